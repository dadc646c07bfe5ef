/* test_place_curve - bones in a row along a curve. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "asserts.h"
#include "failing_memory.h"
#include "made_mesh.h"
#include "mesh/mesh_check.h"
#include "mesh/spline.h"
#include "skeleton/place.h"

/* ---- a vertebra of boxes: a body, 25 high and 40 wide, and a process that slopes down behind it ---- */

static sn_bone_template made_vertebra(double unit)
{
    static char name[] = "vertebra";
    sn_bone_template t = {.name = name, .kind = SN_BONE_CURVE, .length = 0.03 * unit};
    t.bone = made_box(sn_v3(-0.02, -0.0125, -0.015), sn_v3(0.02, 0.0125, 0.02));
    sn_tri_mesh b = made_box(sn_v3(-0.004, -0.01, -0.06), sn_v3(0.004, 0.01, -0.016));
    for (int v = 0; v < 8; v++)
        if (b.pos[3 * v + 2] < -0.05) b.pos[3 * v + 1] -= 0.012;
    append_mesh(&t.bone, &b, 0);
    scale_mesh(&t.bone, unit);
    return t;
}

typedef struct placed {
    sn_affine *map;
    int32_t n;
    sn_curve_report r;
} placed;

static placed place(const sn_bone_template *t, const double *point, int32_t n, sn_curve_options o)
{
    placed p;
    sn_error err = {.msg = ""};
    if (sn_place_curve(t, point, n, &o, NULL, &p.map, &p.n, &p.r, &err)) fail_msg("%s", err.msg);
    return p;
}

/* Pairs of faces of different bones that cross, of all bones in one mesh. */
static int64_t crossings(const sn_bone_template *t, const placed *p)
{
    sn_tri_mesh all;
    sn_mesh_check c, one;
    sn_tri_mesh_init(&all);
    assert_int_equal(sn_mesh_check_run(&one, &t->bone, NULL, NULL), SN_OK);
    for (int32_t k = 0; k < p->n; k++) {
        sn_tri_mesh m;
        sn_tri_mesh_init(&m);
        assert_int_equal(sn_tri_mesh_copy(&m, &t->bone, NULL), SN_OK);
        sn_affine_mesh(&p->map[k], &m);
        if (k == 0)
            all = m;
        else
            append_mesh(&all, &m, 0);
    }
    assert_int_equal(sn_mesh_check_run(&c, &all, NULL, NULL), SN_OK);
    sn_tri_mesh_free(&all);
    return c.self_intersections - p->n * one.self_intersections;
}

/* Columns at right angles, x and z alike, not mirrored. */
static void assert_sound(const placed *p, double thickness)
{
    for (int32_t k = 0; k < p->n; k++) {
        const sn_affine *a = &p->map[k];
        double x = sn_v3_len(a->col[0]), y = sn_v3_len(a->col[1]), z = sn_v3_len(a->col[2]);
        assert_near(x, thickness * y, 1e-12 * y);
        assert_near(z, thickness * y, 1e-12 * y);
        for (int i = 0; i < 3; i++)
            assert_near(sn_v3_dot(a->col[i], a->col[(i + 1) % 3]), 0.0, 1e-12 * y * y);
        assert_true(sn_affine_det(a) > 0.0);
    }
}

/* The greatest turn from one bone to the next, degrees. */
static double greatest_turn(const placed *p)
{
    double most = 0.0;
    for (int32_t k = 1; k < p->n; k++) {
        double trace = 0.0;
        for (int i = 0; i < 3; i++)
            trace += sn_v3_dot(sn_v3_unit(p->map[k].col[i]), sn_v3_unit(p->map[k - 1].col[i]));
        most = fmax(most, acos(fmin(fmax(0.5 * (trace - 1.0), -1.0), 1.0)));
    }
    return most * 180.0 / TEST_PI;
}

/* ---- the same by other means: where on the spline a point is, by length ---- */

