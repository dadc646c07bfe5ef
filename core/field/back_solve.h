/* back_solve.h - x := L'^-1 x for some right-hand sides side by side: the half of a solve that reads the
 * whole factor. */
#ifndef SN_FIELD_BACK_SOLVE_H
#define SN_FIELD_BACK_SOLVE_H

#include "field/cholesky_private.h"

#define SN_LANES_MAX 12 /* right-hand sides in a lane: their sums stay in registers */
#define SN_STRIP_MAX 24 /* right-hand sides that go back together                   */

/* Some right-hand sides: n x width, row-major, in the order of elimination. */
typedef struct sn_lane {
    double *x;
    int32_t n, width; /* right-hand sides; values per row that they take */
} sn_lane;

int32_t sn_lane_width(int32_t n_rhs); /* for n_rhs <= SN_LANES_MAX */

/* All lanes together: a supernode is read once. Each column gets the same bits whatever stands beside it, but
 * for one that goes alone. Errors: SN_ENOMEM, SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_back_solve(const cholmod_factor *f, const sn_lane *lane, int32_t n_lane,
                                    const sn_run *run, sn_error *err);

#endif
