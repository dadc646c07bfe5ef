#include "muscle/stroke_private.h"

#include "base/alloc.h"

#include <stdio.h>

#define OFFER 40.0 /* pixels: an end that misses by less is told how to snap */

sn_vec3 sn_stroke_sight(const sn_stroke_view *v, const double pixel[2])
{
    return sn_v3_mad(sn_v3_mad(v->corner, pixel[0], v->per_x), pixel[1], v->per_y);
}

/* Cramer's rule for p - eye = depth * (corner + x per_x + y per_y). */
bool sn_stroke_project(const sn_stroke_view *v, sn_vec3 p, double pixel[2], double *depth)
{
    sn_vec3 q = sn_v3_sub(p, v->eye);
    double det = sn_v3_det(v->corner, v->per_x, v->per_y), d = sn_v3_det(q, v->per_x, v->per_y) / det;
    if (!(d > 0.0)) return false;
    pixel[0] = sn_v3_det(v->corner, q, v->per_y) / (det * d);
    pixel[1] = sn_v3_det(v->corner, v->per_x, q) / (det * d);
    *depth = d;
    return true;
}

/* ---- the bone under a pixel ---- */

/* The first surface entered from outside of all bones, so that an eye inside one sees the next; where there
 * is none the first surface at all. */
static sn_status hit_bone(const sn_stroke_view *v, const stroke_room *r, const double pixel[2], sn_vec3 *at,
                          int32_t *bone, sn_error *err)
{
    sn_ray_hit *hit;
    size_t n_hit, best = 0;
    sn_status st = sn_bvh_ray_all(r->bones, v->eye, sn_stroke_sight(v, pixel), INFINITY, &hit, &n_hit, err);
    if (st) return st;
    for (size_t i = n_hit; i > 0; i--)
        if (hit[i - 1].entering && sn_stroke_winding(hit, n_hit, hit[i - 1].t) == 1) best = i - 1;
    *bone = n_hit ? sn_bvh_mesh(r->bones)->label[hit[best].face] : -1;
    if (n_hit) *at = hit[best].point;
    sn_release(hit);
    return SN_OK;
}

/* ---- the bone nearest to a pixel ---- */

typedef struct near_bone {
    sn_vec3 point;
    double pixel[2], off; /* off: pixels */
    int32_t bone;         /* -1: no bone is before the eye */
} near_bone;

typedef struct seen {
    sn_vec3 point;
    double pixel[2], depth;
    bool is_before;
} seen;

/* The point of the edge ab whose image is nearest to the pixel. Along an image 1/depth is linear. */
static void try_edge(const seen *a, const seen *b, const double pixel[2], int32_t bone, near_bone *best)
{
    double x = b->pixel[0] - a->pixel[0], y = b->pixel[1] - a->pixel[1], len2 = x * x + y * y;
    double s = len2 > 0.0 ? ((pixel[0] - a->pixel[0]) * x + (pixel[1] - a->pixel[1]) * y) / len2 : 0.0;
    s = fmin(fmax(s, 0.0), 1.0);
    double at[2] = {a->pixel[0] + s * x, a->pixel[1] + s * y};
    double off = hypot(at[0] - pixel[0], at[1] - pixel[1]);
    if (!(off < best->off)) return;
    double wa = (1.0 - s) / a->depth, wb = s / b->depth;
    *best = (near_bone){.point = sn_v3_lerp(a->point, b->point, wb / (wa + wb)),
                        .pixel = {at[0], at[1]},
                        .off = off,
                        .bone = bone};
}

/* The image of a surface that misses the pixel is nearest to it on an edge. Edges that reach behind the eye
 * are passed over. */
static sn_status nearest_bone(const sn_stroke_view *v, const sn_bvh *bones, const double pixel[2],
                              near_bone *best, sn_error *err)
{
    const sn_tri_mesh *m = sn_bvh_mesh(bones);
    seen *at = SN_NEW(seen, m->n_vert);
    if (!at) return sn_fail(err, SN_ENOMEM, "stroke: no memory");
    *best = (near_bone){.off = INFINITY, .bone = -1};
    for (int32_t i = 0; i < m->n_vert; i++) {
        at[i].point = sn_tri_mesh_point(m, i);
        at[i].is_before = sn_stroke_project(v, at[i].point, at[i].pixel, &at[i].depth);
    }
    for (int32_t f = 0; f < m->n_face; f++)
        for (int k = 0; k < 3; k++) {
            const int32_t *face = m->face + 3 * (size_t)f;
            const seen *a = &at[face[k]], *b = &at[face[(k + 1) % 3]];
            if (a->is_before && b->is_before) try_edge(a, b, pixel, m->label[f], best);
        }
    sn_release(at);
    return SN_OK;
}

/* ---- the ends ---- */

static sn_status missed(const sn_stroke_view *v, const sn_stroke_body *body, const near_bone *near,
                        const double pixel[2], int32_t number, bool is_first, sn_error *err)
{
    const char *end = is_first ? "first" : "last";
    if (near->bone < 0)
        return sn_fail(
            err, SN_EINVAL,
            "the %s point of the stroke (point %d, pixel %.6g, %.6g) is not over a bone, and no bone "
            "is before the camera",
            end, number, pixel[0], pixel[1]);
    sn_vec3 sight = sn_v3_unit(sn_stroke_sight(v, pixel)), to = sn_v3_sub(near->point, v->eye),
            p = near->point;
    double off_sight = sn_v3_len(sn_v3_cross(sight, to));
    char advice[80] = "";
    if (near->off <= OFFER)
        (void)snprintf(advice, sizeof advice, ": %s there, or set snap = %.0f", is_first ? "begin" : "end",
                       ceil(near->off));
    return sn_fail(
        err, SN_EINVAL,
        "the %s point of the stroke (point %d, pixel %.6g, %.6g) is not over a bone; the nearest is "
        "'%s' at pixel %.1f, %.1f, %.1f pixels away (in space {%.6g, %.6g, %.6g}, %.3g off the line "
        "of sight)%s",
        end, number, pixel[0], pixel[1], body->bone_name[near->bone], near->pixel[0], near->pixel[1],
        near->off, p.x, p.y, p.z, off_sight, advice);
}

sn_status sn_stroke_find_ends(const sn_stroke_view *v, const sn_stroke_body *body, const stroke_room *r,
                              double snap, double *pixel, int32_t n, sn_vec3 end[2], sn_stroke_report *report,
                              sn_error *err)
{
    for (int e = 0; e < 2; e++) {
        int32_t i = e == 0 ? 0 : n - 1;
        double *at = pixel + 2 * (size_t)i;
        near_bone near = {.bone = -1};
        report->snapped[e] = 0.0;
        sn_status st = hit_bone(v, r, at, &end[e], &report->bone[e], err);
        if (!st && report->bone[e] >= 0) continue;
        if (!st) st = nearest_bone(v, r->bones, at, &near, err);
        if (!st && !(near.bone >= 0 && near.off <= snap)) st = missed(v, body, &near, at, i + 1, e == 0, err);
        if (st) return st;
        end[e] = near.point;
        report->bone[e] = near.bone;
        report->snapped[e] = near.off;
        at[0] = near.pixel[0];
        at[1] = near.pixel[1];
    }
    return SN_OK;
}
