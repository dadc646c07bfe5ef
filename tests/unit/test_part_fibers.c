/* test_part_fibers - fibers, lines, tendon and architecture of parts whose shape is known. */
#include "extract/part_fibers.h"
#include "tetra/locate.h"

#include "failing_memory.h"
#include "made_fibers.h"

static const char *const names[] = {"fat", "psoas", "iliacus"};
static const double along_z[] = {0, 0, 0, 0, 0, 2};

static sn_vec3 in_cylinder(double x, double y, double s)
{
    return sn_v3(0.3 * x, 0.3 * y, 2.0 * s);
}

/* The first muscle wins below z = top, the second above. */
static sn_extraction extraction_of(const sn_tet_mesh *m, double top)
{
    size_t n = (size_t)m->n_vert;
    double *value = SN_NEW_ZERO(double, 3 * n);
    sn_extraction x;
    sn_error err = {.msg = ""};
    for (size_t v = 0; v < n; v++) {
        value[n + v] = 10.0 + top - m->pos[3 * v + 2];
        value[2 * n + v] = 10.0 + m->pos[3 * v + 2] - top;
    }
    sn_extraction_init(&x);
    if (sn_extract(m, value, names, 3, NULL, NULL, &x, &err)) fail_msg("%s", err.msg);
    sn_release(value);
    return x;
}

static sn_extraction whole(const sn_tet_mesh *m) /* all of it the first muscle's */
{
    return extraction_of(m, 1000.0);
}

static sn_part_fibers fibers_of(const sn_extraction *x, const sn_tet_mesh *input, int32_t tissue,
                                const sn_muscle *m)
{
    sn_part_fibers p;
    sn_error err = {.msg = ""};
    if (sn_part_fibers_build(&p, x, input, tissue, m, NULL, &err)) fail_msg("%s", err.msg);
    return p;
}

static sn_part_architecture architecture_of(const sn_tet_mesh *input, const sn_muscle *m)
{
    sn_extraction x = whole(input);
    sn_part_fibers p = fibers_of(&x, input, 1, m);
    sn_part_architecture a;
    sn_error err = {.msg = ""};
    if (sn_part_architecture_find(&p, &x, NULL, &a, &err)) fail_msg("%s", err.msg);
    assert_int_equal(p.n_tet, sn_extraction_part_tets(&x, 1));
    sn_part_fibers_free(&p);
    sn_extraction_free(&x);
    return a;
}

static void set_tendon(sn_muscle *m, double length, double area)
{
    sn_error err = {.msg = ""};
    if (sn_muscle_set_tendon(m, &(sn_tendon){length, area}, &err)) fail_msg("%s", err.msg);
}

static void assert_rel(double got, double want, double tolerance)
{
    if (!(fabs(got - want) <= tolerance * fabs(want))) fail_msg("%.9g where %.9g was wanted", got, want);
}

/* ---- architecture ---- */

static const tube cylinder = {4, 16, 32, in_cylinder};

static void architecture_of_a_cylinder(void **state)
{
    (void)state;
    sn_tet_mesh body = made_tube(&cylinder);
    sn_muscle m = curve_muscle(along_z, 2);
    sn_part_architecture a = architecture_of(&body, &m);
    double section = 0.09 * disc_area(&cylinder);
    assert_rel(a.volume, 2.0 * section, 1e-9);
    assert_true(a.belly_volume == a.volume);
    assert_rel(a.fiber_length, 2.0, 0.02);
    assert_rel(a.pcsa, section, 0.03);
    assert_true(a.pennation_deg < 1e-3);
    assert_int_equal(a.check.sinks + a.check.sources + a.check.flipped + a.check.still, 0);
    sn_muscle_free(&m);
    sn_tet_mesh_free(&body);
}

/* 0.25 of tendon at each end: the border lies on a layer of the mesh. */
static void tendon_is_no_belly(void **state)
{
    (void)state;
    sn_tet_mesh body = made_tube(&cylinder);
    sn_muscle m = curve_muscle(along_z, 2);
    set_tendon(&m, 0.25, 0.0);
    sn_part_architecture a = architecture_of(&body, &m);
    double section = 0.09 * disc_area(&cylinder);
    assert_rel(a.volume, 2.0 * section, 1e-9);
    assert_rel(a.volume - a.belly_volume, 0.5 * section, 0.02);
    assert_rel(a.fiber_length, 1.5, 0.02);
    assert_rel(a.pcsa, section, 0.03);
    set_tendon(&m, 1.5, 0.0); /* nothing else */
    a = architecture_of(&body, &m);
    assert_true(a.belly_volume == 0.0 && a.fiber_length == 0.0 && a.pcsa == 0.0 && a.pennation_deg == 0.0);
    assert_rel(a.volume, 2.0 * section, 1e-9);
    sn_muscle_free(&m);
    sn_tet_mesh_free(&body);
}

