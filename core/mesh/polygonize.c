#include "mesh/polygonize.h"

#include "base/alloc.h"

#include <assert.h>
#include <string.h>
#ifdef _OPENMP
#include <omp.h>
#endif

/* The lattice has corners (i, j, k) with 0 <= i <= n[0] and so on, and one centre per cube, named by the
 * cube's lowest corner. A tet is an edge between two corners with two neighbouring centres of the four around
 * it: twelve per cube. The outermost corners and centres are outside (see cut), so the tets missing at the
 * border would be empty.
 *
 * Work is done in blocks of corners, each on its own: a block samples what its tets touch, so nothing
 * outlives it but its piece of surface. Points that blocks share are computed in each of them, to the same
 * bits. */
enum {
    BLOCK = 8,        /* corners along a block; larger: less shared between blocks, but fewer skipped */
    SIDE = BLOCK + 2, /* with the layer of centres before and the layer of corners after              */
    POINTS = SIDE * SIDE * SIDE,
    EDGES = 14, /* that a cube owns: 3 between corners, 8 from its centre to its corners, 3 between centres */
    CENTRE_EDGE = 3,  /* first of the 8                                                              */
    CENTRE_AXIS = 11, /* first of the 3 between centres                                              */
    BATCH = 4096      /* blocks between two reports of progress                                      */
};
static const int stride[3] = {1, SIDE, SIDE *SIDE};

#define MAX_POINTS 2e8
#define EDGE_KEEP 1e-2 /* vertices keep this fraction of an edge from its ends */
#define ROOT_WIDTH 1e-6
#define MIN_CELL_REL 1e-9 /* of the coordinates: rounding stays far below EDGE_KEEP */
#define CUT_MARGIN 0.25   /* cells; below 1/2, so that the outermost centres are cut off too */

typedef struct lattice {
    const sn_polygonize *p;
    sn_box3 cut;    /* everything outside it is outside */
    sn_vec3 origin; /* of corner (0, 0, 0): one cell before box.min */
    int32_t n[3];   /* cubes along each axis */
    int32_t blocks[3];
} lattice;

typedef struct vertex {
    int64_t key; /* of the lattice edge it is on */
    sn_vec3 pos;
} vertex;

typedef struct triangle {
    int32_t v[3]; /* in the block's own vertices */
} triangle;

/* One thread's scratch for the current block, and the surface of all its blocks. */
typedef struct worker {
    double value[2 * POINTS];          /* by point id: corners, then centres */
    int32_t vertex_of[POINTS * EDGES]; /* by cube and edge: vertex of the block, or -1 */
    int32_t first[3];                  /* corner with point id 0 in the lattice; may be -1 */
    vertex *vert;
    triangle *tri;
    size_t n_vert, cap_vert, n_tri, cap_tri, block_vert; /* block_vert: n_vert when the block began */
    bool no_memory, stopped;
} worker;

typedef struct piece { /* what a block added */
    int32_t i_worker;
    size_t first_vert, n_vert, first_tri, n_tri;
} piece;

/* ---- values on the lattice ---- */

static double value_at(const lattice *g, sn_vec3 p)
{
    double v = g->p->value(g->p->user, p);
    double x = fmax(g->cut.min.x - p.x, p.x - g->cut.max.x);
    double y = fmax(g->cut.min.y - p.y, p.y - g->cut.max.y);
    double z = fmax(g->cut.min.z - p.z, p.z - g->cut.max.z);
    double out = fmax(x, fmax(y, z));
    return out > v ? out : v;
}

static bool is_inside(double value)
{
    return value <= 0.0;
}

static sn_vec3 lattice_point(const lattice *g, double i, double j, double k)
{
    double h = g->p->cell;
    return sn_v3(g->origin.x + h * i, g->origin.y + h * j, g->origin.z + h * k);
}

static sn_vec3 point_of(const lattice *g, const worker *w, int id)
{
    double shift = id >= POINTS ? 0.5 : 0.0;
    int c = id % POINTS;
    return lattice_point(g, w->first[0] + c % SIDE + shift, w->first[1] + c / SIDE % SIDE + shift,
                         w->first[2] + c / (SIDE * SIDE) + shift);
}

