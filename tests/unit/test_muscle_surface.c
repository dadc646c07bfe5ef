/* test_muscle_surface - surfaces of muscles as triangles: where they are, closed, shared, the same for any
 * number of threads. */
#include "made_body.h"
#include "render/muscle_surface.h"

static double ball(int32_t i, sn_vec3 p) /* |p| < 0.7 */
{
    return i == 0 ? 0.0 : 0.49 - sn_v3_len2(p);
}
static double two_sides(int32_t i,
                        sn_vec3 p) /* muscle 1 at x < 0, 2 at x > 0, both below z = 0.3 + |x| / 2 */
{
    return i == 0 ? 0.0 : 0.3 - p.z + (i == 1 ? -0.5 : 0.5) * p.x;
}
static double three_lobes(int32_t i, sn_vec3 p) /* three cones side by side: they meet inside tets */
{
    static const double x[3] = {-0.3, 0.31, 0.02}, y[3] = {-0.17, -0.2, 0.33};
    if (i == 0) return 0.0;
    return 0.45 - sqrt((p.x - x[i - 1]) * (p.x - x[i - 1]) + (p.y - y[i - 1]) * (p.y - y[i - 1]) + p.z * p.z);
}
static double twins(int32_t i, sn_vec3 p) /* two muscles with one field, up to the border */
{
    return i == 0 ? 0.0 : 0.3 - p.z;
}
static double only_fat(int32_t i, sn_vec3 p)
{
    return i == 0 ? 1.0 : 0.1 * p.x;
}

static sn_muscle_surface make(const body *b, int n_threads)
{
    sn_error err;
    sn_run run = {.n_threads = n_threads};
    sn_muscle_tets t;
    sn_muscle_border border = {0};
    sn_muscle_surface s = {0};
    sn_muscle_tets_init(&t);
    ok(find_tets(&t, &b->scene, &run, &err), &err);
    ok(sn_muscle_border_find(&border, &b->mesh, &run, &err), &err);
    ok(sn_muscle_surface_make(&s, &b->scene, &t, &border, sn_v3(0, 0, 0), &run, &err), &err);
    sn_muscle_border_free(&border);
    sn_muscle_tets_free(&t);
    return s;
}

static sn_vec3 place(const sn_muscle_surface *s, size_t i_corner)
{
    const float *p = s->vert[s->index[i_corner]].place;
    return sn_v3((double)p[0], (double)p[1], (double)p[2]);
}

/* Six times the volume inside, twice the area, twice the sum of the area vectors, of one muscle or all (< 0).
 */
static void sums(const sn_muscle_surface *s, int32_t muscle, double *volume, double *area, sn_vec3 *vector)
{
    *volume = *area = 0.0;
    *vector = sn_v3(0, 0, 0);
    for (size_t i = 0; i < s->n_index; i += 3) {
        sn_vec3 a = place(s, i), b = place(s, i + 1), c = place(s, i + 2);
        sn_vec3 n = sn_v3_cross(sn_v3_sub(b, a), sn_v3_sub(c, a));
        if (muscle >= 0 && s->vert[s->index[i]].kind != 512 + muscle) continue;
        *volume += sn_v3_det(a, b, c);
        *area += sn_v3_len(n);
        *vector = sn_v3_add(*vector, n);
    }
}

