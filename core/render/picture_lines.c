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

static sn_status send_tube(sn_line *line, const sn_picture_curve *c, const sn_frame *f, sn_error *err)
{
    size_t n_band = (size_t)c->n_point + 5;
    float *data = SN_NEW(float, 36 * n_side * n_band);
    sn_vec3 *p = SN_NEW(sn_vec3, c->n_point);
    sn_status st = SN_OK;
    if (data && p) {
        int32_t n = distinct_points(c, 1e-7 * f->unit, p);
        line->n_tube = n > 1 ? (GLsizei)put_tube(data, f, p, n) : 0;
        if (line->n_tube > 0) line->tube = sn_gl_vertex_array(&f->gl, 2, data, (size_t)line->n_tube);
    } else {
        st = sn_fail(err, SN_ENOMEM, "picture: no memory for a curve of %d points", c->n_point);
    }
    sn_release(data);
    sn_release(p);
    return st;
}

static sn_status send_balls(sn_line *line, const sn_picture_curve *c, const sn_frame *f, sn_error *err)
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
    line->balls = sn_gl_vertex_array(&f->gl, 2, data, n);
    line->n_balls = (GLsizei)n;
    sn_release(data);
    return SN_OK;
}

sn_status sn_line_pass_prepare(sn_line_pass *p, const sn_frame *f, sn_error *err)
{
    const sn_picture_scene *s = f->scene;
    sn_status st = sn_gl_program(&f->gl, "curve", sn_shader_line_vs, sn_shader_line_fs, &p->program, err);
    if (st) return st;
    p->line = SN_NEW_ZERO(sn_line, s->n_curve);
    if (!p->line) return sn_fail(err, SN_ENOMEM, "picture: no memory for %d curves", s->n_curve);
    p->n_line = s->n_curve;
    for (int i = 0; i < s->n_curve && !st; i++) {
        const sn_picture_curve *c = &s->curve[i];
        if (f->opt->show_curves && c->n_point > 1) st = send_tube(&p->line[i], c, f, err);
        if (!st && f->opt->show_points && c->n_control > 0) st = send_balls(&p->line[i], c, f, err);
    }
    return st ? st : sn_gl_check(&f->gl, "sending curves", err);
}

static void draw_part(const sn_line_pass *p, const sn_frame *f, GLuint array, GLsizei n, double radius,
                      float pixels)
{
    const sn_gl *gl = &f->gl;
    if (n == 0) return;
    gl->Uniform1f(gl->GetUniformLocation(p->program, "u_radius"), (float)(radius * f->unit));
    gl->Uniform1f(gl->GetUniformLocation(p->program, "u_pixels"), pixels * (float)f->samples);
    gl->BindVertexArray(array);
    gl->DrawArrays(GL_TRIANGLES, 0, n);
}

static void draw_lines(const sn_line_pass *p, const sn_frame *f, float grow, bool has_color)
{
    const sn_gl *gl = &f->gl;
    GLint color = gl->GetUniformLocation(p->program, "u_color");
    gl->Uniform1f(gl->GetUniformLocation(p->program, "u_grow"), grow * (float)f->samples);
    for (int i = 0; i < p->n_line; i++) {
        sn_rgb c = f->scene->curve[i].color;
        if (has_color)
            gl->Uniform4f(color, c.r, c.g, c.b, 1.0f);
        else
            gl->Uniform4f(color, 0.16f * c.r, 0.16f * c.g, 0.16f * c.b, 0.0f);
        draw_part(p, f, p->line[i].tube, p->line[i].n_tube, tube_radius, tube_pixels);
        draw_part(p, f, p->line[i].balls, p->line[i].n_balls, ball_radius, ball_pixels);
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
    sn_release(p->line);
    memset(p, 0, sizeof *p);
}
