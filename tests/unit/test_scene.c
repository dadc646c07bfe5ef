/* test_scene - the document: what an edit makes stale, names, errors, reports. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "scene/scene.h"

#include "made_mesh.h"

#define EDGE 0.3

/* ---- a limb of some thousand tets: an ellipsoid-like capsule, two bones, three muscles along it ---- */

static sn_tri_mesh skin, upper, lower;

static int make_surfaces(void **state)
{
    (void)state;
    skin = made_capsule(sn_v3(0, -1.2, 0), sn_v3(0, 1.2, 0), 0.9, 0.3);
    upper = made_capsule(sn_v3(0, 0.3, 0), sn_v3(0, 1.2, 0), 0.2, 0.2);
    lower = made_capsule(sn_v3(0, -1.2, 0), sn_v3(0, -0.3, 0), 0.2, 0.2);
    return 0;
}

static int free_surfaces(void **state)
{
    (void)state;
    sn_tri_mesh_free(&skin);
    sn_tri_mesh_free(&upper);
    sn_tri_mesh_free(&lower);
    return 0;
}

static const double front[] = {0, -1, 0.5, 0, 0, 0.6, 0, 1, 0.5};
static const double back[] = {0, -1, -0.5, 0, 0, -0.6, 0, 1, -0.5};
static const double side[] = {0.55, -0.8, 0, 0.55, 0.8, 0};

static sn_scene *new_scene(void)
{
    sn_scene *s = NULL;
    assert_int_equal(sn_scene_create(&s, "limb", "cm", SN_UP_Y, NULL), SN_OK);
    return s;
}

static sn_scene *limb(void)
{
    sn_scene *s = new_scene();
    sn_error err = {0};
    sn_body_options opt = {.edge_length = EDGE};
    assert_int_equal(sn_scene_set_skin(s, &skin, NULL), SN_OK);
    assert_int_equal(sn_scene_add_bone(s, "upper", &upper, NULL), SN_OK);
    assert_int_equal(sn_scene_add_bone(s, "lower", &lower, NULL), SN_OK);
    assert_int_equal(sn_scene_add_muscle(s, "flexor", front, NULL, 3, NULL), SN_OK);
    assert_int_equal(sn_scene_add_muscle(s, "extensor", back, (double[]){1, 1.5, 1}, 3, NULL), SN_OK);
    assert_int_equal(sn_scene_add_muscle(s, "abductor", side, NULL, 2, NULL), SN_OK);
    if (sn_scene_tetrahedralize(s, &opt, NULL, NULL, &err)) fail_msg("%s", err.msg);
    return s;
}

static sn_solve_report solve(sn_scene *s)
{
    sn_solve_report r;
    sn_error err = {0};
    if (sn_scene_solve(s, NULL, &r, &err)) fail_msg("%s", err.msg);
    assert_non_null(sn_scene_fields(s));
    assert_true(r.tissue.residual < 1e-8);
    return r;
}

static size_t field_size(const sn_scene *s)
{
    return (size_t)sn_scene_tissue_count(s) * (size_t)sn_scene_body(s)->mesh.n_vert * sizeof(double);
}

/* A copy to compare with later; sn_release it. */
static double *copy_fields(sn_scene *s)
{
    double *copy = sn_alloc(field_size(s), 1);
    assert_non_null(copy);
    memcpy(copy, sn_scene_fields(s), field_size(s));
    return copy;
}

static double largest_difference(const sn_scene *s, const double *a)
{
    const double *b = sn_scene_fields(s);
    double d = 0.0;
    for (size_t k = 0; k < field_size(s) / sizeof *a; k++) d = fmax(d, fabs(a[k] - b[k]));
    return d;
}

/* ---- staleness ---- */

static void nothing_new_is_not_solved_again(void **state)
{
    (void)state;
    sn_scene *s = limb();
    assert_null(sn_scene_fields(s));
    sn_solve_report r = solve(s);
    assert_false(r.was_meshed); /* tetrahedralize did */
    assert_true(r.was_factorized);
    assert_int_equal(r.tissue.n_solved, 4);
    uint64_t revision = sn_scene_revision(s);
    double *before = copy_fields(s);
    r = solve(s);
    assert_false(r.was_meshed || r.was_factorized);
    assert_int_equal(sn_scene_revision(s), revision);
    assert_memory_equal(before, sn_scene_fields(s), field_size(s));
    assert_int_equal(sn_scene_set_fat(s, sn_scene_fat(s), NULL), SN_OK); /* the same values change nothing */
    assert_int_equal(sn_scene_set_alpha(s, sn_scene_alpha(s), NULL), SN_OK);
    assert_int_equal(sn_scene_revision(s), revision);
    assert_non_null(sn_scene_fields(s));
    assert_int_equal(sn_scene_solve(s, NULL, NULL, NULL), SN_OK);
    sn_release(before);
    sn_scene_destroy(s);
}

static void a_tissue_value_needs_its_own_field_only(void **state)
{
    (void)state;
    sn_scene *s = limb();
    solve(s);
    double *before = copy_fields(s);
    size_t row = (size_t)sn_scene_body(s)->mesh.n_vert;
    assert_int_equal(sn_scene_set_tissue(s, 1, 0, 0, 2.0, NULL), SN_OK);
    assert_null(sn_scene_fields(s));
    sn_solve_report r = solve(s);
    assert_false(r.was_meshed || r.was_factorized);
    assert_int_equal(r.tissue.n_solved, 1);
    const double *after = sn_scene_fields(s);
    assert_memory_equal(before, after, 2 * row * sizeof *after);                     /* fat, flexor */
    assert_memory_not_equal(before + 2 * row, after + 2 * row, row * sizeof *after); /* extensor */
    assert_memory_equal(before + 3 * row, after + 3 * row, row * sizeof *after);     /* abductor */
    assert_int_equal(sn_scene_set_tissue(s, 1, 0, 0, 1.0, NULL), SN_OK);
    solve(s);
    assert_true(largest_difference(s, before) <
                1e-12); /* solved alone or together with others: not the same bits */
    assert_int_equal(sn_scene_set_tissue(s, 0, 0, -1, 3.0, NULL),
                     SN_OK); /* all points: the field is linear in them */
    solve(s);
    for (size_t k = row; k < 2 * row; k++) assert_true(fabs(sn_scene_fields(s)[k] - 3.0 * before[k]) < 1e-9);
    sn_release(before);
    sn_scene_destroy(s);
}

