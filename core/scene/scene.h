/* scene.h - the document: skin, bones, muscles, and everything computed from them. The only place that knows
 * what is stale: an edit marks its step and every later one; `solve`, `render` and `extract` first bring up
 * to date what they need.
 *
 *     skin | bones -> body (tets) -> curves (collocation, factor) -> values (right-hand sides) -> picture,
 * extraction
 *
 * On an error the scene is as before the call. Names of bones and muscles: 1..64 bytes, no '/', no '"' and no
 * control characters; each name once among the bones and once among the muscles; "fat" is taken. */
#ifndef SN_SCENE_SCENE_H
#define SN_SCENE_SCENE_H

#include "base/names.h"
#include "base/notes.h"
#include "extract/extraction.h"
#include "extract/part_fibers.h"
#include "field/attachment.h"
#include "field/tissue.h"
#include "muscle/muscle.h"
#include "muscle/path.h"
#include "render/picture.h"
#include "tetra/body.h"

typedef struct sn_scene sn_scene; /* opaque; one thread at a time */

/* unit: "m", "mm", "cm" ...: for files and reports only. Errors: SN_EINVAL, SN_ENOMEM. */
SN_MUST_USE sn_status sn_scene_create(sn_scene **out, const char *name, const char *unit, sn_up up,
                                      sn_error *err);
void sn_scene_destroy(sn_scene *s); /* NULL is fine */
const char *sn_scene_name(const sn_scene *s);
const char *sn_scene_unit(const sn_scene *s);
sn_up sn_scene_up(const sn_scene *s);
/* Counts edits; two equal numbers mean that nothing changed in between. */
uint64_t sn_scene_revision(const sn_scene *s);
/* Warnings since the last sn_scene_clear_notes. */
const sn_notes *sn_scene_notes(const sn_scene *s);
void sn_scene_clear_notes(sn_scene *s);

/* ---- skin and bones ---- (surfaces are copied) */
SN_MUST_USE sn_status sn_scene_set_skin(sn_scene *s, const sn_tri_mesh *skin, sn_error *err);
const sn_tri_mesh *sn_scene_skin(const sn_scene *s); /* NULL: none. Lives until the skin is set again. */
SN_MUST_USE sn_status sn_scene_add_bone(sn_scene *s, const char *name, const sn_tri_mesh *bone,
                                        sn_error *err);
SN_MUST_USE sn_status sn_scene_remove_bone(sn_scene *s, const char *name, sn_error *err);
int32_t sn_scene_bone_count(const sn_scene *s);
const char *sn_scene_bone_name(const sn_scene *s, int32_t i_bone);
const sn_tri_mesh *sn_scene_bone_mesh(const sn_scene *s, int32_t i_bone);
/* Index, or SN_EINVAL "no bone 'x' (did you mean 'y'?)". */
SN_MUST_USE sn_status sn_scene_find_bone(const sn_scene *s, const char *name, int32_t *i_bone, sn_error *err);

/* ---- body ---- */
/* Meshes the body now with these options, which also later re-meshing uses. report: NULL to skip.
 *
 * opt->is_adaptive: the edge lengths are those of places where tissues meet, in the fat or among muscles, and
 * of the curves; away from them they grow up to SN_BODY_COARSEST times. Where that is comes from a first mesh
 * that is fine at the curves only, on which the muscles as they are now are solved. The mesh then stays until
 * the next call: muscles that are moved far into its coarse regions are less exact. opt->sizing must be NULL.
 * Errors besides: SN_EINVAL (adaptive, and no muscles). */
SN_MUST_USE sn_status sn_scene_tetrahedralize(sn_scene *s, const sn_body_options *opt, const sn_run *run,
                                              sn_body_report *report, sn_error *err);
const sn_body *sn_scene_body(const sn_scene *s); /* NULL: not meshed, or stale */

/* ---- muscles ---- */
SN_MUST_USE sn_status sn_scene_set_fat(sn_scene *s, double value, sn_error *err);   /* >= 0 [0.2]  */
SN_MUST_USE sn_status sn_scene_set_alpha(sn_scene *s, double value, sn_error *err); /* > 0  [5]    */
double sn_scene_fat(const sn_scene *s);
double sn_scene_alpha(const sn_scene *s);
/* A muscle of one curve. point: n x 3; tissue: n values or NULL for 1. */
SN_MUST_USE sn_status sn_scene_add_muscle(sn_scene *s, const char *name, const double *point,
                                          const double *tissue, int32_t n, sn_error *err);
