#include "base/alloc.h"
#include "field/tissue_private.h"

void sn_tissue_rhs_free(tissue_rhs *b)
{
    sn_release(b->ptr);
    sn_release(b->index);
    sn_release(b->value);
    *b = (tissue_rhs){0};
}

/* One vector: each unknown once, in the order in which it is met. */
typedef struct summing {
    const sn_tissue_solver *s;
    tissue_rhs *b;
    int32_t *at; /* n_free: where an unknown is in b, or before the vector when it is not */
    int32_t first, end;
} summing;

static void add_row(summing *v, int32_t tet, const double *bary, double value)
{
    for (int k = 0; k < 4; k++) {
        int32_t u = v->s->number[v->s->body->mesh.tet[4 * (size_t)tet + (size_t)k]];
        if (u < 0) continue;
        if (v->at[u] < v->first) {
            v->at[u] = v->end;
            v->b->index[v->end] = u;
            v->b->value[v->end++] = 0.0;
        }
        v->b->value[v->at[u]] += v->s->alpha * bary[k] * value;
    }
}

static void fill_vector(summing *v, int32_t tissue)
{
    const sn_row_set *set = &v->s->set;
    const sn_collocation *c = tissue > 0 ? v->s->muscle[tissue - 1].row : NULL;
    for (int32_t r = 0; c && r < c->n_row; r++) add_row(v, c->tet[r], c->bary + 4 * (size_t)r, c->value[r]);
    for (int32_t r = 0; !c && r < set->n; r++) add_row(v, set->row[r].tet, set->row[r].bary, 1.0);
}

sn_status sn_tissue_rhs_init(tissue_rhs *b, const sn_tissue_solver *s, const int32_t *tissue, int32_t n,
                             sn_error *err)
{
    size_t most = 0;
    for (int32_t j = 0; j < n; j++)
        most += 4 * (size_t)(tissue[j] == 0 ? s->set.n : s->muscle[tissue[j] - 1].row->n_row);
    summing v = {.s = s, .b = b, .at = SN_NEW(int32_t, s->n_free)};
    b->n = n;
    b->ptr = SN_NEW_ZERO(int32_t, (size_t)n + 1);
    b->index = SN_NEW(int32_t, most);
    b->value = SN_NEW(double, most);
    sn_status st = v.at && b->ptr && b->index && b->value
                       ? SN_OK
                       : sn_fail(err, SN_ENOMEM, "tissue: no memory for %d fields", n);
    for (int32_t u = 0; !st && u < s->n_free; u++) v.at[u] = -1;
    for (int32_t j = 0; !st && j < n; j++) {
        v.first = v.end;
        fill_vector(&v, tissue[j]);
        b->ptr[j + 1] = v.end;
    }
    sn_release(v.at);
    return st;
}
