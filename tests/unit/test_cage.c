/* test_cage - mean value coordinates. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/alloc.h"
#include "skeleton/cage.h"

#include "made_template.h"

static double *weights_of(const sn_tri_mesh *cage, const double *point, int32_t n, const sn_run *run)
{
    sn_error err = {.msg = ""};
    double *w = SN_NEW(double, (size_t)n *(size_t)cage->n_vert);
    assert_non_null(w);
    if (sn_cage_weights(cage, point, n, run, w, &err)) fail_msg("%s", err.msg);
    return w;
}

/* The weights add up to 1 and give the points, to 1e-12 of the cage's size. */
static void assert_linear(const sn_tri_mesh *cage, const double *point, int32_t n)
{
    double size = sn_box3_diagonal(sn_tri_mesh_bounds(cage)), *w = weights_of(cage, point, n, NULL);
    for (int32_t i = 0; i < n; i++) {
        double sum = 0.0;
        sn_vec3 p = sn_v3(0, 0, 0), want = sn_v3_load(point + 3 * i);
        for (int32_t j = 0; j < cage->n_vert; j++) {
            double x = w[(size_t)i * (size_t)cage->n_vert + (size_t)j];
            assert_true(isfinite(x));
            sum += x;
            p = sn_v3_mad(p, x, sn_tri_mesh_point(cage, j));
        }
        assert_near(sum, 1.0, 1e-12);
        if (!(sn_v3_dist(p, want) <= 1e-12 * size))
            fail_msg("point %d (%g %g %g) is off by %g", i, want.x, want.y, want.z, sn_v3_dist(p, want));
    }
    sn_release(w);
}

static sn_tri_mesh concave_cage(void) /* a lumpy head, finer than a cage needs to be */
{
    return made_head(0.4);
}

static void points_inside_and_outside(void **state)
{
    (void)state;
    sn_tri_mesh cage[3] = {made_box(sn_v3(-1, -1, -1), sn_v3(1, 2, 1)), made_sphere(sn_v3(0, 0, 0), 1.5, 1.0),
                           concave_cage()};
    uint64_t h = 99;
    enum { N = 300 };
    double point[3 * N];
    for (int k = 0; k < 3 * N; k++) point[k] = 6.0 * made_random(&h) - 3.0;
    for (int c = 0; c < 3; c++) {
        assert_linear(&cage[c], point, N);
        scale_mesh(&cage[c], 1e6); /* the points are now all near the middle */
        assert_linear(&cage[c], point, N);
        sn_tri_mesh_free(&cage[c]);
    }
}

/* On corners, edges and faces, a little beside them, and in the planes of faces. */
static void points_on_the_cage(void **state)
{
    (void)state;
    sn_tri_mesh cage[2] = {made_box(sn_v3(-1, -1, -1), sn_v3(1, 2, 1)), concave_cage()};
    static const double mean[][3] = {{1, 0, 0},       {0.5, 0.5, 0},       {0.3, 0.3, 0.4}, {1e-9, 0, 1.0},
                                     {0.9, 0.1, 0.0}, {1.5, -0.25, -0.25}, {2.0, -1.0, 0.0}};
    static const double off[] = {0.0, 1e-3, 1e-6, 1e-9, 1e-11, 1e-12, 1e-13, 1e-14, 1e-15, 1e-16};
    for (int c = 0; c < 2; c++) {
        double point[3 * 10];
        for (int32_t f = 0; f < cage[c].n_face; f += 1 + 6 * c) {
            const int32_t *v = cage[c].face + 3 * f;
            sn_vec3 n = sn_v3_unit(sn_tri_mesh_face_normal(&cage[c], f));
            for (size_t m = 0; m < sizeof mean / sizeof *mean; m++) {
                sn_vec3 p = sn_v3(0, 0, 0);
                for (int k = 0; k < 3; k++) p = sn_v3_mad(p, mean[m][k], sn_tri_mesh_point(&cage[c], v[k]));
                for (int k = 0; k < 10; k++)
                    sn_v3_store(point + 3 * k, sn_v3_mad(p, k % 2 ? off[k] : -off[k], n));
                assert_linear(&cage[c], point, 10);
            }
        }
        sn_tri_mesh_free(&cage[c]);
    }
}

