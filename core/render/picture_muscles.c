/* picture_muscles.c - the tets that can show a muscle, sent to the GPU in batches. */
#include "render/draw.h"

#include "base/alloc.h"
#include "render/muscle_tets.h"
#include "render/shaders.h"

#include <string.h>

enum { batch_tets = 65536 };
static const sn_rgb tendon_color = {0.915f, 0.900f, 0.880f}; /* pearl: whiter than bone, no yellow of fat */

typedef struct batch_data { /* what one batch uploads */
    float *corner;          /* 24 per tet: per corner its place; its number, the tet of the batch, 0 */
    float *tet;      /* 8 per tet: the eye's barycentric coordinates, first texel and number of candidates */
    float *cand;     /* 20 per candidate: g at the corners; normal at each corner (the first with the muscle);
                        with tendons 4 more: their values at the corners */
    int texels;      /* per candidate */
    uint32_t *index; /* at most 9 per tet: a tet shows the eye at most three faces */
} batch_data;

static int candidate_texels(const sn_picture_scene *s)
{
    return s->tendon ? 6 : 5;
}

static void batch_free(batch_data *b)
{
    sn_release(b->corner);
    sn_release(b->tet);
    sn_release(b->cand);
    sn_release(b->index);
}

static sn_status batch_reserve(batch_data *b, size_t n_tet, size_t n_cand, sn_error *err)
{
    b->corner = SN_NEW(float, 24 * n_tet);
    b->tet = SN_NEW(float, 8 * n_tet);
    b->cand = SN_NEW(float, 4 * (size_t)b->texels * n_cand);
    b->index = SN_NEW(uint32_t, 12 * n_tet);
    if (b->corner && b->tet && b->cand && b->index) return SN_OK;
    return sn_fail(err, SN_ENOMEM, "picture: no memory to send %zu tets", n_tet);
}

/* Barycentric coordinates of the eye: signed volumes of the eye with each face, over the tet's. p counts from
 * the eye. All 0 for a tet without volume, which then draws nothing. */
static void eye_coordinates(const sn_vec3 p[4], float out[4])
{
    double volume = sn_v3_det(sn_v3_sub(p[1], p[0]), sn_v3_sub(p[2], p[0]), sn_v3_sub(p[3], p[0]));
    for (int k = 0; k < 4; k++) {
        const int *c = sn_tet_face[k];
        out[k] = volume > 0.0 ? (float)(sn_v3_det(p[c[0]], p[c[1]], p[c[2]]) / volume) : 0.0f;
    }
}

static void fill_candidate(const sn_muscle_tets *m, const sn_picture_scene *s, const int32_t v[4],
                           int32_t i_muscle, float *out)
{
    for (int k = 0; k < 4; k++) {
        out[k] = (float)sn_muscle_above_fat(s, i_muscle, v[k]);
        memcpy(out + 4 * (k + 1), sn_muscle_tets_normal(m, v[k], i_muscle), 3 * sizeof *out);
        out[4 * (k + 1) + 3] = (float)i_muscle;
        if (s->tendon) out[20 + k] = (float)sn_muscle_tendon(s, i_muscle, v[k]);
    }
}

/* Tet number `at` of the batch; cand0: the batch's first candidate. */
static void fill_tet(batch_data *b, const sn_muscle_tets *m, const sn_frame *f, int32_t i_sent, size_t at,
                     int64_t cand0)
{
    const sn_tet_mesh *mesh = f->scene->tets;
    const int32_t *v = mesh->tet + 4 * (size_t)m->tet[i_sent];
    sn_vec3 p[4];
    for (int k = 0; k < 4; k++) {
        p[k] = sn_v3_sub(sn_tet_mesh_point(mesh, v[k]), f->eye);
        float *corner = b->corner + 24 * at + 6 * k;
        sn_frame_place(f, sn_tet_mesh_point(mesh, v[k]), corner);
        corner[3] = (float)k;
        corner[4] = (float)at;
        corner[5] = 0.0f;
    }
    int64_t c0 = m->cand.first[i_sent], c1 = m->cand.first[i_sent + 1];
    float *tet = b->tet + 8 * at;
    eye_coordinates(p, tet);
    tet[4] = (float)(b->texels * (c0 - cand0));
    tet[5] = (float)(c1 - c0);
    tet[6] = tet[7] = 0.0f;
    for (int64_t c = c0; c < c1; c++)
        fill_candidate(m, f->scene, v, m->cand.muscle[c], b->cand + 4 * b->texels * (c - cand0));
}

