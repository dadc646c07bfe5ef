#include "field/laplacian.h"

#include "base/alloc.h"

#include <string.h>

#define MAX_ROW 4096 /* neighbours of a vertex; a mesh with more is refused */

void sn_csr_free(sn_csr *a)
{
    sn_release(a->ptr);
    sn_release(a->idx);
    sn_release(a->val);
    memset(a, 0, sizeof *a);
}

int64_t sn_csr_find(const sn_csr *a, int32_t i, int32_t j)
{
    int64_t lo = a->ptr[i], hi = a->ptr[i + 1];
    while (lo < hi) {
        int64_t mid = lo + (hi - lo) / 2;
        if (a->idx[mid] < j)
            lo = mid + 1;
        else
            hi = mid;
    }
    return lo < a->ptr[i + 1] && a->idx[lo] == j ? lo : -1;
}

static inline double gradients(const sn_tet_mesh *m, int32_t i_tet, sn_vec3 grad[4])
{
    const int32_t *t = m->tet + 4 * (size_t)i_tet;
    sn_vec3 a = sn_tet_mesh_point(m, t[0]);
    sn_vec3 e1 = sn_v3_sub(sn_tet_mesh_point(m, t[1]), a), e2 = sn_v3_sub(sn_tet_mesh_point(m, t[2]), a);
    sn_vec3 e3 = sn_v3_sub(sn_tet_mesh_point(m, t[3]), a);
    double det = sn_v3_det(e1, e2, e3);
    grad[1] = sn_v3_scale(1.0 / det, sn_v3_cross(e2, e3));
    grad[2] = sn_v3_scale(1.0 / det, sn_v3_cross(e3, e1));
    grad[3] = sn_v3_scale(1.0 / det, sn_v3_cross(e1, e2));
    grad[0] = sn_v3_scale(-1.0, sn_v3_add(sn_v3_add(grad[1], grad[2]), grad[3]));
    return det / 6.0;
}

double sn_tet_gradients(const sn_tet_mesh *m, int32_t i_tet, sn_vec3 grad[4])
{
    return gradients(m, i_tet, grad);
}

void sn_assembly_free(sn_assembly *a)
{
    sn_release(a->slot);
    a->slot = NULL;
}

/* ---- pattern ---- */

typedef struct vertex_tets { /* the tets around v are tet[ptr[v]] .. tet[ptr[v + 1] - 1], ascending */
    int32_t *ptr, *tet;
} vertex_tets;

static void vertex_tets_free(vertex_tets *v)
{
    sn_release(v->ptr);
    sn_release(v->tet);
}

static sn_status find_around(vertex_tets *out, const sn_tet_mesh *m, sn_error *err)
{
    size_t n = 4 * (size_t)m->n_tet;
    out->ptr = SN_NEW_ZERO(int32_t, (size_t)m->n_vert + 2);
    out->tet = SN_NEW(int32_t, n);
    if (!out->ptr || !out->tet || n > INT32_MAX)
        return sn_fail(err, SN_ENOMEM, "laplacian: no memory for %d tets", m->n_tet);
    for (size_t k = 0; k < n; k++) out->ptr[m->tet[k] + 2]++;
    for (int32_t v = 0; v < m->n_vert; v++) out->ptr[v + 2] += out->ptr[v + 1];
    for (size_t k = 0; k < n; k++) out->tet[out->ptr[m->tet[k] + 1]++] = (int32_t)(k >> 2);
    return SN_OK;
}

/* The distinct vertices of the tets around v, v itself among them; -1 when there are too many. seen: n_vert,
 * the last vertex that met each. */
static int gather_row(const sn_tet_mesh *m, const vertex_tets *around, int32_t v, int32_t *seen,
                      int32_t row[MAX_ROW])
{
    int n = 0;
    for (int32_t i = around->ptr[v]; i < around->ptr[v + 1]; i++)
        for (int k = 0; k < 4; k++) {
            int32_t w = m->tet[4 * (size_t)around->tet[i] + (size_t)k];
            if (seen[w] == v + 1) continue;
            if (n == MAX_ROW) return -1;
            seen[w] = v + 1;
            row[n++] = w;
        }
    return n;
}

