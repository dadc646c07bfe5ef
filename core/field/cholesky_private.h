/* cholesky_private.h - what the files of the Cholesky solver share. */
#ifndef SN_FIELD_CHOLESKY_PRIVATE_H
#define SN_FIELD_CHOLESKY_PRIVATE_H

#include "field/cholesky.h"

#include <cblas.h>
#include <cholmod.h>

struct sn_cholesky {
    cholmod_common common;
    cholmod_factor *symbolic; /* the analysis, for clones */
    cholmod_factor *factor;
    int32_t *place; /* n_row of the matrix: where each comes in the order of elimination, -1 for none */
    int32_t n, n_row;
};

/* OpenBLAS's own: not in every cblas.h. With two threads it cuts its work elsewhere and the last bits change:
 * always 1. */
extern void openblas_set_num_threads(int n);

#endif
