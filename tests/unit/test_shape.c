/* test_shape - distances against brute force, the bound that lets blocks be skipped, bounds, meshes, every
 * message. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/alloc.h"
#include "mesh/shape.h"

#include "closed_surface.h"

#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

/* ---- short ways to make shapes ---- */

static void ok(sn_status st, const sn_error *err)
{
    if (st) fail_msg("%s", err->msg);
}

static sn_shape *sphere(double x, double y, double z, double r)
{
    sn_shape *s;
    sn_error err;
    ok(sn_shape_sphere(&s, sn_v3(x, y, z), r, &err), &err);
    return s;
}

static sn_shape *capsule(sn_vec3 a, sn_vec3 b, double ra, double rb)
{
    sn_shape *s;
    sn_error err;
    ok(sn_shape_capsule(&s, a, b, ra, rb, &err), &err);
    return s;
}

static sn_shape *ellipsoid(double x, double y, double z)
{
    sn_shape *s;
    sn_error err;
    ok(sn_shape_ellipsoid(&s, sn_v3(0, 0, 0), sn_v3(x, y, z), &err), &err);
    return s;
}

static sn_shape *box(double x, double y, double z, double rounding)
{
    sn_shape *s;
    sn_error err;
    ok(sn_shape_box(&s, sn_v3(0, 0, 0), sn_v3(x, y, z), rounding, &err), &err);
    return s;
}

/* The next three take their operands over. */
static sn_shape *joined(sn_shape *a, sn_shape *b)
{
    sn_shape *s, *part[2] = {a, b};
    sn_error err;
    ok(sn_shape_union(&s, part, 2, &err), &err);
    sn_shape_release(a);
    sn_shape_release(b);
    return s;
}

static sn_shape *blended(double k, sn_shape *a, sn_shape *b)
{
    sn_shape *s, *part[2] = {a, b};
    sn_error err;
    ok(sn_shape_smooth_union(&s, k, part, 2, &err), &err);
    sn_shape_release(a);
    sn_shape_release(b);
    return s;
}

static sn_shape *cut(sn_shape *a, sn_shape *b)
{
    sn_shape *s;
    sn_error err;
    ok(sn_shape_subtract(&s, a, b, &err), &err);
    sn_shape_release(a);
    sn_shape_release(b);
    return s;
}

static double rnd(uint64_t *seed) /* -1..1 */
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * ldexp(1.0, -52) - 1.0;
}

static sn_vec3 rnd_point(uint64_t *seed, double reach)
{
    double x = rnd(seed), y = rnd(seed), z = rnd(seed);
    return sn_v3(reach * x, reach * y, reach * z);
}

static void near_to(double found, double wanted, double tol)
{
    if (!(fabs(found - wanted) <= tol)) fail_msg("found %.17g, wanted %.17g", found, wanted);
}

static void value_is(const sn_shape *s, double x, double y, double z, double wanted)
{
    near_to(sn_shape_value(s, sn_v3(x, y, z)), wanted, 1e-12);
}

/* ---- distances ---- */

static void sphere_distance(void **state)
{
    (void)state;
    sn_shape *s = sphere(1, 2, 3, 0.5);
    value_is(s, 1, 2, 3, -0.5);
    value_is(s, 1, 2, 3.5, 0.0);
    value_is(s, 1, 5, 7, 4.5); /* 3, 4, 5 */
    sn_box3 b = sn_shape_bounds(s);
    assert_true(b.min.x == 0.5 && b.max.z == 3.5);
    sn_shape_release(s);
}

/* Axis from 0 to 5 along x, radii 4 and 1: s = 3/5, c = 4/5. The flank's normal is (0.6, 0.8) and touches the
 * circles at 4 (0.6, 0.8) and (5, 0) + (0.6, 0.8). */
static void capsule_distance(void **state)
{
    (void)state;
    sn_shape *s = capsule(sn_v3(0, 0, 0), sn_v3(5, 0, 0), 4, 1);
    value_is(s, -6, 0, 0, 2.0);
    value_is(s, 0, 0, 0, -4.0);
    value_is(s, 9, 0, 0, 3.0);
    value_is(s, 2.4, 3.2, 0, 0.0);
    value_is(s, 5.6, 0, 0.8, 0.0);
    value_is(s, 4.0, 0, -2.0, 0.0);                     /* half way on the flank */
    value_is(s, 4.0 + 0.6 * 3, -2.0 - 0.8 * 3, 0, 3.0); /* out along the normal */
    sn_box3 b = sn_shape_bounds(s);
    assert_true(b.min.x == -4.0 && b.max.x == 6.0 && b.max.y == 4.0);
    sn_shape_release(s);
}

/* The round cone is the union of the balls along the axis whose radius runs linearly: outside, the nearest of
 * them. */
static void capsule_against_balls(void **state)
{
    (void)state;
    uint64_t seed = 5;
    for (int i = 0; i < 200; i++) {
        sn_vec3 a = rnd_point(&seed, 1.0), b = rnd_point(&seed, 1.0), p = rnd_point(&seed, 2.0);
        double ra = 0.05 + 0.4 * fabs(rnd(&seed)), rb = 0.05 + 0.4 * fabs(rnd(&seed)), best = INFINITY;
        for (int k = 0; k <= 20000; k++) {
            double t = k / 20000.0;
            best = fmin(best, sn_v3_dist(p, sn_v3_lerp(a, b, t)) - ra - t * (rb - ra));
        }
        sn_shape *s = capsule(a, b, ra, rb);
        near_to(sn_shape_value(s, p), best, 1e-6); /* also inside: the same formula */
        sn_shape_release(s);
    }
}

