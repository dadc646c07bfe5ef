/* test_body - skin and bones to tets: volumes, labels, conformity; bones that cross, touch, poke out; hostile
 * input. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "mesh/bvh.h"
#include "mesh/mesh_check.h"
#include "tetra/body.h"

#include "closed_surface.h"
#include "made_mesh.h"

#include <stdio.h>

#define EDGE 0.25 /* target length in most tests; the skin is a sphere of radius 1 */

static sn_tri_mesh skin;
static sn_body_report report;
static sn_notes notes;

static int make_skin(void **state)
{
    (void)state;
    skin = made_sphere(sn_v3(0, 0, 0), 1.0, EDGE);
    return 0;
}

static int free_skin(void **state)
{
    (void)state;
    sn_tri_mesh_free(&skin);
    sn_notes_free(&notes);
    return 0;
}

static sn_vec3 face_centre(const sn_tet_mesh *m, size_t h)
{
    sn_vec3 c = {0, 0, 0};
    for (int k = 0; k < 3; k++)
        c = sn_v3_mad(c, 1.0 / 3.0,
                      sn_tet_mesh_point(m, m->tet[(h & ~(size_t)3) + (size_t)sn_tet_face[h & 3][k]]));
    return c;
}

/* What must hold for any body. tolerance: how far a boundary face may lie from the surface that it is
 * labelled with. */
static void assert_sound(const sn_body *b, const sn_tri_mesh *outer, sn_tri_mesh *const *bone, int n_bone,
                         double tolerance)
{
    sn_bvh *bvh[8] = {NULL};
    int32_t *adj = NULL;
    assert_int_equal(sn_tet_mesh_validate(&b->mesh, NULL), SN_OK);
    assert_int_equal(sn_tet_mesh_adjacency(&b->mesh, &adj, NULL), SN_OK);
    assert_int_equal(sn_bvh_create(&bvh[0], outer, NULL), SN_OK);
    for (int i = 0; i < n_bone; i++) assert_int_equal(sn_bvh_create(&bvh[1 + i], bone[i], NULL), SN_OK);
    for (size_t h = 0; h < 4 * (size_t)b->mesh.n_tet; h++) {
        assert_true(sn_body_is_boundary(b->across[h]) == (adj[h] < 0));
        if (adj[h] >= 0) {
            assert_int_equal(b->across[h], adj[h]);
            continue;
        }
        int32_t label = sn_body_label(b->across[h]);
        assert_true(label >= 0 && label <= n_bone);
        assert_true(sn_bvh_closest(bvh[label], face_centre(&b->mesh, h)).dist < tolerance);
    }
    for (int i = 0; i <= n_bone; i++) sn_bvh_destroy(bvh[i]);
    sn_release(adj);
    sn_tri_mesh boundary; /* closed, of the volume of the tets */
    sn_mesh_check check;
    sn_tri_mesh_init(&boundary);
    assert_int_equal(sn_tet_mesh_surface(&b->mesh, -1, &boundary, NULL, NULL), SN_OK);
    assert_int_equal(sn_mesh_check_run(&check, &boundary, NULL, NULL), SN_OK);
    assert_true(check.closed);
    double volume = sn_tet_mesh_volume(&b->mesh);
    assert_true(fabs(sn_tri_mesh_volume(&boundary) / volume - 1.0) < 1e-9);
    sn_tri_mesh_free(&boundary);
    int32_t *used = calloc((size_t)b->mesh.n_vert, sizeof *used);
    for (size_t k = 0; k < 4 * (size_t)b->mesh.n_tet; k++) used[b->mesh.tet[k]] = 1;
    for (int32_t v = 0; v < b->mesh.n_vert; v++) assert_int_equal(used[v], 1);
    free(used);
    assert_int_equal(b->n_bone, n_bone);
    assert_int_equal(report.n_tet, b->mesh.n_tet);
    assert_int_equal(report.n_vert, b->mesh.n_vert);
    assert_true(report.min_dihedral_deg > 0.0 && report.max_dihedral_deg < 180.0);
    assert_true(report.share_below_10_deg < 0.05);
}

static sn_body build_in(const sn_tri_mesh *outer, sn_tri_mesh *const *bone, int n_bone, double edge,
                        double tolerance)
{
    static const char *const names[] = {"a", "b", "c", "d"};
    sn_named_surface named[4];
    sn_body b;
    sn_error err = {.msg = ""};
    for (int i = 0; i < n_bone; i++) named[i] = (sn_named_surface){names[i], bone[i]};
    sn_notes_free(&notes);
    sn_body_init(&b);
    if (sn_body_build(outer, named, n_bone, &(sn_body_options){.edge_length = edge}, NULL, &b, &report,
                      &notes, &err))
        fail_msg("%s", err.msg);
    assert_sound(&b, outer, bone, n_bone, tolerance);
    return b;
}

#define BONES(...) ((sn_tri_mesh *const[]){__VA_ARGS__})
#define BUILD(n, ...) build_in(&skin, BONES(__VA_ARGS__), n, EDGE, 0.2 * EDGE)

static void assert_near(double got, double want, double relative)
{
    if (!(fabs(got / want - 1.0) <= relative)) fail_msg("%.17g, want %.17g within %g", got, want, relative);
}

