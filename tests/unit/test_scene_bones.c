/* test_scene_bones - the skeleton of a scene: bones placed, edited, kept inside the skin. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "made_skeleton.h"
#include "mesh/bvh.h"

/* ---- scenes with a box for a skin: rays through it have exact middles ---- */

static sn_scene *boxed_scene(void)
{
    sn_scene *s = new_scene("m", SN_UP_Y);
    sn_tri_mesh skin = made_box(sn_v3(-1, -1, -0.25), sn_v3(1, 1, 0.25));
    ok(sn_scene_set_skin(s, &skin, &err));
    sn_tri_mesh_free(&skin);
    return s;
}

static sn_pick at(double x, double y, double z)
{
    return (sn_pick){.origin = {x, y, z}};
}

static double distance_to_bone(const sn_scene *s, int32_t i, sn_vec3 p)
{
    sn_bvh *b = NULL;
    ok(sn_bvh_create(&b, sn_scene_bone_mesh(s, i), &err));
    double d = sn_bvh_closest(b, p).dist;
    sn_bvh_destroy(b);
    return d;
}

/* ---- placing ---- */

static void a_bone_lies_between_its_ends(void **state)
{
    (void)state;
    sn_scene *s = new_scene("m", SN_UP_Y);
    const sn_bone_template *t = template("femur");
    sn_vec3 from = {0.1, 0.9, 0.0}, to = {0.12, 0.4, 0.03}, a, b;
    int32_t n, i = place_between(s, "femur_l", "femur", from, to);
    assert_true(sn_scene_bone_ends(s, i, &a, &b));
    assert_at(a, from, 0.0);
    assert_at(b, to, 0.0);
    double k = sn_v3_dist(from, to) / sn_v3_dist(t->from, t->to);
    assert_near(sn_tri_mesh_volume(sn_scene_bone_mesh(s, i)), k * k * k * sn_tri_mesh_volume(&t->bone),
                1e-15);
    const sn_landmark *l = sn_scene_bone_landmarks(s, i, &n);
    assert_int_equal(n, t->n_landmark);
    for (int32_t j = 0; j < n; j++) {
        assert_string_equal(l[j].name, t->landmark[j].name);
        assert_near(l[j].radius, k * t->landmark[j].radius, 1e-15);
        if (l[j].radius > 0.0) assert_true(distance_to_bone(s, i, l[j].at) < 1e-6);
    }
    assert_true(landmark(s, i, "greater_trochanter").x > landmark(s, i, "lesser_trochanter").x);
    assert_int_equal(sn_scene_bone_landmark(s, i, "greater_trochanter", &(sn_landmark){0}, NULL), SN_OK);
    sn_scene_destroy(s);
}

static void rays_pick_the_middle_of_the_skin(void **state)
{
    (void)state;
    sn_scene *s = boxed_scene();
    sn_vec3 p = {7, 7, 7}, from, to;
    ok(sn_scene_pick(s, &(sn_pick){.origin = {3, 4, 5}}, &p, &err)); /* a point is itself */
    assert_at(p, sn_v3(3, 4, 5), 0.0);
    ok(sn_scene_pick(s, &(sn_pick){true, {0.5, 0.75, 9}, {0, 0, -1}}, &p, &err));
    assert_at(p, sn_v3(0.5, 0.75, 0), 1e-15);
    sn_bone_placing placing = {.name = "tibia_l", .from_template = template("tibia")};
    sn_pick a = {true, {0.5, 0.25, 9}, {0, 0, -1}}, b = {true, {9, -0.5, 0.125}, {-4, 0, 0}};
    ok(sn_scene_place_cylinder(s, &placing, &a, &b, &(sn_cylinder_placing){0}, NULL, NULL, &err));
    assert_true(sn_scene_bone_ends(s, 0, &from, &to));
    assert_at(from, sn_v3(0.5, 0.25, 0), 1e-15);
    assert_at(to, sn_v3(0, -0.5, 0.125), 1e-15);
    assert_error(sn_scene_pick(s, &(sn_pick){true, {5, 0, 9}, {0, 0, -1}}, &p, &err), "misses the skin by 4");
    assert_error(sn_scene_pick(s, &(sn_pick){.origin = {NAN, 0, 0}}, &p, &err),
                 "pick: the point is not finite");
    b.dir.x = 1;
    placing.name = "tibia_r";
    assert_error(sn_scene_place_cylinder(s, &placing, &a, &b, &(sn_cylinder_placing){0}, NULL, NULL, &err),
                 "bone 'tibia_r': to: ");
    sn_scene_destroy(s);
    s = new_scene("m", SN_UP_Y);
    assert_error(sn_scene_pick(s, &a, &p, &err),
                 "a pick by a ray needs a skin and the scene has none: set_skin first");
    sn_scene_destroy(s);
}

