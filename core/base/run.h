/* run.h - the circumstances a long step runs in: threads, progress, interruption, a deadline.
 *
 * Every function that may take longer than a blink takes a `const sn_run *run`; NULL means one thread per
 * core, no progress, no interruption. No result depends on the number of threads. */
#ifndef SN_BASE_RUN_H
#define SN_BASE_RUN_H

#include "base/status.h"

#include <signal.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct sn_run {
    int n_threads; /* 0: one per core                                          */
    const volatile sig_atomic_t
        *cancel;     /* nonzero: stop; NULL: cannot be stopped. May be set by a signal handler */
    double deadline; /* sn_clock() after which to stop with SN_ELIMIT; 0: none   */
    void (*progress)(void *user, const char *step, double fraction); /* fraction in 0..1; < 0 unknown; NULL:
                                             none. Called from the thread that started the step only.       */
    void *user;
} sn_run;

double sn_clock(void);                  /* monotonic seconds */
int sn_run_threads(const sn_run *run);  /* at least 1 */
bool sn_run_stopped(const sn_run *run); /* cheap; from any thread */
/* Reports progress and checks for a stop. SN_ECANCEL "interrupted" or SN_ELIMIT "time limit reached" with the
 * step. */
SN_MUST_USE sn_status sn_run_step(const sn_run *run, const char *step, double fraction, sn_error *err);

/* A call into a library that cannot be stopped, on a thread of its own. Reports progress and returns as soon
 * as the run is stopped; job then belongs to that thread, which ends in its time and calls leave(job). So fn
 * may touch nothing that is not the job's. Otherwise leave is not called and the job is the caller's as
 * before. Without anything to report or to stop for, fn is called as it is. Errors: SN_ECANCEL, SN_ELIMIT
 * (job is gone). */
SN_MUST_USE sn_status sn_run_apart(const sn_run *run, const char *step, void (*fn)(void *job),
                                   void (*leave)(void *job), void *job, sn_error *err);
/* Threads left behind by the above that have not ended: while there are any, the process is better ended by
 * _exit, which does not take the libraries away from under them. */
int sn_run_left_behind(void);

/* Calls fn for i = 0 .. n - 1, many at a time: as many as the run has threads, or up to half as many more
 * where that evens the load and the run has the whole machine anyway (three on two cores). Each call gets a
 * run with its share of the threads; the items that the caller's own thread does report progress, as a part
 * of all. An item must not depend on another. All are called even when one fails; the error is that of the
 * lowest index. Errors: those of fn, SN_ENOMEM. */
typedef sn_status (*sn_each_fn)(void *user, int32_t i, const sn_run *run, sn_error *err);
SN_MUST_USE sn_status sn_run_each(const sn_run *run, int32_t n, sn_each_fn fn, void *user, sn_error *err);
int sn_run_count_at_once(const sn_run *run, int32_t n); /* how many of n items that does at a time */

#endif
