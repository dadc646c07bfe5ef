/* Halves of surfaces: what is kept, the cap, and what cannot be cut. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "mesh/mesh_check.h"
#include "mesh/surface_io.h"
#include "mesh/tri_cut.h"

#include "closed_surface.h"
#include "failing_memory.h"
#include "made_mesh.h"

#include <stdio.h>

enum { cap_label = 77 };

typedef struct half {
    sn_tri_mesh mesh;
    int32_t *from;
} half;

static void half_free(half *h)
{
    sn_tri_mesh_free(&h->mesh);
    sn_release(h->from);
}

static half cut(const sn_tri_mesh *m, sn_vec3 point, sn_vec3 normal)
{
    half h;
    sn_error err = {0};
    sn_tri_mesh_init(&h.mesh);
    if (sn_tri_mesh_cut(m, point, normal, cap_label, NULL, &h.mesh, &h.from, &err)) fail_msg("%s", err.msg);
    return h;
}

static double cap_area(const half *h)
{
    double sum = 0.0;
    for (int32_t f = 0; f < h->mesh.n_face; f++)
        if (h->from[f] < 0) sum += 0.5 * sn_v3_len(sn_tri_mesh_face_normal(&h->mesh, f));
    return sum;
}

/* No vertex lies beyond the plane, the cap lies in it and looks away from what is kept, the other faces come
 * from faces of m in order. */
static void assert_is_half(const half *h, const sn_tri_mesh *m, sn_vec3 point, sn_vec3 normal)
{
    sn_plane plane;
    double near = 1e-14 * (sn_box3_diagonal(sn_tri_mesh_bounds(m)) + sn_v3_len(point));
    int32_t last = 0;
    assert_int_equal(sn_plane_make(&plane, "test", point, normal, NULL), SN_OK);
    for (int32_t v = 0; v < h->mesh.n_vert; v++)
        assert_true(sn_plane_height(&plane, sn_tri_mesh_point(&h->mesh, v)) >=
                    (plane.axis < 0 ? -near : 0.0));
    for (int32_t f = 0; f < h->mesh.n_face; f++) {
        if (h->from[f] >= 0) {
            assert_true(last >= 0 && last <= h->from[f] && h->from[f] < m->n_face);
            assert_int_equal(h->mesh.label ? h->mesh.label[f] : 0, m->label ? m->label[h->from[f]] : 0);
        } else {
            const int32_t *v = h->mesh.face + 3 * (size_t)f;
            for (int k = 0; k < 3; k++)
                assert_true(fabs(sn_plane_height(&plane, sn_tri_mesh_point(&h->mesh, v[k]))) <=
                            (plane.axis < 0 ? near : 0.0));
            assert_true(sn_v3_dot(sn_tri_mesh_face_normal(&h->mesh, f), plane.normal) < 0.0);
            if (h->mesh.label) assert_int_equal(h->mesh.label[f], cap_label);
        }
        last = h->from[f];
    }
}

static void assert_clean(const sn_tri_mesh *m)
{
    sn_mesh_check c;
    assert_int_equal(sn_mesh_check_run(&c, m, NULL, NULL), SN_OK);
    assert_true(c.closed && c.manifold && c.oriented);
    if (c.self_intersections > 0) fail_msg("%lld crossings", (long long)c.self_intersections);
    assert_int_equal(c.degenerate_faces + c.duplicate_faces + c.duplicate_vertices + c.unused_vertices, 0);
}

/* Both halves are sound, with the same cap, and make up the whole. Returns the area of the cap. */
static double assert_halves(const sn_tri_mesh *m, sn_vec3 point, sn_vec3 normal)
{
    half a = cut(m, point, normal), b = cut(m, point, sn_v3_scale(-2.0, normal));
    assert_is_half(&a, m, point, normal);
    assert_is_half(&b, m, point, sn_v3_scale(-1.0, normal));
    assert_clean(&a.mesh);
    assert_clean(&b.mesh);
    double whole = sn_tri_mesh_volume(m), sum = sn_tri_mesh_volume(&a.mesh) + sn_tri_mesh_volume(&b.mesh);
    assert_true(sn_tri_mesh_volume(&a.mesh) > 0.0 && sn_tri_mesh_volume(&b.mesh) > 0.0);
    if (fabs(sum - whole) > 1e-12 * whole) fail_msg("volumes: %.17g of %.17g", sum, whole);
    double area = cap_area(&a);
    assert_true(fabs(area - cap_area(&b)) < 1e-12 * area);
    half_free(&a);
    half_free(&b);
    return area;
}

