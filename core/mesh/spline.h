/* spline.h - centripetal Catmull-Rom splines through control points [A 3.2].
 *
 * Centripetal (knots spaced by the square root of the chord): no loops or cusps inside a span, however uneven
 * the points (Yuksel et al. 2011). The end tangents come from a reflected extra point. Two points give the
 * straight line. */
#ifndef SN_MESH_SPLINE_H
#define SN_MESH_SPLINE_H

#include "base/status.h"
#include "mesh/cubic.h"

#include <stdint.h>

typedef struct sn_spline { /* open */
    sn_cubic *seg;         /* n_seg = points - 1, owned                              */
    double *arc;           /* n_seg + 1: length up to each control point, owned      */
    int32_t n_seg;
} sn_spline;

/* point: n x 3, n >= 2, finite, neighbours distinct. s: zero-initialised or filled. Errors: SN_EINVAL (names
 * the point, counted from 1), SN_ENOMEM. */
SN_MUST_USE sn_status sn_spline_build(sn_spline *s, const double *point, int32_t n, sn_error *err);
void sn_spline_free(sn_spline *s);
double sn_spline_length(const sn_spline *s);
/* The segment and parameter at arc length a (clamped to 0..length). */
void sn_spline_at(const sn_spline *s, double a, int32_t *i_seg, double *t);
/* The other way round: the length up to parameter t of segment i_seg. */
double sn_spline_arc(const sn_spline *s, int32_t i_seg, double t);
/* The unit tangent there, from origin to insertion. Where the derivative vanishes, that of the chord. */
sn_vec3 sn_spline_tangent(const sn_spline *s, double a);
/* n >= 2 points evenly spaced by arc length, both ends included. out: n x 3. */
void sn_spline_sample(const sn_spline *s, int32_t n, double *out);

#endif
