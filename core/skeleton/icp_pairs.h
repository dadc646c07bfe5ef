/* icp_pairs.h - what rigid and cage ICP share: pairs of a moving surface piece's vertices with the nearest
 * points of a target surface, options, and the account of what happened. */
#ifndef SN_SKELETON_ICP_PAIRS_H
#define SN_SKELETON_ICP_PAIRS_H

#include "base/run.h"
#include "mesh/bvh.h"

enum { SN_ICP_MAX_ITERATIONS = 500 };

typedef struct sn_icp_options { /* zeros: the defaults */
    double min_dot;         /* a pair whose unit normals have a smaller dot product is left out; -1 .. 1 */
    double trim;            /* share of the pairs, the farthest ones, that is left out; 0 .. 0.9         */
    double tolerance;       /* settled when the residual changes by less than this share; default 1e-4   */
    double max_residual;    /* with more, in sizes of the piece, there is no result; default: each step's */
    int32_t max_iterations; /* at most SN_ICP_MAX_ITERATIONS; default: each step's                       */
} sn_icp_options;

typedef enum sn_icp_stop {
    SN_ICP_NONE,    /* did not come to an end                                                  */
    SN_ICP_EXACT,   /* the residual is rounding: 1e-10 of the piece's size                     */
    SN_ICP_SETTLED, /* the residual changes by less than the tolerance                         */
    SN_ICP_STIFF,   /* cage only: settled, but a softer cage would turn faces inside out       */
    SN_ICP_LOST,    /* rigid only: ended too far from the start: an error                      */
    SN_ICP_LIMIT,   /* the iterations were used up: an error                                   */
    SN_ICP_UNPAIRED /* less than 0.3 of the piece (by area) had a match: an error              */
} sn_icp_stop;
const char *sn_icp_stop_name(sn_icp_stop stop); /* the last word of the constant, in lower case */

typedef struct sn_icp_report {
    /* RMS distance of the pairs that were kept, weighted by area: at the start and after each iteration. */
    double residual[SN_ICP_MAX_ITERATIONS + 1];
    double size;               /* of the piece: diagonal of its box at the start */
    int32_t n_iteration;       /* residual has one more                          */
    int32_t n_point, n_paired; /* the piece's vertices, and how many were kept at the end */
    int32_t n_opposed, n_far;  /* discarded for their normals, and by the trim            */
    sn_icp_stop stop;
} sn_icp_report;

/* Fills in the defaults. max_iterations, max_residual: those of the caller's step, named `step` in messages.
 * Errors: SN_EINVAL (a value out of range). */
SN_MUST_USE sn_status sn_icp_options_set(sn_icp_options *o, int32_t max_iterations, double max_residual,
                                         const char *step, sn_error *err);

typedef struct sn_icp_pairs {
    const sn_tri_mesh *piece; /* borrowed: its faces are used */
    const sn_bvh *target;     /* borrowed                     */
    double min_dot, trim;
    double *share;  /* n: area that a vertex stands for, adds up to 1                   */
    double *own;    /* n x 3: unit normals of the piece where it is now                  */
    double *point;  /* n x 3: nearest points                                            */
    double *normal; /* n x 3: unit normals of the target there                          */
    double *dist;   /* n                                                                */
    double *weight; /* n: the share of a pair that is kept, else 0                       */
    void *order;    /* room for sorting                                                 */
    int32_t n, n_paired, n_opposed, n_far;
    double kept;     /* sum of weight                  */
    double residual; /* RMS distance of the pairs kept */
} sn_icp_pairs;

/* p: zero-initialised; must be freed in any case. Errors: SN_EINVAL (a piece without area), SN_ENOMEM. */
SN_MUST_USE sn_status sn_icp_pairs_init(sn_icp_pairs *p, const sn_tri_mesh *piece, const sn_bvh *target,
                                        const sn_icp_options *opt, sn_error *err);
void sn_icp_pairs_free(sn_icp_pairs *p);
/* pos: n x 3, the piece's vertices where they are now. */
void sn_icp_pairs_find(sn_icp_pairs *p, const double *pos, const sn_run *run);
bool sn_icp_pairs_suffice(const sn_icp_pairs *p); /* is enough of the piece paired */
/* Copies the counts into the report and appends the residual as that of iteration r->n_iteration. */
void sn_icp_pairs_tell(const sn_icp_pairs *p, sn_icp_report *r);

/* SN_OK, or SN_ESOLVE with the numbers when r->stop is an error or the last residual is too large. */
SN_MUST_USE sn_status sn_icp_judge(const sn_icp_report *r, const sn_icp_options *opt, const char *step,
                                   sn_error *err);

#endif
