/* repair_bridge.h - the parts of repairing a surface that CGAL does. Called inside a child process
 * (base/child.h): CGAL may abort or take long.
 *
 * Every function reads a valid surface and fills an init-ed one, without labels. */
#ifndef SN_MESH_REPAIR_BRIDGE_H
#define SN_MESH_REPAIR_BRIDGE_H

#include "mesh/tri_mesh.h"

SN_BEGIN_DECLS

typedef struct sn_repair_counts {
    int32_t turned;         /* faces that ran the other way than their neighbours                     */
    int32_t split_vertices; /* copies made so that each edge has two faces and each vertex one fan   */
    int32_t stitched;       /* pairs of border edges joined                                           */
    int32_t crumbs;         /* open components of hardly any area, removed                            */
    int32_t filled, left;   /* holes                                                                  */
    int32_t added;          /* faces in the filled holes                                              */
    int32_t unions;         /* pairs of components that crossed and became one                        */
    int32_t mended;         /* components whose own crossings were cut out and filled anew            */
} sn_repair_counts;

/* Winds the faces of each component alike, cuts where more than two faces share an edge or two fans a vertex,
 * joins borders that coincide, removes open components with less than crumb_area each, and fills the holes
 * whose rim has a bounding box of diagonal <= hole_size. The rim of an open sheet is no hole.
 * Errors: SN_EMESH, SN_ENOMEM. */
SN_MUST_USE sn_status sn_bridge_orient_fill(const sn_tri_mesh *in, double hole_size, double crumb_area,
                                            sn_tri_mesh *out, sn_repair_counts *n, sn_error *err);
/* in: closed, manifold. Cuts out the faces of a component that cross each other and fills the gap without
 * crossings, where such a filling is found; then unites components that cross. Rounding may leave a few
 * crossings. Errors: SN_EMESH, SN_ENOMEM. */
SN_MUST_USE sn_status sn_bridge_untangle(const sn_tri_mesh *in, sn_tri_mesh *out, sn_repair_counts *n,
                                         sn_error *err);
typedef struct sn_wrap_sizes {
    double alpha; /* gaps wider than about twice this are entered ...                                       */
    double far;   /* ... and where the wrap is farther than this from the input, also gaps ...              */
    double least; /* ... wider than about twice this. least = alpha: the same everywhere                    */
    double offset; /* of the wrap from the input */
} sn_wrap_sizes;
/* A closed, manifold, outward surface around the faces of in, `offset` away from them (Portaneri et al.,
 * Alpha Wrapping with an Offset, 2022), here with an alpha that adapts. offset > 0, 0 < least <= alpha.
 * Errors: SN_EMESH, SN_ENOMEM. */
SN_MUST_USE sn_status sn_bridge_wrap(const sn_tri_mesh *in, const sn_wrap_sizes *w, sn_tri_mesh *out,
                                     sn_error *err);

SN_END_DECLS

#endif
