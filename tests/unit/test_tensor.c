/* test_tensor - anisotropic diffusion: the Laplacian with tensors, frames spread over a mesh, and what they
 * do to the muscles of a scene. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "field/tensor.h"

#include "made_limb.h"

static sn_csr laplacian_of(const sn_tet_mesh *m)
{
    sn_csr a = {0};
    sn_assembly s = {0};
    assert_int_equal(sn_laplacian_build(&a, &s, m, 0.0, NULL, NULL), SN_OK);
    sn_assembly_free(&s);
    return a;
}

/* The Laplacian with these frames and eigenvalues. */
static sn_csr anisotropic_of(const sn_tet_mesh *m, const sn_triad *frame, const double eigenvalue[3])
{
    sn_csr a = {0};
    sn_assembly s = {0};
    double *tensor = malloc(6 * (size_t)m->n_vert * sizeof *tensor);
    sn_tensor_field(frame, m->n_vert, eigenvalue, tensor);
    assert_int_equal(sn_laplacian_build(&a, &s, m, 0.0, NULL, NULL), SN_OK);
    sn_laplacian_set_anisotropic(&a, &s, m, tensor);
    sn_assembly_free(&s);
    free(tensor);
    return a;
}

static sn_tet_mesh shaken_box(int n)
{
    sn_tet_mesh m = made_lattice(n, sn_v3(-1, 2, 3), 0.5);
    shake_mesh(&m, 0.06);
    return m;
}

static double largest_entry(const sn_csr *a)
{
    double largest = 0.0;
    for (int64_t k = 0; k < a->ptr[a->n]; k++) largest = fmax(largest, fabs(a->val[k]));
    return largest;
}

static void assert_same_entries(const sn_csr *a, const sn_csr *b, double factor, double tolerance)
{
    double unit = largest_entry(a);
    assert_int_equal(a->ptr[a->n], b->ptr[b->n]);
    for (int64_t k = 0; k < a->ptr[a->n]; k++)
        assert_true(a->idx[k] == b->idx[k] && fabs(a->val[k] - factor * b->val[k]) < tolerance * unit);
}

/* Any right-handed frame, the same for the same *h. */
static sn_triad random_frame(uint64_t *h)
{
    sn_vec3 a = sn_v3(made_random(h) - 0.5, made_random(h) - 0.5, made_random(h) - 0.5), e2 = {0};
    sn_vec3 e1 = sn_v3_unit(a);
    while (
        !sn_normal_towards(e1, sn_v3(made_random(h) - 0.5, made_random(h) - 0.5, made_random(h) - 0.5), &e2))
        ;
    return (sn_triad){e1, e2, sn_v3_cross(e1, e2)};
}

static sn_triad *random_frames(int32_t n, uint64_t seed)
{
    sn_triad *frame = malloc((size_t)n * sizeof *frame);
    for (int32_t v = 0; v < n; v++) frame[v] = random_frame(&seed);
    return frame;
}

static sn_triad *same_frames(int32_t n, sn_triad f)
{
    sn_triad *frame = malloc((size_t)n * sizeof *frame);
    for (int32_t v = 0; v < n; v++) frame[v] = f;
    return frame;
}

static const sn_triad axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/* ---- tensors ---- */

static void columns_of_the_frame_are_eigenvectors(void **state)
{
    (void)state;
    const double l[3] = {1, 4, 9};
    sn_triad *frame = random_frames(50, 12);
    double tensor[300];
    sn_tensor_field(frame, 50, l, tensor);
    for (int v = 0; v < 50; v++) {
        const double *a = tensor + 6 * v;
        const sn_vec3 axis[3] = {frame[v].e1, frame[v].e2, frame[v].e3};
        for (int k = 0; k < 3; k++) {
            sn_vec3 e = axis[k];
            sn_vec3 product =
                sn_v3(a[0] * e.x + a[1] * e.y + a[2] * e.z, a[1] * e.x + a[3] * e.y + a[4] * e.z,
                      a[2] * e.x + a[4] * e.y + a[5] * e.z);
            assert_true(sn_v3_dist(product, sn_v3_scale(l[k], e)) < 1e-13);
        }
    }
    free(frame);
    sn_tensor_field(&axes, 1, l, tensor);
    const double want[] = {1, 0, 0, 4, 0, 9};
    assert_memory_equal(tensor, want, sizeof want);
}

