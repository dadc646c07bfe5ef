/* test_picture_lines - fibers and arrows: where they are, what hides them, what they do to the rest. */
#include "made_body.h"
#include "render/draw.h"

static const sn_rgb blue = {0.1f, 0.2f, 0.9f};

static double pixels_per_length(const sn_picture_options *o, double z) /* at distance z in front of 0 */
{
    double x0, x1, y;
    assert_true(sn_camera_project(&o->camera, sn_v3(-0.5, 0, z), o->width, o->height, &x0, &y));
    assert_true(sn_camera_project(&o->camera, sn_v3(0.5, 0, z), o->width, o->height, &x1, &y));
    return x1 - x0;
}

static double below_z(int32_t i, sn_vec3 p) /* muscle where z < 0.3 */
{
    return i == 0 ? 0.0 : 0.3 - p.z;
}

/* ---- fibers ---- */

/* The area of the tube's outline: 2 r long, with a half disc at each end. */
static void test_fiber_is_where_it_should_be(void **state)
{
    (void)state;
    const double end[3][6] = {
        {-0.7, 0.1, 0, 0.7, 0.1, 0}, {0.1, -0.7, 0.2, 0.1, 0.7, 0.2}, {-0.6, -0.5, 0, 0.5, 0.6, 0}};
    for (int i = 0; i < 3; i++)
        for (int thick = 0; thick < 2; thick++) {
            sn_picture_line l = {end[i], 2, blue};
            sn_picture_scene s = {.fiber = &l, .n_fiber = 1, .unit = thick ? 50.0 : 1.0};
            sn_picture_options o = front(300, 300);
            sn_image m;
            o.samples = 4;
            sn_picture_stats stats = draw(&s, &o, &m);
            assert_false(stats.is_blank);
            sn_vec3 a = sn_v3_load(end[i]), b = sn_v3_load(end[i] + 3);
            double scale = pixels_per_length(&o, a.z);
            double r = thick ? 0.0008 * 50.0 * scale : 0.65, length = scale * sn_v3_dist(a, b);
            assert_near(covered(&m), 2.0 * r * length + PI * r * r, (thick ? 0.02 : 0.16) * 2.0 * r * length);
            for (int k = 0; k <= 10; k++)
                assert_true(at_point(&m, &o.camera, sn_v3_lerp(a, b, k / 10.0))[3] > 120);
            sn_vec3 t = sn_v3_unit(sn_v3_sub(b, a)), side = sn_v3(-t.y, t.x, 0), mid = sn_v3_lerp(a, b, 0.4);
            for (int way = -1; way <= 1; way += 2) {
                double off =
                    way * (r + 2.0) / scale; /* two pixels beyond the edge: a pixel's filter reaches one */
                assert_int_equal(at_point(&m, &o.camera, sn_v3_mad(mid, off, side))[3], 0);
                assert_int_equal(at_point(&m, &o.camera, sn_v3_mad(way < 0 ? a : b, off, t))[3], 0);
                if (thick)
                    assert_int_equal(
                        at_point(&m, &o.camera, sn_v3_mad(mid, way * (r - 2.0) / scale, side))[3], 255);
            }
            sn_image_free(&m);
        }
}

/* Lit from the upper left: a tube across the picture is brighter on its upper side, in its own hue. */
static void test_fiber_is_a_lit_tube(void **state)
{
    (void)state;
    const double end[6] = {-0.7, 0, 0, 0.7, 0, 0};
    sn_picture_line l = {end, 2, blue};
    sn_picture_scene s = {.fiber = &l, .n_fiber = 1, .unit = 100.0}; /* radius 0.08 */
    sn_picture_options o = front(300, 300);
    sn_image m;
    (void)draw(&s, &o, &m);
    const uint8_t *up = at_point(&m, &o.camera, sn_v3(0, 0.05, 0)),
                  *down = at_point(&m, &o.camera, sn_v3(0, -0.06, 0));
    assert_true(up[2] > down[2] + 30);
    assert_true(up[2] > up[0] + 50 && down[2] > down[0] + 30);
    sn_image_free(&m);
}