static void fat_needs_its_own_field_only(void **state)
{
    (void)state;
    sn_scene *s = limb();
    solve(s);
    double *before = copy_fields(s);
    size_t row = (size_t)sn_scene_body(s)->mesh.n_vert;
    assert_int_equal(sn_scene_set_fat(s, 0.4, NULL), SN_OK);
    assert_true(sn_scene_fat(s) == 0.4);
    sn_solve_report r = solve(s);
    assert_false(r.was_meshed || r.was_factorized);
    assert_int_equal(r.tissue.n_solved, 1);
    assert_memory_equal(before + row, sn_scene_fields(s) + row, 3 * row * sizeof *before);
    for (size_t k = 0; k < row; k++)
        assert_true(fabs(sn_scene_fields(s)[k] - 2.0 * before[k]) < 1e-9); /* 0.4 = 2 x 0.2 */
    sn_release(before);
    sn_scene_destroy(s);
}

static void a_moved_point_needs_no_new_factor(void **state)
{
    (void)state;
    sn_scene *s = limb();
    sn_error err = {0};
    solve(s);
    double *before = copy_fields(s);
    const sn_body *body = sn_scene_body(s);
    for (int what = 0; what < 4; what++) {
        sn_status st = what == 0   ? sn_scene_set_point(s, 0, 0, 1, sn_v3(0.1, 0, 0.55), &err)
                       : what == 1 ? sn_scene_insert_point(s, 0, 0, 1, sn_v3(0, -0.5, 0.6), 1.2, &err)
                       : what == 2 ? sn_scene_remove_point(s, 0, 0, 1, &err)
                                   : sn_scene_set_alpha(s, 50, &err);
        if (st) fail_msg("%s", err.msg);
        assert_null(sn_scene_fields(s));
        sn_solve_report r = solve(s);
        assert_false(r.was_meshed);
        assert_int_equal(r.was_factorized, what == 3);
        assert_int_equal(r.tissue.n_changed_rows > 0, what < 3);
        assert_int_equal(r.tissue.n_solved, 4);
        assert_ptr_equal(sn_scene_body(s), body);
        assert_true(largest_difference(s, before) > 1e-4);
    }
    assert_int_equal(sn_scene_set_alpha(s, 5, NULL), SN_OK);
    assert_int_equal(sn_scene_set_point(s, 0, 0, 1, sn_v3(0, 0, 0.6), NULL),
                     SN_OK); /* as it was: the same bits */
    solve(s);
    assert_memory_equal(before, sn_scene_fields(s), field_size(s));
    sn_release(before);
    sn_scene_destroy(s);
}

/* A bone or a new skin: meshed again, with the options of tetrahedralize. */
static void a_bone_needs_a_new_body(void **state)
{
    (void)state;
    sn_scene *s = limb();
    solve(s);
    double *before = copy_fields(s);
    int32_t n_tet = sn_scene_body(s)->mesh.n_tet;
    assert_int_equal(sn_scene_remove_bone(s, "lower", NULL), SN_OK);
    assert_null(sn_scene_body(s));
    assert_null(sn_scene_fields(s));
    sn_solve_report r = solve(s);
    assert_true(r.was_meshed && r.was_factorized);
    assert_int_equal(r.tissue.n_solved, 4);
    assert_int_not_equal(sn_scene_body(s)->mesh.n_tet, n_tet);
    assert_int_equal(sn_scene_add_bone(s, "lower", &lower, NULL), SN_OK);
    r = solve(s);
    assert_true(r.was_meshed);
    assert_int_equal(sn_scene_body(s)->mesh.n_tet, n_tet); /* the same scene: the same bits */
    assert_memory_equal(before, sn_scene_fields(s), field_size(s));
    assert_int_equal(sn_scene_set_skin(s, &skin, NULL), SN_OK);
    assert_null(sn_scene_body(s));
    sn_release(before);
    sn_scene_destroy(s);
}

static void removing_a_muscle_renumbers(void **state)
{
    (void)state;
    sn_scene *s = limb();
    solve(s);
    int32_t i = -1;
    assert_int_equal(sn_scene_tissue_count(s), 4);
    assert_string_equal(sn_scene_tissue_name(s, 0), "fat");
    assert_string_equal(sn_scene_tissue_name(s, 3), "abductor");
    assert_int_equal(sn_scene_find_muscle(s, "abductor", &i, NULL), SN_OK);
    assert_int_equal(i, 2);
    const sn_muscle *kept = sn_scene_muscle(s, 2);
    assert_int_equal(sn_scene_remove_muscle(s, "flexor", NULL), SN_OK);
    assert_null(sn_scene_fields(s));
    assert_non_null(sn_scene_body(s)); /* the body is as it was */
    assert_int_equal(sn_scene_tissue_count(s), 3);
    assert_string_equal(sn_scene_tissue_name(s, 1), "extensor");
    assert_int_equal(sn_scene_find_muscle(s, "abductor", &i, NULL), SN_OK);
    assert_int_equal(i, 1);
    assert_ptr_equal(sn_scene_muscle(s, 1), kept);
    sn_solve_report r = solve(s);
    assert_false(r.was_meshed || r.was_factorized);
    assert_true(r.tissue.n_changed_rows > 0);
    assert_int_equal(r.tissue.n_solved, 3);
    sn_extraction x;
    sn_extraction_init(&x);
    assert_int_equal(sn_scene_extract(s, NULL, NULL, &x, NULL), SN_OK);
    assert_int_equal(x.n_tissue, 3);
    assert_int_equal(sn_extraction_find(&x, "extensor"), 1);
    assert_int_equal(sn_extraction_find(&x, "flexor"), -1);
    assert_true(sn_extraction_part_tets(&x, 1) > 0 && sn_extraction_part_tets(&x, 2) > 0);
    sn_extraction_free(&x);
    assert_int_equal(sn_scene_add_muscle(s, "flexor", front, NULL, 3, NULL),
                     SN_OK); /* the name is free again */
    assert_string_equal(sn_scene_tissue_name(s, 3), "flexor");
    solve(s);
    assert_int_equal(sn_scene_remove_muscle(s, "flexor", NULL), SN_OK);
    assert_int_equal(sn_scene_remove_muscle(s, "abductor", NULL), SN_OK);
    assert_int_equal(sn_scene_remove_muscle(s, "extensor", NULL), SN_OK);
    sn_error err = {0};
    assert_int_equal(sn_scene_solve(s, NULL, NULL, &err), SN_EINVAL);
    assert_string_equal(err.msg, "the scene has no muscles: add_muscle first");
    sn_scene_destroy(s);
}

