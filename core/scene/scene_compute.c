/* The computed half of the scene: each function brings up to date what it needs and no more. */
#include "scene/scene.h"

#include "base/alloc.h"
#include "field/segmentation.h"
#include "field/tensor.h"
#include "mesh/bvh.h"
#include "scene/scene_private.h"

#include <string.h>

/* ---- body ---- */

static sn_status build_body(sn_scene *s, const sn_body_options *opt, const sn_run *run, sn_error *err)
{
    if (s->skin.n_face == 0) return sn_fail(err, SN_EINVAL, "the scene has no skin: set_skin first");
    sn_named_surface *bone = SN_NEW(sn_named_surface, s->n_bone);
    if (!bone) return sn_scene_no_memory(err);
    for (int32_t i = 0; i < s->n_bone; i++) bone[i] = (sn_named_surface){s->bone[i].name, &s->bone[i].mesh};
    sn_body body;
    sn_body_report report;
    sn_body_init(&body);
    sn_locator *locator = NULL;
    sn_status st = sn_body_build(&s->skin, bone, s->n_bone, opt, run, &body, &report, &s->notes, err);
    sn_release(bone);
    if (st) return st;
    sn_scene_stale_body(s);
    sn_body_free(&s->body);
    s->body = body;
    s->body_report = report;
    st = sn_locator_create(&locator, &s->body.mesh, err);
    if (st) return st;
    s->locator = locator;
    s->body_options = *opt;
    s->has_options = s->has_body = true;
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

static sn_status need_body(sn_scene *s, const sn_run *run, bool *was_meshed, sn_error *err)
{
    *was_meshed = !s->has_body;
    if (s->has_body) return SN_OK;
    sn_body_options opt = s->has_options ? s->body_options : (sn_body_options){0};
    return build_body(s, &opt, run, err);
}

/* ---- fields ---- */

static sn_status need_rows(sn_scene *s, sn_error *err)
{
    for (int32_t i = 0; i < s->n_muscle; i++) {
        scene_muscle *m = s->muscle[i];
        if (m->has_row) continue;
        sn_notes *notes = s->has_factor ? NULL : &s->notes; /* only tissue values changed: said before */
        sn_status st = sn_collocate(&m->muscle, &s->body, s->locator, &m->row, notes, err);
        if (st) return st;
        m->has_row = true;
    }
    return SN_OK;
}

static sn_status need_solver(sn_scene *s, const sn_run *run, sn_error *err)
{
    return s->solver ? SN_OK : sn_tissue_solver_create(&s->solver, &s->body, run, err);
}

static sn_status need_harmonic(sn_scene *s, const sn_run *run, sn_error *err)
{
    if (s->harmonic) return SN_OK;
    int32_t *rank = SN_NEW(int32_t, s->body.mesh.n_vert);
    if (!rank) return sn_scene_no_memory(err);
    sn_tissue_solver_order(s->solver, rank);
    sn_status st = sn_harmonic_create(&s->harmonic, sn_tissue_solver_laplacian(s->solver), rank, run, err);
    sn_release(rank);
    return st;
}

static sn_status make_tensor(const sn_scene *s, scene_muscle *m, const sn_run *run, sn_error *err)
{
    int32_t n = s->body.mesh.n_vert;
    sn_triad *frame = SN_NEW(sn_triad, n);
    sn_release(m->tensor);
    m->tensor = SN_NEW(double, 6 * (size_t)n);
    sn_status st = frame && m->tensor ? sn_scene_need_paths(m, err) : sn_scene_no_memory(err);
    if (!st) st = sn_frame_field(s->harmonic, &s->body.mesh, &m->row, &m->paths, run, frame, err);
    if (!st) sn_tensor_field(frame, n, m->muscle.anisotropy.eigenvalue, m->tensor);
    sn_release(frame);
    m->has_tensor = st == SN_OK;
    return sn_muscle_blame(&m->muscle, -1, st, err);
}

/* A frame with eigenvalues (1, 1, 1) only says where e2 points: the muscle is isotropic. */
static bool is_anisotropic(const sn_muscle *m)
{
    const double *l = m->anisotropy.eigenvalue;
    return m->anisotropy.is_on && !(l[0] == 1.0 && l[1] == 1.0 && l[2] == 1.0);
}

static void drop_tensor(scene_muscle *m)
{
    sn_release(m->tensor);
    m->tensor = NULL;
    m->has_tensor = false;
}

static sn_status need_tensor(void *user, int32_t i, const sn_run *run, sn_error *err)
{
    sn_scene *s = user;
    scene_muscle *m = s->muscle[i];
    if (!is_anisotropic(&m->muscle)) drop_tensor(m);
    return m->has_tensor || !is_anisotropic(&m->muscle) ? SN_OK : make_tensor(s, m, run, err);
}

static bool needs_frames(const sn_scene *s)
{
    bool needed = false;
    for (int32_t i = 0; i < s->n_muscle; i++)
        needed = needed || (is_anisotropic(&s->muscle[i]->muscle) && !s->muscle[i]->has_tensor);
    return needed;
}

static sn_status make_factor(sn_scene *s, const sn_run *run, sn_error *err)
{
    sn_status st = sn_tissue_solver_set_curves(s->solver, s->inputs, s->n_muscle, s->alpha, run, err);
    s->has_factor = st == SN_OK;
    return st;
}

static sn_status make_one_factor(void *user, int32_t i, const sn_run *run, sn_error *err)
{
    return i == 0 ? need_harmonic(user, run, err) : make_factor(user, run, err);
}

/* The factor for the curves and that for frames: side by side when both are wanted. */
static sn_status make_factors(sn_scene *s, const sn_run *run, sn_error *err)
{
    bool wants_curves = !s->has_factor, wants_frames = needs_frames(s) && !s->harmonic;
    if (!wants_curves || !wants_frames) {
        sn_status st = wants_curves ? make_factor(s, run, err) : SN_OK;
        return !st && wants_frames ? need_harmonic(s, run, err) : st;
    }
    return sn_run_each(run, 2, make_one_factor, s, err);
}

static sn_status need_factor(sn_scene *s, const sn_run *run, bool *was_factorized, sn_error *err)
{
    sn_status st = sn_run_step(run, "factorizing", 0.0, err);
    *was_factorized = !s->has_factor;
    if (!st && !s->inputs) {
        s->inputs = SN_NEW(sn_tissue_muscle, s->n_muscle);
        if (!s->inputs) return sn_scene_no_memory(err);
    }
    for (int32_t i = 0; !st && i < s->n_muscle; i++)
        s->inputs[i] = (sn_tissue_muscle){s->muscle[i]->muscle.name, &s->muscle[i]->row, NULL};
    return st ? st : make_factors(s, run, err);
}

static sn_status need_values(sn_scene *s, const sn_run *run, sn_error *err)
{
    int32_t n_tissue = 1 + s->n_muscle, n_wanted = 0;
    bool *wanted = SN_NEW(bool, n_tissue);
    if (!s->field) s->field = SN_NEW(double, (size_t)n_tissue *(size_t)s->body.mesh.n_vert);
    if (!wanted || !s->field) {
        sn_release(wanted);
        return sn_scene_no_memory(err);
    }
    wanted[0] = !s->is_fat_solved;
    for (int32_t i = 0; i < s->n_muscle; i++) wanted[1 + i] = !s->muscle[i]->is_solved;
    for (int32_t i = 0; i < n_tissue; i++) n_wanted += wanted[i];
    sn_status st = SN_OK;
    if (n_wanted) {
        s->is_volume_kept = false;
        st = sn_tissue_solver_solve(s->solver, s->fat, wanted, run, s->field, err);
    }
    sn_release(wanted);
    if (st) return st;
    s->is_fat_solved = s->has_field = true;
    for (int32_t i = 0; i < s->n_muscle; i++) s->muscle[i]->is_solved = true;
    return SN_OK;
}

sn_status sn_scene_solve(sn_scene *s, const sn_run *run, sn_solve_report *report, sn_error *err)
{
    sn_solve_report r = {0};
    double start = sn_clock();
    if (s->n_muscle == 0) return sn_fail(err, SN_EINVAL, "the scene has no muscles: add_muscle first");
    sn_status st = need_body(s, run, &r.was_meshed, err);
    if (!st) st = need_rows(s, err);
    if (!st) st = need_solver(s, run, err);
    if (!st) st = need_factor(s, run, &r.was_factorized, err);
    double frames = sn_clock();
    if (!st) st = sn_run_step(run, "spreading frames", -1.0, err);
    if (!st) st = sn_run_each(run, s->n_muscle, need_tensor, s, err);
    r.seconds_frames = sn_clock() - frames;
    for (int32_t i = 0; !st && i < s->n_muscle; i++) s->inputs[i].tensor = s->muscle[i]->tensor;
    if (!st) st = need_values(s, run, err);
    if (!st && !s->is_volume_kept) st = sn_scene_keep_volumes(s, run, err);
    if (st) return st;
    r.tissue = *sn_tissue_solver_report(s->solver);
    r.seconds = sn_clock() - start;
    if (report) *report = r;
    return SN_OK;
}

const double *sn_scene_fields(const sn_scene *s)
{
    bool fresh = s->has_field && s->has_factor && s->is_fat_solved && s->is_volume_kept;
    for (int32_t i = 0; fresh && i < s->n_muscle; i++) fresh = s->muscle[i]->is_solved;
    return fresh ? s->field : NULL;
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
    sn_release(name);
    sn_release(muscle);
    if (st) sn_extraction_free(out);
    return st;
}
