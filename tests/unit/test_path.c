/* test_path - curves with frames carried along them: against closed formulas, and nearest places by brute
 * force. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "muscle/path.h"

#include "made_mesh.h"

static sn_muscle made_muscle(const sn_head_points *head, int32_t n)
{
    sn_muscle m;
    sn_error err = {.msg = ""};
    if (sn_muscle_init(&m, "psoas", head, n, &err)) fail_msg("%s", err.msg);
    return m;
}

static sn_paths paths_of(const sn_muscle *m)
{
    sn_paths p = {0};
    sn_error err = {.msg = ""};
    if (sn_paths_build(&p, m, &err)) fail_msg("%s", err.msg);
    assert_int_equal(p.n_head, m->n_head);
    return p;
}

static sn_paths paths_of_curve(const double *point, int32_t n, const sn_anisotropy *a)
{
    sn_muscle m = made_muscle(&(sn_head_points){point, NULL, n}, 1);
    sn_error err = {.msg = ""};
    if (a && sn_muscle_set_anisotropy(&m, a, &err)) fail_msg("%s", err.msg);
    sn_paths p = paths_of(&m);
    sn_muscle_free(&m);
    return p;
}

static void assert_near(sn_vec3 a, sn_vec3 b, double tolerance)
{
    if (!(sn_v3_dist(a, b) <= tolerance))
        fail_msg("{%g, %g, %g} is %g away from {%g, %g, %g}", a.x, a.y, a.z, sn_v3_dist(a, b), b.x, b.y, b.z);
}

static void assert_orthonormal(sn_triad f)
{
    assert_true(fabs(sn_v3_len(f.e1) - 1.0) < 1e-14 && fabs(sn_v3_len(f.e2) - 1.0) < 1e-14);
    assert_true(fabs(sn_v3_dot(f.e1, f.e2)) < 1e-14);
    assert_near(sn_v3_cross(f.e1, f.e2), f.e3, 1e-14);
}

static void assert_frames(const sn_path *p)
{
    for (int k = 0; k <= SN_PATH_STEPS; k++) assert_orthonormal(p->frame[k]);
    for (int k = -5; k <= 1005; k++) assert_orthonormal(sn_path_frame(p, p->length * k / 1000));
}

/* ---- frames ---- */

static void a_straight_curve(void **state)
{
    (void)state;
    const double point[] = {1, 2, 3, 4, 6, 3};
    sn_paths p = paths_of_curve(point, 2, NULL); /* along (0.6, 0.8, 0): z is what it runs along least */
    const sn_path *h = &p.head[0];
    assert_true(fabs(h->length - 5.0) < 1e-14);
    assert_frames(h);
    for (int k = 0; k <= SN_PATH_STEPS; k++) {
        double s = 5.0 * k / SN_PATH_STEPS;
        assert_near(h->point[k], sn_v3(1 + 0.6 * s, 2 + 0.8 * s, 3), 1e-11);
        assert_near(h->frame[k].e1, sn_v3(0.6, 0.8, 0), 1e-13);
        assert_near(h->frame[k].e2, sn_v3(0, 0, 1), 1e-13);
        assert_near(h->frame[k].e3, sn_v3(0.8, -0.6, 0), 1e-13);
    }
    const double arc[] = {-5.0, 0.0, 1.2345, 5.0, 10.0};
    for (int i = 0; i < 5; i++) {
        assert_near(sn_path_point(h, arc[i]), sn_v3(1 + 0.6 * arc[i], 2 + 0.8 * arc[i], 3), 1e-11);
        assert_near(sn_path_frame(h, arc[i]).e2, sn_v3(0, 0, 1), 1e-13);
    }
    sn_paths_free(&p);
    sn_paths_free(&p);
}

/* In a plane: what starts along the plane's normal stays so, and with it the third axis stays in the plane.
 */
static void a_curve_in_a_plane(void **state)
{
    (void)state;
    const double point[] = {0, 0, 1, 1, 1.5, 1, 3, 1, 1, 3.5, -1, 1, 2, -2, 1};
    sn_paths p = paths_of_curve(point, 5, NULL);
    assert_frames(&p.head[0]);
    for (int k = 0; k <= SN_PATH_STEPS; k++) assert_near(p.head[0].frame[k].e2, sn_v3(0, 0, 1), 1e-12);
    sn_paths_free(&p);
    p = paths_of_curve(point, 5, &(sn_anisotropy){true, 0, {1, 1, 1}, true, {-1, 1, 0}});
    assert_frames(&p.head[0]);
    for (int k = 0; k <= SN_PATH_STEPS; k++) {
        assert_near(p.head[0].frame[k].e3, sn_v3(0, 0, 1), 1e-12);
        assert_true(fabs(p.head[0].frame[k].e2.z) < 1e-12);
    }
    sn_paths_free(&p);
}