/* ---- names and other bad input ---- */

static void assert_message(sn_status st, const sn_error *err, const char *want)
{
    assert_int_equal(st, SN_EINVAL);
    if (!strstr(err->msg, want)) fail_msg("'%s' where '%s' was wanted", err->msg, want);
}

static void names_are_checked(void **state)
{
    (void)state;
    sn_scene *s = new_scene();
    sn_error err = {0};
    int32_t i = -7;
    char word[66], many[140];
    memset(word, 'w', 65);
    word[65] = '\0';
    memset(many, 'm', 139);
    many[139] = '\0';
    assert_message(sn_scene_find_muscle(s, "biceps", &i, &err), &err, "no muscle 'biceps' (the scene has 0)");
    assert_int_equal(sn_scene_add_muscle(s, "biceps", front, NULL, 3, NULL), SN_OK);
    assert_int_equal(sn_scene_add_bone(s, "biceps", &upper, NULL), SN_OK); /* bones have their own names */
    uint64_t revision = sn_scene_revision(s);
    static const struct {
        const char *name, *want;
    } bad[] = {
        {"biceps", "there is a muscle 'biceps' already"},
        {"fat", "'fat' is no name for a muscle: it is tissue 0"},
        {"", "name of a muscle has 0 bytes, need 1 to 64"},
        {"a/b", "name of muscle 'a/b' holds '/', '\"' or a control character"},
        {"a\nb", "holds '/', '\"' or a control character"},
        {"a\x7f", "holds '/', '\"' or a control character"},
        {".", "'.' is no name for a muscle"},
        {"..", "'..' is no name for a muscle"},
    };
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
        assert_message(sn_scene_add_muscle(s, bad[k].name, front, NULL, 3, &err), &err, bad[k].want);
    assert_message(sn_scene_add_muscle(s, word, front, NULL, 3, &err), &err,
                   "name of a muscle has 65 bytes, need 1 to 64");
    assert_message(sn_scene_add_bone(s, "biceps", &upper, &err), &err, "there is a bone 'biceps' already");
    assert_message(sn_scene_add_bone(s, "", &upper, &err), &err, "name of a bone has 0 bytes");
    assert_message(sn_scene_find_muscle(s, "bicpes", &i, &err), &err,
                   "no muscle 'bicpes' (did you mean 'biceps'?)");
    assert_message(sn_scene_find_bone(s, "bicep", &i, &err), &err,
                   "no bone 'bicep' (did you mean 'biceps'?)");
    assert_message(sn_scene_remove_bone(s, "xyz", &err), &err, "no bone 'xyz' (the scene has 1)");
    assert_message(sn_scene_remove_muscle(s, many, &err), &err, "(the scene has 1)");
    assert_int_equal(i, -7);
    assert_int_equal(sn_scene_revision(s), revision);
    assert_int_equal(sn_scene_muscle_count(s), 1);
    assert_int_equal(sn_scene_bone_count(s), 1);
    word[64] = '\0';
    assert_int_equal(sn_scene_add_muscle(s, word, front, NULL, 3, NULL), SN_OK);
    assert_int_equal(sn_scene_find_muscle(s, word, &i, NULL), SN_OK);
    assert_int_equal(i, 1);
    sn_scene_destroy(s);
}

static void the_nearest_name_is_suggested(void **state)
{
    (void)state;
    static const char *const name[] = {"gastrocnemius_L", "gastrocnemius_R", "soleus", "Soleus2"};
    assert_string_equal(sn_nearest_name("gastrocnemius_R", name, 4), "gastrocnemius_R");
    assert_string_equal(sn_nearest_name("gastrocnemius", name, 4),
                        "gastrocnemius_L"); /* equally near: the first */
    assert_string_equal(sn_nearest_name("solues", name, 4), "soleus");
    assert_string_equal(sn_nearest_name("soleus2", name, 4), "soleus"); /* one edit each: the first */
    assert_null(sn_nearest_name("quadriceps", name, 4));
    assert_null(sn_nearest_name("x", name, 0));
    char word[201];
    memset(word, 'q', 200);
    word[200] = '\0';
    assert_null(sn_nearest_name(word, name, 4));
}

