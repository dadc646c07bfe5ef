/* test_image_draw - empty pictures, pasting, rectangles, lines, text, scaling: pixel values and messages. */
#include "made_body.h"
#include "render/image_draw.h"

static const float white[4] = {1, 1, 1, 1}, black[4] = {0, 0, 0, 1}, red[4] = {1, 0, 0, 1},
                   clear[4] = {1, 1, 1, 0};

static void make(sn_image *m, int w, int h, const float color[4])
{
    sn_error err;
    sn_image_init(m);
    ok(sn_image_create(m, w, h, color, &err), &err);
}

static void assert_pixel(const sn_image *m, int x, int y, int r, int g, int b, int a)
{
    const uint8_t *p = at(m, x, y);
    if (p[0] != r || p[1] != g || p[2] != b || p[3] != a)
        fail_msg("pixel (%d, %d) is %d %d %d %d, not %d %d %d %d", x, y, p[0], p[1], p[2], p[3], r, g, b, a);
}

static bool same_pixel(const sn_image *m, int x, int y, const uint8_t want[4])
{
    return memcmp(at(m, x, y), want, 4) == 0;
}

/* Blackness of all pixels, 1 for a black one. */
static double ink(const sn_image *m)
{
    double sum = 0.0;
    for (int i = 0; i < m->width * m->height; i++) sum += 1.0 - m->rgba[4 * i] / 255.0;
    return sum;
}

static void test_create_and_fill(void **state)
{
    (void)state;
    sn_image m;
    sn_error err;
    const float half_red[4] = {1, 0, 0, 0.5f}, green[4] = {0, 0.5f, 0, 1};
    make(&m, 8, 6, white);
    ok(sn_image_fill(&m, 2, 1, 3, 2, green, &err), &err);
    for (int y = 0; y < 6; y++)
        for (int x = 0; x < 8; x++) {
            bool in = x >= 2 && x < 5 && y >= 1 && y < 3;
            assert_pixel(&m, x, y, in ? 0 : 255, in ? 128 : 255, in ? 0 : 255, 255);
        }
    ok(sn_image_fill(&m, -3, -3, 4, 4, black, &err), &err); /* cut off at the corner */
    assert_pixel(&m, 0, 0, 0, 0, 0, 255);
    assert_pixel(&m, 1, 0, 255, 255, 255, 255);
    ok(sn_image_fill(&m, 6, 4, 100, INT32_MAX, half_red, &err), &err);
    assert_pixel(&m, 7, 5, 255, 188, 188, 255); /* half of the light: sRGB 188 */
    assert_pixel(&m, 5, 5, 255, 255, 255, 255);
    ok(sn_image_fill(&m, INT32_MAX, INT32_MIN, 9, 9, black, &err), &err);
    ok(sn_image_fill(&m, 0, 0, 0, 6, black, &err), &err);
    assert_pixel(&m, 0, 5, 255, 255, 255, 255);
    sn_image_free(&m);
    make(&m, 2, 1, clear);
    assert_pixel(&m, 0, 0, 255, 255, 255, 0);
    ok(sn_image_fill(&m, 0, 0, 1, 1, half_red, &err), &err); /* over nothing: itself */
    assert_pixel(&m, 0, 0, 255, 0, 0, 128);
    ok(sn_image_fill(&m, 0, 0, 1, 1, half_red, &err), &err);
    assert_pixel(&m, 0, 0, 255, 0, 0, 191 + (at(&m, 0, 0)[3] == 192)); /* 1 - 0.5 * 0.498 */
    sn_image_free(&m);
}

static void test_paste(void **state)
{
    (void)state;
    sn_image m, p;
    sn_error err;
    make(&m, 6, 5, white);
    make(&p, 3, 3, clear);
    for (int i = 0; i < 36; i++) p.rgba[i] = (uint8_t)(i * 7);
    for (int i = 0; i < 9; i++) p.rgba[4 * i + 3] = i == 4 ? 0 : 255;
    ok(sn_image_paste(&m, &p, 1, 2, &err), &err);
    for (int y = 0; y < 5; y++)
        for (int x = 0; x < 6; x++) {
            bool in = x >= 1 && x < 4 && y >= 2 && (x != 2 || y != 3); /* not where p is clear */
            const uint8_t *want = in ? at(&p, x - 1, y - 2) : (const uint8_t[]){255, 255, 255, 255};
            assert_true(same_pixel(&m, x, y, want));
        }
    const int32_t way[6][2] = {{-2, -2}, {5, 4}, {-3, 0}, {6, 0}, {0, INT32_MAX}, {INT32_MIN, 0}};
    for (int k = 0; k < 6; k++) ok(sn_image_paste(&m, &p, way[k][0], way[k][1], &err), &err);
    assert_true(same_pixel(&m, 0, 0, at(&p, 2, 2)));
    assert_true(same_pixel(&m, 5, 4, at(&p, 0, 0)));
    assert_true(same_pixel(&m, 1, 0, (const uint8_t[]){255, 255, 255, 255}));
    ok(sn_image_paste(&m, &m, 1, 0, &err), &err); /* onto itself */
    assert_true(same_pixel(&m, 1, 0, at(&p, 2, 2)) && same_pixel(&m, 0, 0, at(&p, 2, 2)));
    assert_true(same_pixel(&m, 2, 0, (const uint8_t[]){255, 255, 255, 255}));
    sn_image_free(&m);
    sn_image_free(&p);
}