static double thickness_of(const sn_scene *s, int32_t i) /* across, of a bone along y */
{
    sn_box3 b = sn_tri_mesh_bounds(sn_scene_bone_mesh(s, i));
    return b.max.x - b.min.x;
}

static void thickness_goes_with_the_length_or_is_kept(void **state)
{
    (void)state;
    static const struct {
        const char *unit;
        double per_metre;
    } unit[] = {{"m", 1.0}, {"dm", 10.0}, {"cm", 100.0}, {"mm", 1000.0}, {"in", 1.0 / 0.0254}};
    const sn_bone_template *t = template("humerus");
    sn_box3 box = sn_tri_mesh_bounds(&t->bone);
    double own = box.max.x - box.min.x, length = sn_v3_dist(t->from, t->to);
    for (size_t k = 0; k < sizeof unit / sizeof *unit; k++) {
        sn_scene *s = new_scene(unit[k].unit, SN_UP_Y);
        double u = unit[k].per_metre;
        sn_pick from = at(0, 0.5 * u, 0), to = at(0, 0, 0);
        const sn_cylinder_placing opt[] = {{.proportion = 0.0}, {.proportion = 1.25}, {.is_kept = true}};
        const char *const name[] = {"a_l", "b_l", "c_l"};
        for (int i = 0; i < 3; i++) {
            sn_bone_placing p = {.name = name[i], .from_template = t};
            ok(sn_scene_place_cylinder(s, &p, &from, &to, &opt[i], NULL, NULL, &err));
        }
        assert_near(thickness_of(s, 0), own * 0.5 * u / length, 1e-9 * u);
        assert_near(thickness_of(s, 1), 1.25 * own * 0.5 * u / length, 1e-9 * u);
        assert_near(thickness_of(s, 2), own * u, 1e-9 * u);
        sn_scene_destroy(s);
    }
    sn_scene *s = new_scene("furlong", SN_UP_Y);
    sn_bone_placing p = {.name = "a", .from_template = t},
                    q = {.name = "b", .from_template = template("skull")};
    sn_pick from = at(0, 0.5, 0), to = at(0, 0, 0);
    assert_error(
        sn_scene_place_cylinder(s, &p, &from, &to, &(sn_cylinder_placing){.is_kept = true}, NULL, NULL, &err),
        "bone 'a': how long a metre is in the scene's unit 'furlong' is not known (known: m, dm, cm, mm, "
        "km, in, ft)");
    assert_error(sn_scene_place_shape(s, &q, &to, &(sn_shape_options){0}, NULL, NULL, NULL, &err),
                 "'furlong'");
    ok(sn_scene_place_cylinder(s, &p, &from, &to, &(sn_cylinder_placing){0}, NULL, NULL, &err)); /* no need */
    sn_scene_destroy(s);
}

