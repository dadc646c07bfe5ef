/* test_fiber - fiber directions where they are known: cylinders, a bent tube, spindles, fans, several heads,
 * pennate blocks. */
#include "field/fiber.h"

#include "failing_memory.h"
#include "made_fibers.h"

static sn_fibers fibers_of(const sn_tet_mesh *body, const double *share, const sn_muscle *m)
{
    sn_fibers f = {.u = NULL};
    sn_error err = {.msg = ""};
    if (sn_fibers_build(&f, body, share, m, NULL, &err)) fail_msg("%s", err.msg);
    return f;
}

/* The whole mesh is muscle. */
static sn_fibers fibers_of_all(const sn_tet_mesh *body, const sn_muscle *m)
{
    double *share = full_shares(body);
    sn_fibers f = fibers_of(body, share, m);
    assert_int_equal(f.mesh.n_tet, body->n_tet);
    sn_release(share);
    return f;
}

static sn_fibers_check check_of(const sn_fibers *f)
{
    sn_fibers_check c;
    assert_int_equal(sn_fibers_check_run(f, &c, NULL), SN_OK);
    return c;
}

static void assert_no_faults(const sn_fibers *f)
{
    sn_fibers_check c = check_of(f);
    if (c.sinks || c.sources || c.flipped || c.still)
        fail_msg("%d sinks, %d sources, %d flipped, %d still", c.sinks, c.sources, c.flipped, c.still);
}

/* How far fibers are from what they should be, in tets with a share of at least `least`. */
typedef struct deviation {
    double worst, mean;
    sn_vec3 at;
} deviation;

static deviation deviation_from(const sn_fibers *f, const sn_tet_mesh *body, const double *share,
                                double least, sn_vec3 (*want)(sn_vec3 p))
{
    deviation d = {.worst = -1.0};
    int n = 0;
    for (int32_t t = 0; t < body->n_tet; t++) {
        if (share && share[t] < least) continue;
        sn_vec3 p = sn_tet_mesh_centre(body, t), way = sn_fibers_at(f, t, p, NULL);
        assert_true(fabs(sn_v3_len(way) - 1.0) < 1e-12);
        double off = angle_deg(way, want(p));
        d.mean += off;
        n++;
        if (off > d.worst) {
            d.worst = off;
            d.at = p;
        }
    }
    assert_true(n > 0);
    d.mean /= n;
    return d;
}

static void assert_below(deviation d, double worst, double mean)
{
    if (!(d.worst < worst) || !(d.mean < mean))
        fail_msg("worst %g degrees at {%g, %g, %g}, mean %g", d.worst, d.at.x, d.at.y, d.at.z, d.mean);
}

/* ---- a straight cylinder of radius 0.3 and length 2, along z ---- */

static const double straight[] = {0, 0, 0, 0, 0, 1, 0, 0, 2};

static sn_vec3 in_cylinder(double x, double y, double s)
{
    return sn_v3(0.3 * x, 0.3 * y, 2.0 * s);
}

/* Of a prism on 24 sides around that circle, from z = 0 to 2 (the origin shifted to be within). */
static double *cylinder_shares(sn_tet_mesh *body)
{
    enum { n_side = 24 };
    sn_vec3 plane[n_side + 2] = {{0, 0, 1}, {0, 0, -1}};
    for (int k = 0; k < n_side; k++) {
        double a = 2.0 * TEST_PI * k / n_side;
        plane[2 + k] = sn_v3(cos(a) / 0.3, sin(a) / 0.3, 0);
    }
    for (int32_t v = 0; v < body->n_vert; v++) body->pos[3 * v + 2] -= 1.0;
    double *share = convex_shares(body, plane, n_side + 2), volume = 0.0;
    for (int32_t v = 0; v < body->n_vert; v++) body->pos[3 * v + 2] += 1.0;
    for (int32_t t = 0; t < body->n_tet; t++) volume += share[t] * sn_tet_mesh_tet_volume(body, t);
    assert_true(fabs(volume - 2.0 * 0.09 * n_side * tan(TEST_PI / n_side)) < 1e-9);
    return share;
}

static sn_vec3 upwards(sn_vec3 p)
{
    (void)p;
    return sn_v3(0, 0, 1);
}

