/* test_camera - presets, orbit, look, projection and its inverse. */
#include "render/camera.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include <string.h>

static const sn_box3 box = {{-1, -2, -3}, {3, 4, 5}};
static const char *const names[] = {"front", "back", "left", "right", "top", "bottom", "iso"};

static void assert_near(double a, double b, double tol)
{
    if (!(fabs(a - b) <= tol)) fail_msg("%.17g is not %.17g within %g", a, b, tol);
}

static sn_camera preset(const char *name, sn_up up, double aspect)
{
    sn_camera c;
    sn_error err;
    if (sn_camera_preset(&c, name, box, up, aspect, &err)) fail_msg("%s", err.msg);
    assert_int_equal(sn_camera_check(&c, &err), SN_OK);
    return c;
}

static sn_vec3 corner(int k)
{
    return sn_v3(k & 1 ? box.max.x : box.min.x, k & 2 ? box.max.y : box.min.y, k & 4 ? box.max.z : box.min.z);
}

static void test_eye_sides(void **state)
{
    (void)state;
    struct {
        const char *name;
        sn_up up;
        sn_vec3 toward, above; /* from the target to the eye; up in the picture */
    } want[] = {{"front", SN_UP_Y, {0, 0, 1}, {0, 1, 0}},  {"back", SN_UP_Y, {0, 0, -1}, {0, 1, 0}},
                {"left", SN_UP_Y, {1, 0, 0}, {0, 1, 0}},   {"right", SN_UP_Y, {-1, 0, 0}, {0, 1, 0}},
                {"top", SN_UP_Y, {0, 1, 0}, {0, 0, -1}},   {"bottom", SN_UP_Y, {0, -1, 0}, {0, 0, 1}},
                {"front", SN_UP_Z, {0, -1, 0}, {0, 0, 1}}, {"back", SN_UP_Z, {0, 1, 0}, {0, 0, 1}},
                {"left", SN_UP_Z, {1, 0, 0}, {0, 0, 1}},   {"right", SN_UP_Z, {-1, 0, 0}, {0, 0, 1}},
                {"top", SN_UP_Z, {0, 0, 1}, {0, 1, 0}},    {"bottom", SN_UP_Z, {0, 0, -1}, {0, -1, 0}}};
    for (size_t i = 0; i < sizeof want / sizeof want[0]; i++) {
        sn_camera c = preset(want[i].name, want[i].up, 1.5);
        sn_vec3 right, up, back;
        sn_camera_frame(&c, &right, &up, &back);
        assert_near(sn_v3_dist(back, want[i].toward), 0.0, 1e-12);
        assert_near(sn_v3_dist(up, want[i].above), 0.0, 1e-12);
        assert_near(sn_v3_dist(c.target, sn_v3(1, 1, 1)), 0.0, 1e-12);
    }
}

/* Every corner is inside the picture, and some corner is near its border: the fit is not loose. */
static void test_box_fits(void **state)
{
    (void)state;
    const int size[3][2] = {{800, 600}, {300, 900}, {1000, 100}};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        for (int up = 0; up < 2; up++)
            for (int s = 0; s < 3; s++) {
                int w = size[s][0], h = size[s][1];
                sn_camera c = preset(names[i], (sn_up)up, (double)w / h);
                double reach = 0.0;
                for (int k = 0; k < 8; k++) {
                    double x, y, depth;
                    sn_vec3 right, u, back;
                    assert_true(sn_camera_project(&c, corner(k), w, h, &x, &y));
                    reach = fmax(reach, fmax(fabs((x + 0.5) / w - 0.5), fabs((y + 0.5) / h - 0.5)));
                    sn_camera_frame(&c, &right, &u, &back);
                    depth = -sn_v3_dot(sn_v3_sub(corner(k), c.eye), back);
                    assert_true(depth > c.znear && depth < c.zfar);
                }
                assert_true(reach <= 0.5 && reach > 0.47);
            }
}

static void test_ray_and_project_are_inverse(void **state)
{
    (void)state;
    sn_camera c = preset("iso", SN_UP_Z, 1.25);
    for (int k = 0; k < 5; k++) {
        double x = 37.0 * k - 3.25, y = 200.5 - 31.0 * k, px, py;
        sn_vec3 o, d;
        sn_camera_ray(&c, x, y, 250, 200, &o, &d);
        assert_near(sn_v3_len(d), 1.0, 1e-14);
        assert_true(sn_camera_project(&c, sn_v3_mad(o, 7.5, d), 250, 200, &px, &py));
        assert_near(px, x, 1e-9);
        assert_near(py, y, 1e-9);
        assert_false(sn_camera_project(&c, sn_v3_mad(o, -1.0, d), 250, 200, &px, &py));
    }
    double px, py; /* the target is the middle of the picture: between pixels 124 and 125, 99 and 100 */
    assert_true(sn_camera_project(&c, c.target, 250, 200, &px, &py));
    assert_near(px, 124.5, 1e-9);
    assert_near(py, 99.5, 1e-9);
}

