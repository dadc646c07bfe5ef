#include "field/half_solve_private.h"

#include "base/alloc.h"

#include <string.h>

#define CHUNK 48 /* most columns that go through the factor together */

void sn_half_solve_destroy(sn_half_solve *h)
{
    if (!h) return;
    sn_release(h->at);
    sn_release(h->first);
    sn_release(h->last);
    sn_release(h->step);
    sn_release(h->y);
    sn_release(h);
}

/* ---- paths ---- */

/* Marks the paths vector by vector: a supernode's columns of y are an interval. */
static void mark_paths(sn_half_solve *h, const sn_sparse_vectors *b)
{
    const sn_order *o = h->c->order;
    for (size_t k = 0; k < h->c->factor->nsuper; k++) h->at[k] = -1;
    for (int32_t j = 0; j < b->n; j++)
        for (int32_t e = b->ptr[j]; e < b->ptr[j + 1]; e++)
            for (int32_t k = o->super_of[o->column_of[b->index[e]]]; k >= 0; k = o->tree.parent[k]) {
                if (h->at[k] >= 0 && h->last[k] == j + 1) break; /* so are all above */
                if (h->at[k] < 0) h->first[k] = j;
                h->at[k] = 0;
                h->last[k] = j + 1;
            }
}

static sn_status lay_out(sn_half_solve *h, sn_error *err)
{
    const cholmod_factor *f = h->c->factor;
    for (size_t k = 0; k < f->nsuper; k++) h->n_step += h->at[k] >= 0;
    h->step = SN_NEW(int32_t, h->n_step);
    if (!h->step) return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d supernodes", h->n_step);
    h->n_step = 0;
    for (size_t k = 0; k < f->nsuper; k++) {
        if (h->at[k] < 0) continue;
        int32_t own = sn_super_own(f, k), below = sn_super_all(f, k) - own;
        h->at[k] = h->n_row;
        h->n_row += own;
        h->step[h->n_step++] = (int32_t)k;
        if (below > h->n_below) h->n_below = below;
    }
    if (h->n_row <= INT32_MAX) h->y = sn_alloc_zero((size_t)h->n_row * (size_t)h->n_col, sizeof *h->y);
    if (h->y) return SN_OK;
    return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %lld x %d values", (long long)h->n_row, h->n_col);
}

/* The value of a row (a column of the factor) in column j of y. */
static double *place_in(const sn_half_solve *h, int32_t row, int32_t j)
{
    int32_t s = h->c->order->super_of[row];
    return h->y + (size_t)j * (size_t)h->n_row + h->at[s] + (row - sn_supers(h->c->factor)[s]);
}

/* ---- forward ---- */

/* One supernode, columns from..to of y: y there := L_kk^-1 y there; what lies below is reduced by L_below
 * times that. */
static void eliminate(sn_half_solve *h, size_t k, int32_t from, int32_t to, double *below)
{
    const cholmod_factor *f = h->c->factor;
    int own = sn_super_own(f, k), all = sn_super_all(f, k), under = all - own, n_col = to - from;
    const SuiteSparse_long *row = sn_super_rows(f, k) + own;
    const double *l = sn_super_block(f, k);
    double *y = h->y + (size_t)from * (size_t)h->n_row + h->at[k];
    if (n_col == 1)
        cblas_dtrsv(CblasColMajor, CblasLower, CblasNoTrans, CblasNonUnit, own, l, all, y, 1);
    else
        cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, own, n_col, 1.0, l, all,
                    y, (int)h->n_row);
    if (under == 0) return;
    if (n_col == 1)
        cblas_dgemv(CblasColMajor, CblasNoTrans, under, own, 1.0, l + own, all, y, 1, 0.0, below, 1);
    else
        cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, under, n_col, own, 1.0, l + own, all, y,
                    (int)h->n_row, 0.0, below, under);
    for (int i = 0; i < under; i++) {
        double *at = place_in(h, (int32_t)row[i], from);
        for (int j = 0; j < n_col; j++)
            at[(size_t)j * (size_t)h->n_row] -= below[(size_t)j * (size_t)under + (size_t)i];
    }
}

typedef struct forward {
    sn_half_solve *h;
    int32_t n_chunk;
    double *below; /* n_below x n_col */
} forward;

static sn_status go_forward(void *user, int32_t i_chunk, const sn_run *run, sn_error *err)
{
    const forward *f = user;
    sn_half_solve *h = f->h;
    int32_t from = (int32_t)((int64_t)h->n_col * i_chunk / f->n_chunk),
            to = (int32_t)((int64_t)h->n_col * (i_chunk + 1) / f->n_chunk);
    sn_status st = SN_OK;
    for (int32_t s = 0; !st && s < h->n_step; s++) {
        int32_t k = h->step[s];
        int32_t first = h->first[k] > from ? h->first[k] : from, last = h->last[k] < to ? h->last[k] : to;
        if (s % 256 == 0) st = sn_run_step(run, "solving", -1.0, err);
        if (!st && first < last)
            eliminate(h, (size_t)k, first, last, f->below + (size_t)from * (size_t)h->n_below);
    }
    return st;
}

