#include "render/muscle_polygons.h"

#include "base/alloc.h"

#include <string.h>

static const float gloss = 0.5f;

/* A point of a tet or a face by its corners' weights: where g is 0 on the edge between the corners i and j,
 * at a corner when they are equal, or, i < 0, any other. */
typedef struct sn_bary {
    double w[4];
    int i, j;
} sn_bary;

bool sn_polygon_scratch_init(sn_polygon_scratch *w, int32_t n_tissue)
{
    size_t n = (size_t)n_tissue + 4; /* each of the others may add a corner to four */
    w->muscle = SN_NEW(int32_t, n);
    w->value = SN_NEW(double, 4 * n);
    w->corner = SN_NEW(sn_bary, n);
    w->next = SN_NEW(sn_bary, n);
    return w->muscle && w->value && w->corner && w->next;
}

void sn_polygon_scratch_free(sn_polygon_scratch *w)
{
    sn_release(w->muscle);
    sn_release(w->value);
    sn_release(w->corner);
    sn_release(w->next);
}

void sn_polygons_free(sn_polygons *p)
{
    sn_release(p->corner);
    sn_release(p->size);
    sn_release(p->own);
    sn_release(p->own_tendon);
    memset(p, 0, sizeof *p);
}

/* ---- clipping ---- */

static double value_at(const sn_bary *c, const double value[4])
{
    return c->w[0] * value[0] + c->w[1] * value[1] + c->w[2] * value[2] + c->w[3] * value[3];
}

static sn_bary point_between(const sn_bary *a, const sn_bary *b, double at)
{
    sn_bary c = {.i = -1, .j = -1};
    for (int k = 0; k < 4; k++) c.w[k] = a->w[k] + at * (b->w[k] - a->w[k]);
    return c;
}

/* Keeps what of the polygon lies where the value is not above 0. Returns the number of corners. */
static int32_t clip(sn_polygon_scratch *w, int32_t n, const double value[4])
{
    int32_t n_out = 0;
    for (int32_t k = 0; k < n; k++) {
        const sn_bary *a = &w->corner[k], *b = &w->corner[k + 1 < n ? k + 1 : 0];
        double va = value_at(a, value), vb = value_at(b, value);
        if (va <= 0.0) w->next[n_out++] = *a;
        /* From the kept end, so that both ways along the side give the same point. */
        if (va <= 0.0 && vb > 0.0) w->next[n_out++] = point_between(a, b, va / (va - vb));
        if (va > 0.0 && vb <= 0.0) w->next[n_out++] = point_between(b, a, vb / (vb - va));
    }
    sn_bary *swap = w->corner;
    w->corner = w->next;
    w->next = swap;
    return n_out < 3 ? 0 : n_out;
}

/* ---- vertices ---- */

static int16_t to_short(double v)
{
    return (int16_t)lround(32767.0 * fmin(fmax(v, -1.0), 1.0));
}

static uint8_t to_byte(float v)
{
    return (uint8_t)(255.0f * v + 0.5f);
}

static sn_surface_vertex make_vertex(sn_vec3 place, sn_vec3 normal, int32_t muscle)
{
    sn_rgb c = sn_muscle_color(muscle);
    return (sn_surface_vertex){.place = {(float)place.x, (float)place.y, (float)place.z},
                               .normal = {to_short(normal.x), to_short(normal.y), to_short(normal.z)},
                               .kind = (uint16_t)(512 + muscle % 512),
                               .color = {to_byte(c.r), to_byte(c.g), to_byte(c.b), to_byte(gloss)}};
}

static sn_vec3 normal_at(const sn_muscle_tets *m, int32_t v, int32_t muscle)
{
    const float *n = sn_muscle_tets_normal(m, v, muscle);
    return sn_v3((double)n[0], (double)n[1], (double)n[2]);
}

/* Where g is 0 on the edge from a to b, counted from a: the same from every tet around it, for a < b. */
static double crossing(double ga, double gb)
{
    return ga / (ga - gb);
}

sn_surface_vertex sn_corner_vertex(const sn_corner *c, const sn_picture_scene *s, const sn_muscle_tets *m,
                                   sn_vec3 origin, float *tendon)
{
    sn_vec3 pa = sn_tet_mesh_point(s->tets, c->a);
    double ta = sn_muscle_tendon(s, c->muscle, c->a);
    if (c->a == c->b) {
        sn_surface_vertex v = make_vertex(sn_v3_sub(pa, origin), (sn_vec3){0}, c->muscle);
        memcpy(v.normal, c->normal, sizeof v.normal);
        *tendon = (float)ta;
        return v;
    }
    double at = crossing(sn_muscle_above_fat(s, c->muscle, c->a), sn_muscle_above_fat(s, c->muscle, c->b));
    sn_vec3 p = sn_v3_lerp(pa, sn_tet_mesh_point(s->tets, c->b), at);
    *tendon = (float)(ta + at * (sn_muscle_tendon(s, c->muscle, c->b) - ta));
    sn_vec3 n = sn_v3_lerp(normal_at(m, c->a, c->muscle), normal_at(m, c->b, c->muscle), at);
    return make_vertex(sn_v3_sub(p, origin), n, c->muscle);
}

