/* shape_value.c - the distance functions of shapes. */
#include "mesh/shape_private.h"

/* Round cone in the half plane through its axis: y along it from a, x away from it. The cone's flank touches
 * both circles; its outward normal is (y, x) = (s, c). */
static double capsule_value(const sn_shape *h, sn_vec3 p)
{
    sn_vec3 d = sn_v3_sub(p, h->center);
    double y = sn_v3_dot(d, h->size), x = sn_v3_len(sn_v3_mad(d, -y, h->size));
    double s = (h->radius - h->radius_b) / h->length, c = sqrt(1.0 - s * s);
    double along = y * c - x * s; /* on the flank, from where it touches a's circle */
    if (along <= 0.0) return hypot(x, y) - h->radius;
    if (along >= h->length * c) return hypot(x, y - h->length) - h->radius_b;
    return s * y + c * x - h->radius;
}

static double box_value(const sn_shape *h, sn_vec3 p)
{
    sn_vec3 d = sn_v3_sub(p, h->center);
    double x = fabs(d.x) - h->size.x + h->radius, y = fabs(d.y) - h->size.y + h->radius;
    double z = fabs(d.z) - h->size.z + h->radius;
    double out = sn_v3_len(sn_v3(fmax(x, 0.0), fmax(y, 0.0), fmax(z, 0.0)));
    return out + fmin(fmax(x, fmax(y, z)), 0.0) - h->radius;
}

/* The closest point of the ellipsoid with radii e to y is e_i^2 y_i / (t + e_i^2), where t > -min e^2 solves
 * sum (e_i y_i / (t + e_i^2))^2 = 1. Written with s = t + min e^2 >= 0 and gap_i = e_i^2 - min e^2, so that
 * nothing cancels near the focal curves. */
typedef struct ellipsoid_point {
    double ey[3], gap[3];
} ellipsoid_point;

static double excess(const ellipsoid_point *q, double s, double *slope) /* the sum minus 1, falls with s */
{
    double sum = 0.0, d = 0.0;
    for (int k = 0; k < 3; k++) {
        if (q->ey[k] <= 0.0) continue;
        double den = s + q->gap[k], g = q->ey[k] / den;
        sum += g * g;
        d -= 2.0 * g * g / den;
    }
    *slope = d;
    return sum - 1.0;
}

/* The root of excess right of lo > 0, where it is positive. Geometric bisection first: Newton's steps, which
 * never overshoot here, only grow by a constant factor while s is far too small. */
static double ellipsoid_root(const ellipsoid_point *q, double lo)
{
    double slope, hi = sqrt(q->ey[0] * q->ey[0] + q->ey[1] * q->ey[1] + q->ey[2] * q->ey[2]);
    while (hi > 4.0 * lo) {
        double mid = sqrt(lo) * sqrt(hi);
        *(excess(q, mid, &slope) > 0.0 ? &lo : &hi) = mid;
    }
    for (int i = 0; i < 50; i++) {
        double f = excess(q, lo, &slope), next = lo - f / slope;
        if (!(next > lo)) break;
        lo = next;
    }
    return lo;
}

static double ellipsoid_value(const sn_shape *h, sn_vec3 p)
{
    double unit =
        fmax(h->size.x, fmax(h->size.y, h->size.z)); /* all below is in units of the largest radius */
    sn_vec3 d = sn_v3_sub(p, h->center);
    double e[3] = {h->size.x / unit, h->size.y / unit, h->size.z / unit};
    double y[3] = {fabs(d.x) / unit, fabs(d.y) / unit, fabs(d.z) / unit};
    double e_min = fmin(e[0], fmin(e[1], e[2])), s = 0.0, slope;
    ellipsoid_point q;
    for (int k = 0; k < 3; k++) {
        q.ey[k] = e[k] * y[k];
        q.gap[k] = (e[k] - e_min) * (e[k] + e_min);
        s = fmax(s, q.ey[k] - q.gap[k]); /* one term alone makes 1: the root is not left of it */
    }
    s = fmax(s, 1e-15 * e_min * e_min);
    bool regular = excess(&q, s, &slope) > 0.0;
    s = regular ? ellipsoid_root(&q, s) : s;
    double length2 = 0.0, rest = 1.0; /* of e_min times the step's direction */
    for (int k = 0; k < 3; k++) {
        double den = s + q.gap[k], g = den > 0.0 ? y[k] / den : 0.0;
        length2 += e_min * g * e_min * g;
        rest -= e[k] * g * e[k] * g;
    }
    if (!regular) length2 += fmax(rest, 0.0); /* p is at the middle of the thinnest radius: step along it */
    return unit * (s - e_min * e_min) / e_min * sqrt(length2);
}

