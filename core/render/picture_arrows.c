/* picture_arrows.c - arrows (axes, directions): a shaft and a cone, lit and with a dark contour as curves
 * are, in the same layer over the picture. */
#include "render/draw.h"

#include "base/alloc.h"
#include "render/shaders.h"

#include <string.h>

enum { n_side = 12, n_band = 4, floats_per_vert = 12, batch_arrows = 256 };
enum { arrow_floats = n_band * n_side * 6 * floats_per_vert };
static const double shaft_radius = 0.028, head_part = 0.34; /* of the arrow's length */
static const double head_width = 3.0, head_tilt = 0.24; /* of the shaft's; radians, of the cone's normal */
static const float arrow_pixels = 0.9f;                 /* least radius of the shaft on the picture */
static const float contour_pixels = 0.8f;

typedef struct circle { /* of the arrow's outline turned about its axis */
    double at, radius;  /* along the arrow, 0..1; in radii of the shaft */
} circle;

typedef struct arrow_axes {
    sn_vec3 from, along, t, u, v; /* along has the arrow's length; t, u, v are unit */
    float radius, color;
} arrow_axes;

static arrow_axes axes_of(const sn_picture_arrow *a)
{
    arrow_axes x = {.from = a->from, .along = a->along, .t = sn_v3_unit(a->along)};
    x.u = sn_v3_unit(sn_v3_cross(x.t, fabs(x.t.x) < 0.6 ? sn_v3(1, 0, 0) : sn_v3(0, 1, 0)));
    x.v = sn_v3_cross(x.t, x.u);
    x.radius = (float)(shaft_radius * sn_v3_len(a->along));
    x.color = sn_color_pack(a->color);
    return x;
}

static void put3(float *at, sn_vec3 v)
{
    at[0] = (float)v.x;
    at[1] = (float)v.y;
    at[2] = (float)v.z;
}

/* Corner k of a circle: its centre, the normal, the way out to the corner in radii of the shaft, and what the
 * arrow's corners share. tilt turns the normal from across to along. */
static float *put_corner(float *at, const sn_frame *f, const arrow_axes *x, const circle *c, double tilt,
                         int k)
{
    double a = 6.28318530717958648 * k / n_side;
    sn_vec3 across = sn_v3_add(sn_v3_scale(cos(a), x->u), sn_v3_scale(sin(a), x->v));
    sn_frame_place(f, sn_v3_mad(x->from, c->at, x->along), at);
    put3(at + 3, sn_v3_mad(sn_v3_scale(cos(tilt), across), sin(tilt), x->t));
    put3(at + 6, sn_v3_scale(c->radius, across));
    at[9] = x->radius;
    at[10] = x->color;
    at[11] = 0.0f;
    return at + floats_per_vert;
}

static void put_arrow(float *at, const sn_frame *f, const sn_picture_arrow *a)
{
    static const double back = -1.57079632679489662, neck = 1.0 - head_part;
    static const struct {
        circle from, to;
        double tilt;
    } band[n_band] = {{{0.0, 0.0}, {0.0, 1.0}, back},
                      {{0.0, 1.0}, {neck, 1.0}, 0.0},
                      {{neck, 1.0}, {neck, head_width}, back},
                      {{neck, head_width}, {1.0, 0.0}, head_tilt}};
    const arrow_axes x = axes_of(a);
    for (int b = 0; b < n_band; b++)
        for (int k = 0; k < n_side; k++) {
            at = put_corner(at, f, &x, &band[b].from, band[b].tilt, k);
            at = put_corner(at, f, &x, &band[b].from, band[b].tilt, k + 1);
            at = put_corner(at, f, &x, &band[b].to, band[b].tilt, k + 1);
            at = put_corner(at, f, &x, &band[b].from, band[b].tilt, k);
            at = put_corner(at, f, &x, &band[b].to, band[b].tilt, k + 1);
            at = put_corner(at, f, &x, &band[b].to, band[b].tilt, k);
        }
}

static sn_status send_arrows(sn_arrow_pass *p, const sn_frame *f, sn_error *err)
{
    const sn_picture_scene *s = f->scene;
    sn_status st = sn_mesh_list_reserve(&p->batch, (s->n_arrow + batch_arrows - 1) / batch_arrows, err);
    float *data = st ? NULL : SN_NEW(float, arrow_floats *batch_arrows);
    if (!st && !data) st = sn_fail(err, SN_ENOMEM, "picture: no memory for %d arrows", s->n_arrow);
    for (int32_t i = 0; i < s->n_arrow && !st; i += batch_arrows) {
        int32_t count = s->n_arrow - i < batch_arrows ? s->n_arrow - i : batch_arrows;
        for (int32_t k = 0; k < count; k++)
            put_arrow(data + (size_t)arrow_floats * (size_t)k, f, &s->arrow[i + k]);
        size_t n_vert = (size_t)count * (arrow_floats / floats_per_vert);
        p->batch.mesh[p->batch.n++] = sn_gl_vertex_array(&f->gl, 4, data, n_vert);
        st = sn_gl_check(&f->gl, "sending arrows", err);
    }
    sn_release(data);
    return st;
}

sn_status sn_arrow_pass_update(sn_arrow_pass *p, const sn_frame *f, sn_error *err)
{
    sn_key key = sn_frame_key(f, f->scene->stamp.curves, f->scene->stamp.curves);
    key.count[0] = f->scene->n_arrow;
    if (sn_key_same(&p->key, &key)) return SN_OK;
    p->key = (sn_key){0};
    sn_mesh_list_clear(&p->batch, &f->gl);
    sn_status st =
        p->program ? SN_OK
                   : sn_gl_program(&f->gl, "arrow", sn_shader_arrow_vs, sn_shader_arrow_fs, &p->program, err);
    if (!st) st = send_arrows(p, f, err);
    if (!st) p->key = key;
    return st;
}

static void draw_arrows(const sn_arrow_pass *p, const sn_frame *f, float grow, float is_lit)
{
    const sn_gl *gl = &f->gl;
    gl->Uniform1f(gl->GetUniformLocation(p->program, "u_grow"), grow * (float)f->samples);
    gl->Uniform1f(gl->GetUniformLocation(p->program, "u_is_lit"), is_lit);
    for (int i = 0; i < p->batch.n; i++) sn_gl_draw(gl, &p->batch.mesh[i], GL_TRIANGLES);
}

void sn_arrow_pass_draw(const sn_arrow_pass *p, const sn_frame *f)
{
    const sn_gl *gl = &f->gl;
    sn_frame_use(f, p->program);
    gl->Uniform1f(gl->GetUniformLocation(p->program, "u_pixels"), arrow_pixels * (float)f->samples);
    gl->Enable(GL_CLIP_DISTANCE0);
    gl->Enable(GL_CULL_FACE);
    gl->CullFace(GL_FRONT); /* the contour, as for curves */
    draw_arrows(p, f, contour_pixels, 0.0f);
    gl->CullFace(GL_BACK);
    draw_arrows(p, f, 0.0f, 1.0f);
    gl->Disable(GL_CULL_FACE);
    gl->Disable(GL_CLIP_DISTANCE0);
}

void sn_arrow_pass_free(sn_arrow_pass *p)
{
    sn_mesh_list_clear(&p->batch, NULL);
    memset(p, 0, sizeof *p);
}
