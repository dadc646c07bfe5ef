/* mesh_check.h - what is right and wrong with a surface. */
#ifndef SN_MESH_MESH_CHECK_H
#define SN_MESH_MESH_CHECK_H

#include "base/run.h"
#include "mesh/tri_mesh.h"

#include <stdbool.h>

/* Faces that name a vertex twice are left out where edges and fans are looked at, as if collapsed; a
 * component still hangs together through them. */
typedef struct sn_mesh_check {
    bool closed;        /* has faces; every edge has as many on its one side as on its other: no boundary */
    bool manifold;      /* no edge with more than two faces, no vertex whose faces form two fans */
    bool oriented;      /* where just two faces meet, they run along the edge in opposite directions */
    int32_t components; /* of faces joined by edges */
    int32_t boundary_edges;       /* with one face */
    int32_t nonmanifold_edges;    /* with three or more */
    int32_t nonmanifold_vertices; /* faces around it are not one fan or ring, as at such an edge */
    int32_t degenerate_faces;     /* two equal corners or exactly no area */
    int32_t duplicate_vertices;   /* bit-equal to an earlier vertex (-0 equals 0) */
    int32_t duplicate_faces;      /* the same three vertices as an earlier face, in any order */
    int32_t unused_vertices;
    int64_t self_intersections; /* pairs of faces that cross or touch outside what they share; exact */
    int32_t first_pair[2];      /* the lowest such pair of faces, or -1, -1 */
} sn_mesh_check;

/* m: valid indices and finite coordinates; may have no faces. O(n log n + pairs). On error *out is empty.
 * Errors: SN_ENOMEM, SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_mesh_check_run(sn_mesh_check *out, const sn_tri_mesh *m, const sn_run *run,
                                        sn_error *err);

/* Only the fields that follow from the indices: closed to nonmanifold_vertices, and unused_vertices; the
 * others are 0. O(n log n). Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_mesh_check_topology(sn_mesh_check *out, const sn_tri_mesh *m, sn_error *err);

/* Faces connected through edges: comp[f] in [0, *n_comp), numbered by lowest face. comp: n_face, caller's.
 * Errors: SN_ENOMEM, SN_ELIMIT (more than 715,827,882 faces). */
SN_MUST_USE sn_status sn_mesh_components(const sn_tri_mesh *m, int32_t *comp, int32_t *n_comp, sn_error *err);

/* All crossing pairs (f < g) by sn_triangles_cross, sorted; pairs: 2 x *n, by sn_alloc, the caller's; NULL
 * when there are none. Errors: SN_ENOMEM, SN_ECANCEL, SN_ELIMIT; *pairs is then NULL and *n 0. */
SN_MUST_USE sn_status sn_mesh_self_intersections(const sn_tri_mesh *m, const sn_run *run, int32_t **pairs,
                                                 size_t *n, sn_error *err);

#endif
