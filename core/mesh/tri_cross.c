/* tri_cross.c - where segments and triangles meet, by exact signs (declared in predicates.h). */
#include "mesh/predicates.h"

typedef struct tri {
    sn_vec3 v[3];
} tri;

static bool same_point(sn_vec3 a, sn_vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static bool between(double x, double a, double b)
{
    return a < b ? a <= x && x <= b : b <= x && x <= a;
}

static bool in_segment_box(sn_vec3 p, sn_vec3 a, sn_vec3 b)
{
    return between(p.x, a.x, b.x) && between(p.y, a.y, b.y) && between(p.z, a.z, b.z);
}

static bool on_segment(sn_vec3 p, sn_vec3 a, sn_vec3 b)
{
    return in_segment_box(p, a, b) && sn_triangle_is_degenerate(p, a, b);
}

/* A coordinate whose dropping keeps the triangle's area; -1 when it has none. */
static int projection_axis(sn_vec3 a, sn_vec3 b, sn_vec3 c)
{
    sn_vec3 n = sn_v3_cross(sn_v3_sub(b, a), sn_v3_sub(c, a));
    double x = fabs(n.x), y = fabs(n.y), z = fabs(n.z);
    int first = x >= y && x >= z ? 0 : y >= z ? 1 : 2; /* the likely best one */
    for (int k = 0; k < 3; k++)
        if (sn_orient2d(a, b, c, (first + k) % 3) != 0) return (first + k) % 3;
    return -1;
}

/* Both segments lie in one plane that dropping `axis` maps one to one. */
static bool segments_meet_in_plane(sn_vec3 a, sn_vec3 b, sn_vec3 c, sn_vec3 d, int axis)
{
    int sc = sn_orient2d(a, b, c, axis), sd = sn_orient2d(a, b, d, axis);
    if (sc * sd > 0) return false;
    int sa = sn_orient2d(c, d, a, axis), sb = sn_orient2d(c, d, b, axis);
    if (sa * sb > 0) return false;
    if (sc * sd < 0 && sa * sb < 0) return true;
    return (sc == 0 && in_segment_box(c, a, b)) || (sd == 0 && in_segment_box(d, a, b)) ||
           (sa == 0 && in_segment_box(a, c, d)) || (sb == 0 && in_segment_box(b, c, d));
}

static bool segments_meet(sn_vec3 a, sn_vec3 b, sn_vec3 c, sn_vec3 d)
{
    if (sn_orient3d(a, b, c, d) != 0) return false;
    int axis = projection_axis(a, b, c);
    if (axis < 0) axis = projection_axis(a, b, d);
    if (axis < 0) axis = projection_axis(c, d, a);
    if (axis < 0) axis = projection_axis(c, d, b);
    if (axis >= 0) return segments_meet_in_plane(a, b, c, d, axis);
    return on_segment(a, c, d) || on_segment(b, c, d) || on_segment(c, a, b) || on_segment(d, a, b);
}

static bool in_triangle_in_plane(sn_vec3 x, const tri *t, int axis)
{
    int s0 = sn_orient2d(t->v[0], t->v[1], x, axis), s1 = sn_orient2d(t->v[1], t->v[2], x, axis),
        s2 = sn_orient2d(t->v[2], t->v[0], x, axis);
    return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
}

/* As sn_segment_meets_triangle, for a segment in the plane of t (any segment when t has no area). */
static bool meets_in_plane(sn_vec3 a, sn_vec3 b, const tri *t)
{
    int axis = projection_axis(t->v[0], t->v[1], t->v[2]);
    if (axis < 0)
        return segments_meet(a, b, t->v[0], t->v[1]) || segments_meet(a, b, t->v[1], t->v[2]) ||
               segments_meet(a, b, t->v[2], t->v[0]);
    if (in_triangle_in_plane(a, t, axis)) return true;
    for (int k = 0; k < 3; k++)
        if (segments_meet_in_plane(a, b, t->v[k], t->v[(k + 1) % 3], axis)) return true;
    return false;
}

/* sa, sb: the sides of t on which a and b lie. */
static bool meets(sn_vec3 a, int sa, sn_vec3 b, int sb, const tri *t)
{
    if (sa * sb > 0) return false;
    if (sa == 0 && sb == 0) return meets_in_plane(a, b, t);
    int s0 = sn_orient3d(a, b, t->v[0], t->v[1]), s1 = sn_orient3d(a, b, t->v[1], t->v[2]);
    if (s0 * s1 < 0) return false;
    int s2 = sn_orient3d(a, b, t->v[2], t->v[0]);
    return s0 * s2 >= 0 && s1 * s2 >= 0;
}

static int side(const tri *t, sn_vec3 x)
{
    return sn_orient3d(t->v[0], t->v[1], t->v[2], x);
}

bool sn_segment_meets_triangle(sn_vec3 a, sn_vec3 b, sn_vec3 p, sn_vec3 q, sn_vec3 r)
{
    const tri t = {{p, q, r}};
    return meets(a, side(&t, a), b, side(&t, b), &t);
}

static bool apart(double a0, double a1, double a2, double b0, double b1, double b2)
{
    return (a0 < b0 && a0 < b1 && a0 < b2 && a1 < b0 && a1 < b1 && a1 < b2 && a2 < b0 && a2 < b1 &&
            a2 < b2) ||
           (a0 > b0 && a0 > b1 && a0 > b2 && a1 > b0 && a1 > b1 && a1 > b2 && a2 > b0 && a2 > b1 && a2 > b2);
}

static bool boxes_apart(const tri *s, const tri *t)
{
    return apart(s->v[0].x, s->v[1].x, s->v[2].x, t->v[0].x, t->v[1].x, t->v[2].x) ||
           apart(s->v[0].y, s->v[1].y, s->v[2].y, t->v[0].y, t->v[1].y, t->v[2].y) ||
           apart(s->v[0].z, s->v[1].z, s->v[2].z, t->v[0].z, t->v[1].z, t->v[2].z);
}

/* Signs of the corners of t, from `from` on, by the plane of s; false when all lie strictly on one side. */
static bool straddles(const tri *s, const tri *t, int from, int sign[3])
{
    int low = 1, high = -1;
    for (int k = from; k < 3; k++) {
        sign[k] = side(s, t->v[k]);
        if (sign[k] < low) low = sign[k];
        if (sign[k] > high) high = sign[k];
    }
    return low <= 0 && high >= 0;
}

static bool cross_apart(const tri *s, const tri *t)
{
    int on_s[3], on_t[3];
    if (!straddles(s, t, 0, on_s) || !straddles(t, s, 0, on_t)) return false;
    for (int k = 0; k < 3; k++) {
        int l = (k + 1) % 3;
        if (meets(s->v[k], on_t[k], s->v[l], on_t[l], t) || meets(t->v[k], on_s[k], t->v[l], on_s[l], s))
            return true;
    }
    return false;
}

/* The part of t that lies opposite its corner 0 meets s elsewhere than in that corner, which s has too. A
 * segment from the corner that stays in both triangles leaves one of them opposite the corner: testing that
 * for s and for t is enough. on_s: the sides of s on which the corners of t lie. */
static bool far_side_meets(const tri *s, const tri *t, const int on_s[3])
{
    if (!on_segment(t->v[0], t->v[1], t->v[2])) return meets(t->v[1], on_s[1], t->v[2], on_s[2], s);
    for (int k = 1; k < 3; k++) /* t is a segment through its corner: it ends in the other two */
        if (!same_point(t->v[k], t->v[0]) && on_s[k] == 0 && meets_in_plane(t->v[k], t->v[k], s)) return true;
    return false;
}

static bool cross_at_corner(const tri *s, const tri *t) /* shared: corner 0 of both */
{
    int on_s[3] = {0, 0, 0}, on_t[3] = {0, 0, 0};
    if (!straddles(s, t, 1, on_s) || !straddles(t, s, 1, on_t)) return false;
    return far_side_meets(s, t, on_s) || far_side_meets(t, s, on_t);
}

static bool passes(sn_vec3 a, sn_vec3 b, sn_vec3 c) /* c lies behind b seen from a */
{
    return !same_point(b, c) && on_segment(b, a, c);
}

static bool folds_at_edge(const tri *s, const tri *t) /* shared: corners 0 and 1 of both */
{
    sn_vec3 a = s->v[0], b = s->v[1], c = s->v[2], d = t->v[2];
    if (sn_orient3d(a, b, c, d) != 0) return false;
    int axis = projection_axis(a, b, c), t_axis = projection_axis(a, b, d);
    if (axis >= 0 && t_axis >= 0) return sn_orient2d(a, b, c, axis) == sn_orient2d(a, b, d, axis);
    if (axis >= 0 || t_axis >= 0) return false; /* the line ab meets the other in the shared edge only */
    if (same_point(a, b))                       /* two segments from one point */
        return (!same_point(c, a) && on_segment(c, a, d)) || (!same_point(d, a) && on_segment(d, a, c));
    return (passes(a, b, c) && passes(a, b, d)) || (passes(b, a, c) && passes(b, a, d));
}

/* Brings the corners with equal ids to the front of both triangles, in the same order. Returns how many there
 * are. */
static int align(const sn_vec3 p[3], const int i[3], const sn_vec3 q[3], const int j[3], tri *s, tri *t)
{
    bool used_p[3] = {false, false, false}, used_q[3] = {false, false, false};
    int n = 0;
    for (int k = 0; k < 3; k++) {
        if ((k > 0 && i[k] == i[0]) || (k > 1 && i[k] == i[1])) continue; /* an id counts once */
        for (int l = 0; l < 3; l++)
            if (i[k] == j[l]) {
                used_p[k] = used_q[l] = true;
                s->v[n] = p[k];
                t->v[n++] = q[l];
                break;
            }
    }
    for (int k = 0, np = n, nq = n; k < 3; k++) {
        if (!used_p[k]) s->v[np++] = p[k];
        if (!used_q[k]) t->v[nq++] = q[k];
    }
    return n;
}

/* ---- plainly apart: what rounding cannot overturn, so that flat regions need no exact arithmetic ---- */

#define APART_REL 1e-14 /* margin over coordinate size: some 50 roundings */

static double size_of(sn_vec3 a)
{
    return fabs(a.x) + fabs(a.y) + fabs(a.z);
}

static double margin_of(const tri *s, const tri *t)
{
    double m = 0.0;
    for (int k = 0; k < 3; k++) m = fmax(m, fmax(size_of(s->v[k]), size_of(t->v[k])));
    return APART_REL * m;
}

/* Whether the plane across n through o keeps corners from `from` on of s on its back and those of t on its
 * front; `from` = 1: o is the shared corner; 0: any plane across n will do. */
static bool splits(sn_vec3 n, sn_vec3 o, const tri *s, const tri *t, int from, double margin)
{
    double high = -INFINITY, low = INFINITY, m = margin * size_of(n);
    for (int k = from; k < 3; k++) {
        high = fmax(high, sn_v3_dot(n, sn_v3_sub(s->v[k], o)));
        low = fmin(low, sn_v3_dot(n, sn_v3_sub(t->v[k], o)));
    }
    return from ? high < -m && low > m : low - high > m;
}

static sn_vec3 direction(const tri *t)
{
    return sn_v3_add(sn_v3_unit(sn_v3_sub(t->v[1], t->v[0])), sn_v3_unit(sn_v3_sub(t->v[2], t->v[0])));
}

/* The planes that hold an edge of s and stand upright on it. */
static bool edge_splits(const tri *s, const tri *t, double margin)
{
    sn_vec3 up = sn_v3_cross(sn_v3_sub(s->v[1], s->v[0]), sn_v3_sub(s->v[2], s->v[0]));
    for (int k = 0; k < 3; k++) {
        sn_vec3 n = sn_v3_cross(sn_v3_sub(s->v[(k + 1) % 3], s->v[k]), up);
        if (splits(n, s->v[k], s, t, 0, margin)) return true;
    }
    return false;
}

static bool plainly_apart(const tri *s, const tri *t, int n_shared)
{
    double margin = margin_of(s, t);
    if (n_shared == 0) return edge_splits(s, t, margin) || edge_splits(t, s, margin);
    if (n_shared == 1) return splits(sn_v3_sub(direction(t), direction(s)), s->v[0], s, t, 1, margin);
    sn_vec3 e = sn_v3_sub(s->v[1], s->v[0]), u = sn_v3_sub(s->v[2], s->v[0]), v = sn_v3_sub(t->v[2], t->v[0]);
    sn_vec3 a = sn_v3_cross(e, u), b = sn_v3_cross(e, v); /* they point apart across a flat edge */
    double longest = sqrt(fmax(sn_v3_len2(u), sn_v3_len2(v))), l2 = sn_v3_len2(e);
    return sn_v3_dot(a, b) < -4.0 * margin * l2 * (longest + sqrt(l2));
}

bool sn_triangles_cross(const sn_vec3 p[3], const int i[3], const sn_vec3 q[3], const int j[3])
{
    tri s, t;
    int n_shared = align(p, i, q, j, &s, &t);
    switch (n_shared) {
    case 0:
        return !boxes_apart(&s, &t) && !plainly_apart(&s, &t, 0) && cross_apart(&s, &t);
    case 1:
        return !plainly_apart(&s, &t, 1) && cross_at_corner(&s, &t);
    case 2:
        return !plainly_apart(&s, &t, 2) && folds_at_edge(&s, &t);
    default:
        return true;
    }
}