/* Seen from its end a fiber is a disc. */
static void test_fiber_end_on(void **state)
{
    (void)state;
    const double end[6] = {0, 0, -0.5, 0, 0, 0.5};
    sn_picture_line l = {end, 2, blue};
    sn_picture_scene s = {.fiber = &l, .n_fiber = 1, .unit = 100.0};
    sn_picture_options o = front(300, 300);
    sn_image m;
    (void)draw(&s, &o, &m);
    double r0 = 0.08 * pixels_per_length(&o, -0.5), r1 = 0.08 * pixels_per_length(&o, 0.5);
    assert_true(covered(&m) > 0.9 * PI * r0 * r0 && covered(&m) < 1.05 * PI * r1 * r1);
    sn_image_free(&m);
}

static void test_bones_hide_fibers(void **state)
{
    (void)state;
    const double point[3][6] = {
        {-0.4, 0, 0.6, 0.4, 0, 0.6}, {-0.4, 0, 0, 0.4, 0, 0}, {-0.4, 0.1, -0.6, 0.4, 0.1, -0.6}};
    sn_picture_line l[3];
    for (int i = 0; i < 3; i++) l[i] = (sn_picture_line){point[i], 2, blue};
    sn_tri_mesh bone;
    const sn_tri_mesh *list[1] = {&bone};
    make_box(&bone, sn_v3(-0.6, -0.6, -0.3), sn_v3(0.6, 0.6, 0.3));
    sn_picture_scene s = {.bone = list, .n_bone = 1, .fiber = l, .n_fiber = 3, .unit = 3.5};
    sn_picture_options o = front(200, 200);
    sn_image with, without, hidden;
    (void)draw(&s, &o, &with);
    o.show_fibers = false;
    (void)draw(&s, &o, &without);
    o.show_fibers = true;
    s.fiber = l + 1; /* those inside and behind */
    s.n_fiber = 2;
    (void)draw(&s, &o, &hidden);
    assert_memory_equal(hidden.rgba, without.rgba, 4 * 200 * 200);
    const uint8_t *p = at_point(&with, &o.camera, sn_v3(0, 0, 0.6)),
                  *q = at_point(&without, &o.camera, sn_v3(0, 0, 0.6));
    assert_true(q[0] - p[0] > 80 && p[2] > p[0]);
    sn_image_free(&with);
    sn_image_free(&without);
    sn_image_free(&hidden);
    sn_tri_mesh_free(&bone);
}

/* With the muscles drawn, fibers are laid over them: full in front, faint inside. Without: as they are. */
static void test_fibers_over_muscles(void **state)
{
    (void)state;
    body b;
    const double point[2][6] = {{-0.5, 0.5, 0.8, 0.5, 0.5, 0.8}, {-0.5, 0, -0.5, 0.5, 0, -0.5}};
    sn_picture_line l[2] = {{point[0], 2, blue}, {point[1], 2, blue}};
    sn_image m[3]; /* muscles, both, fibers */
    body_make(&b, 5, 2, below_z);
    b.scene.fiber = l;
    b.scene.n_fiber = 2;
    b.scene.unit = 20.0;
    for (int k = 0; k < 3; k++) {
        sn_picture_options o = front(200, 200);
        o.show_fibers = k > 0;
        o.show_muscles = k < 2;
        (void)draw(&b.scene, &o, &m[k]);
    }
    sn_camera c = front(200, 200).camera;
    sn_vec3 before = sn_v3(0, 0.5, 0.8), inside = sn_v3(0.1, 0, -0.5);
    int full = at_point(&m[0], &c, before)[0] - at_point(&m[1], &c, before)[0];
    int faint = at_point(&m[0], &c, inside)[0] - at_point(&m[1], &c, inside)[0];
    assert_true(full > 60);
    assert_true(faint > 8 && faint < full - 30);
    assert_int_equal(at_point(&m[2], &c, inside)[3], 255);
    assert_true(at_point(&m[2], &c, inside)[2] > 100);
    assert_int_equal(at_point(&m[2], &c, sn_v3(0, -0.5, 0))[3], 0);
    for (int k = 0; k < 3; k++) sn_image_free(&m[k]);
    body_free(&b);
}