/* Nothing of the surface is near the block: the ball that holds all its points has one sign. */
static bool is_far(const lattice *g, const worker *w)
{
    if (!g->p->is_distance) return false;
    double mid = 1.0 + 0.5 * BLOCK - 0.25,
           half = 0.5 * BLOCK + 0.26; /* from half a cell before to BLOCK after */
    sn_vec3 c = lattice_point(g, w->first[0] + mid, w->first[1] + mid, w->first[2] + mid);
    return fabs(value_at(g, c)) > half * sqrt(3.0) * g->p->cell;
}

/* Samples corners first + 1 .. and centres first .. of the block. Points off the lattice are outside and
 * belong to no tet. Returns whether the signs differ. */
static bool sample(const lattice *g, worker *w)
{
    int n_inside = 0, n_all = 0;
    for (int id = 0; id < 2 * POINTS; id++) {
        int c = id % POINTS, centre = id >= POINTS;
        int l[3] = {c % SIDE, c / SIDE % SIDE, c / (SIDE * SIDE)};
        bool used = true, on_lattice = true;
        for (int k = 0; k < 3; k++) {
            int32_t i = w->first[k] + l[k];
            used = used && (centre ? l[k] <= BLOCK : l[k] >= 1);
            on_lattice = on_lattice && i >= 0 && i <= g->n[k] - centre;
        }
        w->value[id] = 1.0;
        if (!used || !on_lattice) continue;
        w->value[id] = value_at(g, point_of(g, w, id));
        n_inside += is_inside(w->value[id]);
        n_all++;
    }
    return n_inside > 0 && n_inside < n_all;
}

/* ---- vertices ---- */

/* The fraction along p0 p1 where the sign changes: interpolate, truncate, project (Oliveira and Takahashi
 * 2020), which never takes more than one step beyond bisection and few on smooth functions. */
static double root(const lattice *g, sn_vec3 p0, sn_vec3 p1, double f0, double f1)
{
    double a = 0.0, b = 1.0, reach = 0.5 * ROOT_WIDTH * ldexp(1.0, 21);
    bool a_inside = is_inside(f0);
    for (; b - a > ROOT_WIDTH; reach *= 0.5) {
        double mid = 0.5 * (a + b), secant = (f1 * a - f0 * b) / (f1 - f0);
        if (!(secant >= a && secant <= b)) secant = mid;
        double side = mid >= secant ? 1.0 : -1.0, nudge = 0.2 * (b - a) * (b - a);
        double t = nudge <= fabs(mid - secant) ? secant + side * nudge : mid;
        double slack = reach - 0.5 * (b - a);
        if (fabs(t - mid) > slack) t = mid - side * slack;
        double f = value_at(g, sn_v3_lerp(p0, p1, t));
        if (is_inside(f) == a_inside) {
            a = t;
            f0 = f;
        } else {
            b = t;
            f1 = f;
        }
    }
    double t = (f1 * a - f0 * b) / (f1 - f0);
    return t >= a && t <= b ? t : 0.5 * (a + b);
}

/* The edge between two points of one tet: which cube owns it and its number there; u becomes the owner's
 * point. */
static int edge_number(int *u, int *v)
{
    bool mixed = (*u >= POINTS) != (*v >= POINTS);
    if (mixed ? *u < *v : *u > *v) { /* from the centre to the corner, or from the lower to the higher */
        int swap = *u;
        *u = *v;
        *v = swap;
    }
    int d = *v % POINTS - *u % POINTS;
    if (!mixed) return (*u >= POINTS ? CENTRE_AXIS : 0) + (d == stride[0] ? 0 : d == stride[1] ? 1 : 2);
    return CENTRE_EDGE + d % SIDE + 2 * (d / SIDE % SIDE) + 4 * (d / (SIDE * SIDE));
}

static int64_t edge_key(const lattice *g, const worker *w, int cube, int number)
{
    int64_t i = w->first[0] + cube % SIDE, j = w->first[1] + cube / SIDE % SIDE;
    int64_t k = w->first[2] + cube / (SIDE * SIDE);
    return ((k * g->n[1] + j) * g->n[0] + i) * EDGES + number;
}

