/* test_extraction - the maximization diagram as tets: hostile ties, sizes, errors, and what it must agree
 * with. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "extract/extraction.h"
#include "field/segmentation.h"
#include "tetra/locate.h"

#include "made_extraction.h"

#include <pthread.h>
#include <signal.h>
#include <time.h>

#define MARGIN 1e-3 /* the default of sn_extract_options */

/* ---- meshes ---- */

static sn_tet_mesh from_arrays(const double *pos, int32_t n_vert, const int32_t *tet, int32_t n_tet)
{
    sn_tet_mesh m;
    sn_tet_mesh_init(&m);
    assert_int_equal(sn_tet_mesh_reserve(&m, n_vert, n_tet, false, NULL), SN_OK);
    memcpy(m.pos, pos, 3 * (size_t)n_vert * sizeof *pos);
    memcpy(m.tet, tet, 4 * (size_t)n_tet * sizeof *tet);
    return m;
}

static sn_tet_mesh one_tet(void)
{
    static const double pos[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    return from_arrays(pos, 4, (int32_t[]){0, 1, 2, 3}, 1);
}

/* Two tets on both sides of the face 1 2 3. */
static sn_tet_mesh two_tets(void)
{
    static const double pos[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
    return from_arrays(pos, 5, (int32_t[]){0, 1, 2, 3, 4, 2, 1, 3}, 2);
}

static void cut(const sn_tet_mesh *m, const double *value, int n_tissue)
{
    sn_extraction x = extract(m, value, n_tissue);
    sn_extraction_free(&x);
}

static int n_winning(const sn_extraction *x)
{
    int n = 0;
    for (int i = 0; i < x->n_tissue; i++) n += sn_extraction_part_tets(x, i) > 0;
    return n;
}

/* ---- ties ---- */

static void equal_values_leave_the_mesh_as_it_is(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(2, sn_v3(0, 0, 0), 1);
    double *value = new_values(&m, 5);
    for (int k = 0; k < 5 * m.n_vert; k++) value[k] = 3.25;
    for (int n = 1; n <= 5; n++) {
        sn_extraction x = extract(&m, value, n);
        assert_int_equal(x.mesh.n_tet, m.n_tet);
        assert_int_equal(x.mesh.n_vert, m.n_vert);
        assert_memory_equal(x.mesh.tet, m.tet, 4 * (size_t)m.n_tet * sizeof *m.tet);
        for (int32_t t = 0; t < m.n_tet; t++) assert_int_equal(x.mesh.part[t], 0);
        assert_int_equal(x.n_moved, 0);
        sn_extraction_free(&x);
    }
    sn_release(value);
    sn_tet_mesh_free(&m);
}

/* Ways to give n_tissue tissues values 0 .. n_level - 1 at the vertices, every `stride`-th of all there are:
 * ties at vertices, along edges, on faces, through whole tets, between all of them. */
static void cut_every_way(const sn_tet_mesh *m, int n_tissue, int n_level, int stride)
{
    double *value = new_values(m, n_tissue);
    int n = n_tissue * m->n_vert, n_way = 1;
    for (int k = 0; k < n; k++) n_way *= n_level;
    for (int way = 0; way < n_way; way += stride) {
        for (int k = 0, rest = way; k < n; k++, rest /= n_level) value[k] = rest % n_level;
        cut(m, value, n_tissue);
    }
    sn_release(value);
}

static void every_tie_in_one_tet(void **state)
{
    (void)state;
    sn_tet_mesh m = one_tet();
    cut_every_way(&m, 2, 3, 1);
    cut_every_way(&m, 3, 2, 1);
    sn_tet_mesh_free(&m);
}

static void ties_of_two_tets(void **state)
{
    (void)state;
    sn_tet_mesh m = two_tets();
    cut_every_way(&m, 2, 3, 11);
    cut_every_way(&m, 3, 2, 5);
    sn_tet_mesh_free(&m);
}

static void many_ties_of_many_tissues(void **state)
{
    (void)state;
    sn_tet_mesh m = two_tets();
    double value[10 * 5];
    for (int i = 0; i < 1000; i++) {
        int n_tissue = 4 + below(7), n_level = 2 + below(3);
        for (int k = 0; k < n_tissue * m.n_vert; k++) value[k] = below(n_level);
        cut(&m, value, n_tissue);
    }
    sn_tet_mesh_free(&m);
}

/* Ties that pass through the middle of edges, faces and the tet: f_i is 1 at corner i and 0 elsewhere. */
static void ties_through_the_centre(void **state)
{
    (void)state;
    sn_tet_mesh m = one_tet();
    double value[4 * 4];
    for (int k = 0; k < 16; k++) value[k] = k / 4 == k % 4;
    sn_extraction x = extract(&m, value, 4);
    /* 4 corners, 6 middles of edges, 4 of faces, 1 of the tet; each cell is a cube: 5 or 6 tets, here from
     * one corner: 6 */
    assert_int_equal(x.mesh.n_vert, 4 + 6 + 4 + 1);
    assert_int_equal(x.n_moved, 0);
    for (int i = 0; i < 4; i++) {
        assert_true(fabs(sn_extraction_part_volume(&x, i) - 1.0 / 24.0) < 1e-15);
        assert_int_equal(sn_extraction_part_tets(&x, i), 6);
    }
    const double *centre = x.mesh.pos + 3 * 14;
    for (int c = 0; c < 3; c++) assert_true(fabs(centre[c] - 0.25) < 1e-15);
    sn_extraction_free(&x);
    sn_tet_mesh_free(&m);
}

static void random_lattice(int n, int n_tissue, int n_level)
{
    sn_tet_mesh m = made_lattice(n, sn_v3(0, 0, 0), 1);
    double *value = new_values(&m, n_tissue);
    for (int k = 0; k < n_tissue * m.n_vert; k++) value[k] = below(n_level);
    cut(&m, value, n_tissue);
    sn_release(value);
    sn_tet_mesh_free(&m);
}

static void ties_on_lattices(void **state)
{
    (void)state;
    for (int i = 0; i < 48; i++)
        for (int n_level = 2; n_level <= 3; n_level++) random_lattice(1 + i % 2, 3 + i % 6, n_level);
    for (int i = 0; i < 6; i++) random_lattice(3, 3 + i, 2);
}

/* ---- many tissues ---- */

static void sixty_four_random_tissues_in_one_tet(void **state)
{
    (void)state;
    sn_tet_mesh m = one_tet();
    double value[64 * 4];
    for (int i = 0; i < 20; i++) {
        for (int k = 0; k < 64 * 4; k++) value[k] = rnd();
        cut(&m, value, 64);
        for (int k = 0; k < 64 * 4; k++) value[k] = below(2 + i);
        cut(&m, value, 64);
    }
    sn_tet_mesh_free(&m);
}

/* f_i = a_i . p - |a_i|^2 / 2 with sites a_i on the moment curve (t, t^2, t^3) inside the tet: tissue i wins
 * at a_i, and cells of a moment curve's Voronoi diagram all touch each other. */
static void sixty_four_tissues_that_all_win(void **state)
{
    (void)state;
    sn_tet_mesh m = one_tet();
    double value[64 * 4], site[64][3];
    for (int i = 0; i < 64; i++) {
        double t = 0.05 + 0.45 * i / 63.0, half = 0.0;
        for (int c = 0; c < 3; c++) site[i][c] = pow(t, c + 1);
        for (int c = 0; c < 3; c++) half += 0.5 * site[i][c] * site[i][c];
        for (int v = 0; v < 4; v++) value[4 * i + v] = (v > 0 ? site[i][v - 1] : 0.0) - half;
    }
    sn_extraction x = extract(&m, value, 64);
    assert_int_equal(n_winning(&x), 64);
    sn_locator *l = NULL;
    assert_int_equal(sn_locator_create(&l, &x.mesh, NULL), SN_OK);
    for (int i = 0; i < 64; i++) {
        int32_t t = sn_locator_find(l, sn_v3_load(site[i]), NULL);
        assert_true(t >= 0);
        assert_int_equal(x.mesh.part[t], i);
    }
    sn_locator_destroy(l);
    sn_extraction_free(&x);
    sn_tet_mesh_free(&m);
}

static void one_tissue_and_an_empty_one(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(2, sn_v3(0, 0, 0), 1), part;
    double *value = new_values(&m, 3);
    for (int k = 0; k < m.n_vert; k++) {
        value[k] = rnd();
        value[m.n_vert + k] = rnd();
        value[2 * m.n_vert + k] = -0.001 * k;
    }
    cut(&m, value, 1);
    sn_extraction x = extract(&m, value, 3);
    assert_int_equal(sn_extraction_part_tets(&x, 2), 0);
    assert_true(sn_extraction_part_volume(&x, 2) == 0.0);
    sn_tet_mesh_init(&part);
    assert_int_equal(sn_extraction_part(&x, 2, &part, NULL), SN_OK);
    assert_int_equal(part.n_tet, 0);
    assert_int_equal(part.n_vert, 0);
    sn_tet_mesh_free(&part);
    sn_extraction_free(&x);
    sn_release(value);
    sn_tet_mesh_free(&m);
}

/* ---- numbers ---- */

static void near_ties(void **state)
{
    (void)state;
    for (int i = 0; i < 40; i++) {
        sn_tet_mesh m = made_lattice(1 + i % 3, sn_v3(0, 0, 0), 1);
        int n_tissue = 2 + below(5);
        double *value = new_values(&m, n_tissue), eps = pow(10.0, -6 - below(10));
        for (int v = 0; v < m.n_vert; v++)
            for (int t = 0; t < n_tissue; t++)
                value[t * m.n_vert + v] = (i % 2 ? v % 5 : below(2)) + eps * (rnd() - 0.5);
        cut(&m, value, n_tissue);
        sn_release(value);
        sn_tet_mesh_free(&m);
    }
}

/* Only where values lie in their own range counts: the same parts for a f + b. */
static void huge_tiny_and_negative_values(void **state)
{
    (void)state;
    static const double scale[] = {1e300, 1.7e308, 1e-290, -1.0, 1e-3, 0x1p-600};
    static const double shift[] = {0, 0, 0, -7, 1e3, 0};
    sn_tet_mesh m = made_lattice(2, sn_v3(0, 0, 0), 1);
    double *value = new_values(&m, 4), *other = new_values(&m, 4);
    for (int k = 0; k < 4 * m.n_vert; k++) value[k] = 2.0 * rnd() - 1.0;
    sn_extraction x = extract(&m, value, 4);
    for (int i = 0; i < 6; i++) {
        for (int k = 0; k < 4 * m.n_vert; k++) other[k] = fabs(scale[i]) * value[k] + shift[i];
        sn_extraction y = extract(&m, other, 4);
        assert_int_equal(y.mesh.n_tet, x.mesh.n_tet);
        for (int t = 0; t < 4; t++)
            assert_true(fabs(sn_extraction_part_volume(&x, t) - sn_extraction_part_volume(&y, t)) < 1e-6);
        sn_extraction_free(&y);
    }
    for (int k = 0; k < 4 * m.n_vert; k++)
        other[k] = 1e-310 * value[k]; /* no numbers to tell them apart: sound at least */
    cut(&m, other, 4);
    for (int k = 0; k < 4 * m.n_vert; k++) other[k] = value[k] > 0.9 ? 1e300 : value[k];
    cut(&m, other, 4);
    sn_extraction_free(&x);
    sn_release(value);
    sn_release(other);
    sn_tet_mesh_free(&m);
}

/* Lengths must not count either, nor where the mesh lies. */
static void far_small_and_shaken_meshes(void **state)
{
    (void)state;
    static const double size[] = {1e-9, 1e-3, 1.0, 1e6, 1.0};
    static const double away[] = {0, 0, 0, 0, 1e4};
    for (int i = 0; i < 5; i++) {
        sn_tet_mesh m = made_lattice(3, sn_v3(away[i], -away[i], away[i]), size[i]);
        shake_mesh(&m, 0.15 * size[i]);
        double *value = new_values(&m, 5);
        for (int k = 0; k < 5 * m.n_vert; k++) value[k] = i % 2 ? rnd() : below(3);
        cut(&m, value, 5);
        sn_release(value);
        sn_tet_mesh_free(&m);
    }
}

/* ---- errors ---- */

static void assert_refused(const sn_tet_mesh *m, const double *value, int n_tissue, double margin,
                           sn_status status, const char *want)
{
    sn_extraction x;
    sn_error err = {0};
    sn_extract_options opt = {.margin = margin};
    sn_extraction_init(&x);
    assert_int_equal(sn_extract(m, value, names(), n_tissue, &opt, NULL, &x, &err), status);
    assert_string_equal(err.msg, want);
    assert_null(x.mesh.tet);
    assert_null(x.name);
    assert_int_equal(x.n_tissue, 0);
    assert_int_equal(sn_extract(m, value, names(), n_tissue, &opt, NULL, &x, NULL), status);
}

static void bad_input_is_named(void **state)
{
    (void)state;
    sn_tet_mesh m = one_tet();
    double value[8] = {1, 2, 3, 4, 5, 6, 7, 8};
    assert_refused(&m, value, 0, 0, SN_EINVAL, "extract: 0 tissues, need 1 to 4096");
    assert_refused(&m, value, -3, 0, SN_EINVAL, "extract: -3 tissues, need 1 to 4096");
    assert_refused(&m, value, 4097, 0, SN_EINVAL, "extract: 4097 tissues, need 1 to 4096");
    assert_refused(&m, value, 2, -1, SN_EINVAL, "extract: margin is -1, need > 0 and <= 0.2");
    assert_refused(&m, value, 2, 0.21, SN_EINVAL, "extract: margin is 0.21, need > 0 and <= 0.2");
    assert_refused(&m, value, 2, (double)NAN, SN_EINVAL, "extract: margin is nan, need > 0 and <= 0.2");
    value[5] = (double)NAN;
    assert_refused(&m, value, 2, 0, SN_EINVAL, "extract: value of 't1' at vertex 2 is not finite");
    value[5] = 0.0;
    value[3] = -(double)INFINITY;
    assert_refused(&m, value, 2, 0.1, SN_EINVAL, "extract: value of 'fat' at vertex 4 is not finite");
    value[3] = 0.0;
    m.tet[2] = 0;
    sn_error err = {0};
    sn_extraction x;
    sn_extraction_init(&x);
    assert_int_equal(sn_extract(&m, value, names(), 2, NULL, NULL, &x, &err), SN_EINVAL);
    assert_non_null(strstr(err.msg, "extract: "));
    sn_tet_mesh_free(&m);
}

static void margins_up_to_the_largest(void **state)
{
    (void)state;
    static const double margin[] = {1e-9, 1e-3, 0.05, 0.2};
    sn_tet_mesh m = made_lattice(2, sn_v3(0, 0, 0), 1);
    double *value = new_values(&m, 6);
    for (int i = 0; i < 40; i++) {
        sn_extraction x;
        sn_error err = {0};
        sn_extract_options opt = {.margin = margin[i % 4]};
        for (int k = 0; k < 6 * m.n_vert; k++) value[k] = i < 20 ? rnd() : below(2 + i % 3);
        sn_extraction_init(&x);
        if (sn_extract(&m, value, names(), 6, &opt, NULL, &x, &err)) fail_msg("%s", err.msg);
        assert_sound(&x, &m, 6);
        sn_extraction_free(&x);
    }
    sn_release(value);
    sn_tet_mesh_free(&m);
}

static void an_earlier_result_is_replaced(void **state)
{
    (void)state;
    sn_tet_mesh m = two_tets();
    double value[15];
    for (int k = 0; k < 15; k++) value[k] = rnd();
    sn_extraction x = extract(&m, value, 3);
    assert_int_equal(sn_extract(&m, value, names(), 2, NULL, NULL, &x, NULL), SN_OK);
    assert_sound(&x, &m, 2);
    assert_int_equal(sn_extract(&m, value, names(), 0, NULL, NULL, &x, NULL), SN_EINVAL);
    assert_null(x.mesh.tet);
    sn_extraction_free(&x);
    sn_tet_mesh_free(&m);
}

/* ---- agreement with the fields ---- */

/* Smooth bumps: tissue i peaks at a random place, fat is low everywhere. */
static double *bumps(const sn_tet_mesh *m, int n_tissue)
{
    double *value = new_values(m, n_tissue);
    sn_box3 box = sn_tet_mesh_bounds(m);
    sn_vec3 size = sn_v3_sub(box.max, box.min);
    for (int i = 0; i < n_tissue; i++) {
        sn_vec3 c = sn_v3(rnd(), rnd(), rnd());
        double width = 0.02 + 0.1 * rnd(), height = 0.5 + rnd();
        for (int32_t v = 0; v < m->n_vert; v++) {
            sn_vec3 p = sn_v3_sub(sn_tet_mesh_point(m, v), box.min);
            sn_vec3 d = sn_v3_sub(sn_v3(p.x / size.x, p.y / size.y, p.z / size.z), c);
            value[i * m->n_vert + v] = i ? height * exp(-sn_v3_len2(d) / width) : 0.25;
        }
    }
    return value;
}

/* How far the part's tissue may lie below the winner inside a tet: the values move by at most half a grid
 * step each, and a corner's weights by at most 6 margins together, which changes a difference of functions by
 * at most 3 margins of its range over the tet. The winner's lead is convex and small at all corners, so it is
 * small inside. */
static double allowed_lead(const sn_tet_mesh *m, const double *value, int n_tissue, int32_t t, int32_t part,
                           double step)
{
    double widest = 0.0;
    for (int j = 0; j < n_tissue; j++) {
        double lo = INFINITY, hi = -INFINITY;
        for (int k = 0; k < 4; k++) {
            int32_t v = m->tet[4 * t + k];
            double d = value[j * m->n_vert + v] - value[part * m->n_vert + v];
            lo = fmin(lo, d);
            hi = fmax(hi, d);
        }
        widest = fmax(widest, hi - lo);
    }
    return step + 3.0 * MARGIN * widest + 1e-12;
}

static void compare_with_argmax(const sn_tet_mesh *m, int n_tissue, int n_point)
{
    double *value = bumps(m, n_tissue), lo = value[0], hi = value[0], lead[MAX_NAMES];
    for (int k = 0; k < n_tissue * m->n_vert; k++) {
        lo = fmin(lo, value[k]);
        hi = fmax(hi, value[k]);
    }
    sn_extraction x = extract(m, value, n_tissue);
    assert_true(n_winning(&x) > n_tissue / 2);
    sn_locator *l = NULL;
    assert_int_equal(sn_locator_create(&l, &x.mesh, NULL), SN_OK);
    sn_box3 box = sn_tet_mesh_bounds(m);
    int n_other = 0, n_inside = 0;
    for (int i = 0; i < n_point; i++) {
        sn_vec3 p =
            sn_v3(box.min.x + rnd() * (box.max.x - box.min.x), box.min.y + rnd() * (box.max.y - box.min.y),
                  box.min.z + rnd() * (box.max.z - box.min.z));
        double bary[4];
        int32_t t = sn_locator_find(l, p, NULL);
        if (t < 0) continue; /* a shaken mesh does not fill its box */
        n_inside++;
        int32_t source = x.source[t], part = x.mesh.part[t];
        sn_tet_barycentric(m, source, p, bary);
        for (int k = 0; k < 4; k++) assert_true(bary[k] > -1e-9);
        sn_tissue_values(m, value, n_tissue, source, bary, lead);
        int32_t best = sn_tissue_winner(lead, n_tissue);
        if (best == part) continue;
        n_other++;
        assert_true(lead[best] - lead[part] <=
                    allowed_lead(m, value, n_tissue, source, part, (hi - lo) / (double)(1 << 27)));
    }
    assert_true(n_inside > 9 * (n_point / 10));
    assert_true(n_other < n_inside / 1000); /* the allowance is not what makes it pass */
    sn_locator_destroy(l);
    sn_extraction_free(&x);
    sn_release(value);
}

static void a_million_points_have_the_largest_tissue(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(12, sn_v3(0, 0, 0), 1);
    compare_with_argmax(&m, 12, 600000);
    shake_mesh(&m, 0.15);
    for (size_t k = 0; k < 3 * (size_t)m.n_vert; k++) m.pos[k] *= (double[]){1e-3, 2e-3, 1e-4}[k % 3];
    compare_with_argmax(&m, 12, 400000);
    sn_tet_mesh_free(&m);
}

/* At the input's vertices exactly, at the other corners as near as they lie to where they belong. */
static void the_envelope_is_the_largest_value(void **state)
{
    (void)state;
    enum { N = 9 };
    sn_tet_mesh m = made_lattice(6, sn_v3(0, 0, 0), 1);
    double *value = bumps(&m, N), at[N];
    sn_extraction x = extract(&m, value, N);
    for (int32_t v = 0; v < m.n_vert; v++) {
        double best = value[v];
        for (int i = 1; i < N; i++) best = fmax(best, value[i * m.n_vert + v]);
        assert_true(fabs(x.envelope[v] - best) <=
                    1.5 / (double)(1 << 27)); /* the winner is that on the grid */
    }
    for (int32_t t = 0; t < x.mesh.n_tet; t++)
        for (int k = 0; k < 4; k++) {
            double bary[4];
            int32_t v = x.mesh.tet[4 * t + k], source = x.source[t];
            sn_tet_barycentric(&m, source, sn_tet_mesh_point(&x.mesh, v), bary);
            sn_tissue_values(&m, value, N, source, bary, at);
            double best = at[sn_tissue_winner(at, N)];
            assert_true(x.envelope[v] <= best + 1e-12);
            assert_true(x.envelope[v] >=
                        best - allowed_lead(&m, value, N, source, x.mesh.part[t], 1.5 / (1 << 27)));
        }
    sn_extraction_free(&x);
    sn_release(value);
    sn_tet_mesh_free(&m);
}

/* ---- volumes ---- */

/* The part of the unit cube with n . p < s, n > 0. */
static double cut_cube(const double n[3], double s)
{
    double sum = 0.0;
    for (int c = 0; c < 8; c++) {
        double left = s - (c & 1 ? n[0] : 0) - (c & 2 ? n[1] : 0) - (c & 4 ? n[2] : 0);
        sum += left > 0.0 ? pow(left, 3) * (c == 0 || c == 3 || c == 5 || c == 6 ? 1 : -1) : 0.0;
    }
    return sum / (6.0 * n[0] * n[1] * n[2]);
}

static void a_plane_cuts_a_cube(void **state)
{
    (void)state;
    static const double normal[3][3] = {{1, 1, 1}, {1, 2, 3}, {0.3, 1.7, 0.9}};
    sn_tet_mesh m = made_lattice(5, sn_v3(0, 0, 0), 0.2);
    double *value = new_values(&m, 2);
    for (int i = 0; i < 30; i++) {
        const double *n = normal[i % 3], s = (0.05 + 0.9 * rnd()) * (n[0] + n[1] + n[2]);
        for (int32_t v = 0; v < m.n_vert; v++) {
            const double *p = m.pos + 3 * v;
            value[v] = n[0] * p[0] + n[1] * p[1] + n[2] * p[2];
            value[m.n_vert + v] = s;
        }
        sn_extraction x = extract(&m, value, 2);
        double allowed = 1e-7 + 1.8 * x.largest_move; /* the cut is less than 1.8 large */
        assert_true(x.largest_move < 2.0 * MARGIN * 0.2 * sqrt(3.0));
        assert_true(fabs(sn_extraction_part_volume(&x, 1) - cut_cube(n, s)) < allowed);
        if (x.n_moved == 0) assert_true(x.largest_move == 0.0);
        sn_extraction_free(&x);
    }
    sn_release(value);
    sn_tet_mesh_free(&m);
}

/* Tissue 1 wins in a ball of radius 0.4, tissue 2 in half of it. */
static double ball_error(int n, double *half_error)
{
    sn_tet_mesh m = made_lattice(n, sn_v3(-0.5, -0.5, -0.5), 1.0 / n);
    double *value = new_values(&m, 3), want = 4.0 / 3.0 * TEST_PI * 0.064;
    for (int32_t v = 0; v < m.n_vert; v++) {
        sn_vec3 p = sn_tet_mesh_point(&m, v);
        value[v] = 0.0;
        value[m.n_vert + v] = 0.16 - sn_v3_len2(p);
        value[2 * m.n_vert + v] = 0.16 - sn_v3_len2(p) + 0.3 * p.x - 0.1 * p.y + 0.2 * p.z;
    }
    sn_extraction x = extract(&m, value, 3);
    double ball =
        0.0; /* where tissue 1 or 2 beats fat is larger than the ball: take fields without the tilt */
    for (int32_t v = 0; v < m.n_vert; v++) value[2 * m.n_vert + v] = -1.0;
    sn_extraction y = extract(&m, value, 3);
    ball = sn_extraction_part_volume(&y, 1);
    *half_error = fabs(sn_extraction_part_volume(&x, 1) - 0.5 * want);
    sn_extraction_free(&x);
    sn_extraction_free(&y);
    sn_release(value);
    sn_tet_mesh_free(&m);
    return fabs(ball - want);
}

/* Fields are linear in tets: the error of a curved border goes with the square of the edge length. */
static void a_ball_converges(void **state)
{
    (void)state;
    double half[2], error[2] = {ball_error(9, &half[0]), ball_error(18, &half[1])};
    assert_true(error[0] < 0.02 && error[1] < 0.3 * error[0]);
    assert_true(half[0] < 0.02 && half[1] < 0.35 * half[0]);
}

/* ---- the same for all threads, orders ---- */

static void threads_do_not_count(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(12, sn_v3(0, 0, 0), 1);
    double *value = bumps(&m, 20);
    for (int32_t k = 0; k < 20 * m.n_vert; k++) value[k] = k % 7 ? value[k] : rint(4 * value[k]) / 4;
    sn_extraction x[3];
    for (int i = 0; i < 3; i++) {
        sn_error err = {0};
        sn_extraction_init(&x[i]);
        if (sn_extract(&m, value, names(), 20, NULL, &(sn_run){.n_threads = 1 + i}, &x[i], &err))
            fail_msg("%s", err.msg);
        assert_int_equal(x[i].mesh.n_tet, x[0].mesh.n_tet);
        assert_int_equal(x[i].mesh.n_vert, x[0].mesh.n_vert);
        size_t n_tet = (size_t)x[0].mesh.n_tet, n_vert = (size_t)x[0].mesh.n_vert;
        assert_memory_equal(x[i].mesh.pos, x[0].mesh.pos, 3 * n_vert * sizeof *x[0].mesh.pos);
        assert_memory_equal(x[i].mesh.tet, x[0].mesh.tet, 4 * n_tet * sizeof *x[0].mesh.tet);
        assert_memory_equal(x[i].mesh.part, x[0].mesh.part, n_tet * sizeof *x[0].mesh.part);
        assert_memory_equal(x[i].source, x[0].source, n_tet * sizeof *x[0].source);
        assert_int_equal(x[i].n_moved, x[0].n_moved);
        assert_true(x[i].largest_move == x[0].largest_move);
    }
    assert_sound(&x[0], &m, 20);
    for (int i = 0; i < 3; i++) sn_extraction_free(&x[i]);
    sn_release(value);
    sn_tet_mesh_free(&m);
}

/* Without ties the order of the tissues only renames them: the same corners, the same volumes. */
static void the_order_of_tissues_only_renames(void **state)
{
    (void)state;
    enum { N = 9 };
    sn_tet_mesh m = made_lattice(6, sn_v3(0, 0, 0), 1);
    double *value = bumps(&m, N), *turned = new_values(&m, N);
    for (int k = 0; k < N * m.n_vert; k++) value[k] += 1e-4 * rnd();
    sn_extraction x = extract(&m, value, N);
    for (int turn = 1; turn < N; turn += 3) {
        for (int i = 0; i < N; i++)
            memcpy(turned + ((i * 2 + turn) % N) * m.n_vert, value + i * m.n_vert,
                   (size_t)m.n_vert * sizeof *value);
        sn_extraction y = extract(&m, turned, N);
        assert_int_equal(y.mesh.n_vert, x.mesh.n_vert);
        assert_int_equal(y.n_moved, x.n_moved);
        for (int i = 0; i < N; i++)
            assert_true(fabs(sn_extraction_part_volume(&x, i) -
                             sn_extraction_part_volume(&y, (i * 2 + turn) % N)) < 1e-9);
        sn_locator *l = NULL;
        assert_int_equal(sn_locator_create(&l, &y.mesh, NULL), SN_OK);
        for (int32_t t = 0; t < x.mesh.n_tet; t++) { /* the middle of each tet lies in the same tissue */
            sn_vec3 p = sn_v3(0, 0, 0);
            if (sn_tet_mesh_tet_volume(&x.mesh, t) < 1e-6)
                continue; /* rounding may put a flat tet's on the other side */
            for (int k = 0; k < 4; k++)
                p = sn_v3_mad(p, 0.25, sn_tet_mesh_point(&x.mesh, x.mesh.tet[4 * t + k]));
            int32_t at = sn_locator_find(l, p, NULL);
            assert_true(at >= 0);
            assert_int_equal(y.source[at], x.source[t]);
            assert_int_equal(y.mesh.part[at], (x.mesh.part[t] * 2 + turn) % N);
        }
        sn_locator_destroy(l);
        sn_extraction_free(&y);
    }
    sn_extraction_free(&x);
    sn_release(value);
    sn_release(turned);
    sn_tet_mesh_free(&m);
}

/* ---- interruption, memory ---- */

typedef struct stopper {
    volatile sig_atomic_t cancel;
    int left;
} stopper;

static void count_down(void *user, const char *step, double fraction)
{
    stopper *s = user;
    assert_non_null(step);
    assert_true(fraction <= 1.0);
    if (s->left-- <= 0) s->cancel = 1;
}

static void can_be_stopped_anywhere(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(2, sn_v3(0, 0, 0), 1);
    double *value = new_values(&m, 6);
    for (int k = 0; k < 6 * m.n_vert; k++) value[k] = below(2);
    ration r = {.left = INT32_MAX};
    int n_stopped = 0;
    sn_status st = SN_ECANCEL;
    for (; st == SN_ECANCEL; n_stopped++) {
        stopper s = {.left = n_stopped};
        sn_run run = {.n_threads = 2, .cancel = &s.cancel, .progress = count_down, .user = &s};
        sn_extraction x;
        sn_error err = {0};
        sn_extraction_init(&x);
        if (n_stopped == 0) s.cancel = 1;
        st = sn_extract(&m, value, names(), 6, NULL, &run, &x, &err);
        assert_true(st == SN_OK || st == SN_ECANCEL);
        if (st) assert_non_null(strstr(err.msg, "interrupted"));
        if (st) assert_null(x.mesh.tet);
        sn_extraction_free(&x);
    }
    assert_true(n_stopped > 3);
    sn_extraction x;
    sn_error err = {0};
    sn_extraction_init(&x);
    sn_set_allocator(RATION(r));
    stopper s = {.cancel = 1};
    assert_int_equal(
        sn_extract(&m, value, names(), 6, NULL, &(sn_run){.n_threads = 1, .cancel = &s.cancel}, &x, &err),
        SN_ECANCEL);
    sn_set_allocator(NULL);
    assert_int_equal(r.in_use, 0);
    assert_int_equal(sn_extract(&m, value, names(), 6, NULL, &(sn_run){.deadline = 1e-9}, &x, &err),
                     SN_ELIMIT);
    assert_non_null(strstr(err.msg, "time limit"));
    sn_release(value);
    sn_tet_mesh_free(&m);
}

static void short_of_memory_at_every_step(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(1, sn_v3(0, 0, 0), 1);
    double *value = new_values(&m, 7);
    for (int k = 0; k < 7 * m.n_vert; k++) value[k] = k < 4 * m.n_vert ? below(2) : rnd();
    sn_run run = {.n_threads = 1};
    sn_status st = SN_ENOMEM;
    int left = 0;
    for (; st == SN_ENOMEM; left++) {
        sn_extraction x;
        sn_error err = {0};
        sn_extraction_init(&x);
        ration r = {.left = left};
        sn_set_allocator(RATION(r));
        st = sn_extract(&m, value, names(), 7, NULL, &run, &x, &err);
        if (st) assert_int_equal(r.in_use, 0);
        if (st) assert_non_null(strstr(err.msg, "no memory"));
        if (st) assert_null(x.mesh.tet);
        sn_extraction_free(&x);
        sn_set_allocator(NULL);
        assert_int_equal(r.in_use, 0);
    }
    assert_int_equal(st, SN_OK);
    assert_true(left > 20);
    sn_release(value);
    sn_tet_mesh_free(&m);
}

static void other_calls_short_of_memory(void **state)
{
    (void)state;
    sn_tet_mesh m = two_tets();
    double value[15];
    for (int k = 0; k < 15; k++) value[k] = rnd();
    sn_extraction x = extract(&m, value, 3);
    for (int what = 0; what < 2; what++) {
        sn_status st = SN_ENOMEM;
        for (int left = 0; st == SN_ENOMEM; left++) {
            sn_tet_mesh part;
            sn_extraction_check c;
            sn_error err = {0};
            ration r = {.left = left};
            sn_tet_mesh_init(&part);
            sn_set_allocator(RATION(r));
            st = what == 0 ? sn_extraction_part(&x, 1, &part, &err)
                           : sn_extraction_check_run(&c, &x, &m, NULL, &err);
            sn_tet_mesh_free(&part);
            sn_set_allocator(NULL);
            assert_int_equal(r.in_use, 0);
            if (st) assert_non_null(strstr(err.msg, "memory"));
            if (left == 0) assert_int_equal(st, SN_ENOMEM);
        }
        assert_int_equal(st, SN_OK);
    }
    sn_extraction_free(&x);
    sn_tet_mesh_free(&m);
}

/* ---- the check itself ---- */

static sn_extraction_check run_check(const sn_extraction *x, const sn_tet_mesh *input)
{
    sn_extraction_check c;
    assert_int_equal(sn_extraction_check_run(&c, x, input, NULL, NULL), SN_OK);
    return c;
}

static void the_check_sees_what_is_broken(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(2, sn_v3(0, 0, 0), 1);
    double *value = new_values(&m, 3);
    for (int k = 0; k < 3 * m.n_vert; k++) value[k] = rnd();
    sn_extraction x = extract(&m, value, 3);
    sn_extraction_check c = run_check(&x, NULL);
    assert_true(c.conforming && c.manifold && c.positive && c.volume_error < 1e-12);

    int32_t *t = x.mesh.tet + 4 * 17, swap = t[0]; /* a tet turned inside out */
    t[0] = t[1];
    t[1] = swap;
    c = run_check(&x, &m);
    assert_false(c.positive);
    assert_int_equal(c.inverted, 1);
    assert_true(c.min_volume < 0.0 && c.volume_error > 0.0);
    t[1] = t[0];
    t[0] = swap;

    x.mesh.n_tet--; /* a tet lost */
    c = run_check(&x, &m);
    assert_false(c.conforming);
    assert_true(c.positive && c.volume_error > 0.0);
    x.mesh.n_tet++;

    int32_t kept[4]; /* a tet twice: its faces have three */
    memcpy(kept, t, sizeof kept);
    memcpy(t, t - 4, sizeof kept);
    c = run_check(&x, &m);
    assert_false(c.conforming);
    memcpy(t, kept, sizeof kept);

    x.mesh.pos[3 * (size_t)m.n_vert] +=
        1e-3; /* a corner off its edge: bad if it shows outside or turns a tet */
    x.mesh.pos[3 * (size_t)m.n_vert + 1] += 1e-3;
    x.mesh.pos[3 * (size_t)m.n_vert + 2] -= 1e-3;
    c = run_check(&x, &m);
    assert_true(!c.conforming || !c.positive || c.volume_error < 1e-12);
    sn_extraction_free(&x);

    sn_extraction_init(&x); /* two tets of a tissue that share just an edge: a cube's opposite tets */
    for (int k = 0; k < m.n_vert; k++) value[k] = 0.0;
    x = extract(&m, value, 1);
    for (int32_t i = 0; i < 48; i++) x.mesh.part[i] = i == 0 || i == 3;
    x.n_tissue = 1; /* only fat is looked at, and the whole */
    c = run_check(&x, &m);
    assert_false(c.manifold);
    assert_true(c.nonmanifold_edges > 0 && c.conforming);
    sn_extraction_free(&x);
    sn_release(value);
    sn_tet_mesh_free(&m);
}

/* ---- stopping by another thread ---- */

typedef struct later {
    volatile sig_atomic_t cancel;
    int ms;
} later;

static void *cancel_later(void *user)
{
    later *l = user;
    const struct timespec t = {0, 1000000L * l->ms};
    (void)nanosleep(&t, NULL);
    l->cancel = 1;
    return NULL;
}

/* By another thread while it cuts: a whole result or none. */
static void stopped_by_another_thread(void **state)
{
    (void)state;
    enum { n_tissue = 30 };
    sn_tet_mesh m;
    double *value;
    sn_extraction x;
    sn_error err = {0};
    m = made_lattice(22, sn_v3(0, 0, 0), 1.0 / 22);
    value = new_values(&m, n_tissue);
    for (size_t k = 0; k < (size_t)n_tissue * (size_t)m.n_vert; k++) value[k] = rnd();
    sn_extraction_init(&x);
    for (int ms = 0; ms <= 64; ms = ms ? 2 * ms : 1) {
        later s = {.ms = ms};
        pthread_t thread;
        const sn_run run = {.n_threads = 2, .cancel = &s.cancel};
        assert_int_equal(pthread_create(&thread, NULL, cancel_later, &s), 0);
        sn_status st = sn_extract(&m, value, names(), n_tissue, NULL, &run, &x, &err);
        assert_int_equal(pthread_join(thread, NULL), 0);
        assert_true(st == SN_OK || st == SN_ECANCEL);
        assert_true(st == SN_OK ? x.mesh.n_tet > m.n_tet : !x.mesh.pos && !x.name);
        sn_extraction_free(&x);
    }
    sn_release(value);
    sn_tet_mesh_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_values_leave_the_mesh_as_it_is),
        cmocka_unit_test(every_tie_in_one_tet),
        cmocka_unit_test(ties_of_two_tets),
        cmocka_unit_test(many_ties_of_many_tissues),
        cmocka_unit_test(ties_through_the_centre),
        cmocka_unit_test(ties_on_lattices),
        cmocka_unit_test(sixty_four_random_tissues_in_one_tet),
        cmocka_unit_test(sixty_four_tissues_that_all_win),
        cmocka_unit_test(one_tissue_and_an_empty_one),
        cmocka_unit_test(near_ties),
        cmocka_unit_test(huge_tiny_and_negative_values),
        cmocka_unit_test(far_small_and_shaken_meshes),
        cmocka_unit_test(bad_input_is_named),
        cmocka_unit_test(margins_up_to_the_largest),
        cmocka_unit_test(an_earlier_result_is_replaced),
        cmocka_unit_test(a_million_points_have_the_largest_tissue),
        cmocka_unit_test(the_envelope_is_the_largest_value),
        cmocka_unit_test(a_plane_cuts_a_cube),
        cmocka_unit_test(a_ball_converges),
        cmocka_unit_test(threads_do_not_count),
        cmocka_unit_test(the_order_of_tissues_only_renames),
        cmocka_unit_test(can_be_stopped_anywhere),
        cmocka_unit_test(short_of_memory_at_every_step),
        cmocka_unit_test(other_calls_short_of_memory),
        cmocka_unit_test(the_check_sees_what_is_broken),
        cmocka_unit_test(stopped_by_another_thread),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
