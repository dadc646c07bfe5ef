/* Joints: which bone turns on which, about what point and axes. */
#include "base/alloc.h"
#include "base/plane.h"
#include "base/side_name.h"
#include "scene/scene_private.h"

#include <string.h>

#define SPAN_REL 1e-6 /* sine between axes: less spans no space */

static void free_joint(sn_joint *j)
{
    sn_release(j->name);
    sn_release(j->parent);
    sn_release(j->child);
    memset(j, 0, sizeof *j);
}

void sn_scene_drop_joint(sn_scene *s, int32_t i_joint)
{
    free_joint(&s->joint[i_joint]);
    memmove(&s->joint[i_joint], &s->joint[i_joint + 1],
            (size_t)(s->n_joint - i_joint - 1) * sizeof *s->joint);
    s->n_joint--;
    s->revision++;
}

static int32_t find_joint(const sn_scene *s, const char *name)
{
    for (int32_t i = 0; i < s->n_joint; i++)
        if (strcmp(s->joint[i].name, name) == 0) return i;
    return -1;
}

/* The joint whose child the bone is. */
static int32_t joint_above(const sn_scene *s, const char *bone)
{
    for (int32_t i = 0; i < s->n_joint; i++)
        if (strcmp(s->joint[i].child, bone) == 0) return i;
    return -1;
}

static sn_status check_bones(const sn_scene *s, const char *name, const char *parent, const char *child,
                             sn_error *err)
{
    int32_t i;
    sn_status st = sn_scene_find_bone(s, parent, &i, err);
    if (!st) st = sn_scene_find_bone(s, child, &i, err);
    if (st) return sn_fail_prefix(err, st, "joint '%s': ", name);
    if (strcmp(parent, child) == 0)
        return sn_fail(err, SN_EINVAL, "joint '%s': bone '%s' is its own parent", name, child);
    int32_t above = joint_above(s, child);
    if (above >= 0)
        return sn_fail(err, SN_EINVAL, "joint '%s': bone '%s' hangs on joint '%s' already", name, child,
                       s->joint[above].name);
    for (int32_t k = joint_above(s, parent); k >= 0; k = joint_above(s, s->joint[k].parent))
        if (strcmp(s->joint[k].parent, child) == 0)
            return sn_fail(err, SN_EINVAL, "joint '%s': bone '%s' hangs on '%s' in turn: a ring", name,
                           parent, child);
    return SN_OK;
}

static sn_status make_axes(const char *name, const sn_vec3 in[3], sn_vec3 out[3], sn_error *err)
{
    static const sn_vec3 space[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    if (!in) in = space;
    sn_vec3 x = sn_v3_unit(in[0]), y = sn_v3_mad(in[1], -sn_v3_dot(in[1], x), x);
    double handed = sn_v3_dot(sn_v3_cross(x, sn_v3_unit(y)), sn_v3_unit(in[2]));
    bool is_finite = sn_v3_is_finite(in[0]) && sn_v3_is_finite(in[1]) && sn_v3_is_finite(in[2]);
    if (!is_finite || !(sn_v3_len(x) > 0.0) || !(sn_v3_len(y) > SPAN_REL * sn_v3_len(in[1])) ||
        !(fabs(handed) > SPAN_REL))
        return sn_fail(err, SN_EINVAL, "joint '%s': its axes do not span space", name);
    if (handed < 0.0)
        return sn_fail(err, SN_EINVAL, "joint '%s': its axes are left-handed; swap two or turn one", name);
    out[0] = x;
    out[1] = sn_v3_unit(y);
    out[2] = sn_v3_cross(out[0], out[1]);
    return SN_OK;
}

sn_status sn_scene_add_joint(sn_scene *s, const char *name, const char *parent, const char *child,
                             sn_vec3 center, const sn_vec3 axis[3], sn_error *err)
{
    sn_joint j = {.center = center};
    sn_status st = sn_check_name("joint", name, err);
    if (!st && find_joint(s, name) >= 0) st = sn_fail(err, SN_EINVAL, "there is a joint '%s' already", name);
    if (!st) st = check_bones(s, name, parent, child, err);
    if (!st && !sn_v3_is_finite(center))
        st = sn_fail(err, SN_EINVAL, "joint '%s': its center is not finite", name);
    if (!st) st = make_axes(name, axis, j.axis, err);
    if (st) return st;
    sn_joint *list = sn_realloc(s->joint, (size_t)s->n_joint + 1, sizeof *list);
    if (list) s->joint = list;
    j.name = sn_strdup(name);
    j.parent = sn_strdup(parent);
    j.child = sn_strdup(child);
    if (!list || !j.name || !j.parent || !j.child) {
        free_joint(&j);
        return sn_scene_no_memory(err);
    }
    list[s->n_joint++] = j;
    s->revision++;
    return SN_OK;
}

sn_status sn_scene_remove_joint(sn_scene *s, const char *name, sn_error *err)
{
    const char **names = SN_NEW(const char *, s->n_joint);
    int32_t i;
    if (!names) return sn_scene_no_memory(err);
    for (int32_t k = 0; k < s->n_joint; k++) names[k] = s->joint[k].name;
    sn_status st = sn_find_name("joint", name, names, s->n_joint, &i, err);
    sn_release(names);
    if (!st) sn_scene_drop_joint(s, i);
    return st;
}

int32_t sn_scene_joint_count(const sn_scene *s)
{
    return s->n_joint;
}

const sn_joint *sn_scene_joint(const sn_scene *s, int32_t i_joint)
{
    return &s->joint[i_joint];
}

/* The image's axes: reflected, and the last turned so that they stay right-handed. Bones without a side stay.
 */
static sn_status mirror_joint(sn_scene *s, int32_t i, const char *name, const sn_plane *plane, sn_error *err)
{
    char parent[160], child[160];
    sn_vec3 axis[3], center = sn_plane_reflect(plane, s->joint[i].center);
    (void)sn_side_name_swap(s->joint[i].parent, parent, sizeof parent);
    (void)sn_side_name_swap(s->joint[i].child, child, sizeof child);
    for (int k = 0; k < 3; k++) axis[k] = sn_plane_reflect_vector(plane, s->joint[i].axis[k]);
    axis[2] = sn_v3_scale(-1.0, axis[2]);
    int32_t old = find_joint(s, name);
    if (old >= 0) {
        s->joint[old].center = center;
        memcpy(s->joint[old].axis, axis, sizeof axis);
        s->revision++;
        return SN_OK;
    }
    return sn_scene_add_joint(s, name, parent, child, center, axis, err);
}

sn_status sn_scene_mirror_joints(sn_scene *s, sn_vec3 point, sn_vec3 normal, sn_error *err)
{
    sn_plane plane;
    int32_t n = s->n_joint;
    sn_status st = sn_plane_make(&plane, "mirror_bones", point, normal, err);
    for (int32_t i = 0; i < n && !st; i++) {
        char other[160];
        bool has_side = sn_side_name_swap(s->joint[i].name, other, sizeof other);
        if (!has_side || (sn_side_of(s->joint[i].name) == SN_SIDE_RIGHT && find_joint(s, other) >= 0))
            continue;
        st = mirror_joint(s, i, other, &plane, err);
    }
    return st;
}
