/* Planes: sides, projections, reflections. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/plane.h"

#include "made_mesh.h"

static sn_plane made_plane(sn_vec3 point, sn_vec3 normal)
{
    sn_plane p;
    assert_int_equal(sn_plane_make(&p, "test", point, normal, NULL), SN_OK);
    return p;
}

static void a_plane_across_an_axis_is_exact(void **state)
{
    (void)state;
    for (int axis = 0; axis < 3; axis++)
        for (int sign = -1; sign <= 1; sign += 2) {
            double n[3] = {0, 0, 0}, q[3] = {0.3, 0.7, -0.9}, back[3];
            n[axis] = sign * 1e-200; /* its square is 0 */
            sn_plane p = made_plane(sn_v3(0.1, 0.1, 0.1), sn_v3_load(n));
            assert_int_equal(p.axis, axis);
            assert_true(sn_v3_len(p.normal) == 1.0);
            double on[3];
            sn_v3_store(on, sn_plane_project(&p, sn_v3_load(q)));
            sn_v3_store(back, sn_plane_reflect(&p, sn_plane_reflect(&p, sn_v3_load(q))));
            for (int k = 0; k < 3; k++) {
                assert_true(on[k] == (k == axis ? 0.1 : q[k]));
                assert_true(fabs(back[k] - q[k]) < 1e-15);
            }
            assert_true(sn_plane_height(&p, sn_v3_load(q)) * sign == q[axis] - 0.1);
        }
}

/* The plane x + 2 y + 2 z = 9 has the unit normal (1, 2, 2) / 3. */
static void a_slanted_plane(void **state)
{
    (void)state;
    sn_plane p = made_plane(sn_v3(1, 2, 2), sn_v3(1e200, 2e200, 2e200));
    assert_int_equal(p.axis, -1);
    sn_vec3 q = sn_v3(2, 4, 4), on = sn_plane_project(&p, q), image = sn_plane_reflect(&p, q);
    assert_true(fabs(sn_plane_height(&p, q) - 3.0) < 1e-14);
    assert_true(sn_v3_dist(on, sn_v3(1, 2, 2)) < 1e-14);
    assert_true(sn_v3_len(image) < 1e-14);
    assert_true(sn_v3_dist(sn_plane_reflect(&p, image), q) < 1e-14);
    sn_vec3 across = sn_plane_reflect_vector(&p, sn_v3(1, 2, 2)),
            within = sn_plane_reflect_vector(&p, sn_v3(0, 1, -1));
    assert_true(sn_v3_dist(across, sn_v3(-1, -2, -2)) < 1e-14);
    assert_true(sn_v3_dist(within, sn_v3(0, 1, -1)) < 1e-14);
}

static void planes_that_are_none(void **state)
{
    const sn_vec3 o = {0, 0, 0}, x = {1, 0, 0};
    sn_plane p;
    sn_error err;
    (void)state;
    assert_int_equal(sn_plane_make(&p, "cut", o, o, &err), SN_EINVAL);
    assert_string_equal(err.msg, "cut: the plane needs a finite point and a normal that is not zero");
    assert_int_equal(sn_plane_make(&p, "cut", o, sn_v3(0, NAN, 1), &err), SN_EINVAL);
    assert_int_equal(sn_plane_make(&p, "cut", o, sn_v3(0, INFINITY, 0), &err), SN_EINVAL);
    assert_int_equal(sn_plane_make(&p, "cut", sn_v3(0, 0, NAN), x, &err), SN_EINVAL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plane_across_an_axis_is_exact),
        cmocka_unit_test(a_slanted_plane),
        cmocka_unit_test(planes_that_are_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
