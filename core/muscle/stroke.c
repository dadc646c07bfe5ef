#include "muscle/stroke.h"

#include "base/alloc.h"
#include "mesh/spline_fit.h"
#include "muscle/stroke_private.h"

#include <string.h>

enum {
    n_sample = SN_STROKE_SAMPLES,
    default_points = 4,
    n_check = 257,    /* points of the curve that are looked at for the report  */
    most_rounds = 12, /* of pushing the curve out of bones                      */
    most_vain = 4     /* rounds one after the other that do not help            */
};
#define FARTHEST 1e6      /* pixels                                                     */
#define SAME_REL 1e-9     /* of the diagonal: ends nearer to each other are one spot       */
#define TOUCH_REL 1e-6    /* of the diagonal: deeper in bone than that counts as inside    */
#define TIGHT 0.5         /* of the wanted gap: less than that and the curve is pushed     */
#define LEAST_GAP 0.1     /* of the wanted gap, where the path itself has none             */
#define TIGHT_COUNTS 0.05 /* a point that is pushed, compared to one on the wrong side      */
#define PUSHED_WEIGHT 1.5 /* factor on the weight of a point where the curve is pushed     */
#define MOST_WEIGHT 32.0

int32_t sn_stroke_point_count(const sn_stroke_options *opt)
{
    return opt->n_point ? opt->n_point : default_points;
}

/* ---- what comes in ---- */

static sn_status check_options(const sn_stroke_options *o, sn_error *err)
{
    int32_t k = sn_stroke_point_count(o);
    if (k < 2 || k > SN_SPLINE_FIT_MAX_POINTS)
        return sn_fail(err, SN_EINVAL, "a drawn muscle has %d control point%s, need 2..%d", k,
                       k == 1 ? "" : "s", SN_SPLINE_FIT_MAX_POINTS);
    if (!(o->snap >= 0.0 && isfinite(o->snap)))
        return sn_fail(err, SN_EINVAL, "snap is %g pixels, need >= 0", o->snap);
    if (!(o->margin >= 0.0 && isfinite(o->margin)))
        return sn_fail(err, SN_EINVAL, "margin is %g, need >= 0", o->margin);
    return SN_OK;
}

static sn_status check_stroke(const sn_stroke *s, const sn_stroke_body *body, sn_error *err)
{
    const sn_stroke_view *v = &s->view;
    double det = sn_v3_det(v->corner, v->per_x, v->per_y);
    if (body->n_bone < 1)
        return sn_fail(err, SN_EINVAL, "there are no bones: a stroke begins and ends over a bone");
    if (!sn_v3_is_finite(v->eye) || !(fabs(det) > 0.0 && isfinite(det)))
        return sn_fail(err, SN_EINVAL, "the view that the stroke is drawn in is flat or not finite");
    if (s->n_pixel < 2)
        return sn_fail(err, SN_EINVAL, "a stroke has %d point%s, need 2 or more", s->n_pixel,
                       s->n_pixel == 1 ? "" : "s");
    for (int32_t i = 0; i < s->n_pixel; i++) {
        const double *p = s->pixel + 2 * (size_t)i;
        if (!isfinite(p[0]) || !isfinite(p[1]))
            return sn_fail(err, SN_EINVAL, "point %d of the stroke is not finite", i + 1);
        if (fmax(fabs(p[0]), fabs(p[1])) > FARTHEST)
            return sn_fail(err, SN_EINVAL, "point %d of the stroke is at pixel %g, %g, need -1e6..1e6", i + 1,
                           p[0], p[1]);
    }
    return SN_OK;
}

/* Points evenly spaced by length along the polyline of n pixels, both ends included. arc: room for n. */
static sn_status resample(const double *pixel, int32_t n, double *arc, double *out, sn_error *err)
{
    arc[0] = 0.0;
    for (int32_t i = 1; i < n; i++) {
        const double *a = pixel + 2 * (size_t)(i - 1);
        arc[i] = arc[i - 1] + hypot(a[2] - a[0], a[3] - a[1]);
    }
    if (!(arc[n - 1] > 0.0))
        return sn_fail(err, SN_EINVAL, "the stroke has no length: all its %d points are equal", n);
    for (int32_t k = 0, i = 0; k < n_sample; k++) {
        double want = arc[n - 1] * k / (n_sample - 1);
        while (i < n - 2 && arc[i + 1] < want) i++;
        const double *a = pixel + 2 * (size_t)i;
        double part = arc[i + 1] - arc[i], s = part > 0.0 ? (want - arc[i]) / part : 0.0;
        s = k == n_sample - 1 ? 1.0 : s;
        for (int c = 0; c < 2; c++) out[2 * k + c] = a[c] + s * (a[2 + c] - a[c]);
    }
    return SN_OK;
}

