/* picture_surfaces.c - bones (opaque, capped where the clip plane cuts them) and the translucent skin. */
#include "render/draw.h"

#include "base/alloc.h"
#include "render/shaders.h"

#include <string.h>

static const double bone_crease_deg = 55.0, skin_crease_deg = 80.0;
static const sn_rgb bone_color = {0.925f, 0.880f, 0.770f}; /* ivory */
static const sn_rgb bone_cut_color = {0.870f, 0.800f, 0.660f};
static const sn_rgb skin_color = {0.900f, 0.690f, 0.580f};
static const double closed_rel =
    1e-6; /* of the area: what the area vectors of a closed surface may add up to */

typedef struct corner_fan { /* corners (3 face + k) around each vertex, in index order */
    int32_t *first, *corner;
    sn_vec3 *unit; /* face normals of length 1 */
    double *angle; /* at each corner */
} corner_fan;

static void fan_free(corner_fan *c)
{
    sn_release(c->first);
    sn_release(c->corner);
    sn_release(c->unit);
    sn_release(c->angle);
}

static double corner_angle(const sn_tri_mesh *m, const int32_t *f, int k)
{
    sn_vec3 a = sn_tri_mesh_point(m, f[k]);
    sn_vec3 u = sn_v3_sub(sn_tri_mesh_point(m, f[(k + 1) % 3]), a),
            v = sn_v3_sub(sn_tri_mesh_point(m, f[(k + 2) % 3]), a);
    return atan2(sn_v3_len(sn_v3_cross(u, v)), sn_v3_dot(u, v));
}

static sn_status fan_init(corner_fan *c, const sn_tri_mesh *m, const sn_run *run, sn_error *err)
{
    size_t n_corner = 3 * (size_t)m->n_face;
    c->first = SN_NEW_ZERO(int32_t, (size_t)m->n_vert + 2);
    c->corner = SN_NEW(int32_t, n_corner);
    c->unit = SN_NEW(sn_vec3, m->n_face);
    c->angle = SN_NEW(double, n_corner);
    if (!c->first || !c->corner || !c->unit || !c->angle)
        return sn_fail(err, SN_ENOMEM, "picture: no memory for the normals of %d faces", m->n_face);
    /* Counts go two places up, so that filling moves the starts into place. */
    for (size_t i = 0; i < n_corner; i++) c->first[m->face[i] + 2]++;
    for (int32_t v = 0; v < m->n_vert; v++) c->first[v + 2] += c->first[v + 1];
    for (size_t i = 0; i < n_corner; i++) c->corner[c->first[m->face[i] + 1]++] = (int32_t)i;
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(run))
    for (int32_t i = 0; i < m->n_face; i++) {
        c->unit[i] = sn_v3_unit(sn_tri_mesh_face_normal(m, i));
        for (int k = 0; k < 3; k++)
            c->angle[3 * (size_t)i + (size_t)k] = corner_angle(m, m->face + 3 * (size_t)i, k);
    }
    return SN_OK;
}

sn_status sn_corner_normals(const sn_tri_mesh *m, double crease_deg, const sn_run *run, float *out,
                            sn_error *err)
{
    corner_fan c = {0};
    sn_status st = fan_init(&c, m, run, err);
    double least = cos(crease_deg * (3.14159265358979323846 / 180.0));
    if (st) goto done;
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(run))
    for (int32_t i = 0; i < 3 * m->n_face; i++) {
        sn_vec3 own = c.unit[i / 3], sum = {0};
        int32_t v = m->face[i];
        for (int32_t a = c.first[v]; a < c.first[v + 1]; a++) {
            sn_vec3 other = c.unit[c.corner[a] / 3];
            if (sn_v3_dot(own, other) >= least) sum = sn_v3_mad(sum, c.angle[c.corner[a]], other);
        }
        sum = sn_v3_len2(sum) > 0.0 ? sn_v3_unit(sum) : own;
        out[3 * (size_t)i] = (float)sum.x;
        out[3 * (size_t)i + 1] = (float)sum.y;
        out[3 * (size_t)i + 2] = (float)sum.z;
    }
done:
    fan_free(&c);
    return st;
}

