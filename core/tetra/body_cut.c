/* Half models: the boundary of the soft tissue, remeshed, cut by a plane. */
#include "base/alloc.h"
#include "base/plane.h"
#include "mesh/mesh_check.h"
#include "mesh/tri_cut.h"
#include "tetra/body_private.h"

/* Of the shortest edge at a vertex: nearer to the plane than that it goes into it, so that no face is cut
 * close to a corner. */
#define SNAP_REL 0.3

typedef struct corner_heights {  /* one of each vertex */
    double *height, *shortest;   /* over the plane; shortest edge */
    bool *has_above, *has_below; /* among its neighbours, farther from the plane than what goes into it */
} corner_heights;

static sn_status open_heights(corner_heights *c, const sn_tri_mesh *m, const sn_plane *plane, sn_error *err)
{
    *c = (corner_heights){SN_NEW(double, m->n_vert), SN_NEW(double, m->n_vert), SN_NEW_ZERO(bool, m->n_vert),
                          SN_NEW_ZERO(bool, m->n_vert)};
    if (!c->height || !c->shortest || !c->has_above || !c->has_below)
        return sn_fail(err, SN_ENOMEM, "body: no memory for %d vertices", m->n_vert);
    for (int32_t v = 0; v < m->n_vert; v++) {
        c->height[v] = sn_plane_height(plane, sn_tri_mesh_point(m, v));
        c->shortest[v] = INFINITY;
    }
    return SN_OK;
}

static void close_heights(corner_heights *c)
{
    sn_release(c->height);
    sn_release(c->shortest);
    sn_release(c->has_above);
    sn_release(c->has_below);
}

static void look_around(const sn_tri_mesh *m, corner_heights *c)
{
    for (int32_t h = 0; h < 3 * m->n_face; h++) {
        int32_t a = m->face[h], b = m->face[h % 3 == 2 ? h - 2 : h + 1];
        double length = sn_v3_dist(sn_tri_mesh_point(m, a), sn_tri_mesh_point(m, b));
        c->shortest[a] = fmin(c->shortest[a], length);
        c->shortest[b] = fmin(c->shortest[b], length);
    }
    for (int32_t h = 0; h < 3 * m->n_face; h++) { /* each edge is in two faces, once either way */
        int32_t a = m->face[h], b = m->face[h % 3 == 2 ? h - 2 : h + 1];
        c->has_above[a] = c->has_above[a] || c->height[b] > SNAP_REL * c->shortest[b];
        c->has_below[a] = c->has_below[a] || c->height[b] < -SNAP_REL * c->shortest[b];
    }
}

/* Only where the plane goes through the surface: a corner that would just touch it would join the half with
 * its image in a point. */
static sn_status snap_to_plane(sn_tri_mesh *m, const sn_body_options *opt, sn_error *err)
{
    sn_plane plane;
    corner_heights c = {0};
    sn_status st = sn_plane_make(&plane, "cut", opt->cut_point, opt->cut_normal, err);
    if (!st) st = open_heights(&c, m, &plane, err);
    if (!st) look_around(m, &c);
    for (int32_t v = 0; !st && v < m->n_vert; v++)
        if (fabs(c.height[v]) < SNAP_REL * c.shortest[v] && c.has_above[v] && c.has_below[v])
            sn_v3_store(m->pos + 3 * (size_t)v, sn_plane_project(&plane, sn_tri_mesh_point(m, v)));
    close_heights(&c);
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
