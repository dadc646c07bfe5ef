/* test_harmonic - smooth spreading of data, and the parts of the Cholesky solver that it needs: blocks of the
 * inverse, clones, orders of elimination, dense systems. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/dense.h"
#include "field/cholesky.h"
#include "field/harmonic.h"
#include "field/tissue.h"

#include "made_mesh.h"

static sn_csr laplacian_of(const sn_tet_mesh *m)
{
    sn_csr a = {0};
    sn_assembly s = {0};
    assert_int_equal(sn_laplacian_build(&a, &s, m, 0.0, NULL, NULL), SN_OK);
    sn_assembly_free(&s);
    return a;
}

static sn_tet_mesh shaken_box(int n)
{
    sn_tet_mesh m = made_lattice(n, sn_v3(-1, 2, 3), 0.5);
    shake_mesh(&m, 0.06);
    return m;
}

/* 0, 1, 2, ...: no vertex is held at 0. */
static int32_t *all_free(int32_t n)
{
    int32_t *number = malloc((size_t)n * sizeof *number);
    for (int32_t v = 0; v < n; v++) number[v] = v;
    return number;
}

static sn_status create_free(sn_harmonic **h, const sn_csr *a, const sn_run *run, sn_error *err)
{
    int32_t *number = all_free(a->n);
    sn_status st = sn_harmonic_create(h, a, number, a->n, NULL, run, err);
    free(number); /* borrowed for the call only */
    return st;
}

static sn_harmonic *harmonic_of(const sn_tet_mesh *m)
{
    sn_csr a = laplacian_of(m);
    sn_harmonic *h = NULL;
    sn_error err = {.msg = ""};
    if (create_free(&h, &a, NULL, &err)) fail_msg("%s", err.msg);
    sn_csr_free(&a);
    return h;
}

/* n different numbers below `below`, in no order. */
static void choose(int32_t *out, int32_t n, int32_t below, uint64_t *h)
{
    int32_t *all = malloc((size_t)below * sizeof *all);
    for (int32_t i = 0; i < below; i++) all[i] = i;
    for (int32_t i = 0; i < n; i++) {
        int32_t k = i + (int32_t)(made_random(h) * (below - i)), swap = all[i];
        all[i] = all[k];
        all[k] = swap;
        out[i] = all[i];
    }
    free(all);
}

/* ---- harmonic functions ---- */

static double linear_at(const sn_tet_mesh *m, int32_t v)
{
    return 3.0 + sn_v3_dot(sn_tet_mesh_point(m, v), sn_v3(2, -1, 0.5));
}

static void linear_functions_are_reproduced(void **state)
{
    (void)state;
    enum { n = 7, s = n + 1 };
    sn_tet_mesh m = shaken_box(n);
    int32_t *fixed = malloc((size_t)m.n_vert * sizeof *fixed), n_fixed = 0;
    double *value = malloc((size_t)m.n_vert * sizeof *value);
    double *out = malloc((size_t)m.n_vert * sizeof *out);
    for (int32_t v = 0; v < m.n_vert; v++) {
        const int at[3] = {v / (s * s), v / s % s, v % s};
        bool inner = true;
        for (int k = 0; k < 3; k++) inner = inner && at[k] > 0 && at[k] < n;
        if (inner) continue;
        value[n_fixed] = linear_at(&m, v);
        fixed[n_fixed++] = v;
    }
    assert_int_equal(n_fixed, s * s * s - (s - 2) * (s - 2) * (s - 2));
    sn_harmonic *h = harmonic_of(&m);
    assert_int_equal(sn_harmonic_solve(h, fixed, n_fixed, value, 1, NULL, out, NULL), SN_OK);
    for (int32_t v = 0; v < m.n_vert; v++) assert_true(fabs(out[v] - linear_at(&m, v)) < 1e-7);
    for (int32_t i = 0; i < n_fixed; i++) assert_true(out[fixed[i]] == value[i]);
    sn_harmonic_destroy(h);
    sn_harmonic_destroy(NULL);
    sn_tet_mesh_free(&m);
    free(fixed);
    free(value);
    free(out);
}

/* y = L x on the free vertices. */
static void apply_free(const sn_csr *a, const bool *is_fixed, const double *x, double *y)
{
    for (int32_t v = 0; v < a->n; v++) {
        y[v] = 0.0;
        for (int64_t k = a->ptr[v]; k < a->ptr[v + 1] && !is_fixed[v]; k++) y[v] += a->val[k] * x[a->idx[k]];
    }
}

