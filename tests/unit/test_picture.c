/* test_picture - what is drawn, as numbers: areas, places, colours, counts. */
#include "made_body.h"
#include "render/draw.h"
#include "render/muscle_tets.h"

/* ---- fields: fat is tissue 0 ---- */

static double below_plane(int32_t i, sn_vec3 p) /* muscle where z < 0.3 */
{
    return i == 0 ? 0.0 : 0.3 - p.z;
}
static double two_sides(int32_t i,
                        sn_vec3 p) /* muscle 1 at x < 0, muscle 2 at x > 0, both below z = 0.3 + |x| / 2 */
{
    return i == 0 ? 0.0 : 0.3 - p.z + (i == 1 ? -0.5 : 0.5) * p.x;
}
static double ball(int32_t i, sn_vec3 p) /* |p| < 0.7 */
{
    return i == 0 ? 0.0 : 0.49 - sn_v3_len2(p);
}
static double only_fat(int32_t i, sn_vec3 p)
{
    return i == 0 ? 1.0 : 0.5 * p.x;
}
static double only_muscle(int32_t i, sn_vec3 p)
{
    return i == 0 ? 0.0 : 2.0 + p.x;
}
static double split_muscles(int32_t i, sn_vec3 p) /* neither is above fat everywhere, together they are */
{
    return i == 0 ? -0.1 : i == 1 ? p.x : -p.x;
}
static double gap_between(int32_t i, sn_vec3 p) /* fat only where |x| < 0.01: inside the boxes around x = 0 */
{
    return i == 0 ? 0.01 : i == 1 ? p.x : -p.x;
}
static double valley_sides(int32_t i,
                           sn_vec3 p) /* three muscles that leave a thin column of fat at the axis */
{
    static const double a[3] = {0.3, 2.4, 4.5};
    return i == 0 ? 0.02 : cos(a[i - 1]) * p.x + sin(a[i - 1]) * p.y;
}

/* ---- the tets that are sent ---- */

static void test_tets_sent(void **state)
{
    (void)state;
    struct {
        field_fn f;
        int n_tissue, n, sent;
    } c[] = {{only_fat, 2, 4, 0},
             {only_muscle, 2, 4, 0},
             {split_muscles, 3, 5, 0},
             {below_plane, 2, 5, 150},  /* z = 0.3 is inside the layer 0.2..0.6: 25 boxes of 6 */
             {gap_between, 3, 5, 150}}; /* and x = 0 inside -0.2..0.2 */
    for (size_t i = 0; i < sizeof c / sizeof c[0]; i++) {
        body b;
        sn_image m;
        sn_muscle_tets t;
        sn_error err;
        body_make(&b, c[i].n, c[i].n_tissue, c[i].f);
        sn_muscle_tets_init(&t);
        ok(find_tets(&t, &b.scene, NULL, &err), &err);
        assert_int_equal(t.n_tet, c[i].sent);
        sn_muscle_tets_free(&t);
        sn_picture_options o = front(32, 32);
        sn_picture_stats stats = draw(&b.scene, &o, &m);
        assert_int_equal(stats.tets_sent, c[i].sent);
        assert_int_equal(stats.is_blank, c[i].f == only_fat);
        assert_true(strlen(stats.renderer) > 10);
        sn_image_free(&m);
        body_free(&b);
    }
}

/* Against a dense sampling of each tet: every tet where both fat and a muscle win at samples is sent, and of
 * the others only those that hold three or more candidates may be. */
static void test_sent_against_samples(void **state)
{
    (void)state;
    field_fn fields[] = {ball, gap_between, valley_sides, two_sides};
    int n_tissue[] = {2, 3, 4, 3};
    for (int q = 0; q < 4; q++) {
        body b;
        sn_muscle_tets t;
        sn_error err;
        body_make(&b, 5, n_tissue[q], fields[q]);
        sn_muscle_tets_init(&t);
        ok(find_tets(&t, &b.scene, NULL, &err), &err);
        int32_t at_sent = 0;
        for (int32_t i = 0; i < b.mesh.n_tet; i++) {
            bool is_sent = at_sent < t.n_tet && t.tet[at_sent] == i, fat = false, muscle = false;
            const int32_t *v = b.mesh.tet + 4 * i;
            for (int s = 0; s < 13 * 13 * 13; s++) {
                double w[4] = {s % 13 / 12.0, s / 13 % 13 / 12.0, s / 169 / 12.0, 0}, best = -1e9;
                w[3] = 1.0 - w[0] - w[1] - w[2];
                if (w[3] < -1e-12) continue;
                for (int32_t k = 1; k < b.n_tissue; k++) {
                    double g = 0.0;
                    for (int c = 0; c < 4; c++) g += w[c] * sn_muscle_above_fat(&b.scene, k - 1, v[c]);
                    best = fmax(best, g);
                }
                fat = fat || best < -1e-9;
                muscle = muscle || best > 1e-9;
            }
            if (fat && muscle) assert_true(is_sent);
            if (is_sent) assert_true(muscle);
            at_sent += is_sent;
        }
        assert_int_equal(at_sent, t.n_tet);
        sn_muscle_tets_free(&t);
        body_free(&b);
    }
}