static void a_cylinder_that_conforms(void **state)
{
    (void)state;
    sn_tet_mesh body = made_tube(&(tube){4, 16, 24, in_cylinder});
    sn_muscle m = curve_muscle(straight, 3);
    sn_fibers f = fibers_of_all(&body, &m);
    assert_below(deviation_from(&f, &body, NULL, 0.0, upwards), 1e-5, 1e-6);
    for (int32_t t = 0; t < body.n_tet; t++) {
        double u;
        sn_vec3 p = sn_tet_mesh_centre(&body, t);
        (void)sn_fibers_at(&f, t, p, &u);
        assert_true(fabs(u - 0.5 * p.z) < 1e-7); /* linear, from 0 to 1 */
        assert_true(sn_v3_dist(sn_fibers_line_of_action(&f, p), sn_v3(0, 0, 1)) < 1e-12);
    }
    assert_no_faults(&f);
    assert_true(check_of(&f).worst_turn_deg < 1e-4);
    sn_fibers_free(&f);
    assert_null(f.u);
    sn_fibers_free(&f);
    sn_muscle_free(&m);
    sn_tet_mesh_free(&body);
}

/* A box [-0.5, 0.5]^2 x [-0.2, 2.2] of tets that know nothing of the cylinder in it. */
static sn_tet_mesh shaken_box(int n)
{
    sn_tet_mesh m = made_lattice(n, sn_v3(0, 0, 0), 1.0 / n);
    shake_mesh(&m, 0.1 / n);
    for (int32_t v = 0; v < m.n_vert; v++) {
        sn_vec3 p = sn_tet_mesh_point(&m, v);
        sn_v3_store(m.pos + 3 * v, sn_v3(p.x - 0.5, p.y - 0.5, 2.4 * p.z - 0.2));
    }
    assert_int_equal(sn_tet_mesh_validate(&m, NULL), SN_OK);
    return m;
}

static void a_cylinder_within_other_tets(void **state)
{
    (void)state;
    sn_tet_mesh body = shaken_box(14);
    double *share = cylinder_shares(&body);
    sn_muscle m = curve_muscle(straight, 3);
    sn_fibers f = fibers_of(&body, share, &m);
    for (int32_t t = 0; t < body.n_tet; t++) assert_true((f.tet_of[t] >= 0) == (share[t] > 0.0));
    assert_below(deviation_from(&f, &body, share, 0.5, upwards), 1.0, 0.1);
    assert_below(deviation_from(&f, &body, share, 1e-9, upwards), 5.0, 0.2); /* slivers, too */
    sn_fibers_check c = check_of(&f);
    assert_int_equal(c.sinks + c.sources + c.flipped, 0);
    sn_fibers_free(&f);
    sn_muscle_free(&m);
    sn_release(share);
    sn_tet_mesh_free(&body);
}

/* ---- a quarter of a torus of radii 1.2 and 0.3, about the y axis at x = 1.2 ---- */

static sn_vec3 in_bend(double x, double y, double s)
{
    double r = 1.2 - 0.3 * x, a = 0.5 * TEST_PI * s;
    return sn_v3(1.2 - r * cos(a), 0.3 * y, r * sin(a));
}

static sn_vec3 around_bend(sn_vec3 p)
{
    return sn_v3_unit(sn_v3(p.z, 0, 1.2 - p.x));
}

static bool is_in_bend(sn_vec3 p)
{
    return hypot(hypot(1.2 - p.x, p.z) - 1.2, p.y) <= 0.3 && p.z >= 0.0 && p.x <= 1.2;
}

static sn_muscle bent_muscle(void)
{
    double point[3 * 65]; /* many: a spline's ends are not quite the circle */
    for (int k = 0; k < 65; k++) sn_v3_store(point + 3 * k, in_bend(0, 0, k / 64.0));
    return curve_muscle(point, 65);
}

static void a_bent_tube_that_conforms(void **state)
{
    (void)state;
    sn_tet_mesh body = made_tube(&(tube){4, 16, 32, in_bend});
    sn_muscle m = bent_muscle();
    sn_fibers f = fibers_of_all(&body, &m);
    assert_below(deviation_from(&f, &body, NULL, 0.0, around_bend), 5.0, 1.0);
    for (int32_t v = 0; v < f.mesh.n_vert; v++) { /* u is the angle */
        sn_vec3 p = sn_tet_mesh_point(&f.mesh, v);
        assert_true(fabs(f.u[v] - atan2(p.z, 1.2 - p.x) / (0.5 * TEST_PI)) < 0.01);
    }
    assert_no_faults(&f);
    sn_fibers_free(&f);
    sn_muscle_free(&m);
    sn_tet_mesh_free(&body);
}

