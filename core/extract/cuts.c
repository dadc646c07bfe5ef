#include "extract/extract_private.h"

#include "base/alloc.h"
#include "base/array.h"

#include <string.h>

void xt_cuts_free(xt_cuts *c)
{
    sn_release(c->edge);
    sn_release(c->edge_first);
    sn_release(c->edge_tie);
    sn_release(c->face);
    sn_release(c->face_first);
    sn_release(c->face_tie);
    memset(c, 0, sizeof *c);
}

static sn_status no_memory(sn_error *err)
{
    return sn_fail(err, SN_ENOMEM, "extract: no memory");
}

static bool is_mixed(const xt_grid *g, const int32_t *t)
{
    int32_t w = g->winner[t[0]];
    return g->winner[t[1]] != w || g->winner[t[2]] != w || g->winner[t[3]] != w;
}

/* ---- edges ---- */

/* The distinct edges whose ends have different winners, sorted. */
static sn_status collect_edges(xt_cuts *c, const sn_tet_mesh *m, const xt_grid *g, sn_error *err)
{
    uint64_t *key = NULL, *tmp = NULL;
    size_t n = 0, cap = 0;
    for (int32_t t = 0; t < m->n_tet; t++) {
        const int32_t *v = m->tet + 4 * (size_t)t;
        if (!is_mixed(g, v)) continue;
        if (!sn_grow(&key, &cap, n + 6, sizeof *key)) goto no_mem;
        for (int e = 0; e < 6; e++) {
            int32_t a = v[sn_tet_edge[e][0]], b = v[sn_tet_edge[e][1]];
            if (g->winner[a] == g->winner[b]) continue;
            key[n++] = a < b ? (uint64_t)a << 32 | (uint64_t)b : (uint64_t)b << 32 | (uint64_t)a;
        }
    }
    tmp = SN_NEW(uint64_t, n);
    if (!tmp) goto no_mem;
    n = n ? sn_sort_unique_u64(key, tmp, n) : 0;
    c->edge = sn_alloc(n, sizeof *c->edge);
    c->edge_first = SN_NEW(int32_t, n + 1);
    if (!c->edge || !c->edge_first || n > INT32_MAX) goto no_mem;
    c->n_edge = (int32_t)n;
    for (size_t i = 0; i < n; i++) {
        c->edge[i][0] = (int32_t)(key[i] >> 32);
        c->edge[i][1] = (int32_t)(key[i] & 0xffffffffu);
    }
    sn_release(key);
    sn_release(tmp);
    return SN_OK;
no_mem:
    sn_release(key);
    sn_release(tmp);
    return no_memory(err);
}

/* From the tissue that wins so far, the one that overtakes it first on the way to v: see signs.h for the
 * rows. */
static int32_t next_winner(const xt_grid *g, int32_t u, int32_t v, int32_t now)
{
    const int32_t *fu = xt_row(g, u), *fv = xt_row(g, v);
    int32_t best = -1;
    for (int32_t j = 0; j < g->n_tissue; j++) {
        if (j == now || sn_sign_above(fv[j], j, fv[now], now) < 0) continue;
        if (best < 0) {
            best = j;
            continue;
        }
        int64_t p[2] = {(int64_t)fu[now] - fu[best], (int64_t)fv[now] - fv[best]};
        int64_t q[2] = {(int64_t)fu[now] - fu[j], (int64_t)fv[now] - fv[j]};
        int32_t id[2] = {best, j};
        if (sn_sign2(now, p, q, id) < 0) best = j; /* j is above where best overtakes */
    }
    return best;
}

