/* test_field - Laplacian, sparse Cholesky, tissue functions, segmentation: exact cases, convergence, dense
 * reference. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "field/cholesky.h"
#include "field/laplacian.h"
#include "field/segmentation.h"
#include "field/tissue.h"

#include "made_mesh.h"

#include <stdio.h>

static sn_csr laplacian_of(const sn_tet_mesh *m)
{
    sn_csr a = {0};
    sn_assembly s = {0};
    assert_int_equal(sn_laplacian_build(&a, &s, m, 0.0, NULL, NULL), SN_OK);
    sn_assembly_free(&s);
    assert_int_equal(a.n, m->n_vert);
    return a;
}

/* ---- Laplacian ---- */

static void laplacian_of_one_tet(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(1, sn_v3(0, 0, 0), 2.0);
    m.n_tet =
        1; /* corners 0, 4, 6, 7: along x, y, z. b0 = 1 - x/2, b1 = (x - y)/2, b2 = (y - z)/2, b3 = z/2 */
    sn_csr a = laplacian_of(&m);
    /* Volume 8/6; grad b0 = (-1/2, 0, 0), grad b1 = (1/2, -1/2, 0): L00 = 8/6/4 / d, L11 = 8/6/2 / d, d =
     * sqrt(12). */
    double d = sqrt(12.0), unit = 8.0 / 6.0 / 4.0 / d;
    const int32_t v[4] = {m.tet[0], m.tet[1], m.tet[2], m.tet[3]};
    const double want[4][4] = {{1, -1, 0, 0}, {-1, 2, -1, 0}, {0, -1, 2, -1}, {0, 0, -1, 1}};
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) {
            int64_t at = sn_csr_find(&a, v[i], v[k]);
            assert_true(at >= 0 && fabs(a.val[at] - want[i][k] * unit) < 1e-15);
        }
    assert_int_equal(a.ptr[a.n], 16);
    assert_int_equal(sn_csr_find(&a, v[0], 1), -1);
    assert_int_equal(sn_csr_find(&a, 1, 1), -1); /* a vertex without tets has an empty row */
    sn_csr_free(&a);
    sn_csr_free(&a);
    sn_tet_mesh_free(&m);
}

static void laplacian_is_what_it_should_be(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(5, sn_v3(-1, 2, 3), 0.7);
    shake_mesh(&m, 0.1);
    sn_csr a = laplacian_of(&m);
    double largest = 0.0;
    for (int64_t k = 0; k < a.ptr[a.n]; k++) largest = fmax(largest, fabs(a.val[k]));
    for (int32_t i = 0; i < a.n; i++) {
        double sum = 0.0, product = 0.0;
        for (int64_t k = a.ptr[i]; k < a.ptr[i + 1]; k++) {
            sum += a.val[k];
            product += a.val[k] * sn_v3_dot(sn_tet_mesh_point(&m, a.idx[k]), sn_v3(1, -2, 3));
            if (k > a.ptr[i]) assert_true(a.idx[k] > a.idx[k - 1]);
            int64_t back = sn_csr_find(&a, a.idx[k], i);
            assert_true(back >= 0 && fabs(a.val[back] - a.val[k]) < 1e-14 * largest);
        }
        assert_true(fabs(sum) < 1e-13 * largest);
        const double *p = m.pos + 3 * i; /* linear functions are harmonic inside */
        bool inner = p[0] > -0.7 && p[0] < 2.2 && p[1] > 2.3 && p[1] < 5.2 && p[2] > 3.3 && p[2] < 6.2;
        if (inner) assert_true(fabs(product) < 1e-12 * largest);
    }
    /* f' L f = integral of |grad f|^2 over the size cubed per unit of size: |g|^2 volume / size. */
    double energy = 0.0;
    for (int32_t i = 0; i < a.n; i++)
        for (int64_t k = a.ptr[i]; k < a.ptr[i + 1]; k++)
            energy += a.val[k] * sn_v3_dot(sn_tet_mesh_point(&m, i), sn_v3(1, -2, 3)) *
                      sn_v3_dot(sn_tet_mesh_point(&m, a.idx[k]), sn_v3(1, -2, 3));
    double want = 14.0 * sn_tet_mesh_volume(&m) / sn_box3_diagonal(sn_tet_mesh_bounds(&m));
    assert_true(fabs(energy / want - 1.0) < 1e-10);
    sn_csr_free(&a);
    sn_tet_mesh_free(&m);
}

static void gradients_of_barycentric_functions(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(3, sn_v3(0, 0, 0), 1.0);
    shake_mesh(&m, 0.1);
    for (int32_t t = 0; t < m.n_tet; t++) {
        sn_vec3 g[4];
        assert_true(fabs(sn_tet_gradients(&m, t, g) - sn_tet_mesh_tet_volume(&m, t)) < 1e-15);
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < 4; k++) { /* b_i is 1 at corner i and 0 at the others */
                sn_vec3 e = sn_v3_sub(sn_tet_mesh_point(&m, m.tet[4 * t + k]),
                                      sn_tet_mesh_point(&m, m.tet[4 * t + (k + 1) % 4]));
                assert_true(fabs(sn_v3_dot(g[i], e) - ((k == i) - ((k + 1) % 4 == i))) < 1e-12);
            }
    }
    sn_tet_mesh_free(&m);
}

