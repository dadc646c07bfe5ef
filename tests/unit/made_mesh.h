/* made_mesh.h - small meshes that tests make by hand, and an allocator that runs dry. */
#ifndef SN_TESTS_MADE_MESH_H
#define SN_TESTS_MADE_MESH_H

#include "base/alloc.h"
#include "mesh/tet_mesh.h"
#include "mesh/tri_mesh.h"

#include <stdlib.h> /* cmocka.h comes before this file */
#include <string.h>

#define TEST_PI 3.14159265358979323846

/* ---- surfaces ---- */

/* Twelve faces, outside out. */
static inline sn_tri_mesh made_box(sn_vec3 min, sn_vec3 max)
{
    static const int32_t face[] = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                   1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};
    const double x[2] = {min.x, max.x}, y[2] = {min.y, max.y}, z[2] = {min.z, max.z};
    sn_tri_mesh m;
    sn_tri_mesh_init(&m);
    assert_int_equal(sn_tri_mesh_reserve(&m, 8, 12, NULL), SN_OK);
    for (int v = 0; v < 8; v++)
        sn_v3_store(m.pos + 3 * v, sn_v3(x[(v & 3) == 1 || (v & 3) == 2], y[(v & 3) > 1], z[v > 3]));
    memcpy(m.face, face, sizeof face);
    return m;
}

/* n_ring rings of n_around vertices between two poles, joined by triangles; the caller places the vertices:
 * the first pole, the rings, the last pole. Outside out when the rings turn counter-clockwise about the way
 * to the last pole. */
static inline sn_tri_mesh made_rings(int n_ring, int n_around)
{
    sn_tri_mesh m;
    sn_tri_mesh_init(&m);
    assert_int_equal(sn_tri_mesh_reserve(&m, n_ring * n_around + 2, 2 * n_ring * n_around, NULL), SN_OK);
    int32_t *f = m.face, last = m.n_vert - 1;
    for (int r = 0; r <= n_ring; r++)
        for (int k = 0; k < n_around; k++) {
            int next = (k + 1) % n_around, below = 1 + (r - 1) * n_around, above = 1 + r * n_around;
            int32_t a = r > 0 ? below + k : 0, b = r > 0 ? below + next : 0;
            int32_t c = r < n_ring ? above + next : last, d = r < n_ring ? above + k : last;
            if (r > 0) *f++ = a, *f++ = b, *f++ = c;
            if (r < n_ring) *f++ = a, *f++ = c, *f++ = d;
        }
    return m;
}

/* A capsule of radius r from a to b; a = b gives a ball. Its edges are about `cell` long. */
static inline sn_tri_mesh made_capsule(sn_vec3 a, sn_vec3 b, double r, double cell)
{
    int n_around = (int)ceil(2.0 * TEST_PI * r / cell), n_cap = (int)ceil(0.5 * TEST_PI * r / cell);
    int n_side = (int)ceil(sn_v3_dist(a, b) / cell), n_ring = 2 * n_cap - 1 + n_side;
    sn_vec3 w = sn_v3_dist(a, b) > 0.0 ? sn_v3_unit(sn_v3_sub(b, a)) : sn_v3(0, 0, 1);
    sn_vec3 u = sn_v3_unit(sn_v3_cross(fabs(w.x) < 0.7 ? sn_v3(1, 0, 0) : sn_v3(0, 1, 0), w)),
            v = sn_v3_cross(w, u);
    sn_tri_mesh m = made_rings(n_ring, n_around);
    sn_v3_store(m.pos, sn_v3_mad(a, -r, w));
    sn_v3_store(m.pos + 3 * (m.n_vert - 1), sn_v3_mad(b, r, w));
    for (int i = 0; i < n_ring; i++) {
        int up = i + 1 < n_cap ? i + 1 - n_cap : i + 1 > n_cap + n_side ? i + 1 - n_cap - n_side : 0;
        double s = n_side > 0 ? fmin(1.0, fmax(0.0, (double)(i + 1 - n_cap) / n_side)) : 0.0;
        double height = r * sin(0.5 * TEST_PI * up / n_cap), wide = r * cos(0.5 * TEST_PI * up / n_cap);
        sn_vec3 c = sn_v3_mad(sn_v3_lerp(a, b, s), height, w);
        for (int k = 0; k < n_around; k++) {
            double t = 2.0 * TEST_PI * (k + 0.5 * (i & 1)) / n_around;
            sn_vec3 p = sn_v3_mad(sn_v3_mad(c, wide * cos(t), u), wide * sin(t), v);
            sn_v3_store(m.pos + 3 * (1 + i * n_around + k), p);
        }
    }
    return m;
}

static inline sn_tri_mesh made_sphere(sn_vec3 center, double radius, double cell)
{
    return made_capsule(center, center, radius, cell);
}

