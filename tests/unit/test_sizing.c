/* test_sizing - lengths on a lattice: sites, growth, other units, refused input; surfaces remeshed by one. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "mesh/remesh.h"
#include "mesh/sizing.h"

#include "made_mesh.h"

static const sn_box3 unit_box = {{0, 0, 0}, {1, 1, 1}};

static sn_sizing made(double cell, double longest)
{
    sn_sizing s = {.length = NULL};
    sn_error err = {.msg = ""};
    if (sn_sizing_create(&s, unit_box, cell, longest, &err)) fail_msg("%s", err.msg);
    return s;
}

static sn_vec3 random_point(uint64_t *seed)
{
    double x = made_random(seed), y = made_random(seed);
    return sn_v3(x, y, made_random(seed));
}

/* From one site: between growth x distance and 8 % more of it, up to the cells that both ends are rounded to.
 */
static void grows_with_the_distance(void **state)
{
    (void)state;
    const double cell = 0.02, growth = 0.5;
    uint64_t seed = 5;
    sn_vec3 site = sn_v3(0.3, 0.6, 0.2);
    sn_sizing s = made(cell, 0.3);
    sn_sizing_add(&s, site, 0.01);
    sn_sizing_add(&s, site, 0.05); /* longer: no effect */
    sn_sizing_spread(&s, 0, growth);
    assert_true(fabs(sn_sizing_at(&s, site) - 0.01) < 1e-8);
    for (int i = 0; i < 20000; i++) {
        sn_vec3 p = random_point(&seed);
        double d = sn_v3_dist(p, site), at = sn_sizing_at(&s, p), slack = 2.0 * cell;
        assert_true(at <= fmin(0.3, 0.01 + 1.09 * growth * (d + slack)) + 1e-7);
        assert_true(at >= fmin(0.3, 0.01 + growth * (d - slack)) - 1e-7);
    }
    sn_sizing_free(&s);
    assert_null(s.length);
}

/* Many sites: as the least over each of them alone. */
static void the_finest_site_wins(void **state)
{
    (void)state;
    uint64_t seed = 11;
    sn_sizing all = made(0.05, 0.5), one[6];
    for (int i = 0; i < 6; i++) {
        sn_vec3 p = random_point(&seed);
        double length = 0.02 + 0.1 * made_random(&seed);
        one[i] = made(0.05, 0.5);
        sn_sizing_add(&one[i], p, length);
        sn_sizing_add(&all, p, length);
        sn_sizing_spread(&one[i], 1, 0.7);
    }
    sn_sizing_spread(&all, 1, 0.7);
    for (int i = 0; i < 5000; i++) {
        sn_vec3 p = random_point(&seed);
        double least = 0.5;
        for (int k = 0; k < 6; k++) least = fmin(least, sn_sizing_at(&one[k], p));
        assert_true(fabs(sn_sizing_at(&all, p) - least) < 1e-6);
    }
    sn_sizing_free(&all);
    for (int k = 0; k < 6; k++) sn_sizing_free(&one[k]);
}

static void a_band_stays_fine(void **state)
{
    (void)state;
    sn_sizing s = made(0.05, 0.5);
    sn_vec3 site = sn_v3(0.5, 0.5, 0.5);
    sn_sizing_add(&s, site, 0.1);
    sn_sizing_spread(&s, 2, 1.0);
    for (int k = -2; k <= 2; k++) {
        assert_true(fabs(sn_sizing_at(&s, sn_v3(0.5 + 0.05 * k, 0.5, 0.5)) - 0.1) < 1e-7);
        assert_true(fabs(sn_sizing_at(&s, sn_v3(0.5, 0.5 - 0.05 * k, 0.5 + 0.05 * k)) - 0.1) < 1e-7);
    }
    assert_true(fabs(sn_sizing_at(&s, sn_v3(0.65, 0.5, 0.5)) - 0.15) < 1e-6);
    sn_sizing_free(&s);
}