static void the_assembly_knows_every_place(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(4, sn_v3(0, 0, 0), 1.0);
    sn_csr a = {0}, other = {0};
    sn_assembly s = {0};
    assert_int_equal(sn_laplacian_build(&a, &s, &m, 0.0, &(sn_run){.n_threads = 1}, NULL), SN_OK);
    for (int32_t t = 0; t < m.n_tet; t++)
        for (int k = 0; k < 16; k++) {
            int32_t row = m.tet[4 * t + k / 4];
            assert_int_equal(a.ptr[row] + s.slot[16 * t + k], sn_csr_find(&a, row, m.tet[4 * t + k % 4]));
        }
    for (int n = 2; n < 4; n++) { /* over what is there, and with other threads */
        assert_int_equal(sn_laplacian_build(&other, &s, &m, 0.0, &(sn_run){.n_threads = n}, NULL), SN_OK);
        assert_memory_equal(other.ptr, a.ptr, ((size_t)a.n + 1) * sizeof *a.ptr);
        assert_memory_equal(other.idx, a.idx, (size_t)a.ptr[a.n] * sizeof *a.idx);
        assert_memory_equal(other.val, a.val, (size_t)a.ptr[a.n] * sizeof *a.val);
    }
    sn_csr_free(&a);
    sn_csr_free(&other);
    sn_assembly_free(&s);
    sn_assembly_free(&s);
    sn_tet_mesh_free(&m);
}

/* A part of the domain: each tet counts by its share, so weights of 1 and shares that add up give L again. */
static void tets_count_by_their_weight(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(4, sn_v3(0, 0, 0), 1.0);
    shake_mesh(&m, 0.1);
    sn_csr all = {0}, part = {0};
    sn_assembly s = {0};
    double *weight = calloc((size_t)m.n_tet, sizeof *weight), largest = 0.0, *sum;
    assert_int_equal(sn_laplacian_build(&all, &s, &m, 0.0, NULL, NULL), SN_OK);
    assert_int_equal(sn_laplacian_build(&part, &s, &m, 0.0, NULL, NULL), SN_OK);
    size_t n = (size_t)all.ptr[all.n];
    sum = calloc(n, sizeof *sum);
    for (int round = 0; round < 2; round++) {
        uint64_t h = 5;
        for (int32_t t = 0; t < m.n_tet; t++) weight[t] = round + (round ? -1.0 : 1.0) * made_random(&h);
        sn_laplacian_set_weighted(&part, &s, &m, weight);
        for (size_t k = 0; k < n; k++) sum[k] += part.val[k];
    }
    for (size_t k = 0; k < n; k++) largest = fmax(largest, fabs(all.val[k]));
    for (size_t k = 0; k < n; k++) assert_true(fabs(sum[k] - all.val[k]) < 1e-14 * largest);
    memset(weight, 0, (size_t)m.n_tet * sizeof *weight);
    weight[7] = 0.5; /* one half of one tet: nothing but its own 16 entries */
    sn_laplacian_set_weighted(&part, &s, &m, weight);
    sn_vec3 g[4];
    double unit = 0.5 * sn_tet_gradients(&m, 7, g) / sn_box3_diagonal(sn_tet_mesh_bounds(&m)), rest = 0.0;
    for (size_t k = 0; k < n; k++) rest += fabs(part.val[k]);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) {
            double value = part.val[sn_csr_find(&part, m.tet[28 + i], m.tet[28 + k])];
            assert_true(fabs(value - unit * sn_v3_dot(g[i], g[k])) < 1e-15);
            rest -= fabs(value);
        }
    assert_true(fabs(rest) < 1e-14);
    free(weight);
    free(sum);
    sn_csr_free(&all);
    sn_csr_free(&part);
    sn_assembly_free(&s);
    sn_tet_mesh_free(&m);
}

/* n tets around the axis from vertex 0 to vertex 1. */
static sn_tet_mesh fan_of(int32_t n)
{
    sn_tet_mesh m;
    sn_tet_mesh_init(&m);
    assert_int_equal(sn_tet_mesh_reserve(&m, n + 2, n, false, NULL), SN_OK);
    sn_v3_store(m.pos, sn_v3(0, 0, 0));
    sn_v3_store(m.pos + 3, sn_v3(0, 0, 1));
    for (int32_t i = 0; i < n; i++) {
        sn_v3_store(m.pos + 3 * (i + 2), sn_v3(cos(2 * TEST_PI * i / n), sin(2 * TEST_PI * i / n), 0));
        const int32_t tet[4] = {0, 2 + i, 2 + (i + 1) % n, 1};
        memcpy(m.tet + 4 * i, tet, sizeof tet);
    }
    return m;
}

static void a_vertex_with_very_many_neighbours(void **state)
{
    (void)state;
    const int32_t n[2] = {4094, 4095}; /* and the other end of the axis, and itself */
    sn_csr a = {0};
    sn_assembly s = {0};
    sn_error err;
    for (int i = 0; i < 2; i++) {
        sn_tet_mesh m = fan_of(n[i]);
        sn_status st = sn_laplacian_build(&a, &s, &m, 0.0, NULL, &err);
        assert_int_equal(st, i ? SN_EINVAL : SN_OK);
        if (!st) assert_int_equal(a.ptr[1], 4096);
        if (!st) assert_true(a.val[sn_csr_find(&a, 0, 1)] < 0.0);
        if (st) assert_string_equal(err.msg, "laplacian: a vertex has more than 4096 neighbours");
        if (st) assert_true(!a.ptr && !a.val && !s.slot);
        sn_tet_mesh_free(&m);
    }
}

/* ---- Cholesky ---- */