static double speed(const sn_cubic *c, double t)
{
    return sn_v3_len(sn_cubic_tangent(c, t));
}

static double simpson(const sn_cubic *c, double to)
{
    enum { n = 4000 };
    double sum = speed(c, 0.0) + speed(c, to);
    for (int i = 1; i < n; i++) sum += (i % 2 ? 4.0 : 2.0) * speed(c, to * i / n);
    return sum * to / n / 3.0;
}

static double arc_at(const sn_spline *s, sn_vec3 p)
{
    double best = INFINITY, arc = 0.0, before = 0.0;
    for (int32_t i = 0; i < s->n_seg; i++) {
        const sn_cubic *c = &s->seg[i];
        double near = INFINITY, t = 0.0;
        for (int k = 0; k <= 200; k++) {
            double d = sn_v3_dist(p, sn_cubic_point(c, k / 200.0));
            if (d < near) near = d, t = k / 200.0;
        }
        for (int k = 0; k < 50; k++) {
            sn_vec3 v = sn_cubic_tangent(c, t);
            t = fmin(fmax(t + sn_v3_dot(v, sn_v3_sub(p, sn_cubic_point(c, t))) / sn_v3_len2(v), 0.0), 1.0);
        }
        near = sn_v3_dist(p, sn_cubic_point(c, t));
        if (near < best) best = near, arc = before + simpson(c, t);
        before += simpson(c, 1.0);
    }
    assert_near(best, 0.0, 1e-9 * before);
    return arc;
}

static void assert_spaced(const double *point, int32_t n, int count)
{
    sn_bone_template t = made_vertebra(0.01);
    placed p = place(&t, point, n, (sn_curve_options){.count = count, .thickness = 0.1});
    sn_spline s = {0};
    assert_int_equal(sn_spline_build(&s, point, n, NULL), SN_OK);
    double length = sn_spline_length(&s);
    assert_int_equal(p.n, count);
    assert_near(p.r.length, length, 1e-12 * length);
    assert_near(p.r.spacing, length / count, 1e-12 * length);
    assert_near(p.r.rms, 0.0, 0.0);
    assert_sound(&p, 0.1);
    for (int k = 0; k < count; k++) {
        double arc = arc_at(&s, p.map[k].t);
        assert_near(arc, length * (k + 0.5) / count, 1e-9 * length);
        assert_at(sn_v3_unit(p.map[k].col[1]), sn_spline_tangent(&s, arc), 1e-7);
        assert_near(sn_v3_len(p.map[k].col[1]), p.r.fill * p.r.spacing / t.length,
                    1e-10 * p.r.spacing / t.length);
    }
    sn_spline_free(&s);
    sn_release(p.map);
    sn_tri_mesh_free(&t.bone);
}

static void spacing_is_by_length(void **state)
{
    (void)state;
    const double line[] = {0, 0, 0, 1, 2, 2};
    double arc[36], wave[36];
    for (int i = 0; i < 12; i++) {
        double a = 0.5 * TEST_PI * i / 11;
        sn_v3_store(arc + 3 * i, sn_v3(cos(a), sin(a), 0));
        sn_v3_store(wave + 3 * i, sn_v3(0.3 * sin(1.1 * i), 0.5 * i + 0.1 * (i % 3), 0.2 * cos(0.7 * i)));
    }
    assert_spaced(line, 2, 5);
    assert_spaced(arc, 12, 9);
    assert_spaced(wave, 12, 24);
    sn_bone_template t = made_vertebra(1.0);
    placed p = place(&t, line, 2, (sn_curve_options){.count = 3});
    for (int k = 0; k < 3; k++) assert_at(p.map[k].t, sn_v3_scale((k + 0.5) / 3, sn_v3(1, 2, 2)), 1e-11);
    sn_release(p.map);
    sn_tri_mesh_free(&t.bone);
}

static const double up[] = {0, 0, 0, 0, 1, 0}; /* a line of length 1 towards the head */

