/* test_tet_mesh - tet meshes as plain arrays: checks, volumes, neighbours, boundary surfaces. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "mesh/tet_mesh.h"

#include "closed_surface.h"
#include "made_mesh.h"

static void faces_of_a_tet_turn_outwards(void **state)
{
    (void)state;
    sn_tet_mesh m = made_unit_tet();
    assert_true(sn_tet_mesh_tet_volume(&m, 0) == 1.0 / 6.0);
    for (int k = 0; k < 4; k++) {
        const int *f = sn_tet_face[k];
        sn_vec3 a = sn_tet_mesh_point(&m, f[0]);
        sn_vec3 n =
            sn_v3_cross(sn_v3_sub(sn_tet_mesh_point(&m, f[1]), a), sn_v3_sub(sn_tet_mesh_point(&m, f[2]), a));
        assert_true(sn_v3_dot(n, sn_v3_sub(sn_tet_mesh_point(&m, k), a)) <
                    0.0); /* corner k lies behind face k */
        assert_int_equal((1 << k) + (1 << f[0]) + (1 << f[1]) + (1 << f[2]), 15);
    }
    int pairs = 0;
    for (int e = 0; e < 6; e++) {
        assert_true(sn_tet_edge[e][0] < sn_tet_edge[e][1]);
        pairs |= 1 << (4 * sn_tet_edge[e][0] + sn_tet_edge[e][1]);
    }
    assert_int_equal(pairs, 1 << 1 | 1 << 2 | 1 << 3 | 1 << 6 | 1 << 7 | 1 << 11);
    sn_tet_mesh_free(&m);
}

static void lattice_fills_its_cube(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(5, sn_v3(-1, 2, 3), 0.5);
    assert_int_equal(sn_tet_mesh_validate(&m, NULL), SN_OK);
    assert_true(fabs(sn_tet_mesh_volume(&m) - 2.5 * 2.5 * 2.5) < 1e-12);
    for (int32_t t = 0; t < m.n_tet; t++)
        assert_true(fabs(sn_tet_mesh_tet_volume(&m, t) - 0.125 / 6.0) < 1e-15);
    sn_box3 b = sn_tet_mesh_bounds(&m);
    assert_true(b.min.x == -1 && b.min.y == 2 && b.min.z == 3 && b.max.x == 1.5 && b.max.y == 4.5 &&
                b.max.z == 5.5);
    sn_tet_mesh_free(&m);
}

static void assert_invalid(const sn_tet_mesh *m, const char *want)
{
    sn_error err;
    assert_int_equal(sn_tet_mesh_validate(m, &err), SN_EINVAL);
    assert_string_equal(err.msg, want);
}

static void validation_names_the_first_breach(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(1, sn_v3(0, 0, 0), 1.0), empty;
    sn_tet_mesh_init(&empty);
    assert_invalid(&empty, "tet mesh has no tets");
    m.tet[23] = m.tet[22];
    assert_invalid(&m, "tet 6 has volume 0, need > 0");
    int32_t swap = m.tet[8];
    m.tet[8] = m.tet[9];
    m.tet[9] = swap;
    assert_invalid(&m, "tet 3 has volume -0.166667, need > 0");
    m.tet[7] = 8;
    assert_invalid(&m, "tet 2 names vertex 9, need 1..8");
    m.tet[3] = -2;
    assert_invalid(&m, "tet 1 names vertex -1, need 1..8");
    m.pos[4] = NAN;
    assert_invalid(&m, "vertex 2 has a coordinate that is not finite");
    sn_tet_mesh_free(&m);
    sn_tet_mesh_free(&m);
}

static void copies_are_deep(void **state)
{
    (void)state;
    sn_tet_mesh m = made_unit_tet(), c;
    sn_tet_mesh_init(&c);
    assert_int_equal(sn_tet_mesh_copy(&c, &m, NULL), SN_OK);
    assert_null(c.part);
    m.part = SN_NEW(int32_t, 1);
    m.part[0] = 4;
    assert_int_equal(sn_tet_mesh_copy(&c, &m, NULL), SN_OK);
    m.part[0] = 5;
    m.pos[3] = 9;
    m.tet[0] = 3;
    assert_int_equal(c.part[0], 4);
    assert_int_equal(c.tet[0], 0);
    assert_true(c.pos[3] == 1.0);
    sn_tet_mesh_free(&m);
    sn_tet_mesh_free(&c);
}

/* ---- neighbours ---- */

static bool has_corner(const sn_tet_mesh *m, int32_t t, int32_t v)
{
    const int32_t *c = m->tet + 4 * (size_t)t;
    return c[0] == v || c[1] == v || c[2] == v || c[3] == v;
}

/* The other tet with all three corners of face k of t, by looking at all. */
static int32_t slow_neighbour(const sn_tet_mesh *m, int32_t t, int k)
{
    for (int32_t u = 0; u < m->n_tet; u++) {
        bool all = u != t;
        for (int c = 0; c < 3 && all; c++) all = has_corner(m, u, m->tet[4 * t + sn_tet_face[k][c]]);
        if (all) return u;
    }
    return -1;
}

static void neighbours_as_by_brute_force(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(4, sn_v3(0, 0, 0), 1.0);
    int32_t *adj = NULL, n_boundary = 0;
    assert_int_equal(sn_tet_mesh_adjacency(&m, &adj, NULL), SN_OK);
    for (int32_t t = 0; t < m.n_tet; t++)
        for (int k = 0; k < 4; k++) {
            assert_int_equal(adj[4 * t + k], slow_neighbour(&m, t, k));
            n_boundary += adj[4 * t + k] < 0;
        }
    assert_int_equal(n_boundary, 6 * 16 * 2); /* two triangles per square of the cube's skin */
    sn_release(adj);
    sn_tet_mesh_free(&m);
}

