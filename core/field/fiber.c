#include "field/fiber.h"

#include "base/alloc.h"
#include "field/cholesky.h"
#include "tetra/trace.h"

#include <string.h>

#define ALPHA 50.0       /* weight of the curve's direction, against 1 of the Laplacian          */
#define LEAST_SHARE 1e-3 /* a tet with less counts as this much: the matrix stays well behaved   */
#define AT_END_REL 0.04  /* of the curve: so near to an end u is given, too: caps are never quite flat */
#define PASSING_REL 2.0  /* of the distance to an end: a head that passes nearer owns the place, too */
#define END_REL 0.04     /* of the curve: how much of a muscle that stops short counts as its end */

/* ---- the tets that take part ---- */

static sn_status find_part(sn_fibers *f, const sn_tet_mesh *body, const double *share, const char *name,
                           sn_error *err)
{
    int32_t n_tet = 0, n_vert = 0, *number = SN_NEW_ZERO(int32_t, body->n_vert);
    f->tet_of = SN_NEW(int32_t, body->n_tet);
    if (!number || !f->tet_of) {
        sn_release(number);
        return sn_fail(err, SN_ENOMEM, "fibers of muscle '%s': no memory", name);
    }
    for (int32_t t = 0; t < body->n_tet; t++) {
        f->tet_of[t] = share[t] > 0.0 ? n_tet++ : -1;
        for (int k = 0; k < 4 && share[t] > 0.0; k++) number[body->tet[4 * (size_t)t + (size_t)k]] = 1;
    }
    for (int32_t v = 0; v < body->n_vert; v++) number[v] = number[v] ? n_vert++ : -1;
    sn_status st = n_tet > 0 ? sn_tet_mesh_reserve(&f->mesh, n_vert, n_tet, false, err)
                             : sn_fail(err, SN_EINVAL, "fibers of muscle '%s': it is empty", name);
    f->share = SN_NEW(double, n_tet);
    if (!st && !f->share) st = sn_fail(err, SN_ENOMEM, "fibers of muscle '%s': no memory", name);
    for (int32_t v = 0; !st && v < body->n_vert; v++)
        if (number[v] >= 0) sn_v3_store(f->mesh.pos + 3 * (size_t)number[v], sn_tet_mesh_point(body, v));
    for (int32_t t = 0; !st && t < body->n_tet; t++) {
        if (f->tet_of[t] < 0) continue;
        f->share[f->tet_of[t]] = fmax(share[t], LEAST_SHARE);
        for (size_t k = 0; k < 4; k++)
            f->mesh.tet[4 * (size_t)f->tet_of[t] + k] = number[body->tet[4 * (size_t)t + k]];
    }
    sn_release(number);
    return st;
}

/* ---- places of the vertices ---- */

/* From 0 at the origin of its head to 1 at the insertion; beyond, outside of that. */
static double fraction(const sn_fibers *f, const sn_curve_place *p)
{
    return p->arc / f->paths.head[p->head].length;
}

/* What u is there: counted from the end that the heads share, in lengths of the longest, so that heads of
 * different lengths that run side by side agree. */
static double progress(const sn_fibers *f, const sn_curve_place *p)
{
    if (f->from_origin) return p->arc / f->longest;
    return 1.0 - (f->paths.head[p->head].length - p->arc) / f->longest;
}

/* ---- ends ---- */

typedef struct ends {
    double first, last; /* the range of fractions of one head's vertices */
} ends;

static void find_ends(const sn_fibers *f, const sn_curve_place *place, ends *e)
{
    for (int32_t h = 0; h < f->paths.n_head; h++) e[h] = (ends){INFINITY, -INFINITY};
    for (int32_t v = 0; v < f->mesh.n_vert; v++) {
        ends *of = &e[place[v].head];
        of->first = fmin(of->first, fraction(f, &place[v]));
        of->last = fmax(of->last, fraction(f, &place[v]));
    }
}

