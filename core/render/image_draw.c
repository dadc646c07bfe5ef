/* image_draw.c - pictures laid over each other, and lines and text by Cairo, which only this file sees.
 *
 * Cairo fills a mask, a band of the picture at a time; the mixing is ours, so that straight alpha stays as it
 * is and what is not touched keeps its bits. */
#include "render/image_draw.h"

#include "base/alloc.h"
#include "render/srgb.h"

#include <cairo.h>
#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846
enum { band_rows = 256 };

static sn_status check_color(const float color[4], sn_error *err)
{
    for (int k = 0; k < 4; k++)
        if (!(color[k] >= 0.0f && color[k] <= 1.0f))
            return sn_fail(err, SN_EINVAL, "image: colour value %d is %g, need 0..1", k + 1,
                           (double)color[k]);
    return SN_OK;
}

static uint8_t *pixel_at(const sn_image *m, int64_t x, int64_t y)
{
    return m->rgba + 4 * ((size_t)y * (size_t)m->width + (size_t)x);
}

/* ---- one pixel over another ---- */

typedef struct paint { /* a colour as sRGB values, as linear light and as bytes */
    float rgb[3], light[3];
    uint8_t byte[3];
    float alpha;
} paint;

static paint paint_of(const float color[4])
{
    paint p = {.alpha = color[3]};
    for (int k = 0; k < 3; k++) {
        p.rgb[k] = color[k];
        p.light[k] = sn_srgb_to_linear(color[k]);
        p.byte[k] = sn_to_byte(color[k]);
    }
    return p;
}

/* How much of the mix of alpha over out is the new colour's; sets out's alpha. */
static float take_alpha(float alpha, uint8_t out[4])
{
    float under = (float)out[3] / 255.0f * (1.0f - alpha);
    out[3] = sn_to_byte(alpha + under);
    return alpha / (alpha + under);
}

static void lay_light(const float light[3], const uint8_t byte[3], float alpha, uint8_t out[4])
{
    if (!(alpha > 0.0f)) return;
    float w = take_alpha(alpha, out);
    if (w >= 1.0f) {
        memcpy(out, byte, 3);
        return;
    }
    for (int k = 0; k < 3; k++) {
        float old = sn_srgb_to_linear((float)out[k] / 255.0f);
        out[k] = sn_linear_to_byte(old + w * (light[k] - old));
    }
}

static void lay_text(const paint *p, float alpha, uint8_t out[4])
{
    if (!(alpha > 0.0f)) return;
    float w = take_alpha(alpha, out);
    for (int k = 0; k < 3; k++) {
        float old = (float)out[k] / 255.0f;
        out[k] = sn_to_byte(old + w * (p->rgb[k] - old));
    }
}

/* ---- pictures and rectangles ---- */

sn_status sn_image_create(sn_image *out, int32_t width, int32_t height, const float color[4], sn_error *err)
{
    sn_image_free(out);
    sn_status st = check_color(color, err);
    if (!st) st = sn_image_reserve(out, width, height, err);
    if (st) return st;
    uint8_t one[4];
    for (int k = 0; k < 4; k++) one[k] = sn_to_byte(color[k]);
    for (size_t i = 0; i < (size_t)width * (size_t)height; i++) memcpy(out->rgba + 4 * i, one, 4);
    return SN_OK;
}

typedef struct area { /* of pixels, x1 and y1 not in it */
    int64_t x0, y0, x1, y1;
} area;

/* The part of the picture, empty when x1 <= x0 or y1 <= y0. */
static area clip_area(const sn_image *m, int64_t x, int64_t y, int64_t width, int64_t height)
{
    area a = {x > 0 ? x : 0, y > 0 ? y : 0, m->width, m->height};
    if (x < m->width && width < m->width - x) a.x1 = x + width;
    if (y < m->height && height < m->height - y) a.y1 = y + height;
    return a;
}

