#include "extract/part_fibers.h"

#include "base/alloc.h"

#include <string.h>

void sn_part_fibers_free(sn_part_fibers *p)
{
    sn_fibers_free(&p->fibers);
    sn_tendons_free(&p->tendons);
    sn_release(p->tet);
    sn_release(p->source);
    memset(p, 0, sizeof *p);
}

static sn_status find_tets(sn_part_fibers *p, const sn_extraction *x, sn_error *err)
{
    int32_t n = sn_extraction_part_tets(x, p->tissue);
    p->tet = SN_NEW(int32_t, n);
    p->source = SN_NEW(int32_t, n);
    if (!p->tet || !p->source) return sn_fail(err, SN_ENOMEM, "fibers: no memory for %d tets", n);
    for (int32_t t = 0; t < x->mesh.n_tet; t++) {
        if (x->mesh.part[t] != p->tissue) continue;
        p->tet[p->n_tet] = t;
        p->source[p->n_tet++] = x->source[t];
    }
    return SN_OK;
}

/* What the part has of each input tet. */
static double *find_shares(const sn_part_fibers *p, const sn_extraction *x, const sn_tet_mesh *input)
{
    double *share = SN_NEW_ZERO(double, input->n_tet);
    for (int32_t i = 0; share && i < p->n_tet; i++)
        share[p->source[i]] += sn_tet_mesh_tet_volume(&x->mesh, p->tet[i]);
    for (int32_t t = 0; share && t < input->n_tet; t++)
        if (share[t] > 0.0) share[t] = fmin(share[t] / sn_tet_mesh_tet_volume(input, t), 1.0);
    return share;
}

static sn_status find_muscle(const sn_extraction *x, int32_t tissue, const sn_muscle **m, sn_error *err)
{
    if (*m) return SN_OK;
    if (x->n_muscle > 0 && tissue == 0)
        return sn_fail(err, SN_EINVAL, "part '%s' is no muscle: it has no fibers", x->name[0]);
    if (tissue < 1 || tissue > x->n_muscle)
        return sn_fail(err, SN_EINVAL, "part '%s' has no curve that fibers could follow: give one",
                       x->name[tissue]);
    *m = &x->muscle[tissue - 1];
    return SN_OK;
}

sn_status sn_part_fibers_build(sn_part_fibers *p, const sn_extraction *x, const sn_tet_mesh *input,
                               int32_t tissue, const sn_muscle *m, const sn_run *run, sn_error *err)
{
    memset(p, 0, sizeof *p);
    p->tissue = tissue;
    double *share = NULL;
    sn_status st = find_muscle(x, tissue, &m, err);
    if (!st) st = find_tets(p, x, err);
    if (!st && !(share = find_shares(p, x, input))) st = sn_fail(err, SN_ENOMEM, "fibers: no memory");
    if (!st) st = sn_fibers_build(&p->fibers, input, share, m, run, err);
    if (!st) {
        p->has_tendon = sn_muscle_has_tendon(m);
        st = sn_tendons_find(&p->tendons, input, share, m, &p->fibers.paths, err);
    }
    sn_release(share);
    if (st) sn_part_fibers_free(p);
    return st;
}

static bool is_tendon_at(const sn_part_fibers *p, sn_vec3 at)
{
    return p->has_tendon && sn_tendons_at(&p->tendons, &p->fibers.paths, at) > 0.0;
}

void sn_part_fibers_sample(const sn_part_fibers *p, const sn_extraction *x, const sn_run *run,
                           sn_vec3 *centre, sn_vec3 *direction, double *u, bool *is_tendon)
{
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(run))
    for (int32_t i = 0; i < p->n_tet; i++) {
        double here;
        sn_vec3 c = sn_tet_mesh_centre(&x->mesh, p->tet[i]),
                d = sn_fibers_at(&p->fibers, p->source[i], c, &here);
        if (centre) centre[i] = c;
        if (direction) direction[i] = d;
        if (u) u[i] = here;
        if (is_tendon) is_tendon[i] = is_tendon_at(p, c);
    }
}

/* ---- architecture ---- */

enum { n_measured_lines = 400 };

static double mean_length(const sn_polylines *lines)
{
    double sum = 0.0;
    for (size_t i = 0; i < lines->n_line; i++) sum += sn_polylines_length(lines, i);
    return lines->n_line ? sum / (double)lines->n_line : 0.0;
}

