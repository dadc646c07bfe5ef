/* picture_lines.c - curves as round tubes, control points as balls, both with a dark contour. They go to a
 * layer of their own, which the final pass lays over the picture: full where they are in front, faint where
 * something hides them. */
#include "render/draw.h"

#include "base/alloc.h"
#include "render/shaders.h"

#include <string.h>

enum { n_side = 12, ball_rings = 10, ball_sides = 16 };
static const double tube_radius = 0.0022, ball_radius = 0.0050; /* of the scene's unit */
static const float tube_pixels = 1.1f, ball_pixels = 2.6f;      /* least radius on the picture */
static const float contour_pixels = 0.9f;

/* A vertex: the point on the curve and the direction in which the shader moves it out by the radius. */
static void put_vertex(float *data, size_t at, const sn_frame *f, sn_vec3 centre, sn_vec3 dir)
{
    sn_frame_place(f, centre, data + 6 * at);
    data[6 * at + 3] = (float)dir.x;
    data[6 * at + 4] = (float)dir.y;
    data[6 * at + 5] = (float)dir.z;
}

typedef struct ring { /* directions centre-outward: cos * (across) + sin * along */
    sn_vec3 centre, u, v, along;
    double tilt; /* radians towards along, for the round ends */
} ring;

static sn_vec3 ring_dir(const ring *r, int k, int n)
{
    double a = 6.28318530717958648 * k / n;
    sn_vec3 across = sn_v3_add(sn_v3_scale(cos(a), r->u), sn_v3_scale(sin(a), r->v));
    return sn_v3_mad(sn_v3_scale(cos(r->tilt), across), sin(r->tilt), r->along);
}

/* The band between two rings, outside out when b lies ahead of a along u x v; returns the next free vertex.
 */
static size_t put_band(float *data, size_t at, const sn_frame *f, const ring *a, const ring *b, int n)
{
    for (int k = 0; k < n; k++) {
        sn_vec3 a0 = ring_dir(a, k, n), a1 = ring_dir(a, k + 1, n), b0 = ring_dir(b, k, n),
                b1 = ring_dir(b, k + 1, n);
        put_vertex(data, at++, f, a->centre, a0);
        put_vertex(data, at++, f, a->centre, a1);
        put_vertex(data, at++, f, b->centre, b1);
        put_vertex(data, at++, f, a->centre, a0);
        put_vertex(data, at++, f, b->centre, b1);
        put_vertex(data, at++, f, b->centre, b0);
    }
    return at;
}

static sn_vec3 any_normal(sn_vec3 t)
{
    return sn_v3_unit(sn_v3_cross(t, fabs(t.x) < 0.6 ? sn_v3(1, 0, 0) : sn_v3(0, 1, 0)));
}

/* Points of the curve without repetitions; returns how many. */
static int32_t distinct_points(const sn_picture_curve *c, double least, sn_vec3 *out)
{
    int32_t n = 0;
    for (int32_t i = 0; i < c->n_point; i++) {
        sn_vec3 p = sn_v3_load(c->point + 3 * (size_t)i);
        if (n == 0 || sn_v3_dist(out[n - 1], p) > least) out[n++] = p;
    }
    return n;
}

static size_t put_tube(float *data, const sn_frame *f, const sn_vec3 *p, int32_t n)
{
    static const double end_tilt[4] = {-1.57079632679489662, -1.0471975511965976, -0.5235987755982988, 0.0};
    size_t at = 0;
    ring last = {0}, next;
    for (int32_t i = 0; i < n; i++) {
        sn_vec3 t = sn_v3_unit(sn_v3_sub(p[i + 1 < n ? i + 1 : i], p[i > 0 ? i - 1 : i]));
        if (!(sn_v3_len2(t) > 0.0)) t = last.along; /* the curve turns back on itself */
        /* The last frame's normal, made square to the new tangent: close to parallel transport for short
         * steps. */
        sn_vec3 u = i > 0 ? sn_v3_mad(last.u, -sn_v3_dot(last.u, t), t) : any_normal(t);
        u = sn_v3_len2(u) > 1e-12 ? sn_v3_unit(u) : any_normal(t);
        next = (ring){.centre = p[i], .u = u, .v = sn_v3_cross(t, u), .along = t};
        if (i > 0) at = put_band(data, at, f, &last, &next, n_side);
        last = next;
        for (int k = 0; k < 3; k++) { /* round ends */
            ring a = last, b = last;
            if (i > 0 && i < n - 1) break;
            a.tilt = i == 0 ? end_tilt[k] : -end_tilt[3 - k];
            b.tilt = i == 0 ? end_tilt[k + 1] : -end_tilt[2 - k];
            at = put_band(data, at, f, &a, &b, n_side);
        }
    }
    return at;
}

static sn_status send_tube(sn_gl_mesh *out, const sn_picture_curve *c, const sn_frame *f, sn_error *err)
{
    size_t n_band = (size_t)c->n_point + 5;
    float *data = SN_NEW(float, 36 * n_side * n_band);
    sn_vec3 *p = SN_NEW(sn_vec3, c->n_point);
    sn_status st = SN_OK;
    if (data && p) {
        int32_t n = distinct_points(c, 1e-7 * f->unit, p);
        size_t n_vert = n > 1 ? put_tube(data, f, p, n) : 0;
        if (n_vert > 0) *out = sn_gl_vertex_array(&f->gl, 2, data, n_vert);
    } else {
        st = sn_fail(err, SN_ENOMEM, "picture: no memory for a curve of %d points", c->n_point);
    }
    sn_release(data);
    sn_release(p);
    return st;
}

