/* test_scene_cut - half models: what is left of skin, bones and body, and that the cap changes nothing. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "asserts.h"
#include "made_mesh.h"
#include "mesh/mesh_check.h"
#include "mesh/tri_cut.h"
#include "scene/scene_bones.h"

/* Small steps by the thousand: other tests run beside this one. */
static const sn_run one_thread = {.n_threads = 1};
static const sn_vec3 zero = {0, 0, 0}, x_axis = {1, 0, 0};

/* ---- a trunk, symmetric in x: a skin, a spine in the plane, a leg bone on each side ---- */

enum { SPINE, LEFT, RIGHT, n_bones };
static sn_tri_mesh skin, bone[n_bones];
static const char *const bone_name[] = {"spine", "leg_l", "leg_r"};

/* The surface with its image for what lies on the other side: symmetric to the bit. */
static sn_tri_mesh symmetric(sn_tri_mesh *m)
{
    sn_tri_mesh half, image;
    sn_tri_mesh_init(&half);
    ok(sn_tri_mesh_cut(m, zero, x_axis, 0, NULL, &half, NULL, &err));
    int32_t n_face = 0;
    for (int32_t f = 0; f < half.n_face; f++) { /* without the cap */
        const int32_t *v = half.face + 3 * (size_t)f;
        if (half.pos[3 * v[0]] == 0.0 && half.pos[3 * v[1]] == 0.0 && half.pos[3 * v[2]] == 0.0) continue;
        memmove(half.face + 3 * (size_t)n_face++, v, 3 * sizeof *v);
    }
    half.n_face = n_face;
    sn_tri_mesh_init(&image);
    ok(sn_tri_mesh_copy(&image, &half, &err));
    ok(sn_tri_mesh_mirror(&image, zero, x_axis, &err));
    append_mesh(&half, &image, 0);
    ok(sn_tri_mesh_weld(&half, NULL, &err));
    sn_tri_mesh_free(m);
    return half;
}

/* Without the vertices that no face uses. */
static void drop_unused(sn_tri_mesh *m)
{
    sn_tri_mesh out;
    int32_t n = 0, *to = malloc((size_t)m->n_vert * sizeof *to);
    for (int32_t v = 0; v < m->n_vert; v++) to[v] = -1;
    for (size_t c = 0; c < 3 * (size_t)m->n_face; c++) to[m->face[c]] = 0;
    for (int32_t v = 0; v < m->n_vert; v++)
        if (to[v] == 0) to[v] = n++;
    sn_tri_mesh_init(&out);
    ok(sn_tri_mesh_reserve(&out, n, m->n_face, &err));
    for (int32_t v = 0; v < m->n_vert; v++)
        if (to[v] >= 0) memcpy(out.pos + 3 * (size_t)to[v], m->pos + 3 * (size_t)v, 3 * sizeof *m->pos);
    for (size_t c = 0; c < 3 * (size_t)m->n_face; c++) out.face[c] = to[m->face[c]];
    free(to);
    sn_tri_mesh_free(m);
    *m = out;
}

static int make_surfaces(void **state)
{
    (void)state;
    skin = made_capsule(sn_v3(0, -1, 0), sn_v3(0, 1, 0), 0.8, 0.25);
    bone[SPINE] = made_capsule(sn_v3(0, -0.6, -0.4), sn_v3(0, 0.9, -0.4), 0.12, 0.1);
    skin = symmetric(&skin);
    bone[SPINE] = symmetric(&bone[SPINE]);
    drop_unused(&skin);
    drop_unused(&bone[SPINE]);
    bone[LEFT] = made_capsule(sn_v3(0.35, -1.1, 0), sn_v3(0.35, -0.3, 0), 0.12, 0.1);
    sn_tri_mesh_init(&bone[RIGHT]);
    ok(sn_tri_mesh_copy(&bone[RIGHT], &bone[LEFT], &err));
    ok(sn_tri_mesh_mirror(&bone[RIGHT], zero, x_axis, &err));
    return 0;
}

static int free_surfaces(void **state)
{
    (void)state;
    sn_tri_mesh_free(&skin);
    for (int i = 0; i < n_bones; i++) sn_tri_mesh_free(&bone[i]);
    return 0;
}