static void a_row_is_one_bone_of_many_pieces(void **state)
{
    (void)state;
    sn_scene *s = new_scene("mm", SN_UP_Y);
    static const double line[] = {0, 0, 0, 0, 185, 0};
    const sn_bone_template *t = template("lumbar");
    sn_bone_placing p = {.name = "lumbar_spine", .from_template = t};
    sn_curve_report r;
    int32_t n_piece, n;
    ok(sn_scene_place_row(s, &p, line, 2, &(sn_curve_options){.count = 5}, NULL, &r, &n_piece, NULL, &err));
    assert_int_equal(n_piece, 5);
    assert_near(r.fill, 1.0, 0.0); /* at their own length no two cross */
    assert_near(r.spacing, 37.0, 1e-9);
    const sn_tri_mesh *m = sn_scene_bone_mesh(s, 0);
    assert_int_equal(m->n_vert, 5 * t->bone.n_vert);
    assert_near(sn_tri_mesh_volume(m), 5e9 * sn_tri_mesh_volume(&t->bone), 1e-3);
    (void)sn_scene_bone_landmarks(s, 0, &n);
    assert_int_equal(n, 5 * t->n_landmark);
    sn_vec3 step = sn_v3_sub(landmark(s, 0, "spinous_5"), landmark(s, 0, "spinous_1"));
    assert_at(step, sn_v3(0, 148, 0), 1e-9);
    assert_false(sn_scene_bone_ends(s, 0, &step, &step));
    assert_error(sn_scene_bone_landmark(s, 0, "spinous", &(sn_landmark){0}, &err),
                 "did you mean 'spinous_1'?");
    p.name = "more";
    assert_error(sn_scene_place_row(s, &p, line, 2, &(sn_curve_options){0}, NULL, &r, &n_piece, NULL, &err),
                 "bone 'more': bone template 'lumbar': count is 0 and spacing is 0, need one of them");
    sn_scene_destroy(s);
}

/* +y of the template goes up, +z to the front, whichever axis of the scene is up. */
static void bones_stand_upright(void **state)
{
    (void)state;
    sn_scene *y = new_scene("m", SN_UP_Y), *z = new_scene("m", SN_UP_Z);
    place_at(y, "skull", "skull", sn_v3(0.5, 1.5, 0.25));
    place_at(z, "skull", "skull", sn_v3(0.5, -0.25, 1.5));
    place_between(y, "tibia_l", "tibia", sn_v3(0, 0.5, 0), sn_v3(0, 0.1, 0));
    place_between(z, "tibia_l", "tibia", sn_v3(0, 0, 0.5), sn_v3(0, 0, 0.1));
    for (int32_t i = 0; i < 2; i++) {
        const sn_tri_mesh *a = sn_scene_bone_mesh(y, i), *b = sn_scene_bone_mesh(z, i);
        for (int32_t v = 0; v < a->n_vert; v++) {
            sn_vec3 p = sn_tri_mesh_point(a, v);
            assert_at(sn_tri_mesh_point(b, v), sn_v3(p.x, -p.z, p.y), 1e-15);
        }
    }
    assert_true(landmark(z, 0, "vertex").z > 1.6 && landmark(z, 0, "glabella").y < -0.33);
    assert_true(landmark(z, 1, "tibial_tuberosity").y < 0.0);
    sn_scene_destroy(y);
    sn_scene_destroy(z);
}

/* ---- edits ---- */

static void landmarks_and_ends_go_along(void **state)
{
    (void)state;
    sn_scene *s = new_scene("m", SN_UP_Y);
    const char *name = "greater_trochanter";
    int32_t i = place_between(s, "femur_l", "femur", sn_v3(0.1, 0.9, 0), sn_v3(0.1, 0.4, 0));
    uint64_t h = 4;
    for (int step = 0; step < 20; step++) {
        sn_landmark before, after;
        sn_vec3 from[2], to[2], axis = {made_random(&h), made_random(&h), made_random(&h) + 0.1};
        double volume = sn_tri_mesh_volume(sn_scene_bone_mesh(s, i)), k = 0.5 + made_random(&h);
        sn_affine map = sn_affine_after(sn_affine_rotation(axis, 360.0 * made_random(&h), sn_v3(0.1, 0.4, 0)),
                                        sn_affine_scale(k, axis));
        uint64_t revision = sn_scene_revision(s);
        ok(sn_scene_bone_landmark(s, i, name, &before, &err));
        assert_true(sn_scene_bone_ends(s, i, &from[0], &to[0]));
        ok(sn_scene_map_bone(s, i, &map, &err));
        ok(sn_scene_bone_landmark(s, i, name, &after, &err));
        assert_true(sn_scene_bone_ends(s, i, &from[1], &to[1]));
        assert_true(sn_scene_revision(s) > revision);
        assert_at(after.at, sn_affine_point(&map, before.at), 1e-12);
        assert_near(after.radius, k * before.radius, 1e-12);
        assert_at(from[1], sn_affine_point(&map, from[0]), 1e-12);
        assert_at(to[1], sn_affine_point(&map, to[0]), 1e-12);
        double now = sn_tri_mesh_volume(sn_scene_bone_mesh(s, i));
        assert_near(now / volume, k * k * k, 1e-9);
        assert_true(distance_to_bone(s, i, after.at) < 1e-6 * sn_v3_dist(from[1], to[1]));
    }
    sn_scene_destroy(s);
}

