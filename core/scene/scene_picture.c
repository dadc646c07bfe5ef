/* What a picture of the scene shows, and what the next picture can use again. */
#include "scene/scene.h"

#include "base/alloc.h"
#include "field/measure.h"
#include "render/painter.h"
#include "scene/scene_private.h"

#include <string.h>

#define CURVE_SAMPLES 96
enum { n_frame = 9 }; /* along each curve */

typedef struct drawing {
    const sn_tri_mesh **bone;
    int32_t n_bone;
    sn_picture_curve *curve;
    double *sample; /* n_curve x CURVE_SAMPLES x 3 */
    int32_t n_curve;
    sn_picture_arrow *arrow;
    int32_t n_arrow;
    float **tendon; /* n_muscle, each NULL or n_vert; NULL: no muscle has one */
    int32_t n_tendon;
    sn_polylines lines;
    sn_picture_line *fiber;
} drawing;

static void free_drawing(drawing *d)
{
    sn_release(d->bone);
    sn_release(d->curve);
    sn_release(d->sample);
    sn_release(d->arrow);
    for (int32_t i = 0; d->tendon && i < d->n_tendon; i++) sn_release(d->tendon[i]);
    sn_release(d->tendon);
    sn_polylines_free(&d->lines);
    sn_release(d->fiber);
}

static int32_t count_heads(const sn_scene *s)
{
    int32_t n = 0;
    for (int32_t i = 0; i < s->n_muscle; i++) n += s->muscle[i]->muscle.n_head;
    return n;
}

/* A curve for each head, in its muscle's colour. */
static sn_status make_curves(const sn_scene *s, drawing *d, sn_error *err)
{
    int32_t n = count_heads(s);
    d->curve = SN_NEW(sn_picture_curve, n);
    d->sample = SN_NEW(double, (size_t)n *CURVE_SAMPLES * 3);
    if (!d->curve || !d->sample) return sn_scene_no_memory(err);
    for (int32_t i = 0; i < s->n_muscle; i++)
        for (int32_t k = 0; k < s->muscle[i]->muscle.n_head; k++) {
            const sn_head *h = &s->muscle[i]->muscle.head[k];
            double *at = d->sample + (size_t)d->n_curve * CURVE_SAMPLES * 3;
            sn_spline_sample(&h->spline, CURVE_SAMPLES, at);
            d->curve[d->n_curve++] =
                (sn_picture_curve){at, CURVE_SAMPLES, h->point, h->n_point, sn_muscle_color(i)};
        }
    return SN_OK;
}

/* ---- frames ---- */

static bool has_frame(const sn_muscle *m)
{
    return m->anisotropy.is_on || m->pennation.kind >= SN_UNIPENNATE;
}

/* Arrows as long as tissue reaches in their directions: by the roots of the eigenvalues, the longest a
 * twelfth of the curve. */
static void add_arrows(const sn_muscle *m, const sn_path *p, drawing *d)
{
    static const sn_rgb color[3] = {{0.80f, 0.16f, 0.13f}, {0.13f, 0.55f, 0.20f}, {0.14f, 0.33f, 0.78f}};
    const double *l = m->anisotropy.eigenvalue;
    double root[3], most = 0.0;
    for (int k = 0; k < 3; k++) {
        root[k] = m->anisotropy.is_on ? sqrt(l[k]) : 1.0;
        most = fmax(most, root[k]);
    }
    for (int i = 0; i < n_frame; i++) {
        double arc = p->length * i / (n_frame - 1);
        sn_triad f = sn_path_frame(p, arc);
        const sn_vec3 e[3] = {f.e1, f.e2, f.e3};
        for (int k = 0; k < 3; k++)
            d->arrow[d->n_arrow++] = (sn_picture_arrow){
                sn_path_point(p, arc), sn_v3_scale(p->length / 12.0 * root[k] / most, e[k]), color[k]};
    }
}

static sn_status make_frames(sn_scene *s, drawing *d, sn_error *err)
{
    d->arrow = SN_NEW(sn_picture_arrow, 3 * n_frame * (size_t)count_heads(s));
    if (!d->arrow) return sn_scene_no_memory(err);
    for (int32_t i = 0; i < s->n_muscle; i++) {
        const sn_muscle *m = &s->muscle[i]->muscle;
        if (!has_frame(m)) continue;
        sn_status st = sn_scene_need_paths(s->muscle[i], err);
        if (st) return st;
        for (int32_t h = 0; h < m->n_head; h++) add_arrows(m, &s->muscle[i]->paths.head[h], d);
    }
    return SN_OK;
}

/* ---- tendon ---- */

