/* measure.h - exact sizes of the regions in which a tissue wins: volumes in tets, areas on boundary faces.
 *
 * The fields are linear in a tet, so tissue i wins there in a convex polyhedron: the tet clipped by the
 * planes f_i = f_j. No extraction is needed. Exact up to rounding; where two functions are equal all over a
 * tet or face the lower tissue has it. Sums go over fixed runs of tets in a fixed order: the same for any
 * number of threads. */
#ifndef SN_FIELD_MEASURE_H
#define SN_FIELD_MEASURE_H

#include "base/run.h"
#include "tetra/body.h"

typedef struct sn_measure sn_measure; /* opaque; const = may be read by many */

/* Prepares for one tissue. mesh, field (n_tissue x n_vert): borrowed, must not change. The tissue's own row
 * is taken times `scale` in all questions below. Errors: SN_ENOMEM. O(n_vert n_tissue). */
SN_MUST_USE sn_status sn_measure_create(sn_measure **out, const sn_tet_mesh *mesh, const double *field,
                                        int32_t n_tissue, int32_t tissue, const sn_run *run, sn_error *err);
void sn_measure_destroy(sn_measure *m); /* NULL is fine */

/* Of all tets. */
double sn_measure_volume(const sn_measure *m, double scale, const sn_run *run);
/* The share of one tet that the tissue wins, 0..1. */
double sn_measure_tet_share(const sn_measure *m, int32_t i_tet, double scale);
/* The area of face k of a tet that it wins, and the centroid of that part (when the area is > 0). */
double sn_measure_face_area(const sn_measure *m, int32_t i_tet, int k, double scale, sn_vec3 *centroid);

/* The scale that gives `volume`, to 1e-7 of it. Errors: SN_EINVAL: no scale does; the message says what is
 * possible and is to be prefixed with the muscle's name. SN_ECANCEL. */
SN_MUST_USE sn_status sn_measure_find_scale(const sn_measure *m, double volume, const sn_run *run,
                                            double *scale, sn_error *err);

#endif
