/* Solving: brings the fields up to date. What is to be solved is cut into items that run side by side: all
 * isotropic tissues by one factor, the factor that spreads frames, and each anisotropic muscle with its
 * frames, tensor and factor. */
#include "base/alloc.h"
#include "field/tensor.h"
#include "scene/scene.h"
#include "scene/scene_private.h"

#include <string.h>

static sn_status need_rows(sn_scene *s, sn_error *err)
{
    for (int32_t i = 0; i < s->n_muscle; i++) {
        scene_muscle *m = s->muscle[i];
        if (m->has_row) continue;
        sn_notes *notes = s->has_curves ? NULL : &s->notes; /* only tissue values changed: said before */
        sn_status st = sn_collocate(&m->muscle, &s->body, s->locator, &m->row, notes, err);
        if (st) return st;
        m->has_row = true;
    }
    return SN_OK;
}

static sn_status need_solver(sn_scene *s, const sn_run *run, sn_error *err)
{
    return s->solver ? SN_OK : sn_tissue_solver_create(&s->solver, &s->body, s->solver_kind, run, err);
}

static sn_status need_curves(sn_scene *s, sn_error *err)
{
    if (s->has_curves) return SN_OK;
    if (!s->inputs) s->inputs = SN_NEW(sn_tissue_muscle, s->n_muscle);
    if (!s->inputs) return sn_scene_no_memory(err);
    for (int32_t i = 0; i < s->n_muscle; i++)
        s->inputs[i] = (sn_tissue_muscle){s->muscle[i]->muscle.name, &s->muscle[i]->row, s->muscle[i]->id};
    sn_status st = sn_tissue_solver_set_curves(s->solver, s->inputs, s->n_muscle, s->alpha, err);
    s->has_curves = st == SN_OK;
    return st;
}

/* ---- items ---- */

/* A frame with eigenvalues (1, 1, 1) only says where e2 points: the muscle is isotropic. */
static bool is_anisotropic(const sn_muscle *m)
{
    const double *l = m->anisotropy.eigenvalue;
    return m->anisotropy.is_on && !(l[0] == 1.0 && l[1] == 1.0 && l[2] == 1.0);
}

enum { ITEM_SHARED = -2, ITEM_HARMONIC = -1 }; /* else a muscle */

typedef struct solve_job {
    sn_scene *scene;
    bool *is_shared; /* 1 + n_muscle: isotropic and wanted */
    int32_t *item, n_item;
    double *residual, *seconds_frame, *seconds_own; /* n_muscle */
    bool frames_wait;                               /* for the factor that spreads them   */
    bool *was_kept, *is_edited;                     /* 1 + n_muscle                       */
    sn_tissue_quick quick;                          /* of these two                       */
    sn_tissue_stamp *stamp;                         /* 1 + n_muscle                       */
    bool is_quick, is_fat_scaled;
} solve_job;

static const sn_tissue_quick *quick_of(const solve_job *job)
{
    return job->is_quick ? &job->quick : NULL;
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
    m->tensor_stamp++;
    return sn_muscle_blame(&m->muscle, -1, st, err);
}

static sn_status solve_own(const solve_job *job, int32_t i, const sn_run *run, sn_error *err)
{
    sn_scene *s = job->scene;
    scene_muscle *m = s->muscle[i];
    double start = sn_clock();
    sn_status st = m->has_tensor ? SN_OK : make_tensor(s, m, run, err);
    job->seconds_frame[i] = sn_clock() - start;
    start = sn_clock();
    const sn_tissue_own own = {i, m->tensor, m->tensor_stamp};
    if (!st)
        st = sn_tissue_solver_solve_own(s->solver, &own, quick_of(job), job->stamp, run, s->field,
                                        &job->residual[i], &m->was_factorized, err);
    job->seconds_own[i] = sn_clock() - start;
    return st;
}

