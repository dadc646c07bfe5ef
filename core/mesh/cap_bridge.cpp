#include "mesh/cap_bridge.h"

#include "base/alloc.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <cstring>
#include <map>
#include <new>
#include <vector>

namespace
{

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
struct Face_info {
    bool is_known = false;
    int32_t winding = 0;
};
using Vertex_base = CGAL::Triangulation_vertex_base_with_info_2<int32_t, Kernel>;
using Face_base =
    CGAL::Triangulation_face_base_with_info_2<Face_info, Kernel,
                                              CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Cdt =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel,
                                               CGAL::Triangulation_data_structure_2<Vertex_base, Face_base>,
                                               CGAL::No_constraint_intersection_tag>;
using Face = Cdt::Face_handle;
using Turns = std::map<std::pair<int32_t, int32_t>, int32_t>;

sn_status crossing(int32_t at, int32_t *where, sn_error *err)
{
    *where = at;
    return sn_fail(err, SN_EMESH, "the outline crosses or touches itself");
}

sn_status insert(Cdt &cdt, const double *point, int32_t n_point, const sn_cap_edge *edge, int32_t n_edge,
                 int32_t *where, sn_error *err)
{
    std::vector<Cdt::Vertex_handle> v(static_cast<size_t>(n_point));
    Face near;
    for (int32_t i = 0; i < n_point; i++) {
        const double *p = point + 2 * static_cast<size_t>(i);
        v[i] = cdt.insert(Cdt::Point(p[0], p[1]), near);
        v[i]->info() = i;
        near = v[i]->face();
    }
    if (cdt.number_of_vertices() != v.size()) return sn_fail(err, SN_EMESH, "two points are equal");
    for (int32_t i = 0; i < n_edge; i++) {
        const sn_cap_edge &e = edge[i];
        try {
            cdt.insert_constraint(v[e.a], v[e.b]);
        } catch (const Cdt::Intersection_of_constraints_exception &) {
            return crossing(e.a, where, err);
        }
        if (!cdt.is_edge(v[e.a], v[e.b])) return crossing(e.a, where, err); /* it runs through a point */
    }
    return SN_OK;
}

/* What the winding number changes by from f to its neighbour across edge i, whose ends run counter-clockwise
 * around f. */
int32_t change_across(const Cdt &cdt, const Turns &turns, Face f, int i)
{
    if (!cdt.is_constrained(Cdt::Edge(f, i))) return 0;
    int32_t a = f->vertex(Cdt::ccw(i))->info(), b = f->vertex(Cdt::cw(i))->info();
    auto forward = turns.find({a, b}), back = turns.find({b, a});
    return (back != turns.end() ? back->second : 0) - (forward != turns.end() ? forward->second : 0);
}

/* Spreads winding numbers from the outside, where they are 0. */
void wind(Cdt &cdt, const sn_cap_edge *edge, int32_t n_edge)
{
    Turns turns;
    for (int32_t i = 0; i < n_edge; i++) turns[{edge[i].a, edge[i].b}] = edge[i].turn;
    std::vector<Face> open{cdt.infinite_face()};
    open[0]->info().is_known = true;
    while (!open.empty()) {
        Face f = open.back();
        open.pop_back();
        for (int i = 0; i < 3; i++) {
            Face g = f->neighbor(i);
            if (g->info().is_known) continue;
            g->info() = {true, f->info().winding + (cdt.is_infinite(f) && cdt.is_infinite(g)
                                                        ? 0
                                                        : change_across(cdt, turns, f, i))};
            open.push_back(g);
        }
    }
}

sn_status collect(const Cdt &cdt, std::vector<int32_t> &out, int32_t *where, sn_error *err)
{
    for (Face f : cdt.finite_face_handles()) {
        int32_t w = f->info().winding;
        if (w == 0) continue;
        if (w < -1 || w > 1) {
            *where = f->vertex(0)->info();
            return sn_fail(err, SN_EMESH, "one shell lies inside another one that turns the same way");
        }
        out.push_back(f->vertex(0)->info());
        out.push_back(f->vertex(w > 0 ? 1 : 2)->info());
        out.push_back(f->vertex(w > 0 ? 2 : 1)->info());
    }
    return SN_OK;
}

sn_status triangulate(const double *point, int32_t n_point, const sn_cap_edge *edge, int32_t n_edge,
                      int32_t **tri, int32_t *n_tri, int32_t *where, sn_error *err)
{
    Cdt cdt;
    std::vector<int32_t> corner;
    sn_status st = insert(cdt, point, n_point, edge, n_edge, where, err);
    if (!st && cdt.dimension() == 2) {
        wind(cdt, edge, n_edge);
        st = collect(cdt, corner, where, err);
    }
    if (st) return st;
    *tri = SN_NEW(int32_t, corner.size());
    if (!*tri) return sn_fail(err, SN_ENOMEM, "no memory for %zu triangles of the cap", corner.size() / 3);
    if (!corner.empty()) std::memcpy(*tri, corner.data(), corner.size() * sizeof(int32_t));
    *n_tri = static_cast<int32_t>(corner.size() / 3);
    return SN_OK;
}

} // namespace

sn_status sn_cap_triangulate(const double *point, int32_t n_point, const sn_cap_edge *edge, int32_t n_edge,
                             int32_t **tri, int32_t *n_tri, int32_t *where, sn_error *err)
{
    *tri = nullptr;
    *n_tri = 0;
    *where = 0;
    try {
        return triangulate(point, n_point, edge, n_edge, tri, n_tri, where, err);
    } catch (const std::bad_alloc &) {
        return sn_fail(err, SN_ENOMEM, "no memory for a cap of %d points", n_point);
    } catch (...) {
        return sn_fail(err, SN_EMESH, "the cap cannot be triangulated");
    }
}
