/* shape.h - implicit shapes for skins and bones made by a script, and their closed meshes.
 *
 * A shape is an immutable, reference-counted tree of signed distance functions (negative inside). Spheres,
 * ellipsoids, capsules, boxes, plates and tori give the exact distance; unions are exact outside;
 * subtractions, intersections, smooth combinations and uneven scales give a lower bound of the distance. No
 * value changes faster than the point moves. Lengths in the scene's unit. Shapes may be shared between
 * threads. */
#ifndef SN_MESH_SHAPE_H
#define SN_MESH_SHAPE_H

#include "base/run.h"
#include "mesh/tri_mesh.h"

typedef struct sn_shape sn_shape; /* opaque, reference-counted, immutable */

sn_shape *sn_shape_retain(sn_shape *s);
void sn_shape_release(sn_shape *s); /* NULL is fine */

/* All constructors: *out receives a new shape to _release, NULL on error. They retain their operands; one
 * shape may be used many times. Errors: SN_EINVAL with the argument's name for coordinates that are not
 * finite or above 1e50, for radii and sizes not in 1e-50..1e50 and for operands that are NULL; SN_ELIMIT
 * for trees nested deeper than 1000; SN_ENOMEM. */
SN_MUST_USE sn_status sn_shape_sphere(sn_shape **out, sn_vec3 center, double radius, sn_error *err);
SN_MUST_USE sn_status sn_shape_ellipsoid(sn_shape **out, sn_vec3 center, sn_vec3 radii, sn_error *err);
/* A cone with round ends: radius ra at a, rb at b. Where one ball holds the other it alone is left. */
SN_MUST_USE sn_status sn_shape_capsule(sn_shape **out, sn_vec3 a, sn_vec3 b, double ra, double rb,
                                       sn_error *err);
/* half: half sizes; rounding: radius of the edges, >= 0 and at most the smallest half size. */
SN_MUST_USE sn_status sn_shape_box(sn_shape **out, sn_vec3 center, sn_vec3 half, double rounding,
                                   sn_error *err);
/* A ring around the axis through center. axis: any length > 0. tube: half the thickness of the ring; above
 * ring the hole is closed. */
SN_MUST_USE sn_status sn_shape_torus(sn_shape **out, sn_vec3 center, sn_vec3 axis, double ring, double tube,
                                     sn_error *err);
/* All points within radius of the triangle a, b, c, whose corners may not lie on a line. */
SN_MUST_USE sn_status sn_shape_plate(sn_shape **out, sn_vec3 a, sn_vec3 b, sn_vec3 c, double radius,
                                     sn_error *err);
/* n >= 1. Many shapes are better given to one union than nested. */
SN_MUST_USE sn_status sn_shape_union(sn_shape **out, sn_shape *const *s, int n, sn_error *err);
/* k: blend length > 0 (polynomial smooth minimum: where two shapes meet the surface swells by at most k/4,
 * where many do by less than k). Blended in the given order: with three or more the order shows where all of
 * them meet. */
SN_MUST_USE sn_status sn_shape_smooth_union(sn_shape **out, double k, sn_shape *const *s, int n,
                                            sn_error *err);
/* a minus b. */
SN_MUST_USE sn_status sn_shape_subtract(sn_shape **out, sn_shape *a, sn_shape *b, sn_error *err);
/* a minus b with a rounded rim: there the surface sinks by at most k/4. */
SN_MUST_USE sn_status sn_shape_smooth_subtract(sn_shape **out, double k, sn_shape *a, sn_shape *b,
                                               sn_error *err);
/* What lies in all of them, n >= 1. */
SN_MUST_USE sn_status sn_shape_intersect(sn_shape **out, sn_shape *const *s, int n, sn_error *err);

typedef struct sn_shape_placement {
    sn_vec3 scale; /* along x, y, z, each > 0 */
    sn_vec3 axis;  /* any length > 0; not looked at when the angle is 0 */
    double angle_deg;
    sn_vec3 translate;
} sn_shape_placement;
/* s scaled, then turned about the origin, then moved. */
SN_MUST_USE sn_status sn_shape_transform(sn_shape **out, sn_shape *s, const sn_shape_placement *t,
                                         sn_error *err);
/* s reflected in the plane through point. normal: any length > 0. */
SN_MUST_USE sn_status sn_shape_mirror(sn_shape **out, sn_shape *s, sn_vec3 point, sn_vec3 normal,
                                      sn_error *err);

double sn_shape_value(const sn_shape *s, sn_vec3 p);
/* Holds the surface; not the tightest box after anything but a union. */
sn_box3 sn_shape_bounds(const sn_shape *s);

/* A closed, manifold, oriented surface without self-intersections, triangles of edge length about `cell`:
 * marching tetrahedra on a lattice finer than cell (manifold by construction), then remeshed. Its faces stay
 * within a fraction of a cell of the surface. Sharp edges are cut off by less than a cell; features thinner
 * than a cell may be lost. Should remeshing break one of these promises, the finer lattice surface is given
 * as it is. out: init-ed; on error it is left empty. Errors: SN_EINVAL (cell), SN_EMESH (nothing inside: the
 * shape is empty or cell too coarse), SN_ELIMIT (over 2e8 lattice points: says which cell would do),
 * SN_ENOMEM, SN_ECANCEL. */
SN_MUST_USE sn_status sn_shape_mesh(const sn_shape *s, double cell, const sn_run *run, sn_tri_mesh *out,
                                    sn_error *err);

#endif
