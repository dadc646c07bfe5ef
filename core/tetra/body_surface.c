/* The boundary of the soft tissue: the exact difference of skin and bones, remeshed; or, where that cannot be
 * had, the same set sampled on a lattice. */
#include "base/alloc.h"
#include "base/child.h"
#include "mesh/bvh.h"
#include "mesh/polygonize.h"
#include "mesh/remesh.h"
#include "tetra/body_private.h"
#include "tetra/corefine_bridge.h"
#include "tetra/mesher.h"

#include <string.h>

#define MAX_BONE_VOLUME_CHANGE 0.015 /* above it the remeshing is done again with half the deviation */
#define REMESH_TRIES 8
#define SAMPLE_CELL 0.6      /* of the shorter edge length */
#define SAMPLE_THICKNESS 0.5 /* of the thinnest bone's radius                                            */
#define LEAST_TISSUE 1e-3    /* of the skin's volume: less is the noise of two surfaces that coincide     */

typedef struct corefine_job {
    const sn_tri_mesh *skin;
    const sn_tri_mesh *const *bone;
    int32_t n_bone;
} corefine_job;

/* The job as bytes: how many surfaces and whether the first is the skin; then each one's counts, positions
 * and faces. */
static size_t packed_size(const sn_tri_mesh *m)
{
    return 2 * sizeof(int64_t) + 3 * (size_t)m->n_vert * sizeof *m->pos +
           3 * (size_t)m->n_face * sizeof *m->face;
}

static char *pack_mesh(char *at, const sn_tri_mesh *m)
{
    int64_t n[2] = {m->n_vert, m->n_face};
    size_t pos = 3 * (size_t)m->n_vert * sizeof *m->pos, face = 3 * (size_t)m->n_face * sizeof *m->face;
    memcpy(at, n, sizeof n);
    memcpy(at + sizeof n, m->pos, pos);
    memcpy(at + sizeof n + pos, m->face, face);
    return at + sizeof n + pos + face;
}

static char *pack_job(const corefine_job *job, size_t *size)
{
    int64_t head[2] = {job->n_bone, job->skin != NULL};
    *size = sizeof head + (job->skin ? packed_size(job->skin) : 0);
    for (int32_t i = 0; i < job->n_bone; i++) *size += packed_size(job->bone[i]);
    char *data = sn_alloc(*size, 1), *at = data;
    if (!data) return NULL;
    memcpy(at, head, sizeof head);
    at += sizeof head;
    if (job->skin) at = pack_mesh(at, job->skin);
    for (int32_t i = 0; i < job->n_bone; i++) at = pack_mesh(at, job->bone[i]);
    return data;
}

/* false: the bytes end early or memory does. */
static bool unpack_mesh(const char **at, const char *end, sn_tri_mesh *out)
{
    int64_t n[2];
    if ((size_t)(end - *at) < sizeof n) return false;
    memcpy(n, *at, sizeof n);
    if (n[0] < 0 || n[1] < 0 || n[0] > INT32_MAX || n[1] > INT32_MAX / 3) return false;
    size_t pos = 3 * (size_t)n[0] * sizeof *out->pos, face = 3 * (size_t)n[1] * sizeof *out->face;
    if ((size_t)(end - *at) - sizeof n < pos + face) return false;
    if (sn_tri_mesh_reserve(out, (int32_t)n[0], (int32_t)n[1], NULL)) return false;
    memcpy(out->pos, *at + sizeof n, pos);
    memcpy(out->face, *at + sizeof n + pos, face);
    *at += sizeof n + pos + face;
    return true;
}

static sn_status corefine_and_send(const corefine_job *job, sn_child_out *out, sn_error *err)
{
    sn_tri_mesh m;
    sn_tri_mesh_init(&m);
    sn_status st = sn_corefine(job->skin, job->bone, job->n_bone, &m, err);
    if (st) return st;
    int32_t n[2] = {m.n_vert, m.n_face};
    sn_child_send(out, n, sizeof n);
    sn_child_send(out, m.pos, 3 * (size_t)m.n_vert * sizeof *m.pos);
    sn_child_send(out, m.face, 3 * (size_t)m.n_face * sizeof *m.face);
    sn_child_send(out, m.label, (size_t)m.n_face * sizeof *m.label);
    sn_tri_mesh_free(&m);
    return SN_OK;
}

