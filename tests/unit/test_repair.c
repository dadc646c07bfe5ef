/* test_repair - dirty surfaces with known faults, and what becomes of them. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "closed_surface.h"
#include "failing_memory.h"
#include "made_mesh.h"
#include "mesh/bvh.h"
#include "mesh/repair.h"

#include <math.h>
#include <string.h>

static sn_tri_mesh repaired(sn_tri_mesh *m, const sn_repair *opt, sn_repair_report *report)
{
    sn_repair_report own;
    sn_repair def = sn_repair_defaults();
    sn_error err = {SN_OK, ""};
    sn_tri_mesh out;
    sn_tri_mesh_init(&out);
    sn_status st = sn_repair_run(m, opt ? opt : &def, NULL, &out, report ? report : &own, &err);
    if (st) fail_msg("%s", err.msg);
    assert_closed_manifold(&out);
    assert_int_equal(count_crossings(&out), 0);
    assert_true(sn_tri_mesh_volume(&out) > 0.0);
    sn_tri_mesh_free(m);
    return out;
}

static void assert_fails(sn_tri_mesh *m, const sn_repair *opt, const sn_run *run, sn_status want, const char *text)
{
    sn_repair_report report;
    sn_error err = {SN_OK, ""};
    sn_tri_mesh out;
    sn_tri_mesh_init(&out);
    assert_int_equal(sn_repair_run(m, opt, run, &out, &report, &err), want);
    if (!strstr(err.msg, text)) fail_msg("'%s' does not say '%s'", err.msg, text);
    assert_null(out.face);
}

static int64_t count_of(const sn_repair_report *r, const char *step, const char *name)
{
    for (int i = 0; i < r->n_step; i++)
        for (int k = 0; k < r->step[i].n_count; k++)
            if (strcmp(r->step[i].name, step) == 0 && strcmp(r->step[i].count[k].name, name) == 0)
                return r->step[i].count[k].n;
    return -1;
}

static double moved_in(const sn_repair_report *r, const char *step)
{
    for (int i = 0; i < r->n_step; i++)
        if (strcmp(r->step[i].name, step) == 0) return r->step[i].moved;
    return -1.0;
}

static sn_tri_mesh unit_box(void)
{
    return made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1));
}

static void drop_faces(sn_tri_mesh *m, int32_t first, int32_t n)
{
    memmove(m->face + 3 * first, m->face + 3 * (first + n), 3 * (size_t)(m->n_face - first - n) * sizeof *m->face);
    m->n_face -= n;
}

static void add_faces(sn_tri_mesh *m, const int32_t *face, int32_t n)
{
    m->face = sn_realloc(m->face, 3 * (size_t)(m->n_face + n), sizeof *m->face);
    assert_non_null(m->face);
    memcpy(m->face + 3 * m->n_face, face, 3 * (size_t)n * sizeof *face);
    m->n_face += n;
}

static int32_t add_vertex(sn_tri_mesh *m, sn_vec3 p)
{
    m->pos = sn_realloc(m->pos, 3 * (size_t)(m->n_vert + 1), sizeof *m->pos);
    assert_non_null(m->pos);
    sn_v3_store(m->pos + 3 * m->n_vert, p);
    return m->n_vert++;
}

static void clean_surface_stays_as_it_is(void **state)
{
    sn_repair_report r;
    sn_tri_mesh m = made_sphere(sn_v3(1, 2, 3), 0.5, 0.1), before = made_sphere(sn_v3(1, 2, 3), 0.5, 0.1);
    (void)state;
    sn_tri_mesh out = repaired(&m, NULL, &r);
    assert_int_equal(out.n_vert, before.n_vert);
    assert_int_equal(out.n_face, before.n_face);
    assert_memory_equal(out.pos, before.pos, 3 * (size_t)out.n_vert * sizeof *out.pos);
    assert_memory_equal(out.face, before.face, 3 * (size_t)out.n_face * sizeof *out.face);
    assert_false(r.wrapped);
    assert_true(r.moved < 1e-12 && r.missed < 1e-12);
    assert_true(r.check.closed && r.check.components == 1);
    sn_tri_mesh_free(&out);
    sn_tri_mesh_free(&before);
}

/* A box of 12 faces with corners of their own, each shaken by less than half the tolerance. */
static void weld_joins_within_the_tolerance(void **state)
{
    sn_tri_mesh box = unit_box(), m;
    uint64_t h = 12345;
    (void)state;
    sn_tri_mesh_init(&m);
    assert_int_equal(sn_tri_mesh_reserve(&m, 36, 12, NULL), SN_OK);
    for (int32_t k = 0; k < 36; k++) {
        sn_vec3 p = sn_tri_mesh_point(&box, box.face[k]);
        sn_v3_store(m.pos + 3 * k, p);
        for (int i = 0; i < 3; i++) m.pos[3 * k + i] += 0.005 * (made_random(&h) - 0.5);
        m.face[k] = k;
    }
    sn_repair opt = sn_repair_defaults();
    opt.wrap = SN_WRAP_NEVER;
    opt.fill_holes = 0.0;
    assert_fails(&m, &opt, NULL, SN_EMESH, "boundary edges");
    opt.weld = 0.01;
    sn_repair_report r;
    sn_tri_mesh out = repaired(&m, &opt, &r);
    assert_int_equal(out.n_vert, 8);
    assert_int_equal(count_of(&r, "weld", "joined_vertices"), 28);
    assert_true(moved_in(&r, "weld") > 0.0 && moved_in(&r, "weld") <= 0.01);
    assert_true(fabs(sn_tri_mesh_volume(&out) - 1.0) < 0.02);
    sn_tri_mesh_free(&out);
    sn_tri_mesh_free(&box);
}

