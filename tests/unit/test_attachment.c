/* test_attachment - where muscles meet bones: a cube of tissue with bones as walls, areas by hand. */
#include "field/attachment.h"

#include "failing_memory.h"
#include "made_fibers.h"

enum { FLOOR, SIDE, LID }; /* bones: the faces z = 0, x = 0, z = 1 */

static bool is_on(const sn_tet_mesh *m, int32_t h, int axis, double at)
{
    for (int k = 0; k < 3; k++)
        if (m->pos[3 * m->tet[(h & ~3) + sn_tet_face[h & 3][k]] + axis] != at) return false;
    return true;
}

/* The unit cube, 8^3 boxes of tets; wall[i]: is this bone there? */
static sn_body cube_with_bones(const bool wall[3])
{
    sn_tet_mesh m = made_lattice(8, sn_v3(0, 0, 0), 0.125);
    sn_body b;
    sn_body_init(&b);
    assert_int_equal(sn_body_from_tets(&m, SN_LABEL_SKIN, &b, NULL), SN_OK);
    for (int32_t h = 0; h < 4 * m.n_tet; h++) {
        if (b.across[h] >= 0) continue;
        int bone = is_on(&m, h, 2, 0.0)   ? FLOOR
                   : is_on(&m, h, 2, 1.0) ? LID
                   : is_on(&m, h, 0, 0.0) ? SIDE
                                          : -1;
        if (bone >= 0 && wall[bone]) b.across[h] = -1 - SN_LABEL_BONE(bone);
    }
    b.n_bone = 3;
    sn_tet_mesh_free(&m);
    return b;
}

/* The muscle wins where f(p) < 0 for all of the n functions: its own is 0. They are linear, so that is exact.
 */
static void find(const sn_body *b, double (*const *f)(sn_vec3 p), int n, const sn_muscle *m,
                 sn_attachment *out)
{
    size_t n_vert = (size_t)b->mesh.n_vert;
    double *field = SN_NEW_ZERO(double, (size_t)(1 + n) * n_vert);
    sn_measure *measure = NULL;
    sn_paths paths = {0};
    sn_error err = {.msg = ""};
    for (int i = 0; i < n; i++)
        for (int32_t v = 0; v < b->mesh.n_vert; v++)
            field[(size_t)(1 + i) * n_vert + (size_t)v] = f[i](sn_tet_mesh_point(&b->mesh, v));
    assert_int_equal(sn_measure_create(&measure, &b->mesh, field, 1 + n, 0, NULL, NULL), SN_OK);
    assert_int_equal(sn_paths_build(&paths, m, NULL), SN_OK);
    if (sn_attachments_find(b, measure, m, &paths, out, &err)) fail_msg("%s", err.msg);
    sn_paths_free(&paths);
    sn_measure_destroy(measure);
    sn_release(field);
}

static void assert_near(double got, double want, double tolerance)
{
    if (!(fabs(got - want) <= tolerance)) fail_msg("%.12g where %.12g was wanted", got, want);
}

static void assert_at(sn_vec3 got, sn_vec3 want, double tolerance)
{
    if (!(sn_v3_dist(got, want) <= tolerance))
        fail_msg("{%g, %g, %g} where {%g, %g, %g} was wanted", got.x, got.y, got.z, want.x, want.y, want.z);
}

/* The box x < 0.35, y < 0.6 */
static double beyond_x(sn_vec3 p)
{
    return p.x - 0.35;
}
static double beyond_y(sn_vec3 p)
{
    return p.y - 0.6;
}
static double below_box(sn_vec3 p) /* and z > 0.3 */
{
    return 0.3 - p.z;
}
static double above_box(sn_vec3 p) /* and z < 0.7 */
{
    return p.z - 0.7;
}

static double (*const column[])(sn_vec3) = {beyond_x, beyond_y};
static double (*const floating[])(sn_vec3) = {beyond_x, beyond_y, below_box, above_box};
static const double upwards[] = {0.175, 0.3, 0, 0.175, 0.3, 1};

/* ---- one head ---- */

static void a_column_between_two_walls(void **state)
{
    (void)state;
    sn_body b = cube_with_bones((bool[]){true, false, true});
    sn_muscle m = curve_muscle(upwards, 2);
    sn_attachment a[2];
    find(&b, column, 2, &m, a);
    for (int k = 0; k < 2; k++) {
        assert_int_equal(a[k].i_bone, k ? LID : FLOOR);
        assert_near(a[k].area, 0.35 * 0.6, 1e-12);
        assert_at(a[k].centroid, sn_v3(0.175, 0.3, k), 1e-12);
        assert_true(a[k].distance >= 0.0 && a[k].distance < 0.08); /* to the nearest face's centre */
    }
    sn_muscle_free(&m);
    sn_body_free(&b);
}

/* A wall along all of the column: only what is near an end is the end's patch. */
static void a_wall_along_the_muscle(void **state)
{
    (void)state;
    sn_body b = cube_with_bones((bool[]){false, true, true});
    sn_muscle m = curve_muscle(upwards, 2);
    sn_attachment a[2];
    find(&b, column, 2, &m, a);
    assert_int_equal(a[0].i_bone, SIDE);
    assert_near(a[0].area, 0.6 * SN_ATTACHMENT_REACH, 0.6 * 0.125);
    assert_true(a[0].centroid.x == 0.0 && a[0].centroid.z < 0.2);
    assert_near(a[0].centroid.y, 0.3, 0.03);
    assert_int_equal(a[1].i_bone, LID); /* nearer to the insertion than the wall */
    assert_near(a[1].area, 0.35 * 0.6, 1e-12);
    sn_muscle_free(&m);
    sn_body_free(&b);
}

