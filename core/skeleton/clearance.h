/* clearance.h - how far bones stay inside the skin. */
#ifndef SN_SKELETON_CLEARANCE_H
#define SN_SKELETON_CLEARANCE_H

#include "base/run.h"
#include "mesh/bvh.h"

typedef struct sn_clearance {
    double least;   /* signed distance from the skin of the nearest vertex: < 0 outside of it      */
    sn_vec3 at;     /* that vertex                                                                 */
    int32_t n_out;  /* vertices outside of the skin                                                */
    int32_t n_near; /* vertices nearer than the margin, those outside included                     */
} sn_clearance;
/* Of the vertices; a face that is large for the skin's curvature may come nearer. bone: valid. skin: closed.
 * margin >= 0. Errors: SN_ENOMEM, SN_ECANCEL, SN_ELIMIT; *out is then 0. */
SN_MUST_USE sn_status sn_clearance_measure(const sn_tri_mesh *bone, const sn_bvh *skin, double margin,
                                           const sn_run *run, sn_clearance *out, sn_error *err);

typedef struct sn_clearance_report {
    sn_clearance before, after;
    double moved;    /* largest distance that a vertex moved                                       */
    int32_t n_moved; /* vertices that moved by more than 1e-6 of the bone's diagonal               */
    int32_t rounds;
} sn_clearance_report;
/* Moves what comes nearer to the skin than the margin inwards, and what is around it along with it, so that
 * the bone stays smooth: displacements are spread over the surface (spread.h), about four times as far as
 * they are long, before they are applied, round by round. Afterwards no vertex is nearer than the margin;
 * those moved last may be deeper by up to 1e-3 of it. A bone that kept the margin stays as it is, to the bit.
 *
 * In place; bone is unchanged on error. report: NULL to skip; on error `before` and the last `after` as far
 * as it got. Errors: SN_EINVAL (margin not > 0; a bone that is not valid or not closed), SN_ESOLVE (no room:
 * the margin cannot be kept in 80 rounds, or faces would turn inside out or cross: the message has the place
 * and, but for crossing, the margin that was reached), SN_ENOMEM, SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_clearance_keep(sn_tri_mesh *bone, const sn_bvh *skin, double margin,
                                        const sn_run *run, sn_clearance_report *report, sn_error *err);

#endif
