#include "mesh/mesh_check.h"

#include "base/alloc.h"
#include "base/array.h"
#include "mesh/predicates.h"
#include "mesh/mesh_check_private.h"

#include <string.h>

/* ---- sets of elements that are joined step by step ---- */

static int32_t find_root(int32_t *parent, int32_t i)
{
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static void join(int32_t *parent, int32_t i, int32_t j) /* the lowest element is the root */
{
    int32_t a = find_root(parent, i), b = find_root(parent, j);
    if (a < b)
        parent[b] = a;
    else
        parent[a] = b;
}

/* ---- the edges of a surface: half-edges grouped by their two vertices ---- */

typedef struct half_edge {
    int32_t low, high; /* vertices, low < high           */
    int32_t corner;    /* 3 face + k, from corner k on   */
    bool forward;      /* the face runs from low to high */
} half_edge;

typedef struct edge_list {
    half_edge *half; /* sorted by low, high, corner; sides of zero length are left out */
    size_t n;
} edge_list;

static int compare_half_edges(const void *a, const void *b)
{
    const half_edge *p = a, *q = b;
    if (p->high != q->high) return p->high < q->high ? -1 : 1;
    return (p->corner > q->corner) - (p->corner < q->corner);
}

static half_edge half_edge_at(const sn_tri_mesh *m, int32_t f, int k)
{
    const int32_t *v = m->face + 3 * (size_t)f;
    int32_t a = v[k], b = v[(k + 1) % 3];
    return (half_edge){a < b ? a : b, a < b ? b : a, 3 * f + k, a < b};
}

/* Half-edges in groups of equal `low`, each group sorted. start: n_vert + 1, zero. */
static void sort_half_edges(edge_list *e, const sn_tri_mesh *m, size_t *start)
{
    for (int32_t f = 0; f < m->n_face; f++)
        for (int k = 0; k < 3; k++) {
            half_edge h = half_edge_at(m, f, k);
            if (h.low != h.high) start[h.low + 1]++;
        }
    for (int32_t i = 0; i < m->n_vert; i++) start[i + 1] += start[i];
    e->n = start[m->n_vert];
    for (int32_t f = 0; f < m->n_face; f++)
        for (int k = 0; k < 3; k++) {
            half_edge h = half_edge_at(m, f, k);
            if (h.low != h.high) e->half[start[h.low]++] = h; /* start moves on to the end of its group */
        }
    for (int32_t i = 0; i < m->n_vert; i++) {
        size_t begin = i > 0 ? start[i - 1] : 0;
        sn_sort(e->half + begin, start[i] - begin, sizeof *e->half, compare_half_edges);
    }
}

static sn_status edge_list_create(edge_list *e, const sn_tri_mesh *m, sn_error *err)
{
    *e = (edge_list){NULL, 0};
    if (m->n_face > INT32_MAX / 3)
        return sn_fail(err, SN_ELIMIT, "mesh check: %d faces, need at most %d", m->n_face, INT32_MAX / 3);
    size_t *start = SN_NEW_ZERO(size_t, (size_t)m->n_vert + 1);
    e->half = SN_NEW(half_edge, 3 * (size_t)m->n_face);
    bool ok = start && e->half;
    if (ok) {
        sort_half_edges(e, m, start);
    } else {
        sn_release(e->half);
        e->half = NULL;
    }
    sn_release(start);
    return ok ? SN_OK : sn_fail(err, SN_ENOMEM, "mesh check: no memory for the edges of %d faces", m->n_face);
}

static void edge_list_free(edge_list *e)
{
    sn_release(e->half);
    *e = (edge_list){NULL, 0};
}

/* One past the last half-edge of the edge that begins at i. */
static size_t edge_end(const edge_list *e, size_t i)
{
    size_t k = i + 1;
    while (k < e->n && e->half[k].low == e->half[i].low && e->half[k].high == e->half[i].high) k++;
    return k;
}

/* ---- components ---- */

static int32_t number_components(const edge_list *e, int32_t n_face, int32_t *comp)
{
    for (int32_t f = 0; f < n_face; f++) comp[f] = f;
    for (size_t i = 1; i < e->n; i++) {
        const half_edge *h = &e->half[i], *before = h - 1;
        if (h->low == before->low && h->high == before->high) join(comp, h->corner / 3, before->corner / 3);
    }
    int32_t n = 0;
    for (int32_t f = 0; f < n_face; f++) { /* parents are lower: they hold their number already */
        int32_t parent = comp[f];
        comp[f] = parent == f ? n++ : comp[parent];
    }
    return n;
}

sn_status sn_mesh_components(const sn_tri_mesh *m, int32_t *comp, int32_t *n_comp, sn_error *err)
{
    edge_list e;
    *n_comp = 0;
    sn_status st = edge_list_create(&e, m, err);
    if (st) return st;
    *n_comp = number_components(&e, m->n_face, comp);
    edge_list_free(&e);
    return SN_OK;
}

/* ---- edges and vertices ---- */

static bool repeats_vertex(const int32_t v[3])
{
    return v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
}

typedef struct work {
    const sn_tri_mesh *m;
    sn_mesh_check *out;
    edge_list edges;
    int32_t *fan;   /* 3 n_face: corners joined around their vertex             */
    int32_t *n_fan; /* n_vert: fans at a vertex; -1: an edge with too many faces */
    bool *used;     /* n_vert */
    bool balanced;  /* every edge has as many faces on one side as on the other */
} work;

/* The corner of the same face at the other end of the half-edge. */
static int32_t corner_after(int32_t corner)
{
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

static void join_around_ends(work *w, const half_edge *a, const half_edge *b)
{
    int32_t a_after = corner_after(a->corner), b_after = corner_after(b->corner);
    join(w->fan, a->forward ? a->corner : a_after, b->forward ? b->corner : b_after);
    join(w->fan, a->forward ? a_after : a->corner, b->forward ? b_after : b->corner);
}

/* Faces that name a vertex twice are no part of the surface around an edge. */
static void check_edge(work *w, size_t begin, size_t end)
{
    int32_t n_forward = 0, n_back = 0;
    const half_edge *last = NULL;
    for (size_t i = begin; i < end; i++) {
        const half_edge *h = &w->edges.half[i];
        if (repeats_vertex(w->m->face + 3 * (size_t)(h->corner / 3))) continue;
        if (last) join_around_ends(w, last, h);
        last = h;
        if (h->forward)
            n_forward++;
        else
            n_back++;
    }
    int32_t n = n_forward + n_back;
    if (n_forward != n_back) w->balanced = false;
    if (n == 2 && n_forward != n_back) w->out->oriented = false;
    if (n == 1) w->out->boundary_edges++;
    if (n <= 2) return;
    w->out->nonmanifold_edges++;
    w->n_fan[w->edges.half[begin].low] = w->n_fan[w->edges.half[begin].high] = -1;
}

static void check_edges(work *w)
{
    w->balanced = true;
    w->out->oriented = true;
    for (size_t i = 0; i < 3 * (size_t)w->m->n_face; i++) w->fan[i] = (int32_t)i;
    for (size_t i = 0, end; i < w->edges.n; i = end) {
        end = edge_end(&w->edges, i);
        check_edge(w, i, end);
    }
    w->out->closed = w->m->n_face > 0 && w->balanced; /* a boundary edge is not balanced */
}

static void check_vertices(work *w)
{
    const sn_tri_mesh *m = w->m;
    for (int32_t f = 0; f < m->n_face; f++) {
        const int32_t *v = m->face + 3 * (size_t)f;
        for (int k = 0; k < 3; k++) {
            w->used[v[k]] = true;
            bool starts_fan = !repeats_vertex(v) && find_root(w->fan, 3 * f + k) == 3 * f + k;
            if (starts_fan && w->n_fan[v[k]] >= 0) w->n_fan[v[k]]++;
        }
    }
    for (int32_t i = 0; i < m->n_vert; i++) {
        w->out->unused_vertices += !w->used[i];
        w->out->nonmanifold_vertices += w->n_fan[i] < 0 || w->n_fan[i] > 1;
    }
    w->out->manifold = w->out->nonmanifold_edges == 0 && w->out->nonmanifold_vertices == 0;
}

static sn_status check_topology(work *w, sn_error *err)
{
    size_t n_vert = (size_t)w->m->n_vert, n_face = (size_t)w->m->n_face;
    sn_status st = edge_list_create(&w->edges, w->m, err);
    if (st) return st;
    w->fan = SN_NEW(int32_t, 3 * n_face);
    w->n_fan = SN_NEW_ZERO(int32_t, n_vert);
    w->used = SN_NEW_ZERO(bool, n_vert);
    if (w->fan && w->n_fan && w->used) {
        check_edges(w);
        check_vertices(w);
        w->out->components = number_components(&w->edges, w->m->n_face, w->fan); /* fan is free now */
    } else {
        st = sn_fail(err, SN_ENOMEM, "mesh check: no memory for %d faces", w->m->n_face);
    }
    sn_release(w->fan);
    sn_release(w->n_fan);
    sn_release(w->used);
    edge_list_free(&w->edges);
    return st;
}

/* ---- repeated and flat things ---- */

typedef struct place {
    double x[3];
} place;

static int compare_places(const void *a, const void *b)
{
    const place *p = a, *q = b;
    for (int k = 0; k < 3; k++)
        if (p->x[k] != q->x[k]) return p->x[k] < q->x[k] ? -1 : 1;
    return 0;
}

static int compare_triples(const void *a, const void *b)
{
    const int32_t *p = a, *q = b;
    for (int k = 0; k < 3; k++)
        if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
    return 0;
}

/* How many elements equal an earlier one; sorts base. */
static int32_t count_repeats(void *base, size_t n, size_t size, int (*compare)(const void *, const void *))
{
    int32_t n_repeat = 0;
    const char *at = base;
    sn_sort(base, n, size, compare);
    for (size_t i = 1; i < n; i++) n_repeat += compare(at + (i - 1) * size, at + i * size) == 0;
    return n_repeat;
}

static sn_status check_repeats(const sn_tri_mesh *m, sn_mesh_check *out, sn_error *err)
{
    place *at = SN_NEW(place, m->n_vert);
    int32_t *triple = SN_NEW(int32_t, 3 * (size_t)m->n_face);
    bool ok = at && triple;
    if (ok && m->n_vert > 0) memcpy(at, m->pos, (size_t)m->n_vert * sizeof *at);
    if (ok && m->n_face > 0) memcpy(triple, m->face, 3 * (size_t)m->n_face * sizeof *triple);
    if (ok) {
        for (int32_t f = 0; f < m->n_face; f++) sn_sort3(triple + 3 * (size_t)f);
        out->duplicate_vertices = count_repeats(at, (size_t)m->n_vert, sizeof *at, compare_places);
        out->duplicate_faces = count_repeats(triple, (size_t)m->n_face, 3 * sizeof *triple, compare_triples);
    }
    sn_release(at);
    sn_release(triple);
    return ok ? SN_OK : sn_fail(err, SN_ENOMEM, "mesh check: no memory for %d faces", m->n_face);
}

static int32_t count_degenerate(const sn_tri_mesh *m)
{
    int32_t n = 0;
    for (int32_t f = 0; f < m->n_face; f++) {
        const int32_t *v = m->face + 3 * (size_t)f;
        n += repeats_vertex(v) ||
             sn_triangle_is_degenerate(sn_tri_mesh_point(m, v[0]), sn_tri_mesh_point(m, v[1]),
                                       sn_tri_mesh_point(m, v[2]));
    }
    return n;
}

sn_status sn_mesh_check_topology(sn_mesh_check *out, const sn_tri_mesh *m, sn_error *err)
{
    sn_mesh_check c = {.first_pair = {-1, -1}};
    *out = c;
    work w = {.m = m, .out = &c};
    sn_status st = check_topology(&w, err);
    if (!st) *out = c;
    return st;
}

sn_status sn_mesh_check_run(sn_mesh_check *out, const sn_tri_mesh *m, const sn_run *run, sn_error *err)
{
    sn_mesh_check c = {.first_pair = {-1, -1}};
    *out = c;
    work w = {.m = m, .out = &c};
    sn_self_crossings found;
    sn_status st = check_topology(&w, err);
    if (!st) st = check_repeats(m, &c, err);
    if (!st) st = sn_self_crossings_find(&found, m, false, run, err);
    if (st) return st;
    c.degenerate_faces = count_degenerate(m);
    c.self_intersections = (int64_t)found.n;
    memcpy(c.first_pair, found.first, sizeof c.first_pair);
    *out = c;
    return SN_OK;
}
