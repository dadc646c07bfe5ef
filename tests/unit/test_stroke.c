/* test_stroke - strokes drawn in a picture: ends on bone, depth between them, the fitted spline, the scene.
 */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "mesh/bvh.h"
#include "mesh/spline_fit.h"
#include "muscle/stroke.h"
#include "scene/scene_stroke.h"

#include "made_mesh.h"

/* ---- a picture of 400 x 400 pixels from (0, 0, 20) along -z: pixel (200, 200) is the middle ---- */

#define SLOPE 0.002
static const sn_stroke_view view = {
    {0, 0, 20}, {-200 * SLOPE, 200 * SLOPE, -1}, {SLOPE, 0, 0}, {0, -SLOPE, 0}};

static void pixel_of(sn_vec3 p, double out[2])
{
    out[0] = 200.0 + p.x / (20.0 - p.z) / SLOPE;
    out[1] = 200.0 - p.y / (20.0 - p.z) / SLOPE;
}

/* ---- a box of skin, a ball of bone near either end, and one bone more ---- */

#define DIAGONAL 11.489125293076057 /* of 10 x 4 x 4 */
static const char *const names[] = {"left", "right", "obstacle"};
static const sn_vec3 from = {-2.55, 0, 0.2}, to = {2.55, 0, -0.3}; /* on the balls' inner, visible sides */

typedef struct body {
    sn_tri_mesh skin, bone[3];
    const sn_tri_mesh *list[3];
    sn_stroke_body given;
} body;

static void new_body(body *b, const sn_tri_mesh *obstacle)
{
    *b = (body){.skin = made_box(sn_v3(-5, -2, -2), sn_v3(5, 2, 2)),
                .bone = {made_sphere(sn_v3(-3, 0, 0), 0.5, 0.05), made_sphere(sn_v3(3, 0, -0.5), 0.5, 0.05)}};
    if (obstacle) b->bone[2] = *obstacle;
    for (int i = 0; i < 3; i++) b->list[i] = &b->bone[i];
    b->given =
        (sn_stroke_body){.bone_name = names, .bone = b->list, .n_bone = obstacle ? 3 : 2, .skin = &b->skin};
}

static void free_body(body *b)
{
    sn_tri_mesh_free(&b->skin);
    for (int i = 0; i < b->given.n_bone; i++) sn_tri_mesh_free(&b->bone[i]);
}

static void straight_pixels(double pixel[4])
{
    pixel_of(from, pixel);
    pixel_of(to, pixel + 2);
}

static sn_stroke_report draw(const body *b, const double *pixel, int32_t n, const sn_stroke_options *opt,
                             double *point)
{
    sn_stroke_report r = {0};
    sn_error err = {.msg = ""};
    const sn_stroke s = {.view = view, .pixel = pixel, .n_pixel = n};
    if (sn_stroke_curve(&s, &b->given, opt, NULL, point, &r, &err)) fail_msg("%s", err.msg);
    return r;
}

static double distance_to_line(sn_vec3 p, sn_vec3 a, sn_vec3 b)
{
    sn_vec3 d = sn_v3_unit(sn_v3_sub(b, a));
    return sn_v3_len(sn_v3_cross(sn_v3_sub(p, a), d));
}

/* The least distance of the middle 80 % of the curve to the surface; negative on the wrong side. */
static double least_gap(const double *point, int32_t k, const sn_tri_mesh *m, bool want_inside)
{
    sn_bvh *tree;
    sn_spline s = {0};
    double p[3 * 101], least = INFINITY;
    assert_int_equal(sn_bvh_create(&tree, m, NULL), SN_OK);
    assert_int_equal(sn_spline_build(&s, point, k, NULL), SN_OK);
    sn_spline_sample(&s, 101, p);
    for (int i = 10; i <= 90; i++) {
        double d = sn_bvh_closest(tree, sn_v3_load(p + 3 * i)).dist;
        least = fmin(least, sn_bvh_contains(tree, sn_v3_load(p + 3 * i)) == want_inside ? d : -d);
    }
    sn_spline_free(&s);
    sn_bvh_destroy(tree);
    return least;
}

/* ---- fitting ---- */

