/* TetGen in a child process; then labels, adjacency, and the tissue that bone shuts off dropped. */
#include "base/alloc.h"
#include "base/array.h"
#include "base/plane.h"
#include "base/child.h"
#include "mesh/bvh.h"
#include "mesh/mesh_check.h"
#include "tetra/body_private.h"
#include "tetra/mesher.h"
#include "tetra/tetgen_bridge.h"

#include <string.h>

#define MIN_DIHEDRAL_DEG 12.0 /* asked of TetGen, which treats it as a wish */
/* The same for an adaptive mesh. In the films of tissue that bones almost in touch leave between them the
 * wish alone can triple the tets of a coarse mesh (the ankle of a dog: 230 k or 1000 k). */
#define MIN_DIHEDRAL_SIZED_DEG 2.0

/* ---- holes ---- */

/* A point beyond face f on its outer side, half-way to the next surface. false when the ray leaves the body.
 */
static bool point_beyond(const sn_bvh *bvh, int32_t f, sn_vec3 *out)
{
    const sn_tri_mesh *m = sn_bvh_mesh(bvh);
    const int32_t *v = m->face + 3 * (size_t)f;
    sn_vec3 c = sn_v3_add(sn_v3_add(sn_tri_mesh_point(m, v[0]), sn_tri_mesh_point(m, v[1])),
                          sn_tri_mesh_point(m, v[2]));
    c = sn_v3_scale(1.0 / 3.0, c);
    sn_vec3 n = sn_v3_unit(sn_tri_mesh_face_normal(m, f));
    double big = sn_box3_diagonal(sn_tri_mesh_bounds(m)), eps = 1e-9 * big;
    sn_ray_hit hit;
    if (sn_v3_len2(n) == 0.0 || !sn_bvh_ray_first(bvh, sn_v3_mad(c, eps, n), n, 2.0 * big, &hit))
        return false;
    *out = sn_v3_mad(c, eps + 0.5 * hit.t, n);
    return !sn_bvh_contains(bvh, *out);
}

/* The signed volume of each component: negative for the wall of a cavity. */
static void component_volumes(const sn_tri_mesh *m, const int32_t *comp, double *volume, int32_t n_comp)
{
    for (int32_t c = 0; c < n_comp; c++) volume[c] = 0.0;
    sn_vec3 o = sn_tri_mesh_point(m, 0);
    for (int32_t f = 0; f < m->n_face; f++) {
        const int32_t *v = m->face + 3 * (size_t)f;
        volume[comp[f]] +=
            sn_v3_det(sn_v3_sub(sn_tri_mesh_point(m, v[0]), o), sn_v3_sub(sn_tri_mesh_point(m, v[1]), o),
                      sn_v3_sub(sn_tri_mesh_point(m, v[2]), o));
    }
}

/* One point per cavity: beyond the largest face of each wall that admits one. */
static sn_status find_holes(const sn_tri_mesh *m, double **hole, int32_t *n_hole, sn_error *err)
{
    int32_t *comp = SN_NEW(int32_t, m->n_face), n_comp = 0;
    double *volume = NULL;
    sn_bvh *bvh = NULL;
    *hole = NULL;
    *n_hole = 0;
    sn_status st =
        comp ? sn_mesh_components(m, comp, &n_comp, err) : sn_fail(err, SN_ENOMEM, "body: no memory");
    if (!st) st = sn_bvh_create(&bvh, m, err);
    if (st) goto done;
    volume = SN_NEW(double, n_comp);
    *hole = SN_NEW(double, 3 * (size_t)n_comp);
    if (!volume || !*hole) {
        st = sn_fail(err, SN_ENOMEM, "body: no memory");
        goto done;
    }
    component_volumes(m, comp, volume, n_comp);
    for (int32_t f = 0; f < m->n_face; f++) {
        sn_vec3 p;
        if (volume[comp[f]] >= 0.0 || !point_beyond(bvh, f, &p)) continue;
        sn_v3_store(*hole + 3 * (size_t)(*n_hole)++, p);
        volume[comp[f]] = 0.0; /* done */
    }
    for (int32_t c = 0; c < n_comp; c++)
        if (volume[c] < 0.0)
            st = sn_fail(err, SN_EMESH, "body: no point found inside a cavity of the surface");
done:
    if (st) {
        sn_release(*hole);
        *hole = NULL;
    }
    sn_bvh_destroy(bvh);
    sn_release(volume);
    sn_release(comp);
    return st;
}

