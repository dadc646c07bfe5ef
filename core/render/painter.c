#include "render/painter.h"

#include "base/alloc.h"
#include "render/draw.h"

#include <stdio.h>
#include <string.h>

enum {
    tile_margin = 128, /* samples that tiles overlap, so that shading, which looks at neighbours, does
                          not see the seams */
    most_kept_samples = 1280 * 960 * 2 /* framebuffers of more than that are given back after the picture */
};

struct sn_painter {
    sn_context *context; /* NULL: none yet */
    sn_renderer renderer;
    sn_gl gl;
    sn_muscle_pass muscles;
    sn_surface_pass surfaces;
    sn_line_pass lines;
    sn_fiber_pass fibers;
    sn_arrow_pass arrows;
    sn_targets targets;
    uint16_t *samples; /* n_sample x 4 half floats, of a tile read back */
    size_t n_sample;
};

typedef struct drawing { /* what lives for one picture */
    sn_painter *painter;
    sn_frame frame;
    bool has_muscles, has_bones, has_skin, has_curves, has_fibers, has_arrows;
    int tile_width, tile_height, pixels_x, pixels_y; /* framebuffer, and the pixels that a tile brings */
} drawing;

sn_status sn_painter_create(sn_painter **out, sn_error *err)
{
    *out = SN_NEW_ZERO(sn_painter, 1);
    return *out ? SN_OK : sn_fail(err, SN_ENOMEM, "picture: no memory");
}

/* The context goes, and with it all that it holds. */
static void forget(sn_painter *p)
{
    sn_muscle_pass_free(&p->muscles);
    sn_surface_pass_free(&p->surfaces);
    sn_line_pass_free(&p->lines);
    sn_fiber_pass_free(&p->fibers);
    sn_arrow_pass_free(&p->arrows);
    p->targets = (sn_targets){0};
    sn_context_destroy(p->context);
    p->context = NULL;
}

void sn_painter_destroy(sn_painter *p)
{
    if (!p) return;
    forget(p);
    sn_release(p->samples);
    sn_release(p);
}

static sn_status need_context(sn_painter *p, sn_renderer renderer, sn_error *err)
{
    if (p->context && p->renderer == renderer) return sn_context_make_current(p->context, err);
    forget(p);
    sn_status st = sn_context_create(&p->context, renderer, err);
    p->renderer = renderer;
    return st ? st : sn_gl_load(&p->gl, p->context, err);
}

/* ---- what is to be drawn ---- */

static void look_at_scene(drawing *d)
{
    const sn_picture_scene *s = d->frame.scene;
    const sn_picture_options *opt = d->frame.opt;
    d->has_muscles = opt->show_muscles && s->tets;
    d->has_bones = opt->show_bones && s->n_bone > 0;
    d->has_skin = opt->show_skin && s->skin && opt->skin_opacity > 0.0;
    d->has_curves = (opt->show_curves || opt->show_points) && s->n_curve > 0;
    d->has_fibers = opt->show_fibers && s->n_fiber > 0;
    d->has_arrows = opt->show_frames && s->n_arrow > 0;
}

static sn_status update(drawing *d, sn_error *err)
{
    sn_painter *p = d->painter;
    const sn_frame *f = &d->frame;
    bool has_lines = d->has_curves || d->has_arrows || (d->has_fibers && !sn_fibers_are_solid(f));
    sn_status st =
        sn_targets_update(&p->targets, f, d->tile_width, d->tile_height, d->has_skin, has_lines, err);
    if (!st) st = sn_run_step(f->run, "sending bones", 0.0, err);
    if (!st && (d->has_bones || d->has_skin)) st = sn_surface_pass_update(&p->surfaces, f, err);
    if (!st && d->has_curves) st = sn_line_pass_update(&p->lines, f, err);
    if (!st && d->has_fibers) st = sn_fiber_pass_update(&p->fibers, f, err);
    if (!st && d->has_arrows) st = sn_arrow_pass_update(&p->arrows, f, err);
    if (!st && d->has_muscles) st = sn_muscle_pass_update(&p->muscles, f, err);
    return st;
}

/* The surfaces of the muscles; all tets when the section shows fat, too. */
static sn_box3 muscle_bounds(const drawing *d)
{
    if (!d->has_muscles) return sn_box3_empty();
    return d->frame.has_section ? sn_tet_mesh_bounds(d->frame.scene->tets) : d->painter->muscles.bounds;
}

