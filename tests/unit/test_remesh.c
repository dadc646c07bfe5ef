/* test_remesh - isotropic remeshing: what must stay (borders, creases, volume, no crossings) and what must
 * get better. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "mesh/mesh_check.h"
#include "mesh/remesh.h"
#include "mesh/shape.h"

#include "closed_surface.h"
#include "made_mesh.h"

#include <stdio.h>

static sn_remesh_report report;

static sn_tri_mesh remeshed_with(const sn_tri_mesh *in, const sn_remesh *opt, const sn_run *run)
{
    sn_tri_mesh out;
    sn_error err = {.msg = ""};
    sn_tri_mesh_init(&out);
    if (sn_remesh_run(in, opt, run, &out, &report, &err)) fail_msg("%s", err.msg);
    assert_closed_manifold(&out);
    assert_int_equal(out.n_face, in->n_face + 2 * (report.splits - report.collapses));
    assert_int_equal(report.crossings_after, count_crossings(&out));
    return out;
}

static sn_tri_mesh remeshed(const sn_tri_mesh *in, double edge_length)
{
    return remeshed_with(in, &(sn_remesh){.edge_length = edge_length}, NULL);
}

typedef struct lengths {
    double mean, min, max;
} lengths;

static lengths edge_lengths(const sn_tri_mesh *m)
{
    lengths l = {0.0, INFINITY, 0.0};
    for (int32_t i = 0; i < 3 * m->n_face; i++) {
        double d = sn_v3_dist(sn_tri_mesh_point(m, m->face[i]),
                              sn_tri_mesh_point(m, m->face[i % 3 == 2 ? i - 2 : i + 1]));
        l.mean += d / (3 * m->n_face);
        l.min = fmin(l.min, d);
        l.max = fmax(l.max, d);
    }
    return l;
}

static double smallest_height(const sn_tri_mesh *m)
{
    double least = INFINITY;
    for (int32_t f = 0; f < m->n_face; f++) {
        const int32_t *v = m->face + 3 * (size_t)f;
        sn_vec3 a = sn_tri_mesh_point(m, v[0]), b = sn_tri_mesh_point(m, v[1]),
                c = sn_tri_mesh_point(m, v[2]);
        double longest = fmax(sn_v3_dist(a, b), fmax(sn_v3_dist(b, c), sn_v3_dist(c, a)));
        least = fmin(least, sn_v3_len(sn_tri_mesh_face_normal(m, f)) / longest);
    }
    return least;
}

/* ---- what gets better ---- */

static void sphere_gets_the_wanted_edges(void **state)
{
    (void)state;
    sn_tri_mesh in = made_sphere(sn_v3(0, 0, 0), 1.0, 0.1);
    const double want[] = {0.3, 0.2, 0.08};
    for (int i = 0; i < 3; i++) {
        sn_tri_mesh out = remeshed(&in, want[i]);
        lengths l = edge_lengths(&out);
        assert_true(l.mean > 0.85 * want[i] && l.mean < 1.1 * want[i]);
        assert_true(l.min > 0.3 * want[i] && l.max < 1.5 * want[i]);
        assert_true(smallest_height(&out) > 0.2 * want[i]);
        assert_int_equal(report.crossings_after, 0);
        assert_int_equal(euler_characteristic(&out), 2);
        assert_true(fabs(sn_tri_mesh_volume(&out) / sn_tri_mesh_volume(&in) - 1.0) < 1e-3);
        for (int32_t v = 0; v < out.n_vert; v++) /* the input's faces dip by 0.1^2 / 8 */
            assert_true(fabs(sn_v3_len(sn_tri_mesh_point(&out, v)) - 1.0) < 0.08 * want[i] + 2e-3);
        assert_true(report.largest_move <= 0.16 * want[i]);
        sn_tri_mesh_free(&out);
    }
    sn_tri_mesh_free(&in);
}

/* A surface from a lattice has slivers where it passes close to a lattice point. On a round surface they bend
 * by any angle: taken for creases, they and their short edges would stay. */
