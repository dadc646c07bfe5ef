/* The cells of each tet and their tets.
 *
 * A cell is a simple convex polytope: every corner lies on exactly three of its facets, which are faces of
 * the tet or walls against another tissue, and its name says which. Two corners are joined by an edge when
 * they share two facets; the order of the three facets around a corner (an exact sign) says which way round.
 * So no geometry is needed to triangulate: a facet is a fan from its lowest corner, the cell a cone from its
 * lowest corner. */
#include "extract/extract_private.h"

#include "base/alloc.h"

#include <string.h>

#define CHUNK 2048 /* tets cut by one thread at a time */

typedef struct point {
    int32_t id;     /* corner number                            */
    int32_t tie[4]; /* n_tie tissues                            */
    int8_t n_tie;
    uint8_t faces; /* bit k: lies on face k of the tet         */
} point;

typedef struct corner { /* of one cell */
    int32_t id;
    int32_t facet[3]; /* in positive order: det of outward normals > 0 */
} corner;

typedef struct buffer { /* what one chunk makes */
    int32_t *tet, *part, *source;
    int32_t (*tie)[4];
    int32_t *tie_tet;
    size_t n_tet, n_inner, cap_tet, cap_part, cap_source, cap_tie, cap_tie_tet;
} buffer;

typedef struct worker {
    const sn_tet_mesh *mesh;
    const xt_grid *grid;
    const xt_cuts *cuts;
    buffer *out;
    int32_t first_inner; /* number of the first point inside tets */
    int32_t i_tet;
    const int32_t *v; /* its corners */
    const int32_t *row[4];
    xt_list candidate, present;
    point *pt;
    size_t n_pt, cap_pt;
    int32_t (*quad)[4]; /* points inside the tet, ascending tissues */
    size_t n_quad, cap_quad;
    corner *cell;
    size_t n_cell, cap_cell;
    bool out_of_memory, broken;
} worker;

/* ---- facets ---- */

static int32_t wall(int32_t tissue)
{
    return 4 + tissue;
}

/* ---- points inside the tet ---- */

static int64_t diff(const worker *w, int k, int32_t a, int32_t b)
{
    return (int64_t)w->row[k][a] - w->row[k][b];
}

/* The sign of the weights' determinant of the tie (i, j, k) on the edge from corner a to corner b. */
static int edge_sign(const worker *w, int a, int b, const int32_t s[3])
{
    int64_t p[2] = {diff(w, a, s[0], s[1]), diff(w, b, s[0], s[1])};
    int64_t q[2] = {diff(w, a, s[0], s[2]), diff(w, b, s[0], s[2])};
    return sn_sign2(s[0], p, q, s + 1);
}

/* The faces of the tet where the three tissues of s tie: none or two. sign[n]: of the weights there. */
static int line_ends(const worker *w, const int32_t s[3], int face[2], int sign[2])
{
    int n = 0;
    for (int k = 0; k < 4 && n < 2; k++) {
        const int *f = sn_tet_face[k];
        int a = edge_sign(w, f[1], f[2], s), b = edge_sign(w, f[2], f[0], s);
        if (a != b || edge_sign(w, f[0], f[1], s) != a) continue;
        face[n] = k;
        sign[n++] = a;
    }
    return n;
}

/* On face k, where the tissues of s tie with weights of the given sign: is m above? */
static bool above_on_face(const worker *w, int k, int sign, const int32_t s[3], int32_t m)
{
    int64_t p[3], q[3], t[3];
    int32_t id[3] = {s[1], s[2], m};
    for (int c = 0; c < 3; c++) {
        int x = sn_tet_face[k][c];
        p[c] = diff(w, x, s[0], s[1]);
        q[c] = diff(w, x, s[0], s[2]);
        t[c] = diff(w, x, s[0], m);
    }
    return sign * sn_sign3(s[0], p, q, t, id) < 0;
}

/* Inside, where the tissues of s and l tie: is m above? */
static bool above_inside(const worker *w, const int32_t s[3], int32_t l, int32_t m)
{
    int64_t p[4], q[4], r[4], t[4];
    int32_t id[4] = {s[1], s[2], l, m};
    for (int x = 0; x < 4; x++) {
        p[x] = diff(w, x, s[0], s[1]);
        q[x] = diff(w, x, s[0], s[2]);
        r[x] = diff(w, x, s[0], l);
        t[x] = diff(w, x, s[0], m);
    }
    return sn_sign3(s[0], p, q, r, id) * sn_sign4(s[0], p, q, r, t, id) < 0;
}

