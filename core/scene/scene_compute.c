/* The computed half of the scene: each function brings up to date what it needs and no more. */
#include "scene/scene.h"

#include "base/alloc.h"
#include "field/segmentation.h"
#include "mesh/bvh.h"
#include "scene/scene_private.h"

#include <string.h>

/* ---- body ---- */

/* The scene takes over the body, or is left as it is. */
static sn_status adopt_body(sn_scene *s, sn_body *body, const sn_body_report *report, sn_error *err)
{
    sn_locator *locator = NULL;
    sn_body before = s->body;
    s->body = *body; /* the locator keeps the address */
    sn_status st = sn_locator_create(&locator, &s->body.mesh, err);
    if (st) {
        s->body = before;
        sn_body_free(body);
        return st;
    }
    sn_scene_stale_body(s);
    sn_body_free(&before);
    s->locator = locator;
    s->body_report = *report;
    s->has_body = true;
    return SN_OK;
}

static sn_status build_even(sn_scene *s, const sn_body_options *opt, const sn_run *run, sn_body *body,
                            sn_body_report *report, sn_error *err)
{
    sn_named_surface *bone = SN_NEW(sn_named_surface, s->n_bone);
    if (!bone) return sn_scene_no_memory(err);
    for (int32_t i = 0; i < s->n_bone; i++) bone[i] = (sn_named_surface){s->bone[i].name, &s->bone[i].mesh};
    sn_status st = sn_body_build(&s->skin, bone, s->n_bone, opt, run, body, report, &s->notes, err);
    sn_release(bone);
    return st;
}

static sn_status build_adaptive(sn_scene *s, sn_body_options opt, const sn_run *run, sn_body *body,
                                sn_body_report *report, sn_error *err)
{
    sn_sizing sizing = {.length = NULL};
    int32_t n_coarse_tet = 0;
    double start = sn_clock();
    sn_status st = sn_scene_find_sizing(s, &opt, run, &sizing, &n_coarse_tet, err);
    double seconds = sn_clock() - start;
    opt.sizing = &sizing;
    if (!st) st = build_even(s, &opt, run, body, report, err);
    report->n_coarse_tet = n_coarse_tet;
    report->seconds_coarse = seconds;
    report->seconds += seconds;
    sn_sizing_free(&sizing);
    return st;
}

static sn_status build_body(sn_scene *s, const sn_body_options *asked, const sn_run *run, sn_error *err)
{
    sn_body_options opt = *asked;
    opt.has_cut = s->has_cut;
    opt.cut_point = s->cut_point;
    opt.cut_normal = s->cut_normal;
    if (s->skin.n_face == 0) return sn_fail(err, SN_EINVAL, "the scene has no skin: set_skin first");
    sn_body body;
    sn_body_report report = {0};
    sn_body_init(&body);
    sn_status st = opt.is_adaptive ? build_adaptive(s, opt, run, &body, &report, err)
                                   : build_even(s, &opt, run, &body, &report, err);
    if (!st) st = adopt_body(s, &body, &report, err);
    if (st) return st;
    s->body_options = opt;
    s->has_options = true;
    return SN_OK;
}

sn_status sn_scene_tetrahedralize(sn_scene *s, const sn_body_options *opt, const sn_run *run,
                                  sn_body_report *report, sn_error *err)
{
    sn_status st = build_body(s, opt, run, err);
    if (!st && report) *report = s->body_report;
    return st;
}

const sn_body *sn_scene_body(const sn_scene *s)
{
    return s->has_body ? &s->body : NULL;
}

sn_status sn_scene_need_body(sn_scene *s, const sn_run *run, bool *was_meshed, sn_error *err)
{
    *was_meshed = !s->has_body;
    if (s->has_body) return SN_OK;
    sn_body_options opt = s->has_options ? s->body_options : (sn_body_options){0};
    return build_body(s, &opt, run, err);
}

/* ---- fields ---- */

const double *sn_scene_fields(const sn_scene *s)
{
    bool fresh = s->has_curves && s->is_fat_solved && s->is_volume_kept;
    for (int32_t i = 0; fresh && i < s->n_muscle; i++) fresh = s->muscle[i]->is_solved;
    return fresh ? s->field : NULL;
}