/* Normals of a linear field are exact; those of a ball point outward. */
static void test_normals(void **state)
{
    (void)state;
    for (int q = 0; q < 2; q++) {
        body b;
        sn_muscle_tets t;
        sn_error err;
        body_make(&b, 8, 2, q ? ball : below_plane);
        sn_muscle_tets_init(&t);
        ok(find_tets(&t, &b.scene, NULL, &err), &err);
        for (int32_t i = 0; i < 4 * t.n_tet; i++) {
            int32_t v = b.mesh.tet[4 * t.tet[i / 4] + i % 4];
            const float *n = sn_muscle_tets_normal(&t, v, 0);
            sn_vec3 want = q ? sn_v3_unit(sn_tet_mesh_point(&b.mesh, v)) : sn_v3(0, 0, 1);
            assert_near(sn_v3_dot(sn_v3((double)n[0], (double)n[1], (double)n[2]), want), 1.0,
                        q ? 0.06 : 1e-6);
        }
        sn_muscle_tets_free(&t);
        body_free(&b);
    }
}

/* ---- surfaces ---- */

static void test_plane_is_where_it_should_be(void **state)
{
    (void)state;
    body b;
    sn_image m;
    body_make(&b, 5, 2, below_plane);
    sn_picture_options o = front(300, 300);
    (void)draw(&b.scene, &o, &m);
    double x0, y0, x1, y1; /* the square [-1, 1]^2 at z = 0.3 hides all that lies behind it */
    assert_true(sn_camera_project(&o.camera, sn_v3(-1, 1, 0.3), 300, 300, &x0, &y0));
    assert_true(sn_camera_project(&o.camera, sn_v3(1, -1, 0.3), 300, 300, &x1, &y1));
    double want = (x1 - x0) * (y1 - y0);
    assert_near(covered(&m), want, 0.01 * want);
    for (int k = 0; k < 200; k++) { /* no hole in it: only light varies, a little */
        int x = (int)x0 + 4 + k * 37 % ((int)(x1 - x0) - 8), y = (int)y0 + 4 + k * 53 % ((int)(y1 - y0) - 8);
        const uint8_t *p = at(&m, x, y), *mid = at(&m, 150, 150);
        assert_int_equal(p[3], 255);
        for (int c = 0; c < 3; c++) assert_true(abs(p[c] - mid[c]) < 24);
    }
    sn_image_free(&m);
    body_free(&b);
}

static void test_ball_silhouette(void **state)
{
    (void)state;
    body b;
    sn_image m;
    body_make(&b, 24, 2, ball);
    for (int samples = 1; samples <= 3; samples++) {
        sn_picture_options o = front(200, 160);
        o.samples = samples;
        (void)draw(&b.scene, &o, &m);
        double d = sn_v3_len(o.camera.eye), slope = 2.0 * tan(o.camera.fov_deg * PI / 360.0) / 160.0;
        double r = 0.7 / sqrt(d * d - 0.49) / slope; /* of the cone of tangents, pixels */
        assert_near(covered(&m), PI * r * r, 0.01 * PI * r * r);
        for (int y = 0; y < 160; y++) /* watertight */
            for (int x = 0; x < 200; x++)
                if (hypot(x - 99.5, y - 79.5) < r - 2.5) assert_int_equal(at(&m, x, y)[3], 255);
        sn_image_free(&m);
    }
    body_free(&b);
}

static void test_nearest_muscle_is_seen(void **state)
{
    (void)state;
    body b;
    sn_image m;
    body_make(&b, 6, 3, two_sides);
    sn_picture_options o = front(120, 120);
    (void)draw(&b.scene, &o, &m);
    for (int k = -8; k <= 8; k++) {
        if (k == 0) continue;
        double x = 0.1 * k;
        const uint8_t *p = at_point(&m, &o.camera, sn_v3(x, 0.2, 0.3 + 0.5 * fabs(x)));
        assert_int_equal(p[3], 255);
        assert_true(hue_distance(p, k < 0 ? 0 : 1) < hue_distance(p, k < 0 ? 1 : 0));
    }
    sn_image_free(&m);
    body_free(&b);
}