/* No place of a triangle or piece is missed; another sizing gives the lengths. */
static void triangles_and_pieces_are_covered(void **state)
{
    (void)state;
    uint64_t seed = 3;
    sn_sizing usual = made(0.01, 0.2), s = made(0.01, 0.5);
    sn_sizing_add(&usual, sn_v3(0.1, 0.1, 0.1), 0.02);
    sn_sizing_spread(&usual, 0, 0.5);
    sn_vec3 a = sn_v3(0.1, 0.1, 0.1), b = sn_v3(0.93, 0.21, 0.4), c = sn_v3(0.3, 0.87, 0.77);
    sn_sizing_add_triangle(&s, a, b, c, &usual, 0.5);
    sn_sizing_add_piece(&s, sn_v3(0, 1, 0), sn_v3(1, 1, 1), NULL, 0.03);
    int n_off = 0; /* corners of cells between two samples */
    for (int i = 0; i < 5000; i++) {
        double u = made_random(&seed), v = made_random(&seed), t = made_random(&seed);
        if (u + v > 1.0) continue;
        sn_vec3 p = sn_v3_mad(sn_v3_mad(a, u, sn_v3_sub(b, a)), v, sn_v3_sub(c, a));
        sn_vec3 corner = sn_v3(0.005, 0.005, 0.005);
        double here = sn_sizing_at(&s, p), near = sn_sizing_at(&s, sn_v3_add(p, corner));
        assert_true(fmin(here, near) <= 0.5 * sn_sizing_at(&usual, p) + 0.5 * 0.5 * 0.02);
        n_off += sn_sizing_at(&s, sn_v3(t, 1, t)) > 0.03 + 1e-7;
    }
    assert_true(n_off < 250);
    assert_true(fabs(sn_sizing_at(&s, sn_v3(0.5, 0.5, 0.0)) - 0.5) < 1e-7);
    sn_sizing_free(&usual);
    sn_sizing_free(&s);
}

static void moved_to_another_box(void **state)
{
    (void)state;
    uint64_t seed = 17;
    sn_sizing s = made(0.03, 0.4);
    sn_sizing_add(&s, sn_v3(0.2, 0.9, 0.4), 0.05);
    sn_sizing_spread(&s, 1, 0.6);
    sn_vec3 origin = sn_v3(-3, 2, 5);
    sn_sizing in_mm = sn_sizing_moved(&s, origin, 1e-3),
              back = sn_sizing_moved(&in_mm, sn_v3(3e3, -2e3, -5e3), 1e3);
    int n_off = 0;
    for (int i = 0; i < 2000; i++) { /* but for places within a rounding of a cell's face */
        sn_vec3 p = random_point(&seed), q = sn_v3_scale(1e3, sn_v3_sub(p, origin));
        n_off += fabs(sn_sizing_at(&in_mm, q) - 1e3 * sn_sizing_at(&s, p)) > 1e-9;
        n_off += fabs(sn_sizing_at(&back, p) - sn_sizing_at(&s, p)) > 1e-12;
    }
    assert_int_equal(n_off, 0);
    sn_sizing_free(&s);
}

static void places_outside_take_the_nearest_cell(void **state)
{
    (void)state;
    sn_sizing s = made(0.1, 0.4);
    sn_sizing_add(&s, sn_v3(-50, -50, -50), 0.1);
    assert_true(fabs(sn_sizing_at(&s, sn_v3(-1e300, 0, 0)) - 0.1) < 1e-7);
    assert_true(fabs(sn_sizing_at(&s, sn_v3(1e300, 1e300, 1e300)) - 0.4) < 1e-7);
    sn_sizing_free(&s);
}

static void a_lattice_stays_small(void **state)
{
    (void)state;
    sn_sizing s = made(1e-9, 0.4);
    assert_true((size_t)s.n[0] * (size_t)s.n[1] * (size_t)s.n[2] <= SN_SIZING_MAX_CELLS);
    assert_true(s.cell < 0.01);
    sn_sizing_free(&s);
}

