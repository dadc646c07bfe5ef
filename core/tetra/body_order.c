#include "base/alloc.h"
#include "base/array.h"
#include "tetra/body_private.h"

#include <string.h>

enum { key_bits = 21 }; /* per coordinate */

typedef struct keyed {
    uint64_t key;
    int32_t vert;
} keyed;

static int before(const void *a, const void *b)
{
    const keyed *x = a, *y = b;
    return x->key < y->key || (x->key == y->key && x->vert < y->vert);
}

/* Bit i of x to bit 3 i. */
static uint64_t spread_bits(uint64_t x)
{
    uint64_t out = 0;
    for (int i = 0; i < key_bits; i++) out |= (x >> i & 1) << (3 * i);
    return out;
}

/* Where p lies on the curve through the box that visits near points together (Morton's). */
static uint64_t place_key(sn_vec3 p, sn_box3 box, double size)
{
    const double c[3] = {p.x - box.min.x, p.y - box.min.y, p.z - box.min.z};
    uint64_t key = 0;
    for (int k = 0; k < 3; k++) {
        double at = size > 0.0 ? c[k] / size * ((1 << key_bits) - 1) : 0.0;
        key |= spread_bits((uint64_t)at) << k;
    }
    return key;
}

/* rank[v]: the new number of v; pos moves along. */
static sn_status sort_vertices(sn_tet_mesh *m, int32_t *rank, sn_error *err)
{
    sn_box3 box = sn_tet_mesh_bounds(m);
    double size = sn_box3_diagonal(box);
    keyed *order = SN_NEW(keyed, m->n_vert);
    double *pos = SN_NEW(double, 3 * (size_t)m->n_vert);
    sn_status st =
        order && pos ? SN_OK : sn_fail(err, SN_ENOMEM, "body: no memory for %d vertices", m->n_vert);
    if (!st) {
        for (int32_t v = 0; v < m->n_vert; v++)
            order[v] = (keyed){place_key(sn_tet_mesh_point(m, v), box, size), v};
        sn_sort(order, (size_t)m->n_vert, sizeof *order, before);
        for (int32_t i = 0; i < m->n_vert; i++) {
            rank[order[i].vert] = i;
            memcpy(pos + 3 * (size_t)i, m->pos + 3 * (size_t)order[i].vert, 3 * sizeof *pos);
        }
        memcpy(m->pos, pos, 3 * (size_t)m->n_vert * sizeof *pos);
    }
    sn_release(order);
    sn_release(pos);
    return st;
}

static int32_t lowest_corner(const int32_t *t)
{
    int32_t low = t[0];
    for (int k = 1; k < 4; k++) low = t[k] < low ? t[k] : low;
    return low;
}

/* By lowest corner, else as they were. */
static sn_status sort_tets(sn_tet_mesh *m, sn_error *err)
{
    int32_t *first = SN_NEW_ZERO(int32_t, (size_t)m->n_vert + 1),
            *tet = SN_NEW(int32_t, 4 * (size_t)m->n_tet);
    sn_status st = first && tet ? SN_OK : sn_fail(err, SN_ENOMEM, "body: no memory for %d tets", m->n_tet);
    if (!st) {
        for (int32_t t = 0; t < m->n_tet; t++) first[lowest_corner(m->tet + 4 * (size_t)t) + 1]++;
        for (int32_t v = 0; v < m->n_vert; v++) first[v + 1] += first[v];
        for (int32_t t = 0; t < m->n_tet; t++) {
            const int32_t *v = m->tet + 4 * (size_t)t;
            memcpy(tet + 4 * (size_t)first[lowest_corner(v)]++, v, 4 * sizeof *tet);
        }
        memcpy(m->tet, tet, 4 * (size_t)m->n_tet * sizeof *tet);
    }
    sn_release(first);
    sn_release(tet);
    return st;
}

sn_status sn_body_sort(sn_tet_mesh *m, int32_t *face, int32_t n_face, sn_error *err)
{
    int32_t *rank = SN_NEW(int32_t, m->n_vert);
    sn_status st = rank ? SN_OK : sn_fail(err, SN_ENOMEM, "body: no memory for %d vertices", m->n_vert);
    if (!st) st = sort_vertices(m, rank, err);
    if (!st) {
        for (size_t k = 0; k < 4 * (size_t)m->n_tet; k++) m->tet[k] = rank[m->tet[k]];
        for (size_t k = 0; k < 3 * (size_t)n_face; k++) face[k] = rank[face[k]];
        st = sort_tets(m, err);
    }
    sn_release(rank);
    return st;
}
