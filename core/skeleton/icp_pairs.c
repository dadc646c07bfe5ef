#include "skeleton/icp_pairs.h"

#include "base/alloc.h"
#include "base/array.h"

#include <string.h>

static const double LEAST_PAIRED = 0.3; /* of the area */

const char *sn_icp_stop_name(sn_icp_stop stop)
{
    static const char *const name[] = {"none", "exact", "settled", "stiff", "lost", "limit", "unpaired"};
    return name[stop];
}

sn_status sn_icp_options_set(sn_icp_options *o, int32_t max_iterations, double max_residual, const char *step,
                             sn_error *err)
{
    if (o->tolerance == 0.0) o->tolerance = 1e-4;
    if (o->max_residual == 0.0) o->max_residual = max_residual;
    if (o->max_iterations == 0) o->max_iterations = max_iterations;
    if (!(o->min_dot >= -1.0 && o->min_dot <= 1.0))
        return sn_fail(err, SN_EINVAL, "%s: min_dot is %g, need -1 to 1", step, o->min_dot);
    if (!(o->trim >= 0.0 && o->trim <= 0.9))
        return sn_fail(err, SN_EINVAL, "%s: trim is %g, need 0 to 0.9", step, o->trim);
    if (!(o->tolerance > 0.0 && o->tolerance < 1.0))
        return sn_fail(err, SN_EINVAL, "%s: tolerance is %g, need more than 0 and less than 1", step,
                       o->tolerance);
    if (!(o->max_residual > 0.0))
        return sn_fail(err, SN_EINVAL, "%s: max_residual is %g, need > 0", step, o->max_residual);
    if (o->max_iterations >= 1 && o->max_iterations <= SN_ICP_MAX_ITERATIONS) return SN_OK;
    return sn_fail(err, SN_EINVAL, "%s: max_iterations is %d, need 1 to %d", step, o->max_iterations,
                   SN_ICP_MAX_ITERATIONS);
}

/* ---- pairs ---- */

typedef struct far_pair {
    double dist;
    int32_t i;
} far_pair;

static int far_pair_less(const void *a, const void *b)
{
    const far_pair *p = a, *q = b;
    if (p->dist != q->dist) return p->dist < q->dist ? -1 : 1;
    return (p->i > q->i) - (p->i < q->i);
}

static sn_status set_shares(sn_icp_pairs *p, sn_error *err)
{
    const sn_tri_mesh *m = p->piece;
    double sum = 0.0;
    for (int32_t f = 0; f < m->n_face; f++) {
        double area = sn_v3_len(sn_tri_mesh_face_normal(m, f)); /* twice */
        for (int k = 0; k < 3; k++) p->share[m->face[3 * (size_t)f + (size_t)k]] += area;
        sum += 3.0 * area;
    }
    if (!(sum > 0.0 && isfinite(sum)))
        return sn_fail(err, SN_EINVAL, "template skin: area is %g, need > 0", sum / 6.0);
    for (int32_t i = 0; i < p->n; i++) p->share[i] /= sum;
    return SN_OK;
}

sn_status sn_icp_pairs_init(sn_icp_pairs *p, const sn_tri_mesh *piece, const sn_bvh *target,
                            const sn_icp_options *opt, sn_error *err)
{
    size_t n = (size_t)piece->n_vert;
    *p = (sn_icp_pairs){
        .piece = piece, .target = target, .min_dot = opt->min_dot, .trim = opt->trim, .n = piece->n_vert};
    p->share = SN_NEW_ZERO(double, n);
    p->own = SN_NEW(double, 3 * n);
    p->point = SN_NEW(double, 3 * n);
    p->normal = SN_NEW(double, 3 * n);
    p->dist = SN_NEW(double, n);
    p->weight = SN_NEW(double, n);
    p->order = SN_NEW(far_pair, n);
    if (p->share && p->own && p->point && p->normal && p->dist && p->weight && p->order)
        return set_shares(p, err);
    return sn_fail(err, SN_ENOMEM, "ICP: no memory for %zu points", n);
}

void sn_icp_pairs_free(sn_icp_pairs *p)
{
    sn_release(p->share);
    sn_release(p->own);
    sn_release(p->point);
    sn_release(p->normal);
    sn_release(p->dist);
    sn_release(p->weight);
    sn_release(p->order);
    *p = (sn_icp_pairs){0};
}

