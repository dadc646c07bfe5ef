#include "mesh/repair_bridge.h"

#include "mesh/exact_points.hpp"

#include <CGAL/Polygon_mesh_processing/bbox.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair.h>
#include <CGAL/Polygon_mesh_processing/repair_self_intersections.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <new>
#include <vector>

namespace PMP = CGAL::Polygon_mesh_processing;

namespace
{

using namespace sn_exact;
using Point = Kernel::Point_3;
using Halfedge = Mesh::Halfedge_index;
using Triple = std::array<size_t, 3>;

constexpr double PULL = 1e-3;     /* of the way to the middle of a vertex's neighbours */
constexpr double MAY_LOSE = 0.05; /* of a component's volume */
constexpr double SHEET = 0.95;    /* a rim of at least this part of its component's size bounds a sheet */

double diagonal(const CGAL::Bbox_3 &b)
{
    return std::hypot(b.xmax() - b.xmin(), b.ymax() - b.ymin(), b.zmax() - b.zmin());
}

/* ---- in and out ---- */

void read_soup(const sn_tri_mesh &m, std::vector<Point> &point, std::vector<Triple> &face)
{
    for (int32_t i = 0; i < m.n_vert; i++) {
        const double *p = m.pos + 3 * static_cast<size_t>(i);
        point.emplace_back(p[0], p[1], p[2]);
    }
    for (int32_t f = 0; f < m.n_face; f++) {
        const int32_t *v = m.face + 3 * static_cast<size_t>(f);
        face.push_back({static_cast<size_t>(v[0]), static_cast<size_t>(v[1]), static_cast<size_t>(v[2])});
    }
}

bool read_mesh(const sn_tri_mesh &m, Mesh &mesh)
{
    std::vector<Point> point;
    std::vector<Triple> face;
    read_soup(m, point, face);
    if (!PMP::is_polygon_soup_a_polygon_mesh(face)) return false;
    PMP::polygon_soup_to_polygon_mesh(point, face, mesh);
    return true;
}

sn_status write_mesh(Mesh &mesh, sn_tri_mesh *out, sn_error *err)
{
    PMP::remove_isolated_vertices(mesh);
    mesh.collect_garbage();
    sn_status st = sn_tri_mesh_reserve(out, static_cast<int32_t>(mesh.number_of_vertices()),
                                       static_cast<int32_t>(mesh.number_of_faces()), err);
    if (st) return st;
    for (Vertex v : mesh.vertices()) {
        const Point &p = mesh.point(v);
        sn_v3_store(out->pos + 3 * static_cast<size_t>(v), sn_vec3{p.x(), p.y(), p.z()});
    }
    size_t k = 0;
    for (Face f : mesh.faces())
        for (Vertex v : CGAL::vertices_around_face(mesh.halfedge(f), mesh))
            out->face[k++] = static_cast<int32_t>(v);
    return SN_OK;
}

/* ---- orientation and holes ---- */

struct Orientation_counter : public PMP::Default_orientation_visitor {
    sn_repair_counts *n; /* CGAL copies the visitor */
    explicit Orientation_counter(sn_repair_counts *counts) : n(counts)
    {
    }
    void duplicated_vertex(std::size_t, std::size_t)
    {
        n->split_vertices++;
    }
    void polygon_orientation_reversed(std::size_t)
    {
        n->turned++;
    }
};

/* Gives each fan around a vertex its own copy, and draws copies at one place apart, towards their neighbours:
 * where they are the surface would touch itself. */
int32_t pull_apart(Mesh &mesh)
{
    int32_t n = static_cast<int32_t>(PMP::duplicate_non_manifold_vertices(mesh));
    std::map<Point, std::vector<Vertex>> place;
    for (Vertex v : mesh.vertices())
        if (!mesh.is_isolated(v)) place[mesh.point(v)].push_back(v);
    for (const auto &at : place) {
        if (at.second.size() < 2) continue;
        for (Vertex v : at.second) {
            Kernel::Vector_3 sum(0, 0, 0);
            int degree = 0;
            for (Vertex w : CGAL::vertices_around_target(mesh.halfedge(v), mesh)) {
                sum = sum + (mesh.point(w) - at.first);
                degree++;
            }
            mesh.point(v) = at.first + (PULL / degree) * sum;
        }
    }
    return n;
}

struct Components {
    Mesh::Property_map<Face, size_t> id;
    std::vector<CGAL::Bbox_3> box;
    std::vector<double> area;
    std::vector<bool> is_open;

