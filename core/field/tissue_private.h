/* tissue_private.h - what the two ways of solving for a tissue share: with the matrix of all (tissue.c), and
 * with the matrix of one anisotropic muscle (tissue_own.c). */
#ifndef SN_FIELD_TISSUE_PRIVATE_H
#define SN_FIELD_TISSUE_PRIVATE_H

#include "field/tissue.h"
#include "field/tissue_system.h"

/* The matrix of one anisotropic muscle. Kept from solve to solve: its factor serves until its tensor changes,
 * and the pages of a new factor cost as much as a good part of filling it. */
typedef struct own_room {
    sn_tissue_system system;
    double *val;            /* the matrix, in the pattern of L   */
    uint64_t id, tensor_id; /* of the muscle and tensor that the factor is of; 0: none */
    uint64_t last_use;
    bool is_taken;
} own_room;

struct sn_tissue_solver {
    const sn_body *body;
    sn_csr laplacian;
    double *matrix; /* L + alpha B'B, in the pattern of L */
    sn_assembly assembly;
    int32_t *number;    /* n_vert: index among the unknowns, -1 on the skin */
    int32_t *vertex_of; /* n_free */
    int32_t n_free;
    sn_tissue_system system;
    double *cover; /* n_free: h, see tissue.h */
    bool has_cover;
    const sn_tissue_muscle *muscle;
    int32_t n_muscle;
    double alpha;
    sn_row_set set;    /* all rows of the muscles */
    uint64_t revision; /* of the rows; 0: no curves set */
    own_room **room;   /* n_room */
    int32_t n_room;
    uint64_t n_use; /* of rooms */
    sn_tissue_report report;
};

/* More than rounding: the change since the factor has lost too many digits. */
#define SN_RESIDUAL_TOO_LARGE 1e-11

/* The row of fat from the cover. */
void sn_tissue_put_fat(const sn_tissue_solver *s, double fat, double *field);
sn_tissue_rows sn_tissue_rows_of(const sn_tissue_solver *s);
void sn_tissue_close_room(own_room *r); /* NULL is fine */

/* ---- right-hand sides (tissue_rhs.c) ---- */

/* b of tissues: alpha B_i' d_i on the unknowns, each once in a vector; of fat alpha B' 1. */
typedef struct tissue_rhs {
    int32_t n, *ptr, *index;
    double *value;
} tissue_rhs;
SN_MUST_USE sn_status sn_tissue_rhs_init(tissue_rhs *b, const sn_tissue_solver *s, const int32_t *tissue,
                                         int32_t n, sn_error *err);
void sn_tissue_rhs_free(tissue_rhs *b);

/* ---- solving by a system (tissue_block.c, tissue_iterate.c) ---- */

typedef struct tissue_block { /* some tissues, together */
    const int32_t *tissue;
    int32_t n;
    double fat;
    const sn_tissue_quick *quick;
    sn_tissue_stamp *stamp; /* NULL: of no interest */
    double *field;
} tissue_block;
/* What a solution, written at the unknowns of its row, leaves to be done: the skin, where it was not written
 * before, fat from the cover (which the row then holds), the stamp. */
void sn_tissue_complete_field(const sn_tissue_solver *s, const tissue_block *b, double *cover,
                              int32_t tissue);
/* *n_solved: those that were not kept. cover: the solver's when the block may
 * have fat. */
SN_MUST_USE sn_status sn_tissue_solve_block(const sn_tissue_solver *s, sn_tissue_system *system,
                                            const tissue_block *b, double *cover, const sn_run *run,
                                            double *residual, int32_t *n_solved, sn_error *err);
/* The same by an iterative system. *iterations: most of a field. */
SN_MUST_USE sn_status sn_tissue_iterate_block(const sn_tissue_solver *s, const sn_tissue_system *system,
                                              const tissue_block *b, double *cover, const sn_run *run,
                                              double *residual, int32_t *iterations, int32_t *n_solved,
                                              sn_error *err);

#endif
