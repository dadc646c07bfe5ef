/* icp_cage.h - bends a cage so that the surface piece bound to it lies on a target surface: non-rigid ICP
 * [A 3.1.4, second step].
 *
 * The unknowns are the cage's vertices; the piece follows them by mean value coordinates (cage.h). Each
 * iteration pairs the piece's vertices with nearest points of the target and minimises, over the cage's
 * displacement D from the start,
 *
 *     mean over pairs of (n.e)^2 + across (|e|^2 - (n.e)^2)  +  stiffness |L P D|^2 / n_cage
 *
 * where e is what a pair misses, n the target's normal, L the uniform graph Laplacian of the cage and P takes
 * away the best affine motion: a stiff cage still turns, scales and stretches freely. Little weights (1e-3
 * and 1e-6 of the stiffness) on |L D|^2 and |D|^2 decide what the piece says nothing about. The stiffness
 * goes down in steps of 4, each until the residual settles: the first fit is nearly affine, the last one
 * bends where the target does. */
#ifndef SN_SKELETON_ICP_CAGE_H
#define SN_SKELETON_ICP_CAGE_H

#include "skeleton/icp_pairs.h"

typedef struct sn_icp_cage_options { /* zeros: the defaults */
    sn_icp_options icp;              /* max_iterations 200, max_residual 0.01 sizes */
    double stiff, soft;              /* first and last stiffness, stiff >= soft > 0; 100 and 1e-3 */
    double across;                   /* weight of a distance across the target's normal, 0 .. 1; 0.05 */
} sn_icp_cage_options;

/* cage: as sn_cage_check wants it, where it starts; piece: likewise, valid, with an area; bound: its weights
 * in that cage (piece->n_vert x cage->n_vert). out: cage->n_vert x 3, may be cage->pos; untouched on error.
 * A stiffness that turns a cage face inside out (against the affine motion of the whole) is not used: the
 * last one before it is the result, and report->stop says "stiff". report: also filled where it does not
 * converge. Cost of an iteration: n_piece (3 n_cage)^2 operations. Errors: SN_EINVAL (options, piece),
 * SN_ESOLVE (does not converge, with numbers), SN_ENOMEM, SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_icp_cage_run(const sn_tri_mesh *cage, const sn_tri_mesh *piece, const double *bound,
                                      const sn_bvh *target, const sn_icp_cage_options *options,
                                      const sn_run *run, double *out, sn_icp_report *report, sn_error *err);

/* Faces of m that are inside out at pos (n_vert x 3), seen against the affine motion that comes closest to
 * the one from m's vertices to pos. Faces without area are none. */
int32_t sn_count_inverted(const sn_tri_mesh *m, const double *pos);

#endif