    explicit Components(Mesh &mesh)
    {
        id = mesh.add_property_map<Face, size_t>("f:component", 0).first;
        size_t n = PMP::connected_components(mesh, id);
        box.resize(n);
        area.resize(n, 0.0);
        is_open.resize(n, false);
        for (Face f : mesh.faces()) {
            size_t c = id[f];
            area[c] += CGAL::to_double(PMP::face_area(f, mesh));
            for (Halfedge h : CGAL::halfedges_around_face(mesh.halfedge(f), mesh)) {
                box[c] += mesh.point(mesh.target(h)).bbox();
                if (mesh.is_border(mesh.opposite(h))) is_open[c] = true;
            }
        }
    }
};

int32_t remove_crumbs(Mesh &mesh, double least_area)
{
    Components c(mesh);
    std::vector<size_t> crumb;
    for (size_t i = 0; i < c.box.size(); i++)
        if (c.is_open[i] && c.area[i] < least_area) crumb.push_back(i);
    PMP::remove_connected_components(mesh, crumb, c.id);
    mesh.collect_garbage();
    return static_cast<int32_t>(crumb.size());
}

void fill_holes(Mesh &mesh, double hole_size, sn_repair_counts *n)
{
    Components c(mesh);
    std::vector<Halfedge> hole;
    PMP::extract_boundary_cycles(mesh, std::back_inserter(hole));
    for (Halfedge h : hole) {
        CGAL::Bbox_3 rim;
        for (Halfedge g : CGAL::halfedges_around_face(h, mesh)) rim += mesh.point(mesh.target(g)).bbox();
        double size = diagonal(rim), whole = diagonal(c.box[c.id[mesh.face(mesh.opposite(h))]]);
        std::vector<Face> patch;
        if (size <= hole_size && size < SHEET * whole)
            PMP::triangulate_hole(mesh, h, std::back_inserter(patch));
        if (patch.empty()) {
            n->left++;
        } else {
            n->filled++;
            n->added += static_cast<int32_t>(patch.size());
        }
    }
}

sn_status orient_fill(const sn_tri_mesh *in, double hole_size, double crumb_area, sn_tri_mesh *out,
                      sn_repair_counts *n, sn_error *err)
{
    std::vector<Point> point;
    std::vector<Triple> face;
    Orientation_counter counter(n);
    Mesh mesh;
    read_soup(*in, point, face);
    PMP::orient_polygon_soup(point, face, CGAL::parameters::visitor(counter));
    PMP::polygon_soup_to_polygon_mesh(point, face, mesh);
    n->stitched = static_cast<int32_t>(PMP::stitch_borders(mesh));
    n->split_vertices += pull_apart(mesh);
    n->crumbs = remove_crumbs(mesh, crumb_area);
    fill_holes(mesh, hole_size, n);
    return write_mesh(mesh, out, err);
}

/* ---- self-intersections ---- */

struct Part {
    Mesh mesh;
    Exact_points points;
    CGAL::Bbox_3 box;

