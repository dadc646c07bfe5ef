/* test_volume - muscles of a scene that are given a volume, and muscles that keep theirs through edits. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "made_limb.h"

static double volume_of(sn_scene *s, int32_t i)
{
    double volume = -1.0;
    sn_error err = {.msg = ""};
    if (sn_scene_muscle_volume(s, i, &one_thread, &volume, &err)) fail_msg("%s", err.msg);
    return volume;
}

static double extracted_volume(sn_scene *s, int32_t i)
{
    sn_extraction x;
    sn_error err = {.msg = ""};
    sn_extraction_init(&x);
    if (sn_scene_extract(s, NULL, &one_thread, &x, &err)) fail_msg("%s", err.msg);
    double volume = sn_extraction_part_volume(&x, 1 + i);
    sn_extraction_free(&x);
    return volume;
}

static void set_volume(sn_scene *s, int32_t i, double volume)
{
    sn_error err = {.msg = ""};
    if (sn_scene_set_volume(s, i, volume, &one_thread, &err)) fail_msg("%s", err.msg);
}

static void keep(sn_scene *s, int32_t i, bool is_kept)
{
    sn_error err = {.msg = ""};
    if (sn_scene_set_preserve_volume(s, i, is_kept, &one_thread, &err)) fail_msg("%s", err.msg);
}

static void assert_rel(double found, double want, double tolerance)
{
    if (!(fabs(found / want - 1.0) <= tolerance)) fail_msg("%.17g where %.17g was wanted", found, want);
}

static void assert_message(sn_status st, const sn_error *err, const char *want)
{
    assert_int_equal(st, SN_EINVAL);
    if (!strstr(err->msg, want)) fail_msg("'%s' where '%s' was wanted", err->msg, want);
}

/* ---- asking and setting ---- */

static void volumes_are_those_of_the_extraction(void **state)
{
    (void)state;
    sn_scene *s = made_limb();
    double fat = sn_tet_mesh_volume(&sn_scene_body(s)->mesh);
    for (int32_t i = 0; i < 3; i++) { /* the first solves */
        double volume = volume_of(s, i);
        assert_true(volume > 0.05);
        assert_rel(extracted_volume(s, i), volume, 1e-3);
        fat -= volume;
    }
    assert_true(fat > 0.1);
    assert_int_equal(sn_scene_set_fat(s, 0.35, NULL), SN_OK); /* stale: solved again */
    double less = volume_of(s, FLEXOR);
    assert_int_equal(sn_scene_set_fat(s, 0.2, NULL), SN_OK);
    assert_true(less < 0.95 * volume_of(s, FLEXOR));
    sn_scene_destroy(s);
}

static void a_volume_is_hit(void **state)
{
    (void)state;
    sn_scene *s = made_limb();
    double first = volume_of(s, EXTENSOR);
    double *before = copy_fields(s);
    size_t row = (size_t)sn_scene_body(s)->mesh.n_vert;
    const double factor[] = {0.5, 1.3, 0.05, 1.0};
    for (int i = 0; i < 4; i++) {
        uint64_t revision = sn_scene_revision(s);
        set_volume(s, EXTENSOR, factor[i] * first);
        assert_true(sn_scene_revision(s) > revision);
        const double *after = sn_scene_fields(s); /* no solve needed */
        assert_non_null(after);
        assert_rel(volume_of(s, EXTENSOR), factor[i] * first, 1e-5);
        assert_memory_equal(before, after, 2 * row * sizeof *after);
        assert_memory_equal(before + 3 * row, after + 3 * row, row * sizeof *after);
        /* One factor for all tissue values and the whole field; a solve finds the same. */
        const double *t = sn_scene_muscle(s, EXTENSOR)->head[0].tissue;
        assert_rel(t[1], 1.5 * t[0], 1e-14);
        assert_rel(t[2], t[0], 1e-14);
        for (size_t v = 2 * row; v < 3 * row; v++) assert_true(fabs(after[v] - t[0] * before[v]) < 1e-12);
        double *scaled = copy_fields(s);
        assert_int_equal(sn_scene_set_tissue(s, EXTENSOR, 0, 0, t[0], NULL), SN_OK);
        sn_solve_report r = solve_scene(s);
        assert_int_equal(r.tissue.n_solved, 1);
        assert_true(largest_difference(s, scaled) < 1e-11);
        assert_rel(volume_of(s, EXTENSOR), factor[i] * first, 1e-4);
        sn_release(scaled);
    }
    assert_true(sn_scene_kept_volume(s, EXTENSOR) == 0.0); /* set once, not kept */
    sn_release(before);
    sn_scene_destroy(s);
}

