/* Where the corners go. The combinatorics is settled; here a corner moves a little within its edge, face or
 * tet so that every tet keeps a positive volume in doubles. */
#include "extract/extract_private.h"

#include "base/alloc.h"

#include <math.h>
#include <string.h>

#define FLAT_REL 2e-14 /* of size of coordinates x longest edge^2: some hundred roundings of a corner  */
#define SWEEPS 40      /* at the last try                                                         */
#define FIRST_SWEEPS 5 /* at the others                                                           */
#define BACK_SWEEPS 8  /* that only undo, see step_back                                           */
#define NARROWER 3     /* margins that the search starts from, each a tenth of the last                 */
#define NO_MOVE 1e-12  /* in weights: the rounding of their sum                                     */
#define STEP_BACK 0.03
#define WIDEN_AFTER 2    /* sweeps; then the corners around a flat tet move as well                    */
#define MIN_RATIO 0.25   /* of the raises of two neighbouring tissues, see set_raise                   */
#define CLOSEST_REL 0.05 /* of the margin: as close to the border as mending may put a corner          */

typedef struct placer {
    sn_extraction *x;
    const sn_tet_mesh *m;
    const xt_grid *g;
    const xt_cuts *cuts;
    const xt_cells *cells;
    double margin;
    double coordinate; /* the largest, absolute */
    int32_t *raise;    /* per tissue: added to its values where corners are placed, see set_raise  */
    double *exact;     /* as weight: where the ties are, before anything was moved                 */
    double *weight;    /* per corner beyond the vertices: 4 weights on the vertices of its simplex */
    int32_t first_face, first_inner, n_point;
} placer;

/* ---- the simplex that a corner lies in ---- */

static int simplex_of(const placer *p, int32_t id, int32_t v[4])
{
    if (id < p->first_face) {
        int32_t lo = 0, hi = p->cuts->n_edge, at = id - p->m->n_vert; /* the edge whose range holds it */
        while (hi - lo > 1) {
            int32_t mid = lo + (hi - lo) / 2;
            if (p->cuts->edge_first[mid] <= at)
                lo = mid;
            else
                hi = mid;
        }
        memcpy(v, p->cuts->edge[lo], sizeof p->cuts->edge[lo]);
        return 2;
    }
    if (id < p->first_inner) {
        int32_t lo = 0, hi = p->cuts->n_face, at = id - p->first_face;
        while (hi - lo > 1) {
            int32_t mid = lo + (hi - lo) / 2;
            if (p->cuts->face_first[mid] <= at)
                lo = mid;
            else
                hi = mid;
        }
        memcpy(v, p->cuts->face[lo], sizeof p->cuts->face[lo]);
        return 3;
    }
    memcpy(v, p->m->tet + 4 * (size_t)p->cells->inner_tet[id - p->first_inner], 4 * sizeof *v);
    return 4;
}

static double *weight_of(placer *p, int32_t id)
{
    return p->weight + 4 * (size_t)(id - p->m->n_vert);
}

static double *exact_of(placer *p, int32_t id)
{
    return p->exact + 4 * (size_t)(id - p->m->n_vert);
}

static sn_vec3 blend(const placer *p, const int32_t *v, const double *w, int n)
{
    sn_vec3 q = sn_tet_mesh_point(p->m, v[0]), o = q;
    for (int k = 1; k < n; k++) q = sn_v3_mad(q, w[k], sn_v3_sub(sn_tet_mesh_point(p->m, v[k]), o));
    return q;
}

static void put(placer *p, int32_t id)
{
    int32_t v[4];
    int n = simplex_of(p, id, v);
    sn_v3_store(p->x->mesh.pos + 3 * (size_t)id, blend(p, v, weight_of(p, id), n));
}

/* ---- first places ---- */

static int64_t diff(const placer *p, const int32_t *row, int32_t a, int32_t b)
{
    return (int64_t)row[a] - row[b] + p->raise[a] - p->raise[b];
}