/* A block [0, 10] x [-0.25, 0.25] x [-0.2, 0.2], the curve along x: e3 is z, 0.4 thick. */
static sn_tet_mesh made_block(void)
{
    sn_tet_mesh m = made_lattice(10, sn_v3(0, 0, 0), 0.1);
    for (int32_t v = 0; v < m.n_vert; v++) {
        sn_vec3 p = sn_tet_mesh_point(&m, v);
        sn_v3_store(m.pos + 3 * v, sn_v3(10.0 * p.x, 0.5 * p.y - 0.25, 0.4 * p.z - 0.2));
    }
    return m;
}

static const double along_x[] = {0, 0, 0, 10, 0, 0};

static void architecture_of_pennate_blocks(void **state)
{
    (void)state;
    sn_tet_mesh block = made_block();
    sn_muscle m = curve_muscle(along_x, 2);
    make_pennate(&m, &(sn_pennation){.kind = SN_UNIPENNATE, .angle_deg = {20.0}, .n_angle = 1});
    sn_part_architecture a = architecture_of(&block, &m);
    assert_rel(a.volume, 2.0, 1e-9);
    assert_true(fabs(a.pennation_deg - 20.0) < 1e-6);
    assert_rel(a.fiber_length, 0.4 / sin_deg(20.0), 0.1); /* shorter near the block's ends */
    assert_rel(a.pcsa, a.belly_volume * cos_deg(20.0) / a.fiber_length, 1e-12);
    /* Bipennate: to the sheet in the middle and no further, from both sides: half as long. */
    make_pennate(&m, &(sn_pennation){.kind = SN_BIPENNATE, .angle_deg = {20.0}, .n_angle = 1});
    sn_part_architecture b = architecture_of(&block, &m);
    assert_rel(b.fiber_length, 0.2 / sin_deg(20.0), 0.1);
    assert_rel(b.pcsa, 2.0 * a.pcsa, 0.1);
    assert_true(fabs(b.pennation_deg - 20.0) < 1e-6);
    /* Three sheets: six rooms, a third as long again. */
    make_pennate(&m,
                 &(sn_pennation){.kind = SN_MULTIPENNATE, .angle_deg = {20.0}, .n_angle = 1, .n_sheet = 3});
    sn_part_architecture c = architecture_of(&block, &m);
    assert_rel(c.fiber_length, 0.2 / 3.0 / sin_deg(20.0), 0.1);
    sn_muscle_free(&m);
    sn_tet_mesh_free(&block);
}

/* ---- samples ---- */

static void samples_in_the_order_of_the_tets(void **state)
{
    (void)state;
    sn_tet_mesh body = made_tube(&cylinder);
    sn_extraction x = extraction_of(&body, 1.03);
    sn_muscle m = curve_muscle(along_z, 2);
    set_tendon(&m, 0.3, 0.0);
    sn_part_fibers p = fibers_of(&x, &body, 2, &m); /* from z = 1.03 up */
    sn_vec3 *centre = SN_NEW(sn_vec3, p.n_tet), *direction = SN_NEW(sn_vec3, p.n_tet);
    double *u = SN_NEW(double, p.n_tet);
    bool *is_tendon = SN_NEW(bool, p.n_tet);
    sn_part_fibers_sample(&p, &x, NULL, centre, direction, u, is_tendon);
    assert_int_equal(p.n_tet, sn_extraction_part_tets(&x, 2));
    int n_tendon = 0;
    for (int32_t i = 0; i < p.n_tet; i++) {
        assert_int_equal(x.mesh.part[p.tet[i]], 2);
        assert_int_equal(x.source[p.tet[i]], p.source[i]);
        assert_true(i == 0 || p.tet[i - 1] < p.tet[i]);
        assert_true(sn_v3_dist(centre[i], sn_tet_mesh_centre(&x.mesh, p.tet[i])) < 1e-15);
        assert_true(centre[i].z > 1.03);
        assert_true(angle_deg(direction[i], sn_v3(0, 0, 1)) < 1.0);
        assert_true(fabs(u[i] - 0.5 * centre[i].z) < 0.01);
        assert_true(is_tendon[i] == (centre[i].z > 1.7));
        n_tendon += is_tendon[i];
    }
    assert_true(n_tendon > 10 && n_tendon < p.n_tet);
    sn_part_fibers_sample(&p, &x, NULL, NULL, NULL, NULL, NULL); /* all skipped */
    sn_release(centre);
    sn_release(direction);
    sn_release(u);
    sn_release(is_tendon);
    sn_part_fibers_free(&p);
    sn_part_fibers_free(&p);
    sn_muscle_free(&m);
    sn_extraction_free(&x);
    sn_tet_mesh_free(&body);
}

