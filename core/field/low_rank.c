#include "field/low_rank.h"

#include "base/alloc.h"
#include "base/dense.h"

#include <string.h>

/* Columns that are of no use any more may be twice as many as the others. */
#define MOST_COLUMNS_REL 3

typedef struct part { /* columns that were half solved together */
    sn_half_solve *y;
    int32_t first, n;
} part;

struct sn_low_rank {
    const sn_cholesky *c;
    part *part;
    int32_t n_part;
    int32_t width, n; /* columns; terms among them */
    int32_t *ptr, *index;
    double *value;  /* the columns' vectors                         */
    double *weight; /* width: 0 of what is no term                  */
    double *gram;   /* width x width: Y'Y                           */
    int32_t *term;  /* n: their columns                             */
    double *s;      /* n x n: LU factors                            */
    int32_t *pivot; /* n                                            */
};

static void drop_terms(sn_low_rank *r)
{
    sn_release(r->term);
    sn_release(r->s);
    sn_release(r->pivot);
    r->term = r->pivot = NULL;
    r->s = NULL;
    r->n = 0;
    for (int32_t k = 0; k < r->width; k++) r->weight[k] = 0.0;
}

static void drop_columns(sn_low_rank *r)
{
    drop_terms(r);
    for (int32_t i = 0; i < r->n_part; i++) sn_half_solve_destroy(r->part[i].y);
    sn_release(r->part);
    sn_release(r->ptr);
    sn_release(r->index);
    sn_release(r->value);
    sn_release(r->weight);
    sn_release(r->gram);
    *r = (sn_low_rank){.c = r->c};
}

void sn_low_rank_destroy(sn_low_rank *r)
{
    if (!r) return;
    drop_columns(r);
    sn_release(r);
}

sn_status sn_low_rank_create(sn_low_rank **out, const sn_cholesky *c, sn_error *err)
{
    sn_low_rank *r = *out = SN_NEW_ZERO(sn_low_rank, 1);
    if (!r) return sn_fail(err, SN_ENOMEM, "cholesky: no memory");
    r->c = c;
    return SN_OK;
}

/* ---- columns ---- */

static bool same_vector(const sn_sparse_vectors *a, int32_t i, const sn_sparse_vectors *b, int32_t j)
{
    int32_t n = a->ptr[i + 1] - a->ptr[i];
    if (n != b->ptr[j + 1] - b->ptr[j]) return false;
    for (int32_t e = 0; e < n; e++)
        if (a->index[a->ptr[i] + e] != b->index[b->ptr[j] + e] ||
            a->value[a->ptr[i] + e] != b->value[b->ptr[j] + e])
            return false;
    return true;
}

/* column[i]: where u's vector i is, -1 when it is new; a column serves one vector. Returns how many are
 * there. */
static int32_t find_columns(const sn_low_rank *r, const sn_sparse_vectors *u, bool *is_used, int32_t *column)
{
    const sn_sparse_vectors own = sn_low_rank_vectors(r);
    int32_t n_found = 0;
    for (int32_t i = 0; i < u->n; i++) {
        column[i] = -1;
        for (int32_t k = 0; k < own.n && column[i] < 0; k++)
            if (!is_used[k] && same_vector(u, i, &own, k)) column[i] = k;
        if (column[i] < 0) continue;
        is_used[column[i]] = true;
        n_found++;
    }
    return n_found;
}

/* The vectors of u without a column, behind the others. */
static sn_status append_vectors(sn_low_rank *r, const sn_sparse_vectors *u, int32_t *column, int32_t n_new,
                                sn_error *err)
{
    int32_t before = r->width > 0 ? r->ptr[r->width] : 0;
    size_t width = (size_t)r->width + (size_t)n_new, n_entry = (size_t)before + (size_t)u->ptr[u->n];
    int32_t *ptr = sn_realloc(r->ptr, width + 1, sizeof *ptr);
    if (ptr) r->ptr = ptr;
    int32_t *index = sn_realloc(r->index, n_entry, sizeof *index);
    if (index) r->index = index;
    double *value = sn_realloc(r->value, n_entry, sizeof *value);
    if (value) r->value = value;
    double *weight = sn_realloc(r->weight, width, sizeof *weight);
    if (weight) r->weight = weight;
    if (!ptr || !index || !value || !weight)
        return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %zu terms", width);
    int32_t k = r->width;
    ptr[k] = before;
    for (int32_t i = 0; i < u->n; i++) {
        if (column[i] >= 0) continue;
        int32_t n = u->ptr[i + 1] - u->ptr[i];
        if (n > 0) memcpy(index + ptr[k], u->index + u->ptr[i], (size_t)n * sizeof *index);
        if (n > 0) memcpy(value + ptr[k], u->value + u->ptr[i], (size_t)n * sizeof *value);
        ptr[k + 1] = ptr[k] + n;
        weight[k] = 0.0;
        column[i] = k++;
    }
    return SN_OK;
}

