/* bone_template.h - a bone of the library: its surface with named landmarks, and what places it [A 3.1].
 *
 * Templates are of the left side in the anatomical position, in metres at the size of an adult human: +x
 * lateral (left), +y towards the head or the trunk, +z to the front. */
#ifndef SN_SKELETON_BONE_TEMPLATE_H
#define SN_SKELETON_BONE_TEMPLATE_H

#include "mesh/tri_mesh.h"

typedef enum sn_bone_kind {
    SN_BONE_CYLINDER, /* between two handles                                                      */
    SN_BONE_CURVE,    /* one of a row along a curve                                               */
    SN_BONE_SHAPE     /* fitted to the skin around it                                             */
} sn_bone_kind;
const char *sn_bone_kind_name(sn_bone_kind kind); /* "cylinder", "curve", "shape" */

typedef struct sn_landmark {
    char *name; /* owned; 1..64 bytes                                                             */
    sn_vec3 at;
    double radius; /* of the attachment region around it, on the bone's surface; 0: the centre of a joint */
} sn_landmark;
void sn_landmarks_free(sn_landmark *landmark, int32_t n); /* NULL is fine */
/* Deep copy by sn_alloc; NULL for none. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_landmarks_copy(sn_landmark **out, const sn_landmark *landmark, int32_t n,
                                        sn_error *err);

typedef struct sn_bone_template { /* zero-initialised = empty */
    char *name;
    sn_bone_kind kind;
    sn_tri_mesh bone;
    sn_tri_mesh cage, skin; /* of shapes (icp_cage.h), may be empty                                 */
    sn_vec3 from, to;       /* of cylinders: the centres of the proximal and the distal joint       */
    double length;          /* of curve bones: how far along the curve one comes after another      */
    sn_landmark *landmark;  /* n_landmark, owned                                                    */
    int32_t n_landmark;
} sn_bone_template;
void sn_bone_template_free(sn_bone_template *t); /* fine on empty, fine twice */

/* Turns a template of any place and direction into the frame of curve bones: the middle between from and to
 * comes to the origin, from -> to along +y, front towards +z; length is their distance unless it is set.
 * Errors: SN_EINVAL (from and to one point, front along them). */
SN_MUST_USE sn_status sn_bone_template_align(sn_bone_template *t, sn_vec3 from, sn_vec3 to, sn_vec3 front,
                                             sn_error *err);

/* Reads the two texts of a template. text: lines `kind`, `from`, `to`, `length`, `landmark NAME X Y Z
 * RADIUS`, `joint NAME X Y Z`; `#` starts a comment. obj: `o NAME`, `o cage`, `o skin` with v and f lines,
 * triangles, indices counted through. out: empty. Errors: SN_EFORMAT (names the line), SN_EINVAL
 * (sn_bone_template_check), SN_ENOMEM; out is then empty. */
SN_MUST_USE sn_status sn_bone_template_parse(sn_bone_template *out, const char *name, const char *text,
                                             const char *obj, sn_error *err);
/* Meshes valid, the bone closed; handles apart; length > 0; landmark names once each; a cage comes with a
 * skin and the other way round. The message names the template and the first breach. SN_EINVAL, SN_ENOMEM. */
SN_MUST_USE sn_status sn_bone_template_check(const sn_bone_template *t, sn_error *err);

#endif