static sn_scene *trunk(void)
{
    sn_scene *s = NULL;
    ok(sn_scene_create(&s, "trunk", "m", SN_UP_Y, &err));
    ok(sn_scene_set_skin(s, &skin, &err));
    for (int i = 0; i < n_bones; i++) ok(sn_scene_add_bone(s, bone_name[i], &bone[i], &err));
    return s;
}

static void assert_same_mesh(const sn_tri_mesh *a, const sn_tri_mesh *b)
{
    assert_int_equal(a->n_vert, b->n_vert);
    assert_int_equal(a->n_face, b->n_face);
    assert_memory_equal(a->pos, b->pos, 3 * (size_t)a->n_vert * sizeof *a->pos);
    assert_memory_equal(a->face, b->face, 3 * (size_t)a->n_face * sizeof *a->face);
}

static void assert_same_scene(const sn_scene *a, const sn_scene *b)
{
    assert_same_mesh(sn_scene_skin(a), sn_scene_skin(b));
    assert_int_equal(sn_scene_bone_count(a), sn_scene_bone_count(b));
    for (int32_t i = 0; i < sn_scene_bone_count(a); i++)
        assert_same_mesh(sn_scene_bone_mesh(a, i), sn_scene_bone_mesh(b, i));
}

/* ---- surfaces ---- */

static void assert_clean_half(const sn_tri_mesh *m, sn_vec3 point, sn_vec3 normal, double on_plane)
{
    sn_mesh_check c;
    int32_t n_on = 0;
    ok(sn_mesh_check_run(&c, m, NULL, &err));
    assert_true(c.closed && c.manifold && c.oriented && c.self_intersections == 0);
    for (int32_t v = 0; v < m->n_vert; v++) {
        double h = sn_v3_dot(sn_v3_sub(sn_tri_mesh_point(m, v), point), sn_v3_unit(normal));
        assert_true(h >= -on_plane);
        n_on += h <= on_plane;
    }
    assert_true(n_on > 5);
}

static void both_halves_make_the_whole(void **state)
{
    (void)state;
    static const struct {
        sn_vec3 point, normal;
        double on_plane;
    } cut[] = {{{0, 0, 0}, {1, 0, 0}, 0.0},    /* of symmetry: halves */
               {{9, 0.3, 9}, {0, -4, 0}, 0.0}, /* across an axis: the exact coordinate */
               {{0, 0.1, -0.1}, {1, 2, -0.5}, 1e-9}};
    for (size_t k = 0; k < sizeof cut / sizeof *cut; k++) {
        sn_scene *s = trunk();
        double volume[2];
        sn_vec3 back = sn_v3_scale(-1.0, cut[k].normal), point, normal;
        for (int side = 0; side < 2; side++) {
            ok(sn_scene_cut(s, cut[k].point, side ? back : cut[k].normal, &err));
            volume[side] = sn_tri_mesh_volume(sn_scene_skin(s));
            assert_clean_half(sn_scene_skin(s), cut[k].point, side ? back : cut[k].normal, cut[k].on_plane);
        }
        assert_true(sn_scene_cut_plane(s, &point, &normal));
        assert_true(sn_v3_dist(normal, back) == 0.0 && sn_v3_dist(point, cut[k].point) == 0.0);
        double whole = sn_tri_mesh_volume(&skin);
        assert_near(volume[0] + volume[1], whole, 1e-12 * whole);
        if (k == 0) {
            assert_near(volume[0], volume[1], 1e-12 * whole);
            assert_near(sn_tri_mesh_volume(sn_scene_bone_mesh(s, SPINE)),
                        0.5 * sn_tri_mesh_volume(&bone[SPINE]), 1e-12);
        }
        sn_scene_uncut(s);
        assert_false(sn_scene_cut_plane(s, &point, &normal));
        sn_scene_destroy(s);
    }
}

static void uncut_brings_all_back(void **state)
{
    (void)state;
    sn_scene *s = trunk(), *whole = trunk();
    uint64_t revision = sn_scene_revision(s);
    sn_scene_uncut(s); /* not cut: nothing */
    assert_int_equal(sn_scene_revision(s), revision);
    ok(sn_scene_cut(s, zero, x_axis, &err));
    assert_int_equal(sn_scene_bone_mesh(s, RIGHT)->n_face, 0);
    assert_same_mesh(sn_scene_bone_mesh(s, LEFT), &bone[LEFT]);
    ok(sn_scene_cut(s, sn_v3(0, 0.2, 0), sn_v3(0, 1, 0), &err)); /* of the whole, not of the half */
    assert_int_equal(sn_scene_bone_mesh(s, LEFT)->n_face, 0);
    assert_near(sn_tri_mesh_bounds(sn_scene_skin(s)).min.x, sn_tri_mesh_bounds(&skin).min.x, 0.0);
    assert_true(sn_scene_revision(s) > revision);
    sn_scene_uncut(s);
    assert_same_scene(s, whole);
    sn_scene_destroy(s);
    sn_scene_destroy(whole);
}

