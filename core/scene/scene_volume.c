/* Volumes: scaling the tissue values of a muscle scales its own field and no other's, so a wanted volume
 * needs no solve. */
#include "scene/scene.h"

#include "base/alloc.h"
#include "field/measure.h"
#include "scene/scene_private.h"

#include <string.h>

#define KEPT_REL 1e-5   /* how near to its volume each kept muscle comes; 0.1 % is promised */
#define ENOUGH_REL 5e-4 /* what is taken when the rounds come no nearer */
#define NEARING 0.8     /* in so many rounds the distance must shrink to this part of it */
enum { max_sweeps = 400, patience = 16 };

static sn_status create_measure(const sn_scene *s, int32_t i_muscle, const sn_run *run, sn_measure **m,
                                sn_error *err)
{
    return sn_measure_create(m, &s->body.mesh, s->field, 1 + s->n_muscle, 1 + i_muscle, run, err);
}

static void scale_muscle(sn_scene *s, int32_t i_muscle, double factor)
{
    scene_muscle *m = s->muscle[i_muscle];
    size_t n = (size_t)s->body.mesh.n_vert;
    double *f = s->field + (size_t)(1 + i_muscle) * n;
    sn_muscle_scale_tissue(&m->muscle, factor);
    for (int32_t r = 0; r < m->row.n_row; r++) m->row.value[r] *= factor;
    for (size_t v = 0; v < n; v++) f[v] *= factor;
    s->revision++;
}

static bool others_kept(const sn_scene *s, int32_t i_muscle)
{
    bool any = false;
    for (int32_t i = 0; i < s->n_muscle; i++) any = any || (i != i_muscle && s->muscle[i]->kept_volume > 0.0);
    return any;
}

/* Scales one muscle to a volume; *gap receives how far off it was, relative. */
static sn_status fit(sn_scene *s, int32_t i_muscle, double volume, const sn_run *run, double *gap,
                     sn_error *err)
{
    sn_measure *m = NULL;
    double scale = 1.0;
    sn_status st = create_measure(s, i_muscle, run, &m, err);
    if (!st) {
        *gap = fabs(sn_measure_volume(m, 1.0, run) - volume) / volume;
        if (*gap > KEPT_REL) st = sn_measure_find_scale(m, volume, run, &scale, err);
    }
    sn_measure_destroy(m);
    if (!st && scale != 1.0) scale_muscle(s, i_muscle, scale);
    if (st == SN_EINVAL && err && others_kept(s, i_muscle)) {
        sn_error alone = *err;
        st = sn_fail(err, st, "%s, and less beside the volumes that other muscles keep", alone.msg);
    }
    return sn_muscle_blame(&s->muscle[i_muscle]->muscle, -1, st, err);
}

/* ---- keeping several at once ----
 *
 * One after another, over and over: each has what it wants for a moment, what it takes from the others grows
 * less with each round. In the logarithms of the scales this is coordinate ascent on a concave function
 * (semi-discrete optimal transport), so it ends in the one solution when there is one. */

/* *i_worst: the muscle that was farthest off, by *worst. */
static sn_status sweep(sn_scene *s, const sn_run *run, int32_t *i_worst, double *worst, sn_error *err)
{
    *worst = 0.0;
    for (int32_t i = 0; i < s->n_muscle; i++) {
        double gap = 0.0;
        if (!(s->muscle[i]->kept_volume > 0.0)) continue;
        sn_status st = sn_run_step(run, "keeping volumes", -1.0, err);
        if (!st) st = fit(s, i, s->muscle[i]->kept_volume, run, &gap, err);
        if (st) return st;
        if (gap > *worst) *i_worst = i;
        *worst = fmax(*worst, gap);
    }
    return SN_OK;
}

/* Says how much the muscle has when all others have theirs. */
static sn_status fail_beside(sn_scene *s, int32_t i_muscle, const sn_run *run, sn_error *err)
{
    double wanted = s->muscle[i_muscle]->kept_volume, gap, worst, has = 0.0;
    int32_t i_worst;
    sn_measure *m = NULL;
    s->muscle[i_muscle]->kept_volume = 0.0;
    sn_status st = SN_OK;
    for (int i = 0; i < patience && !st; i++) st = sweep(s, run, &i_worst, &worst, err);
    s->muscle[i_muscle]->kept_volume = wanted;
    if (!st) st = create_measure(s, i_muscle, run, &m, err);
    if (st) return st;
    has = sn_measure_volume(m, 1.0, run);
    gap = fabs(has - wanted) / wanted;
    sn_measure_destroy(m);
    return sn_fail(
        err, SN_EINVAL,
        "muscle '%s': there is no room for a volume of %g beside those that other muscles keep: about %g "
        "is possible (%.2g %% off)",
        s->muscle[i_muscle]->muscle.name, wanted, has, 100.0 * gap);
}

