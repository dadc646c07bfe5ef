/* test_image - PNG reading and writing, comparison. */
#define _POSIX_C_SOURCE 200809L
#include "render/image.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[] = "/tmp/sinew_image_XXXXXX";

static const char *in_folder(const char *name)
{
    static char path[2][128];
    static int turn;
    turn ^= 1;
    (void)snprintf(path[turn], sizeof path[turn], "%s/%s", folder, name);
    return path[turn];
}

static int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    return rmdir(folder);
}

static void ok(sn_status st, const sn_error *err)
{
    if (st) fail_msg("%s", err->msg);
}

static void expect(sn_status st, sn_status want, const sn_error *err, const char *text)
{
    assert_int_equal(st, want);
    if (!strstr(err->msg, text)) fail_msg("'%s' does not say '%s'", err->msg, text);
}

static void make_image(sn_image *m, int w, int h)
{
    sn_error err;
    sn_image_init(m);
    ok(sn_image_reserve(m, w, h, &err), &err);
    for (int i = 0; i < 4 * w * h; i++) m->rgba[i] = (uint8_t)(i * 37 + i / 7);
}

static size_t slurp(const char *path, unsigned char *out, size_t cap)
{
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    size_t n = fread(out, 1, cap, f);
    (void)fclose(f);
    return n;
}

static void spill(const char *path, const unsigned char *data, size_t n)
{
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(data, 1, n, f), n);
    (void)fclose(f);
}

static void test_round_trip(void **state)
{
    (void)state;
    static unsigned char one[65536], two[65536];
    const sn_image_text text[2] = {{"Software", "sinew"}, {"Renderer", "llvmpipe, 4.5"}};
    sn_image a, b;
    sn_error err;
    make_image(&a, 13, 7);
    sn_image_init(&b);
    ok(sn_image_save(&a, text, 2, in_folder("a.png"), &err), &err);
    ok(sn_image_load(&b, in_folder("a.png"), &err), &err);
    assert_int_equal(b.width, 13);
    assert_int_equal(b.height, 7);
    assert_memory_equal(a.rgba, b.rgba, 13 * 7 * 4);
    ok(sn_image_save(&a, text, 2, in_folder("b.PNG"), &err), &err); /* the same picture, the same bytes */
    size_t n = slurp(in_folder("a.png"), one, sizeof one);
    assert_int_equal(slurp(in_folder("b.PNG"), two, sizeof two), n);
    assert_memory_equal(one, two, n);
    const char chunk[] = "tEXtRenderer\0llvmpipe, 4.5";
    bool found = false;
    for (size_t i = 0; i + sizeof chunk <= n; i++)
        found = found || memcmp(one + i, chunk, sizeof chunk - 1) == 0;
    assert_true(found);
    for (size_t i = 0; i + 4 <= n; i++) assert_true(memcmp(one + i, "tIME", 4) != 0);
    sn_image_free(&a);
    sn_image_free(&b);
    (void)remove(in_folder("a.png"));
    (void)remove(in_folder("b.PNG"));
}

/* Writes through libpng what our writer never would. row: bytes as the format wants them, rows of `stride`.
 */