static void test_neighbours_differ(void **state)
{
    (void)state;
    double point[12][6];
    sn_picture_line l[12];
    for (int i = 0; i < 12; i++) {
        double y = 0.1 * i - 0.55;
        memcpy(point[i], (double[]){-0.7, y, 0, 0.7, y, 0}, sizeof point[i]);
        l[i] = (sn_picture_line){point[i], 2, {0.7f, 0.3f, 0.2f}};
    }
    sn_picture_scene s = {.fiber = l, .n_fiber = 12, .unit = 40.0};
    sn_picture_options o = front(300, 300);
    sn_image m;
    (void)draw(&s, &o, &m);
    for (int i = 0; i + 1 < 12; i++) {
        const uint8_t *p = at_point(&m, &o.camera, sn_v3(0, point[i][1], 0)),
                      *q = at_point(&m, &o.camera, sn_v3(0, point[i + 1][1], 0));
        assert_true(abs(p[0] - q[0]) + abs(p[1] - q[1]) + abs(p[2] - q[2]) > 10);
        assert_true(p[0] > p[1] + 40 && p[1] >= p[2]); /* still the same red */
    }
    sn_image_free(&m);
}

static void test_fibers_are_clipped(void **state)
{
    (void)state;
    const double end[6] = {-0.7, 0, 0, 0.7, 0, 0};
    sn_picture_line l = {end, 2, blue};
    sn_picture_arrow a = {{-0.7, -0.5, 0}, {1.4, 0, 0}, {1, 0, 0}};
    sn_picture_scene s = {.fiber = &l, .n_fiber = 1, .arrow = &a, .n_arrow = 1, .unit = 20.0};
    sn_picture_options o = front(200, 200);
    o.has_clip = true;
    o.clip_normal = sn_v3(1, 0, 0);
    sn_image m;
    (void)draw(&s, &o, &m);
    for (int k = 0; k < 2; k++) {
        assert_true(at_point(&m, &o.camera, sn_v3(-0.1, -0.5 * k, 0))[3] > 200);
        assert_int_equal(at_point(&m, &o.camera, sn_v3(0.1, -0.5 * k, 0))[3], 0);
    }
    sn_image_free(&m);
}

/* Lines that are hardly lines: nothing, a dot, a line that stands still, one through the eye. */
static void test_strange_fibers(void **state)
{
    (void)state;
    sn_picture_options o = front(200, 200);
    sn_vec3 e = o.camera.eye;
    const double dot[9] = {0.2, 0.1, 0, 0.2, 0.1, 0, 0.2, 0.1, 0};
    const double eye[9] = {0, 0, 0, e.x, e.y, e.z, e.x, e.y, 2 * e.z};
    sn_picture_line l[4] = {{dot, 0, blue}, {dot, 1, blue}, {dot, 3, blue}, {eye, 3, blue}};
    for (int i = 0; i < 4; i++) {
        sn_picture_scene s = {.fiber = &l[i], .n_fiber = 1, .unit = 50.0};
        sn_image m;
        sn_picture_stats stats = draw(&s, &o, &m);
        double r = 0.04 * pixels_per_length(&o, 0.0);
        assert_int_equal(stats.is_blank, i == 0);
        if (i == 1 || i == 2) assert_near(covered(&m), PI * r * r, 0.1 * PI * r * r);
        sn_image_free(&m);
    }
    sn_picture_scene s = {.fiber = l, .n_fiber = 2, .unit = 50.0}; /* an empty one among others */
    sn_image m;
    assert_false(draw(&s, &o, &m).is_blank);
    sn_image_free(&m);
}