/* Muscle up to the border of the mesh: the border is its surface. */
static void test_border_shows_muscle(void **state)
{
    (void)state;
    body b;
    sn_image m;
    body_make(&b, 4, 2, only_muscle);
    sn_picture_options o = front(150, 150);
    (void)draw(&b.scene, &o, &m);
    double x0, y0, x1, y1;
    assert_true(sn_camera_project(&o.camera, sn_v3(-1, 1, 1), 150, 150, &x0, &y0));
    assert_true(sn_camera_project(&o.camera, sn_v3(1, -1, 1), 150, 150, &x1, &y1));
    assert_near(covered(&m), (x1 - x0) * (y1 - y0), 0.015 * (x1 - x0) * (y1 - y0));
    sn_image_free(&m);
    body_free(&b);
}

/* ---- the section ---- */

static void test_section_areas(void **state)
{
    (void)state;
    const sn_rgb fat = {0.965f, 0.925f, 0.780f};
    for (int q = 0; q < 2; q++) { /* through boxes, and exactly along faces of tets */
        body b;
        sn_image m;
        body_make(&b, 24, 2, ball);
        sn_picture_options o = front(400, 400);
        o.has_clip = true;
        o.clip_point = sn_v3(0, 0, q ? 0.0 : 0.03);
        o.clip_normal = sn_v3(0, 0, 2);
        (void)draw(&b.scene, &o, &m);
        double n_muscle = 0, n_fat = 0, n_line = 0;
        for (int i = 0; i < 400 * 400; i++) {
            const uint8_t *p = m.rgba + 4 * i;
            if (p[3] == 0) continue;
            if (color_gap(p, sn_muscle_color(0)) <= 2.0)
                n_muscle++;
            else if (color_gap(p, fat) <= 2.0)
                n_fat++;
            else
                n_line++;
        }
        double all = n_muscle + n_fat + n_line, want = PI * (q ? 0.49 : 0.49 - 0.0009) / 4.0;
        assert_true(n_line < 0.04 * all);
        assert_near((n_muscle + 0.33 * n_line) / all, want,
                    0.01); /* a third of the lines is on the muscle's side */
        assert_true(color_gap(at(&m, 200, 200), sn_muscle_color(0)) <= 1.0);
        double x0, y0, x1, y1;
        assert_true(sn_camera_project(&o.camera, sn_v3(-1, 1, o.clip_point.z), 400, 400, &x0, &y0));
        assert_true(sn_camera_project(&o.camera, sn_v3(1, -1, o.clip_point.z), 400, 400, &x1, &y1));
        assert_near(all, (x1 - x0) * (y1 - y0), 0.01 * all);
        sn_image_free(&m);
        body_free(&b);
    }
}

/* From the kept side the plane is not a wall: the ball is seen as without it; from the other side nothing is
 * left. */
static void test_clip_from_behind(void **state)
{
    (void)state;
    body b;
    sn_image whole, m;
    body_make(&b, 12, 2, ball);
    sn_picture_options o = front(100, 100);
    (void)draw(&b.scene, &o, &whole);
    o.has_clip = true;
    o.clip_point = sn_v3(0, 0, -0.2);
    o.clip_normal = sn_v3(0, 0, -1);
    (void)draw(&b.scene, &o, &m);
    assert_near(covered(&m), covered(&whole), 0.01 * covered(&whole));
    assert_memory_equal(at(&m, 50, 50), at(&whole, 50, 50), 4);
    sn_image_free(&m);
    o.clip_point = sn_v3(0, 0, 3);
    sn_picture_stats stats = draw(&b.scene, &o, &m);
    assert_true(stats.is_blank);
    sn_image_free(&m);
    sn_image_free(&whole);
    body_free(&b);
}

/* ---- tendons ---- */

static const sn_rgb tendon_color = {0.915f, 0.900f, 0.880f};

/* Of each muscle: a value above 0 where normal.p > offset. */
typedef struct tendons {
    float *value[2];
    const float *muscle[2];
} tendons;

