/* amg_bridge.h - algebraic multigrid as a preconditioner, by DUNE's iterative solver template library
 * (aggregation, symmetric Gauss-Seidel, UMFPACK on the coarsest level). */
#ifndef SN_FIELD_AMG_BRIDGE_H
#define SN_FIELD_AMG_BRIDGE_H

#include "base/status.h"

#include <stdint.h>

SN_BEGIN_DECLS

typedef struct sn_amg sn_amg; /* opaque; const = may be used by many threads, each with a cycle of its own */

/* A symmetric positive definite matrix, stored whole: row i holds its entries ptr[i] .. ptr[i + 1] - 1 by
 * ascending column. Copied. Deterministic. Errors: SN_ESOLVE (says what DUNE says), SN_ENOMEM. */
SN_MUST_USE sn_status sn_amg_create(sn_amg **out, int32_t n, const int64_t *ptr, const int32_t *idx,
                                    const double *val, sn_error *err);
void sn_amg_destroy(sn_amg *a); /* NULL is fine */
/* Other values, all that create was given: for the finest level; the coarser ones stay, and serve as long as
 * the values are near. Not while cycles are applied. */
void sn_amg_set_values(sn_amg *a, const double *val);

typedef struct sn_amg_cycle sn_amg_cycle; /* opaque: the vectors of one V-cycle; for one thread */

/* a: borrowed. Errors: SN_ENOMEM, SN_ESOLVE. */
SN_MUST_USE sn_status sn_amg_cycle_create(sn_amg_cycle **out, const sn_amg *a, sn_error *err);
void sn_amg_cycle_destroy(sn_amg_cycle *c); /* NULL is fine */
/* z := about A^-1 r, a symmetric positive definite map. r, z: n. Errors: SN_ESOLVE. */
SN_MUST_USE sn_status sn_amg_apply(sn_amg_cycle *c, const double *r, double *z, sn_error *err);

SN_END_DECLS

#endif
