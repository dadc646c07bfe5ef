#include "skeleton/icp_rigid.h"

#include "base/alloc.h"
#include "base/dense.h"

#include <string.h>

static const char STEP[] = "rigid ICP";
static const double EXACT_REL = 1e-10;    /* of the size: the residual is rounding             */
static const double ACROSS_LEAST = 0.002; /* weight of a distance across the target's normal   */
static const double MOST_GROWTH = 2.0;    /* of the scale from the start, either way           */
static const double MOST_TURN = 60.0;     /* degrees from the start                            */
static const double NEAR = 0.9;           /* of these limits: beyond it a result is none       */
static const double DEG = 3.14159265358979323846 / 180.0;
enum { N_HALVED = 6 }; /* times that a step is halved before it is given up */

/* ---- placements: x -> scale R x + t, R by a unit quaternion (w, v) ---- */

typedef struct placement {
    double scale, w;
    sn_vec3 v, t;
} placement;

static sn_vec3 turn(double w, sn_vec3 v, sn_vec3 x)
{
    sn_vec3 c = sn_v3_scale(2.0, sn_v3_cross(v, x));
    return sn_v3_add(sn_v3_mad(x, w, c), sn_v3_cross(v, c));
}

static placement from_transform(const sn_transform *t)
{
    sn_vec3 axis = sn_v3_unit(t->axis);
    double half = sn_v3_len2(axis) > 0.0 ? 0.5 * DEG * t->angle_deg : 0.0;
    return (placement){t->scale, cos(half), sn_v3_scale(sin(half), axis), t->translate};
}

static sn_transform to_transform(const placement *p)
{
    double s = sn_v3_len(p->v);
    return (sn_transform){p->scale, sn_v3_unit(p->v), 2.0 * atan2(s, p->w) / DEG, p->t};
}

/* About g: a turn by the vector `spin`, growth by the factor `grow`, then a shift. */
static placement moved(const placement *p, sn_vec3 g, sn_vec3 spin, double grow, sn_vec3 shift)
{
    double angle = sn_v3_len(spin), cw = cos(0.5 * angle);
    sn_vec3 cv = angle > 0.0 ? sn_v3_scale(sin(0.5 * angle) / angle, spin) : spin;
    placement q = {.scale = p->scale * grow, .w = cw * p->w - sn_v3_dot(cv, p->v)};
    q.v = sn_v3_add(sn_v3_mad(sn_v3_scale(cw, p->v), p->w, cv), sn_v3_cross(cv, p->v));
    double unit = 1.0 / sqrt(q.w * q.w + sn_v3_len2(q.v));
    q.w *= unit;
    q.v = sn_v3_scale(unit, q.v);
    q.t = sn_v3_add(sn_v3_add(g, shift), sn_v3_scale(grow, turn(cw, cv, sn_v3_sub(p->t, g))));
    return q;
}

/* ---- one step ---- */

typedef struct rigid {
    sn_icp_pairs pairs;
    sn_icp_options opt;
    const sn_run *run;
    double *pos; /* the piece where it is now */
    placement first, at;
    double across;
    bool with_scale;
} rigid;

typedef struct step { /* about g */
    sn_vec3 g, spin, shift;
    double grow; /* less 1 */
} step;

static void place(rigid *r, const placement *p)
{
    const sn_tri_mesh *m = r->pairs.piece;
    for (int32_t i = 0; i < m->n_vert; i++) {
        sn_vec3 x = turn(p->w, p->v, sn_tri_mesh_point(m, i));
        sn_v3_store(r->pos + 3 * (size_t)i, sn_v3_mad(p->t, p->scale, x));
    }
    sn_icp_pairs_find(&r->pairs, r->pos, r->run);
}