static void tendons_make(tendons *t, body *b, sn_vec3 normal, double offset)
{
    size_t n = (size_t)b->mesh.n_vert;
    for (int k = 0; k < 2; k++) {
        t->muscle[k] = t->value[k] = malloc(n * sizeof(float));
        for (size_t v = 0; v < n; v++)
            t->value[k][v] = (float)(sn_v3_dot(normal, sn_tet_mesh_point(&b->mesh, (int32_t)v)) - offset);
    }
    b->scene.tendon = t->muscle;
}

static void tendons_free(tendons *t)
{
    free(t->value[0]);
    free(t->value[1]);
}

static bool is_pale(const uint8_t *p) /* tendon, whatever the light: red not much above blue */
{
    return p[3] == 255 && p[0] < 1.25 * p[2];
}

/* The ball's surface changes where y = 0.123, in pixels; left and right of the middle, too. */
static void test_tendon_border_on_a_ball(void **state)
{
    (void)state;
    body b;
    tendons t;
    sn_image m;
    body_make(&b, 24, 2, ball);
    tendons_make(&t, &b, sn_v3(0, 1, 0), 0.123);
    sn_picture_options o = front(300, 300);
    (void)draw(&b.scene, &o, &m);
    for (int k = -4; k <= 4; k++) {
        double x = 0.1 * k, px, py;
        sn_vec3 p = sn_v3(x, 0.123, sqrt(0.49 - x * x - 0.123 * 0.123));
        assert_true(sn_camera_project(&o.camera, p, 300, 300, &px, &py));
        int at_x = (int)lround(px), first = 0;
        while (first < 300 && !is_pale(at(&m, at_x, first))) first++;
        int last = first;
        while (is_pale(at(&m, at_x, last))) last++;
        assert_near(last - 0.5, py, 1.0);
        for (int y = last; at(&m, at_x, y)[3] == 255; y++) assert_false(is_pale(at(&m, at_x, y)));
    }
    sn_image_free(&m);
    tendons_free(&t);
    body_free(&b);
}

/* Where the muscle reaches the border of the mesh, and in the section. */
static void test_tendon_border_on_flat_pieces(void **state)
{
    (void)state;
    for (int is_section = 0; is_section < 2; is_section++) {
        body b;
        tendons t;
        sn_image m;
        double z = is_section ? 0.1 : 1.0, px, py;
        body_make(&b, 5, 2, only_muscle);
        tendons_make(&t, &b, sn_v3(1, 0.3, 0.5), -0.2);
        sn_picture_options o = front(300, 300);
        o.has_clip = is_section;
        o.clip_point = sn_v3(0, 0, z);
        o.clip_normal = sn_v3(0, 0, 1);
        (void)draw(&b.scene, &o, &m);
        for (int k = -4; k <= 4; k++) {
            double y = 0.2 * k, x = -0.2 - 0.3 * y - 0.5 * z;
            assert_true(sn_camera_project(&o.camera, sn_v3(x, y, z), 300, 300, &px, &py));
            int row = (int)lround(py);
            px += 0.3 * (row - py); /* along the border to the middle of the row: lower means more x */
            for (int i = 3; i < 30; i += 3) {
                assert_true(is_pale(at(&m, (int)lround(px + i), row)));
                if (px - i > 12.0) assert_false(is_pale(at(&m, (int)lround(px - i), row)));
            }
            if (!is_section) continue;
            assert_true(color_gap(at(&m, (int)lround(px + 2), row), tendon_color) <= 1.0);
            assert_true(color_gap(at(&m, (int)lround(px - 2), row), sn_muscle_color(0)) <= 1.0);
        }
        sn_image_free(&m);
        tendons_free(&t);
        body_free(&b);
    }
}

/* Values that are nowhere above 0, or none for any muscle, change nothing; one muscle's leave the other
 * alone. */
