#include "field/cholesky.h"

#include "base/alloc.h"

#include <cblas.h>
#include <cholmod.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* OpenBLAS's own: not in every cblas.h. */
extern void openblas_set_num_threads(int n);
/* LAPACK, which OpenBLAS brings along without its header. */
extern void dposv_(const char *uplo, const int *n, const int *n_rhs, double *a, const int *lda, double *b,
                   const int *ldb, int *info);

struct sn_cholesky {
    cholmod_common common;
    cholmod_factor *symbolic; /* the analysis, for clones */
    cholmod_factor *factor;
    int32_t *number; /* n_row of the matrix */
    int32_t n, n_row;
};

static sn_status fail_by_status(const cholmod_common *c, const char *what, sn_error *err)
{
    if (c->status == CHOLMOD_OUT_OF_MEMORY) return sn_fail(err, SN_ENOMEM, "%s: no memory", what);
    if (c->status == CHOLMOD_TOO_LARGE) return sn_fail(err, SN_ESOLVE, "%s: the matrix is too large", what);
    return sn_fail(err, SN_ESOLVE, "%s: CHOLMOD failed with status %d", what, c->status);
}

/* The lower triangle of the numbered part, columns in order. Pattern only when values are not wanted. */
static cholmod_sparse *lower_part(sn_cholesky *c, const sn_csr *a, bool with_values)
{
    int64_t nnz = 0;
    for (int32_t i = 0; i < a->n; i++)
        for (int64_t k = a->ptr[i]; c->number[i] >= 0 && k < a->ptr[i + 1]; k++)
            nnz += c->number[a->idx[k]] >= c->number[i];
    cholmod_sparse *s = cholmod_l_allocate_sparse((size_t)c->n, (size_t)c->n, (size_t)nnz, 0, 1, -1,
                                                  with_values ? CHOLMOD_REAL : CHOLMOD_PATTERN, &c->common);
    int32_t *row_of = SN_NEW(int32_t, c->n);
    if (!s || !row_of) {
        if (s) cholmod_l_free_sparse(&s, &c->common);
        sn_release(row_of);
        return NULL;
    }
    for (int32_t i = 0; i < a->n; i++)
        if (c->number[i] >= 0) row_of[c->number[i]] = i;
    SuiteSparse_long *ptr = s->p, *idx = s->i, n = 0;
    double *val = s->x;
    for (int32_t j = 0; j < c->n; j++) {
        ptr[j] = n;
        for (int64_t k = a->ptr[row_of[j]]; k < a->ptr[row_of[j] + 1]; k++) {
            int32_t i = c->number[a->idx[k]];
            if (i < j) continue;
            idx[n] = i;
            if (with_values) val[n] = a->val[k];
            n++;
        }
    }
    ptr[c->n] = n;
    sn_release(row_of);
    return s;
}

/* CHOLMOD and OpenBLAS run on the caller's thread alone: with two threads OpenBLAS cuts its work elsewhere
 * and the last bits change, and CHOLMOD's own loops (four threads for many small ones) take 0.40 s where one
 * thread factorizes 108,000 unknowns in 0.18 s. Independent matrices are the parallelism. Returns what to
 * hand to use_threads_again. */
static int use_one_thread(void)
{
    int levels = omp_get_max_active_levels();
    openblas_set_num_threads(1);
    omp_set_max_active_levels(0);
    return levels;
}

static void use_threads_again(int levels)
{
    omp_set_max_active_levels(levels);
}

static void set_up(cholmod_common *c)
{
    cholmod_l_start(c);
    c->print = 0;
    c->supernodal = CHOLMOD_SUPERNODAL;
    c->nmethods = 1;
    c->postorder = 1;
}

static int by_rank(const void *a, const void *b)
{
    const int32_t *x = a, *y = b;
    if (x[0] != y[0]) return x[0] < y[0] ? -1 : 1;
    return (x[1] > y[1]) - (x[1] < y[1]);
}

/* The order of elimination that the ranks ask for; by sn_alloc. */
static SuiteSparse_long *order_by(const int32_t *rank, int32_t n)
{
    int32_t *pair = SN_NEW(int32_t, 2 * (size_t)n);
    SuiteSparse_long *order = SN_NEW(SuiteSparse_long, n);
    for (int32_t i = 0; pair && i < n; i++) {
        pair[2 * (size_t)i] = rank[i];
        pair[2 * (size_t)i + 1] = i;
    }
    if (pair) qsort(pair, (size_t)n, 2 * sizeof *pair, by_rank);
    for (int32_t i = 0; pair && order && i < n; i++) order[i] = pair[2 * (size_t)i + 1];
    if (!pair) {
        sn_release(order);
        order = NULL;
    }
    sn_release(pair);
    return order;
}

