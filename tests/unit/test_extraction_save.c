#define _GNU_SOURCE /* mkdtemp */
/* test_extraction_save - parts of an extraction and its files, also as a checker that shares no code with us
 * sees them. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/file.h"
#include "extract/part_fibers.h"
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

/* ---- fibers and tendon ---- */

/* A cube of tets: fat where x > 0.75, below z = 0.45 the muscle t1, above it t2; t1 has tendon, the two heads
 * of t2 share no end. */
typedef struct known {
    sn_tet_mesh input;
    sn_extraction x;
} known;

static sn_muscle made_muscle(const sn_head_points *head, int32_t n)
{
    sn_muscle m;
    memset(&m, 0, sizeof m);
    assert_int_equal(sn_muscle_init(&m, "any", head, n, NULL), SN_OK);
    return m;
}

static known with_muscles(void)
{
    static const double along[] = {0, 0.5, 0.2, 0.8, 0.5, 0.2}, a[] = {0, 0.5, 0.8, 0.3, 0.5, 0.8},
                        b[] = {0.4, 0.5, 0.8, 0.7, 0.5, 0.8};
    known k = {.input = made_lattice(6, sn_v3(0, 0, 0), 1.0 / 6)};
    double *value = new_values(&k.input, 3);
    for (int32_t v = 0; v < k.input.n_vert; v++) {
        sn_vec3 p = sn_tet_mesh_point(&k.input, v);
        value[v] = p.x - 0.75;
        value[k.input.n_vert + v] = 0.45 - p.z;
        value[2 * k.input.n_vert + v] = p.z - 0.45;
    }
    k.x = extract(&k.input, value, 3);
    sn_muscle one = made_muscle(&(sn_head_points){along, NULL, 2}, 1);
    sn_muscle apart = made_muscle((const sn_head_points[]){{a, NULL, 2}, {b, NULL, 2}}, 2);
    assert_int_equal(sn_muscle_set_tendon(&one, &(sn_tendon){.length = 0.25}, NULL), SN_OK);
    assert_int_equal(sn_extraction_set_muscles(&k.x, (const sn_muscle *const[]){&one, &apart}, 2, NULL),
                     SN_OK);
    sn_muscle_free(&one);
    sn_muscle_free(&apart);
    sn_release(value);
    return k;
}

static void free_known(known *k)
{
    sn_extraction_free(&k->x);
    sn_tet_mesh_free(&k->input);
}

static char *text_of(const char *name)
{
    char *text = NULL;
    size_t size = 0;
    assert_int_equal(sn_file_read(in_folder(name), &text, &size, NULL), SN_OK);
    return text;
}

