/* test_icp_cage - a cage bent until its piece of skin lies on a target. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "skeleton/cage.h"
#include "skeleton/icp_cage.h"

#include "made_template.h"

static sn_icp_report report; /* large */

typedef struct scene { /* a template, its target, and the cage as it came out */
    made_template t;
    sn_tri_mesh target;
    sn_bvh *bvh;
    double *bound, *out;
} scene;

static void scene_init(scene *s, double cell, sn_vec3 (*warp)(sn_vec3))
{
    made_template_init(&s->t, cell);
    sn_tri_mesh_init(&s->target);
    assert_int_equal(sn_tri_mesh_copy(&s->target, &s->t.head, NULL), SN_OK);
    for (int32_t i = 0; i < s->target.n_vert; i++)
        sn_v3_store(s->target.pos + 3 * i, warp(sn_tri_mesh_point(&s->target, i)));
    assert_int_equal(sn_bvh_create(&s->bvh, &s->target, NULL), SN_OK);
    s->bound = SN_NEW(double, s->t.skin.n_vert * s->t.cage.n_vert);
    s->out = SN_NEW_ZERO(double, 3 * s->t.cage.n_vert);
    assert_true(s->bound && s->out);
    assert_int_equal(sn_cage_weights(&s->t.cage, s->t.skin.pos, s->t.skin.n_vert, NULL, s->bound, NULL),
                     SN_OK);
}

static void scene_free(scene *s)
{
    made_template_free(&s->t);
    sn_tri_mesh_free(&s->target);
    sn_bvh_destroy(s->bvh);
    sn_release(s->bound);
    sn_release(s->out);
}

static sn_status bend(scene *s, const sn_icp_cage_options *o, const sn_run *run, sn_error *err)
{
    return sn_icp_cage_run(&s->t.cage, &s->t.skin, s->bound, s->bvh, o, run, s->out, &report, err);
}

static sn_vec3 stretch(sn_vec3 p)
{
    return sn_v3(1.1 * p.x + 0.05 * p.y, 0.93 * p.y, 1.08 * p.z + 0.04);
}

static sn_vec3 same(sn_vec3 p)
{
    return p;
}

static sn_vec3 turned(sn_vec3 p) /* by 75 degrees */
{
    return sn_v3(0.2588 * p.x + 0.9659 * p.z, p.y, 0.2588 * p.z - 0.9659 * p.x);
}

/* The cage turns and stretches as a whole for free: an affine target is met almost exactly. */
static void affine_targets_are_met(void **state)
{
    (void)state;
    scene s;
    sn_error err = {.msg = ""};
    scene_init(&s, 0.15, stretch);
    if (bend(&s, &(sn_icp_cage_options){0}, NULL, &err)) fail_msg("%s", err.msg);
    for (int32_t i = 0; i < s.t.cage.n_vert; i++) {
        sn_vec3 want = stretch(sn_tri_mesh_point(&s.t.cage, i));
        assert_near(sn_v3_dist(want, sn_v3_load(s.out + 3 * i)), 0.0, 0.02);
    }
    assert_true(report.residual[report.n_iteration] < 2e-4 * report.size);
    assert_true(report.residual[0] > 0.01 * report.size);
    assert_int_equal(report.n_paired, s.t.skin.n_vert);
    scene_free(&s);
}

static void the_truth_stays(void **state)
{
    (void)state;
    scene s;
    scene_init(&s, 0.2, same);
    assert_int_equal(bend(&s, &(sn_icp_cage_options){0}, NULL, NULL), SN_OK);
    assert_int_equal(report.stop, SN_ICP_EXACT);
    for (int k = 0; k < 3 * s.t.cage.n_vert; k++) assert_near(s.out[k], s.t.cage.pos[k], 1e-12);
    /* A nudge of the cage, and it comes back. */
    for (int32_t i = 0; i < s.t.cage.n_vert; i++) s.t.cage.pos[3 * i] += 0.01;
    assert_int_equal(bend(&s, &(sn_icp_cage_options){0}, NULL, NULL), SN_OK);
    for (int32_t i = 0; i < s.t.cage.n_vert; i++) assert_near(s.out[3 * i], s.t.cage.pos[3 * i] - 0.01, 2e-3);
    scene_free(&s);
}