static void capsule_of_one_ball(void **state)
{
    (void)state;
    sn_shape *same = capsule(sn_v3(1, 0, 0), sn_v3(1, 0, 0), 0.2, 0.3);
    value_is(same, 2, 0, 0, 0.7);
    sn_shape *inner = capsule(sn_v3(0, 0, 0), sn_v3(1, 0, 0), 1.0, 2.0); /* touches from within */
    value_is(inner, -2, 0, 0, 1.0);
    value_is(inner, 5, 0, 0, 2.0);
    sn_shape *barely = capsule(sn_v3(0, 0, 0), sn_v3(1, 0, 0), 1.0, 2.0 - 1e-15);
    near_to(sn_shape_value(barely, sn_v3(0, 5, 0)), sqrt(26.0) - 2.0, 1e-6);
    sn_shape_release(same);
    sn_shape_release(inner);
    sn_shape_release(barely);
}

static void box_distance(void **state)
{
    (void)state;
    sn_shape *s = box(1, 2, 3, 0), *r = box(1, 2, 3, 0.5);
    value_is(s, 0, 0, 0, -1.0);
    value_is(s, 0.25, 1.9, 0, -0.1);
    value_is(s, 3, 0, 0, 2.0);
    value_is(s, 4, -6, 0, 5.0); /* 3, 4, 5 from the edge */
    value_is(s, 2, 4, -5, 3.0); /* 1, 2, 2, 3 from the corner */
    value_is(r, 0, 0, 0, -1.0);
    value_is(r, 3, 0, 0, 2.0);
    value_is(r, 0.5, 1.5, 0, -0.5); /* on the axis of a round edge */
    value_is(r, 3.5, 5.5, 0, 4.5);
    value_is(r, 1.5, 3.5, 4.5, 2.5);
    sn_shape *ball = box(1, 1, 1, 1);
    value_is(ball, 3, 4, 0, 4.0);
    sn_shape_release(s);
    sn_shape_release(r);
    sn_shape_release(ball);
}

static void ellipsoid_distance_at_known_points(void **state)
{
    (void)state;
    sn_shape *s = ellipsoid(3, 2, 1);
    value_is(s, 0, 0, 0, -1.0);
    value_is(s, 4, 0, 0, 1.0);
    value_is(s, 0, -4, 0, 2.0);
    value_is(s, 0, 0, 1, 0.0);
    value_is(s, 0, 0, 0.5, -0.5);
    value_is(s, 2.99, 0, 0, -0.01); /* beyond the focus (9 - 1) / 3 */
    /* (1, 0, 0) is inside the focal curve: closest at x = 9 / (9 - 1), z = sqrt(1 - x^2 / 9) */
    double x = 9.0 / 8.0;
    value_is(s, 1, 0, 0, -sqrt((x - 1) * (x - 1) + 1.0 - x * x / 9.0));
    sn_shape *ball = ellipsoid(2, 2, 2), *plate = ellipsoid(1e3, 1e3, 1e-3);
    value_is(ball, 0, 0, 0, -2.0);
    value_is(ball, 3, 4, 0, 3.0);
    value_is(plate, 0, 0, 7, 7 - 1e-3);
    value_is(plate, 0, 0, 0, -1e-3);
    sn_shape_release(s);
    sn_shape_release(ball);
    sn_shape_release(plate);
}

/* From a surface point straight along the normal: outwards the distance is the way gone. */
static void ellipsoid_distance_along_normals(void **state)
{
    (void)state;
    uint64_t seed = 11;
    for (int i = 0; i < 2000; i++) {
        sn_vec3 e = sn_v3(exp(3 * rnd(&seed)), exp(3 * rnd(&seed)), exp(3 * rnd(&seed)));
        sn_vec3 u = sn_v3_unit(rnd_point(&seed, 1.0));
        if (i % 5 == 0) u.z *= 1e-12; /* nearly in a plane of symmetry */
        u = sn_v3_unit(u);
        sn_vec3 p = sn_v3(e.x * u.x, e.y * u.y, e.z * u.z);
        sn_vec3 n = sn_v3_unit(sn_v3(u.x / e.x, u.y / e.y, u.z / e.z));
        double far = fabs(rnd(&seed)) * 3.0, largest = fmax(e.x, fmax(e.y, e.z));
        sn_shape *s = ellipsoid(e.x, e.y, e.z);
        near_to(sn_shape_value(s, sn_v3_mad(p, far, n)), far, 1e-11 * (largest + far));
        near_to(sn_shape_value(s, p), 0.0, 1e-12 * largest);
        double deep = 0.5 * fmin(e.x, fmin(e.y, e.z)) * fmin(e.x, fmin(e.y, e.z)) /
                      largest; /* within the least radius of curvature */
        near_to(sn_shape_value(s, sn_v3_mad(p, -deep, n)), -deep, 1e-11 * largest);
        sn_shape_release(s);
    }
}

/* Ring of radius 3 around y through (1, 0, 0), tube 1. */
static void torus_distance(void **state)
{
    (void)state;
    sn_shape *s;
    sn_error err;
    ok(sn_shape_torus(&s, sn_v3(1, 0, 0), sn_v3(0, 5, 0), 3, 1, &err), &err);
    value_is(s, 1, 0, 0, 2.0);
    value_is(s, 4, 0, 0, -1.0);
    value_is(s, 8, 4, 0, sqrt(32.0) - 1.0);
    value_is(s, 1, 4, 0, 4.0); /* 3, 4, 5 from the ring */
    value_is(s, 1, -1, -3, 0.0);
    sn_box3 b = sn_shape_bounds(s);
    near_to(b.max.x, 5.0, 1e-12);
    near_to(b.max.y, 1.0, 1e-12);
    near_to(b.min.z, -4.0, 1e-12);
    sn_shape_release(s);
}

