#define _GNU_SOURCE /* mkdtemp */
/* test_extraction_save - parts of an extraction and its files, also as a checker that shares no code with us
 * sees them. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/file.h"
#include "extract/extraction.h"
#include "mesh/surface_io.h"

#include "made_extraction.h"

#include <sys/wait.h>
#include <unistd.h>

/* ---- parts and files ---- */

static void parts_are_found_and_taken_out(void **state)
{
    (void)state;
    sn_tet_mesh m = made_lattice(3, sn_v3(0, 0, 0), 1), part;
    double *value = new_values(&m, 4);
    for (int k = 0; k < 4 * m.n_vert; k++) value[k] = rnd();
    sn_extraction x = extract(&m, value, 4);
    assert_int_equal(sn_extraction_find(&x, "fat"), 0);
    assert_int_equal(sn_extraction_find(&x, "t3"), 3);
    assert_int_equal(sn_extraction_find(&x, "t4"), -1);
    assert_int_equal(sn_extraction_find(&x, ""), -1);
    sn_tet_mesh_init(&part);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(sn_extraction_part(&x, i, &part, NULL), SN_OK);
        assert_int_equal(sn_tet_mesh_validate(&part, NULL), SN_OK);
        assert_int_equal(part.n_tet, sn_extraction_part_tets(&x, i));
        assert_true(fabs(sn_tet_mesh_volume(&part) - sn_extraction_part_volume(&x, i)) < 1e-12);
        for (int32_t t = 0, at = 0; t < x.mesh.n_tet; t++) { /* the same tets in the same order */
            if (x.mesh.part[t] != i) continue;
            assert_int_equal(part.part[at], i);
            for (int k = 0; k < 4; k++)
                assert_memory_equal(part.pos + 3 * part.tet[4 * at + k],
                                    x.mesh.pos + 3 * x.mesh.tet[4 * t + k], 3 * sizeof(double));
            at++;
        }
        bool *used = SN_NEW_ZERO(bool, part.n_vert);
        for (int k = 0; k < 4 * part.n_tet; k++) used[part.tet[k]] = true;
        for (int32_t v = 0; v < part.n_vert; v++) assert_true(used[v]);
        sn_release(used);
    }
    sn_tet_mesh_free(&part);
    sn_extraction_free(&x);
    sn_release(value);
    sn_tet_mesh_free(&m);
}

static char folder[64];

static const char *in_folder(const char *name)
{
    static char path[4][128];
    static int at;
    at = (at + 1) % 4;
    (void)snprintf(path[at], sizeof path[at], "%s/%s", folder, name);
    return path[at];
}

static int make_folder(void **state)
{
    (void)state;
    (void)snprintf(folder, sizeof folder, "/tmp/sn_extraction_XXXXXX");
    return mkdtemp(folder) ? 0 : 1;
}

static int remove_folder(void **state)
{
    static const char *const file[] = {"parts/t1.obj", "parts/t2.obj", "parts",
                                       "all.vtu",      "all.mesh",     "all.msh"};
    (void)state;
    for (size_t i = 0; i < sizeof file / sizeof *file; i++) (void)remove(in_folder(file[i]));
    return rmdir(folder);
}

/* Fat, two muscles, and a third that wins nowhere. */
static sn_extraction four_tissues(void)
{
    sn_tet_mesh m = made_lattice(4, sn_v3(0, 0, 0), 0.25);
    double *value = new_values(&m, 4);
    for (int32_t v = 0; v < m.n_vert; v++) {
        sn_vec3 p = sn_tet_mesh_point(&m, v);
        value[v] = 0.4;
        value[m.n_vert + v] = 0.9 - sn_v3_dist(p, sn_v3(0.3, 0.3, 0.3));
        value[2 * m.n_vert + v] = 0.9 - sn_v3_dist(p, sn_v3(0.7, 0.7, 0.6));
        value[3 * m.n_vert + v] = -1.0;
    }
    sn_extraction x = extract(&m, value, 4);
    sn_release(value);
    sn_tet_mesh_free(&m);
    return x;
}

static void a_path_without_extension_is_a_folder(void **state)
{
    (void)state;
    sn_extraction x = four_tissues();
    sn_error err = {0};
    if (sn_extraction_save(&x, NULL, in_folder("parts"), NULL, &err)) fail_msg("%s", err.msg);
    assert_int_equal(sn_extraction_save(&x, NULL, in_folder("parts"), NULL, &err),
                     SN_OK); /* again: files are replaced */
    assert_int_not_equal(access(in_folder("parts/fat.obj"), F_OK), 0);
    assert_int_not_equal(access(in_folder("parts/t3.obj"), F_OK), 0);
    for (int i = 1; i <= 2; i++) {
        sn_tri_mesh s;
        sn_tri_mesh_init(&s);
        if (sn_surface_load(&s, in_folder(i == 1 ? "parts/t1.obj" : "parts/t2.obj"), &err))
            fail_msg("%s", err.msg);
        assert_true(fabs(sn_tri_mesh_volume(&s) - sn_extraction_part_volume(&x, i)) < 1e-12);
        sn_tri_mesh_free(&s);
    }
    assert_int_equal(sn_extraction_save(&x, NULL, in_folder("none/parts"), NULL, &err), SN_EIO);
    assert_non_null(strstr(err.msg, "none/parts"));
    sn_extraction_free(&x);
}

