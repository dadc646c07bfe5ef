/* test_place - picks, and bones between two joints. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "asserts.h"
#include "failing_memory.h"
#include "made_mesh.h"
#include "skeleton/place.h"

/* ---- picks ---- */

static sn_bvh *tree_of(sn_tri_mesh *m) /* frees m */
{
    sn_bvh *b = NULL;
    assert_int_equal(sn_bvh_create(&b, m, NULL), SN_OK);
    sn_tri_mesh_free(m);
    return b;
}

static sn_vec3 random_direction(uint64_t *h)
{
    sn_vec3 d;
    do d = sn_v3(2 * made_random(h) - 1, 2 * made_random(h) - 1, 2 * made_random(h) - 1);
    while (!(sn_v3_len(d) > 0.1 && sn_v3_len(d) < 1.0));
    return d;
}

/* Rings of one kind between two poles along y, parted in the middle by `gap`: flat quads, and a ray through
 * the centre has its midpoint there. */
static sn_bvh *symmetric_skin(sn_vec3 centre, sn_vec3 radii, double gap)
{
    enum { n_ring = 10, n_around = 16 };
    sn_tri_mesh m = made_rings(n_ring, n_around);
    for (int i = 0; i < n_ring; i++) {
        double lat = TEST_PI * ((i < 5 ? i + 1 : i + 2) / 12.0 - 0.5),
               up = radii.y * sin(lat) + (i < 5 ? -gap : gap);
        for (int k = 0; k < n_around; k++) {
            double lon = 2.0 * TEST_PI * k / n_around;
            sn_vec3 p = {radii.x * cos(lat) * sin(lon), up, radii.z * cos(lat) * cos(lon)};
            sn_v3_store(m.pos + 3 * (1 + i * n_around + k), sn_v3_add(centre, p));
        }
    }
    sn_v3_store(m.pos, sn_v3_sub(centre, sn_v3(0, radii.y + gap, 0)));
    sn_v3_store(m.pos + 3 * (m.n_vert - 1), sn_v3_add(centre, sn_v3(0, radii.y + gap, 0)));
    assert_true(sn_tri_mesh_volume(&m) > 0.0);
    return tree_of(&m);
}

static void midpoints_are_exact(void **state)
{
    (void)state;
    const struct {
        sn_vec3 centre, radii;
        double gap;
    } skin[] = {{{0.25, -0.5, 0.125}, {1, 1, 1}, 0.0}, /* a sphere     */
                {{0, 1, 0}, {0.5, 2.0, 1.25}, 0.0},    /* an ellipsoid */
                {{0, 0, 0.5}, {0.5, 0.5, 0.5}, 2.0}};  /* a capsule    */
    uint64_t h = 77;
    for (size_t i = 0; i < sizeof skin / sizeof *skin; i++) {
        sn_bvh *b = symmetric_skin(skin[i].centre, skin[i].radii, skin[i].gap);
        for (int k = 0; k < 200; k++) {
            sn_vec3 d = random_direction(&h), got;
            sn_vec3 from = sn_v3_mad(skin[i].centre, -7.0 / sn_v3_len(d), d);
            d = sn_v3_scale(1000.0 * made_random(&h) + 0.001, d);
            assert_int_equal(sn_pick_midpoint(b, from, d, &got, NULL), SN_OK);
            assert_at(got, skin[i].centre, 1e-12);
        }
        sn_bvh_destroy(b);
    }
}

/* Beside the centre: across a limb along y the middle is in the plane through its axis. */
static void a_limb_is_halved(void **state)
{
    (void)state;
    sn_tri_mesh m = made_capsule(sn_v3(0, -2, 0), sn_v3(0, 2, 0), 0.5, 2.0 * TEST_PI * 0.5 / 64);
    sn_bvh *skin = tree_of(&m);
    uint64_t h = 5;
    for (int k = 0; k < 100; k++) {
        double x = 0.9 * (made_random(&h) - 0.5), y = 3.0 * (made_random(&h) - 0.5);
        sn_vec3 got;
        assert_int_equal(sn_pick_midpoint(skin, sn_v3(x, y, 9), sn_v3(0, 0, -1), &got, NULL), SN_OK);
        assert_at(got, sn_v3(x, y, 0), 0.01);
    }
    sn_bvh_destroy(skin);
}

