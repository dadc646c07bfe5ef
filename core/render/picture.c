/* picture.c - what is known of a picture before anything is drawn: checks, the view, which part of it shows
 * anything; and the picture drawn once. */
#include "render/picture.h"

#include "base/alloc.h"
#include "render/draw.h"
#include "render/painter.h"

#include <string.h>

#define PI 3.14159265358979323846
enum { part_margin = 8 }; /* pixels: contours, lines of a least width, the filter of the samples */
static const double line_margin =
    0.02; /* of the unit: more than the radius of anything laid over the picture */

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

static sn_box3 add_points(sn_box3 box, const double *point, int32_t n)
{
    for (int32_t k = 0; k < n; k++) box = sn_box3_add(box, sn_v3_load(point + 3 * (size_t)k));
    return box;
}

/* Of curves, control points, fibers and arrows. */
static sn_box3 line_bounds(const sn_picture_scene *s)
{
    sn_box3 box = sn_box3_empty();
    for (int i = 0; i < s->n_curve; i++) {
        box = add_points(box, s->curve[i].point, s->curve[i].n_point);
        box = add_points(box, s->curve[i].control, s->curve[i].n_control);
    }
    for (int i = 0; i < s->n_fiber; i++) box = add_points(box, s->fiber[i].point, s->fiber[i].n_point);
    for (int i = 0; i < s->n_arrow; i++)
        box = sn_box3_add(sn_box3_add(box, s->arrow[i].from), sn_v3_add(s->arrow[i].from, s->arrow[i].along));
    return box;
}

static sn_box3 surface_bounds(const sn_picture_scene *s)
{
    sn_box3 box = s->skin ? sn_tri_mesh_bounds(s->skin) : sn_box3_empty();
    for (int i = 0; i < s->n_bone; i++) box = sn_box3_merge(box, sn_tri_mesh_bounds(s->bone[i]));
    return box;
}

/* The scene's own length, or the diagonal of all there is to draw. */
static double scene_unit(const sn_picture_scene *s)
{
    if (s->unit > 0.0 && isfinite(s->unit)) return s->unit;
    sn_box3 box = sn_box3_merge(surface_bounds(s), line_bounds(s));
    if (s->tets) box = sn_box3_merge(box, sn_tet_mesh_bounds(s->tets));
    double d = sn_box3_diagonal(box);
    return d > 0.0 ? d : 1.0;
}

/* The middle of the surfaces, or without any of the tets, or of the lines: what is hidden in one picture and
 * shown in the next moves it as rarely as can be, for all that is kept counts from it. */
static sn_vec3 scene_origin(const sn_picture_scene *s)
{
    sn_box3 box = surface_bounds(s);
    if (!(box.min.x <= box.max.x)) box = s->tets ? sn_tet_mesh_bounds(s->tets) : line_bounds(s);
    return box.min.x <= box.max.x ? sn_v3_lerp(box.min, box.max, 0.5) : sn_v3(0.0, 0.0, 0.0);
}

/* A box around what is laid over the picture, or around fibers among the solid things. */
static sn_box3 wide_line_bounds(const sn_picture_scene *s, double unit)
{
    sn_box3 lines = line_bounds(s);
    if (!(lines.min.x <= lines.max.x)) return lines;
    double r = line_margin * unit; /* heads of arrows are wider: a tenth of their lengths */
    for (int i = 0; i < s->n_arrow; i++) r = fmax(r, 0.1 * sn_v3_len(s->arrow[i].along));
    sn_vec3 out = sn_v3(r, r, r);
    return (sn_box3){sn_v3_sub(lines.min, out), sn_v3_add(lines.max, out)};
}

static int whole_pixel(double v, int last)
{
    return v <= 0.0 ? 0 : v >= last ? last : (int)v;
}

/* The pixels that the box covers; all of them when it reaches behind the eye. */
static sn_pixels covered_part(const sn_frame *f, sn_box3 box)
{
    int w = f->opt->width, h = f->opt->height;
    double x0 = INFINITY, x1 = -INFINITY, y0 = INFINITY, y1 = -INFINITY;
    if (!(box.min.x <= box.max.x)) return (sn_pixels){0, 0, 0, 0};
    for (int k = 0; k < 8; k++) {
        sn_vec3 p = sn_v3(k & 1 ? box.max.x : box.min.x, k & 2 ? box.max.y : box.min.y,
                          k & 4 ? box.max.z : box.min.z);
        p = sn_v3_sub(p, f->eye);
        double far = -sn_v3_dot(p, f->back), scale = (double)f->slope * f->samples * far;
        if (!(far > 1e-6 * f->unit)) return (sn_pixels){0, w, 0, h};
        double x = 0.5 * w + sn_v3_dot(p, f->right) / scale, y = 0.5 * h - sn_v3_dot(p, f->up) / scale;
        x0 = fmin(x0, x);
        x1 = fmax(x1, x);
        y0 = fmin(y0, y);
        y1 = fmax(y1, y);
    }
    return (sn_pixels){whole_pixel(floor(x0) - part_margin, w), whole_pixel(ceil(x1) + part_margin, w),
                       whole_pixel(floor(y0) - part_margin, h), whole_pixel(ceil(y1) + part_margin, h)};
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
    f->origin = scene_origin(s);
    return SN_OK;
}

