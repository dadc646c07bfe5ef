/* repair.h - makes a surface closed, manifold, oriented and free of self-intersections.
 *
 * The steps, in this order; one that finds nothing to do changes nothing:
 *   weld        joins vertices that lie within a tolerance of each other
 *   clean       removes degenerate and duplicate faces and unused vertices; a face without area whose middle
 *               corner lies on a neighbour's edge goes into that neighbour, so that no slit opens
 *   orient      winds the faces of each component alike, cuts where more than two faces share an edge or
 *               two fans a vertex, joins borders that coincide, removes open crumbs
 *   fill        closes holes up to a size with triangles
 *   components  turns closed components outside out, removes those that lie inside another one; a closed
 *               component wound against the one around it bounds a cavity and stays
 *   untangle    cuts a component's own crossings out, unites components that cross
 *   wrap        where the steps before did not suffice: a new surface around all faces (CGAL's alpha wrap),
 *               laid back onto the faces where that crosses nothing */
#ifndef SN_MESH_REPAIR_H
#define SN_MESH_REPAIR_H

#include "mesh/mesh_check.h"
#include "mesh/tri_mesh.h"

typedef enum sn_wrap { SN_WRAP_AUTO, SN_WRAP_ALWAYS, SN_WRAP_NEVER } sn_wrap;

/* Lengths in the surface's unit. "diagonal": that of the input's bounding box. */
typedef struct sn_repair {
    double weld;       /* vertices this near are joined; 0: only equal ones; < 0: 1e-6 diagonal             */
    double fill_holes; /* largest diagonal of a hole's bounding box; 0: fill none; < 0: 0.25 diagonal, and
                          all where a wrap would go in through a larger one */
    bool untangle;     /* the step; without it crossings are left to the wrap                               */
    bool largest;      /* keep only the component with the largest volume                                   */
    sn_wrap wrap;      /* auto: when the other steps did not suffice; always: after weld, clean and fill    */
    double tolerance;  /* how far the wrap may be from the input; 0: 0.003 diagonal, or more where the wrap
                          would have more than about 100,000 faces                                          */
    double alpha;  /* the wrap enters gaps wider than about twice this; 0: half the tolerance or less, where
                      the wrap is that far away from the input, and 3 tolerances elsewhere: narrower creases
                      are bridged, smooth parts get few faces                                           */
    double offset; /* the wrap's distance from the input before it is laid back; 0: 0.3 tolerance       */
    double time_limit; /* seconds for each step in a process of its own, 0: none                            */
    size_t memory_limit; /* bytes for it [6 GiB], 0: none                                                   */
} sn_repair;
sn_repair sn_repair_defaults(void);

#define SN_REPAIR_MAX_STEPS 12
#define SN_REPAIR_MAX_COUNTS 6

typedef struct sn_repair_count {
    const char *name; /* "joined", static; plain words that can be keys */
    int64_t n;
} sn_repair_count;

typedef struct sn_repair_step {
    const char *name;
    sn_repair_count count[SN_REPAIR_MAX_COUNTS];
    int n_count;
    double moved; /* weld: the largest displacement of a vertex. Others: the largest distance of the new
                     surface (vertices, edge and face centers) from the faces before the step; for the wrap
                     from the faces that were wrapped. 0 where only faces went. */
} sn_repair_step;

typedef struct sn_repair_report {
    sn_repair_step step[SN_REPAIR_MAX_STEPS];
    int n_step;
    bool wrapped;
    double tolerance, alpha, offset; /* as used; alpha and offset 0 when not wrapped */
    double
        moved; /* largest distance of the result (vertices, edge and face centers) from the input's faces */
    double missed; /* largest distance of an input face's center that is seen from outside from the result:
                      what was cut off or bridged over. Seen: a straight line in one of 26 directions meets
                      no other face. */
    sn_mesh_check check; /* of the result */
} sn_repair_report;

/* in: valid; labels are ignored. out: init-ed, not in; closed, manifold, oriented, outside out, without
 * self-intersections and without labels; empty on error. Deterministic. report: filled as far as the repair
 * came, also on error.
 * Errors: SN_EINVAL (options; a surface that has no extent), SN_EMESH (what remains wrong and which option
 * would help), SN_ENOMEM, SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_repair_run(const sn_tri_mesh *in, const sn_repair *opt, const sn_run *run,
                                    sn_tri_mesh *out, sn_repair_report *report, sn_error *err);

#endif
