/* test_predicates - exact signs and crossings against rational arithmetic and hand-made degenerate cases. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "mesh/predicates.h"

#include <gmp.h>
#include <stdlib.h>

/* ---- a plain reference in rationals ---- */

static int orient3d_reference(sn_vec3 a, sn_vec3 b, sn_vec3 c, sn_vec3 d)
{
    const double x[4][3] = {{a.x, a.y, a.z}, {b.x, b.y, b.z}, {c.x, c.y, c.z}, {d.x, d.y, d.z}};
    mpq_t m[3][3], sum, term, t;
    mpq_inits(sum, term, t, NULL);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            mpq_init(m[i][k]);
            mpq_set_d(m[i][k], x[i + 1][k]);
            mpq_set_d(t, x[0][k]);
            mpq_sub(m[i][k], m[i][k], t);
        }
    for (int k = 0; k < 6; k++) { /* the six permutations */
        static const int perm[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
        mpq_mul(term, m[0][perm[k][0]], m[1][perm[k][1]]);
        mpq_mul(term, term, m[2][perm[k][2]]);
        if (k < 3)
            mpq_add(sum, sum, term);
        else
            mpq_sub(sum, sum, term);
    }
    int sign = mpq_sgn(sum);
    for (int i = 0; i < 9; i++) mpq_clear(m[i / 3][i % 3]);
    mpq_clears(sum, term, t, NULL);
    return sign;
}

static int orient2d_reference(sn_vec3 a, sn_vec3 b, sn_vec3 c, int axis)
{
    double as, at, bs, bt, cs, ct;
    sn_drop_axis(a, axis, &as, &at);
    sn_drop_axis(b, axis, &bs, &bt);
    sn_drop_axis(c, axis, &cs, &ct);
    sn_vec3 up = sn_v3(as, at, 1.0); /* the area is six times the volume of the tet with it */
    return orient3d_reference(sn_v3(as, at, 0.0), sn_v3(bs, bt, 0.0), sn_v3(cs, ct, 0.0), up);
}

