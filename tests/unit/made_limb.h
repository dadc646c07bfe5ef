/* made_limb.h - a scene that tests make: a limb of some thousand tets, two bones, three muscles along it. */
#ifndef SN_TESTS_MADE_LIMB_H
#define SN_TESTS_MADE_LIMB_H

#include "scene/scene.h"

#include "made_mesh.h"

enum { FLEXOR, EXTENSOR, ABDUCTOR }; /* its muscles, in the order added */

/* Small steps by the thousand: other tests run beside this one, and threads that wait for a core make it
 * slow. */
static const sn_run one_thread = {.n_threads = 1};

static inline sn_scene *scene_with_skin(double radius)
{
    sn_scene *s = NULL;
    sn_tri_mesh skin = made_capsule(sn_v3(0, -1.2, 0), sn_v3(0, 1.2, 0), radius, 0.3);
    assert_int_equal(sn_scene_create(&s, "limb", "cm", SN_UP_Y, NULL), SN_OK);
    assert_int_equal(sn_scene_set_skin(s, &skin, NULL), SN_OK);
    sn_tri_mesh_free(&skin);
    return s;
}

static inline void mesh_scene(sn_scene *s, double edge_length)
{
    sn_error err = {.msg = ""};
    if (sn_scene_tetrahedralize(s, &(sn_body_options){.edge_length = edge_length}, NULL, NULL, &err))
        fail_msg("%s", err.msg);
}

static inline sn_scene *made_limb(void)
{
    static const double front[] = {0, -1, 0.5, 0, 0, 0.6, 0, 1, 0.5},
                        back[] = {0, -1, -0.5, 0, 0, -0.6, 0, 1, -0.5},
                        side[] = {0.55, -0.8, 0, 0.55, 0.8, 0};
    sn_scene *s = scene_with_skin(0.9);
    sn_tri_mesh upper = made_capsule(sn_v3(0, 0.3, 0), sn_v3(0, 1.2, 0), 0.2, 0.2);
    sn_tri_mesh lower = made_capsule(sn_v3(0, -1.2, 0), sn_v3(0, -0.3, 0), 0.2, 0.2);
    assert_int_equal(sn_scene_add_bone(s, "upper", &upper, NULL), SN_OK);
    assert_int_equal(sn_scene_add_bone(s, "lower", &lower, NULL), SN_OK);
    assert_int_equal(sn_scene_add_muscle(s, "flexor", front, NULL, 3, NULL), SN_OK);
    assert_int_equal(sn_scene_add_muscle(s, "extensor", back, (double[]){1, 1.5, 1}, 3, NULL), SN_OK);
    assert_int_equal(sn_scene_add_muscle(s, "abductor", side, NULL, 2, NULL), SN_OK);
    sn_tri_mesh_free(&upper);
    sn_tri_mesh_free(&lower);
    mesh_scene(s, 0.3);
    return s;
}

static inline sn_solve_report solve_scene(sn_scene *s)
{
    sn_solve_report r = {0};
    sn_error err = {.msg = ""};
    if (sn_scene_solve(s, &one_thread, &r, &err)) fail_msg("%s", err.msg);
    assert_non_null(sn_scene_fields(s));
    assert_true(r.tissue.residual < 1e-8);
    return r;
}

static inline size_t fields_size(const sn_scene *s) /* bytes */
{
    return (size_t)sn_scene_tissue_count(s) * (size_t)sn_scene_body(s)->mesh.n_vert * sizeof(double);
}

/* A copy to compare with later; sn_release it. */
static inline double *copy_fields(const sn_scene *s)
{
    double *copy = sn_alloc(fields_size(s), 1);
    assert_non_null(copy);
    assert_non_null(sn_scene_fields(s));
    memcpy(copy, sn_scene_fields(s), fields_size(s));
    return copy;
}

static inline double largest_difference(const sn_scene *s, const double *a)
{
    const double *b = sn_scene_fields(s);
    double d = 0.0;
    for (size_t k = 0; k < fields_size(s) / sizeof *a; k++) d = fmax(d, fabs(a[k] - b[k]));
    return d;
}

#endif
