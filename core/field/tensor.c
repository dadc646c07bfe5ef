#include "field/tensor.h"

#include "base/alloc.h"

#include <string.h>

#define CANCELLED 1e-9 /* of a unit vector: less is no direction, or too far from the curves to matter */

static sn_vec3 row_point(const sn_tet_mesh *m, const sn_collocation *c, int32_t row)
{
    sn_vec3 p = {0};
    for (int k = 0; k < 4; k++)
        p = sn_v3_mad(p, c->bary[4 * (size_t)row + (size_t)k],
                      sn_tet_mesh_point(m, m->tet[4 * (size_t)c->tet[row] + (size_t)k]));
    return p;
}

static int32_t nearest_row(const sn_vec3 *row_at, int32_t n_row, sn_vec3 p)
{
    int32_t best = 0;
    for (int32_t r = 1; r < n_row; r++)
        if (sn_v3_len2(sn_v3_sub(row_at[r], p)) < sn_v3_len2(sn_v3_sub(row_at[best], p))) best = r;
    return best;
}

/* The vertices of crossed tets, ascending: first those that the harmonic functions may be given at, then
 * those where these are 0. */
static sn_status find_fixed(const sn_tet_mesh *m, const sn_harmonic *h, const sn_collocation *c,
                            int32_t **out, int32_t *n_free, int32_t *n, sn_error *err)
{
    const int32_t *number = sn_harmonic_numbers(h);
    bool *is_fixed = SN_NEW_ZERO(bool, m->n_vert);
    *n_free = *n = 0;
    *out = SN_NEW(int32_t, 4 * (size_t)c->n_row);
    if (!is_fixed || !*out) {
        sn_release(is_fixed);
        return sn_fail(err, SN_ENOMEM, "frames: no memory for %d vertices", m->n_vert);
    }
    for (int32_t r = 0; r < c->n_row; r++)
        for (int k = 0; k < 4; k++) is_fixed[m->tet[4 * (size_t)c->tet[r] + (size_t)k]] = true;
    for (int32_t v = 0; v < m->n_vert; v++)
        if (is_fixed[v] && number[v] >= 0) (*out)[(*n_free)++] = v;
    *n = *n_free;
    for (int32_t v = 0; v < m->n_vert; v++)
        if (is_fixed[v] && number[v] < 0) (*out)[(*n)++] = v;
    sn_release(is_fixed);
    return SN_OK;
}

/* e1 and e2: e3 follows from them in the end, so its three fields are left out. */
enum { n_entry = 6 };

static void put_entries(sn_triad f, double *at, size_t stride)
{
    const sn_vec3 axis[2] = {f.e1, f.e2};
    for (size_t k = 0; k < 2; k++) {
        at[3 * k * stride] = axis[k].x;
        at[(3 * k + 1) * stride] = axis[k].y;
        at[(3 * k + 2) * stride] = axis[k].z;
    }
}

/* Gram-Schmidt, e1 first: it is the direction that matters most. false when there is none. */
static bool orthonormal(const double *at, size_t stride, sn_triad *out)
{
    sn_vec3 axis[2];
    for (size_t k = 0; k < 2; k++)
        axis[k] = sn_v3(at[3 * k * stride], at[(3 * k + 1) * stride], at[(3 * k + 2) * stride]);
    if (!(sn_v3_len(axis[0]) > CANCELLED)) return false;
    sn_vec3 e1 = sn_v3_unit(axis[0]), e2 = sn_v3_mad(axis[1], -sn_v3_dot(axis[1], e1), e1);
    if (!(sn_v3_len(e2) > CANCELLED)) return false;
    e2 = sn_v3_unit(e2);
    *out = (sn_triad){e1, e2, sn_v3_cross(e1, e2)};
    return true;
}

typedef struct spread {              /* what is known of the curves, and the fields */
    int32_t *fixed, n_free, n_fixed; /* as find_fixed leaves them */
    sn_vec3 *row_at;
    sn_triad *row_frame;
    double *value, *field; /* n_free and n_vert x n_entry; column-major */
} spread;

static void spread_free(spread *s)
{
    sn_release(s->fixed);
    sn_release(s->row_at);
    sn_release(s->row_frame);
    sn_release(s->value);
    sn_release(s->field);
}

