#include "scene/scene.h"

#include "base/alloc.h"
#include "scene/scene_private.h"

#include <string.h>

void sn_scene_report_free(sn_scene_report *r)
{
    for (int32_t i = 0; i < r->n_muscle; i++) sn_release(r->muscle[i].end);
    sn_release(r->muscle);
    memset(r, 0, sizeof *r);
}

/* Pieces of each tissue joined through faces: flood fill over the extraction. */
static sn_status count_components(const sn_extraction *x, sn_scene_report *r, sn_error *err)
{
    const sn_tet_mesh *m = &x->mesh;
    int32_t *adj = NULL, *stack = SN_NEW(int32_t, m->n_tet);
    bool *seen = SN_NEW_ZERO(bool, m->n_tet);
    sn_status st = stack && seen ? SN_OK : sn_fail(err, SN_ENOMEM, "report: no memory");
    if (!st) st = sn_tet_mesh_adjacency(m, &adj, err);
    for (int32_t t = 0; !st && t < m->n_tet; t++) {
        if (seen[t]) continue;
        int32_t top = 0;
        if (m->part[t] > 0) r->muscle[m->part[t] - 1].components++;
        seen[t] = true;
        stack[top++] = t;
        while (top > 0) {
            int32_t u = stack[--top];
            for (int k = 0; k < 4; k++) {
                int32_t w = adj[4 * (size_t)u + (size_t)k];
                if (w < 0 || seen[w] || m->part[w] != m->part[u]) continue;
                seen[w] = true;
                stack[top++] = w;
            }
        }
    }
    sn_release(adj);
    sn_release(stack);
    sn_release(seen);
    return st;
}

/* How many tissues each tet of the body holds: distinct parts among the tets cut from it, which are
 * consecutive. */
static void count_tissues(const sn_extraction *x, sn_scene_report *r)
{
    const sn_tet_mesh *m = &x->mesh;
    for (int32_t t = 0; t < m->n_tet;) {
        int32_t n = 0, end = t;
        while (end < m->n_tet && x->source[end] == x->source[t]) { /* a cell's tets are consecutive, too */
            bool is_new = true;
            for (int32_t u = t; u < end && is_new; u++) is_new = m->part[u] != m->part[end];
            n += is_new;
            end++;
        }
        r->tissues_per_tet[n < SN_TISSUE_HISTOGRAM ? n : SN_TISSUE_HISTOGRAM - 1]++;
        t = end;
    }
}

static void measure(const sn_scene *s, const sn_extraction *x, sn_scene_report *r)
{
    for (int32_t t = 0; t < x->mesh.n_tet; t++) {
        double v = sn_tet_mesh_tet_volume(&x->mesh, t);
        int32_t part = x->mesh.part[t];
        if (part == 0) {
            r->fat_volume += v;
        } else {
            r->muscle[part - 1].volume += v;
            r->muscle[part - 1].tets++;
        }
    }
    for (int32_t i = 0; i < s->n_muscle; i++) {
        r->muscle[i].length = sn_muscle_length(&s->muscle[i]->muscle);
        r->muscle[i].length_outside = s->muscle[i]->row.length_outside;
    }
}

/* ---- ends and fibers of each muscle, many at a time ---- */

static sn_status report_ends(sn_scene *s, int32_t i, const sn_run *run, sn_muscle_report *r, sn_error *err)
{
    scene_muscle *m = s->muscle[i];
    sn_measure *measure = NULL;
    r->n_head = m->muscle.n_head;
    r->end = SN_NEW_ZERO(sn_attachment, 2 * (size_t)r->n_head);
    sn_status st = r->end ? sn_scene_need_paths(m, err) : sn_scene_no_memory(err);
    if (!st) st = sn_measure_create(&measure, &s->body.mesh, s->field, 1 + s->n_muscle, 1 + i, run, err);
    if (!st) st = sn_attachments_find(&s->body, measure, &m->muscle, &m->paths, r->end, err);
    sn_measure_destroy(measure);
    return st;
}

static sn_status report_fibers(const sn_scene *s, const sn_extraction *x, int32_t i, const sn_run *run,
                               sn_muscle_report *r, sn_error *err)
{
    sn_part_fibers p;
    sn_status st = sn_part_fibers_build(&p, x, &s->body.mesh, 1 + i, NULL, run, err);
    if (st == SN_EINVAL) return SN_OK; /* empty, or heads that share no end */
    if (!st) st = sn_part_architecture_find(&p, x, run, &r->architecture, err);
    r->has_fibers = st == SN_OK;
    sn_part_fibers_free(&p);
    return st;
}

typedef struct report_job {
    sn_scene *scene;
    const sn_extraction *x;
    sn_scene_report *report;
} report_job;

static sn_status report_muscle(void *user, int32_t i, const sn_run *run, sn_error *err)
{
    const report_job *j = user;
    sn_status st = report_ends(j->scene, i, run, &j->report->muscle[i], err);
    return st ? st : report_fibers(j->scene, j->x, i, run, &j->report->muscle[i], err);
}

static sn_status report_muscles(sn_scene *s, const sn_extraction *x, const sn_run *run, sn_scene_report *r,
                                sn_error *err)
{
    report_job job = {s, x, r};
    sn_status st = sn_run_step(run, "measuring muscles", 0.0, err);
    return st ? st : sn_run_each(run, s->n_muscle, report_muscle, &job, err);
}

sn_status sn_scene_report_make(sn_scene *s, const sn_run *run, sn_scene_report *r, sn_error *err)
{
    sn_extraction x;
    sn_extraction_init(&x);
    sn_scene_report_free(r);
    sn_status st = sn_scene_extract(s, NULL, run, &x, err);
    if (!st && !(r->muscle = SN_NEW_ZERO(sn_muscle_report, s->n_muscle)))
        st = sn_fail(err, SN_ENOMEM, "report: no memory");
    if (!st) {
        r->n_muscle = s->n_muscle;
        measure(s, &x, r);
        count_tissues(&x, r);
        r->body = s->body_report;
        r->solve = s->solved;
        r->seconds_extract = x.seconds;
        st = count_components(&x, r, err);
        if (!st) st = report_muscles(s, &x, run, r, err);
    }
    sn_extraction_free(&x);
    if (st) sn_scene_report_free(r);
    return st;
}
