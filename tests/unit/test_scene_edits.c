/* test_scene_edits - edits by the factor of before: as exact as a new one, and quick ones within their
 * promise. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include <stdio.h>

#include "scene/scene.h"

#include "made_mesh.h"

enum { n_most = 12, n_edit = 500, every = 25 };

static sn_scene *made_limb(double edge, int n_muscle)
{
    sn_scene *s = NULL;
    sn_error err = {0};
    sn_tri_mesh skin = made_capsule(sn_v3(0, -4, 0), sn_v3(0, 4, 0), 0.8, 0.3);
    sn_tri_mesh bone = made_capsule(sn_v3(0, -4, 0), sn_v3(0, -0.3, 0), 0.2, 0.2);
    assert_int_equal(sn_scene_create(&s, "limb", "cm", SN_UP_Y, NULL), SN_OK);
    assert_int_equal(sn_scene_set_skin(s, &skin, NULL), SN_OK);
    assert_int_equal(sn_scene_add_bone(s, "bone", &bone, NULL), SN_OK);
    for (int i = 0; i < n_muscle; i++) {
        char name[8];
        double x = 0.45 * cos(i), y = 2 * (i % 4) - 3, z = 0.45 * sin(i);
        (void)snprintf(name, sizeof name, "m%d", i);
        const double p[] = {0.9 * x, y - 0.8, 0.9 * z, x, y, z, 0.9 * x, y + 0.8, 0.9 * z};
        assert_int_equal(sn_scene_add_muscle(s, name, p, NULL, 3, NULL), SN_OK);
    }
    if (sn_scene_tetrahedralize(s, &(sn_body_options){.edge_length = edge}, NULL, NULL, &err))
        fail_msg("%s", err.msg);
    sn_tri_mesh_free(&skin);
    sn_tri_mesh_free(&bone);
    return s;
}

static sn_solve_report solve(sn_scene *s)
{
    sn_solve_report r;
    sn_error err = {0};
    if (sn_scene_solve(s, NULL, &r, &err)) fail_msg("%s", err.msg);
    return r;
}

static sn_solve_report solve_quick(sn_scene *s)
{
    sn_solve_report r;
    sn_error err = {0};
    if (sn_scene_solve_quick(s, NULL, &r, &err)) fail_msg("%s", err.msg);
    assert_non_null(sn_scene_picture_fields(s));
    return r;
}

static size_t field_count(const sn_scene *s)
{
    return (size_t)sn_scene_tissue_count(s) * (size_t)sn_scene_body(s)->mesh.n_vert;
}

static double *copy_of(const sn_scene *s, const double *field)
{
    double *copy = sn_alloc(field_count(s), sizeof *copy);
    assert_non_null(copy);
    memcpy(copy, field, field_count(s) * sizeof *copy);
    return copy;
}

/* max |a - b| / max |b|. */
static double difference(const sn_scene *s, const double *a, const double *b)
{
    double worst = 0.0, largest = 0.0;
    for (size_t k = 0; k < field_count(s); k++) {
        worst = fmax(worst, fabs(a[k] - b[k]));
        largest = fmax(largest, fabs(b[k]));
    }
    return worst / largest;
}

/* Another alpha and back: every factor is made anew. */
static void solve_from_scratch(sn_scene *s)
{
    double alpha = sn_scene_alpha(s);
    assert_int_equal(sn_scene_set_alpha(s, 1.1 * alpha, NULL), SN_OK);
    solve(s);
    assert_int_equal(sn_scene_set_alpha(s, alpha, NULL), SN_OK);
    sn_solve_report r = solve(s);
    assert_true(r.was_factorized);
    assert_int_equal(r.tissue.n_changed_rows, 0);
}

static double between(uint64_t *h, double a, double b)
{
    return a + (b - a) * made_random(h);
}

/* In the flesh, about as high as p. */
static sn_vec3 near(uint64_t *h, sn_vec3 p)
{
    double turn = between(h, 0, 6.28), r = between(h, 0.3, 0.6);
    return sn_v3(r * cos(turn), p.y + between(h, -0.2, 0.2), r * sin(turn));
}