static void a_bent_tube_within_other_tets(void **state)
{
    (void)state;
    sn_tet_mesh body = made_lattice(20, sn_v3(-0.4, -0.85, -0.1), 1.7 / 20);
    shake_mesh(&body, 0.008);
    double *share = sampled_shares(&body, is_in_bend);
    sn_muscle m = bent_muscle();
    sn_fibers f = fibers_of(&body, share, &m);
    assert_below(deviation_from(&f, &body, share, 0.5, around_bend), 5.0, 1.0);
    sn_fibers_check c = check_of(&f);
    assert_int_equal(c.sinks + c.sources + c.flipped, 0);
    sn_fibers_free(&f);
    sn_muscle_free(&m);
    sn_release(share);
    sn_tet_mesh_free(&body);
}

static void straps_follow_the_curve_exactly(void **state)
{
    (void)state;
    sn_tet_mesh body = made_tube(&(tube){4, 16, 32, in_bend});
    sn_muscle m = bent_muscle();
    make_pennate(&m, &(sn_pennation){.kind = SN_PARALLEL});
    sn_fibers f = fibers_of_all(&body, &m);
    assert_null(f.u);
    assert_below(deviation_from(&f, &body, NULL, 0.0, around_bend), 0.6, 0.1);
    for (int32_t t = 0; t < body.n_tet; t++) {
        double u;
        sn_vec3 p = sn_tet_mesh_centre(&body, t);
        (void)sn_fibers_at(&f, t, p, &u);
        assert_true(fabs(u - atan2(p.z, 1.2 - p.x) / (0.5 * TEST_PI)) < 0.003);
    }
    assert_no_faults(&f);
    sn_fibers_free(&f);
    sn_muscle_free(&m);
    sn_tet_mesh_free(&body);
}

/* ---- a spindle: radius 0.12 at the ends, 0.4 in the middle ---- */

static double spindle_radius(double s)
{
    return 0.12 + 0.28 * sin(TEST_PI * s);
}

static sn_vec3 in_spindle(double x, double y, double s)
{
    return sn_v3(spindle_radius(s) * x, spindle_radius(s) * y, 2.0 * s);
}

/* The largest angle between fibers and the tube's side, u within [from, to]. */
static double off_surface(const sn_fibers *f, const sn_tet_mesh *body, double from, double to)
{
    int32_t *adj = NULL;
    double worst = 0.0;
    assert_int_equal(sn_tet_mesh_adjacency(body, &adj, NULL), SN_OK);
    for (int32_t h = 0; h < 4 * body->n_tet; h++) {
        if (adj[h] >= 0) continue;
        sn_vec3 c[3], p = {0};
        for (int k = 0; k < 3; k++) {
            c[k] = sn_tet_mesh_point(body, body->tet[(h & ~3) + sn_tet_face[h & 3][k]]);
            p = sn_v3_mad(p, 1.0 / 3.0, c[k]);
        }
        if (p.z < 2.0 * from || p.z > 2.0 * to) continue;
        sn_vec3 n = sn_v3_unit(sn_v3_cross(sn_v3_sub(c[1], c[0]), sn_v3_sub(c[2], c[0])));
        worst = fmax(worst, fabs(90.0 - angle_deg(n, sn_fibers_at(f, h / 4, p, NULL))));
    }
    sn_release(adj);
    return worst;
}

static void a_spindle(void **state)
{
    (void)state;
    sn_tet_mesh body = made_tube(&(tube){6, 20, 40, in_spindle});
    sn_muscle m = curve_muscle(straight, 3);
    sn_fibers f = fibers_of_all(&body, &m);
    double middle = off_surface(&f, &body, 0.08, 0.92), ends = off_surface(&f, &body, 0.001, 0.999);
    if (!(middle < 10.0)) fail_msg("fibers leave the surface at %g degrees", middle);
    assert_true(ends < 24.0); /* there they run along the curve: the surface leans by 23.7 degrees */
    assert_no_faults(&f);
    sn_fibers_free(&f);
    sn_muscle_free(&m);
    sn_tet_mesh_free(&body);
}

/* ---- several heads ---- */

static const double left[] = {-0.6, 0, 0, -0.3, 0, 0.6, 0, 0, 1.1, 0, 0, 2};
static const double right[] = {0.6, 0, 0, 0.3, 0, 0.6, 0, 0, 1.1, 0, 0, 2};

