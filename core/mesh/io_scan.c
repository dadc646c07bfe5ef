/* io_scan.c - the scanner that all mesh readers share. */
#include "mesh/io_private.h"

#include "base/alloc.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

sn_status sn_scan_open(sn_scan *s, const char *path, char **data, sn_error *err)
{
    size_t size = 0;
    sn_status st = sn_file_read(path, data, &size, err);
    if (st) return st;
    *s = (sn_scan){.start = *data, .p = *data, .end = *data + size, .path = path};
    return SN_OK;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

static bool is_eol(char c)
{
    return c == '\n' || c == '\r';
}

/* p is at a '\n', "\r\n" or '\r'; returns what follows it. */
static const char *past_eol(const char *p, const char *end)
{
    return *p == '\r' && p + 1 < end && p[1] == '\n' ? p + 2 : p + 1;
}

static bool is_join(const sn_scan *s, const char *p)
{
    return s->has_joins && *p == '\\' && p + 1 < s->end && is_eol(p[1]);
}

void sn_scan_blanks(sn_scan *s)
{
    for (;;) {
        while (s->p < s->end && is_blank(*s->p)) s->p++;
        if (s->p >= s->end || !is_join(s, s->p)) return;
        s->p = past_eol(s->p + 1, s->end);
    }
}

static bool at_line_stop(const sn_scan *s)
{
    return s->p >= s->end || is_eol(*s->p) || (s->comment && *s->p == s->comment);
}

bool sn_scan_at_eol(sn_scan *s)
{
    sn_scan_blanks(s);
    return at_line_stop(s);
}

void sn_scan_next_line(sn_scan *s)
{
    while (s->p < s->end && !is_eol(*s->p)) s->p++;
    if (s->p < s->end) s->p = past_eol(s->p, s->end);
}

bool sn_scan_more(sn_scan *s)
{
    while (s->p < s->end && sn_scan_at_eol(s)) sn_scan_next_line(s);
    return s->p < s->end;
}

bool sn_scan_ends(const sn_scan *s)
{
    return at_line_stop(s) || is_blank(*s->p) || is_join(s, s->p);
}

static void seek(sn_scan *s)
{
    if (s->by_line)
        sn_scan_blanks(s);
    else
        (void)sn_scan_more(s);
}

sn_word sn_scan_word(sn_scan *s)
{
    seek(s);
    sn_word w = {s->p, 0};
    while (!sn_scan_ends(s)) s->p++;
    w.n = (size_t)(s->p - w.s);
    return w;
}

bool sn_word_is(sn_word w, const char *text)
{
    return strlen(text) == w.n && memcmp(w.s, text, w.n) == 0;
}

bool sn_word_is_nocase(sn_word w, const char *lower)
{
    if (strlen(lower) != w.n) return false;
    for (size_t i = 0; i < w.n; i++) {
        char c = w.s[i];
        if (c >= 'A' && c <= 'Z') c = (char)(c - 'A' + 'a');
        if (c != lower[i]) return false;
    }
    return true;
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

bool sn_scan_digits(sn_scan *s, int64_t *v)
{
    const char *p = s->p;
    bool is_negative = p < s->end && *p == '-';
    if (p < s->end && (*p == '-' || *p == '+')) p++;
    if (p >= s->end || !is_digit(*p)) return false;
    int64_t n = 0;
    for (; p < s->end && is_digit(*p); p++)
        n = n > (INT64_MAX - 9) / 10 ? INT64_MAX - 9 : 10 * n + (*p - '0');
    *v = is_negative ? -n : n;
    s->p = p;
    return true;
}

sn_status sn_scan_int(sn_scan *s, int64_t *v, const char *what, sn_error *err)
{
    seek(s);
    const char *word = s->p;
    if (sn_scan_digits(s, v) && sn_scan_ends(s)) return SN_OK;
    s->p = word;
    return sn_scan_want(s, what, err);
}

/* Most numbers in files have few digits: m * 10^e is then one correctly rounded operation on exact operands,
 * and the result has the bits that strtod gives (W. Clinger, How to read floating point numbers accurately,
 * 1990). NULL when the number is not of that kind. */
static const char *short_double(const char *p, const char *end, double *v)
{
    static const double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                   1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    bool is_negative = p < end && *p == '-', has_digits = false;
    if (p < end && (*p == '-' || *p == '+')) p++;
    uint64_t m = 0;
    int e = 0;
    for (; p < end && is_digit(*p); p++, has_digits = true) {
        m = 10 * m + (uint64_t)(*p - '0');
        if (m >> 53) return NULL;
    }
    if (p < end && *p == '.')
        for (p++; p < end && is_digit(*p); p++, has_digits = true) {
            m = 10 * m + (uint64_t)(*p - '0');
            if (m >> 53 || --e < -22) return NULL;
        }
    if (!has_digits) return NULL;
    if (p + 1 < end && (*p == 'e' || *p == 'E')) {
        bool is_small = *++p == '-';
        if (*p == '-' || *p == '+') p++;
        if (p >= end || !is_digit(*p)) return NULL;
        int x = 0;
        for (; p < end && is_digit(*p); p++)
            if ((x = 10 * x + (*p - '0')) > 99) return NULL;
        e += is_small ? -x : x;
    }
    if (e < -22 || e > 22) return NULL;
    double d = e < 0 ? (double)m / power[-e] : (double)m * power[e];
    *v = is_negative ? -d : d;
    return p;
}

sn_status sn_scan_number(sn_scan *s, double *v, const char *what, sn_error *err)
{
    seek(s);
    const char *word = s->p, *stop = short_double(s->p, s->end, v);
    if (!stop && !sn_scan_ends(s)) *v = sn_parse_double(s->p, &stop);
    if (stop && stop > word && stop <= s->end) {
        s->p = stop;
        if (sn_scan_ends(s)) return SN_OK;
        s->p = word;
    }
    return sn_scan_want(s, what, err);
}

sn_status sn_scan_point(sn_scan *s, double p[3], sn_error *err)
{
    for (int k = 0; k < 3; k++) {
        seek(s);
        const char *word = s->p;
        sn_status st = sn_scan_number(s, &p[k], "a coordinate", err);
        if (st) return st;
        if (!isfinite(p[k])) {
            s->p = word;
            return sn_scan_want(s, "a finite coordinate", err);
        }
    }
    return SN_OK;
}

/* Line ends before p, counting "\r\n" once. */
static long long line_of(const sn_scan *s)
{
    long long n = 1;
    for (const char *p = s->start; p < s->p; p = is_eol(*p) ? past_eol(p, s->end) : p + 1)
        if (is_eol(*p)) n++;
    return n;
}

sn_status sn_scan_fail(const sn_scan *s, sn_error *err, const char *fmt, ...)
{
    char text[320];
    va_list ap;
    va_start(ap, fmt);
    (void)vsnprintf(text, sizeof text, fmt, ap);
    va_end(ap);
    return sn_fail(err, SN_EFORMAT, "%s:%lld: %s", s->path, line_of(s), text);
}

void sn_word_show(char out[SN_SHOWN_SIZE], sn_word w)
{
    size_t max = SN_SHOWN_SIZE - 4, n = w.n < max ? w.n : max;
    while (n > 0 && n < w.n && ((unsigned char)w.s[n] & 0xC0) == 0x80) n--; /* not inside a UTF-8 character */
    for (size_t i = 0; i < n; i++) out[i] = (unsigned char)w.s[i] < 32 || w.s[i] == 127 ? '?' : w.s[i];
    memcpy(out + n, n < w.n ? "..." : "", n < w.n ? 4 : 1);
}

sn_status sn_scan_want(const sn_scan *s, const char *what, sn_error *err)
{
    if (s->p >= s->end) return sn_scan_fail(s, err, "need %s, found the end of the file", what);
    if (at_line_stop(s)) return sn_scan_fail(s, err, "need %s, found the end of the line", what);
    sn_scan word = *s;
    word.by_line = true;
    char found[SN_SHOWN_SIZE];
    sn_word_show(found, sn_scan_word(&word));
    return sn_scan_fail(s, err, "need %s, found '%s'", what, found);
}

size_t sn_number_size(sn_number_type type)
{
    static const size_t size[SN_NO_NUMBER] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return size[type];
}

double sn_number_decode(const void *p, sn_number_type type, bool is_big)
{
    const unsigned char *byte = p;
    uint64_t u = 0;
    size_t n = sn_number_size(type);
    for (size_t k = 0; k < n; k++) u |= (uint64_t)byte[is_big ? n - 1 - k : k] << 8 * k;
    float f;
    double d;
    uint32_t low = (uint32_t)u;
    switch (type) {
    case SN_I8:
        return (double)(int8_t)u;
    case SN_I16:
        return (double)(int16_t)u;
    case SN_I32:
        return (double)(int32_t)u;
    case SN_I64:
        return (double)(int64_t)u;
    case SN_F32:
        memcpy(&f, &low, sizeof f);
        return (double)f;
    case SN_F64:
        memcpy(&d, &u, sizeof d);
        return d;
    default:
        return (double)u;
    }
}
