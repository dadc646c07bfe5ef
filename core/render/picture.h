/* picture.h - draws a body: muscles from the tissue fields, bones, translucent skin, curves.
 *
 * What is seen of a muscle is the first change from fat to it along the ray [A 3.6]. All fields are linear
 * inside a tet, so these places are planes there: they are cut out as polygons that share vertices (see
 * muscle_surface.h), once for each set of fields and not for each ray. Where a muscle reaches the border of
 * the tet mesh (bone, skin, a symmetry plane), the border is its surface.
 *
 * With a clip plane, the cut is a section as in an atlas: plain colours of the tissues (fat is pale cream),
 * bones capped in their own, dark lines between. The section shows only to an eye on the removed side. Bones
 * that are not closed get no cap. Curves, control points and arrows (show_frames) are laid over the rest,
 * faint where something solid hides them. Fibers are solid when no muscles are drawn: bones hide them, and
 * they shade each other; else they are laid over the rest, too. Tendon is pearly white in place of the
 * muscle's colour, on its surface and in the section.
 *
 * For many pictures of one scene see painter.h. No context is current after a call. LP_NUM_THREADS sets the
 * threads that llvmpipe draws with; sn_run only those that prepare. */
#ifndef SN_RENDER_PICTURE_H
#define SN_RENDER_PICTURE_H

#include "base/run.h"
#include "mesh/tet_mesh.h"
#include "mesh/tri_mesh.h"
#include "render/camera.h"
#include "render/context.h"
#include "render/image.h"

typedef struct sn_rgb {
    float r, g, b; /* sRGB values 0..1, as an artist picks them */
} sn_rgb;

/* The colour of muscle i_muscle (0-based, in the order added): distinct neighbours, flesh-like but clearly
 * different, the same for ever. */
sn_rgb sn_muscle_color(int32_t i_muscle);

typedef struct sn_picture_curve {
    const double *point; /* n_point x 3: the curve as drawn (already sampled)  */
    int32_t n_point;
    const double *control; /* n_control x 3, the control points                  */
    int32_t n_control;
    sn_rgb color;
} sn_picture_curve;

typedef struct sn_picture_line { /* one of many thin lines: a fiber */
    const double *point;         /* n_point x 3 */
    int32_t n_point;
    sn_rgb color; /* drawn a little darker or lighter from line to line */
} sn_picture_line;

typedef struct sn_picture_arrow { /* nothing is drawn of one without a length */
    sn_vec3 from, along;          /* its tip is at from + along; as thick as its length asks for */
    sn_rgb color;
} sn_picture_arrow;

/* For painter.h: while a stamp that is not 0 stays the same, so do the things it stands for. 0: they may have
 * changed. One picture alone needs none. */
typedef struct sn_picture_stamps {
    uint64_t shapes; /* tets, bones, skin                                       */
    uint64_t fields; /* field and tendon                                        */
    uint64_t curves; /* curves, arrows, and with `fields` the fibers            */
} sn_picture_stamps;

typedef struct sn_picture_scene { /* all borrowed for the call; zero-initialised = nothing to draw */
    const sn_tet_mesh *tets;      /* NULL: no muscles                                                */
    const double *field;          /* n_tissue x n_vert, row 0 is fat, then the muscles in order       */
    int32_t n_tissue;             /* 1 + number of muscles                                            */
    const sn_tri_mesh *const *bone;
    int32_t n_bone;
    const sn_tri_mesh *skin; /* NULL: none */
    const sn_picture_curve *curve;
    int32_t n_curve;
    const sn_picture_line *fiber; /* about 80 bytes per point go to OpenGL */
    int32_t n_fiber;
    const sn_picture_arrow *arrow; /* 14 kB each */
    int32_t n_arrow;
    const float *const *tendon; /* NULL: none; per muscle (n_tissue - 1) NULL or n_vert values: the muscle is
                                   tendon where the value, linear in each tet, is above 0 */
    double unit; /* a length of the scene (box diagonal) that widths of lines and shadows follow; 0: from what
                    is there */
    sn_picture_stamps stamp;
} sn_picture_scene;

typedef struct sn_picture_options {
    sn_camera camera;
    int32_t width, height;
    bool show_muscles, show_bones, show_skin, show_curves, show_points, show_fibers, show_frames;
    bool has_clip; /* removes what lies on the side the normal points to; the cut shows the tissues */
    sn_vec3 clip_point, clip_normal;
    float background[4]; /* RGBA, straight alpha, 0..1 */
    double skin_opacity; /* 0..1, of the skin seen face on */
    int32_t samples;     /* anti-aliasing: samples per pixel side, 1..4; 0: 2 */
    sn_renderer renderer;
} sn_picture_options;

typedef struct sn_picture_stats {
    int64_t tets_sent; /* of all tets, those in which a muscle's surface is */
    double seconds;
    char renderer[160];
    bool is_blank; /* every pixel is the background */
} sn_picture_stats;

/* Draws into *out (init-ed; empty on error). The same input on the same machine gives the same pixels, with
 * any number of threads. Large pictures are drawn in tiles, memory stays bounded. stats: NULL to skip. The
 * tets must be valid (sn_tet_mesh_validate). Errors: SN_EINVAL (size, camera, an option out of range, a field
 * value that is not finite: names it), SN_ERENDER (context, shader: with GL's log), SN_ENOMEM, SN_ECANCEL,
 * SN_ELIMIT. */
SN_MUST_USE sn_status sn_picture_draw(const sn_picture_scene *s, const sn_picture_options *opt,
                                      const sn_run *run, sn_image *out, sn_picture_stats *stats,
                                      sn_error *err);

#endif
