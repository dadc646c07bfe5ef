#define _GNU_SOURCE
#include "base/file.h"

#include "base/alloc.h"
#include "base/number_bridge.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <float.h>
#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static locale_t c_locale;
static pthread_once_t c_locale_once = PTHREAD_ONCE_INIT;

static void make_c_locale(void)
{
    c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
}

double sn_parse_double(const char *s, const char **end)
{
    (void)pthread_once(&c_locale_once, make_c_locale);
    char *stop;
    double v = strtod_l(s, &stop, c_locale);
    *end = stop;
    return v;
}

/* By the C library: any number, but slowly. */
static int format_slowly(char buf[32], double v)
{
    (void)pthread_once(&c_locale_once, make_c_locale);
    locale_t old = uselocale(c_locale);
    int n = 0;
    for (int digits = 15; digits <= 17; digits++) {
        n = snprintf(buf, 32, "%.*g", digits, v);
        if (digits == 17 || strtod(buf, NULL) == v) break;
    }
    (void)uselocale(old);
    return n;
}

/* As printf's %g lays n digits out for the precision of 15, or n when that is more. */
static char *write_digits(char *p, const char *digit, int n, int exponent)
{
    int precision = n > 15 ? n : 15;
    if (exponent < -4 || exponent >= precision) {
        *p++ = digit[0];
        if (n > 1) *p++ = '.';
        for (int i = 1; i < n; i++) *p++ = digit[i];
        *p++ = 'e';
        *p++ = exponent < 0 ? '-' : '+';
        int e = exponent < 0 ? -exponent : exponent;
        if (e >= 100) *p++ = (char)('0' + e / 100);
        *p++ = (char)('0' + e / 10 % 10);
        *p++ = (char)('0' + e % 10);
        return p;
    }
    if (exponent < 0) {
        *p++ = '0';
        *p++ = '.';
        for (int i = -1; i > exponent; i--) *p++ = '0';
    }
    for (int i = 0; i < n || i <= exponent; i++) {
        if (i > 0 && i == exponent + 1) *p++ = '.';
        *p++ = i < n ? digit[i] : '0';
    }
    return p;
}

/* Below a power of two numbers lie twice as dense as above it: the nearest number of 16 digits may then miss
 * v while another one reads back to it, and the two ways of writing differ. */
static bool is_power_of_two(double v)
{
    int e;
    return frexp(v, &e) == 0.5;
}

int sn_format_double(char buf[32], double v)
{
    char digit[SN_DIGITS_MAX], *p = buf;
    double size = fabs(v);
    if (size != 0.0 && !(size >= DBL_MIN && size <= DBL_MAX)) return format_slowly(buf, v);
    int exponent = 0, n = size > 0.0 ? sn_shortest_digits(size, digit, &exponent) : 0;
    if (n > 15 && is_power_of_two(size)) return format_slowly(buf, v);
    if (signbit(v)) *p++ = '-';
    if (n > 0)
        p = write_digits(p, digit, n, exponent);
    else
        *p++ = '0';
    *p = '\0';
    return (int)(p - buf);
}

static sn_status io_fail(sn_error *err, const char *path, const char *what, int code)
{
    return sn_fail(err, SN_EIO, "%s: cannot %s: %s", path, what, strerror(code));
}

/* Pipes and devices may never end, and a rename over them would replace them. */
static sn_status check_regular(const char *path, const char *what, const struct stat *info, sn_error *err)
{
    if (S_ISREG(info->st_mode)) return SN_OK;
    if (S_ISDIR(info->st_mode)) return io_fail(err, path, what, EISDIR);
    return sn_fail(err, SN_EIO, "%s: cannot %s: not a regular file", path, what);
}

/* Not blocking: a pipe that nobody writes to is refused, too. */
static FILE *open_regular(const char *path, size_t *size, sn_status *st, sn_error *err)
{
    struct stat info;
    int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    FILE *f = fd < 0 ? NULL : fdopen(fd, "rb");
    *st = f ? SN_OK : io_fail(err, path, "open", errno);
    if (!f && fd >= 0) (void)close(fd);
    if (!f) return NULL;
    if (fstat(fd, &info) != 0)
        *st = io_fail(err, path, "read", errno);
    else
        *st = check_regular(path, "read", &info, err);
    *size = *st ? 0 : (size_t)info.st_size;
    return f;
}