/* A vertex that no other block can share: of the weights w of n_corner vertices of the mesh. */
static bool add_own(sn_polygons *p, const sn_picture_scene *s, const int32_t *v, const sn_vec3 *normal, int n,
                    const sn_bary *c, int32_t muscle, sn_vec3 origin)
{
    if (!sn_grow(&p->own, &p->cap_own, p->n_own + 1, sizeof *p->own) ||
        !sn_grow(&p->own_tendon, &p->cap_tendon, p->n_own + 1, sizeof *p->own_tendon))
        return false;
    sn_vec3 place = {0}, sum = {0};
    double tendon = 0.0;
    for (int k = 0; k < n; k++) {
        place = sn_v3_mad(place, c->w[k], sn_v3_sub(sn_tet_mesh_point(s->tets, v[k]), origin));
        sum = sn_v3_mad(sum, c->w[k], normal[k]);
        tendon += c->w[k] * sn_muscle_tendon(s, muscle, v[k]);
    }
    p->own_tendon[p->n_own] = (float)tendon;
    p->own[p->n_own++] = make_vertex(place, sum, muscle);
    return true;
}

static bool begin_polygon(sn_polygons *p, int32_t n)
{
    if (!sn_grow(&p->corner, &p->cap_corner, p->n_corner + (size_t)n, sizeof *p->corner) ||
        !sn_grow(&p->size, &p->cap_polygon, p->n_polygon + 1, sizeof *p->size))
        return false;
    p->size[p->n_polygon++] = n;
    return true;
}

/* ---- in a tet ---- */

static int next_outside(const double g[4], int k, bool is_above)
{
    while (k < 4 && (g[k] > 0.0) != is_above) k++;
    return k;
}

static sn_bary crossing_point(const double g[4], const int32_t v[4], int i, int j)
{
    bool is_up = v[i] < v[j];
    double at = is_up ? crossing(g[i], g[j]) : crossing(g[j], g[i]);
    sn_bary c = {.i = i, .j = j};
    c.w[is_up ? j : i] = at;
    c.w[is_up ? i : j] = 1.0 - at;
    return c;
}

/* Where g is 0 in the tet: 0, 3 or 4 corners, counter-clockwise seen from where g is below 0. */
static int32_t zero_polygon(const double g[4], const int32_t v[4], sn_bary *out)
{
    int n_above = 0;
    for (int k = 0; k < 4; k++) n_above += g[k] > 0.0;
    if (n_above == 0 || n_above == 4) return 0;
    if (n_above != 2) { /* around the one corner that is alone on its side */
        int apex = next_outside(g, 0, n_above == 1);
        for (int k = 0; k < 3; k++)
            out[k] = crossing_point(g, v, apex, sn_tet_face[apex][n_above == 1 ? k : 2 - k]);
        return 3;
    }
    int p = next_outside(g, 0, true), q = next_outside(g, 0, false);
    int p2 = next_outside(g, p + 1, true), q2 = next_outside(g, q + 1, false);
    bool is_odd = (p > q) ^ (p > q2) ^ (p2 > q) ^ (p2 > q2); /* p, p2, q, q2 as a permutation */
    out[0] = crossing_point(g, v, p, q);
    out[is_odd ? 3 : 1] = crossing_point(g, v, p, q2);
    out[2] = crossing_point(g, v, p2, q2);
    out[is_odd ? 1 : 3] = crossing_point(g, v, p2, q);
    return 4;
}

static bool put_tet_polygon(sn_polygons *p, const sn_picture_scene *s, const sn_muscle_tets *m,
                            const int32_t v[4], int32_t muscle, sn_vec3 origin, const sn_bary *c, int32_t n)
{
    if (!begin_polygon(p, n)) return false;
    for (int32_t k = 0; k < n; k++) {
        sn_corner *out = &p->corner[p->n_corner++];
        *out = (sn_corner){.a = -1, .b = (int32_t)p->n_own, .muscle = muscle};
        if (c[k].i >= 0) {
            int32_t a = v[c[k].i], b = v[c[k].j];
            out->a = a < b ? a : b;
            out->b = a < b ? b : a;
            continue;
        }
        sn_vec3 normal[4];
        for (int q = 0; q < 4; q++) normal[q] = normal_at(m, v[q], muscle);
        if (!add_own(p, s, v, normal, 4, &c[k], muscle, origin)) return false;
    }
    return true;
}

