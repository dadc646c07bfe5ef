/* picture_cuts.c - the section: where the clip plane cuts the tets, flat pieces coloured by the tissue that
 * wins. */
#include "render/draw.h"

#include "base/alloc.h"
#include "render/muscle_tets.h"
#include "render/shaders.h"

#include <string.h>

static const sn_rgb fat_color = {0.965f, 0.925f, 0.780f}; /* pale cream */

typedef struct sn_muscle_section { /* what one batch has sent */
    sn_gl_mesh mesh;
    sn_gl_texels face, cand;
} sn_muscle_section;

typedef struct pieces { /* triangles waiting to be sent */
    float *corner;      /* 27 per triangle: place, normal; number of the corner, triangle, 0 */
    float *face;        /* 4 per triangle: first texel, number of candidates */
    float *cand;        /* 4 per candidate: g at the corners, muscle; with tendons 4 more: theirs, 0 */
    size_t corner_cap, face_cap, cand_cap, n_face, n_texel;
} pieces;

static void pieces_free(pieces *p)
{
    sn_release(p->corner);
    sn_release(p->face);
    sn_release(p->cand);
}

static sn_status pieces_send(pieces *p, sn_muscle_pass *pass, const sn_frame *f, sn_error *err)
{
    if (p->n_face == 0) return SN_OK;
    sn_muscle_section *more = sn_realloc(pass->section, (size_t)pass->n_section + 1, sizeof *more);
    float none[4] = {0};
    if (!more) return sn_fail(err, SN_ENOMEM, "picture: no memory for %d batches", pass->n_section + 1);
    pass->section = more;
    sn_muscle_section *b = &more[pass->n_section++];
    b->mesh = sn_gl_vertex_array(&f->gl, 3, p->corner, 3 * p->n_face);
    b->face = sn_gl_buffer_texture(&f->gl, GL_RGBA32F, p->face, 4 * p->n_face * sizeof(float));
    b->cand = p->n_texel > 0
                  ? sn_gl_buffer_texture(&f->gl, GL_RGBA32F, p->cand, 4 * p->n_texel * sizeof(float))
                  : sn_gl_buffer_texture(&f->gl, GL_RGBA32F, none, sizeof none);
    p->n_face = p->n_texel = 0;
    return sn_gl_check(&f->gl, "sending sections", err);
}

typedef struct cut_corner { /* a point on the edge a-b (or the vertex a = b) of the tet mesh */
    sn_vec3 place, normal;
    int32_t a, b;
    double at; /* 0 at a, 1 at b */
} cut_corner;

static double value_at(const sn_picture_scene *s, int32_t i_muscle, const cut_corner *c)
{
    double ga = sn_muscle_above_fat(s, i_muscle, c->a);
    return c->a == c->b ? ga : ga + c->at * (sn_muscle_above_fat(s, i_muscle, c->b) - ga);
}

static float tendon_at(const sn_picture_scene *s, int32_t i_muscle, const cut_corner *c)
{
    double a = sn_muscle_tendon(s, i_muscle, c->a);
    return (float)(c->a == c->b ? a : a + c->at * (sn_muscle_tendon(s, i_muscle, c->b) - a));
}

/* Adds a triangle with n muscles; sends what waits when the texels of one buffer are used up. */
static sn_status pieces_add(pieces *p, const sn_frame *f, const cut_corner c[3], const int32_t *muscle,
                            int32_t n, sn_error *err)
{
    bool has_tendon = f->scene->tendon != NULL;
    if (!sn_grow(&p->corner, &p->corner_cap, 27 * (p->n_face + 1), sizeof(float)) ||
        !sn_grow(&p->face, &p->face_cap, 4 * (p->n_face + 1), sizeof(float)) ||
        !sn_grow(&p->cand, &p->cand_cap, 4 * (p->n_texel + 2 * (size_t)n), sizeof(float)))
        return sn_fail(err, SN_ENOMEM, "picture: no memory for %zu section triangles", p->n_face + 1);
    for (int k = 0; k < 3; k++) {
        float *q = p->corner + 27 * p->n_face + 9 * k;
        sn_frame_place(f, c[k].place, q);
        q[3] = (float)c[k].normal.x;
        q[4] = (float)c[k].normal.y;
        q[5] = (float)c[k].normal.z;
        q[6] = (float)k;
        q[7] = (float)p->n_face;
        q[8] = 0.0f;
    }
    float *face = p->face + 4 * p->n_face++;
    face[0] = (float)p->n_texel;
    face[1] = (float)n;
    face[2] = face[3] = 0.0f;
    for (int32_t i = 0; i < n; i++) {
        float *g = p->cand + 4 * p->n_texel++;
        for (int k = 0; k < 3; k++) g[k] = (float)value_at(f->scene, muscle[i], &c[k]);
        g[3] = (float)muscle[i];
        if (!has_tendon) continue;
        float *t = p->cand + 4 * p->n_texel++;
        for (int k = 0; k < 3; k++) t[k] = tendon_at(f->scene, muscle[i], &c[k]);
        t[3] = 0.0f;
    }
    return SN_OK;
}

static bool pieces_full(const pieces *p, int32_t room, int32_t max_texels)
{
    return p->n_face + 2 > (size_t)max_texels || p->n_texel + 4 * (size_t)room > (size_t)max_texels;
}

/* The point of the plane on the edge between a kept and a removed vertex, the same from every tet around the
 * edge. */
static cut_corner cross_edge(const sn_frame *f, const double *height, int32_t a, int32_t b)
{
    if (a > b) {
        int32_t swap = a;
        a = b;
        b = swap;
    }
    cut_corner c = {.a = a, .b = b, .normal = f->plane_normal, .at = height[a] / (height[a] - height[b])};
    c.place = sn_v3_lerp(sn_tet_mesh_point(f->scene->tets, a), sn_tet_mesh_point(f->scene->tets, b), c.at);
    return c;
}

