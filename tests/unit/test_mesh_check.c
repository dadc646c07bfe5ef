/* test_mesh_check - topology and self-intersections of small surfaces whose faults are known. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/alloc.h"
#include "mesh/mesh_check.h"
#include "mesh/predicates.h"

#include <stdlib.h>
#include <string.h>

static void make(sn_tri_mesh *m, const double *pos, int32_t n_vert, const int32_t *face, int32_t n_face)
{
    sn_tri_mesh_init(m);
    assert_int_equal(sn_tri_mesh_reserve(m, n_vert, n_face, NULL), SN_OK);
    if (n_vert > 0) memcpy(m->pos, pos, 3 * (size_t)n_vert * sizeof *pos);
    if (n_face > 0) memcpy(m->face, face, 3 * (size_t)n_face * sizeof *face);
}

static const double cube_pos[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1};
static const int32_t cube_face[] = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                    1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};

/* Two cubes; the second one moved and scaled. */
static void make_cubes(sn_tri_mesh *m, sn_vec3 move, double scale)
{
    sn_tri_mesh_init(m);
    assert_int_equal(sn_tri_mesh_reserve(m, 16, 24, NULL), SN_OK);
    memcpy(m->pos, cube_pos, sizeof cube_pos);
    memcpy(m->face, cube_face, sizeof cube_face);
    for (size_t k = 0; k < 8; k++)
        sn_v3_store(m->pos + 24 + 3 * k, sn_v3_mad(move, scale, sn_v3_load(cube_pos + 3 * k)));
    for (size_t k = 0; k < 36; k++) m->face[36 + k] = cube_face[k] + 8;
}

static sn_mesh_check checked(const sn_tri_mesh *m)
{
    sn_mesh_check c;
    assert_int_equal(sn_mesh_check_run(&c, m, NULL, NULL), SN_OK);
    return c;
}

static sn_mesh_check check_and_free(sn_tri_mesh *m)
{
    sn_mesh_check c = checked(m);
    sn_tri_mesh_free(m);
    return c;
}

static sn_mesh_check check_arrays(const double *pos, int32_t n_vert, const int32_t *face, int32_t n_face)
{
    sn_tri_mesh m;
    make(&m, pos, n_vert, face, n_face);
    return check_and_free(&m);
}

static void assert_clean(const sn_mesh_check *c)
{
    assert_true(c->closed && c->manifold && c->oriented);
    assert_int_equal(c->boundary_edges + c->nonmanifold_edges + c->nonmanifold_vertices, 0);
    assert_int_equal(c->degenerate_faces + c->duplicate_vertices + c->duplicate_faces + c->unused_vertices,
                     0);
    assert_int_equal(c->self_intersections, 0);
    assert_int_equal(c->first_pair[0], -1);
    assert_int_equal(c->first_pair[1], -1);
}

static void cube_is_clean(void **state)
{
    (void)state;
    sn_mesh_check c = check_arrays(cube_pos, 8, cube_face, 12);
    assert_clean(&c);
    assert_int_equal(c.components, 1);
}

static void nested_cubes_are_clean(void **state)
{
    (void)state;
    sn_tri_mesh m;
    make_cubes(&m, sn_v3(0.25, 0.25, 0.25), 0.5);
    sn_mesh_check c = check_and_free(&m);
    assert_clean(&c);
    assert_int_equal(c.components, 2);
}

static void empty_surface_is_not_closed(void **state)
{
    (void)state;
    sn_mesh_check c = check_arrays(cube_pos, 8, cube_face, 0);
    assert_false(c.closed);
    assert_true(c.manifold && c.oriented);
    assert_int_equal(c.components, 0);
    assert_int_equal(c.unused_vertices, 8);
    assert_int_equal(c.first_pair[0], -1);
}

static void open_cube_has_a_boundary(void **state)
{
    (void)state;
    sn_mesh_check c = check_arrays(cube_pos, 8, cube_face, 10); /* without the side x = 0 */
    assert_false(c.closed);
    assert_true(c.manifold && c.oriented);
    assert_int_equal(c.boundary_edges, 4);
    c = check_arrays(cube_pos, 8, cube_face, 1);
    assert_int_equal(c.boundary_edges, 3);
    assert_int_equal(c.unused_vertices, 5);
}

