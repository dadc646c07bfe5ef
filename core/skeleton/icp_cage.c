#include "skeleton/icp_cage.h"

#include "base/alloc.h"
#include "base/dense.h"
#include "skeleton/cage.h"

#include <string.h>

static const char STEP[] = "cage ICP";
static const double EXACT_REL = 1e-10; /* of the piece's size: the residual is rounding          */
static const double SOFTER = 0.25;     /* from one stiffness to the next                         */
static const double ROUGH = 0.02;      /* tolerance of all stiffnesses but the last              */
static const double NOISE_REL = 1e-7;  /* of the size: changes of the residual below this are none */
static const double WHOLE = 1e-3;      /* weight of |L D|^2 against |L P D|^2                    */
static const double STILL = 1e-6;      /* weight of |D|^2                                        */

/* ---- the smoothness of the cage ---- */

/* One column against the `n_done` before it, twice; false when nothing is left of it. */
static bool orthonormalize(double *column, const double *done, int n_done, int32_t n)
{
    double before = 0.0, after = 0.0;
    for (int32_t i = 0; i < n; i++) before += column[i] * column[i];
    for (int k = 0; k < 2 * n_done; k++) {
        const double *q = done + (size_t)(k % n_done) * (size_t)n;
        double dot = 0.0;
        for (int32_t i = 0; i < n; i++) dot += q[i] * column[i];
        for (int32_t i = 0; i < n; i++) column[i] -= dot * q[i];
    }
    for (int32_t i = 0; i < n; i++) after += column[i] * column[i];
    if (!(after > 1e-20 * before)) return false;
    for (int32_t i = 0; i < n; i++) column[i] /= sqrt(after);
    return true;
}

/* The functions 1, x, y, z on the cage's vertices, orthonormal: up to 4 columns of n. */
static int affine_basis(const sn_tri_mesh *cage, double *basis)
{
    int n_done = 0;
    int32_t n = cage->n_vert;
    for (int k = 0; k < 4; k++) {
        double *column = basis + (size_t)n_done * (size_t)n;
        for (int32_t i = 0; i < n; i++) column[i] = k == 0 ? 1.0 : cage->pos[3 * (size_t)i + (size_t)k - 1];
        n_done += orthonormalize(column, basis, n_done, n);
    }
    return n_done;
}

/* l: n x n, the vertex itself less the mean of its neighbours. Each edge is seen by two faces. */
static void laplacian(const sn_tri_mesh *cage, double *l)
{
    size_t n = (size_t)cage->n_vert;
    memset(l, 0, n * n * sizeof *l);
    for (size_t c = 0; c < 3 * (size_t)cage->n_face; c++) {
        size_t i = (size_t)cage->face[c], j = (size_t)cage->face[c % 3 == 2 ? c - 2 : c + 1];
        l[i * n + j] = l[j * n + i] = -1.0;
    }
    for (size_t i = 0; i < n; i++) {
        double degree = 0.0;
        for (size_t j = 0; j < n; j++) degree -= l[i * n + j];
        for (size_t j = 0; j < n; j++) l[i * n + j] /= degree;
        l[i * n + i] = 1.0;
    }
}

/* Takes from each row of l its part in the basis: l P. */
static void project_rows(double *l, int32_t n, const double *basis, int n_basis)
{
    for (int32_t r = 0; r < n; r++) {
        double *row = l + (size_t)r * (size_t)n;
        for (int k = 0; k < n_basis; k++) {
            const double *q = basis + (size_t)k * (size_t)n;
            double dot = 0.0;
            for (int32_t i = 0; i < n; i++) dot += row[i] * q[i];
            for (int32_t i = 0; i < n; i++) row[i] -= dot * q[i];
        }
    }
}

/* k = (P L^T L P + WHOLE L^T L + STILL I) / n; k: n x n. */
static sn_status smoothness(const sn_tri_mesh *cage, double *k, sn_error *err)
{
    int32_t n = cage->n_vert;
    size_t nn = (size_t)n * (size_t)n;
    double *l = SN_NEW(double, nn), *basis = SN_NEW(double, 4 * (size_t)n);
    sn_status st = l && basis ? SN_OK : sn_fail(err, SN_ENOMEM, "%s: no memory for %d vertices", STEP, n);
    if (!st) {
        memset(k, 0, nn * sizeof *k);
        laplacian(cage, l);
        sn_dense_add_gram(l, n, n, k);
        for (size_t i = 0; i < nn; i++) k[i] *= WHOLE;
        project_rows(l, n, basis, affine_basis(cage, basis));
        sn_dense_add_gram(l, n, n, k);
        for (int32_t i = 0; i < n; i++) k[(size_t)i * (size_t)n + (size_t)i] += STILL;
        for (size_t i = 0; i < nn; i++) k[i] /= n;
    }
    sn_release(l);
    sn_release(basis);
    return st;
}

