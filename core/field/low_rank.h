/* low_rank.h - a matrix that differs by few terms from one that was factorized: A + U diag(w) U', U sparse.
 *
 * By the formula of Sherman, Morrison and Woodbury, with Y = L^-1 P U and Z = L^-1 P B the half solves,
 * (A + U diag(w) U')^-1 B = P' L'^-1 (Z - Y S^-1 Y'Z),  S = diag(1/w) + Y'Y.
 * So a new right-hand side costs no more than by the factor, and the terms cost their own paths. */
#ifndef SN_FIELD_LOW_RANK_H
#define SN_FIELD_LOW_RANK_H

#include "field/half_solve.h"

typedef struct sn_low_rank sn_low_rank; /* opaque; const = may be used by many threads */

/* u: the terms, n_term of them, and after them probes: places at which solutions are asked for. weight:
 * n_term, none 0. c: borrowed with its factor. u may be empty. Errors: SN_ESOLVE (the changed matrix is
 * singular), SN_ENOMEM, SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_low_rank_create(sn_low_rank **out, const sn_cholesky *c, const sn_sparse_vectors *u,
                                         const double *weight, int32_t n_term, const sn_run *run,
                                         sn_error *err);
void sn_low_rank_destroy(sn_low_rank *r);        /* NULL is fine */
int32_t sn_low_rank_count(const sn_low_rank *r); /* terms; 0 of NULL */
int32_t sn_low_rank_width(const sn_low_rank *r); /* terms and probes */

/* What finishes a half solve z of n_rhs columns (width x n_rhs, column-major). factor: -S^-1 Y'Z, 0 for
 * probes; seen: U'X, the solutions at terms and probes. */
SN_MUST_USE sn_status sn_low_rank_factor(const sn_low_rank *r, const sn_half_solve *z, int32_t n_rhs,
                                         double *factor, double *seen, sn_error *err);
/* y += U diag(w) U' x. */
void sn_low_rank_add_product(const sn_low_rank *r, const double *x, double *y);
sn_sparse_vectors sn_low_rank_vectors(const sn_low_rank *r); /* U */
const sn_half_solve *sn_low_rank_half(const sn_low_rank *r); /* Y; NULL when there are neither */

#endif
