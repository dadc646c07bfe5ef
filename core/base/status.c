#include "base/status.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

sn_status sn_fail(sn_error *err, sn_status code, const char *fmt, ...)
{
    if (err) {
        va_list ap;
        va_start(ap, fmt);
        err->code = code;
        (void)vsnprintf(err->msg, sizeof err->msg, fmt, ap);
        va_end(ap);
    }
    return code;
}

sn_status sn_fail_prefix(sn_error *err, sn_status code, const char *fmt, ...)
{
    if (err) {
        char old[sizeof err->msg];
        memcpy(old, err->msg, sizeof old);
        va_list ap;
        va_start(ap, fmt);
        int n = vsnprintf(err->msg, sizeof err->msg, fmt, ap);
        va_end(ap);
        err->code = code;
        if (n >= 0 && (size_t)n < sizeof err->msg)
            (void)snprintf(err->msg + n, sizeof err->msg - (size_t)n, "%s", old);
    }
    return code;
}