static void ends_are_set(void **state)
{
    (void)state;
    sn_scene *s = new_scene("m", SN_UP_Y);
    int32_t i = place_between(s, "radius_l", "radius", sn_v3(0, 0.25, 0), sn_v3(0, 0, 0));
    double volume = sn_tri_mesh_volume(sn_scene_bone_mesh(s, i));
    static const sn_vec3 end[][2] = {{{0, 0.5, 0}, {0, 0, 0}}, /* twice as long */
                                     {{1, 2, 3}, {1.5, 2, 3}}, /* across        */
                                     {{2, 2, 3}, {1.5, 2, 3}}, /* the other way */
                                     {{0, 0.25, 0}, {0, 0, 0}}};
    static const double thickness[] = {1.0, 0.5, 2.0, 1.0};
    double across = 1.0;
    for (int k = 0; k < 4; k++) {
        sn_vec3 from, to;
        ok(sn_scene_set_bone_ends(s, i, end[k][0], end[k][1], thickness[k], &err));
        assert_true(sn_scene_bone_ends(s, i, &from, &to));
        assert_at(from, end[k][0], 1e-14);
        assert_at(to, end[k][1], 1e-14);
        across *= thickness[k];
        double want = volume * across * across * sn_v3_dist(from, to) / 0.25;
        assert_near(sn_tri_mesh_volume(sn_scene_bone_mesh(s, i)) / want, 1.0, 1e-12);
        assert_true(distance_to_bone(s, i, landmark(s, i, "radial_tuberosity")) < 1e-6);
    }
    int32_t skull = place_at(s, "skull", "skull", sn_v3(0, 0, 0));
    sn_vec3 a = {0, 0, 0}, b = {0, 1, 0};
    assert_error(sn_scene_set_bone_ends(s, skull, a, b, 1.0, &err),
                 "bone 'skull' has no ends: only bones placed between two points have");
    assert_error(sn_scene_set_bone_ends(s, i, a, a, 1.0, &err),
                 "bone 'radius_l': its ends are 0 apart, need > 0");
    assert_error(sn_scene_set_bone_ends(s, i, a, sn_v3(NAN, 0, 0), 1.0, &err), "need > 0");
    assert_error(sn_scene_set_bone_ends(s, i, a, b, 0.0, &err), "bone 'radius_l': thickness is 0, need > 0");
    assert_error(sn_scene_set_bone_ends(s, i, a, b, NAN, &err), "thickness is");
    sn_scene_destroy(s);
}

