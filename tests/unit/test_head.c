/* test_head - one curve of a muscle: its points and tissue values, and edits of them. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "muscle/head.h"

#include "made_mesh.h"

static const double points[] = {0, 0, 0, 1, 1, 0, 2, 1, 0, 3, 0, 0};
static const double tissues[] = {1, 2, 3, 5};

static sn_head new_head(const double *point, const double *tissue, int32_t n)
{
    sn_head h;
    sn_error err = {.msg = ""};
    if (sn_head_init(&h, &(sn_head_points){point, tissue, n}, &err)) fail_msg("%s", err.msg);
    return h;
}

/* The spline is always that of the points. */
static void assert_head(const sn_head *h, const double *point, const double *tissue, int32_t n)
{
    sn_spline want = {0};
    assert_int_equal(h->n_point, n);
    assert_memory_equal(h->point, point, 3 * (size_t)n * sizeof *point);
    assert_memory_equal(h->tissue, tissue, (size_t)n * sizeof *tissue);
    assert_int_equal(sn_spline_build(&want, point, n, NULL), SN_OK);
    assert_int_equal(h->spline.n_seg, n - 1);
    assert_memory_equal(h->spline.seg, want.seg, (size_t)(n - 1) * sizeof *want.seg);
    assert_memory_equal(h->spline.arc, want.arc, (size_t)n * sizeof *want.arc);
    sn_spline_free(&want);
}

static void made_and_copied(void **state)
{
    (void)state;
    sn_head h = new_head(points, tissues, 4), copy;
    assert_head(&h, points, tissues, 4);
    assert_int_equal(sn_head_copy(&copy, &h, NULL), SN_OK);
    assert_head(&copy, points, tissues, 4);
    assert_true(copy.point != h.point && copy.tissue != h.tissue);
    assert_int_equal(sn_head_set_tissue(&copy, 0, 9, NULL), SN_OK);
    assert_head(&h, points, tissues, 4);
    sn_head_free(&copy);
    sn_head_free(&h);
    sn_head_free(&h);
    const double one[] = {1, 1, 1, 1};
    h = new_head(points, NULL, 4);
    assert_head(&h, points, one, 4);
    sn_head_free(&h);
}

static void points_are_set_added_and_removed(void **state)
{
    (void)state;
    sn_head h = new_head(points, tissues, 4);
    assert_int_equal(sn_head_set_point(&h, 2, sn_v3(2, 2, 2), NULL), SN_OK);
    const double moved[] = {0, 0, 0, 1, 1, 0, 2, 2, 2, 3, 0, 0};
    assert_head(&h, moved, tissues, 4);
    assert_int_equal(sn_head_insert_point(&h, 0, sn_v3(-1, 0, 0), 7, NULL), SN_OK);
    assert_int_equal(sn_head_insert_point(&h, 5, sn_v3(9, 9, 9), 8, NULL), SN_OK);
    assert_int_equal(sn_head_insert_point(&h, 2, sn_v3(0.5, 0, 0), 9, NULL), SN_OK);
    const double more[] = {-1, 0, 0, 0, 0, 0, 0.5, 0, 0, 1, 1, 0, 2, 2, 2, 3, 0, 0, 9, 9, 9},
                 t[] = {7, 1, 9, 2, 3, 5, 8};
    assert_head(&h, more, t, 7);
    assert_int_equal(sn_head_remove_point(&h, 2, NULL), SN_OK);
    assert_int_equal(sn_head_remove_point(&h, 5, NULL), SN_OK);
    assert_int_equal(sn_head_remove_point(&h, 0, NULL), SN_OK);
    assert_head(&h, moved, tissues, 4);
    sn_head_free(&h);
}

static void tissue_values(void **state)
{
    (void)state;
    sn_head h = new_head(points, tissues, 4);
    assert_true(sn_head_tissue_at(&h, 0, 0.0) == 1.0 && sn_head_tissue_at(&h, 0, 0.25) == 1.25);
    assert_true(sn_head_tissue_at(&h, 2, 0.5) == 4.0 && sn_head_tissue_at(&h, 2, 1.0) == 5.0);
    assert_int_equal(sn_head_set_tissue(&h, 1, 0.5, NULL), SN_OK);
    const double one[] = {1, 0.5, 3, 5}, all[] = {2, 2, 2, 2};
    assert_head(&h, points, one, 4);
    assert_int_equal(sn_head_set_tissue(&h, -1, 2.0, NULL), SN_OK);
    assert_head(&h, points, all, 4);
    sn_head_free(&h);
}