sn_status sn_mesher_corefine(const char *input, size_t size, sn_child_out *out, sn_error *err)
{
    int64_t head[2] = {0, 0};
    const char *at = input + sizeof head, *end = input + size;
    if (size < sizeof head) return sn_fail(err, SN_EINTERNAL, "sinew-mesher: the job is cut short");
    memcpy(head, input, sizeof head);
    bool ok = head[0] >= 0 && head[0] < INT32_MAX;
    int32_t n = ok ? (int32_t)head[0] : 0;
    sn_tri_mesh skin, *bone = SN_NEW_ZERO(sn_tri_mesh, n);
    const sn_tri_mesh **ptr = SN_NEW(const sn_tri_mesh *, n);
    sn_tri_mesh_init(&skin);
    ok = ok && bone && ptr && (!head[1] || unpack_mesh(&at, end, &skin));
    for (int32_t i = 0; ok && i < n; i++) {
        ok = unpack_mesh(&at, end, &bone[i]);
        ptr[i] = &bone[i];
    }
    corefine_job job = {head[1] ? &skin : NULL, ptr, n};
    sn_status st = ok ? corefine_and_send(&job, out, err)
                      : sn_fail(err, SN_EINTERNAL, "sinew-mesher: the job is cut short, or no memory for it");
    sn_tri_mesh_free(&skin);
    for (int32_t i = 0; bone && i < n; i++) sn_tri_mesh_free(&bone[i]);
    sn_release(bone);
    sn_release(ptr);
    return st;
}

static sn_status corefine_in_child(void *user, sn_child_out *out, sn_error *err)
{
    size_t size;
    char *input = pack_job(user, &size);
    if (input) sn_mesher_exec(out, SN_MESHER_COREFINE, input, size);
    sn_release(input);
    return corefine_and_send(user, out, err);
}

static sn_status unpack_surface(const char *data, size_t size, sn_tri_mesh *out, sn_error *err)
{
    int32_t n[2];
    memcpy(n, data, sizeof n);
    sn_status st = sn_tri_mesh_reserve(out, n[0], n[1], err);
    if (st) return st;
    out->label = SN_NEW(int32_t, n[1]);
    if (!out->label) return sn_fail(err, SN_ENOMEM, "body: no memory");
    size_t pos = 3 * (size_t)n[0] * sizeof *out->pos, face = 3 * (size_t)n[1] * sizeof *out->face;
    size_t label = (size_t)n[1] * sizeof *out->label;
    if (size != sizeof n + pos + face + label)
        return sn_fail(err, SN_EINTERNAL, "body: union of bones was cut short");
    memcpy(out->pos, data + sizeof n, pos);
    memcpy(out->face, data + sizeof n + pos, face);
    memcpy(out->label, data + sizeof n + pos + face, label);
    return SN_OK;
}

static sn_status exact_difference(const corefine_job *job, const sn_body_options *opt, const sn_run *run,
                                  sn_tri_mesh *out, sn_error *err)
{
    sn_child child = {"uniting bones", opt->time_limit, opt->memory_limit, SN_EMESH};
    char *data;
    size_t size;
    sn_status st = sn_child_run(&child, corefine_in_child, (void *)job, run, &data, &size, err);
    if (!st) st = unpack_surface(data, size, out, err);
    if (st) sn_tri_mesh_free(out);
    sn_release(data);
    return st;
}

/* ---- sampling ---- */

typedef struct sampler {
    sn_bvh *skin;
    sn_bvh **bone;
    sn_box3 *box; /* of each bone */
    int32_t n_bone;
} sampler;

static double signed_distance(const sn_bvh *b, sn_vec3 p)
{
    double d = sn_bvh_closest(b, p).dist;
    return sn_bvh_contains(b, p) ? -d : d;
}

/* How far p lies outside of a box; 0 inside. */
static double outside_by(sn_box3 b, sn_vec3 p)
{
    sn_vec3 d =
        sn_v3(fmax(0.0, fmax(b.min.x - p.x, p.x - b.max.x)), fmax(0.0, fmax(b.min.y - p.y, p.y - b.max.y)),
              fmax(0.0, fmax(b.min.z - p.z, p.z - b.max.z)));
    return sn_v3_len(d);
}