static void slivers_are_no_creases(void **state)
{
    (void)state;
    sn_shape *ball = NULL;
    sn_tri_mesh m;
    sn_tri_mesh_init(&m);
    assert_int_equal(sn_shape_sphere(&ball, sn_v3(0.03, 0.01, 0.02), 1.0, NULL), SN_OK);
    assert_int_equal(sn_shape_mesh(ball, 0.2, NULL, &m, NULL), SN_OK);
    sn_shape_release(ball);
    lengths l = edge_lengths(&m);
    assert_true(l.mean > 0.17 && l.min > 0.08); /* 0.001 and 3 % below 0.004 when slivers count */
    assert_true(smallest_height(&m) > 0.05);
    sn_tri_mesh_free(&m);
}

static void labels_have_lengths_of_their_own(void **state)
{
    (void)state;
    const double length[2] = {0.25, 0.1};
    sn_tri_mesh in = made_sphere(sn_v3(-2, 0, 0), 1.0, 0.2), other = made_sphere(sn_v3(2, 0, 0), 1.0, 0.2);
    in.label = SN_NEW_ZERO(int32_t, in.n_face);
    append_mesh(&in, &other, 1);
    sn_tri_mesh out =
        remeshed_with(&in, &(sn_remesh){.edge_length = 0.2, .label_length = length, .n_label = 2}, NULL);
    int32_t n[2] = {0, 0};
    for (int32_t f = 0; f < out.n_face; f++) {
        assert_true(out.label[f] == (sn_tri_mesh_point(&out, out.face[3 * f]).x > 0.0));
        n[out.label[f]]++;
    }
    double ideal[2]; /* 4 pi over the area of a regular triangle */
    for (int i = 0; i < 2; i++) ideal[i] = 4.0 * TEST_PI / (0.4330127 * length[i] * length[i]);
    for (int i = 0; i < 2; i++) assert_true(n[i] > 0.8 * ideal[i] && n[i] < 1.5 * ideal[i]);
    sn_tri_mesh_free(&out);
    sn_tri_mesh_free(&in);
}

/* ---- what stays ---- */

/* All of the box's surface, and nothing but: every face lies in one side, and the area is whole. */
static void assert_is_box(const sn_tri_mesh *m, sn_vec3 half, double tolerance)
{
    const double h[3] = {half.x, half.y, half.z};
    int corners = 0;
    for (int32_t f = 0; f < m->n_face; f++) {
        bool in_side = false;
        for (int k = 0; k < 6; k++) {
            bool all = true;
            for (int c = 0; c < 3; c++) {
                double x = m->pos[3 * (size_t)m->face[3 * (size_t)f + (size_t)c] + (size_t)(k / 2)];
                all = all && fabs(x - (k % 2 ? h[k / 2] : -h[k / 2])) < tolerance;
            }
            in_side = in_side || all;
        }
        assert_true(in_side);
    }
    for (int32_t v = 0; v < m->n_vert; v++) {
        const double *p = m->pos + 3 * (size_t)v;
        corners +=
            fabs(p[0]) > h[0] - tolerance && fabs(p[1]) > h[1] - tolerance && fabs(p[2]) > h[2] - tolerance;
    }
    assert_int_equal(corners, 8);
    assert_true(fabs(sn_tri_mesh_volume(m) / (8.0 * h[0] * h[1] * h[2]) - 1.0) < 1e-9);
    assert_true(fabs(sn_tri_mesh_area(m) / (8.0 * (h[0] * h[1] + h[1] * h[2] + h[2] * h[0])) - 1.0) < 1e-9);
}

static void box_stays_sharp(void **state)
{
    (void)state;
    sn_vec3 half = {1.0, 0.6, 0.4};
    sn_tri_mesh box = made_box(sn_v3_scale(-1.0, half), half);
    sn_tri_mesh fine = remeshed(&box, 0.1);
    assert_is_box(&fine, half, 1e-12);
    lengths l = edge_lengths(&fine);
    assert_true(l.mean > 0.07 && l.mean < 0.12 && l.max < 0.14);
    sn_tri_mesh coarse = remeshed(&fine, 0.35); /* and back */
    assert_is_box(&coarse, half, 1e-12);
    l = edge_lengths(&coarse);
    assert_true(l.mean > 0.25 && l.max < 0.5);
    assert_int_equal(report.crossings_after, 0);
    sn_tri_mesh_free(&box);
    sn_tri_mesh_free(&fine);
    sn_tri_mesh_free(&coarse);
}