static void equal_eigenvalues_give_the_laplacian(void **state)
{
    (void)state;
    sn_tet_mesh m = shaken_box(5);
    sn_csr a = laplacian_of(&m);
    sn_triad *frame = random_frames(m.n_vert, 3);
    sn_csr one = anisotropic_of(&m, frame, (double[]){1, 1, 1}),
           three = anisotropic_of(&m, frame, (double[]){3, 3, 3});
    assert_same_entries(&a, &one, 1.0, 1e-13);
    assert_same_entries(&three, &a, 3.0, 1e-13);
    sn_csr_free(&a);
    sn_csr_free(&one);
    sn_csr_free(&three);
    free(frame);
    sn_tet_mesh_free(&m);
}

/* f' L f is the integral of grad f . A grad f, over the size of the mesh. */
static void energies_of_linear_functions(void **state)
{
    (void)state;
    sn_tet_mesh m = shaken_box(5);
    sn_triad *frame = same_frames(m.n_vert, axes);
    sn_csr a = anisotropic_of(&m, frame, (double[]){1, 4, 9});
    const sn_vec3 direction[4] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, -2, 3}};
    const double want[4] = {1, 4, 9, 1 + 16 + 81};
    double unit = sn_tet_mesh_volume(&m) / sn_box3_diagonal(sn_tet_mesh_bounds(&m));
    for (int i = 0; i < 4; i++) {
        double energy = 0.0;
        for (int32_t v = 0; v < a.n; v++)
            for (int64_t k = a.ptr[v]; k < a.ptr[v + 1]; k++)
                energy += a.val[k] * sn_v3_dot(direction[i], sn_tet_mesh_point(&m, v)) *
                          sn_v3_dot(direction[i], sn_tet_mesh_point(&m, a.idx[k]));
        assert_true(fabs(energy / (want[i] * unit) - 1.0) < 1e-10);
    }
    sn_csr_free(&a);
    free(frame);
    sn_tet_mesh_free(&m);
}

/* With x' = x / sqrt(l) the tensor becomes the identity: L_A(mesh) size = sqrt(l1 l2 l3) L(mesh') size'. */
static void a_tensor_is_a_stretch(void **state)
{
    (void)state;
    const double l[3] = {0.5, 2, 7};
    sn_tet_mesh m = shaken_box(5), stretched;
    sn_tet_mesh_init(&stretched);
    assert_int_equal(sn_tet_mesh_copy(&stretched, &m, NULL), SN_OK);
    for (int32_t v = 0; v < m.n_vert; v++)
        for (int k = 0; k < 3; k++) stretched.pos[3 * v + k] /= sqrt(l[k]);
    sn_triad *frame = same_frames(m.n_vert, axes);
    sn_csr a = anisotropic_of(&m, frame, l), b = laplacian_of(&stretched);
    double size = sn_box3_diagonal(sn_tet_mesh_bounds(&m)),
           size_b = sn_box3_diagonal(sn_tet_mesh_bounds(&stretched));
    assert_same_entries(&a, &b, sqrt(l[0] * l[1] * l[2]) * size_b / size, 1e-12);
    sn_csr_free(&a);
    sn_csr_free(&b);
    free(frame);
    sn_tet_mesh_free(&m);
    sn_tet_mesh_free(&stretched);
}

/* Mesh and frames turned together: nothing changes. Different frames at the corners, so the mean matters,
 * too. */
