#include "mesh/spline_fit.h"

#include "base/alloc.h"

#include <string.h>

enum { pieces = 16, max_steps = 60, max_tries = 12 }; /* pieces: of a segment in the table of lengths */
#define DIFFERENCE 1e-6    /* of the path's length: step of the numeric derivatives        */
#define FIRST_DAMPING 1e-4 /* of the diagonal                                              */
#define IMPROVEMENT 1e-6   /* relative: a step that gains less is the last                 */

/* ---- a curve by fractions of its length ---- */

sn_status sn_spline_at_fractions(const sn_spline *s, const double *fraction, int32_t n, double *out,
                                 sn_error *err)
{
    int32_t n_piece = s->n_seg * pieces, j = 0;
    double *arc = SN_NEW(double, n_piece + 1);
    if (!arc) return sn_fail(err, SN_ENOMEM, "curve: no memory for %d lengths", n_piece);
    arc[0] = 0.0;
    for (int32_t i = 0; i < n_piece; i++) {
        double t = (double)(i % pieces) / pieces;
        arc[i + 1] = arc[i] + sn_cubic_length(&s->seg[i / pieces], t, t + 1.0 / pieces);
    }
    for (int32_t i = 0; i < n; i++) {
        double want = fraction[i] * arc[n_piece];
        while (j < n_piece - 1 && arc[j + 1] < want) j++;
        const sn_cubic *c = &s->seg[j / pieces];
        double t0 = (double)(j % pieces) / pieces, t1 = t0 + 1.0 / pieces, part = arc[j + 1] - arc[j];
        double t = part > 0.0 ? t0 + (t1 - t0) * (want - arc[j]) / part : t0;
        double speed = sn_v3_len(sn_cubic_tangent(c, t));
        if (speed > 0.0) t += (want - arc[j] - sn_cubic_length(c, t0, t)) / speed; /* one Newton step */
        sn_v3_store(out + 3 * (size_t)i, sn_cubic_point(c, fmin(fmax(t, t0), t1)));
    }
    sn_release(arc);
    return SN_OK;
}

/* ---- residuals and their derivatives ---- */

typedef struct problem {
    const sn_spline_fit *fit;
    const double *fraction;
    int32_t k, n_var, n_res; /* control points; 3 (k - 2); 3 n */
    double length;
} problem;

static double weight_at(const problem *q, int32_t i)
{
    return q->fit->weight ? sqrt(q->fit->weight[i]) : 1.0;
}

static sn_status residuals(const problem *q, const double *point, double *res, sn_error *err)
{
    sn_spline s = {0};
    sn_status st = sn_spline_build(&s, point, q->k, err);
    if (!st) st = sn_spline_at_fractions(&s, q->fraction, q->fit->n, res, err);
    for (int32_t i = 0; !st && i < q->n_res; i++) res[i] = weight_at(q, i / 3) * (res[i] - q->fit->path[i]);
    sn_spline_free(&s);
    return st;
}

static double cost_of(const problem *q, const double *res)
{
    double sum = 0.0;
    for (int32_t i = 0; i < q->n_res; i++) sum += res[i] * res[i];
    return sum;
}

/* jac: one row of n_res derivatives for each variable. point is changed and put back. */
static sn_status derivatives(const problem *q, double *point, const double *res, double *jac, sn_error *err)
{
    sn_status st = SN_OK;
    double h = DIFFERENCE * q->length;
    for (int32_t v = 0; !st && v < q->n_var; v++) {
        double *row = jac + (size_t)v * (size_t)q->n_res, before = point[3 + v];
        point[3 + v] = before + h;
        st = residuals(q, point, row, err);
        point[3 + v] = before;
        for (int32_t i = 0; !st && i < q->n_res; i++) row[i] = (row[i] - res[i]) / h;
    }
    return st;
}

/* ---- normal equations ---- */