/* Faces of a big turned box against a small target: their boxes hold a million grid cells each. */
static void few_big_faces_and_a_fine_target(void **state)
{
    (void)state;
    sn_tri_mesh box = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1));
    sn_transform turn = {1.0, {1, 2, 3}, 40.0, {0, 0, 0}};
    assert_int_equal(sn_tri_mesh_transform(&box, &turn, NULL), SN_OK);
    double start = sn_clock();
    sn_tri_mesh out = remeshed_with(&box, &(sn_remesh){.edge_length = 0.02, .iterations = 1}, NULL);
    assert_true(sn_clock() - start < 20.0);
    assert_true(fabs(sn_tri_mesh_volume(&out) - 1.0) < 1e-9);
    assert_true(out.n_face > 30000);
    sn_tri_mesh_free(&box);
    sn_tri_mesh_free(&out);
}

static void border_between_labels_stays(void **state)
{
    (void)state;
    sn_tri_mesh box = made_box(sn_v3(-1, -1, -1), sn_v3(1, 1, 1)), fine = remeshed(&box, 0.15);
    /* Cut by the label at a jagged line: its vertices are where they are, and its length is known. */
    fine.label = SN_NEW(int32_t, fine.n_face);
    double area[2] = {0, 0}, got[2] = {0, 0}, length = 0.0, got_length = 0.0;
    for (int pass = 0; pass < 2; pass++) {
        sn_tri_mesh out;
        if (pass == 1) out = remeshed(&fine, 0.3);
        sn_tri_mesh *m = pass ? &out : &fine;
        for (int32_t f = 0; f < m->n_face; f++) {
            sn_vec3 p[3];
            for (int k = 0; k < 3; k++) p[k] = sn_tri_mesh_point(m, m->face[3 * f + k]);
            if (pass == 0) m->label[f] = p[0].z + p[1].z + p[2].z > 0.0 ? 3 : 1;
            (pass ? got : area)[m->label[f] == 3] += 0.5 * sn_v3_len(sn_tri_mesh_face_normal(m, f));
        }
        for (int32_t i = 0; i < 3 * m->n_face; i++) /* half-edges of label 3 whose other side is label 1 */
            for (int32_t j = 0; j < 3 * m->n_face && m->label[i / 3] == 3; j++) {
                int32_t to_i = m->face[i % 3 == 2 ? i - 2 : i + 1],
                        to_j = m->face[j % 3 == 2 ? j - 2 : j + 1];
                if (m->face[i] != to_j || m->face[j] != to_i || m->label[j / 3] != 1) continue;
                *(pass ? &got_length : &length) +=
                    sn_v3_dist(sn_tri_mesh_point(m, m->face[i]), sn_tri_mesh_point(m, to_i));
            }
        if (pass == 1) {
            assert_is_box(&out, sn_v3(1, 1, 1), 1e-9);
            sn_tri_mesh_free(&out);
        }
    }
    assert_true(fabs(got[0] / area[0] - 1.0) < 0.02 && fabs(got[1] / area[1] - 1.0) < 0.02);
    assert_true(fabs(got[0] + got[1] - area[0] - area[1]) < 1e-9);
    assert_true(got_length <= length + 1e-9 && got_length > 0.8 * length);
    sn_tri_mesh_free(&box);
    sn_tri_mesh_free(&fine);
}

