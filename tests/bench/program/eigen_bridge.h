/* eigen_bridge.h - the systems solved by Eigen, as libigl's users do (min_quad_with_fixed): compute() orders,
 * analyses and factorizes anew, then all right-hand sides are solved. */
#ifndef BENCH_EIGEN_BRIDGE_H
#define BENCH_EIGEN_BRIDGE_H

#ifdef __cplusplus
#include <cstdint>
extern "C" {
#else
#include <stdint.h>
#endif

typedef enum bench_eigen {
    BENCH_EIGEN_LDLT,
    BENCH_EIGEN_CHOLMOD
} bench_eigen; /* SimplicialLDLT, CholmodSupernodalLLT */

/* Lower triangle by columns (n, ptr, idx, val), n_rhs right-hand sides, x: solutions, all column-major.
 * compute, solve: seconds. 0, or -1 when the solver failed or memory is short. */
int bench_eigen_solve(bench_eigen kind, int32_t n, const int64_t *ptr, const int64_t *idx, const double *val,
                      int32_t n_rhs, const double *rhs, double *x, double *compute, double *solve);

const char *bench_eigen_version(void);

#ifdef __cplusplus
}
#endif
#endif
