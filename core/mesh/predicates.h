/* predicates.h - exact signs: a floating-point filter, and GMP integers where it cannot tell.
 *
 * Coordinates must be finite; otherwise every answer is right, also for numbers whose products overflow or
 * vanish. Nothing here allocates. The filters are inline: a clear case costs about twenty multiplications. */
#ifndef SN_MESH_PREDICATES_H
#define SN_MESH_PREDICATES_H

#include "base/vec3.h"

#include <stdbool.h>

/* The same signs as the functions without _exact, always by integers: about fifty times slower. */
int sn_orient3d_exact(sn_vec3 a, sn_vec3 b, sn_vec3 c, sn_vec3 d);
int sn_orient2d_exact(sn_vec3 a, sn_vec3 b, sn_vec3 c, int axis);

/* Error bounds of Shewchuk (1997), rounded up, and a term for what products lose when they underflow. */
#define SN_ORIENT3D_REL 7.8e-16
#define SN_ORIENT2D_REL 3.4e-16
#define SN_ORIENT_ABS 1e-300

/* Sign (-1, 0, 1) of det[b-a, c-a, d-a]: 1 when (a,b,c,d) is a positive tet. Exact. */
static inline int sn_orient3d(sn_vec3 a, sn_vec3 b, sn_vec3 c, sn_vec3 d)
{
    sn_vec3 u = sn_v3_sub(b, a), v = sn_v3_sub(c, a), w = sn_v3_sub(d, a);
    double yz = u.y * v.z, zy = u.z * v.y, zx = u.z * v.x, xz = u.x * v.z, xy = u.x * v.y, yx = u.y * v.x;
    double wx = fabs(w.x), wy = fabs(w.y), wz = fabs(w.z);
    double det = w.x * (yz - zy) + w.y * (zx - xz) + w.z * (xy - yx);
    double size = wx * (fabs(yz) + fabs(zy)) + wy * (fabs(zx) + fabs(xz)) + wz * (fabs(xy) + fabs(yx));
    double bound = SN_ORIENT3D_REL * size + SN_ORIENT_ABS * (1.0 + wx + wy + wz);
    if (det > bound) return 1; /* an overflow makes the bound infinite or NaN: both tests fail */
    if (det < -bound) return -1;
    return sn_orient3d_exact(a, b, c, d);
}

/* The two coordinates left after dropping `axis`, in cyclic order: yz, zx, xy. */
static inline void sn_drop_axis(sn_vec3 p, int axis, double *s, double *t)
{
    *s = axis == 0 ? p.y : axis == 1 ? p.z : p.x;
    *t = axis == 0 ? p.z : axis == 1 ? p.x : p.y;
}

/* Sign of the area of (a,b,c) after dropping coordinate `axis` (0..2) and keeping the cyclic order of the
 * others: the sign of that component of (b-a) x (c-a). Exact. */
static inline int sn_orient2d(sn_vec3 a, sn_vec3 b, sn_vec3 c, int axis)
{
    double as, at, bs, bt, cs, ct;
    sn_drop_axis(a, axis, &as, &at);
    sn_drop_axis(b, axis, &bs, &bt);
    sn_drop_axis(c, axis, &cs, &ct);
    double left = (bs - as) * (ct - at), right = (bt - at) * (cs - as), det = left - right;
    double bound = SN_ORIENT2D_REL * (fabs(left) + fabs(right)) + SN_ORIENT_ABS;
    if (det > bound) return 1;
    if (det < -bound) return -1;
    return sn_orient2d_exact(a, b, c, axis);
}

/* The triangle's three corners lie on one line (or coincide). Exact. */
bool sn_triangle_is_degenerate(sn_vec3 a, sn_vec3 b, sn_vec3 c);

/* Whether two triangles of one surface cross or touch anywhere but in the corners they share. p, q: corner
 * positions; i, j: vertex ids; equal ids are shared corners, equal positions alone are not. Two shared
 * corners: only a fold onto each other (coplanar, same side) counts. Three shared: true. Degenerate triangles
 * are treated as the segment or point they are. Exact, and the same when (p,i) and (q,j) change places. */
bool sn_triangles_cross(const sn_vec3 p[3], const int i[3], const sn_vec3 q[3], const int j[3]);
/* Segment (a,b), both ends included, meets the closed triangle (p,q,r). Exact, coplanar and degenerate cases
 * too. */
bool sn_segment_meets_triangle(sn_vec3 a, sn_vec3 b, sn_vec3 p, sn_vec3 q, sn_vec3 r);

#endif
