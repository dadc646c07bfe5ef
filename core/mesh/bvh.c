#include "mesh/bvh.h"

#include "base/alloc.h"
#include "mesh/bvh_private.h"

#include <stdint.h>
#include <string.h>

/* Binned surface area heuristic (Wald 2007). Below MAX_SAH_DEPTH ranges are halved, so paths stay below
 * MAX_SAH_DEPTH + 31 nodes. */
enum { N_BIN = 16, LEAF_SIZE = 4, MAX_SAH_DEPTH = 56 };

typedef struct builder {
    sn_bvh *b;
    sn_box3 *box; /* per face */
} builder;

typedef struct range {
    int32_t node, begin, end;
    int depth;
} range;

typedef struct split {
    int axis;
    int bin;     /* the first bin of the right side */
    double cost; /* INFINITY: none found            */
} split;

typedef struct bin {
    sn_box3 box;
    int32_t count;
} bin;

static double component(sn_vec3 p, int axis)
{
    return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

static double half_area(sn_box3 b)
{
    double x = b.max.x - b.min.x, y = b.max.y - b.min.y, z = b.max.z - b.min.z;
    return x * y + y * z + z * x;
}

static sn_vec3 centre(const builder *w, int32_t slot)
{
    const sn_box3 *box = &w->box[w->b->face[slot]];
    return sn_v3_lerp(box->min, box->max, 0.5);
}

static int bin_of(double x, double low, double high)
{
    double s = (x - low) / (high - low) * N_BIN;
    return s >= N_BIN - 1 ? N_BIN - 1 : s > 0.0 ? (int)s : 0;
}

static void add_bin(bin *sum, const bin *b)
{
    if (b->count == 0) return; /* an empty box would make the merged one infinite */
    sum->box = sn_box3_merge(sum->box, b->box);
    sum->count += b->count;
}

/* Improves *best by the splits of the range along one axis. */
static void try_axis(const builder *w, const range *r, int axis, sn_box3 centres, split *best)
{
    double low = component(centres.min, axis), high = component(centres.max, axis);
    if (!(high > low)) return;
    bin bins[N_BIN];
    for (int k = 0; k < N_BIN; k++) bins[k] = (bin){sn_box3_empty(), 0};
    for (int32_t s = r->begin; s < r->end; s++) {
        bin *to = &bins[bin_of(component(centre(w, s), axis), low, high)];
        to->box = sn_box3_merge(to->box, w->box[w->b->face[s]]);
        to->count++;
    }
    double right_cost[N_BIN];
    bin sum = {sn_box3_empty(), 0};
    for (int k = N_BIN - 1; k > 0; k--) {
        add_bin(&sum, &bins[k]);
        right_cost[k] = sum.count > 0 ? half_area(sum.box) * sum.count : INFINITY;
    }
    sum = (bin){sn_box3_empty(), 0};
    for (int k = 1; k < N_BIN; k++) {
        add_bin(&sum, &bins[k - 1]);
        if (sum.count == 0) continue;
        double cost = half_area(sum.box) * sum.count + right_cost[k];
        if (cost < best->cost) *best = (split){axis, k, cost};
    }
}

/* Moves the slots of the left side to the front; returns where the right side begins. */
static int32_t partition(const builder *w, const range *r, sn_box3 centres, const split *s)
{
    double low = component(centres.min, s->axis), high = component(centres.max, s->axis);
    int32_t *face = w->b->face, left = r->begin;
    for (int32_t k = r->begin; k < r->end; k++) {
        if (bin_of(component(centre(w, k), s->axis), low, high) >= s->bin) continue;
        int32_t swap = face[k];
        face[k] = face[left];
        face[left++] = swap;
    }
    return left;
}

static int32_t choose_middle(const builder *w, const range *r)
{
    int32_t half = r->begin + (r->end - r->begin) / 2;
    if (r->depth >= MAX_SAH_DEPTH) return half;
    sn_box3 centres = sn_box3_empty();
    for (int32_t s = r->begin; s < r->end; s++) centres = sn_box3_add(centres, centre(w, s));
    split best = {0, 0, INFINITY};
    for (int axis = 0; axis < 3; axis++) try_axis(w, r, axis, centres, &best);
    return best.cost < INFINITY ? partition(w, r, centres, &best) : half;
}

static void fill_leaf(const builder *w, sn_bvh_node *node, const range *r)
{
    const sn_bvh *b = w->b;
    node->first = r->begin;
    node->count = r->end - r->begin;
    node->box = sn_box3_empty();
    node->label_min = INT32_MAX;
    node->label_max = INT32_MIN;
    for (int32_t s = r->begin; s < r->end; s++) {
        int32_t f = b->face[s], label = b->mesh.label ? b->mesh.label[f] : 0;
        node->box = sn_box3_merge(node->box, w->box[f]);
        if (label < node->label_min) node->label_min = label;
        if (label > node->label_max) node->label_max = label;
    }
}

static void grow_tree(const builder *w)
{
    sn_bvh *b = w->b;
    range stack[SN_BVH_STACK];
    int n = 0;
    b->n_node = 1;
    stack[n++] = (range){0, 0, b->mesh.n_face, 0};
    while (n > 0) {
        range r = stack[--n];
        sn_bvh_node *node = &b->node[r.node];
        if (r.end - r.begin <= LEAF_SIZE) {
            fill_leaf(w, node, &r);
            continue;
        }
        int32_t middle = choose_middle(w, &r);
        node->first = b->n_node;
        node->count = 0;
        b->n_node += 2;
        stack[n++] = (range){node->first + 1, middle, r.end, r.depth + 1};
        stack[n++] = (range){node->first, r.begin, middle, r.depth + 1};
    }
}

static void join_children(sn_bvh *b)
{
    for (int32_t i = b->n_node - 1; i >= 0; i--) {
        sn_bvh_node *node = &b->node[i];
        if (node->count > 0) continue;
        const sn_bvh_node *l = &b->node[node->first], *r = l + 1;
        node->box = sn_box3_merge(l->box, r->box);
        node->label_min = l->label_min < r->label_min ? l->label_min : r->label_min;
        node->label_max = l->label_max > r->label_max ? l->label_max : r->label_max;
    }
}

static sn_bvh_tri corners(const sn_tri_mesh *m, int32_t f)
{
    const int32_t *v = m->face + 3 * (size_t)f;
    return (sn_bvh_tri){{sn_tri_mesh_point(m, v[0]), sn_tri_mesh_point(m, v[1]), sn_tri_mesh_point(m, v[2])}};
}

static void build(builder *w)
{
    sn_bvh *b = w->b;
    for (int32_t f = 0; f < b->mesh.n_face; f++) {
        sn_bvh_tri t = corners(&b->mesh, f);
        b->face[f] = f;
        w->box[f] = sn_box3_add(sn_box3_add(sn_box3_add(sn_box3_empty(), t.v[0]), t.v[1]), t.v[2]);
    }
    grow_tree(w);
    join_children(b);
    for (int32_t s = 0; s < b->mesh.n_face; s++) b->tri[s] = corners(&b->mesh, b->face[s]);
    sn_bvh_set_moments(b);
}

sn_status sn_bvh_create(sn_bvh **out, const sn_tri_mesh *m, sn_error *err)
{
    *out = NULL;
    if (m->n_face < 1) return sn_fail(err, SN_EINVAL, "bvh: the surface has no faces, need at least 1");
    sn_bvh *b = SN_NEW_ZERO(sn_bvh, 1);
    if (!b) return sn_fail(err, SN_ENOMEM, "bvh: no memory");
    sn_status st = sn_tri_mesh_copy(&b->mesh, m, err);
    if (st) {
        sn_bvh_destroy(b);
        return st;
    }
    size_t n = (size_t)m->n_face,
           n_node = 2 * ((n + 1) / 2 + n / 2); /* a full binary tree of at most n leaves */
    builder w = {b, SN_NEW(sn_box3, n)};
    b->node = SN_NEW(sn_bvh_node, n_node);
    b->moment = SN_NEW(sn_bvh_moment, n_node);
    b->face = SN_NEW(int32_t, n);
    b->tri = SN_NEW(sn_bvh_tri, n);
    if (w.box && b->node && b->moment && b->face && b->tri) {
        build(&w);
        *out = b;
    } else {
        sn_bvh_destroy(b);
        st = sn_fail(err, SN_ENOMEM, "bvh: no memory for a tree over %d faces", m->n_face);
    }
    sn_release(w.box);
    return st;
}

void sn_bvh_destroy(sn_bvh *b)
{
    if (!b) return;
    sn_tri_mesh_free(&b->mesh);
    sn_release(b->node);
    sn_release(b->moment);
    sn_release(b->face);
    sn_release(b->tri);
    sn_release(b);
}

const sn_tri_mesh *sn_bvh_mesh(const sn_bvh *b)
{
    return &b->mesh;
}