/* The points of one edge in order, at least a margin apart and from the ends. */
static void place_edge(placer *p, int32_t e)
{
    int32_t first = p->cuts->edge_first[e], n = p->cuts->edge_first[e + 1] - first;
    const int32_t *fu = xt_row(p->g, p->cuts->edge[e][0]), *fv = xt_row(p->g, p->cuts->edge[e][1]);
    double gap = fmin(p->margin, 0.5 / (n + 1)), low = 0.0;
    for (int32_t i = 0; i < n; i++) {
        const int32_t *tie = p->cuts->edge_tie[first + i];
        double a = fmax(0.0, (double)diff(p, fu, tie[0], tie[1])),
               b = fmax(0.0, (double)diff(p, fv, tie[1], tie[0]));
        double s = a + b > 0.0 ? a / (a + b) : 0.5, want[4] = {1.0 - s, s, 0, 0};
        double kept = fmin(fmax(s, low + gap), 1.0 - gap * (n - i));
        double *w = weight_of(p, p->m->n_vert + first + i);
        w[0] = 1.0 - kept;
        w[1] = kept;
        w[2] = w[3] = 0.0;
        low = kept;
        memcpy(exact_of(p, p->m->n_vert + first + i), want, sizeof want);
    }
}

/* Weights up to a factor -> weights that add up to 1, none below the margin. */
static void settle(placer *p, int32_t id, const double *raw, int n)
{
    double sum = 0.0, want[4] = {0, 0, 0, 0}, *w = weight_of(p, id), after = 0.0;
    for (int k = 0; k < n; k++) sum += fabs(raw[k]);
    memset(w, 0, 4 * sizeof *w);
    for (int k = 0; k < n; k++) {
        want[k] = sum > 0.0 ? fabs(raw[k]) / sum : 1.0 / n;
        w[k] = fmax(want[k], p->margin);
        after += w[k];
    }
    memcpy(exact_of(p, id), want, sizeof want);
    for (int k = 0; k < n; k++) w[k] /= after;
}

static void place_face_point(placer *p, int32_t f, int32_t i)
{
    const int32_t *s = p->cuts->face_tie[i];
    int64_t a[3], b[3];
    for (int k = 0; k < 3; k++) {
        const int32_t *row = xt_row(p->g, p->cuts->face[f][k]);
        a[k] = diff(p, row, s[0], s[1]);
        b[k] = diff(p, row, s[0], s[2]);
    }
    double raw[3];
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        raw[k] = (double)(a[u] * b[v] - a[v] * b[u]);
    }
    settle(p, p->first_face + i, raw, 3);
}

static void place_inner_point(placer *p, int32_t i)
{
    const int32_t *s = p->cells->inner_tie[i], *v = p->m->tet + 4 * (size_t)p->cells->inner_tet[i];
    double raw[4];
    for (int out = 0; out < 4; out++) {
        int64_t d[3][3];
        int n = 0;
        for (int k = 0; k < 4; k++) {
            if (k == out) continue;
            const int32_t *row = xt_row(p->g, v[k]);
            for (int r = 0; r < 3; r++) d[r][n] = diff(p, row, s[0], s[r + 1]);
            n++;
        }
        raw[out] = (double)sn_det3(d[0], d[1], d[2]);
    }
    settle(p, p->first_inner + i, raw, 4);
}

static void place_first(placer *p)
{
    for (int32_t v = 0; v < p->m->n_vert; v++)
        memcpy(p->x->mesh.pos + 3 * (size_t)v, p->m->pos + 3 * (size_t)v, 3 * sizeof(double));
    for (int32_t e = 0; e < p->cuts->n_edge; e++) place_edge(p, e);
    for (int32_t f = 0; f < p->cuts->n_face; f++)
        for (int32_t i = p->cuts->face_first[f]; i < p->cuts->face_first[f + 1]; i++)
            place_face_point(p, f, i);
    for (int32_t i = 0; i < (int32_t)p->cells->n_inner; i++) place_inner_point(p, i);
    for (int32_t id = p->m->n_vert; id < p->n_point; id++) put(p, id);
}

/* ---- mending ---- */

static double relative_volume(const placer *p, int32_t t)
{
    return sn_tet_mesh_tet_volume(&p->x->mesh, t) / sn_tet_mesh_tet_volume(p->m, p->cells->source[t]);
}

typedef struct stars { /* the tets around the marked corners */
    int32_t *mark;     /* n_point: rank among the marked, or -1 */
    int32_t *id;       /* n: the marked corners, ascending      */
    int32_t *first, *tet;
    int32_t n;
} stars;

static void free_stars(stars *s)
{
    sn_release(s->mark);
    sn_release(s->id);
    sn_release(s->first);
    sn_release(s->tet);
    memset(s, 0, sizeof *s);
}

