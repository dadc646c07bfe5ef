/* test_adaptive - adaptive tet meshes of a scene: fine where muscles meet, coarse elsewhere, the same
 * muscles; when there are none; stopped on the way. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "mesh/bvh.h"
#include "scene/scene.h"

#include "made_mesh.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <time.h>

#define EDGE 0.16

/* A long limb with a bone and two muscles side by side at its upper end. scale: of all lengths. */
static sn_scene *limb(double scale, bool with_muscles)
{
    static const double a[] = {-0.35, 0.9, 0, -0.45, 1.7, 0, -0.35, 2.5, 0},
                        b[] = {0.35, 0.9, 0, 0.45, 1.7, 0, 0.35, 2.5, 0};
    double first[9], second[9];
    sn_scene *s = NULL;
    sn_tri_mesh skin = made_capsule(sn_v3(0, -3.0, 0), sn_v3(0, 2.6, 0), 1.0, 0.3),
                bone = made_capsule(sn_v3(0, 0.2, 0), sn_v3(0, 2.6, 0), 0.15, 0.1);
    for (size_t k = 0; k < 3 * (size_t)skin.n_vert; k++) skin.pos[k] *= scale;
    for (size_t k = 0; k < 3 * (size_t)bone.n_vert; k++) bone.pos[k] *= scale;
    for (int k = 0; k < 9; k++) {
        first[k] = scale * a[k];
        second[k] = scale * b[k];
    }
    assert_int_equal(sn_scene_create(&s, "limb", "cm", SN_UP_Y, NULL), SN_OK);
    assert_int_equal(sn_scene_set_skin(s, &skin, NULL), SN_OK);
    assert_int_equal(sn_scene_add_bone(s, "bone", &bone, NULL), SN_OK);
    if (with_muscles) {
        assert_int_equal(sn_scene_add_muscle(s, "left", first, NULL, 3, NULL), SN_OK);
        assert_int_equal(sn_scene_add_muscle(s, "right", second, NULL, 3, NULL), SN_OK);
    }
    sn_tri_mesh_free(&skin);
    sn_tri_mesh_free(&bone);
    return s;
}

static sn_body_report mesh(sn_scene *s, double edge, bool is_adaptive, int n_threads)
{
    sn_body_options opt = {.edge_length = edge, .bone_edge_length = 0.6 * edge, .is_adaptive = is_adaptive};
    sn_run run = {.n_threads = n_threads};
    sn_body_report r = {0};
    sn_error err = {.msg = ""};
    if (sn_scene_tetrahedralize(s, &opt, &run, &r, &err)) fail_msg("%s", err.msg);
    assert_int_equal(r.n_tet, sn_scene_body(s)->mesh.n_tet);
    assert_true((r.n_coarse_tet > 0) == is_adaptive && (r.seconds_coarse > 0.0) == is_adaptive);
    return r;
}

static void extract(sn_scene *s, sn_extraction *x)
{
    sn_error err = {.msg = ""};
    sn_extraction_init(x);
    if (sn_scene_extract(s, NULL, NULL, x, &err)) fail_msg("%s", err.msg);
}

/* The largest distance of the vertices of one part's surface from the surface of the same part there. */
static double distance(const sn_extraction *from, const sn_extraction *to, int32_t tissue)
{
    sn_tri_mesh a, b;
    sn_bvh *bvh = NULL;
    double largest = 0.0;
    sn_tri_mesh_init(&a);
    sn_tri_mesh_init(&b);
    assert_int_equal(sn_tet_mesh_surface(&from->mesh, tissue, &a, NULL, NULL), SN_OK);
    assert_int_equal(sn_tet_mesh_surface(&to->mesh, tissue, &b, NULL, NULL), SN_OK);
    assert_int_equal(sn_bvh_create(&bvh, &b, NULL), SN_OK);
    assert_true(a.n_face > 100 && b.n_face > 100);
    for (int32_t v = 0; v < a.n_vert; v++)
        largest = fmax(largest, sn_bvh_closest(bvh, sn_tri_mesh_point(&a, v)).dist);
    sn_bvh_destroy(bvh);
    sn_tri_mesh_free(&a);
    sn_tri_mesh_free(&b);
    return largest;
}

/* The mean volume of the tets whose centres lie between two heights. */
static double mean_volume(const sn_tet_mesh *m, double low, double high)
{
    double sum = 0.0;
    int n = 0;
    for (int32_t t = 0; t < m->n_tet; t++) {
        double y = sn_tet_mesh_centre(m, t).y;
        if (y < low || y > high) continue;
        sum += sn_tet_mesh_tet_volume(m, t);
        n++;
    }
    assert_true(n > 10);
    return sum / n;
}