static uint64_t rng_next(uint64_t *s) /* splitmix64 */
{
    uint64_t z = (*s += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static double rng_unit(uint64_t *s)
{
    return (double)(rng_next(s) >> 11) * 0x1p-53;
}

static int rng_below(uint64_t *s, int n)
{
    return (int)(rng_next(s) % (uint64_t)n);
}

static sn_vec3 random_point(uint64_t *s, double scale)
{
    double x = rng_unit(s), y = rng_unit(s), z = rng_unit(s);
    return sn_v3(scale * x, scale * y, scale * z);
}

static sn_vec3 grid_point(uint64_t *s, int n)
{
    int x = rng_below(s, n), y = rng_below(s, n), z = rng_below(s, n);
    return sn_v3(x, y, z);
}

static void orient3d_of_unit_tet(void **state)
{
    (void)state;
    sn_vec3 o = sn_v3(0, 0, 0), x = sn_v3(1, 0, 0), y = sn_v3(0, 1, 0), z = sn_v3(0, 0, 1);
    assert_int_equal(sn_orient3d(o, x, y, z), 1);
    assert_int_equal(sn_orient3d(o, y, x, z), -1);
    assert_int_equal(sn_orient3d(o, x, y, sn_v3(5, 7, 0)), 0);
    assert_int_equal(sn_orient3d(o, x, y, sn_v3(5, 7, 5e-324)), 1);
    assert_int_equal(sn_orient3d_exact(o, x, y, z), 1);
    assert_int_equal(sn_orient3d_exact(o, y, x, z), -1);
}

static void orient2d_keeps_cyclic_order(void **state)
{
    (void)state;
    sn_vec3 o = sn_v3(0, 0, 0), x = sn_v3(1, 0, 0), y = sn_v3(0, 1, 0), z = sn_v3(0, 0, 1);
    assert_int_equal(sn_orient2d(o, y, z, 0), 1);
    assert_int_equal(sn_orient2d(o, z, x, 1), 1);
    assert_int_equal(sn_orient2d(o, x, y, 2), 1);
    assert_int_equal(sn_orient2d(o, y, x, 2), -1);
    assert_int_equal(sn_orient2d(o, x, sn_v3(2, 0, 9), 2), 0);
}

static void signs_agree_with_rationals(void **state)
{
    (void)state;
    uint64_t seed = 1;
    for (int trial = 0; trial < 4000; trial++) {
        sn_vec3 p[4];
        double scale = ldexp(1.0, rng_below(&seed, 9) * 40 - 160);
        for (int k = 0; k < 4; k++) p[k] = random_point(&seed, scale);
        /* three of four: a point that is on the plane, or on a line, up to rounding */
        double s = rng_unit(&seed), t = rng_unit(&seed);
        if (trial % 4 == 1) p[3] = sn_v3_lerp(sn_v3_lerp(p[0], p[1], s), p[2], t);
        if (trial % 4 == 2) p[2] = sn_v3_lerp(p[0], p[1], s);
        if (trial % 4 == 3) p[3] = sn_v3_add(p[0], sn_v3_sub(p[2], p[1]));
        int want = orient3d_reference(p[0], p[1], p[2], p[3]);
        assert_int_equal(sn_orient3d(p[0], p[1], p[2], p[3]), want);
        assert_int_equal(sn_orient3d_exact(p[0], p[1], p[2], p[3]), want);
        assert_int_equal(sn_orient3d(p[1], p[0], p[2], p[3]), -want);
        assert_int_equal(sn_orient3d(p[3], p[0], p[1], p[2]), -want); /* an odd permutation */
        for (int axis = 0; axis < 3; axis++) {
            want = orient2d_reference(p[0], p[1], p[2], axis);
            assert_int_equal(sn_orient2d(p[0], p[1], p[2], axis), want);
            assert_int_equal(sn_orient2d_exact(p[0], p[1], p[2], axis), want);
        }
    }
}

static void extreme_exponents_are_exact(void **state)
{
    (void)state;
    static const double value[] = {0.0,  5e-324, -5e-324, 1e-320, 2.3e-308, -1e-160, 3e-103,  1e-20,
                                   -1.0, 1.5,    1e103,   -1e155, 1e200,    1.7e308, -1.7e308};
    uint64_t seed = 2;
    for (int trial = 0; trial < 3000; trial++) {
        sn_vec3 p[4];
        for (int k = 0; k < 4; k++) {
            double x = value[rng_below(&seed, 15)], y = value[rng_below(&seed, 15)],
                   z = value[rng_below(&seed, 15)];
            p[k] = sn_v3(x, y, z);
        }
        assert_int_equal(sn_orient3d(p[0], p[1], p[2], p[3]), orient3d_reference(p[0], p[1], p[2], p[3]));
        for (int axis = 0; axis < 3; axis++)
            assert_int_equal(sn_orient2d(p[0], p[1], p[2], axis), orient2d_reference(p[0], p[1], p[2], axis));
    }
}

static void one_ulp_off_the_diagonal_is_seen(void **state) /* the example of Kettner et al. 2008 */
{
    (void)state;
    sn_vec3 q = sn_v3(12, 12, 0), r = sn_v3(24, 24, 0);
    for (int i = 0; i < 64; i++)
        for (int k = 0; k < 64; k++) {
            sn_vec3 p = sn_v3(0.5 + i * 0x1p-53, 0.5 + k * 0x1p-53, 0);
            double x = p.x, y = p.y; /* rounding may join neighbours; the sign is that of y - x */
            assert_int_equal(sn_orient2d(q, r, p, 2), (y > x) - (y < x));
        }
}

static void degenerate_triangles_are_seen(void **state)
{
    (void)state;
    sn_vec3 a = sn_v3(0.1, 0.2, 0.3), b = sn_v3(0.2, 0.4, 0.6), c = sn_v3(0.4, 0.8, 1.2);
    assert_true(sn_triangle_is_degenerate(a, b, c)); /* exact doublings */
    assert_true(sn_triangle_is_degenerate(a, a, b));
    assert_true(sn_triangle_is_degenerate(a, a, a));
    c.z = nextafter(c.z, 2.0);
    assert_false(sn_triangle_is_degenerate(a, b, c));
    assert_false(sn_triangle_is_degenerate(sn_v3(0, 0, 0), sn_v3(1e-200, 0, 0), sn_v3(0, 1e-200, 0)));
}

static void segment_against_triangle(void **state)
{
    (void)state;
    sn_vec3 p = sn_v3(0, 0, 0), q = sn_v3(4, 0, 0), r = sn_v3(0, 4, 0);
    struct {
        sn_vec3 a, b;
        bool meets;
    } c[] = {
        {{1, 1, -1}, {1, 1, 1}, true},    {{1, 1, 1}, {1, 1, 2}, false},   {{1, 1, 1}, {1, 1, 0}, true},
        {{3, 3, -1}, {3, 3, 1}, false},   {{2, 2, -1}, {2, 2, 1}, true},   {{4, 0, -1}, {4, 0, 1}, true},
        {{2, 0, 0}, {2, -3, 5}, true},    {{1, 1, 0}, {2, 1, 0}, true},    {{-1, 1, 0}, {9, 1, 0}, true},
        {{-1, -1, 0}, {9, -1, 0}, false}, {{4, 0, 0}, {9, 0, 0}, true},    {{5, 0, 0}, {9, 0, 0}, false},
        {{-2, 6, 0}, {6, -2, 0}, true},   {{-2, 7, 0}, {7, -2, 0}, false}, {{1, 1, 0}, {1, 1, 0}, true},
        {{3, 3, 0}, {3, 3, 0}, false},    {{1, 1, 1}, {1, 1, 1}, false},
    };
    for (size_t k = 0; k < sizeof c / sizeof c[0]; k++) {
        assert_int_equal(sn_segment_meets_triangle(c[k].a, c[k].b, p, q, r), c[k].meets);
        assert_int_equal(sn_segment_meets_triangle(c[k].b, c[k].a, q, p, r), c[k].meets);
    }
    /* triangles without area: a segment and a point */
    assert_true(sn_segment_meets_triangle(sn_v3(1, -1, 0), sn_v3(1, 1, 0), p, q, sn_v3(2, 0, 0)));
    assert_false(sn_segment_meets_triangle(sn_v3(5, -1, 0), sn_v3(5, 1, 0), p, q, sn_v3(2, 0, 0)));
    assert_false(sn_segment_meets_triangle(sn_v3(1, -1, 1), sn_v3(1, 1, 1), p, q, sn_v3(2, 0, 0)));
    assert_true(sn_segment_meets_triangle(sn_v3(-1, -1, -1), sn_v3(1, 1, 1), p, p, p));
    assert_false(sn_segment_meets_triangle(sn_v3(-1, -1, -1), sn_v3(1, 1, 2), p, p, p));
    assert_true(sn_segment_meets_triangle(p, p, p, p, p));
}

/* Both orders, all rotations and flips of the corners must give the same answer. */
static void check_cross(const sn_vec3 p[3], const int i[3], const sn_vec3 q[3], const int j[3], bool want)
{
    static const int perm[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    for (int s = 0; s < 6; s++)
        for (int t = 0; t < 6; t++) {
            sn_vec3 a[3], b[3];
            int ia[3], ib[3];
            for (int k = 0; k < 3; k++) {
                a[k] = p[perm[s][k]];
                ia[k] = i[perm[s][k]];
                b[k] = q[perm[t][k]];
                ib[k] = j[perm[t][k]];
            }
            assert_int_equal(sn_triangles_cross(a, ia, b, ib), want);
            assert_int_equal(sn_triangles_cross(b, ib, a, ia), want);
        }
}

static const int first_ids[3] = {0, 1, 2}, other_ids[3] = {3, 4, 5}, corner_ids[3] = {0, 3, 4},
                 edge_ids[3] = {0, 1, 3};
static const sn_vec3 base[3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};

static void apart_triangles(void **state)
{
    (void)state;
    struct {
        sn_vec3 q[3];
        bool cross;
    } c[] = {
        {{{1, 1, -1}, {1, 1, 1}, {9, 9, 0}}, true},      /* through the inside          */
        {{{1, 1, 1}, {1, 1, 2}, {9, 9, 3}}, false},      /* above                       */
        {{{1, 1, 0}, {1, 2, 5}, {2, 1, 5}}, true},       /* a corner on the inside      */
        {{{4, 0, 0}, {5, 0, 1}, {5, 0, -1}}, true},      /* a corner on a corner        */
        {{{2, 0, 0}, {2, -1, 1}, {2, -1, -1}}, true},    /* a corner on an edge         */
        {{{1, 1, 0}, {2, 1, 0}, {1, 2, 0}}, true},       /* coplanar, contained         */
        {{{-9, -9, 0}, {30, -9, 0}, {-9, 30, 0}}, true}, /* coplanar, containing      */
        {{{4, 4, 0}, {4, 1, 0}, {1, 4, 0}}, false},      /* coplanar, apart             */
        {{{4, 4, 0}, {4, 0, 0}, {0, 4, 0}}, true},       /* coplanar, along an edge     */
        {{{2, -2, 0}, {3, 0, 0}, {1, 0, 0}}, true},      /* coplanar, edges overlap     */
        {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, true},       /* the same places, other ids  */
        {{{0, 5, 0}, {5, 0, 0}, {5, 5, 3}}, false},      /* boxes overlap, apart        */
        {{{1, 1, 0}, {1, 1, 0}, {1, 1, 0}}, true},       /* a point inside              */
        {{{3, 3, 0}, {3, 3, 0}, {3, 3, 0}}, false},      /* a point in the plane        */
        {{{1, 1, -1}, {1, 1, 0}, {1, 1, 3}}, true},      /* a segment through           */
        {{{1, 1, 1}, {1, 1, 2}, {1, 1, 3}}, false},
        {{{-1, 1, 0}, {2, 1, 0}, {9, 1, 0}}, true}, /* a coplanar segment through  */
        {{{-1, -1, 0}, {2, -1, 0}, {9, -1, 0}}, false},
    };
    for (size_t k = 0; k < sizeof c / sizeof c[0]; k++)
        check_cross(base, first_ids, c[k].q, other_ids, c[k].cross);
    const sn_vec3 s[3] = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, t[3] = {{2, 0, 1}, {0, 2, 1}, {1, 1, 1}},
                  u[3] = {{3, 3, 3}, {4, 4, 4}, {5, 5, 5}}, v[3] = {{2, 2, 2}, {3, 3, 3}, {2, 2, 2}};
    check_cross(s, first_ids, t, other_ids,
                true); /* two segments crossing, collinear apart, collinear touching */
    check_cross(s, first_ids, u, other_ids, false);
    check_cross(s, first_ids, v, other_ids, true);
}

static void triangles_with_one_corner(void **state)
{
    (void)state;
    struct {
        sn_vec3 b, c;
        bool cross;
    } c[] = {
        {{-1, 0, 1}, {0, -1, 1}, false},   {{-1, -1, 0}, {-2, -1, 0}, false}, /* a fan; coplanar apart */
        {{1, 1, 0}, {-1, -1, 5}, true},    {{1, 1, 1}, {1, 1, -1}, true}, /* corner inside; edge through   */
        {{9, 9, 0}, {9, 8, 0}, true},      {{9, 0, 0}, {9, -9, 0}, true}, /* coplanar: over; along an edge */
        {{4, 0, 0}, {0, 0, 7}, true},      {{3, 0, 0}, {3, -1, 1}, true}, /* a corner at a corner; on edge */
        {{9, 9, 1}, {9, 9, 2}, false},     {{-3, 1, 0}, {-3, 2, 0}, false},
        {{-9, 1, 0}, {9, -8, 0}, false},   {{-1, 9, 0}, {9, -1, 0}, true}, /* coplanar wedge around         */
        {{0, 0, 0}, {0, 0, 5}, false},     {{0, 0, 0}, {2, 2, 0}, true},   /* t is a segment from a         */
        {{1, 1, 0}, {-1, -1, 0}, true},    {{1, 1, 1}, {-1, -1, -1}, false}, /* t is a segment through a */
        {{-1, -1, 0}, {-2, -2, 0}, false}, {{9, 9, 0}, {8, 8, 0}, true}, /* t is a segment ending in a    */
        {{0, 0, 0}, {0, 0, 0}, false},                                   /* t is a itself                 */
    };
    for (size_t k = 0; k < sizeof c / sizeof c[0]; k++) {
        const sn_vec3 q[3] = {base[0], c[k].b, c[k].c};
        check_cross(base, first_ids, q, corner_ids, c[k].cross);
    }
    /* both are segments through the shared corner */
    const sn_vec3 s[3] = {{0, 0, 0}, {1, 0, 0}, {-1, 0, 0}}, t[3] = {{0, 0, 0}, {0, 1, 0}, {0, -1, 0}},
                  u[3] = {{0, 0, 0}, {5, 0, 0}, {7, 0, 0}};
    check_cross(s, first_ids, t, corner_ids, false);
    check_cross(s, first_ids, u, corner_ids, true);
}

static void triangles_with_one_edge(void **state)
{
    (void)state;
    struct {
        sn_vec3 d;
        bool cross;
    } c[] = {
        {{0, -4, 0}, false}, {{1, 1, 5}, false},     {{0, 4, 1e-300}, false}, {{1, 1, 0}, true},
        {{9, 9, 0}, true},   {{0, 4, 0}, true},      {{2, 0, 0}, false},      {{9, 0, 0}, false},
        {{4, 0, 0}, false},  {{9, 1e-300, 0}, true},
    };
    for (size_t k = 0; k < sizeof c / sizeof c[0]; k++) {
        const sn_vec3 q[3] = {base[0], base[1], c[k].d};
        check_cross(base, first_ids, q, edge_ids, c[k].cross);
    }
    const sn_vec3 s[3] = {{0, 0, 0}, {4, 0, 0}, {6, 0, 0}}, beyond[3] = {{0, 0, 0}, {4, 0, 0}, {5, 0, 0}},
                  before[3] = {{0, 0, 0}, {4, 0, 0}, {-5, 0, 0}},
                  within[3] = {{0, 0, 0}, {4, 0, 0}, {1, 0, 0}};
    check_cross(s, first_ids, beyond, edge_ids, true);
    check_cross(s, first_ids, before, edge_ids, false);
    check_cross(s, first_ids, within, edge_ids, false);
    const sn_vec3 v[3] = {{0, 0, 0}, {0, 0, 0}, {6, 0, 0}}, same[3] = {{0, 0, 0}, {0, 0, 0}, {2, 0, 0}},
                  back[3] = {{0, 0, 0}, {0, 0, 0}, {-2, 0, 0}}; /* the shared edge has no length */
    check_cross(v, first_ids, same, edge_ids, true);
    check_cross(v, first_ids, v, edge_ids, true);
    check_cross(v, first_ids, back, edge_ids, false);
}

static void triangles_with_equal_ids(void **state)
{
    (void)state;
    static const int twice[3] = {0, 0, 2}, twice_other[3] = {0, 0, 5};
    check_cross(base, first_ids, base, first_ids, true);
    const sn_vec3 s[3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 4}}, t[3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, -4}},
                  u[3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 1}};
    check_cross(s, twice, t, twice_other, false); /* an id twice in a triangle is one shared corner */
    check_cross(s, twice, u, twice_other, true);
    check_cross(base, first_ids, s, twice_other, false);
}

