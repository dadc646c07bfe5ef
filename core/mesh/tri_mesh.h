/* tri_mesh.h - triangle surfaces as plain arrays. Lengths in the scene's unit. C indices are 0-based.
 *
 * Faces turn counter-clockwise seen from outside, so a closed surface has a positive volume. */
#ifndef SN_MESH_TRI_MESH_H
#define SN_MESH_TRI_MESH_H

#include "base/status.h"
#include "base/vec3.h"

#include <stdint.h>

SN_BEGIN_DECLS

typedef struct sn_tri_mesh { /* open: kernels read the arrays directly */
    double *pos;             /* n_vert x 3, row-major, owned                                       */
    int32_t *face;           /* n_face x 3, each in [0, n_vert), owned                             */
    int32_t *label;          /* n_face, what the face belongs to; NULL when unlabelled; owned      */
    int32_t n_vert, n_face;
} sn_tri_mesh;

void sn_tri_mesh_init(sn_tri_mesh *m); /* makes *m empty; must come first                  */
void sn_tri_mesh_free(sn_tri_mesh *m); /* releases and re-inits; fine on empty, fine twice */
/* Room for n_vert and n_face (values not set, no labels). m must be init-ed; on error it is left empty.
 * Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_tri_mesh_reserve(sn_tri_mesh *m, int32_t n_vert, int32_t n_face, sn_error *err);
/* Deep copy into an init-ed mesh. Errors: SN_ENOMEM; out is then empty. */
SN_MUST_USE sn_status sn_tri_mesh_copy(sn_tri_mesh *out, const sn_tri_mesh *m, sn_error *err);
/* Indices in range, coordinates finite, at least one face. The message names the first breach. O(n).
 * SN_EINVAL. */
SN_MUST_USE sn_status sn_tri_mesh_validate(const sn_tri_mesh *m, sn_error *err);

static inline sn_vec3 sn_tri_mesh_point(const sn_tri_mesh *m, int32_t i_vert)
{
    return sn_v3_load(m->pos + 3 * (size_t)i_vert);
}
sn_box3 sn_tri_mesh_bounds(const sn_tri_mesh *m); /* of all vertices; empty for no vertices */
double sn_tri_mesh_area(const sn_tri_mesh *m);
double sn_tri_mesh_volume(const sn_tri_mesh *m); /* signed; meaningful for closed surfaces */
sn_vec3 sn_tri_mesh_face_normal(const sn_tri_mesh *m, int32_t i_face); /* length = twice the area */

/* In place: p -> R(p * scale) + translate, R about the origin by angle_deg around axis (axis 0: no rotation).
 * A negative scale would turn the surface inside out: SN_EINVAL unless scale is finite and > 0. */
typedef struct sn_transform {
    double scale; /* > 0                 */
    sn_vec3 axis; /* any length, 0: none */
    double angle_deg;
    sn_vec3 translate;
} sn_transform;
SN_MUST_USE sn_status sn_tri_mesh_transform(sn_tri_mesh *m, const sn_transform *t, sn_error *err);
/* In place: reflects in the plane through `point` and turns every face so that outside stays outside. */
SN_MUST_USE sn_status sn_tri_mesh_mirror(sn_tri_mesh *m, sn_vec3 point, sn_vec3 normal, sn_error *err);

/* Joins vertices with bit-equal coordinates (-0 equals 0) into the first of them, in place; order is kept.
 * Unused vertices stay. n_joined (NULL to skip) receives how many went. Errors: SN_ENOMEM (m unchanged). */
SN_MUST_USE sn_status sn_tri_mesh_weld(sn_tri_mesh *m, int32_t *n_joined, sn_error *err);

SN_END_DECLS

#endif