static double off_segment(sn_vec3 p, sn_vec3 a, sn_vec3 b)
{
    double t = sn_v3_dot(sn_v3_sub(p, a), sn_v3_sub(b, a)) / sn_v3_len2(sn_v3_sub(b, a));
    return sn_v3_dist(p, sn_v3_lerp(a, b, fmin(fmax(t, 0.0), 1.0)));
}

static bool is_in_y(sn_vec3 p)
{
    sn_vec3 q = sn_v3(fabs(p.x), p.y, p.z), fork = sn_v3(0, 0, 1.1);
    return p.z >= 0.0 && p.z <= 2.0 &&
           fmin(off_segment(q, sn_v3(0.6, 0, 0), fork), off_segment(q, fork, sn_v3(0, 0, 2))) <= 0.2;
}

static void two_heads_with_one_insertion(void **state)
{
    (void)state;
    sn_tet_mesh body = made_lattice(22, sn_v3(-1.1, -1.1, -0.1), 0.1);
    shake_mesh(&body, 0.008);
    double *share = sampled_shares(&body, is_in_y);
    sn_muscle m = heads_muscle((const sn_head_points[]){{left, NULL, 4}, {right, NULL, 4}}, 2);
    sn_fibers f = fibers_of(&body, share, &m);
    int low = 0, high = 0;
    for (int32_t t = 0; t < body.n_tet; t++) {
        if (share[t] < 0.5) continue;
        double u;
        sn_vec3 p = sn_tet_mesh_centre(&body, t), way = sn_fibers_at(&f, t, p, &u);
        assert_true(u > -0.1 && u < 1.1);
        assert_true(way.z > 0.3);            /* on and on, from either origin */
        if (p.z < 0.6 && fabs(p.x) > 0.25) { /* in a head: towards the other one, as its curve runs */
            assert_true(way.x * p.x < 0.0);
            assert_true(angle_deg(way, sn_fibers_line_of_action(&f, p)) < 25.0);
        }
        if (p.z < 0.15) {
            assert_true(u < 0.2);
            low += p.x < 0.0 ? 1 : 1000;
        }
        if (p.z > 1.85) {
            assert_true(u > 0.8);
            high++;
        }
    }
    assert_true(low % 1000 > 5 && low / 1000 > 5 && high > 5);
    sn_fibers_check c = check_of(&f);
    if (c.sinks + c.sources + c.flipped)
        fail_msg("%d sinks, %d sources, %d flipped", c.sinks, c.sources, c.flipped);
    sn_fibers_free(&f);
    sn_muscle_free(&m);
    sn_release(share);
    sn_tet_mesh_free(&body);
}

static void messages(void **state)
{
    (void)state;
    sn_tet_mesh body = made_lattice(2, sn_v3(0, 0, 0), 0.5);
    double *share = full_shares(&body);
    sn_fibers f = {.u = NULL};
    sn_error err = {.msg = ""};
    const double a[] = {0, 0, 0, 0, 0, 1}, b[] = {1, 0, 0, 1, 1, 1};
    sn_muscle apart = heads_muscle((const sn_head_points[]){{a, NULL, 2}, {b, NULL, 2}}, 2);
    assert_int_equal(sn_fibers_build(&f, &body, share, &apart, NULL, &err), SN_EINVAL);
    assert_string_equal(err.msg, "fibers of muscle 'psoas': its 2 heads share neither an insertion (last "
                                 "point) nor an origin (first point)");
    sn_muscle one = curve_muscle(a, 2);
    memset(share, 0, (size_t)body.n_tet * sizeof *share);
    assert_int_equal(sn_fibers_build(&f, &body, share, &one, NULL, &err), SN_EINVAL);
    assert_string_equal(err.msg, "fibers of muscle 'psoas': it is empty");
    volatile sig_atomic_t stop = 1;
    share[0] = 1.0;
    assert_int_equal(sn_fibers_build(&f, &body, share, &one, &(sn_run){.cancel = &stop}, &err), SN_ECANCEL);
    assert_string_equal(err.msg, "interrupted while finding fibers");
    assert_null(f.u);
    assert_null(f.tet_of);
    sn_muscle_free(&apart);
    sn_muscle_free(&one);
    sn_release(share);
    sn_tet_mesh_free(&body);
}

