/* laplacian.h - the linear finite-element (cotangent) Laplacian of a tet mesh, in normalized lengths.
 *
 * Lengths are divided by a size, the box diagonal of the mesh where nothing else is said, so that the matrix
 * - and with it every field - is the same in metres and in millimetres. */
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

/* Where each entry of a tet's 4 x 4 matrix goes: value (a, b) of tet t to place slot[16 t + 4 a + b] of row
 * tet[4 t + a]. Made once per mesh, so that matrices of the same pattern are assembled without searching. */
typedef struct sn_assembly {
    uint16_t *slot; /* n_tet x 16; owned                       */
    double size;    /* length that all lengths are divided by */
} sn_assembly;
void sn_assembly_free(sn_assembly *a);

/* L with L_ij = sum over tets of volume * grad b_i . grad b_j (positive semidefinite, rows add up to 0 up to
 * rounding). m: positive tets. The entries are summed in tet order. out, assembly: zero-initialised or
 * filled. size: see above, 0: the box diagonal. Errors: SN_ENOMEM, SN_ECANCEL, SN_EINVAL (a vertex with more
 * than 4096 neighbours). */
SN_MUST_USE sn_status sn_laplacian_build(sn_csr *out, sn_assembly *assembly, const sn_tet_mesh *m,
                                         double size, const sn_run *run, sn_error *err);
/* The values of the anisotropic form G' M A G [A Eq. 13]: grad b_i . A grad b_j with A the mean of the
 * tensors at a tet's corners, into a matrix that has the pattern of m's Laplacian. tensor   n_vert x 6: xx xy
 * xz yy yz zz of a symmetric positive definite tensor at each vertex The identity everywhere gives the
 * Laplacian's values up to rounding. */
void sn_laplacian_set_anisotropic(sn_csr *out, const sn_assembly *assembly, const sn_tet_mesh *m,
                                  const double *tensor);

/* The same of a part of the domain: each tet counts by its weight >= 0, the share of it that lies in the
 * part. Linear elements on the cut domain: its own boundary is natural. */
void sn_laplacian_set_weighted(sn_csr *out, const sn_assembly *assembly, const sn_tet_mesh *m,
                               const double *weight);

#endif
