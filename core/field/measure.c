#include "field/measure.h"

#include "base/alloc.h"

#include <string.h>

#define SCALE_LIMIT 0x1p400
#define VOLUME_TOL 1e-7

struct sn_measure {
    const sn_tet_mesh *mesh;
    const double *field, *own; /* own: the tissue's row */
    double *best;              /* n_vert: the largest value of the other tissues; owned */
    int32_t *rival;            /* n_vert: which one (-1: there is none); owned          */
    int32_t n_tissue, tissue;
};

sn_status sn_measure_create(sn_measure **out, const sn_tet_mesh *mesh, const double *field, int32_t n_tissue,
                            int32_t tissue, const sn_run *run, sn_error *err)
{
    size_t n = (size_t)mesh->n_vert;
    *out = NULL;
    sn_measure *m = SN_NEW_ZERO(sn_measure, 1);
    if (m) {
        *m = (sn_measure){.mesh = mesh, .field = field, .n_tissue = n_tissue, .tissue = tissue};
        m->own = field + (size_t)tissue * n;
        m->best = SN_NEW(double, n);
        m->rival = SN_NEW(int32_t, n);
    }
    if (!m || !m->best || !m->rival) {
        sn_measure_destroy(m);
        return sn_fail(err, SN_ENOMEM, "volume: no memory for %d vertices", mesh->n_vert);
    }
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(run))
    for (int32_t v = 0; v < mesh->n_vert; v++) {
        m->best[v] = -INFINITY;
        m->rival[v] = -1;
        for (int32_t j = 0; j < n_tissue; j++) {
            double f = field[(size_t)j * n + (size_t)v];
            if (j == tissue || !(f > m->best[v])) continue;
            m->best[v] = f;
            m->rival[v] = j;
        }
    }
    *out = m;
    return SN_OK;
}

void sn_measure_destroy(sn_measure *m)
{
    if (!m) return;
    sn_release(m->best);
    sn_release(m->rival);
    sn_release(m);
}

/* ---- one tet ---- */

/* scale f_i - f_j at the four corners. */
static void lead_over(const sn_measure *m, const int32_t *v, int32_t j, double scale, double g[4])
{
    const double *f = m->field + (size_t)j * (size_t)m->mesh->n_vert;
    for (int k = 0; k < 4; k++) g[k] = scale * m->own[v[k]] - f[v[k]];
}

typedef enum outcome { NONE, ALL, SOME } outcome;

/* Against a rival with these leads at n corners. Equal functions: the lower tissue has it all, as in the
 * segmentation. */
static outcome against(const double *g, int n, bool has_ties)
{
    bool above = false, below = false;
    for (int k = 0; k < n; k++) {
        above = above || g[k] > 0.0;
        below = below || g[k] < 0.0;
    }
    if (!below) return above || has_ties ? ALL : NONE;
    return above ? SOME : NONE;
}

/* The cheap answer from the best rivals at the corners: for most tets it is the whole one. */
static outcome glance(const sn_measure *m, const int32_t *v, double scale)
{
    double lead[4], g[4];
    for (int k = 0; k < 4; k++) lead[k] = scale * m->own[v[k]] - m->best[v[k]];
    if (against(lead, 4, false) == ALL) return ALL; /* their best lies below its interpolant */
    for (int k = 0; k < 4; k++) {
        int32_t j = m->rival[v[k]];
        if (j < 0 || (k > 0 && j == m->rival[v[k - 1]])) continue;
        lead_over(m, v, j, scale, g);
        if (against(g, 4, m->tissue < j) == NONE) return NONE;
    }
    return SOME;
}

/* A piece of a tet: four points in its barycentric coordinates. */
typedef struct piece {
    double at[4][4];
} piece;

static double piece_share(const piece *p)
{
    sn_vec3 e[3]; /* coordinates 1..3 are affine; corner 0 is their origin */
    for (int k = 0; k < 3; k++)
        e[k] = sn_v3(p->at[k + 1][1] - p->at[0][1], p->at[k + 1][2] - p->at[0][2],
                     p->at[k + 1][3] - p->at[0][3]);
    return fabs(sn_v3_det(e[0], e[1], e[2]));
}

static void crossing(const double *in, const double *out, double g_in, double g_out, double *at)
{
    double t = g_in / (g_in - g_out);
    for (int c = 0; c < 4; c++) at[c] = in[c] + t * (out[c] - in[c]);
}