static int32_t faces_with(const sn_body *b, int32_t label)
{
    int32_t n = 0;
    for (size_t h = 0; h < 4 * (size_t)b->mesh.n_tet; h++) n += b->across[h] == -1 - label;
    return n;
}

static double area_with(const sn_body *b, int32_t label)
{
    double area = 0.0;
    for (size_t h = 0; h < 4 * (size_t)b->mesh.n_tet; h++) {
        if (b->across[h] != -1 - label) continue;
        sn_vec3 p[3];
        for (int k = 0; k < 3; k++)
            p[k] = sn_tet_mesh_point(&b->mesh, b->mesh.tet[(h & ~(size_t)3) + (size_t)sn_tet_face[h & 3][k]]);
        area += 0.5 * sn_v3_len(sn_v3_cross(sn_v3_sub(p[1], p[0]), sn_v3_sub(p[2], p[0])));
    }
    return area;
}

static bool noted(const char *text)
{
    for (size_t i = 0; i < notes.n_line; i++)
        if (strstr(notes.line[i], text)) return true;
    return false;
}

/* ---- what comes out ---- */

static void skin_alone(void **state)
{
    (void)state;
    sn_body b = BUILD(0, NULL);
    assert_near(sn_tet_mesh_volume(&b.mesh), sn_tri_mesh_volume(&skin), 1e-3);
    assert_near(area_with(&b, SN_LABEL_SKIN), sn_tri_mesh_area(&skin), 1e-2);
    assert_true(report.bone_volume == 0.0 && report.n_dropped == 0 && !report.was_resampled);
    assert_int_equal(notes.n_line, 0);
    double max_volume = 0.35 * EDGE * EDGE * EDGE;
    for (int32_t t = 0; t < b.mesh.n_tet; t++)
        assert_true(sn_tet_mesh_tet_volume(&b.mesh, t) <= max_volume * (1 + 1e-9));
    sn_body_free(&b);
    sn_body_free(&b);
}

static void ball_in_a_ball(void **state)
{
    (void)state;
    sn_tri_mesh ball = made_sphere(sn_v3(0, 0, 0), 0.5, 0.15);
    sn_body b = BUILD(1, &ball);
    double bone = sn_tri_mesh_volume(&ball);
    assert_near(sn_tet_mesh_volume(&b.mesh), sn_tri_mesh_volume(&skin) - bone, 2e-3);
    assert_near(sn_tri_mesh_volume(&skin) - sn_tet_mesh_volume(&b.mesh), bone, 0.03);
    assert_near(report.bone_volume_exact, bone, 1e-9);
    assert_near(report.bone_volume, bone, 0.015);
    assert_near(area_with(&b, SN_LABEL_BONE(0)), sn_tri_mesh_area(&ball), 0.02);
    for (int32_t t = 0; t < b.mesh.n_tet; t++) { /* no tet in the bone */
        sn_vec3 c = {0, 0, 0};
        for (int k = 0; k < 4; k++) c = sn_v3_mad(c, 0.25, sn_tet_mesh_point(&b.mesh, b.mesh.tet[4 * t + k]));
        assert_true(sn_v3_len(c) > 0.47 && sn_v3_len(c) < 1.0);
    }
    assert_int_equal(notes.n_line, 0);
    sn_body_free(&b);
    sn_tri_mesh_free(&ball);
}

static void lengths_of_skin_and_bones(void **state)
{
    (void)state;
    sn_tri_mesh ball = made_sphere(sn_v3(0, 0, 0), 0.5, 0.15);
    sn_named_surface named = {"a", &ball};
    sn_body b;
    sn_body_init(&b);
    const sn_body_options opt = {
        .edge_length = 0.25, .bone_edge_length = 0.1, .max_volume = 0.01, .radius_edge = 1.8};
    assert_int_equal(sn_body_build(&skin, &named, 1, &opt, NULL, &b, &report, NULL, NULL), SN_OK);
    assert_sound(&b, &skin, BONES(&ball), 1, 0.05);
    double on_skin = area_with(&b, SN_LABEL_SKIN) / faces_with(&b, SN_LABEL_SKIN);
    double on_bone = area_with(&b, SN_LABEL_BONE(0)) / faces_with(&b, SN_LABEL_BONE(0));
    assert_true(on_skin > 2.0 * on_bone); /* (0.25 / 0.1)^2 = 6.25, less what TetGen splits */
    for (int32_t t = 0; t < b.mesh.n_tet; t++)
        assert_true(sn_tet_mesh_tet_volume(&b.mesh, t) <= 0.01 * (1 + 1e-9));
    sn_body_free(&b);
    sn_tri_mesh_free(&ball);
}

