/* test_clearance - bones that keep clear of the skin. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "asserts.h"
#include "closed_surface.h"
#include "failing_memory.h"
#include "made_mesh.h"
#include "skeleton/clearance.h"
#include "skeleton/spread.h"

static sn_bvh *ball(double radius, double cell)
{
    sn_tri_mesh m = made_sphere(sn_v3(0, 0, 0), radius, cell);
    sn_bvh *b = NULL;
    assert_int_equal(sn_bvh_create(&b, &m, NULL), SN_OK);
    sn_tri_mesh_free(&m);
    return b;
}

static sn_tri_mesh copy_of(const sn_tri_mesh *m)
{
    sn_tri_mesh c;
    sn_tri_mesh_init(&c);
    assert_int_equal(sn_tri_mesh_copy(&c, m, NULL), SN_OK);
    return c;
}

static bool same_bits(const sn_tri_mesh *a, const sn_tri_mesh *b)
{
    return a->n_vert == b->n_vert && a->n_face == b->n_face &&
           memcmp(a->pos, b->pos, 3 * (size_t)a->n_vert * sizeof *a->pos) == 0 &&
           memcmp(a->face, b->face, 3 * (size_t)a->n_face * sizeof *a->face) == 0;
}

/* The nearest vertex to the skin by looking at all, with the sign of the distance from the centre. */
static double least_depth(const sn_tri_mesh *m, const sn_bvh *skin)
{
    double least = INFINITY;
    for (int32_t i = 0; i < m->n_vert; i++) {
        sn_vec3 p = sn_tri_mesh_point(m, i);
        double d = sn_bvh_closest(skin, p).dist;
        least = fmin(least, sn_bvh_winding(skin, p) > 0.5 ? d : -d);
    }
    return least;
}

static void assert_sound(const sn_tri_mesh *m)
{
    assert_closed_manifold(m);
    assert_int_equal(count_crossings(m), 0);
    assert_true(sn_tri_mesh_volume(m) > 0.0);
}

static void keep(sn_tri_mesh *m, const sn_bvh *skin, double margin, sn_clearance_report *r)
{
    sn_error err = {.msg = ""};
    if (sn_clearance_keep(m, skin, margin, NULL, r, &err)) fail_msg("%s", err.msg);
}

/* ---- measures ---- */

static void what_pokes_out_is_counted(void **state)
{
    (void)state;
    sn_bvh *skin = ball(1.0, 0.05);
    sn_tri_mesh m = made_box(sn_v3(-0.2, -0.2, -0.2), sn_v3(0.2, 0.2, 1.5));
    m.pos[3 * 5 + 2] = 1.6; /* the outermost of the four corners above */
    sn_clearance c;
    assert_int_equal(sn_clearance_measure(&m, skin, 0.1, NULL, &c, NULL), SN_OK);
    assert_int_equal(c.n_out, 4);
    assert_int_equal(c.n_near, 4);
    sn_vec3 worst = sn_tri_mesh_point(&m, 5);
    assert_near(c.least, 1.0 - sn_v3_len(worst), 0.002);
    assert_near(sn_v3_dist(c.at, worst), 0.0, 0.0);
    assert_int_equal(sn_clearance_measure(&m, skin, 0.7, NULL, &c, NULL), SN_OK);
    assert_int_equal(c.n_near, 8); /* the lower corners are 0.65 deep */
    assert_int_equal(c.n_out, 4);
    m.pos[3 * 5 + 2] = 1.5;
    scale_mesh(&m, 0.5);
    assert_int_equal(sn_clearance_measure(&m, skin, 0.0, NULL, &c, NULL), SN_OK);
    assert_int_equal(c.n_out, 0);
    assert_near(c.least, 1.0 - sqrt(0.75 * 0.75 + 0.02), 0.002);
    sn_tri_mesh_free(&m);
    sn_bvh_destroy(skin);
}

