/* alloc.h - all memory of the library goes through here, so that sizes cannot overflow and tests can count
 * and fail allocations. */
#ifndef SN_BASE_ALLOC_H
#define SN_BASE_ALLOC_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

SN_BEGIN_DECLS

/* n * size bytes, not initialised; NULL when memory is short or n * size overflows. n = 0 gives a valid
 * pointer. */
void *sn_alloc(size_t n, size_t size);
void *sn_alloc_zero(size_t n, size_t size);
/* As realloc; on NULL the old block is untouched. */
void *sn_realloc(void *p, size_t n, size_t size);
void sn_release(void *p); /* NULL is fine */

#define SN_NEW(T, n) ((T *)sn_alloc((size_t)(n), sizeof(T)))
#define SN_NEW_ZERO(T, n) ((T *)sn_alloc_zero((size_t)(n), sizeof(T)))

/* Makes room for `need` elements of `size` bytes in *p, whose room is *cap elements; grows by at least half.
 * false when memory is short; *p and *cap are then untouched. */
bool sn_grow(void *p_ptr, size_t *cap, size_t need, size_t size);

char *sn_strdup(const char *s); /* a copy by sn_alloc, or NULL */

/* Replaces the allocator (NULL: back to the C library's). For tests; set before any other call, not
 * thread-safe. realloc_fn(user, p, bytes): bytes = 0 frees p, p = NULL allocates. */
typedef struct sn_allocator {
    void *(*realloc_fn)(void *user, void *p, size_t bytes);
    void *user;
} sn_allocator;
void sn_set_allocator(const sn_allocator *a);

/* Narrows n to int32_t; *ok is cleared when it does not fit and never set. */
static inline int32_t sn_to_i32(size_t n, bool *ok)
{
    if (n > (size_t)INT32_MAX) {
        *ok = false;
        return 0;
    }
    return (int32_t)n;
}

SN_END_DECLS

#endif