static bool coplanar(const sn_vec3 p[3], const sn_vec3 q[3]) /* small integers: no rounding */
{
    sn_vec3 n = sn_v3_cross(sn_v3_sub(p[1], p[0]), sn_v3_sub(p[2], p[0]));
    for (int k = 0; k < 3; k++)
        if (sn_v3_dot(n, sn_v3_sub(q[k], p[0])) != 0.0) return false;
    return true;
}

/* Whether two triangles (or segments, a corner given twice) meet, by looking for a separating plane along
 * every normal that may give one. For integer corners whose values stay below 2^53. */
static bool meet_by_separation(const sn_vec3 p[3], const sn_vec3 q[3])
{
    sn_vec3 e[6], n[23];
    int n_axis = 0;
    for (int k = 0; k < 3; k++) {
        e[k] = sn_v3_sub(p[(k + 1) % 3], p[k]);
        e[3 + k] = sn_v3_sub(q[(k + 1) % 3], q[k]);
    }
    n[n_axis++] = sn_v3_cross(e[0], e[1]);
    n[n_axis++] = sn_v3_cross(e[3], e[4]);
    for (int k = 0; k < 3; k++)
        for (int l = 3; l < 6; l++) n[n_axis++] = sn_v3_cross(e[k], e[l]);
    for (int k = 0; k < 6; k++) { /* in-plane normals, for coplanar pairs */
        n[n_axis++] = sn_v3_cross(n[0], e[k]);
        n[n_axis++] = sn_v3_cross(n[1], e[k]);
    }
    for (int a = 0; a < n_axis; a++) {
        double lo_p = INFINITY, hi_p = -INFINITY, lo_q = INFINITY, hi_q = -INFINITY;
        for (int k = 0; k < 3; k++) {
            double s = sn_v3_dot(n[a], p[k]), t = sn_v3_dot(n[a], q[k]);
            lo_p = fmin(lo_p, s);
            hi_p = fmax(hi_p, s);
            lo_q = fmin(lo_q, t);
            hi_q = fmax(hi_q, t);
        }
        if (hi_p < lo_q || hi_q < lo_p) return false;
    }
    return true;
}

