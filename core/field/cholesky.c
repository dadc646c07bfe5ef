#include "field/cholesky.h"

#include "base/alloc.h"
#include "field/cholesky_private.h"

#include <omp.h>
#include <string.h>

static sn_status fail_by_status(const cholmod_common *c, const char *what, sn_error *err)
{
    if (c->status == CHOLMOD_OUT_OF_MEMORY) return sn_fail(err, SN_ENOMEM, "%s: no memory", what);
    if (c->status == CHOLMOD_TOO_LARGE) return sn_fail(err, SN_ESOLVE, "%s: the matrix is too large", what);
    return sn_fail(err, SN_ESOLVE, "%s: CHOLMOD failed with status %d", what, c->status);
}

/* The lower triangle of the numbered part, columns in the order of the numbers. Pattern only when values are
 * not wanted. */
static cholmod_sparse *lower_part(sn_cholesky *c, const sn_csr *a, const int32_t *number, bool with_values)
{
    int64_t nnz = 0;
    for (int32_t i = 0; i < a->n; i++)
        for (int64_t k = a->ptr[i]; number[i] >= 0 && k < a->ptr[i + 1]; k++)
            nnz += number[a->idx[k]] >= number[i];
    cholmod_sparse *s = cholmod_l_allocate_sparse((size_t)c->n, (size_t)c->n, (size_t)nnz, 0, 1, -1,
                                                  with_values ? CHOLMOD_REAL : CHOLMOD_PATTERN, &c->common);
    int32_t *row_of = SN_NEW(int32_t, c->n);
    if (!s || !row_of) {
        if (s) cholmod_l_free_sparse(&s, &c->common);
        sn_release(row_of);
        return NULL;
    }
    for (int32_t i = 0; i < a->n; i++)
        if (number[i] >= 0) row_of[number[i]] = i;
    SuiteSparse_long *ptr = s->p, *idx = s->i, n = 0;
    double *val = s->x;
    for (int32_t j = 0; j < c->n; j++) {
        ptr[j] = n;
        for (int64_t k = a->ptr[row_of[j]]; k < a->ptr[row_of[j] + 1]; k++) {
            int32_t i = number[a->idx[k]];
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

/* CHOLMOD would permute each matrix given to it, twice: it is filled in the order of elimination instead. */
static sn_status find_places(sn_cholesky *c, const int32_t *number, sn_error *err)
{
    const SuiteSparse_long *perm = c->symbolic->Perm;
    int32_t *place_of = SN_NEW(int32_t, c->n);
    if (!place_of) return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", c->n);
    for (int32_t j = 0; j < c->n; j++) place_of[perm[j]] = j;
    for (int32_t i = 0; i < c->n_row; i++) c->place[i] = number[i] >= 0 ? place_of[number[i]] : -1;
    sn_release(place_of);
    return SN_OK;
}

static sn_status analyse(sn_cholesky *c, cholmod_sparse *s, sn_error *err)
{
    int levels = use_one_thread();
    c->symbolic = cholmod_l_analyze(s, &c->common);
    use_threads_again(levels);
    if (c->symbolic) c->factor = cholmod_l_copy_factor(c->symbolic, &c->common);
    return c->factor && c->common.status >= 0 ? SN_OK : fail_by_status(&c->common, "analysis", err);
}

static sn_status create(sn_cholesky **out, const sn_csr *a, const int32_t *number, int32_t n, int ordering,
                        const sn_run *run, sn_error *err)
{
    *out = NULL;
    if (n < 1) return sn_fail(err, SN_EINVAL, "cholesky: the matrix has no rows");
    sn_cholesky *c = SN_NEW_ZERO(sn_cholesky, 1);
    if (!c) return sn_fail(err, SN_ENOMEM, "cholesky: no memory");
    set_up(&c->common);
    c->common.method[0].ordering = ordering;
    c->n = n;
    c->n_row = a->n;
    c->place = SN_NEW(int32_t, a->n);
    sn_status st = sn_run_step(run, "ordering the matrix", 0.0, err);
    cholmod_sparse *s = st ? NULL : lower_part(c, a, number, false);
    if (!st && (!c->place || !s)) st = sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", n);
    if (!st) st = analyse(c, s, err);
    if (!st) st = find_places(c, number, err);
    if (s) cholmod_l_free_sparse(&s, &c->common);
    if (!st) st = sn_run_step(run, "ordering the matrix", 1.0, err);
    if (st)
        sn_cholesky_destroy(c);
    else
        *out = c;
    return st;
}

sn_status sn_cholesky_create(sn_cholesky **out, const sn_csr *a, const int32_t *number, int32_t n,
                             const sn_run *run, sn_error *err)
{
    return create(out, a, number, n, CHOLMOD_METIS, run, err);
}

sn_status sn_cholesky_create_small(sn_cholesky **out, const sn_csr *a, const int32_t *number, int32_t n,
                                   const sn_run *run, sn_error *err)
{
    return create(out, a, number, n, CHOLMOD_AMD, run, err);
}

sn_status sn_cholesky_clone(sn_cholesky **out, const sn_cholesky *from, sn_error *err)
{
    *out = NULL;
    sn_cholesky *c = SN_NEW_ZERO(sn_cholesky, 1);
    if (!c) return sn_fail(err, SN_ENOMEM, "cholesky: no memory");
    set_up(&c->common);
    c->n = from->n;
    c->n_row = from->n_row;
    c->place = SN_NEW(int32_t, c->n_row);
    c->symbolic = cholmod_l_copy_factor(from->symbolic, &c->common);
    c->factor = cholmod_l_copy_factor(from->symbolic, &c->common);
    if (!c->place || !c->symbolic || !c->factor) {
        sn_cholesky_destroy(c);
        return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", from->n);
    }
    memcpy(c->place, from->place, (size_t)c->n_row * sizeof *c->place);
    *out = c;
    return SN_OK;
}

void sn_cholesky_destroy(sn_cholesky *c)
{
    if (!c) return;
    if (c->symbolic) cholmod_l_free_factor(&c->symbolic, &c->common);
    if (c->factor) cholmod_l_free_factor(&c->factor, &c->common);
    cholmod_l_finish(&c->common);
    sn_release(c->place);
    sn_release(c);
}

sn_status sn_cholesky_factorize(sn_cholesky *c, const sn_csr *a, const sn_run *run, sn_error *err)
{
    sn_status st = sn_run_step(run, "factorizing", 0.0, err);
    if (st) return st;
    cholmod_sparse *s = lower_part(c, a, c->place, true);
    if (!s) return sn_fail(err, SN_ENOMEM, "factorization: no memory for %d rows", c->n);
    int levels = use_one_thread();
    double none[2] = {0.0, 0.0};
    int ok = cholmod_l_super_numeric(s, NULL, none, c->factor, &c->common);
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

int64_t sn_cholesky_factor_entries(const sn_cholesky *c)
{
    return c->factor && c->factor->is_super ? (int64_t)c->factor->xsize : 0;
}
