/* test_painter - pictures one after another by one painter, against those of new painters: equal to the byte.
 */
#include "made_body.h"

#include <pthread.h>

static double lobe(int32_t i, sn_vec3 p)
{
    static const double x[3] = {-0.35, 0.3, 0.0};
    return i == 0 ? 0.0 : 0.5 - sn_v3_dist(p, sn_v3(x[i - 1], 0.1 * i, 0.2));
}

static uint32_t seed = 12345;
static int chance(int n) /* 0..n - 1 */
{
    seed = seed * 1664525u + 1013904223u;
    return (int)(seed >> 8) % n;
}
static double part(void)
{
    return chance(10000) / 10000.0;
}

/* ---- a scene in which everything may change ---- */

typedef struct stage {
    body b;
    sn_tri_mesh bone[2], skin;
    const sn_tri_mesh *list[2];
    double curve[3][3], fiber[2][6];
    sn_picture_curve curves[1];
    sn_picture_line fibers[2];
    sn_picture_arrow arrow;
    float *tendon[3];
    const float *tendons[3];
    sn_picture_scene scene;
} stage;

static void stage_make(stage *s)
{
    memset(s, 0, sizeof *s);
    body_make(&s->b, 6, 4, lobe);
    for (int k = 0; k < 3; k++) {
        s->tendons[k] = s->tendon[k] = malloc(sizeof(float) * (size_t)s->b.mesh.n_vert);
        for (int32_t v = 0; v < s->b.mesh.n_vert; v++)
            s->tendon[k][v] = (float)(sn_tet_mesh_point(&s->b.mesh, v).y - 0.2);
        for (int c = 0; c < 3; c++) s->curve[k][c] = 0.4 * (k - 1) + 0.1 * c;
    }
    make_box(&s->bone[0], sn_v3(-0.9, -0.9, -0.9), sn_v3(-0.5, 0.6, 0.2));
    make_box(&s->bone[1], sn_v3(0.5, -0.9, -0.9), sn_v3(0.8, 0.6, 0.9));
    make_box(&s->skin, sn_v3(-1, -1, -1), sn_v3(1, 1, 1));
    for (int k = 0; k < 2; k++) {
        s->list[k] = &s->bone[k];
        for (int c = 0; c < 6; c++) s->fiber[k][c] = 0.3 * (c % 3) - 0.2 * k + 0.1 * c;
        s->fibers[k] = (sn_picture_line){s->fiber[k], 2, {0.8f, 0.3f, 0.2f}};
    }
    s->curves[0] = (sn_picture_curve){s->curve[0], 3, s->curve[0], 3, {0.9f, 0.2f, 0.1f}};
    s->arrow = (sn_picture_arrow){{0, 0, 0.9}, {0.3, 0.2, 0.1}, {0.1f, 0.6f, 0.2f}};
    s->scene = s->b.scene;
    s->scene.bone = s->list;
    s->scene.n_bone = 2;
    s->scene.skin = &s->skin;
    s->scene.curve = s->curves;
    s->scene.n_curve = 1;
    s->scene.fiber = s->fibers;
    s->scene.n_fiber = 2;
    s->scene.arrow = &s->arrow;
    s->scene.n_arrow = 1;
    s->scene.stamp = (sn_picture_stamps){1, 1, 1};
}

static void stage_free(stage *s)
{
    for (int k = 0; k < 3; k++) free(s->tendon[k]);
    for (int k = 0; k < 2; k++) sn_tri_mesh_free(&s->bone[k]);
    sn_tri_mesh_free(&s->skin);
    body_free(&s->b);
}