static bool has_area(const sn_vec3 p[3])
{
    return sn_v3_len2(sn_v3_cross(sn_v3_sub(p[1], p[0]), sn_v3_sub(p[2], p[0]))) > 0.0;
}

static void grid_triangles_agree_with_separating_axes(void **state)
{
    (void)state;
    uint64_t seed = 3;
    int n_cross = 0, n_coplanar = 0;
    for (int trial = 0; trial < 60000; trial++) {
        sn_vec3 p[3], q[3];
        for (int k = 0; k < 3; k++) {
            p[k] = grid_point(&seed, 5);
            q[k] = grid_point(&seed, 5);
            if (trial % 3 == 0) p[k].z = q[k].z = p[k].x + p[k].y - 4; /* q leaves that plane at times */
            if (trial % 3 == 0) q[k].z = q[k].x + q[k].y - 4;
        }
        if (!has_area(p) || !has_area(q)) continue;
        bool want = meet_by_separation(p, q);
        n_cross += want;
        n_coplanar += coplanar(p, q);
        assert_int_equal(sn_triangles_cross(p, first_ids, q, other_ids), want);
        assert_int_equal(sn_triangles_cross(q, other_ids, p, first_ids), want);
    }
    assert_in_range(n_cross, 5000, 55000);
    assert_in_range(n_coplanar, 5000, 30000);
}

