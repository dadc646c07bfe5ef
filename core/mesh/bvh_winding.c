/* bvh_winding.c - generalized winding numbers: solid angles near, multipoles far.
 *
 * Barill, Dickson, Schmidt, Levin, Jacobson, "Fast Winding Numbers for Soups and Clouds", 2018. The winding
 * number of a surface at q is the integral of n.g(y - q) with g(x) = x / (4 pi |x|^3). Far from a cluster g
 * is expanded about the cluster's centre up to second derivatives. */
#include "mesh/bvh_private.h"

#include <string.h>

static const double PI = 3.14159265358979323846;

/* A cluster is far when q is this many radii away. The sum over a whole body of 30,000 faces is then off by
 * at most 5e-4 (SURE) and 2e-2 (QUICK, a quarter of the time). */
static const double SURE = 3.5, QUICK = 2.0;

static void add_linear_linear(double quad[6], const double a[3], const double b[3],
                              double s) /* quad += s a b */
{
    for (int i = 0, k = 0; i < 3; i++)
        for (int j = i; j < 3; j++, k++) quad[k] += s * (i == j ? a[i] * b[i] : a[i] * b[j] + a[j] * b[i]);
}

static void add_linear_quad(double cubic[10], const double a[3], const double q[6],
                            double s) /* cubic += s a q */
{
    cubic[0] += s * a[0] * q[0];
    cubic[1] += s * (a[0] * q[1] + a[1] * q[0]);
    cubic[2] += s * (a[0] * q[2] + a[2] * q[0]);
    cubic[3] += s * (a[0] * q[3] + a[1] * q[1]);
    cubic[4] += s * (a[0] * q[4] + a[1] * q[2] + a[2] * q[1]);
    cubic[5] += s * (a[0] * q[5] + a[2] * q[2]);
    cubic[6] += s * a[1] * q[3];
    cubic[7] += s * (a[1] * q[4] + a[2] * q[3]);
    cubic[8] += s * (a[1] * q[5] + a[2] * q[4]);
    cubic[9] += s * a[2] * q[5];
}

static double quad_at(const double q[6], sn_vec3 u)
{
    return u.x * (q[0] * u.x + q[1] * u.y + q[2] * u.z) + u.y * (q[3] * u.y + q[4] * u.z) + q[5] * u.z * u.z;
}

static double cubic_at(const double c[10], sn_vec3 u)
{
    return u.x * quad_at(c, u) + u.y * (u.y * (c[6] * u.y + c[7] * u.z) + c[8] * u.z * u.z) +
           c[9] * u.z * u.z * u.z;
}

static double cubic_laplacian_at(const double c[10], sn_vec3 u)
{
    return (6.0 * c[0] + 2.0 * (c[3] + c[5])) * u.x + (6.0 * c[6] + 2.0 * (c[1] + c[8])) * u.y +
           (6.0 * c[9] + 2.0 * (c[2] + c[7])) * u.z;
}

/* Area vector of a triangle: half the cross product. */
static sn_vec3 area_vector(const sn_bvh_tri *t)
{
    return sn_v3_scale(0.5, sn_v3_cross(sn_v3_sub(t->v[1], t->v[0]), sn_v3_sub(t->v[2], t->v[0])));
}

static sn_vec3 centroid(const sn_bvh_tri *t)
{
    return sn_v3_scale(1.0 / 3.0, sn_v3_add(sn_v3_add(t->v[0], t->v[1]), t->v[2]));
}

/* The mean of (d.x)^2 over a triangle is (sum of (v.x)^2 + 9 (centroid.x)^2) / 12. */
static void add_triangle(sn_bvh_moment *m, const sn_bvh_tri *t)
{
    sn_vec3 n = area_vector(t), d = sn_v3_sub(centroid(t), m->centre);
    const double a[3] = {n.x, n.y, n.z}, c[3] = {d.x, d.y, d.z};
    double square[6] = {0};
    add_linear_linear(square, c, c, 9.0 / 12.0);
    for (int k = 0; k < 3; k++) {
        sn_vec3 v = sn_v3_sub(t->v[k], m->centre);
        const double x[3] = {v.x, v.y, v.z};
        add_linear_linear(square, x, x, 1.0 / 12.0);
        m->radius = fmax(m->radius, sn_v3_len(v));
        m->linear[k] += a[k];
    }
    add_linear_linear(m->quad, a, c, 1.0);
    add_linear_quad(m->cubic, a, square, 1.0);
}

/* Moves the moments of a child to the centre of *m: d becomes d + s. */
static void add_child(sn_bvh_moment *m, const sn_bvh_moment *child)
{
    sn_vec3 shift = sn_v3_sub(child->centre, m->centre);
    const double s[3] = {shift.x, shift.y, shift.z};
    double square[6] = {0};
    add_linear_linear(square, s, s, 1.0);
    for (int k = 0; k < 3; k++) m->linear[k] += child->linear[k];
    for (int k = 0; k < 6; k++) m->quad[k] += child->quad[k];
    for (int k = 0; k < 10; k++) m->cubic[k] += child->cubic[k];
    add_linear_linear(m->quad, child->linear, s, 1.0);
    add_linear_quad(m->cubic, s, child->quad, 2.0);
    add_linear_quad(m->cubic, child->linear, square, 1.0);
    m->radius = fmax(m->radius, sn_v3_len(shift) + child->radius);
}

