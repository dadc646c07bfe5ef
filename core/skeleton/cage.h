/* cage.h - points bound to a closed triangle cage by mean value coordinates: moving the cage's vertices moves
 * the points. Any point is a mean of the cage's vertices, with weights that add up to 1 and are negative in
 * places; where the cage moves affinely the points do, too. Source: Ju et al. 2005. */
#ifndef SN_SKELETON_CAGE_H
#define SN_SKELETON_CAGE_H

#include "base/run.h"
#include "mesh/tri_mesh.h"

/* Can the surface serve as a cage: valid, closed, manifold, oriented, with a positive volume (outside out).
 * Errors: SN_EINVAL (the message says what is wrong), SN_ENOMEM. */
SN_MUST_USE sn_status sn_cage_check(const sn_tri_mesh *cage, sn_error *err);

/* weight: n_point x cage->n_vert, row-major. point: n_point x 3, anywhere: inside, on and outside the cage.
 * Each row reproduces its point to rounding of the cage's size; a point on a face, an edge or a vertex gets
 * the weights of just that. Vertices far outside, at more than some 1e4 cage sizes, lose digits. cage: as
 * sn_cage_check wants it. Cost n_point x n_face. Errors: SN_EINVAL (a point that is not finite), SN_ECANCEL,
 * SN_ELIMIT; weight is then not meaningful. */
SN_MUST_USE sn_status sn_cage_weights(const sn_tri_mesh *cage, const double *point, int32_t n_point,
                                      const sn_run *run, double *weight, sn_error *err);

/* out = weight * cage_pos: n_point x 3 from n_point x n_vert and n_vert x 3; out is none of them. */
void sn_cage_apply(const double *weight, int32_t n_point, const double *cage_pos, int32_t n_vert,
                   const sn_run *run, double *out);

#endif