static double product(const double *x, const double *y, int32_t n)
{
    double sum = 0.0;
    for (int32_t v = 0; v < n; v++) sum += x[v] * y[v];
    return sum;
}

/* L x = 0 off the fixed vertices by conjugate gradients from the x given. */
static void solve_slowly(const sn_csr *a, const bool *is_fixed, double *x)
{
    size_t n = (size_t)a->n;
    double *r = malloc(n * sizeof *r), *d = malloc(n * sizeof *d), *q = malloc(n * sizeof *q);
    apply_free(a, is_fixed, x, r);
    for (size_t v = 0; v < n; v++) d[v] = r[v] = -r[v];
    double rr = product(r, r, a->n), first = rr;
    int round = 0;
    for (; round < 5000 && rr > 1e-26 * first; round++) {
        apply_free(a, is_fixed, d, q);
        double step = rr / product(d, q, a->n), before = rr;
        for (size_t v = 0; v < n; v++) {
            x[v] += step * d[v];
            r[v] -= step * q[v];
        }
        rr = product(r, r, a->n);
        for (size_t v = 0; v < n; v++) d[v] = r[v] + rr / before * d[v];
    }
    assert_true(round < 5000);
    free(r);
    free(d);
    free(q);
}

static void agrees_with_conjugate_gradients(void **state)
{
    (void)state;
    sn_tet_mesh m = shaken_box(6);
    sn_csr a = laplacian_of(&m);
    sn_harmonic *h = harmonic_of(&m);
    const int32_t counts[] = {1, 2, 17, 120}; /* one value alone is held by the whisper of mass only */
    uint64_t seed = 4711;
    for (int i = 0; i < 4; i++) {
        double tolerance = i == 0 ? 1e-4 : 1e-6;
        int32_t n = counts[i], *fixed = malloc((size_t)n * sizeof *fixed);
        double *value = malloc(3 * (size_t)n * sizeof *value);
        double *out = malloc(3 * (size_t)m.n_vert * sizeof *out);
        choose(fixed, n, m.n_vert, &seed);
        for (int32_t k = 0; k < 3 * n; k++) value[k] = 2.0 * made_random(&seed) - 1.0;
        assert_int_equal(sn_harmonic_solve(h, fixed, n, value, 3, NULL, out, NULL), SN_OK);
        for (int f = 0; f < 3; f++) {
            double *x = calloc((size_t)m.n_vert, sizeof *x);
            bool *is_fixed = calloc((size_t)m.n_vert, sizeof *is_fixed);
            for (int32_t k = 0; k < n; k++) {
                is_fixed[fixed[k]] = true;
                x[fixed[k]] = value[f * n + k];
                assert_true(out[f * m.n_vert + fixed[k]] == value[f * n + k]);
            }
            solve_slowly(&a, is_fixed, x);
            for (int32_t v = 0; v < m.n_vert; v++)
                assert_true(fabs(out[f * m.n_vert + v] - x[v]) < tolerance);
            free(x);
            free(is_fixed);
        }
        free(fixed);
        free(value);
        free(out);
    }
    sn_harmonic_destroy(h);
    sn_csr_free(&a);
    sn_tet_mesh_free(&m);
}

static void constants_stay_constant(void **state)
{
    (void)state;
    sn_tet_mesh m = shaken_box(12);
    sn_harmonic *h = harmonic_of(&m);
    double *out = malloc((size_t)m.n_vert * sizeof *out);
    int32_t fixed[40];
    uint64_t seed = 99;
    for (int32_t n = 1; n <= 40; n += 13) {
        double one[40];
        for (int i = 0; i < n; i++) one[i] = 1.0;
        choose(fixed, n, m.n_vert, &seed);
        assert_int_equal(sn_harmonic_solve(h, fixed, n, one, 1, NULL, out, NULL), SN_OK);
        for (int32_t v = 0; v < m.n_vert; v++) assert_true(fabs(out[v] - 1.0) < (n == 1 ? 1e-4 : 1e-6));
    }
    free(out);
    sn_harmonic_destroy(h);
    sn_tet_mesh_free(&m);
}

