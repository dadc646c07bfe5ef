/* exact_points.hpp - a CGAL surface mesh with exact points beside its doubles: what the bridges cut and unite
 * with. */
#ifndef SN_MESH_EXACT_POINTS_HPP
#define SN_MESH_EXACT_POINTS_HPP

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

namespace sn_exact
{

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Face = Mesh::Face_index;
using Vertex = Mesh::Vertex_index;
using Exact_map = Mesh::Property_map<Vertex, Exact::Point_3>;

/* Points that CGAL reads and writes exactly; the mesh's own double points follow. */
struct Exact_points {
    typedef boost::read_write_property_map_tag category;
    typedef Exact::Point_3 value_type;
    typedef value_type reference;
    typedef Vertex key_type;
    Exact_map exact;
    Mesh *mesh;
    friend reference get(const Exact_points &m, key_type v)
    {
        return m.exact[v];
    }
    friend void put(const Exact_points &m, key_type v, const value_type &p)
    {
        CGAL::Cartesian_converter<Exact, Kernel> round;
        m.exact[v] = p;
        m.mesh->point(v) = round(p);
    }
};

} // namespace sn_exact

#endif