/* Another head passes by nearly as close, between its own ends: p belongs to its belly, too. */
static bool has_passing_head(const sn_fibers *f, sn_vec3 p, const sn_curve_place *at)
{
    for (int32_t h = 0; h < f->paths.n_head; h++) {
        sn_paths one = {&f->paths.head[h], 1};
        if (h == at->head) continue;
        sn_curve_place other = sn_paths_place(&one, p);
        double t = other.arc / one.head->length;
        if (t > AT_END_REL && t < 1.0 - AT_END_REL && other.distance < PASSING_REL * at->distance)
            return true;
    }
    return false;
}

/* From p to the nearest end point of an insertion. */
static double to_insertion(const sn_fibers *f, sn_vec3 p)
{
    double near = INFINITY;
    for (int32_t h = 0; h < f->paths.n_head; h++)
        near = fmin(near, sn_v3_dist(p, f->paths.head[h].point[SN_PATH_STEPS]));
    return near;
}

/* The vertices of the tet nearest to an insertion's end point, and what lies as near. */
static double insertion_radius(const sn_fibers *f)
{
    double near = INFINITY;
    for (int32_t v = 0; v < f->mesh.n_vert; v++)
        near = fmin(near, to_insertion(f, sn_tet_mesh_point(&f->mesh, v)));
    return 2.0 * near + 0.02 * f->paths.head[0].length;
}

/* Tets that reach beyond an end hold some of the muscle's cap, which no free vertex may touch: it is no wall
 * along which fibers run. */
static void fix_caps(const sn_fibers *f, const sn_curve_place *place, const bool *is_end, double *value)
{
    for (int32_t t = 0; t < f->mesh.n_tet; t++) {
        const int32_t *v = f->mesh.tet + 4 * (size_t)t;
        bool is_cap = false;
        for (int k = 0; k < 4; k++) {
            double at = fraction(f, &place[v[k]]);
            is_cap = is_cap || (is_end[v[k]] && (at < 0.0 || at > 1.0));
        }
        for (int k = 0; k < 4 && is_cap; k++)
            if (isnan(value[v[k]])) value[v[k]] = progress(f, &place[v[k]]);
    }
}

/* value[v]: u where it is given; NAN where it is free. is_end: room for n_vert. */
static void fix_ends(const sn_fibers *f, const sn_curve_place *place, const ends *e, bool *is_end,
                     double *value)
{
    bool to_point = f->pennation.kind == SN_CONVERGENT;
    double radius = to_point ? insertion_radius(f) : 0.0;
    for (int32_t v = 0; v < f->mesh.n_vert; v++) {
        const ends *of = &e[place[v].head];
        sn_vec3 p = sn_tet_mesh_point(&f->mesh, v);
        double t = fraction(f, &place[v]), first = of->first > AT_END_REL ? of->first + END_REL : AT_END_REL;
        double last = of->last < 1.0 - AT_END_REL ? of->last - END_REL : 1.0 - AT_END_REL;
        is_end[v] = (t <= first || (!to_point && t >= last)) && !has_passing_head(f, p, &place[v]);
        value[v] = is_end[v] ? progress(f, &place[v]) : (double)NAN;
        double to_end = to_point ? to_insertion(f, p) : INFINITY;
        if (to_end <= radius) value[v] = 1.0 - to_end / f->longest;
    }
    fix_caps(f, place, is_end, value);
}

/* ---- pieces that do not reach from end to end ---- */

static int32_t root_of(int32_t *parent, int32_t v)
{
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
}

/* Of the part of the head along which the muscle lies: it may hold less than half of the curve. */
static bool is_first_half(const sn_fibers *f, const sn_curve_place *p, const ends *e)
{
    return fraction(f, p) < 0.5 * (e[p->head].first + e[p->head].last);
}

/* A piece of the muscle without both ends has nothing that drives u through it: u is the place along the
 * curve all over it. */
static sn_status fix_pieces(const sn_fibers *f, const sn_curve_place *place, const ends *e, double *value,
                            sn_error *err)
{
    int32_t n = f->mesh.n_vert, *parent = SN_NEW(int32_t, n);
    unsigned char *has = SN_NEW_ZERO(unsigned char, n); /* 1: an origin, 2: an insertion */
    sn_status st = parent && has ? SN_OK : sn_fail(err, SN_ENOMEM, "fibers: no memory for %d vertices", n);
    for (int32_t v = 0; !st && v < n; v++) parent[v] = v;
    for (int32_t t = 0; !st && t < f->mesh.n_tet; t++) {
        const int32_t *v = f->mesh.tet + 4 * (size_t)t;
        for (int k = 1; k < 4; k++) parent[root_of(parent, v[k])] = root_of(parent, v[0]);
    }
    for (int32_t v = 0; !st && v < n; v++)
        if (!isnan(value[v])) has[root_of(parent, v)] |= is_first_half(f, &place[v], e) ? 1 : 2;
    for (int32_t v = 0; !st && v < n; v++)
        if (has[root_of(parent, v)] != 3) value[v] = progress(f, &place[v]);
    sn_release(parent);
    sn_release(has);
    return st;
}

