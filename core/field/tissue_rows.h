/* tissue_rows.h - sets of collocation rows, and what one has that another has not. */
#ifndef SN_FIELD_TISSUE_ROWS_H
#define SN_FIELD_TISSUE_ROWS_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

typedef struct sn_row { /* of B: a point of a tet */
    int32_t tet;
    double bary[4];
} sn_row;

typedef struct sn_row_set { /* ascending; a row may be there several times */
    sn_row *row;            /* n; owned */
    int32_t n;
} sn_row_set;

void sn_row_set_free(sn_row_set *s);
void sn_row_set_sort(sn_row_set *s);
SN_MUST_USE sn_status sn_row_set_copy(sn_row_set *to, const sn_row_set *from, sn_error *err);
/* out := the rows of both, each once. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_row_set_join(const sn_row_set *a, const sn_row_set *b, sn_row_set *out,
                                      sn_error *err);
/* What from has and other has not, with a row counted as often as it is there. out: room for from->n rows;
 * returns how many there are. */
int32_t sn_row_set_less(const sn_row_set *from, const sn_row_set *other, sn_row *out);

/* The rows of curves, and what places them in a matrix. */
typedef struct sn_tissue_rows { /* borrowed */
    const sn_row_set *set;
    uint64_t revision;     /* > 0; another one for other rows or another alpha */
    const int32_t *tet;    /* of the mesh: corners                             */
    const int32_t *number; /* unknown of each vertex, -1 for none              */
    int32_t n_free;        /* unknowns                                         */
    double alpha;
} sn_tissue_rows;

#endif