static void errors_leave_the_scene_as_it_was(void **state)
{
    (void)state;
    sn_scene *s = limb();
    sn_error err = {0};
    solve(s);
    uint64_t revision = sn_scene_revision(s);
    double *before = copy_fields(s);
    sn_tri_mesh broken = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1)), empty;
    sn_tri_mesh_init(&empty);
    broken.pos[4] = (double)NAN;
    assert_message(sn_scene_set_skin(s, &broken, &err), &err, "skin: ");
    assert_message(sn_scene_set_skin(s, &empty, &err), &err, "skin: ");
    assert_message(sn_scene_add_bone(s, "new", &broken, &err), &err, "bone 'new': ");
    assert_message(sn_scene_set_fat(s, -0.1, &err), &err, "fat is -0.1, need >= 0");
    assert_message(sn_scene_set_fat(s, (double)NAN, &err), &err, "fat is nan, need >= 0");
    assert_message(sn_scene_set_alpha(s, 0, &err), &err, "alpha is 0, need > 0");
    assert_message(sn_scene_set_alpha(s, (double)INFINITY, &err), &err, "alpha is inf, need > 0");
    assert_message(sn_scene_add_muscle(s, "m", front, NULL, 1, &err), &err, "'m'");
    assert_message(sn_scene_add_muscle(s, "m", front, (double[]){1, 0, 1}, 3, &err), &err, "'m'");
    assert_message(sn_scene_set_point(s, 3, 0, 0, sn_v3(0, 0, 0), &err), &err, "muscle 4, need 1..3");
    assert_message(sn_scene_set_point(s, -1, 0, 0, sn_v3(0, 0, 0), &err), &err, "muscle 0, need 1..3");
    assert_message(sn_scene_set_point(s, 0, 0, 3, sn_v3(0, 0, 0), &err), &err,
                   "muscle 'flexor': point 4, need 1..3");
    assert_message(sn_scene_set_point(s, 0, 0, -1, sn_v3(0, 0, 0), &err), &err,
                   "muscle 'flexor': point 0, need 1..3");
    assert_message(sn_scene_set_point(s, 0, 0, 0, sn_v3((double)NAN, 0, 0), &err), &err, "'flexor'");
    assert_message(sn_scene_set_point(s, 0, 0, 0, sn_v3(0, 0, 0.6), &err), &err,
                   "'flexor'"); /* on its neighbour */
    assert_message(sn_scene_insert_point(s, 0, 0, 4, sn_v3(0, 0, 0), 1, &err), &err,
                   "muscle 'flexor': point 5, need 1..4");
    assert_message(sn_scene_insert_point(s, 0, 0, 0, sn_v3(0, 0, 0), -1, &err), &err, "'flexor'");
    assert_message(sn_scene_remove_point(s, 2, 0, 0, &err), &err, "'abductor'"); /* two must stay */
    assert_message(sn_scene_set_tissue(s, 0, 0, 0, 0, &err), &err, "'flexor'");
    assert_message(sn_scene_set_tissue(s, 0, 0, 3, 1, &err), &err, "muscle 'flexor': point 4, need 1..3");
    assert_message(sn_scene_set_tissue(s, 9, 0, 0, 1, &err), &err, "muscle 10, need 1..3");
    assert_message(sn_scene_tetrahedralize(s, &(sn_body_options){.edge_length = -1}, NULL, NULL, &err), &err,
                   "edge");
    assert_int_equal(sn_scene_revision(s), revision);
    assert_non_null(sn_scene_fields(s));
    assert_memory_equal(before, sn_scene_fields(s), field_size(s));
    assert_int_equal(sn_scene_muscle_count(s), 3);
    assert_int_equal(sn_scene_bone_count(s), 2);
    sn_solve_report r = solve(s);
    assert_false(r.was_factorized);
    sn_tri_mesh_free(&broken);
    sn_release(before);
    sn_scene_destroy(s);
}

/* Heads of 3 and 2 points. */
static void heads_are_edited_one_by_one(void **state)
{
    (void)state;
    sn_scene *s = new_scene();
    sn_error err = {0};
    const sn_head_points head[] = {{front, NULL, 3}, {side, (double[]){2, 3}, 2}};
    const sn_paths *paths = NULL;
    assert_message(sn_scene_add_heads(s, "calf", head, 0, &err), &err,
                   "muscle 'calf': no heads, need 1 or more");
    assert_message(sn_scene_add_heads(s, "calf", (sn_head_points[]){head[0], {side, NULL, 1}}, 2, &err), &err,
                   "muscle 'calf', head 2: a curve has 1 point, need 2 or more");
    assert_int_equal(sn_scene_muscle_count(s), 0);
    assert_int_equal(sn_scene_add_heads(s, "calf", head, 2, NULL), SN_OK);
    const sn_muscle *m = sn_scene_muscle(s, 0);
    assert_int_equal(m->n_head, 2);
    assert_int_equal(sn_scene_muscle_paths(s, 0, &paths, NULL), SN_OK);
    assert_true(fabs(paths->head[1].length - 1.6) < 1e-9);
    assert_int_equal(sn_scene_set_point(s, 0, 1, 1, sn_v3(0.55, 1.2, 0), NULL), SN_OK);
    assert_int_equal(sn_scene_muscle_paths(s, 0, &paths, NULL), SN_OK);
    assert_true(fabs(paths->head[1].length - 2.0) < 1e-9);
    assert_int_equal(sn_scene_insert_point(s, 0, 1, 1, sn_v3(0.6, 0, 0), 5, NULL), SN_OK);
    assert_true(m->head[0].n_point == 3 && m->head[1].n_point == 3 && m->head[1].tissue[1] == 5.0);
    assert_int_equal(sn_scene_remove_point(s, 0, 1, 1, NULL), SN_OK);
    assert_int_equal(sn_scene_set_tissue(s, 0, 1, 0, 7, NULL), SN_OK);
    assert_true(m->head[1].tissue[0] == 7.0 && m->head[0].tissue[0] == 1.0);
    uint64_t revision = sn_scene_revision(s);
    assert_message(sn_scene_set_point(s, 0, 2, 0, sn_v3(0, 0, 0), &err), &err,
                   "muscle 'calf': head 3, need 1..2");
    assert_message(sn_scene_set_point(s, 0, -1, 0, sn_v3(0, 0, 0), &err), &err,
                   "muscle 'calf': head 0, need 1..2");
    assert_message(sn_scene_set_point(s, 0, 1, 2, sn_v3(0, 0, 0), &err), &err,
                   "muscle 'calf', head 2: point 3, need 1..2");
    assert_message(sn_scene_remove_point(s, 0, 1, 0, &err), &err,
                   "muscle 'calf', head 2: has 2 points, the fewest a curve can have");
    assert_message(sn_scene_set_tissue(s, 0, 1, 0, -1, &err), &err,
                   "muscle 'calf', head 2: tissue of point 1 is -1, need > 0");
    /* The third point of all heads: the second has none, so the first is not changed, either. */
    assert_message(sn_scene_set_tissue(s, 0, -1, 2, 9, &err), &err,
                   "muscle 'calf', head 2: point 3, need 1..2");
    assert_true(m->head[0].tissue[2] == 1.0);
    assert_int_equal(sn_scene_revision(s), revision);
    assert_int_equal(sn_scene_set_tissue(s, 0, -1, 1, 9, NULL), SN_OK);
    assert_true(m->head[0].tissue[1] == 9.0 && m->head[1].tissue[1] == 9.0 && m->head[1].tissue[0] == 7.0);
    assert_int_equal(sn_scene_set_tissue(s, 0, -1, -1, 4, NULL), SN_OK);
    assert_true(m->head[0].tissue[0] == 4.0 && m->head[1].tissue[0] == 4.0);
    sn_scene_destroy(s);
}

