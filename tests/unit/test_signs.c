/* test_signs - exact signs of determinants: against GMP, with real tiny shifts in place of the symbolic ones.
 */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "extract/signs.h"

#include "made_mesh.h"

#include <gmp.h>

#define N_ID 12
#define SHIFT_BITS                                                                                           \
    160 /* d_i = 2^(-160 (i + 1)): a coefficient is an integer below 2^95, so each shift outweighs the next  \
         */

/* ---- the reference ---- */

typedef struct matrix {
    mpz_t at[4][4];
} matrix;

/* Sum over permutations, the slow plain way. */
static int reference_sign(matrix *m, int n)
{
    static const int factorial[5] = {1, 1, 2, 6, 24};
    mpz_t sum, term;
    mpz_inits(sum, term, NULL);
    for (int code = 0; code < factorial[n]; code++) {
        int left[4] = {0, 1, 2, 3}, rest = code, sign = 1;
        mpz_set_si(term, 1);
        for (int r = 0; r < n; r++) {
            int pick = rest % (n - r);
            rest /= n - r;
            if (pick % 2) sign = -sign; /* pick columns left of it are still to come: so many inversions */
            mpz_mul(term, term, m->at[r][left[pick]]);
            for (int k = pick; k + 1 < n - r; k++) left[k] = left[k + 1];
        }
        if (sign > 0)
            mpz_add(sum, sum, term);
        else
            mpz_sub(sum, sum, term);
    }
    int s = mpz_sgn(sum);
    mpz_clears(sum, term, NULL);
    return s;
}

/* The rows with d_base - d_id added to every entry; all times 2^(SHIFT_BITS N_ID), which keeps them whole. */
static int shifted_sign(int32_t base, const int64_t row[4][4], const int32_t *id, int n)
{
    static matrix m;
    static bool is_ready;
    mpz_t shift, one;
    mpz_inits(shift, one, NULL);
    for (int k = 0; k < 16 && !is_ready; k++) mpz_init(m.at[k / 4][k % 4]);
    is_ready = true;
    for (int r = 0; r < n; r++) {
        mpz_set_si(one, 1);
        mpz_mul_2exp(shift, one, (mp_bitcnt_t)(SHIFT_BITS * (N_ID - (base + 1))));
        mpz_mul_2exp(one, one, (mp_bitcnt_t)(SHIFT_BITS * (N_ID - (id[r] + 1))));
        mpz_sub(shift, shift, one);
        for (int c = 0; c < n; c++) {
            mpz_set_si(m.at[r][c], (long)row[r][c]);
            mpz_mul_2exp(m.at[r][c], m.at[r][c], SHIFT_BITS * N_ID);
            mpz_add(m.at[r][c], m.at[r][c], shift);
        }
    }
    mpz_clears(shift, one, NULL);
    return reference_sign(&m, n);
}

static int our_sign(int32_t base, const int64_t row[4][4], const int32_t *id, int n)
{
    if (n == 2) return sn_sign2(base, row[0], row[1], id);
    if (n == 3) return sn_sign3(base, row[0], row[1], row[2], id);
    return sn_sign4(base, row[0], row[1], row[2], row[3], id);
}

/* ---- random rows ---- */

static uint64_t seed = 4101842887655102017u;

static int64_t below(int64_t n)
{
    return (int64_t)(made_random(&seed) * (double)n);
}

static int64_t entry(int64_t largest)
{
    return below(2 * largest + 1) - largest;
}

/* A base and n other tissues, all different, in any order. */
static int32_t pick_ids(int32_t *id, int n)
{
    int32_t all[N_ID];
    for (int i = 0; i < N_ID; i++) all[i] = i;
    for (int i = 0; i <= n; i++) {
        int k = i + (int)below(N_ID - i);
        int32_t swap = all[i];
        all[i] = all[k];
        all[k] = swap;
    }
    memcpy(id, all + 1, (size_t)n * sizeof *id);
    return all[0];
}

/* Turns rows into ones that depend on each other, fully or up to a little. */
static void spoil(int64_t row[4][4], int n, int how)
{
    int a = (int)below(n), b = (a + 1) % n;
    for (int c = 0; c < n; c++) {
        if (how == 1) row[a][c] = row[b][c];            /* equal                    */
        if (how == 2) row[a][c] = -row[b][c];           /* opposite                 */
        if (how == 3) row[a][c] = row[b][c] + entry(1); /* nearly equal             */
        if (how == 4) row[a][c] = row[a][0];            /* all entries equal        */
        if (how == 5) row[a][c] = 0;
        if (how == 6) row[a][c] = row[b][c] + row[a][0] / 2; /* a constant shift apart   */
        if (how == 7) row[c][0] = row[c][n - 1];             /* equal columns            */
        if (how == 8) row[a][c] = row[b][c] / 3;
    }
    for (int r = 0; r < n; r++)
        for (int c = 0; c < n; c++)
            if (how == 9) row[r][c] = row[r][0]; /* every function is constant: no shift helps */
}