static sn_shape *plate(sn_vec3 a, sn_vec3 b, sn_vec3 c, double r)
{
    sn_shape *s;
    sn_error err;
    ok(sn_shape_plate(&s, a, b, c, r, &err), &err);
    return s;
}

/* Against the nearest of many points of the triangle; both turns of the corners. */
static void plate_distance(void **state)
{
    (void)state;
    sn_shape *flat = plate(sn_v3(0, 0, 0), sn_v3(4, 0, 0), sn_v3(0, 4, 0), 0.5);
    value_is(flat, 1, 1, 3, 2.5);
    value_is(flat, 1, 1, -3, 2.5);
    value_is(flat, -3, 2, 4, 4.5); /* 3, 4, 5 from a side */
    value_is(flat, 3, 3, 0, sqrt(2.0) - 0.5);
    sn_shape_release(flat);
    uint64_t seed = 21;
    for (int i = 0; i < 40; i++) {
        sn_vec3 a = rnd_point(&seed, 1.0), b = rnd_point(&seed, 1.0), c = rnd_point(&seed, 1.0);
        sn_vec3 p = rnd_point(&seed, 2.0);
        double best = INFINITY;
        for (int j = 0; j <= 300; j++)
            for (int k = 0; k <= 300 - j; k++) {
                sn_vec3 q = sn_v3_mad(sn_v3_scale(1.0 - (j + k) / 300.0, a), j / 300.0, b);
                best = fmin(best, sn_v3_dist(p, sn_v3_mad(q, k / 300.0, c)));
            }
        sn_shape *s = plate(a, b, c, 0.25), *back = plate(c, b, a, 0.25);
        near_to(sn_shape_value(s, p), best - 0.25, 2e-3);
        near_to(sn_shape_value(back, p), sn_shape_value(s, p), 1e-12);
        sn_shape_release(s);
        sn_shape_release(back);
    }
}

/* ---- combinations ---- */

static void union_and_subtract(void **state)
{
    (void)state;
    sn_shape *u = joined(sphere(-2, 0, 0, 1), sphere(2, 0, 0, 1));
    value_is(u, 5, 0, 0, 2.0);
    value_is(u, -2, 0, 0, -1.0);
    value_is(u, 0, 0, 0, 1.0);
    sn_box3 b = sn_shape_bounds(u);
    assert_true(b.min.x == -3.0 && b.max.x == 3.0 && b.max.y == 1.0);
    sn_shape *c = cut(box(1, 1, 1, 0), sphere(0, 0, 0, 0.5));
    value_is(c, 0, 0, 0, 0.5);
    value_is(c, 0.5, 0, 0, 0.0);
    value_is(c, 0.75, 0, 0, -0.25);
    value_is(c, 2, 0, 0, 1.0);
    assert_true(sn_shape_bounds(c).max.x == 1.0);
    sn_shape_release(u);
    sn_shape_release(c);
}

/* At equal values the blend lowers by k/4; where they differ by k or more not at all; at a difference of k/2
 * by k/16. */
static void smooth_union_values(void **state)
{
    (void)state;
    sn_shape *s = blended(0.4, sphere(-1, 0, 0, 0.9), sphere(1, 0, 0, 0.9));
    value_is(s, 0, 0, 0, 0.1 - 0.1);
    value_is(s, 0.2, 0, 0, -0.1);
    value_is(s, 0.1, 0, 0, 0.0 - 0.4 / 16.0);
    value_is(s, 3, 0, 0, 1.1);
    sn_shape_release(s);
    sn_shape *same[3] = {sphere(0, 0, 0, 1), NULL, NULL};
    same[1] = same[2] = same[0];
    sn_error err;
    ok(sn_shape_smooth_union(&s, 1.0, same, 3, &err), &err);
    value_is(s, 2, 0, 0, 1.0 - 0.25 - 0.25 * 0.75 * 0.75); /* folded: -1/4 and 1, then 3/4 and 1 */
    sn_shape_release(s);
    sn_shape_release(same[0]);
}

static void intersect_and_smooth_subtract(void **state)
{
    (void)state;
    sn_shape *part[2] = {sphere(0, 0, 0, 1), sphere(1, 0, 0, 0.75)}, *s;
    sn_error err;
    ok(sn_shape_intersect(&s, part, 2, &err), &err);
    value_is(s, 0, 0, 0, 0.25);
    value_is(s, 0.5, 0, 0, -0.25);
    value_is(s, 3, 0, 0, 2.0);
    assert_true(sn_shape_bounds(s).min.x == 0.25 && sn_shape_bounds(s).max.y == 0.75); /* the smaller one's */
    sn_shape_release(s);
    ok(sn_shape_smooth_subtract(&s, 0.4, part[0], part[1], &err), &err);
    value_is(s, 0.25, 0, 0, 0.0); /* -0.75 and 0 differ by more than k: as without rounding */
    value_is(s, 0.625, 0, 0, 0.375);
    double y = sqrt(1.0 - 0.71875 * 0.71875); /* on both spheres: sinks by k/4 */
    value_is(s, 0.71875, y, 0, 0.1);
    sn_shape_release(s);
    sn_shape_release(part[0]);
    sn_shape_release(part[1]);
}

static sn_shape *moved(sn_shape *s, sn_vec3 scale, sn_vec3 axis, double degrees,
                       sn_vec3 to) /* takes s over */
{
    sn_shape_placement t = {scale, axis, degrees, to};
    sn_shape *out;
    sn_error err;
    ok(sn_shape_transform(&out, s, &t, &err), &err);
    sn_shape_release(s);
    return out;
}