static void paste_other(sn_image *m, const sn_image *from, int64_t x, int64_t y)
{
    area a = clip_area(m, x, y, from->width, from->height);
    float light[256], to[3];
    for (int v = 0; v < 256; v++) light[v] = sn_srgb_to_linear((float)v / 255.0f);
    for (int64_t i = a.y0; i < a.y1; i++)
        for (int64_t k = a.x0; k < a.x1; k++) {
            const uint8_t *c = pixel_at(from, k - x, i - y);
            for (int n = 0; n < 3; n++) to[n] = light[c[n]];
            lay_light(to, c, (float)c[3] / 255.0f, pixel_at(m, k, i));
        }
}

sn_status sn_image_paste(sn_image *m, const sn_image *from, int32_t x, int32_t y, sn_error *err)
{
    if (from->rgba != m->rgba) {
        paste_other(m, from, x, y);
        return SN_OK;
    }
    sn_image copy;
    sn_image_init(&copy);
    sn_status st = sn_image_reserve(&copy, m->width, m->height, err);
    if (st) return st;
    memcpy(copy.rgba, m->rgba, 4 * (size_t)m->width * (size_t)m->height);
    paste_other(m, &copy, x, y);
    sn_image_free(&copy);
    return SN_OK;
}

sn_status sn_image_fill(sn_image *m, int32_t x, int32_t y, int32_t width, int32_t height,
                        const float color[4], sn_error *err)
{
    if (width < 0 || height < 0)
        return sn_fail(err, SN_EINVAL, "image: a rectangle of %d x %d pixels, need 0 or more", width, height);
    sn_status st = check_color(color, err);
    if (st) return st;
    const paint p = paint_of(color);
    area a = clip_area(m, x, y, width, height);
    for (int64_t i = a.y0; i < a.y1; i++)
        for (int64_t k = a.x0; k < a.x1; k++) lay_light(p.light, p.byte, p.alpha, pixel_at(m, k, i));
    return SN_OK;
}

/* ---- what Cairo draws ---- */

typedef struct figure {                                /* a line or a text */
    void (*path)(cairo_t *cr, const struct figure *f); /* in pixels, (0, 0) the corner of the picture */
    const double *point;
    int32_t n_point;
    double width; /* of a line, 0: the path is filled */
    const sn_image_label *label;
} figure;

static void line_path(cairo_t *cr, const figure *f)
{
    for (int32_t i = 0; i < f->n_point; i++)
        cairo_line_to(cr, f->point[2 * i] + 0.5, f->point[2 * i + 1] + 0.5);
    if (f->n_point == 1) cairo_close_path(cr); /* a dot */
}

static sn_status cairo_check(cairo_t *cr, sn_error *err)
{
    cairo_status_t st = cairo_status(cr);
    if (st == CAIRO_STATUS_SUCCESS) return SN_OK;
    if (st == CAIRO_STATUS_NO_MEMORY) return sn_fail(err, SN_ENOMEM, "image: Cairo is short of memory");
    if (st == CAIRO_STATUS_INVALID_STRING)
        return sn_fail(err, SN_EINVAL, "image: the text is not valid UTF-8");
    return sn_fail(err, SN_ERENDER, "image: Cairo: %s", cairo_status_to_string(st));
}

/* Heights of letters follow the pixels, widths do not: crisp, and spaced as the font's designer wanted. */
static void set_font(cairo_t *cr, double size)
{
    cairo_font_options_t *o = cairo_font_options_create();
    cairo_font_options_set_antialias(o, CAIRO_ANTIALIAS_GRAY);
    cairo_font_options_set_hint_style(o, CAIRO_HINT_STYLE_SLIGHT);
    cairo_font_options_set_hint_metrics(o, CAIRO_HINT_METRICS_OFF);
    cairo_set_font_options(cr, o);
    cairo_font_options_destroy(o);
    cairo_select_font_face(cr, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cr, size);
}

/* Half a pixel from the pixel's centre to the edge where the text begins or ends, and to the one it stands
 * on. */
