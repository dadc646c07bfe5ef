/* image.h - 8-bit RGBA pictures: PNG files and comparison. Row 0 is the top. */
#ifndef SN_RENDER_IMAGE_H
#define SN_RENDER_IMAGE_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

#define SN_IMAGE_MAX_SIDE 16384 /* pixels; libpng's and OSMesa's limits are near */

typedef struct sn_image {
    uint8_t *rgba; /* height x width x 4, straight alpha, owned */
    int32_t width, height;
} sn_image;

void sn_image_init(sn_image *m);
void sn_image_free(sn_image *m);
/* Room, values not set. Errors: SN_EINVAL (a side not in 1..SN_IMAGE_MAX_SIDE: names it), SN_ENOMEM. */
SN_MUST_USE sn_status sn_image_reserve(sn_image *m, int32_t width, int32_t height, sn_error *err);

void sn_image_flip(sn_image *m); /* left and right change places */

typedef struct sn_image_text { /* a tEXt chunk: key 1..79 Latin-1 characters */
    const char *key, *text;
} sn_image_text;

/* Any PNG (palette, grey, 16-bit, interlaced) becomes RGBA8; colour profiles are ignored. out is init-ed; on
 * error it is empty. Errors: SN_EIO, SN_EFORMAT (not a PNG, damaged, cut short), SN_ENOMEM, SN_ELIMIT (a side
 * above SN_IMAGE_MAX_SIDE: names both sides). */
SN_MUST_USE sn_status sn_image_load(sn_image *out, const char *path, sn_error *err);
/* All or nothing (base/file.h). No time stamp: the same picture gives the same bytes. text: n_text chunks in
 * this order, NULL when n_text is 0. Errors: SN_EIO, SN_ENOMEM, SN_EINVAL (not .png, no pixels, a key that
 * PNG does not allow). */
SN_MUST_USE sn_status sn_image_save(const sn_image *m, const sn_image_text *text, int n_text,
                                    const char *path, sn_error *err);

typedef struct sn_image_diff {
    bool equal;    /* count <= max_count                                                */
    int32_t max;   /* largest difference in any channel, alpha included                 */
    int64_t count; /* pixels with a difference above max_diff in some channel           */
    double rmse;   /* over all channels, 0..255                                         */
} sn_image_diff;
/* equal: no more than max_count pixels differ by more than max_diff in a channel. diff (NULL to skip):
 * init-ed; a pale grey copy of a where the pixels are the same, red by the size of the difference elsewhere.
 * Errors: SN_EINVAL (sizes differ: says both; a limit below 0), SN_ENOMEM. */
SN_MUST_USE sn_status sn_image_compare(const sn_image *a, const sn_image *b, int32_t max_diff,
                                       int64_t max_count, sn_image_diff *out, sn_image *diff, sn_error *err);

#endif
