/* repair_private.h - the steps of a repair, one file each. For core/mesh/repair*.c only, but for the job that
 * sinew-mesher does. */
#ifndef SN_MESH_REPAIR_PRIVATE_H
#define SN_MESH_REPAIR_PRIVATE_H

#include "base/child.h"
#include "mesh/repair.h"
#include "mesh/repair_bridge.h"

/* ---- repair_soup.c: in place; labels must be NULL. Errors: SN_ENOMEM; m is then still valid. ---- */

/* Each vertex joins the nearest one before it that stays, within the tolerance. *moved: largest distance. */
SN_MUST_USE sn_status sn_repair_weld(sn_tri_mesh *m, double tolerance, int32_t *n_joined, double *moved,
                                     sn_error *err);
typedef struct sn_clean_counts {
    int32_t degenerate, duplicate, unused;
} sn_clean_counts;
SN_MUST_USE sn_status sn_repair_clean(sn_tri_mesh *m, sn_clean_counts *n, sn_error *err);

/* ---- repair_parts.c ---- */

typedef struct sn_part_counts {
    int32_t turned, inside, others; /* components: turned, removed inside another, removed as not largest */
} sn_part_counts;
/* m: closed, manifold, oriented. In place. Components that cross each other stay, outside out. Errors:
 * SN_ENOMEM, SN_ECANCEL, SN_ELIMIT. */
SN_MUST_USE sn_status sn_repair_parts(sn_tri_mesh *m, bool only_largest, const sn_run *run, sn_part_counts *n,
                                      sn_error *err);
/* Takes out the faces that keep[face] denies, and then unused vertices. Errors: SN_ENOMEM (m unchanged). */
SN_MUST_USE sn_status sn_repair_keep_faces(sn_tri_mesh *m, const bool *keep, int32_t *n_unused,
                                           sn_error *err);

/* ---- repair_distance.c ---- */

/* Largest distance of m's vertices, edge centers and face centers from the faces of `from`. */
SN_MUST_USE sn_status sn_repair_moved(const sn_tri_mesh *m, const sn_tri_mesh *from, const sn_run *run,
                                      double *moved, sn_error *err);
/* Largest distance from m of the face centers of `from` that are seen from outside. */
SN_MUST_USE sn_status sn_repair_missed(const sn_tri_mesh *m, const sn_tri_mesh *from, const sn_run *run,
                                       double *missed, sn_error *err);

/* ---- repair_wrap.c ---- */

typedef struct sn_wrap_result {
    double alpha, offset, moved; /* alpha: the smallest one   */
    int32_t tries, laid_back;    /* laid_back: vertices moved onto the input */
    bool is_shell;               /* failed: the wrap went in through a hole  */
} sn_wrap_result;
/* Wraps with opt->tolerance (> 0), alpha and offset (0: by itself). *result is set also on error.
 * Errors: SN_EMESH (tolerance not kept, or a wrap that went in through a hole), and those of the child. */
SN_MUST_USE sn_status sn_repair_wrap(const sn_tri_mesh *in, const sn_repair *opt, const sn_run *run,
                                     sn_tri_mesh *out, sn_wrap_result *result, sn_error *err);

/* ---- repair_child.c: CGAL in a process of its own ---- */

enum { SN_REPAIR_JOB = 3 }; /* among the jobs of sinew-mesher, see tetra/mesher.h */

typedef enum sn_repair_task { SN_TASK_ORIENT_FILL, SN_TASK_UNTANGLE, SN_TASK_WRAP } sn_repair_task;
typedef struct sn_repair_sizes { /* those of the task */
    double hole, crumb;
    sn_wrap_sizes wrap;
} sn_repair_sizes;
/* n: zero unless the task counts. */
SN_MUST_USE sn_status sn_repair_in_child(sn_repair_task task, const sn_tri_mesh *in, sn_repair_sizes sizes,
                                         const sn_repair *opt, const sn_run *run, sn_tri_mesh *out,
                                         sn_repair_counts *n, sn_error *err);
/* What sinew-mesher does with such a job. */
SN_MUST_USE sn_status sn_repair_serve(const char *input, size_t size, sn_child_out *out, sn_error *err);

#endif
