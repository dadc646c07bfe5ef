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

/* Signals stay with the threads that there were. */
static bool start_thread(pthread_t *thread, void *(*fn)(void *), void *arg)
{
    sigset_t all, before;
    (void)sigfillset(&all);
    (void)pthread_sigmask(SIG_SETMASK, &all, &before);
    bool ok = pthread_create(thread, NULL, fn, arg) == 0;
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
    return ok;
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
    const sn_run *outer;
    sn_run run; /* of each */
    int32_t n;
    sn_each_fn fn;
    void *user;
    outcome *of;
    atomic_int next, n_done;
} items;

static void work(items *w, const sn_run *run)
{
    for (int i = atomic_fetch_add(&w->next, 1); i < w->n; i = atomic_fetch_add(&w->next, 1)) {
        w->of[i].status = w->fn(w->user, i, run, &w->of[i].error);
        (void)atomic_fetch_add(&w->n_done, 1);
    }
}

static void *help(void *arg)
{
    items *w = arg;
    work(w, &w->run);
    return NULL;
}

/* What an item of the caller's thread reports, as a part of all items. */
static void report_item(void *user, const char *step, double fraction)
{
    const items *w = user;
    double of_all = fraction < 0.0 ? fraction : (atomic_load(&w->n_done) + fraction) / w->n;
    w->outer->progress(w->outer->user, step, of_all < 1.0 ? of_all : 1.0);
}

/* The caller works, too; threads that cannot be had are done without. */
static void work_together(items *w, pthread_t *helper, int n_helper)
{
    sn_run own = w->run;
    int n = 0;
    if (w->outer && w->outer->progress) {
        own.progress = report_item;
        own.user = w;
    }
    while (n < n_helper && start_thread(&helper[n], help, w)) n++;
    work(w, &own);
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

int sn_run_count_at_once(const sn_run *run, int32_t n)
{
    return count_at_once(sn_run_threads(run), n);
}

sn_status sn_run_each(const sn_run *run, int32_t n, sn_each_fn fn, void *user, sn_error *err)
{
    int threads = sn_run_threads(run), at_once = count_at_once(threads, n);
    items w = {.outer = run,
               .run = run ? *run : (sn_run){0},
               .n = n,
               .fn = fn,
               .user = user,
               .of = SN_NEW_ZERO(outcome, n)};
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

/* ---- what cannot be stopped ---- */

#define LOOK_EVERY 50e6 /* nanoseconds */

static atomic_int n_left_behind; /* of the process, as the threads are */

typedef struct apart {
    pthread_mutex_t lock;
    pthread_cond_t done;
    bool is_done, is_left;
    void (*fn)(void *job), (*leave)(void *job);
    void *job;
} apart;

static void apart_free(apart *a)
{
    (void)pthread_mutex_destroy(&a->lock);
    (void)pthread_cond_destroy(&a->done);
    sn_release(a);
}

static void *work_apart(void *arg)
{
    apart *a = arg;
    a->fn(a->job);
    (void)pthread_mutex_lock(&a->lock);
    a->is_done = true;
    bool is_left = a->is_left;
    (void)pthread_cond_signal(&a->done);
    (void)pthread_mutex_unlock(&a->lock);
    if (!is_left) return NULL;
    a->leave(a->job);
    apart_free(a);
    (void)atomic_fetch_sub(&n_left_behind, 1);
    return NULL;
}

/* Holds the lock, but for the wait. */
static sn_status wait_for(apart *a, const sn_run *run, const char *step, sn_error *err)
{
    sn_status st = SN_OK;
    while (!a->is_done && !st) {
        struct timespec until;
        (void)clock_gettime(CLOCK_REALTIME, &until);
        double ns = (double)until.tv_nsec + LOOK_EVERY;
        until.tv_sec += ns >= 1e9;
        until.tv_nsec = (long)(ns >= 1e9 ? ns - 1e9 : ns);
        (void)pthread_cond_timedwait(&a->done, &a->lock, &until);
        if (!a->is_done) st = sn_run_step(run, step, -1.0, err);
    }
    return a->is_done ? SN_OK : st;
}

sn_status sn_run_apart(const sn_run *run, const char *step, void (*fn)(void *job), void (*leave)(void *job),
                       void *job, sn_error *err)
{
    pthread_t thread;
    bool is_free = !run || (!run->progress && !run->cancel && !(run->deadline > 0.0));
    apart *a = is_free ? NULL : SN_NEW_ZERO(apart, 1);
    if (a) {
        *a = (apart){.fn = fn, .leave = leave, .job = job};
        (void)pthread_mutex_init(&a->lock, NULL);
        (void)pthread_cond_init(&a->done, NULL);
    }
    if (!a || !start_thread(&thread, work_apart, a)) { /* no thread to be had: it is done all the same */
        if (a) apart_free(a);
        fn(job);
        return SN_OK;
    }
    (void)pthread_mutex_lock(&a->lock);
    sn_status st = wait_for(a, run, step, err);
    a->is_left = st != SN_OK;
    if (st) (void)atomic_fetch_add(&n_left_behind, 1);
    (void)pthread_mutex_unlock(&a->lock);
    if (st) {
        (void)pthread_detach(thread);
        return st;
    }
    (void)pthread_join(thread, NULL);
    apart_free(a);
    return SN_OK;
}

int sn_run_left_behind(void)
{
    return atomic_load(&n_left_behind);
}
