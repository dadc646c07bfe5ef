#include "mesh/remesh_private.h"

#include "base/alloc.h"

#include <string.h>

void rm_mesh_free(rm_mesh *m)
{
    sn_release(m->pos);
    sn_release(m->out);
    sn_release(m->vert);
    sn_release(m->twin);
    sn_release(m->crease);
    sn_release(m->label);
    memset(m, 0, sizeof *m);
}

static bool reserve(rm_mesh *m, size_t n_vert, size_t n_tri)
{
    return sn_grow(&m->pos, &m->cap_vert, n_vert, sizeof *m->pos) &&
           sn_grow(&m->out, &m->cap_out, n_vert, sizeof *m->out) &&
           sn_grow(&m->vert, &m->cap_vertid, 3 * n_tri, sizeof *m->vert) &&
           sn_grow(&m->twin, &m->cap_twin, 3 * n_tri, sizeof *m->twin) &&
           sn_grow(&m->crease, &m->cap_crease, 3 * n_tri, sizeof *m->crease) &&
           sn_grow(&m->label, &m->cap_label, n_tri, sizeof *m->label);
}

bool rm_mesh_room(rm_mesh *m)
{
    return m->n_tri + 2 < INT32_MAX / 3 && reserve(m, m->n_vert + 1, m->n_tri + 2);
}

/* Pairs half-edges by a list per first vertex. */
static sn_status pair_half_edges(rm_mesh *m, int32_t *list, sn_error *err)
{
    int32_t n_half = (int32_t)(3 * m->n_tri);
    for (size_t v = 0; v < m->n_vert; v++) m->out[v] = -1;
    for (int32_t h = 0; h < n_half; h++) { /* out[] heads the list for now */
        list[h] = m->out[m->vert[h]];
        m->out[m->vert[h]] = h;
        m->twin[h] = -1;
    }
    for (int32_t h = 0; h < n_half; h++) {
        int32_t a = m->vert[h], b = m->vert[rm_next(h)], found = -1;
        for (int32_t g = m->out[b]; g >= 0; g = list[g])
            if (m->vert[rm_next(g)] == a) {
                if (found >= 0 || m->twin[g] >= 0) found = -2;
                if (found == -1) found = g;
            }
        if (found < 0 || a == b)
            return sn_fail(err, SN_EMESH, "remesh: edge (%d, %d) is not between two faces that turn alike",
                           a + 1, b + 1);
        if (found > h) continue; /* set from the other side */
        m->twin[h] = found;
        m->twin[found] = h;
    }
    return SN_OK;
}

/* The faces around a vertex are one ring: its half-edges that one spin meets are all that leave it. */
static sn_status check_rings(const rm_mesh *m, int32_t *n_left, sn_error *err)
{
    for (size_t v = 0; v < m->n_vert; v++) n_left[v] = 0;
    for (size_t h = 0; h < 3 * m->n_tri; h++) n_left[m->vert[h]]++;
    for (int32_t v = 0; v < (int32_t)m->n_vert; v++) {
        int32_t start = m->out[v], h = start;
        if (start < 0) continue;
        do {
            n_left[v]--;
            h = rm_spin(m, h);
        } while (h != start);
        if (n_left[v] != 0)
            return sn_fail(err, SN_EMESH,
                           "remesh: parts of the surface touch in vertex %d alone; need a manifold", v + 1);
    }
    return SN_OK;
}

static sn_vec3 normal_of(const rm_mesh *m, int32_t t)
{
    const int32_t *v = m->vert + 3 * (size_t)t;
    sn_vec3 a = m->pos[v[0]];
    return sn_v3_unit(sn_v3_cross(sn_v3_sub(m->pos[v[1]], a), sn_v3_sub(m->pos[v[2]], a)));
}

/* The least height of a triangle. The normal of a low one is noise: that of a sliver on a round surface may
 * point anywhere. */
static double height_of(const rm_mesh *m, int32_t t)
{
    const int32_t *v = m->vert + 3 * (size_t)t;
    sn_vec3 a = m->pos[v[0]], b = m->pos[v[1]], c = m->pos[v[2]];
    double longest = fmax(sn_v3_dist(a, b), fmax(sn_v3_dist(b, c), sn_v3_dist(c, a)));
    return longest > 0.0 ? sn_v3_len(sn_v3_cross(sn_v3_sub(b, a), sn_v3_sub(c, a))) / longest : 0.0;
}

static bool is_sharp(const rm_mesh *m, int32_t t, int32_t u, double crease_cos, double min_height)
{
    return sn_v3_dot(normal_of(m, t), normal_of(m, u)) < crease_cos && height_of(m, t) > min_height &&
           height_of(m, u) > min_height;
}

