/* test_fit - a template's bone fitted to the skin of a model. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "failing_memory.h"
#include "made_template.h"

static const sn_transform nowhere = {.scale = 1.0};
static sn_fit_result result; /* large */

/* Stretched by 12, -8 and 10 % and bent by about as much, then turned, shifted and scaled. */
static sn_vec3 warped(sn_vec3 p)
{
    return sn_v3(1.12 * p.x + 0.1 * p.z * p.z, 0.92 * p.y + 0.06 * p.x * p.z, 1.1 * p.z);
}

static const sn_transform motion = {1.1, {1, 2, 3}, 15.0, {0.2, -0.1, 0.1}};

static void warp(sn_tri_mesh *m)
{
    for (int32_t i = 0; i < m->n_vert; i++) sn_v3_store(m->pos + 3 * i, warped(sn_tri_mesh_point(m, i)));
    assert_int_equal(sn_tri_mesh_transform(m, &motion, NULL), SN_OK);
}

static sn_tri_mesh copy_of(const sn_tri_mesh *m)
{
    sn_tri_mesh c;
    sn_tri_mesh_init(&c);
    assert_int_equal(sn_tri_mesh_copy(&c, m, NULL), SN_OK);
    return c;
}

static void fit(const made_template *t, const sn_tri_mesh *skin, const sn_run *run)
{
    sn_error err = {.msg = ""};
    if (sn_fit_shape(&t->t, skin, &nowhere, &(sn_fit_options){0}, run, &result, &err))
        fail_msg("%s", err.msg);
}

/* The largest distance of vertices, in diagonals of the second mesh. */
static double apart(const sn_tri_mesh *a, const sn_tri_mesh *b)
{
    double most = 0.0;
    for (int32_t i = 0; i < a->n_vert; i++)
        most = fmax(most, sn_v3_dist(sn_tri_mesh_point(a, i), sn_tri_mesh_point(b, i)));
    return most / sn_box3_diagonal(sn_tri_mesh_bounds(b));
}

static void assert_recovered(double cell_of_skin)
{
    made_template t;
    made_template_init(&t, 0.1);
    sn_tri_mesh skin = made_head(cell_of_skin), want = copy_of(&t.bone), cage = copy_of(&t.cage);
    sn_tri_mesh mark = copy_of(&t.bone);
    mark.n_vert = 2;
    memcpy(mark.pos, head_landmarks, sizeof head_landmarks);
    warp(&skin);
    warp(&want);
    warp(&mark);
    fit(&t, &skin, NULL);
    assert_int_equal(result.bone.n_vert, t.bone.n_vert);
    assert_memory_equal(result.bone.face, t.bone.face, 3 * (size_t)t.bone.n_face * sizeof *t.bone.face);
    assert_true(apart(&result.bone, &want) < 0.015);
    for (int k = 0; k < 2; k++)
        assert_true(sn_v3_dist(sn_v3_load(result.point + 3 * k), sn_tri_mesh_point(&mark, k)) <
                    0.02 * sn_box3_diagonal(sn_tri_mesh_bounds(&want)));
    assert_int_equal(result.rigid.stop, SN_ICP_SETTLED);
    assert_int_equal(result.bent.stop, SN_ICP_SETTLED);
    assert_true(result.bent.residual[result.bent.n_iteration] < 0.05 * result.rigid.residual[0]);
    assert_true(result.bent.residual[0] == result.rigid.residual[result.rigid.n_iteration] ||
                fabs(result.bent.residual[0] / result.rigid.residual[result.rigid.n_iteration] - 1.0) < 1e-9);
    assert_true(result.n_inverted == 0 && result.n_crossing == 0 && result.n_cage_crossing == 0);
    assert_true(result.n_bone_outside == 0 && result.n_skin_outside == 0);
    assert_memory_equal(t.cage.pos, cage.pos, 3 * (size_t)cage.n_vert * sizeof *cage.pos);
    mark.n_vert = t.bone.n_vert;
    sn_tri_mesh_free(&mark);
    sn_tri_mesh_free(&cage);
    sn_tri_mesh_free(&want);
    sn_tri_mesh_free(&skin);
    sn_fit_result_free(&result);
    made_template_free(&t);
}

static void known_deformations_are_recovered(void **state)
{
    (void)state;
    assert_recovered(0.1);  /* the skin has the template's own faces */
    assert_recovered(0.07); /* ... others */
}

