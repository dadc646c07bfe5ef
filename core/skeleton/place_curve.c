/* place_curve.c - bones in a row along a curve. */
#include "skeleton/place.h"

#include "base/alloc.h"
#include "base/plane.h"
#include "mesh/spline_fit.h"
#include "skeleton/place_private.h"

#include <math.h>
#include <string.h>

enum {
    max_bones = 1000,
    max_points = 100000,
    max_given = 12,   /* as many points as this are control points, more are a stroke               */
    n_stroke = 200,   /* a stroke is fitted at as many places, evenly: drawn slowly or not          */
    n_direction = 512 /* places along the curve, at least, where the bones' directions are followed */
};
static const double EQUAL_REL = 1e-9;   /* of the length of a stroke: neighbours nearer than this are one  */
static const double SHRINK_STEP = 0.04; /* of the fill that was asked for, where bones cross              */
static const double SMALLEST = 0.5;

/* ---- options ---- */

static bool at_least_0(double x)
{
    return x >= 0.0 && isfinite(x);
}

static sn_status check_numbers(const sn_curve_options *o, sn_error *err)
{
    const double *s = o->size;
    if (!at_least_0(o->fill))
        return sn_fail(err, SN_EINVAL, "fill is %g, need > 0, or 0 for the template's own", o->fill);
    if (!at_least_0(o->thickness))
        return sn_fail(err, SN_EINVAL, "thickness is %g, need > 0, or 0 for as long as thick", o->thickness);
    bool equal = s[0] == 0.0 && s[1] == 0.0;
    if (!equal && !(s[0] > 0.0 && s[1] > 0.0 && isfinite(s[0]) && isfinite(s[1])))
        return sn_fail(err, SN_EINVAL, "sizes are %g and %g, need two > 0", s[0], s[1]);
    bool all = o->first == 0.0 && o->last == 0.0;
    if (!all && !(o->first >= 0.0 && o->first < o->last && o->last <= 1.0))
        return sn_fail(err, SN_EINVAL, "part of the curve is %g to %g, need 0 <= first < last <= 1", o->first,
                       o->last);
    if (!sn_v3_is_finite(o->front))
        return sn_fail(err, SN_EINVAL, "front has a coordinate that is not finite");
    return SN_OK;
}

static sn_status check_options(const sn_curve_options *o, int32_t n_point, sn_error *err)
{
    if ((o->count != 0) == (o->spacing != 0.0))
        return sn_fail(err, SN_EINVAL, "count is %d and spacing is %g, need one of them", o->count,
                       o->spacing);
    if (o->count < 0 || o->count > max_bones)
        return sn_fail(err, SN_EINVAL, "count is %d, need 1..%d", o->count, max_bones);
    if (!at_least_0(o->spacing))
        return sn_fail(err, SN_EINVAL, "spacing is %g, need a number > 0", o->spacing);
    if (o->n_control != 0 && (o->n_control < 2 || o->n_control > SN_SPLINE_FIT_MAX_POINTS))
        return sn_fail(err, SN_EINVAL, "%d control points, need 2..%d, or 0 for as many as fit", o->n_control,
                       SN_SPLINE_FIT_MAX_POINTS);
    if (n_point < 2 || n_point > max_points)
        return sn_fail(err, SN_EINVAL, "the curve has %d point%s, need 2..%d", n_point,
                       n_point == 1 ? "" : "s", max_points);
    return check_numbers(o, err);
}

/* ---- points ---- */

typedef struct stroke {
    double *point; /* n x 3: projected, neighbours different */
    int32_t n;
    sn_plane plane;
    double moved; /* by the projection, at most */
} stroke;

static sn_status project(stroke *s, const double *point, const sn_curve_options *o, sn_error *err)
{
    if (o->has_plane) {
        sn_status st = sn_plane_make(&s->plane, "curve", o->plane_point, o->plane_normal, err);
        if (st) return st;
    }
    for (int32_t i = 0; i < s->n; i++) {
        sn_vec3 p = sn_v3_load(point + 3 * (size_t)i), q = p;
        if (!sn_v3_is_finite(p))
            return sn_fail(err, SN_EINVAL, "point %d of the curve has a coordinate that is not finite",
                           i + 1);
        if (o->has_plane) q = sn_plane_project(&s->plane, p);
        s->moved = fmax(s->moved, sn_v3_dist(p, q));
        sn_v3_store(s->point + 3 * (size_t)i, q);
    }
    return SN_OK;
}

