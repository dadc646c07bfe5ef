#include "base/array.h"

#include <stdlib.h>

void sn_sort(void *base, size_t n, size_t size, int (*less)(const void *, const void *))
{
    if (n > 1) qsort(base, n, size, less);
}
