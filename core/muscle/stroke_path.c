/* The clear path: the cheapest way through a lattice of points on the stroke's lines of sight, by dynamic
 * programming. A node is a depth, as the distance `off` along the line of sight from the straight path, and
 * in a second attempt also a step aside in the picture. The lattice is refined around the way found. */
#include "muscle/stroke_private.h"

#include "base/alloc.h"

#include <string.h>

enum {
    n_ray = SN_STROKE_SAMPLES,
    most_steps = 40,   /* depths to either side, first time                             */
    refinements = 2,   /* of the lattice around the way found                           */
    refine_factor = 4, /* of the steps, each time                                       */
    refine_steps = 6,  /* depths to either side, then                                   */
    knots = 4,         /* rays from knot to knot; half of that in the last refinement   */
    sides = 7          /* lines of sight beside each other, when ways may go aside      */
};

/* What a path costs per its length. A path that turns off at 45 degrees costs 1. */
#define COST_GAP 25.0    /* where the gap is 0, less with the square of the gap; more inside of bone  */
#define COST_HIDDEN 1.0  /* behind a bone                                                             */
#define COST_OFF 0.1     /* as far off the straight path as that is long; with the square             */
#define COST_ASIDE 100.0 /* as far beside the stroke as the straight path is long; with the square    */
#define MOST_DEEP 4.0    /* margins: deeper inside of bone costs no more                              */
#define SIDE_STEP 0.015  /* of the straight path: between lines of sight beside each other            */
#define BLOCKED 0.02     /* share of a path on the wrong side: then it may leave the stroke           */

typedef struct straight { /* the path without obstacles */
    double pixel[2 * n_ray], depth[n_ray];
    double step[n_ray]; /* length from the point before */
    double length;
} straight;

typedef struct lattice {
    int32_t n_side, n_off, n_node; /* per ray: n_side x n_off         */
    double side_step, off_step;    /* lengths                         */
    double centre[n_ray];          /* off of the middle node          */
    bool is_aligned;               /* all centres are 0               */
    int32_t stride;                /* rays from knot to knot: a way is straight between its knots, else
                                      gentle turns would be made of single, dear steps */
    double *cost, *wrong, *total;  /* n_ray x n_node: cost per length of the node; of its gap alone, summed up
                                      over the depths before it; of the cheapest way to it */
    int32_t *from;                 /* n_ray x n_node: the node before */
} lattice;

typedef struct way {
    double off[n_ray], aside[n_ray];
} way;

static size_t at(const lattice *g, int32_t i_ray, int32_t side, int32_t k)
{
    return (size_t)i_ray * (size_t)g->n_node + (size_t)(side * g->n_off + k);
}

static double aside_of(const lattice *g, int32_t side)
{
    return g->side_step * (side - g->n_side / 2);
}

static double off_of(const lattice *g, int32_t i_ray, int32_t k)
{
    return g->centre[i_ray] + g->off_step * (k - g->n_off / 2);
}

/* ---- the straight path ---- */

static sn_vec3 point_of(const sn_stroke_view *v, const double pixel[2], double depth, double off)
{
    sn_vec3 sight = sn_stroke_sight(v, pixel);
    return sn_v3_mad(sn_v3_mad(v->eye, depth, sight), off, sn_v3_unit(sight));
}

/* 1/depth is linear along the image of a line. */
static void make_straight(straight *s, const sn_stroke_view *v, const double *pixel, const double depth[2])
{
    sn_vec3 before = {0};
    memcpy(s->pixel, pixel, sizeof s->pixel);
    s->length = 0.0;
    for (int32_t i = 0; i < n_ray; i++) {
        double u = (double)i / (n_ray - 1);
        s->depth[i] = 1.0 / ((1.0 - u) / depth[0] + u / depth[1]);
        sn_vec3 p = point_of(v, pixel + 2 * i, s->depth[i], 0.0);
        s->step[i] = i > 0 ? sn_v3_dist(p, before) : 0.0;
        s->length += s->step[i];
        before = p;
    }
    for (int32_t i = 1; i < n_ray; i++) s->step[i] = fmax(s->step[i], 1e-6 * s->length);
}

/* The pixel at a distance in space beside the stroke, at the depth of the straight path. */
static void move_aside(const straight *s, const sn_stroke_view *v, int32_t i, double aside, double pixel[2])
{
    const double *p = s->pixel + 2 * i;
    const double *a = s->pixel + 2 * (i > 0 ? i - 1 : 0), *b = s->pixel + 2 * (i < n_ray - 1 ? i + 1 : i);
    double x = b[0] - a[0], y = b[1] - a[1], len = hypot(x, y);
    double to_pixels = 1.0 / (s->depth[i] * sn_v3_len(v->per_x));
    pixel[0] = p[0];
    pixel[1] = p[1];
    if (!(len > 0.0)) return; /* the stroke turns back on itself here */
    pixel[0] -= aside * to_pixels * y / len;
    pixel[1] += aside * to_pixels * x / len;
}

