#include "field/harmonic.h"

#include "base/alloc.h"
#include "field/iterative.h"

#include <string.h>

/* Of the mean diagonal entry. A function that should be constant falls off by about this times the number of
 * vertices, far below what the directions made of such functions need; the matrix's condition stays near
 * 1e10. */
#define MASS_REL 1e-9

#define TOLERANCE 1e-8 /* of iterative solves: directions are made of these functions */

struct sn_harmonic {
    sn_cholesky *cholesky;   /* NULL: iterative */
    sn_csr matrix;           /* of the iterative kind: with values of its own */
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

static sn_status create(sn_harmonic **out, int32_t n_vert, const int32_t *number, int32_t n, sn_error *err)
{
    sn_harmonic *h = *out = SN_NEW_ZERO(sn_harmonic, 1);
    if (!h) return sn_fail(err, SN_ENOMEM, "harmonic: no memory");
    h->n = n;
    h->n_vert = n_vert;
    h->number = SN_NEW(int32_t, n_vert);
    if (!h->number) return sn_fail(err, SN_ENOMEM, "harmonic: no memory for %d vertices", n_vert);
    memcpy(h->number, number, (size_t)n_vert * sizeof *number);
    return SN_OK;
}

static sn_status keep(sn_harmonic **h, sn_status st)
{
    if (!st) return SN_OK;
    sn_harmonic_destroy(*h);
    *h = NULL;
    return st;
}

sn_status sn_harmonic_create(sn_harmonic **out, const sn_csr *laplacian, const int32_t *number, int32_t n,
                             const sn_cholesky *analysis, const sn_run *run, sn_error *err)
{
    sn_status st = create(out, laplacian->n, number, n, err);
    if (!st) st = factorize(*out, laplacian, analysis, run, err);
    return keep(out, st);
}

sn_status sn_harmonic_create_iterative(sn_harmonic **out, const sn_csr *laplacian, const int32_t *number,
                                       int32_t n, sn_error *err)
{
    sn_status st = create(out, laplacian->n, number, n, err);
    if (!st) st = with_mass(&(*out)->matrix, laplacian, err);
    return keep(out, st);
}

void sn_harmonic_destroy(sn_harmonic *h)
{
    if (!h) return;
    sn_cholesky_destroy(h->cholesky);
    sn_release(h->matrix.val); /* the pattern is borrowed */
    sn_release(h->number);
    sn_release(h);
}

const int32_t *sn_harmonic_numbers(const sn_harmonic *h)
{
    return h->number;
}

static void put_values(const int32_t *number, const sn_harmonic *h, const double *x, const int32_t *fixed,
                       int32_t n_fixed, const double *value, int32_t n_field, double *out)
{
    for (size_t f = 0; f < (size_t)n_field; f++) {
        double *to = out + f * (size_t)h->n_vert;
        const double *from = x + f * (size_t)h->n;
        for (int32_t v = 0; v < h->n_vert; v++) to[v] = number[v] >= 0 ? from[number[v]] : 0.0;
        for (int32_t i = 0; i < n_fixed; i++) to[fixed[i]] = value[f * (size_t)n_fixed + (size_t)i];
    }
}

static sn_status solve_by_factor(const sn_harmonic *h, const int32_t *fixed, int32_t n_fixed,
                                 const double *value, int32_t n_field, const sn_run *run, double *out,
                                 sn_error *err)
{
    int32_t *unknown = SN_NEW(int32_t, n_fixed);
    double *x = SN_NEW(double, (size_t)h->n *(size_t)n_field);
    sn_status st =
        unknown && x ? SN_OK : sn_fail(err, SN_ENOMEM, "harmonic: no memory for %d values", n_fixed);
    for (int32_t i = 0; !st && i < n_fixed; i++) unknown[i] = h->number[fixed[i]];
    if (!st) st = sn_cholesky_solve_held(h->cholesky, unknown, n_fixed, value, n_field, run, x, err);
    if (!st) put_values(h->number, h, x, fixed, n_fixed, value, n_field, out);
    sn_release(unknown);
    sn_release(x);
    return st;
}

/* ---- the iterative kind: the fixed vertices leave the matrix ---- */

static int32_t number_others(const sn_harmonic *h, const int32_t *fixed, int32_t n_fixed, int32_t *number)
{
    int32_t n = 0;
    for (int32_t v = 0; v < h->n_vert; v++) number[v] = h->number[v] < 0 ? -1 : 0;
    for (int32_t i = 0; i < n_fixed; i++) number[fixed[i]] = -1;
    for (int32_t v = 0; v < h->n_vert; v++)
        if (number[v] == 0) number[v] = n++;
    return n;
}

/* b := - A times the fixed values, on the others. */
static void flow_from_fixed(const sn_harmonic *h, const int32_t *number, const int32_t *fixed,
                            int32_t n_fixed, const double *value, double *b)
{
    const sn_csr *a = &h->matrix; /* symmetric: a fixed column is a row */
    for (int32_t i = 0; i < n_fixed; i++)
        for (int64_t k = a->ptr[fixed[i]]; k < a->ptr[fixed[i] + 1]; k++)
            if (number[a->idx[k]] >= 0) b[number[a->idx[k]]] -= a->val[k] * value[i];
}

static sn_status iterate_fields(const sn_harmonic *h, const int32_t *number, int32_t n, const int32_t *fixed,
                                int32_t n_fixed, const double *value, int32_t n_field, const sn_run *run,
                                double *b, double *x, sn_error *err)
{
    sn_iterative *solver = NULL;
    sn_iterative_report report;
    sn_status st = sn_iterative_create(&solver, &h->matrix, number, n, run, err);
    for (int32_t f = 0; !st && f < n_field; f++) {
        memset(b, 0, (size_t)n * sizeof *b);
        flow_from_fixed(h, number, fixed, n_fixed, value + (size_t)f * (size_t)n_fixed, b);
        st = sn_iterative_solve(solver, b, x + (size_t)f * (size_t)n, TOLERANCE, run, &report, err);
    }
    sn_iterative_destroy(solver);
    return st;
}

static sn_status solve_by_iteration(const sn_harmonic *h, const int32_t *fixed, int32_t n_fixed,
                                    const double *value, int32_t n_field, const sn_run *run, double *out,
                                    sn_error *err)
{
    int32_t *number = SN_NEW(int32_t, h->n_vert);
    if (!number) return sn_fail(err, SN_ENOMEM, "harmonic: no memory for %d vertices", h->n_vert);
    int32_t n = number_others(h, fixed, n_fixed, number);
    double *b = SN_NEW(double, n), *x = SN_NEW_ZERO(double, (size_t)n *(size_t)n_field);
    sn_status st = b && x ? SN_OK : sn_fail(err, SN_ENOMEM, "harmonic: no memory for %d values", n);
    if (!st && n > 0) st = iterate_fields(h, number, n, fixed, n_fixed, value, n_field, run, b, x, err);
    const sn_harmonic others = {.n_vert = h->n_vert, .n = n};
    if (!st) put_values(number, &others, x, fixed, n_fixed, value, n_field, out);
    sn_release(number);
    sn_release(b);
    sn_release(x);
    return st;
}

sn_status sn_harmonic_solve(const sn_harmonic *h, const int32_t *fixed, int32_t n_fixed, const double *value,
                            int32_t n_field, const sn_run *run, double *out, sn_error *err)
{
    return h->cholesky ? solve_by_factor(h, fixed, n_fixed, value, n_field, run, out, err)
                       : solve_by_iteration(h, fixed, n_fixed, value, n_field, run, out, err);
}