static double path_length(const double *point, int32_t n)
{
    double length = 0.0;
    for (size_t i = 1; i < (size_t)n; i++)
        length += sn_v3_dist(sn_v3_load(point + 3 * i - 3), sn_v3_load(point + 3 * i));
    return length;
}

static void join_equal(stroke *s)
{
    double least = EQUAL_REL * path_length(s->point, s->n);
    int32_t n = 1;
    for (int32_t i = 1; i < s->n; i++) {
        sn_vec3 p = sn_v3_load(s->point + 3 * (size_t)i);
        if (sn_v3_dist(p, sn_v3_load(s->point + 3 * (size_t)(n - 1))) > least)
            sn_v3_store(s->point + 3 * (size_t)n++, p);
    }
    s->n = n;
}

static sn_status stroke_make(stroke *s, const double *point, int32_t n, const sn_curve_options *o,
                             sn_error *err)
{
    *s = (stroke){.point = SN_NEW(double, 3 * (size_t)n), .n = n};
    if (!s->point) return sn_fail(err, SN_ENOMEM, "curve: no memory for %d points", n);
    sn_status st = project(s, point, o, err);
    if (st) return st;
    join_equal(s);
    if (s->n > 1) return SN_OK;
    return sn_fail(err, SN_EINVAL,
                   "all %d points of the curve are at (%g, %g, %g)%s, need two different ones", n,
                   s->point[0], s->point[1], s->point[2], o->has_plane ? " in the plane" : "");
}

/* ---- the spline ---- */

/* Points evenly spaced along the stroke. */
static void sample_stroke(const stroke *s, double *out)
{
    double length = path_length(s->point, s->n), before = 0.0;
    int32_t i = 1;
    for (int32_t k = 0; k < n_stroke; k++) {
        double want = length * k / (n_stroke - 1);
        sn_vec3 a = sn_v3_load(s->point + 3 * (size_t)(i - 1)), b = sn_v3_load(s->point + 3 * (size_t)i);
        for (; i < s->n - 1 && before + sn_v3_dist(a, b) < want; i++) {
            before += sn_v3_dist(a, b);
            a = b;
            b = sn_v3_load(s->point + 3 * (size_t)(i + 1));
        }
        sn_v3_store(out + 3 * (size_t)k, sn_v3_lerp(a, b, fmin((want - before) / sn_v3_dist(a, b), 1.0)));
    }
}

/* k control points, fitted; the plane is kept to the bit. */
static sn_status fit(const stroke *s, const sn_curve_options *o, double *control, int32_t k, double *rms,
                     sn_error *err)
{
    sn_spline_fit_report report;
    double *even = SN_NEW(double, 3 * n_stroke);
    if (!even) return sn_fail(err, SN_ENOMEM, "curve: no memory for %d points", n_stroke);
    sample_stroke(s, even);
    sn_status st = sn_spline_fit_points(&(sn_spline_fit){.path = even, .n = n_stroke}, control, k, NULL, err);
    for (int32_t i = 0; !st && o->has_plane && i < k; i++)
        sn_v3_store(control + 3 * (size_t)i,
                    sn_plane_project(&s->plane, sn_v3_load(control + 3 * (size_t)i)));
    if (!st)
        st = sn_spline_fit_distance(&(sn_spline_fit){.path = s->point, .n = s->n}, control, k, &report, err);
    if (!st) *rms = report.rms;
    sn_release(even);
    return st;
}

static int32_t control_count(const stroke *s, const sn_curve_options *o)
{
    if (o->n_control > 0) return o->n_control < s->n ? o->n_control : s->n;
    if (s->n <= max_given) return s->n;
    int32_t k = s->n / 10;
    return k < 4 ? 4 : k > max_given ? max_given : k;
}