static void landmarks_are_set(void **state)
{
    (void)state;
    sn_scene *s = new_scene("m", SN_UP_Y);
    sn_tri_mesh box = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1));
    sn_landmark l = {.radius = -7};
    int32_t n;
    ok(sn_scene_add_bone(s, "box", &box, &err));
    (void)sn_scene_bone_landmarks(s, 0, &n);
    assert_int_equal(n, 0);
    assert_error(sn_scene_bone_landmark(s, 0, "tip", &l, &err),
                 "bone 'box' has no landmark 'tip' (it has 0: bone:landmarks() lists them)");
    ok(sn_scene_set_landmark(s, 0, "tip", sn_v3(1, 1, 1), 0.1, &err));
    ok(sn_scene_set_landmark(s, 0, "side", sn_v3(1, 0.5, 0.5), 0.0, &err));
    ok(sn_scene_set_landmark(s, 0, "tip", sn_v3(0, 1, 1), 0.2, &err));
    (void)sn_scene_bone_landmarks(s, 0, &n);
    assert_int_equal(n, 2);
    ok(sn_scene_bone_landmark(s, 0, "tip", &l, &err));
    assert_at(l.at, sn_v3(0, 1, 1), 0.0);
    assert_near(l.radius, 0.2, 0.0);
    assert_error(sn_scene_bone_landmark(s, 0, "sid", &l, &err), "no landmark 'sid' (did you mean 'side'?)");
    assert_error(sn_scene_set_landmark(s, 0, "", sn_v3(0, 0, 0), 0, &err), "name of a landmark has 0 bytes");
    assert_error(sn_scene_set_landmark(s, 0, "a/b", sn_v3(0, 0, 0), 0, &err), "name of landmark 'a/b' holds");
    assert_error(sn_scene_set_landmark(s, 0, "tip", sn_v3(NAN, 0, 0), 0, &err), "tip");
    assert_error(sn_scene_set_landmark(s, 0, "tip", sn_v3(0, 0, 0), -1, &err), "tip");
    sn_tri_mesh_free(&box);
    sn_scene_destroy(s);
}

/* ---- the margin to the skin ---- */

static void bones_keep_clear_of_the_skin(void **state)
{
    (void)state;
    sn_scene *s = boxed_scene();
    sn_bone_placing p = {.name = "fibula_l", .from_template = template("fibula")};
    sn_pick from = at(0.985, 0.4, 0), to = at(0.985, 0, 0);
    sn_clearance_report r = {0};
    sn_clearance c;
    ok(sn_scene_place_cylinder(s, &p, &from, &to, &(sn_cylinder_placing){0}, NULL, NULL, &err));
    ok(sn_scene_bone_clearance(s, 0, 0.02, NULL, &c, &err));
    assert_true(c.least < 0.02 && c.n_near > 0);
    p.name = "fibula_2_l";
    p.margin = 0.02;
    ok(sn_scene_place_cylinder(s, &p, &from, &to, &(sn_cylinder_placing){0}, NULL, &r, &err));
    assert_int_equal(r.before.n_near, c.n_near);
    assert_near(r.before.least, c.least, 0.0);
    ok(sn_scene_bone_clearance(s, 1, 0.02, NULL, &c, &err));
    assert_int_equal(c.n_out + c.n_near, 0);
    assert_true(c.least >= 0.02 && r.moved >= 0.02 - r.before.least - 1e-12);
    ok(sn_scene_keep_bone_clear(s, 0, 0.02, NULL, &r, &err)); /* afterwards: the same */
    assert_same_mesh(sn_scene_bone_mesh(s, 0), sn_scene_bone_mesh(s, 1), 0.0);
    p.name = "fibula_3_l";
    p.margin = 0.4; /* thicker than the box */
    assert_error(sn_scene_place_cylinder(s, &p, &from, &to, &(sn_cylinder_placing){0}, NULL, NULL, &err),
                 "0.4");
    assert_int_equal(sn_scene_bone_count(s), 2);
    assert_error(sn_scene_keep_bone_clear(s, 0, 0.4, NULL, &r, &err), "bone 'fibula_l': ");
    assert_same_mesh(sn_scene_bone_mesh(s, 0), sn_scene_bone_mesh(s, 1), 0.0);
    sn_scene_destroy(s);
    s = new_scene("m", SN_UP_Y);
    p.margin = 0.01;
    assert_error(sn_scene_place_cylinder(s, &p, &from, &to, &(sn_cylinder_placing){0}, NULL, NULL, &err),
                 "a margin needs a skin and the scene has none: set_skin first");
    place_at(s, "skull", "skull", sn_v3(0, 0, 0));
    assert_error(sn_scene_bone_clearance(s, 0, 0, NULL, &c, &err), "clearance needs a skin");
    assert_error(sn_scene_keep_bone_clear(s, 0, 0.1, NULL, &r, &err), "a margin needs a skin");
    sn_scene_destroy(s);
}

