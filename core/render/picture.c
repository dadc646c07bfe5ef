/* picture.c - one picture from beginning to end: what is checked, prepared once, and drawn tile by tile. */
#include "render/picture.h"

#include "base/alloc.h"
#include "render/context.h"
#include "render/draw.h"

#include <stdio.h>
#include <string.h>

#define PI 3.14159265358979323846
/* Samples that tiles overlap, so that shading, which looks at neighbours, does not see the seams. */
enum { tile_margin = 128 };

static sn_status check_options(const sn_picture_options *opt, sn_error *err)
{
    sn_status st = sn_camera_check(&opt->camera, err);
    if (st) return st;
    const int side[2] = {opt->width, opt->height};
    for (int k = 0; k < 2; k++)
        if (side[k] < 1 || side[k] > SN_IMAGE_MAX_SIDE)
            return sn_fail(err, SN_EINVAL, "picture: %s is %d pixels, need 1..%d", k ? "height" : "width",
                           side[k], SN_IMAGE_MAX_SIDE);
    if (opt->samples < 0 || opt->samples > 4)
        return sn_fail(err, SN_EINVAL, "picture: %d samples per pixel side, need 1..4 (0: the default)",
                       opt->samples);
    if (!(opt->skin_opacity >= 0.0 && opt->skin_opacity <= 1.0))
        return sn_fail(err, SN_EINVAL, "picture: skin opacity is %g, need 0..1", opt->skin_opacity);
    for (int k = 0; k < 4; k++)
        if (!(opt->background[k] >= 0.0f && opt->background[k] <= 1.0f))
            return sn_fail(err, SN_EINVAL, "picture: background value %d is %g, need 0..1", k + 1,
                           (double)opt->background[k]);
    if (opt->has_clip && (!sn_v3_is_finite(opt->clip_point) || !sn_v3_is_finite(opt->clip_normal) ||
                          !(sn_v3_len(opt->clip_normal) > 0.0)))
        return sn_fail(err, SN_EINVAL,
                       "picture: the clip plane has normal (%g, %g, %g), need a finite one with a length",
                       opt->clip_normal.x, opt->clip_normal.y, opt->clip_normal.z);
    return SN_OK;
}

static sn_status check_scene(const sn_picture_scene *s, sn_error *err)
{
    if (s->tets && (s->n_tissue < 1 || !s->field))
        return sn_fail(err, SN_EINVAL,
                       "picture: a tet mesh with %d tissues, need 1 (fat) or more and their values",
                       s->n_tissue);
    for (int32_t i = 0; i < s->n_fiber; i++)
        for (int32_t k = 0; k < s->fiber[i].n_point; k++)
            if (!sn_v3_is_finite(sn_v3_load(s->fiber[i].point + 3 * (size_t)k)))
                return sn_fail(err, SN_EINVAL, "picture: point %d of fiber %d is not finite", k + 1, i + 1);
    for (int32_t i = 0; i < s->n_arrow; i++)
        if (!sn_v3_is_finite(s->arrow[i].from) || !sn_v3_is_finite(s->arrow[i].along))
            return sn_fail(err, SN_EINVAL, "picture: arrow %d is not finite", i + 1);
    return SN_OK;
}

/* The scene's own length, or the diagonal of all there is to draw. */
static double scene_unit(const sn_picture_scene *s)
{
    if (s->unit > 0.0 && isfinite(s->unit)) return s->unit;
    sn_box3 box = sn_box3_empty();
    if (s->tets) box = sn_box3_merge(box, sn_tet_mesh_bounds(s->tets));
    if (s->skin) box = sn_box3_merge(box, sn_tri_mesh_bounds(s->skin));
    for (int i = 0; i < s->n_bone; i++) box = sn_box3_merge(box, sn_tri_mesh_bounds(s->bone[i]));
    for (int i = 0; i < s->n_curve; i++)
        for (int k = 0; k < s->curve[i].n_point; k++)
            box = sn_box3_add(box, sn_v3_load(s->curve[i].point + 3 * (size_t)k));
    for (int i = 0; i < s->n_fiber; i++)
        for (int k = 0; k < s->fiber[i].n_point; k++)
            box = sn_box3_add(box, sn_v3_load(s->fiber[i].point + 3 * (size_t)k));
    for (int i = 0; i < s->n_arrow; i++)
        box = sn_box3_add(sn_box3_add(box, s->arrow[i].from), sn_v3_add(s->arrow[i].from, s->arrow[i].along));
    double d = sn_box3_diagonal(box);
    return d > 0.0 ? d : 1.0;
}