static void sizes_grow_along(void **state)
{
    (void)state;
    sn_bone_template t = made_vertebra(1.0);
    placed p =
        place(&t, up, 2, (sn_curve_options){.count = 5, .size = {1, 3}, .fill = 0.8, .thickness = 1.5});
    double before = 0.0; /* sizes 1, 1.5, 2, 2.5, 3: a tenth of the length is 1 */
    for (int k = 0; k < 5; k++) {
        double piece = 0.1 * (1.0 + 0.5 * k);
        assert_at(p.map[k].t, sn_v3(0, before + 0.5 * piece, 0), 1e-12);
        assert_near(p.map[k].col[1].y, 0.8 * piece / 0.03, 1e-10);
        assert_near(p.map[k].col[2].z, 1.5 * 0.8 * piece / 0.03, 1e-10);
        before += piece;
    }
    assert_sound(&p, 1.5);
    assert_near(p.r.spacing, 0.2, 1e-12);
    assert_near(p.r.fill, 0.8, 0.0);
    sn_release(p.map);
    p = place(&t, up, 2, (sn_curve_options){.count = 1, .size = {1, 3}});
    assert_at(p.map[0].t, sn_v3(0, 0.5, 0), 1e-12);
    assert_near(p.map[0].col[1].y, 1.0 / 0.03, 1e-10);
    sn_release(p.map);
    sn_tri_mesh_free(&t.bone);
}

static void a_spacing_gives_the_count(void **state)
{
    (void)state;
    sn_bone_template t = made_vertebra(1.0);
    const struct {
        double spacing, first, last;
        int n;
        double begin;
    } row[] = {{0.1, 0, 0, 10, 0.0}, {0.3, 0, 0, 3, 0.05}, {1.0, 0, 0, 1, 0.0}, {0.12, 0.25, 0.75, 4, 0.26}};
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        sn_curve_options o = {.spacing = row[i].spacing, .first = row[i].first, .last = row[i].last};
        placed p = place(&t, up, 2, o);
        assert_int_equal(p.n, row[i].n);
        assert_near(p.r.spacing, row[i].spacing, 1e-12);
        for (int k = 0; k < p.n; k++)
            assert_at(p.map[k].t, sn_v3(0, row[i].begin + (k + 0.5) * row[i].spacing, 0), 1e-12);
        sn_release(p.map);
    }
    placed p = place(&t, up, 2, (sn_curve_options){.count = 2, .first = 0.5, .last = 0.9});
    assert_near(p.r.length, 0.4, 1e-12);
    assert_at(p.map[0].t, sn_v3(0, 0.6, 0), 1e-12);
    assert_at(p.map[1].t, sn_v3(0, 0.8, 0), 1e-12);
    sn_release(p.map);
    sn_tri_mesh_free(&t.bone);
}

/* ---- strokes ---- */

/* A spine of 0.6 as a stroke of n points from below upwards, off the plane x = 0 by up to `off`. */
static void made_spine(double *point, int n, double off, double unit)
{
    for (int i = 0; i < n; i++) {
        double s = (double)i / (n - 1);
        sn_vec3 p = {off * sin(9.0 * i), 0.9 + 0.58 * s, 0.045 * sin(TEST_PI * (2.2 * s - 0.1))};
        sn_v3_store(point + 3 * i, sn_v3_scale(unit, p));
    }
}