static void crossing_bones_are_united(void **state)
{
    (void)state;
    /* Boxes 1 x 0.4 x 0.4 along x and y that share a cube of 0.4: 0.16 + 0.16 - 0.064. */
    sn_tri_mesh x = made_box(sn_v3(-0.5, -0.2, -0.2), sn_v3(0.5, 0.2, 0.2));
    sn_tri_mesh y = made_box(sn_v3(-0.2, -0.5, -0.2), sn_v3(0.2, 0.5, 0.2));
    sn_body b = BUILD(2, &x, &y);
    assert_false(report.was_resampled);
    assert_near(sn_tri_mesh_volume(&skin) - sn_tet_mesh_volume(&b.mesh), 0.256, 0.03);
    assert_near(report.bone_volume_exact, 0.256, 1e-9);
    assert_near(report.bone_volume, 0.256, 0.015);
    /* Top and bottom: a cross of 0.64 each; ends 4 x 0.16; walls 8 x 0.3 x 0.4. */
    assert_near(area_with(&b, SN_LABEL_BONE(0)) + area_with(&b, SN_LABEL_BONE(1)), 2 * 0.64 + 0.64 + 0.96,
                0.01);
    assert_true(area_with(&b, SN_LABEL_BONE(1)) > 2 * 0.24 + 0.32 + 0.4); /* its arms at least */
    sn_body_free(&b);
    sn_tri_mesh_free(&x);
    sn_tri_mesh_free(&y);
}

static void round_bones_that_cross(void **state)
{
    (void)state;
    sn_tri_mesh x = made_capsule(sn_v3(-0.5, 0, 0), sn_v3(0.5, 0, 0), 0.2, 0.1);
    sn_tri_mesh y = made_capsule(sn_v3(0, -0.5, 0.05), sn_v3(0, 0.5, 0.05), 0.2, 0.1);
    sn_body b = BUILD(2, &x, &y);
    assert_false(report.was_resampled);
    assert_near(report.bone_volume, report.bone_volume_exact, 0.015);
    assert_near(sn_tri_mesh_volume(&skin) - sn_tet_mesh_volume(&b.mesh), report.bone_volume_exact, 0.03);
    assert_true(report.bone_volume_exact < sn_tri_mesh_volume(&x) + sn_tri_mesh_volume(&y));
    assert_true(faces_with(&b, SN_LABEL_BONE(0)) > 50 && faces_with(&b, SN_LABEL_BONE(1)) > 50);
    sn_body_free(&b);
    sn_tri_mesh_free(&x);
    sn_tri_mesh_free(&y);
}

static void bone_pokes_through_the_skin(void **state)
{
    (void)state;
    sn_tri_mesh p = made_capsule(sn_v3(0, 0, 0), sn_v3(1.5, 0, 0), 0.2, 0.05);
    sn_body b = BUILD(1, &p);
    assert_true(noted("bone 'a' pokes through the skin: what is outside is cut off"));
    assert_int_equal(notes.n_line, 1);
    /* A half ball, a cylinder from 0 to the sphere, whose height averages 2 (1 - (1 - r^2)^1.5) / (3 r^2). */
    double r = 0.2, height = 2.0 * (1.0 - pow(1.0 - r * r, 1.5)) / (3.0 * r * r);
    double inside = TEST_PI * r * r * height + 2.0 / 3.0 * TEST_PI * r * r * r;
    assert_near(sn_tri_mesh_volume(&skin) - sn_tet_mesh_volume(&b.mesh), inside,
                0.04); /* facets of the capsule and the skin */
    assert_near(report.bone_volume, report.bone_volume_exact, 0.015);
    assert_near(area_with(&b, SN_LABEL_SKIN), sn_tri_mesh_area(&skin) - TEST_PI * r * r, 0.01);
    sn_body_free(&b);
    sn_tri_mesh_free(&p);
}

/* No corner and no face centre of the rod lies in the skin. */
static void long_rod_runs_through_the_skin(void **state)
{
    (void)state;
    sn_tri_mesh rod = made_box(sn_v3(-5, -0.1, -0.1), sn_v3(5, 0.1, 0.1));
    sn_body b = BUILD(1, &rod);
    assert_true(noted("bone 'a' pokes through the skin"));
    assert_near(sn_tri_mesh_volume(&skin) - sn_tet_mesh_volume(&b.mesh), 0.04 * 2.0 * (1.0 - 0.01 / 3.0),
                0.03);
    sn_body_free(&b);
    sn_tri_mesh_free(&rod);
}

static void slab_cuts_the_body_in_two(void **state)
{
    (void)state;
    sn_tri_mesh slab = made_box(sn_v3(-2, -2, -0.1), sn_v3(2, 2, 0.1));
    sn_body b = BUILD(1, &slab);
    assert_int_equal(report.n_dropped, 0); /* both caps touch the skin */
    double h = 0.9, cap = TEST_PI * h * h * (3.0 - h) / 3.0;
    assert_near(sn_tet_mesh_volume(&b.mesh), 2.0 * cap, 0.03); /* the skin's facets */
    for (int32_t v = 0; v < b.mesh.n_vert; v++) assert_true(fabs(b.mesh.pos[3 * v + 2]) > 0.1 - 0.2 * EDGE);
    sn_body_free(&b);
    sn_tri_mesh_free(&slab);
}