static void turning_everything_changes_nothing(void **state)
{
    (void)state;
    uint64_t h = 77;
    sn_triad turn = random_frame(&h);
    sn_tet_mesh m = shaken_box(4), turned;
    sn_tet_mesh_init(&turned);
    assert_int_equal(sn_tet_mesh_copy(&turned, &m, NULL), SN_OK);
    sn_triad *frame = random_frames(m.n_vert, 5), *other = malloc((size_t)m.n_vert * sizeof *other);
    for (int32_t v = 0; v < m.n_vert; v++) {
        sn_vec3 from[4] = {sn_tet_mesh_point(&m, v), frame[v].e1, frame[v].e2, frame[v].e3}, to[4];
        for (int k = 0; k < 4; k++)
            to[k] =
                sn_v3(sn_v3_dot(turn.e1, from[k]), sn_v3_dot(turn.e2, from[k]), sn_v3_dot(turn.e3, from[k]));
        sn_v3_store(turned.pos + 3 * v, to[0]);
        other[v] = (sn_triad){to[1], to[2], to[3]};
    }
    const double l[3] = {1, 8, 0.3};
    sn_csr a = anisotropic_of(&m, frame, l), b = anisotropic_of(&turned, other, l);
    double size = sn_box3_diagonal(sn_tet_mesh_bounds(&m)),
           size_b = sn_box3_diagonal(sn_tet_mesh_bounds(&turned)), unit = largest_entry(&a);
    assert_same_entries(&a, &b, size_b / size, 1e-12);
    for (int32_t v = 0; v < a.n; v++) {
        double sum = 0.0;
        for (int64_t k = a.ptr[v]; k < a.ptr[v + 1]; k++) {
            sum += a.val[k];
            assert_true(fabs(a.val[k] - a.val[sn_csr_find(&a, a.idx[k], v)]) < 1e-14 * unit);
        }
        assert_true(fabs(sum) < 1e-13 * unit);
    }
    sn_csr_free(&a);
    sn_csr_free(&b);
    free(frame);
    free(other);
    sn_tet_mesh_free(&m);
    sn_tet_mesh_free(&turned);
}

/* ---- frame fields ---- */

/* With free values everywhere: no vertex is held at 0. */
static sn_status harmonic_of(const sn_csr *l, const sn_run *run, sn_harmonic **h)
{
    int32_t *number = malloc((size_t)l->n * sizeof *number);
    for (int32_t v = 0; v < l->n; v++) number[v] = v;
    sn_status st = sn_harmonic_create(h, l, number, l->n, NULL, run, NULL);
    free(number);
    return st;
}

typedef struct spread { /* a shaken box with the frames of a muscle in it */
    sn_body body;
    sn_locator *locator;
    sn_muscle muscle;
    sn_paths paths;
    sn_collocation row;
    sn_triad *frame;
} spread;

static void make_spread(spread *s, const sn_head_points *head, int32_t n_head, const sn_anisotropy *a,
                        const sn_run *run)
{
    sn_tet_mesh m = shaken_box(8); /* (-1, 2, 3) to (3, 6, 7) */
    sn_harmonic *h = NULL;
    sn_error err = {.msg = ""};
    memset(s, 0, sizeof *s);
    sn_csr l = laplacian_of(&m);
    sn_body_init(&s->body);
    assert_int_equal(sn_body_from_tets(&m, SN_LABEL_SKIN, &s->body, NULL), SN_OK);
    assert_int_equal(sn_locator_create(&s->locator, &s->body.mesh, NULL), SN_OK);
    assert_int_equal(sn_muscle_init(&s->muscle, "m", head, n_head, NULL), SN_OK);
    assert_int_equal(sn_muscle_set_anisotropy(&s->muscle, a, NULL), SN_OK);
    assert_int_equal(sn_paths_build(&s->paths, &s->muscle, NULL), SN_OK);
    assert_int_equal(sn_collocate(&s->muscle, &s->body, s->locator, &s->row, NULL, NULL), SN_OK);
    assert_int_equal(harmonic_of(&l, run, &h), SN_OK);
    s->frame = malloc((size_t)m.n_vert * sizeof *s->frame);
    if (sn_frame_field(h, &s->body.mesh, &s->row, &s->paths, run, s->frame, &err)) fail_msg("%s", err.msg);
    for (int32_t v = 0; v < m.n_vert; v++) {
        sn_triad f = s->frame[v];
        assert_true(fabs(sn_v3_len(f.e1) - 1.0) < 1e-14 && fabs(sn_v3_len(f.e2) - 1.0) < 1e-14);
        assert_true(fabs(sn_v3_dot(f.e1, f.e2)) < 1e-13);
        assert_true(sn_v3_dist(sn_v3_cross(f.e1, f.e2), f.e3) < 1e-13);
    }
    sn_harmonic_destroy(h);
    sn_csr_free(&l);
    sn_tet_mesh_free(&m);
}