/* A bundle in several batches: the same with any number of threads, and in tiles. */
static void test_bundle(void **state)
{
    (void)state;
    enum { n = 2500, n_point = 60 };
    double *point = malloc(sizeof(double) * 3 * n * n_point);
    sn_picture_line *l = malloc(sizeof *l * n);
    for (int i = 0; i < n; i++) {
        double a = 2.39996 * i, r = 0.5 * sqrt((i + 0.5) / n);
        for (int k = 0; k < n_point; k++) {
            double t = 2.0 * k / (n_point - 1) - 1.0, w = r * (1.1 - t * t);
            sn_v3_store(point + 3 * (i * n_point + k), sn_v3(w * cos(a + t), 0.9 * t, w * sin(a + t)));
        }
        l[i] = (sn_picture_line){point + 3 * i * n_point, n_point, {0.7f, 0.3f, 0.25f}};
    }
    sn_picture_scene s = {.fiber = l, .n_fiber = n, .unit = 3.5};
    sn_picture_options o = front(450, 430);
    sn_image m[3];
    sn_image_diff d;
    sn_error err;
    o.samples = 2;
    for (int k = 0; k < 3; k++) {
        sn_run run = {.n_threads = 1 + k % 2};
        sn_image_init(&m[k]);
        ok(draw_tiled(&s, &o, k == 2 ? 768 : 2048, &run, &m[k], NULL, &err), &err);
    }
    assert_memory_equal(m[0].rgba, m[1].rgba, 4 * 450 * 430);
    ok(sn_image_compare(&m[0], &m[2], 8, 450 * 430 / 200, &d, NULL, &err), &err);
    assert_true(d.equal);
    assert_true(covered(&m[0]) > 10000.0);
    for (int k = 0; k < 3; k++) sn_image_free(&m[k]);
    free(point);
    free(l);
}

/* ---- arrows ---- */

static double column(const sn_image *m, int x) /* pixels covered */
{
    double sum = 0.0;
    for (int y = 0; y < m->height; y++) sum += at(m, x, y)[3] / 255.0;
    return sum;
}

static void test_arrow_is_where_it_should_be(void **state)
{
    (void)state;
    sn_picture_arrow a = {{-0.5, 0, 0}, {1, 0, 0}, {0.9f, 0.1f, 0.1f}};
    sn_picture_scene s = {.arrow = &a, .n_arrow = 1};
    sn_picture_options o = front(400, 400);
    sn_image m;
    o.samples = 4;
    (void)draw(&s, &o, &m);
    double scale = pixels_per_length(&o, 0.0), x0, x1, neck, y;
    assert_true(sn_camera_project(&o.camera, a.from, 400, 400, &x0, &y));
    assert_true(sn_camera_project(&o.camera, sn_v3(0.5, 0, 0), 400, 400, &x1, &y));
    assert_true(sn_camera_project(&o.camera, sn_v3(0.16, 0, 0), 400, 400, &neck, &y));
    assert_near(column(&m, (int)(0.5 * (x0 + neck))), 2.0 * (0.028 * scale + 0.8), 0.6);
    for (int d = 3; d < 45; d += 6) { /* the head tapers */
        double left = 1.0 - ((int)neck + d - neck) / (x1 - neck);
        assert_near(column(&m, (int)neck + d), 6.0 * 0.028 * scale * left + 1.6, 0.9);
    }
    assert_int_equal((int)(column(&m, (int)x0 - 4) + column(&m, (int)x1 + 4)), 0);
    const uint8_t *p = at_point(&m, &o.camera, sn_v3(-0.2, 0, 0));
    assert_true(p[3] == 255 && p[0] > p[1] + 80 && p[0] > p[2] + 80);
    sn_image_free(&m);
    o.show_frames = false;
    assert_true(draw(&s, &o, &m).is_blank);
    sn_image_free(&m);
    o.show_frames = true;
    a.along = sn_v3(0, 0, 0);
    assert_true(draw(&s, &o, &m).is_blank);
    sn_image_free(&m);
}

/* Small arrows keep a shaft of about two pixels. */
static void test_small_arrow(void **state)
{
    (void)state;
    sn_picture_arrow a = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.6f, 0}};
    sn_picture_scene s = {.arrow = &a, .n_arrow = 1, .unit = 3.5};
    sn_picture_options o = front(200, 200);
    sn_image m;
    double x, y;
    o.samples = 4;
    (void)draw(&s, &o, &m);
    assert_true(sn_camera_project(&o.camera, sn_v3(0.03, 0, 0), 200, 200, &x, &y));
    assert_near(column(&m, (int)lround(x)), 2.0 * (0.9 + 0.8), 0.5);
    sn_image_free(&m);
}