/* The tissue values of the limb's muscles: 8 numbers. */
static void read_tissues(const sn_scene *s, double out[8])
{
    int n = 0;
    for (int32_t i = 0; i < 3; i++)
        for (int32_t k = 0; k < sn_scene_muscle(s, i)->head[0].n_point; k++)
            out[n++] = sn_scene_muscle(s, i)->head[0].tissue[k];
    assert_int_equal(n, 8);
}

static void wrong_volumes(void **state)
{
    (void)state;
    sn_scene *s = made_limb();
    sn_error err = {.msg = ""};
    double first = volume_of(s, FLEXOR), body = sn_tet_mesh_volume(&sn_scene_body(s)->mesh), tissue[8],
           now[8], v;
    double *before = copy_fields(s);
    read_tissues(s, tissue);
    assert_message(sn_scene_set_volume(s, 0, 0.0, &one_thread, &err), &err,
                   "muscle 'flexor': volume is 0, need > 0");
    assert_message(sn_scene_set_volume(s, 0, -2.0, &one_thread, &err), &err,
                   "muscle 'flexor': volume is -2, need > 0");
    assert_message(sn_scene_set_volume(s, 0, (double)NAN, &one_thread, &err), &err,
                   "volume is nan, need > 0");
    assert_message(sn_scene_set_volume(s, 0, (double)INFINITY, &one_thread, &err), &err,
                   "volume is inf, need > 0");
    assert_message(sn_scene_set_volume(s, 3, 1.0, &one_thread, &err), &err, "muscle 4, need 1..3");
    assert_message(sn_scene_muscle_volume(s, -1, &one_thread, &v, &err), &err, "muscle 0, need 1..3");
    assert_message(sn_scene_set_preserve_volume(s, 5, true, &one_thread, &err), &err, "muscle 6, need 1..3");
    assert_memory_equal(before, sn_scene_fields(s), fields_size(s));
    assert_message(sn_scene_set_volume(s, 0, 1.01 * body, &one_thread, &err), &err,
                   "muscle 'flexor': no tissue value gives a volume of ");
    assert_non_null(strstr(err.msg, ": crowded by its neighbours and the skin it can reach at most "));
    double most = atof(strstr(err.msg, "at most ") + 8);
    assert_true(most > first && most < body);
    read_tissues(s, now);
    assert_memory_equal(tissue, now, sizeof now);
    solve_scene(s);
    assert_true(largest_difference(s, before) < 1e-11);
    assert_rel(volume_of(s, FLEXOR), first, 1e-9);
    set_volume(s, FLEXOR, 0.999 * most); /* what the message says is possible is possible */
    assert_rel(volume_of(s, FLEXOR), 0.999 * most, 1e-4);
    sn_release(before);
    sn_scene_destroy(s);
    assert_int_equal(sn_scene_create(&s, "empty", "m", SN_UP_Y, NULL), SN_OK);
    assert_message(sn_scene_muscle_volume(s, 0, &one_thread, &v, &err), &err, "muscle 1, need 1..0");
    sn_scene_destroy(s);
}

static void an_empty_muscle_has_nothing_to_keep(void **state)
{
    (void)state;
    sn_scene *s = made_limb();
    sn_error err = {.msg = ""};
    const sn_head *h = &sn_scene_muscle(s, FLEXOR)->head[0]; /* the curve of a stronger one */
    assert_int_equal(sn_scene_add_muscle(s, "weak", h->point, (double[]){1e-3, 1e-3, 1e-3}, 3, NULL), SN_OK);
    assert_true(volume_of(s, 3) == 0.0);
    assert_message(sn_scene_set_preserve_volume(s, 3, true, &one_thread, &err), &err,
                   "muscle 'weak': it is empty, there is no volume to keep");
    assert_true(sn_scene_kept_volume(s, 3) == 0.0);
    sn_scene_destroy(s);
}

/* ---- keeping ---- */

