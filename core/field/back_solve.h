/* back_solve.h - x := L'^-1 x for some right-hand sides side by side: the half of a solve that reads the
 * whole factor. */
#ifndef SN_FIELD_BACK_SOLVE_H
#define SN_FIELD_BACK_SOLVE_H

#include "field/cholesky_private.h"

#define SN_LANES 4 /* right-hand sides in a vector */

int32_t sn_back_solve_width(int32_t n_rhs); /* values per row of x that so many of them take */

typedef struct sn_strip { /* some right-hand sides */
    double *x;            /* n x width, row-major, in the order of elimination */
    int32_t width;        /* see above                                         */
    int32_t from, n;      /* columns: multiples of SN_LANES, or the only one   */
    double *below;        /* room for maxesize x n                             */
} sn_strip;
/* The rows of supernode k; those of its ancestors are solved for. A column gets the same bits whatever stands
 * beside it, but for one that goes alone. */
void sn_back_solve(const cholmod_factor *f, size_t k, const sn_strip *s);

#endif
