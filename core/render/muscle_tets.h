/* muscle_tets.h - which tets, boundary faces and section polygons can show a muscle, and with which muscles.
 *
 * The part of the muscle picture that needs no OpenGL. g_i = f_i - f_fat, computed in double; a muscle can
 * show only where its g is above 0, and g is linear in a tet, so the signs at the corners settle which
 * muscles count in a tet. */
#ifndef SN_RENDER_MUSCLE_TETS_H
#define SN_RENDER_MUSCLE_TETS_H

#include "base/run.h"
#include "render/picture.h"

typedef struct sn_muscle_lists { /* muscles per item, items in index order */
    int64_t *first;              /* n_item + 1, into muscle; owned         */
    int32_t *muscle;             /* increasing within an item; owned       */
} sn_muscle_lists;

typedef struct sn_muscle_tets {
    sn_muscle_lists above; /* per vertex: the muscles with g > 0 there                                     */
    int32_t *tet; /* n_tet, increasing: the tets in which fat wins somewhere and a muscle somewhere; owned */
    sn_muscle_lists cand; /* per tet sent: its candidates                                                 */
    int32_t n_tet;
    sn_muscle_lists need; /* per vertex: the muscles whose normals are needed there                       */
    float *normal;        /* 3 per entry of need: unit, toward smaller g (out of the muscle); owned       */
} sn_muscle_tets;

/* The tets around each vertex, in index order: does not depend on the fields. */
typedef struct sn_tet_fans {
    int64_t *first; /* n_vert + 1, into tet; owned */
    int32_t *tet;
} sn_tet_fans;
/* f is zeroed. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_tet_fans_find(sn_tet_fans *f, const sn_tet_mesh *mesh, sn_error *err);
void sn_tet_fans_free(sn_tet_fans *f);

void sn_muscle_tets_init(sn_muscle_tets *m);
void sn_muscle_tets_free(sn_muscle_tets *m);
/* Everything above for the scene's tets. fans: theirs. m is init-ed; on error it is empty.
 * Errors: SN_EINVAL (a field value that is not finite: names tissue and vertex), SN_ENOMEM, SN_ECANCEL. */
SN_MUST_USE sn_status sn_muscle_tets_find(sn_muscle_tets *m, const sn_picture_scene *s,
                                          const sn_tet_fans *fans, const sn_run *run, sn_error *err);
/* The normal of a muscle at a vertex of a tet sent, where it is a candidate. */
const float *sn_muscle_tets_normal(const sn_muscle_tets *m, int32_t i_vert, int32_t i_muscle);

/* Merges the increasing lists of n_item <= 4 items into out (room for all muscles); returns the number. */
int32_t sn_muscle_lists_merge(const sn_muscle_lists *l, const int32_t *item, int n_item, int32_t *out);

static inline double sn_muscle_above_fat(const sn_picture_scene *s, int32_t i_muscle, int32_t i_vert)
{
    size_t n = (size_t)s->tets->n_vert;
    return s->field[(size_t)(i_muscle + 1) * n + (size_t)i_vert] - s->field[i_vert];
}
/* 0 or less: no tendon. */
static inline double sn_muscle_tendon(const sn_picture_scene *s, int32_t i_muscle, int32_t i_vert)
{
    const float *t = s->tendon ? s->tendon[i_muscle] : NULL;
    return t ? (double)t[i_vert] : 0.0;
}

#endif
