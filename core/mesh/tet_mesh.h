/* tet_mesh.h - tetrahedra as plain arrays, with what is known of each tet and of the boundary.
 * Lengths in the scene's unit. C indices are 0-based.
 * Tet (a,b,c,d) is positive when det[b-a, c-a, d-a] > 0; every function here keeps tets positive.
 * Face k of a tet is the one opposite corner k. */
#ifndef SN_MESH_TET_MESH_H
#define SN_MESH_TET_MESH_H

#include "base/status.h"
#include "base/vec3.h"
#include "mesh/tri_mesh.h"

#include <stdint.h>

SN_BEGIN_DECLS

typedef struct sn_tet_mesh { /* open: kernels read the arrays directly */
    double *pos;             /* n_vert x 3, row-major, owned                          */
    int32_t *tet;            /* n_tet x 4, each in [0, n_vert), owned                 */
    int32_t *part;           /* n_tet, part id >= 0; NULL when unlabelled; owned      */
    int32_t n_vert, n_tet;
} sn_tet_mesh;

void sn_tet_mesh_init(sn_tet_mesh *m);
void sn_tet_mesh_free(sn_tet_mesh *m);
/* Room for n_vert and n_tet (values not set; parts only when has_parts). On error m is empty. Errors:
 * SN_ENOMEM. */
SN_MUST_USE sn_status sn_tet_mesh_reserve(sn_tet_mesh *m, int32_t n_vert, int32_t n_tet, bool has_parts,
                                          sn_error *err);
SN_MUST_USE sn_status sn_tet_mesh_copy(sn_tet_mesh *out, const sn_tet_mesh *m, sn_error *err);
/* Indices in range and distinct per tet, coordinates finite, every tet positive, at least one tet. The
 * message names the first breach. O(n). Errors: SN_EINVAL. */
SN_MUST_USE sn_status sn_tet_mesh_validate(const sn_tet_mesh *m, sn_error *err);

static inline sn_vec3 sn_tet_mesh_point(const sn_tet_mesh *m, int32_t i_vert)
{
    return sn_v3_load(m->pos + 3 * (size_t)i_vert);
}
sn_vec3 sn_tet_mesh_centre(const sn_tet_mesh *m, int32_t i_tet); /* mean of the corners */
sn_box3 sn_tet_mesh_bounds(const sn_tet_mesh *m);
double sn_tet_mesh_tet_volume(const sn_tet_mesh *m, int32_t i_tet);
double sn_tet_mesh_volume(const sn_tet_mesh *m); /* sum in index order */

/* adj: n_tet x 4, the tet across face k, or -1 on the boundary. By sn_alloc, owned by the caller.
 * Errors: SN_ENOMEM; SN_EINVAL when three tets share a face (names it). O(n_tet). */
SN_MUST_USE sn_status sn_tet_mesh_adjacency(const sn_tet_mesh *m, int32_t **adj, sn_error *err);

/* Corners of face k in the order that turns counter-clockwise seen from outside the tet. */
extern const int sn_tet_face[4][3];
/* The six edges of a tet as corner pairs, in the order 01 02 03 12 13 23. */
extern const int sn_tet_edge[6][2];

/* The boundary triangles of the tets with part == part_id (all tets when part_id < 0), outside out; only the
 * vertices used, in index order. v_map (NULL to skip): n_vert of the result, the tet mesh's vertex; by
 * sn_alloc, the caller's. */
SN_MUST_USE sn_status sn_tet_mesh_surface(const sn_tet_mesh *m, int32_t part_id, sn_tri_mesh *out,
                                          int32_t **v_map, sn_error *err);
/* The same with the adjacency at hand (entries < 0 are the boundary): for many parts of one mesh. */
SN_MUST_USE sn_status sn_tet_mesh_surface_adj(const sn_tet_mesh *m, const int32_t *adj, int32_t part_id,
                                              sn_tri_mesh *out, int32_t **v_map, sn_error *err);

SN_END_DECLS

#endif