static double ball(int32_t i, sn_vec3 p)
{
    return i == 0 ? 0.0 : 0.49 - sn_v3_len2(p);
}

/* A picture on nothing, pasted on blue, is the picture on blue. */
static void test_paste_as_background(void **state)
{
    (void)state;
    body b;
    sn_image none, over, sheet;
    sn_image_diff d;
    sn_error err;
    const float blue[4] = {0.2f, 0.3f, 0.9f, 1};
    body_make(&b, 8, 2, ball);
    sn_picture_options o = front(90, 70);
    (void)draw(&b.scene, &o, &none);
    memcpy(o.background, blue, sizeof blue);
    (void)draw(&b.scene, &o, &over);
    make(&sheet, 90, 70, blue);
    ok(sn_image_paste(&sheet, &none, 0, 0, &err), &err);
    ok(sn_image_compare(&sheet, &over, 2, 0, &d, NULL, &err), &err);
    assert_true(d.equal);
    sn_image_free(&none);
    sn_image_free(&over);
    sn_image_free(&sheet);
    body_free(&b);
}

static void test_line(void **state)
{
    (void)state;
    sn_image m;
    sn_error err;
    const double row[4] = {2, 5, 17, 5}, slope[4] = {5, 5, 45, 35}, dot[2] = {10, 10},
                 far[4] = {-1e6, 3, 1e6, 3};
    make(&m, 20, 11, white);
    ok(sn_image_line(&m, row, 2, 1.0, black, &err), &err); /* whole numbers: exactly one row */
    for (int y = 0; y < 11; y++)
        for (int x = 3; x < 17; x++)
            assert_pixel(&m, x, y, y == 5 ? 0 : 255, y == 5 ? 0 : 255, y == 5 ? 0 : 255, 255);
    assert_pixel(&m, 0, 5, 255, 255, 255, 255);
    assert_pixel(&m, 19, 5, 255, 255, 255, 255);
    ok(sn_image_line(&m, far, 2, 1.0, red, &err), &err); /* cut off */
    for (int x = 0; x < 20; x++) assert_pixel(&m, x, 3, 255, 0, 0, 255);
    sn_image_free(&m);
    make(&m, 50, 40, clear); /* alpha is the coverage: width times length and round ends */
    ok(sn_image_line(&m, slope, 2, 4.0, black, &err), &err);
    assert_near(covered(&m), 4.0 * 50.0 + PI * 4.0, 1.5);
    for (int i = 0; i < 50 * 40; i++)
        if (m.rgba[4 * i + 3] > 0) assert_int_equal(m.rgba[4 * i] + m.rgba[4 * i + 1] + m.rgba[4 * i + 2], 0);
    sn_image_free(&m);
    for (int n = 1; n <= 2; n++) { /* a dot, and a line that stands still */
        const double twice[4] = {10, 10, 10, 10};
        make(&m, 21, 21, clear);
        ok(sn_image_line(&m, n == 1 ? dot : twice, n, 9.0, black, &err), &err);
        assert_near(covered(&m), PI * 4.5 * 4.5, 0.7);
        assert_pixel(&m, 10, 10, 0, 0, 0, 255);
        sn_image_free(&m);
    }
}

/* Corners of overlapping pieces are not darker: a polyline is one figure. */
static void test_translucent_line(void **state)
{
    (void)state;
    sn_image m;
    sn_error err;
    const double zigzag[8] = {3, 5, 30, 5, 3, 7, 30, 7};
    const float half[4] = {0, 0, 0, 0.5f};
    make(&m, 34, 13, white);
    ok(sn_image_line(&m, zigzag, 4, 5.0, half, &err), &err);
    for (int x = 5; x < 28; x++) assert_pixel(&m, x, 6, 188, 188, 188, 255);
    sn_image_free(&m);
}

