#include "base/names.h"

#include <string.h>

#define MAX_NAME 64

/* Edits between two names: insert, delete, replace, swap two neighbours (optimal string alignment). */
static size_t distance(const char *a, const char *b)
{
    size_t row[3][MAX_NAME + 1], n = strlen(b);
    if (n > MAX_NAME || strlen(a) > MAX_NAME) return SIZE_MAX;
    size_t *before = row[0], *last = row[1], *now = row[2];
    for (size_t j = 0; j <= n; j++) last[j] = j;
    for (size_t i = 0; a[i]; i++) {
        now[0] = i + 1;
        for (size_t j = 0; j < n; j++) {
            size_t best = last[j] + (a[i] != b[j]);
            if (last[j + 1] + 1 < best) best = last[j + 1] + 1;
            if (now[j] + 1 < best) best = now[j] + 1;
            if (i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j] && before[j - 1] + 1 < best)
                best = before[j - 1] + 1;
            now[j + 1] = best;
        }
        size_t *spare = before;
        before = last;
        last = now;
        now = spare;
    }
    return last[n];
}

const char *sn_nearest_name(const char *word, const char *const *name, size_t n)
{
    const char *best = NULL;
    size_t least =
        strlen(word) / 4 + 2; /* one edit in four letters and one more: farther away is no suggestion */
    for (size_t i = 0; i < n; i++) {
        size_t d = distance(word, name[i]);
        if (d < least && d < strlen(word)) {
            least = d;
            best = name[i];
        }
    }
    return best;
}

sn_status sn_check_name(const char *kind, const char *name, sn_error *err)
{
    size_t n = strlen(name);
    if (n == 0 || n > MAX_NAME)
        return sn_fail(err, SN_EINVAL, "name of a %s has %zu bytes, need 1 to %d", kind, n, MAX_NAME);
    for (size_t i = 0; i < n; i++)
        if ((unsigned char)name[i] < 32 || name[i] == '/' || name[i] == '"' || name[i] == 127)
            return sn_fail(err, SN_EINVAL, "name of %s '%.64s' holds '/', '\"' or a control character", kind,
                           name);
    if (strcmp(name, ".") == 0 || strcmp(name, "..") == 0)
        return sn_fail(err, SN_EINVAL, "'%s' is no name for a %s", name, kind);
    return SN_OK;
}

/* Index of word, or an error that suggests the nearest or says that there are none. */
sn_status sn_find_name(const char *kind, const char *word, const char *const *name, int32_t n, int32_t *index,
                       sn_error *err)
{
    for (int32_t i = 0; i < n; i++)
        if (strcmp(name[i], word) == 0) {
            *index = i;
            return SN_OK;
        }
    const char *near = sn_nearest_name(word, name, (size_t)n);
    if (near) return sn_fail(err, SN_EINVAL, "no %s '%.64s' (did you mean '%s'?)", kind, word, near);
    return sn_fail(err, SN_EINVAL, "no %s '%.64s' (the scene has %d)", kind, word, n);
}
