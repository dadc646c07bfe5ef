#include "field/cholesky.h"

#include "base/alloc.h"
#include "field/cholesky_order.h"

#include <math.h>
#include <string.h>

/* Takes the order over, also on error. */
static sn_status create_on(sn_cholesky **out, sn_order *order, sn_error *err)
{
    *out = NULL;
    sn_cholesky *c = SN_NEW_ZERO(sn_cholesky, 1);
    if (!c) {
        sn_order_leave(order);
        return sn_fail(err, SN_ENOMEM, "cholesky: no memory");
    }
    sn_cholmod_start(&c->common);
    c->order = order;
    c->val = SN_NEW(double, (size_t)order->ptr[order->n]);
    c->factor = cholmod_l_copy_factor(order->symbolic, &c->common);
    if (!c->val || !c->factor) {
        sn_status st = sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", order->n);
        sn_cholesky_destroy(c); /* and with it the order, when nobody else has it */
        return st;
    }
    *out = c;
    return SN_OK;
}

sn_status sn_cholesky_create(sn_cholesky **out, const sn_csr *a, const int32_t *number, int32_t n,
                             const sn_run *run, sn_error *err)
{
    sn_order *order;
    *out = NULL;
    sn_status st = sn_order_create(&order, a, number, n, CHOLMOD_METIS, run, err);
    return st ? st : create_on(out, order, err);
}

sn_status sn_cholesky_create_small(sn_cholesky **out, const sn_csr *a, const int32_t *number, int32_t n,
                                   const sn_run *run, sn_error *err)
{
    sn_order *order;
    *out = NULL;
    sn_status st = sn_order_create(&order, a, number, n, CHOLMOD_AMD, run, err);
    return st ? st : create_on(out, order, err);
}

sn_status sn_cholesky_clone(sn_cholesky **out, const sn_cholesky *from, sn_error *err)
{
    sn_order_use(from->order);
    return create_on(out, from->order, err);
}

void sn_cholesky_destroy(sn_cholesky *c)
{
    if (!c) return;
    if (c->factor) cholmod_l_free_factor(&c->factor, &c->common);
    cholmod_l_finish(&c->common);
    sn_order_leave(c->order);
    sn_release(c->val);
    sn_release(c);
}

static cholmod_sparse lower_triangle(const sn_cholesky *c)
{
    const sn_order *o = c->order;
    return (cholmod_sparse){.nrow = (size_t)o->n,
                            .ncol = (size_t)o->n,
                            .nzmax = (size_t)o->ptr[o->n],
                            .p = o->ptr,
                            .i = o->idx,
                            .x = c->val,
                            .stype = -1,
                            .itype = CHOLMOD_LONG,
                            .xtype = CHOLMOD_REAL,
                            .dtype = CHOLMOD_DOUBLE,
                            .sorted = 1,
                            .packed = 1};
}

static void factorize(void *job)
{
    sn_cholesky *c = job;
    double none[2] = {0.0, 0.0};
    cholmod_sparse lower = lower_triangle(c);
    int levels = sn_cholmod_one_thread();
    if (!cholmod_l_super_numeric(&lower, NULL, none, c->factor, &c->common) && c->common.status >= 0)
        c->common.status = CHOLMOD_INVALID;
    sn_cholmod_threads_again(levels);
}

static void leave_factor(void *job)
{
    sn_cholesky_destroy(job);
}

/* What the factor is made in, when there is none. */
static sn_status need_room(sn_cholesky *c, sn_error *err)
{
    if (!c->val) c->val = SN_NEW(double, (size_t)c->order->ptr[c->order->n]);
    if (!c->factor) c->factor = cholmod_l_copy_factor(c->order->symbolic, &c->common);
    if (c->val && c->factor) return SN_OK;
    return sn_fail(err, SN_ENOMEM, "factorization: no memory for %d rows", c->order->n);
}

