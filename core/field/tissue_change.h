/* tissue_change.h - what the rows of a matrix L + alpha B'B have gained and lost since it was factorized, as
 * terms on its unknowns (see low_rank.h). */
#ifndef SN_FIELD_TISSUE_CHANGE_H
#define SN_FIELD_TISSUE_CHANGE_H

#include "field/tissue_rows.h"

typedef struct sn_tissue_change { /* zero-initialised = empty; owned                                      */
    sn_row *row; /* n_row: gained ones, lost ones, then ones that went since a field was solved for */
    int32_t n_gained, n_term, n_row; /* n_term: gained and lost                                           */
    int32_t *ptr, *index;            /* n_row + 1, ptr[n_row]: unknowns of the rows                       */
    double *value, *weight;          /* ptr[n_row], n_row: alpha, or minus that                           */
    int32_t n_touched;               /* unknowns of the terms                                             */
    int32_t *probe, n_probe;         /* unknowns of those that went, each once                            */
} sn_tissue_change;

/* base: the rows in the factor. past: rows that fields were solved for. Errors: SN_ENOMEM; c is then empty.
 */
SN_MUST_USE sn_status sn_tissue_change_find(sn_tissue_change *c, const sn_row_set *base,
                                            const sn_tissue_rows *rows, const sn_row_set *past,
                                            sn_error *err);
void sn_tissue_change_free(sn_tissue_change *c);

#endif
