/* low_rank.h - a matrix that differs by few terms from one that was factorized: A + U diag(w) U', U sparse.
 *
 * The terms of curves lie close together: they touch fewer unknowns than they are. So the change is taken as
 * E M E', E columns of the identity and M = sum of w u u' on the unknowns touched. By the formula of Sherman,
 * Morrison and Woodbury, with Y = L^-1 P E and Z = L^-1 P B the half solves and G = Y'Y,
 * (A + E M E')^-1 B = P' L'^-1 (Z - Y M s),  s = (I + G M)^-1 Y'Z,  the solution at the unknowns touched.
 * So a new right-hand side costs no more than by the factor, and an unknown costs its own path, once:
 * columns of Y stay for as long as they are of use. */
#ifndef SN_FIELD_LOW_RANK_H
#define SN_FIELD_LOW_RANK_H

#include "field/unit_columns.h"

typedef struct sn_low_rank sn_low_rank; /* opaque; const = may be used by many threads */

/* c: borrowed with its factor. No terms yet. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_low_rank_create(sn_low_rank **out, const sn_cholesky *c, sn_error *err);
void sn_low_rank_destroy(sn_low_rank *r); /* NULL is fine */

typedef struct sn_low_rank_terms { /* borrowed                                            */
    sn_sparse_vectors u;
    const double *weight; /* u.n                                                          */
    const int32_t *probe; /* n_probe: unknowns at which solutions are asked for, besides those of u */
    int32_t n_probe;
} sn_low_rank_terms;
/* Takes the terms in the place of those it had. Errors: SN_ESOLVE (the changed matrix is singular),
 * SN_ENOMEM, SN_ECANCEL, SN_ELIMIT; it is then without terms. */
SN_MUST_USE sn_status sn_low_rank_set(sn_low_rank *r, const sn_low_rank_terms *terms, const sn_run *run,
                                      sn_error *err);
int32_t sn_low_rank_count(const sn_low_rank *r); /* terms; 0 of NULL */

/* Y: of terms, of probes, and some that are of no use now. */
const sn_unit_columns *sn_low_rank_columns(const sn_low_rank *r);
/* What finishes right-hand sides B + E Q. seen: Y'Z in, and out the solutions at all columns; factor: Q in,
 * and out what Y is multiplied with (both columns x n_rhs, column-major). Errors: SN_ENOMEM, SN_ESOLVE. */
SN_MUST_USE sn_status sn_low_rank_factor(const sn_low_rank *r, int32_t n_rhs, double *seen, double *factor,
                                         sn_error *err);
/* y += U diag(w) U' x. */
void sn_low_rank_add_product(const sn_low_rank *r, const double *x, double *y);

#endif
