/* cholesky.h - sparse Cholesky of symmetric positive definite matrices: analyse once, factorize often, solve
 * many right-hand sides together. The only file of the library that sees CHOLMOD (its 64-bit interface, METIS
 * ordering, supernodal). */
#ifndef SN_FIELD_CHOLESKY_H
#define SN_FIELD_CHOLESKY_H

#include "base/run.h"
#include "field/laplacian.h"

typedef struct sn_cholesky sn_cholesky; /* opaque: one thread at a time */

/* Orders and analyses the rows and columns of a with number[i] >= 0, where number maps them one to one onto
 * 0..n-1; the others are left out. Copies what it needs. Errors: SN_ENOMEM, SN_EINVAL (n < 1), SN_ESOLVE. */
SN_MUST_USE sn_status sn_cholesky_create(sn_cholesky **out, const sn_csr *a, const int32_t *number, int32_t n,
                                         const sn_run *run, sn_error *err);
void sn_cholesky_destroy(sn_cholesky *c); /* NULL is fine */

/* a: the matrix given to _create with other values. Errors: SN_ESOLVE (not positive definite: names the
 * column), SN_ENOMEM. The earlier factor is gone either way. */
SN_MUST_USE sn_status sn_cholesky_factorize(sn_cholesky *c, const sn_csr *a, const sn_run *run,
                                            sn_error *err);
/* x: n x n_rhs, column-major, right-hand sides in and solutions out. Needs a factor. Errors: SN_ESOLVE,
 * SN_ENOMEM, SN_ECANCEL, SN_ELIMIT; x is then untouched. */
SN_MUST_USE sn_status sn_cholesky_solve(sn_cholesky *c, double *x, int32_t n_rhs, const sn_run *run,
                                        sn_error *err);
int64_t sn_cholesky_factor_entries(const sn_cholesky *c); /* nonzeros of the factor; 0 before it is there */

#endif
