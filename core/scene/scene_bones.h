/* scene_bones.h - the skeleton of a scene: bones from the library or as surfaces, edited, mirrored, joined,
 * cut.
 *
 * A bone keeps its landmarks and, where it was placed between two points, its ends: they go along with every
 * edit. All edits make the body stale. On an error the scene is as before the call. */
#ifndef SN_SCENE_SCENE_BONES_H
#define SN_SCENE_SCENE_BONES_H

#include "scene/scene.h"
#include "skeleton/bone_template.h"
#include "skeleton/clearance.h"
#include "skeleton/fit.h"
#include "skeleton/place.h"

/* ---- placing ---- */

typedef struct sn_pick { /* a place in the body                                                          */
    bool is_ray;         /* origin and dir: the midpoint of the ray's first two hits with the skin        */
    sn_vec3 origin, dir; /* a point is its origin                                                         */
} sn_pick;
SN_MUST_USE sn_status sn_scene_pick(const sn_scene *s, const sn_pick *pick, sn_vec3 *out, sn_error *err);

typedef struct sn_bone_placing { /* what all kinds have in common                                         */
    const char *name;            /* of the new bone                                                       */
    const sn_bone_template *from_template;
    double margin; /* to the skin, see clearance.h; 0: as it falls                                        */
} sn_bone_placing;

typedef struct sn_cylinder_placing {
    sn_cylinder_options map; /* front 0: the scene's                                                      */
    double proportion;       /* thickness over the one in proportion to the length; 0: 1                  */
    bool is_kept;            /* thickness as of the template, whatever the length                         */
} sn_cylinder_placing;

/* A bone whose name ends in _r, .r, _right ... is the mirror image of the template, whatever opt says. Adds
 * the bone as the last one. clear: NULL to skip; filled when there is a margin. Errors: those of place.h,
 * fit.h, clearance.h and sn_scene_add_bone; rays and margins need a skin. */
SN_MUST_USE sn_status sn_scene_place_cylinder(sn_scene *s, const sn_bone_placing *p, const sn_pick *from,
                                              const sn_pick *to, const sn_cylinder_placing *opt,
                                              const sn_run *run, sn_clearance_report *clear, sn_error *err);
/* One bone of many pieces: piece k, from 1, has its landmarks as NAME_k. point: n x 3. */
SN_MUST_USE sn_status sn_scene_place_row(sn_scene *s, const sn_bone_placing *p, const double *point,
                                         int32_t n, const sn_curve_options *opt, const sn_run *run,
                                         sn_curve_report *report, int32_t *n_piece,
                                         sn_clearance_report *clear, sn_error *err);

/* Where the lines of sight of a stroke's pixels (n x 2) meet a plane; out: n x 3. Errors: SN_EINVAL (a plane
 * that is seen from its edge, or lies behind the eye). */
SN_MUST_USE sn_status sn_scene_stroke_on_plane(const sn_camera *camera, int width, int height,
                                               const double *pixel, int32_t n, sn_vec3 point, sn_vec3 normal,
                                               double *out, sn_error *err);

typedef struct sn_shape_options { /* {0}: as the template is, in the scene's unit                         */
    double size;                  /* factor; 0: 1                                                         */
    sn_affine turn;               /* rotation about the template's origin, once it stands upright; 0: none */
    bool is_fitted;               /* to the skin around it: needs a template with a cage, and a skin      */
    sn_fit_options fit;
} sn_shape_options;
/* fit: zero-initialised; filled when fitted, also on error; the caller's to free. NULL when not fitted. */
SN_MUST_USE sn_status sn_scene_place_shape(sn_scene *s, const sn_bone_placing *p, const sn_pick *at,
                                           const sn_shape_options *opt, const sn_run *run, sn_fit_result *fit,
                                           sn_clearance_report *clear, sn_error *err);
/* Scene units in a metre: the templates' unit. m, dm, cm, mm, km, in, ft. Errors: SN_EINVAL (lists the
 * known). */
SN_MUST_USE sn_status sn_scene_units_per_metre(const sn_scene *s, double *out, sn_error *err);