/* The vertex of the block on the edge u v, made when it is new. -1 when memory is short. */
static int32_t vertex_on(const lattice *g, worker *w, int u, int v)
{
    int number = edge_number(&u, &v), cube = u % POINTS;
    int32_t *slot = &w->vertex_of[cube * EDGES + number];
    if (*slot >= 0) return *slot;
    if (!sn_grow(&w->vert, &w->cap_vert, w->n_vert + 1, sizeof *w->vert)) {
        w->no_memory = true;
        return -1;
    }
    sn_vec3 p = point_of(g, w, u), q = point_of(g, w, v);
    double t = root(g, p, q, w->value[u], w->value[v]);
    t = fmin(fmax(t, EDGE_KEEP), 1.0 - EDGE_KEEP);
    w->vert[w->n_vert] = (vertex){edge_key(g, w, cube, number), sn_v3_lerp(p, q, t)};
    *slot = (int32_t)(w->n_vert++ - w->block_vert);
    return *slot;
}

/* ---- tets ---- */

static void add_triangle(worker *w, int32_t a, int32_t b, int32_t c)
{
    if (!sn_grow(&w->tri, &w->cap_tri, w->n_tri + 1, sizeof *w->tri))
        w->no_memory = true;
    else
        w->tri[w->n_tri++] = (triangle){{a, b, c}};
}

static double span2(const worker *w, int32_t a, int32_t b)
{
    const vertex *v = w->vert + w->block_vert;
    return sn_v3_len2(sn_v3_sub(v[a].pos, v[b].pos));
}

/* Corners of a tet by its mask of inside corners, evenly permuted: the lone corner first, or the two inside
 * ones. */
static const unsigned char order[16][4] = {{0, 1, 2, 3}, {0, 1, 2, 3}, {1, 0, 3, 2}, {0, 1, 2, 3},
                                           {2, 3, 0, 1}, {0, 2, 3, 1}, {1, 2, 0, 3}, {3, 2, 1, 0},
                                           {3, 2, 1, 0}, {0, 3, 1, 2}, {1, 3, 2, 0}, {2, 3, 0, 1},
                                           {2, 3, 0, 1}, {1, 0, 3, 2}, {0, 1, 2, 3}, {0, 1, 2, 3}};

/* tet: four point ids, positively oriented. */
static void march(const lattice *g, worker *w, const int tet[4])
{
    int mask = 0, n_inside = 0;
    for (int k = 0; k < 4; k++)
        if (is_inside(w->value[tet[k]])) {
            mask |= 1 << k;
            n_inside++;
        }
    if (n_inside == 0 || n_inside == 4) return;
    const unsigned char *o = order[mask];
    int a = tet[o[0]], b = tet[o[1]], c = tet[o[2]], d = tet[o[3]];
    if (n_inside == 2) {
        int32_t q[4] = {vertex_on(g, w, a, c), vertex_on(g, w, a, d), vertex_on(g, w, b, d),
                        vertex_on(g, w, b, c)};
        if (w->no_memory) return;
        int s = span2(w, q[1], q[3]) < span2(w, q[0], q[2]); /* the shorter diagonal: better triangles */
        add_triangle(w, q[s], q[s + 1], q[s + 2]);
        add_triangle(w, q[s], q[s + 2], q[(s + 3) % 4]);
        return;
    }
    int32_t q[3] = {vertex_on(g, w, a, b), vertex_on(g, w, a, c), vertex_on(g, w, a, d)};
    if (w->no_memory) return;
    bool out = n_inside == 1; /* the lone corner is inside: the triangle turns away from it */
    add_triangle(w, q[0], out ? q[1] : q[2], out ? q[2] : q[1]);
}