/* ---- displacements spread ---- */

/* On a long rod that is held at one end the displacement fades as exp(-distance / range). */
static void displacements_fade(void **state)
{
    (void)state;
    sn_tri_mesh m = made_capsule(sn_v3(0, 0, 0), sn_v3(0, 8, 0), 0.2, 0.06);
    sn_spread *s = NULL;
    assert_int_equal(sn_spread_create(&s, &m, NULL), SN_OK);
    assert_near(sn_spread_edge(s), 0.06, 0.02);
    double *wish = calloc(3 * (size_t)m.n_vert, sizeof *wish), *u = calloc(3 * (size_t)m.n_vert, sizeof *u);
    double *weight = calloc((size_t)m.n_vert, sizeof *weight);
    for (int32_t i = 0; i < m.n_vert; i++) {
        bool held = m.pos[3 * i + 1] < 0.5;
        weight[i] = held ? 1e6 : 1.0;
        if (held) wish[3 * i + 2] = 2.0;
    }
    sn_spread_apply(s, wish, weight, 0.5, NULL, u);
    for (int32_t i = 0; i < m.n_vert; i++) {
        double y = m.pos[3 * i + 1];
        assert_true(u[3 * i + 2] <= 2.0 * (1.0 + 1e-5) && u[3 * i + 2] > -1e-5);
        assert_near(u[3 * i], 0.0, 1e-12);
        if (y < 0.5) assert_near(u[3 * i + 2], 2.0, 1e-3);
        if (y > 0.8 && y < 2.5)
            assert_near(log(u[3 * i + 2] / 2.0) / ((0.48 - y) / 0.5), 1.0,
                        0.15); /* obtuse faces carry farther */
        if (y > 6.0) assert_near(u[3 * i + 2], 0.0, 1e-4);
    }
    sn_spread_destroy(s);
    free(wish);
    free(u);
    free(weight);
    sn_tri_mesh_free(&m);
}

/* ---- keeping clear ---- */

static void a_rod_comes_in(void **state)
{
    (void)state;
    sn_bvh *skin = ball(1.0, 0.08);
    const double out[] = {0.93, 1.05, 1.3}; /* within the margin, just out, far out */
    for (int i = 0; i < 3; i++) {
        sn_tri_mesh m = made_capsule(sn_v3(-0.5, 0, 0), sn_v3(out[i] - 0.1, 0.1, 0), 0.1, 0.03),
                    was = copy_of(&m);
        sn_clearance_report r;
        keep(&m, skin, 0.1, &r);
        assert_sound(&m);
        double least = least_depth(&m, skin);
        assert_true(least >= 0.1 && least <= 0.1 * (1.0 + 1e-3));
        assert_near(r.after.least, least, 0.0);
        assert_int_equal(r.after.n_near, 0);
        assert_int_equal(r.after.n_out, 0);
        assert_near(r.before.least, least_depth(&was, skin), 0.0);
        assert_true(r.before.n_near > 0 && (i == 0) == (r.before.n_out == 0));
        assert_true(r.moved >= 0.1 - r.before.least && r.moved < 2.0 * (0.1 - r.before.least));
        assert_true(r.n_moved >= r.before.n_near && r.rounds > 0);
        assert_memory_equal(m.face, was.face, 3 * (size_t)m.n_face * sizeof *m.face);
        if (i < 2) /* the far end stays */
            for (int32_t v = 0; v < m.n_vert; v++)
                if (was.pos[3 * v] < -0.5)
                    assert_near(sn_v3_dist(sn_tri_mesh_point(&m, v), sn_tri_mesh_point(&was, v)), 0.0, 0.02);
        sn_tri_mesh again = copy_of(&m);
        keep(&m, skin, 0.1, &r);
        assert_true(same_bits(&m, &again));
        sn_tri_mesh_free(&again);
        sn_tri_mesh_free(&m);
        sn_tri_mesh_free(&was);
    }
    sn_bvh_destroy(skin);
}

