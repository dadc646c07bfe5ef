/* image_resize.c - the mean of the area that each new pixel covers. */
#include "render/image_draw.h"

#include "base/alloc.h"
#include "render/srgb.h"

#include <string.h>

/* Clear pixels count as much, so that a clear area keeps its colour; no 8-bit value can tell. */
static const float least_alpha = 1e-6f;

/* The old pixels under new pixel i of n_new: *first up to the result (not included), and the part of the
 * first and last that counts. */
static int32_t cover(int32_t i, int32_t n_new, int32_t n_old, int32_t *first, float part[2])
{
    int64_t a = (int64_t)i * n_old, b = a + n_old; /* in n_new-ths of an old pixel */
    int32_t last = (int32_t)((b - 1) / n_new);
    *first = (int32_t)(a / n_new);
    part[0] = (float)((int64_t)(*first + 1) * n_new - a) / (float)n_new;
    part[1] = (float)(b - (int64_t)last * n_new) / (float)n_new;
    if (*first == last) part[0] = part[1] = (float)n_old / (float)n_new;
    return last + 1;
}

static float weight_of(int32_t k, int32_t first, int32_t end, const float part[2])
{
    return k == first ? part[0] : k == end - 1 ? part[1] : 1.0f;
}

/* The old rows under new row y into sum: width x 4, linear light times alpha, and alpha. */
static void sum_rows(const sn_image *m, int32_t y, int32_t height, const float light[256], float *sum)
{
    int32_t first, end;
    float part[2];
    end = cover(y, height, m->height, &first, part);
    memset(sum, 0, 4 * (size_t)m->width * sizeof *sum);
    for (int32_t j = first; j < end; j++) {
        const uint8_t *c = m->rgba + 4 * (size_t)j * (size_t)m->width;
        float w = weight_of(j, first, end, part);
        for (size_t x = 0; x < (size_t)m->width; x++) {
            float alpha = (float)c[4 * x + 3] / 255.0f, a = w * (alpha > 0.0f ? alpha : least_alpha);
            for (size_t k = 0; k < 3; k++) sum[4 * x + k] += a * light[c[4 * x + k]];
            sum[4 * x + 3] += a;
        }
    }
}

/* area: old pixels to a new one. */
static void write_row(const float *sum, int32_t n_old, int32_t n_new, float area, uint8_t *out)
{
    for (int32_t x = 0; x < n_new; x++, out += 4) {
        int32_t first, end;
        float part[2], c[4] = {0};
        end = cover(x, n_new, n_old, &first, part);
        for (int32_t i = first; i < end; i++) {
            float w = weight_of(i, first, end, part);
            for (int k = 0; k < 4; k++) c[k] += w * sum[4 * (size_t)i + (size_t)k];
        }
        for (int k = 0; k < 3; k++) out[k] = sn_linear_to_byte(c[k] / c[3]);
        out[3] = sn_to_byte(c[3] / area);
    }
}

sn_status sn_image_resize(sn_image *out, const sn_image *m, int32_t width, int32_t height, const sn_run *run,
                          sn_error *err)
{
    sn_status st = sn_image_reserve(out, width, height, err);
    if (st) return st;
    float light[256], area = (float)m->width / (float)width * ((float)m->height / (float)height);
    bool is_short = false;
    for (int v = 0; v < 256; v++) light[v] = sn_srgb_to_linear((float)v / 255.0f);
#pragma omp parallel num_threads(sn_run_threads(run)) reduction(|| : is_short)
    {
        float *sum = SN_NEW(float, 4 * (size_t)m->width);
        is_short = !sum;
#pragma omp for schedule(static)
        for (int32_t y = 0; y < height; y++) {
            if (is_short) continue;
            sum_rows(m, y, height, light, sum);
            write_row(sum, m->width, width, area, out->rgba + 4 * (size_t)y * (size_t)width);
        }
        sn_release(sum);
    }
    if (!is_short) return SN_OK;
    sn_image_free(out);
    return sn_fail(err, SN_ENOMEM, "image: no memory for rows of %d pixels", m->width);
}
