#include "field/low_rank.h"

#include "base/alloc.h"
#include "base/dense.h"

#include <cblas.h>
#include <string.h>

/* The unknowns that terms touch are numbered 0 .. n - 1. */
struct sn_low_rank {
    sn_unit_columns e;
    int32_t n, *unknown;       /* n: those touched; behind them the probes that are not among them */
    int32_t *column;           /* n: where each is among the columns                            */
    int32_t n_term, *ptr, *at; /* n_term + 1, ptr[n_term]: touched unknowns of the terms, once each */
    double *value, *weight;    /* ptr[n_term], n_term                                           */
    double *g;                 /* width x n: the columns of the Gram matrix                     */
    double *s;                 /* n x n: LU factors of I + G M                                  */
    int32_t *pivot;            /* n                                                             */
};

static void drop_terms(sn_low_rank *r)
{
    sn_unit_columns e = r->e;
    sn_release(r->unknown);
    sn_release(r->column);
    sn_release(r->ptr);
    sn_release(r->at);
    sn_release(r->value);
    sn_release(r->weight);
    sn_release(r->g);
    sn_release(r->s);
    sn_release(r->pivot);
    *r = (sn_low_rank){.e = e};
}

void sn_low_rank_destroy(sn_low_rank *r)
{
    if (!r) return;
    drop_terms(r);
    sn_unit_columns_free(&r->e);
    sn_release(r);
}

sn_status sn_low_rank_create(sn_low_rank **out, const sn_cholesky *c, sn_error *err)
{
    sn_low_rank *r = *out = SN_NEW_ZERO(sn_low_rank, 1);
    if (!r) return sn_fail(err, SN_ENOMEM, "cholesky: no memory");
    r->e.c = c;
    return SN_OK;
}

/* ---- terms ---- */

/* Where x is among the first *n of list; it is appended when it is not there. */
static int32_t find_or_append(int32_t *list, int32_t *n, int32_t x)
{
    int32_t i = 0;
    while (i < *n && list[i] != x) i++;
    if (i == *n) list[(*n)++] = x;
    return i;
}

/* Copies the terms. Returns how many unknowns there are with the probes. */
static int32_t take_terms(sn_low_rank *r, const sn_low_rank_terms *t)
{
    int32_t n = 0;
    r->ptr[0] = 0;
    for (int32_t j = 0; j < t->u.n; j++) {
        int32_t end = r->ptr[j];
        for (int32_t e = t->u.ptr[j]; e < t->u.ptr[j + 1]; e++) {
            int32_t i = find_or_append(r->unknown, &n, t->u.index[e]), k = r->ptr[j];
            while (k < end && r->at[k] != i) k++;
            if (k == end) {
                r->value[end] = 0.0;
                r->at[end++] = i;
            }
            r->value[k] += t->u.value[e];
        }
        r->ptr[j + 1] = end;
        r->weight[j] = t->weight[j];
    }
    r->n_term = t->u.n;
    r->n = n;
    for (int32_t i = 0; i < t->n_probe; i++) (void)find_or_append(r->unknown, &n, t->probe[i]);
    return n;
}

/* s := I + G M, term by term: M is the sum of w u u'. gu: room for n. */
static void fill_s(sn_low_rank *r, double *gu)
{
    size_t n = (size_t)r->n, width = (size_t)r->e.width;
    memset(r->s, 0, n * n * sizeof *r->s);
    for (size_t i = 0; i < n; i++) r->s[i * n + i] = 1.0;
    for (int32_t j = 0; j < r->n_term; j++) {
        memset(gu, 0, n * sizeof *gu);
        for (int32_t e = r->ptr[j]; e < r->ptr[j + 1]; e++) {
            const double *g = r->g + (size_t)r->at[e] * width;
            for (size_t i = 0; i < n; i++) gu[i] += r->weight[j] * r->value[e] * g[r->column[i]];
        }
        for (int32_t e = r->ptr[j]; e < r->ptr[j + 1]; e++)
            for (size_t i = 0; i < n; i++) r->s[(size_t)r->at[e] * n + i] += r->value[e] * gu[i];
    }
}

static sn_status factorize(sn_low_rank *r, sn_error *err)
{
    size_t n = (size_t)r->n, width = (size_t)r->e.width;
    double *gu = SN_NEW(double, n);
    r->g = SN_NEW(double, width *n);
    r->s = SN_NEW(double, n *n);
    r->pivot = SN_NEW(int32_t, n);
    sn_status st = gu && r->g && r->s && r->pivot
                       ? SN_OK
                       : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %zu unknowns", n);
    if (!st && n > 0) {
        for (size_t i = 0; i < n; i++)
            memcpy(r->g + i * width, r->e.gram + (size_t)r->column[i] * width, width * sizeof *r->g);
        fill_s(r, gu);
        st = sn_dense_factorize(r->s, r->n, r->pivot, err);
    }
    sn_release(gu);
    return st;
}

