#include "skeleton/bone_template.h"

#include "base/alloc.h"
#include "mesh/affine.h"
#include "mesh/mesh_check.h"

#include <string.h>

const char *sn_bone_kind_name(sn_bone_kind kind)
{
    static const char *const name[] = {"cylinder", "curve", "shape"};
    return name[kind];
}

void sn_landmarks_free(sn_landmark *landmark, int32_t n)
{
    for (int32_t i = 0; landmark && i < n; i++) sn_release(landmark[i].name);
    sn_release(landmark);
}

sn_status sn_landmarks_copy(sn_landmark **out, const sn_landmark *landmark, int32_t n, sn_error *err)
{
    *out = NULL;
    if (n == 0) return SN_OK;
    sn_landmark *copy = SN_NEW_ZERO(sn_landmark, n);
    sn_status st = copy ? SN_OK : sn_fail(err, SN_ENOMEM, "landmarks: no memory for %d", n);
    for (int32_t i = 0; i < n && !st; i++) {
        copy[i] = landmark[i];
        copy[i].name = sn_strdup(landmark[i].name);
        if (!copy[i].name) st = sn_fail(err, SN_ENOMEM, "landmarks: no memory for %d", n);
    }
    if (st)
        sn_landmarks_free(copy, n);
    else
        *out = copy;
    return st;
}

void sn_bone_template_free(sn_bone_template *t)
{
    sn_release(t->name);
    sn_tri_mesh_free(&t->bone);
    sn_tri_mesh_free(&t->cage);
    sn_tri_mesh_free(&t->skin);
    sn_landmarks_free(t->landmark, t->n_landmark);
    memset(t, 0, sizeof *t);
}

/* ---- check ---- */

static sn_status check_closed(const sn_bone_template *t, const char *what, const sn_tri_mesh *m,
                              sn_error *err)
{
    sn_mesh_check r;
    sn_status st = sn_tri_mesh_validate(m, err);
    if (!st) st = sn_mesh_check_topology(&r, m, err);
    if (st) return sn_fail_prefix(err, st, "template '%s': %s: ", t->name, what);
    if (r.closed && r.oriented && sn_tri_mesh_volume(m) > 0.0) return SN_OK;
    return sn_fail(err, SN_EINVAL,
                   "template '%s': the %s is not a closed surface with its faces outwards (surface:check() "
                   "tells, surface:repair{} may mend it)",
                   t->name, what);
}

static sn_status check_handles(const sn_bone_template *t, sn_error *err)
{
    double size = sn_box3_diagonal(sn_tri_mesh_bounds(&t->bone));
    if (t->kind == SN_BONE_CYLINDER && !(sn_v3_dist(t->from, t->to) > 1e-6 * size))
        return sn_fail(err, SN_EINVAL, "template '%s': its ends 'from' and 'to' are one point", t->name);
    if (t->kind == SN_BONE_CURVE && !(t->length > 0.0 && isfinite(t->length)))
        return sn_fail(err, SN_EINVAL, "template '%s': its length along the curve is %g, need > 0", t->name,
                       t->length);
    return SN_OK;
}

static sn_status check_landmarks(const sn_bone_template *t, sn_error *err)
{
    for (int32_t i = 0; i < t->n_landmark; i++) {
        const sn_landmark *l = &t->landmark[i];
        if (!sn_v3_is_finite(l->at) || !(l->radius >= 0.0 && isfinite(l->radius)))
            return sn_fail(err, SN_EINVAL, "template '%s': landmark '%s' is not a finite point and radius",
                           t->name, l->name);
        for (int32_t k = 0; k < i; k++)
            if (strcmp(l->name, t->landmark[k].name) == 0)
                return sn_fail(err, SN_EINVAL, "template '%s': landmark '%s' is there twice", t->name,
                               l->name);
    }
    return SN_OK;
}

sn_status sn_bone_template_check(const sn_bone_template *t, sn_error *err)
{
    sn_status st = check_closed(t, "bone", &t->bone, err);
    if (!st) st = check_handles(t, err);
    if (!st) st = check_landmarks(t, err);
    if (!st && t->cage.n_face > 0) st = check_closed(t, "cage", &t->cage, err);
    if (!st && t->skin.n_face > 0 && (st = sn_tri_mesh_validate(&t->skin, err)))
        st = sn_fail_prefix(err, st, "template '%s': skin: ", t->name);
    if (!st && (t->cage.n_face > 0) != (t->skin.n_face > 0))
        st = sn_fail(err, SN_EINVAL, "template '%s': it has a %s but no %s: fitting needs both", t->name,
                     t->cage.n_face > 0 ? "cage" : "skin", t->cage.n_face > 0 ? "skin" : "cage");
    return st;
}

sn_status sn_bone_template_align(sn_bone_template *t, sn_vec3 from, sn_vec3 to, sn_vec3 front, sn_error *err)
{
    sn_vec3 y = sn_v3_unit(sn_v3_sub(to, from)), z = sn_v3_mad(front, -sn_v3_dot(front, y), y);
    double distance = sn_v3_dist(from, to);
    if (!(distance > 0.0 && isfinite(distance)) || !(sn_v3_len(z) > 1e-6 * sn_v3_len(front)))
        return sn_fail(err, SN_EINVAL,
                       "template '%s': 'from' and 'to' must be two points, and 'front' across their line",
                       t->name);
    z = sn_v3_unit(z);
    sn_vec3 x = sn_v3_cross(y, z), middle = sn_v3_lerp(from, to, 0.5);
    sn_affine map = {.col = {{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}};
    map.t = sn_v3_scale(-1.0, sn_affine_vector(&map, middle));
    sn_affine_mesh(&map, &t->bone);
    for (int32_t i = 0; i < t->n_landmark; i++) t->landmark[i].at = sn_affine_point(&map, t->landmark[i].at);
    if (t->length == 0.0) t->length = distance;
    return SN_OK;
}
