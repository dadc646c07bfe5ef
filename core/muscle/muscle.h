/* muscle.h - a muscle: a name, a curve, a tissue value at each control point [A 3.2].
 * Points in the scene's unit; the first is the origin, the last the insertion. */
#ifndef SN_MUSCLE_MUSCLE_H
#define SN_MUSCLE_MUSCLE_H

#include "base/notes.h"
#include "muscle/spline.h"

typedef struct sn_muscle { /* read freely; change through the functions below */
    char *name;            /* owned                                           */
    double *point;         /* n_point x 3, owned                              */
    double *tissue;        /* n_point, each finite and > 0, owned             */
    int32_t n_point;
    sn_spline spline; /* always that of the points                       */
} sn_muscle;

/* point: n x 3, n >= 2; tissue: n values, or NULL for 1 everywhere. m: zero-initialised. On error m is empty.
 * Errors: SN_EINVAL (too few points, equal neighbours, a value that is not finite or a tissue that is not >
 * 0: the message names the muscle and the point), SN_ENOMEM. */
SN_MUST_USE sn_status sn_muscle_init(sn_muscle *m, const char *name, const double *point,
                                     const double *tissue, int32_t n, sn_error *err);
void sn_muscle_free(sn_muscle *m);

/* i_point in [0, n_point). On error the muscle is unchanged. Errors: SN_EINVAL, SN_ENOMEM. */
SN_MUST_USE sn_status sn_muscle_set_point(sn_muscle *m, int32_t i_point, sn_vec3 p, sn_error *err);
/* Before i_point, in [0, n_point] (n_point appends). */
SN_MUST_USE sn_status sn_muscle_insert_point(sn_muscle *m, int32_t i_point, sn_vec3 p, double tissue,
                                             sn_error *err);
SN_MUST_USE sn_status sn_muscle_remove_point(sn_muscle *m, int32_t i_point, sn_error *err); /* 2 must stay */
/* i_point < 0: all points. */
SN_MUST_USE sn_status sn_muscle_set_tissue(sn_muscle *m, int32_t i_point, double value, sn_error *err);

/* The tissue value at a place of the curve: linear between control points in the segment's parameter. */
double sn_muscle_tissue_at(const sn_muscle *m, int32_t i_seg, double s);

typedef struct sn_collocation { /* rows of B and d for one muscle [A 3.3] */
    int32_t *tet;               /* n_row: the tet that the row's curve piece crosses; owned   */
    double *bary;               /* n_row x 4: barycentric coordinates of the piece's middle; owned */
    double *value;              /* n_row: tissue value there; owned                           */
    int32_t n_row;
    double length_inside, length_outside;
} sn_collocation;
void sn_collocation_free(sn_collocation *c);

#define SN_LENGTH_LOST_REL                                                                                   \
    0.005 /* of the curve: a shorter loss is the roughness of the bone's mesh, not worth a note */

/* One row per tet that the curve crosses, in curve order. A curve partly outside the body: a note with the
 * muscle's name and the length lost. Errors: SN_EINVAL (the curve never enters the body), SN_ENOMEM. */
SN_MUST_USE sn_status sn_collocate(const sn_muscle *m, const sn_body *b, const sn_locator *l,
                                   sn_collocation *out, sn_notes *notes, sn_error *err);

#endif
