/* draw.h - what the passes of one picture share. Internal to core/render. */
#ifndef SN_RENDER_DRAW_H
#define SN_RENDER_DRAW_H

#include "render/gl.h"
#include "render/picture.h"

#include <stdbool.h>

enum { sn_tile_side = 2048 }; /* samples per side of the framebuffer: bounds memory at about 300 MB */

typedef struct sn_tile { /* of the picture's samples, x right and y UP from the lower left corner */
    int x, y, width, height;
} sn_tile;

typedef struct sn_frame {
    sn_gl gl;
    const sn_picture_scene *scene; /* borrowed */
    const sn_picture_options *opt; /* borrowed */
    const sn_run *run;
    int samples;                  /* per pixel side */
    int width, height;            /* of the picture, samples */
    double unit;                  /* a length of the scene, > 0 */
    sn_vec3 eye, right, up, back; /* the view's axes */
    sn_vec3
        plane_normal; /* unit; places are counted from the eye: removed where normal.p + plane_offset > 0 */
    double plane_offset;
    bool has_section; /* the eye is on the removed side and sees the cut */
    sn_tile tile;
    float clip[16]; /* for the tile, column-major */
    float depth[2]; /* normalized depth = depth[0] + depth[1] / distance */
    float slope;    /* width of a sample at distance 1 */
} sn_frame;

/* Fills what is known before a context is there. Errors: SN_EINVAL (camera, size, samples, plane). */
SN_MUST_USE sn_status sn_frame_init(sn_frame *f, const sn_picture_scene *s, const sn_picture_options *opt,
                                    const sn_run *run, sn_error *err);
void sn_frame_set_tile(sn_frame *f, sn_tile tile);
/* Makes the program current and sets the uniforms that all vertex shaders know. */
void sn_frame_use(const sn_frame *f, GLuint program);
/* Place counted from the eye, in single precision. */
static inline void sn_frame_place(const sn_frame *f, sn_vec3 p, float out[3])
{
    out[0] = (float)(p.x - f->eye.x);
    out[1] = (float)(p.y - f->eye.y);
    out[2] = (float)(p.z - f->eye.z);
}
/* A colour in one number of a vertex: 65536 r + 256 g + b in bytes, which a float holds exactly. */
static inline float sn_color_pack(sn_rgb c)
{
    const float in[3] = {c.r, c.g, c.b};
    float sum = 0.0f;
    for (int k = 0; k < 3; k++) sum = 256.0f * sum + floorf(255.0f * fminf(fmaxf(in[k], 0.0f), 1.0f) + 0.5f);
    return sum;
}
/* > 0 on the side that the clip plane removes. */
static inline double sn_frame_removed(const sn_frame *f, sn_vec3 p)
{
    return sn_v3_dot(f->plane_normal, sn_v3_sub(p, f->eye)) + f->plane_offset;
}

/* ---- muscles: picture_muscles.c (tets), picture_cuts.c (the domain's border, the section) ---- */

typedef struct sn_tet_batch {
    GLuint array, tet, cand; /* vertex array, buffer textures */
    GLsizei n_index;
} sn_tet_batch;
typedef struct sn_cut_batch {
    GLuint array, face, cand;
    GLsizei n_vert;
} sn_cut_batch;
typedef struct sn_muscle_pass {
    GLuint tet_program, cut_program, color;
    sn_tet_batch *tets;             /* owned */
    sn_cut_batch *border, *section; /* owned */
    int n_tets, n_border, n_section;
    int64_t n_sent;
} sn_muscle_pass;
/* p is zeroed. Errors as sn_picture_draw; free p in any case. */
SN_MUST_USE sn_status sn_muscle_pass_prepare(sn_muscle_pass *p, const sn_frame *f, sn_error *err);
void sn_muscle_pass_draw(const sn_muscle_pass *p, const sn_frame *f);
void sn_muscle_pass_free(sn_muscle_pass *p);

/* Tells the current program how many texels a candidate has (one more when the scene has tendons) and the
 * tendons' colour. */
void sn_muscle_use_tendon(const sn_frame *f, GLuint program, int texels);

struct sn_muscle_tets;
SN_MUST_USE sn_status sn_cut_border(sn_muscle_pass *p, const sn_frame *f, const struct sn_muscle_tets *m,
                                    int32_t max_texels, sn_error *err);
SN_MUST_USE sn_status sn_cut_section(sn_muscle_pass *p, const sn_frame *f, const struct sn_muscle_tets *m,
                                     int32_t max_texels, sn_error *err);
void sn_cut_draw(const sn_muscle_pass *p, const sn_frame *f);