/* Two boxes side by side: what one is given does not reach the other. */
static void a_piece_without_values_gets_zero(void **state)
{
    (void)state;
    sn_tet_mesh a = made_lattice(3, sn_v3(0, 0, 0), 1.0), m;
    sn_tet_mesh_init(&m);
    assert_int_equal(sn_tet_mesh_reserve(&m, 2 * a.n_vert, 2 * a.n_tet, false, NULL), SN_OK);
    for (int32_t v = 0; v < m.n_vert; v++)
        sn_v3_store(m.pos + 3 * v,
                    sn_v3_add(sn_tet_mesh_point(&a, v % a.n_vert), sn_v3(v < a.n_vert ? 0.0 : 10.0, 0, 0)));
    for (int32_t k = 0; k < 4 * m.n_tet; k++)
        m.tet[k] = a.tet[k % (4 * a.n_tet)] + (k < 4 * a.n_tet ? 0 : a.n_vert);
    sn_harmonic *h = harmonic_of(&m);
    double *out = malloc((size_t)m.n_vert * sizeof *out);
    assert_int_equal(sn_harmonic_solve(h, (int32_t[]){70, 100}, 2, (double[]){2.0, 2.0}, 1, NULL, out, NULL),
                     SN_OK);
    for (int32_t v = 0; v < a.n_vert; v++) assert_true(out[v] == 0.0);
    for (int32_t v = a.n_vert; v < m.n_vert; v++) assert_true(fabs(out[v] - 2.0) < 1e-6);
    free(out);
    sn_harmonic_destroy(h);
    sn_tet_mesh_free(&a);
    sn_tet_mesh_free(&m);
}

/* The functions of a tissue solver are 0 on the skin and harmonic elsewhere: those of a factor made for that.
 */
static void functions_held_at_zero(void **state)
{
    (void)state;
    sn_tet_mesh m = shaken_box(8);
    sn_csr a = laplacian_of(&m);
    sn_body body;
    sn_tissue_solver *solver = NULL;
    sn_harmonic *h = NULL, *own = NULL;
    sn_body_init(&body);
    assert_int_equal(sn_body_from_tets(&m, SN_LABEL_SKIN, &body, NULL), SN_OK);
    assert_int_equal(sn_tissue_solver_create(&solver, &body, SN_SOLVER_AUTO, NULL, NULL), SN_OK);
    assert_int_equal(sn_tissue_solver_harmonic(solver, &h, NULL, NULL), SN_OK);
    const int32_t *number = sn_harmonic_numbers(h);
    int32_t fixed[3], n_free = 0;
    for (int32_t v = 0; v < m.n_vert; v++) n_free += number[v] >= 0;
    assert_int_equal(n_free, 7 * 7 * 7);
    for (int32_t v = 0; v < m.n_vert; v++)
        for (int i = 0; i < 3; i++)
            if (number[v] == 100 + 60 * i) fixed[i] = v;
    assert_int_equal(sn_harmonic_create(&own, &a, number, n_free, NULL, NULL, NULL), SN_OK);
    const double value[6] = {1, -2, 3, 0, 0, 1};
    double *out = malloc(2 * (size_t)m.n_vert * sizeof *out),
           *other = malloc(2 * (size_t)m.n_vert * sizeof *out);
    bool *is_held = calloc((size_t)m.n_vert, sizeof *is_held);
    assert_int_equal(sn_harmonic_solve(h, fixed, 3, value, 2, NULL, out, NULL), SN_OK);
    assert_int_equal(sn_harmonic_solve(own, fixed, 3, value, 2, NULL, other, NULL), SN_OK);
    for (int32_t v = 0; v < m.n_vert; v++) is_held[v] = number[v] < 0;
    for (int i = 0; i < 3; i++) is_held[fixed[i]] = true;
    for (int32_t f = 0; f < 2; f++) {
        double *x = calloc((size_t)m.n_vert, sizeof *x);
        for (int i = 0; i < 3; i++) x[fixed[i]] = value[3 * f + i];
        solve_slowly(&a, is_held, x);
        for (int32_t v = 0; v < m.n_vert; v++) {
            assert_true(fabs(out[f * m.n_vert + v] - x[v]) < 1e-6);
            assert_true(fabs(out[f * m.n_vert + v] - other[f * m.n_vert + v]) < 1e-12);
            if (number[v] < 0) assert_true(out[f * m.n_vert + v] == 0.0);
        }
        free(x);
    }
    free(out);
    free(other);
    free(is_held);
    sn_harmonic_destroy(h);
    sn_harmonic_destroy(own);
    sn_tissue_solver_destroy(solver);
    sn_body_free(&body);
    sn_csr_free(&a);
    sn_tet_mesh_free(&m);
}