static void a_muscle_that_does_not_touch(void **state)
{
    (void)state;
    sn_body b = cube_with_bones((bool[]){true, false, true});
    static const double curve[] = {0.26, 0.26, 0.3, 0.24, 0.38, 0.8};
    sn_muscle m = curve_muscle(curve, 2);
    sn_attachment a[2];
    find(&b, floating, 4, &m, a);
    assert_int_equal(a[0].i_bone, FLOOR);
    assert_int_equal(a[1].i_bone, LID);
    assert_true(a[0].area == 0.0 && a[1].area == 0.0);
    assert_at(a[0].centroid, sn_v3(0.25, 0.25, 0), 0.0); /* corners of the lattice */
    assert_at(a[1].centroid, sn_v3(0.25, 0.375, 1), 0.0);
    assert_near(a[0].distance, sqrt(0.01 * 0.01 + 0.01 * 0.01 + 0.09), 1e-9);
    assert_near(a[1].distance, sqrt(0.01 * 0.01 + 0.005 * 0.005 + 0.04), 1e-9);
    sn_muscle_free(&m);
    sn_body_free(&b);
}

static void no_bones_at_all(void **state)
{
    (void)state;
    sn_body b = cube_with_bones((bool[]){false, false, false});
    b.n_bone = 0;
    sn_muscle m = curve_muscle(upwards, 2);
    sn_attachment a[2];
    find(&b, column, 2, &m, a);
    for (int k = 0; k < 2; k++) {
        assert_int_equal(a[k].i_bone, -1);
        assert_true(a[k].area == 0.0 && a[k].distance == 0.0);
        assert_at(a[k].centroid, sn_v3(0.175, 0.3, k), 1e-12); /* the curve's end */
    }
    sn_muscle_free(&m);
    sn_body_free(&b);
}

/* A muscle that wins nowhere touches nothing. */
static double everywhere(sn_vec3 p)
{
    (void)p;
    return 1.0;
}

static void an_empty_muscle(void **state)
{
    (void)state;
    sn_body b = cube_with_bones((bool[]){true, false, true});
    sn_muscle m = curve_muscle(upwards, 2);
    sn_attachment a[2];
    find(&b, (double (*const[])(sn_vec3)){everywhere}, 1, &m, a);
    assert_true(a[0].i_bone == FLOOR && a[0].area == 0.0);
    assert_true(a[1].i_bone == LID && a[1].area == 0.0);
    sn_muscle_free(&m);
    sn_body_free(&b);
}

/* ---- heads ---- */

/* From the floor, at x = 0.25 and 0.75, to the middle of the lid, all of the cube the muscle's. */
static void two_heads(void **state)
{
    (void)state;
    sn_body b = cube_with_bones((bool[]){true, false, true});
    static const double left[] = {0.25, 0.5, 0, 0.25, 0.5, 0.5, 0.5, 0.5, 1};
    static const double right[] = {0.75, 0.5, 0, 0.75, 0.5, 0.5, 0.5, 0.5, 1};
    sn_muscle m = heads_muscle((const sn_head_points[]){{left, NULL, 3}, {right, NULL, 3}}, 2);
    sn_attachment a[4];
    find(&b, NULL, 0, &m, a);
    assert_true(a[1].i_bone == a[3].i_bone && a[1].area == a[3].area && a[1].distance == a[3].distance);
    assert_at(a[3].centroid, a[1].centroid, 0.0); /* the same patch of the lid */
    assert_int_equal(a[1].i_bone, LID);
    assert_near(a[1].area, 1.0, 1e-12);
    assert_at(a[1].centroid, sn_v3(0.5, 0.5, 1), 1e-12);
    for (int k = 0; k < 2; k++) { /* each its half of the floor */
        assert_int_equal(a[2 * k].i_bone, FLOOR);
        assert_near(a[2 * k].area, 0.5, 1e-12);
        assert_at(a[2 * k].centroid, sn_v3(k ? 0.75 : 0.25, 0.5, 0), 1e-12);
    }
    sn_muscle_free(&m);
    sn_body_free(&b);
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    sn_body b = cube_with_bones((bool[]){true, true, true});
    sn_muscle m = curve_muscle(upwards, 2);
    double *field = SN_NEW_ZERO(double, b.mesh.n_vert);
    sn_measure *measure = NULL;
    sn_paths paths = {0};
    assert_int_equal(sn_measure_create(&measure, &b.mesh, field, 1, 0, NULL, NULL), SN_OK);
    assert_int_equal(sn_paths_build(&paths, &m, NULL), SN_OK);
    int n = 0;
    for (;; n++) {
        failing mem = {.left = n};
        sn_attachment a[2];
        sn_error err = {.msg = ""};
        sn_set_allocator(&(sn_allocator){failing_realloc, &mem});
        sn_status st = sn_attachments_find(&b, measure, &m, &paths, a, &err);
        sn_set_allocator(NULL);
        assert_int_equal(mem.n_alive, 0);
        if (!st) break;
        assert_int_equal(st, SN_ENOMEM);
        assert_string_equal(err.msg, "attachments: no memory");
    }
    assert_true(n > 0);
    sn_paths_free(&paths);
    sn_measure_destroy(measure);
    sn_release(field);
    sn_muscle_free(&m);
    sn_body_free(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_column_between_two_walls),
        cmocka_unit_test(a_wall_along_the_muscle),
        cmocka_unit_test(a_muscle_that_does_not_touch),
        cmocka_unit_test(no_bones_at_all),
        cmocka_unit_test(an_empty_muscle),
        cmocka_unit_test(two_heads),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
