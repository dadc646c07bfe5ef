/* mesher.h - the program sinew-mesher: third-party meshing in a process of its own.
 *
 * CGAL's corefinement orders things by their addresses: one union came out with 33 k faces in three ways,
 * depending on what the caller's heap held (measured). A fresh process without address randomization has the
 * same memory layout every time, so the same input gives the same output. */
#ifndef SN_TETRA_MESHER_H
#define SN_TETRA_MESHER_H

#include "base/child.h"

/* The repair of a surface (core/mesh/repair_child.c) starts the program by itself; its job begins with its
 * number. */
typedef enum sn_mesher_job {
    SN_MESHER_TETGEN = 1,
    SN_MESHER_COREFINE = 2,
    SN_MESHER_REPAIR = 3 /* SN_REPAIR_JOB */
} sn_mesher_job;

/* Called in a child (base/child.h): goes on as sinew-mesher with this job. The program is looked for beside
 * the running one, then where the library was built. Returns when it is not there: the caller then does the
 * work in the fork. */
void sn_mesher_exec(sn_child_out *out, sn_mesher_job job, const char *input, size_t size);
/* What sinew-mesher does with its standard input. Errors: SN_EINTERNAL for anything but a job, and those of
 * the job. */
SN_MUST_USE sn_status sn_mesher_serve(const char *input, size_t size, sn_child_out *out, sn_error *err);

/* The jobs, each beside the code that makes its input. */
SN_MUST_USE sn_status sn_mesher_tetgen(const char *input, size_t size, sn_child_out *out, sn_error *err);
SN_MUST_USE sn_status sn_mesher_corefine(const char *input, size_t size, sn_child_out *out, sn_error *err);

#endif
