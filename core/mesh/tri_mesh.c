#include "mesh/tri_mesh.h"

#include "base/alloc.h"
#include "base/array.h"

#include <string.h>

void sn_tri_mesh_init(sn_tri_mesh *m)
{
    memset(m, 0, sizeof *m);
}

void sn_tri_mesh_free(sn_tri_mesh *m)
{
    sn_release(m->pos);
    sn_release(m->face);
    sn_release(m->label);
    sn_tri_mesh_init(m);
}

sn_status sn_tri_mesh_reserve(sn_tri_mesh *m, int32_t n_vert, int32_t n_face, sn_error *err)
{
    sn_tri_mesh_free(m);
    m->pos = SN_NEW(double, 3 * (size_t)n_vert);
    m->face = SN_NEW(int32_t, 3 * (size_t)n_face);
    if (!m->pos || !m->face) {
        sn_tri_mesh_free(m);
        return sn_fail(err, SN_ENOMEM, "surface: no memory for %d vertices and %d faces", n_vert, n_face);
    }
    m->n_vert = n_vert;
    m->n_face = n_face;
    return SN_OK;
}

sn_status sn_tri_mesh_copy(sn_tri_mesh *out, const sn_tri_mesh *m, sn_error *err)
{
    sn_status st = sn_tri_mesh_reserve(out, m->n_vert, m->n_face, err);
    if (st) return st;
    if (m->n_vert > 0) memcpy(out->pos, m->pos, 3 * (size_t)m->n_vert * sizeof *m->pos);
    if (m->n_face > 0) memcpy(out->face, m->face, 3 * (size_t)m->n_face * sizeof *m->face);
    if (!m->label || m->n_face == 0) return SN_OK;
    out->label = SN_NEW(int32_t, m->n_face);
    if (!out->label) {
        sn_tri_mesh_free(out);
        return sn_fail(err, SN_ENOMEM, "surface: no memory for %d labels", m->n_face);
    }
    memcpy(out->label, m->label, (size_t)m->n_face * sizeof *m->label);
    return SN_OK;
}

sn_status sn_tri_mesh_validate(const sn_tri_mesh *m, sn_error *err)
{
    if (m->n_face < 1) return sn_fail(err, SN_EINVAL, "surface has no faces");
    for (int32_t i = 0; i < m->n_vert; i++)
        if (!sn_v3_is_finite(sn_tri_mesh_point(m, i)))
            return sn_fail(err, SN_EINVAL, "vertex %d has a coordinate that is not finite", i + 1);
    for (int32_t f = 0; f < m->n_face; f++)
        for (int k = 0; k < 3; k++) {
            int32_t v = m->face[3 * (size_t)f + (size_t)k];
            if (v < 0 || v >= m->n_vert)
                return sn_fail(err, SN_EINVAL, "face %d names vertex %lld, need 1..%d", f + 1,
                               (long long)v + 1, m->n_vert);
        }
    return SN_OK;
}

sn_box3 sn_tri_mesh_bounds(const sn_tri_mesh *m)
{
    sn_box3 b = sn_box3_empty();
    for (int32_t i = 0; i < m->n_vert; i++) b = sn_box3_add(b, sn_tri_mesh_point(m, i));
    return b;
}

sn_vec3 sn_tri_mesh_face_normal(const sn_tri_mesh *m, int32_t i_face)
{
    const int32_t *f = m->face + 3 * (size_t)i_face;
    sn_vec3 a = sn_tri_mesh_point(m, f[0]);
    return sn_v3_cross(sn_v3_sub(sn_tri_mesh_point(m, f[1]), a), sn_v3_sub(sn_tri_mesh_point(m, f[2]), a));
}

double sn_tri_mesh_area(const sn_tri_mesh *m)
{
    double sum = 0.0;
    for (int32_t f = 0; f < m->n_face; f++) sum += sn_v3_len(sn_tri_mesh_face_normal(m, f));
    return 0.5 * sum;
}

double sn_tri_mesh_volume(const sn_tri_mesh *m)
{
    if (m->n_face == 0) return 0.0;
    sn_vec3 o = sn_tri_mesh_point(m, m->face[0]); /* near the surface: less cancellation than the origin */
    double sum = 0.0;
    for (int32_t f = 0; f < m->n_face; f++) {
        const int32_t *v = m->face + 3 * (size_t)f;
        sum += sn_v3_det(sn_v3_sub(sn_tri_mesh_point(m, v[0]), o), sn_v3_sub(sn_tri_mesh_point(m, v[1]), o),
                         sn_v3_sub(sn_tri_mesh_point(m, v[2]), o));
    }
    return sum / 6.0;
}

