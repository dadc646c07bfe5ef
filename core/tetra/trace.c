#include "tetra/trace.h"

#include "base/alloc.h"

#include <string.h>

#define STEPS_OUTSIDE 1000 /* samples per cubic when looking for the way back in  */
#define BISECTIONS 48
#define MIN_PIECE 1e-9 /* of the curve's length: shorter pieces are dropped    */
#define MAX_STUCK 32   /* steps without advance before the tet is looked up anew */
#define NUDGE 1e-9     /* first parameter step past a corner; doubles until the walk gets on */
#define ON_FACE 1e-11  /* barycentric: a curve along a face or edge counts as inside, in spite of rounding */
#define NUDGE_OUT 1e-6 /* parameter step past the boundary, so that a curve along it ends in time */

void sn_trace_free(sn_trace *t)
{
    sn_release(t->piece);
    memset(t, 0, sizeof *t);
}

/* ---- cubic polynomials ---- */

static double poly(const double a[4], double s)
{
    return a[0] + s * (a[1] + s * (a[2] + s * a[3]));
}

/* A root in [lo, hi], where poly changes from >= 0 to < 0. */
static double bisect(const double a[4], double lo, double hi)
{
    for (int i = 0; i < BISECTIONS; i++) {
        double mid = 0.5 * (lo + hi);
        if (poly(a, mid) >= 0.0)
            lo = mid;
        else
            hi = mid;
    }
    return hi;
}

/* Inner extrema in (lo, hi), ascending; returns how many. */
static int extrema(const double a[4], double lo, double hi, double out[2])
{
    double p = 3.0 * a[3], q = 2.0 * a[2], r = a[1], root[2];
    int n = 0, kept = 0;
    double disc = q * q - 4.0 * p * r;
    if (p == 0.0 && q != 0.0) root[n++] = -r / q;
    if (p != 0.0 && disc >= 0.0) {
        double t = -0.5 * (q + copysign(sqrt(disc), q));
        root[n++] = t / p;
        if (t != 0.0) root[n++] = r / t;
    }
    if (n == 2 && root[0] > root[1]) {
        double s = root[0];
        root[0] = root[1];
        root[1] = s;
    }
    for (int i = 0; i < n; i++)
        if (root[i] > lo && root[i] < hi) out[kept++] = root[i];
    return kept;
}

/* The smallest s in [lo, 1] where poly becomes negative; 2 when it stays >= 0. */
static double first_negative(const double a[4], double lo)
{
    double at[4] = {lo}, inner[2];
    int n = extrema(a, lo, 1.0, inner), k = 1;
    for (int i = 0; i < n; i++) at[k++] = inner[i];
    at[k] = 1.0;
    if (poly(a, lo) < 0.0) {
        /* Rounding on the face just crossed: negative only counts if it gets worse. */
        if (a[1] + lo * (2.0 * a[2] + 3.0 * lo * a[3]) <= 0.0) return lo;
    }
    for (int i = 0; i < k; i++)
        if (poly(a, at[i + 1]) < 0.0) {
            if (poly(a, at[i]) >= 0.0) return bisect(a, at[i], at[i + 1]);
            if (i > 0) return at[i];
        }
    return 2.0;
}

/* Barycentric coordinate functions of the cubic: four polynomials. */
static void bary_polys(const sn_tet_mesh *m, int32_t tet, const sn_cubic *c, double out[4][4])
{
    const int32_t *t = m->tet + 4 * (size_t)tet;
    sn_vec3 a = sn_tet_mesh_point(m, t[0]);
    sn_vec3 e1 = sn_v3_sub(sn_tet_mesh_point(m, t[1]), a), e2 = sn_v3_sub(sn_tet_mesh_point(m, t[2]), a);
    sn_vec3 e3 = sn_v3_sub(sn_tet_mesh_point(m, t[3]), a);
    double det = sn_v3_det(e1, e2, e3);
    sn_vec3 g[3] = {sn_v3_scale(1.0 / det, sn_v3_cross(e2, e3)), sn_v3_scale(1.0 / det, sn_v3_cross(e3, e1)),
                    sn_v3_scale(1.0 / det, sn_v3_cross(e1, e2))};
    for (int d = 0; d < 4; d++) {
        sn_vec3 x = d == 0 ? sn_v3_sub(c->c[0], a) : c->c[d];
        for (int k = 0; k < 3; k++) out[k + 1][d] = sn_v3_dot(g[k], x);
        out[0][d] = (d == 0 ? 1.0 : 0.0) - out[1][d] - out[2][d] - out[3][d];
    }
}

/* ---- walking ---- */

typedef struct walker {
    const sn_body *body;
    const sn_locator *locator;
    const sn_cubic *curve;
    int32_t n_seg;
    sn_trace *out;
    size_t cap;
    double min_length;
    int32_t tet, i_seg; /* where the walk stands; tet < 0: outside */
    double s;
    int32_t open_seg; /* the last piece ran to the end of this cubic; NONE: it ended before */
    double longest;   /* of the last piece's parts on one cubic each */
} walker;

#define NONE (-2)

