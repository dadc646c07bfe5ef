/* tissue.h - the tissue functions: one field per muscle and one for fat [A Eq. 10].
 *
 * Muscle i minimizes f' L f + alpha |B f - d_i|^2 with f = 0 on the skin, fat the same with d = 0 and f =
 * d_fat on the skin; B stacks the collocation rows of all curves. So all share the matrix L + alpha B'B on
 * the vertices off the skin: one analysis per tet mesh, one factorization per set of curves, all right-hand
 * sides together. An anisotropic muscle has L_i in the place of L [A Eq. 13]: it shares the analysis and pays
 * for a factorization of its own, which may run beside all others. */
#ifndef SN_FIELD_TISSUE_H
#define SN_FIELD_TISSUE_H

#include "field/harmonic.h"
#include "field/laplacian.h"
#include "muscle/collocation.h"
#include "tetra/body.h"

typedef struct sn_tissue_solver sn_tissue_solver; /* opaque */

typedef struct sn_tissue_report {
    int32_t unknowns;           /* vertices off the skin                                           */
    int32_t collocation_points; /* rows of B                                                       */
    int32_t n_solved;           /* right-hand sides of the last solve                              */
    int64_t factor_entries;
    double residual; /* largest |A x - b| over |b|, in the largest norm, of the last solve */
    double seconds_assembly, seconds_analysis, seconds_factor, seconds_solve;
} sn_tissue_report;

/* Assembles L and analyses the matrix. body: borrowed, must outlive the solver.
 * Errors: SN_ESOLVE (no vertex off the skin), SN_ENOMEM, SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_tissue_solver_create(sn_tissue_solver **out, const sn_body *body, const sn_run *run,
                                              sn_error *err);
void sn_tissue_solver_destroy(sn_tissue_solver *s); /* NULL is fine */

typedef struct sn_tissue_muscle { /* borrowed                                                       */
    const char *name;             /* for messages                                                   */
    const sn_collocation *row;
} sn_tissue_muscle;

/* Takes the curves; the next solve factorizes. muscle: n_muscle, borrowed until the next call. alpha: weight
 * of the curves, > 0. Errors: SN_EINVAL (alpha; the solver is as before). */
SN_MUST_USE sn_status sn_tissue_solver_set_curves(sn_tissue_solver *s, const sn_tissue_muscle *muscle,
                                                  int32_t n_muscle, double alpha, sn_error *err);

/* Solves for the isotropic tissues with wanted[i] (NULL: all): 0 is fat, 1 + i muscle i.
 *   fat     d_fat, finite and >= 0
 *   field   (1 + n_muscle) x n_vert; rows not wanted are untouched; wanted ones are undefined on error
 * Needs curves set. Errors: SN_EINVAL, SN_ESOLVE, SN_ENOMEM, SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_tissue_solver_solve(sn_tissue_solver *s, double fat, const bool *wanted,
                                             const sn_run *run, double *field, sn_error *err);
/* Solves for muscle i_muscle with its own tensor (n_vert x 6, see tensor.h). residual: see the report. Needs
 * curves set; changes row 1 + i_muscle of field only. May run beside the above and itself, for other muscles.
 * Errors: as above; the message names the muscle. */
SN_MUST_USE sn_status sn_tissue_solver_solve_own(sn_tissue_solver *s, int32_t i_muscle, const double *tensor,
                                                 const sn_run *run, double *field, double *residual,
                                                 sn_error *err);
/* Harmonic functions with 0 on the skin, by the analysis of the solver. May run beside the above. */
SN_MUST_USE sn_status sn_tissue_solver_harmonic(const sn_tissue_solver *s, sn_harmonic **out,
                                                const sn_run *run, sn_error *err);
const sn_tissue_report *sn_tissue_solver_report(const sn_tissue_solver *s);

#endif
