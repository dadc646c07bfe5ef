#include "render/image.h"

#include "base/alloc.h"

#include <string.h>

void sn_image_init(sn_image *m)
{
    memset(m, 0, sizeof *m);
}

void sn_image_free(sn_image *m)
{
    sn_release(m->rgba);
    sn_image_init(m);
}

static sn_status check_side(const char *name, int32_t side, sn_error *err)
{
    if (side >= 1 && side <= SN_IMAGE_MAX_SIDE) return SN_OK;
    return sn_fail(err, SN_EINVAL, "picture: %s is %d pixels, need 1..%d", name, side, SN_IMAGE_MAX_SIDE);
}

sn_status sn_image_reserve(sn_image *m, int32_t width, int32_t height, sn_error *err)
{
    sn_image_free(m);
    sn_status st = check_side("width", width, err);
    if (!st) st = check_side("height", height, err);
    if (st) return st;
    m->rgba = SN_NEW(uint8_t, 4 * (size_t)width * (size_t)height);
    if (!m->rgba) return sn_fail(err, SN_ENOMEM, "picture: no memory for %d x %d pixels", width, height);
    m->width = width;
    m->height = height;
    return SN_OK;
}

void sn_image_flip(sn_image *m)
{
    for (int32_t y = 0; y < m->height; y++) {
        uint8_t *row = m->rgba + 4 * (size_t)y * (size_t)m->width, pixel[4];
        for (int32_t x = 0; x < m->width / 2; x++) {
            uint8_t *a = row + 4 * (size_t)x, *b = row + 4 * (size_t)(m->width - 1 - x);
            memcpy(pixel, a, sizeof pixel);
            memcpy(a, b, sizeof pixel);
            memcpy(b, pixel, sizeof pixel);
        }
    }
}