/* From the flags in mark: ranks and stars. */
static bool build_stars(const placer *p, stars *s)
{
    const sn_tet_mesh *o = &p->x->mesh;
    s->n = 0;
    for (int32_t i = 0; i < p->n_point; i++) s->mark[i] = s->mark[i] ? s->n++ : -1;
    s->id = SN_NEW(int32_t, s->n);
    s->first = SN_NEW_ZERO(int32_t, (size_t)s->n + 2);
    if (!s->id || !s->first) return false;
    for (int32_t i = 0; i < p->n_point; i++)
        if (s->mark[i] >= 0) s->id[s->mark[i]] = i;
    for (size_t k = 0; k < 4 * (size_t)o->n_tet; k++)
        if (s->mark[o->tet[k]] >= 0) s->first[s->mark[o->tet[k]] + 2]++;
    for (int32_t i = 0; i < s->n; i++) s->first[i + 2] += s->first[i + 1];
    s->tet = SN_NEW(int32_t, s->first[s->n + 1]);
    if (!s->tet) return false;
    for (size_t k = 0; k < 4 * (size_t)o->n_tet; k++)
        if (s->mark[o->tet[k]] >= 0) s->tet[s->first[s->mark[o->tet[k]] + 1]++] = (int32_t)(k >> 2);
    return true;
}

/* Whether rounding the corners to doubles could be what makes the volume positive. */
static bool is_flat(const placer *p, int32_t t)
{
    const sn_tet_mesh *o = &p->x->mesh;
    double longest2 = 0.0;
    for (int e = 0; e < 6; e++) {
        const int32_t *v = o->tet + 4 * (size_t)t;
        sn_vec3 a = sn_tet_mesh_point(o, v[sn_tet_edge[e][0]]),
                b = sn_tet_mesh_point(o, v[sn_tet_edge[e][1]]);
        longest2 = fmax(longest2, sn_v3_len2(sn_v3_sub(b, a)));
    }
    return 6.0 * sn_tet_mesh_tet_volume(o, t) <= FLAT_REL * p->coordinate * longest2;
}

/* Marks the movable corners of flat tets; returns how many tets are flat. */
static int32_t mark_flat(const placer *p, int32_t *mark)
{
    const sn_tet_mesh *o = &p->x->mesh;
    int32_t n = 0;
    memset(mark, 0, (size_t)p->n_point * sizeof *mark);
    for (int32_t t = 0; t < o->n_tet; t++) {
        if (!is_flat(p, t)) continue;
        n++;
        for (int k = 0; k < 4; k++)
            if (o->tet[4 * (size_t)t + (size_t)k] >= p->m->n_vert)
                mark[o->tet[4 * (size_t)t + (size_t)k]] = 1;
    }
    return n;
}

/* Also the movable corners of all tets that touch a marked one. */
static void widen(const placer *p, int32_t *mark)
{
    const sn_tet_mesh *o = &p->x->mesh;
    for (int32_t t = 0; t < o->n_tet; t++) {
        const int32_t *v = o->tet + 4 * (size_t)t;
        if (mark[v[0]] != 1 && mark[v[1]] != 1 && mark[v[2]] != 1 && mark[v[3]] != 1) continue;
        for (int k = 0; k < 4; k++)
            if (v[k] >= p->m->n_vert && !mark[v[k]]) mark[v[k]] = 2;
    }
}

/* Per dimension of the search for the best place of a corner on an edge, in a face, in a tet: it need not be
 * the very best, so the costlier searches are coarser. */
static const int search_steps[5] = {0, 0, 40, 20, 8};

typedef struct search { /* the volumes around one corner are linear in its weights */
    double (*form)[4];  /* n: relative volume = form . weights */
    int32_t n;
    int n_weight;
    double least; /* smallest weight allowed */
    double best_w[4], best;
} search;

static double flattest(const search *s, const double *w)
{
    double low = INFINITY;
    for (int32_t i = 0; i < s->n; i++) {
        double v = 0.0;
        for (int k = 0; k < s->n_weight; k++) v += s->form[i][k] * w[k];
        low = fmin(low, v);
    }
    return low;
}

/* The smallest volume with the first k weights given, the best over the others: concave, so a ternary search
 * nests. */
static double best_over(search *s, double w[4], int k, double left)
{
    if (k == s->n_weight - 1) {
        w[k] = left;
        double low = flattest(s, w);
        if (low > s->best) {
            s->best = low;
            memcpy(s->best_w, w, sizeof s->best_w);
        }
        return low;
    }
    double lo = s->least, hi = left - s->least * (s->n_weight - 1 - k);
    for (int i = 0; i < search_steps[s->n_weight]; i++) {
        double a = lo + (hi - lo) / 3.0, b = hi - (hi - lo) / 3.0;
        w[k] = a;
        double fa = best_over(s, w, k + 1, left - a);
        w[k] = b;
        double fb = best_over(s, w, k + 1, left - b);
        if (fa < fb)
            lo = a;
        else
            hi = b;
    }
    w[k] = 0.5 * (lo + hi);
    return best_over(s, w, k + 1, left - w[k]);
}