sn_status sn_frame_init(sn_frame *f, const sn_picture_scene *s, const sn_picture_options *opt,
                        const sn_run *run, sn_error *err)
{
    memset(f, 0, sizeof *f);
    sn_status st = check_options(opt, err);
    if (!st) st = check_scene(s, err);
    if (st) return st;
    const sn_camera *c = &opt->camera;
    f->scene = s;
    f->opt = opt;
    f->run = run;
    f->samples = opt->samples ? opt->samples : 2;
    f->width = opt->width * f->samples;
    f->height = opt->height * f->samples;
    f->unit = scene_unit(s);
    f->eye = c->eye;
    sn_camera_frame(c, &f->right, &f->up, &f->back);
    f->depth[0] = (float)((c->zfar + c->znear) / (c->zfar - c->znear));
    f->depth[1] = (float)(-2.0 * c->zfar * c->znear / (c->zfar - c->znear));
    f->slope = (float)(2.0 * tan(0.5 * c->fov_deg * (PI / 180.0)) / f->height);
    f->plane_offset = -1.0; /* removes nothing */
    if (opt->has_clip) {
        f->plane_normal = sn_v3_unit(opt->clip_normal);
        f->plane_offset = sn_v3_dot(f->plane_normal, sn_v3_sub(f->eye, opt->clip_point));
        f->has_section = f->plane_offset > 0.0;
    }
    return SN_OK;
}

void sn_frame_set_tile(sn_frame *f, sn_tile tile)
{
    f->tile = tile;
    const sn_vec3 axis[3] = {f->right, f->up, f->back};
    double focus = 2.0 / (double)f->slope; /* samples per unit slope, doubled */
    double sx = focus / tile.width, sy = focus / tile.height;
    double ox = (double)(f->width - 2 * tile.x) / tile.width - 1.0;
    double oy = (double)(f->height - 2 * tile.y) / tile.height - 1.0;
    for (int k = 0; k < 3; k++) {
        double a[3] = {k == 0   ? axis[0].x
                       : k == 1 ? axis[0].y
                                : axis[0].z,
                       k == 0   ? axis[1].x
                       : k == 1 ? axis[1].y
                                : axis[1].z,
                       k == 0   ? axis[2].x
                       : k == 1 ? axis[2].y
                                : axis[2].z};
        f->clip[4 * k] = (float)(sx * a[0] - ox * a[2]);
        f->clip[4 * k + 1] = (float)(sy * a[1] - oy * a[2]);
        f->clip[4 * k + 2] = (float)(-(double)f->depth[0] * a[2]);
        f->clip[4 * k + 3] = (float)-a[2];
    }
    f->clip[12] = f->clip[13] = f->clip[15] = 0.0f;
    f->clip[14] = f->depth[1];
}

void sn_frame_use(const sn_frame *f, GLuint program)
{
    const sn_gl *gl = &f->gl;
    const float turn[9] = {(float)f->right.x, (float)f->up.x, (float)f->back.x,
                           (float)f->right.y, (float)f->up.y, (float)f->back.y,
                           (float)f->right.z, (float)f->up.z, (float)f->back.z};
    gl->UseProgram(program);
    gl->UniformMatrix4fv(gl->GetUniformLocation(program, "u_clip"), 1, GL_FALSE, f->clip);
    gl->UniformMatrix3fv(gl->GetUniformLocation(program, "u_turn"), 1, GL_FALSE, turn);
    gl->Uniform4f(gl->GetUniformLocation(program, "u_plane"), (float)f->plane_normal.x,
                  (float)f->plane_normal.y, (float)f->plane_normal.z, (float)f->plane_offset);
    gl->Uniform2f(gl->GetUniformLocation(program, "u_depth"), f->depth[0], f->depth[1]);
    gl->Uniform1f(gl->GetUniformLocation(program, "u_slope"), f->slope);
}

