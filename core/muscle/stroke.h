/* stroke.h - a stroke drawn in a picture becomes the control points of a muscle [A 3.2].
 *
 * The first and last point of the stroke must lie over a bone: the first bone surface that their lines of
 * sight enter is the origin and the insertion. What the depth is in between the picture does not tell:
 *   SN_DEPTH_LINEAR  the paper's: it runs linearly from one end to the other (by the stroke's length);
 *   SN_DEPTH_CLEAR   the cheapest path that stays inside the skin and outside of the bones by a margin, turns
 *                    as little as possible and rather runs before a bone than behind it. Where no depth is
 *                    free it may leave the stroke a little. Straight where nothing is in the way.
 * The spline is fitted to that path by least squares. */
#ifndef SN_MUSCLE_STROKE_H
#define SN_MUSCLE_STROKE_H

#include "base/run.h"
#include "mesh/tri_mesh.h"

#define SN_STROKE_SAMPLES 65 /* points of a path, evenly spaced along the stroke, however it was drawn */

typedef enum sn_stroke_depth { SN_DEPTH_CLEAR, SN_DEPTH_LINEAR } sn_stroke_depth;

/* The picture: the line of sight of pixel (x, y) leaves eye towards corner + x per_x + y per_y. Depth is the
 * factor of that vector. */
typedef struct sn_stroke_view {
    sn_vec3 eye, corner, per_x, per_y; /* the last three: not in one plane */
} sn_stroke_view;

typedef struct sn_stroke_body { /* borrowed; closed surfaces, turned outwards here where they are not */
    const char *const *bone_name;
    const sn_tri_mesh *const *bone;
    int32_t n_bone;          /* 1 or more            */
    const sn_tri_mesh *skin; /* NULL: no limit there */
} sn_stroke_body;

typedef struct sn_stroke { /* borrowed */
    sn_stroke_view view;
    const double *pixel; /* n_pixel x 2, each within -1e6..1e6 */
    int32_t n_pixel;
} sn_stroke;

typedef struct sn_stroke_options { /* {0}: all defaults */
    sn_stroke_depth depth;
    int32_t n_point; /* control points, 2..32; 0: 4                                             */
    double snap;     /* pixels, >= 0: an end that misses takes the nearest bone within that     */
    double margin;   /* to bones and skin, >= 0; 0: 1 % of the diagonal of the skin's box (of   */
                     /* the bones' without skin). It fades in from the ends, which lie on bone. */
} sn_stroke_options;

typedef struct sn_stroke_report {
    double rms, max;     /* distance of the path from the curve                             */
    double path_length;  /* of the path                                                     */
    double inside_bone;  /* share of the curve's length, 0..1                               */
    double outside_skin; /* the same; 0 without skin                                        */
    double snapped[2];   /* pixels that the first and the last point were moved by          */
    int32_t bone[2];     /* of the origin and the insertion                                 */
    double path[3 * SN_STROKE_SAMPLES];
} sn_stroke_report;

/* point: n_point x 3, the first on the origin's bone, the last on the insertion's. Deterministic; run's
 * threads are used. report: NULL to skip. Errors, before anything is written: SN_EINVAL (options; no bones;
 * fewer than two different pixels; a view that is flat; an end that misses all bones: the message has the
 * nearest bone, where it is in the picture and in space, and how far off; both ends on one spot), SN_ECANCEL,
 * SN_ENOMEM. */
SN_MUST_USE sn_status sn_stroke_curve(const sn_stroke *s, const sn_stroke_body *body,
                                      const sn_stroke_options *opt, const sn_run *run, double *point,
                                      sn_stroke_report *report, sn_error *err);
/* Control points for opt->n_point: 4 for 0. */
int32_t sn_stroke_point_count(const sn_stroke_options *opt);

#endif