static void known_curves_are_recovered(void **state)
{
    (void)state;
    const double four[] = {0, 0, 0, 1, 1, 0.2, 2.2, 0.8, -0.5, 3, 0, 0};
    const double six[] = {0, 0, 0, 1, 1, 0, 2, 0.7, 1, 3, -0.5, 1.2, 4.2, 0.3, 0, 5, 0, 0};
    const struct {
        const double *point;
        int32_t k;
    } known[] = {{four, 4}, {six, 6}};
    for (int c = 0; c < 2; c++) {
        sn_spline s = {0};
        double path[3 * 65], got[18];
        int32_t k = known[c].k;
        sn_spline_fit_report r;
        assert_int_equal(sn_spline_build(&s, known[c].point, k, NULL), SN_OK);
        sn_spline_sample(&s, 65, path);
        const sn_spline_fit fit = {.path = path, .n = 65};
        assert_int_equal(sn_spline_fit_points(&fit, got, k, &r, NULL), SN_OK);
        for (int i = 0; i < 3 * k; i++)
            assert_float_equal(got[i], known[c].point[i], 1e-3 * sn_spline_length(&s));
        assert_true(r.rms <= r.max && r.max < 1e-3 * sn_spline_length(&s));
        sn_spline_free(&s);
    }
}

static void fractions_are_of_the_length(void **state)
{
    (void)state;
    const double point[] = {0, 0, 0, 1, 1, 0, 4, 0, 0, 5, 2, 1};
    double even[9], at[3 * 33], want[3 * 33], f[33];
    const double three[3] = {0, 0.5, 1}, line[] = {0, 0, 0, 4, 0, 0};
    sn_spline s = {0};
    assert_int_equal(sn_spline_build(&s, line, 2, NULL), SN_OK);
    assert_int_equal(sn_spline_at_fractions(&s, three, 3, even, NULL), SN_OK);
    assert_float_equal(even[3], 2.0, 1e-12);
    assert_float_equal(even[6], 4.0, 1e-12);
    assert_int_equal(sn_spline_build(&s, point, 4, NULL), SN_OK);
    for (int i = 0; i < 33; i++) f[i] = i / 32.0;
    assert_int_equal(sn_spline_at_fractions(&s, f, 33, at, NULL), SN_OK);
    sn_spline_sample(&s, 33, want);
    for (int i = 0; i < 99; i++) assert_float_equal(at[i], want[i], 1e-5);
    sn_spline_free(&s);
}

static void weights_and_ends(void **state)
{
    (void)state;
    /* a path with a peak in the middle: three control points cannot follow it; weight pulls them there */
    const double path[] = {0, 0, 0, 1, 0, 0, 2, 1, 0, 3, 0, 0, 4, 0, 0}, heavy[] = {1, 1, 100, 1, 1};
    const double fraction[] = {0, 0.25, 0.5, 0.75, 1};
    double even[9], pulled[9], line[6];
    sn_spline_fit fit = {.path = path, .n = 5, .fraction = fraction};
    sn_spline_fit_report r;
    assert_int_equal(sn_spline_fit_points(&fit, even, 3, NULL, NULL), SN_OK);
    fit.weight = heavy;
    assert_int_equal(sn_spline_fit_points(&fit, pulled, 3, NULL, NULL), SN_OK);
    assert_true(even[4] > 0.1 && pulled[4] > even[4] + 0.1 && fabs(pulled[4] - 1.0) < 0.05);
    assert_memory_equal(pulled, path, 3 * sizeof *path);
    assert_memory_equal(pulled + 6, path + 12, 3 * sizeof *path);
    assert_int_equal(sn_spline_fit_points(&fit, line, 2, &r, NULL), SN_OK);
    assert_float_equal(r.max, 1.0, 1e-12); /* the peak */
    assert_float_equal(r.rms, sqrt(1.0 / 5.0), 1e-12);
}

