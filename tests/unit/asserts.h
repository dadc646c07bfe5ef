/* asserts.h - what cmocka does not assert: numbers and places to a tolerance, and what an error says. */
#ifndef SN_TESTS_ASSERTS_H
#define SN_TESTS_ASSERTS_H

#include "base/status.h"
#include "base/vec3.h"

#include <string.h>

#define assert_near(a, b, tolerance)                                                                         \
    do {                                                                                                     \
        double a_ = (a), b_ = (b);                                                                           \
        if (!(fabs(a_ - b_) <= (tolerance)))                                                                 \
            fail_msg("%.17g is not %.17g to %g", a_, b_, (double)(tolerance));                               \
    } while (0)
#define assert_at(p, q, tolerance) assert_near(sn_v3_dist(p, q), 0.0, tolerance)
#define assert_says(err, text)                                                                               \
    do {                                                                                                     \
        if (!strstr((err).msg, text)) fail_msg("\"%s\" does not say \"%s\"", (err).msg, text);               \
    } while (0)
/* Calls that report into &err, which these make. */
#define assert_error(call, text)                                                                             \
    do {                                                                                                     \
        sn_error err = {.msg = ""};                                                                          \
        assert_int_not_equal((call), SN_OK);                                                                 \
        if (!strstr(err.msg, text)) fail_msg("\"%s\" does not say \"%s\"", err.msg, text);                   \
    } while (0)
#define ok(call)                                                                                             \
    do {                                                                                                     \
        sn_error err = {.msg = ""};                                                                          \
        if (call) fail_msg("%s", err.msg);                                                                   \
    } while (0)

#endif
