#include "muscle/head.h"

#include "base/alloc.h"

#include <string.h>

void sn_head_free(sn_head *h)
{
    sn_release(h->point);
    sn_release(h->tissue);
    sn_spline_free(&h->spline);
    memset(h, 0, sizeof *h);
}

static sn_status check_tissue(int32_t i_point, double value, sn_error *err)
{
    if (value > 0.0 && isfinite(value)) return SN_OK;
    return sn_fail(err, SN_EINVAL, "tissue of point %d is %g, need > 0", i_point + 1, value);
}

static sn_status no_memory(sn_error *err)
{
    return sn_fail(err, SN_ENOMEM, "no memory for its curve");
}

/* Takes new points and tissues (n of them, by sn_alloc) when they make a curve; releases them when not. */
static sn_status adopt(sn_head *h, double *point, double *tissue, int32_t n, sn_error *err)
{
    sn_spline spline = {0};
    sn_status st = point && tissue ? sn_spline_build(&spline, point, n, err) : no_memory(err);
    if (st) {
        sn_release(point);
        sn_release(tissue);
        return st;
    }
    sn_head_free(h);
    h->point = point;
    h->tissue = tissue;
    h->n_point = n;
    h->spline = spline;
    return SN_OK;
}

sn_status sn_head_init(sn_head *h, const sn_head_points *from, sn_error *err)
{
    int32_t n = from->n;
    memset(h, 0, sizeof *h);
    for (int32_t i = 0; from->tissue && i < n; i++) {
        sn_status st = check_tissue(i, from->tissue[i], err);
        if (st) return st;
    }
    double *p = SN_NEW(double, 3 * (size_t)n), *t = SN_NEW(double, n);
    if (p && n > 0) memcpy(p, from->point, 3 * (size_t)n * sizeof *p);
    for (int32_t i = 0; t && i < n; i++) t[i] = from->tissue ? from->tissue[i] : 1.0;
    return adopt(h, p, t, n, err);
}

sn_status sn_head_copy(sn_head *out, const sn_head *h, sn_error *err)
{
    return sn_head_init(out, &(sn_head_points){h->point, h->tissue, h->n_point}, err);
}

/* A copy of the points and tissues with a gap of `gap` (-1, 0, 1) at i_point. */
static bool copy_with_gap(const sn_head *h, int32_t i_point, int gap, double **point, double **tissue)
{
    int32_t n = h->n_point + gap, tail = h->n_point - i_point - (gap < 0);
    *point = SN_NEW(double, 3 * (size_t)n);
    *tissue = SN_NEW(double, n);
    if (!*point || !*tissue) {
        sn_release(*point);
        sn_release(*tissue);
        return false;
    }
    size_t to = (size_t)i_point + (gap > 0), from = (size_t)i_point + (gap < 0);
    memcpy(*point, h->point, 3 * (size_t)i_point * sizeof **point);
    memcpy(*tissue, h->tissue, (size_t)i_point * sizeof **tissue);
    memcpy(*point + 3 * to, h->point + 3 * from, 3 * (size_t)tail * sizeof **point);
    memcpy(*tissue + to, h->tissue + from, (size_t)tail * sizeof **tissue);
    return true;
}

sn_status sn_head_set_point(sn_head *h, int32_t i_point, sn_vec3 p, sn_error *err)
{
    double *point, *tissue;
    if (!copy_with_gap(h, i_point, 0, &point, &tissue)) return no_memory(err);
    sn_v3_store(point + 3 * (size_t)i_point, p);
    return adopt(h, point, tissue, h->n_point, err);
}

sn_status sn_head_insert_point(sn_head *h, int32_t i_point, sn_vec3 p, double value, sn_error *err)
{
    double *point, *tissue;
    sn_status st = check_tissue(i_point, value, err);
    if (st) return st;
    if (!copy_with_gap(h, i_point, 1, &point, &tissue)) return no_memory(err);
    sn_v3_store(point + 3 * (size_t)i_point, p);
    tissue[i_point] = value;
    return adopt(h, point, tissue, h->n_point + 1, err);
}

sn_status sn_head_remove_point(sn_head *h, int32_t i_point, sn_error *err)
{
    double *point, *tissue;
    if (h->n_point <= 2) return sn_fail(err, SN_EINVAL, "has 2 points, the fewest a curve can have");
    if (!copy_with_gap(h, i_point, -1, &point, &tissue)) return no_memory(err);
    return adopt(h, point, tissue, h->n_point - 1, err);
}

sn_status sn_head_set_tissue(sn_head *h, int32_t i_point, double value, sn_error *err)
{
    sn_status st = check_tissue(i_point < 0 ? 0 : i_point, value, err);
    if (st) return st;
    for (int32_t i = 0; i < h->n_point; i++)
        if (i_point < 0 || i == i_point) h->tissue[i] = value;
    return SN_OK;
}

double sn_head_tissue_at(const sn_head *h, int32_t i_seg, double s)
{
    return h->tissue[i_seg] + s * (h->tissue[i_seg + 1] - h->tissue[i_seg]);
}