static void strokes_are_projected_and_fitted(void **state)
{
    (void)state;
    enum { n = 150 };
    double point[3 * n];
    sn_bone_template t = made_vertebra(1.0);
    made_spine(point, n, 0.004, 1.0);
    placed p =
        place(&t, point, n, (sn_curve_options){.count = 24, .has_plane = true, .plane_normal = {-3, 0, 0}});
    assert_near(p.r.moved, 0.004, 1e-5);
    assert_true(p.r.rms > 0.0 && p.r.rms < 0.0005);
    for (int k = 0; k < p.n; k++) assert_true(p.map[k].t.x == 0.0 && p.map[k].col[1].x == 0.0);
    sn_release(p.map);
    p = place(&t, point, n, (sn_curve_options){.count = 24});
    assert_near(p.r.moved, 0.0, 0.0);
    assert_true(p.r.rms > 0.001); /* the wobble is not followed */
    sn_release(p.map);
    p = place(&t, point, n,
              (sn_curve_options){.count = 3,
                                 .thickness = 0.1,
                                 .has_plane = true,
                                 .plane_normal = {1, 1, 0},
                                 .plane_point = {0, 1, 0}});
    for (int k = 0; k < p.n; k++) assert_near(p.map[k].t.x + p.map[k].t.y, 1.0, 1e-12);
    sn_release(p.map);
    sn_tri_mesh_free(&t.bone);
}

/* The hand slows down: the curve stays. */
static void slow_strokes_are_like_fast_ones(void **state)
{
    (void)state;
    enum { n = 400 };
    double fast[3 * 60], slow[3 * n];
    sn_bone_template t = made_vertebra(1.0);
    made_spine(fast, 60, 0.0, 1.0);
    for (int i = 0; i < n; i++) {
        double s = pow((double)i / (n - 1), 3.0) * 59.0;
        int k = s < 58.0 ? (int)s : 58;
        sn_v3_store(slow + 3 * i, sn_v3_lerp(sn_v3_load(fast + 3 * k), sn_v3_load(fast + 3 * k + 3), s - k));
    }
    placed a = place(&t, fast, 60, (sn_curve_options){.count = 10, .n_control = 6});
    placed b = place(&t, slow, n, (sn_curve_options){.count = 10, .n_control = 6});
    for (int k = 0; k < 10; k++) assert_at(a.map[k].t, b.map[k].t, 1e-4);
    sn_release(a.map);
    sn_release(b.map);
    sn_tri_mesh_free(&t.bone);
}

/* ---- bones that do not cross ---- */

static void a_spine_of_24(void **state)
{
    (void)state;
    enum { n = 200 };
    double point[3 * n];
    sn_bone_template t = made_vertebra(1.0);
    made_spine(point, n, 0.001, 1.0);
    placed p =
        place(&t, point, n, (sn_curve_options){.count = 24, .has_plane = true, .plane_normal = {1, 0, 0}});
    assert_int_equal(p.n, 24);
    assert_sound(&p, 1.0);
    assert_true(p.r.fill >= 0.9);
    assert_int_equal(crossings(&t, &p), 0);
    for (int k = 0; k < 24; k++) {
        assert_true(p.map[k].col[2].z > 0.8 * sn_v3_len(p.map[k].col[2])); /* looks to the front */
        assert_near(sn_v3_unit(p.map[k].col[0]).x, 1.0, 1e-12);            /* left stays left    */
        assert_true(k == 0 || p.map[k].t.y > p.map[k - 1].t.y);
    }
    assert_true(greatest_turn(&p) < 15.0);
    sn_release(p.map);
    sn_tri_mesh_free(&t.bone);
}

/* Round a small circle, the processes inside of it, they are made smaller until none cross. */
static void tight_curves_shrink_them(void **state)
{
    (void)state;
    double point[3 * 9];
    sn_bone_template t = made_vertebra(1.0);
    for (int i = 0; i < 9; i++) {
        double a = TEST_PI * i / 8;
        sn_v3_store(point + 3 * i, sn_v3(0, 0.1 * cos(a), 0.1 * sin(a)));
    }
    sn_curve_options o = {.count = 8, .front = {0, 0, 1}, .fill = 1.1};
    placed p = place(&t, point, 9, o);
    assert_true(p.r.fill < 1.09 && p.r.fill >= 0.55);
    double steps = (1.0 - p.r.fill / 1.1) / 0.04;
    assert_near(steps, round(steps), 1e-9);
    assert_int_equal(crossings(&t, &p), 0);
    assert_near(sn_v3_len(p.map[0].col[1]), p.r.fill * p.r.spacing / t.length, 1e-9);
    for (int k = 0; k < 8; k++) { /* one step less does cross */
        double more = (p.r.fill + 0.044) / p.r.fill;
        for (int i = 0; i < 3; i++) p.map[k].col[i] = sn_v3_scale(more, p.map[k].col[i]);
    }
    assert_true(crossings(&t, &p) > 0);
    sn_release(p.map);

    sn_error err = {.msg = ""};
    o.thickness = 6.0;
    assert_int_equal(sn_place_curve(&t, point, 9, &o, NULL, &p.map, &p.n, &p.r, &err), SN_ESOLVE);
    assert_says(err, "bone template 'vertebra': bones 1 and ");
    assert_says(err, "of 8 cross near (");
    assert_says(err, "half their size (fill 0.55)");
    assert_null(p.map);
    assert_int_equal(p.n, 0);
    sn_tri_mesh_free(&t.bone);
}

