/* draw.h - what the passes of a picture share. Internal to core/render.
 *
 * A pass keeps what it has sent. Its `_update` compares the key of what is kept with that of what is asked
 * for and sends anew when they differ; `_draw` is then the same as right after the first sending. Nothing
 * that is kept depends on the camera: places count from the scene's origin. */
#ifndef SN_RENDER_DRAW_H
#define SN_RENDER_DRAW_H

#include "render/gl.h"
#include "render/painter.h"
#include "render/srgb.h"

#include <stdbool.h>

enum { sn_tile_side = 2048 }; /* samples per side of the framebuffer: bounds memory at about 300 MB */

typedef struct sn_tile { /* of the picture's samples, x right and y UP from the lower left corner */
    int x, y, width, height;
} sn_tile;

typedef struct sn_pixels { /* x0 <= x < x1, y0 <= y < y1, rows from the top */
    int x0, x1, y0, y1;
} sn_pixels;

typedef struct sn_frame {
    sn_gl gl;
    const sn_picture_scene *scene; /* borrowed */
    const sn_picture_options *opt; /* borrowed */
    const sn_run *run;
    int samples;                  /* per pixel side */
    int width, height;            /* of the picture, samples */
    double unit;                  /* a length of the scene, > 0 */
    sn_vec3 origin;               /* the middle of the scene; does not depend on the camera */
    sn_vec3 eye, right, up, back; /* the view's axes */
    sn_vec3
        plane_normal; /* unit; places counted from the eye are removed where normal.p + plane_offset > 0 */
    double plane_offset;
    bool has_section;     /* the eye is on the removed side and sees the cut */
    sn_pixels part;       /* of the picture: pixels outside show the background */
    sn_pixels solid_part; /* of that: outside only skin and lines are seen      */
    sn_tile tile;
    float clip[16]; /* for the tile, column-major */
    float depth[2]; /* normalized depth = depth[0] + depth[1] / distance */
    float slope;    /* width of a sample at distance 1 */
} sn_frame;

/* Fills what is known before a context is there. Errors: SN_EINVAL (camera, size, samples, plane). */
SN_MUST_USE sn_status sn_frame_init(sn_frame *f, const sn_picture_scene *s, const sn_picture_options *opt,
                                    const sn_run *run, sn_error *err);
/* Finds the parts. muscles: a box around those that are shown, or around all tets. */
void sn_frame_set_parts(sn_frame *f, sn_box3 muscles);
void sn_frame_set_tile(sn_frame *f, sn_tile tile);
/* Makes the program current and sets the uniforms that all vertex shaders know. */
void sn_frame_use(const sn_frame *f, GLuint program);
/* Place counted from the origin, in single precision. */
static inline void sn_frame_place(const sn_frame *f, sn_vec3 p, float out[3])
{
    out[0] = (float)(p.x - f->origin.x);
    out[1] = (float)(p.y - f->origin.y);
    out[2] = (float)(p.z - f->origin.z);
}
/* A colour in one number of a vertex: 65536 r + 256 g + b in bytes, which a float holds exactly. */
static inline float sn_color_pack(sn_rgb c)
{
    const float in[3] = {c.r, c.g, c.b};
    float sum = 0.0f;
    for (int k = 0; k < 3; k++) sum = 256.0f * sum + floorf(255.0f * fminf(fmaxf(in[k], 0.0f), 1.0f) + 0.5f);
    return sum;
}
static inline void sn_color_linear(sn_rgb c, float out[3])
{
    out[0] = sn_srgb_to_linear(c.r);
    out[1] = sn_srgb_to_linear(c.g);
    out[2] = sn_srgb_to_linear(c.b);
}
/* > 0 on the side that the clip plane removes. */
static inline double sn_frame_removed(const sn_frame *f, sn_vec3 p)
{
    return sn_v3_dot(f->plane_normal, sn_v3_sub(p, f->opt->clip_point));
}

/* ---- what is kept ---- */

typedef struct sn_key { /* of what a pass has sent; all bytes count */
    uint64_t stamp[2];  /* of its sources; 0: never the same */
    int64_t count[3];   /* and how many there are, what of them is shown */
    sn_vec3 origin;
    double unit;
} sn_key;
/* The origin and unit are the frame's. */
sn_key sn_frame_key(const sn_frame *f, uint64_t stamp0, uint64_t stamp1);
bool sn_key_same(const sn_key *a, const sn_key *b);

typedef struct sn_clip_key {
    bool has_section;
    sn_vec3 point, normal; /* 0 without a section */
} sn_clip_key;
sn_clip_key sn_frame_clip_key(const sn_frame *f);
bool sn_clip_key_same(const sn_clip_key *a, const sn_clip_key *b);

typedef struct sn_mesh_list {
    sn_gl_mesh *mesh; /* owned */
    int n, cap;
} sn_mesh_list;
/* Room for n meshes, none yet. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_mesh_list_reserve(sn_mesh_list *l, int n, sn_error *err);
void sn_mesh_list_clear(sn_mesh_list *l, const sn_gl *gl); /* gl NULL: the context is gone or goes */

/* All passes are zeroed to begin with. _update: errors as sn_painter_draw; nothing is kept then. _free: with
 * the context, or after it. */

/* ---- muscles: picture_muscles.c (surfaces), picture_cuts.c (the section) ---- */