/* ---- what a node costs ---- */

typedef struct sight { /* one line of sight with all its surfaces */
    const stroke_room *room;
    sn_vec3 eye, dir;
    double start; /* t of off = 0 */
    sn_ray_hit *bone, *skin;
    size_t n_bone, n_skin;
} sight;

static double nearest_hit(const sn_ray_hit *hit, size_t n, double t)
{
    double best = INFINITY;
    for (size_t i = 0; i < n; i++) best = fmin(best, fabs(hit[i].t - t));
    return best;
}

/* Of one surface: 0 where the gap is wide enough, up to 1 at gap 0, more on the wrong side. Squared. */
static double wrong_by(const stroke_room *r, const sn_bvh *b, bool is_wrong_side, const sn_ray_hit *hit,
                       size_t n_hit, double t, sn_vec3 p)
{
    double x = is_wrong_side ? 1.0 + fmin(nearest_hit(hit, n_hit, t) / r->margin, MOST_DEEP)
                             : (sn_stroke_wanted_gap(r, p) - sn_bvh_closest(b, p).dist) / r->margin;
    return x > 0.0 ? x * x : 0.0;
}

static double wrongness(const sight *s, double t, bool *is_hidden)
{
    const stroke_room *r = s->room;
    sn_vec3 p = sn_v3_mad(s->eye, t, s->dir);
    bool in_bone = sn_stroke_winding(s->bone, s->n_bone, t) > 0;
    double sum = wrong_by(r, r->bones, in_bone, s->bone, s->n_bone, t, p);
    if (r->skin) {
        bool is_out = sn_stroke_winding(s->skin, s->n_skin, t) <= 0;
        sum += wrong_by(r, r->skin, is_out, s->skin, s->n_skin, t, p);
    }
    *is_hidden = !in_bone && s->n_bone > 0 && s->bone[0].t < t;
    return sum;
}

static sn_status open_sight(sight *s, const stroke_room *r, const sn_stroke_view *v, const double pixel[2],
                            double depth)
{
    sn_vec3 d = sn_stroke_sight(v, pixel);
    *s = (sight){.room = r, .eye = v->eye, .dir = sn_v3_unit(d), .start = depth * sn_v3_len(d)};
    sn_status st = sn_bvh_ray_all(r->bones, s->eye, s->dir, INFINITY, &s->bone, &s->n_bone, NULL);
    if (!st && r->skin) st = sn_bvh_ray_all(r->skin, s->eye, s->dir, INFINITY, &s->skin, &s->n_skin, NULL);
    return st;
}

static sn_status cost_of_ray(lattice *g, const straight *s, const stroke_room *r, const sn_stroke_view *v,
                             int32_t i, int32_t side)
{
    sight line;
    double pixel[2], aside = aside_of(g, side), above = 0.0, sum = 0.0;
    move_aside(s, v, i, aside, pixel);
    sn_status st = open_sight(&line, r, v, pixel, s->depth[i]);
    for (int32_t k = 0; !st && k < g->n_off; k++) {
        bool is_hidden;
        double off = off_of(g, i, k), t = line.start + off, far = off / s->length;
        double wrong = wrongness(&line, fmax(t, 0.0), &is_hidden);
        if (t <= 0.0) wrong += MOST_DEEP * MOST_DEEP; /* behind the eye */
        sum += k > 0 ? 0.5 * (above + wrong) : 0.0;
        above = wrong;
        g->wrong[at(g, i, side, k)] = sum;
        g->cost[at(g, i, side, k)] = COST_GAP * wrong + (is_hidden ? COST_HIDDEN : 0.0) +
                                     COST_OFF * far * far +
                                     COST_ASIDE * (aside / s->length) * (aside / s->length);
    }
    sn_release(line.bone);
    sn_release(line.skin);
    return st;
}

static sn_status cost_of_nodes(lattice *g, const straight *s, const stroke_room *r, const sn_stroke_view *v,
                               const sn_run *run, sn_error *err)
{
    int failed = 0;
#pragma omp parallel for schedule(dynamic, 1) num_threads(sn_run_threads(run)) reduction(| : failed)
    for (int32_t q = 1; q < n_ray - 1; q++) /* the ends are given */
        for (int32_t side = 0; side < g->n_side; side++)
            if (!failed && !sn_run_stopped(run)) failed |= cost_of_ray(g, s, r, v, q, side) != SN_OK;
    if (failed) return sn_fail(err, SN_ENOMEM, "stroke: no memory");
    return sn_run_step(run, "drawing a muscle", -1.0, err);
}

