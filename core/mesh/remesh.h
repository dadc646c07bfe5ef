/* remesh.h - isotropic remeshing that cannot create an intersection.
 *
 * Splits, collapses, flips and smooths edges towards a target length, as Botsch and Kobbelt 2004, but takes a
 * step only when the new triangles cross nothing (exact predicates) and stay within a distance of the input.
 * A surface without self-intersections stays so; one with a few, from rounding, loses them where a step can
 * cure them. */
#ifndef SN_MESH_REMESH_H
#define SN_MESH_REMESH_H

#include "base/run.h"
#include "mesh/sizing.h"
#include "mesh/tri_mesh.h"

typedef struct sn_remesh {
    double edge_length;         /* target, > 0; for labels without their own            */
    const double *label_length; /* n_label targets by face label, or NULL                */
    int32_t n_label;
    const sn_sizing *sizing; /* NULL: none. Else targets are this where it is longer, borrowed             */
    double coarsest;         /* with sizing: no target gets longer than this times its own; >= 1           */
    int iterations;          /* 0: the default of 6                                   */
    double max_deviation; /* how far faces may leave the input, as a fraction of the target length; 0: 0.08 */
} sn_remesh;

typedef struct sn_remesh_report {
    int32_t splits, collapses, flips, moves, refused; /* refused: steps that would have crossed something */
    int64_t crossings_before, crossings_after;        /* pairs of faces                                   */
    double largest_move; /* distance of the farthest new vertex from the input                  */
} sn_remesh_report;

/* in: closed, every edge with exactly two faces, the faces around a vertex one ring; labels optional,
 * 0..16777215 (borders between labels stay where they are: their vertices move along them only). out:
 * init-ed; labelled as in. Deterministic. report: NULL to skip. Errors: SN_EINVAL (options; indices,
 * coordinates or labels of in), SN_EMESH (edge that is not between two faces, parts that touch in a vertex),
 * SN_ENOMEM, SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_remesh_run(const sn_tri_mesh *in, const sn_remesh *opt, const sn_run *run,
                                    sn_tri_mesh *out, sn_remesh_report *report, sn_error *err);

#endif