static void text_path(cairo_t *cr, const figure *f)
{
    const sn_image_label *l = f->label;
    static const double part[3] = {0.0, -0.5, -1.0}, edge[3] = {-0.5, 0.0, 0.5};
    cairo_text_extents_t e;
    set_font(cr, l->size);
    cairo_text_extents(cr, l->text, &e);
    cairo_translate(cr, l->x + 0.5, l->y + 0.5);
    if (l->rotate_deg != 0.0) cairo_rotate(cr, -l->rotate_deg * (PI / 180.0));
    cairo_move_to(cr, edge[l->align] + part[l->align] * e.x_advance, 0.5);
    cairo_text_path(cr, l->text);
}

/* The whole path, ready to be stroked or filled; corner: where in the picture the surface begins. */
static void put_path(cairo_t *cr, const figure *f, int64_t corner_x, int64_t corner_y)
{
    cairo_translate(cr, (double)-corner_x, (double)-corner_y);
    f->path(cr, f);
    cairo_identity_matrix(cr);
    cairo_set_antialias(cr, CAIRO_ANTIALIAS_BEST);
    cairo_set_line_width(cr, f->width);
    cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
}

/* To measure on: without an end, for Cairo leaves out letters that lie off a surface. */
static cairo_t *open_measure(void)
{
    cairo_surface_t *s = cairo_recording_surface_create(CAIRO_CONTENT_ALPHA, NULL);
    cairo_t *cr = cairo_create(s);
    cairo_surface_destroy(s); /* cr holds it */
    return cr;
}

static cairo_t *open_mask(uint8_t *data, int width, int height, int stride)
{
    cairo_surface_t *s = cairo_image_surface_create_for_data(data, CAIRO_FORMAT_A8, width, height, stride);
    cairo_t *cr = cairo_create(s);
    cairo_surface_destroy(s);
    return cr;
}

/* The pixels of m that the figure can touch. */
static sn_status find_area(const sn_image *m, const figure *f, area *out, sn_error *err)
{
    double x0, y0, x1, y1;
    cairo_t *cr = open_measure();
    put_path(cr, f, 0, 0);
    if (f->width > 0.0)
        cairo_stroke_extents(cr, &x0, &y0, &x1, &y1);
    else
        cairo_fill_extents(cr, &x0, &y0, &x1, &y1);
    sn_status st = cairo_check(cr, err);
    cairo_destroy(cr);
    if (st) return st;
    int64_t x = (int64_t)floor(x0), y = (int64_t)floor(y0);
    *out = clip_area(m, x, y, (int64_t)ceil(x1) - x, (int64_t)ceil(y1) - y);
    return SN_OK;
}

static sn_status fill_mask(uint8_t *mask, int stride, const figure *f, area a, sn_error *err)
{
    int width = (int)(a.x1 - a.x0), height = (int)(a.y1 - a.y0);
    memset(mask, 0, (size_t)stride * (size_t)height);
    cairo_t *cr = open_mask(mask, width, height, stride);
    put_path(cr, f, a.x0, a.y0);
    if (f->width > 0.0)
        cairo_stroke(cr);
    else
        cairo_fill(cr);
    cairo_surface_flush(cairo_get_target(cr));
    sn_status st = cairo_check(cr, err);
    cairo_destroy(cr);
    return st;
}

static void lay_mask(sn_image *m, const uint8_t *mask, int stride, area a, const paint *p, bool is_text)
{
    for (int64_t y = a.y0; y < a.y1; y++)
        for (int64_t x = a.x0; x < a.x1; x++) {
            float alpha = p->alpha * (float)mask[(y - a.y0) * stride + (x - a.x0)] / 255.0f;
            if (is_text)
                lay_text(p, alpha, pixel_at(m, x, y));
            else
                lay_light(p->light, p->byte, alpha, pixel_at(m, x, y));
        }
}

static sn_status draw_figure(sn_image *m, const figure *f, const float color[4], sn_error *err)
{
    const paint p = paint_of(color);
    area all;
    sn_status st = find_area(m, f, &all, err);
    if (st || all.x1 <= all.x0 || all.y1 <= all.y0) return st;
    int stride = cairo_format_stride_for_width(CAIRO_FORMAT_A8, (int)(all.x1 - all.x0));
    uint8_t *mask = SN_NEW(uint8_t, (size_t)stride * band_rows);
    if (!mask) return sn_fail(err, SN_ENOMEM, "image: no memory to draw %d pixels wide", stride);
    for (int64_t y = all.y0; y < all.y1 && !st; y += band_rows) {
        area band = {all.x0, y, all.x1, y + band_rows < all.y1 ? y + band_rows : all.y1};
        st = fill_mask(mask, stride, f, band, err);
        if (!st) lay_mask(m, mask, stride, band, &p, f->label != NULL);
    }
    sn_release(mask);
    return st;
}