/* A few entries of a right-hand side, among them two at one unknown, against the whole. */
static void right_hand_sides_of_few_entries(void **state)
{
    (void)state;
    sn_tet_mesh m = shaken_box(7);
    sn_csr a = laplacian_of(&m);
    for (int32_t v = 0; v < a.n; v++) a.val[sn_csr_find(&a, v, v)] += 0.1;
    int32_t *number = all_free(a.n);
    sn_cholesky *c = NULL;
    assert_int_equal(sn_cholesky_create(&c, &a, number, a.n, NULL, NULL), SN_OK);
    assert_int_equal(sn_cholesky_factorize(c, &a, NULL, NULL), SN_OK);
    const int32_t index[] = {300, 7, 511, 300, 44};
    const double value[] = {1, -2, 0.5, 3, 1e-3};
    double *x = calloc((size_t)a.n, sizeof *x), *few = malloc((size_t)a.n * sizeof *few);
    for (int i = 0; i < 5; i++) x[index[i]] += value[i];
    assert_int_equal(sn_cholesky_solve(c, x, 1, NULL, NULL), SN_OK);
    assert_int_equal(sn_cholesky_solve_few(c, index, value, 5, NULL, few, NULL), SN_OK);
    for (int32_t v = 0; v < a.n; v++) assert_true(fabs(x[v] - few[v]) < 1e-12);
    sn_cholesky_destroy(c);
    free(number);
    free(x);
    free(few);
    sn_csr_free(&a);
    sn_tet_mesh_free(&m);
}

static void interrupted(void **state)
{
    (void)state;
    sn_tet_mesh m = shaken_box(4);
    sn_csr a = laplacian_of(&m);
    sn_harmonic *h = (sn_harmonic *)&m;
    sn_error err;
    volatile sig_atomic_t cancel = 1;
    sn_run stop = {.cancel = &cancel};
    double *out = malloc((size_t)m.n_vert * sizeof *out);
    assert_int_equal(create_free(&h, &a, &stop, &err), SN_ECANCEL);
    assert_null(h);
    assert_int_equal(create_free(&h, &a, NULL, NULL), SN_OK);
    assert_int_equal(sn_harmonic_solve(h, (int32_t[]){3}, 1, (double[]){1}, 1, &stop, out, &err), SN_ECANCEL);
    assert_memory_equal(err.msg, "interrupted", 11);
    cancel = 0; /* and taken up again */
    assert_int_equal(sn_harmonic_solve(h, (int32_t[]){3}, 1, (double[]){1}, 1, &stop, out, NULL), SN_OK);
    assert_true(out[3] == 1.0);
    free(out);
    sn_harmonic_destroy(h);
    sn_csr_free(&a);
    sn_tet_mesh_free(&m);
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    sn_tet_mesh m = shaken_box(3);
    sn_csr a = laplacian_of(&m);
    double *out = malloc((size_t)m.n_vert * sizeof *out);
    int32_t *number = all_free(m.n_vert);
    sn_status st = SN_ENOMEM;
    int n = 0;
    for (; st; n++) {
        ration r = {n, 0};
        sn_harmonic *h = NULL;
        sn_error err;
        sn_set_allocator(RATION(r));
        st = sn_harmonic_create(&h, &a, number, a.n, NULL, &(sn_run){.n_threads = 1}, &err);
        if (st) assert_null(h);
        if (!st) st = sn_harmonic_solve(h, (int32_t[]){3, 40, 7}, 3, (double[]){1, 2, 3}, 1, NULL, out, &err);
        if (st) assert_int_equal(err.code, SN_ENOMEM);
        if (st) assert_non_null(strstr(err.msg, "no memory"));
        sn_harmonic_destroy(h);
        assert_int_equal(r.in_use, 0);
        assert_true(n < 60);
    }
    assert_true(n > 12);
    sn_set_allocator(NULL);
    free(out);
    free(number);
    sn_csr_free(&a);
    sn_tet_mesh_free(&m);
}

/* ---- Cholesky ---- */

typedef struct spd { /* Laplacian plus a diagonal on every row but each fifth */
    sn_tet_mesh mesh;
    sn_csr a;
    int32_t *number, n;
} spd;