/* A muscle of a single tet has fibers as well. */
static void a_single_tet(void **state)
{
    (void)state;
    sn_tet_mesh body = made_lattice(2, sn_v3(0, 0, 0), 0.5);
    double *share = full_shares(&body);
    const double a[] = {0.25, 0.25, 0, 0.25, 0.25, 1};
    sn_muscle m = curve_muscle(a, 2);
    memset(share, 0, (size_t)body.n_tet * sizeof *share);
    share[3] = 1e-9;
    sn_fibers f = fibers_of(&body, share, &m);
    assert_int_equal(f.mesh.n_tet, 1);
    assert_int_equal(f.mesh.n_vert, 4);
    assert_true(angle_deg(sn_fibers_at(&f, 3, sn_tet_mesh_centre(&body, 3), NULL), sn_v3(0, 0, 1)) < 1.0);
    sn_fibers_free(&f);
    sn_muscle_free(&m);
    sn_release(share);
    sn_tet_mesh_free(&body);
}

/* ---- fans: 0.2 thick, from z = 0 to the insertion (0, 0, 1), narrowing from half width `wide` to `narrow`
 * ---- */

static double *fan_shares(sn_tet_mesh *body, double wide, double narrow)
{
    double slope = wide - narrow, middle = 0.5 * (wide + narrow); /* x + slope (z - 0.5) <= middle */
    const sn_vec3 plane[] = {{0, 0, 2},
                             {0, 0, -2},
                             {0, 10, 0},
                             {0, -10, 0},
                             {1.0 / middle, 0, slope / middle},
                             {-1.0 / middle, 0, slope / middle}};
    for (int32_t v = 0; v < body->n_vert; v++) body->pos[3 * v + 2] -= 0.5;
    double *share = convex_shares(body, plane, 6);
    for (int32_t v = 0; v < body->n_vert; v++) body->pos[3 * v + 2] += 0.5;
    return share;
}

typedef struct aim {
    double worst, mean; /* angle to the insertion, degrees, away from both ends */
} aim;

static aim aim_of(const sn_fibers *f, const sn_tet_mesh *body, const double *share)
{
    aim a = {0.0, 0.0};
    int n = 0;
    for (int32_t t = 0; t < body->n_tet; t++) {
        sn_vec3 p = sn_tet_mesh_centre(body, t), to_end = sn_v3_sub(sn_v3(0, 0, 1), p);
        if (share[t] < 0.5 || p.z < 0.3 || sn_v3_len(to_end) < 0.25) continue;
        double off = angle_deg(sn_fibers_at(f, t, p, NULL), to_end);
        a.worst = fmax(a.worst, off);
        a.mean += off;
        n++;
    }
    a.mean /= n;
    return a;
}

/* In a strap as wide as it is long fibers of a fusiform muscle run on to the far edge, those of a convergent
 * one to the insertion; in a fan the shape itself draws them together. */
static void convergent(void **state)
{
    (void)state;
    sn_tet_mesh body = made_lattice(20, sn_v3(-0.65, -0.65, -0.15), 0.065);
    shake_mesh(&body, 0.005);
    const double point[] = {0, 0, 0, 0, 0, 1};
    for (int is_fan = 0; is_fan < 2; is_fan++) {
        double *share = fan_shares(&body, 0.5, is_fan ? 0.08 : 0.5);
        sn_muscle m = curve_muscle(point, 2);
        sn_fibers plain = fibers_of(&body, share, &m);
        make_pennate(&m, &(sn_pennation){.kind = SN_CONVERGENT});
        sn_fibers f = fibers_of(&body, share, &m);
        aim a = aim_of(&f, &body, share), b = aim_of(&plain, &body, share);
        if (!(a.worst < (is_fan ? 35.0 : 65.0)) || !(a.mean < (is_fan ? 10.0 : 27.0)))
            fail_msg("fibers pass the insertion at up to %g degrees, %g in the mean", a.worst, a.mean);
        if (!is_fan) assert_true(a.mean < 0.7 * b.mean && a.worst < 0.7 * b.worst);
        for (int32_t t = 0; t < body.n_tet; t++) {
            double u;
            sn_vec3 p = sn_tet_mesh_centre(&body, t);
            if (share[t] < 0.5) continue;
            sn_vec3 way = sn_fibers_at(&f, t, p, &u);
            if (!is_fan && p.z > 0.9 && fabs(fabs(p.x) - 0.3) < 0.1)
                assert_true(way.x * p.x < -0.5 * fabs(p.x));
            if (p.z < 0.1) assert_true(u < 0.15);
            if (sn_v3_dist(p, sn_v3(0, 0, 1)) < 0.08) assert_true(u > 0.8);
        }
        sn_fibers_check c = check_of(&f);
        if (c.sinks + c.sources + c.flipped)
            fail_msg("%d sinks, %d sources, %d flipped", c.sinks, c.sources, c.flipped);
        sn_fibers_free(&f);
        sn_fibers_free(&plain);
        sn_muscle_free(&m);
        sn_release(share);
    }
    sn_tet_mesh_free(&body);
}