static void write_raw(const char *path, int w, int h, int depth, int type, int interlace, unsigned char *rows,
                      int stride)
{
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    if (setjmp(png_jmpbuf(png))) {
        fail_msg("libpng failed");
        return;
    }
    png_init_io(png, f);
    png_set_IHDR(png, info, (png_uint_32)w, (png_uint_32)h, depth, type, interlace,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (type == PNG_COLOR_TYPE_PALETTE) {
        png_color c[3] = {{10, 20, 30}, {40, 50, 60}, {70, 80, 90}};
        png_byte alpha[2] = {255, 100};
        png_set_PLTE(png, info, c, 3);
        png_set_tRNS(png, info, alpha, 2, NULL);
    }
    png_write_info(png, info);
    png_bytep row[16];
    for (int y = 0; y < h; y++) row[y] = rows + y * stride;
    png_write_image(png, row);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    (void)fclose(f);
}

static void load_and_compare(const char *path, int w, int h, const uint8_t *want)
{
    sn_image m;
    sn_error err;
    sn_image_init(&m);
    ok(sn_image_load(&m, path, &err), &err);
    assert_int_equal(m.width, w);
    assert_int_equal(m.height, h);
    assert_memory_equal(m.rgba, want, 4 * (size_t)w * (size_t)h);
    sn_image_free(&m);
    (void)remove(path);
}

static void test_all_kinds(void **state)
{
    (void)state;
    const char *path = in_folder("k.png");
    unsigned char grey16[4] = {0x80, 0x80, 0xff, 0xff}; /* 2 x 1 */
    write_raw(path, 2, 1, 16, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, grey16, 4);
    load_and_compare(path, 2, 1, (const uint8_t[]){128, 128, 128, 255, 255, 255, 255, 255});
    unsigned char rgba16[8] = {0x12, 0x12, 0x34, 0x34, 0x56, 0x56, 0x78, 0x78};
    write_raw(path, 1, 1, 16, PNG_COLOR_TYPE_RGB_ALPHA, PNG_INTERLACE_NONE, rgba16, 8);
    load_and_compare(path, 1, 1, (const uint8_t[]){0x12, 0x34, 0x56, 0x78});
    unsigned char bit[1] = {0xa0}; /* 1, 0, 1 */
    write_raw(path, 3, 1, 1, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, bit, 1);
    load_and_compare(path, 3, 1, (const uint8_t[]){255, 255, 255, 255, 0, 0, 0, 255, 255, 255, 255, 255});
    unsigned char index[3] = {2, 1, 0};
    write_raw(path, 3, 1, 8, PNG_COLOR_TYPE_PALETTE, PNG_INTERLACE_NONE, index, 3);
    load_and_compare(path, 3, 1, (const uint8_t[]){70, 80, 90, 255, 40, 50, 60, 100, 10, 20, 30, 255});
    unsigned char rgb[9 * 9 * 3];
    uint8_t want[9 * 9 * 4];
    for (int i = 0; i < 81; i++) {
        for (int k = 0; k < 3; k++) want[4 * i + k] = rgb[3 * i + k] = (unsigned char)(i * 3 + k * 50);
        want[4 * i + 3] = 255;
    }
    write_raw(path, 9, 9, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_ADAM7, rgb, 27);
    load_and_compare(path, 9, 9, want);
}

/* Every shorter file and many damaged ones: an error that names the file, or a picture; never a crash or a
 * leak. */
static void test_damaged(void **state)
{
    (void)state;
    static unsigned char data[65536];
    const char *path = in_folder("d.png");
    sn_image a, b;
    sn_error err;
    make_image(&a, 5, 5);
    sn_image_init(&b);
    ok(sn_image_save(&a, NULL, 0, path, &err), &err);
    size_t n = slurp(path, data, sizeof data);
    for (size_t k = 0; k < n; k++) {
        spill(path, data, k);
        expect(sn_image_load(&b, path, &err), SN_EFORMAT, &err, path);
        assert_null(b.rgba);
    }
    spill(path, data, n / 2);
    expect(sn_image_load(&b, path, &err), SN_EFORMAT, &err, "damaged PNG: the file is cut short");
    for (size_t k = 8; k < n; k++) {
        data[k] ^= 0x55;
        spill(path, data, n);
        if (sn_image_load(&b, path, &err)) assert_null(b.rgba);
        data[k] ^= 0x55;
    }
    spill(path, (const unsigned char *)"GIF89a and more", 15);
    expect(sn_image_load(&b, path, &err), SN_EFORMAT, &err, "not a PNG file");
    sn_image_free(&a);
    sn_image_free(&b);
    (void)remove(path);
    expect(sn_image_load(&b, path, &err), SN_EIO, &err, "cannot open");
    expect(sn_image_load(&b, folder, &err), SN_EIO, &err, folder);
}

static void test_too_large(void **state)
{
    (void)state;
    const char *path = in_folder("wide.png");
    unsigned char *row = calloc(200000, 1);
    assert_non_null(row);
    FILE *f = fopen(path, "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, f);
    png_set_IHDR(png, info, 200000, 1, 8, PNG_COLOR_TYPE_GRAY, 0, 0, 0);
    png_write_info(png, info);
    png_write_row(png, row);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    (void)fclose(f);
    free(row);
    sn_image m;
    sn_error err;
    sn_image_init(&m);
    expect(sn_image_load(&m, path, &err), SN_ELIMIT, &err,
           "picture of 200000 x 1 pixels, at most 16384 per side");
    assert_null(m.rgba);
    (void)remove(path);
    expect(sn_image_reserve(&m, 200000, 10, &err), SN_EINVAL, &err, "width is 200000 pixels, need 1..16384");
    expect(sn_image_reserve(&m, 10, 0, &err), SN_EINVAL, &err, "height is 0 pixels, need 1..16384");
}

static void test_unwritable(void **state)
{
    (void)state;
    sn_image m;
    sn_error err;
    make_image(&m, 2, 2);
    expect(sn_image_save(&m, NULL, 0, "/nonexistent/x.png", &err), SN_EIO, &err, "/nonexistent/x.png");
    expect(sn_image_save(&m, NULL, 0, in_folder("x.jpg"), &err), SN_EINVAL, &err,
           "written as .png, found '.jpg'");
    expect(sn_image_save(&m, NULL, 0, in_folder("x"), &err), SN_EINVAL, &err, "written as .png");
    const sn_image_text bad[] = {{"", "t"}, {" a", "t"}, {"a  b", "t"}, {"a\nb", "t"}};
    for (int i = 0; i < 4; i++)
        expect(sn_image_save(&m, &bad[i], 1, in_folder("x.png"), &err), SN_EINVAL, &err, "text key");
    sn_image_free(&m);
    expect(sn_image_save(&m, NULL, 0, in_folder("x.png"), &err), SN_EINVAL, &err, "no pixels");
    assert_int_not_equal(access(in_folder("x.png"), F_OK), 0);
}

static void test_compare(void **state)
{
    (void)state;
    sn_image a, b, diff;
    sn_image_diff d;
    sn_error err;
    make_image(&a, 4, 3);
    make_image(&b, 4, 3);
    sn_image_init(&diff);
    ok(sn_image_compare(&a, &b, 0, 0, &d, &diff, &err), &err);
    assert_true(d.equal && d.max == 0 && d.count == 0 && d.rmse == 0.0);
    assert_int_equal(diff.rgba[0], diff.rgba[1]);
    for (int i = 0; i < 4; i++) a.rgba[i] = b.rgba[i] = 100;
    b.rgba[0] = 110; /* one pixel by 10 and 4 in two channels, another by 2 */
    b.rgba[3] = 96;
    a.rgba[4 * 5 + 1] = 50;
    b.rgba[4 * 5 + 1] = 52;
    ok(sn_image_compare(&a, &b, 0, 1, &d, &diff, &err), &err);
    assert_int_equal(d.max, 10);
    assert_int_equal(d.count, 2);
    assert_false(d.equal);
    assert_true(fabs(d.rmse - sqrt((100.0 + 16.0 + 4.0) / 48.0)) < 1e-12);
    assert_int_equal(diff.rgba[0], 255);
    assert_true(diff.rgba[1] < 255 && diff.rgba[4 * 5] == 255);
    ok(sn_image_compare(&a, &b, 2, 1, &d, NULL, &err), &err);
    assert_int_equal(d.count, 1);
    assert_true(d.equal);
    ok(sn_image_compare(&a, &b, 10, 0, &d, NULL, &err), &err);
    assert_true(d.equal && d.count == 0 && d.max == 10);
    expect(sn_image_compare(&a, &b, -1, 0, &d, NULL, &err), SN_EINVAL, &err, "limits are -1 and 0");
    ok(sn_image_reserve(&b, 3, 4, &err), &err);
    expect(sn_image_compare(&a, &b, 0, 0, &d, NULL, &err), SN_EINVAL, &err, "4 x 3 pixels, the other 3 x 4");
    sn_image_free(&a);
    sn_image_free(&b);
    sn_image_free(&diff);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip), cmocka_unit_test(test_all_kinds),  cmocka_unit_test(test_damaged),
        cmocka_unit_test(test_too_large),  cmocka_unit_test(test_unwritable), cmocka_unit_test(test_compare),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