static void bone_flush_with_the_skin(void **state)
{
    (void)state;
    sn_tri_mesh cube = made_box(sn_v3(-1, -1, -1), sn_v3(1, 1, 1)),
                bone = made_box(sn_v3(-0.3, -0.3, 0.2), sn_v3(0.3, 0.3, 1));
    sn_body b = build_in(&cube, BONES(&bone), 1, 0.3, 1e-9);
    assert_near(sn_tet_mesh_volume(&b.mesh), 8.0 - 0.288, 1e-9);
    assert_near(area_with(&b, SN_LABEL_SKIN), 24.0 - 0.36, 1e-9);
    assert_near(area_with(&b, SN_LABEL_BONE(0)), 0.36 + 4 * 0.48, 1e-9);
    sn_body_free(&b);
    sn_tri_mesh_free(&cube);
    sn_tri_mesh_free(&bone);
}

/* ---- bones and bones ---- */

static void bone_inside_a_bone_is_not_seen(void **state)
{
    (void)state;
    sn_tri_mesh outer = made_sphere(sn_v3(0, 0, 0), 0.5, 0.15),
                inner = made_sphere(sn_v3(0.05, 0, 0), 0.3, 0.15);
    for (int order = 0; order < 2; order++) {
        sn_body b = order ? BUILD(2, &inner, &outer) : BUILD(2, &outer, &inner);
        assert_int_equal(faces_with(&b, SN_LABEL_BONE(1 - order)), 0);
        assert_near(sn_tri_mesh_volume(&skin) - sn_tet_mesh_volume(&b.mesh), sn_tri_mesh_volume(&outer),
                    0.03);
        assert_int_equal(report.n_dropped, 0);
        sn_body_free(&b);
    }
    sn_tri_mesh_free(&outer);
    sn_tri_mesh_free(&inner);
}

static void boxes_side_by_side(void **state)
{
    (void)state;
    sn_tri_mesh a = made_box(sn_v3(-0.4, -0.2, -0.2), sn_v3(0.1, 0.2, 0.2)); /* 0.5 x 0.4 x 0.4 */
    sn_tri_mesh touch =
        made_box(sn_v3(0.1, -0.1, -0.1), sn_v3(0.5, 0.3, 0.1)); /* on its end: 0.4 x 0.4 x 0.2 */
    sn_body b = BUILD(2, &a, &touch);
    assert_near(sn_tri_mesh_volume(&skin) - sn_tet_mesh_volume(&b.mesh), 0.08 + 0.032, 0.005);
    assert_near(area_with(&b, SN_LABEL_BONE(0)), 2 * 0.16 + 4 * 0.2 - 0.3 * 0.2,
                1e-6); /* contact is no boundary */
    assert_near(area_with(&b, SN_LABEL_BONE(1)), 2 * 0.08 + 4 * 0.12 - 0.3 * 0.2 + 0.08, 0.2);
    sn_body_free(&b);
    sn_tri_mesh same_sides =
        made_box(sn_v3(-0.1, -0.2, -0.1), sn_v3(0.5, 0.2, 0.3)); /* overlaps, y sides coplanar */
    b = BUILD(2, &a, &same_sides);
    assert_near(sn_tri_mesh_volume(&skin) - sn_tet_mesh_volume(&b.mesh),
                0.08 + 0.6 * 0.4 * 0.4 - 0.2 * 0.4 * 0.3, 0.005);
    sn_body_free(&b);
    b = BUILD(2, &a, &a); /* twice the same */
    assert_near(sn_tri_mesh_volume(&skin) - sn_tet_mesh_volume(&b.mesh), 0.08, 0.005);
    assert_near(area_with(&b, SN_LABEL_BONE(0)) + area_with(&b, SN_LABEL_BONE(1)), 2 * 0.16 + 4 * 0.2, 1e-6);
    sn_body_free(&b);
    sn_tri_mesh_free(&a);
    sn_tri_mesh_free(&touch);
    sn_tri_mesh_free(&same_sides);
}

/* Such a union is no manifold: the surfaces are resampled, which costs sharp edges some volume. */
static void boxes_that_touch_in_a_corner_or_an_edge(void **state)
{
    (void)state;
    sn_tri_mesh a = made_box(sn_v3(-0.5, -0.2, -0.2), sn_v3(0.1, 0.2, 0.2));
    sn_tri_mesh other[2] = {made_box(sn_v3(0.1, 0.2, 0.2), sn_v3(0.5, 0.6, 0.5)),
                            made_box(sn_v3(0.1, 0.2, -0.3), sn_v3(0.5, 0.6, 0.2))};
    for (int i = 0; i < 2; i++) {
        sn_body b = build_in(&skin, BONES(&a, &other[i]), 2, EDGE, 0.5 * EDGE);
        double bones = sn_tri_mesh_volume(&a) + sn_tri_mesh_volume(&other[i]);
        assert_true(report.was_resampled && noted("resampled"));
        assert_near(report.bone_volume, bones, 0.08); /* their edges are cut by part of a sample cell */
        assert_true(faces_with(&b, SN_LABEL_BONE(0)) > 50 && faces_with(&b, SN_LABEL_BONE(1)) > 50);
        sn_body_free(&b);
        sn_tri_mesh_free(&other[i]);
    }
    sn_tri_mesh_free(&a);
}