/* What the array that begins with this tag holds; by sn_alloc. RFC 4648, one digit at a time. */
static void *vtu_array(const char *text, const char *tag, size_t *size)
{
    static const char table[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char *p = strstr(text, tag);
    if (!p) fail_msg("no %s", tag);
    p += strlen(tag) + 1;
    unsigned char *raw = SN_NEW(unsigned char, strcspn(p, "\n"));
    size_t n = 0;
    unsigned bits = 0;
    int n_bits = 0;
    for (const char *digit; *p && (digit = strchr(table, *p)); p++) {
        bits = bits << 6 | (unsigned)(digit - table);
        n_bits += 6;
        if (n_bits < 8) continue;
        n_bits -= 8;
        raw[n++] = (unsigned char)(bits >> n_bits & 0xFF);
    }
    uint64_t said;
    memcpy(&said, raw, sizeof said);
    assert_int_equal(n, said + sizeof said);
    memmove(raw, raw + sizeof said, (size_t)said);
    *size = (size_t)said;
    return raw;
}

#define FIBER_TAG "<DataArray type=\"Float64\" Name=\"fiber\" NumberOfComponents=\"3\" format=\"binary\">"
#define TENDON_TAG "<DataArray type=\"Int32\" Name=\"tendon\" format=\"binary\">"

/* Directions and tendon of the tets of a mesh of the extraction: t1 along x, its tendon within 0.25 of the
 * curve's ends; nothing else has either. */
static void assert_fibers(const sn_tet_mesh *m, const double *fiber, const int32_t *tendon)
{
    int n_tendon = 0;
    for (int32_t t = 0; t < m->n_tet; t++) {
        sn_vec3 c = sn_tet_mesh_centre(m, t), d = sn_v3_load(fiber + 3 * t);
        if (m->part[t] == 1)
            assert_true(fabs(sn_v3_len(d) - 1.0) < 1e-12 && d.x > 0.99);
        else
            assert_true(sn_v3_len(d) == 0.0);
        assert_int_equal(tendon[t], m->part[t] == 1 && (c.x < 0.25 || c.x > 0.55));
        n_tendon += tendon[t];
    }
    assert_true(n_tendon > 10);
}

static void vtu_has_fibers_and_tendon(void **state)
{
    (void)state;
    known k = with_muscles();
    sn_error err = {0};
    for (int whole = 0; whole < 2; whole++) {
        sn_tet_mesh m;
        size_t fiber_size, tendon_size;
        sn_tet_mesh_init(&m);
        if (whole ? sn_extraction_save(&k.x, &k.input, in_folder("all.vtu"), NULL, &err)
                  : sn_extraction_save_part(&k.x, &k.input, 1, in_folder("all.vtu"), NULL, &err))
            fail_msg("%s", err.msg);
        if (sn_tet_mesh_load(&m, in_folder("all.vtu"), &err)) fail_msg("%s", err.msg);
        assert_int_equal(m.n_tet, whole ? k.x.mesh.n_tet : sn_extraction_part_tets(&k.x, 1));
        char *text = text_of("all.vtu");
        double *fiber = vtu_array(text, FIBER_TAG, &fiber_size);
        int32_t *tendon = vtu_array(text, TENDON_TAG, &tendon_size);
        assert_int_equal(fiber_size, 3 * (size_t)m.n_tet * sizeof *fiber);
        assert_int_equal(tendon_size, (size_t)m.n_tet * sizeof *tendon);
        assert_fibers(&m, fiber, tendon);
        sn_release(fiber);
        sn_release(tendon);
        sn_release(text);
        sn_tet_mesh_free(&m);
    }
    free_known(&k);
}

static void without_input_no_fibers(void **state)
{
    (void)state;
    known k = with_muscles();
    static const char *const file[] = {"all.vtu", "all.msh", "all.mesh"};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(sn_extraction_save(&k.x, NULL, in_folder(file[i]), NULL, NULL), SN_OK);
        char *text = text_of(file[i]);
        assert_null(strstr(text, "fiber"));
        assert_null(strstr(text, "tendon"));
        sn_release(text);
    }
    free_known(&k);
}

/* The rows of a $ElementData section after its header, which must be as wanted; moves *text behind them. */
static void read_element_data(const char **text, const char *name, int n_comp, int32_t n, double *out)
{
    char header[128];
    (void)snprintf(header, sizeof header, "$ElementData\n1\n\"%s\"\n1\n0.0\n3\n0\n%d\n%d\n", name, n_comp, n);
    const char *p = strstr(*text, header);
    if (!p) fail_msg("no %s", header);
    char *at = (char *)(uintptr_t)(p + strlen(header));
    for (int32_t i = 0; i < n; i++) {
        assert_int_equal(strtol(at, &at, 10), i + 1);
        for (int c = 0; c < n_comp; c++) out[n_comp * i + c] = strtod(at, &at);
    }
    assert_int_equal(strncmp(at, "\n$EndElementData\n", 17), 0);
    *text = at;
}

static void msh_has_element_data(void **state)
{
    (void)state;
    known k = with_muscles();
    int32_t n = k.x.mesh.n_tet;
    sn_error err = {0};
    if (sn_extraction_save(&k.x, &k.input, in_folder("all.msh"), NULL, &err)) fail_msg("%s", err.msg);
    char *text = text_of("all.msh");
    const char *at = text;
    double *fiber = SN_NEW(double, 3 * (size_t)n), *value = SN_NEW(double, n);
    int32_t *tendon = SN_NEW(int32_t, n);
    read_element_data(&at, "fiber", 3, n, fiber);
    read_element_data(&at, "tendon", 1, n, value);
    for (int32_t t = 0; t < n; t++) tendon[t] = (int32_t)value[t];
    assert_fibers(&k.x.mesh, fiber, tendon);
    sn_release(fiber);
    sn_release(value);
    sn_release(tendon);
    sn_release(text);
    free_known(&k);
}