sn_status rm_mesh_build(rm_mesh *m, const sn_tri_mesh *in, double crease_cos, double min_height,
                        sn_error *err)
{
    memset(m, 0, sizeof *m);
    int32_t *list = SN_NEW(int32_t, 3 * (size_t)in->n_face), *n_left = SN_NEW(int32_t, in->n_vert);
    sn_status st = SN_OK;
    if (!list || !n_left || !reserve(m, (size_t)in->n_vert, (size_t)in->n_face)) {
        st = sn_fail(err, SN_ENOMEM, "remesh: no memory for %d faces", in->n_face);
        goto done;
    }
    m->n_vert = (size_t)in->n_vert;
    m->n_tri = (size_t)in->n_face;
    for (size_t v = 0; v < m->n_vert; v++) m->pos[v] = sn_tri_mesh_point(in, (int32_t)v);
    memcpy(m->vert, in->face, 3 * m->n_tri * sizeof *m->vert);
    for (size_t t = 0; t < m->n_tri; t++) m->label[t] = in->label ? in->label[t] : 0;
    st = pair_half_edges(m, list, err);
    if (!st) st = check_rings(m, n_left, err);
    if (st) goto done;
    for (int32_t h = 0; h < (int32_t)(3 * m->n_tri); h++) {
        int32_t t = h / 3, u = m->twin[h] / 3;
        m->crease[h] = m->label[t] != m->label[u] || is_sharp(m, t, u, crease_cos, min_height);
    }
done:
    sn_release(list);
    sn_release(n_left);
    if (st) rm_mesh_free(m);
    return st;
}

sn_status rm_mesh_export(const rm_mesh *m, bool has_labels, sn_tri_mesh *out, sn_error *err)
{
    int32_t *number = SN_NEW(int32_t, m->n_vert);
    if (!number) return sn_fail(err, SN_ENOMEM, "remesh: no memory for the result");
    int32_t n_vert = 0, n_face = 0;
    for (size_t v = 0; v < m->n_vert; v++) number[v] = m->out[v] >= 0 ? n_vert++ : -1;
    for (size_t t = 0; t < m->n_tri; t++) n_face += rm_alive(m, (int32_t)t);
    sn_status st = sn_tri_mesh_reserve(out, n_vert, n_face, err);
    if (!st && has_labels && !(out->label = SN_NEW(int32_t, n_face)))
        st = sn_fail(err, SN_ENOMEM, "remesh: no memory for the result");
    if (st) {
        sn_release(number);
        sn_tri_mesh_free(out);
        return st;
    }
    for (size_t v = 0; v < m->n_vert; v++)
        if (number[v] >= 0) sn_v3_store(out->pos + 3 * (size_t)number[v], m->pos[v]);
    size_t n = 0;
    for (size_t t = 0; t < m->n_tri; t++) {
        if (!rm_alive(m, (int32_t)t)) continue;
        if (has_labels) out->label[n] = m->label[t];
        for (int k = 0; k < 3; k++) out->face[3 * n + (size_t)k] = number[m->vert[3 * t + (size_t)k]];
        n++;
    }
    sn_release(number);
    return SN_OK;
}

static void glue(rm_mesh *m, int32_t g, int32_t h)
{
    m->twin[g] = h;
    m->twin[h] = g;
}

static int32_t new_tri(rm_mesh *m, int32_t a, int32_t b, int32_t c, int32_t label)
{
    int32_t t = (int32_t)m->n_tri++, h = 3 * t;
    m->vert[h] = a;
    m->vert[h + 1] = b;
    m->vert[h + 2] = c;
    m->label[t] = label;
    return h;
}

/* Cuts the triangle of h, which runs from a to b with c opposite, into (a, mid, c) in place and (mid, b, c).
 * Returns the new triangle's half-edge mid -> b. */
static int32_t split_side(rm_mesh *m, int32_t h, int32_t mid)
{
    int32_t side = rm_next(h), b = m->vert[side], c = m->vert[rm_prev(h)], outer = m->twin[side];
    int32_t n = new_tri(m, mid, b, c, m->label[h / 3]);
    m->vert[side] = mid;
    m->crease[n] = m->crease[h];
    m->crease[n + 1] = m->crease[side];
    m->crease[n + 2] = m->crease[side] = false;
    glue(m, n + 1, outer);
    glue(m, n + 2, side);
    return n;
}