/* A field of planes: areas and volumes are those of the solid it stands for, exactly. */
static void test_planes_are_exact(void **state)
{
    (void)state;
    body b;
    double volume, area;
    sn_vec3 vector;
    body_make(&b, 5, 3, two_sides);
    sn_muscle_surface s = make(&b, 2);
    sums(&s, -1, &volume, &area, &vector);
    /* Below: 4; sides at y = +-1: 2 (2 (1.3) + 0.5); at x = +-1: 2 (2 (1.8)); above: 4 sqrt(1.25) */
    assert_near(area / 2.0, 4.0 + 2.0 * (2.6 + 0.5) + 4.0 * 1.8 + 4.0 * sqrt(1.25), 1e-5);
    assert_near(volume / 6.0, 4.0 * 1.3 + 1.0, 1e-5);
    assert_near(sn_v3_len(vector), 0.0, 1e-5);
    for (int i = 0; i < 2; i++) { /* each its own half; open where they meet */
        sums(&s, i, &volume, &area, &vector);
        assert_near(area / 2.0, 0.5 * (4.0 + 2.0 * 3.1 + 4.0 * 1.8 + 4.0 * sqrt(1.25)), 1e-5);
    }
    assert_null(s.tendon);
    sn_muscle_surface_free(&s);
    assert_null(s.vert);
    body_free(&b);
}

static int by_edge(const void *a, const void *b)
{
    return memcmp(a, b, 2 * sizeof(uint32_t));
}

/* Every edge belongs to two triangles, which run along it in opposite ways: watertight, and shared. */
static void test_ball_is_closed_and_shared(void **state)
{
    (void)state;
    body b;
    body_make(&b, 14, 2, ball);
    sn_muscle_surface s = make(&b, 2);
    uint32_t(*edge)[2] = malloc(2 * s.n_index * sizeof *edge);
    for (size_t i = 0; i < s.n_index; i++) {
        uint32_t from = s.index[i], to = s.index[i - i % 3 + (i + 1) % 3];
        assert_true(from < s.n_vert && to < s.n_vert);
        edge[i][0] = from;
        edge[i][1] = to;
        edge[s.n_index + i][0] = to;
        edge[s.n_index + i][1] = from;
    }
    qsort(edge, 2 * s.n_index, sizeof *edge, by_edge);
    for (size_t i = 0; i < 2 * s.n_index; i += 2) {
        assert_memory_equal(edge[i], edge[i + 1], sizeof *edge);
        if (i > 0) assert_memory_not_equal(edge[i - 1], edge[i], sizeof *edge);
    }
    free(edge);
    assert_int_equal(s.n_vert, s.n_index / 6 + 2); /* Euler: one sphere */
    double volume, area;
    sn_vec3 vector;
    sums(&s, -1, &volume, &area, &vector);
    assert_near(volume / 6.0, 4.0 / 3.0 * PI * 0.343, 0.04 * 1.44);
    for (size_t i = 0; i < s.n_vert; i++) { /* normals point out */
        const sn_surface_vertex *v = &s.vert[i];
        double dot = 0.0;
        for (int k = 0; k < 3; k++) dot += v->normal[k] / 32767.0 * (double)v->place[k] / 0.7;
        assert_near(dot, 1.0, 0.05);
    }
    sn_muscle_surface_free(&s);
    body_free(&b);
}

/* The value of g of each muscle at a point of the cube, interpolated in the tet that holds it. */
static void values_at(const body *b, sn_vec3 p, double *g)
{
    for (int32_t t = 0; t < b->mesh.n_tet; t++) {
        const int32_t *v = b->mesh.tet + 4 * t;
        sn_vec3 c[4];
        double w[4], sum = 0.0, least = 1.0;
        for (int k = 0; k < 4; k++) c[k] = sn_v3_sub(sn_tet_mesh_point(&b->mesh, v[k]), p);
        for (int k = 0; k < 4; k++) {
            const int *f = sn_tet_face[k];
            w[k] = -sn_v3_det(c[f[0]], c[f[1]], c[f[2]]);
            sum += w[k];
        }
        for (int k = 0; k < 4; k++) least = fmin(least, w[k] / sum);
        if (fabs(sum) < 1e-12 || least < -1e-5) continue;
        for (int32_t i = 1; i < b->n_tissue; i++) {
            g[i - 1] = 0.0;
            for (int k = 0; k < 4; k++) g[i - 1] += w[k] / sum * sn_muscle_above_fat(&b->scene, i - 1, v[k]);
        }
        return;
    }
    fail_msg("(%g, %g, %g) is in no tet", p.x, p.y, p.z);
}