/* ---- shapes ---- */

/* Around the z axis, radii 1 and r. */
static sn_tri_mesh made_torus(int n_long, int n_round, double r)
{
    sn_tri_mesh m;
    sn_tri_mesh_init(&m);
    assert_int_equal(sn_tri_mesh_reserve(&m, n_long * n_round, 2 * n_long * n_round, NULL), SN_OK);
    for (int i = 0; i < n_long; i++)
        for (int k = 0; k < n_round; k++) {
            double a = 2.0 * TEST_PI * (i + 0.3) / n_long, b = 2.0 * TEST_PI * k / n_round;
            double wide = 1.0 + r * cos(b);
            int32_t next = (i + 1) % n_long * n_round, up = (k + 1) % n_round, v = i * n_round + k;
            int32_t *f = m.face + 6 * (size_t)v;
            sn_v3_store(m.pos + 3 * v, sn_v3(wide * cos(a), wide * sin(a), r * sin(b)));
            f[0] = v, f[1] = next + k, f[2] = next + up;
            f[3] = v, f[4] = next + up, f[5] = i * n_round + up;
        }
    assert_true(sn_tri_mesh_volume(&m) > 0.0);
    return m;
}

/* A ball with bumps, faces of many sizes. */
static sn_tri_mesh made_lump(double cell)
{
    sn_tri_mesh m = made_sphere(sn_v3(0, 0, 0), 1.0, cell);
    for (int32_t v = 0; v < m.n_vert; v++) {
        sn_vec3 p = sn_tri_mesh_point(&m, v);
        double r = 1.0 + 0.2 * sin(5.0 * p.x + 1.0) * cos(4.0 * p.y) + 0.1 * sin(7.0 * p.z);
        sn_v3_store(m.pos + 3 * v, sn_v3_scale(r, p));
    }
    return m;
}

static void add_labels(sn_tri_mesh *m, int32_t modulus)
{
    m->label = SN_NEW(int32_t, m->n_face);
    assert_non_null(m->label);
    for (int32_t f = 0; f < m->n_face; f++) m->label[f] = f % modulus;
}

/* ---- simple bodies ---- */

/* The box 1 x 2 x 3 cut at a quarter: what is left, the area of the cap and what the faces come from. */
static void a_box_across_its_axes(void **state)
{
    (void)state;
    const double size[3] = {1, 2, 3}, area[3] = {6, 3, 2};
    sn_tri_mesh m = made_box(sn_v3(0, 0, 0), sn_v3(1, 2, 3));
    add_labels(&m, 5);
    for (int axis = 0; axis < 3; axis++) {
        double n[3] = {0, 0, 0};
        n[axis] = 3.0;
        sn_vec3 normal = sn_v3_load(n), point = sn_v3_scale(0.25 * size[axis] / 3.0, normal);
        assert_true(fabs(assert_halves(&m, point, normal) - area[axis]) < 1e-14);
        half h = cut(&m, point, normal);
        assert_true(fabs(sn_tri_mesh_volume(&h.mesh) - 4.5) < 1e-14); /* three quarters of 6 */
        assert_int_equal(h.mesh.n_vert, 12);                          /* 4 corners, 8 edges cut */
        assert_int_equal(h.mesh.n_face, 20);                          /* 2 n_vert - 4 */
        assert_closed_manifold(&h.mesh);
        half_free(&h);
    }
    sn_tri_mesh_free(&m);
}

