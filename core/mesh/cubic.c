#include "mesh/cubic.h"

sn_vec3 sn_cubic_point(const sn_cubic *c, double s)
{
    return sn_v3_mad(c->c[0], s, sn_v3_mad(c->c[1], s, sn_v3_mad(c->c[2], s, c->c[3])));
}

sn_vec3 sn_cubic_tangent(const sn_cubic *c, double s)
{
    return sn_v3_mad(c->c[1], s, sn_v3_mad(sn_v3_scale(2.0, c->c[2]), 3.0 * s, c->c[3]));
}

/* Gauss-Legendre with five points on panels of at most 1/4: 1e-10 for curves without near-cusps. */
double sn_cubic_length(const sn_cubic *c, double s0, double s1)
{
    static const double x[5] = {0.0, 0.5384693101056831, -0.5384693101056831, 0.9061798459386640,
                                -0.9061798459386640};
    static const double w[5] = {0.5688888888888889, 0.4786286704993665, 0.4786286704993665,
                                0.2369268850561891, 0.2369268850561891};
    int n = (int)ceil(4.0 * (s1 - s0));
    double sum = 0.0;
    for (int i = 0; i < n; i++) {
        double a = s0 + (s1 - s0) * i / n, h = 0.5 * (s1 - s0) / n;
        for (int k = 0; k < 5; k++) sum += h * w[k] * sn_v3_len(sn_cubic_tangent(c, a + h + h * x[k]));
    }
    return sum;
}
