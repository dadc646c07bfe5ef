/* test_tendon - lengths of tendon: as set, and where a cross-section that is known reaches an area. */
#include "field/tendon.h"

#include "failing_memory.h"
#include "made_fibers.h"

static const double along_z[] = {0, 0, 0, 0, 0, 2};

static sn_vec3 in_cylinder(double x, double y, double s)
{
    return sn_v3(0.3 * x, 0.3 * y, 2.0 * s);
}

static double cone_radius(double z)
{
    return 0.1 + 0.15 * z;
}

static sn_vec3 in_cone(double x, double y, double s)
{
    return sn_v3(cone_radius(2.0 * s) * x, cone_radius(2.0 * s) * y, 2.0 * s);
}

static double spindle_radius(double z) /* 0.1 at the ends, 0.3 at z = 0.8 */
{
    return z < 0.8 ? 0.1 + 0.2 * z / 0.8 : 0.3 - 0.2 * (z - 0.8) / 1.2;
}

static sn_vec3 in_spindle(double x, double y, double s)
{
    double r = spindle_radius(2.0 * s);
    return sn_v3(r * x, r * y, 2.0 * s);
}

static const tube fine = {4, 24, 50, in_cylinder};

static void set_tendon(sn_muscle *m, double length, double area)
{
    sn_error err = {.msg = ""};
    if (sn_muscle_set_tendon(m, &(sn_tendon){length, area}, &err)) fail_msg("%s", err.msg);
}

static sn_paths paths_of(const sn_muscle *m)
{
    sn_paths p = {0};
    assert_int_equal(sn_paths_build(&p, m, NULL), SN_OK);
    return p;
}

/* The tendon lengths of a muscle that fills the mesh; heads are one after the other, origin first. */
static void find_lengths(const sn_tet_mesh *body, const sn_muscle *m, double *length)
{
    double *share = full_shares(body);
    sn_paths p = paths_of(m);
    sn_tendons t = {0};
    sn_error err = {.msg = ""};
    if (sn_tendons_find(&t, body, share, m, &p, &err)) fail_msg("%s", err.msg);
    assert_int_equal(t.n_head, m->n_head);
    memcpy(length, t.length, 2 * (size_t)m->n_head * sizeof *length);
    sn_tendons_free(&t);
    assert_null(t.length);
    sn_paths_free(&p);
    sn_release(share);
}

static void find_tube_lengths(const tube *form, double set_length, double set_area, double length[2])
{
    sn_tet_mesh body = made_tube(form);
    sn_muscle m = curve_muscle(along_z, 2);
    set_tendon(&m, set_length, set_area);
    assert_true(sn_muscle_has_tendon(&m) == (set_length > 0.0 || set_area > 0.0));
    find_lengths(&body, &m, length);
    sn_muscle_free(&m);
    sn_tet_mesh_free(&body);
}

static void assert_near(double got, double want, double tolerance)
{
    if (!(fabs(got - want) <= tolerance)) fail_msg("%g where %g was wanted", got, want);
}

/* ---- lengths ---- */

static void lengths_as_set(void **state)
{
    (void)state;
    double l[2];
    find_tube_lengths(&fine, 0.0, 0.0, l);
    assert_true(l[0] == 0.0 && l[1] == 0.0);
    find_tube_lengths(&fine, 0.35, 0.0, l);
    assert_true(l[0] == 0.35 && l[1] == 0.35);
    find_tube_lengths(&fine, 5.0, 0.0, l); /* no more than there is */
    assert_near(l[0], 2.0, 1e-12);
    assert_near(l[1], 2.0, 1e-12);
}

/* Radius 0.1 at the origin, 0.4 at the insertion: pi r^2 reaches pi 0.25^2 at z = 1. */
static void areas_of_a_cone(void **state)
{
    (void)state;
    const tube cone = {4, 24, 50, in_cone};
    double l[2], unit = disc_area(&cone);
    static const double at[] = {0.5, 1.0, 1.5};
    for (int i = 0; i < 3; i++) {
        find_tube_lengths(&cone, 0.0, unit * cone_radius(at[i]) * cone_radius(at[i]), l);
        assert_near(l[0], at[i], 0.03 * at[i]);
        assert_near(l[1], 0.0, 1e-12); /* thick enough there from the start */
    }
    find_tube_lengths(&cone, 0.0, unit * 0.09 * 0.09, l); /* less than anywhere */
    assert_true(l[0] == 0.0 && l[1] == 0.0);
    find_tube_lengths(&cone, 0.0, unit * 0.45 * 0.45, l); /* more than anywhere: all is tendon */
    assert_near(l[0], 2.0, 1e-12);
    assert_near(l[1], 2.0, 1e-12);
    find_tube_lengths(&cone, 0.7, unit * 0.25 * 0.25, l); /* the longer of both */
    assert_near(l[0], 1.0, 0.03);
    assert_true(l[1] == 0.7);
}

/* From both ends of a spindle: r = 0.2 at z = 0.4 and at z = 1.4. */
static void areas_of_a_spindle(void **state)
{
    (void)state;
    const tube spindle = {4, 24, 50, in_spindle};
    double l[2];
    find_tube_lengths(&spindle, 0.0, disc_area(&spindle) * 0.04, l);
    assert_near(l[0], 0.4, 0.03 * 0.4);
    assert_near(l[1], 0.6, 0.03 * 0.6);
}