/* A bone that lies within another one crosses nothing, and yet it is not beside it. */
static void bones_inside_bones_are_seen(void **state)
{
    (void)state;
    sn_bone_template t = made_vertebra(1.0);
    sn_tri_mesh_free(&t.bone);
    t.bone = made_box(sn_v3(-1, -0.1, -1), sn_v3(1, 0.1, 1));
    sn_error err = {.msg = ""};
    placed p;
    for (int side = 0; side < 2; side++) {
        sn_curve_options o = {.count = 2, .size = {1, 1}, .fill = 10};
        o.size[side] = 100.0; /* lengths 1 and 99 of 100, and the larger one six times as long as its piece */
        assert_int_equal(sn_place_curve(&t, up, 2, &o, NULL, &p.map, &p.n, &p.r, &err), SN_ESOLVE);
        assert_says(err, "bones 1 and 2 of 2 cross");
    }
    sn_tri_mesh_free(&t.bone);
}

/* ---- directions ---- */

static void reversal_is_the_same_row(void **state)
{
    (void)state;
    double point[3 * 8], back[3 * 8];
    sn_bone_template t = made_vertebra(1.0);
    made_spine(point, 8, 0.01, 1.0);
    for (int i = 0; i < 8; i++) memcpy(back + 3 * i, point + 3 * (7 - i), 3 * sizeof *back);
    placed a = place(&t, point, 8, (sn_curve_options){.count = 9, .size = {2, 1}});
    placed b = place(&t, back, 8, (sn_curve_options){.count = 9, .size = {1, 2}, .is_reversed = true});
    for (int k = 0; k < 9; k++) {
        assert_at(a.map[k].t, b.map[8 - k].t, 1e-9);
        for (int i = 0; i < 3; i++) assert_at(a.map[k].col[i], b.map[8 - k].col[i], 1e-7);
        assert_true(a.map[k].col[1].y > 0.0);
    }
    sn_release(a.map);
    sn_release(b.map);
    sn_tri_mesh_free(&t.bone);
}

/* Where the tangent is far enough from front, +z is front made perpendicular. */
static void fronts_are_followed(void **state)
{
    (void)state;
    double point[3 * 8];
    sn_bone_template t = made_vertebra(1.0);
    made_spine(point, 8, 0.01, 1.0);
    const sn_vec3 front[] = {{0, 0, 0}, {0, 0, 5}, {1, 0, 0}, {-1, 0.2, 0.3}};
    for (int f = 0; f < 4; f++) {
        placed p = place(&t, point, 8, (sn_curve_options){.count = 12, .front = front[f]});
        sn_vec3 want = f == 0 ? sn_v3(0, 0, 1) : front[f];
        for (int k = 0; k < 12; k++) {
            sn_vec3 y = sn_v3_unit(p.map[k].col[1]);
            assert_at(sn_v3_unit(p.map[k].col[2]), sn_v3_unit(sn_v3_mad(want, -sn_v3_dot(want, y), y)), 1e-9);
        }
        sn_release(p.map);
    }
    sn_tri_mesh_free(&t.bone);
}