static void same_muscles_on_a_third_of_the_tets(void **state)
{
    (void)state;
    sn_scene *even = limb(1.0, true), *adaptive = limb(1.0, true);
    sn_extraction x, y;
    sn_body_report r = mesh(even, EDGE, false, 0), q = mesh(adaptive, EDGE, true, 0);
    if (!(3 * q.n_tet < r.n_tet)) fail_msg("%d tets, evenly %d", q.n_tet, r.n_tet);
    extract(even, &x);
    extract(adaptive, &y);
    for (int32_t i = 1; i <= 2; i++) {
        double there = distance(&x, &y, i), back = distance(&y, &x, i);
        if (!(there < 0.5 * EDGE && back < 0.5 * EDGE)) fail_msg("distances %g, %g", there, back);
        double was = sn_extraction_part_volume(&x, i);
        assert_true(fabs(sn_extraction_part_volume(&y, i) - was) < 0.1 * was);
    }
    const sn_tet_mesh *m = &sn_scene_body(adaptive)->mesh;
    assert_true(mean_volume(m, 1.2, 2.2) < 0.2 * mean_volume(m, -3.0, -1.5));
    assert_true(mean_volume(m, 1.2, 2.2) < 3.0 * mean_volume(&sn_scene_body(even)->mesh, 1.2, 2.2));
    sn_extraction_free(&x);
    sn_extraction_free(&y);
    sn_scene_destroy(even);
    sn_scene_destroy(adaptive);
}

static void assert_same_mesh(const sn_tet_mesh *a, const sn_tet_mesh *b)
{
    assert_int_equal(a->n_vert, b->n_vert);
    assert_int_equal(a->n_tet, b->n_tet);
    assert_memory_equal(a->tet, b->tet, 4 * (size_t)a->n_tet * sizeof *a->tet);
}

/* Any number of threads, called again, and in another unit. */
static void the_same_mesh_each_time(void **state)
{
    (void)state;
    sn_scene *s = limb(1.0, true), *t = limb(1.0, true), *large = limb(1000.0, true);
    (void)mesh(s, 2 * EDGE, true, 1);
    (void)mesh(t, 2 * EDGE, true, 2);
    (void)mesh(large, 2000 * EDGE, true, 2);
    const sn_tet_mesh *m = &sn_scene_body(s)->mesh, *n = &sn_scene_body(t)->mesh;
    assert_same_mesh(m, n);
    assert_memory_equal(m->pos, n->pos, 3 * (size_t)m->n_vert * sizeof *m->pos);
    assert_same_mesh(m, &sn_scene_body(large)->mesh);
    (void)mesh(t, 2 * EDGE, false, 2);
    (void)mesh(t, 2 * EDGE, true, 2);
    assert_same_mesh(m, &sn_scene_body(t)->mesh);
    sn_scene_destroy(s);
    sn_scene_destroy(t);
    sn_scene_destroy(large);
}

/* An edit leaves the mesh; the next call follows it. A new skin is meshed adaptively by the solve. */
static void edits_and_remeshing(void **state)
{
    (void)state;
    sn_scene *s = limb(1.0, true);
    sn_error err = {.msg = ""};
    (void)mesh(s, 2 * EDGE, true, 0);
    int32_t n = sn_scene_body(s)->mesh.n_tet;
    double low = mean_volume(&sn_scene_body(s)->mesh, -2.9, -1.5);
    assert_int_equal(sn_scene_set_point(s, 0, 0, 1, sn_v3(-0.4, -2.5, 0), &err), SN_OK);
    if (sn_scene_solve(s, NULL, NULL, &err)) fail_msg("%s", err.msg);
    assert_int_equal(sn_scene_body(s)->mesh.n_tet, n);
    sn_body_report r = mesh(s, 2 * EDGE, true, 0);
    assert_true(r.n_tet > n);
    assert_true(mean_volume(&sn_scene_body(s)->mesh, -2.9, -1.5) < 0.7 * low);
    sn_tri_mesh skin;
    sn_tri_mesh_init(&skin);
    assert_int_equal(sn_tri_mesh_copy(&skin, sn_scene_skin(s), &err), SN_OK);
    assert_int_equal(sn_scene_set_skin(s, &skin, &err), SN_OK);
    assert_null(sn_scene_body(s));
    if (sn_scene_solve(s, NULL, NULL, &err)) fail_msg("%s", err.msg);
    assert_int_equal(sn_scene_body(s)->mesh.n_tet, r.n_tet);
    sn_tri_mesh_free(&skin);
    sn_scene_destroy(s);
}