/* k > 0. A mean of the slopes of a and b, so no steeper than they are. */
static double smooth_min(double a, double b, double k)
{
    double h = fmax(k - fabs(a - b), 0.0) / k;
    return fmin(a, b) - 0.25 * k * h * h;
}

static double torus_value(const sn_shape *h, sn_vec3 p)
{
    sn_vec3 d = sn_v3_sub(p, h->center);
    double y = sn_v3_dot(d, h->size), x = sn_v3_len(sn_v3_mad(d, -y, h->size));
    return hypot(x - h->radius, y) - h->radius_b;
}

/* Distance of d to the segment from the origin to e, squared. */
static double segment2(sn_vec3 d, sn_vec3 e)
{
    double t = sn_v3_dot(d, e) / sn_v3_len2(e);
    return sn_v3_len2(sn_v3_mad(d, -fmin(fmax(t, 0.0), 1.0), e));
}

/* Above the triangle the distance to its plane, else that to the nearest side. */
static double plate_value(const sn_shape *h, sn_vec3 p)
{
    sn_vec3 d = sn_v3_sub(p, h->center), b = h->size, c = h->size_c;
    sn_vec3 n = sn_v3_cross(b, c), db = sn_v3_sub(d, b), bc = sn_v3_sub(c, b);
    bool above = sn_v3_dot(sn_v3_cross(b, d), n) >= 0.0 && sn_v3_dot(sn_v3_cross(bc, db), n) >= 0.0 &&
                 sn_v3_dot(sn_v3_cross(d, c), n) >= 0.0;
    if (above) return fabs(sn_v3_dot(d, n)) / sn_v3_len(n) - h->radius;
    return sqrt(fmin(segment2(d, b), fmin(segment2(d, c), segment2(db, bc)))) - h->radius;
}

static double transform_value(const sn_shape *h, sn_vec3 p)
{
    const double *r = h->turn;
    sn_vec3 d = sn_v3_sub(p, h->center);
    sn_vec3 q = sn_v3((r[0] * d.x + r[3] * d.y + r[6] * d.z) / h->size.x,
                      (r[1] * d.x + r[4] * d.y + r[7] * d.z) / h->size.y,
                      (r[2] * d.x + r[5] * d.y + r[8] * d.z) / h->size.z);
    return h->length * sn_shape_value(h->part[0], q);
}

static double mirror_value(const sn_shape *h, sn_vec3 p)
{
    double away = sn_v3_dot(sn_v3_sub(p, h->center), h->size);
    return sn_shape_value(h->part[0], sn_v3_mad(p, -2.0 * away, h->size));
}

double sn_shape_value(const sn_shape *s, sn_vec3 p)
{
    double v;
    switch (s->kind) {
    case SN_SHAPE_SPHERE:
        return sn_v3_dist(p, s->center) - s->radius;
    case SN_SHAPE_ELLIPSOID:
        return ellipsoid_value(s, p);
    case SN_SHAPE_CAPSULE:
        return capsule_value(s, p);
    case SN_SHAPE_BOX:
        return box_value(s, p);
    case SN_SHAPE_UNION:
        v = sn_shape_value(s->part[0], p);
        for (int i = 1; i < s->n_part; i++) v = fmin(v, sn_shape_value(s->part[i], p));
        return v;
    case SN_SHAPE_SMOOTH_UNION:
        v = sn_shape_value(s->part[0], p);
        for (int i = 1; i < s->n_part; i++) v = smooth_min(v, sn_shape_value(s->part[i], p), s->length);
        return v;
    case SN_SHAPE_INTERSECT:
        v = sn_shape_value(s->part[0], p);
        for (int i = 1; i < s->n_part; i++) v = fmax(v, sn_shape_value(s->part[i], p));
        return v;
    case SN_SHAPE_SMOOTH_SUBTRACT:
        return -smooth_min(-sn_shape_value(s->part[0], p), sn_shape_value(s->part[1], p), s->length);
    case SN_SHAPE_TORUS:
        return torus_value(s, p);
    case SN_SHAPE_PLATE:
        return plate_value(s, p);
    case SN_SHAPE_TRANSFORM:
        return transform_value(s, p);
    case SN_SHAPE_MIRROR:
        return mirror_value(s, p);
    case SN_SHAPE_SUBTRACT:
        return fmax(sn_shape_value(s->part[0], p), -sn_shape_value(s->part[1], p));
    }
    return NAN; /* not reached */
}