static void refused(void **state)
{
    (void)state;
    sn_sizing s = {.length = NULL};
    sn_error err = {.msg = ""};
    const struct {
        sn_box3 box;
        double cell, longest;
    } bad[] = {{unit_box, 0.0, 1.0},
               {unit_box, NAN, 1.0},
               {unit_box, 0.1, -1.0},
               {unit_box, 0.1, INFINITY},
               {{{1, 0, 0}, {0, 1, 1}}, 0.1, 1.0},
               {{{0, 0, 0}, {INFINITY, 1, 1}}, 0.1, 1.0}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(sn_sizing_create(&s, bad[i].box, bad[i].cell, bad[i].longest, &err), SN_EINVAL);
        assert_non_null(strstr(err.msg, "sizing: needs a box"));
        assert_null(s.length);
    }
}

/* ---- remeshing ---- */

static void edge_range(const sn_tri_mesh *m, bool above, double *mean)
{
    double sum = 0.0;
    int n = 0;
    for (int32_t h = 0; h < 3 * m->n_face; h++) {
        sn_vec3 p = sn_tri_mesh_point(m, m->face[h]),
                q = sn_tri_mesh_point(m, m->face[h % 3 == 2 ? h - 2 : h + 1]);
        if (above != (p.z + q.z > 1.2) || fabs(p.z + q.z - 1.2) < 0.5) continue;
        sum += sn_v3_dist(p, q);
        n++;
    }
    assert_true(n > 20);
    *mean = sum / n;
}

/* A capsule that is fine at its upper end: three times longer edges at the lower one, and no further from it.
 */
static void remeshed_by_a_sizing(void **state)
{
    (void)state;
    sn_tri_mesh in = made_capsule(sn_v3(0.5, 0.5, 0.2), sn_v3(0.5, 0.5, 0.9), 0.2, 0.02), out, even;
    sn_sizing s = made(0.02, 0.2);
    sn_error err = {.msg = ""};
    sn_remesh_report r = {0};
    sn_tri_mesh_init(&out);
    sn_tri_mesh_init(&even);
    sn_sizing_add(&s, sn_v3(0.5, 0.5, 1.0), 0.01);
    sn_sizing_spread(&s, 5, 0.3);
    sn_remesh opt = {.edge_length = 0.03, .sizing = &s, .coarsest = 3.0};
    if (sn_remesh_run(&in, &opt, NULL, &out, &r, &err)) fail_msg("%s", err.msg);
    assert_int_equal(r.crossings_after, 0);
    assert_true(r.largest_move < 0.08 * 3.0 * 0.03);
    double fine, coarse;
    edge_range(&out, true, &fine);
    edge_range(&out, false, &coarse);
    assert_true(fine > 0.02 && fine < 0.05);
    assert_true(coarse > 0.05 && coarse < 0.12);
    opt.sizing = NULL;
    if (sn_remesh_run(&in, &opt, NULL, &even, &r, &err)) fail_msg("%s", err.msg);
    assert_true(out.n_face < even.n_face);
    opt.sizing = &s;
    opt.coarsest = 0.5;
    assert_int_equal(sn_remesh_run(&in, &opt, NULL, &even, &r, &err), SN_EINVAL);
    assert_string_equal(err.msg, "remesh: coarsest is 0.5, need >= 1");
    sn_sizing_free(&s);
    sn_tri_mesh_free(&in);
    sn_tri_mesh_free(&out);
    sn_tri_mesh_free(&even);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(grows_with_the_distance), cmocka_unit_test(the_finest_site_wins),
        cmocka_unit_test(a_band_stays_fine),       cmocka_unit_test(triangles_and_pieces_are_covered),
        cmocka_unit_test(moved_to_another_box),    cmocka_unit_test(places_outside_take_the_nearest_cell),
        cmocka_unit_test(a_lattice_stays_small),   cmocka_unit_test(refused),
        cmocka_unit_test(remeshed_by_a_sizing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
