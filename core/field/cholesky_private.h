/* cholesky_private.h - what the files of the Cholesky solver share. */
#ifndef SN_FIELD_CHOLESKY_PRIVATE_H
#define SN_FIELD_CHOLESKY_PRIVATE_H

#include "field/cholesky.h"
#include "field/tree_cut.h"

#include <cblas.h>
#include <cholmod.h>
#include <stdatomic.h>

/* The analysis of a pattern; clones share it. Columns are counted in the order of elimination. */
typedef struct sn_order {
    atomic_int users;
    cholmod_common common;
    cholmod_factor *symbolic;
    int32_t n, n_row;            /* unknowns, rows of the whole matrix                              */
    int32_t *place;              /* n_row: column of each row, -1 for none                          */
    int32_t *column_of;          /* n: column of each unknown                                       */
    int32_t *super_of;           /* n: supernode of each column                                     */
    SuiteSparse_long *ptr, *idx; /* lower triangle: n + 1, ptr[n]; by ascending row in each column   */
    int64_t *from;               /* ptr[n]: where the whole matrix holds it                         */
    sn_tree_cut tree;
} sn_order;

struct sn_cholesky {
    cholmod_common common;
    sn_order *order;
    cholmod_factor *factor;
    double *val; /* of the lower triangle: the matrix that was factorized */
    bool is_factorized;
};

/* OpenBLAS's own: not in every cblas.h. With two threads it cuts its work elsewhere and the last bits change:
 * always 1. */
extern void openblas_set_num_threads(int n);

/* ---- supernodes of a factor ---- */

static inline const SuiteSparse_long *sn_supers(const cholmod_factor *f)
{
    return f->super;
}

static inline int sn_super_own(const cholmod_factor *f, size_t k) /* its columns */
{
    return (int)(sn_supers(f)[k + 1] - sn_supers(f)[k]);
}

static inline int sn_super_all(const cholmod_factor *f, size_t k) /* its rows */
{
    const SuiteSparse_long *pi = f->pi;
    return (int)(pi[k + 1] - pi[k]);
}

/* The rows of supernode k, its own first. */
static inline const SuiteSparse_long *sn_super_rows(const cholmod_factor *f, size_t k)
{
    const SuiteSparse_long *pi = f->pi, *row = f->s;
    return row + pi[k];
}

/* all x own, column-major. */
static inline const double *sn_super_block(const cholmod_factor *f, size_t k)
{
    const SuiteSparse_long *px = f->px;
    return (const double *)f->x + px[k];
}

#endif