static void straight_border_stays_exactly(void **state)
{
    (void)state;
    /* Two boxes of 6 x 6 x 6 lattice cubes side by side, their common skin: the border is the square x = 3.
     */
    sn_tet_mesh tets = made_lattice(6, sn_v3(0, 0, 0), 1.0);
    sn_tri_mesh in;
    sn_tri_mesh_init(&in);
    assert_int_equal(sn_tet_mesh_surface(&tets, -1, &in, NULL, NULL), SN_OK);
    in.label = SN_NEW(int32_t, in.n_face);
    for (int32_t f = 0; f < in.n_face; f++) {
        double x = 0.0;
        for (int k = 0; k < 3; k++) x += in.pos[3 * in.face[3 * f + k]];
        in.label[f] = x > 9.0;
    }
    const double targets[] = {2.0, 0.5};
    for (int i = 0; i < 2; i++) {
        sn_tri_mesh out = remeshed(&in, targets[i]);
        double area[2] = {0, 0};
        for (int32_t f = 0; f < out.n_face; f++) {
            for (int k = 0; k < 3; k++) {
                double x = out.pos[3 * out.face[3 * f + k]];
                assert_true(out.label[f] ? x >= 3.0 - 1e-12 : x <= 3.0 + 1e-12);
            }
            area[out.label[f]] += 0.5 * sn_v3_len(sn_tri_mesh_face_normal(&out, f));
        }
        assert_true(fabs(area[0] - 108.0) < 1e-9 && fabs(area[1] - 108.0) < 1e-9); /* 36 + 4 * 18 */
        sn_tri_mesh_free(&out);
    }
    sn_tri_mesh_free(&in);
    sn_tet_mesh_free(&tets);
}

static void thin_bone_keeps_its_volume(void **state)
{
    (void)state;
    sn_tri_mesh in = made_capsule(sn_v3(0, 0, 0), sn_v3(0.6, 0.7, 0.9), 0.1, 0.04);
    sn_tri_mesh out = remeshed(&in, 0.15); /* six edges around */
    assert_true(fabs(sn_tri_mesh_volume(&out) / sn_tri_mesh_volume(&in) - 1.0) < 0.02);
    assert_int_equal(report.crossings_after, 0);
    sn_tri_mesh_free(&in);
    sn_tri_mesh_free(&out);
}

/* ---- what must not cross ---- */

static void thin_plates_do_not_cross(void **state)
{
    (void)state;
    sn_tri_mesh in = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 0.006));
    for (int i = 1; i < 4; i++) { /* plates of 3/100 of the edge length, 2/100 apart */
        sn_tri_mesh more =
            made_box(sn_v3(0.1 * i, 0.05, 0.01 * i), sn_v3(1 + 0.1 * i, 0.9, 0.01 * i + 0.006));
        append_mesh(&in, &more, 0);
    }
    sn_transform turn = {1.0, {3, -1, 2}, 25.0, {0, 0, 0}};
    assert_int_equal(sn_tri_mesh_transform(&in, &turn, NULL), SN_OK);
    double volume = sn_tri_mesh_volume(&in);
    sn_tri_mesh out = remeshed(&in, 0.2);
    assert_int_equal(report.crossings_before, 0);
    assert_int_equal(report.crossings_after, 0);
    assert_int_equal(count_parts(&out), 4);
    assert_true(fabs(sn_tri_mesh_volume(&out) / volume - 1.0) < 0.02);
    sn_tri_mesh_free(&in);
    sn_tri_mesh_free(&out);
}

/* A shell of 1/100 of its radius, remeshed so coarsely that chords of the outer sphere would cut the inner
 * one: 0.5^2 / 8 = 0.03. */
static void thin_round_shell_does_not_cross(void **state)
{
    (void)state;
    sn_tri_mesh in = made_sphere(sn_v3(0, 0, 0), 1.0, 0.15), outer = made_sphere(sn_v3(0, 0, 0), 1.0, 0.15);
    turn_faces(&in);
    scale_mesh(&outer, 1.01);
    append_mesh(&in, &outer, 0);
    sn_tri_mesh out = remeshed(&in, 0.5);
    assert_int_equal(report.crossings_before, 0);
    assert_int_equal(report.crossings_after, 0);
    assert_true(report.refused > 0);
    assert_int_equal(count_parts(&out), 2);
    assert_true(out.n_face < in.n_face / 2);
    sn_tri_mesh_free(&in);
    sn_tri_mesh_free(&out);
}

