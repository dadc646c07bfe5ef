/* made_fibers.h - tubes of tets whose fibers are known, muscles to lead them, and parts of a lattice. Brings
 * cmocka and its headers. */
#ifndef SN_TESTS_MADE_FIBERS_H
#define SN_TESTS_MADE_FIBERS_H

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "field/measure.h"
#include "muscle/muscle.h"

#include "made_mesh.h"

/* ---- angles ---- */

static inline double angle_deg(sn_vec3 a, sn_vec3 b)
{
    return atan2(sn_v3_len(sn_v3_cross(a, b)), sn_v3_dot(a, b)) * (180.0 / TEST_PI);
}

static inline double sin_deg(double deg)
{
    return sin(deg * (TEST_PI / 180.0));
}

static inline double cos_deg(double deg)
{
    return cos(deg * (TEST_PI / 180.0));
}

/* ---- tubes: discs of n_ring rings of n_around sectors, n_layer prisms between them, three tets each ---- */

typedef struct tube {
    int n_ring, n_around, n_layer;
    sn_vec3 (*place)(double x, double y, double s); /* of the unit disc, and 0..1 along */
} tube;

static inline int disc_size(const tube *t)
{
    return 1 + t->n_ring * t->n_around;
}

/* Tets between the triangle a < b < c of a disc and the next disc: diagonals go up to the higher number, so
 * neighbours agree. */
static inline int32_t *add_prism(int32_t *out, const sn_tet_mesh *m, int32_t a, int32_t b, int32_t c, int up)
{
    int32_t v[3] = {a, b, c};
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2; k++)
            if (v[k] > v[k + 1]) {
                int32_t swap = v[k];
                v[k] = v[k + 1];
                v[k + 1] = swap;
            }
    const int32_t tet[3][4] = {{v[0], v[1], v[2], v[2] + up},
                               {v[0], v[1], v[1] + up, v[2] + up},
                               {v[0], v[0] + up, v[1] + up, v[2] + up}};
    for (int i = 0; i < 3; i++, out += 4) {
        sn_vec3 p = sn_tet_mesh_point(m, tet[i][0]);
        sn_vec3 e[3];
        for (int k = 0; k < 3; k++) e[k] = sn_v3_sub(sn_tet_mesh_point(m, tet[i][k + 1]), p);
        bool turned = sn_v3_det(e[0], e[1], e[2]) < 0.0;
        out[0] = tet[i][0];
        out[1] = tet[i][1];
        out[2] = tet[i][turned ? 3 : 2];
        out[3] = tet[i][turned ? 2 : 3];
    }
    return out;
}

static inline void place_tube(const tube *t, sn_tet_mesh *m)
{
    for (int l = 0, v = 0; l <= t->n_layer; l++)
        for (int k = 0; k < disc_size(t); k++, v++) {
            double r = k ? (double)((k - 1) / t->n_around + 1) / t->n_ring : 0.0;
            double a = 2.0 * TEST_PI * (k ? (k - 1) % t->n_around : 0) / t->n_around;
            sn_v3_store(m->pos + 3 * v, t->place(r * cos(a), r * sin(a), (double)l / t->n_layer));
        }
}

static inline sn_tet_mesh made_tube(const tube *t)
{
    int up = disc_size(t), n_triangle = (2 * t->n_ring - 1) * t->n_around;
    sn_tet_mesh m;
    sn_tet_mesh_init(&m);
    assert_int_equal(sn_tet_mesh_reserve(&m, up * (t->n_layer + 1), 3 * n_triangle * t->n_layer, false, NULL),
                     SN_OK);
    place_tube(t, &m);
    int32_t *out = m.tet;
    for (int l = 0; l < t->n_layer; l++)
        for (int r = 0; r < t->n_ring; r++)
            for (int k = 0; k < t->n_around; k++) {
                int next = (k + 1) % t->n_around, base = l * up, inner = base + 1 + (r - 1) * t->n_around;
                int outer = base + 1 + r * t->n_around;
                out = add_prism(out, &m, r ? inner + k : base, outer + k, outer + next, up);
                if (r) out = add_prism(out, &m, inner + k, inner + next, outer + next, up);
            }
    assert_int_equal(sn_tet_mesh_validate(&m, NULL), SN_OK);
    return m;
}

/* The area of the polygon that stands for the disc, relative to the square of its radius. */
static inline double disc_area(const tube *t)
{
    return 0.5 * t->n_around * sin(2.0 * TEST_PI / t->n_around);
}

/* ---- shares ---- */

static inline double *full_shares(const sn_tet_mesh *m)
{
    double *share = SN_NEW(double, m->n_tet);
    assert_non_null(share);
    for (int32_t t = 0; t < m->n_tet; t++) share[t] = 1.0;
    return share;
}

/* The part of each tet where n . p <= 1 for all n: exact, by linear functions that the measure clips at. */
static inline double *convex_shares(const sn_tet_mesh *m, const sn_vec3 *n, int32_t n_plane)
{
    double *field = SN_NEW_ZERO(double, (size_t)(1 + n_plane) * (size_t)m->n_vert);
    double *share = SN_NEW(double, m->n_tet);
    sn_measure *measure = NULL;
    assert_true(field && share);
    for (int32_t i = 0; i < n_plane; i++)
        for (int32_t v = 0; v < m->n_vert; v++)
            field[(size_t)(1 + i) * (size_t)m->n_vert + (size_t)v] =
                sn_v3_dot(n[i], sn_tet_mesh_point(m, v)) - 1.0;
    assert_int_equal(sn_measure_create(&measure, m, field, 1 + n_plane, 0, NULL, NULL), SN_OK);
    for (int32_t t = 0; t < m->n_tet; t++) share[t] = sn_measure_tet_share(measure, t, 1.0);
    sn_measure_destroy(measure);
    sn_release(field);
    return share;
}

/* The part of each tet where is_in holds, by points spread evenly. */
static inline double *sampled_shares(const sn_tet_mesh *m, bool (*is_in)(sn_vec3 p))
{
    enum { n = 12 };
    double *share = SN_NEW_ZERO(double, m->n_tet);
    assert_non_null(share);
    for (int32_t t = 0; t < m->n_tet; t++) {
        int in = 0, all = 0;
        for (int i = 0; i < n; i++)
            for (int j = 0; i + j < n; j++)
                for (int k = 0; i + j + k < n; k++, all++) {
                    const double bary[4] = {(i + 0.25) / n, (j + 0.25) / n, (k + 0.25) / n,
                                            (n - i - j - k - 0.75) / n};
                    sn_vec3 p = {0};
                    for (int c = 0; c < 4; c++)
                        p = sn_v3_mad(p, bary[c], sn_tet_mesh_point(m, m->tet[4 * t + c]));
                    in += is_in(p);
                }
        share[t] = (double)in / all;
    }
    return share;
}

/* ---- muscles ---- */

static inline sn_muscle heads_muscle(const sn_head_points *head, int32_t n)
{
    sn_muscle m;
    sn_error err = {.msg = ""};
    memset(&m, 0, sizeof m);
    if (sn_muscle_init(&m, "psoas", head, n, &err)) fail_msg("%s", err.msg);
    return m;
}

static inline sn_muscle curve_muscle(const double *point, int32_t n)
{
    return heads_muscle(&(sn_head_points){point, NULL, n}, 1);
}

static inline void make_pennate(sn_muscle *m, const sn_pennation *p)
{
    sn_error err = {.msg = ""};
    if (sn_muscle_set_pennation(m, p, &err)) fail_msg("%s", err.msg);
}

#endif
