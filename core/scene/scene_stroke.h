/* scene_stroke.h - muscles drawn as strokes in a picture of the scene: muscle/stroke.h for a camera. */
#ifndef SN_SCENE_SCENE_STROKE_H
#define SN_SCENE_SCENE_STROKE_H

#include "muscle/stroke.h"
#include "scene/scene.h"

typedef struct sn_scene_stroke { /* borrowed */
    const char *name;            /* of the new muscle                                            */
    const sn_camera *camera;
    int width, height;    /* pixels of the picture                                               */
    const double *pixel;  /* n_pixel x 2, from the origin to the insertion, as sn_camera_ray has */
    int32_t n_pixel;      /* them                                                                */
    const double *tissue; /* one per control point (sn_stroke_point_count); NULL: all 1          */
} sn_scene_stroke;

/* Adds the muscle as the last one. Leaves a note when more than 1 % of its curve lies in bone or outside of
 * the skin. report: NULL to skip. Errors: those of sn_stroke_curve, sn_camera_check and sn_scene_add_muscle;
 * the scene is then as before. */
SN_MUST_USE sn_status sn_scene_draw_muscle(sn_scene *s, const sn_scene_stroke *stroke,
                                           const sn_stroke_options *opt, const sn_run *run,
                                           sn_stroke_report *report, sn_error *err);

#endif