struct sn_muscle_kept;
typedef struct sn_muscle_pass {
    GLuint program, cut_program;
    sn_gl_mesh surface;
    GLuint tendon;                     /* a buffer of surface.array */
    struct sn_muscle_section *section; /* n_section, owned */
    sn_gl_texels color;
    int n_section;
    struct sn_muscle_kept *kept; /* owned: which tets, the border */
    sn_key key;
    sn_clip_key clip;
    int64_t n_sent;
    sn_box3 bounds; /* of the surfaces */
} sn_muscle_pass;
SN_MUST_USE sn_status sn_muscle_pass_update(sn_muscle_pass *p, const sn_frame *f, sn_error *err);
void sn_muscle_pass_draw(const sn_muscle_pass *p, const sn_frame *f);
void sn_muscle_pass_free(sn_muscle_pass *p);

/* Tells the current program the tendons' colour. */
void sn_muscle_use_tendon(const sn_frame *f, GLuint program);

struct sn_muscle_tets;
/* The pieces of the clip plane, once for each plane and fields. */
SN_MUST_USE sn_status sn_cut_update(sn_muscle_pass *p, const sn_frame *f, const struct sn_muscle_tets *m,
                                    sn_error *err);
void sn_cut_clear(sn_muscle_pass *p, const sn_gl *gl);
void sn_cut_draw(const sn_muscle_pass *p, const sn_frame *f);

/* ---- bones and skin: picture_surfaces.c ---- */

typedef struct sn_surface_pass {
    GLuint solid_program, skin_program;
    sn_mesh_list bone,
        cap;         /* cap: squares in the clip plane around the bones' cuts, one per bone, maybe empty */
    bool *is_closed; /* per bone, owned */
    sn_gl_mesh skin;
    sn_key bone_key, skin_key;
    sn_clip_key clip;
} sn_surface_pass;
SN_MUST_USE sn_status sn_surface_pass_update(sn_surface_pass *p, const sn_frame *f, sn_error *err);
void sn_surface_pass_bones(const sn_surface_pass *p, const sn_frame *f);
void sn_surface_pass_skin(const sn_surface_pass *p, const sn_frame *f);
void sn_surface_pass_free(sn_surface_pass *p);

/* One unit normal per corner: the mean, weighted by angle, of the faces around the corner's vertex that turn
 * from this face by less than crease_deg. out: 9 n_face. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_corner_normals(const sn_tri_mesh *m, double crease_deg, const sn_run *run,
                                        float *out, sn_error *err);

/* ---- curves: picture_lines.c ---- */

typedef struct sn_line_pass {
    GLuint program;
    sn_mesh_list tube, balls; /* one per curve, maybe empty */
    sn_key key;
} sn_line_pass;
SN_MUST_USE sn_status sn_line_pass_update(sn_line_pass *p, const sn_frame *f, sn_error *err);
void sn_line_pass_draw(const sn_line_pass *p, const sn_frame *f);
void sn_line_pass_free(sn_line_pass *p);

/* ---- fibers: picture_fibers.c; arrows: picture_arrows.c ---- */

typedef struct sn_fiber_pass {
    GLuint solid_program, line_program;
    sn_mesh_list batch;
    sn_key key;
} sn_fiber_pass;
/* Are fibers drawn with the solid things (no muscles are), or in the layer of the curves? */
bool sn_fibers_are_solid(const sn_frame *f);
SN_MUST_USE sn_status sn_fiber_pass_update(sn_fiber_pass *p, const sn_frame *f, sn_error *err);
void sn_fiber_pass_draw(const sn_fiber_pass *p, const sn_frame *f);
void sn_fiber_pass_free(sn_fiber_pass *p);

typedef struct sn_arrow_pass {
    GLuint program;
    sn_mesh_list batch;
    sn_key key;
} sn_arrow_pass;
SN_MUST_USE sn_status sn_arrow_pass_update(sn_arrow_pass *p, const sn_frame *f, sn_error *err);
void sn_arrow_pass_draw(const sn_arrow_pass *p, const sn_frame *f);
void sn_arrow_pass_free(sn_arrow_pass *p);

/* ---- putting together: picture_target.c (framebuffers, light), picture_resolve.c (samples to pixels) ----
 */

typedef struct sn_targets {
    GLuint color, shape, depth, skin_sum, skin_weight, line, line_depth, open, picture;
    GLuint solid_frame, skin_frame, line_frame, open_frame, picture_frame;
    GLuint occlusion_program, final_program, rest_program, screen;
    int width, height; /* 0: there are none */
    bool has_skin, has_lines;
} sn_targets;
/* Makes framebuffers of this size, with those for skin and lines as the flags say, unless there are such. */
SN_MUST_USE sn_status sn_targets_update(sn_targets *t, const sn_frame *f, int width, int height,
                                        bool has_skin, bool has_lines, sn_error *err);
void sn_targets_clear(sn_targets *t, const sn_gl *gl);                       /* the programs stay */
void sn_targets_begin(const sn_targets *t, const sn_frame *f, GLuint frame); /* binds and clears */
void sn_targets_occlusion(const sn_targets *t, const sn_frame *f);
void sn_targets_final(const sn_targets *t, const sn_frame *f);

/* Weighs the samples of these pixels into out. samples: the tile's, linear premultiplied RGBA in half
 * floats, rows from the bottom. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_resolve(const sn_frame *f, const uint16_t *samples, sn_pixels px, sn_image *out,
                                 sn_error *err);
/* The 8-bit pixel of the background alone. */
void sn_background_pixel(const float background[4], uint8_t out[4]);

/* sn_painter_draw with a framebuffer of tile_side samples (at least 768). */
SN_MUST_USE sn_status sn_painter_draw_tiled(sn_painter *p, const sn_picture_scene *s,
                                            const sn_picture_options *opt, int tile_side, const sn_run *run,
                                            sn_image *out, sn_picture_stats *stats, sn_error *err);

#endif