static sn_status cut_edges(xt_cuts *c, const xt_grid *g, sn_error *err)
{
    size_t n = 0, cap = 0;
    for (int32_t e = 0; e < c->n_edge; e++) {
        int32_t u = c->edge[e][0], v = c->edge[e][1], now = g->winner[u];
        c->edge_first[e] = (int32_t)n;
        while (now != g->winner[v]) {
            int32_t next = next_winner(g, u, v, now);
            if (next < 0 || n >= INT32_MAX - 1)
                return sn_fail(err, SN_EINTERNAL, "extract: no winner on edge (%d, %d)", u + 1, v + 1);
            if (!sn_grow(&c->edge_tie, &cap, n + 1, sizeof *c->edge_tie)) return no_memory(err);
            c->edge_tie[n][0] = now;
            c->edge_tie[n][1] = next;
            n++;
            now = next;
        }
    }
    c->edge_first[c->n_edge] = (int32_t)n;
    c->n_edge_point = (int32_t)n;
    return SN_OK;
}

int32_t xt_find_edge(const xt_cuts *c, int32_t u, int32_t v)
{
    if (u > v) {
        int32_t s = u;
        u = v;
        v = s;
    }
    int32_t lo = 0, hi = c->n_edge;
    while (lo < hi) {
        int32_t mid = lo + (hi - lo) / 2;
        if (c->edge[mid][0] < u || (c->edge[mid][0] == u && c->edge[mid][1] < v))
            lo = mid + 1;
        else
            hi = mid;
    }
    return lo < c->n_edge && c->edge[lo][0] == u && c->edge[lo][1] == v ? lo : -1;
}

/* ---- faces ---- */

/* At least three tissues on the border of the face: with two, none can win inside alone. */
static bool has_three_tissues(const xt_cuts *c, const xt_grid *g, const int32_t v[3])
{
    int32_t a = g->winner[v[0]], b = -1;
    for (int k = 0; k < 3; k++) {
        int32_t w = g->winner[v[k]];
        if (w != a && b < 0) b = w;
        if (w != a && w != b) return true;
    }
    for (int k = 0; k < 3; k++) {
        int32_t e = xt_find_edge(c, v[k], v[(k + 1) % 3]);
        for (int32_t i = e < 0 ? 0 : c->edge_first[e]; e >= 0 && i < c->edge_first[e + 1]; i++)
            for (int s = 0; s < 2; s++)
                if (c->edge_tie[i][s] != a && c->edge_tie[i][s] != b) return true;
    }
    return false;
}

static int face_less(const void *a, const void *b)
{
    const int32_t *p = a, *q = b;
    for (int k = 0; k < 3; k++)
        if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
    return 0;
}

static sn_status collect_faces(xt_cuts *c, const sn_tet_mesh *m, const xt_grid *g, sn_error *err)
{
    size_t n = 0, cap = 0;
    for (int32_t t = 0; t < m->n_tet; t++) {
        const int32_t *v = m->tet + 4 * (size_t)t;
        if (!is_mixed(g, v)) continue;
        for (int k = 0; k < 4; k++) {
            int32_t f[3] = {v[sn_tet_face[k][0]], v[sn_tet_face[k][1]], v[sn_tet_face[k][2]]};
            sn_sort3(f);
            if (!has_three_tissues(c, g, f)) continue;
            if (!sn_grow(&c->face, &cap, n + 1, sizeof *c->face)) return no_memory(err);
            memcpy(c->face[n++], f, sizeof f);
        }
    }
    sn_sort(c->face, n, sizeof *c->face, face_less);
    size_t kept = 0;
    for (size_t i = 0; i < n; i++)
        if (i == 0 || face_less(c->face[i], c->face[kept - 1]) != 0)
            memmove(c->face[kept++], c->face[i], sizeof *c->face);
    if (kept > INT32_MAX) return sn_fail(err, SN_ELIMIT, "extract: too many faces");
    c->n_face = (int32_t)kept;
    return SN_OK;
}

/* A face while its triple points are traced. */
typedef struct face_work {
    const xt_grid *g;
    int32_t corner[3];
    const int32_t *row[3];
    xt_list candidate;
    int32_t (*triple)[3]; /* found so far, ascending tissues */
    size_t n, cap;
} face_work;