static void transform_values(void **state)
{
    (void)state;
    sn_vec3 one = sn_v3(1, 1, 1), none = sn_v3(0, 0, 0);
    sn_shape *s = moved(box(3, 1, 1, 0), one, sn_v3(0, 0, 2), 90, sn_v3(10, 0, 0));
    value_is(s, 10, 5, 0, 2.0); /* x became y, then 10 to the right */
    value_is(s, 12, 0, 0, 1.0);
    near_to(sn_shape_bounds(s).max.y, 3.0, 1e-12);
    near_to(sn_shape_bounds(s).min.x, 9.0, 1e-12);
    sn_shape_release(s);
    s = moved(sphere(1, 0, 0, 1), sn_v3(2, 2, 2), none, 0, sn_v3(0, 5, 0));
    value_is(s, 2, 5, 7, 5.0);
    value_is(s, 2, 5, 0, -2.0);
    sn_shape_release(s);
    s = moved(sphere(0, 0, 0, 1), sn_v3(3, 1, 2), none, 0, none); /* uneven: a bound with the same surface */
    value_is(s, 3, 0, 0, 0.0);
    value_is(s, 0, 0, 2, 0.0);
    value_is(s, 0, 3, 0, 2.0);
    assert_true(sn_shape_value(s, sn_v3(5, 0, 0)) > 0.0 && sn_shape_value(s, sn_v3(5, 0, 0)) <= 2.0);
    sn_shape_release(s);
    s = moved(box(1, 2, 3, 0), one, sn_v3(1, 1, 1), 120, none); /* x to y to z to x */
    value_is(s, 4, 0, 0, 1.0);
    value_is(s, 0, 4, 0, 3.0);
    value_is(s, 0, 0, 4, 2.0);
    sn_shape_release(s);
}

static void mirror_values(void **state)
{
    (void)state;
    sn_shape *a = sphere(3, 1, 0, 1), *s;
    sn_error err;
    ok(sn_shape_mirror(&s, a, sn_v3(1, 0, 0), sn_v3(-4, 0, 0), &err), &err);
    value_is(s, -1, 1, 0, -1.0);
    value_is(s, 3, 1, 0, 3.0);
    near_to(sn_shape_bounds(s).min.x, -2.0, 1e-12);
    near_to(sn_shape_bounds(s).max.x, 0.0, 1e-12);
    sn_shape_release(s);
    sn_shape_release(a);
}

static sn_shape *knot(void) /* some of the rest */
{
    sn_shape *ring, *part[2], *bitten;
    sn_error err;
    ok(sn_shape_torus(&ring, sn_v3(0, 0, 0), sn_v3(1, 2, 0.5), 0.7, 0.2, &err), &err);
    part[0] = moved(ring, sn_v3(1.2, 0.7, 1), sn_v3(1, 0, 1), 40, sn_v3(0.1, 0, 0));
    part[1] = plate(sn_v3(-1, -1, 0), sn_v3(1, -0.8, 0.2), sn_v3(0, 1, -0.3), 0.15);
    ok(sn_shape_smooth_subtract(&bitten, 0.2, part[1], part[0], &err), &err);
    sn_shape_release(part[1]);
    return blended(0.15, part[0], bitten);
}

static sn_shape *tangle(void) /* some of everything */
{
    sn_shape *blob =
        blended(0.3, ellipsoid(1.0, 0.3, 0.5), capsule(sn_v3(-1, -1, 0), sn_v3(1, 1, 0.4), 0.3, 0.1));
    sn_shape *hole = joined(sphere(0.5, 0, 0.4, 0.35), capsule(sn_v3(0, 0, -1), sn_v3(0, 0, 1), 0.1, 0.1));
    return blended(0.1, cut(blob, hole), box(0.2, 1.2, 0.1, 0.05));
}

/* No value changes faster than the point moves: the reason why blocks may be skipped. */
static void values_are_no_steeper_than_one(void **state)
{
    (void)state;
    sn_shape *s[4] = {tangle(), ellipsoid(1.0, 0.01, 0.3), box(1, 0.5, 0.2, 0.1), knot()};
    uint64_t seed = 3;
    for (int i = 0; i < 60000; i++) {
        sn_vec3 p = rnd_point(&seed, 1.5);
        sn_vec3 q = sn_v3_add(p, rnd_point(&seed, i % 8 < 4 ? 1.0 : 1e-4));
        double d = fabs(sn_shape_value(s[i % 4], p) - sn_shape_value(s[i % 4], q));
        assert_true(d <= sn_v3_dist(p, q) * (1.0 + 1e-9) + 1e-13);
    }
    for (int i = 0; i < 4; i++) sn_shape_release(s[i]);
}

/* Outside the bounds the value is at least the distance to them. */
static void bounds_hold_the_surface(void **state)
{
    (void)state;
    sn_shape *many[6];
    for (int i = 0; i < 6; i++) many[i] = sphere(0.05 * i, 0.02 * i, 0, 0.5);
    sn_shape *swollen, *s[2];
    sn_error err;
    ok(sn_shape_smooth_union(&swollen, 0.5, many, 6, &err), &err);
    for (int i = 0; i < 6; i++) sn_shape_release(many[i]);
    s[0] = swollen;
    s[1] = tangle();
    uint64_t seed = 9;
    for (int i = 0; i < 40000; i++) {
        sn_box3 b = sn_shape_bounds(s[i % 2]);
        sn_vec3 p = rnd_point(&seed, 2.5);
        sn_vec3 q = sn_v3(fmin(fmax(p.x, b.min.x), b.max.x), fmin(fmax(p.y, b.min.y), b.max.y),
                          fmin(fmax(p.z, b.min.z), b.max.z));
        double away = sn_v3_dist(p, q);
        if (away > 0.0) assert_true(sn_shape_value(s[i % 2], p) >= away - 1e-12);
    }
    sn_shape_release(s[0]);
    sn_shape_release(s[1]);
}

