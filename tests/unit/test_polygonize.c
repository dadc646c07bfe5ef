/* test_polygonize - closed manifold surfaces of functions on a lattice: accuracy, topology, exact zeros,
 * errors. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/alloc.h"
#include "mesh/polygonize.h"

#include "closed_surface.h"

#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

/* ---- functions ---- */

static double sphere(void *user, sn_vec3 p)
{
    const double *s = user; /* center, radius */
    return sn_v3_dist(p, sn_v3(s[0], s[1], s[2])) - s[3];
}

static double two_spheres(void *user, sn_vec3 p)
{
    double *s = user;
    return fmin(sphere(s, p), sphere(s + 4, p));
}

static double torus(void *user, sn_vec3 p)
{
    const double *r = user; /* ring, tube */
    return hypot(hypot(p.x, p.y) - r[0], p.z) - r[1];
}

static double box(void *user, sn_vec3 p)
{
    const double *half = user;
    return fmax(fabs(p.x) - half[0], fmax(fabs(p.y) - half[1], fabs(p.z) - half[2]));
}

static double constant(void *user, sn_vec3 p)
{
    (void)p;
    return *(const double *)user;
}

static double noise(void *user,
                    sn_vec3 p) /* any signs at all, the same for the same point; some NaN, some zero */
{
    uint64_t h = *(const uint64_t *)user;
    const double x[3] = {p.x, p.y, p.z};
    for (int k = 0; k < 3; k++) {
        uint64_t bits;
        memcpy(&bits, &x[k], sizeof bits);
        h = (h ^ bits) * 0x9e3779b97f4a7c15u;
        h ^= h >> 29;
    }
    int pick = (int)(h % 17);
    return pick == 0 ? NAN : pick == 1 ? 0.0 : pick == 2 ? -INFINITY : (double)(h % 1000) - 499.5;
}

static double gyroid(void *user, sn_vec3 p)
{
    double k = *(const double *)user;
    return sin(k * p.x) * cos(k * p.y) + sin(k * p.y) * cos(k * p.z) + sin(k * p.z) * cos(k * p.x);
}

static sn_box3 cube(double half)
{
    return (sn_box3){{-half, -half, -half}, {half, half, half}};
}

static sn_tri_mesh polygonize(sn_polygonize p)
{
    sn_tri_mesh m;
    sn_error err = {.msg = ""};
    sn_tri_mesh_init(&m);
    if (sn_polygonize_run(&p, NULL, &m, &err)) fail_msg("%s", err.msg);
    assert_closed_manifold(&m);
    return m;
}

/* ---- tests ---- */

static void sphere_converges_at_second_order(void **state)
{
    (void)state;
    double s[4] = {0.03, -0.02, 0.01, 1.0}, volume[3], area[3], cell[3] = {0.2, 0.1, 0.05};
    for (int i = 0; i < 3; i++) {
        sn_tri_mesh m = polygonize((sn_polygonize){sphere, s, cube(1.05), cell[i], true});
        assert_int_equal(euler_characteristic(&m), 2);
        for (int32_t v = 0; v < m.n_vert; v++) /* on the surface, but for the few moved off lattice points */
            assert_true(fabs(sphere(s, sn_tri_mesh_point(&m, v))) < 1.1e-2 * cell[i]);
        volume[i] = 4.0 / 3.0 * PI - sn_tri_mesh_volume(&m); /* positive: oriented outward, and inscribed */
        area[i] = 4.0 * PI - sn_tri_mesh_area(&m);
        sn_tri_mesh_free(&m);
    }
    for (int i = 0; i < 2; i++) {
        assert_true(volume[i] > 0.0 && area[i] > 0.0);
        assert_true(volume[i] / volume[i + 1] > 3.6 && volume[i] / volume[i + 1] < 4.4);
        assert_true(area[i] / area[i + 1] > 3.6 && area[i] / area[i + 1] < 4.4);
    }
    assert_true(volume[2] < 5e-3);
}