static spd make_spd(int lattice)
{
    spd s = {.mesh = shaken_box(lattice)};
    uint64_t h = 31;
    s.a = laplacian_of(&s.mesh);
    s.number = malloc((size_t)s.a.n * sizeof *s.number);
    for (int32_t v = 0; v < s.a.n; v++) {
        s.a.val[sn_csr_find(&s.a, v, v)] += 0.01 + 0.1 * made_random(&h);
        s.number[v] = v % 5 == 2 ? -1 : s.n++;
    }
    return s;
}

static void free_spd(spd *s)
{
    sn_csr_free(&s->a);
    sn_tet_mesh_free(&s->mesh);
    free(s->number);
}

static sn_cholesky *factor_of(const spd *s)
{
    sn_cholesky *c = NULL;
    assert_int_equal(sn_cholesky_create(&c, &s->a, s->number, s->n, NULL, NULL), SN_OK);
    assert_int_equal(sn_cholesky_factorize(c, &s->a, NULL, NULL), SN_OK);
    assert_true(sn_cholesky_factor_entries(c) > s->n);
    return c;
}

static void blocks_of_the_inverse(void **state)
{
    (void)state;
    spd s = make_spd(7);
    sn_cholesky *c = factor_of(&s);
    size_t n = (size_t)s.n;
    double *inverse = calloc(n * n, sizeof *inverse), largest = 0.0;
    for (size_t i = 0; i < n; i++) inverse[i * n + i] = 1.0;
    assert_int_equal(sn_cholesky_solve(c, inverse, s.n, NULL, NULL), SN_OK);
    for (size_t k = 0; k < n * n; k++) largest = fmax(largest, fabs(inverse[k]));
    const int32_t counts[] = {1, 2, 7, 63, s.n};
    uint64_t seed = 8;
    for (int round = 0; round < 10; round++) {
        int32_t p = counts[round % 5], *index = malloc((size_t)p * sizeof *index);
        double *block = malloc((size_t)p * (size_t)p * sizeof *block);
        choose(index, p, s.n, &seed);
        assert_int_equal(sn_cholesky_inverse_block(c, index, p, NULL, block, NULL), SN_OK);
        for (int32_t i = 0; i < p; i++)
            for (int32_t k = 0; k < p; k++) {
                double want = inverse[(size_t)index[i] * n + (size_t)index[k]];
                assert_true(fabs(block[i * p + k] - want) < 1e-10 * largest);
                assert_true(block[i * p + k] == block[k * p + i]);
            }
        free(index);
        free(block);
    }
    volatile sig_atomic_t cancel = 1;
    double one;
    sn_error err;
    assert_int_equal(
        sn_cholesky_inverse_block(c, (int32_t[]){0}, 1, &(sn_run){.cancel = &cancel}, &one, &err),
        SN_ECANCEL);
    sn_cholesky_destroy(c);
    free(inverse);
    free_spd(&s);
}

static void fill_rhs(double *x, int32_t n)
{
    uint64_t h = 3;
    for (int32_t k = 0; k < n; k++) x[k] = made_random(&h) - 0.5;
}

static void clones_give_the_same_bits(void **state)
{
    (void)state;
    spd s = make_spd(6);
    sn_cholesky *c = factor_of(&s), *clone = NULL;
    size_t size = 3 * (size_t)s.n * sizeof(double);
    double *x = malloc(size), *y = malloc(size), *block = malloc(16 * sizeof *block), other[16];
    const int32_t index[] = {5, 0, 77, 31};
    fill_rhs(x, 3 * s.n);
    memcpy(y, x, size);
    assert_int_equal(sn_cholesky_solve(c, x, 3, NULL, NULL), SN_OK);
    assert_int_equal(sn_cholesky_inverse_block(c, index, 4, NULL, block, NULL), SN_OK);
    assert_int_equal(sn_cholesky_clone(&clone, c, NULL), SN_OK);
    int64_t entries = sn_cholesky_factor_entries(c);
    sn_cholesky_destroy(c);
    assert_int_equal(sn_cholesky_factorize(clone, &s.a, NULL, NULL), SN_OK);
    assert_int_equal(sn_cholesky_factor_entries(clone), entries);
    assert_int_equal(sn_cholesky_solve(clone, y, 3, NULL, NULL), SN_OK);
    assert_memory_equal(x, y, size);
    assert_int_equal(sn_cholesky_inverse_block(clone, index, 4, NULL, other, NULL), SN_OK);
    assert_memory_equal(block, other, sizeof other);
    sn_cholesky *second = NULL; /* a clone of the clone, and one short of memory */
    sn_error err;
    for (int n = 0; n < 2; n++) {
        ration r = {n, 0};
        sn_set_allocator(RATION(r));
        assert_int_equal(sn_cholesky_clone(&second, clone, &err), SN_ENOMEM);
        sn_set_allocator(NULL);
        assert_null(second);
        assert_int_equal(r.in_use, 0);
    }
    assert_int_equal(sn_cholesky_clone(&second, clone, NULL), SN_OK);
    assert_int_equal(sn_cholesky_factorize(second, &s.a, NULL, NULL), SN_OK);
    fill_rhs(y, 3 * s.n);
    assert_int_equal(sn_cholesky_solve(second, y, 3, NULL, NULL), SN_OK);
    assert_memory_equal(x, y, size);
    sn_cholesky_destroy(clone);
    sn_cholesky_destroy(second);
    free(x);
    free(y);
    free(block);
    free_spd(&s);
}

