/* What callers of the Cholesky solver ask of half solves: entries of the inverse, and single right-hand sides
 * with few entries. */
#include "base/alloc.h"
#include "base/dense.h"
#include "field/cholesky_private.h"
#include "field/half_solve.h"

#include <string.h>

sn_status sn_cholesky_inverse_block(const sn_cholesky *c, const int32_t *index, int32_t n_index,
                                    const sn_run *run, double *out, sn_error *err)
{
    sn_half_solve *h;
    sn_status st = sn_half_solve_create_units(&h, c, index, n_index, run, err);
    if (!st) sn_half_solve_gram(h, out);
    sn_half_solve_destroy(h);
    return st;
}

/* Columns one below another, as sn_half_solve_finish takes them; by sn_alloc. */
static double **columns_of(double *x, int32_t n, int32_t n_rhs)
{
    double **column = SN_NEW(double *, n_rhs);
    for (int32_t j = 0; column && j < n_rhs; j++) column[j] = x + (size_t)j * (size_t)n;
    return column;
}

sn_status sn_cholesky_solve_held(const sn_cholesky *c, const int32_t *index, int32_t n_index,
                                 const double *value, int32_t n_rhs, const sn_run *run, double *x,
                                 sn_error *err)
{
    sn_half_solve *h = NULL;
    size_t p = (size_t)n_index;
    double *block = SN_NEW(double, p *p), *source = SN_NEW(double, p *(size_t)n_rhs);
    double **column = columns_of(x, c->order->n, n_rhs);
    sn_status st = block && source && column
                       ? sn_half_solve_create_units(&h, c, index, n_index, run, err)
                       : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d values", n_index);
    if (!st) {
        sn_half_solve_gram(h, block);
        memcpy(source, value, p * (size_t)n_rhs * sizeof *source);
        st = sn_dense_solve_spd(block, n_index, source, n_rhs, err);
    }
    if (!st)
        st = sn_half_solve_finish(c, &(sn_half_term){h, source, n_index, NULL}, 1, n_rhs, column, NULL, run,
                                  err);
    sn_half_solve_destroy(h);
    sn_release(block);
    sn_release(source);
    sn_release(column);
    return st;
}

sn_status sn_cholesky_solve_few(const sn_cholesky *c, const int32_t *index, const double *value,
                                int32_t n_entry, const sn_run *run, double *x, sn_error *err)
{
    sn_half_solve *h;
    const int32_t ptr[2] = {0, n_entry};
    sn_status st = sn_half_solve_create(&h, c, &(sn_sparse_vectors){1, ptr, index, value}, run, err);
    if (!st) st = sn_half_solve_finish(c, &(sn_half_term){.y = h}, 1, 1, &x, NULL, run, err);
    sn_half_solve_destroy(h);
    return st;
}