static void a_face_holds_its_points_alone(void **state)
{
    (void)state;
    sn_tri_mesh cage = made_sphere(sn_v3(0, 0, 0), 1.5, 1.0);
    const int32_t *v = cage.face + 3 * 7;
    static const double mean[3] = {0.2, 0.3, 0.5};
    sn_vec3 p = sn_v3(0, 0, 0), n = sn_v3_unit(sn_tri_mesh_face_normal(&cage, 7));
    for (int k = 0; k < 3; k++) p = sn_v3_mad(p, mean[k], sn_tri_mesh_point(&cage, v[k]));
    double point[9];
    sn_v3_store(point, p);
    sn_v3_store(point + 3, sn_v3_mad(p, -1e-9, n));
    sn_v3_store(point + 6, sn_tri_mesh_point(&cage, 5));
    double *w = weights_of(&cage, point, 3, NULL);
    for (int32_t j = 0; j < cage.n_vert; j++) {
        double want = j == v[0] ? 0.2 : j == v[1] ? 0.3 : j == v[2] ? 0.5 : 0.0;
        assert_near(w[j], want, 1e-12);
        assert_near(w[cage.n_vert + j], want, 1e-7); /* no jump beside the face */
        assert_true(w[2 * cage.n_vert + j] == (j == 5 ? 1.0 : 0.0));
    }
    sn_release(w);
    sn_tri_mesh_free(&cage);
}

/* The definition: the weight of a vertex is the integral of its hat function over distance, over the image of
 * the cage on the unit sphere around the point. Here by brute force, faces cut into 60 x 60. */
static void the_definition_by_brute_force(void **state)
{
    (void)state;
    enum { CUT = 60 };
    sn_tri_mesh cage = made_box(sn_v3(-1, -1, -1), sn_v3(1, 2, 1));
    const double point[] = {0.2, 0.7, -0.4};
    double *w = weights_of(&cage, point, 1, NULL), want[8] = {0.0}, sum = 0.0;
    sn_vec3 p = sn_v3_load(point);
    for (int32_t f = 0; f < cage.n_face; f++) {
        const int32_t *v = cage.face + 3 * f;
        sn_vec3 n = sn_v3_scale(0.5 / (CUT * CUT), sn_tri_mesh_face_normal(&cage, f));
        for (int i = 0; i < CUT; i++)
            for (int j = 0; i + j < CUT; j++)
                for (int up = 0; up < 2 && i + j + up < CUT; up++) {
                    double a = (i + (1 + up) / 3.0) / CUT, b = (j + (1 + up) / 3.0) / CUT;
                    const double hat[3] = {a, b, 1.0 - a - b};
                    sn_vec3 y = sn_v3(-p.x, -p.y, -p.z);
                    for (int k = 0; k < 3; k++) y = sn_v3_mad(y, hat[k], sn_tri_mesh_point(&cage, v[k]));
                    double r = sn_v3_len(y), share = sn_v3_dot(y, n) / (r * r * r * r);
                    for (int k = 0; k < 3; k++) want[v[k]] += share * hat[k];
                    sum += share;
                }
    }
    for (int j = 0; j < 8; j++) assert_near(w[j], want[j] / sum, 2e-4);
    sn_release(w);
    sn_tri_mesh_free(&cage);
}