/* On which side of the tendon's border each vertex near the muscle lies. */
static void place_tendon(const sn_scene *s, int32_t i_muscle, const double *share, const sn_tendons *t,
                         const sn_run *run, float *out)
{
    const sn_tet_mesh *m = &s->body.mesh;
    const sn_paths *paths = &s->muscle[i_muscle]->paths;
    for (int32_t v = 0; v < m->n_vert; v++) out[v] = 0.0f;
    for (size_t k = 0; k < 4 * (size_t)m->n_tet; k++)
        if (share[k >> 2] > 0.0) out[m->tet[k]] = 1.0f;
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(run))
    for (int32_t v = 0; v < m->n_vert; v++)
        out[v] = out[v] > 0.0f ? (float)sn_tendons_at(t, paths, sn_tet_mesh_point(m, v)) : -1.0f;
}

static sn_status make_tendon(sn_scene *s, int32_t i, const sn_run *run, float **out, sn_error *err)
{
    scene_muscle *m = s->muscle[i];
    sn_measure *measure = NULL;
    sn_tendons tendons = {0};
    double *share = SN_NEW(double, s->body.mesh.n_tet);
    *out = SN_NEW(float, s->body.mesh.n_vert);
    sn_status st = share && *out ? sn_scene_need_paths(m, err) : sn_scene_no_memory(err);
    if (!st) st = sn_measure_create(&measure, &s->body.mesh, s->field, 1 + s->n_muscle, 1 + i, run, err);
    if (!st) {
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(run))
        for (int32_t t = 0; t < s->body.mesh.n_tet; t++) share[t] = sn_measure_tet_share(measure, t, 1.0);
        st = sn_tendons_find(&tendons, &s->body.mesh, share, &m->muscle, &m->paths, err);
    }
    if (!st) place_tendon(s, i, share, &tendons, run, *out);
    sn_tendons_free(&tendons);
    sn_measure_destroy(measure);
    sn_release(share);
    return st;
}

static sn_status make_tendons(sn_scene *s, drawing *d, const sn_run *run, sn_error *err)
{
    for (int32_t i = 0; i < s->n_muscle; i++) {
        if (!sn_muscle_has_tendon(&s->muscle[i]->muscle)) continue;
        if (!d->tendon) d->tendon = SN_NEW_ZERO(float *, s->n_muscle);
        if (!d->tendon) return sn_scene_no_memory(err);
        d->n_tendon = s->n_muscle;
        sn_status st = make_tendon(s, i, run, &d->tendon[i], err);
        if (st) return st;
    }
    return SN_OK;
}

/* ---- fibers ---- */

static sn_status trace_fibers(sn_scene *s, const sn_extraction *x, int32_t n, drawing *d, const sn_run *run,
                              sn_error *err)
{
    for (int32_t i = 0; i < s->n_muscle; i++) {
        sn_part_fibers p;
        sn_error why;
        sn_status st = sn_part_fibers_build(&p, x, &s->body.mesh, 1 + i, NULL, run, &why);
        if (st == SN_EINVAL) sn_notes_add(&s->notes, "%s: none are drawn", why.msg);
        if (st && st != SN_EINVAL && err) *err = why;
        if (!st) st = sn_part_fibers_lines(&p, x, n, run, &d->lines, err);
        sn_part_fibers_free(&p);
        if (st && st != SN_EINVAL) return st;
    }
    return SN_OK;
}

static sn_status make_fibers(sn_scene *s, int32_t n, drawing *d, const sn_run *run, sn_error *err)
{
    sn_extraction x;
    sn_extraction_init(&x);
    sn_status st = sn_scene_extract(s, NULL, run, &x, err);
    if (!st) st = trace_fibers(s, &x, n, d, run, err);
    sn_extraction_free(&x);
    if (st) return st;
    d->fiber = SN_NEW(sn_picture_line, d->lines.n_line);
    if (!d->fiber) return sn_scene_no_memory(err);
    for (size_t i = 0; i < d->lines.n_line; i++) {
        int64_t first = d->lines.first[i], end = d->lines.first[i + 1];
        d->fiber[i] = (sn_picture_line){d->lines.pos + 3 * (size_t)first, (int32_t)(end - first),
                                        sn_muscle_color(d->lines.part[i] - 1)};
    }
    return SN_OK;
}

/* ---- the whole ---- */

/* What the drawing was made of; with equal ones it is the same. */
typedef struct view_key {
    uint64_t revision, shapes, fields;
    int32_t n_fiber;
    bool show_frames, show_fibers, has_tendons, has_fields;
} view_key;

/* Stays with the scene from picture to picture. */
typedef struct scene_view {
    sn_painter *painter;
    drawing drawing;
    view_key key;
    bool has_drawing;
    uint64_t n_drawing; /* made so far */
} scene_view;