static void operands_live_as_long_as_needed(void **state)
{
    (void)state;
    sn_shape *a = sphere(0, 0, 0, 1);
    assert_ptr_equal(sn_shape_retain(a), a);
    sn_shape *u = joined(a, sphere(3, 0, 0, 1)); /* lets go of one of two references */
    value_is(a, 2, 0, 0, 1.0);
    sn_shape_release(a);
    value_is(u, 0, 0, 0, -1.0);
    sn_shape_release(u);
    sn_shape_release(NULL);
    assert_null(sn_shape_retain(NULL));
}

/* ---- messages ---- */

/* s: what the failed call left, or NULL. */
static void wrong(sn_status st, sn_status code, sn_shape *const *s, const sn_error *err, const char *message)
{
    assert_int_equal(st, code);
    if (s) assert_null(*s);
    if (!strstr(err->msg, message)) fail_msg("message is: %s", err->msg);
}

static void bad_leaves(void **state)
{
    (void)state;
    sn_vec3 o = sn_v3(0, 0, 0), one = sn_v3(1, 1, 1), bad = sn_v3(0, NAN, 2);
    sn_shape *s;
    sn_error e;
#define WRONG(call, message) wrong(call, SN_EINVAL, &s, &e, message)
    WRONG(sn_shape_sphere(&s, bad, 1, &e),
          "sphere: center is (0, nan, 2), need finite coordinates up to 1e+50");
    WRONG(sn_shape_sphere(&s, sn_v3(0, 0, 1e60), 1, &e), "sphere: center is (0, 0, 1e+60), need finite");
    WRONG(sn_shape_sphere(&s, o, 0, &e), "sphere: radius is 0, need > 0 (1e-50 to 1e+50)");
    WRONG(sn_shape_sphere(&s, o, -1, &e), "sphere: radius is -1, need > 0");
    WRONG(sn_shape_sphere(&s, o, NAN, &e), "sphere: radius is nan, need > 0");
    WRONG(sn_shape_sphere(&s, o, INFINITY, &e), "sphere: radius is inf, need > 0 (1e-50 to 1e+50)");
    WRONG(sn_shape_ellipsoid(&s, bad, one, &e), "ellipsoid: center is (0, nan, 2)");
    WRONG(sn_shape_ellipsoid(&s, o, sn_v3(0, 1, 1), &e), "ellipsoid: radius along x is 0, need > 0");
    WRONG(sn_shape_ellipsoid(&s, o, sn_v3(1, -2, 1), &e), "ellipsoid: radius along y is -2, need > 0");
    WRONG(sn_shape_ellipsoid(&s, o, sn_v3(1, 1, NAN), &e), "ellipsoid: radius along z is nan, need > 0");
    WRONG(sn_shape_capsule(&s, bad, o, 1, 1, &e), "capsule: end a is (0, nan, 2)");
    WRONG(sn_shape_capsule(&s, o, bad, 1, 1, &e), "capsule: end b is (0, nan, 2)");
    WRONG(sn_shape_capsule(&s, o, one, 0, 1, &e), "capsule: radius at a is 0, need > 0");
    WRONG(sn_shape_capsule(&s, o, one, 1, -3, &e), "capsule: radius at b is -3, need > 0");
    WRONG(sn_shape_box(&s, bad, one, 0, &e), "box: center is (0, nan, 2)");
    WRONG(sn_shape_box(&s, o, sn_v3(-1, 1, 1), 0, &e), "box: half size along x is -1, need > 0");
    WRONG(sn_shape_box(&s, o, sn_v3(1, 0, 1), 0, &e), "box: half size along y is 0, need > 0");
    WRONG(sn_shape_box(&s, o, sn_v3(1, 1, INFINITY), 0, &e), "box: half size along z is inf, need > 0");
    WRONG(sn_shape_box(&s, o, sn_v3(3, 2, 4), 2.5, &e),
          "box: rounding is 2.5, need 0 to the smallest half size 2");
    WRONG(sn_shape_box(&s, o, one, -0.1, &e), "box: rounding is -0.1, need 0 to");
    WRONG(sn_shape_box(&s, o, one, NAN, &e), "box: rounding is nan, need 0 to");
    WRONG(sn_shape_torus(&s, bad, one, 1, 1, &e), "torus: center is (0, nan, 2)");
    WRONG(sn_shape_torus(&s, o, o, 1, 1, &e), "torus: axis is (0, 0, 0), need a direction");
    WRONG(sn_shape_torus(&s, o, bad, 1, 1, &e), "torus: axis is (0, nan, 2)");
    WRONG(sn_shape_torus(&s, o, one, 0, 1, &e), "torus: radius of the ring is 0, need > 0");
    WRONG(sn_shape_torus(&s, o, one, 1, -2, &e), "torus: radius of the tube is -2, need > 0");
    WRONG(sn_shape_plate(&s, bad, o, one, 1, &e), "plate: corner a is (0, nan, 2)");
    WRONG(sn_shape_plate(&s, o, bad, one, 1, &e), "plate: corner b is (0, nan, 2)");
    WRONG(sn_shape_plate(&s, o, one, bad, 1, &e), "plate: corner c is (0, nan, 2)");
    WRONG(sn_shape_plate(&s, o, one, sn_v3(1, 0, 0), 0, &e), "plate: radius is 0, need > 0");
    WRONG(sn_shape_plate(&s, o, one, sn_v3(2, 2, 2), 1, &e),
          "plate: its corners lie on a line, need a triangle");
    WRONG(sn_shape_plate(&s, o, o, o, 1, &e), "plate: its corners lie on a line");
#undef WRONG
}

