/* tissue.h - the tissue functions: one field per muscle and one for fat [A Eq. 10].
 *
 * Muscle i minimizes f' L f + alpha |B f - d_i|^2 with f = 0 on the skin, fat the same with d = 0 and f =
 * d_fat on the skin; B stacks the collocation rows of all curves. So all share the matrix L + alpha B'B on
 * the vertices off the skin: one analysis per tet mesh, one factor, all right-hand sides together. An
 * anisotropic muscle has L_i in the place of L [A Eq. 13]: it shares the analysis and has a factor of its
 * own, which may be made beside all others.
 *
 * An edit changes few rows of B: what they change is solved for by a factor of before (tissue_system.h). Fat
 * follows from one field that does not know d_fat: constants are in the kernel of L, so f_fat = d_fat (1 - h)
 * with h the field of a muscle that has the value 1 on all curves. */
#ifndef SN_FIELD_TISSUE_H
#define SN_FIELD_TISSUE_H

#include "field/harmonic.h"
#include "field/laplacian.h"
#include "muscle/collocation.h"
#include "tetra/body.h"

typedef struct sn_tissue_solver sn_tissue_solver; /* opaque */

/* How the matrix is solved with: by a factor, or by conjugate gradients once the factor would be too large.
 */
typedef enum sn_solver_kind { SN_SOLVER_AUTO, SN_SOLVER_DIRECT, SN_SOLVER_ITERATIVE } sn_solver_kind;

typedef struct sn_tissue_report {
    int32_t unknowns;           /* vertices off the skin                                           */
    int32_t collocation_points; /* rows of B                                                       */
    int32_t n_solved;           /* right-hand sides of the last solve                              */
    int32_t n_kept;             /* of a quick solve: fields left as they were                      */
    int32_t n_changed_rows;     /* of B, since the factor was made                                 */
    bool was_factorized;        /* by the last solve                                               */
    bool is_iterative;
    int32_t iterations; /* most of a field; 0 of a direct solver                                   */
    int64_t factor_entries;
    double residual; /* |A x - b| over |b|, in the largest norm, of sums of the fields last solved */
    double seconds_assembly, seconds_analysis, seconds_factor, seconds_solve;
} sn_tissue_report;

/* Assembles L and analyses the matrix. body: borrowed, must outlive the solver. SN_SOLVER_AUTO: direct up to
 * one and a half million unknowns, where a factor has some 4 GB. Errors: SN_ESOLVE (no vertex off the skin),
 * SN_ENOMEM, SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_tissue_solver_create(sn_tissue_solver **out, const sn_body *body,
                                              sn_solver_kind kind, const sn_run *run, sn_error *err);
void sn_tissue_solver_destroy(sn_tissue_solver *s); /* NULL is fine */

typedef struct sn_tissue_muscle { /* borrowed                                                       */
    const char *name;             /* for messages                                                   */
    const sn_collocation *row;
    uint64_t id; /* the same muscle has the same one for as long as the solver lives */
} sn_tissue_muscle;

/* Takes the curves. muscle: n_muscle, borrowed until the next call. alpha: weight of the curves, > 0. Errors:
 * SN_EINVAL (alpha), SN_ENOMEM; the solver is as before. */
SN_MUST_USE sn_status sn_tissue_solver_set_curves(sn_tissue_solver *s, const sn_tissue_muscle *muscle,
                                                  int32_t n_muscle, double alpha, sn_error *err);

/* For the picture while something is edited: fields that hardly change stay as they are. */
typedef struct sn_tissue_quick {
    const bool
        *is_edited;   /* 1 + n_muscle: has no field, or one of other tissue values or curves of its own */
    double tolerance; /* most that a field which stays may be off at the rows that changed; an iterative
                         solver keeps none, and solves all to 1e-5 */
    bool *was_kept;   /* 1 + n_muscle: receives whether a wanted field was left as it was               */
} sn_tissue_quick;

/* Which curves a field is of: to be kept with it, 0 at first and when the row of field may hold anything. */
typedef uint64_t sn_tissue_stamp;

/* Solves for the isotropic tissues with wanted[i] (NULL: all): 0 is fat, 1 + i muscle i.
 *   fat     d_fat, finite and >= 0
 *   quick   NULL: exactly
 *   *   stamp   1 + n_muscle, of the rows of field; NULL: there will be no quick solves, and an iterative
 * solver begins at 0, not at the field of before field   (1 + n_muscle) x n_vert; rows not wanted are
 * untouched; wanted ones are undefined on error Needs curves set. Errors: SN_EINVAL, SN_ESOLVE, SN_ENOMEM,
 * SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_tissue_solver_solve(sn_tissue_solver *s, double fat, const bool *wanted,
                                             const sn_tissue_quick *quick, sn_tissue_stamp *stamp,
                                             const sn_run *run, double *field, sn_error *err);
/* The field of fat for another d_fat, when fat was solved exactly for the curves as they are; false when it
 * was not. */
bool sn_tissue_solver_set_fat(const sn_tissue_solver *s, double fat, double *field);

typedef struct sn_tissue_own {
    int32_t i_muscle;
    const double *tensor; /* n_vert x 6, see tensor.h                              */
    uint64_t tensor_id;   /* > 0; another one for another tensor of this muscle    */
} sn_tissue_own;
/* Solves for a muscle with its own tensor. quick: as above, NULL: exactly. residual: see the report;
 * *was_factorized: whether its matrix was. Needs curves set; changes row 1 + i_muscle of field only. May run
 * beside the above and itself, for other muscles. Errors: as above; the message names the muscle. */
SN_MUST_USE sn_status sn_tissue_solver_solve_own(sn_tissue_solver *s, const sn_tissue_own *own,
                                                 const sn_tissue_quick *quick, sn_tissue_stamp *stamp,
                                                 const sn_run *run, double *field, double *residual,
                                                 bool *was_factorized, sn_error *err);
bool sn_tissue_solver_has_factor(const sn_tissue_solver *s); /* of the matrix that all share */
/* Harmonic functions with 0 on the skin, by the analysis of the solver. May run beside the above. */
SN_MUST_USE sn_status sn_tissue_solver_harmonic(const sn_tissue_solver *s, sn_harmonic **out,
                                                const sn_run *run, sn_error *err);
const sn_tissue_report *sn_tissue_solver_report(const sn_tissue_solver *s);

#endif