/* Tets of tendon carry the id after the last tissue's; nothing else is changed by it. */
static void mesh_has_ids_of_tendon(void **state)
{
    (void)state;
    known k = with_muscles();
    sn_error err = {0};
    sn_tet_mesh m;
    sn_tet_mesh_init(&m);
    if (sn_extraction_save(&k.x, &k.input, in_folder("all.mesh"), NULL, &err)) fail_msg("%s", err.msg);
    char *text = text_of("all.mesh");
    assert_non_null(strstr(text,
                           "# tissue 1 fat\n# tissue 2 t1\n# tissue 3 t2\n# tissue 4 t1:tendon\n# tissue 5 "
                           "t2:tendon\n"));
    sn_release(text);
    if (sn_tet_mesh_load(&m, in_folder("all.mesh"), &err)) fail_msg("%s", err.msg);
    assert_int_equal(m.n_tet, k.x.mesh.n_tet);
    int n_tendon = 0;
    for (int32_t t = 0; t < m.n_tet; t++) {
        double x = sn_tet_mesh_centre(&m, t).x;
        bool is_tendon = k.x.mesh.part[t] == 1 && (x < 0.25 || x > 0.55);
        assert_int_equal(m.part[t], is_tendon ? 3 : k.x.mesh.part[t]);
        n_tendon += is_tendon;
    }
    assert_true(n_tendon > 10);
    sn_tet_mesh_free(&m);
    if (sn_extraction_save_part(&k.x, &k.input, 1, in_folder("all.mesh"), NULL, &err))
        fail_msg("%s", err.msg);
    sn_tet_mesh_init(&m);
    if (sn_tet_mesh_load(&m, in_folder("all.mesh"), &err)) fail_msg("%s", err.msg);
    int n_part_tendon = 0;
    for (int32_t t = 0; t < m.n_tet; t++) n_part_tendon += m.part[t] == 3;
    assert_int_equal(n_part_tendon, n_tendon);
    sn_tet_mesh_free(&m);
    free_known(&k);
}

static void parts_are_saved_by_extension(void **state)
{
    (void)state;
    known k = with_muscles();
    sn_error err = {0};
    static const char *const surface[] = {"part.obj", "part.ply", "part.off", "part.stl"};
    for (int i = 0; i < 4; i++) {
        sn_tri_mesh s;
        sn_tri_mesh_init(&s);
        if (sn_extraction_save_part(&k.x, &k.input, 2, in_folder(surface[i]), NULL, &err))
            fail_msg("%s", err.msg);
        if (sn_surface_load(&s, in_folder(surface[i]), &err)) fail_msg("%s", err.msg);
        double tolerance = i == 3 ? 1e-6 : 1e-12; /* .stl has floats */
        assert_true(fabs(sn_tri_mesh_volume(&s) - sn_extraction_part_volume(&k.x, 2)) < tolerance);
        sn_tri_mesh_free(&s);
        (void)remove(in_folder(surface[i]));
    }
    assert_int_equal(sn_extraction_save_part(&k.x, NULL, 1, in_folder("part.xyz"), NULL, &err), SN_EINVAL);
    assert_non_null(strstr(err.msg,
                           "part.xyz: unknown format 'xyz' (known: .obj .ply .stl .off for the surface, "
                           ".vtu .mesh .msh for the tets)"));
    assert_int_equal(sn_extraction_save_part(&k.x, NULL, 1, in_folder("no/part.vtu"), NULL, &err), SN_EIO);
    free_known(&k);
    sn_extraction x = four_tissues();
    assert_int_equal(sn_extraction_save_part(&x, NULL, 3, in_folder("part.vtu"), NULL, &err), SN_EINVAL);
    assert_string_equal(err.msg, "part 't3' is empty: no tets");
    assert_int_not_equal(access(in_folder("part.vtu"), F_OK), 0);
    sn_extraction_free(&x);
}

static void saving_may_run_out_of_memory(void **state)
{
    (void)state;
    known k = with_muscles();
    static const char *const file[] = {"all.vtu", "all.mesh"};
    for (int i = 0; i < 4; i++)
        for (int n = 0;; n += 1 + n / 8) {
            ration r = {n, 0};
            sn_error err = {0};
            sn_set_allocator(RATION(r));
            sn_status st =
                i < 2 ? sn_extraction_save(&k.x, &k.input, in_folder(file[i]), &one_thread, &err)
                      : sn_extraction_save_part(&k.x, &k.input, 1, in_folder(file[i - 2]), &one_thread, &err);
            sn_set_allocator(NULL);
            assert_int_equal(r.in_use, 0);
            if (!st) break;
            if (st != SN_ENOMEM) fail_msg("allocation %d: %d, '%s'", n, st, err.msg);
        }
    free_known(&k);
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
        cmocka_unit_test(vtu_has_fibers_and_tendon),
        cmocka_unit_test(without_input_no_fibers),
        cmocka_unit_test(msh_has_element_data),
        cmocka_unit_test(mesh_has_ids_of_tendon),
        cmocka_unit_test(parts_are_saved_by_extension),
        cmocka_unit_test(saving_may_run_out_of_memory),
        cmocka_unit_test(a_checker_of_another_make_agrees),
        cmocka_unit_test(the_checker_of_another_make_sees_what_is_broken),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
