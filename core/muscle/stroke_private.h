/* stroke_private.h - what the stroke's files share: the room between bones and skin, and the ends. */
#ifndef SN_MUSCLE_STROKE_PRIVATE_H
#define SN_MUSCLE_STROKE_PRIVATE_H

#include "mesh/bvh.h"
#include "muscle/stroke.h"

typedef struct stroke_room {
    sn_bvh *bones; /* all in one, labelled by bone */
    sn_bvh *skin;  /* NULL: none                   */
    double margin, diagonal;
    sn_vec3 end[2]; /* origin and insertion */
} stroke_room;

/* ---- stroke_room.c ---- */
SN_MUST_USE sn_status sn_stroke_room_make(stroke_room *r, const sn_stroke_body *body, double margin,
                                          sn_error *err);
void sn_stroke_room_free(stroke_room *r);
/* How far p is outside of the bones, or inside the skin; negative on the wrong side. away (NULL to skip): the
 * unit direction in which that grows fastest, 0 on the surface itself. */
double sn_stroke_bone_gap(const stroke_room *r, sn_vec3 p, sn_vec3 *away);
double sn_stroke_skin_gap(const stroke_room *r, sn_vec3 p, sn_vec3 *away);
/* The gap wanted at p: the margin, less near the ends. */
double sn_stroke_wanted_gap(const stroke_room *r, sn_vec3 p);
/* Surfaces around the point at t of a ray with these hits: > 0 inside of a closed one. */
int sn_stroke_winding(const sn_ray_hit *hit, size_t n_hit, double t);

/* ---- stroke_view.c ---- */
sn_vec3 sn_stroke_sight(const sn_stroke_view *v, const double pixel[2]); /* from the eye, at depth 1 */
/* Depth and pixel of p; false when it is not before the eye. */
bool sn_stroke_project(const sn_stroke_view *v, sn_vec3 p, double pixel[2], double *depth);
/* The bone points of both ends; moves the ends of pixel (n x 2) where it snaps. */
SN_MUST_USE sn_status sn_stroke_find_ends(const sn_stroke_view *v, const sn_stroke_body *body,
                                          const stroke_room *r, double snap, double *pixel, int32_t n,
                                          sn_vec3 end[2], sn_stroke_report *report, sn_error *err);

/* ---- stroke_path.c ---- */
/* The clear path through the pixels (SN_STROKE_SAMPLES x 2) with these depths at the ends. path: x 3. */
SN_MUST_USE sn_status sn_stroke_clear_path(const sn_stroke_view *v, const stroke_room *r, const double *pixel,
                                           const double depth[2], const sn_run *run, double *path,
                                           sn_error *err);
#endif