/* Both heads of one muscle pull its function up; the curve of a head is no zero for the other. */
static void heads_make_one_tissue(void **state)
{
    (void)state;
    sn_scene *s = limb();
    double value[5];
    bool inside;
    assert_int_equal(sn_scene_remove_muscle(s, "flexor", NULL), SN_OK);
    assert_int_equal(sn_scene_remove_muscle(s, "abductor", NULL), SN_OK);
    assert_int_equal(
        sn_scene_add_heads(s, "two", (sn_head_points[]){{front, NULL, 3}, {side, NULL, 2}}, 2, NULL), SN_OK);
    sn_solve_report r = solve(s);
    assert_int_equal(r.tissue.n_solved, 3);
    const sn_vec3 on_curve[] = {{0, 0, 0.6}, {0.55, 0, 0}};
    for (int i = 0; i < 2; i++) {
        assert_int_equal(sn_scene_values_at(s, on_curve[i], NULL, value, &inside, NULL), SN_OK);
        assert_true(inside && value[2] > 0.7 && value[2] < 1.3 && value[1] < 0.2);
    }
    sn_scene_destroy(s);
}

/* Wishes that are no geometry leave the fields as they are. */
static void pennation_and_tendon_need_no_solve(void **state)
{
    (void)state;
    sn_scene *s = limb();
    sn_error err = {0};
    solve(s);
    uint64_t revision = sn_scene_revision(s);
    const sn_pennation p = {.kind = SN_UNIPENNATE, .angle_deg = {15}, .n_angle = 1},
                       bad = {.kind = SN_UNIPENNATE};
    assert_int_equal(sn_scene_set_pennation(s, 1, &p, NULL), SN_OK);
    assert_int_equal(sn_scene_set_tendon(s, 1, &(sn_tendon){0.2, 0.0}, NULL), SN_OK);
    assert_true(sn_scene_revision(s) > revision); /* files and pictures of fibers may change */
    assert_non_null(sn_scene_fields(s));
    assert_int_equal(sn_scene_muscle(s, 1)->pennation.kind, SN_UNIPENNATE);
    assert_true(sn_scene_muscle(s, 1)->tendon.length == 0.2);
    revision = sn_scene_revision(s);
    assert_message(sn_scene_set_pennation(s, 1, &bad, &err), &err, "muscle 'extensor': 0 pennation angles");
    assert_message(sn_scene_set_pennation(s, 3, &p, &err), &err, "muscle 4, need 1..3");
    assert_message(sn_scene_set_tendon(s, 1, &(sn_tendon){-1, 0}, &err), &err,
                   "muscle 'extensor': tendon length");
    assert_message(sn_scene_set_tendon(s, -1, &(sn_tendon){0, 0}, &err), &err, "muscle 0, need 1..3");
    assert_message(sn_scene_set_anisotropy(s, 0, &(sn_anisotropy){.is_on = true}, &err), &err,
                   "muscle 'flexor': eigenvalue 1 is 0, need > 0");
    assert_message(sn_scene_set_anisotropy(s, 7, &(sn_anisotropy){0}, &err), &err, "muscle 8, need 1..3");
    const sn_paths *paths = NULL;
    assert_message(sn_scene_muscle_paths(s, 3, &paths, &err), &err, "muscle 4, need 1..3");
    assert_int_equal(sn_scene_revision(s), revision);
    sn_scene_destroy(s);
}

static void steps_say_what_is_missing(void **state)
{
    (void)state;
    sn_scene *s = new_scene();
    sn_error err = {0};
    sn_extraction x;
    sn_scene_report r = {0};
    double value[8];
    bool inside;
    sn_extraction_init(&x);
    assert_null(sn_scene_skin(s));
    assert_null(sn_scene_body(s));
    assert_null(sn_scene_fields(s));
    assert_true(sn_box3_is_empty(sn_scene_bounds(s)));
    assert_message(sn_scene_tetrahedralize(s, &(sn_body_options){0}, NULL, NULL, &err), &err,
                   "the scene has no skin: set_skin first");
    assert_message(sn_scene_solve(s, NULL, NULL, &err), &err, "the scene has no muscles: add_muscle first");
    assert_message(sn_scene_values_at(s, sn_v3(0, 0, 0), NULL, value, &inside, &err), &err, "no muscles");
    assert_int_equal(sn_scene_add_muscle(s, "flexor", front, NULL, 3, NULL), SN_OK);
    assert_message(sn_scene_solve(s, NULL, NULL, &err), &err, "the scene has no skin: set_skin first");
    assert_message(sn_scene_extract(s, NULL, NULL, &x, &err), &err, "no skin");
    assert_message(sn_scene_report_make(s, NULL, &r, &err), &err, "no skin");
    assert_null(r.muscle);
    sn_box3 b = sn_scene_bounds(s);
    assert_true(b.min.y == -1 && b.max.y == 1 && b.max.z == 0.6);
    assert_string_equal(sn_scene_name(s), "limb");
    assert_string_equal(sn_scene_unit(s), "cm");
    assert_int_equal(sn_scene_up(s), SN_UP_Y);
    sn_scene_destroy(s);
    sn_scene_destroy(NULL);
}

