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
    uint64_t id, tensor_stamp;       /* other ones for another muscle, another tensor           */
    bool is_solved;                  /* its field is that of all curves, its tissue values and tensor */
    sn_tissue_stamp stamp;           /* of its field                                                */
    bool is_edited;                  /* it has no field, or one of other curves or values of its own  */
    bool was_solved, was_factorized; /* by the last solve that had something to do             */
    double kept_volume;              /* what each solve scales it to; 0: its volume is free       */
} scene_muscle;

/* What is computed, and up to where it is valid. Each step needs the ones before it. */
struct sn_scene {
    char *name, *unit;
    sn_up up;
    uint64_t revision;
    uint64_t shape_revision,
        field_revision;      /* counted up when skin, bones or tets, when `field` is written */
    struct scene_view *view; /* what the last picture leaves to the next: scene_picture.c    */
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

    sn_solver_kind solver_kind;
    sn_tissue_solver *solver; /* with the body                                         */
    sn_solve_report solved;   /* the last solve that had something to do               */
    sn_harmonic *harmonic;    /* with the body; NULL until there is reason to make it  */
    sn_tissue_muscle *inputs; /* what the solver was given                             */
    bool has_curves;          /* it was given the curves as they are                   */
    double *field;            /* n_field x n_vert; row 1 + i is muscle i's             */
    int32_t n_field;
    bool is_fat_solved, is_fat_edited, was_fat_solved; /* as of a muscle                          */
    sn_tissue_stamp fat_stamp;
    bool is_volume_kept; /* the fields are those of the volumes to be kept        */
    bool is_quick;       /* the fields are good enough for a picture              */
    uint64_t n_made;     /* muscles and tensors: where their ids and stamps come from */
};

/* ---- staleness: what an edit marks ---- */
void sn_scene_stale_body(sn_scene *s);                    /* skin or bones                       */
void sn_scene_stale_curves(sn_scene *s);                  /* a curve, alpha, the set of muscles  */
void sn_scene_drop_fields(sn_scene *s, int32_t i_muscle); /* of a muscle, before it goes; -1: all */
void sn_scene_stale_field(sn_scene *s, int32_t i_muscle); /* tissue values; -1: fat              */

/* ---- what the steps need ---- */
SN_MUST_USE sn_status sn_scene_no_memory(sn_error *err);
SN_MUST_USE sn_status sn_scene_need_body(sn_scene *s, const sn_run *run, bool *was_meshed, sn_error *err);
/* How long the edges of an adaptive mesh should be, by the muscles as they are (scene_adaptive.c); in the unit
 * box of the skin. out: zero-initialised. Errors: SN_EINVAL (options; no muscles), and those of meshing,
 * solving and extracting. */
SN_MUST_USE sn_status sn_scene_find_sizing(const sn_scene *s, const sn_body_options *opt, const sn_run *run,
                                           sn_sizing *out, int32_t *n_coarse_tet, sn_error *err);
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
void sn_scene_free_view(sn_scene *s); /* the next picture is made from nothing */
SN_MUST_USE sn_status sn_scene_check_muscle(const sn_scene *s, int32_t i_muscle, sn_error *err);

#endif
