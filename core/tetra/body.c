#include "tetra/body.h"

#include "base/alloc.h"
#include "base/plane.h"
#include "mesh/bvh.h"
#include "mesh/mesh_check.h"
#include "tetra/body_private.h"

#include <stdio.h>
#include <string.h>

#define TOUCH_REL 1e-9 /* of the skin's box diagonal: nearer than that is on the skin */
/* Corners lie on this grid of the unit box. What rounding set apart, as 0.1 + 0.2 and 0.3, is made equal so:
 * TetGen hangs or crashes in gaps of 1e-17. */
#define SNAP_GRID 0x1p-34

void sn_body_init(sn_body *b)
{
    memset(b, 0, sizeof *b);
}

void sn_body_free(sn_body *b)
{
    sn_tet_mesh_free(&b->mesh);
    sn_release(b->across);
    sn_body_init(b);
}

static sn_status check_positive(const char *name, double value, sn_error *err)
{
    if (value == 0.0 || (value > 0.0 && isfinite(value))) return SN_OK;
    return sn_fail(err, SN_EINVAL, "tetrahedralize: %s is %g, need > 0", name, value);
}

sn_status sn_body_defaults(const sn_body_options *opt, const sn_tri_mesh *skin, sn_body_options *out,
                           sn_error *err)
{
    sn_status st = check_positive("edge_length", opt->edge_length, err);
    if (!st) st = check_positive("bone_edge_length", opt->bone_edge_length, err);
    if (!st) st = check_positive("max_volume", opt->max_volume, err);
    if (!st) st = check_positive("time_limit", opt->time_limit, err);
    if (!st && opt->radius_edge != 0.0 && !(opt->radius_edge >= 1.1 && isfinite(opt->radius_edge)))
        st = sn_fail(err, SN_EINVAL, "tetrahedralize: radius_edge is %g, need >= 1.1", opt->radius_edge);
    sn_plane plane;
    if (!st && opt->has_cut) st = sn_plane_make(&plane, "cut", opt->cut_point, opt->cut_normal, err);
    if (st) return st;
    *out = *opt;
    if (out->edge_length == 0.0) out->edge_length = sn_box3_diagonal(sn_tri_mesh_bounds(skin)) / 80.0;
    if (out->bone_edge_length == 0.0) out->bone_edge_length = out->edge_length;
    double longest = opt->sizing ? SN_BODY_COARSEST * out->edge_length : out->edge_length;
    if (out->max_volume == 0.0) out->max_volume = SN_BODY_SIZE_VOLUME * pow(longest, 3.0);
    if (out->radius_edge == 0.0) out->radius_edge = 1.414;
    if (out->time_limit == 0.0) out->time_limit = 300.0;
    if (out->memory_limit == 0) out->memory_limit = (size_t)6 << 30;
    return SN_OK;
}

static sn_status fail_open(const sn_mesh_check *c, const char *kind, const char *name, sn_error *err)
{
    if (c->boundary_edges)
        return sn_fail(err, SN_EMESH, "%s%s is not closed: %d boundary edges; need a closed surface", kind,
                       name, c->boundary_edges);
    if (c->nonmanifold_edges)
        return sn_fail(err, SN_EMESH, "%s%s is not manifold: %d edges with more than two faces", kind, name,
                       c->nonmanifold_edges);
    if (!c->oriented)
        return sn_fail(err, SN_EMESH,
                       "%s%s has neighbouring faces that turn opposite ways; need one orientation", kind,
                       name);
    return sn_fail(err, SN_EMESH, "%s%s is not a closed manifold surface", kind, name);
}

static void turn_inside_out(sn_tri_mesh *m)
{
    for (int32_t f = 0; f < m->n_face; f++) {
        int32_t *v = m->face + 3 * (size_t)f, swap = v[1];
        v[1] = v[2];
        v[2] = swap;
    }
}

/* Rounds to multiples of grid (a power of two). */
static void snap(sn_tri_mesh *m, double grid)
{
    for (size_t k = 0; k < 3 * (size_t)m->n_vert; k++) m->pos[k] = round(m->pos[k] / grid) * grid;
}

/* Components that turn inwards although they lie in nothing are the usual export mistake: only a surface
 * whose whole volume is negative is turned. */
