/* dense.h - small dense systems, by LAPACK on one thread: the same bits on every run of one machine. */
#ifndef SN_BASE_DENSE_H
#define SN_BASE_DENSE_H

#include "base/status.h"

#include <stdint.h>

/* Solves a x = b for a symmetric positive definite a (n x n, whole; overwritten) and n_rhs columns of x
 * (right-hand sides in, solutions out). Errors: SN_ESOLVE (not positive definite: names the column). */
SN_MUST_USE sn_status sn_dense_solve_spd(double *a, int32_t n, double *x, int32_t n_rhs, sn_error *err);

/* LU factors of a (n x n, column-major; overwritten), with partial pivoting. pivot: n. Errors: SN_ESOLVE
 * (singular: names the column). */
SN_MUST_USE sn_status sn_dense_factorize(double *a, int32_t n, int32_t *pivot, sn_error *err);
/* Solves a x = b by these: n_rhs columns of x, right-hand sides in, solutions out. Errors: SN_ESOLVE (an
 * argument that LAPACK refuses). */
SN_MUST_USE sn_status sn_dense_solve_factorized(const double *a, int32_t n, const int32_t *pivot, double *x,
                                                int32_t n_rhs, sn_error *err);

/* a += r^T r, for r of n_row x n, row-major, and a symmetric a (n x n, whole before and after). */
void sn_dense_add_gram(const double *r, int32_t n_row, int32_t n, double *a);

#endif
