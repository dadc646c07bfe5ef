/* shape.h - implicit shapes for skins and bones made by a script, and their closed meshes.
 *
 * A shape is an immutable, reference-counted tree of signed distance functions (negative inside; a bound rather than
 * the distance after smooth unions and for ellipsoids). Lengths in the scene's unit. */
#ifndef SN_MESH_SHAPE_H
#define SN_MESH_SHAPE_H

#include "base/run.h"
#include "mesh/tri_mesh.h"

typedef struct sn_shape sn_shape; /* opaque, reference-counted, immutable */

sn_shape *sn_shape_retain(sn_shape *s);
void sn_shape_release(sn_shape *s); /* NULL is fine */

/* All constructors: SN_EINVAL with the argument's name for values that are not finite or radii/sizes <= 0; SN_ENOMEM. They
 * retain their operands. */
SN_MUST_USE sn_status sn_shape_sphere(sn_shape **out, sn_vec3 center, double radius, sn_error *err);
SN_MUST_USE sn_status sn_shape_ellipsoid(sn_shape **out, sn_vec3 center, sn_vec3 radii, sn_error *err);
/* A cone with round ends: radius ra at a, rb at b (exact distance). a = b gives the larger sphere. */
SN_MUST_USE sn_status sn_shape_capsule(sn_shape **out, sn_vec3 a, sn_vec3 b, double ra, double rb, sn_error *err);
/* half: half sizes; rounding: radius of the edges, >= 0 and at most the smallest half size. */
SN_MUST_USE sn_status sn_shape_box(sn_shape **out, sn_vec3 center, sn_vec3 half, double rounding, sn_error *err);
SN_MUST_USE sn_status sn_shape_union(sn_shape **out, sn_shape *const *s, int n, sn_error *err);
/* k: blend length > 0 (polynomial smooth minimum: the surface swells by at most k/4). */
SN_MUST_USE sn_status sn_shape_smooth_union(sn_shape **out, double k, sn_shape *const *s, int n, sn_error *err);
SN_MUST_USE sn_status sn_shape_subtract(sn_shape **out, sn_shape *a, sn_shape *b, sn_error *err); /* a minus b */

double sn_shape_value(const sn_shape *s, sn_vec3 p);
sn_box3 sn_shape_bounds(const sn_shape *s); /* holds the surface */

/* A closed, manifold, oriented surface without self-intersections, triangles of edge length about `cell`: marching tetrahedra on a
 * lattice (manifold by construction), then remeshed and drawn onto the surface. Features thinner than a cell may be lost.
 * Errors: SN_EINVAL (cell), SN_EMESH (nothing inside: cell too coarse), SN_ELIMIT (over 2e8 lattice points: says which cell would do),
 * SN_ENOMEM, SN_ECANCEL. */
SN_MUST_USE sn_status sn_shape_mesh(const sn_shape *s, double cell, const sn_run *run, sn_tri_mesh *out, sn_error *err);

#endif
