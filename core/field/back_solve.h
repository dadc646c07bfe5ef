/* back_solve.h - x := L'^-1 x for some right-hand sides side by side: the half of a solve that reads the
 * whole factor. */
#ifndef SN_FIELD_BACK_SOLVE_H
#define SN_FIELD_BACK_SOLVE_H

#include "field/cholesky_private.h"

#define SN_STRIP_MAX 24 /* right-hand sides that go back together */

int32_t sn_strip_width(int32_t n_rhs); /* values per row of x that n_rhs <= SN_STRIP_MAX of them take */

/* x: n x width, row-major, in the order of elimination; width as above. Each column gets the same bits
 * whatever stands beside it, but for one that goes alone. Errors: SN_ENOMEM, SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_back_solve(const cholmod_factor *f, double *x, int32_t width, const sn_run *run,
                                    sn_error *err);

#endif