/* As even as may be, and an even number for two threads; the same for any number of threads, as BLAS may
 * round a column otherwise when others stand beside it. */
static int32_t count_chunks(int32_t n)
{
    int32_t n_chunk = (n + CHUNK - 1) / CHUNK;
    return n > 8 ? n_chunk + n_chunk % 2 : n_chunk;
}

/* All room is made by the caller's thread: what threads that come and go ask for is new to them each time. */
static sn_status run_forward(sn_half_solve *h, const sn_run *run, sn_error *err)
{
    forward f = {h, count_chunks(h->n_col), SN_NEW(double, (size_t)h->n_below *(size_t)h->n_col)};
    if (!f.below) return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", h->n_below);
    openblas_set_num_threads(1);
    sn_status st = sn_run_each(run, f.n_chunk, go_forward, &f, err);
    sn_release(f.below);
    return st;
}

sn_status sn_half_solve_create(sn_half_solve **out, const sn_cholesky *c, const sn_sparse_vectors *b,
                               const sn_run *run, sn_error *err)
{
    *out = NULL;
    sn_half_solve *h = SN_NEW_ZERO(sn_half_solve, 1);
    if (!h) return sn_fail(err, SN_ENOMEM, "cholesky: no memory");
    h->c = c;
    h->n_col = b->n;
    h->at = SN_NEW(int64_t, c->factor->nsuper);
    h->first = SN_NEW(int32_t, c->factor->nsuper);
    h->last = SN_NEW(int32_t, c->factor->nsuper);
    sn_status st = h->at && h->first && h->last
                       ? SN_OK
                       : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", c->order->n);
    if (!st) mark_paths(h, b);
    if (!st) st = lay_out(h, err);
    for (int32_t j = 0; !st && j < b->n; j++)
        for (int32_t e = b->ptr[j]; e < b->ptr[j + 1]; e++)
            *place_in(h, c->order->column_of[b->index[e]], j) += b->value[e];
    if (!st) st = run_forward(h, run, err);
    if (st)
        sn_half_solve_destroy(h);
    else
        *out = h;
    return st;
}

sn_status sn_half_solve_create_units(sn_half_solve **out, const sn_cholesky *c, const int32_t *index,
                                     int32_t n, const sn_run *run, sn_error *err)
{
    int32_t *ptr = SN_NEW(int32_t, (size_t)n + 1);
    double *one = SN_NEW(double, n);
    *out = NULL;
    sn_status st = ptr && one ? SN_OK : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d columns", n);
    for (int32_t j = 0; !st && j <= n; j++) ptr[j] = j;
    for (int32_t j = 0; !st && j < n; j++) one[j] = 1.0;
    if (!st) st = sn_half_solve_create(out, c, &(sn_sparse_vectors){n, ptr, index, one}, run, err);
    sn_release(ptr);
    sn_release(one);
    return st;
}

int32_t sn_half_solve_count(const sn_half_solve *h)
{
    return h->n_col;
}

/* ---- products ---- */

void sn_half_solve_gram(const sn_half_solve *h, double *out)
{
    int32_t n = h->n_col;
    openblas_set_num_threads(1);
    cblas_dsyrk(CblasColMajor, CblasUpper, CblasTrans, n, (int)h->n_row, 1.0, h->y, (int)h->n_row, 0.0, out,
                n);
    for (int32_t i = 0; i < n; i++)
        for (int32_t j = 0; j < i; j++)
            out[(size_t)j * (size_t)n + (size_t)i] = out[(size_t)i * (size_t)n + (size_t)j];
}

void sn_half_solve_product(const sn_half_solve *y, const sn_half_solve *z, double *out)
{
    const cholmod_factor *f = y->c->factor;
    memset(out, 0, (size_t)y->n_col * (size_t)z->n_col * sizeof *out);
    openblas_set_num_threads(1);
    for (int32_t s = 0; s < y->n_step; s++) {
        size_t k = (size_t)y->step[s];
        if (z->at[k] < 0) continue;
        cblas_dgemm(CblasColMajor, CblasTrans, CblasNoTrans, y->last[k] - y->first[k],
                    z->last[k] - z->first[k], sn_super_own(f, k), 1.0,
                    y->y + (size_t)y->first[k] * (size_t)y->n_row + y->at[k], (int)y->n_row,
                    z->y + (size_t)z->first[k] * (size_t)z->n_row + z->at[k], (int)z->n_row, 1.0,
                    out + (size_t)z->first[k] * (size_t)y->n_col + y->first[k], y->n_col);
    }
}