    explicit Part(const Mesh &m) : mesh(m)
    {
        points.exact = mesh.add_property_map<Vertex, Exact::Point_3>("v:exact").first;
        points.mesh = &mesh;
        for (Vertex v : mesh.vertices()) {
            const Point &p = mesh.point(v);
            points.exact[v] = Exact::Point_3(p.x(), p.y(), p.z());
        }
        box = PMP::bbox(mesh);
    }
    Part(const Part &p) : mesh(p.mesh), box(p.box)
    {
        points.exact = mesh.property_map<Vertex, Exact::Point_3>("v:exact").first;
        points.mesh = &mesh;
    }
    Part &operator=(const Part &) = delete;
};
using Part_ptr = std::unique_ptr<Part>;

/* Unites b into a when they cross; false when they do not, or when the union is not to be had. */
bool unite(Part_ptr &a, const Part &b)
{
    if (!CGAL::do_overlap(a->box, b.box) || !PMP::do_intersect(a->mesh, b.mesh)) return false;
    namespace P = CGAL::parameters;
    Part_ptr x = std::make_unique<Part>(*a);
    Part y(b); /* a union that fails leaves both cut */
    try {
        auto px = P::vertex_point_map(x->points).throw_on_self_intersection(true);
        auto py = P::vertex_point_map(y.points);
        auto po = P::vertex_point_map(x->points);
        if (!PMP::corefine_and_compute_union(x->mesh, y.mesh, x->mesh, px, py, po)) return false;
    } catch (const PMP::Corefinement::Self_intersection_exception &) {
        return false;
    }
    x->mesh.collect_garbage();
    x->box = PMP::bbox(x->mesh);
    a = std::move(x);
    return true;
}

/* CGAL's ways to remove crossings may drop what they cannot sort out. */
bool is_good(const Mesh &mesh, double volume)
{
    return !mesh.is_empty() && CGAL::is_closed(mesh) && !PMP::does_self_intersect(mesh) &&
           std::fabs(PMP::volume(mesh) - volume) <= MAY_LOSE * std::fabs(volume);
}

/* true when the component had crossings of its own and has lost them all; else it stays as it is. Small folds
 * are cut out and filled; where the component passes through itself, what lies inside is cut off. */
bool mend(Mesh &mesh)
{
    if (!PMP::does_self_intersect(mesh)) return false;
    double volume = PMP::volume(mesh);
    Mesh cut = mesh;
    (void)PMP::experimental::remove_self_intersections(cut, CGAL::parameters::preserve_genus(false));
    if (!is_good(cut, volume)) {
        cut = mesh;
        if (!PMP::experimental::autorefine_and_remove_self_intersections(cut)) return false;
    }
    if (!is_good(cut, volume)) return false;
    mesh = cut;
    return true;
}

sn_status untangle(const sn_tri_mesh *in, sn_tri_mesh *out, sn_repair_counts *n, sn_error *err)
{
    Mesh whole;
    if (!read_mesh(*in, whole))
        return sn_fail(err, SN_EMESH, "self-intersections: the surface is not manifold");
    std::vector<Mesh> component;
    PMP::split_connected_components(whole, component);
    std::vector<Part_ptr> part;
    for (Mesh &m : component) {
        n->mended += mend(m);
        m.collect_garbage();
        part.push_back(std::make_unique<Part>(m));
    }
    for (size_t i = 0; i < part.size(); i++)
        for (size_t j = i + 1; j < part.size();) {
            if (!unite(part[i], *part[j])) {
                j++;
                continue;
            }
            n->unions++;
            part.erase(part.begin() + static_cast<std::ptrdiff_t>(j));
            j = i + 1; /* what was apart from the smaller part may cross the larger one */
        }
    Mesh all;
    for (Part_ptr &p : part) CGAL::copy_face_graph(p->mesh, all);
    (void)pull_apart(all);
    return write_mesh(all, out, err);
}

template <typename Fn> sn_status guarded(const char *what, sn_error *err, Fn fn)
{
    try {
        return fn();
    } catch (const std::bad_alloc &) {
        return sn_fail(err, SN_ENOMEM, "%s: no memory", what);
    } catch (const std::exception &e) {
        return sn_fail(err, SN_EMESH, "%s: %s", what, e.what());
    } catch (...) {
        return sn_fail(err, SN_EMESH, "%s failed", what);
    }
}

} // namespace

sn_status sn_bridge_orient_fill(const sn_tri_mesh *in, double hole_size, double crumb_area, sn_tri_mesh *out,
                                sn_repair_counts *n, sn_error *err)
{
    return guarded("orienting and filling holes", err,
                   [&] { return orient_fill(in, hole_size, crumb_area, out, n, err); });
}

sn_status sn_bridge_untangle(const sn_tri_mesh *in, sn_tri_mesh *out, sn_repair_counts *n, sn_error *err)
{
    return guarded("self-intersections", err, [&] { return untangle(in, out, n, err); });
}
