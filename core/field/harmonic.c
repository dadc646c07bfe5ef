#include "field/harmonic.h"

#include "base/alloc.h"

#include <string.h>

/* Of the mean diagonal entry. A function that should be constant falls off by about this times the number of
 * vertices, far below what the directions made of such functions need; the matrix's condition stays near
 * 1e10. */
#define MASS_REL 1e-9

struct sn_harmonic {
    sn_cholesky *cholesky;
    int32_t *number, n_vert; /* one of each vertex */
    int32_t n;
};

/* L + mass, in the pattern of L. */
static sn_status with_mass(sn_csr *a, const sn_csr *laplacian, sn_error *err)
{
    size_t nnz = (size_t)laplacian->ptr[laplacian->n];
    double trace = 0.0;
    *a = *laplacian;
    a->val = SN_NEW(double, nnz);
    if (!a->val) return sn_fail(err, SN_ENOMEM, "harmonic: no memory for %d rows", a->n);
    memcpy(a->val, laplacian->val, nnz * sizeof *a->val);
    for (int32_t v = 0; v < a->n; v++) trace += a->val[sn_csr_find(a, v, v)];
    for (int32_t v = 0; v < a->n; v++) a->val[sn_csr_find(a, v, v)] += MASS_REL * trace / a->n;
    return SN_OK;
}

static sn_status factorize(sn_harmonic *h, const sn_csr *laplacian, const sn_cholesky *analysis,
                           const sn_run *run, sn_error *err)
{
    sn_csr a;
    sn_status st = with_mass(&a, laplacian, err);
    if (!st)
        st = analysis ? sn_cholesky_clone(&h->cholesky, analysis, err)
                      : sn_cholesky_create(&h->cholesky, &a, h->number, h->n, run, err);
    if (!st) st = sn_cholesky_factorize(h->cholesky, &a, run, err);
    sn_release(a.val);
    return st;
}

sn_status sn_harmonic_create(sn_harmonic **out, const sn_csr *laplacian, const int32_t *number, int32_t n,
                             const sn_cholesky *analysis, const sn_run *run, sn_error *err)
{
    *out = NULL;
    sn_harmonic *h = SN_NEW_ZERO(sn_harmonic, 1);
    if (!h) return sn_fail(err, SN_ENOMEM, "harmonic: no memory");
    h->n = n;
    h->n_vert = laplacian->n;
    h->number = SN_NEW(int32_t, h->n_vert);
    sn_status st = SN_OK;
    if (h->number)
        memcpy(h->number, number, (size_t)h->n_vert * sizeof *number);
    else
        st = sn_fail(err, SN_ENOMEM, "harmonic: no memory for %d vertices", h->n_vert);
    if (!st) st = factorize(h, laplacian, analysis, run, err);
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
    sn_release(h->number);
    sn_release(h);
}

const int32_t *sn_harmonic_numbers(const sn_harmonic *h)
{
    return h->number;
}

static void put_values(const sn_harmonic *h, const double *x, const int32_t *fixed, int32_t n_fixed,
                       const double *value, int32_t n_field, double *out)
{
    for (size_t f = 0; f < (size_t)n_field; f++) {
        double *to = out + f * (size_t)h->n_vert;
        const double *from = x + f * (size_t)h->n;
        for (int32_t v = 0; v < h->n_vert; v++) to[v] = h->number[v] >= 0 ? from[h->number[v]] : 0.0;
        for (int32_t i = 0; i < n_fixed; i++) to[fixed[i]] = value[f * (size_t)n_fixed + (size_t)i];
    }
}

sn_status sn_harmonic_solve(const sn_harmonic *h, const int32_t *fixed, int32_t n_fixed, const double *value,
                            int32_t n_field, const sn_run *run, double *out, sn_error *err)
{
    int32_t *unknown = SN_NEW(int32_t, n_fixed);
    double *x = SN_NEW(double, (size_t)h->n *(size_t)n_field);
    sn_status st =
        unknown && x ? SN_OK : sn_fail(err, SN_ENOMEM, "harmonic: no memory for %d values", n_fixed);
    for (int32_t i = 0; !st && i < n_fixed; i++) unknown[i] = h->number[fixed[i]];
    if (!st) st = sn_cholesky_solve_held(h->cholesky, unknown, n_fixed, value, n_field, run, x, err);
    if (!st) put_values(h, x, fixed, n_fixed, value, n_field, out);
    sn_release(unknown);
    sn_release(x);
    return st;
}