/* ---- the child ---- */

typedef struct tetgen_job {
    sn_tri_mesh surface; /* in the unit box; its arrays but pos are borrowed */
    double *hole;
    int32_t n_hole;
    bool has_sizing;
    sn_sizing sizing; /* its lengths are borrowed */
    sn_tetgen_options opt;
} tetgen_job;

/* The job as bytes: a header, then positions, faces, labels, holes, and the sizing's lengths. */
typedef struct job_header {
    int32_t n_vert, n_face, n_hole, has_sizing;
    sn_sizing sizing;
    sn_tetgen_options opt;
} job_header;

static size_t sizing_bytes(bool has_sizing, const sn_sizing *s)
{
    return has_sizing ? (size_t)s->n[0] * (size_t)s->n[1] * (size_t)s->n[2] * sizeof *s->length : 0;
}

static char *pack_job(const tetgen_job *job, size_t *size)
{
    const sn_tri_mesh *s = &job->surface;
    job_header h = {s->n_vert, s->n_face, job->n_hole, job->has_sizing, job->sizing, job->opt};
    size_t pos = 3 * (size_t)h.n_vert * sizeof *s->pos, face = 3 * (size_t)h.n_face * sizeof *s->face;
    size_t label = (size_t)h.n_face * sizeof *s->label, hole = 3 * (size_t)h.n_hole * sizeof *job->hole;
    size_t sizing = sizing_bytes(job->has_sizing, &job->sizing);
    char *data = sn_alloc(*size = sizeof h + pos + face + label + hole + sizing, 1), *at = data;
    if (!data) return NULL;
    memcpy(at, &h, sizeof h);
    memcpy(at += sizeof h, s->pos, pos);
    memcpy(at += pos, s->face, face);
    memcpy(at += face, s->label, label);
    if (hole) memcpy(at + label, job->hole, hole);
    if (sizing) memcpy(at + label + hole, job->sizing.length, sizing);
    return data;
}

static sn_status mesh_and_send(const tetgen_job *job, sn_child_out *out, sn_error *err)
{
    sn_tetgen_result r;
    sn_status st = sn_tetgen(&job->surface, job->hole, job->n_hole, &job->opt,
                             job->has_sizing ? &job->sizing : NULL, &r, err);
    if (st) return st;
    int32_t n[3] = {r.n_vert, r.n_tet, r.n_face};
    sn_child_send(out, n, sizeof n);
    sn_child_send(out, r.pos, 3 * (size_t)n[0] * sizeof *r.pos);
    sn_child_send(out, r.tet, 4 * (size_t)n[1] * sizeof *r.tet);
    sn_child_send(out, r.face, 3 * (size_t)n[2] * sizeof *r.face);
    sn_child_send(out, r.face_label, (size_t)n[2] * sizeof *r.face_label);
    sn_tetgen_result_free(&r);
    return SN_OK;
}

sn_status sn_mesher_tetgen(const char *input, size_t size, sn_child_out *out, sn_error *err)
{
    job_header h;
    if (size < sizeof h) return sn_fail(err, SN_EINTERNAL, "sinew-mesher: needs a job on its standard input");
    memcpy(&h, input, sizeof h);
    size_t pos = 3 * (size_t)h.n_vert * sizeof(double), face = 3 * (size_t)h.n_face * sizeof(int32_t);
    size_t label = (size_t)h.n_face * sizeof(int32_t), hole = 3 * (size_t)h.n_hole * sizeof(double);
    size_t sizing = sizing_bytes(h.has_sizing, &h.sizing);
    if (size != sizeof h + pos + face + label + hole + sizing)
        return sn_fail(err, SN_EINTERNAL, "sinew-mesher: the job is %zu bytes, its header says other", size);
    tetgen_job job = {.n_hole = h.n_hole,
                      .opt = h.opt,
                      .has_sizing = h.has_sizing,
                      .sizing = h.sizing,
                      .hole = SN_NEW(double, 3 * (size_t)h.n_hole)};
    job.sizing.length = sn_alloc(sizing, 1);
    sn_status st = sn_tri_mesh_reserve(&job.surface, h.n_vert, h.n_face, err);
    if (!st) job.surface.label = SN_NEW(int32_t, h.n_face);
    if (!st && (!job.surface.label || !job.hole || !job.sizing.length))
        st = sn_fail(err, SN_ENOMEM, "sinew-mesher: no memory");
    if (!st) {
        const char *at = input + sizeof h;
        memcpy(job.surface.pos, at, pos);
        memcpy(job.surface.face, at += pos, face);
        memcpy(job.surface.label, at += face, label);
        if (hole) memcpy(job.hole, at + label, hole);
        if (sizing) memcpy(job.sizing.length, at + label + hole, sizing);
        st = mesh_and_send(&job, out, err);
    }
    sn_tri_mesh_free(&job.surface);
    sn_release(job.hole);
    sn_release(job.sizing.length);
    return st;
}

