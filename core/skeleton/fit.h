/* fit.h - a shape bone (a skull, a pelvis, a shoulder blade) fitted to the skin around it: the template's own
 * piece of skin is moved onto the skin of the model, first as a whole, then with its cage, and the bone
 * follows the cage [A 3.1.3 and 3.1.4]. */
#ifndef SN_SKELETON_FIT_H
#define SN_SKELETON_FIT_H

#include "skeleton/icp_cage.h"
#include "skeleton/icp_rigid.h"

typedef struct sn_fit_template { /* all borrowed, in one frame */
    const sn_tri_mesh *bone;     /* any surface                                                     */
    const sn_tri_mesh *cage;     /* closed, some 20 to 200 vertices, around bone and skin: sn_cage_check */
    const sn_tri_mesh *skin;     /* the skin over the bone, usually open; normals point outwards     */
    const double *point;         /* n_point x 3, landmarks that go along; NULL: none                 */
    int32_t n_point;
} sn_fit_template;

typedef struct sn_fit_options { /* zeros: the defaults of icp_rigid.h and icp_cage.h */
    sn_icp_options rigid;
    sn_icp_cage_options cage;
    bool keeps_scale; /* the first step finds no scale, only the second one stretches */
} sn_fit_options;

typedef struct sn_fit_result { /* zero-initialised = empty */
    sn_tri_mesh bone;          /* faces and labels of the template's        */
    sn_tri_mesh cage;          /* where the cage went                       */
    double *point;             /* n_point x 3, NULL when there are none     */
    sn_transform placement;    /* the rigid step's: template -> model       */
    sn_icp_report rigid, bent; /* filled also on error, as far as it went   */
    int32_t n_inverted;        /* faces of the bone that the cage turned inside out */
    int64_t n_crossing;        /* pairs of the fitted bone's faces that cross ...  */
    int64_t n_crossing_before; /* ... and of the template's                        */
    int64_t n_cage_crossing;   /* pairs of the fitted cage's faces that cross      */
    /* Vertices of the template outside its cage: they are carried along, but less smoothly. */
    int32_t n_bone_outside, n_skin_outside;
} sn_fit_result;
void sn_fit_result_free(sn_fit_result *r);

/* start: where the template is put first, within some 20 degrees and 20 % of its size. skin: the model's,
 * closed, faces outwards. out: empty; on error its meshes and points stay empty. Errors: SN_EINVAL (a surface
 * that is not valid or not closed, a start or option out of range), SN_ESOLVE (does not converge: the message
 * has the residual reached, the one wanted and the iterations), SN_ENOMEM, SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_fit_shape(const sn_fit_template *t, const sn_tri_mesh *skin,
                                   const sn_transform *start, const sn_fit_options *options,
                                   const sn_run *run, sn_fit_result *out, sn_error *err);

#endif
