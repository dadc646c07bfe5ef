/* predicates.h - exact signs: a floating-point filter, and GMP rationals where it cannot tell.
 * Coordinates must be finite. */
#ifndef SN_MESH_PREDICATES_H
#define SN_MESH_PREDICATES_H

#include "base/vec3.h"

#include <stdbool.h>

/* Sign (-1, 0, 1) of det[b-a, c-a, d-a]: 1 when (a,b,c,d) is a positive tet. Exact. */
int sn_orient3d(sn_vec3 a, sn_vec3 b, sn_vec3 c, sn_vec3 d);
/* Sign of the area of (a,b,c) after dropping coordinate `axis` (0..2) and keeping the cyclic order of the others. Exact. */
int sn_orient2d(sn_vec3 a, sn_vec3 b, sn_vec3 c, int axis);
/* The triangle's three corners lie on one line (or coincide). Exact. */
bool sn_triangle_is_degenerate(sn_vec3 a, sn_vec3 b, sn_vec3 c);

/* Whether two triangles of one surface cross or touch anywhere but in the corners they share. p, q: corner positions;
 * i, j: vertex ids; equal ids are shared corners. Two shared corners: only a fold onto each other (coplanar, same
 * side) counts. Three shared: true. Degenerate triangles are treated as the segment or point they are. Exact. */
bool sn_triangles_cross(const sn_vec3 p[3], const int i[3], const sn_vec3 q[3], const int j[3]);
/* Segment (a,b), both ends included, meets the closed triangle (p,q,r). Exact, coplanar cases too. */
bool sn_segment_meets_triangle(sn_vec3 a, sn_vec3 b, sn_vec3 p, sn_vec3 q, sn_vec3 r);

#endif