static void inverted_faces_are_counted(void **state)
{
    (void)state;
    sn_tri_mesh m = made_sphere(sn_v3(0, 0, 0), 1.0, 0.4), moved;
    sn_tri_mesh_init(&moved);
    assert_int_equal(sn_tri_mesh_copy(&moved, &m, NULL), SN_OK);
    for (int32_t i = 0; i < m.n_vert; i++) /* stretched and turned, even reflected: nothing is inside out */
        sn_v3_store(moved.pos + 3 * i,
                    sn_v3(-3.0 * m.pos[3 * i + 1] + 7.0, m.pos[3 * i], -0.2 * m.pos[3 * i + 2]));
    assert_int_equal(sn_count_inverted(&m, moved.pos), 0);
    memcpy(moved.pos, m.pos, 3 * (size_t)m.n_vert * sizeof *m.pos);
    int32_t v = m.n_vert / 2, n_inverted = 0;
    for (int k = 0; k < 3; k++)
        moved.pos[3 * v + k] += 0.5 * m.pos[3 * (v + 1) + k] - 0.5 * m.pos[3 * (v - 1) + k];
    for (int k = 0; k < 3; k++) moved.pos[3 * v + k] += m.pos[3 * (v + 1) + k] - m.pos[3 * (v - 1) + k];
    for (int32_t f = 0; f < m.n_face; f++)
        n_inverted += sn_v3_dot(sn_tri_mesh_face_normal(&m, f), sn_tri_mesh_face_normal(&moved, f)) < 0.0;
    assert_true(n_inverted > 0);
    assert_int_equal(sn_count_inverted(&m, moved.pos), n_inverted);
    assert_int_equal(sn_count_inverted(&m, m.pos), 0);
    sn_tri_mesh_free(&m);
    sn_tri_mesh_free(&moved);
}

/* So far off that a soft cage would fold: it stays as stiff as it must be. */
static void the_cage_does_not_fold(void **state)
{
    (void)state;
    scene s;
    sn_error err = {.msg = ""};
    scene_init(&s, 0.2, turned);
    sn_icp_cage_options o = {.icp.max_residual = 1.0, .soft = 1e-7};
    if (bend(&s, &o, NULL, &err)) fail_msg("%s", err.msg);
    assert_int_equal(report.stop, SN_ICP_STIFF);
    assert_string_equal(sn_icp_stop_name(report.stop), "stiff");
    assert_int_equal(sn_count_inverted(&s.t.cage, s.out), 0);
    scene_free(&s);
}

static void the_same_bits_for_any_threads(void **state)
{
    (void)state;
    scene s;
    double first[3 * 200];
    sn_run one = {.n_threads = 1}, three = {.n_threads = 3};
    scene_init(&s, 0.15, stretch);
    assert_true(s.t.cage.n_vert <= 200);
    assert_int_equal(bend(&s, &(sn_icp_cage_options){0}, &one, NULL), SN_OK);
    memcpy(first, s.out, 3 * (size_t)s.t.cage.n_vert * sizeof *first);
    assert_int_equal(bend(&s, &(sn_icp_cage_options){0}, &three, NULL), SN_OK);
    assert_memory_equal(first, s.out, 3 * (size_t)s.t.cage.n_vert * sizeof *first);
    scene_free(&s);
}

static void what_goes_wrong_is_told(void **state)
{
    (void)state;
    const struct {
        sn_icp_cage_options o;
        sn_status want;
        const char *msg; /* how it begins */
    } bad[] = {
        {{.icp.trim = -1}, SN_EINVAL, "cage ICP: trim is -1, need 0 to 0.9"},
        {{.soft = -1}, SN_EINVAL, "cage ICP: stiffness goes from 100 to -1, need > 0 and not rising"},
        {{.soft = 1, .stiff = 0.5},
         SN_EINVAL,
         "cage ICP: stiffness goes from 0.5 to 1, need > 0 and not rising"},
        {{.across = 2}, SN_EINVAL, "cage ICP: across is 2, need 0 to 1"},
        {{.icp.max_iterations = 4},
         SN_ESOLVE,
         "cage ICP: does not converge: after 4 iterations the residual is 0."},
        {{.icp.max_residual = 1e-7}, SN_ESOLVE, "cage ICP: does not converge: the residual settled at "},
    };
    scene s;
    scene_init(&s, 0.2, stretch);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        sn_error err = {.msg = ""};
        sn_status st = bend(&s, &bad[i].o, NULL, &err);
        if (st != bad[i].want || strncmp(err.msg, bad[i].msg, strlen(bad[i].msg)) != 0)
            fail_msg("case %zu: %d %s", i, st, err.msg);
        for (int k = 0; k < 3 * s.t.cage.n_vert; k++) assert_true(s.out[k] == 0.0);
    }
    scene_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(affine_targets_are_met),        cmocka_unit_test(the_truth_stays),
        cmocka_unit_test(inverted_faces_are_counted),    cmocka_unit_test(the_cage_does_not_fold),
        cmocka_unit_test(the_same_bits_for_any_threads), cmocka_unit_test(what_goes_wrong_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