/* Through the middle of a unit cube across its diagonal: a regular hexagon of side sqrt(1/2). */
static void a_cube_across_its_diagonal(void **state)
{
    (void)state;
    sn_tri_mesh m = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1));
    double area = assert_halves(&m, sn_v3(0.5, 0.5, 0.5), sn_v3(1, 1, 1));
    assert_true(fabs(area - 0.75 * sqrt(3.0)) < 1e-14);
    half h = cut(&m, sn_v3(0.5, 0.5, 0.5), sn_v3(1, 1, 1));
    assert_true(fabs(sn_tri_mesh_volume(&h.mesh) - 0.5) < 1e-14);
    half_free(&h);
    sn_tri_mesh_free(&m);
}

/* Four corners of the cube lie in the plane x = y, and so does its diagonal face edge. */
static void a_cube_through_its_corners(void **state)
{
    (void)state;
    sn_tri_mesh m = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1));
    assert_true(fabs(assert_halves(&m, sn_v3(0, 0, 0.3), sn_v3(1, -1, 0)) - sqrt(2.0)) < 1e-14);
    half h = cut(&m, sn_v3(0, 0, 0.3), sn_v3(1, -1, 0));
    assert_true(fabs(sn_tri_mesh_volume(&h.mesh) - 0.5) < 1e-14);
    assert_true(h.mesh.n_vert == 6 || h.mesh.n_vert == 7); /* the other diagonals may cross the plane */
    half_free(&h);
    sn_tri_mesh_free(&m);
}

static void a_cube_with_a_face_in_the_plane(void **state)
{
    (void)state;
    sn_tri_mesh m = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1)), out;
    sn_error err;
    half h = cut(&m, sn_v3(7, 7, 0), sn_v3(0, 0, 1));
    assert_is_half(&h, &m, sn_v3(7, 7, 0), sn_v3(0, 0, 1));
    assert_clean(&h.mesh);
    assert_true(sn_tri_mesh_volume(&h.mesh) == 1.0);
    assert_true(cap_area(&h) == 1.0);
    assert_int_equal(h.mesh.n_vert, 8);
    assert_int_equal(h.mesh.n_face, 12);
    half_free(&h);
    sn_tri_mesh_init(&out);
    assert_int_equal(sn_tri_mesh_cut(&m, sn_v3(7, 7, 0), sn_v3(0, 0, -1), 0, NULL, &out, NULL, &err),
                     SN_EINVAL);
    assert_string_equal(err.msg, "cut: the plane misses the surface, which lies between -1 and 0 along the "
                                 "normal: nothing would be left");
    sn_tri_mesh_free(&m);
}

/* Two steps, x < 1 up to z = 1 and x > 1 up to z = 2, cut at z = 1: a face in the plane that is covered from
 * above where the upper step stands. */
static void a_step_in_the_plane(void **state)
{
    static const double outline[6][2] = {{0, 0}, {2, 0}, {2, 2}, {1, 2}, {1, 1}, {0, 1}};
    static const int32_t tri[4][3] = {{0, 1, 4}, {0, 4, 5}, {1, 2, 4}, {2, 3, 4}};
    sn_tri_mesh m;
    (void)state;
    sn_tri_mesh_init(&m);
    assert_int_equal(sn_tri_mesh_reserve(&m, 12, 20, NULL), SN_OK);
    for (int k = 0; k < 12; k++)
        sn_v3_store(m.pos + 3 * k, sn_v3(outline[k % 6][0], k / 6, outline[k % 6][1]));
    int32_t *f = m.face;
    for (int k = 0; k < 4; k++, f += 6) {
        for (int i = 0; i < 3; i++) f[i] = tri[k][i], f[3 + i] = 6 + tri[k][2 - i];
    }
    for (int32_t k = 0; k < 6; k++, f += 6) {
        int32_t n = (k + 1) % 6;
        f[0] = k, f[1] = k + 6, f[2] = n + 6, f[3] = k, f[4] = n + 6, f[5] = n;
    }
    assert_clean(&m);
    assert_true(fabs(sn_tri_mesh_volume(&m) - 3.0) < 1e-14);
    assert_true(assert_halves(&m, sn_v3(0, 0, 1.5), sn_v3(0, 0, 1)) == 1.0);
    half up = cut(&m, sn_v3(0, 0, 1), sn_v3(0, 0, 1)), down = cut(&m, sn_v3(0, 0, 1), sn_v3(0, 0, -1));
    assert_clean(&up.mesh);
    assert_clean(&down.mesh);
    assert_true(sn_tri_mesh_volume(&up.mesh) == 1.0 && sn_tri_mesh_volume(&down.mesh) == 2.0);
    assert_true(cap_area(&up) == 1.0 && cap_area(&down) == 2.0);
    half_free(&up);
    half_free(&down);
    sn_tri_mesh_free(&m);
}