#define HELIX_POINTS 600

/* Radius 1, 0.4 of height per radian, two turns. */
static void make_helix(double *point)
{
    for (int i = 0; i < HELIX_POINTS; i++) {
        double a = 4.0 * TEST_PI * i / (HELIX_POINTS - 1);
        sn_v3_store(point + 3 * i, sn_v3(cos(a), sin(a), 0.4 * a));
    }
}

/* Against the normal and binormal the frame turns back by the torsion, 0.4 / (1 + 0.4^2) per length. */
static void a_helix_does_not_twist(void **state)
{
    (void)state;
    double *point = malloc(3 * HELIX_POINTS * sizeof *point), n = sqrt(1.16), torsion = 0.4 / 1.16;
    make_helix(point);
    sn_paths p = paths_of_curve(point, HELIX_POINTS, NULL);
    const sn_path *h = &p.head[0];
    assert_frames(h);
    assert_true(fabs(h->length - 4.0 * TEST_PI * n) < 1e-3);
    double first = 0.0, most = 0.0;
    for (int k = 8; k <= SN_PATH_STEPS - 8; k++) { /* the spline's ends are not quite the helix */
        double a = atan2(h->point[k].y, h->point[k].x);
        sn_vec3 normal = sn_v3(-cos(a), -sin(a), 0), tangent = sn_v3(-sin(a) / n, cos(a) / n, 0.4 / n);
        sn_vec3 binormal = sn_v3_cross(tangent, normal);
        assert_near(h->frame[k].e1, tangent, 1e-3);
        double angle = atan2(sn_v3_dot(h->frame[k].e2, binormal), sn_v3_dot(h->frame[k].e2, normal));
        angle += torsion * h->length * k / SN_PATH_STEPS;
        if (k == 8) first = angle;
        most = fmax(most, fabs(remainder(angle - first, 2.0 * TEST_PI)));
    }
    if (!(most < 1e-4)) fail_msg("the frame is off by %g", most);
    sn_paths_free(&p);
    free(point);
}

static void axis_and_angle(void **state)
{
    (void)state;
    double *point = malloc(3 * HELIX_POINTS * sizeof *point);
    make_helix(point);
    const double angle[] = {0.0, 30.0, 90.0, -45.0, 360.0, 1234.5};
    const sn_vec3 axis = {2, -1, 0.5};
    sn_paths none = paths_of_curve(point, HELIX_POINTS, &(sn_anisotropy){true, 0, {1, 1, 1}, true, axis});
    sn_triad f = none.head[0].frame[0];
    sn_vec3 across = sn_v3_unit(sn_v3_mad(axis, -sn_v3_dot(axis, f.e1), f.e1));
    assert_near(f.e2, across, 1e-14);
    for (int i = 0; i < 6; i++) {
        sn_paths p =
            paths_of_curve(point, HELIX_POINTS, &(sn_anisotropy){true, angle[i], {1, 2, 3}, true, axis});
        double c = cos(angle[i] * TEST_PI / 180), s = sin(angle[i] * TEST_PI / 180);
        for (int k = 0; k <= SN_PATH_STEPS; k++) { /* turned at the first point means turned everywhere */
            sn_triad a = none.head[0].frame[k], b = p.head[0].frame[k];
            assert_near(b.e1, a.e1, 0.0);
            assert_near(b.e2, sn_v3_mad(sn_v3_scale(c, a.e2), s, a.e3), 1e-12);
        }
        sn_paths_free(&p);
    }
    sn_paths_free(&none);
    free(point);
}

/* Along x the first head's axis is y. The second, along z, would take x of its own; the third runs along y
 * and must look elsewhere. */