static void small_matrix(void **state)
{
    (void)state;
    /* Rows 0 and 2 of a 3 x 3 matrix, numbered the other way round: [4 2; 2 3] for (row 2, row 0) = [3 2; 2
     * 4]. */
    int64_t ptr[] = {0, 3, 6, 9};
    int32_t idx[] = {0, 1, 2, 0, 1, 2, 0, 1, 2}, number[] = {1, -1, 0};
    double val[] = {4, 9, 2, 9, 9, 9, 2, 9, 3};
    sn_csr a = {ptr, idx, val, 3};
    sn_cholesky *c = NULL;
    sn_error err;
    assert_int_equal(sn_cholesky_create(&c, &a, number, 0, NULL, &err), SN_EINVAL);
    assert_string_equal(err.msg, "cholesky: the matrix has no rows");
    assert_null(c);
    assert_int_equal(sn_cholesky_create(&c, &a, number, 2, NULL, NULL), SN_OK);
    assert_int_equal(sn_cholesky_factorize(c, &a, NULL, NULL), SN_OK);
    assert_true(sn_cholesky_factor_entries(c) >= 3);
    double x[] = {3 * 5 + 2 * 7, 2 * 5 + 4 * 7, 3, 2}; /* x = (5, 7) and (1, 0) */
    assert_int_equal(sn_cholesky_solve(c, x, 2, NULL, NULL), SN_OK);
    const double want[] = {5, 7, 1, 0};
    for (int i = 0; i < 4; i++) assert_true(fabs(x[i] - want[i]) < 1e-14);
    val[0] = 1.0; /* [3 2; 2 1]: not positive definite */
    assert_int_equal(sn_cholesky_factorize(c, &a, NULL, &err), SN_ESOLVE);
    assert_memory_equal(err.msg, "the matrix is not positive definite (column ", 44);
    assert_non_null(strstr(err.msg, " of 2)"));
    val[0] = 4.0; /* and a good one again */
    assert_int_equal(sn_cholesky_factorize(c, &a, NULL, NULL), SN_OK);
    double y[] = {29, 38};
    assert_int_equal(sn_cholesky_solve(c, y, 1, NULL, NULL), SN_OK);
    assert_true(fabs(y[0] - 5) < 1e-14 && fabs(y[1] - 7) < 1e-14);
    sn_cholesky_destroy(c);
    sn_cholesky_destroy(NULL);
}

/* L x = 0 on vertices not fixed, x given on the others. */
static void solve_dirichlet(const sn_tet_mesh *m, const bool *fixed, double *x)
{
    sn_csr a = laplacian_of(m);
    int32_t *number = malloc((size_t)m->n_vert * sizeof *number), n = 0;
    for (int32_t v = 0; v < m->n_vert; v++) number[v] = fixed[v] ? -1 : n++;
    double *b = calloc((size_t)n, sizeof *b);
    for (int32_t v = 0; v < m->n_vert; v++)
        for (int64_t k = a.ptr[v]; k < a.ptr[v + 1] && !fixed[v]; k++)
            if (fixed[a.idx[k]]) b[number[v]] -= a.val[k] * x[a.idx[k]];
    sn_cholesky *c = NULL;
    assert_int_equal(sn_cholesky_create(&c, &a, number, n, NULL, NULL), SN_OK);
    assert_int_equal(sn_cholesky_factorize(c, &a, NULL, NULL), SN_OK);
    assert_int_equal(sn_cholesky_solve(c, b, 1, NULL, NULL), SN_OK);
    for (int32_t v = 0; v < m->n_vert; v++)
        if (!fixed[v]) x[v] = b[number[v]];
    sn_cholesky_destroy(c);
    sn_csr_free(&a);
    free(number);
    free(b);
}

static void linear_functions_are_exact(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(6, sn_v3(0, 0, 0), 1.0);
    bool *fixed = calloc((size_t)m.n_vert, sizeof *fixed);
    double *x = calloc((size_t)m.n_vert, sizeof *x);
    for (int32_t v = 0; v < m.n_vert; v++) {
        const double *p = m.pos + 3 * v;
        for (int k = 0; k < 3; k++) fixed[v] = fixed[v] || p[k] == 0.0 || p[k] == 6.0;
    }
    shake_mesh(&m, 0.12);
    for (int32_t v = 0; v < m.n_vert; v++)
        if (fixed[v]) x[v] = 3.0 + sn_v3_dot(sn_tet_mesh_point(&m, v), sn_v3(2, -1, 0.5));
    solve_dirichlet(&m, fixed, x);
    for (int32_t v = 0; v < m.n_vert; v++)
        assert_true(fabs(x[v] - 3.0 - sn_v3_dot(sn_tet_mesh_point(&m, v), sn_v3(2, -1, 0.5))) < 1e-12);
    free(fixed);
    free(x);
    sn_tet_mesh_free(&m);
}

/* The shell between the spheres of radius 1/2 and 1: a cube without its middle, cubes around the origin made
 * spheres. Root mean square of the error of the field that is 1 inside and 0 outside: 1/r - 1. */
static double shell_error(int n)
{
    sn_tet_mesh m = made_lattice(n, sn_v3(-1, -1, -1), 2.0 / n);
    int32_t kept = 0;
    for (int32_t cube = 0; cube < n * n * n; cube++) {
        int at[3] = {cube / (n * n), cube / n % n, cube % n}, inside = 0;
        for (int k = 0; k < 3; k++) inside += at[k] >= n / 4 && at[k] < n - n / 4;
        if (inside == 3) continue;
        memmove(m.tet + 4 * kept, m.tet + 24 * cube, 24 * sizeof *m.tet);
        kept += 6;
    }
    m.n_tet = kept;
    bool *fixed = calloc((size_t)m.n_vert, sizeof *fixed);
    double *x = calloc((size_t)m.n_vert, sizeof *x), sum = 0.0;
    int n_free = 0;
    for (int32_t v = 0; v < m.n_vert; v++) {
        double *p = m.pos + 3 * v, most = fmax(fabs(p[0]), fmax(fabs(p[1]), fabs(p[2])));
        sn_vec3 q = sn_v3_load(p);
        sn_v3_store(p, sn_v3_scale(most, sn_v3_unit(q)));
        fixed[v] = most < 0.5 + 1e-9 || most > 1.0 - 1e-9;
        x[v] = most < 0.75;
    }
    assert_int_equal(sn_tet_mesh_validate(&m, NULL), SN_OK);
    solve_dirichlet(&m, fixed, x);
    for (int32_t v = 0; v < m.n_vert; v++)
        if (!fixed[v]) {
            sum += pow(x[v] - (1.0 / sn_v3_len(sn_tet_mesh_point(&m, v)) - 1.0), 2.0);
            n_free++;
        }
    free(fixed);
    free(x);
    sn_tet_mesh_free(&m);
    return sqrt(sum / n_free);
}

