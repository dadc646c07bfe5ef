/* test_icp_rigid - a piece of a surface moved onto the surface it is from, and what else can happen. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "skeleton/icp_rigid.h"

#include "made_template.h"

static const sn_transform nowhere = {.scale = 1.0};
static sn_icp_report report; /* large */

static sn_bvh *bvh_of(const sn_tri_mesh *m)
{
    sn_bvh *b;
    assert_int_equal(sn_bvh_create(&b, m, NULL), SN_OK);
    return b;
}

static sn_transform find(const sn_tri_mesh *piece, const sn_tri_mesh *target, const sn_transform *start,
                         const sn_icp_options *o, bool with_scale, const sn_run *run)
{
    sn_error err = {.msg = ""};
    sn_transform out = nowhere;
    sn_bvh *b = bvh_of(target);
    if (sn_icp_rigid_run(piece, b, start, o, with_scale, run, &out, &report, &err)) fail_msg("%s", err.msg);
    sn_bvh_destroy(b);
    return out;
}

/* The farthest that the two motions take a vertex apart, in sizes of the piece. */
static double apart(const sn_tri_mesh *piece, const sn_transform *s, const sn_transform *t)
{
    sn_tri_mesh a, b;
    double most = 0.0;
    sn_tri_mesh_init(&a);
    sn_tri_mesh_init(&b);
    assert_int_equal(sn_tri_mesh_copy(&a, piece, NULL), SN_OK);
    assert_int_equal(sn_tri_mesh_copy(&b, piece, NULL), SN_OK);
    assert_int_equal(sn_tri_mesh_transform(&a, s, NULL), SN_OK);
    assert_int_equal(sn_tri_mesh_transform(&b, t, NULL), SN_OK);
    for (int32_t i = 0; i < a.n_vert; i++)
        most = fmax(most, sn_v3_dist(sn_tri_mesh_point(&a, i), sn_tri_mesh_point(&b, i)));
    double size = sn_box3_diagonal(sn_tri_mesh_bounds(&a));
    sn_tri_mesh_free(&a);
    sn_tri_mesh_free(&b);
    return most / size;
}

static void assert_falls(const sn_icp_report *r)
{
    for (int32_t i = 0; i < r->n_iteration; i++) assert_true(r->residual[i + 1] <= r->residual[i]);
}

/* Start errors of 20 to 30 degrees about several axes, a fifth of the size, and a shift. */
static void known_motions_are_found(void **state)
{
    (void)state;
    static const sn_transform motion[] = {
        {1.0, {1, 2, 3}, 20.0, {0.3, -0.15, 0.2}},   {1.2, {0, 1, 0}, 20.0, {0.2, 0.2, -0.2}},
        {0.8, {1, 0, 0}, -20.0, {-0.3, 0.1, 0.1}},   {1.25, {0, 0, 1}, -25.0, {0.1, -0.2, 0.3}},
        {0.8, {-1, 1, 0.5}, 25.0, {0.0, 0.3, -0.1}}, {1.0, {0, 0, 0}, 0.0, {0.4, 0.0, 0.0}},
    };
    made_template t;
    made_template_init(&t, 0.12);
    for (size_t i = 0; i < sizeof motion / sizeof *motion; i++) {
        sn_tri_mesh target;
        sn_tri_mesh_init(&target);
        assert_int_equal(sn_tri_mesh_copy(&target, &t.head, NULL), SN_OK);
        assert_int_equal(sn_tri_mesh_transform(&target, &motion[i], NULL), SN_OK);
        sn_transform got = find(&t.skin, &target, &nowhere, &(sn_icp_options){0}, true, NULL);
        assert_near(apart(&t.skin, &got, &motion[i]), 0.0, 1e-6);
        assert_near(got.scale, motion[i].scale, 1e-6);
        assert_falls(&report);
        assert_int_equal(report.stop, SN_ICP_EXACT);
        assert_true(report.n_iteration > 3 && report.n_iteration < 60);
        assert_int_equal(report.n_point, t.skin.n_vert);
        assert_int_equal(report.n_paired, t.skin.n_vert);
        if (motion[i].scale == 1.0) {
            got = find(&t.skin, &target, &nowhere, &(sn_icp_options){0}, false, NULL);
            assert_near(apart(&t.skin, &got, &motion[i]), 0.0, 1e-6);
            assert_true(got.scale == 1.0);
        }
        sn_tri_mesh_free(&target);
    }
    made_template_free(&t);
}

static void the_truth_stays(void **state)
{
    (void)state;
    made_template t;
    made_template_init(&t, 0.2);
    sn_transform start = {3.0, {1, 1, 0}, 100.0, {5, 6, 7}};
    sn_tri_mesh target;
    sn_tri_mesh_init(&target);
    assert_int_equal(sn_tri_mesh_copy(&target, &t.head, NULL), SN_OK);
    assert_int_equal(sn_tri_mesh_transform(&target, &start, NULL), SN_OK);
    sn_transform got = find(&t.skin, &target, &start, &(sn_icp_options){0}, true, NULL);
    assert_near(apart(&t.skin, &got, &start), 0.0, 1e-9);
    assert_int_equal(report.stop, SN_ICP_EXACT);
    assert_int_equal(report.n_iteration, 0);
    sn_tri_mesh_free(&target);
    made_template_free(&t);
}

