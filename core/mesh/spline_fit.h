/* spline_fit.h - the spline with few control points that lies nearest to a path, by least squares [A 3.2]. */
#ifndef SN_MESH_SPLINE_FIT_H
#define SN_MESH_SPLINE_FIT_H

#include "mesh/spline.h"

#define SN_SPLINE_FIT_MAX_POINTS 32

typedef struct sn_spline_fit { /* what is fitted; open, all borrowed */
    const double *path;        /* n x 3, finite, neighbours may be equal                          */
    const double *weight;      /* n, >= 0; NULL: all 1                                            */
    const double *fraction; /* n, ascending 0..1: where along the curve, by length, each point belongs; NULL:
                               as along the path itself                                         */
    int32_t n;              /* 2 or more                                                       */
} sn_spline_fit;

typedef struct sn_spline_fit_report {
    double rms, max; /* distance of the path's points from the curve */
} sn_spline_fit_report;

/* Control points (k x 3) of the centripetal spline that starts and ends at the path's ends and otherwise
 * minimises sum of weight * |path - curve(fraction)|^2, fraction by length along both. Found by damped
 * Gauss-Newton from points evenly spaced along the path: a local minimum. k = 2: the straight line. report:
 * NULL to skip. Errors: SN_EINVAL (k not in 2..SN_SPLINE_FIT_MAX_POINTS, fewer than two points, a path
 * without length or with equal ends), SN_ENOMEM; point is then not usable. */
SN_MUST_USE sn_status sn_spline_fit_points(const sn_spline_fit *fit, double *point, int32_t k,
                                           sn_spline_fit_report *report, sn_error *err);

/* Distance of the path's points from the spline through these k control points. */
SN_MUST_USE sn_status sn_spline_fit_distance(const sn_spline_fit *fit, const double *point, int32_t k,
                                             sn_spline_fit_report *report, sn_error *err);

/* The points of the spline at these fractions (ascending 0..1) of its length; out: n x 3. */
SN_MUST_USE sn_status sn_spline_at_fractions(const sn_spline *s, const double *fraction, int32_t n,
                                             double *out, sn_error *err);

#endif
