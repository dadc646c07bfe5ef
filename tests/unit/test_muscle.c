/* test_muscle - a muscle of one or more heads, what its owner wants of it, and its collocation rows. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "muscle/collocation.h"
#include "tetra/trace.h"
#include "muscle/muscle.h"

#include "made_mesh.h"

static const double points[] = {0, 0, 0, 1, 1, 0, 2, 1, 0, 3, 0, 0}, tissues[] = {1, 2, 3, 5};
static const double points_b[] = {0, 3, 0, 2, 2, 0, 3, 0.1, 0}, tissues_b[] = {4, 1, 1};
static const sn_head_points both[] = {{points, tissues, 4}, {points_b, tissues_b, 3}};

static sn_muscle made_muscle(const sn_head_points *head, int32_t n)
{
    sn_muscle m;
    sn_error err = {.msg = ""};
    if (sn_muscle_init(&m, "biceps", head, n, &err)) fail_msg("%s", err.msg);
    return m;
}

static void assert_heads(const sn_muscle *m, const sn_head_points *head, int32_t n)
{
    assert_int_equal(m->n_head, n);
    for (int32_t i = 0; i < n; i++) {
        assert_int_equal(m->head[i].n_point, head[i].n);
        assert_memory_equal(m->head[i].point, head[i].point, 3 * (size_t)head[i].n * sizeof(double));
        assert_int_equal(m->head[i].spline.n_seg, head[i].n - 1);
        for (int32_t k = 0; k < head[i].n; k++)
            assert_true(m->head[i].tissue[k] == (head[i].tissue ? head[i].tissue[k] : 1.0));
    }
}

static void new_muscle(void **state)
{
    (void)state;
    sn_muscle m = made_muscle(both, 2);
    assert_string_equal(m.name, "biceps");
    assert_heads(&m, both, 2);
    assert_false(m.anisotropy.is_on);
    assert_int_equal(m.pennation.kind, SN_FUSIFORM);
    assert_true(m.tendon.length == 0.0 && m.tendon.area == 0.0);
    double sum = sn_spline_length(&m.head[0].spline) + sn_spline_length(&m.head[1].spline);
    assert_true(sn_muscle_length(&m) == sum && sum > 6.0);
    sn_muscle_scale_tissue(&m, 0.5);
    assert_true(m.head[0].tissue[3] == 2.5 && m.head[1].tissue[0] == 2.0 && m.head[1].tissue[2] == 0.5);
    sn_muscle_free(&m);
    sn_muscle_free(&m);
    const sn_head_points plain = {points, NULL, 4};
    assert_int_equal(sn_muscle_init(&m, "", &plain, 1, NULL), SN_OK);
    assert_heads(&m, &plain, 1);
    sn_muscle_free(&m);
}

static void a_copy_has_everything(void **state)
{
    (void)state;
    sn_muscle m = made_muscle(both, 2), copy;
    const sn_anisotropy a = {true, 30.0, {1, 8, 2}, true, {0, 0, 1}};
    const sn_pennation p = {.kind = SN_MULTIPENNATE, .angle_deg = {10, 20}, .n_angle = 2, .n_sheet = 3};
    assert_int_equal(sn_muscle_set_anisotropy(&m, &a, NULL), SN_OK);
    assert_int_equal(sn_muscle_set_pennation(&m, &p, NULL), SN_OK);
    assert_int_equal(sn_muscle_set_tendon(&m, &(sn_tendon){0.5, 0.25}, NULL), SN_OK);
    assert_int_equal(sn_muscle_copy(&copy, &m, NULL), SN_OK);
    sn_muscle_free(&m);
    assert_string_equal(copy.name, "biceps");
    assert_heads(&copy, both, 2);
    assert_true(copy.anisotropy.is_on && copy.anisotropy.angle_deg == 30.0 && copy.anisotropy.has_axis);
    assert_true(copy.anisotropy.eigenvalue[1] == 8.0 && copy.anisotropy.axis.z == 1.0);
    assert_true(copy.pennation.kind == SN_MULTIPENNATE && copy.pennation.angle_deg[1] == 20.0);
    assert_true(copy.pennation.n_angle == 2 && copy.pennation.n_sheet == 3);
    assert_true(copy.tendon.length == 0.5 && copy.tendon.area == 0.25);
    sn_muscle_free(&copy);
}

static void bad_muscles_are_empty(void **state)
{
    (void)state;
    const double bad_tissue[] = {1, 2, 0, 1}, nan_point[] = {0, 0, 0, 1, NAN, 0};
    const sn_head_points one[] = {{points, bad_tissue, 4}}, second[] = {both[0], {nan_point, NULL, 2}},
                         first[] = {{points, NULL, 1}, both[1]};
    const struct {
        const sn_head_points *head;
        int32_t n;
        const char *want;
    } bad[] = {
        {one, 1, "muscle 'psoas': tissue of point 3 is 0, need > 0"},
        {second, 2, "muscle 'psoas', head 2: point 2 has a coordinate that is not finite"},
        {first, 2, "muscle 'psoas', head 1: a curve has 1 point, need 2 or more"},
        {first, 1, "muscle 'psoas': a curve has 1 point, need 2 or more"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        sn_muscle m;
        sn_error err;
        assert_int_equal(sn_muscle_init(&m, "psoas", bad[i].head, bad[i].n, &err), SN_EINVAL);
        assert_string_equal(err.msg, bad[i].want);
        assert_true(!m.name && !m.head && m.n_head == 0);
    }
}

/* ---- wishes ---- */

