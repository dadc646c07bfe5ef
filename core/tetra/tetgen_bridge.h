/* tetgen_bridge.h - the only file of the library that sees TetGen. Called inside a child process
 * (base/child.h): TetGen may crash or hang. */
#ifndef SN_TETRA_TETGEN_BRIDGE_H
#define SN_TETRA_TETGEN_BRIDGE_H

#include "mesh/sizing.h"
#include "mesh/tet_mesh.h"

SN_BEGIN_DECLS

typedef struct sn_tetgen_options {
    double radius_edge;      /* bound on circumradius over shortest edge, > 1; TetGen's -q            */
    double min_dihedral_deg; /* wished, not promised; -q's second figure                            */
    double max_volume;       /* of a tet, in the cube of the input's unit; 0: no bound; -a            */
    double size_volume;      /* with a sizing: bound on a tet's volume over the cube of the length there  */
} sn_tetgen_options;

typedef struct sn_tetgen_result { /* arrays by malloc, free with sn_tetgen_result_free */
    double *pos;                  /* n_vert x 3                                                            */
    int32_t *tet;                 /* n_tet x 4, positive                                                   */
    int32_t *face;                /* n_face x 3: every piece of an input face                              */
    int32_t *face_label;          /* n_face: the label of the input face it is a piece of                  */
    int32_t n_vert, n_tet, n_face;
} sn_tetgen_result;
void sn_tetgen_result_free(sn_tetgen_result *r);

/* Constrained Delaunay tets inside the labelled closed surface, refined.
 *   hole    n_hole x 3: a point in every cavity
 *   sizing  lengths from place to place, NULL: none; not by two threads at a time
 * Errors: SN_EMESH with TetGen's reason, SN_ENOMEM. *out is then empty. */
SN_MUST_USE sn_status sn_tetgen(const sn_tri_mesh *surface, const double *hole, int32_t n_hole,
                                const sn_tetgen_options *opt, const sn_sizing *sizing, sn_tetgen_result *out,
                                sn_error *err);

SN_END_DECLS

#endif