static void the_truth_stays(void **state)
{
    (void)state;
    made_template t;
    made_template_init(&t, 0.15);
    fit(&t, &t.head, NULL);
    assert_near(apart(&result.bone, &t.bone), 0.0, 1e-6);
    assert_near(apart(&result.cage, &t.cage), 0.0, 1e-6);
    sn_fit_result_free(&result);
    sn_fit_result_free(&result);
    t.t.n_point = 0;
    fit(&t, &t.head, NULL);
    assert_null(result.point);
    sn_fit_result_free(&result);
    made_template_free(&t);
}

static void the_unit_does_not_matter(void **state)
{
    (void)state;
    made_template t;
    made_template_init(&t, 0.2);
    sn_tri_mesh skin = made_head(0.15);
    warp(&skin);
    fit(&t, &skin, NULL);
    sn_fit_result small = result;
    scale_mesh(&skin, 1000.0);
    scale_mesh(&t.bone, 1000.0);
    scale_mesh(&t.skin, 1000.0);
    scale_mesh(&t.cage, 1000.0);
    fit(&t, &skin, NULL);
    scale_mesh(&result.bone, 0.001);
    assert_near(apart(&result.bone, &small.bone), 0.0, 1e-9);
    assert_int_equal(result.bent.n_iteration, small.bent.n_iteration);
    sn_fit_result_free(&small);
    sn_fit_result_free(&result);
    sn_tri_mesh_free(&skin);
    made_template_free(&t);
}

static void the_same_bits_for_any_threads(void **state)
{
    (void)state;
    made_template t;
    made_template_init(&t, 0.12);
    sn_tri_mesh skin = made_head(0.15);
    warp(&skin);
    sn_run one = {.n_threads = 1}, three = {.n_threads = 3};
    fit(&t, &skin, &one);
    sn_fit_result first = result;
    fit(&t, &skin, &three);
    assert_memory_equal(first.bone.pos, result.bone.pos, 3 * (size_t)t.bone.n_vert * sizeof *first.bone.pos);
    assert_memory_equal(first.point, result.point, 6 * sizeof *first.point);
    sn_fit_result_free(&first);
    sn_fit_result_free(&result);
    sn_tri_mesh_free(&skin);
    made_template_free(&t);
}

/* A cage that leaves part of the bone and skin outside carries them along, and says so. */
static void small_cages_are_reported(void **state)
{
    (void)state;
    made_template t;
    made_template_init(&t, 0.15);
    scale_mesh(&t.cage, 0.4);
    fit(&t, &t.head, NULL);
    assert_true(result.n_skin_outside > t.skin.n_vert / 2);
    assert_true(result.n_bone_outside > 0 && result.n_bone_outside < t.bone.n_vert);
    assert_near(apart(&result.bone, &t.bone), 0.0, 1e-6);
    sn_fit_result_free(&result);
    made_template_free(&t);
}

static void assert_empty(const sn_fit_result *r)
{
    assert_true(!r->bone.pos && !r->bone.face && !r->cage.pos && !r->cage.face && !r->point);
}

static void assert_refused(const made_template *t, const sn_tri_mesh *skin, const char *want)
{
    sn_error err = {.msg = ""};
    assert_int_equal(sn_fit_shape(&t->t, skin, &nowhere, &(sn_fit_options){0}, NULL, &result, &err),
                     SN_EINVAL);
    assert_string_equal(err.msg, want);
    assert_empty(&result);
    assert_int_equal(result.rigid.stop, SN_ICP_NONE);
    assert_int_equal(result.bent.stop, SN_ICP_NONE);
}