static void assert_refused(sn_status st, const sn_error *err, const char *want)
{
    assert_int_equal(st, SN_EINVAL);
    assert_string_equal(err->msg, want);
}

static void frames_are_checked(void **state)
{
    (void)state;
    const double straight[] = {1, 1, 1, 3, 1, 1};
    sn_muscle m = made_muscle(&(sn_head_points){straight, NULL, 2}, 1);
    const sn_anisotropy good = {true, 45, {1, 4, 2}, true, {5, 1, 0}};
    sn_error err;
    assert_int_equal(sn_muscle_set_anisotropy(&m, &good, NULL), SN_OK);
    const struct {
        sn_anisotropy a;
        const char *want;
    } bad[] = {
        {{true, NAN, {1, 1, 1}, false, {0, 0, 0}},
         "muscle 'biceps': angle of the frame is nan, need a finite number"},
        {{true, -INFINITY, {1, 1, 1}, false, {0, 0, 0}},
         "muscle 'biceps': angle of the frame is -inf, need a finite number"},
        {{true, 0, {-1, 1, 1}, false, {0, 0, 0}}, "muscle 'biceps': eigenvalue 1 is -1, need > 0"},
        {{true, 0, {1, 0, 1}, false, {0, 0, 0}}, "muscle 'biceps': eigenvalue 2 is 0, need > 0"},
        {{true, 0, {1, 1, INFINITY}, false, {0, 0, 0}}, "muscle 'biceps': eigenvalue 3 is inf, need > 0"},
        {{true, 0, {1, NAN, 1}, false, {0, 0, 0}}, "muscle 'biceps': eigenvalue 2 is nan, need > 0"},
        {{true, 0, {1, 1, 1}, true, {-2, 0, 0}},
         "muscle 'biceps': axis {-2, 0, 0} of the frame runs along the curve, need a direction across it"},
        {{true, 0, {1, 1, 1}, true, {0, 0, 0}}, "muscle 'biceps': axis {0, 0, 0} of the frame "},
        {{true, 0, {1, 1, 1}, true, {0, NAN, 0}}, "muscle 'biceps': axis {0, nan, 0} of the frame "},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(sn_muscle_set_anisotropy(&m, &bad[i].a, &err), SN_EINVAL);
        if (strncmp(err.msg, bad[i].want, strlen(bad[i].want)) != 0) fail_msg("%s", err.msg);
        assert_true(m.anisotropy.is_on && m.anisotropy.angle_deg == 45 && m.anisotropy.eigenvalue[1] == 4);
    }
    const sn_anisotropy off = {
        false, NAN, {-1, 0, INFINITY}, true, {1, 0, 0}}; /* what is off is not looked at */
    assert_int_equal(sn_muscle_set_anisotropy(&m, &off, NULL), SN_OK);
    assert_true(!m.anisotropy.is_on && m.anisotropy.angle_deg == 0.0 && !m.anisotropy.has_axis);
    sn_muscle_free(&m);
}