static void three_tets_on_a_face(void **state)
{
    (void)state;
    sn_tet_mesh m = made_unit_tet(), three;
    sn_tet_mesh_init(&three);
    assert_int_equal(sn_tet_mesh_reserve(&three, 6, 3, false, NULL), SN_OK);
    memcpy(three.pos, m.pos, 12 * sizeof *m.pos);
    sn_v3_store(three.pos + 12, sn_v3(0, 0, -1));
    sn_v3_store(three.pos + 15, sn_v3(0, 0, 2));
    const int32_t tet[] = {0, 1, 2, 3, 0, 2, 1, 4, 0, 1, 2, 5};
    memcpy(three.tet, tet, sizeof tet);
    int32_t *adj = three.tet;
    sn_error err;
    assert_int_equal(sn_tet_mesh_validate(&three, NULL), SN_OK);
    assert_int_equal(sn_tet_mesh_adjacency(&three, &adj, &err), SN_EINVAL);
    assert_string_equal(err.msg, "tet mesh: face (1, 2, 3) belongs to more than two tets");
    assert_null(adj);
    sn_tri_mesh s;
    int32_t *map = three.tet;
    sn_tri_mesh_init(&s);
    assert_int_equal(sn_tet_mesh_surface(&three, -1, &s, &map, &err), SN_EINVAL);
    assert_null(map);
    assert_null(s.pos);
    sn_tet_mesh_free(&m);
    sn_tet_mesh_free(&three);
}

/* ---- surfaces ---- */

static void surface_of_the_whole(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(4, sn_v3(1, 2, 3), 0.25);
    sn_tri_mesh s;
    int32_t *map;
    sn_tri_mesh_init(&s);
    assert_int_equal(sn_tet_mesh_surface(&m, -1, &s, &map, NULL), SN_OK);
    assert_closed_manifold(&s);
    assert_int_equal(euler_characteristic(&s), 2);
    assert_int_equal(s.n_vert, 125 - 27);
    assert_true(fabs(sn_tri_mesh_volume(&s) - 1.0) < 1e-12); /* positive: outside out */
    assert_true(fabs(sn_tri_mesh_area(&s) - 6.0) < 1e-12);
    for (int32_t v = 0; v < s.n_vert; v++) {
        assert_true(sn_v3_dist(sn_tri_mesh_point(&s, v), sn_tet_mesh_point(&m, map[v])) == 0.0);
        if (v > 0) assert_true(map[v - 1] < map[v]);
    }
    sn_release(map);
    sn_tri_mesh_free(&s);
    assert_int_equal(sn_tet_mesh_surface(&m, 0, &s, NULL, NULL), SN_OK); /* no parts: no part 0 either */
    assert_int_equal(s.n_face, 0);
    sn_tri_mesh_free(&s);
    sn_tet_mesh_free(&m);
}

static void surfaces_of_parts_meet(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(4, sn_v3(0, 0, 0), 0.25);
    sn_tri_mesh s;
    double volume = 0.0, area = 0.0;
    sn_tri_mesh_init(&s);
    m.part = SN_NEW(int32_t, m.n_tet);
    for (int32_t t = 0; t < m.n_tet; t++) m.part[t] = t / 6 / 16 < 2 ? 1 : 5; /* split at x = 0.5 */
    for (int part = 0; part < 6; part++) {
        assert_int_equal(sn_tet_mesh_surface(&m, part, &s, NULL, NULL), SN_OK);
        if (part != 1 && part != 5) assert_int_equal(s.n_face, 0);
        if (part != 1 && part != 5) continue;
        assert_closed_manifold(&s);
        volume += sn_tri_mesh_volume(&s);
        area += sn_tri_mesh_area(&s);
        assert_true(fabs(sn_tri_mesh_volume(&s) - 0.5) < 1e-12);
    }
    assert_true(fabs(volume - 1.0) < 1e-12);
    assert_true(fabs(area - 8.0) < 1e-12); /* the cube's six, and the cut from both sides */
    sn_tri_mesh_free(&s);
    sn_tet_mesh_free(&m);
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(2, sn_v3(0, 0, 0), 1.0);
    sn_status st = SN_ENOMEM;
    for (int n = 0; st; n++) {
        ration r = {n, 0};
        sn_error err;
        sn_tet_mesh copy;
        sn_tri_mesh s;
        int32_t *map = NULL;
        sn_tet_mesh_init(&copy);
        sn_tri_mesh_init(&s);
        sn_set_allocator(RATION(r));
        st = sn_tet_mesh_copy(&copy, &m, &err);
        if (st) assert_true(!copy.pos && copy.n_vert == 0);
        if (!st) st = sn_tet_mesh_surface(&copy, -1, &s, &map, &err);
        if (st) assert_int_equal(err.code, SN_ENOMEM);
        if (st) assert_non_null(strstr(err.msg, "no memory"));
        if (st) assert_null(map);
        sn_release(map);
        sn_tri_mesh_free(&s);
        sn_tet_mesh_free(&copy);
        assert_int_equal(r.in_use, 0);
        assert_true(n < 20);
    }
    sn_set_allocator(NULL);
    sn_tet_mesh_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(faces_of_a_tet_turn_outwards),
        cmocka_unit_test(lattice_fills_its_cube),
        cmocka_unit_test(validation_names_the_first_breach),
        cmocka_unit_test(copies_are_deep),
        cmocka_unit_test(neighbours_as_by_brute_force),
        cmocka_unit_test(three_tets_on_a_face),
        cmocka_unit_test(surface_of_the_whole),
        cmocka_unit_test(surfaces_of_parts_meet),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