static double dot(const double *a, const double *b, int32_t n)
{
    double sum = 0.0;
    for (int32_t i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

/* Solves (J'J + damping * diagonal) x = -J'res by Cholesky; a: n_var x n_var, holds J'J and is kept, low:
 * room for the factor. false when it breaks down. */
static bool solve(const problem *q, const double *a, const double *gradient, double damping, double *low,
                  double *x)
{
    int32_t n = q->n_var;
    for (int32_t i = 0; i < n; i++)
        for (int32_t j = 0; j <= i; j++) {
            size_t ij = (size_t)i * (size_t)n + (size_t)j;
            double *ri = low + (size_t)i * (size_t)n, *rj = low + (size_t)j * (size_t)n;
            double sum = a[ij] * (i == j ? 1.0 + damping : 1.0) - dot(ri, rj, j);
            if (i == j && !(sum > 0.0)) return false;
            low[ij] = i == j ? sqrt(sum) : sum / rj[j];
        }
    for (int32_t i = 0; i < n; i++) {
        const double *ri = low + (size_t)i * (size_t)n;
        x[i] = (-gradient[i] - dot(ri, x, i)) / ri[i];
    }
    for (int32_t i = n - 1; i >= 0; i--) {
        for (int32_t j = i + 1; j < n; j++) x[i] -= low[(size_t)j * (size_t)n + (size_t)i] * x[j];
        x[i] /= low[(size_t)i * (size_t)n + (size_t)i];
    }
    return true;
}

typedef struct work {
    double *res, *res_new, *jac, *a, *low, *gradient, *x, *trial;
} work;

static void free_work(work *w)
{
    double *all[] = {w->res, w->res_new, w->jac, w->a, w->low, w->gradient, w->x, w->trial};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) sn_release(all[i]);
}

static sn_status new_work(work *w, const problem *q, sn_error *err)
{
    size_t n = (size_t)q->n_var, m = (size_t)q->n_res;
    *w = (work){.res = SN_NEW(double, m),
                .res_new = SN_NEW(double, m),
                .jac = SN_NEW(double, n *m),
                .a = SN_NEW(double, n *n),
                .low = SN_NEW(double, n *n),
                .gradient = SN_NEW(double, n),
                .x = SN_NEW(double, n),
                .trial = SN_NEW(double, 3 * q->k)};
    bool ok = w->res && w->res_new && w->jac && w->a && w->low && w->gradient && w->x && w->trial;
    return ok ? SN_OK : sn_fail(err, SN_ENOMEM, "curve: no memory to fit %d points", q->k);
}

/* Tries steps with more and more damping; *gain receives how much of the cost the first one that helps takes
 * away, 0 when none does. Points that make no curve are steps that do not help. */
static sn_status step(const problem *q, work *w, double *point, double *damping, double *gain, sn_error *err)
{
    double cost = cost_of(q, w->res);
    size_t size = 3 * (size_t)q->k * sizeof *point;
    *gain = 0.0;
    for (int tries = 0; tries < max_tries; tries++, *damping *= 10.0) {
        if (!solve(q, w->a, w->gradient, *damping, w->low, w->x)) continue;
        memcpy(w->trial, point, size);
        for (int32_t v = 0; v < q->n_var; v++) w->trial[3 + v] += w->x[v];
        sn_status st = residuals(q, w->trial, w->res_new, err);
        if (st == SN_ENOMEM) return st;
        double now = st ? INFINITY : cost_of(q, w->res_new);
        if (!(now < cost)) continue;
        *gain = (cost - now) / cost;
        *damping *= 0.1;
        memcpy(point, w->trial, size);
        memcpy(w->res, w->res_new, (size_t)q->n_res * sizeof *w->res);
        return SN_OK;
    }
    return SN_OK;
}

static sn_status gauss_newton(const problem *q, double *point, sn_error *err)
{
    work w;
    double damping = FIRST_DAMPING, gain = 1.0;
    sn_status st = new_work(&w, q, err);
    if (!st) st = residuals(q, point, w.res, err);
    for (int k = 0; !st && k < max_steps && gain > IMPROVEMENT && cost_of(q, w.res) > 0.0; k++) {
        st = derivatives(q, point, w.res, w.jac, err);
        if (st) break;
        size_t m = (size_t)q->n_res;
        for (int32_t i = 0; i < q->n_var; i++) {
            w.gradient[i] = dot(w.jac + (size_t)i * m, w.res, q->n_res);
            for (int32_t j = 0; j < q->n_var; j++)
                w.a[i * q->n_var + j] = dot(w.jac + (size_t)i * m, w.jac + (size_t)j * m, q->n_res);
        }
        st = step(q, &w, point, &damping, &gain, err);
    }
    free_work(&w);
    return st;
}

/* ---- the path ---- */

/* Fractions of the length up to each point; returns the length. */
static double fractions_of(const double *path, int32_t n, double *fraction)
{
    fraction[0] = 0.0;
    for (int32_t i = 1; i < n; i++)
        fraction[i] = fraction[i - 1] +
                      sn_v3_dist(sn_v3_load(path + 3 * (size_t)i), sn_v3_load(path + 3 * (size_t)(i - 1)));
    double length = fraction[n - 1];
    for (int32_t i = 1; length > 0.0 && i < n; i++) fraction[i] /= length;
    return length;
}

/* k points evenly spaced by fraction, both ends included. */
static void start_points(const sn_spline_fit *fit, const double *fraction, double *point, int32_t k)
{
    for (int32_t j = 0, i = 0; j < k; j++) {
        double want = (double)j / (k - 1);
        while (i < fit->n - 2 && fraction[i + 1] < want) i++;
        double part = fraction[i + 1] - fraction[i], s = part > 0.0 ? (want - fraction[i]) / part : 0.0;
        sn_vec3 a = sn_v3_load(fit->path + 3 * (size_t)i), b = sn_v3_load(fit->path + 3 * (size_t)(i + 1));
        sn_v3_store(point + 3 * (size_t)j, sn_v3_lerp(a, b, s));
    }
    memcpy(point, fit->path, 3 * sizeof *point);
    memcpy(point + 3 * (size_t)(k - 1), fit->path + 3 * (size_t)(fit->n - 1), 3 * sizeof *point);
}

static double distance_to_segment(sn_vec3 p, sn_vec3 a, sn_vec3 b)
{
    sn_vec3 ab = sn_v3_sub(b, a);
    double len2 = sn_v3_len2(ab), s = len2 > 0.0 ? sn_v3_dot(sn_v3_sub(p, a), ab) / len2 : 0.0;
    return sn_v3_dist(p, sn_v3_mad(a, fmin(fmax(s, 0.0), 1.0), ab));
}

static double distance_to_curve(const sn_spline *s, sn_vec3 p)
{
    double best = INFINITY;
    for (int32_t i = 0; i < s->n_seg; i++)
        for (int k = 0; k < 2 * pieces; k++)
            best = fmin(best, distance_to_segment(p, sn_cubic_point(&s->seg[i], 0.5 * k / pieces),
                                                  sn_cubic_point(&s->seg[i], 0.5 * (k + 1) / pieces)));
    return best;
}

sn_status sn_spline_fit_distance(const sn_spline_fit *fit, const double *point, int32_t k,
                                 sn_spline_fit_report *report, sn_error *err)
{
    sn_spline s = {0};
    double sum = 0.0, max = 0.0;
    sn_status st = sn_spline_build(&s, point, k, err);
    for (int32_t i = 0; !st && i < fit->n; i++) {
        double d = distance_to_curve(&s, sn_v3_load(fit->path + 3 * (size_t)i));
        sum += d * d;
        max = fmax(max, d);
    }
    *report = (sn_spline_fit_report){.rms = sqrt(sum / fit->n), .max = max};
    sn_spline_free(&s);
    return st;
}

sn_status sn_spline_fit_points(const sn_spline_fit *fit, double *point, int32_t k,
                               sn_spline_fit_report *report, sn_error *err)
{
    int32_t n = fit->n;
    if (k < 2 || k > SN_SPLINE_FIT_MAX_POINTS)
        return sn_fail(err, SN_EINVAL, "a fitted curve has %d point%s, need 2..%d", k, k == 1 ? "" : "s",
                       SN_SPLINE_FIT_MAX_POINTS);
    if (n < 2) return sn_fail(err, SN_EINVAL, "a path has %d point%s, need 2 or more", n, n == 1 ? "" : "s");
    if (!(sn_v3_dist(sn_v3_load(fit->path), sn_v3_load(fit->path + 3 * (size_t)(n - 1))) > 0.0))
        return sn_fail(err, SN_EINVAL, "a path begins and ends at the same point");
    double *own = SN_NEW(double, n);
    if (!own) return sn_fail(err, SN_ENOMEM, "path: no memory for %d points", n);
    double length = fractions_of(fit->path, n, own);
    problem q = {.fit = fit,
                 .fraction = fit->fraction ? fit->fraction : own,
                 .k = k,
                 .n_var = 3 * (k - 2),
                 .n_res = 3 * n,
                 .length = length};
    start_points(fit, own, point, k);
    sn_status st = k > 2 ? gauss_newton(&q, point, err) : SN_OK;
    if (!st && report) st = sn_spline_fit_distance(fit, point, k, report, err);
    sn_release(own);
    return st;
}
