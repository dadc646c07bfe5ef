/* shape_private.h - the nodes of a shape's tree. */
#ifndef SN_MESH_SHAPE_PRIVATE_H
#define SN_MESH_SHAPE_PRIVATE_H

#include "mesh/shape.h"

#include <stdatomic.h>

typedef enum sn_shape_kind {
    SN_SHAPE_SPHERE,
    SN_SHAPE_ELLIPSOID,
    SN_SHAPE_CAPSULE,
    SN_SHAPE_BOX,
    SN_SHAPE_TORUS,
    SN_SHAPE_PLATE,
    SN_SHAPE_UNION,
    SN_SHAPE_SMOOTH_UNION,
    SN_SHAPE_INTERSECT,
    SN_SHAPE_SUBTRACT,
    SN_SHAPE_SMOOTH_SUBTRACT,
    SN_SHAPE_TRANSFORM,
    SN_SHAPE_MIRROR
} sn_shape_kind;

struct sn_shape {
    atomic_int refs;
    sn_shape_kind kind;
    int depth;       /* 1 for a leaf */
    sn_box3 bounds;  /* holds the surface */
    sn_vec3 center;  /* capsule: the end a; plate: corner a; transform: where the origin goes; mirror: a point
                        of the plane */
    sn_vec3 size;    /* radii, half sizes, scales; capsule: unit vector to b; torus: unit axis; mirror: unit
                        normal; plate: corner b less corner a */
    sn_vec3 size_c;  /* plate: corner c less corner a */
    double radius;   /* sphere; capsule: at a; box: of its edges; torus: of the ring; plate: half thickness */
    double radius_b; /* capsule: at b; torus: of the tube */
    double length;   /* capsule: of the axis; smooth ones: k; transform: the smallest scale */
    double turn[9];  /* transform: rotation, row-major */
    sn_shape **part; /* n_part operands, retained; owned array */
    int n_part;
};

#endif