/* Two triangles with the corner a in common share more than a exactly when their cones from a share a ray:
 * when the far edge of one meets the other made much larger about a. Grid angles are far above 1/1000. */
static void shared_corner_agrees_with_cones(void **state)
{
    (void)state;
    uint64_t seed = 4;
    int n_cross = 0;
    for (int trial = 0; trial < 40000; trial++) {
        sn_vec3 p[3], q[3];
        for (int k = 0; k < 3; k++) {
            p[k] = grid_point(&seed, 4);
            q[k] = grid_point(&seed, 4);
            if (trial % 2) p[k].z = q[k].z = 0;
        }
        q[0] = p[0];
        if (!has_area(p) || !has_area(q)) continue;
        const sn_vec3 far_edge[3] = {p[1], p[2], p[2]};
        const sn_vec3 large[3] = {q[0], sn_v3_mad(q[0], 1000, sn_v3_sub(q[1], q[0])),
                                  sn_v3_mad(q[0], 1000, sn_v3_sub(q[2], q[0]))};
        bool want = meet_by_separation(far_edge, large);
        n_cross += want;
        assert_int_equal(sn_triangles_cross(p, first_ids, q, corner_ids), want);
        assert_int_equal(sn_triangles_cross(q, corner_ids, p, first_ids), want);
    }
    assert_in_range(n_cross, 1000, 39000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(orient3d_of_unit_tet),
        cmocka_unit_test(orient2d_keeps_cyclic_order),
        cmocka_unit_test(signs_agree_with_rationals),
        cmocka_unit_test(extreme_exponents_are_exact),
        cmocka_unit_test(one_ulp_off_the_diagonal_is_seen),
        cmocka_unit_test(degenerate_triangles_are_seen),
        cmocka_unit_test(segment_against_triangle),
        cmocka_unit_test(apart_triangles),
        cmocka_unit_test(triangles_with_one_corner),
        cmocka_unit_test(triangles_with_one_edge),
        cmocka_unit_test(triangles_with_equal_ids),
        cmocka_unit_test(grid_triangles_agree_with_separating_axes),
        cmocka_unit_test(shared_corner_agrees_with_cones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