static void pennations_are_checked(void **state)
{
    (void)state;
    sn_muscle m = made_muscle(both, 1);
    sn_pennation p = {.kind = SN_BIPENNATE, .angle_deg = {0, 80}, .n_angle = 2};
    sn_error err;
    assert_int_equal(sn_muscle_set_pennation(&m, &p, NULL), SN_OK);
    const struct {
        sn_pennation p;
        const char *want;
    } bad[] = {
        {{.kind = SN_UNIPENNATE}, "muscle 'biceps': 0 pennation angles, need 1..16"},
        {{.kind = SN_BIPENNATE, .n_angle = 17}, "muscle 'biceps': 17 pennation angles, need 1..16"},
        {{.kind = SN_FUSIFORM, .n_angle = 1},
         "muscle 'biceps': fibers that are fusiform have no pennation angle"},
        {{.kind = SN_CONVERGENT, .n_angle = 2},
         "muscle 'biceps': fibers that are convergent have no pennation angle"},
        {{.kind = SN_UNIPENNATE, .angle_deg = {20, 81}, .n_angle = 2},
         "muscle 'biceps': pennation angle 2 is 81 degrees, need 0..80"},
        {{.kind = SN_UNIPENNATE, .angle_deg = {-1}, .n_angle = 1},
         "muscle 'biceps': pennation angle 1 is -1 degrees, need 0..80"},
        {{.kind = SN_UNIPENNATE, .angle_deg = {NAN}, .n_angle = 1},
         "muscle 'biceps': pennation angle 1 is nan degrees, need 0..80"},
        {{.kind = SN_MULTIPENNATE, .angle_deg = {9}, .n_angle = 1, .n_sheet = 1},
         "muscle 'biceps': 1 aponeuroses, need 2..16"},
        {{.kind = SN_MULTIPENNATE, .angle_deg = {9}, .n_angle = 1, .n_sheet = 17},
         "muscle 'biceps': 17 aponeuroses, need 2..16"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_refused(sn_muscle_set_pennation(&m, &bad[i].p, &err), &err, bad[i].want);
        assert_true(m.pennation.kind == SN_BIPENNATE && m.pennation.n_angle == 2);
    }
    assert_string_equal(sn_architecture_name[SN_FUSIFORM], "fusiform");
    assert_string_equal(sn_architecture_name[SN_MULTIPENNATE], "multipennate");
    assert_null(sn_architecture_name[SN_N_ARCHITECTURE]);
    sn_muscle_free(&m);
}

static void tendons_are_checked(void **state)
{
    (void)state;
    sn_muscle m = made_muscle(both, 1);
    sn_error err;
    assert_int_equal(sn_muscle_set_tendon(&m, &(sn_tendon){0.5, 0.0}, NULL), SN_OK);
    assert_refused(sn_muscle_set_tendon(&m, &(sn_tendon){-1, 0}, &err), &err,
                   "muscle 'biceps': tendon length is -1, need >= 0");
    assert_refused(sn_muscle_set_tendon(&m, &(sn_tendon){INFINITY, 0}, &err), &err,
                   "muscle 'biceps': tendon length is inf, need >= 0");
    assert_refused(sn_muscle_set_tendon(&m, &(sn_tendon){0, -0.5}, &err), &err,
                   "muscle 'biceps': tendon area is -0.5, need >= 0");
    assert_int_equal(sn_muscle_set_tendon(&m, &(sn_tendon){0, NAN}, &err), SN_EINVAL);
    assert_true(m.tendon.length == 0.5 && m.tendon.area == 0.0);
    sn_muscle_free(&m);
}

/* Heads of lengths 10 and 4: ends within 5 % of 4 are shared. */
static void shared_ends(void **state)
{
    (void)state;
    const double a[] = {0, 0, 0, 10, 0, 0}, b[] = {10, 4, 0, 10, 0.19, 0}, c[] = {10, 4, 0, 10, 0.21, 0},
                 d[] = {0, 0.1, 0, 0, 4, 0};
    const sn_head_points insertion[] = {{a, NULL, 2}, {b, NULL, 2}}, none[] = {{a, NULL, 2}, {c, NULL, 2}},
                         origin[] = {{a, NULL, 2}, {d, NULL, 2}},
                         three[] = {{a, NULL, 2}, {b, NULL, 2}, {d, NULL, 2}};
    const struct {
        const sn_head_points *head;
        int32_t n;
        sn_shared_end want;
    } cases[] = {{insertion, 2, SN_SHARE_INSERTION},
                 {none, 2, SN_SHARE_NONE},
                 {origin, 2, SN_SHARE_ORIGIN},
                 {three, 3, SN_SHARE_NONE},
                 {origin, 1, SN_SHARE_INSERTION}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        sn_muscle m = made_muscle(cases[i].head, cases[i].n);
        assert_int_equal(sn_muscle_shared_end(&m), cases[i].want);
        sn_muscle_free(&m);
    }
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
    assert_int_equal(sn_muscle_init(&m, "x", &(sn_head_points){p, tissue, 3}, 1, NULL), SN_OK);
    const sn_spline *spline = &m.head[0].spline;
    for (int round = 0; round < 2; round++) /* the second time over the first */
        assert_int_equal(sn_collocate(&m, &b, l, &c, &notes, NULL), SN_OK);
    assert_int_equal(sn_trace_curve(&b, l, spline->seg, spline->n_seg, &t, NULL), SN_OK);
    assert_true(c.n_row > 10);
    assert_int_equal(c.n_row, t.n_piece);
    for (int32_t i = 0; i < c.n_row; i++) {
        const sn_trace_piece *q = &t.piece[i];
        assert_int_equal(c.tet[i], q->tet);
        assert_memory_equal(c.bary + 4 * i, q->bary, sizeof q->bary);
        assert_true(c.value[i] == tissue[q->i_seg] + q->s * (tissue[q->i_seg + 1] - tissue[q->i_seg]));
        assert_true(c.value[i] >= 1.0 && c.value[i] <= 3.0);
        int32_t i_seg; /* the row's length of curve leads back to its place */
        double at;
        sn_spline_at(spline, c.arc[i], &i_seg, &at);
        sn_vec3 there = sn_cubic_point(&spline->seg[i_seg], at);
        assert_true(sn_v3_dist(there, sn_cubic_point(&spline->seg[q->i_seg], q->s)) < 1e-6);
        assert_true(c.arc[i] > (i ? c.arc[i - 1] : 0.0) && c.arc[i] < sn_spline_length(spline));
        assert_int_equal(c.head[i], 0);
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

/* Rows of two heads are those of the one followed by those of the other. */
static void heads_follow_each_other(void **state)
{
    (void)state;
    sn_body b;
    sn_locator *l;
    make_body(&b, &l, 5);
    const double p[] = {0.7, 0.8, 0.9, 2, 3, 1, 4.1, 4, 4.2}, q[] = {1, 4, 0.5, 4.1, 4, 4.2},
                 out[] = {1, 4, 0.5, 1, 4, 3.5, 1, 4, 7}, away[] = {8, 8, 8, 9, 9, 9};
    sn_collocation all = {0}, part[2] = {{0}, {0}};
    sn_head_points head[] = {{p, NULL, 3}, {q, (double[]){2, 3}, 2}};
    sn_notes notes = {0};
    sn_error err;
    sn_muscle m = made_muscle(head, 2);
    assert_int_equal(sn_collocate(&m, &b, l, &all, NULL, NULL), SN_OK);
    sn_muscle_free(&m);
    for (int32_t i = 0, at = 0; i < 2; at += part[i++].n_row) {
        m = made_muscle(&head[i], 1);
        assert_int_equal(sn_collocate(&m, &b, l, &part[i], NULL, NULL), SN_OK);
        size_t n = (size_t)part[i].n_row, from = (size_t)at;
        assert_true(n > 5 && from + n <= (size_t)all.n_row);
        assert_memory_equal(all.tet + from, part[i].tet, n * sizeof *all.tet);
        assert_memory_equal(all.bary + 4 * from, part[i].bary, 4 * n * sizeof *all.bary);
        assert_memory_equal(all.value + from, part[i].value, n * sizeof *all.value);
        assert_memory_equal(all.arc + from, part[i].arc, n * sizeof *all.arc);
        for (size_t r = from; r < from + n; r++) assert_int_equal(all.head[r], i);
        sn_muscle_free(&m);
    }
    assert_int_equal(all.n_row, part[0].n_row + part[1].n_row);
    assert_true(all.length_inside == part[0].length_inside + part[1].length_inside);
    head[1] = (sn_head_points){out, NULL, 3};
    m = made_muscle(head, 2);
    assert_int_equal(sn_collocate(&m, &b, l, &all, &notes, NULL), SN_OK);
    assert_int_equal(notes.n_line, 1);
    assert_memory_equal(notes.line[0], "muscle 'biceps', head 2: ", 25);
    assert_non_null(strstr(notes.line[0], " of its curve's 6.5 lies outside the soft tissue"));
    sn_muscle_free(&m);
    head[1] = (sn_head_points){away, NULL, 2};
    m = made_muscle(head, 2);
    assert_int_equal(sn_collocate(&m, &b, l, &all, &notes, &err), SN_EINVAL);
    assert_string_equal(err.msg,
                        "muscle 'biceps', head 2: its curve never enters the soft tissue inside the skin");
    assert_true(all.n_row == 0 && !all.tet && !all.arc && !all.head);
    sn_muscle_free(&m);
    for (int i = 0; i < 2; i++) sn_collocation_free(&part[i]);
    sn_notes_free(&notes);
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
    assert_int_equal(sn_muscle_init(&m, "psoas", &(sn_head_points){half, NULL, 2}, 1, NULL), SN_OK);
    assert_int_equal(sn_collocate(&m, &b, l, &c, &notes, NULL), SN_OK);
    assert_true(fabs(c.length_inside - 2.5) < 0.15 && fabs(c.length_inside + c.length_outside - 5.0) < 1e-9);
    assert_int_equal(notes.n_line, 1);
    assert_memory_equal(notes.line[0], "muscle 'psoas': 2.", 18);
    assert_non_null(strstr(notes.line[0], " of its curve's 5 lies outside the soft tissue and is not used"));
    assert_int_equal(sn_collocate(&m, &b, l, &c, NULL, NULL), SN_OK);
    sn_muscle_free(&m);
    assert_int_equal(sn_muscle_init(&m, "psoas", &(sn_head_points){away, NULL, 2}, 1, NULL), SN_OK);
    assert_int_equal(sn_collocate(&m, &b, l, &c, &notes, &err), SN_EINVAL);
    assert_string_equal(err.msg, "muscle 'psoas': its curve never enters the soft tissue inside the skin");
    assert_true(c.n_row == 0 && !c.tet);
    sn_muscle_free(&m);
    assert_int_equal(sn_muscle_init(&m, "psoas", &(sn_head_points){barely, NULL, 2}, 1, NULL),
                     SN_OK); /* loses less than 1/200 */
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
        sn_muscle m = {0}, copy = {0};
        sn_collocation c = {0};
        sn_error err;
        sn_set_allocator(RATION(r));
        st = sn_muscle_init(&m, "x", both, 2, &err);
        if (!st) st = sn_muscle_copy(&copy, &m, &err);
        if (!st) st = sn_collocate(&m, &b, l, &c, NULL, &err);
        if (st) assert_int_equal(err.code, SN_ENOMEM);
        if (st) assert_memory_equal(err.msg, "muscle 'x'", 10);
        if (st) assert_non_null(strstr(err.msg, "no memory"));
        if (st) assert_true(c.n_row == 0);
        sn_collocation_free(&c);
        sn_muscle_free(&copy);
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
        cmocka_unit_test(a_copy_has_everything),
        cmocka_unit_test(bad_muscles_are_empty),
        cmocka_unit_test(frames_are_checked),
        cmocka_unit_test(pennations_are_checked),
        cmocka_unit_test(tendons_are_checked),
        cmocka_unit_test(shared_ends),
        cmocka_unit_test(rows_are_the_pieces_of_the_curve),
        cmocka_unit_test(heads_follow_each_other),
        cmocka_unit_test(curves_outside_are_noted_or_refused),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
