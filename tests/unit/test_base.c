/* test_base - errors, memory, files, notes, runs and child processes. */
#define _GNU_SOURCE
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/alloc.h"
#include "base/array.h"
#include "base/child.h"
#include "base/file.h"
#include "base/notes.h"
#include "base/run.h"

#include <dirent.h>
#include <fcntl.h>
#include <float.h>
#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "made_mesh.h"

static char folder[64];

static const char *in_folder(const char *name)
{
    static char path[4][160];
    static int next;
    char *p = path[next++ % 4];
    (void)snprintf(p, sizeof path[0], "%s/%s", folder, name);
    return p;
}

static int make_folder(void **state)
{
    (void)state;
    (void)snprintf(folder, sizeof folder, "/tmp/test_base.XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    char command[128];
    (void)snprintf(command, sizeof command, "rm -rf '%s'", folder);
    return system(command);
}

static int files_in_folder(void)
{
    DIR *d = opendir(folder);
    assert_non_null(d);
    int n = 0;
    for (const struct dirent *e; (e = readdir(d));) n += e->d_name[0] != '.';
    (void)closedir(d);
    return n;
}

static void write_file(const char *path, const char *text)
{
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(text, 1, strlen(text), f), strlen(text));
    assert_int_equal(fclose(f), 0);
}

static void assert_file(const char *path, const char *text)
{
    char *data;
    size_t size;
    assert_int_equal(sn_file_read(path, &data, &size, NULL), SN_OK);
    assert_int_equal(size, strlen(text));
    assert_string_equal(data, text);
    sn_release(data);
}

/* ---- status ---- */

static void failing_fills_the_error(void **state)
{
    (void)state;
    sn_error err;
    assert_int_equal(sn_fail(&err, SN_EMESH, "face %d of '%s'", 7, "femur"), SN_EMESH);
    assert_int_equal(err.code, SN_EMESH);
    assert_string_equal(err.msg, "face 7 of 'femur'");
    assert_int_equal(sn_fail(NULL, SN_EIO, "nobody reads %d", 1), SN_EIO);
    assert_int_equal(sn_fail_prefix(&err, SN_EINVAL, "bone %d: ", 2), SN_EINVAL);
    assert_int_equal(err.code, SN_EINVAL);
    assert_string_equal(err.msg, "bone 2: face 7 of 'femur'");
    assert_int_equal(sn_fail_prefix(NULL, SN_EINVAL, "x"), SN_EINVAL);
}

