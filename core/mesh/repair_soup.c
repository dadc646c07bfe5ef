/* repair_soup.c - welding, and faces that should not be there. */
#include "mesh/repair_private.h"

#include "base/alloc.h"
#include "base/array.h"
#include "mesh/predicates.h"

#include <string.h>

/* ---- welding: the vertices that stay, in a hash table of cells as wide as the tolerance ---- */

typedef struct cells {
    const sn_tri_mesh *m;
    double size;
    int32_t *head, *next; /* head: mask + 1; next: n_vert */
    size_t mask;
} cells;

static size_t cell_slot(const cells *c, const double cell[3])
{
    uint64_t h = 0;
    for (int k = 0; k < 3; k++) {
        double x = cell[k] + 0.0; /* -0 -> 0 */
        uint64_t bits;
        memcpy(&bits, &x, sizeof bits);
        h = (h ^ bits) * 0x9E3779B97F4A7C15u;
        h ^= h >> 29;
    }
    return (size_t)h & c->mask;
}

static void cell_of(const cells *c, sn_vec3 p, double cell[3])
{
    sn_v3_store(cell, sn_v3_scale(1.0 / c->size, p));
    for (int k = 0; k < 3; k++) cell[k] = floor(cell[k]);
}

/* The nearest vertex that stays within the tolerance, the lowest of several; -1: none. */
static int32_t nearest_kept(const cells *c, sn_vec3 p, double tolerance, double *dist)
{
    double center[3];
    int32_t best = -1;
    cell_of(c, p, center);
    for (int i = 0; i < 27; i++) {
        const double cell[3] = {center[0] + i / 9 - 1, center[1] + i / 3 % 3 - 1, center[2] + i % 3 - 1};
        for (int32_t v = c->head[cell_slot(c, cell)]; v >= 0; v = c->next[v]) {
            double d = sn_v3_dist(p, sn_tri_mesh_point(c->m, v));
            if (d > tolerance || (best >= 0 && (d > *dist || (d == *dist && v >= best)))) continue;
            best = v;
            *dist = d;
        }
    }
    return best;
}

/* to[i]: the vertex that i becomes part of, itself when it stays. */
static void find_joins(cells *c, double tolerance, int32_t *to, double *moved)
{
    for (size_t s = 0; s <= c->mask; s++) c->head[s] = -1;
    for (int32_t i = 0; i < c->m->n_vert; i++) {
        sn_vec3 p = sn_tri_mesh_point(c->m, i);
        double dist = 0.0, cell[3];
        int32_t near = nearest_kept(c, p, tolerance, &dist);
        to[i] = near >= 0 ? near : i;
        if (near >= 0) {
            if (dist > *moved) *moved = dist;
            continue;
        }
        cell_of(c, p, cell);
        size_t slot = cell_slot(c, cell);
        c->next[i] = c->head[slot];
        c->head[slot] = i;
    }
}

static int32_t join_vertices(sn_tri_mesh *m, int32_t *to)
{
    int32_t n = 0;
    for (int32_t i = 0; i < m->n_vert; i++) {
        if (to[i] == i) {
            memmove(m->pos + 3 * (size_t)n, m->pos + 3 * (size_t)i, 3 * sizeof *m->pos);
            to[i] = n++;
        } else {
            to[i] = to[to[i]]; /* a lower vertex: it has its new number */
        }
    }
    for (size_t k = 0; k < 3 * (size_t)m->n_face; k++) m->face[k] = to[m->face[k]];
    int32_t n_joined = m->n_vert - n;
    m->n_vert = n;
    return n_joined;
}