static void a_bone_inside_stays(void **state)
{
    (void)state;
    sn_bvh *skin = ball(1.0, 0.1);
    sn_tri_mesh m = made_capsule(sn_v3(-0.5, 0, 0), sn_v3(0.5, 0.1, 0), 0.1, 0.05), was = copy_of(&m);
    sn_clearance_report r;
    keep(&m, skin, 0.1, &r);
    assert_true(same_bits(&m, &was));
    assert_int_equal(r.rounds, 0);
    assert_int_equal(r.n_moved, 0);
    assert_near(r.moved, 0.0, 0.0);
    assert_near(r.before.least, r.after.least, 0.0);
    sn_tri_mesh_free(&m);
    sn_tri_mesh_free(&was);
    sn_bvh_destroy(skin);
}

/* Out on two sides of a limb, and along all of it: bent and pressed in, still whole. */
static void a_bent_bone_in_a_limb(void **state)
{
    (void)state;
    sn_tri_mesh m = made_capsule(sn_v3(0, -1.5, 0), sn_v3(0, 1.5, 0), 0.5, 0.1);
    sn_bvh *skin = NULL;
    assert_int_equal(sn_bvh_create(&skin, &m, NULL), SN_OK);
    sn_tri_mesh_free(&m);
    m = made_capsule(sn_v3(0, -1.3, 0), sn_v3(0, 1.3, 0), 0.12, 0.05);
    for (int32_t i = 0; i < m.n_vert; i++) m.pos[3 * i] += 0.45 * sin(2.2 * m.pos[3 * i + 1]);
    sn_clearance_report r;
    keep(&m, skin, 0.08, &r);
    assert_true(r.before.n_out > 20);
    assert_true(least_depth(&m, skin) >= 0.08);
    assert_sound(&m);
    sn_tri_mesh_free(&m);
    sn_bvh_destroy(skin);
}

static void no_room_is_told(void **state)
{
    (void)state;
    sn_bvh *skin = ball(1.0, 0.1);
    sn_tri_mesh m = made_capsule(sn_v3(-0.5, 0, 0), sn_v3(0.5, 0.1, 0), 0.3, 0.06), was = copy_of(&m);
    sn_error err = {.msg = ""};
    sn_clearance_report r;
    const double margin[] = {0.97, 2.0, 1e6};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(sn_clearance_keep(&m, skin, margin[i], NULL, &r, &err), SN_ESOLVE);
        assert_says(err, "no room: a margin of ");
        assert_says(err, " to the skin cannot be kept at (");
        assert_says(err, " was reached)");
        assert_true(same_bits(&m, &was));
        const char *reached = strstr(err.msg, "a margin of ") + 1;
        double got = strtod(strstr(reached, "a margin of ") + 12, NULL);
        assert_true(got > 0.1 && got <= 1.0);
        sn_tri_mesh again = copy_of(&m); /* and somewhat less is indeed */
        keep(&again, skin, 0.95 * got, &r);
        sn_tri_mesh_free(&again);
    }
    sn_tri_mesh_free(&m);
    sn_tri_mesh_free(&was);
    sn_bvh_destroy(skin);
}