/* ---- the field ---- */

typedef struct fiber_system {
    sn_csr matrix;
    sn_assembly assembly;
    sn_curve_place *place; /* n_vert */
    ends *end;             /* n_head */
    double *fixed;         /* n_vert; NAN where free */
    bool *is_end;          /* n_vert; given because it lies at an end */
    int32_t *number;       /* n_vert: unknown, or -1 */
    int32_t n_free;
    sn_cholesky *cholesky;
} fiber_system;

static void free_system(fiber_system *s)
{
    sn_csr_free(&s->matrix);
    sn_assembly_free(&s->assembly);
    sn_release(s->place);
    sn_release(s->end);
    sn_release(s->fixed);
    sn_release(s->is_end);
    sn_release(s->number);
    sn_cholesky_destroy(s->cholesky);
}

/* Adds alpha |n . grad u|^2 over one tet, in normalized lengths. Without the volume the term would be a
 * constraint, the harder the finer the mesh, and the directions of neighbouring tets do not quite agree. */
static void add_normal(fiber_system *s, const sn_fibers *f, int32_t t, sn_vec3 n, double size)
{
    sn_vec3 g[4];
    const int32_t *v = f->mesh.tet + 4 * (size_t)t;
    double weight = ALPHA * f->share[t] * sn_tet_gradients(&f->mesh, t, g) / size;
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++)
            s->matrix.val[sn_csr_find(&s->matrix, v[i], v[k])] +=
                weight * sn_v3_dot(n, g[i]) * sn_v3_dot(n, g[k]);
}

/* The directions of the curves in the tets that they cross. */
static sn_status add_curves(fiber_system *s, const sn_fibers *f, const sn_muscle *m, sn_error *err)
{
    sn_body body;
    sn_locator *locator = NULL;
    double size = sn_box3_diagonal(sn_tet_mesh_bounds(&f->mesh));
    sn_body_init(&body);
    sn_status st = sn_body_from_tets(&f->mesh, SN_LABEL_SKIN, &body, err);
    if (!st) st = sn_locator_create(&locator, &f->mesh, err);
    for (int32_t h = 0; h < m->n_head && !st; h++) {
        const sn_spline *spline = &m->head[h].spline;
        sn_trace trace = {0};
        st = sn_trace_curve(&body, locator, spline->seg, spline->n_seg, &trace, err);
        for (size_t i = 0; i < trace.n_piece && !st; i++) {
            const sn_trace_piece *p = &trace.piece[i];
            sn_triad frame = sn_path_frame(&f->paths.head[h], sn_spline_arc(spline, p->i_seg, p->s));
            add_normal(s, f, p->tet, frame.e2, size);
            add_normal(s, f, p->tet, frame.e3, size);
        }
        sn_trace_free(&trace);
    }
    sn_locator_destroy(locator);
    sn_body_free(&body);
    return st;
}