static sn_status measure_belly(const sn_part_fibers *p, const sn_extraction *x, const sn_run *run,
                               sn_part_architecture *out, sn_error *err)
{
    sn_vec3 *centre = SN_NEW(sn_vec3, p->n_tet), *direction = SN_NEW(sn_vec3, p->n_tet);
    bool *is_tendon = SN_NEW(bool, p->n_tet);
    sn_status st = centre && direction && is_tendon ? SN_OK : sn_fail(err, SN_ENOMEM, "fibers: no memory");
    if (!st) sn_part_fibers_sample(p, x, run, centre, direction, NULL, is_tendon);
    for (int32_t i = 0; i < p->n_tet && !st; i++) {
        double volume = sn_tet_mesh_tet_volume(&x->mesh, p->tet[i]);
        out->volume += volume;
        if (is_tendon[i]) continue;
        double c = sn_v3_dot(direction[i], sn_fibers_line_of_action(&p->fibers, centre[i]));
        out->belly_volume += volume;
        out->pennation_deg += volume * acos(fmin(fmax(c, -1.0), 1.0)) * (180.0 / 3.14159265358979323846);
    }
    if (out->belly_volume > 0.0) out->pennation_deg /= out->belly_volume;
    sn_release(centre);
    sn_release(direction);
    sn_release(is_tendon);
    return st;
}

sn_status sn_part_architecture_find(const sn_part_fibers *p, const sn_extraction *x, const sn_run *run,
                                    sn_part_architecture *out, sn_error *err)
{
    sn_polylines lines;
    sn_polylines_init(&lines, false);
    memset(out, 0, sizeof *out);
    sn_status st = measure_belly(p, x, run, out, err);
    if (!st) st = sn_part_fibers_lines(p, x, n_measured_lines, run, &lines, err);
    if (!st) st = sn_fibers_check_run(&p->fibers, &out->check, err);
    if (!st) {
        out->fiber_length = mean_length(&lines);
        if (out->fiber_length > 0.0)
            out->pcsa = out->belly_volume * cos(out->pennation_deg * (3.14159265358979323846 / 180.0)) /
                        out->fiber_length;
    }
    sn_polylines_free(&lines);
    return st;
}

/* ---- all muscles ---- */

static void put_part(const sn_part_fibers *p, const sn_extraction *x, double *fiber, double *tendon)
{
    for (int32_t i = 0; i < p->n_tet; i++) {
        sn_vec3 c = sn_tet_mesh_centre(&x->mesh, p->tet[i]);
        sn_v3_store(fiber + 3 * (size_t)p->tet[i], sn_fibers_at(&p->fibers, p->source[i], c, NULL));
        tendon[p->tet[i]] = is_tendon_at(p, c) ? 1.0 : 0.0;
    }
}

typedef struct fibers_job {
    const sn_extraction *x;
    const sn_tet_mesh *input;
    int32_t tissue; /* < 0: all */
    double *fiber, *tendon;
} fibers_job;

static sn_status find_fibers(void *user, int32_t i, const sn_run *run, sn_error *err)
{
    const fibers_job *j = user;
    sn_part_fibers p;
    if (j->tissue >= 0 && j->tissue != 1 + i) return SN_OK;
    sn_status st = sn_part_fibers_build(&p, j->x, j->input, 1 + i, NULL, run, err);
    if (!st) put_part(&p, j->x, j->fiber, j->tendon);
    sn_part_fibers_free(&p);
    return st == SN_EINVAL ? SN_OK : st; /* empty, or no way to say where fibers run */
}

sn_status sn_extraction_fibers(const sn_extraction *x, const sn_tet_mesh *input, int32_t tissue,
                               const sn_run *run, double *fiber, double *tendon, sn_error *err)
{
    fibers_job job = {x, input, tissue, fiber, tendon};
    memset(fiber, 0, 3 * (size_t)x->mesh.n_tet * sizeof *fiber);
    memset(tendon, 0, (size_t)x->mesh.n_tet * sizeof *tendon);
    sn_status st = sn_run_step(run, "finding fibers", 0.0, err);
    return st ? st : sn_run_each(run, x->n_muscle, find_fibers, &job, err);
}