static void test_tendon_of_one_muscle(void **state)
{
    (void)state;
    body b;
    tendons t;
    sn_image m[4];
    body_make(&b, 6, 3, two_sides);
    sn_picture_options o = front(120, 120);
    tendons_make(&t, &b, sn_v3(0, 0, 1), 1.0); /* z > 1: at most 0 */
    (void)draw(&b.scene, &o, &m[1]);
    t.muscle[0] = t.muscle[1] = NULL;
    (void)draw(&b.scene, &o, &m[2]);
    b.scene.tendon = NULL;
    (void)draw(&b.scene, &o, &m[0]);
    b.scene.tendon = t.muscle;
    t.muscle[1] = t.value[1];
    for (int32_t v = 0; v < b.mesh.n_vert; v++) t.value[1][v] = 1.0f;
    (void)draw(&b.scene, &o, &m[3]);
    assert_memory_equal(m[0].rgba, m[1].rgba, 4 * 120 * 120);
    assert_memory_equal(m[0].rgba, m[2].rgba, 4 * 120 * 120);
    for (int k = 1; k <= 8; k++) {
        sn_vec3 p = sn_v3(0.1 * k, 0.2, 0.3 + 0.05 * k);
        assert_true(is_pale(at_point(&m[3], &o.camera, p)));
        assert_false(is_pale(at_point(&m[0], &o.camera, p)));
        p.x = -p.x;
        assert_memory_equal(at_point(&m[3], &o.camera, p), at_point(&m[0], &o.camera, p), 3);
    }
    for (int k = 0; k < 4; k++) sn_image_free(&m[k]);
    tendons_free(&t);
    body_free(&b);
}

static void test_tendon_messages(void **state)
{
    (void)state;
    body b;
    tendons t;
    sn_image m;
    sn_error e;
    body_make(&b, 2, 3, two_sides);
    tendons_make(&t, &b, sn_v3(0, 0, 1), 0.0);
    t.value[1][4] = NAN;
    sn_picture_options o = front(20, 20);
    sn_image_init(&m);
    expect(sn_picture_draw(&b.scene, &o, NULL, &m, NULL, &e), SN_EINVAL, &e,
           "picture: the tendon of muscle 2 has the value ");
    assert_non_null(strstr(e.msg, "at vertex 5, need a finite one"));
    tendons_free(&t);
    body_free(&b);
}

/* ---- bones, skin, curves ---- */

/* A small bone a little in front of or behind the muscle's surface: depths of the two ways of drawing agree.
 */
static void test_depth_agrees(void **state)
{
    (void)state;
    body b;
    sn_image m;
    body_make(&b, 5, 2, below_plane);
    for (int side = -1; side <= 1; side += 2) {
        sn_tri_mesh bone;
        const sn_tri_mesh *list[1] = {&bone};
        make_box(&bone, sn_v3(-0.8, -0.8, -0.5), sn_v3(0.8, 0.8, 0.3 + 4e-4 * side));
        b.scene.bone = list;
        b.scene.n_bone = 1;
        sn_picture_options o = front(301, 301); /* odd: some samples lie exactly on edges of tets */
        (void)draw(&b.scene, &o, &m);
        for (int y = 60; y < 240; y++)
            for (int x = 60; x < 240; x++) assert_int_equal(hue_distance(at(&m, x, y), 0) < 0.3, side < 0);
        sn_image_free(&m);
        sn_tri_mesh_free(&bone);
    }
    body_free(&b);
}

static void test_cut_bone_is_capped(void **state)
{
    (void)state;
    const sn_rgb cap = {0.870f, 0.800f, 0.660f};
    sn_tri_mesh bone;
    const sn_tri_mesh *list[1] = {&bone};
    make_box(&bone, sn_v3(-0.5, -0.5, -0.5), sn_v3(0.5, 0.5, 0.5));
    for (int with_body = 0; with_body < 2; with_body++) {
        body b;
        sn_image m;
        body_make(&b, 4, 2, ball);
        if (!with_body) b.scene.tets = NULL;
        b.scene.bone = list;
        b.scene.n_bone = 1;
        sn_picture_options o = front(200, 200);
        o.has_clip = true;
        o.clip_normal = sn_v3(0, 0, 1);
        (void)draw(&b.scene, &o, &m);
        double n = 0, x0, y0, x1, y1;
        for (int i = 0; i < 200 * 200; i++) n += color_gap(m.rgba + 4 * i, cap) <= 1.0;
        assert_true(sn_camera_project(&o.camera, sn_v3(-0.5, 0.5, 0), 200, 200, &x0, &y0));
        assert_true(sn_camera_project(&o.camera, sn_v3(0.5, -0.5, 0), 200, 200, &x1, &y1));
        double want = (x1 - x0) * (y1 - y0);
        assert_true(n <= 1.02 * want && n >= want - 8.0 * (x1 - x0)); /* less a line around it */
        sn_image_free(&m);
        body_free(&b);
    }
    sn_tri_mesh_free(&bone);
}

