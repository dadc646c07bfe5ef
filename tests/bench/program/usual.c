#include "usual.h"

#include "base/run.h"

#include <omp.h>
#include <string.h>

extern void openblas_set_num_threads(int n); /* not in every cblas.h */
extern int openblas_get_num_procs(void);

void bench_use_threads(int n_threads)
{
    openblas_set_num_threads(n_threads > 0 ? n_threads : openblas_get_num_procs());
    omp_set_max_active_levels(n_threads == 1 ? 0 : 1);
}

void bench_usual_free(bench_usual *u)
{
    if (u->is_open) {
        if (u->factor) cholmod_l_free_factor(&u->factor, &u->common);
        cholmod_l_finish(&u->common);
    }
    memset(u, 0, sizeof *u);
}

static void open_usual(bench_usual *u)
{
    cholmod_l_start(&u->common);
    u->common.print = 0;
    u->common.supernodal = CHOLMOD_SUPERNODAL;
    u->common.nmethods = 1;
    u->common.method[0].ordering = CHOLMOD_METIS;
    u->is_open = true;
}

static cholmod_sparse matrix_of(const bench_system *s)
{
    return (cholmod_sparse){.nrow = (size_t)s->n,
                            .ncol = (size_t)s->n,
                            .nzmax = (size_t)s->ptr[s->n],
                            .p = s->ptr,
                            .i = s->idx,
                            .x = s->val,
                            .stype = -1,
                            .itype = CHOLMOD_LONG,
                            .xtype = CHOLMOD_REAL,
                            .dtype = CHOLMOD_DOUBLE,
                            .sorted = 1,
                            .packed = 1};
}

static bool solve_all(bench_usual *u, bench_system *s)
{
    cholmod_dense b = {.nrow = (size_t)s->n,
                       .ncol = (size_t)s->n_rhs,
                       .nzmax = (size_t)s->n * (size_t)s->n_rhs,
                       .d = (size_t)s->n,
                       .x = s->rhs,
                       .xtype = CHOLMOD_REAL,
                       .dtype = CHOLMOD_DOUBLE};
    cholmod_dense *x = cholmod_l_solve(CHOLMOD_A, u->factor, &b, &u->common);
    if (!x) return false;
    memcpy(s->x, x->x, b.nzmax * sizeof *s->x);
    cholmod_l_free_dense(&x, &u->common);
    return true;
}

sn_status bench_usual_solve(bench_usual *u, bench_system *s, int n_threads, bench_times *times, sn_error *err)
{
    if (!u->is_open) open_usual(u);
    cholmod_sparse a = matrix_of(s);
    memset(times, 0, sizeof *times);
    bench_use_threads(n_threads);
    double t0 = sn_clock();
    bool is_new = !u->factor;
    if (is_new) u->factor = cholmod_l_analyze(&a, &u->common);
    double t1 = sn_clock();
    bool ok = u->factor && cholmod_l_factorize(&a, u->factor, &u->common) && u->common.status == CHOLMOD_OK;
    double t2 = sn_clock();
    ok = ok && solve_all(u, s);
    double t3 = sn_clock();
    bench_use_threads(1);
    if (!ok) return sn_fail(err, SN_ESOLVE, "bench: CHOLMOD failed with status %d", u->common.status);
    *times = (bench_times){.analysis = is_new ? t1 - t0 : 0.0,
                           .factor = t2 - t1,
                           .solve = t3 - t2,
                           .entries = (int64_t)u->factor->xsize};
    return SN_OK;
}