/* The middle of the paired points and their mean distance from it. */
static sn_vec3 middle(const rigid *r, double *radius)
{
    const sn_icp_pairs *p = &r->pairs;
    sn_vec3 g = sn_v3(0, 0, 0);
    double sum = 0.0;
    for (int32_t i = 0; i < p->n; i++)
        g = sn_v3_mad(g, p->weight[i] / p->kept, sn_v3_load(r->pos + 3 * (size_t)i));
    for (int32_t i = 0; i < p->n; i++)
        sum += p->weight[i] / p->kept * sn_v3_len2(sn_v3_sub(sn_v3_load(r->pos + 3 * (size_t)i), g));
    *radius = sqrt(sum);
    return g;
}

/* Adds one direction d of a pair's distance: the motion (spin, shift, growth) changes it by row . z. */
static void add_row(double a[49], double z[7], int n, sn_vec3 q, sn_vec3 d, double weight, double e)
{
    sn_vec3 c = sn_v3_cross(q, d);
    const double row[7] = {c.x, c.y, c.z, d.x, d.y, d.z, sn_v3_dot(q, d)};
    for (int j = 0; j < n; j++) {
        for (int k = 0; k < n; k++) a[j * n + k] += weight * row[j] * row[k];
        z[j] -= weight * e * row[j];
    }
}

/* Lengths are in units of the piece's radius, so that the system has none. */
static sn_status solve_step(const rigid *r, step *s, sn_error *err)
{
    const sn_icp_pairs *p = &r->pairs;
    int n = r->with_scale ? 7 : 6;
    double a[49] = {0.0}, z[7] = {0.0}, radius, trace = 0.0;
    s->g = middle(r, &radius);
    if (!(radius > 0.0)) return sn_fail(err, SN_ESOLVE, "%s: the points with a match are all one", STEP);
    for (int32_t i = 0; i < p->n; i++) {
        if (!(p->weight[i] > 0.0)) continue;
        sn_vec3 x = sn_v3_load(r->pos + 3 * (size_t)i), d = sn_v3_load(p->normal + 3 * (size_t)i);
        sn_vec3 q = sn_v3_scale(1.0 / radius, sn_v3_sub(x, s->g));
        sn_vec3 e = sn_v3_scale(1.0 / radius, sn_v3_sub(x, sn_v3_load(p->point + 3 * (size_t)i)));
        double w = p->weight[i] / p->kept;
        add_row(a, z, n, q, d, w * (1.0 - r->across), sn_v3_dot(d, e));
        add_row(a, z, n, q, sn_v3(1, 0, 0), w * r->across, e.x);
        add_row(a, z, n, q, sn_v3(0, 1, 0), w * r->across, e.y);
        add_row(a, z, n, q, sn_v3(0, 0, 1), w * r->across, e.z);
    }
    for (int j = 0; j < n; j++) trace += a[j * n + j];
    for (int j = 0; j < n; j++) a[j * n + j] += 1e-9 * trace; /* points on a line may spin freely */
    sn_status st = sn_dense_solve_spd(a, n, z, 1, err);
    if (st) return sn_fail_prefix(err, st, "%s: ", STEP);
    s->spin = sn_v3(z[0], z[1], z[2]);
    s->shift = sn_v3_scale(radius, sn_v3(z[3], z[4], z[5]));
    s->grow = n == 7 ? z[6] : 0.0;
    return SN_OK;
}

/* A piece that shrinks to a point lies on any surface; one that turns around has lost its way. */
static bool is_near_start(const rigid *r, const placement *p, double share_of_limit)
{
    double grown = fabs(log(p->scale / r->first.scale));
    double half = fabs(r->first.w * p->w + sn_v3_dot(r->first.v, p->v)); /* cosine of half the turn */
    return grown <= share_of_limit * log(MOST_GROWTH) && half >= cos(0.5 * DEG * share_of_limit * MOST_TURN);
}

/* Goes the part of the step, halved as often as needed, that lowers the residual; stays when there is none.
 */
