/* tensor.h - the diffusion tensor of a muscle from the frames along its curves [A 3.7].
 *
 * The corners of the tets that a curve crosses take the frame of the nearest collocation point; harmonic
 * fields, one per entry of e1 and e2 (the paper spreads e3's, too, which follow), spread the frames over the
 * mesh. They are 0 on the skin, as the muscle's own field is (the paper leaves it free): so they share the
 * analysis of the tissue matrix, and each place of the curve counts for as much as it does in that field.
 * Skin vertices take the sum of their neighbours. Orthonormalized, a frame Q and the eigenvalues give the
 * tensor Q diag(l1, l2, l3) Q' (the paper prints Q' Lambda Q). */
#ifndef SN_FIELD_TENSOR_H
#define SN_FIELD_TENSOR_H

#include "field/harmonic.h"
#include "muscle/collocation.h"
#include "muscle/path.h"

/* frame: n_vert, orthonormal and right-handed at every vertex. row: at least one. Where the spread frames
 * cancel out or come to less than 1e-9, the frame of the first collocation point stands in. Errors:
 * SN_ENOMEM, SN_ESOLVE, SN_ECANCEL.
 */
SN_MUST_USE sn_status sn_frame_field(const sn_harmonic *h, const sn_tet_mesh *m, const sn_collocation *row,
                                     const sn_paths *paths, const sn_run *run, sn_triad *frame,
                                     sn_error *err);

/* tensor: n_vert x 6 as in sn_laplacian_set_anisotropic. eigenvalue: each > 0, so that the tensor is positive
 * definite whatever the frame. */
void sn_tensor_field(const sn_triad *frame, int32_t n_vert, const double eigenvalue[3], double *tensor);

#endif