static sn_status solve_shared(const solve_job *job, const sn_run *run, sn_error *err)
{
    sn_scene *s = job->scene;
    return sn_tissue_solver_solve(s->solver, s->fat, job->is_shared, quick_of(job), job->stamp, run, s->field,
                                  err);
}

/* Made before it is needed when a thread has nothing else to do: no harm then if it cannot be had. */
static sn_status make_harmonic(const solve_job *job, const sn_run *run, sn_error *err)
{
    sn_scene *s = job->scene;
    sn_status st = sn_tissue_solver_harmonic(s->solver, &s->harmonic, run, err);
    return job->frames_wait || st == SN_ECANCEL || st == SN_ELIMIT ? st : SN_OK;
}

static sn_status do_item(void *user, int32_t k, const sn_run *run, sn_error *err)
{
    const solve_job *job = user;
    if (job->item[k] == ITEM_SHARED) return solve_shared(job, run, err);
    if (job->item[k] == ITEM_HARMONIC) return make_harmonic(job, run, err);
    return solve_own(job, job->item[k], run, err);
}

static sn_status do_items(solve_job *job, const sn_run *run, sn_error *err)
{
    sn_status st = sn_run_each(run, job->n_item, do_item, job, err);
    job->n_item = 0;
    return st;
}

/* The factor that spreads frames takes as much memory as the shared one: where it is large it waits until
 * frames ask for it. */
#define MOST_UNKNOWNS_EAGER 200000

static bool is_thread_idle(const sn_scene *s, const sn_run *run)
{
    return !sn_tissue_solver_has_factor(s->solver) && sn_run_threads(run) > 1 &&
           sn_tissue_solver_report(s->solver)->unknowns <= MOST_UNKNOWNS_EAGER;
}

/* The long items first. Muscles whose frames wait for their factor come after it. */
static sn_status run_items(solve_job *job, const sn_run *run, sn_error *err)
{
    sn_scene *s = job->scene;
    bool any_shared = false;
    for (int32_t i = 0; i <= s->n_muscle; i++) any_shared = any_shared || job->is_shared[i];
    if (any_shared) job->item[job->n_item++] = ITEM_SHARED;
    bool is_idle = any_shared && is_thread_idle(s, run);
    if (!s->harmonic && (job->frames_wait || is_idle)) job->item[job->n_item++] = ITEM_HARMONIC;
    sn_status st = SN_OK;
    if (job->frames_wait) st = do_items(job, run, err);
    for (int32_t i = 0; i < s->n_muscle; i++)
        if (!s->muscle[i]->is_solved && is_anisotropic(&s->muscle[i]->muscle)) job->item[job->n_item++] = i;
    return st ? st : do_items(job, run, err);
}

/* ---- fields ---- */

static void drop_tensor(scene_muscle *m)
{
    sn_release(m->tensor);
    m->tensor = NULL;
    m->has_tensor = false;
}

/* A row for each tissue; rows that are there stay. */
static sn_status need_room(sn_scene *s, sn_error *err)
{
    size_t n_vert = (size_t)s->body.mesh.n_vert, n = 1 + (size_t)s->n_muscle;
    if (s->n_field >= (int32_t)n) return SN_OK;
    double *field = sn_realloc(s->field, n, n_vert * sizeof *field);
    if (!field) return sn_scene_no_memory(err);
    s->field = field;
    s->n_field = (int32_t)n;
    return SN_OK;
}

/* Of the largest tissue value. 1e-3 is promised; the change of a field is largest where its matrix changed,
 * which is looked at, but for what obtuse tets add. */
#define QUICK_REL 5e-4

static double largest_value(const sn_scene *s)
{
    double largest = s->fat;
    for (int32_t i = 0; i < s->n_muscle; i++)
        for (int32_t r = 0; r < s->muscle[i]->row.n_row; r++)
            largest = fmax(largest, s->muscle[i]->row.value[r]);
    return largest;
}