/* From the place now towards the best one, no farther than makes the tets a tenth as good as there. */
static void shorten_move(search *s, const double *from)
{
    for (double step = 1.0 / 1024; step < 1.0; step *= 2.0) {
        double w[4];
        for (int k = 0; k < 4; k++) w[k] = from[k] + step * (s->best_w[k] - from[k]);
        if (flattest(s, w) < 0.1 * s->best) continue;
        memcpy(s->best_w, w, sizeof w);
        return;
    }
}

/* Moves one marked corner so that the flattest tet around it gets less flat. */
static bool mend_corner(placer *p, const stars *s, int32_t rank)
{
    int32_t id = s->id[rank], v[4], first = s->first[rank], n = s->first[rank + 1] - first;
    search q = {.form = sn_alloc((size_t)n, sizeof *q.form), .n = n, .best = -INFINITY};
    if (!q.form) return false;
    q.n_weight = simplex_of(p, id, v);
    q.least = CLOSEST_REL * p->margin;
    double *pos = p->x->mesh.pos + 3 * (size_t)id, now = INFINITY;
    for (int32_t i = 0; i < n; i++) now = fmin(now, relative_volume(p, s->tet[first + i]));
    for (int k = 0; k < q.n_weight; k++) {
        sn_v3_store(pos, sn_tet_mesh_point(p->m, v[k]));
        for (int32_t i = 0; i < n; i++) q.form[i][k] = relative_volume(p, s->tet[first + i]);
    }
    double w[4] = {0, 0, 0, 0}, *weight = weight_of(p, id);
    (void)best_over(&q, w, 0, 1.0);
    if (q.best > now) {
        if (q.best > 0.0) shorten_move(&q, weight);
        memcpy(weight, q.best_w, sizeof q.best_w);
    }
    put(p, id);
    sn_release(q.form);
    return true;
}

/* Where keeping off the border turned a tet, corners go back towards their exact places: always inside their
 * simplex, and in the same order on an edge. */
static void step_back(placer *p, const stars *s)
{
    for (int32_t i = 0; i < s->n; i++) {
        double *w = weight_of(p, s->id[i]), *e = exact_of(p, s->id[i]);
        for (int k = 0; k < 4; k++) w[k] = e[k] + STEP_BACK * (w[k] - e[k]);
        put(p, s->id[i]);
    }
}

/* Sweeps over the corners of flat tets until there are none: back towards the exact places, or to the best
 * ones. */
static sn_status mend(placer *p, bool back, int sweeps, const sn_run *run, sn_error *err)
{
    sn_status st = SN_OK;
    for (int sweep = 0; !st; sweep++) {
        stars s = {.mark = SN_NEW(int32_t, p->n_point)};
        if (!s.mark) return sn_fail(err, SN_ENOMEM, "extract: no memory");
        int32_t n_flat = mark_flat(p, s.mark);
        if (n_flat == 0) {
            free_stars(&s);
            return SN_OK;
        }
        if (sweep >= WIDEN_AFTER) widen(p, s.mark);
        if (sweep == sweeps) st = sn_fail(err, SN_EINTERNAL, "extract: %d tets stayed flat", n_flat);
        if (!st && !build_stars(p, &s)) st = sn_fail(err, SN_ENOMEM, "extract: no memory");
        if (!st) st = sn_run_step(run, "mending flat tets", (double)sweep / sweeps, err);
        if (!st && back) step_back(p, &s);
        for (int32_t i = 0; i < s.n && !st && !back; i++)
            if (!mend_corner(p, &s, i)) st = sn_fail(err, SN_ENOMEM, "extract: no memory");
        free_stars(&s);
    }
    return st;
}

/* Where many tissues tie exactly (values from a short list, say), all first places coincide and mending
 * starts from nothing. The signs were taken as if tissue i were raised by d_0 >> d_1 >> ... > 0; raising the
 * values by real steps of that kind, small against the range, spreads the places in the way that the
 * combinatorics means. */
static void set_raise(placer *p, int32_t largest)
{
    double ratio = fmax(MIN_RATIO, pow(1e-3, 1.0 / p->g->n_tissue)), step = largest;
    for (int32_t i = 0; i < p->g->n_tissue; i++, step *= ratio) p->raise[i] = (int32_t)step;
}

