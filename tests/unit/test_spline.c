/* test_spline - centripetal Catmull-Rom splines, against the recursive construction of Barry and Goldman. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "mesh/spline.h"

#include "made_mesh.h"

static sn_spline spline_of(const double *point, int32_t n)
{
    sn_spline s = {0};
    sn_error err = {.msg = ""};
    if (sn_spline_build(&s, point, n, &err)) fail_msg("%s", err.msg);
    assert_int_equal(s.n_seg, n - 1);
    return s;
}

static const double bent[] = {0,   0, 0, 1, 2, 0,  1.1, 2.1,
                              0.3, 5, 0, 2, 6, -4, 1}; /* five points, unevenly spaced */

/* Barry and Goldman 1988: knots t_i apart by the square root of the chord, blended pairwise. */
static sn_vec3 pyramid(const sn_vec3 p[4], double u)
{
    double t[4] = {0};
    for (int k = 1; k < 4; k++) t[k] = t[k - 1] + sqrt(sn_v3_dist(p[k - 1], p[k]));
    double x = t[1] + u * (t[2] - t[1]);
    sn_vec3 a[3], b[2];
    for (int k = 0; k < 3; k++) a[k] = sn_v3_lerp(p[k], p[k + 1], (x - t[k]) / (t[k + 1] - t[k]));
    for (int k = 0; k < 2; k++) b[k] = sn_v3_lerp(a[k], a[k + 1], (x - t[k]) / (t[k + 2] - t[k]));
    return sn_v3_lerp(b[0], b[1], (x - t[1]) / (t[2] - t[1]));
}

static void agrees_with_the_recursive_construction(void **state)
{
    (void)state;
    sn_spline s = spline_of(bent, 5);
    for (int i = 0; i < 4; i++) {
        sn_vec3 p[4]; /* beyond the ends: reflected */
        for (int k = 0; k < 4; k++) {
            int j = i - 1 + k;
            if (j >= 0 && j < 5) p[k] = sn_v3_load(bent + 3 * j);
            if (j < 0) p[k] = sn_v3_sub(sn_v3_scale(2, sn_v3_load(bent)), sn_v3_load(bent + 3));
            if (j > 4) p[k] = sn_v3_sub(sn_v3_scale(2, sn_v3_load(bent + 12)), sn_v3_load(bent + 9));
        }
        for (int k = 0; k <= 10; k++)
            assert_true(sn_v3_dist(sn_cubic_point(&s.seg[i], 0.1 * k), pyramid(p, 0.1 * k)) < 1e-12);
    }
    sn_spline_free(&s);
}

static void passes_its_points_smoothly(void **state)
{
    (void)state;
    sn_spline s = spline_of(bent, 5);
    for (int i = 0; i < 4; i++) {
        assert_true(sn_v3_dist(sn_cubic_point(&s.seg[i], 0.0), sn_v3_load(bent + 3 * i)) == 0.0);
        assert_true(sn_v3_dist(sn_cubic_point(&s.seg[i], 1.0), sn_v3_load(bent + 3 * i + 3)) < 1e-14);
        if (i == 0) continue; /* equal derivatives by the knots' own parameter */
        double d0 = sqrt(sn_v3_dist(sn_v3_load(bent + 3 * i - 3), sn_v3_load(bent + 3 * i)));
        double d1 = sqrt(sn_v3_dist(sn_v3_load(bent + 3 * i), sn_v3_load(bent + 3 * i + 3)));
        sn_vec3 before = sn_v3_scale(1.0 / d0, sn_cubic_tangent(&s.seg[i - 1], 1.0));
        assert_true(sn_v3_dist(before, sn_v3_scale(1.0 / d1, sn_cubic_tangent(&s.seg[i], 0.0))) < 1e-12);
    }
    sn_spline_free(&s);
}

