/* affine.h - affine maps p -> M p + t of points and surfaces. */
#ifndef SN_MESH_AFFINE_H
#define SN_MESH_AFFINE_H

#include "mesh/tri_mesh.h"

typedef struct sn_affine {
    sn_vec3 col[3]; /* of M: where the unit vectors go */
    sn_vec3 t;
} sn_affine;

sn_affine sn_affine_identity(void);
sn_affine sn_affine_translation(sn_vec3 v);
/* angle_deg around axis (any length > 0) through about. */
sn_affine sn_affine_rotation(sn_vec3 axis, double angle_deg, sn_vec3 about);
sn_affine sn_affine_scale(double k, sn_vec3 about);
sn_affine sn_affine_mirror(sn_vec3 point, sn_vec3 normal);    /* normal: any length > 0 */
sn_affine sn_affine_after(sn_affine second, sn_affine first); /* p -> second(first(p)) */
sn_vec3 sn_affine_point(const sn_affine *a, sn_vec3 p);
sn_vec3 sn_affine_vector(const sn_affine *a, sn_vec3 v); /* M v */
double sn_affine_det(const sn_affine *a);                /* < 0: it reflects */
/* In place; a map that reflects turns the faces, so that outside stays outside. */
void sn_affine_mesh(const sn_affine *a, sn_tri_mesh *m);

#endif
