/* muscle_polygons.h - the pieces of muscle_surface.h before they are joined: convex polygons in tets and on
 * faces of the border. Internal to core/render. */
#ifndef SN_RENDER_MUSCLE_POLYGONS_H
#define SN_RENDER_MUSCLE_POLYGONS_H

#include "render/muscle_surface.h"

typedef struct sn_corner { /* of a polygon */
    int32_t a, b;          /* on the edge a-b of the tet mesh, a < b; at vertex a = b; a < 0: in no edge, the
                              block's own vertex number b */
    int32_t muscle;
    int16_t normal[3]; /* at a vertex; 0 else */
} sn_corner;

typedef struct sn_polygons { /* of one block of tets or faces, in their order */
    sn_corner *corner;
    int32_t *size; /* corners of each polygon */
    sn_surface_vertex *own;
    float *own_tendon; /* as many; not used without tendons */
    size_t n_corner, n_polygon, n_own, cap_corner, cap_polygon, cap_own, cap_tendon;
} sn_polygons;

typedef struct sn_polygon_scratch { /* of one thread */
    int32_t *muscle;
    double *value; /* room for 4 values of each muscle */
    struct sn_bary *corner, *next;
} sn_polygon_scratch;

bool sn_polygon_scratch_init(sn_polygon_scratch *w, int32_t n_tissue); /* false: no memory */
void sn_polygon_scratch_free(sn_polygon_scratch *w);
void sn_polygons_free(sn_polygons *p);

/* Adds the polygons of tet i_sent of m, or of face i_face of b. false: no memory. */
bool sn_polygons_add_tet(sn_polygons *p, const sn_picture_scene *s, const sn_muscle_tets *m, int32_t i_sent,
                         sn_vec3 origin, sn_polygon_scratch *w);
bool sn_polygons_add_face(sn_polygons *p, const sn_picture_scene *s, const sn_muscle_tets *m,
                          const sn_muscle_border *b, int32_t i_face, sn_vec3 origin, sn_polygon_scratch *w);
/* The vertex that a corner stands for; its block's own ones are made already. */
sn_surface_vertex sn_corner_vertex(const sn_corner *c, const sn_picture_scene *s, const sn_muscle_tets *m,
                                   sn_vec3 origin, float *tendon);

#endif