static void a_ball_tends_to_its_volume(void **state)
{
    (void)state;
    sn_tri_mesh m = made_sphere(sn_v3(1, 2, 3), 1.0, 0.05);
    double area = assert_halves(&m, sn_v3(1, 2, 3.5), sn_v3(0, 0, 1));
    assert_true(fabs(area - 0.75 * TEST_PI) < 0.01);
    half h = cut(&m, sn_v3(1, 2, 3.5), sn_v3(0, 0, 1)); /* a cap of height 1/2: pi h^2 (3 - h) / 3 */
    assert_true(fabs(sn_tri_mesh_volume(&h.mesh) - TEST_PI * 0.25 * 2.5 / 3.0) < 0.005);
    half_free(&h);
    sn_tri_mesh_free(&m);
}

/* The rings of the ball lie in planes across z: the one at z = 0 is met vertex by vertex. */
static void a_ring_of_vertices_on_the_plane(void **state)
{
    (void)state;
    sn_tri_mesh m = made_sphere(sn_v3(0, 0, 0), 1.0, 0.3);
    int32_t n_on = 0;
    for (int32_t v = 0; v < m.n_vert; v++) n_on += fabs(sn_tri_mesh_point(&m, v).z) < 1e-9;
    assert_true(n_on > 10);
    (void)assert_halves(&m, sn_v3(0, 0, 0), sn_v3(0, 0, 1));
    half h = cut(&m, sn_v3(0, 0, 0), sn_v3(0, 0, 1));
    assert_int_equal(h.mesh.n_vert, (m.n_vert - n_on) / 2 + n_on); /* no new points */
    half_free(&h);
    /* Moved off by less than what counts as on, they are moved back onto it. */
    for (int32_t v = 0; v < m.n_vert; v++)
        if (fabs(m.pos[3 * v + 2]) < 1e-9) m.pos[3 * v + 2] = (v % 3 - 1) * 3e-9; /* 1e-9 of 3.46 */
    h = cut(&m, sn_v3(0, 0, 0), sn_v3(0, 0, 1));
    assert_int_equal(h.mesh.n_vert, (m.n_vert - n_on) / 2 + n_on);
    assert_is_half(&h, &m, sn_v3(0, 0, 0), sn_v3(0, 0, 1));
    assert_clean(&h.mesh);
    half_free(&h);
    sn_tri_mesh_free(&m);
}

/* ---- loops, holes, islands ---- */

static void a_torus_has_two_loops(void **state)
{
    (void)state;
    sn_tri_mesh m = made_torus(48, 24, 0.3);
    double area = assert_halves(&m, sn_v3(0, 0, 0), sn_v3(0, 1, 0)); /* standing: two discs */
    assert_true(fabs(area - 2.0 * TEST_PI * 0.09) < 0.02);
    area = assert_halves(&m, sn_v3(0, 0, 0.1), sn_v3(0, 0, 1)); /* lying: a ring of width 2 sqrt(0.08) */
    assert_true(fabs(area - 4.0 * TEST_PI * sqrt(0.08)) < 0.05);
    (void)assert_halves(&m, sn_v3(0.05, 0.02, 0.01), sn_v3(1, 2, 5));
    half h = cut(&m, sn_v3(0, 0, 0), sn_v3(0, 1, 0));
    assert_int_equal(count_parts(&h.mesh), 1);
    assert_int_equal(euler_characteristic(&h.mesh), 2); /* half a ring is a ball */
    half_free(&h);
    sn_tri_mesh_free(&m);
}