static sn_status send_balls(sn_gl_mesh *out, const sn_picture_curve *c, const sn_frame *f, sn_error *err)
{
    size_t n = 6 * ball_rings * ball_sides * (size_t)c->n_control, at = 0;
    float *data = SN_NEW(float, 6 * n);
    if (!data) return sn_fail(err, SN_ENOMEM, "picture: no memory for %d control points", c->n_control);
    for (int32_t i = 0; i < c->n_control; i++) {
        ring a = {.centre = sn_v3_load(c->control + 3 * (size_t)i),
                  .u = {1, 0, 0},
                  .v = {0, 1, 0},
                  .along = {0, 0, 1}};
        for (int k = 0; k < ball_rings; k++) {
            ring b = a;
            a.tilt = 3.14159265358979323846 * ((double)k / ball_rings - 0.5);
            b.tilt = 3.14159265358979323846 * ((double)(k + 1) / ball_rings - 0.5);
            at = put_band(data, at, f, &a, &b, ball_sides);
        }
    }
    *out = sn_gl_vertex_array(&f->gl, 2, data, n);
    sn_release(data);
    return SN_OK;
}

static sn_status send_lines(sn_line_pass *p, const sn_frame *f, sn_error *err)
{
    const sn_picture_scene *s = f->scene;
    sn_status st = sn_mesh_list_reserve(&p->tube, s->n_curve, err);
    if (!st) st = sn_mesh_list_reserve(&p->balls, s->n_curve, err);
    for (int i = 0; i < s->n_curve && !st; i++) {
        const sn_picture_curve *c = &s->curve[i];
        sn_gl_mesh *tube = &p->tube.mesh[p->tube.n++], *balls = &p->balls.mesh[p->balls.n++];
        if (f->opt->show_curves && c->n_point > 1) st = send_tube(tube, c, f, err);
        if (!st && f->opt->show_points && c->n_control > 0) st = send_balls(balls, c, f, err);
    }
    return st ? st : sn_gl_check(&f->gl, "sending curves", err);
}

sn_status sn_line_pass_update(sn_line_pass *p, const sn_frame *f, sn_error *err)
{
    sn_key key = sn_frame_key(f, f->scene->stamp.curves, f->scene->stamp.curves);
    key.count[0] = f->scene->n_curve;
    key.count[1] = f->opt->show_curves;
    key.count[2] = f->opt->show_points;
    if (sn_key_same(&p->key, &key)) return SN_OK;
    p->key = (sn_key){0};
    sn_mesh_list_clear(&p->tube, &f->gl);
    sn_mesh_list_clear(&p->balls, &f->gl);
    sn_status st =
        p->program ? SN_OK
                   : sn_gl_program(&f->gl, "curve", sn_shader_line_vs, sn_shader_line_fs, &p->program, err);
    if (!st) st = send_lines(p, f, err);
    if (!st) p->key = key;
    return st;
}

static void draw_part(const sn_line_pass *p, const sn_frame *f, const sn_gl_mesh *m, double radius,
                      float pixels)
{
    const sn_gl *gl = &f->gl;
    gl->Uniform1f(gl->GetUniformLocation(p->program, "u_radius"), (float)(radius * f->unit));
    gl->Uniform1f(gl->GetUniformLocation(p->program, "u_pixels"), pixels * (float)f->samples);
    sn_gl_draw(gl, m, GL_TRIANGLES);
}

static void draw_lines(const sn_line_pass *p, const sn_frame *f, float grow, bool has_color)
{
    const sn_gl *gl = &f->gl;
    GLint color = gl->GetUniformLocation(p->program, "u_color");
    gl->Uniform1f(gl->GetUniformLocation(p->program, "u_grow"), grow * (float)f->samples);
    for (int i = 0; i < p->tube.n; i++) {
        sn_rgb c = f->scene->curve[i].color;
        if (has_color)
            gl->Uniform4f(color, c.r, c.g, c.b, 1.0f);
        else
            gl->Uniform4f(color, 0.16f * c.r, 0.16f * c.g, 0.16f * c.b, 0.0f);
        draw_part(p, f, &p->tube.mesh[i], tube_radius, tube_pixels);
        draw_part(p, f, &p->balls.mesh[i], ball_radius, ball_pixels);
    }
}

void sn_line_pass_draw(const sn_line_pass *p, const sn_frame *f)
{
    const sn_gl *gl = &f->gl;
    sn_frame_use(f, p->program);
    gl->Enable(GL_CLIP_DISTANCE0);
    gl->Enable(GL_CULL_FACE);
    gl->CullFace(GL_FRONT); /* the far side of a grown copy is seen only around the tube: its contour */
    draw_lines(p, f, contour_pixels, false);
    gl->CullFace(GL_BACK);
    draw_lines(p, f, 0.0f, true);
    gl->Disable(GL_CULL_FACE);
    gl->Disable(GL_CLIP_DISTANCE0);
}

void sn_line_pass_free(sn_line_pass *p)
{
    sn_mesh_list_clear(&p->tube, NULL);
    sn_mesh_list_clear(&p->balls, NULL);
    memset(p, 0, sizeof *p);
}
