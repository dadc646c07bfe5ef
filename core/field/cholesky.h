/* cholesky.h - sparse Cholesky of symmetric positive definite matrices: analyse once, factorize often, solve
 * many right-hand sides together. The only part of the library that sees CHOLMOD (its 64-bit interface, METIS
 * ordering, supernodal). */
#ifndef SN_FIELD_CHOLESKY_H
#define SN_FIELD_CHOLESKY_H

#include "base/run.h"
#include "field/laplacian.h"

#include <stdbool.h>

typedef struct sn_cholesky sn_cholesky; /* opaque; const = may be used by many threads */

/* Orders and analyses the rows and columns of a with number[i] >= 0, where number maps them one to one onto
 * 0..n-1; the others are left out. Copies what it needs. Errors: SN_ENOMEM, SN_EINVAL (n < 1), SN_ESOLVE. */
SN_MUST_USE sn_status sn_cholesky_create(sn_cholesky **out, const sn_csr *a, const int32_t *number, int32_t n,
                                         const sn_run *run, sn_error *err);
/* The same for systems of up to some ten thousand unknowns that are solved once: an order by minimum degree,
 * found sooner than METIS's, and by many threads at a time (METIS draws from one random stream). */
SN_MUST_USE sn_status sn_cholesky_create_small(sn_cholesky **out, const sn_csr *a, const int32_t *number,
                                               int32_t n, const sn_run *run, sn_error *err);
/* Another matrix of the same pattern, without a factor yet: shares the ordering, costs no analysis. c may go
 * first. For use by another thread than c's, make it first. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_cholesky_clone(sn_cholesky **out, const sn_cholesky *c, sn_error *err);
void sn_cholesky_destroy(sn_cholesky *c); /* NULL is fine */

/* a: the matrix given to _create with other values. Errors: SN_ESOLVE (not positive definite: names the
 * column), SN_ENOMEM. The earlier factor is gone either way. */
SN_MUST_USE sn_status sn_cholesky_factorize(sn_cholesky *c, const sn_csr *a, const sn_run *run,
                                            sn_error *err);
/* x: n x n_rhs, column-major, right-hand sides in and solutions out. Needs a factor. Errors: SN_ESOLVE,
 * SN_ENOMEM, SN_ECANCEL, SN_ELIMIT; x is then untouched. */
SN_MUST_USE sn_status sn_cholesky_solve(const sn_cholesky *c, double *x, int32_t n_rhs, const sn_run *run,
                                        sn_error *err);
/* The rows and columns index[0..n_index) (unknowns, all different) of the inverse. out: n_index x n_index,
 * symmetric, whole. Touches only the columns of the factor on the paths from these unknowns to the root of
 * the elimination tree: much cheaper than n_index solves. Needs a factor. Errors: SN_ENOMEM, SN_ECANCEL. */
SN_MUST_USE sn_status sn_cholesky_inverse_block(const sn_cholesky *c, const int32_t *index, int32_t n_index,
                                                const sn_run *run, double *out, sn_error *err);
/* The x (n x n_rhs, column-major) with x[index] = value (n_index >= 1 unknowns, all different; n_index x
 * n_rhs, column-major) and A x = 0 at all other unknowns. As cheap as that, and a half of a solve. Errors:
 * SN_ESOLVE, SN_ENOMEM, SN_ECANCEL; x is then untouched. */
SN_MUST_USE sn_status sn_cholesky_solve_held(const sn_cholesky *c, const int32_t *index, int32_t n_index,
                                             const double *value, int32_t n_rhs, const sn_run *run, double *x,
                                             sn_error *err);
/* One right-hand side of n_entry entries, value[j] at unknown index[j] (entries of one unknown add up); zero
 * elsewhere. Half of a solve. x: n. Errors as above. */
SN_MUST_USE sn_status sn_cholesky_solve_few(const sn_cholesky *c, const int32_t *index, const double *value,
                                            int32_t n_entry, const sn_run *run, double *x, sn_error *err);
/* y += A x with the A that was factorized. x, y: n. */
void sn_cholesky_add_product(const sn_cholesky *c, const double *x, double *y);
/* About the smallest over the largest pivot: near 1e-16, the matrix may have been singular. Needs a factor.
 */
double sn_cholesky_rcond(const sn_cholesky *c);
bool sn_cholesky_is_factorized(const sn_cholesky *c);     /* has a factor */
int64_t sn_cholesky_factor_entries(const sn_cholesky *c); /* stored for the factor; known from the analysis */

#endif