static void free_spread(spread *s)
{
    free(s->frame);
    sn_collocation_free(&s->row);
    sn_paths_free(&s->paths);
    sn_muscle_free(&s->muscle);
    sn_locator_destroy(s->locator);
    sn_body_free(&s->body);
}

static void frames_of_a_straight_curve_are_constant(void **state)
{
    (void)state;
    const double along_z[] = {0.8, 3.7, 3.2, 0.8, 3.7, 6.7};
    const double c = cos(TEST_PI / 6), s = sin(TEST_PI / 6);
    spread x;
    make_spread(&x, &(sn_head_points){along_z, NULL, 2}, 1,
                &(sn_anisotropy){true, 30, {1, 2, 3}, true, {0, 5, 5}}, NULL);
    for (int32_t v = 0; v < x.body.mesh.n_vert; v++) { /* e2 from y towards e3 = z cross y = -x */
        assert_true(sn_v3_dist(x.frame[v].e1, sn_v3(0, 0, 1)) < 1e-9);
        assert_true(sn_v3_dist(x.frame[v].e2, sn_v3(-s, c, 0)) < 1e-9);
    }
    free_spread(&x);
}

/* The corners of crossed tets have the frame of the nearest row; in between it turns as the curve does. */
static void frames_follow_a_curve(void **state)
{
    (void)state;
    const double bend[] = {-0.5, 2.5, 5, 1.5, 2.8, 5, 2.5, 4, 5, 2.4, 5.6, 5};
    const sn_head_points head = {bend, NULL, 4};
    const sn_anisotropy a = {true, 0, {1, 2, 3}, true, {0, 0, 1}};
    spread x, again;
    make_spread(&x, &head, 1, &a, &(sn_run){.n_threads = 1});
    const sn_tet_mesh *m = &x.body.mesh;
    for (int32_t r = 0; r < x.row.n_row; r++)
        for (int k = 0; k < 4; k++) {
            int32_t v = m->tet[4 * x.row.tet[r] + k], near = 0;
            double least = INFINITY;
            for (int32_t q = 0; q < x.row.n_row; q++) {
                sn_vec3 at = sn_path_point(&x.paths.head[0], x.row.arc[q]);
                if (sn_v3_dist(at, sn_tet_mesh_point(m, v)) >= least) continue;
                least = sn_v3_dist(at, sn_tet_mesh_point(m, v));
                near = q;
            }
            sn_triad want = sn_path_frame(&x.paths.head[0], x.row.arc[near]);
            assert_true(sn_v3_dist(x.frame[v].e1, want.e1) < 0.05); /* rows nearly as near may be taken */
            assert_true(sn_v3_dist(x.frame[v].e2, sn_v3(0, 0, 1)) < 1e-9);
        }
    for (int32_t v = 0; v < m->n_vert; v++) { /* from along x to along y, never back */
        sn_vec3 e1 = x.frame[v].e1;
        assert_true(sn_v3_dist(x.frame[v].e2, sn_v3(0, 0, 1)) < 1e-5 && fabs(e1.z) < 1e-5 && e1.y > -0.1);
    }
    make_spread(&again, &head, 1, &a, &(sn_run){.n_threads = 2});
    assert_memory_equal(again.frame, x.frame, (size_t)m->n_vert * sizeof *x.frame);
    free_spread(&again);
    free_spread(&x);
}

/* Two heads side by side, one up and one down: half way the fields cancel out, and a frame is there all the
 * same. */
static void frames_that_cancel_out(void **state)
{
    (void)state;
    const double up[] = {0, 4, 3.3, 0, 4, 6.7}, down[] = {2, 4, 6.7, 2, 4, 3.3};
    spread x;
    int n_up = 0, n_down = 0;
    make_spread(&x, (sn_head_points[]){{up, NULL, 2}, {down, NULL, 2}}, 2,
                &(sn_anisotropy){true, 0, {1, 2, 3}, true, {0, 1, 0}}, NULL);
    for (int32_t v = 0; v < x.body.mesh.n_vert; v++) {
        sn_vec3 e1 = x.frame[v].e1;
        assert_true(sn_v3_dist(x.frame[v].e2, sn_v3(0, 1, 0)) < 1e-6);
        assert_true(fabs(e1.y) < 1e-6);
        n_up += e1.z > 0.9;
        n_down += e1.z < -0.9;
        if (x.body.mesh.pos[3 * v] < 0.0) assert_true(e1.z > 0.99);
        if (x.body.mesh.pos[3 * v] > 2.0) assert_true(e1.z < -0.99);
    }
    assert_true(n_up > 200 && n_down > 200);
    free_spread(&x);
}