static void bad_moves(void **state)
{
    (void)state;
    sn_vec3 o = sn_v3(0, 0, 0), one = sn_v3(1, 1, 1), bad = sn_v3(0, NAN, 2);
    sn_shape *a = sphere(0, 0, 0, 1), *s;
    sn_error e;
#define WRONG(message, ...)                                                                                  \
    wrong(sn_shape_transform(&s, a, &(sn_shape_placement){__VA_ARGS__}, &e), SN_EINVAL, &s, &e, message)
    WRONG("transform: scale along x is 0, need > 0", o, one, 0, o);
    WRONG("transform: scale along z is -1, need > 0", sn_v3(1, 1, -1), one, 0, o);
    WRONG("transform: translate is (0, nan, 2)", one, one, 0, bad);
    WRONG("transform: axis is (0, 0, 0), need a direction", one, o, 5, o);
    WRONG("transform: angle is nan, need a finite number", one, one, NAN, o);
#undef WRONG
    wrong(sn_shape_transform(&s, NULL, &(sn_shape_placement){one, one, 0, o}, &e), SN_EINVAL, &s, &e,
          "transform: shape 1 of 1 is missing");
    wrong(sn_shape_mirror(&s, a, bad, one, &e), SN_EINVAL, &s, &e, "mirror: point is (0, nan, 2)");
    wrong(sn_shape_mirror(&s, a, o, o, &e), SN_EINVAL, &s, &e,
          "mirror: normal is (0, 0, 0), need a direction");
    wrong(sn_shape_mirror(&s, NULL, o, one, &e), SN_EINVAL, &s, &e, "mirror: shape 1 of 1 is missing");
    sn_shape_release(a);
}

static void bad_combinations(void **state)
{
    (void)state;
    sn_shape *a = sphere(0, 0, 0, 1), *part[2] = {a, NULL}, *s;
    sn_error e;
    wrong(sn_shape_union(&s, part, 0, &e), SN_EINVAL, &s, &e, "union: 0 shapes, need at least 1");
    wrong(sn_shape_union(&s, part, 2, &e), SN_EINVAL, &s, &e, "union: shape 2 of 2 is missing");
    wrong(sn_shape_smooth_union(&s, 0, part, 1, &e), SN_EINVAL, &s, &e, "smooth_union: k is 0, need > 0");
    wrong(sn_shape_smooth_union(&s, NAN, part, 1, &e), SN_EINVAL, &s, &e, "smooth_union: k is nan, need > 0");
    wrong(sn_shape_smooth_union(&s, 1, part, -4, &e), SN_EINVAL, &s, &e,
          "smooth_union: -4 shapes, need at least 1");
    wrong(sn_shape_smooth_union(&s, 1, part, 2, &e), SN_EINVAL, &s, &e,
          "smooth_union: shape 2 of 2 is missing");
    wrong(sn_shape_subtract(&s, NULL, a, &e), SN_EINVAL, &s, &e, "subtract: shape 1 of 2 is missing");
    wrong(sn_shape_subtract(&s, a, NULL, &e), SN_EINVAL, &s, &e, "subtract: shape 2 of 2 is missing");
    wrong(sn_shape_smooth_subtract(&s, 0, a, a, &e), SN_EINVAL, &s, &e, "smooth_subtract: k is 0, need > 0");
    wrong(sn_shape_smooth_subtract(&s, 1, a, NULL, &e), SN_EINVAL, &s, &e,
          "smooth_subtract: shape 2 of 2 is missing");
    wrong(sn_shape_intersect(&s, part, 0, &e), SN_EINVAL, &s, &e, "intersect: 0 shapes, need at least 1");
    wrong(sn_shape_intersect(&s, part, 2, &e), SN_EINVAL, &s, &e, "intersect: shape 2 of 2 is missing");
    for (int i = 1; i < 1000; i++) { /* depth 1000 */
        sn_shape *deeper;
        ok(sn_shape_union(&deeper, &a, 1, &e), &e);
        sn_shape_release(a);
        a = deeper;
    }
    value_is(a, 3, 0, 0, 2.0);
    wrong(sn_shape_union(&s, &a, 1, &e), SN_ELIMIT, &s, &e,
          "union: nested deeper than 1000; give many shapes to one union instead");
    sn_shape_release(a);
}

/* ---- meshes ---- */

static sn_tri_mesh mesh_of(sn_shape *s, double cell) /* takes s over */
{
    sn_tri_mesh m;
    sn_error err;
    sn_tri_mesh_init(&m);
    ok(sn_shape_mesh(s, cell, NULL, &m, &err), &err);
    sn_shape_release(s);
    assert_int_equal(sn_tri_mesh_validate(&m, &err), SN_OK);
    assert_closed_manifold(&m);
    assert_int_equal(count_crossings(&m), 0);
    assert_null(m.label);
    return m;
}

static void mesh_of_sphere(void **state)
{
    (void)state;
    sn_tri_mesh m = mesh_of(sphere(1, -2, 3, 1), 0.2);
    assert_int_equal(euler_characteristic(&m), 2);
    near_to(sn_tri_mesh_volume(&m), 4.0 / 3.0 * PI, 0.15);
    near_to(sn_tri_mesh_area(&m), 4.0 * PI, 0.3);
    sn_shape *s = sphere(1, -2, 3, 1);
    for (int32_t v = 0; v < m.n_vert; v++)
        assert_true(fabs(sn_shape_value(s, sn_tri_mesh_point(&m, v))) < 0.04);
    sn_shape_release(s);
    sn_tri_mesh_free(&m);
}

