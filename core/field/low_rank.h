/* low_rank.h - a matrix that differs by few terms from one that was factorized: A + U diag(w) U', U sparse.
 *
 * By the formula of Sherman, Morrison and Woodbury, with Y = L^-1 P U and Z = L^-1 P B the half solves,
 * (A + U diag(w) U')^-1 B = P' L'^-1 (Z - Y S^-1 Y'Z),  S = diag(1/w) + Y'Y.
 * So a new right-hand side costs no more than by the factor, and the terms cost their own paths, once:
 * columns of Y stay for as long as they are of use. */
#ifndef SN_FIELD_LOW_RANK_H
#define SN_FIELD_LOW_RANK_H

#include "field/half_solve.h"

typedef struct sn_low_rank sn_low_rank; /* opaque; const = may be used by many threads */

/* c: borrowed with its factor. No terms yet. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_low_rank_create(sn_low_rank **out, const sn_cholesky *c, sn_error *err);
void sn_low_rank_destroy(sn_low_rank *r); /* NULL is fine */

/* Takes the terms in the place of those it had. u: the terms, n_term of them, and after them probes: places
 * at which solutions are asked for. weight: n_term, none 0. Errors: SN_ESOLVE (the changed matrix is
 * singular), SN_ENOMEM, SN_ECANCEL, SN_ELIMIT; it is then without terms. */
SN_MUST_USE sn_status sn_low_rank_set(sn_low_rank *r, const sn_sparse_vectors *u, const double *weight,
                                      int32_t n_term, const sn_run *run, sn_error *err);
int32_t sn_low_rank_count(const sn_low_rank *r); /* terms; 0 of NULL */

/* ---- columns of Y: terms, probes, and some that are of no use now, in an order of its own ---- */

int32_t sn_low_rank_width(const sn_low_rank *r);
sn_sparse_vectors sn_low_rank_vectors(const sn_low_rank *r);
int32_t sn_low_rank_part_count(const sn_low_rank *r);
/* Columns first .. first + n - 1. */
const sn_half_solve *sn_low_rank_part(const sn_low_rank *r, int32_t i_part, int32_t *first, int32_t *n);

/* What finishes right-hand sides. seen: Y'Z in, and out U'X, the solutions at all columns; factor: what Y is
 * multiplied with (both width x n_rhs, column-major). has_sum (n_rhs): to this right-hand side U w is to be
 * added, the sum of the terms. Errors: SN_ESOLVE. */
SN_MUST_USE sn_status sn_low_rank_factor(const sn_low_rank *r, int32_t n_rhs, const bool *has_sum,
                                         double *seen, double *factor, sn_error *err);
/* y += U diag(w) U' x. */
void sn_low_rank_add_product(const sn_low_rank *r, const double *x, double *y);
/* y += scale U w. */
void sn_low_rank_add_sum(const sn_low_rank *r, double scale, double *y);

#endif
