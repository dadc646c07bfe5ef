/* test_low_rank - what edits are solved by: half solves, strips that go back, changes of low rank, half
 * solves that are kept, and conjugate gradients; all against whole solves by a factor of the same matrix. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "field/half_cache.h"
#include "field/iterative.h"
#include "field/low_rank.h"

#include "made_mesh.h"

enum { n_corner = 4 };

/* ---- a matrix, and vectors like rows of curves: four entries around a vertex ---- */

typedef struct system {
    sn_tet_mesh mesh;
    sn_csr a;
    int32_t *number, n;
    sn_cholesky *c;
} system_of;

static system_of made_system(int lattice)
{
    system_of s = {.mesh = made_lattice(lattice, sn_v3(0, 0, 0), 0.5)};
    sn_assembly assembly = {0};
    shake_mesh(&s.mesh, 0.06);
    assert_int_equal(sn_laplacian_build(&s.a, &assembly, &s.mesh, 0.0, NULL, NULL), SN_OK);
    sn_assembly_free(&assembly);
    s.number = malloc((size_t)s.a.n * sizeof *s.number);
    for (int32_t v = 0; v < s.a.n; v++) {
        s.a.val[sn_csr_find(&s.a, v, v)] += 0.02;
        s.number[v] = v % 7 == 3 ? -1 : s.n++;
    }
    assert_int_equal(sn_cholesky_create(&s.c, &s.a, s.number, s.n, NULL, NULL), SN_OK);
    assert_int_equal(sn_cholesky_factorize(s.c, &s.a, NULL, NULL), SN_OK);
    return s;
}

static void free_system(system_of *s)
{
    sn_cholesky_destroy(s->c);
    sn_csr_free(&s->a);
    sn_tet_mesh_free(&s->mesh);
    free(s->number);
}

typedef struct vectors {
    sn_sparse_vectors v;
    int32_t *ptr, *index;
    double *value;
} vectors;

/* Vector i is that of tet (first + i) of the mesh. */
static vectors made_vectors(const system_of *s, int32_t first, int32_t n)
{
    vectors r = {.ptr = calloc((size_t)n + 1, sizeof *r.ptr),
                 .index = malloc(n_corner * ((size_t)n + 1) * sizeof *r.index),
                 .value = malloc(n_corner * ((size_t)n + 1) * sizeof *r.value)};
    for (int32_t i = 0; i < n; i++) {
        int32_t end = r.ptr[i];
        for (int k = 0; k < n_corner; k++) {
            int32_t tet = (first + i) % s->mesh.n_tet,
                    u = s->number[s->mesh.tet[4 * (size_t)tet + (size_t)k]];
            if (u < 0) continue;
            r.index[end] = u;
            r.value[end++] = 0.1 * (k + 1);
        }
        r.ptr[i + 1] = end;
    }
    r.v = (sn_sparse_vectors){n, r.ptr, r.index, r.value};
    return r;
}

static void free_vectors(vectors *r)
{
    free(r->ptr);
    free(r->index);
    free(r->value);
}

/* Column i of the right-hand sides, whole. */
static double *dense_of(const system_of *s, const vectors *b)
{
    double *x = calloc((size_t)s->n * (size_t)(b->v.n + 1), sizeof *x);
    for (int32_t j = 0; j < b->v.n; j++)
        for (int32_t e = b->ptr[j]; e < b->ptr[j + 1]; e++)
            x[(size_t)j * (size_t)s->n + (size_t)b->index[e]] += b->value[e];
    return x;
}

static double **columns_of(double *x, int32_t n, int32_t n_column)
{
    double **column = malloc(((size_t)n_column + 1) * sizeof(double *));
    for (int32_t j = 0; j < n_column; j++) column[j] = x + (size_t)j * (size_t)n;
    return column;
}

static void assert_same(const double *a, const double *b, size_t n, double tolerance)
{
    double worst = 0.0, largest = 0.0;
    for (size_t k = 0; k < n; k++) {
        worst = fmax(worst, fabs(a[k] - b[k]));
        largest = fmax(largest, fabs(b[k]));
    }
    assert_true(worst <= tolerance * largest);
}

/* ---- half solves ---- */