static void short_of_memory(void **state)
{
    (void)state;
    const double along_z[] = {0.8, 3.7, 3.2, 0.8, 3.7, 6.7};
    spread x;
    make_spread(&x, &(sn_head_points){along_z, NULL, 2}, 1,
                &(sn_anisotropy){true, 0, {1, 2, 3}, false, {0, 0, 0}}, NULL);
    sn_csr l = laplacian_of(&x.body.mesh);
    sn_harmonic *h = NULL;
    sn_error err;
    sn_run run = {.n_threads = 1};
    assert_int_equal(harmonic_of(&l, NULL, &h), SN_OK);
    sn_status st = SN_ENOMEM;
    int n = 0;
    for (; st; n++) {
        ration r = {n, 0};
        sn_set_allocator(RATION(r));
        st = sn_frame_field(h, &x.body.mesh, &x.row, &x.paths, &run, x.frame, &err);
        sn_set_allocator(NULL);
        if (st) assert_int_equal(st, SN_ENOMEM);
        if (st) assert_non_null(strstr(err.msg, "no memory"));
        assert_int_equal(r.in_use, 0);
        assert_true(n < 60);
    }
    assert_true(n > 8);
    volatile sig_atomic_t cancel = 1;
    run.cancel = &cancel;
    assert_int_equal(sn_frame_field(h, &x.body.mesh, &x.row, &x.paths, &run, x.frame, &err), SN_ECANCEL);
    sn_harmonic_destroy(h);
    sn_csr_free(&l);
    free_spread(&x);
}

/* ---- in a scene ---- */

static void set_frame(sn_scene *s, int32_t i, double angle, double l1, double l2, double l3)
{
    sn_error err = {.msg = ""};
    const sn_anisotropy a = {true, angle, {l1, l2, l3}, true, {1, 0, 0}};
    if (sn_scene_set_anisotropy(s, i, &a, &err)) fail_msg("%s", err.msg);
}

static void equal_eigenvalues_change_nothing(void **state)
{
    (void)state;
    sn_scene *s = made_limb();
    solve_scene(s);
    double *before = copy_fields(s);
    set_frame(s, FLEXOR, 37.0, 1, 1, 1);
    sn_solve_report r = solve_scene(s);
    assert_int_equal(r.n_anisotropic, 0); /* known without solving with a tensor */
    assert_true(largest_difference(s, before) < 1e-10);
    set_frame(s, FLEXOR, 37.0, 1, 1 + 1e-14, 1);
    r = solve_scene(s);
    assert_int_equal(r.n_anisotropic, 1);
    assert_false(r.was_factorized);
    assert_true(largest_difference(s, before) < 1e-10);
    set_frame(s, FLEXOR, 37.0, 1, 4, 1);
    solve_scene(s);
    assert_true(largest_difference(s, before) > 1e-3);
    assert_int_equal(sn_scene_set_anisotropy(s, FLEXOR, &(sn_anisotropy){0}, NULL), SN_OK);
    r = solve_scene(s);
    assert_int_equal(r.n_anisotropic, 0);
    assert_true(largest_difference(s, before) < 1e-10);
    sn_release(before);
    sn_scene_destroy(s);
}