static void edit(stage *s)
{
    switch (chance(9)) {
    case 0: { /* fields */
        double scale = 0.8 + 0.4 * part();
        size_t n = (size_t)s->b.mesh.n_vert, i = (size_t)(1 + chance(3));
        for (size_t v = 0; v < n; v++)
            s->b.field[i * n + v] = scale * s->b.field[i * n + v] + 0.02 * (scale - 1.0);
        s->scene.stamp.fields++;
        break;
    }
    case 1: /* a bone moves */
        for (int v = 0; v < 8; v++) s->bone[0].pos[3 * v] += 0.05 * (part() - 0.5);
        s->scene.stamp.shapes++;
        break;
    case 2: /* bones come and go */
        s->scene.n_bone = chance(3);
        s->scene.stamp.shapes++;
        break;
    case 3: /* no skin, then again */
        s->scene.skin = s->scene.skin ? NULL : &s->skin;
        s->scene.stamp.shapes++;
        break;
    case 4:
        s->curve[1][0] += 0.1 * (part() - 0.5);
        s->fiber[1][2] += 0.1 * (part() - 0.5);
        s->arrow.along.y = part();
        s->scene.stamp.curves++;
        break;
    case 5: /* tendons */
        s->scene.tendon = s->scene.tendon ? NULL : s->tendons;
        s->scene.stamp.fields++;
        break;
    case 6:
        s->scene.n_tissue = 2 + chance(3);
        s->scene.stamp.fields++;
        break;
    case 7: /* tets */
        s->b.mesh.pos[3 * 200] += 0.02 * (part() - 0.5);
        s->scene.stamp.shapes++;
        break;
    default: /* the camera alone */
        break;
    }
}

static sn_picture_options look(void)
{
    static const int side[4] = {40, 64, 90, 90};
    sn_picture_options o = front(side[chance(4)], side[chance(4)]);
    sn_error err;
    o.samples = 1 + chance(2);
    o.show_muscles = chance(5) > 0;
    o.show_bones = chance(4) > 0;
    o.show_skin = chance(3) > 0;
    o.show_curves = chance(2);
    o.show_points = chance(2);
    o.show_fibers = chance(3) == 0;
    o.show_frames = chance(3) == 0;
    o.has_clip = chance(3) == 0;
    o.clip_point = sn_v3(0, 0, chance(2) ? 0.1 : 0.3);
    o.clip_normal = sn_v3(0, chance(2), 1);
    ok(sn_camera_orbit(&o.camera, 360.0 * part(), 60.0 * part() - 30.0, 0.7 + part(),
                       (sn_box3){{-1, -1, -1}, {1, 1, 1}}, SN_UP_Y, (double)o.width / o.height, &err),
       &err);
    return o;
}

static void same(sn_painter *p, const stage *s, const sn_picture_options *o, int step)
{
    sn_image kept, anew;
    sn_error err;
    sn_picture_stats stats;
    sn_image_init(&kept);
    ok(sn_painter_draw(p, &s->scene, o, NULL, &kept, &stats, &err), &err);
    sn_picture_stats want = draw(&s->scene, o, &anew);
    if (memcmp(kept.rgba, anew.rgba, 4 * (size_t)o->width * (size_t)o->height) != 0)
        fail_msg("picture %d differs", step);
    assert_int_equal(stats.tets_sent, want.tets_sent);
    assert_int_equal(stats.is_blank, want.is_blank);
    sn_image_free(&kept);
    sn_image_free(&anew);
}

static void test_pictures_are_those_of_a_new_painter(void **state)
{
    (void)state;
    stage s;
    sn_painter *p;
    sn_error err;
    stage_make(&s);
    ok(sn_painter_create(&p, &err), &err);
    for (int step = 0; step < 50; step++) {
        sn_picture_options o = look();
        for (int k = chance(3); k > 0; k--) edit(&s);
        same(p, &s, &o, step);
    }
    sn_painter_destroy(p);
    stage_free(&s);
}

