#include "skeleton/cage.h"

#include "mesh/mesh_check.h"

#include <string.h>

/* Closer than this share of the cage's size a point is on a face or vertex. */
static const double ON_REL = 1e-13;
/* A face seen edge-on adds nothing: nearer to its plane than this its share is lost in rounding. */
static const double FLAT_REL = 1e-10;

sn_status sn_cage_check(const sn_tri_mesh *cage, sn_error *err)
{
    sn_mesh_check c;
    sn_status st = sn_tri_mesh_validate(cage, err);
    if (st) return sn_fail_prefix(err, st, "cage: ");
    st = sn_mesh_check_topology(&c, cage, err);
    if (st) return st;
    if (!c.closed)
        return sn_fail(err, SN_EINVAL, "cage: has %d boundary edges, need a closed surface",
                       c.boundary_edges);
    if (!c.manifold || !c.oriented)
        return sn_fail(err, SN_EINVAL, "cage: not manifold or faces turn both ways, need a sound surface");
    if (c.unused_vertices > 0)
        return sn_fail(err, SN_EINVAL, "cage: %d vertices without a face, need none", c.unused_vertices);
    double volume = sn_tri_mesh_volume(cage);
    if (volume > 0.0) return SN_OK;
    return sn_fail(err, SN_EINVAL, "cage: volume is %g, need > 0 with faces turned outwards", volume);
}

/* One face seen from a point: v are its corners from there, side[k] the normal of the plane through the point
 * and the edge across corner k, with twice that triangle's area as length. */
typedef struct view {
    sn_vec3 v[3], side[3];
    sn_vec3 normal; /* twice the area of the face */
    double det;     /* six times the volume       */
} view;

static view view_of(const sn_tri_mesh *cage, int32_t f, sn_vec3 p)
{
    view w;
    for (int k = 0; k < 3; k++)
        w.v[k] = sn_v3_sub(sn_tri_mesh_point(cage, cage->face[3 * (size_t)f + (size_t)k]), p);
    for (int k = 0; k < 3; k++) w.side[k] = sn_v3_cross(w.v[(k + 1) % 3], w.v[(k + 2) % 3]);
    w.normal = sn_v3_cross(sn_v3_sub(w.v[1], w.v[0]), sn_v3_sub(w.v[2], w.v[0]));
    w.det = sn_v3_dot(w.normal, w.v[0]);
    return w;
}

/* The weights of a point on this face; false when it is not on it. */
static bool on_face(const view *w, double size, double b[3])
{
    double area = sn_v3_len(w->normal), least = 1.0;
    if (!(fabs(w->det) <= ON_REL * size * area) || !(area > 0.0)) return false;
    for (int k = 0; k < 2; k++) b[k] = sn_v3_dot(w->side[k], w->normal) / (area * area);
    b[2] = 1.0 - b[0] - b[1];
    for (int k = 0; k < 3; k++) least = fmin(least, b[k]);
    return least >= -ON_REL;
}

/* The integral of the directions to the face over its image on the unit sphere is half the sum of the angles
 * of its edges times the normals of their planes [Ju et al. 2005, eq. 5 and 6]; b are its coordinates in the
 * corners. Angles by atan2: right to rounding for all of them. */
static void face_weights(const view *w, double size, double b[3])
{
    sn_vec3 m = sn_v3(0, 0, 0);
    b[0] = b[1] = b[2] = 0.0;
    if (!(fabs(w->det) > FLAT_REL * size * sn_v3_len(w->normal))) return;
    for (int k = 0; k < 3; k++) {
        double s = sn_v3_len(w->side[k]), c = sn_v3_dot(w->v[(k + 1) % 3], w->v[(k + 2) % 3]);
        if (s > 0.0) m = sn_v3_mad(m, 0.5 * atan2(s, c) / s, w->side[k]);
    }
    for (int k = 0; k < 3; k++) b[k] = sn_v3_dot(w->side[k], m) / w->det;
}

/* Weights of a point that is on the cage; false when it is not. row: all 0 before. */
static bool weights_on(const sn_tri_mesh *cage, sn_vec3 p, double size, double *row)
{
    double b[3];
    for (int32_t j = 0; j < cage->n_vert; j++)
        if (sn_v3_dist(sn_tri_mesh_point(cage, j), p) <= ON_REL * size) {
            row[j] = 1.0;
            return true;
        }
    for (int32_t f = 0; f < cage->n_face; f++) {
        view w = view_of(cage, f, p);
        if (!on_face(&w, size, b)) continue;
        for (int k = 0; k < 3; k++) row[cage->face[3 * (size_t)f + (size_t)k]] = b[k];
        return true;
    }
    return false;
}