/* Every width of a strip, one and many strips, one and two threads: as by the whole solver. */
static void half_solves_finish_as_whole_ones(void **state)
{
    (void)state;
    system_of s = made_system(9);
    for (int32_t n = 1; n <= 60; n += n < 30 ? 1 : 15) {
        vectors b = made_vectors(&s, 11 * n, n);
        double *want = dense_of(&s, &b), *got[2];
        assert_int_equal(sn_cholesky_solve(s.c, want, n, NULL, NULL), SN_OK);
        for (int t = 0; t < 2; t++) {
            sn_run run = {.n_threads = 1 + t};
            sn_half_solve *h = NULL;
            got[t] = calloc((size_t)s.n * (size_t)n, sizeof *got[t]);
            double **column = columns_of(got[t], s.n, n);
            assert_int_equal(sn_half_solve_create(&h, s.c, &b.v, &run, NULL), SN_OK);
            assert_int_equal(sn_half_solve_count(h), n);
            assert_int_equal(
                sn_half_solve_finish(&(sn_half_term){h, NULL, 0}, 1, n, column, NULL, &run, NULL), SN_OK);
            sn_half_solve_destroy(h);
            free(column);
        }
        assert_same(got[0], want, (size_t)s.n * (size_t)n, 1e-13);
        assert_memory_equal(got[0], got[1], (size_t)s.n * (size_t)n * sizeof(double));
        free(want);
        free(got[0]);
        free(got[1]);
        free_vectors(&b);
    }
    free_system(&s);
}

static void products_are_those_with_the_inverse(void **state)
{
    (void)state;
    system_of s = made_system(6);
    vectors u = made_vectors(&s, 5, 13), v = made_vectors(&s, 300, 40);
    double *x = dense_of(&s, &v), product[13 * 40], gram[13 * 13], itself[13 * 13];
    sn_half_solve *y = NULL, *z = NULL;
    assert_int_equal(sn_cholesky_solve(s.c, x, 40, NULL, NULL), SN_OK);
    assert_int_equal(sn_half_solve_create(&y, s.c, &u.v, NULL, NULL), SN_OK);
    assert_int_equal(sn_half_solve_create(&z, s.c, &v.v, NULL, NULL), SN_OK);
    sn_half_solve_product(y, z, product);
    for (int32_t j = 0; j < 40; j++)
        for (int32_t i = 0; i < 13; i++) {
            double want = 0.0;
            for (int32_t e = u.ptr[i]; e < u.ptr[i + 1]; e++)
                want += u.value[e] * x[(size_t)j * (size_t)s.n + (size_t)u.index[e]];
            assert_true(fabs(product[j * 13 + i] - want) < 1e-12 * (1.0 + fabs(want)));
        }
    sn_half_solve_gram(y, gram);
    sn_half_solve_product(y, y, itself);
    for (int k = 0; k < 13 * 13; k++) assert_true(fabs(gram[k] - itself[k]) < 1e-12);
    volatile sig_atomic_t cancel = 1;
    sn_half_solve *none = y;
    sn_error err;
    assert_int_equal(sn_half_solve_create(&none, s.c, &u.v, &(sn_run){.cancel = &cancel}, &err), SN_ECANCEL);
    assert_null(none);
    sn_half_solve_destroy(y);
    sn_half_solve_destroy(z);
    sn_half_solve_destroy(NULL);
    free(x);
    free_vectors(&u);
    free_vectors(&v);
    free_system(&s);
}

/* ---- changes of low rank ---- */

/* a += weight u u', of the whole matrix. */
static void change_matrix(system_of *s, const vectors *u, const double *weight)
{
    int32_t *row_of = malloc((size_t)s->n * sizeof *row_of);
    for (int32_t v = 0; v < s->a.n; v++)
        if (s->number[v] >= 0) row_of[s->number[v]] = v;
    for (int32_t j = 0; j < u->v.n; j++)
        for (int32_t e = u->ptr[j]; e < u->ptr[j + 1]; e++)
            for (int32_t f = u->ptr[j]; f < u->ptr[j + 1]; f++)
                s->a.val[sn_csr_find(&s->a, row_of[u->index[e]], row_of[u->index[f]])] +=
                    weight[j] * u->value[e] * u->value[f];
    free(row_of);
}

