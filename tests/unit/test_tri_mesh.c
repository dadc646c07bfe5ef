/* test_tri_mesh - triangle surfaces as plain arrays: checks, sizes, moving, welding. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "mesh/tri_mesh.h"

#include "closed_surface.h"
#include "made_mesh.h"

static sn_tri_mesh unit_box(void)
{
    return made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1));
}

static void assert_point(sn_vec3 p, double x, double y, double z)
{
    assert_true(fabs(p.x - x) < 1e-12 && fabs(p.y - y) < 1e-12 && fabs(p.z - z) < 1e-12);
}

static void box_sizes(void **state)
{
    (void)state;
    sn_tri_mesh m = made_box(sn_v3(1, 2, 3), sn_v3(3, 5, 4)); /* 2 x 3 x 1 */
    assert_closed_manifold(&m);
    assert_true(fabs(sn_tri_mesh_volume(&m) - 6.0) < 1e-12);
    assert_true(fabs(sn_tri_mesh_area(&m) - 22.0) < 1e-12); /* 2 (6 + 2 + 3) */
    sn_box3 b = sn_tri_mesh_bounds(&m);
    assert_point(b.min, 1, 2, 3);
    assert_point(b.max, 3, 5, 4);
    assert_point(sn_tri_mesh_face_normal(&m, 0), 0, 0, -6); /* bottom: 2 x 3, twice the area of its half */
    turn_faces(&m);
    assert_true(fabs(sn_tri_mesh_volume(&m) + 6.0) < 1e-12);
    sn_tri_mesh_free(&m);
}

static void volume_far_from_the_origin(void **state)
{
    (void)state;
    sn_tri_mesh m = unit_box();
    for (size_t k = 0; k < 24; k++) m.pos[k] += 1048576.0; /* exact: 2^20 */
    assert_true(fabs(sn_tri_mesh_volume(&m) - 1.0) < 1e-12);
    sn_tri_mesh_free(&m);
}

static void nothing_is_harmless(void **state)
{
    (void)state;
    sn_tri_mesh m;
    sn_error err;
    sn_tri_mesh_init(&m);
    sn_tri_mesh_free(&m);
    sn_tri_mesh_free(&m);
    assert_true(sn_box3_is_empty(sn_tri_mesh_bounds(&m)));
    assert_true(sn_box3_diagonal(sn_tri_mesh_bounds(&m)) == 0.0);
    assert_true(sn_tri_mesh_volume(&m) == 0.0 && sn_tri_mesh_area(&m) == 0.0);
    int32_t joined = 9;
    assert_int_equal(sn_tri_mesh_weld(&m, &joined, &err), SN_OK);
    assert_int_equal(joined, 0);
    assert_int_equal(sn_tri_mesh_validate(&m, &err), SN_EINVAL);
    assert_string_equal(err.msg, "surface has no faces");
}

static void copies_are_deep(void **state)
{
    (void)state;
    sn_tri_mesh m = unit_box(), c;
    sn_tri_mesh_init(&c);
    assert_int_equal(sn_tri_mesh_copy(&c, &m, NULL), SN_OK);
    assert_null(c.label);
    m.label = SN_NEW(int32_t, 12);
    for (int f = 0; f < 12; f++) m.label[f] = f / 2;
    assert_int_equal(sn_tri_mesh_copy(&c, &m, NULL), SN_OK); /* over the earlier copy */
    m.pos[0] = 5.0;
    m.face[0] = 3;
    m.label[11] = 77;
    assert_true(c.pos[0] == 0.0);
    assert_int_equal(c.face[0], 0);
    assert_int_equal(c.label[11], 5);
    assert_int_equal(c.n_vert, 8);
    assert_int_equal(c.n_face, 12);
    sn_tri_mesh_free(&m);
    sn_tri_mesh_free(&c);
}

static void assert_invalid(const sn_tri_mesh *m, const char *want)
{
    sn_error err;
    assert_int_equal(sn_tri_mesh_validate(m, &err), SN_EINVAL);
    assert_string_equal(err.msg, want);
}

