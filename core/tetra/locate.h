/* locate.h - which tet holds a point. A tree of boxes over the tets; built once, read by many threads. */
#ifndef SN_TETRA_LOCATE_H
#define SN_TETRA_LOCATE_H

#include "mesh/tet_mesh.h"

#include <stdbool.h>

typedef struct sn_locator sn_locator; /* opaque */

/* m: valid; borrowed, must outlive the locator. Errors: SN_ENOMEM. O(n log n). */
SN_MUST_USE sn_status sn_locator_create(sn_locator **out, const sn_tet_mesh *m, sn_error *err);
void sn_locator_destroy(sn_locator *l); /* NULL is fine */

/* The tet that holds p, or -1. A point on a shared face (up to rounding) belongs to the lowest tet. bary
 * (NULL to skip) receives its four barycentric coordinates, which add up to 1; none below -1e-10. */
int32_t sn_locator_find(const sn_locator *l, sn_vec3 p, double bary[4]);

/* Barycentric coordinates of any point with respect to a tet. */
void sn_tet_barycentric(const sn_tet_mesh *m, int32_t i_tet, sn_vec3 p, double bary[4]);

#endif
