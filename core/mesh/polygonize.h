/* polygonize.h - the zero set of a function on a lattice as a closed manifold surface: marching tetrahedra.
 *
 * The lattice is body-centred cubic (its tets are congruent and well shaped). A lattice value <= 0 is inside; exact zeros
 * are pushed inside by symbolic perturbation, so that the surface is always a closed manifold without self-intersections. */
#ifndef SN_MESH_POLYGONIZE_H
#define SN_MESH_POLYGONIZE_H

#include "base/run.h"
#include "mesh/tri_mesh.h"

typedef struct sn_polygonize {
    double (*value)(void *user, sn_vec3 p); /* negative inside; called from many threads */
    void *user;
    sn_box3 box;    /* grown by the call so that the surface closes inside the lattice */
    double cell;    /* edge of the lattice's cubes, > 0                                */
    bool is_distance; /* |value| never exceeds the distance to the surface: lets far blocks be skipped */
} sn_polygonize;

/* Vertices lie on lattice edges at the function's zero found by bisection/secant to 1e-6 cells, clamped to keep 1e-2 of the edge from its
 * ends. Vertex and face order depend on the function only. No faces: SN_OK with an empty mesh. Errors: SN_EINVAL, SN_ELIMIT
 * (more than 2e8 lattice points), SN_ENOMEM, SN_ECANCEL. */
SN_MUST_USE sn_status sn_polygonize_run(const sn_polygonize *p, const sn_run *run, sn_tri_mesh *out, sn_error *err);

#endif