/* Appends b's faces to a; labels, where a has any, are made `label` for them. Frees b. */
static inline void append_mesh(sn_tri_mesh *a, sn_tri_mesh *b, int32_t label)
{
    sn_tri_mesh m;
    sn_tri_mesh_init(&m);
    assert_int_equal(sn_tri_mesh_reserve(&m, a->n_vert + b->n_vert, a->n_face + b->n_face, NULL), SN_OK);
    memcpy(m.pos, a->pos, 3 * (size_t)a->n_vert * sizeof *m.pos);
    memcpy(m.pos + 3 * (size_t)a->n_vert, b->pos, 3 * (size_t)b->n_vert * sizeof *m.pos);
    memcpy(m.face, a->face, 3 * (size_t)a->n_face * sizeof *m.face);
    for (size_t k = 0; k < 3 * (size_t)b->n_face; k++)
        m.face[3 * (size_t)a->n_face + k] = b->face[k] + a->n_vert;
    if (a->label) {
        m.label = SN_NEW(int32_t, m.n_face);
        assert_non_null(m.label);
        for (int32_t f = 0; f < m.n_face; f++) m.label[f] = f < a->n_face ? a->label[f] : label;
    }
    sn_tri_mesh_free(a);
    sn_tri_mesh_free(b);
    *a = m;
}

static inline void turn_faces(sn_tri_mesh *m)
{
    for (int32_t f = 0; f < m->n_face; f++) {
        int32_t *v = m->face + 3 * (size_t)f, swap = v[0];
        v[0] = v[1];
        v[1] = swap;
    }
}

static inline void scale_mesh(sn_tri_mesh *m, double factor)
{
    for (size_t k = 0; k < 3 * (size_t)m->n_vert; k++) m->pos[k] *= factor;
}

/* ---- tets ---- */

/* The Kuhn lattice: n x n x n cubes of side `cell` from the corner `min`, six tets around each cube's
 * diagonal; 6 n^3 tets. Vertex (i, j, k) has number (i (n + 1) + j) (n + 1) + k. */
static inline sn_tet_mesh made_lattice(int n, sn_vec3 min, double cell)
{
    static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    static const bool even[6] = {true, false, false, true, true, false};
    int s = n + 1;
    sn_tet_mesh m;
    sn_tet_mesh_init(&m);
    assert_int_equal(sn_tet_mesh_reserve(&m, s * s * s, 6 * n * n * n, false, NULL), SN_OK);
    for (int v = 0; v < m.n_vert; v++)
        sn_v3_store(m.pos + 3 * v,
                    sn_v3(min.x + cell * (v / (s * s)), min.y + cell * (v / s % s), min.z + cell * (v % s)));
    const int step[3] = {s * s, s, 1};
    int32_t *t = m.tet;
    for (int cube = 0; cube < n * n * n; cube++) {
        int32_t corner = (cube / (n * n)) * step[0] + (cube / n % n) * step[1] + cube % n;
        for (int p = 0; p < 6; p++, t += 4) {
            int32_t a = corner + step[order[p][0]], b = a + step[order[p][1]];
            t[0] = corner;
            t[1] = even[p] ? a : b;
            t[2] = even[p] ? b : a;
            t[3] = corner + step[0] + step[1] + step[2];
        }
    }
    return m;
}

/* Moves every vertex of a lattice by up to `by` in each coordinate, the same way every time. */
static inline void shake_mesh(sn_tet_mesh *m, double by)
{
    uint64_t h = 88172645463325252u;
    for (size_t k = 0; k < 3 * (size_t)m->n_vert; k++) {
        h ^= h << 13, h ^= h >> 7, h ^= h << 17;
        m->pos[k] += by * ((double)(h >> 11) * 0x1p-52 - 1.0);
    }
}

/* ---- random numbers, the same every time ---- */

static inline double made_random(uint64_t *h) /* in [0, 1); *h not 0 */
{
    *h ^= *h << 13, *h ^= *h >> 7, *h ^= *h << 17;
    return (double)(*h >> 11) * 0x1p-53;
}

/* ---- an allocator that gives `left` blocks and no more ---- */

typedef struct ration {
    int left;
    int in_use;
} ration;

static inline void *rationed_realloc(void *user, void *p, size_t bytes)
{
    ration *r = user;
    if (bytes == 0) {
        r->in_use -= p != NULL;
        free(p);
        return NULL;
    }
    if (r->left == 0) return NULL;
    r->left--;
    r->in_use += p == NULL;
    return realloc(p, bytes);
}

#define RATION(r) (&(sn_allocator){rationed_realloc, &(r)})

/* (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1): volume 1/6. */
static inline sn_tet_mesh made_unit_tet(void)
{
    static const double pos[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const int32_t tet[] = {0, 1, 2, 3};
    sn_tet_mesh m;
    sn_tet_mesh_init(&m);
    assert_int_equal(sn_tet_mesh_reserve(&m, 4, 1, false, NULL), SN_OK);
    memcpy(m.pos, pos, sizeof pos);
    memcpy(m.tet, tet, sizeof tet);
    return m;
}

#endif