sn_status sn_repair_weld(sn_tri_mesh *m, double tolerance, int32_t *n_joined, double *moved, sn_error *err)
{
    *moved = 0.0;
    if (!(tolerance > 0.0)) return sn_tri_mesh_weld(m, n_joined, err);
    cells c = {.m = m, .size = tolerance, .mask = 1};
    while (c.mask < 2 * (size_t)m->n_vert) c.mask = 2 * c.mask + 1;
    int32_t *to = SN_NEW(int32_t, m->n_vert);
    c.head = SN_NEW(int32_t, c.mask + 1);
    c.next = SN_NEW(int32_t, m->n_vert);
    bool ok = to && c.head && c.next;
    if (ok) {
        find_joins(&c, tolerance, to, moved);
        *n_joined = join_vertices(m, to);
    }
    sn_release(to);
    sn_release(c.head);
    sn_release(c.next);
    return ok ? SN_OK : sn_fail(err, SN_ENOMEM, "weld: no memory for %d vertices", m->n_vert);
}

/* ---- faces without area ---- */

typedef struct corners { /* the corners 3 face + k at each vertex, chained */
    sn_tri_mesh *m;
    int32_t *head, *next; /* n_vert, 3 n_face */
    bool *keep;           /* n_face */
} corners;

static void chain_corner(corners *c, int32_t corner)
{
    int32_t v = c->m->face[corner];
    c->next[corner] = c->head[v];
    c->head[v] = corner;
}

static void unchain_corner(corners *c, int32_t corner)
{
    int32_t *at = &c->head[c->m->face[corner]];
    while (*at != corner) at = &c->next[*at];
    *at = c->next[corner];
}

static void set_corner(corners *c, int32_t corner, int32_t v)
{
    unchain_corner(c, corner);
    c->m->face[corner] = v;
    chain_corner(c, corner);
}

static bool repeats_vertex(const int32_t *v)
{
    return v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
}

static bool is_flat(const sn_tri_mesh *m, int32_t f)
{
    const int32_t *v = m->face + 3 * (size_t)f;
    return repeats_vertex(v) ||
           sn_triangle_is_degenerate(sn_tri_mesh_point(m, v[0]), sn_tri_mesh_point(m, v[1]),
                                     sn_tri_mesh_point(m, v[2]));
}

/* The lowest face besides f with the vertices p and q and a third that is not r; -1: none. */
static int32_t face_across(const corners *c, int32_t f, int32_t p, int32_t q, int32_t r)
{
    int32_t best = -1;
    for (int32_t corner = c->head[p]; corner >= 0; corner = c->next[corner]) {
        int32_t g = corner / 3;
        const int32_t *v = c->m->face + 3 * (size_t)g;
        bool has_q = v[0] == q || v[1] == q || v[2] == q, has_r = v[0] == r || v[1] == r || v[2] == r;
        if (g != f && c->keep[g] && has_q && !has_r && !repeats_vertex(v) && (best < 0 || g < best)) best = g;
    }
    return best;
}

/* Face f has its corners on a line. Its longest side is that of a neighbour, which the corner between splits
 * in two: f becomes the second half. false when there is no such neighbour. */
static bool merge_flat(corners *c, int32_t f)
{
    int32_t *v = c->m->face + 3 * (size_t)f;
    double longest = -1.0;
    int32_t p = 0, q = 0, r = 0;
    for (int k = 0; k < 3; k++) {
        double d = sn_v3_dist(sn_tri_mesh_point(c->m, v[k]), sn_tri_mesh_point(c->m, v[(k + 1) % 3]));
        if (d <= longest) continue;
        longest = d;
        p = v[k], q = v[(k + 1) % 3], r = v[(k + 2) % 3];
    }
    int32_t g = face_across(c, f, p, q, r);
    if (g < 0) return false;
    for (int k = 0; k < 3; k++) {
        int32_t x = c->m->face[3 * (size_t)g + (size_t)k];
        set_corner(c, 3 * f + k, x == p ? r : x);
    }
    for (int k = 0; k < 3; k++)
        if (c->m->face[3 * (size_t)g + (size_t)k] == q) set_corner(c, 3 * g + k, r);
    return true;
}

/* In the order of the faces, again while something changes: a half may be without area too. */
static int32_t drop_flat(corners *c)
{
    int32_t n = 0;
    bool changes = true;
    for (int pass = 0; changes && pass < 8; pass++) {
        changes = false;
        for (int32_t f = 0; f < c->m->n_face; f++) {
            const int32_t *v = c->m->face + 3 * (size_t)f;
            if (!c->keep[f] || !is_flat(c->m, f)) continue;
            if (pass == 0) n++;
            if (repeats_vertex(v))
                c->keep[f] = false;
            else
                changes = merge_flat(c, f) || changes;
        }
    }
    for (int32_t f = 0; f < c->m->n_face; f++)
        if (c->keep[f] && is_flat(c->m, f)) c->keep[f] = false;
    return n;
}