static sn_status tetgen_in_child(void *user, sn_child_out *out, sn_error *err)
{
    size_t size;
    char *input = pack_job(user, &size);
    if (input) sn_mesher_exec(out, SN_MESHER_TETGEN, input, size);
    sn_release(input);
    return mesh_and_send(user, out, err);
}

typedef struct label_table { /* the labelled faces by their smallest vertex */
    int32_t *head, *next;
    const int32_t *face, *label;
    int32_t n_face;
} label_table;

static sn_status build_table(label_table *t, int32_t n_vert, sn_error *err)
{
    t->head = SN_NEW(int32_t, n_vert);
    t->next = SN_NEW(int32_t, t->n_face);
    if (!t->head || !t->next) return sn_fail(err, SN_ENOMEM, "body: no memory");
    for (int32_t v = 0; v < n_vert; v++) t->head[v] = -1;
    for (int32_t f = 0; f < t->n_face; f++) {
        int32_t v[3] = {t->face[3 * (size_t)f], t->face[3 * (size_t)f + 1], t->face[3 * (size_t)f + 2]};
        sn_sort3(v);
        t->next[f] = t->head[v[0]];
        t->head[v[0]] = f;
    }
    return SN_OK;
}

static int32_t look_up(const label_table *t, const int32_t v[3])
{
    for (int32_t f = t->head[v[0]]; f >= 0; f = t->next[f]) {
        int32_t w[3] = {t->face[3 * (size_t)f], t->face[3 * (size_t)f + 1], t->face[3 * (size_t)f + 2]};
        sn_sort3(w);
        if (w[1] == v[1] && w[2] == v[2]) return t->label[f];
    }
    return -1;
}

static sn_status label_boundary(sn_body *b, const int32_t *face, const int32_t *label, int32_t n_face,
                                sn_error *err)
{
    label_table t = {NULL, NULL, face, label, n_face};
    sn_status st = build_table(&t, b->mesh.n_vert, err);
    for (size_t h = 0; !st && h < 4 * (size_t)b->mesh.n_tet; h++) {
        if (b->across[h] >= 0) continue;
        const int32_t *tet = b->mesh.tet + (h & ~(size_t)3);
        const int *c = sn_tet_face[h & 3];
        int32_t v[3] = {tet[c[0]], tet[c[1]], tet[c[2]]};
        sn_sort3(v);
        int32_t l = look_up(&t, v);
        if (l < 0)
            st = sn_fail(err, SN_EINTERNAL, "body: a boundary face of TetGen's mesh lies on no input face");
        b->across[h] = -1 - l;
    }
    sn_release(t.head);
    sn_release(t.next);
    return st;
}

/* ---- what is shut off ---- */

/* keep[t]: the tet's connected component touches the skin. */
static sn_status mark_reachable(const sn_body *b, bool *keep, sn_error *err)
{
    int32_t n = b->mesh.n_tet, *stack = SN_NEW(int32_t, n), top = 0;
    if (!stack) return sn_fail(err, SN_ENOMEM, "body: no memory");
    memset(keep, 0, (size_t)n * sizeof *keep);
    for (size_t h = 0; h < 4 * (size_t)n; h++) {
        int32_t t = (int32_t)(h >> 2);
        if (b->across[h] == -1 - SN_LABEL_SKIN && !keep[t]) {
            keep[t] = true;
            stack[top++] = t;
        }
    }
    while (top > 0) {
        int32_t t = stack[--top];
        for (int k = 0; k < 4; k++) {
            int32_t u = b->across[4 * (size_t)t + (size_t)k];
            if (u >= 0 && !keep[u]) {
                keep[u] = true;
                stack[top++] = u;
            }
        }
    }
    sn_release(stack);
    return SN_OK;
}

