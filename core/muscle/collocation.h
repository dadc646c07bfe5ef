/* collocation.h - where a muscle's curves pin the tissue functions: one point per crossed tet [A 3.3]. */
#ifndef SN_MUSCLE_COLLOCATION_H
#define SN_MUSCLE_COLLOCATION_H

#include "base/notes.h"
#include "muscle/muscle.h"
#include "tetra/body.h"
#include "tetra/locate.h"

typedef struct sn_collocation { /* rows of B and d for one muscle, head after head                      */
    int32_t *tet;               /* n_row: the tet that the row's curve piece crosses; owned             */
    double *bary;               /* n_row x 4: barycentric coordinates of the piece's middle; owned      */
    double *value;              /* n_row: tissue value there; owned                                     */
    int32_t *head;              /* n_row; owned                                                         */
    double *arc;                /* n_row: length of the head's curve up to there; owned                 */
    int32_t n_row;
    double length_inside, length_outside; /* over all heads */
} sn_collocation;
void sn_collocation_free(sn_collocation *c);

#define SN_LENGTH_LOST_REL                                                                                   \
    0.005 /* of the curve: a shorter loss is the roughness of the bone's mesh, not worth a note */

/* One row per tet that a curve crosses, in curve order. A curve partly outside the body: a note with the
 * muscle's name and the length lost. Errors: SN_EINVAL (a curve never enters the body), SN_ENOMEM. out is
 * then empty. */
SN_MUST_USE sn_status sn_collocate(const sn_muscle *m, const sn_body *b, const sn_locator *l,
                                   sn_collocation *out, sn_notes *notes, sn_error *err);

#endif