static void compare(int n, int rounds)
{
    static const int64_t largest[] = {1, 2, 7, 1000, 1 << 20, (1 << 29) - 1};
    int zero = 0, by_shift = 0;
    for (int i = 0; i < rounds; i++) {
        int64_t row[4][4], big = largest[below(6)];
        int32_t id[4], base = pick_ids(id, n);
        for (int r = 0; r < n; r++)
            for (int c = 0; c < n; c++) row[r][c] = below(4) ? entry(big) : big * (below(2) ? 1 : -1);
        spoil(row, n, (int)below(12));
        for (int r = 0; r < n; r++) /* spoiling may leave the range: back to 29 bits and a sign */
            for (int c = 0; c < n; c++) {
                if (row[r][c] > (1 << 29) - 1) row[r][c] = (1 << 29) - 1;
                if (row[r][c] < 1 - (1 << 29)) row[r][c] = 1 - (1 << 29);
            }
        int want = shifted_sign(base, row, id, n);
        assert_int_equal(our_sign(base, row, id, n), want);
        zero += want == 0;
        sn_i128 plain = n == 2   ? sn_det2(row[0], row[1])
                        : n == 3 ? sn_det3(row[0], row[1], row[2])
                                 : sn_det4(row[0], row[1], row[2], row[3]);
        by_shift += plain == 0 && want != 0;
    }
    assert_true(by_shift > rounds / 20); /* the test does reach what it is about */
    assert_true(zero > 0);
}

/* ---- tests ---- */

static void signs_of_two_rows(void **state)
{
    (void)state;
    compare(2, 20000);
}

static void signs_of_three_rows(void **state)
{
    (void)state;
    compare(3, 20000);
}

static void signs_of_four_rows(void **state)
{
    (void)state;
    compare(4, 20000);
}

/* All matrices with entries -1, 0, 1 and all orders of the ids: 81 * 6 of two rows, 19683 * 24 of three. */
static void every_small_matrix(void **state)
{
    (void)state;
    for (int n = 2; n <= 3; n++) {
        int n_matrix = n == 2 ? 81 : 19683, n_order = n == 2 ? 6 : 24;
        for (int code = 0; code < n_matrix; code++)
            for (int order = n == 3 ? code % 5 : 0; order < n_order; order += n == 3 ? 5 : 1) {
                int64_t row[4][4];
                int32_t left[4] = {0, 1, 2, 3}, id[4];
                for (int k = 0, rest = code; k < n * n; k++, rest /= 3) row[k / n][k % n] = rest % 3 - 1;
                for (int k = 0, rest = order; k <= n; k++) {
                    int pick = rest % (n + 1 - k);
                    rest /= n + 1 - k;
                    id[k] = left[pick];
                    for (int j = pick; j < n - k; j++) left[j] = left[j + 1];
                }
                assert_int_equal(our_sign(id[n], row, id, n), shifted_sign(id[n], row, id, n));
            }
    }
}

/* By hand: f_0 - f_1 = (0, 0) and f_0 - f_2 = (1, -1). The determinant is 0; with shifts row 0 is the
 * constant d_0 - d_1 > 0, so the sign is that of d_0 (-1 - 1) < 0. With the base last, it is that of -d_0
 * (-2) > 0. */
static void a_small_case_by_hand(void **state)
{
    (void)state;
    const int64_t p[2] = {0, 0}, q[2] = {1, -1};
    assert_int_equal(sn_sign2(0, p, q, (int32_t[]){1, 2}), -1);
    assert_int_equal(sn_sign2(2, p, q, (int32_t[]){0, 1}), 1);
    assert_int_equal(sn_sign2(0, p, p, (int32_t[]){1, 2}), 0); /* constants: no crossing to speak of */
    const int64_t unit[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    assert_true(sn_det4(unit[0], unit[1], unit[2], unit[3]) == 1);
    assert_true(sn_det4(unit[1], unit[0], unit[2], unit[3]) == -1);
    assert_true(sn_det3(unit[0], unit[1], unit[2]) == 1);
    assert_true(sn_det2(unit[0], unit[1]) == 1);
}

static void the_lower_tissue_is_above_at_a_tie(void **state)
{
    (void)state;
    assert_int_equal(sn_sign_above(5, 3, 4, 0), 1);
    assert_int_equal(sn_sign_above(4, 0, 5, 3), -1);
    assert_int_equal(sn_sign_above(4, 0, 4, 3), 1);
    assert_int_equal(sn_sign_above(4, 3, 4, 0), -1);
    assert_int_equal(sn_sign_above(4, 3, 4, 3), 0);
    assert_int_equal(sn_sign64(INT64_MIN), -1);
    assert_int_equal(sn_sign64(0), 0);
    assert_int_equal(sn_sign128((sn_i128)1 << 126), 1);
    assert_int_equal(sn_sign128(-((sn_i128)1 << 126)), -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(signs_of_two_rows),    cmocka_unit_test(signs_of_three_rows),
        cmocka_unit_test(signs_of_four_rows),   cmocka_unit_test(every_small_matrix),
        cmocka_unit_test(a_small_case_by_hand), cmocka_unit_test(the_lower_tissue_is_above_at_a_tie),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