static sn_vec3 point_of(const sn_scene *s, int32_t i_muscle, int k)
{
    const double *p = sn_scene_muscle(s, i_muscle)->head[0].point + 3 * k;
    return sn_v3(p[0], p[1], p[2]);
}

/* One random edit of any kind. */
static sn_status edit(sn_scene *s, uint64_t *h, int *n_made, sn_error *err)
{
    int32_t n = sn_scene_muscle_count(s), i = (int32_t)between(h, 0, n - 1e-9);
    int what = (int)between(h, 0, 20);
    char name[16];
    if (what < 9) return sn_scene_set_point(s, i, 0, 1, near(h, point_of(s, i, 1)), err);
    if (what < 12) return sn_scene_set_tissue(s, i, 0, 1, between(h, 0.5, 2.0), err);
    if (what < 14) return sn_scene_set_fat(s, between(h, 0.0, 0.4), err);
    if (what == 14 && n < n_most) {
        sn_vec3 a = near(h, sn_v3(0, between(h, -3, 2), 0)), b = near(h, sn_v3(0, a.y + 1, 0));
        const double p[] = {a.x, a.y, a.z, b.x, b.y, b.z};
        (void)snprintf(name, sizeof name, "n%d", (*n_made)++);
        return sn_scene_add_muscle(s, name, p, NULL, 2, err);
    }
    if (what == 15 && n > 3) return sn_scene_remove_muscle(s, sn_scene_muscle(s, i)->name, err);
    if (what == 16) {
        sn_anisotropy a = sn_scene_muscle(s, i)->anisotropy;
        a.is_on = !a.is_on;
        a.angle_deg = between(h, 0, 180);
        a.eigenvalue[0] = 1.0;
        a.eigenvalue[1] = between(h, 0.5, 4.0);
        a.eigenvalue[2] = between(h, 0.5, 4.0);
        return sn_scene_set_anisotropy(s, i, &a, err);
    }
    return sn_scene_set_point(s, i, 0, 0, near(h, point_of(s, i, 0)), err);
}

/* Quick and exact solves between them, by chance: what comes out is the field of a scene as it is then. */
static void five_hundred_random_edits(void **state)
{
    (void)state;
    sn_scene *s = made_limb(0.25, 8);
    uint64_t h = 2022;
    int n_made = 0, n_quick = 0, n_by_change = 0;
    double worst = 0.0, worst_quick = 0.0;
    solve(s);
    for (int k = 1; k <= n_edit; k++) {
        sn_error err = {0};
        if (edit(s, &h, &n_made, &err)) fail_msg("%s", err.msg);
        assert_null(sn_scene_picture_fields(s));
        double chance = made_random(&h);
        if (chance < 0.3) { /* some in a row */
            solve_quick(s);
        } else if (chance < 0.5) {
            sn_solve_report r = solve_quick(s);
            double *quick = copy_of(s, sn_scene_picture_fields(s));
            n_quick += r.was_quick;
            assert_int_equal(r.was_quick, sn_scene_fields(s) == NULL);
            solve(s);
            worst_quick = fmax(worst_quick, difference(s, quick, sn_scene_fields(s)));
            sn_release(quick);
        } else if (chance < 0.8) {
            n_by_change += solve(s).tissue.n_changed_rows > 0;
        }
        if (k % every) continue;
        solve(s);
        double *field = copy_of(s, sn_scene_fields(s));
        solve_from_scratch(s);
        worst = fmax(worst, difference(s, field, sn_scene_fields(s)));
        sn_release(field);
    }
    assert_true(n_quick > 20 && n_by_change > 50);
    assert_true(worst < 1e-8);
    assert_true(worst_quick > 1e-8 && worst_quick < 1e-3);
    sn_scene_destroy(s);
}