typedef struct drawing { /* everything that lives for one picture */
    sn_context *context;
    sn_frame frame;
    sn_muscle_pass muscles;
    sn_surface_pass surfaces;
    sn_line_pass lines;
    sn_fiber_pass fibers;
    sn_arrow_pass arrows;
    sn_targets targets;
    float *samples;                                  /* one tile, read back */
    int tile_width, tile_height, pixels_x, pixels_y; /* framebuffer, and the pixels that a tile brings */
} drawing;

/* One tile when the picture fits; otherwise tiles that overlap by the margin on all sides. */
static void plan_tiles(drawing *d, int tile_side)
{
    const sn_frame *f = &d->frame;
    int inner = (tile_side - 2 * tile_margin) / f->samples;
    d->pixels_x = f->width <= tile_side ? f->opt->width : inner;
    d->pixels_y = f->height <= tile_side ? f->opt->height : inner;
    d->tile_width = f->width <= tile_side ? f->width : tile_side;
    d->tile_height = f->height <= tile_side ? f->height : tile_side;
}

static sn_status prepare(drawing *d, int tile_side, sn_error *err)
{
    sn_frame *f = &d->frame;
    const sn_picture_options *opt = f->opt;
    sn_status st = sn_context_create(&d->context, err);
    if (!st) st = sn_gl_load(&f->gl, err);
    if (st) return st;
    plan_tiles(d, tile_side);
    d->targets.has_skin = opt->show_skin && f->scene->skin && opt->skin_opacity > 0.0;
    bool has_curves = (opt->show_curves || opt->show_points) && f->scene->n_curve > 0;
    bool has_fibers = opt->show_fibers && f->scene->n_fiber > 0;
    bool has_arrows = opt->show_frames && f->scene->n_arrow > 0;
    bool has_muscles = opt->show_muscles && f->scene->tets;
    d->targets.has_lines = has_curves || has_arrows || (has_fibers && has_muscles);
    d->samples = sn_alloc(4 * (size_t)d->tile_width * (size_t)d->tile_height, sizeof *d->samples);
    if (!d->samples)
        return sn_fail(err, SN_ENOMEM, "picture: no memory for a tile of %d x %d samples", d->tile_width,
                       d->tile_height);
    st = sn_targets_create(&d->targets, f, d->tile_width, d->tile_height, err);
    if (!st) st = sn_run_step(f->run, "sending bones", 0.0, err);
    if (!st) st = sn_surface_pass_prepare(&d->surfaces, f, err);
    if (!st && has_curves) st = sn_line_pass_prepare(&d->lines, f, err);
    if (!st && has_fibers) st = sn_fiber_pass_prepare(&d->fibers, f, err);
    if (!st && has_arrows) st = sn_arrow_pass_prepare(&d->arrows, f, err);
    if (!st && has_muscles) st = sn_muscle_pass_prepare(&d->muscles, f, err);
    return st;
}

static sn_tile tile_of(const drawing *d, sn_pixels px)
{
    const sn_frame *f = &d->frame;
    int n = f->samples, x0 = px.x0 * n - tile_margin, y0 = f->height - px.y1 * n - tile_margin;
    int x1 = px.x1 * n + tile_margin, y1 = f->height - px.y0 * n + tile_margin;
    x0 = x0 > 0 ? x0 : 0;
    y0 = y0 > 0 ? y0 : 0;
    x1 = x1 < f->width ? x1 : f->width;
    y1 = y1 < f->height ? y1 : f->height;
    return (sn_tile){x0, y0, x1 - x0, y1 - y0};
}

static void draw_solids(const drawing *d)
{
    const sn_frame *f = &d->frame;
    sn_targets_begin(&d->targets, f, d->targets.solid_frame);
    if (d->muscles.tet_program) sn_muscle_pass_draw(&d->muscles, f);
    sn_surface_pass_bones(&d->surfaces, f);
    if (d->fibers.is_solid) sn_fiber_pass_draw(&d->fibers, f);
}

