/* picture_muscles.c - the muscles: their surfaces are made and sent once for each set of fields. */
#include "render/draw.h"

#include "base/alloc.h"
#include "render/muscle_surface.h"
#include "render/muscle_tets.h"
#include "render/shaders.h"

#include <string.h>

static const sn_rgb tendon_color = {0.915f, 0.900f, 0.880f}; /* pearl: whiter than bone, no yellow of fat */

typedef struct sn_muscle_kept {
    sn_muscle_tets tets; /* of the fields */
    sn_tet_fans fans;    /* this and the border: of the tet mesh */
    sn_muscle_border border;
    sn_key mesh_key;
} sn_muscle_kept;

static sn_status send_colors(sn_muscle_pass *p, const sn_frame *f, sn_error *err)
{
    size_t n = (size_t)f->scene->n_tissue - 1;
    float *c = SN_NEW_ZERO(float, 4 * (n + 1)); /* one more, so that no buffer is empty */
    if (!c) return sn_fail(err, SN_ENOMEM, "picture: no memory for %zu colours", n);
    for (size_t i = 0; i < n; i++) sn_color_linear(sn_muscle_color((int32_t)i), c + 4 * i);
    sn_gl_delete_texels(&f->gl, &p->color);
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

static void clear_surface(sn_muscle_pass *p, const sn_gl *gl)
{
    sn_gl_delete_mesh(gl, &p->surface);
    sn_gl_delete_buffer(gl, &p->tendon);
}

static void send_surface(sn_muscle_pass *p, const sn_gl *gl, const sn_muscle_surface *s)
{
    enum { stride = sizeof(sn_surface_vertex) };
    p->surface.n = (GLsizei)s->n_index;
    gl->GenVertexArrays(1, &p->surface.array);
    gl->BindVertexArray(p->surface.array);
    p->surface.buffer = sn_gl_buffer(gl, GL_ARRAY_BUFFER, s->vert, s->n_vert * sizeof *s->vert);
    sn_gl_attribute(gl, 0, 3, GL_FLOAT, false, stride, offsetof(sn_surface_vertex, place));
    sn_gl_attribute(gl, 1, 3, GL_SHORT, true, stride, offsetof(sn_surface_vertex, normal));
    sn_gl_attribute(gl, 2, 1, GL_UNSIGNED_SHORT, false, stride, offsetof(sn_surface_vertex, kind));
    sn_gl_attribute(gl, 3, 4, GL_UNSIGNED_BYTE, true, stride, offsetof(sn_surface_vertex, color));
    if (s->tendon) { /* without, the attribute is 0: no tendon */
        p->tendon = sn_gl_buffer(gl, GL_ARRAY_BUFFER, s->tendon, s->n_vert * sizeof *s->tendon);
        sn_gl_attribute(gl, 4, 1, GL_FLOAT, false, 0, 0);
    }
    p->surface.index = sn_gl_buffer(gl, GL_ELEMENT_ARRAY_BUFFER, s->index, s->n_index * sizeof *s->index);
}

static sn_box3 surface_bounds(const sn_muscle_surface *s, sn_vec3 origin)
{
    sn_box3 box = sn_box3_empty();
    for (size_t i = 0; i < s->n_vert; i++) {
        const float *p = s->vert[i].place;
        box = sn_box3_add(box, sn_v3_add(origin, sn_v3((double)p[0], (double)p[1], (double)p[2])));
    }
    return box;
}

static sn_status look_at_mesh(sn_muscle_kept *k, const sn_frame *f, sn_error *err)
{
    sn_key key = sn_frame_key(f, f->scene->stamp.shapes, f->scene->stamp.shapes);
    key.count[0] = f->scene->tets->n_tet;
    if (sn_key_same(&k->mesh_key, &key)) return SN_OK;
    k->mesh_key = (sn_key){0};
    sn_muscle_border_free(&k->border);
    sn_tet_fans_free(&k->fans);
    sn_status st = sn_muscle_border_find(&k->border, f->scene->tets, f->run, err);
    if (!st) st = sn_tet_fans_find(&k->fans, f->scene->tets, err);
    if (!st) k->mesh_key = key;
    return st;
}

static sn_status make_surface(sn_muscle_pass *p, const sn_frame *f, sn_error *err)
{
    sn_muscle_kept *k = p->kept;
    sn_muscle_surface s = {0};
    clear_surface(p, &f->gl);
    sn_status st = check_tendons(f->scene, err);
    if (!st) st = look_at_mesh(k, f, err);
    if (!st) st = sn_muscle_tets_find(&k->tets, f->scene, &k->fans, f->run, err);
    if (!st) st = send_colors(p, f, err);
    if (!st) st = sn_run_step(f->run, "making surfaces", 0.2, err);
    if (!st) st = sn_muscle_surface_make(&s, f->scene, &k->tets, &k->border, f->origin, f->run, err);
    if (!st) {
        send_surface(p, &f->gl, &s);
        p->bounds = surface_bounds(&s, f->origin);
        p->n_sent = k->tets.n_tet;
        st = sn_gl_check(&f->gl, "sending muscles", err);
    }
    sn_muscle_surface_free(&s);
    return st;
}

sn_status sn_muscle_pass_update(sn_muscle_pass *p, const sn_frame *f, sn_error *err)
{
    sn_key key = sn_frame_key(f, f->scene->stamp.shapes, f->scene->stamp.fields);
    sn_clip_key clip = sn_frame_clip_key(f);
    key.count[0] = f->scene->n_tissue;
    key.count[1] = f->scene->tets->n_tet;
    key.count[2] = f->scene->tendon != NULL;
    bool is_same = sn_key_same(&p->key, &key);
    if (is_same && sn_clip_key_same(&p->clip, &clip)) return SN_OK;
    p->key = (sn_key){0};
    if (!p->kept) p->kept = SN_NEW_ZERO(sn_muscle_kept, 1);
    if (!p->kept) return sn_fail(err, SN_ENOMEM, "picture: no memory for muscles");
    sn_status st = SN_OK;
    if (!p->program)
        st = sn_gl_program(&f->gl, "muscle", sn_shader_muscle_vs, sn_shader_muscle_fs, &p->program, err);
    if (!st && !is_same) st = make_surface(p, f, err);
    sn_cut_clear(p, &f->gl);
    if (!st && clip.has_section) st = sn_cut_update(p, f, &p->kept->tets, err);
    if (st) return st;
    p->key = key;
    p->clip = clip;
    return SN_OK;
}

void sn_muscle_use_tendon(const sn_frame *f, GLuint program)
{
    const sn_gl *gl = &f->gl;
    float c[3];
    sn_color_linear(tendon_color, c);
    gl->Uniform3f(gl->GetUniformLocation(program, "u_tendon"), c[0], c[1], c[2]);
}

void sn_muscle_pass_draw(const sn_muscle_pass *p, const sn_frame *f)
{
    const sn_gl *gl = &f->gl;
    sn_frame_use(f, p->program);
    sn_muscle_use_tendon(f, p->program);
    if (f->opt->has_clip) gl->Enable(GL_CLIP_DISTANCE0);
    gl->Enable(GL_CULL_FACE); /* the change from muscle to fat is not seen */
    gl->CullFace(GL_BACK);
    sn_gl_draw(gl, &p->surface, GL_TRIANGLES);
    gl->Disable(GL_CULL_FACE);
    gl->Disable(GL_CLIP_DISTANCE0);
    if (p->n_section > 0) sn_cut_draw(p, f);
}

void sn_muscle_pass_free(sn_muscle_pass *p)
{
    if (p->kept) {
        sn_muscle_tets_free(&p->kept->tets);
        sn_muscle_border_free(&p->kept->border);
        sn_tet_fans_free(&p->kept->fans);
    }
    sn_release(p->kept);
    sn_cut_clear(p, NULL);
    memset(p, 0, sizeof *p);
}