static void test_arrows_show_through(void **state)
{
    (void)state;
    sn_picture_arrow a[2] = {{{-0.5, 0.5, 0.8}, {1, 0, 0}, blue}, {{-0.5, -0.3, -0.5}, {1, 0, 0}, blue}};
    body b;
    sn_image with, without;
    body_make(&b, 5, 2, below_z);
    b.scene.arrow = a;
    b.scene.n_arrow = 2;
    sn_picture_options o = front(200, 200);
    (void)draw(&b.scene, &o, &with);
    o.show_frames = false;
    (void)draw(&b.scene, &o, &without);
    sn_vec3 p = sn_v3(-0.1, 0.5, 0.8), q = sn_v3(-0.1, -0.3, -0.5);
    int full = at_point(&without, &o.camera, p)[0] - at_point(&with, &o.camera, p)[0];
    int faint = at_point(&without, &o.camera, q)[0] - at_point(&with, &o.camera, q)[0];
    assert_true(full > 60 && faint > 8 && faint < full - 30);
    sn_image_free(&with);
    sn_image_free(&without);
    body_free(&b);
}

/* ---- both ---- */

static void test_messages(void **state)
{
    (void)state;
    double point[6] = {0, 0, 0, 1, NAN, 0};
    sn_picture_line l[2] = {{point, 1, blue}, {point, 2, blue}};
    sn_picture_arrow a[2] = {{{0, 0, 0}, {1, 0, 0}, blue}, {{0, 0, 0}, {1, INFINITY, 0}, blue}};
    sn_picture_scene s = {.fiber = l, .n_fiber = 2, .arrow = a, .n_arrow = 2};
    sn_picture_options o = front(20, 20);
    sn_image m;
    sn_error e;
    sn_image_init(&m);
    expect(sn_picture_draw(&s, &o, NULL, &m, NULL, &e), SN_EINVAL, &e,
           "picture: point 2 of fiber 2 is not finite");
    s.n_fiber = 1;
    expect(sn_picture_draw(&s, &o, NULL, &m, NULL, &e), SN_EINVAL, &e, "picture: arrow 2 is not finite");
    assert_null(m.rgba);
}

static void test_no_memory(void **state)
{
    (void)state;
    const double point[6] = {-0.5, 0, 0.5, 0.5, 0, 0.5};
    sn_picture_line l = {point, 2, blue};
    sn_picture_arrow a = {{0, 0, 0}, {1, 0, 0}, blue};
    sn_picture_scene s = {.fiber = &l, .n_fiber = 1, .arrow = &a, .n_arrow = 1};
    sn_picture_options o = front(12, 12);
    sn_image m;
    sn_error e;
    sn_image_init(&m);
    counter c;
    sn_run run = {.n_threads = 1};
    sn_allocator dry = {count_realloc, &c};
    sn_set_allocator(&dry);
    long n = 0;
    for (;; n++) {
        c.left = n;
        sn_status st = sn_picture_draw(&s, &o, &run, &m, NULL, &e);
        if (st == SN_OK) break;
        assert_int_equal(st, SN_ENOMEM);
        assert_null(m.rgba);
    }
    sn_image_free(&m);
    sn_set_allocator(NULL);
    assert_true(n >= 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fiber_is_where_it_should_be),
        cmocka_unit_test(test_fiber_is_a_lit_tube),
        cmocka_unit_test(test_fiber_end_on),
        cmocka_unit_test(test_bones_hide_fibers),
        cmocka_unit_test(test_fibers_over_muscles),
        cmocka_unit_test(test_neighbours_differ),
        cmocka_unit_test(test_fibers_are_clipped),
        cmocka_unit_test(test_strange_fibers),
        cmocka_unit_test(test_bundle),
        cmocka_unit_test(test_arrow_is_where_it_should_be),
        cmocka_unit_test(test_small_arrow),
        cmocka_unit_test(test_arrows_show_through),
        cmocka_unit_test(test_messages),
        cmocka_unit_test(test_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
