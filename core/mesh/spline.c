#include "mesh/spline.h"

#include "base/alloc.h"

#include <string.h>

void sn_spline_free(sn_spline *s)
{
    sn_release(s->seg);
    sn_release(s->arc);
    memset(s, 0, sizeof *s);
}

/* Point i of n, with one reflected point beyond each end. */
static sn_vec3 point_at(const double *point, int32_t n, int32_t i)
{
    if (i >= 0 && i < n) return sn_v3_load(point + 3 * (size_t)i);
    int32_t end = i < 0 ? 0 : n - 1, inner = i < 0 ? 1 : n - 2;
    return sn_v3_sub(sn_v3_scale(2.0, sn_v3_load(point + 3 * (size_t)end)),
                     sn_v3_load(point + 3 * (size_t)inner));
}

/* Tangent at p1 of the non-uniform spline, times the length d1 of the span it is used in. */
static sn_vec3 tangent(sn_vec3 p0, sn_vec3 p1, sn_vec3 p2, double d0, double d1, double span)
{
    sn_vec3 a = sn_v3_scale(1.0 / d0, sn_v3_sub(p1, p0)), b = sn_v3_scale(1.0 / (d0 + d1), sn_v3_sub(p2, p0));
    sn_vec3 c = sn_v3_scale(1.0 / d1, sn_v3_sub(p2, p1));
    return sn_v3_scale(span, sn_v3_add(sn_v3_sub(a, b), c));
}

static sn_cubic segment(const double *point, int32_t n, int32_t i)
{
    sn_vec3 p[4];
    double d[3];
    for (int k = 0; k < 4; k++) p[k] = point_at(point, n, i - 1 + k);
    for (int k = 0; k < 3; k++) d[k] = sqrt(sn_v3_dist(p[k], p[k + 1]));
    sn_vec3 m1 = tangent(p[0], p[1], p[2], d[0], d[1], d[1]),
            m2 = tangent(p[1], p[2], p[3], d[1], d[2], d[1]);
    sn_vec3 chord = sn_v3_sub(p[2], p[1]);
    sn_cubic c;
    c.c[0] = p[1];
    c.c[1] = m1;
    c.c[2] = sn_v3_sub(sn_v3_scale(3.0, chord), sn_v3_add(sn_v3_scale(2.0, m1), m2));
    c.c[3] = sn_v3_sub(sn_v3_add(m1, m2), sn_v3_scale(2.0, chord));
    return c;
}

static sn_status check_points(const double *point, int32_t n, sn_error *err)
{
    if (n < 2) return sn_fail(err, SN_EINVAL, "a curve has %d point%s, need 2 or more", n, n == 1 ? "" : "s");
    for (int32_t i = 0; i < n; i++) {
        if (!sn_v3_is_finite(sn_v3_load(point + 3 * (size_t)i)))
            return sn_fail(err, SN_EINVAL, "point %d has a coordinate that is not finite", i + 1);
        if (i > 0 &&
            !(sn_v3_dist(sn_v3_load(point + 3 * (size_t)i), sn_v3_load(point + 3 * (size_t)(i - 1))) > 0.0))
            return sn_fail(err, SN_EINVAL, "points %d and %d of a curve are equal", i, i + 1);
    }
    return SN_OK;
}

sn_status sn_spline_build(sn_spline *s, const double *point, int32_t n, sn_error *err)
{
    sn_spline_free(s);
    sn_status st = check_points(point, n, err);
    if (st) return st;
    s->seg = SN_NEW(sn_cubic, n - 1);
    s->arc = SN_NEW(double, n);
    if (!s->seg || !s->arc) {
        sn_spline_free(s);
        return sn_fail(err, SN_ENOMEM, "curve: no memory for %d points", n);
    }
    s->n_seg = n - 1;
    s->arc[0] = 0.0;
    for (int32_t i = 0; i < s->n_seg; i++) {
        s->seg[i] = segment(point, n, i);
        s->arc[i + 1] = s->arc[i] + sn_cubic_length(&s->seg[i], 0.0, 1.0);
    }
    return SN_OK;
}

double sn_spline_length(const sn_spline *s)
{
    return s->n_seg ? s->arc[s->n_seg] : 0.0;
}

void sn_spline_at(const sn_spline *s, double a, int32_t *i_seg, double *t)
{
    int32_t i = 0;
    while (i < s->n_seg - 1 && a > s->arc[i + 1]) i++;
    *i_seg = i;
    double want = fmin(fmax(a - s->arc[i], 0.0), s->arc[i + 1] - s->arc[i]), lo = 0.0, hi = 1.0;
    for (int k = 0; k < 40; k++) {
        double mid = 0.5 * (lo + hi);
        if (sn_cubic_length(&s->seg[i], 0.0, mid) < want)
            lo = mid;
        else
            hi = mid;
    }
    *t = want <= 0.0 ? 0.0 : want >= s->arc[i + 1] - s->arc[i] ? 1.0 : 0.5 * (lo + hi);
}

double sn_spline_arc(const sn_spline *s, int32_t i_seg, double t)
{
    return s->arc[i_seg] + sn_cubic_length(&s->seg[i_seg], 0.0, t);
}

sn_vec3 sn_spline_tangent(const sn_spline *s, double a)
{
    int32_t seg;
    double t;
    sn_spline_at(s, a, &seg, &t);
    const sn_cubic *c = &s->seg[seg];
    sn_vec3 d = sn_cubic_tangent(c, t), chord = sn_v3_sub(sn_cubic_point(c, 1.0), c->c[0]);
    return sn_v3_unit(sn_v3_len(d) > 1e-9 * sn_v3_len(chord) ? d : chord);
}

void sn_spline_sample(const sn_spline *s, int32_t n, double *out)
{
    double length = sn_spline_length(s);
    for (int32_t i = 0; i < n; i++) {
        int32_t seg;
        double t;
        sn_spline_at(s, length * i / (n - 1), &seg, &t);
        sn_v3_store(out + 3 * (size_t)i, sn_cubic_point(&s->seg[seg], t));
    }
}