static void bad_heads_are_empty(void **state)
{
    (void)state;
    const double bad_tissue[] = {1, 2, 0, 1}, nan_point[] = {0, 0, 0, 1, NAN, 0},
                 equal[] = {0, 0, 0, 1, 1, 1, 1, 1, 1};
    const struct {
        const double *point, *tissue;
        int32_t n;
        const char *want;
    } bad[] = {
        {points, bad_tissue, 4, "tissue of point 3 is 0, need > 0"},
        {points, NULL, 1, "a curve has 1 point, need 2 or more"},
        {points, NULL, 0, "a curve has 0 points, need 2 or more"},
        {nan_point, NULL, 2, "point 2 has a coordinate that is not finite"},
        {equal, NULL, 3, "points 2 and 3 of a curve are equal"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        sn_head h;
        sn_error err;
        assert_int_equal(sn_head_init(&h, &(sn_head_points){bad[i].point, bad[i].tissue, bad[i].n}, &err),
                         SN_EINVAL);
        assert_string_equal(err.msg, bad[i].want);
        assert_true(!h.point && !h.tissue && h.n_point == 0 && h.spline.n_seg == 0);
    }
}

static void bad_edits_change_nothing(void **state)
{
    (void)state;
    sn_head h = new_head(points, tissues, 4);
    sn_error err;
    assert_int_equal(sn_head_set_point(&h, 1, sn_v3(0, 0, 0), &err), SN_EINVAL);
    assert_string_equal(err.msg, "points 1 and 2 of a curve are equal");
    assert_int_equal(sn_head_set_point(&h, 3, sn_v3(0, INFINITY, 0), &err), SN_EINVAL);
    assert_string_equal(err.msg, "point 4 has a coordinate that is not finite");
    assert_int_equal(sn_head_insert_point(&h, 4, sn_v3(3, 0, 0), 1, &err), SN_EINVAL);
    assert_string_equal(err.msg, "points 4 and 5 of a curve are equal");
    assert_int_equal(sn_head_insert_point(&h, 4, sn_v3(4, 0, 0), -2, &err), SN_EINVAL);
    assert_string_equal(err.msg, "tissue of point 5 is -2, need > 0");
    assert_int_equal(sn_head_set_tissue(&h, 2, NAN, &err), SN_EINVAL);
    assert_string_equal(err.msg, "tissue of point 3 is nan, need > 0");
    assert_int_equal(sn_head_set_tissue(&h, -1, INFINITY, &err), SN_EINVAL);
    assert_string_equal(err.msg, "tissue of point 1 is inf, need > 0");
    assert_head(&h, points, tissues, 4);
    assert_int_equal(sn_head_remove_point(&h, 0, NULL), SN_OK);
    assert_int_equal(sn_head_remove_point(&h, 0, NULL), SN_OK);
    assert_int_equal(sn_head_remove_point(&h, 0, &err), SN_EINVAL);
    assert_string_equal(err.msg, "has 2 points, the fewest a curve can have");
    assert_head(&h, points + 6, tissues + 2, 2);
    sn_head_free(&h);
    const double there_and_back[] = {0, 0, 0, 1, 0, 0, 0, 0, 0};
    h = new_head(there_and_back, NULL, 3);
    assert_int_equal(sn_head_remove_point(&h, 1, &err), SN_EINVAL); /* its neighbours are equal */
    assert_string_equal(err.msg, "points 1 and 2 of a curve are equal");
    assert_int_equal(h.n_point, 3);
    sn_head_free(&h);
}

static sn_status make_and_edit(sn_head *h, sn_error *err)
{
    sn_head copy = {0};
    sn_status st = sn_head_init(h, &(sn_head_points){points, tissues, 4}, err);
    if (st) assert_true(!h->point && !h->tissue && h->n_point == 0);
    if (st) return st;
    st = sn_head_insert_point(h, 2, sn_v3(1.5, 1.5, 1.5), 2.0, err);
    if (st) assert_memory_equal(h->point, points, sizeof points);
    if (!st) st = sn_head_remove_point(h, 0, err);
    if (!st) st = sn_head_set_point(h, 0, sn_v3(0.5, 0.6, 0.7), err);
    assert_int_equal(h->spline.n_seg, h->n_point - 1);
    if (!st) st = sn_head_copy(&copy, h, err);
    sn_head_free(&copy);
    return st;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    sn_status st = SN_ENOMEM;
    int n = 0;
    for (; st; n++) {
        ration r = {n, 0};
        sn_head h = {0};
        sn_error err;
        sn_set_allocator(RATION(r));
        st = make_and_edit(&h, &err);
        if (st) assert_int_equal(err.code, SN_ENOMEM);
        if (st) assert_non_null(strstr(err.msg, "no memory"));
        sn_head_free(&h);
        assert_int_equal(r.in_use, 0);
        assert_true(n < 50);
    }
    assert_true(n > 16); /* points, tissue and two of the spline, five times */
    sn_set_allocator(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(made_and_copied),
        cmocka_unit_test(points_are_set_added_and_removed),
        cmocka_unit_test(tissue_values),
        cmocka_unit_test(bad_heads_are_empty),
        cmocka_unit_test(bad_edits_change_nothing),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