static void crossings_of_the_input_are_reported(void **state)
{
    (void)state;
    sn_tri_mesh in = made_sphere(sn_v3(0, 0, 0), 1.0, 0.3),
                other = made_sphere(sn_v3(0.71, 0.13, 0.17), 1.0, 0.3);
    append_mesh(&in, &other, 0);
    int before = count_crossings(&in);
    assert_true(before > 0);
    sn_tri_mesh out = remeshed(&in, 0.3);
    assert_int_equal(report.crossings_before, before);
    assert_true(report.crossings_after > 0); /* the faces got smaller, so there may be more pairs */
    sn_tri_mesh_free(&in);
    sn_tri_mesh_free(&out);
}

/* A vertex on an edge of its neighbour: a face without area, closed all the same. */
static void face_without_area_goes(void **state)
{
    (void)state;
    sn_tri_mesh in = made_box(sn_v3(-1, -1, -1), sn_v3(1, 1, 1)), m;
    sn_tri_mesh_init(&m);
    assert_int_equal(sn_tri_mesh_reserve(&m, 9, 14, NULL), SN_OK);
    memcpy(m.pos, in.pos, 24 * sizeof *m.pos);
    memcpy(m.face, in.face, 36 * sizeof *m.face);
    sn_v3_store(m.pos + 24,
                sn_v3(0, 0, -1)); /* the middle of edge (0, 2), of faces (0, 2, 1) and (0, 3, 2) */
    const int32_t face[] = {0, 8, 1, 8, 2, 1, 0, 2, 8};
    memcpy(m.face, face, 3 * sizeof *face);
    memcpy(m.face + 36, face + 3, 6 * sizeof *face);
    assert_closed_manifold(&m);
    sn_tri_mesh out = remeshed(&m, 1.2);
    assert_is_box(&out, sn_v3(1, 1, 1), 1e-9);
    assert_true(smallest_height(&out) > 0.05);
    sn_tri_mesh_free(&in);
    sn_tri_mesh_free(&m);
    sn_tri_mesh_free(&out);
}

/* ---- determinism ---- */

static void same_bits_with_any_threads(void **state)
{
    (void)state;
    sn_tri_mesh in = made_sphere(sn_v3(0, 0, 0), 1.0, 0.12), first;
    for (int n = 1; n <= 3; n++) {
        sn_tri_mesh out = remeshed_with(&in, &(sn_remesh){.edge_length = 0.1}, &(sn_run){.n_threads = n});
        if (n == 1) {
            first = out;
            continue;
        }
        assert_int_equal(out.n_vert, first.n_vert);
        assert_int_equal(out.n_face, first.n_face);
        assert_memory_equal(out.pos, first.pos, 3 * (size_t)out.n_vert * sizeof *out.pos);
        assert_memory_equal(out.face, first.face, 3 * (size_t)out.n_face * sizeof *out.face);
        sn_tri_mesh_free(&out);
    }
    sn_tri_mesh_free(&first);
    sn_tri_mesh_free(&in);
}

static void unit_of_length_does_not_matter(void **state)
{
    (void)state;
    sn_tri_mesh in = made_sphere(sn_v3(0, 0, 0), 1.0, 0.2);
    sn_tri_mesh small = remeshed(&in, 0.15);
    scale_mesh(&in, 1024.0); /* a power of two: exact */
    sn_tri_mesh large = remeshed(&in, 1024.0 * 0.15);
    scale_mesh(&small, 1024.0);
    assert_int_equal(small.n_face, large.n_face);
    assert_memory_equal(small.face, large.face, 3 * (size_t)small.n_face * sizeof *small.face);
    assert_memory_equal(small.pos, large.pos, 3 * (size_t)small.n_vert * sizeof *small.pos);
    sn_tri_mesh_free(&in);
    sn_tri_mesh_free(&small);
    sn_tri_mesh_free(&large);
}

/* ---- hostile input ---- */

