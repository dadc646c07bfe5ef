/* bvh.h - a tree of boxes over the faces of a surface: rays, closest points, generalized winding numbers,
 * overlaps.
 *
 * Built once (O(n log n)), immutable, may be read by many threads. The surface is copied: it may be freed
 * afterwards. */
#ifndef SN_MESH_BVH_H
#define SN_MESH_BVH_H

#include "mesh/tri_mesh.h"

typedef struct sn_bvh sn_bvh; /* opaque */

/* m: valid (sn_tri_mesh_validate). Errors: SN_ENOMEM, SN_EINVAL (no faces); *out is then NULL. */
SN_MUST_USE sn_status sn_bvh_create(sn_bvh **out, const sn_tri_mesh *m, sn_error *err);
void sn_bvh_destroy(sn_bvh *b);                  /* NULL is fine */
const sn_tri_mesh *sn_bvh_mesh(const sn_bvh *b); /* the copy; lives as long as b */

typedef struct sn_ray_hit {
    double t; /* along the direction as given (not normalised), >= 0 */
    int32_t face;
    bool entering; /* the ray goes against the face's normal              */
    sn_vec3 point;
} sn_ray_hit;
/* All hits with t in [0, t_max] (t_max may be INFINITY), in the order in which the ray meets the faces. A ray
 * through a shared edge or corner is treated as one that passes beside it by a fixed, vanishing amount: it
 * counts once per crossing, none or two where it only touches, so that entering and leaving alternate on
 * closed outward surfaces, and over the whole line they are equally many. Faces that the ray lies in are not
 * hit. Of equal faces the lower comes first. *hits by sn_alloc, the caller's. Errors: SN_ENOMEM, SN_EINVAL
 * (origin or direction not finite, direction zero); *hits is then NULL. */
SN_MUST_USE sn_status sn_bvh_ray_all(const sn_bvh *b, sn_vec3 origin, sn_vec3 dir, double t_max,
                                     sn_ray_hit **hits, size_t *n_hits, sn_error *err);
/* The first of them; false when there is none, also for a ray that sn_bvh_ray_all refuses. hit is then
 * untouched. */
bool sn_bvh_ray_first(const sn_bvh *b, sn_vec3 origin, sn_vec3 dir, double t_max, sn_ray_hit *hit);

typedef struct sn_closest {
    double dist;  /* >= 0                                    */
    int32_t face; /* the lowest one of several equally close */
    sn_vec3 point;
} sn_closest;
/* p: finite. O(log n) usually. Degenerate faces are the segments or points they are. */
sn_closest sn_bvh_closest(const sn_bvh *b, sn_vec3 p);
/* As above, but only faces whose label is `label`; face = -1 and dist = INFINITY when there is none or no
 * labels. */
sn_closest sn_bvh_closest_label(const sn_bvh *b, sn_vec3 p, int32_t label);

/* Generalized winding number: solid angle over 4 pi; 1 inside and 0 outside a closed outward surface, in
 * between near holes. Exact up to rounding near the surface, far clusters by their first three moments
 * (Barill et al. 2018), error below 1e-3 on a unit scale. A face in whose plane p lies adds nothing: on a
 * smooth surface the result is about 0.5. */
double sn_bvh_winding(const sn_bvh *b, sn_vec3 p);
bool sn_bvh_contains(const sn_bvh *b, sn_vec3 p); /* winding > 0.5 */

/* Calls fn for every face whose own box meets the given closed box, in tree order (fixed for one surface);
 * stops when fn returns false. */
void sn_bvh_overlap(const sn_bvh *b, sn_box3 box, bool (*fn)(void *user, int32_t face), void *user);

#endif
