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

typedef struct solid_vertex { /* 20 bytes */
    float place[3];
    int16_t normal[4]; /* of length 32767; 0 */
} solid_vertex;

/* Corners of one vertex with one normal share what is sent of it. Returns how many vertices there are. first:
 * per vertex of the mesh the last of those made for it, -1 for none; next: the one made before. */
static uint32_t share_corners(const sn_tri_mesh *m, const sn_frame *f, const float *normal, int32_t *first,
                              int32_t *next, solid_vertex *out, uint32_t *index)
{
    int32_t n = 0;
    for (int32_t v = 0; v < m->n_vert; v++) first[v] = -1;
    for (size_t c = 0; c < 3 * (size_t)m->n_face; c++) {
        int32_t v = m->face[c], at = first[v];
        solid_vertex own = {.normal = {0}};
        sn_frame_place(f, sn_tri_mesh_point(m, v), own.place);
        for (int k = 0; k < 3; k++) own.normal[k] = (int16_t)lrintf(32767.0f * normal[3 * c + (size_t)k]);
        while (at >= 0 && memcmp(out[at].normal, own.normal, sizeof own.normal) != 0) at = next[at];
        if (at < 0) {
            at = n++;
            out[at] = own;
            next[at] = first[v];
            first[v] = at;
        }
        index[c] = (uint32_t)at;
    }
    return (uint32_t)n;
}

static sn_gl_mesh send_vertices(const sn_gl *gl, const solid_vertex *vert, size_t n_vert,
                                const uint32_t *index, size_t n_index)
{
    sn_gl_mesh m = {.n = (GLsizei)n_index};
    gl->GenVertexArrays(1, &m.array);
    gl->BindVertexArray(m.array);
    m.buffer = sn_gl_buffer(gl, GL_ARRAY_BUFFER, vert, n_vert * sizeof *vert);
    sn_gl_attribute(gl, 0, 3, GL_FLOAT, false, sizeof *vert, offsetof(solid_vertex, place));
    sn_gl_attribute(gl, 1, 3, GL_SHORT, true, sizeof *vert, offsetof(solid_vertex, normal));
    m.index = sn_gl_buffer(gl, GL_ELEMENT_ARRAY_BUFFER, index, n_index * sizeof *index);
    return m;
}

