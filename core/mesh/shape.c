#include "mesh/shape.h"

#include "base/alloc.h"
#include "mesh/mesh_check.h"
#include "mesh/polygonize.h"
#include "mesh/remesh.h"
#include "mesh/shape_private.h"

#define MAX_SIZE 1e50 /* squares and products of sizes stay finite and above zero */
#define MIN_SIZE 1e-50
#define MAX_DEPTH 1000 /* values and releases recurse */
#define LATTICE_REL                                                                                          \
    0.6 /* lattice cell over edge length: the remesher starts with some more detail than it keeps */

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

static sn_status check_direction(sn_vec3 v, const char *shape, const char *name, sn_error *err)
{
    sn_status st = check_point(v, shape, name, err);
    if (!st && !(sn_v3_len(v) >= MIN_SIZE))
        st = sn_fail(err, SN_EINVAL, "%s: %s is (%g, %g, %g), need a direction", shape, name, v.x, v.y, v.z);
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

static sn_status make(sn_shape **out, sn_shape_kind kind, const char *name, sn_error *err)
{
    sn_shape *s = SN_NEW_ZERO(sn_shape, 1);
    if (!s) return sn_fail(err, SN_ENOMEM, "%s: no memory", name);
    atomic_init(&s->refs, 1);
    s->kind = kind;
    s->depth = 1;
    *out = s;
    return SN_OK;
}

static sn_status make_of_parts(sn_shape **out, sn_shape_kind kind, const char *name, sn_shape *const *part,
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
    if (!st) st = make(out, SN_SHAPE_SPHERE, "sphere", err);
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
    if (!st) st = make(out, SN_SHAPE_ELLIPSOID, "ellipsoid", err);
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
    st = make(out, SN_SHAPE_CAPSULE, "capsule", err);
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
    st = make(out, SN_SHAPE_BOX, "box", err);
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
    return make_of_parts(out, SN_SHAPE_UNION, "union", s, n, err);
}

sn_status sn_shape_smooth_union(sn_shape **out, double k, sn_shape *const *s, int n, sn_error *err)
{
    *out = NULL;
    sn_status st = check_size(k, "smooth_union", "k", err);
    if (!st) st = make_of_parts(out, SN_SHAPE_SMOOTH_UNION, "smooth_union", s, n, err);
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
    sn_status st = make_of_parts(out, SN_SHAPE_SUBTRACT, "subtract", part, 2, err);
    if (!st) (*out)->bounds = a->bounds;
    return st;
}

sn_status sn_shape_intersect(sn_shape **out, sn_shape *const *s, int n, sn_error *err)
{
    *out = NULL;
    sn_status st = make_of_parts(out, SN_SHAPE_INTERSECT, "intersect", s, n, err);
    if (st) return st;
    int best = 0;
    for (int i = 1; i < n; i++)
        if (sn_box3_diagonal(s[i]->bounds) < sn_box3_diagonal(s[best]->bounds)) best = i;
    (*out)->bounds = s[best]->bounds;
    return SN_OK;
}

sn_status sn_shape_smooth_subtract(sn_shape **out, double k, sn_shape *a, sn_shape *b, sn_error *err)
{
    sn_shape *part[2] = {a, b};
    *out = NULL;
    sn_status st = check_size(k, "smooth_subtract", "k", err);
    if (!st) st = make_of_parts(out, SN_SHAPE_SMOOTH_SUBTRACT, "smooth_subtract", part, 2, err);
    if (st) return st;
    (*out)->bounds = a->bounds;
    (*out)->length = k;
    return SN_OK;
}

sn_status sn_shape_torus(sn_shape **out, sn_vec3 center, sn_vec3 axis, double ring, double tube,
                         sn_error *err)
{
    *out = NULL;
    sn_status st = check_point(center, "torus", "center", err);
    if (!st) st = check_direction(axis, "torus", "axis", err);
    if (!st) st = check_size(ring, "torus", "radius of the ring", err);
    if (!st) st = check_size(tube, "torus", "radius of the tube", err);
    if (!st) st = make(out, SN_SHAPE_TORUS, "torus", err);
    if (st) return st;
    sn_vec3 n = sn_v3_unit(axis);
    sn_vec3 half = sn_v3(hypot(n.y, n.z), hypot(n.x, n.z), hypot(n.x, n.y));
    (*out)->center = center;
    (*out)->size = n;
    (*out)->radius = ring;
    (*out)->radius_b = tube;
    (*out)->bounds = box_around(center, sn_v3_add(sn_v3_scale(ring, half), sn_v3(tube, tube, tube)));
    return SN_OK;
}

sn_status sn_shape_plate(sn_shape **out, sn_vec3 a, sn_vec3 b, sn_vec3 c, double radius, sn_error *err)
{
    *out = NULL;
    sn_status st = check_point(a, "plate", "corner a", err);
    if (!st) st = check_point(b, "plate", "corner b", err);
    if (!st) st = check_point(c, "plate", "corner c", err);
    if (!st) st = check_size(radius, "plate", "radius", err);
    if (st) return st;
    sn_vec3 ab = sn_v3_sub(b, a), ac = sn_v3_sub(c, a);
    double high = sn_v3_len(sn_v3_cross(ab, ac)), longest = fmax(sn_v3_len2(ab), sn_v3_len2(ac));
    if (!(high > 1e-9 * longest))
        return sn_fail(err, SN_EINVAL, "plate: its corners lie on a line, need a triangle");
    st = make(out, SN_SHAPE_PLATE, "plate", err);
    if (st) return st;
    sn_vec3 r = sn_v3(radius, radius, radius);
    (*out)->center = a;
    (*out)->size = ab;
    (*out)->size_c = ac;
    (*out)->radius = radius;
    (*out)->bounds = sn_box3_merge(box_around(a, r), sn_box3_merge(box_around(b, r), box_around(c, r)));
    return SN_OK;
}

/* ---- moved shapes ---- */

static void set_rotation(double r[9], sn_vec3 axis, double degrees)
{
    sn_vec3 n = sn_v3_unit(axis);
    double a = degrees * (acos(-1.0) / 180.0), c = cos(a), s = sin(a), f = 1.0 - c;
    double m[9] = {c + f * n.x * n.x,       f * n.x * n.y - s * n.z, f * n.x * n.z + s * n.y,
                   f * n.x * n.y + s * n.z, c + f * n.y * n.y,       f * n.y * n.z - s * n.x,
                   f * n.x * n.z - s * n.y, f * n.y * n.z + s * n.x, c + f * n.z * n.z};
    for (int i = 0; i < 9; i++) r[i] = m[i];
}

/* Where shape h takes the point q of its operand. */
static sn_vec3 placed(const sn_shape *h, sn_vec3 q)
{
    const double *r = h->turn;
    if (h->kind == SN_SHAPE_MIRROR)
        return sn_v3_mad(q, -2.0 * sn_v3_dot(sn_v3_sub(q, h->center), h->size), h->size);
    sn_vec3 d = sn_v3(q.x * h->size.x, q.y * h->size.y, q.z * h->size.z);
    return sn_v3_add(h->center,
                     sn_v3(r[0] * d.x + r[1] * d.y + r[2] * d.z, r[3] * d.x + r[4] * d.y + r[5] * d.z,
                           r[6] * d.x + r[7] * d.y + r[8] * d.z));
}

static void set_placed_bounds(sn_shape *h)
{
    sn_box3 b = h->part[0]->bounds;
    h->bounds = sn_box3_empty();
    for (int k = 0; k < 8; k++) {
        sn_vec3 q = sn_v3(k & 1 ? b.max.x : b.min.x, k & 2 ? b.max.y : b.min.y, k & 4 ? b.max.z : b.min.z);
        h->bounds = sn_box3_add(h->bounds, placed(h, q));
    }
}

sn_status sn_shape_transform(sn_shape **out, sn_shape *s, const sn_shape_placement *t, sn_error *err)
{
    static const char *const name[3] = {"scale along x", "scale along y", "scale along z"};
    *out = NULL;
    sn_status st = check_sizes(t->scale, "transform", name, err);
    if (!st) st = check_point(t->translate, "transform", "translate", err);
    if (!st && t->angle_deg != 0.0) st = check_direction(t->axis, "transform", "axis", err);
    if (!st && !isfinite(t->angle_deg))
        st = sn_fail(err, SN_EINVAL, "transform: angle is %g, need a finite number", t->angle_deg);
    if (!st) st = make_of_parts(out, SN_SHAPE_TRANSFORM, "transform", &s, 1, err);
    if (st) return st;
    (*out)->center = t->translate;
    (*out)->size = t->scale;
    (*out)->length = fmin(t->scale.x, fmin(t->scale.y, t->scale.z));
    set_rotation((*out)->turn, t->axis, t->angle_deg);
    set_placed_bounds(*out);
    return SN_OK;
}

sn_status sn_shape_mirror(sn_shape **out, sn_shape *s, sn_vec3 point, sn_vec3 normal, sn_error *err)
{
    *out = NULL;
    sn_status st = check_point(point, "mirror", "point", err);
    if (!st) st = check_direction(normal, "mirror", "normal", err);
    if (!st) st = make_of_parts(out, SN_SHAPE_MIRROR, "mirror", &s, 1, err);
    if (st) return st;
    (*out)->center = point;
    (*out)->size = sn_v3_unit(normal);
    set_placed_bounds(*out);
    return SN_OK;
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
