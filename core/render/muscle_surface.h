/* muscle_surface.h - the surfaces of the muscles as triangles that share vertices.
 *
 * They are exact: all fields are linear inside a tet, so muscle i shows in it where g_i = f_i - f_fat is 0
 * and no other g is above 0, which is a convex polygon [A 3.6]. Where a muscle reaches the border of the tet
 * mesh, the border is its surface: the part of each face on which its g is above 0 and the largest. Needs no
 * OpenGL and does not depend on where the picture is taken from. */
#ifndef SN_RENDER_MUSCLE_SURFACE_H
#define SN_RENDER_MUSCLE_SURFACE_H

#include "render/muscle_tets.h"

typedef struct sn_surface_vertex { /* as it is sent: 24 bytes */
    float place[3];                /* counted from the origin            */
    int16_t normal[3]; /* out of the muscle, of length 32767 or (between vertices of the mesh) less */
    uint16_t kind;     /* see shaders.c                      */
    uint8_t color[4];  /* sRGB and gloss                     */
} sn_surface_vertex;

typedef struct sn_muscle_surface {
    sn_surface_vertex *vert; /* owned */
    float *tendon;           /* n_vert, above 0: tendon; NULL when the scene has none; owned       */
    uint32_t *index;         /* 3 per triangle, counter-clockwise seen from outside; owned         */
    size_t n_vert, n_index;
} sn_muscle_surface;

/* The border of the tet mesh with its normals: does not depend on the fields. */
typedef struct sn_muscle_border {
    int32_t *vert;   /* 3 per face, of the tet mesh; owned        */
    int16_t *normal; /* 9 per face, smooth within 50 degrees; owned */
    int32_t n_face;
} sn_muscle_border;

/* b is zeroed. Errors: SN_EINVAL (three tets share a face), SN_ENOMEM. */
SN_MUST_USE sn_status sn_muscle_border_find(sn_muscle_border *b, const sn_tet_mesh *mesh, const sn_run *run,
                                            sn_error *err);
void sn_muscle_border_free(sn_muscle_border *b);

/* out is zeroed. m: of the scene's fields. Errors: SN_ENOMEM, SN_ELIMIT (2^32 corners or more). */
SN_MUST_USE sn_status sn_muscle_surface_make(sn_muscle_surface *out, const sn_picture_scene *s,
                                             const sn_muscle_tets *m, const sn_muscle_border *b,
                                             sn_vec3 origin, const sn_run *run, sn_error *err);
void sn_muscle_surface_free(sn_muscle_surface *s);

#endif