sn_status sn_body_prepare(const sn_tri_mesh *in, const char *kind, const char *name, double grid,
                          const sn_run *run, sn_tri_mesh *out, int32_t crossing[2], sn_error *err)
{
    sn_mesh_check c;
    sn_status st = sn_tri_mesh_validate(in, err);
    if (st) return sn_fail_prefix(err, SN_EMESH, "%s%s: ", kind, name);
    st = sn_tri_mesh_copy(out, in, err);
    if (!st) snap(out, grid);
    if (!st) st = sn_tri_mesh_weld(out, NULL, err);
    if (!st) st = sn_mesh_check_run(&c, out, run, err);
    if (st) return st;
    if (!c.closed || !c.oriented || c.nonmanifold_edges) return fail_open(&c, kind, name, err);
    double volume = sn_tri_mesh_volume(out);
    if (volume == 0.0) return sn_fail(err, SN_EMESH, "%s%s encloses no volume", kind, name);
    if (volume < 0.0) turn_inside_out(out);
    crossing[0] = c.first_pair[0];
    crossing[1] = c.first_pair[1];
    return SN_OK;
}

/* Strictly inside: a bone that touches the skin from outside has corners on it. */
static bool is_within(const sn_bvh *skin, sn_vec3 p, double margin)
{
    return sn_bvh_contains(skin, p) && sn_bvh_closest(skin, p).dist > margin;
}

/* Some vertex or face centre of the bone lies inside the skin; *pokes: some vertex lies outside. */
static bool bone_is_inside(const sn_bvh *skin, const sn_tri_mesh *bone, bool *pokes)
{
    double margin = TOUCH_REL * sn_box3_diagonal(sn_tri_mesh_bounds(sn_bvh_mesh(skin)));
    bool inside = false;
    *pokes = false;
    for (int32_t v = 0; v < bone->n_vert; v++) {
        sn_vec3 p = sn_tri_mesh_point(bone, v);
        if (!sn_bvh_contains(skin, p))
            *pokes = true;
        else if (!inside)
            inside = is_within(skin, p, margin);
    }
    for (int32_t f = 0; f < bone->n_face && !inside; f++) {
        const int32_t *v = bone->face + 3 * (size_t)f;
        sn_vec3 c = sn_v3_add(sn_v3_add(sn_tri_mesh_point(bone, v[0]), sn_tri_mesh_point(bone, v[1])),
                              sn_tri_mesh_point(bone, v[2]));
        inside = is_within(skin, sn_v3_scale(1.0 / 3.0, c), margin);
    }
    return inside;
}

static bool edges_hit(const sn_bvh *b, const sn_tri_mesh *m)
{
    sn_ray_hit hit;
    for (int32_t i = 0; i < 3 * m->n_face; i++) {
        sn_vec3 p = sn_tri_mesh_point(m, m->face[i]),
                q = sn_tri_mesh_point(m, m->face[i % 3 == 2 ? i - 2 : i + 1]);
        if (sn_bvh_ray_first(b, p, sn_v3_sub(q, p), 1.0, &hit)) return true;
    }
    return false;
}

/* A bone with neither a corner nor a face centre in the skin: a long one may still run through it, a large
 * one hold it. */
static sn_status check_overlap(const sn_bvh *skin, const sn_tri_mesh *bone, const char *name, sn_error *err)
{
    sn_bvh *b = NULL;
    sn_status st = sn_bvh_create(&b, bone, err);
    if (st) return st;
    if (!edges_hit(skin, bone) && !edges_hit(b, sn_bvh_mesh(skin))) {
        if (sn_bvh_contains(b, sn_tri_mesh_point(sn_bvh_mesh(skin), 0)))
            st = sn_fail(err, SN_EMESH, "bone '%s' encloses the whole skin and leaves no soft tissue", name);
        else
            st = sn_fail(err, SN_EMESH, "bone '%s' lies outside the skin: no part of it is inside", name);
    }
    sn_bvh_destroy(b);
    return st;
}

