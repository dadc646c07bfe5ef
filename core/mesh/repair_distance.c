/* repair_distance.c - how far a repaired surface is from the one before, and what of that it lost. */
#include "mesh/repair_private.h"

#include "base/alloc.h"
#include "mesh/bvh.h"

#define STEP_OFF                                                                                             \
    1e-6 /* of the diagonal: where a line of sight begins, so that it does not meet its own face */

static sn_vec3 face_center(const sn_tri_mesh *m, int32_t f)
{
    const int32_t *v = m->face + 3 * (size_t)f;
    sn_vec3 sum = sn_v3_add(sn_tri_mesh_point(m, v[0]), sn_tri_mesh_point(m, v[1]));
    return sn_v3_scale(1.0 / 3.0, sn_v3_add(sum, sn_tri_mesh_point(m, v[2])));
}

/* The corners, edge centers and center of a face. */
static double face_distance(const sn_bvh *from, const sn_tri_mesh *m, int32_t f)
{
    const int32_t *v = m->face + 3 * (size_t)f;
    double far = sn_bvh_closest(from, face_center(m, f)).dist;
    for (int k = 0; k < 3; k++) {
        sn_vec3 p = sn_tri_mesh_point(m, v[k]), q = sn_tri_mesh_point(m, v[(k + 1) % 3]);
        far = fmax(far, sn_bvh_closest(from, p).dist);
        far = fmax(far, sn_bvh_closest(from, sn_v3_lerp(p, q, 0.5)).dist);
    }
    return far;
}

sn_status sn_repair_moved(const sn_tri_mesh *m, const sn_tri_mesh *from, const sn_run *run, double *moved,
                          sn_error *err)
{
    static const char step[] = "measuring the repair";
    sn_bvh *b;
    *moved = 0.0;
    sn_status st = sn_run_step(run, step, 0.0, err);
    if (!st) st = sn_bvh_create(&b, from, err);
    if (st) return st;
    double far = 0.0;
#pragma omp parallel for num_threads(sn_run_threads(run)) schedule(dynamic, 256) reduction(max : far)
    for (int32_t f = 0; f < m->n_face; f++)
        if (!sn_run_stopped(run)) far = fmax(far, face_distance(b, m, f));
    sn_bvh_destroy(b);
    *moved = far;
    return sn_run_step(run, step, 1.0, err);
}

/* Along the 26 directions to the neighbours in a lattice of cubes. */
static bool is_seen(const sn_bvh *b, sn_vec3 p, double off)
{
    for (int i = 0; i < 27; i++) {
        sn_vec3 dir = sn_v3_unit(sn_v3(i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1));
        sn_ray_hit hit;
        if (i != 13 && !sn_bvh_ray_first(b, sn_v3_mad(p, off, dir), dir, INFINITY, &hit)) return true;
    }
    return false;
}

sn_status sn_repair_missed(const sn_tri_mesh *m, const sn_tri_mesh *from, const sn_run *run, double *missed,
                           sn_error *err)
{
    static const char step[] = "measuring the repair";
    sn_bvh *own = NULL, *other = NULL;
    sn_box3 box = sn_tri_mesh_bounds(from);
    double far = 0.0, off = STEP_OFF * sn_v3_dist(box.min, box.max);
    *missed = 0.0;
    sn_status st = sn_run_step(run, step, 0.0, err);
    if (!st) st = sn_bvh_create(&own, from, err);
    if (!st) st = sn_bvh_create(&other, m, err);
    if (!st) {
#pragma omp parallel for num_threads(sn_run_threads(run)) schedule(dynamic, 256) reduction(max : far)
        for (int32_t f = 0; f < from->n_face; f++) {
            if (sn_run_stopped(run)) continue;
            sn_vec3 p = face_center(from, f);
            double d = sn_bvh_closest(other, p).dist;
            if (d > far && is_seen(own, p, off)) far = d;
        }
        *missed = far;
        st = sn_run_step(run, step, 1.0, err);
    }
    sn_bvh_destroy(own);
    sn_bvh_destroy(other);
    return st;
}