static void weigh(double area, sn_vec3 at, double *total, sn_vec3 *sum)
{
    *total += area;
    *sum = sn_v3_mad(*sum, area, at);
}

static sn_vec3 weighted_centre(const sn_bvh *b, const sn_bvh_node *node, double *area)
{
    sn_vec3 middle = sn_v3_lerp(node->box.min, node->box.max, 0.5), sum = sn_v3(0.0, 0.0, 0.0);
    *area = 0.0; /* places relative to the middle: no cancellation far from the origin */
    for (int32_t s = node->first; s < node->first + node->count; s++)
        weigh(sn_v3_len(area_vector(&b->tri[s])), sn_v3_sub(centroid(&b->tri[s]), middle), area, &sum);
    for (int k = 0; k < 2 && node->count == 0; k++) {
        const sn_bvh_moment *child = &b->moment[node->first + k];
        weigh(child->area, sn_v3_sub(child->centre, middle), area, &sum);
    }
    return *area > 0.0 ? sn_v3_mad(middle, 1.0 / *area, sum) : middle;
}

static double farthest_corner(const sn_box3 *b, sn_vec3 p)
{
    return sn_v3_len(sn_v3(fmax(b->max.x - p.x, p.x - b->min.x), fmax(b->max.y - p.y, p.y - b->min.y),
                           fmax(b->max.z - p.z, p.z - b->min.z)));
}

void sn_bvh_set_moments(sn_bvh *b)
{
    for (int32_t i = b->n_node - 1; i >= 0; i--) { /* children before their parents */
        const sn_bvh_node *node = &b->node[i];
        sn_bvh_moment *m = &b->moment[i];
        memset(m, 0, sizeof *m);
        m->centre = weighted_centre(b, node, &m->area);
        for (int32_t s = node->first; s < node->first + node->count; s++) add_triangle(m, &b->tri[s]);
        for (int k = 0; k < 2 && node->count == 0; k++) add_child(m, &b->moment[node->first + k]);
        m->radius = fmin(m->radius, farthest_corner(&node->box, m->centre));
    }
}

/* Van Oosterom and Strackee 1983; in units of 4 pi. 0 for q in the plane of the triangle. */
static double solid_angle(const sn_bvh_tri *t, sn_vec3 q)
{
    sn_vec3 a = sn_v3_sub(t->v[0], q), b = sn_v3_sub(t->v[1], q), c = sn_v3_sub(t->v[2], q);
    double det = sn_v3_det(a, b, c);
    if (det == 0.0) return 0.0;
    double la = sn_v3_len(a), lb = sn_v3_len(b), lc = sn_v3_len(c);
    double den = la * lb * lc + sn_v3_dot(a, b) * lc + sn_v3_dot(b, c) * la + sn_v3_dot(c, a) * lb;
    return atan2(det, den) / (2.0 * PI);
}

/* g and its derivatives along u, the direction from q to the centre at distance d. */
static double multipole(const sn_bvh_moment *m, sn_vec3 r, double d)
{
    sn_vec3 u = sn_v3_scale(1.0 / d, r);
    double dipole = m->linear[0] * u.x + m->linear[1] * u.y + m->linear[2] * u.z;
    double quadrupole = m->quad[0] + m->quad[3] + m->quad[5] - 3.0 * quad_at(m->quad, u);
    double octupole = 0.5 * (15.0 * cubic_at(m->cubic, u) - 1.5 * cubic_laplacian_at(m->cubic, u));
    return (dipole + (quadrupole + octupole / d) / d) / (4.0 * PI * d * d);
}

static double winding(const sn_bvh *b, sn_vec3 p, double far_radii)
{
    int32_t stack[SN_BVH_STACK];
    int n = 0;
    double sum = 0.0;
    stack[n++] = 0;
    while (n > 0) {
        int32_t i = stack[--n];
        const sn_bvh_node *node = &b->node[i];
        const sn_bvh_moment *m = &b->moment[i];
        sn_vec3 r = sn_v3_sub(m->centre, p);
        double d = sn_v3_len(r);
        if (d > far_radii * m->radius) {
            sum += multipole(m, r, d);
        } else if (node->count == 0) {
            stack[n++] = node->first + 1;
            stack[n++] = node->first;
        } else {
            for (int32_t s = node->first; s < node->first + node->count; s++)
                sum += solid_angle(&b->tri[s], p);
        }
    }
    return sum;
}

double sn_bvh_winding(const sn_bvh *b, sn_vec3 p)
{
    return winding(b, p, SURE);
}

bool sn_bvh_contains(const sn_bvh *b, sn_vec3 p)
{
    double w = winding(b, p, QUICK);
    return fabs(w - 0.5) > 0.2 ? w > 0.5 : sn_bvh_winding(b, p) > 0.5;
}