static void affine_motions_carry_over(void **state)
{
    (void)state;
    made_template t;
    made_template_init(&t, 0.25);
    double *w = weights_of(&t.cage, t.bone.pos, t.bone.n_vert, NULL),
           *out = SN_NEW(double, 3 * t.bone.n_vert);
    assert_non_null(out);
    for (int32_t i = 0; i < t.cage.n_vert; i++) {
        double *p = t.cage.pos + 3 * i, x = p[0], y = p[1], z = p[2];
        p[0] = 2.0 * x + 0.3 * y + 5.0, p[1] = y - 0.2 * z, p[2] = 0.1 * x - z;
    }
    sn_cage_apply(w, t.bone.n_vert, t.cage.pos, t.cage.n_vert, NULL, out);
    for (int32_t i = 0; i < t.bone.n_vert; i++) {
        const double *p = t.bone.pos + 3 * i;
        assert_near(out[3 * i], 2.0 * p[0] + 0.3 * p[1] + 5.0, 1e-12);
        assert_near(out[3 * i + 1], p[1] - 0.2 * p[2], 1e-12);
        assert_near(out[3 * i + 2], 0.1 * p[0] - p[2], 1e-12);
    }
    sn_release(out);
    sn_release(w);
    made_template_free(&t);
}

static void the_same_bits_for_any_threads(void **state)
{
    (void)state;
    made_template t;
    made_template_init(&t, 0.15);
    sn_run one = {.n_threads = 1}, three = {.n_threads = 3};
    double *a = weights_of(&t.cage, t.skin.pos, t.skin.n_vert, &one);
    double *b = weights_of(&t.cage, t.skin.pos, t.skin.n_vert, &three);
    assert_memory_equal(a, b, (size_t)t.skin.n_vert * (size_t)t.cage.n_vert * sizeof *a);
    sn_release(a);
    sn_release(b);
    made_template_free(&t);
}

static void assert_bad_cage(sn_tri_mesh *cage, const char *want)
{
    sn_error err;
    assert_int_equal(sn_cage_check(cage, &err), SN_EINVAL);
    assert_string_equal(err.msg, want);
    sn_tri_mesh_free(cage);
}

static void bad_cages_and_points(void **state)
{
    (void)state;
    sn_error err;
    sn_vec3 low = sn_v3(-1, -1, -1), high = sn_v3(1, 1, 1);
    sn_tri_mesh m = made_box(low, high);
    assert_int_equal(sn_cage_check(&m, &err), SN_OK);
    const double bad[] = {0, 0, 0, 0, INFINITY, 0};
    double w[16];
    assert_int_equal(sn_cage_weights(&m, bad, 2, NULL, w, &err), SN_EINVAL);
    assert_string_equal(err.msg, "cage: point 2 has a coordinate that is not finite");
    volatile sig_atomic_t stop = 1;
    sn_run run = {.cancel = &stop};
    assert_int_equal(sn_cage_weights(&m, bad, 1, &run, w, &err), SN_ECANCEL);
    assert_string_equal(err.msg, "interrupted while binding to the cage");
    m.n_face--;
    assert_bad_cage(&m, "cage: has 3 boundary edges, need a closed surface");
    m = made_box(low, high);
    turn_faces(&m);
    assert_bad_cage(&m, "cage: volume is -8, need > 0 with faces turned outwards");
    m = made_box(low, high);
    m.pos[4] = NAN;
    assert_bad_cage(&m, "cage: vertex 2 has a coordinate that is not finite");
    m = made_box(low, high);
    m.n_face = 0;
    assert_bad_cage(&m, "cage: surface has no faces");
    m = made_sphere(sn_v3(0, 0, 0), 1.0, 1.0);
    for (size_t k = 0; k < 3 * (size_t)m.n_face; k++) m.face[k] -= m.face[k] == m.n_vert - 1 ? 1 : 0;
    assert_int_equal(sn_cage_check(&m, &err), SN_EINVAL);
    sn_tri_mesh_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_inside_and_outside),     cmocka_unit_test(points_on_the_cage),
        cmocka_unit_test(a_face_holds_its_points_alone), cmocka_unit_test(the_definition_by_brute_force),
        cmocka_unit_test(affine_motions_carry_over),     cmocka_unit_test(the_same_bits_for_any_threads),
        cmocka_unit_test(bad_cages_and_points),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