/* 0.1 + 0.2 and 0.3: left as they are the boxes do not touch, and TetGen hangs in the gap. */
static void boxes_a_rounding_error_apart(void **state)
{
    (void)state;
    sn_tri_mesh a = made_box(sn_v3(-0.3, -0.2, -0.2), sn_v3(0.3, 0.2, 0.2));
    sn_tri_mesh b = made_box(sn_v3(0.1 + 0.2, -0.2, -0.2), sn_v3(0.6, 0.2, 0.2));
    sn_named_surface named[2] = {{"a", &a}, {"b", &b}};
    assert_true(b.pos[0] > 0.3 && b.pos[0] < 0.3 + 1e-15);
    const sn_body_options opt = {.edge_length = EDGE, .bone_edge_length = 0.1};
    sn_body body;
    sn_error err = {.msg = ""};
    sn_body_init(&body);
    sn_notes_free(&notes);
    if (sn_body_build(&skin, named, 2, &opt, NULL, &body, &report, &notes, &err)) fail_msg("%s", err.msg);
    assert_sound(&body, &skin, BONES(&a, &b), 2, 0.5 * EDGE);
    assert_near(report.bone_volume, 0.9 * 0.16, 1e-9);
    assert_false(report.was_resampled);
    sn_body_free(&body);
    sn_tri_mesh_free(&a);
    sn_tri_mesh_free(&b);
}

static void bone_that_crosses_itself_is_resampled(void **state)
{
    (void)state;
    sn_tri_mesh bone = made_box(sn_v3(-0.4, -0.2, -0.2), sn_v3(0.1, 0.2, 0.2));
    sn_tri_mesh more = made_box(sn_v3(-0.1, -0.15, -0.1), sn_v3(0.5, 0.3, 0.1));
    append_mesh(&bone, &more, 0);
    sn_body b = build_in(&skin, BONES(&bone), 1, EDGE, 0.5 * EDGE);
    assert_true(report.was_resampled);
    assert_true(noted("bone 'a' crosses itself (faces ") && noted("): the surfaces are resampled"));
    /* 0.08 + 0.6 * 0.45 * 0.2 less the overlap 0.2 * 0.35 * 0.2 */
    assert_near(report.bone_volume, 0.08 + 0.054 - 0.014, 0.08);
    sn_body_free(&b);
    sn_tri_mesh_free(&bone);
}

/* ---- shut off, inside out, welded ---- */

static void tissue_in_a_hollow_bone_is_dropped(void **state)
{
    (void)state;
    sn_tri_mesh hollow = made_sphere(sn_v3(0, 0, 0), 0.6, 0.2), wall = made_sphere(sn_v3(0, 0, 0), 0.4, 0.2);
    double outer = sn_tri_mesh_volume(&hollow), inner = sn_tri_mesh_volume(&wall);
    turn_faces(&wall);
    append_mesh(&hollow, &wall, 0);
    sn_body b = BUILD(1, &hollow);
    assert_true(report.n_dropped > 100);
    assert_near(report.dropped_volume, inner, 0.1); /* the label's volume is kept, not that of each wall */
    assert_near(sn_tri_mesh_volume(&skin) - sn_tet_mesh_volume(&b.mesh), outer, 0.03);
    assert_true(noted("are shut off from the skin by bone: dropped"));
    for (int32_t v = 0; v < b.mesh.n_vert; v++) assert_true(sn_v3_len(sn_tet_mesh_point(&b.mesh, v)) > 0.5);
    sn_body_free(&b);
    sn_tri_mesh_free(&hollow);
}

static void surfaces_inside_out_are_turned(void **state)
{
    (void)state;
    sn_tri_mesh ball = made_sphere(sn_v3(0, 0, 0), 0.5, 0.2),
                inverted = made_sphere(sn_v3(0, 0, 0), 1.0, EDGE);
    double want = sn_tri_mesh_volume(&skin) - sn_tri_mesh_volume(&ball);
    turn_faces(&ball);
    turn_faces(&inverted);
    sn_body b = build_in(&inverted, BONES(&ball), 1, EDGE, 0.2 * EDGE);
    assert_near(sn_tet_mesh_volume(&b.mesh), want, 2e-3);
    assert_true(sn_tri_mesh_volume(&inverted) < 0.0); /* the caller's are left alone */
    sn_body_free(&b);
    sn_tri_mesh_free(&ball);
    sn_tri_mesh_free(&inverted);
}

static void corners_of_a_soup_are_welded(void **state)
{
    (void)state;
    sn_tri_mesh cube = made_box(sn_v3(-1, -1, -1), sn_v3(1, 1, 1)), soup;
    sn_tri_mesh_init(&soup);
    assert_int_equal(sn_tri_mesh_reserve(&soup, 36, 12, NULL), SN_OK);
    for (int k = 0; k < 36; k++) {
        sn_v3_store(soup.pos + 3 * k, sn_tri_mesh_point(&cube, cube.face[k]));
        soup.face[k] = k;
    }
    sn_body b = build_in(&soup, NULL, 0, 0.5, 1e-9);
    assert_near(sn_tet_mesh_volume(&b.mesh), 8.0, 1e-9);
    sn_body_free(&b);
    sn_tri_mesh_free(&cube);
    sn_tri_mesh_free(&soup);
}

/* ---- sameness ---- */