/* The part of p where the function with values g at p's corners is >= 0, as up to three pieces. */
static int clip_piece(const piece *p, const double g[4], piece out[3])
{
    int in[4], outside[4], n_in = 0, n_out = 0;
    for (int k = 0; k < 4; k++)
        if (g[k] >= 0.0)
            in[n_in++] = k;
        else
            outside[n_out++] = k;
    if (n_in == 0) return 0;
    if (n_in == 4) {
        out[0] = *p;
        return 1;
    }
    double cut[4][4]; /* on the edges from in[a] to outside[b], a fastest */
    for (int b = 0; b < n_out; b++)
        for (int a = 0; a < n_in; a++)
            crossing(p->at[in[a]], p->at[outside[b]], g[in[a]], g[outside[b]], cut[b * n_in + a]);
    const double *corner[6];
    if (n_in == 1) {
        const double *one[4] = {p->at[in[0]], cut[0], cut[1], cut[2]};
        for (int k = 0; k < 4; k++) memcpy(out[0].at[k], one[k], sizeof out[0].at[k]);
        return 1;
    }
    if (n_in == 2) { /* a prism between the triangles (in0, cut00, cut01) and (in1, cut10, cut11) */
        const double *prism[6] = {p->at[in[0]], cut[0], cut[2], p->at[in[1]], cut[1], cut[3]};
        memcpy(corner, prism, sizeof corner);
    } else { /* between the triangle of the corners and that of the cuts */
        const double *prism[6] = {p->at[in[0]], p->at[in[1]], p->at[in[2]], cut[0], cut[1], cut[2]};
        memcpy(corner, prism, sizeof corner);
    }
    static const int split[3][4] = {{0, 1, 2, 3}, {1, 2, 3, 4}, {2, 3, 4, 5}};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++) memcpy(out[i].at[k], corner[split[i][k]], sizeof out[i].at[k]);
    return 3;
}

static const piece whole_tet = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};

/* Values at the piece's corners of the function with values g at the tet's. */
static void at_piece(const piece *p, const double g[4], double at[4])
{
    for (int k = 0; k < 4; k++)
        at[k] = g[0] * p->at[k][0] + g[1] * p->at[k][1] + g[2] * p->at[k][2] + g[3] * p->at[k][3];
}

static outcome in_piece(const sn_measure *m, const int32_t *v, double scale, const piece *p, int32_t j,
                        double at[4])
{
    double g[4];
    lead_over(m, v, j, scale, g);
    at_piece(p, g, at);
    return against(at, 4, m->tissue < j);
}

/* The share of the tet in piece p where the tissue leads over these rivals. */
static double clipped_share(const sn_measure *m, const int32_t *v, double scale, const piece *p,
                            const int32_t *rival, int n_rival)
{
    for (; n_rival > 0; rival++, n_rival--) {
        double at[4], sum = 0.0;
        piece part[3];
        outcome o = in_piece(m, v, scale, p, *rival, at);
        if (o == ALL) continue;
        if (o == NONE) return 0.0;
        int n = clip_piece(p, at, part);
        for (int i = 0; i < n; i++) sum += clipped_share(m, v, scale, &part[i], rival + 1, n_rival - 1);
        return sum;
    }
    return piece_share(p);
}

/* The ends of the longest edge of n points in barycentric coordinates. */
static void longest_edge(const double at[][4], int n, int *from, int *to)
{
    double longest = -1.0;
    for (int a = 0; a < n; a++)
        for (int b = a + 1; b < n; b++) {
            double length = 0.0;
            for (int c = 0; c < 4; c++) length += (at[a][c] - at[b][c]) * (at[a][c] - at[b][c]);
            if (length <= longest) continue;
            longest = length;
            *from = a;
            *to = b;
        }
}

/* Rivals that cut one piece one after another multiply its parts, so a piece with many is halved until each
 * half has few; what is left undecided after max_halvings is below 2^-45 of the tet. */
enum { max_rivals = 12, max_halvings = 45 };

static double share_in(const sn_measure *m, const int32_t *v, double scale, const piece *p, int n_halving)
{
    int32_t rival[max_rivals];
    int n = 0, a = 0, b = 1;
    bool too_many = false;
    for (int32_t j = 0; j < m->n_tissue; j++) {
        double at[4];
        if (j == m->tissue) continue;
        outcome o = in_piece(m, v, scale, p, j, at);
        if (o == NONE) return 0.0;
        if (o == SOME && n == max_rivals)
            too_many = true;
        else if (o == SOME)
            rival[n++] = j;
    }
    if (!too_many || n_halving == max_halvings) return clipped_share(m, v, scale, p, rival, n);
    piece half[2] = {*p, *p};
    longest_edge(p->at, 4, &a, &b);
    for (int c = 0; c < 4; c++) half[0].at[a][c] = half[1].at[b][c] = 0.5 * (p->at[a][c] + p->at[b][c]);
    return share_in(m, v, scale, &half[0], n_halving + 1) + share_in(m, v, scale, &half[1], n_halving + 1);
}

