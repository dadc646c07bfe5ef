/* back_solve.h - x := L'^-1 x for some right-hand sides side by side: the half of a solve that reads the
 * whole factor. */
#ifndef SN_FIELD_BACK_SOLVE_H
#define SN_FIELD_BACK_SOLVE_H

#include "field/cholesky_private.h"

#define SN_LANES 8 /* right-hand sides come in multiples of this: the most that a vector holds */

int32_t sn_back_solve_width(int32_t n_rhs); /* values per row of x that so many of them take */

typedef struct sn_strip { /* some right-hand sides                                            */
    const sn_cholesky *c;
    double *trunk;  /* n_trunk_row x width, row-major: see tree_cut.h               */
    double *branch; /* rows first .. last - 1 of x, width each; NULL in the trunk   */
    int32_t first, last;
    int32_t width;   /* see above                                                    */
    int32_t from, n; /* columns: multiples of SN_LANES, or the only one              */
    double *below;   /* room for maxesize x n                                        */
} sn_strip;
/* A row of x, in the order of elimination, at column `from`. */
static inline double *sn_strip_row(const sn_strip *s, SuiteSparse_long row)
{
    bool is_here = s->branch && row < s->last;
    size_t i = is_here ? (size_t)(row - s->first) : (size_t)s->c->order->tree.trunk_row[row];
    return (is_here ? s->branch : s->trunk) + i * (size_t)s->width + s->from;
}

/* The rows of supernode k; those of its ancestors are solved for. A column gets the same bits whatever stands
 * beside it, but for one that goes alone. */
void sn_back_solve(const sn_strip *s, size_t k);

#endif