static sn_status spread_init(spread *s, const sn_harmonic *h, const sn_tet_mesh *m, const sn_collocation *c,
                             const sn_paths *paths, sn_error *err)
{
    sn_status st = find_fixed(m, h, c, &s->fixed, &s->n_free, &s->n_fixed, err);
    if (st) return st;
    s->row_at = SN_NEW(sn_vec3, c->n_row);
    s->row_frame = SN_NEW(sn_triad, c->n_row);
    s->value = SN_NEW(double, n_entry *(size_t)s->n_free);
    s->field = SN_NEW_ZERO(double, n_entry *(size_t)m->n_vert);
    if (!s->row_at || !s->row_frame || !s->value || !s->field)
        return sn_fail(err, SN_ENOMEM, "frames: no memory for %d vertices", m->n_vert);
    for (int32_t r = 0; r < c->n_row; r++) {
        s->row_at[r] = row_point(m, c, r);
        s->row_frame[r] = sn_path_frame(&paths->head[c->head[r]], c->arc[r]);
    }
    for (int32_t i = 0; i < s->n_free; i++) {
        sn_vec3 p = sn_tet_mesh_point(m, s->fixed[i]);
        put_entries(s->row_frame[nearest_row(s->row_at, c->n_row, p)], s->value + i, (size_t)s->n_free);
    }
    return SN_OK;
}

/* Where the functions are held at 0, the sum of those around, tet by tet. */
static void reach_held_vertices(const int32_t *number, const sn_tet_mesh *m, double *field)
{
    for (int32_t t = 0; t < m->n_tet; t++) {
        const int32_t *v = m->tet + 4 * (size_t)t;
        bool is_free[4];
        for (int k = 0; k < 4; k++) is_free[k] = number[v[k]] >= 0;
        if (is_free[0] && is_free[1] && is_free[2] && is_free[3]) continue;
        for (size_t e = 0; e < n_entry; e++) {
            double *f = field + e * (size_t)m->n_vert, sum = 0.0;
            for (int k = 0; k < 4; k++) sum += is_free[k] ? f[v[k]] : 0.0;
            for (int k = 0; k < 4; k++) f[v[k]] += is_free[k] ? 0.0 : sum;
        }
    }
}

sn_status sn_frame_field(const sn_harmonic *h, const sn_tet_mesh *m, const sn_collocation *row,
                         const sn_paths *paths, const sn_run *run, sn_triad *frame, sn_error *err)
{
    spread s = {0};
    sn_status st = spread_init(&s, h, m, row, paths, err);
    if (!st && s.n_free > 0)
        st = sn_harmonic_solve(h, s.fixed, s.n_free, s.value, n_entry, run, s.field, err);
    if (!st) {
        reach_held_vertices(sn_harmonic_numbers(h), m, s.field);
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(run))
        for (int32_t v = 0; v < m->n_vert; v++)
            if (!orthonormal(s.field + v, (size_t)m->n_vert, &frame[v])) frame[v] = s.row_frame[0];
        for (int32_t i = s.n_free; i < s.n_fixed; i++)
            frame[s.fixed[i]] =
                s.row_frame[nearest_row(s.row_at, row->n_row, sn_tet_mesh_point(m, s.fixed[i]))];
    }
    spread_free(&s);
    return st;
}

void sn_tensor_field(const sn_triad *frame, int32_t n_vert, const double eigenvalue[3], double *tensor)
{
    for (int32_t v = 0; v < n_vert; v++) {
        const sn_vec3 axis[3] = {frame[v].e1, frame[v].e2, frame[v].e3};
        double *a = tensor + 6 * (size_t)v;
        memset(a, 0, 6 * sizeof *a);
        for (int k = 0; k < 3; k++) {
            sn_vec3 e = axis[k], f = sn_v3_scale(eigenvalue[k], e);
            a[0] += f.x * e.x;
            a[1] += f.x * e.y;
            a[2] += f.x * e.z;
            a[3] += f.y * e.y;
            a[4] += f.y * e.z;
            a[5] += f.z * e.z;
        }
    }
}