/* ---- faces inside out ---- */

static sn_vec3 face_normal_at(const int32_t *v, const double *pos)
{
    sn_vec3 a = sn_v3_load(pos + 3 * (size_t)v[0]);
    return sn_v3_cross(sn_v3_sub(sn_v3_load(pos + 3 * (size_t)v[1]), a),
                       sn_v3_sub(sn_v3_load(pos + 3 * (size_t)v[2]), a));
}

static sn_vec3 mean_point(const double *pos, int32_t n)
{
    sn_vec3 g = sn_v3(0, 0, 0);
    for (int32_t i = 0; i < n; i++) g = sn_v3_mad(g, 1.0 / n, sn_v3_load(pos + 3 * (size_t)i));
    return g;
}

/* The columns of the linear map that comes closest to from -> to, both about their means; the identity when
 * the points are flat. */
static void best_linear(const double *from, const double *to, int32_t n, sn_vec3 column[3])
{
    sn_vec3 gf = mean_point(from, n), gt = mean_point(to, n);
    double a[9] = {0.0}, x[9] = {0.0}, trace = 0.0;
    for (int32_t i = 0; i < n; i++) {
        sn_vec3 f = sn_v3_sub(sn_v3_load(from + 3 * (size_t)i), gf);
        sn_vec3 t = sn_v3_sub(sn_v3_load(to + 3 * (size_t)i), gt);
        const double p[3] = {f.x, f.y, f.z}, q[3] = {t.x, t.y, t.z};
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++) {
                a[3 * j + k] += p[j] * p[k];
                x[3 * k + j] += p[j] * q[k];
            }
    }
    for (int k = 0; k < 3; k++) trace += a[4 * k];
    for (int k = 0; k < 3; k++) a[4 * k] += 1e-12 * trace; /* flat points: x is then the identity at most */
    for (int k = 0; k < 3; k++) x[4 * k] += 1e-12 * trace;
    bool solved = trace > 0.0 && sn_dense_solve_spd(a, 3, x, 3, NULL) == SN_OK;
    for (int j = 0; j < 3; j++)
        column[j] = solved ? sn_v3(x[j], x[3 + j], x[6 + j]) : sn_v3(j == 0, j == 1, j == 2);
}

int32_t sn_count_inverted(const sn_tri_mesh *m, const double *pos)
{
    sn_vec3 c[3];
    int32_t n_inverted = 0;
    best_linear(m->pos, pos, m->n_vert, c);
    sn_vec3 cofactor[3] = {sn_v3_cross(c[1], c[2]), sn_v3_cross(c[2], c[0]), sn_v3_cross(c[0], c[1])};
    for (int32_t f = 0; f < m->n_face; f++) {
        sn_vec3 n = sn_tri_mesh_face_normal(m, f);
        sn_vec3 want =
            sn_v3_mad(sn_v3_mad(sn_v3_scale(n.x, cofactor[0]), n.y, cofactor[1]), n.z, cofactor[2]);
        n_inverted += sn_v3_dot(want, face_normal_at(m->face + 3 * (size_t)f, pos)) < 0.0;
    }
    return n_inverted;
}

/* ---- one iteration ---- */

typedef struct bending {
    const sn_tri_mesh *cage, *piece;
    const double *bound;
    sn_icp_cage_options opt;
    const sn_run *run;
    sn_icp_pairs pairs;
    double *smooth;      /* n x n                                              */
    double *rows;        /* n_piece x 3n: how distances along normals change   */
    double *tangent;     /* n_piece x n: bound, weighted                       */
    double *gram;        /* n x n                                              */
    double *system, *d;  /* 3n x 3n, 3n: x of all vertices first, then y, z    */
    double *start, *pos; /* the piece at the start and now                     */
    double *now, *kept;  /* the cage now and after the last stiffness          */
} bending;

