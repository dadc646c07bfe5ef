#include "muscle/muscle_mirror.h"

#include "base/alloc.h"
#include "muscle/path.h"

/* All heads with the points of m reflected, which stand in `point`. */
static sn_status init_heads(sn_muscle *out, const sn_muscle *m, const sn_plane *plane, const char *name,
                            double *point, sn_head_points *head, sn_error *err)
{
    for (int32_t h = 0; h < m->n_head; h++) {
        const sn_head *from = &m->head[h];
        head[h] = (sn_head_points){point, from->tissue, from->n_point};
        for (int32_t i = 0; i < from->n_point; i++, point += 3)
            sn_v3_store(point, sn_plane_reflect(plane, sn_v3_load(from->point + 3 * (size_t)i)));
    }
    return sn_muscle_init(out, name, head, m->n_head, err);
}

static sn_status mirror_frame(sn_muscle *out, const sn_muscle *m, const sn_plane *plane, sn_error *err)
{
    sn_anisotropy a = m->anisotropy;
    if (!a.is_on && m->pennation.kind < SN_UNIPENNATE) return SN_OK;
    if (!a.is_on) a.eigenvalue[0] = a.eigenvalue[1] = a.eigenvalue[2] = 1.0;
    a.is_on = a.has_axis = true;
    a.axis = sn_v3_scale(-1.0, sn_plane_reflect_vector(plane, sn_muscle_frame_axis(m)));
    a.angle_deg = -a.angle_deg;
    return sn_muscle_set_anisotropy(out, &a, err);
}

sn_status sn_muscle_mirror(sn_muscle *out, const sn_muscle *m, const sn_plane *plane, const char *name,
                           sn_error *err)
{
    size_t n_point = 0;
    for (int32_t h = 0; h < m->n_head; h++) n_point += (size_t)m->head[h].n_point;
    double *point = SN_NEW(double, 3 * n_point);
    sn_head_points *head = SN_NEW(sn_head_points, m->n_head);
    sn_status st = point && head ? SN_OK : sn_fail(err, SN_ENOMEM, "muscle '%s': no memory", name);
    if (!st) st = init_heads(out, m, plane, name, point, head, err);
    sn_release(point);
    sn_release(head);
    if (st) return st;
    out->pennation = m->pennation;
    out->tendon = m->tendon;
    st = mirror_frame(out, m, plane, err);
    if (st) sn_muscle_free(out);
    return st;
}