double sn_measure_tet_share(const sn_measure *m, int32_t i_tet, double scale)
{
    const int32_t *v = m->mesh->tet + 4 * (size_t)i_tet;
    outcome o = glance(m, v, scale);
    return o == ALL ? 1.0 : o == NONE ? 0.0 : share_in(m, v, scale, &whole_tet, 0);
}

/* ---- all tets ---- */

enum { n_part = 256 }; /* runs of tets that are summed on their own, whatever the number of threads */

double sn_measure_volume(const sn_measure *m, double scale, const sn_run *run)
{
    double part[n_part], total = 0.0;
#pragma omp parallel for schedule(dynamic, 1) num_threads(sn_run_threads(run))
    for (int i = 0; i < n_part; i++) {
        int32_t end = (int32_t)((int64_t)m->mesh->n_tet * (i + 1) / n_part);
        part[i] = 0.0;
        for (int32_t t = (int32_t)((int64_t)m->mesh->n_tet * i / n_part); t < end; t++) {
            double share = sn_measure_tet_share(m, t, scale);
            if (share > 0.0) part[i] += share * sn_tet_mesh_tet_volume(m->mesh, t);
        }
    }
    for (int i = 0; i < n_part; i++) total += part[i];
    return total;
}

/* ---- faces ---- */

enum { max_polygon = 3 + 2 * max_rivals }; /* corners; each rival that cuts it adds at most one */
typedef struct polygon {
    double at[max_polygon][4]; /* barycentric in the tet */
    int n;
} polygon;

static double value_at(const double g[4], const double at[4])
{
    return g[0] * at[0] + g[1] * at[1] + g[2] * at[2] + g[3] * at[3];
}

static void clip_polygon(polygon *p, const double g[4])
{
    polygon out = {.n = 0};
    for (int k = 0; k < p->n; k++) {
        const double *a = p->at[k], *b = p->at[(k + 1) % p->n];
        double ga = value_at(g, a), gb = value_at(g, b);
        if (ga >= 0.0 && out.n < max_polygon) memcpy(out.at[out.n++], a, sizeof out.at[0]);
        if ((ga >= 0.0) != (gb >= 0.0) && out.n < max_polygon) crossing(a, b, ga, gb, out.at[out.n++]);
    }
    *p = out;
}

typedef struct face_part { /* what is won of a face so far */
    double area;
    sn_vec3 moment; /* area times centroid */
} face_part;

static void add_polygon(const sn_tet_mesh *m, const int32_t *v, const polygon *p, face_part *sum)
{
    sn_vec3 q[max_polygon];
    for (int i = 0; i < p->n; i++) {
        q[i] = sn_v3(0, 0, 0);
        for (int c = 0; c < 4; c++) q[i] = sn_v3_mad(q[i], p->at[i][c], sn_tet_mesh_point(m, v[c]));
    }
    for (int i = 1; i + 1 < p->n; i++) { /* a fan */
        double area = 0.5 * sn_v3_len(sn_v3_cross(sn_v3_sub(q[i], q[0]), sn_v3_sub(q[i + 1], q[0])));
        sum->area += area;
        sum->moment = sn_v3_mad(sum->moment, area / 3.0, sn_v3_add(sn_v3_add(q[0], q[i]), q[i + 1]));
    }
}

/* A triangle of a face, halved as pieces of tets are. */
static void add_triangle(const sn_measure *m, const int32_t *v, double scale, const double corner[3][4],
                         int n_halving, face_part *sum)
{
    polygon p = {.n = 3};
    int n = 0, a = 0, b = 1;
    memcpy(p.at, corner, 3 * sizeof *corner);
    for (int32_t j = 0; j < m->n_tissue && p.n > 0; j++) {
        double g[4], at[3];
        if (j == m->tissue) continue;
        lead_over(m, v, j, scale, g);
        for (int k = 0; k < 3; k++) at[k] = value_at(g, corner[k]);
        outcome o = against(at, 3, m->tissue < j);
        if (o == NONE) return;
        if (o == SOME && n++ < 2 * max_rivals) clip_polygon(&p, g);
    }
    if (n <= 2 * max_rivals || p.n == 0 || n_halving == max_halvings) {
        add_polygon(m->mesh, v, &p, sum);
        return;
    }
    double half[2][3][4];
    for (int i = 0; i < 2; i++) memcpy(half[i], corner, sizeof half[i]);
    longest_edge(corner, 3, &a, &b);
    for (int c = 0; c < 4; c++) half[0][a][c] = half[1][b][c] = 0.5 * (corner[a][c] + corner[b][c]);
    for (int i = 0; i < 2; i++) add_triangle(m, v, scale, (const double(*)[4])half[i], n_halving + 1, sum);
}

