/* Skin and bones: what they are and how they are edited. */
#include "base/alloc.h"
#include "base/plane.h"
#include "base/side_name.h"
#include "scene/scene_private.h"

#include <stdio.h>
#include <string.h>

#define FLAT_REL 1e-12 /* determinant of a map against the product of its columns: less flattens a bone */

/* ---- skin ---- */

sn_status sn_scene_set_skin(sn_scene *s, const sn_tri_mesh *skin, sn_error *err)
{
    sn_tri_mesh copy, half;
    sn_tri_mesh_init(&copy);
    sn_tri_mesh_init(&half);
    sn_status st = sn_tri_mesh_validate(skin, err);
    if (st) return sn_fail_prefix(err, st, "skin: ");
    st = sn_tri_mesh_copy(&copy, skin, err);
    if (!st && s->has_cut) st = sn_scene_half_of(&copy, "skin", s->cut_point, s->cut_normal, &half, err);
    if (st) {
        sn_tri_mesh_free(&copy);
        return st;
    }
    sn_tri_mesh_free(&s->skin);
    sn_tri_mesh_free(&s->half_skin);
    s->skin = copy;
    s->half_skin = half;
    sn_scene_stale_body(s);
    return SN_OK;
}

const sn_tri_mesh *sn_scene_skin(const sn_scene *s)
{
    const sn_tri_mesh *m = s->has_cut ? &s->half_skin : &s->skin;
    return m->n_face ? m : NULL;
}

/* ---- bones ---- */

void sn_scene_free_bone(scene_bone *b)
{
    sn_release(b->name);
    sn_tri_mesh_free(&b->mesh);
    sn_tri_mesh_free(&b->half);
    sn_landmarks_free(b->landmark, b->n_landmark);
    memset(b, 0, sizeof *b);
}

static int32_t find_quietly(const sn_scene *s, const char *name)
{
    for (int32_t i = 0; i < s->n_bone; i++)
        if (strcmp(s->bone[i].name, name) == 0) return i;
    return -1;
}

static sn_status new_bone_name(const sn_scene *s, const char *name, sn_error *err)
{
    sn_status st = sn_check_name("bone", name, err);
    if (!st && find_quietly(s, name) >= 0) st = sn_fail(err, SN_EINVAL, "there is a bone '%s' already", name);
    return st;
}

static sn_status cut_bone(const sn_scene *s, scene_bone *b, sn_error *err)
{
    char what[96];
    sn_tri_mesh_free(&b->half);
    if (!s->has_cut) return SN_OK;
    (void)snprintf(what, sizeof what, "bone '%s'", b->name);
    return sn_scene_half_of(&b->mesh, what, s->cut_point, s->cut_normal, &b->half, err);
}

sn_status sn_scene_put_bone(sn_scene *s, int32_t i_bone, scene_bone *b, sn_error *err)
{
    sn_status st = i_bone < 0 ? new_bone_name(s, b->name, err) : SN_OK;
    if (st) return st;
    st = sn_tri_mesh_validate(&b->mesh, err);
    if (st) return sn_fail_prefix(err, st, "bone '%s': ", b->name);
    st = cut_bone(s, b, err);
    if (st) return st;
    if (i_bone < 0) {
        if (!sn_grow(&s->bone, &s->cap_bone, (size_t)s->n_bone + 1, sizeof *s->bone))
            return sn_scene_no_memory(err);
        i_bone = s->n_bone++;
    } else {
        sn_scene_free_bone(&s->bone[i_bone]);
    }
    s->bone[i_bone] = *b;
    memset(b, 0, sizeof *b);
    sn_scene_stale_body(s);
    return SN_OK;
}

sn_status sn_scene_add_bone(sn_scene *s, const char *name, const sn_tri_mesh *bone, sn_error *err)
{
    scene_bone b = {.name = sn_strdup(name)};
    sn_status st = b.name ? sn_tri_mesh_copy(&b.mesh, bone, err) : sn_scene_no_memory(err);
    if (!st) st = sn_scene_put_bone(s, -1, &b, err);
    if (st) sn_scene_free_bone(&b);
    return st;
}

sn_status sn_scene_find_bone(const sn_scene *s, const char *name, int32_t *i_bone, sn_error *err)
{
    const char **names = SN_NEW(const char *, s->n_bone);
    if (!names) return sn_scene_no_memory(err);
    for (int32_t i = 0; i < s->n_bone; i++) names[i] = s->bone[i].name;
    sn_status st = sn_find_name("bone", name, names, s->n_bone, i_bone, err);
    sn_release(names);
    return st;
}

sn_status sn_scene_remove_bone(sn_scene *s, const char *name, sn_error *err)
{
    int32_t i;
    sn_status st = sn_scene_find_bone(s, name, &i, err);
    if (st) return st;
    for (int32_t k = s->n_joint - 1; k >= 0; k--)
        if (strcmp(s->joint[k].parent, s->bone[i].name) == 0 ||
            strcmp(s->joint[k].child, s->bone[i].name) == 0) {
            sn_notes_add(&s->notes, "joint '%s' went with bone '%s'", s->joint[k].name, s->bone[i].name);
            sn_scene_drop_joint(s, k);
        }
    sn_scene_free_bone(&s->bone[i]);
    memmove(&s->bone[i], &s->bone[i + 1], (size_t)(s->n_bone - i - 1) * sizeof *s->bone);
    s->n_bone--;
    sn_scene_stale_body(s);
    return SN_OK;
}