static void only_the_muscle_itself_changes(void **state)
{
    (void)state;
    sn_scene *s = made_limb();
    solve_scene(s);
    double *before = copy_fields(s);
    size_t row = (size_t)sn_scene_body(s)->mesh.n_vert;
    uint64_t revision = sn_scene_revision(s);
    set_frame(s, EXTENSOR, 20.0, 2, 8, 1);
    assert_null(sn_scene_fields(s));
    assert_true(sn_scene_revision(s) > revision);
    sn_solve_report r = solve_scene(s);
    assert_false(r.was_meshed || r.was_factorized);
    assert_int_equal(r.tissue.n_solved, 1);
    assert_int_equal(r.n_anisotropic, 1);
    const double *after = sn_scene_fields(s);
    assert_memory_equal(before, after, 2 * row * sizeof *after);                 /* fat, flexor */
    assert_memory_equal(before + 3 * row, after + 3 * row, row * sizeof *after); /* abductor */
    assert_memory_not_equal(before + 2 * row, after + 2 * row, row * sizeof *after);
    revision = sn_scene_revision(s);
    set_frame(s, EXTENSOR, 20.0, 2, 8, 1); /* the same again: nothing to do */
    assert_non_null(sn_scene_fields(s));
    assert_int_equal(sn_scene_revision(s), revision);
    double *anisotropic = copy_fields(s);
    assert_int_equal(sn_scene_set_tissue(s, EXTENSOR, -1, -1, 3.0, NULL), SN_OK);
    r = solve_scene(s); /* a right-hand side needs its factor again */
    assert_int_equal(r.tissue.n_solved, 1);
    assert_int_equal(r.n_anisotropic, 1);
    assert_int_equal(sn_scene_set_tissue(s, EXTENSOR, 0, 0, 1.0, NULL), SN_OK);
    assert_int_equal(sn_scene_set_tissue(s, EXTENSOR, 0, 1, 1.5, NULL), SN_OK);
    assert_int_equal(sn_scene_set_tissue(s, EXTENSOR, 0, 2, 1.0, NULL), SN_OK);
    solve_scene(s);
    assert_memory_equal(anisotropic + 2 * row, sn_scene_fields(s) + 2 * row, row * sizeof *after);
    sn_release(anisotropic);
    sn_release(before);
    sn_scene_destroy(s);
}

/* Whatever comes first: a frame set before the first solve, on a body meshed again, after a point went there
 * and back. */
static void the_order_of_edits_does_not_matter(void **state)
{
    (void)state;
    sn_scene *s = made_limb();
    set_frame(s, FLEXOR, 10.0, 1, 3, 1);
    set_frame(s, ABDUCTOR, -50.0, 1, 1, 5);
    sn_solve_report r = solve_scene(s);
    assert_int_equal(r.tissue.n_solved, 4);
    assert_int_equal(r.n_anisotropic, 2);
    double *first = copy_fields(s);
    sn_vec3 home = sn_v3_load(sn_scene_muscle(s, FLEXOR)->head[0].point + 3);
    assert_int_equal(sn_scene_set_point(s, FLEXOR, 0, 1, sn_v3(0.1, 0.1, 0.5), NULL), SN_OK);
    solve_scene(s);
    assert_true(largest_difference(s, first) > 1e-3);
    assert_int_equal(sn_scene_set_point(s, FLEXOR, 0, 1, home, NULL), SN_OK);
    solve_scene(s);
    assert_memory_equal(first, sn_scene_fields(s), fields_size(s));
    sn_tri_mesh skin;
    sn_tri_mesh_init(&skin);
    assert_int_equal(sn_tri_mesh_copy(&skin, sn_scene_skin(s), NULL), SN_OK);
    assert_int_equal(sn_scene_set_skin(s, &skin, NULL), SN_OK);
    r = solve_scene(s);
    assert_true(r.was_meshed);
    assert_memory_equal(first, sn_scene_fields(s), fields_size(s));
    assert_int_equal(sn_scene_set_alpha(s, 6, NULL), SN_OK);
    assert_int_equal(sn_scene_set_alpha(s, 5, NULL), SN_OK);
    assert_int_equal(sn_scene_solve(s, &(sn_run){.n_threads = 1}, NULL, NULL), SN_OK);
    assert_memory_equal(first, sn_scene_fields(s), fields_size(s));
    sn_tri_mesh_free(&skin);
    sn_release(first);
    sn_scene_destroy(s);
}

