/* scene_private.h - what the scene's files share. */
#ifndef SN_SCENE_PRIVATE_H
#define SN_SCENE_PRIVATE_H

#include "base/names.h"
#include "field/harmonic.h"
#include "muscle/path.h"
#include "scene/scene.h"
#include "scene/scene_bones.h"

typedef struct scene_bone {
    char *name;
    sn_tri_mesh mesh;
    sn_tri_mesh half; /* what is left of it in a half model; empty in a whole one */
    sn_landmark *landmark;
    int32_t n_landmark;
    bool has_ends;
    sn_vec3 from, to;
} scene_bone;

typedef struct scene_muscle {
    sn_muscle muscle;
    sn_collocation row; /* of the body as it is, when has_row                 */
    bool has_row;
    sn_paths paths; /* of the curves and the frame's angle as they are, when has_paths */
    bool has_paths;
    double *tensor; /* n_vert x 6 on the body as it is, when has_tensor; owned */
    bool has_tensor;
    bool is_solved;     /* its field is that of its tissue values, curves and tensor */
    double kept_volume; /* what each solve scales it to; 0: its volume is free       */
} scene_muscle;

/* What is computed, and up to where it is valid. Each step needs the ones before it. */
struct sn_scene {
    char *name, *unit;
    sn_up up;
    uint64_t revision;
    sn_notes notes;

    sn_tri_mesh skin; /* n_face = 0: none */
    scene_bone *bone;
    int32_t n_bone;
    size_t cap_bone;
    sn_joint *joint;
    int32_t n_joint;
    bool has_cut; /* half model */
    sn_vec3 cut_point, cut_normal;
    sn_tri_mesh half_skin;
    scene_muscle **muscle; /* pointers: the addresses of muscles stay */
    int32_t n_muscle;
    size_t cap_muscle;
    double fat, alpha;

    sn_body_options body_options;
    bool has_options; /* tetrahedralize was called: later meshing is like it */
    sn_body body;
    sn_body_report body_report;
    bool has_body;
    sn_locator *locator; /* with the body */

    sn_tissue_solver *solver; /* with the body                                         */
    sn_solve_report solved;   /* the last solve that had something to do               */
    sn_harmonic *harmonic;    /* with the body; NULL until there is reason to make it  */
    sn_tissue_muscle *inputs; /* what the solver was given                             */
    bool has_factor;          /* for the curves as they are                            */
    double *field;            /* (1 + n_muscle) x n_vert                               */
    bool has_field;           /* field has rows for these muscles on this body         */
    bool is_fat_solved;
    bool is_volume_kept; /* the fields are those of the volumes to be kept        */
};

/* ---- staleness: what an edit marks ---- */
void sn_scene_stale_body(sn_scene *s);                    /* skin or bones                       */
void sn_scene_stale_curves(sn_scene *s);                  /* a curve, alpha, the set of muscles  */
void sn_scene_stale_muscles(sn_scene *s);                 /* the set of muscles: other fields    */
void sn_scene_stale_field(sn_scene *s, int32_t i_muscle); /* tissue values; -1: fat              */

/* ---- what the steps need ---- */
SN_MUST_USE sn_status sn_scene_no_memory(sn_error *err);
SN_MUST_USE sn_status sn_scene_need_body(sn_scene *s, const sn_run *run, bool *was_meshed, sn_error *err);
SN_MUST_USE sn_status sn_scene_need_paths(scene_muscle *m, sn_error *err);
/* Scales the muscles whose volumes are to be kept. The fields are solved. */
SN_MUST_USE sn_status sn_scene_keep_volumes(sn_scene *s, const sn_run *run, sn_error *err);
void sn_scene_free_muscle(scene_muscle *m); /* NULL is fine */
void sn_scene_free_bone(scene_bone *b);
/* Takes *b over as the last bone, or in the place of bone i_bone when that is not < 0; leaves it to the
 * caller on error. */
SN_MUST_USE sn_status sn_scene_put_bone(sn_scene *s, int32_t i_bone, scene_bone *b, sn_error *err);
/* The half of a surface of the scene, empty when nothing is left of it. what: for messages. */
SN_MUST_USE sn_status sn_scene_half_of(const sn_tri_mesh *whole, const char *what, sn_vec3 point,
                                       sn_vec3 normal, sn_tri_mesh *half, sn_error *err);
void sn_scene_drop_joint(sn_scene *s, int32_t i_joint);
/* Maps the joints that stay with a mirrored or edited bone. */
SN_MUST_USE sn_status sn_scene_mirror_joints(sn_scene *s, sn_vec3 point, sn_vec3 normal, sn_error *err);
SN_MUST_USE sn_status sn_scene_check_muscle(const sn_scene *s, int32_t i_muscle, sn_error *err);

#endif