/* A different shape and tessellation: no exact answer, but the residual falls and settles. */
static void other_surfaces_settle(void **state)
{
    (void)state;
    made_template t;
    made_template_init(&t, 0.12);
    sn_tri_mesh target = made_head(0.09);
    for (int32_t i = 0; i < target.n_vert; i++) target.pos[3 * i] *= 1.1;
    sn_transform start = {0.9, {0, 1, 0}, 15.0, {0.1, 0.1, 0.1}};
    sn_transform got = find(&t.skin, &target, &start, &(sn_icp_options){0}, true, NULL);
    assert_falls(&report);
    assert_int_equal(report.stop, SN_ICP_SETTLED);
    assert_true(apart(&t.skin, &got, &nowhere) < 0.08);
    double untrimmed = report.residual[report.n_iteration];
    got = find(&t.skin, &target, &start, &(sn_icp_options){.trim = 0.25}, true, NULL);
    assert_int_equal(report.n_far, t.skin.n_vert / 4);
    assert_int_equal(report.n_paired + report.n_far + report.n_opposed, t.skin.n_vert);
    assert_true(report.residual[report.n_iteration] < 0.8 * untrimmed);
    sn_tri_mesh_free(&target);
    made_template_free(&t);
}

/* A bit of the upper side of a slab: 9 x 9 vertices at height z, facing up. */
static sn_tri_mesh made_sheet(double z)
{
    sn_tri_mesh m;
    sn_tri_mesh_init(&m);
    assert_int_equal(sn_tri_mesh_reserve(&m, 81, 128, NULL), SN_OK);
    for (int i = 0; i < 81; i++)
        sn_v3_store(m.pos + 3 * i, sn_v3(0.1 * (i % 9) - 0.4, 0.1 * (i / 9) - 0.4, z));
    for (int i = 0; i < 64; i++) {
        int32_t a = i / 8 * 9 + i % 8, *f = m.face + 6 * i;
        f[0] = a, f[1] = a + 1, f[2] = a + 10, f[3] = a, f[4] = a + 10, f[5] = a + 9;
    }
    return m;
}

/* The sheet belongs on the slab's upper side, z = 0.1, but starts tilted with half of it nearer to the lower
 * one, z = 0. Pairs with the lower side oppose: without them it goes up, with them it stays between. */
static void opposed_pairs_are_left_out(void **state)
{
    (void)state;
    sn_tri_mesh slab = made_box(sn_v3(-2, -2, 0), sn_v3(2, 2, 0.1)), sheet = made_sheet(0.052);
    sn_transform start = {1.0, {1, 0, 0}, 5.0, {0, 0, 0}};
    sn_transform got = find(&sheet, &slab, &start, &(sn_icp_options){0}, false, NULL);
    assert_true(sheet.n_vert == report.n_paired && report.n_opposed == 0);
    sn_tri_mesh up = sheet;
    assert_int_equal(sn_tri_mesh_transform(&up, &got, NULL), SN_OK);
    for (int32_t i = 0; i < up.n_vert; i++) assert_near(up.pos[3 * i + 2], 0.1, 1e-6);
    sn_tri_mesh_free(&sheet);
    sheet = made_sheet(0.052);
    got = find(&sheet, &slab, &start, &(sn_icp_options){.min_dot = -1.0}, false, NULL);
    assert_int_equal(report.n_paired, sheet.n_vert);
    assert_true(report.residual[report.n_iteration] > 1e-3);
    sn_tri_mesh_free(&sheet);
    sheet = made_sheet(0.02); /* all of it nearer to the lower side */
    sn_bvh *b = bvh_of(&slab);
    sn_error err;
    assert_int_equal(
        sn_icp_rigid_run(&sheet, b, &nowhere, &(sn_icp_options){0}, false, NULL, &got, &report, &err),
        SN_ESOLVE);
    assert_string_equal(err.msg, "rigid ICP: only 0 of 81 points of the template's skin have a match on the "
                                 "skin after 0 iterations (81 face the other way): is the template placed "
                                 "near the right spot?");
    assert_int_equal(report.stop, SN_ICP_UNPAIRED);
    assert_int_equal(report.n_opposed, 81);
    sn_bvh_destroy(b);
    sn_tri_mesh_free(&sheet);
    sn_tri_mesh_free(&slab);
}

