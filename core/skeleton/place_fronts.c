/* place_fronts.c - which way the bones of a row look: no flips along the curve. */
#include "base/alloc.h"
#include "skeleton/place_private.h"

#include <math.h>

static const double NEAR_TANGENT_DEG = 20.0; /* nearer to the tangent, front says too little about the turn */
#define PI 3.14159265358979323846

/* A frame carried along the curve by the smallest turns, to measure angles from. */
static void carry_along(const sn_vec3 *tangent, int32_t n, sn_vec3 *u)
{
    u[0] = sn_any_across(tangent[0]);
    for (int32_t i = 1; i < n; i++)
        u[i] = sn_v3_unit(sn_across(sn_turn_along(u[i - 1], tangent[i - 1], tangent[i]), tangent[i]));
}

/* angle[i]: of front seen across the tangent, from u[i], NAN where it is too near to it. The line of front
 * counts, not its direction: each angle is the one, of those half a turn apart, that is nearest to the angle
 * before. In the end the place that sees front best has it on the right side. false when all are NAN. */
static bool measure_angles(const sn_vec3 *tangent, const sn_vec3 *u, int32_t n, sn_vec3 front, double *angle)
{
    double least = sin(NEAR_TANGENT_DEG * SN_RADIANS), best = 0.0, before = NAN, half = 0.0;
    for (int32_t i = 0; i < n; i++) {
        sn_vec3 q = sn_across(front, tangent[i]);
        double seen = sn_v3_len(q);
        angle[i] = NAN;
        if (seen < least) continue;
        double a = atan2(sn_v3_dot(sn_v3_cross(tangent[i], u[i]), q), sn_v3_dot(u[i], q));
        double n_half = isnan(before) ? 0.0 : round((before - a) / PI);
        before = angle[i] = a + PI * n_half;
        if (seen > best * (1.0 + 1e-9)) { /* of equal ones the first, whatever rounding does */
            best = seen;
            half = n_half;
        }
    }
    for (int32_t i = 0; i < n && fmod(half, 2.0) != 0.0; i++) angle[i] += PI;
    return best > 0.0;
}

/* From the angle before a gap to the one after it evenly; a gap at an end takes its neighbour's. */
static void fill_gaps(double *angle, int32_t n)
{
    for (int32_t i = 0, end; i < n; i = end + 1) {
        for (end = i; end < n && isnan(angle[end]);) end++;
        double after = end < n ? angle[end] : angle[i - 1], before = i > 0 ? angle[i - 1] : after;
        for (int32_t k = i; k < end; k++) angle[k] = before + (after - before) * (k - i + 1) / (end - i + 1);
    }
}

sn_status sn_row_fronts(const sn_vec3 *tangent, int32_t n, sn_vec3 front, sn_vec3 *out, sn_error *err)
{
    double *angle = SN_NEW(double, n);
    if (!angle) return sn_fail(err, SN_ENOMEM, "curve bones: no memory for %d directions", n);
    carry_along(tangent, n, out);
    if (measure_angles(tangent, out, n, front, angle)) {
        fill_gaps(angle, n);
    } else { /* the curve runs along front: as the smallest turn of the template has it */
        sn_vec3 z = sn_turn_along(sn_v3(0, 0, 1), sn_v3(0, 1, 0), tangent[0]);
        double a = atan2(sn_v3_dot(sn_v3_cross(tangent[0], out[0]), z), sn_v3_dot(out[0], z));
        for (int32_t i = 0; i < n; i++) angle[i] = a;
    }
    for (int32_t i = 0; i < n; i++) {
        sn_vec3 v = sn_v3_cross(tangent[i], out[i]);
        out[i] = sn_v3_add(sn_v3_scale(cos(angle[i]), out[i]), sn_v3_scale(sin(angle[i]), v));
    }
    sn_release(angle);
    return SN_OK;
}