static void most_vertices_lie_on_the_surface(void **state)
{
    (void)state;
    double s[4] = {0.03, -0.02, 0.01, 1.0};
    sn_tri_mesh m = polygonize((sn_polygonize){sphere, s, cube(1.05), 0.1, true});
    int32_t n_on = 0;
    for (int32_t v = 0; v < m.n_vert; v++) n_on += fabs(sphere(s, sn_tri_mesh_point(&m, v))) < 1e-7;
    assert_true(n_on > m.n_vert / 100 * 95); /* 2 percent of the edges cross within 1e-2 of an end */
    sn_tri_mesh_free(&m);
}

static void torus_has_genus_one(void **state)
{
    (void)state;
    double r[2] = {1.0, 0.3};
    sn_tri_mesh m = polygonize((sn_polygonize){torus, r, cube(1.3), 0.1, true});
    assert_int_equal(euler_characteristic(&m), 0);
    assert_int_equal(count_parts(&m), 1);
    assert_int_equal(count_crossings(&m), 0);
    assert_true(fabs(sn_tri_mesh_volume(&m) / (2.0 * PI * PI * 0.09) - 1.0) < 0.03);
    sn_tri_mesh_free(&m);
}

static void two_spheres_are_two_parts(void **state)
{
    (void)state;
    double s[8] = {-0.5, 0, 0, 0.4, 0.5, 0, 0, 0.4};
    sn_tri_mesh m = polygonize((sn_polygonize){two_spheres, s, cube(1.0), 0.13, true});
    assert_int_equal(count_parts(&m), 2);
    assert_int_equal(euler_characteristic(&m), 4);
    sn_tri_mesh_free(&m);
}

/* The lattice starts at box.min: corners at multiples of 1/8. The sphere of radius 1 passes exactly through
 * (1,0,0), and (0.6,0.8,0)-like points; radius 0.75 through (0.5,0.5,0.25). */
static void sphere_through_lattice_points(void **state)
{
    (void)state;
    const double radius[3] = {0.5, 0.75, 1.0};
    for (int i = 0; i < 3; i++) {
        double s[4] = {0, 0, 0, radius[i]};
        sn_tri_mesh m = polygonize((sn_polygonize){sphere, s, cube(1.0), 0.125, true});
        assert_int_equal(euler_characteristic(&m), 2);
        assert_int_equal(count_crossings(&m), 0);
        sn_tri_mesh_free(&m);
    }
}

/* All of the box's surface is in planes of lattice corners, then of cube centres. Its corners are zeros:
 * inside. Faces move out by 1e-2 of an edge between corners (0.25) or between a corner and a centre (half as
 * far along x). */
static void box_aligned_with_the_lattice(void **state)
{
    (void)state;
    double corners[3] = {1.0, 0.75, 0.5}, centres[3] = {0.875, 0.625, 0.375};
    double *half[2] = {corners, centres};
    for (int i = 0; i < 2; i++) {
        const double *h = half[i];
        sn_tri_mesh m = polygonize((sn_polygonize){box, half[i], cube(1.0), 0.25, true});
        assert_int_equal(euler_characteristic(&m), 2);
        assert_int_equal(count_crossings(&m), 0);
        sn_box3 b = sn_tri_mesh_bounds(&m);
        assert_true(b.max.x > h[0] + 0.001 && b.max.x < h[0] + 0.0026);
        assert_true(b.min.z < -h[2] - 0.001 && b.min.z > -h[2] - 0.0026);
        double most = 8.0 * (h[0] + 0.0025) * (h[1] + 0.0025) * (h[2] + 0.0025);
        assert_true(sn_tri_mesh_volume(&m) < most && sn_tri_mesh_volume(&m) > 0.9 * most); /* edges cut off */
        sn_tri_mesh_free(&m);
    }
}

