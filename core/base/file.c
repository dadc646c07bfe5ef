#define _GNU_SOURCE
#include "base/file.h"

#include "base/alloc.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <locale.h>
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

int sn_format_double(char buf[32], double v)
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

struct sn_out {
    FILE *f;
    char *path;   /* as given, for messages */
    char *target; /* where links lead       */
    char *temp;
    int error; /* errno of the first failure, 0 when none */
};

static void out_free(sn_out *o)
{
    sn_release(o->path);
    sn_release(o->target);
    sn_release(o->temp);
    sn_release(o);
}

/* A random name beside the target with the rights that a plain new file would get. */
static FILE *open_temp(char *temp)
{
    int fd = mkstemp(temp);
    if (fd < 0) return NULL;
    mode_t mask = umask(0);
    (void)umask(mask);
    (void)fchmod(fd, 0666 & ~mask);
    FILE *f = fdopen(fd, "wb");
    if (!f) (void)close(fd);
    return f;
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
    if (o->path && o->target && o->temp) {
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
    o->f = open_temp(o->temp);
    if (!o->f) {
        sn_status st = io_fail(err, path, "write", errno);
        out_free(o);
        return st;
    }
    (void)setvbuf(o->f, NULL, _IOFBF, 1 << 16);
    *out = o;
    return SN_OK;
}

void sn_out_bytes(sn_out *o, const void *data, size_t size)
{
    if (size > 0 && !o->error && fwrite(data, 1, size, o->f) != size) o->error = errno ? errno : EIO;
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

void sn_out_base64(sn_out *o, const void *data, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const unsigned char *p = data;
    char block[4096];
    size_t n = 0;
    for (size_t i = 0; i < size; i += 3) {
        size_t left = size - i;
        unsigned v = (unsigned)p[i] << 16;
        if (left > 1) v |= (unsigned)p[i + 1] << 8;
        if (left > 2) v |= p[i + 2];
        block[n++] = digits[v >> 18];
        block[n++] = digits[v >> 12 & 63];
        block[n++] = left > 1 ? digits[v >> 6 & 63] : '=';
        block[n++] = left > 2 ? digits[v & 63] : '=';
        if (n == sizeof block) {
            sn_out_bytes(o, block, n);
            n = 0;
        }
    }
    sn_out_bytes(o, block, n);
}

sn_status sn_out_commit(sn_out *o, sn_error *err)
{
    if (fflush(o->f) != 0 && !o->error) o->error = errno;
    if (fclose(o->f) != 0 && !o->error) o->error = errno;
    if (!o->error && rename(o->temp, o->target) != 0) o->error = errno;
    sn_status st = SN_OK;
    if (o->error) {
        (void)remove(o->temp);
        st = io_fail(err, o->path, "write", o->error);
    }
    out_free(o);
    return st;
}

void sn_out_abort(sn_out *o)
{
    if (!o) return;
    (void)fclose(o->f);
    (void)remove(o->temp);
    out_free(o);
}