/* Shells of radius 1, 0.8 (inwards), 0.5, 0.2 (inwards): the cap is two rings, and the hole stays one. */
static void shells_in_shells(void **state)
{
    static const double radius[] = {1.0, 0.8, 0.5, 0.2};
    sn_tri_mesh m = made_sphere(sn_v3(0, 0, 0), radius[0], 0.1);
    add_labels(&m, 1);
    double want = 0.0;
    (void)state;
    for (int i = 1; i < 4; i++) {
        sn_tri_mesh s = made_sphere(sn_v3(0, 0, 0), radius[i], 0.1 * radius[i]);
        if (i % 2) turn_faces(&s);
        append_mesh(&m, &s, i);
    }
    double at[] = {0.01, 0.3, 0.6, 0.9};
    for (int k = 0; k < 4; k++) {
        want = 0.0;
        for (int i = 0; i < 4; i++)
            if (radius[i] > at[k])
                want += (i % 2 ? -1 : 1) * TEST_PI * (radius[i] * radius[i] - at[k] * at[k]);
        double area = assert_halves(&m, sn_v3(0, at[k], 0), sn_v3(0, 1, 0));
        assert_true(fabs(area - want) < 0.04);
    }
    half h = cut(&m, sn_v3(0, 0.01, 0), sn_v3(0, -1, 0));
    assert_int_equal(count_parts(&h.mesh), 2);
    half_free(&h);
    sn_tri_mesh_free(&m);
}

/* Some shells lie on one side altogether. */
static void shells_beside_the_plane(void **state)
{
    (void)state;
    sn_tri_mesh m = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1)), up = made_box(sn_v3(0, 0, 2), sn_v3(1, 1, 3)),
                down = made_box(sn_v3(0, 0, -2), sn_v3(1, 1, -1));
    append_mesh(&m, &up, 0);
    append_mesh(&m, &down, 0);
    assert_true(assert_halves(&m, sn_v3(0, 0, 0.5), sn_v3(0, 0, 1)) == 1.0);
    half h = cut(&m, sn_v3(0, 0, 0.5), sn_v3(0, 0, 1));
    assert_true(fabs(sn_tri_mesh_volume(&h.mesh) - 1.5) < 1e-14);
    half_free(&h);
    sn_tri_mesh_free(&m);
}

/* A surface inside out gives a half inside out. */
static void inside_out(void **state)
{
    (void)state;
    sn_tri_mesh m = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1));
    turn_faces(&m);
    half h = cut(&m, sn_v3(0, 0, 0.75), sn_v3(0, 0, 1));
    assert_clean(&h.mesh);
    assert_true(fabs(sn_tri_mesh_volume(&h.mesh) + 0.25) < 1e-14);
    half_free(&h);
    sn_tri_mesh_free(&m);
}

/* The corner of a hollow, pointing down, touches the plane within the cap: one vertex, shared by both. */
static void a_hollow_that_touches_the_plane(void **state)
{
    (void)state;
    sn_tri_mesh m = made_box(sn_v3(-1, -1, -1), sn_v3(1, 1, 1)),
                hollow = made_box(sn_v3(0, 0, 0), sn_v3(0.2, 0.2, 0.2));
    for (int32_t v = 0; v < hollow.n_vert; v++) { /* onto its corner */
        sn_vec3 p = sn_tri_mesh_point(&hollow, v);
        sn_v3_store(hollow.pos + 3 * v, sn_v3(p.x - p.y, p.y - p.z, p.x + p.y + p.z));
    }
    turn_faces(&hollow);
    double volume = sn_tri_mesh_volume(&hollow);
    append_mesh(&m, &hollow, 0);
    half h = cut(&m, sn_v3(0, 0, 0), sn_v3(0, 0, 1));
    sn_mesh_check c;
    assert_int_equal(sn_mesh_check_run(&c, &h.mesh, NULL, NULL), SN_OK);
    assert_true(c.closed && c.oriented && c.self_intersections == 0);
    assert_int_equal(c.nonmanifold_vertices, 1);
    assert_true(fabs(sn_tri_mesh_volume(&h.mesh) - 4.0 - volume) < 1e-14);
    half_free(&h);
    h = cut(&m, sn_v3(0, 0, 0), sn_v3(0, 0, -1));
    assert_clean(&h.mesh);
    half_free(&h);
    sn_tri_mesh_free(&m);
}