/* ---- editing ---- */
/* The middle of the box of the whole bone, also in a half model. */
sn_vec3 sn_scene_bone_centre(const sn_scene *s, int32_t i_bone);
/* Errors: SN_EINVAL (a map that is not finite or flattens). */
SN_MUST_USE sn_status sn_scene_map_bone(sn_scene *s, int32_t i_bone, const sn_affine *map, sn_error *err);
/* Takes a bone with ends to new ones: scaled along its axis, and across it by `thickness` (1: as thick as it
 * is). Errors: SN_EINVAL (a bone without ends, ends that are one point, thickness not > 0). */
SN_MUST_USE sn_status sn_scene_set_bone_ends(sn_scene *s, int32_t i_bone, sn_vec3 from, sn_vec3 to,
                                             double thickness, sn_error *err);
bool sn_scene_bone_ends(const sn_scene *s, int32_t i_bone, sn_vec3 *from,
                        sn_vec3 *to); /* false: it has none */
const sn_landmark *sn_scene_bone_landmarks(const sn_scene *s, int32_t i_bone, int32_t *n);
/* Errors: SN_EINVAL: no such landmark: suggests the nearest, or lists them. */
SN_MUST_USE sn_status sn_scene_bone_landmark(const sn_scene *s, int32_t i_bone, const char *name,
                                             sn_landmark *out, sn_error *err); /* name: the scene's */
/* Adds a landmark or moves the one of that name. radius >= 0. */
SN_MUST_USE sn_status sn_scene_set_landmark(sn_scene *s, int32_t i_bone, const char *name, sn_vec3 at,
                                            double radius, sn_error *err);
/* How far the bone stays inside of the skin; _keep_ moves what comes too near. Errors: SN_EINVAL (no skin).
 */
SN_MUST_USE sn_status sn_scene_bone_clearance(const sn_scene *s, int32_t i_bone, double margin,
                                              const sn_run *run, sn_clearance *out, sn_error *err);
SN_MUST_USE sn_status sn_scene_keep_bone_clear(sn_scene *s, int32_t i_bone, double margin, const sn_run *run,
                                               sn_clearance_report *report, sn_error *err);
/* Every bone and joint whose name has a side (base/side_name.h) gets its image on the other side of the plane
 * under the other name; one of that name is replaced. Where both sides are there, the left one counts.
 * report: how many were added and replaced. Errors: SN_EINVAL (plane, no bone with a side). */
SN_MUST_USE sn_status sn_scene_mirror_bones(sn_scene *s, sn_vec3 point, sn_vec3 normal, int32_t *n_added,
                                            int32_t *n_replaced, sn_error *err);

/* ---- joints ---- */
typedef struct sn_joint {
    char *name;           /* the scene's                                                                  */
    char *parent, *child; /* names of bones                                                              */
    sn_vec3 center;
    sn_vec3 axis[3]; /* orthonormal, right-handed: rotations of the child are about these               */
} sn_joint;
/* axis: NULL: those of space; else three vectors, made orthonormal in this order. Errors: SN_EINVAL (a name
 * that is taken, bones that are not there or the same, axes that do not span space, a child with a parent
 * already, a ring). */
SN_MUST_USE sn_status sn_scene_add_joint(sn_scene *s, const char *name, const char *parent, const char *child,
                                         sn_vec3 center, const sn_vec3 axis[3], sn_error *err);
SN_MUST_USE sn_status sn_scene_remove_joint(sn_scene *s, const char *name, sn_error *err);
int32_t sn_scene_joint_count(const sn_scene *s);
const sn_joint *sn_scene_joint(const sn_scene *s, int32_t i_joint);

/* ---- half models [A 5] ---- */
/* From now on skin, bones and body are those on the side of the plane that normal points to; the caps carry
 * no skin condition. The whole surfaces are kept. Errors: SN_EINVAL (no skin, plane), SN_EMESH. */
SN_MUST_USE sn_status sn_scene_cut(sn_scene *s, sn_vec3 point, sn_vec3 normal, sn_error *err);
void sn_scene_uncut(sn_scene *s);
bool sn_scene_cut_plane(const sn_scene *s, sn_vec3 *point, sn_vec3 *normal); /* false: not cut */

#endif