static void same_bits_every_time(void **state)
{
    (void)state;
    sn_tri_mesh x = made_capsule(sn_v3(-0.5, 0, 0), sn_v3(0.5, 0, 0), 0.2, 0.2);
    sn_named_surface named = {"x", &x};
    sn_body b[2];
    for (int i = 0; i < 2; i++) {
        sn_body_init(&b[i]);
        assert_int_equal(sn_body_build(&skin, &named, 1, &(sn_body_options){.edge_length = 0.3},
                                       &(sn_run){.n_threads = 1 + i}, &b[i], NULL, NULL, NULL),
                         SN_OK);
    }
    assert_int_equal(b[0].mesh.n_tet, b[1].mesh.n_tet);
    assert_int_equal(b[0].mesh.n_vert, b[1].mesh.n_vert);
    assert_memory_equal(b[0].mesh.pos, b[1].mesh.pos, 3 * (size_t)b[0].mesh.n_vert * sizeof(double));
    assert_memory_equal(b[0].mesh.tet, b[1].mesh.tet, 4 * (size_t)b[0].mesh.n_tet * sizeof(int32_t));
    assert_memory_equal(b[0].across, b[1].across, 4 * (size_t)b[0].mesh.n_tet * sizeof(int32_t));
    for (int i = 0; i < 2; i++) sn_body_free(&b[i]);
    sn_tri_mesh_free(&x);
}

static void unit_of_length_does_not_matter(void **state)
{
    (void)state;
    sn_tri_mesh ball = made_sphere(sn_v3(0.1, 0, 0), 0.5, 0.2);
    int32_t n_tet[3];
    double volume[3];
    const double factor[3] = {1.0, 1000.0, 1e-3};
    for (int i = 0; i < 3; i++) {
        sn_tri_mesh s, bone;
        sn_tri_mesh_init(&s);
        sn_tri_mesh_init(&bone);
        assert_int_equal(sn_tri_mesh_copy(&s, &skin, NULL), SN_OK);
        assert_int_equal(sn_tri_mesh_copy(&bone, &ball, NULL), SN_OK);
        scale_mesh(&s, factor[i]);
        scale_mesh(&bone, factor[i]);
        sn_body b = build_in(&s, BONES(&bone), 1, EDGE * factor[i], 0.2 * EDGE * factor[i]);
        n_tet[i] = b.mesh.n_tet;
        volume[i] = sn_tet_mesh_volume(&b.mesh) / pow(factor[i], 3.0);
        sn_body_free(&b);
        sn_tri_mesh_free(&s);
        sn_tri_mesh_free(&bone);
    }
    for (int i = 1; i < 3; i++) {
        assert_near(n_tet[i], n_tet[0], 0.05);
        assert_near(volume[i], volume[0], 1e-4);
    }
    sn_tri_mesh_free(&ball);
}

/* ---- what is refused ---- */

static sn_error failure(const sn_tri_mesh *outer, const sn_tri_mesh *bone, const sn_body_options *opt,
                        const sn_run *run)
{
    sn_named_surface named = {"femur", bone};
    sn_body b;
    sn_error err = {.msg = ""};
    sn_body_init(&b);
    sn_status st = sn_body_build(outer, &named, bone != NULL, opt, run, &b, NULL, NULL, &err);
    assert_true(st != SN_OK);
    assert_int_equal(err.code, st);
    assert_null(b.across);
    assert_int_equal(b.mesh.n_tet, 0);
    return err;
}

static void assert_refused(const sn_tri_mesh *outer, const sn_tri_mesh *bone, const char *message)
{
    sn_error err = failure(outer, bone, &(sn_body_options){.edge_length = EDGE}, NULL);
    assert_int_equal(err.code, SN_EMESH);
    assert_string_equal(err.msg, message);
}

static void unfit_skins(void **state)
{
    (void)state;
    sn_tri_mesh s = made_box(sn_v3(-1, -1, -1), sn_v3(1, 1, 1));
    s.n_face = 11;
    assert_refused(&s, NULL, "skin is not closed: 3 boundary edges; need a closed surface");
    s.n_face = 12;
    int32_t swap = s.face[0];
    s.face[0] = s.face[1], s.face[1] = swap;
    assert_refused(&s, NULL, "skin has neighbouring faces that turn opposite ways; need one orientation");
    s.face[1] = s.face[0], s.face[0] = swap;
    s.pos[5] = NAN;
    assert_refused(&s, NULL, "skin: vertex 2 has a coordinate that is not finite");
    s.pos[5] = -1;
    s.face[35] = 8;
    assert_refused(&s, NULL, "skin: face 12 names vertex 9, need 1..8");
    s.n_face = 0;
    assert_refused(&s, NULL, "skin: surface has no faces");
    sn_tri_mesh_free(&s);
    sn_tri_mesh flat = made_box(sn_v3(-1, -1, 0), sn_v3(1, 1, 1));
    for (int v = 0; v < 8; v++) flat.pos[3 * v + 2] = 0.5 * flat.pos[3 * v]; /* into the plane z = x / 2 */
    flat.pos[0] += 1e-3; /* so that no vertices are bit-equal */
    for (int v = 0; v < 4; v++) flat.pos[3 * v] *= 0.5, flat.pos[3 * v + 2] *= 0.5;
    sn_error err = failure(&flat, NULL, &(sn_body_options){.edge_length = EDGE}, NULL);
    assert_int_equal(err.code, SN_EMESH);
    assert_true(strstr(err.msg, "skin encloses no volume") || strstr(err.msg, "skin crosses itself: faces "));
    sn_tri_mesh_free(&flat);
}

