/* test_scene_mirror - the bones of the other side. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "made_skeleton.h"

static double size_of(const sn_tri_mesh *m)
{
    return sn_box3_diagonal(sn_tri_mesh_bounds(m));
}

/* For every template: the bone of the right, placed, is the image of the left one. */
static void right_bones_are_the_image_of_left_ones(void **state)
{
    (void)state;
    for (int32_t i = 0; i < sn_bone_library_count(library); i++) {
        const sn_bone_template *t = template(sn_bone_library_name(library, i));
        sn_scene *placed = new_scene("m", SN_UP_Y), *mirrored = new_scene("m", SN_UP_Y);
        int32_t n_added, n_replaced, n;
        if (t->kind == SN_BONE_CURVE) {
            sn_scene_destroy(placed);
            sn_scene_destroy(mirrored);
            continue;
        }
        if (t->kind == SN_BONE_CYLINDER) {
            place_between(mirrored, "x_l", t->name, sn_v3(0.1, 0.4, 0.1), sn_v3(0.2, 0.05, 0.07));
            place_between(placed, "x_r", t->name, sn_v3(-0.1, 0.4, 0.1), sn_v3(-0.2, 0.05, 0.07));
        } else {
            place_at(mirrored, "x_l", t->name, sn_v3(0.3, 1.2, -0.1));
            place_at(placed, "x_r", t->name, sn_v3(-0.3, 1.2, -0.1));
        }
        ok(sn_scene_mirror_bones(mirrored, sn_v3(0, 0, 0), sn_v3(1, 0, 0), &n_added, &n_replaced, &err));
        assert_int_equal(n_added, 1);
        assert_int_equal(n_replaced, 0);
        assert_string_equal(sn_scene_bone_name(mirrored, 1), "x_r");
        const sn_tri_mesh *m = sn_scene_bone_mesh(mirrored, 1);
        assert_same_mesh(m, sn_scene_bone_mesh(placed, 0), 1e-12 * size_of(m));
        assert_true(sn_tri_mesh_volume(m) > 0.0);
        const sn_landmark *a = sn_scene_bone_landmarks(mirrored, 1, &n),
                          *b = sn_scene_bone_landmarks(placed, 0, &n);
        for (int32_t k = 0; k < n; k++) {
            assert_string_equal(a[k].name, b[k].name);
            assert_at(a[k].at, b[k].at, 1e-12 * size_of(m));
            assert_near(a[k].radius, b[k].radius, 1e-15);
        }
        sn_scene_destroy(placed);
        sn_scene_destroy(mirrored);
    }
}

static void mirrored_twice_gives_the_same_bits(void **state)
{
    (void)state;
    sn_scene *s = new_scene("m", SN_UP_Y);
    int32_t i = place_between(s, "ulna.L", "ulna", sn_v3(0.31, 0.2, 0.1), sn_v3(0.4, -0.07, 0.123)), n_added,
            n_replaced;
    sn_tri_mesh first;
    sn_vec3 from, to, from_again, to_again;
    sn_tri_mesh_init(&first);
    ok(sn_tri_mesh_copy(&first, sn_scene_bone_mesh(s, i), &err));
    assert_true(sn_scene_bone_ends(s, i, &from, &to));
    for (int k = 0; k < 2; k++) { /* to the right, and back */
        ok(sn_scene_mirror_bones(s, sn_v3(0, 0, 0), sn_v3(-2, 0, 0), &n_added, &n_replaced, &err));
        ok(sn_scene_remove_bone(s, k ? "ulna.R" : "ulna.L", &err));
    }
    assert_int_equal(sn_scene_bone_count(s), 1);
    assert_string_equal(sn_scene_bone_name(s, 0), "ulna.L");
    const sn_tri_mesh *m = sn_scene_bone_mesh(s, 0);
    assert_memory_equal(m->pos, first.pos, 3 * (size_t)first.n_vert * sizeof *first.pos);
    assert_memory_equal(m->face, first.face, 3 * (size_t)first.n_face * sizeof *first.face);
    assert_true(sn_scene_bone_ends(s, 0, &from_again, &to_again));
    assert_at(from, from_again, 0.0);
    assert_at(to, to_again, 0.0);
    sn_tri_mesh_free(&first);
    sn_scene_destroy(s);
}

static void the_left_one_counts(void **state)
{
    (void)state;
    sn_scene *s = new_scene("m", SN_UP_Y);
    int32_t n_added = 9, n_replaced = 9, i;
    sn_vec3 point = {0, 0, 0.5}, normal = {1, 0, 1};
    assert_error(sn_scene_mirror_bones(s, point, normal, &n_added, &n_replaced, &err),
                 "mirror_bones: no bone has a side: names of a side end in _l or _r (or .l, _L, _left ...)");
    place_at(s, "skull", "skull", sn_v3(0, 1.5, 0));
    assert_error(sn_scene_mirror_bones(s, point, normal, &n_added, &n_replaced, &err), "no bone has a side");
    place_at(s, "foot_r", "foot", sn_v3(-9, 0, 0));
    place_at(s, "foot_l", "foot", sn_v3(0.1, 0, 0));
    place_at(s, "hand_right", "hand", sn_v3(-0.5, 1, 0));
    assert_error(sn_scene_mirror_bones(s, point, sn_v3(0, 0, 0), &n_added, &n_replaced, &err),
                 "mirror_bones: the plane needs a finite point and a normal that is not zero");
    assert_error(sn_scene_mirror_bones(s, sn_v3(0, NAN, 0), normal, &n_added, &n_replaced, &err),
                 "finite point");
    assert_int_equal(sn_scene_bone_count(s), 4);
    ok(sn_scene_mirror_bones(s, point, normal, &n_added, &n_replaced, &err));
    assert_int_equal(n_added, 1);
    assert_int_equal(n_replaced, 1);
    assert_int_equal(sn_scene_bone_count(s), 5);
    ok(sn_scene_find_bone(s, "foot_r", &i, &err));
    assert_int_equal(i, 1); /* in its place */
    sn_affine map = sn_affine_mirror(point, normal);
    sn_tri_mesh image;
    sn_tri_mesh_init(&image);
    ok(sn_tri_mesh_copy(&image, sn_scene_bone_mesh(s, 2), &err));
    sn_affine_mesh(&map, &image);
    assert_same_mesh(sn_scene_bone_mesh(s, 1), &image, 1e-12);
    sn_vec3 l = landmark(s, 2, "calcaneal_tuberosity");
    assert_at(landmark(s, 1, "calcaneal_tuberosity"), sn_affine_point(&map, l), 1e-12);
    ok(sn_scene_find_bone(s, "hand_left", &i, &err));
    assert_int_equal(i, 4);
    sn_tri_mesh_free(&image);
    sn_scene_destroy(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(right_bones_are_the_image_of_left_ones),
        cmocka_unit_test(mirrored_twice_gives_the_same_bits),
        cmocka_unit_test(the_left_one_counts),
    };
    return cmocka_run_group_tests(tests, make_library, free_library);
}