/* The four tets around the edge from corner c along the axis. */
static void march_ring(const lattice *g, worker *w, int c, int axis)
{
    int e = stride[(axis + 1) % 3], f = stride[(axis + 2) % 3], centre = c + POINTS;
    int ring[4] = {centre, centre - e, centre - e - f, centre - f};
    int n_inside = is_inside(w->value[c]) + is_inside(w->value[c + stride[axis]]);
    for (int k = 0; k < 4; k++) n_inside += is_inside(w->value[ring[k]]);
    if (n_inside == 0 || n_inside == 6) return;
    for (int k = 0; k < 4; k++) {
        int tet[4] = {c, c + stride[axis], ring[k], ring[(k + 1) % 4]};
        march(g, w, tet);
    }
}

static void march_block(const lattice *g, worker *w)
{
    memset(w->vertex_of, -1, sizeof w->vertex_of);
    for (int z = 1; z <= BLOCK; z++)
        for (int y = 1; y <= BLOCK; y++)
            for (int x = 1; x <= BLOCK; x++) {
                int32_t i[3] = {w->first[0] + x, w->first[1] + y, w->first[2] + z};
                if (i[0] >= g->n[0] || i[1] >= g->n[1] || i[2] >= g->n[2]) continue;
                for (int axis = 0; axis < 3 && !w->no_memory; axis++)
                    if (i[(axis + 1) % 3] >= 1 && i[(axis + 2) % 3] >= 1)
                        march_ring(g, w, x + SIDE * (y + SIDE * z), axis);
            }
}

static piece run_block(const lattice *g, worker *w, int64_t i_block)
{
    piece out = {0, w->n_vert, 0, w->n_tri, 0};
    w->block_vert = w->n_vert;
    int64_t row = i_block / g->blocks[0];
    w->first[0] = (int32_t)(i_block % g->blocks[0]) * BLOCK - 1;
    w->first[1] = (int32_t)(row % g->blocks[1]) * BLOCK - 1;
    w->first[2] = (int32_t)(row / g->blocks[1]) * BLOCK - 1;
    if (!is_far(g, w) && sample(g, w)) march_block(g, w);
    out.n_vert = w->n_vert - out.first_vert;
    out.n_tri = w->n_tri - out.first_tri;
    return out;
}

/* ---- all blocks ---- */

typedef struct sweep {
    lattice g;
    worker **worker;
    int n_worker;
    piece *piece; /* of blocks with surface, in block order */
    size_t n_piece, cap_piece;
} sweep;

static int thread_number(void)
{
#ifdef _OPENMP
    return omp_get_thread_num();
#else
    return 0;
#endif
}

static void run_batch(sweep *s, const sn_run *run, int64_t first, int n, piece *found)
{
#pragma omp parallel for num_threads(s->n_worker) schedule(dynamic, 8)
    for (int i = 0; i < n; i++) {
        int k = thread_number();
        worker *w = s->worker[k];
        found[i] = (piece){0};
        if (w->no_memory || w->stopped) continue;
        if (sn_run_stopped(run)) {
            w->stopped = true;
            continue;
        }
        found[i] = run_block(&s->g, w, first + i);
        found[i].i_worker = k;
    }
}

static sn_status after_batch(sweep *s, int n, const piece *found, sn_error *err)
{
    for (int k = 0; k < s->n_worker; k++) {
        if (s->worker[k]->no_memory) return sn_fail(err, SN_ENOMEM, "polygonize: no memory for the surface");
        if (s->worker[k]->stopped) return sn_fail(err, SN_ECANCEL, "interrupted while polygonizing");
    }
    for (int i = 0; i < n; i++) {
        if (found[i].n_tri == 0) continue;
        if (!sn_grow(&s->piece, &s->cap_piece, s->n_piece + 1, sizeof *s->piece))
            return sn_fail(err, SN_ENOMEM, "polygonize: no memory for the surface");
        s->piece[s->n_piece++] = found[i];
    }
    return SN_OK;
}