/* The middles of triangles lie where their muscle's g is 0 and no other is above it; the whole is closed. */
static void test_muscles_that_meet(void **state)
{
    (void)state;
    body b;
    double volume, area, g[3];
    sn_vec3 vector;
    body_make(&b, 6, 4, three_lobes);
    sn_muscle_surface s = make(&b, 2);
    sums(&s, -1, &volume, &area, &vector);
    assert_near(sn_v3_len(vector), 0.0, 1e-5);
    int seen[3] = {0};
    for (size_t i = 0; i < s.n_index; i += 3) {
        sn_vec3 mid =
            sn_v3_scale(1.0 / 3.0, sn_v3_add(place(&s, i), sn_v3_add(place(&s, i + 1), place(&s, i + 2))));
        int own = s.vert[s.index[i]].kind - 512;
        for (int k = 1; k < 3; k++) assert_int_equal(s.vert[s.index[i + (size_t)k]].kind, 512 + own);
        values_at(&b, mid, g);
        for (int k = 0; k < 3; k++) assert_true(g[k] < 1e-5);
        assert_near(g[own], 0.0, 1e-5);
        seen[own]++;
    }
    for (int k = 0; k < 3; k++) assert_true(seen[k] > 50);
    sn_muscle_surface_free(&s);
    body_free(&b);
}

static void test_of_equal_muscles_the_first_is_seen(void **state)
{
    (void)state;
    body b;
    double volume, area;
    sn_vec3 vector;
    body_make(&b, 3, 3, twins);
    sn_muscle_surface s = make(&b, 1);
    for (size_t i = 0; i < s.n_vert; i++) assert_int_equal(s.vert[i].kind, 512);
    sums(&s, -1, &volume, &area, &vector);
    assert_near(volume / 6.0, 4.0 * 1.3, 1e-5);
    sn_muscle_surface_free(&s);
    body_free(&b);
    body_make(&b, 3, 2, only_fat);
    s = make(&b, 1);
    assert_int_equal(s.n_vert, 0);
    assert_int_equal(s.n_index, 0);
    sn_muscle_surface_free(&s);
    body_free(&b);
}

static void test_tendon_is_linear(void **state)
{
    (void)state;
    body b;
    body_make(&b, 6, 2, ball);
    float *value = malloc(sizeof *value * (size_t)b.mesh.n_vert);
    const float *list[1] = {value};
    for (int32_t v = 0; v < b.mesh.n_vert; v++)
        value[v] = (float)(0.3 + 2.0 * sn_tet_mesh_point(&b.mesh, v).y);
    b.scene.tendon = list;
    sn_muscle_surface s = make(&b, 2);
    assert_non_null(s.tendon);
    for (size_t i = 0; i < s.n_vert; i++)
        assert_near((double)s.tendon[i], 0.3 + 2.0 * (double)s.vert[i].place[1], 1e-5);
    sn_muscle_surface_free(&s);
    free(value);
    body_free(&b);
}

static void test_same_for_any_threads(void **state)
{
    (void)state;
    body b;
    body_make(&b, 16, 4, three_lobes);
    sn_muscle_surface one = make(&b, 1), many = make(&b, 3);
    assert_int_equal(one.n_vert, many.n_vert);
    assert_int_equal(one.n_index, many.n_index);
    assert_memory_equal(one.vert, many.vert, one.n_vert * sizeof *one.vert);
    assert_memory_equal(one.index, many.index, one.n_index * sizeof *one.index);
    sn_muscle_surface_free(&one);
    sn_muscle_surface_free(&many);
    body_free(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_planes_are_exact),  cmocka_unit_test(test_ball_is_closed_and_shared),
        cmocka_unit_test(test_muscles_that_meet), cmocka_unit_test(test_of_equal_muscles_the_first_is_seen),
        cmocka_unit_test(test_tendon_is_linear),  cmocka_unit_test(test_same_for_any_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
