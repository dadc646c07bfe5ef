/* bvh_ray.c - rays against the tree, watertight.
 *
 * As Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", 2013, every corner is sheared once so that
 * the ray becomes the z axis, and a triangle is hit when its three edges turn the same way around the origin.
 * Here those signs are exact, and a zero is decided as if the ray were shifted by (e, e^2), e tiny: no ray
 * passes through an edge or a corner. What is hit is then consistent over a whole closed surface, and so is
 * its order along the ray, which is exact too where rounding leaves it open. */
#include "mesh/bvh_private.h"

#include "base/alloc.h"
#include "base/array.h"
#include "mesh/predicates.h"

#include <float.h>
#include <gmp.h>
#include <string.h>

typedef struct ray {
    sn_vec3 origin;
    int kx, ky,
        kz; /* kz: the largest component of the direction; kx, ky so that the shear keeps orientation */
    double sx, sy; /* the shear */
    double sz; /* 1 or -1: the sense along kz                                                              */
    double length;   /* of the direction along kz: z = t * length   */
    double slope[3]; /* direction / length */
    double pad; /* boxes grow by this: more than the rounding of the shear                                  */
} ray;

typedef struct candidate {
    double z, z_error; /* along the ray, and how far rounding may have moved it */
    sn_bvh_tri local;  /* sheared corners                                       */
    int32_t face;
    bool entering;
} candidate;

static double component(sn_vec3 p, int axis)
{
    return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

static double largest(sn_vec3 p)
{
    return fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z)));
}

static bool ray_init(ray *r, const sn_bvh *b, sn_vec3 origin, sn_vec3 dir)
{
    r->length = largest(dir);
    if (!sn_v3_is_finite(dir) || !sn_v3_is_finite(origin) || !(r->length > 0.0)) return false;
    r->origin = origin;
    r->kz = fabs(dir.x) == r->length ? 0 : fabs(dir.y) == r->length ? 1 : 2;
    r->kx = (r->kz + 1) % 3;
    r->ky = (r->kz + 2) % 3;
    r->sz = component(dir, r->kz) > 0.0 ? 1.0 : -1.0;
    if (r->sz < 0.0) {
        int swap = r->kx;
        r->kx = r->ky;
        r->ky = swap;
    }
    for (int k = 0; k < 3; k++) r->slope[k] = component(dir, k) / r->length;
    r->sx = r->slope[r->kx] * r->sz;
    r->sy = r->slope[r->ky] * r->sz;
    const sn_box3 *box = &b->node[0].box;
    r->pad = 8.0 * DBL_EPSILON * (largest(origin) + fmax(largest(box->min), largest(box->max)));
    return true;
}

static sn_vec3 shear(const ray *r, sn_vec3 p)
{
    sn_vec3 d = sn_v3_sub(p, r->origin);
    double along = component(d, r->kz);
    return sn_v3(component(d, r->kx) - r->sx * along, component(d, r->ky) - r->sy * along, r->sz * along);
}

/* The part of the ray with z in [*near, *far] inside the padded box; false when there is none. */
static bool clip(const ray *r, const sn_box3 *box, double *near, double *far)
{
    for (int k = 0; k < 3; k++) {
        double low = component(box->min, k) - r->pad - component(r->origin, k);
        double high = component(box->max, k) + r->pad - component(r->origin, k);
        double slope = r->slope[k];
        if (fabs(slope) < 1e-200) { /* parallel */
            if (low > 0.0 || high < 0.0) return false;
            continue;
        }
        double z0 = (slope > 0.0 ? low : high) / slope, z1 = (slope > 0.0 ? high : low) / slope;
        *near = fmax(*near, z0);
        *far = fmin(*far, z1);
    }
    return *near <= *far;
}

/* The side of the shifted origin at which the sheared edge (a, b) passes: 1 left. 0 only when a and b
 * coincide. */
static int edge_side(sn_vec3 a, sn_vec3 b)
{
    int s = sn_orient2d(sn_v3(0.0, 0.0, 0.0), a, b, 2);
    if (s != 0) return s;
    if (a.y != b.y) return a.y > b.y ? 1 : -1;
    return (b.x > a.x) - (b.x < a.x);
}