static sn_status bending_init(bending *b, const sn_bvh *target, sn_error *err)
{
    size_t n = (size_t)b->cage->n_vert, m = (size_t)b->piece->n_vert;
    sn_status st = sn_icp_pairs_init(&b->pairs, b->piece, target, &b->opt.icp, err);
    if (st) return st;
    b->smooth = SN_NEW(double, n *n);
    b->rows = SN_NEW(double, 3 * m * n);
    b->tangent = SN_NEW(double, m *n);
    b->gram = SN_NEW(double, n *n);
    b->system = SN_NEW(double, 9 * n * n);
    b->d = SN_NEW(double, 3 * n);
    b->start = SN_NEW(double, 3 * m);
    b->pos = SN_NEW(double, 3 * m);
    b->now = SN_NEW(double, 3 * n);
    b->kept = SN_NEW(double, 3 * n);
    if (!b->smooth || !b->rows || !b->tangent || !b->gram || !b->system || !b->d || !b->start || !b->pos ||
        !b->now || !b->kept)
        return sn_fail(err, SN_ENOMEM, "%s: no memory for %zu vertices and %zu points", STEP, n, m);
    memcpy(b->now, b->cage->pos, 3 * n * sizeof *b->now);
    memcpy(b->kept, b->now, 3 * n * sizeof *b->now);
    sn_cage_apply(b->bound, b->piece->n_vert, b->now, b->cage->n_vert, b->run, b->start);
    return smoothness(b->cage, b->smooth, err);
}

static void bending_free(bending *b)
{
    sn_icp_pairs_free(&b->pairs);
    double *all[] = {b->smooth, b->rows,  b->tangent, b->gram, b->system,
                     b->d,      b->start, b->pos,     b->now,  b->kept};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) sn_release(all[i]);
}

/* Moves the piece to where the cage is now, and pairs it. */
static void follow(bending *b)
{
    sn_cage_apply(b->bound, b->piece->n_vert, b->now, b->cage->n_vert, b->run, b->pos);
    sn_icp_pairs_find(&b->pairs, b->pos, b->run);
}

/* The rows of the least squares problem, and its right-hand side in d. */
static void set_rows(bending *b)
{
    const sn_icp_pairs *p = &b->pairs;
    size_t n = (size_t)b->cage->n_vert;
    double across = b->opt.across;
    memset(b->d, 0, 3 * n * sizeof *b->d);
    for (size_t i = 0; i < (size_t)p->n; i++) {
        const double *w = b->bound + i * n, *nrm = p->normal + 3 * i;
        double weight = p->weight[i] / p->kept, u = sqrt(weight * (1.0 - across)), v = sqrt(weight * across);
        sn_vec3 e = sn_v3_sub(sn_v3_load(b->start + 3 * i), sn_v3_load(p->point + 3 * i));
        double along = weight * (1.0 - across) * sn_v3_dot(sn_v3_load(nrm), e);
        const double miss[3] = {e.x, e.y, e.z};
        for (size_t k = 0; k < 3; k++) {
            double *row = b->rows + i * 3 * n + k * n, pull = along * nrm[k] + weight * across * miss[k];
            for (size_t j = 0; j < n; j++) {
                row[j] = u * nrm[k] * w[j];
                b->d[k * n + j] -= pull * w[j];
            }
        }
        for (size_t j = 0; j < n; j++) b->tangent[i * n + j] = v * w[j];
    }
}

/* Moves the cage to the minimum for these pairs. */
static sn_status solve_cage(bending *b, double stiffness, sn_error *err)
{
    int32_t n = b->cage->n_vert;
    size_t row = 3 * (size_t)n, nn = (size_t)n * (size_t)n;
    set_rows(b);
    memset(b->system, 0, 9 * nn * sizeof *b->system);
    sn_dense_add_gram(b->rows, b->piece->n_vert, 3 * n, b->system);
    for (size_t i = 0; i < nn; i++) b->gram[i] = stiffness * b->smooth[i];
    sn_dense_add_gram(b->tangent, b->piece->n_vert, n, b->gram);
    for (size_t k = 0; k < 3; k++)
        for (size_t i = 0; i < (size_t)n; i++)
            for (size_t j = 0; j < (size_t)n; j++)
                b->system[(k * (size_t)n + i) * row + k * (size_t)n + j] += b->gram[i * (size_t)n + j];
    sn_status st = sn_dense_solve_spd(b->system, 3 * n, b->d, 1, err);
    if (st) return sn_fail_prefix(err, st, "%s: ", STEP);
    for (size_t i = 0; i < (size_t)n; i++)
        for (size_t k = 0; k < 3; k++) b->now[3 * i + k] = b->cage->pos[3 * i + k] + b->d[k * (size_t)n + i];
    return SN_OK;
}

/* ---- the whole ---- */