const double *sn_scene_picture_fields(const sn_scene *s)
{
    return s->is_quick ? s->field : sn_scene_fields(s);
}

int32_t sn_scene_tissue_count(const sn_scene *s)
{
    return 1 + s->n_muscle;
}

const char *sn_scene_tissue_name(const sn_scene *s, int32_t i_tissue)
{
    return i_tissue == 0 ? "fat" : s->muscle[i_tissue - 1]->muscle.name;
}

sn_status sn_scene_values_at(sn_scene *s, sn_vec3 p, const sn_run *run, double *value, bool *inside,
                             sn_error *err)
{
    double bary[4];
    *inside = false;
    sn_status st = sn_scene_fields(s) ? SN_OK : sn_scene_solve(s, run, NULL, err);
    if (st) return st;
    int32_t tet = sn_locator_find(s->locator, p, bary);
    if (tet < 0) return SN_OK;
    *inside = true;
    sn_tissue_values(&s->body.mesh, s->field, 1 + s->n_muscle, tet, bary, value);
    return SN_OK;
}

/* The first bone that holds p, or -1. */
static sn_status bone_at(const sn_scene *s, sn_vec3 p, int32_t *i_bone, sn_error *err)
{
    *i_bone = -1;
    for (int32_t i = 0; i < s->n_bone && *i_bone < 0; i++) {
        const sn_tri_mesh *m = &s->bone[i].mesh;
        sn_box3 b = sn_tri_mesh_bounds(m);
        if (p.x < b.min.x || p.x > b.max.x || p.y < b.min.y || p.y > b.max.y || p.z < b.min.z ||
            p.z > b.max.z)
            continue;
        sn_bvh *bvh = NULL;
        sn_status st = sn_bvh_create(&bvh, m, err);
        if (st) return st;
        if (fabs(sn_bvh_winding(bvh, p)) > 0.5) *i_bone = i;
        sn_bvh_destroy(bvh);
    }
    return SN_OK;
}

sn_status sn_scene_tissue_at(sn_scene *s, sn_vec3 p, const sn_run *run, sn_place *place, int32_t *index,
                             sn_error *err)
{
    bool inside;
    double *value = SN_NEW(double, 1 + s->n_muscle);
    if (!value) return sn_scene_no_memory(err);
    sn_status st = sn_scene_values_at(s, p, run, value, &inside, err);
    *index = 0;
    *place = SN_PLACE_TISSUE;
    if (!st && inside) {
        *index = sn_tissue_winner(value, 1 + s->n_muscle);
    } else if (!st) {
        st = bone_at(s, p, index, err);
        *place = *index >= 0 ? SN_PLACE_BONE : SN_PLACE_OUTSIDE;
    }
    sn_release(value);
    return st;
}

/* ---- extraction ---- */

sn_status sn_scene_extract(sn_scene *s, const sn_extract_options *opt, const sn_run *run, sn_extraction *out,
                           sn_error *err)
{
    sn_status st = sn_scene_solve(s, run, NULL, err);
    if (st) return st;
    int32_t n = 1 + s->n_muscle;
    const char **name = SN_NEW(const char *, n);
    const sn_muscle **muscle = SN_NEW(const sn_muscle *, s->n_muscle);
    if (!name || !muscle) st = sn_scene_no_memory(err);
    for (int32_t i = 0; !st && i < n; i++) name[i] = sn_scene_tissue_name(s, i);
    for (int32_t i = 0; !st && i < s->n_muscle; i++) muscle[i] = &s->muscle[i]->muscle;
    if (!st) st = sn_extract(&s->body.mesh, s->field, name, n, opt, run, out, err);
    if (!st) st = sn_extraction_set_muscles(out, muscle, s->n_muscle, err);
    if (!st) out->is_cut = sn_scene_cut_plane(s, &out->cut_point, &out->cut_normal);
    sn_release(name);
    sn_release(muscle);
    if (st) sn_extraction_free(out);
    return st;
}
