/* Half models: the skin and the bones on one side of a plane. */
#include "base/alloc.h"
#include "base/plane.h"
#include "mesh/tri_cut.h"
#include "scene/scene_private.h"

#include <stdio.h>

sn_status sn_scene_half_of(const sn_tri_mesh *whole, const char *what, sn_vec3 point, sn_vec3 normal,
                           sn_tri_mesh *half, sn_error *err)
{
    sn_plane plane;
    sn_status st = sn_plane_make(&plane, "cut", point, normal, err);
    if (st) return st;
    double low = INFINITY, high = -INFINITY;
    double least = SN_PLANE_REL * sn_box3_diagonal(sn_tri_mesh_bounds(whole));
    for (int32_t v = 0; v < whole->n_vert; v++) {
        double h = sn_plane_height(&plane, sn_tri_mesh_point(whole, v));
        low = fmin(low, h);
        high = fmax(high, h);
    }
    if (high <= least) return SN_OK;
    if (low >= -least) return sn_tri_mesh_copy(half, whole, err);
    st = sn_tri_mesh_cut(whole, point, normal, 0, NULL, half, NULL, err);
    return st ? sn_fail_prefix(err, st, "%s: ", what) : SN_OK;
}

static sn_status cut_all(const sn_scene *s, sn_vec3 point, sn_vec3 normal, sn_tri_mesh *half, sn_error *err)
{
    sn_status st = sn_tri_mesh_cut(&s->skin, point, normal, 0, NULL, &half[s->n_bone], NULL, err);
    for (int32_t i = 0; i < s->n_bone && !st; i++) {
        char what[96];
        (void)snprintf(what, sizeof what, "bone '%s'", s->bone[i].name);
        st = sn_scene_half_of(&s->bone[i].mesh, what, point, normal, &half[i], err);
    }
    return st;
}

sn_status sn_scene_cut(sn_scene *s, sn_vec3 point, sn_vec3 normal, sn_error *err)
{
    if (s->skin.n_face == 0) return sn_fail(err, SN_EINVAL, "the scene has no skin: set_skin first");
    sn_tri_mesh *half = SN_NEW_ZERO(sn_tri_mesh, s->n_bone + 1); /* the bones, then the skin */
    if (!half) return sn_scene_no_memory(err);
    sn_status st = cut_all(s, point, normal, half, err);
    if (!st) {
        sn_scene_uncut(s);
        for (int32_t i = 0; i < s->n_bone; i++) s->bone[i].half = half[i];
        s->half_skin = half[s->n_bone];
        s->has_cut = true;
        s->cut_point = point;
        s->cut_normal = normal;
        sn_scene_stale_body(s);
    }
    for (int32_t i = 0; st && i <= s->n_bone; i++) sn_tri_mesh_free(&half[i]);
    sn_release(half);
    return st;
}

void sn_scene_uncut(sn_scene *s)
{
    if (!s->has_cut) return;
    for (int32_t i = 0; i < s->n_bone; i++) sn_tri_mesh_free(&s->bone[i].half);
    sn_tri_mesh_free(&s->half_skin);
    s->has_cut = false;
    sn_scene_stale_body(s);
}

bool sn_scene_cut_plane(const sn_scene *s, sn_vec3 *point, sn_vec3 *normal)
{
    *point = s->cut_point;
    *normal = s->cut_normal;
    return s->has_cut;
}
