#include "extract/extract_private.h"

#include "base/alloc.h"

#include <math.h>
#include <string.h>

void xt_grid_free(xt_grid *g)
{
    sn_release(g->value);
    sn_release(g->winner);
    memset(g, 0, sizeof *g);
}

/* Range of all values; the first that is not finite is an error. */
static sn_status find_range(const double *value, const char *const *name, int32_t n_tissue, int32_t n_vert,
                            double *lo, double *hi, sn_error *err)
{
    *lo = INFINITY;
    *hi = -INFINITY;
    for (int32_t i = 0; i < n_tissue; i++)
        for (int32_t v = 0; v < n_vert; v++) {
            double x = value[(size_t)i * (size_t)n_vert + (size_t)v];
            if (!isfinite(x))
                return sn_fail(err, SN_EINVAL, "extract: value of '%s' at vertex %d is not finite", name[i],
                               v + 1);
            if (x < *lo) *lo = x;
            if (x > *hi) *hi = x;
        }
    return SN_OK;
}

sn_status xt_grid_build(xt_grid *g, const double *value, const char *const *name, int32_t n_tissue,
                        int32_t n_vert, const sn_run *run, sn_error *err)
{
    double lo, hi;
    memset(g, 0, sizeof *g);
    sn_status st = find_range(value, name, n_tissue, n_vert, &lo, &hi, err);
    if (st) return st;
    g->n_vert = n_vert;
    g->n_tissue = n_tissue;
    g->value = SN_NEW(int32_t, (size_t)n_vert * (size_t)n_tissue);
    g->winner = SN_NEW(int32_t, n_vert);
    if (!g->value || !g->winner) {
        xt_grid_free(g);
        return sn_fail(err, SN_ENOMEM, "extract: no memory for %d values at %d vertices", n_tissue, n_vert);
    }
    double half = 0.5 * hi - 0.5 * lo, mid = lo + half;
    double steps = half > 0.0 ? (double)((1 << (SN_GRID_BITS - 1)) - 1) / half : 0.0;
    if (!isfinite(steps)) steps = 0.0; /* a range below 1e-300: all equal */
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(run))
    for (int32_t v = 0; v < n_vert; v++) {
        int32_t *row = g->value + (size_t)v * (size_t)n_tissue, best = 0;
        for (int32_t i = 0; i < n_tissue; i++) {
            row[i] = (int32_t)rint((value[(size_t)i * (size_t)n_vert + (size_t)v] - mid) * steps);
            if (row[i] > row[best]) best = i;
        }
        g->winner[v] = best;
    }
    return SN_OK;
}

/* b is below a at every corner, ties by id. */
static bool dominates(const int32_t *const *row, int n_corner, int32_t a, int32_t b)
{
    for (int k = 0; k < n_corner; k++)
        if (sn_sign_above(row[k][a], a, row[k][b], b) < 0) return false;
    return true;
}

bool xt_candidates(const xt_grid *g, const int32_t *corner, int n_corner, xt_list *out)
{
    const int32_t *row[4];
    out->n = 0;
    for (int k = 0; k < n_corner; k++) row[k] = xt_row(g, corner[k]);
    for (int32_t j = 0; j < g->n_tissue; j++) {
        bool below = false;
        for (int k = 0; k < n_corner && !below; k++) {
            int32_t w = g->winner[corner[k]];
            below = w != j && dominates(row, n_corner, w, j);
        }
        if (below) continue;
        if (!sn_grow(&out->id, &out->cap, out->n + 1, sizeof *out->id)) return false;
        out->id[out->n++] = j;
    }
    size_t kept = 0; /* among each other: being dominated is transitive, so the order does not matter */
    for (size_t b = 0; b < out->n; b++) {
        bool below = false;
        for (size_t a = 0; a < out->n && !below; a++)
            below = a != b && dominates(row, n_corner, out->id[a], out->id[b]);
        if (!below) out->id[kept++] = out->id[b];
    }
    out->n = kept;
    return true;
}
