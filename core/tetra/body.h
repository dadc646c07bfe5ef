/* body.h - the soft tissue as a tet mesh: inside the skin, outside of all bones [A 3].
 *
 * Bones may cross each other and poke through the skin: they are united and cut out of the skin's inside.
 * Every boundary face knows whether it is skin or which bone. A plane may cut a half of it off: the cap there
 * is neither [A 5]. Lengths in the scene's unit. */
#ifndef SN_TETRA_BODY_H
#define SN_TETRA_BODY_H

#include "base/notes.h"
#include "base/run.h"
#include "mesh/sizing.h"
#include "mesh/tet_mesh.h"

#include <stdbool.h>

/* What a boundary face belongs to. */
#define SN_LABEL_SKIN 0
#define SN_LABEL_BONE(i_bone) (1 + (i_bone))
#define SN_LABEL_CAP(n_bone) (1 + (n_bone)) /* where a half model was cut: neither skin nor bone */

typedef struct sn_body { /* open */
    sn_tet_mesh mesh;    /* the soft tissue                                                              */
    int32_t *across;     /* n_tet x 4: the tet across face k; < 0 on the boundary: -1 - label; owned     */
    int32_t n_bone;
    double size; /* length that energies are normalized by: the box diagonal of the mesh, of a half model with
                    its image */
} sn_body;

static inline bool sn_body_is_boundary(int32_t across)
{
    return across < 0;
}
static inline int32_t sn_body_label(int32_t across) /* of a boundary face */
{
    return -1 - across;
}
/* The bone that a face borders on, -1: none. */
static inline int32_t sn_body_bone(const sn_body *b, int32_t across)
{
    int32_t i_bone = -2 - across;
    return i_bone >= 0 && i_bone < b->n_bone ? i_bone : -1;
}

#define SN_BODY_COARSEST 3.0 /* with a sizing: how much longer than their targets edges of the surfaces get  \
                              */

void sn_body_init(sn_body *b);
void sn_body_free(sn_body *b);

typedef struct sn_body_options { /* zero-initialised = the defaults in brackets */
    double edge_length;      /* target on the skin [box diagonal of the skin / 80]                        */
    double bone_edge_length; /* target on bones [edge_length]                                             */
    double max_volume;       /* of a tet, cubed unit [0.35 edge_length^3: an edge of 1.4 edge_length]     */
    double radius_edge;      /* bound on circumradius over shortest edge, >= 1.1 [1.414]                  */
    double time_limit;   /* seconds for the whole of it [300]                                              */
    size_t memory_limit; /* bytes for the mesher [6 GiB]                                              */
    bool is_adaptive;    /* of a scene: see sn_scene_tetrahedralize                               */
    const sn_sizing *sizing; /* lengths from place to place, in the unit box; NULL: the same everywhere.
                                Borrowed. Where it is longer than the targets above these grow with it, up to
                                SN_BODY_COARSEST times; then max_volume is 0.35 of its cube.           */
    bool has_cut;            /* half model: only what is on the side of the plane that the normal points to */
    sn_vec3 cut_point, cut_normal;
} sn_body_options;

typedef struct sn_body_report {
    int32_t n_vert, n_tet;
    int32_t n_surface_face;   /* given to TetGen                                                           */
    int64_t crossings_cured;  /* pairs of faces that rounding left crossing after the union                */
    bool was_resampled;       /* the exact union could not be used: surfaces were sampled on a lattice     */
    double bone_volume_exact; /* of the union of the bones within the skin, before remeshing               */
    double bone_volume;       /* the same after it; both before a half is cut off                           */
    int32_t n_dropped;        /* tets of tissue that bone shuts off from the skin: dropped                 */
    double dropped_volume;
    double min_dihedral_deg, max_dihedral_deg;
    double share_below_10_deg; /* tets with a dihedral angle below 10 degrees, 0..1                         */
    double seconds_surface, seconds_tets, seconds;
    int32_t n_coarse_tet;  /* of an adaptive mesh: tets of the mesh that found where to be fine; else 0 */
    double seconds_coarse; /* for that, all of it; counted in `seconds`                                 */
} sn_body_report;

typedef struct sn_named_surface {
    const char *name;        /* for messages, borrowed */
    const sn_tri_mesh *mesh; /* borrowed               */
} sn_named_surface;

/* Checks the options and fills in the defaults. Errors: SN_EINVAL. */
SN_MUST_USE sn_status sn_body_defaults(const sn_body_options *opt, const sn_tri_mesh *skin,
                                       sn_body_options *out, sn_error *err);

/* The unit box: places are (p - origin) / size, so that the skin's box starts at 0 and has the diagonal 1. */
typedef struct sn_unit_box {
    sn_vec3 origin;
    double size;
} sn_unit_box;
sn_unit_box sn_body_unit_box(const sn_tri_mesh *skin);

/* Builds the tet mesh. Surfaces that turn inwards are turned, corners rounded by up to 2e-12 of the skin's
 * box diagonal and equal ones welded. out: init-ed; empty on error. report, notes: NULL to skip.
 * Deterministic. Errors, each naming the surface: SN_EMESH (open, not manifold, a skin that crosses itself, a
 * bone outside the skin, bones that leave no tissue, TetGen's own failures), SN_EINVAL (options), SN_ELIMIT
 * (time, memory), SN_ECANCEL, SN_ENOMEM. */
SN_MUST_USE sn_status sn_body_build(const sn_tri_mesh *skin, const sn_named_surface *bone, int32_t n_bone,
                                    const sn_body_options *opt, const sn_run *run, sn_body *out,
                                    sn_body_report *report, sn_notes *notes, sn_error *err);

/* Makes a body of any valid tet mesh whose whole boundary carries `label`: for tests and other people's
 * meshes. Copies. Errors: SN_EINVAL, SN_ENOMEM. */
SN_MUST_USE sn_status sn_body_from_tets(const sn_tet_mesh *m, int32_t label, sn_body *out, sn_error *err);

#endif