static sn_vec3 rotate(sn_vec3 p, sn_vec3 k, double c, double s) /* Rodrigues; |k| = 1 */
{
    sn_vec3 q = sn_v3_mad(sn_v3_scale(c, p), s, sn_v3_cross(k, p));
    return sn_v3_mad(q, (1.0 - c) * sn_v3_dot(k, p), k);
}

sn_status sn_tri_mesh_transform(sn_tri_mesh *m, const sn_transform *t, sn_error *err)
{
    if (!(t->scale > 0.0 && isfinite(t->scale)))
        return sn_fail(err, SN_EINVAL, "transform: scale is %g, need > 0", t->scale);
    if (!sn_v3_is_finite(t->axis) || !isfinite(t->angle_deg) || !sn_v3_is_finite(t->translate))
        return sn_fail(err, SN_EINVAL, "transform: axis, angle or translation is not finite");
    double angle = t->angle_deg * (3.14159265358979323846 / 180.0), c = cos(angle), s = sin(angle);
    sn_vec3 axis = sn_v3_unit(t->axis);
    bool turns = sn_v3_len2(axis) > 0.0 && t->angle_deg != 0.0;
    for (int32_t i = 0; i < m->n_vert; i++) {
        sn_vec3 p = sn_v3_scale(t->scale, sn_tri_mesh_point(m, i));
        if (turns) p = rotate(p, axis, c, s);
        sn_v3_store(m->pos + 3 * (size_t)i, sn_v3_add(p, t->translate));
    }
    return SN_OK;
}

sn_status sn_tri_mesh_mirror(sn_tri_mesh *m, sn_vec3 point, sn_vec3 normal, sn_error *err)
{
    sn_vec3 n = sn_v3_unit(normal);
    if (!sn_v3_is_finite(point) || !sn_v3_is_finite(n) || sn_v3_len2(n) == 0.0)
        return sn_fail(err, SN_EINVAL,
                       "mirror: the plane needs a finite point and a normal that is not zero");
    for (int32_t i = 0; i < m->n_vert; i++) {
        sn_vec3 p = sn_tri_mesh_point(m, i);
        sn_v3_store(m->pos + 3 * (size_t)i, sn_v3_mad(p, -2.0 * sn_v3_dot(n, sn_v3_sub(p, point)), n));
    }
    for (int32_t f = 0; f < m->n_face; f++) {
        int32_t *v = m->face + 3 * (size_t)f, swap = v[1];
        v[1] = v[2];
        v[2] = swap;
    }
    return SN_OK;
}

static uint64_t hash_point(const double *p)
{
    uint64_t h = 0;
    for (int k = 0; k < 3; k++) {
        double x = p[k] + 0.0; /* -0 -> 0 */
        uint64_t bits;
        memcpy(&bits, &x, sizeof bits);
        h = (h ^ bits) * 0x9e3779b97f4a7c15u;
        h ^= h >> 29;
    }
    return h * 0xbf58476d1ce4e5b9u >> 20;
}

/* to[i]: the first vertex at the place of i. The result does not depend on the hash. false: no memory. */
static bool find_first_equal(const sn_tri_mesh *m, int32_t *to)
{
    size_t n_slot = 16;
    while (n_slot < 2 * (size_t)m->n_vert) n_slot *= 2;
    int32_t *slot = SN_NEW(int32_t, n_slot);
    if (!slot) return false;
    memset(slot, 0xff, n_slot * sizeof *slot); /* -1: free */
    for (int32_t i = 0; i < m->n_vert; i++) {
        const double *p = m->pos + 3 * (size_t)i;
        size_t at = hash_point(p) & (n_slot - 1);
        for (; slot[at] >= 0; at = (at + 1) & (n_slot - 1)) {
            const double *q = m->pos + 3 * (size_t)slot[at];
            if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) break;
        }
        if (slot[at] < 0) slot[at] = i;
        to[i] = slot[at];
    }
    sn_release(slot);
    return true;
}

sn_status sn_tri_mesh_weld(sn_tri_mesh *m, int32_t *n_joined, sn_error *err)
{
    int32_t *to = SN_NEW(int32_t, m->n_vert);
    if (!to || !find_first_equal(m, to)) {
        sn_release(to);
        return sn_fail(err, SN_ENOMEM, "weld: no memory for %d vertices", m->n_vert);
    }
    int32_t n = 0;
    for (int32_t i = 0; i < m->n_vert; i++) {
        if (to[i] == i) {
            memmove(m->pos + 3 * (size_t)n, m->pos + 3 * (size_t)i, 3 * sizeof *m->pos);
            to[i] = n++;
        } else {
            to[i] = to[to[i]];
        }
    }
    for (size_t k = 0; k < 3 * (size_t)m->n_face; k++) m->face[k] = to[m->face[k]];
    if (n_joined) *n_joined = m->n_vert - n;
    m->n_vert = n;
    sn_release(to);
    return SN_OK;
}
