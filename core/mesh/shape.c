#include "mesh/shape.h"

#include "base/alloc.h"
#include "mesh/mesh_check.h"
#include "mesh/polygonize.h"
#include "mesh/remesh.h"

#include <stdatomic.h>

#define MAX_SIZE 1e50 /* squares and products of sizes stay finite and above zero */
#define MIN_SIZE 1e-50
#define MAX_DEPTH 1000 /* values and releases recurse */
#define LATTICE_REL                                                                                          \
    0.6 /* lattice cell over edge length: the remesher starts with some more detail than it keeps */

typedef enum shape_kind { SPHERE, ELLIPSOID, CAPSULE, BOX, UNION, SMOOTH_UNION, SUBTRACT } shape_kind;

struct sn_shape {
    atomic_int refs;
    shape_kind kind;
    int depth;       /* 1 for a leaf */
    sn_box3 bounds;  /* outside it the value is at least the distance to it */
    sn_vec3 center;  /* capsule: the end a                           */
    sn_vec3 size;    /* radii, half sizes; capsule: unit vector to b */
    double radius;   /* sphere; capsule: at a; box: of its edges     */
    double radius_b; /* capsule: at b                                */
    double length;   /* capsule: of the axis; smooth union: k        */
    sn_shape **part; /* n_part operands, retained; owned array       */
    int n_part;
};

/* ---- distances ---- */

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

double sn_shape_value(const sn_shape *s, sn_vec3 p)
{
    double v;
    switch (s->kind) {
    case SPHERE:
        return sn_v3_dist(p, s->center) - s->radius;
    case ELLIPSOID:
        return ellipsoid_value(s, p);
    case CAPSULE:
        return capsule_value(s, p);
    case BOX:
        return box_value(s, p);
    case UNION:
        v = sn_shape_value(s->part[0], p);
        for (int i = 1; i < s->n_part; i++) v = fmin(v, sn_shape_value(s->part[i], p));
        return v;
    case SMOOTH_UNION:
        v = sn_shape_value(s->part[0], p);
        for (int i = 1; i < s->n_part; i++) v = smooth_min(v, sn_shape_value(s->part[i], p), s->length);
        return v;
    case SUBTRACT:
        return fmax(sn_shape_value(s->part[0], p), -sn_shape_value(s->part[1], p));
    }
    return NAN; /* not reached */
}

sn_box3 sn_shape_bounds(const sn_shape *s)
{
    return s->bounds;
}

/* ---- checks of arguments ---- */

static sn_status check_point(sn_vec3 p, const char *shape, const char *name, sn_error *err)
{
    double far = fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z)));
    if (sn_v3_is_finite(p) && far <= MAX_SIZE) return SN_OK;
    return sn_fail(err, SN_EINVAL, "%s: %s is (%g, %g, %g), need finite coordinates up to %g", shape, name,
                   p.x, p.y, p.z, MAX_SIZE);
}

static sn_status check_size(double x, const char *shape, const char *name, sn_error *err)
{
    if (x >= MIN_SIZE && x <= MAX_SIZE) return SN_OK;
    return sn_fail(err, SN_EINVAL, "%s: %s is %g, need > 0 (%g to %g)", shape, name, x, MIN_SIZE, MAX_SIZE);
}

static sn_status check_sizes(sn_vec3 v, const char *shape, const char *const name[3], sn_error *err)
{
    sn_status st = check_size(v.x, shape, name[0], err);
    if (!st) st = check_size(v.y, shape, name[1], err);
    if (!st) st = check_size(v.z, shape, name[2], err);
    return st;
}

static sn_status check_parts(sn_shape *const *s, int n, const char *shape, int *depth, sn_error *err)
{
    if (n < 1) return sn_fail(err, SN_EINVAL, "%s: %d shapes, need at least 1", shape, n);
    for (int i = 0; i < n; i++) {
        if (!s[i]) return sn_fail(err, SN_EINVAL, "%s: shape %d of %d is missing", shape, i + 1, n);
        if (s[i]->depth > *depth) *depth = s[i]->depth;
    }
    if (*depth >= MAX_DEPTH)
        return sn_fail(err, SN_ELIMIT, "%s: nested deeper than %d; give many shapes to one union instead",
                       shape, MAX_DEPTH);
    return SN_OK;
}

/* ---- making and releasing ---- */

static sn_status make(sn_shape **out, shape_kind kind, const char *name, sn_error *err)
{
    sn_shape *s = SN_NEW_ZERO(sn_shape, 1);
    if (!s) return sn_fail(err, SN_ENOMEM, "%s: no memory", name);
    atomic_init(&s->refs, 1);
    s->kind = kind;
    s->depth = 1;
    *out = s;
    return SN_OK;
}

