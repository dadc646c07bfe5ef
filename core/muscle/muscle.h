/* muscle.h - a muscle: a name, one or more heads, and what its owner wants of its shape and its fibers. */
#ifndef SN_MUSCLE_MUSCLE_H
#define SN_MUSCLE_MUSCLE_H

#include "muscle/head.h"

/* How its tissue spreads along and across the curve: the frame (e1, e2, e3) of path.h, turned by angle_deg
 * about e1, holds the axes of the diffusion tensor [A 3.7]. */
typedef struct sn_anisotropy {
    bool is_on;
    double angle_deg;     /* finite                                                                  */
    double eigenvalue[3]; /* rates along e1, e2, e3; finite and > 0                                  */
    bool has_axis;        /* at angle 0, e2 points as nearly along `axis` as it can                  */
    sn_vec3 axis;         /* not along the curve's first tangent                                     */
} sn_anisotropy;

/* How fibers run through it. */
typedef enum sn_architecture {
    SN_FUSIFORM,     /* along the muscle's shape, from end to end: the default                       */
    SN_PARALLEL,     /* along the line of action everywhere: a strap                                 */
    SN_CONVERGENT,   /* as fusiform, but drawn together to the insertion: a fan                      */
    SN_UNIPENNATE,   /* at an angle to the line of action, all to one side of the aponeurosis        */
    SN_BIPENNATE,    /* towards one aponeurosis sheet from both of its sides                         */
    SN_MULTIPENNATE, /* towards several sheets                                                       */
    SN_N_ARCHITECTURE
} sn_architecture;
extern const char *const sn_architecture_name[SN_N_ARCHITECTURE + 1]; /* NULL-ended */

#define SN_PENNATION_ANGLES 16
/* The aponeurosis is the sheet that the curve and e2 of its frame span; fibers lean along e3. */
typedef struct sn_pennation {
    sn_architecture kind;
    double angle_deg[SN_PENNATION_ANGLES]; /* evenly spaced from origin to insertion, each in [0, 80] */
    int32_t n_angle; /* 0 for kinds without an angle                                    */
    int32_t n_sheet; /* of a multipennate muscle: 2..16                                 */
} sn_pennation;

typedef struct sn_tendon { /* what counts as tendon; both 0: nothing */
    double length;         /* within this length of curve of each end                                 */
    double area;           /* and outwards of where the cross-section first reaches this area         */
} sn_tendon;

typedef struct sn_muscle { /* read freely; change through the functions below */
    char *name;            /* owned                                                                   */
    sn_head *head;         /* n_head, owned                                                           */
    int32_t n_head;
    sn_anisotropy anisotropy;
    sn_pennation pennation;
    sn_tendon tendon;
} sn_muscle;

/* n_head >= 1. m: zero-initialised; zero again on error. Errors: SN_EINVAL (see head.h: the message names the
 * muscle, and the head when there are several), SN_ENOMEM. */
SN_MUST_USE sn_status sn_muscle_init(sn_muscle *m, const char *name, const sn_head_points *head,
                                     int32_t n_head, sn_error *err);
SN_MUST_USE sn_status sn_muscle_copy(sn_muscle *out, const sn_muscle *m, sn_error *err); /* as _init */
void sn_muscle_free(sn_muscle *m);
/* Puts "muscle 'x': " or "muscle 'x', head 2: " before the message of st, unless the run was stopped. */
sn_status sn_muscle_blame(const sn_muscle *m, int32_t i_head, sn_status st, sn_error *err);

/* Each checks all values first: on error the muscle is unchanged and the message names it. SN_EINVAL. */
SN_MUST_USE sn_status sn_muscle_set_anisotropy(sn_muscle *m, const sn_anisotropy *a, sn_error *err);
SN_MUST_USE sn_status sn_muscle_set_pennation(sn_muscle *m, const sn_pennation *p, sn_error *err);
SN_MUST_USE sn_status sn_muscle_set_tendon(sn_muscle *m, const sn_tendon *t, sn_error *err);
/* All tissue values times factor, finite and > 0. */
void sn_muscle_scale_tissue(sn_muscle *m, double factor);

/* Sum over the heads. */
double sn_muscle_length(const sn_muscle *m);

/* Which ends the heads share, up to SN_SHARED_END_REL of the shorter head: fibers need one. */
#define SN_SHARED_END_REL 0.05
typedef enum sn_shared_end { SN_SHARE_NONE, SN_SHARE_ORIGIN, SN_SHARE_INSERTION } sn_shared_end;
sn_shared_end sn_muscle_shared_end(const sn_muscle *m); /* one head: SN_SHARE_INSERTION */

#endif
