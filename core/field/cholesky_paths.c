/* Right-hand sides with few entries, and entries of the inverse.
 *
 * With P A P' = L L' and E some columns of the identity, E' A^-1 E = Y'Y where Y = L^-1 P E. A column of Y is
 * zero off the path from its unknown to the root of the elimination tree, so Y is kept for the supernodes on
 * some path only, and going forward costs next to nothing. */
#include "base/alloc.h"
#include "base/dense.h"
#include "field/cholesky_private.h"

#include <string.h>

typedef struct half_solve {
    const cholmod_factor *f;
    int32_t *super_of;      /* n: supernode of each column                          */
    int64_t *at;            /* n_super: first row in y, -1 when on no path          */
    int32_t *first, *last;  /* n_super: columns of y that may not be zero there     */
    double *y, *below;      /* n_row x n_col, and room for one product; column-major */
    int64_t n_row, n_below; /* most rows below a supernode on a path                */
    int32_t n_col;
} half_solve;

static void half_solve_free(half_solve *h)
{
    sn_release(h->super_of);
    sn_release(h->at);
    sn_release(h->first);
    sn_release(h->last);
    sn_release(h->y);
    sn_release(h->below);
}

static const SuiteSparse_long *supers(const cholmod_factor *f)
{
    return f->super;
}

static int n_own(const cholmod_factor *f, size_t k)
{
    return (int)(supers(f)[k + 1] - supers(f)[k]);
}

static int n_all(const cholmod_factor *f, size_t k)
{
    const SuiteSparse_long *pi = f->pi;
    return (int)(pi[k + 1] - pi[k]);
}

/* The rows of supernode k, its own first. */
static const SuiteSparse_long *rows_of(const cholmod_factor *f, size_t k)
{
    const SuiteSparse_long *pi = f->pi, *row = f->s;
    return row + pi[k];
}

/* n_all x n_own, column-major. */
static const double *block_of(const cholmod_factor *f, size_t k)
{
    const SuiteSparse_long *px = f->px;
    return (const double *)f->x + px[k];
}

/* The supernode of the first row below supernode k; -1 at a root. */
static int32_t parent_of(const half_solve *h, int32_t k)
{
    int own = n_own(h->f, (size_t)k);
    return n_all(h->f, (size_t)k) > own ? h->super_of[rows_of(h->f, (size_t)k)[own]] : -1;
}

/* Marks the paths of the columns, entry by entry: with an ascending column of y for each entry, a supernode's
 * columns of y are an interval. */
static void mark_paths(half_solve *h, const int32_t *column, const int32_t *y_of, int32_t n_entry)
{
    for (size_t k = 0; k < h->f->nsuper; k++) h->at[k] = -1;
    for (int32_t j = 0; j < n_entry; j++)
        for (int32_t k = h->super_of[column[j]]; k >= 0; k = parent_of(h, k)) {
            if (h->at[k] >= 0 && h->last[k] == y_of[j] + 1) break; /* so are all above */
            if (h->at[k] < 0) h->first[k] = y_of[j];
            h->at[k] = 0;
            h->last[k] = y_of[j] + 1;
        }
    for (size_t k = 0; k < h->f->nsuper; k++) {
        if (h->at[k] < 0) continue;
        int64_t own = n_own(h->f, k), under = n_all(h->f, k) - own;
        h->at[k] = h->n_row;
        h->n_row += own;
        if (under > h->n_below) h->n_below = under;
    }
}

/* One supernode: y there := L_kk^-1 y there; what lies below is reduced by L_below times that. */
static void eliminate(half_solve *h, size_t k)
{
    int own = n_own(h->f, k), all = n_all(h->f, k), under = all - own, n_col = h->last[k] - h->first[k];
    const SuiteSparse_long *row = rows_of(h->f, k) + own;
    const double *l = block_of(h->f, k);
    double *y = h->y + (size_t)h->first[k] * (size_t)h->n_row + h->at[k];
    cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, own, n_col, 1.0, l, all, y,
                (int)h->n_row);
    if (under == 0) return;
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, under, n_col, own, 1.0, l + own, all, y,
                (int)h->n_row, 0.0, h->below, under);
    for (int i = 0; i < under; i++) {
        int32_t s = h->super_of[row[i]];
        double *to = h->y + (size_t)h->first[k] * (size_t)h->n_row + h->at[s] + (row[i] - supers(h->f)[s]);
        for (int j = 0; j < n_col; j++)
            to[(size_t)j * (size_t)h->n_row] -= h->below[(size_t)j * (size_t)under + (size_t)i];
    }
}