static sn_status run_blocks(sweep *s, const sn_run *run, sn_error *err)
{
    int64_t n = (int64_t)s->g.blocks[0] * s->g.blocks[1] * s->g.blocks[2];
    piece *found = SN_NEW(piece, BATCH);
    if (!found) return sn_fail(err, SN_ENOMEM, "polygonize: no memory");
    sn_status st = SN_OK;
    for (int64_t i = 0; i < n && !st; i += BATCH) {
        st = sn_run_step(run, "polygonizing", (double)i / (double)n, err);
        if (st) break;
        int m = n - i < BATCH ? (int)(n - i) : BATCH;
        run_batch(s, run, i, m, found);
        st = sn_run_step(run, "polygonizing", (double)(i + m) / (double)n, err);
        if (!st) st = after_batch(s, m, found, err);
    }
    sn_release(found);
    return st;
}

/* ---- the mesh ---- */

/* Numbers edges in the order they come: open addressing, at most half full. */
typedef struct numbering {
    int64_t *key; /* -1: free */
    int32_t *id;
    size_t mask;
} numbering;

static int32_t number_of(numbering *t, int64_t key, int32_t next)
{
    size_t at = (size_t)(((uint64_t)key * 0x9e3779b97f4a7c15u) >> 32) & t->mask;
    while (t->key[at] != key && t->key[at] != -1) at = (at + 1) & t->mask;
    if (t->key[at] == -1) {
        t->key[at] = key;
        t->id[at] = next;
    }
    return t->id[at];
}

/* Joins the pieces; out has room for every vertex of every piece. id: room for those of one piece. */
static void join(const sweep *s, numbering *t, int32_t *id, sn_tri_mesh *out)
{
    out->n_vert = 0;
    int32_t *face = out->face;
    for (size_t i = 0; i < s->n_piece; i++) {
        const piece *p = &s->piece[i];
        const vertex *v = s->worker[p->i_worker]->vert + p->first_vert;
        for (size_t k = 0; k < p->n_vert; k++) {
            id[k] = number_of(t, v[k].key, out->n_vert);
            if (id[k] == out->n_vert) sn_v3_store(out->pos + 3 * (size_t)out->n_vert++, v[k].pos);
        }
        const triangle *f = s->worker[p->i_worker]->tri + p->first_tri;
        for (size_t k = 0; k < p->n_tri; k++)
            for (int c = 0; c < 3; c++) *face++ = id[f[k].v[c]];
    }
}

static sn_status assemble(const sweep *s, sn_tri_mesh *out, sn_error *err)
{
    size_t n_vert = 0, n_tri = 0, room = 1;
    for (size_t i = 0; i < s->n_piece; i++) {
        n_vert += s->piece[i].n_vert;
        n_tri += s->piece[i].n_tri;
    }
    bool fits = true;
    int32_t nv = sn_to_i32(n_vert, &fits), nf = sn_to_i32(n_tri, &fits);
    if (!fits)
        return sn_fail(err, SN_ELIMIT, "polygonize: %zu faces, at most %d can be kept", n_tri, INT32_MAX);
    if (nf == 0) return SN_OK;
    while (room < 2 * n_vert) room *= 2;
    numbering t = {SN_NEW(int64_t, room), SN_NEW(int32_t, room), room - 1};
    int32_t *id = SN_NEW(int32_t, POINTS * EDGES);
    sn_status st = sn_tri_mesh_reserve(out, nv, nf, err);
    if (!st && !(t.key && t.id && id)) st = sn_fail(err, SN_ENOMEM, "polygonize: no memory for %d faces", nf);
    if (!st) {
        memset(t.key, -1, room * sizeof *t.key);
        join(s, &t, id, out);
        double *fitted = sn_realloc(out->pos, 3 * (size_t)out->n_vert, sizeof *fitted);
        if (fitted) out->pos = fitted;
    }
    sn_release(t.key);
    sn_release(t.id);
    sn_release(id);
    return st;
}

/* ---- set-up ---- */

static double extent(sn_box3 box, int axis)
{
    sn_vec3 d = sn_v3_sub(box.max, box.min);
    return axis == 0 ? d.x : axis == 1 ? d.y : d.z;
}

static double count_points(sn_box3 box, double cell)
{
    double corners = 1.0, centres = 1.0;
    for (int k = 0; k < 3; k++) {
        double n = ceil(extent(box, k) / cell) + 2.0;
        corners *= n + 1.0;
        centres *= n;
    }
    return corners + centres;
}

