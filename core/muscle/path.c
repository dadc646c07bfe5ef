#include "muscle/path.h"

#include "base/alloc.h"

#include <string.h>

enum { group = 16, n_group = SN_PATH_STEPS / group };

/* ---- frames ---- */

bool sn_normal_towards(sn_vec3 t, sn_vec3 axis, sn_vec3 *out)
{
    double size = fmax(fabs(axis.x), fmax(fabs(axis.y), fabs(axis.z)));
    if (!(size > 0.0)) return false;
    axis = sn_v3(axis.x / size, axis.y / size, axis.z / size); /* its square must not overflow */
    sn_vec3 n = sn_v3_mad(axis, -sn_v3_dot(axis, t), t);
    if (!(sn_v3_len(n) > 1e-6 * sn_v3_len(axis))) return false;
    *out = sn_v3_unit(n);
    return true;
}

/* The coordinate axis that t runs along least. */
static sn_vec3 least_axis(sn_vec3 t)
{
    double x = fabs(t.x), y = fabs(t.y), z = fabs(t.z);
    if (x <= y && x <= z) return sn_v3(1, 0, 0);
    return y <= z ? sn_v3(0, 1, 0) : sn_v3(0, 0, 1);
}

static sn_triad triad(sn_vec3 e1, sn_vec3 e2)
{
    return (sn_triad){e1, e2, sn_v3_cross(e1, e2)};
}

static sn_triad turned(sn_triad f, double angle_deg)
{
    double a = angle_deg * (3.14159265358979323846 / 180.0);
    return triad(f.e1, sn_v3_mad(sn_v3_scale(cos(a), f.e2), sin(a), f.e3));
}

/* v after the reflection that the vector across takes to its opposite. */
static sn_vec3 reflect(sn_vec3 v, sn_vec3 across)
{
    double c = sn_v3_len2(across);
    return c > 0.0 ? sn_v3_mad(v, -2.0 * sn_v3_dot(across, v) / c, across) : v;
}

static sn_triad carry(sn_triad f, sn_vec3 p0, sn_vec3 p1, sn_vec3 tangent)
{
    sn_vec3 step = sn_v3_sub(p1, p0), t = reflect(f.e1, step), n = reflect(f.e2, step), e2;
    n = reflect(n, sn_v3_sub(tangent, t));
    if (!sn_normal_towards(tangent, n, &e2)) (void)sn_normal_towards(tangent, least_axis(tangent), &e2);
    return triad(tangent, e2);
}

/* ---- one head ---- */

static void build_groups(sn_path *p)
{
    for (int g = 0; g < n_group; g++) {
        sn_vec3 middle = p->point[g * group + group / 2];
        p->group_radius[g] = 0.0;
        for (int k = g * group; k <= (g + 1) * group; k++)
            p->group_radius[g] = fmax(p->group_radius[g], sn_v3_dist(middle, p->point[k]));
    }
}

static void build_path(sn_path *p, const sn_spline *s, sn_vec3 axis, double angle_deg)
{
    p->length = sn_spline_length(s);
    for (int k = 0; k <= SN_PATH_STEPS; k++) {
        int32_t seg;
        double t;
        sn_spline_at(s, p->length * k / SN_PATH_STEPS, &seg, &t);
        p->point[k] = sn_cubic_point(&s->seg[seg], t);
        sn_vec3 e1 = sn_spline_tangent(s, p->length * k / SN_PATH_STEPS), e2;
        if (k > 0) {
            p->frame[k] = carry(p->frame[k - 1], p->point[k - 1], p->point[k], e1);
            continue;
        }
        if (!sn_normal_towards(e1, axis, &e2)) (void)sn_normal_towards(e1, least_axis(e1), &e2);
        p->frame[0] = turned(triad(e1, e2), angle_deg);
    }
    build_groups(p);
}

sn_vec3 sn_muscle_frame_axis(const sn_muscle *m)
{
    const sn_anisotropy *a = &m->anisotropy;
    return a->has_axis ? a->axis : least_axis(sn_spline_tangent(&m->head[0].spline, 0.0));
}