static void sort_row(int32_t *row, int n)
{
    for (int i = 1; i < n; i++) {
        int32_t w = row[i];
        int at = i;
        for (; at > 0 && row[at - 1] > w; at--) row[at] = row[at - 1];
        row[at] = w;
    }
}

/* Counts the rows (idx NULL) or fills them. seen: n_vert for each of n_part runs of vertices. */
static bool gather_rows(sn_csr *a, const sn_tet_mesh *m, const vertex_tets *around, int32_t *seen, int n_part)
{
    bool too_many = false;
    size_t n = (size_t)a->n;
    memset(seen, 0, n * (size_t)n_part * sizeof *seen);
#pragma omp parallel for schedule(static, 1) num_threads(n_part) reduction(|| : too_many)
    for (int p = 0; p < n_part; p++)
        for (size_t v = n * (size_t)p / (size_t)n_part; v < n * ((size_t)p + 1) / (size_t)n_part; v++) {
            int32_t row[MAX_ROW];
            int count = gather_row(m, around, (int32_t)v, seen + n * (size_t)p, row);
            too_many = too_many || count < 0;
            if (a->idx) {
                sort_row(row, count);
                memcpy(a->idx + a->ptr[v], row, (size_t)count * sizeof *row);
            } else {
                a->ptr[v + 1] = count;
            }
        }
    return !too_many;
}

static sn_status build_pattern(sn_csr *a, const sn_tet_mesh *m, const vertex_tets *around, const sn_run *run,
                               sn_error *err)
{
    int n_part = sn_run_threads(run);
    a->n = m->n_vert;
    a->ptr = SN_NEW(int64_t, (size_t)a->n + 1);
    int32_t *seen = SN_NEW(int32_t, (size_t)a->n * (size_t)n_part);
    sn_status st = SN_OK;
    if (!a->ptr || !seen) st = sn_fail(err, SN_ENOMEM, "laplacian: no memory for %d rows", a->n);
    if (!st && !gather_rows(a, m, around, seen, n_part))
        st = sn_fail(err, SN_EINVAL, "laplacian: a vertex has more than %d neighbours", MAX_ROW);
    if (!st) {
        a->ptr[0] = 0;
        for (int32_t v = 0; v < a->n; v++) a->ptr[v + 1] += a->ptr[v];
        a->idx = SN_NEW(int32_t, a->ptr[a->n]);
        a->val = SN_NEW(double, a->ptr[a->n]);
        if (a->idx && a->val)
            (void)gather_rows(a, m, around, seen, n_part);
        else
            st = sn_fail(err, SN_ENOMEM, "laplacian: no memory for %lld entries", (long long)a->ptr[a->n]);
    }
    sn_release(seen);
    return st;
}

static sn_status build_slots(sn_assembly *out, const sn_csr *a, const sn_tet_mesh *m, const sn_run *run,
                             sn_error *err)
{
    out->slot = SN_NEW(uint16_t, 16 * (size_t)m->n_tet);
    if (!out->slot) return sn_fail(err, SN_ENOMEM, "laplacian: no memory for %d tets", m->n_tet);
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(run))
    for (int32_t t = 0; t < m->n_tet; t++) {
        const int32_t *v = m->tet + 4 * (size_t)t;
        for (int k = 0; k < 16; k++)
            out->slot[16 * (size_t)t + (size_t)k] =
                (uint16_t)(sn_csr_find(a, v[k / 4], v[k % 4]) - a->ptr[v[k / 4]]);
    }
    return SN_OK;
}

/* ---- values ---- */