int32_t sn_scene_bone_count(const sn_scene *s)
{
    return s->n_bone;
}

const char *sn_scene_bone_name(const sn_scene *s, int32_t i_bone)
{
    return s->bone[i_bone].name;
}

const sn_tri_mesh *sn_scene_bone_mesh(const sn_scene *s, int32_t i_bone)
{
    return s->has_cut ? &s->bone[i_bone].half : &s->bone[i_bone].mesh;
}

sn_vec3 sn_scene_bone_centre(const sn_scene *s, int32_t i_bone)
{
    sn_box3 box = sn_tri_mesh_bounds(&s->bone[i_bone].mesh);
    return sn_v3_lerp(box.min, box.max, 0.5);
}

/* ---- landmarks and ends ---- */

bool sn_scene_bone_ends(const sn_scene *s, int32_t i_bone, sn_vec3 *from, sn_vec3 *to)
{
    *from = s->bone[i_bone].from;
    *to = s->bone[i_bone].to;
    return s->bone[i_bone].has_ends;
}

const sn_landmark *sn_scene_bone_landmarks(const sn_scene *s, int32_t i_bone, int32_t *n)
{
    *n = s->bone[i_bone].n_landmark;
    return s->bone[i_bone].landmark;
}

static int32_t find_landmark(const scene_bone *b, const char *name)
{
    for (int32_t i = 0; i < b->n_landmark; i++)
        if (strcmp(b->landmark[i].name, name) == 0) return i;
    return -1;
}

static sn_status fail_no_landmark(const scene_bone *b, const char *name, sn_error *err)
{
    const char **names = SN_NEW(const char *, b->n_landmark);
    if (!names) return sn_scene_no_memory(err);
    for (int32_t i = 0; i < b->n_landmark; i++) names[i] = b->landmark[i].name;
    const char *near = sn_nearest_name(name, names, (size_t)b->n_landmark);
    sn_release(names);
    if (near)
        return sn_fail(err, SN_EINVAL, "bone '%s' has no landmark '%.64s' (did you mean '%s'?)", b->name,
                       name, near);
    return sn_fail(err, SN_EINVAL,
                   "bone '%s' has no landmark '%.64s' (it has %d: bone:landmarks() lists them)", b->name,
                   name, b->n_landmark);
}

sn_status sn_scene_bone_landmark(const sn_scene *s, int32_t i_bone, const char *name, sn_landmark *out,
                                 sn_error *err)
{
    const scene_bone *b = &s->bone[i_bone];
    int32_t i = find_landmark(b, name);
    if (i < 0) return fail_no_landmark(b, name, err);
    *out = b->landmark[i];
    return SN_OK;
}

sn_status sn_scene_set_landmark(sn_scene *s, int32_t i_bone, const char *name, sn_vec3 at, double radius,
                                sn_error *err)
{
    scene_bone *b = &s->bone[i_bone];
    sn_status st = sn_check_name("landmark", name, err);
    if (st) return st;
    if (!sn_v3_is_finite(at) || !(radius >= 0.0 && isfinite(radius)))
        return sn_fail(err, SN_EINVAL, "bone '%s': landmark '%s': need a finite point and a radius >= 0",
                       b->name, name);
    int32_t i = find_landmark(b, name);
    if (i < 0) {
        sn_landmark *list = sn_realloc(b->landmark, (size_t)b->n_landmark + 1, sizeof *list);
        char *copy = sn_strdup(name);
        if (list) b->landmark = list;
        if (!list || !copy) {
            sn_release(copy);
            return sn_scene_no_memory(err);
        }
        i = b->n_landmark++;
        list[i].name = copy;
    }
    b->landmark[i].at = at;
    b->landmark[i].radius = radius;
    s->revision++;
    return SN_OK;
}

/* ---- edits ---- */

static sn_status check_map(const scene_bone *b, const sn_affine *map, sn_error *err)
{
    double size = 1.0;
    bool is_finite = sn_v3_is_finite(map->t);
    for (int k = 0; k < 3; k++) {
        is_finite = is_finite && sn_v3_is_finite(map->col[k]);
        size *= sn_v3_len(map->col[k]);
    }
    if (is_finite && fabs(sn_affine_det(map)) > FLAT_REL * size) return SN_OK;
    return sn_fail(err, SN_EINVAL, "bone '%s': the map is not finite, or flattens the bone", b->name);
}