/* ---- errors ---- */

static void errors_leave_the_scene_as_it_was(void **state)
{
    (void)state;
    sn_scene *s = boxed_scene();
    sn_affine flat = sn_affine_identity(), wild = flat;
    sn_pick a = at(0, 0.4, 0), b = at(0, 0, 0), nowhere = at(0, INFINITY, 0);
    sn_bone_placing bone = {.name = "femur_l", .from_template = template("femur")}, skull = bone, bad = bone;
    int32_t i = place_between(s, "femur_l", "femur", a.origin, b.origin);
    skull.from_template = template("skull");
    bad.name = "a/b";
    flat.col[1] = flat.col[0];
    wild.t.x = NAN;
    uint64_t revision = sn_scene_revision(s);
    const sn_cylinder_placing none = {0};
    const sn_shape_options plain = {0};
    assert_error(sn_scene_place_cylinder(s, &bone, &a, &b, &none, NULL, NULL, &err),
                 "there is a bone 'femur_l'");
    assert_error(sn_scene_place_cylinder(s, &bad, &a, &b, &none, NULL, NULL, &err),
                 "name of bone 'a/b' holds");
    assert_error(sn_scene_place_shape(s, &skull, &a, &plain, NULL, NULL, NULL, &err),
                 "there is a bone 'femur_l'");
    skull.name = bone.name = "new";
    assert_error(sn_scene_place_cylinder(s, &bone, &a, &a, &none, NULL, NULL, &err), "bone 'new': ");
    assert_error(sn_scene_place_cylinder(s, &bone, &nowhere, &b, &none, NULL, NULL, &err),
                 "bone 'new': from: pick: the point is not finite");
    assert_error(sn_scene_place_cylinder(s, &skull, &a, &b, &none, NULL, NULL, &err), "bone 'new': ");
    assert_error(sn_scene_place_cylinder(s, &bone, &a, &b,
                                         &(sn_cylinder_placing){.proportion = 1, .map = {.twist_deg = NAN}},
                                         NULL, NULL, &err),
                 "bone 'new': ");
    assert_error(sn_scene_place_shape(s, &skull, &a, &(sn_shape_options){.size = -1}, NULL, NULL, NULL, &err),
                 "bone 'new': size is -1, need > 0");
    assert_error(sn_scene_place_shape(s, &bone, &a, &(sn_shape_options){.is_fitted = true}, NULL,
                                      &(sn_fit_result){0}, NULL, &err),
                 "bone 'new': template 'femur' has no cage and skin to be fitted by");
    assert_error(sn_scene_map_bone(s, i, &flat, &err),
                 "bone 'femur_l': the map is not finite, or flattens the bone");
    assert_error(sn_scene_map_bone(s, i, &wild, &err), "the map is not finite");
    assert_error(sn_scene_remove_bone(s, "femur_r", &err), "did you mean 'femur_l'?");
    assert_int_equal(sn_scene_revision(s), revision);
    assert_int_equal(sn_scene_bone_count(s), 1);
    sn_scene_destroy(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_bone_lies_between_its_ends),
        cmocka_unit_test(rays_pick_the_middle_of_the_skin),
        cmocka_unit_test(thickness_goes_with_the_length_or_is_kept),
        cmocka_unit_test(a_row_is_one_bone_of_many_pieces),
        cmocka_unit_test(bones_stand_upright),
        cmocka_unit_test(landmarks_and_ends_go_along),
        cmocka_unit_test(ends_are_set),
        cmocka_unit_test(landmarks_are_set),
        cmocka_unit_test(bones_keep_clear_of_the_skin),
        cmocka_unit_test(errors_leave_the_scene_as_it_was),
    };
    return cmocka_run_group_tests(tests, make_library, free_library);
}
