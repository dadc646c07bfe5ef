/* spread.h - displacements wanted at some vertices of a surface, spread smoothly over all of it. */
#ifndef SN_SKELETON_SPREAD_H
#define SN_SKELETON_SPREAD_H

#include "base/run.h"
#include "mesh/tri_mesh.h"

typedef struct sn_spread sn_spread; /* opaque; made for one surface, whose shape is kept */

/* m: valid. Faces without area do not connect their corners. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_spread_create(sn_spread **out, const sn_tri_mesh *m, sn_error *err);
void sn_spread_destroy(sn_spread *s);      /* NULL is fine */
double sn_spread_edge(const sn_spread *s); /* mean length of the edges */

/* u (n_vert x 3) minimises the sum over the surface of weight |u - wish|^2 + range^2 |grad u|^2: where the
 * weight is 1 and the wish 0, u fades as exp(-distance / range). Never longer than the longest wish.
 * Conjugate gradients, in a fixed order. weight: n_vert, > 0. u holds the start, such as 0. */
void sn_spread_apply(sn_spread *s, const double *wish, const double *weight, double range, const sn_run *run,
                     double *u);

#endif