static sn_trace_piece piece_to(const walker *w, double s_end, double length)
{
    sn_trace_piece p = {.tet = w->tet, .i_seg = w->i_seg, .s = 0.5 * (w->s + s_end), .length = length};
    sn_tet_barycentric(&w->body->mesh, p.tet, sn_cubic_point(&w->curve[w->i_seg], p.s), p.bary);
    return p;
}

/* Knots inside a tet: one piece, one collocation point, on its longest part. */
static void lengthen_last(walker *w, double s_end, double length)
{
    sn_trace_piece *last = &w->out->piece[w->out->n_piece - 1];
    double whole = last->length + length;
    if (length > w->longest) {
        *last = piece_to(w, s_end, length);
        w->longest = length;
    }
    last->length = whole;
}

static bool add_piece(walker *w, double s_end)
{
    double length = s_end > w->s ? sn_cubic_length(&w->curve[w->i_seg], w->s, s_end) : 0.0;
    if (length <= w->min_length) return true;
    if (!sn_grow(&w->out->piece, &w->cap, w->out->n_piece + 1, sizeof *w->out->piece)) return false;
    w->out->length_inside += length;
    size_t n = w->out->n_piece;
    if (n > 0 && w->out->piece[n - 1].tet == w->tet && w->s == 0.0 && w->open_seg == w->i_seg - 1) {
        lengthen_last(w, s_end, length);
    } else {
        w->out->piece[w->out->n_piece++] = piece_to(w, s_end, length);
        w->longest = length;
    }
    w->open_seg = s_end >= 1.0 ? w->i_seg : NONE;
    return true;
}

/* From a point outside: forward to where the curve comes in. false at the end of the curve. */
static bool find_entry(walker *w)
{
    while (w->i_seg < w->n_seg) {
        const sn_cubic *c = &w->curve[w->i_seg];
        double from = w->s;
        int first = (int)floor(w->s * STEPS_OUTSIDE);
        for (int i = first; i <= STEPS_OUTSIDE; i++) {
            double s = i == first ? w->s : (double)i / STEPS_OUTSIDE;
            int32_t tet = sn_locator_find(w->locator, sn_cubic_point(c, s), NULL);
            if (tet < 0) {
                from = s;
                continue;
            }
            double out = from, in = s;
            for (int k = 0; k < BISECTIONS && in > out; k++) {
                double mid = 0.5 * (out + in);
                int32_t t = sn_locator_find(w->locator, sn_cubic_point(c, mid), NULL);
                if (t < 0) {
                    out = mid;
                } else {
                    in = mid;
                    tet = t;
                }
            }
            w->s = in;
            w->tet = tet;
            return true;
        }
        w->i_seg++;
        w->s = 0.0;
    }
    return false;
}

/* Through tets until the curve ends or leaves. */
static bool walk_inside(walker *w)
{
    int stuck = 0;
    double nudge = NUDGE;
    while (w->i_seg < w->n_seg) {
        double b[4][4], s_out = 2.0;
        int face = -1;
        bary_polys(&w->body->mesh, w->tet, &w->curve[w->i_seg], b);
        for (int k = 0; k < 4; k++) {
            double s = first_negative(b[k], w->s);
            if (s < s_out) {
                s_out = s;
                face = k;
            }
        }
        if (face < 0 || s_out >= 1.0) { /* the cubic ends inside this tet */
            if (!add_piece(w, 1.0)) return false;
            w->i_seg++;
            w->s = 0.0;
            continue;
        }
        if (!add_piece(w, s_out)) return false;
        if (s_out > w->s + nudge) nudge = NUDGE;
        stuck = s_out > w->s ? 0 : stuck + 1;
        w->s = s_out;
        int32_t next = w->body->across[4 * (size_t)w->tet + (size_t)face];
        if (stuck > MAX_STUCK) { /* round and round an edge or corner */
            w->s = fmin(1.0, w->s + nudge);
            nudge *= 2.0;
            next = sn_locator_find(w->locator, sn_cubic_point(&w->curve[w->i_seg], w->s), NULL);
            stuck = 0;
        }
        if (next < 0) {
            w->s = fmin(1.0, w->s + NUDGE_OUT);
            w->tet = -1;
            return true;
        }
        w->tet = next;
    }
    return true;
}

sn_status sn_trace_curve(const sn_body *b, const sn_locator *l, const sn_cubic *curve, int32_t n_seg,
                         sn_trace *out, sn_error *err)
{
    double total = 0.0;
    sn_trace_free(out);
    for (int32_t i = 0; i < n_seg; i++) total += sn_cubic_length(&curve[i], 0.0, 1.0);
    walker w = {.body = b, .locator = l, .curve = curve, .n_seg = n_seg, .out = out, .open_seg = NONE};
    w.min_length = MIN_PIECE * total;
    while (w.i_seg < n_seg && find_entry(&w))
        if (!walk_inside(&w)) {
            sn_trace_free(out);
            return sn_fail(err, SN_ENOMEM, "curve: no memory for its collocation points");
        }
    for (size_t i = 0; i < out->n_piece; i++) { /* rounding: no weight below zero */
        double *q = out->piece[i].bary, sum = 0.0;
        for (int k = 0; k < 4; k++) sum += q[k] = fmax(0.0, q[k]);
        for (int k = 0; k < 4; k++) q[k] /= sum;
    }
    out->length_outside = fmax(0.0, total - out->length_inside);
    return SN_OK;
}