static sn_status analyse(sn_cholesky *c, cholmod_sparse *s, const int32_t *rank, sn_error *err)
{
    SuiteSparse_long *order = NULL;
    if (rank) {
        order = order_by(rank, c->n);
        if (!order) return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", c->n);
    }
    int levels = use_one_thread();
    c->symbolic = cholmod_l_analyze_p(s, order, NULL, 0, &c->common);
    use_threads_again(levels);
    sn_release(order);
    if (c->symbolic) c->factor = cholmod_l_copy_factor(c->symbolic, &c->common);
    return c->factor && c->common.status >= 0 ? SN_OK : fail_by_status(&c->common, "analysis", err);
}

static sn_status create(sn_cholesky **out, const sn_csr *a, const int32_t *number, int32_t n, int ordering,
                        const int32_t *rank, const sn_run *run, sn_error *err)
{
    *out = NULL;
    if (n < 1) return sn_fail(err, SN_EINVAL, "cholesky: the matrix has no rows");
    sn_cholesky *c = SN_NEW_ZERO(sn_cholesky, 1);
    if (!c) return sn_fail(err, SN_ENOMEM, "cholesky: no memory");
    set_up(&c->common);
    c->common.method[0].ordering = ordering;
    c->n = n;
    c->n_row = a->n;
    c->number = SN_NEW(int32_t, a->n);
    sn_status st = sn_run_step(run, "ordering the matrix", 0.0, err);
    cholmod_sparse *s = NULL;
    if (!st && !c->number) st = sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", a->n);
    if (!st) {
        memcpy(c->number, number, (size_t)a->n * sizeof *number);
        s = lower_part(c, a, false);
        if (!s) st = sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", n);
    }
    if (!st) st = analyse(c, s, rank, err);
    if (s) cholmod_l_free_sparse(&s, &c->common);
    if (!st) st = sn_run_step(run, "ordering the matrix", 1.0, err);
    if (st)
        sn_cholesky_destroy(c);
    else
        *out = c;
    return st;
}

sn_status sn_cholesky_create(sn_cholesky **out, const sn_csr *a, const int32_t *number, int32_t n,
                             const int32_t *rank, const sn_run *run, sn_error *err)
{
    return create(out, a, number, n, rank ? CHOLMOD_GIVEN : CHOLMOD_METIS, rank, run, err);
}

sn_status sn_cholesky_create_small(sn_cholesky **out, const sn_csr *a, const int32_t *number, int32_t n,
                                   const sn_run *run, sn_error *err)
{
    return create(out, a, number, n, CHOLMOD_AMD, NULL, run, err);
}

sn_status sn_cholesky_clone(sn_cholesky **out, const sn_cholesky *from, sn_error *err)
{
    *out = NULL;
    sn_cholesky *c = SN_NEW_ZERO(sn_cholesky, 1);
    if (!c) return sn_fail(err, SN_ENOMEM, "cholesky: no memory");
    set_up(&c->common);
    c->n = from->n;
    c->n_row = from->n_row;
    c->number = SN_NEW(int32_t, c->n_row);
    c->symbolic = cholmod_l_copy_factor(from->symbolic, &c->common);
    c->factor = cholmod_l_copy_factor(from->symbolic, &c->common);
    if (!c->number || !c->symbolic || !c->factor) {
        sn_cholesky_destroy(c);
        return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", from->n);
    }
    memcpy(c->number, from->number, (size_t)c->n_row * sizeof *c->number);
    *out = c;
    return SN_OK;
}

void sn_cholesky_order(const sn_cholesky *c, int32_t *rank)
{
    const SuiteSparse_long *perm = c->symbolic->Perm;
    for (int32_t k = 0; k < c->n; k++) rank[perm[k]] = k;
}

void sn_cholesky_destroy(sn_cholesky *c)
{
    if (!c) return;
    if (c->symbolic) cholmod_l_free_factor(&c->symbolic, &c->common);
    if (c->factor) cholmod_l_free_factor(&c->factor, &c->common);
    cholmod_l_finish(&c->common);
    sn_release(c->number);
    sn_release(c);
}