/* ---- lines ---- */

static sn_polylines lines_of(const sn_part_fibers *p, const sn_extraction *x, int32_t n)
{
    sn_polylines l;
    sn_error err = {.msg = ""};
    sn_polylines_init(&l, true);
    if (sn_part_fibers_lines(p, x, n, NULL, &l, &err)) fail_msg("%s", err.msg);
    return l;
}

/* A quarter of a torus about the y axis at x = 1.2. */
static sn_vec3 in_bend(double x, double y, double s)
{
    double r = 1.2 - 0.3 * x, a = 0.5 * TEST_PI * s;
    return sn_v3(1.2 - r * cos(a), 0.3 * y, r * sin(a));
}

static void lines_stay_inside_and_bend_gently(void **state)
{
    (void)state;
    sn_tet_mesh body = made_tube(&(tube){4, 16, 32, in_bend});
    double point[3 * 33];
    for (int k = 0; k < 33; k++) sn_v3_store(point + 3 * k, in_bend(0, 0, k / 32.0));
    sn_muscle m = curve_muscle(point, 33);
    sn_extraction x = whole(&body);
    sn_part_fibers p = fibers_of(&x, &body, 1, &m);
    sn_polylines l = lines_of(&p, &x, 50);
    sn_locator *locator = NULL;
    assert_int_equal(sn_locator_create(&locator, &x.mesh, NULL), SN_OK);
    assert_int_equal(l.n_line, 50);
    int n_deep = 0;
    for (size_t i = 0; i < l.n_line; i++) {
        assert_int_equal(l.part[i], 1);
        sn_vec3 first = sn_polylines_point(&l, (size_t)l.first[i]);
        double r = hypot(first.x - 1.2, first.z), length = sn_polylines_length(&l, i);
        bool is_deep = hypot(r - 1.2, first.y) < 0.25;            /* others may leave through the side */
        if (is_deep) assert_rel(length, 0.5 * TEST_PI * r, 0.03); /* a quarter of its circle */
        assert_true(length < 0.5 * TEST_PI * r * 1.03);
        n_deep += is_deep;
        for (int64_t k = l.first[i]; k < l.first[i + 1]; k++) {
            sn_vec3 q = sn_polylines_point(&l, (size_t)k);
            assert_true(sn_locator_find(locator, q, NULL) >= 0);
            if (!(fabs(hypot(q.x - 1.2, q.z) - r) < 0.03))
                fail_msg("%g off its circle", hypot(q.x - 1.2, q.z) - r);
            if (k > l.first[i]) assert_true(l.value[k] >= l.value[k - 1]); /* from origin to insertion */
            if (k < l.first[i] + 2) continue;
            sn_vec3 b = sn_polylines_point(&l, (size_t)k - 1), a = sn_polylines_point(&l, (size_t)k - 2);
            assert_true(angle_deg(sn_v3_sub(b, a), sn_v3_sub(q, b)) < 6.0);
        }
        if (is_deep) assert_true(l.value[l.first[i]] < 0.02 && l.value[l.first[i + 1] - 1] > 0.98);
    }
    assert_true(n_deep > 25);
    sn_polylines more = lines_of(&p, &x, 7);
    assert_int_equal(more.n_line, 7);
    assert_int_equal(sn_part_fibers_lines(&p, &x, 3, NULL, &more, NULL), SN_OK); /* appends */
    assert_int_equal(more.n_line, 10);
    sn_polylines_free(&more);
    sn_polylines_free(&l);
    sn_locator_destroy(locator);
    sn_part_fibers_free(&p);
    sn_extraction_free(&x);
    sn_muscle_free(&m);
    sn_tet_mesh_free(&body);
}

