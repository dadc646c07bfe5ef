#include "mesh/affine.h"

sn_affine sn_affine_identity(void)
{
    return (sn_affine){.col = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
}

sn_affine sn_affine_translation(sn_vec3 v)
{
    sn_affine a = sn_affine_identity();
    a.t = v;
    return a;
}

/* The map with this M that leaves a point where it is. */
static sn_affine about_point(sn_affine a, sn_vec3 fixed)
{
    a.t = sn_v3_sub(fixed, sn_affine_vector(&a, fixed));
    return a;
}

sn_affine sn_affine_rotation(sn_vec3 axis, double angle_deg, sn_vec3 about)
{
    double angle = angle_deg * (3.14159265358979323846 / 180.0), c = cos(angle), s = sin(angle);
    sn_vec3 u = sn_v3_unit(axis);
    sn_affine a = sn_affine_identity();
    for (int k = 0; k < 3; k++) { /* Rodrigues */
        sn_vec3 e = a.col[k];
        sn_vec3 along = sn_v3_scale((1.0 - c) * sn_v3_dot(u, e), u);
        a.col[k] = sn_v3_add(sn_v3_add(sn_v3_scale(c, e), along), sn_v3_scale(s, sn_v3_cross(u, e)));
    }
    return about_point(a, about);
}

sn_affine sn_affine_scale(double k, sn_vec3 about)
{
    sn_affine a = {.col = {{k, 0, 0}, {0, k, 0}, {0, 0, k}}};
    return about_point(a, about);
}

sn_affine sn_affine_mirror(sn_vec3 point, sn_vec3 normal)
{
    sn_vec3 n = sn_v3_unit(normal);
    sn_affine a = sn_affine_identity();
    for (int k = 0; k < 3; k++) a.col[k] = sn_v3_mad(a.col[k], -2.0 * sn_v3_dot(a.col[k], n), n);
    a.t = sn_v3_scale(2.0 * sn_v3_dot(point, n), n);
    return a;
}

sn_affine sn_affine_after(sn_affine second, sn_affine first)
{
    sn_affine a;
    for (int k = 0; k < 3; k++) a.col[k] = sn_affine_vector(&second, first.col[k]);
    a.t = sn_affine_point(&second, first.t);
    return a;
}

sn_vec3 sn_affine_vector(const sn_affine *a, sn_vec3 v)
{
    return sn_v3_add(sn_v3_scale(v.x, a->col[0]),
                     sn_v3_add(sn_v3_scale(v.y, a->col[1]), sn_v3_scale(v.z, a->col[2])));
}

sn_vec3 sn_affine_point(const sn_affine *a, sn_vec3 p)
{
    return sn_v3_add(sn_affine_vector(a, p), a->t);
}

double sn_affine_det(const sn_affine *a)
{
    return sn_v3_det(a->col[0], a->col[1], a->col[2]);
}

void sn_affine_mesh(const sn_affine *a, sn_tri_mesh *m)
{
    for (int32_t v = 0; v < m->n_vert; v++)
        sn_v3_store(m->pos + 3 * (size_t)v, sn_affine_point(a, sn_tri_mesh_point(m, v)));
    for (int32_t f = 0; f < m->n_face && sn_affine_det(a) < 0.0; f++) {
        int32_t *c = m->face + 3 * (size_t)f, swap = c[1];
        c[1] = c[2];
        c[2] = swap;
    }
}