/* A single zero at a lattice corner, all else outside: one closed cell around it, with a vertex on each of
 * its 14 edges and a face in each of its 24 tets. */
static void lone_zero(void **state)
{
    (void)state;
    double s[4] = {0, 0, 0, 0.0};
    sn_tri_mesh m = polygonize((sn_polygonize){sphere, s, cube(1.0), 1.0, false});
    assert_int_equal(m.n_vert, 14);
    assert_int_equal(m.n_face, 24);
    assert_true(sn_tri_mesh_volume(&m) > 0.0);
    for (int32_t v = 0; v < 14; v++) { /* 1e-2 of an edge of length 1 or sqrt(3)/2 */
        double d = sn_v3_len(sn_tri_mesh_point(&m, v));
        assert_true(fabs(d - 0.01) < 1e-12 || fabs(d - 0.01 * sqrt(0.75)) < 1e-12);
    }
    sn_tri_mesh_free(&m);
}

static void any_signs_give_a_manifold(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 6; seed++) {
        sn_tri_mesh m = polygonize((sn_polygonize){noise, &seed, cube(1.0), seed <= 3 ? 0.5 : 0.09, false});
        assert_true(m.n_face > 100);
        assert_true(sn_tri_mesh_volume(&m) > 0.0);
        if (seed <= 3) assert_int_equal(count_crossings(&m), 0);
        sn_tri_mesh_free(&m);
    }
}

static void no_faces(void **state)
{
    (void)state;
    double one = 1.0;
    sn_tri_mesh m = polygonize((sn_polygonize){constant, &one, cube(1.0), 0.1, false});
    assert_int_equal(m.n_face, 0);
    assert_int_equal(m.n_vert, 0);
    double s[4] = {0.05, 0.02, 0.05, 0.01}; /* slips between the points of the lattice */
    m = polygonize((sn_polygonize){sphere, s, cube(1.0), 0.5, true});
    assert_int_equal(m.n_face, 0);
    sn_tri_mesh_free(&m);
}

/* Inside everywhere: closed a quarter of a cell outside the box; lines and points are boxes too. */
static void inside_is_cut_off_at_the_box(void **state)
{
    (void)state;
    double minus = -1.0;
    const sn_box3 line = {{-1, 0, 0}, {1, 0, 0}}, point = {{5, 5, 5}, {5, 5, 5}};
    const sn_box3 boxes[3] = {cube(1.0), line, point};
    for (int i = 0; i < 3; i++) {
        sn_tri_mesh m = polygonize((sn_polygonize){constant, &minus, boxes[i], 0.2, i == 1});
        assert_int_equal(euler_characteristic(&m), 2);
        assert_int_equal(count_crossings(&m), 0);
        sn_box3 b = sn_tri_mesh_bounds(&m);
        assert_true(fabs(b.max.x - boxes[i].max.x - 0.05) < 1e-6);
        assert_true(fabs(b.min.z - boxes[i].min.z + 0.05) < 1e-6);
        sn_tri_mesh_free(&m);
    }
}

/* Skipping far blocks changes nothing, also where the box has many blocks and the surface is in few. */
static void skipping_changes_nothing(void **state)
{
    (void)state;
    double s[8] = {-2.5, 0.3, 0, 0.4, 1.5, -0.2, 0.1, 0.7};
    sn_tri_mesh a = polygonize((sn_polygonize){two_spheres, s, cube(3.0), 0.06, true});
    sn_tri_mesh b = polygonize((sn_polygonize){two_spheres, s, cube(3.0), 0.06, false});
    assert_int_equal(a.n_vert, b.n_vert);
    assert_int_equal(a.n_face, b.n_face);
    assert_memory_equal(a.pos, b.pos, 3 * (size_t)a.n_vert * sizeof *a.pos);
    assert_memory_equal(a.face, b.face, 3 * (size_t)a.n_face * sizeof *a.face);
    sn_tri_mesh_free(&a);
    sn_tri_mesh_free(&b);
}