/* A bone counts only where it is nearer than the skin and the bones before it: its box tells that soonest. */
static double tissue_value(void *user, sn_vec3 p)
{
    const sampler *s = user;
    double v = signed_distance(s->skin, p);
    for (int32_t i = 0; i < s->n_bone; i++)
        if (-outside_by(s->box[i], p) > v) v = fmax(v, -signed_distance(s->bone[i], p));
    return v;
}

static sn_status label_by_nearest(const sampler *s, sn_tri_mesh *m, sn_error *err)
{
    m->label = SN_NEW(int32_t, m->n_face);
    if (!m->label) return sn_fail(err, SN_ENOMEM, "body: no memory");
    for (int32_t f = 0; f < m->n_face; f++) {
        const int32_t *v = m->face + 3 * (size_t)f;
        sn_vec3 c = sn_v3_add(sn_v3_add(sn_tri_mesh_point(m, v[0]), sn_tri_mesh_point(m, v[1])),
                              sn_tri_mesh_point(m, v[2]));
        c = sn_v3_scale(1.0 / 3.0, c);
        double best = sn_bvh_closest(s->skin, c).dist;
        m->label[f] = SN_LABEL_SKIN;
        for (int32_t i = 0; i < s->n_bone; i++) {
            double d = sn_bvh_closest(s->bone[i], c).dist;
            if (d < best) {
                best = d;
                m->label[f] = SN_LABEL_BONE(i);
            }
        }
    }
    return SN_OK;
}

/* Fine enough for the edge lengths asked for and for the thinnest bone: 3 V / A is the radius of a ball. */
static double sample_cell(const corefine_job *job, const sn_body_options *opt)
{
    double cell = SAMPLE_CELL * fmin(opt->edge_length, opt->bone_edge_length);
    for (int32_t i = 0; i < job->n_bone; i++) {
        double area = sn_tri_mesh_area(job->bone[i]);
        if (area > 0.0) cell = fmin(cell, SAMPLE_THICKNESS * 3.0 * sn_tri_mesh_volume(job->bone[i]) / area);
    }
    return fmax(cell, 1.1 * sn_polygonize_smallest_cell(sn_tri_mesh_bounds(job->skin)));
}

static sn_status sampled_difference(const corefine_job *job, const sn_body_options *opt, const sn_run *run,
                                    sn_tri_mesh *out, sn_error *err)
{
    sampler s = {NULL, SN_NEW_ZERO(sn_bvh *, job->n_bone), SN_NEW(sn_box3, job->n_bone), job->n_bone};
    sn_polygonize p = {tissue_value, &s, sn_tri_mesh_bounds(job->skin), sample_cell(job, opt), true};
    sn_status st =
        s.bone && s.box ? sn_bvh_create(&s.skin, job->skin, err) : sn_fail(err, SN_ENOMEM, "body: no memory");
    for (int32_t i = 0; !st && i < job->n_bone; i++) {
        s.box[i] = sn_tri_mesh_bounds(job->bone[i]);
        st = sn_bvh_create(&s.bone[i], job->bone[i], err);
    }
    if (!st) st = sn_polygonize_run(&p, run, out, err);
    if (!st && (out->n_face == 0 || sn_tri_mesh_volume(out) < LEAST_TISSUE * sn_tri_mesh_volume(job->skin)))
        st = sn_fail(err, SN_EMESH, "the bones leave no soft tissue inside the skin");
    if (!st) st = label_by_nearest(&s, out, err);
    if (st) sn_tri_mesh_free(out);
    for (int32_t i = 0; s.bone && i < job->n_bone; i++) sn_bvh_destroy(s.bone[i]);
    sn_release(s.bone);
    sn_release(s.box);
    sn_bvh_destroy(s.skin);
    return st;
}

/* ---- remeshing ---- */

static bool is_bone(int32_t label, int32_t n_bone)
{
    return label >= SN_LABEL_BONE(0) && label < SN_LABEL_BONE(n_bone);
}

/* The mean of the corners of bone faces: a place near all openings. */
static sn_vec3 bone_centre(const sn_tri_mesh *m, int32_t n_bone)
{
    sn_vec3 o = {0, 0, 0};
    int64_t n = 0;
    for (int32_t f = 0; f < m->n_face; f++)
        if (is_bone(m->label[f], n_bone)) {
            n++;
            o = sn_v3_mad(o, 1.0 / (double)n, sn_v3_sub(sn_tri_mesh_point(m, m->face[3 * (size_t)f]), o));
        }
    return o;
}

