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

double sn_tet_gradients(const sn_tet_mesh *m, int32_t i_tet, sn_vec3 grad[4])
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

void sn_vertex_tets_free(sn_vertex_tets *v)
{
    sn_release(v->ptr);
    sn_release(v->tet);
    memset(v, 0, sizeof *v);
}

sn_status sn_vertex_tets_build(sn_vertex_tets *out, const sn_tet_mesh *m, sn_error *err)
{
    size_t n = 4 * (size_t)m->n_tet;
    memset(out, 0, sizeof *out);
    out->ptr = SN_NEW_ZERO(int32_t, (size_t)m->n_vert + 2);
    out->tet = SN_NEW(int32_t, n);
    if (!out->ptr || !out->tet || n > INT32_MAX) {
        sn_vertex_tets_free(out);
        return sn_fail(err, SN_ENOMEM, "laplacian: no memory for %d tets", m->n_tet);
    }
    for (size_t k = 0; k < n; k++) out->ptr[m->tet[k] + 2]++;
    for (int32_t v = 0; v < m->n_vert; v++) out->ptr[v + 2] += out->ptr[v + 1];
    for (size_t k = 0; k < n; k++) out->tet[out->ptr[m->tet[k] + 1]++] = (int32_t)(k >> 2);
    return SN_OK;
}

/* The distinct vertices of the tets around v, ascending, v itself among them; -1 when there are too many. */
static int gather_row(const sn_tet_mesh *m, const sn_vertex_tets *around, int32_t v, int32_t row[MAX_ROW])
{
    int n = 0;
    for (int32_t i = around->ptr[v]; i < around->ptr[v + 1]; i++)
        for (int k = 0; k < 4; k++) {
            int32_t w = m->tet[4 * (size_t)around->tet[i] + (size_t)k];
            int at = n;
            while (at > 0 && row[at - 1] > w) at--;
            if (at > 0 && row[at - 1] == w) continue;
            if (n == MAX_ROW) return -1;
            memmove(row + at + 1, row + at, (size_t)(n - at) * sizeof *row);
            row[at] = w;
            n++;
        }
    return n;
}

static sn_status build_pattern(sn_csr *a, const sn_tet_mesh *m, const sn_vertex_tets *around,
                               const sn_run *run, sn_error *err)
{
    bool too_many = false;
    a->n = m->n_vert;
    a->ptr = SN_NEW(int64_t, (size_t)a->n + 1);
    if (!a->ptr) return sn_fail(err, SN_ENOMEM, "laplacian: no memory for %d rows", a->n);
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(run)) reduction(|| : too_many)
    for (int32_t v = 0; v < a->n; v++) { /* count, then fill: the rows are cheap to find twice */
        int32_t row[MAX_ROW];
        int n = gather_row(m, around, v, row);
        too_many = too_many || n < 0;
        a->ptr[v + 1] = n;
    }
    if (too_many) return sn_fail(err, SN_EINVAL, "laplacian: a vertex has more than %d neighbours", MAX_ROW);
    a->ptr[0] = 0;
    for (int32_t v = 0; v < a->n; v++) a->ptr[v + 1] += a->ptr[v];
    a->idx = SN_NEW(int32_t, a->ptr[a->n]);
    a->val = SN_NEW_ZERO(double, a->ptr[a->n]);
    if (!a->idx || !a->val)
        return sn_fail(err, SN_ENOMEM, "laplacian: no memory for %lld entries", (long long)a->ptr[a->n]);
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(run))
    for (int32_t v = 0; v < a->n; v++) {
        int32_t row[MAX_ROW];
        int n = gather_row(m, around, v, row);
        memcpy(a->idx + a->ptr[v], row, (size_t)n * sizeof *row);
    }
    return SN_OK;
}

sn_status sn_laplacian_build(sn_csr *out, const sn_tet_mesh *m, const sn_run *run, sn_error *err)
{
    sn_vertex_tets around = {0};
    double size = sn_box3_diagonal(sn_tet_mesh_bounds(m));
    sn_csr_free(out);
    sn_status st = sn_run_step(run, "assembling", 0.0, err);
    if (!st) st = sn_vertex_tets_build(&around, m, err);
    if (!st) st = build_pattern(out, m, &around, run, err);
    if (!st) {
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(run))
        for (int32_t v = 0; v < out->n; v++)
            for (int32_t i = around.ptr[v]; i < around.ptr[v + 1]; i++) {
                sn_vec3 g[4];
                int32_t t = around.tet[i];
                const int32_t *c = m->tet + 4 * (size_t)t;
                double volume = sn_tet_gradients(m, t, g);
                int me = c[0] == v ? 0 : c[1] == v ? 1 : c[2] == v ? 2 : 3;
                for (int k = 0; k < 4; k++) /* volume / size^3 * grad * size . grad * size */
                    out->val[sn_csr_find(out, v, c[k])] += volume * sn_v3_dot(g[me], g[k]) / size;
            }
    }
    sn_vertex_tets_free(&around);
    if (st) sn_csr_free(out);
    return st;
}
