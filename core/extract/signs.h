/* signs.h - exact signs of the small determinants that decide the maximization diagram.
 *
 * Tissue values are integers of at most SN_GRID_BITS bits. Where a determinant is zero, tissue i counts as
 * raised by a constant d_i with d_0 >> d_1 >> ... > 0: ties go to the lower id. A constant shift per function
 * moves every tie set off every other, and a determinant of ties is linear in the shifts, so its sign is that
 * of the first of: the determinant itself, the coefficient of the lowest tissue, of the next, ... that is not
 * zero.
 *
 * Rows are differences base - other over the vertices of a simplex. Row r belongs to tissue id[r]. */
#ifndef SN_EXTRACT_SIGNS_H
#define SN_EXTRACT_SIGNS_H

#include <stdint.h>

#define SN_GRID_BITS 28 /* 4 x 4 determinants of 29-bit differences stay below 2^121 */

__extension__ typedef __int128 sn_i128;

static inline int sn_sign64(int64_t x)
{
    return (x > 0) - (x < 0);
}
static inline int sn_sign128(sn_i128 x)
{
    return (x > 0) - (x < 0);
}

static inline int64_t sn_det2(const int64_t p[2], const int64_t q[2])
{
    return p[0] * q[1] - p[1] * q[0];
}
static inline sn_i128 sn_det3(const int64_t p[3], const int64_t q[3], const int64_t r[3])
{
    return (sn_i128)p[0] * (q[1] * r[2] - q[2] * r[1]) - (sn_i128)p[1] * (q[0] * r[2] - q[2] * r[0]) +
           (sn_i128)p[2] * (q[0] * r[1] - q[1] * r[0]);
}
static inline sn_i128 sn_det4(const int64_t p[4], const int64_t q[4], const int64_t r[4], const int64_t t[4])
{
#define M(a, b, i, j) (a[i] * b[j] - a[j] * b[i])
    return (sn_i128)M(p, q, 0, 1) * M(r, t, 2, 3) - (sn_i128)M(p, q, 0, 2) * M(r, t, 1, 3) +
           (sn_i128)M(p, q, 0, 3) * M(r, t, 1, 2) + (sn_i128)M(p, q, 1, 2) * M(r, t, 0, 3) -
           (sn_i128)M(p, q, 1, 3) * M(r, t, 0, 2) + (sn_i128)M(p, q, 2, 3) * M(r, t, 0, 1);
#undef M
}

/* Sign by the shifts: coef[r] is the determinant with row r replaced by ones, which multiplies d_base -
 * d_id[r]. */
static inline int sn_sign_by_shift(int32_t base, const int32_t *id, const sn_i128 *coef, int n)
{
    sn_i128 of_base = 0;
    for (int r = 0; r < n; r++) of_base += coef[r];
    for (int32_t last = -1;;) { /* ascending ids; n is at most 4 */
        int32_t next = base > last ? base : INT32_MAX;
        int at = -1;
        for (int r = 0; r < n; r++)
            if (id[r] > last && id[r] < next) {
                next = id[r];
                at = r;
            }
        if (next == INT32_MAX) return 0;
        int s = at < 0 ? sn_sign128(of_base) : -sn_sign128(coef[at]);
        if (s) return s;
        last = next;
    }
}

/* f_a(v) - f_b(v) */
static inline int sn_sign_above(int64_t fa, int32_t a, int64_t fb, int32_t b)
{
    return fa != fb ? sn_sign64(fa - fb) : (a < b) - (a > b);
}

/* det[p; q] over the two ends of an edge. */
static inline int sn_sign2(int32_t base, const int64_t p[2], const int64_t q[2], const int32_t id[2])
{
    int s = sn_sign64(sn_det2(p, q));
    if (s) return s;
    sn_i128 coef[2] = {q[1] - q[0], p[0] - p[1]};
    return sn_sign_by_shift(base, id, coef, 2);
}

/* det[p; q; r] over the corners of a face. */
static inline int sn_sign3(int32_t base, const int64_t p[3], const int64_t q[3], const int64_t r[3],
                           const int32_t id[3])
{
    static const int64_t one[3] = {1, 1, 1};
    int s = sn_sign128(sn_det3(p, q, r));
    if (s) return s;
    sn_i128 coef[3] = {sn_det3(one, q, r), sn_det3(p, one, r), sn_det3(p, q, one)};
    return sn_sign_by_shift(base, id, coef, 3);
}

/* det[p; q; r; t] over the corners of a tet. */
static inline int sn_sign4(int32_t base, const int64_t p[4], const int64_t q[4], const int64_t r[4],
                           const int64_t t[4], const int32_t id[4])
{
    static const int64_t one[4] = {1, 1, 1, 1};
    int s = sn_sign128(sn_det4(p, q, r, t));
    if (s) return s;
    sn_i128 coef[4] = {sn_det4(one, q, r, t), sn_det4(p, one, r, t), sn_det4(p, q, one, t),
                       sn_det4(p, q, r, one)};
    return sn_sign_by_shift(base, id, coef, 4);
}

#endif
