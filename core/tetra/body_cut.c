/* Half models: the boundary of the soft tissue cut by a plane, and kept on its side of it. */
#include "base/alloc.h"
#include "base/plane.h"
#include "mesh/tri_cut.h"
#include "tetra/body_private.h"

#define LEAST_HEIGHT 0.05 /* of the edge length: what is no cap stays that far from the plane */

sn_status sn_body_cut_surface(sn_tri_mesh *m, const sn_body_options *opt, int32_t n_bone, const sn_run *run,
                              sn_error *err)
{
    sn_tri_mesh half;
    sn_tri_mesh_init(&half);
    sn_status st =
        sn_tri_mesh_cut(m, opt->cut_point, opt->cut_normal, SN_LABEL_CAP(n_bone), run, &half, NULL, err);
    sn_tri_mesh_free(m);
    *m = half;
    return st;
}

/* Remeshing follows the surface within a small distance, and so may dip below the plane beside the cap: such
 * vertices go back, and those of the cap exactly into the plane. */
sn_status sn_body_keep_side(sn_tri_mesh *m, const sn_body_options *opt, int32_t n_bone, sn_error *err)
{
    sn_plane plane;
    sn_status st = sn_plane_make(&plane, "cut", opt->cut_point, opt->cut_normal, err);
    bool *in_cap = SN_NEW_ZERO(bool, m->n_vert);
    if (!st && !in_cap) st = sn_fail(err, SN_ENOMEM, "body: no memory");
    for (size_t c = 0; !st && c < 3 * (size_t)m->n_face; c++)
        if (m->label[c / 3] == SN_LABEL_CAP(n_bone)) in_cap[m->face[c]] = true;
    double least = LEAST_HEIGHT * fmin(opt->edge_length, opt->bone_edge_length);
    for (int32_t v = 0; !st && v < m->n_vert; v++) {
        sn_vec3 p = sn_tri_mesh_point(m, v);
        double height = sn_plane_height(&plane, p);
        if (in_cap[v])
            sn_v3_store(m->pos + 3 * (size_t)v, sn_plane_project(&plane, p));
        else if (height < least)
            sn_v3_store(m->pos + 3 * (size_t)v, sn_v3_mad(p, least - height, plane.normal));
    }
    sn_release(in_cap);
    return st;
}