static void bad_inputs(void **state)
{
    (void)state;
    made_template t;
    double keep;
    made_template_init(&t, 0.2);
    sn_tri_mesh skin = copy_of(&t.head);
    skin.n_face--;
    assert_refused(&t, &skin, "skin: has 3 boundary edges, need a closed surface");
    skin.n_face = 0;
    assert_refused(&t, &skin, "skin: surface has no faces");
    skin.n_face = t.head.n_face;
    turn_faces(&skin);
    sn_error err;
    assert_int_equal(sn_fit_shape(&t.t, &skin, &nowhere, &(sn_fit_options){0}, NULL, &result, &err),
                     SN_EINVAL);
    assert_non_null(strstr(err.msg, "or faces turn both ways, need all faces outwards"));
    t.cage.n_face--;
    assert_refused(&t, &t.head, "cage: has 3 boundary edges, need a closed surface");
    t.cage.n_face++;
    keep = t.bone.pos[5];
    t.bone.pos[5] = NAN;
    assert_refused(&t, &t.head, "template bone: vertex 2 has a coordinate that is not finite");
    t.bone.pos[5] = keep;
    int32_t n_face = t.skin.n_face;
    t.skin.n_face = 0;
    assert_refused(&t, &t.head, "template skin: surface has no faces");
    t.skin.n_face = n_face;
    const double marks[] = {0, 0, 0, 0, NAN, 0};
    t.t.point = marks;
    assert_refused(&t, &t.head, "template: landmark 2 has a coordinate that is not finite");
    t.t.point = head_landmarks;
    sn_fit_options o = {.cage.icp.max_iterations = 2};
    sn_tri_mesh_free(&skin);
    skin = made_head(0.15);
    warp(&skin);
    assert_int_equal(sn_fit_shape(&t.t, &skin, &nowhere, &o, NULL, &result, &err), SN_ESOLVE);
    assert_non_null(strstr(err.msg, "cage ICP: does not converge: after 2 iterations the residual is 0.0"));
    assert_empty(&result);
    assert_int_equal(result.bent.n_iteration, 2); /* the account of what happened stays */
    assert_int_equal(result.rigid.stop, SN_ICP_SETTLED);
    sn_tri_mesh_free(&skin);
    made_template_free(&t);
}

typedef struct stopper {
    int left;
    volatile sig_atomic_t stop;
} stopper;

static void count_down(void *user, const char *step, double fraction)
{
    stopper *s = user;
    assert_true(step && fraction <= 1.0);
    if (s->left-- <= 0) s->stop = 1;
}

static void interruptions_leave_nothing(void **state)
{
    (void)state;
    made_template t;
    made_template_init(&t, 0.3);
    sn_tri_mesh skin = made_head(0.25);
    warp(&skin);
    sn_fit_options o = {.cage = {.icp.max_residual = 1.0, .soft = 1.0}};
    sn_status st = SN_ECANCEL;
    int n = 0;
    for (; st == SN_ECANCEL; n++) {
        stopper s = {.left = n};
        sn_run run = {.cancel = &s.stop, .progress = count_down, .user = &s};
        sn_error err = {.msg = ""};
        st = sn_fit_shape(&t.t, &skin, &nowhere, &o, &run, &result, &err);
        if (st) assert_empty(&result);
        if (st) assert_int_equal(strncmp(err.msg, "interrupted while ", 18), 0);
    }
    assert_int_equal(st, SN_OK);
    assert_true(n > 20);
    sn_fit_result_free(&result);
    sn_tri_mesh_free(&skin);
    made_template_free(&t);
}

static void memory_may_end_anywhere(void **state)
{
    (void)state;
    made_template t;
    made_template_init(&t, 0.35);
    sn_tri_mesh skin = made_head(0.3);
    warp(&skin);
    sn_fit_options o = {.cage = {.icp.max_residual = 1.0, .soft = 1.0}};
    sn_status st = SN_ENOMEM;
    int n = 0;
    for (; st == SN_ENOMEM; n++) {
        failing f = {.left = n};
        sn_error err = {.msg = ""};
        sn_set_allocator(&(sn_allocator){failing_realloc, &f});
        st = sn_fit_shape(&t.t, &skin, &nowhere, &o, NULL, &result, &err);
        if (st) assert_int_equal(f.n_alive, 0);
        sn_fit_result_free(&result);
        assert_int_equal(f.n_alive, 0);
        sn_set_allocator(NULL);
    }
    assert_int_equal(st, SN_OK);
    assert_true(n > 40);
    sn_tri_mesh_free(&skin);
    made_template_free(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_deformations_are_recovered), cmocka_unit_test(the_truth_stays),
        cmocka_unit_test(the_unit_does_not_matter),         cmocka_unit_test(the_same_bits_for_any_threads),
        cmocka_unit_test(small_cages_are_reported),         cmocka_unit_test(bad_inputs),
        cmocka_unit_test(interruptions_leave_nothing),      cmocka_unit_test(memory_may_end_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