static void drop_drawing(scene_view *v)
{
    free_drawing(&v->drawing);
    v->drawing = (drawing){0};
    sn_polylines_init(&v->drawing.lines, false);
    v->has_drawing = false;
}

void sn_scene_free_view(sn_scene *s)
{
    if (!s->view) return;
    drop_drawing(s->view);
    sn_painter_destroy(s->view->painter);
    sn_release(s->view);
    s->view = NULL;
}

static sn_status need_view(sn_scene *s, sn_error *err)
{
    if (s->view) return SN_OK;
    scene_view *v = SN_NEW_ZERO(scene_view, 1);
    if (!v) return sn_scene_no_memory(err);
    drop_drawing(v);
    sn_status st = sn_painter_create(&v->painter, err);
    if (st)
        sn_release(v);
    else
        s->view = v;
    return st;
}

static sn_status make_drawing(sn_scene *s, const view_key *k, const sn_run *run, drawing *d, sn_error *err)
{
    d->bone = SN_NEW(const sn_tri_mesh *, s->n_bone);
    if (!d->bone) return sn_scene_no_memory(err);
    for (int32_t i = 0; i < s->n_bone; i++) /* nothing may be left of it in a half model */
        if (sn_scene_bone_mesh(s, i)->n_face > 0) d->bone[d->n_bone++] = sn_scene_bone_mesh(s, i);
    sn_status st = make_curves(s, d, err);
    if (!st && k->show_frames) st = make_frames(s, d, err);
    if (!st && k->has_tendons) st = make_tendons(s, d, run, err);
    if (!st && k->has_fields && k->show_fibers) st = make_fibers(s, k->n_fiber, d, run, err);
    return st;
}

/* Fibers are of an extraction, which may solve. */
static sn_status need_drawing(sn_scene *s, const sn_picture_options *opt, int32_t n_fiber, const sn_run *run,
                              sn_error *err)
{
    scene_view *v = s->view;
    bool has_fields = s->n_muscle > 0 && sn_scene_picture_fields(s);
    view_key k;
    memset(&k, 0, sizeof k);
    k.has_fields = has_fields;
    k.has_tendons = has_fields && (opt->show_muscles || opt->has_clip);
    k.show_frames = opt->show_frames;
    k.show_fibers = opt->show_fibers;
    k.n_fiber = opt->show_fibers ? n_fiber : 0;
    k.revision = s->revision;
    k.shapes = s->shape_revision;
    k.fields = s->field_revision;
    if (v->has_drawing && memcmp(&v->key, &k, sizeof k) == 0) return SN_OK;
    drop_drawing(v);
    sn_status st = make_drawing(s, &k, run, &v->drawing, err);
    if (st) {
        drop_drawing(v);
        return st;
    }
    k.fields = s->field_revision;
    v->key = k;
    v->has_drawing = true;
    v->n_drawing++;
    return SN_OK;
}

static void show_drawing(const sn_scene *s, const scene_view *v, sn_picture_scene *p)
{
    const drawing *d = &v->drawing;
    p->bone = d->bone;
    p->n_bone = d->n_bone;
    p->skin = sn_scene_skin(s);
    p->curve = d->curve;
    p->n_curve = d->n_curve;
    p->arrow = d->arrow;
    p->n_arrow = d->n_arrow;
    p->fiber = d->fiber;
    p->n_fiber = (int32_t)d->lines.n_line;
    p->tendon = (const float *const *)d->tendon;
    p->unit = sn_box3_diagonal(sn_scene_bounds(s));
    /* Both numbers of the sum only grow: it is another one when either is. */
    p->stamp = (sn_picture_stamps){.shapes = 1 + s->shape_revision,
                                   .fields = 1 + s->field_revision + s->revision,
                                   .curves = v->n_drawing};
}

sn_status sn_scene_render(sn_scene *s, const sn_picture_options *opt, int32_t n_fiber, const sn_run *run,
                          sn_image *out, sn_picture_stats *stats, sn_error *err)
{
    sn_picture_scene p = {0};
    bool wants_fields = (opt->show_muscles || opt->show_fibers || opt->has_clip) && s->n_muscle > 0;
    sn_status st = need_view(s, err);
    if (!st && wants_fields && !sn_scene_picture_fields(s)) st = sn_scene_solve(s, run, NULL, err);
    if (!st) st = need_drawing(s, opt, n_fiber, run, err);
    if (st) return st;
    show_drawing(s, s->view, &p);
    if (wants_fields) {
        p.tets = &s->body.mesh;
        p.field = s->field;
        p.n_tissue = 1 + s->n_muscle;
    }
    return sn_painter_draw(s->view->painter, &p, opt, run, out, stats, err);
}
