#include "base/dense.h"

#include <cblas.h>
#include <stddef.h>

/* OpenBLAS's own: not in every cblas.h. */
extern void openblas_set_num_threads(int n);
/* LAPACK, which OpenBLAS brings along without its header. */
extern void dposv_(const char *uplo, const int *n, const int *n_rhs, double *a, const int *lda, double *b,
                   const int *ldb, int *info);
extern void dgetrf_(const int *m, const int *n, double *a, const int *lda, int *pivot, int *info);
extern void dgetrs_(const char *trans, const int *n, const int *n_rhs, const double *a, const int *lda,
                    const int *pivot, double *b, const int *ldb, int *info);

sn_status sn_dense_solve_spd(double *a, int32_t n, double *x, int32_t n_rhs, sn_error *err)
{
    int info = 0;
    openblas_set_num_threads(1);
    dposv_("L", &n, &n_rhs, a, &n, x, &n, &info);
    if (info == 0) return SN_OK;
    return sn_fail(err, SN_ESOLVE, "the dense matrix is not positive definite (column %d of %d)", info, n);
}

sn_status sn_dense_factorize(double *a, int32_t n, int32_t *pivot, sn_error *err)
{
    int info = 0;
    openblas_set_num_threads(1);
    dgetrf_(&n, &n, a, &n, pivot, &info);
    if (info == 0) return SN_OK;
    return sn_fail(err, SN_ESOLVE, "the dense matrix is singular (column %d of %d)", info, n);
}

sn_status sn_dense_solve_factorized(const double *a, int32_t n, const int32_t *pivot, double *x,
                                    int32_t n_rhs, sn_error *err)
{
    int info = 0;
    openblas_set_num_threads(1);
    dgetrs_("N", &n, &n_rhs, a, &n, pivot, x, &n, &info);
    if (info == 0) return SN_OK;
    return sn_fail(err, SN_ESOLVE, "dense solve: LAPACK refuses argument %d", -info);
}

void sn_dense_add_gram(const double *r, int32_t n_row, int32_t n, double *a)
{
    if (n_row < 1) return;
    openblas_set_num_threads(1);
    cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, n, n_row, 1.0, r, n, 1.0, a, n);
    for (int32_t j = 0; j < n; j++)
        for (int32_t i = 0; i < j; i++)
            a[(size_t)j * (size_t)n + (size_t)i] = a[(size_t)i * (size_t)n + (size_t)j];
}
