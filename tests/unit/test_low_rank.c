/* test_low_rank - what edits are solved by: half solves, strips that go back, changes of low rank, half
 * solves that are kept, and conjugate gradients; all against whole solves by a factor of the same matrix. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "field/cholesky_private.h"
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
                sn_half_solve_finish(s.c, &(sn_half_term){.y = h}, 1, n, column, NULL, &run, NULL), SN_OK);
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

/* Each supernode is in the trunk or in one branch; a branch is the whole of what is below its last one. */
static void branches_and_trunk_are_all(void **state)
{
    (void)state;
    system_of s = made_system(12);
    const sn_tree_cut *t = &s.c->order->tree;
    int32_t n = (int32_t)s.c->factor->nsuper, *count = calloc((size_t)n, sizeof *count), n_row = 0;
    assert_true(t->n_branch > 1);
    assert_true(t->n_trunk > 0);
    for (int32_t i = 0; i < t->n_trunk; i++) {
        int32_t k = t->trunk[i];
        count[k]++;
        for (SuiteSparse_long r = sn_supers(s.c->factor)[k]; r < sn_supers(s.c->factor)[k + 1]; r++)
            assert_int_equal(t->trunk_row[r], n_row++);
    }
    assert_int_equal(t->n_trunk_row, n_row);
    for (int32_t i = 0; i < t->n_branch; i++) {
        const sn_branch *b = &t->branch[i];
        assert_true(i == 0 || b->n_entry <= b[-1].n_entry);
        for (int32_t k = b->from; k < b->to; k++) {
            count[k]++;
            assert_true(k == b->to - 1 || (t->parent[k] > k && t->parent[k] < b->to));
        }
    }
    for (int32_t k = 0; k < n; k++) assert_int_equal(count[k], 1);
    free(count);
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

/* Solves for b by the change; x: n x b->n. rest: what is added to b at the columns, width x b->n, NULL for
 * nothing. seen: width x b->n, by malloc. */
static double *solve_changed(const system_of *s, const sn_low_rank *r, const vectors *b, const double *rest,
                             double *x)
{
    const sn_unit_columns *e = sn_low_rank_columns(r);
    size_t n = (size_t)b->v.n, width = (size_t)e->width;
    double *seen = calloc(width * n + 1, sizeof *seen), *factor = calloc(width * n + 1, sizeof *factor);
    sn_half_term *term = calloc((size_t)e->n_part + 1, sizeof *term);
    double **column = columns_of(x, s->n, b->v.n);
    if (rest) memcpy(factor, rest, width * n * sizeof *rest);
    assert_int_equal(sn_half_solve_create((sn_half_solve **)&term[0].y, s->c, &b->v, NULL, NULL), SN_OK);
    for (int32_t p = 0; p < e->n_part; p++) {
        const sn_unit_part *part = &e->part[p];
        double *product = malloc((size_t)part->n * n * sizeof *product);
        sn_half_solve_product(part->y, term[0].y, product);
        for (size_t j = 0; j < n; j++)
            memcpy(seen + j * width + part->first, product + j * (size_t)part->n,
                   (size_t)part->n * sizeof *product);
        term[1 + p] = (sn_half_term){.y = part->y, .factor = factor + part->first, .stride = e->width};
        free(product);
    }
    assert_int_equal(sn_low_rank_factor(r, b->v.n, seen, factor, NULL), SN_OK);
    assert_int_equal(sn_half_solve_finish(s->c, term, 1 + e->n_part, b->v.n, column, NULL, NULL, NULL),
                     SN_OK);
    sn_half_solve_destroy((sn_half_solve *)term[0].y);
    free(column);
    free(term);
    free(factor);
    return seen;
}

static void assert_solves_as_a_new_factor(system_of *s, const sn_low_rank *r, const vectors *u,
                                          const double *weight)
{
    vectors b = made_vectors(s, 77, 5);
    double *want = dense_of(s, &b), *rest = dense_of(s, &b), *x = calloc((size_t)s->n * 5, sizeof *x);
    double *seen = solve_changed(s, r, &b, NULL, x);
    for (int32_t j = 0; j < 5; j++) { /* what is left of b: the matrix, and what it changed by */
        double *left = rest + (size_t)j * (size_t)s->n, *back = calloc((size_t)s->n, sizeof *back);
        sn_cholesky_add_product(s->c, x + (size_t)j * (size_t)s->n, back);
        sn_low_rank_add_product(r, x + (size_t)j * (size_t)s->n, back);
        assert_same(back, left, (size_t)s->n, 1e-11);
        free(back);
    }
    const sn_unit_columns *e = sn_low_rank_columns(r);
    for (size_t j = 0; j < 5; j++)
        for (size_t k = 0; k < (size_t)e->width; k++) /* terms, probes and the rest all see the solution */
            assert_true(fabs(seen[j * (size_t)e->width + k] - x[j * (size_t)s->n + (size_t)e->unknown[k]]) <
                        1e-11);
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

static bool has_column(const sn_low_rank *r, int32_t unknown)
{
    const sn_unit_columns *e = sn_low_rank_columns(r);
    int32_t k = 0;
    while (k < e->width && e->unknown[k] != unknown) k++;
    return k < e->width;
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
        int32_t n = round == 4 ? 0 : 20 + round, probe[] = {3, 100 + round, 100 + 2 * round};
        vectors u = made_vectors(&s, 100 + 6 * round, n);
        for (int32_t k = 0; k < n; k++) weight[k] = k % 3 == 1 ? 0.4 : 5.0;
        const sn_low_rank_terms terms = {u.v, weight, probe, round % 4};
        assert_int_equal(sn_low_rank_set(r, &terms, NULL, NULL), SN_OK);
        assert_int_equal(sn_low_rank_count(r), n);
        assert_true(sn_low_rank_columns(r)->width <= 3 * (4 * n + round % 4));
        for (int k = 0; k < round % 4; k++) assert_true(has_column(r, probe[k]));
        for (int32_t e = 0; e < u.ptr[n]; e++) assert_true(has_column(r, u.index[e]));
        assert_solves_as_a_new_factor(&s, r, &u, weight);
        free_vectors(&u);
    }
    sn_low_rank_destroy(r);
    sn_low_rank_destroy(NULL);
    free_system(&s);
}

/* What is missing of a right-hand side at the unknowns of columns is added without a half solve. */
static void rests_are_added(void **state)
{
    (void)state;
    system_of s = made_system(7);
    sn_low_rank *r = NULL;
    vectors u = made_vectors(&s, 60, 9), b = made_vectors(&s, 200, 2);
    const double weight[] = {1, 2, -0.01, 3, 1, 2, 4, 5, 6};
    assert_int_equal(sn_low_rank_create(&r, s.c, NULL), SN_OK);
    assert_int_equal(sn_low_rank_set(r, &(sn_low_rank_terms){u.v, weight, NULL, 0}, NULL, NULL), SN_OK);
    size_t width = (size_t)sn_low_rank_columns(r)->width, n = (size_t)s.n;
    double *rest = calloc(2 * width, sizeof *rest), *x = malloc(2 * n * sizeof *x), *want = dense_of(&s, &b);
    for (size_t j = 0; j < 2; j++)
        for (size_t k = j; k < width; k += 3) {
            rest[j * width + k] = 0.1 * (double)k - 0.5;
            want[j * n + (size_t)sn_low_rank_columns(r)->unknown[k]] += rest[j * width + k];
        }
    free(solve_changed(&s, r, &b, rest, x));
    change_matrix(&s, &u, weight);
    assert_int_equal(sn_cholesky_factorize(s.c, &s.a, NULL, NULL), SN_OK);
    assert_int_equal(sn_cholesky_solve(s.c, want, 2, NULL, NULL), SN_OK);
    assert_same(x, want, 2 * n, 1e-11);
    sn_low_rank_destroy(r);
    free_vectors(&u);
    free_vectors(&b);
    free_system(&s);
    free(rest);
    free(want);
    free(x);
}

/* What was added may be taken away; what makes the matrix singular is said. */
static void terms_that_take_away(void **state)
{
    (void)state;
    system_of s = made_system(6);
    vectors u = made_vectors(&s, 40, 2), others = made_vectors(&s, 200, 3);
    const double add[] = {3.0, 2.0}, take[] = {-3.0, -2.0}, ones[] = {1, 1, 1};
    const sn_low_rank_terms taking = {u.v, take, NULL, 0}, adding = {others.v, ones, NULL, 0};
    change_matrix(&s, &u, add);
    assert_int_equal(sn_cholesky_factorize(s.c, &s.a, NULL, NULL), SN_OK);
    sn_low_rank *r = NULL;
    assert_int_equal(sn_low_rank_create(&r, s.c, NULL), SN_OK);
    assert_int_equal(sn_low_rank_set(r, &taking, NULL, NULL), SN_OK);
    assert_solves_as_a_new_factor(&s, r, &u, take);
    volatile sig_atomic_t cancel = 1;
    assert_int_equal(sn_low_rank_set(r, &adding, &(sn_run){.cancel = &cancel}, NULL), SN_ECANCEL);
    assert_int_equal(sn_low_rank_count(r), 0);
    assert_int_equal(sn_low_rank_set(r, &taking, NULL, NULL), SN_OK); /* taken up again */
    assert_solves_as_a_new_factor(&s, r, &u, take);
    sn_low_rank_destroy(r);
    free_vectors(&u);
    free_vectors(&others);
    free_system(&s);
}

/* One unknown, taken away whole: 1 + g m is 0 to the last bit. */
static void a_singular_change_is_refused(void **state)
{
    (void)state;
    system_of s = {.n = 1, .number = calloc(1, sizeof *s.number)};
    sn_low_rank *r = NULL;
    sn_error err = {.msg = ""};
    const int32_t ptr[] = {0, 1}, zero = 0;
    const double one = 1.0, minus_4 = -4.0;
    const sn_low_rank_terms terms = {{1, ptr, &zero, &one}, &minus_4, NULL, 0};
    s.a = (sn_csr){.n = 1,
                   .ptr = calloc(2, sizeof *s.a.ptr),
                   .idx = calloc(1, sizeof *s.a.idx),
                   .val = malloc(sizeof *s.a.val)};
    s.a.ptr[1] = 1;
    s.a.val[0] = 4.0;
    assert_int_equal(sn_cholesky_create(&s.c, &s.a, s.number, 1, NULL, NULL), SN_OK);
    assert_int_equal(sn_cholesky_factorize(s.c, &s.a, NULL, NULL), SN_OK);
    assert_int_equal(sn_low_rank_create(&r, s.c, NULL), SN_OK);
    assert_int_equal(sn_low_rank_set(r, &terms, NULL, &err), SN_ESOLVE);
    assert_string_equal(err.msg, "the dense matrix is singular (column 1 of 1)");
    assert_int_equal(sn_low_rank_count(r), 0);
    sn_low_rank_destroy(r);
    sn_cholesky_destroy(s.c);
    free(s.a.ptr);
    free(s.a.idx);
    free(s.a.val);
    free(s.number);
}

/* ---- half solves that are kept ---- */

/* What a place and the rest beside it make is the solution for b. */
static void assert_places(const sn_half_cache *h, const system_of *s, const vectors *b,
                          const sn_unit_columns *e, const sn_half_place *place, const double *rest)
{
    size_t n = (size_t)s->n, width = (size_t)e->width;
    double *x = dense_of(s, b), *got = malloc(n * sizeof *got);
    assert_int_equal(sn_cholesky_solve(s->c, x, b->v.n, NULL, NULL), SN_OK);
    for (size_t j = 0; j < (size_t)b->v.n; j++) {
        sn_half_term term[8];
        int32_t n_term = 0;
        assert_true(e->n_part <= 7);
        if (place[j].i_batch >= 0)
            term[n_term++] = (sn_half_term){.y = h->batch[place[j].i_batch].z, .pick = &place[j].column};
        for (int32_t p = 0; p < e->n_part; p++)
            term[n_term++] = (sn_half_term){
                .y = e->part[p].y, .factor = rest + j * width + e->part[p].first, .stride = e->width};
        assert_int_equal(sn_half_solve_finish(s->c, term, n_term, 1, &got, NULL, NULL, NULL), SN_OK);
        assert_same(got, x + j * n, n, 1e-12);
    }
    free(got);
    free(x);
}

static void need_half_solves(sn_half_cache *h, const system_of *s, const vectors *b, const uint64_t *key,
                             const sn_unit_columns *e, sn_half_place *place)
{
    double *rest = calloc((size_t)e->width * (size_t)b->v.n + 1, sizeof *rest);
    const sn_half_wanted w = {b->v, key, e, s->n};
    assert_int_equal(sn_half_cache_need(h, &w, NULL, place, rest, NULL), SN_OK);
    assert_places(h, s, b, e, place, rest);
    free(rest);
}

static void half_solves_are_kept(void **state)
{
    (void)state;
    system_of s = made_system(6);
    sn_half_cache h = {0};
    sn_unit_columns none = {.c = s.c};
    sn_half_place place[20];
    uint64_t key[20];
    vectors all = made_vectors(&s, 10, 20);
    for (uint64_t k = 0; k < 20; k++) key[k] = 100 + k;
    need_half_solves(&h, &s, &all, key, &none, place);
    assert_int_equal(h.n_batch, 1);
    for (int i = 0; i < 9; i++) { /* single ones come, and the large batch stays */
        const uint64_t other = 5;
        vectors one = made_vectors(&s, 100 + i, 1);
        need_half_solves(&h, &s, &one, &other, &none, place);
        assert_true(h.n_batch <= 4);
        free_vectors(&one);
        int32_t before = h.n_batch;
        need_half_solves(&h, &s, &all, key, &none, place);
        assert_int_equal(h.n_batch, before); /* all there */
        for (int k = 0; k < 20; k++) assert_true(place[k].i_batch >= 0);
    }
    sn_half_cache_free(&h);
    assert_int_equal(h.n_batch, 0);
    free_vectors(&all);
    free_system(&s);
}

/* One that differs only where there are columns needs no half solve; one of columns alone, no kept one. */
static void near_half_solves_serve(void **state)
{
    (void)state;
    system_of s = made_system(6);
    sn_half_cache h = {0};
    sn_unit_columns e = {.c = s.c};
    sn_half_place place[3];
    const uint64_t key[] = {1, 2, 3}, other = 9;
    int32_t column[4];
    vectors all = made_vectors(&s, 10, 3), near_one = made_vectors(&s, 10, 1),
            of_columns = made_vectors(&s, 10, 1);
    need_half_solves(&h, &s, &all, key, &e, place);
    assert_int_equal(near_one.ptr[1], 4);
    assert_int_equal(sn_unit_columns_need(&e, near_one.index, 2, column, NULL, NULL), SN_OK);
    near_one.value[1] += 0.3;
    need_half_solves(&h, &s, &near_one, key, &e, place);
    assert_int_equal(h.n_batch, 1);
    assert_int_equal(place[0].i_batch, 0);
    of_columns.v.n = 1;
    of_columns.ptr[1] = 2; /* the first two entries */
    need_half_solves(&h, &s, &of_columns, &other, &e, place);
    assert_int_equal(h.n_batch, 1);
    assert_int_equal(place[0].i_batch, -1);
    of_columns.ptr[1] = 0; /* nothing at all: no column is needed */
    sn_unit_columns_free(&e);
    sn_half_cache_free(&h);
    need_half_solves(&h, &s, &of_columns, &other, &e, place);
    assert_int_equal(h.n_batch, 0);
    need_half_solves(&h, &s, &all, key, &e, place);
    assert_int_equal(sn_unit_columns_need(&e, near_one.index, 2, column, NULL, NULL), SN_OK);
    near_one.value[3] += 0.3; /* has no column */
    need_half_solves(&h, &s, &near_one, key, &e, place);
    assert_int_equal(h.n_batch, 2);
    sn_half_cache_free(&h);
    sn_unit_columns_free(&e);
    free_vectors(&all);
    free_vectors(&near_one);
    free_vectors(&of_columns);
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
        cmocka_unit_test(branches_and_trunk_are_all),
        cmocka_unit_test(terms_come_and_go),
        cmocka_unit_test(rests_are_added),
        cmocka_unit_test(terms_that_take_away),
        cmocka_unit_test(a_singular_change_is_refused),
        cmocka_unit_test(half_solves_are_kept),
        cmocka_unit_test(near_half_solves_serve),
        cmocka_unit_test(gradients_find_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