/* The polygon of one tet, corners in turn; returns 0, 3 or 4. A vertex in the plane counts as removed, so
 * that a face in the plane belongs to the tet that is kept. */
static int cut_tet(const sn_frame *f, const double *height, const int32_t v[4], cut_corner out[4])
{
    int32_t kept[4], removed[4];
    int n_kept = 0, n_removed = 0;
    for (int k = 0; k < 4; k++)
        if (height[v[k]] < 0.0)
            kept[n_kept++] = v[k];
        else
            removed[n_removed++] = v[k];
    if (n_kept == 0 || n_removed == 0) return 0;
    if (n_kept == 2) {
        for (int k = 0; k < 4; k++) out[k] = cross_edge(f, height, kept[k >> 1], removed[(k ^ (k >> 1)) & 1]);
        return 4;
    }
    for (int k = 0; k < 3; k++)
        out[k] = n_kept == 1 ? cross_edge(f, height, kept[0], removed[k])
                             : cross_edge(f, height, kept[k], removed[0]);
    return 3;
}

static double *plane_heights(const sn_frame *f)
{
    const sn_tet_mesh *mesh = f->scene->tets;
    double *height = SN_NEW(double, mesh->n_vert);
    if (!height) return NULL;
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(f->run))
    for (int32_t v = 0; v < mesh->n_vert; v++) height[v] = sn_frame_removed(f, sn_tet_mesh_point(mesh, v));
    return height;
}

static sn_status send_section(sn_muscle_pass *p, const sn_frame *f, const sn_muscle_tets *m,
                              int32_t max_texels, sn_error *err)
{
    const sn_tet_mesh *mesh = f->scene->tets;
    int32_t *muscle = SN_NEW(int32_t, f->scene->n_tissue);
    double *height = plane_heights(f);
    pieces wait = {0};
    sn_status st = SN_OK;
    if (!muscle || !height)
        st = sn_fail(err, SN_ENOMEM, "picture: no memory to cut %d vertices", mesh->n_vert);
    for (int32_t t = 0; t < mesh->n_tet && !st; t++) {
        const int32_t *v = mesh->tet + 4 * (size_t)t;
        cut_corner c[4];
        int n_corner = cut_tet(f, height, v, c);
        if (n_corner == 0) continue;
        int32_t n = sn_muscle_lists_merge(&m->above, v, 4, muscle);
        if (pieces_full(&wait, n, max_texels)) st = pieces_send(&wait, p, f, err);
        if (!st) st = pieces_add(&wait, f, c, muscle, n, err);
        c[1] = c[0];
        if (!st && n_corner == 4) st = pieces_add(&wait, f, c + 1, muscle, n, err);
    }
    if (!st) st = pieces_send(&wait, p, f, err);
    pieces_free(&wait);
    sn_release(muscle);
    sn_release(height);
    return st;
}

sn_status sn_cut_update(sn_muscle_pass *p, const sn_frame *f, const sn_muscle_tets *m, sn_error *err)
{
    GLint max_texels = 0;
    f->gl.GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &max_texels);
    if (max_texels > 1 << 24) max_texels = 1 << 24; /* texel numbers travel as floats */
    sn_cut_clear(p, &f->gl);
    sn_status st = sn_run_step(f->run, "cutting tets", 0.4, err);
    if (!st && !p->cut_program)
        st = sn_gl_program(&f->gl, "section", sn_shader_cut_vs, sn_shader_cut_fs, &p->cut_program, err);
    return st ? st : send_section(p, f, m, max_texels, err);
}

void sn_cut_clear(sn_muscle_pass *p, const sn_gl *gl)
{
    for (int i = 0; gl && i < p->n_section; i++) {
        sn_gl_delete_mesh(gl, &p->section[i].mesh);
        sn_gl_delete_texels(gl, &p->section[i].face);
        sn_gl_delete_texels(gl, &p->section[i].cand);
    }
    sn_release(p->section);
    p->section = NULL;
    p->n_section = 0;
}

/* Drawn a hair nearer than it is, so that it wins over surfaces that begin at the same place. */
void sn_cut_draw(const sn_muscle_pass *p, const sn_frame *f)
{
    const sn_gl *gl = &f->gl;
    sn_frame_use(f, p->cut_program);
    float fat[3];
    sn_color_linear(fat_color, fat);
    gl->Uniform3f(gl->GetUniformLocation(p->cut_program, "u_fat"), fat[0], fat[1], fat[2]);
    gl->Uniform1i(gl->GetUniformLocation(p->cut_program, "u_stride"), f->scene->tendon ? 2 : 1);
    sn_muscle_use_tendon(f, p->cut_program);
    sn_gl_sampler(gl, p->cut_program, "u_color", 2, GL_TEXTURE_BUFFER, p->color.texture);
    gl->Enable(GL_POLYGON_OFFSET_FILL);
    gl->PolygonOffset(-1.0f, -8.0f);
    for (int i = 0; i < p->n_section; i++) {
        const sn_muscle_section *b = &p->section[i];
        sn_gl_sampler(gl, p->cut_program, "u_face", 0, GL_TEXTURE_BUFFER, b->face.texture);
        sn_gl_sampler(gl, p->cut_program, "u_cand", 1, GL_TEXTURE_BUFFER, b->cand.texture);
        sn_gl_draw(gl, &b->mesh, GL_TRIANGLES);
    }
    gl->Disable(GL_POLYGON_OFFSET_FILL);
}