/* Along the tie of s to its end on face k: the tissue met first, or -1. */
static int32_t first_met(const worker *w, const int32_t s[3], int k, int sign)
{
    int32_t best = -1;
    for (size_t c = 0; c < w->candidate.n; c++) {
        int32_t m = w->candidate.id[c];
        if (m == s[0] || m == s[1] || m == s[2] || !above_on_face(w, k, sign, s, m)) continue;
        if (best < 0 || above_inside(w, s, best, m)) best = m;
    }
    return best;
}

static void add_quad(worker *w, const int32_t s[3], int32_t m)
{
    int32_t q[4] = {s[0], s[1], s[2], m};
    for (int i = 3; i > 0 && q[i] < q[i - 1]; i--) { /* s is ascending */
        int32_t swap = q[i];
        q[i] = q[i - 1];
        q[i - 1] = swap;
    }
    for (size_t k = 0; k < w->n_quad; k++)
        if (memcmp(w->quad[k], q, sizeof q) == 0) return;
    if (!sn_grow(&w->quad, &w->cap_quad, w->n_quad + 1, sizeof *w->quad)) {
        w->out_of_memory = true;
        return;
    }
    memcpy(w->quad[w->n_quad++], q, sizeof q);
}

/* From the point on face `from` along the tie of s into the tet. */
static void follow_from_face(worker *w, const int32_t s[3], int from)
{
    int face[2], sign[2], n = line_ends(w, s, face, sign);
    for (int e = 0; e < n; e++) {
        if (face[e] == from) continue;
        int32_t m = first_met(w, s, face[e], sign[e]);
        if (m >= 0) add_quad(w, s, m);
    }
}

/* From a point inside along its four lines, each to where its fourth tissue falls below. */
static void follow_from_inside(worker *w, size_t at)
{
    for (int out = 0; out < 4; out++) {
        int32_t s[3], n_s = 0, gone = w->quad[at][out];
        for (int i = 0; i < 4; i++)
            if (i != out) s[n_s++] = w->quad[at][i];
        int face[2], sign[2], n = line_ends(w, s, face, sign);
        for (int e = 0; e < n; e++) {
            if (above_on_face(w, face[e], sign[e], s, gone)) continue;
            int32_t m = first_met(w, s, face[e], sign[e]);
            if (m >= 0) add_quad(w, s, m);
        }
    }
}

/* ---- gathering ---- */

static void add_point(worker *w, int32_t id, const int32_t *tie, int n_tie, unsigned faces)
{
    if (!sn_grow(&w->pt, &w->cap_pt, w->n_pt + 1, sizeof *w->pt)) {
        w->out_of_memory = true;
        return;
    }
    point *p = &w->pt[w->n_pt++];
    p->id = id;
    p->n_tie = (int8_t)n_tie;
    p->faces = (uint8_t)faces;
    memcpy(p->tie, tie, (size_t)n_tie * sizeof *tie);
}

static void gather_vertices_and_edges(worker *w)
{
    for (int k = 0; k < 4; k++) add_point(w, w->v[k], &w->grid->winner[w->v[k]], 1, 15u & ~(1u << k));
    for (int e = 0; e < 6; e++) {
        int a = sn_tet_edge[e][0], b = sn_tet_edge[e][1];
        if (w->grid->winner[w->v[a]] == w->grid->winner[w->v[b]]) continue;
        int32_t i = xt_find_edge(w->cuts, w->v[a], w->v[b]);
        if (i < 0) {
            w->broken = true;
            return;
        }
        for (int32_t p = w->cuts->edge_first[i]; p < w->cuts->edge_first[i + 1]; p++)
            add_point(w, w->mesh->n_vert + p, w->cuts->edge_tie[p], 2, 15u & ~(1u << a) & ~(1u << b));
    }
}

static void gather_faces(worker *w)
{
    for (int k = 0; k < 4; k++) {
        const int *f = sn_tet_face[k];
        int32_t i = xt_find_face(w->cuts, w->v[f[0]], w->v[f[1]], w->v[f[2]]);
        for (int32_t p = i < 0 ? 0 : w->cuts->face_first[i]; i >= 0 && p < w->cuts->face_first[i + 1]; p++)
            add_point(w, w->mesh->n_vert + w->cuts->n_edge_point + p, w->cuts->face_tie[p], 3, 1u << k);
    }
}