static void skin_that_crosses_itself(void **state)
{
    (void)state;
    sn_tri_mesh s = made_box(sn_v3(0, 0, 0), sn_v3(2, 2, 2)),
                other = made_box(sn_v3(1, 0.5, 0.5), sn_v3(3, 1.5, 1.5));
    append_mesh(&s, &other, 0);
    sn_error err = failure(&s, NULL, &(sn_body_options){.edge_length = 0.5}, NULL);
    assert_int_equal(err.code, SN_EMESH);
    assert_memory_equal(err.msg, "skin crosses itself: faces ", 27);
    assert_non_null(strstr(err.msg, "; need a surface without self-intersections"));
    sn_tri_mesh_free(&s);
}

static void unfit_bones(void **state)
{
    (void)state;
    sn_tri_mesh bone = made_box(sn_v3(-0.2, -0.2, -0.2), sn_v3(0.2, 0.2, 0.2));
    bone.n_face = 10;
    assert_refused(&skin, &bone, "bone 'femur' is not closed: 4 boundary edges; need a closed surface");
    bone.n_face = 12;
    bone.pos[0] = INFINITY;
    assert_refused(&skin, &bone, "bone 'femur': vertex 1 has a coordinate that is not finite");
    sn_tri_mesh_free(&bone);
    sn_tri_mesh a = made_box(sn_v3(-0.2, -0.2, -0.2), sn_v3(0, 0, 0.2)),
                b = made_box(sn_v3(0, 0, -0.2), sn_v3(0.2, 0.2, 0.2));
    append_mesh(&a, &b, 0); /* welded: four faces on the common edge */
    assert_refused(&skin, &a, "bone 'femur' is not manifold: 1 edges with more than two faces");
    sn_tri_mesh_free(&a);
    const int32_t back_to_back[] = {0, 1, 2, 0, 2, 1};
    sn_tri_mesh flat = made_box(sn_v3(-0.2, -0.2, -0.2), sn_v3(0.2, 0.2, 0.2));
    memcpy(flat.face, back_to_back, sizeof back_to_back);
    flat.n_face = 2;
    assert_refused(&skin, &flat, "bone 'femur' encloses no volume");
    sn_tri_mesh_free(&flat);
}

static void bones_in_the_wrong_place(void **state)
{
    (void)state;
    sn_tri_mesh away = made_box(sn_v3(3, 0, 0), sn_v3(4, 1, 1)),
                big = made_box(sn_v3(-2, -2, -2), sn_v3(2, 2, 2));
    assert_refused(&skin, &away, "bone 'femur' lies outside the skin: no part of it is inside");
    assert_refused(&skin, &big, "bone 'femur' encloses the whole skin and leaves no soft tissue");
    assert_refused(&skin, &skin, "the bones leave no soft tissue inside the skin");
    sn_tri_mesh_free(&away);
    sn_tri_mesh_free(&big);
}

