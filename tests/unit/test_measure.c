/* test_measure - sizes of the regions in which tissues win: by hand, by closed formulas, by adding up, and
 * against the extraction. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "extract/extraction.h"
#include "field/measure.h"

#include "made_mesh.h"

static sn_measure *measure_of(const sn_tet_mesh *m, const double *field, int32_t n_tissue, int32_t tissue)
{
    sn_measure *out = NULL;
    sn_error err = {.msg = ""};
    if (sn_measure_create(&out, m, field, n_tissue, tissue, NULL, &err)) fail_msg("%s", err.msg);
    return out;
}

/* The share of the unit tet that a tissue wins. */
static double share_of(const double *field, int32_t n_tissue, int32_t tissue, double scale)
{
    sn_tet_mesh tet = made_unit_tet();
    sn_measure *m = measure_of(&tet, field, n_tissue, tissue);
    double share = sn_measure_tet_share(m, 0, scale);
    assert_true(fabs(sn_measure_volume(m, scale, NULL) - share / 6.0) < 1e-16);
    sn_measure_destroy(m);
    sn_tet_mesh_free(&tet);
    return share;
}

/* ---- one tet ---- */

static void shares_with_one_rival(void **state)
{
    (void)state;
    const struct {
        double lead[4], want; /* of tissue 1 over tissue 0 */
    } cases[] = {
        {{1, 1, 1, 1}, 1},
        {{-1, -1, -2, -1}, 0},
        {{1, -1, -1, -1}, 1.0 / 8},  /* half way along three edges: (1/2)^3 */
        {{-1, -1, 1, -1}, 1.0 / 8},  /* the same at another corner */
        {{1, -3, -3, -3}, 1.0 / 64}, /* a quarter along three edges */
        {{1, -1, -3, -7}, 1.0 / 64}, /* 1/2, 1/4 and 1/8 */
        {{1, 1, -1, 1}, 7.0 / 8},    /* a corner is cut off */
        {{1, 1, -1, -1}, 1.0 / 2},   /* a prism: half by symmetry */
        {{-1, 1, -1, 1}, 1.0 / 2},
        {{1, 1, -3, -3}, 5.0 / 32}, /* 3 s^2 - 2 s^3 at s = 1/4 */
        {{1, 0, 0, 0}, 1},          /* a tie on a face takes nothing away */
        {{-1, 0, 0, 0}, 0},
        {{0, 0, -1, 1}, 1.0 / 2},     /* the plane through an edge */
        {{0, -1, 1, 3}, 1 - 1.0 / 8}, /* and through a corner: 1 - 1/2 1/4 */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double field[8] = {10, 20, 30, 40};
        for (int k = 0; k < 4; k++) field[4 + k] = field[k] + cases[i].lead[k];
        assert_true(fabs(share_of(field, 2, 1, 1.0) - cases[i].want) < 1e-15);
        assert_true(fabs(share_of(field, 2, 0, 1.0) - (1.0 - cases[i].want)) < 1e-15);
    }
}

/* The part of a tet where a linear function with values g at the corners is above 0: the sum over those above
 * of g_i^3 / product of (g_i - g_j). */
static double part_above(const double g[4])
{
    double sum = 0.0;
    for (int i = 0; i < 4; i++) {
        double term = g[i] * g[i] * g[i];
        for (int j = 0; j < 4; j++)
            if (j != i) term /= g[i] - g[j];
        if (g[i] > 0.0) sum += term;
    }
    return sum;
}

static void shares_agree_with_the_formula(void **state)
{
    (void)state;
    uint64_t h = 1234;
    for (int i = 0; i < 2000; i++) {
        double field[8], lead[4], scale = 0.25 + 2.0 * made_random(&h);
        for (int k = 0; k < 8; k++) field[k] = 2.0 * made_random(&h) - 1.0;
        for (int k = 0; k < 4; k++) lead[k] = scale * field[4 + k] - field[k];
        double least = 1.0;
        for (int k = 0; k < 6; k++)
            least = fmin(least, fabs(lead[sn_tet_edge[k][0]] - lead[sn_tet_edge[k][1]]));
        if (least < 0.01) continue; /* the formula cancels out */
        assert_true(fabs(share_of(field, 2, 1, scale) - part_above(lead)) < 1e-9);
    }
}

