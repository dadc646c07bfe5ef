#include "mesh/repair_bridge.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include <array>
#include <new>
#include <vector>

namespace
{

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

sn_status wrap(const sn_tri_mesh *in, double alpha, double offset, sn_tri_mesh *out, sn_error *err)
{
    std::vector<Kernel::Point_3> point;
    std::vector<std::array<size_t, 3>> face;
    for (int32_t i = 0; i < in->n_vert; i++) {
        const double *p = in->pos + 3 * static_cast<size_t>(i);
        point.emplace_back(p[0], p[1], p[2]);
    }
    for (int32_t f = 0; f < in->n_face; f++) {
        const int32_t *v = in->face + 3 * static_cast<size_t>(f);
        face.push_back({static_cast<size_t>(v[0]), static_cast<size_t>(v[1]), static_cast<size_t>(v[2])});
    }
    Mesh mesh;
    CGAL::alpha_wrap_3(point, face, alpha, offset, mesh);
    mesh.collect_garbage();
    sn_status st = sn_tri_mesh_reserve(out, static_cast<int32_t>(mesh.number_of_vertices()),
                                       static_cast<int32_t>(mesh.number_of_faces()), err);
    if (st) return st;
    for (Mesh::Vertex_index v : mesh.vertices()) {
        const Kernel::Point_3 &p = mesh.point(v);
        sn_v3_store(out->pos + 3 * static_cast<size_t>(v), sn_vec3{p.x(), p.y(), p.z()});
    }
    size_t k = 0;
    for (Mesh::Face_index f : mesh.faces())
        for (Mesh::Vertex_index v : CGAL::vertices_around_face(mesh.halfedge(f), mesh))
            out->face[k++] = static_cast<int32_t>(v);
    return SN_OK;
}

} // namespace

sn_status sn_bridge_wrap(const sn_tri_mesh *in, double alpha, double offset, sn_tri_mesh *out, sn_error *err)
{
    try {
        return wrap(in, alpha, offset, out, err);
    } catch (const std::bad_alloc &) {
        return sn_fail(err, SN_ENOMEM, "wrapping: no memory");
    } catch (const std::exception &e) {
        return sn_fail(err, SN_EMESH, "wrapping: %s", e.what());
    } catch (...) {
        return sn_fail(err, SN_EMESH, "wrapping failed");
    }
}