static void unfit_options(void **state)
{
    (void)state;
    const struct {
        sn_body_options opt;
        const char *want;
    } bad[] = {
        {{.edge_length = -1}, "tetrahedralize: edge_length is -1, need > 0"},
        {{.edge_length = INFINITY}, "tetrahedralize: edge_length is inf, need > 0"},
        {{.bone_edge_length = -0.5}, "tetrahedralize: bone_edge_length is -0.5, need > 0"},
        {{.max_volume = -2}, "tetrahedralize: max_volume is -2, need > 0"},
        {{.time_limit = -3}, "tetrahedralize: time_limit is -3, need > 0"},
        {{.radius_edge = 1.0}, "tetrahedralize: radius_edge is 1, need >= 1.1"},
        {{.radius_edge = INFINITY}, "tetrahedralize: radius_edge is inf, need >= 1.1"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        sn_error err = failure(&skin, NULL, &bad[i].opt, NULL);
        assert_int_equal(err.code, SN_EINVAL);
        assert_string_equal(err.msg, bad[i].want);
    }
    sn_error err = failure(&skin, NULL, &(sn_body_options){.edge_length = NAN}, NULL);
    assert_int_equal(err.code, SN_EINVAL);
}

static void limits_and_cancel(void **state)
{
    (void)state;
    volatile sig_atomic_t cancel = 1;
    sn_error err =
        failure(&skin, NULL, &(sn_body_options){.edge_length = EDGE}, &(sn_run){.cancel = &cancel});
    assert_int_equal(err.code, SN_ECANCEL);
    assert_memory_equal(err.msg, "interrupted while ", 18);
    err = failure(&skin, NULL, &(sn_body_options){.edge_length = EDGE}, &(sn_run){.deadline = 1e-9});
    assert_int_equal(err.code, SN_ELIMIT);
    assert_memory_equal(err.msg, "time limit reached while ", 25);
    double start = sn_clock(); /* far more tets than 0.1 s give */
    err = failure(&skin, NULL, &(sn_body_options){.edge_length = EDGE, .max_volume = 1e-7, .time_limit = 0.1},
                  NULL);
    assert_int_equal(err.code, SN_ELIMIT);
    assert_non_null(
        strstr(err.msg, ": time limit of 0.1 s reached")); /* uniting bones or meshing with TetGen */
    assert_true(sn_clock() - start < 4.0);
#ifndef __SANITIZE_ADDRESS__ /* which stops at an allocation that fails */
    const sn_body_options little = {.edge_length = EDGE, .max_volume = 1e-6, .memory_limit = (size_t)4 << 20};
    err = failure(&skin, NULL, &little, NULL);
    assert_int_equal(err.code, SN_ELIMIT);
    assert_non_null(strstr(err.msg, ": memory limit of 4 MiB reached"));
#endif
}

static volatile sig_atomic_t stop_now;

static void stop_in_tetgen(void *user, const char *step, double fraction)
{
    (void)user, (void)fraction;
    if (strcmp(step, "meshing with TetGen") == 0) stop_now = 1;
}

static void cancel_in_the_middle(void **state)
{
    (void)state;
    stop_now = 0;
    sn_run run = {.cancel = &stop_now, .progress = stop_in_tetgen};
    sn_error err = failure(&skin, NULL, &(sn_body_options){.edge_length = EDGE}, &run);
    assert_int_equal(err.code, SN_ECANCEL);
    assert_string_equal(err.msg, "interrupted while meshing with TetGen");
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    sn_tri_mesh cube = made_box(sn_v3(-1, -1, -1), sn_v3(1, 1, 1)),
                bone = made_box(sn_v3(-0.4, -0.3, -0.2), sn_v3(0.2, 0.3, 0.4));
    sn_named_surface named = {"a", &bone};
    sn_run one = {.n_threads = 1};
    sn_status st = SN_ENOMEM;
    for (int n = 0; st; n += 1 + n / 8) { /* not every one: each run starts two processes */
        ration r = {n, 0};
        sn_body b;
        sn_error err = {.msg = ""};
        sn_body_init(&b);
        sn_set_allocator(RATION(r));
        st = sn_body_build(&cube, &named, 1, &(sn_body_options){.edge_length = 1.0}, &one, &b, NULL, NULL,
                           &err);
        if (st) assert_true(st == SN_ENOMEM || st == SN_ELIMIT); /* the child's own limit is a limit */
        if (st) assert_non_null(strstr(err.msg, "memory"));
        if (st) assert_null(b.across);
        sn_body_free(&b);
        sn_set_allocator(NULL);
        assert_int_equal(r.in_use, 0);
        assert_true(n < 5000);
    }
    sn_tri_mesh_free(&cube);
    sn_tri_mesh_free(&bone);
}

/* ---- other people's tets ---- */

static void body_of_a_tet_mesh(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(2, sn_v3(0, 0, 0), 1.0);
    sn_body b;
    sn_error err;
    sn_body_init(&b);
    assert_int_equal(sn_body_from_tets(&m, SN_LABEL_BONE(2), &b, NULL), SN_OK);
    assert_int_equal(faces_with(&b, SN_LABEL_BONE(2)), 48);
    assert_int_equal(b.mesh.n_tet, 48);
    assert_ptr_not_equal(b.mesh.pos, m.pos);
    m.tet[0] = m.tet[1];
    assert_int_equal(sn_body_from_tets(&m, SN_LABEL_SKIN, &b, &err), SN_EINVAL);
    assert_string_equal(err.msg, "tet 1 has volume 0, need > 0");
    assert_null(b.across);
    sn_tet_mesh_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(skin_alone),
        cmocka_unit_test(ball_in_a_ball),
        cmocka_unit_test(lengths_of_skin_and_bones),
        cmocka_unit_test(crossing_bones_are_united),
        cmocka_unit_test(round_bones_that_cross),
        cmocka_unit_test(bone_pokes_through_the_skin),
        cmocka_unit_test(long_rod_runs_through_the_skin),
        cmocka_unit_test(slab_cuts_the_body_in_two),
        cmocka_unit_test(bone_flush_with_the_skin),
        cmocka_unit_test(bone_inside_a_bone_is_not_seen),
        cmocka_unit_test(boxes_side_by_side),
        cmocka_unit_test(boxes_that_touch_in_a_corner_or_an_edge),
        cmocka_unit_test(boxes_a_rounding_error_apart),
        cmocka_unit_test(bone_that_crosses_itself_is_resampled),
        cmocka_unit_test(tissue_in_a_hollow_bone_is_dropped),
        cmocka_unit_test(surfaces_inside_out_are_turned),
        cmocka_unit_test(corners_of_a_soup_are_welded),
        cmocka_unit_test(same_bits_every_time),
        cmocka_unit_test(unit_of_length_does_not_matter),
        cmocka_unit_test(unfit_skins),
        cmocka_unit_test(skin_that_crosses_itself),
        cmocka_unit_test(unfit_bones),
        cmocka_unit_test(bones_in_the_wrong_place),
        cmocka_unit_test(unfit_options),
        cmocka_unit_test(limits_and_cancel),
        cmocka_unit_test(cancel_in_the_middle),
        cmocka_unit_test(memory_may_run_out_anywhere),
        cmocka_unit_test(body_of_a_tet_mesh),
    };
    return cmocka_run_group_tests(tests, make_skin, free_skin);
}