/* Solves for b by the change; x: n x b->n. seen: width x b->n, by malloc. */
static double *solve_changed(const system_of *s, const sn_low_rank *r, const vectors *b, double *x)
{
    int32_t n = b->v.n, width = sn_low_rank_width(r), n_part = sn_low_rank_part_count(r);
    double *seen = calloc((size_t)width * (size_t)n + 1, sizeof *seen),
           *factor = calloc((size_t)width * (size_t)n + 1, sizeof *factor);
    bool *has_sum = calloc((size_t)n, sizeof *has_sum);
    sn_half_term *term = malloc(((size_t)n_part + 1) * sizeof *term);
    sn_half_solve *z = NULL;
    double **column = columns_of(x, s->n, n);
    assert_int_equal(sn_half_solve_create(&z, s->c, &b->v, NULL, NULL), SN_OK);
    term[0] = (sn_half_term){z, NULL, 0};
    for (int32_t p = 0; p < n_part; p++) {
        int32_t first, count;
        const sn_half_solve *y = sn_low_rank_part(r, p, &first, &count);
        double *product = malloc((size_t)count * (size_t)n * sizeof *product);
        sn_half_solve_product(y, z, product);
        for (int32_t j = 0; j < n; j++)
            memcpy(seen + (size_t)j * (size_t)width + first, product + (size_t)j * (size_t)count,
                   (size_t)count * sizeof *product);
        term[1 + p] = (sn_half_term){y, factor + first, width};
        free(product);
    }
    assert_int_equal(sn_low_rank_factor(r, n, has_sum, seen, factor, NULL), SN_OK);
    assert_int_equal(sn_half_solve_finish(term, 1 + n_part, n, column, NULL, NULL, NULL), SN_OK);
    sn_half_solve_destroy(z);
    free(column);
    free(term);
    free(has_sum);
    free(factor);
    return seen;
}

static void assert_solves_as_a_new_factor(system_of *s, const sn_low_rank *r, const vectors *u,
                                          const double *weight)
{
    vectors b = made_vectors(s, 77, 5);
    double *want = dense_of(s, &b), *rest = dense_of(s, &b), *x = calloc((size_t)s->n * 5, sizeof *x);
    double *seen = solve_changed(s, r, &b, x);
    for (int32_t j = 0; j < 5; j++) { /* what is left of b: the matrix, and what it changed by */
        double *left = rest + (size_t)j * (size_t)s->n, *back = calloc((size_t)s->n, sizeof *back);
        sn_cholesky_add_product(s->c, x + (size_t)j * (size_t)s->n, back);
        sn_low_rank_add_product(r, x + (size_t)j * (size_t)s->n, back);
        assert_same(back, left, (size_t)s->n, 1e-11);
        free(back);
    }
    const sn_sparse_vectors own = sn_low_rank_vectors(r);
    for (int32_t j = 0; j < 5; j++)
        for (int32_t k = 0; k < own.n; k++) { /* terms, probes and the rest all see the solution */
            double value = 0.0;
            for (int32_t e = own.ptr[k]; e < own.ptr[k + 1]; e++)
                value += own.value[e] * x[(size_t)j * (size_t)s->n + (size_t)own.index[e]];
            assert_true(fabs(seen[(size_t)j * (size_t)own.n + (size_t)k] - value) < 1e-11);
        }
    sn_cholesky *fresh = NULL;
    change_matrix(s, u, weight);
    assert_int_equal(sn_cholesky_clone(&fresh, s->c, NULL), SN_OK);
    assert_int_equal(sn_cholesky_factorize(fresh, &s->a, NULL, NULL), SN_OK);
    assert_int_equal(sn_cholesky_solve(fresh, want, 5, NULL, NULL), SN_OK);
    assert_same(x, want, (size_t)s->n * 5, 1e-11);
    double *minus = malloc(((size_t)u->v.n + 1) * sizeof *minus);
    for (int32_t k = 0; k < u->v.n; k++) minus[k] = -weight[k];
    change_matrix(s, u, minus);
    sn_cholesky_destroy(fresh);
    free(minus);
    free(seen);
    free(want);
    free(rest);
    free(x);
    free_vectors(&b);
}

/* Terms come and go, as in a drag: columns that are known are not solved for again, and nothing is forgotten.
 */
