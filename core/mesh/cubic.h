/* cubic.h - a cubic polynomial in space: one piece of a curve. */
#ifndef SN_MESH_CUBIC_H
#define SN_MESH_CUBIC_H

#include "base/vec3.h"

typedef struct sn_cubic { /* c[0] + c[1] s + c[2] s^2 + c[3] s^3, s in 0..1 */
    sn_vec3 c[4];
} sn_cubic;

sn_vec3 sn_cubic_point(const sn_cubic *c, double s);
sn_vec3 sn_cubic_tangent(const sn_cubic *c, double s); /* derivative by s, not normalised */
double sn_cubic_length(const sn_cubic *c, double s0, double s1);

#endif