static void the_unit_does_not_matter(void **state)
{
    (void)state;
    made_template t;
    made_template_init(&t, 0.2);
    sn_tri_mesh target = made_head(0.15);
    for (int32_t i = 0; i < target.n_vert; i++) target.pos[3 * i + 1] *= 1.08;
    sn_transform start = {1.0, {0, 1, 0}, 15.0, {0.1, 0.1, 0.1}};
    sn_transform small = find(&t.skin, &target, &start, &(sn_icp_options){0}, true, NULL), large;
    int32_t n = report.n_iteration;
    double residual = report.residual[n];
    scale_mesh(&t.skin, 1000.0);
    scale_mesh(&target, 1000.0);
    start.translate = sn_v3_scale(1000.0, start.translate);
    large = find(&t.skin, &target, &start, &(sn_icp_options){0}, true, NULL);
    large.translate = sn_v3_scale(0.001, large.translate);
    scale_mesh(&t.skin, 0.001);
    assert_near(apart(&t.skin, &small, &large), 0.0, 1e-9);
    assert_int_equal(report.n_iteration, n);
    assert_near(report.residual[n] / 1000.0, residual, 1e-9);
    sn_tri_mesh_free(&target);
    made_template_free(&t);
}

static void the_same_bits_for_any_threads(void **state)
{
    (void)state;
    made_template t;
    made_template_init(&t, 0.15);
    sn_transform start = {1.1, {0, 1, 0}, 15.0, {0.1, 0.1, 0.1}}, a, b;
    sn_run one = {.n_threads = 1}, three = {.n_threads = 3};
    a = find(&t.skin, &t.head, &start, &(sn_icp_options){.trim = 0.1}, true, &one);
    b = find(&t.skin, &t.head, &start, &(sn_icp_options){.trim = 0.1}, true, &three);
    assert_memory_equal(&a, &b, sizeof a);
    made_template_free(&t);
}

typedef struct bad_case {
    sn_icp_options o;
    sn_transform start;
    sn_status want;
    const char *msg; /* how it begins */
} bad_case;

static void what_goes_wrong_is_told(void **state)
{
    (void)state;
    const sn_transform off = {1.1, {0, 1, 0}, 20.0, {0.1, 0, 0}};
    const bad_case bad[] = {
        {{.min_dot = -2}, nowhere, SN_EINVAL, "rigid ICP: min_dot is -2, need -1 to 1"},
        {{.trim = 1}, nowhere, SN_EINVAL, "rigid ICP: trim is 1, need 0 to 0.9"},
        {{.tolerance = NAN},
         nowhere,
         SN_EINVAL,
         "rigid ICP: tolerance is nan, need more than 0 and less than 1"},
        {{.max_residual = -1}, nowhere, SN_EINVAL, "rigid ICP: max_residual is -1, need > 0"},
        {{.max_iterations = 501}, nowhere, SN_EINVAL, "rigid ICP: max_iterations is 501, need 1 to 500"},
        {{.trim = 0}, {.scale = 0}, SN_EINVAL, "rigid ICP: scale of the start is 0, need > 0"},
        {{.trim = 0},
         {.scale = 1, .translate = {NAN, 0, 0}},
         SN_EINVAL,
         "rigid ICP: axis, angle or translation of the start is not finite"},
        {{.max_iterations = 3},
         off,
         SN_ESOLVE,
         "rigid ICP: does not converge: after 3 iterations the residual is 0."},
        {{.max_residual = 1e-4},
         {1.0, {0, 1, 0}, 90.0, {0, 0, 0}},
         SN_ESOLVE,
         "rigid ICP: does not converge: "},
        {{.trim = 0},
         {3.0, {0, 1, 0}, 0.0, {0, 0, 0}},
         SN_ESOLVE,
         "rigid ICP: does not converge: in 8 iterations it went more than 54 degrees or nearly a factor of 2 "
         "in "
         "size away from the start, to a residual of 0."},
    };
    made_template t;
    made_template_init(&t, 0.2);
    sn_bvh *b = bvh_of(&t.head);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        sn_error err = {.msg = ""};
        sn_transform out = {.scale = 77.0};
        sn_status st =
            sn_icp_rigid_run(&t.skin, b, &bad[i].start, &bad[i].o, true, NULL, &out, &report, &err);
        if (st != bad[i].want || strncmp(err.msg, bad[i].msg, strlen(bad[i].msg)) != 0)
            fail_msg("case %zu: %d %s", i, st, err.msg);
        assert_true(out.scale == 77.0);
        if (bad[i].o.max_iterations == 3) {
            assert_int_equal(report.stop, SN_ICP_LIMIT);
            assert_int_equal(report.n_iteration, 3);
        }
    }
    sn_transform out;
    sn_error err;
    for (size_t k = 0; k < 3 * (size_t)t.skin.n_vert; k++) t.skin.pos[k] = 1.0;
    assert_int_equal(
        sn_icp_rigid_run(&t.skin, b, &nowhere, &(sn_icp_options){0}, true, NULL, &out, &report, &err),
        SN_EINVAL);
    assert_string_equal(err.msg, "template skin: area is 0, need > 0");
    sn_bvh_destroy(b);
    made_template_free(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_motions_are_found),  cmocka_unit_test(the_truth_stays),
        cmocka_unit_test(other_surfaces_settle),    cmocka_unit_test(opposed_pairs_are_left_out),
        cmocka_unit_test(the_unit_does_not_matter), cmocka_unit_test(the_same_bits_for_any_threads),
        cmocka_unit_test(what_goes_wrong_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