static void two_points_give_the_line(void **state)
{
    (void)state;
    const double p[] = {1, 2, 3, 4, 6, 15}; /* 3, 4, 12: 13 long */
    sn_spline s = spline_of(p, 2);
    assert_true(fabs(sn_spline_length(&s) - 13.0) < 1e-12);
    for (int k = 0; k <= 8; k++) {
        sn_vec3 want = sn_v3_lerp(sn_v3_load(p), sn_v3_load(p + 3), k / 8.0);
        assert_true(sn_v3_dist(sn_cubic_point(&s.seg[0], k / 8.0), want) < 1e-14);
    }
    sn_spline_free(&s);
    sn_spline_free(&s);
    assert_true(sn_spline_length(&s) == 0.0);
}

static void points_on_a_line_stay_on_it(void **state)
{
    (void)state;
    double p[18], at[] = {0, 1, 1.01, 7, 7.5, 20};
    for (int i = 0; i < 6; i++) sn_v3_store(p + 3 * i, sn_v3(at[i], 2 * at[i], -2 * at[i]));
    sn_spline s = spline_of(p, 6);
    assert_true(fabs(sn_spline_length(&s) - 60.0) < 1e-9); /* 20 * 3, so never backwards */
    for (int i = 0; i < 5; i++)
        for (int k = 0; k <= 20; k++) {
            sn_vec3 q = sn_cubic_point(&s.seg[i], k / 20.0);
            assert_true(fabs(q.y - 2 * q.x) < 1e-12 && fabs(q.z + 2 * q.x) < 1e-12);
            assert_true(sn_cubic_tangent(&s.seg[i], k / 20.0).x > 0.0);
        }
    sn_spline_free(&s);
}

/* Uniform splines make loops and cusps where chords are very uneven; centripetal ones do not. */
static void no_cusps_between_uneven_points(void **state)
{
    (void)state;
    uint64_t h = 9;
    for (int round = 0; round < 200; round++) {
        double p[12];
        for (int i = 0; i < 4; i++) {
            double step = pow(10.0, -3.0 * made_random(&h));
            for (int k = 0; k < 3; k++)
                p[3 * i + k] = (i ? p[3 * i - 3 + k] : 0.0) + step * (made_random(&h) - 0.4);
        }
        sn_spline s = spline_of(p, 4);
        for (int i = 0; i < 3; i++) {
            double chord = sn_v3_dist(sn_v3_load(p + 3 * i), sn_v3_load(p + 3 * i + 3));
            for (int k = 1; k < 50; k++)
                assert_true(sn_v3_len(sn_cubic_tangent(&s.seg[i], k / 50.0)) > 0.05 * chord);
            assert_true(s.arc[i + 1] - s.arc[i] < 2.5 * chord);
        }
        sn_spline_free(&s);
    }
}

static void lengths_add_up(void **state)
{
    (void)state;
    sn_spline s = spline_of(bent, 5);
    double sum = 0.0;
    assert_true(s.arc[0] == 0.0);
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 20000; k++)
            sum += sn_v3_dist(sn_cubic_point(&s.seg[i], k / 20000.0),
                              sn_cubic_point(&s.seg[i], (k + 1) / 20000.0));
        assert_true(fabs(s.arc[i + 1] - sum) < 1e-6);
    }
    assert_true(sn_spline_length(&s) == s.arc[4]);
    for (int k = 0; k <= 40; k++) { /* back from length to place */
        double a = sn_spline_length(&s) * k / 40, t;
        int32_t i;
        sn_spline_at(&s, a, &i, &t);
        assert_true(i >= 0 && i < 4 && t >= 0.0 && t <= 1.0);
        assert_true(fabs(s.arc[i] + sn_cubic_length(&s.seg[i], 0.0, t) - a) < 1e-8);
    }
    int32_t i;
    double t;
    sn_spline_at(&s, -5.0, &i, &t);
    assert_true(i == 0 && t == 0.0);
    sn_spline_at(&s, 1e9, &i, &t);
    assert_true(i == 3 && t == 1.0);
    sn_spline_free(&s);
}