/* Two rods that are pushed towards each other. */
static void bones_do_not_cross_themselves(void **state)
{
    (void)state;
    sn_tri_mesh m = made_capsule(sn_v3(0, -1.5, 0), sn_v3(0, 1.5, 0), 0.5, 0.1);
    sn_bvh *skin = NULL;
    assert_int_equal(sn_bvh_create(&skin, &m, NULL), SN_OK);
    sn_tri_mesh_free(&m);
    m = made_capsule(sn_v3(0.3, -1, 0), sn_v3(0.3, 1, 0), 0.1, 0.05);
    sn_tri_mesh b = made_capsule(sn_v3(-0.3, -1, 0), sn_v3(-0.3, 1, 0), 0.1, 0.05);
    append_mesh(&m, &b, 0);
    sn_tri_mesh was = copy_of(&m);
    sn_error err = {.msg = ""};
    sn_clearance_report r;
    assert_int_equal(sn_clearance_keep(&m, skin, 0.42, NULL, &r, &err), SN_ESOLVE);
    assert_says(err, "with a margin of 0.42 to the skin the bone would cross itself at (");
    assert_true(same_bits(&m, &was));
    keep(&m, skin, 0.15, &r);
    assert_int_equal(count_crossings(&m), 0);
    sn_tri_mesh_free(&m);
    sn_tri_mesh_free(&was);
    sn_bvh_destroy(skin);
}

static void bad_inputs(void **state)
{
    (void)state;
    sn_bvh *skin = ball(1.0, 0.3);
    sn_tri_mesh m = made_box(sn_v3(-0.1, -0.1, -0.1), sn_v3(0.1, 0.1, 0.1));
    sn_error err = {.msg = ""};
    const double margin[] = {0.0, -1.0, NAN, INFINITY};
    for (int i = 0; i < 4; i++) {
        assert_int_equal(sn_clearance_keep(&m, skin, margin[i], NULL, NULL, &err), SN_EINVAL);
        assert_says(err, "margin to the skin is ");
    }
    m.n_face--;
    assert_int_equal(sn_clearance_keep(&m, skin, 0.1, NULL, NULL, &err), SN_EINVAL);
    assert_says(err, "bone: has 3 boundary edges, need a closed surface");
    m.n_face++;
    m.pos[4] = NAN;
    assert_int_equal(sn_clearance_keep(&m, skin, 0.1, NULL, NULL, &err), SN_EINVAL);
    assert_says(err, "bone: ");
    sn_tri_mesh_free(&m);
    sn_bvh_destroy(skin);
}

static void the_unit_does_not_matter(void **state)
{
    (void)state;
    sn_tri_mesh m = made_capsule(sn_v3(-0.5, 0, 0), sn_v3(1.0, 0.1, 0), 0.1, 0.04), large = copy_of(&m);
    sn_bvh *skin = ball(1.0, 0.1);
    sn_tri_mesh s = copy_of(sn_bvh_mesh(skin));
    scale_mesh(&s, 1000.0);
    scale_mesh(&large, 1000.0);
    sn_bvh *large_skin = NULL;
    assert_int_equal(sn_bvh_create(&large_skin, &s, NULL), SN_OK);
    sn_clearance_report r, q;
    keep(&m, skin, 0.1, &r);
    keep(&large, large_skin, 100.0, &q);
    assert_int_equal(r.rounds, q.rounds);
    assert_int_equal(r.n_moved, q.n_moved);
    for (int32_t i = 0; i < 3 * m.n_vert; i++) assert_near(1000.0 * m.pos[i], large.pos[i], 1e-4);
    sn_tri_mesh_free(&m);
    sn_tri_mesh_free(&s);
    sn_tri_mesh_free(&large);
    sn_bvh_destroy(skin);
    sn_bvh_destroy(large_skin);
}

static void the_same_bits_for_any_threads(void **state)
{
    (void)state;
    sn_bvh *skin = ball(1.0, 0.1);
    sn_tri_mesh from = made_capsule(sn_v3(-0.5, 0, 0), sn_v3(1.0, 0.1, 0), 0.1, 0.02), first = copy_of(&from);
    sn_clearance_report r, q;
    assert_true(from.n_vert > 2000);
    keep(&first, skin, 0.1, &r);
    for (int threads = 1; threads <= 5; threads += 2) {
        sn_tri_mesh m = copy_of(&from);
        sn_run run = {.n_threads = threads};
        assert_int_equal(sn_clearance_keep(&m, skin, 0.1, &run, &q, NULL), SN_OK);
        assert_true(same_bits(&m, &first));
        assert_int_equal(r.rounds, q.rounds);
        sn_tri_mesh_free(&m);
    }
    sn_tri_mesh_free(&from);
    sn_tri_mesh_free(&first);
    sn_bvh_destroy(skin);
}