/* Second moments of a muscle's region about its centroid, along x and z. */
static void widths(sn_scene *s, double *along_x, double *along_z)
{
    sn_extraction x;
    sn_vec3 sum = {0};
    double volume = 0.0;
    sn_extraction_init(&x);
    assert_int_equal(sn_scene_extract(s, NULL, NULL, &x, NULL), SN_OK);
    *along_x = *along_z = 0.0;
    for (int pass = 0; pass < 2; pass++)
        for (int32_t t = 0; t < x.mesh.n_tet; t++) {
            if (x.mesh.part[t] != 1) continue;
            double part = sn_tet_mesh_tet_volume(&x.mesh, t);
            sn_vec3 c = {0};
            for (int k = 0; k < 4; k++)
                c = sn_v3_mad(c, 0.25, sn_tet_mesh_point(&x.mesh, x.mesh.tet[4 * (size_t)t + (size_t)k]));
            if (pass == 0) {
                sum = sn_v3_mad(sum, part, c);
                volume += part;
                continue;
            }
            *along_x += part * pow(c.x - sum.x / volume, 2.0) / volume;
            *along_z += part * pow(c.z - sum.z / volume, 2.0) / volume;
        }
    sn_extraction_free(&x);
}

/* A muscle straight up the middle of a round limb is round; faster along e2 makes it wide there. */
static void faster_means_wider(void **state)
{
    (void)state;
    const double up[] = {0, -0.8, 0, 0, 0.8, 0};
    double x, z, other_x, other_z;
    sn_scene *s = scene_with_skin(0.9);
    mesh_scene(s, 0.18);
    assert_int_equal(sn_scene_add_muscle(s, "m", up, NULL, 2, NULL), SN_OK);
    widths(s, &x, &z);
    assert_true(fabs(x / z - 1.0) < 0.1);
    set_frame(s, 0, 0.0, 1, 8, 1); /* e2 along x */
    widths(s, &x, &z);
    assert_true(x > 1.5 * z);
    set_frame(s, 0, 90.0, 1, 8, 1); /* and turned about the curve: along z */
    widths(s, &other_x, &other_z);
    assert_true(other_z > 1.5 * other_x);
    assert_true(fabs(other_z / x - 1.0) < 0.1 && fabs(other_x / z - 1.0) < 0.1);
    set_frame(s, 0, 0.0, 1, 1, 8); /* the same by the third eigenvalue */
    widths(s, &x, &z);
    assert_true(fabs(other_z / z - 1.0) < 1e-6 && fabs(other_x / x - 1.0) < 1e-6);
    sn_scene_destroy(s);
}

static void frames_short_of_memory(void **state)
{
    (void)state;
    sn_scene *s = made_limb();
    set_frame(s, FLEXOR, 10.0, 1, 3, 1);
    solve_scene(s);
    double *before = copy_fields(s);
    sn_run run = {.n_threads = 1};
    sn_status st = SN_ENOMEM;
    int left = 0;
    for (; st == SN_ENOMEM; left++) {
        sn_error err = {0};
        ration r = {.left = left};
        set_frame(s, FLEXOR, 20.0, 1, 3, 1);
        set_frame(s, FLEXOR, 10.0, 1, 3, 1);
        sn_set_allocator(RATION(r));
        st = sn_scene_solve(s, &run, NULL, &err);
        sn_set_allocator(NULL);
        if (st) assert_non_null(strstr(err.msg, "memory"));
        if (st) assert_null(sn_scene_fields(s));
    }
    assert_int_equal(st, SN_OK);
    assert_true(left > 15);
    assert_memory_equal(before, sn_scene_fields(s), fields_size(s));
    sn_release(before);
    sn_scene_destroy(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(columns_of_the_frame_are_eigenvectors),
        cmocka_unit_test(equal_eigenvalues_give_the_laplacian),
        cmocka_unit_test(energies_of_linear_functions),
        cmocka_unit_test(a_tensor_is_a_stretch),
        cmocka_unit_test(turning_everything_changes_nothing),
        cmocka_unit_test(frames_of_a_straight_curve_are_constant),
        cmocka_unit_test(frames_follow_a_curve),
        cmocka_unit_test(frames_that_cancel_out),
        cmocka_unit_test(short_of_memory),
        cmocka_unit_test(equal_eigenvalues_change_nothing),
        cmocka_unit_test(only_the_muscle_itself_changes),
        cmocka_unit_test(the_order_of_edits_does_not_matter),
        cmocka_unit_test(faster_means_wider),
        cmocka_unit_test(frames_short_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