/* ---- a piece apart ---- */

/* Three pieces: none reaches from end to end, and the middle one has neither. */
static void a_piece_without_an_end(void **state)
{
    (void)state;
    sn_tet_mesh body = shaken_box(14);
    double *share = cylinder_shares(&body);
    for (int32_t t = 0; t < body.n_tet; t++) {
        double z = sn_tet_mesh_centre(&body, t).z;
        if ((z > 0.4 && z < 0.8) || (z > 1.2 && z < 1.6)) share[t] = 0.0;
    }
    sn_muscle m = curve_muscle(straight, 3);
    sn_fibers f = fibers_of(&body, share, &m);
    assert_below(deviation_from(&f, &body, share, 0.0001, upwards), 1e-4, 1e-5);
    for (int32_t v = 0; v < f.mesh.n_vert; v++) {
        assert_false(f.is_free[v]);
        assert_true(fabs(f.u[v] - 0.5 * f.mesh.pos[3 * v + 2]) < 1e-9);
    }
    assert_no_faults(&f);
    sn_fibers_free(&f);
    sn_muscle_free(&m);
    sn_release(share);
    sn_tet_mesh_free(&body);
}

/* ---- pennate muscles: a block [0, 2] x [-0.25, 0.25] x [-0.2, 0.2], the curve along x in its middle. The
 * frame: e1 = x, e2 = y (what the curve runs along least, and the first of y and z), e3 = z. ---- */

static const double along_x[] = {0, 0, 0, 2, 0, 0};

static sn_tet_mesh made_block(int n)
{
    sn_tet_mesh m = made_lattice(n, sn_v3(0, 0, 0), 1.0 / n);
    for (int32_t v = 0; v < m.n_vert; v++) {
        sn_vec3 p = sn_tet_mesh_point(&m, v);
        sn_v3_store(m.pos + 3 * v, sn_v3(2.0 * p.x, 0.5 * p.y - 0.25, 0.4 * p.z - 0.2));
    }
    return m;
}

/* The fibers of the block for one kind. */
static sn_fibers pennate_fibers(const sn_tet_mesh *block, const sn_pennation *p)
{
    sn_muscle m = curve_muscle(along_x, 2);
    make_pennate(&m, p);
    sn_fibers f = fibers_of_all(block, &m);
    sn_muscle_free(&m);
    return f;
}

static void unipennate(void **state)
{
    (void)state;
    sn_tet_mesh block = made_block(6);
    sn_fibers f =
        pennate_fibers(&block, &(sn_pennation){.kind = SN_UNIPENNATE, .angle_deg = {20.0}, .n_angle = 1});
    for (int32_t t = 0; t < block.n_tet; t++) {
        double u;
        sn_vec3 p = sn_tet_mesh_centre(&block, t), way = sn_fibers_at(&f, t, p, &u);
        assert_true(fabs(angle_deg(way, sn_fibers_line_of_action(&f, p)) - 20.0) < 1e-6);
        assert_true(sn_v3_dist(way, sn_v3(cos_deg(20.0), 0, sin_deg(20.0))) < 1e-12);
        assert_true(fabs(u - 0.5 * p.x) < 1e-9);
    }
    assert_no_faults(&f);
    sn_fibers_free(&f);
    sn_tet_mesh_free(&block);
}

/* On a curve that bends: at 20 degrees to the circle, in the plane of tangent and e3. */
static void unipennate_along_a_bend(void **state)
{
    (void)state;
    sn_tet_mesh body = made_tube(&(tube){3, 12, 16, in_bend});
    sn_muscle m = bent_muscle();
    make_pennate(&m, &(sn_pennation){.kind = SN_UNIPENNATE, .angle_deg = {20.0}, .n_angle = 1});
    sn_fibers f = fibers_of_all(&body, &m);
    for (int32_t t = 0; t < body.n_tet; t++) {
        sn_vec3 p = sn_tet_mesh_centre(&body, t), way = sn_fibers_at(&f, t, p, NULL);
        sn_curve_place at = sn_paths_place(&f.paths, p);
        sn_triad frame = sn_path_frame(&f.paths.head[0], at.arc);
        assert_true(fabs(angle_deg(way, sn_fibers_line_of_action(&f, p)) - 20.0) < 1e-6);
        assert_true(fabs(sn_v3_dot(way, frame.e2)) < 1e-12);
        assert_true(sn_v3_dot(way, frame.e3) > 0.0);
    }
    sn_fibers_free(&f);
    sn_muscle_free(&m);
    sn_tet_mesh_free(&body);
}