static void field_between_spheres_converges(void **state)
{
    (void)state;
    double coarse = shell_error(8), fine = shell_error(16);
    assert_true(coarse < 0.01 && fine < 0.0025);
    assert_true(coarse / fine > 3.0 && coarse / fine < 6.0); /* second order: 4 */
}

/* ---- tissue functions ---- */

typedef struct scene {
    sn_body body;
    sn_locator *locator;
    sn_collocation row[80];
    sn_tissue_muscle ptr[80];
    int32_t n_muscle;
} scene;

/* A lattice of n^3 cubes, side 1 times scale; z = 0 is bone 0, the rest of its boundary skin. */
static void make_scene(scene *s, int n, double scale)
{
    memset(s, 0, sizeof *s);
    sn_tet_mesh m = made_lattice(n, sn_v3(0, 0, 0), 1.0);
    sn_tet_mesh flat;
    sn_tet_mesh_init(&flat);
    assert_int_equal(sn_tet_mesh_copy(&flat, &m, NULL), SN_OK);
    shake_mesh(&m, 0.1);
    for (size_t k = 0; k < 3 * (size_t)m.n_vert; k++) m.pos[k] *= scale;
    sn_body_init(&s->body);
    assert_int_equal(sn_body_from_tets(&m, SN_LABEL_SKIN, &s->body, NULL), SN_OK);
    for (size_t h = 0; h < 4 * (size_t)m.n_tet; h++) {
        double z = 0.0;
        for (int k = 0; k < 3; k++)
            z += flat.pos[3 * m.tet[(h & ~(size_t)3) + (size_t)sn_tet_face[h & 3][k]] + 2];
        if (s->body.across[h] < 0 && z == 0.0) s->body.across[h] = -1 - SN_LABEL_BONE(0);
    }
    s->body.n_bone = 1;
    assert_int_equal(sn_locator_create(&s->locator, &s->body.mesh, NULL), SN_OK);
    sn_tet_mesh_free(&m);
    sn_tet_mesh_free(&flat);
}

static void add_muscle(scene *s, const double *point, const double *tissue, int32_t n, double scale)
{
    double p[30];
    sn_muscle m;
    for (int32_t k = 0; k < 3 * n; k++) p[k] = scale * point[k];
    assert_int_equal(sn_muscle_init(&m, "m", &(sn_head_points){p, tissue, n}, 1, NULL), SN_OK);
    assert_int_equal(sn_collocate(&m, &s->body, s->locator, &s->row[s->n_muscle], NULL, NULL), SN_OK);
    s->ptr[s->n_muscle].row = &s->row[s->n_muscle];
    s->n_muscle++;
    sn_muscle_free(&m);
}

static void free_scene(scene *s)
{
    for (int32_t i = 0; i < s->n_muscle; i++) sn_collocation_free(&s->row[i]);
    sn_locator_destroy(s->locator);
    sn_body_free(&s->body);
}

static sn_tissue_solver *solver_of(const scene *s, double alpha, const sn_run *run)
{
    sn_tissue_solver *t = NULL;
    sn_error err = {.msg = ""};
    if (sn_tissue_solver_create(&t, &s->body, SN_SOLVER_AUTO, run, &err)) fail_msg("%s", err.msg);
    if (sn_tissue_solver_set_curves(t, s->ptr, s->n_muscle, alpha, &err)) fail_msg("%s", err.msg);
    return t;
}

static double *new_field(const scene *s)
{
    return calloc((size_t)(1 + s->n_muscle) * (size_t)s->body.mesh.n_vert, sizeof(double));
}

static double *solved(const scene *s, double alpha, double fat, const sn_run *run)
{
    double *field = new_field(s);
    sn_tissue_solver *t = solver_of(s, alpha, run);
    assert_int_equal(sn_tissue_solver_solve(t, fat, NULL, NULL, NULL, run, field, NULL), SN_OK);
    const sn_tissue_report *r = sn_tissue_solver_report(t);
    assert_true(r->residual <
                (alpha < 1e5 ? 1e-10 : 1e-6)); /* against the fat's data, which alpha is not part of */
    assert_int_equal(r->n_solved, 1 + s->n_muscle);
    int32_t rows = 0;
    for (int32_t i = 0; i < s->n_muscle; i++) rows += s->row[i].n_row;
    assert_int_equal(r->collocation_points, rows);
    sn_tissue_solver_destroy(t);
    return field;
}

static const double curve_a[] = {1.2, 1.1, 0.3, 1.6, 1.5, 1.4, 1.3, 1.4, 2.6}, tissue_a[] = {1, 2, 1.5};
static const double curve_b[] = {2.4, 1.2, 0.4, 2.6, 2.5, 2.5};

