/* test_bone_template - templates: their two texts, what is checked, and the library of them. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "asserts.h"
#include "failing_memory.h"
#include "made_mesh.h"
#include "mesh/mesh_check.h"
#include "skeleton/bone_library.h"

#include <stdio.h>

/* ---- texts ---- */

/* A tetrahedron as `o NAME`; its corners come after `before` other vertices. */
#define CORNERS "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
#define FACES "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
#define BONE "o bone\n" CORNERS FACES
#define CAGE "o cage\nv -1 -1 -1\nv 5 -1 -1\nv -1 5 -1\nv -1 -1 5\nf 5 7 6\nf 5 6 8\nf 6 7 8\nf 5 8 7\n"
#define SKIN "o skin\nv 0 0 2\nv 1 0 2\nv 0 1 2\nf 9 10 11\n"
#define CYLINDER "kind cylinder\nfrom 0 1 0\nto 0 0 0\n"

static void parses(const char *text, const char *obj, sn_bone_template *t)
{
    sn_error err = {.msg = ""};
    if (sn_bone_template_parse(t, "thing", text, obj, &err)) fail_msg("%s", err.msg);
    assert_string_equal(t->name, "thing");
}

static void cylinders_are_read(void **state)
{
    (void)state;
    sn_bone_template t;
    parses("# a bone\n\n kind\tcylinder # of the arm\r\nfrom 0 1e0 0\nto 0 -.5 0.25\n"
           "landmark tip 1 0 0 0.125\njoint knee 0 0 1",
           "# made by hand\n" BONE, &t);
    assert_int_equal(t.kind, SN_BONE_CYLINDER);
    assert_at(t.from, sn_v3(0, 1, 0), 0.0);
    assert_at(t.to, sn_v3(0, -0.5, 0.25), 0.0);
    assert_int_equal(t.n_landmark, 2);
    assert_string_equal(t.landmark[0].name, "tip");
    assert_at(t.landmark[0].at, sn_v3(1, 0, 0), 0.0);
    assert_near(t.landmark[0].radius, 0.125, 0.0);
    assert_string_equal(t.landmark[1].name, "knee");
    assert_near(t.landmark[1].radius, 0.0, 0.0);
    assert_int_equal(t.bone.n_vert, 4);
    assert_int_equal(t.bone.n_face, 4);
    assert_near(sn_tri_mesh_volume(&t.bone), 1.0 / 6.0, 1e-15);
    assert_int_equal(t.cage.n_face + t.skin.n_face, 0);
    sn_bone_template_free(&t);
    assert_null(t.name);
    sn_bone_template_free(&t);
}

static void curve_bones_are_read(void **state)
{
    (void)state;
    sn_bone_template t;
    parses("length 0.025\nkind curve\n", BONE, &t);
    assert_int_equal(t.kind, SN_BONE_CURVE);
    assert_near(t.length, 0.025, 0.0);
    assert_int_equal(t.n_landmark, 0);
    sn_bone_template_free(&t);
}

/* Indices are counted through the surfaces of the file. */
static void shapes_are_read(void **state)
{
    (void)state;
    sn_bone_template t;
    parses("kind shape", BONE CAGE SKIN, &t);
    assert_int_equal(t.kind, SN_BONE_SHAPE);
    assert_int_equal(t.cage.n_face, 4);
    assert_near(sn_tri_mesh_volume(&t.cage), 36.0, 1e-12);
    assert_int_equal(t.skin.n_vert, 3);
    assert_at(sn_tri_mesh_face_normal(&t.skin, 0), sn_v3(0, 0, 1), 0.0);
    sn_bone_template_free(&t);
}

