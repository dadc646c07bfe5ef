#include "tetra/locate.h"

#include "base/alloc.h"

#include <string.h>

#define LEAF_SIZE 4
#define MAX_DEPTH 64
#define ON_FACE                                                                                              \
    1e-10 /* barycentric coordinates down to minus this count as inside: rounding on shared faces */

typedef struct node {
    sn_box3 box;
    int32_t first; /* leaf: into order; inner: the right child (the left one follows) */
    int32_t count; /* tets of a leaf, 0 for an inner node                              */
} node;

struct sn_locator {
    const sn_tet_mesh *mesh;
    node *nodes;
    int32_t *order;
    int32_t n_node;
};

void sn_tet_barycentric(const sn_tet_mesh *m, int32_t i_tet, sn_vec3 p, double bary[4])
{
    const int32_t *t = m->tet + 4 * (size_t)i_tet;
    sn_vec3 a = sn_tet_mesh_point(m, t[0]);
    sn_vec3 e1 = sn_v3_sub(sn_tet_mesh_point(m, t[1]), a), e2 = sn_v3_sub(sn_tet_mesh_point(m, t[2]), a);
    sn_vec3 e3 = sn_v3_sub(sn_tet_mesh_point(m, t[3]), a), q = sn_v3_sub(p, a);
    double det = sn_v3_det(e1, e2, e3);
    bary[1] = sn_v3_det(q, e2, e3) / det;
    bary[2] = sn_v3_det(e1, q, e3) / det;
    bary[3] = sn_v3_det(e1, e2, q) / det;
    bary[0] = 1.0 - bary[1] - bary[2] - bary[3];
}

/* Holds every point that counts as inside: up to 3 ON_FACE edge lengths off the tet. */
static sn_box3 tet_box(const sn_tet_mesh *m, int32_t t)
{
    sn_box3 b = sn_box3_empty();
    for (int k = 0; k < 4; k++) b = sn_box3_add(b, sn_tet_mesh_point(m, m->tet[4 * (size_t)t + (size_t)k]));
    double pad = 4.0 * ON_FACE * sn_box3_diagonal(b);
    sn_vec3 d = {pad, pad, pad};
    return (sn_box3){sn_v3_sub(b.min, d), sn_v3_add(b.max, d)};
}

typedef struct keyed {
    double key[3]; /* centre */
    int32_t tet;
} keyed;

static bool before(const keyed *a, const keyed *b, int axis)
{
    double x = a->key[axis], y = b->key[axis];
    return x < y || (x == y && a->tet < b->tet);
}

static void swap_keyed(keyed *a, keyed *b)
{
    keyed s = *a;
    *a = *b;
    *b = s;
}

/* Puts the k smallest on `axis` (ties by tet) first: quickselect, median of three. */
static void select_half(keyed *e, int32_t n, int32_t k, int axis)
{
    int32_t lo = 0, hi = n - 1;
    while (lo < hi) {
        int32_t mid = lo + (hi - lo) / 2;
        if (before(&e[mid], &e[lo], axis)) swap_keyed(&e[mid], &e[lo]);
        if (before(&e[hi], &e[lo], axis)) swap_keyed(&e[hi], &e[lo]);
        if (before(&e[hi], &e[mid], axis)) swap_keyed(&e[hi], &e[mid]);
        keyed pivot = e[mid];
        int32_t i = lo, j = hi;
        while (i <= j) {
            while (before(&e[i], &pivot, axis)) i++;
            while (before(&pivot, &e[j], axis)) j--;
            if (i <= j) swap_keyed(&e[i++], &e[j--]);
        }
        if (k <= j)
            hi = j;
        else if (k >= i)
            lo = i;
        else
            return;
    }
}

static int widest_axis(const keyed *e, int32_t n)
{
    sn_box3 b = sn_box3_empty();
    for (int32_t i = 0; i < n; i++) b = sn_box3_add(b, sn_v3_load(e[i].key));
    sn_vec3 d = sn_v3_sub(b.max, b.min);
    return d.x >= d.y && d.x >= d.z ? 0 : d.y >= d.z ? 1 : 2;
}

static int32_t build(sn_locator *l, keyed *e, int32_t first, int32_t n)
{
    int32_t at = l->n_node++;
    if (n <= LEAF_SIZE) {
        sn_box3 box = sn_box3_empty();
        for (int32_t i = 0; i < n; i++) {
            l->order[first + i] = e[first + i].tet;
            box = sn_box3_merge(box, tet_box(l->mesh, e[first + i].tet));
        }
        l->nodes[at] = (node){box, first, n};
        return at;
    }
    int axis = widest_axis(e + first, n);
    select_half(e + first, n, n / 2, axis);
    int32_t left = build(l, e, first, n / 2), right = build(l, e, first + n / 2, n - n / 2);
    l->nodes[at] = (node){sn_box3_merge(l->nodes[left].box, l->nodes[right].box), right, 0};
    return at;
}

sn_status sn_locator_create(sn_locator **out, const sn_tet_mesh *m, sn_error *err)
{
    *out = NULL;
    sn_locator *l = SN_NEW_ZERO(sn_locator, 1);
    keyed *e = SN_NEW(keyed, m->n_tet);
    if (l) {
        l->mesh = m;
        l->nodes = SN_NEW(node, 2 * (size_t)m->n_tet);
        l->order = SN_NEW(int32_t, m->n_tet);
    }
    if (!l || !e || !l->nodes || !l->order) {
        sn_release(e);
        sn_locator_destroy(l);
        return sn_fail(err, SN_ENOMEM, "locator: no memory for %d tets", m->n_tet);
    }
    for (int32_t t = 0; t < m->n_tet; t++) {
        sn_vec3 c = {0, 0, 0};
        for (int k = 0; k < 4; k++) c = sn_v3_add(c, sn_tet_mesh_point(m, m->tet[4 * (size_t)t + (size_t)k]));
        e[t] = (keyed){{c.x, c.y, c.z}, t};
    }
    (void)build(l, e, 0, m->n_tet);
    sn_release(e);
    *out = l;
    return SN_OK;
}

void sn_locator_destroy(sn_locator *l)
{
    if (!l) return;
    sn_release(l->nodes);
    sn_release(l->order);
    sn_release(l);
}

static bool in_box(const sn_box3 *b, sn_vec3 p)
{
    return p.x >= b->min.x && p.x <= b->max.x && p.y >= b->min.y && p.y <= b->max.y && p.z >= b->min.z &&
           p.z <= b->max.z;
}

int32_t sn_locator_find(const sn_locator *l, sn_vec3 p, double bary[4])
{
    int32_t stack[MAX_DEPTH], top = 0, found = -1;
    stack[top++] = 0;
    while (top > 0) {
        int32_t at = stack[--top];
        const node *n = &l->nodes[at];
        if (!in_box(&n->box, p)) continue;
        if (n->count == 0) {
            stack[top++] = n->first;
            stack[top++] = at + 1;
            continue;
        }
        for (int32_t i = 0; i < n->count; i++) {
            double b[4];
            int32_t t = l->order[n->first + i];
            if (found >= 0 && t > found) continue;
            sn_tet_barycentric(l->mesh, t, p, b);
            if (fmin(fmin(b[0], b[1]), fmin(b[2], b[3])) < -ON_FACE) continue;
            found = t;
            if (bary) memcpy(bary, b, sizeof b);
        }
    }
    return found;
}
