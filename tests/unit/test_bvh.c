/* test_bvh - rays, closest points, winding numbers and overlaps against plain loops and hand-made cases. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/alloc.h"
#include "mesh/bvh.h"

#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* ---- surfaces ---- */

static void make(sn_tri_mesh *m, const double *pos, int32_t n_vert, const int32_t *face, int32_t n_face)
{
    sn_tri_mesh_init(m);
    assert_int_equal(sn_tri_mesh_reserve(m, n_vert, n_face, NULL), SN_OK);
    memcpy(m->pos, pos, 3 * (size_t)n_vert * sizeof *pos);
    memcpy(m->face, face, 3 * (size_t)n_face * sizeof *face);
}

static const double cube_pos[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1};
static const int32_t cube_face[] = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                    1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};

static void make_cube(sn_tri_mesh *m)
{
    make(m, cube_pos, 8, cube_face, 12);
}

/* A bumpy closed surface over a grid of n x 2n on the sphere; poles included. */
static void make_bumpy(sn_tri_mesh *m, int n)
{
    int cols = 2 * n;
    sn_tri_mesh_init(m);
    assert_int_equal(sn_tri_mesh_reserve(m, cols * (n - 1) + 2, 2 * cols * (n - 1), NULL), SN_OK);
    for (int i = 1; i < n; i++)
        for (int k = 0; k < cols; k++) {
            double a = PI * i / n, b = 2.0 * PI * k / cols, r = 1.0 + 0.2 * sin(5 * a) * cos(3 * b);
            sn_v3_store(m->pos + 3 * ((i - 1) * cols + k),
                        sn_v3(r * sin(a) * cos(b), r * sin(a) * sin(b), r * cos(a)));
        }
    int32_t top = cols * (n - 1), *f = m->face;
    sn_v3_store(m->pos + 3 * top, sn_v3(0, 0, 1));
    sn_v3_store(m->pos + 3 * (top + 1), sn_v3(0, 0, -1));
    for (int k = 0; k < cols; k++) {
        int32_t next = (k + 1) % cols, last = cols * (n - 2);
        *f++ = top, *f++ = k, *f++ = next;
        *f++ = top + 1, *f++ = last + next, *f++ = last + k;
        for (int i = 0; i + 2 < n; i++) {
            int32_t a = i * cols + k, b = i * cols + next;
            *f++ = a, *f++ = a + cols, *f++ = b + cols;
            *f++ = a, *f++ = b + cols, *f++ = b;
        }
    }
    assert_int_equal((int)(f - m->face), 3 * m->n_face);
    assert_true(sn_tri_mesh_volume(m) > 3.0);
}

static sn_bvh *tree_of(const sn_tri_mesh *m)
{
    sn_bvh *b;
    assert_int_equal(sn_bvh_create(&b, m, NULL), SN_OK);
    return b;
}