static int64_t diff(const face_work *w, int k, int32_t a, int32_t b)
{
    return (int64_t)w->row[k][a] - w->row[k][b];
}

/* On edge (k, l) where i and j tie: is m above them? Needs the tie to be there. */
static bool above_on_edge(const face_work *w, int k, int l, int32_t i, int32_t j, int32_t m)
{
    int64_t p[2] = {diff(w, k, i, j), diff(w, l, i, j)}, q[2] = {diff(w, k, i, m), diff(w, l, i, m)};
    int32_t id[2] = {j, m};
    /* Weights (p[1], -p[0]) up to the sign s = sign p[1] of the first: f_i - f_m there is s (p[1] q[0] - p[0]
     * q[1]). */
    int s = sn_sign_above(w->row[l][i], i, w->row[l][j], j);
    return -s * sn_sign2(i, p, q, id) < 0;
}

/* Inside, where i, j and k tie: is m above? */
static bool above_inside(const face_work *w, int32_t i, int32_t j, int32_t k, int32_t m)
{
    int64_t p[3], q[3], t[3];
    for (int c = 0; c < 3; c++) {
        p[c] = diff(w, c, i, j);
        q[c] = diff(w, c, i, k);
        t[c] = diff(w, c, i, m);
    }
    int64_t p01[2] = {p[0], p[1]}, q01[2] = {q[0], q[1]};
    int32_t id2[2] = {j, k}, id3[3] = {j, k, m};
    int s = sn_sign2(i, p01, q01, id2); /* sign of all three weights */
    return s * sn_sign3(i, p, q, t, id3) < 0;
}

/* The edge (k, k+1) on which the line of ties of i and j ends on the side where m is below or above; of its
 * two ends. */
static int line_ends(const face_work *w, int32_t i, int32_t j, int end[2])
{
    int s[3], n = 0;
    for (int k = 0; k < 3; k++) s[k] = sn_sign_above(w->row[k][i], i, w->row[k][j], j);
    for (int k = 0; k < 3; k++)
        if (s[k] != s[(k + 1) % 3]) end[n++] = k;
    return n;
}

/* Along the tie of i and j to its end on edge `end`: the tissue met first, or -1. */
static int32_t first_met(const face_work *w, int32_t i, int32_t j, int end)
{
    int32_t best = -1;
    for (size_t c = 0; c < w->candidate.n; c++) {
        int32_t m = w->candidate.id[c];
        if (m == i || m == j || !above_on_edge(w, end, (end + 1) % 3, i, j, m)) continue;
        if (best < 0 || above_inside(w, i, j, best, m)) best = m;
    }
    return best;
}

static bool add_triple(face_work *w, int32_t i, int32_t j, int32_t m, bool *is_new)
{
    int32_t t[3] = {i, j, m};
    sn_sort3(t);
    *is_new = true;
    for (size_t k = 0; k < w->n && *is_new; k++) *is_new = face_less(w->triple[k], t) != 0;
    if (!*is_new) return true;
    if (!sn_grow(&w->triple, &w->cap, w->n + 1, sizeof *w->triple)) return false;
    memcpy(w->triple[w->n++], t, sizeof t);
    return true;
}

/* From a triple point along its three lines, each to where its third tissue falls below. */
static bool follow_lines(face_work *w, size_t at)
{
    for (int out = 0; out < 3; out++) {
        int32_t m = w->triple[at][out], i = w->triple[at][(out + 1) % 3], j = w->triple[at][(out + 2) % 3];
        int end[2], n = line_ends(w, i, j, end);
        for (int e = 0; e < n; e++) {
            if (above_on_edge(w, end[e], (end[e] + 1) % 3, i, j, m)) continue;
            bool is_new;
            int32_t met = first_met(w, i, j, end[e]);
            if (met >= 0 && !add_triple(w, i, j, met, &is_new)) return false;
        }
    }
    return true;
}

