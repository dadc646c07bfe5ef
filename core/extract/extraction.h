/* extraction.h - muscles as tets that fit each other exactly: the maximization diagram of the tissue
 * functions [A 4].
 *
 * Every tet is cut into the cells { p : f_i(p) >= f_j(p) for all j }. Corners are named by the vertex, edge,
 * face or tet they lie on and the set of tissues that tie there, so neighbouring tets agree without
 * searching, and all decisions are signs of small integer determinants with symbolic tie-breaking: the result
 * conforms and every tissue's boundary is manifold wherever the tet mesh is. METHOD 8. */
#ifndef SN_EXTRACT_EXTRACTION_H
#define SN_EXTRACT_EXTRACTION_H

#include "base/plane.h"
#include "base/run.h"
#include "mesh/tet_io.h"
#include "mesh/tet_mesh.h"
#include "muscle/muscle.h"

#include <stdbool.h>

#define SN_MAX_TISSUES 4096

/* What an extraction made by sn_extraction_mirror is the double of. The half's vertices, tets, tissues and
 * muscles come first in the whole, as they were but for vertices moved onto the plane; tet n_tet + i is the
 * image of tet i. */
typedef struct sn_extraction_half {
    sn_plane plane;
    int32_t n_vert, n_tet, n_tissue, n_muscle; /* n_tet is 0 in any other extraction */
} sn_extraction_half;

typedef struct sn_extraction { /* open */
    sn_tet_mesh mesh;          /* all cells; part = tissue id: 0 is the first function (fat)              */
    int32_t *source;  /* n_tet: the input tet that the tet, or the one it is the image of, lies in; owned */
    double *envelope; /* n_vert: the largest tissue function's value there; owned                */
    char **name;      /* n_tissue; owned                                                         */
    int32_t n_tissue;
    sn_muscle *muscle;   /* n_muscle: what is known of tissues 1, 2, ...; owned                      */
    int32_t n_muscle;    /* 0: nothing                                                               */
    double input_volume; /* of the input tets                                                       */
    int64_t n_moved;     /* corners kept away from the ends of their edge, the border of their face or tet  */
    double largest_move; /* of those, in input units                                                */
    double seconds;
    sn_extraction_half half;
    bool is_cut; /* of a half model, cut by this plane                                               */
    sn_vec3 cut_point, cut_normal;
} sn_extraction;

void sn_extraction_init(sn_extraction *x);
void sn_extraction_free(sn_extraction *x);

typedef struct sn_extract_options { /* zero-initialised = defaults */
    double margin; /* how far crossings stay from the ends of their edge, and so on, as a fraction; in (0,
                      0.2]; 0: 1e-3 */
} sn_extract_options;

/* value: n_tissue x n_vert, finite. name: n_tissue. Deterministic, whatever the number of threads.
 * Errors: SN_EINVAL (no tissues, more than SN_MAX_TISSUES, a value that is not finite: names tissue and
 * vertex), SN_ENOMEM, SN_ELIMIT (more than 2^31 tets), SN_ECANCEL. out is then empty. */
SN_MUST_USE sn_status sn_extract(const sn_tet_mesh *m, const double *value, const char *const *name,
                                 int32_t n_tissue, const sn_extract_options *opt, const sn_run *run,
                                 sn_extraction *out, sn_error *err);

typedef struct sn_extraction_check {
    bool conforming;     /* no face with more than two tets; the outside faces are those of the input      */
    bool manifold;       /* every tissue's boundary: edges and vertices (and the whole's)                  */
    bool positive;       /* every tet has a positive volume                                                */
    double volume_error; /* |sum of volumes - input volume| / input volume                                 */
    int64_t nonmanifold_edges, nonmanifold_vertices; /* over all tissues */
    int64_t bad_faces; /* shared by more than two tets, or open where the input is not                   */
    int32_t inverted;  /* tets without a positive volume                                                 */
    double min_volume, max_volume;
} sn_extraction_check;
/* input: the mesh that was cut, or NULL to check without it (conforming then means: no face with more than
 * two tets and the outside is closed). */
SN_MUST_USE sn_status sn_extraction_check_run(sn_extraction_check *out, const sn_extraction *x,
                                              const sn_tet_mesh *input, const sn_run *run, sn_error *err);

/* Says which muscles tissues 1 .. n_muscle are: their curves and wishes lead fibers and tendons. Copies. On
 * error x is unchanged. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_extraction_set_muscles(sn_extraction *x, const sn_muscle *const *muscle,
                                                int32_t n_muscle, sn_error *err);

static inline bool sn_extraction_is_image(const sn_extraction *x, int32_t i_tet)
{
    return x->half.n_tet > 0 && i_tet >= x->half.n_tet;
}

int32_t sn_extraction_find(const sn_extraction *x, const char *name); /* tissue id, or -1 */
/* One tissue alone: its tets (part = tissue id) with the vertices they use, in order. Empty tissue: 0 tets,
 * SN_OK. */
SN_MUST_USE sn_status sn_extraction_part(const sn_extraction *x, int32_t tissue, sn_tet_mesh *out,
                                         sn_error *err);
double sn_extraction_part_volume(const sn_extraction *x, int32_t tissue);
int32_t sn_extraction_part_tets(const sn_extraction *x, int32_t tissue);
/* Writes by extension. input: the tets that x was cut from, or NULL.
 *
 * .vtu: all tissues with ids and names, the field "envelope" per vertex; with muscles known and input given
 * also "fiber" (unit vectors) and "tendon" (1 or 0) per tet, 0 where a muscle has no fibers.
 *
 * .msh: the same as far as Gmsh has places for it.
 *
 * .mesh: ids and names; tendon has ids of its own after the last tissue, named "NAME:tendon".
 *
 * No extension: a folder (made when missing) that receives NAME.obj, the surface of each muscle (not fat, not
 * empty ones).
 *
 * Errors: SN_EIO, SN_EINVAL, SN_ENOMEM, SN_ECANCEL. */
SN_MUST_USE sn_status sn_extraction_save(const sn_extraction *x, const sn_tet_mesh *input, const char *path,
                                         const sn_run *run, sn_error *err);
/* One tissue alone: .vtu .msh .mesh its tets as above, with all names; .obj .ply .stl .off its surface.
 * SN_EINVAL: it is empty. */
SN_MUST_USE sn_status sn_extraction_save_part(const sn_extraction *x, const sn_tet_mesh *input,
                                              int32_t tissue, const char *path, const sn_run *run,
                                              sn_error *err);

#endif