/* Step k of an edit: points wander, frames turn, fat changes, a neighbour grows. */
static void edit(sn_scene *s, int k)
{
    sn_vec3 p = sn_v3(0.02 * k, 0.03 * k - 0.2, 0.6 - 0.012 * k);
    const sn_anisotropy frame = {true, 12.0 * k, {1, 1 + 0.3 * k, 1}, true, {1, 0, 0}};
    sn_status st = SN_OK;
    switch (k % 5) {
    case 0:
        st = sn_scene_set_point(s, FLEXOR, 0, 1, p, NULL);
        break;
    case 1:
        st = sn_scene_set_anisotropy(s, FLEXOR, &frame, NULL);
        break;
    case 2:
        st = sn_scene_set_fat(s, 0.15 + 0.01 * k, NULL);
        break;
    case 3:
        st = sn_scene_insert_point(s, FLEXOR, 0, 1, sn_v3(0.02 * k, -0.5, 0.55), 1.0, NULL);
        break;
    default:
        st = sn_scene_set_tissue(s, ABDUCTOR, 0, -1, 1.0 + 0.05 * k, NULL);
        break;
    }
    assert_int_equal(st, SN_OK);
    if (k % 5 == 4) assert_int_equal(sn_scene_remove_point(s, FLEXOR, 0, 1, NULL), SN_OK);
}

static void a_kept_volume_stays(void **state)
{
    (void)state;
    sn_scene *s = made_limb();
    double volume = volume_of(s, FLEXOR), least = 1e9, most = 0.0;
    keep(s, FLEXOR, true);
    assert_rel(sn_scene_kept_volume(s, FLEXOR), volume, 1e-12);
    for (int k = 0; k < 20; k++) {
        edit(s, k);
        assert_null(sn_scene_fields(s));
        solve_scene(s);
        assert_rel(volume_of(s, FLEXOR), volume, 1e-3);
        assert_rel(extracted_volume(s, FLEXOR), volume, 1e-3);
        least = fmin(least, sn_scene_muscle(s, FLEXOR)->head[0].tissue[0]);
        most = fmax(most, sn_scene_muscle(s, FLEXOR)->head[0].tissue[0]);
    }
    assert_true(most > 1.1 * least); /* it took something */
    double *fields = copy_fields(s);
    uint64_t revision = sn_scene_revision(s);
    solve_scene(s); /* nothing to do */
    assert_int_equal(sn_scene_revision(s), revision);
    assert_memory_equal(fields, sn_scene_fields(s), fields_size(s));
    keep(s, FLEXOR, false);
    assert_true(sn_scene_kept_volume(s, FLEXOR) == 0.0);
    assert_memory_equal(fields, sn_scene_fields(s), fields_size(s));
    assert_int_equal(sn_scene_set_fat(s, 0.1, NULL), SN_OK);
    assert_true(volume_of(s, FLEXOR) > 1.02 * volume); /* free again */
    sn_release(fields);
    sn_scene_destroy(s);
}

static void a_kept_volume_survives_other_muscles_and_meshes(void **state)
{
    (void)state;
    sn_scene *s = made_limb();
    const double near[] = {0.3, -0.9, 0.4, 0.35, 0.9, 0.4};
    double volume = volume_of(s, FLEXOR);
    keep(s, FLEXOR, true);
    assert_int_equal(sn_scene_add_muscle(s, "near", near, NULL, 2, NULL), SN_OK);
    solve_scene(s);
    assert_rel(volume_of(s, FLEXOR), volume, 1e-3);
    assert_int_equal(sn_scene_remove_muscle(s, "near", NULL), SN_OK);
    assert_int_equal(sn_scene_remove_muscle(s, "extensor", NULL), SN_OK);
    assert_rel(volume_of(s, FLEXOR), volume, 1e-3);
    mesh_scene(s, 0.25);
    assert_rel(volume_of(s, FLEXOR), volume, 1e-3);
    assert_rel(sn_scene_kept_volume(s, FLEXOR), volume, 1e-12);
    set_volume(s, FLEXOR, 0.8 * volume); /* from now on this is what is kept */
    assert_rel(sn_scene_kept_volume(s, FLEXOR), 0.8 * volume, 1e-12);
    assert_int_equal(sn_scene_set_fat(s, 0.3, NULL), SN_OK);
    assert_rel(volume_of(s, FLEXOR), 0.8 * volume, 1e-3);
    sn_scene_destroy(s);
}