/* Without stamps everything is looked at anew; with equal ones nothing is. */
static void test_stamps_are_taken_at_their_word(void **state)
{
    (void)state;
    stage s;
    sn_painter *p;
    sn_error err;
    sn_image a, b;
    stage_make(&s);
    sn_picture_options o = front(60, 60);
    o.show_skin = false;
    ok(sn_painter_create(&p, &err), &err);
    for (int has_stamps = 0; has_stamps < 2; has_stamps++) {
        s.scene.stamp = (sn_picture_stamps){(uint64_t)has_stamps, (uint64_t)has_stamps, (uint64_t)has_stamps};
        sn_image_init(&a);
        sn_image_init(&b);
        ok(sn_painter_draw(p, &s.scene, &o, NULL, &a, NULL, &err), &err);
        for (int32_t v = 0; v < s.b.mesh.n_vert; v++) s.b.field[s.b.mesh.n_vert + v] -= 0.1;
        ok(sn_painter_draw(p, &s.scene, &o, NULL, &b, NULL, &err), &err);
        assert_int_equal(memcmp(a.rgba, b.rgba, 4 * 60 * 60) == 0, has_stamps);
        sn_image_free(&a);
        sn_image_free(&b);
    }
    sn_painter_destroy(p);
    stage_free(&s);
}

/* ---- what goes wrong leaves nothing wrong ---- */

static volatile sig_atomic_t stop;
static const char *stop_step;
static void stop_at(void *user, const char *step, double fraction)
{
    (void)user;
    (void)fraction;
    if (stop_step && strcmp(step, stop_step) == 0) stop = 1;
}

static void test_after_an_error(void **state)
{
    (void)state;
    static const char *const steps[] = {"sending bones", "choosing tets", "making surfaces", "cutting tets",
                                        "lighting"};
    stage s;
    sn_painter *p;
    sn_error err;
    sn_image m;
    stage_make(&s);
    sn_picture_options o = front(50, 50);
    o.has_clip = true;
    o.clip_point = sn_v3(0, 0, 0.2);
    o.clip_normal = sn_v3(0, 0, 1);
    ok(sn_painter_create(&p, &err), &err);
    sn_image_init(&m);
    sn_run run = {.cancel = &stop, .progress = stop_at};
    same(p, &s, &o, 0);
    for (size_t k = 0; k < sizeof steps / sizeof steps[0]; k++) {
        s.scene.stamp = (sn_picture_stamps){k + 2, k + 2, k + 2};
        s.b.field[s.b.mesh.n_vert + 100] += 0.01;
        s.bone[0].pos[0] += 0.01;
        stop_step = steps[k];
        expect(sn_painter_draw(p, &s.scene, &o, &run, &m, NULL, &err), SN_ECANCEL, &err, steps[k]);
        assert_null(m.rgba);
        stop = 0;
        stop_step = NULL;
        same(p, &s, &o, (int)k + 1);
    }
    double good = s.b.field[7];
    s.b.field[7] = INFINITY;
    s.scene.stamp.fields++;
    expect(sn_painter_draw(p, &s.scene, &o, NULL, &m, NULL, &err), SN_EINVAL, &err,
           "tissue 0 has the value inf");
    s.b.field[7] = good; /* the stamp promised nothing: there was no picture */
    same(p, &s, &o, 10);
    o.width = 0;
    expect(sn_painter_draw(p, &s.scene, &o, NULL, &m, NULL, &err), SN_EINVAL, &err, "width is 0");
    sn_painter_destroy(p);
    stage_free(&s);
}

static void test_no_memory(void **state)
{
    (void)state;
    stage s;
    sn_painter *p;
    sn_error err;
    sn_image m;
    stage_make(&s);
    sn_picture_options o = front(16, 16);
    o.has_clip = true;
    o.clip_normal = sn_v3(0, 0, 1);
    ok(sn_painter_create(&p, &err), &err);
    sn_image_init(&m);
    sn_run run = {.n_threads = 1};
    counter c;
    sn_allocator a = {count_realloc, &c};
    long n = 0;
    for (sn_status st = SN_ENOMEM; st; n++) { /* each time everything is new */
        s.scene.stamp = (sn_picture_stamps){(uint64_t)n + 2, (uint64_t)n + 2, (uint64_t)n + 2};
        sn_set_allocator(&a);
        c.left = n;
        st = sn_painter_draw(p, &s.scene, &o, &run, &m, NULL, &err);
        sn_set_allocator(NULL);
        assert_true(st == SN_OK || st == SN_ENOMEM);
    }
    assert_true(n > 40);
    same(p, &s, &o, (int)n);
    sn_image_free(&m);
    sn_painter_destroy(p);
    stage_free(&s);
}