static sn_status send_mesh(sn_solid *s, const sn_tri_mesh *m, double crease_deg, const sn_frame *f,
                           sn_error *err)
{
    size_t n = 3 * (size_t)m->n_face;
    float *normal = SN_NEW(float, 3 * n), *data = SN_NEW(float, 6 * n);
    sn_status st = normal && data ? sn_corner_normals(m, crease_deg, f->run, normal, err)
                                  : sn_fail(err, SN_ENOMEM, "picture: no memory for %d faces", m->n_face);
    if (st) goto done;
    for (size_t i = 0; i < n; i++) {
        sn_frame_place(f, sn_tri_mesh_point(m, m->face[i]), data + 6 * i);
        memcpy(data + 6 * i + 3, normal + 3 * i, 3 * sizeof *data);
    }
    s->array = sn_gl_vertex_array(&f->gl, 2, data, n);
    s->n_vert = (GLsizei)n;
    st = sn_gl_check(&f->gl, "sending surfaces", err);
done:
    sn_release(normal);
    sn_release(data);
    return st;
}

/* The area vectors of a closed surface add up to 0; that is enough to tell a cap that makes sense from one
 * that would spill over the picture. */
static bool is_closed(const sn_tri_mesh *m)
{
    sn_vec3 sum = {0};
    double area = 0.0;
    for (int32_t i = 0; i < m->n_face; i++) {
        sn_vec3 n = sn_tri_mesh_face_normal(m, i);
        sum = sn_v3_add(sum, n);
        area += sn_v3_len(n);
    }
    return sn_v3_len(sum) <= closed_rel * area;
}

