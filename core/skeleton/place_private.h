/* place_private.h - what the files that place bones share. */
#ifndef SN_SKELETON_PLACE_PRIVATE_H
#define SN_SKELETON_PLACE_PRIVATE_H

#include "base/run.h"
#include "mesh/affine.h"
#include "skeleton/bone_template.h"

#define SN_RADIANS (3.14159265358979323846 / 180.0) /* per degree */

/* ---- small vectors; axis, a and b: unit ---- */

/* The part of v across the axis. */
static inline sn_vec3 sn_across(sn_vec3 v, sn_vec3 axis)
{
    return sn_v3_mad(v, -sn_v3_dot(v, axis), axis);
}

/* A unit vector across the axis: the coordinate direction farthest from it, made perpendicular. */
static inline sn_vec3 sn_any_across(sn_vec3 axis)
{
    double x = fabs(axis.x), y = fabs(axis.y), z = fabs(axis.z);
    sn_vec3 e = x <= y && x <= z ? sn_v3(1, 0, 0) : z <= y ? sn_v3(0, 0, 1) : sn_v3(0, 1, 0);
    return sn_v3_unit(sn_across(e, axis));
}

/* v after the smallest turn that takes a to b; where they are opposite, half a turn about sn_any_across(a).
 */
sn_vec3 sn_turn_along(sn_vec3 v, sn_vec3 a, sn_vec3 b);

/* ---- what the user gave ---- */

sn_vec3 sn_front_or_z(sn_vec3 front);                    /* unit; +z for 0 */
const char *sn_template_name(const sn_bone_template *t); /* for messages   */

/* ---- rows of bones ---- */

/* Unit directions across the tangents, as near to front as these let them be, for n >= 1 places in order
 * along a curve. Where the tangent comes within 20 degrees of front the direction turns evenly from the one
 * before to the one after, beginning and ending with the smallest turn; it never changes its sign, so that
 * beyond such a place it may be the opposite of front that the direction is near to. It is near to front
 * itself where the tangent is farthest from it. tangent and front: unit. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_row_fronts(const sn_vec3 *tangent, int32_t n, sn_vec3 front, sn_vec3 *out,
                                    sn_error *err);

/* The lowest two of n copies of a bone, each with its own map, whose surfaces cross or of which one holds the
 * other; -1, -1 when there are none. Exact for coordinates as sn_affine_mesh gives them. Errors: SN_ENOMEM,
 * SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_row_crossing(const sn_tri_mesh *bone, const sn_affine *map, int32_t n,
                                      const sn_run *run, int32_t pair[2], sn_error *err);

#endif