static sn_status make_of_parts(sn_shape **out, shape_kind kind, const char *name, sn_shape *const *part,
                               int n, sn_error *err)
{
    int depth = 0;
    sn_status st = check_parts(part, n, name, &depth, err);
    if (!st) st = make(out, kind, name, err);
    if (st) return st;
    sn_shape *s = *out;
    s->depth = depth + 1;
    s->part = SN_NEW(sn_shape *, n);
    if (!s->part) {
        sn_shape_release(s);
        *out = NULL;
        return sn_fail(err, SN_ENOMEM, "%s: no memory for %d shapes", name, n);
    }
    s->n_part = n;
    s->bounds = sn_box3_empty();
    for (int i = 0; i < n; i++) {
        s->part[i] = sn_shape_retain(part[i]);
        s->bounds = sn_box3_merge(s->bounds, part[i]->bounds);
    }
    return SN_OK;
}

sn_shape *sn_shape_retain(sn_shape *s)
{
    if (s) atomic_fetch_add(&s->refs, 1);
    return s;
}

void sn_shape_release(sn_shape *s)
{
    if (!s || atomic_fetch_sub(&s->refs, 1) > 1) return;
    for (int i = 0; i < s->n_part; i++) sn_shape_release(s->part[i]);
    sn_release(s->part);
    sn_release(s);
}

static sn_box3 box_around(sn_vec3 c, sn_vec3 half)
{
    return (sn_box3){sn_v3_sub(c, half), sn_v3_add(c, half)};
}

sn_status sn_shape_sphere(sn_shape **out, sn_vec3 center, double radius, sn_error *err)
{
    *out = NULL;
    sn_status st = check_point(center, "sphere", "center", err);
    if (!st) st = check_size(radius, "sphere", "radius", err);
    if (!st) st = make(out, SPHERE, "sphere", err);
    if (st) return st;
    (*out)->center = center;
    (*out)->radius = radius;
    (*out)->bounds = box_around(center, sn_v3(radius, radius, radius));
    return SN_OK;
}

sn_status sn_shape_ellipsoid(sn_shape **out, sn_vec3 center, sn_vec3 radii, sn_error *err)
{
    static const char *const name[3] = {"radius along x", "radius along y", "radius along z"};
    *out = NULL;
    sn_status st = check_point(center, "ellipsoid", "center", err);
    if (!st) st = check_sizes(radii, "ellipsoid", name, err);
    if (!st) st = make(out, ELLIPSOID, "ellipsoid", err);
    if (st) return st;
    (*out)->center = center;
    (*out)->size = radii;
    (*out)->bounds = box_around(center, radii);
    return SN_OK;
}

sn_status sn_shape_capsule(sn_shape **out, sn_vec3 a, sn_vec3 b, double ra, double rb, sn_error *err)
{
    *out = NULL;
    sn_status st = check_point(a, "capsule", "end a", err);
    if (!st) st = check_point(b, "capsule", "end b", err);
    if (!st) st = check_size(ra, "capsule", "radius at a", err);
    if (!st) st = check_size(rb, "capsule", "radius at b", err);
    if (st) return st;
    double length = sn_v3_dist(a, b);
    if (!(length > fabs(ra - rb))) return sn_shape_sphere(out, ra >= rb ? a : b, fmax(ra, rb), err);
    st = make(out, CAPSULE, "capsule", err);
    if (st) return st;
    (*out)->center = a;
    (*out)->size = sn_v3_unit(sn_v3_sub(b, a));
    (*out)->radius = ra;
    (*out)->radius_b = rb;
    (*out)->length = length;
    (*out)->bounds = sn_box3_merge(box_around(a, sn_v3(ra, ra, ra)), box_around(b, sn_v3(rb, rb, rb)));
    return SN_OK;
}

sn_status sn_shape_box(sn_shape **out, sn_vec3 center, sn_vec3 half, double rounding, sn_error *err)
{
    static const char *const name[3] = {"half size along x", "half size along y", "half size along z"};
    *out = NULL;
    sn_status st = check_point(center, "box", "center", err);
    if (!st) st = check_sizes(half, "box", name, err);
    if (st) return st;
    double most = fmin(half.x, fmin(half.y, half.z));
    if (!(rounding >= 0.0 && rounding <= most))
        return sn_fail(err, SN_EINVAL, "box: rounding is %g, need 0 to the smallest half size %g", rounding,
                       most);
    st = make(out, BOX, "box", err);
    if (st) return st;
    (*out)->center = center;
    (*out)->size = half;
    (*out)->radius = rounding;
    (*out)->bounds = box_around(center, half);
    return SN_OK;
}