/* Edits of a half model and then a cut, or the other way round: one result. */
static void edits_see_the_whole(void **state)
{
    (void)state;
    sn_scene *after = trunk(), *before = trunk();
    sn_tri_mesh other = made_capsule(sn_v3(0, -1, 0), sn_v3(0, 1, 0), 0.9, 0.3);
    sn_tri_mesh rib = made_capsule(sn_v3(-0.3, 0.5, 0.3), sn_v3(0.3, 0.5, 0.3), 0.05, 0.05);
    sn_affine map = sn_affine_after(sn_affine_translation(sn_v3(-0.3, 0.1, 0)),
                                    sn_affine_rotation(sn_v3(0, 0, 1), 20, zero));
    sn_scene *const s[] = {before, after};
    ok(sn_scene_cut(before, zero, x_axis, &err));
    for (int k = 0; k < 2; k++) {
        ok(sn_scene_set_skin(s[k], &other, &err));
        ok(sn_scene_add_bone(s[k], "rib", &rib, &err));
        ok(sn_scene_map_bone(s[k], LEFT, &map, &err)); /* now across the plane */
        ok(sn_scene_remove_bone(s[k], "leg_r", &err));
    }
    ok(sn_scene_cut(after, zero, x_axis, &err));
    assert_same_scene(before, after);
    assert_near(sn_tri_mesh_bounds(sn_scene_bone_mesh(before, 2)).min.x, 0.0, 0.0);
    sn_scene_uncut(before);
    sn_scene_uncut(after);
    assert_same_scene(before, after);
    assert_same_mesh(sn_scene_bone_mesh(before, 2), &rib);
    sn_tri_mesh_free(&other);
    sn_tri_mesh_free(&rib);
    sn_scene_destroy(before);
    sn_scene_destroy(after);
}

static void a_bone_of_one_side_can_be_mirrored(void **state)
{
    (void)state;
    sn_scene *s = trunk();
    int32_t n_added, n_replaced;
    ok(sn_scene_remove_bone(s, "leg_r", &err));
    ok(sn_scene_cut(s, zero, x_axis, &err));
    ok(sn_scene_mirror_bones(s, zero, x_axis, &n_added, &n_replaced, &err));
    assert_int_equal(n_added, 1);
    assert_int_equal(sn_scene_bone_mesh(s, RIGHT)->n_face, 0); /* it is on the other side */
    sn_scene_uncut(s);
    assert_same_mesh(sn_scene_bone_mesh(s, RIGHT), &bone[RIGHT]);
    sn_scene_destroy(s);
}

/* ---- the body ---- */

static sn_body_report mesh(sn_scene *s, double edge_length)
{
    sn_body_report r = {0};
    ok(sn_scene_tetrahedralize(s, &(sn_body_options){.edge_length = edge_length}, NULL, &r, &err));
    return r;
}