static sn_status send_mesh(sn_gl_mesh *out, const sn_tri_mesh *m, double crease_deg, const sn_frame *f,
                           sn_error *err)
{
    size_t n = 3 * (size_t)m->n_face;
    float *normal = SN_NEW(float, 3 * n);
    solid_vertex *vert = SN_NEW(solid_vertex, n);
    uint32_t *index = SN_NEW(uint32_t, n);
    int32_t *first = SN_NEW(int32_t, m->n_vert), *next = SN_NEW(int32_t, n);
    sn_status st = normal && vert && index && first && next
                       ? sn_corner_normals(m, crease_deg, f->run, normal, err)
                       : sn_fail(err, SN_ENOMEM, "picture: no memory for %d faces", m->n_face);
    if (!st) {
        uint32_t n_vert = share_corners(m, f, normal, first, next, vert, index);
        *out = send_vertices(&f->gl, vert, n_vert, index, n);
        st = sn_gl_check(&f->gl, "sending surfaces", err);
    }
    sn_release(normal);
    sn_release(vert);
    sn_release(index);
    sn_release(first);
    sn_release(next);
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
static void send_cap(sn_gl_mesh *cap, const sn_tri_mesh *m, const sn_frame *f)
{
    sn_box3 box = sn_tri_mesh_bounds(m);
    double r = 0.5 * sn_box3_diagonal(box);
    sn_vec3 mid = sn_v3_lerp(box.min, box.max, 0.5), n = f->plane_normal;
    double h = sn_frame_removed(f, mid);
    if (fabs(h) > r) return;
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
    *cap = sn_gl_vertex_array(&f->gl, 2, data, 4);
}

static sn_status send_bones(sn_surface_pass *p, const sn_frame *f, sn_error *err)
{
    const sn_picture_scene *s = f->scene;
    sn_release(p->is_closed);
    p->is_closed = SN_NEW(bool, s->n_bone);
    if (!p->is_closed) return sn_fail(err, SN_ENOMEM, "picture: no memory for %d bones", s->n_bone);
    sn_status st = sn_mesh_list_reserve(&p->bone, s->n_bone, err);
    for (int i = 0; i < s->n_bone && !st; i++) {
        p->is_closed[i] = is_closed(s->bone[i]);
        st = send_mesh(&p->bone.mesh[p->bone.n++], s->bone[i], bone_crease_deg, f, err);
    }
    return st;
}

static sn_status update_bones(sn_surface_pass *p, const sn_frame *f, sn_error *err)
{
    sn_key key = sn_frame_key(f, f->scene->stamp.shapes, f->scene->stamp.shapes);
    sn_clip_key clip = sn_frame_clip_key(f);
    key.count[0] = f->scene->n_bone;
    bool is_same = sn_key_same(&p->bone_key, &key);
    if (is_same && sn_clip_key_same(&p->clip, &clip)) return SN_OK;
    sn_status st = SN_OK;
    sn_mesh_list_clear(&p->cap, &f->gl);
    p->bone_key = (sn_key){0};
    if (!is_same) {
        sn_mesh_list_clear(&p->bone, &f->gl);
        st = send_bones(p, f, err);
    }
    if (!st) st = sn_mesh_list_reserve(&p->cap, f->scene->n_bone, err);
    for (int i = 0; i < f->scene->n_bone && !st; i++) {
        sn_gl_mesh *cap = &p->cap.mesh[p->cap.n++];
        if (clip.has_section && p->is_closed[i]) send_cap(cap, f->scene->bone[i], f);
    }
    if (!st) p->bone_key = key;
    p->clip = clip;
    return st;
}

static sn_status update_skin(sn_surface_pass *p, const sn_frame *f, sn_error *err)
{
    sn_key key = sn_frame_key(f, f->scene->stamp.shapes, f->scene->stamp.shapes);
    if (sn_key_same(&p->skin_key, &key)) return SN_OK;
    p->skin_key = (sn_key){0};
    sn_gl_delete_mesh(&f->gl, &p->skin);
    sn_status st = send_mesh(&p->skin, f->scene->skin, skin_crease_deg, f, err);
    if (!st) p->skin_key = key;
    return st;
}

sn_status sn_surface_pass_update(sn_surface_pass *p, const sn_frame *f, sn_error *err)
{
    sn_status st = SN_OK;
    if (!p->solid_program)
        st = sn_gl_program(&f->gl, "bone", sn_shader_solid_vs, sn_shader_solid_fs, &p->solid_program, err);
    if (!st && !p->skin_program)
        st = sn_gl_program(&f->gl, "skin", sn_shader_solid_vs, sn_shader_skin_fs, &p->skin_program, err);
    if (!st && f->opt->show_bones && f->scene->n_bone > 0) st = update_bones(p, f, err);
    if (!st && f->opt->show_skin && f->scene->skin) st = update_skin(p, f, err);
    return st;
}

static void set_color(const sn_frame *f, GLuint program, sn_rgb c, float a)
{
    float rgb[3];
    sn_color_linear(c, rgb);
    f->gl.Uniform4f(f->gl.GetUniformLocation(program, "u_color"), rgb[0], rgb[1], rgb[2], a);
}

static void draw_solid(const sn_surface_pass *p, const sn_frame *f, const sn_gl_mesh *m, GLenum shape,
                       float kind, float is_section)
{
    const sn_gl *gl = &f->gl;
    gl->Uniform1f(gl->GetUniformLocation(p->solid_program, "u_kind"), kind);
    gl->Uniform1f(gl->GetUniformLocation(p->solid_program, "u_is_section"), is_section);
    sn_gl_draw(gl, m, shape);
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
    draw_solid(p, f, &p->bone.mesh[i_bone], GL_TRIANGLES, kind, 0.0f);
    gl->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl->DepthMask(GL_TRUE);
    gl->DepthFunc(GL_LEQUAL);
    gl->StencilFunc(GL_NOTEQUAL, 0, 0xff);
    gl->StencilOp(GL_ZERO, GL_ZERO, GL_ZERO);
    gl->Enable(GL_POLYGON_OFFSET_FILL);
    gl->PolygonOffset(-2.0f, -16.0f); /* over the section of the tets, should both be there */
    set_color(f, p->solid_program, bone_cut_color, 0.0f);
    draw_solid(p, f, &p->cap.mesh[i_bone], GL_TRIANGLE_STRIP, -kind, 1.0f);
    gl->Disable(GL_POLYGON_OFFSET_FILL);
    gl->Disable(GL_STENCIL_TEST);
}

void sn_surface_pass_bones(const sn_surface_pass *p, const sn_frame *f)
{
    if (!f->opt->show_bones || f->scene->n_bone == 0) return;
    sn_frame_use(f, p->solid_program);
    f->gl.Enable(GL_CLIP_DISTANCE0);
    for (int i = 0; i < p->bone.n; i++) {
        float kind = (float)(1 + i % 511);
        set_color(f, p->solid_program, bone_color, 0.35f);
        draw_solid(p, f, &p->bone.mesh[i], GL_TRIANGLES, kind, 0.0f);
        if (p->cap.mesh[i].n > 0) draw_cap(p, f, i, kind);
    }
    f->gl.Disable(GL_CLIP_DISTANCE0);
}

void sn_surface_pass_skin(const sn_surface_pass *p, const sn_frame *f)
{
    const sn_gl *gl = &f->gl;
    sn_frame_use(f, p->skin_program);
    set_color(f, p->skin_program, skin_color, (float)f->opt->skin_opacity);
    gl->Enable(GL_CLIP_DISTANCE0);
    gl->DepthMask(GL_FALSE);
    gl->Enable(GL_BLEND);
    gl->BlendFuncSeparate(GL_ONE, GL_ONE, GL_ZERO, GL_ONE_MINUS_SRC_ALPHA);
    gl->Enable(GL_POLYGON_OFFSET_FILL);
    gl->PolygonOffset(-2.0f, -16.0f); /* in front of muscles that touch it */
    sn_gl_draw(gl, &p->skin, GL_TRIANGLES);
    gl->Disable(GL_POLYGON_OFFSET_FILL);
    gl->Disable(GL_BLEND);
    gl->DepthMask(GL_TRUE);
    gl->Disable(GL_CLIP_DISTANCE0);
}

void sn_surface_pass_free(sn_surface_pass *p)
{
    sn_mesh_list_clear(&p->bone, NULL);
    sn_mesh_list_clear(&p->cap, NULL);
    sn_release(p->is_closed);
    memset(p, 0, sizeof *p);
}
