#include "eigen_bridge.h"

#include <Eigen/CholmodSupport>
#include <Eigen/Sparse>

#include <chrono>
#include <exception>

namespace
{

using matrix = Eigen::SparseMatrix<double>;

double seconds_since(std::chrono::steady_clock::time_point start)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

matrix lower_triangle(int32_t n, const int64_t *ptr, const int64_t *idx, const double *val)
{
    matrix a(n, n);
    a.resizeNonZeros(static_cast<Eigen::Index>(ptr[n]));
    for (int32_t j = 0; j <= n; j++) a.outerIndexPtr()[j] = static_cast<int>(ptr[j]);
    for (int64_t k = 0; k < ptr[n]; k++) {
        a.innerIndexPtr()[k] = static_cast<int>(idx[k]);
        a.valuePtr()[k] = val[k];
    }
    return a;
}

template <class Solver>
int run(const matrix &a, Eigen::Map<const Eigen::MatrixXd> b, Eigen::Map<Eigen::MatrixXd> x, double *compute,
        double *solve)
{
    auto start = std::chrono::steady_clock::now();
    Solver solver;
    solver.compute(a);
    *compute = seconds_since(start);
    if (solver.info() != Eigen::Success) return -1;
    start = std::chrono::steady_clock::now();
    x = solver.solve(b);
    *solve = seconds_since(start);
    return solver.info() == Eigen::Success ? 0 : -1;
}

} // namespace

int bench_eigen_solve(bench_eigen kind, int32_t n, const int64_t *ptr, const int64_t *idx, const double *val,
                      int32_t n_rhs, const double *rhs, double *x, double *compute, double *solve)
{
    try {
        matrix a = lower_triangle(n, ptr, idx, val);
        Eigen::Map<const Eigen::MatrixXd> b(rhs, n, n_rhs);
        Eigen::Map<Eigen::MatrixXd> result(x, n, n_rhs);
        if (kind == BENCH_EIGEN_LDLT)
            return run<Eigen::SimplicialLDLT<matrix, Eigen::Lower>>(a, b, result, compute, solve);
        return run<Eigen::CholmodSupernodalLLT<matrix, Eigen::Lower>>(a, b, result, compute, solve);
    } catch (const std::exception &) {
        return -1;
    }
}

#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)

const char *bench_eigen_version(void)
{
    return TEXT(EIGEN_WORLD_VERSION) "." TEXT(EIGEN_MAJOR_VERSION) "." TEXT(EIGEN_MINOR_VERSION);
}
