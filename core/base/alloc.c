#include "base/alloc.h"

#include <stdlib.h>
#include <string.h>

static sn_allocator hook; /* the one mutable global: set before first use, see alloc.h */

void sn_set_allocator(const sn_allocator *a)
{
    hook = a ? *a : (sn_allocator){NULL, NULL};
}

static void *raw_realloc(void *p, size_t bytes)
{
    if (hook.realloc_fn) return hook.realloc_fn(hook.user, p, bytes);
    if (bytes == 0) {
        free(p);
        return NULL;
    }
    return realloc(p, bytes);
}

static bool product(size_t n, size_t size, size_t *bytes)
{
    if (__builtin_mul_overflow(n, size, bytes)) return false;
    if (*bytes == 0) *bytes = 1;
    return true;
}

void *sn_alloc(size_t n, size_t size)
{
    size_t bytes;
    return product(n, size, &bytes) ? raw_realloc(NULL, bytes) : NULL;
}

void *sn_alloc_zero(size_t n, size_t size)
{
    size_t bytes;
    if (!product(n, size, &bytes)) return NULL;
    if (!hook.realloc_fn) return calloc(1, bytes);
    void *p = raw_realloc(NULL, bytes);
    if (p) memset(p, 0, bytes);
    return p;
}

void *sn_realloc(void *p, size_t n, size_t size)
{
    size_t bytes;
    return product(n, size, &bytes) ? raw_realloc(p, bytes) : NULL;
}

void sn_release(void *p)
{
    if (p) (void)raw_realloc(p, 0);
}

bool sn_grow(void *p_ptr, size_t *cap, size_t need, size_t size)
{
    if (need <= *cap) return true;
    void *p;
    memcpy(&p, p_ptr, sizeof p);
    size_t room = *cap + *cap / 2 + 16;
    if (room < need) room = need;
    void *q = sn_realloc(p, room, size);
    if (!q) return false;
    memcpy(p_ptr, &q, sizeof q);
    *cap = room;
    return true;
}

char *sn_strdup(const char *s)
{
    size_t n = strlen(s) + 1;
    char *copy = sn_alloc(n, 1);
    if (copy) memcpy(copy, s, n);
    return copy;
}