static sn_status assemble(fiber_system *s, const sn_fibers *f, const sn_muscle *m, const sn_run *run,
                          sn_error *err)
{
    size_t n = (size_t)f->mesh.n_vert;
    s->place = SN_NEW(sn_curve_place, n);
    s->end = SN_NEW(ends, f->paths.n_head);
    s->fixed = SN_NEW(double, n);
    s->is_end = SN_NEW(bool, n);
    s->number = SN_NEW(int32_t, n);
    if (!s->place || !s->end || !s->fixed || !s->is_end || !s->number)
        return sn_fail(err, SN_ENOMEM, "fibers: no memory for %zu vertices", n);
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(run))
    for (size_t v = 0; v < n; v++)
        s->place[v] = sn_paths_place(&f->paths, sn_tet_mesh_point(&f->mesh, (int32_t)v));
    sn_status st = sn_laplacian_build(&s->matrix, &s->assembly, &f->mesh, 0.0, run, err);
    if (st) return st;
    sn_laplacian_set_weighted(&s->matrix, &s->assembly, &f->mesh, f->share);
    st = add_curves(s, f, m, err);
    if (st) return st;
    find_ends(f, s->place, s->end);
    fix_ends(f, s->place, s->end, s->is_end, s->fixed);
    st = fix_pieces(f, s->place, s->end, s->fixed, err);
    if (st) return st;
    for (size_t v = 0; v < n; v++) s->number[v] = isnan(s->fixed[v]) ? s->n_free++ : -1;
    return SN_OK;
}

/* b on the unknowns: what the given values bring. */
static void reduce_rhs(const fiber_system *s, double *b)
{
    for (int32_t v = 0; v < s->matrix.n; v++) {
        if (s->number[v] < 0) continue;
        double sum = 0.0;
        for (int64_t k = s->matrix.ptr[v]; k < s->matrix.ptr[v + 1]; k++)
            if (s->number[s->matrix.idx[k]] < 0) sum -= s->matrix.val[k] * s->fixed[s->matrix.idx[k]];
        b[s->number[v]] = sum;
    }
}

static sn_status solve_u(sn_fibers *f, const sn_muscle *m, const sn_run *run, sn_error *err)
{
    fiber_system s = {.n_free = 0};
    double *b = SN_NEW(double, f->mesh.n_vert);
    f->u = SN_NEW(double, f->mesh.n_vert);
    f->is_free = SN_NEW(bool, f->mesh.n_vert);
    sn_status st =
        b && f->u && f->is_free ? assemble(&s, f, m, run, err) : sn_fail(err, SN_ENOMEM, "fibers: no memory");
    if (!st && s.n_free > 0) {
        reduce_rhs(&s, b);
        st = sn_cholesky_create_small(&s.cholesky, &s.matrix, s.number, s.n_free, run, err);
        if (!st) st = sn_cholesky_factorize(s.cholesky, &s.matrix, run, err);
        if (!st) st = sn_cholesky_solve(s.cholesky, b, 1, run, err);
    }
    for (int32_t v = 0; v < f->mesh.n_vert && !st; v++) {
        f->is_free[v] = s.number[v] >= 0;
        f->u[v] = f->is_free[v] ? b[s.number[v]] : s.fixed[v];
    }
    free_system(&s);
    sn_release(b);
    return st;
}

/* grad u in a tet. */
static sn_vec3 slope_of(const sn_fibers *f, int32_t t)
{
    sn_vec3 g[4], sum = {0};
    (void)sn_tet_gradients(&f->mesh, t, g);
    for (int k = 0; k < 4; k++) sum = sn_v3_mad(sum, f->u[f->mesh.tet[4 * (size_t)t + (size_t)k]], g[k]);
    return sum;
}

/* Adds to each vertex what its tets bring, times the muscle's volume in them. */
static void gather(const sn_fibers *f, const sn_vec3 *slope, sn_vec3 *sum, double *mass)
{
    memset(sum, 0, (size_t)f->mesh.n_vert * sizeof *sum);
    memset(mass, 0, (size_t)f->mesh.n_vert * sizeof *mass);
    for (int32_t t = 0; t < f->mesh.n_tet; t++) {
        double volume = f->share[t] * sn_tet_mesh_tet_volume(&f->mesh, t);
        for (int k = 0; k < 4; k++) {
            int32_t v = f->mesh.tet[4 * (size_t)t + (size_t)k];
            sum[v] = sn_v3_mad(sum[v], volume, slope[t]);
            mass[v] += volume;
        }
    }
}

/* To each tet the mean of its corners, by the muscle's volume around them. */
static void spread_back(const sn_fibers *f, const double *mass, sn_vec3 *slope)
{
    for (int32_t t = 0; t < f->mesh.n_tet; t++) {
        const int32_t *v = f->mesh.tet + 4 * (size_t)t;
        sn_vec3 sum =
            sn_v3_add(sn_v3_add(f->along[v[0]], f->along[v[1]]), sn_v3_add(f->along[v[2]], f->along[v[3]]));
        slope[t] = sn_v3_scale(1.0 / (mass[v[0]] + mass[v[1]] + mass[v[2]] + mass[v[3]]), sum);
    }
}

