#include "skeleton/spread.h"

#include "base/alloc.h"

#include <math.h>
#include <string.h>

enum { max_iterations = 400 };
static const double RESIDUAL = 1e-6;     /* of the right-hand side                              */
static const double SMALLEST_COT = 0.02; /* obtuse faces count as a little: no weight is negative */

struct sn_spread {
    const double *weight;     /* of the current call                                 */
    double *cot;              /* 3 n_face: half the cotangent of each corner         */
    double *mass;             /* n_vert: a third of the area around it               */
    int32_t *face;            /* 3 n_face                                            */
    int32_t *start;           /* n_vert + 1: where the corners at a vertex begin     */
    int32_t *corner;          /* 3 n_face                                            */
    double *diag, *r, *p, *q; /* n_vert, 3 n_vert ...                            */
    double range2, edge;
    int32_t n_vert, n_face;
};

/* ---- the surface ---- */

static void face_weights(sn_spread *s, const sn_tri_mesh *m, int32_t f, double smallest)
{
    sn_vec3 p[3];
    for (int k = 0; k < 3; k++) p[k] = sn_tri_mesh_point(m, m->face[3 * (size_t)f + (size_t)k]);
    double area2 = sn_v3_len(sn_v3_cross(sn_v3_sub(p[1], p[0]), sn_v3_sub(p[2], p[0])));
    for (int k = 0; k < 3; k++) {
        sn_vec3 a = sn_v3_sub(p[(k + 1) % 3], p[k]), b = sn_v3_sub(p[(k + 2) % 3], p[k]);
        size_t c = 3 * (size_t)f + (size_t)k;
        s->cot[c] = area2 > smallest ? 0.5 * fmax(sn_v3_dot(a, b) / area2, SMALLEST_COT) : 0.0;
        s->mass[m->face[c]] += area2 / 6.0;
        s->edge += sn_v3_len(a);
    }
}

static void sort_corners(sn_spread *s)
{
    size_t n = 3 * (size_t)s->n_face;
    for (size_t c = 0; c < n; c++) s->start[s->face[c] + 1]++;
    for (int32_t v = 0; v < s->n_vert; v++) s->start[v + 1] += s->start[v];
    for (size_t c = 0; c < n; c++) s->corner[s->start[s->face[c]]++] = (int32_t)c;
    for (int32_t v = s->n_vert; v > 0; v--) s->start[v] = s->start[v - 1];
    s->start[0] = 0;
}

static void measure(sn_spread *s, const sn_tri_mesh *m)
{
    double diagonal = sn_box3_diagonal(sn_tri_mesh_bounds(m)), area = sn_tri_mesh_area(m);
    memcpy(s->face, m->face, 3 * (size_t)m->n_face * sizeof *s->face);
    for (int32_t f = 0; f < m->n_face; f++) face_weights(s, m, f, 1e-14 * diagonal * diagonal);
    s->edge /= 3.0 * m->n_face;
    for (int32_t v = 0; v < m->n_vert; v++) /* a vertex needs some mass, also one without a face */
        s->mass[v] = fmax(s->mass[v], 1e-6 * area / m->n_vert);
    sort_corners(s);
}

sn_status sn_spread_create(sn_spread **out, const sn_tri_mesh *m, sn_error *err)
{
    sn_spread *s = SN_NEW_ZERO(sn_spread, 1);
    size_t n = (size_t)m->n_vert, n_corner = 3 * (size_t)m->n_face;
    *out = NULL;
    if (!s || n_corner > INT32_MAX) {
        sn_release(s);
        return sn_fail(err, SN_ENOMEM, "no memory to spread over %d faces", m->n_face);
    }
    s->n_vert = m->n_vert;
    s->n_face = m->n_face;
    s->cot = SN_NEW(double, n_corner);
    s->face = SN_NEW(int32_t, n_corner);
    s->corner = SN_NEW(int32_t, n_corner);
    s->start = SN_NEW_ZERO(int32_t, n + 1);
    s->mass = SN_NEW_ZERO(double, n);
    s->diag = SN_NEW(double, n);
    s->r = SN_NEW(double, 3 * n);
    s->p = SN_NEW(double, 3 * n);
    s->q = SN_NEW(double, 3 * n);
    bool ok = s->cot && s->face && s->corner && s->start && s->mass && s->diag && s->r && s->p && s->q;
    if (!ok) {
        sn_spread_destroy(s);
        return sn_fail(err, SN_ENOMEM, "no memory to spread over %d faces", m->n_face);
    }
    measure(s, m);
    *out = s;
    return SN_OK;
}

