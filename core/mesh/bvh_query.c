/* bvh_query.c - closest points and overlapping boxes. */
#include "mesh/bvh_private.h"

#include <string.h>

/* A little less than 1: a box is skipped only when rounding cannot have made it look too far. */
static const double NEARER = 1.0 - 1e-14;

static double outside(double x, double low, double high)
{
    return x < low ? low - x : x > high ? x - high : 0.0;
}

static double box_distance2(const sn_box3 *b, sn_vec3 p)
{
    return sn_v3_len2(sn_v3(outside(p.x, b->min.x, b->max.x), outside(p.y, b->min.y, b->max.y),
                            outside(p.z, b->min.z, b->max.z)));
}

static bool comes_before(sn_vec3 a, sn_vec3 b)
{
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

/* The ends are put in a fixed order: both faces at an edge get the same bits. */
static sn_vec3 closest_on_segment(sn_vec3 p, sn_vec3 a, sn_vec3 b)
{
    if (comes_before(b, a)) {
        sn_vec3 swap = a;
        a = b;
        b = swap;
    }
    sn_vec3 ab = sn_v3_sub(b, a);
    double along = sn_v3_dot(sn_v3_sub(p, a), ab), len2 = sn_v3_len2(ab);
    if (!(along > 0.0)) return a;
    if (along >= len2) return b;
    return along <= 0.5 * len2 ? sn_v3_mad(a, along / len2, ab)
                               : sn_v3_mad(b, -sn_v3_dot(sn_v3_sub(b, p), ab) / len2, ab);
}

/* The projection of p into the triangle as a weighted mean of its corners; false when it falls outside. */
static bool project_inside(sn_vec3 p, const sn_bvh_tri *t, sn_vec3 *out)
{
    sn_vec3 n = sn_v3_cross(sn_v3_sub(t->v[1], t->v[0]), sn_v3_sub(t->v[2], t->v[0])), d[3];
    for (int k = 0; k < 3; k++) d[k] = sn_v3_sub(t->v[k], p);
    double w0 = sn_v3_det(n, d[1], d[2]), w1 = sn_v3_det(n, d[2], d[0]), w2 = sn_v3_det(n, d[0], d[1]);
    double sum = w0 + w1 + w2;
    if (!(w0 >= 0.0 && w1 >= 0.0 && w2 >= 0.0 && sum > 0.0)) return false;
    *out = sn_v3_mad(sn_v3_mad(t->v[0], w1 / sum, sn_v3_sub(t->v[1], t->v[0])), w2 / sum,
                     sn_v3_sub(t->v[2], t->v[0]));
    return true;
}

/* The edges are looked at even when the projection is inside: on a needle its weights may be off, and the
 * best of several points of the triangle is never wrong by more than that. */
static sn_vec3 closest_on_triangle(sn_vec3 p, const sn_bvh_tri *t, double *dist2)
{
    sn_vec3 best = t->v[0], x;
    *dist2 = INFINITY;
    for (int k = 0; k < 3; k++) {
        x = closest_on_segment(p, t->v[k], t->v[(k + 1) % 3]);
        double d = sn_v3_len2(sn_v3_sub(p, x));
        if (d < *dist2) {
            *dist2 = d;
            best = x;
        }
    }
    if (!project_inside(p, t, &x)) return best;
    double d = sn_v3_len2(sn_v3_sub(p, x));
    if (!(d < *dist2)) return best;
    *dist2 = d;
    return x;
}

typedef struct closest_query {
    const sn_bvh *b;
    sn_vec3 p;
    int32_t label;
    bool any_label;
    double dist2; /* of the best so far */
    sn_closest best;
} closest_query;

static void search_leaf(closest_query *q, const sn_bvh_node *node)
{
    for (int32_t s = node->first; s < node->first + node->count; s++) {
        int32_t f = q->b->face[s];
        if (!q->any_label && q->b->mesh.label[f] != q->label) continue;
        double d;
        sn_vec3 x = closest_on_triangle(q->p, &q->b->tri[s], &d);
        if (d > q->dist2 || (d == q->dist2 && q->best.face >= 0 && f > q->best.face)) continue;
        q->dist2 = d;
        q->best.face = f;
        q->best.point = x;
    }
}

static bool is_candidate(const closest_query *q, const sn_bvh_node *node, double box_dist2)
{
    return box_dist2 * NEARER <= q->dist2 &&
           (q->any_label || (node->label_min <= q->label && q->label <= node->label_max));
}

static void search(closest_query *q)
{
    struct {
        int32_t node;
        double dist2;
    } stack[SN_BVH_STACK];
    int n = 0;
    stack[n].node = 0;
    stack[n++].dist2 = 0.0;
    while (n > 0) {
        n--;
        const sn_bvh_node *node = &q->b->node[stack[n].node];
        if (!is_candidate(q, node, stack[n].dist2)) continue;
        if (node->count > 0) {
            search_leaf(q, node);
            continue;
        }
        int32_t l = node->first, r = node->first + 1;
        double dl = box_distance2(&q->b->node[l].box, q->p), dr = box_distance2(&q->b->node[r].box, q->p);
        bool left_first = dl <= dr; /* the nearer one is pushed last and so visited first */
        stack[n].node = left_first ? r : l;
        stack[n++].dist2 = left_first ? dr : dl;
        stack[n].node = left_first ? l : r;
        stack[n++].dist2 = left_first ? dl : dr;
    }
    q->best.dist = sqrt(q->dist2);
}

sn_closest sn_bvh_closest(const sn_bvh *b, sn_vec3 p)
{
    closest_query q = {b, p, 0, true, INFINITY, {INFINITY, -1, p}};
    search(&q);
    return q.best;
}

sn_closest sn_bvh_closest_label(const sn_bvh *b, sn_vec3 p, int32_t label)
{
    closest_query q = {b, p, label, false, INFINITY, {INFINITY, -1, p}};
    if (b->mesh.label) search(&q);
    return q.best;
}

static bool boxes_meet(const sn_box3 *a, const sn_box3 *b)
{
    return a->min.x <= b->max.x && b->min.x <= a->max.x && a->min.y <= b->max.y && b->min.y <= a->max.y &&
           a->min.z <= b->max.z && b->min.z <= a->max.z;
}

static sn_box3 box_of(const sn_bvh_tri *t)
{
    return sn_box3_add(sn_box3_add(sn_box3_add(sn_box3_empty(), t->v[0]), t->v[1]), t->v[2]);
}

void sn_bvh_overlap(const sn_bvh *b, sn_box3 box, bool (*fn)(void *user, int32_t face), void *user)
{
    int32_t stack[SN_BVH_STACK];
    int n = 0;
    stack[n++] = 0;
    while (n > 0) {
        const sn_bvh_node *node = &b->node[stack[--n]];
        if (!boxes_meet(&node->box, &box)) continue;
        if (node->count == 0) {
            stack[n++] = node->first + 1;
            stack[n++] = node->first;
            continue;
        }
        for (int32_t s = node->first; s < node->first + node->count; s++) {
            sn_box3 own = box_of(&b->tri[s]);
            if (boxes_meet(&own, &box) && !fn(user, b->face[s])) return;
        }
    }
}