static void make_small_scene(scene *s, double scale)
{
    make_scene(s, 4, scale);
    add_muscle(s, curve_a, tissue_a, 3, scale);
    add_muscle(s, curve_b, NULL, 2, scale);
}

/* Solves a x = b in place by elimination with pivots; a: n x n. */
static void eliminate(double *a, double *b, int n)
{
    for (int c = 0; c < n; c++) {
        int p = c;
        for (int r = c + 1; r < n; r++)
            if (fabs(a[r * n + c]) > fabs(a[p * n + c])) p = r;
        for (int k = 0; k < n; k++) {
            double swap = a[c * n + k];
            a[c * n + k] = a[p * n + k], a[p * n + k] = swap;
        }
        double swap = b[c];
        b[c] = b[p], b[p] = swap;
        for (int r = c + 1; r < n; r++) {
            double f = a[r * n + c] / a[c * n + c];
            for (int k = c; k < n; k++) a[r * n + k] -= f * a[c * n + k];
            b[r] -= f * b[c];
        }
    }
    for (int r = n - 1; r >= 0; r--) {
        for (int k = r + 1; k < n; k++) b[r] -= a[r * n + k] * b[k];
        b[r] /= a[r * n + r];
    }
}

/* Eq. 10 by dense matrices, with gradients of its own: the coefficients of 1, x, y, z of each barycentric
 * function. */
static void dense_tissue(const scene *s, double alpha, double fat, int32_t tissue, double *field)
{
    const sn_tet_mesh *m = &s->body.mesh;
    int n = m->n_vert;
    double size = sn_box3_diagonal(sn_tet_mesh_bounds(m));
    double *a = calloc((size_t)(n * n), sizeof *a), *b = calloc((size_t)n, sizeof *b);
    for (int32_t t = 0; t < m->n_tet; t++) {
        double grad[4][3];
        for (int k = 0; k < 4; k++) {
            double c[16], e[4] = {k == 0, k == 1, k == 2, k == 3};
            for (int i = 0; i < 4; i++) {
                c[4 * i] = 1.0;
                for (int x = 0; x < 3; x++) c[4 * i + 1 + x] = m->pos[3 * m->tet[4 * t + i] + x] / size;
            }
            eliminate(c, e, 4);
            for (int x = 0; x < 3; x++) grad[k][x] = e[1 + x];
        }
        double volume = sn_tet_mesh_tet_volume(m, t) / (size * size * size);
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < 4; k++)
                for (int x = 0; x < 3; x++)
                    a[m->tet[4 * t + i] * n + m->tet[4 * t + k]] += volume * grad[i][x] * grad[k][x];
    }
    for (int32_t j = 0; j < s->n_muscle; j++)
        for (int32_t r = 0; r < s->row[j].n_row; r++)
            for (int i = 0; i < 4; i++) {
                int32_t v = m->tet[4 * s->row[j].tet[r] + i];
                double w = alpha * s->row[j].bary[4 * r + i];
                for (int k = 0; k < 4; k++)
                    a[v * n + m->tet[4 * s->row[j].tet[r] + k]] += w * s->row[j].bary[4 * r + k];
                if (j == tissue - 1) b[v] += w * s->row[j].value[r];
            }
    for (size_t h = 0; h < 4 * (size_t)m->n_tet; h++) /* skin rows become "x = value" */
        for (int k = 0; k < 3 && s->body.across[h] == -1 - SN_LABEL_SKIN; k++) {
            int32_t v = m->tet[(h & ~(size_t)3) + (size_t)sn_tet_face[h & 3][k]];
            for (int c = 0; c < n; c++) a[v * n + c] = c == v;
            b[v] = tissue == 0 ? fat : 0.0;
        }
    eliminate(a, b, n);
    memcpy(field, b, (size_t)n * sizeof *b);
    free(a);
    free(b);
}

static void agrees_with_dense_elimination(void **state)
{
    (void)state;
    scene s;
    make_small_scene(&s, 1.0);
    const double alphas[] = {5.0, 200.0};
    double *want = calloc((size_t)s.body.mesh.n_vert, sizeof *want);
    for (int i = 0; i < 2; i++) {
        double *field = solved(&s, alphas[i], 0.2, NULL);
        for (int32_t tissue = 0; tissue < 3; tissue++) {
            double largest = 0.0;
            dense_tissue(&s, alphas[i], 0.2, tissue, want);
            for (int32_t v = 0; v < s.body.mesh.n_vert; v++) {
                assert_true(fabs(field[tissue * s.body.mesh.n_vert + v] - want[v]) < 1e-11);
                largest = fmax(largest, fabs(want[v]));
            }
            assert_true(largest > 0.1); /* something was compared */
        }
        free(field);
    }
    free(want);
    free_scene(&s);
}

static void skin_values_are_kept(void **state)
{
    (void)state;
    scene s;
    make_small_scene(&s, 1.0);
    double *field = solved(&s, 5.0, 0.3, NULL);
    int32_t n = s.body.mesh.n_vert, bones = 0;
    for (int32_t v = 0; v < n; v++) {
        bool skin = false;
        for (size_t h = 0; h < 4 * (size_t)s.body.mesh.n_tet; h++)
            for (int k = 0; k < 3 && s.body.across[h] == -1; k++)
                skin = skin || s.body.mesh.tet[(h & ~(size_t)3) + (size_t)sn_tet_face[h & 3][k]] == v;
        if (skin) assert_true(field[v] == 0.3 && field[n + v] == 0.0 && field[2 * n + v] == 0.0);
        if (!skin && v % 5 == 0) bones++; /* z = 0, inside its rim: free */
    }
    assert_int_equal(bones, 9);
    free(field);
    free_scene(&s);
}