static void draw_lines(const drawing *d)
{
    const sn_frame *f = &d->frame;
    sn_targets_begin(&d->targets, f, d->targets.line_frame);
    if (d->fibers.program && !d->fibers.is_solid) sn_fiber_pass_draw(&d->fibers, f);
    if (d->lines.program) sn_line_pass_draw(&d->lines, f);
    if (d->arrows.program) sn_arrow_pass_draw(&d->arrows, f);
}

/* Steps report through `done` of all pixels; each step may be the last when the caller wants to stop. */
static sn_status draw_tile(drawing *d, sn_pixels px, double done, sn_image *out, sn_error *err)
{
    sn_frame *f = &d->frame;
    const sn_gl *gl = &f->gl;
    sn_frame_set_tile(f, tile_of(d, px));
    sn_status st = sn_run_step(f->run, "drawing", 0.5 + 0.5 * done, err);
    if (st) return st;
    draw_solids(d);
    if (d->targets.has_skin) {
        sn_targets_begin(&d->targets, f, d->targets.skin_frame);
        sn_surface_pass_skin(&d->surfaces, f);
    }
    if (d->targets.has_lines) draw_lines(d);
    st = sn_run_step(f->run, "lighting", 0.5 + 0.5 * done, err);
    if (st) return st;
    sn_targets_occlusion(&d->targets, f);
    sn_targets_final(&d->targets, f);
    gl->ReadBuffer(GL_COLOR_ATTACHMENT0);
    gl->ReadPixels(0, 0, f->tile.width, f->tile.height, GL_RGBA, GL_FLOAT, d->samples);
    st = sn_gl_check(gl, "drawing", err);
    if (!st) sn_resolve(f, d->samples, px, out);
    return st;
}

static sn_status draw_tiles(drawing *d, sn_image *out, sn_error *err)
{
    const sn_gl *gl = &d->frame.gl;
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthFunc(GL_LEQUAL);
    gl->Enable(GL_DEPTH_CLAMP); /* nothing vanishes for being nearer or farther than the camera said */
    for (int y = 0; y < out->height; y += d->pixels_y)
        for (int x = 0; x < out->width; x += d->pixels_x) {
            sn_pixels px = {x, x + d->pixels_x, y, y + d->pixels_y};
            if (px.x1 > out->width) px.x1 = out->width;
            if (px.y1 > out->height) px.y1 = out->height;
            double done =
                ((double)y * out->width + (double)x * d->pixels_y) / ((double)out->width * out->height);
            sn_status st = draw_tile(d, px, fmin(done, 1.0), out, err);
            if (st) return st;
        }
    return SN_OK;
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

static void drawing_free(drawing *d)
{
    sn_muscle_pass_free(&d->muscles);
    sn_surface_pass_free(&d->surfaces);
    sn_line_pass_free(&d->lines);
    sn_fiber_pass_free(&d->fibers);
    sn_arrow_pass_free(&d->arrows);
    sn_release(d->samples);
    sn_context_destroy(d->context);
}

sn_status sn_picture_draw_tiled(const sn_picture_scene *s, const sn_picture_options *opt, int tile_side,
                                const sn_run *run, sn_image *out, sn_picture_stats *stats, sn_error *err)
{
    double start = sn_clock();
    drawing d = {0};
    sn_image_free(out);
    if (stats) *stats = (sn_picture_stats){0};
    sn_status st = sn_frame_init(&d.frame, s, opt, run, err);
    if (!st) st = sn_image_reserve(out, opt->width, opt->height, err);
    if (!st) st = prepare(&d, tile_side, err);
    if (!st) st = draw_tiles(&d, out, err);
    if (!st) st = sn_run_step(run, "drawing", 1.0, err);
    if (!st && stats) {
        stats->tets_sent = d.muscles.n_sent;
        stats->seconds = sn_clock() - start;
        stats->is_blank = is_blank(out, opt->background);
        (void)snprintf(stats->renderer, sizeof stats->renderer, "%s", sn_context_renderer(d.context));
    }
    drawing_free(&d);
    if (st) sn_image_free(out);
    return st;
}

sn_status sn_picture_draw(const sn_picture_scene *s, const sn_picture_options *opt, const sn_run *run,
                          sn_image *out, sn_picture_stats *stats, sn_error *err)
{
    return sn_picture_draw_tiled(s, opt, sn_tile_side, run, out, stats, err);
}