/* The tolerance may be any: vertices farther apart stay, those nearer go, on a line of them. */
static void weld_never_moves_farther_than_the_tolerance(void **state)
{
    (void)state;
    for (int scale = 0; scale < 3; scale++) {
        double unit = scale == 0 ? 1.0 : scale == 1 ? 1e-9 : 1e12;
        sn_tri_mesh m = made_sphere(sn_v3(0, 0, 0), 1.0, 0.05);
        scale_mesh(&m, unit);
        sn_repair opt = sn_repair_defaults();
        opt.weld = 0.02 * unit;
        sn_repair_report r;
        sn_tri_mesh out = repaired(&m, &opt, &r);
        assert_true(moved_in(&r, "weld") <= opt.weld);
        assert_true(r.moved <= opt.weld);
        for (int32_t i = 0; i < out.n_vert; i++)
            for (int32_t k = 0; k < i; k++)
                assert_true(sn_v3_dist(sn_tri_mesh_point(&out, i), sn_tri_mesh_point(&out, k)) > opt.weld);
        sn_tri_mesh_free(&out);
    }
}

static void duplicate_and_degenerate_faces_go(void **state)
{
    static const int32_t more[] = {0, 2, 1, 1, 2, 0, 4, 4, 5, 3, 3, 3};
    sn_tri_mesh m = unit_box();
    sn_repair_report r;
    (void)state;
    add_faces(&m, more, 4);
    (void)add_vertex(&m, sn_v3(0.5, 0.5, 0.5));
    sn_tri_mesh out = repaired(&m, NULL, &r);
    assert_int_equal(out.n_face, 12);
    assert_int_equal(out.n_vert, 8);
    assert_int_equal(count_of(&r, "clean", "duplicate_faces"), 2);
    assert_int_equal(count_of(&r, "clean", "degenerate_faces"), 2);
    assert_int_equal(count_of(&r, "clean", "unused_vertices"), 1);
    assert_true(fabs(sn_tri_mesh_volume(&out) - 1.0) < 1e-12);
    sn_tri_mesh_free(&out);
}

/* The middle of the diagonal of the bottom is a corner of the one half only, and a face without area fills
 * the slit between: taking the face out alone would open it. */
static void face_without_area_leaves_no_slit(void **state)
{
    sn_tri_mesh m = unit_box();
    sn_repair_report r;
    (void)state;
    int32_t v = add_vertex(&m, sn_v3(0.5, 0.5, 0)); /* bottom: 0 2 1 and 0 3 2 */
    const int32_t more[] = {0, v, 1, v, 2, 1, 0, 2, v};
    drop_faces(&m, 0, 1);
    add_faces(&m, more, 3);
    sn_repair opt = sn_repair_defaults();
    opt.wrap = SN_WRAP_NEVER;
    sn_tri_mesh out = repaired(&m, &opt, &r);
    assert_int_equal(count_of(&r, "clean", "degenerate_faces"), 1);
    assert_int_equal(out.n_vert, 9);
    assert_int_equal(out.n_face, 14);
    assert_true(fabs(sn_tri_mesh_volume(&out) - 1.0) < 1e-12);
    sn_tri_mesh_free(&out);
}