/* An arch from up through the front's direction to down: in its plane nothing twists. */
static void arches_do_not_flip(void **state)
{
    (void)state;
    double point[3 * 12];
    sn_bone_template t = made_vertebra(1.0);
    for (int i = 0; i < 12; i++) {
        double a = 1.1 * TEST_PI * i / 11;
        sn_v3_store(point + 3 * i, sn_v3(0, sin(a), -cos(a)));
    }
    for (int reversed = 0; reversed < 2; reversed++) {
        placed p = place(&t, point, 12, (sn_curve_options){.count = 40, .is_reversed = reversed});
        assert_true(greatest_turn(&p) < 1.5 * 1.1 * 180.0 / 40);
        for (int k = 0; k < 40; k++)
            assert_near(sn_v3_unit(p.map[k].col[0]).x, sn_v3_unit(p.map[0].col[0]).x, 1e-9);
        assert_sound(&p, 1.0);
        sn_release(p.map);
    }
    /* a straight curve along front has one direction all along: that of the smallest turn */
    const double along[] = {0, 0, 0, 0, 0, 2};
    placed p = place(&t, along, 2, (sn_curve_options){.count = 4});
    for (int k = 0; k < 4; k++) {
        assert_at(sn_v3_unit(p.map[k].col[1]), sn_v3(0, 0, 1), 1e-12);
        assert_at(sn_v3_unit(p.map[k].col[2]), sn_v3(0, -1, 0), 1e-12);
    }
    sn_release(p.map);
    sn_tri_mesh_free(&t.bone);
}

/* Past the front's direction at some distance: turns are spread, none is a jump. */
static void crooked_curves_turn_evenly(void **state)
{
    (void)state;
    sn_bone_template t = made_vertebra(1.0);
    for (int by = -4; by <= 4; by++) {
        double point[3 * 12];
        for (int i = 0; i < 12; i++) {
            double a = TEST_PI * i / 11;
            sn_v3_store(point + 3 * i, sn_v3(0.1 * by * (a - sin(2.0 * a) / 2.0), sin(a), -cos(a)));
        }
        placed p = place(&t, point, 12, (sn_curve_options){.count = 40, .thickness = 0.2});
        if (!(greatest_turn(&p) < 25.0)) fail_msg("%d: turns by %g degrees", by, greatest_turn(&p));
        assert_sound(&p, 0.2);
        sn_release(p.map);
    }
    sn_tri_mesh_free(&t.bone);
}

/* ---- hostile input, units, threads, interruption, memory ---- */