/* The faces turned to the eye: it lies beyond face k when its coordinate k is negative. */
static size_t fill_index(batch_data *b, size_t n_tet)
{
    size_t n = 0;
    for (size_t i = 0; i < n_tet; i++)
        for (int k = 0; k < 4; k++)
            if (b->tet[8 * i + (size_t)k] < 0.0f)
                for (int c = 0; c < 3; c++) b->index[n++] = (uint32_t)(4 * i) + (uint32_t)sn_tet_face[k][c];
    return n;
}

static sn_status send_batch(sn_tet_batch *out, const sn_muscle_tets *m, const sn_frame *f, int32_t i0,
                            int32_t i1, sn_error *err)
{
    int64_t c0 = m->cand.first[i0], n_cand = m->cand.first[i1] - c0;
    size_t n_tet = (size_t)(i1 - i0);
    batch_data b = {.texels = candidate_texels(f->scene)};
    sn_status st = batch_reserve(&b, n_tet, (size_t)n_cand, err);
    if (st) goto done;
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(f->run))
    for (int32_t i = i0; i < i1; i++) fill_tet(&b, m, f, i, (size_t)(i - i0), c0);
    size_t n_index = fill_index(&b, n_tet);
    out->n_index = (GLsizei)n_index;
    out->array = sn_gl_vertex_array(&f->gl, 2, b.corner, 4 * n_tet);
    (void)sn_gl_buffer(&f->gl, GL_ELEMENT_ARRAY_BUFFER, b.index, n_index * sizeof *b.index);
    out->tet = sn_gl_buffer_texture(&f->gl, GL_RGBA32F, b.tet, 8 * n_tet * sizeof(float));
    out->cand = sn_gl_buffer_texture(&f->gl, GL_RGBA32F, b.cand,
                                     4 * (size_t)b.texels * (size_t)n_cand * sizeof(float));
    st = sn_gl_check(&f->gl, "sending tets", err);
done:
    batch_free(&b);
    return st;
}

/* The end of the batch that begins at i0: within batch_tets and the texels of one buffer, at least one tet.
 */
static int32_t batch_end(const sn_muscle_tets *m, const sn_frame *f, int32_t i0, int32_t max_texels)
{
    int texels = candidate_texels(f->scene);
    int32_t i = i0 + 1;
    while (i < m->n_tet && i - i0 < batch_tets && 2 * (i + 1 - i0) <= max_texels &&
           texels * (m->cand.first[i + 1] - m->cand.first[i0]) <= max_texels)
        i++;
    return i;
}

static sn_status send_tets(sn_muscle_pass *p, const sn_muscle_tets *m, const sn_frame *f, int32_t max_texels,
                           sn_error *err)
{
    int n = 0;
    for (int32_t i = 0; i < m->n_tet; i = batch_end(m, f, i, max_texels)) n++;
    p->tets = SN_NEW_ZERO(sn_tet_batch, n);
    if (!p->tets) return sn_fail(err, SN_ENOMEM, "picture: no memory for %d batches", n);
    for (int32_t i = 0, end; i < m->n_tet; i = end) {
        end = batch_end(m, f, i, max_texels);
        sn_status st = sn_run_step(f->run, "sending tets", 0.2 + 0.2 * i / m->n_tet, err);
        if (!st) st = send_batch(&p->tets[p->n_tets++], m, f, i, end, err);
        if (st) return st;
    }
    p->n_sent = m->n_tet;
    return SN_OK;
}

