/* test_affine - maps of points: what each does, how they combine, and what they do to a surface. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "made_mesh.h"
#include "mesh/affine.h"

static void assert_at(sn_vec3 p, sn_vec3 want, double tolerance)
{
    double d = sn_v3_dist(p, want);
    if (!(d <= tolerance))
        fail_msg("(%.17g, %.17g, %.17g) is not (%.17g, %.17g, %.17g) to %g", p.x, p.y, p.z, want.x, want.y,
                 want.z, tolerance);
}

static void assert_map_is(const sn_affine *a, const sn_affine *b, double tolerance)
{
    for (int k = 0; k < 3; k++) assert_at(a->col[k], b->col[k], tolerance);
    assert_at(a->t, b->t, tolerance);
}

static sn_vec3 random_point(uint64_t *h)
{
    double p[3];
    for (int k = 0; k < 3; k++) p[k] = 4.0 * made_random(h) - 2.0;
    return sn_v3_load(p);
}

/* Rotated, stretched, sheared, moved. */
static sn_affine random_map(uint64_t *h)
{
    sn_affine a = {.t = random_point(h)};
    do
        for (int k = 0; k < 3; k++) a.col[k] = random_point(h);
    while (!(fabs(sn_affine_det(&a)) > 0.1));
    return a;
}

/* ---- what each does ---- */

static void maps_do_what_they_say(void **state)
{
    (void)state;
    sn_vec3 p = {3, -4, 5}, about = {1, 2, 3};
    sn_affine a = sn_affine_identity();
    assert_at(sn_affine_point(&a, p), p, 0.0);
    a = sn_affine_translation(sn_v3(0.5, 0, -1));
    assert_at(sn_affine_point(&a, p), sn_v3(3.5, -4, 4), 0.0);
    assert_at(sn_affine_vector(&a, p), p, 0.0);
    a = sn_affine_scale(2.0, about);
    assert_at(sn_affine_point(&a, about), about, 0.0);
    assert_at(sn_affine_point(&a, p), sn_v3(5, -10, 7), 1e-14);
    a = sn_affine_rotation(sn_v3(0, 0, 7), 90.0, sn_v3(0, 0, 0)); /* x to y to -x */
    assert_at(sn_affine_point(&a, p), sn_v3(4, 3, 5), 1e-14);
    a = sn_affine_rotation(sn_v3(0, 1, 0), 180.0, about);
    assert_at(sn_affine_point(&a, p), sn_v3(-1, -4, 1), 1e-14);
    a = sn_affine_mirror(sn_v3(1, 9, 9), sn_v3(-3, 0, 0));
    assert_at(sn_affine_point(&a, p), sn_v3(-1, -4, 5), 1e-14);
    a = sn_affine_mirror(sn_v3(0, 0, 0), sn_v3(1, 1, 0));
    assert_at(sn_affine_point(&a, p), sn_v3(4, -3, 5), 1e-14);
}

static void determinants(void **state)
{
    (void)state;
    sn_affine a = sn_affine_scale(3.0, sn_v3(1, 1, 1));
    assert_true(fabs(sn_affine_det(&a) - 27.0) < 1e-13);
    a = sn_affine_rotation(sn_v3(1, 2, 3), 123.0, sn_v3(1, 1, 1));
    assert_true(fabs(sn_affine_det(&a) - 1.0) < 1e-14);
    a = sn_affine_mirror(sn_v3(1, 1, 1), sn_v3(1, 2, 3));
    assert_true(fabs(sn_affine_det(&a) + 1.0) < 1e-14);
    uint64_t h = 3;
    for (int i = 0; i < 100; i++) { /* of a product: the product */
        sn_affine f = random_map(&h), g = random_map(&h), both = sn_affine_after(f, g);
        double want = sn_affine_det(&f) * sn_affine_det(&g);
        assert_true(fabs(sn_affine_det(&both) - want) < 1e-12 * (1.0 + fabs(want)));
    }
}

/* ---- how they combine ---- */

static void the_second_comes_after_the_first(void **state)
{
    (void)state;
    uint64_t h = 11;
    for (int i = 0; i < 200; i++) {
        sn_affine f = random_map(&h), g = random_map(&h), both = sn_affine_after(f, g);
        sn_vec3 p = random_point(&h), q = random_point(&h), once = sn_affine_point(&g, p);
        assert_at(sn_affine_point(&both, p), sn_affine_point(&f, once), 1e-12);
        /* vectors: differences of points */
        assert_at(sn_affine_vector(&f, sn_v3_sub(p, q)),
                  sn_v3_sub(sn_affine_point(&f, p), sn_affine_point(&f, q)), 1e-12);
    }
}

