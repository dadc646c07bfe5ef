#include "muscle/collocation.h"

#include "base/alloc.h"
#include "tetra/trace.h"

#include <stdio.h>
#include <string.h>

void sn_collocation_free(sn_collocation *c)
{
    sn_release(c->tet);
    sn_release(c->bary);
    sn_release(c->value);
    sn_release(c->head);
    sn_release(c->arc);
    memset(c, 0, sizeof *c);
}

static bool reserve(sn_collocation *c, size_t n)
{
    c->tet = SN_NEW(int32_t, n);
    c->bary = SN_NEW(double, 4 * n);
    c->value = SN_NEW(double, n);
    c->head = SN_NEW(int32_t, n);
    c->arc = SN_NEW(double, n);
    return c->tet && c->bary && c->value && c->head && c->arc;
}

static void append(sn_collocation *c, const sn_head *h, int32_t i_head, const sn_trace *t)
{
    for (size_t i = 0; i < t->n_piece; i++) {
        const sn_trace_piece *p = &t->piece[i];
        size_t row = (size_t)c->n_row++;
        c->tet[row] = p->tet;
        memcpy(c->bary + 4 * row, p->bary, sizeof p->bary);
        c->value[row] = sn_head_tissue_at(h, p->i_seg, p->s);
        c->head[row] = i_head;
        c->arc[row] = sn_spline_arc(&h->spline, p->i_seg, p->s);
    }
    c->length_inside += t->length_inside;
    c->length_outside += t->length_outside;
}

static sn_status trace_head(const sn_muscle *m, int32_t i_head, const sn_body *b, const sn_locator *l,
                            sn_trace *t, sn_notes *notes, sn_error *err)
{
    const sn_spline *s = &m->head[i_head].spline;
    sn_status st = sn_trace_curve(b, l, s->seg, s->n_seg, t, err);
    if (!st && t->n_piece == 0)
        st = sn_fail(err, SN_EINVAL, "its curve never enters the soft tissue inside the skin");
    if (st) return sn_muscle_blame(m, i_head, st, err);
    double length = sn_spline_length(s);
    if (t->length_outside <= SN_LENGTH_LOST_REL * length) return SN_OK;
    char head[32] = "";
    if (m->n_head > 1) (void)snprintf(head, sizeof head, ", head %d", i_head + 1);
    sn_notes_add(notes, "muscle '%s'%s: %g of its curve's %g lies outside the soft tissue and is not used",
                 m->name, head, t->length_outside, length);
    return SN_OK;
}

sn_status sn_collocate(const sn_muscle *m, const sn_body *b, const sn_locator *l, sn_collocation *out,
                       sn_notes *notes, sn_error *err)
{
    size_t n = 0;
    sn_collocation_free(out);
    sn_trace *trace = SN_NEW_ZERO(sn_trace, m->n_head);
    sn_status st = trace ? SN_OK : sn_fail(err, SN_ENOMEM, "muscle '%s': no memory", m->name);
    for (int32_t i = 0; i < m->n_head && !st; i++) {
        st = trace_head(m, i, b, l, &trace[i], notes, err);
        n += trace[i].n_piece;
    }
    if (!st && !reserve(out, n)) st = sn_fail(err, SN_ENOMEM, "muscle '%s': no memory", m->name);
    for (int32_t i = 0; i < m->n_head && !st; i++) append(out, &m->head[i], i, &trace[i]);
    for (int32_t i = 0; trace && i < m->n_head; i++) sn_trace_free(&trace[i]);
    sn_release(trace);
    if (st) sn_collocation_free(out);
    return st;
}