/* The muscle has half of each tet: half of the cross-section. */
static void shares_count(void **state)
{
    (void)state;
    const tube cone = {4, 24, 50, in_cone};
    sn_tet_mesh body = made_tube(&cone);
    sn_muscle m = curve_muscle(along_z, 2);
    sn_paths p = paths_of(&m);
    sn_tendons t = {0};
    double *share = full_shares(&body);
    for (int32_t i = 0; i < body.n_tet; i++) share[i] = 0.5;
    set_tendon(&m, 0.0, 0.5 * disc_area(&cone) * 0.0625);
    for (int again = 0; again < 2; again++) { /* what it held is released */
        assert_int_equal(sn_tendons_find(&t, &body, share, &m, &p, NULL), SN_OK);
        assert_near(t.length[0], 1.0, 0.03);
    }
    sn_tendons_free(&t);
    sn_tendons_free(&t);
    sn_release(share);
    sn_paths_free(&p);
    sn_muscle_free(&m);
    sn_tet_mesh_free(&body);
}

/* ---- heads ---- */

/* Two curves in a cone that meet at the insertion: at the end that they share both count together, at their
 * own ends each has half of the cross-section, which reaches pi 0.25^2 where the radius is 0.25 sqrt(2). */
static void heads_share_an_end(void **state)
{
    (void)state;
    static const double left[2][6] = {{-0.1, 0, 2, 0, 0, 0}, {-0.05, 0, 0, 0, 0, 2}};
    static const double right[2][6] = {{0.1, 0, 2, 0, 0, 0}, {0.05, 0, 0, 0, 0, 2}};
    const tube cone = {6, 24, 50, in_cone};
    sn_tet_mesh body = made_tube(&cone);
    for (int k = 0; k < 2; k++) { /* to the thin end, to the thick end */
        sn_muscle m = heads_muscle((const sn_head_points[]){{left[k], NULL, 2}, {right[k], NULL, 2}}, 2);
        double l[4], own = (0.25 * sqrt(2.0) - 0.1) / 0.15;
        assert_int_equal(sn_muscle_shared_end(&m), SN_SHARE_INSERTION);
        set_tendon(&m, 0.0, disc_area(&cone) * 0.0625);
        find_lengths(&body, &m, l);
        assert_near(l[0], k ? own : 0.0, 0.03 * own * k);
        assert_near(l[1], k ? 0.0 : 1.0, k ? 0.0 : 0.03);
        assert_near(l[2], l[0], 1e-3);
        assert_near(l[3], l[1], 1e-3);
        sn_muscle_free(&m);
    }
    sn_tet_mesh_free(&body);
}

/* ---- places ---- */

static void places(void **state)
{
    (void)state;
    sn_muscle m = curve_muscle(along_z, 2);
    sn_paths p = paths_of(&m);
    double length[2] = {0.3, 0.5};
    sn_tendons t = {length, 1};
    static const double want[][2] = {{-0.1, 0.4}, {0.0, 0.3},  {0.2, 0.1}, {0.4, -0.1},
                                     {1.4, -0.1}, {1.6, 0.1},  {2.0, 0.5}, {2.2, 0.7},
                                     {0.9, -0.6}, {1.1, -0.4}, {0.3, 0.0}}; /* z, by how much in tendon */
    for (size_t i = 0; i < sizeof want / sizeof *want; i++)
        assert_near(sn_tendons_at(&t, &p, sn_v3(0.05, -0.02, want[i][0])), want[i][1], 1e-9);
    length[0] = 0.0; /* none at the origin: beyond its end neither */
    assert_true(sn_tendons_at(&t, &p, sn_v3(0, 0, -0.1)) < 0.0);
    assert_true(sn_tendons_at(&t, &p, sn_v3(0, 0, 1.6)) > 0.0);
    length[1] = 0.0;
    for (double z = -0.5; z < 2.6; z += 0.1) assert_true(sn_tendons_at(&t, &p, sn_v3(0, 0, z)) < 0.0);
    sn_paths_free(&p);
    sn_muscle_free(&m);
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    sn_tet_mesh body = made_tube(&(tube){2, 6, 4, in_cylinder});
    double *share = full_shares(&body);
    sn_muscle m = curve_muscle(along_z, 2);
    sn_paths p = paths_of(&m);
    set_tendon(&m, 0.1, 0.1);
    int n = 0;
    for (;; n++) {
        failing mem = {.left = n};
        sn_tendons t = {0};
        sn_error err = {.msg = ""};
        sn_set_allocator(&(sn_allocator){failing_realloc, &mem});
        sn_status st = sn_tendons_find(&t, &body, share, &m, &p, &err);
        sn_tendons_free(&t);
        sn_set_allocator(NULL);
        assert_int_equal(mem.n_alive, 0);
        if (!st) break;
        assert_int_equal(st, SN_ENOMEM);
        assert_string_equal(err.msg, "tendon of muscle 'psoas': no memory");
    }
    assert_int_equal(n, 2);
    sn_release(share);
    sn_paths_free(&p);
    sn_muscle_free(&m);
    sn_tet_mesh_free(&body);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lengths_as_set),
        cmocka_unit_test(areas_of_a_cone),
        cmocka_unit_test(areas_of_a_spindle),
        cmocka_unit_test(shares_count),
        cmocka_unit_test(heads_share_an_end),
        cmocka_unit_test(places),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