static void only_the_first_two_hits_count(void **state)
{
    (void)state;
    sn_tri_mesh m = made_box(sn_v3(0, 0, 0), sn_v3(1, 2, 1)), b = made_box(sn_v3(0, 0, -9), sn_v3(1, 1, -5));
    append_mesh(&m, &b, 0);
    sn_bvh *skin = tree_of(&m);
    sn_vec3 got;
    assert_int_equal(sn_pick_midpoint(skin, sn_v3(0.3, 0.4, 5), sn_v3(0, 0, -2), &got, NULL), SN_OK);
    assert_at(got, sn_v3(0.3, 0.4, 0.5), 1e-15);
    assert_int_equal(sn_pick_midpoint(skin, sn_v3(0.3, 0.4, -2), sn_v3(0, 0, -2), &got, NULL), SN_OK);
    assert_at(got, sn_v3(0.3, 0.4, -7), 1e-14);
    sn_bvh_destroy(skin);
}

static void rays_that_pick_nothing(void **state)
{
    (void)state;
    sn_tri_mesh m = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1));
    sn_bvh *skin = tree_of(&m);
    sn_error err = {.msg = ""};
    sn_vec3 got = {7, 7, 7};
    struct {
        sn_vec3 from, dir;
        const char *says[2];
    } no[] = {{{2.5, 0.5, 5}, {0, 0, -1}, {"misses the skin by 1.5", "nearest at (1, "}},
              {{0.5, 0.5, 5}, {0, 0, 1}, {"misses the skin by 4:", "nearest at (0.5, 0.5, 1)"}},
              {{2, 3, 0.25}, {0, -1, 0}, {"by 1:", "nearest at (1, "}},
              {{0.5, 0.5, 0.5}, {1, 0, 0}, {"starts inside the skin", "leaves at (1, 0.5, 0.5)"}},
              {{0.5, 0.5, 5}, {0, 0, 0}, {"direction that is not zero", "(0, 0, 0)"}},
              {{0.5, NAN, 5}, {0, 0, 1}, {"finite", "ray"}},
              {{0.5, 0.5, 5}, {0, INFINITY, 1}, {"finite", "ray"}}};
    for (size_t i = 0; i < sizeof no / sizeof *no; i++) {
        assert_int_equal(sn_pick_midpoint(skin, no[i].from, no[i].dir, &got, &err), SN_EINVAL);
        for (int k = 0; k < 2; k++) assert_says(err, no[i].says[k]);
        assert_at(got, sn_v3(7, 7, 7), 0.0);
    }
    sn_bvh_destroy(skin);
}

/* Along the edge of a post: entering and leaving at one place is no limb; what comes after is. */
static void touches_are_passed_over(void **state)
{
    (void)state;
    static const double corner[4][2] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
    for (int side = 0; side < 2; side++) {
        sn_tri_mesh m = made_box(sn_v3(-1, -1, -1), sn_v3(1, 1, 1));
        sn_tri_mesh b = made_box(sn_v3(-3, 4, -1), sn_v3(3, 6, 1));
        for (int v = 0; v < 8; v++) memcpy(m.pos + 3 * v, corner[v & 3], sizeof corner[0]);
        sn_bvh *post = NULL;
        assert_int_equal(sn_bvh_create(&post, &m, NULL), SN_OK);
        append_mesh(&m, &b, 0);
        sn_bvh *both = tree_of(&m);
        sn_vec3 from = {side ? 1 : -1, -5, 0.1}, got = {7, 7, 7};
        sn_error err = {.msg = ""};
        assert_int_equal(sn_pick_midpoint(post, from, sn_v3(0, 1, 0), &got, &err), SN_EINVAL);
        assert_says(err, "only touches the skin at (");
        assert_int_equal(sn_pick_midpoint(both, from, sn_v3(0, 1, 0), &got, &err), SN_OK);
        assert_at(got, sn_v3(from.x, 5, 0.1), 1e-12);
        sn_bvh_destroy(post);
        sn_bvh_destroy(both);
    }
}