/* v with the mean tensor of a tet's corners applied. */
static sn_vec3 apply_tensor(const double a[6], sn_vec3 v)
{
    return sn_v3(a[0] * v.x + a[1] * v.y + a[2] * v.z, a[1] * v.x + a[3] * v.y + a[4] * v.z,
                 a[2] * v.x + a[4] * v.y + a[5] * v.z);
}

static void mean_tensor(const double *tensor, const int32_t *corner, double a[6])
{
    memset(a, 0, 6 * sizeof *a);
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < 6; i++) a[i] += 0.25 * tensor[6 * (size_t)corner[k] + (size_t)i];
}

/* The matrix of one tet: symmetric, its rows add up to zero. tensor: NULL for the identity. */
static inline void element(const sn_vec3 g[4], double weight, const double *tensor, double e[4][4])
{
    for (int i = 1; i < 4; i++) {
        sn_vec3 flow = sn_v3_scale(weight, tensor ? apply_tensor(tensor, g[i]) : g[i]);
        for (int k = 0; k < i; k++) e[i][k] = e[k][i] = sn_v3_dot(flow, g[k]);
    }
    e[0][0] = -(e[0][1] + e[0][2] + e[0][3]);
    e[1][1] = -(e[1][0] + e[1][2] + e[1][3]);
    e[2][2] = -(e[2][0] + e[2][1] + e[2][3]);
    e[3][3] = -(e[3][0] + e[3][1] + e[3][2]);
}

/* Tet by tet. tensor: NULL for the identity; share: NULL for 1. */
static void fill(sn_csr *a, const sn_assembly *s, const sn_tet_mesh *m, const double *tensor,
                 const double *share)
{
    double mean[6];
    memset(a->val, 0, (size_t)a->ptr[a->n] * sizeof *a->val);
    for (int32_t t = 0; t < m->n_tet; t++) {
        const int32_t *v = m->tet + 4 * (size_t)t;
        const uint16_t *slot = s->slot + 16 * (size_t)t;
        sn_vec3 g[4];
        double e[4][4],
            weight = gradients(m, t, g) / s->size; /* volume / size^3 * grad * size . grad * size */
        if (tensor) mean_tensor(tensor, v, mean);
        if (share) weight *= share[t];
        element(g, weight, tensor ? mean : NULL, e);
        for (int i = 0; i < 4; i++) {
            double *row = a->val + a->ptr[v[i]];
            for (int k = 0; k < 4; k++) row[slot[4 * i + k]] += e[i][k];
        }
    }
}

sn_status sn_laplacian_build(sn_csr *out, sn_assembly *assembly, const sn_tet_mesh *m, double size,
                             const sn_run *run, sn_error *err)
{
    vertex_tets around = {0};
    sn_csr_free(out);
    sn_assembly_free(assembly);
    assembly->size = size > 0.0 ? size : sn_box3_diagonal(sn_tet_mesh_bounds(m));
    sn_status st = sn_run_step(run, "assembling", 0.0, err);
    if (!st) st = find_around(&around, m, err);
    if (!st) st = sn_run_step(run, "assembling", 0.1, err);
    if (!st) st = build_pattern(out, m, &around, run, err);
    if (!st) st = sn_run_step(run, "assembling", 0.6, err);
    if (!st) st = build_slots(assembly, out, m, run, err);
    if (!st) st = sn_run_step(run, "assembling", 0.8, err);
    if (!st) fill(out, assembly, m, NULL, NULL);
    vertex_tets_free(&around);
    if (st) {
        sn_csr_free(out);
        sn_assembly_free(assembly);
    }
    return st;
}

void sn_laplacian_set_anisotropic(sn_csr *out, const sn_assembly *assembly, const sn_tet_mesh *m,
                                  const double *tensor)
{
    fill(out, assembly, m, tensor, NULL);
}

void sn_laplacian_set_weighted(sn_csr *out, const sn_assembly *assembly, const sn_tet_mesh *m,
                               const double *weight)
{
    fill(out, assembly, m, NULL, weight);
}
