/* test_locate - which tet holds a point, against looking at every tet. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tetra/locate.h"

#include "made_mesh.h"

static sn_locator *locator_of(const sn_tet_mesh *m)
{
    sn_locator *l = NULL;
    assert_int_equal(sn_locator_create(&l, m, NULL), SN_OK);
    assert_non_null(l);
    return l;
}

/* Smallest height of p over the four faces, over the tet's size; from signed volumes. */
static double depth(const sn_tet_mesh *m, int32_t t, sn_vec3 p)
{
    double least = INFINITY, whole = 6.0 * sn_tet_mesh_tet_volume(m, t);
    for (int k = 0; k < 4; k++) {
        sn_vec3 c[3];
        for (int i = 0; i < 3; i++)
            c[i] = sn_v3_sub(sn_tet_mesh_point(m, m->tet[4 * t + sn_tet_face[k][i]]), p);
        least = fmin(least, sn_v3_det(c[0], c[1], c[2]) / whole);
    }
    return least;
}

static int32_t slow_find(const sn_tet_mesh *m, sn_vec3 p)
{
    for (int32_t t = 0; t < m->n_tet; t++)
        if (depth(m, t, p) >= -1e-11) return t;
    return -1;
}

static void assert_weights(const sn_tet_mesh *m, int32_t t, sn_vec3 p, const double bary[4])
{
    sn_vec3 q = {0, 0, 0};
    for (int k = 0; k < 4; k++) {
        assert_true(bary[k] >= -1e-10);
        q = sn_v3_mad(q, bary[k], sn_tet_mesh_point(m, m->tet[4 * t + k]));
    }
    assert_true(fabs(bary[0] + bary[1] + bary[2] + bary[3] - 1.0) < 1e-14);
    assert_true(sn_v3_dist(p, q) < 1e-12 * sn_box3_diagonal(sn_tet_mesh_bounds(m)));
}

static void random_points(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(6, sn_v3(-3, -3, -3), 1.0);
    shake_mesh(&m, 0.12);
    assert_int_equal(sn_tet_mesh_validate(&m, NULL), SN_OK);
    sn_locator *l = locator_of(&m);
    uint64_t h = 1;
    int n_in = 0;
    for (int i = 0; i < 3000; i++) {
        sn_vec3 p = {7.0 * made_random(&h) - 3.5, 7.0 * made_random(&h) - 3.5, 7.0 * made_random(&h) - 3.5};
        double bary[4] = {9, 9, 9, 9};
        int32_t t = sn_locator_find(l, p, bary);
        assert_int_equal(t, slow_find(&m, p));
        assert_int_equal(sn_locator_find(l, p, NULL), t);
        if (t >= 0) assert_weights(&m, t, p, bary);
        if (t < 0) assert_true(bary[0] == 9.0 && bary[3] == 9.0);
        n_in += t >= 0;
    }
    assert_true(n_in > 1500 && n_in < 2500); /* 216 of 343 */
    sn_locator_destroy(l);
    sn_tet_mesh_free(&m);
}

/* Vertices, edge middles and face centres belong to the lowest tet that has them, at any scale. */
static void shared_points_go_to_the_lowest_tet(void **state)
{
    (void)state;
    const double cells[] = {1.0, 1e-7, 1e7, 0.1};
    for (int i = 0; i < 4; i++) {
        sn_tet_mesh m = made_lattice(4, sn_v3(-2 * cells[i], -2 * cells[i], -2 * cells[i]), cells[i]);
        sn_locator *l = locator_of(&m);
        for (int32_t v = 0; v < m.n_vert; v++) {
            double bary[4];
            sn_vec3 p = sn_tet_mesh_point(&m, v);
            int32_t t = sn_locator_find(l, p, bary);
            assert_int_equal(t, slow_find(&m, p));
            assert_weights(&m, t, p, bary);
        }
        for (int32_t t = 0; t < m.n_tet; t += 7) {
            for (int e = 0; e < 6; e++) {
                sn_vec3 a = sn_tet_mesh_point(&m, m.tet[4 * t + sn_tet_edge[e][0]]);
                sn_vec3 p = sn_v3_lerp(a, sn_tet_mesh_point(&m, m.tet[4 * t + sn_tet_edge[e][1]]), 0.5);
                assert_int_equal(sn_locator_find(l, p, NULL), slow_find(&m, p));
            }
            for (int k = 0; k < 4; k++) {
                sn_vec3 p = {0, 0, 0};
                for (int c = 0; c < 3; c++)
                    p = sn_v3_mad(p, 1.0 / 3.0, sn_tet_mesh_point(&m, m.tet[4 * t + sn_tet_face[k][c]]));
                int32_t found = sn_locator_find(l, p, NULL);
                if (found < 0) assert_true(depth(&m, t, p) < 1e-12); /* on the hull, rounded outwards */
                if (found >= 0) assert_int_equal(found, slow_find(&m, p));
            }
        }
        sn_locator_destroy(l);
        sn_tet_mesh_free(&m);
    }
}