static void flipped_face_is_not_oriented(void **state)
{
    (void)state;
    int32_t face[36];
    memcpy(face, cube_face, sizeof face);
    face[1] = 1;
    face[2] = 2;
    sn_mesh_check c = check_arrays(cube_pos, 8, face, 12);
    assert_true(c.manifold && !c.oriented && !c.closed);
    assert_int_equal(c.boundary_edges, 0);
    assert_int_equal(c.self_intersections, 0);
}

static void duplicate_face_is_counted(void **state)
{
    (void)state;
    int32_t face[42];
    memcpy(face, cube_face, sizeof cube_face);
    const int32_t extra[] = {2, 1, 0, 0, 1, 2}; /* face 0 turned round its corners, and flipped */
    memcpy(face + 36, extra, sizeof extra);
    sn_mesh_check c = check_arrays(cube_pos, 8, face, 14);
    assert_int_equal(c.duplicate_faces, 2);
    assert_int_equal(c.nonmanifold_edges, 3);
    assert_int_equal(c.nonmanifold_vertices, 3);
    assert_true(c.closed); /* the two extra faces balance */
    assert_false(c.manifold);
    assert_int_equal(c.self_intersections, 3);
    assert_int_equal(c.first_pair[0], 0);
    assert_int_equal(c.first_pair[1], 12);
}

static const double tets_pos[] = {0,  0, 0, 1, 0,  0, 0, 1, 0,  0,  0,  1,
                                  -1, 0, 0, 0, -1, 0, 0, 0, -1, -1, -1, 0};
#define TET(a, b, c, d) a, c, b, a, b, d, b, c, d, c, a, d

static void tets_that_share_a_vertex(void **state)
{
    (void)state;
    const int32_t face[] = {TET(0, 1, 2, 3), TET(0, 5, 4, 6)};
    sn_mesh_check c = check_arrays(tets_pos, 7, face, 8);
    assert_true(c.closed && c.oriented && !c.manifold);
    assert_int_equal(c.nonmanifold_vertices, 1);
    assert_int_equal(c.nonmanifold_edges, 0);
    assert_int_equal(c.components, 2);
    assert_int_equal(c.self_intersections, 0);
}

static void tets_that_share_an_edge(void **state)
{
    (void)state;
    const int32_t face[] = {TET(0, 1, 2, 3), TET(0, 4, 5, 3)};
    sn_mesh_check c = check_arrays(tets_pos, 6, face, 8);
    assert_true(c.closed && c.oriented && !c.manifold);
    assert_int_equal(c.nonmanifold_edges, 1);
    assert_int_equal(c.nonmanifold_vertices, 2);
    assert_int_equal(c.components, 1);
    assert_int_equal(c.self_intersections, 0);
}

static void cubes_that_touch_cross(void **state)
{
    (void)state;
    sn_tri_mesh m;
    make_cubes(&m, sn_v3(1, 1, 1), 1.0); /* corner at corner, not joined */
    sn_mesh_check c = check_and_free(&m);
    assert_true(c.closed && c.manifold);
    assert_int_equal(c.duplicate_vertices, 1);
    assert_true(c.self_intersections > 0);
    make_cubes(&m, sn_v3(0.25, 0.25, 1), 0.5); /* standing on the top side */
    c = check_and_free(&m);
    assert_int_equal(c.duplicate_vertices, 0);
    assert_true(c.self_intersections > 0);
    make_cubes(&m, sn_v3(0.25, 0.25, 1.0 + 0x1p-52), 0.5); /* one step above */
    c = check_and_free(&m);
    assert_clean(&c);
}

static void touching_tip_crosses_what_it_touches(void **state)
{
    (void)state;
    /* A triangle whose corner touches another from above: inside, on an edge (a T-junction), just off. */
    const double pos[] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 1, 0, 1, 1, 1, 2, 1, 1};
    const int32_t face[] = {0, 1, 2, 3, 4, 5};
    double p[18];
    memcpy(p, pos, sizeof p);
    assert_int_equal(check_arrays(p, 6, face, 2).self_intersections, 1);
    p[9] = p[10] = 2;
    assert_int_equal(check_arrays(p, 6, face, 2).self_intersections, 1);
    p[11] = 1e-300;
    assert_int_equal(check_arrays(p, 6, face, 2).self_intersections, 0);
}

