#include "skeleton/clearance.h"

#include "base/alloc.h"
#include "mesh/mesh_check.h"
#include "skeleton/spread.h"

#include <math.h>
#include <string.h>

enum {
    max_rounds = 80,
    patience = 12,   /* rounds without getting nearer to the margin              */
    max_halvings = 6 /* of a step that would turn a face                         */
};
static const double AIM = 1.0005;      /* margins: a little beyond, so that the last rounds get there      */
static const double REACH = 4.0;       /* how far a displacement spreads, in lengths of the longest        */
static const double FIRST_WEIGHT = 30; /* of vertices that must move over those that need not              */
static const double MOST_WEIGHT = 1e5; /* it doubles each round                                            */
static const double ON_SKIN_REL = 1e-12; /* of the skin's diagonal */
static const double MOVED_REL = 1e-6; /* of the diagonal                                                  */

/* ---- signed distances ---- */

typedef struct depth {
    double value;   /* > 0 inside                          */
    sn_vec3 inward; /* unit: the way that makes it greater */
} depth;

static depth depth_at(const sn_bvh *skin, double size, sn_vec3 p)
{
    sn_closest c = sn_bvh_closest(skin, p);
    double sign = sn_bvh_contains(skin, p) ? 1.0 : -1.0;
    sn_vec3 inward = sn_v3_scale(sign, sn_v3_sub(p, c.point));
    if (!(c.dist > ON_SKIN_REL * size)) /* rounding would choose the way */
        inward = sn_v3_scale(-1.0, sn_tri_mesh_face_normal(sn_bvh_mesh(skin), c.face));
    return (depth){sign * c.dist, sn_v3_unit(inward)};
}

static sn_status find_depths(const double *pos, int32_t n, const sn_bvh *skin, const sn_run *run, depth *out,
                             sn_error *err)
{
    double size = sn_box3_diagonal(sn_tri_mesh_bounds(sn_bvh_mesh(skin)));
#pragma omp parallel for schedule(dynamic, 64) num_threads(sn_run_threads(run))
    for (int32_t i = 0; i < n; i++)
        if (!sn_run_stopped(run)) out[i] = depth_at(skin, size, sn_v3_load(pos + 3 * (size_t)i));
    return sn_run_step(run, "measuring the distance to the skin", -1.0, err);
}

static sn_clearance summary(const double *pos, const depth *d, int32_t n, double margin)
{
    sn_clearance c = {.least = INFINITY};
    for (int32_t i = 0; i < n; i++) {
        c.n_out += d[i].value < 0.0;
        c.n_near += d[i].value < margin;
        if (!(d[i].value < c.least)) continue;
        c.least = d[i].value;
        c.at = sn_v3_load(pos + 3 * (size_t)i);
    }
    return c;
}

sn_status sn_clearance_measure(const sn_tri_mesh *bone, const sn_bvh *skin, double margin, const sn_run *run,
                               sn_clearance *out, sn_error *err)
{
    depth *d = SN_NEW(depth, bone->n_vert);
    *out = (sn_clearance){0};
    if (!d) return sn_fail(err, SN_ENOMEM, "no memory for the distances of %d vertices", bone->n_vert);
    sn_status st = find_depths(bone->pos, bone->n_vert, skin, run, d, err);
    if (!st) *out = summary(bone->pos, d, bone->n_vert, margin);
    sn_release(d);
    return st;
}

/* ---- the work of keeping clear ---- */

typedef struct keeper {
    const sn_bvh *skin;
    const sn_run *run;
    sn_tri_mesh now; /* the bone as it comes in, round by round */
    sn_spread *spread;
    depth *depth;                       /* n_vert                                     */
    double *wish, *weight, *move, *pos; /* 3 n_vert, n_vert, 3 n_vert, 3 n_vert       */
    double margin, best;                /* best: the greatest `least` of all rounds   */
    int32_t rounds, since_best;
    int64_t n_crossing; /* of the bone's faces, before */
} keeper;

static void keeper_free(keeper *k)
{
    sn_tri_mesh_free(&k->now);
    sn_spread_destroy(k->spread);
    sn_release(k->depth);
    sn_release(k->wish);
    sn_release(k->weight);
    sn_release(k->move);
    sn_release(k->pos);
}