/* In a bipennate block lines end at the sheet z = 0 that they run to; each keeps to its side. */
static void lines_end_at_the_sheet(void **state)
{
    (void)state;
    sn_tet_mesh block = made_block();
    sn_muscle m = curve_muscle(along_x, 2);
    make_pennate(&m, &(sn_pennation){.kind = SN_BIPENNATE, .angle_deg = {20.0}, .n_angle = 1});
    sn_extraction x = whole(&block);
    sn_part_fibers p = fibers_of(&x, &block, 1, &m);
    sn_polylines l = lines_of(&p, &x, 40);
    for (size_t i = 0; i < l.n_line; i++) {
        sn_vec3 a = sn_polylines_point(&l, (size_t)l.first[i]);
        sn_vec3 b = sn_polylines_point(&l, (size_t)l.first[i + 1] - 1);
        assert_true(fabs(b.z) < fabs(a.z) && a.x < b.x);
        if (b.x < 9.99) assert_true(fabs(b.z) < 1e-3); /* the sheet */
        if (a.x > 0.01) assert_true(fabs(fabs(a.z) - 0.2) < 1e-3);
        if (b.x < 9.99 && a.x > 0.01) assert_rel(sn_polylines_length(&l, i), 0.2 / sin_deg(20.0), 0.01);
    }
    sn_polylines_free(&l);
    sn_part_fibers_free(&p);
    sn_extraction_free(&x);
    sn_muscle_free(&m);
    sn_tet_mesh_free(&block);
}

static void any_number_of_threads_gives_the_same_bits(void **state)
{
    (void)state;
    sn_tet_mesh body = made_tube(&(tube){3, 10, 10, in_bend});
    sn_muscle m = curve_muscle((const double[]){0, 0, 0, 0.4, 0, 0.9, 1.2, 0, 1.2}, 3);
    sn_extraction x = whole(&body);
    const sn_muscle *known[] = {&m};
    assert_int_equal(sn_extraction_set_muscles(&x, known, 1, NULL), SN_OK);
    size_t n = (size_t)x.mesh.n_tet;
    double *value[2];
    for (int k = 0; k < 2; k++) {
        value[k] = SN_NEW(double, 4 * n);
        assert_int_equal(sn_extraction_fibers(&x, &body, -1, &(sn_run){.n_threads = 1 + k}, value[k],
                                              value[k] + 3 * n, NULL),
                         SN_OK);
    }
    assert_memory_equal(value[0], value[1], 4 * n * sizeof(double));
    sn_release(value[0]);
    sn_release(value[1]);
    sn_extraction_free(&x);
    sn_muscle_free(&m);
    sn_tet_mesh_free(&body);
}

/* ---- all muscles at once ---- */

/* The second muscle has two heads that share no end: it keeps 0, and so does what is asked for alone. */
static void directions_of_all(void **state)
{
    (void)state;
    static const double a[] = {0.1, 0, 1, 0.1, 0, 1.5}, b[] = {-0.1, 0, 1.5, -0.1, 0, 2};
    sn_tet_mesh body = made_tube(&cylinder);
    sn_extraction x = extraction_of(&body, 1.03);
    sn_muscle lower = curve_muscle((const double[]){0, 0, 0, 0, 0, 1.03}, 2);
    sn_muscle apart = heads_muscle((const sn_head_points[]){{a, NULL, 2}, {b, NULL, 2}}, 2);
    set_tendon(&lower, 0.2, 0.0);
    assert_int_equal(sn_extraction_set_muscles(&x, (const sn_muscle *const[]){&lower, &apart}, 2, NULL),
                     SN_OK);
    size_t n = (size_t)x.mesh.n_tet;
    double *fiber = SN_NEW(double, 3 * n), *tendon = SN_NEW(double, n);
    for (int32_t asked = -1; asked <= 2; asked++) {
        sn_error err = {.msg = ""};
        if (sn_extraction_fibers(&x, &body, asked, NULL, fiber, tendon, &err)) fail_msg("%s", err.msg);
        for (size_t t = 0; t < n; t++) {
            sn_vec3 d = sn_v3_load(fiber + 3 * t), c = sn_tet_mesh_centre(&x.mesh, (int32_t)t);
            bool has = x.mesh.part[t] == 1 && (asked < 0 || asked == 1);
            assert_true(has ? angle_deg(d, sn_v3(0, 0, 1)) < 1.0 : sn_v3_len(d) == 0.0);
            assert_true(tendon[t] == (has && (c.z < 0.2 || c.z > 0.83) ? 1.0 : 0.0));
        }
    }
    sn_release(fiber);
    sn_release(tendon);
    sn_muscle_free(&lower);
    sn_muscle_free(&apart);
    sn_extraction_free(&x);
    sn_tet_mesh_free(&body);
}

/* ---- errors ---- */