static void choose_tissues(solve_job *job, sn_scene *s)
{
    job->is_shared[0] = !s->is_fat_solved && !sn_tissue_solver_set_fat(s->solver, s->fat, s->field);
    job->is_fat_scaled = !s->is_fat_solved && !job->is_shared[0];
    job->is_edited[0] = s->is_fat_edited;
    job->stamp[0] = s->fat_stamp;
    for (int32_t i = 0; i < s->n_muscle; i++) {
        scene_muscle *m = s->muscle[i];
        bool is_own = is_anisotropic(&m->muscle);
        if (!is_own) drop_tensor(m);
        job->is_shared[1 + i] = !m->is_solved && !is_own;
        job->is_edited[1 + i] = m->is_edited;
        job->stamp[1 + i] = m->stamp;
        job->frames_wait = job->frames_wait || (is_own && !m->has_tensor && !s->harmonic);
    }
}

static sn_status begin_job(solve_job *job, sn_scene *s, bool is_quick, sn_error *err)
{
    size_t n = (size_t)s->n_muscle;
    *job = (solve_job){.scene = s,
                       .is_shared = SN_NEW_ZERO(bool, n + 1),
                       .item = SN_NEW(int32_t, n + 2),
                       .residual = SN_NEW_ZERO(double, n),
                       .seconds_frame = SN_NEW_ZERO(double, n),
                       .seconds_own = SN_NEW_ZERO(double, n),
                       .was_kept = SN_NEW_ZERO(bool, n + 1),
                       .is_edited = SN_NEW_ZERO(bool, n + 1),
                       .stamp = SN_NEW_ZERO(sn_tissue_stamp, n + 1),
                       .is_quick = is_quick};
    if (!job->is_shared || !job->item || !job->residual || !job->seconds_frame || !job->seconds_own ||
        !job->was_kept || !job->is_edited || !job->stamp)
        return sn_scene_no_memory(err);
    job->quick = (sn_tissue_quick){job->is_edited, QUICK_REL * largest_value(s), job->was_kept};
    sn_status st = need_room(s, err);
    if (!st) choose_tissues(job, s);
    return st;
}

static void end_job(solve_job *job)
{
    sn_release(job->is_shared);
    sn_release(job->item);
    sn_release(job->residual);
    sn_release(job->seconds_frame);
    sn_release(job->seconds_own);
    sn_release(job->was_kept);
    sn_release(job->is_edited);
    sn_release(job->stamp);
}

static void report_job(const solve_job *job, sn_solve_report *r)
{
    const sn_scene *s = job->scene;
    r->tissue = *sn_tissue_solver_report(s->solver);
    int32_t n_shared = 0;
    for (int32_t i = 0; i <= s->n_muscle; i++) {
        n_shared += job->is_shared[i];
        r->was_quick = r->was_quick || job->was_kept[i];
    }
    if (n_shared == 0) { /* the solver had nothing to do but for single muscles */
        r->tissue.residual = r->tissue.seconds_solve = r->tissue.seconds_factor = 0.0;
        r->tissue.n_solved = r->tissue.n_kept = 0;
        r->tissue.was_factorized = false;
    }
    r->tissue.n_solved += job->is_fat_scaled;
    r->was_factorized = r->tissue.was_factorized;
    for (int32_t i = 0; i < s->n_muscle; i++) {
        const scene_muscle *m = s->muscle[i];
        bool is_own = !m->is_solved && is_anisotropic(&m->muscle), is_kept = job->was_kept[1 + i];
        r->n_anisotropic += is_own && !is_kept;
        r->tissue.n_solved += is_own && !is_kept;
        r->tissue.n_kept += is_own && is_kept;
        r->tissue.residual = fmax(r->tissue.residual, job->residual[i]);
        r->seconds_frames += job->seconds_frame[i];
        r->seconds_anisotropic += job->seconds_own[i];
    }
}