/* Muscles that share a border and both keep their volumes; the third gives way. */
static void neighbours_both_keep_theirs(void **state)
{
    (void)state;
    sn_scene *s = made_limb();
    const double near[] = {0.3, -0.9, 0.4, 0.35, 0.9, 0.4};
    assert_int_equal(sn_scene_add_muscle(s, "near", near, NULL, 2, NULL), SN_OK);
    double a = volume_of(s, FLEXOR), b = volume_of(s, 3), c = volume_of(s, ABDUCTOR);
    keep(s, FLEXOR, true);
    keep(s, 3, true);
    for (int k = 0; k < 6; k++) {
        sn_vec3 p = sn_v3(0.04 * k, 0, 0.6 - 0.02 * k);
        assert_int_equal(sn_scene_set_point(s, FLEXOR, 0, 1, p, NULL), SN_OK);
        solve_scene(s);
        assert_rel(volume_of(s, FLEXOR), a, 1e-3);
        assert_rel(volume_of(s, 3), b, 1e-3);
        assert_rel(extracted_volume(s, FLEXOR), a, 2e-3);
        assert_rel(extracted_volume(s, 3), b, 2e-3);
    }
    assert_true(fabs(volume_of(s, ABDUCTOR) / c - 1.0) > 1e-3);
    set_volume(s, ABDUCTOR,
               1.2 * c); /* the kept ones take back what that takes, and it is met all the same */
    assert_rel(volume_of(s, ABDUCTOR), 1.2 * c, 1e-4);
    assert_rel(volume_of(s, FLEXOR), a, 1e-4);
    assert_rel(volume_of(s, 3), b, 1e-4);
    assert_true(sn_scene_kept_volume(s, ABDUCTOR) == 0.0);
    sn_scene_destroy(s);
}

static void same_bits_with_any_threads(void **state)
{
    (void)state;
    double *fields[2];
    size_t size = 0;
    for (int i = 0; i < 2; i++) {
        sn_scene *s = made_limb();
        sn_run run = {.n_threads = 1 + i};
        assert_int_equal(sn_scene_set_preserve_volume(s, FLEXOR, true, &run, NULL), SN_OK);
        assert_int_equal(sn_scene_set_preserve_volume(s, EXTENSOR, true, &run, NULL), SN_OK);
        for (int k = 0; k < 4; k++) {
            edit(s, k);
            assert_int_equal(sn_scene_solve(s, &run, NULL, NULL), SN_OK);
        }
        fields[i] = copy_fields(s);
        size = fields_size(s);
        sn_scene_destroy(s);
    }
    assert_memory_equal(fields[0], fields[1], size);
    for (int i = 0; i < 2; i++) sn_release(fields[i]);
}

/* ---- what cannot be kept ---- */

/* The limb gets thinner than its muscle. */
static void crowded_out(void **state)
{
    (void)state;
    sn_scene *s = made_limb();
    sn_error err = {.msg = ""};
    double tissue[8], now[8];
    sn_tri_mesh thin = made_capsule(sn_v3(0, -1.2, 0), sn_v3(0, 1.2, 0), 0.7, 0.3);
    set_volume(s, FLEXOR, 4.6);
    keep(s, FLEXOR, true);
    keep(s, EXTENSOR, true);
    assert_int_equal(sn_scene_set_skin(s, &thin, NULL), SN_OK);
    read_tissues(s, tissue);
    for (int round = 0; round < 2; round++) { /* it fails each time, and the same way */
        assert_message(sn_scene_solve(s, &one_thread, NULL, &err), &err,
                       "muscle 'flexor': no tissue value gives a volume of 4.6: ");
        assert_non_null(strstr(err.msg, "crowded by its neighbours and the skin it can reach at most "));
        assert_null(sn_scene_fields(s));
        read_tissues(s, now);
        assert_memory_equal(tissue, now, sizeof now);
    }
    double volume;
    assert_message(sn_scene_muscle_volume(s, ABDUCTOR, &one_thread, &volume, &err), &err,
                   "muscle 'flexor': ");
    assert_rel(sn_scene_kept_volume(s, FLEXOR), 4.6, 1e-4);
    keep(s, FLEXOR, false);
    solve_scene(s);
    assert_true(volume_of(s, FLEXOR) < 4.6);
    assert_rel(volume_of(s, EXTENSOR), sn_scene_kept_volume(s, EXTENSOR), 1e-3);
    sn_tri_mesh_free(&thin);
    sn_scene_destroy(s);
}

