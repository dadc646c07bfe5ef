/* bvh.h - a tree of boxes over the faces of a surface: rays, closest points, generalized winding numbers, overlaps.
 *
 * Built once (O(n log n)), immutable, may be read by many threads. The surface is copied: it may be freed afterwards. */
#ifndef SN_MESH_BVH_H
#define SN_MESH_BVH_H

#include "mesh/tri_mesh.h"

typedef struct sn_bvh sn_bvh; /* opaque */

/* m: valid (sn_tri_mesh_validate). Errors: SN_ENOMEM, SN_EINVAL (no faces); *out is then NULL. */
SN_MUST_USE sn_status sn_bvh_create(sn_bvh **out, const sn_tri_mesh *m, sn_error *err);
void sn_bvh_destroy(sn_bvh *b); /* NULL is fine */
const sn_tri_mesh *sn_bvh_mesh(const sn_bvh *b); /* the copy; lives as long as b */

typedef struct sn_ray_hit {
    double t;        /* along the direction as given (not normalised), >= 0 */
    int32_t face;
    bool entering;   /* the ray goes against the face's normal              */
    sn_vec3 point;
} sn_ray_hit;
/* All hits with t in [0, t_max], sorted by t, then face. A ray through a shared edge or vertex of a closed surface counts once per
 * crossing (watertight test of Woop et al. 2013). *hits by sn_alloc, the caller's. Errors: SN_ENOMEM, SN_EINVAL (direction zero or not finite). */
SN_MUST_USE sn_status sn_bvh_ray_all(const sn_bvh *b, sn_vec3 origin, sn_vec3 dir, double t_max, sn_ray_hit **hits,
                                     size_t *n_hits, sn_error *err);
bool sn_bvh_ray_first(const sn_bvh *b, sn_vec3 origin, sn_vec3 dir, double t_max, sn_ray_hit *hit);

typedef struct sn_closest {
    double dist;     /* >= 0                                    */
    int32_t face;    /* the lowest one of several equally close */
    sn_vec3 point;
} sn_closest;
sn_closest sn_bvh_closest(const sn_bvh *b, sn_vec3 p); /* O(log n) usually */
/* As above, but only faces whose label is `label` (needs a labelled surface); face = -1 when there is none. */
sn_closest sn_bvh_closest_label(const sn_bvh *b, sn_vec3 p, int32_t label);

/* Generalized winding number: solid angle over 4 pi; 1 inside and 0 outside a closed outward surface, in between near
 * holes. Exact up to rounding near the surface, far clusters by their dipole and higher terms (Barill et al. 2018),
 * error below 1e-3 on a unit scale. */
double sn_bvh_winding(const sn_bvh *b, sn_vec3 p);
bool sn_bvh_contains(const sn_bvh *b, sn_vec3 p); /* winding > 0.5 */

/* Calls fn for every face whose box meets the given box, in index-free tree order (fixed for one tree); stops when
 * fn returns false. */
void sn_bvh_overlap(const sn_bvh *b, sn_box3 box, bool (*fn)(void *user, int32_t face), void *user);

#endif
