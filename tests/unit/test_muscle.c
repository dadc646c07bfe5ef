/* test_muscle - a muscle's points and tissue values, and its collocation rows. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "muscle/muscle.h"

#include "made_mesh.h"

static const double points[] = {0, 0, 0, 1, 1, 0, 2, 1, 0, 3, 0, 0};
static const double tissues[] = {1, 2, 3, 5};

static sn_muscle biceps(void)
{
    sn_muscle m;
    sn_error err = {.msg = ""};
    if (sn_muscle_init(&m, "biceps", points, tissues, 4, &err)) fail_msg("%s", err.msg);
    return m;
}

/* The spline is always that of the points. */
static void assert_muscle(const sn_muscle *m, const double *point, const double *tissue, int32_t n)
{
    sn_spline want = {0};
    assert_int_equal(m->n_point, n);
    assert_memory_equal(m->point, point, 3 * (size_t)n * sizeof *point);
    assert_memory_equal(m->tissue, tissue, (size_t)n * sizeof *tissue);
    assert_int_equal(sn_spline_build(&want, point, n, NULL), SN_OK);
    assert_int_equal(m->spline.n_seg, n - 1);
    assert_memory_equal(m->spline.seg, want.seg, (size_t)(n - 1) * sizeof *want.seg);
    assert_memory_equal(m->spline.arc, want.arc, (size_t)n * sizeof *want.arc);
    sn_spline_free(&want);
}

static void new_muscle(void **state)
{
    (void)state;
    sn_muscle m = biceps();
    assert_string_equal(m.name, "biceps");
    assert_muscle(&m, points, tissues, 4);
    sn_muscle_free(&m);
    sn_muscle_free(&m);
    const double one[] = {1, 1, 1, 1};
    assert_int_equal(sn_muscle_init(&m, "", points, NULL, 4, NULL), SN_OK);
    assert_muscle(&m, points, one, 4);
    sn_muscle_free(&m);
}

static void points_are_set_added_and_removed(void **state)
{
    (void)state;
    sn_muscle m = biceps();
    assert_int_equal(sn_muscle_set_point(&m, 2, sn_v3(2, 2, 2), NULL), SN_OK);
    const double moved[] = {0, 0, 0, 1, 1, 0, 2, 2, 2, 3, 0, 0};
    assert_muscle(&m, moved, tissues, 4);
    assert_int_equal(sn_muscle_insert_point(&m, 0, sn_v3(-1, 0, 0), 7, NULL), SN_OK);
    assert_int_equal(sn_muscle_insert_point(&m, 5, sn_v3(9, 9, 9), 8, NULL), SN_OK);
    assert_int_equal(sn_muscle_insert_point(&m, 2, sn_v3(0.5, 0, 0), 9, NULL), SN_OK);
    const double more[] = {-1, 0, 0, 0, 0, 0, 0.5, 0, 0, 1, 1, 0, 2, 2, 2, 3, 0, 0, 9, 9, 9},
                 t[] = {7, 1, 9, 2, 3, 5, 8};
    assert_muscle(&m, more, t, 7);
    assert_int_equal(sn_muscle_remove_point(&m, 2, NULL), SN_OK);
    assert_int_equal(sn_muscle_remove_point(&m, 5, NULL), SN_OK);
    assert_int_equal(sn_muscle_remove_point(&m, 0, NULL), SN_OK);
    assert_muscle(&m, moved, tissues, 4);
    sn_muscle_free(&m);
}

static void tissue_values(void **state)
{
    (void)state;
    sn_muscle m = biceps();
    assert_true(sn_muscle_tissue_at(&m, 0, 0.0) == 1.0 && sn_muscle_tissue_at(&m, 0, 0.25) == 1.25);
    assert_true(sn_muscle_tissue_at(&m, 2, 0.5) == 4.0 && sn_muscle_tissue_at(&m, 2, 1.0) == 5.0);
    assert_int_equal(sn_muscle_set_tissue(&m, 1, 0.5, NULL), SN_OK);
    const double one[] = {1, 0.5, 3, 5}, all[] = {2, 2, 2, 2};
    assert_muscle(&m, points, one, 4);
    assert_int_equal(sn_muscle_set_tissue(&m, -1, 2.0, NULL), SN_OK);
    assert_muscle(&m, points, all, 4);
    sn_muscle_free(&m);
}