/* By a twin that has all that c has, and keeps it when it is left behind. */
static sn_status factorize_apart(sn_cholesky *c, const sn_run *run, sn_error *err)
{
    sn_cholesky *twin = SN_NEW(sn_cholesky, 1);
    if (!twin) return sn_fail(err, SN_ENOMEM, "factorization: no memory");
    *twin = *c;
    sn_order_use(c->order);
    sn_status st = sn_run_apart(run, "factorizing", factorize, leave_factor, twin, err);
    if (st) {
        c->factor = NULL;
        c->val = NULL;
        sn_cholmod_start(&c->common);
        return st;
    }
    *c = *twin;
    sn_order_leave(c->order);
    sn_release(twin);
    return SN_OK;
}

sn_status sn_cholesky_factorize(sn_cholesky *c, const sn_csr *a, const sn_run *run, sn_error *err)
{
    const sn_order *o = c->order;
    c->is_factorized = false;
    sn_status st = sn_run_step(run, "factorizing", 0.0, err);
    if (!st) st = need_room(c, err);
    for (SuiteSparse_long k = 0; !st && k < o->ptr[o->n]; k++) c->val[k] = a->val[o->from[k]];
    if (!st) st = factorize_apart(c, run, err);
    if (st) return st;
    if (c->common.status < 0) return sn_cholmod_fail(&c->common, "factorization", err);
    if (c->common.status == CHOLMOD_NOT_POSDEF || c->factor->minor < c->factor->n)
        return sn_fail(err, SN_ESOLVE, "the matrix is not positive definite (column %zu of %d)",
                       c->factor->minor, o->n);
    c->is_factorized = true;
    return sn_run_step(run, "factorizing", 1.0, err);
}

bool sn_cholesky_is_factorized(const sn_cholesky *c)
{
    return c->is_factorized;
}

/* With a workspace of its own, so that many threads may use one factor. */
sn_status sn_cholesky_solve(const sn_cholesky *c, double *x, int32_t n_rhs, const sn_run *run, sn_error *err)
{
    size_t n = (size_t)c->order->n;
    cholmod_dense b = {.nrow = n,
                       .ncol = (size_t)n_rhs,
                       .nzmax = n * (size_t)n_rhs,
                       .d = n,
                       .x = x,
                       .xtype = CHOLMOD_REAL,
                       .dtype = CHOLMOD_DOUBLE};
    cholmod_dense *result = NULL;
    cholmod_common common;
    sn_status st = sn_run_step(run, "solving", -1.0, err);
    if (st) return st;
    sn_cholmod_start(&common);
    int levels = sn_cholmod_one_thread();
    result = cholmod_l_solve(CHOLMOD_A, c->factor, &b, &common);
    sn_cholmod_threads_again(levels);
    if (result && common.status >= 0)
        memcpy(x, result->x, b.nzmax * sizeof *x);
    else
        st = sn_cholmod_fail(&common, "solve", err);
    if (result) cholmod_l_free_dense(&result, &common);
    cholmod_l_finish(&common);
    return st;
}

void sn_cholesky_add_product(const sn_cholesky *c, const double *x, double *y)
{
    const sn_order *o = c->order;
    const SuiteSparse_long *unknown = o->symbolic->Perm;
    for (int32_t j = 0; j < o->n; j++) {
        SuiteSparse_long u = unknown[j], k = o->ptr[j];
        double x_u = x[u], sum = c->val[k] * x_u; /* the diagonal comes first */
        for (k++; k < o->ptr[j + 1]; k++) {
            SuiteSparse_long v = unknown[o->idx[k]];
            sum += c->val[k] * x[v];
            y[v] += c->val[k] * x_u;
        }
        y[u] += sum;
    }
}

double sn_cholesky_rcond(const sn_cholesky *c)
{
    double least = INFINITY, most = 0.0;
    for (size_t k = 0; k < c->factor->nsuper; k++)
        for (int j = 0; j < sn_super_own(c->factor, k); j++) {
            double pivot =
                sn_super_block(c->factor, k)[(size_t)j * (size_t)sn_super_all(c->factor, k) + (size_t)j];
            least = fmin(least, pivot);
            most = fmax(most, pivot);
        }
    return (least / most) * (least / most);
}

int64_t sn_cholesky_factor_entries(const sn_cholesky *c)
{
    return c->factor && c->factor->is_super ? (int64_t)c->factor->xsize : 0;
}