/* Keeps the marked tets and the vertices they use, in order. */
static sn_status compact(sn_body *b, const bool *keep, sn_error *err)
{
    sn_tet_mesh *m = &b->mesh;
    int32_t *tet_to = SN_NEW(int32_t, m->n_tet), *vert_to = SN_NEW(int32_t, m->n_vert);
    if (!tet_to || !vert_to) {
        sn_release(tet_to);
        sn_release(vert_to);
        return sn_fail(err, SN_ENOMEM, "body: no memory");
    }
    int32_t n_tet = 0, n_vert = 0;
    for (int32_t v = 0; v < m->n_vert; v++) vert_to[v] = -1;
    for (int32_t t = 0; t < m->n_tet; t++) {
        tet_to[t] = keep[t] ? n_tet++ : -1;
        for (int k = 0; k < 4 && keep[t]; k++) vert_to[m->tet[4 * (size_t)t + (size_t)k]] = 0;
    }
    for (int32_t v = 0; v < m->n_vert; v++) {
        if (vert_to[v] < 0) continue;
        memmove(m->pos + 3 * (size_t)n_vert, m->pos + 3 * (size_t)v, 3 * sizeof *m->pos);
        vert_to[v] = n_vert++;
    }
    for (int32_t t = 0; t < m->n_tet; t++) {
        if (!keep[t]) continue;
        for (int k = 0; k < 4; k++) {
            size_t from = 4 * (size_t)t + (size_t)k, to = 4 * (size_t)tet_to[t] + (size_t)k;
            m->tet[to] = vert_to[m->tet[from]];
            b->across[to] = b->across[from] >= 0 ? tet_to[b->across[from]] : b->across[from];
        }
    }
    m->n_tet = n_tet;
    m->n_vert = n_vert;
    sn_release(tet_to);
    sn_release(vert_to);
    return SN_OK;
}

static sn_status drop_shut_off(sn_body *b, sn_body_report *report, sn_error *err)
{
    bool *keep = SN_NEW(bool, b->mesh.n_tet);
    if (!keep) return sn_fail(err, SN_ENOMEM, "body: no memory");
    sn_status st = mark_reachable(b, keep, err);
    for (int32_t t = 0; !st && t < b->mesh.n_tet; t++)
        if (!keep[t]) {
            report->n_dropped++;
            report->dropped_volume += sn_tet_mesh_tet_volume(&b->mesh, t);
        }
    if (!st && report->n_dropped == b->mesh.n_tet)
        st = sn_fail(err, SN_EMESH, "the bones shut all soft tissue off from the skin");
    if (!st) st = compact(b, keep, err); /* also drops vertices that no tet uses */
    sn_release(keep);
    return st;
}

/* ---- caps of half models ---- */

/* TetGen's new points in the plane miss it by a rounding error: they are moved onto it. on_plane: n_vert. */
static sn_status flatten(sn_tet_mesh *m, const sn_body_options *opt, bool *on_plane, sn_error *err)
{
    sn_plane plane;
    sn_status st = sn_plane_make(&plane, "cut", opt->cut_point, opt->cut_normal, err);
    for (int32_t v = 0; !st && v < m->n_vert; v++) {
        sn_vec3 p = sn_tet_mesh_point(m, v);
        on_plane[v] = fabs(sn_plane_height(&plane, p)) < SN_PLANE_REL;
        if (on_plane[v]) sn_v3_store(m->pos + 3 * (size_t)v, sn_plane_project(&plane, p));
    }
    return st;
}

/* Tets with all corners in the plane have no volume: what lies behind them becomes the cap. */
static sn_status flatten_cap(sn_body *b, const sn_body_options *opt, sn_error *err)
{
    sn_tet_mesh *m = &b->mesh;
    bool *on_plane = SN_NEW(bool, m->n_vert), *keep = SN_NEW(bool, m->n_tet);
    sn_status st =
        on_plane && keep ? flatten(m, opt, on_plane, err) : sn_fail(err, SN_ENOMEM, "body: no memory");
    int32_t cap = -1, n_flat = 0;
    for (int32_t t = 0; !st && t < m->n_tet; t++) {
        const int32_t *v = m->tet + 4 * (size_t)t;
        keep[t] = !(on_plane[v[0]] && on_plane[v[1]] && on_plane[v[2]] && on_plane[v[3]]);
        n_flat += !keep[t];
        for (int k = 0; k < 4 && !keep[t]; k++)
            if (b->across[4 * (size_t)t + (size_t)k] < 0) cap = b->across[4 * (size_t)t + (size_t)k];
    }
    for (size_t h = 0; !st && n_flat > 0 && h < 4 * (size_t)m->n_tet; h++)
        if (keep[h / 4] && b->across[h] >= 0 && !keep[b->across[h]]) b->across[h] = cap;
    if (!st && n_flat > 0) st = compact(b, keep, err);
    sn_release(on_plane);
    sn_release(keep);
    return st;
}