/* The matrices put a point where sn_camera_project does, with depth -1 at znear and 1 at zfar. */
static void test_matrices_agree(void **state)
{
    (void)state;
    sn_camera c = preset("iso", SN_UP_Y, 2.0);
    float view[16], proj[16];
    sn_camera_matrices(&c, 2.0, view, proj);
    for (int k = 0; k < 8; k++) {
        sn_vec3 p = corner(k);
        double in[4] = {p.x, p.y, p.z, 1.0}, eye[4], clip[4], x, y;
        for (int r = 0; r < 4; r++) {
            eye[r] = 0.0;
            for (int j = 0; j < 4; j++) eye[r] += (double)view[4 * j + r] * in[j];
        }
        for (int r = 0; r < 4; r++) {
            clip[r] = 0.0;
            for (int j = 0; j < 4; j++) clip[r] += (double)proj[4 * j + r] * eye[j];
        }
        assert_true(sn_camera_project(&c, p, 400, 200, &x, &y));
        assert_near((clip[0] / clip[3] + 1.0) * 200.0 - 0.5, x, 1e-3);
        assert_near((1.0 - clip[1] / clip[3]) * 100.0 - 0.5, y, 1e-3);
        assert_true(fabs(clip[2]) <= clip[3]);
    }
}

static void test_orbit(void **state)
{
    (void)state;
    sn_camera a, b;
    sn_error err;
    double xa, ya, xb, yb;
    assert_int_equal(sn_camera_orbit(&a, 30, 20, 1, box, SN_UP_Y, 1, &err), SN_OK);
    assert_int_equal(sn_camera_orbit(&b, 30, 20, 2, box, SN_UP_Y, 1, &err), SN_OK);
    assert_true(sn_camera_project(&a, corner(3), 101, 101, &xa, &ya));
    assert_true(sn_camera_project(&b, corner(3), 101, 101, &xb, &yb));
    assert_near(xb - 50.0, 2.0 * (xa - 50.0), 1e-9); /* twice as large */
    assert_near(yb - 50.0, 2.0 * (ya - 50.0), 1e-9);
    assert_int_equal(sn_camera_orbit(&b, 390, 20, 1, box, SN_UP_Y, 1, &err), SN_OK);
    assert_near(sn_v3_dist(a.eye, b.eye), 0.0, 1e-9);
    sn_box3 point = {{2, 2, 2}, {2, 2, 2}};
    assert_int_equal(sn_camera_orbit(&a, 0, 0, 1, point, SN_UP_Y, 1, &err), SN_OK);
    assert_int_equal(sn_camera_check(&a, &err), SN_OK);
}

static void expect(sn_status st, sn_status want, const sn_error *err, const char *text)
{
    assert_int_equal(st, want);
    if (!strstr(err->msg, text)) fail_msg("'%s' does not say '%s'", err->msg, text);
}

static void test_messages(void **state)
{
    (void)state;
    sn_camera c;
    sn_error e;
    sn_vec3 o = {0}, z = {0, 0, 1}, y = {0, 1, 0};
    expect(sn_camera_preset(&c, "frnt", box, SN_UP_Y, 1, &e), SN_EINVAL, &e,
           "unknown view 'frnt' (known: front, back, left, right, top, bottom, iso)");
    expect(sn_camera_preset(&c, "front", sn_box3_empty(), SN_UP_Y, 1, &e), SN_EINVAL, &e,
           "empty or not finite");
    expect(sn_camera_preset(&c, "front", box, SN_UP_Y, 0, &e), SN_EINVAL, &e, "aspect (width / height) is 0");
    expect(sn_camera_orbit(&c, NAN, 0, 1, box, SN_UP_Y, 1, &e), SN_EINVAL, &e, "azimuth");
    expect(sn_camera_orbit(&c, 0, 91, 1, box, SN_UP_Y, 1, &e), SN_EINVAL, &e,
           "elevation is 91 degrees, need -90..90");
    expect(sn_camera_orbit(&c, 0, 0, 0, box, SN_UP_Y, 1, &e), SN_EINVAL, &e, "zoom is 0, need 0.05..20");
    expect(sn_camera_look(&c, z, z, y, 30, box, &e), SN_EINVAL, &e,
           "eye and target are the same point (0, 0, 1)");
    expect(sn_camera_look(&c, z, o, z, 30, box, &e), SN_EINVAL, &e, "parallel");
    expect(sn_camera_look(&c, z, o, o, 30, box, &e), SN_EINVAL, &e, "parallel to the view or zero");
    expect(sn_camera_look(&c, z, o, y, 171, box, &e), SN_EINVAL, &e,
           "field of view is 171 degrees, need 1..170");
    expect(sn_camera_look(&c, sn_v3(0, INFINITY, 0), o, y, 30, box, &e), SN_EINVAL, &e, "not finite");
    expect(sn_camera_look(&c, z, o, y, 30, sn_box3_empty(), &e), SN_EINVAL, &e, "empty");
    c = preset("front", SN_UP_Y, 1);
    c.zfar = c.znear;
    expect(sn_camera_check(&c, &e), SN_EINVAL, &e, "need 0 < near < far");
}

/* The eye inside the box: depths stay positive. */
static void test_look_from_inside(void **state)
{
    (void)state;
    sn_camera c;
    sn_error e;
    assert_int_equal(sn_camera_look(&c, sn_v3(1, 1, 1), sn_v3(2, 1, 1), sn_v3(0, 1, 0), 60, box, &e), SN_OK);
    assert_true(c.znear > 0.0 && c.zfar > c.znear);
    assert_int_equal(sn_camera_check(&c, &e), SN_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_eye_sides),
        cmocka_unit_test(test_box_fits),
        cmocka_unit_test(test_ray_and_project_are_inverse),
        cmocka_unit_test(test_matrices_agree),
        cmocka_unit_test(test_orbit),
        cmocka_unit_test(test_messages),
        cmocka_unit_test(test_look_from_inside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