/* ---- lines and text ---- */

static bool is_near(double v) /* false for NaN */
{
    return v >= -SN_IMAGE_MAX_PLACE && v <= SN_IMAGE_MAX_PLACE;
}

sn_status sn_image_line(sn_image *m, const double *point, int32_t n, double width, const float color[4],
                        sn_error *err)
{
    if (n < 1) return sn_fail(err, SN_EINVAL, "image: a line of %d points, need 1 or more", n);
    if (!(width > 0.0 && width <= SN_IMAGE_MAX_SIDE))
        return sn_fail(err, SN_EINVAL, "image: a line %g pixels wide, need more than 0, at most %d", width,
                       SN_IMAGE_MAX_SIDE);
    for (int32_t i = 0; i < n; i++)
        if (!is_near(point[2 * (size_t)i]) || !is_near(point[2 * (size_t)i + 1]))
            return sn_fail(err, SN_EINVAL,
                           "image: point %d of a line is (%g, %g), need at most %g pixels away", i + 1,
                           point[2 * (size_t)i], point[2 * (size_t)i + 1], SN_IMAGE_MAX_PLACE);
    sn_status st = check_color(color, err);
    const figure f = {.path = line_path, .point = point, .n_point = n, .width = width};
    return st ? st : draw_figure(m, &f, color, err);
}

static sn_status check_text(const char *text, double size, sn_error *err)
{
    size_t n = strlen(text);
    if (n > SN_IMAGE_MAX_TEXT)
        return sn_fail(err, SN_EINVAL, "image: the text has %zu bytes, need at most %d", n,
                       SN_IMAGE_MAX_TEXT);
    for (size_t i = 0; i < n; i++)
        if ((unsigned char)text[i] < 32 || text[i] == 127)
            return sn_fail(err, SN_EINVAL,
                           "image: the text has a control character (code %d) at byte %zu, need one line of "
                           "plain text",
                           text[i], i + 1);
    if (!(size >= 1.0 && size <= SN_IMAGE_MAX_TEXT_SIZE))
        return sn_fail(err, SN_EINVAL, "image: text of size %g pixels, need 1..%g", size,
                       SN_IMAGE_MAX_TEXT_SIZE);
    return SN_OK;
}

sn_status sn_image_text_draw(sn_image *m, const sn_image_label *label, sn_error *err)
{
    sn_status st = check_text(label->text, label->size, err);
    if (!st) st = check_color(label->color, err);
    if (st) return st;
    if (!is_near(label->x) || !is_near(label->y))
        return sn_fail(err, SN_EINVAL, "image: text at (%g, %g), need at most %g pixels away", label->x,
                       label->y, SN_IMAGE_MAX_PLACE);
    if (!isfinite(label->rotate_deg))
        return sn_fail(err, SN_EINVAL, "image: text turned by %g degrees, need a finite angle",
                       label->rotate_deg);
    const figure f = {.path = text_path, .label = label};
    return draw_figure(m, &f, label->color, err);
}

sn_status sn_image_text_measure(const char *text, double size, sn_text_size *out, sn_error *err)
{
    cairo_text_extents_t e;
    cairo_font_extents_t font;
    *out = (sn_text_size){0};
    sn_status st = check_text(text, size, err);
    if (st) return st;
    cairo_t *cr = open_measure();
    set_font(cr, size);
    cairo_text_extents(cr, text, &e);
    cairo_font_extents(cr, &font);
    st = cairo_check(cr, err);
    cairo_destroy(cr);
    if (!st) *out = (sn_text_size){e.x_advance, ceil(font.ascent) + ceil(font.descent), ceil(font.ascent)};
    return st;
}