/* ---- the whole ---- */

static sn_status unpack(const char *data, size_t size, sn_vec3 origin, double scale, sn_body *out,
                        sn_error *err)
{
    int32_t n[3];
    memcpy(n, data, sizeof n);
    size_t pos = 3 * (size_t)n[0] * sizeof(double), tet = 4 * (size_t)n[1] * sizeof(int32_t);
    size_t face = 3 * (size_t)n[2] * sizeof(int32_t), label = (size_t)n[2] * sizeof(int32_t);
    if (size != sizeof n + pos + tet + face + label)
        return sn_fail(err, SN_EINTERNAL, "body: TetGen's result was cut short");
    sn_status st = sn_tet_mesh_reserve(&out->mesh, n[0], n[1], false, err);
    int32_t *faces = SN_NEW(int32_t, 4 * (size_t)n[2]);
    if (!st && !faces) st = sn_fail(err, SN_ENOMEM, "body: no memory");
    if (!st) {
        const char *at = data + sizeof n;
        memcpy(out->mesh.pos, at, pos);
        memcpy(out->mesh.tet, at += pos, tet);
        memcpy(faces, at += tet, face + label);
        st = sn_body_sort(&out->mesh, faces, n[2], err);
        for (int32_t v = 0; v < n[0]; v++) {
            double *p = out->mesh.pos + 3 * (size_t)v;
            sn_v3_store(p, sn_v3_mad(origin, scale, sn_v3_load(p)));
        }
    }
    if (!st) st = sn_tet_mesh_adjacency(&out->mesh, &out->across, err);
    if (!st) st = label_boundary(out, faces, faces + 3 * (size_t)n[2], n[2], err);
    sn_release(faces);
    return st;
}

/* Into the unit box, where TetGen's own tolerances mean what they should. */
static sn_status make_job(const sn_tri_mesh *s, const sn_body_options *opt, sn_vec3 origin, double scale,
                          tetgen_job *job, sn_error *err)
{
    job->surface = *s;
    job->surface.pos = SN_NEW(double, 3 * (size_t)s->n_vert);
    if (!job->surface.pos) return sn_fail(err, SN_ENOMEM, "body: no memory");
    for (int32_t v = 0; v < s->n_vert; v++)
        sn_v3_store(job->surface.pos + 3 * (size_t)v,
                    sn_v3_scale(1.0 / scale, sn_v3_sub(sn_tri_mesh_point(s, v), origin)));
    job->opt =
        (sn_tetgen_options){.radius_edge = opt->radius_edge,
                            .min_dihedral_deg = opt->sizing ? MIN_DIHEDRAL_SIZED_DEG : MIN_DIHEDRAL_DEG,
                            .max_volume = opt->max_volume / (scale * scale * scale),
                            .size_volume = SN_BODY_SIZE_VOLUME};
    job->has_sizing = opt->sizing != NULL;
    if (opt->sizing)
        job->sizing = sn_sizing_moved(opt->sizing, origin, scale); /* from the unit box to this one */
    return find_holes(&job->surface, &job->hole, &job->n_hole, err);
}

sn_status sn_body_tets(const sn_tri_mesh *surface, const sn_body_options *opt, const sn_run *run,
                       sn_body *out, sn_body_report *report, sn_error *err)
{
    double start = sn_clock();
    sn_box3 box = sn_tri_mesh_bounds(surface);
    double scale = sn_box3_diagonal(box);
    tetgen_job job = {.hole = NULL};
    sn_child child = {"meshing with TetGen", opt->time_limit, opt->memory_limit, SN_EMESH};
    char *data = NULL;
    size_t size = 0;
    sn_status st = make_job(surface, opt, box.min, scale, &job, err);
    if (!st) st = sn_child_run(&child, tetgen_in_child, &job, run, &data, &size, err);
    if (!st) st = unpack(data, size, box.min, scale, out, err);
    if (!st && opt->has_cut) st = flatten_cap(out, opt, err);
    if (!st) st = drop_shut_off(out, report, err);
    if (!st) st = sn_tet_mesh_validate(&out->mesh, err);
    report->seconds_tets = sn_clock() - start;
    sn_release(data);
    sn_release(job.hole);
    sn_release(job.surface.pos);
    if (st) sn_body_free(out);
    return st;
}
