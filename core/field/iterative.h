/* iterative.h - conjugate gradients for symmetric positive definite matrices that are too large to factorize:
 * memory in proportion to the entries of the matrix, preconditioned by algebraic multigrid. */
#ifndef SN_FIELD_ITERATIVE_H
#define SN_FIELD_ITERATIVE_H

#include "base/run.h"
#include "field/laplacian.h"

#include <stdbool.h>

typedef struct sn_iterative sn_iterative; /* opaque; const = may be used by many threads */

/* The rows and columns of a with number[i] >= 0, where number maps them one to one onto 0..n-1. Copies what
 * it needs; makes the preconditioner. Errors: SN_ESOLVE, SN_ENOMEM, SN_ECANCEL, SN_ELIMIT, SN_EINVAL (n < 1).
 */
SN_MUST_USE sn_status sn_iterative_create(sn_iterative **out, const sn_csr *a, const int32_t *number,
                                          int32_t n, const sn_run *run, sn_error *err);
void sn_iterative_destroy(sn_iterative *s); /* NULL is fine */

/* Other values of the same pattern; the coarse levels of the preconditioner stay, and serve as long as these
 * are near. */
void sn_iterative_set_values(sn_iterative *s, const sn_csr *a);

typedef struct sn_iterative_report {
    int32_t iterations;
    double residual; /* |A x - b| over |b|, in the largest norm */
} sn_iterative_report;

/* Solves A x = b. x: n, a first guess in, the solution out (undefined on error). tolerance: of the error, in
 * the norm of the matrix, relative to the solution, as the preconditioner sees it. Not the same bits for
 * another first guess; the same for any number of threads. Errors: SN_ESOLVE (no progress: says how far it
 * came), SN_ENOMEM, SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_iterative_solve(const sn_iterative *s, const double *b, double *x, double tolerance,
                                         const sn_run *run, sn_iterative_report *report, sn_error *err);

#endif