/* A square seen face on lets through what its opacity says. */
static void test_skin_opacity(void **state)
{
    (void)state;
    sn_tri_mesh skin;
    sn_error err;
    sn_tri_mesh_init(&skin);
    ok(sn_tri_mesh_reserve(&skin, 4, 2, &err), &err);
    memcpy(skin.pos, (double[]){-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0}, 12 * sizeof(double));
    memcpy(skin.face, (int32_t[]){0, 1, 2, 0, 2, 3}, 6 * sizeof(int32_t));
    sn_picture_scene s = {.skin = &skin};
    for (int k = 0; k <= 4; k++) {
        sn_image m;
        sn_picture_options o = front(60, 60);
        o.skin_opacity = 0.25 * k;
        sn_picture_stats stats = draw(&s, &o, &m);
        assert_near(at(&m, 30, 30)[3] / 255.0, 0.25 * k, 0.01);
        assert_int_equal(at(&m, 0, 0)[3], 0);
        assert_int_equal(stats.is_blank, k == 0);
        sn_image_free(&m);
    }
    sn_tri_mesh_free(&skin);
}

static void test_curves_show_through(void **state)
{
    (void)state;
    body b;
    double point[3][6] = {
        {-0.5, 0.5, 0.8, 0.5, 0.5, 0.8}, {-0.5, 0, -0.5, 0.5, 0, -0.5}, {-0.5, -0.5, 0.8, 0.5, -0.5, 0.8}};
    double control[6] = {-0.5, 0, 0.8, 0.5, 0, 0.8};
    sn_picture_curve c[2] = {{point[0], 2, control, 2, {0.1f, 0.2f, 0.9f}},
                             {point[1], 2, NULL, 0, {0.1f, 0.2f, 0.9f}}};
    sn_image with, without;
    body_make(&b, 5, 2, below_plane);
    b.scene.curve = c;
    b.scene.n_curve = 2;
    sn_picture_options o = front(200, 200);
    (void)draw(&b.scene, &o, &with);
    o.show_curves = o.show_points = false;
    (void)draw(&b.scene, &o, &without);
    int full = at_point(&with, &o.camera, sn_v3(0, 0.5, 0.8))[0],
        ground = at_point(&without, &o.camera, sn_v3(0, 0.5, 0.8))[0];
    int faint = at_point(&with, &o.camera, sn_v3(0.1, 0, -0.5))[0],
        under = at_point(&without, &o.camera, sn_v3(0.1, 0, -0.5))[0];
    assert_true(ground - full > 60);                                      /* blue on red */
    assert_true(under - faint > 8 && under - faint < ground - full - 30); /* seen, but less */
    assert_true(at_point(&without, &o.camera, sn_v3(-0.5, 0, 0.8))[0] -
                    at_point(&with, &o.camera, sn_v3(-0.5, 0, 0.8))[0] >
                40);
    sn_image_free(&with);
    sn_image_free(&without);
    body_free(&b);
}

/* ---- the whole ---- */

static void test_same_pixels(void **state)
{
    (void)state;
    body b;
    sn_image m[3];
    sn_error err;
    body_make(&b, 8, 3, two_sides);
    sn_picture_options o = front(90, 70);
    for (int k = 0; k < 3; k++) {
        sn_run run = {.n_threads = 1 + k % 2};
        sn_image_init(&m[k]);
        ok(sn_picture_draw(&b.scene, &o, &run, &m[k], NULL, &err), &err);
        assert_memory_equal(m[0].rgba, m[k].rgba, 4 * 90 * 70);
    }
    for (int k = 0; k < 3; k++) sn_image_free(&m[k]);
    body_free(&b);
}

static void test_tiles_have_no_seams(void **state)
{
    (void)state;
    body b;
    sn_image one, many;
    sn_image_diff d;
    sn_error err;
    body_make(&b, 6, 2, ball);
    sn_tri_mesh bone;
    const sn_tri_mesh *list[1] = {&bone};
    make_box(&bone, sn_v3(-0.9, -0.9, -0.9), sn_v3(0.9, -0.6, 0.2));
    b.scene.bone = list;
    b.scene.n_bone = 1;
    b.scene.skin = &bone;
    sn_picture_options o = front(450, 430);
    o.samples = 2;
    (void)draw(&b.scene, &o, &one);
    sn_image_init(&many);
    ok(draw_tiled(&b.scene, &o, 768, NULL, &many, NULL, &err), &err);
    ok(sn_image_compare(&one, &many, 3, 450 * 430 / 500, &d, NULL, &err), &err);
    assert_true(d.equal);
    sn_image_free(&one);
    sn_image_free(&many);
    sn_tri_mesh_free(&bone);
    body_free(&b);
}