/* Slopes of a bent muscle are compared in the frame that goes with its curve: the mean of neighbours on one
 * side only, as at an end, would else point off the bend. Between heads there is no such frame. */
static sn_triad smoothing_frame(const sn_fibers *f, sn_vec3 p)
{
    if (f->paths.n_head > 1) return (sn_triad){{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    return sn_path_frame(&f->paths.head[0], sn_paths_place(&f->paths, p).arc);
}

static sn_vec3 into(sn_triad f, sn_vec3 v)
{
    return sn_v3(sn_v3_dot(f.e1, v), sn_v3_dot(f.e2, v), sn_v3_dot(f.e3, v));
}

static sn_vec3 out_of(sn_triad f, sn_vec3 v)
{
    return sn_v3_mad(sn_v3_mad(sn_v3_scale(v.x, f.e1), v.y, f.e2), v.z, f.e3);
}

/* The mean of grad u over the muscle around each vertex, taken several times: corners outside of the muscle,
 * whose tets hold slivers of it only, then follow their neighbours inside, and the facets of the muscle's
 * surface, along which linear elements must run, even out. */
enum { n_smoothing = 3 };

static sn_status average_slopes(sn_fibers *f, sn_error *err)
{
    sn_vec3 *slope = SN_NEW(sn_vec3, f->mesh.n_tet);
    double *mass = SN_NEW(double, f->mesh.n_vert);
    f->along = SN_NEW(sn_vec3, f->mesh.n_vert);
    sn_status st = slope && mass && f->along ? SN_OK : sn_fail(err, SN_ENOMEM, "fibers: no memory");
    for (int32_t t = 0; !st && t < f->mesh.n_tet; t++)
        slope[t] = into(smoothing_frame(f, sn_tet_mesh_centre(&f->mesh, t)), slope_of(f, t));
    for (int i = 0; !st && i < n_smoothing; i++) {
        if (i > 0) spread_back(f, mass, slope);
        gather(f, slope, f->along, mass);
    }
    for (int32_t v = 0; !st && v < f->mesh.n_vert; v++) {
        sn_vec3 p = sn_tet_mesh_point(&f->mesh, v);
        f->along[v] = sn_v3_unit(out_of(smoothing_frame(f, p), f->along[v]));
        if (!(sn_v3_len(f->along[v]) > 0.5)) f->along[v] = sn_fibers_line_of_action(f, p);
    }
    sn_release(slope);
    sn_release(mass);
    return st;
}

/* ---- frames: straps and pennate muscles ---- */

static bool has_field(const sn_fibers *f)
{
    return f->pennation.kind == SN_FUSIFORM || f->pennation.kind == SN_CONVERGENT;
}

typedef struct spot { /* the nearest place of the curves, and what is known there */
    sn_curve_place at;
    sn_triad frame;
    double off; /* how far the point lies from the sheet of the curve and e2, along e3 */
} spot;

static spot spot_of(const sn_fibers *f, sn_vec3 p)
{
    sn_curve_place at = sn_paths_place(&f->paths, p);
    const sn_path *path = &f->paths.head[at.head];
    sn_triad frame = sn_path_frame(path, at.arc);
    return (spot){at, frame, sn_v3_dot(sn_v3_sub(p, sn_path_point(path, at.arc)), frame.e3)};
}

static void find_sheets(sn_fibers *f)
{
    f->sheet_min = INFINITY;
    f->sheet_max = -INFINITY;
    for (int32_t t = 0; t < f->mesh.n_tet; t++) {
        if (f->share[t] < 0.5) continue;
        double off = spot_of(f, sn_tet_mesh_centre(&f->mesh, t)).off;
        f->sheet_min = fmin(f->sheet_min, off);
        f->sheet_max = fmax(f->sheet_max, off);
    }
    if (!(f->sheet_min < f->sheet_max)) f->sheet_min = f->sheet_max = 0.0;
}

static double angle_at(const sn_pennation *p, double t)
{
    double at = fmin(fmax(t, 0.0), 1.0) * (p->n_angle - 1);
    int k = (int)at < p->n_angle - 1 ? (int)at : p->n_angle - 2;
    double deg = p->n_angle < 2 ? p->angle_deg[0]
                                : p->angle_deg[k] + (at - k) * (p->angle_deg[k + 1] - p->angle_deg[k]);
    return deg * (3.14159265358979323846 / 180.0);
}

/* The room between two neighbouring sheets of tendon that lies `off` the curve's sheet: in even ones fibers
 * lean along e3, in odd ones against it. */
static int32_t room_at(const sn_fibers *f, double off)
{
    if (f->pennation.kind != SN_BIPENNATE && f->pennation.kind != SN_MULTIPENNATE) return 0;
    if (f->pennation.kind == SN_BIPENNATE || !(f->sheet_max > f->sheet_min)) return off > 0.0;
    int32_t n = 2 * f->pennation.n_sheet;
    return (int32_t)fmin(fmax((off - f->sheet_min) / (f->sheet_max - f->sheet_min) * n, 0.0), n - 1.0);
}

static sn_vec3 by_frame(const sn_fibers *f, sn_vec3 p, double *u)
{
    spot s = spot_of(f, p);
    if (u) *u = progress(f, &s.at);
    if (f->pennation.kind == SN_PARALLEL) return s.frame.e1;
    double angle = angle_at(&f->pennation, fraction(f, &s.at)), side = room_at(f, s.off) % 2 ? -1.0 : 1.0;
    return sn_v3_mad(sn_v3_scale(cos(angle), s.frame.e1), side * sin(angle), s.frame.e3);
}

/* ---- the whole ---- */

static void find_lengths(sn_fibers *f, const sn_muscle *m)
{
    f->from_origin = sn_muscle_shared_end(m) == SN_SHARE_ORIGIN;
    for (int32_t h = 0; h < f->paths.n_head; h++) f->longest = fmax(f->longest, f->paths.head[h].length);
}

sn_status sn_fibers_build(sn_fibers *f, const sn_tet_mesh *body, const double *share, const sn_muscle *m,
                          const sn_run *run, sn_error *err)
{
    memset(f, 0, sizeof *f);
    f->pennation = m->pennation;
    sn_status st = sn_run_step(run, "finding fibers", -1.0, err);
    if (!st && has_field(f) && sn_muscle_shared_end(m) == SN_SHARE_NONE)
        st = sn_fail(
            err, SN_EINVAL,
            "fibers of muscle '%s': its %d heads share neither an insertion (last point) nor an origin "
            "(first point)",
            m->name, m->n_head);
    if (!st) st = find_part(f, body, share, m->name, err);
    if (!st) st = sn_paths_build(&f->paths, m, err);
    if (!st) find_lengths(f, m);
    if (!st && has_field(f)) {
        st = solve_u(f, m, run, err);
        if (!st) st = average_slopes(f, err);
    } else if (!st) {
        find_sheets(f);
    }
    if (st) sn_fibers_free(f);
    return st;
}

void sn_fibers_free(sn_fibers *f)
{
    sn_tet_mesh_free(&f->mesh);
    sn_release(f->tet_of);
    sn_release(f->share);
    sn_release(f->u);
    sn_release(f->is_free);
    sn_release(f->along);
    sn_paths_free(&f->paths);
    memset(f, 0, sizeof *f);
}

sn_vec3 sn_fibers_line_of_action(const sn_fibers *f, sn_vec3 p)
{
    sn_curve_place at = sn_paths_place(&f->paths, p);
    return sn_path_frame(&f->paths.head[at.head], at.arc).e1;
}

int32_t sn_fibers_room(const sn_fibers *f, sn_vec3 p)
{
    bool has_rooms = f->pennation.kind == SN_BIPENNATE || f->pennation.kind == SN_MULTIPENNATE;
    return has_rooms ? room_at(f, spot_of(f, p).off) : 0;
}

sn_vec3 sn_fibers_at(const sn_fibers *f, int32_t i_body_tet, sn_vec3 p, double *u)
{
    int32_t t = f->tet_of[i_body_tet];
    if (!has_field(f)) return by_frame(f, p, u);
    double bary[4];
    sn_vec3 along = {0};
    sn_tet_barycentric(&f->mesh, t, p, bary);
    if (u) *u = 0.0;
    for (int k = 0; k < 4; k++) {
        int32_t v = f->mesh.tet[4 * (size_t)t + (size_t)k];
        along = sn_v3_mad(along, bary[k], f->along[v]);
        if (u) *u += bary[k] * f->u[v];
    }
    along = sn_v3_unit(along);
    return sn_v3_len(along) > 0.5 ? along : sn_fibers_line_of_action(f, p);
}

/* ---- what holds of it ---- */

static double turn_deg(sn_vec3 a, sn_vec3 b)
{
    return acos(fmin(fmax(sn_v3_dot(a, b), -1.0), 1.0)) * (180.0 / 3.14159265358979323846);
}

static void check_turns(const sn_fibers *f, const sn_vec3 *along, const int32_t *room, sn_fibers_check *out)
{
    for (int32_t t = 0; t < f->mesh.n_tet; t++) {
        const int32_t *v = f->mesh.tet + 4 * (size_t)t;
        double worst = 0.0;
        for (int e = 0; e < 6; e++) {
            int32_t a = v[sn_tet_edge[e][0]], b = v[sn_tet_edge[e][1]];
            if (room[a] == room[b]) worst = fmax(worst, turn_deg(along[a], along[b]));
        }
        out->worst_turn_deg = fmax(out->worst_turn_deg, worst);
        out->flipped += worst > 90.0;
    }
}

/* Directions at the corners, and between which aponeuroses they lie. */
static sn_status check_directions(const sn_fibers *f, sn_fibers_check *out, sn_error *err)
{
    sn_vec3 *along = SN_NEW(sn_vec3, f->mesh.n_vert);
    int32_t *room = SN_NEW(int32_t, f->mesh.n_vert);
    sn_status st = along && room ? SN_OK : sn_fail(err, SN_ENOMEM, "fibers: no memory");
    for (int32_t v = 0; !st && v < f->mesh.n_vert; v++) {
        sn_vec3 p = sn_tet_mesh_point(&f->mesh, v);
        along[v] = has_field(f) ? f->along[v] : by_frame(f, p, NULL);
        room[v] = sn_fibers_room(f, p);
    }
    if (!st) check_turns(f, along, room, out);
    sn_release(along);
    sn_release(room);
    return st;
}

sn_status sn_fibers_check_run(const sn_fibers *f, sn_fibers_check *out, sn_error *err)
{
    memset(out, 0, sizeof *out);
    sn_status st = check_directions(f, out, err);
    if (st || !has_field(f)) return st;
    /* 1: has a higher neighbour, 2: a lower one, 4: lies outside, a corner of tets that are hardly the
     * muscle's */
    unsigned char *has = SN_NEW_ZERO(unsigned char, f->mesh.n_vert);
    if (!has) return sn_fail(err, SN_ENOMEM, "fibers: no memory");
    for (int32_t t = 0; t < f->mesh.n_tet; t++) {
        for (int k = 0; k < 4 && f->share[t] < 0.5; k++) has[f->mesh.tet[4 * (size_t)t + (size_t)k]] |= 4;
        for (int e = 0; e < 6; e++) {
            int32_t a = f->mesh.tet[4 * (size_t)t + (size_t)sn_tet_edge[e][0]];
            int32_t b = f->mesh.tet[4 * (size_t)t + (size_t)sn_tet_edge[e][1]];
            has[a] |= f->u[b] > f->u[a] ? 1 : f->u[b] < f->u[a] ? 2 : 0;
            has[b] |= f->u[a] > f->u[b] ? 1 : f->u[a] < f->u[b] ? 2 : 0;
        }
    }
    for (int32_t v = 0; v < f->mesh.n_vert; v++) {
        if (!f->is_free[v] || (has[v] & 4)) continue;
        out->sinks += !(has[v] & 1);
        out->sources += !(has[v] & 2);
    }
    for (int32_t t = 0; t < f->mesh.n_tet; t++)
        out->still += !(sn_v3_len(slope_of(f, t)) * f->longest > 1e-3);
    sn_release(has);
    return SN_OK;
}
