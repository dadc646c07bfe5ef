/* Names of the left and right side. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/side_name.h"

#include <string.h>

static void assert_swap(const char *left, const char *right)
{
    char out[64];
    assert_true(sn_side_name_swap(left, out, strlen(left) + SN_SIDE_NAME_EXTRA));
    assert_string_equal(out, right);
    assert_true(sn_side_name_swap(right, out, strlen(right) + SN_SIDE_NAME_EXTRA));
    assert_string_equal(out, left);
}

static void every_ending_swaps_both_ways(void **state)
{
    (void)state;
    assert_swap("biceps_l", "biceps_r");
    assert_swap("biceps_L", "biceps_R");
    assert_swap("biceps.l", "biceps.r");
    assert_swap("biceps.L", "biceps.R");
    assert_swap("biceps_left", "biceps_right");
    assert_swap("_l_r", "_l_l"); /* only the ending counts */
}

static void names_without_a_side_stay(void **state)
{
    static const char *const name[] = {
        "",  "fat",    "_l",      "_right",        ".R",      "gracilis", "femur",
        "l", "tibial", "rect_l2", "masseter_Left", "left_arm"};
    char out[64];
    (void)state;
    for (size_t i = 0; i < sizeof name / sizeof *name; i++) {
        assert_false(sn_side_name_swap(name[i], out, sizeof out));
        assert_string_equal(out, name[i]);
    }
}

static void a_small_room_cuts_the_name_off(void **state)
{
    char out[8] = "zzzzzzz";
    (void)state;
    assert_true(sn_side_name_swap("biceps_left", out, 5));
    assert_string_equal(out, "bice");
    assert_int_equal(out[5], 'z');
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_ending_swaps_both_ways),
        cmocka_unit_test(names_without_a_side_stay),
        cmocka_unit_test(a_small_room_cuts_the_name_off),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