static void validation_names_the_first_breach(void **state)
{
    (void)state;
    sn_tri_mesh m = unit_box();
    assert_int_equal(sn_tri_mesh_validate(&m, NULL), SN_OK);
    m.face[35] = 8;
    assert_invalid(&m, "face 12 names vertex 9, need 1..8");
    m.face[4] = INT32_MAX;
    assert_invalid(&m, "face 2 names vertex 2147483648, need 1..8");
    m.face[0] = -1;
    assert_invalid(&m, "face 1 names vertex 0, need 1..8");
    m.pos[23] = INFINITY;
    assert_invalid(&m, "vertex 8 has a coordinate that is not finite");
    m.pos[3] = NAN;
    assert_invalid(&m, "vertex 2 has a coordinate that is not finite");
    sn_tri_mesh_free(&m);
}

/* ---- moving ---- */

static void transform_scales_turns_then_moves(void **state)
{
    (void)state;
    sn_tri_mesh m = unit_box();
    /* Vertex 1 = (1, 0, 0): by 2 to (2, 0, 0), by 90 degrees about z to (0, 2, 0), then moved. */
    sn_transform t = {2.0, {0, 0, 5}, 90.0, {10, 20, 30}};
    assert_int_equal(sn_tri_mesh_transform(&m, &t, NULL), SN_OK);
    assert_point(sn_tri_mesh_point(&m, 0), 10, 20, 30);
    assert_point(sn_tri_mesh_point(&m, 1), 10, 22, 30);
    assert_point(sn_tri_mesh_point(&m, 6), 8, 22, 32); /* (1, 1, 1) -> (-2, 2, 2) */
    assert_true(fabs(sn_tri_mesh_volume(&m) - 8.0) < 1e-12);
    sn_tri_mesh_free(&m);
}

static void turn_about_the_diagonal_cycles_the_axes(void **state)
{
    (void)state;
    sn_tri_mesh m = unit_box();
    sn_transform t = {1.0, {1, 1, 1}, 120.0, {0, 0, 0}};
    assert_int_equal(sn_tri_mesh_transform(&m, &t, NULL), SN_OK);
    assert_point(sn_tri_mesh_point(&m, 1), 0, 1, 0); /* x -> y -> z -> x */
    assert_point(sn_tri_mesh_point(&m, 3), 0, 0, 1);
    assert_point(sn_tri_mesh_point(&m, 4), 1, 0, 0);
    assert_point(sn_tri_mesh_point(&m, 6), 1, 1, 1);
    sn_tri_mesh_free(&m);
}

static void no_axis_no_turn(void **state)
{
    (void)state;
    sn_tri_mesh m = unit_box(), same = unit_box();
    sn_transform t = {1.0, {0, 0, 0}, 77.0, {0, 0, 0}};
    assert_int_equal(sn_tri_mesh_transform(&m, &t, NULL), SN_OK);
    assert_memory_equal(m.pos, same.pos, 24 * sizeof *m.pos);
    t = (sn_transform){1.0, {1, 2, 3}, 0.0, {0, 0, 0}};
    assert_int_equal(sn_tri_mesh_transform(&m, &t, NULL), SN_OK);
    assert_memory_equal(m.pos, same.pos, 24 * sizeof *m.pos);
    sn_tri_mesh_free(&m);
    sn_tri_mesh_free(&same);
}

