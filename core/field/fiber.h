/* fiber.h - the fiber directions of one muscle [A 4.4].
 *
 * Fusiform and convergent muscles: u minimizes u' L u + alpha |N G u|^2, where N holds the two unit normals
 * of the curve's tangent in each tet that the curve crosses; fibers run along grad u. Departures from the
 * paper:
 * - The field lives on the tets of the body that the muscle takes part in, each weighted by the muscle's
 * share of it (linear elements on the cut domain), not on the muscle's own tets, which are full of slivers:
 * the muscle's surface is natural all the same, and a linear u is reproduced exactly.
 * - The curve's term counts by the tet's volume in the muscle. Without that it is a constraint that hardens
 * as the mesh gets finer, and since the directions of neighbouring tets do not quite agree, fibers near the
 * curve then miss them by more and more (a bent tube: 4 degrees, with half the edge length 8; by volume 4 and
 * 2).
 * - At an end u is not a constant but goes on along the curve, and it counts from the end that the heads
 * share: (length of curve from there) / (length of the longest head), taken from 1 when that end is the
 * insertion. So u is 0 at the farthest origin and 1 at the insertion, and heads of different lengths that run
 * side by side agree. Where the muscle does not reach its end (tendon), the same holds for the outermost 4 %
 * of it. Of a convergent muscle, u is given only near the end point of the insertion. Strap-like and pennate
 * muscles: directions by the frame of path.h at the nearest place of the curve, turned by the pennation angle
 * towards e3 (unipennate), or towards the nearest aponeurosis (bi-, multipennate); u is that place. */
#ifndef SN_FIELD_FIBER_H
#define SN_FIELD_FIBER_H

#include "base/run.h"
#include "mesh/tet_mesh.h"
#include "muscle/path.h"

typedef struct sn_fibers { /* open; read only */
    sn_tet_mesh mesh;      /* the tets of the body with a share, and their vertices; owned           */
    int32_t *tet_of;       /* n_tet of the body: the tet in mesh, -1 for the others; owned           */
    double *share;         /* mesh.n_tet; owned                                                      */
    double *u;             /* mesh.n_vert; 0 at the origin, 1 at the insertion; owned                */
    bool *is_free;         /* mesh.n_vert: u was solved for, not given; owned                        */
    sn_vec3 *along;        /* mesh.n_vert: unit, the mean of grad u around the vertex; owned         */
    sn_paths paths;        /* owned                                                                  */
    double longest;   /* head                                                                           */
    bool from_origin; /* the heads share their origin: u counts from there                               */
    sn_pennation pennation;
    double sheet_min, sheet_max; /* extent of the muscle along e3, for several aponeuroses                 */
} sn_fibers;

/* share: n_tet of the body, 0..1, somewhere > 0. f: zero-initialised. Errors: SN_EINVAL (names the muscle: it
 * is empty; fusiform or convergent with heads that share no end), SN_ENOMEM, SN_ESOLVE, SN_ECANCEL. */
SN_MUST_USE sn_status sn_fibers_build(sn_fibers *f, const sn_tet_mesh *body, const double *share,
                                      const sn_muscle *m, const sn_run *run, sn_error *err);
void sn_fibers_free(sn_fibers *f);

/* Unit direction, from origin to insertion, and u (NULL to skip) at a point of a tet of the body that the
 * muscle has a share in. Any thread. */
sn_vec3 sn_fibers_at(const sn_fibers *f, int32_t i_body_tet, sn_vec3 p, double *u);
/* The line of action there: the tangent of the nearest place of the curve. */
sn_vec3 sn_fibers_line_of_action(const sn_fibers *f, sn_vec3 p);
/* Of a bi- or multipennate muscle, the room between two neighbouring sheets, from 0 along e3: no fiber leads
 * from one to another. 0 for other kinds. */
int32_t sn_fibers_room(const sn_fibers *f, sn_vec3 p);

typedef struct sn_fibers_check {
    int32_t sinks, sources; /* vertices off the ends where u is largest or smallest among the neighbours */
    int32_t flipped;        /* tets with directions more than 90 degrees apart at their corners          */
    int32_t still;          /* tets where u changes by less than a thousandth of its mean slope          */
    double worst_turn_deg;  /* largest angle between corners of a tet                                    */
} sn_fibers_check;
/* Sinks, sources and still tets are those of the field u; kinds without one have none. */
SN_MUST_USE sn_status sn_fibers_check_run(const sn_fibers *f, sn_fibers_check *out, sn_error *err);

#endif