static void each_has_its_inverse(void **state)
{
    (void)state;
    sn_affine same = sn_affine_identity();
    uint64_t h = 21;
    for (int i = 0; i < 100; i++) {
        sn_vec3 axis = random_point(&h), about = random_point(&h);
        double angle = 720.0 * made_random(&h) - 360.0, k = 0.1 + made_random(&h);
        sn_affine there = sn_affine_rotation(axis, angle, about),
                  back = sn_affine_rotation(sn_v3_scale(-0.01, axis), angle, about);
        sn_affine both = sn_affine_after(back, there);
        assert_map_is(&both, &same, 1e-13);
        assert_at(sn_affine_point(&there, about), about, 1e-14);
        assert_at(sn_affine_vector(&there, axis), axis, 1e-14);
        both = sn_affine_after(sn_affine_scale(1.0 / k, about), sn_affine_scale(k, about));
        assert_map_is(&both, &same, 1e-13);
        both = sn_affine_after(sn_affine_mirror(about, axis), sn_affine_mirror(about, axis));
        assert_map_is(&both, &same, 1e-13);
        both = sn_affine_after(sn_affine_translation(sn_v3_scale(-1, axis)), sn_affine_translation(axis));
        assert_map_is(&both, &same, 0.0);
    }
}

static void mirrors_keep_their_plane_and_turn_its_normal(void **state)
{
    (void)state;
    uint64_t h = 31;
    for (int i = 0; i < 100; i++) {
        sn_vec3 point = random_point(&h), normal = random_point(&h), p = random_point(&h);
        sn_affine a = sn_affine_mirror(point, normal);
        sn_vec3 q = sn_affine_point(&a, p), middle = sn_v3_lerp(p, q, 0.5), n = sn_v3_unit(normal);
        assert_true(fabs(sn_v3_dot(sn_v3_sub(middle, point), n)) < 1e-14); /* halfway: the plane */
        assert_true(sn_v3_len(sn_v3_cross(sn_v3_sub(q, p), n)) < 1e-14);   /* straight across    */
        assert_at(sn_affine_vector(&a, normal), sn_v3_scale(-1.0, normal), 1e-14);
    }
}

/* ---- surfaces ---- */

static void outside_stays_outside(void **state)
{
    (void)state;
    uint64_t h = 41;
    int n_reflecting = 0;
    for (int i = 0; i < 40; i++) {
        sn_affine a = random_map(&h);
        sn_tri_mesh m = made_box(sn_v3(-1, 0, 2), sn_v3(1, 3, 2.5)),
                    before = made_box(sn_v3(-1, 0, 2), sn_v3(1, 3, 2.5));
        sn_affine_mesh(&a, &m);
        assert_true(fabs(sn_tri_mesh_volume(&m) - 3.0 * fabs(sn_affine_det(&a))) < 1e-11);
        for (int v = 0; v < 8; v++)
            assert_at(sn_tri_mesh_point(&m, v), sn_affine_point(&a, sn_tri_mesh_point(&before, v)), 0.0);
        bool is_turned = memcmp(m.face, before.face, 36 * sizeof *m.face) != 0;
        assert_int_equal(is_turned, sn_affine_det(&a) < 0.0);
        n_reflecting += is_turned;
        sn_tri_mesh_free(&m);
        sn_tri_mesh_free(&before);
    }
    assert_true(n_reflecting > 5 && n_reflecting < 35);
    sn_tri_mesh none;
    sn_tri_mesh_init(&none);
    sn_affine a = sn_affine_mirror(sn_v3(0, 0, 0), sn_v3(1, 0, 0));
    sn_affine_mesh(&a, &none);
    assert_int_equal(none.n_vert, 0);
}

/* Across a coordinate axis through zero: coordinates change their sign and nothing else. */
static void mirrors_across_an_axis_are_exact(void **state)
{
    (void)state;
    sn_tri_mesh m = made_sphere(sn_v3(0.1, 0.2, 0.3), 0.77, 0.3), twice;
    sn_tri_mesh_init(&twice);
    assert_int_equal(sn_tri_mesh_copy(&twice, &m, NULL), SN_OK);
    sn_affine a = sn_affine_mirror(sn_v3(0, 5, 5), sn_v3(2, 0, 0));
    sn_affine_mesh(&a, &twice);
    for (int32_t v = 0; v < m.n_vert; v++) {
        sn_vec3 p = sn_tri_mesh_point(&m, v);
        assert_at(sn_tri_mesh_point(&twice, v), sn_v3(-p.x, p.y, p.z), 0.0);
    }
    sn_affine_mesh(&a, &twice);
    assert_memory_equal(twice.pos, m.pos, 3 * (size_t)m.n_vert * sizeof *m.pos);
    assert_memory_equal(twice.face, m.face, 3 * (size_t)m.n_face * sizeof *m.face);
    sn_tri_mesh_free(&m);
    sn_tri_mesh_free(&twice);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(maps_do_what_they_say),
        cmocka_unit_test(determinants),
        cmocka_unit_test(the_second_comes_after_the_first),
        cmocka_unit_test(each_has_its_inverse),
        cmocka_unit_test(mirrors_keep_their_plane_and_turn_its_normal),
        cmocka_unit_test(outside_stays_outside),
        cmocka_unit_test(mirrors_across_an_axis_are_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
