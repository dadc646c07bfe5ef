#include "base/alloc.h"
#include "field/tissue_private.h"

void sn_tissue_rhs_free(tissue_rhs *b)
{
    sn_release(b->ptr);
    sn_release(b->index);
    sn_release(b->value);
    *b = (tissue_rhs){0};
}

static int32_t add_row(const sn_tissue_solver *s, int32_t tet, const double *bary, double value,
                       tissue_rhs *b, int32_t n)
{
    for (int k = 0; k < 4; k++) {
        int32_t u = s->number[s->body->mesh.tet[4 * (size_t)tet + (size_t)k]];
        if (u < 0) continue;
        b->index[n] = u;
        b->value[n++] = s->alpha * bary[k] * value;
    }
    return n;
}

sn_status sn_tissue_rhs_init(tissue_rhs *b, const sn_tissue_solver *s, const int32_t *tissue, int32_t n,
                             const sn_row_set *cover, sn_error *err)
{
    size_t most = 0;
    for (int32_t j = 0; j < n; j++)
        most += 4 * (size_t)(tissue[j] == 0 ? cover->n : s->muscle[tissue[j] - 1].row->n_row);
    b->n = n;
    b->ptr = SN_NEW_ZERO(int32_t, (size_t)n + 1);
    b->index = SN_NEW(int32_t, most);
    b->value = SN_NEW(double, most);
    if (!b->ptr || !b->index || !b->value)
        return sn_fail(err, SN_ENOMEM, "tissue: no memory for %d fields", n);
    for (int32_t j = 0; j < n; j++) {
        int32_t end = b->ptr[j];
        const sn_collocation *c = tissue[j] > 0 ? s->muscle[tissue[j] - 1].row : NULL;
        for (int32_t r = 0; c && r < c->n_row; r++)
            end = add_row(s, c->tet[r], c->bary + 4 * (size_t)r, c->value[r], b, end);
        for (int32_t r = 0; !c && r < cover->n; r++)
            end = add_row(s, cover->row[r].tet, cover->row[r].bary, 1.0, b, end);
        b->ptr[j + 1] = end;
    }
    return SN_OK;
}