static sn_status check_bone(keeper *k, const sn_tri_mesh *bone, sn_error *err)
{
    sn_mesh_check c;
    sn_status st = sn_mesh_check_run(&c, bone, k->run, err);
    if (st) return sn_fail_prefix(err, st, "bone: ");
    k->n_crossing = c.self_intersections;
    if (c.closed) return SN_OK;
    return sn_fail(err, SN_EINVAL, "bone: has %d boundary edges, need a closed surface", c.boundary_edges);
}

static sn_status keeper_reserve(keeper *k, const sn_tri_mesh *bone, sn_error *err)
{
    size_t n = (size_t)bone->n_vert;
    sn_status st = sn_tri_mesh_copy(&k->now, bone, err);
    if (!st) st = sn_spread_create(&k->spread, bone, err);
    if (st) return st;
    k->wish = SN_NEW(double, 3 * n);
    k->weight = SN_NEW(double, n);
    k->move = SN_NEW(double, 3 * n);
    k->pos = SN_NEW(double, 3 * n);
    if (k->wish && k->weight && k->move && k->pos) return SN_OK;
    return sn_fail(err, SN_ENOMEM, "bone: no memory to move %d vertices", bone->n_vert);
}

static sn_status fail_no_room(const keeper *k, sn_vec3 at, const char *why, sn_error *err)
{
    return sn_fail(err, SN_ESOLVE,
                   "no room: a margin of %g to the skin cannot be kept at (%g, %g, %g), where %s (round %d; "
                   "a margin of %g was reached)",
                   k->margin, at.x, at.y, at.z, why, k->rounds, k->best);
}

/* ---- one round ---- */

/* What every vertex wishes; returns the longest wish. */
static double make_wishes(keeper *k)
{
    double longest = 0.0, weight = fmin(FIRST_WEIGHT * pow(2.0, k->rounds), MOST_WEIGHT);
    for (int32_t i = 0; i < k->now.n_vert; i++) {
        const depth *d = &k->depth[i];
        double need = d->value < k->margin ? AIM * k->margin - d->value : 0.0;
        k->weight[i] = need > 0.0 ? weight : 1.0;
        sn_v3_store(k->wish + 3 * (size_t)i, sn_v3_scale(need, d->inward));
        longest = fmax(longest, need);
    }
    return longest;
}

static sn_vec3 normal_at(const sn_tri_mesh *m, const double *pos, int32_t f)
{
    const int32_t *v = m->face + 3 * (size_t)f;
    sn_vec3 a = sn_v3_load(pos + 3 * (size_t)v[0]);
    return sn_v3_cross(sn_v3_sub(sn_v3_load(pos + 3 * (size_t)v[1]), a),
                       sn_v3_sub(sn_v3_load(pos + 3 * (size_t)v[2]), a));
}

/* The first face that the step turns by more than 60 degrees, or -1. Faces without area are let be. */
static int32_t first_turned(const keeper *k)
{
    for (int32_t f = 0; f < k->now.n_face; f++) {
        sn_vec3 before = normal_at(&k->now, k->now.pos, f), after = normal_at(&k->now, k->pos, f);
        double size = sn_v3_len(before) * sn_v3_len(after);
        if (sn_v3_len(before) > 0.0 && !(sn_v3_dot(before, after) > 0.5 * size)) return f;
    }
    return -1;
}

/* As much of the move as turns no face. */
static sn_status take_step(keeper *k, sn_error *err)
{
    size_t n = 3 * (size_t)k->now.n_vert;
    double share = 1.0;
    for (int h = 0; h <= max_halvings; h++, share *= 0.5) {
        for (size_t i = 0; i < n; i++) k->pos[i] = k->now.pos[i] + share * k->move[i];
        int32_t f = first_turned(k);
        if (f >= 0 && h == max_halvings)
            return fail_no_room(k, sn_tri_mesh_point(&k->now, k->now.face[3 * (size_t)f]),
                                "the bone would turn inside out", err);
        if (f < 0) break;
    }
    memcpy(k->now.pos, k->pos, n * sizeof *k->pos);
    return SN_OK;
}

