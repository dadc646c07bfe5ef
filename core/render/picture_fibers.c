/* picture_fibers.c - thin lines by the thousand: each a strip that faces the eye and is shaded as the tube it
 * stands for. Two triangles a point instead of a dozen, and nothing is lost at a few pixels of width. */
#include "render/draw.h"

#include "base/alloc.h"
#include "render/shaders.h"

#include <string.h>

enum { batch_points = 65536, floats_per_vert = 9 };
static const double fiber_radius = 0.0008; /* of the scene's unit */
static const double shade_range = 0.4;
static const float fiber_pixels = 0.65f; /* least radius on the picture */

/* Vertices of a strip: a pair per point, a pair beyond each end, the first and the last once more so that
 * strips can be joined without a triangle between. */
static size_t strip_verts(const sn_picture_line *l)
{
    return l->n_point > 0 ? 2 * ((size_t)l->n_point + 2) + 2 : 0;
}

/* The line's own colour a little darker or lighter: by the golden ratio, so that neighbours in number differ.
 */
static float line_color(sn_rgb c, int32_t i_line)
{
    double u = 0.61803398874989485 * i_line;
    u -= (double)(int64_t)u;
    float to = u < 0.5 ? 0.0f : 1.0f, w = (float)(shade_range * fabs(u - 0.5));
    return sn_color_pack((sn_rgb){c.r + w * (to - c.r), c.g + w * (to - c.g), c.b + w * (to - c.b)});
}

static float *put_pair(float *at, const float place[3], const float along[3], float tip, float color)
{
    for (int side = -1; side <= 1; side += 2, at += floats_per_vert) {
        memcpy(at, place, 3 * sizeof *at);
        memcpy(at + 3, along, 3 * sizeof *at);
        at[6] = (float)side;
        at[7] = tip;
        at[8] = color;
    }
    return at;
}

/* Unit tangent at point i; 0 where the neighbours coincide, which the shader sees to. */
static void tangent_at(const sn_picture_line *l, int32_t i, float out[3])
{
    int32_t a = i > 0 ? i - 1 : 0, b = i + 1 < l->n_point ? i + 1 : i;
    sn_vec3 t =
        sn_v3_unit(sn_v3_sub(sn_v3_load(l->point + 3 * (size_t)b), sn_v3_load(l->point + 3 * (size_t)a)));
    out[0] = (float)t.x;
    out[1] = (float)t.y;
    out[2] = (float)t.z;
}

/* data: room for strip_verts of a line that has points. */
static void put_strip(float *data, const sn_frame *f, int32_t i_line)
{
    const sn_picture_line *l = &f->scene->fiber[i_line];
    float color = line_color(l->color, i_line), *at = data + floats_per_vert;
    for (int32_t i = 0; i < l->n_point; i++) {
        float place[3], along[3];
        sn_frame_place(f, sn_v3_load(l->point + 3 * (size_t)i), place);
        tangent_at(l, i, along);
        if (i == 0) at = put_pair(at, place, along, -1.0f, color);
        at = put_pair(at, place, along, 0.0f, color);
        if (i == l->n_point - 1) at = put_pair(at, place, along, 1.0f, color);
    }
    memcpy(data, data + floats_per_vert, floats_per_vert * sizeof *data);
    memcpy(at, at - floats_per_vert, floats_per_vert * sizeof *data);
}

/* The strips of the lines i0..i1 as one batch. */
static sn_status send_batch(sn_gl_mesh *out, const sn_frame *f, int32_t i0, int32_t i1, sn_error *err)
{
    const sn_picture_line *line = f->scene->fiber;
    sn_status st = SN_OK;
    size_t n_vert = 0, *first = SN_NEW(size_t, i1 - i0);
    for (int32_t i = i0; first && i < i1; i++) {
        first[i - i0] = n_vert;
        n_vert += strip_verts(&line[i]);
    }
    float *data = first ? SN_NEW(float, floats_per_vert *n_vert) : NULL;
    if (data) {
#pragma omp parallel for schedule(dynamic, 64) num_threads(sn_run_threads(f->run))
        for (int32_t i = i0; i < i1; i++)
            if (line[i].n_point > 0) put_strip(data + floats_per_vert * first[i - i0], f, i);
        *out = sn_gl_vertex_array(&f->gl, 3, data, n_vert);
        st = sn_gl_check(&f->gl, "sending fibers", err);
    } else {
        st = sn_fail(err, SN_ENOMEM, "picture: no memory to send %d fibers", i1 - i0);
    }
    sn_release(first);
    sn_release(data);
    return st;
}

/* The end of the batch that begins at i0: within batch_points, at least one line. */
static int32_t batch_end(const sn_picture_scene *s, int32_t i0)
{
    int64_t n = s->fiber[i0].n_point;
    int32_t i = i0 + 1;
    while (i < s->n_fiber && n + s->fiber[i].n_point <= batch_points) n += s->fiber[i++].n_point;
    return i;
}

static sn_status send_fibers(sn_fiber_pass *p, const sn_frame *f, sn_error *err)
{
    const sn_picture_scene *s = f->scene;
    int n = 0;
    for (int32_t i = 0; i < s->n_fiber; i = batch_end(s, i)) n++;
    sn_status st = sn_mesh_list_reserve(&p->batch, n, err);
    for (int32_t i = 0, end; i < s->n_fiber && !st; i = end) {
        end = batch_end(s, i);
        st = send_batch(&p->batch.mesh[p->batch.n++], f, i, end, err);
    }
    return st;
}

bool sn_fibers_are_solid(const sn_frame *f)
{
    return !(f->opt->show_muscles && f->scene->tets);
}

static sn_status need_program(sn_fiber_pass *p, const sn_frame *f, sn_error *err)
{
    bool is_solid = sn_fibers_are_solid(f);
    GLuint *program = is_solid ? &p->solid_program : &p->line_program;
    if (*program) return SN_OK;
    return sn_gl_program(&f->gl, "fiber", sn_shader_fiber_vs,
                         is_solid ? sn_shader_fiber_fs : sn_shader_fiber_line_fs, program, err);
}

sn_status sn_fiber_pass_update(sn_fiber_pass *p, const sn_frame *f, sn_error *err)
{
    sn_key key = sn_frame_key(f, f->scene->stamp.curves, f->scene->stamp.fields);
    key.count[0] = f->scene->n_fiber;
    sn_status st = need_program(p, f, err);
    if (st || sn_key_same(&p->key, &key)) return st;
    p->key = (sn_key){0};
    sn_mesh_list_clear(&p->batch, &f->gl);
    st = send_fibers(p, f, err);
    if (!st) p->key = key;
    return st;
}

void sn_fiber_pass_draw(const sn_fiber_pass *p, const sn_frame *f)
{
    const sn_gl *gl = &f->gl;
    GLuint program = sn_fibers_are_solid(f) ? p->solid_program : p->line_program;
    sn_frame_use(f, program);
    gl->Uniform1f(gl->GetUniformLocation(program, "u_radius"), (float)(fiber_radius * f->unit));
    gl->Uniform1f(gl->GetUniformLocation(program, "u_pixels"), fiber_pixels * (float)f->samples);
    gl->Enable(GL_CLIP_DISTANCE0);
    for (int i = 0; i < p->batch.n; i++) sn_gl_draw(gl, &p->batch.mesh[i], GL_TRIANGLE_STRIP);
    gl->Disable(GL_CLIP_DISTANCE0);
}

void sn_fiber_pass_free(sn_fiber_pass *p)
{
    sn_mesh_list_clear(&p->batch, NULL);
    memset(p, 0, sizeof *p);
}