static void wrong_texts_are_told(void **state)
{
    (void)state;
    char long_name[200], text[300];
    memset(long_name, 'x', 65);
    long_name[65] = '\0';
    (void)snprintf(text, sizeof text, "kind shape\nlandmark %s 0 0 0 1\n", long_name);
    const struct {
        const char *text, *obj, *says;
    } bad[] = {
        {"kind sphere", BONE, "template 'thing', text, line 1: need cylinder, curve or shape"},
        {"kind shape\n\nkind", BONE, "text, line 3: need cylinder, curve or shape"},
        {"kind shape\nsize 3", BONE, "line 2: need kind, from, to, length, landmark or joint"},
        {"kinds shape", BONE, "line 1: need kind, from, to, length, landmark or joint"},
        {"kind shape extra", BONE, "line 1: need the end of the line"},
        {"kind curve\nlength", BONE, "line 2: need a number"},
        {"kind curve\nlength long", BONE, "line 2: need a number"},
        {"kind curve\nlength inf", BONE, "line 2: need a number"},
        {"kind curve\nlength 1 2", BONE, "line 2: need the end of the line"},
        {"from 0 1\nto 0 0 0", BONE, "line 1: need a number"},
        {"to 0 0 nan", BONE, "line 1: need a number"},
        {"kind shape\nlandmark", BONE, "line 2: need a name of 1..64 characters"},
        {text, BONE, "line 2: need a name of 1..64 characters"},
        {"kind shape\nlandmark a 1 2 3", BONE, "line 2: need a number"},
        {"kind shape\njoint a 1 2", BONE, "line 2: need a number"},
        {"kind shape\njoint a 1 2 3 4", BONE, "line 2: need the end of the line"},
        {"kind shape", "v 0 0 x\n", "template 'thing', surfaces, line 1: need a number"},
        {"kind shape", "v 0 0 0\nf 1 1\n", "surfaces, line 2: need a number"},
        {"kind shape", CORNERS "f 1 2 3 4\n", "surfaces, line 5: need a triangle"},
        {"kind shape", CORNERS "f 1 2 5\n", "line 5: need the index of a vertex of the same surface"},
        {"kind shape", CORNERS "f 1 2 0\n", "line 5: need the index of a vertex of the same surface"},
        {"kind shape", CORNERS "f 1 2 1.5\n", "line 5: need the index of a vertex of the same surface"},
        {"kind shape", BONE "o cage\n" CORNERS "f 1 7 6\n",
         "line 15: need the index of a vertex of the same"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        sn_bone_template t;
        sn_error err = {.msg = ""};
        sn_status st = sn_bone_template_parse(&t, "thing", bad[i].text, bad[i].obj, &err);
        assert_says(err, bad[i].says);
        assert_int_equal(st, SN_EFORMAT);
        assert_null(t.name);
        assert_null(t.bone.pos);
        assert_null(t.landmark);
    }
}

/* ---- what is checked ---- */

static void wrong_templates_are_told(void **state)
{
    (void)state;
    static const struct {
        const char *text, *obj, *says;
    } bad[] = {
        {"kind shape", "", "template 'thing': bone: "},
        {"kind shape", "o bone\n" CORNERS, "template 'thing': bone: "},
        {"kind shape", "o bone\n" CORNERS "f 1 3 2\nf 1 2 4\nf 2 3 4\n",
         "template 'thing': the bone is not a closed surface with its faces outwards (surface:check() tells, "
         "surface:repair{} may mend it)"},
        {"kind shape", "o bone\n" CORNERS "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 1 3 4\n", "with its faces outwards"},
        {"kind shape", "o bone\n" CORNERS "f 1 2 3\nf 1 2 4\nf 2 3 4\nf 1 4 3\n", "with its faces outwards"},
        {"kind cylinder", BONE, "template 'thing': its ends 'from' and 'to' are one point"},
        {"from 0 0 0\nto 0 1e-9 0", BONE, "its ends 'from' and 'to' are one point"},
        {"kind curve", BONE, "template 'thing': its length along the curve is 0, need > 0"},
        {"kind curve\nlength -2", BONE, "its length along the curve is -2, need > 0"},
        {"kind shape\nlandmark a 0 0 0 -1", BONE,
         "template 'thing': landmark 'a' is not a finite point and radius"},
        {"kind shape\nlandmark a 0 0 0 1\njoint b 0 0 0\njoint a 0 0 0", BONE,
         "template 'thing': landmark 'a' is there twice"},
        {"kind shape", BONE CAGE, "template 'thing': it has a cage but no skin: fitting needs both"},
        {"kind shape", BONE "o skin\nv 0 0 2\nv 1 0 2\nv 0 1 2\nf 5 6 7\n",
         "template 'thing': it has a skin but no cage: fitting needs both"},
        {"kind shape", BONE "o cage\n" CORNERS "f 5 7 6\n" SKIN, "the cage is not a closed surface"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        sn_bone_template t;
        sn_error err = {.msg = ""};
        sn_status st = sn_bone_template_parse(&t, "thing", bad[i].text, bad[i].obj, &err);
        assert_says(err, bad[i].says);
        assert_int_equal(st, SN_EINVAL);
        assert_null(t.name);
    }
}

/* What no text can hold, but a program can. */
static void numbers_that_are_not_finite_are_told(void **state)
{
    (void)state;
    sn_bone_template t;
    sn_error err = {.msg = ""};
    parses("kind shape\nlandmark a 0 0 0 1", BONE CAGE SKIN, &t);
    t.landmark[0].radius = NAN;
    assert_int_equal(sn_bone_template_check(&t, &err), SN_EINVAL);
    assert_says(err, "landmark 'a' is not a finite point and radius");
    t.landmark[0].radius = 1.0;
    t.landmark[0].at.y = INFINITY;
    assert_int_equal(sn_bone_template_check(&t, &err), SN_EINVAL);
    t.landmark[0].at.y = 0.0;
    t.kind = SN_BONE_CURVE;
    t.length = INFINITY;
    assert_int_equal(sn_bone_template_check(&t, &err), SN_EINVAL);
    t.kind = SN_BONE_CYLINDER;
    t.from.x = NAN;
    assert_int_equal(sn_bone_template_check(&t, &err), SN_EINVAL);
    assert_says(err, "are one point");
    t.kind = SN_BONE_SHAPE;
    assert_int_equal(sn_bone_template_check(&t, &err), SN_OK);
    t.skin.pos[0] = NAN;
    assert_int_equal(sn_bone_template_check(&t, &err), SN_EINVAL);
    sn_bone_template_free(&t);
}

/* ---- turned into the frame of curve bones ---- */

static void templates_are_aligned(void **state)
{
    (void)state;
    sn_bone_template t;
    parses("kind curve\nlength 1\nlandmark top 1 2 5 0.5\nlandmark nose 3 2 4 0.5", BONE, &t);
    t.length = 0.0;
    double volume = sn_tri_mesh_volume(&t.bone);
    sn_vec3 corner = sn_tri_mesh_point(&t.bone, 1);
    /* along z, its front along x */
    assert_int_equal(sn_bone_template_align(&t, sn_v3(1, 2, 3), sn_v3(1, 2, 5), sn_v3(4, 0, 1), NULL), SN_OK);
    assert_near(t.length, 2.0, 1e-15);
    assert_at(t.landmark[0].at, sn_v3(0, 1, 0), 1e-15);
    assert_at(t.landmark[1].at, sn_v3(0, 0, 2), 1e-15);
    assert_at(sn_tri_mesh_point(&t.bone, 1), sn_v3(corner.y - 2, corner.z - 4, corner.x - 1), 1e-14);
    assert_near(sn_tri_mesh_volume(&t.bone), volume, 1e-14);
    t.length = 0.75; /* set: stays */
    assert_int_equal(sn_bone_template_align(&t, sn_v3(0, -3, 0), sn_v3(0, 3, 0), sn_v3(0, 0, 1), NULL),
                     SN_OK);
    assert_near(t.length, 0.75, 0.0);
    assert_at(t.landmark[0].at, sn_v3(0, 1, 0), 1e-15);
    static const sn_vec3 bad[][3] = {{{1, 1, 1}, {1, 1, 1}, {0, 0, 1}},
                                     {{0, 0, 0}, {0, 1, 0}, {0, -3, 0}},
                                     {{0, 0, 0}, {0, 1, 0}, {0, 0, 0}},
                                     {{0, 0, 0}, {0, NAN, 0}, {0, 0, 1}}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        sn_error err = {.msg = ""};
        assert_int_equal(sn_bone_template_align(&t, bad[i][0], bad[i][1], bad[i][2], &err), SN_EINVAL);
        assert_string_equal(err.msg,
                            "template 'thing': 'from' and 'to' must be two points, and 'front' across "
                            "their line");
        assert_at(t.landmark[0].at, sn_v3(0, 1, 0), 1e-15);
    }
    sn_bone_template_free(&t);
}

/* ---- the library ---- */

static sn_bone_library *new_library(void)
{
    sn_bone_library *l = NULL;
    assert_int_equal(sn_bone_library_create(&l, NULL), SN_OK);
    return l;
}

static const sn_bone_template *found(sn_bone_library *l, const char *name)
{
    const sn_bone_template *t = NULL;
    sn_error err = {.msg = ""};
    if (sn_bone_library_find(l, name, &t, &err)) fail_msg("%s", err.msg);
    assert_string_equal(t->name, name);
    return t;
}

static void every_bone_of_the_library_is_sound(void **state)
{
    (void)state;
    sn_bone_library *l = new_library();
    int32_t n = sn_bone_library_count(l), n_kind[3] = {0};
    assert_true(n >= 22);
    for (int32_t i = 0; i < n; i++) {
        const sn_bone_template *t = found(l, sn_bone_library_name(l, i));
        sn_mesh_check r;
        if (i > 0) assert_true(strcmp(sn_bone_library_name(l, i - 1), t->name) < 0);
        assert_int_equal(sn_bone_template_check(t, NULL), SN_OK);
        assert_int_equal(sn_mesh_check_topology(&r, &t->bone, NULL), SN_OK);
        assert_true(r.closed && r.manifold && r.oriented && r.components == 1);
        assert_int_equal(t->kind == SN_BONE_SHAPE, t->cage.n_face > 0);
        double size = sn_box3_diagonal(sn_tri_mesh_bounds(&t->bone));
        assert_true(size > 0.01 && size < 0.7); /* metres */
        assert_true(t->n_landmark >= 7);
        assert_ptr_equal(found(l, t->name), t); /* read once */
        n_kind[t->kind]++;
    }
    assert_true(n_kind[SN_BONE_CYLINDER] >= 10 && n_kind[SN_BONE_CURVE] >= 5 && n_kind[SN_BONE_SHAPE] >= 7);
    sn_bone_library_destroy(l);
    sn_bone_library_destroy(NULL);
}

static void unknown_templates_are_told(void **state)
{
    (void)state;
    sn_bone_library *l = new_library();
    const sn_bone_template *t = (void *)&l;
    sn_error err = {.msg = ""};
    assert_int_equal(sn_bone_library_find(l, "femurr", &t, &err), SN_EINVAL);
    assert_null(t);
    assert_says(err, "no bone template 'femurr' (did you mean 'femur'? known: caudal, ");
    assert_int_equal(sn_bone_library_find(l, "antler of an elk", &t, &err), SN_EINVAL);
    assert_says(err, "no bone template 'antler of an elk' (known: caudal, cervical, clavicle, femur, ");
    assert_says(err, "tibia, ulna)"); /* all of them */
    assert_int_equal(sn_bone_library_find(l, "", &t, &err), SN_EINVAL);
    assert_says(err, "no bone template '' (known: ");
    char word[300];
    memset(word, 'w', sizeof word);
    word[299] = '\0';
    assert_int_equal(sn_bone_library_find(l, word, &t, &err), SN_EINVAL);
    sn_bone_library_destroy(l);
}

static sn_bone_template own(const char *name, const char *text)
{
    sn_bone_template t;
    assert_int_equal(sn_bone_template_parse(&t, name, text, BONE, NULL), SN_OK);
    return t;
}

static void own_templates_join_the_library(void **state)
{
    (void)state;
    sn_bone_library *l = new_library();
    int32_t n = sn_bone_library_count(l);
    sn_error err = {.msg = ""};
    sn_bone_template t = own("antler", CYLINDER);
    assert_int_equal(sn_bone_library_add(l, &t, NULL), SN_OK);
    assert_null(t.name); /* taken over */
    assert_int_equal(sn_bone_library_count(l), n + 1);
    assert_string_equal(sn_bone_library_name(l, n), "antler");
    assert_int_equal(found(l, "antler")->kind, SN_BONE_CYLINDER);
    const sn_bone_template *none;
    assert_int_equal(sn_bone_library_find(l, "anlter", &none, &err), SN_EINVAL);
    assert_says(err, "did you mean 'antler'?");
    assert_says(err, "ulna, antler)");
    t = own("antler", "kind curve\nlength 3"); /* again: replaced */
    assert_int_equal(sn_bone_library_add(l, &t, NULL), SN_OK);
    assert_int_equal(sn_bone_library_count(l), n + 1);
    assert_int_equal(found(l, "antler")->kind, SN_BONE_CURVE);
    sn_bone_library_destroy(l);
}

static void templates_that_cannot_be_added(void **state)
{
    (void)state;
    sn_bone_library *l = new_library();
    int32_t n = sn_bone_library_count(l);
    sn_error err = {.msg = ""};
    sn_bone_template t = own("femur", CYLINDER);
    assert_int_equal(sn_bone_library_add(l, &t, &err), SN_EINVAL);
    assert_string_equal(err.msg, "bone template 'femur' comes with sinew: give yours another name");
    assert_string_equal(t.name, "femur"); /* the caller's still */
    sn_bone_template_free(&t);
    t = own("a/b", CYLINDER);
    assert_int_equal(sn_bone_library_add(l, &t, &err), SN_EINVAL);
    assert_says(err, "name of bone template 'a/b' holds '/'");
    sn_bone_template_free(&t);
    t = own("stick", CYLINDER);
    t.to = t.from;
    assert_int_equal(sn_bone_library_add(l, &t, &err), SN_EINVAL);
    assert_says(err, "template 'stick': its ends 'from' and 'to' are one point");
    assert_non_null(t.bone.pos);
    sn_bone_template_free(&t);
    assert_int_equal(sn_bone_library_count(l), n);
    sn_bone_library_destroy(l);
}

/* ---- short of memory ---- */

static sn_status use_library(const sn_tri_mesh *bone)
{
    sn_bone_library *l = NULL;
    const sn_bone_template *t;
    sn_bone_template mine = {0}, read = {0};
    sn_landmark *copy = NULL;
    sn_status st = sn_bone_library_create(&l, NULL);
    if (!st) st = sn_bone_library_find(l, "patella", &t, NULL);
    if (!st) st = sn_landmarks_copy(&copy, t->landmark, t->n_landmark, NULL);
    if (!st) sn_landmarks_free(copy, t->n_landmark);
    if (!st)
        st = sn_bone_template_parse(&mine, "mine", "kind shape\nlandmark a 0 0 0 1", BONE CAGE SKIN, NULL);
    if (!st) st = sn_bone_library_add(l, &mine, NULL);
    if (!st) st = sn_bone_template_parse(&mine, "mine", CYLINDER, BONE, NULL);
    if (!st) st = sn_bone_library_add(l, &mine, NULL);
    if (!st) st = sn_bone_library_find(l, "no such bone", &t, NULL) == SN_EINVAL ? SN_OK : SN_ENOMEM;
    if (!st) st = sn_tri_mesh_copy(&read.bone, bone, NULL);
    sn_bone_template_free(&read);
    sn_bone_template_free(&mine);
    sn_bone_library_destroy(l);
    return st;
}

static void short_of_memory(void **state)
{
    (void)state;
    sn_tri_mesh bone = made_box(sn_v3(0, 0, 0), sn_v3(1, 1, 1));
    for (int left = 0;; left++) {
        failing f = {.left = left};
        sn_set_allocator(&(sn_allocator){failing_realloc, &f});
        sn_status st = use_library(&bone);
        sn_set_allocator(NULL);
        assert_int_equal(f.n_alive, 0);
        if (!st) break;
        assert_int_equal(st, SN_ENOMEM);
        assert_true(left < 5000);
    }
    sn_tri_mesh_free(&bone);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cylinders_are_read),
        cmocka_unit_test(curve_bones_are_read),
        cmocka_unit_test(shapes_are_read),
        cmocka_unit_test(wrong_texts_are_told),
        cmocka_unit_test(wrong_templates_are_told),
        cmocka_unit_test(numbers_that_are_not_finite_are_told),
        cmocka_unit_test(templates_are_aligned),
        cmocka_unit_test(every_bone_of_the_library_is_sound),
        cmocka_unit_test(unknown_templates_are_told),
        cmocka_unit_test(own_templates_join_the_library),
        cmocka_unit_test(templates_that_cannot_be_added),
        cmocka_unit_test(short_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
