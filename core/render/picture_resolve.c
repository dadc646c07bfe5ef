/* picture_resolve.c - samples (linear, premultiplied) to 8-bit sRGB pixels with straight alpha. */
#include "render/draw.h"

#include "render/srgb.h"

#include <math.h>

/* c: premultiplied colour of what was drawn, laid over the background. */
static void put_pixel(const float c[4], const float background[4], const float ground[3], uint8_t out[4])
{
    float rest = background[3] * (1.0f - c[3]), alpha = c[3] + rest;
    for (int k = 0; k < 3; k++) {
        float v = alpha > 0.0f ? (c[k] + rest * ground[k]) / alpha : 0.0f;
        out[k] = c[3] > 0.0f ? sn_linear_to_byte(v) : sn_to_byte(background[k]);
    }
    out[3] = sn_to_byte(alpha);
}

void sn_background_pixel(const float background[4], uint8_t out[4])
{
    for (int k = 0; k < 4; k++) out[k] = sn_to_byte(background[k]);
}

/* Weights of the samples around a pixel along one axis: a tent two pixels wide. tap 0 is `*first` samples
 * after the pixel's first sample (at most 0). */
static int tent(int samples, int *first, float weight[8])
{
    int n = 0;
    float sum = 0.0f;
    *first = -(samples / 2);
    for (int k = *first; k < samples + samples / 2; k++) {
        float at = ((float)k + 0.5f) / (float)samples - 0.5f; /* in pixels from its middle */
        weight[n] = 1.0f - fabsf(at);
        sum += weight[n++];
    }
    for (int k = 0; k < n; k++) weight[k] /= sum;
    return n;
}

static int clamp_int(int v, int last)
{
    return v < 0 ? 0 : v > last ? last : v;
}

typedef struct filter {
    float weight[8];
    int first, n;
} filter;

/* Sums the samples around pixel (x, y). Beyond the tile's edge, which is then the picture's, the edge
 * repeats. */
static void gather(const sn_frame *f, const filter *w, const float *samples, int x, int y, float out[4])
{
    int sx = x * f->samples - f->tile.x + w->first, sy = y * f->samples + w->first;
    out[0] = out[1] = out[2] = out[3] = 0.0f;
    for (int j = 0; j < w->n; j++) {
        int from_top = clamp_int(sy + j, f->height - 1);
        int row = clamp_int(f->height - 1 - from_top - f->tile.y, f->tile.height - 1);
        for (int i = 0; i < w->n; i++) {
            int column = clamp_int(sx + i, f->tile.width - 1);
            const float *c = samples + 4 * ((size_t)row * (size_t)f->tile.width + (size_t)column);
            float weight = w->weight[i] * w->weight[j];
            for (int k = 0; k < 4; k++) out[k] += weight * (k < 3 && c[k] > c[3] ? c[3] : c[k]);
        }
    }
}

void sn_resolve(const sn_frame *f, const float *samples, sn_pixels px, sn_image *out)
{
    const float *background = f->opt->background;
    float ground[3];
    filter w;
    w.n = tent(f->samples, &w.first, w.weight);
    for (int k = 0; k < 3; k++) ground[k] = sn_srgb_to_linear(background[k]);
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(f->run))
    for (int y = px.y0; y < px.y1; y++)
        for (int x = px.x0; x < px.x1; x++) {
            float c[4];
            gather(f, &w, samples, x, y, c);
            put_pixel(c, background, ground, out->rgba + 4 * ((size_t)y * (size_t)out->width + (size_t)x));
        }
}