/* The stroke with its ends on bone: resampled pixels (n_sample x 2), and the ends in r. */
static sn_status read_stroke(const sn_stroke *s, const sn_stroke_body *body, stroke_room *r, double snap,
                             double *pixel, sn_stroke_report *report, sn_error *err)
{
    size_t n = (size_t)s->n_pixel;
    double *own = SN_NEW(double, 2 * n), *arc = SN_NEW(double, n);
    sn_status st =
        own && arc ? SN_OK : sn_fail(err, SN_ENOMEM, "stroke: no memory for %d points", s->n_pixel);
    if (!st) {
        memcpy(own, s->pixel, 2 * n * sizeof *own);
        st = resample(own, s->n_pixel, arc, pixel, err); /* no length is said before what is hit */
    }
    if (!st) st = sn_stroke_find_ends(&s->view, body, r, snap, own, s->n_pixel, r->end, report, err);
    if (!st) st = resample(own, s->n_pixel, arc, pixel, err);
    if (!st && sn_v3_dist(r->end[0], r->end[1]) <= SAME_REL * r->diagonal)
        st = sn_fail(err, SN_EINVAL, "the stroke begins and ends at the same spot of bone '%s'",
                     body->bone_name[report->bone[0]]);
    sn_release(own);
    sn_release(arc);
    return st;
}

/* ---- the path ---- */

static void linear_path(const sn_stroke_view *v, const double *pixel, const double depth[2], double *path)
{
    for (int32_t i = 0; i < n_sample; i++) {
        double d = depth[0] + (depth[1] - depth[0]) * i / (n_sample - 1);
        sn_v3_store(path + 3 * i, sn_v3_mad(v->eye, d, sn_stroke_sight(v, pixel + 2 * i)));
    }
}

static sn_status make_path(const sn_stroke_view *v, const stroke_room *r, const double *pixel,
                           sn_stroke_depth how, const sn_run *run, double *path, sn_error *err)
{
    double depth[2], seen[2];
    sn_status st = SN_OK;
    for (int e = 0; e < 2; e++)
        if (!sn_stroke_project(v, r->end[e], seen, &depth[e]))
            return sn_fail(err, SN_EINTERNAL, "stroke: end %d is behind the eye", e + 1);
    if (how == SN_DEPTH_LINEAR)
        linear_path(v, pixel, depth, path);
    else
        st = sn_stroke_clear_path(v, r, pixel, depth, run, path, err);
    sn_v3_store(path, r->end[0]);
    sn_v3_store(path + 3 * (n_sample - 1), r->end[1]);
    return st;
}

static double length_of(const double *path)
{
    double sum = 0.0;
    for (int32_t i = 1; i < n_sample; i++)
        sum += sn_v3_dist(sn_v3_load(path + 3 * i), sn_v3_load(path + 3 * (i - 1)));
    return sum;
}

/* ---- the curve ---- */

/* Shares of the curve in bone and outside of the skin. */
static sn_status look_at(const stroke_room *r, const double *point, int32_t k, const sn_run *run,
                         sn_stroke_report *report, sn_error *err)
{
    sn_spline s = {0};
    double fraction[n_check], at[3 * n_check], touch = TOUCH_REL * r->diagonal;
    int in_bone = 0, outside = 0;
    for (int i = 0; i < n_check; i++) fraction[i] = (double)i / (n_check - 1);
    sn_status st = sn_spline_build(&s, point, k, err);
    if (!st) st = sn_spline_at_fractions(&s, fraction, n_check, at, err);
    sn_spline_free(&s);
    if (st) return st;
#pragma omp parallel for num_threads(sn_run_threads(run)) reduction(+ : in_bone, outside)
    for (int i = 0; i < n_check; i++) {
        sn_vec3 p = sn_v3_load(at + 3 * i);
        in_bone += sn_stroke_bone_gap(r, p, NULL) < -touch;
        outside += sn_stroke_skin_gap(r, p, NULL) < -touch;
    }
    report->inside_bone = (double)in_bone / n_check;
    report->outside_skin = (double)outside / n_check;
    return SN_OK;
}

typedef struct target { /* what the curve is fitted to: the path, pushed where the curve cuts a corner */
    double point[3 * n_sample], weight[n_sample], fraction[n_sample];
    double want[n_sample]; /* gap: no more than the path has */
} target;

static double gap_at(const stroke_room *r, sn_vec3 p, sn_vec3 *away)
{
    sn_vec3 from_skin;
    double gap = sn_stroke_bone_gap(r, p, away), skin_gap = sn_stroke_skin_gap(r, p, &from_skin);
    if (skin_gap >= gap) return gap;
    *away = from_skin;
    return skin_gap;
}

