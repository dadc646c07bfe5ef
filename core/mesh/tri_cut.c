#include "mesh/tri_cut.h"

#include "base/alloc.h"
#include "base/array.h"
#include "mesh/cap_bridge.h"
#include "mesh/mesh_check.h"
#include "mesh/predicates.h"

#include <string.h>

/* Places are numbered in one row: the vertices of m, then a point on each edge that crosses the plane. */
typedef struct cutter {
    const sn_tri_mesh *m;
    sn_plane plane;
    double *height;     /* n_vert: above the plane, 0 for vertices that count as on it */
    uint64_t *edge;     /* n_edge: lower vertex << 32 | higher vertex, ascending       */
    double *pos;        /* n_place x 3                                                 */
    int32_t *to;        /* n_place: the place that stands for it; the lowest of equals */
    int32_t *number;    /* n_place: vertex of the result, -1: none                     */
    int32_t *cap_place; /* n_cap_point: places in the plane that kept faces use        */
    double *cap_point;  /* n_cap_point x 2                                             */
    sn_cap_edge *outline;
    int32_t *cap; /* n_cap x 3, of cap points */
    size_t n_edge, n_place;
    int32_t n_cap_point, n_outline, n_cap;
} cutter;

static void cutter_free(cutter *c)
{
    sn_release(c->height);
    sn_release(c->edge);
    sn_release(c->pos);
    sn_release(c->to);
    sn_release(c->number);
    sn_release(c->cap_place);
    sn_release(c->cap_point);
    sn_release(c->outline);
    sn_release(c->cap);
}

static sn_status no_memory(const cutter *c, sn_error *err)
{
    return sn_fail(err, SN_ENOMEM, "cut: no memory for %d faces", c->m->n_face);
}

/* ---- what is where ---- */

static sn_status check_closed(const sn_tri_mesh *m, sn_error *err)
{
    sn_mesh_check topo;
    sn_status st = sn_tri_mesh_validate(m, err);
    if (!st) st = sn_mesh_check_topology(&topo, m, err);
    if (st) return sn_fail_prefix(err, st, "cut: ");
    if (topo.closed) return SN_OK;
    if (topo.boundary_edges > 0)
        return sn_fail(err, SN_EMESH, "cut: the surface is not closed: %d edges have only one face",
                       topo.boundary_edges);
    return sn_fail(err, SN_EMESH, "cut: the surface is not closed: its faces do not all turn the same way");
}

static bool repeats_vertex(const int32_t v[3])
{
    return v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
}

/* Refuses a plane that takes nothing away, or everything. */
static sn_status check_sides(const cutter *c, sn_error *err)
{
    double low = INFINITY, high = -INFINITY;
    bool has_face_in_plane = false;
    for (int32_t f = 0; f < c->m->n_face; f++) {
        const int32_t *v = c->m->face + 3 * (size_t)f;
        double a = c->height[v[0]], b = c->height[v[1]], d = c->height[v[2]];
        low = fmin(low, fmin(a, fmin(b, d)));
        high = fmax(high, fmax(a, fmax(b, d)));
        has_face_in_plane = has_face_in_plane || (a == 0.0 && b == 0.0 && d == 0.0);
    }
    if (high > 0.0 && (low < 0.0 || has_face_in_plane)) return SN_OK;
    return sn_fail(err, SN_EINVAL,
                   "cut: the plane misses the surface, which lies between %g and %g along the normal: "
                   "nothing would be %s",
                   low, high, high > 0.0 ? "cut off" : "left");
}

static sn_status find_heights(cutter *c, sn_error *err)
{
    double near = SN_PLANE_REL * sn_box3_diagonal(sn_tri_mesh_bounds(c->m));
    c->height = SN_NEW(double, c->m->n_vert);
    if (!c->height) return no_memory(c, err);
    for (int32_t v = 0; v < c->m->n_vert; v++) {
        double h = sn_plane_height(&c->plane, sn_tri_mesh_point(c->m, v));
        c->height[v] = fabs(h) <= near ? 0.0 : h;
    }
    return check_sides(c, err);
}