/* ---- faces that are there twice, and the whole ---- */

typedef struct named_face {
    int32_t v[3], face;
} named_face;

static int compare_named(const void *a, const void *b)
{
    const named_face *p = a, *q = b;
    for (int k = 0; k < 3; k++)
        if (p->v[k] != q->v[k]) return p->v[k] < q->v[k] ? -1 : 1;
    return (p->face > q->face) - (p->face < q->face);
}

static int32_t drop_repeats(const sn_tri_mesh *m, named_face *name, bool *keep)
{
    int32_t n = 0, n_repeat = 0;
    for (int32_t f = 0; f < m->n_face; f++) {
        if (!keep[f]) continue;
        memcpy(name[n].v, m->face + 3 * (size_t)f, sizeof name[n].v);
        sn_sort3(name[n].v);
        name[n++].face = f;
    }
    sn_sort(name, (size_t)n, sizeof *name, compare_named);
    for (int32_t i = 1; i < n; i++) {
        if (memcmp(name[i].v, name[i - 1].v, sizeof name[i].v) != 0) continue;
        keep[name[i].face] = false;
        n_repeat++;
    }
    return n_repeat;
}

sn_status sn_repair_keep_faces(sn_tri_mesh *m, const bool *keep, int32_t *n_unused, sn_error *err)
{
    int32_t *number = SN_NEW_ZERO(int32_t, m->n_vert), n_vert = 0, n_face = 0;
    if (!number) return sn_fail(err, SN_ENOMEM, "repair: no memory for %d vertices", m->n_vert);
    for (int32_t f = 0; f < m->n_face; f++) {
        if (!keep[f]) continue;
        memmove(m->face + 3 * (size_t)n_face, m->face + 3 * (size_t)f, 3 * sizeof *m->face);
        for (int k = 0; k < 3; k++) number[m->face[3 * (size_t)n_face + (size_t)k]] = 1;
        n_face++;
    }
    for (int32_t i = 0; i < m->n_vert; i++) {
        if (!number[i]) continue;
        memmove(m->pos + 3 * (size_t)n_vert, m->pos + 3 * (size_t)i, 3 * sizeof *m->pos);
        number[i] = n_vert++;
    }
    for (size_t k = 0; k < 3 * (size_t)n_face; k++) m->face[k] = number[m->face[k]];
    if (n_unused) *n_unused = m->n_vert - n_vert;
    m->n_vert = n_vert;
    m->n_face = n_face;
    sn_release(number);
    return SN_OK;
}

sn_status sn_repair_clean(sn_tri_mesh *m, sn_clean_counts *n, sn_error *err)
{
    corners c = {.m = m,
                 .head = SN_NEW(int32_t, m->n_vert),
                 .next = SN_NEW(int32_t, 3 * (size_t)m->n_face),
                 .keep = SN_NEW(bool, m->n_face)};
    named_face *name = SN_NEW(named_face, m->n_face);
    sn_status st = SN_OK;
    if (c.head && c.next && c.keep && name) {
        for (int32_t i = 0; i < m->n_vert; i++) c.head[i] = -1;
        for (int32_t k = 0; k < 3 * m->n_face; k++) chain_corner(&c, k);
        for (int32_t f = 0; f < m->n_face; f++) c.keep[f] = true;
        n->degenerate = drop_flat(&c);
        n->duplicate = drop_repeats(m, name, c.keep);
        st = sn_repair_keep_faces(m, c.keep, &n->unused, err);
    } else {
        st = sn_fail(err, SN_ENOMEM, "repair: no memory for %d faces", m->n_face);
    }
    sn_release(c.head);
    sn_release(c.next);
    sn_release(c.keep);
    sn_release(name);
    return st;
}