static void faces_are_turned_alike_and_outwards(void **state)
{
    sn_tri_mesh m = made_sphere(sn_v3(0, 0, 0), 1.0, 0.2);
    sn_repair_report r;
    (void)state;
    double volume = sn_tri_mesh_volume(&m);
    turn_faces(&m); /* inside out */
    for (int32_t f = 0; f < m.n_face; f += 7) {
        int32_t *v = m.face + 3 * f, swap = v[0];
        v[0] = v[1], v[1] = swap;
    }
    sn_tri_mesh out = repaired(&m, NULL, &r);
    assert_true(fabs(sn_tri_mesh_volume(&out) - volume) < 1e-12);
    assert_true(count_of(&r, "orient", "turned_faces") > 0);
    assert_true(r.moved < 1e-12);
    assert_false(r.wrapped);
    sn_tri_mesh_free(&out);
}

static void holes_are_filled_up_to_a_size(void **state)
{
    sn_repair opt = sn_repair_defaults();
    sn_repair_report r;
    (void)state;
    opt.wrap = SN_WRAP_NEVER;
    sn_tri_mesh m = unit_box();
    drop_faces(&m, 0, 2); /* the rim has a diagonal of sqrt(2) */
    opt.fill_holes = 1.41;
    assert_fails(&m, &opt, NULL, SN_EMESH, "what remains: 4 boundary edges; fill_holes closes larger holes");
    opt.fill_holes = 1.42;
    sn_tri_mesh out = repaired(&m, &opt, &r);
    assert_int_equal(count_of(&r, "fill", "filled_holes"), 1);
    assert_int_equal(count_of(&r, "fill", "added_faces"), 2);
    assert_int_equal(count_of(&r, "fill", "left_holes"), 0);
    assert_true(fabs(sn_tri_mesh_volume(&out) - 1.0) < 1e-12);
    assert_true(fabs(moved_in(&r, "fill") - 0.5) < 1e-9); /* the middle of the filling from the rim */
    sn_tri_mesh_free(&out);
}

/* Two unit balls at a distance of 1: V = 2 (4/3) pi - 5/12 pi, that is 27/16 of a ball. */
static void crossing_balls_become_their_union(void **state)
{
    sn_repair opt = sn_repair_defaults();
    sn_repair_report r;
    (void)state;
    opt.wrap = SN_WRAP_NEVER;
    sn_tri_mesh m = made_sphere(sn_v3(0, 0, 0), 1.0, 0.15), b = made_sphere(sn_v3(1, 0.013, 0.007), 1.0, 0.15);
    double ball = sn_tri_mesh_volume(&m);
    append_mesh(&m, &b, 0);
    sn_tri_mesh out = repaired(&m, &opt, &r);
    assert_int_equal(count_parts(&out), 1);
    assert_int_equal(count_of(&r, "untangle", "unions"), 1);
    assert_true(count_of(&r, "untangle", "crossings_before") > 0);
    assert_int_equal(count_of(&r, "untangle", "crossings_after"), 0);
    assert_true(fabs(sn_tri_mesh_volume(&out) / ball - 27.0 / 16.0) < 0.01);
    assert_true(r.moved < 1e-9); /* a union has only points of its parts */
    assert_true(r.missed < 1e-9);
    sn_tri_mesh_free(&out);
}

static void crossings_can_be_left_to_nobody(void **state)
{
    sn_repair opt = sn_repair_defaults();
    (void)state;
    sn_tri_mesh m = unit_box(), b = made_box(sn_v3(0.5, 0.4, 0.3), sn_v3(1.5, 1.4, 1.3));
    append_mesh(&m, &b, 0);
    opt.untangle = false;
    opt.wrap = SN_WRAP_NEVER;
    assert_fails(&m, &opt, NULL, SN_EMESH, "self-intersections; self_intersections = true resolves them");
    sn_tri_mesh_free(&m);
}