static void fit_errors(void **state)
{
    (void)state;
    double point[3 * 40];
    const double path[] = {0, 0, 0, 1, 0, 0, 0, 0, 0};
    sn_spline_fit fit = {.path = path, .n = 2};
    sn_error err;
    const struct {
        int32_t n, k;
        const char *message;
    } bad[] = {{2, 1, "a fitted curve has 1 point, need 2..32"},
               {2, 33, "a fitted curve has 33 points, need 2..32"},
               {1, 2, "a path has 1 point, need 2 or more"},
               {3, 2, "a path begins and ends at the same point"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        fit.n = bad[i].n;
        assert_int_equal(sn_spline_fit_points(&fit, point, bad[i].k, NULL, &err), SN_EINVAL);
        assert_string_equal(err.msg, bad[i].message);
    }
}

/* ---- strokes ---- */

static void straight_where_nothing_is_in_the_way(void **state)
{
    (void)state;
    body b;
    double pixel[4], point[12];
    new_body(&b, NULL);
    straight_pixels(pixel);
    sn_stroke_report r = draw(&b, pixel, 2, &(sn_stroke_options){0}, point);
    sn_vec3 a = sn_v3_load(point), e = sn_v3_load(point + 9);
    assert_float_equal(sn_v3_dist(a, sn_v3(-3, 0, 0)), 0.5, 0.01); /* on the balls */
    assert_float_equal(sn_v3_dist(e, sn_v3(3, 0, -0.5)), 0.5, 0.01);
    assert_true(r.bone[0] == 0 && r.bone[1] == 1);
    for (int i = 0; i < SN_STROKE_SAMPLES; i++)
        assert_true(distance_to_line(sn_v3_load(r.path + 3 * i), a, e) < 1e-9);
    for (int i = 1; i < 3; i++) assert_true(distance_to_line(sn_v3_load(point + 3 * i), a, e) < 1e-6);
    assert_float_equal(r.path_length, sn_v3_dist(a, e), 1e-9);
    assert_true(r.rms < 1e-6 && r.max < 1e-6 && r.inside_bone == 0.0 && r.outside_skin == 0.0);
    assert_true(r.snapped[0] == 0.0 && r.snapped[1] == 0.0);
    free_body(&b);
}

static void linear_depth(void **state)
{
    (void)state;
    body b;
    double pixel[6], point[12], seen[2];
    new_body(&b, NULL);
    straight_pixels(pixel);
    memcpy(pixel + 4, pixel + 2, 2 * sizeof *pixel);
    pixel[2] = 200.0;
    pixel[3] = 160.0; /* over the middle */
    const sn_stroke_options o = {.depth = SN_DEPTH_LINEAR};
    sn_stroke_report r = draw(&b, pixel, 3, &o, point);
    double first = 20.0 - r.path[2], last = 20.0 - r.path[3 * 64 + 2];
    double up = hypot(pixel[2] - pixel[0], pixel[3] - pixel[1]),
           length = up + hypot(pixel[4] - pixel[2], pixel[5] - pixel[3]);
    for (int i = 0; i < SN_STROKE_SAMPLES; i++) {
        double arc = length * i / 64;
        int leg = arc > up;
        double s = leg ? (arc - up) / (length - up) : arc / up;
        pixel_of(sn_v3_load(r.path + 3 * i), seen);
        assert_float_equal(20.0 - r.path[3 * i + 2], first + (last - first) * i / 64, 1e-9);
        for (int c = 0; c < 2; c++)
            assert_float_equal(seen[c],
                               pixel[2 * leg + c] + s * (pixel[2 * leg + 2 + c] - pixel[2 * leg + c]), 1e-6);
    }
    free_body(&b);
}

static void around_a_bone(void **state)
{
    (void)state;
    body b;
    double pixel[4], point[18];
    const sn_tri_mesh ball = made_sphere(sn_v3(0, 0, 0.2), 0.8, 0.1);
    new_body(&b, &ball);
    straight_pixels(pixel);
    for (int32_t k = 4; k <= 6; k++) {
        sn_stroke_report r = draw(&b, pixel, 2, &(sn_stroke_options){.n_point = k}, point);
        assert_true(r.inside_bone == 0.0 && r.outside_skin == 0.0);
        assert_true(least_gap(point, k, &ball, false) > 0.5 * 0.01 * DIAGONAL);
        assert_true(least_gap(point, k, &b.skin, true) > 0.5 * 0.01 * DIAGONAL);
        assert_true(r.path[3 * 32 + 2] > 1.0); /* before the ball, not behind */
        for (int i = 0; i < SN_STROKE_SAMPLES; i++) assert_true(fabs(r.path[3 * i + 1]) < 1e-9); /* on it */
    }
    sn_stroke_report wide = draw(&b, pixel, 2, &(sn_stroke_options){.margin = 0.4, .n_point = 6}, point);
    assert_true(wide.inside_bone == 0.0 && least_gap(point, 6, &ball, false) > 0.2);
    free_body(&b);
}

static void behind_a_bone_that_touches_the_skin(void **state)
{
    (void)state;
    body b;
    double pixel[4], point[18];
    const sn_tri_mesh block = made_box(sn_v3(-0.4, -1.5, -0.5), sn_v3(0.4, 1.5, 2.1));
    new_body(&b, &block);
    straight_pixels(pixel);
    sn_stroke_report r = draw(&b, pixel, 2, &(sn_stroke_options){.n_point = 6}, point);
    assert_true(r.inside_bone == 0.0 && r.outside_skin == 0.0);
    assert_true(r.path[3 * 32 + 2] < -0.5 && r.path[3 * 32 + 2] > -2.0);
    assert_true(least_gap(point, 6, &block, false) > 0.03);
    free_body(&b);
}

/* No depth is free: the path leaves the stroke by a little. */
static void beside_a_bone_through_the_skin(void **state)
{
    (void)state;
    body b;
    double pixel[4], point[18];
    const sn_tri_mesh wall = made_box(sn_v3(-0.3, -2.5, -2.5), sn_v3(0.3, 0.04, 2.5));
    new_body(&b, &wall);
    straight_pixels(pixel);
    sn_stroke_report r = draw(&b, pixel, 2, &(sn_stroke_options){.n_point = 6, .margin = 0.05}, point);
    assert_true(r.inside_bone == 0.0 && r.outside_skin == 0.0);
    assert_true(r.path[3 * 32 + 1] > 0.04 && r.path[3 * 32 + 1] < 0.4);
    free_body(&b);
}

/* A wall that leaves no way: the curve is made all the same, and the report says how much lies in bone. */
static void no_way_is_reported(void **state)
{
    (void)state;
    body b;
    double pixel[4], point[12];
    const sn_tri_mesh wall = made_box(sn_v3(-0.5, -3, -3), sn_v3(0.5, 3, 3));
    new_body(&b, &wall);
    straight_pixels(pixel);
    sn_stroke_report r = draw(&b, pixel, 2, &(sn_stroke_options){0}, point);
    assert_true(r.inside_bone > 0.1 && r.inside_bone < 0.4); /* 1 of 5 */
    free_body(&b);
}

/* The number of points along the stroke does not matter, nor doubled ones. */
static void only_the_shape_of_the_stroke_counts(void **state)
{
    (void)state;
    enum { many = 301 };
    body b;
    double few[6], fine[2 * 2 * many], a[12], c[12];
    const sn_tri_mesh ball = made_sphere(sn_v3(0, 0, 0.2), 0.8, 0.1);
    new_body(&b, &ball);
    straight_pixels(few);
    memcpy(few + 4, few + 2, 2 * sizeof *few);
    few[2] = 230.0;
    few[3] = 180.0;
    for (int i = 0; i < 2 * many; i++) { /* each point twice, crowded towards the start */
        double u = 2.0 * pow((double)(i / 2) / (many - 1), 2.0);
        int leg = u > 1.0;
        for (int d = 0; d < 2; d++)
            fine[2 * i + d] = few[2 * leg + d] + (u - leg) * (few[2 * leg + 2 + d] - few[2 * leg + d]);
    }
    (void)draw(&b, few, 3, &(sn_stroke_options){0}, a);
    (void)draw(&b, fine, 2 * many, &(sn_stroke_options){0}, c);
    for (int i = 0; i < 12; i++) assert_float_equal(a[i], c[i], 0.02); /* the corner is cut by one interval */
    free_body(&b);
}

static void no_result_depends_on_threads(void **state)
{
    (void)state;
    body b;
    double pixel[4], one[12], four[12];
    const sn_tri_mesh ball = made_sphere(sn_v3(0, 0, 0.2), 0.8, 0.1);
    new_body(&b, &ball);
    straight_pixels(pixel);
    const sn_stroke s = {.view = view, .pixel = pixel, .n_pixel = 2};
    const sn_stroke_options o = {0};
    assert_int_equal(sn_stroke_curve(&s, &b.given, &o, &(sn_run){.n_threads = 1}, one, NULL, NULL), SN_OK);
    assert_int_equal(sn_stroke_curve(&s, &b.given, &o, &(sn_run){.n_threads = 4}, four, NULL, NULL), SN_OK);
    assert_memory_equal(one, four, sizeof one);
    free_body(&b);
}

static void no_result_depends_on_the_unit(void **state)
{
    (void)state;
    body b;
    double pixel[4], m[12], mm[12];
    sn_tri_mesh ball = made_sphere(sn_v3(0, 0, 0.2), 0.8, 0.1);
    new_body(&b, &ball);
    straight_pixels(pixel);
    (void)draw(&b, pixel, 2, &(sn_stroke_options){0}, m);
    scale_mesh(&b.skin, 1024.0);
    for (int i = 0; i < 3; i++) scale_mesh(&b.bone[i], 1024.0);
    sn_stroke s = {.view = view, .pixel = pixel, .n_pixel = 2};
    s.view.eye.z *= 1024.0;
    assert_int_equal(sn_stroke_curve(&s, &b.given, &(sn_stroke_options){0}, NULL, mm, NULL, NULL), SN_OK);
    for (int i = 0; i < 12; i++) assert_float_equal(mm[i] / 1024.0, m[i], 1e-5);
    free_body(&b);
}

/* An eye inside a bone sees the bones beyond it; surfaces that are inside out are turned. */
static void eye_inside_a_bone(void **state)
{
    (void)state;
    body b;
    double pixel[4], point[12];
    const sn_tri_mesh around = made_sphere(sn_v3(0, 0, 20), 1.0, 0.3);
    new_body(&b, &around);
    for (int i = 0; i < 3; i++) turn_faces(&b.bone[i]);
    turn_faces(&b.skin);
    straight_pixels(pixel);
    sn_stroke_report r = draw(&b, pixel, 2, &(sn_stroke_options){0}, point);
    assert_true(r.bone[0] == 0 && r.bone[1] == 1 && r.inside_bone == 0.0 && r.outside_skin == 0.0);
    assert_float_equal(sn_v3_dist(sn_v3_load(point), sn_v3(-3, 0, 0)), 0.5, 0.01);
    free_body(&b);
}

static void without_skin(void **state)
{
    (void)state;
    body b;
    double pixel[4], point[12];
    const sn_tri_mesh ball = made_sphere(sn_v3(0, 0, 0.2), 0.8, 0.1);
    new_body(&b, &ball);
    b.given.skin = NULL;
    straight_pixels(pixel);
    sn_stroke_report r = draw(&b, pixel, 2, &(sn_stroke_options){0}, point);
    assert_true(r.inside_bone == 0.0 && r.outside_skin == 0.0 && least_gap(point, 4, &ball, false) > 0.02);
    free_body(&b);
}

/* A ball of radius R at distance D is seen up to the angle asin(R / D) from its middle. */
static void ends_snap_to_the_rim(void **state)
{
    (void)state;
    body b;
    double pixel[4], point[12];
    new_body(&b, NULL);
    straight_pixels(pixel);
    double d = hypot(3.0, 20.0), rim = tan(atan2(3.0, 20.0) + asin(0.5 / d)) / SLOPE; /* from the middle */
    pixel[0] = 200.0 - rim - 8.0;
    pixel[1] = 200.0;
    sn_stroke_report r = draw(&b, pixel, 2, &(sn_stroke_options){.snap = 10.0}, point);
    assert_float_equal(r.snapped[0], 8.0, 0.2);
    assert_true(r.snapped[1] == 0.0 && r.bone[0] == 0 && r.bone[1] == 1);
    assert_float_equal(sn_v3_dist(sn_v3_load(point), sn_v3(-3, 0, 0)), 0.5, 0.01);
    free_body(&b);
}

/* ---- errors ---- */

static void assert_refused(const body *b, sn_stroke s, sn_stroke_options o, const char *message)
{
    double point[12] = {7};
    sn_stroke_report r = {.rms = 7};
    sn_error err = {.msg = ""};
    assert_int_equal(sn_stroke_curve(&s, &b->given, &o, NULL, point, &r, &err), SN_EINVAL);
    if (!strstr(err.msg, message)) fail_msg("'%s' does not say '%s'", err.msg, message);
    assert_true(point[0] == 7 && r.rms == 7);
}

static void bad_strokes(void **state)
{
    (void)state;
    body b;
    double pixel[4], same[4], hole[4], spot[6];
    new_body(&b, NULL);
    straight_pixels(pixel);
    const sn_stroke good = {.view = view, .pixel = pixel, .n_pixel = 2};
    sn_stroke s = good;
    s.n_pixel = 1;
    assert_refused(&b, s, (sn_stroke_options){0}, "a stroke has 1 point, need 2 or more");
    s.n_pixel = 0;
    assert_refused(&b, s, (sn_stroke_options){0}, "a stroke has 0 points, need 2 or more");
    s = good;
    memcpy(same, pixel, sizeof same);
    memcpy(same + 2, same, 2 * sizeof *same);
    s.pixel = same;
    assert_refused(&b, s, (sn_stroke_options){0}, "the stroke has no length: all its 2 points are equal");
    memcpy(hole, pixel, sizeof hole);
    hole[3] = NAN;
    s.pixel = hole;
    assert_refused(&b, s, (sn_stroke_options){0}, "point 2 of the stroke is not finite");
    hole[3] = -2e6;
    assert_refused(&b, s, (sn_stroke_options){0}, "-2e+06, need -1e6..1e6");
    memcpy(spot, pixel, 2 * sizeof *spot);
    memcpy(spot + 4, pixel, 2 * sizeof *spot);
    spot[2] = spot[3] = 200.0;
    s.pixel = spot;
    s.n_pixel = 3;
    assert_refused(&b, s, (sn_stroke_options){0},
                   "the stroke begins and ends at the same spot of bone 'left'");
    s = good;
    s.view.per_y = s.view.per_x;
    assert_refused(&b, s, (sn_stroke_options){0},
                   "the view that the stroke is drawn in is flat or not finite");
    s.view = view;
    s.view.eye.x = INFINITY;
    assert_refused(&b, s, (sn_stroke_options){0},
                   "the view that the stroke is drawn in is flat or not finite");
    assert_refused(&b, good, (sn_stroke_options){.n_point = 1}, "has 1 control point, need 2..32");
    assert_refused(&b, good, (sn_stroke_options){.n_point = 33}, "has 33 control points, need 2..32");
    assert_refused(&b, good, (sn_stroke_options){.snap = -1}, "snap is -1 pixels, need >= 0");
    assert_refused(&b, good, (sn_stroke_options){.margin = NAN}, "margin is nan, need >= 0");
    int32_t n_bone = b.given.n_bone;
    b.given.n_bone = 0;
    assert_refused(&b, good, (sn_stroke_options){0},
                   "there are no bones: a stroke begins and ends over a bone");
    b.given.n_bone = n_bone;
    free_body(&b);
}

static void missed_ends(void **state)
{
    (void)state;
    body b;
    double pixel[4];
    new_body(&b, NULL);
    straight_pixels(pixel);
    double d = hypot(3.0, 20.0), rim = tan(atan2(3.0, 20.0) + asin(0.5 / d)) / SLOPE;
    sn_stroke s = {.view = view, .pixel = pixel, .n_pixel = 2};
    pixel[0] = 200.0 - rim - 8.0;
    pixel[1] = 200.0;
    assert_refused(&b, s, (sn_stroke_options){0}, "the first point of the stroke (point 1, pixel ");
    assert_refused(&b, s, (sn_stroke_options){0},
                   ", 200) is not over a bone; the nearest is 'left' at pixel ");
    assert_refused(&b, s, (sn_stroke_options){0}, " pixels away (in space {-3.");
    assert_refused(&b, s, (sn_stroke_options){0}, " off the line of sight): begin there, or set snap = 9");
    assert_refused(&b, s, (sn_stroke_options){.snap = 7.0}, "begin there, or set snap = 9");
    straight_pixels(pixel);
    pixel[2] = 320.0;
    pixel[3] = 200.0;
    assert_refused(
        &b, s, (sn_stroke_options){0},
        "the last point of the stroke (point 2, pixel 320, 200) is not over a bone; the nearest is "
        "'right' at pixel 2");
    assert_refused(&b, s, (sn_stroke_options){0}, "end there, or set snap = ");
    pixel[2] = 1000.0; /* far away: no advice to snap */
    double point[12];
    sn_error err;
    assert_int_equal(sn_stroke_curve(&s, &b.given, &(sn_stroke_options){0}, NULL, point, NULL, &err),
                     SN_EINVAL);
    assert_non_null(strstr(err.msg, "the nearest is 'right'"));
    assert_null(strstr(err.msg, "snap"));
    s.view.eye.z = -20.0; /* all is behind */
    assert_refused(&b, s, (sn_stroke_options){0}, "is not over a bone, and no bone is before the camera");
    free_body(&b);
}

static void memory_and_interruption(void **state)
{
    (void)state;
    body b;
    double pixel[4], point[12];
    const sn_tri_mesh wall = made_box(sn_v3(-0.3, -2.5, -2.5), sn_v3(0.3, 0.04, 2.5)); /* all attempts */
    new_body(&b, &wall);
    straight_pixels(pixel);
    const sn_stroke s = {.view = view, .pixel = pixel, .n_pixel = 2};
    const sn_stroke_options o = {0};
    const sn_run run = {.n_threads = 1};
    sn_status st = SN_ENOMEM;
    int step = 1;
    for (int left = 0; st; left += step, step += step / 4 + 1) {
        ration r = {left, 0};
        sn_error err = {0};
        sn_set_allocator(RATION(r));
        st = sn_stroke_curve(&s, &b.given, &o, &run, point, NULL, &err);
        sn_set_allocator(NULL);
        assert_int_equal(r.in_use, 0);
        assert_true(st == SN_OK || (st == SN_ENOMEM && err.code == SN_ENOMEM && err.msg[0]));
    }
    volatile sig_atomic_t now = 1;
    assert_int_equal(sn_stroke_curve(&s, &b.given, &o, &(sn_run){.cancel = &now}, point, NULL, NULL),
                     SN_ECANCEL);
    free_body(&b);
}

/* ---- in a scene ---- */

static sn_scene *new_scene(const body *b)
{
    sn_scene *s = NULL;
    assert_int_equal(sn_scene_create(&s, "limb", "cm", SN_UP_Y, NULL), SN_OK);
    assert_int_equal(sn_scene_set_skin(s, &b->skin, NULL), SN_OK);
    for (int i = 0; i < b->given.n_bone; i++)
        assert_int_equal(sn_scene_add_bone(s, names[i], &b->bone[i], NULL), SN_OK);
    return s;
}

/* The scene's lines of sight are those of its camera: what is drawn over a point ends on it. */
static void a_scene_draws_a_muscle(void **state)
{
    (void)state;
    body b;
    sn_camera c;
    double pixel[4], tissue[3] = {1, 2, 3};
    sn_stroke_report r;
    new_body(&b, NULL);
    sn_scene *s = new_scene(&b);
    assert_int_equal(sn_camera_preset(&c, "iso", sn_scene_bounds(s), SN_UP_Y, 1.5, NULL), SN_OK);
    const sn_vec3 on_left = sn_v3_mad(sn_v3(-3, 0, 0), 0.5, sn_v3_unit(sn_v3_sub(c.eye, sn_v3(-3, 0, 0))));
    const sn_vec3 on_right =
        sn_v3_mad(sn_v3(3, 0, -0.5), 0.5, sn_v3_unit(sn_v3_sub(c.eye, sn_v3(3, 0, -0.5))));
    assert_true(sn_camera_project(&c, on_left, 300, 200, &pixel[0], &pixel[1]));
    assert_true(sn_camera_project(&c, on_right, 300, 200, &pixel[2], &pixel[3]));
    const sn_scene_stroke stroke = {.name = "flexor",
                                    .camera = &c,
                                    .width = 300,
                                    .height = 200,
                                    .pixel = pixel,
                                    .n_pixel = 2,
                                    .tissue = tissue};
    uint64_t before = sn_scene_revision(s);
    assert_int_equal(sn_scene_draw_muscle(s, &stroke, &(sn_stroke_options){.n_point = 3}, NULL, &r, NULL),
                     SN_OK);
    assert_true(sn_scene_muscle_count(s) == 1 && sn_scene_revision(s) > before);
    const sn_muscle *m = sn_scene_muscle(s, 0);
    assert_string_equal(m->name, "flexor");
    assert_true(m->n_head == 1 && m->head[0].n_point == 3 && m->head[0].tissue[1] == 2.0 && r.bone[1] == 1);
    assert_true(sn_v3_dist(sn_v3_load(m->head[0].point), on_left) < 0.01);
    assert_true(sn_v3_dist(sn_v3_load(m->head[0].point + 6), on_right) < 0.01);
    assert_int_equal(sn_scene_notes(s)->n_line, 0);
    sn_scene_destroy(s);
    free_body(&b);
}

static void a_scene_refuses_and_notes(void **state)
{
    (void)state;
    body b;
    sn_camera c;
    sn_error err;
    double pixel[4] = {-50, -50, 0, 0};
    const sn_tri_mesh wall = made_box(sn_v3(-0.5, -1.9, -3), sn_v3(0.5, 1.9, 3));
    new_body(&b, &wall);
    sn_scene *s = new_scene(&b);
    assert_int_equal(sn_camera_preset(&c, "front", sn_scene_bounds(s), SN_UP_Y, 1.5, NULL), SN_OK);
    sn_scene_stroke stroke = {
        .name = "flexor", .camera = &c, .width = 300, .height = 200, .pixel = pixel, .n_pixel = 2};
    const sn_stroke_options o = {0};
    uint64_t before = sn_scene_revision(s);
    assert_int_equal(sn_scene_draw_muscle(s, &stroke, &o, NULL, NULL, &err), SN_EINVAL);
    assert_non_null(
        strstr(err.msg, "muscle 'flexor': the first point of the stroke (point 1, pixel -50, -50)"));
    stroke.width = 0;
    assert_int_equal(sn_scene_draw_muscle(s, &stroke, &o, NULL, NULL, &err), SN_EINVAL);
    assert_string_equal(err.msg, "the picture is 0 x 200 pixels, need 1 or more");
    stroke.width = 300;
    sn_camera flat = c;
    flat.target = flat.eye;
    stroke.camera = &flat;
    assert_int_equal(sn_scene_draw_muscle(s, &stroke, &o, NULL, NULL, &err), SN_EINVAL);
    assert_non_null(strstr(err.msg, "muscle 'flexor': camera: "));
    stroke.camera = &c;
    assert_true(sn_camera_project(&c, sn_v3(-2.6, 0, 0.2), 300, 200, &pixel[0], &pixel[1]));
    assert_true(sn_camera_project(&c, sn_v3(2.6, 0, -0.3), 300, 200, &pixel[2], &pixel[3]));
    stroke.name = "fat";
    assert_int_equal(sn_scene_draw_muscle(s, &stroke, &o, NULL, NULL, &err), SN_EINVAL);
    assert_string_equal(err.msg, "'fat' is no name for a muscle: it is tissue 0");
    assert_true(sn_scene_muscle_count(s) == 0 && sn_scene_revision(s) == before &&
                !sn_scene_notes(s)->n_line);
    stroke.name = "flexor";
    assert_int_equal(sn_scene_draw_muscle(s, &stroke, &o, NULL, NULL, &err), SN_OK);
    assert_int_equal(sn_scene_notes(s)->n_line, 1);
    assert_non_null(
        strstr(sn_scene_notes(s)->line[0], "% of the drawn curve is inside bone: give it more points"));
    sn_scene_destroy(s);
    free_body(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_curves_are_recovered),
        cmocka_unit_test(fractions_are_of_the_length),
        cmocka_unit_test(weights_and_ends),
        cmocka_unit_test(fit_errors),
        cmocka_unit_test(straight_where_nothing_is_in_the_way),
        cmocka_unit_test(linear_depth),
        cmocka_unit_test(around_a_bone),
        cmocka_unit_test(behind_a_bone_that_touches_the_skin),
        cmocka_unit_test(beside_a_bone_through_the_skin),
        cmocka_unit_test(no_way_is_reported),
        cmocka_unit_test(only_the_shape_of_the_stroke_counts),
        cmocka_unit_test(no_result_depends_on_threads),
        cmocka_unit_test(no_result_depends_on_the_unit),
        cmocka_unit_test(eye_inside_a_bone),
        cmocka_unit_test(without_skin),
        cmocka_unit_test(ends_snap_to_the_rim),
        cmocka_unit_test(bad_strokes),
        cmocka_unit_test(missed_ends),
        cmocka_unit_test(memory_and_interruption),
        cmocka_unit_test(a_scene_draws_a_muscle),
        cmocka_unit_test(a_scene_refuses_and_notes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