/* Y'Y with a new part: what is known stays. */
static sn_status extend_gram(sn_low_rank *r, const part *new, sn_error *err)
{
    size_t old = (size_t) new->first, n = (size_t) new->n, width = old + n;
    double *gram = SN_NEW(double, width *width), *block = SN_NEW(double, width *n);
    sn_status st =
        gram && block ? SN_OK : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %zu terms", width);
    for (size_t j = 0; !st && j < old; j++) memcpy(gram + j * width, r->gram + j * old, old * sizeof *gram);
    for (int32_t p = 0; !st && p <= r->n_part; p++) {
        const part *with = p < r->n_part ? &r->part[p] : new;
        if (with == new)
            sn_half_solve_gram(new->y, block);
        else
            sn_half_solve_product(with->y, new->y, block);
        for (size_t j = 0; j < n; j++)
            for (size_t i = 0; i < (size_t)with->n; i++) {
                size_t a = (size_t)with->first + i, b = old + j;
                gram[b * width + a] = gram[a * width + b] = block[j * (size_t)with->n + i];
            }
    }
    sn_release(block);
    if (st) {
        sn_release(gram);
        return st;
    }
    sn_release(r->gram);
    r->gram = gram;
    return SN_OK;
}

/* Half solves of the vectors from r->width on. */
static sn_status append_part(sn_low_rank *r, int32_t n_new, const sn_run *run, sn_error *err)
{
    int32_t *ptr = SN_NEW(int32_t, (size_t)n_new + 1), first = r->width;
    part new = {NULL, first, n_new}, *all = sn_realloc(r->part, (size_t)r->n_part + 1, sizeof *all);
    if (all) r->part = all;
    sn_status st = ptr && all ? SN_OK : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d terms", n_new);
    for (int32_t i = 0; !st && i <= n_new; i++) ptr[i] = r->ptr[first + i] - r->ptr[first];
    if (!st) {
        const sn_sparse_vectors u = {n_new, ptr, r->index + r->ptr[first], r->value + r->ptr[first]};
        st = sn_half_solve_create(&new.y, r->c, &u, run, err);
    }
    if (!st) st = extend_gram(r, &new, err);
    sn_release(ptr);
    if (st) {
        sn_half_solve_destroy(new.y);
        return st;
    }
    r->part[r->n_part++] = new;
    r->width += n_new;
    return SN_OK;
}

/* column: u->n, receives where each is. */
static sn_status need_columns(sn_low_rank *r, const sn_sparse_vectors *u, int32_t *column, const sn_run *run,
                              sn_error *err)
{
    bool *is_used = SN_NEW_ZERO(bool, r->width);
    if (!is_used) return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d terms", u->n);
    int32_t n_new = u->n - find_columns(r, u, is_used, column);
    sn_release(is_used);
    if (r->width + n_new > MOST_COLUMNS_REL * u->n) { /* mostly of no use: anew */
        drop_columns(r);
        n_new = u->n;
        for (int32_t i = 0; i < u->n; i++) column[i] = -1;
    }
    if (n_new == 0) return SN_OK;
    sn_status st = append_vectors(r, u, column, n_new, err);
    return st ? st : append_part(r, n_new, run, err);
}

/* ---- terms ---- */

/* LU factors of S = diag(1/w) + Y'Y of the terms. */
static sn_status factorize(sn_low_rank *r, const int32_t *column, const double *weight, int32_t n,
                           sn_error *err)
{
    r->term = SN_NEW(int32_t, n);
    r->s = SN_NEW(double, (size_t)n *(size_t)n);
    r->pivot = SN_NEW(int32_t, n);
    if (!r->term || !r->s || !r->pivot) return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d terms", n);
    for (int32_t j = 0; j < n; j++) {
        r->term[j] = column[j];
        r->weight[column[j]] = weight[j];
        for (int32_t i = 0; i < n; i++)
            r->s[(size_t)j * (size_t)n + (size_t)i] =
                r->gram[(size_t)column[j] * (size_t)r->width + (size_t)column[i]];
        r->s[(size_t)j * (size_t)n + (size_t)j] += 1.0 / weight[j];
    }
    r->n = n;
    return n > 0 ? sn_dense_factorize(r->s, n, r->pivot, err) : SN_OK;
}