/* ---- many planes ---- */

static void many_planes(void **state)
{
    uint64_t h = 12345;
    (void)state;
    sn_tri_mesh m = made_lump(0.35);
    sn_mesh_check c;
    assert_int_equal(sn_mesh_check_run(&c, &m, NULL, NULL), SN_OK);
    assert_true(c.closed && c.manifold && c.self_intersections == 0);
    for (int i = 0; i < 250; i++) {
        sn_vec3 n = sn_v3(made_random(&h) - 0.5, made_random(&h) - 0.5, made_random(&h) - 0.5);
        sn_vec3 p = sn_v3(made_random(&h) - 0.5, made_random(&h) - 0.5, made_random(&h) - 0.5);
        if (i % 4 == 0) p = sn_tri_mesh_point(&m, (int32_t)(made_random(&h) * m.n_vert)); /* a vertex on it */
        if (i % 4 == 1) n = i % 8 == 1 ? sn_v3(0, 1, 0) : sn_v3(-1, 0, 0);
        if (i % 4 == 0 && fabs(sn_v3_dot(sn_v3_unit(n), p)) > 0.7) p = sn_v3_scale(0.5, p);
        (void)assert_halves(&m, p, n);
    }
    sn_tri_mesh_free(&m);
}

/* Lengths in another unit: the same faces, points scaled. */
static void the_unit_does_not_matter(void **state)
{
    static const double factor[] = {0x1p10, 0x1p-60, 0x1p70};
    (void)state;
    sn_tri_mesh m = made_lump(0.35);
    const sn_vec3 point = {0.1, -0.2, 0.05}, normal = {1, 2, -0.5};
    half h = cut(&m, point, normal);
    for (int i = 0; i < 3; i++) {
        sn_tri_mesh s;
        sn_tri_mesh_init(&s);
        assert_int_equal(sn_tri_mesh_copy(&s, &m, NULL), SN_OK);
        scale_mesh(&s, factor[i]);
        half k = cut(&s, sn_v3_scale(factor[i], point), normal);
        assert_int_equal(k.mesh.n_vert, h.mesh.n_vert);
        assert_int_equal(k.mesh.n_face, h.mesh.n_face);
        assert_memory_equal(k.mesh.face, h.mesh.face, 3 * (size_t)h.mesh.n_face * sizeof *h.mesh.face);
        for (size_t c = 0; c < 3 * (size_t)h.mesh.n_vert; c++)
            assert_true(k.mesh.pos[c] == factor[i] * h.mesh.pos[c]);
        half_free(&k);
        sn_tri_mesh_free(&s);
    }
    half_free(&h);
    sn_tri_mesh_free(&m);
}

/* Vertices just off the plane, from which many edges cross it in nearly, or bit by bit, the same point. */
static void vertices_just_off_the_plane(void **state)
{
    (void)state;
    for (int i = 0; i < 12; i++) {
        sn_tri_mesh m = made_sphere(sn_v3(0, 0, 0), 1.0, 0.4);
        double off = pow(10.0, -4.0 - 0.5 * i);
        for (int32_t v = 0; v < m.n_vert; v++)
            if (fabs(m.pos[3 * v + 2]) < 1e-12) m.pos[3 * v + 2] = v % 2 ? off : -off;
        half a = cut(&m, sn_v3(0, 0, 0), sn_v3(0, 0, 1)), b = cut(&m, sn_v3(0, 0, 0), sn_v3(0, 0, -1));
        assert_closed_manifold(&a.mesh);
        assert_closed_manifold(&b.mesh);
        assert_is_half(&a, &m, sn_v3(0, 0, 0), sn_v3(0, 0, 1));
        double sum = sn_tri_mesh_volume(&a.mesh) + sn_tri_mesh_volume(&b.mesh);
        assert_true(fabs(sum - sn_tri_mesh_volume(&m)) < 1e-9);
        half_free(&a);
        half_free(&b);
        sn_tri_mesh_free(&m);
    }
}