static void bipennate(void **state)
{
    (void)state;
    sn_tet_mesh block = made_block(6);
    sn_fibers f =
        pennate_fibers(&block, &(sn_pennation){.kind = SN_BIPENNATE, .angle_deg = {30.0}, .n_angle = 1});
    for (int32_t t = 0; t < block.n_tet; t++) {
        sn_vec3 p = sn_tet_mesh_centre(&block, t), way = sn_fibers_at(&f, t, p, NULL);
        double side = p.z > 0.0 ? -1.0 : 1.0; /* towards the sheet z = 0 */
        assert_true(sn_v3_dist(way, sn_v3(cos_deg(30.0), 0, side * sin_deg(30.0))) < 1e-12);
        assert_int_equal(sn_fibers_room(&f, p), p.z > 0.0);
    }
    sn_fibers_free(&f);
    sn_tet_mesh_free(&block);
}

/* Three sheets at 1/6, 3/6 and 5/6 of the thickness: fibers run to each from both of its sides. */
static void multipennate(void **state)
{
    (void)state;
    sn_tet_mesh block = made_block(24);
    sn_fibers f = pennate_fibers(
        &block, &(sn_pennation){.kind = SN_MULTIPENNATE, .angle_deg = {25.0}, .n_angle = 1, .n_sheet = 3});
    assert_true(fabs(f.sheet_min + 0.2) < 0.4 / 24 && fabs(f.sheet_max - 0.2) < 0.4 / 24);
    int changes = 0;
    double last = 0.0;
    for (int k = 0; k < 1000; k++) {
        sn_vec3 way = sn_fibers_at(&f, 0, sn_v3(1.0, 0.0, -0.2 + 0.4 * (k + 0.5) / 1000), NULL);
        assert_true(fabs(angle_deg(way, sn_v3(1, 0, 0)) - 25.0) < 1e-6 && fabs(way.y) < 1e-12);
        changes += way.z * last < 0.0;
        if (k == 0) assert_true(way.z > 0.0);
        if (k == 999) assert_true(way.z < 0.0);
        last = way.z;
    }
    assert_int_equal(changes, 5);
    for (int k = 0; k < 3; k++) { /* just below and above each sheet */
        double z = -0.2 + 0.4 * (2 * k + 1) / 6;
        assert_int_equal(sn_fibers_room(&f, sn_v3(1, 0, z - 0.02)), 2 * k);
        assert_int_equal(sn_fibers_room(&f, sn_v3(1, 0, z + 0.02)), 2 * k + 1);
        assert_true(sn_fibers_at(&f, 0, sn_v3(1, 0, z - 0.01), NULL).z > 0.0);
        assert_true(sn_fibers_at(&f, 0, sn_v3(1, 0, z + 0.01), NULL).z < 0.0);
    }
    sn_fibers_free(&f);
    sn_tet_mesh_free(&block);
}

static void angles_that_vary(void **state)
{
    (void)state;
    sn_tet_mesh block = made_block(6);
    sn_fibers f = pennate_fibers(
        &block, &(sn_pennation){.kind = SN_UNIPENNATE, .angle_deg = {10.0, 40.0, 20.0}, .n_angle = 3});
    static const double want[][2] = {{0.0, 10}, {0.5, 25},  {1.0, 40}, {1.5, 30},
                                     {2.0, 20}, {-0.3, 10}, {2.4, 20}, {0.1, 13}}; /* x, degrees */
    for (size_t i = 0; i < sizeof want / sizeof *want; i++) {
        sn_vec3 way = sn_fibers_at(&f, 0, sn_v3(want[i][0], 0.1, 0.05), NULL);
        assert_true(fabs(angle_deg(way, sn_v3(1, 0, 0)) - want[i][1]) < 1e-6);
    }
    sn_fibers_free(&f);
    sn_tet_mesh_free(&block);
}

