/* bvh_private.h - the tree itself, for the files that build and search it. */
#ifndef SN_MESH_BVH_PRIVATE_H
#define SN_MESH_BVH_PRIVATE_H

#include "mesh/bvh.h"

enum { SN_BVH_STACK = 96 }; /* the builder keeps every path shorter */

typedef struct sn_bvh_node { /* one cache line; children come after their parent */
    sn_box3 box;
    int32_t first; /* leaf: its first slot; else its first child, the second one follows */
    int32_t count; /* slots of a leaf; 0: not a leaf */
    int32_t label_min, label_max;
} sn_bvh_node;

typedef struct sn_bvh_tri {
    sn_vec3 v[3];
} sn_bvh_tri;

/* Moments of the oriented area of a node about its centre c, as polynomials in a direction x; n dA is the
 * area element and d = y - c the place of its point y. Monomials in the order xx xy xz yy yz zz and xxx xxy
 * xxz xyy xyz xzz yyy yyz yzz zzz. */
typedef struct sn_bvh_moment {
    sn_vec3 centre;
    double radius; /* of a ball about the centre with all faces of the node */
    double area;
    double linear[3]; /* integral of (n.x)         */
    double quad[6];   /* integral of (n.x)(d.x)    */
    double cubic[10]; /* integral of (n.x)(d.x)^2  */
} sn_bvh_moment;

struct sn_bvh {
    sn_tri_mesh mesh;
    sn_bvh_node *node;     /* n_node; 0 is the root */
    sn_bvh_moment *moment; /* n_node                */
    int32_t *face;         /* the face in each slot */
    sn_bvh_tri *tri;       /* its corners           */
    int32_t n_node;
};

void sn_bvh_set_moments(sn_bvh *b); /* bvh_winding.c; fills moment from the rest */

#endif