static sn_status make_spline(const double *point, int32_t n, const sn_curve_options *o, sn_spline *spline,
                             sn_curve_report *report, sn_error *err)
{
    stroke s;
    double *control = NULL;
    sn_status st = stroke_make(&s, point, n, o, err);
    int32_t k = st ? 0 : control_count(&s, o);
    report->moved = s.moved;
    if (!st && k == s.n) st = sn_spline_build(spline, s.point, s.n, err);
    if (!st && k < s.n) {
        control = SN_NEW(double, 3 * (size_t)k);
        st = control ? fit(&s, o, control, k, &report->rms, err)
                     : sn_fail(err, SN_ENOMEM, "curve: no memory for %d points", k);
        if (!st) st = sn_spline_build(spline, control, k, err);
    }
    sn_release(control);
    sn_release(s.point);
    return st;
}

/* ---- pieces of the curve, one for each bone ---- */

typedef struct row {
    const sn_bone_template *t;
    const sn_curve_options *o;
    sn_spline spline;
    double begin;  /* arc length of the first piece's begin        */
    double length; /* of all pieces                                */
    int32_t n;
    double *piece;   /* n: lengths                                  */
    double *arc;     /* n_at: places, 2 m in each piece and the end */
    sn_vec3 *y, *z;  /* n_at: directions of the bone there          */
    int32_t m, n_at; /* the middle of piece k is place (2 k + 1) m  */
    sn_affine *map;  /* n                                           */
} row;

static void row_free(row *r)
{
    sn_spline_free(&r->spline);
    sn_release(r->piece);
    sn_release(r->arc);
    sn_release(r->y);
    sn_release(r->z);
    sn_release(r->map);
}

/* How many bones, and where the first begins. What a spacing leaves over is shared by both ends. */
static sn_status count_bones(row *r, sn_curve_report *report, sn_error *err)
{
    const sn_curve_options *o = r->o;
    double all = sn_spline_length(&r->spline), last = o->last > 0.0 ? o->last : 1.0;
    report->length = r->length = all * (last - o->first);
    r->begin = all * o->first;
    r->n = o->count;
    if (o->count == 0) {
        double n = floor(r->length / o->spacing * (1.0 + EQUAL_REL));
        if (n < 1.0)
            return sn_fail(err, SN_EINVAL, "spacing is %g, longer than the curve's %g", o->spacing,
                           r->length);
        if (n > max_bones)
            return sn_fail(err, SN_EINVAL, "spacing of %g along %g gives %g bones, need at most %d",
                           o->spacing, r->length, n, max_bones);
        r->n = (int32_t)n;
        r->begin += 0.5 * (r->length - n * o->spacing);
        r->length = n * o->spacing;
    }
    report->spacing = r->length / r->n;
    return SN_OK;
}

static sn_status row_reserve(row *r, sn_error *err)
{
    r->m = n_direction / (2 * r->n) > 2 ? n_direction / (2 * r->n) : 2;
    r->n_at = 2 * r->m * r->n + 1;
    r->piece = SN_NEW(double, r->n);
    r->map = SN_NEW(sn_affine, r->n);
    r->arc = SN_NEW(double, r->n_at);
    r->y = SN_NEW(sn_vec3, r->n_at);
    r->z = SN_NEW(sn_vec3, r->n_at);
    if (r->piece && r->map && r->arc && r->y && r->z) return SN_OK;
    return sn_fail(err, SN_ENOMEM, "curve: no memory for %d bones", r->n);
}

/* Lengths in proportion to the sizes, and the places in them. */
static void divide(row *r)
{
    double from = r->o->size[0] > 0.0 ? r->o->size[0] : 1.0, to = r->o->size[0] > 0.0 ? r->o->size[1] : 1.0;
    double sum = 0.5 * (from + to) * r->n, before = r->begin;
    for (int32_t k = 0; k < r->n; k++) {
        double s = r->n > 1 ? (double)k / (r->n - 1) : 0.5;
        r->piece[k] = r->length * ((1.0 - s) * from + s * to) / sum;
        for (int32_t i = 0; i < 2 * r->m; i++)
            r->arc[2 * r->m * k + i] = before + r->piece[k] * i / (2 * r->m);
        before += r->piece[k];
    }
    r->arc[r->n_at - 1] = before;
}

static sn_status find_directions(row *r, const sn_run *run, sn_error *err)
{
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(run))
    for (int32_t i = 0; i < r->n_at; i++)
        r->y[i] = sn_v3_scale(r->o->is_reversed ? -1.0 : 1.0, sn_spline_tangent(&r->spline, r->arc[i]));
    return sn_row_fronts(r->y, r->n_at, sn_front_or_z(r->o->front), r->z, err);
}