static sn_status prepare_bones(const sn_bvh *skin, const sn_named_surface *bone, int32_t n_bone, double grid,
                               const sn_run *run, sn_tri_mesh *clean, bool *exact, sn_notes *notes,
                               sn_error *err)
{
    for (int32_t i = 0; i < n_bone; i++) {
        int32_t crossing[2];
        char name[128];
        (void)snprintf(name, sizeof name, " '%s'", bone[i].name);
        sn_status st = sn_body_prepare(bone[i].mesh, "bone", name, grid, run, &clean[i], crossing, err);
        if (st) return st;
        bool pokes;
        if (!bone_is_inside(skin, &clean[i], &pokes)) st = check_overlap(skin, &clean[i], bone[i].name, err);
        if (st) return st;
        if (pokes)
            sn_notes_add(notes, "bone '%s' pokes through the skin: what is outside is cut off", bone[i].name);
        if (crossing[0] >= 0) {
            sn_notes_add(notes, "bone '%s' crosses itself (faces %d and %d): the surfaces are resampled",
                         bone[i].name, crossing[0] + 1, crossing[1] + 1);
            *exact = false;
        }
    }
    return SN_OK;
}

static sn_status prepare_skin(const sn_tri_mesh *in, const sn_run *run, sn_tri_mesh *out, sn_error *err)
{
    int32_t crossing[2];
    sn_status st = sn_body_prepare(in, "skin", "", SNAP_GRID, run, out, crossing, err);
    if (!st && crossing[0] >= 0)
        st = sn_fail(err, SN_EMESH,
                     "skin crosses itself: faces %d and %d; need a surface without self-intersections",
                     crossing[0] + 1, crossing[1] + 1);
    return st;
}

/* Dihedral angles of all tets, in degrees. */
static void measure_shape(const sn_tet_mesh *m, sn_body_report *r)
{
    double lo = 180.0, hi = 0.0;
    int64_t below = 0;
    for (int32_t t = 0; t < m->n_tet; t++) {
        sn_vec3 n[4];
        double tet_lo = 180.0;
        for (int k = 0; k < 4; k++) {
            const int *f = sn_tet_face[k];
            const int32_t *v = m->tet + 4 * (size_t)t;
            sn_vec3 a = sn_tet_mesh_point(m, v[f[0]]);
            n[k] = sn_v3_unit(sn_v3_cross(sn_v3_sub(sn_tet_mesh_point(m, v[f[1]]), a),
                                          sn_v3_sub(sn_tet_mesh_point(m, v[f[2]]), a)));
        }
        for (int e = 0; e < 6; e++) {
            double c = -sn_v3_dot(n[sn_tet_edge[e][0]], n[sn_tet_edge[e][1]]);
            double angle = acos(fmin(1.0, fmax(-1.0, c))) * (180.0 / 3.14159265358979323846);
            tet_lo = fmin(tet_lo, angle);
            hi = fmax(hi, angle);
        }
        lo = fmin(lo, tet_lo);
        below += tet_lo < 10.0;
    }
    r->min_dihedral_deg = lo;
    r->max_dihedral_deg = hi;
    r->share_below_10_deg = m->n_tet ? (double)below / m->n_tet : 0.0;
}

/* Boundary and tets. Bones a rounding error apart cross nothing, yet TetGen stops or crashes at them:
 * sampling closes such gaps. */
static sn_status mesh_between(const sn_tri_mesh *skin, const sn_tri_mesh *const *bone, int32_t n_bone,
                              bool exact, const sn_body_options *opt, const sn_run *run, sn_body *out,
                              sn_body_report *report, sn_notes *notes, sn_error *err)
{
    sn_tri_mesh surface;
    sn_error why;
    sn_tri_mesh_init(&surface);
    double start = sn_clock();
    sn_status st = sn_body_surface(skin, bone, n_bone, exact, opt, run, &surface, report, notes, &why);
    report->seconds_surface = sn_clock() - start;
    if (!st) st = sn_body_tets(&surface, opt, run, out, report, &why);
    if (st == SN_EMESH && surface.n_face > 0 && !report->was_resampled) {
        sn_notes_add(notes, "%s: the surfaces are resampled", why.msg);
        start = sn_clock();
        st = sn_body_surface(skin, bone, n_bone, false, opt, run, &surface, report, notes, &why);
        report->seconds_surface += sn_clock() - start;
        if (!st) st = sn_body_tets(&surface, opt, run, out, report, &why);
    }
    if (st && err) *err = why;
    sn_tri_mesh_free(&surface);
    return st;
}

