/* cholesky_order.h - the analysis of a sparse pattern: order of elimination, supernodes, and the lower
 * triangle in that order. Made once for a pattern, shared by all that factorize matrices of it. */
#ifndef SN_FIELD_CHOLESKY_ORDER_H
#define SN_FIELD_CHOLESKY_ORDER_H

#include "field/cholesky_private.h"

/* ordering_method: CHOLMOD_METIS or CHOLMOD_AMD. One user: the caller. Errors: SN_ENOMEM, SN_ESOLVE,
 * SN_ECANCEL. */
SN_MUST_USE sn_status sn_order_create(sn_order **out, const sn_csr *a, const int32_t *number, int32_t n,
                                      int ordering_method, const sn_run *run, sn_error *err);
void sn_order_use(sn_order *o);   /* one user more */
void sn_order_leave(sn_order *o); /* one less; the last one frees it; NULL is fine */

/* CHOLMOD's settings for all we do with it. */
void sn_cholmod_start(cholmod_common *c);
/* CHOLMOD and OpenBLAS on the caller's thread alone; returns what to hand to the other. */
int sn_cholmod_one_thread(void);
void sn_cholmod_threads_again(int levels);
SN_MUST_USE sn_status sn_cholmod_fail(const cholmod_common *c, const char *what, sn_error *err);

#endif
