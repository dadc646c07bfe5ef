/* array.h - sorting with a result that depends on the data only. */
#ifndef SN_BASE_ARRAY_H
#define SN_BASE_ARRAY_H

#include <stddef.h>

/* As qsort. `less` must order every two different elements (break ties by index): then the result is unique.
 * Never allocates from the sn_ allocator. */
void sn_sort(void *base, size_t n, size_t size, int (*less)(const void *, const void *));

#endif