/* First the cheap cure, which changes least; then the search, from ever nearer to the exact places. */
static sn_status place_with_raise(placer *p, int32_t largest, int sweeps, const sn_run *run, sn_error *err)
{
    double margin = p->margin;
    set_raise(p, largest);
    sn_status st = sn_run_step(run, "placing corners", -1.0, err);
    if (st) return st;
    place_first(p);
    st = sn_run_step(run, "placing corners", -1.0, err);
    if (!st) st = mend(p, true, BACK_SWEEPS, run, err);
    for (int i = 0; i < NARROWER && st == SN_EINTERNAL; i++, p->margin *= 0.1) {
        place_first(p);
        st = mend(p, false, sweeps, run, err);
    }
    p->margin = margin;
    return st;
}

/* ---- what was done ---- */

/* Corners that are not where their tissues tie. */
static void count_moves(placer *p)
{
    p->x->n_moved = 0;
    p->x->largest_move = 0.0;
    for (int32_t id = p->m->n_vert; id < p->n_point; id++) {
        const double *w = weight_of(p, id), *e = exact_of(p, id);
        double most = 0.0;
        for (int k = 0; k < 4; k++) most = fmax(most, fabs(w[k] - e[k]));
        if (most < NO_MOVE) continue;
        int32_t v[4];
        int n = simplex_of(p, id, v);
        p->x->n_moved++;
        p->x->largest_move = fmax(p->x->largest_move, sn_v3_dist(blend(p, v, w, n), blend(p, v, e, n)));
    }
}

static double value_in(const placer *p, const double *value, int32_t tissue, const int32_t *v,
                       const double *w, int n)
{
    const double *f = value + (size_t)tissue * (size_t)p->m->n_vert;
    double sum = 0.0;
    for (int k = 0; k < n; k++) sum += w[k] * f[v[k]];
    return sum;
}

/* The largest of the functions that tie at a corner: they differ a little where it was moved. */
static void fill_envelope(placer *p, const double *value)
{
    for (int32_t v = 0; v < p->m->n_vert; v++)
        p->x->envelope[v] = value[(size_t)p->g->winner[v] * (size_t)p->m->n_vert + (size_t)v];
    for (int32_t id = p->m->n_vert; id < p->n_point; id++) {
        int32_t v[4];
        int n = simplex_of(p, id, v);
        const int32_t *tie = n == 2   ? p->cuts->edge_tie[id - p->m->n_vert]
                             : n == 3 ? p->cuts->face_tie[id - p->first_face]
                                      : p->cells->inner_tie[id - p->first_inner];
        double best = -INFINITY;
        for (int k = 0; k < n; k++) best = fmax(best, value_in(p, value, tie[k], v, weight_of(p, id), n));
        p->x->envelope[id] = best;
    }
}

sn_status xt_place(sn_extraction *out, const sn_tet_mesh *m, const xt_grid *g, const xt_cuts *cuts,
                   const xt_cells *cells, const double *value, double margin, const sn_run *run,
                   sn_error *err)
{
    static const int32_t raises[] = {0, 1 << 14, 1 << 17, 1 << 20, 1 << 23}; /* of a range of 2^28 */
    placer p = {.x = out, .m = m, .g = g, .cuts = cuts, .cells = cells, .margin = margin};
    p.first_face = m->n_vert + cuts->n_edge_point;
    p.first_inner = p.first_face + cuts->n_face_point;
    p.n_point = out->mesh.n_vert;
    for (size_t k = 0; k < 3 * (size_t)m->n_vert; k++) p.coordinate = fmax(p.coordinate, fabs(m->pos[k]));
    p.weight = SN_NEW(double, 4 * (size_t)(p.n_point - m->n_vert));
    p.exact = SN_NEW(double, 4 * (size_t)(p.n_point - m->n_vert));
    p.raise = SN_NEW(int32_t, g->n_tissue);
    sn_status st =
        p.weight && p.exact && p.raise ? SN_EINTERNAL : sn_fail(err, SN_ENOMEM, "extract: no memory");
    size_t last = sizeof raises / sizeof *raises - 1;
    for (size_t i = 0; st == SN_EINTERNAL && i <= last; i++)
        st = place_with_raise(&p, raises[i], i < last ? FIRST_SWEEPS : SWEEPS, run, err);
    if (!st) st = sn_run_step(run, "placing corners", 1.0, err);
    if (!st) count_moves(&p);
    if (!st) fill_envelope(&p, value);
    sn_release(p.weight);
    sn_release(p.exact);
    sn_release(p.raise);
    return st;
}