/* ---- the cheapest way ---- */

/* A value of the nodes of one line of sight, linear between them. */
static double value_at(const lattice *g, const double *value, int32_t i_ray, int32_t side, double x)
{
    int32_t k = (int32_t)fmin(fmax(floor(x), 0.0), g->n_off - 2);
    double u = fmin(fmax(x - k, 0.0), 1.0), v = value[at(g, i_ray, side, k)];
    return v + u * (value[at(g, i_ray, side, k + 1)] - v);
}

/* What the straight piece costs that ends at node (i, side, k) and comes from node (i - stride, side + d,
 * k0), above `c`; stops when that is `enough`. Changes of depth are charged for what lies between the two
 * depths, so that no bone is jumped over. */
static double piece_cost(const lattice *g, const straight *s, int32_t i, int32_t side, int32_t k, int32_t d,
                         int32_t k0, double c, double enough)
{
    int32_t start = i - g->stride;
    double off0 = off_of(g, start, k0), off1 = off_of(g, i, k), off = off0;
    for (int32_t q = 1; q <= g->stride && c < enough; q++) {
        int32_t ray = start + q, lane = 2 * q < g->stride ? side + d : side;
        double first = g->centre[ray] - g->off_step * (g->n_off / 2), before = off;
        off = off0 + (off1 - off0) * q / g->stride;
        double x = (off - first) / g->off_step, x0 = (before - first) / g->off_step;
        c += value_at(g, g->cost, ray, lane, x) * s->step[ray];
        if (g->is_aligned)
            c += COST_GAP * g->off_step *
                 fabs(value_at(g, g->wrong, ray, lane, x) - value_at(g, g->wrong, ray, lane, x0));
    }
    return c;
}

/* Finds the cheapest way to a node. Small turns come first: most others are then too dear at a glance. */
static void reach(lattice *g, const straight *s, int32_t i, int32_t side, int32_t k)
{
    static const int32_t lanes[] = {0, -1, 1};
    size_t to = at(g, i, side, k);
    double best = INFINITY, length = 0.0;
    int32_t start = i - g->stride;
    for (int32_t q = start + 1; q <= i; q++) length += s->step[q];
    for (int32_t m = 0; m < 3 * 2 * g->n_off; m++) {
        int32_t d = lanes[m / (2 * g->n_off)], far = m % (2 * g->n_off) / 2, k0 = m & 1 ? k - far : k + far;
        if (side + d < 0 || side + d >= g->n_side || k0 < 0 || k0 >= g->n_off) continue;
        size_t from = at(g, start, side + d, k0);
        double turn = off_of(g, i, k) - off_of(g, start, k0), aside = d * g->side_step;
        double c = g->total[from] + (turn * turn + aside * aside) / length;
        if (c < best) c = piece_cost(g, s, i, side, k, d, k0, c, best);
        if (!(c < best)) continue;
        best = c;
        g->from[to] = (int32_t)(from - (size_t)start * (size_t)g->n_node);
    }
    g->total[to] = best;
}

/* The first and the last ray have one node: that on the straight path. */
static bool is_open(const lattice *g, int32_t i, int32_t side, int32_t k)
{
    bool is_end = i == 0 || i == n_ray - 1;
    return !is_end || (side == g->n_side / 2 && k == g->n_off / 2);
}

static void cheapest_way(lattice *g, const straight *s, const sn_run *run, way *w)
{
    for (int32_t i = 0; i < n_ray; i += g->stride) {
#pragma omp parallel for schedule(dynamic, 8) num_threads(sn_run_threads(run))
        for (int32_t node = 0; node < g->n_node; node++) {
            int32_t side = node / g->n_off, k = node % g->n_off;
            if (!is_open(g, i, side, k))
                g->total[at(g, i, side, k)] = INFINITY;
            else if (i > 0)
                reach(g, s, i, side, k);
            else
                g->total[at(g, 0, side, k)] = 0.0;
        }
    }
    int32_t node = (g->n_side / 2) * g->n_off + g->n_off / 2;
    for (int32_t i = n_ray - 1; i >= 0; i -= g->stride) {
        w->off[i] = off_of(g, i, node % g->n_off);
        w->aside[i] = aside_of(g, node / g->n_off);
        if (i > 0) node = g->from[(size_t)i * (size_t)g->n_node + (size_t)node];
    }
    for (int32_t i = 0; i < n_ray; i++) { /* straight between the knots */
        int32_t a = i - i % g->stride, b = a < i ? a + g->stride : a;
        double u = (double)(i - a) / g->stride;
        w->off[i] = w->off[a] + u * (w->off[b] - w->off[a]);
        w->aside[i] = w->aside[a] + u * (w->aside[b] - w->aside[a]);
    }
}

