#include "render/image.h"

#include <math.h>
#include <stdlib.h>

/* Largest difference over the four channels; *sum2 grows by the squares. */
static int32_t pixel_diff(const uint8_t *a, const uint8_t *b, int64_t *sum2)
{
    int32_t max = 0;
    for (int c = 0; c < 4; c++) {
        int32_t d = abs((int)a[c] - (int)b[c]);
        *sum2 += (int64_t)d * d;
        if (d > max) max = d;
    }
    return max;
}

static void paint_diff(const uint8_t *a, int32_t diff, uint8_t *out)
{
    int grey = 160 + (2 * a[0] + 5 * a[1] + a[2]) / 8 / 3; /* pale, so that the red stands out */
    int rest = diff > 0 ? (255 - diff) / 2 : grey;         /* a difference of 1 must be seen */
    out[0] = (uint8_t)(diff > 0 ? 255 : grey);
    out[1] = (uint8_t)rest;
    out[2] = (uint8_t)rest;
    out[3] = 255;
}

sn_status sn_image_compare(const sn_image *a, const sn_image *b, int32_t max_diff, int64_t max_count,
                           sn_image_diff *out, sn_image *diff, sn_error *err)
{
    *out = (sn_image_diff){0};
    if (a->width != b->width || a->height != b->height)
        return sn_fail(err, SN_EINVAL, "pictures: one is %d x %d pixels, the other %d x %d", a->width,
                       a->height, b->width, b->height);
    if (max_diff < 0 || max_count < 0)
        return sn_fail(err, SN_EINVAL, "pictures: limits are %d and %lld, need 0 or more", max_diff,
                       (long long)max_count);
    if (diff) {
        sn_status st = sn_image_reserve(diff, a->width, a->height, err);
        if (st) return st;
    }
    size_t n = (size_t)a->width * (size_t)a->height;
    int64_t sum2 = 0;
    for (size_t i = 0; i < n; i++) {
        int32_t d = pixel_diff(a->rgba + 4 * i, b->rgba + 4 * i, &sum2);
        if (d > out->max) out->max = d;
        if (d > max_diff) out->count++;
        if (diff) paint_diff(a->rgba + 4 * i, d, diff->rgba + 4 * i);
    }
    out->rmse = n ? sqrt((double)sum2 / (4.0 * (double)n)) : 0.0;
    out->equal = out->count <= max_count;
    return SN_OK;
}
