#include "field/low_rank.h"

#include "base/alloc.h"
#include "base/dense.h"

#include <string.h>

struct sn_low_rank {
    int32_t n, width;     /* terms; with the probes after them */
    int32_t *ptr, *index; /* U and probes */
    double *value;
    sn_half_solve *y;
    double *weight; /* n                       */
    double *gram;   /* width x width: Y'Y      */
    double *s;      /* n x n: LU factors       */
    int32_t *pivot; /* n                       */
};

void sn_low_rank_destroy(sn_low_rank *r)
{
    if (!r) return;
    sn_half_solve_destroy(r->y);
    sn_release(r->ptr);
    sn_release(r->index);
    sn_release(r->value);
    sn_release(r->weight);
    sn_release(r->gram);
    sn_release(r->s);
    sn_release(r->pivot);
    sn_release(r);
}

static sn_status copy_terms(sn_low_rank *r, const sn_sparse_vectors *u, const double *weight, int32_t n_term,
                            sn_error *err)
{
    size_t width = (size_t)u->n, n_entry = (size_t)u->ptr[u->n];
    r->n = n_term;
    r->width = u->n;
    r->ptr = SN_NEW(int32_t, width + 1);
    r->index = SN_NEW(int32_t, n_entry);
    r->value = SN_NEW(double, n_entry);
    r->weight = SN_NEW(double, n_term);
    if (!r->ptr || !r->index || !r->value || !r->weight)
        return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d terms", u->n);
    memcpy(r->ptr, u->ptr, (width + 1) * sizeof *r->ptr);
    if (n_entry > 0) memcpy(r->index, u->index, n_entry * sizeof *r->index);
    if (n_entry > 0) memcpy(r->value, u->value, n_entry * sizeof *r->value);
    if (n_term > 0) memcpy(r->weight, weight, (size_t)n_term * sizeof *r->weight);
    return SN_OK;
}

/* LU factors of S = diag(1/w) + Y'Y. */
static sn_status factorize(sn_low_rank *r, sn_error *err)
{
    size_t n = (size_t)r->n, width = (size_t)r->width;
    r->gram = SN_NEW(double, width *width);
    r->s = SN_NEW(double, n *n);
    r->pivot = SN_NEW(int32_t, n);
    if (!r->gram || !r->s || !r->pivot)
        return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d terms", r->n);
    sn_half_solve_gram(r->y, r->gram);
    for (size_t j = 0; j < n; j++) memcpy(r->s + j * n, r->gram + j * width, n * sizeof *r->s);
    for (size_t i = 0; i < n; i++) r->s[i * n + i] += 1.0 / r->weight[i];
    return n > 0 ? sn_dense_factorize(r->s, r->n, r->pivot, err) : SN_OK;
}

sn_status sn_low_rank_create(sn_low_rank **out, const sn_cholesky *c, const sn_sparse_vectors *u,
                             const double *weight, int32_t n_term, const sn_run *run, sn_error *err)
{
    *out = NULL;
    sn_low_rank *r = SN_NEW_ZERO(sn_low_rank, 1);
    if (!r) return sn_fail(err, SN_ENOMEM, "cholesky: no memory");
    sn_status st = copy_terms(r, u, weight, n_term, err);
    if (!st && u->n > 0) st = sn_half_solve_create(&r->y, c, u, run, err);
    if (!st && u->n > 0) st = factorize(r, err);
    if (st)
        sn_low_rank_destroy(r);
    else
        *out = r;
    return st;
}

int32_t sn_low_rank_count(const sn_low_rank *r)
{
    return r ? r->n : 0;
}

const sn_half_solve *sn_low_rank_half(const sn_low_rank *r)
{
    return r->y;
}

int32_t sn_low_rank_width(const sn_low_rank *r)
{
    return r->width;
}

/* One column: t = Y'z becomes what is seen, f the factor. */
static sn_status factor_column(const sn_low_rank *r, double *f, double *t, sn_error *err)
{
    size_t n = (size_t)r->n, width = (size_t)r->width;
    memset(f, 0, width * sizeof *f);
    memcpy(f, t, n * sizeof *f);
    sn_status st = n > 0 ? sn_dense_solve_factorized(r->s, r->n, r->pivot, f, 1, err) : SN_OK;
    for (size_t i = 0; i < n; i++) {
        t[i] = f[i] / r->weight[i]; /* t - Y'Y f, by the equation for f */
        f[i] = -f[i];
    }
    for (size_t j = 0; j < n; j++)
        for (size_t i = n; i < width; i++) t[i] += r->gram[j * width + i] * f[j];
    return st;
}

sn_status sn_low_rank_factor(const sn_low_rank *r, const sn_half_solve *z, int32_t n_rhs, double *factor,
                             double *seen, sn_error *err)
{
    size_t width = (size_t)r->width;
    sn_status st = SN_OK;
    if (width == 0) return SN_OK;
    sn_half_solve_product(r->y, z, seen);
    for (size_t j = 0; !st && j < (size_t)n_rhs; j++)
        st = factor_column(r, factor + j * width, seen + j * width, err);
    return st;
}

void sn_low_rank_add_product(const sn_low_rank *r, const double *x, double *y)
{
    for (int32_t j = 0; j < r->n; j++) {
        double sum = 0.0;
        for (int32_t e = r->ptr[j]; e < r->ptr[j + 1]; e++) sum += r->value[e] * x[r->index[e]];
        for (int32_t e = r->ptr[j]; e < r->ptr[j + 1]; e++)
            y[r->index[e]] += r->weight[j] * r->value[e] * sum;
    }
}

sn_sparse_vectors sn_low_rank_vectors(const sn_low_rank *r)
{
    return (sn_sparse_vectors){r->width, r->ptr, r->index, r->value};
}