sn_status sn_paths_build(sn_paths *p, const sn_muscle *m, sn_error *err)
{
    sn_vec3 axis = sn_muscle_frame_axis(m);
    sn_paths_free(p);
    p->head = SN_NEW(sn_path, m->n_head);
    if (!p->head) return sn_fail(err, SN_ENOMEM, "muscle '%s': no memory", m->name);
    p->n_head = m->n_head;
    for (int32_t i = 0; i < m->n_head; i++)
        build_path(&p->head[i], &m->head[i].spline, axis, m->anisotropy.angle_deg);
    return SN_OK;
}

void sn_paths_free(sn_paths *p)
{
    sn_release(p->head);
    memset(p, 0, sizeof *p);
}

/* The step that holds arc and how far into it, 0..1. */
static int step_of(const sn_path *p, double arc, double *t)
{
    double at = fmin(fmax(arc / p->length, 0.0), 1.0) * SN_PATH_STEPS;
    int k = (int)at < SN_PATH_STEPS - 1 ? (int)at : SN_PATH_STEPS - 1;
    *t = at - k;
    return k;
}

sn_vec3 sn_path_point(const sn_path *p, double arc)
{
    double t;
    int k = step_of(p, arc, &t);
    if (arc < 0.0) return sn_v3_mad(p->point[0], arc, p->frame[0].e1);
    if (arc > p->length)
        return sn_v3_mad(p->point[SN_PATH_STEPS], arc - p->length, p->frame[SN_PATH_STEPS].e1);
    return sn_v3_lerp(p->point[k], p->point[k + 1], t);
}

sn_triad sn_path_frame(const sn_path *p, double arc)
{
    double t;
    int k = step_of(p, arc, &t);
    sn_vec3 e1 = sn_v3_unit(sn_v3_lerp(p->frame[k].e1, p->frame[k + 1].e1, t)), e2;
    if (!sn_normal_towards(e1, sn_v3_lerp(p->frame[k].e2, p->frame[k + 1].e2, t), &e2)) return p->frame[k];
    return triad(e1, e2);
}

/* ---- nearest places ---- */

typedef struct nearest {
    int32_t head;
    double at, dist2; /* steps from the origin */
} nearest;

static void try_step(const sn_path *p, int32_t i_head, int k, sn_vec3 point, nearest *best)
{
    sn_vec3 along = sn_v3_sub(p->point[k + 1], p->point[k]), to = sn_v3_sub(point, p->point[k]);
    double len2 = sn_v3_len2(along), t = len2 > 0.0 ? fmin(fmax(sn_v3_dot(to, along) / len2, 0.0), 1.0) : 0.0;
    double dist2 = sn_v3_len2(sn_v3_mad(to, -t, along));
    /* Another head has to be nearer by more than rounding, which must not choose beyond a shared end. */
    if (dist2 < best->dist2 * (i_head == best->head ? 1.0 : 1.0 - 1e-9))
        *best = (nearest){i_head, k + t, dist2};
}

static void search_head(const sn_path *p, int32_t i_head, sn_vec3 point, nearest *best)
{
    for (int g = 0; g < n_group; g++) {
        double to_middle = sn_v3_dist(point, p->point[g * group + group / 2]) - p->group_radius[g];
        if (to_middle > 0.0 && to_middle * to_middle > best->dist2) continue;
        for (int k = g * group; k < (g + 1) * group; k++) try_step(p, i_head, k, point, best);
    }
}

sn_curve_place sn_paths_place(const sn_paths *p, sn_vec3 point)
{
    nearest best = {0, 0.0, INFINITY};
    for (int32_t i = 0; i < p->n_head; i++) search_head(&p->head[i], i, point, &best);
    const sn_path *h = &p->head[best.head];
    double arc = h->length * best.at / SN_PATH_STEPS;
    if (best.at <= 0.0)
        arc = fmin(sn_v3_dot(sn_v3_sub(point, h->point[0]), h->frame[0].e1), 0.0);
    else if (best.at >= SN_PATH_STEPS)
        arc = h->length +
              fmax(sn_v3_dot(sn_v3_sub(point, h->point[SN_PATH_STEPS]), h->frame[SN_PATH_STEPS].e1), 0.0);
    return (sn_curve_place){best.head, arc, sqrt(best.dist2)};
}