static void rows_that_cannot_be_placed(void **state)
{
    (void)state;
    sn_bone_template t = made_vertebra(1.0), rod = t, flat = t;
    rod.kind = SN_BONE_CYLINDER;
    flat.length = 0.0;
    const double same[] = {1, 2, 3, 1, 2, 3, 1, 2, 3}, across[] = {-1, 2, 3, 1, 2, 3},
                 bad[] = {0, 0, 0, 0, NAN, 0};
    double loop[3 * 40];
    for (int i = 0; i < 40; i++)
        sn_v3_store(loop + 3 * i,
                    sn_v3(sin(2 * TEST_PI * (i % 39) / 39), cos(2 * TEST_PI * (i % 39) / 39), 0));
    const sn_curve_options five = {.count = 5};
    struct {
        const sn_bone_template *t;
        const double *point;
        int32_t n;
        sn_curve_options o;
        const char *says;
    } no[] = {{&t, up, 1, five, "bone template 'vertebra': the curve has 1 point, need 2..100000"},
              {&t, up, 0, five, "the curve has 0 points"},
              {&t, up, 100001, five, "the curve has 100001 points"},
              {&t, same, 3, five, "all 3 points of the curve are at (1, 2, 3), need two different"},
              {&t, across, 2, {.count = 5, .has_plane = true, .plane_normal = {1, 0, 0}}, "in the plane"},
              {&t, up, 2, {.count = 5, .has_plane = true}, "normal that is not zero"},
              {&t, bad, 2, five, "point 2 of the curve has a coordinate that is not finite"},
              {&t, loop, 40, five, "begins and ends at the same point"},
              {&rod, up, 2, five, "no bone of a row along a curve"},
              {&flat, up, 2, five, "its length along the curve is 0"},
              {&t, up, 2, {.count = 0}, "count is 0 and spacing is 0, need one of them"},
              {&t, up, 2, {.count = 5, .spacing = 0.1}, "count is 5 and spacing is 0.1"},
              {&t, up, 2, {.count = -1}, "count is -1, need 1..1000"},
              {&t, up, 2, {.count = 1001}, "count is 1001"},
              {&t, up, 2, {.spacing = -1}, "spacing is -1"},
              {&t, up, 2, {.spacing = NAN}, "spacing is nan"},
              {&t, up, 2, {.spacing = 1.5}, "spacing is 1.5, longer than the curve's 1"},
              {&t, up, 2, {.spacing = 1e-5}, "gives 100000 bones, need at most 1000"},
              {&t, up, 2, {.count = 5, .fill = -1}, "fill is -1"},
              {&t, up, 2, {.count = 5, .thickness = NAN}, "thickness is nan"},
              {&t, up, 2, {.count = 5, .size = {1, 0}}, "sizes are 1 and 0"},
              {&t, up, 2, {.count = 5, .first = 0.6, .last = 0.5}, "part of the curve is 0.6 to 0.5"},
              {&t, up, 2, {.count = 5, .first = 0.6}, "part of the curve is 0.6 to 0,"},
              {&t, up, 2, {.count = 5, .last = 1.5}, "part of the curve is 0 to 1.5"},
              {&t, up, 2, {.count = 5, .front = {NAN, 0, 0}}, "front has a coordinate"},
              {&t, up, 2, {.count = 5, .n_control = 1}, "1 control points, need 2..32"},
              {&t, up, 2, {.count = 5, .n_control = 33}, "33 control points"}};
    for (size_t i = 0; i < sizeof no / sizeof *no; i++) {
        sn_error err = {.msg = ""};
        placed p = {.n = 9};
        assert_int_equal(
            sn_place_curve(no[i].t, no[i].point, no[i].n, &no[i].o, NULL, &p.map, &p.n, NULL, &err),
            SN_EINVAL);
        assert_says(err, no[i].says);
        assert_null(p.map);
        assert_int_equal(p.n, 0);
    }
    sn_tri_mesh_free(&t.bone);
}

static void the_unit_does_not_matter(void **state)
{
    (void)state;
    enum { n = 90 };
    double small[3 * n], large[3 * n];
    sn_bone_template a = made_vertebra(1.0), b = made_vertebra(1000.0);
    made_spine(small, n, 0.002, 1.0);
    made_spine(large, n, 0.002, 1000.0);
    placed p = place(&a, small, n, (sn_curve_options){.spacing = 0.025, .fill = 1.3});
    placed q = place(&b, large, n, (sn_curve_options){.spacing = 25.0, .fill = 1.3});
    assert_int_equal(p.n, q.n);
    assert_near(p.r.fill, q.r.fill, 1e-12);
    assert_true(p.r.fill < 1.3);
    for (int k = 0; k < p.n; k++) {
        assert_at(sn_v3_scale(1000, p.map[k].t), q.map[k].t, 1e-5);
        for (int i = 0; i < 3; i++) assert_at(p.map[k].col[i], q.map[k].col[i], 1e-6);
    }
    sn_release(p.map);
    sn_release(q.map);
    sn_tri_mesh_free(&a.bone);
    sn_tri_mesh_free(&b.bone);
}

