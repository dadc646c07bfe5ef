/* closed_surface.h - slow, plain checks of a surface, for tests of what makes surfaces. */
#ifndef SN_TESTS_CLOSED_SURFACE_H
#define SN_TESTS_CLOSED_SURFACE_H

#include "mesh/predicates.h"
#include "mesh/tri_mesh.h"

#include <stdlib.h> /* cmocka.h comes before this file */

static inline int half_edge_less(const void *a, const void *b)
{
    const int32_t *p = a, *q = b;
    if (p[0] != q[0]) return p[0] < q[0] ? -1 : 1;
    return (p[1] > q[1]) - (p[1] < q[1]);
}

static inline int32_t root_of(int32_t *parent, int32_t i)
{
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* Every half-edge once and its opposite once; every vertex used, its faces one ring. */
static inline void assert_closed_manifold(const sn_tri_mesh *m)
{
    size_t n = 3 * (size_t)m->n_face;
    int32_t *half = malloc(3 * n * sizeof *half), *corner = malloc(n * sizeof *corner);
    for (size_t i = 0; i < n; i++) {
        half[3 * i] = m->face[i];
        half[3 * i + 1] = m->face[i % 3 == 2 ? i - 2 : i + 1];
        half[3 * i + 2] = (int32_t)i;
        corner[i] = (int32_t)i;
        assert_true(m->face[i] >= 0 && m->face[i] < m->n_vert);
    }
    qsort(half, n, 3 * sizeof *half, half_edge_less);
    int32_t n_joined = 0;
    for (size_t i = 0; i < n; i++) {
        assert_true(half[3 * i] != half[3 * i + 1]);
        if (i > 0) assert_true(half_edge_less(half + 3 * i - 3, half + 3 * i) < 0);
        int32_t back[2] = {half[3 * i + 1], half[3 * i]};
        const int32_t *o = bsearch(back, half, n, 3 * sizeof *half, half_edge_less);
        assert_non_null(o);
        int32_t mine = half[3 * i + 2],
                next = o[2] % 3 == 2 ? o[2] - 2 : o[2] + 1; /* corners at one vertex */
        int32_t a = root_of(corner, mine), b = root_of(corner, next);
        if (a != b) n_joined++;
        corner[a] = b;
    }
    assert_int_equal((int32_t)n - n_joined, m->n_vert); /* fans = vertices, and none unused (each has >= 1) */
    for (size_t i = 0; i < n; i++) half[i] = 0;
    for (size_t i = 0; i < n; i++) half[m->face[i]] = 1;
    for (int32_t i = 0; i < m->n_vert; i++) assert_int_equal(half[i], 1);
    free(half);
    free(corner);
}

static inline int count_parts(const sn_tri_mesh *m)
{
    int32_t *parent = malloc((size_t)(m->n_vert + 1) * sizeof *parent);
    int parts = m->n_vert;
    for (int32_t i = 0; i < m->n_vert; i++) parent[i] = i;
    for (size_t i = 0; i < 3 * (size_t)m->n_face; i++) {
        int32_t a = root_of(parent, m->face[i]), b = root_of(parent, m->face[i % 3 == 2 ? i - 2 : i + 1]);
        if (a == b) continue;
        parent[a] = b;
        parts--;
    }
    free(parent);
    return parts;
}

static inline int euler_characteristic(const sn_tri_mesh *m) /* of a closed surface: 3 n_face = 2 n_edge */
{
    return m->n_vert - m->n_face / 2;
}

typedef struct boxed_face {
    sn_vec3 p[3];
    const int32_t *i;
    sn_box3 box;
    int32_t face;
} boxed_face;

static inline int boxed_face_less(const void *a, const void *b)
{
    const boxed_face *p = a, *q = b;
    if (p->box.min.x != q->box.min.x) return p->box.min.x < q->box.min.x ? -1 : 1;
    return (p->face > q->face) - (p->face < q->face);
}

/* Pairs of faces that cross, exact: all pairs whose boxes meet. */
static inline int count_crossings(const sn_tri_mesh *m)
{
    boxed_face *list = malloc((size_t)(m->n_face + 1) * sizeof *list);
    int n = 0;
    for (int32_t f = 0; f < m->n_face; f++) {
        boxed_face *t = &list[f];
        t->i = m->face + 3 * (size_t)f;
        t->face = f;
        t->box = sn_box3_empty();
        for (int k = 0; k < 3; k++) t->box = sn_box3_add(t->box, t->p[k] = sn_tri_mesh_point(m, t->i[k]));
    }
    qsort(list, (size_t)m->n_face, sizeof *list, boxed_face_less);
    for (const boxed_face *s = list; s < list + m->n_face; s++)
        for (const boxed_face *t = s + 1; t < list + m->n_face && t->box.min.x <= s->box.max.x; t++)
            if (t->box.min.y <= s->box.max.y && t->box.max.y >= s->box.min.y &&
                t->box.min.z <= s->box.max.z && t->box.max.z >= s->box.min.z)
                n += sn_triangles_cross(s->p, s->i, t->p, t->i);
    free(list);
    return n;
}

#endif
