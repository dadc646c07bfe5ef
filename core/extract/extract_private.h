/* extract_private.h - the steps of sn_extract: grid -> cuts on edges and faces -> cells -> positions. */
#ifndef SN_EXTRACT_PRIVATE_H
#define SN_EXTRACT_PRIVATE_H

#include "extract/extraction.h"
#include "extract/signs.h"

/* ---- grid.c: integer values, winners ---- */
typedef struct xt_grid {
    int32_t *value;  /* n_vert x n_tissue                                       */
    int32_t *winner; /* n_vert: the largest value's tissue, ties to the lower   */
    int32_t n_vert, n_tissue;
} xt_grid;
SN_MUST_USE sn_status xt_grid_build(xt_grid *g, const double *value, const char *const *name,
                                    int32_t n_tissue, int32_t n_vert, const sn_run *run, sn_error *err);
void xt_grid_free(xt_grid *g);
static inline const int32_t *xt_row(const xt_grid *g, int32_t v)
{
    return g->value + (size_t)v * (size_t)g->n_tissue;
}
/* Growable list of the tissues that may win somewhere in a simplex of n_corner (1..4) vertices: not below one
 * other tissue at all of them. Ascending ids. false: no memory. */
typedef struct xt_list {
    int32_t *id;
    size_t n, cap;
} xt_list;
bool xt_candidates(const xt_grid *g, const int32_t *corner, int n_corner, xt_list *out);

/* ---- cuts.c: points on edges and faces, found once for all tets around ---- */
typedef struct xt_cuts {
    /* Edges whose ends have different winners, by ascending ends. Points of edge e: edge_first[e] ..
     * edge_first[e+1]. */
    int32_t (*edge)[2];     /* n_edge: ends, the lower first                                              */
    int32_t *edge_first;    /* n_edge + 1                                                                 */
    int32_t (*edge_tie)[2]; /* n_edge_point: the tissues on the lower end's side and on the other         */
    int32_t n_edge, n_edge_point;
    /* Faces with points inside, by ascending corners. */
    int32_t (*face)[3];
    int32_t *face_first;
    int32_t (*face_tie)[3]; /* n_face_point: ascending tissues */
    int32_t n_face, n_face_point;
} xt_cuts;
SN_MUST_USE sn_status xt_cuts_build(xt_cuts *c, const sn_tet_mesh *m, const xt_grid *g, const sn_run *run,
                                    sn_error *err);
void xt_cuts_free(xt_cuts *c);
int32_t xt_find_edge(const xt_cuts *c, int32_t u, int32_t v);            /* any order; -1: not cut   */
int32_t xt_find_face(const xt_cuts *c, int32_t u, int32_t v, int32_t w); /* any order; -1: no points */

/* ---- cells.c: tets of all cells ---- */
/* Corner numbers of the result: mesh vertices, edge points, face points, then the points inside tets in tet
 * order. */
typedef struct xt_cells {
    int32_t *tet, *part, *source; /* n_tet x 4, n_tet, n_tet                                              */
    int32_t (*inner_tie)[4];      /* n_inner: ascending tissues of points inside tets                     */
    int32_t *inner_tet;           /* n_inner: their tet                                                   */
    size_t n_tet, n_inner;
} xt_cells;
SN_MUST_USE sn_status xt_cells_build(xt_cells *c, const sn_tet_mesh *m, const xt_grid *g, const xt_cuts *cuts,
                                     const sn_run *run, sn_error *err);
void xt_cells_free(xt_cells *c);

/* ---- positions.c ---- */
/* Places all corners; moves those that would make a tet flat or turn it. Fills out->mesh.pos, out->envelope
 * (from value: n_tissue x n_vert) and the counts. */
SN_MUST_USE sn_status xt_place(sn_extraction *out, const sn_tet_mesh *m, const xt_grid *g,
                               const xt_cuts *cuts, const xt_cells *cells, const double *value, double margin,
                               const sn_run *run, sn_error *err);

#endif
