/* icp_rigid.h - moves a surface piece onto the part of a target surface that it resembles: rotation,
 * translation and, if wanted, one scale [A 3.1.4, first step].
 *
 * Iterative closest points. The distance of a pair counts fully along the target's normal and by a factor
 * across it, which goes from 1 (point to point) to 0.002 (nearly point to plane) as the residual settles.
 * Each step is a damped Gauss-Newton step that lowers the residual. */
#ifndef SN_SKELETON_ICP_RIGID_H
#define SN_SKELETON_ICP_RIGID_H

#include "skeleton/icp_pairs.h"

/* piece: valid, with an area. start: where it is placed first; finds its way from some 20 degrees and 20 % of
 * size and place. with_scale: else the scale stays that of the start. Never goes farther than 60 degrees
 * and half to twice the scale from the start; where it settles near that border it has lost its way.
 * Defaults: max_iterations 200, max_residual 0.25 sizes. report: also filled where it does not converge. *out
 * is untouched on error. Errors: SN_EINVAL (options, start, piece), SN_ESOLVE (does not converge: the message
 * has the residual reached and wanted and the iterations), SN_ENOMEM, SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_icp_rigid_run(const sn_tri_mesh *piece, const sn_bvh *target,
                                       const sn_transform *start, const sn_icp_options *options,
                                       bool with_scale, const sn_run *run, sn_transform *out,
                                       sn_icp_report *report, sn_error *err);

#endif
