/* tri_cut.h - one half of a closed surface, with a cap where a plane cuts it. */
#ifndef SN_MESH_TRI_CUT_H
#define SN_MESH_TRI_CUT_H

#include "base/plane.h"
#include "base/run.h"
#include "mesh/tri_mesh.h"

/* Keeps the side of the plane that `normal` points to and closes it with faces in the plane.
 *
 * m may hold several shells, also inside each other when they turn in turn outwards and inwards (a skin with
 * bones cut out of it): the cap covers what lies inside of the outer and outside of the inner ones, with any
 * number of holes and islands. The result is closed and oriented, and manifold and without
 * self-intersections when m is; a saddle, or a point or an edge that touches the plane from the kept side,
 * gives a vertex or an edge where the result touches itself. The halves of both normals have the same points
 * in the plane, and their volumes add up to that of m.
 *
 * Vertices within SN_PLANE_REL of m's box diagonal of the plane count as on it and are moved onto it; faces
 * in the plane go, the cap replaces them. New points lie on m's edges, computed from the lower to the higher
 * vertex number. Points in a plane across a coordinate axis have its very coordinate; in other planes they
 * lie up to rounding. New points that coincide are joined. The cap has no points of its own: constrained
 * Delaunay triangles of its outline, seen along the coordinate axis nearest to the normal.
 *
 *   m          closed, any genus; labels optional
 *   cap_label  label of the cap's faces; not used when m has none
 *   out        init-ed; not m; vertices of m first, in order, then new ones; kept faces first, in order, then
 *              the cap. Empty on error
 *   from_face  n_face of out: the face of m, or -1 for the cap; by sn_alloc, the caller's; NULL to skip;
 * *from_face is NULL on error
 *
 * Deterministic. Errors: SN_EINVAL (plane not finite, normal zero; m is no valid mesh; the plane misses m:
 * the message says where m lies), SN_EMESH (m is open, or its faces turn different ways; in the plane m
 * crosses itself or a shell lies in another one that turns the same way), SN_ENOMEM, SN_ECANCEL, SN_ELIMIT.
 */
SN_MUST_USE sn_status sn_tri_mesh_cut(const sn_tri_mesh *m, sn_vec3 point, sn_vec3 normal, int32_t cap_label,
                                      const sn_run *run, sn_tri_mesh *out, int32_t **from_face,
                                      sn_error *err);

#endif