int32_t rm_split(rm_mesh *m, int32_t h, sn_vec3 p)
{
    int32_t g = m->twin[h], a = m->vert[h], b = m->vert[g], mid = (int32_t)m->n_vert++;
    m->pos[mid] = p;
    int32_t n = split_side(m, h, mid), k = split_side(m, g, mid);
    glue(m, h, k); /* a - mid */
    glue(m, g, n); /* b - mid */
    m->out[mid] = n;
    m->out[a] = h;
    m->out[b] = g;
    return mid;
}

bool rm_can_collapse(const rm_mesh *m, int32_t h)
{
    int32_t g = m->twin[h], a = m->vert[h], b = m->vert[g];
    int32_t c = m->vert[rm_prev(h)], d = m->vert[rm_prev(g)];
    if (c == d) return false;
    /* No common neighbour but c and d, and neither of them of valence three. */
    for (int32_t i = rm_spin(m, h); i != h; i = rm_spin(m, i)) {
        int32_t w = m->vert[rm_next(i)];
        if (w == c || w == d) continue;
        for (int32_t j = rm_spin(m, g); j != g; j = rm_spin(m, j))
            if (m->vert[rm_next(j)] == w) return false;
    }
    int32_t hc = rm_prev(h), hd = rm_prev(g); /* c -> a, d -> b */
    if (rm_spin(m, rm_spin(m, rm_spin(m, hc))) == hc || rm_spin(m, rm_spin(m, rm_spin(m, hd))) == hd)
        return false;
    (void)a;
    (void)b;
    return true;
}

/* Closes the gap that triangle h/3 leaves: the two sides other than h become one edge. */
static void zip(rm_mesh *m, int32_t h)
{
    int32_t x = m->twin[rm_next(h)], y = m->twin[rm_prev(h)];
    bool crease = m->crease[x] || m->crease[y];
    glue(m, x, y);
    m->crease[x] = m->crease[y] = crease;
    m->out[m->vert[x]] = x;
    m->out[m->vert[y]] = y;
}

void rm_collapse(rm_mesh *m, int32_t h)
{
    int32_t g = m->twin[h], a = m->vert[h], b = m->vert[g];
    int32_t i = h;
    do { /* the links are intact while the corners are renamed */
        int32_t next = rm_spin(m, i);
        m->vert[i] = b;
        i = next;
    } while (i != h);
    zip(m, h);
    zip(m, g);
    for (int k = 0; k < 3; k++) m->vert[h / 3 * 3 + k] = m->vert[g / 3 * 3 + k] = -1;
    m->out[a] = -1;
}

bool rm_can_flip(const rm_mesh *m, int32_t h)
{
    int32_t g = m->twin[h], c = m->vert[rm_prev(h)], d = m->vert[rm_prev(g)];
    if (c == d || m->crease[h]) return false;
    for (int32_t start = rm_prev(h), i = rm_spin(m, start); i != start; i = rm_spin(m, i))
        if (m->vert[rm_next(i)] == d) return false; /* the edge exists already */
    int32_t ha = h, hb = g;
    return rm_spin(m, rm_spin(m, rm_spin(m, ha))) != ha && rm_spin(m, rm_spin(m, rm_spin(m, hb))) != hb;
}

/* (a, b, c) and (b, a, d) become (c, d, b) and (d, c, a): h runs from c to d afterwards. */
void rm_flip(rm_mesh *m, int32_t h)
{
    int32_t g = m->twin[h], hn = rm_next(h), hp = rm_prev(h), gn = rm_next(g), gp = rm_prev(g);
    int32_t a = m->vert[h], b = m->vert[g], c = m->vert[hp], d = m->vert[gp];
    int32_t bc = m->twin[hn], ca = m->twin[hp], ad = m->twin[gn], db = m->twin[gp];
    bool f_bc = m->crease[hn], f_ca = m->crease[hp], f_ad = m->crease[gn], f_db = m->crease[gp];
    m->vert[h] = c, m->vert[hn] = d, m->vert[hp] = b;
    m->vert[g] = d, m->vert[gn] = c, m->vert[gp] = a;
    glue(m, hn, db), m->crease[hn] = f_db;
    glue(m, hp, bc), m->crease[hp] = f_bc;
    glue(m, gn, ca), m->crease[gn] = f_ca;
    glue(m, gp, ad), m->crease[gp] = f_ad;
    m->out[a] = gp, m->out[b] = hp, m->out[c] = h, m->out[d] = g;
}

int rm_crease_count(const rm_mesh *m, int32_t v)
{
    int n = 0;
    int32_t h = m->out[v], i = h;
    do {
        n += m->crease[i];
        i = rm_spin(m, i);
    } while (i != h);
    return n;
}