sn_status sn_shape_union(sn_shape **out, sn_shape *const *s, int n, sn_error *err)
{
    *out = NULL;
    return make_of_parts(out, UNION, "union", s, n, err);
}

sn_status sn_shape_smooth_union(sn_shape **out, double k, sn_shape *const *s, int n, sn_error *err)
{
    *out = NULL;
    sn_status st = check_size(k, "smooth_union", "k", err);
    if (!st) st = make_of_parts(out, SMOOTH_UNION, "smooth_union", s, n, err);
    if (st) return st;
    double swell = 0.0; /* in k: by how much n equal values blend below themselves; below 1 for any n */
    for (int i = 1; i < n; i++) swell += 0.25 * (1.0 - swell) * (1.0 - swell);
    sn_box3 b = (*out)->bounds;
    sn_vec3 m = sn_v3(swell * k, swell * k, swell * k);
    (*out)->bounds = (sn_box3){sn_v3_sub(b.min, m), sn_v3_add(b.max, m)};
    (*out)->length = k;
    return SN_OK;
}

sn_status sn_shape_subtract(sn_shape **out, sn_shape *a, sn_shape *b, sn_error *err)
{
    sn_shape *part[2] = {a, b};
    *out = NULL;
    sn_status st = make_of_parts(out, SUBTRACT, "subtract", part, 2, err);
    if (!st) (*out)->bounds = a->bounds;
    return st;
}

/* ---- mesh ---- */

static double value_of(void *user, sn_vec3 p)
{
    return sn_shape_value(user, p);
}

static sn_status polygonize(const sn_shape *s, double cell, const sn_run *run, sn_tri_mesh *out,
                            sn_error *err)
{
    double h = LATTICE_REL * cell;
    /* Odd shares of a cell: sides of a box whose size is a whole number of cells do not fall on lattice
     * points. */
    sn_box3 box = {sn_v3_sub(s->bounds.min, sn_v3(0.31 * h, 0.37 * h, 0.29 * h)), s->bounds.max};
    double least = 1.01 / LATTICE_REL * sn_polygonize_smallest_cell(box);
    if (cell < least)
        return sn_fail(err, SN_ELIMIT,
                       "shape: cell %g needs more than 2e8 lattice points; a cell of %.3g would do", cell,
                       least);
    sn_polygonize p = {
        .value = value_of, .user = (void *)(uintptr_t)s, .box = box, .cell = h, .is_distance = true};
    sn_status st = sn_polygonize_run(&p, run, out, err);
    if (st || out->n_face > 0) return st;
    sn_vec3 d = sn_v3_sub(s->bounds.max, s->bounds.min);
    return sn_fail(
        err, SN_EMESH,
        "shape: nothing inside at cell %g; the shape, in %g x %g x %g, is empty or thinner than a cell", cell,
        d.x, d.y, d.z);
}

/* Remeshes fine into *out, or leaves *out empty where the result is not sound. */
static sn_status remesh(const sn_tri_mesh *fine, double cell, const sn_run *run, sn_tri_mesh *out,
                        sn_error *err)
{
    sn_remesh opt = {.edge_length = cell};
    sn_status st = sn_remesh_run(fine, &opt, run, out, NULL, err);
    sn_mesh_check c = {.closed = false};
    if (!st && out->n_face > 0) st = sn_mesh_check_run(&c, out, run, err);
    bool sound =
        !st && c.closed && c.manifold && c.oriented && c.self_intersections == 0 && c.degenerate_faces == 0;
    if (!sound) sn_tri_mesh_free(out);
    return st == SN_EMESH ? SN_OK : st;
}

sn_status sn_shape_mesh(const sn_shape *s, double cell, const sn_run *run, sn_tri_mesh *out, sn_error *err)
{
    sn_tri_mesh_free(out);
    if (!(cell > 0.0 && isfinite(cell))) return sn_fail(err, SN_EINVAL, "shape: cell is %g, need > 0", cell);
    sn_tri_mesh fine;
    sn_tri_mesh_init(&fine);
    sn_status st = polygonize(s, cell, run, &fine, err);
    if (!st) st = remesh(&fine, cell, run, out, err);
    if (!st && out->n_face == 0) {
        *out = fine;
        sn_tri_mesh_init(&fine);
    }
    sn_tri_mesh_free(&fine);
    return st;
}
