/* extraction_mirror.h - both sides of a half model, joined without a seam.
 *
 * Names say what becomes of a tissue (base/side_name.h). One without a side is one tissue of the whole, with
 * its image. One of a side keeps its tets, and the image goes to the tissue of the other side: to that of the
 * half, where it has both, else to a new one. */
#ifndef SN_EXTRACT_EXTRACTION_MIRROR_H
#define SN_EXTRACT_EXTRACTION_MIRROR_H

#include "extract/extraction.h"

/* The half x and its image. Vertices within SN_PLANE_REL of the diagonal of x's box of the plane are moved
 * onto it and shared; all others are reflected, and tets turned so that they stay positive. Tissues are those
 * of x in order, then the new ones in the order of those they are images of; input_volume and n_moved are
 * doubled. A tissue that is new gets the mirrored muscle; one that both sides share keeps the half's, whose
 * curves run in the half. Fibers and tendon of the image are the reflected ones of the half: the functions
 * that take the tets which x was cut from take them for the whole, too.
 *
 *   x        on either side of the plane; its muscles known for all tissues but the first, or for none
 *   normal   of any length; its sign does not matter
 *   out      init-ed; not x; empty on error
 * Errors: SN_EINVAL (plane; x mirrored already; a vertex beyond the plane: says how far; no face in the
 * plane: says how far x is), SN_EMESH (a tet that is flat once its vertices are moved), SN_ENOMEM, SN_ELIMIT,
 * SN_ECANCEL. */
SN_MUST_USE sn_status sn_extraction_mirror(const sn_extraction *x, sn_vec3 point, sn_vec3 normal,
                                           const sn_run *run, sn_extraction *out, sn_error *err);

/* The half that a mirrored extraction was made of. Borrows: valid while x is, not to be freed. */
sn_extraction sn_extraction_half_view(const sn_extraction *x);
/* The tissue of the half whose tets (is_image: whose images) belong to that tissue; -1: none. */
int32_t sn_extraction_half_tissue(const sn_extraction *x, int32_t tissue, bool is_image);

#endif