/* A hollow ball holds a ball in its cavity; in its wall lies a box. */
static void inner_components(void **state)
{
    (void)state;
    for (int turned = 0; turned < 2; turned++) {
        sn_tri_mesh m = made_sphere(sn_v3(0, 0, 0), 1.0, 0.2), cavity = made_sphere(sn_v3(0, 0, 0), 0.6, 0.2);
        sn_tri_mesh inner = made_sphere(sn_v3(0, 0, 0), 0.2, 0.1);
        sn_tri_mesh box = made_box(sn_v3(0.75, -0.05, -0.05), sn_v3(0.85, 0.05, 0.05));
        double want = sn_tri_mesh_volume(&m) - sn_tri_mesh_volume(&cavity) + sn_tri_mesh_volume(&inner);
        double largest = sn_tri_mesh_volume(&m) - sn_tri_mesh_volume(&cavity) + sn_tri_mesh_volume(&inner);
        turn_faces(&cavity);
        append_mesh(&m, &cavity, 0);
        append_mesh(&m, &inner, 0);
        append_mesh(&m, &box, 0);
        if (turned) turn_faces(&m);
        sn_repair_report r;
        sn_tri_mesh out = repaired(&m, NULL, &r);
        assert_int_equal(count_parts(&out), 3);
        assert_int_equal(count_of(&r, "components", "removed_inside"), 1);
        assert_int_equal(count_of(&r, "components", "turned"), turned ? 3 : 0);
        assert_true(fabs(sn_tri_mesh_volume(&out) - want) < 1e-9);
        sn_tri_mesh apart = made_box(sn_v3(3, 0, 0), sn_v3(3.5, 0.5, 0.5));
        append_mesh(&out, &apart, 0);
        sn_repair opt = sn_repair_defaults();
        opt.largest = true;
        sn_tri_mesh one = repaired(&out, &opt, &r);
        assert_int_equal(count_of(&r, "components", "removed_others"), 1);
        assert_true(fabs(sn_tri_mesh_volume(&one) - largest) < 1e-9);
        sn_tri_mesh_free(&one);
    }
}

/* Triangles of a ball, each a little apart from its neighbours: nothing to weld, hundreds of rims. */
static sn_tri_mesh made_soup(double unit)
{
    sn_tri_mesh ball = made_sphere(sn_v3(0, 0, 0), 1.0, 0.15), m;
    sn_tri_mesh_init(&m);
    assert_int_equal(sn_tri_mesh_reserve(&m, 3 * ball.n_face, ball.n_face, NULL), SN_OK);
    for (int32_t k = 0; k < 3 * ball.n_face; k++) {
        double grow = k / 3 % 2 ? 1.0005 : 0.9995;
        sn_v3_store(m.pos + 3 * k, sn_v3_scale(grow * unit, sn_tri_mesh_point(&ball, ball.face[k])));
        m.face[k] = k;
    }
    sn_tri_mesh_free(&ball);
    return m;
}

static void soup_is_wrapped_within_the_tolerance(void **state)
{
    sn_repair opt = sn_repair_defaults();
    sn_repair_report r;
    (void)state;
    opt.tolerance = 0.06;
    sn_tri_mesh m = made_soup(1.0), soup = made_soup(1.0);
    sn_tri_mesh out = repaired(&m, &opt, &r);
    assert_true(r.wrapped);
    assert_int_equal(count_parts(&out), 1);
    assert_true(r.moved > 0.0 && r.moved <= 0.06 && r.missed <= 0.06);
    assert_true(fabs(sn_tri_mesh_volume(&out) / (4.0 / 3.0 * TEST_PI) - 1.0) < 0.05);
    sn_bvh *b; /* the report is right: every vertex and center by itself */
    double far = 0.0;
    assert_int_equal(sn_bvh_create(&b, &soup, NULL), SN_OK);
    for (int32_t i = 0; i < out.n_vert; i++) far = fmax(far, sn_bvh_closest(b, sn_tri_mesh_point(&out, i)).dist);
    assert_true(far <= r.moved);
    sn_bvh_destroy(b);
    sn_tri_mesh_free(&out);
    sn_tri_mesh_free(&soup);
}

/* The wrap is as fine as its alpha only where it would be too far away. */
static void wrap_of_a_smooth_surface_has_few_faces(void **state)
{
    int32_t n_face[2];
    (void)state;
    for (int same = 0; same < 2; same++) {
        sn_repair opt = sn_repair_defaults();
        sn_repair_report r;
        sn_tri_mesh m = made_soup(1.0);
        opt.wrap = SN_WRAP_ALWAYS;
        opt.tolerance = 0.12;
        opt.alpha = same ? 0.06 : 0.0;
        sn_tri_mesh out = repaired(&m, &opt, &r);
        assert_true(r.moved <= opt.tolerance);
        assert_true(fabs(r.alpha - 0.06) < 1e-12);
        n_face[same] = out.n_face;
        sn_tri_mesh_free(&out);
    }
    assert_true(n_face[0] < n_face[1] / 3);
}

