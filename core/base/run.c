#define _POSIX_C_SOURCE 200809L
#include "base/run.h"

#include "base/alloc.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
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

static int n_processors(void)
{
#ifdef _OPENMP
    return omp_get_num_procs();
#else
    return 1;
#endif
}

int sn_run_threads(const sn_run *run)
{
    return run && run->n_threads > 0 ? run->n_threads : n_processors();
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

/* ---- many items ----
 *
 * Threads of our own, not a team of OpenMP's: in a team, each parallel loop of a library (CHOLMOD has
 * hundreds of thousands of small ones) makes a new team behind a lock, and two factorizations side by side
 * take three times as long as one. */

typedef struct outcome {
    sn_status status;
    sn_error error;
} outcome;

typedef struct items {
    sn_run run; /* of each */
    int32_t n;
    sn_each_fn fn;
    void *user;
    outcome *of;
    atomic_int next;
} items;

static void *work(void *arg)
{
    items *w = arg;
    for (int i = atomic_fetch_add(&w->next, 1); i < w->n; i = atomic_fetch_add(&w->next, 1))
        w->of[i].status = w->fn(w->user, i, &w->run, &w->of[i].error);
    return NULL;
}

/* The caller works, too; threads that cannot be had are done without. Signals stay with the caller's thread.
 */
static void work_together(items *w, pthread_t *helper, int n_helper)
{
    sigset_t all, before;
    int n = 0;
    (void)sigfillset(&all);
    (void)pthread_sigmask(SIG_SETMASK, &all, &before);
    while (n < n_helper && pthread_create(&helper[n], NULL, work, w) == 0) n++;
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
    (void)work(w);
    for (int i = 0; i < n; i++) (void)pthread_join(helper[i], NULL);
}

/* Items take turns on the cores, so 3 of them on 2 cores take 1.5 times as long as one, not 2. */
static int count_at_once(int threads, int32_t n)
{
    if (n <= threads) return n;
    if (threads < n_processors()) return threads;
    int rounds = n / threads, even = (n + rounds - 1) / rounds;
    return even <= threads + threads / 2 ? even : threads;
}

sn_status sn_run_each(const sn_run *run, int32_t n, sn_each_fn fn, void *user, sn_error *err)
{
    int threads = sn_run_threads(run), at_once = count_at_once(threads, n);
    items w = {
        .run = run ? *run : (sn_run){0}, .n = n, .fn = fn, .user = user, .of = SN_NEW_ZERO(outcome, n)};
    pthread_t *helper = SN_NEW(pthread_t, at_once);
    sn_status st = w.of && helper ? SN_OK : sn_fail(err, SN_ENOMEM, "no memory for %d items", n);
    w.run.progress = NULL; /* only the thread that called may report */
    w.run.n_threads = at_once > 0 && at_once < threads ? threads / at_once : 1;
    if (!st) work_together(&w, helper, at_once - 1);
    for (int32_t i = 0; i < n && !st; i++) {
        st = w.of[i].status;
        if (st && err) *err = w.of[i].error;
    }
    sn_release(w.of);
    sn_release(helper);
    return st;
}
