#include "tetra/corefine_bridge.h"

#include "base/alloc.h"
#include "mesh/exact_points.hpp"

#include <CGAL/Polygon_mesh_processing/corefinement.h>

#include <map>
#include <new>
#include <vector>

namespace PMP = CGAL::Polygon_mesh_processing;

namespace
{

using namespace sn_exact;
using Label_map = Mesh::Property_map<Face, int32_t>;

/* Carries face labels through the cuts. */
struct Label_visitor : public PMP::Corefinement::Default_visitor<Mesh> {
    std::map<const Mesh *, Label_map> *labels;
    int32_t current = 0;
    void before_subface_creations(Face f, Mesh &m)
    {
        current = labels->at(&m)[f];
    }
    void after_subface_created(Face f, Mesh &m)
    {
        labels->at(&m)[f] = current;
    }
    void after_face_copy(Face from, Mesh &m_from, Face to, Mesh &m_to)
    {
        labels->at(&m_to)[to] = labels->at(&m_from)[from];
    }
};

struct Labelled {
    Mesh mesh;
    Label_map label;
    Exact_points points;

    Labelled()
    {
        label = mesh.add_property_map<Face, int32_t>("f:label", 0).first;
        points.exact = mesh.add_property_map<Vertex, Exact::Point_3>("v:exact").first;
        points.mesh = &mesh;
    }
    Labelled(const Labelled &) = delete;
    Labelled &operator=(const Labelled &) = delete;

    bool fill(const sn_tri_mesh &m, int32_t id)
    {
        std::vector<Vertex> v(static_cast<size_t>(m.n_vert));
        for (int32_t i = 0; i < m.n_vert; i++) {
            const double *p = m.pos + 3 * static_cast<size_t>(i);
            v[i] = mesh.add_vertex(Kernel::Point_3(p[0], p[1], p[2]));
            points.exact[v[i]] = Exact::Point_3(p[0], p[1], p[2]);
        }
        for (int32_t f = 0; f < m.n_face; f++) {
            const int32_t *c = m.face + 3 * static_cast<size_t>(f);
            Face added = mesh.add_face(v[c[0]], v[c[1]], v[c[2]]);
            if (added == Mesh::null_face()) return false;
            label[added] = id;
        }
        return true;
    }
};

bool boolean(Labelled &a, Labelled &b, bool subtract)
{
    std::map<const Mesh *, Label_map> labels{{&a.mesh, a.label}, {&b.mesh, b.label}};
    Label_visitor visitor;
    visitor.labels = &labels;
    namespace P = CGAL::parameters;
    auto pa = P::vertex_point_map(a.points).visitor(visitor).throw_on_self_intersection(true);
    auto pb = P::vertex_point_map(b.points);
    auto po = P::vertex_point_map(a.points);
    return subtract ? PMP::corefine_and_compute_difference(a.mesh, b.mesh, a.mesh, pa, pb, po)
                    : PMP::corefine_and_compute_union(a.mesh, b.mesh, a.mesh, pa, pb, po);
}

sn_status export_mesh(const Labelled &l, sn_tri_mesh *out, sn_error *err)
{
    sn_status st = sn_tri_mesh_reserve(out, static_cast<int32_t>(l.mesh.number_of_vertices()),
                                       static_cast<int32_t>(l.mesh.number_of_faces()), err);
    if (st) return st;
    std::map<Vertex, int32_t> number;
    int32_t n = 0;
    for (Vertex v : l.mesh.vertices()) {
        const Kernel::Point_3 &p = l.mesh.point(v);
        sn_v3_store(out->pos + 3 * static_cast<size_t>(n), sn_vec3{p.x(), p.y(), p.z()});
        number[v] = n++;
    }
    out->label = SN_NEW(int32_t, out->n_face);
    if (!out->label) return sn_fail(err, SN_ENOMEM, "union of bones: no memory");
    size_t k = 0, f = 0;
    for (Face face : l.mesh.faces()) {
        for (Vertex v : CGAL::vertices_around_face(l.mesh.halfedge(face), l.mesh)) out->face[k++] = number[v];
        out->label[f++] = l.label[face];
    }
    return SN_OK;
}

sn_status corefine(const sn_tri_mesh *skin, const sn_tri_mesh *const *bone, int32_t n_bone, sn_tri_mesh *out,
                   sn_error *err)
{
    Labelled all;
    if (n_bone > 0 && !all.fill(*bone[0], 1)) return sn_fail(err, SN_EMESH, "bone 1: not manifold");
    for (int32_t i = 1; i < n_bone; i++) {
        Labelled one;
        if (!one.fill(*bone[i], 1 + i)) return sn_fail(err, SN_EMESH, "bone %d: not manifold", i + 1);
        if (!boolean(all, one, false))
            return sn_fail(err, SN_EMESH, "union with bone %d: not manifold", i + 1);
    }
    if (!skin) return export_mesh(all, out, err);
    Labelled body;
    if (!body.fill(*skin, 0)) return sn_fail(err, SN_EMESH, "skin: not manifold");
    if (n_bone > 0 && !boolean(body, all, true))
        return sn_fail(err, SN_EMESH, "skin minus bones: not manifold");
    return export_mesh(body, out, err);
}

} // namespace

sn_status sn_corefine(const sn_tri_mesh *skin, const sn_tri_mesh *const *bone, int32_t n_bone,
                      sn_tri_mesh *out, sn_error *err)
{
    try {
        return corefine(skin, bone, n_bone, out, err);
    } catch (const PMP::Corefinement::Self_intersection_exception &) {
        return sn_fail(err, SN_EMESH, "a surface crosses itself where it meets another");
    } catch (const std::bad_alloc &) {
        return sn_fail(err, SN_ENOMEM, "union of bones: no memory");
    } catch (const std::exception &e) {
        return sn_fail(err, SN_EMESH, "union of bones: %s", e.what());
    } catch (...) {
        return sn_fail(err, SN_EMESH, "union of bones failed");
    }
}