static sn_status build(const sn_tri_mesh *skin, const sn_named_surface *bone, int32_t n_bone,
                       sn_tri_mesh *clean, const sn_body_options *opt, const sn_run *run, sn_body *out,
                       sn_body_report *report, sn_notes *notes, sn_error *err)
{
    sn_bvh *bvh = NULL;
    const sn_tri_mesh **ptr = SN_NEW(const sn_tri_mesh *, n_bone);
    bool exact = true;
    sn_status st = ptr ? sn_bvh_create(&bvh, skin, err) : sn_fail(err, SN_ENOMEM, "body: no memory");
    if (!st) st = prepare_bones(bvh, bone, n_bone, SNAP_GRID, run, clean, &exact, notes, err);
    for (int32_t i = 0; !st && i < n_bone; i++) ptr[i] = &clean[i];
    if (!st) st = mesh_between(skin, ptr, n_bone, exact, opt, run, out, report, notes, err);
    sn_bvh_destroy(bvh);
    sn_release(ptr);
    return st;
}

/* The run with an earlier deadline, if it is earlier: time_limit holds for the surfaces as well as for
 * TetGen. */
static sn_run limit_run(const sn_run *run, double deadline)
{
    sn_run r = {0};
    if (run) r = *run;
    if (r.deadline <= 0.0 || deadline < r.deadline) r.deadline = deadline;
    return r;
}

/* Of a half model with its image: the half has the same fields as the whole then. */
static double whole_size(const sn_tet_mesh *m, const sn_body_options *opt)
{
    sn_plane plane;
    sn_box3 box = sn_tet_mesh_bounds(m);
    if (opt->has_cut && !sn_plane_make(&plane, "cut", opt->cut_point, opt->cut_normal, NULL))
        for (int32_t v = 0; v < m->n_vert; v++)
            box = sn_box3_add(box, sn_plane_reflect(&plane, sn_tet_mesh_point(m, v)));
    return sn_box3_diagonal(box);
}

static sn_status build_in_unit_box(const sn_tri_mesh *skin, const sn_named_surface *bone, int32_t n_bone,
                                   const sn_body_options *opt, const sn_run *run, sn_body *out,
                                   sn_body_report *report, sn_notes *notes, sn_error *err)
{
    sn_body_report r = {0};
    sn_tri_mesh clean_skin, *clean = SN_NEW_ZERO(sn_tri_mesh, n_bone);
    double start = sn_clock();
    sn_tri_mesh_init(&clean_skin);
    sn_body_free(out);
    sn_status st = clean ? SN_OK : sn_fail(err, SN_ENOMEM, "body: no memory");
    if (!st) st = prepare_skin(skin, run, &clean_skin, err);
    if (!st) {
        sn_run limited = limit_run(run, start + opt->time_limit);
        st = build(&clean_skin, bone, n_bone, clean, opt, &limited, out, &r, notes, err);
        if (st == SN_ELIMIT && sn_run_stopped(&limited) && !sn_run_stopped(run))
            st = sn_fail(err, SN_ELIMIT, "tetrahedralize: time limit of %g s reached", opt->time_limit);
    }
    if (!st) {
        out->n_bone = n_bone;
        out->size = whole_size(&out->mesh, opt);
        measure_shape(&out->mesh, &r);
        r.n_vert = out->mesh.n_vert;
        r.n_tet = out->mesh.n_tet;
        r.seconds = sn_clock() - start;
        *report = r;
    } else {
        sn_body_free(out);
    }
    sn_tri_mesh_free(&clean_skin);
    for (int32_t i = 0; clean && i < n_bone; i++) sn_tri_mesh_free(&clean[i]);
    sn_release(clean);
    return st;
}

/* The snapping grid in the unit box is far coarser than rounding, so a body in metres and the same one in
 * millimetres give the same coordinates, and so the same tets. */
sn_unit_box sn_body_unit_box(const sn_tri_mesh *skin)
{
    sn_box3 box = sn_tri_mesh_bounds(skin);
    double size = sn_box3_diagonal(box);
    return (sn_unit_box){box.min, size > 0.0 && isfinite(size) ? size : 1.0};
}