sn_status sn_low_rank_set(sn_low_rank *r, const sn_sparse_vectors *u, const double *weight, int32_t n_term,
                          const sn_run *run, sn_error *err)
{
    int32_t *column = SN_NEW(int32_t, u->n);
    drop_terms(r);
    sn_status st = column ? need_columns(r, u, column, run, err)
                          : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d terms", u->n);
    if (!st) st = factorize(r, column, weight, n_term, err);
    if (st) drop_columns(r);
    sn_release(column);
    return st;
}

int32_t sn_low_rank_count(const sn_low_rank *r)
{
    return r ? r->n : 0;
}

int32_t sn_low_rank_width(const sn_low_rank *r)
{
    return r->width;
}

sn_sparse_vectors sn_low_rank_vectors(const sn_low_rank *r)
{
    return (sn_sparse_vectors){r->width, r->ptr, r->index, r->value};
}

int32_t sn_low_rank_part_count(const sn_low_rank *r)
{
    return r->n_part;
}

const sn_half_solve *sn_low_rank_part(const sn_low_rank *r, int32_t i_part, int32_t *first, int32_t *n)
{
    *first = r->part[i_part].first;
    *n = r->part[i_part].n;
    return r->part[i_part].y;
}

/* ---- right-hand sides ---- */

/* to += sign G from, both over all columns. */
static void add_gram(const sn_low_rank *r, double sign, const double *from, double *to)
{
    size_t width = (size_t)r->width;
    for (int32_t k = 0; k < r->n; k++) {
        const double *g = r->gram + (size_t)r->term[k] * width;
        double x = sign * from[r->term[k]];
        for (size_t i = 0; i < width; i++) to[i] += x * g[i];
    }
}

/* t = Y'z becomes what is seen, f the factor; x: room for n. */
static sn_status factor_column(const sn_low_rank *r, bool has_sum, double *t, double *f, double *x,
                               sn_error *err)
{
    memset(f, 0, (size_t)r->width * sizeof *f);
    if (has_sum) add_gram(r, 1.0, r->weight, t);
    for (int32_t k = 0; k < r->n; k++) x[k] = t[r->term[k]];
    sn_status st = r->n > 0 ? sn_dense_solve_factorized(r->s, r->n, r->pivot, x, 1, err) : SN_OK;
    for (int32_t k = 0; k < r->n; k++) f[r->term[k]] = -x[k];
    add_gram(r, 1.0, f, t);
    for (int32_t k = 0; k < r->n; k++)
        t[r->term[k]] = x[k] / r->weight[r->term[k]]; /* the same, with less rounding */
    for (int32_t k = 0; has_sum && k < r->n; k++) f[r->term[k]] += r->weight[r->term[k]];
    return st;
}

sn_status sn_low_rank_factor(const sn_low_rank *r, int32_t n_rhs, const bool *has_sum, double *seen,
                             double *factor, sn_error *err)
{
    size_t width = (size_t)r->width;
    double *x = SN_NEW(double, r->n);
    sn_status st = x ? SN_OK : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d terms", r->n);
    for (size_t j = 0; !st && j < (size_t)n_rhs; j++)
        st = factor_column(r, has_sum[j], seen + j * width, factor + j * width, x, err);
    sn_release(x);
    return st;
}

void sn_low_rank_add_product(const sn_low_rank *r, const double *x, double *y)
{
    for (int32_t k = 0; k < r->n; k++) {
        int32_t j = r->term[k];
        double sum = 0.0;
        for (int32_t e = r->ptr[j]; e < r->ptr[j + 1]; e++) sum += r->value[e] * x[r->index[e]];
        for (int32_t e = r->ptr[j]; e < r->ptr[j + 1]; e++)
            y[r->index[e]] += r->weight[j] * r->value[e] * sum;
    }
}

void sn_low_rank_add_sum(const sn_low_rank *r, double scale, double *y)
{
    for (int32_t k = 0; k < r->n; k++) {
        int32_t j = r->term[k];
        for (int32_t e = r->ptr[j]; e < r->ptr[j + 1]; e++)
            y[r->index[e]] += scale * r->weight[j] * r->value[e];
    }
}
