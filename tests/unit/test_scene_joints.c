/* test_scene_joints - which bone turns on which: what is refused, what goes with a bone, the other side. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "asserts.h"
#include "made_mesh.h"
#include "scene/scene_bones.h"

#define assert_same_place(p, q) assert_true(sn_v3_dist(p, q) <= 1e-14)
#define assert_einval(call, text)                                                                            \
    do {                                                                                                     \
        sn_error err = {.msg = ""};                                                                          \
        assert_int_equal((call), SN_EINVAL);                                                                 \
        if (!strstr(err.msg, text)) fail_msg("\"%s\" does not say \"%s\"", err.msg, text);                   \
    } while (0)

/* A pelvis with a leg of three bones. */
static sn_scene *made_leg(void)
{
    static const char *const name[] = {"pelvis", "femur_l", "tibia_l", "foot_l"};
    sn_scene *s = NULL;
    ok(sn_scene_create(&s, "leg", "m", SN_UP_Y, &err));
    for (int i = 0; i < 4; i++) {
        sn_tri_mesh m = made_box(sn_v3(0.1, -1 - i, 0), sn_v3(0.2, -0.1 - i, 0.1));
        ok(sn_scene_add_bone(s, name[i], &m, &err));
        sn_tri_mesh_free(&m);
    }
    return s;
}

static void add(sn_scene *s, const char *name, const char *parent, const char *child)
{
    ok(sn_scene_add_joint(s, name, parent, child, sn_v3(0.15, -1, 0), NULL, &err));
}

static void joints_are_kept(void **state)
{
    (void)state;
    sn_scene *s = made_leg();
    uint64_t revision = sn_scene_revision(s);
    const sn_vec3 tilted[3] = {{0, 0, 2}, {3, 0, 1}, {0.1, 5, 0.2}};
    add(s, "hip_l", "pelvis", "femur_l");
    ok(sn_scene_add_joint(s, "knee_l", "femur_l", "tibia_l", sn_v3(1, 2, 3), tilted, &err));
    assert_true(sn_scene_revision(s) > revision);
    assert_int_equal(sn_scene_joint_count(s), 2);
    const sn_joint *j = sn_scene_joint(s, 0);
    assert_string_equal(j->name, "hip_l");
    assert_string_equal(j->parent, "pelvis");
    assert_string_equal(j->child, "femur_l");
    assert_same_place(j->center, sn_v3(0.15, -1, 0));
    assert_same_place(j->axis[0], sn_v3(1, 0, 0));
    assert_same_place(j->axis[1], sn_v3(0, 1, 0));
    assert_same_place(j->axis[2], sn_v3(0, 0, 1));
    j = sn_scene_joint(s, 1); /* orthonormal, in this order */
    assert_same_place(j->axis[0], sn_v3(0, 0, 1));
    assert_same_place(j->axis[1], sn_v3(1, 0, 0));
    assert_same_place(j->axis[2], sn_v3(0, 1, 0));
    ok(sn_scene_remove_joint(s, "hip_l", &err));
    assert_int_equal(sn_scene_joint_count(s), 1);
    assert_string_equal(sn_scene_joint(s, 0)->name, "knee_l");
    assert_einval(sn_scene_remove_joint(s, "knee", &err), "no joint 'knee' (did you mean 'knee_l'?)");
    ok(sn_scene_remove_joint(s, "knee_l", &err));
    assert_einval(sn_scene_remove_joint(s, "knee_l", &err), "no joint 'knee_l' (the scene has 0)");
    sn_scene_destroy(s);
}