static int least(int a, int b)
{
    return a < b ? a : b;
}

static int most(int a, int b)
{
    return a > b ? a : b;
}

static sn_pixels both_parts(sn_pixels a, sn_pixels b)
{
    if (a.x0 >= a.x1 || a.y0 >= a.y1) return b;
    if (b.x0 >= b.x1 || b.y0 >= b.y1) return a;
    return (sn_pixels){least(a.x0, b.x0), most(a.x1, b.x1), least(a.y0, b.y0), most(a.y1, b.y1)};
}

void sn_frame_set_parts(sn_frame *f, sn_box3 muscles)
{
    const sn_picture_scene *s = f->scene;
    const sn_picture_options *opt = f->opt;
    sn_box3 solid = muscles;
    bool has_lines = opt->show_curves || opt->show_points || opt->show_fibers || opt->show_frames;
    sn_pixels lines = has_lines ? covered_part(f, wide_line_bounds(s, f->unit)) : (sn_pixels){0};
    for (int i = 0; opt->show_bones && i < s->n_bone; i++)
        solid = sn_box3_merge(solid, sn_tri_mesh_bounds(s->bone[i]));
    f->solid_part = covered_part(f, solid);
    if (opt->show_fibers && sn_fibers_are_solid(f)) f->solid_part = both_parts(f->solid_part, lines);
    f->part = both_parts(f->solid_part, lines);
    if (opt->show_skin && s->skin)
        f->part = both_parts(f->part, covered_part(f, sn_tri_mesh_bounds(s->skin)));
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
    gl->Uniform3f(gl->GetUniformLocation(program, "u_shift"), (float)(f->origin.x - f->eye.x),
                  (float)(f->origin.y - f->eye.y), (float)(f->origin.z - f->eye.z));
    gl->Uniform4f(gl->GetUniformLocation(program, "u_plane"), (float)f->plane_normal.x,
                  (float)f->plane_normal.y, (float)f->plane_normal.z, (float)f->plane_offset);
    gl->Uniform2f(gl->GetUniformLocation(program, "u_depth"), f->depth[0], f->depth[1]);
    gl->Uniform1f(gl->GetUniformLocation(program, "u_slope"), f->slope);
}

/* ---- what is kept ---- */

sn_key sn_frame_key(const sn_frame *f, uint64_t stamp0, uint64_t stamp1)
{
    return (sn_key){.stamp = {stamp0, stamp1}, .origin = f->origin, .unit = f->unit};
}

bool sn_key_same(const sn_key *a, const sn_key *b)
{
    return a->stamp[0] != 0 && a->stamp[1] != 0 && memcmp(a, b, sizeof *a) == 0;
}

sn_clip_key sn_frame_clip_key(const sn_frame *f)
{
    sn_clip_key k = {.has_section = f->has_section};
    if (!f->has_section) return k;
    k.point = f->opt->clip_point;
    k.normal = f->plane_normal;
    return k;
}

bool sn_clip_key_same(const sn_clip_key *a, const sn_clip_key *b)
{
    return a->has_section == b->has_section && memcmp(&a->point, &b->point, sizeof a->point) == 0 &&
           memcmp(&a->normal, &b->normal, sizeof a->normal) == 0;
}

sn_status sn_mesh_list_reserve(sn_mesh_list *l, int n, sn_error *err)
{
    l->mesh = SN_NEW_ZERO(sn_gl_mesh, n);
    l->n = 0;
    l->cap = l->mesh ? n : 0;
    return l->mesh ? SN_OK : sn_fail(err, SN_ENOMEM, "picture: no memory for %d batches", n);
}

void sn_mesh_list_clear(sn_mesh_list *l, const sn_gl *gl)
{
    for (int i = 0; gl && i < l->n; i++) sn_gl_delete_mesh(gl, &l->mesh[i]);
    sn_release(l->mesh);
    *l = (sn_mesh_list){0};
}

sn_status sn_picture_draw(const sn_picture_scene *s, const sn_picture_options *opt, const sn_run *run,
                          sn_image *out, sn_picture_stats *stats, sn_error *err)
{
    sn_painter *p = NULL;
    sn_image_free(out);
    sn_status st = sn_painter_create(&p, err);
    if (!st) st = sn_painter_draw(p, s, opt, run, out, stats, err);
    sn_painter_destroy(p);
    return st;
}