/* The triple points of one face: from every point on its border along the tie into the face, then on from
 * what is met. The border between cells is connected to the border of the face, so this finds them all. */
static bool trace_face(face_work *w, const xt_cuts *c)
{
    w->n = 0;
    for (int k = 0; k < 3; k++) w->row[k] = xt_row(w->g, w->corner[k]);
    if (!xt_candidates(w->g, w->corner, 3, &w->candidate)) return false;
    for (int k = 0; k < 3; k++) {
        int32_t e = xt_find_edge(c, w->corner[k], w->corner[(k + 1) % 3]);
        for (int32_t i = e < 0 ? 0 : c->edge_first[e]; e >= 0 && i < c->edge_first[e + 1]; i++) {
            int32_t a = c->edge_tie[i][0], b = c->edge_tie[i][1];
            int end[2], n = line_ends(w, a, b, end);
            for (int x = 0; x < n; x++) {
                bool is_new;
                int32_t met = end[x] == k ? -1 : first_met(w, a, b, end[x]);
                if (met >= 0 && !add_triple(w, a, b, met, &is_new)) return false;
            }
        }
    }
    for (size_t at = 0; at < w->n; at++)
        if (!follow_lines(w, at)) return false;
    sn_sort(w->triple, w->n, sizeof *w->triple, face_less);
    return true;
}

static sn_status cut_faces(xt_cuts *c, const xt_grid *g, const sn_run *run, sn_error *err)
{
    face_work w = {.g = g};
    size_t n = 0, cap = 0;
    int32_t kept = 0;
    sn_status st = SN_OK;
    c->face_first = SN_NEW(int32_t, (size_t)c->n_face + 1);
    if (!c->face_first) st = no_memory(err);
    for (int32_t f = 0; !st && f < c->n_face; f++) {
        if (f % 4096 == 0) st = sn_run_step(run, "cutting faces", (double)f / c->n_face, err);
        memcpy(w.corner, c->face[f], sizeof w.corner);
        if (!st && (!trace_face(&w, c) || !sn_grow(&c->face_tie, &cap, n + w.n, sizeof *c->face_tie)))
            st = no_memory(err);
        if (st || w.n == 0) continue; /* three tissues on the border but no point inside */
        memmove(c->face[kept], w.corner, sizeof w.corner);
        c->face_first[kept++] = (int32_t)n;
        memcpy(c->face_tie + n, w.triple, w.n * sizeof *w.triple);
        n += w.n;
        if (n > INT32_MAX / 2) st = sn_fail(err, SN_ELIMIT, "extract: too many points on faces");
    }
    if (!st) {
        c->n_face = kept;
        c->face_first[kept] = (int32_t)n;
        c->n_face_point = (int32_t)n;
    }
    sn_release(w.candidate.id);
    sn_release(w.triple);
    return st;
}

int32_t xt_find_face(const xt_cuts *c, int32_t u, int32_t v, int32_t w)
{
    int32_t key[3] = {u, v, w}, lo = 0, hi = c->n_face;
    sn_sort3(key);
    while (lo < hi) {
        int32_t mid = lo + (hi - lo) / 2;
        if (face_less(c->face[mid], key) < 0)
            lo = mid + 1;
        else
            hi = mid;
    }
    return lo < c->n_face && face_less(c->face[lo], key) == 0 ? lo : -1;
}

sn_status xt_cuts_build(xt_cuts *c, const sn_tet_mesh *m, const xt_grid *g, const sn_run *run, sn_error *err)
{
    memset(c, 0, sizeof *c);
    sn_status st = collect_edges(c, m, g, err);
    if (!st) st = sn_run_step(run, "cutting edges", -1.0, err);
    if (!st) st = cut_edges(c, g, err);
    if (!st) st = sn_run_step(run, "cutting edges", -1.0, err);
    if (!st) st = collect_faces(c, m, g, err);
    if (!st) st = cut_faces(c, g, run, err);
    if (st) xt_cuts_free(c);
    return st;
}
