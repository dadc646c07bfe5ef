/* polygonize.h - the zero set of a function on a lattice as a closed manifold surface: marching tetrahedra.
 *
 * The lattice is body-centred cubic (its tets are congruent and well shaped): points at box.min + cell * (i,
 * j, k) for whole i, j, k, and the centres of the cubes between them. A value <= 0 is inside and a zero at a
 * lattice point is inside too (NaN is outside), so every tet is cut in general position and the surface is
 * always a closed manifold without self-intersections. */
#ifndef SN_MESH_POLYGONIZE_H
#define SN_MESH_POLYGONIZE_H

#include "base/run.h"
#include "mesh/tri_mesh.h"

typedef struct sn_polygonize {
    double (*value)(void *user,
                    sn_vec3 p); /* negative inside; called from many threads; same p, same value */
    void *user;
    sn_box3 box; /* min <= max on every axis, may be flat. Holds the surface; an inside that reaches out of it
                  * is cut off at a quarter of a cell beyond the box, so that the surface closes there too */
    double cell; /* edge of the lattice's cubes, > 0                                               */
    bool is_distance; /* |value| never exceeds the distance to the surface: lets far blocks be skipped */
} sn_polygonize;

/* Vertices lie on lattice edges at the function's zero, found to 1e-6 edges, but never nearer than 1e-2 of
 * the edge to its ends: a surface that runs exactly through lattice points is moved out by 1e-2 of an edge
 * there. Vertex and face order depend on p only. Features that pass between lattice points are not seen.
 * Memory follows the surface. out: init-ed; on error it is left empty. No faces: SN_OK with an empty mesh.
 * Errors: SN_EINVAL (cell, box, a cell below 1e-9 of the coordinates), SN_ELIMIT (more than 2e8 lattice
 * points: says which cell would do), SN_ENOMEM, SN_ECANCEL. */
SN_MUST_USE sn_status sn_polygonize_run(const sn_polygonize *p, const sn_run *run, sn_tri_mesh *out,
                                        sn_error *err);

/* A cell just large enough for the limit of 2e8 lattice points; 0 when box is a point. box: finite, not
 * empty. */
double sn_polygonize_smallest_cell(sn_box3 box);

#endif