static void samples_are_evenly_spaced(void **state)
{
    (void)state;
    sn_spline s = spline_of(bent, 5);
    double out[3 * 101], line[] = {0, 0, 0, 10, 0, 0}, few[9];
    sn_spline_sample(&s, 101, out);
    assert_true(sn_v3_dist(sn_v3_load(out), sn_v3_load(bent)) == 0.0);
    assert_true(sn_v3_dist(sn_v3_load(out + 300), sn_v3_load(bent + 12)) < 1e-12);
    double step = sn_spline_length(&s) / 100.0;
    for (int k = 0; k < 100; k++) {
        double d = sn_v3_dist(sn_v3_load(out + 3 * k), sn_v3_load(out + 3 * k + 3));
        assert_true(d <= step * (1 + 1e-6) && d > 0.9 * step); /* chords of equal arcs */
    }
    sn_spline_free(&s);
    s = spline_of(line, 2);
    sn_spline_sample(&s, 3, few);
    assert_true(fabs(few[3] - 5.0) < 1e-9 && few[4] == 0.0 && fabs(few[6] - 10.0) < 1e-9);
    sn_spline_free(&s);
}

static void the_way_back_and_the_unit_do_not_matter(void **state)
{
    (void)state;
    double back[15], large[15];
    for (int i = 0; i < 15; i++) {
        back[i] = bent[3 * (4 - i / 3) + i % 3];
        large[i] = 1000.0 * bent[i];
    }
    sn_spline s = spline_of(bent, 5), r = spline_of(back, 5), l = spline_of(large, 5);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k <= 10; k++) {
            sn_vec3 p = sn_cubic_point(&s.seg[i], 0.1 * k);
            assert_true(sn_v3_dist(p, sn_cubic_point(&r.seg[3 - i], 1.0 - 0.1 * k)) < 1e-12);
            assert_true(sn_v3_dist(sn_v3_scale(1000.0, p), sn_cubic_point(&l.seg[i], 0.1 * k)) < 1e-9);
        }
    assert_true(fabs(sn_spline_length(&l) / sn_spline_length(&s) - 1000.0) < 1e-9);
    sn_spline_free(&s);
    sn_spline_free(&r);
    sn_spline_free(&l);
}

static void bad_points_are_named(void **state)
{
    (void)state;
    sn_spline s = {0};
    sn_error err;
    double p[9] = {0, 0, 0, 1, 0, 0, 1, 0, 0};
    const struct {
        int32_t n;
        const char *want;
    } few[] = {{0, "a curve has 0 points, need 2 or more"},
               {1, "a curve has 1 point, need 2 or more"},
               {-3, "a curve has -3 points, need 2 or more"}};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(sn_spline_build(&s, p, few[i].n, &err), SN_EINVAL);
        assert_string_equal(err.msg, few[i].want);
    }
    assert_int_equal(sn_spline_build(&s, p, 3, &err), SN_EINVAL);
    assert_string_equal(err.msg, "points 2 and 3 of a curve are equal");
    p[7] = NAN;
    assert_int_equal(sn_spline_build(&s, p, 3, &err), SN_EINVAL);
    assert_string_equal(err.msg, "point 3 has a coordinate that is not finite");
    assert_true(!s.seg && !s.arc && s.n_seg == 0);
    p[7] = 1e-12; /* close, but not equal */
    assert_int_equal(sn_spline_build(&s, p, 3, &err), SN_OK);
    for (int i = 0; i < 2; i++)
        for (int k = 0; k <= 10; k++) assert_true(sn_v3_is_finite(sn_cubic_point(&s.seg[i], 0.1 * k)));
    for (int n = 0; n < 2; n++) {
        ration r = {n, 0};
        sn_spline t = {0};
        sn_set_allocator(RATION(r));
        assert_int_equal(sn_spline_build(&t, bent, 5, &err), SN_ENOMEM);
        assert_string_equal(err.msg, "curve: no memory for 5 points");
        assert_int_equal(r.in_use, 0);
        sn_set_allocator(NULL);
    }
    sn_spline_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(agrees_with_the_recursive_construction),
        cmocka_unit_test(passes_its_points_smoothly),
        cmocka_unit_test(two_points_give_the_line),
        cmocka_unit_test(points_on_a_line_stay_on_it),
        cmocka_unit_test(no_cusps_between_uneven_points),
        cmocka_unit_test(lengths_add_up),
        cmocka_unit_test(samples_are_evenly_spaced),
        cmocka_unit_test(the_way_back_and_the_unit_do_not_matter),
        cmocka_unit_test(bad_points_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
