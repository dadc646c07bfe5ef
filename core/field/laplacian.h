/* laplacian.h - the linear finite-element (cotangent) Laplacian of a tet mesh, in normalized lengths.
 *
 * Lengths are divided by the box diagonal of the mesh, so that the matrix - and with it every field - is the
 * same in metres and in millimetres. */
#ifndef SN_FIELD_LAPLACIAN_H
#define SN_FIELD_LAPLACIAN_H

#include "base/run.h"
#include "mesh/tet_mesh.h"

#include <stdint.h>

typedef struct sn_csr { /* open; a symmetric matrix stored whole: row i holds its entries by ascending column
                         */
    int64_t *ptr;       /* n + 1                                     */
    int32_t *idx;       /* ptr[n]                                    */
    double *val;        /* ptr[n]                                    */
    int32_t n;
} sn_csr;
void sn_csr_free(sn_csr *a);
/* Where entry (i, j) is; -1 when it is not in the pattern. O(log row). */
int64_t sn_csr_find(const sn_csr *a, int32_t i, int32_t j);

/* Gradients of the four barycentric coordinates, per unit of length of the mesh; returns the volume. */
double sn_tet_gradients(const sn_tet_mesh *m, int32_t i_tet, sn_vec3 grad[4]);

/* The tets around each vertex: those of v are tet[ptr[v]] .. tet[ptr[v + 1] - 1], ascending. */
typedef struct sn_vertex_tets {
    int32_t *ptr, *tet; /* n_vert + 1 and 4 n_tet; owned */
} sn_vertex_tets;
void sn_vertex_tets_free(sn_vertex_tets *v);
SN_MUST_USE sn_status sn_vertex_tets_build(sn_vertex_tets *out, const sn_tet_mesh *m, sn_error *err);

/* L with L_ij = sum over tets of volume * grad b_i . grad b_j (positive semidefinite, rows add up to 0 up to
 * rounding). m: positive tets. The entries are summed in tet order: the same for any number of threads.
 * Errors: SN_ENOMEM, SN_ECANCEL. */
SN_MUST_USE sn_status sn_laplacian_build(sn_csr *out, const sn_tet_mesh *m, const sn_run *run, sn_error *err);

#endif
