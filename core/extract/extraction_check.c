#include "extract/extraction.h"

#include "base/alloc.h"
#include "mesh/mesh_check.h"
#include "tetra/locate.h"

#include <math.h>

#define ON_BORDER 1e-9 /* barycentric: an outside face lies on an outside face of its source tet */

static void check_volumes(const sn_extraction *x, sn_extraction_check *c)
{
    double sum = 0.0;
    c->min_volume = INFINITY;
    c->max_volume = 0.0;
    for (int32_t t = 0; t < x->mesh.n_tet; t++) {
        double v = sn_tet_mesh_tet_volume(&x->mesh, t);
        sum += v;
        c->inverted += !(v > 0.0);
        c->min_volume = fmin(c->min_volume, v);
        c->max_volume = fmax(c->max_volume, v);
    }
    c->positive = c->inverted == 0 && x->mesh.n_tet > 0;
    c->volume_error = x->input_volume > 0.0 ? fabs(sum - x->input_volume) / x->input_volume : 0.0;
}

/* Outside faces must lie on outside faces of the input: anything else is a crack. */
static sn_status check_outside(const sn_extraction *x, const int32_t *adj, const sn_tet_mesh *input,
                               sn_extraction_check *c, sn_error *err)
{
    int32_t *in_adj = NULL;
    sn_status st = sn_tet_mesh_adjacency(input, &in_adj, err);
    for (size_t h = 0; !st && h < 4 * (size_t)x->mesh.n_tet; h++) {
        if (adj[h] >= 0) continue;
        const int32_t *t = x->mesh.tet + (h & ~(size_t)3);
        const int *f = sn_tet_face[h & 3];
        int32_t source = x->source[h >> 2];
        bool on[4] = {true, true, true, true}, ok = false;
        for (int i = 0; i < 3; i++) {
            double b[4];
            sn_vec3 p = sn_tet_mesh_point(&x->mesh, t[f[i]]);
            if (sn_extraction_is_image(x, (int32_t)(h >> 2))) p = sn_plane_reflect(&x->half.plane, p);
            sn_tet_barycentric(input, source, p, b);
            for (int k = 0; k < 4; k++) on[k] = on[k] && fabs(b[k]) < ON_BORDER;
        }
        for (int k = 0; k < 4; k++) ok = ok || (on[k] && in_adj[4 * (size_t)source + (size_t)k] < 0);
        c->bad_faces += !ok;
    }
    sn_release(in_adj);
    return st;
}

static sn_status check_part(const sn_extraction *x, const int32_t *adj, int32_t part, sn_extraction_check *c,
                            sn_error *err)
{
    sn_tri_mesh surface;
    sn_mesh_check topo = {0};
    sn_tri_mesh_init(&surface);
    sn_status st = sn_tet_mesh_surface_adj(&x->mesh, adj, part, &surface, NULL, err);
    if (!st && surface.n_face > 0) {
        st = sn_mesh_check_topology(&topo, &surface, err);
        c->nonmanifold_edges += topo.nonmanifold_edges;
        c->nonmanifold_vertices += topo.nonmanifold_vertices;
        c->bad_faces += !st && !topo.closed;
    }
    sn_tri_mesh_free(&surface);
    return st;
}

sn_status sn_extraction_check_run(sn_extraction_check *out, const sn_extraction *x, const sn_tet_mesh *input,
                                  const sn_run *run, sn_error *err)
{
    sn_extraction_check c = {0};
    int32_t *adj = NULL;
    sn_error why;
    *out = c;
    check_volumes(x, &c);
    sn_status st = sn_tet_mesh_adjacency(&x->mesh, &adj, &why);
    if (st == SN_EINVAL) { /* a face with three tets */
        c.bad_faces = 1;
        *out = c;
        return SN_OK;
    }
    if (st) {
        if (err) *err = why;
        return st;
    }
    if (input) st = check_outside(x, adj, input, &c, err);
    for (int32_t part = -1; part < x->n_tissue && !st; part++) { /* -1: the whole */
        st = sn_run_step(run, "checking", (double)(part + 1) / (x->n_tissue + 1), err);
        if (!st) st = check_part(x, adj, part, &c, err);
    }
    sn_release(adj);
    if (st) return st;
    c.conforming = c.bad_faces == 0;
    c.manifold = c.nonmanifold_edges == 0 && c.nonmanifold_vertices == 0;
    *out = c;
    return SN_OK;
}
