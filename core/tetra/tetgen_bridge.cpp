#include "tetra/tetgen_bridge.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <locale.h>
#include <new>

#define TETLIBRARY
#include <tetgen.h>

namespace
{

template <class T> T *copy_array(const T *from, size_t n)
{
    T *p = static_cast<T *>(malloc((n ? n : 1) * sizeof(T)));
    if (!p) throw std::bad_alloc();
    if (n) memcpy(p, from, n * sizeof(T));
    return p;
}

/* tetgenio frees its arrays with delete[]: everything it owns is made with new[]. */
void fill_input(tetgenio &in, const sn_tri_mesh &s, const double *hole, int32_t n_hole)
{
    in.firstnumber = 0;
    in.numberofpoints = s.n_vert;
    in.pointlist = new REAL[3 * static_cast<size_t>(s.n_vert)];
    memcpy(in.pointlist, s.pos, 3 * static_cast<size_t>(s.n_vert) * sizeof(double));
    in.numberoffacets = s.n_face;
    in.facetlist = new tetgenio::facet[static_cast<size_t>(s.n_face)];
    in.facetmarkerlist = new int[static_cast<size_t>(s.n_face)];
    for (int32_t f = 0; f < s.n_face; f++) {
        tetgenio::facet *facet = &in.facetlist[f];
        tetgenio::init(facet);
        facet->numberofpolygons = 1;
        facet->polygonlist = new tetgenio::polygon[1];
        tetgenio::polygon *p = facet->polygonlist;
        tetgenio::init(p);
        p->numberofvertices = 3;
        p->vertexlist = new int[3];
        for (int k = 0; k < 3; k++) p->vertexlist[k] = s.face[3 * static_cast<size_t>(f) + k];
        in.facetmarkerlist[f] = 1 + (s.label ? s.label[f] : 0);
    }
    in.numberofholes = n_hole;
    if (n_hole > 0) {
        in.holelist = new REAL[3 * static_cast<size_t>(n_hole)];
        memcpy(in.holelist, hole, 3 * static_cast<size_t>(n_hole) * sizeof(double));
    }
}

void read_output(const tetgenio &io, sn_tetgen_result *out)
{
    out->n_vert = io.numberofpoints;
    out->n_tet = io.numberoftetrahedra;
    out->n_face = io.numberoftrifaces;
    out->pos = copy_array(io.pointlist, 3 * static_cast<size_t>(out->n_vert));
    out->tet = copy_array(io.tetrahedronlist, 4 * static_cast<size_t>(out->n_tet));
    out->face = copy_array(io.trifacelist, 3 * static_cast<size_t>(out->n_face));
    out->face_label = copy_array(io.trifacemarkerlist, static_cast<size_t>(out->n_face));
    for (int32_t f = 0; f < out->n_face; f++) out->face_label[f] -= 1;
}

/* TetGen asks a plain function whether a tet is too large. */
struct size_bound {
    const sn_sizing *sizing;
    double volume;
};
thread_local size_bound bound;

bool is_too_large(REAL *a, REAL *b, REAL *c, REAL *d, REAL *, REAL)
{
    sn_vec3 o = sn_v3_load(a), p = sn_v3_sub(sn_v3_load(b), o), q = sn_v3_sub(sn_v3_load(c), o),
            r = sn_v3_sub(sn_v3_load(d), o);
    double volume = std::fabs(sn_v3_det(p, q, r)) / 6.0;
    double length = sn_sizing_at(bound.sizing, sn_v3_mad(o, 0.25, sn_v3_add(sn_v3_add(p, q), r)));
    return volume > bound.volume * length * length * length;
}

const char *reason(int code)
{
    switch (code) {
    case 1:
        return "out of memory";
    case 2:
        return "an internal error";
    case 3:
        return "faces that cross each other";
    case 4:
        return "features smaller than its tolerance";
    case 5:
        return "two faces that almost lie on each other";
    case 10:
        return "unusable input";
    default:
        return "an unknown error";
    }
}

} // namespace

void sn_tetgen_result_free(sn_tetgen_result *r)
{
    free(r->pos);
    free(r->tet);
    free(r->face);
    free(r->face_label);
    memset(r, 0, sizeof *r);
}

sn_status sn_tetgen(const sn_tri_mesh *surface, const double *hole, int32_t n_hole,
                    const sn_tetgen_options *opt, const sn_sizing *sizing, sn_tetgen_result *out,
                    sn_error *err)
{
    char switches[128];
    memset(out, 0, sizeof *out);
    int n = snprintf(switches, sizeof switches, "pzQq%.6f/%.6f", opt->radius_edge, opt->min_dihedral_deg);
    if (opt->max_volume > 0.0)
        (void)snprintf(switches + n, sizeof switches - static_cast<size_t>(n), "a%.17f", opt->max_volume);
    try {
        tetgenio in, result;
        fill_input(in, *surface, hole, n_hole);
        bound = {sizing, opt->size_volume};
        if (sizing) in.tetunsuitable = is_too_large;
        tetrahedralize(switches, &in, &result);
        read_output(result, out);
        return SN_OK;
    } catch (int code) {
        sn_tetgen_result_free(out);
        return sn_fail(err, code == 1 ? SN_ENOMEM : SN_EMESH, "TetGen stopped at %s (code %d)", reason(code),
                       code);
    } catch (const std::bad_alloc &) {
        sn_tetgen_result_free(out);
        return sn_fail(err, SN_ENOMEM, "TetGen ran out of memory");
    } catch (...) {
        sn_tetgen_result_free(out);
        return sn_fail(err, SN_EMESH, "TetGen failed");
    }
}
