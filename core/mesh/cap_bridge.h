/* cap_bridge.h - triangles between the loops of a plane outline, by CGAL's constrained Delaunay
 * triangulation. */
#ifndef SN_MESH_CAP_BRIDGE_H
#define SN_MESH_CAP_BRIDGE_H

#include "base/status.h"

#include <stdint.h>

SN_BEGIN_DECLS

typedef struct sn_cap_edge {
    int32_t a, b; /* points                                                                          */
    int32_t turn; /* how often the outline runs from a to b, less how often back; the inside is to the left.
                     0: it bounds nothing, but no triangle may lie across it */
} sn_cap_edge;

/* Triangles of the region that the outline winds around once, counter-clockwise; where it winds around once
 * the other way they are clockwise. Any number of loops, holes and islands; no new points; every point within
 * the region is a corner.
 *   point  n_point x 2, finite, all different
 *   edge   every pair of points at most once; the turns that leave a point are as many as those that enter it
 *   tri    n_tri x 3 point numbers, by sn_alloc, the caller's; NULL on error
 *   where  on SN_EMESH: a point near the trouble
 * Deterministic. Errors: SN_EMESH (edges that cross or touch outside their ends; a region that is wound
 * around more than once), SN_ENOMEM. */
SN_MUST_USE sn_status sn_cap_triangulate(const double *point, int32_t n_point, const sn_cap_edge *edge,
                                         int32_t n_edge, int32_t **tri, int32_t *n_tri, int32_t *where,
                                         sn_error *err);

SN_END_DECLS

#endif