static void an_open_skin_is_told(void **state)
{
    (void)state;
    sn_tri_mesh m = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1));
    m.n_face = 4; /* bottom and top */
    memmove(m.face, m.face + 6, 6 * sizeof *m.face);
    m.n_face = 2; /* top */
    sn_bvh *skin = tree_of(&m);
    sn_error err = {.msg = ""};
    sn_vec3 got;
    assert_int_equal(sn_pick_midpoint(skin, sn_v3(0.3, 0.4, 5), sn_v3(0, 0, -1), &got, &err), SN_EINVAL);
    assert_says(err, "does not leave it");
    sn_bvh_destroy(skin);
}

/* ---- cylinder bones ---- */

static sn_bone_template rod_template(sn_vec3 from, sn_vec3 to)
{
    static char name[] = "rod";
    return (sn_bone_template){.name = name, .kind = SN_BONE_CYLINDER, .from = from, .to = to};
}

static sn_affine placed(const sn_bone_template *t, sn_vec3 from, sn_vec3 to, const sn_cylinder_options *o)
{
    sn_affine a;
    sn_error err = {.msg = ""};
    if (sn_place_cylinder(t, from, to, o, &a, &err)) fail_msg("%s", err.msg);
    return a;
}

static sn_vec3 random_point(uint64_t *h)
{
    return sn_v3_scale(3.0, sn_v3(made_random(h) - 0.5, made_random(h) - 0.5, made_random(h) - 0.5));
}

static void handles_are_met(void **state)
{
    (void)state;
    uint64_t h = 3;
    for (int i = 0; i < 200; i++) {
        sn_bone_template t = rod_template(random_point(&h), random_point(&h));
        sn_vec3 from = random_point(&h), to = random_point(&h);
        sn_cylinder_options o = {.thickness = i % 3 ? 0.5 + made_random(&h) : 0.0,
                                 .twist_deg = i % 2 ? 360.0 * made_random(&h) : 0.0,
                                 .front = i % 5 ? random_direction(&h) : sn_v3(0, 0, 0),
                                 .is_mirrored = i % 7 > 3};
        sn_affine a = placed(&t, from, to, &o);
        assert_at(sn_affine_point(&a, t.from), from, 1e-12);
        assert_at(sn_affine_point(&a, t.to), to, 1e-12);
        assert_true(sn_affine_det(&a) * (o.is_mirrored ? -1.0 : 1.0) > 0.0);
        /* What is across the axis stays across it, and circles stay circles: no shear. */
        sn_vec3 u = sn_v3_unit(sn_v3_sub(t.to, t.from)), w = sn_v3_unit(sn_v3_cross(u, sn_v3(0.3, 0.5, 0.8)));
        sn_vec3 v = sn_v3_cross(w, u);
        sn_vec3 mu = sn_affine_vector(&a, u), mw = sn_affine_vector(&a, w), mv = sn_affine_vector(&a, v);
        double along = sn_v3_dist(from, to) / sn_v3_dist(t.from, t.to);
        double across = o.thickness > 0.0 ? o.thickness : along;
        assert_near(sn_v3_dot(mu, mw), 0.0, 1e-12 * along * across);
        assert_near(sn_v3_dot(mu, mv), 0.0, 1e-12 * along * across);
        assert_near(sn_v3_dot(mw, mv), 0.0, 1e-12 * across * across);
        assert_near(sn_v3_len(mu), along, 1e-12 * along);
        assert_near(sn_v3_len(mw), across, 1e-12 * across);
        assert_near(sn_v3_len(mv), across, 1e-12 * across);
    }
}

/* In the template's own place nothing moves. */
static void the_own_pose_is_the_identity(void **state)
{
    (void)state;
    sn_bone_template t = rod_template(sn_v3(0, 0.2, 0), sn_v3(0, -0.23, 0));
    sn_affine a = placed(&t, t.from, t.to, &(sn_cylinder_options){0});
    sn_affine b = placed(&t, t.from, t.to, &(sn_cylinder_options){.thickness = 1.0, .twist_deg = 360.0});
    for (int k = 0; k < 3; k++) {
        assert_at(a.col[k], sn_affine_identity().col[k], 1e-15);
        assert_at(b.col[k], sn_affine_identity().col[k], 1e-15);
    }
    assert_at(a.t, sn_v3(0, 0, 0), 1e-15);
}

