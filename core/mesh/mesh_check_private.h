/* mesh_check_private.h - the search behind sn_mesh_self_intersections and sn_mesh_check_run. For core/mesh
 * only.
 */
#ifndef SN_MESH_MESH_CHECK_PRIVATE_H
#define SN_MESH_MESH_CHECK_PRIVATE_H

#include "base/run.h"
#include "mesh/tri_mesh.h"

#include <stdbool.h>

typedef struct sn_self_crossings {
    int32_t *pairs; /* 2 x n, sorted, by sn_alloc; NULL when not stored or n = 0 */
    size_t n;
    int32_t first[2]; /* the lowest pair, or -1, -1 */
} sn_self_crossings;

/* store: false only counts, in little memory. Errors: SN_ENOMEM, SN_ECANCEL, SN_ELIMIT; *out is then empty.
 */
SN_MUST_USE sn_status sn_self_crossings_find(sn_self_crossings *out, const sn_tri_mesh *m, bool store,
                                             const sn_run *run, sn_error *err);

#endif