static sn_status one_round(keeper *k, sn_error *err)
{
    size_t n = 3 * (size_t)k->now.n_vert;
    sn_status st = sn_run_step(k->run, "keeping clear of the skin", (double)k->rounds / max_rounds, err);
    if (st) return st;
    double longest = make_wishes(k);
    memset(k->move, 0, n * sizeof *k->move);
    sn_spread_apply(k->spread, k->wish, k->weight, fmax(REACH * longest, sn_spread_edge(k->spread)), k->run,
                    k->move);
    st = sn_run_step(k->run, "keeping clear of the skin", (double)k->rounds / max_rounds, err);
    if (!st) st = take_step(k, err);
    k->rounds++;
    return st ? st : find_depths(k->now.pos, k->now.n_vert, k->skin, k->run, k->depth, err);
}

static sn_status all_rounds(keeper *k, sn_clearance *after, sn_error *err)
{
    sn_status st = SN_OK;
    k->best = after->least;
    while (!st && after->n_near > 0) {
        if (k->rounds == max_rounds || k->since_best == patience)
            return fail_no_room(k, after->at, "the bone comes no farther in", err);
        st = one_round(k, err);
        if (st) break;
        *after = summary(k->now.pos, k->depth, k->now.n_vert, k->margin);
        k->since_best++;
        if (!(after->least > k->best)) continue;
        k->best = after->least;
        k->since_best = 0;
    }
    return st;
}

/* ---- the result ---- */

static sn_status check_result(const keeper *k, sn_error *err)
{
    sn_mesh_check c;
    sn_status st = sn_mesh_check_run(&c, &k->now, k->run, err);
    if (st) return st;
    if (c.self_intersections <= k->n_crossing && sn_tri_mesh_volume(&k->now) > 0.0) return SN_OK;
    sn_vec3 at =
        sn_tri_mesh_point(&k->now, k->now.face[3 * (size_t)(c.first_pair[0] >= 0 ? c.first_pair[0] : 0)]);
    return sn_fail(err, SN_ESOLVE,
                   "no room: with a margin of %g to the skin the bone would cross itself at (%g, %g, %g)",
                   k->margin, at.x, at.y, at.z);
}

static void report_moves(const keeper *k, const sn_tri_mesh *bone, sn_clearance_report *r)
{
    double least = MOVED_REL * sn_box3_diagonal(sn_tri_mesh_bounds(bone));
    for (int32_t i = 0; i < bone->n_vert; i++) {
        double moved = sn_v3_dist(sn_tri_mesh_point(bone, i), sn_tri_mesh_point(&k->now, i));
        r->moved = fmax(r->moved, moved);
        r->n_moved += moved > least;
    }
    r->rounds = k->rounds;
}

static sn_status keep(keeper *k, sn_tri_mesh *bone, sn_clearance_report *r, sn_error *err)
{
    sn_status st = sn_tri_mesh_validate(bone, err);
    if (st) return sn_fail_prefix(err, st, "bone: ");
    k->depth = SN_NEW(depth, bone->n_vert);
    if (!k->depth) return sn_fail(err, SN_ENOMEM, "bone: no memory for %d vertices", bone->n_vert);
    st = check_bone(k, bone, err);
    if (!st) st = find_depths(bone->pos, bone->n_vert, k->skin, k->run, k->depth, err);
    if (st) return st;
    r->before = r->after = summary(bone->pos, k->depth, bone->n_vert, k->margin);
    if (r->before.n_near == 0) return SN_OK;
    st = keeper_reserve(k, bone, err);
    if (!st) st = all_rounds(k, &r->after, err);
    if (!st) st = check_result(k, err);
    if (st) return st;
    report_moves(k, bone, r);
    memcpy(bone->pos, k->now.pos, 3 * (size_t)bone->n_vert * sizeof *bone->pos);
    return SN_OK;
}

sn_status sn_clearance_keep(sn_tri_mesh *bone, const sn_bvh *skin, double margin, const sn_run *run,
                            sn_clearance_report *report, sn_error *err)
{
    sn_clearance_report own = {0};
    if (!(margin > 0.0 && isfinite(margin)))
        return sn_fail(err, SN_EINVAL, "margin to the skin is %g, need a number > 0", margin);
    keeper k = {.skin = skin, .run = run, .margin = margin};
    sn_tri_mesh_init(&k.now);
    sn_status st = keep(&k, bone, &own, err);
    keeper_free(&k);
    if (report) *report = own;
    return st;
}