static void tunnel_has_genus_one(void **state)
{
    (void)state;
    sn_shape *drill = capsule(sn_v3(0, 0, -2), sn_v3(0, 0, 2), 0.4, 0.4);
    sn_tri_mesh m = mesh_of(cut(box(1, 1, 0.5, 0.1), drill), 0.2);
    assert_int_equal(euler_characteristic(&m), 0);
    assert_int_equal(count_parts(&m), 1);
    sn_tri_mesh_free(&m);
    sn_shape *pipe = capsule(sn_v3(-2, 0, 0.1), sn_v3(2, 0, -0.1), 0.3, 0.4);
    m = mesh_of(cut(sphere(0, 0, 0, 1), pipe), 0.2);
    assert_int_equal(euler_characteristic(&m), 0);
    sn_tri_mesh_free(&m);
}

static void hollow_and_apart(void **state)
{
    (void)state;
    sn_tri_mesh m = mesh_of(cut(sphere(0, 0, 0, 1), sphere(0, 0, 0, 0.5)), 0.2); /* a shell: two spheres */
    assert_int_equal(count_parts(&m), 2);
    assert_int_equal(euler_characteristic(&m), 4);
    near_to(sn_tri_mesh_volume(&m), 4.0 / 3.0 * PI * 0.875, 0.15); /* the inner one turns inward */
    sn_tri_mesh_free(&m);
    m = mesh_of(joined(sphere(-1, 0, 0, 0.7), sphere(1, 0, 0, 0.7)), 0.2);
    assert_int_equal(count_parts(&m), 2);
    sn_tri_mesh_free(&m);
    m = mesh_of(blended(1.0, sphere(-1, 0, 0, 0.8), sphere(1, 0, 0, 0.8)),
                0.2); /* 0.2 - k/4 < 0: grown together */
    assert_int_equal(count_parts(&m), 1);
    assert_int_equal(euler_characteristic(&m), 2);
    sn_tri_mesh_free(&m);
}

/* Sides on whole cells, rods of about a cell, a plate of half a cell: closed, whatever is kept of the thin
 * ones. */
static void aligned_and_thin(void **state)
{
    (void)state;
    sn_tri_mesh m = mesh_of(box(1.0, 0.75, 0.5, 0), 0.25);
    assert_int_equal(euler_characteristic(&m), 2);
    near_to(sn_tri_mesh_volume(&m), 3.0, 0.3);
    sn_tri_mesh_free(&m);
    m = mesh_of(capsule(sn_v3(-1, -1, -1), sn_v3(1, 0.7, 0.4), 0.12, 0.15), 0.25);
    assert_int_equal(count_parts(&m), 1);
    sn_tri_mesh_free(&m);
    m = mesh_of(joined(sphere(0, 0, 0, 0.5), box(0.9, 0.8, 0.06, 0.02)), 0.25);
    assert_true(m.n_face > 0);
    sn_tri_mesh_free(&m);
    m = mesh_of(joined(box(1, 1, 1, 0), sphere(1, 1, 1, 0.25)), 0.25);
    assert_int_equal(euler_characteristic(&m), 2);
    sn_tri_mesh_free(&m);
}

static void meshes_of_the_rest(void **state)
{
    (void)state;
    sn_shape *ring;
    sn_error err;
    ok(sn_shape_torus(&ring, sn_v3(0, 0, 0), sn_v3(0, 0, 1), 1, 0.4, &err), &err);
    sn_tri_mesh m = mesh_of(ring, 0.15);
    assert_int_equal(euler_characteristic(&m), 0);
    near_to(sn_tri_mesh_volume(&m), 2.0 * PI * PI * 0.16, 0.1); /* 2 pi^2 R r^2 */
    sn_tri_mesh_free(&m);
    m = mesh_of(moved(sphere(0, 0, 0, 1), sn_v3(1, 0.5, 0.5), sn_v3(0, 0, 1), 30, sn_v3(4, 0, 0)), 0.12);
    assert_int_equal(euler_characteristic(&m), 2);
    near_to(sn_tri_mesh_volume(&m), PI / 3.0, 0.04);
    sn_tri_mesh_free(&m);
    m = mesh_of(knot(), 0.1);
    assert_true(m.n_face > 0);
    sn_tri_mesh_free(&m);
}

static void mesh_is_the_same_with_any_threads(void **state)
{
    (void)state;
    sn_shape *s = tangle();
    sn_tri_mesh m[2];
    for (int i = 0; i < 2; i++) {
        sn_run run = {.n_threads = i + 1};
        sn_tri_mesh_init(&m[i]);
        assert_int_equal(sn_shape_mesh(s, 0.1, &run, &m[i], NULL), SN_OK);
    }
    assert_closed_manifold(&m[0]);
    assert_int_equal(m[0].n_vert, m[1].n_vert);
    assert_int_equal(m[0].n_face, m[1].n_face);
    assert_memory_equal(m[0].pos, m[1].pos, 3 * (size_t)m[0].n_vert * sizeof *m[0].pos);
    assert_memory_equal(m[0].face, m[1].face, 3 * (size_t)m[0].n_face * sizeof *m[0].face);
    sn_tri_mesh_free(&m[0]);
    sn_tri_mesh_free(&m[1]);
    sn_shape_release(s);
}