static sn_status into_unit_box(const sn_unit_box *u, const sn_tri_mesh *in, sn_tri_mesh *out, sn_error *err)
{
    sn_status st = sn_tri_mesh_copy(out, in, err);
    for (int32_t v = 0; !st && v < out->n_vert; v++)
        sn_v3_store(out->pos + 3 * (size_t)v,
                    sn_v3_scale(1.0 / u->size, sn_v3_sub(sn_tri_mesh_point(in, v), u->origin)));
    return st;
}

/* Lengths in single precision: the last bits of a quotient must not decide. */
static sn_body_options options_in_unit_box(const sn_unit_box *u, const sn_body_options *opt)
{
    sn_body_options o = *opt;
    o.edge_length = (double)(float)(o.edge_length / u->size);
    o.bone_edge_length = (double)(float)(o.bone_edge_length / u->size);
    o.max_volume = (double)(float)(o.max_volume / u->size / u->size / u->size);
    o.cut_point = sn_v3_scale(1.0 / u->size, sn_v3_sub(o.cut_point, u->origin));
    return o;
}

static void out_of_unit_box(const sn_unit_box *u, sn_body *b, sn_body_report *r)
{
    double cube = u->size * u->size * u->size;
    for (int32_t v = 0; v < b->mesh.n_vert; v++) {
        double *p = b->mesh.pos + 3 * (size_t)v;
        sn_v3_store(p, sn_v3_mad(u->origin, u->size, sn_v3_load(p)));
    }
    b->size *= u->size;
    r->bone_volume_exact *= cube;
    r->bone_volume *= cube;
    r->dropped_volume *= cube;
}

sn_status sn_body_build(const sn_tri_mesh *skin, const sn_named_surface *bone, int32_t n_bone,
                        const sn_body_options *opt, const sn_run *run, sn_body *out, sn_body_report *report,
                        sn_notes *notes, sn_error *err)
{
    sn_body_options full;
    sn_body_report r = {0};
    sn_tri_mesh *mesh = SN_NEW_ZERO(sn_tri_mesh, n_bone + 1); /* the bones, then the skin */
    sn_named_surface *named = SN_NEW(sn_named_surface, n_bone);
    sn_unit_box u = sn_body_unit_box(skin);
    sn_body_free(out);
    sn_status st =
        mesh && named ? sn_body_defaults(opt, skin, &full, err) : sn_fail(err, SN_ENOMEM, "body: no memory");
    if (!st) st = into_unit_box(&u, skin, &mesh[n_bone], err);
    for (int32_t i = 0; i < n_bone && !st; i++) {
        st = into_unit_box(&u, bone[i].mesh, &mesh[i], err);
        named[i] = (sn_named_surface){bone[i].name, &mesh[i]};
    }
    if (!st) {
        full = options_in_unit_box(&u, &full);
        st = build_in_unit_box(&mesh[n_bone], named, n_bone, &full, run, out, &r, notes, err);
    }
    if (!st) {
        out_of_unit_box(&u, out, &r);
        if (r.n_dropped)
            sn_notes_add(notes, "%d tets (volume %g) are shut off from the skin by bone: dropped",
                         r.n_dropped, r.dropped_volume);
        if (report) *report = r;
    }
    for (int32_t i = 0; mesh && i <= n_bone; i++) sn_tri_mesh_free(&mesh[i]);
    sn_release(mesh);
    sn_release(named);
    return st;
}

sn_status sn_body_from_tets(const sn_tet_mesh *m, int32_t label, sn_body *out, sn_error *err)
{
    sn_body_free(out);
    sn_status st = sn_tet_mesh_validate(m, err);
    if (!st) st = sn_tet_mesh_copy(&out->mesh, m, err);
    if (!st) st = sn_tet_mesh_adjacency(m, &out->across, err);
    for (size_t h = 0; !st && h < 4 * (size_t)m->n_tet; h++)
        if (out->across[h] < 0) out->across[h] = -1 - label;
    out->size = sn_box3_diagonal(sn_tet_mesh_bounds(&out->mesh));
    if (st) sn_body_free(out);
    return st;
}