static void descend(rigid *r, const step *s)
{
    double before = r->pairs.residual, part = fmin(1.0, 0.5 / (sn_v3_len(s->spin) + 1e-300));
    part = fmin(part, 0.3 / (fabs(s->grow) + 1e-300));
    for (int k = 0; k < N_HALVED; k++, part *= 0.5) {
        placement next = moved(&r->at, s->g, sn_v3_scale(part, s->spin), 1.0 + part * s->grow,
                               sn_v3_scale(part, s->shift));
        if (!is_near_start(r, &next, 1.0)) continue;
        place(r, &next);
        if (!sn_icp_pairs_suffice(&r->pairs) || !(r->pairs.residual < before)) continue;
        r->at = next;
        return;
    }
    place(r, &r->at);
}

/* ---- the whole ---- */

/* Why the iteration is over after the residual went from `before` to what it is now; LIMIT: it is not. */
static sn_icp_stop look(rigid *r, double before, double size)
{
    double gain = before - r->pairs.residual;
    if (!sn_icp_pairs_suffice(&r->pairs)) return SN_ICP_UNPAIRED;
    if (r->pairs.residual <= EXACT_REL * size) return SN_ICP_EXACT;
    if (gain < r->opt.tolerance * before && r->across <= ACROSS_LEAST)
        return is_near_start(r, &r->at, NEAR) ? SN_ICP_SETTLED : SN_ICP_LOST;
    if (gain < 0.3 * before) r->across = fmax(0.25 * r->across, ACROSS_LEAST);
    return SN_ICP_LIMIT;
}

static sn_status iterate(rigid *r, sn_icp_report *rep, sn_error *err)
{
    place(r, &r->at);
    sn_icp_pairs_tell(&r->pairs, rep);
    rep->stop = look(r, INFINITY, rep->size);
    while (rep->stop == SN_ICP_LIMIT && rep->n_iteration < r->opt.max_iterations) {
        step s = {.grow = 0.0};
        double before = r->pairs.residual;
        sn_status st = sn_run_step(r->run, "fitting a bone: rigid",
                                   (double)rep->n_iteration / r->opt.max_iterations, err);
        if (!st) st = solve_step(r, &s, err);
        if (st) return st;
        descend(r, &s);
        rep->n_iteration++;
        sn_icp_pairs_tell(&r->pairs, rep);
        rep->stop = look(r, before, rep->size);
    }
    return SN_OK;
}

static sn_status check_start(const sn_transform *t, sn_error *err)
{
    if (!(t->scale > 0.0 && isfinite(t->scale)))
        return sn_fail(err, SN_EINVAL, "%s: scale of the start is %g, need > 0", STEP, t->scale);
    if (sn_v3_is_finite(t->axis) && isfinite(t->angle_deg) && sn_v3_is_finite(t->translate)) return SN_OK;
    return sn_fail(err, SN_EINVAL, "%s: axis, angle or translation of the start is not finite", STEP);
}

sn_status sn_icp_rigid_run(const sn_tri_mesh *piece, const sn_bvh *target, const sn_transform *start,
                           const sn_icp_options *options, bool with_scale, const sn_run *run,
                           sn_transform *out, sn_icp_report *report, sn_error *err)
{
    rigid r = {.opt = *options, .run = run, .with_scale = with_scale, .across = 1.0};
    *report = (sn_icp_report){.n_iteration = 0};
    sn_status st = sn_icp_options_set(&r.opt, 200, 0.25, STEP, err);
    if (!st) st = check_start(start, err);
    if (!st) st = sn_icp_pairs_init(&r.pairs, piece, target, &r.opt, err);
    r.pos = st ? NULL : SN_NEW(double, 3 * (size_t)piece->n_vert);
    if (!st && !r.pos) st = sn_fail(err, SN_ENOMEM, "%s: no memory for %d points", STEP, piece->n_vert);
    if (!st) {
        r.at = from_transform(start);
        r.first = r.at;
        report->size = start->scale * sn_box3_diagonal(sn_tri_mesh_bounds(piece));
        st = iterate(&r, report, err);
        if (st) report->stop = SN_ICP_NONE;
    }
    if (!st) st = sn_icp_judge(report, &r.opt, STEP, err);
    if (!st) *out = to_transform(&r.at);
    sn_icp_pairs_free(&r.pairs);
    sn_release(r.pos);
    return st;
}