static void bad_muscles_are_empty(void **state)
{
    (void)state;
    const double bad_tissue[] = {1, 2, 0, 1}, nan_point[] = {0, 0, 0, 1, NAN, 0},
                 equal[] = {0, 0, 0, 1, 1, 1, 1, 1, 1};
    const struct {
        const double *point, *tissue;
        int32_t n;
        const char *want;
    } bad[] = {
        {points, bad_tissue, 4, "muscle 'psoas': tissue of point 3 is 0, need > 0"},
        {points, NULL, 1, "muscle 'psoas': a curve has 1 point, need 2 or more"},
        {points, NULL, 0, "muscle 'psoas': a curve has 0 points, need 2 or more"},
        {nan_point, NULL, 2, "muscle 'psoas': point 2 has a coordinate that is not finite"},
        {equal, NULL, 3, "muscle 'psoas': points 2 and 3 of a curve are equal"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        sn_muscle m;
        sn_error err;
        assert_int_equal(sn_muscle_init(&m, "psoas", bad[i].point, bad[i].tissue, bad[i].n, &err), SN_EINVAL);
        assert_string_equal(err.msg, bad[i].want);
        assert_true(!m.name && !m.point && !m.tissue && m.n_point == 0 && m.spline.n_seg == 0);
    }
}

static void bad_edits_change_nothing(void **state)
{
    (void)state;
    sn_muscle m = biceps();
    sn_error err;
    assert_int_equal(sn_muscle_set_point(&m, 1, sn_v3(0, 0, 0), &err), SN_EINVAL);
    assert_string_equal(err.msg, "muscle 'biceps': points 1 and 2 of a curve are equal");
    assert_int_equal(sn_muscle_set_point(&m, 3, sn_v3(0, INFINITY, 0), &err), SN_EINVAL);
    assert_string_equal(err.msg, "muscle 'biceps': point 4 has a coordinate that is not finite");
    assert_int_equal(sn_muscle_insert_point(&m, 4, sn_v3(3, 0, 0), 1, &err), SN_EINVAL);
    assert_string_equal(err.msg, "muscle 'biceps': points 4 and 5 of a curve are equal");
    assert_int_equal(sn_muscle_insert_point(&m, 4, sn_v3(4, 0, 0), -2, &err), SN_EINVAL);
    assert_string_equal(err.msg, "muscle 'biceps': tissue of point 5 is -2, need > 0");
    assert_int_equal(sn_muscle_set_tissue(&m, 2, NAN, &err), SN_EINVAL);
    assert_int_equal(sn_muscle_set_tissue(&m, -1, INFINITY, &err), SN_EINVAL);
    assert_string_equal(err.msg, "muscle 'biceps': tissue of point 1 is inf, need > 0");
    assert_muscle(&m, points, tissues, 4);
    assert_int_equal(sn_muscle_remove_point(&m, 0, NULL), SN_OK);
    assert_int_equal(sn_muscle_remove_point(&m, 0, NULL), SN_OK);
    assert_int_equal(sn_muscle_remove_point(&m, 0, &err), SN_EINVAL);
    assert_string_equal(err.msg, "muscle 'biceps': has 2 points, the fewest a curve can have");
    assert_muscle(&m, points + 6, tissues + 2, 2);
    sn_muscle_free(&m);
    const double there_and_back[] = {0, 0, 0, 1, 0, 0, 0, 0, 0};
    assert_int_equal(sn_muscle_init(&m, "loop", there_and_back, NULL, 3, NULL), SN_OK);
    assert_int_equal(sn_muscle_remove_point(&m, 1, &err), SN_EINVAL); /* its neighbours are equal */
    assert_string_equal(err.msg, "muscle 'loop': points 1 and 2 of a curve are equal");
    assert_int_equal(m.n_point, 3);
    sn_muscle_free(&m);
}

/* ---- collocation ---- */

static void make_body(sn_body *b, sn_locator **l, int n)
{
    sn_tet_mesh m = made_lattice(n, sn_v3(0, 0, 0), 1.0);
    shake_mesh(&m, 0.1);
    sn_body_init(b);
    assert_int_equal(sn_body_from_tets(&m, SN_LABEL_SKIN, b, NULL), SN_OK);
    assert_int_equal(sn_locator_create(l, &b->mesh, NULL), SN_OK);
    sn_tet_mesh_free(&m);
}

static void rows_are_the_pieces_of_the_curve(void **state)
{
    (void)state;
    sn_body b;
    sn_locator *l;
    make_body(&b, &l, 5);
    const double p[] = {0.7, 0.8, 0.9, 2, 3, 1, 4.1, 4, 4.2};
    const double tissue[] = {1, 3, 2};
    sn_muscle m;
    sn_trace t = {0};
    sn_collocation c = {0};
    sn_notes notes = {0};
    assert_int_equal(sn_muscle_init(&m, "x", p, tissue, 3, NULL), SN_OK);
    for (int round = 0; round < 2; round++) /* the second time over the first */
        assert_int_equal(sn_collocate(&m, &b, l, &c, &notes, NULL), SN_OK);
    assert_int_equal(sn_trace_curve(&b, l, m.spline.seg, m.spline.n_seg, &t, NULL), SN_OK);
    assert_true(c.n_row > 10);
    assert_int_equal(c.n_row, t.n_piece);
    for (int32_t i = 0; i < c.n_row; i++) {
        const sn_trace_piece *q = &t.piece[i];
        assert_int_equal(c.tet[i], q->tet);
        assert_memory_equal(c.bary + 4 * i, q->bary, sizeof q->bary);
        assert_true(c.value[i] == tissue[q->i_seg] + q->s * (tissue[q->i_seg + 1] - tissue[q->i_seg]));
        assert_true(c.value[i] >= 1.0 && c.value[i] <= 3.0);
    }
    assert_true(c.length_inside == t.length_inside && c.length_outside == t.length_outside);
    assert_int_equal(notes.n_line, 0);
    sn_trace_free(&t);
    sn_collocation_free(&c);
    sn_collocation_free(&c);
    sn_muscle_free(&m);
    sn_locator_destroy(l);
    sn_body_free(&b);
}

static void curves_outside_are_noted_or_refused(void **state)
{
    (void)state;
    sn_body b;
    sn_locator *l;
    sn_error err;
    make_body(&b, &l, 5);
    const double half[] = {2.5, 2.5, 2.5, 2.5, 2.5, 7.5}, away[] = {8, 8, 8, 9, 9, 9},
                 barely[] = {2.5, 2.5, 0.5, 2.5, 2.5, 4.99};
    sn_muscle m;
    sn_collocation c = {0};
    sn_notes notes = {0};
    assert_int_equal(sn_muscle_init(&m, "psoas", half, NULL, 2, NULL), SN_OK);
    assert_int_equal(sn_collocate(&m, &b, l, &c, &notes, NULL), SN_OK);
    assert_true(fabs(c.length_inside - 2.5) < 0.15 && fabs(c.length_inside + c.length_outside - 5.0) < 1e-9);
    assert_int_equal(notes.n_line, 1);
    assert_memory_equal(notes.line[0], "muscle 'psoas': 2.", 18);
    assert_non_null(strstr(notes.line[0], " of its curve's 5 lies outside the soft tissue and is not used"));
    assert_int_equal(sn_collocate(&m, &b, l, &c, NULL, NULL), SN_OK);
    sn_muscle_free(&m);
    assert_int_equal(sn_muscle_init(&m, "psoas", away, NULL, 2, NULL), SN_OK);
    assert_int_equal(sn_collocate(&m, &b, l, &c, &notes, &err), SN_EINVAL);
    assert_string_equal(err.msg, "muscle 'psoas': its curve never enters the soft tissue inside the skin");
    assert_true(c.n_row == 0 && !c.tet);
    sn_muscle_free(&m);
    assert_int_equal(sn_muscle_init(&m, "psoas", barely, NULL, 2, NULL), SN_OK); /* loses less than 1/200 */
    assert_int_equal(sn_collocate(&m, &b, l, &c, &notes, &err), SN_OK);
    if (c.length_outside <= SN_LENGTH_LOST_REL * 4.49) assert_int_equal(notes.n_line, 1);
    sn_muscle_free(&m);
    sn_collocation_free(&c);
    sn_notes_free(&notes);
    sn_locator_destroy(l);
    sn_body_free(&b);
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    sn_body b;
    sn_locator *l;
    make_body(&b, &l, 4);
    sn_status st = SN_ENOMEM;
    for (int n = 0; st; n++) {
        ration r = {n, 0};
        sn_muscle m = {0};
        sn_collocation c = {0};
        sn_error err;
        sn_set_allocator(RATION(r));
        st = sn_muscle_init(&m, "x", points, tissues, 4, &err);
        if (!st) st = sn_muscle_insert_point(&m, 2, sn_v3(1.5, 1.5, 1.5), 2.0, &err);
        if (st && m.name) assert_int_equal(m.n_point, 4);
        if (!st) st = sn_muscle_remove_point(&m, 0, &err);
        if (st && m.name) assert_int_equal(m.spline.n_seg, m.n_point - 1);
        if (!st) st = sn_muscle_set_point(&m, 0, sn_v3(0.5, 0.6, 0.7), &err);
        if (!st) st = sn_collocate(&m, &b, l, &c, NULL, &err);
        if (st) assert_int_equal(err.code, SN_ENOMEM);
        if (st) assert_memory_equal(err.msg, "muscle 'x': ", 12);
        if (st) assert_non_null(strstr(err.msg, "no memory"));
        if (st) assert_true(c.n_row == 0);
        sn_collocation_free(&c);
        sn_muscle_free(&m);
        assert_int_equal(r.in_use, 0);
        assert_true(n < 50);
    }
    sn_set_allocator(NULL);
    sn_locator_destroy(l);
    sn_body_free(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(new_muscle),
        cmocka_unit_test(points_are_set_added_and_removed),
        cmocka_unit_test(tissue_values),
        cmocka_unit_test(bad_muscles_are_empty),
        cmocka_unit_test(bad_edits_change_nothing),
        cmocka_unit_test(rows_are_the_pieces_of_the_curve),
        cmocka_unit_test(curves_outside_are_noted_or_refused),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