/* Faces in the plane are the cap, and no others: neither skin nor bone. */
static void the_cap_is_neither_skin_nor_bone(void **state)
{
    (void)state;
    static const sn_vec3 normal[] = {{1, 0, 0}, {1, 0.5, 0.25}};
    for (int k = 0; k < 2; k++) {
        sn_scene *s = trunk();
        double area = 0.0, label_area[5] = {0}, on_plane = k ? 1e-9 : 0.0;
        ok(sn_scene_cut(s, zero, normal[k], &err));
        mesh(s, 0.25);
        const sn_body *b = sn_scene_body(s);
        assert_int_equal(b->n_bone, 3);
        for (int32_t i = 0; i < 4 * b->mesh.n_tet; i++) {
            if (!sn_body_is_boundary(b->across[i])) continue;
            sn_vec3 p[3];
            int n_on = 0, label = sn_body_label(b->across[i]);
            for (int c = 0, n = 0; c < 4; c++) {
                if (c == i % 4) continue;
                p[n] = sn_tet_mesh_point(&b->mesh, b->mesh.tet[i - i % 4 + c]);
                n_on += fabs(sn_v3_dot(p[n++], sn_v3_unit(normal[k]))) <= on_plane;
            }
            assert_in_range(label, 0, SN_LABEL_CAP(3));
            assert_int_equal(n_on == 3, label == SN_LABEL_CAP(3));
            double a = 0.5 * sn_v3_len(sn_v3_cross(sn_v3_sub(p[1], p[0]), sn_v3_sub(p[2], p[0])));
            label_area[label] += a;
            area += a;
            assert_int_equal(sn_body_bone(b, b->across[i]), label >= 1 && label <= 3 ? label - 1 : -1);
        }
        assert_true(label_area[SN_LABEL_SKIN] > 4.0 && label_area[SN_LABEL_BONE(LEFT)] > 0.3);
        if (k == 0) {
            double cap = 2 * 0.8 * 2.0 + TEST_PI * 0.64 - (0.24 * 1.5 + TEST_PI * 0.0144);
            assert_near(label_area[SN_LABEL_CAP(3)], cap, 0.03 * cap);
            assert_near(label_area[SN_LABEL_BONE(RIGHT)], 0.0, 0.0); /* on the other side */
        }
        assert_true(area > 0.0);
        sn_scene_destroy(s);
    }
}

static void the_body_is_half_as_large(void **state)
{
    (void)state;
    sn_scene *s = trunk();
    mesh(s, 0.25);
    double whole = sn_tet_mesh_volume(&sn_scene_body(s)->mesh);
    ok(sn_scene_cut(s, zero, x_axis, &err));
    assert_null(sn_scene_body(s)); /* stale */
    mesh(s, 0.25);
    assert_near(sn_tet_mesh_volume(&sn_scene_body(s)->mesh), 0.5 * whole, 0.005 * whole);
    sn_scene_uncut(s);
    assert_null(sn_scene_body(s));
    mesh(s, 0.25);
    assert_near(sn_tet_mesh_volume(&sn_scene_body(s)->mesh), whole, 1e-12 * whole);
    sn_scene_destroy(s);
}

/* A muscle on each side: near the plane the half has the fields of the whole. What is symmetric has no slope
 * across the plane, which is the cap's natural condition; were the cap skin, the fields would be 0 there. The
 * half's muscle of the left stands for itself and its image. */
static void the_fields_are_those_of_the_whole(void **state)
{
    (void)state;
    static const double left[] = {0.4, -0.6, 0.2, 0.45, 0, 0.25, 0.35, 0.7, 0.2};
    sn_scene *s[2] = {trunk(), trunk()};
    double right[9], worst = 0.0, sum = 0.0, largest = 0.0, fat = 0.0;
    int n = 0;
    for (int k = 0; k < 9; k++) right[k] = k % 3 ? left[k] : -left[k];
    ok(sn_scene_cut(s[1], zero, x_axis, &err));
    for (int k = 0; k < 2; k++) {
        ok(sn_scene_add_muscle(s[k], "rectus_l", left, NULL, 3, &err));
        if (k == 0) ok(sn_scene_add_muscle(s[k], "rectus_r", right, NULL, 3, &err));
        mesh(s[k], 0.12);
    }
    for (double x = 1e-6; x < 0.15; x += 0.04)
        for (double y = -0.7; y < 0.8; y += 0.1)
            for (double z = -0.2; z < 0.7; z += 0.1) {
                double a[3], b[2];
                bool in_whole, in_half;
                ok(sn_scene_values_at(s[0], sn_v3(x, y, z), &one_thread, a, &in_whole, &err));
                ok(sn_scene_values_at(s[1], sn_v3(x, y, z), &one_thread, b, &in_half, &err));
                if (!in_whole || !in_half) continue;
                worst = fmax(worst, fabs(a[1] + a[2] - b[1]));
                sum += a[1] + a[2] - b[1];
                fat = fmax(fat, fabs(a[0] - b[0]));
                largest = fmax(largest, b[1]);
                n++;
            }
    assert_true(n > 300);
    assert_true(largest > 0.4);
    /* Without bones, wholes meshed 4 % finer or coarser differ by 0.04, by 0.008 in the mean: a curve pins
     * the more the coarser the tets around it are. */
    if (!(worst < 0.1) || !(fabs(sum / n) < 0.04) || !(fat < 0.03))
        fail_msg("muscle differs by %g, %g in the mean, fat by %g", worst, sum / n, fat);
    sn_scene_destroy(s[0]);
    sn_scene_destroy(s[1]);
}

