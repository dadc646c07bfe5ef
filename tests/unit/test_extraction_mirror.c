#define _DEFAULT_SOURCE /* mkdtemp */
/* Half models joined with their images: tets, names, muscles, fibers, files. */
#include "temp_folder.h"

#include "extract/extraction_mirror.h"
#include "extract/part_fibers.h"
#include "mesh/mesh_check.h"
#include "mesh/surface_io.h"
#include "muscle/muscle_mirror.h"

#include "failing_memory.h"
#include "made_fibers.h"

enum { fat, biceps, belly, arm_l, arm_r, n_half, biceps_r = n_half, n_whole };
static const char *const half_name[n_half] = {"fat", "biceps_l", "belly", "arm_l", "arm_r"};

/* ---- a half model: a block on one side of a plane, moved and turned as a whole ---- */

typedef struct frame { /* where the block's x, y, z axes point; its plane is y = 0 */
    sn_vec3 o, x, y, z;
} frame;
static const frame upright = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                   below = {{0, 0.125, 0}, {1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
                   slanted = {{3, -2, 1},
                              {2.0 / 3, 2.0 / 3, 1.0 / 3},
                              {-2.0 / 3, 1.0 / 3, 2.0 / 3},
                              {1.0 / 3, -2.0 / 3, 2.0 / 3}};

static sn_vec3 turned(const frame *f, sn_vec3 p)
{
    return sn_v3_mad(sn_v3_mad(sn_v3_scale(p.x, f->x), p.y, f->y), p.z, f->z);
}
static sn_vec3 placed(const frame *f, sn_vec3 p)
{
    return sn_v3_add(f->o, turned(f, p));
}

typedef struct model {
    sn_tet_mesh input;
    sn_extraction x; /* of the half */
} model;

static double near_line(sn_vec3 p, sn_vec3 a, sn_vec3 b)
{
    sn_vec3 d = sn_v3_sub(b, a);
    double t = sn_v3_dot(sn_v3_sub(p, a), d) / sn_v3_len2(d);
    return 0.8 - 1.5 * sn_v3_dist(p, sn_v3_lerp(a, b, fmin(fmax(t, 0.0), 1.0)));
}

/* The belly lies across the plane, and so does the arm that comes from the other side. No curve runs along
 * faces of the lattice, where rounding chooses the tet. */
static const double line_of[n_half][6] = {{0},
                                          {0.31, 0.63, 0.0, 0.28, 0.71, 1.0},
                                          {0.7, 0.04, 0.0, 0.7, 0.06, 1.0},
                                          {0.8, 0.8, 0.1, 0.7, 0.8, 0.9},
                                          {0.2, 0.1, 0.9, 0.25, 0.02, 0.2}};

static double *made_values(const sn_tet_mesh *m)
{
    double *value = SN_NEW(double, (size_t)n_half *(size_t)m->n_vert);
    assert_non_null(value);
    for (int32_t v = 0; v < m->n_vert; v++)
        for (int i = 0; i < n_half; i++)
            value[(size_t)i * (size_t)m->n_vert + (size_t)v] =
                i == fat
                    ? 0.45
                    : near_line(sn_tet_mesh_point(m, v), sn_v3_load(line_of[i]), sn_v3_load(line_of[i] + 3));
    return value;
}

static sn_muscle made_muscle(int i, const frame *f)
{
    double point[6];
    sn_muscle m = {0};
    for (int k = 0; k < 2; k++) sn_v3_store(point + 3 * k, placed(f, sn_v3_load(line_of[i] + 3 * k)));
    assert_int_equal(sn_muscle_init(&m, half_name[i], &(sn_head_points){point, NULL, 2}, 1, NULL), SN_OK);
    assert_int_equal(sn_muscle_set_tendon(&m, &(sn_tendon){.length = 0.15}, NULL), SN_OK);
    if (i == biceps)
        make_pennate(&m, &(sn_pennation){.kind = SN_UNIPENNATE, .angle_deg = {25}, .n_angle = 1});
    if (i == arm_r) make_pennate(&m, &(sn_pennation){.kind = SN_PARALLEL});
    return m;
}

static void set_muscles(sn_extraction *x, const frame *f)
{
    sn_muscle muscle[n_half - 1];
    const sn_muscle *known[n_half - 1];
    for (int i = 1; i < n_half; i++) muscle[i - 1] = made_muscle(i, f), known[i - 1] = &muscle[i - 1];
    assert_int_equal(sn_extraction_set_muscles(x, known, n_half - 1, NULL), SN_OK);
    for (int i = 1; i < n_half; i++) sn_muscle_free(&muscle[i - 1]);
}

static model made_model(const frame *f, bool has_muscles)
{
    model m;
    sn_error err = {0};
    m.input = made_lattice(5, sn_v3(0, 0, 0), 0.2);
    double *value = made_values(&m.input);
    for (int32_t v = 0; v < m.input.n_vert; v++)
        sn_v3_store(m.input.pos + 3 * v, placed(f, sn_tet_mesh_point(&m.input, v)));
    sn_extraction_init(&m.x);
    if (sn_extract(&m.input, value, half_name, n_half, NULL, NULL, &m.x, &err)) fail_msg("%s", err.msg);
    if (has_muscles) set_muscles(&m.x, f);
    sn_release(value);
    return m;
}

static void model_free(model *m)
{
    sn_extraction_free(&m->x);
    sn_tet_mesh_free(&m->input);
}

static sn_extraction mirrored(const model *m, const frame *f)
{
    sn_extraction whole;
    sn_error err = {0};
    sn_extraction_init(&whole);
    if (sn_extraction_mirror(&m->x, sn_v3_mad(f->o, 0.7, f->x), sn_v3_scale(3.0, f->y), NULL, &whole, &err))
        fail_msg("%s", err.msg);
    return whole;
}

/* ---- tets ---- */

static void assert_sound(const sn_extraction *x, const sn_tet_mesh *input)
{
    sn_extraction_check c;
    assert_int_equal(sn_extraction_check_run(&c, x, input, NULL, NULL), SN_OK);
    if (!c.conforming || !c.manifold || !c.positive)
        fail_msg("bad faces %lld, edges %lld, vertices %lld, inverted %d", (long long)c.bad_faces,
                 (long long)c.nonmanifold_edges, (long long)c.nonmanifold_vertices, c.inverted);
    assert_true(c.volume_error < 1e-12);
}

static int32_t count_on(const sn_extraction *x, const frame *f)
{
    int32_t n = 0;
    for (int32_t v = 0; v < x->mesh.n_vert; v++)
        n += fabs(sn_v3_dot(f->y, sn_v3_sub(sn_tet_mesh_point(&x->mesh, v), f->o))) < 1e-9;
    return n;
}

static int32_t surface_faces(const sn_extraction *x, const frame *f, int32_t *n_on)
{
    sn_tri_mesh s;
    sn_mesh_check c;
    sn_tri_mesh_init(&s);
    assert_int_equal(sn_tet_mesh_surface(&x->mesh, -1, &s, NULL, NULL), SN_OK);
    assert_int_equal(sn_mesh_check_run(&c, &s, NULL, NULL), SN_OK);
    assert_true(c.closed && c.manifold && c.oriented && c.components == 1);
    *n_on = 0;
    for (int32_t i = 0; i < s.n_face; i++) {
        bool on = true;
        for (int k = 0; k < 3; k++)
            on =
                on && fabs(sn_v3_dot(f->y, sn_v3_sub(sn_tri_mesh_point(&s, s.face[3 * i + k]), f->o))) < 1e-9;
        *n_on += on;
    }
    int32_t n = s.n_face;
    sn_tri_mesh_free(&s);
    return n;
}

static void both_sides_are_joined(void **state)
{
    const frame *const all[] = {&upright, &below, &slanted};
    (void)state;
    for (int i = 0; i < 3; i++) {
        const frame *f = all[i];
        model m = made_model(f, false);
        sn_extraction x = mirrored(&m, f);
        int32_t n_on = count_on(&m.x, f), n_cap, n_seam;
        int32_t n_outside = surface_faces(&m.x, f, &n_cap);
        assert_sound(&x, &m.input);
        assert_sound(&x, NULL);
        assert_int_equal(x.mesh.n_tet, 2 * m.x.mesh.n_tet);
        assert_int_equal(x.mesh.n_vert, 2 * m.x.mesh.n_vert - n_on);
        assert_int_equal(count_on(&x, f), n_on);
        assert_true(n_cap > 50);
        assert_int_equal(surface_faces(&x, f, &n_seam), 2 * (n_outside - n_cap));
        assert_int_equal(n_seam, 0);
        double once = sn_tet_mesh_volume(&m.x.mesh);
        assert_true(fabs(sn_tet_mesh_volume(&x.mesh) - 2.0 * once) < 1e-12 * once);
        assert_true(x.input_volume == 2.0 * m.x.input_volume && x.n_moved == 2 * m.x.n_moved);
        sn_extraction_free(&x);
        model_free(&m);
    }
}

/* The half comes first; reflecting an image gives the vertex back; envelope and source are the same. */
static void images_are_exact(void **state)
{
    const frame *const all[] = {&upright, &below, &slanted};
    (void)state;
    for (int i = 0; i < 3; i++) {
        model m = made_model(all[i], false);
        sn_extraction x = mirrored(&m, all[i]);
        int32_t n = m.x.mesh.n_tet;
        sn_plane plane;
        assert_int_equal(sn_plane_make(&plane, "test", all[i]->o, all[i]->y, NULL), SN_OK);
        assert_memory_equal(x.mesh.tet, m.x.mesh.tet, 4 * (size_t)n * sizeof *x.mesh.tet);
        assert_memory_equal(x.mesh.part, m.x.mesh.part, (size_t)n * sizeof *x.mesh.part);
        assert_memory_equal(x.source, m.x.source, (size_t)n * sizeof *x.source);
        assert_memory_equal(x.source + n, m.x.source, (size_t)n * sizeof *x.source);
        for (int32_t v = 0; v < m.x.mesh.n_vert; v++)
            assert_true(sn_v3_dist(sn_tet_mesh_point(&x.mesh, v), sn_tet_mesh_point(&m.x.mesh, v)) < 1e-14);
        for (int32_t t = 0; t < n; t++) {
            static const int corner[4] = {0, 1, 3, 2};
            assert_true(sn_extraction_is_image(&x, n + t) && !sn_extraction_is_image(&x, t));
            for (int k = 0; k < 4; k++) {
                int32_t v = x.mesh.tet[4 * t + k], w = x.mesh.tet[4 * (n + t) + corner[k]];
                sn_vec3 back = sn_plane_reflect(&plane, sn_tet_mesh_point(&x.mesh, w));
                assert_true(sn_v3_dist(back, sn_tet_mesh_point(&x.mesh, v)) < 1e-14);
                assert_true(x.envelope[v] == x.envelope[w] && x.envelope[v] == m.x.envelope[v]);
                if (i == 0 && v == w) assert_true(x.mesh.pos[3 * v + 1] == 0.0);
                if (i == 1 && v == w) assert_true(x.mesh.pos[3 * v + 1] == 0.125);
            }
        }
        sn_extraction_free(&x);
        model_free(&m);
    }
}

/* ---- tissues ---- */

static void tissues_go_by_their_names(void **state)
{
    static const char *const want[] = {"fat", "biceps_l", "belly", "arm_l", "arm_r", "biceps_r"};
    (void)state;
    model m = made_model(&upright, true);
    sn_extraction x = mirrored(&m, &upright);
    double half[n_half], whole[n_whole];
    assert_int_equal(x.n_tissue, n_whole);
    for (int i = 0; i < n_whole; i++) assert_string_equal(x.name[i], want[i]);
    for (int i = 0; i < n_half; i++) assert_true((half[i] = sn_extraction_part_volume(&m.x, i)) > 0.01);
    for (int i = 0; i < n_whole; i++) whole[i] = sn_extraction_part_volume(&x, i);
    const double sum[n_whole] = {
        2 * half[fat], half[biceps], 2 * half[belly], half[arm_l] + half[arm_r], half[arm_l] + half[arm_r],
        half[biceps]};
    for (int i = 0; i < n_whole; i++) assert_true(fabs(whole[i] - sum[i]) < 1e-12);
    assert_int_equal(x.n_muscle, n_whole - 1);
    for (int i = 1; i < n_whole; i++) assert_string_equal(x.muscle[i - 1].name, want[i]);
    assert_true(x.muscle[biceps_r - 1].head[0].point[1] == -0.63);
    assert_true(x.muscle[biceps_r - 1].head[0].point[4] == -0.71);
    assert_true(x.muscle[biceps_r - 1].tendon.length == 0.15);
    assert_int_equal(x.muscle[biceps_r - 1].pennation.kind, SN_UNIPENNATE);
    assert_true(x.muscle[belly - 1].head[0].point[1] == 0.04);
    for (int i = 0; i < n_half; i++) {
        assert_int_equal(sn_extraction_half_tissue(&x, i, false), i);
        static const int32_t image[n_half] = {fat, -1, belly, arm_r, arm_l};
        assert_int_equal(sn_extraction_half_tissue(&x, i, true), image[i]);
    }
    assert_int_equal(sn_extraction_half_tissue(&x, biceps_r, false), -1);
    assert_int_equal(sn_extraction_half_tissue(&x, biceps_r, true), biceps);
    sn_extraction_free(&x);
    model_free(&m);
}

/* ---- fibers ---- */

static double *new_fibers(const sn_extraction *x, const sn_tet_mesh *input, int32_t tissue)
{
    double *fiber = SN_NEW(double, 4 * (size_t)x->mesh.n_tet);
    sn_error err = {0};
    assert_non_null(fiber);
    if (sn_extraction_fibers(x, input, tissue, NULL, fiber, fiber + 3 * (size_t)x->mesh.n_tet, &err))
        fail_msg("%s", err.msg);
    return fiber;
}

static void fibers_are_reflected(void **state)
{
    (void)state;
    model m = made_model(&slanted, true);
    sn_extraction x = mirrored(&m, &slanted);
    size_t n = (size_t)m.x.mesh.n_tet;
    double *half = new_fibers(&m.x, &m.input, -1), *whole = new_fibers(&x, &m.input, -1);
    int n_fiber = 0, n_tendon = 0;
    for (size_t k = 0; k < 3 * n; k++) assert_true(fabs(whole[k] - half[k]) < 1e-9);
    assert_memory_equal(whole + 6 * n, half + 3 * n, n * sizeof *half);
    assert_memory_equal(whole + 7 * n, half + 3 * n, n * sizeof *half);
    for (size_t t = 0; t < n; t++) {
        sn_vec3 d = sn_v3_load(whole + 3 * t), image = sn_v3_load(whole + 3 * (n + t));
        sn_vec3 want = sn_v3_mad(d, -2.0 * sn_v3_dot(d, slanted.y), slanted.y);
        assert_true(sn_v3_dist(image, want) < 1e-14);
        n_fiber += sn_v3_len(d) > 0.5;
        n_tendon += half[3 * n + t] > 0.0;
    }
    assert_true(n_fiber > 1000 && n_tendon > 100);
    for (int32_t i = 0; i < n_whole; i++) { /* one tissue alone */
        double *one = new_fibers(&x, &m.input, i);
        for (size_t t = 0; t < 2 * n; t++) {
            bool is_in = x.mesh.part[t] == i;
            for (size_t k = 0; k < 3; k++) assert_true(one[3 * t + k] == (is_in ? whole[3 * t + k] : 0.0));
            assert_true(one[6 * n + t] == (is_in ? whole[6 * n + t] : 0.0));
        }
        sn_release(one);
    }
    sn_release(half);
    sn_release(whole);
    sn_extraction_free(&x);
    model_free(&m);
}

/* Every part's own account is that of the whole. */
static void parts_show_the_same_fibers(void **state)
{
    (void)state;
    model m = made_model(&slanted, true);
    sn_extraction x = mirrored(&m, &slanted);
    double *whole = new_fibers(&x, &m.input, -1);
    for (int32_t i = 1; i < n_whole; i++) {
        sn_part_fibers p;
        sn_error err = {0};
        if (sn_part_fibers_build(&p, &x, &m.input, i, NULL, NULL, &err)) fail_msg("%s", err.msg);
        assert_int_equal(p.n_tet, sn_extraction_part_tets(&x, i));
        sn_vec3 *centre = SN_NEW(sn_vec3, p.n_tet), *d = SN_NEW(sn_vec3, p.n_tet);
        double *u = SN_NEW(double, p.n_tet);
        bool *is_tendon = SN_NEW(bool, p.n_tet);
        sn_part_fibers_sample(&p, &x, NULL, centre, d, u, is_tendon);
        for (int32_t k = 0; k < p.n_tet; k++) {
            int32_t t = p.tet[k];
            assert_int_equal(x.mesh.part[t], i);
            assert_true(sn_v3_dist(centre[k], sn_tet_mesh_centre(&x.mesh, t)) == 0.0);
            /* the image of a centre is the centre of the image, but for rounding */
            assert_true(sn_v3_dist(d[k], sn_v3_load(whole + 3 * (size_t)t)) < 1e-6);
            assert_true(is_tendon[k] == (whole[6 * (size_t)m.x.mesh.n_tet + (size_t)t] > 0.0));
        }
        assert_true((p.image != NULL) == (i == arm_l || i == arm_r));
        sn_part_fibers_free(&p);
        sn_release(centre);
        sn_release(d);
        sn_release(u);
        sn_release(is_tendon);
    }
    sn_release(whole);
    sn_extraction_free(&x);
    model_free(&m);
}

/* The mirrored muscle in a mirrored body, solved anew, has the fibers that reflection gives: above all, they
 * lean to the mirrored side. */
static void a_mirrored_muscle_has_mirrored_fibers(void **state)
{
    (void)state;
    model m = made_model(&slanted, true);
    sn_extraction x = mirrored(&m, &slanted);
    sn_plane plane = x.half.plane;
    sn_tet_mesh input;
    sn_extraction image = sn_extraction_half_view(&x); /* the image alone, as if it were a half */
    sn_tet_mesh_init(&input);
    assert_int_equal(sn_tet_mesh_copy(&input, &m.input, NULL), SN_OK);
    for (int32_t v = 0; v < input.n_vert; v++)
        sn_v3_store(input.pos + 3 * v, sn_plane_reflect(&plane, sn_tet_mesh_point(&input, v)));
    for (int32_t t = 0; t < input.n_tet; t++) {
        int32_t *v = input.tet + 4 * (size_t)t, swap = v[2];
        v[2] = v[3], v[3] = swap;
    }
    image.mesh.n_vert = x.mesh.n_vert;
    image.mesh.tet = x.mesh.tet + 4 * (size_t)x.half.n_tet;
    static const int kind[] = {SN_UNIPENNATE, SN_BIPENNATE, SN_PARALLEL, SN_FUSIFORM};
    for (int k = 0; k < 4; k++) {
        sn_muscle mirror = {0}, *own = &m.x.muscle[biceps - 1];
        sn_pennation pennation = {.kind = (sn_architecture)kind[k], .angle_deg = {25}, .n_angle = k < 2};
        make_pennate(own, &pennation);
        assert_int_equal(sn_muscle_mirror(&mirror, own, &plane, "other", NULL), SN_OK);
        assert_string_equal(mirror.name, "other");
        sn_part_fibers a, b;
        assert_int_equal(sn_part_fibers_build(&a, &m.x, &m.input, biceps, own, NULL, NULL), SN_OK);
        assert_int_equal(sn_part_fibers_build(&b, &image, &input, biceps, &mirror, NULL, NULL), SN_OK);
        assert_int_equal(a.n_tet, b.n_tet);
        sn_vec3 *da = SN_NEW(sn_vec3, a.n_tet), *db = SN_NEW(sn_vec3, a.n_tet);
        sn_part_fibers_sample(&a, &m.x, NULL, NULL, da, NULL, NULL);
        sn_part_fibers_sample(&b, &image, NULL, NULL, db, NULL, NULL);
        for (int32_t t = 0; t < a.n_tet; t++)
            if (!(sn_v3_dist(sn_plane_reflect_vector(&plane, da[t]), db[t]) < 1e-6))
                fail_msg("kind %d, tet %d: off by %g", kind[k], t,
                         sn_v3_dist(sn_plane_reflect_vector(&plane, da[t]), db[t]));
        sn_release(da);
        sn_release(db);
        sn_part_fibers_free(&a);
        sn_part_fibers_free(&b);
        sn_muscle_free(&mirror);
    }
    sn_tet_mesh_free(&input);
    sn_extraction_free(&x);
    model_free(&m);
}

/* A frame that turns: e1 and e3 are reflected along the whole curve, e2 reflected and turned round. */
static void a_mirrored_frame(void **state)
{
    static const double point[] = {0, 0.5, 0, 0.3, 0.6, 0.4, 0.1, 0.9, 0.8, 0, 1, 1.5};
    (void)state;
    for (int i = 0; i < 4; i++) {
        sn_muscle m = curve_muscle(point, 4), image = {0};
        sn_anisotropy a = {.is_on = true, .angle_deg = 30, .eigenvalue = {3, 2, 1}, .has_axis = i > 1};
        a.axis = sn_v3(1, 2, 0.5);
        if (i > 0) assert_int_equal(sn_muscle_set_anisotropy(&m, &a, NULL), SN_OK);
        if (i == 0) make_pennate(&m, &(sn_pennation){.kind = SN_BIPENNATE, .angle_deg = {9}, .n_angle = 1});
        sn_plane plane;
        sn_paths p = {0}, q = {0};
        assert_int_equal(sn_plane_make(&plane, "test", sn_v3(0, 0.1, 0), sn_v3(0.2, 1, i - 1), NULL), SN_OK);
        assert_int_equal(sn_muscle_mirror(&image, &m, &plane, "x", NULL), SN_OK);
        assert_int_equal(sn_paths_build(&p, &m, NULL), SN_OK);
        assert_int_equal(sn_paths_build(&q, &image, NULL), SN_OK);
        assert_true(image.anisotropy.is_on && image.anisotropy.eigenvalue[0] == (i > 0 ? 3.0 : 1.0));
        for (int k = 0; k <= SN_PATH_STEPS; k++) {
            sn_triad f = p.head[0].frame[k], g = q.head[0].frame[k];
            sn_vec3 at = sn_plane_reflect(&plane, p.head[0].point[k]);
            assert_true(sn_v3_dist(at, q.head[0].point[k]) < 1e-9);
            assert_true(sn_v3_dist(sn_plane_reflect_vector(&plane, f.e1), g.e1) < 1e-9);
            assert_true(sn_v3_dist(sn_plane_reflect_vector(&plane, f.e2), sn_v3_scale(-1, g.e2)) < 1e-9);
            assert_true(sn_v3_dist(sn_plane_reflect_vector(&plane, f.e3), g.e3) < 1e-9);
        }
        sn_paths_free(&p);
        sn_paths_free(&q);
        sn_muscle_free(&m);
        sn_muscle_free(&image);
    }
}

/* A muscle that wins nowhere has no image either, and its other side says so by its own name. */
static void an_empty_muscle(void **state)
{
    (void)state;
    model m = made_model(&upright, true);
    for (int32_t t = 0; t < m.x.mesh.n_tet; t++)
        if (m.x.mesh.part[t] == biceps) m.x.mesh.part[t] = fat;
    sn_extraction x = mirrored(&m, &upright);
    sn_part_fibers p;
    sn_error err;
    assert_string_equal(x.name[biceps_r], "biceps_r");
    assert_int_equal(sn_extraction_part_tets(&x, biceps_r), 0);
    assert_int_equal(sn_part_fibers_build(&p, &x, &m.input, biceps, NULL, NULL, &err), SN_EINVAL);
    assert_int_equal(sn_part_fibers_build(&p, &x, &m.input, biceps_r, NULL, NULL, &err), SN_EINVAL);
    assert_string_equal(err.msg, "part 'biceps_r' is empty: it has no fibers");
    double *fiber = new_fibers(&x, &m.input, biceps_r);
    for (size_t k = 0; k < 4 * (size_t)x.mesh.n_tet; k++) assert_true(fiber[k] == 0.0);
    sn_release(fiber);
    sn_extraction_free(&x);
    model_free(&m);
}

/* ---- lines and architecture ---- */

static sn_polylines lines_of(const sn_extraction *x, const sn_tet_mesh *input, int32_t tissue, int32_t n,
                             const sn_muscle *lead)
{
    sn_polylines l;
    sn_part_fibers p;
    sn_error err = {0};
    sn_polylines_init(&l, true);
    if (sn_part_fibers_build(&p, x, input, tissue, lead, NULL, &err)) fail_msg("%s", err.msg);
    if (sn_part_fibers_lines(&p, x, n, NULL, &l, &err)) fail_msg("%s", err.msg);
    sn_part_fibers_free(&p);
    return l;
}

static void lines_run_on_both_sides(void **state)
{
    (void)state;
    model m = made_model(&upright, true);
    sn_extraction x = mirrored(&m, &upright);
    sn_polylines left = lines_of(&x, &m.input, biceps, 20, NULL),
                 right = lines_of(&x, &m.input, biceps_r, 20, NULL),
                 half = lines_of(&m.x, &m.input, biceps, 20, NULL);
    assert_true(left.n_line > 15);
    assert_int_equal(left.n_line, half.n_line);
    assert_int_equal(left.n_line, right.n_line);
    assert_int_equal(left.n_point, right.n_point);
    assert_memory_equal(left.pos, half.pos, 3 * left.n_point * sizeof *left.pos);
    for (size_t i = 0; i < left.n_line; i++) {
        assert_int_equal(left.part[i], biceps);
        assert_int_equal(right.part[i], biceps_r);
    }
    for (size_t k = 0; k < left.n_point; k++) {
        sn_vec3 p = sn_polylines_point(&left, k), q = sn_polylines_point(&right, k);
        assert_true(q.x == p.x && q.y == -p.y && q.z == p.z && left.value[k] == right.value[k]);
    }
    sn_polylines_free(&left);
    sn_polylines_free(&right);
    sn_polylines_free(&half);
    const int32_t both[] = {belly, arm_l, arm_r};
    for (int i = 0; i < 3; i++) {
        sn_polylines l = lines_of(&x, &m.input, both[i], 41, NULL);
        int n_own = 0, n_image = 0, n_up = 0;
        for (size_t k = 0; k < l.n_line; k++) {
            sn_vec3 a = sn_polylines_point(&l, (size_t)l.first[k]),
                    b = sn_polylines_point(&l, (size_t)l.first[k + 1] - 1);
            assert_true((a.y >= 0.0 && b.y >= 0.0) || (a.y <= 0.0 && b.y <= 0.0));
            n_own += a.y > 0.0;
            n_image += a.y < 0.0;
            n_up += b.z > a.z;
            assert_int_equal(l.part[k], both[i]);
        }
        assert_true(n_own > 3 && n_image > 3 && n_own + n_image <= 41);
        if (both[i] == belly) assert_int_equal(n_up, n_own + n_image); /* from origin to insertion */
        if (both[i] == arm_l) assert_int_equal(n_up, n_own); /* the image is arm_r's, which runs down */
        if (both[i] == arm_r) assert_int_equal(n_up, n_image);
        sn_polylines_free(&l);
    }
    sn_extraction_free(&x);
    model_free(&m);
}

/* A curve given for a part that is all image runs there; for others it leads the half's side. */
static void a_curve_given(void **state)
{
    (void)state;
    model m = made_model(&upright, false);
    sn_extraction x = mirrored(&m, &upright);
    sn_muscle right = curve_muscle((const double[]){0.3, -0.6, 0, 0.3, -0.7, 1}, 2),
              left = curve_muscle((const double[]){0.3, 0.6, 0, 0.3, 0.7, 1}, 2);
    sn_polylines r = lines_of(&x, &m.input, biceps_r, 10, &right),
                 l = lines_of(&x, &m.input, biceps, 10, &left);
    assert_true(r.n_line > 5);
    assert_int_equal(r.n_point, l.n_point);
    for (size_t k = 0; k < r.n_point; k++) assert_true(r.pos[3 * k + 1] == -l.pos[3 * k + 1]);
    sn_polylines_free(&r);
    sn_polylines_free(&l);
    sn_muscle_free(&left);
    sn_muscle_free(&right);
    sn_part_fibers p;
    sn_error err;
    assert_int_equal(sn_part_fibers_build(&p, &x, &m.input, biceps_r, NULL, NULL, &err), SN_EINVAL);
    assert_string_equal(err.msg, "part 'biceps_r' has no curve that fibers could follow: give one");
    sn_extraction_free(&x);
    model_free(&m);
}

static sn_part_architecture architecture_of(const sn_extraction *x, const sn_tet_mesh *input, int32_t tissue)
{
    sn_part_fibers p;
    sn_part_architecture a;
    assert_int_equal(sn_part_fibers_build(&p, x, input, tissue, NULL, NULL, NULL), SN_OK);
    assert_int_equal(sn_part_architecture_find(&p, x, NULL, &a, NULL), SN_OK);
    sn_part_fibers_free(&p);
    return a;
}

static void assert_near(double a, double b, double relative)
{
    if (!(fabs(a - b) <= relative * fabs(b))) fail_msg("%.17g is not %.17g", a, b);
}

static void architecture_of_both_sides(void **state)
{
    (void)state;
    model m = made_model(&slanted, true);
    sn_extraction x = mirrored(&m, &slanted);
    sn_part_architecture half = architecture_of(&m.x, &m.input, biceps),
                         left = architecture_of(&x, &m.input, biceps),
                         right = architecture_of(&x, &m.input, biceps_r);
    assert_near(half.pennation_deg, 25.0, 0.05);
    assert_near(left.pennation_deg, half.pennation_deg, 1e-9);
    assert_near(right.pennation_deg, half.pennation_deg, 1e-9);
    assert_near(right.belly_volume, half.belly_volume, 1e-9);
    assert_near(right.fiber_length, half.fiber_length, 1e-9);
    assert_near(right.pcsa, half.pcsa, 1e-9);
    half = architecture_of(&m.x, &m.input, belly);
    sn_part_architecture whole = architecture_of(&x, &m.input, belly);
    assert_near(whole.volume, 2.0 * half.volume, 1e-12);
    assert_near(whole.belly_volume, 2.0 * half.belly_volume, 1e-12);
    assert_near(whole.fiber_length, half.fiber_length, 0.03); /* other lines */
    assert_near(whole.pcsa, 2.0 * half.pcsa, 0.03);
    assert_int_equal(whole.check.sinks, 2 * half.check.sinks);
    assert_near(whole.check.worst_turn_deg, half.check.worst_turn_deg, 1e-6);
    sn_extraction_free(&x);
    model_free(&m);
}

/* ---- files ---- */

static void files_hold_both_sides(void **state)
{
    static const char *const file[] = {"whole.vtu", "whole.mesh"};
    (void)state;
    model m = made_model(&upright, true);
    sn_extraction x = mirrored(&m, &upright);
    sn_error err = {0};
    for (int i = 0; i < 2; i++) {
        sn_tet_mesh back;
        sn_tet_mesh_init(&back);
        if (sn_extraction_save(&x, &m.input, in_folder(file[i]), NULL, &err)) fail_msg("%s", err.msg);
        if (sn_tet_mesh_load(&back, in_folder(file[i]), &err)) fail_msg("%s", err.msg);
        assert_int_equal(back.n_vert, x.mesh.n_vert);
        assert_int_equal(back.n_tet, x.mesh.n_tet);
        assert_memory_equal(back.pos, x.mesh.pos, 3 * (size_t)back.n_vert * sizeof *back.pos);
        assert_memory_equal(back.tet, x.mesh.tet, 4 * (size_t)back.n_tet * sizeof *back.tet);
        if (i == 1) { /* a name for each tissue and for the tendon of each */
            char *text = file_text(file[i]);
            assert_non_null(strstr(text, "biceps_r\n"));
            assert_non_null(strstr(text, "biceps_r:tendon\n"));
            sn_release(text);
        }
        if (i == 0) assert_memory_equal(back.part, x.mesh.part, (size_t)back.n_tet * sizeof *back.part);
        sn_tet_mesh_free(&back);
    }
    if (sn_extraction_save(&x, &m.input, in_folder("whole.msh"), NULL, &err)) fail_msg("%s", err.msg);
    if (sn_extraction_save_part(&x, &m.input, biceps_r, in_folder("part.vtu"), NULL, &err))
        fail_msg("%s", err.msg);
    if (sn_extraction_save_part(&x, &m.input, belly, in_folder("belly.obj"), NULL, &err))
        fail_msg("%s", err.msg);
    sn_tri_mesh s;
    sn_tri_mesh_init(&s);
    assert_int_equal(sn_surface_load(&s, in_folder("belly.obj"), &err), SN_OK);
    assert_true(fabs(sn_tri_mesh_volume(&s) - sn_extraction_part_volume(&x, belly)) < 1e-12);
    assert_true(sn_tri_mesh_bounds(&s).min.y == -sn_tri_mesh_bounds(&s).max.y);
    sn_tri_mesh_free(&s);
    sn_extraction_free(&x);
    model_free(&m);
}

/* ---- what cannot be mirrored ---- */

static void assert_refused(const sn_extraction *x, sn_vec3 point, sn_vec3 normal, const char *msg)
{
    sn_extraction out;
    sn_error err = {0};
    sn_extraction_init(&out);
    assert_int_not_equal(sn_extraction_mirror(x, point, normal, NULL, &out, &err), SN_OK);
    assert_string_equal(err.msg, msg);
    assert_null(out.mesh.pos);
    assert_null(out.name);
}

static void refusals(void **state)
{
    (void)state;
    const sn_vec3 o = {0, 0, 0}, y = {0, 1, 0};
    model m = made_model(&upright, true);
    assert_refused(&m.x, o, o, "mirror: the plane needs a finite point and a normal that is not zero");
    assert_refused(&m.x, o, sn_v3(NAN, 0, 0),
                   "mirror: the plane needs a finite point and a normal that is not zero");
    assert_refused(&m.x, sn_v3(0, 0.25, 0), y,
                   "mirror: vertex 1 lies 0.25 beyond the plane: a half must lie on one side of it");
    assert_refused(&m.x, sn_v3(0, -0.125, 0), y,
                   "mirror: the half has no face in the plane, its nearest vertex is 0.125 from it");
    assert_refused(&m.x, o, sn_v3(1, 1, 0), /* it only touches an edge */
                   "mirror: the half has no face in the plane, its nearest vertex is 0 from it");
    sn_extraction x = mirrored(&m, &upright);
    assert_refused(&x, o, y, "mirror: the extraction is mirrored already");
    sn_extraction_free(&x);
    sn_muscle_free(&m.x.muscle[--m.x.n_muscle]);
    assert_refused(&m.x, o, y, "mirror: muscles of 3 tissues are known, need 4 or none");
    sn_extraction_init(&x);
    assert_refused(&x, o, y, "mirror: the extraction has no tets");
    while (m.x.n_muscle > 0) sn_muscle_free(&m.x.muscle[--m.x.n_muscle]);
    for (int32_t v = 0; v < 4; v++) m.x.mesh.pos[3 * m.x.mesh.tet[v] + 1] = 0.0;
    assert_refused(&m.x, o, y, "mirror: tet 1 lies flat in the plane");
    model_free(&m);
}

/* Vertices a little off the plane, on both sides, are moved onto it. */
static void vertices_near_the_plane(void **state)
{
    (void)state;
    model m = made_model(&upright, false);
    int32_t n_on = count_on(&m.x, &upright);
    for (int32_t v = 0; v < m.x.mesh.n_vert; v++)
        if (m.x.mesh.pos[3 * v + 1] == 0.0) m.x.mesh.pos[3 * v + 1] = (v % 3 - 1) * 1.5e-9;
    sn_extraction x = mirrored(&m, &upright);
    assert_int_equal(x.mesh.n_vert, 2 * m.x.mesh.n_vert - n_on);
    assert_int_equal(count_on(&x, &upright), n_on);
    assert_sound(&x, NULL);
    sn_extraction_free(&x);
    model_free(&m);
}

static void no_memory(void **state)
{
    (void)state;
    model m = made_model(&upright, true);
    sn_status st = SN_ENOMEM;
    for (int n = 0; st; n++) {
        failing f = {.left = n};
        sn_extraction x;
        sn_error err = {0};
        sn_extraction_init(&x);
        sn_set_allocator(&(sn_allocator){failing_realloc, &f});
        st = sn_extraction_mirror(&m.x, sn_v3(0, 0, 0), sn_v3(0, 1, 0), NULL, &x, &err);
        if (st) {
            assert_int_equal(st, SN_ENOMEM);
            assert_non_null(strstr(err.msg, "no memory"));
            assert_null(x.name);
        }
        sn_extraction_free(&x);
        sn_set_allocator(NULL);
        assert_int_equal(f.n_alive, 0);
        assert_true(n < 200);
    }
    model_free(&m);
}

/* The fields of both sides of a part that comes from two tissues; single threads, so that calls are counted.
 */
static void no_memory_for_fibers(void **state)
{
    (void)state;
    const sn_run run = {.n_threads = 1};
    model m = made_model(&upright, true);
    sn_extraction x = mirrored(&m, &upright);
    sn_status st = SN_ENOMEM;
    for (int n = 0; st; n++) {
        failing f = {.left = n};
        sn_part_fibers p;
        sn_polylines l;
        sn_error err = {0};
        sn_polylines_init(&l, true);
        sn_set_allocator(&(sn_allocator){failing_realloc, &f});
        st = sn_part_fibers_build(&p, &x, &m.input, arm_l, NULL, &run, &err);
        if (!st) st = sn_part_fibers_lines(&p, &x, 4, &run, &l, &err);
        if (st) assert_int_equal(st, SN_ENOMEM);
        sn_part_fibers_free(&p);
        sn_polylines_free(&l);
        sn_set_allocator(NULL);
        assert_int_equal(f.n_alive, 0);
        assert_true(n < 1000);
    }
    sn_extraction_free(&x);
    model_free(&m);
}

static void interrupted(void **state)
{
    (void)state;
    const volatile sig_atomic_t stop = 1;
    const sn_run run = {.cancel = &stop};
    model m = made_model(&upright, true);
    sn_extraction x;
    sn_extraction_init(&x);
    assert_int_equal(sn_extraction_mirror(&m.x, sn_v3(0, 0, 0), sn_v3(0, 1, 0), &run, &x, NULL), SN_ECANCEL);
    assert_null(x.mesh.pos);
    model_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_sides_are_joined),
        cmocka_unit_test(images_are_exact),
        cmocka_unit_test(tissues_go_by_their_names),
        cmocka_unit_test(fibers_are_reflected),
        cmocka_unit_test(parts_show_the_same_fibers),
        cmocka_unit_test(a_mirrored_muscle_has_mirrored_fibers),
        cmocka_unit_test(a_mirrored_frame),
        cmocka_unit_test(an_empty_muscle),
        cmocka_unit_test(lines_run_on_both_sides),
        cmocka_unit_test(a_curve_given),
        cmocka_unit_test(architecture_of_both_sides),
        cmocka_unit_test(files_hold_both_sides),
        cmocka_unit_test(refusals),
        cmocka_unit_test(vertices_near_the_plane),
        cmocka_unit_test(no_memory),
        cmocka_unit_test(no_memory_for_fibers),
        cmocka_unit_test(interrupted),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
