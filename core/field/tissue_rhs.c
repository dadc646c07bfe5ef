#include "base/alloc.h"
#include "field/tissue_private.h"

void sn_tissue_rhs_free(tissue_rhs *b)
{
    sn_release(b->ptr);
    sn_release(b->index);
    sn_release(b->value);
    *b = (tissue_rhs){0};
}

static int32_t add_rows(const sn_tissue_solver *s, const sn_collocation *c, bool is_cover, tissue_rhs *b,
                        int32_t n)
{
    for (size_t k = 0; k < 4 * (size_t)c->n_row; k++) {
        int32_t u = s->number[s->body->mesh.tet[4 * (size_t)c->tet[k / 4] + k % 4]];
        if (u < 0) continue;
        b->index[n] = u;
        b->value[n++] = s->alpha * c->bary[k] * (is_cover ? 1.0 : c->value[k / 4]);
    }
    return n;
}

sn_status sn_tissue_rhs_init(tissue_rhs *b, const sn_tissue_solver *s, const int32_t *tissue, int32_t n,
                             sn_error *err)
{
    size_t most = 0;
    for (int32_t j = 0; j < n; j++)
        most += 4 * (size_t)(tissue[j] == 0 ? s->set.n : s->muscle[tissue[j] - 1].row->n_row);
    b->n = n;
    b->ptr = SN_NEW_ZERO(int32_t, (size_t)n + 1);
    b->index = SN_NEW(int32_t, most);
    b->value = SN_NEW(double, most);
    if (!b->ptr || !b->index || !b->value)
        return sn_fail(err, SN_ENOMEM, "tissue: no memory for %d fields", n);
    for (int32_t j = 0; j < n; j++) {
        int32_t end = b->ptr[j], i = tissue[j] - 1;
        if (i >= 0) end = add_rows(s, s->muscle[i].row, false, b, end);
        for (int32_t k = 0; i < 0 && k < s->n_muscle; k++) end = add_rows(s, s->muscle[k].row, true, b, end);
        b->ptr[j + 1] = end;
    }
    return SN_OK;
}
