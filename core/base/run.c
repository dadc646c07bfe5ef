#define _POSIX_C_SOURCE 200809L
#include "base/run.h"

#include "base/alloc.h"

#include <time.h>
#ifdef _OPENMP
#include <omp.h>
#endif

double sn_clock(void)
{
    struct timespec t;
    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int sn_run_threads(const sn_run *run)
{
    if (run && run->n_threads > 0) return run->n_threads;
#ifdef _OPENMP
    return omp_get_num_procs();
#else
    return 1;
#endif
}

bool sn_run_stopped(const sn_run *run)
{
    if (!run) return false;
    if (run->cancel && *run->cancel) return true;
    return run->deadline > 0.0 && sn_clock() > run->deadline;
}

sn_status sn_run_step(const sn_run *run, const char *step, double fraction, sn_error *err)
{
    if (!run) return SN_OK;
    if (run->progress) run->progress(run->user, step, fraction);
    if (run->cancel && *run->cancel) return sn_fail(err, SN_ECANCEL, "interrupted while %s", step);
    if (run->deadline > 0.0 && sn_clock() > run->deadline)
        return sn_fail(err, SN_ELIMIT, "time limit reached while %s", step);
    return SN_OK;
}

typedef struct outcome {
    sn_status status;
    sn_error error;
} outcome;

sn_status sn_run_each(const sn_run *run, int32_t n, sn_each_fn fn, void *user, sn_error *err)
{
    outcome *of = SN_NEW_ZERO(outcome, n);
    if (!of) return sn_fail(err, SN_ENOMEM, "no memory for %d items", n);
    int threads = sn_run_threads(run), at_once = threads < n ? threads : n;
    sn_run each = run ? *run : (sn_run){0};
    each.progress = NULL; /* only the thread that called may report */
    each.n_threads = at_once > 0 ? threads / at_once : threads;
    if (at_once <= 1) { /* inside a team of one, nested teams would make new threads each time */
        for (int32_t i = 0; i < n; i++) of[i].status = fn(user, i, &each, &of[i].error);
    } else {
#pragma omp parallel for schedule(dynamic, 1) num_threads(at_once)
        for (int32_t i = 0; i < n; i++) of[i].status = fn(user, i, &each, &of[i].error);
    }
    sn_status st = SN_OK;
    for (int32_t i = 0; i < n && !st; i++) {
        st = of[i].status;
        if (st && err) *err = of[i].error;
    }
    sn_release(of);
    return st;
}
