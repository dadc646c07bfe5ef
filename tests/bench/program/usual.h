/* usual.h - the usual way to solve the systems: CHOLMOD, supernodal, ordered by METIS; the analysis is kept
 * as long as the mesh is, an edit costs a new numeric factorization and all right-hand sides. */
#ifndef BENCH_USUAL_H
#define BENCH_USUAL_H

#include "system.h"

#include <cholmod.h>

typedef struct bench_usual { /* zero-initialised = empty; opened by the first solve */
    cholmod_common common;
    cholmod_factor *factor;
    bool is_open;
} bench_usual;
void bench_usual_free(bench_usual *u);

typedef struct bench_times {
    double analysis; /* seconds; 0 where it was kept                                */
    double factor;   /* with the analysis where a library's users do both together  */
    double solve;
    int64_t entries; /* of the factor, 0: not known                                 */
} bench_times;

/* Solves s, x receives the solutions. n_threads: of OpenBLAS and CHOLMOD, 0: as they choose. Errors:
 * SN_ESOLVE. */
SN_MUST_USE sn_status bench_usual_solve(bench_usual *u, bench_system *s, int n_threads, bench_times *times,
                                        sn_error *err);

/* Lets OpenBLAS and CHOLMOD use n_threads, 0: as many as they choose. The library sets one thread for its own
 * calls. */
void bench_use_threads(int n_threads);

#endif