/* A square in the clip plane that holds the cut of the bone; none when the plane misses the bone's ball. */
static void send_cap(sn_solid *s, const sn_tri_mesh *m, const sn_frame *f)
{
    sn_box3 box = sn_tri_mesh_bounds(m);
    double r = 0.5 * sn_box3_diagonal(box);
    sn_vec3 mid = sn_v3_lerp(box.min, box.max, 0.5), n = f->plane_normal;
    double h = sn_frame_removed(f, mid);
    if (fabs(h) > r || !is_closed(m)) return;
    sn_vec3 at = sn_v3_mad(mid, -h, n);
    sn_vec3 u = sn_v3_unit(sn_v3_cross(n, fabs(n.x) < 0.6 ? sn_v3(1, 0, 0) : sn_v3(0, 1, 0))),
            v = sn_v3_cross(n, u);
    static const double side[4][2] = {{-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
    float data[24];
    for (int k = 0; k < 4; k++) {
        sn_frame_place(f, sn_v3_mad(sn_v3_mad(at, 1.01 * r * side[k][0], u), 1.01 * r * side[k][1], v),
                       data + 6 * k);
        data[6 * k + 3] = (float)n.x;
        data[6 * k + 4] = (float)n.y;
        data[6 * k + 5] = (float)n.z;
    }
    s->cap = sn_gl_vertex_array(&f->gl, 2, data, 4);
}

sn_status sn_surface_pass_prepare(sn_surface_pass *p, const sn_frame *f, sn_error *err)
{
    const sn_picture_scene *s = f->scene;
    sn_status st =
        sn_gl_program(&f->gl, "bone", sn_shader_solid_vs, sn_shader_solid_fs, &p->solid_program, err);
    if (!st) st = sn_gl_program(&f->gl, "skin", sn_shader_solid_vs, sn_shader_skin_fs, &p->skin_program, err);
    if (st) return st;
    p->n_bone = f->opt->show_bones ? s->n_bone : 0;
    p->bone = SN_NEW_ZERO(sn_solid, p->n_bone);
    if (!p->bone) return sn_fail(err, SN_ENOMEM, "picture: no memory for %d bones", p->n_bone);
    for (int i = 0; i < p->n_bone && !st; i++) {
        st = send_mesh(&p->bone[i], s->bone[i], bone_crease_deg, f, err);
        if (!st && f->has_section) send_cap(&p->bone[i], s->bone[i], f);
    }
    if (!st && f->opt->show_skin && s->skin) st = send_mesh(&p->skin, s->skin, skin_crease_deg, f, err);
    return st;
}

static void set_color(const sn_frame *f, GLuint program, sn_rgb c, float a)
{
    f->gl.Uniform4f(f->gl.GetUniformLocation(program, "u_color"), c.r, c.g, c.b, a);
}

static void draw_solid(const sn_surface_pass *p, const sn_frame *f, GLuint array, GLenum shape, GLsizei n,
                       float kind, float is_section)
{
    const sn_gl *gl = &f->gl;
    gl->Uniform1f(gl->GetUniformLocation(p->solid_program, "u_kind"), kind);
    gl->Uniform1f(gl->GetUniformLocation(p->solid_program, "u_is_section"), is_section);
    gl->BindVertexArray(array);
    gl->DrawArrays(shape, 0, n);
}

/* The stencil counts, behind the clip plane, back faces minus front faces: not 0 where the ray meets the
 * plane inside the bone. There the cap is painted, which sets the stencil back to 0. */
static void draw_cap(const sn_surface_pass *p, const sn_frame *f, int i_bone, float kind)
{
    const sn_gl *gl = &f->gl;
    gl->Enable(GL_STENCIL_TEST);
    gl->StencilFunc(GL_ALWAYS, 0, 0xff);
    gl->StencilOpSeparate(GL_BACK, GL_KEEP, GL_KEEP, GL_INCR_WRAP);
    gl->StencilOpSeparate(GL_FRONT, GL_KEEP, GL_KEEP, GL_DECR_WRAP);
    gl->ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    gl->DepthMask(GL_FALSE);
    gl->DepthFunc(GL_ALWAYS);
    draw_solid(p, f, p->bone[i_bone].array, GL_TRIANGLES, p->bone[i_bone].n_vert, kind, 0.0f);
    gl->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl->DepthMask(GL_TRUE);
    gl->DepthFunc(GL_LEQUAL);
    gl->StencilFunc(GL_NOTEQUAL, 0, 0xff);
    gl->StencilOp(GL_ZERO, GL_ZERO, GL_ZERO);
    gl->Enable(GL_POLYGON_OFFSET_FILL);
    gl->PolygonOffset(-2.0f, -16.0f); /* over the section of the tets, should both be there */
    set_color(f, p->solid_program, bone_cut_color, 0.0f);
    draw_solid(p, f, p->bone[i_bone].cap, GL_TRIANGLE_STRIP, 4, -kind, 1.0f);
    gl->Disable(GL_POLYGON_OFFSET_FILL);
    gl->Disable(GL_STENCIL_TEST);
}

void sn_surface_pass_bones(const sn_surface_pass *p, const sn_frame *f)
{
    if (p->n_bone == 0) return;
    sn_frame_use(f, p->solid_program);
    f->gl.Enable(GL_CLIP_DISTANCE0);
    for (int i = 0; i < p->n_bone; i++) {
        float kind = (float)(1 + i % 511);
        set_color(f, p->solid_program, bone_color, 0.35f);
        draw_solid(p, f, p->bone[i].array, GL_TRIANGLES, p->bone[i].n_vert, kind, 0.0f);
        if (p->bone[i].cap) draw_cap(p, f, i, kind);
    }
    f->gl.Disable(GL_CLIP_DISTANCE0);
}

void sn_surface_pass_skin(const sn_surface_pass *p, const sn_frame *f)
{
    const sn_gl *gl = &f->gl;
    if (!p->skin.array) return;
    sn_frame_use(f, p->skin_program);
    set_color(f, p->skin_program, skin_color, (float)f->opt->skin_opacity);
    gl->Enable(GL_CLIP_DISTANCE0);
    gl->DepthMask(GL_FALSE);
    gl->Enable(GL_BLEND);
    gl->BlendFuncSeparate(GL_ONE, GL_ONE, GL_ZERO, GL_ONE_MINUS_SRC_ALPHA);
    gl->Enable(GL_POLYGON_OFFSET_FILL);
    gl->PolygonOffset(-2.0f, -16.0f); /* in front of muscles that touch it */
    gl->BindVertexArray(p->skin.array);
    gl->DrawArrays(GL_TRIANGLES, 0, p->skin.n_vert);
    gl->Disable(GL_POLYGON_OFFSET_FILL);
    gl->Disable(GL_BLEND);
    gl->DepthMask(GL_TRUE);
    gl->Disable(GL_CLIP_DISTANCE0);
}

void sn_surface_pass_free(sn_surface_pass *p)
{
    sn_release(p->bone);
    memset(p, 0, sizeof *p);
}