/* ---- whatever the circumstances ---- */

static void any_number_of_threads_gives_the_same_bits(void **state)
{
    (void)state;
    sn_tet_mesh body = shaken_box(10);
    double *share = cylinder_shares(&body);
    sn_muscle m = curve_muscle(straight, 3);
    sn_fibers one = {.u = NULL}, two = {.u = NULL};
    assert_int_equal(sn_fibers_build(&one, &body, share, &m, &(sn_run){.n_threads = 1}, NULL), SN_OK);
    assert_int_equal(sn_fibers_build(&two, &body, share, &m, &(sn_run){.n_threads = 2}, NULL), SN_OK);
    assert_memory_equal(one.u, two.u, (size_t)one.mesh.n_vert * sizeof *one.u);
    assert_memory_equal(one.along, two.along, (size_t)one.mesh.n_vert * sizeof *one.along);
    sn_fibers_free(&one);
    sn_fibers_free(&two);
    sn_muscle_free(&m);
    sn_release(share);
    sn_tet_mesh_free(&body);
}

/* Metres or millimetres: the same directions, the same u. The curve keeps off the edges of the tets, where
 * rounding says which tet it is in. */
static const double off_axis[] = {0.013, 0.007, 0, 0.011, 0.009, 2};

static void the_unit_does_not_matter(void **state)
{
    (void)state;
    sn_tet_mesh body = made_tube(&(tube){3, 12, 12, in_spindle});
    sn_muscle m = curve_muscle(off_axis, 2);
    sn_fibers f = fibers_of_all(&body, &m);
    double large[6];
    for (int k = 0; k < 6; k++) large[k] = 1000.0 * off_axis[k];
    for (int32_t k = 0; k < 3 * body.n_vert; k++) body.pos[k] *= 1000.0;
    sn_muscle n = curve_muscle(large, 2);
    sn_fibers g = fibers_of_all(&body, &n);
    for (int32_t v = 0; v < f.mesh.n_vert; v++) {
        assert_true(fabs(f.u[v] - g.u[v]) < 1e-9);
        if (!(sn_v3_dist(f.along[v], g.along[v]) < 1e-7))
            fail_msg("vertex %d turns by %g", v, sn_v3_dist(f.along[v], g.along[v]));
    }
    sn_fibers_free(&f);
    sn_fibers_free(&g);
    sn_muscle_free(&m);
    sn_muscle_free(&n);
    sn_tet_mesh_free(&body);
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    sn_tet_mesh body = made_tube(&(tube){2, 6, 4, in_cylinder});
    double *share = full_shares(&body);
    sn_muscle m = curve_muscle(straight, 3);
    int n = 0;
    for (;; n++) {
        failing mem = {.left = n};
        sn_fibers f = {.u = NULL};
        sn_fibers_check c;
        sn_error err = {.msg = ""};
        sn_set_allocator(&(sn_allocator){failing_realloc, &mem});
        sn_status st = sn_fibers_build(&f, &body, share, &m, &(sn_run){.n_threads = 1}, &err);
        if (!st) st = sn_fibers_check_run(&f, &c, &err);
        sn_fibers_free(&f);
        sn_set_allocator(NULL);
        assert_int_equal(mem.n_alive, 0);
        if (!st) break;
        if (st != SN_ENOMEM) fail_msg("allocation %d: status %d, '%s'", n, st, err.msg);
        assert_true(err.msg[0] != '\0');
    }
    assert_true(n > 20);
    sn_muscle_free(&m);
    sn_release(share);
    sn_tet_mesh_free(&body);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cylinder_that_conforms),
        cmocka_unit_test(a_cylinder_within_other_tets),
        cmocka_unit_test(a_bent_tube_that_conforms),
        cmocka_unit_test(a_bent_tube_within_other_tets),
        cmocka_unit_test(straps_follow_the_curve_exactly),
        cmocka_unit_test(a_spindle),
        cmocka_unit_test(two_heads_with_one_insertion),
        cmocka_unit_test(messages),
        cmocka_unit_test(a_single_tet),
        cmocka_unit_test(convergent),
        cmocka_unit_test(a_piece_without_an_end),
        cmocka_unit_test(unipennate),
        cmocka_unit_test(unipennate_along_a_bend),
        cmocka_unit_test(bipennate),
        cmocka_unit_test(multipennate),
        cmocka_unit_test(angles_that_vary),
        cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
        cmocka_unit_test(the_unit_does_not_matter),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
