/* remesh_private.h - the pieces of the remesher: a half-edge mesh that can be edited, a grid that finds what
 * is near. */
#ifndef SN_MESH_REMESH_PRIVATE_H
#define SN_MESH_REMESH_PRIVATE_H

#include "mesh/bvh.h"
#include "mesh/remesh.h"

#include <stdbool.h>

/* Triangle t owns the half-edges 3t, 3t+1, 3t+2; half-edge h runs from vert[h] to vert[next(h)]. Dead
 * triangles have vert[3t] < 0. Every edge has two half-edges: the surface is closed. */
typedef struct rm_mesh {
    sn_vec3 *pos;
    int32_t *out; /* per vertex: a half-edge that leaves it; -1 when the vertex is gone */
    size_t n_vert, cap_vert, cap_out;
    int32_t *vert, *twin;
    bool *crease;   /* per half-edge, both sides alike: a label border or a sharp edge of the input */
    int32_t *label; /* per triangle */
    size_t n_tri, cap_vertid, cap_twin, cap_crease, cap_label;
} rm_mesh;

static inline int32_t rm_next(int32_t h)
{
    return h % 3 == 2 ? h - 2 : h + 1;
}
static inline int32_t rm_prev(int32_t h)
{
    return h % 3 == 0 ? h + 2 : h - 1;
}
static inline bool rm_alive(const rm_mesh *m, int32_t t)
{
    return m->vert[3 * (size_t)t] >= 0;
}
/* The next half-edge that leaves the same vertex. */
static inline int32_t rm_spin(const rm_mesh *m, int32_t h)
{
    return m->twin[rm_prev(h)];
}

/* Creases: label borders, and edges bent by more than crease_cos between two triangles higher than
 * min_height. */
SN_MUST_USE sn_status rm_mesh_build(rm_mesh *m, const sn_tri_mesh *in, double crease_cos, double min_height,
                                    sn_error *err);
void rm_mesh_free(rm_mesh *m);
SN_MUST_USE sn_status rm_mesh_export(const rm_mesh *m, bool has_labels, sn_tri_mesh *out, sn_error *err);
/* Room for one more vertex and two more triangles. */
bool rm_mesh_room(rm_mesh *m);
/* The new vertex at p on h's edge; needs rm_mesh_room. */
int32_t rm_split(rm_mesh *m, int32_t h, sn_vec3 p);
/* Moves h's first vertex into its second; the caller has checked rm_can_collapse. */
void rm_collapse(rm_mesh *m, int32_t h);
bool rm_can_collapse(const rm_mesh *m, int32_t h); /* the link condition: the result is manifold */
void rm_flip(rm_mesh *m, int32_t h);               /* turns h's edge to join the two opposite corners */
bool rm_can_flip(const rm_mesh *m, int32_t h);
int rm_crease_count(const rm_mesh *m, int32_t v); /* crease edges at v */

/* A hash of grid cells to the triangles whose boxes meet them. */
typedef struct rm_grid {
    double cell;
    sn_vec3 origin;
    int32_t *head; /* n_head (a power of two), into the links, -1 */
    size_t n_head;
    struct rm_link {
        int32_t tri, next;
        int32_t cx, cy, cz;
    } * link;
    size_t n_link, cap_link;
    int32_t free_link;
} rm_grid;

SN_MUST_USE sn_status rm_grid_build(rm_grid *g, const rm_mesh *m, double cell, sn_error *err);
void rm_grid_free(rm_grid *g);
bool rm_grid_add(rm_grid *g, const rm_mesh *m, int32_t t); /* false: no memory */
void rm_grid_remove(rm_grid *g, const rm_mesh *m,
                    int32_t t); /* with the same corner positions as when added */
/* Whether the triangle crosses a living triangle that is not in skip (sorted or not, n_skip short). */
bool rm_grid_crosses(const rm_grid *g, const rm_mesh *m, const sn_vec3 p[3], const int32_t id[3],
                     const int32_t *skip, int n_skip);

#endif
