#include "mesh/repair_bridge.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include <algorithm>
#include <array>
#include <new>
#include <vector>

namespace
{

namespace Wraps = CGAL::Alpha_wraps_3::internal;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Points = std::vector<Kernel::Point_3>;
using Faces = std::vector<std::array<size_t, 3>>;

/* The faces to wrap, and how the wrap adapts to them. */
struct Oracle : public Wraps::Triangle_soup_oracle<Kernel> {
    double sq_least, sq_far;
    double sq_short; /* a facet with corners at the offset and no longer edge is not far */
    explicit Oracle(const sn_wrap_sizes &w)
        : Wraps::Triangle_soup_oracle<Kernel>(w.alpha, Kernel()), sq_least(w.least * w.least),
          sq_far(w.far * w.far)
    {
        const double spare = std::max(0.0, w.far - w.offset);
        sq_short = 3.0 * spare * spare; /* its center is longest / sqrt(3) from a corner, at most */
    }
};

} // namespace

/* CGAL's wrap enters through a facet where a ball of radius alpha passes. This one enters also where only a
 * smaller ball passes when the facet is far from the input: fine where it bridges a gap, coarse elsewhere.
 * The smallest ball stays above a bound, which is what the proof of termination needs. */
template <> bool CGAL::Alpha_wraps_3::internal::Alpha_wrap_3<Oracle>::is_traversable(const Facet &f) const
{
    if (less_squared_radius_of_min_empty_sphere(m_sq_alpha, f, m_dt)) return true;
    if (!(m_oracle.sq_least < m_sq_alpha)) return false;
    const Point_3 &a = m_dt.point(f.first, (f.second + 1) & 3), &b = m_dt.point(f.first, (f.second + 2) & 3);
    const Point_3 &c = m_dt.point(f.first, (f.second + 3) & 3);
    const double longest = std::max({squared_distance(a, b), squared_distance(b, c), squared_distance(c, a)});
    if (longest <= m_oracle.sq_short) return false;
    auto ball = geom_traits().construct_ball_3_object();
    bool is_far = false;
    for (const Point_3 &p : {centroid(a, b, c), midpoint(a, b), midpoint(b, c), midpoint(c, a)})
        is_far = is_far || !m_oracle.do_intersect(ball(p, m_oracle.sq_far));
    if (!is_far) return false;
    return less_squared_radius_of_min_empty_sphere(m_oracle.sq_least, f, m_dt);
}

namespace
{

sn_status wrap(const sn_tri_mesh *in, const sn_wrap_sizes *w, sn_tri_mesh *out, sn_error *err)
{
    Points point;
    Faces face;
    for (int32_t i = 0; i < in->n_vert; i++) {
        const double *p = in->pos + 3 * static_cast<size_t>(i);
        point.emplace_back(p[0], p[1], p[2]);
    }
    for (int32_t f = 0; f < in->n_face; f++) {
        const int32_t *v = in->face + 3 * static_cast<size_t>(f);
        face.push_back({static_cast<size_t>(v[0]), static_cast<size_t>(v[1]), static_cast<size_t>(v[2])});
    }
    Mesh mesh;
    Oracle oracle(*w);
    oracle.add_triangle_soup(point, face);
    Wraps::Alpha_wrap_3<Oracle> wrapper(oracle);
    wrapper(w->alpha, w->offset, mesh);
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

sn_status sn_bridge_wrap(const sn_tri_mesh *in, const sn_wrap_sizes *w, sn_tri_mesh *out, sn_error *err)
{
    try {
        return wrap(in, w, out, err);
    } catch (const std::bad_alloc &) {
        return sn_fail(err, SN_ENOMEM, "wrapping: no memory");
    } catch (const std::exception &e) {
        return sn_fail(err, SN_EMESH, "wrapping: %s", e.what());
    } catch (...) {
        return sn_fail(err, SN_EMESH, "wrapping failed");
    }
}