static void files_hold_all_tissues(void **state)
{
    (void)state;
    sn_extraction x = four_tissues();
    sn_error err = {0};
    static const char *const file[] = {"all.vtu", "all.mesh"};
    for (int i = 0; i < 2; i++) {
        sn_tet_mesh m;
        sn_tet_mesh_init(&m);
        if (sn_extraction_save(&x, NULL, in_folder(file[i]), NULL, &err)) fail_msg("%s", err.msg);
        if (sn_tet_mesh_load(&m, in_folder(file[i]), &err)) fail_msg("%s", err.msg);
        assert_int_equal(m.n_tet, x.mesh.n_tet);
        assert_int_equal(m.n_vert, x.mesh.n_vert);
        assert_memory_equal(m.pos, x.mesh.pos, 3 * (size_t)m.n_vert * sizeof *m.pos);
        assert_memory_equal(m.tet, x.mesh.tet, 4 * (size_t)m.n_tet * sizeof *m.tet);
        assert_memory_equal(m.part, x.mesh.part, (size_t)m.n_tet * sizeof *m.part);
        sn_tet_mesh_free(&m);
    }
    assert_int_equal(sn_extraction_save(&x, NULL, in_folder("all.msh"), NULL, &err), SN_OK);
    for (int i = 0; i < 3; i++) { /* the names are in the file; t3 as well, though it is empty */
        char *text = NULL;
        size_t size = 0;
        assert_int_equal(sn_file_read(in_folder(i == 0   ? "all.vtu"
                                                : i == 1 ? "all.mesh"
                                                         : "all.msh"),
                                      &text, &size, NULL),
                         SN_OK);
        if (i == 1)
            assert_non_null(strstr(text, "# tissue 1 fat\n# tissue 2 t1\n# tissue 3 t2\n# tissue 4 t3\n"));
        if (i == 2) assert_non_null(strstr(text, "\"t3\""));
        sn_release(text);
    }
    assert_int_equal(sn_extraction_save(&x, NULL, in_folder("all.step"), NULL, &err), SN_EINVAL);
    assert_non_null(strstr(err.msg, "all.step: no tet mesh format to write 'step' (known: .vtu .mesh .msh)"));
    assert_int_not_equal(access(in_folder("all.step"), F_OK), 0);
    sn_extraction_free(&x);
}

/* ---- a reader of our files that shares no code with us ---- */

