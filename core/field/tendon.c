#include "field/tendon.h"

#include "base/alloc.h"

#include <string.h>

enum { n_step = 64 };

/* Adds a tet's volume to the steps of its head, spread evenly over the range of its corners. */
static void add_tet(const sn_paths *paths, const sn_tet_mesh *m, int32_t t, double volume, double *profile)
{
    double lo = INFINITY, hi = -INFINITY;
    int32_t head = sn_paths_place(paths, sn_tet_mesh_centre(m, t)).head;
    sn_paths one = {&paths->head[head], 1};
    double length = one.head->length;
    for (int k = 0; k < 4; k++) {
        double arc = sn_paths_place(&one, sn_tet_mesh_point(m, m->tet[4 * (size_t)t + (size_t)k])).arc;
        lo = fmin(lo, arc);
        hi = fmax(hi, arc);
    }
    lo = fmin(fmax(lo / length, 0.0), 1.0) * n_step;
    hi = fmin(fmax(hi / length, 0.0), 1.0) * n_step;
    if (!(hi - lo > 1e-9)) return; /* wholly beyond an end: no part of the curve's cross-sections */
    for (int i = (int)lo; i < n_step && i < hi; i++) {
        double from = fmax(lo, i), to = fmin(hi, i + 1);
        if (to > from) profile[(size_t)head * n_step + (size_t)i] += volume * (to - from) / (hi - lo);
    }
}

/* The cross-section `step` steps in from an end of a head; of all heads, where they share it. */
static double area_at(const sn_paths *paths, const double *profile, int32_t head, int step, bool at_origin,
                      bool is_shared)
{
    double sum = 0.0;
    for (int32_t h = 0; h < paths->n_head; h++)
        if (is_shared || h == head)
            sum += profile[(size_t)h * n_step + (size_t)(at_origin ? step : n_step - 1 - step)] * n_step /
                   paths->head[h].length;
    return sum;
}

/* Length of curve from the end to where the cross-section reaches the area: between the middles of steps. */
static double thin_length(const sn_paths *paths, const double *profile, int32_t head, bool at_origin,
                          bool is_shared, double area)
{
    double last = 0.0, length = paths->head[head].length;
    for (int i = 0; i < n_step; i++) {
        double now = area_at(paths, profile, head, i, at_origin, is_shared);
        if (now >= area) {
            double part = i > 0 ? (area - last) / (now - last) : 0.0;
            return length * fmax(i - 0.5 + part, 0.0) / n_step;
        }
        last = now;
    }
    return length;
}

sn_status sn_tendons_find(sn_tendons *t, const sn_tet_mesh *mesh, const double *share, const sn_muscle *m,
                          const sn_paths *paths, sn_error *err)
{
    sn_tendons_free(t);
    double *profile = SN_NEW_ZERO(double, (size_t)m->n_head *n_step);
    t->length = SN_NEW_ZERO(double, 2 * (size_t)m->n_head);
    if (!profile || !t->length) {
        sn_release(profile);
        return sn_fail(err, SN_ENOMEM, "tendon of muscle '%s': no memory", m->name);
    }
    t->n_head = m->n_head;
    for (int32_t i = 0; m->tendon.area > 0.0 && i < mesh->n_tet; i++)
        if (share[i] > 0.0) add_tet(paths, mesh, i, share[i] * sn_tet_mesh_tet_volume(mesh, i), profile);
    sn_shared_end shared = m->n_head > 1 ? sn_muscle_shared_end(m) : SN_SHARE_NONE;
    for (int32_t h = 0; h < m->n_head; h++)
        for (int k = 0; k < 2; k++) {
            bool is_shared = shared == (k ? SN_SHARE_INSERTION : SN_SHARE_ORIGIN);
            double thin = m->tendon.area > 0.0
                              ? thin_length(paths, profile, h, k == 0, is_shared, m->tendon.area)
                              : 0.0;
            t->length[2 * h + k] = fmin(fmax(m->tendon.length, thin), paths->head[h].length);
        }
    sn_release(profile);
    return SN_OK;
}

void sn_tendons_free(sn_tendons *t)
{
    sn_release(t->length);
    memset(t, 0, sizeof *t);
}

/* The same for one head: by how much p lies on the tendon's side. */
static double at_head(const sn_tendons *t, int32_t head, double length, double arc)
{
    double from_origin = t->length[2 * head], from_insertion = t->length[2 * head + 1];
    double origin = from_origin > 0.0 ? from_origin - arc : -length;
    double insertion = from_insertion > 0.0 ? from_insertion - (length - arc) : -length;
    return fmax(origin, insertion);
}

/* The mean over the heads, weighted by the fourth power of nearness: between heads whose tendons are of
 * different lengths the border then runs smoothly from one to the other. */
double sn_tendons_at(const sn_tendons *t, const sn_paths *paths, sn_vec3 p)
{
    double sum = 0.0, weight = 0.0;
    for (int32_t h = 0; h < paths->n_head; h++) {
        sn_paths one = {&paths->head[h], 1};
        sn_curve_place at = sn_paths_place(&one, p);
        double length = one.head->length, near = at.distance / length, w = 1.0 / (near * near + 1e-6);
        sum += w * w * at_head(t, h, length, at.arc);
        weight += w * w;
    }
    return sum / weight;
}