/* ---- points on edges ---- */

static bool crosses(const cutter *c, int32_t u, int32_t v)
{
    return (c->height[u] < 0.0 && c->height[v] > 0.0) || (c->height[u] > 0.0 && c->height[v] < 0.0);
}

static uint64_t edge_key(int32_t u, int32_t v)
{
    return u < v ? (uint64_t)u << 32 | (uint64_t)v : (uint64_t)v << 32 | (uint64_t)u;
}

static sn_status find_edges(cutter *c, sn_error *err)
{
    const int32_t *face = c->m->face;
    size_t n = 0, n_corner = 3 * (size_t)c->m->n_face;
    for (size_t k = 0; k < n_corner; k++) n += crosses(c, face[k], face[k % 3 == 2 ? k - 2 : k + 1]);
    c->edge = SN_NEW(uint64_t, n);
    uint64_t *tmp = SN_NEW(uint64_t, n);
    if (!c->edge || !tmp) {
        sn_release(tmp);
        return no_memory(c, err);
    }
    n = 0;
    for (size_t k = 0; k < n_corner; k++) {
        int32_t u = face[k], v = face[k % 3 == 2 ? k - 2 : k + 1];
        if (crosses(c, u, v)) c->edge[n++] = edge_key(u, v);
    }
    c->n_edge = sn_sort_unique_u64(c->edge, tmp, n);
    c->n_place = (size_t)c->m->n_vert + c->n_edge;
    sn_release(tmp);
    if (c->n_place > INT32_MAX)
        return sn_fail(err, SN_ELIMIT, "cut: %zu vertices are more than 2^31", c->n_place);
    return SN_OK;
}

static int32_t edge_place(const cutter *c, int32_t u, int32_t v)
{
    uint64_t key = edge_key(u, v);
    size_t low = 0, high = c->n_edge;
    while (high - low > 1) {
        size_t mid = (low + high) / 2;
        if (c->edge[mid] <= key)
            low = mid;
        else
            high = mid;
    }
    return c->m->n_vert + (int32_t)low;
}

static bool is_in_plane(const cutter *c, int32_t place)
{
    return place >= c->m->n_vert || c->height[place] == 0.0;
}

static sn_status place_points(cutter *c, sn_error *err)
{
    c->pos = SN_NEW(double, 3 * c->n_place);
    if (!c->pos) return no_memory(c, err);
    for (size_t i = 0; i < c->n_place; i++) {
        bool is_vertex = i < (size_t)c->m->n_vert;
        sn_vec3 p;
        if (is_vertex) {
            p = sn_tri_mesh_point(c->m, (int32_t)i);
        } else {
            uint64_t key = c->edge[i - (size_t)c->m->n_vert];
            int32_t u = (int32_t)(key >> 32), v = (int32_t)(key & UINT32_MAX);
            p = sn_v3_lerp(sn_tri_mesh_point(c->m, u), sn_tri_mesh_point(c->m, v),
                           c->height[u] / (c->height[u] - c->height[v]));
        }
        if (is_in_plane(c, (int32_t)i)) p = sn_plane_project(&c->plane, p);
        sn_v3_store(c->pos + 3 * i, p);
    }
    return SN_OK;
}

/* ---- the plane seen along a coordinate axis: no rounding, and triangles that are apart stay so ---- */

/* Counter-clockwise as seen from the side that is cut off, which is the cap's outside. */
static void flat_point(const cutter *c, size_t place, double out[2])
{
    sn_vec3 n = c->plane.normal, size = sn_v3(fabs(n.x), fabs(n.y), fabs(n.z));
    int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    double along = axis == 0 ? n.x : axis == 1 ? n.y : n.z, s, t;
    sn_drop_axis(sn_v3_load(c->pos + 3 * place), axis, &s, &t);
    out[0] = along < 0.0 ? s : t;
    out[1] = along < 0.0 ? t : s;
}

