#include "field/tissue_change.h"

#include "base/alloc.h"

#include <stdlib.h>
#include <string.h>

void sn_tissue_change_free(sn_tissue_change *c)
{
    sn_release(c->row);
    sn_release(c->ptr);
    sn_release(c->index);
    sn_release(c->value);
    sn_release(c->weight);
    sn_release(c->probe);
    *c = (sn_tissue_change){0};
}

static sn_status find_rows(sn_tissue_change *c, const sn_row_set *base, const sn_row_set *now,
                           const sn_row_set *past, sn_error *err)
{
    size_t most = (size_t)now->n + (size_t)base->n + (size_t)past->n;
    sn_row *gone = SN_NEW(sn_row, past->n);
    c->row = SN_NEW(sn_row, most);
    if (!c->row || !gone) {
        sn_release(gone);
        return sn_fail(err, SN_ENOMEM, "tissue: no memory for %zu rows", most);
    }
    c->n_gained = sn_row_set_less(now, base, c->row);
    c->n_term = c->n_gained + sn_row_set_less(base, now, c->row + c->n_gained);
    const sn_row_set without = {gone, sn_row_set_less(past, now, gone)};
    c->n_row = c->n_term + sn_row_set_less(&without, base, c->row + c->n_term);
    sn_release(gone);
    return SN_OK;
}

static sn_status fill_rows(sn_tissue_change *c, const sn_tissue_rows *rows, sn_error *err)
{
    c->ptr = SN_NEW_ZERO(int32_t, (size_t)c->n_row + 1);
    c->index = SN_NEW(int32_t, 4 * (size_t)c->n_row);
    c->value = SN_NEW(double, 4 * (size_t)c->n_row);
    c->weight = SN_NEW(double, c->n_row);
    if (!c->ptr || !c->index || !c->value || !c->weight)
        return sn_fail(err, SN_ENOMEM, "tissue: no memory for %d rows", c->n_row);
    for (int32_t j = 0; j < c->n_row; j++) {
        int32_t n = c->ptr[j];
        for (int k = 0; k < 4; k++) {
            int32_t u = rows->number[rows->tet[4 * (size_t)c->row[j].tet + (size_t)k]];
            if (u < 0) continue;
            c->index[n] = u;
            c->value[n++] = c->row[j].bary[k];
        }
        c->ptr[j + 1] = n;
        c->weight[j] = j < c->n_gained ? rows->alpha : -rows->alpha;
    }
    return SN_OK;
}

static int compare(const void *pa, const void *pb)
{
    int32_t a = *(const int32_t *)pa, b = *(const int32_t *)pb;
    return a < b ? -1 : a > b;
}

/* Sorts, and keeps each once; returns how many. */
static int32_t make_unique(int32_t *x, int32_t n)
{
    int32_t kept = 0;
    if (n > 1) qsort(x, (size_t)n, sizeof *x, compare);
    for (int32_t i = 0; i < n; i++)
        if (kept == 0 || x[kept - 1] != x[i]) x[kept++] = x[i];
    return kept;
}

static sn_status find_unknowns(sn_tissue_change *c, sn_error *err)
{
    int32_t n = c->ptr[c->n_term], n_gone = c->ptr[c->n_row] - n;
    int32_t *touched = SN_NEW(int32_t, n);
    c->probe = SN_NEW(int32_t, n_gone);
    if (!touched || !c->probe) {
        sn_release(touched);
        return sn_fail(err, SN_ENOMEM, "tissue: no memory for %d rows", c->n_row);
    }
    if (n > 0) memcpy(touched, c->index, (size_t)n * sizeof *touched);
    if (n_gone > 0) memcpy(c->probe, c->index + n, (size_t)n_gone * sizeof *c->probe);
    c->n_touched = make_unique(touched, n);
    c->n_probe = make_unique(c->probe, n_gone);
    sn_release(touched);
    return SN_OK;
}

sn_status sn_tissue_change_find(sn_tissue_change *c, const sn_row_set *base, const sn_tissue_rows *rows,
                                const sn_row_set *past, sn_error *err)
{
    sn_status st = find_rows(c, base, rows->set, past, err);
    if (!st) st = fill_rows(c, rows, err);
    if (!st) st = find_unknowns(c, err);
    if (st) sn_tissue_change_free(c);
    return st;
}