static void needs_muscles(void **state)
{
    (void)state;
    sn_scene *s = limb(1.0, false);
    sn_error err = {.msg = ""};
    const sn_body_options opt = {.edge_length = EDGE, .is_adaptive = true},
                          bad = {.edge_length = -1, .is_adaptive = true};
    assert_int_equal(sn_scene_tetrahedralize(s, &opt, NULL, NULL, &err), SN_EINVAL);
    assert_string_equal(err.msg,
                        "tetrahedralize: an adaptive mesh is fine where muscles meet, and the scene has "
                        "none: add_muscle first");
    assert_null(sn_scene_body(s));
    sn_scene_destroy(s);
    s = limb(1.0, true);
    assert_int_equal(sn_scene_tetrahedralize(s, &bad, NULL, NULL, &err), SN_EINVAL);
    assert_string_equal(err.msg, "tetrahedralize: edge_length is -1, need > 0");
    sn_scene_destroy(s);
}

/* ---- stopping ---- */

typedef struct stopper {
    const char *step; /* where to stop */
    bool was_there;
    volatile sig_atomic_t cancel;
} stopper;

static void stop_at_step(void *user, const char *step, double fraction)
{
    stopper *s = user;
    (void)fraction;
    if (strcmp(step, s->step) != 0) return;
    s->was_there = true;
    s->cancel = 1;
}

/* At each kind of step; the mesh and the fields of before stay. */
static void stopped_on_the_way(void **state)
{
    (void)state;
    static const char *const step[] = {"remeshing", "meshing with TetGen", "extracting",
                                       "finding where muscles meet"};
    sn_scene *s = limb(1.0, true);
    sn_error err = {.msg = ""};
    (void)mesh(s, 3 * EDGE, false, 0);
    if (sn_scene_solve(s, NULL, NULL, &err)) fail_msg("%s", err.msg);
    const double *field = sn_scene_fields(s), *pos = sn_scene_body(s)->mesh.pos;
    for (size_t i = 0; i < sizeof step / sizeof *step; i++) {
        stopper stop = {.step = step[i]};
        const sn_run run = {.cancel = &stop.cancel, .progress = stop_at_step, .user = &stop};
        const sn_body_options opt = {.edge_length = 2 * EDGE, .is_adaptive = true};
        sn_status st = sn_scene_tetrahedralize(s, &opt, &run, NULL, &err);
        if (!stop.was_there) fail_msg("no step '%s'", step[i]);
        assert_int_equal(st, SN_ECANCEL);
        assert_ptr_equal(sn_scene_fields(s), field);
        assert_ptr_equal(sn_scene_body(s)->mesh.pos, pos);
    }
    sn_scene_destroy(s);
}

typedef struct later {
    volatile sig_atomic_t cancel;
    int ms;
} later;

static void *cancel_later(void *user)
{
    later *l = user;
    struct timespec t = {l->ms / 1000, l->ms % 1000 * 1000000L};
    (void)nanosleep(&t, NULL);
    l->cancel = 1;
    return NULL;
}

/* From another thread, somewhere on the way through meshing, solving and extracting. */
static void stopped_by_another_thread(void **state)
{
    (void)state;
    sn_scene *s = limb(1.0, true);
    sn_error err = {.msg = ""};
    (void)mesh(s, 3 * EDGE, false, 0);
    const double *pos = sn_scene_body(s)->mesh.pos;
    for (int ms = 1; ms <= 256; ms *= 4) {
        later l = {.ms = ms};
        pthread_t thread;
        const sn_run run = {.cancel = &l.cancel};
        const sn_body_options opt = {.edge_length = 0.5 * EDGE, .is_adaptive = true};
        assert_int_equal(pthread_create(&thread, NULL, cancel_later, &l), 0);
        sn_status st = sn_scene_tetrahedralize(s, &opt, &run, NULL, &err);
        assert_int_equal(pthread_join(thread, NULL), 0);
        assert_int_equal(st, SN_ECANCEL);
        assert_non_null(strstr(err.msg, "interrupted while "));
        assert_ptr_equal(sn_scene_body(s)->mesh.pos, pos);
    }
    sn_scene_destroy(s);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_muscles_on_a_third_of_the_tets),
        cmocka_unit_test(the_same_mesh_each_time),
        cmocka_unit_test(edits_and_remeshing),
        cmocka_unit_test(needs_muscles),
        cmocka_unit_test(stopped_on_the_way),
        cmocka_unit_test(stopped_by_another_thread),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