/* ---- tiles ---- */

static int least(int a, int b)
{
    return a < b ? a : b;
}

/* One tile when the part that shows anything fits; otherwise tiles that overlap by the margin on all sides.
 */
static void plan_tiles(drawing *d, int tile_side)
{
    const sn_frame *f = &d->frame;
    int n = f->samples, inner = (tile_side - 2 * tile_margin) / n;
    int w = f->part.x1 - f->part.x0, h = f->part.y1 - f->part.y0;
    d->pixels_x = w * n <= tile_side ? w : inner;
    d->pixels_y = h * n <= tile_side ? h : inner;
}

static sn_tile tile_of(const drawing *d, sn_pixels px)
{
    const sn_frame *f = &d->frame;
    int n = f->samples, x0 = px.x0 * n - tile_margin, y0 = f->height - px.y1 * n - tile_margin;
    int x1 = px.x1 * n + tile_margin, y1 = f->height - px.y0 * n + tile_margin;
    int left = f->part.x0 * n, bottom = f->height - f->part.y1 * n;
    int right = f->part.x1 * n, top = f->height - f->part.y0 * n;
    x0 = x0 > left ? x0 : left;
    y0 = y0 > bottom ? y0 : bottom;
    return (sn_tile){x0, y0, least(x1, right) - x0, least(y1, top) - y0};
}

static void draw_solids(const drawing *d)
{
    const sn_frame *f = &d->frame;
    const sn_painter *p = d->painter;
    sn_targets_begin(&p->targets, f, p->targets.solid_frame);
    if (d->has_muscles) sn_muscle_pass_draw(&p->muscles, f);
    if (d->has_bones) sn_surface_pass_bones(&p->surfaces, f);
    if (d->has_fibers && sn_fibers_are_solid(f)) sn_fiber_pass_draw(&p->fibers, f);
}

static void draw_lines(const drawing *d)
{
    const sn_frame *f = &d->frame;
    const sn_painter *p = d->painter;
    sn_targets_begin(&p->targets, f, p->targets.line_frame);
    if (d->has_fibers && !sn_fibers_are_solid(f)) sn_fiber_pass_draw(&p->fibers, f);
    if (d->has_curves) sn_line_pass_draw(&p->lines, f);
    if (d->has_arrows) sn_arrow_pass_draw(&p->arrows, f);
}

static sn_status read_back(const drawing *d, sn_pixels px, sn_image *out, sn_error *err)
{
    const sn_frame *f = &d->frame;
    const sn_gl *gl = &f->gl;
    uint16_t *samples = d->painter->samples;
    gl->ReadBuffer(GL_COLOR_ATTACHMENT0);
    gl->ReadPixels(0, 0, f->tile.width, f->tile.height, GL_RGBA, GL_HALF_FLOAT, samples);
    sn_status st = sn_gl_check(gl, "drawing", err);
    return st ? st : sn_resolve(f, samples, px, out, err);
}

/* Steps report through `done` of all pixels; each step may be the last when the caller wants to stop. */
static sn_status draw_tile(drawing *d, sn_pixels px, double done, sn_image *out, sn_error *err)
{
    sn_frame *f = &d->frame;
    const sn_targets *t = &d->painter->targets;
    sn_frame_set_tile(f, tile_of(d, px));
    sn_status st = sn_run_step(f->run, "drawing", 0.5 + 0.5 * done, err);
    if (st) return st;
    draw_solids(d);
    if (d->has_skin) {
        sn_targets_begin(t, f, t->skin_frame);
        sn_surface_pass_skin(&d->painter->surfaces, f);
    }
    if (t->has_lines) draw_lines(d);
    st = sn_run_step(f->run, "lighting", 0.5 + 0.5 * done, err);
    if (st) return st;
    sn_targets_occlusion(t, f);
    sn_targets_final(t, f);
    return read_back(d, px, out, err);
}

