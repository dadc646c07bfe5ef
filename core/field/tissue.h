/* tissue.h - the tissue functions: one field per muscle and one for fat [A Eq. 10].
 *
 * Muscle i minimizes f' L f + alpha |B f - d_i|^2 with f = 0 on the skin, fat the same with d = 0 and f =
 * d_fat on the skin; B stacks the collocation rows of all curves. So all share the matrix L + alpha B'B on
 * the vertices off the skin: one analysis per tet mesh, one factorization per set of curves, all right-hand
 * sides together. An anisotropic muscle has L_i in the place of L [A Eq. 13]: it shares the analysis and pays
 * for a factorization of its own, which runs beside those of the others. */
#ifndef SN_FIELD_TISSUE_H
#define SN_FIELD_TISSUE_H

#include "field/laplacian.h"
#include "muscle/collocation.h"
#include "tetra/body.h"

typedef struct sn_tissue_solver sn_tissue_solver; /* opaque */

typedef struct sn_tissue_report {
    int32_t unknowns;           /* vertices off the skin                                           */
    int32_t collocation_points; /* rows of B                                                       */
    int32_t n_solved;           /* right-hand sides of the last solve                              */
    int32_t n_anisotropic;      /* of those, with a factorization of their own                     */
    int64_t factor_entries;
    double residual; /* largest |A x - b| over |b|, in the largest norm, of the last solve */
    double seconds_assembly, seconds_analysis, seconds_factor, seconds_solve;
    double seconds_anisotropic; /* of seconds_solve                                               */
} sn_tissue_report;

/* Assembles L and analyses the matrix. body: borrowed, must outlive the solver.
 * Errors: SN_ESOLVE (no vertex off the skin), SN_ENOMEM, SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_tissue_solver_create(sn_tissue_solver **out, const sn_body *body, const sn_run *run,
                                              sn_error *err);
void sn_tissue_solver_destroy(sn_tissue_solver *s); /* NULL is fine */

typedef struct sn_tissue_muscle { /* borrowed                                                       */
    const char *name;             /* for messages                                                   */
    const sn_collocation *row;
    const double *tensor; /* n_vert x 6, see tensor.h; NULL: isotropic                       */
} sn_tissue_muscle;

/* Takes the curves and factorizes. muscle: n_muscle, borrowed until the next call. alpha: weight of the
 * curves, > 0. Errors: SN_EINVAL (alpha), SN_ESOLVE, SN_ENOMEM, SN_ECANCEL. After an error the solver has
 * no factor. */
SN_MUST_USE sn_status sn_tissue_solver_set_curves(sn_tissue_solver *s, const sn_tissue_muscle *muscle,
                                                  int32_t n_muscle, double alpha, const sn_run *run,
                                                  sn_error *err);

/* Solves for the tissues with wanted[i] (NULL: all): 0 is fat, 1 + i muscle i.
 *   fat     d_fat, finite and >= 0
 *   field   (1 + n_muscle) x n_vert; rows not wanted are untouched; wanted ones are undefined on error
 * Needs curves set. Errors: SN_EINVAL, SN_ESOLVE, SN_ENOMEM, SN_ECANCEL. */
SN_MUST_USE sn_status sn_tissue_solver_solve(sn_tissue_solver *s, double fat, const bool *wanted,
                                             const sn_run *run, double *field, sn_error *err);
const sn_csr *sn_tissue_solver_laplacian(const sn_tissue_solver *s); /* of the whole mesh; the solver's */
/* An order of elimination for the whole mesh, skin included (n_vert ranks, see cholesky.h), from that of the
 * unknowns: each skin vertex comes right after the last of its neighbours off the skin. */
void sn_tissue_solver_order(const sn_tissue_solver *s, int32_t *rank);
const sn_tissue_report *sn_tissue_solver_report(const sn_tissue_solver *s);

#endif