static int run_checker(const char *path, char *line, int room)
{
    char command[256];
    (void)snprintf(command, sizeof command, "python3 tests/check_mesh.py %s", path);
    FILE *f = popen(command, "r");
    assert_non_null(f);
    line[0] = '\0';
    if (!fgets(line, room, f)) line[0] = '\0';
    int status = pclose(f);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

/* Writes text with the first `from` replaced by `to` and has it checked: it must be refused with `want`. */
static void assert_checker_refuses(const char *text, const char *from, const char *to, const char *want)
{
    char line[512];
    const char *at = strstr(text, from);
    sn_out *o = NULL;
    assert_non_null(at);
    assert_int_equal(sn_out_open(&o, in_folder("all.mesh"), NULL), SN_OK);
    sn_out_bytes(o, text, (size_t)(at - text));
    sn_out_text(o, to);
    sn_out_text(o, at + strlen(from));
    assert_int_equal(sn_out_commit(o, NULL), SN_OK);
    assert_int_equal(run_checker(in_folder("all.mesh"), line, sizeof line), 1);
    if (!strstr(line, want)) fail_msg("'%s' where '%s' was wanted", line, want);
}

static void a_checker_of_another_make_agrees(void **state)
{
    (void)state;
    if (system("python3 -c '' 2>/dev/null") != 0) skip();
    char line[512], want[128];
    sn_extraction x = four_tissues();
    assert_int_equal(sn_extraction_save(&x, NULL, in_folder("all.mesh"), NULL, NULL), SN_OK);
    assert_int_equal(run_checker(in_folder("all.mesh"), line, sizeof line), 0);
    (void)snprintf(want, sizeof want, "tets %d, materials 3, volume %.9g, ok\n", x.mesh.n_tet,
                   x.input_volume);
    if (!strstr(line, want)) fail_msg("'%s' where '%s' was wanted", line, want);
    sn_extraction_free(&x);

    sn_tet_mesh m = made_lattice(4, sn_v3(0, 0, 0), 0.25);
    double *value = new_values(&m, 8);
    for (int k = 0; k < 8 * m.n_vert; k++) value[k] = below(3);
    x = extract(&m, value, 8);
    assert_int_equal(sn_extraction_save(&x, NULL, in_folder("all.mesh"), NULL, NULL), SN_OK);
    if (run_checker(in_folder("all.mesh"), line, sizeof line)) fail_msg("%s", line);
    sn_extraction_free(&x);
    sn_release(value);
    sn_tet_mesh_free(&m);
}

static void the_checker_of_another_make_sees_what_is_broken(void **state)
{
    (void)state;
    if (system("python3 -c '' 2>/dev/null") != 0) skip();
    static const char text[] =
        "MeshVersionFormatted 2\nDimension 3\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 1 1 0\n"
        "Triangles\n7\n1 4 3 1\n1 2 4 1\n1 3 2 1\n2 3 4 1\n3 4 5 2\n2 5 4 2\n2 3 5 2\n"
        "Tetrahedra\n2\n1 2 3 4 1\n5 3 2 4 2\nEnd\n";
    char line[512];
    sn_out *o = NULL;
    assert_int_equal(sn_out_open(&o, in_folder("all.mesh"), NULL), SN_OK);
    sn_out_text(o, text);
    assert_int_equal(sn_out_commit(o, NULL), SN_OK);
    if (run_checker(in_folder("all.mesh"), line, sizeof line)) fail_msg("%s", line);
    assert_non_null(strstr(line, "tets 2, materials 2, volume 0.5, ok"));
    assert_checker_refuses(text, "5 3 2 4 2\n", "3 5 2 4 2\n", "tet 2 has volume -0.333333, need > 0");
    assert_checker_refuses(text, "5 3 2 4 2\n", "5 3 2 4 1\n", "lies between no two materials");
    assert_checker_refuses(text, "2 3 4 1\n", "2 4 3 1\n", "triangle 2 4 3 is turned towards material 1");
    assert_checker_refuses(text, "2 3 4 1\n", "2 3 4 2\n", "triangle 2 3 4 has ref 2, need 1");
    assert_checker_refuses(text, "2 3 4 1\n", "1 3 2 1\n", "comes twice");
    assert_checker_refuses(text, "7\n1 4 3 1\n", "6\n", "6 triangles, but 7 faces");
    assert_checker_refuses(text, "2\n1 2 3 4 1\n", "3\n1 2 3 4 1\n1 2 3 4 1\n", "has more than two tets");
    assert_checker_refuses(text, "5 3 2 4 2\n", "", "Tetrahedra: 2 promised, the file ends before");
    assert_checker_refuses(text, "5 3 2 4 2\n", "6 3 2 4 2\n", "a vertex number is not in 1..5");
    assert_checker_refuses(text, "1 1 1 0\n", "nan 1 1 0\n", "a coordinate is not finite");
    /* Apart but for an edge: 2 and 3 shared, and the corner 4 made two. */
    static const char pinched[] =
        "MeshVersionFormatted 2\nDimension 3\nVertices\n6\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 1 1 0\n1 1 "
        "0 0\n"
        "Triangles\n8\n1 4 3 1\n1 2 4 1\n1 3 2 1\n2 3 4 1\n2 5 3 1\n2 6 5 1\n3 5 6 1\n2 3 6 1\n"
        "Tetrahedra\n2\n1 2 3 4 1\n3 2 6 5 1\nEnd\n";
    assert_checker_refuses(pinched, "End", "End", "edge 3 2 has more than two triangles");
    /* Two tets that share vertex 2 only. */
    static const char touching[] =
        "MeshVersionFormatted 2\nDimension 3\nVertices\n7\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n2 0 0 0\n1 1 "
        "0 0\n1 0 1 0\n"
        "Triangles\n8\n1 4 3 1\n1 2 4 1\n1 3 2 1\n2 3 4 1\n2 7 6 1\n2 5 7 1\n2 6 5 1\n5 6 7 1\n"
        "Tetrahedra\n2\n1 2 3 4 1\n2 5 6 7 1\nEnd\n";
    assert_checker_refuses(touching, "End", "End", "vertex 2 has two fans");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_are_found_and_taken_out),
        cmocka_unit_test(a_path_without_extension_is_a_folder),
        cmocka_unit_test(files_hold_all_tissues),
        cmocka_unit_test(a_checker_of_another_make_agrees),
        cmocka_unit_test(the_checker_of_another_make_sees_what_is_broken),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