static void assert_refused(const sn_extraction *x, const sn_tet_mesh *input, int32_t tissue,
                           const sn_muscle *m, const char *message)
{
    sn_part_fibers p;
    sn_error err = {.msg = ""};
    assert_int_equal(sn_part_fibers_build(&p, x, input, tissue, m, NULL, &err), SN_EINVAL);
    assert_string_equal(err.msg, message);
    assert_null(p.tet);
    assert_null(p.fibers.u);
}

static void messages(void **state)
{
    (void)state;
    static const double a[] = {0.1, 0, 0, 0.1, 0, 1}, b[] = {-0.1, 0, 1, -0.1, 0, 2};
    sn_tet_mesh body = made_tube(&(tube){2, 8, 8, in_cylinder});
    sn_extraction x = whole(&body);
    sn_muscle one = curve_muscle(along_z, 2);
    sn_muscle apart = heads_muscle((const sn_head_points[]){{a, NULL, 2}, {b, NULL, 2}}, 2);
    assert_refused(&x, &body, 1, NULL, "part 'psoas' has no curve that fibers could follow: give one");
    assert_refused(&x, &body, 0, NULL, "part 'fat' has no curve that fibers could follow: give one");
    assert_int_equal(sn_extraction_set_muscles(&x, (const sn_muscle *const[]){&one}, 1, NULL), SN_OK);
    assert_refused(&x, &body, 0, NULL, "part 'fat' is no muscle: it has no fibers");
    assert_refused(&x, &body, 2, NULL, "part 'iliacus' has no curve that fibers could follow: give one");
    assert_refused(&x, &body, 2, &one, "fibers of muscle 'psoas': it is empty");
    assert_refused(&x, &body, 1, &apart,
                   "fibers of muscle 'psoas': its 2 heads share neither an insertion (last point) nor an "
                   "origin (first point)");
    sn_muscle_free(&one);
    sn_muscle_free(&apart);
    sn_extraction_free(&x);
    sn_tet_mesh_free(&body);
}

static sn_status do_all(const sn_extraction *x, const sn_tet_mesh *input, sn_error *err)
{
    const sn_run run = {.n_threads = 1};
    sn_part_fibers p;
    sn_part_architecture a;
    sn_status st = sn_part_fibers_build(&p, x, input, 1, NULL, &run, err);
    if (!st) st = sn_part_architecture_find(&p, x, &run, &a, err);
    sn_part_fibers_free(&p);
    return st;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    sn_tet_mesh body = made_tube(&(tube){1, 4, 2, in_cylinder});
    sn_muscle m = curve_muscle(along_z, 2);
    sn_extraction x = whole(&body);
    assert_int_equal(sn_extraction_set_muscles(&x, (const sn_muscle *const[]){&m}, 1, NULL), SN_OK);
    int n = 0;
    for (;; n++) {
        failing mem = {.left = n};
        sn_error err = {.msg = ""};
        sn_set_allocator(&(sn_allocator){failing_realloc, &mem});
        sn_status st = do_all(&x, &body, &err);
        sn_set_allocator(NULL);
        assert_int_equal(mem.n_alive, 0);
        if (!st) break;
        if (st != SN_ENOMEM || !err.msg[0]) fail_msg("allocation %d: status %d, '%s'", n, st, err.msg);
    }
    assert_true(n > 30);
    for (n = 0;; n++) {
        failing mem = {.left = n};
        sn_error err = {.msg = ""};
        double fiber[3 * 64], tendon[64];
        assert_true(x.mesh.n_tet <= 64);
        sn_set_allocator(&(sn_allocator){failing_realloc, &mem});
        sn_status st = sn_extraction_fibers(&x, &body, -1, &(sn_run){.n_threads = 1}, fiber, tendon, &err);
        sn_set_allocator(NULL);
        assert_int_equal(mem.n_alive, 0);
        if (!st) break;
        assert_int_equal(st, SN_ENOMEM);
    }
    assert_true(n > 20);
    sn_muscle_free(&m);
    sn_extraction_free(&x);
    sn_tet_mesh_free(&body);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(architecture_of_a_cylinder),
        cmocka_unit_test(tendon_is_no_belly),
        cmocka_unit_test(architecture_of_pennate_blocks),
        cmocka_unit_test(samples_in_the_order_of_the_tets),
        cmocka_unit_test(lines_stay_inside_and_bend_gently),
        cmocka_unit_test(lines_end_at_the_sheet),
        cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
        cmocka_unit_test(directions_of_all),
        cmocka_unit_test(messages),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