/* A muscle of several heads: one tissue function with all their curves. */
SN_MUST_USE sn_status sn_scene_add_heads(sn_scene *s, const char *name, const sn_head_points *head,
                                         int32_t n_head, sn_error *err);
SN_MUST_USE sn_status sn_scene_remove_muscle(sn_scene *s, const char *name, sn_error *err);
int32_t sn_scene_muscle_count(const sn_scene *s);
const sn_muscle *sn_scene_muscle(const sn_scene *s, int32_t i_muscle); /* lives until the muscles change */
/* Index, or SN_EINVAL "no muscle 'x' (did you mean 'y'?)". */
SN_MUST_USE sn_status sn_scene_find_muscle(const sn_scene *s, const char *name, int32_t *i_muscle,
                                           sn_error *err);
/* Edits; all indices 0-based. Errors: SN_EINVAL (index, value), SN_ENOMEM. */
SN_MUST_USE sn_status sn_scene_set_point(sn_scene *s, int32_t i_muscle, int32_t i_head, int32_t i_point,
                                         sn_vec3 p, sn_error *err);
SN_MUST_USE sn_status sn_scene_insert_point(sn_scene *s, int32_t i_muscle, int32_t i_head, int32_t i_point,
                                            sn_vec3 p, double tissue, sn_error *err);
SN_MUST_USE sn_status sn_scene_remove_point(sn_scene *s, int32_t i_muscle, int32_t i_head, int32_t i_point,
                                            sn_error *err);
/* i_head < 0: all heads; i_point < 0: all points. */
SN_MUST_USE sn_status sn_scene_set_tissue(sn_scene *s, int32_t i_muscle, int32_t i_head, int32_t i_point,
                                          double value, sn_error *err);
/* See muscle.h for the values and errors of these. Only the muscle's own field becomes stale, or nothing. */
SN_MUST_USE sn_status sn_scene_set_anisotropy(sn_scene *s, int32_t i_muscle, const sn_anisotropy *a,
                                              sn_error *err);
SN_MUST_USE sn_status sn_scene_set_pennation(sn_scene *s, int32_t i_muscle, const sn_pennation *p,
                                             sn_error *err);
SN_MUST_USE sn_status sn_scene_set_tendon(sn_scene *s, int32_t i_muscle, const sn_tendon *t, sn_error *err);
/* The curves with their frames; lives until the muscle is edited. */
SN_MUST_USE sn_status sn_scene_muscle_paths(sn_scene *s, int32_t i_muscle, const sn_paths **paths,
                                            sn_error *err);

/* ---- volumes ---- (cubed unit; each solves first if stale) */
SN_MUST_USE sn_status sn_scene_muscle_volume(sn_scene *s, int32_t i_muscle, const sn_run *run, double *volume,
                                             sn_error *err);
/* Scales the muscle's tissue values so that it has this volume, to 0.001 %; muscles whose volume is kept give
 * way and take back elsewhere. Errors: SN_EINVAL (not > 0; no tissue value gives it: says what is possible).
 */
SN_MUST_USE sn_status sn_scene_set_volume(sn_scene *s, int32_t i_muscle, double volume, const sn_run *run,
                                          sn_error *err);
/* From now on every solve scales the muscle's tissue values so that the volume stays what it is now, whatever
 * is edited; a solve that cannot do so fails and says what is possible. */
SN_MUST_USE sn_status sn_scene_set_preserve_volume(sn_scene *s, int32_t i_muscle, bool is_kept,
                                                   const sn_run *run, sn_error *err);
double sn_scene_kept_volume(const sn_scene *s, int32_t i_muscle); /* 0: free */

/* ---- results ---- */
typedef struct sn_solve_report {
    double seconds; /* of this call                                                     */
    bool was_meshed, was_factorized;
    sn_tissue_report tissue; /* of the last solve; n_solved and residual with anisotropic muscles */
    int32_t n_anisotropic;   /* of n_solved, with a factorization of their own                   */
    double seconds_frames, seconds_anisotropic; /* summed over these muscles, which run side by side:
                                                   frames and tensors; assembly, factor, solution  */
    bool was_quick;                             /* some fields were left as they were: within tolerance */
} sn_solve_report;
/* Brings the fields up to date; does nothing when they are. report: NULL to skip. Errors: SN_EINVAL (no skin,
 * no muscles, a curve that never enters the body), and those of the steps it runs. */