/* Functions that are 1 at one corner each have equal shares; an equal one at the rest of them changes
 * nothing. */
static void shares_with_more_rivals(void **state)
{
    (void)state;
    const double corner[] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    for (int i = 0; i < 4; i++) {
        assert_true(fabs(share_of(corner, 4, i, 1.0) - 1.0 / 4) < 1e-15);
        if (i < 3) assert_true(fabs(share_of(corner, 3, i, 1.0) - 1.0 / 3) < 1e-15);
        if (i < 2) assert_true(fabs(share_of(corner, 2, i, 1.0) - 1.0 / 2) < 1e-15);
    }
    /* Below 1/2 everywhere the four corners stand free: (1/2)^3 each, the rest is the fifth's. */
    double five[20];
    memcpy(five, corner, sizeof corner);
    for (int k = 16; k < 20; k++) five[k] = 0.5;
    for (int i = 0; i < 4; i++) assert_true(fabs(share_of(five, 5, i, 1.0) - 1.0 / 8) < 1e-15);
    assert_true(fabs(share_of(five, 5, 4, 1.0) - 1.0 / 2) < 1e-15);
    assert_true(share_of(five, 5, 4, 2.0) == 1.0 && share_of(five, 5, 4, 0.25) == 0.0); /* 1; 1/8 < 1/4 */
    assert_true(share_of(corner, 1, 0, 1.0) == 1.0);                                    /* alone */
}

/* Equal functions: what the extraction does with a tie, the lower one has it, and nothing is counted twice.
 */
static void ties_go_to_the_lower_tissue(void **state)
{
    (void)state;
    const double same[] = {1, 2, 3, 4, 1, 2, 3, 4, 0, 0, 0, 5, 1, 2, 3, 4}, zero[12] = {0};
    assert_true(fabs(share_of(same, 4, 0, 1.0) - (1.0 - share_of(same, 4, 2, 1.0))) < 1e-15);
    assert_true(share_of(same, 4, 2, 1.0) > 0.0);
    assert_true(share_of(same, 4, 1, 1.0) == 0.0 && share_of(same, 4, 3, 1.0) == 0.0);
    assert_true(share_of(zero, 3, 0, 1.0) == 1.0);
    assert_true(share_of(zero, 3, 1, 1.0) == 0.0 && share_of(zero, 3, 2, 1.0) == 0.0);
    sn_tet_mesh tet = made_unit_tet();
    for (int i = 0; i < 3; i++) {
        sn_measure *m = measure_of(&tet, zero, 3, i);
        sn_vec3 c;
        assert_true(fabs(sn_measure_face_area(m, 0, 3, 1.0, &c) - (i == 0 ? 0.5 : 0.0)) < 1e-15);
        sn_measure_destroy(m);
    }
    sn_tet_mesh_free(&tet);
}

/* Cells of one point and very many others around it: the volume of a polyhedron with 320 faces. */
static void very_many_rivals(void **state)
{
    (void)state;
    enum { n = 321 };
    static double field[4 * n]; /* f_i = 2 c_i . x - |c_i|^2: the nearest site wins; site 0 in the middle */
    sn_tet_mesh tet = made_unit_tet();
    const sn_vec3 middle = {0.25, 0.25, 0.25};
    double whole = 0.0, area = 0.0;
    for (int i = 0; i < n; i++) {
        double z = i ? 1.0 - (2.0 * i - 1.0) / (n - 1) : 0.0, a = 2.399963 * i, r = sqrt(1.0 - z * z);
        sn_vec3 way = sn_v3(r * cos(a), r * sin(a), z), c = sn_v3_mad(middle, i ? 0.2 : 0.0, way);
        for (int k = 0; k < 4; k++)
            field[4 * i + k] = 2.0 * sn_v3_dot(c, sn_tet_mesh_point(&tet, k)) - sn_v3_len2(c);
    }
    for (int i = 0; i < n; i++) {
        sn_measure *m = measure_of(&tet, field, n, i);
        sn_vec3 at;
        double share = sn_measure_tet_share(m, 0, 1.0);
        if (i == 0) { /* nearly a ball of radius 0.1 */
            double ball = 4.0 / 3.0 * TEST_PI * 0.001;
            assert_true(share / 6.0 > ball && share / 6.0 < 1.03 * ball);
        }
        whole += share;
        for (int k = 0; k < 4; k++) area += sn_measure_face_area(m, 0, k, 1.0, &at);
        sn_measure_destroy(m);
    }
    assert_true(fabs(whole - 1.0) < 1e-11);
    assert_true(fabs(area - (1.5 + sqrt(0.75))) < 1e-11);
    sn_tet_mesh_free(&tet);
}

