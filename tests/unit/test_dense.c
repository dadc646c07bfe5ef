/* test_dense - small dense systems. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/dense.h"

#include <math.h>
#include <string.h>

/* 4 x + y = 6, x + 3 y = 7 has (1, 2); with (9, 5) it has (2, 1). */
static void solves_by_hand(void **state)
{
    (void)state;
    double a[] = {4, 1, 1, 3}, x[] = {6, 7, 9, 5};
    const double want[] = {1, 2, 2, 1};
    assert_int_equal(sn_dense_solve_spd(a, 2, x, 2, NULL), SN_OK);
    for (int i = 0; i < 4; i++) assert_true(fabs(x[i] - want[i]) < 1e-14);
}

static void names_the_column(void **state)
{
    (void)state;
    sn_error err;
    double a[] = {1, 2, 2, 1}, x[] = {1, 1};
    assert_int_equal(sn_dense_solve_spd(a, 2, x, 1, &err), SN_ESOLVE);
    assert_string_equal(err.msg, "the dense matrix is not positive definite (column 2 of 2)");
}

/* Rows (1, 2, 3) and (0, 1, -1). */
static void adds_a_gram_matrix(void **state)
{
    (void)state;
    const double r[] = {1, 2, 3, 0, 1, -1}, want[] = {2, 2, 3, 2, 6, 5, 3, 5, 11};
    double a[] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, before[9];
    sn_dense_add_gram(r, 2, 3, a);
    for (int i = 0; i < 9; i++) assert_true(a[i] == want[i]);
    memcpy(before, a, sizeof a);
    sn_dense_add_gram(r, 0, 3, a);
    assert_memory_equal(a, before, sizeof a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(solves_by_hand), cmocka_unit_test(names_the_column),
                                       cmocka_unit_test(adds_a_gram_matrix)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