static void wrap_that_cannot_keep_the_tolerance_is_refused(void **state)
{
    sn_repair opt = sn_repair_defaults();
    (void)state;
    sn_tri_mesh m = made_soup(1.0);
    opt.tolerance = 0.01;
    opt.alpha = 0.3; /* bridges, and its offset alone is too much */
    opt.offset = 0.05;
    assert_fails(&m, &opt, NULL, SN_EMESH, "away from the surface, the tolerance is 0.01: a smaller alpha");
    sn_tri_mesh_free(&m);
}

/* Half a box: the wrap goes in through the open side, unless that is filled. */
static void wrap_of_an_open_bowl_is_a_shell(void **state)
{
    sn_repair opt = sn_repair_defaults();
    (void)state;
    opt.wrap = SN_WRAP_ALWAYS;
    opt.tolerance = 0.05;
    sn_tri_mesh m = unit_box();
    drop_faces(&m, 0, 2);
    opt.fill_holes = 0.5;
    assert_fails(&m, &opt, NULL, SN_EMESH, "went in through a hole");
    sn_tri_mesh_free(&m);
    for (int i = 0; i < 2; i++) { /* by default it is filled when that shows */
        opt.fill_holes = i ? -1.0 : 2.0;
        sn_repair_report r;
        m = unit_box();
        drop_faces(&m, 0, 2);
        sn_tri_mesh out = repaired(&m, &opt, &r);
        assert_true(r.wrapped);
        assert_true(fabs(sn_tri_mesh_volume(&out) - 1.0) < 0.1);
        sn_tri_mesh_free(&out);
    }
}

static void same_for_any_unit(void **state)
{
    (void)state;
    for (int wrap = 0; wrap < 2; wrap++) {
        sn_tri_mesh out[2];
        sn_repair_report r[2];
        for (int i = 0; i < 2; i++) {
            sn_tri_mesh m = made_soup(1.0);
            if (!wrap) {
                sn_tri_mesh ball = made_sphere(sn_v3(0, 0, 0), 1.0, 0.2);
                sn_tri_mesh other = made_sphere(sn_v3(1, 0.1, 0), 1.0, 0.2);
                sn_tri_mesh_free(&m);
                m = ball;
                append_mesh(&m, &other, 0);
                drop_faces(&m, 0, 2);
            }
            scale_mesh(&m, i ? 1024.0 : 1.0);
            sn_repair opt = sn_repair_defaults();
            opt.tolerance = wrap ? (i ? 1024.0 : 1.0) * 0.08 : 0.0;
            out[i] = repaired(&m, &opt, &r[i]);
        }
        assert_int_equal(r[0].wrapped, wrap);
        assert_int_equal(r[1].wrapped, wrap);
        assert_int_equal(r[0].n_step, r[1].n_step);
        double v = sn_tri_mesh_volume(&out[0]);
        assert_true(fabs(sn_tri_mesh_volume(&out[1]) / (1024.0 * 1024.0 * 1024.0) / v - 1.0) < (wrap ? 1e-3 : 1e-9));
        assert_true(fabs(r[1].moved / 1024.0 - r[0].moved) < (wrap ? 0.01 : 1e-9));
        sn_tri_mesh_free(&out[0]);
        sn_tri_mesh_free(&out[1]);
    }
}

static void same_every_time(void **state)
{
    sn_tri_mesh first;
    (void)state;
    sn_tri_mesh_init(&first);
    for (int i = 0; i < 2; i++) {
        sn_tri_mesh m = made_soup(1.0), out;
        sn_run run = {.n_threads = 1 + i};
        sn_repair opt = sn_repair_defaults();
        sn_repair_report r;
        opt.tolerance = 0.1;
        sn_tri_mesh_init(&out);
        void *hole = malloc(12345 * (size_t)(i + 1)); /* another heap */
        assert_int_equal(sn_repair_run(&m, &opt, &run, &out, &r, NULL), SN_OK);
        free(hole);
        sn_tri_mesh_free(&m);
        if (i == 0) {
            first = out;
            continue;
        }
        assert_int_equal(out.n_vert, first.n_vert);
        assert_memory_equal(out.pos, first.pos, 3 * (size_t)out.n_vert * sizeof *out.pos);
        assert_memory_equal(out.face, first.face, 3 * (size_t)out.n_face * sizeof *out.face);
        sn_tri_mesh_free(&out);
    }
    sn_tri_mesh_free(&first);
}

