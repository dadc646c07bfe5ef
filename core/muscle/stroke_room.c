#include "muscle/stroke_private.h"

#include "base/alloc.h"

#include <string.h>

#define MARGIN_REL 0.01 /* of the diagonal: the default margin                            */
#define FADE 0.5        /* wanted gap per distance to the nearer end, until the margin    */

/* Appends the faces of m with that label, turned outwards. */
static void append(sn_tri_mesh *out, const sn_tri_mesh *m, int32_t label)
{
    bool is_inside_out = sn_tri_mesh_volume(m) < 0.0;
    memcpy(out->pos + 3 * (size_t)out->n_vert, m->pos, 3 * (size_t)m->n_vert * sizeof *m->pos);
    for (int32_t f = 0; f < m->n_face; f++) {
        const int32_t *v = m->face + 3 * (size_t)f;
        int32_t *to = out->face + 3 * (size_t)(out->n_face + f);
        to[0] = out->n_vert + v[0];
        to[1] = out->n_vert + v[is_inside_out ? 2 : 1];
        to[2] = out->n_vert + v[is_inside_out ? 1 : 2];
        out->label[out->n_face + f] = label;
    }
    out->n_vert += m->n_vert;
    out->n_face += m->n_face;
}

static sn_status tree_of(sn_bvh **out, const sn_tri_mesh *const *mesh, int32_t n, sn_box3 *box, sn_error *err)
{
    sn_tri_mesh all;
    size_t n_vert = 0, n_face = 0;
    bool fits = true;
    for (int32_t i = 0; i < n; i++) n_vert += (size_t)mesh[i]->n_vert, n_face += (size_t)mesh[i]->n_face;
    int32_t most_vert = sn_to_i32(n_vert, &fits), most_face = sn_to_i32(n_face, &fits);
    if (!fits) return sn_fail(err, SN_ELIMIT, "stroke: too many faces");
    sn_tri_mesh_init(&all);
    sn_status st = sn_tri_mesh_reserve(&all, most_vert, most_face, err);
    if (!st && !(all.label = SN_NEW(int32_t, n_face))) st = sn_fail(err, SN_ENOMEM, "stroke: no memory");
    if (!st) {
        all.n_vert = all.n_face = 0;
        for (int32_t i = 0; i < n; i++) append(&all, mesh[i], i);
        *box = sn_tri_mesh_bounds(&all);
        st = sn_bvh_create(out, &all, err);
    }
    sn_tri_mesh_free(&all);
    return st;
}

sn_status sn_stroke_room_make(stroke_room *r, const sn_stroke_body *body, double margin, sn_error *err)
{
    sn_box3 box;
    *r = (stroke_room){0};
    sn_status st = tree_of(&r->bones, body->bone, body->n_bone, &box, err);
    if (!st && body->skin) st = tree_of(&r->skin, &body->skin, 1, &box, err);
    if (st) {
        sn_stroke_room_free(r);
        return st;
    }
    r->diagonal = sn_box3_diagonal(box);
    r->margin = margin > 0.0 ? margin : MARGIN_REL * r->diagonal;
    return SN_OK;
}

void sn_stroke_room_free(stroke_room *r)
{
    sn_bvh_destroy(r->bones);
    sn_bvh_destroy(r->skin);
    *r = (stroke_room){0};
}

/* Distance to the surface, positive on the wanted side. */
static double gap(const sn_bvh *b, sn_vec3 p, bool want_inside, sn_vec3 *away)
{
    sn_closest c = sn_bvh_closest(b, p);
    double sign = sn_bvh_contains(b, p) == want_inside ? 1.0 : -1.0;
    if (away) *away = sn_v3_unit(sn_v3_scale(sign, sn_v3_sub(p, c.point)));
    return sign * c.dist;
}

double sn_stroke_bone_gap(const stroke_room *r, sn_vec3 p, sn_vec3 *away)
{
    return gap(r->bones, p, false, away);
}

double sn_stroke_skin_gap(const stroke_room *r, sn_vec3 p, sn_vec3 *away)
{
    if (away) *away = sn_v3(0, 0, 0);
    return r->skin ? gap(r->skin, p, true, away) : INFINITY;
}

double sn_stroke_wanted_gap(const stroke_room *r, sn_vec3 p)
{
    return fmin(r->margin, FADE * fmin(sn_v3_dist(p, r->end[0]), sn_v3_dist(p, r->end[1])));
}

int sn_stroke_winding(const sn_ray_hit *hit, size_t n_hit, double t)
{
    int sum = 0; /* counted from the far end, which is outside */
    for (size_t i = n_hit; i > 0 && hit[i - 1].t > t; i--) sum += hit[i - 1].entering ? -1 : 1;
    return sum;
}