static sn_status half_solve_init(half_solve *h, const cholmod_factor *f, int32_t n_col, sn_error *err)
{
    *h = (half_solve){.f = f, .n_col = n_col};
    h->super_of = SN_NEW(int32_t, f->n);
    h->at = SN_NEW(int64_t, f->nsuper);
    h->first = SN_NEW(int32_t, f->nsuper);
    h->last = SN_NEW(int32_t, f->nsuper);
    if (!h->super_of || !h->at || !h->first || !h->last)
        return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %zu rows", f->n);
    for (size_t k = 0; k < f->nsuper; k++)
        for (SuiteSparse_long j = supers(f)[k]; j < supers(f)[k + 1]; j++) h->super_of[j] = (int32_t)k;
    return SN_OK;
}

/* Y from entries of its right-hand side: value[j] (NULL: 1) in column y_of[j], ascending, at column[j] of the
 * factor. */
static sn_status go_forward(half_solve *h, const int32_t *column, const int32_t *y_of, const double *value,
                            int32_t n_entry, const sn_run *run, sn_error *err)
{
    mark_paths(h, column, y_of, n_entry);
    if (h->n_row > INT32_MAX || h->n_below > INT32_MAX)
        return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %lld rows", (long long)h->n_row);
    h->y = sn_alloc_zero((size_t)h->n_row * (size_t)h->n_col, sizeof *h->y);
    h->below = sn_alloc((size_t)h->n_below * (size_t)h->n_col, sizeof *h->below);
    if (!h->y || !h->below)
        return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %lld x %d values", (long long)h->n_row,
                       h->n_col);
    for (int32_t j = 0; j < n_entry; j++) {
        int32_t s = h->super_of[column[j]];
        size_t row = (size_t)(h->at[s] + column[j] - supers(h->f)[s]);
        h->y[(size_t)y_of[j] * (size_t)h->n_row + row] += value ? value[j] : 1.0;
    }
    for (size_t k = 0; k < h->f->nsuper; k++) {
        sn_status st = k % 256 == 0 ? sn_run_step(run, "solving", -1.0, err) : SN_OK;
        if (st) return st;
        if (h->at[k] >= 0) eliminate(h, k);
    }
    return SN_OK;
}

/* ---- all the way back ---- */

/* x := L'^-1 x, x: n x n_rhs, row-major, in the order of elimination. below: room for the rows below a
 * supernode. */
static void go_back(const cholmod_factor *f, double *x, int n_rhs, double *below)
{
    size_t r = (size_t)n_rhs;
    for (size_t k = f->nsuper; k-- > 0;) {
        int own = n_own(f, k), all = n_all(f, k), under = all - own;
        const SuiteSparse_long *row = rows_of(f, k) + own;
        const double *l = block_of(f, k);
        double *to = x + (size_t)supers(f)[k] * r;
        for (int i = 0; i < under; i++)
            memcpy(below + (size_t)i * r, x + (size_t)row[i] * r, r * sizeof *below);
        if (n_rhs == 1) {
            if (under > 0)
                cblas_dgemv(CblasColMajor, CblasTrans, under, own, -1.0, l + own, all, below, 1, 1.0, to, 1);
            cblas_dtrsv(CblasColMajor, CblasLower, CblasTrans, CblasNonUnit, own, l, all, to, 1);
            continue;
        }
        if (under > 0) /* L, column-major, is L' to these */
            cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, own, n_rhs, under, -1.0, l + own, all,
                        below, n_rhs, 1.0, to, n_rhs);
        cblas_dtrsm(CblasRowMajor, CblasLeft, CblasUpper, CblasNoTrans, CblasNonUnit, own, n_rhs, 1.0, l, all,
                    to, n_rhs);
    }
}

/* out := P' L'^-1 Y source; source: n_col x n_rhs, column-major, NULL: the identity. */
static sn_status finish(const half_solve *h, const double *source, int32_t n_rhs, double *out, sn_error *err)
{
    const cholmod_factor *f = h->f;
    const SuiteSparse_long *perm = f->Perm;
    size_t n = f->n, r = (size_t)n_rhs;
    double *x = SN_NEW_ZERO(double, n *r), *below = SN_NEW(double, f->maxesize *r);
    double *y = source ? SN_NEW(double, (size_t)h->n_row *r) : h->y;
    sn_status st = SN_OK;
    if (!x || !below || !y) st = sn_fail(err, SN_ENOMEM, "cholesky: no memory for %zu x %d values", n, n_rhs);
    if (!st && source)
        cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, (int)h->n_row, n_rhs, h->n_col, 1.0, h->y,
                    (int)h->n_row, source, h->n_col, 0.0, y, (int)h->n_row);
    for (size_t k = 0; !st && k < f->nsuper; k++)
        for (int i = 0; h->at[k] >= 0 && i < n_own(f, k); i++)
            for (size_t c = 0; c < r; c++)
                x[((size_t)supers(f)[k] + (size_t)i) * r + c] =
                    y[c * (size_t)h->n_row + (size_t)h->at[k] + (size_t)i];
    if (!st) go_back(f, x, n_rhs, below);
    for (size_t j = 0; !st && j < n; j++)
        for (size_t c = 0; c < r; c++) out[c * n + (size_t)perm[j]] = x[j * r + c];
    if (source) sn_release(y);
    sn_release(x);
    sn_release(below);
    return st;
}

