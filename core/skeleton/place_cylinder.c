/* place_cylinder.c - a bone between two joints. */
#include "skeleton/place.h"

#include "skeleton/place_private.h"

#include <math.h>

static const double NEAR_AXIS_DEG = 5.0; /* nearer to the axis, a front says nothing about the turn */

static sn_status check(const sn_bone_template *t, sn_vec3 from, sn_vec3 to, const sn_cylinder_options *opt,
                       sn_error *err)
{
    const char *name = sn_template_name(t);
    if (t->kind != SN_BONE_CYLINDER)
        return sn_fail(err, SN_EINVAL, "bone template '%s' is no cylinder: it has no two ends to place",
                       name);
    if (!sn_v3_is_finite(from) || !sn_v3_is_finite(to))
        return sn_fail(err, SN_EINVAL, "bone '%s': an end has a coordinate that is not finite", name);
    if (!(sn_v3_dist(from, to) > 0.0))
        return sn_fail(err, SN_EINVAL, "bone '%s': both ends are at (%g, %g, %g), need two different places",
                       name, from.x, from.y, from.z);
    if (!(sn_v3_dist(t->from, t->to) > 0.0))
        return sn_fail(err, SN_EINVAL, "bone template '%s': both handles are at (%g, %g, %g)", name,
                       t->from.x, t->from.y, t->from.z);
    if (!(opt->thickness >= 0.0 && isfinite(opt->thickness)))
        return sn_fail(err, SN_EINVAL, "bone '%s': thickness is %g, need > 0, or 0 for the template's", name,
                       opt->thickness);
    if (!isfinite(opt->twist_deg))
        return sn_fail(err, SN_EINVAL, "bone '%s': twist is %g degrees, need a finite number", name,
                       opt->twist_deg);
    if (!sn_v3_is_finite(opt->front))
        return sn_fail(err, SN_EINVAL, "bone '%s': front has a coordinate that is not finite", name);
    return SN_OK;
}

/* Two directions across the axis, one of the template and where it goes. */
static void match_across(sn_vec3 axis, sn_vec3 goal, sn_vec3 front, sn_vec3 *across, sn_vec3 *goes_to)
{
    const sn_vec3 z = {0, 0, 1};
    *across = sn_across(z, axis);
    *goes_to = sn_across(front, goal);
    double least = sin(NEAR_AXIS_DEG * SN_RADIANS);
    if (sn_v3_len(*across) < least || sn_v3_len(*goes_to) < least) {
        *across = sn_any_across(axis);
        *goes_to = sn_across(sn_turn_along(*across, axis, goal), goal);
    }
    *across = sn_v3_unit(*across);
    *goes_to = sn_v3_unit(*goes_to);
}

/* M = along goal u' + k (g w' + h v'): the axis u goes to goal, what is across it by its own factor. */
static sn_affine stretch(sn_vec3 u, sn_vec3 w, sn_vec3 goal, sn_vec3 g, double along, double k)
{
    const sn_vec3 v = sn_v3_cross(w, u), h = sn_v3_cross(g, goal);
    const double u_at[3] = {u.x, u.y, u.z}, w_at[3] = {w.x, w.y, w.z}, v_at[3] = {v.x, v.y, v.z};
    sn_affine a = {.t = {0, 0, 0}};
    for (int i = 0; i < 3; i++)
        a.col[i] = sn_v3_add(sn_v3_scale(along * u_at[i], goal),
                             sn_v3_add(sn_v3_scale(k * w_at[i], g), sn_v3_scale(k * v_at[i], h)));
    return a;
}

sn_status sn_place_cylinder(const sn_bone_template *t, sn_vec3 from, sn_vec3 to,
                            const sn_cylinder_options *opt, sn_affine *out, sn_error *err)
{
    sn_status st = check(t, from, to, opt, err);
    if (st) return st;
    sn_affine mirror = sn_affine_identity();
    if (opt->is_mirrored) mirror = sn_affine_mirror(sn_v3(0, 0, 0), sn_v3(1, 0, 0));
    sn_vec3 start = sn_affine_point(&mirror, t->from), end = sn_affine_point(&mirror, t->to);
    sn_vec3 u = sn_v3_unit(sn_v3_sub(end, start)), goal = sn_v3_unit(sn_v3_sub(to, from)), w, g;
    match_across(u, goal, sn_front_or_z(opt->front), &w, &g);
    sn_affine twist = sn_affine_rotation(goal, opt->twist_deg, sn_v3(0, 0, 0));
    double along = sn_v3_dist(from, to) / sn_v3_dist(start, end);
    double k = opt->thickness > 0.0 ? opt->thickness : along;
    if (!isfinite(along) || !(along > 0.0))
        return sn_fail(err, SN_EINVAL, "bone '%s': it would be scaled by %g", sn_template_name(t), along);
    sn_affine m = stretch(u, w, goal, sn_affine_vector(&twist, g), along, k);
    m.t = sn_v3_sub(from, sn_affine_vector(&m, start));
    *out = sn_affine_after(m, mirror);
    return SN_OK;
}

sn_affine sn_place_ends(const sn_vec3 end[2], const sn_vec3 goal[2], double thickness)
{
    sn_vec3 u = sn_v3_unit(sn_v3_sub(end[1], end[0])), v = sn_v3_unit(sn_v3_sub(goal[1], goal[0]));
    sn_vec3 across = sn_any_across(u);
    double along = sn_v3_dist(goal[0], goal[1]) / sn_v3_dist(end[0], end[1]);
    sn_affine m = stretch(u, across, v, sn_turn_along(across, u, v), along, thickness);
    m.t = sn_v3_sub(goal[0], sn_affine_vector(&m, end[0]));
    return m;
}
