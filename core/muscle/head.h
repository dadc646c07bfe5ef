/* head.h - one head of a muscle: a curve through control points with a tissue value at each [A 3.2].
 * Points in the scene's unit; the first is the origin, the last the insertion. Messages name points counted
 * from 1; the muscle puts its own name before them. */
#ifndef SN_MUSCLE_HEAD_H
#define SN_MUSCLE_HEAD_H

#include "mesh/spline.h"

typedef struct sn_head { /* open: read freely, change through the functions below */
    double *point;       /* n_point x 3, owned                   */
    double *tissue;      /* n_point, each finite and > 0, owned  */
    int32_t n_point;
    sn_spline spline; /* always that of the points            */
} sn_head;

typedef struct sn_head_points { /* what a head is made of; borrowed */
    const double *point;        /* n x 3                            */
    const double *tissue;       /* n, or NULL for 1 everywhere      */
    int32_t n;
} sn_head_points;

/* h: zero-initialised; zero again on error. Errors: SN_EINVAL (fewer than 2 points, equal neighbours, a value
 * that is not finite, a tissue that is not > 0: the message names the point), SN_ENOMEM. */
SN_MUST_USE sn_status sn_head_init(sn_head *h, const sn_head_points *from, sn_error *err);
SN_MUST_USE sn_status sn_head_copy(sn_head *out, const sn_head *h, sn_error *err); /* out as in _init */
void sn_head_free(sn_head *h);

/* i_point in [0, n_point). On error the head is unchanged. Errors: SN_EINVAL, SN_ENOMEM. */
SN_MUST_USE sn_status sn_head_set_point(sn_head *h, int32_t i_point, sn_vec3 p, sn_error *err);
/* Before i_point, in [0, n_point] (n_point appends). */
SN_MUST_USE sn_status sn_head_insert_point(sn_head *h, int32_t i_point, sn_vec3 p, double tissue,
                                           sn_error *err);
SN_MUST_USE sn_status sn_head_remove_point(sn_head *h, int32_t i_point, sn_error *err); /* 2 must stay */
/* i_point < 0: all points. */
SN_MUST_USE sn_status sn_head_set_tissue(sn_head *h, int32_t i_point, double value, sn_error *err);

/* The tissue value at a place of the curve: linear between control points in the segment's parameter. */
double sn_head_tissue_at(const sn_head *h, int32_t i_seg, double s);

#endif
