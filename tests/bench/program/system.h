/* system.h - the linear systems behind a scene's tissue functions, assembled as anybody would: the matrix L +
 * alpha B'B on the vertices off the skin, and one right-hand side for fat and each muscle [A Eq. 10].
 * Anisotropic muscles are taken as isotropic: the systems measure the usual way, which knows one matrix. */
#ifndef BENCH_SYSTEM_H
#define BENCH_SYSTEM_H

#include "field/laplacian.h"
#include "scene/scene.h"
#include "tetra/locate.h"

typedef struct bench_system { /* open; zero-initialised = empty                                          */
    int64_t *ptr, *idx;       /* lower triangle by columns, rows ascending: n + 1, ptr[n]; owned         */
    double *val;              /* ptr[n]; owned                                                           */
    double *rhs, *x;          /* n x n_rhs, column-major: right-hand sides, the last solutions; owned    */
    int32_t n, n_rhs, n_row;  /* unknowns, tissues, collocation points                                   */
    int32_t *number, *vertex; /* unknown of a vertex, -1 on the skin, and the other way round; owned     */
    sn_csr laplacian, matrix;
    sn_locator *locator;
    const double *pos;   /* of the mesh that they were made for */
    const sn_body *body; /* borrowed from the scene: valid until it is meshed again               */
} bench_system;

/* Assembles the systems of the scene as it is: it must be meshed and have muscles. out: zero-initialised, or
 * made before for the same mesh, whose pattern is then kept. On error it is to be freed. Errors: SN_EINVAL
 * (also for another mesh), SN_ENOMEM, SN_ECANCEL. */
SN_MUST_USE sn_status bench_system_make(bench_system *out, const sn_scene *scene, const sn_run *run,
                                        sn_error *err);
void bench_system_free(bench_system *s);

/* The largest difference between the last solutions and the scene's fields, exact or quick, over the largest
 * value of these, over all isotropic tissues. Errors: SN_EINVAL (the scene has other muscles, or is not
 * solved). */
SN_MUST_USE sn_status bench_system_compare(const bench_system *s, const sn_scene *scene, double *difference,
                                           sn_error *err);

#endif