static void gather_inside(worker *w, size_t first_on_face)
{
    w->n_quad = 0;
    if (first_on_face == w->n_pt) return; /* every point inside is reached from a face */
    if (!xt_candidates(w->grid, w->v, 4, &w->candidate)) {
        w->out_of_memory = true;
        return;
    }
    if (w->candidate.n < 4) return;
    for (size_t i = first_on_face; i < w->n_pt; i++)
        follow_from_face(w, w->pt[i].tie, __builtin_ctz(w->pt[i].faces));
    for (size_t at = 0; at < w->n_quad && !w->out_of_memory; at++) follow_from_inside(w, at);
    for (size_t i = 0; i < w->n_quad; i++)
        add_point(w, w->first_inner + (int32_t)(w->out->n_inner + i), w->quad[i], 4, 0);
}

static void keep_inside(worker *w)
{
    buffer *b = w->out;
    if (!sn_grow(&b->tie, &b->cap_tie, b->n_inner + w->n_quad, sizeof *b->tie) ||
        !sn_grow(&b->tie_tet, &b->cap_tie_tet, b->n_inner + w->n_quad, sizeof *b->tie_tet)) {
        w->out_of_memory = true;
        return;
    }
    for (size_t i = 0; i < w->n_quad; i++) {
        memcpy(b->tie[b->n_inner], w->quad[i], sizeof *b->tie);
        b->tie_tet[b->n_inner++] = w->i_tet;
    }
}

static void add_present(worker *w, int32_t tissue)
{
    for (size_t i = 0; i < w->present.n; i++)
        if (w->present.id[i] == tissue) return;
    if (!sn_grow(&w->present.id, &w->present.cap, w->present.n + 1, sizeof *w->present.id)) {
        w->out_of_memory = true;
        return;
    }
    w->present.id[w->present.n++] = tissue;
}

/* ---- one cell ---- */

/* The outward normal of a facet of tissue i's cell, in the basis of the gradients of barycentric coordinates
 * 1, 2, 3. */
static void facet_normal(const worker *w, int32_t i, int32_t facet, int64_t n[3])
{
    for (int k = 0; k < 3; k++) {
        if (facet == 0)
            n[k] = 1;
        else if (facet < 4)
            n[k] = facet == k + 1 ? -1 : 0;
        else
            n[k] = diff(w, k + 1, facet - 4, i) - diff(w, 0, facet - 4, i);
    }
}

static void add_corner(worker *w, const point *p, int32_t tissue)
{
    int64_t normal[3][3];
    corner c = {.id = p->id};
    int n = 0;
    for (int k = 0; k < 4; k++)
        if (p->faces >> k & 1) c.facet[n++] = k;
    for (int k = 0; k < p->n_tie; k++)
        if (p->tie[k] != tissue) c.facet[n++] = wall(p->tie[k]);
    for (int k = 0; k < 3; k++) facet_normal(w, tissue, c.facet[k], normal[k]);
    int sign = sn_sign128(sn_det3(normal[0], normal[1], normal[2]));
    if (sign == 0) w->broken = true;
    if (sign < 0) {
        int32_t s = c.facet[1];
        c.facet[1] = c.facet[2];
        c.facet[2] = s;
    }
    if (!sn_grow(&w->cell, &w->cap_cell, w->n_cell + 1, sizeof *w->cell)) {
        w->out_of_memory = true;
        return;
    }
    w->cell[w->n_cell++] = c;
}

static bool collect_cell(worker *w, int32_t tissue)
{
    w->n_cell = 0;
    for (size_t i = 0; i < w->n_pt; i++)
        for (int k = 0; k < w->pt[i].n_tie; k++)
            if (w->pt[i].tie[k] == tissue) add_corner(w, &w->pt[i], tissue);
    if (w->n_cell < 4) w->broken = true;
    return !w->broken && !w->out_of_memory;
}

static int facet_place(const corner *c, int32_t facet)
{
    return c->facet[0] == facet ? 0 : c->facet[1] == facet ? 1 : c->facet[2] == facet ? 2 : -1;
}

/* The corner after c counter-clockwise around the facet: the other one that also lies on the facet that
 * follows in c's order but one. -1: none, which cannot be. */