/* On a face: a polygon of 600 corners. */
static void very_many_rivals_on_a_face(void **state)
{
    (void)state;
    enum { n = 601 };
    static double field[4 * n];
    sn_tet_mesh tet = made_unit_tet();
    for (int i = 1; i < n; i++) { /* 0 above r - 1/8 along each direction in the plane z = 0 */
        double a = 2.0 * TEST_PI * i / (n - 1);
        for (int k = 0; k < 4; k++)
            field[4 * i + k] = cos(a) * (tet.pos[3 * k] - 0.3) + sin(a) * (tet.pos[3 * k + 1] - 0.3) - 0.125;
    }
    sn_measure *m = measure_of(&tet, field, n, 0);
    sn_vec3 c = {9, 9, 9};
    double side = 0.25 * tan(TEST_PI / (n - 1)), area = sn_measure_face_area(m, 0, 3, 1.0, &c);
    assert_true(fabs(area - 0.5 * 0.125 * side * (n - 1)) < 1e-12);
    assert_true(sn_v3_dist(c, sn_v3(0.3, 0.3, 0)) < 1e-9);
    sn_measure_destroy(m);
    sn_tet_mesh_free(&tet);
}

/* ---- many tets ---- */

static double *random_field(int32_t n_vert, int32_t n_tissue, uint64_t seed)
{
    double *field = malloc((size_t)n_vert * (size_t)n_tissue * sizeof *field);
    for (size_t k = 0; k < (size_t)n_vert * (size_t)n_tissue; k++) field[k] = made_random(&seed) - 0.3;
    return field;
}

static void volumes_add_up(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(3, sn_v3(0, 0, 0), 0.7);
    shake_mesh(&m, 0.1);
    const int32_t counts[] = {2, 5, 64};
    for (int i = 0; i < 3; i++) {
        double *field = random_field(m.n_vert, counts[i], 55 + (uint64_t)i), sum = 0.0, *share;
        share = calloc((size_t)m.n_tet, sizeof *share);
        for (int32_t t = 0; t < counts[i]; t++) {
            sn_measure *x = measure_of(&m, field, counts[i], t);
            double volume = 0.0;
            for (int32_t k = 0; k < m.n_tet; k++) {
                double s = sn_measure_tet_share(x, k, 1.0);
                assert_true(s >= 0.0 && s <= 1.0 + 1e-14);
                share[k] += s;
                volume += s * sn_tet_mesh_tet_volume(&m, k);
            }
            assert_true(fabs(volume - sn_measure_volume(x, 1.0, NULL)) < 1e-13);
            sum += volume;
            sn_measure_destroy(x);
        }
        assert_true(fabs(sum / sn_tet_mesh_volume(&m) - 1.0) < 1e-12);
        for (int32_t k = 0; k < m.n_tet; k++) assert_true(fabs(share[k] - 1.0) < 1e-12);
        free(share);
        free(field);
    }
    sn_tet_mesh_free(&m);
}

