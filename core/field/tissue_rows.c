#include "field/tissue_rows.h"

#include "base/alloc.h"

#include <stdlib.h>
#include <string.h>

void sn_row_set_free(sn_row_set *s)
{
    sn_release(s->row);
    *s = (sn_row_set){0};
}

/* Any total order will do in which equal rows are neighbours. */
static int compare(const void *pa, const void *pb)
{
    const sn_row *a = pa, *b = pb;
    if (a->tet != b->tet) return a->tet < b->tet ? -1 : 1;
    for (int k = 0; k < 4; k++)
        if (a->bary[k] != b->bary[k]) return a->bary[k] < b->bary[k] ? -1 : 1;
    return 0;
}

void sn_row_set_sort(sn_row_set *s)
{
    if (s->n > 1) qsort(s->row, (size_t)s->n, sizeof *s->row, compare);
}

sn_status sn_row_set_copy(sn_row_set *to, const sn_row_set *from, sn_error *err)
{
    sn_row *row = SN_NEW(sn_row, from->n);
    if (!row) return sn_fail(err, SN_ENOMEM, "tissue: no memory for %d rows", from->n);
    if (from->n > 0) memcpy(row, from->row, (size_t)from->n * sizeof *row);
    sn_row_set_free(to);
    *to = (sn_row_set){row, from->n};
    return SN_OK;
}

int32_t sn_row_set_less(const sn_row_set *from, const sn_row_set *other, sn_row *out)
{
    int32_t n = 0, k = 0;
    for (int32_t i = 0; i < from->n; i++) {
        while (k < other->n && compare(&other->row[k], &from->row[i]) < 0) k++;
        if (k < other->n && compare(&other->row[k], &from->row[i]) == 0)
            k++;
        else
            out[n++] = from->row[i];
    }
    return n;
}

sn_status sn_row_set_join(const sn_row_set *a, const sn_row_set *b, sn_row_set *out, sn_error *err)
{
    size_t most = (size_t)a->n + (size_t)b->n;
    sn_row_set all = {SN_NEW(sn_row, most), (int32_t)most};
    if (!all.row) return sn_fail(err, SN_ENOMEM, "tissue: no memory for %zu rows", most);
    if (a->n > 0) memcpy(all.row, a->row, (size_t)a->n * sizeof *all.row);
    if (b->n > 0) memcpy(all.row + a->n, b->row, (size_t)b->n * sizeof *all.row);
    sn_row_set_sort(&all);
    int32_t n = 0;
    for (int32_t i = 0; i < all.n; i++)
        if (n == 0 || compare(&all.row[n - 1], &all.row[i]) != 0) all.row[n++] = all.row[i];
    all.n = n;
    sn_row_set_free(out);
    *out = all;
    return SN_OK;
}
