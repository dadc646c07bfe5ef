/* part_fibers.h - fibers, tendon and architecture of a muscle in an extraction. */
#ifndef SN_EXTRACT_PART_FIBERS_H
#define SN_EXTRACT_PART_FIBERS_H

#include "extract/extraction.h"
#include "field/fiber.h"
#include "field/tendon.h"
#include "mesh/polylines.h"

typedef struct sn_part_fibers { /* open; read only. In a mirrored extraction fields are those of the half */
    int32_t tissue;
    sn_fibers fibers;
    sn_tendons tendons;
    bool has_tendon;
    int32_t *tet;    /* n_tet: the extraction's tets of the muscle, ascending; owned            */
    int32_t *source; /* n_tet: the input tet of each; owned                                     */
    int32_t n_tet;
    struct sn_part_fibers *image; /* the field that images of tets reflect, where it is another one than that
                                     of the other tets; owned, NULL: it is the same */
} sn_part_fibers;

/* input: the tets that x was cut from; when x is mirrored, those that its half was cut from. m: the muscle
 * whose curves and wishes to follow, or NULL for the one that x knows (sn_extraction_set_muscles). In a
 * mirrored extraction m leads the half's tets and its reflection their images; a part that is all image is
 * led by m itself. p: zero-initialised. Errors: SN_EINVAL (fat; no curve known; empty; heads without a shared
 * end: the message names the part), SN_ENOMEM, SN_ESOLVE, SN_ECANCEL. */
SN_MUST_USE sn_status sn_part_fibers_build(sn_part_fibers *p, const sn_extraction *x,
                                           const sn_tet_mesh *input, int32_t tissue, const sn_muscle *m,
                                           const sn_run *run, sn_error *err);
void sn_part_fibers_free(sn_part_fibers *p);

/* One side of a part of a mirrored extraction, as a part of its half: of the tets that are no images, or of
 * those whose images they are. Borrows, not to be freed; tet is NULL. */
sn_part_fibers sn_part_fibers_side(const sn_part_fibers *p, const sn_extraction *x, bool is_image);

/* For each tet of the part: centre (n_tet), unit direction (n_tet), u (n_tet), is it tendon (n_tet). NULL to
 * skip any. */
void sn_part_fibers_sample(const sn_part_fibers *p, const sn_extraction *x, const sn_run *run,
                           sn_vec3 *centre, sn_vec3 *direction, double *u, bool *is_tendon);

/* n lines through points spread evenly over the belly (the muscle without its tendon), from origin to
 * insertion, each followed both ways until it leaves the belly or meets the other side of an aponeurosis.
 * Their part is the tissue, their values are u. Fewer than n when some come out shorter than two points.
 * out: appended to. Errors: SN_ENOMEM, SN_ECANCEL. */
SN_MUST_USE sn_status sn_part_fibers_lines(const sn_part_fibers *p, const sn_extraction *x, int32_t n,
                                           const sn_run *run, sn_polylines *out, sn_error *err);

/* Counts of both sides in a mirrored extraction. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_part_fibers_check(const sn_part_fibers *p, const sn_extraction *x,
                                           sn_fibers_check *out, sn_error *err);

typedef struct sn_part_architecture {
    double volume, belly_volume; /* with and without tendon                                                */
    double fiber_length;         /* mean of 400 lines                                                      */
    double pennation_deg;        /* mean angle between fibers and the line of action, by volume of belly   */
    double pcsa; /* physiological cross-section: belly_volume * cos(pennation) / fiber_length              */
    sn_fibers_check check;
} sn_part_architecture;
SN_MUST_USE sn_status sn_part_architecture_find(const sn_part_fibers *p, const sn_extraction *x,
                                                const sn_run *run, sn_part_architecture *out, sn_error *err);

/* Directions and tendon of all muscles (of one when tissue >= 0): fiber n_tet x 3 (0 in fat and in parts
 * without curves), tendon n_tet (1 or 0) of x. A muscle without a field (empty, heads that share no end)
 * keeps 0. Errors: SN_ENOMEM, SN_ESOLVE, SN_ECANCEL. */
SN_MUST_USE sn_status sn_extraction_fibers(const sn_extraction *x, const sn_tet_mesh *input, int32_t tissue,
                                           const sn_run *run, double *fiber, double *tendon, sn_error *err);

#endif