static void test_background_and_blank(void **state)
{
    (void)state;
    sn_picture_scene nothing = {0};
    sn_picture_options o = front(40, 30);
    const float back[4] = {0.2f, 0.4f, 0.6f, 0.8f};
    memcpy(o.background, back, sizeof back);
    sn_image m;
    sn_picture_stats stats = draw(&nothing, &o, &m);
    assert_true(stats.is_blank && stats.tets_sent == 0 && stats.seconds > 0.0);
    for (int i = 0; i < 40 * 30; i++)
        assert_memory_equal(m.rgba + 4 * i, ((uint8_t[]){51, 102, 153, 204}), 4);
    sn_image_free(&m);
}

static volatile sig_atomic_t stop;
static void stop_at_light(void *user, const char *step, double fraction)
{
    (void)user;
    (void)fraction;
    if (strcmp(step, "lighting") == 0) stop = 1;
}

static void test_messages(void **state)
{
    (void)state;
    body b;
    sn_image m;
    sn_error e;
    body_make(&b, 2, 2, ball);
    sn_image_init(&m);
#define DRAW() sn_picture_draw(&b.scene, &o, NULL, &m, NULL, &e)
    sn_picture_options good = front(20, 20), o = good;
    o.width = 0;
    expect(DRAW(), SN_EINVAL, &e, "width is 0 pixels, need 1..16384");
    o = good;
    o.height = 20000;
    expect(DRAW(), SN_EINVAL, &e, "height is 20000 pixels");
    o = good;
    o.samples = 5;
    expect(DRAW(), SN_EINVAL, &e, "5 samples per pixel side, need 1..4");
    o = good;
    o.skin_opacity = NAN;
    expect(DRAW(), SN_EINVAL, &e, "skin opacity");
    o = good;
    o.background[3] = 2.0f;
    expect(DRAW(), SN_EINVAL, &e, "background value 4 is 2, need 0..1");
    o = good;
    o.has_clip = true;
    expect(DRAW(), SN_EINVAL, &e, "clip plane has normal (0, 0, 0)");
    o = good;
    o.camera.fov_deg = 0.0;
    expect(DRAW(), SN_EINVAL, &e, "field of view is 0 degrees");
    o = good;
    b.field[27 + 4] = NAN;
    expect(DRAW(), SN_EINVAL, &e, "tissue 1 has the value nan at vertex 5");
    assert_null(m.rgba);
    b.field[27 + 4] = 0.0;
    b.scene.n_tissue = 0;
    expect(DRAW(), SN_EINVAL, &e, "a tet mesh with 0 tissues");
    b.scene.n_tissue = 1; /* fat alone is fine */
    ok(DRAW(), &e);
    b.scene.n_tissue = 2;
    sn_run run = {.cancel = &stop, .progress = stop_at_light};
    expect(sn_picture_draw(&b.scene, &o, &run, &m, NULL, &e), SN_ECANCEL, &e, "interrupted while lighting");
    assert_null(m.rgba);
#undef DRAW
    body_free(&b);
}

static void test_no_memory(void **state)
{
    (void)state;
    body b;
    sn_image m;
    sn_error e;
    sn_tri_mesh bone;
    const sn_tri_mesh *list[1] = {&bone};
    double line[6] = {-0.5, 0, 0.5, 0.5, 0, 0.5};
    sn_picture_curve curve = {line, 2, line, 2, {1, 0, 0}};
    body_make(&b, 2, 2, ball);
    make_box(&bone, sn_v3(-0.9, -0.9, -0.9), sn_v3(0.9, -0.6, 0.2));
    b.scene.bone = list;
    b.scene.n_bone = 1;
    b.scene.skin = &bone;
    b.scene.curve = &curve;
    b.scene.n_curve = 1;
    sn_picture_options o = front(12, 12);
    o.has_clip = true;
    o.clip_normal = sn_v3(0, 0, 1);
    sn_image_init(&m);
    counter c;
    sn_run run = {.n_threads = 1};
    sn_allocator a = {count_realloc, &c};
    sn_set_allocator(&a);
    long n = 0;
    for (;; n++) {
        c.left = n;
        sn_status st = sn_picture_draw(&b.scene, &o, &run, &m, NULL, &e);
        if (st == SN_OK) break;
        assert_int_equal(st, SN_ENOMEM);
        assert_null(m.rgba);
    }
    sn_image_free(&m);
    sn_set_allocator(NULL);
    assert_true(n > 40);
    sn_tri_mesh_free(&bone);
    body_free(&b);
}

