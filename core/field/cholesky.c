#include "field/cholesky.h"

#include "base/alloc.h"

#include <cholmod.h>
#include <string.h>

/* OpenBLAS has no header of its own for this in every package. */
extern void openblas_set_num_threads(int n);

struct sn_cholesky {
    cholmod_common common;
    cholmod_factor *factor;
    int32_t *number; /* n_row of the matrix */
    int32_t n, n_row;
    cholmod_dense *y, *e; /* workspaces of cholmod_l_solve2 */
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

/* With two threads OpenBLAS cuts its work elsewhere and the last bits change, while 43,000 unknowns are
 * factorized no faster (0.6 s). */
static void use_one_thread(void)
{
    openblas_set_num_threads(1);
}

static void set_up(cholmod_common *c)
{
    cholmod_l_start(c);
    c->print = 0;
    c->supernodal = CHOLMOD_SUPERNODAL;
    c->nmethods = 1;
    c->method[0].ordering = CHOLMOD_METIS;
    c->postorder = 1;
}

sn_status sn_cholesky_create(sn_cholesky **out, const sn_csr *a, const int32_t *number, int32_t n,
                             const sn_run *run, sn_error *err)
{
    *out = NULL;
    if (n < 1) return sn_fail(err, SN_EINVAL, "cholesky: the matrix has no rows");
    sn_cholesky *c = SN_NEW_ZERO(sn_cholesky, 1);
    if (!c) return sn_fail(err, SN_ENOMEM, "cholesky: no memory");
    set_up(&c->common);
    c->n = n;
    c->n_row = a->n;
    c->number = SN_NEW(int32_t, a->n);
    sn_status st = sn_run_step(run, "ordering the matrix", 0.0, err);
    cholmod_sparse *s = NULL;
    if (!st && !c->number) st = sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", a->n);
    if (!st) {
        memcpy(c->number, number, (size_t)a->n * sizeof *number);
        use_one_thread();
        s = lower_part(c, a, false);
        if (!s) st = sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", n);
    }
    if (!st) {
        c->factor = cholmod_l_analyze(s, &c->common);
        if (!c->factor || c->common.status < 0) st = fail_by_status(&c->common, "analysis", err);
    }
    if (s) cholmod_l_free_sparse(&s, &c->common);
    if (!st) st = sn_run_step(run, "ordering the matrix", 1.0, err);
    if (st)
        sn_cholesky_destroy(c);
    else
        *out = c;
    return st;
}

void sn_cholesky_destroy(sn_cholesky *c)
{
    if (!c) return;
    if (c->factor) cholmod_l_free_factor(&c->factor, &c->common);
    if (c->y) cholmod_l_free_dense(&c->y, &c->common);
    if (c->e) cholmod_l_free_dense(&c->e, &c->common);
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
    use_one_thread();
    int ok = cholmod_l_factorize(s, c->factor, &c->common);
    cholmod_l_free_sparse(&s, &c->common);
    if (!ok || c->common.status < 0) return fail_by_status(&c->common, "factorization", err);
    if (c->common.status == CHOLMOD_NOT_POSDEF || c->factor->minor < c->factor->n)
        return sn_fail(err, SN_ESOLVE, "the matrix is not positive definite (column %zu of %d)",
                       c->factor->minor, c->n);
    return sn_run_step(run, "factorizing", 1.0, err);
}

sn_status sn_cholesky_solve(sn_cholesky *c, double *x, int32_t n_rhs, const sn_run *run, sn_error *err)
{
    cholmod_dense b = {.nrow = (size_t)c->n,
                       .ncol = (size_t)n_rhs,
                       .nzmax = (size_t)c->n * (size_t)n_rhs,
                       .d = (size_t)c->n,
                       .x = x,
                       .xtype = CHOLMOD_REAL,
                       .dtype = CHOLMOD_DOUBLE};
    cholmod_dense *result = NULL;
    sn_status st = sn_run_step(run, "solving", -1.0, err);
    if (st) return st;
    use_one_thread();
    int ok = cholmod_l_solve2(CHOLMOD_A, c->factor, &b, NULL, &result, NULL, &c->y, &c->e, &c->common);
    if (!ok || !result || c->common.status < 0) {
        if (result) cholmod_l_free_dense(&result, &c->common);
        return fail_by_status(&c->common, "solve", err);
    }
    memcpy(x, result->x, b.nzmax * sizeof *x);
    cholmod_l_free_dense(&result, &c->common);
    return SN_OK;
}

int64_t sn_cholesky_factor_entries(const sn_cholesky *c)
{
    return c->factor && c->factor->is_super ? (int64_t)c->factor->xsize : 0;
}