static void no_mesh(sn_shape *s, double cell, const sn_run *run, sn_status code, const char *message)
{
    sn_tri_mesh m;
    sn_error err;
    sn_tri_mesh_init(&m);
    sn_status st = sn_shape_mesh(s, cell, run, &m, &err);
    wrong(st, code, NULL, &err, message);
    assert_null(m.pos);
    assert_int_equal(m.n_face, 0);
}

static void bad_meshes(void **state)
{
    (void)state;
    sn_shape *s = sphere(0, 0, 0, 1), *empty = cut(sphere(0, 0, 0, 1), sphere(0, 0, 0, 2));
    sn_shape *far = sphere(1e12, 0, 0, 1);
    volatile sig_atomic_t stop = 1;
    sn_run stopped = {.cancel = &stop}, late = {.deadline = sn_clock() - 1.0};
    no_mesh(s, 0, NULL, SN_EINVAL, "shape: cell is 0, need > 0");
    no_mesh(s, -1, NULL, SN_EINVAL, "shape: cell is -1, need > 0");
    no_mesh(s, NAN, NULL, SN_EINVAL, "shape: cell is nan, need > 0");
    no_mesh(s, INFINITY, NULL, SN_EINVAL, "shape: cell is inf, need > 0");
    no_mesh(s, 1e-3, NULL, SN_ELIMIT,
            "shape: cell 0.001 needs more than 2e8 lattice points; a cell of 0.0073 would do");
    no_mesh(s, 50, NULL, SN_EMESH,
            "shape: nothing inside at cell 50; the shape, in 2 x 2 x 2, is empty or thinner than a cell");
    no_mesh(empty, 0.2, NULL, SN_EMESH,
            "shape: nothing inside at cell 0.2; the shape, in 2 x 2 x 2, is empty");
    no_mesh(far, 0.1, NULL, SN_EINVAL,
            "polygonize: cell 0.06 is too small for coordinates up to 1e+12, need 1000");
    no_mesh(s, 0.2, &stopped, SN_ECANCEL, "interrupted while");
    no_mesh(s, 0.2, &late, SN_ELIMIT, "time limit reached while");
    sn_shape_release(s);
    sn_shape_release(far);
    sn_shape_release(empty);
}

/* ---- memory ---- */

typedef struct budget {
    int left, in_use;
} budget;

static void *rationed(void *user, void *p, size_t bytes)
{
    budget *b = user;
    if (bytes == 0) {
        b->in_use--;
        free(p);
        return NULL;
    }
    if (b->left-- == 0) return NULL;
    if (!p) b->in_use++;
    return realloc(p, bytes);
}

static sn_status make_and_mesh(sn_error *err)
{
    sn_shape *part[2] = {NULL, NULL}, *u = NULL, *turned = NULL, *s = NULL;
    sn_run run = {.n_threads = 1};
    sn_tri_mesh m;
    sn_tri_mesh_init(&m);
    sn_status st = sn_shape_sphere(&part[0], sn_v3(0, 0, 0), 1, err);
    if (!st) st = sn_shape_box(&part[1], sn_v3(1, 0, 0), sn_v3(1, 1, 1), 0.1, err);
    if (!st) st = sn_shape_union(&u, part, 2, err);
    if (!st) st = sn_shape_mirror(&turned, u, sn_v3(0, 0, 0), sn_v3(1, 0, 0), err);
    if (!st) st = sn_shape_subtract(&s, turned, part[0], err);
    if (!st) st = sn_shape_mesh(s, 1.0, &run, &m, err);
    sn_shape_release(part[0]);
    sn_shape_release(part[1]);
    sn_shape_release(u);
    sn_shape_release(turned);
    sn_shape_release(s);
    if (st) assert_null(m.pos);
    sn_tri_mesh_free(&m);
    return st;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    sn_status st = SN_ENOMEM;
    int n = 0;
    for (; st; n++) {
        budget b = {n, 0};
        sn_error err;
        sn_set_allocator(&(sn_allocator){rationed, &b});
        st = make_and_mesh(&err);
        if (st) assert_int_equal(st, SN_ENOMEM);
        if (st) assert_non_null(strstr(err.msg, "no memory"));
        assert_int_equal(b.in_use, 0);
    }
    sn_set_allocator(NULL);
    assert_true(n > 12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sphere_distance),
        cmocka_unit_test(capsule_distance),
        cmocka_unit_test(capsule_against_balls),
        cmocka_unit_test(capsule_of_one_ball),
        cmocka_unit_test(box_distance),
        cmocka_unit_test(ellipsoid_distance_at_known_points),
        cmocka_unit_test(ellipsoid_distance_along_normals),
        cmocka_unit_test(torus_distance),
        cmocka_unit_test(plate_distance),
        cmocka_unit_test(union_and_subtract),
        cmocka_unit_test(smooth_union_values),
        cmocka_unit_test(intersect_and_smooth_subtract),
        cmocka_unit_test(transform_values),
        cmocka_unit_test(mirror_values),
        cmocka_unit_test(values_are_no_steeper_than_one),
        cmocka_unit_test(bounds_hold_the_surface),
        cmocka_unit_test(operands_live_as_long_as_needed),
        cmocka_unit_test(bad_leaves),
        cmocka_unit_test(bad_moves),
        cmocka_unit_test(bad_combinations),
        cmocka_unit_test(mesh_of_sphere),
        cmocka_unit_test(tunnel_has_genus_one),
        cmocka_unit_test(hollow_and_apart),
        cmocka_unit_test(aligned_and_thin),
        cmocka_unit_test(meshes_of_the_rest),
        cmocka_unit_test(mesh_is_the_same_with_any_threads),
        cmocka_unit_test(bad_meshes),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
