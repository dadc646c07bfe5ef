/* path.h - the heads' curves sampled evenly, with a frame carried along without twist [A 3.7].
 *
 * The frame is (e1, e2, e3): e1 the tangent, e2 and e3 across, right-handed. At the first point of a head,
 * and at angle 0, e2 is the wanted axis made normal to the curve; without one it is the coordinate axis that
 * the curve runs along least, and the later heads take that of the first; so does a head whose curve starts along
 * the wanted axis. From there the frame is carried by
 * the double reflection of Wang et al. 2008 (parallel transport up to fourth order in the step). */
#ifndef SN_MUSCLE_PATH_H
#define SN_MUSCLE_PATH_H

#include "muscle/muscle.h"

typedef struct sn_triad {
    sn_vec3 e1, e2, e3;
} sn_triad;

#define SN_PATH_STEPS 256
typedef struct sn_path { /* one head */
    sn_vec3 point[SN_PATH_STEPS + 1];
    sn_triad frame[SN_PATH_STEPS + 1];
    double length;
    double group_radius[SN_PATH_STEPS / 16]; /* of every 16 steps about their middle point */
} sn_path;

typedef struct sn_paths {
    sn_path *head; /* n_head, owned */
    int32_t n_head;
} sn_paths;

/* p: zero-initialised or filled. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_paths_build(sn_paths *p, const sn_muscle *m, sn_error *err);
void sn_paths_free(sn_paths *p);

/* The point and frame at a length of curve; beyond the ends the curve goes on straight. */
sn_vec3 sn_path_point(const sn_path *p, double arc);
sn_triad sn_path_frame(const sn_path *p, double arc);

typedef struct sn_curve_place { /* the place of the heads' curves that is nearest to a point                */
    int32_t head;               /* ties go to the lower                                                 */
    double arc;                 /* length of curve from the origin; < 0 or > length: that far beyond an end,
                                   along the end's tangent                                              */
    double distance;            /* from the curve (from its end, beyond one)                            */
} sn_curve_place;
sn_curve_place sn_paths_place(const sn_paths *p, sn_vec3 point);

/* The unit vector across t (a unit vector) that is nearest to axis; false when axis runs along t. */
bool sn_normal_towards(sn_vec3 t, sn_vec3 axis, sn_vec3 *out);
/* The axis that e2 of all heads starts towards: the one set, or the one chosen. */
sn_vec3 sn_muscle_frame_axis(const sn_muscle *m);

#endif