static void a_scale_is_a_scaled_row(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(4, sn_v3(0, 0, 0), 1.0);
    double *field = random_field(m.n_vert, 5, 3), *scaled = random_field(m.n_vert, 5, 3), last = -1.0;
    sn_measure *x = measure_of(&m, field, 5, 2);
    double largest = sn_measure_volume(x, 1e15, NULL);
    const double scale[] = {1e-9, 0.3, 1.0, 1.7, 40.0, 1e12};
    for (int i = 0; i < 6; i++) {
        for (int32_t v = 0; v < m.n_vert; v++) scaled[2 * m.n_vert + v] = scale[i] * field[2 * m.n_vert + v];
        sn_measure *y = measure_of(&m, scaled, 5, 2);
        double volume = sn_measure_volume(x, scale[i], NULL);
        assert_true(fabs(volume - sn_measure_volume(y, 1.0, NULL)) < 1e-12 * largest);
        assert_true(volume <= largest * (1 + 1e-12));
        last = volume;
        sn_measure_destroy(y);
    }
    assert_true(last > largest * (1 - 1e-9)); /* all that is above 0 */
    sn_measure_destroy(x);
    free(field);
    free(scaled);
    sn_tet_mesh_free(&m);
}

static void same_bits_with_any_threads(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(14, sn_v3(0, 0, 0), 1.0); /* five runs of tets, the last one short */
    shake_mesh(&m, 0.1);
    double *field = random_field(m.n_vert, 4, 3);
    sn_measure *x = measure_of(&m, field, 4, 1);
    double one = sn_measure_volume(x, 1.1, &(sn_run){.n_threads = 1});
    for (int n = 2; n < 5; n++) assert_true(sn_measure_volume(x, 1.1, &(sn_run){.n_threads = n}) == one);
    assert_true(one > 100.0);
    sn_measure_destroy(x);
    sn_measure_destroy(NULL);
    free(field);
    sn_tet_mesh_free(&m);
}

/* Smooth functions: waves of different lengths. */
static double *smooth_field(const sn_tet_mesh *m, int32_t n_tissue)
{
    double *field = malloc((size_t)m->n_vert * (size_t)n_tissue * sizeof *field);
    for (int32_t t = 0; t < n_tissue; t++)
        for (int32_t v = 0; v < m->n_vert; v++) {
            const double *p = m->pos + 3 * v;
            field[t * m->n_vert + v] =
                sin(0.7 * p[0] + t) + cos(0.5 * p[1] - 2.0 * t) + sin(0.6 * p[2] + 3.0 * t);
        }
    return field;
}

static double distance_to_extraction(const sn_tet_mesh *m, const double *field, double margin)
{
    const char *const name[] = {"a", "b", "c", "d", "e", "f"};
    sn_extraction x;
    double worst = 0.0;
    sn_extraction_init(&x);
    assert_int_equal(sn_extract(m, field, name, 6, &(sn_extract_options){.margin = margin}, NULL, &x, NULL),
                     SN_OK);
    for (int32_t t = 0; t < 6; t++) {
        sn_measure *measure = measure_of(m, field, 6, t);
        double volume = sn_measure_volume(measure, 1.0, NULL);
        worst = fmax(worst, fabs(volume - sn_extraction_part_volume(&x, t)) / volume);
        assert_true(volume > 1.0);
        sn_measure_destroy(measure);
    }
    sn_extraction_free(&x);
    return worst;
}

/* The extraction keeps its corners apart; with a finer margin it comes nearer. */
static void agrees_with_the_extraction(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(8, sn_v3(0, 0, 0), 1.0);
    shake_mesh(&m, 0.1);
    double *field = smooth_field(&m, 6);
    double coarse = distance_to_extraction(&m, field, 1e-2), usual = distance_to_extraction(&m, field, 1e-3),
           fine = distance_to_extraction(&m, field, 1e-4);
    assert_true(usual < 1e-3 && usual < coarse && fine <= usual && fine < 1e-4);
    free(field);
    sn_tet_mesh_free(&m);
}

/* ---- faces ---- */