static void outside_is_nowhere(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(1, sn_v3(0, 0, 0), 1.0);
    sn_locator *l = locator_of(&m);
    const sn_vec3 out[] = {{-1e-9, 0.5, 0.5}, {1.0 + 1e-9, 0.5, 0.5}, {2, 2, 2},
                           {NAN, 0.5, 0.5},   {INFINITY, 0, 0},       {0.5, 0.5, -INFINITY}};
    for (int i = 0; i < 6; i++) assert_int_equal(sn_locator_find(l, out[i], NULL), -1);
    sn_locator_destroy(l);
    sn_locator_destroy(NULL);
    m.n_tet = 1; /* a single tet is a leaf */
    l = locator_of(&m);
    assert_int_equal(sn_locator_find(l, sn_v3(0.75, 0.5, 0.25), NULL), 0); /* x > y > z */
    assert_int_equal(sn_locator_find(l, sn_v3(0.25, 0.5, 0.75), NULL), -1);
    sn_locator_destroy(l);
    sn_tet_mesh_free(&m);
}

static void weights_of_any_point(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(1, sn_v3(0, 0, 0), 2.0); /* tet 0: (0,0,0) (2,0,0) (2,2,0) (2,2,2) */
    double bary[4];
    sn_tet_barycentric(&m, 0, sn_v3(3, -1, 1), bary); /* 1 - x/2, (x - y)/2, (y - z)/2, z/2 */
    assert_true(bary[0] == -0.5 && bary[1] == 2.0 && bary[2] == -1.0 && bary[3] == 0.5);
    sn_tet_mesh_free(&m);
}

/* All centres equal: no split by position helps. */
static void equal_tets(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(1, sn_v3(0, 0, 0), 1.0), many;
    sn_tet_mesh_init(&many);
    assert_int_equal(sn_tet_mesh_reserve(&many, 8, 5000, false, NULL), SN_OK);
    memcpy(many.pos, m.pos, 24 * sizeof *m.pos);
    for (int t = 0; t < 5000; t++) memcpy(many.tet + 4 * t, m.tet, 4 * sizeof *m.tet);
    sn_locator *l = locator_of(&many);
    assert_int_equal(sn_locator_find(l, sn_v3(0.75, 0.5, 0.25), NULL), 0);
    sn_locator_destroy(l);
    sn_tet_mesh_free(&m);
    sn_tet_mesh_free(&many);
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(2, sn_v3(0, 0, 0), 1.0);
    sn_status st = SN_ENOMEM;
    for (int n = 0; st; n++) {
        ration r = {n, 0};
        sn_locator *l = NULL;
        sn_error err;
        sn_set_allocator(RATION(r));
        st = sn_locator_create(&l, &m, &err);
        if (st) assert_int_equal(st, SN_ENOMEM);
        if (st) assert_string_equal(err.msg, "locator: no memory for 48 tets");
        if (st) assert_null(l);
        sn_locator_destroy(l);
        assert_int_equal(r.in_use, 0);
        assert_true(n < 10);
    }
    sn_set_allocator(NULL);
    sn_tet_mesh_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_points),      cmocka_unit_test(shared_points_go_to_the_lowest_tet),
        cmocka_unit_test(outside_is_nowhere), cmocka_unit_test(weights_of_any_point),
        cmocka_unit_test(equal_tets),         cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
