/* image_draw.h - putting figure sheets together: empty pictures, pasting, rectangles, lines, text, scaling.
 *
 * Places are in pixels, x to the right and y down; whole numbers are the centres of pixels, (0, 0) that of
 * the top left one, as in camera.h. Anything outside of the picture is cut off. Colours are RGBA 0..1, sRGB
 * with straight alpha. Everything is laid over what is there in linear light, as sn_picture_draw lays a body
 * over its background: a picture on a transparent ground pasted on white looks like the picture on white.
 * Opaque pixels arrive bit for bit. Text is the exception: its edges are mixed in sRGB values, which keeps
 * thin stems as dark as readers are used to.
 *
 * The same calls give the same pixels on the same machine. Lines and text come from Cairo, text in the family
 * "DejaVu Sans" as fontconfig finds it. */
#ifndef SN_RENDER_IMAGE_DRAW_H
#define SN_RENDER_IMAGE_DRAW_H

#include "base/run.h"
#include "render/image.h"

#define SN_IMAGE_MAX_TEXT 1000        /* bytes of one line of text */
#define SN_IMAGE_MAX_PLACE 1000000.0  /* pixels from the corner, of a point of a line or text */
#define SN_IMAGE_MAX_TEXT_SIZE 2000.0 /* pixels */

/* out is init-ed (empty on error). Errors: SN_EINVAL (a side not in 1..SN_IMAGE_MAX_SIDE, a colour not in
 * 0..1), SN_ENOMEM. */
SN_MUST_USE sn_status sn_image_create(sn_image *out, int32_t width, int32_t height, const float color[4],
                                      sn_error *err);
/* from's top left pixel goes to (x, y). from may be m itself: it is copied first. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_image_paste(sn_image *m, const sn_image *from, int32_t x, int32_t y, sn_error *err);
/* Pixels x..x + width - 1, y..y + height - 1. Errors: SN_EINVAL (a size below 0, colour). */
SN_MUST_USE sn_status sn_image_fill(sn_image *m, int32_t x, int32_t y, int32_t width, int32_t height,
                                    const float color[4], sn_error *err);
/* A line of `width` pixels through n points (n x 2), round at corners and ends, antialiased. One point gives
 * a dot. Errors: SN_EINVAL (no points, a point that is not finite or too far away, width not in (0,
 * SN_IMAGE_MAX_SIDE], colour), SN_ENOMEM. */
SN_MUST_USE sn_status sn_image_line(sn_image *m, const double *point, int32_t n, double width,
                                    const float color[4], sn_error *err);

typedef enum sn_text_align { SN_TEXT_LEFT, SN_TEXT_CENTER, SN_TEXT_RIGHT } sn_text_align;
typedef struct sn_image_label {
    const char *text;  /* UTF-8, one line, at most SN_IMAGE_MAX_TEXT bytes */
    double x, y;       /* where the text begins, has its middle or ends, on the baseline */
    double size;       /* of the font, pixels: about the distance of two lines of text */
    double rotate_deg; /* about (x, y), counter-clockwise */
    sn_text_align align;
    float color[4];
} sn_image_label;
/* Letters stand on the lower edge of pixel row y when y is whole and nothing is rotated. Errors: SN_EINVAL
 * (text, place, size, angle, colour: says which), SN_ENOMEM, SN_ERENDER (Cairo's message). */
SN_MUST_USE sn_status sn_image_text_draw(sn_image *m, const sn_image_label *label, sn_error *err);

typedef struct sn_text_size {
    double width;  /* from the beginning to where more text would begin */
    double height; /* of the font, whole pixels: from the highest letters to below the lowest, for any text */
    double ascent; /* the part of height above the baseline */
} sn_text_size;
/* Errors: as sn_image_text_draw. */
SN_MUST_USE sn_status sn_image_text_measure(const char *text, double size, sn_text_size *out, sn_error *err);

/* A copy of m with another size: each new pixel is the mean, in linear light and weighted by alpha, of the
 * area that it covers. Made for smaller pictures; larger ones show the old pixels as squares. out: init-ed,
 * not m; empty on error. Errors: SN_EINVAL (sides), SN_ENOMEM. */
SN_MUST_USE sn_status sn_image_resize(sn_image *out, const sn_image *m, int32_t width, int32_t height,
                                      const sn_run *run, sn_error *err);

#endif
