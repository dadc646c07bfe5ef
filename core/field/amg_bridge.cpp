#include "field/amg_bridge.h"

#define HAVE_SUITESPARSE_UMFPACK 1 /* for the coarsest level: exact, so that a cycle is one linear map */

#include <dune/istl/bcrsmatrix.hh>
#include <dune/istl/bvector.hh>
#include <dune/istl/operators.hh>
#include <dune/istl/paamg/amg.hh>
#include <dune/istl/preconditioners.hh>
#include <dune/istl/umfpack.hh>

#include <algorithm>
#include <exception>
#include <memory>
#include <new>

namespace
{

using Matrix = Dune::BCRSMatrix<double>;
using Vector = Dune::BlockVector<double>;
using Operator = Dune::MatrixAdapter<Matrix, Vector, Vector>;
using Smoother = Dune::SeqSSOR<Matrix, Vector, Vector>;
using Amg = Dune::Amg::AMG<Operator, Vector, Smoother>;
using Criterion =
    Dune::Amg::CoarsenCriterion<Dune::Amg::SymmetricCriterion<Matrix, Dune::Amg::FirstDiagonal>>;

constexpr int most_levels = 15, coarsest = 2000, space = 3;

/* Exceptions end here. */
template <typename Function> sn_status guarded(const char *what, sn_error *err, Function call)
{
    try {
        call();
        return SN_OK;
    } catch (const std::bad_alloc &) {
        return sn_fail(err, SN_ENOMEM, "%s: no memory", what);
    } catch (const std::exception &e) {
        return sn_fail(err, SN_ESOLVE, "%s: %s", what, e.what());
    } catch (...) {
        return sn_fail(err, SN_ESOLVE, "%s: DUNE failed", what);
    }
}

void put_values(Matrix &a, const double *val)
{
    for (auto row = a.begin(); row != a.end(); ++row)
        for (auto entry = row->begin(); entry != row->end(); ++entry) *entry = *val++;
}

std::shared_ptr<Matrix> copy_matrix(int32_t n, const int64_t *ptr, const int32_t *idx, const double *val)
{
    auto a = std::make_shared<Matrix>();
    const auto size = static_cast<std::size_t>(n);
    a->setBuildMode(Matrix::row_wise);
    a->setSize(size, size, static_cast<std::size_t>(ptr[n]));
    for (auto row = a->createbegin(); row != a->createend(); ++row)
        for (int64_t k = ptr[row.index()]; k < ptr[row.index() + 1]; k++)
            row.insert(static_cast<std::size_t>(idx[k]));
    put_values(*a, val);
    return a;
}

} // namespace

struct sn_amg {
    std::shared_ptr<Matrix> matrix;
    std::shared_ptr<const Operator> op;
    std::unique_ptr<Amg> amg;
};

struct sn_amg_cycle {
    std::unique_ptr<Amg> amg; /* shares the levels, has vectors of its own */
    Vector z, r;
};

sn_status sn_amg_create(sn_amg **out, int32_t n, const int64_t *ptr, const int32_t *idx, const double *val,
                        sn_error *err)
{
    *out = nullptr;
    return guarded("multigrid", err, [&] {
        auto a = std::make_unique<sn_amg>();
        a->matrix = copy_matrix(n, ptr, idx, val);
        a->op = std::make_shared<const Operator>(a->matrix);
        Criterion criterion(most_levels, coarsest);
        criterion.setDefaultValuesIsotropic(space);
        criterion.setDebugLevel(0);
        Amg::SmootherArgs smoothing;
        smoothing.iterations = 1;
        smoothing.relaxationFactor = 1.0;
        a->amg = std::make_unique<Amg>(*a->op, criterion, smoothing);
        *out = a.release();
    });
}

void sn_amg_destroy(sn_amg *a)
{
    delete a;
}

void sn_amg_set_values(sn_amg *a, const double *val)
{
    put_values(*a->matrix, val);
}

sn_status sn_amg_cycle_create(sn_amg_cycle **out, const sn_amg *a, sn_error *err)
{
    *out = nullptr;
    return guarded("multigrid", err, [&] {
        auto c = std::make_unique<sn_amg_cycle>();
        c->z.resize(a->matrix->N());
        c->r.resize(a->matrix->N());
        c->z = 0.0;
        c->r = 0.0;
        c->amg = std::make_unique<Amg>(*a->amg);
        c->amg->pre(c->z, c->r);
        *out = c.release();
    });
}

void sn_amg_cycle_destroy(sn_amg_cycle *c)
{
    if (!c) return;
    (void)guarded("multigrid", nullptr, [&] { c->amg->post(c->z); });
    delete c;
}

sn_status sn_amg_apply(sn_amg_cycle *c, const double *r, double *z, sn_error *err)
{
    return guarded("multigrid", err, [&] {
        for (std::size_t i = 0; i < c->r.size(); i++) c->r[i] = r[i];
        c->z = 0.0;
        c->amg->apply(c->z, c->r);
        for (std::size_t i = 0; i < c->z.size(); i++) z[i] = c->z[i];
    });
}
