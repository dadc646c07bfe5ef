#include "base/plane.h"

sn_status sn_plane_make(sn_plane *p, const char *what, sn_vec3 point, sn_vec3 normal, sn_error *err)
{
    double size = fmax(fabs(normal.x), fmax(fabs(normal.y), fabs(normal.z)));
    if (!sn_v3_is_finite(point) || !sn_v3_is_finite(normal) || !(size > 0.0))
        return sn_fail(err, SN_EINVAL, "%s: the plane needs a finite point and a normal that is not zero",
                       what);
    p->point = point;
    p->normal = sn_v3_unit(sn_v3(normal.x / size, normal.y / size, normal.z / size)); /* no overflow */
    p->axis = -1;
    if (normal.y == 0.0 && normal.z == 0.0) p->axis = 0;
    if (normal.z == 0.0 && normal.x == 0.0) p->axis = 1;
    if (normal.x == 0.0 && normal.y == 0.0) p->axis = 2;
    return SN_OK;
}

sn_vec3 sn_plane_project(const sn_plane *p, sn_vec3 q)
{
    switch (p->axis) {
    case 0:
        return sn_v3(p->point.x, q.y, q.z);
    case 1:
        return sn_v3(q.x, p->point.y, q.z);
    case 2:
        return sn_v3(q.x, q.y, p->point.z);
    default:
        return sn_v3_mad(q, -sn_plane_height(p, q), p->normal);
    }
}

sn_vec3 sn_plane_reflect(const sn_plane *p, sn_vec3 q)
{
    switch (p->axis) {
    case 0:
        return sn_v3(2.0 * p->point.x - q.x, q.y, q.z);
    case 1:
        return sn_v3(q.x, 2.0 * p->point.y - q.y, q.z);
    case 2:
        return sn_v3(q.x, q.y, 2.0 * p->point.z - q.z);
    default:
        return sn_v3_mad(q, -2.0 * sn_plane_height(p, q), p->normal);
    }
}

sn_vec3 sn_plane_reflect_vector(const sn_plane *p, sn_vec3 v)
{
    return sn_v3_mad(v, -2.0 * sn_v3_dot(p->normal, v), p->normal);
}