static void curves_outside_are_noted_or_refused(void **state)
{
    (void)state;
    sn_scene *s = limb();
    sn_error err = {0};
    const double far[] = {9, 0, 0, 10, 0, 0}, half_out[] = {0.5, 0, 0, 1.5, 0, 0};
    solve(s);
    sn_scene_clear_notes(s);
    assert_int_equal(sn_scene_add_muscle(s, "far", far, NULL, 2, NULL), SN_OK);
    assert_message(sn_scene_solve(s, NULL, NULL, &err), &err, "'far'");
    assert_null(sn_scene_fields(s));
    assert_int_equal(sn_scene_muscle_count(s), 4);
    assert_int_equal(sn_scene_remove_muscle(s, "far", NULL), SN_OK);
    assert_int_equal(sn_scene_add_muscle(s, "half", half_out, NULL, 2, NULL), SN_OK);
    sn_scene_clear_notes(s);
    solve(s);
    assert_int_equal(sn_scene_notes(s)->n_line, 1);
    assert_non_null(strstr(sn_scene_notes(s)->line[0], "muscle 'half': "));
    assert_int_equal(sn_scene_set_tissue(s, 3, 0, 0, 2, NULL), SN_OK); /* said once is enough */
    solve(s);
    assert_int_equal(sn_scene_notes(s)->n_line, 1);
    sn_scene_clear_notes(s);
    assert_int_equal(sn_scene_notes(s)->n_line, 0);
    sn_scene_destroy(s);
}

/* ---- points ---- */

static sn_place place_at(sn_scene *s, double x, double y, double z, int32_t *index)
{
    sn_place place;
    sn_error err = {0};
    if (sn_scene_tissue_at(s, sn_v3(x, y, z), NULL, &place, index, &err)) fail_msg("%s", err.msg);
    return place;
}

static void points_know_their_tissue(void **state)
{
    (void)state;
    sn_scene *s = limb();
    int32_t i = -1;
    double value[4];
    bool inside = true;
    assert_int_equal(place_at(s, 0, 0, 0.6, &i), SN_PLACE_TISSUE); /* solves first */
    assert_int_equal(i, 1);
    assert_non_null(sn_scene_fields(s));
    assert_int_equal(place_at(s, 0, 0, -0.6, &i), SN_PLACE_TISSUE);
    assert_int_equal(i, 2);
    assert_int_equal(place_at(s, 0.55, 0.2, 0, &i), SN_PLACE_TISSUE);
    assert_int_equal(i, 3);
    assert_int_equal(place_at(s, -0.85, 0, 0, &i), SN_PLACE_TISSUE); /* below the skin */
    assert_int_equal(i, 0);
    assert_int_equal(place_at(s, 0, 0.7, 0, &i), SN_PLACE_BONE);
    assert_int_equal(i, 0);
    assert_int_equal(place_at(s, 0.05, -0.7, 0, &i), SN_PLACE_BONE);
    assert_int_equal(i, 1);
    assert_int_equal(place_at(s, 0, 5, 0, &i), SN_PLACE_OUTSIDE);
    assert_int_equal(place_at(s, (double)NAN, 0, 0, &i), SN_PLACE_OUTSIDE);
    assert_int_equal(sn_scene_values_at(s, sn_v3(0, 0.7, 0), NULL, value, &inside, NULL), SN_OK);
    assert_false(inside);
    assert_int_equal(sn_scene_values_at(s, sn_v3(0, 0, 0.6), NULL, value, &inside, NULL), SN_OK);
    assert_true(inside);
    assert_true(value[1] > value[0] && value[1] > value[2] && value[1] > value[3]);
    assert_true(value[1] > 0.7 && value[1] < 1.3); /* drawn to 1 on its curve */
    /* At a vertex the value is the field's. */
    const sn_tet_mesh *m = &sn_scene_body(s)->mesh;
    for (int32_t v = 0; v < m->n_vert; v += 97) {
        assert_int_equal(sn_scene_values_at(s, sn_tet_mesh_point(m, v), NULL, value, &inside, NULL), SN_OK);
        if (!inside) continue; /* rounding, on the border */
        for (int t = 0; t < 4; t++)
            assert_true(fabs(value[t] - sn_scene_fields(s)[(size_t)t * (size_t)m->n_vert + (size_t)v]) <
                        1e-8);
    }
    sn_scene_destroy(s);
}

/* The extraction holds the same tissues as the fields do. */
static void the_extraction_is_that_of_the_fields(void **state)
{
    (void)state;
    sn_scene *s = limb();
    sn_extraction x;
    sn_extraction_check c;
    sn_error err = {0};
    sn_extraction_init(&x);
    if (sn_scene_extract(s, NULL, NULL, &x, &err)) fail_msg("%s", err.msg);
    assert_int_equal(sn_extraction_check_run(&c, &x, &sn_scene_body(s)->mesh, NULL, NULL), SN_OK);
    assert_true(c.conforming && c.positive && c.manifold && c.volume_error < 1e-9);
    sn_locator *l = NULL;
    assert_int_equal(sn_locator_create(&l, &x.mesh, NULL), SN_OK);
    uint64_t h = 77;
    int n_other = 0, n_inside = 0;
    for (int k = 0; k < 20000; k++) {
        sn_vec3 p = sn_v3(2 * made_random(&h) - 1, 4 * made_random(&h) - 2, 2 * made_random(&h) - 1);
        int32_t t = sn_locator_find(l, p, NULL), i;
        if (t < 0) continue;
        n_inside++;
        if (place_at(s, p.x, p.y, p.z, &i) != SN_PLACE_TISSUE || i != x.mesh.part[t]) n_other++;
    }
    assert_true(n_inside > 5000 && n_other < n_inside / 200);
    sn_locator_destroy(l);
    sn_extraction_free(&x);
    sn_scene_destroy(s);
}

/* ---- report ---- */

/* Pieces of a part: every tet takes the lowest number among itself and its neighbours of the part, until none
 * changes. */
static int count_pieces(const sn_extraction *x, int32_t part)
{
    const sn_tet_mesh *m = &x->mesh;
    int32_t *adj = NULL, *low = SN_NEW(int32_t, m->n_tet), n = 0;
    assert_int_equal(sn_tet_mesh_adjacency(m, &adj, NULL), SN_OK);
    for (int32_t t = 0; t < m->n_tet; t++) low[t] = t;
    for (bool changed = true; changed;) {
        changed = false;
        for (int32_t h = 0; h < 4 * m->n_tet; h++) {
            int32_t t = h / 4, u = adj[h];
            if (u < 0 || m->part[t] != part || m->part[u] != part || low[u] >= low[t]) continue;
            low[t] = low[u];
            changed = true;
        }
    }
    for (int32_t t = 0; t < m->n_tet; t++) n += m->part[t] == part && low[t] == t;
    sn_release(adj);
    sn_release(low);
    return n;
}