static void t_junction_in_one_plane_crosses(void **state)
{
    (void)state;
    const double pos[] = {0, 0, 0, 2, 0, 0, 1, 1, 0, 1, 0, 0, 1, -1, 0}; /* 3 lies on the edge 01 */
    const int32_t face[] = {0, 1, 2, 0, 4, 3, 3, 4, 1};
    sn_mesh_check c = check_arrays(pos, 5, face, 3);
    assert_int_equal(c.self_intersections, 2); /* each small face runs along 01, sharing one corner */
    assert_int_equal(c.first_pair[0], 0);
    assert_int_equal(c.first_pair[1], 1);
    assert_int_equal(c.components, 2);
}

static void fold_at_an_edge_crosses(void **state)
{
    (void)state;
    const double pos[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
    const int32_t face[] = {0, 1, 2, 1, 0, 3}; /* both above the edge 01 */
    sn_mesh_check c = check_arrays(pos, 4, face, 2);
    assert_int_equal(c.self_intersections, 1);
    double up[12];
    memcpy(up, pos, sizeof up);
    up[11] = 1e-9;
    assert_int_equal(check_arrays(up, 4, face, 2).self_intersections, 0);
}

static void moebius_strip_is_not_oriented(void **state)
{
    (void)state;
    enum { N = 12 };
    double pos[6 * N];
    int32_t face[6 * N];
    for (int k = 0; k < N; k++) { /* a band along a circle that turns by half a turn */
        double a = 2 * 3.14159265358979323846 * k / N, c = 0.3 * cos(a / 2), s = 0.3 * sin(a / 2);
        sn_v3_store(pos + 6 * k, sn_v3((1 + c) * cos(a), (1 + c) * sin(a), s));
        sn_v3_store(pos + 6 * k + 3, sn_v3((1 - c) * cos(a), (1 - c) * sin(a), -s));
        int32_t v = 2 * k, w = 2 * k + 1, x = v + 2, y = w + 2;
        if (k == N - 1) x = 1, y = 0;
        const int32_t two[] = {v, x, w, w, x, y};
        memcpy(face + 6 * k, two, sizeof two);
    }
    sn_mesh_check c = check_arrays(pos, 2 * N, face, 2 * N);
    assert_true(c.manifold && !c.oriented && !c.closed);
    assert_int_equal(c.boundary_edges, 2 * N);
    assert_int_equal(c.components, 1);
    assert_int_equal(c.self_intersections, 0);
}

static void degenerate_faces_are_counted(void **state)
{
    (void)state;
    /* 0 and 3 name a vertex twice or thrice, 1 lies on a line by doubled tenths, 2 has an area of 1e-320. */
    const double pos[] = {0.1, 0.2, 0.3, 0.2, 0.4, 0.6, 0.4, 0.8, 1.2, 0, 0, 0, 1e-160, 0, 0, 0, 1e-160, 0};
    const int32_t face[] = {0, 0, 1, 0, 1, 2, 3, 4, 5, 3, 3, 3};
    sn_mesh_check c = check_arrays(pos, 6, face, 4);
    assert_int_equal(c.degenerate_faces, 3);
    assert_int_equal(c.boundary_edges, 6); /* faces that repeat a vertex have no say in edges */
    assert_int_equal(c.components, 3);     /* but hang together with the faces at them        */
    assert_int_equal(c.nonmanifold_edges, 0);
}

static void collapsed_face_between_two_faces(void **state)
{
    (void)state;
    int32_t face[39];
    memcpy(face, cube_face, sizeof cube_face);
    face[36] = face[37] = 0, face[38] = 1;
    sn_mesh_check c = check_arrays(cube_pos, 8, face, 13);
    assert_true(c.closed && c.manifold && c.oriented);
    assert_int_equal(c.degenerate_faces, 1);
    assert_int_equal(c.components, 1);
}

static void repeated_vertices_are_counted(void **state)
{
    (void)state;
    const double pos[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, -0.0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 1e-300};
    const int32_t face[] = {0, 1, 2};
    sn_mesh_check c = check_arrays(pos, 7, face, 1);
    assert_int_equal(c.duplicate_vertices, 3);
    assert_int_equal(c.unused_vertices, 4);
}

static void three_sheets_at_an_edge(void **state)
{
    (void)state;
    const double pos[] = {0, 0, 0, 0, 0, 1, 1, 0, 0, -1, 1, 0, -1, -1, 0};
    const int32_t face[] = {0, 1, 2, 0, 1, 3, 1, 0, 4};
    sn_mesh_check c = check_arrays(pos, 5, face, 3);
    assert_int_equal(c.nonmanifold_edges, 1);
    assert_int_equal(c.boundary_edges, 6);
    assert_int_equal(c.nonmanifold_vertices, 2);
    assert_true(!c.closed && !c.manifold);
    assert_int_equal(c.self_intersections, 0);
}

static void components_are_numbered_by_lowest_face(void **state)
{
    (void)state;
    /* strips a: faces 0 3 5, b: 1 4, c: 2; b and c share a vertex only */
    const int32_t face[] = {0, 1, 2, 10, 11, 12, 12, 13, 14, 2, 1, 3, 10, 12, 15, 3, 1, 4};
    double pos[48];
    for (int k = 0; k < 48; k++) pos[k] = k * k % 17;
    sn_tri_mesh m;
    make(&m, pos, 16, face, 6);
    int32_t comp[6], n;
    assert_int_equal(sn_mesh_components(&m, comp, &n, NULL), SN_OK);
    const int32_t want[] = {0, 1, 2, 0, 1, 0};
    assert_int_equal(n, 3);
    assert_memory_equal(comp, want, sizeof want);
    sn_tri_mesh_free(&m);
}

/* ---- self-intersections against all pairs ---- */

static uint64_t rng(uint64_t *s) /* splitmix64 */
{
    uint64_t z = (*s += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* Small faces over few grid points: many touch, fold and lie in one plane. */
static void make_soup(sn_tri_mesh *m, int32_t n_face)
{
    uint64_t seed = 11;
    sn_tri_mesh_init(m);
    assert_int_equal(sn_tri_mesh_reserve(m, 12 * 12 * 12, n_face, NULL), SN_OK);
    for (int32_t i = 0; i < m->n_vert; i++)
        sn_v3_store(m->pos + 3 * i, sn_v3(i % 12, i / 12 % 12, floor(i / 144.0)));
    for (int32_t f = 0; f < n_face; f++) {
        int32_t at = (int32_t)(rng(&seed) % (uint64_t)(m->n_vert - 314));
        for (int k = 0; k < 3; k++)
            m->face[3 * f + k] = at + (int32_t)(rng(&seed) % 3) + 12 * (int32_t)(rng(&seed) % 3) +
                                 144 * (int32_t)(rng(&seed) % 3);
    }
}

static void soup_agrees_with_all_pairs(void **state)
{
    (void)state;
    sn_tri_mesh m;
    make_soup(&m, 1500);
    int32_t *pairs, *again;
    size_t n, n_again, k = 0;
    sn_run one = {.n_threads = 1}, three = {.n_threads = 3};
    assert_int_equal(sn_mesh_self_intersections(&m, &one, &pairs, &n, NULL), SN_OK);
    assert_int_equal(sn_mesh_self_intersections(&m, &three, &again, &n_again, NULL), SN_OK);
    assert_int_equal(n, n_again);
    assert_memory_equal(pairs, again, 2 * n * sizeof *pairs);
    for (int32_t f = 0; f < m.n_face; f++)
        for (int32_t g = f + 1; g < m.n_face; g++) {
            sn_vec3 p[3], q[3];
            for (int l = 0; l < 3; l++) {
                p[l] = sn_tri_mesh_point(&m, m.face[3 * f + l]);
                q[l] = sn_tri_mesh_point(&m, m.face[3 * g + l]);
            }
            if (!sn_triangles_cross(p, m.face + 3 * f, q, m.face + 3 * g)) continue;
            assert_true(k < n);
            assert_int_equal(pairs[2 * k], f);
            assert_int_equal(pairs[2 * k + 1], g);
            k++;
        }
    assert_int_equal(k, n);
    assert_true(n > 1000);
    sn_mesh_check c = checked(&m);
    assert_int_equal(c.self_intersections, n);
    assert_int_equal(c.first_pair[0], pairs[0]);
    assert_int_equal(c.first_pair[1], pairs[1]);
    sn_release(pairs);
    sn_release(again);
    sn_tri_mesh_free(&m);
}

static void interruption_is_reported(void **state)
{
    (void)state;
    sn_tri_mesh m;
    make(&m, cube_pos, 8, cube_face, 12);
    volatile sig_atomic_t cancel = 1;
    sn_run stopped = {.cancel = &cancel}, late = {.deadline = 1e-9};
    sn_error err;
    sn_mesh_check c;
    int32_t *pairs;
    size_t n;
    assert_int_equal(sn_mesh_check_run(&c, &m, &stopped, &err), SN_ECANCEL);
    assert_string_equal(err.msg, "interrupted while looking for self-intersections");
    assert_int_equal(sn_mesh_self_intersections(&m, &late, &pairs, &n, &err), SN_ELIMIT);
    assert_string_equal(err.msg, "time limit reached while looking for self-intersections");
    assert_null(pairs);
    assert_int_equal(n, 0);
    sn_tri_mesh_free(&m);
}

typedef struct failing {
    int left;
    int live;
} failing;

static void *failing_realloc(void *user, void *p, size_t bytes)
{
    failing *f = user;
    if (bytes == 0) {
        f->live -= p != NULL;
        free(p);
        return NULL;
    }
    if (f->left-- <= 0) return NULL;
    f->live += p == NULL;
    return realloc(p, bytes);
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    failing f = {1000, 0};
    sn_allocator a = {failing_realloc, &f};
    sn_set_allocator(&a);
    sn_tri_mesh m;
    make_cubes(&m, sn_v3(0.5, 0.5, 0.5), 1.0);
    int base = f.live;
    sn_run one = {.n_threads = 1};
    sn_status st = SN_ENOMEM;
    for (int allowed = 0; st != SN_OK; allowed++) {
        sn_mesh_check c;
        sn_error err;
        int32_t *pairs = NULL;
        size_t n = 0;
        f.left = allowed;
        st = sn_mesh_check_run(&c, &m, &one, &err);
        if (!st) st = sn_mesh_self_intersections(&m, &one, &pairs, &n, &err);
        if (st) assert_int_equal(err.code, SN_ENOMEM);
        if (st) assert_null(pairs);
        assert_true(allowed < 60);
        sn_release(pairs);
        assert_int_equal(f.live, base);
    }
    sn_tri_mesh_free(&m);
    sn_set_allocator(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cube_is_clean),
        cmocka_unit_test(nested_cubes_are_clean),
        cmocka_unit_test(empty_surface_is_not_closed),
        cmocka_unit_test(open_cube_has_a_boundary),
        cmocka_unit_test(flipped_face_is_not_oriented),
        cmocka_unit_test(duplicate_face_is_counted),
        cmocka_unit_test(tets_that_share_a_vertex),
        cmocka_unit_test(tets_that_share_an_edge),
        cmocka_unit_test(cubes_that_touch_cross),
        cmocka_unit_test(touching_tip_crosses_what_it_touches),
        cmocka_unit_test(t_junction_in_one_plane_crosses),
        cmocka_unit_test(fold_at_an_edge_crosses),
        cmocka_unit_test(moebius_strip_is_not_oriented),
        cmocka_unit_test(degenerate_faces_are_counted),
        cmocka_unit_test(collapsed_face_between_two_faces),
        cmocka_unit_test(repeated_vertices_are_counted),
        cmocka_unit_test(three_sheets_at_an_edge),
        cmocka_unit_test(components_are_numbered_by_lowest_face),
        cmocka_unit_test(soup_agrees_with_all_pairs),
        cmocka_unit_test(interruption_is_reported),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
