/* tendon.h - how much of a muscle's ends is tendon: within a set length of an end, or outwards of where the
 * cross-section first reaches a set area. */
#ifndef SN_FIELD_TENDON_H
#define SN_FIELD_TENDON_H

#include "mesh/tet_mesh.h"
#include "muscle/path.h"

typedef struct sn_tendons { /* of one muscle */
    double *length;         /* 2 n_head: of curve, at the origin and at the insertion of each head; owned */
    int32_t n_head;
} sn_tendons;

/* share: of each tet of the mesh, what the muscle wins of it, 0..1. The cross-section is volume per length of
 * curve, in 64 steps along each head; at an end that the heads share, of all heads together. Where it never
 * reaches the area, all of the head is tendon. t: zero-initialised or filled. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_tendons_find(sn_tendons *t, const sn_tet_mesh *mesh, const double *share,
                                      const sn_muscle *m, const sn_paths *paths, sn_error *err);
void sn_tendons_free(sn_tendons *t);
static inline bool sn_muscle_has_tendon(const sn_muscle *m)
{
    return m->tendon.length > 0.0 || m->tendon.area > 0.0;
}

/* > 0 in tendon: by how much length of curve the place lies on the tendon's side of its border. Continuous:
 * between heads a mean of theirs. */
double sn_tendons_at(const sn_tendons *t, const sn_paths *paths, sn_vec3 p);

#endif
