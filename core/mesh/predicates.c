#include "mesh/predicates.h"

#include <gmp.h>
#include <stdint.h>
#include <string.h>

/* Doubles are multiples of 2^-1074 below 2^1024: a coordinate scaled to an integer has at most 2098 bits, a
 * difference 2099, the sum of six products of three differences 6300. Real data needs one to six limbs of the
 * room below. */
enum { LIMB_BITS = GMP_NUMB_BITS, MAX_LIMBS = 6400 / LIMB_BITS + 6 };

typedef struct big { /* sign * magnitude */
    int sign;        /* -1, 0, 1         */
    mp_size_t n;     /* limbs in use; 0 for zero, else the last one is not 0 */
    mp_limb_t d[MAX_LIMBS];
} big;

/* x = *m * 2^e with odd *m; zero gives 0 and 0. */
static int split_double(double x, int64_t *m)
{
    int e;
    double f = frexp(x, &e);
    *m = (int64_t)ldexp(f, 53);
    if (*m == 0) return 0;
    int zeros = __builtin_ctzll((unsigned long long)*m);
    *m /= (int64_t)1 << zeros;
    return e - 53 + zeros;
}

/* The largest power of two (as an exponent) that all n numbers are multiples of. */
static int common_exponent(const double *x, int n)
{
    int least = 0;
    bool any = false;
    for (int k = 0; k < n; k++) {
        int64_t m;
        int e = split_double(x[k], &m);
        if (m != 0 && (!any || e < least)) {
            least = e;
            any = true;
        }
    }
    return least;
}

static void trim(big *r)
{
    while (r->n > 0 && r->d[r->n - 1] == 0) r->n--;
    if (r->n == 0) r->sign = 0;
}

/* r = x / 2^e, which must be an integer. */
static void big_set(big *r, double x, int e)
{
    int64_t m;
    int shift = split_double(x, &m) - e;
    r->sign = (m > 0) - (m < 0);
    r->n = 0;
    if (m == 0) return;
    mp_limb_t limbs[64 / LIMB_BITS + 1] = {0};
    uint64_t rest = m < 0 ? (uint64_t)-m : (uint64_t)m;
    for (int k = 0; k < 64 / LIMB_BITS; k++) limbs[k] = (mp_limb_t)(rest >> (k * LIMB_BITS));
    mp_size_t low = shift / LIMB_BITS, count = 64 / LIMB_BITS + 1;
    memset(r->d, 0, (size_t)low * sizeof r->d[0]);
    if (shift % LIMB_BITS)
        mpn_lshift(r->d + low, limbs, count, (unsigned)(shift % LIMB_BITS));
    else
        memcpy(r->d + low, limbs, sizeof limbs);
    r->n = low + count;
    trim(r);
}

/* r = a + b_sign * |b|; r is neither a nor b. */
static void add_signed(big *r, const big *a, const big *b, int b_sign)
{
    if (b->n > a->n || (b->n == a->n && b->n > 0 && mpn_cmp(b->d, a->d, b->n) > 0)) {
        const big *swap = a; /* now |a| >= |b| */
        int a_sign = a->sign;
        a = b;
        b = swap;
        r->sign = b_sign;
        b_sign = a_sign;
    } else {
        r->sign = a->sign;
    }
    r->n = a->n;
    if (b->n == 0) {
        memcpy(r->d, a->d, (size_t)a->n * sizeof a->d[0]);
    } else if (r->sign == b_sign) {
        mp_limb_t carry = mpn_add(r->d, a->d, a->n, b->d, b->n);
        if (carry) r->d[r->n++] = carry;
    } else {
        mpn_sub(r->d, a->d, a->n, b->d, b->n);
    }
    trim(r);
}

static void big_add(big *r, const big *a, const big *b)
{
    add_signed(r, a, b, b->sign);
}

static void big_sub(big *r, const big *a, const big *b)
{
    add_signed(r, a, b, -b->sign);
}

static void big_mul(big *r, const big *a, const big *b)
{
    r->sign = a->sign * b->sign;
    r->n = 0;
    if (r->sign == 0) return;
    r->n = a->n + b->n;
    if (a->n >= b->n)
        mpn_mul(r->d, a->d, a->n, b->d, b->n);
    else
        mpn_mul(r->d, b->d, b->n, a->d, a->n);
    trim(r);
}

/* r = a d - b c */
static void big_det2(big *r, const big *a, const big *b, const big *c, const big *d)
{
    big left, right;
    big_mul(&left, a, d);
    big_mul(&right, b, c);
    big_sub(r, &left, &right);
}

static void difference(big r[3], sn_vec3 p, sn_vec3 q, int e) /* p - q */
{
    const double a[3] = {p.x, p.y, p.z}, b[3] = {q.x, q.y, q.z};
    for (int k = 0; k < 3; k++) {
        big s, t;
        big_set(&s, a[k], e);
        big_set(&t, b[k], e);
        big_sub(&r[k], &s, &t);
    }
}

static bool has_equal_axis(sn_vec3 a, sn_vec3 b, sn_vec3 c, sn_vec3 d)
{
    return (a.x == b.x && a.x == c.x && a.x == d.x) || (a.y == b.y && a.y == c.y && a.y == d.y) ||
           (a.z == b.z && a.z == c.z && a.z == d.z);
}

int sn_orient3d_exact(sn_vec3 a, sn_vec3 b, sn_vec3 c, sn_vec3 d)
{
    if (has_equal_axis(a, b, c, d)) return 0; /* most exact zeros of real models are axis-aligned planes */
    const double x[12] = {a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, d.x, d.y, d.z};
    int e = common_exponent(x, 12);
    big u[3], v[3], w[3], sum, next, minor, term;
    difference(u, b, a, e);
    difference(v, c, a, e);
    difference(w, d, a, e);
    sum.sign = 0;
    sum.n = 0;
    for (int k = 0; k < 3; k++) {
        int s = (k + 1) % 3, t = (k + 2) % 3;
        if (w[k].sign == 0) continue;
        big_det2(&minor, &u[s], &u[t], &v[s], &v[t]);
        big_mul(&term, &w[k], &minor);
        big_add(&next, &sum, &term);
        sum.sign = next.sign;
        sum.n = next.n;
        memcpy(sum.d, next.d, (size_t)next.n * sizeof next.d[0]);
    }
    return sum.sign;
}

int sn_orient2d_exact(sn_vec3 a, sn_vec3 b, sn_vec3 c, int axis)
{
    double x[6];
    sn_drop_axis(a, axis, &x[0], &x[1]);
    sn_drop_axis(b, axis, &x[2], &x[3]);
    sn_drop_axis(c, axis, &x[4], &x[5]);
    if ((x[0] == x[2] && x[0] == x[4]) || (x[1] == x[3] && x[1] == x[5])) return 0;
    int e = common_exponent(x, 6);
    big p[6], us, ut, vs, vt, det;
    for (int k = 0; k < 6; k++) big_set(&p[k], x[k], e);
    big_sub(&us, &p[2], &p[0]);
    big_sub(&ut, &p[3], &p[1]);
    big_sub(&vs, &p[4], &p[0]);
    big_sub(&vt, &p[5], &p[1]);
    big_det2(&det, &us, &ut, &vs, &vt);
    return det.sign;
}

bool sn_triangle_is_degenerate(sn_vec3 a, sn_vec3 b, sn_vec3 c)
{
    for (int axis = 0; axis < 3; axis++)
        if (sn_orient2d(a, b, c, axis) != 0) return false;
    return true;
}