static void heads_share_the_first_ones_axis(void **state)
{
    (void)state;
    const double along_x[] = {0, 0, 0, 2, 0, 0}, along_z[] = {0, 0, 0, 0, 0, 3},
                 along_y[] = {0, 0, 0, 0, 1, 0};
    sn_muscle m =
        made_muscle((sn_head_points[]){{along_x, NULL, 2}, {along_z, NULL, 2}, {along_y, NULL, 2}}, 3);
    sn_paths p = paths_of(&m), alone = paths_of_curve(along_z, 2, NULL);
    assert_near(p.head[0].frame[0].e2, sn_v3(0, 1, 0), 1e-15);
    assert_near(p.head[1].frame[0].e2, sn_v3(0, 1, 0), 1e-15);
    assert_near(alone.head[0].frame[0].e2, sn_v3(1, 0, 0), 1e-15);
    assert_orthonormal(p.head[2].frame[0]);
    assert_near(p.head[2].frame[0].e2, sn_v3(1, 0, 0), 1e-15);
    for (int k = 0; k < 3; k++) assert_true(fabs(p.head[k].length - (double[]){2, 3, 1}[k]) < 1e-12);
    const sn_anisotropy a = {true, 90, {1, 2, 1}, true, {0, 1, 1}}; /* the option is for all heads, too */
    assert_int_equal(sn_muscle_set_anisotropy(&m, &a, NULL), SN_OK);
    assert_int_equal(sn_paths_build(&p, &m, NULL), SN_OK); /* over what is there */
    assert_near(p.head[0].frame[0].e2, sn_v3_unit(sn_v3(0, -1, 1)), 1e-15);
    assert_near(p.head[1].frame[0].e2, sn_v3(-1, 0, 0), 1e-15); /* from y, turned about z */
    assert_near(p.head[2].frame[0].e2, sn_v3(1, 0, 0), 1e-15);  /* from z, turned about y */
    sn_paths_free(&p);
    sn_paths_free(&alone);
    sn_muscle_free(&m);
}

/* A curve that comes back the way it went, and one with points crowded at one place. */
static void awkward_curves_have_frames(void **state)
{
    (void)state;
    const double back[] = {0, 0, 0, 1, 0, 0, 0, 0, 0}, crowded[] = {0, 0, 0, 1, 1, 0, 1, 1, 1e-9, 2, 0, 1};
    sn_paths p = paths_of_curve(back, 3, NULL);
    assert_frames(&p.head[0]);
    assert_true(fabs(p.head[0].length - 2.0) < 1e-9);
    sn_paths_free(&p);
    p = paths_of_curve(crowded, 4, NULL);
    assert_frames(&p.head[0]);
    sn_paths_free(&p);
}

static void normals_towards_an_axis(void **state)
{
    (void)state;
    sn_vec3 n = {7, 7, 7};
    assert_true(sn_normal_towards(sn_v3(1, 0, 0), sn_v3(5, 3, 4), &n));
    assert_near(n, sn_v3(0, 0.6, 0.8), 1e-15);
    assert_true(
        sn_normal_towards(sn_v3(1, 0, 0), sn_v3(5e-9, 3e-9, 4e-9), &n)); /* its length does not matter */
    assert_near(n, sn_v3(0, 0.6, 0.8), 1e-15);
    assert_false(sn_normal_towards(sn_v3(1, 0, 0), sn_v3(-3, 1e-7, 0), &n));
    assert_false(sn_normal_towards(sn_v3(1, 0, 0), sn_v3(0, 0, 0), &n));
    assert_false(sn_normal_towards(sn_v3(1, 0, 0), sn_v3(0, NAN, 0), &n));
}

/* ---- places ---- */

enum { n_sample = 20000 };

static sn_paths two_heads(void)
{
    double helix[36];
    const double arch[] = {1.5, 1, -1, 0, -0.5, 1, 0.5, 0.2, 4};
    for (int i = 0; i < 12; i++) sn_v3_store(helix + 3 * i, sn_v3(1.2 * cos(0.5 * i), sin(0.5 * i), 0.3 * i));
    sn_muscle m = made_muscle((sn_head_points[]){{helix, NULL, 12}, {arch, NULL, 3}}, 2);
    sn_paths p = paths_of(&m);
    sn_muscle_free(&m);
    return p;
}

static double brute_distance(const sn_vec3 *sample, sn_vec3 q)
{
    double least = INFINITY;
    for (int i = 0; i <= n_sample; i++) least = fmin(least, sn_v3_len2(sn_v3_sub(q, sample[i])));
    return sqrt(least);
}