typedef struct flat_place {
    double p[2];
    int32_t place;
} flat_place;

static int flat_less(const void *a, const void *b)
{
    const flat_place *f = a, *g = b;
    for (int k = 0; k < 2; k++)
        if (f->p[k] != g->p[k]) return f->p[k] < g->p[k] ? -1 : 1;
    return (f->place > g->place) - (f->place < g->place);
}

/* Two edges that leave a vertex just above the plane side by side can meet it in one point. */
static sn_status join_equal(cutter *c, sn_error *err)
{
    size_t n = 0;
    c->to = SN_NEW(int32_t, c->n_place);
    for (size_t i = 0; i < c->n_place; i++) n += is_in_plane(c, (int32_t)i);
    flat_place *flat = SN_NEW(flat_place, n);
    if (!c->to || !flat) {
        sn_release(flat);
        return no_memory(c, err);
    }
    n = 0;
    for (size_t i = 0; i < c->n_place; i++) {
        c->to[i] = (int32_t)i;
        if (!is_in_plane(c, (int32_t)i)) continue;
        flat_point(c, i, flat[n].p);
        flat[n++].place = (int32_t)i;
    }
    sn_sort(flat, n, sizeof *flat, flat_less);
    for (size_t i = 1; i < n; i++)
        if (flat[i].p[0] == flat[i - 1].p[0] && flat[i].p[1] == flat[i - 1].p[1])
            c->to[flat[i].place] = c->to[flat[i - 1].place];
    sn_release(flat);
    return SN_OK;
}

/* ---- what is kept of a face ---- */

/* The corners of the kept part of a face, 0, 3 or 4. */
static int clip(const cutter *c, int32_t face, int32_t corner[4])
{
    const int32_t *v = c->m->face + 3 * (size_t)face;
    int n = 0;
    if (repeats_vertex(v)) return 0;
    if (c->height[v[0]] <= 0.0 && c->height[v[1]] <= 0.0 && c->height[v[2]] <= 0.0) return 0;
    for (int k = 0; k < 3; k++) {
        int32_t a = v[k], b = v[(k + 1) % 3];
        if (c->height[a] >= 0.0) corner[n++] = c->to[a];
        if (crosses(c, a, b)) corner[n++] = c->to[edge_place(c, a, b)];
    }
    return n < 3 ? 0 : n;
}

static double corner_dist(const cutter *c, int32_t a, int32_t b)
{
    return sn_v3_dist(sn_v3_load(c->pos + 3 * (size_t)a), sn_v3_load(c->pos + 3 * (size_t)b));
}

/* Its triangles: a part with four corners is cut along the shorter diagonal; what joined points have closed
 * up is left out. */
static int triangles_of(const cutter *c, int32_t face, int32_t tri[2][3])
{
    int32_t v[4];
    int n = clip(c, face, v), n_tri = 0;
    int at = n == 4 && corner_dist(c, v[1], v[3]) < corner_dist(c, v[0], v[2]) ? 1 : 0;
    for (int k = 0; k < n - 2; k++) {
        const int32_t t[3] = {v[at], v[(at + k + 1) % n], v[(at + k + 2) % n]};
        if (!repeats_vertex(t)) memcpy(tri[n_tri++], t, sizeof t);
    }
    return n_tri;
}

/* ---- the cap ---- */

typedef struct kept_edge {
    int32_t low, high, turn;
} kept_edge;

static int kept_less(const void *a, const void *b)
{
    const kept_edge *e = a, *f = b;
    if (e->low != f->low) return e->low < f->low ? -1 : 1;
    if (e->high != f->high) return e->high < f->high ? -1 : 1;
    return (e->turn > f->turn) - (e->turn < f->turn);
}

