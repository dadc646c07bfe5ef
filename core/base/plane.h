/* plane.h - a plane through a point: on which side a place lies, how far, and its reflection.
 *
 * A plane across a coordinate axis is met exactly: projected points have its very coordinate, and points off
 * it keep the other two. For others results are right up to rounding. */
#ifndef SN_BASE_PLANE_H
#define SN_BASE_PLANE_H

#include "base/status.h"
#include "base/vec3.h"

/* Points nearer than this to a plane, relative to the diagonal of the box of what it cuts or mirrors, count
 * as on it. */
#define SN_PLANE_REL 1e-9

typedef struct sn_plane { /* made by sn_plane_make */
    sn_vec3 point;
    sn_vec3 normal; /* unit                                                       */
    int axis;       /* 0..2: the plane is exactly across x, y or z; -1: it is not */
} sn_plane;

/* normal: of any length. what: begins the message ("cut"). Errors: SN_EINVAL (a coordinate that is not
 * finite, a normal of zero). */
SN_MUST_USE sn_status sn_plane_make(sn_plane *p, const char *what, sn_vec3 point, sn_vec3 normal,
                                    sn_error *err);

/* Distance, > 0 on the side that the normal points to. */
static inline double sn_plane_height(const sn_plane *p, sn_vec3 q)
{
    return sn_v3_dot(p->normal, sn_v3_sub(q, p->point));
}
sn_vec3 sn_plane_project(const sn_plane *p, sn_vec3 q); /* the nearest point of the plane */
sn_vec3 sn_plane_reflect(const sn_plane *p, sn_vec3 q); /* of a point                     */
sn_vec3 sn_plane_reflect_vector(const sn_plane *p, sn_vec3 v);

#endif