typedef struct box {
    int x0, y0, x1, y1; /* of pixels that are not white, inclusive */
} box;
static box ink_box(const sn_image *m)
{
    box b = {m->width, m->height, -1, -1};
    for (int y = 0; y < m->height; y++)
        for (int x = 0; x < m->width; x++)
            if (at(m, x, y)[0] < 255) {
                b.x0 = x < b.x0 ? x : b.x0;
                b.x1 = x > b.x1 ? x : b.x1;
                b.y0 = y < b.y0 ? y : b.y0;
                b.y1 = y > b.y1 ? y : b.y1;
            }
    return b;
}

static void put_text(sn_image *m, const char *text, double x, double y, double size, sn_text_align align,
                     double turn)
{
    sn_error err;
    const sn_image_label l = {.text = text,
                              .x = x,
                              .y = y,
                              .size = size,
                              .align = align,
                              .rotate_deg = turn,
                              .color = {0, 0, 0, 1}};
    ok(sn_image_text_draw(m, &l, &err), &err);
}

/* The ink lies in the reported size: one pixel is left for antialiasing. */
static void test_text_in_its_size(void **state)
{
    (void)state;
    const char *const text[] = {"Hxg fiber field", "M. biceps brachii (caput longum), 12.5 mm",
                                "µ = 0.3 ± 0.1 N/m²", "|_|"};
    const double size[] = {9, 14, 20.5, 40};
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) {
            sn_image m;
            sn_text_size s;
            sn_error err;
            ok(sn_image_text_measure(text[i], size[k], &s, &err), &err);
            assert_true(s.ascent > 0.7 * size[k] && s.height > s.ascent && s.height < 1.5 * size[k]);
            make(&m, (int)s.width + 20, (int)s.height + 20, white);
            int base = 10 + (int)ceil(s.ascent);
            put_text(&m, text[i], 10, base, size[k], SN_TEXT_LEFT, 0.0);
            box b = ink_box(&m);
            assert_true(b.x0 >= 9 && b.x1 <= 10 + s.width + 1.0);
            assert_true(b.y0 >= base - s.ascent - 1.0 && b.y1 <= base + s.height - s.ascent + 1.0);
            assert_true(b.x1 - b.x0 > 0.8 * s.width - 2.0 && ink(&m) > 0.05 * s.width * size[k]);
            sn_image_free(&m);
        }
}

static void test_text_stands_on_its_row(void **state)
{
    (void)state;
    for (int size = 10; size <= 30; size += 5) {
        sn_image m;
        make(&m, 60, 60, white);
        put_text(&m, "HTE", 5, 40, size, SN_TEXT_LEFT, 0.0);
        assert_int_equal(ink_box(&m).y1, 40);
        assert_true(ink_box(&m).x0 >= 5);
        sn_image_free(&m);
    }
}

static void test_text_align_and_turn(void **state)
{
    (void)state;
    sn_image m[4];
    sn_text_size s;
    sn_error err;
    ok(sn_image_text_measure("HHHH", 20, &s, &err), &err);
    for (int k = 0; k < 4; k++) {
        make(&m[k], 161, 161, white);
        put_text(&m[k], "HHHH", 80, 80, 20, k == 3 ? SN_TEXT_LEFT : (sn_text_align)k, k == 3 ? 90.0 : 0.0);
    }
    box left = ink_box(&m[0]), mid = ink_box(&m[1]), right = ink_box(&m[2]), up = ink_box(&m[3]);
    assert_true(left.x0 >= 80 && left.x0 <= 83);
    assert_near(left.x1, 79.5 + s.width, 3.0);
    assert_near(mid.x0 + mid.x1, 160, 1.0);
    assert_true(right.x1 <= 80 && right.x1 >= 77);
    assert_near(up.y1, 160 - left.x0, 1.0); /* turned about (80, 80), counter-clockwise: reads upward */
    assert_near(up.y0, 160 - left.x1, 1.0);
    assert_near(up.x0, left.y0, 1.0);
    assert_near(up.x1, left.y1, 1.0);
    for (int k = 0; k < 4; k++) sn_image_free(&m[k]);
}

/* The picture is drawn in bands of 256 rows: nobody can tell. */
static void test_bands(void **state)
{
    (void)state;
    sn_image tall, low;
    sn_error err;
    make(&tall, 120, 600, white);
    make(&low, 120, 100, white);
    for (int k = 0; k < 2; k++) {
        double y = k ? 50 : 256, line[4] = {3, y - 30, 110, y + 30};
        put_text(k ? &low : &tall, "Fascicle", 5, y + 5, 24, SN_TEXT_LEFT, 10.0);
        ok(sn_image_line(k ? &low : &tall, line, 2, 1.5, black, &err), &err);
    }
    for (int y = 0; y < 100; y++) assert_memory_equal(at(&tall, 0, y + 206), at(&low, 0, y), 4 * 120);
    sn_image_free(&tall);
    sn_image_free(&low);
}