/* The order by minimum degree, for small systems: another factor, the same solution; clones as of any. */
static void small_systems(void **state)
{
    (void)state;
    spd s = make_spd(6);
    sn_cholesky *c[3] = {factor_of(&s), NULL, NULL};
    double *x[3];
    sn_error err;
    assert_int_equal(sn_cholesky_create_small(&c[1], &s.a, s.number, 0, NULL, &err), SN_EINVAL);
    assert_string_equal(err.msg, "cholesky: the matrix has no rows");
    assert_null(c[1]);
    assert_int_equal(sn_cholesky_create_small(&c[1], &s.a, s.number, s.n, NULL, NULL), SN_OK);
    assert_int_equal(sn_cholesky_clone(&c[2], c[1], NULL), SN_OK);
    for (int i = 0; i < 3; i++) {
        if (i > 0) assert_int_equal(sn_cholesky_factorize(c[i], &s.a, NULL, NULL), SN_OK);
        x[i] = malloc((size_t)s.n * sizeof **x);
        fill_rhs(x[i], s.n);
        assert_int_equal(sn_cholesky_solve(c[i], x[i], 1, NULL, NULL), SN_OK);
        sn_cholesky_destroy(c[i]);
    }
    for (int32_t k = 0; k < s.n; k++) assert_true(fabs(x[1][k] - x[0][k]) < 1e-11);
    assert_memory_equal(x[1], x[2], (size_t)s.n * sizeof **x);
    for (int i = 0; i < 3; i++) free(x[i]);
    free_spd(&s);
}

static void dense_systems(void **state)
{
    (void)state;
    double a[] = {4, 2, 2, 3}, x[] = {4 * 5 + 2 * 7, 2 * 5 + 3 * 7, 4, 2}; /* (5, 7) and (1, 0) */
    const double want[] = {5, 7, 1, 0};
    sn_error err;
    assert_int_equal(sn_dense_solve_spd(a, 2, x, 2, NULL), SN_OK);
    for (int i = 0; i < 4; i++) assert_true(fabs(x[i] - want[i]) < 1e-14);
    double bad[] = {1, 2, 0, 2, 1, 0, 0, 0, 1}, y[] = {1, 1, 1}; /* eigenvalues 3, -1, 1 */
    assert_int_equal(sn_dense_solve_spd(bad, 3, y, 1, &err), SN_ESOLVE);
    assert_string_equal(err.msg, "the dense matrix is not positive definite (column 2 of 3)");
    double zero[] = {0}, z[] = {1};
    assert_int_equal(sn_dense_solve_spd(zero, 1, z, 1, &err), SN_ESOLVE);
    assert_string_equal(err.msg, "the dense matrix is not positive definite (column 1 of 1)");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_functions_are_reproduced),
        cmocka_unit_test(agrees_with_conjugate_gradients),
        cmocka_unit_test(constants_stay_constant),
        cmocka_unit_test(a_piece_without_values_gets_zero),
        cmocka_unit_test(functions_held_at_zero),
        cmocka_unit_test(right_hand_sides_of_few_entries),
        cmocka_unit_test(interrupted),
        cmocka_unit_test(every_allocation_may_fail),
        cmocka_unit_test(blocks_of_the_inverse),
        cmocka_unit_test(clones_give_the_same_bits),
        cmocka_unit_test(small_systems),
        cmocka_unit_test(dense_systems),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