/* Height of the triangle above the origin, and a bound for its rounding error. Steep triangles have large
 * errors, but no more than their own extent. */
static void set_height(candidate *c)
{
    const sn_vec3 *v = c->local.v;
    double low = fmin(v[0].z, fmin(v[1].z, v[2].z)), high = fmax(v[0].z, fmax(v[1].z, v[2].z));
    double sum = 0.0, z = 0.0, size = 0.0, reach = fmax(fabs(low), fabs(high));
    for (int k = 0; k < 3; k++) {
        const sn_vec3 *a = &v[(k + 1) % 3], *b = &v[(k + 2) % 3];
        double left = a->x * b->y, right = a->y * b->x;
        sum += left - right;
        z += (left - right) * v[k].z;
        size += fabs(left) + fabs(right);
    }
    c->z = z / sum;
    c->z_error = 16.0 * DBL_EPSILON * reach * (size / fabs(sum));
    if (!(c->z_error < high - low)) { /* also when sum is 0 */
        c->z_error = high - low;
        if (isnan(c->z)) c->z = low;
    }
    c->z = fmin(fmax(c->z, low), high);
}

static bool hits_face(const ray *r, const sn_bvh *b, int32_t slot, candidate *c)
{
    for (int k = 0; k < 3; k++) c->local.v[k] = shear(r, b->tri[slot].v[k]);
    const sn_vec3 *v = c->local.v;
    int s = edge_side(v[0], v[1]);
    if (s == 0 || edge_side(v[1], v[2]) != s || edge_side(v[2], v[0]) != s) return false;
    c->face = b->face[slot];
    c->entering = s < 0;
    set_height(c);
    return true;
}

/* plane[0..2] = n.a, -n.x, -n.y over n.z: the height at the origin and its slopes. */
static void exact_plane(mpq_t plane[3], const sn_bvh_tri *t)
{
    mpq_t e[2][3], n[3], a[3], x;
    mpq_init(x);
    for (int k = 0; k < 3; k++) {
        mpq_inits(e[0][k], e[1][k], n[k], a[k], NULL);
        mpq_set_d(a[k], component(t->v[0], k));
        for (int i = 0; i < 2; i++) {
            mpq_set_d(x, component(t->v[i + 1], k));
            mpq_sub(e[i][k], x, a[k]);
        }
    }
    for (int k = 0; k < 3; k++) {
        mpq_mul(n[k], e[0][(k + 1) % 3], e[1][(k + 2) % 3]);
        mpq_mul(x, e[0][(k + 2) % 3], e[1][(k + 1) % 3]);
        mpq_sub(n[k], n[k], x);
    }
    mpq_set_ui(plane[0], 0, 1);
    for (int k = 0; k < 3; k++) {
        mpq_mul(x, n[k], a[k]);
        mpq_add(plane[0], plane[0], x);
    }
    mpq_neg(plane[1], n[0]);
    mpq_neg(plane[2], n[1]);
    for (int k = 0; k < 3; k++) mpq_div(plane[k], plane[k], n[2]); /* a face that is hit is not parallel */
    for (int k = 0; k < 3; k++) mpq_clears(e[0][k], e[1][k], n[k], a[k], NULL);
    mpq_clear(x);
}

/* Which of two planes the shifted ray meets first. */
static int compare_exactly(const candidate *p, const candidate *q)
{
    mpq_t a[3], b[3];
    for (int k = 0; k < 3; k++) mpq_inits(a[k], b[k], NULL);
    exact_plane(a, &p->local);
    exact_plane(b, &q->local);
    int order = 0;
    for (int k = 0; k < 3 && order == 0; k++) order = mpq_cmp(a[k], b[k]);
    for (int k = 0; k < 3; k++) mpq_clears(a[k], b[k], NULL);
    return order;
}

static int compare_candidates(const void *a, const void *b)
{
    const candidate *p = a, *q = b;
    if (p->face == q->face) return 0;
    if (p->z + p->z_error < q->z - q->z_error) return -1;
    if (q->z + q->z_error < p->z - p->z_error) return 1;
    int order = compare_exactly(p, q);
    return order != 0 ? order : (p->face > q->face) - (p->face < q->face);
}