static void test_corner_normals(void **state)
{
    (void)state;
    sn_tri_mesh m;
    sn_error err;
    float n[108];
    make_box(&m, sn_v3(0, 0, 0), sn_v3(1, 1, 1));
    ok(sn_corner_normals(&m, 50.0, NULL, n, &err), &err); /* sharp: each corner its own face's */
    for (int i = 0; i < 36; i++) {
        sn_vec3 f = sn_v3_unit(sn_tri_mesh_face_normal(&m, i / 3));
        assert_near(sn_v3_dot(f, sn_v3((double)n[3 * i], (double)n[3 * i + 1], (double)n[3 * i + 2])), 1.0,
                    1e-6);
    }
    ok(sn_corner_normals(&m, 100.0, NULL, n, &err), &err); /* smooth: by angle, along the cube's diagonals */
    for (int i = 0; i < 36; i++) {
        sn_vec3 d = sn_v3_sub(sn_tri_mesh_point(&m, m.face[i]), sn_v3(0.5, 0.5, 0.5));
        assert_near(
            sn_v3_dot(sn_v3_unit(d), sn_v3((double)n[3 * i], (double)n[3 * i + 1], (double)n[3 * i + 2])),
            1.0, 1e-6);
    }
    sn_tri_mesh_free(&m);
}

/* CIELAB, D65. */
static sn_vec3 lab(sn_rgb c)
{
    double in[3] = {(double)c.r, (double)c.g, (double)c.b}, f[3];
    for (int k = 0; k < 3; k++) in[k] = in[k] <= 0.04045 ? in[k] / 12.92 : pow((in[k] + 0.055) / 1.055, 2.4);
    f[0] = (0.4124564 * in[0] + 0.3575761 * in[1] + 0.1804375 * in[2]) / 0.95047;
    f[1] = 0.2126729 * in[0] + 0.7151522 * in[1] + 0.0721750 * in[2];
    f[2] = (0.0193339 * in[0] + 0.1191920 * in[1] + 0.9503041 * in[2]) / 1.08883;
    for (int k = 0; k < 3; k++) f[k] = f[k] > 0.008856 ? cbrt(f[k]) : 7.787 * f[k] + 16.0 / 116.0;
    return sn_v3(116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2]));
}

static void test_colors(void **state)
{
    (void)state;
    for (int i = 0; i < 40; i++)
        for (int j = 0; j < i; j++)
            assert_true(sn_v3_dist(lab(sn_muscle_color(i)), lab(sn_muscle_color(j))) > 12.0);
    for (int i = 0; i + 1 < 500; i++) { /* neighbours differ more; nothing leaves the range */
        sn_rgb c = sn_muscle_color(i);
        assert_true(sn_v3_dist(lab(c), lab(sn_muscle_color(i + 1))) > 15.0);
        assert_true(c.r >= 0 && c.r <= 1 && c.g >= 0 && c.g <= 1 && c.b >= 0 && c.b <= 1);
    }
    sn_rgb first = sn_muscle_color(0); /* the same for ever */
    assert_true(color_gap((const uint8_t[]){175, 65, 55}, first) < 0.01);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tets_sent),
        cmocka_unit_test(test_sent_against_samples),
        cmocka_unit_test(test_normals),
        cmocka_unit_test(test_plane_is_where_it_should_be),
        cmocka_unit_test(test_ball_silhouette),
        cmocka_unit_test(test_nearest_muscle_is_seen),
        cmocka_unit_test(test_border_shows_muscle),
        cmocka_unit_test(test_section_areas),
        cmocka_unit_test(test_clip_from_behind),
        cmocka_unit_test(test_tendon_border_on_a_ball),
        cmocka_unit_test(test_tendon_border_on_flat_pieces),
        cmocka_unit_test(test_tendon_of_one_muscle),
        cmocka_unit_test(test_tendon_messages),
        cmocka_unit_test(test_depth_agrees),
        cmocka_unit_test(test_cut_bone_is_capped),
        cmocka_unit_test(test_skin_opacity),
        cmocka_unit_test(test_curves_show_through),
        cmocka_unit_test(test_same_pixels),
        cmocka_unit_test(test_tiles_have_no_seams),
        cmocka_unit_test(test_background_and_blank),
        cmocka_unit_test(test_messages),
        cmocka_unit_test(test_no_memory),
        cmocka_unit_test(test_corner_normals),
        cmocka_unit_test(test_colors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