static double rng(uint64_t *s) /* -1..1, splitmix64 */
{
    uint64_t z = (*s += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1.0;
}

static sn_vec3 random_point(uint64_t *s, double scale)
{
    double x = rng(s), y = rng(s), z = rng(s);
    return sn_v3(scale * x, scale * y, scale * z);
}

static void face_corners(const sn_tri_mesh *m, int32_t f, sn_vec3 p[3])
{
    for (int k = 0; k < 3; k++) p[k] = sn_tri_mesh_point(m, m->face[3 * f + k]);
}

/* ---- rays ---- */

/* Entering and leaving take turns, t does not fall; returns leaving minus entering. */
static int check_alternates(const sn_bvh *b, sn_vec3 o, sn_vec3 d)
{
    sn_ray_hit *h, first;
    size_t n;
    int sum = 0;
    assert_int_equal(sn_bvh_ray_all(b, o, d, INFINITY, &h, &n, NULL), SN_OK);
    assert_int_equal(sn_bvh_ray_first(b, o, d, INFINITY, &first), n > 0);
    if (n > 0) {
        assert_int_equal(first.face, h[0].face);
        assert_true(first.t == h[0].t && first.entering == h[0].entering);
    }
    for (size_t k = 0; k < n; k++) {
        sum += h[k].entering ? -1 : 1;
        if (k == 0) continue;
        assert_true(h[k].t >= h[k - 1].t);
        assert_int_equal(h[k].entering, !h[k - 1].entering);
    }
    sn_release(h);
    return sum;
}

static void ray_through_cube(void **state)
{
    (void)state;
    sn_tri_mesh m;
    make_cube(&m);
    sn_bvh *b = tree_of(&m);
    sn_ray_hit *h;
    size_t n;
    assert_int_equal(sn_bvh_ray_all(b, sn_v3(-1, 0.25, 0.5), sn_v3(2, 0, 0), 9, &h, &n, NULL), SN_OK);
    assert_int_equal(n, 2);
    assert_true(h[0].t == 0.5 && h[1].t == 1.0); /* along the direction as given */
    assert_true(h[0].entering && !h[1].entering);
    assert_true(h[0].point.x == 0.0 && h[0].point.y == 0.25 && h[1].point.x == 1.0);
    sn_release(h);
    assert_int_equal(sn_bvh_ray_all(b, sn_v3(-1, 0.25, 0.5), sn_v3(2, 0, 0), 0.5, &h, &n, NULL), SN_OK);
    assert_int_equal(n, 1); /* t_max included */
    sn_release(h);
    sn_ray_hit hit;
    assert_true(sn_bvh_ray_first(b, sn_v3(0.5, 0.25, 0.5), sn_v3(0, 0, -4), 9, &hit));
    assert_true(!hit.entering && hit.t == 0.125);
    assert_false(sn_bvh_ray_first(b, sn_v3(0.5, 0.25, 0.5), sn_v3(0, 0, -4), 0.1, &hit));
    assert_false(sn_bvh_ray_first(b, sn_v3(0.5, 0.25, 2), sn_v3(0, 0, 1), 9, &hit)); /* behind */
    sn_bvh_destroy(b);
    sn_tri_mesh_free(&m);
}

static void rays_through_edges_and_corners_of_a_cube(void **state)
{
    (void)state;
    sn_tri_mesh m;
    make_cube(&m);
    sn_bvh *b = tree_of(&m);
    /* From inside to every place of a fine grid on the surface: corners, edges, diagonals: leaves exactly
     * once. */
    for (int i = 0; i <= 8; i++)
        for (int k = 0; k <= 8; k++)
            for (int l = 0; l <= 8; l++) {
                sn_vec3 o = sn_v3(0.5, 0.5, 0.5), p = sn_v3(i / 8.0, k / 8.0, l / 8.0), d = sn_v3_sub(p, o);
                if (sn_v3_len2(d) > 0.0) assert_int_equal(check_alternates(b, o, d), 1);
                if (sn_v3_len2(d) > 0.0) assert_int_equal(check_alternates(b, sn_v3_mad(o, -9, d), d), 0);
                /* axis rays in the planes of faces, along edges, through corners, from outside */
                assert_int_equal(check_alternates(b, sn_v3(-2, k / 8.0, l / 8.0), sn_v3(1, 0, 0)), 0);
                assert_int_equal(check_alternates(b, sn_v3(i / 8.0, 3, l / 8.0), sn_v3(0, -1, 0)), 0);
                assert_int_equal(check_alternates(b, sn_v3(i / 8.0, k / 8.0, 3), sn_v3(0, 0, -0.1)), 0);
                /* grazing an edge of the box askew */
                assert_int_equal(check_alternates(b, sn_v3(-1, 1, l / 8.0), sn_v3(1, -1, 0)), 0);
                assert_int_equal(check_alternates(b, sn_v3(-1, 2, l / 8.0), sn_v3(1, -1, i / 64.0)), 0);
                assert_int_equal(check_alternates(b, sn_v3(-1, 0, l / 8.0), sn_v3(1, 1, i / 64.0)), 0);
            }
    sn_bvh_destroy(b);
    sn_tri_mesh_free(&m);
}

static void rays_at_vertices_of_a_bumpy_surface(void **state)
{
    (void)state;
    sn_tri_mesh m;
    make_bumpy(&m, 12);
    sn_bvh *b = tree_of(&m);
    uint64_t seed = 5;
    for (int32_t i = 0; i < m.n_vert; i++) {
        sn_vec3 v = sn_tri_mesh_point(&m, i), w = sn_tri_mesh_point(&m, (i * 37 + 11) % m.n_vert);
        for (int k = 0; k < 4; k++) {
            sn_vec3 out = random_point(&seed, 1.0), in = random_point(&seed, 0.3);
            out = sn_v3_scale(4.0, sn_v3_unit(out));
            if (k == 1) out = sn_v3(3, v.y, v.z); /* axis-parallel */
            assert_int_equal(check_alternates(b, out, sn_v3_sub(v, out)), 0);
            assert_int_equal(check_alternates(b, in, sn_v3_sub(v, in)), 1);
            sn_vec3 middle = sn_v3_lerp(v, w, 0.5), d = sn_v3_sub(w, v); /* along the surface */
            if (sn_v3_len2(d) > 0.0) assert_int_equal(check_alternates(b, sn_v3_mad(middle, -50, d), d), 0);
        }
    }
    sn_bvh_destroy(b);
    sn_tri_mesh_free(&m);
}

static void rays_agree_with_plain_loop(void **state)
{
    (void)state;
    sn_tri_mesh m;
    make_bumpy(&m, 20);
    sn_bvh *b = tree_of(&m);
    uint64_t seed = 6;
    for (int trial = 0; trial < 300; trial++) {
        sn_vec3 o = random_point(&seed, 2.0), d = random_point(&seed, 1.0);
        size_t want = 0, n;
        double nearest = INFINITY;
        for (int32_t f = 0; f < m.n_face; f++) { /* Cramer's rule */
            sn_vec3 p[3];
            face_corners(&m, f, p);
            sn_vec3 e = sn_v3_sub(p[1], p[0]), g = sn_v3_sub(p[2], p[0]), s = sn_v3_sub(o, p[0]);
            double det = -sn_v3_det(d, e, g), t = sn_v3_det(s, e, g) / det;
            double u = -sn_v3_det(d, s, g) / det, v = -sn_v3_det(d, e, s) / det;
            if (u < 0 || v < 0 || u + v > 1 || t < 0 || t > 3.0) continue;
            want++;
            nearest = fmin(nearest, t);
        }
        sn_ray_hit *h;
        assert_int_equal(sn_bvh_ray_all(b, o, d, 3.0, &h, &n, NULL), SN_OK);
        assert_int_equal(n, want);
        if (n > 0) assert_true(fabs(h[0].t - nearest) < 1e-12);
        sn_release(h);
    }
    sn_bvh_destroy(b);
    sn_tri_mesh_free(&m);
}

static void bad_rays_are_refused(void **state)
{
    (void)state;
    sn_tri_mesh m;
    make_cube(&m);
    sn_bvh *b = tree_of(&m);
    sn_ray_hit *h, hit;
    size_t n;
    sn_error err;
    assert_int_equal(sn_bvh_ray_all(b, sn_v3(0, 0, 0), sn_v3(0, 0, 0), 1, &h, &n, &err), SN_EINVAL);
    assert_null(h);
    assert_string_equal(err.msg,
                        "ray: origin (0, 0, 0), direction (0, 0, 0), need finite numbers and a direction "
                        "that is not zero");
    assert_int_equal(sn_bvh_ray_all(b, sn_v3(0, 0, 0), sn_v3(NAN, 0, 1), 1, &h, &n, &err), SN_EINVAL);
    assert_int_equal(sn_bvh_ray_all(b, sn_v3(INFINITY, 0, 0), sn_v3(1, 0, 1), 1, &h, &n, &err), SN_EINVAL);
    assert_false(sn_bvh_ray_first(b, sn_v3(0, 0, 0), sn_v3(0, 0, 0), 1, &hit));
    sn_bvh_destroy(b);
    sn_tri_mesh_free(&m);
}

/* ---- closest points ---- */

static sn_vec3 clamp_to_segment(sn_vec3 p, sn_vec3 a, sn_vec3 b)
{
    sn_vec3 d = sn_v3_sub(b, a);
    double l = sn_v3_len2(d), t = l > 0 ? sn_v3_dot(sn_v3_sub(p, a), d) / l : 0;
    return sn_v3_mad(a, fmin(fmax(t, 0), 1), d);
}

static double distance_reference(sn_vec3 p, const sn_vec3 t[3])
{
    double best = INFINITY;
    for (int k = 0; k < 3; k++) best = fmin(best, sn_v3_dist(p, clamp_to_segment(p, t[k], t[(k + 1) % 3])));
    sn_vec3 n = sn_v3_unit(sn_v3_cross(sn_v3_sub(t[1], t[0]), sn_v3_sub(t[2], t[0])));
    double h = sn_v3_dot(n, sn_v3_sub(p, t[0]));
    sn_vec3 q = sn_v3_mad(p, -h, n);
    bool inside = sn_v3_len2(n) > 0;
    for (int k = 0; k < 3; k++)
        if (sn_v3_det(n, sn_v3_sub(t[(k + 1) % 3], t[k]), sn_v3_sub(q, t[k])) < 0) inside = false;
    return inside ? fmin(best, fabs(h)) : best;
}

static void closest_agrees_with_plain_loop(void **state)
{
    (void)state;
    sn_tri_mesh m;
    make_bumpy(&m, 14);
    m.label = SN_NEW(int32_t, m.n_face);
    for (int32_t f = 0; f < m.n_face; f++) m.label[f] = f % 5 == 0 ? 9 : f % 3;
    for (int k = 0; k < 3; k++) m.face[3 * 17 + k] = m.face[3 * 17]; /* a face that is a point */
    m.face[3 * 40 + 1] = m.face[3 * 40];                             /* and one that is a segment */
    sn_bvh *b = tree_of(&m);
    uint64_t seed = 7;
    for (int trial = 0; trial < 400; trial++) {
        sn_vec3 p = random_point(&seed, trial % 2 ? 1.3 : 30.0), t[3];
        if (trial % 5 == 0) p = sn_tri_mesh_point(&m, trial % m.n_vert);
        double best[2] = {INFINITY, INFINITY};
        for (int32_t f = 0; f < m.n_face; f++) {
            face_corners(&m, f, t);
            double d = distance_reference(p, t);
            best[0] = fmin(best[0], d);
            if (m.label[f] == 9) best[1] = fmin(best[1], d);
        }
        sn_closest c = sn_bvh_closest(b, p), l = sn_bvh_closest_label(b, p, 9);
        assert_true(fabs(c.dist - best[0]) < 1e-13 * (1 + best[0]));
        assert_true(fabs(l.dist - best[1]) < 1e-13 * (1 + best[1]));
        assert_int_equal(m.label[l.face], 9);
        face_corners(&m, c.face, t);
        assert_true(distance_reference(c.point, t) < 1e-14);
        assert_true(fabs(sn_v3_dist(p, c.point) - c.dist) < 1e-14 * (1 + c.dist));
    }
    assert_int_equal(sn_bvh_closest_label(b, sn_v3(0, 0, 0), 4).face, -1);
    assert_true(isinf(sn_bvh_closest_label(b, sn_v3(0, 0, 0), 4).dist));
    sn_bvh_destroy(b);
    sn_tri_mesh_free(&m);
}

static void ties_go_to_the_lowest_face(void **state)
{
    (void)state;
    sn_tri_mesh m;
    make_bumpy(&m, 10);
    sn_bvh *b = tree_of(&m);
    for (int32_t i = 0; i < m.n_vert; i++) { /* at a vertex, and off it along its direction */
        sn_vec3 v = sn_tri_mesh_point(&m, i);
        int32_t lowest = 0;
        while (m.face[3 * lowest] != i && m.face[3 * lowest + 1] != i && m.face[3 * lowest + 2] != i)
            lowest++;
        sn_closest c = sn_bvh_closest(b, v);
        assert_true(c.dist == 0.0);
        assert_int_equal(c.face, lowest);
    }
    sn_bvh_destroy(b);
    sn_tri_mesh_free(&m);
    make_cube(&m);
    b = tree_of(&m);
    sn_closest c = sn_bvh_closest(b, sn_v3(2, 2, 2)); /* corner 6: faces 2 and more */
    assert_int_equal(c.face, 2);
    assert_true(c.point.x == 1 && c.point.y == 1 && c.point.z == 1);
    c = sn_bvh_closest(b, sn_v3(0.5, 0.5, 0.5)); /* the middle: all sides equally far */
    assert_int_equal(c.face, 0);
    assert_true(c.dist == 0.5);
    assert_int_equal(sn_bvh_closest_label(b, sn_v3(0, 0, 0), 0).face, -1); /* no labels */
    sn_bvh_destroy(b);
    sn_tri_mesh_free(&m);
}

static void needles_have_true_distances(void **state)
{
    (void)state;
    const double pos[] = {0, 0, 0, 1, 0, 0, 0.5, 1e-13, 0};
    const int32_t face[] = {0, 1, 2};
    sn_tri_mesh m;
    make(&m, pos, 3, face, 1);
    sn_bvh *b = tree_of(&m);
    uint64_t seed = 8;
    for (int trial = 0; trial < 1000; trial++) {
        sn_vec3 p = random_point(&seed, 2.0);
        double want = sn_v3_dist(p, clamp_to_segment(p, sn_v3(0, 0, 0), sn_v3(1, 0, 0)));
        assert_true(fabs(sn_bvh_closest(b, p).dist - want) < 1e-12);
    }
    sn_bvh_destroy(b);
    sn_tri_mesh_free(&m);
}

/* ---- winding numbers ---- */

static double winding_reference(const sn_tri_mesh *m, sn_vec3 q)
{
    double sum = 0;
    for (int32_t f = 0; f < m->n_face; f++) {
        sn_vec3 p[3];
        double l[3];
        face_corners(m, f, p);
        for (int k = 0; k < 3; k++) {
            p[k] = sn_v3_sub(p[k], q);
            l[k] = sn_v3_len(p[k]);
        }
        sum += atan2(sn_v3_det(p[0], p[1], p[2]), l[0] * l[1] * l[2] + sn_v3_dot(p[0], p[1]) * l[2] +
                                                      sn_v3_dot(p[1], p[2]) * l[0] +
                                                      sn_v3_dot(p[2], p[0]) * l[1]);
    }
    return sum / (2 * PI);
}

static void winding_of_cube(void **state)
{
    (void)state;
    sn_tri_mesh m;
    make_cube(&m);
    sn_bvh *b = tree_of(&m);
    assert_true(fabs(sn_bvh_winding(b, sn_v3(0.3, 0.4, 0.9)) - 1) < 1e-12);
    assert_true(fabs(sn_bvh_winding(b, sn_v3(1.1, 0.4, 0.9))) < 1e-12);
    assert_true(fabs(sn_bvh_winding(b, sn_v3(0.3, 0.4, 1)) - 0.5) < 1e-12); /* on a side */
    assert_true(fabs(sn_bvh_winding(b, sn_v3(40, 50, 60))) < 1e-6);
    assert_true(sn_bvh_contains(b, sn_v3(1e-9, 0.5, 0.5)));
    assert_false(sn_bvh_contains(b, sn_v3(-1e-9, 0.5, 0.5)));
    sn_bvh_destroy(b);
    m.n_face = 10; /* without the side x = 0: its middle sees a sixth of the sphere through the hole */
    b = tree_of(&m);
    assert_true(fabs(sn_bvh_winding(b, sn_v3(0.5, 0.5, 0.5)) - 5.0 / 6.0) < 1e-12);
    sn_bvh_destroy(b);
    sn_tri_mesh_free(&m);
}

static void winding_agrees_with_plain_sum(void **state)
{
    (void)state;
    sn_tri_mesh m;
    make_bumpy(&m, 40);
    m.n_face -= 300;                                              /* with a hole */
    for (int32_t i = 0; i < 3 * m.n_vert; i++) m.pos[i] += 100.0; /* far from the origin */
    sn_bvh *b = tree_of(&m);
    uint64_t seed = 9;
    for (int trial = 0; trial < 300; trial++) {
        sn_vec3 p = sn_v3_add(sn_v3(100, 100, 100), random_point(&seed, trial % 3 == 0 ? 5.0 : 1.3));
        double want = winding_reference(&m, p);
        assert_true(fabs(sn_bvh_winding(b, p) - want) < 1e-3);
        if (fabs(want - 0.5) > 1e-3) assert_int_equal(sn_bvh_contains(b, p), want > 0.5);
    }
    sn_bvh_destroy(b);
    sn_tri_mesh_free(&m);
}

/* Nearly the whole sum is multipoles here: without the third moments it would be off by more than this. */
static void far_disc_is_seen_by_its_moments(void **state)
{
    (void)state;
    enum { N = 64 };
    double pos[3 * (N + 1)] = {0};
    int32_t face[3 * N];
    for (int k = 0; k < N; k++) {
        pos[3 * k + 3] = cos(2 * PI * k / N);
        pos[3 * k + 4] = sin(2 * PI * k / N);
        face[3 * k] = 0, face[3 * k + 1] = k + 1, face[3 * k + 2] = (k + 1) % N + 1;
    }
    sn_tri_mesh m;
    make(&m, pos, N + 1, face, N);
    sn_bvh *b = tree_of(&m);
    sn_vec3 at[] = {{0, 0, -4}, {0, 0, 4}, {3, 2, -3}, {-2, 4, 1}, {0.3, 5, 0.2}};
    for (int k = 0; k < 5; k++)
        assert_true(fabs(sn_bvh_winding(b, at[k]) - winding_reference(&m, at[k])) < 1e-4);
    sn_bvh_destroy(b);
    sn_tri_mesh_free(&m);
}

/* ---- overlaps and the tree ---- */

typedef struct seen {
    int n, stop_at;
    bool face[4000];
} seen;

static bool see(void *user, int32_t face)
{
    seen *s = user;
    assert_false(s->face[face]);
    s->face[face] = true;
    return ++s->n != s->stop_at;
}

static void overlap_finds_every_box(void **state)
{
    (void)state;
    sn_tri_mesh m;
    make_bumpy(&m, 20);
    sn_bvh *b = tree_of(&m);
    uint64_t seed = 10;
    for (int trial = 0; trial < 50; trial++) {
        sn_vec3 p = random_point(&seed, 1.2);
        sn_box3 box = sn_box3_add(sn_box3_add(sn_box3_empty(), p), sn_v3_add(p, random_point(&seed, 0.6)));
        seen s = {0};
        sn_bvh_overlap(b, box, see, &s);
        for (int32_t f = 0; f < m.n_face; f++) {
            sn_vec3 t[3];
            face_corners(&m, f, t);
            sn_box3 own = sn_box3_add(sn_box3_add(sn_box3_add(sn_box3_empty(), t[0]), t[1]), t[2]);
            bool meet = own.min.x <= box.max.x && box.min.x <= own.max.x && own.min.y <= box.max.y &&
                        box.min.y <= own.max.y && own.min.z <= box.max.z && box.min.z <= own.max.z;
            assert_int_equal(s.face[f], meet);
        }
        seen one = {.stop_at = 1};
        sn_bvh_overlap(b, box, see, &one);
        assert_int_equal(one.n, s.n > 0 ? 1 : 0);
    }
    sn_bvh_destroy(b);
    sn_tri_mesh_free(&m);
}

static void many_equal_faces_make_a_tree(void **state)
{
    (void)state;
    sn_tri_mesh m;
    sn_tri_mesh_init(&m);
    assert_int_equal(sn_tri_mesh_reserve(&m, 3, 3000, NULL), SN_OK);
    const double pos[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    memcpy(m.pos, pos, sizeof pos);
    for (int32_t k = 0; k < 9000; k++) m.face[k] = k % 3;
    sn_bvh *b = tree_of(&m);
    sn_closest c = sn_bvh_closest(b, sn_v3(0.2, 0.2, 3));
    assert_int_equal(c.face, 0);
    assert_true(c.dist == 3.0);
    sn_ray_hit *h;
    size_t n;
    assert_int_equal(sn_bvh_ray_all(b, sn_v3(0.2, 0.2, 3), sn_v3(0, 0, -1), 9, &h, &n, NULL), SN_OK);
    assert_int_equal(n, 3000);
    for (size_t k = 0; k < n; k++) assert_int_equal(h[k].face, (int)k); /* equal faces: the lower first */
    sn_release(h);
    sn_bvh_destroy(b);
    sn_tri_mesh_free(&m);
}

/* Sizes that halve each time make the deepest trees the split rule allows. */
static void geometric_sizes_stay_within_the_stack(void **state)
{
    (void)state;
    enum { N = 1000 };
    sn_tri_mesh m;
    sn_tri_mesh_init(&m);
    assert_int_equal(sn_tri_mesh_reserve(&m, 3 * N, N, NULL), SN_OK);
    for (int32_t k = 0; k < N; k++) {
        double x = ldexp(1.0, -k), s = 0.1 * x;
        sn_v3_store(m.pos + 9 * k, sn_v3(x, 0, 0));
        sn_v3_store(m.pos + 9 * k + 3, sn_v3(x + s, 0, 0));
        sn_v3_store(m.pos + 9 * k + 6, sn_v3(x, s, 0));
        for (int32_t l = 0; l < 3; l++) m.face[3 * k + l] = 3 * k + l;
    }
    sn_bvh *b = tree_of(&m);
    for (int k = 0; k < 60; k++) {
        double x = ldexp(1.0, -k);
        sn_ray_hit hit;
        assert_int_equal(sn_bvh_closest(b, sn_v3(1.02 * x, 0.01 * x, 0)).face, k);
        assert_true(sn_bvh_ray_first(b, sn_v3(1.02 * x, 0.01 * x, x), sn_v3(0, 0, -x), 2, &hit) &&
                    hit.face == k);
    }
    sn_bvh_destroy(b);
    sn_tri_mesh_free(&m);
}

static void no_faces_is_an_error(void **state)
{
    (void)state;
    sn_tri_mesh m;
    sn_bvh *b;
    sn_error err;
    sn_tri_mesh_init(&m);
    assert_int_equal(sn_bvh_create(&b, &m, &err), SN_EINVAL);
    assert_null(b);
    assert_string_equal(err.msg, "bvh: the surface has no faces, need at least 1");
    sn_bvh_destroy(NULL);
}

/* ---- memory ---- */

typedef struct failing {
    int left;
    int live;
} failing;

static void *failing_realloc(void *user, void *p, size_t bytes)
{
    failing *f = user;
    if (bytes == 0) {
        f->live -= p != NULL;
        free(p);
        return NULL;
    }
    if (f->left-- <= 0) return NULL;
    f->live += p == NULL;
    return realloc(p, bytes);
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    failing f = {1000, 0};
    sn_allocator a = {failing_realloc, &f};
    sn_set_allocator(&a);
    sn_tri_mesh m;
    make_cube(&m);
    int base = f.live;
    sn_status st = SN_ENOMEM;
    for (int allowed = 0; st != SN_OK; allowed++) {
        sn_bvh *b;
        sn_ray_hit *h = NULL;
        size_t n;
        sn_error err;
        f.left = allowed;
        st = sn_bvh_create(&b, &m, &err);
        if (!st) st = sn_bvh_ray_all(b, sn_v3(-1, 0.3, 0.5), sn_v3(1, 0, 0), 9, &h, &n, &err);
        if (st) assert_int_equal(err.code, SN_ENOMEM);
        if (st) assert_null(h);
        assert_true(allowed < 30);
        sn_release(h);
        sn_bvh_destroy(b);
        assert_int_equal(f.live, base);
    }
    sn_tri_mesh_free(&m);
    sn_set_allocator(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ray_through_cube),
        cmocka_unit_test(rays_through_edges_and_corners_of_a_cube),
        cmocka_unit_test(rays_at_vertices_of_a_bumpy_surface),
        cmocka_unit_test(rays_agree_with_plain_loop),
        cmocka_unit_test(bad_rays_are_refused),
        cmocka_unit_test(closest_agrees_with_plain_loop),
        cmocka_unit_test(ties_go_to_the_lowest_face),
        cmocka_unit_test(needles_have_true_distances),
        cmocka_unit_test(winding_of_cube),
        cmocka_unit_test(winding_agrees_with_plain_sum),
        cmocka_unit_test(far_disc_is_seen_by_its_moments),
        cmocka_unit_test(overlap_finds_every_box),
        cmocka_unit_test(many_equal_faces_make_a_tree),
        cmocka_unit_test(geometric_sizes_stay_within_the_stack),
        cmocka_unit_test(no_faces_is_an_error),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