static void assert_refused(const sn_tri_mesh *in, const sn_remesh *opt, sn_status want, const char *message)
{
    sn_tri_mesh out = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1));
    sn_error err = {.msg = ""};
    assert_int_equal(sn_remesh_run(in, opt, NULL, &out, NULL, &err), want);
    assert_string_equal(err.msg, message);
    assert_null(out.pos);
    assert_int_equal(out.n_face, 0);
}

static void bad_options(void **state)
{
    (void)state;
    sn_tri_mesh in = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1));
    const double bad[2] = {0.1, -2.0};
    assert_refused(&in, &(sn_remesh){0}, SN_EINVAL, "remesh: edge length is 0, need > 0");
    assert_refused(&in, &(sn_remesh){.edge_length = -1}, SN_EINVAL, "remesh: edge length is -1, need > 0");
    assert_refused(&in, &(sn_remesh){.edge_length = INFINITY}, SN_EINVAL,
                   "remesh: edge length is inf, need > 0");
    assert_refused(&in, &(sn_remesh){.edge_length = 1, .label_length = bad, .n_label = 2}, SN_EINVAL,
                   "remesh: edge length of label 1 is -2, need > 0");
    const char *negative = "remesh: iterations and max_deviation must not be negative";
    assert_refused(&in, &(sn_remesh){.edge_length = 1, .iterations = -1}, SN_EINVAL, negative);
    assert_refused(&in, &(sn_remesh){.edge_length = 1, .max_deviation = -0.1}, SN_EINVAL, negative);
    assert_refused(&in, &(sn_remesh){.edge_length = 1, .max_deviation = NAN}, SN_EINVAL, negative);
    sn_tri_mesh_free(&in);
}

static void bad_surfaces(void **state)
{
    (void)state;
    const sn_remesh opt = {.edge_length = 0.5};
    sn_tri_mesh in = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1));
    in.n_face = 11; /* face (3, 4, 7) is gone */
    assert_refused(&in, &opt, SN_EMESH, "remesh: edge (8, 5) is not between two faces that turn alike");
    in.n_face = 12;
    in.face[0] = 2, in.face[1] = 0; /* turns the other way */
    assert_refused(&in, &opt, SN_EMESH, "remesh: edge (3, 1) is not between two faces that turn alike");
    in.face[0] = 0, in.face[1] = 0; /* an edge from a vertex to itself */
    assert_refused(&in, &opt, SN_EMESH, "remesh: edge (1, 1) is not between two faces that turn alike");
    in.face[1] = 8;
    assert_refused(&in, &opt, SN_EINVAL, "remesh: face 1 names vertex 9, need 1..8");
    in.face[1] = 2;
    in.pos[4] = NAN;
    assert_refused(&in, &opt, SN_EINVAL, "remesh: vertex 2 has a coordinate that is not finite");
    in.pos[4] = 0;
    in.label = SN_NEW_ZERO(int32_t, 12);
    in.label[5] = -1;
    assert_refused(&in, &opt, SN_EINVAL, "remesh: label of face 6 is -1, need 0..16777215");
    in.label[5] = INT32_MAX;
    assert_refused(&in, &opt, SN_EINVAL, "remesh: label of face 6 is 2147483647, need 0..16777215");
    in.n_face = 0;
    assert_refused(&in, &opt, SN_EINVAL, "remesh: surface has no faces");
    sn_tri_mesh_free(&in);
}

/* Two boxes that share a vertex by number: no ring of faces, and a collapse would tear them apart. */
static void boxes_joined_in_a_vertex(void **state)
{
    (void)state;
    sn_tri_mesh in = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1)),
                other = made_box(sn_v3(1, 1, 1), sn_v3(2, 2, 2));
    append_mesh(&in, &other, 0);
    assert_int_equal(sn_tri_mesh_weld(&in, NULL, NULL), SN_OK);
    assert_int_equal(in.n_vert, 15);
    assert_refused(&in, &(sn_remesh){.edge_length = 0.5}, SN_EMESH,
                   "remesh: parts of the surface touch in vertex 7 alone; need a manifold");
    sn_tri_mesh_free(&in);
}