static void metres_or_millimetres(void **state)
{
    (void)state;
    const double scale[] = {1.0, 1000.0, 1e-3};
    double *field[3];
    int32_t n = 0;
    for (int i = 0; i < 3; i++) {
        scene s;
        make_small_scene(&s, scale[i]);
        field[i] = solved(&s, 5.0, 0.2, NULL);
        n = 3 * s.body.mesh.n_vert;
        free_scene(&s);
    }
    for (int i = 1; i < 3; i++)
        for (int32_t k = 0; k < n; k++) assert_true(fabs(field[i][k] - field[0][k]) < 1e-9);
    for (int i = 0; i < 3; i++) free(field[i]);
}

static void unwanted_fields_are_untouched(void **state)
{
    (void)state;
    scene s;
    make_small_scene(&s, 1.0);
    double *all = solved(&s, 5.0, 0.2, NULL), *some = new_field(&s);
    int32_t n = s.body.mesh.n_vert;
    for (int32_t k = 0; k < 3 * n; k++) some[k] = -77.0;
    sn_tissue_solver *t = solver_of(&s, 5.0, NULL);
    const bool wanted[] = {false, false, true}, none[] = {false, false, false};
    assert_int_equal(sn_tissue_solver_solve(t, 0.2, none, NULL, NULL, NULL, some, NULL), SN_OK);
    assert_int_equal(sn_tissue_solver_report(t)->n_solved, 0);
    for (int32_t k = 0; k < 3 * n; k++) assert_true(some[k] == -77.0);
    assert_int_equal(sn_tissue_solver_solve(t, 0.2, wanted, NULL, NULL, NULL, some, NULL), SN_OK);
    assert_int_equal(sn_tissue_solver_report(t)->n_solved, 1);
    for (int32_t k = 0; k < 2 * n; k++) assert_true(some[k] == -77.0);
    for (int32_t k = 2 * n; k < 3 * n; k++) assert_true(fabs(some[k] - all[k]) < 1e-13);
    sn_tissue_solver_destroy(t);
    free(all);
    free(some);
    free_scene(&s);
}

/* But for rounding: right-hand sides stand beside others. size: bytes. */
static void assert_near(const double *a, const double *b, size_t size)
{
    for (size_t k = 0; k < size / sizeof *a; k++) assert_true(fabs(a[k] - b[k]) < 1e-13);
}

/* One solver through changes of tissue values, curves and alpha, against fresh ones. */
static void solver_is_used_again(void **state)
{
    (void)state;
    scene s;
    make_small_scene(&s, 1.0);
    size_t size = 3 * (size_t)s.body.mesh.n_vert * sizeof(double);
    sn_tissue_solver *t = solver_of(&s, 5.0, NULL);
    double *field = new_field(&s), *fresh;
    assert_int_equal(sn_tissue_solver_solve(t, 0.2, NULL, NULL, NULL, NULL, field, NULL), SN_OK);
    for (int32_t r = 0; r < s.row[0].n_row; r++) s.row[0].value[r] *= 3.0; /* right-hand sides only */
    assert_int_equal(sn_tissue_solver_solve(t, 0.4, NULL, NULL, NULL, NULL, field, NULL), SN_OK);
    fresh = solved(&s, 5.0, 0.4, NULL);
    assert_near(field, fresh, size);
    free(fresh);
    assert_int_equal(sn_tissue_solver_set_curves(t, s.ptr, 2, 50.0, NULL), SN_OK);
    assert_int_equal(sn_tissue_solver_solve(t, 0.4, NULL, NULL, NULL, NULL, field, NULL), SN_OK);
    fresh = solved(&s, 50.0, 0.4, NULL);
    assert_near(field, fresh, size);
    free(fresh);
    free(field);
    s.n_muscle = 1; /* fewer curves */
    assert_int_equal(sn_tissue_solver_set_curves(t, s.ptr, 1, 5.0, NULL), SN_OK);
    field = new_field(&s);
    assert_int_equal(sn_tissue_solver_solve(t, 0.1, NULL, NULL, NULL, NULL, field, NULL), SN_OK);
    fresh = solved(&s, 5.0, 0.1, NULL);
    assert_near(field, fresh, 2 * (size / 3));
    free(fresh);
    free(field);
    sn_tissue_solver_destroy(t);
    s.n_muscle = 2;
    free_scene(&s);
}

static void heavy_curves_are_met(void **state)
{
    (void)state;
    scene s;
    make_scene(&s, 6, 1.0);
    const double a[] = {2.3, 2.2, 2.4, 3.4, 2.3, 3.6}, b[] = {2.3, 4.2, 2.4, 3.4, 4.3, 3.6};
    add_muscle(&s, a, NULL, 2, 1.0);
    add_muscle(&s, b, NULL, 2, 1.0);
    double error[2];
    for (int i = 0; i < 2; i++) {
        double *field = solved(&s, i ? 1e7 : 1e2, 0.2, NULL);
        error[i] = 0.0;
        for (int32_t tissue = 0; tissue < 3; tissue++)
            for (int32_t j = 0; j < 2; j++)
                for (int32_t r = 0; r < s.row[j].n_row; r++) {
                    double value[3];
                    sn_tissue_values(&s.body.mesh, field, 3, s.row[j].tet[r], s.row[j].bary + 4 * r, value);
                    error[i] = fmax(error[i], fabs(value[tissue] - (tissue == j + 1)));
                    if (i) assert_int_equal(sn_tissue_winner(value, 3), j + 1);
                }
        free(field);
    }
    assert_true(error[1] < 1e-4 && error[1] < 1e-3 * error[0]);
    free_scene(&s);
}

