/* temp_folder.h - a folder under /tmp for the files of a test. For the main file of a test, which defines
 * _DEFAULT_SOURCE (mkdtemp) before anything else and gives make_folder and remove_folder to its group. */
#ifndef SN_TEST_TEMP_FOLDER_H
#define SN_TEST_TEMP_FOLDER_H

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/alloc.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[] = "/tmp/sn_test_XXXXXX";

/* The path of a file in the folder, until the next call. */
static inline const char *in_folder(const char *name)
{
    static char path[512];
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static inline int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

/* Files that a failed writer left behind count, too. */
static inline int count_files(void)
{
    int n = 0;
    DIR *d = opendir(folder);
    for (struct dirent *e; (e = readdir(d));) n += e->d_name[0] != '.';
    (void)closedir(d);
    return n;
}

static inline int remove_folder(void **state)
{
    (void)state;
    DIR *d = opendir(folder);
    for (struct dirent *e; (e = readdir(d));)
        if (e->d_name[0] != '.') (void)remove(in_folder(e->d_name));
    (void)closedir(d);
    return rmdir(folder);
}

static inline void put_file(const char *name, const void *data, size_t size)
{
    FILE *f = fopen(in_folder(name), "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(data, 1, size, f), size);
    assert_int_equal(fclose(f), 0);
}

static inline void put_text(const char *name, const char *text)
{
    put_file(name, text, strlen(text));
}

/* The contents, with a 0 behind; the caller's to sn_release. */
static inline char *file_text(const char *name)
{
    FILE *f = fopen(in_folder(name), "rb");
    assert_non_null(f);
    assert_int_equal(fseek(f, 0, SEEK_END), 0);
    size_t size = (size_t)ftell(f);
    rewind(f);
    char *text = SN_NEW(char, size + 1);
    assert_non_null(text);
    assert_int_equal(fread(text, 1, size, f), size);
    assert_int_equal(fclose(f), 0);
    text[size] = '\0';
    return text;
}

#endif