/* What is asked for exactly after a quick solve is exact. */
static void exact_follows_quick(void **state)
{
    (void)state;
    sn_scene *s = made_limb(0.2, 6);
    bool is_inside;
    double value[7];
    solve(s);
    assert_int_equal(sn_scene_set_point(s, 0, 0, 1, sn_v3(0.4, -3, 0.05), NULL), SN_OK);
    sn_solve_report r = solve_quick(s);
    assert_true(r.was_quick && r.tissue.n_kept > 0);
    assert_int_equal(r.tissue.n_kept + r.tissue.n_solved, 7);
    assert_true(sn_scene_was_solved(s, 1));
    assert_null(sn_scene_fields(s));
    r = solve_quick(s); /* nothing new */
    assert_true(r.was_quick);
    assert_null(sn_scene_fields(s));
    assert_int_equal(sn_scene_values_at(s, sn_v3(0.4, -3, 0), NULL, value, &is_inside, NULL), SN_OK);
    assert_true(is_inside);
    assert_non_null(sn_scene_fields(s));
    double *field = copy_of(s, sn_scene_fields(s));
    solve_from_scratch(s);
    assert_true(difference(s, field, sn_scene_fields(s)) < 1e-10);
    sn_release(field);
    sn_scene_destroy(s);
}

/* The one factor of an anisotropic muscle serves while only others are edited. */
static void own_factors_are_kept(void **state)
{
    (void)state;
    sn_scene *s = made_limb(0.25, 5);
    const sn_anisotropy a = {.is_on = true, .eigenvalue = {1, 3, 0.5}};
    assert_int_equal(sn_scene_set_anisotropy(s, 1, &a, NULL), SN_OK);
    solve(s);
    assert_true(sn_scene_was_factorized(s, 2));
    assert_int_equal(sn_scene_set_point(s, 3, 0, 1, sn_v3(-0.4, 3.1, 0.1), NULL), SN_OK);
    sn_solve_report r = solve(s);
    assert_int_equal(r.tissue.n_solved, 6);
    assert_true(sn_scene_was_solved(s, 2) && !sn_scene_was_factorized(s, 2));
    assert_int_equal(sn_scene_remove_muscle(s, "m0", NULL), SN_OK); /* another number, the same muscle */
    r = solve(s);
    assert_true(sn_scene_was_solved(s, 1) && !sn_scene_was_factorized(s, 1));
    double *field = copy_of(s, sn_scene_fields(s));
    solve_from_scratch(s);
    assert_true(sn_scene_was_factorized(s, 1));
    assert_true(difference(s, field, sn_scene_fields(s)) < 1e-10);
    sn_release(field);
    sn_scene_destroy(s);
}

/* A stopped solve leaves the scene as it was, and the next one is right. */
static void stopped_solves(void **state)
{
    (void)state;
    sn_scene *s = made_limb(0.25, 4);
    sn_error err;
    volatile sig_atomic_t cancel = 1;
    const sn_run stop = {.cancel = &cancel};
    solve(s);
    for (int k = 0; k < 4; k++) {
        assert_int_equal(sn_scene_set_point(s, k, 0, 1, sn_v3(0.3 - 0.1 * k, 2 * k - 2.9, 0.4), NULL), SN_OK);
        sn_status st =
            k % 2 ? sn_scene_solve(s, &stop, NULL, &err) : sn_scene_solve_quick(s, &stop, NULL, &err);
        assert_int_equal(st, SN_ECANCEL);
        assert_null(sn_scene_picture_fields(s));
        if (k < 2) solve_quick(s);
    }
    solve(s);
    double *field = copy_of(s, sn_scene_fields(s));
    solve_from_scratch(s);
    assert_true(difference(s, field, sn_scene_fields(s)) < 1e-10);
    sn_release(field);
    sn_scene_destroy(s);
}

/* ---- the iterative solver ---- */