static void threads_change_nothing(void **state)
{
    (void)state;
    double k = 6.0;
    sn_polygonize p = {gyroid, &k, cube(2.0), 0.08, false};
    sn_tri_mesh m[3];
    for (int i = 0; i < 3; i++) {
        sn_run run = {.n_threads = i + 1};
        sn_tri_mesh_init(&m[i]);
        assert_int_equal(sn_polygonize_run(&p, &run, &m[i], NULL), SN_OK);
        assert_int_equal(m[i].n_vert, m[0].n_vert);
        assert_int_equal(m[i].n_face, m[0].n_face);
        assert_memory_equal(m[i].pos, m[0].pos, 3 * (size_t)m[0].n_vert * sizeof *m[0].pos);
        assert_memory_equal(m[i].face, m[0].face, 3 * (size_t)m[0].n_face * sizeof *m[0].face);
    }
    assert_closed_manifold(&m[0]);
    for (int i = 0; i < 3; i++) sn_tri_mesh_free(&m[i]);
}

static void scaled_by_two_is_the_same(void **state) /* powers of two: to the bit */
{
    (void)state;
    double s[4] = {0.03, -0.02, 0.01, 1.0}, s2[4] = {0.06, -0.04, 0.02, 2.0};
    sn_tri_mesh a = polygonize((sn_polygonize){sphere, s, cube(1.05), 0.2, true});
    sn_tri_mesh b = polygonize((sn_polygonize){sphere, s2, cube(2.1), 0.4, true});
    assert_int_equal(a.n_vert, b.n_vert);
    for (size_t i = 0; i < 3 * (size_t)a.n_vert; i++) assert_true(2.0 * a.pos[i] == b.pos[i]);
    sn_tri_mesh_free(&a);
    sn_tri_mesh_free(&b);
}

/* ---- errors ---- */

static void expect_error(sn_polygonize p, const sn_run *run, sn_status code, const char *message)
{
    double s[4] = {0, 0, 0, 1};
    sn_tri_mesh m;
    sn_error err;
    sn_tri_mesh_init(&m);
    p.value = sphere;
    p.user = s;
    assert_int_equal(sn_polygonize_run(&p, run, &m, &err), code);
    if (!strstr(err.msg, message)) fail_msg("message is: %s", err.msg);
    assert_int_equal(err.code, code);
    assert_null(m.pos);
    assert_null(m.face);
}

static void errors(void **state)
{
    (void)state;
    sn_polygonize p = {.box = cube(1.0), .cell = 0.0};
    expect_error(p, NULL, SN_EINVAL, "polygonize: cell is 0, need > 0");
    p.cell = NAN;
    expect_error(p, NULL, SN_EINVAL, "polygonize: cell is nan, need > 0");
    p.cell = INFINITY;
    expect_error(p, NULL, SN_EINVAL, "polygonize: cell is inf, need > 0");
    p.cell = 0.1;
    p.box.max.y = NAN;
    expect_error(p, NULL, SN_EINVAL, "polygonize: box -1 -1 -1 to 1 nan 1 is empty or not finite");
    p.box.max.y = -2.0;
    expect_error(p, NULL, SN_EINVAL, "box -1 -1 -1 to 1 -2 1 is empty or not finite");
    p.box = sn_box3_empty();
    expect_error(p, NULL, SN_EINVAL, "is empty or not finite");
    p.box = (sn_box3){{1e6, 0, 0}, {1e6, 0, 0}};
    p.cell = 1e-4;
    expect_error(p, NULL, SN_EINVAL,
                 "polygonize: cell 0.0001 is too small for coordinates up to 1e+06, need 0.001");
    p.box = cube(1.0);
    expect_error(p, NULL, SN_ELIMIT,
                 "polygonize: cell 0.0001 needs 1.6e+13 lattice points, at most 2e8; a cell of 0.00438");
    p.cell = 1e-300;
    expect_error(p, NULL, SN_ELIMIT, "lattice points, at most 2e8; a cell of 0.00438");
}