/* More right-hand sides than are solved together. */
static void many_muscles(void **state)
{
    (void)state;
    scene s;
    make_scene(&s, 6, 1.0);
    for (int i = 0; i < 70; i++) {
        double x = 0.6 + 0.5 * (i % 10), y = 0.6 + 0.7 * (i / 10);
        const double p[] = {x, y, 1.2, x + 0.1, y + 0.1, 4.4};
        add_muscle(&s, p, NULL, 2, 1.0);
    }
    double *field = solved(&s, 5.0, 0.2, NULL), *one = new_field(&s);
    sn_tissue_solver *t = solver_of(&s, 5.0, NULL);
    size_t n = (size_t)s.body.mesh.n_vert;
    for (size_t i = 0; i < 71; i += 14) {
        bool wanted[71] = {false};
        wanted[i] = true;
        assert_int_equal(sn_tissue_solver_solve(t, 0.2, wanted, NULL, NULL, NULL, one, NULL), SN_OK);
        for (size_t v = 0; v < n; v++) assert_true(fabs(one[i * n + v] - field[i * n + v]) < 1e-12);
    }
    sn_tissue_solver_destroy(t);
    free(field);
    free(one);
    free_scene(&s);
}

static void same_bits_with_any_threads(void **state)
{
    (void)state;
    scene s;
    make_scene(&s, 18, 1.0);
    for (int i = 0; i < 5; i++) {
        const double p[] = {3.0 + 2.5 * i, 4, 2, 4.0 + 2.2 * i, 9, 9, 3.5 + 2.4 * i, 14, 15};
        add_muscle(&s, p, NULL, 3, 1.0);
    }
    double *field[2];
    for (int i = 0; i < 2; i++) field[i] = solved(&s, 5.0, 0.2, &(sn_run){.n_threads = 1 + i});
    assert_true(s.body.mesh.n_vert > 5000); /* large enough for BLAS to use its threads */
    assert_memory_equal(field[0], field[1], 6 * (size_t)s.body.mesh.n_vert * sizeof(double));
    for (int i = 0; i < 2; i++) free(field[i]);
    free_scene(&s);
}

static void what_cannot_be_solved(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(1, sn_v3(0, 0, 0), 1.0);
    sn_body b;
    sn_error err;
    sn_tissue_solver *t = (sn_tissue_solver *)&m;
    sn_body_init(&b);
    assert_int_equal(sn_body_from_tets(&m, SN_LABEL_SKIN, &b, NULL), SN_OK);
    assert_int_equal(sn_tissue_solver_create(&t, &b, SN_SOLVER_AUTO, NULL, &err), SN_ESOLVE);
    assert_string_equal(err.msg, "the tet mesh has no vertex off the skin: mesh with a smaller edge length");
    assert_null(t);
    sn_body_free(&b);
    sn_tet_mesh_free(&m);
    scene s;
    make_small_scene(&s, 1.0);
    double *field = new_field(&s);
    field[5] = 42.0;
    assert_int_equal(sn_tissue_solver_create(&t, &s.body, SN_SOLVER_AUTO, NULL, NULL), SN_OK);
    assert_int_equal(sn_tissue_solver_solve(t, 0.2, NULL, NULL, NULL, NULL, field, &err), SN_EINVAL);
    assert_string_equal(err.msg, "tissue: no curves set");
    const double bad[] = {0.0, -1.0, INFINITY};
    const char *const want[] = {"alpha is 0, need > 0", "alpha is -1, need > 0", "alpha is inf, need > 0"};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(sn_tissue_solver_set_curves(t, s.ptr, 2, bad[i], &err), SN_EINVAL);
        assert_string_equal(err.msg, want[i]);
    }
    assert_int_equal(sn_tissue_solver_set_curves(t, s.ptr, 2, NAN, &err), SN_EINVAL);
    assert_int_equal(sn_tissue_solver_set_curves(t, s.ptr, 2, 5.0, NULL), SN_OK);
    assert_int_equal(sn_tissue_solver_solve(t, -0.1, NULL, NULL, NULL, NULL, field, &err), SN_EINVAL);
    assert_string_equal(err.msg, "fat is -0.1, need >= 0");
    assert_int_equal(sn_tissue_solver_solve(t, NAN, NULL, NULL, NULL, NULL, field, &err), SN_EINVAL);
    volatile sig_atomic_t cancel = 1;
    sn_run stop = {.cancel = &cancel};
    assert_int_equal(sn_tissue_solver_solve(t, 0.1, NULL, NULL, NULL, &stop, field, &err), SN_ECANCEL);
    assert_string_equal(err.msg, "interrupted while assembling");
    assert_true(field[5] == 42.0 && field[6] == 0.0);
    cancel = 0;
    assert_int_equal(sn_tissue_solver_solve(t, 0.1, NULL, NULL, NULL, &stop, field, &err),
                     SN_OK); /* taken up again */
    cancel = 1;
    assert_int_equal(sn_tissue_solver_solve(t, 0.1, NULL, NULL, NULL, &stop, field, &err), SN_ECANCEL);
    assert_string_equal(err.msg, "interrupted while solving"); /* the factor is still there */
    double none;
    bool was_factorized;
    const sn_tissue_own own = {0, NULL, 1};
    assert_int_equal(
        sn_tissue_solver_solve_own(t, &own, NULL, NULL, &stop, field, &none, &was_factorized, &err),
        SN_ECANCEL);
    assert_string_equal(err.msg, "interrupted while assembling");
    sn_tissue_solver_destroy(t);
    sn_tissue_solver_destroy(NULL);
    assert_int_equal(sn_tissue_solver_create(&t, &s.body, SN_SOLVER_AUTO, &stop, &err), SN_ECANCEL);
    assert_null(t);
    free(field);
    free_scene(&s);
}