sn_status sn_cholesky_factorize(sn_cholesky *c, const sn_csr *a, const sn_run *run, sn_error *err)
{
    sn_status st = sn_run_step(run, "factorizing", 0.0, err);
    if (st) return st;
    cholmod_sparse *s = lower_part(c, a, true);
    if (!s) return sn_fail(err, SN_ENOMEM, "factorization: no memory for %d rows", c->n);
    int levels = use_one_thread();
    int ok = cholmod_l_factorize(s, c->factor, &c->common);
    use_threads_again(levels);
    cholmod_l_free_sparse(&s, &c->common);
    if (!ok || c->common.status < 0) return fail_by_status(&c->common, "factorization", err);
    if (c->common.status == CHOLMOD_NOT_POSDEF || c->factor->minor < c->factor->n)
        return sn_fail(err, SN_ESOLVE, "the matrix is not positive definite (column %zu of %d)",
                       c->factor->minor, c->n);
    return sn_run_step(run, "factorizing", 1.0, err);
}

/* With a workspace of its own, so that many threads may use one factor. */
sn_status sn_cholesky_solve(const sn_cholesky *c, double *x, int32_t n_rhs, const sn_run *run, sn_error *err)
{
    cholmod_dense b = {.nrow = (size_t)c->n,
                       .ncol = (size_t)n_rhs,
                       .nzmax = (size_t)c->n * (size_t)n_rhs,
                       .d = (size_t)c->n,
                       .x = x,
                       .xtype = CHOLMOD_REAL,
                       .dtype = CHOLMOD_DOUBLE};
    cholmod_dense *result = NULL;
    cholmod_common common;
    sn_status st = sn_run_step(run, "solving", -1.0, err);
    if (st) return st;
    set_up(&common);
    int levels = use_one_thread();
    result = cholmod_l_solve(CHOLMOD_A, c->factor, &b, &common);
    use_threads_again(levels);
    if (result && common.status >= 0)
        memcpy(x, result->x, b.nzmax * sizeof *x);
    else
        st = fail_by_status(&common, "solve", err);
    if (result) cholmod_l_free_dense(&result, &common);
    cholmod_l_finish(&common);
    return st;
}

/* ---- entries of the inverse ----
 *
 * With P A P' = L L' and E the wanted columns of the identity, E' A^-1 E = Y'Y where Y = L^-1 P E. A column
 * of Y is zero off the path from its unknown to the root, so Y is kept for the supernodes on some path only.
 */

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

static const SuiteSparse_long *supers(const half_solve *h)
{
    return h->f->super;
}

/* The supernode of the first row below supernode k; -1 at a root. */
static int32_t parent_of(const half_solve *h, int32_t k)
{
    const SuiteSparse_long *pi = h->f->pi, *row = h->f->s;
    SuiteSparse_long n_own = supers(h)[k + 1] - supers(h)[k];
    return pi[k + 1] - pi[k] > n_own ? h->super_of[row[pi[k] + n_own]] : -1;
}

/* Marks the paths, column by column: a supernode's columns of y are then an interval. */
static void mark_paths(half_solve *h, const int32_t *column)
{
    for (size_t k = 0; k < h->f->nsuper; k++) h->at[k] = -1;
    for (int32_t j = 0; j < h->n_col; j++)
        for (int32_t k = h->super_of[column[j]]; k >= 0; k = parent_of(h, k)) {
            if (h->at[k] < 0) h->first[k] = j;
            h->at[k] = 0;
            h->last[k] = j + 1;
        }
    const SuiteSparse_long *pi = h->f->pi;
    for (size_t k = 0; k < h->f->nsuper; k++) {
        if (h->at[k] < 0) continue;
        int64_t n_own = supers(h)[k + 1] - supers(h)[k], n_under = pi[k + 1] - pi[k] - n_own;
        h->at[k] = h->n_row;
        h->n_row += n_own;
        if (n_under > h->n_below) h->n_below = n_under;
    }
}

/* One supernode: y there := L_kk^-1 y there; what lies below is reduced by L_below times that. */
static void eliminate(half_solve *h, int32_t k)
{
    const SuiteSparse_long *pi = h->f->pi, *px = h->f->px, *row = h->f->s;
    int n_own = (int)(supers(h)[k + 1] - supers(h)[k]), n_all = (int)(pi[k + 1] - pi[k]);
    int n_under = n_all - n_own, n_col = h->last[k] - h->first[k];
    const double *l = (const double *)h->f->x + px[k];
    double *own = h->y + (size_t)h->first[k] * (size_t)h->n_row + h->at[k];
    cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, n_own, n_col, 1.0, l, n_all,
                own, (int)h->n_row);
    if (n_under == 0) return;
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, n_under, n_col, n_own, 1.0, l + n_own, n_all, own,
                (int)h->n_row, 0.0, h->below, n_under);
    for (int i = 0; i < n_under; i++) {
        SuiteSparse_long r = row[pi[k] + n_own + i];
        int32_t s = h->super_of[r];
        double *to = h->y + (size_t)h->first[k] * (size_t)h->n_row + h->at[s] + (r - supers(h)[s]);
        for (int j = 0; j < n_col; j++)
            to[(size_t)j * (size_t)h->n_row] -= h->below[(size_t)j * (size_t)n_under + (size_t)i];
    }
}

