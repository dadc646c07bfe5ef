/* What a picture of the scene shows. */
#include "scene/scene.h"

#include "base/alloc.h"
#include "scene/scene_private.h"

#include <string.h>

#define CURVE_SAMPLES 96

typedef struct drawing {
    const sn_tri_mesh **bone;
    sn_picture_curve *curve;
    double *sample; /* n_curve x CURVE_SAMPLES x 3 */
    int32_t n_curve;
} drawing;

static void free_drawing(drawing *d)
{
    sn_release(d->bone);
    sn_release(d->curve);
    sn_release(d->sample);
}

/* A curve for each head, in its muscle's colour. */
static sn_status make_curves(const sn_scene *s, drawing *d, sn_error *err)
{
    int32_t n = 0;
    for (int32_t i = 0; i < s->n_muscle; i++) n += s->muscle[i]->muscle.n_head;
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

static sn_status make_drawing(const sn_scene *s, drawing *d, sn_picture_scene *p, sn_error *err)
{
    d->bone = SN_NEW(const sn_tri_mesh *, s->n_bone);
    if (!d->bone) return sn_scene_no_memory(err);
    for (int32_t i = 0; i < s->n_bone; i++) d->bone[i] = &s->bone[i].mesh;
    sn_status st = make_curves(s, d, err);
    if (st) return st;
    p->bone = d->bone;
    p->n_bone = s->n_bone;
    p->skin = sn_scene_skin(s);
    p->curve = d->curve;
    p->n_curve = d->n_curve;
    p->unit = sn_box3_diagonal(sn_scene_bounds(s));
    return SN_OK;
}

sn_status sn_scene_render(sn_scene *s, const sn_picture_options *opt, const sn_run *run, sn_image *out,
                          sn_picture_stats *stats, sn_error *err)
{
    drawing d = {0};
    sn_picture_scene p = {0};
    bool wants_fields = (opt->show_muscles || opt->has_clip) && s->n_muscle > 0;
    sn_status st = wants_fields ? sn_scene_solve(s, run, NULL, err) : SN_OK;
    if (!st) st = make_drawing(s, &d, &p, err);
    if (!st && wants_fields) {
        p.tets = &s->body.mesh;
        p.field = s->field;
        p.n_tissue = 1 + s->n_muscle;
    }
    if (!st) st = sn_picture_draw(&p, opt, run, out, stats, err);
    free_drawing(&d);
    return st;
}