static void bad_transforms_change_nothing(void **state)
{
    (void)state;
    sn_tri_mesh m = unit_box(), same = unit_box();
    sn_error err;
    const double scales[] = {0.0, -1.0, NAN, INFINITY};
    const char *const want[] = {"transform: scale is 0, need > 0", "transform: scale is -1, need > 0", NULL,
                                "transform: scale is inf, need > 0"};
    for (int i = 0; i < 4; i++) {
        sn_transform t = {scales[i], {0, 0, 1}, 10.0, {0, 0, 0}};
        assert_int_equal(sn_tri_mesh_transform(&m, &t, &err), SN_EINVAL);
        if (want[i]) assert_string_equal(err.msg, want[i]);
    }
    const sn_transform bad[] = {{1.0, {0, NAN, 1}, 10.0, {0, 0, 0}},
                                {1.0, {0, 0, 1}, INFINITY, {0, 0, 0}},
                                {1.0, {0, 0, 1}, 10.0, {0, 0, -INFINITY}}};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(sn_tri_mesh_transform(&m, &bad[i], &err), SN_EINVAL);
        assert_string_equal(err.msg, "transform: axis, angle or translation is not finite");
    }
    const sn_vec3 zero = {0, 0, 0}, one = {1, 0, 0}, nan = {NAN, 0, 0};
    const sn_vec3 planes[][2] = {{zero, zero}, {nan, one}, {zero, nan}};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(sn_tri_mesh_mirror(&m, planes[i][0], planes[i][1], &err), SN_EINVAL);
        assert_string_equal(err.msg, "mirror: the plane needs a finite point and a normal that is not zero");
    }
    assert_memory_equal(m.pos, same.pos, 24 * sizeof *m.pos);
    assert_memory_equal(m.face, same.face, 36 * sizeof *m.face);
    sn_tri_mesh_free(&m);
    sn_tri_mesh_free(&same);
}

static void mirror_keeps_the_outside_out(void **state)
{
    (void)state;
    sn_tri_mesh m = made_box(sn_v3(1, 0, 0), sn_v3(2, 1, 3));
    assert_int_equal(sn_tri_mesh_mirror(&m, sn_v3(0.5, 9, 9), sn_v3(-3, 0, 0), NULL), SN_OK);
    sn_box3 b = sn_tri_mesh_bounds(&m);
    assert_point(b.min, -1, 0, 0); /* x -> 1 - x */
    assert_point(b.max, 0, 1, 3);
    assert_true(fabs(sn_tri_mesh_volume(&m) - 3.0) < 1e-12);
    assert_closed_manifold(&m);
    assert_int_equal(sn_tri_mesh_mirror(&m, sn_v3(0.5, 9, 9), sn_v3(1, 0, 0), NULL), SN_OK);
    assert_point(sn_tri_mesh_point(&m, 0), 1, 0, 0);
    sn_tri_mesh_free(&m);
}

/* ---- welding ---- */

/* Each face with corners of its own, as in an STL file. */
static sn_tri_mesh soup(const sn_tri_mesh *m)
{
    sn_tri_mesh s;
    sn_tri_mesh_init(&s);
    assert_int_equal(sn_tri_mesh_reserve(&s, 3 * m->n_face, m->n_face, NULL), SN_OK);
    for (int32_t k = 0; k < s.n_vert; k++) {
        sn_v3_store(s.pos + 3 * (size_t)k, sn_tri_mesh_point(m, m->face[k]));
        s.face[k] = k;
    }
    return s;
}

static void welding_undoes_a_soup(void **state)
{
    (void)state;
    sn_tri_mesh m = unit_box(), s = soup(&m);
    int32_t joined = 0;
    assert_int_equal(sn_tri_mesh_weld(&s, &joined, NULL), SN_OK);
    assert_int_equal(joined, 28);
    assert_int_equal(s.n_vert, 8);
    assert_closed_manifold(&s);
    assert_true(fabs(sn_tri_mesh_volume(&s) - 1.0) < 1e-12);
    for (int k = 0; k < 36; k++) /* every corner stays where it was */
        assert_true(sn_v3_dist(sn_tri_mesh_point(&s, s.face[k]), sn_tri_mesh_point(&m, m.face[k])) == 0.0);
    assert_point(sn_tri_mesh_point(&s, 0), 0, 0, 0); /* in the order of first use: face 0 is 0, 2, 1 */
    assert_point(sn_tri_mesh_point(&s, 1), 1, 1, 0);
    assert_point(sn_tri_mesh_point(&s, 2), 1, 0, 0);
    assert_int_equal(sn_tri_mesh_weld(&s, &joined, NULL), SN_OK);
    assert_int_equal(joined, 0);
    sn_tri_mesh_free(&m);
    sn_tri_mesh_free(&s);
}

