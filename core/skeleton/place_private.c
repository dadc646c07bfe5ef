#include "skeleton/place_private.h"

#include <math.h>

static sn_vec3 half_turn(sn_vec3 axis, sn_vec3 v)
{
    return sn_v3_sub(sn_v3_scale(2.0 * sn_v3_dot(axis, v), axis), v);
}

/* Half a turn about a and half a turn about the middle of a and b are the whole way from a to b. */
sn_vec3 sn_turn_along(sn_vec3 v, sn_vec3 a, sn_vec3 b)
{
    sn_vec3 middle = sn_v3_add(a, b);
    if (sn_v3_len(middle) < 1e-8) return half_turn(sn_any_across(a), v);
    return half_turn(sn_v3_unit(middle), half_turn(a, v));
}

sn_vec3 sn_front_or_z(sn_vec3 front)
{
    double size = fmax(fabs(front.x), fmax(fabs(front.y), fabs(front.z)));
    if (!(size > 0.0)) return sn_v3(0, 0, 1);
    return sn_v3_unit(sn_v3(front.x / size, front.y / size, front.z / size)); /* no overflow */
}

const char *sn_template_name(const sn_bone_template *t)
{
    return t->name ? t->name : "?";
}