static void make_maps(row *r, double fill)
{
    double thickness = r->o->thickness > 0.0 ? r->o->thickness : 1.0;
    for (int32_t k = 0; k < r->n; k++) {
        int32_t at = (2 * k + 1) * r->m, seg;
        double along = fill * r->piece[k] / r->t->length, across = thickness * along, t;
        sn_vec3 y = r->y[at], z = r->z[at];
        sn_spline_at(&r->spline, r->arc[at], &seg, &t);
        r->map[k] = (sn_affine){
            .col = {sn_v3_scale(across, sn_v3_cross(y, z)), sn_v3_scale(along, y), sn_v3_scale(across, z)},
            .t = sn_cubic_point(&r->spline.seg[seg], t)};
    }
}

/* ---- bones that do not cross ---- */

static sn_status two_cross(const row *r, int32_t pair[2], const sn_run *run, sn_error *err)
{
    if (pair[0] < 0) return SN_OK;
    int32_t found[2];
    const sn_affine two[2] = {r->map[pair[0]], r->map[pair[1]]};
    sn_status st = sn_row_crossing(&r->t->bone, two, 2, run, found, err);
    if (found[0] < 0) pair[0] = pair[1] = -1;
    return st;
}

/* Smaller and smaller; the two that crossed last are looked at first, before all the others are. */
static sn_status make_room(row *r, const sn_run *run, sn_curve_report *report, sn_error *err)
{
    double asked = r->o->fill > 0.0 ? r->o->fill : 1.0, share = 1.0;
    int32_t pair[2] = {-1, -1};
    for (int step = 0;; step++) {
        share = fmax(SMALLEST, 1.0 - SHRINK_STEP * step);
        sn_status st = sn_run_step(run, "placing bones along a curve", step / (0.5 / SHRINK_STEP + 2.0), err);
        if (st) return st;
        make_maps(r, asked * share);
        bool last = share == SMALLEST;
        if (!last) st = two_cross(r, pair, run, err);
        if (!st && (last || pair[0] < 0)) st = sn_row_crossing(&r->t->bone, r->map, r->n, run, pair, err);
        if (st) return st;
        if (pair[0] < 0 || last) break;
    }
    report->fill = asked * share;
    if (pair[0] < 0) return SN_OK;
    sn_vec3 p = r->map[pair[0]].t;
    return sn_fail(err, SN_ESOLVE,
                   "bones %d and %d of %d cross near (%g, %g, %g), even at half their size (fill %g): need "
                   "fewer bones, less thickness or a curve that turns less",
                   pair[0] + 1, pair[1] + 1, r->n, p.x, p.y, p.z, report->fill);
}

/* ---- all together ---- */

static sn_status check_template(const sn_bone_template *t, sn_error *err)
{
    if (t->kind != SN_BONE_CURVE) return sn_fail(err, SN_EINVAL, "it is no bone of a row along a curve");
    if (t->length > 0.0 && isfinite(t->length)) return SN_OK;
    return sn_fail(err, SN_EINVAL, "its length along the curve is %g, need > 0", t->length);
}

static sn_status place(row *r, const double *point, int32_t n, const sn_run *run, sn_curve_report *report,
                       sn_error *err)
{
    sn_status st = check_template(r->t, err);
    if (!st) st = check_options(r->o, n, err);
    if (!st) st = make_spline(point, n, r->o, &r->spline, report, err);
    if (!st) st = count_bones(r, report, err);
    if (!st) st = row_reserve(r, err);
    if (st) return st;
    divide(r);
    st = find_directions(r, run, err);
    return st ? st : make_room(r, run, report, err);
}

sn_status sn_place_curve(const sn_bone_template *t, const double *point, int32_t n,
                         const sn_curve_options *opt, const sn_run *run, sn_affine **map, int32_t *n_map,
                         sn_curve_report *report, sn_error *err)
{
    row r = {.t = t, .o = opt};
    sn_curve_report own = {0};
    *map = NULL;
    *n_map = 0;
    sn_status st = place(&r, point, n, run, &own, err);
    if (report) *report = own;
    if (st) {
        st = sn_fail_prefix(err, st, "bone template '%s': ", sn_template_name(t));
    } else {
        *map = r.map;
        *n_map = r.n;
        r.map = NULL;
    }
    row_free(&r);
    return st;
}