static void test_resize(void **state)
{
    (void)state;
    sn_image m, out;
    sn_error err;
    make(&m, 40, 30, white);
    sn_image_init(&out);
    for (int i = 0; i < 4 * 40 * 30; i++) m.rgba[i] = (uint8_t)(i * 131 + i / 40);
    ok(sn_image_resize(&out, &m, 40, 30, NULL, &err), &err); /* the same size: the same bits */
    assert_memory_equal(m.rgba, out.rgba, 4 * 40 * 30);
    ok(sn_image_resize(&out, &m, 80, 90, NULL, &err), &err); /* larger by whole numbers: squares */
    for (int y = 0; y < 90; y++)
        for (int x = 0; x < 80; x++) assert_memory_equal(at(&out, x, y), at(&m, x / 2, y / 3), 4);
    sn_image_free(&m);
    make(&m, 4, 2, white); /* columns white, black: half of the light; 3 of 8 pixels clear red do not count */
    for (int i = 0; i < 8; i++)
        if (i % 2) memcpy(m.rgba + 4 * i, (uint8_t[]){0, 0, 0, 255}, 4);
    ok(sn_image_resize(&out, &m, 1, 1, NULL, &err), &err);
    assert_pixel(&out, 0, 0, 188, 188, 188, 255);
    ok(sn_image_resize(&out, &m, 3, 1, NULL, &err),
       &err); /* 4/3 pixels each: white + black / 3 is 3/4 of the light */
    assert_pixel(&out, 0, 0, 225, 225, 225, 255);
    assert_pixel(&out, 1, 0, 188, 188, 188, 255);
    assert_pixel(&out, 2, 0, 137, 137, 137, 255);
    for (int i = 0; i < 8; i++)
        if (i % 2) memcpy(m.rgba + 4 * i, (uint8_t[]){255, 0, 0, 0}, 4);
    ok(sn_image_resize(&out, &m, 2, 1, NULL, &err), &err);
    assert_pixel(&out, 0, 0, 255, 255, 255, 128);
    sn_image_free(&m);
    sn_image_free(&out);
}

static void test_resize_keeps_the_mean(void **state)
{
    (void)state;
    sn_image m, out[2];
    sn_error err;
    make(&m, 101, 67, white);
    for (int y = 0; y < 67; y++)
        for (int x = 0; x < 101; x++)
            if (hypot(x - 40, y - 30) < 25) memcpy(m.rgba + 4 * (101 * y + x), (uint8_t[]){0, 0, 0, 255}, 4);
    double was = 0.0;
    for (int i = 0; i < 101 * 67; i++) was += m.rgba[4 * i] / 255.0 / (101 * 67);
    for (int k = 0; k < 2; k++) {
        double is = 0.0;
        sn_run run = {.n_threads = 1 + k};
        sn_image_init(&out[k]);
        ok(sn_image_resize(&out[k], &m, 37, 29, &run, &err), &err);
        for (int i = 0; i < 37 * 29; i++) {
            double v = out[k].rgba[4 * i] / 255.0;
            is += (v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4)) / (37 * 29);
        }
        assert_near(is, was, 2e-3);
    }
    assert_memory_equal(out[0].rgba, out[1].rgba, 4 * 37 * 29);
    sn_image_free(&m);
    sn_image_free(&out[0]);
    sn_image_free(&out[1]);
}

