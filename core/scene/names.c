#include "scene/scene.h"

#include "base/alloc.h"
#include "scene/scene_private.h"

#include <string.h>

#define MAX_NAME 64

/* Levenshtein distance, bounded by the length of names. */
static size_t distance(const char *a, const char *b)
{
    size_t row[MAX_NAME + 1], n = strlen(b);
    if (n > MAX_NAME || strlen(a) > MAX_NAME) return MAX_NAME;
    for (size_t j = 0; j <= n; j++) row[j] = j;
    for (size_t i = 0; a[i]; i++) {
        size_t diagonal = row[0];
        row[0] = i + 1;
        for (size_t j = 0; j < n; j++) {
            size_t best = diagonal + (a[i] != b[j]);
            diagonal = row[j + 1];
            if (row[j + 1] + 1 < best) best = row[j + 1] + 1;
            if (row[j] + 1 < best) best = row[j] + 1;
            row[j + 1] = best;
        }
    }
    return row[n];
}

const char *sn_nearest_name(const char *word, const char *const *name, size_t n)
{
    const char *best = NULL;
    size_t least = strlen(word) / 2 + 2; /* farther away is no suggestion */
    for (size_t i = 0; i < n; i++) {
        size_t d = distance(word, name[i]);
        if (d < least) {
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
        if ((unsigned char)name[i] < 32 || name[i] == '/' || name[i] == 127)
            return sn_fail(err, SN_EINVAL, "name of %s '%.64s' holds '/' or a control character", kind, name);
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