static int32_t next_around(const worker *w, int32_t at, int32_t facet)
{
    const corner *c = &w->cell[at];
    int32_t leave = c->facet[(facet_place(c, facet) + 2) % 3];
    for (size_t i = 0; i < w->n_cell; i++)
        if ((int32_t)i != at && facet_place(&w->cell[i], facet) >= 0 && facet_place(&w->cell[i], leave) >= 0)
            return (int32_t)i;
    return -1;
}

static void add_tet(worker *w, int32_t a, int32_t b, int32_t c, int32_t d, int32_t tissue)
{
    buffer *o = w->out;
    if (!sn_grow(&o->tet, &o->cap_tet, 4 * (o->n_tet + 1), sizeof *o->tet) ||
        !sn_grow(&o->part, &o->cap_part, o->n_tet + 1, sizeof *o->part) ||
        !sn_grow(&o->source, &o->cap_source, o->n_tet + 1, sizeof *o->source)) {
        w->out_of_memory = true;
        return;
    }
    int32_t *t = o->tet + 4 * o->n_tet;
    t[0] = a;
    t[1] = b;
    t[2] = c;
    t[3] = d;
    o->part[o->n_tet] = tissue;
    o->source[o->n_tet++] = w->i_tet;
}

/* The facet as a fan from its lowest corner, which is corner `first`, coned to the apex. */
static void cone_facet(worker *w, int32_t apex, int32_t first, int32_t facet, int32_t tissue)
{
    int32_t a = next_around(w, first, facet);
    for (size_t guard = 0; a >= 0 && guard < w->n_cell; guard++) {
        int32_t b = next_around(w, a, facet);
        if (b < 0) break;
        if (b == first) return;
        add_tet(w, w->cell[apex].id, w->cell[first].id, w->cell[a].id, w->cell[b].id, tissue);
        a = b;
    }
    w->broken = true;
}

static void triangulate_cell(worker *w, int32_t tissue)
{
    int32_t apex = 0;
    for (size_t i = 1; i < w->n_cell; i++)
        if (w->cell[i].id < w->cell[apex].id) apex = (int32_t)i;
    for (size_t i = 0; i < w->n_cell; i++)
        for (int k = 0; k < 3; k++) { /* each facet is handled at its lowest corner */
            int32_t facet = w->cell[i].facet[k];
            bool lowest = facet_place(&w->cell[apex], facet) < 0;
            for (size_t j = 0; j < w->n_cell && lowest; j++)
                lowest = facet_place(&w->cell[j], facet) < 0 || w->cell[j].id >= w->cell[i].id;
            if (lowest) cone_facet(w, apex, (int32_t)i, facet, tissue);
        }
}

/* ---- one tet ---- */

static void cut_tet(worker *w, int32_t t)
{
    w->i_tet = t;
    w->v = w->mesh->tet + 4 * (size_t)t;
    int32_t win = w->grid->winner[w->v[0]];
    bool is_pure = true;
    for (int k = 1; k < 4; k++) is_pure = is_pure && w->grid->winner[w->v[k]] == win;
    if (is_pure) {
        add_tet(w, w->v[0], w->v[1], w->v[2], w->v[3], win);
        return;
    }
    for (int k = 0; k < 4; k++) w->row[k] = xt_row(w->grid, w->v[k]);
    w->n_pt = w->present.n = 0;
    gather_vertices_and_edges(w);
    size_t first_on_face = w->n_pt;
    gather_faces(w);
    gather_inside(w, first_on_face);
    keep_inside(w);
    for (size_t i = 0; i < w->n_pt; i++)
        for (int k = 0; k < w->pt[i].n_tie; k++) add_present(w, w->pt[i].tie[k]);
    for (size_t i = 0; i < w->present.n; i++)
        if (collect_cell(w, w->present.id[i])) triangulate_cell(w, w->present.id[i]);
}

static void free_worker(worker *w)
{
    sn_release(w->candidate.id);
    sn_release(w->present.id);
    sn_release(w->pt);
    sn_release(w->quad);
    sn_release(w->cell);
}

static void free_buffer(buffer *b)
{
    sn_release(b->tet);
    sn_release(b->part);
    sn_release(b->source);
    sn_release(b->tie);
    sn_release(b->tie_tet);
}

/* ---- all tets ---- */