/* i_asked: the muscle whose volume was asked for, -1: none, an edit is at fault. */
static sn_status sweep_all(sn_scene *s, int32_t i_asked, const sn_run *run, sn_error *err)
{
    double worst = INFINITY, before = INFINITY;
    int32_t i_worst = 0;
    bool is_nearing = true;
    for (int i = 0; i < max_sweeps && worst > KEPT_REL && is_nearing; i++) {
        sn_status st = sweep(s, run, &i_worst, &worst, err);
        if (st) return st;
        if (i % patience != patience - 1) continue;
        is_nearing = worst <= NEARING * before;
        before = worst;
    }
    return worst <= ENOUGH_REL ? SN_OK : fail_beside(s, i_asked >= 0 ? i_asked : i_worst, run, err);
}

/* The tissue values of all kept muscles, to go back to. */
static sn_status save_tissue(const sn_scene *s, double **out, sn_error *err)
{
    size_t n = 0, at = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (int32_t i = 0; i < s->n_muscle; i++)
            for (int32_t h = 0; h < s->muscle[i]->muscle.n_head; h++) {
                const sn_head *head = &s->muscle[i]->muscle.head[h];
                if (pass) memcpy(*out + at, head->tissue, (size_t)head->n_point * sizeof **out);
                at += (size_t)head->n_point;
            }
        n = at;
        at = 0;
        if (!pass && !(*out = SN_NEW(double, n))) return sn_scene_no_memory(err);
    }
    return SN_OK;
}

static void restore_tissue(sn_scene *s, const double *tissue)
{
    for (int32_t i = 0; i < s->n_muscle; i++) {
        for (int32_t h = 0; h < s->muscle[i]->muscle.n_head; h++) {
            sn_head *head = &s->muscle[i]->muscle.head[h];
            memcpy(head->tissue, tissue, (size_t)head->n_point * sizeof *tissue);
            tissue += head->n_point;
        }
        if (s->muscle[i]->kept_volume > 0.0) sn_scene_stale_field(s, i);
    }
}

static sn_status keep(sn_scene *s, int32_t i_asked, const sn_run *run, sn_error *err)
{
    double *before = NULL;
    bool any = false;
    for (int32_t i = 0; i < s->n_muscle; i++) any = any || s->muscle[i]->kept_volume > 0.0;
    if (any) {
        sn_status st = save_tissue(s, &before, err);
        if (!st) st = sweep_all(s, i_asked, run, err);
        if (st && before) restore_tissue(s, before);
        sn_release(before);
        if (st) return st;
    }
    s->is_volume_kept = true;
    return SN_OK;
}

sn_status sn_scene_keep_volumes(sn_scene *s, const sn_run *run, sn_error *err)
{
    return keep(s, -1, run, err);
}

/* ---- asked for ---- */

sn_status sn_scene_muscle_volume(sn_scene *s, int32_t i_muscle, const sn_run *run, double *volume,
                                 sn_error *err)
{
    sn_measure *m = NULL;
    sn_status st = sn_scene_check_muscle(s, i_muscle, err);
    if (!st) st = sn_scene_solve(s, run, NULL, err);
    if (!st) st = create_measure(s, i_muscle, run, &m, err);
    if (!st) *volume = sn_measure_volume(m, 1.0, run);
    sn_measure_destroy(m);
    return st;
}

sn_status sn_scene_set_volume(sn_scene *s, int32_t i_muscle, double volume, const sn_run *run, sn_error *err)
{
    sn_status st = sn_scene_check_muscle(s, i_muscle, err);
    if (st) return st;
    scene_muscle *m = s->muscle[i_muscle];
    if (!(volume > 0.0 && isfinite(volume)))
        return sn_fail(err, SN_EINVAL, "muscle '%s': volume is %g, need > 0", m->muscle.name, volume);
    st = sn_scene_solve(s, run, NULL, err);
    if (st) return st;
    double old = m->kept_volume; /* kept for now at least, against what the others take back */
    m->kept_volume = volume;
    st = keep(s, i_muscle, run, err);
    if (st || !(old > 0.0)) m->kept_volume = old;
    return st;
}

sn_status sn_scene_set_preserve_volume(sn_scene *s, int32_t i_muscle, bool is_kept, const sn_run *run,
                                       sn_error *err)
{
    double volume = 0.0;
    sn_status st = sn_scene_check_muscle(s, i_muscle, err);
    if (!st && is_kept) st = sn_scene_muscle_volume(s, i_muscle, run, &volume, err);
    if (st) return st;
    if (is_kept && !(volume > 0.0))
        return sn_fail(err, SN_EINVAL, "muscle '%s': it is empty, there is no volume to keep",
                       s->muscle[i_muscle]->muscle.name);
    s->muscle[i_muscle]->kept_volume = volume;
    return SN_OK;
}

double sn_scene_kept_volume(const sn_scene *s, int32_t i_muscle)
{
    return s->muscle[i_muscle]->kept_volume;
}