static sn_status send_colors(sn_muscle_pass *p, const sn_frame *f, sn_error *err)
{
    size_t n = (size_t)f->scene->n_tissue - 1;
    float *c = SN_NEW_ZERO(float, 4 * (n + 1)); /* one more, so that no buffer is empty */
    if (!c) return sn_fail(err, SN_ENOMEM, "picture: no memory for %zu colours", n);
    for (size_t i = 0; i < n; i++) {
        sn_rgb rgb = sn_muscle_color((int32_t)i);
        memcpy(c + 4 * i, &rgb, 3 * sizeof *c);
    }
    p->color = sn_gl_buffer_texture(&f->gl, GL_RGBA32F, c, 4 * (n + 1) * sizeof *c);
    sn_release(c);
    return SN_OK;
}

static sn_status check_tendons(const sn_picture_scene *s, sn_error *err)
{
    for (int32_t i = 0; s->tendon && i < s->n_tissue - 1; i++)
        for (int32_t v = 0; s->tendon[i] && v < s->tets->n_vert; v++)
            if (!isfinite(s->tendon[i][v]))
                return sn_fail(
                    err, SN_EINVAL,
                    "picture: the tendon of muscle %d has the value %g at vertex %d, need a finite one",
                    i + 1, (double)s->tendon[i][v], v + 1);
    return SN_OK;
}

sn_status sn_muscle_pass_prepare(sn_muscle_pass *p, const sn_frame *f, sn_error *err)
{
    sn_muscle_tets m;
    sn_muscle_tets_init(&m);
    GLint max_texels = 0;
    f->gl.GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &max_texels);
    if (max_texels > 1 << 24) max_texels = 1 << 24; /* texel numbers travel as floats */
    sn_status st =
        sn_gl_program(&f->gl, "muscle", sn_shader_muscle_vs, sn_shader_muscle_fs, &p->tet_program, err);
    if (!st) st = sn_gl_program(&f->gl, "section", sn_shader_cut_vs, sn_shader_cut_fs, &p->cut_program, err);
    if (!st) st = check_tendons(f->scene, err);
    if (!st) st = sn_muscle_tets_find(&m, f->scene, f->run, err);
    if (!st) st = send_colors(p, f, err);
    if (!st) st = send_tets(p, &m, f, max_texels, err);
    if (!st) st = sn_run_step(f->run, "cutting tets", 0.4, err);
    if (!st) st = sn_cut_border(p, f, &m, max_texels, err);
    if (!st && f->has_section) st = sn_cut_section(p, f, &m, max_texels, err);
    sn_muscle_tets_free(&m);
    return st;
}

void sn_muscle_use_tendon(const sn_frame *f, GLuint program, int texels)
{
    const sn_gl *gl = &f->gl;
    const sn_rgb c = tendon_color;
    gl->Uniform1i(gl->GetUniformLocation(program, "u_stride"), texels + (f->scene->tendon ? 1 : 0));
    gl->Uniform3f(gl->GetUniformLocation(program, "u_tendon"), c.r, c.g, c.b);
}

static void draw_tets(const sn_muscle_pass *p, const sn_frame *f)
{
    const sn_gl *gl = &f->gl;
    sn_frame_use(f, p->tet_program);
    sn_muscle_use_tendon(f, p->tet_program, 5);
    sn_gl_sampler(gl, p->tet_program, "u_color", 2, GL_TEXTURE_BUFFER, p->color);
    for (int i = 0; i < p->n_tets; i++) {
        const sn_tet_batch *b = &p->tets[i];
        sn_gl_sampler(gl, p->tet_program, "u_tet", 0, GL_TEXTURE_BUFFER, b->tet);
        sn_gl_sampler(gl, p->tet_program, "u_cand", 1, GL_TEXTURE_BUFFER, b->cand);
        gl->BindVertexArray(b->array);
        gl->DrawElements(GL_TRIANGLES, b->n_index, GL_UNSIGNED_INT, NULL);
    }
}

void sn_muscle_pass_draw(const sn_muscle_pass *p, const sn_frame *f)
{
    draw_tets(p, f);
    sn_cut_draw(p, f);
}

void sn_muscle_pass_free(sn_muscle_pass *p)
{
    sn_release(p->tets);
    sn_release(p->border);
    sn_release(p->section);
    memset(p, 0, sizeof *p);
}
