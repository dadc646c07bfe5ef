/* Half models: the boundary of the soft tissue, remeshed, cut by a plane. */
#include "base/alloc.h"
#include "base/plane.h"
#include "mesh/mesh_check.h"
#include "mesh/tri_cut.h"
#include "tetra/body_private.h"

/* Of the shortest edge at a vertex: nearer to the plane than that it goes into it, so that no face is cut
 * close to a corner. */
#define SNAP_REL 0.3

/* The length of the shortest edge at each vertex. */
static void find_shortest(const sn_tri_mesh *m, double *shortest)
{
    for (int32_t v = 0; v < m->n_vert; v++) shortest[v] = INFINITY;
    for (int32_t f = 0; f < m->n_face; f++) {
        const int32_t *v = m->face + 3 * (size_t)f;
        for (int k = 0; k < 3; k++) {
            int32_t a = v[k], b = v[(k + 1) % 3];
            double length = sn_v3_dist(sn_tri_mesh_point(m, a), sn_tri_mesh_point(m, b));
            shortest[a] = fmin(shortest[a], length);
            shortest[b] = fmin(shortest[b], length);
        }
    }
}

static sn_status snap_to_plane(sn_tri_mesh *m, const sn_body_options *opt, sn_error *err)
{
    sn_plane plane;
    double *shortest = SN_NEW(double, m->n_vert);
    sn_status st = shortest ? sn_plane_make(&plane, "cut", opt->cut_point, opt->cut_normal, err)
                            : sn_fail(err, SN_ENOMEM, "body: no memory");
    if (!st) find_shortest(m, shortest);
    for (int32_t v = 0; !st && v < m->n_vert; v++) {
        sn_vec3 p = sn_tri_mesh_point(m, v);
        if (fabs(sn_plane_height(&plane, p)) < SNAP_REL * shortest[v])
            sn_v3_store(m->pos + 3 * (size_t)v, sn_plane_project(&plane, p));
    }
    sn_release(shortest);
    return st;
}

/* crosses: the half crosses itself. half: init-ed. */
static sn_status cut(const sn_tri_mesh *m, const sn_body_options *opt, int32_t n_bone, const sn_run *run,
                     sn_tri_mesh *half, bool *crosses, sn_error *err)
{
    sn_mesh_check c;
    sn_status st =
        sn_tri_mesh_cut(m, opt->cut_point, opt->cut_normal, SN_LABEL_CAP(n_bone), run, half, NULL, err);
    if (!st) st = sn_mesh_check_run(&c, half, run, err);
    *crosses = !st && c.self_intersections > 0;
    return st;
}

/* Thin parts may lose their thickness when both sides go into the plane: then nothing goes. */
static sn_status cut_either_way(const sn_tri_mesh *m, const sn_body_options *opt, int32_t n_bone,
                                const sn_run *run, sn_tri_mesh *half, sn_error *err)
{
    sn_tri_mesh snapped;
    bool crosses = false;
    sn_tri_mesh_init(&snapped);
    sn_status st = sn_tri_mesh_copy(&snapped, m, err);
    if (!st) st = snap_to_plane(&snapped, opt, err);
    if (!st) st = cut(&snapped, opt, n_bone, run, half, &crosses, err);
    sn_tri_mesh_free(&snapped);
    if (crosses || st == SN_EMESH) {
        sn_tri_mesh_free(half);
        st = cut(m, opt, n_bone, run, half, &crosses, err);
    }
    return crosses ? sn_fail(err, SN_EMESH, "the half of the body crosses itself at the plane") : st;
}

sn_status sn_body_cut_surface(sn_tri_mesh *m, const sn_body_options *opt, int32_t n_bone, const sn_run *run,
                              sn_error *err)
{
    sn_tri_mesh half;
    sn_tri_mesh_init(&half);
    sn_status st = cut_either_way(m, opt, n_bone, run, &half, err);
    sn_tri_mesh_free(m);
    if (st)
        sn_tri_mesh_free(&half);
    else
        *m = half;
    return st;
}
