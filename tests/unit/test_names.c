/* test_names - names that users give and mistype. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/names.h"

#include <string.h>

static void assert_bad(const char *name, const char *text)
{
    sn_error err = {.msg = ""};
    assert_int_equal(sn_check_name("thing", name, &err), SN_EINVAL);
    if (!strstr(err.msg, text)) fail_msg("\"%s\" does not say \"%s\"", err.msg, text);
}

static void names_are_checked(void **state)
{
    (void)state;
    char name[80];
    memset(name, 'n', sizeof name);
    name[64] = '\0';
    assert_int_equal(sn_check_name("thing", name, NULL), SN_OK);
    assert_int_equal(sn_check_name("thing", "M. flexor \xc3\xa4.l (2)", NULL), SN_OK);
    assert_int_equal(sn_check_name("thing", "...", NULL), SN_OK);
    name[64] = 'n', name[65] = '\0';
    assert_bad(name, "name of a thing has 65 bytes, need 1 to 64");
    assert_bad("", "name of a thing has 0 bytes, need 1 to 64");
    assert_bad("a/b", "name of thing 'a/b' holds '/', '\"' or a control character");
    assert_bad("a\"b", "holds '/', '\"' or a control character");
    assert_bad("\tb", "holds '/', '\"' or a control character");
    assert_bad("b\x7f", "holds '/', '\"' or a control character");
    assert_bad(".", "'.' is no name for a thing");
    assert_bad("..", "'..' is no name for a thing");
}

/* One edit, and one more for each four letters of the word; two neighbours swapped are one edit. */
static void near_names_are_suggested(void **state)
{
    (void)state;
    static const char *const name[] = {"femur", "tibia", "fibula", "rib", "rib_pair"};
    static const struct {
        const char *word, *want;
    } pair[] = {{"femur", "femur"},       {"fmeur", "femur"},  {"femurs", "femur"}, {"emur", "femur"},
                {"tibai", "tibia"},       {"fibua", "fibula"}, {"rip", "rib"},      {"ribpair", "rib_pair"},
                {"rib_piar", "rib_pair"}, {"humerus", NULL},   {"x", NULL},         {"", NULL},
                {"fmru", "femur"},        {"pelvis", NULL}};
    for (size_t i = 0; i < sizeof pair / sizeof *pair; i++) {
        const char *got = sn_nearest_name(pair[i].word, name, 5);
        if (!pair[i].want && got) fail_msg("'%s' suggests '%s'", pair[i].word, got);
        if (pair[i].want) assert_string_equal(got, pair[i].want);
    }
    assert_null(sn_nearest_name("femur", name, 0));
    char long_word[100];
    memset(long_word, 'f', sizeof long_word);
    long_word[99] = '\0';
    assert_null(sn_nearest_name(long_word, name, 5));
}

static void names_are_found(void **state)
{
    (void)state;
    static const char *const name[] = {"femur", "tibia"};
    sn_error err = {.msg = ""};
    int32_t i = -3;
    assert_int_equal(sn_find_name("bone", "femru", name, 2, &i, &err), SN_EINVAL);
    assert_string_equal(err.msg, "no bone 'femru' (did you mean 'femur'?)");
    assert_int_equal(sn_find_name("bone", "skull", name, 2, &i, &err), SN_EINVAL);
    assert_string_equal(err.msg, "no bone 'skull' (the scene has 2)");
    assert_int_equal(i, -3);
    assert_int_equal(sn_find_name("bone", "tibia", name, 2, &i, &err), SN_OK);
    assert_int_equal(i, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_are_checked),
        cmocka_unit_test(near_names_are_suggested),
        cmocka_unit_test(names_are_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
