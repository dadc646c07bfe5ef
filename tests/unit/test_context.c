/* test_context - OpenGL contexts: which back end, what is said when there is none, pictures by either. */
#include "made_body.h"
#include "render/context_driver.h"

static void test_names(void **state)
{
    (void)state;
    assert_string_equal(sn_renderer_name(SN_RENDERER_AUTO), "auto");
    assert_string_equal(sn_renderer_name(SN_RENDERER_OSMESA), "osmesa");
    assert_string_equal(sn_renderer_name(SN_RENDERER_EGL), "egl");
    assert_true(sn_renderer_is_software("llvmpipe (LLVM 15.0.6, 256 bits)"));
    assert_true(sn_renderer_is_software("softpipe"));
    assert_true(sn_renderer_is_software("Google SwiftShader"));
    assert_false(sn_renderer_is_software("NVIDIA H200/PCIe/SSE2"));
    assert_false(sn_renderer_is_software("Mesa Intel(R) UHD Graphics 630 (CFL GT2)"));
}

static bool has_egl(void)
{
    sn_context *c;
    sn_error err;
    bool is_there = sn_context_create(&c, SN_RENDERER_EGL, &err) == SN_OK;
    if (!is_there) {
        assert_int_equal(err.code, SN_ERENDER);
        assert_ptr_equal(strstr(err.msg, "renderer egl: "), err.msg);
        assert_non_null(strstr(err.msg, "; use osmesa"));
    }
    sn_context_destroy(c);
    return is_there;
}

static void test_osmesa(void **state)
{
    (void)state;
    sn_context *c;
    sn_error err;
    ok(sn_context_create(&c, SN_RENDERER_OSMESA, &err), &err);
    assert_false(sn_context_is_hardware(c));
    assert_non_null(strstr(sn_context_renderer(c), "OpenGL "));
    assert_non_null(sn_context_proc(c, "glDrawElements"));
    sn_context_release(c);
    sn_context_release(c); /* twice is fine */
    ok(sn_context_make_current(c, &err), &err);
    sn_context_destroy(c);
    sn_context_destroy(NULL);
}

/* Auto is a GPU or OSMesa, never a slow renderer by a roundabout way. */
static void test_auto(void **state)
{
    (void)state;
    sn_context *c;
    sn_error err;
    ok(sn_context_create(&c, SN_RENDERER_AUTO, &err), &err);
    bool is_egl = strstr(sn_context_renderer(c), "EGL, ") != NULL;
    assert_int_equal(is_egl, sn_context_is_hardware(c));
    sn_context_destroy(c);
}

static void test_egl_that_is_not_there(void **state)
{
    (void)state;
    void *c = NULL;
    sn_error err;
    expect(sn_context_egl_open(&c, "libEGL_of_nobody.so.1", false, &err), SN_ERENDER, &err,
           "renderer egl: libEGL_of_nobody.so.1 is not installed; use osmesa");
    expect(sn_context_egl_open(&c, "libm.so.6", false, &err), SN_ERENDER, &err,
           "renderer egl: libm.so.6 has no function egl");
    assert_null(c);
    if (!has_egl()) return;
    sn_status st = sn_context_egl_open(&c, "libEGL.so.1", true, &err); /* a GPU or the reason */
    if (st)
        expect(st, SN_ERENDER, &err, "in hardware");
    else
        sn_context_egl.destroy(c);
}

static double ball(int32_t i, sn_vec3 p)
{
    return i == 0 ? 0.0 : 0.49 - sn_v3_len2(p);
}

static void draw_with(sn_renderer renderer, const body *b, sn_image *m, sn_picture_stats *stats)
{
    sn_picture_options o = front(200, 160);
    sn_error err;
    o.samples = 2;
    o.renderer = renderer;
    sn_image_init(m);
    ok(sn_picture_draw(&b->scene, &o, NULL, m, stats, &err), &err);
}

/* The limits of the pictures in tests/golden. */
static void test_pictures_agree(void **state)
{
    (void)state;
    body b;
    sn_image m[2];
    sn_picture_stats stats[2];
    sn_image_diff d;
    sn_error err;
    if (!has_egl()) skip();
    body_make(&b, 12, 2, ball);
    sn_tri_mesh bone;
    const sn_tri_mesh *list[1] = {&bone};
    make_box(&bone, sn_v3(-0.9, -0.9, -0.9), sn_v3(0.9, -0.6, 0.2));
    b.scene.bone = list;
    b.scene.n_bone = 1;
    b.scene.skin = &bone;
    draw_with(SN_RENDERER_OSMESA, &b, &m[0], &stats[0]);
    draw_with(SN_RENDERER_EGL, &b, &m[1], &stats[1]);
    assert_null(strstr(stats[0].renderer, "EGL"));
    assert_ptr_equal(strstr(stats[1].renderer, "EGL, "), stats[1].renderer);
    ok(sn_image_compare(&m[0], &m[1], 12, 200 * 160 / 200, &d, NULL, &err), &err);
    assert_true(d.equal);
    for (int k = 0; k < 2; k++) sn_image_free(&m[k]);
    sn_tri_mesh_free(&bone);
    body_free(&b);
}

/* One painter, the renderer changed and changed back. */
static void test_a_painter_changes_its_renderer(void **state)
{
    (void)state;
    body b;
    sn_painter *p;
    sn_image m[3];
    sn_error err;
    if (!has_egl()) skip();
    body_make(&b, 6, 2, ball);
    b.scene.stamp = (sn_picture_stamps){1, 1, 1};
    ok(sn_painter_create(&p, &err), &err);
    for (int k = 0; k < 3; k++) {
        sn_picture_options o = front(40, 40);
        o.renderer = k == 1 ? SN_RENDERER_EGL : SN_RENDERER_OSMESA;
        sn_image_init(&m[k]);
        ok(sn_painter_draw(p, &b.scene, &o, NULL, &m[k], NULL, &err), &err);
    }
    assert_memory_equal(m[0].rgba, m[2].rgba, 4 * 40 * 40);
    for (int k = 0; k < 3; k++) sn_image_free(&m[k]);
    sn_painter_destroy(p);
    body_free(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_names),          cmocka_unit_test(test_osmesa),
        cmocka_unit_test(test_auto),           cmocka_unit_test(test_egl_that_is_not_there),
        cmocka_unit_test(test_pictures_agree), cmocka_unit_test(test_a_painter_changes_its_renderer),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
