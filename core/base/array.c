#include "base/array.h"

#include <stdlib.h>
#include <string.h>

void sn_sort(void *base, size_t n, size_t size, int (*less)(const void *, const void *))
{
    if (n > 1) qsort(base, n, size, less);
}

#define DIGIT_BITS 11
#define N_DIGIT (1 << DIGIT_BITS)

static void sort_by_digit(const uint64_t *from, uint64_t *to, size_t n, int shift)
{
    size_t count[N_DIGIT] = {0}, sum = 0;
    for (size_t i = 0; i < n; i++) count[from[i] >> shift & (N_DIGIT - 1)]++;
    for (int d = 0; d < N_DIGIT; d++) {
        size_t c = count[d];
        count[d] = sum;
        sum += c;
    }
    for (size_t i = 0; i < n; i++) to[count[from[i] >> shift & (N_DIGIT - 1)]++] = from[i];
}

size_t sn_sort_unique_u64(uint64_t *key, uint64_t *tmp, size_t n)
{
    uint64_t any = 0;
    for (size_t i = 0; i < n; i++) any |= key[i];
    uint64_t *from = key, *to = tmp;
    for (int shift = 0; shift < 64; shift += DIGIT_BITS) {
        if (!(any >> shift & (N_DIGIT - 1))) continue; /* all zero in this digit */
        sort_by_digit(from, to, n, shift);
        uint64_t *swap = from;
        from = to;
        to = swap;
    }
    if (from != key) memcpy(key, from, n * sizeof *key);
    size_t kept = 0;
    for (size_t i = 0; i < n; i++)
        if (i == 0 || key[i] != key[i - 1]) key[kept++] = key[i];
    return kept;
}
