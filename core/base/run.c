#define _POSIX_C_SOURCE 200809L
#include "base/run.h"

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