/* Iterates at one stiffness until the residual settles; report->stop is SETTLED, EXACT or an error. */
static sn_status settle(bending *b, double stiffness, double tolerance, sn_icp_report *r, sn_error *err)
{
    r->stop = SN_ICP_LIMIT;
    while (r->n_iteration < b->opt.icp.max_iterations) {
        double before = b->pairs.residual;
        sn_status st = sn_run_step(b->run, "fitting a bone: cage",
                                   (double)r->n_iteration / b->opt.icp.max_iterations, err);
        if (!st) st = solve_cage(b, stiffness, err);
        if (st) return st;
        follow(b);
        r->n_iteration++;
        sn_icp_pairs_tell(&b->pairs, r);
        bool exact = b->pairs.residual <= EXACT_REL * r->size;
        bool settled = fabs(before - b->pairs.residual) <= tolerance * before + NOISE_REL * r->size;
        if (!sn_icp_pairs_suffice(&b->pairs))
            r->stop = SN_ICP_UNPAIRED;
        else if (exact || settled)
            r->stop = exact ? SN_ICP_EXACT : SN_ICP_SETTLED;
        if (r->stop != SN_ICP_LIMIT) return SN_OK;
    }
    return SN_OK;
}

/* Puts the cage back to the last stiffness without faces inside out. */
static void go_back(bending *b, sn_icp_report *r)
{
    memcpy(b->now, b->kept, 3 * (size_t)b->cage->n_vert * sizeof *b->now);
    follow(b);
    sn_icp_pairs_tell(&b->pairs, r);
    r->stop = SN_ICP_STIFF;
}

static sn_status soften(bending *b, sn_icp_report *r, sn_error *err)
{
    follow(b);
    sn_icp_pairs_tell(&b->pairs, r);
    r->stop = b->pairs.residual <= EXACT_REL * r->size ? SN_ICP_EXACT : SN_ICP_UNPAIRED;
    if (r->stop == SN_ICP_EXACT || !sn_icp_pairs_suffice(&b->pairs)) return SN_OK;
    for (double stiffness = b->opt.stiff;; stiffness = fmax(SOFTER * stiffness, b->opt.soft)) {
        bool is_last = stiffness <= b->opt.soft;
        double tolerance = is_last ? b->opt.icp.tolerance : fmax(ROUGH, b->opt.icp.tolerance);
        sn_status st = settle(b, stiffness, tolerance, r, err);
        if (st || r->stop == SN_ICP_LIMIT || r->stop == SN_ICP_UNPAIRED) return st;
        if (sn_count_inverted(b->cage, b->now) > 0) {
            go_back(b, r);
            return SN_OK;
        }
        if (is_last || r->stop == SN_ICP_EXACT) return SN_OK;
        memcpy(b->kept, b->now, 3 * (size_t)b->cage->n_vert * sizeof *b->now);
    }
}

static sn_status set_options(sn_icp_cage_options *o, sn_error *err)
{
    sn_status st = sn_icp_options_set(&o->icp, 200, 0.01, STEP, err);
    if (st) return st;
    if (o->stiff == 0.0) o->stiff = 100.0;
    if (o->soft == 0.0) o->soft = 1e-3;
    if (o->across == 0.0) o->across = 0.05;
    if (!(o->soft > 0.0 && o->stiff >= o->soft && isfinite(o->stiff)))
        return sn_fail(err, SN_EINVAL, "%s: stiffness goes from %g to %g, need > 0 and not rising", STEP,
                       o->stiff, o->soft);
    if (o->across >= 0.0 && o->across <= 1.0) return SN_OK;
    return sn_fail(err, SN_EINVAL, "%s: across is %g, need 0 to 1", STEP, o->across);
}

sn_status sn_icp_cage_run(const sn_tri_mesh *cage, const sn_tri_mesh *piece, const double *bound,
                          const sn_bvh *target, const sn_icp_cage_options *options, const sn_run *run,
                          double *out, sn_icp_report *report, sn_error *err)
{
    bending b = {.cage = cage, .piece = piece, .bound = bound, .opt = *options, .run = run};
    *report = (sn_icp_report){.size = sn_box3_diagonal(sn_tri_mesh_bounds(piece))};
    sn_status st = set_options(&b.opt, err);
    if (!st) st = bending_init(&b, target, err);
    if (!st) st = soften(&b, report, err);
    if (st) report->stop = SN_ICP_NONE;
    if (!st) st = sn_icp_judge(report, &b.opt.icp, STEP, err);
    if (!st) memcpy(out, b.now, 3 * (size_t)cage->n_vert * sizeof *out);
    bending_free(&b);
    return st;
}