/* The bone's copy, mapped, under a name of its own. */
static sn_status copy_mapped(const scene_bone *b, const char *name, const sn_affine *map, scene_bone *out,
                             sn_error *err)
{
    *out = (scene_bone){.name = sn_strdup(name), .has_ends = b->has_ends};
    sn_status st = out->name ? sn_tri_mesh_copy(&out->mesh, &b->mesh, err) : sn_scene_no_memory(err);
    if (!st) st = sn_landmarks_copy(&out->landmark, b->landmark, b->n_landmark, err);
    if (st) {
        sn_scene_free_bone(out);
        return st;
    }
    out->n_landmark = b->n_landmark;
    double scale = cbrt(fabs(sn_affine_det(map)));
    sn_affine_mesh(map, &out->mesh);
    for (int32_t i = 0; i < out->n_landmark; i++) {
        out->landmark[i].at = sn_affine_point(map, out->landmark[i].at);
        out->landmark[i].radius *= scale;
    }
    out->from = sn_affine_point(map, b->from);
    out->to = sn_affine_point(map, b->to);
    return SN_OK;
}

sn_status sn_scene_map_bone(sn_scene *s, int32_t i_bone, const sn_affine *map, sn_error *err)
{
    scene_bone mapped;
    sn_status st = check_map(&s->bone[i_bone], map, err);
    if (!st) st = copy_mapped(&s->bone[i_bone], s->bone[i_bone].name, map, &mapped, err);
    if (st) return st;
    st = sn_scene_put_bone(s, i_bone, &mapped, err);
    if (st) sn_scene_free_bone(&mapped);
    return st;
}

sn_status sn_scene_set_bone_ends(sn_scene *s, int32_t i_bone, sn_vec3 from, sn_vec3 to, double thickness,
                                 sn_error *err)
{
    const scene_bone *b = &s->bone[i_bone];
    double before = sn_v3_dist(b->from, b->to), after = sn_v3_dist(from, to);
    if (!b->has_ends)
        return sn_fail(err, SN_EINVAL, "bone '%s' has no ends: only bones placed between two points have",
                       b->name);
    if (!(after > 1e-9 * before && isfinite(after)))
        return sn_fail(err, SN_EINVAL, "bone '%s': its ends are %g apart, need > 0", b->name, after);
    if (!(thickness > 0.0 && isfinite(thickness)))
        return sn_fail(err, SN_EINVAL, "bone '%s': thickness is %g, need > 0", b->name, thickness);
    sn_affine map = sn_place_ends((sn_vec3[2]){b->from, b->to}, (sn_vec3[2]){from, to}, thickness);
    return sn_scene_map_bone(s, i_bone, &map, err);
}

/* ---- the other side ---- */

/* The images of all bones of a side, checked and cut, so that putting them into the scene cannot fail any
 * more but for memory. at: the bone that each replaces, or -1. */
static sn_status make_images(const sn_scene *s, const sn_affine *map, scene_bone *image, int32_t *at,
                             int32_t *n, sn_error *err)
{
    for (int32_t i = 0; i < s->n_bone; i++) {
        char other[160];
        bool has_side = sn_side_name_swap(s->bone[i].name, other, sizeof other);
        if (!has_side || (sn_side_of(s->bone[i].name) == SN_SIDE_RIGHT && find_quietly(s, other) >= 0))
            continue;
        at[*n] = find_quietly(s, other);
        sn_status st = copy_mapped(&s->bone[i], other, map, &image[*n], err);
        if (st) return st;
        ++*n;
        st = at[*n - 1] < 0 ? new_bone_name(s, other, err) : SN_OK;
        if (!st) st = cut_bone(s, &image[*n - 1], err);
        if (st) return st;
    }
    if (*n > 0) return SN_OK;
    return sn_fail(
        err, SN_EINVAL,
        "mirror_bones: no bone has a side: names of a side end in _l or _r (or .l, _L, _left ...)");
}

static sn_status put_images(sn_scene *s, scene_bone *image, const int32_t *at, int32_t n, sn_error *err)
{
    if (!sn_grow(&s->bone, &s->cap_bone, (size_t)(s->n_bone + n), sizeof *s->bone))
        return sn_scene_no_memory(err);
    sn_status st = SN_OK;
    for (int32_t i = 0; i < n && !st; i++) st = sn_scene_put_bone(s, at[i], &image[i], err);
    return st;
}

sn_status sn_scene_mirror_bones(sn_scene *s, sn_vec3 point, sn_vec3 normal, int32_t *n_added,
                                int32_t *n_replaced, sn_error *err)
{
    sn_plane plane;
    sn_affine map;
    int32_t n = 0, *at = SN_NEW(int32_t, s->n_bone);
    scene_bone *image = SN_NEW_ZERO(scene_bone, s->n_bone);
    *n_added = *n_replaced = 0;
    sn_status st =
        at && image ? sn_plane_make(&plane, "mirror_bones", point, normal, err) : sn_scene_no_memory(err);
    if (!st) map = sn_affine_mirror(plane.point, plane.normal);
    if (!st) st = make_images(s, &map, image, at, &n, err);
    if (!st) st = put_images(s, image, at, n, err);
    if (!st) st = sn_scene_mirror_joints(s, point, normal, err);
    for (int32_t i = 0; i < n; i++) {
        ++*(at[i] < 0 ? n_added : n_replaced);
        sn_scene_free_bone(&image[i]);
    }
    sn_release(at);
    sn_release(image);
    return st;
}
