#include "extract/part_fibers.h"

#include "base/alloc.h"
#include "extract/extraction_mirror.h"
#include "muscle/muscle_mirror.h"

#include <string.h>

void sn_part_fibers_free(sn_part_fibers *p)
{
    sn_fibers_free(&p->fibers);
    sn_tendons_free(&p->tendons);
    sn_release(p->tet);
    sn_release(p->source);
    if (p->image) sn_part_fibers_free(p->image);
    sn_release(p->image);
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

/* x: not mirrored. */
static sn_status build_part(sn_part_fibers *p, const sn_extraction *x, const sn_tet_mesh *input,
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

/* ---- mirrored extractions ---- */

static bool has_tets(const sn_extraction *x, int32_t tissue)
{
    return tissue >= 0 && sn_extraction_part_tets(x, tissue) > 0;
}

static sn_status build_image(sn_part_fibers *p, const sn_extraction *half, const sn_tet_mesh *input,
                             int32_t tissue, const sn_muscle *m, const sn_run *run, sn_error *err)
{
    p->image = SN_NEW_ZERO(sn_part_fibers, 1);
    if (!p->image) return sn_fail(err, SN_ENOMEM, "fibers: no memory");
    return build_part(p->image, half, input, tissue, m, run, err);
}

/* The fields of the half, then the tets of the whole. */
static sn_status build_mirrored(sn_part_fibers *p, const sn_extraction *x, const sn_tet_mesh *input,
                                int32_t tissue, const sn_muscle *m, const sn_run *run, sn_error *err)
{
    const sn_muscle *any = m;
    sn_muscle reflected = {0};
    sn_extraction half = sn_extraction_half_view(x);
    int32_t own = sn_extraction_half_tissue(x, tissue, false),
            image = sn_extraction_half_tissue(x, tissue, true);
    bool is_image = !has_tets(&half, own) && has_tets(&half, image);
    memset(p, 0, sizeof *p);
    sn_status st = find_muscle(x, tissue, &any, err);
    if (!st && m && is_image) st = sn_muscle_mirror(&reflected, m, &x->half.plane, m->name, err);
    if (!st && own < 0 && image < 0)
        st = sn_fail(err, SN_EINVAL, "part '%s' is empty: it has no fibers", x->name[tissue]);
    if (!st)
        st = build_part(p, &half, input, is_image ? image : own, reflected.name ? &reflected : m, run, err);
    if (!st && !is_image && image != own && has_tets(&half, image))
        st = build_image(p, &half, input, image, m, run, err);
    sn_muscle_free(&reflected);
    if (!st) {
        sn_release(p->tet);
        sn_release(p->source);
        p->tet = p->source = NULL;
        p->n_tet = 0;
        p->tissue = tissue;
        st = find_tets(p, x, err);
    }
    if (st) sn_part_fibers_free(p);
    return st;
}

sn_status sn_part_fibers_build(sn_part_fibers *p, const sn_extraction *x, const sn_tet_mesh *input,
                               int32_t tissue, const sn_muscle *m, const sn_run *run, sn_error *err)
{
    return x->half.n_tet > 0 ? build_mirrored(p, x, input, tissue, m, run, err)
                             : build_part(p, x, input, tissue, m, run, err);
}

sn_part_fibers sn_part_fibers_side(const sn_part_fibers *p, const sn_extraction *x, bool is_image)
{
    int32_t n_own = 0;
    while (n_own < p->n_tet && !sn_extraction_is_image(x, p->tet[n_own])) n_own++;
    sn_part_fibers side = is_image && p->image ? *p->image : *p;
    side.tissue = sn_extraction_half_tissue(x, p->tissue, is_image);
    side.source = is_image ? p->source + n_own : p->source;
    side.n_tet = is_image ? p->n_tet - n_own : n_own;
    side.tet = NULL;
    side.image = NULL;
    return side;
}

/* Where to look for what holds at a place of tet i of the part: the image of a tet shows its field reflected.
 */
typedef struct place {
    const sn_part_fibers *field;
    const sn_plane *mirror; /* NULL: none lies between */
    sn_vec3 p;
    int32_t source;
} place;

static place place_in(const sn_part_fibers *p, const sn_extraction *x, int32_t i, sn_vec3 at)
{
    place out = {p, NULL, at, p->source[i]};
    if (!sn_extraction_is_image(x, p->tet[i])) return out;
    if (p->image) out.field = p->image;
    out.mirror = &x->half.plane;
    out.p = sn_plane_reflect(out.mirror, at);
    return out;
}

static sn_vec3 shown(const place *at, sn_vec3 v)
{
    return at->mirror ? sn_plane_reflect_vector(at->mirror, v) : v;
}

void sn_part_fibers_sample(const sn_part_fibers *p, const sn_extraction *x, const sn_run *run,
                           sn_vec3 *centre, sn_vec3 *direction, double *u, bool *is_tendon)
{
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(run))
    for (int32_t i = 0; i < p->n_tet; i++) {
        double here;
        sn_vec3 c = sn_tet_mesh_centre(&x->mesh, p->tet[i]);
        place at = place_in(p, x, i, c);
        sn_vec3 d = sn_fibers_at(&at.field->fibers, at.source, at.p, &here);
        if (centre) centre[i] = c;
        if (direction) direction[i] = shown(&at, d);
        if (u) u[i] = here;
        if (is_tendon) is_tendon[i] = is_tendon_at(at.field, at.p);
    }
}

sn_status sn_part_fibers_check(const sn_part_fibers *p, const sn_extraction *x, sn_fibers_check *out,
                               sn_error *err)
{
    if (x->half.n_tet == 0) return sn_fibers_check_run(&p->fibers, out, err);
    *out = (sn_fibers_check){0};
    for (int i = 0; i < 2; i++) {
        sn_fibers_check c;
        sn_part_fibers side = sn_part_fibers_side(p, x, i == 1);
        if (side.n_tet == 0) continue;
        sn_status st = sn_fibers_check_run(&side.fibers, &c, err);
        if (st) return st;
        out->sinks += c.sinks;
        out->sources += c.sources;
        out->flipped += c.flipped;
        out->still += c.still;
        out->worst_turn_deg = fmax(out->worst_turn_deg, c.worst_turn_deg);
    }
    return SN_OK;
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
        place at = place_in(p, x, i, centre[i]);
        double c = sn_v3_dot(direction[i], shown(&at, sn_fibers_line_of_action(&at.field->fibers, at.p)));
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
    if (!st) st = sn_part_fibers_check(p, x, &out->check, err);
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
    bool is_all;
    int32_t tissue[2]; /* else these; -1: none */
    double *fiber, *tendon;
} fibers_job;

static sn_status find_fibers(void *user, int32_t i, const sn_run *run, sn_error *err)
{
    const fibers_job *j = user;
    sn_part_fibers p;
    if (!j->is_all && j->tissue[0] != 1 + i && j->tissue[1] != 1 + i) return SN_OK;
    sn_status st = build_part(&p, j->x, j->input, 1 + i, NULL, run, err);
    if (!st) put_part(&p, j->x, j->fiber, j->tendon);
    sn_part_fibers_free(&p);
    return st == SN_EINVAL ? SN_OK : st; /* empty, or no way to say where fibers run */
}

/* What stands at the half's tets, reflected, to their images; tissue >= 0: nothing outside of it. */
static void reflect_fibers(const sn_extraction *x, int32_t tissue, double *fiber, double *tendon)
{
    size_t n = (size_t)x->half.n_tet;
    for (size_t t = 0; t < n; t++) {
        sn_vec3 d = sn_plane_reflect_vector(&x->half.plane, sn_v3_load(fiber + 3 * t));
        sn_v3_store(fiber + 3 * (n + t), d);
        tendon[n + t] = tendon[t];
    }
    for (size_t t = 0; t < 2 * n && tissue >= 0; t++) {
        if (x->mesh.part[t] == tissue) continue;
        sn_v3_store(fiber + 3 * t, sn_v3(0, 0, 0));
        tendon[t] = 0.0;
    }
}

sn_status sn_extraction_fibers(const sn_extraction *x, const sn_tet_mesh *input, int32_t tissue,
                               const sn_run *run, double *fiber, double *tendon, sn_error *err)
{
    bool is_mirrored = x->half.n_tet > 0;
    sn_extraction half = is_mirrored ? sn_extraction_half_view(x) : *x;
    fibers_job job = {&half, input, tissue < 0, {tissue, -1}, fiber, tendon};
    for (int i = 0; i < 2 && tissue >= 0 && is_mirrored; i++)
        job.tissue[i] = sn_extraction_half_tissue(x, tissue, i == 1);
    memset(fiber, 0, 3 * (size_t)x->mesh.n_tet * sizeof *fiber);
    memset(tendon, 0, (size_t)x->mesh.n_tet * sizeof *tendon);
    sn_status st = sn_run_step(run, "finding fibers", 0.0, err);
    if (!st) st = sn_run_each(run, half.n_muscle, find_fibers, &job, err);
    if (!st && is_mirrored) reflect_fibers(x, tissue, fiber, tendon);
    return st;
}