static void front_is_followed(void **state)
{
    (void)state;
    uint64_t h = 9;
    sn_bone_template t = rod_template(sn_v3(0, 0, 0), sn_v3(0, -1, 0));
    for (int i = 0; i < 100; i++) {
        sn_vec3 to = random_point(&h), front = random_direction(&h), axis = sn_v3_unit(to);
        sn_affine a = placed(&t, sn_v3(0, 0, 0), to, &(sn_cylinder_options){.front = front});
        sn_vec3 want = sn_v3_unit(sn_v3_mad(front, -sn_v3_dot(front, axis), axis));
        if (sn_v3_len(sn_v3_cross(sn_v3_unit(front), axis)) < 0.1) continue;
        assert_at(sn_v3_unit(a.col[2]), want, 1e-12);
        sn_affine b = placed(&t, sn_v3(0, 0, 0), to,
                             &(sn_cylinder_options){.front = sn_v3_scale(1e200, front), .twist_deg = 37.0});
        double angle = atan2(sn_v3_dot(axis, sn_v3_cross(a.col[2], b.col[2])), sn_v3_dot(a.col[2], b.col[2]));
        assert_near(angle, 37.0 * TEST_PI / 180.0, 1e-12);
    }
}

/* Where front says nothing the template's axis turns there the shortest way: by the angle between them. */
static void the_smallest_turn(void **state)
{
    (void)state;
    uint64_t h = 11;
    for (int i = 0; i < 100; i++) {
        sn_vec3 end = i % 2 ? sn_v3(0, -1, 0) : sn_v3(0.01, 0.02, 1); /* odd: front along the goal */
        sn_bone_template t = rod_template(sn_v3(0, 0, 0), end);
        sn_vec3 to = sn_v3_unit(random_point(&h)),
                front = i % 2 ? sn_v3_mad(to, 0.02, random_point(&h)) : sn_v3(0, 1, 0);
        if (i == 20) to = sn_v3_scale(-1.0, end); /* half a turn */
        if (i == 22) to = end;
        if (i == 24) to = sn_v3(-0.01, -0.02 + 1e-7, -1);
        sn_affine a =
            placed(&t, sn_v3(0, 0, 0), to, &(sn_cylinder_options){.front = front, .thickness = 1.0});
        double k = sn_v3_len(to) / sn_v3_len(end);
        sn_vec3 u = sn_v3_unit(end), mu = sn_affine_vector(&a, u);
        /* trace of a turn = 1 + 2 cos; here the axis is longer by k - 1 along its image */
        double trace = a.col[0].x + a.col[1].y + a.col[2].z - (k - 1.0) * sn_v3_dot(sn_v3_unit(mu), u);
        assert_near(trace, 1.0 + 2.0 * sn_v3_dot(sn_v3_unit(to), u), 1e-7);
        assert_near(sn_affine_det(&a), k, 1e-12 * k);
    }
}

/* The right side is the mirror image of the left one. */
static void both_sides_are_alike(void **state)
{
    (void)state;
    uint64_t h = 21;
    for (int i = 0; i < 100; i++) {
        sn_bone_template t = rod_template(random_point(&h), random_point(&h));
        sn_vec3 from = random_point(&h), to = random_point(&h), front = random_direction(&h);
        if (i % 4 == 0) front = sn_v3_sub(to, from);
        sn_affine mirror = sn_affine_mirror(sn_v3(0, 0, 0), sn_v3(1, 0, 0));
        sn_cylinder_options left = {.front = front, .twist_deg = 30.0, .thickness = 1.3};
        sn_cylinder_options right = left;
        right.front = sn_affine_vector(&mirror, front);
        right.twist_deg = -30.0;
        right.is_mirrored = true;
        sn_affine a = sn_affine_after(mirror, placed(&t, from, to, &left));
        sn_affine b = placed(&t, sn_affine_point(&mirror, from), sn_affine_point(&mirror, to), &right);
        for (int k = 0; k < 3; k++) assert_at(a.col[k], b.col[k], 1e-12);
        assert_at(a.t, b.t, 1e-12);
    }
}