/* Solves the symmetric 4 x 4 system a x = b by Cholesky; false when a has no full rank. */
static bool solve4(double a[4][4], double x[4])
{
    for (int j = 0; j < 4; j++) {
        double whole = a[j][j];
        for (int k = 0; k < j; k++) a[j][j] -= a[j][k] * a[j][k];
        if (!(a[j][j] > 1e-14 * whole)) return false;
        a[j][j] = sqrt(a[j][j]);
        for (int i = j + 1; i < 4; i++) {
            for (int k = 0; k < j; k++) a[i][j] -= a[i][k] * a[j][k];
            a[i][j] /= a[j][j];
        }
    }
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < i; k++) x[i] -= a[i][k] * x[k];
        x[i] /= a[i][i];
    }
    for (int i = 3; i >= 0; i--) {
        for (int k = i + 1; k < 4; k++) x[i] -= a[k][i] * x[k];
        x[i] /= a[i][i];
    }
    return true;
}

/* What rounding left of "the weights add up to 1 and give the point" is taken away by the smallest change,
 * relative to the weights, that does so. */
static void polish(const sn_tri_mesh *cage, sn_vec3 p, double size, double *row)
{
    double a[4][4] = {{0.0}}, x[4] = {1.0, 0.0, 0.0, 0.0};
    for (int32_t j = 0; j < cage->n_vert; j++) {
        sn_vec3 d = sn_v3_scale(1.0 / size, sn_v3_sub(sn_tri_mesh_point(cage, j), p));
        double q[4] = {1.0, d.x, d.y, d.z};
        for (int i = 0; i < 4; i++) {
            x[i] -= row[j] * q[i];
            for (int k = 0; k < 4; k++) a[i][k] += fabs(row[j]) * q[i] * q[k];
        }
    }
    if (!solve4(a, x)) return;
    for (int32_t j = 0; j < cage->n_vert; j++) {
        sn_vec3 d = sn_v3_scale(1.0 / size, sn_v3_sub(sn_tri_mesh_point(cage, j), p));
        row[j] += fabs(row[j]) * (x[0] + x[1] * d.x + x[2] * d.y + x[3] * d.z);
    }
}

static void weights_of(const sn_tri_mesh *cage, sn_vec3 p, double size, double *row)
{
    memset(row, 0, (size_t)cage->n_vert * sizeof *row);
    if (weights_on(cage, p, size, row)) return;
    for (int32_t f = 0; f < cage->n_face; f++) {
        double b[3];
        view w = view_of(cage, f, p);
        face_weights(&w, size, b);
        for (int k = 0; k < 3; k++) row[cage->face[3 * (size_t)f + (size_t)k]] += b[k];
    }
    double sum = 0.0;
    for (int32_t j = 0; j < cage->n_vert; j++) sum += row[j];
    for (int32_t j = 0; j < cage->n_vert; j++) row[j] /= sum;
    polish(cage, p, size, row);
}

sn_status sn_cage_weights(const sn_tri_mesh *cage, const double *point, int32_t n_point, const sn_run *run,
                          double *weight, sn_error *err)
{
    const int32_t block = 512; /* points between two looks at the run */
    double size = sn_box3_diagonal(sn_tri_mesh_bounds(cage));
    for (int32_t i = 0; i < n_point; i++)
        if (!sn_v3_is_finite(sn_v3_load(point + 3 * (size_t)i)))
            return sn_fail(err, SN_EINVAL, "cage: point %d has a coordinate that is not finite", i + 1);
    for (int32_t first = 0; first < n_point; first += block) {
        int32_t n = n_point - first < block ? n_point - first : block;
        sn_status st = sn_run_step(run, "binding to the cage", (double)first / n_point, err);
        if (st) return st;
#pragma omp parallel for schedule(dynamic, 16) num_threads(sn_run_threads(run))
        for (int32_t k = 0; k < n; k++) {
            size_t i = (size_t)first + (size_t)k;
            weights_of(cage, sn_v3_load(point + 3 * i), size, weight + i * (size_t)cage->n_vert);
        }
    }
    return SN_OK;
}

void sn_cage_apply(const double *weight, int32_t n_point, const double *cage_pos, int32_t n_vert,
                   const sn_run *run, double *out)
{
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(run)) if (n_point >= 2000)
    for (int32_t i = 0; i < n_point; i++) {
        const double *row = weight + (size_t)i * (size_t)n_vert;
        sn_vec3 p = sn_v3(0, 0, 0);
        for (int32_t j = 0; j < n_vert; j++) p = sn_v3_mad(p, row[j], sn_v3_load(cage_pos + 3 * (size_t)j));
        sn_v3_store(out + 3 * (size_t)i, p);
    }
}
