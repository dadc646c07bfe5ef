/* corefine_bridge.h - exact unions and differences of closed surfaces with CGAL's corefinement.
 * The only file of the library that sees CGAL. Called inside a child process (base/child.h): CGAL may abort.
 */
#ifndef SN_TETRA_COREFINE_BRIDGE_H
#define SN_TETRA_COREFINE_BRIDGE_H

#include "mesh/tri_mesh.h"

SN_BEGIN_DECLS

/* skin minus all bones: the boundary of the soft tissue, outside out. Points are computed exactly and rounded
 * at the end, so a few triangles may cross by a rounding error; remeshing cures them. skin    closed,
 * outward; NULL: the union of the bones alone, outward bone    n_bone closed, outward surfaces; they may
 * cross each other and the skin out     init-ed; label 0 on skin, 1 + i on faces of bone i Errors: SN_EMESH
 * (an input that crosses itself where it is cut; a result that is not manifold), SN_ENOMEM. */
SN_MUST_USE sn_status sn_corefine(const sn_tri_mesh *skin, const sn_tri_mesh *const *bone, int32_t n_bone,
                                  sn_tri_mesh *out, sn_error *err);

SN_END_DECLS

#endif