static void the_same_bits_for_any_threads(void **state)
{
    (void)state;
    enum { n = 90 };
    double point[3 * n];
    sn_bone_template t = made_vertebra(1.0);
    made_spine(point, n, 0.002, 1.0);
    sn_curve_options o = {.count = 24, .fill = 1.3};
    placed first = place(&t, point, n, o);
    for (int threads = 1; threads <= 5; threads += 2) {
        sn_run run = {.n_threads = threads};
        placed p;
        assert_int_equal(sn_place_curve(&t, point, n, &o, &run, &p.map, &p.n, &p.r, NULL), SN_OK);
        assert_int_equal(p.n, first.n);
        assert_memory_equal(p.map, first.map, (size_t)p.n * sizeof *p.map);
        assert_memory_equal(&p.r, &first.r, sizeof p.r);
        sn_release(p.map);
    }
    sn_release(first.map);
    sn_tri_mesh_free(&t.bone);
}

typedef struct stopper {
    volatile sig_atomic_t stop;
    int left;
} stopper;

static void count_down(void *user, const char *step, double fraction)
{
    stopper *s = user;
    assert_true(step && fraction <= 1.0);
    if (s->left-- <= 0) s->stop = 1;
}

static void interruptions_leave_nothing(void **state)
{
    (void)state;
    double point[3 * 9];
    sn_bone_template t = made_vertebra(1.0);
    made_spine(point, 9, 0.0, 1.0);
    sn_status st = SN_ECANCEL;
    int n = 0;
    for (; st == SN_ECANCEL; n++) {
        stopper s = {.left = n};
        sn_run run = {.cancel = &s.stop, .progress = count_down, .user = &s};
        sn_error err = {.msg = ""};
        placed p;
        st = sn_place_curve(&t, point, 9, &(sn_curve_options){.count = 24, .fill = 1.3}, &run, &p.map, &p.n,
                            &p.r, &err);
        if (st) assert_null(p.map);
        if (st && !strstr(err.msg, "interrupted while looking for crossing bones"))
            assert_says(err, "interrupted while placing bones along a curve");
        sn_release(p.map);
    }
    assert_int_equal(st, SN_OK);
    assert_true(n > 3);
    sn_tri_mesh_free(&t.bone);
}

static void memory_may_end_anywhere(void **state)
{
    (void)state;
    enum { n = 30 };
    double point[3 * n];
    sn_bone_template t = made_vertebra(1.0);
    made_spine(point, n, 0.001, 1.0);
    sn_status st = SN_ENOMEM;
    int left = 0;
    sn_run run = {.n_threads = 1};
    for (; st == SN_ENOMEM; left++) {
        failing f = {.left = left};
        placed p;
        sn_set_allocator(&(sn_allocator){failing_realloc, &f});
        st = sn_place_curve(&t, point, n, &(sn_curve_options){.count = 3, .thickness = 0.3}, &run, &p.map,
                            &p.n, &p.r, NULL);
        if (st) assert_null(p.map);
        sn_release(p.map);
        assert_int_equal(f.n_alive, 0);
        sn_set_allocator(NULL);
    }
    assert_int_equal(st, SN_OK);
    assert_true(left > 20);
    sn_tri_mesh_free(&t.bone);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spacing_is_by_length),
        cmocka_unit_test(sizes_grow_along),
        cmocka_unit_test(a_spacing_gives_the_count),
        cmocka_unit_test(strokes_are_projected_and_fitted),
        cmocka_unit_test(slow_strokes_are_like_fast_ones),
        cmocka_unit_test(a_spine_of_24),
        cmocka_unit_test(tight_curves_shrink_them),
        cmocka_unit_test(bones_inside_bones_are_seen),
        cmocka_unit_test(reversal_is_the_same_row),
        cmocka_unit_test(fronts_are_followed),
        cmocka_unit_test(arches_do_not_flip),
        cmocka_unit_test(crooked_curves_turn_evenly),
        cmocka_unit_test(rows_that_cannot_be_placed),
        cmocka_unit_test(the_unit_does_not_matter),
        cmocka_unit_test(the_same_bits_for_any_threads),
        cmocka_unit_test(interruptions_leave_nothing),
        cmocka_unit_test(memory_may_end_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