/* ---- what callers ask for ---- */

/* The columns of the factor that hold these unknowns; by sn_alloc. */
static int32_t *factor_columns(const cholmod_factor *f, const int32_t *index, int32_t n)
{
    const SuiteSparse_long *perm = f->Perm;
    int32_t *column = SN_NEW(int32_t, f->n), *out = SN_NEW(int32_t, n);
    for (size_t j = 0; column && j < f->n; j++) column[perm[j]] = (int32_t)j;
    for (int32_t i = 0; column && out && i < n; i++) out[i] = column[index[i]];
    if (!column) {
        sn_release(out);
        out = NULL;
    }
    sn_release(column);
    return out;
}

/* Y for the columns of the identity. */
static sn_status forward_of_unknowns(half_solve *h, const sn_cholesky *c, const int32_t *index,
                                     int32_t n_index, const sn_run *run, sn_error *err)
{
    int32_t *column = factor_columns(c->factor, index, n_index), *y_of = SN_NEW(int32_t, n_index);
    sn_status st = column && y_of ? half_solve_init(h, c->factor, n_index, err)
                                  : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", c->n);
    for (int32_t j = 0; !st && j < n_index; j++) y_of[j] = j;
    openblas_set_num_threads(1);
    if (!st) st = go_forward(h, column, y_of, NULL, n_index, run, err);
    sn_release(column);
    sn_release(y_of);
    return st;
}

static void inner_products(const half_solve *h, double *out)
{
    int32_t n = h->n_col;
    cblas_dsyrk(CblasColMajor, CblasUpper, CblasTrans, n, (int)h->n_row, 1.0, h->y, (int)h->n_row, 0.0, out,
                n);
    for (int32_t i = 0; i < n; i++)
        for (int32_t j = 0; j < i; j++)
            out[(size_t)j * (size_t)n + (size_t)i] = out[(size_t)i * (size_t)n + (size_t)j];
}

sn_status sn_cholesky_inverse_block(const sn_cholesky *c, const int32_t *index, int32_t n_index,
                                    const sn_run *run, double *out, sn_error *err)
{
    half_solve h = {0};
    sn_status st = forward_of_unknowns(&h, c, index, n_index, run, err);
    if (!st) inner_products(&h, out);
    half_solve_free(&h);
    return st;
}

sn_status sn_cholesky_solve_held(const sn_cholesky *c, const int32_t *index, int32_t n_index,
                                 const double *value, int32_t n_rhs, const sn_run *run, double *x,
                                 sn_error *err)
{
    half_solve h = {0};
    size_t p = (size_t)n_index;
    double *block = SN_NEW(double, p *p), *source = SN_NEW(double, p *(size_t)n_rhs);
    sn_status st =
        block && source ? SN_OK : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d values", n_index);
    if (!st) st = forward_of_unknowns(&h, c, index, n_index, run, err);
    if (!st) {
        inner_products(&h, block);
        memcpy(source, value, p * (size_t)n_rhs * sizeof *source);
        st = sn_dense_solve_spd(block, n_index, source, n_rhs, err);
    }
    if (!st) st = finish(&h, source, n_rhs, x, err);
    half_solve_free(&h);
    sn_release(block);
    sn_release(source);
    return st;
}

sn_status sn_cholesky_solve_few(const sn_cholesky *c, const int32_t *index, const double *value,
                                int32_t n_entry, const sn_run *run, double *x, sn_error *err)
{
    half_solve h = {0};
    int32_t *column = factor_columns(c->factor, index, n_entry), *y_of = SN_NEW_ZERO(int32_t, n_entry);
    sn_status st = column && y_of ? half_solve_init(&h, c->factor, 1, err)
                                  : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", c->n);
    openblas_set_num_threads(1);
    if (!st) st = go_forward(&h, column, y_of, value, n_entry, run, err);
    if (!st) st = finish(&h, NULL, 1, x, err);
    half_solve_free(&h);
    sn_release(column);
    sn_release(y_of);
    return st;
}