static sn_status set_terms(sn_low_rank *r, const sn_low_rank_terms *t, const sn_run *run, sn_error *err)
{
    size_t n_entry = (size_t)t->u.ptr[t->u.n], most = n_entry + (size_t)t->n_probe;
    r->unknown = SN_NEW(int32_t, most);
    r->column = SN_NEW(int32_t, most);
    r->ptr = SN_NEW(int32_t, (size_t)t->u.n + 1);
    r->at = SN_NEW(int32_t, n_entry);
    r->value = SN_NEW(double, n_entry);
    r->weight = SN_NEW(double, t->u.n);
    if (!r->unknown || !r->column || !r->ptr || !r->at || !r->value || !r->weight)
        return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d terms", t->u.n);
    int32_t n = take_terms(r, t);
    sn_status st = sn_unit_columns_need(&r->e, r->unknown, n, r->column, run, err);
    return st ? st : factorize(r, err);
}

sn_status sn_low_rank_set(sn_low_rank *r, const sn_low_rank_terms *terms, const sn_run *run, sn_error *err)
{
    drop_terms(r);
    sn_status st = set_terms(r, terms, run, err);
    if (st) drop_terms(r);
    return st;
}

int32_t sn_low_rank_count(const sn_low_rank *r)
{
    return r ? r->n_term : 0;
}

const sn_unit_columns *sn_low_rank_columns(const sn_low_rank *r)
{
    return &r->e;
}

/* ---- right-hand sides ---- */

/* y += scale M x. place: n, where each unknown touched is in x and y; NULL: they have only these. */
static void add_product(const sn_low_rank *r, double scale, const int32_t *place, const double *x, double *y)
{
    for (int32_t j = 0; j < r->n_term; j++) {
        double sum = 0.0;
        for (int32_t e = r->ptr[j]; e < r->ptr[j + 1]; e++)
            sum += r->value[e] * x[place ? place[r->at[e]] : r->at[e]];
        sum *= scale * r->weight[j];
        for (int32_t e = r->ptr[j]; e < r->ptr[j + 1]; e++)
            y[place ? place[r->at[e]] : r->at[e]] += sum * r->value[e];
    }
}

/* t += G q; q is mostly 0. */
static void add_gram(const sn_low_rank *r, const double *q, double *t)
{
    size_t width = (size_t)r->e.width;
    for (size_t k = 0; k < width; k++) {
        const double *g = r->e.gram + k * width;
        for (size_t i = 0; q[k] != 0.0 && i < width; i++) t[i] += q[k] * g[i];
    }
}

/* The solutions at the unknowns touched, s, and -M s: each n x n_rhs. */
static sn_status solve_touched(const sn_low_rank *r, int32_t n_rhs, const double *seen, double *s,
                               double *minus_ms, sn_error *err)
{
    size_t n = (size_t)r->n, width = (size_t)r->e.width;
    memset(minus_ms, 0, n * (size_t)n_rhs * sizeof *minus_ms);
    for (size_t j = 0; j < (size_t)n_rhs; j++)
        for (size_t i = 0; i < n; i++) s[j * n + i] = seen[j * width + (size_t)r->column[i]];
    sn_status st = sn_dense_solve_factorized(r->s, r->n, r->pivot, s, n_rhs, err);
    for (size_t j = 0; !st && j < (size_t)n_rhs; j++) add_product(r, -1.0, NULL, s + j * n, minus_ms + j * n);
    return st;
}

sn_status sn_low_rank_factor(const sn_low_rank *r, int32_t n_rhs, double *seen, double *factor, sn_error *err)
{
    size_t n = (size_t)r->n, width = (size_t)r->e.width, count = (size_t)n_rhs;
    for (size_t j = 0; j < count; j++) add_gram(r, factor + j * width, seen + j * width);
    if (n == 0 || count == 0) return SN_OK;
    double *s = SN_NEW(double, n *count), *minus_ms = SN_NEW(double, n *count);
    sn_status st = s && minus_ms ? solve_touched(r, n_rhs, seen, s, minus_ms, err)
                                 : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d terms", r->n_term);
    if (!st)
        cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, (int)width, n_rhs, (int)n, 1.0, r->g,
                    (int)width, minus_ms, (int)n, 1.0, seen, (int)width);
    for (size_t j = 0; !st && j < count; j++)
        for (size_t i = 0; i < n; i++) {
            size_t k = j * width + (size_t)r->column[i];
            factor[k] += minus_ms[j * n + i];
            seen[k] = s[j * n + i]; /* the same, with less rounding */
        }
    sn_release(s);
    sn_release(minus_ms);
    return st;
}

void sn_low_rank_add_product(const sn_low_rank *r, const double *x, double *y)
{
    add_product(r, 1.0, r->unknown, x, y);
}
