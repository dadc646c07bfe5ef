#include "muscle/muscle.h"

#include "base/alloc.h"

#include <string.h>

void sn_muscle_free(sn_muscle *m)
{
    sn_release(m->name);
    sn_release(m->point);
    sn_release(m->tissue);
    sn_spline_free(&m->spline);
    memset(m, 0, sizeof *m);
}

static sn_status check_tissue(const char *name, int32_t i_point, double value, sn_error *err)
{
    if (value > 0.0 && isfinite(value)) return SN_OK;
    return sn_fail(err, SN_EINVAL, "muscle '%s': tissue of point %d is %g, need > 0", name, i_point + 1,
                   value);
}

/* Takes new points and tissues (n of them, by sn_alloc) when they make a curve; releases them when not. */
static sn_status adopt(sn_muscle *m, const char *name, double *point, double *tissue, int32_t n,
                       sn_error *err)
{
    sn_spline spline = {0};
    sn_status st = sn_spline_build(&spline, point, n, err);
    if (st) {
        (void)sn_fail_prefix(err, st, "muscle '%s': ", name);
        sn_release(point);
        sn_release(tissue);
        return st;
    }
    sn_release(m->point);
    sn_release(m->tissue);
    sn_spline_free(&m->spline);
    m->point = point;
    m->tissue = tissue;
    m->n_point = n;
    m->spline = spline;
    return SN_OK;
}

static sn_status no_memory(const char *name, sn_error *err)
{
    return sn_fail(err, SN_ENOMEM, "muscle '%s': no memory", name);
}

sn_status sn_muscle_init(sn_muscle *m, const char *name, const double *point, const double *tissue, int32_t n,
                         sn_error *err)
{
    memset(m, 0, sizeof *m);
    for (int32_t i = 0; tissue && i < n; i++) {
        sn_status st = check_tissue(name, i, tissue[i], err);
        if (st) return st;
    }
    double *p = SN_NEW(double, 3 * (size_t)n), *t = SN_NEW(double, n);
    m->name = sn_strdup(name);
    if (!p || !t || !m->name) {
        sn_release(p);
        sn_release(t);
        sn_muscle_free(m);
        return no_memory(name, err);
    }
    if (n > 0) memcpy(p, point, 3 * (size_t)n * sizeof *p);
    for (int32_t i = 0; i < n; i++) t[i] = tissue ? tissue[i] : 1.0;
    sn_status st = adopt(m, name, p, t, n, err);
    if (st) sn_muscle_free(m);
    return st;
}

/* A copy of the points and tissues with a gap of `gap` (-1, 0, 1) at i_point, then adopted by the caller. */
static bool copy_with_gap(const sn_muscle *m, int32_t i_point, int gap, double **point, double **tissue)
{
    int32_t n = m->n_point + gap, tail = m->n_point - i_point - (gap < 0);
    *point = SN_NEW(double, 3 * (size_t)n);
    *tissue = SN_NEW(double, n);
    if (!*point || !*tissue) {
        sn_release(*point);
        sn_release(*tissue);
        return false;
    }
    size_t to = (size_t)i_point + (gap > 0), from = (size_t)i_point + (gap < 0);
    memcpy(*point, m->point, 3 * (size_t)i_point * sizeof **point);
    memcpy(*tissue, m->tissue, (size_t)i_point * sizeof **tissue);
    memcpy(*point + 3 * to, m->point + 3 * from, 3 * (size_t)tail * sizeof **point);
    memcpy(*tissue + to, m->tissue + from, (size_t)tail * sizeof **tissue);
    return true;
}

sn_status sn_muscle_set_point(sn_muscle *m, int32_t i_point, sn_vec3 p, sn_error *err)
{
    double *point, *tissue;
    if (!copy_with_gap(m, i_point, 0, &point, &tissue)) return no_memory(m->name, err);
    sn_v3_store(point + 3 * (size_t)i_point, p);
    return adopt(m, m->name, point, tissue, m->n_point, err);
}

sn_status sn_muscle_insert_point(sn_muscle *m, int32_t i_point, sn_vec3 p, double value, sn_error *err)
{
    double *point, *tissue;
    sn_status st = check_tissue(m->name, i_point, value, err);
    if (st) return st;
    if (!copy_with_gap(m, i_point, 1, &point, &tissue)) return no_memory(m->name, err);
    sn_v3_store(point + 3 * (size_t)i_point, p);
    tissue[i_point] = value;
    return adopt(m, m->name, point, tissue, m->n_point + 1, err);
}

sn_status sn_muscle_remove_point(sn_muscle *m, int32_t i_point, sn_error *err)
{
    double *point, *tissue;
    if (m->n_point <= 2)
        return sn_fail(err, SN_EINVAL, "muscle '%s': has 2 points, the fewest a curve can have", m->name);
    if (!copy_with_gap(m, i_point, -1, &point, &tissue)) return no_memory(m->name, err);
    return adopt(m, m->name, point, tissue, m->n_point - 1, err);
}

sn_status sn_muscle_set_tissue(sn_muscle *m, int32_t i_point, double value, sn_error *err)
{
    sn_status st = check_tissue(m->name, i_point < 0 ? 0 : i_point, value, err);
    if (st) return st;
    for (int32_t i = 0; i < m->n_point; i++)
        if (i_point < 0 || i == i_point) m->tissue[i] = value;
    return SN_OK;
}

double sn_muscle_tissue_at(const sn_muscle *m, int32_t i_seg, double s)
{
    return m->tissue[i_seg] + s * (m->tissue[i_seg + 1] - m->tissue[i_seg]);
}

void sn_collocation_free(sn_collocation *c)
{
    sn_release(c->tet);
    sn_release(c->bary);
    sn_release(c->value);
    memset(c, 0, sizeof *c);
}

sn_status sn_collocate(const sn_muscle *m, const sn_body *b, const sn_locator *l, sn_collocation *out,
                       sn_notes *notes, sn_error *err)
{
    sn_trace trace = {0};
    sn_collocation_free(out);
    sn_status st = sn_trace_curve(b, l, m->spline.seg, m->spline.n_seg, &trace, err);
    if (st) return sn_fail_prefix(err, st, "muscle '%s': ", m->name);
    if (trace.n_piece == 0) {
        sn_trace_free(&trace);
        return sn_fail(err, SN_EINVAL, "muscle '%s': its curve never enters the soft tissue inside the skin",
                       m->name);
    }
    out->n_row = (int32_t)trace.n_piece;
    out->tet = SN_NEW(int32_t, out->n_row);
    out->bary = SN_NEW(double, 4 * (size_t)out->n_row);
    out->value = SN_NEW(double, out->n_row);
    out->length_inside = trace.length_inside;
    out->length_outside = trace.length_outside;
    if (out->tet && out->bary && out->value) {
        for (int32_t i = 0; i < out->n_row; i++) {
            const sn_trace_piece *p = &trace.piece[i];
            out->tet[i] = p->tet;
            memcpy(out->bary + 4 * (size_t)i, p->bary, sizeof p->bary);
            out->value[i] = sn_muscle_tissue_at(m, p->i_seg, p->s);
        }
    } else {
        sn_collocation_free(out);
        st = no_memory(m->name, err);
    }
    double length = sn_spline_length(&m->spline);
    if (!st && trace.length_outside > SN_LENGTH_LOST_REL * length)
        sn_notes_add(notes, "muscle '%s': %g of its curve's %g lies outside the soft tissue and is not used",
                     m->name, trace.length_outside, length);
    sn_trace_free(&trace);
    return st;
}
