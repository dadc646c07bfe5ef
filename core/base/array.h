/* array.h - sorting with a result that depends on the data only. */
#ifndef SN_BASE_ARRAY_H
#define SN_BASE_ARRAY_H

#include <stddef.h>
#include <stdint.h>

/* As qsort. `less` must order every two different elements (break ties by index): then the result is unique.
 * Never allocates from the sn_ allocator. */
void sn_sort(void *base, size_t n, size_t size, int (*less)(const void *, const void *));

/* Three numbers ascending: the name of a face. */
static inline void sn_sort3(int32_t v[3])
{
    int32_t a = v[0] < v[1] ? v[0] : v[1], b = v[0] < v[1] ? v[1] : v[0], c = v[2];
    v[0] = a < c ? a : c;
    v[2] = b > c ? b : c;
    v[1] = c < a ? a : c > b ? b : c;
}

/* Sorts keys ascending by radix; tmp: room for n. Returns the number of distinct keys, which come first. */
size_t sn_sort_unique_u64(uint64_t *key, uint64_t *tmp, size_t n);

#endif
