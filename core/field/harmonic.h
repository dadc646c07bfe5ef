/* harmonic.h - harmonic functions on a tet mesh with given values at some vertices: smooth spreading of data.
 *
 * Vertices without a number have the value 0; elsewhere the boundary is natural (zero normal derivative). One
 * factor per tet mesh serves every set of vertices: with N = L + a whisper of mass (so that N can be
 * inverted) on the numbered vertices, the function that is harmonic off the vertices F and has the values t
 * on them is N^-1 E (E' N^-1 E)^-1 t, E the columns of the identity for F. */
#ifndef SN_FIELD_HARMONIC_H
#define SN_FIELD_HARMONIC_H

#include "field/cholesky.h"

typedef struct sn_harmonic sn_harmonic; /* opaque; const = may be used by many threads */

/* laplacian: of the whole mesh. number: n_vert, one to one onto 0..n-1, or -1. analysis: of that part of the
 * Laplacian (see sn_cholesky_create), NULL: it is made here, which takes longer than all the rest. All
 * borrowed for the call. Errors: SN_ENOMEM, SN_ESOLVE, SN_ECANCEL. */
SN_MUST_USE sn_status sn_harmonic_create(sn_harmonic **out, const sn_csr *laplacian, const int32_t *number,
                                         int32_t n, const sn_cholesky *analysis, const sn_run *run,
                                         sn_error *err);
/* For meshes that are too large for a factor: each solve by conjugate gradients, nothing made before.
 * laplacian: borrowed for as long as the object is used. */
SN_MUST_USE sn_status sn_harmonic_create_iterative(sn_harmonic **out, const sn_csr *laplacian,
                                                   const int32_t *number, int32_t n, sn_error *err);
void sn_harmonic_destroy(sn_harmonic *h);                 /* NULL is fine */
const int32_t *sn_harmonic_numbers(const sn_harmonic *h); /* those given; the object's */

/* fixed: n_fixed >= 1 vertices with a number, all different. value: n_fixed x n_field, column-major. out:
 * n_vert x n_field, column-major; the values at the fixed vertices are exact. A piece of the mesh with no
 * fixed vertex gets 0. Errors: SN_ESOLVE, SN_ENOMEM, SN_ECANCEL. */
SN_MUST_USE sn_status sn_harmonic_solve(const sn_harmonic *h, const int32_t *fixed, int32_t n_fixed,
                                        const double *value, int32_t n_field, const sn_run *run, double *out,
                                        sn_error *err);

#endif