/* Two that want three fifths of the limb each. */
static void too_much_for_two(void **state)
{
    (void)state;
    sn_scene *s = made_limb();
    sn_error err = {.msg = ""};
    solve_scene(s);
    double most = 0.6 * sn_tet_mesh_volume(&sn_scene_body(s)->mesh), tissue[8], now[8];
    set_volume(s, FLEXOR, most);
    keep(s, FLEXOR, true);
    read_tissues(s, tissue);
    sn_status st = sn_scene_set_volume(s, EXTENSOR, most, &one_thread, &err);
    assert_message(st, &err, "muscle 'extensor': there is no room for a volume of ");
    const char *room = strstr(err.msg, "beside those that other muscles keep: about ");
    assert_non_null(room);
    read_tissues(s, now);
    assert_memory_equal(tissue, now, sizeof now);
    assert_true(sn_scene_kept_volume(s, EXTENSOR) == 0.0);
    solve_scene(s);
    assert_rel(volume_of(s, FLEXOR), most, 1e-3);
    keep(s, FLEXOR, false);
    set_volume(s, EXTENSOR, most);
    assert_rel(volume_of(s, EXTENSOR), most, 1e-5);
    sn_scene_destroy(s);
}

static void interrupted_and_taken_up(void **state)
{
    (void)state;
    sn_scene *s = made_limb();
    sn_error err = {.msg = ""};
    volatile sig_atomic_t cancel = 1;
    sn_run stop = {.cancel = &cancel};
    double volume = volume_of(s, FLEXOR), tissue[8], now[8];
    keep(s, FLEXOR, true);
    read_tissues(s, tissue);
    assert_int_equal(sn_scene_set_volume(s, FLEXOR, 0.5 * volume, &stop, &err), SN_ECANCEL);
    read_tissues(s, now);
    assert_memory_equal(tissue, now, sizeof now);
    assert_rel(sn_scene_kept_volume(s, FLEXOR), volume, 1e-12);
    assert_int_equal(sn_scene_set_fat(s, 0.3, NULL), SN_OK);
    assert_int_equal(sn_scene_solve(s, &stop, NULL, &err), SN_ECANCEL);
    assert_null(sn_scene_fields(s));
    solve_scene(s);
    assert_rel(volume_of(s, FLEXOR), volume, 1e-3);
    sn_scene_destroy(s);
}

static void short_of_memory(void **state)
{
    (void)state;
    sn_scene *s = made_limb();
    double volume = volume_of(s, FLEXOR);
    sn_run run = {.n_threads = 1};
    keep(s, FLEXOR, true);
    sn_status st = SN_ENOMEM;
    int left = 0;
    for (; st == SN_ENOMEM; left++) {
        sn_error err = {.msg = ""};
        ration r = {.left = left};
        assert_int_equal(sn_scene_set_fat(s, 0.3 + 1e-3 * left, NULL), SN_OK);
        sn_set_allocator(RATION(r));
        st = sn_scene_solve(s, &run, NULL, &err);
        sn_set_allocator(NULL);
        if (st) assert_non_null(strstr(err.msg, "memory"));
        if (st) assert_null(sn_scene_fields(s));
    }
    assert_int_equal(st, SN_OK);
    assert_true(left > 4);
    assert_rel(volume_of(s, FLEXOR), volume, 1e-3);
    sn_scene_destroy(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(volumes_are_those_of_the_extraction),
        cmocka_unit_test(a_volume_is_hit),
        cmocka_unit_test(wrong_volumes),
        cmocka_unit_test(an_empty_muscle_has_nothing_to_keep),
        cmocka_unit_test(a_kept_volume_stays),
        cmocka_unit_test(a_kept_volume_survives_other_muscles_and_meshes),
        cmocka_unit_test(neighbours_both_keep_theirs),
        cmocka_unit_test(same_bits_with_any_threads),
        cmocka_unit_test(crowded_out),
        cmocka_unit_test(too_much_for_two),
        cmocka_unit_test(interrupted_and_taken_up),
        cmocka_unit_test(short_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