static void long_messages_are_cut(void **state)
{
    (void)state;
    char text[2000];
    memset(text, 'a', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    sn_error err;
    (void)sn_fail(&err, SN_EINVAL, "%s", text);
    assert_int_equal(strlen(err.msg), sizeof err.msg - 1);
    (void)sn_fail_prefix(&err, SN_EINVAL, "head: ");
    assert_int_equal(strlen(err.msg), sizeof err.msg - 1);
    assert_memory_equal(err.msg, "head: aaaa", 10);
    (void)sn_fail_prefix(&err, SN_EINVAL, "%s", text); /* nothing of the old message is left */
    assert_int_equal(strlen(err.msg), sizeof err.msg - 1);
    assert_int_equal(err.msg[0], 'a');
}

/* ---- memory ---- */

static void sizes_that_overflow_give_no_block(void **state)
{
    (void)state;
    volatile size_t half = SIZE_MAX / 2 + 1;
    assert_null(sn_alloc(half, 2));
    assert_null(sn_alloc_zero(half, 2));
    assert_null(sn_alloc(SIZE_MAX, SIZE_MAX));
    char *p = sn_strdup("stays");
    assert_null(sn_realloc(p, half, 2));
    assert_string_equal(p, "stays");
    size_t cap = 6;
    assert_false(sn_grow(&p, &cap, SIZE_MAX / 8, 16));
    assert_string_equal(p, "stays");
    assert_int_equal(cap, 6);
    sn_release(p);
    p = sn_alloc(0, 8);
    assert_non_null(p);
    sn_release(p);
    sn_release(NULL);
}

static void growing_keeps_the_contents(void **state)
{
    (void)state;
    int32_t *p = NULL;
    size_t cap = 0, grown = 0;
    for (int32_t i = 0; i < 10000; i++) {
        size_t before = cap;
        assert_true(sn_grow(&p, &cap, (size_t)i + 1, sizeof *p));
        assert_true(cap >= (size_t)i + 1);
        if (cap != before) assert_true(cap >= before + before / 2);
        grown += cap != before;
        p[i] = 3 * i;
    }
    for (int32_t i = 0; i < 10000; i++) assert_int_equal(p[i], 3 * i);
    assert_true(grown < 20); /* by halves: log(10000 / 16) / log(1.5) = 16 times */
    int32_t *same = p;
    assert_true(sn_grow(&p, &cap, 5, sizeof *p));
    assert_ptr_equal(p, same);
    sn_release(p);
}

static void allocator_is_used_for_everything(void **state)
{
    (void)state;
    ration r = {3, 0};
    sn_set_allocator(RATION(r));
    int *zero = sn_alloc_zero(100, sizeof *zero);
    char *text = sn_strdup("abc");
    assert_non_null(zero);
    for (int i = 0; i < 100; i++) assert_int_equal(zero[i], 0);
    assert_int_equal(r.in_use, 2);
    text = sn_realloc(text, 8, 1);
    assert_string_equal(text, "abc");
    assert_null(sn_alloc(1, 1));
    assert_null(sn_strdup("x"));
    assert_null(sn_realloc(text, 16, 1));
    sn_release(zero);
    sn_release(text);
    assert_int_equal(r.in_use, 0);
    sn_set_allocator(NULL);
}

static void narrowing_tells_what_does_not_fit(void **state)
{
    (void)state;
    bool ok = true;
    assert_int_equal(sn_to_i32(INT32_MAX, &ok), INT32_MAX);
    assert_true(ok);
    assert_int_equal(sn_to_i32((size_t)INT32_MAX + 1, &ok), 0);
    assert_false(ok);
    assert_int_equal(sn_to_i32(5, &ok), 5);
    assert_false(ok); /* never set again */
}

static int int_less(const void *a, const void *b)
{
    const int *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

static void sorting(void **state)
{
    (void)state;
    int v[1000];
    uint64_t h = 5;
    for (int i = 0; i < 1000; i++) v[i] = (int)(1e6 * made_random(&h));
    sn_sort(v, 1000, sizeof *v, int_less);
    for (int i = 1; i < 1000; i++) assert_true(v[i - 1] <= v[i]);
    sn_sort(NULL, 0, sizeof *v, int_less);
    for (int i = 0; i < 27; i++) { /* all triples of 0, 1, 2 */
        int32_t t[3] = {i / 9, i / 3 % 3, i % 3}, sum = t[0] + t[1] + t[2],
                squares = t[0] * t[0] + t[1] * t[1] + t[2] * t[2];
        sn_sort3(t);
        assert_true(t[0] <= t[1] && t[1] <= t[2]);
        assert_int_equal(t[0] + t[1] + t[2], sum);
        assert_int_equal(t[0] * t[0] + t[1] * t[1] + t[2] * t[2], squares);
    }
}

static int u64_less(const void *a, const void *b)
{
    const uint64_t *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

static void sorting_distinct_keys(void **state)
{
    (void)state;
    static uint64_t key[5000], tmp[5000], slow[5000];
    const uint64_t masks[] = {0, 1, 0xff, 0x3ff000, 0xffffffffffff, UINT64_MAX, (uint64_t)1 << 63};
    uint64_t h = 17;
    for (size_t k = 0; k < sizeof masks / sizeof *masks; k++)
        for (size_t n = 0; n <= 5000; n = 7 * n + 1) {
            for (size_t i = 0; i < n; i++) {
                (void)made_random(&h);
                key[i] = slow[i] = h & masks[k];
            }
            qsort(slow, n, sizeof *slow, u64_less);
            size_t want = 0;
            for (size_t i = 0; i < n; i++)
                if (i == 0 || slow[i] != slow[i - 1]) slow[want++] = slow[i];
            assert_int_equal(sn_sort_unique_u64(key, tmp, n), want);
            assert_memory_equal(key, slow, want * sizeof *key);
        }
}

/* ---- numbers ---- */

static uint64_t bits_of(double v)
{
    uint64_t u;
    memcpy(&u, &v, sizeof u);
    return u;
}

static void assert_round_trip(double v)
{
    char buf[32];
    const char *end;
    int n = sn_format_double(buf, v);
    assert_int_equal(n, strlen(buf));
    assert_null(strchr(buf, ','));
    double back = sn_parse_double(buf, &end);
    assert_ptr_equal(end, buf + n);
    assert_true(bits_of(back) == bits_of(v));
}

static void assert_text(double v, const char *want)
{
    char buf[32];
    (void)sn_format_double(buf, v);
    assert_string_equal(buf, want);
}

static void numbers_come_back_bit_by_bit(void **state)
{
    (void)state;
    const double special[] = {0.0,
                              -0.0,
                              1.0,
                              0.1,
                              -0.1,
                              1.0 / 3.0,
                              DBL_MAX,
                              -DBL_MAX,
                              DBL_MIN,
                              4.9e-324,
                              DBL_EPSILON,
                              1e22,
                              1e23,
                              123456789012345678.0,
                              9007199254740993.0,
                              INFINITY,
                              -INFINITY};
    for (size_t i = 0; i < sizeof special / sizeof *special; i++) assert_round_trip(special[i]);
    uint64_t h = 99;
    for (int i = 0; i < 20000; i++) {
        double v;
        (void)made_random(&h);
        memcpy(&v, &h, sizeof v);
        if (!isnan(v)) assert_round_trip(v);
    }
    assert_text(0.1, "0.1"); /* the shortest that comes back */
    assert_text(1.0, "1");
    assert_text(-2.5e-7, "-2.5e-07");
    assert_text(0.1 + 0.2, "0.30000000000000004");
    const char *end, *text = "nonsense";
    assert_true(isnan(sn_parse_double("nan", &end)));
    assert_true(sn_parse_double(text, &end) == 0.0);
    assert_ptr_equal(end, text);
    text = "1.5,7";
    assert_true(sn_parse_double(text, &end) == 1.5);
    assert_ptr_equal(end, text + 3);
}

/* A locale whose decimal point is a comma: the system's, or one that localedef makes. */
static locale_t comma_locale(void)
{
    const char *const names[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE"};
    locale_t l = (locale_t)0;
    for (size_t i = 0; i < 4 && !l; i++) l = newlocale(LC_ALL_MASK, names[i], (locale_t)0);
    if (l) return l;
    char command[256];
    (void)snprintf(command, sizeof command, "localedef -i de_DE -f UTF-8 %s >/dev/null 2>&1",
                   in_folder("de_DE.UTF-8"));
    if (system(command) != 0) return (locale_t)0;
    (void)setenv("LOCPATH", folder, 1);
    l = newlocale(LC_ALL_MASK, "de_DE.UTF-8", (locale_t)0);
    (void)unsetenv("LOCPATH");
    return l;
}

/* The text is that of printf with the fewest of 15, 16 and 17 digits that read back. */
static void assert_as_printf(double v)
{
    char buf[32], want[32];
    for (int digits = 15; digits <= 17; digits++) {
        (void)snprintf(want, sizeof want, "%.*g", digits, v);
        if (strtod(want, NULL) == v) break;
    }
    (void)sn_format_double(buf, v);
    if (strcmp(buf, want) != 0) fail_msg("%a: '%s', printf has '%s'", v, buf, want);
}

static void doubles_are_written_as_by_printf(void **state)
{
    (void)state;
    uint64_t h = 7;
    for (int e = -330; e <= 309; e++) { /* powers of ten and their neighbours, short numbers */
        char text[32];
        (void)snprintf(text, sizeof text, "1e%d", e);
        double v = strtod(text, NULL);
        if (!isfinite(v)) continue;
        assert_as_printf(v);
        assert_as_printf(nextafter(v, 0.0));
        assert_as_printf(nextafter(v, INFINITY));
        (void)snprintf(text, sizeof text, "-%de%d", (int)(1e6 * made_random(&h)), e);
        assert_as_printf(strtod(text, NULL));
    }
    for (int e = -1080; e <= 1023; e++) { /* numbers lie unevenly about a power of two */
        assert_as_printf(ldexp(1.0, e));
        assert_as_printf(nextafter(ldexp(1.0, e), 0.0));
        assert_as_printf(nextafter(ldexp(1.0, e), INFINITY));
    }
    for (int i = 0; i < 100000; i++) {
        double v;
        (void)made_random(&h);
        memcpy(&v, &h, sizeof v);
        if (isfinite(v)) assert_as_printf(v);
        assert_as_printf(made_random(&h) - 0.5);
        assert_as_printf(floor(1e9 * made_random(&h)) / 1000.0);
    }
}

static void commas_of_the_locale_do_not_matter(void **state)
{
    (void)state;
    locale_t comma = comma_locale();
    if (!comma) {
        print_message("no locale with a decimal comma to be had\n");
        skip();
    }
    locale_t old = uselocale(comma);
    char libc[32];
    (void)snprintf(libc, sizeof libc, "%g", 0.5);
    assert_string_equal(libc, "0,5"); /* the locale works */
    assert_text(0.5, "0.5");
    assert_round_trip(1234567.25);
    const char *end;
    assert_true(sn_parse_double("2.75", &end) == 2.75 && *end == '\0');
    sn_out *o;
    assert_int_equal(sn_out_open(&o, in_folder("comma"), NULL), SN_OK);
    sn_out_double(o, 1234.5);
    sn_out_text(o, " ");
    sn_out_int(o, 1234567);
    assert_int_equal(sn_out_commit(o, NULL), SN_OK);
    (void)snprintf(libc, sizeof libc, "%g", 0.5);
    assert_string_equal(libc, "0,5"); /* and is still in use */
    (void)uselocale(old);
    freelocale(comma);
    assert_file(in_folder("comma"), "1234.5 1234567");
    assert_int_equal(unlink(in_folder("comma")), 0);
}

/* ---- files ---- */

static void reading_files(void **state)
{
    (void)state;
    char *data;
    size_t size;
    sn_error err;
    FILE *f = fopen(in_folder("big"), "wb");
    for (int i = 0; i < 300000; i++) (void)fputc(i % 251, f);
    assert_int_equal(fclose(f), 0);
    assert_int_equal(sn_file_read(in_folder("big"), &data, &size, &err), SN_OK);
    assert_int_equal(size, 300000);
    for (int i = 0; i < 300000; i++) assert_int_equal((unsigned char)data[i], i % 251);
    assert_int_equal(data[size], 0);
    sn_release(data);
    write_file(in_folder("empty"), "");
    assert_file(in_folder("empty"), "");
    assert_int_equal(unlink(in_folder("big")), 0);
    assert_int_equal(unlink(in_folder("empty")), 0);
}

static void assert_unreadable(const char *path, const char *want)
{
    char *data = folder;
    size_t size = 3;
    sn_error err;
    assert_int_equal(sn_file_read(path, &data, &size, &err), SN_EIO);
    assert_null(data);
    assert_int_equal(size, 0);
    assert_memory_equal(err.msg, path, strlen(path));
    assert_string_equal(err.msg + strlen(path), want);
}

static void what_is_not_a_file_is_not_read(void **state)
{
    (void)state;
    assert_unreadable(in_folder("missing"), ": cannot open: No such file or directory");
    assert_unreadable(folder, ": cannot read: Is a directory");
    assert_unreadable("", ": cannot open: No such file or directory");
    assert_unreadable("/dev/zero", ": cannot read: not a regular file"); /* it would never end */
    const char *pipe = in_folder("pipe");
    assert_int_equal(mkfifo(pipe, 0600), 0);
    assert_unreadable(pipe, ": cannot read: not a regular file"); /* nobody writes: it would wait for ever */
    assert_int_equal(unlink(pipe), 0);
}

static void extensions(void **state)
{
    (void)state;
    const char *const want[][2] = {{"a.STL", "stl"},
                                   {"b", ""},
                                   {"/x.y/c", ""},
                                   {"d.tar.Gz", "gz"},
                                   {"/x.y/e.obj", "obj"},
                                   {"f.", ""},
                                   {"", ""},
                                   {"g.abcdefghijklmno", "abcdefghijklmno"},
                                   {"h.abcdefghijklmnop", ""},
                                   {"i.d/../j.Ply", "ply"}};
    char out[16];
    for (size_t i = 0; i < sizeof want / sizeof *want; i++) {
        sn_file_extension(want[i][0], out);
        assert_string_equal(out, want[i][1]);
    }
}

static void folders_are_made_once(void **state)
{
    (void)state;
    sn_error err;
    struct stat info;
    assert_int_equal(sn_dir_create(in_folder("sub"), &err), SN_OK);
    assert_int_equal(stat(in_folder("sub"), &info), 0);
    assert_true(S_ISDIR(info.st_mode));
    assert_int_equal(sn_dir_create(in_folder("sub"), &err), SN_OK);
    assert_int_equal(sn_dir_create(in_folder("no/such/parent"), &err), SN_EIO);
    assert_non_null(strstr(err.msg, "no/such/parent: cannot create the folder: No such file or directory"));
    write_file(in_folder("sub/file"), "x");
    assert_int_equal(sn_dir_create(in_folder("sub/file"), &err), SN_EIO);
    assert_non_null(strstr(err.msg, "cannot create the folder: File exists"));
    assert_int_equal(unlink(in_folder("sub/file")), 0);
    assert_int_equal(rmdir(in_folder("sub")), 0);
}

/* ---- output ---- */

static sn_out *opened(const char *path)
{
    sn_out *o = NULL;
    assert_int_equal(sn_out_open(&o, path, NULL), SN_OK);
    assert_non_null(o);
    return o;
}

static void output_appears_only_when_committed(void **state)
{
    (void)state;
    const char *path = in_folder("target");
    write_file(path, "old");
    sn_out *o = opened(path);
    for (int i = 0; i < 50000; i++) sn_out_text(o, "new text ");
    assert_file(path, "old");
    assert_int_equal(files_in_folder(), 2);
    sn_out_abort(o);
    assert_file(path, "old");
    assert_int_equal(files_in_folder(), 1);
    o = opened(path);
    sn_out_text(o, "new");
    assert_int_equal(sn_out_commit(o, NULL), SN_OK);
    assert_file(path, "new");
    assert_int_equal(files_in_folder(), 1);
    struct stat info;
    mode_t mask = umask(0);
    (void)umask(mask);
    assert_int_equal(stat(path, &info), 0);
    assert_int_equal(info.st_mode & 0777, 0666 & ~mask);
    sn_out_abort(NULL);
    assert_int_equal(unlink(path), 0);
}

static void output_writes_what_it_is_given(void **state)
{
    (void)state;
    const char *path = in_folder("target");
    sn_out *o = opened(path);
    const int64_t whole[] = {0, 7, -7, INT64_MAX, INT64_MIN};
    for (int i = 0; i < 5; i++) {
        sn_out_int(o, whole[i]);
        sn_out_text(o, " ");
    }
    sn_out_double(o, -1e-3);
    sn_out_bytes(o, "|x|", 3);
    sn_out_bytes(o, NULL, 0);
    assert_int_equal(sn_out_commit(o, NULL), SN_OK);
    assert_file(path, "0 7 -7 9223372036854775807 -9223372036854775808 -0.001|x|");
    assert_int_equal(unlink(path), 0);
}

static void base64_as_in_the_rfc(void **state)
{
    (void)state;
    const char *const want[][2] = {{"", ""},
                                   {"f", "Zg=="},
                                   {"fo", "Zm8="},
                                   {"foo", "Zm9v"},
                                   {"foob", "Zm9vYg=="},
                                   {"fooba", "Zm9vYmE="},
                                   {"foobar", "Zm9vYmFy"}};
    const char *path = in_folder("target");
    for (size_t i = 0; i < 7; i++) {
        sn_out *o = opened(path);
        sn_out_base64(o, want[i][0], strlen(want[i][0]));
        assert_int_equal(sn_out_commit(o, NULL), SN_OK);
        assert_file(path, want[i][1]);
    }
    static const unsigned char high[3] = {0xfb, 0xff, 0xbf};
    sn_out *o = opened(path);
    sn_out_base64(o, high, 3);
    assert_int_equal(sn_out_commit(o, NULL), SN_OK);
    assert_file(path, "+/+/");
    char *data, *zero = calloc(1, 10000);
    size_t size; /* longer than its block: 10000 bytes give 4 * ceil(10000 / 3) */
    o = opened(path);
    sn_out_base64(o, zero, 10000);
    assert_int_equal(sn_out_commit(o, NULL), SN_OK);
    assert_int_equal(sn_file_read(path, &data, &size, NULL), SN_OK);
    assert_int_equal(size, 13336);
    assert_int_equal(strspn(data, "A"), 13334);
    assert_string_equal(data + 13334, "==");
    sn_release(data);
    free(zero);
    assert_int_equal(unlink(path), 0);
}

static void output_that_cannot_be_written(void **state)
{
    (void)state;
    sn_error err;
    sn_out *o = (sn_out *)folder;
    assert_int_equal(sn_out_open(&o, in_folder("no/such/file"), &err), SN_EIO);
    assert_null(o);
    assert_non_null(strstr(err.msg, "no/such/file: cannot write: No such file or directory"));
    assert_int_equal(sn_out_open(&o, folder, &err), SN_EIO);
    assert_non_null(strstr(err.msg, ": cannot write: Is a directory"));
    /* Renaming over a device would replace it. */
    assert_int_equal(sn_out_open(&o, "/dev/null", &err), SN_EIO);
    assert_string_equal(err.msg, "/dev/null: cannot write: not a regular file");
    /* The target turns into a folder meanwhile: the rename fails, and nothing is left behind. */
    o = opened(in_folder("target"));
    sn_out_text(o, "x");
    assert_int_equal(mkdir(in_folder("target"), 0700), 0);
    assert_int_equal(sn_out_commit(o, &err), SN_EIO);
    assert_non_null(strstr(err.msg, "target: cannot write: Is a directory"));
    assert_int_equal(files_in_folder(), 1);
    assert_int_equal(rmdir(in_folder("target")), 0);
    assert_int_equal(files_in_folder(), 0);
}

static void output_through_a_link_keeps_the_link(void **state)
{
    (void)state;
    struct stat info;
    write_file(in_folder("real"), "old");
    assert_int_equal(symlink("real", in_folder("link")), 0);
    sn_out *o = opened(in_folder("link"));
    sn_out_text(o, "new");
    assert_int_equal(sn_out_commit(o, NULL), SN_OK);
    assert_file(in_folder("real"), "new");
    assert_int_equal(lstat(in_folder("link"), &info), 0);
    assert_true(S_ISLNK(info.st_mode));
    assert_int_equal(unlink(in_folder("link")), 0);
    assert_int_equal(unlink(in_folder("real")), 0);
}

static void files_without_memory(void **state)
{
    (void)state;
    write_file(in_folder("file"), "text");
    sn_status st = SN_ENOMEM;
    for (int n = 0; st; n++) {
        ration r = {n, 0};
        sn_error err;
        char *data = NULL;
        size_t size;
        sn_out *o = NULL;
        sn_set_allocator(RATION(r));
        st = sn_file_read(in_folder("file"), &data, &size, &err);
        if (!st) st = sn_out_open(&o, in_folder("out"), &err);
        if (st) assert_int_equal(st, SN_ENOMEM);
        if (st) assert_non_null(strstr(err.msg, ": no memory to "));
        sn_out_abort(o);
        sn_release(data);
        assert_int_equal(r.in_use, 0);
        assert_int_equal(files_in_folder(), 1);
        assert_true(n < 10);
    }
    sn_set_allocator(NULL);
    assert_int_equal(unlink(in_folder("file")), 0);
}

/* ---- notes ---- */

static void notes_keep_lines_in_order(void **state)
{
    (void)state;
    sn_notes notes = {0};
    for (int i = 0; i < 100; i++) sn_notes_add(&notes, "line %d", i);
    assert_int_equal(notes.n_line, 100);
    assert_string_equal(notes.line[0], "line 0");
    assert_string_equal(notes.line[99], "line 99");
    sn_notes_add(NULL, "dropped %d", 1);
    sn_notes_free(&notes);
    assert_int_equal(notes.n_line, 0);
    assert_null(notes.line);
    sn_notes_free(&notes);
    for (int n = 0; n < 2; n++) { /* the text, then the list */
        ration r = {n, 0};
        sn_set_allocator(RATION(r));
        sn_notes_add(&notes, "lost");
        assert_int_equal(notes.n_line, 0);
        assert_int_equal(r.in_use, 0);
        sn_set_allocator(NULL);
    }
}

/* ---- runs ---- */

typedef struct heard {
    int n;
    char step[32];
    double fraction;
} heard;

static void listen(void *user, const char *step, double fraction)
{
    heard *h = user;
    h->n++;
    (void)snprintf(h->step, sizeof h->step, "%s", step);
    h->fraction = fraction;
}

static void runs_report_and_stop(void **state)
{
    (void)state;
    sn_error err;
    assert_int_equal(sn_run_step(NULL, "waiting", 0.0, &err), SN_OK);
    assert_false(sn_run_stopped(NULL));
    assert_true(sn_run_threads(NULL) >= 1);
    assert_int_equal(sn_run_threads(&(sn_run){.n_threads = 3}), 3);
    heard h = {0};
    volatile sig_atomic_t cancel = 0;
    sn_run run = {.cancel = &cancel, .progress = listen, .user = &h};
    assert_true(sn_run_threads(&run) >= 1);
    assert_int_equal(sn_run_step(&run, "waiting", 0.25, &err), SN_OK);
    assert_int_equal(h.n, 1);
    assert_string_equal(h.step, "waiting");
    assert_true(h.fraction == 0.25);
    assert_false(sn_run_stopped(&run));
    run.deadline = sn_clock() + 1000.0;
    assert_int_equal(sn_run_step(&run, "waiting", 0.5, &err), SN_OK);
    assert_false(sn_run_stopped(&run));
    run.deadline = sn_clock() - 1e-3;
    assert_true(sn_run_stopped(&run));
    assert_int_equal(sn_run_step(&run, "waiting", 0.5, &err), SN_ELIMIT);
    assert_string_equal(err.msg, "time limit reached while waiting");
    cancel = 1; /* goes before the deadline */
    assert_true(sn_run_stopped(&run));
    assert_int_equal(sn_run_step(&run, "waiting", 0.5, &err), SN_ECANCEL);
    assert_string_equal(err.msg, "interrupted while waiting");
}

/* ---- children ---- */

static sn_status echo(void *user, sn_child_out *out, sn_error *err)
{
    (void)err;
    const size_t *n = user; /* n bytes counting up, in two pieces */
    unsigned char *p = malloc(*n ? *n : 1);
    for (size_t i = 0; i < *n; i++) p[i] = (unsigned char)(i * 7);
    sn_child_send(out, p, *n / 3);
    sn_child_send(out, p + *n / 3, *n - *n / 3);
    free(p);
    return SN_OK;
}

static const sn_child plain = {"testing", 10.0, 0, SN_EMESH};

static void child_sends_bytes(void **state)
{
    (void)state;
    const size_t sizes[] = {0, 1, 70000, 5000000};
    for (int i = 0; i < 4; i++) {
        char *data;
        size_t size, n = sizes[i];
        sn_error err;
        assert_int_equal(sn_child_run(&plain, echo, &n, NULL, &data, &size, &err), SN_OK);
        assert_int_equal(size, n);
        for (size_t k = 0; k < n; k++) assert_int_equal((unsigned char)data[k], (k * 7) & 255);
        sn_release(data);
    }
}

static sn_status fail_on_purpose(void *user, sn_child_out *out, sn_error *err)
{
    sn_child_send(out, "some", 4);
    return sn_fail(err, SN_ESOLVE, "no %s today", (const char *)user);
}

static sn_status crash(void *user, sn_child_out *out, sn_error *err)
{
    (void)out, (void)err;
    (void)signal(SIGSEGV, SIG_DFL); /* a sanitizer's handler would turn it into an exit code */
    (void)raise(*(int *)user);
    return SN_OK;
}

static sn_status leave(void *user, sn_child_out *out, sn_error *err)
{
    (void)user, (void)out, (void)err;
    _exit(9);
}

/* Runs fn and expects it to fail so. */
static void assert_child(const sn_child *opt, sn_status (*fn)(void *, sn_child_out *, sn_error *), void *user,
                         const sn_run *run, sn_status want, const char *message)
{
    char *data = folder;
    size_t size = 5;
    sn_error err;
    assert_int_equal(sn_child_run(opt, fn, user, run, &data, &size, &err), want);
    assert_int_equal(err.code, want);
    assert_string_equal(err.msg, message);
    assert_null(data);
    assert_int_equal(size, 0);
}

static void child_failures_come_back(void **state)
{
    (void)state;
    int segv = SIGSEGV, abort_signal = SIGABRT;
    assert_child(&plain, fail_on_purpose, "luck", NULL, SN_ESOLVE, "no luck today");
    assert_child(&plain, crash, &segv, NULL, SN_EMESH, "testing: crashed (Segmentation fault)");
    assert_child(&plain, crash, &abort_signal, NULL, SN_EMESH, "testing: crashed (Aborted)");
    assert_child(&plain, leave, NULL, NULL, SN_EMESH, "testing: ended with exit code 9");
    char *data;
    size_t size;
    assert_int_equal(sn_child_run(&plain, fail_on_purpose, "luck", NULL, &data, &size, NULL), SN_ESOLVE);
}

static sn_status hang(void *user, sn_child_out *out, sn_error *err)
{
    (void)out, (void)err;
    *(volatile int *)user = 1; /* its own copy */
    while (user) (void)pause();
    return SN_OK;
}

static void child_that_hangs_is_killed(void **state)
{
    (void)state;
    sn_child opt = {"testing", 0.15, 0, SN_EMESH};
    int touched = 0;
    double start = sn_clock();
    assert_child(&opt, hang, &touched, NULL, SN_ELIMIT, "testing: time limit of 0.15 s reached");
    assert_true(sn_clock() - start < 2.0);
    assert_int_equal(touched, 0);
    opt.time_limit = 0.0;
    sn_run late = {.deadline = sn_clock() + 0.1};
    assert_child(&opt, hang, &touched, &late, SN_ELIMIT, "time limit reached while testing");
    assert_int_equal(access("/proc/self/task", F_OK), 0);
}

static void cancel_soon(void *user, const char *step, double fraction)
{
    (void)step, (void)fraction;
    static int calls;
    if (++calls == 3) *(volatile sig_atomic_t *)user = 1;
}

static void child_can_be_cancelled(void **state)
{
    (void)state;
    volatile sig_atomic_t cancel = 0;
    sn_run run = {.cancel = &cancel, .progress = cancel_soon, .user = (void *)&cancel};
    int touched = 0;
    assert_child(&plain, hang, &touched, &run, SN_ECANCEL, "interrupted while testing");
}

static sn_status eat(void *user, sn_child_out *out, sn_error *err)
{
    size_t n = *(const size_t *)user;
    char *p = sn_alloc(n, 1);
    if (!p) return sn_fail(err, SN_ENOMEM, "no memory for the meal");
    sn_release(p);
    sn_child_send(out, "full", 4);
    return SN_OK;
}

static void child_memory_is_limited(void **state)
{
    (void)state;
    sn_child opt = {"testing", 10.0, (size_t)64 << 20, SN_EMESH};
    size_t n = (size_t)16 << 20;
    char *data;
    size_t size;
    assert_int_equal(sn_child_run(&opt, eat, &n, NULL, &data, &size, NULL), SN_OK);
    assert_int_equal(size, 4);
    sn_release(data);
#ifndef __SANITIZE_ADDRESS__ /* which stops at an allocation that fails */
    n = (size_t)256 << 20;
    assert_child(&opt, eat, &n, NULL, SN_ELIMIT,
                 "testing: memory limit of 64 MiB reached (no memory for the meal)");
    opt.memory_limit = 0;
    assert_int_equal(sn_child_run(&opt, eat, &n, NULL, &data, &size, NULL), SN_OK);
    sn_release(data);
#endif
}

/* A program started without standard streams has pipes with their numbers. */
static void child_without_standard_streams(void **state)
{
    (void)state;
    int in = dup(STDIN_FILENO), out = dup(STDOUT_FILENO);
    (void)fflush(stdout);
    (void)close(STDIN_FILENO);
    (void)close(STDOUT_FILENO);
    char *data;
    size_t size, n = 1000;
    sn_status st = sn_child_run(&plain, echo, &n, NULL, &data, &size, NULL);
    if (in >= 0) (void)dup2(in, STDIN_FILENO), (void)close(in);
    if (out >= 0) (void)dup2(out, STDOUT_FILENO), (void)close(out);
    assert_int_equal(st, SN_OK);
    assert_int_equal(size, 1000);
    sn_release(data);
}

static sn_status chat(void *user, sn_child_out *out, sn_error *err)
{
    (void)user, (void)out, (void)err;
    (void)printf("noise that nobody wants\n");
    (void)fflush(stdout);
    (void)fprintf(stderr, "noise\n");
    return SN_OK;
}

static void child_is_silent(void **state)
{
    (void)state;
    const char *path = in_folder("noise");
    (void)fflush(stdout);
    int keep = dup(STDOUT_FILENO), to = open(path, O_CREAT | O_WRONLY | O_TRUNC, 0600);
    assert_true(keep >= 0 && to >= 0);
    (void)dup2(to, STDOUT_FILENO);
    char *data;
    size_t size;
    sn_status st = sn_child_run(&plain, chat, NULL, NULL, &data, &size, NULL);
    (void)dup2(keep, STDOUT_FILENO);
    (void)close(keep);
    (void)close(to);
    assert_int_equal(st, SN_OK);
    sn_release(data);
    assert_file(path, "");
    assert_int_equal(unlink(path), 0);
}

static int open_descriptors(void)
{
    int n = 0;
    for (int fd = 0; fd < 256; fd++) n += fcntl(fd, F_GETFD) >= 0;
    return n;
}

static void children_leave_nothing_open(void **state)
{
    (void)state;
    int before = open_descriptors(), segv = SIGSEGV;
    char *data;
    size_t size, n = 10;
    for (int i = 0; i < 5; i++) {
        assert_int_equal(sn_child_run(&plain, echo, &n, NULL, &data, &size, NULL), SN_OK);
        sn_release(data);
        assert_int_equal(sn_child_run(&plain, crash, &segv, NULL, &data, &size, NULL), SN_EMESH);
    }
    assert_int_equal(open_descriptors(), before);
}

#define WITH_FOLDER(test) cmocka_unit_test_setup_teardown(test, make_folder, remove_folder)

/* ---- sn_run_each ---- */

typedef struct each_seen {
    int count[64]; /* how often each item was called */
    int n_threads[64];
    int32_t bad[2]; /* items that fail */
    bool has_progress;
    pthread_t caller; /* who alone may report */
} each_seen;

static each_seen all_good(bool has_progress)
{
    return (each_seen){.bad = {-1, -1}, .has_progress = has_progress, .caller = pthread_self()};
}

static sn_status see_item(void *user, int32_t i, const sn_run *run, sn_error *err)
{
    each_seen *s = user;
    s->count[i]++;
    s->n_threads[i] = sn_run_threads(run);
    assert_int_equal(run->progress != NULL, s->has_progress && pthread_equal(pthread_self(), s->caller));
    if (run->progress) run->progress(run->user, "seeing", 0.5);
    if (i == s->bad[0] || i == s->bad[1]) return sn_fail(err, SN_EINVAL, "item %d is bad", i);
    return SN_OK;
}

static void see_progress(void *user, const char *step, double fraction)
{
    double *last = user;
    assert_string_equal(step, "seeing");
    assert_true(fraction > 0.0 && fraction <= 1.0);
    *last = fraction;
}

static void each_item_is_called_once_and_the_first_error_is_given(void **state)
{
    (void)state;
    for (int threads = 1; threads <= 4; threads++)
        for (int n = 0; n <= 64; n += 16) {
            double last = 0.0;
            each_seen s = all_good(true);
            sn_run run = {.n_threads = threads, .progress = see_progress, .user = &last};
            sn_error err = {.msg = ""};
            assert_int_equal(sn_run_each(&run, n, see_item, &s, &err), SN_OK);
            for (int i = 0; i < 64; i++) assert_int_equal(s.count[i], i < n);
            for (int i = 0; i < n; i++) assert_int_equal(s.n_threads[i], 1); /* all cores have an item */
            if (threads == 1 && n > 0) assert_true(last == (n - 0.5) / n);   /* half of the last item */
            if (n == 0) continue;
            s = all_good(true);
            s.bad[0] = n - 1;
            s.bad[1] = n / 2;
            assert_int_equal(sn_run_each(&run, n, see_item, &s, &err), SN_EINVAL);
            char want[32];
            (void)snprintf(want, sizeof want, "item %d is bad", n / 2);
            assert_string_equal(err.msg, want);
            for (int i = 0; i < n; i++) assert_int_equal(s.count[i], 1);
        }
    each_seen s = all_good(false);
    assert_int_equal(sn_run_each(&(sn_run){.n_threads = 4}, 2, see_item, &s, NULL), SN_OK);
    assert_int_equal(s.n_threads[0], 2); /* two items share four threads */
    s = all_good(false);
    s.bad[0] = 0;
    assert_int_equal(sn_run_each(NULL, 1, see_item, &s, NULL), SN_EINVAL);
}

/* ---- sn_run_apart ---- */

typedef struct apart_job {
    atomic_bool may_end, has_ended;
    atomic_int n_left;
} apart_job;

static void wait_until_told(void *job)
{
    apart_job *j = job;
    const struct timespec moment = {.tv_nsec = 1000000};
    while (!atomic_load(&j->may_end)) (void)nanosleep(&moment, NULL);
    atomic_store(&j->has_ended, true);
}

static void count_left(void *job)
{
    apart_job *j = job;
    (void)atomic_fetch_add(&j->n_left, 1);
}

static void cancel_at_once(void *user, const char *step, double fraction)
{
    assert_string_equal(step, "waiting");
    assert_true(fraction < 0.0);
    *(volatile sig_atomic_t *)user = 1;
}

static void what_is_stopped_goes_on_apart(void **state)
{
    (void)state;
    static apart_job j; /* outlives the test in any case */
    volatile sig_atomic_t cancel = 0;
    sn_error err;
    const sn_run run = {.cancel = &cancel, .progress = cancel_at_once, .user = (void *)&cancel};
    atomic_store(&j.may_end, true);
    assert_int_equal(sn_run_apart(NULL, "waiting", wait_until_told, count_left, &j, &err), SN_OK);
    assert_true(atomic_load(&j.has_ended));
    assert_int_equal(sn_run_apart(&(sn_run){.deadline = sn_clock() + 1e4}, "waiting", wait_until_told,
                                  count_left, &j, &err),
                     SN_OK);
    assert_int_equal(atomic_load(&j.n_left), 0);
    atomic_store(&j.may_end, false);
    atomic_store(&j.has_ended, false);
    assert_int_equal(sn_run_apart(&run, "waiting", wait_until_told, count_left, &j, &err), SN_ECANCEL);
    assert_string_equal(err.msg, "interrupted while waiting");
    assert_false(atomic_load(&j.has_ended)); /* it came back before */
    assert_int_equal(sn_run_left_behind(), 1);
    atomic_store(&j.may_end, true);
    const struct timespec moment = {.tv_nsec = 1000000};
    while (sn_run_left_behind() > 0) (void)nanosleep(&moment, NULL);
    assert_true(atomic_load(&j.has_ended));
    assert_int_equal(atomic_load(&j.n_left), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_item_is_called_once_and_the_first_error_is_given),
        cmocka_unit_test(what_is_stopped_goes_on_apart),
        cmocka_unit_test(failing_fills_the_error),
        cmocka_unit_test(long_messages_are_cut),
        cmocka_unit_test(sizes_that_overflow_give_no_block),
        cmocka_unit_test(growing_keeps_the_contents),
        cmocka_unit_test(allocator_is_used_for_everything),
        cmocka_unit_test(narrowing_tells_what_does_not_fit),
        cmocka_unit_test(sorting),
        cmocka_unit_test(sorting_distinct_keys),
        cmocka_unit_test(numbers_come_back_bit_by_bit),
        cmocka_unit_test(doubles_are_written_as_by_printf),
        WITH_FOLDER(commas_of_the_locale_do_not_matter),
        WITH_FOLDER(reading_files),
        WITH_FOLDER(what_is_not_a_file_is_not_read),
        cmocka_unit_test(extensions),
        WITH_FOLDER(folders_are_made_once),
        WITH_FOLDER(output_appears_only_when_committed),
        WITH_FOLDER(output_writes_what_it_is_given),
        WITH_FOLDER(base64_as_in_the_rfc),
        WITH_FOLDER(output_that_cannot_be_written),
        WITH_FOLDER(output_through_a_link_keeps_the_link),
        WITH_FOLDER(files_without_memory),
        cmocka_unit_test(notes_keep_lines_in_order),
        cmocka_unit_test(runs_report_and_stop),
        cmocka_unit_test(child_sends_bytes),
        cmocka_unit_test(child_failures_come_back),
        cmocka_unit_test(child_that_hangs_is_killed),
        cmocka_unit_test(child_can_be_cancelled),
        cmocka_unit_test(child_memory_is_limited),
        cmocka_unit_test(child_without_standard_streams),
        WITH_FOLDER(child_is_silent),
        cmocka_unit_test(children_leave_nothing_open),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