double sn_polygonize_smallest_cell(sn_box3 box)
{
    double hi = sn_box3_diagonal(box), lo = 1e-9 * hi; /* 1e9 cells on the diagonal: over 1e9 points */
    for (int i = 0; i < 40; i++) {
        double mid = sqrt(lo) * sqrt(hi);
        *(count_points(box, mid) > MAX_POINTS ? &lo : &hi) = mid;
    }
    return hi;
}

static sn_status check(const sn_polygonize *p, sn_error *err)
{
    sn_box3 b = p->box;
    if (!(p->cell > 0.0 && isfinite(p->cell)))
        return sn_fail(err, SN_EINVAL, "polygonize: cell is %g, need > 0", p->cell);
    bool is_box = sn_v3_is_finite(b.min) && sn_v3_is_finite(b.max);
    if (!is_box || b.min.x > b.max.x || b.min.y > b.max.y || b.min.z > b.max.z)
        return sn_fail(err, SN_EINVAL, "polygonize: box %g %g %g to %g %g %g is empty or not finite", b.min.x,
                       b.min.y, b.min.z, b.max.x, b.max.y, b.max.z);
    double n = count_points(b, p->cell);
    if (!(n <= MAX_POINTS)) /* 1.01: still enough when rounded to three digits */
        return sn_fail(err, SN_ELIMIT,
                       "polygonize: cell %g needs %.3g lattice points, at most 2e8; a cell of %.3g would do",
                       p->cell, n, 1.01 * sn_polygonize_smallest_cell(b));
    double far = fmax(fmax(fmax(fabs(b.min.x), fabs(b.max.x)), fmax(fabs(b.min.y), fabs(b.max.y))),
                      fmax(fabs(b.min.z), fabs(b.max.z)));
    if (p->cell < MIN_CELL_REL * far)
        return sn_fail(err, SN_EINVAL, "polygonize: cell %g is too small for coordinates up to %g, need %g",
                       p->cell, far, MIN_CELL_REL * far);
    return SN_OK;
}

static void lay_out(lattice *g, const sn_polygonize *p)
{
    double h = p->cell, m = CUT_MARGIN * h;
    g->p = p;
    g->origin = sn_v3_sub(p->box.min, sn_v3(h, h, h));
    g->cut = (sn_box3){sn_v3_sub(p->box.min, sn_v3(m, m, m)), sn_v3_add(p->box.max, sn_v3(m, m, m))};
    for (int k = 0; k < 3; k++) {
        g->n[k] = (int32_t)ceil(extent(p->box, k) / h) + 2;
        g->blocks[k] = (g->n[k] + BLOCK - 1) / BLOCK;
    }
}

static sn_status make_workers(sweep *s, const sn_run *run, sn_error *err)
{
    s->n_worker = sn_run_threads(run);
    s->worker = SN_NEW_ZERO(worker *, s->n_worker);
    bool ok = s->worker != NULL;
    for (int k = 0; ok && k < s->n_worker; k++) ok = (s->worker[k] = SN_NEW_ZERO(worker, 1)) != NULL;
    return ok ? SN_OK : sn_fail(err, SN_ENOMEM, "polygonize: no memory for %d threads", s->n_worker);
}

static void free_sweep(sweep *s)
{
    for (int k = 0; s->worker && k < s->n_worker && s->worker[k]; k++) {
        sn_release(s->worker[k]->vert);
        sn_release(s->worker[k]->tri);
        sn_release(s->worker[k]);
    }
    sn_release(s->worker);
    sn_release(s->piece);
}

sn_status sn_polygonize_run(const sn_polygonize *p, const sn_run *run, sn_tri_mesh *out, sn_error *err)
{
    assert(p->value);
    sn_tri_mesh_free(out);
    sn_status st = check(p, err);
    if (st) return st;
    sweep s = {0};
    lay_out(&s.g, p);
    st = make_workers(&s, run, err);
    if (!st) st = run_blocks(&s, run, err);
    if (!st) st = assemble(&s, out, err);
    if (st) sn_tri_mesh_free(out);
    free_sweep(&s);
    return st;
}
