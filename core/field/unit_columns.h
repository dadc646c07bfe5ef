/* unit_columns.h - half solves of columns of the identity, and their products: entries of the inverse. They
 * are kept for as long as most of them are of use. */
#ifndef SN_FIELD_UNIT_COLUMNS_H
#define SN_FIELD_UNIT_COLUMNS_H

#include "field/half_solve.h"

typedef struct sn_unit_part { /* columns that were half solved together */
    sn_half_solve *y;         /* owned */
    int32_t first, n;
} sn_unit_part;

typedef struct sn_unit_columns { /* zero-initialised but for c = empty                          */
    const sn_cholesky *c;        /* borrowed with its factor                                    */
    sn_unit_part *part;          /* n_part; owned                                               */
    int32_t n_part;
    int32_t *unknown; /* width: of each column; owned                                           */
    int32_t width;
    double *gram;        /* width x width: Y'Y = E' A^-1 E; owned                                      */
    uint64_t generation; /* another one after columns were given up                              */
} sn_unit_columns;

void sn_unit_columns_free(sn_unit_columns *u); /* then empty */
/* unknown: n, each once. column: n, receives where each is; columns that are there are not solved for again.
 * Errors: SN_ENOMEM, SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_unit_columns_need(sn_unit_columns *u, const int32_t *unknown, int32_t n,
                                           int32_t *column, const sn_run *run, sn_error *err);

#endif