/* The edges in the plane of kept faces; fills e unless it is NULL. The cap runs along them the other way. */
static size_t list_kept_edges(const cutter *c, kept_edge *e)
{
    size_t n = 0;
    int32_t tri[2][3];
    for (int32_t f = 0; f < c->m->n_face; f++)
        for (int i = 0, n_tri = triangles_of(c, f, tri); i < n_tri; i++)
            for (int k = 0; k < 3; k++) {
                int32_t a = tri[i][k], b = tri[i][(k + 1) % 3];
                if (!is_in_plane(c, a) || !is_in_plane(c, b)) continue;
                if (e) e[n] = a < b ? (kept_edge){a, b, -1} : (kept_edge){b, a, 1};
                n++;
            }
    return n;
}

/* Each pair of places once, with the sum of its turns. */
static size_t sum_turns(kept_edge *e, size_t n)
{
    size_t kept = 0;
    sn_sort(e, n, sizeof *e, kept_less);
    for (size_t i = 0; i < n; i++) {
        if (kept > 0 && e[kept - 1].low == e[i].low && e[kept - 1].high == e[i].high)
            e[kept - 1].turn += e[i].turn;
        else
            e[kept++] = e[i];
    }
    return kept;
}

/* Numbers the places in the plane that kept faces use: c->number holds the cap's numbers for now. */
static sn_status number_cap(cutter *c, sn_error *err)
{
    int32_t tri[2][3];
    c->number = SN_NEW(int32_t, c->n_place);
    if (!c->number) return no_memory(c, err);
    for (size_t i = 0; i < c->n_place; i++) c->number[i] = -1;
    for (int32_t f = 0; f < c->m->n_face; f++)
        for (int i = 0, n_tri = triangles_of(c, f, tri); i < n_tri; i++)
            for (int k = 0; k < 3; k++)
                if (is_in_plane(c, tri[i][k])) c->number[tri[i][k]] = 0;
    for (size_t i = 0; i < c->n_place; i++)
        if (c->number[i] == 0) c->number[i] = c->n_cap_point++;
    c->cap_place = SN_NEW(int32_t, c->n_cap_point);
    c->cap_point = SN_NEW(double, 2 * (size_t)c->n_cap_point);
    if (!c->cap_place || !c->cap_point) return no_memory(c, err);
    for (size_t i = 0; i < c->n_place; i++) {
        if (c->number[i] < 0) continue;
        c->cap_place[c->number[i]] = (int32_t)i;
        flat_point(c, i, c->cap_point + 2 * (size_t)c->number[i]);
    }
    return SN_OK;
}

static sn_status find_outline(cutter *c, sn_error *err)
{
    size_t n = list_kept_edges(c, NULL);
    kept_edge *e = SN_NEW(kept_edge, n);
    c->outline = SN_NEW(sn_cap_edge, n);
    bool ok = e && c->outline;
    if (ok) {
        (void)list_kept_edges(c, e);
        n = sum_turns(e, n);
        for (size_t i = 0; i < n; i++)
            c->outline[i] = (sn_cap_edge){c->number[e[i].low], c->number[e[i].high], e[i].turn};
        c->n_outline = (int32_t)n;
    }
    sn_release(e);
    return ok ? SN_OK : no_memory(c, err);
}

static sn_status make_cap(cutter *c, sn_error *err)
{
    int32_t where;
    sn_status st = number_cap(c, err);
    if (!st) st = find_outline(c, err);
    if (st) return st;
    st = sn_cap_triangulate(c->cap_point, c->n_cap_point, c->outline, c->n_outline, &c->cap, &c->n_cap,
                            &where, err);
    if (st != SN_EMESH) return st;
    const double *p = c->pos + 3 * (size_t)c->cap_place[where];
    return sn_fail_prefix(err, st, "cut: in the plane, near {%g, %g, %g}: ", p[0], p[1], p[2]);
}

/* ---- the result ---- */

static void use(cutter *c, const int32_t v[3])
{
    for (int k = 0; k < 3; k++) c->number[v[k]] = 0;
}