double sn_measure_face_area(const sn_measure *m, int32_t i_tet, int k, double scale, sn_vec3 *centroid)
{
    const int32_t *v = m->mesh->tet + 4 * (size_t)i_tet;
    double corner[3][4];
    face_part sum = {0};
    if (glance(m, v, scale) == NONE) return 0.0;
    for (int i = 0; i < 3; i++) memcpy(corner[i], whole_tet.at[sn_tet_face[k][i]], sizeof corner[i]);
    add_triangle(m, v, scale, (const double(*)[4])corner, 0, &sum);
    if (sum.area > 0.0) *centroid = sn_v3_scale(1.0 / sum.area, sum.moment);
    return sum.area;
}

/* ---- the scale for a volume ---- */

typedef struct bracket { /* logarithms of scales, and the volumes above the wanted one there */
    double lo, hi, at_lo, at_hi;
} bracket;

static double surplus(const sn_measure *m, double volume, double log_scale, const sn_run *run)
{
    return sn_measure_volume(m, exp(log_scale), run) - volume;
}

static sn_status find_bracket(const sn_measure *m, double volume, bracket *b, const sn_run *run,
                              sn_error *err)
{
    double step = 0.05, limit = log(SCALE_LIMIT);
    b->lo = b->hi = 0.0;
    b->at_lo = b->at_hi = surplus(m, volume, 0.0, run);
    while (b->at_hi < 0.0 && b->hi < limit) { /* grow: the last lower end stays below */
        sn_status st = sn_run_step(run, "fitting the volume", -1.0, err);
        if (st) return st;
        b->lo = b->hi;
        b->at_lo = b->at_hi;
        b->hi += step;
        b->at_hi = surplus(m, volume, b->hi, run);
        step *= 2.0;
    }
    step = 0.05;
    while (b->at_lo > 0.0 && b->lo > -limit) {
        sn_status st = sn_run_step(run, "fitting the volume", -1.0, err);
        if (st) return st;
        b->hi = b->lo;
        b->at_hi = b->at_lo;
        b->lo -= step;
        b->at_lo = surplus(m, volume, b->lo, run);
        step *= 2.0;
    }
    if (b->at_lo <= 0.0 && b->at_hi >= 0.0) return SN_OK;
    bool too_much = b->at_hi < 0.0;
    return sn_fail(err, SN_EINVAL, "no tissue value gives a volume of %g: %s %g here", volume,
                   too_much ? "crowded by its neighbours and the skin it can reach at most"
                            : "it keeps at least",
                   volume + (too_much ? b->at_hi : b->at_lo));
}

/* Regula falsi with the Illinois correction (an end that stays twice counts half): the volume grows steadily
 * with the scale. */
sn_status sn_measure_find_scale(const sn_measure *m, double volume, const sn_run *run, double *scale,
                                sn_error *err)
{
    bracket b;
    sn_status st = find_bracket(m, volume, &b, run, err);
    double x = 0.0, at = 0.0;
    int moved = 0; /* the end that moved last: -1 lo, 1 hi */
    for (int i = 0; !st && i < 200; i++) {
        if (b.at_lo == 0.0 || b.at_hi == 0.0) {
            x = b.at_lo == 0.0 ? b.lo : b.hi;
            break;
        }
        x = b.lo - b.at_lo * (b.hi - b.lo) / (b.at_hi - b.at_lo);
        if (!(x > b.lo && x < b.hi)) x = 0.5 * (b.lo + b.hi);
        at = surplus(m, volume, x, run);
        if (fabs(at) <= VOLUME_TOL * volume || b.hi - b.lo < 1e-14 * (1.0 + fabs(x))) break;
        if (at > 0.0) {
            b.hi = x;
            b.at_hi = at;
            if (moved > 0) b.at_lo *= 0.5;
            moved = 1;
        } else {
            b.lo = x;
            b.at_lo = at;
            if (moved < 0) b.at_hi *= 0.5;
            moved = -1;
        }
        st = sn_run_step(run, "fitting the volume", -1.0, err);
    }
    if (!st) *scale = exp(x);
    return st;
}