/* ---- bones and skin: picture_surfaces.c ---- */

typedef struct sn_solid {
    GLuint array, cap; /* cap: a square in the clip plane around the bone's cut; 0: none */
    GLsizei n_vert;
} sn_solid;
typedef struct sn_surface_pass {
    GLuint solid_program, skin_program;
    sn_solid *bone; /* owned */
    sn_solid skin;
    int n_bone;
} sn_surface_pass;
SN_MUST_USE sn_status sn_surface_pass_prepare(sn_surface_pass *p, const sn_frame *f, sn_error *err);
void sn_surface_pass_bones(const sn_surface_pass *p, const sn_frame *f);
void sn_surface_pass_skin(const sn_surface_pass *p, const sn_frame *f);
void sn_surface_pass_free(sn_surface_pass *p);

/* One unit normal per corner: the mean, weighted by angle, of the faces around the corner's vertex that turn
 * from this face by less than crease_deg. out: 9 n_face. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_corner_normals(const sn_tri_mesh *m, double crease_deg, const sn_run *run,
                                        float *out, sn_error *err);

/* ---- curves: picture_lines.c ---- */

typedef struct sn_line {
    GLuint tube, balls;
    GLsizei n_tube, n_balls; /* vertices */
} sn_line;
typedef struct sn_line_pass {
    GLuint program;
    sn_line *line; /* owned */
    int n_line;
} sn_line_pass;
SN_MUST_USE sn_status sn_line_pass_prepare(sn_line_pass *p, const sn_frame *f, sn_error *err);
void sn_line_pass_draw(const sn_line_pass *p, const sn_frame *f);
void sn_line_pass_free(sn_line_pass *p);

/* ---- fibers: picture_fibers.c; arrows: picture_arrows.c ---- */

typedef struct sn_vertex_batch {
    GLuint array;
    GLsizei n_vert;
} sn_vertex_batch;
typedef struct sn_fiber_pass {
    GLuint program;
    sn_vertex_batch *batch; /* owned */
    int n_batch;
    bool is_solid; /* drawn with the solid things (no muscles are), else in the layer of the curves */
} sn_fiber_pass;
SN_MUST_USE sn_status sn_fiber_pass_prepare(sn_fiber_pass *p, const sn_frame *f, sn_error *err);
void sn_fiber_pass_draw(const sn_fiber_pass *p, const sn_frame *f);
void sn_fiber_pass_free(sn_fiber_pass *p);

typedef struct sn_arrow_pass {
    GLuint program;
    sn_vertex_batch *batch; /* owned */
    int n_batch;
} sn_arrow_pass;
SN_MUST_USE sn_status sn_arrow_pass_prepare(sn_arrow_pass *p, const sn_frame *f, sn_error *err);
void sn_arrow_pass_draw(const sn_arrow_pass *p, const sn_frame *f);
void sn_arrow_pass_free(sn_arrow_pass *p);

/* ---- putting together: picture_target.c (framebuffers, light), picture_resolve.c (samples to pixels) ----
 */

typedef struct sn_targets {
    GLuint color, shape, depth, skin_sum, skin_weight, line, line_depth, open, picture;
    GLuint solid_frame, skin_frame, line_frame, open_frame, picture_frame;
    GLuint occlusion_program, final_program, screen;
    bool has_skin, has_lines;
} sn_targets;
SN_MUST_USE sn_status sn_targets_create(sn_targets *t, const sn_frame *f, int width, int height,
                                        sn_error *err);
void sn_targets_begin(const sn_targets *t, const sn_frame *f, GLuint frame); /* binds and clears */
void sn_targets_occlusion(const sn_targets *t, const sn_frame *f);
void sn_targets_final(const sn_targets *t, const sn_frame *f);

/* Weighs the samples of pixels x0 <= x < x1, y0 <= y < y1 (rows from the top) into out. samples: the tile's,
 * linear premultiplied RGBA, rows from the bottom. */
typedef struct sn_pixels {
    int x0, x1, y0, y1;
} sn_pixels;
void sn_resolve(const sn_frame *f, const float *samples, sn_pixels px, sn_image *out);
/* The 8-bit pixel of the background alone. */
void sn_background_pixel(const float background[4], uint8_t out[4]);

/* sn_picture_draw with a framebuffer of tile_side samples (at least 768). */
SN_MUST_USE sn_status sn_picture_draw_tiled(const sn_picture_scene *s, const sn_picture_options *opt,
                                            int tile_side, const sn_run *run, sn_image *out,
                                            sn_picture_stats *stats, sn_error *err);

#endif