static sn_status search(lattice *g, const straight *s, const stroke_room *r, const sn_stroke_view *v,
                        const sn_run *run, way *w, sn_error *err)
{
    g->n_node = g->n_side * g->n_off;
    size_t n = (size_t)n_ray * (size_t)g->n_node;
    g->cost = SN_NEW_ZERO(double, n);
    g->wrong = SN_NEW_ZERO(double, n);
    g->total = SN_NEW_ZERO(double, n);
    g->from = SN_NEW_ZERO(int32_t, n);
    sn_status st = g->cost && g->wrong && g->total && g->from
                       ? SN_OK
                       : sn_fail(err, SN_ENOMEM, "stroke: no memory for %zu points", n);
    if (!st) st = cost_of_nodes(g, s, r, v, run, err);
    if (!st) cheapest_way(g, s, run, w);
    sn_release(g->cost);
    sn_release(g->wrong);
    sn_release(g->total);
    sn_release(g->from);
    return st;
}

/* Moves the stroke to where the way goes: each pixel needs its neighbours as they were. */
static void follow_aside(straight *s, const sn_stroke_view *v, const way *w)
{
    double moved[2 * n_ray];
    for (int32_t i = 0; i < n_ray; i++) move_aside(s, v, i, w->aside[i], moved + 2 * i);
    memcpy(s->pixel, moved, sizeof moved);
}

/* Searches all depths, then in finer and finer steps around the way found. n_side > 1: also beside the
 * stroke, which is moved to where the way goes. */
static sn_status find_way(straight *s, int32_t n_side, const stroke_room *r, const sn_stroke_view *v,
                          const sn_run *run, way *w, sn_error *err)
{
    double reach_far = s->length + 4.0 * r->margin;
    lattice g = {.n_side = n_side,
                 .side_step = SIDE_STEP * s->length,
                 .off_step = fmax(0.5 * r->margin, reach_far / most_steps),
                 .is_aligned = true,
                 .stride = knots};
    g.n_off = 2 * (int32_t)ceil(reach_far / g.off_step) + 1;
    sn_status st = search(&g, s, r, v, run, w, err);
    if (!st) follow_aside(s, v, w);
    for (int k = 0; !st && k < refinements; k++) {
        g = (lattice){.n_side = 1,
                      .n_off = 2 * refine_steps + 1,
                      .off_step = g.off_step / refine_factor,
                      .stride = knots >> k};
        memcpy(g.centre, w->off, sizeof g.centre);
        st = search(&g, s, r, v, run, w, err);
    }
    return st;
}

/* ---- the path ---- */

static void store_path(const straight *s, const way *w, const sn_stroke_view *v, double *path)
{
    for (int32_t i = 0; i < n_ray; i++)
        sn_v3_store(path + 3 * i, point_of(v, s->pixel + 2 * i, s->depth[i], w->off[i]));
}

/* Share of the path's points that are in a bone or outside of the skin. */
static double blocked(const stroke_room *r, const double *path)
{
    int n = 0;
    for (int32_t i = 1; i < n_ray - 1; i++) {
        sn_vec3 p = sn_v3_load(path + 3 * i);
        n += sn_stroke_bone_gap(r, p, NULL) < 0.0 || sn_stroke_skin_gap(r, p, NULL) < 0.0;
    }
    return (double)n / n_ray;
}

sn_status sn_stroke_clear_path(const sn_stroke_view *v, const stroke_room *r, const double *pixel,
                               const double depth[2], const sn_run *run, double *path, sn_error *err)
{
    straight s;
    way w;
    double other[3 * n_ray];
    make_straight(&s, v, pixel, depth);
    sn_status st = find_way(&s, 1, r, v, run, &w, err);
    if (st) return st;
    store_path(&s, &w, v, path);
    double bad = blocked(r, path);
    if (bad <= BLOCKED) return SN_OK;
    st = find_way(&s, sides, r, v, run, &w, err);
    if (st) return st;
    store_path(&s, &w, v, other);
    if (blocked(r, other) < bad) memcpy(path, other, sizeof other);
    return SN_OK;
}