static void smallest_cell(void **state)
{
    (void)state;
    double c = sn_polygonize_smallest_cell(cube(1.0)); /* 2 (2/c)^3 = 2e8: c = 0.0043 less the border */
    assert_true(c > 2.0 / 464.2 && c < 1.01 * 2.0 / 462.0);
    sn_box3 line = {{0, 0, 0}, {1, 0, 0}}; /* n + 3 slices of 9 corners, n + 2 of 4 centres: n = 2e8 / 13 */
    assert_true(fabs(sn_polygonize_smallest_cell(line) * 2e8 / 13.0 - 1.0) < 1e-3);
    sn_box3 point = {{3, 3, 3}, {3, 3, 3}};
    assert_true(sn_polygonize_smallest_cell(point) == 0.0);
}

static volatile sig_atomic_t stop;
static int n_reports;

static void stop_at_half(void *user, const char *step, double fraction)
{
    (void)user;
    assert_string_equal(step, "polygonizing");
    assert_true(fraction >= 0.0 && fraction <= 1.0);
    n_reports++;
    if (fraction >= 0.5) stop = 1;
}

static void interruption(void **state)
{
    (void)state;
    sn_polygonize p = {.box = cube(1.0), .cell = 0.1, .is_distance = true};
    sn_run run = {.n_threads = 2, .cancel = &stop};
    stop = 1;
    expect_error(p, &run, SN_ECANCEL, "interrupted while polygonizing");
    stop = 0;
    n_reports = 0;
    p.cell = 0.011; /* 24^3 blocks: four batches */
    run.progress = stop_at_half;
    expect_error(p, &run, SN_ECANCEL, "interrupted while polygonizing");
    assert_true(n_reports >= 3);
    stop = 0;
    run = (sn_run){.deadline = sn_clock() - 1.0};
    expect_error(p, &run, SN_ELIMIT, "time limit reached while polygonizing");
}

/* Fails one allocation of many, and counts what is in use. */
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

static void every_allocation_may_fail(void **state)
{
    (void)state;
    double s[4] = {0, 0, 0, 1};
    sn_polygonize p = {sphere, s, cube(1.0), 0.3, true};
    sn_run run = {.n_threads = 1};
    sn_status st = SN_ENOMEM;
    int n = 0;
    for (; st; n++) {
        budget b = {n, 0};
        sn_tri_mesh m;
        sn_error err;
        sn_tri_mesh_init(&m);
        sn_set_allocator(&(sn_allocator){rationed, &b});
        st = sn_polygonize_run(&p, &run, &m, &err);
        if (st) {
            assert_int_equal(st, SN_ENOMEM);
            assert_non_null(strstr(err.msg, "no memory"));
            assert_null(m.pos);
            assert_int_equal(b.in_use, 0);
        }
        sn_tri_mesh_free(&m);
        assert_int_equal(b.in_use, 0);
    }
    sn_set_allocator(NULL);
    assert_true(n > 8);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sphere_converges_at_second_order),
        cmocka_unit_test(most_vertices_lie_on_the_surface),
        cmocka_unit_test(torus_has_genus_one),
        cmocka_unit_test(two_spheres_are_two_parts),
        cmocka_unit_test(sphere_through_lattice_points),
        cmocka_unit_test(box_aligned_with_the_lattice),
        cmocka_unit_test(lone_zero),
        cmocka_unit_test(any_signs_give_a_manifold),
        cmocka_unit_test(no_faces),
        cmocka_unit_test(inside_is_cut_off_at_the_box),
        cmocka_unit_test(skipping_changes_nothing),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(scaled_by_two_is_the_same),
        cmocka_unit_test(errors),
        cmocka_unit_test(smallest_cell),
        cmocka_unit_test(interruption),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