static void the_report_adds_up(void **state)
{
    (void)state;
    sn_scene *s = limb();
    sn_error err = {0};
    sn_scene_report r = {0};
    /* A weak muscle in the place of a strong one: no volume, no pieces. */
    const double weak[] = {0, -0.9, 0.5, 0, 0.05, 0.61, 0, 0.9, 0.5};
    assert_int_equal(sn_scene_add_muscle(s, "weak", weak, (double[]){1e-12, 1e-12, 1e-12}, 3, NULL), SN_OK);
    if (sn_scene_report_make(s, NULL, &r, &err)) fail_msg("%s", err.msg);
    const sn_tet_mesh *m = &sn_scene_body(s)->mesh;
    assert_int_equal(r.n_muscle, 4);
    int64_t n_tet = 0;
    for (int k = 1; k < SN_TISSUE_HISTOGRAM; k++) n_tet += r.tissues_per_tet[k];
    assert_int_equal(r.tissues_per_tet[0], 0);
    assert_int_equal(n_tet, m->n_tet);
    assert_true(r.tissues_per_tet[1] > 0 && r.tissues_per_tet[2] > 0);
    double sum = r.fat_volume;
    sn_extraction x;
    sn_extraction_init(&x);
    assert_int_equal(sn_scene_extract(s, NULL, NULL, &x, NULL), SN_OK);
    for (int i = 0; i < 4; i++) {
        sum += r.muscle[i].volume;
        assert_true(r.muscle[i].volume == sn_extraction_part_volume(&x, 1 + i));
        assert_int_equal(r.muscle[i].tets, sn_extraction_part_tets(&x, 1 + i));
        assert_int_equal(r.muscle[i].components, count_pieces(&x, 1 + i));
        assert_true((i < 3) == (r.muscle[i].components > 0));
        assert_true(r.muscle[i].length_outside >= 0.0 && r.muscle[i].length_outside < 1e-9);
    }
    assert_true(fabs(sum - sn_tet_mesh_volume(m)) < 1e-9 * sum);
    assert_true(r.muscle[3].tets == 0 && r.muscle[3].volume == 0.0);
    assert_true(fabs(r.muscle[2].length - 1.6) < 1e-9); /* straight */
    assert_true(r.muscle[0].length > 2.0 && r.muscle[0].length < 2.1);
    assert_int_equal(r.body.n_tet, m->n_tet);
    assert_int_equal(r.body.n_vert, m->n_vert);
    assert_true(r.solve.tissue.unknowns > 0 && r.solve.tissue.unknowns < m->n_vert);
    sn_extraction_free(&x);

    /* Muscles in pieces: one that is strong at its ends and weaker than fat between, and what it leaves of
     * others. */
    const double long_way[] = {0, -1, 0.5, 0, -0.6, 0.6, 0, 0, 0.6, 0, 0.6, 0.6, 0, 1, 0.5};
    assert_int_equal(sn_scene_remove_muscle(s, "weak", NULL), SN_OK);
    assert_int_equal(sn_scene_remove_muscle(s, "flexor", NULL), SN_OK);
    assert_int_equal(sn_scene_add_muscle(s, "ends", long_way, (double[]){1, 0.01, 0.01, 0.01, 1}, 5, NULL),
                     SN_OK);
    assert_int_equal(sn_scene_report_make(s, NULL, &r, NULL), SN_OK); /* r again: freed first */
    assert_int_equal(r.n_muscle, 3);
    sn_extraction_init(&x);
    assert_int_equal(sn_scene_extract(s, NULL, NULL, &x, NULL), SN_OK);
    int most = 0;
    for (int i = 0; i < 3; i++) {
        assert_int_equal(r.muscle[i].components, count_pieces(&x, 1 + i));
        most = r.muscle[i].components > most ? r.muscle[i].components : most;
    }
    assert_true(most > 1);
    sn_extraction_free(&x);
    sn_scene_report_free(&r);
    assert_null(r.muscle);
    sn_scene_destroy(s);
}

/* ---- picture ---- */

static void the_scene_can_be_drawn(void **state)
{
    (void)state;
    sn_scene *s = limb();
    sn_error err = {0};
    sn_image a, b;
    sn_picture_stats stats;
    sn_picture_options opt = {
        .width = 96, .height = 128, .show_muscles = true, .show_bones = true, .background = {1, 1, 1, 1}};
    sn_image_init(&a);
    sn_image_init(&b);
    assert_int_equal(sn_camera_preset(&opt.camera, "front", sn_scene_bounds(s), SN_UP_Y, 0.75, NULL), SN_OK);
    if (sn_scene_render(s, &opt, 1, NULL, &a, &stats, &err)) fail_msg("%s", err.msg); /* solves first */
    assert_non_null(sn_scene_fields(s));
    assert_false(stats.is_blank);
    assert_true(stats.tets_sent > 0);
    assert_int_equal(a.width, 96);
    assert_int_equal(a.height, 128);
    opt.show_muscles = false; /* bones alone need no fields: stale ones stay so */
    assert_int_equal(sn_scene_set_fat(s, 0.5, NULL), SN_OK);
    if (sn_scene_render(s, &opt, 1, NULL, &b, &stats, &err)) fail_msg("%s", err.msg);
    assert_null(sn_scene_fields(s));
    assert_int_equal(stats.tets_sent, 0);
    assert_memory_not_equal(a.rgba, b.rgba, 4 * 96 * 128);
    opt.width = 0;
    assert_int_equal(sn_scene_render(s, &opt, 1, NULL, &b, NULL, &err), SN_EINVAL);
    sn_image_free(&a);
    sn_image_free(&b);
    sn_scene_destroy(s);
    s = new_scene(); /* a scene of bones can be drawn, too */
    assert_int_equal(sn_scene_add_bone(s, "upper", &upper, NULL), SN_OK);
    opt.width = 96;
    opt.show_muscles = true;
    assert_int_equal(sn_scene_render(s, &opt, 1, NULL, &b, &stats, &err), SN_OK);
    assert_false(stats.is_blank);
    sn_image_free(&b);
    sn_scene_destroy(s);
}

