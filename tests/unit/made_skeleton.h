/* made_skeleton.h - the bone library, scenes to put its bones into, and asserts. */
#ifndef SN_TESTS_MADE_SKELETON_H
#define SN_TESTS_MADE_SKELETON_H

#include "asserts.h"
#include "made_mesh.h"
#include "scene/scene_bones.h"
#include "skeleton/bone_library.h"

/* ---- the library: make_library and free_library are the group's setup and teardown ---- */

static sn_bone_library *library;

static inline int make_library(void **state)
{
    (void)state;
    return sn_bone_library_create(&library, NULL) != SN_OK;
}

static inline int free_library(void **state)
{
    (void)state;
    sn_bone_library_destroy(library);
    return 0;
}

static inline const sn_bone_template *template(const char *name)
{
    const sn_bone_template *t;
    ok(sn_bone_library_find(library, name, &t, &err));
    return t;
}

static inline sn_scene *new_scene(const char *unit, sn_up up)
{
    sn_scene *s = NULL;
    ok(sn_scene_create(&s, "made", unit, up, &err));
    return s;
}

static inline int32_t place_between(sn_scene *s, const char *name, const char *of, sn_vec3 from, sn_vec3 to)
{
    sn_bone_placing p = {.name = name, .from_template = template(of)};
    sn_pick a = {.origin = from}, b = {.origin = to};
    ok(sn_scene_place_cylinder(s, &p, &a, &b, &(sn_cylinder_placing){0}, NULL, NULL, &err));
    return sn_scene_bone_count(s) - 1;
}

static inline int32_t place_at(sn_scene *s, const char *name, const char *of, sn_vec3 where)
{
    sn_bone_placing p = {.name = name, .from_template = template(of)};
    ok(sn_scene_place_shape(s, &p, &(sn_pick){.origin = where}, &(sn_shape_options){0}, NULL, NULL, NULL,
                            &err));
    return sn_scene_bone_count(s) - 1;
}

static inline sn_vec3 landmark(const sn_scene *s, int32_t i, const char *name)
{
    sn_landmark l;
    ok(sn_scene_bone_landmark(s, i, name, &l, &err));
    return l.at;
}

static inline void assert_same_mesh(const sn_tri_mesh *a, const sn_tri_mesh *b, double tolerance)
{
    assert_int_equal(a->n_vert, b->n_vert);
    assert_int_equal(a->n_face, b->n_face);
    assert_memory_equal(a->face, b->face, 3 * (size_t)a->n_face * sizeof *a->face);
    for (int32_t v = 0; v < a->n_vert; v++)
        assert_at(sn_tri_mesh_point(a, v), sn_tri_mesh_point(b, v), tolerance);
}

#endif
