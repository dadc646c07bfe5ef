/* half_cache.h - half solves that are kept while their right-hand sides and the factor stay as they are. */
#ifndef SN_FIELD_HALF_CACHE_H
#define SN_FIELD_HALF_CACHE_H

#include "field/half_solve.h"

typedef struct sn_half_place { /* where the half solve of a right-hand side is */
    int32_t i_batch, column;
    uint64_t hash; /* of its entries */
} sn_half_place;

typedef struct sn_half_batch { /* half solves made together */
    sn_half_solve *z;          /* owned */
    uint64_t last_use;
} sn_half_batch;

typedef struct sn_half_cache { /* zero-initialised = empty */
    sn_half_batch *batch;      /* n_batch; owned */
    int32_t n_batch;
    uint64_t n_use;
    sn_half_place *place; /* n_place: all that is there; owned */
    int32_t n_place;
} sn_half_cache;

void sn_half_cache_free(sn_half_cache *h); /* then empty */
/* The half solves of b by a factor that must be the same for as long as the cache is not freed: what is there
 * already, and the rest as one batch. place: b->n, receives where they are. Errors: SN_ENOMEM, SN_ECANCEL,
 * SN_ELIMIT. */
SN_MUST_USE sn_status sn_half_cache_need(sn_half_cache *h, const sn_cholesky *c, const sn_sparse_vectors *b,
                                         const sn_run *run, sn_half_place *place, sn_error *err);

#endif