/* ---- interruption, memory ---- */

static void an_interrupted_solve_can_be_taken_up(void **state)
{
    (void)state;
    sn_scene *s = limb();
    sn_error err = {0};
    solve(s);
    double *before = copy_fields(s);
    volatile sig_atomic_t cancel = 1;
    assert_int_equal(sn_scene_set_alpha(s, 6, NULL), SN_OK);
    assert_int_equal(sn_scene_solve(s, &(sn_run){.cancel = &cancel}, NULL, &err), SN_ECANCEL);
    assert_null(sn_scene_fields(s));
    assert_int_equal(sn_scene_set_alpha(s, 5, NULL), SN_OK);
    solve(s);
    assert_memory_equal(before, sn_scene_fields(s), field_size(s));
    assert_int_equal(sn_scene_remove_bone(s, "lower", NULL), SN_OK);
    assert_int_equal(sn_scene_solve(s, &(sn_run){.cancel = &cancel}, NULL, &err), SN_ECANCEL);
    assert_null(sn_scene_body(s));
    assert_int_equal(sn_scene_muscle_count(s), 3);
    assert_int_equal(sn_scene_add_bone(s, "lower", &lower, NULL), SN_OK);
    solve(s);
    assert_memory_equal(before, sn_scene_fields(s), field_size(s));
    sn_release(before);
    sn_scene_destroy(s);
}

/* Building a document, editing it and taking it apart, with the k-th block refused. */
static sn_status build_and_edit(sn_error *err)
{
    sn_scene *s = NULL;
    int32_t i;
    sn_status st = sn_scene_create(&s, "limb", "cm", SN_UP_Z, err);
    if (!st) st = sn_scene_set_skin(s, &skin, err);
    if (!st) st = sn_scene_add_bone(s, "upper", &upper, err);
    if (!st) st = sn_scene_add_bone(s, "lower", &lower, err);
    if (!st) st = sn_scene_add_muscle(s, "flexor", front, NULL, 3, err);
    if (!st) st = sn_scene_add_muscle(s, "extensor", back, NULL, 3, err);
    if (!st) st = sn_scene_insert_point(s, 0, 0, 3, sn_v3(0, 1.2, 0.5), 1, err);
    if (!st) st = sn_scene_set_point(s, 1, 0, 0, sn_v3(0, -1.1, -0.5), err);
    if (!st) st = sn_scene_find_bone(s, "lower", &i, err);
    if (!st) st = sn_scene_remove_bone(s, "upper", err);
    if (!st) st = sn_scene_remove_muscle(s, "flexor", err);
    if (s && st) assert_true(sn_scene_muscle_count(s) <= 2 && sn_scene_bone_count(s) <= 2);
    sn_scene_destroy(s);
    return st;
}

static void editing_short_of_memory(void **state)
{
    (void)state;
    sn_status st = SN_ENOMEM;
    int left = 0;
    for (; st == SN_ENOMEM; left++) {
        sn_error err = {0};
        ration r = {.left = left};
        sn_set_allocator(RATION(r));
        st = build_and_edit(&err);
        sn_set_allocator(NULL);
        assert_int_equal(r.in_use, 0);
        if (st) assert_non_null(strstr(err.msg, "memory"));
    }
    assert_int_equal(st, SN_OK);
    assert_true(left > 20);
}

/* A solve that runs out of memory leaves a scene that can still be solved, with the same result. */
static void solving_short_of_memory(void **state)
{
    (void)state;
    sn_scene *s = limb();
    solve(s);
    double *before = copy_fields(s);
    sn_run run = {.n_threads = 1};
    sn_status st = SN_ENOMEM;
    for (int left = 0; st == SN_ENOMEM; left++) {
        sn_error err = {0};
        ration r = {.left = left};
        assert_int_equal(sn_scene_set_alpha(s, 6, NULL), SN_OK);
        assert_int_equal(sn_scene_set_alpha(s, 5, NULL), SN_OK);
        sn_set_allocator(RATION(r));
        st = sn_scene_solve(s, &run, NULL, &err);
        sn_set_allocator(NULL);
        if (st) assert_non_null(strstr(err.msg, "memory"));
        if (st) assert_null(sn_scene_fields(s));
    }
    assert_int_equal(st, SN_OK);
    assert_memory_equal(before, sn_scene_fields(s), field_size(s));
    sn_release(before);
    sn_scene_destroy(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_new_is_not_solved_again),
        cmocka_unit_test(a_tissue_value_needs_its_own_field_only),
        cmocka_unit_test(fat_needs_its_own_field_only),
        cmocka_unit_test(a_moved_point_needs_no_new_factor),
        cmocka_unit_test(a_bone_needs_a_new_body),
        cmocka_unit_test(removing_a_muscle_renumbers),
        cmocka_unit_test(names_are_checked),
        cmocka_unit_test(the_nearest_name_is_suggested),
        cmocka_unit_test(errors_leave_the_scene_as_it_was),
        cmocka_unit_test(heads_are_edited_one_by_one),
        cmocka_unit_test(heads_make_one_tissue),
        cmocka_unit_test(pennation_and_tendon_need_no_solve),
        cmocka_unit_test(steps_say_what_is_missing),
        cmocka_unit_test(curves_outside_are_noted_or_refused),
        cmocka_unit_test(points_know_their_tissue),
        cmocka_unit_test(the_extraction_is_that_of_the_fields),
        cmocka_unit_test(the_report_adds_up),
        cmocka_unit_test(the_scene_can_be_drawn),
        cmocka_unit_test(an_interrupted_solve_can_be_taken_up),
        cmocka_unit_test(editing_short_of_memory),
        cmocka_unit_test(solving_short_of_memory),
    };
    return cmocka_run_group_tests(tests, make_surfaces, free_surfaces);
}
