/* half_cache.h - half solves that are kept while the factor stays as it is. A right-hand side that differs
 * from one that is kept only at unknowns which have columns of their own needs no new one. */
#ifndef SN_FIELD_HALF_CACHE_H
#define SN_FIELD_HALF_CACHE_H

#include "field/unit_columns.h"

typedef struct sn_half_batch { /* half solves made together                  */
    sn_half_solve *z;          /* owned                                      */
    int32_t *ptr, *index;      /* their right-hand sides; owned              */
    double *value;
    uint64_t *key;
    double **product; /* n_product: Y'Z with parts of columns, NULL where it was not asked for; owned */
    int32_t n_product;
    uint64_t generation; /* of these columns */
    uint64_t last_use;
} sn_half_batch;

typedef struct sn_half_cache { /* zero-initialised = empty                   */
    sn_half_batch *batch;      /* n_batch; owned                             */
    int32_t n_batch;
    uint64_t n_use;
} sn_half_cache;

typedef struct sn_half_place { /* where a half solve is                      */
    int32_t i_batch, column;   /* i_batch -1: columns of unknowns are enough */
} sn_half_place;

void sn_half_cache_free(sn_half_cache *h); /* then empty */

typedef struct sn_half_wanted { /* borrowed                                                      */
    sn_sparse_vectors b;        /* an unknown is in a vector once                                */
    const uint64_t *key;        /* b.n: what each is of; those kept with the same key are looked at */
    const sn_unit_columns *e;
    int32_t n_unknown;
} sn_half_wanted;
/* Half solves of b by a factor that must be the same for as long as the cache is not freed; what is missing
 * is made as one batch. place: b.n. rest: e->width x b.n, column-major: what is to be added to the right-hand
 * side of a place, at the unknowns of the columns, so that it is b's. Errors: SN_ENOMEM, SN_ECANCEL,
 * SN_ELIMIT. */
SN_MUST_USE sn_status sn_half_cache_need(sn_half_cache *h, const sn_half_wanted *w, const sn_run *run,
                                         sn_half_place *place, double *rest, sn_error *err);
/* seen := Y'Z of n places with all columns, e->width x n, column-major; 0 for places without a batch. What
 * was multiplied before is known. Errors: SN_ENOMEM, SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_half_cache_see(sn_half_cache *h, const sn_unit_columns *e,
                                        const sn_half_place *place, int32_t n, const sn_run *run,
                                        double *seen, sn_error *err);

#endif