static sn_status allocate(xt_cells *c, const buffer *b, int32_t n_chunk, sn_error *err)
{
    for (int32_t i = 0; i < n_chunk; i++) {
        c->n_tet += b[i].n_tet;
        c->n_inner += b[i].n_inner;
    }
    if (c->n_tet > INT32_MAX)
        return sn_fail(err, SN_ELIMIT, "extract: %zu tets are more than 2^31", c->n_tet);
    c->tet = SN_NEW(int32_t, 4 * c->n_tet);
    c->part = SN_NEW(int32_t, c->n_tet);
    c->source = SN_NEW(int32_t, c->n_tet);
    c->inner_tie = sn_alloc(c->n_inner, sizeof *c->inner_tie);
    c->inner_tet = SN_NEW(int32_t, c->n_inner);
    if (c->tet && c->part && c->source && c->inner_tie && c->inner_tet) return SN_OK;
    return sn_fail(err, SN_ENOMEM, "extract: no memory for %zu tets", c->n_tet);
}

/* The chunks in order; points inside get their final numbers. */
static void join(xt_cells *c, buffer *b, int32_t n_chunk, int32_t first_inner)
{
    size_t n_tet = 0, n_inner = 0;
    for (int32_t i = 0; i < n_chunk; i++) {
        for (size_t k = 0; k < 4 * b[i].n_tet; k++)
            c->tet[4 * n_tet + k] = b[i].tet[k] < first_inner ? b[i].tet[k] : b[i].tet[k] + (int32_t)n_inner;
        memcpy(c->part + n_tet, b[i].part, b[i].n_tet * sizeof *c->part);
        memcpy(c->source + n_tet, b[i].source, b[i].n_tet * sizeof *c->source);
        if (b[i].n_inner) {
            memcpy(c->inner_tie + n_inner, b[i].tie, b[i].n_inner * sizeof *c->inner_tie);
            memcpy(c->inner_tet + n_inner, b[i].tie_tet, b[i].n_inner * sizeof *c->inner_tet);
        }
        n_tet += b[i].n_tet;
        n_inner += b[i].n_inner;
    }
}

void xt_cells_free(xt_cells *c)
{
    sn_release(c->tet);
    sn_release(c->part);
    sn_release(c->source);
    sn_release(c->inner_tie);
    sn_release(c->inner_tet);
    memset(c, 0, sizeof *c);
}

sn_status xt_cells_build(xt_cells *c, const sn_tet_mesh *m, const xt_grid *g, const xt_cuts *cuts,
                         const sn_run *run, sn_error *err)
{
    int32_t n_chunk = (m->n_tet + CHUNK - 1) / CHUNK,
            first_inner = m->n_vert + cuts->n_edge_point + cuts->n_face_point;
    buffer *b = SN_NEW_ZERO(buffer, n_chunk);
    bool out_of_memory = false, broken = false;
    memset(c, 0, sizeof *c);
    if (!b) return sn_fail(err, SN_ENOMEM, "extract: no memory");
    sn_status st = sn_run_step(run, "cutting tets", 0.0, err);
#pragma omp parallel num_threads(sn_run_threads(run)) reduction(|| : out_of_memory, broken)
    {
        worker w = {.mesh = m, .grid = g, .cuts = cuts, .first_inner = first_inner};
#pragma omp for schedule(dynamic, 1)
        for (int32_t i = 0; i < n_chunk; i++) {
            if (sn_run_stopped(run) || w.out_of_memory) continue;
            int32_t end = (i + 1) * CHUNK < m->n_tet ? (i + 1) * CHUNK : m->n_tet;
            w.out = &b[i];
            for (int32_t t = i * CHUNK; t < end && !w.out_of_memory; t++) cut_tet(&w, t);
        }
        out_of_memory = out_of_memory || w.out_of_memory;
        broken = broken || w.broken;
        free_worker(&w);
    }
    if (!st) st = sn_run_step(run, "cutting tets", 1.0, err);
    if (!st && out_of_memory) st = sn_fail(err, SN_ENOMEM, "extract: no memory");
    if (!st && broken) st = sn_fail(err, SN_EINTERNAL, "extract: a cell is not a simple polytope");
    if (!st) st = allocate(c, b, n_chunk, err);
    if (!st) join(c, b, n_chunk, first_inner);
    if (st) xt_cells_free(c);
    for (int32_t i = 0; i < n_chunk; i++) free_buffer(&b[i]);
    sn_release(b);
    return st;
}