static void welding_is_by_bits_but_for_zero(void **state)
{
    (void)state;
    const double pos[] = {0.0, 1, 1, -0.0, 1, 1, 0.0, 1 + 1e-15, 1, 7, 7, 7, 0.0, 1, 1};
    const int32_t face[] = {0, 2, 3, 1, 3, 4, 4, 1, 2};
    sn_tri_mesh m;
    sn_tri_mesh_init(&m);
    assert_int_equal(sn_tri_mesh_reserve(&m, 5, 3, NULL), SN_OK);
    memcpy(m.pos, pos, sizeof pos);
    memcpy(m.face, face, sizeof face);
    int32_t joined;
    assert_int_equal(sn_tri_mesh_weld(&m, &joined, NULL), SN_OK);
    assert_int_equal(joined, 2); /* vertices 1 and 4 into 0 */
    const int32_t want[] = {0, 1, 2, 0, 2, 0, 0, 0, 1};
    assert_memory_equal(m.face, want, sizeof want);
    assert_true(m.pos[4] == 1 + 1e-15 && m.pos[6] == 7.0);
    sn_tri_mesh_free(&m);
}

static void many_vertices_weld_as_by_brute_force(void **state)
{
    (void)state;
    enum { N = 600 };
    sn_tri_mesh m;
    uint64_t h = 3;
    int32_t first[N], number[N], n = 0, joined;
    double pos[3 * N];
    sn_tri_mesh_init(&m);
    assert_int_equal(sn_tri_mesh_reserve(&m, N, N / 3, NULL), SN_OK);
    for (int k = 0; k < 3 * N; k++) m.pos[k] = pos[k] = floor(7.0 * made_random(&h)) - 3.0;
    for (int k = 0; k < N; k++) m.face[k] = k;
    for (int i = 0; i < N; i++) {
        for (first[i] = 0; memcmp(pos + 3 * first[i], pos + 3 * i, 24) != 0; first[i]++) {}
        number[i] = first[i] == i ? n++ : number[first[i]];
    }
    assert_int_equal(sn_tri_mesh_weld(&m, &joined, NULL), SN_OK);
    assert_int_equal(m.n_vert, n);
    assert_int_equal(joined, N - n);
    for (int i = 0; i < N; i++) {
        assert_int_equal(m.face[i], number[i]);
        assert_memory_equal(m.pos + 3 * number[i], pos + 3 * i, 24);
    }
    sn_tri_mesh_free(&m);
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    sn_tri_mesh box = unit_box(), s = soup(&box);
    sn_status st = SN_ENOMEM;
    box.label = SN_NEW_ZERO(int32_t, 12);
    for (int n = 0; st; n++) {
        ration r = {n, 0};
        sn_tri_mesh copy;
        sn_error err;
        sn_tri_mesh_init(&copy);
        sn_set_allocator(RATION(r));
        st = sn_tri_mesh_copy(&copy, &box, &err);
        if (st) assert_true(copy.n_vert == 0 && !copy.pos && !copy.label);
        if (!st) st = sn_tri_mesh_weld(&s, NULL, &err);
        if (st) assert_int_equal(err.code, SN_ENOMEM);
        if (st) assert_non_null(strstr(err.msg, "no memory for"));
        if (st) assert_int_equal(s.n_vert, 36);
        sn_tri_mesh_free(&copy);
        assert_int_equal(r.in_use, 0);
        assert_true(n < 10);
    }
    sn_set_allocator(NULL);
    assert_int_equal(s.n_vert, 8);
    sn_tri_mesh_free(&box);
    sn_tri_mesh_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(box_sizes),
        cmocka_unit_test(volume_far_from_the_origin),
        cmocka_unit_test(nothing_is_harmless),
        cmocka_unit_test(copies_are_deep),
        cmocka_unit_test(validation_names_the_first_breach),
        cmocka_unit_test(transform_scales_turns_then_moves),
        cmocka_unit_test(turn_about_the_diagonal_cycles_the_axes),
        cmocka_unit_test(no_axis_no_turn),
        cmocka_unit_test(bad_transforms_change_nothing),
        cmocka_unit_test(mirror_keeps_the_outside_out),
        cmocka_unit_test(welding_undoes_a_soup),
        cmocka_unit_test(welding_is_by_bits_but_for_zero),
        cmocka_unit_test(many_vertices_weld_as_by_brute_force),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