static void stops_when_told_to(void **state)
{
    static const volatile sig_atomic_t stop = 1;
    sn_repair opt = sn_repair_defaults();
    sn_tri_mesh m = made_soup(1.0);
    (void)state;
    assert_fails(&m, &opt, &(sn_run){.cancel = &stop}, SN_ECANCEL, "interrupted");
    opt.tolerance = 0.004; /* a wrap of half a minute */
    opt.wrap = SN_WRAP_ALWAYS;
    opt.fill_holes = 0.0;
    opt.time_limit = 0.2;
    assert_fails(&m, &opt, NULL, SN_ELIMIT, "time limit of 0.2 s reached");
    opt.time_limit = 0.0;
    assert_fails(&m, &opt, &(sn_run){.deadline = sn_clock() + 0.5}, SN_ELIMIT, "time limit reached");
    sn_tri_mesh_free(&m);
}

static void wrong_options_are_named(void **state)
{
    sn_repair good = sn_repair_defaults(), opt = good;
    sn_tri_mesh m = unit_box();
    (void)state;
    opt.tolerance = -1.0;
    assert_fails(&m, &opt, NULL, SN_EINVAL, "tolerance is -1, need a finite number >= 0");
    opt = good, opt.alpha = NAN;
    assert_fails(&m, &opt, NULL, SN_EINVAL, "alpha is nan");
    opt = good, opt.offset = INFINITY;
    assert_fails(&m, &opt, NULL, SN_EINVAL, "offset is inf");
    opt = good, opt.weld = NAN;
    assert_fails(&m, &opt, NULL, SN_EINVAL, "weld is nan");
    opt = good, opt.wrap = (sn_wrap)7;
    assert_fails(&m, &opt, NULL, SN_EINVAL, "wrap is 7, need auto, always or never");
    opt = good, opt.weld = 5.0;
    assert_fails(&m, &opt, NULL, SN_EMESH, "no face has an area that the weld tolerance of 5 leaves");
    for (int k = 0; k < 24; k++) m.pos[k] = 3.0;
    assert_fails(&m, &good, NULL, SN_EINVAL, "the surface has an extent of 0");
    sn_tri_mesh_free(&m);
}

/* Every allocation of the parent fails once; what the child makes may fail in the child. */
static void no_memory_is_an_error(void **state)
{
    failing f = {0, 0};
    sn_tri_mesh m = unit_box(), out;
    sn_repair opt = sn_repair_defaults();
    sn_repair_report r;
    sn_status st = SN_ENOMEM;
    (void)state;
    drop_faces(&m, 0, 1);
    opt.fill_holes = 2.0;
    opt.wrap = SN_WRAP_NEVER;
    opt.memory_limit = 0;
    sn_tri_mesh_init(&out);
    for (int n = 0; st && n < 2000; n++) {
        f = (failing){n, 0};
        sn_set_allocator(&(sn_allocator){failing_realloc, &f});
        st = sn_repair_run(&m, &opt, NULL, &out, &r, NULL);
        if (st) assert_int_equal(st, SN_ENOMEM);
        sn_tri_mesh_free(&out);
        sn_set_allocator(NULL);
        assert_int_equal(f.n_alive, 0);
    }
    assert_int_equal(st, SN_OK);
    sn_tri_mesh_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clean_surface_stays_as_it_is),
        cmocka_unit_test(weld_joins_within_the_tolerance),
        cmocka_unit_test(weld_never_moves_farther_than_the_tolerance),
        cmocka_unit_test(duplicate_and_degenerate_faces_go),
        cmocka_unit_test(face_without_area_leaves_no_slit),
        cmocka_unit_test(faces_are_turned_alike_and_outwards),
        cmocka_unit_test(holes_are_filled_up_to_a_size),
        cmocka_unit_test(crossing_balls_become_their_union),
        cmocka_unit_test(crossings_can_be_left_to_nobody),
        cmocka_unit_test(inner_components),
        cmocka_unit_test(soup_is_wrapped_within_the_tolerance),
        cmocka_unit_test(wrap_of_a_smooth_surface_has_few_faces),
        cmocka_unit_test(wrap_that_cannot_keep_the_tolerance_is_refused),
        cmocka_unit_test(wrap_of_an_open_bowl_is_a_shell),
        cmocka_unit_test(same_for_any_unit),
        cmocka_unit_test(same_every_time),
        cmocka_unit_test(stops_when_told_to),
        cmocka_unit_test(wrong_options_are_named),
        cmocka_unit_test(no_memory_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