static void test_messages(void **state)
{
    (void)state;
    sn_image m, out;
    sn_error e;
    sn_text_size s;
    const float bad[4] = {0, 2, 0, 1};
    const double p[4] = {0, 0, 1, NAN}, far[2] = {2e6, 0};
    char text[1200];
    memset(text, 'a', sizeof text - 1);
    text[sizeof text - 1] = 0;
    sn_image_init(&out);
    expect(sn_image_create(&out, 0, 5, white, &e), SN_EINVAL, &e, "width is 0 pixels, need 1..16384");
    expect(sn_image_create(&out, 5, 16385, white, &e), SN_EINVAL, &e, "height is 16385 pixels");
    expect(sn_image_create(&out, 5, 5, bad, &e), SN_EINVAL, &e, "image: colour value 2 is 2, need 0..1");
    assert_null(out.rgba);
    make(&m, 10, 10, white);
    expect(sn_image_fill(&m, 0, 0, -1, 5, black, &e), SN_EINVAL, &e,
           "a rectangle of -1 x 5 pixels, need 0 or more");
    expect(sn_image_fill(&m, 0, 0, 1, 5, bad, &e), SN_EINVAL, &e, "colour value 2");
    expect(sn_image_line(&m, p, 0, 1.0, black, &e), SN_EINVAL, &e, "a line of 0 points, need 1 or more");
    expect(sn_image_line(&m, p, 2, 1.0, black, &e), SN_EINVAL, &e, "point 2 of a line is (1, ");
    expect(sn_image_line(&m, far, 1, 1.0, black, &e), SN_EINVAL, &e,
           "(2e+06, 0), need at most 1e+06 pixels away");
    expect(sn_image_line(&m, p, 1, NAN, black, &e), SN_EINVAL, &e,
           "pixels wide, need more than 0, at most 16384");
    expect(sn_image_line(&m, p, 1, 1.0, bad, &e), SN_EINVAL, &e, "colour value 2");
    const sn_image_label good = {.text = "a", .size = 10, .color = {0, 0, 0, 1}};
    sn_image_label l = good;
#define TEXT() sn_image_text_draw(&m, &l, &e)
    l.text = text;
    expect(TEXT(), SN_EINVAL, &e, "the text has 1199 bytes, need at most 1000");
    l.text = "two\nlines";
    expect(TEXT(), SN_EINVAL, &e, "a control character (code 10) at byte 4, need one line of plain text");
    l.text = "a\xff";
    expect(TEXT(), SN_EINVAL, &e, "the text is not valid UTF-8");
    l = good;
    l.size = 0.5;
    expect(TEXT(), SN_EINVAL, &e, "text of size 0.5 pixels, need 1..2000");
    l = good;
    l.x = INFINITY;
    expect(TEXT(), SN_EINVAL, &e, "text at (inf, 0), need at most 1e+06 pixels away");
    l = good;
    l.rotate_deg = NAN;
    expect(TEXT(), SN_EINVAL, &e, "need a finite angle");
    l = good;
    l.color[0] = -1.0f;
    expect(TEXT(), SN_EINVAL, &e, "colour value 1 is -1");
#undef TEXT
    expect(sn_image_text_measure("\xc0", 12, &s, &e), SN_EINVAL, &e, "the text is not valid UTF-8");
    expect(sn_image_resize(&out, &m, 10, 0, NULL, &e), SN_EINVAL, &e, "height is 0 pixels");
    for (int i = 0; i < 4 * 100; i++) assert_int_equal(m.rgba[i], 255); /* nothing was drawn */
    l = good;
    l.text = "";
    ok(sn_image_text_draw(&m, &l, &e), &e); /* no text is fine */
    ok(sn_image_text_measure("", 12, &s, &e), &e);
    assert_true(s.width == 0.0 && s.height > 12.0);
    sn_image_free(&m);
}

static void test_no_memory(void **state)
{
    (void)state;
    sn_image m, out;
    sn_error e;
    const double p[4] = {0, 0, 9, 9};
    counter c;
    sn_run run = {.n_threads = 1};
    sn_allocator dry = {count_realloc, &c};
    sn_set_allocator(&dry);
    sn_image_init(&m);
    sn_image_init(&out);
    long n = 0;
    for (;; n++) {
        c.left = n;
        sn_status st = sn_image_create(&m, 10, 10, white, &e);
        if (!st) st = sn_image_line(&m, p, 2, 1.0, black, &e);
        if (!st) st = sn_image_paste(&m, &m, 1, 1, &e);
        if (!st) st = sn_image_resize(&out, &m, 3, 3, &run, &e);
        if (st == SN_OK) break;
        assert_int_equal(st, SN_ENOMEM);
        assert_null(out.rgba);
    }
    assert_int_equal(n, 5);
    sn_image_free(&m);
    sn_image_free(&out);
    sn_set_allocator(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_create_and_fill),
        cmocka_unit_test(test_paste),
        cmocka_unit_test(test_paste_as_background),
        cmocka_unit_test(test_line),
        cmocka_unit_test(test_translucent_line),
        cmocka_unit_test(test_text_in_its_size),
        cmocka_unit_test(test_text_stands_on_its_row),
        cmocka_unit_test(test_text_align_and_turn),
        cmocka_unit_test(test_bands),
        cmocka_unit_test(test_resize),
        cmocka_unit_test(test_resize_keeps_the_mean),
        cmocka_unit_test(test_messages),
        cmocka_unit_test(test_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