/* Neither skin nor curves hold the field: the matrix has no inverse. */
static void floating_body_without_curves(void **state)
{
    (void)state;
    scene s;
    make_scene(&s, 3, 1.0);
    for (size_t h = 0; h < 4 * (size_t)s.body.mesh.n_tet; h++)
        if (s.body.across[h] < 0) s.body.across[h] = -1 - SN_LABEL_BONE(0);
    sn_tissue_solver *t = NULL;
    assert_int_equal(sn_tissue_solver_create(&t, &s.body, SN_SOLVER_AUTO, NULL, NULL), SN_OK);
    sn_error err = {.msg = ""};
    double *field = new_field(&s);
    sn_status st = sn_tissue_solver_set_curves(t, s.ptr, 0, 5.0, &err);
    if (!st) st = sn_tissue_solver_solve(t, 0.2, NULL, NULL, NULL, NULL, field, &err);
    if (st) assert_int_equal(st, SN_ESOLVE);
    if (st) assert_memory_equal(err.msg, "the matrix is not positive definite (column ", 44);
    for (int32_t v = 0; v < s.body.mesh.n_vert; v++)
        assert_true(field[v] == (st ? 0.0 : 0.2)); /* nothing asks for anything but fat */
    add_muscle(&s, curve_a, NULL, 2, 0.9);         /* a curve holds it: the muscle is 1 everywhere, fat 0 */
    free(field);
    field = new_field(&s);
    assert_int_equal(sn_tissue_solver_set_curves(t, s.ptr, 1, 5.0, NULL), SN_OK);
    assert_int_equal(sn_tissue_solver_solve(t, 0.2, NULL, NULL, NULL, NULL, field, NULL), SN_OK);
    for (int32_t v = 0; v < s.body.mesh.n_vert; v++)
        assert_true(fabs(field[v]) < 1e-10 && fabs(field[s.body.mesh.n_vert + v] - 1.0) < 1e-10);
    sn_tissue_solver_destroy(t);
    free(field);
    free_scene(&s);
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    scene s;
    make_small_scene(&s, 1.0);
    double *field = new_field(&s);
    sn_run one = {.n_threads = 1};
    sn_status st = SN_ENOMEM;
    for (int n = 0; st; n++) {
        ration r = {n, 0};
        sn_tissue_solver *t = NULL;
        sn_error err;
        sn_set_allocator(RATION(r));
        st = sn_tissue_solver_create(&t, &s.body, SN_SOLVER_AUTO, &one, &err);
        if (st) assert_null(t);
        if (!st) st = sn_tissue_solver_set_curves(t, s.ptr, 2, 5.0, &err);
        if (!st) st = sn_tissue_solver_solve(t, 0.2, NULL, NULL, NULL, &one, field, &err);
        if (st) assert_int_equal(err.code, SN_ENOMEM);
        if (st) assert_non_null(strstr(err.msg, "no memory"));
        if (st) assert_true(field[0] == 0.0);
        sn_tissue_solver_destroy(t);
        assert_int_equal(r.in_use, 0);
        assert_true(n < 120);
    }
    sn_set_allocator(NULL);
    free(field);
    free_scene(&s);
}

/* ---- segmentation ---- */

static void winner_is_the_lowest_of_the_largest(void **state)
{
    (void)state;
    const double a[] = {0.2, 0.7, 0.7, -1}, b[] = {0, 0, 0}, c[] = {-2, -1, -3};
    assert_int_equal(sn_tissue_winner(a, 4), 1);
    assert_int_equal(sn_tissue_winner(b, 3), 0);
    assert_int_equal(sn_tissue_winner(c, 3), 1);
    assert_int_equal(sn_tissue_winner(c, 1), 0);
}

static void values_inside_a_tet(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(1, sn_v3(0, 0, 0), 1.0); /* tet 0: vertices 0, 4, 6, 7 */
    const double field[] = {1, 9, 9, 9, 2, 9, 3, 4, 10, 9, 9, 9, 20, 9, 30, 40};
    const double bary[] = {0.5, 0.25, 0.125, 0.125};
    double out[2];
    sn_tissue_values(&m, field, 2, 0, bary, out);
    assert_true(out[0] == 0.5 + 0.5 + 0.375 + 0.5 && out[1] == 18.75);
    sn_tet_mesh_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(laplacian_of_one_tet),
        cmocka_unit_test(laplacian_is_what_it_should_be),
        cmocka_unit_test(gradients_of_barycentric_functions),
        cmocka_unit_test(the_assembly_knows_every_place),
        cmocka_unit_test(tets_count_by_their_weight),
        cmocka_unit_test(a_vertex_with_very_many_neighbours),
        cmocka_unit_test(small_matrix),
        cmocka_unit_test(linear_functions_are_exact),
        cmocka_unit_test(field_between_spheres_converges),
        cmocka_unit_test(agrees_with_dense_elimination),
        cmocka_unit_test(skin_values_are_kept),
        cmocka_unit_test(metres_or_millimetres),
        cmocka_unit_test(unwanted_fields_are_untouched),
        cmocka_unit_test(solver_is_used_again),
        cmocka_unit_test(heavy_curves_are_met),
        cmocka_unit_test(many_muscles),
        cmocka_unit_test(same_bits_with_any_threads),
        cmocka_unit_test(what_cannot_be_solved),
        cmocka_unit_test(floating_body_without_curves),
        cmocka_unit_test(every_allocation_may_fail),
        cmocka_unit_test(winner_is_the_lowest_of_the_largest),
        cmocka_unit_test(values_inside_a_tet),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