sn_status sn_file_read(const char *path, char **data, size_t *size, sn_error *err)
{
    size_t cap = 0, n = 0, expected;
    sn_status st;
    *data = NULL;
    *size = 0;
    FILE *f = open_regular(path, &expected, &st, err);
    if (!f) return st;
    if (st) goto done;
    for (;;) {
        size_t want = expected > 0 && n == 0 ? expected + 2 : n + n / 2 + 65536;
        if (!sn_grow(data, &cap, want, 1)) {
            st = sn_fail(err, SN_ENOMEM, "%s: no memory to read it", path);
            goto done;
        }
        size_t got = fread(*data + n, 1, cap - n - 1, f);
        n += got;
        if (got == 0) break;
    }
    if (ferror(f)) {
        st = io_fail(err, path, "read", errno ? errno : EIO);
        goto done;
    }
    (*data)[n] = '\0';
    *size = n;
done:
    (void)fclose(f);
    if (st) {
        sn_release(*data);
        *data = NULL;
    }
    return st;
}

void sn_file_extension(const char *path, char out[16])
{
    out[0] = '\0';
    const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
    if (!dot || strlen(dot + 1) >= 16) return;
    size_t i = 0;
    for (; dot[1 + i]; i++) out[i] = (char)tolower((unsigned char)dot[1 + i]);
    out[i] = '\0';
}

sn_status sn_dir_create(const char *path, sn_error *err)
{
    struct stat info;
    if (mkdir(path, 0777) == 0) return SN_OK;
    int code = errno;
    if (code == EEXIST && stat(path, &info) == 0 && S_ISDIR(info.st_mode)) return SN_OK;
    return io_fail(err, path, "create the folder", code);
}

#define BUFFER_SIZE ((size_t)1 << 18)

struct sn_out {
    int fd;
    char *path;   /* as given, for messages */
    char *target; /* where links lead       */
    char *temp;
    char *buffer; /* BUFFER_SIZE, n_buffer of them waiting to be written */
    size_t n_buffer;
    int error; /* errno of the first failure, 0 when none */
    const sn_run *run;
    const char *step;
    double size, expected; /* bytes written so far, and in the end */
    sn_error stop;         /* its code is 0 until the run was stopped */
};

static void out_free(sn_out *o)
{
    sn_release(o->path);
    sn_release(o->target);
    sn_release(o->temp);
    sn_release(o->buffer);
    sn_release(o);
}

/* A random name beside the target with the rights that a plain new file would get. */
static int open_temp(char *temp)
{
    int fd = mkostemp(temp, O_CLOEXEC);
    if (fd < 0) return fd;
    mode_t mask = umask(0);
    (void)umask(mask);
    (void)fchmod(fd, 0666 & ~mask);
    return fd;
}

static sn_out *out_new(const char *path)
{
    sn_out *o = SN_NEW_ZERO(sn_out, 1);
    if (!o) return NULL;
    char *real = realpath(path, NULL); /* a link stays, what it leads to is replaced */
    o->path = sn_strdup(path);
    o->target = sn_strdup(real ? real : path);
    free(real);
    size_t n = o->target ? strlen(o->target) + 16 : 0;
    o->temp = sn_alloc(n, 1);
    o->buffer = sn_alloc(BUFFER_SIZE, 1);
    if (o->path && o->target && o->temp && o->buffer) {
        (void)snprintf(o->temp, n, "%s.XXXXXX", o->target);
        return o;
    }
    out_free(o);
    return NULL;
}

sn_status sn_out_open(sn_out **out, const char *path, sn_error *err)
{
    *out = NULL;
    struct stat info;
    if (stat(path, &info) == 0) {
        sn_status st = check_regular(path, "write", &info, err);
        if (st) return st;
    }
    sn_out *o = out_new(path);
    if (!o) return sn_fail(err, SN_ENOMEM, "%s: no memory to write it", path);
    o->fd = open_temp(o->temp);
    if (o->fd < 0) {
        sn_status st = io_fail(err, path, "write", errno);
        out_free(o);
        return st;
    }
    *out = o;
    return SN_OK;
}

void sn_out_watch(sn_out *o, const sn_run *run, const char *step, double expected)
{
    o->run = run;
    o->step = step;
    o->expected = expected;
}

