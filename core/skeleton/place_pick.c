/* place_pick.c - a place inside the limb under a ray. */
#include "skeleton/place.h"

#include "base/alloc.h"

#include <math.h>

/* Where a ray only touches the skin, entering and leaving are this near, in diagonals of the skin's box. */
static const double TOUCH_REL = 1e-12;

/* ---- how far off a ray is that misses ---- */

typedef struct near_miss {
    double dist;
    sn_vec3 at; /* on the skin */
} near_miss;

static void take_nearer(near_miss *best, sn_vec3 on_ray, sn_vec3 on_skin)
{
    double dist = sn_v3_dist(on_ray, on_skin);
    if (dist < best->dist) *best = (near_miss){dist, on_skin};
}

/* The ray from o along the unit vector d and the segment a, b: their nearest points. */
static void take_edge(near_miss *best, sn_vec3 o, sn_vec3 d, sn_vec3 a, sn_vec3 b)
{
    sn_vec3 ab = sn_v3_sub(b, a), oa = sn_v3_sub(a, o);
    double slant = sn_v3_dot(d, ab), len2 = sn_v3_len2(ab), flat = len2 - slant * slant;
    double s = flat > 1e-14 * len2 ? (slant * sn_v3_dot(d, oa) - sn_v3_dot(ab, oa)) / flat : 0.0;
    s = fmin(fmax(s, 0.0), 1.0);
    double t = sn_v3_dot(d, sn_v3_mad(oa, s, ab));
    if (t < 0.0) { /* the segment's nearest point to the origin of the ray */
        t = 0.0;
        s = len2 > 0.0 ? fmin(fmax(-sn_v3_dot(ab, oa) / len2, 0.0), 1.0) : 0.0;
    }
    take_nearer(best, sn_v3_mad(o, t, d), sn_v3_mad(a, s, ab));
}

/* The ray meets no face: the nearest place is on an edge, or is the one nearest to the origin. */
static near_miss nearest_to_ray(const sn_bvh *skin, sn_vec3 origin, sn_vec3 dir)
{
    const sn_tri_mesh *m = sn_bvh_mesh(skin);
    sn_closest c = sn_bvh_closest(skin, origin);
    near_miss best = {c.dist, c.point};
    for (int32_t f = 0; f < m->n_face; f++)
        for (int k = 0; k < 3; k++) {
            const int32_t *v = m->face + 3 * (size_t)f;
            take_edge(&best, origin, dir, sn_tri_mesh_point(m, v[k]), sn_tri_mesh_point(m, v[(k + 1) % 3]));
        }
    return best;
}

/* ---- the pick ---- */

static sn_status fail_miss(const sn_bvh *skin, sn_vec3 o, sn_vec3 dir, double touch, sn_error *err)
{
    near_miss m = nearest_to_ray(skin, o, dir);
    if (m.dist <= touch)
        return sn_fail(err, SN_EINVAL, "the ray from (%g, %g, %g) only touches the skin at (%g, %g, %g)", o.x,
                       o.y, o.z, m.at.x, m.at.y, m.at.z);
    return sn_fail(err, SN_EINVAL,
                   "the ray from (%g, %g, %g) misses the skin by %g: the skin is nearest at (%g, %g, %g)",
                   o.x, o.y, o.z, m.dist, m.at.x, m.at.y, m.at.z);
}

/* The first two hits that are apart. */
static sn_status first_two(const sn_bvh *skin, const sn_ray_hit *hit, size_t n, sn_vec3 origin, sn_vec3 dir,
                           sn_vec3 *out, sn_error *err)
{
    double touch = TOUCH_REL * sn_box3_diagonal(sn_tri_mesh_bounds(sn_bvh_mesh(skin)));
    size_t i = 0;
    while (i + 1 < n && hit[i].entering && sn_v3_dist(hit[i].point, hit[i + 1].point) <= touch) i += 2;
    if (i >= n) return fail_miss(skin, origin, dir, touch, err);
    sn_vec3 p = hit[i].point;
    if (!hit[i].entering)
        return sn_fail(err, SN_EINVAL,
                       "the ray from (%g, %g, %g) starts inside the skin, which it leaves at (%g, %g, %g): "
                       "need a start outside",
                       origin.x, origin.y, origin.z, p.x, p.y, p.z);
    if (i + 1 == n || hit[i + 1].entering)
        return sn_fail(err, SN_EINVAL,
                       "the ray enters the skin at (%g, %g, %g) and does not leave it: need a closed skin "
                       "that does not cross itself",
                       p.x, p.y, p.z);
    *out = sn_v3_lerp(p, hit[i + 1].point, 0.5);
    return SN_OK;
}

sn_status sn_pick_midpoint(const sn_bvh *skin, sn_vec3 origin, sn_vec3 dir, sn_vec3 *out, sn_error *err)
{
    double size = fmax(fabs(dir.x), fmax(fabs(dir.y), fabs(dir.z)));
    if (!sn_v3_is_finite(origin) || !sn_v3_is_finite(dir) || !(size > 0.0))
        return sn_fail(err, SN_EINVAL,
                       "a ray from (%g, %g, %g) along (%g, %g, %g): need finite numbers and a direction that "
                       "is not zero",
                       origin.x, origin.y, origin.z, dir.x, dir.y, dir.z);
    sn_vec3 unit = sn_v3_unit(sn_v3(dir.x / size, dir.y / size, dir.z / size)); /* no overflow */
    sn_ray_hit *hit = NULL;
    size_t n = 0;
    sn_status st = sn_bvh_ray_all(skin, origin, unit, INFINITY, &hit, &n, err);
    if (!st) st = first_two(skin, hit, n, origin, unit, out, err);
    sn_release(hit);
    return st;
}