static void faces_by_hand(void **state)
{
    (void)state;
    sn_tet_mesh tet = made_unit_tet();
    /* Face 3 is the triangle (0, 0, 0), (1, 0, 0), (0, 1, 0) of area 1/2. */
    const struct {
        double lead[4], area;
        sn_vec3 centroid;
    } cases[] = {
        {{1, 1, 1, 1}, 0.5, {1.0 / 3, 1.0 / 3, 0}},
        {{1, 1, 1, -9}, 0.5, {1.0 / 3, 1.0 / 3, 0}}, /* corner 3 is not on it */
        {{1, -1, -1, 5}, 0.125, {1.0 / 6, 1.0 / 6, 0}},
        {{-1, 1, -1, -1}, 0.125, {2.0 / 3, 1.0 / 6, 0}},
        {{-1, 1, 1, -1}, 0.375, {7.0 / 18, 7.0 / 18, 0}}, /* the whole less a corner: (4/3 - 1/6) / 3 */
        {{0, 1, -1, 7}, 0.25, {0.5, 1.0 / 6, 0}},         /* through corner 0 */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double field[8] = {0, 0, 0, 0};
        memcpy(field + 4, cases[i].lead, sizeof cases[i].lead);
        sn_measure *m = measure_of(&tet, field, 2, 1);
        sn_vec3 c;
        assert_true(fabs(sn_measure_face_area(m, 0, 3, 1.0, &c) - cases[i].area) < 1e-15);
        assert_true(sn_v3_dist(c, cases[i].centroid) < 1e-15);
        sn_measure_destroy(m);
    }
    const double lost[] = {1, 1, 1, 1, 0, 0, 0, 9};
    sn_measure *m = measure_of(&tet, lost, 2, 1);
    sn_vec3 c = {7, 7, 7};
    assert_true(sn_measure_face_area(m, 0, 3, 1.0, &c) == 0.0);
    assert_true(sn_measure_face_area(m, 0, 3, 2.0, &c) == 0.0 && c.x == 7.0); /* untouched */
    sn_measure_destroy(m);
    sn_tet_mesh_free(&tet);
}

static void areas_add_up(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(4, sn_v3(0, 0, 0), 1.0);
    shake_mesh(&m, 0.1);
    int32_t *across = NULL;
    double *field = random_field(m.n_vert, 7, 9), sum = 0.0;
    assert_int_equal(sn_tet_mesh_adjacency(&m, &across, NULL), SN_OK);
    sn_tri_mesh surface;
    sn_tri_mesh_init(&surface);
    assert_int_equal(sn_tet_mesh_surface(&m, -1, &surface, NULL, NULL), SN_OK);
    double whole = 0.0;
    for (int32_t f = 0; f < surface.n_face; f++) {
        sn_vec3 a = sn_v3_load(surface.pos + 3 * surface.face[3 * f]);
        sn_vec3 b = sn_v3_load(surface.pos + 3 * surface.face[3 * f + 1]),
                c = sn_v3_load(surface.pos + 3 * surface.face[3 * f + 2]);
        whole += 0.5 * sn_v3_len(sn_v3_cross(sn_v3_sub(b, a), sn_v3_sub(c, a)));
    }
    for (int32_t i = 0; i < 7; i++) {
        sn_measure *x = measure_of(&m, field, 7, i);
        for (int32_t h = 0; h < 4 * m.n_tet; h++) {
            sn_vec3 c, d;
            double area = sn_measure_face_area(x, h / 4, h % 4, 1.2, &c);
            if (across[h] < 0) {
                sum += sn_measure_face_area(x, h / 4, h % 4, 1.0, &c);
                continue;
            }
            int k = 0; /* the same from the other side */
            while (across[4 * across[h] + k] != h / 4) k++;
            assert_true(fabs(area - sn_measure_face_area(x, across[h], k, 1.2, &d)) < 1e-13);
            if (area > 1e-3) assert_true(sn_v3_dist(c, d) < 1e-10);
        }
        sn_measure_destroy(x);
    }
    assert_true(fabs(sum / whole - 1.0) < 1e-12);
    sn_tri_mesh_free(&surface);
    sn_release(across);
    free(field);
    sn_tet_mesh_free(&m);
}

/* ---- the scale for a volume ---- */