static sn_status half_solve_init(half_solve *h, const cholmod_factor *f, const int32_t *column, int32_t n_col,
                                 sn_error *err)
{
    *h = (half_solve){.f = f, .n_col = n_col};
    h->super_of = SN_NEW(int32_t, f->n);
    h->at = SN_NEW(int64_t, f->nsuper);
    h->first = SN_NEW(int32_t, f->nsuper);
    h->last = SN_NEW(int32_t, f->nsuper);
    if (!h->super_of || !h->at || !h->first || !h->last)
        return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %zu rows", f->n);
    for (size_t k = 0; k < f->nsuper; k++)
        for (SuiteSparse_long j = supers(h)[k]; j < supers(h)[k + 1]; j++) h->super_of[j] = (int32_t)k;
    mark_paths(h, column);
    if (h->n_row > INT32_MAX || h->n_below > INT32_MAX)
        return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %lld rows", (long long)h->n_row);
    h->y = sn_alloc_zero((size_t)h->n_row * (size_t)n_col, sizeof *h->y);
    h->below = sn_alloc((size_t)h->n_below * (size_t)n_col, sizeof *h->below);
    if (!h->y || !h->below)
        return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %lld x %d values", (long long)h->n_row,
                       n_col);
    for (int32_t j = 0; j < n_col; j++) {
        int32_t s = h->super_of[column[j]];
        h->y[(size_t)j * (size_t)h->n_row + (size_t)(h->at[s] + column[j] - supers(h)[s])] = 1.0;
    }
    return SN_OK;
}

/* The columns of the factor that hold these unknowns. */
static sn_status factor_columns(const cholmod_factor *f, const int32_t *index, int32_t n, int32_t *out,
                                sn_error *err)
{
    const SuiteSparse_long *perm = f->Perm;
    int32_t *column = SN_NEW(int32_t, f->n);
    if (!column) return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %zu rows", f->n);
    for (size_t j = 0; j < f->n; j++) column[perm[j]] = (int32_t)j;
    for (int32_t i = 0; i < n; i++) out[i] = column[index[i]];
    sn_release(column);
    return SN_OK;
}

sn_status sn_cholesky_inverse_block(const sn_cholesky *c, const int32_t *index, int32_t n_index,
                                    const sn_run *run, double *out, sn_error *err)
{
    half_solve h = {0};
    int32_t *column = SN_NEW(int32_t, n_index);
    sn_status st = column ? SN_OK : sn_fail(err, SN_ENOMEM, "cholesky: no memory");
    if (!st) st = factor_columns(c->factor, index, n_index, column, err);
    if (!st) st = half_solve_init(&h, c->factor, column, n_index, err);
    openblas_set_num_threads(1);
    for (size_t k = 0; !st && k < c->factor->nsuper; k++) {
        if (k % 256 == 0) st = sn_run_step(run, "solving", -1.0, err);
        if (!st && h.at[k] >= 0) eliminate(&h, (int32_t)k);
    }
    if (!st) {
        cblas_dsyrk(CblasColMajor, CblasUpper, CblasTrans, n_index, (int)h.n_row, 1.0, h.y, (int)h.n_row, 0.0,
                    out, n_index);
        for (int32_t i = 0; i < n_index; i++)
            for (int32_t j = 0; j < i; j++)
                out[(size_t)j * (size_t)n_index + (size_t)i] = out[(size_t)i * (size_t)n_index + (size_t)j];
    }
    half_solve_free(&h);
    sn_release(column);
    return st;
}

int64_t sn_cholesky_factor_entries(const sn_cholesky *c)
{
    return c->factor && c->factor->is_super ? (int64_t)c->factor->xsize : 0;
}

sn_status sn_dense_solve_spd(double *a, int32_t n, double *x, int32_t n_rhs, sn_error *err)
{
    int info = 0;
    openblas_set_num_threads(1);
    dposv_("L", &n, &n_rhs, a, &n, x, &n, &info);
    if (info == 0) return SN_OK;
    return sn_fail(err, SN_ESOLVE, "the dense matrix is not positive definite (column %d of %d)", info, n);
}