static sn_status draw_tiles(drawing *d, sn_image *out, sn_error *err)
{
    const sn_gl *gl = &d->frame.gl;
    sn_pixels part = d->frame.part;
    double all = fmax(1.0, (double)(part.x1 - part.x0) * (part.y1 - part.y0));
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthFunc(GL_LEQUAL);
    gl->Enable(GL_DEPTH_CLAMP); /* nothing vanishes for being nearer or farther than the camera said */
    for (int y = part.y0; y < part.y1; y += d->pixels_y)
        for (int x = part.x0; x < part.x1; x += d->pixels_x) {
            sn_pixels px = {x, least(x + d->pixels_x, part.x1), y, least(y + d->pixels_y, part.y1)};
            double done =
                ((double)(y - part.y0) * (part.x1 - part.x0) + (double)(x - part.x0) * d->pixels_y) / all;
            sn_status st = draw_tile(d, px, fmin(done, 1.0), out, err);
            if (st) return st;
        }
    return SN_OK;
}

/* ---- the whole ---- */

static sn_status need_samples(sn_painter *p, size_t n, sn_error *err)
{
    if (p->n_sample >= n) return SN_OK;
    sn_release(p->samples);
    p->samples = sn_alloc(4 * n, sizeof *p->samples);
    p->n_sample = p->samples ? n : 0;
    if (!p->samples) return sn_fail(err, SN_ENOMEM, "picture: no memory for a tile of %zu samples", n);
    return SN_OK;
}

static void fill_background(sn_image *m, const float background[4])
{
    uint8_t none[4];
    sn_background_pixel(background, none);
    for (size_t i = 0; i < (size_t)m->width * (size_t)m->height; i++) memcpy(m->rgba + 4 * i, none, 4);
}

static bool is_blank(const sn_image *m, const float background[4])
{
    uint8_t none[4];
    sn_background_pixel(background, none);
    size_t n = (size_t)m->width * (size_t)m->height;
    for (size_t i = 0; i < n; i++)
        if (memcmp(m->rgba + 4 * i, none, 4) != 0) return false;
    return true;
}

/* With the context current. */
static sn_status draw(drawing *d, int tile_side, sn_image *out, sn_error *err)
{
    sn_painter *p = d->painter;
    sn_frame *f = &d->frame;
    f->gl = p->gl;
    look_at_scene(d);
    d->tile_width = least(f->width, tile_side); /* room for any part of the picture */
    d->tile_height = least(f->height, tile_side);
    fill_background(out, f->opt->background);
    sn_status st = need_samples(p, (size_t)d->tile_width * (size_t)d->tile_height, err);
    if (!st) st = update(d, err);
    if (!st) {
        sn_frame_set_parts(f, muscle_bounds(d));
        plan_tiles(d, tile_side);
        st = draw_tiles(d, out, err);
    }
    return st ? st : sn_run_step(f->run, "drawing", 1.0, err);
}

/* What a large picture took is not kept. */
static void trim(sn_painter *p)
{
    if ((int64_t)p->targets.width * p->targets.height <= most_kept_samples) return;
    sn_targets_clear(&p->targets, &p->gl);
    sn_release(p->samples);
    p->samples = NULL;
    p->n_sample = 0;
}

static void fill_stats(sn_picture_stats *stats, const drawing *d, const sn_image *m, double start)
{
    stats->tets_sent = d->has_muscles ? d->painter->muscles.n_sent : 0;
    stats->seconds = sn_clock() - start;
    stats->is_blank = is_blank(m, d->frame.opt->background);
    (void)snprintf(stats->renderer, sizeof stats->renderer, "%s", sn_context_renderer(d->painter->context));
}

sn_status sn_painter_draw_tiled(sn_painter *p, const sn_picture_scene *s, const sn_picture_options *opt,
                                int tile_side, const sn_run *run, sn_image *out, sn_picture_stats *stats,
                                sn_error *err)
{
    double start = sn_clock();
    drawing d = {.painter = p};
    sn_image_free(out);
    if (stats) *stats = (sn_picture_stats){0};
    sn_status st = sn_frame_init(&d.frame, s, opt, run, err);
    if (!st) st = sn_image_reserve(out, opt->width, opt->height, err);
    if (!st) st = need_context(p, opt->renderer, err);
    if (!st) st = draw(&d, tile_side, out, err);
    if (!st && stats) fill_stats(stats, &d, out, start);
    if (p->context) {
        trim(p);
        sn_context_release(p->context);
    }
    if (st) sn_image_free(out);
    return st;
}

sn_status sn_painter_draw(sn_painter *p, const sn_picture_scene *s, const sn_picture_options *opt,
                          const sn_run *run, sn_image *out, sn_picture_stats *stats, sn_error *err)
{
    return sn_painter_draw_tiled(p, s, opt, sn_tile_side, run, out, stats, err);
}
