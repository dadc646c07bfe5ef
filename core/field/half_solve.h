/* half_solve.h - sparse right-hand sides half solved, and finished together.
 *
 * With P A P' = L L', a half solve of right-hand sides B is Y = L^-1 P B. A column of Y is zero off the paths
 * from the entries of its right-hand side to the root of the elimination tree, so Y is kept for the
 * supernodes on some path only, and going forward costs next to nothing where the entries are few. Products
 * of half solves are products with the inverse, Y'Z = B' A^-1 C; going back, X = P' L'^-1 Y, touches all of
 * the factor. Between the two, columns may be combined. */
#ifndef SN_FIELD_HALF_SOLVE_H
#define SN_FIELD_HALF_SOLVE_H

#include "field/cholesky.h"

typedef struct sn_sparse_vectors { /* borrowed; entries of one unknown add up               */
    int32_t n;                     /* vectors                                               */
    const int32_t *ptr;            /* n + 1                                                 */
    const int32_t *index;          /* ptr[n]: unknowns                                      */
    const double *value;           /* ptr[n]                                                */
} sn_sparse_vectors;

typedef struct sn_half_solve sn_half_solve; /* opaque; const = may be used by many threads */

/* c: borrowed with its factor, which must stay as it is. Errors: SN_ENOMEM, SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_half_solve_create(sn_half_solve **out, const sn_cholesky *c,
                                           const sn_sparse_vectors *b, const sn_run *run, sn_error *err);
/* The same of columns of the identity. index: n, one for each. */
SN_MUST_USE sn_status sn_half_solve_create_units(sn_half_solve **out, const sn_cholesky *c,
                                                 const int32_t *index, int32_t n, const sn_run *run,
                                                 sn_error *err);
void sn_half_solve_destroy(sn_half_solve *h);        /* NULL is fine */
int32_t sn_half_solve_count(const sn_half_solve *h); /* columns */

/* out := Y'Y, whole; n x n. */
void sn_half_solve_gram(const sn_half_solve *h, double *out);
/* out := Y'Z of two half solves by one factor; column-major, as many rows as y has columns. */
void sn_half_solve_product(const sn_half_solve *y, const sn_half_solve *z, double *out);

typedef struct sn_half_term { /* Y times factor, or columns of Y */
    const sn_half_solve *y;
    const double *factor; /* columns of y x n_rhs, column-major                                        */
    int32_t stride;       /* rows of what factor lies in: at least the columns of y                    */
    const int32_t *pick;  /* without a factor; n_rhs: column of y for each, -1 for none; NULL: their own */
} sn_half_term;
/* X = A^-1 sum B_t F_t, n_rhs columns, 0 without terms. c: that of the terms. out[j]: column j; at: where
 * each unknown goes in it (NULL: to its own number). Errors: SN_ENOMEM, SN_ECANCEL, SN_ELIMIT; some columns
 * may then be written. */
SN_MUST_USE sn_status sn_half_solve_finish(const sn_cholesky *c, const sn_half_term *term, int32_t n_term,
                                           int32_t n_rhs, double *const *out, const int32_t *at,
                                           const sn_run *run, sn_error *err);

#endif