static void iterative_fields_are_the_direct_ones(void **state)
{
    (void)state;
    sn_scene *s = made_limb(0.16, 6); /* more than one level of multigrid */
    const sn_anisotropy a = {.is_on = true, .angle_deg = 20, .eigenvalue = {1, 3, 0.5}};
    assert_int_equal(sn_scene_set_anisotropy(s, 1, &a, NULL), SN_OK);
    sn_solve_report r = solve(s);
    assert_false(r.tissue.is_iterative);
    assert_int_equal(r.tissue.iterations, 0);
    for (int k = 0; k < 3; k++) { /* as it was; moved; back and another value */
        sn_vec3 p = sn_v3(k == 1 ? 0.3 : 0.4, -2.9, 0.1);
        assert_int_equal(sn_scene_set_point(s, 0, 0, 1, p, NULL), SN_OK);
        assert_int_equal(sn_scene_set_tissue(s, 4, 0, 1, 1.0 + 0.5 * (k == 2), NULL), SN_OK);
        sn_scene_set_solver(s, SN_SOLVER_DIRECT);
        solve(s);
        double *direct = copy_of(s, sn_scene_fields(s));
        sn_scene_set_solver(s, SN_SOLVER_ITERATIVE);
        assert_null(sn_scene_fields(s));
        r = solve(s);
        assert_true(r.tissue.is_iterative && r.tissue.iterations > 5);
        assert_int_equal(r.tissue.factor_entries, 0);
        assert_true(difference(s, sn_scene_fields(s), direct) < 1e-8);
        sn_release(direct);
    }
    sn_scene_destroy(s);
}

/* Edits go on from the fields of before; quick ones stop early, and exact ones follow. */
static void iterative_edits(void **state)
{
    (void)state;
    sn_scene *s = made_limb(0.16, 5);
    sn_scene_set_solver(s, SN_SOLVER_ITERATIVE);
    int32_t first = solve(s).tissue.iterations;
    assert_int_equal(sn_scene_set_point(s, 0, 0, 1, sn_v3(0.42, -2.95, 0.02), NULL), SN_OK);
    sn_solve_report r = solve_quick(s);
    assert_true(r.was_quick && r.tissue.iterations < first && !r.was_factorized);
    assert_null(sn_scene_fields(s));
    double *quick = copy_of(s, sn_scene_picture_fields(s));
    solve(s);
    assert_true(difference(s, quick, sn_scene_fields(s)) < 1e-3);
    sn_release(quick);
    assert_int_equal(sn_scene_set_fat(s, 0.3, NULL), SN_OK); /* no system to be solved */
    r = solve(s);
    assert_int_equal(r.tissue.n_solved, 1);
    double *edited = copy_of(s, sn_scene_fields(s));
    sn_scene_set_solver(s, SN_SOLVER_DIRECT);
    solve(s);
    assert_true(difference(s, edited, sn_scene_fields(s)) < 1e-8);
    sn_release(edited);
    volatile sig_atomic_t cancel = 1;
    sn_error err;
    sn_scene_set_solver(s, SN_SOLVER_ITERATIVE);
    assert_int_equal(sn_scene_solve(s, &(sn_run){.cancel = &cancel}, NULL, &err), SN_ECANCEL);
    solve(s);
    sn_scene_destroy(s);
}

/* Fat and the only muscle have the same right-hand side. */
static void one_muscle_follows_by_a_change(void **state)
{
    (void)state;
    sn_scene *s = made_limb(0.25, 1);
    sn_solve_report r = solve(s);
    assert_true(r.tissue.residual < 1e-12);
    assert_int_equal(sn_scene_set_point(s, 0, 0, 1, sn_v3(0.4, -2.9, 0.1), NULL), SN_OK);
    r = solve(s);
    assert_false(r.was_factorized);
    assert_true(r.tissue.n_changed_rows > 0);
    assert_true(r.tissue.residual < 1e-12);
    sn_scene_destroy(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_muscle_follows_by_a_change),
        cmocka_unit_test(five_hundred_random_edits),
        cmocka_unit_test(exact_follows_quick),
        cmocka_unit_test(own_factors_are_kept),
        cmocka_unit_test(stopped_solves),
        cmocka_unit_test(iterative_fields_are_the_direct_ones),
        cmocka_unit_test(iterative_edits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