bool sn_out_failed(const sn_out *o)
{
    return o->error != 0 || o->stop.code != SN_OK;
}

static void write_out(sn_out *o, const char *p, size_t size)
{
    while (size > 0 && !sn_out_failed(o)) {
        size_t piece = size < 4 * BUFFER_SIZE ? size : 4 * BUFFER_SIZE;
        double share = o->expected > 0.0 ? fmin(o->size / o->expected, 1.0) : -1.0;
        if (sn_run_step(o->run, o->step, share, &o->stop)) return;
        ssize_t n = write(o->fd, p, piece);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) {
            o->error = n < 0 ? errno : EIO;
            return;
        }
        p += n;
        size -= (size_t)n;
        o->size += (double)n;
    }
}

static void flush(sn_out *o)
{
    write_out(o, o->buffer, o->n_buffer);
    o->n_buffer = 0;
}

void sn_out_bytes(sn_out *o, const void *data, size_t size)
{
    if (size > BUFFER_SIZE - o->n_buffer) flush(o);
    if (size > BUFFER_SIZE) {
        write_out(o, data, size);
    } else if (size > 0) {
        memcpy(o->buffer + o->n_buffer, data, size);
        o->n_buffer += size;
    }
}

void sn_out_text(sn_out *o, const char *s)
{
    sn_out_bytes(o, s, strlen(s));
}

void sn_out_int(sn_out *o, int64_t v)
{
    char buf[24], *p = buf + sizeof buf;
    uint64_t u = v < 0 ? 0u - (uint64_t)v : (uint64_t)v;
    do {
        *--p = (char)('0' + u % 10);
        u /= 10;
    } while (u);
    if (v < 0) *--p = '-';
    sn_out_bytes(o, p, (size_t)(buf + sizeof buf - p));
}

void sn_out_double(sn_out *o, double v)
{
    char buf[32];
    int n = sn_format_double(buf, v);
    sn_out_bytes(o, buf, (size_t)n);
}

static const char base64_digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/* Two digits for each 12 bits. */
static char base64_pairs[4096][2];
static pthread_once_t base64_once = PTHREAD_ONCE_INIT;

static void make_base64_pairs(void)
{
    for (int i = 0; i < 4096; i++) {
        base64_pairs[i][0] = base64_digits[i >> 6];
        base64_pairs[i][1] = base64_digits[i & 63];
    }
}

/* The last one or two bytes. */
static void put_base64_rest(sn_out *o, const unsigned char *p, size_t left)
{
    unsigned v = (unsigned)p[0] << 16 | (left > 1 ? (unsigned)p[1] << 8 : 0u);
    char out[4] = {base64_digits[v >> 18], base64_digits[v >> 12 & 63],
                   left > 1 ? base64_digits[v >> 6 & 63] : '=', '='};
    sn_out_bytes(o, out, sizeof out);
}

void sn_out_base64(sn_out *o, const void *data, size_t size)
{
    const unsigned char *p = data;
    char block[4096];
    size_t n = 0, whole = size - size % 3;
    (void)pthread_once(&base64_once, make_base64_pairs);
    for (size_t i = 0; i < whole; i += 3) {
        unsigned v = (unsigned)p[i] << 16 | (unsigned)p[i + 1] << 8 | p[i + 2];
        memcpy(block + n, base64_pairs[v >> 12], 2);
        memcpy(block + n + 2, base64_pairs[v & 4095], 2);
        n += 4;
        if (n == sizeof block) {
            sn_out_bytes(o, block, n);
            n = 0;
        }
    }
    sn_out_bytes(o, block, n);
    if (whole < size) put_base64_rest(o, p + whole, size - whole);
}

sn_status sn_out_commit(sn_out *o, sn_error *err)
{
    flush(o);
    if (close(o->fd) != 0 && !o->error) o->error = errno;
    if (!sn_out_failed(o) && rename(o->temp, o->target) != 0) o->error = errno;
    sn_status st = SN_OK;
    if (sn_out_failed(o)) {
        (void)remove(o->temp);
        st = o->error ? io_fail(err, o->path, "write", o->error) : o->stop.code;
        if (!o->error && err) *err = o->stop;
    }
    out_free(o);
    return st;
}

void sn_out_abort(sn_out *o)
{
    if (!o) return;
    (void)close(o->fd);
    (void)remove(o->temp);
    out_free(o);
}