static void wrong_joints_are_told(void **state)
{
    (void)state;
    sn_scene *s = made_leg();
    sn_vec3 c = {0, 0, 0};
    add(s, "hip_l", "pelvis", "femur_l");
    add(s, "knee_l", "femur_l", "tibia_l");
    uint64_t revision = sn_scene_revision(s);
    static const struct {
        const char *name, *parent, *child, *says;
    } bad[] = {
        {"hip_l", "tibia_l", "foot_l", "there is a joint 'hip_l' already"},
        {"", "tibia_l", "foot_l", "name of a joint has 0 bytes, need 1 to 64"},
        {"a/b", "tibia_l", "foot_l", "name of joint 'a/b' holds"},
        {"j", "tibia", "foot_l", "joint 'j': no bone 'tibia' (did you mean 'tibia_l'?)"},
        {"j", "tibia_l", "patella", "joint 'j': no bone 'patella'"},
        {"j", "foot_l", "foot_l", "joint 'j': bone 'foot_l' is its own parent"},
        {"j", "foot_l", "tibia_l", "joint 'j': bone 'tibia_l' hangs on joint 'knee_l' already"},
        {"j", "tibia_l", "pelvis", "joint 'j': bone 'tibia_l' hangs on 'pelvis' in turn: a ring"},
        {"j", "femur_l", "pelvis", "joint 'j': bone 'femur_l' hangs on 'pelvis' in turn: a ring"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_einval(sn_scene_add_joint(s, bad[i].name, bad[i].parent, bad[i].child, c, NULL, &err),
                      bad[i].says);
    assert_einval(sn_scene_add_joint(s, "j", "tibia_l", "foot_l", sn_v3(0, NAN, 0), NULL, &err),
                  "joint 'j': its center is not finite");
    static const sn_vec3 flat[][3] = {{{1, 0, 0}, {2, 0, 0}, {0, 0, 1}}, /* two along one line   */
                                      {{1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, /* three in one plane   */
                                      {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}}, /* one without length   */
                                      {{1, 0, 0}, {0, 1, 0}, {0, 0, 0}},
                                      {{1, 0, 0}, {0, INFINITY, 0}, {0, 0, 1}},
                                      {{1, 0, 0}, {0, 1, 0}, {0, 0, NAN}}};
    for (size_t i = 0; i < sizeof flat / sizeof *flat; i++)
        assert_einval(sn_scene_add_joint(s, "j", "tibia_l", "foot_l", c, flat[i], &err),
                      "joint 'j': its axes do not span space");
    static const sn_vec3 left[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
    assert_einval(sn_scene_add_joint(s, "j", "tibia_l", "foot_l", c, left, &err),
                  "joint 'j': its axes are left-handed; swap two or turn one");
    assert_int_equal(sn_scene_joint_count(s), 2);
    assert_int_equal(sn_scene_revision(s), revision);
    sn_scene_destroy(s);
}

static void joints_go_with_their_bones(void **state)
{
    (void)state;
    sn_scene *s = made_leg();
    add(s, "hip_l", "pelvis", "femur_l");
    add(s, "knee_l", "femur_l", "tibia_l");
    add(s, "ankle_l", "tibia_l", "foot_l");
    ok(sn_scene_remove_bone(s, "femur_l", &err));
    assert_int_equal(sn_scene_joint_count(s), 1);
    assert_string_equal(sn_scene_joint(s, 0)->name, "ankle_l");
    assert_int_equal(sn_scene_notes(s)->n_line, 2);
    add(s, "hip_knee_l", "pelvis", "tibia_l"); /* free again */
    sn_scene_destroy(s);
}

static int32_t joint(const sn_scene *s, const char *name)
{
    for (int32_t i = 0; i < sn_scene_joint_count(s); i++)
        if (strcmp(sn_scene_joint(s, i)->name, name) == 0) return i;
    fail_msg("no joint '%s'", name);
    return -1;
}

static void joints_are_mirrored(void **state)
{
    (void)state;
    sn_scene *s = made_leg();
    int32_t n_added, n_replaced;
    const sn_vec3 axis[3] = {{0.6, 0.8, 0}, {-0.8, 0.6, 0}, {0, 0, 1}};
    add(s, "hip_l", "pelvis", "femur_l");
    ok(sn_scene_add_joint(s, "knee_l", "femur_l", "tibia_l", sn_v3(0.1, 2, 3), axis, &err));
    for (int round = 0; round < 2; round++) { /* new, then replaced */
        ok(sn_scene_mirror_bones(s, sn_v3(0, 0, 0), sn_v3(1, 0, 0), &n_added, &n_replaced, &err));
        assert_int_equal(n_added, round ? 0 : 3);
        assert_int_equal(n_replaced, round ? 3 : 0);
        assert_int_equal(sn_scene_joint_count(s), 4);
        const sn_joint *hip = sn_scene_joint(s, joint(s, "hip_r")),
                       *knee = sn_scene_joint(s, joint(s, "knee_r"));
        assert_string_equal(hip->parent, "pelvis"); /* without a side: the same one */
        assert_string_equal(hip->child, "femur_r");
        assert_string_equal(knee->parent, "femur_r");
        assert_string_equal(knee->child, "tibia_r");
        assert_same_place(knee->center, sn_v3(-0.1, 2, 3));
        assert_same_place(knee->axis[0], sn_v3(-0.6, 0.8, 0));
        assert_same_place(knee->axis[1], sn_v3(0.8, 0.6, 0));
        assert_same_place(knee->axis[2], sn_v3(0, 0, -1)); /* turned, so that they stay right-handed */
        assert_true(sn_v3_det(knee->axis[0], knee->axis[1], knee->axis[2]) > 0.999);
    }
    assert_same_place(sn_scene_joint(s, joint(s, "knee_l"))->center, sn_v3(0.1, 2, 3));
    sn_scene_destroy(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(joints_are_kept),
        cmocka_unit_test(wrong_joints_are_told),
        cmocka_unit_test(joints_go_with_their_bones),
        cmocka_unit_test(joints_are_mirrored),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
