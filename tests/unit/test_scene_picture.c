/* test_scene_picture - pictures of a scene that is edited: what is kept from one to the next never shows. */
#include "scene/scene_private.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>

#include "asserts.h"
#include "made_limb.h"

enum { WIDTH = 60, HEIGHT = 80, N_STEP = 40 };

static uint32_t seed = 7;
static int chance(int n) /* 0..n - 1 */
{
    seed = seed * 1664525u + 1013904223u;
    return (int)(seed >> 8) % n;
}
static double part(void)
{
    return chance(10000) / 10000.0;
}

/* The same edit of both scenes; what an edit refuses both refuse. */
static void edit(sn_scene *const s[2], int step)
{
    int kind = chance(11), i_muscle = chance(3);
    double u = part(), v = part();
    sn_affine shift = sn_affine_translation(sn_v3(0.02 * u, 0, 0));
    sn_status st[2];
    for (int k = 0; k < 2; k++) {
        sn_error err;
        switch (kind) {
        case 0:
            st[k] = sn_scene_set_point(s[k], i_muscle, 0, 1,
                                       sn_v3(0.1 * u, 0.6 * v - 0.3, 0.5 - i_muscle * 0.5), &err);
            break;
        case 1:
            st[k] = sn_scene_set_tissue(s[k], i_muscle, 0, -1, 0.7 + u, &err);
            break;
        case 2:
            st[k] = sn_scene_set_fat(s[k], 0.15 + 0.2 * u, &err);
            break;
        case 3:
            st[k] = sn_scene_set_tendon(s[k], i_muscle, &(sn_tendon){0.5 * u, 0.0}, &err);
            break;
        case 4:
            st[k] = sn_scene_set_anisotropy(
                s[k], i_muscle, &(sn_anisotropy){u < 0.7, 90 * u, {1, 2, 0.5}, false, {0, 0, 0}}, &err);
            break;
        case 5: /* the first round places a bone elsewhere: a new body */
            st[k] = step % 4 ? SN_OK : sn_scene_map_bone(s[k], 0, &shift, &err);
            break;
        case 6:
            st[k] = sn_scene_solve_quick(s[k], &one_thread, NULL, &err);
            break;
        case 7:
            st[k] = sn_scene_solve(s[k], &one_thread, NULL, &err);
            break;
        case 8: {
            const double line[6] = {-0.5, -0.7, 0.1 * u, -0.5, 0.7, 0.1 * v};
            st[k] = sn_scene_muscle_count(s[k]) > 3 ? sn_scene_remove_muscle(s[k], "more", &err)
                                                    : sn_scene_add_muscle(s[k], "more", line, NULL, 2, &err);
            break;
        }
        case 9:
            st[k] = sn_scene_set_alpha(s[k], 4.0 + u, &err);
            break;
        default:
            st[k] = SN_OK;
        }
    }
    assert_int_equal(st[0], st[1]);
}

static sn_picture_options look(const sn_scene *s)
{
    sn_picture_options o = {.width = WIDTH,
                            .height = HEIGHT,
                            .samples = 1,
                            .skin_opacity = 0.3,
                            .renderer = SN_RENDERER_OSMESA,
                            .show_muscles = chance(6) > 0,
                            .show_bones = chance(3) > 0,
                            .show_skin = chance(3) > 0,
                            .show_curves = chance(3) == 0,
                            .show_points = chance(3) == 0,
                            .show_fibers = chance(8) == 0,
                            .show_frames = chance(4) == 0,
                            .has_clip = chance(4) == 0,
                            .clip_normal = {0, 0.2, 1},
                            .background = {1, 1, 1, 1}};
    ok(sn_camera_orbit(&o.camera, 360.0 * part(), 80.0 * part() - 40.0, 1.0, sn_scene_bounds(s), SN_UP_Y,
                       (double)WIDTH / HEIGHT, NULL));
    return o;
}

/* One scene keeps what it can; the other forgets all before each picture. */
static void pictures_are_those_of_a_scene_that_keeps_nothing(void **state)
{
    (void)state;
    sn_scene *s[2] = {made_limb(), made_limb()};
    for (int step = 0; step < N_STEP; step++) {
        sn_image m[2];
        if (step > 0) edit(s, step);
        sn_picture_options o = look(s[0]);
        for (int k = 0; k < 2; k++) {
            sn_image_init(&m[k]);
            if (k == 1) sn_scene_free_view(s[k]);
            ok(sn_scene_render(s[k], &o, 5, &one_thread, &m[k], NULL, &err));
        }
        if (memcmp(m[0].rgba, m[1].rgba, 4 * WIDTH * HEIGHT) != 0) fail_msg("picture %d differs", step);
        for (int k = 0; k < 2; k++) sn_image_free(&m[k]);
    }
    for (int k = 0; k < 2; k++) sn_scene_destroy(s[k]);
}

/* A quick picture is followed by an exact one though nothing was edited in between. */
static void the_exact_fields_show(void **state)
{
    (void)state;
    sn_scene *s = made_limb();
    sn_image quick, exact;
    sn_image_init(&quick);
    sn_image_init(&exact);
    (void)solve_scene(s);
    sn_picture_options o = look(s);
    o.show_muscles = true;
    uint64_t before = s->field_revision;
    ok(sn_scene_render(s, &o, 1, &one_thread, &quick, NULL, &err));
    assert_int_equal(s->field_revision, before); /* drawing alone solves nothing */
    ok(sn_scene_set_point(s, 0, 0, 1, sn_v3(0.05, 0.1, 0.6), &err));
    ok(sn_scene_solve_quick(s, &one_thread, NULL, &err));
    ok(sn_scene_render(s, &o, 1, &one_thread, &quick, NULL, &err));
    uint64_t between = s->field_revision;
    (void)solve_scene(s);
    assert_true(between > before && (s->field_revision > between || sn_scene_fields(s)));
    ok(sn_scene_render(s, &o, 1, &one_thread, &exact, NULL, &err));
    sn_scene_free_view(s);
    ok(sn_scene_render(s, &o, 1, &one_thread, &quick, NULL, &err));
    assert_memory_equal(exact.rgba, quick.rgba, 4 * WIDTH * HEIGHT);
    sn_image_free(&quick);
    sn_image_free(&exact);
    sn_scene_destroy(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_those_of_a_scene_that_keeps_nothing),
        cmocka_unit_test(the_exact_fields_show),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