bool sn_polygons_add_tet(sn_polygons *p, const sn_picture_scene *s, const sn_muscle_tets *m, int32_t i_sent,
                         sn_vec3 origin, sn_polygon_scratch *w)
{
    const int32_t *v = s->tets->tet + 4 * (size_t)m->tet[i_sent];
    const int32_t *muscle = m->cand.muscle + m->cand.first[i_sent];
    int32_t n_cand = (int32_t)(m->cand.first[i_sent + 1] - m->cand.first[i_sent]);
    for (int32_t i = 0; i < n_cand; i++)
        for (int k = 0; k < 4; k++) w->value[4 * i + k] = sn_muscle_above_fat(s, muscle[i], v[k]);
    for (int32_t i = 0; i < n_cand; i++) {
        int32_t n = zero_polygon(w->value + 4 * i, v, w->corner);
        for (int32_t j = 0; j < n_cand && n > 0; j++)
            if (j != i) n = clip(w, n, w->value + 4 * j);
        if (n > 0 && !put_tet_polygon(p, s, m, v, muscle[i], origin, w->corner, n)) return false;
    }
    return true;
}

/* ---- on a face of the border ---- */

/* Is muscle i nowhere above the others on the face? Of equal ones the first is seen. */
static bool is_beaten(const double *value, int32_t i, int32_t n)
{
    for (int32_t j = 0; j < n; j++) {
        const double *a = value + 4 * i, *b = value + 4 * j;
        bool is_less = j < i;
        if (j == i || b[0] < a[0] || b[1] < a[1] || b[2] < a[2]) continue;
        for (int k = 0; k < 3; k++) is_less = is_less || b[k] > a[k];
        if (is_less) return true;
    }
    return false;
}

/* Where muscle i wins: the face, less where g_i is below 0, less where another g is above it. */
static int32_t winning_polygon(sn_polygon_scratch *w, int32_t i, int32_t n_muscle)
{
    const double *own = w->value + 4 * i;
    double gap[4] = {-own[0], -own[1], -own[2], 0.0};
    for (int k = 0; k < 3; k++) w->corner[k] = (sn_bary){.w = {k == 0, k == 1, k == 2}, .i = k, .j = k};
    int32_t n = clip(w, 3, gap);
    for (int32_t j = 0; j < n_muscle && n > 0; j++) {
        if (j == i) continue;
        for (int k = 0; k < 3; k++) gap[k] = w->value[4 * j + k] - own[k];
        n = clip(w, n, gap);
    }
    return n;
}

static bool put_face_polygon(sn_polygons *p, const sn_picture_scene *s, const int32_t v[3],
                             const int16_t normal[9], int32_t muscle, sn_vec3 origin, const sn_bary *c,
                             int32_t n)
{
    if (!begin_polygon(p, n)) return false;
    for (int32_t k = 0; k < n; k++) {
        sn_corner *out = &p->corner[p->n_corner++];
        *out = (sn_corner){.a = -1, .b = (int32_t)p->n_own, .muscle = muscle};
        if (c[k].i >= 0 && c[k].i == c[k].j) {
            out->a = out->b = v[c[k].i];
            memcpy(out->normal, normal + 3 * c[k].i, sizeof out->normal);
            continue;
        }
        sn_vec3 at[3];
        for (int q = 0; q < 3; q++)
            at[q] = sn_v3_scale(1.0 / 32767.0, sn_v3(normal[3 * q], normal[3 * q + 1], normal[3 * q + 2]));
        if (!add_own(p, s, v, at, 3, &c[k], muscle, origin)) return false;
    }
    return true;
}

bool sn_polygons_add_face(sn_polygons *p, const sn_picture_scene *s, const sn_muscle_tets *m,
                          const sn_muscle_border *b, int32_t i_face, sn_vec3 origin, sn_polygon_scratch *w)
{
    const int32_t *v = b->vert + 3 * (size_t)i_face;
    int32_t n_muscle = sn_muscle_lists_merge(&m->above, v, 3, w->muscle);
    for (int32_t i = 0; i < n_muscle; i++) {
        for (int k = 0; k < 3; k++) w->value[4 * i + k] = sn_muscle_above_fat(s, w->muscle[i], v[k]);
        w->value[4 * i + 3] = 0.0;
    }
    for (int32_t i = 0; i < n_muscle; i++) {
        int32_t n = is_beaten(w->value, i, n_muscle) ? 0 : winning_polygon(w, i, n_muscle);
        if (n > 0 &&
            !put_face_polygon(p, s, v, b->normal + 9 * (size_t)i_face, w->muscle[i], origin, w->corner, n))
            return false;
    }
    return true;
}
