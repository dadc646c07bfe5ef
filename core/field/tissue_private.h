/* tissue_private.h - what the two ways of solving for a tissue share: with the matrix of all (tissue.c), and
 * with the matrix of one anisotropic muscle (tissue_own.c). */
#ifndef SN_FIELD_TISSUE_PRIVATE_H
#define SN_FIELD_TISSUE_PRIVATE_H

#include "field/cholesky.h"
#include "field/tissue.h"

/* Room for one anisotropic muscle. Kept from solve to solve: the pages of a new factor cost as much as a good
 * part of filling it. */
typedef struct own_room {
    sn_cholesky *cholesky;
    double *val, *x; /* of the matrix, n_free */
    bool is_taken;
} own_room;

struct sn_tissue_solver {
    const sn_body *body;
    sn_csr laplacian, matrix; /* L, and L + alpha B'B of the same pattern */
    sn_assembly assembly;
    int32_t *number; /* n_vert: index among the unknowns, -1 on the skin */
    int32_t n_free;
    sn_cholesky *cholesky;
    const sn_tissue_muscle *muscle;
    int32_t n_muscle;
    double alpha;
    bool has_curves, has_factor;
    own_room **room; /* n_room: as many as were ever needed at once */
    int32_t n_room;
    sn_tissue_report report;
};

/* matrix += alpha B'B; a row of B touches the four corners of one tet, so it stays in the pattern of L. */
void sn_tissue_add_rows(const sn_tissue_solver *s, sn_csr *matrix);
/* b = alpha B' d_i on the unknowns: the skin value of a muscle is 0. */
void sn_tissue_muscle_rhs(const sn_tissue_solver *s, int32_t i_muscle, double *b);
/* The whole field of a tissue, into its row of field, from the solution on the unknowns. */
void sn_tissue_put_field(const sn_tissue_solver *s, int32_t tissue, double fat, const double *x,
                         double *field);
/* max |A x - b| / max |b| for one tissue whose field is whole (skin values in place). b: room for n_free. */
double sn_tissue_residual(const sn_tissue_solver *s, const sn_csr *matrix, int32_t tissue, double fat,
                          const double *field, double *b);
void sn_tissue_close_room(own_room *r); /* NULL is fine */

#endif