/* Unit normals of the piece at its vertices: of the faces around, weighted by area. */
static void find_own_normals(sn_icp_pairs *p, const double *pos)
{
    const sn_tri_mesh *m = p->piece;
    memset(p->own, 0, 3 * (size_t)p->n * sizeof *p->own);
    for (int32_t f = 0; f < m->n_face; f++) {
        const int32_t *v = m->face + 3 * (size_t)f;
        sn_vec3 a = sn_v3_load(pos + 3 * (size_t)v[0]);
        sn_vec3 n = sn_v3_cross(sn_v3_sub(sn_v3_load(pos + 3 * (size_t)v[1]), a),
                                sn_v3_sub(sn_v3_load(pos + 3 * (size_t)v[2]), a));
        for (int k = 0; k < 3; k++) {
            double *to = p->own + 3 * (size_t)v[k];
            sn_v3_store(to, sn_v3_add(sn_v3_load(to), n));
        }
    }
    for (int32_t i = 0; i < p->n; i++) {
        double *to = p->own + 3 * (size_t)i;
        sn_v3_store(to, sn_v3_unit(sn_v3_load(to)));
    }
}

static void find_nearest(sn_icp_pairs *p, const double *pos, const sn_run *run)
{
    const sn_tri_mesh *m = sn_bvh_mesh(p->target);
#pragma omp parallel for schedule(dynamic, 64) num_threads(sn_run_threads(run)) if (p->n >= 500)
    for (int32_t i = 0; i < p->n; i++) {
        sn_closest c = sn_bvh_closest(p->target, sn_v3_load(pos + 3 * (size_t)i));
        p->dist[i] = c.dist;
        sn_v3_store(p->point + 3 * (size_t)i, c.point);
        sn_v3_store(p->normal + 3 * (size_t)i, sn_v3_unit(sn_tri_mesh_face_normal(m, c.face)));
    }
}

/* Discards the pairs that oppose, then the farthest of the rest. */
static void choose(sn_icp_pairs *p)
{
    far_pair *order = p->order;
    int32_t n = 0;
    for (int32_t i = 0; i < p->n; i++) {
        double dot = sn_v3_dot(sn_v3_load(p->own + 3 * (size_t)i), sn_v3_load(p->normal + 3 * (size_t)i));
        p->weight[i] = 0.0;
        if (dot >= p->min_dot) order[n++] = (far_pair){p->dist[i], i};
    }
    p->n_opposed = p->n - n;
    p->n_paired = n - (int32_t)(p->trim * n);
    p->n_far = n - p->n_paired;
    if (p->n_far > 0) sn_sort(order, (size_t)n, sizeof *order, far_pair_less);
    for (int32_t k = 0; k < p->n_paired; k++) p->weight[order[k].i] = p->share[order[k].i];
}

void sn_icp_pairs_find(sn_icp_pairs *p, const double *pos, const sn_run *run)
{
    find_own_normals(p, pos);
    find_nearest(p, pos, run);
    choose(p);
    double sum = 0.0;
    p->kept = 0.0;
    for (int32_t i = 0; i < p->n; i++) {
        p->kept += p->weight[i];
        sum += p->weight[i] * p->dist[i] * p->dist[i];
    }
    p->residual = p->kept > 0.0 ? sqrt(sum / p->kept) : INFINITY;
}

bool sn_icp_pairs_suffice(const sn_icp_pairs *p)
{
    return p->kept >= LEAST_PAIRED * (1.0 - p->trim);
}

void sn_icp_pairs_tell(const sn_icp_pairs *p, sn_icp_report *r)
{
    r->residual[r->n_iteration] = p->residual;
    r->n_point = p->n;
    r->n_paired = p->n_paired;
    r->n_opposed = p->n_opposed;
    r->n_far = p->n_far;
}

sn_status sn_icp_judge(const sn_icp_report *r, const sn_icp_options *opt, const char *step, sn_error *err)
{
    double reached = r->residual[r->n_iteration], wanted = opt->max_residual * r->size;
    if (r->stop == SN_ICP_UNPAIRED)
        return sn_fail(err, SN_ESOLVE,
                       "%s: only %d of %d points of the template's skin have a match on the skin after %d "
                       "iterations (%d face the other way): is the template placed near the right spot?",
                       step, r->n_paired, r->n_point, r->n_iteration, r->n_opposed);
    if (r->stop == SN_ICP_LOST)
        return sn_fail(
            err, SN_ESOLVE,
            "%s: does not converge: in %d iterations it went more than 54 degrees or nearly a factor "
            "of 2 in size away from the start, to a residual of %g (%g or less near the start would "
            "do): place the template nearer to the right spot, turned the right way",
            step, r->n_iteration, reached, wanted);
    if (r->stop == SN_ICP_LIMIT)
        return sn_fail(err, SN_ESOLVE,
                       "%s: does not converge: after %d iterations the residual is %g and still changes by "
                       "more than a share of %g (wanted: %g or less, settled)",
                       step, r->n_iteration, reached, opt->tolerance, wanted);
    if (reached <= wanted) return SN_OK;
    return sn_fail(err, SN_ESOLVE,
                   "%s: does not converge: the residual settled at %g after %d iterations, wanted %g or less "
                   "(%g of the template's size %g)",
                   step, reached, r->n_iteration, wanted, opt->max_residual, r->size);
}