SN_MUST_USE sn_status sn_scene_solve(sn_scene *s, const sn_run *run, sn_solve_report *report, sn_error *err);
/* For the picture while something is edited: fields that an edit elsewhere changes by less than 1e-3 of the
 * largest tissue value may stay as they are. They are solved for when something exact is asked for. Errors as
 * above. */
SN_MUST_USE sn_status sn_scene_solve_quick(sn_scene *s, const sn_run *run, sn_solve_report *report,
                                           sn_error *err);
/* From the next solve on; another one than before makes the fields stale. */
void sn_scene_set_solver(sn_scene *s, sn_solver_kind kind);
/* Whether the last solve that had something to do solved for this tissue, and made a factor for it alone. */
bool sn_scene_was_solved(const sn_scene *s, int32_t i_tissue);
bool sn_scene_was_factorized(const sn_scene *s, int32_t i_tissue);
int32_t sn_scene_tissue_count(const sn_scene *s);                      /* 1 + muscles */
const char *sn_scene_tissue_name(const sn_scene *s, int32_t i_tissue); /* "fat", then the muscles */
/* Values of all tissues at p (tissue_count of them); *inside false outside of the tet mesh. Solves first if
 * stale. */
SN_MUST_USE sn_status sn_scene_values_at(sn_scene *s, sn_vec3 p, const sn_run *run, double *value,
                                         bool *inside, sn_error *err);
typedef enum sn_place { SN_PLACE_TISSUE, SN_PLACE_BONE, SN_PLACE_OUTSIDE } sn_place;
/* index: tissue or bone. Solves first if stale. */
SN_MUST_USE sn_status sn_scene_tissue_at(sn_scene *s, sn_vec3 p, const sn_run *run, sn_place *place,
                                         int32_t *index, sn_error *err);
/* Solves first if stale. out: init-ed. */
SN_MUST_USE sn_status sn_scene_extract(sn_scene *s, const sn_extract_options *opt, const sn_run *run,
                                       sn_extraction *out, sn_error *err);
/* The tissue fields, n_tissue x n_vert, NULL while stale. */
const double *sn_scene_fields(const sn_scene *s);
/* The same, or those of a quick solve; NULL while stale. */
const double *sn_scene_picture_fields(const sn_scene *s);

/* opt->camera comes from the caller; see sn_scene_bounds. n_fiber: lines in each muscle when fibers are
 * shown, at least 1. Frames are drawn of muscles that have one (sn_anisotropy is_on, or pennate fibers).
 * Solves first if stale and muscles or fibers are shown and there are any; muscles without fibers (empty,
 * heads that share no end) get a note. */
SN_MUST_USE sn_status sn_scene_render(sn_scene *s, const sn_picture_options *opt, int32_t n_fiber,
                                      const sn_run *run, sn_image *out, sn_picture_stats *stats,
                                      sn_error *err);
sn_box3 sn_scene_bounds(const sn_scene *s); /* of skin, bones and control points */

typedef struct sn_muscle_report {
    double length;         /* of the curves                                                      */
    double volume;         /* where the muscle wins: of the extraction                           */
    int32_t tets;          /* of the extraction                                                  */
    int32_t components;    /* pieces joined through faces                                        */
    double length_outside; /* of the curve                                                       */
    sn_attachment *end;    /* 2 n_head: origin and insertion of each head; owned                 */
    int32_t n_head;
    bool has_fibers; /* false: empty, or its heads share no end                            */
    sn_part_architecture architecture;
} sn_muscle_report;
#define SN_TISSUE_HISTOGRAM 9
typedef struct sn_scene_report {
    sn_muscle_report *muscle; /* n_muscle, owned */
    int32_t n_muscle;
    double fat_volume;
    int64_t tissues_per_tet[SN_TISSUE_HISTOGRAM]; /* [k]: tets of the body with k tissues, the last: that many
                                                     or more; [0] unused */
    sn_body_report body;
    sn_solve_report solve;
    double seconds_extract;
} sn_scene_report;
/* Solves and extracts first. r: zero-initialised. */
SN_MUST_USE sn_status sn_scene_report_make(sn_scene *s, const sn_run *run, sn_scene_report *r, sn_error *err);
void sn_scene_report_free(sn_scene_report *r);

#endif
