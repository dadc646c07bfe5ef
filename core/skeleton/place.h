/* place.h - where a template goes: the affine maps of cylinder and curve bones [A 3.1.1, 3.1.2], and picks.
 */
#ifndef SN_SKELETON_PLACE_H
#define SN_SKELETON_PLACE_H

#include "base/run.h"
#include "mesh/affine.h"
#include "mesh/bvh.h"
#include "skeleton/bone_template.h"

/* The midpoint of the first two hits of a ray with the skin: the middle of the limb under it [A 3.1.1]. A
 * place where the ray only touches the skin is passed over. skin: closed. out is untouched on error. Errors:
 * SN_EINVAL: the ray misses the skin (says by how much, and where the skin is nearest), or leaves it only (it
 * starts inside), or enters and does not leave it (a skin that is open or crosses itself), or is not finite
 * or has no direction; SN_ENOMEM. */
SN_MUST_USE sn_status sn_pick_midpoint(const sn_bvh *skin, sn_vec3 origin, sn_vec3 dir, sn_vec3 *out,
                                       sn_error *err);

typedef struct sn_cylinder_options { /* {0}: all defaults */
    double thickness; /* factor across the axis, of the template's own size; 0: as along it   */
    double twist_deg; /* about from -> to, after all else; counter-clockwise seen from `to`   */
    sn_vec3 front;    /* where the template's +z points, as far as the axis lets it; 0: +z    */
    bool is_mirrored; /* the bone of the right side: x of the template is mirrored first. The mirror image
                         of a pose has mirrored ends and front, and -twist_deg                */
} sn_cylinder_options;
/* The map that takes the template's handles to from and to: scaled along the axis by their distance, across
 * it by the thickness, rotated, no shear. Where front runs along the axis (within 5 degrees), or the
 * template's +z along its own, the turn is the smallest one that takes the template's axis there. Errors:
 * SN_EINVAL (not a cylinder, ends or handles equal or not finite, thickness not >= 0, twist or front not
 * finite). */
SN_MUST_USE sn_status sn_place_cylinder(const sn_bone_template *t, sn_vec3 from, sn_vec3 to,
                                        const sn_cylinder_options *opt, sn_affine *out, sn_error *err);

/* The map that takes a bone's ends from -> to to other ones: scaled along the axis by their distance, across
 * it by thickness, turned the smallest way. Ends: apart, finite; thickness > 0. */
sn_affine sn_place_ends(const sn_vec3 end[2], const sn_vec3 goal[2], double thickness);

typedef struct sn_curve_options { /* {0} with a count or a spacing: all other defaults */
    int32_t count;      /* bones along the curve; 0: as many as the spacing gives                      */
    double spacing;     /* from one to the next by arc length, the mean one where sizes differ; what is left
                           over at the curve's ends is equal; 0: length / count                        */
    double first, last; /* part of the curve by length, 0..1; both 0: all of it                        */
    double size[2];     /* how large the first and the last are to each other; 0, 0: equal. Bones in
                           between, and the spacing, are in proportion                                 */
    double fill;        /* size along the curve over the spacing; 0: 1, the template's own gaps        */
    double thickness;   /* across the curve over along it; 0: 1                                        */
    sn_vec3 front;      /* where +z points, as far as the tangent lets it; 0: +z                       */
    bool is_reversed;   /* the curve runs from the head's end; else towards the head                   */
    bool has_plane;     /* project the points to the plane first                                       */
    sn_vec3 plane_point, plane_normal;
    int32_t n_control; /* of the spline fitted to the points, 2..32; 0: a tenth of them, 4 to 12; no more
                          points than that (0: up to 12 points) are the control points themselves */
} sn_curve_options;
typedef struct sn_curve_report {
    double length;  /* of the (part of the) curve                                         */
    double spacing; /* mean, by arc length                                                */
    double moved;   /* largest distance of a point from the plane; 0 without one          */
    double rms;     /* distance of the points from the fitted curve                       */
    double fill;    /* as used: smaller than asked for where neighbours would cross       */
} sn_curve_report;
/* One map for each bone, in the order of the curve: +y of the template along the tangent, origin on the
 * curve, the same scale for x and z. Bone k of n sits in the middle of its own piece of the curve. A stroke
 * (more points than control points) is fitted as a line, however slowly parts of it were drawn.
 *
 * front is followed exactly where it is 20 degrees or more off the tangent. Nearer to it the bones turn
 * evenly from the one before to the one after by the smallest way, and no bone ever flips: on a curve that
 * turns through its front's direction and on, +z ends up on the other side.
 *
 * With crossing bones, or one inside of another, all are made smaller (fill, in steps of 4 % of what was
 * asked for, down to half) until none cross; still crossing is an error that names the pair.
 *
 * point: n x 3; neighbours that are equal count once. map: by sn_alloc, the caller's; NULL on error. report:
 * NULL to skip; filled as far as it got on error. Errors: SN_EINVAL (not a curve bone, fewer than two
 * different points or more than 100,000, count and spacing both or neither given, more than 1000 bones, out
 * of range, a stroke to be fitted that ends where it begins), SN_ESOLVE (they cross), SN_ENOMEM, SN_ECANCEL,
 * SN_ELIMIT. */
SN_MUST_USE sn_status sn_place_curve(const sn_bone_template *t, const double *point, int32_t n,
                                     const sn_curve_options *opt, const sn_run *run, sn_affine **map,
                                     int32_t *n_map, sn_curve_report *report, sn_error *err);

#endif
