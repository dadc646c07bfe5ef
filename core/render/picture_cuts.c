/* picture_cuts.c - flat pieces coloured by the tissue that wins: where a muscle touches the border of the tet
 * mesh, and where the clip plane cuts the tets. */
#include "render/draw.h"

#include "base/alloc.h"
#include "render/muscle_tets.h"
#include "render/shaders.h"

#include <string.h>

static const double border_crease_deg = 50.0;
static const sn_rgb fat_color = {0.965f, 0.925f, 0.780f}; /* pale cream */

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

static sn_status pieces_send(pieces *p, sn_cut_batch **list, int *n_list, const sn_frame *f, sn_error *err)
{
    if (p->n_face == 0) return SN_OK;
    sn_cut_batch *more = sn_realloc(*list, (size_t)*n_list + 1, sizeof **list);
    float none[4] = {0};
    if (!more) return sn_fail(err, SN_ENOMEM, "picture: no memory for %d batches", *n_list + 1);
    *list = more;
    sn_cut_batch *b = &more[(*n_list)++];
    b->n_vert = (GLsizei)(3 * p->n_face);
    b->array = sn_gl_vertex_array(&f->gl, 3, p->corner, 3 * p->n_face);
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

sn_status sn_cut_border(sn_muscle_pass *p, const sn_frame *f, const sn_muscle_tets *m, int32_t max_texels,
                        sn_error *err)
{
    sn_tri_mesh surface;
    sn_tri_mesh_init(&surface);
    int32_t *v_map = NULL, *muscle = SN_NEW(int32_t, f->scene->n_tissue);
    float *normal = NULL;
    pieces wait = {0};
    sn_status st = muscle ? sn_tet_mesh_surface(f->scene->tets, -1, &surface, &v_map, err)
                          : sn_fail(err, SN_ENOMEM, "picture: no memory for %d tissues", f->scene->n_tissue);
    if (st) goto done;
    normal = SN_NEW(float, 9 * (size_t)surface.n_face);
    st = normal ? sn_corner_normals(&surface, border_crease_deg, f->run, normal, err)
                : sn_fail(err, SN_ENOMEM, "picture: no memory for %d border faces", surface.n_face);
    for (int32_t i = 0; i < surface.n_face && !st; i++) {
        const int32_t *v = surface.face + 3 * (size_t)i;
        int32_t mesh_v[3] = {v_map[v[0]], v_map[v[1]], v_map[v[2]]};
        int32_t n = sn_muscle_lists_merge(&m->above, mesh_v, 3, muscle);
        sn_vec3 a = sn_v3_sub(sn_tri_mesh_point(&surface, v[0]), f->eye);
        if (n == 0 || sn_v3_dot(a, sn_tri_mesh_face_normal(&surface, i)) >= 0.0) continue; /* turned away */
        cut_corner c[3];
        for (int k = 0; k < 3; k++) {
            const float *q = normal + 9 * (size_t)i + 3 * k;
            c[k] = (cut_corner){.place = sn_tri_mesh_point(&surface, v[k]), .a = mesh_v[k], .b = mesh_v[k]};
            c[k].normal = sn_v3((double)q[0], (double)q[1], (double)q[2]);
        }
        if (pieces_full(&wait, n, max_texels)) st = pieces_send(&wait, &p->border, &p->n_border, f, err);
        if (!st) st = pieces_add(&wait, f, c, muscle, n, err);
    }
    if (!st) st = pieces_send(&wait, &p->border, &p->n_border, f, err);
done:
    pieces_free(&wait);
    sn_tri_mesh_free(&surface);
    sn_release(v_map);
    sn_release(normal);
    sn_release(muscle);
    return st;
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

sn_status sn_cut_section(sn_muscle_pass *p, const sn_frame *f, const sn_muscle_tets *m, int32_t max_texels,
                         sn_error *err)
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
        if (pieces_full(&wait, n, max_texels)) st = pieces_send(&wait, &p->section, &p->n_section, f, err);
        if (!st) st = pieces_add(&wait, f, c, muscle, n, err);
        c[1] = c[0];
        if (!st && n_corner == 4) st = pieces_add(&wait, f, c + 1, muscle, n, err);
    }
    if (!st) st = pieces_send(&wait, &p->section, &p->n_section, f, err);
    pieces_free(&wait);
    sn_release(muscle);
    sn_release(height);
    return st;
}

static void draw_batches(const sn_muscle_pass *p, const sn_frame *f, const sn_cut_batch *list, int n,
                         float is_section)
{
    const sn_gl *gl = &f->gl;
    gl->Uniform1f(gl->GetUniformLocation(p->cut_program, "u_is_section"), is_section);
    for (int i = 0; i < n; i++) {
        sn_gl_sampler(gl, p->cut_program, "u_face", 0, GL_TEXTURE_BUFFER, list[i].face);
        sn_gl_sampler(gl, p->cut_program, "u_cand", 1, GL_TEXTURE_BUFFER, list[i].cand);
        gl->BindVertexArray(list[i].array);
        gl->DrawArrays(GL_TRIANGLES, 0, list[i].n_vert);
    }
}

/* Drawn a hair nearer than they are, so that they win over the tets that begin at the same place. */
void sn_cut_draw(const sn_muscle_pass *p, const sn_frame *f)
{
    const sn_gl *gl = &f->gl;
    sn_frame_use(f, p->cut_program);
    gl->Uniform3f(gl->GetUniformLocation(p->cut_program, "u_fat"), fat_color.r, fat_color.g, fat_color.b);
    sn_muscle_use_tendon(f, p->cut_program, 1);
    sn_gl_sampler(gl, p->cut_program, "u_color", 2, GL_TEXTURE_BUFFER, p->color);
    gl->Enable(GL_POLYGON_OFFSET_FILL);
    gl->PolygonOffset(-1.0f, -8.0f);
    gl->Enable(GL_CLIP_DISTANCE0);
    draw_batches(p, f, p->border, p->n_border, 0.0f);
    draw_batches(p, f, p->section, p->n_section, 1.0f);
    gl->Disable(GL_CLIP_DISTANCE0);
    gl->Disable(GL_POLYGON_OFFSET_FILL);
}
