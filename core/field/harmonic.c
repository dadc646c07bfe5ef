#include "field/harmonic.h"

#include "base/alloc.h"
#include "field/cholesky.h"

#include <string.h>

/* Of the mean diagonal entry. A function that should be constant falls off by about this times the number of
 * vertices, far below what the directions made of such functions need; the matrix's condition stays near
 * 1e10. */
#define MASS_REL 1e-9

struct sn_harmonic {
    sn_cholesky *cholesky;
    int32_t n;
};

static sn_status factorize(sn_harmonic *h, const sn_csr *laplacian, const int32_t *rank, const sn_run *run,
                           sn_error *err)
{
    size_t nnz = (size_t)laplacian->ptr[laplacian->n];
    sn_csr a = *laplacian; /* its pattern, with values of its own */
    int32_t *number = SN_NEW(int32_t, a.n);
    a.val = SN_NEW(double, nnz);
    sn_status st = number && a.val ? SN_OK : sn_fail(err, SN_ENOMEM, "harmonic: no memory for %d rows", a.n);
    if (!st) {
        double trace = 0.0;
        memcpy(a.val, laplacian->val, nnz * sizeof *a.val);
        for (int32_t v = 0; v < a.n; v++) trace += a.val[sn_csr_find(&a, v, v)];
        for (int32_t v = 0; v < a.n; v++) {
            number[v] = v;
            a.val[sn_csr_find(&a, v, v)] += MASS_REL * trace / a.n;
        }
        st = sn_cholesky_create(&h->cholesky, &a, number, a.n, rank, run, err);
    }
    if (!st) st = sn_cholesky_factorize(h->cholesky, &a, run, err);
    sn_release(number);
    sn_release(a.val);
    return st;
}

sn_status sn_harmonic_create(sn_harmonic **out, const sn_csr *laplacian, const int32_t *rank,
                             const sn_run *run, sn_error *err)
{
    *out = NULL;
    sn_harmonic *h = SN_NEW_ZERO(sn_harmonic, 1);
    if (!h) return sn_fail(err, SN_ENOMEM, "harmonic: no memory");
    h->n = laplacian->n;
    sn_status st = factorize(h, laplacian, rank, run, err);
    if (st)
        sn_harmonic_destroy(h);
    else
        *out = h;
    return st;
}

void sn_harmonic_destroy(sn_harmonic *h)
{
    if (!h) return;
    sn_cholesky_destroy(h->cholesky);
    sn_release(h);
}

sn_status sn_harmonic_solve(const sn_harmonic *h, const int32_t *fixed, int32_t n_fixed, const double *value,
                            int32_t n_field, const sn_run *run, double *out, sn_error *err)
{
    size_t n = (size_t)h->n, p = (size_t)n_fixed;
    double *block = SN_NEW(double, p *p), *source = SN_NEW(double, p *(size_t)n_field);
    sn_status st =
        block && source ? SN_OK : sn_fail(err, SN_ENOMEM, "harmonic: no memory for %d values", n_fixed);
    if (!st) st = sn_cholesky_inverse_block(h->cholesky, fixed, n_fixed, run, block, err);
    if (!st) {
        memcpy(source, value, p * (size_t)n_field * sizeof *source);
        st = sn_dense_solve_spd(block, n_fixed, source, n_field, err);
    }
    if (!st) {
        memset(out, 0, n * (size_t)n_field * sizeof *out);
        for (size_t f = 0; f < (size_t)n_field; f++)
            for (size_t i = 0; i < p; i++) out[f * n + (size_t)fixed[i]] = source[f * p + i];
        st = sn_cholesky_solve(h->cholesky, out, n_field, run, err);
    }
    for (size_t f = 0; !st && f < (size_t)n_field; f++)
        for (size_t i = 0; i < p; i++) out[f * n + (size_t)fixed[i]] = value[f * p + i];
    sn_release(block);
    sn_release(source);
    return st;
}