static void terms_come_and_go(void **state)
{
    (void)state;
    system_of s = made_system(8);
    sn_low_rank *r = NULL;
    double weight[64];
    assert_int_equal(sn_low_rank_create(&r, s.c, NULL), SN_OK);
    assert_int_equal(sn_low_rank_count(r), 0);
    assert_int_equal(sn_low_rank_count(NULL), 0);
    for (int round = 0; round < 12; round++) {
        int32_t n = round == 4 ? 0 : 20 + round, n_probe = round % 3;
        vectors u = made_vectors(&s, 100 + 6 * round, n + n_probe);
        for (int32_t k = 0; k < n; k++) weight[k] = k % 3 == 1 ? 0.4 : 5.0;
        assert_int_equal(sn_low_rank_set(r, &u.v, weight, n, NULL, NULL), SN_OK);
        assert_int_equal(sn_low_rank_count(r), n);
        assert_true(sn_low_rank_width(r) >= n + n_probe);
        assert_true(n == 0 || sn_low_rank_width(r) <= 3 * (n + n_probe));
        u.v.n = n;
        assert_solves_as_a_new_factor(&s, r, &u, weight);
        free_vectors(&u);
    }
    sn_low_rank_destroy(r);
    sn_low_rank_destroy(NULL);
    free_system(&s);
}

/* What was added may be taken away; what makes the matrix singular is said. */
static void terms_that_take_away(void **state)
{
    (void)state;
    system_of s = made_system(6);
    vectors u = made_vectors(&s, 40, 2);
    const double add[] = {3.0, 2.0}, take[] = {-3.0, -2.0};
    change_matrix(&s, &u, add);
    assert_int_equal(sn_cholesky_factorize(s.c, &s.a, NULL, NULL), SN_OK);
    sn_low_rank *r = NULL;
    assert_int_equal(sn_low_rank_create(&r, s.c, NULL), SN_OK);
    assert_int_equal(sn_low_rank_set(r, &u.v, take, 2, NULL, NULL), SN_OK);
    assert_solves_as_a_new_factor(&s, r, &u, take);
    vectors one = made_vectors(&s, 40, 1);
    sn_half_solve *y = NULL;
    double gram, singular;
    assert_int_equal(sn_half_solve_create(&y, s.c, &one.v, NULL, NULL), SN_OK);
    sn_half_solve_gram(y, &gram);
    singular = -1.0 / gram;
    sn_error err = {.msg = ""};
    if (1.0 / singular + gram == 0.0) {
        assert_int_equal(sn_low_rank_set(r, &one.v, &singular, 1, NULL, &err), SN_ESOLVE);
        assert_string_equal(err.msg, "the dense matrix is singular (column 1 of 1)");
        assert_int_equal(sn_low_rank_count(r), 0);
    }
    volatile sig_atomic_t cancel = 1;
    vectors others = made_vectors(&s, 200, 3);
    assert_int_equal(
        sn_low_rank_set(r, &others.v, (double[]){1, 1, 1}, 3, &(sn_run){.cancel = &cancel}, &err),
        SN_ECANCEL);
    assert_int_equal(sn_low_rank_count(r), 0);
    assert_int_equal(sn_low_rank_set(r, &u.v, take, 2, NULL, NULL), SN_OK); /* taken up again */
    assert_solves_as_a_new_factor(&s, r, &u, take);
    sn_half_solve_destroy(y);
    sn_low_rank_destroy(r);
    free_vectors(&u);
    free_vectors(&one);
    free_vectors(&others);
    free_system(&s);
}

/* ---- half solves that are kept ---- */

static void assert_places(const sn_half_cache *h, const system_of *s, const vectors *b,
                          const sn_half_place *place)
{
    double *x = dense_of(s, b);
    assert_int_equal(sn_cholesky_solve(s->c, x, b->v.n, NULL, NULL), SN_OK);
    for (int32_t j = 0; j < b->v.n; j++) { /* the column that the place names is b's */
        const sn_half_solve *z = h->batch[place[j].i_batch].z;
        int32_t n = sn_half_solve_count(z);
        double *pick = calloc((size_t)n, sizeof *pick), *got = calloc((size_t)s->n, sizeof *got);
        pick[place[j].column] = 1.0;
        assert_int_equal(sn_half_solve_finish(&(sn_half_term){z, pick, n}, 1, 1, &got, NULL, NULL, NULL),
                         SN_OK);
        assert_same(got, x + (size_t)j * (size_t)s->n, (size_t)s->n, 1e-13);
        free(pick);
        free(got);
    }
    free(x);
}