/* ---- what cannot be cut ---- */

static void assert_refused(const sn_tri_mesh *m, sn_vec3 point, sn_vec3 normal, sn_status want,
                           const char *msg)
{
    sn_tri_mesh out = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1));
    int32_t *from = (int32_t *)1;
    sn_error err = {0};
    assert_int_equal(sn_tri_mesh_cut(m, point, normal, 0, NULL, &out, &from, &err), want);
    assert_string_equal(err.msg, msg);
    assert_null(from);
    assert_null(out.pos);
}

static void refused_planes(void **state)
{
    (void)state;
    const sn_vec3 o = {0, 0, 0}, z = {0, 0, 2};
    sn_tri_mesh m = made_box(sn_v3(0, 0, 0.25), sn_v3(1, 1, 1));
    assert_refused(&m, o, o, SN_EINVAL, "cut: the plane needs a finite point and a normal that is not zero");
    assert_refused(&m, sn_v3(NAN, 0, 0), z, SN_EINVAL,
                   "cut: the plane needs a finite point and a normal that is not zero");
    assert_refused(&m, o, z, SN_EINVAL,
                   "cut: the plane misses the surface, which lies between 0.25 and 1 along the normal: "
                   "nothing would be cut off");
    assert_refused(&m, sn_v3(0, 0, 2), z, SN_EINVAL,
                   "cut: the plane misses the surface, which lies between -1.75 and -1 along the normal: "
                   "nothing would be left");
    assert_refused(&m, o, sn_v3(0, -1, -1), SN_EINVAL,
                   "cut: the plane misses the surface, which lies between -1.41421 and -0.176777 along the "
                   "normal: nothing would be left");
    /* It touches an edge: nothing lies beyond. */
    assert_refused(&m, sn_v3(1, 0, 0.25), sn_v3(-1, 0, 1), SN_EINVAL,
                   "cut: the plane misses the surface, which lies between 0 and 1.23744 along the normal: "
                   "nothing would be cut off");
    sn_tri_mesh_free(&m);
}

static void refused_surfaces(void **state)
{
    (void)state;
    const sn_vec3 o = {0, 0, 0.5}, z = {0, 0, 1};
    sn_tri_mesh m = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1));
    m.n_face = 11;
    assert_refused(&m, o, z, SN_EMESH, "cut: the surface is not closed: 3 edges have only one face");
    m.n_face = 12;
    int32_t swap = m.face[0];
    m.face[0] = m.face[1];
    m.face[1] = swap;
    assert_refused(&m, o, z, SN_EMESH,
                   "cut: the surface is not closed: its faces do not all turn the same way");
    m.face[0] = 99;
    assert_refused(&m, o, z, SN_EINVAL, "cut: face 1 names vertex 100, need 1..8");
    sn_tri_mesh_free(&m);
    sn_tri_mesh empty;
    sn_tri_mesh_init(&empty);
    assert_refused(&empty, o, z, SN_EINVAL, "cut: surface has no faces");
    /* Two boxes that overlap: their outlines cross. */
    m = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1));
    sn_tri_mesh b = made_box(sn_v3(0.5, 0.5, 0), sn_v3(2, 2, 1));
    append_mesh(&m, &b, 0);
    sn_error err;
    sn_tri_mesh out;
    sn_tri_mesh_init(&out);
    assert_int_equal(sn_tri_mesh_cut(&m, o, z, 0, NULL, &out, NULL, &err), SN_EMESH);
    assert_non_null(strstr(err.msg, "cut: in the plane, near {"));
    assert_non_null(strstr(err.msg, "}: the outline crosses or touches itself"));
    sn_tri_mesh_free(&m);
    /* One inside the other, both outwards. */
    m = made_box(sn_v3(0, 0, 0), sn_v3(4, 4, 1));
    b = made_box(sn_v3(1, 1, 0.25), sn_v3(2, 2, 0.75));
    append_mesh(&m, &b, 0);
    assert_int_equal(sn_tri_mesh_cut(&m, o, z, 0, NULL, &out, NULL, &err), SN_EMESH);
    assert_non_null(strstr(err.msg, "}: one shell lies inside another one that turns the same way"));
    sn_tri_mesh_free(&m);
}