static void the_unit_does_not_matter(void **state)
{
    (void)state;
    sn_bone_template t = rod_template(sn_v3(0, 0, 0), sn_v3(0, -0.4, 0));
    sn_bone_template big = rod_template(sn_v3(0, 0, 0), sn_v3(0, -400, 0));
    sn_vec3 from = {0.1, 0.9, 0.05}, to = {0.15, 0.5, 0.02};
    sn_affine a = placed(&t, from, to, &(sn_cylinder_options){0});
    sn_affine b = placed(&big, sn_v3_scale(1000, from), sn_v3_scale(1000, to), &(sn_cylinder_options){0});
    for (int k = 0; k < 3; k++) assert_at(a.col[k], b.col[k], 1e-13);
    assert_at(sn_v3_scale(1000, a.t), b.t, 1e-10);
}

static void bones_that_cannot_be_placed(void **state)
{
    (void)state;
    sn_bone_template t = rod_template(sn_v3(0, 0, 0), sn_v3(0, 1, 0)), curve = t, flat = t;
    curve.kind = SN_BONE_CURVE;
    flat.to = flat.from;
    sn_vec3 a = {1, 2, 3}, b = {1, 2, 4};
    struct {
        const sn_bone_template *t;
        sn_vec3 from, to;
        sn_cylinder_options o;
        const char *says;
    } no[] = {{&curve, a, b, {.thickness = 0}, "bone template 'rod' is no cylinder"},
              {&flat, a, b, {.thickness = 0}, "both handles are at (0, 0, 0)"},
              {&t, a, a, {.thickness = 0}, "both ends are at (1, 2, 3)"},
              {&t, a, {0, NAN, 0}, {.thickness = 0}, "end has a coordinate that is not finite"},
              {&t, a, b, {.thickness = -1}, "thickness is -1"},
              {&t, a, b, {.thickness = NAN}, "thickness is nan"},
              {&t, a, b, {.twist_deg = INFINITY}, "twist is inf"},
              {&t, a, b, {.front = {0, NAN, 0}}, "front has a coordinate"}};
    for (size_t i = 0; i < sizeof no / sizeof *no; i++) {
        sn_affine m;
        sn_error err = {.msg = ""};
        assert_int_equal(sn_place_cylinder(no[i].t, no[i].from, no[i].to, &no[i].o, &m, &err), SN_EINVAL);
        assert_says(err, no[i].says);
    }
}

static void memory_may_end_anywhere(void **state)
{
    (void)state;
    sn_tri_mesh m = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1));
    sn_bvh *skin = tree_of(&m);
    sn_status st = SN_ENOMEM;
    int n = 0;
    for (; st == SN_ENOMEM; n++) {
        failing f = {.left = n};
        sn_vec3 got = {7, 7, 7};
        sn_set_allocator(&(sn_allocator){failing_realloc, &f});
        st = sn_pick_midpoint(skin, sn_v3(0.5, 0.6, 3), sn_v3(0, 0, -1), &got, NULL);
        sn_set_allocator(NULL);
        assert_int_equal(f.n_alive, 0);
        if (st) assert_at(got, sn_v3(7, 7, 7), 0.0);
    }
    assert_int_equal(st, SN_OK);
    assert_true(n > 1);
    sn_bvh_destroy(skin);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(midpoints_are_exact),
        cmocka_unit_test(a_limb_is_halved),
        cmocka_unit_test(only_the_first_two_hits_count),
        cmocka_unit_test(rays_that_pick_nothing),
        cmocka_unit_test(touches_are_passed_over),
        cmocka_unit_test(an_open_skin_is_told),
        cmocka_unit_test(handles_are_met),
        cmocka_unit_test(the_own_pose_is_the_identity),
        cmocka_unit_test(front_is_followed),
        cmocka_unit_test(the_smallest_turn),
        cmocka_unit_test(both_sides_are_alike),
        cmocka_unit_test(the_unit_does_not_matter),
        cmocka_unit_test(bones_that_cannot_be_placed),
        cmocka_unit_test(memory_may_end_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
