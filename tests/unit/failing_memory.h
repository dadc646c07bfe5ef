/* failing_memory.h - an allocator that fails after a number of calls and counts the blocks in use:
 * sn_set_allocator(&(sn_allocator){failing_realloc, &f}). */
#ifndef SN_TEST_FAILING_MEMORY_H
#define SN_TEST_FAILING_MEMORY_H

#include "base/alloc.h"

#include <stdlib.h>

typedef struct failing {
    int left, n_alive; /* calls that succeed, blocks in use */
} failing;

static inline void *failing_realloc(void *user, void *p, size_t size)
{
    failing *f = user;
    if (size == 0) {
        f->n_alive -= p != NULL;
        free(p);
        return NULL;
    }
    if (f->left-- <= 0) return NULL;
    f->n_alive += p == NULL;
    return realloc(p, size);
}

#endif