static void no_memory(void **state)
{
    (void)state;
    sn_tri_mesh m = made_lump(0.5);
    add_labels(&m, 3);
    sn_status st = SN_ENOMEM;
    for (int n = 0; st; n++) {
        failing f = {.left = n};
        sn_tri_mesh out;
        int32_t *from;
        sn_error err = {0};
        sn_tri_mesh_init(&out);
        sn_set_allocator(&(sn_allocator){failing_realloc, &f});
        st = sn_tri_mesh_cut(&m, sn_v3(0, 0, 0), sn_v3(1, 1, 1), 0, NULL, &out, &from, &err);
        if (st) {
            assert_int_equal(st, SN_ENOMEM);
            assert_non_null(strstr(err.msg, "no memory"));
            assert_null(from);
        }
        sn_tri_mesh_free(&out);
        sn_release(from);
        sn_set_allocator(NULL);
        assert_int_equal(f.n_alive, 0);
        assert_true(n < 100);
        if (!st) assert_true(n > 12);
    }
    sn_tri_mesh_free(&m);
}

static void interrupted(void **state)
{
    (void)state;
    const volatile sig_atomic_t stop = 1;
    const sn_run run = {.cancel = &stop};
    sn_tri_mesh m = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1)), out;
    sn_error err;
    sn_tri_mesh_init(&out);
    assert_int_equal(sn_tri_mesh_cut(&m, sn_v3(0, 0, 0.5), sn_v3(0, 0, 1), 0, &run, &out, NULL, &err),
                     SN_ECANCEL);
    assert_null(out.pos);
    sn_tri_mesh_free(&m);
}

/* ---- the dog ---- */

static void the_dog_in_halves(void **state)
{
    const char *data = getenv("SINEW_DATA");
    char path[512];
    sn_tri_mesh m;
    sn_error err;
    (void)state;
    (void)snprintf(path, sizeof path, "%s/dog_hindleg/skin.stl", data ? data : "../shared/data");
    sn_tri_mesh_init(&m);
    if (sn_surface_load(&m, path, &err)) {
        print_message("%s: skipped\n", err.msg);
        skip();
    }
    double area = assert_halves(&m, sn_v3(0, 0, 0), sn_v3(0, 1, 0));
    assert_true(area > 0.01 && area < 0.3);
    half h = cut(&m, sn_v3(0, 0, 0), sn_v3(0, 1, 0));
    double share = sn_tri_mesh_volume(&h.mesh) / sn_tri_mesh_volume(&m);
    assert_true(fabs(share - 0.5) < 0.01);
    half_free(&h);
    (void)assert_halves(&m, sn_v3(0, 0, 0.4), sn_v3(0.3, 0.2, 1)); /* through neck and legs */
    sn_tri_mesh_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_box_across_its_axes),
        cmocka_unit_test(a_cube_across_its_diagonal),
        cmocka_unit_test(a_cube_through_its_corners),
        cmocka_unit_test(a_cube_with_a_face_in_the_plane),
        cmocka_unit_test(a_step_in_the_plane),
        cmocka_unit_test(a_ball_tends_to_its_volume),
        cmocka_unit_test(a_ring_of_vertices_on_the_plane),
        cmocka_unit_test(a_torus_has_two_loops),
        cmocka_unit_test(shells_in_shells),
        cmocka_unit_test(shells_beside_the_plane),
        cmocka_unit_test(inside_out),
        cmocka_unit_test(a_hollow_that_touches_the_plane),
        cmocka_unit_test(many_planes),
        cmocka_unit_test(the_unit_does_not_matter),
        cmocka_unit_test(vertices_just_off_the_plane),
        cmocka_unit_test(refused_planes),
        cmocka_unit_test(refused_surfaces),
        cmocka_unit_test(no_memory),
        cmocka_unit_test(interrupted),
        cmocka_unit_test(the_dog_in_halves),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
