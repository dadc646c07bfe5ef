#include "muscle/muscle.h"

#include "base/alloc.h"
#include "muscle/path.h"

#include <string.h>

const char *const sn_architecture_name[SN_N_ARCHITECTURE + 1] = {
    "fusiform", "parallel", "convergent", "unipennate", "bipennate", "multipennate", NULL};

void sn_muscle_free(sn_muscle *m)
{
    for (int32_t i = 0; i < m->n_head; i++) sn_head_free(&m->head[i]);
    sn_release(m->head);
    sn_release(m->name);
    memset(m, 0, sizeof *m);
}

sn_status sn_muscle_blame(const sn_muscle *m, int32_t i_head, sn_status st, sn_error *err)
{
    if (!st || st == SN_ECANCEL || st == SN_ELIMIT) return st;
    if (m->n_head > 1 && i_head >= 0)
        return sn_fail_prefix(err, st, "muscle '%s', head %d: ", m->name, i_head + 1);
    return sn_fail_prefix(err, st, "muscle '%s': ", m->name);
}

sn_status sn_muscle_init(sn_muscle *m, const char *name, const sn_head_points *head, int32_t n_head,
                         sn_error *err)
{
    memset(m, 0, sizeof *m);
    m->name = sn_strdup(name);
    m->head = SN_NEW_ZERO(sn_head, n_head);
    sn_status st = SN_OK;
    if (!m->name || !m->head) st = sn_fail(err, SN_ENOMEM, "muscle '%s': no memory", name);
    m->n_head = m->head ? n_head : 0;
    for (int32_t i = 0; i < m->n_head && !st; i++)
        st = sn_muscle_blame(m, i, sn_head_init(&m->head[i], &head[i], err), err);
    if (st) sn_muscle_free(m);
    return st;
}

sn_status sn_muscle_copy(sn_muscle *out, const sn_muscle *m, sn_error *err)
{
    sn_head_points *from = SN_NEW(sn_head_points, m->n_head);
    if (!from) return sn_fail(err, SN_ENOMEM, "muscle '%s': no memory", m->name);
    for (int32_t i = 0; i < m->n_head; i++)
        from[i] = (sn_head_points){m->head[i].point, m->head[i].tissue, m->head[i].n_point};
    sn_status st = sn_muscle_init(out, m->name, from, m->n_head, err);
    sn_release(from);
    if (st) return st;
    out->anisotropy = m->anisotropy;
    out->pennation = m->pennation;
    out->tendon = m->tendon;
    return SN_OK;
}

/* ---- wishes ---- */

sn_status sn_muscle_set_anisotropy(sn_muscle *m, const sn_anisotropy *a, sn_error *err)
{
    if (a->is_on && !isfinite(a->angle_deg))
        return sn_fail(err, SN_EINVAL, "muscle '%s': angle of the frame is %g, need a finite number", m->name,
                       a->angle_deg);
    for (int k = 0; a->is_on && k < 3; k++)
        if (!(a->eigenvalue[k] > 0.0 && isfinite(a->eigenvalue[k])))
            return sn_fail(err, SN_EINVAL, "muscle '%s': eigenvalue %d is %g, need > 0", m->name, k + 1,
                           a->eigenvalue[k]);
    if (a->is_on && a->has_axis) {
        sn_vec3 t = sn_spline_tangent(&m->head[0].spline, 0.0), n;
        if (!sn_v3_is_finite(a->axis) || !(sn_v3_len(a->axis) > 0.0))
            return sn_fail(err, SN_EINVAL, "muscle '%s': axis {%g, %g, %g} of the frame has no direction",
                           m->name, a->axis.x, a->axis.y, a->axis.z);
        if (!sn_normal_towards(t, a->axis, &n))
            return sn_fail(
                err, SN_EINVAL,
                "muscle '%s': axis {%g, %g, %g} of the frame runs along the curve, need a direction "
                "across it",
                m->name, a->axis.x, a->axis.y, a->axis.z);
    }
    m->anisotropy = a->is_on ? *a : (sn_anisotropy){0};
    return SN_OK;
}

sn_status sn_muscle_set_pennation(sn_muscle *m, const sn_pennation *p, sn_error *err)
{
    bool leans = p->kind >= SN_UNIPENNATE;
    if (leans && (p->n_angle < 1 || p->n_angle > SN_PENNATION_ANGLES))
        return sn_fail(err, SN_EINVAL, "muscle '%s': %d pennation angles, need 1..%d", m->name, p->n_angle,
                       SN_PENNATION_ANGLES);
    if (!leans && p->n_angle > 0)
        return sn_fail(err, SN_EINVAL, "muscle '%s': fibers that are %s have no pennation angle", m->name,
                       sn_architecture_name[p->kind]);
    for (int32_t i = 0; i < p->n_angle; i++)
        if (!(p->angle_deg[i] >= 0.0 && p->angle_deg[i] <= 80.0))
            return sn_fail(err, SN_EINVAL, "muscle '%s': pennation angle %d is %g degrees, need 0..80",
                           m->name, i + 1, p->angle_deg[i]);
    if (p->kind == SN_MULTIPENNATE && (p->n_sheet < 2 || p->n_sheet > 16))
        return sn_fail(err, SN_EINVAL, "muscle '%s': %d aponeuroses, need 2..16", m->name, p->n_sheet);
    m->pennation = *p;
    return SN_OK;
}

sn_status sn_muscle_set_tendon(sn_muscle *m, const sn_tendon *t, sn_error *err)
{
    if (!(t->length >= 0.0 && isfinite(t->length)))
        return sn_fail(err, SN_EINVAL, "muscle '%s': tendon length is %g, need >= 0", m->name, t->length);
    if (!(t->area >= 0.0 && isfinite(t->area)))
        return sn_fail(err, SN_EINVAL, "muscle '%s': tendon area is %g, need >= 0", m->name, t->area);
    m->tendon = *t;
    return SN_OK;
}

void sn_muscle_scale_tissue(sn_muscle *m, double factor)
{
    for (int32_t h = 0; h < m->n_head; h++)
        for (int32_t i = 0; i < m->head[h].n_point; i++) m->head[h].tissue[i] *= factor;
}

/* ---- what it is ---- */

double sn_muscle_length(const sn_muscle *m)
{
    double sum = 0.0;
    for (int32_t i = 0; i < m->n_head; i++) sum += sn_spline_length(&m->head[i].spline);
    return sum;
}

static bool all_meet(const sn_muscle *m, bool at_origin)
{
    for (int32_t i = 0; i < m->n_head; i++)
        for (int32_t k = 0; k < i; k++) {
            const sn_head *a = &m->head[i], *b = &m->head[k];
            size_t ia = at_origin ? 0 : (size_t)a->n_point - 1, ib = at_origin ? 0 : (size_t)b->n_point - 1;
            double reach =
                SN_SHARED_END_REL * fmin(sn_spline_length(&a->spline), sn_spline_length(&b->spline));
            if (sn_v3_dist(sn_v3_load(a->point + 3 * ia), sn_v3_load(b->point + 3 * ib)) > reach)
                return false;
        }
    return true;
}

sn_shared_end sn_muscle_shared_end(const sn_muscle *m)
{
    if (all_meet(m, false)) return SN_SHARE_INSERTION;
    return all_meet(m, true) ? SN_SHARE_ORIGIN : SN_SHARE_NONE;
}