typedef struct stopper {
    volatile sig_atomic_t stop;
    int left;
} stopper;

static void count_down(void *user, const char *step, double fraction)
{
    stopper *s = user;
    assert_true(step && fraction <= 1.0);
    if (s->left-- <= 0) s->stop = 1;
}

static void interruptions_leave_the_bone(void **state)
{
    (void)state;
    sn_bvh *skin = ball(1.0, 0.2);
    sn_tri_mesh m = made_capsule(sn_v3(-0.5, 0, 0), sn_v3(1.0, 0.1, 0), 0.1, 0.06), was = copy_of(&m);
    sn_status st = SN_ECANCEL;
    int n = 0;
    for (; st == SN_ECANCEL; n++) {
        stopper s = {.left = n};
        sn_run run = {.cancel = &s.stop, .progress = count_down, .user = &s};
        sn_error err = {.msg = ""};
        sn_clearance_report r;
        st = sn_clearance_keep(&m, skin, 0.1, &run, &r, &err);
        if (st) assert_says(err, "interrupted while ");
        if (st) assert_true(same_bits(&m, &was));
    }
    assert_int_equal(st, SN_OK);
    assert_true(n > 10);
    stopper s = {.stop = 1};
    sn_run run = {.cancel = &s.stop};
    sn_clearance c;
    assert_int_equal(sn_clearance_measure(&m, skin, 0.1, &run, &c, NULL), SN_ECANCEL);
    assert_int_equal(c.n_near, 0);
    sn_tri_mesh_free(&m);
    sn_tri_mesh_free(&was);
    sn_bvh_destroy(skin);
}

static void memory_may_end_anywhere(void **state)
{
    (void)state;
    sn_bvh *skin = ball(1.0, 0.2);
    sn_tri_mesh m = made_capsule(sn_v3(-0.5, 0, 0), sn_v3(1.0, 0.1, 0), 0.1, 0.06), was = copy_of(&m);
    sn_run run = {.n_threads = 1};
    sn_status st = SN_ENOMEM;
    int n = 0;
    for (; st == SN_ENOMEM; n++) {
        failing f = {.left = n};
        sn_set_allocator(&(sn_allocator){failing_realloc, &f});
        st = sn_clearance_keep(&m, skin, 0.1, &run, NULL, NULL);
        sn_set_allocator(NULL);
        assert_int_equal(f.n_alive, 0);
        if (st) assert_true(same_bits(&m, &was));
    }
    assert_int_equal(st, SN_OK);
    assert_true(n > 20);
    failing none = {.left = 0};
    sn_clearance c;
    sn_set_allocator(&(sn_allocator){failing_realloc, &none});
    assert_int_equal(sn_clearance_measure(&m, skin, 0.1, &run, &c, NULL), SN_ENOMEM);
    sn_set_allocator(NULL);
    sn_tri_mesh_free(&m);
    sn_tri_mesh_free(&was);
    sn_bvh_destroy(skin);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_pokes_out_is_counted),
        cmocka_unit_test(displacements_fade),
        cmocka_unit_test(a_rod_comes_in),
        cmocka_unit_test(a_bone_inside_stays),
        cmocka_unit_test(a_bent_bone_in_a_limb),
        cmocka_unit_test(no_room_is_told),
        cmocka_unit_test(bones_do_not_cross_themselves),
        cmocka_unit_test(bad_inputs),
        cmocka_unit_test(the_unit_does_not_matter),
        cmocka_unit_test(the_same_bits_for_any_threads),
        cmocka_unit_test(interruptions_leave_the_bone),
        cmocka_unit_test(memory_may_end_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