/* Which fields are those of all curves now. */
static void mark_solved(const solve_job *job)
{
    sn_scene *s = job->scene;
    s->was_fat_solved = job->is_fat_scaled || (job->is_shared[0] && !job->was_kept[0]);
    if (!job->was_kept[0]) s->is_fat_solved = true;
    s->is_fat_edited = false;
    s->fat_stamp = job->stamp[0];
    for (int32_t i = 0; i < s->n_muscle; i++) {
        scene_muscle *m = s->muscle[i];
        m->was_solved = !m->is_solved && !job->was_kept[1 + i];
        if (!job->was_kept[1 + i]) m->is_solved = true;
        m->is_edited = false;
        m->stamp = job->stamp[1 + i];
    }
    s->is_quick = true;
}

/* Any row that was to be written may hold anything. */
static void mark_failed(const solve_job *job)
{
    sn_scene *s = job->scene;
    if (job->is_shared[0]) {
        s->is_fat_edited = true;
        s->fat_stamp = 0;
    }
    for (int32_t i = 0; i < s->n_muscle; i++)
        if (!s->muscle[i]->is_solved) {
            s->muscle[i]->is_edited = true;
            s->muscle[i]->stamp = 0;
        }
}

static bool is_stale(const sn_scene *s)
{
    bool stale = !s->is_fat_solved || !s->has_curves;
    for (int32_t i = 0; i < s->n_muscle; i++) stale = stale || !s->muscle[i]->is_solved;
    return stale;
}

static sn_status need_values(sn_scene *s, bool is_quick, const sn_run *run, sn_solve_report *r, sn_error *err)
{
    bool has_fields = is_quick ? s->is_quick : !is_stale(s);
    if (has_fields) {
        *r = s->solved;
        r->was_factorized = r->tissue.was_factorized = false;
        return SN_OK;
    }
    s->is_volume_kept = false;
    s->field_revision++;
    for (int32_t i = 0; i < s->n_muscle; i++) s->muscle[i]->was_factorized = false;
    solve_job job;
    sn_status st = begin_job(&job, s, is_quick, err);
    if (!st) st = sn_run_step(run, "solving", -1.0, err);
    if (!st) st = run_items(&job, run, err);
    if (!st) {
        report_job(&job, r);
        s->solved = *r;
        mark_solved(&job);
    } else if (job.is_shared) {
        mark_failed(&job);
    }
    end_job(&job);
    return st;
}

static sn_status solve(sn_scene *s, bool is_quick, const sn_run *run, sn_solve_report *report, sn_error *err)
{
    sn_solve_report r = {0};
    double start = sn_clock();
    if (s->n_muscle == 0) return sn_fail(err, SN_EINVAL, "the scene has no muscles: add_muscle first");
    sn_status st = sn_scene_need_body(s, run, &r.was_meshed, err);
    bool was_meshed = r.was_meshed;
    if (!st) st = need_rows(s, err);
    if (!st) st = need_solver(s, run, err);
    if (!st) st = need_curves(s, err);
    if (!st) st = need_values(s, is_quick, run, &r, err);
    if (!st && !s->is_volume_kept) st = sn_scene_keep_volumes(s, run, err);
    if (st) return st;
    r.seconds = sn_clock() - start;
    r.was_meshed = was_meshed;
    if (report) *report = r;
    return SN_OK;
}

sn_status sn_scene_solve(sn_scene *s, const sn_run *run, sn_solve_report *report, sn_error *err)
{
    return solve(s, false, run, report, err);
}

sn_status sn_scene_solve_quick(sn_scene *s, const sn_run *run, sn_solve_report *report, sn_error *err)
{
    return solve(s, true, run, report, err);
}

bool sn_scene_was_solved(const sn_scene *s, int32_t i_tissue)
{
    return i_tissue == 0 ? s->was_fat_solved : s->muscle[i_tissue - 1]->was_solved;
}

bool sn_scene_was_factorized(const sn_scene *s, int32_t i_tissue)
{
    return i_tissue > 0 && s->muscle[i_tissue - 1]->was_factorized;
}