/* ---- threads ---- */

static void *draw_in_thread(void *user)
{
    sn_painter *p = user;
    body b;
    sn_image first, next;
    sn_error err;
    body_make(&b, 5, 3, lobe);
    b.scene.stamp = (sn_picture_stamps){1, 1, 1};
    sn_picture_options o = front(48, 48);
    sn_run run = {.n_threads = 1};
    sn_image_init(&first);
    sn_image_init(&next);
    ok(sn_painter_draw(p, &b.scene, &o, &run, &first, NULL, &err), &err);
    for (int k = 0; k < 5; k++) {
        ok(sn_painter_draw(p, &b.scene, &o, &run, &next, NULL, &err), &err);
        assert_memory_equal(first.rgba, next.rgba, 4 * 48 * 48);
    }
    sn_image_free(&first);
    sn_image_free(&next);
    body_free(&b);
    return NULL;
}

/* Painters in two threads at once; then each in the other thread, one at a time. */
static void test_threads(void **state)
{
    (void)state;
    sn_painter *p[2];
    sn_error err;
    pthread_t thread;
    for (int k = 0; k < 2; k++) ok(sn_painter_create(&p[k], &err), &err);
    for (int round = 0; round < 2; round++) {
        assert_int_equal(pthread_create(&thread, NULL, draw_in_thread, p[round]), 0);
        (void)draw_in_thread(p[1 - round]);
        assert_int_equal(pthread_join(thread, NULL), 0);
    }
    for (int k = 0; k < 2; k++) sn_painter_destroy(p[k]);
    sn_painter_destroy(NULL);
}

/* ---- parts ---- */

/* What lies outside of the box of all that is shown is background whatever the size of the part. */
static void test_zoomed_and_turned_away(void **state)
{
    (void)state;
    stage s;
    sn_image m, tiled;
    sn_error err;
    stage_make(&s);
    sn_picture_options o = front(450, 430);
    sn_box3 box = {{-1, -1, -1}, {1, 1, 1}};
    o.show_fibers = o.show_frames = false;
    ok(sn_camera_look(&o.camera, sn_v3(0, 0, 4), sn_v3(0, 0, 9), sn_v3(0, 1, 0), 40, box, &err), &err);
    sn_picture_stats stats = draw(&s.scene, &o, &m); /* all behind the eye */
    assert_true(stats.is_blank);
    sn_image_free(&m);
    o.samples = 2;
    static const double eye[3][3] = {{0, 0, 30}, {3, 2, 2.5}, {0.1, 0.2, 0.9}}; /* far, beside, inside */
    for (int k = 0; k < 3; k++) {
        ok(sn_camera_look(&o.camera, sn_v3_load(eye[k]), sn_v3(1.0 - k, 0.1, 0), sn_v3(0, 1, 0), 50, box,
                          &err),
           &err);
        sn_image_diff d;
        sn_image_init(&tiled);
        (void)draw(&s.scene, &o, &m);
        ok(draw_tiled(&s.scene, &o, 768, NULL, &tiled, NULL, &err), &err);
        ok(sn_image_compare(&m, &tiled, 3, 450 * 430 / 500, &d, NULL, &err), &err);
        assert_true(d.equal);
        sn_image_free(&m);
        sn_image_free(&tiled);
    }
    stage_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pictures_are_those_of_a_new_painter),
        cmocka_unit_test(test_stamps_are_taken_at_their_word),
        cmocka_unit_test(test_after_an_error),
        cmocka_unit_test(test_no_memory),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_zoomed_and_turned_away),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