static void nearest_places(void **state)
{
    (void)state;
    sn_paths p = two_heads();
    sn_vec3 *sample[2];
    uint64_t h = 20;
    int n_before = 0, n_after = 0, n_head[2] = {0, 0};
    for (int k = 0; k < 2; k++) {
        sample[k] = malloc((n_sample + 1) * sizeof **sample);
        for (int i = 0; i <= n_sample; i++)
            sample[k][i] = sn_path_point(&p.head[k], p.head[k].length * i / n_sample);
    }
    for (int i = 0; i < 1500; i++) {
        sn_vec3 q = sn_v3(5 * made_random(&h) - 2.5, 5 * made_random(&h) - 2.5, 8 * made_random(&h) - 2.5);
        sn_curve_place at = sn_paths_place(&p, q);
        const sn_path *path = &p.head[at.head];
        double want[2] = {brute_distance(sample[0], q), brute_distance(sample[1], q)};
        double spacing = fmax(p.head[0].length, p.head[1].length) / n_sample;
        assert_true(at.distance <= fmin(want[0], want[1]) + 1e-12); /* samples miss the foot by half a step */
        assert_true(at.distance >= fmin(want[0], want[1]) - spacing);
        if (fabs(want[0] - want[1]) > spacing) assert_int_equal(at.head, want[1] < want[0]);
        double inside = fmin(fmax(at.arc, 0.0), path->length);
        assert_true(fabs(sn_v3_dist(q, sn_path_point(path, inside)) - at.distance) < 1e-9);
        if (at.arc < 0.0 || at.arc > path->length) { /* as far beyond the end as its tangent says */
            int end = at.arc < 0.0 ? 0 : SN_PATH_STEPS;
            double along = sn_v3_dot(sn_v3_sub(q, path->point[end]), path->frame[end].e1);
            assert_true(fabs(at.arc - inside - along) < 1e-12);
        }
        n_before += at.arc < 0.0;
        n_after += at.arc > path->length;
        n_head[at.head]++;
    }
    assert_true(n_before > 50 && n_after > 50 && n_head[0] > 200 && n_head[1] > 200);
    for (int k = 0; k < 2; k++) free(sample[k]);
    sn_paths_free(&p);
}

static void places_by_hand(void **state)
{
    (void)state;
    const double a[] = {0, 0, 0, 2, 0, 0}, b[] = {0, 2, 0, 2, 2, 0};
    sn_muscle m = made_muscle((sn_head_points[]){{a, NULL, 2}, {b, NULL, 2}}, 2);
    sn_paths p = paths_of(&m);
    const struct {
        sn_vec3 q;
        sn_curve_place want;
    } cases[] = {
        {{0.7, 0.3, 0.4}, {0, 0.7, 0.5}}, {{-3, 0, 4}, {0, -3, 5}},
        {{2.5, 3.2, 0}, {1, 2.5, 1.3}},   {{1.0, 1.0, 0}, {0, 1, 1}}, /* as near to both: the lower */
        {{2, 2, 0}, {1, 2, 0}},           {{0, 0, 0.5}, {0, 0, 0.5}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        sn_curve_place at = sn_paths_place(&p, cases[i].q);
        assert_int_equal(at.head, cases[i].want.head);
        assert_true(fabs(at.arc - cases[i].want.arc) < 1e-10);
        assert_true(fabs(at.distance - cases[i].want.distance) < 1e-10);
    }
    sn_paths_free(&p);
    sn_muscle_free(&m);
}

static void short_of_memory(void **state)
{
    (void)state;
    sn_muscle m = made_muscle(&(sn_head_points){(double[]){0, 0, 0, 1, 0, 0}, NULL, 2}, 1);
    sn_paths p = paths_of(&m);
    sn_error err;
    sn_paths_free(&p);
    ration r = {0, 0};
    sn_set_allocator(RATION(r));
    assert_int_equal(sn_paths_build(&p, &m, &err), SN_ENOMEM);
    sn_set_allocator(NULL);
    assert_string_equal(err.msg, "muscle 'psoas': no memory");
    assert_true(!p.head && p.n_head == 0);
    sn_muscle_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_straight_curve),
        cmocka_unit_test(a_curve_in_a_plane),
        cmocka_unit_test(a_helix_does_not_twist),
        cmocka_unit_test(axis_and_angle),
        cmocka_unit_test(heads_share_the_first_ones_axis),
        cmocka_unit_test(awkward_curves_have_frames),
        cmocka_unit_test(normals_towards_an_axis),
        cmocka_unit_test(nearest_places),
        cmocka_unit_test(places_by_hand),
        cmocka_unit_test(short_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