/* Volume of the cone from o to the faces of bones, positive for whole bones: their own, up to the openings
 * where they poke through the skin. What an opening adds depends on o and can make it negative: only figures
 * for the same o may be compared. */
static double bone_volume(const sn_tri_mesh *m, int32_t n_bone, sn_vec3 o)
{
    double sum = 0.0;
    for (int32_t f = 0; f < m->n_face; f++) {
        const int32_t *v = m->face + 3 * (size_t)f;
        if (is_bone(m->label[f], n_bone))
            sum -=
                sn_v3_det(sn_v3_sub(sn_tri_mesh_point(m, v[0]), o), sn_v3_sub(sn_tri_mesh_point(m, v[1]), o),
                          sn_v3_sub(sn_tri_mesh_point(m, v[2]), o)) /
                6.0;
    }
    return sum;
}

/* Remeshes until the bones keep their volume and nothing crosses. *clean: nothing crosses. */
static sn_status remesh(const sn_tri_mesh *in, const sn_body_options *opt, int32_t n_bone, const sn_run *run,
                        sn_tri_mesh *out, bool *clean, sn_body_report *report, sn_error *err)
{
    double *length = SN_NEW(double, n_bone + 1);
    if (!length) return sn_fail(err, SN_ENOMEM, "body: no memory");
    for (int32_t i = 0; i <= n_bone; i++)
        length[i] = is_bone(i, n_bone) ? opt->bone_edge_length : opt->edge_length;
    sn_remesh r = {.edge_length = opt->edge_length,
                   .label_length = length,
                   .n_label = n_bone + 1,
                   .sizing = opt->sizing,
                   .coarsest = SN_BODY_COARSEST,
                   .max_deviation = 0.08};
    sn_remesh_report rr = {0};
    sn_status st = SN_OK;
    sn_vec3 centre = bone_centre(in, n_bone);
    report->bone_volume_exact = bone_volume(in, n_bone, centre);
    for (int i = 0; i < REMESH_TRIES; i++) {
        st = sn_remesh_run(in, &r, run, out, &rr, err);
        if (st) break;
        report->bone_volume = bone_volume(out, n_bone, centre);
        double change = fabs(report->bone_volume - report->bone_volume_exact);
        if (rr.crossings_after == 0 && change <= MAX_BONE_VOLUME_CHANGE * fabs(report->bone_volume_exact))
            break;
        r.max_deviation *= 0.3;
    }
    *clean = rr.crossings_after == 0;
    report->crossings_cured = rr.crossings_before - rr.crossings_after;
    sn_release(length);
    return st;
}

sn_status sn_body_surface(const sn_tri_mesh *skin, const sn_tri_mesh *const *bone, int32_t n_bone,
                          bool is_exact_possible, const sn_body_options *opt, const sn_run *run,
                          sn_tri_mesh *out, sn_body_report *report, sn_notes *notes, sn_error *err)
{
    corefine_job job = {skin, bone, n_bone};
    sn_tri_mesh raw;
    sn_tri_mesh_init(&raw);
    bool clean = false;
    sn_status st = SN_OK;
    if (is_exact_possible) {
        sn_error why;
        st = exact_difference(&job, opt, run, &raw, &why);
        if (!st && raw.n_face == 0)
            st = sn_fail(&why, SN_EMESH, "the bones leave no soft tissue inside the skin");
        if (!st) st = remesh(&raw, opt, n_bone, run, out, &clean, report, &why);
        if (st && st != SN_EMESH) {
            if (err) *err = why;
            goto done;
        }
        if (!clean)
            sn_notes_add(notes, "%s: the surfaces are resampled",
                         st ? why.msg : "remeshing left crossing faces");
    }
    if (!clean) {
        report->was_resampled = true;
        st = sampled_difference(&job, opt, run, &raw, err);
        if (!st) st = remesh(&raw, opt, n_bone, run, out, &clean, report, err);
        if (!st && !clean)
            st = sn_fail(err, SN_EMESH, "the surfaces cross each other and could not be mended");
    }
    if (!st && opt->has_cut) st = sn_body_cut_surface(out, opt, n_bone, run, err);
    report->n_surface_face = out->n_face;
done:
    sn_tri_mesh_free(&raw);
    if (st) sn_tri_mesh_free(out);
    return st;
}