static void half_solves_are_kept(void **state)
{
    (void)state;
    system_of s = made_system(6);
    sn_half_cache h = {0};
    sn_half_place place[24];
    vectors all = made_vectors(&s, 10, 20);
    assert_int_equal(sn_half_cache_need(&h, s.c, &all.v, NULL, place, NULL), SN_OK);
    assert_int_equal(h.n_batch, 1);
    assert_places(&h, &s, &all, place);
    for (int i = 0; i < 9; i++) { /* single ones come, and the large batch stays */
        vectors one = made_vectors(&s, 100 + i, 1);
        assert_int_equal(sn_half_cache_need(&h, s.c, &one.v, NULL, place, NULL), SN_OK);
        assert_places(&h, &s, &one, place);
        assert_true(h.n_batch <= 5);
        free_vectors(&one);
        int32_t before = h.n_batch;
        assert_int_equal(sn_half_cache_need(&h, s.c, &all.v, NULL, place, NULL), SN_OK);
        assert_int_equal(h.n_batch, before); /* all there */
        assert_places(&h, &s, &all, place);
    }
    sn_half_cache_free(&h);
    assert_int_equal(h.n_batch, 0);
    free_vectors(&all);
    free_system(&s);
}

/* ---- conjugate gradients ---- */

static void gradients_find_the_same(void **state)
{
    (void)state;
    system_of s = made_system(16); /* more unknowns than the coarsest level takes */
    vectors b = made_vectors(&s, 500, 1);
    double *want = dense_of(&s, &b), *rhs = dense_of(&s, &b), *x = calloc((size_t)s.n, sizeof *x);
    sn_iterative *it = NULL;
    sn_iterative_report first, again;
    sn_error err = {.msg = ""};
    assert_true(s.n > 3000);
    assert_int_equal(sn_cholesky_solve(s.c, want, 1, NULL, NULL), SN_OK);
    if (sn_iterative_create(&it, &s.a, s.number, s.n, NULL, &err)) fail_msg("%s", err.msg);
    assert_int_equal(sn_iterative_solve(it, rhs, x, 1e-11, NULL, &first, NULL), SN_OK);
    assert_true(first.iterations > 3 && first.residual < 1e-8);
    assert_same(x, want, (size_t)s.n, 1e-9);
    assert_int_equal(sn_iterative_solve(it, rhs, x, 1e-9, NULL, &again, NULL), SN_OK);
    assert_true(again.iterations <= 1); /* it begins where it is */
    for (int64_t k = 0; k < s.a.ptr[s.a.n]; k++) s.a.val[k] *= 2.0;
    sn_iterative_set_values(it, &s.a);
    assert_int_equal(sn_iterative_solve(it, rhs, x, 1e-11, NULL, &again, NULL), SN_OK);
    for (int32_t u = 0; u < s.n; u++) want[u] *= 0.5;
    assert_same(x, want, (size_t)s.n, 1e-9);
    volatile sig_atomic_t cancel = 1;
    x[0] += 1.0;
    assert_int_equal(sn_iterative_solve(it, rhs, x, 1e-11, &(sn_run){.cancel = &cancel}, &again, &err),
                     SN_ECANCEL);
    assert_string_equal(err.msg, "interrupted while iterating");
    sn_iterative_destroy(it);
    sn_iterative_destroy(NULL);
    assert_int_equal(sn_iterative_create(&it, &s.a, s.number, 0, NULL, &err), SN_EINVAL);
    assert_null(it);
    free(want);
    free(rhs);
    free(x);
    free_vectors(&b);
    free_system(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(half_solves_finish_as_whole_ones),
        cmocka_unit_test(products_are_those_with_the_inverse),
        cmocka_unit_test(terms_come_and_go),
        cmocka_unit_test(terms_that_take_away),
        cmocka_unit_test(half_solves_are_kept),
        cmocka_unit_test(gradients_find_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