static void scales_hit_their_volume(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(7, sn_v3(0, 0, 0), 1.0);
    shake_mesh(&m, 0.1);
    double *field = smooth_field(&m, 4);
    for (int32_t v = 0; v < m.n_vert; v++) field[v] = 0.2;
    for (int32_t t = 1; t < 4; t++) {
        sn_measure *x = measure_of(&m, field, 4, t);
        double largest = sn_measure_volume(x, 1e15, NULL), scale = -1.0;
        const double share[] = {1e-4, 0.01, 0.2, 0.5, 0.9, 0.99};
        for (int i = 0; i < 6; i++) {
            assert_int_equal(sn_measure_find_scale(x, share[i] * largest, NULL, &scale, NULL), SN_OK);
            assert_true(scale > 0.0);
            assert_true(fabs(sn_measure_volume(x, scale, NULL) / (share[i] * largest) - 1.0) <= 1e-7);
        }
        double now = sn_measure_volume(x, 1.0, NULL);
        assert_int_equal(sn_measure_find_scale(x, now, NULL, &scale, NULL), SN_OK);
        assert_true(scale == 1.0); /* nothing to do */
        sn_measure_destroy(x);
    }
    free(field);
    sn_tet_mesh_free(&m);
}

static void impossible_volumes(void **state)
{
    (void)state;
    sn_tet_mesh tet = made_unit_tet();
    const double crowded[] = {1, 1, 1, 1, 2, -2, -2, -2}, least[] = {-1, -1, -1, -1, 1, -1, -1, -1};
    double scale = 42.0;
    sn_error err;
    sn_measure *m = measure_of(&tet, crowded, 2, 1); /* above 0 in (1/2)^3 of 1/6 */
    assert_true(fabs(sn_measure_volume(m, 1e15, NULL) - 1.0 / 48) < 1e-15);
    assert_int_equal(sn_measure_find_scale(m, 0.1, NULL, &scale, &err), SN_EINVAL);
    assert_string_equal(err.msg,
                        "no tissue value gives a volume of 0.1: crowded by its neighbours and the skin "
                        "it can reach at most 0.0208333 here");
    assert_int_equal(sn_measure_find_scale(m, 0.02, NULL, &scale, NULL), SN_OK);
    assert_true(fabs(sn_measure_volume(m, scale, NULL) - 0.02) < 1e-8);
    sn_measure_destroy(m);
    scale = 42.0;
    m = measure_of(&tet, least, 2, 1); /* where the other is negative, 0 wins */
    assert_int_equal(sn_measure_find_scale(m, 0.01, NULL, &scale, &err), SN_EINVAL);
    assert_non_null(strstr(err.msg, "no tissue value gives a volume of 0.01: it keeps at least 0.16"));
    assert_true(scale == 42.0);
    sn_measure_destroy(m);
    volatile sig_atomic_t cancel = 1;
    m = measure_of(&tet, crowded, 2, 1);
    assert_int_equal(sn_measure_find_scale(m, 0.02, &(sn_run){.cancel = &cancel}, &scale, &err), SN_ECANCEL);
    assert_true(scale == 42.0);
    sn_measure_destroy(m);
    for (int n = 0; n < 3; n++) {
        ration r = {n, 0};
        sn_set_allocator(RATION(r));
        assert_int_equal(sn_measure_create(&m, &tet, crowded, 2, 1, NULL, &err), SN_ENOMEM);
        sn_set_allocator(NULL);
        assert_null(m);
        assert_non_null(strstr(err.msg, "no memory"));
        assert_int_equal(r.in_use, 0);
    }
    sn_tet_mesh_free(&tet);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shares_with_one_rival),
        cmocka_unit_test(shares_agree_with_the_formula),
        cmocka_unit_test(shares_with_more_rivals),
        cmocka_unit_test(ties_go_to_the_lower_tissue),
        cmocka_unit_test(very_many_rivals),
        cmocka_unit_test(very_many_rivals_on_a_face),
        cmocka_unit_test(volumes_add_up),
        cmocka_unit_test(a_scale_is_a_scaled_row),
        cmocka_unit_test(same_bits_with_any_threads),
        cmocka_unit_test(agrees_with_the_extraction),
        cmocka_unit_test(faces_by_hand),
        cmocka_unit_test(areas_add_up),
        cmocka_unit_test(scales_hit_their_volume),
        cmocka_unit_test(impossible_volumes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