static void set_hit(sn_ray_hit *hit, const ray *r, const candidate *c)
{
    hit->t = c->z / r->length;
    hit->face = c->face;
    hit->entering = c->entering;
    hit->point = sn_v3_mad(r->origin, c->z, sn_v3(r->slope[0], r->slope[1], r->slope[2]));
}

static bool within(const ray *r, const candidate *c, double t_max)
{
    double t = c->z / r->length;
    return t >= 0.0 && t <= t_max;
}

typedef struct search {
    const sn_bvh *b;
    ray r;
    double t_max;
    bool first_only;
    candidate *found; /* n, room for cap; one candidate when first_only */
    size_t n, cap;
} search;

/* false when memory is short */
static bool keep(search *q, const candidate *c)
{
    if (!q->first_only) {
        if (!sn_grow(&q->found, &q->cap, q->n + 1, sizeof *q->found)) return false;
        q->found[q->n++] = *c;
    } else if (q->n == 0 || compare_candidates(c, q->found) < 0) {
        *q->found = *c;
        q->n = 1;
    }
    return true;
}

static bool search_leaf(search *q, const sn_bvh_node *node)
{
    candidate c;
    for (int32_t s = node->first; s < node->first + node->count; s++)
        if (hits_face(&q->r, q->b, s, &c) && within(&q->r, &c, q->t_max) && !keep(q, &c)) return false;
    return true;
}

/* Where the ray enters the node's box, INFINITY when it need not be visited. */
static double entry(const search *q, int32_t i_node)
{
    double near = -q->r.pad, far = q->t_max * q->r.length + q->r.pad;
    if (q->first_only && q->n > 0) far = fmin(far, q->found->z + q->found->z_error + q->r.pad);
    return clip(&q->r, &q->b->node[i_node].box, &near, &far) ? near : INFINITY;
}

static bool search_tree(search *q)
{
    int32_t stack[SN_BVH_STACK];
    int n = 0;
    stack[n++] = 0;
    while (n > 0) {
        int32_t i = stack[--n];
        if (!(entry(q, i) < INFINITY)) continue;
        const sn_bvh_node *node = &q->b->node[i];
        if (node->count > 0) {
            if (!search_leaf(q, node)) return false;
            continue;
        }
        bool left_first = entry(q, node->first) <= entry(q, node->first + 1);
        stack[n++] = left_first ? node->first + 1 : node->first;
        stack[n++] = left_first ? node->first : node->first + 1;
    }
    return true;
}

sn_status sn_bvh_ray_all(const sn_bvh *b, sn_vec3 origin, sn_vec3 dir, double t_max, sn_ray_hit **hits,
                         size_t *n_hits, sn_error *err)
{
    *hits = NULL;
    *n_hits = 0;
    search q = {.b = b, .t_max = t_max};
    if (!ray_init(&q.r, b, origin, dir))
        return sn_fail(err, SN_EINVAL,
                       "ray: origin (%g, %g, %g), direction (%g, %g, %g), need finite numbers and a "
                       "direction that is not zero",
                       origin.x, origin.y, origin.z, dir.x, dir.y, dir.z);
    sn_ray_hit *list = NULL;
    bool ok = search_tree(&q) && (list = SN_NEW(sn_ray_hit, q.n)) != NULL;
    if (ok) {
        sn_sort(q.found, q.n, sizeof *q.found, compare_candidates);
        for (size_t k = 0; k < q.n; k++) {
            set_hit(&list[k], &q.r, &q.found[k]);
            if (k > 0) list[k].t = fmax(list[k].t, list[k - 1].t); /* the order is exact, t is rounded */
        }
        *hits = list;
        *n_hits = q.n;
    }
    sn_release(q.found);
    return ok ? SN_OK : sn_fail(err, SN_ENOMEM, "ray: no memory for %zu hits", q.n + 1);
}

bool sn_bvh_ray_first(const sn_bvh *b, sn_vec3 origin, sn_vec3 dir, double t_max, sn_ray_hit *hit)
{
    candidate best;
    search q = {.b = b, .t_max = t_max, .first_only = true, .found = &best};
    if (!ray_init(&q.r, b, origin, dir) || !search_tree(&q) || q.n == 0) return false;
    set_hit(hit, &q.r, &best);
    return true;
}