void sn_spread_destroy(sn_spread *s)
{
    if (!s) return;
    void *all[] = {s->cot, s->mass, s->face, s->start, s->corner, s->diag, s->r, s->p, s->q};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) sn_release(all[i]);
    sn_release(s);
}

double sn_spread_edge(const sn_spread *s)
{
    return s->edge;
}

/* ---- the system: (weight mass + range^2 stiffness) u = weight mass wish ---- */

/* One row times x; *diag receives the entry on the diagonal. */
static sn_vec3 row_times(const sn_spread *s, int32_t v, const double *x, double *diag)
{
    double sum = s->weight[v] * s->mass[v];
    sn_vec3 own = sn_v3_load(x + 3 * (size_t)v), out = sn_v3_scale(sum, own);
    for (int32_t i = s->start[v]; i < s->start[v + 1]; i++) {
        int32_t c = s->corner[i], first = c - c % 3, b = first + (c + 1) % 3, d = first + (c + 2) % 3;
        const int32_t to[2] = {s->face[b], s->face[d]};
        const double w[2] = {s->range2 * s->cot[d], s->range2 * s->cot[b]}; /* across the edge to it */
        for (int k = 0; k < 2; k++) {
            out = sn_v3_mad(out, w[k], sn_v3_sub(own, sn_v3_load(x + 3 * (size_t)to[k])));
            sum += w[k];
        }
    }
    *diag = sum;
    return out;
}

static void times(sn_spread *s, const double *x, const sn_run *run, double *out)
{
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(run)) if (s->n_vert >= 2000)
    for (int32_t v = 0; v < s->n_vert; v++) sn_v3_store(out + 3 * (size_t)v, row_times(s, v, x, &s->diag[v]));
}

/* a' D^-1 b, or a' b without D; in the order of the vertices. */
static double product(const sn_spread *s, const double *a, const double *b, bool by_diag)
{
    double sum = 0.0;
    for (size_t v = 0; v < (size_t)s->n_vert; v++)
        sum += sn_v3_dot(sn_v3_load(a + 3 * v), sn_v3_load(b + 3 * v)) / (by_diag ? s->diag[v] : 1.0);
    return sum;
}

/* Residual and first direction for the start u; returns the size that the residual must fall to. */
static double begin(sn_spread *s, const double *wish, const sn_run *run, const double *u)
{
    double size = 0.0;
    times(s, u, run, s->r);
    for (size_t v = 0; v < (size_t)s->n_vert; v++)
        for (size_t i = 3 * v; i < 3 * v + 3; i++) {
            double b = s->weight[v] * s->mass[v] * wish[i];
            size += b * b / s->diag[v];
            s->r[i] = b - s->r[i];
            s->p[i] = s->r[i] / s->diag[v];
        }
    return RESIDUAL * RESIDUAL * size;
}

void sn_spread_apply(sn_spread *s, const double *wish, const double *weight, double range, const sn_run *run,
                     double *u)
{
    size_t n = 3 * (size_t)s->n_vert;
    s->weight = weight;
    s->range2 = range * range;
    double enough = begin(s, wish, run, u), rr = product(s, s->r, s->r, true);
    for (int k = 0; k < max_iterations && rr > enough && !sn_run_stopped(run); k++) {
        times(s, s->p, run, s->q);
        double step = rr / product(s, s->p, s->q, false), before = rr;
        for (size_t i = 0; i < n; i++) {
            u[i] += step * s->p[i];
            s->r[i] -= step * s->q[i];
        }
        rr = product(s, s->r, s->r, true);
        for (size_t i = 0; i < n; i++) s->p[i] = s->r[i] / s->diag[i / 3] + rr / before * s->p[i];
    }
    s->weight = NULL;
}
