/* picture_resolve.c - samples (linear, premultiplied) to 8-bit sRGB pixels with straight alpha. */
#include "render/draw.h"

#include "base/alloc.h"
#include "render/srgb.h"

#include <math.h>
#include <string.h>

enum { n_guess = 1024, least_parallel = 1 << 20 }; /* fewer pixels take less time than waking threads does */

void sn_background_pixel(const float background[4], uint8_t out[4])
{
    for (int k = 0; k < 4; k++) out[k] = sn_to_byte(background[k]);
}

/* ---- linear light to bytes, by looking up ---- */

typedef struct byte_table {
    float from[257];        /* byte b stands for from[b] <= light < from[b + 1] */
    uint8_t guess[n_guess]; /* the byte for the beginning of each interval      */
} byte_table;

static void table_make(byte_table *t)
{
    t->from[0] = -INFINITY;
    t->from[256] = INFINITY;
    for (int b = 1; b < 256; b++) t->from[b] = sn_srgb_to_linear(((float)b - 0.5f) / 255.0f);
    for (int i = 0, b = 0; i < n_guess; i++) {
        while (t->from[b + 1] <= (float)i / n_guess) b++;
        t->guess[i] = (uint8_t)b;
    }
}

static uint8_t to_byte(const byte_table *t, float light)
{
    if (!(light > 0.0f)) return 0;
    if (light >= 1.0f) return 255;
    int b = t->guess[(int)(light * n_guess)];
    while (light >= t->from[b + 1]) b++;
    return (uint8_t)b;
}

/* ---- the filter ---- */

typedef struct filter {
    float weight[8];
    int first, n;
} filter;

/* Weights of the samples around a pixel along one axis: a tent two pixels wide. tap 0 is `first` samples
 * after the pixel's first sample (at most 0). */
static filter tent(int samples)
{
    filter w = {.first = -(samples / 2)};
    float sum = 0.0f;
    for (int k = w.first; k < samples + samples / 2; k++) {
        float at = ((float)k + 0.5f) / (float)samples - 0.5f; /* in pixels from its middle */
        w.weight[w.n] = 1.0f - fabsf(at);
        sum += w.weight[w.n++];
    }
    for (int k = 0; k < w.n; k++) w.weight[k] /= sum;
    return w;
}

static int clamp_int(int v, int last)
{
    return v < 0 ? 0 : v > last ? last : v;
}

typedef struct resolving {
    const sn_frame *frame;
    const uint16_t *samples;
    sn_pixels px;
    filter filter;
    byte_table table;
    uint8_t none[4];
    float ground[3];
} resolving;

/* A half float that is not negative: its bits as those of a float, but for the bias of the exponent. */
static inline float from_half(uint16_t h)
{
    uint32_t bits = (uint32_t)(h & 0x7fff) << 13;
    float f;
    memcpy(&f, &bits, sizeof f);
    return f * 0x1p112f;
}

/* A row of samples in single precision; colours above what they cover are bounded by it. false: nothing was
 * drawn there, and out is not set. */
static bool load_row(const resolving *r, int row, float *out)
{
    size_t n = 4 * (size_t)r->frame->tile.width, first = 0, end = n;
    const uint16_t *in = r->samples + n * (size_t)row;
    while (first < n && in[first + 3] == 0) first += 4;
    if (first == n) return false;
    while (in[end - 1] == 0) end -= 4;
    memset(out, 0, first * sizeof *out);
    memset(out + end, 0, (n - end) * sizeof *out);
    for (size_t i = first; i < end; i += 4) {
        float a = from_half(in[i + 3]);
        for (size_t k = 0; k < 3; k++) {
            float c = from_half(in[i + k]);
            out[i + k] = c > a ? a : c;
        }
        out[i + 3] = a;
    }
    return true;
}

static inline void add_sample(const float *c, float weight, float out[4])
{
    for (int k = 0; k < 4; k++) out[k] += weight * c[k];
}

/* Sums a row of samples along it: 4 numbers per pixel, times `weight`, into out. Beyond the tile's edge,
 * which is then the part's, the edge repeats. */
static void add_row(const resolving *r, const float *row, float weight, float *out)
{
    const sn_frame *f = r->frame;
    int last = f->tile.width - 1, n = r->filter.n;
    float w[8];
    for (int i = 0; i < n; i++) w[i] = weight * r->filter.weight[i];
    for (int x = r->px.x0; x < r->px.x1; x++, out += 4) {
        int first = x * f->samples - f->tile.x + r->filter.first;
        float sum[4] = {out[0], out[1], out[2], out[3]};
        if (first >= 0 && first + n <= last + 1)
            for (int i = 0; i < n; i++) add_sample(row + 4 * (first + i), w[i], sum);
        else
            for (int i = 0; i < n; i++) add_sample(row + 4 * clamp_int(first + i, last), w[i], sum);
        memcpy(out, sum, sizeof sum);
    }
}

/* c: premultiplied colour of what was drawn, laid over the background. */
static void put_pixel(const resolving *r, const float c[4], uint8_t out[4])
{
    if (!(c[3] > 0.0f)) {
        memcpy(out, r->none, 4);
        return;
    }
    float rest = r->frame->opt->background[3] * (1.0f - c[3]), alpha = c[3] + rest;
    for (int k = 0; k < 3; k++) out[k] = to_byte(&r->table, (c[k] + rest * r->ground[k]) / alpha);
    out[3] = sn_to_byte(alpha);
}

/* room: a row of samples and one of pixels. */
static void resolve_row(const resolving *r, int y, float *room, sn_image *out)
{
    const sn_frame *f = r->frame;
    int n_pixel = r->px.x1 - r->px.x0;
    float *row = room, *sum = room + 4 * (size_t)f->tile.width;
    memset(sum, 0, 4 * (size_t)n_pixel * sizeof *sum);
    for (int j = 0; j < r->filter.n; j++) {
        int from_top = clamp_int(y * f->samples + r->filter.first + j, f->height - 1);
        if (load_row(r, clamp_int(f->height - 1 - from_top - f->tile.y, f->tile.height - 1), row))
            add_row(r, row, r->filter.weight[j], sum);
    }
    uint8_t *to = out->rgba + 4 * ((size_t)y * (size_t)out->width + (size_t)r->px.x0);
    for (int x = 0; x < n_pixel; x++) put_pixel(r, sum + 4 * (size_t)x, to + 4 * (size_t)x);
}

sn_status sn_resolve(const sn_frame *f, const uint16_t *samples, sn_pixels px, sn_image *out, sn_error *err)
{
    resolving r = {.frame = f, .samples = samples, .px = px, .filter = tent(f->samples)};
    size_t n_pixel = (size_t)(px.x1 - px.x0) * (size_t)(px.y1 - px.y0);
    int n_threads = n_pixel < least_parallel ? 1 : sn_run_threads(f->run);
    bool is_short = false;
    table_make(&r.table);
    sn_background_pixel(f->opt->background, r.none);
    for (int k = 0; k < 3; k++) r.ground[k] = sn_srgb_to_linear(f->opt->background[k]);
#pragma omp parallel num_threads(n_threads) reduction(|| : is_short)
    {
        float *room = SN_NEW(float, 4 * ((size_t)f->tile.width + (size_t)(px.x1 - px.x0)));
        is_short = !room;
#pragma omp for schedule(static)
        for (int y = px.y0; y < px.y1; y++)
            if (!is_short) resolve_row(&r, y, room, out);
        sn_release(room);
    }
    return is_short ? sn_fail(err, SN_ENOMEM, "picture: no memory for a row of pixels") : SN_OK;
}
