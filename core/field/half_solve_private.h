/* half_solve_private.h - how half solves lie in memory: what going forward and going back share. */
#ifndef SN_FIELD_HALF_SOLVE_PRIVATE_H
#define SN_FIELD_HALF_SOLVE_PRIVATE_H

#include "field/cholesky_private.h"
#include "field/half_solve.h"

struct sn_half_solve {
    const sn_cholesky *c;
    int64_t *at;           /* n_super: first row in y, -1 when on no path          */
    int32_t *first, *last; /* n_super: columns of y that may not be zero there     */
    int32_t *step, n_step; /* supernodes on some path, ascending                   */
    double *y;             /* n_row x n_col, column-major                          */
    int64_t n_row;
    int32_t n_below; /* most rows below a supernode on a path */
    int32_t n_col;
};

#endif
