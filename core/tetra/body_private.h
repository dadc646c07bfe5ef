/* body_private.h - the steps of sn_body_build. */
#ifndef SN_TETRA_BODY_PRIVATE_H
#define SN_TETRA_BODY_PRIVATE_H

#include "tetra/body.h"

#define SN_BODY_SIZE_VOLUME                                                                                  \
    0.35 /* of the cube of the edge length: no tet is larger, if nothing else is said */

/* Checks and prepares one surface: corners rounded to multiples of grid, welded, outward. out: init-ed.
 * crossing receives the first pair of faces that cross, -1 when none do. */
SN_MUST_USE sn_status sn_body_prepare(const sn_tri_mesh *in, const char *kind, const char *name, double grid,
                                      const sn_run *run, sn_tri_mesh *out, int32_t crossing[2],
                                      sn_error *err);
/* The labelled, remeshed boundary of the soft tissue, free of crossings. */
SN_MUST_USE sn_status sn_body_surface(const sn_tri_mesh *skin, const sn_tri_mesh *const *bone, int32_t n_bone,
                                      bool is_exact_possible, const sn_body_options *opt, const sn_run *run,
                                      sn_tri_mesh *out, sn_body_report *report, sn_notes *notes,
                                      sn_error *err);
/* Keeps the half that opt->cut_normal points to; m: labelled. Errors: SN_EINVAL (the plane misses it),
 * SN_EMESH, SN_ENOMEM. */
SN_MUST_USE sn_status sn_body_cut_surface(sn_tri_mesh *m, const sn_body_options *opt, int32_t n_bone,
                                          const sn_run *run, sn_error *err);
/* TetGen in a child process, then labels and adjacency. */
SN_MUST_USE sn_status sn_body_tets(const sn_tri_mesh *surface, const sn_body_options *opt, const sn_run *run,
                                   sn_body *out, sn_body_report *report, sn_error *err);
/* Renumbers vertices and tets so that neighbours in space are neighbours in memory: assembly, solving and
 * cutting walk through them in this order. face: n_face x 3 vertices of m, renumbered along. Errors:
 * SN_ENOMEM. */
SN_MUST_USE sn_status sn_body_sort(sn_tet_mesh *m, int32_t *face, int32_t n_face, sn_error *err);
#endif