static void make_target(target *t, const stroke_room *r, const double *path)
{
    double length = length_of(path);
    memcpy(t->point, path, sizeof t->point);
    t->fraction[0] = 0.0;
    for (int i = 0; i < n_sample; i++) {
        sn_vec3 p = sn_v3_load(path + 3 * i), away;
        double want = sn_stroke_wanted_gap(r, p);
        t->want[i] = fmin(fmax(gap_at(r, p, &away), LEAST_GAP * want), want);
        t->weight[i] = 1.0;
    }
    for (int i = 1; i < n_sample; i++)
        t->fraction[i] = t->fraction[i - 1] +
                         sn_v3_dist(sn_v3_load(path + 3 * i), sn_v3_load(path + 3 * (i - 1))) / length;
}

/* Moves the targets where the curve has too little room: from where the curve is, away from the surface. Says
 * how many. */
static sn_status push(target *t, const stroke_room *r, const double *point, int32_t k, int *n_pushed,
                      sn_error *err)
{
    sn_spline s = {0};
    double at[3 * n_sample];
    *n_pushed = 0;
    sn_status st = sn_spline_build(&s, point, k, err);
    if (!st) st = sn_spline_at_fractions(&s, t->fraction, n_sample, at, err);
    sn_spline_free(&s);
    for (int i = 1; !st && i < n_sample - 1; i++) {
        sn_vec3 p = sn_v3_load(at + 3 * i), away;
        double gap = gap_at(r, p, &away), want = t->want[i];
        if (gap >= TIGHT * want) continue;
        sn_v3_store(t->point + 3 * i, sn_v3_mad(p, want - gap, away));
        t->weight[i] = fmin(PUSHED_WEIGHT * t->weight[i], MOST_WEIGHT);
        ++*n_pushed;
    }
    return st;
}

/* Fits, looks, pushes and fits again until nothing is left to push; keeps the control points with the least
 * of the curve on the wrong side or near to it, of equal ones the first, which are nearest to the path. */
static sn_status fit_clear(const stroke_room *r, const double *path, double *point, int32_t k,
                           const sn_run *run, sn_stroke_report *report, sn_error *err)
{
    target t;
    double now[3 * SN_SPLINE_FIT_MAX_POINTS], least = INFINITY;
    int n_pushed = 1, vain = 0;
    sn_status st = SN_OK;
    make_target(&t, r, path);
    const sn_spline_fit fit = {.path = t.point, .weight = t.weight, .fraction = t.fraction, .n = n_sample};
    for (int round = 0; !st && n_pushed > 0 && vain < most_vain && round < most_rounds; round++) {
        sn_stroke_report look = {0};
        st = sn_spline_fit_points(&fit, now, k, NULL, err);
        if (!st) st = look_at(r, now, k, run, &look, err);
        if (!st) st = push(&t, r, now, k, &n_pushed, err);
        double bad = look.inside_bone + look.outside_skin + TIGHT_COUNTS * n_pushed / n_sample;
        vain = bad < least ? 0 : vain + 1;
        if (st || vain > 0) continue;
        least = bad;
        report->inside_bone = look.inside_bone;
        report->outside_skin = look.outside_skin;
        memcpy(point, now, 3 * (size_t)k * sizeof *point);
    }
    return st;
}

static sn_status fit_curve(const stroke_room *r, const double *path, sn_stroke_depth how, double *point,
                           int32_t k, const sn_run *run, sn_stroke_report *report, sn_error *err)
{
    sn_spline_fit_report off;
    const sn_spline_fit fit = {.path = path, .n = n_sample};
    sn_status st;
    if (how == SN_DEPTH_CLEAR)
        st = fit_clear(r, path, point, k, run, report, err);
    else if (!(st = sn_spline_fit_points(&fit, point, k, NULL, err)))
        st = look_at(r, point, k, run, report, err);
    if (!st) st = sn_spline_fit_distance(&fit, point, k, &off, err);
    if (st) return st;
    report->rms = off.rms;
    report->max = off.max;
    return SN_OK;
}

sn_status sn_stroke_curve(const sn_stroke *s, const sn_stroke_body *body, const sn_stroke_options *opt,
                          const sn_run *run, double *point, sn_stroke_report *report, sn_error *err)
{
    stroke_room r = {0};
    sn_stroke_report own = {0};
    double pixel[2 * n_sample], found[3 * SN_SPLINE_FIT_MAX_POINTS];
    int32_t k = sn_stroke_point_count(opt);
    sn_status st = check_options(opt, err);
    if (!st) st = check_stroke(s, body, err);
    if (!st) st = sn_stroke_room_make(&r, body, opt->margin, err);
    if (!st) st = read_stroke(s, body, &r, opt->snap, pixel, &own, err);
    if (!st) st = sn_run_step(run, "drawing a muscle", 0.0, err);
    if (!st) st = make_path(&s->view, &r, pixel, opt->depth, run, own.path, err);
    if (!st) st = fit_curve(&r, own.path, opt->depth, found, k, run, &own, err);
    sn_stroke_room_free(&r);
    if (st) return st;
    own.path_length = length_of(own.path);
    memcpy(point, found, 3 * (size_t)k * sizeof *point);
    if (report) *report = own;
    return SN_OK;
}