/* ---- what cannot be cut ---- */

static void errors_leave_the_scene_as_it_was(void **state)
{
    (void)state;
    sn_scene *s = trunk(), *cut = trunk();
    sn_tri_mesh open;
    sn_vec3 point, normal, far = {5, 0, 0};
    sn_scene *none = NULL;
    ok(sn_scene_create(&none, "none", "m", SN_UP_Y, &err));
    assert_error(sn_scene_cut(none, zero, x_axis, &err), "the scene has no skin: set_skin first");
    sn_scene_destroy(none);
    ok(sn_scene_cut(cut, zero, x_axis, &err));
    ok(sn_scene_cut(s, zero, x_axis, &err));
    uint64_t revision = sn_scene_revision(s);
    assert_error(sn_scene_cut(s, far, x_axis, &err),
                 "cut: the plane misses the surface, which lies between -5.79776 and "
                 "-4.20224 along the normal: nothing would be left");
    assert_error(sn_scene_cut(s, far, sn_v3(-1, 0, 0), &err), "nothing would be cut off");
    assert_error(sn_scene_cut(s, zero, zero, &err),
                 "cut: the plane needs a finite point and a normal that is not zero");
    assert_error(sn_scene_cut(s, sn_v3(NAN, 0, 0), x_axis, &err), "finite point");
    sn_tri_mesh_init(&open);
    ok(sn_tri_mesh_copy(&open, &bone[SPINE], &err));
    open.n_face--;
    assert_error(sn_scene_add_bone(s, "open", &open, &err),
                 "bone 'open': cut: the surface is not closed: 3 edges have "
                 "only one face");
    assert_int_equal(sn_scene_revision(s), revision);
    assert_true(sn_scene_cut_plane(s, &point, &normal));
    assert_true(sn_v3_dist(normal, x_axis) == 0.0);
    assert_same_scene(s, cut);
    sn_scene_uncut(s); /* an open bone in a whole model, then a cut through it */
    ok(sn_scene_add_bone(s, "open", &open, &err));
    revision = sn_scene_revision(s);
    assert_error(sn_scene_cut(s, zero, x_axis, &err), "bone 'open': cut: the surface is not closed");
    assert_false(sn_scene_cut_plane(s, &point, &normal));
    assert_int_equal(sn_scene_revision(s), revision);
    ok(sn_scene_cut(s, sn_v3(0, 1.5, 0), sn_v3(0, 1, 0), &err)); /* not through it */
    sn_tri_mesh_free(&open);
    sn_scene_destroy(s);
    sn_scene_destroy(cut);
}

static void short_of_memory(void **state)
{
    (void)state;
    for (int left = 0;; left++) {
        sn_scene *s = trunk();
        sn_vec3 point, normal;
        ration r = {.left = left};
        uint64_t revision = sn_scene_revision(s);
        sn_set_allocator(RATION(r));
        sn_status st = sn_scene_cut(s, zero, x_axis, NULL);
        r.left = -1; /* enough from here */
        assert_int_equal(sn_scene_cut_plane(s, &point, &normal), st == SN_OK);
        if (st) {
            assert_int_equal(st, SN_ENOMEM);
            assert_int_equal(sn_scene_revision(s), revision);
            assert_int_equal(r.in_use, 0);
        }
        sn_scene_destroy(s);
        sn_set_allocator(NULL);
        if (!st) break;
        assert_true(left < 2000);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_halves_make_the_whole),
        cmocka_unit_test(uncut_brings_all_back),
        cmocka_unit_test(edits_see_the_whole),
        cmocka_unit_test(a_bone_of_one_side_can_be_mirrored),
        cmocka_unit_test(the_cap_is_neither_skin_nor_bone),
        cmocka_unit_test(the_body_is_half_as_large),
        cmocka_unit_test(the_fields_are_those_of_the_whole),
        cmocka_unit_test(errors_leave_the_scene_as_it_was),
        cmocka_unit_test(short_of_memory),
    };
    return cmocka_run_group_tests(tests, make_surfaces, free_surfaces);
}
