/* vec3.h - points and vectors of three doubles. Small enough to pass by value. */
#ifndef SN_BASE_VEC3_H
#define SN_BASE_VEC3_H

#include <math.h>
#include <stddef.h>
#include <stdbool.h>

typedef struct sn_vec3 {
    double x, y, z;
} sn_vec3;

typedef struct sn_box3 { /* empty when min.x > max.x */
    sn_vec3 min, max;
} sn_box3;

static inline sn_vec3 sn_v3(double x, double y, double z)
{
    return (sn_vec3){x, y, z};
}
static inline sn_vec3 sn_v3_load(const double *p)
{
    return (sn_vec3){p[0], p[1], p[2]};
}
static inline void sn_v3_store(double *p, sn_vec3 a)
{
    p[0] = a.x;
    p[1] = a.y;
    p[2] = a.z;
}
static inline sn_vec3 sn_v3_add(sn_vec3 a, sn_vec3 b)
{
    return sn_v3(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline sn_vec3 sn_v3_sub(sn_vec3 a, sn_vec3 b)
{
    return sn_v3(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline sn_vec3 sn_v3_scale(double s, sn_vec3 a)
{
    return sn_v3(s * a.x, s * a.y, s * a.z);
}
static inline sn_vec3 sn_v3_mad(sn_vec3 a, double s, sn_vec3 b) /* a + s b */
{
    return sn_v3(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}
static inline sn_vec3 sn_v3_lerp(sn_vec3 a, sn_vec3 b, double t)
{
    return sn_v3(a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z));
}
static inline double sn_v3_dot(sn_vec3 a, sn_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline sn_vec3 sn_v3_cross(sn_vec3 a, sn_vec3 b)
{
    return sn_v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline double sn_v3_len2(sn_vec3 a)
{
    return sn_v3_dot(a, a);
}
static inline double sn_v3_len(sn_vec3 a)
{
    return sqrt(sn_v3_dot(a, a));
}
static inline double sn_v3_dist(sn_vec3 a, sn_vec3 b)
{
    return sn_v3_len(sn_v3_sub(a, b));
}
/* a / |a|; the zero vector stays zero. */
static inline sn_vec3 sn_v3_unit(sn_vec3 a)
{
    double n = sn_v3_len(a);
    return n > 0.0 ? sn_v3_scale(1.0 / n, a) : a;
}
static inline bool sn_v3_is_finite(sn_vec3 a)
{
    return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}
/* det[a, b, c]: six times the volume of the tet they span with the origin. Not an exact predicate. */
static inline double sn_v3_det(sn_vec3 a, sn_vec3 b, sn_vec3 c)
{
    return sn_v3_dot(a, sn_v3_cross(b, c));
}

static inline sn_box3 sn_box3_empty(void)
{
    return (sn_box3){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}
static inline sn_box3 sn_box3_add(sn_box3 b, sn_vec3 p)
{
    return (sn_box3){{fmin(b.min.x, p.x), fmin(b.min.y, p.y), fmin(b.min.z, p.z)},
                     {fmax(b.max.x, p.x), fmax(b.max.y, p.y), fmax(b.max.z, p.z)}};
}
static inline sn_box3 sn_box3_merge(sn_box3 a, sn_box3 b)
{
    return (sn_box3){{fmin(a.min.x, b.min.x), fmin(a.min.y, b.min.y), fmin(a.min.z, b.min.z)},
                     {fmax(a.max.x, b.max.x), fmax(a.max.y, b.max.y), fmax(a.max.z, b.max.z)}};
}
static inline bool sn_box3_is_empty(sn_box3 b)
{
    return !(b.min.x <= b.max.x);
}
/* 0 for an empty box. */
static inline double sn_box3_diagonal(sn_box3 b)
{
    return sn_box3_is_empty(b) ? 0.0 : sn_v3_dist(b.min, b.max);
}

#endif
