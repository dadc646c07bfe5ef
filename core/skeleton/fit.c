#include "skeleton/fit.h"

#include "base/alloc.h"
#include "mesh/mesh_check.h"
#include "skeleton/cage.h"

#include <string.h>

void sn_fit_result_free(sn_fit_result *r)
{
    sn_tri_mesh_free(&r->bone);
    sn_tri_mesh_free(&r->cage);
    sn_release(r->point);
    r->point = NULL;
}

/* ---- inputs ---- */

static sn_status check_valid(const sn_tri_mesh *m, const char *what, sn_error *err)
{
    sn_status st = sn_tri_mesh_validate(m, err);
    return st ? sn_fail_prefix(err, st, "%s: ", what) : SN_OK;
}

static sn_status check_closed(const sn_tri_mesh *m, sn_error *err)
{
    sn_mesh_check c;
    sn_status st = check_valid(m, "skin", err);
    if (!st) st = sn_mesh_check_topology(&c, m, err);
    if (st) return st;
    if (!c.closed)
        return sn_fail(err, SN_EINVAL, "skin: has %d boundary edges, need a closed surface",
                       c.boundary_edges);
    double volume = sn_tri_mesh_volume(m);
    if (c.oriented && volume > 0.0) return SN_OK;
    return sn_fail(err, SN_EINVAL, "skin: volume is %g or faces turn both ways, need all faces outwards",
                   volume);
}

static sn_status check_inputs(const sn_fit_template *t, const sn_tri_mesh *skin, sn_error *err)
{
    sn_status st = check_valid(t->bone, "template bone", err);
    if (!st) st = check_valid(t->skin, "template skin", err);
    if (!st) st = sn_cage_check(t->cage, err);
    for (int32_t i = 0; i < t->n_point && !st; i++)
        if (!sn_v3_is_finite(sn_v3_load(t->point + 3 * (size_t)i)))
            st = sn_fail(err, SN_EINVAL, "template: landmark %d has a coordinate that is not finite", i + 1);
    if (!st) st = check_closed(skin, err);
    return st;
}

static int32_t count_outside(const sn_bvh *cage, const sn_tri_mesh *m)
{
    int32_t n = 0;
    for (int32_t i = 0; i < m->n_vert; i++) n += !sn_bvh_contains(cage, sn_tri_mesh_point(m, i));
    return n;
}

static sn_status tell_outside(const sn_fit_template *t, sn_fit_result *r, sn_error *err)
{
    sn_bvh *cage = NULL;
    sn_status st = sn_bvh_create(&cage, t->cage, err);
    if (st) return st;
    r->n_bone_outside = count_outside(cage, t->bone);
    r->n_skin_outside = count_outside(cage, t->skin);
    sn_bvh_destroy(cage);
    return SN_OK;
}

/* ---- the two steps ---- */

typedef struct fit {
    const sn_fit_template *t;
    const sn_fit_options *opt;
    const sn_run *run;
    sn_bvh *target;
    sn_tri_mesh cage, piece; /* as the rigid step placed them    */
    double *weight;          /* of the piece's vertices          */
    sn_fit_result *r;
} fit;

static sn_status rigid_step(fit *f, const sn_transform *start, sn_error *err)
{
    sn_fit_result *r = f->r;
    sn_status st = sn_icp_rigid_run(f->t->skin, f->target, start, &f->opt->rigid, !f->opt->keeps_scale,
                                    f->run, &r->placement, &r->rigid, err);
    if (!st) st = sn_tri_mesh_copy(&f->cage, f->t->cage, err);
    if (!st) st = sn_tri_mesh_copy(&f->piece, f->t->skin, err);
    if (!st) st = sn_tri_mesh_transform(&f->cage, &r->placement, err);
    if (!st) st = sn_tri_mesh_transform(&f->piece, &r->placement, err);
    return st;
}

/* The weights of n points in the template's cage; they hold in the placed one, too. */
static sn_status bind(const fit *f, const double *point, int32_t n, double **weight, sn_error *err)
{
    int32_t n_cage = f->t->cage->n_vert;
    *weight = SN_NEW(double, (size_t)n *(size_t)n_cage);
    if (!*weight) return sn_fail(err, SN_ENOMEM, "cage: no memory for %d points and %d vertices", n, n_cage);
    return sn_cage_weights(f->t->cage, point, n, f->run, *weight, err);
}

static sn_status cage_step(fit *f, sn_error *err)
{
    sn_status st = bind(f, f->t->skin->pos, f->t->skin->n_vert, &f->weight, err);
    if (st) return st;
    return sn_icp_cage_run(&f->cage, &f->piece, f->weight, f->target, &f->opt->cage, f->run, f->cage.pos,
                           &f->r->bent, err);
}

/* ---- what follows the cage ---- */

static sn_status carry(const fit *f, const double *point, int32_t n, double *out, sn_error *err)
{
    double *weight = NULL;
    sn_status st = bind(f, point, n, &weight, err);
    if (!st) sn_cage_apply(weight, n, f->cage.pos, f->cage.n_vert, f->run, out);
    sn_release(weight);
    return st;
}

static sn_status count_crossings(const sn_tri_mesh *m, const sn_run *run, int64_t *n, sn_error *err)
{
    sn_mesh_check c;
    sn_status st = sn_mesh_check_run(&c, m, run, err);
    *n = st ? 0 : c.self_intersections;
    return st;
}

static sn_status carry_all(fit *f, sn_error *err)
{
    const sn_fit_template *t = f->t;
    sn_fit_result *r = f->r;
    sn_status st = sn_tri_mesh_copy(&r->bone, t->bone, err);
    if (!st) st = carry(f, t->bone->pos, t->bone->n_vert, r->bone.pos, err);
    if (!st && t->n_point > 0) {
        r->point = SN_NEW(double, 3 * (size_t)t->n_point);
        st = r->point ? carry(f, t->point, t->n_point, r->point, err)
                      : sn_fail(err, SN_ENOMEM, "no memory for %d landmarks", t->n_point);
    }
    if (!st) st = count_crossings(t->bone, f->run, &r->n_crossing_before, err);
    if (!st) st = count_crossings(&r->bone, f->run, &r->n_crossing, err);
    if (!st) st = count_crossings(&f->cage, f->run, &r->n_cage_crossing, err);
    if (st) return st;
    r->n_inverted = sn_count_inverted(t->bone, r->bone.pos);
    r->cage = f->cage;
    sn_tri_mesh_init(&f->cage);
    return SN_OK;
}

sn_status sn_fit_shape(const sn_fit_template *t, const sn_tri_mesh *skin, const sn_transform *start,
                       const sn_fit_options *options, const sn_run *run, sn_fit_result *out, sn_error *err)
{
    fit f = {.t = t, .opt = options, .run = run, .r = out};
    memset(out, 0, sizeof *out);
    sn_status st = check_inputs(t, skin, err);
    if (!st) st = tell_outside(t, out, err);
    if (!st) st = sn_bvh_create(&f.target, skin, err);
    if (!st) st = rigid_step(&f, start, err);
    if (!st) st = cage_step(&f, err);
    if (!st) st = carry_all(&f, err);
    if (st) sn_fit_result_free(out);
    sn_bvh_destroy(f.target);
    sn_tri_mesh_free(&f.cage);
    sn_tri_mesh_free(&f.piece);
    sn_release(f.weight);
    return st;
}