static void four_faces_on_an_edge(void **state)
{
    (void)state;
    sn_tri_mesh in = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1)),
                other = made_box(sn_v3(1, 1, 0), sn_v3(2, 2, 1));
    append_mesh(&in, &other, 0);
    assert_int_equal(sn_tri_mesh_weld(&in, NULL, NULL), SN_OK);
    assert_int_equal(in.n_vert, 14);
    assert_refused(&in, &(sn_remesh){.edge_length = 0.5}, SN_EMESH,
                   "remesh: edge (3, 7) is not between two faces that turn alike");
    sn_tri_mesh_free(&in);
}

static void unused_vertices_go(void **state)
{
    (void)state;
    sn_tri_mesh in = made_box(sn_v3(-1, -1, -1), sn_v3(1, 1, 1)),
                stray = made_box(sn_v3(5, 5, 5), sn_v3(6, 6, 6));
    stray.n_face = 0;
    append_mesh(&in, &stray, 0);
    assert_int_equal(in.n_vert, 16);
    sn_tri_mesh out = remeshed(&in, 0.5);
    assert_is_box(&out, sn_v3(1, 1, 1), 1e-12);
    sn_tri_mesh_free(&in);
    sn_tri_mesh_free(&out);
}

static void stops_when_told(void **state)
{
    (void)state;
    sn_tri_mesh in = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1)), out;
    volatile sig_atomic_t cancel = 1;
    sn_error err;
    sn_tri_mesh_init(&out);
    const sn_remesh opt = {.edge_length = 0.05};
    assert_int_equal(sn_remesh_run(&in, &opt, &(sn_run){.cancel = &cancel}, &out, NULL, &err), SN_ECANCEL);
    assert_memory_equal(err.msg, "interrupted while ", 18);
    assert_null(out.pos);
    assert_int_equal(sn_remesh_run(&in, &opt, &(sn_run){.deadline = 1e-9}, &out, NULL, &err), SN_ELIMIT);
    assert_memory_equal(err.msg, "time limit reached while ", 25);
    sn_tri_mesh_free(&in);
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    sn_tri_mesh in = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1));
    in.label = SN_NEW_ZERO(int32_t, 12);
    in.label[3] = 2;
    sn_run one = {.n_threads = 1};
    sn_status st = SN_ENOMEM;
    for (int n = 0; st; n++) {
        ration r = {n, 0};
        sn_tri_mesh out;
        sn_error err;
        sn_tri_mesh_init(&out);
        sn_set_allocator(RATION(r));
        st = sn_remesh_run(&in, &(sn_remesh){.edge_length = 0.3}, &one, &out, NULL, &err);
        if (st) assert_int_equal(st, SN_ENOMEM);
        if (st) assert_non_null(strstr(err.msg, "no memory"));
        if (st) assert_null(out.pos);
        sn_tri_mesh_free(&out);
        assert_int_equal(r.in_use, 0);
        assert_true(n < 500);
    }
    sn_set_allocator(NULL);
    sn_tri_mesh_free(&in);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sphere_gets_the_wanted_edges),
        cmocka_unit_test(slivers_are_no_creases),
        cmocka_unit_test(labels_have_lengths_of_their_own),
        cmocka_unit_test(box_stays_sharp),
        cmocka_unit_test(few_big_faces_and_a_fine_target),
        cmocka_unit_test(border_between_labels_stays),
        cmocka_unit_test(straight_border_stays_exactly),
        cmocka_unit_test(thin_bone_keeps_its_volume),
        cmocka_unit_test(thin_plates_do_not_cross),
        cmocka_unit_test(thin_round_shell_does_not_cross),
        cmocka_unit_test(crossings_of_the_input_are_reported),
        cmocka_unit_test(face_without_area_goes),
        cmocka_unit_test(same_bits_with_any_threads),
        cmocka_unit_test(unit_of_length_does_not_matter),
        cmocka_unit_test(bad_options),
        cmocka_unit_test(bad_surfaces),
        cmocka_unit_test(boxes_joined_in_a_vertex),
        cmocka_unit_test(four_faces_on_an_edge),
        cmocka_unit_test(unused_vertices_go),
        cmocka_unit_test(stops_when_told),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