/* Numbers the places that the result uses; returns its number of vertices and faces. */
static void number_result(cutter *c, int32_t *n_vert, size_t *n_face)
{
    int32_t tri[2][3];
    *n_vert = 0;
    *n_face = (size_t)c->n_cap;
    for (size_t i = 0; i < c->n_place; i++) c->number[i] = -1;
    for (int32_t f = 0; f < c->m->n_face; f++) {
        int n_tri = triangles_of(c, f, tri);
        for (int i = 0; i < n_tri; i++) use(c, tri[i]);
        *n_face += (size_t)n_tri;
    }
    for (size_t i = 0; i < c->n_place; i++)
        if (c->number[i] == 0) c->number[i] = (*n_vert)++;
}

static void put_face(const cutter *c, sn_tri_mesh *out, int32_t i, const int32_t v[3])
{
    for (int k = 0; k < 3; k++) out->face[3 * (size_t)i + (size_t)k] = c->number[v[k]];
}

static void fill_result(const cutter *c, int32_t cap_label, sn_tri_mesh *out, int32_t *from)
{
    int32_t tri[2][3], n = 0;
    for (size_t i = 0; i < c->n_place; i++)
        if (c->number[i] >= 0)
            memcpy(out->pos + 3 * (size_t)c->number[i], c->pos + 3 * i, 3 * sizeof *c->pos);
    for (int32_t f = 0; f < c->m->n_face; f++)
        for (int i = 0, n_tri = triangles_of(c, f, tri); i < n_tri; i++) {
            put_face(c, out, n, tri[i]);
            if (out->label) out->label[n] = c->m->label[f];
            from[n++] = f;
        }
    for (int32_t f = 0; f < c->n_cap; f++) {
        const int32_t *v = c->cap + 3 * (size_t)f;
        put_face(c, out, n, (const int32_t[3]){c->cap_place[v[0]], c->cap_place[v[1]], c->cap_place[v[2]]});
        if (out->label) out->label[n] = cap_label;
        from[n++] = -1;
    }
}

static sn_status build_result(cutter *c, int32_t cap_label, sn_tri_mesh *out, int32_t **from, sn_error *err)
{
    int32_t n_vert;
    size_t n_face;
    number_result(c, &n_vert, &n_face);
    if (n_face > INT32_MAX / 3) return sn_fail(err, SN_ELIMIT, "cut: %zu faces are too many", n_face);
    sn_status st = sn_tri_mesh_reserve(out, n_vert, (int32_t)n_face, err);
    if (st) return st;
    *from = SN_NEW(int32_t, n_face);
    if (c->m->label) out->label = SN_NEW(int32_t, n_face);
    if (!*from || (c->m->label && !out->label)) return no_memory(c, err);
    fill_result(c, cap_label, out, *from);
    return SN_OK;
}

sn_status sn_tri_mesh_cut(const sn_tri_mesh *m, sn_vec3 point, sn_vec3 normal, int32_t cap_label,
                          const sn_run *run, sn_tri_mesh *out, int32_t **from_face, sn_error *err)
{
    cutter c = {.m = m};
    int32_t *from = NULL;
    sn_tri_mesh_free(out);
    if (from_face) *from_face = NULL;
    sn_status st = sn_plane_make(&c.plane, "cut", point, normal, err);
    if (!st) st = sn_run_step(run, "cutting", 0.0, err);
    if (!st) st = check_closed(m, err);
    if (!st) st = find_heights(&c, err);
    if (!st) st = find_edges(&c, err);
    if (!st) st = place_points(&c, err);
    if (!st) st = join_equal(&c, err);
    if (!st) st = sn_run_step(run, "cutting", 0.4, err);
    if (!st) st = make_cap(&c, err);
    if (!st) st = sn_run_step(run, "cutting", 0.8, err);
    if (!st) st = build_result(&c, cap_label, out, &from, err);
    cutter_free(&c);
    if (st) sn_tri_mesh_free(out);
    if (st || !from_face)
        sn_release(from);
    else
        *from_face = from;
    return st;
}
