/* test_surface_io.c - reading and writing of surfaces: each format's forms, every message, hostile files. */
#define _DEFAULT_SOURCE /* mkdtemp */

#include "temp_folder.h"
#include "failing_memory.h"

#include "base/alloc.h"
#include "base/file.h"
#include "mesh/surface_io.h"

static void check_close(double found, double want, double tol)
{
    if (!(fabs(found - want) <= tol)) fail_msg("found %.17g, wanted %.17g within %g", found, want, tol);
}

/* Every accepted mesh must hold to its own rules; a refused one must leave nothing. */
static sn_status load_bytes(sn_tri_mesh *m, const char *name, const void *data, size_t size, sn_error *err)
{
    put_file(name, data, size);
    sn_status st = sn_surface_load(m, in_folder(name), err);
    if (st) {
        assert_int_equal(err->code, st);
        assert_null(m->pos);
        assert_null(m->face);
        assert_int_equal(m->n_vert + m->n_face, 0);
    } else {
        assert_int_equal(sn_tri_mesh_validate(m, err), SN_OK);
    }
    return st;
}

static void check_loads(const char *name, const char *text, int n_vert, int n_face, const int32_t *face)
{
    sn_tri_mesh m;
    sn_error err = {0};
    sn_tri_mesh_init(&m);
    sn_status st = load_bytes(&m, name, text, strlen(text), &err);
    if (st) print_message("%s\n", err.msg);
    assert_int_equal(st, SN_OK);
    assert_int_equal(m.n_vert, n_vert);
    assert_int_equal(m.n_face, n_face);
    if (face) assert_memory_equal(m.face, face, 3 * (size_t)n_face * sizeof *face);
    sn_tri_mesh_free(&m);
}

/* `part` must be in the message, behind the path. */
static void check_bytes_fail(const char *name, const void *data, size_t size, const char *part)
{
    sn_tri_mesh m;
    sn_error err = {0};
    sn_tri_mesh_init(&m);
    assert_int_equal(load_bytes(&m, name, data, size, &err), SN_EFORMAT);
    if (strncmp(err.msg, in_folder(name), strlen(in_folder(name))) != 0 || !strstr(err.msg, part))
        fail_msg("message: %s\nwanted:  %s", err.msg, part);
}

static void check_fails(const char *name, const char *text, const char *part)
{
    check_bytes_fail(name, text, strlen(text), part);
}

static const char V4[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
static const int32_t quad_fan[] = {0, 1, 2, 0, 2, 3};

static const char *v4(const char *rest)
{
    static char text[512];
    (void)snprintf(text, sizeof text, "%s%s", V4, rest);
    return text;
}

/* ---- OBJ ---- */

static void obj_forms(void **state)
{
    (void)state;
    check_loads("a.obj", v4("f 1 2 3 4\n"), 4, 2, quad_fan);
    check_loads("a.obj", v4("f 1/1 2/2 3/3 4/4\n"), 4, 2, quad_fan);
    check_loads("a.obj", v4("f 1//5 2//6 3//7 4//8\n"), 4, 2, quad_fan);
    check_loads("a.obj", v4("f 1/1/5 2/2/6 3/-3/-7 4/4/8"), 4, 2, quad_fan);
    check_loads("a.obj", v4("f -4 -3 -2 -1\n"), 4, 2, quad_fan);
    check_loads("a.obj", v4("f -4//-1 -3//-1 -2//-1 -1//-1  # four\n"), 4, 2, quad_fan);
    check_loads("a.obj", v4("f 1 2 \\\n 3 \\\r\n4\n"), 4, 2, quad_fan);
    check_loads("a.obj", v4("\tf\t1  2\t3 4 \t\n"), 4, 2, quad_fan);
    check_loads("A.OBJ", v4("g a b\nusemtl C:\\x\ns off\nvn 0 0 1\nvt 0 0\nl 1 2\np 1\no n\nf 1 2 3 4\n"), 4,
                2, quad_fan);
    check_loads("a.obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", 3, 1, NULL); /* faces first */
    check_loads("a.obj", "v 0 0 0 1.0\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0\nv 9 9 9\nf 1 2 3\n", 4, 1, NULL);
}

static void obj_line_ends(void **state)
{
    (void)state;
    check_loads("a.obj", "# c\r\nv 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\n\r\nf 1 2 3\r\n", 3, 1, NULL);
    check_loads("a.obj", "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3", 3, 1, NULL);
    check_fails("a.obj", "v 0 0 0\r\nv 1 0 0\r\n\r\nv 0 x 0\r\n", "a.obj:4: need a coordinate, found 'x'");
    check_fails("a.obj", "v 0 0 0\rv 1 0\r", "a.obj:2: need a coordinate, found the end of the line");
}

static void obj_messages(void **state)
{
    (void)state;
    check_fails("a.obj", v4("f 1 2 5\n"), "a.obj:5: face names vertex 5, need 1..4");
    check_fails("a.obj", v4("f 1 2 99999999999999999999\nf 1 2 3\n"),
                "a.obj:5: face names vertex 9223372036854775");
    check_fails("a.obj", v4("f 1 2 4294967297\n"), "face names vertex 4294967297, need 1..4");
    check_fails("a.obj", v4("f 1 2 -5\n"), "a.obj:5: vertex index -5 with 4 vertices before it");
    check_fails("a.obj", v4("f 0 1 2\n"), "a.obj:5: vertex index 0, need 1 or more");
    check_fails("a.obj", v4("f 1 2\n"), "a.obj:5: a face with 2 corners, need 3 or more");
    check_fails("a.obj", v4("f\n"), "a.obj:5: a face with 0 corners");
    check_fails("a.obj", v4("f 1 2 x\n"), "a.obj:5: need a vertex index, found 'x'");
    check_fails("a.obj", v4("f 1 2 3.5\n"), "need a vertex index, found '3.5'");
    check_fails("a.obj", "v 0 0\n", "a.obj:1: need a coordinate, found the end of the line");
    check_fails("a.obj", "v 0 0", "a.obj:1: need a coordinate, found the end of the file");
    check_fails("a.obj", "v 0 0 nan\n", "need a finite coordinate, found 'nan'");
    check_fails("a.obj", "v 0 -inf 0\n", "need a finite coordinate, found '-inf'");
    check_fails("a.obj", "v 1e999 0 0\n", "need a finite coordinate, found '1e999'");
    check_fails("a.obj", "v 1,5 0 0\n", "need a coordinate, found '1,5'");
    check_fails("a.obj", "v 1\033[31m\001 0 0\n", "need a coordinate, found '1?[31m?'");
    check_fails("a.obj", "v aaaaaaaaaabbbbbbbbbbccccccccccddddddddd 0 0\n",
                "found 'aaaaaaaaaabbbbbbbbbbccccccccccdd...'");
    check_fails("a.obj", V4, "a.obj: no faces in the file");
    check_fails("a.obj", "", "a.obj: no faces in the file");
}

/* ---- Numbers ---- */

/* Each spelling must give strtod's bits, whichever way the scanner takes. */
static void numbers_have_the_bits_of_strtod(void **state)
{
    (void)state;
    static const char *const spelled[] = {"0",
                                          "-0",
                                          "1",
                                          "+1.5",
                                          ".5",
                                          "5.",
                                          "0.1",
                                          "-0.3492",
                                          "9007199254740991",
                                          "9007199254740993",
                                          "123456789012345678901234567890",
                                          "1e22",
                                          "1e23",
                                          "1e-22",
                                          "3e-23",
                                          "0.1e1",
                                          "1E+5",
                                          "1e-5",
                                          "2.2250738585072014e-308",
                                          "4.9e-324",
                                          "1e-400",
                                          "1.7976931348623157e308",
                                          "0.30000000000000004",
                                          "0.000000000000000000000000000001",
                                          "00000000000000000000000001.25",
                                          "8.5e-0",
                                          "1234567.8901234567"};
    for (size_t i = 0; i < sizeof spelled / sizeof *spelled; i++) {
        char text[256];
        int n = snprintf(text, sizeof text, "v %s 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", spelled[i]);
        sn_tri_mesh m;
        sn_error err = {0};
        sn_tri_mesh_init(&m);
        assert_int_equal(load_bytes(&m, "a.obj", text, (size_t)n, &err), SN_OK);
        double want = strtod(spelled[i], NULL);
        assert_memory_equal(&m.pos[0], &want, sizeof want);
        sn_tri_mesh_free(&m);
    }
}

static uint64_t next_random(uint64_t *s)
{
    *s ^= *s << 13;
    *s ^= *s >> 7;
    return *s ^= *s << 17;
}

static void random_numbers_have_the_bits_of_strtod(void **state)
{
    (void)state;
    enum { N = 3000 };
    uint64_t seed = 88172645463325252u;
    char *text = malloc(N * 100);
    double *want = malloc(3 * N * sizeof *want);
    size_t n = 0;
    for (int i = 0; i < 3 * N; i++) {
        char word[40];
        double x = (double)(int64_t)next_random(&seed) * pow(10.0, (double)(next_random(&seed) % 40) - 40.0);
        (void)snprintf(word, sizeof word, "%.*g", 1 + (int)(next_random(&seed) % 17), x);
        want[i] = strtod(word, NULL);
        n += (size_t)sprintf(text + n, "%s%s%s", i % 3 ? " " : "v ", word, i % 3 == 2 ? "\n" : "");
    }
    n += (size_t)sprintf(text + n, "f 1 2 3\n");
    sn_tri_mesh m;
    sn_error err = {0};
    sn_tri_mesh_init(&m);
    assert_int_equal(load_bytes(&m, "a.obj", text, n, &err), SN_OK);
    assert_memory_equal(m.pos, want, 3 * N * sizeof *want);
    sn_tri_mesh_free(&m);
    free(text);
    free(want);
}

/* ---- Polygons ---- */

static double area_of(const char *text, double *min_turn, sn_tri_mesh *m)
{
    sn_error err = {0};
    sn_tri_mesh_init(m);
    assert_int_equal(load_bytes(m, "p.obj", text, strlen(text), &err), SN_OK);
    *min_turn = INFINITY;
    for (int32_t f = 0; f < m->n_face; f++) *min_turn = fmin(*min_turn, sn_tri_mesh_face_normal(m, f).z);
    return sn_tri_mesh_area(m);
}

static void concave_polygons_are_cut_inside(void **state)
{
    (void)state;
    sn_tri_mesh m;
    double turn;
    /* An arrowhead, twice its area (2 2 - 0) + (0 - 2 / 2) + 0 + (0 + 2) = 5 by the shoelace formula. The fan
     * from its first corner would leave it. */
    static const char arrow[] = "v 2 0 0\nv 0 2 0\nv 0.5 0.5 0\nv -1 -1 0\nf 2 3 4 1\n";
    check_close(area_of(arrow, &turn, &m), 2.5, 1e-12);
    assert_true(turn > 0.0);
    sn_tri_mesh_free(&m);
    /* An L: area 3, 6 corners, 4 triangles, all turning the same way. */
    static const char ell[] = "v 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nf 1 2 3 4 5 6\n";
    check_close(area_of(ell, &turn, &m), 3.0, 1e-12);
    assert_true(turn > 0.0);
    assert_int_equal(m.n_face, 4);
    sn_tri_mesh_free(&m);
    /* The same seen from behind: turned the other way in the same plane. */
    static const char back[] = "v 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nf 6 5 4 3 2 1\n";
    check_close(area_of(back, &turn, &m), 3.0, 1e-12);
    for (int32_t f = 0; f < m.n_face; f++) assert_true(sn_tri_mesh_face_normal(&m, f).z < 0.0);
    sn_tri_mesh_free(&m);
    /* A comb standing in the x-z plane with collinear corners: 5 + 2 = 7 squares. */
    static const char comb[] =
        "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 5 0 0\nv 5 0 2\nv 4 0 2\nv 4 0 1\nv 1 0 1\nv 1 0 2\n"
        "v 0 0 2\nf 1 2 3 4 5 6 7 8 9 10\n";
    check_close(area_of(comb, &turn, &m), 7.0, 1e-12);
    assert_int_equal(m.n_face, 8);
    for (int32_t f = 0; f < m.n_face; f++) assert_true(sn_tri_mesh_face_normal(&m, f).y < 0.0);
    sn_tri_mesh_free(&m);
    /* A square with a square hole, joined by a bridge that is walked twice: 16 - 4. */
    static const char ring[] = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\n"
                               "f 1 2 3 4 1 5 6 7 8 5\n";
    check_close(area_of(ring, &turn, &m), 12.0, 1e-12);
    assert_true(turn > 0.0);
    sn_tri_mesh_free(&m);
}

/* A star with n spikes: n corners outside, n inside. */
static char *star(int n, double inner)
{
    char *text = malloc((size_t)n * 100 + 10), *p = text;
    for (int i = 0; i < 2 * n; i++) {
        double r = i % 2 ? inner : 1.0, a = 3.14159265358979323846 * i / n;
        p += sprintf(p, "v %.17g %.17g 0\n", r * cos(a), r * sin(a));
    }
    *p++ = 'f';
    for (int i = 0; i < 2 * n; i++) p += sprintf(p, " %d", i + 1);
    (void)strcpy(p, "\n");
    return text;
}

static void polygon_sizes(void **state)
{
    (void)state;
    sn_tri_mesh m;
    double turn;
    char *text = star(512, 0.5);
    double area = area_of(text, &turn, &m);
    assert_int_equal(m.n_face, 1022);
    assert_true(turn > 0.0);
    check_close(area, 512 * 0.5 * sin(3.14159265358979323846 / 512), 1e-9); /* 2 n triangles r1 r2 sin / 2 */
    sn_tri_mesh_free(&m);
    free(text);
    text = star(513, 0.5);
    check_fails("p.obj", text, "p.obj: face 1 is concave with 1026 corners, at most 1024 can be cut");
    free(text);
    text = star(5000, 1.0); /* convex: any size */
    check_loads("p.obj", text, 10000, 9998, NULL);
    free(text);
}

static void odd_polygons_give_n_minus_2(void **state)
{
    (void)state;
    check_loads("p.obj", v4("f 1 3 2 4\n"), 4, 2, NULL);         /* a bow tie         */
    check_loads("p.obj", v4("f 1 1 1 1 1\n"), 4, 3, NULL);       /* one point         */
    check_loads("p.obj", v4("f 1 2 1 2 1 2 1\n"), 4, 5, NULL);   /* to and fro        */
    check_loads("p.obj", v4("f 1 2 3 1 3 4 2 4\n"), 4, 6, NULL); /* crosses itself    */
    check_loads(
        "p.obj",
        "v 1e308 0 0\nv -1e308 1e308 0\nv 0 -1e308 1e308\nv 1e308 1e308 1e308\nv 0 0 0\nf 1 2 3 4 5\n", 5, 3,
        NULL); /* every product overflows */
}

/* ---- OFF ---- */

static void off_forms(void **state)
{
    (void)state;
    check_loads("a.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n", 4, 2, quad_fan);
    check_loads("a.off", "OFF 4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 255 0 0\n", 4, 2, quad_fan);
    check_loads("a.off", "# c\nOFF # c\n\n4 1\n# v\n0 0 0\r\n1 0 0\n1 1 0 # p\n0 1 0\n4 0 1 2 3", 4, 2,
                quad_fan);
    check_loads(
        "a.off",
        "COFF\n4 1 0\n0 0 0 1 1 1 1\n1 0 0 1 0 0 1\n1 1 0 0 0 0 1\n0 1 0 0 0 0 1\n4 0 1 2 3 0.5 0.5 0.5\n", 4,
        2, quad_fan);
    check_loads("a.off",
                "STCNOFF\n3 1 0\n0 0 0 0 0 1 9 9 9 9 0 0\n1 0 0 0 0 1 9 9 9 9 0 0\n0 1 0 nan\n3 0 1 2\n", 3,
                1, NULL);
    check_loads("a.off", "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", 3, 1, NULL); /* the keyword is optional */
}

#define VTP_HEAD                                                                                             \
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" "                                                   \
    "compressor=\"vtkZLibDataCompressor\"><PolyData><Piece>\n"                                               \
    "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">"                         \
    "0 0 0 1 0 0 1 1 0 0 1 0</DataArray></Points>\n"                                                         \
    "<Lines><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">9 9</DataArray></Lines>\n"
#define VTP_ARRAY(name, numbers)                                                                             \
    "<DataArray type=\"Int32\" Name=\"" name "\" format=\"ascii\">" numbers "</DataArray>"
#define VTP_END "</Piece></PolyData></VTKFile>\n"

/* A compressor may be named where nothing is compressed: OpenSim's bones do. */
static void vtp_polygons(void **state)
{
    (void)state;
    check_loads("a.vtp",
                VTP_HEAD "<Polys>" VTP_ARRAY("connectivity", "0 1 2 3")
                    VTP_ARRAY("offsets", "4") "</Polys>" VTP_END,
                4, 2, quad_fan);
    check_loads("a.VTP",
                VTP_HEAD "<Polys>" VTP_ARRAY("offsets", "3 6")
                    VTP_ARRAY("connectivity", "0 1 2\n0 2 3") "</Polys>"
                                                              "<Strips>" VTP_ARRAY("connectivity",
                                                                                   "7") "</Strips>" VTP_END,
                4, 2, quad_fan);
}

static void vtp_messages(void **state)
{
    (void)state;
    check_fails("a.vtp", "solid", "a.vtp:1: not a VTK XML file");
    check_fails("a.vtp", "<VTKFile type=\"UnstructuredGrid\">", "need a VTKFile of type PolyData");
    check_fails("a.vtp", VTP_HEAD, "truncated: no </VTKFile>");
    check_fails("a.vtp", VTP_HEAD VTP_END, "a.vtp: no 'connectivity' in Polys");
    check_fails("a.vtp", VTP_HEAD "<Polys>" VTP_ARRAY("connectivity", "0 1 2") "</Polys>" VTP_END,
                "a.vtp: no 'offsets' in Polys");
    check_fails("a.vtp",
                VTP_HEAD "<Polys>" VTP_ARRAY("connectivity", "0 1 2")
                    VTP_ARRAY("offsets", "4") "</Polys>" VTP_END,
                "offset 1 is 4, need a whole number up to 3");
    check_fails("a.vtp",
                VTP_HEAD "<Polys>" VTP_ARRAY("connectivity", "0 1 2")
                    VTP_ARRAY("offsets", "3 2") "</Polys>" VTP_END,
                "polygon 2 has -1 corners, need 3 or more");
    check_fails("a.vtp",
                VTP_HEAD "<Polys>" VTP_ARRAY("connectivity", "0 1 4")
                    VTP_ARRAY("offsets", "3") "</Polys>" VTP_END,
                "cell 1 names point 4, need 0..3");
    check_fails("a.vtp",
                VTP_HEAD "<Polys>" VTP_ARRAY("connectivity", "") VTP_ARRAY("offsets", "") "</Polys>" VTP_END,
                "a.vtp: no faces");
    check_fails(
        "a.vtp",
        VTP_HEAD
        "<Polys><DataArray type=\"Int32\" Name=\"offsets\" format=\"binary\">AAAA</DataArray>" VTP_END,
        "compressed data is not read");
}

static void off_messages(void **state)
{
    (void)state;
    check_fails("a.off", "",
                "a.off:1: need the keyword OFF (or COFF, NOFF, STOFF), found the end of the file");
    check_fails("a.off", "solid x\n", "need the keyword OFF (or COFF, NOFF, STOFF), found 'solid'");
    check_fails("a.off", "4OFF\n3 1 0\n", "need the keyword OFF");
    check_fails("a.off", "OFF BINARY\n", "a.off:1: binary OFF is not read");
    check_fails("a.off", "OFF\nx", "a.off:2: need the number of vertices, found 'x'");
    check_fails("a.off", "OFF\n-3 1 0\n", "-3 is no count, need the number of vertices");
    check_fails("a.off", "OFF\n3\n", "need the number of faces, found the end of the file");
    check_fails("a.off", "OFF\n3 -1 0\n", "-1 is no count, need the number of faces");
    check_fails("a.off", "OFF\n2000000000 1 0\n0 0 0\n",
                "the header promises 2000000000 vertices, the file ends after 1");
    check_fails("a.off", "OFF\n3 2000000000 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
                "the header promises 2000000000 faces, the file ends after 1");
    check_fails("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
                "a.off:6: face names vertex 3, need 0..2");
    check_fails("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n",
                "a.off:6: face names vertex -1, need 0..2");
    check_fails("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", "a face with 2 corners, need 3 or more");
    check_fails("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3000000000 0 1 2\n",
                "a face with 3000000000 corners");
    check_fails("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2000000000 0 1 2\n",
                "need a vertex index, found the end of the file");
    check_fails("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\nx 0 1 2\n",
                "need the number of corners, found 'x'");
    check_fails("a.off", "OFF\n1 0 0\n0 0 inf\n", "a.off:3: need a finite coordinate, found 'inf'");
    check_fails("a.off", "OFF\n0 0 0\n", "a.off: no faces in the file");
}

/* ---- STL ---- */

#define FACET(n, a, b, c)                                                                                    \
    "facet normal " n "\nouter loop\nvertex " a "\nvertex " b "\nvertex " c "\nendloop\nendfacet\n"

static void stl_text(void **state)
{
    (void)state;
    static const char two[] = "solid my part\n" FACET("0 0 1", "0 0 0", "1 0 0", "1 1 0")
        FACET("nan nan nan", "0 0 -0", "1 1 0", "0 1 0") "endsolid my part\n";
    check_loads("a.stl", two, 4, 2, quad_fan); /* shared corners are welded, and -0 is 0 */
    static const char shouting[] =
        "SOLID\r\n FACET NORMAL 0 0 1\r\n OUTER LOOP VERTEX 0 0 0 VERTEX 1 0 0 VERTEX 0 1 0\r\n"
        "ENDLOOP ENDFACET ENDSOLID\r\n";
    check_loads("a.STL", shouting, 3, 1, NULL);
    static const char twice[] =
        "solid a\n" FACET("0 0 1", "0 0 0", "1 0 0", "0 1 0") "endsolid a\nsolid b\n" FACET(
            "0 0 1", "0 0 1", "1 0 1", "0 1 1") "endsolid b";
    check_loads("a.stl", twice, 6, 2, NULL);
}

static void stl_text_messages(void **state)
{
    (void)state;
    check_fails("a.stl", "solid a\n" FACET("0 0 1", "0 0 0", "1 0 0", "1 1 0"),
                "truncated STL: the file ends after 1 triangles without 'endsolid'");
    check_fails("a.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n",
                "a.stl:6: need 'vertex', found 'endloop'");
    check_fails("a.stl", "solid a\nfacet normal 0 0 1\nvertex 0 0 0\n",
                "a.stl:3: need 'outer loop', found 'vertex'");
    check_fails("a.stl", "solid a\n" FACET("0 0 1", "0 0 0", "1 0 0", "1 1 inf"),
                "need a finite coordinate, found 'inf'");
    check_fails(
        "a.stl",
        "solid a\nfacet normal 0 0 1\nouter loop vertex 0 0 0 vertex 1 0 0 vertex 1 1 0 vertex 0 1 0\n",
        "need 'endloop' after three vertices, found 'vertex'");
    check_fails("a.stl", "solid a\nfacet outer loop vertex 0 0 0 vertex 1 0 0 vertex 1 1 0 endloop\n",
                "need 'endfacet', found the end of the file");
    check_fails("a.stl", "solid a\nfacets\n", "a.stl:2: need 'facet' or 'endsolid', found 'facets'");
    check_fails("a.stl", "solid a\nendsolid\nfacet\n", "a.stl:3: need 'solid', found 'facet'");
    check_fails("a.stl", "solid a\nendsolid a\n", "a.stl: no faces in the file");
}

static void put_u32(unsigned char *p, uint32_t v)
{
    for (int k = 0; k < 4; k++) p[k] = (unsigned char)(v >> 8 * k & 255);
}

/* One triangle whose header says n. Returns the size. */
static size_t make_stl(unsigned char out[134], const char *header, uint32_t n, float last)
{
    const float p[9] = {0, 0, 0, 1, 0, 0, 0, 1, last};
    memset(out, 0, 134);
    memcpy(out, header, strlen(header));
    put_u32(out + 80, n);
    for (int k = 0; k < 9; k++) {
        uint32_t u;
        memcpy(&u, &p[k], 4);
        put_u32(out + 96 + 4 * k, u);
    }
    return 134;
}

static void stl_binary(void **state)
{
    (void)state;
    unsigned char raw[134];
    sn_tri_mesh m;
    sn_error err = {0};
    sn_tri_mesh_init(&m);
    size_t n = make_stl(raw, "solid exported by a program that should know better", 1, 0.5f);
    assert_int_equal(load_bytes(&m, "a.stl", raw, n, &err), SN_OK);
    assert_int_equal(m.n_vert, 3);
    assert_true(m.pos[8] == 0.5);
    sn_tri_mesh_free(&m);
    (void)make_stl(raw, "x", 7, 0.0f);
    check_bytes_fail("a.stl", raw, n,
                     "truncated STL: the header promises 7 triangles (434 bytes), the file has 134 bytes");
    (void)make_stl(raw, "solid", 7, 0.0f);
    check_bytes_fail("a.stl", raw, n,
                     "truncated STL: the header promises 7 triangles (434 bytes), the file has 134 bytes");
    (void)make_stl(raw, "x", 4294967295u, 0.0f);
    check_bytes_fail("a.stl", raw, n,
                     "the header promises 4294967295 triangles (214748364834 bytes), the file has 134");
    (void)make_stl(raw, "x", 0, 0.0f);
    check_bytes_fail("a.stl", raw, n, "STL with bytes left over: the header promises 0 triangles (84 bytes)");
    check_bytes_fail("a.stl", raw, 84, "a.stl: no faces in the file");
    check_bytes_fail("a.stl", raw, 83,
                     "not an STL: 83 bytes that do not start with 'solid', a binary one has at least 84");
    check_bytes_fail("a.stl", raw, 0, "not an STL: 0 bytes");
    (void)make_stl(raw, "x", 1, INFINITY);
    check_bytes_fail("a.stl", raw, n, "a coordinate of triangle 1 is not finite, at byte 128");
}

/* ---- PLY ---- */

#define PLY_HEAD                                                                                             \
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
#define PLY_FACE "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
#define PLY_V "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"

static void ply_text(void **state)
{
    (void)state;
    check_loads("a.ply", PLY_HEAD PLY_FACE PLY_V "4 0 1 2 3\n", 4, 2, quad_fan);
    check_loads(
        "a.ply",
        "ply\r\nformat ascii 1.0\r\ncomment a b\r\nobj_info c\r\nelement none 3000000000\r\nelement cam 2\r\n"
        "property list uchar float seen\r\nproperty char c\r\nelement vertex 3\r\nproperty uchar red\r\n"
        "property float64 z\r\nproperty list int8 int32 tags\r\nproperty int16 y\r\nproperty float32 x\r\n"
        "element face 1\r\nproperty list uint8 float uv\r\nproperty list ushort double vertex_index\r\n"
        "property float q\r\nend_header\r\n0 7\r\n2 1.5 nan 7\r\n255 5 2 8 9 6 7\r\n0 1 0 2 3\r\n0 1 1 8 3 "
        "4\r\n"
        "2 0.5 0.5 3 2 1 0 #ff\r\n",
        3, 1, (const int32_t[]){2, 1, 0});
}

static void ply_text_messages(void **state)
{
    (void)state;
    check_fails("a.ply", "", "a.ply:1: need 'ply', found the end of the file");
    check_fails("a.ply", "OFF\n", "a.ply:1: need 'ply', found 'OFF'");
    check_fails("a.ply", "ply\nformat ascii 1.0\nelement vertex 4\n",
                "truncated: the header has no 'end_header'");
    check_fails("a.ply", "ply\nformat pdp 1.0\n",
                "need ascii, binary_little_endian or binary_big_endian, found 'pdp'");
    check_fails("a.ply", "ply\nelement vertex 1\nend_header\n", "a.ply:3: the header has no 'format' line");
    check_fails("a.ply", "ply\nfrobnicate\n",
                "a.ply:2: need a header line (element, property, comment, end_header)");
    check_fails("a.ply", "ply\nproperty float x\n", "a property before the first element");
    check_fails("a.ply", "ply\nelement vertex -1\n", "a.ply:2: -1 rows, need 0 or more");
    check_fails("a.ply", "ply\nelement vertex many\n", "need the number of rows, found 'many'");
    check_fails("a.ply", "ply\nelement v 1\nproperty real x\n", "a.ply:3: need a type (char uchar short");
    check_fails("a.ply", "ply\nelement v 1\nproperty float\n",
                "need the property's name, found the end of the line");
    check_fails("a.ply", "ply\nelement vertex 1\nproperty int x\nproperty int x\n",
                "a.ply:4: property 'x' twice");
    check_fails("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nend_header\n1\n",
                "element 'vertex' needs the properties x, y and z");
    check_fails("a.ply", "ply\nformat ascii 1.0\nelement face 1\nproperty int x\nend_header\n1\n",
                "element 'face' needs a list property 'vertex_indices' or 'vertex_index'");
    check_fails("a.ply", PLY_HEAD "end_header\n" PLY_V, "a.ply: no faces in the file");
    check_fails("a.ply", PLY_HEAD PLY_FACE PLY_V, "the header promises 1 rows of 'face', the file has 0");
    check_fails("a.ply", PLY_HEAD PLY_FACE PLY_V "3 0 1 4\n", "a.ply:14: face names vertex 4, need 0..3");
    check_fails("a.ply", PLY_HEAD PLY_FACE PLY_V "3 0 1 -1\n", "a.ply:14: face names vertex -1, need 0..3");
    check_fails("a.ply", PLY_HEAD PLY_FACE PLY_V "3 0 1 1.5\n", "a.ply:14: need a vertex index, found '1.5'");
    check_fails("a.ply", PLY_HEAD PLY_FACE PLY_V "3 0 1 nan\n", "need a vertex index, found 'nan'");
    check_fails("a.ply", PLY_HEAD PLY_FACE PLY_V "2 0 1\n", "a.ply:14: need 3 or more corners, found '2'");
    check_fails("a.ply", PLY_HEAD PLY_FACE PLY_V "-3 0 1\n", "need 3 or more corners, found '-3'");
    check_fails("a.ply", PLY_HEAD PLY_FACE PLY_V "1e30 0 1\n", "need 3 or more corners, found '1e30'");
    check_fails("a.ply", PLY_HEAD PLY_FACE PLY_V "2000000000 0 1\n",
                "need a vertex index, found the end of the file");
    check_fails("a.ply", PLY_HEAD PLY_FACE "0 0 0 7\n", "a.ply:10: need the end of the line, found '7'");
    check_fails("a.ply", PLY_HEAD PLY_FACE "0 0 nan\n", "a.ply:10: need a finite coordinate, found 'nan'");
    check_fails("a.ply", PLY_HEAD PLY_FACE "0 0 z\n", "a.ply:10: need a coordinate, found 'z'");
}

typedef struct bytes {
    unsigned char data[1024];
    size_t n;
    bool is_big;
} bytes;

static void add_text(bytes *b, const char *s)
{
    memcpy(b->data + b->n, s, strlen(s));
    b->n += strlen(s);
}

static void add_value(bytes *b, const void *v, size_t size)
{
    const unsigned char *p = v; /* of this machine, little-endian */
    for (size_t k = 0; k < size; k++) b->data[b->n++] = p[b->is_big ? size - 1 - k : k];
}

static void add_int(bytes *b, int64_t v, size_t size)
{
    add_value(b, &v, size);
    if (b->is_big) { /* the low bytes only */
        b->n -= size;
        for (size_t k = 0; k < size; k++)
            b->data[b->n++] = (unsigned char)((uint64_t)v >> 8 * (size - 1 - k) & 255);
    }
}

/* Mixed types, extra properties and an element that nobody needs before and after. */
static bytes make_ply(bool is_big, const char *eol)
{
    bytes b = {.is_big = is_big};
    static const char *const lines[] = {"element cam 1",     "property list uchar short q",
                                        "property double f", "element vertex 3",
                                        "property char t",   "property double x",
                                        "property float y",  "property short z",
                                        "element face 1",    "property list ushort uint vertex_indices",
                                        "property uchar c",  "element tail 2",
                                        "property int e",    "end_header"};
    add_text(&b, "ply");
    add_text(&b, eol);
    add_text(&b, is_big ? "format binary_big_endian 1.0" : "format binary_little_endian 1.0");
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        add_text(&b, eol);
        add_text(&b, lines[i]);
    }
    add_text(&b, eol);
    double f = NAN;
    add_int(&b, 10, 1); /* a '\n' right behind the header */
    for (int k = 0; k < 10; k++) add_int(&b, -k, 2);
    add_value(&b, &f, 8);
    for (int i = 0; i < 3; i++) {
        double x = 0.1 * i;
        float y = i == 2 ? 2.5f : 0.0f;
        add_int(&b, -1, 1);
        add_value(&b, &x, 8);
        add_value(&b, &y, 4);
        add_int(&b, -7 * i, 2);
    }
    add_int(&b, 3, 2);
    for (int i = 2; i >= 0; i--) add_int(&b, i, 4);
    add_int(&b, 9, 1);
    for (int i = 0; i < 2; i++) add_int(&b, i, 4);
    return b;
}

static void ply_binary(void **state)
{
    (void)state;
    static const char *const eol[] = {"\n", "\r\n", "\r"};
    for (int i = 0; i < 6; i++) {
        bytes b = make_ply(i % 2, eol[i / 2]);
        sn_tri_mesh m;
        sn_error err = {0};
        sn_tri_mesh_init(&m);
        assert_int_equal(load_bytes(&m, "b.ply", b.data, b.n, &err), SN_OK);
        const double want[9] = {0.0, 0.0, 0.0, 0.1, 0.0, -7.0, 0.2, 2.5, -14.0};
        assert_memory_equal(m.pos, want, sizeof want);
        assert_memory_equal(m.face, ((const int32_t[]){2, 1, 0}), 12);
        sn_tri_mesh_free(&m);
    }
}

static void ply_binary_messages(void **state)
{
    (void)state;
    bytes b = make_ply(false, "\n");
    size_t face = b.n - 8 - 1 - 12 - 2; /* the face's count */
    char want[80];
    (void)snprintf(want, sizeof want,
                   "truncated at byte %zu: the header promises 2 rows of 'tail', the file has 1", b.n - 4);
    check_bytes_fail("b.ply", b.data, b.n - 4, want);
    (void)snprintf(want, sizeof want, "truncated at byte %zu: need 1 values of 4 bytes", b.n - 4);
    check_bytes_fail("b.ply", b.data, b.n - 1, want);
    (void)snprintf(want, sizeof want, "truncated at byte %zu: need a vertex index", face + 6);
    check_bytes_fail("b.ply", b.data, face + 9, want);
    b.data[face] = 255; /* 65283 corners */
    b.data[face + 1] = 255;
    check_bytes_fail("b.ply", b.data, b.n, "need a vertex index");
    b.data[face] = 2;
    b.data[face + 1] = 0;
    (void)snprintf(want, sizeof want, "need 3 or more corners, found 2 at byte %zu", face);
    check_bytes_fail("b.ply", b.data, b.n, want);
    b.data[face] = 3;
    b.data[face + 5] = 128; /* 2 + 2^31 */
    (void)snprintf(want, sizeof want, "face names vertex 2147483650, need 0..2, at byte %zu", face + 2);
    check_bytes_fail("b.ply", b.data, b.n, want);
    b = make_ply(false, "\n");
    memset(b.data + face - 3 * 15 + 1, 255, 8); /* x of the first vertex */
    (void)snprintf(want, sizeof want, "need a finite coordinate, found -nan at byte %zu", face - 44);
    check_bytes_fail("b.ply", b.data, b.n, want);
}

/* ---- Saving ---- */

/* A tet with coordinates that need 17 digits, one of them beside a float. */
static void make_tet(sn_tri_mesh *m)
{
    static const double pos[12] = {0.1, 0.2, -0.3,       1.0 / 3.0, 1e-300, 0,
                                   0.7, 1e5, 12345.6789, -0.0,      5e-324, 2};
    static const int32_t face[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    sn_error err;
    sn_tri_mesh_init(m);
    assert_int_equal(sn_tri_mesh_reserve(m, 4, 4, &err), SN_OK);
    memcpy(m->pos, pos, sizeof pos);
    memcpy(m->face, face, sizeof face);
}

static void same_bits_come_back(void **state)
{
    (void)state;
    static const char *const names[] = {"s.obj", "s.off", "s.ply", "s.PLY", "s.stl"};
    sn_tri_mesh m, back;
    sn_error err = {0};
    make_tet(&m);
    sn_tri_mesh_init(&back);
    for (int i = 0; i < 5; i++) {
        bool ascii = i > 2;
        sn_status st = ascii ? sn_surface_save_ascii(&m, in_folder(names[i]), &err)
                             : sn_surface_save(&m, in_folder(names[i]), &err);
        assert_int_equal(st, SN_OK);
        assert_int_equal(sn_surface_load(&back, in_folder(names[i]), &err), SN_OK);
        assert_int_equal(back.n_vert, 4);
        assert_int_equal(back.n_face, 4);
        for (int f = 0; f < 12; f++) /* by value: welding may number anew */
            assert_memory_equal(back.pos + 3 * back.face[f], m.pos + 3 * m.face[f], 24);
    }
    sn_tri_mesh_free(&back);
    sn_tri_mesh_free(&m);
}

static void binary_stl_holds_floats(void **state)
{
    (void)state;
    sn_tri_mesh m, back;
    sn_error err = {0};
    make_tet(&m);
    sn_tri_mesh_init(&back);
    assert_int_equal(sn_surface_save(&m, in_folder("f.stl"), &err), SN_OK);
    assert_int_equal(sn_surface_load(&back, in_folder("f.stl"), &err), SN_OK);
    for (int f = 0; f < 12; f++)
        for (int k = 0; k < 3; k++)
            assert_true(back.pos[3 * back.face[f] + k] == (double)(float)m.pos[3 * m.face[f] + k]);
    char *data = NULL;
    size_t size = 0;
    assert_int_equal(sn_file_read(in_folder("f.stl"), &data, &size, &err), SN_OK);
    assert_int_equal(size, 84 + 4 * 50);
    assert_memory_not_equal(data, "solid", 5);
    sn_release(data);
    m.pos[4] = -1e39;
    assert_int_equal(sn_surface_save(&m, in_folder("g.stl"), &err), SN_EINVAL);
    assert_non_null(
        strstr(err.msg, "vertex 2 has the coordinate -1e+39, a binary STL holds up to 3.40282e+38"));
    assert_int_not_equal(access(in_folder("g.stl"), F_OK), 0);
    assert_int_equal(sn_surface_save_ascii(&m, in_folder("g.stl"), &err), SN_OK);
    sn_tri_mesh_free(&back);
    sn_tri_mesh_free(&m);
}

static void text_is_as_written_here(void **state)
{
    (void)state;
    static const char *const want[][2] = {
        {"t.obj", "v 0 0 0\nv 1 0 0\nv 0 0.1 0\nf 1 2 3\n"},
        {"t.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 0.1 0\n3 0 1 2\n"},
        {"t.ply",
         "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 0.1 0\n3 0 1 "
         "2\n"},
        {"t.stl", "solid sinew\n" FACET("0 0 1", "0 0 0", "1 0 0", "0 0.1 0") "endsolid sinew\n"},
    };
    double pos[9] = {0, 0, 0, 1, 0, 0, 0, 0.1, 0};
    int32_t face[3] = {0, 1, 2};
    const sn_tri_mesh m = {pos, face, NULL, 3, 1};
    for (size_t i = 0; i < 4; i++) {
        sn_error err = {0};
        char *data = NULL;
        size_t size = 0;
        assert_int_equal(sn_surface_save_ascii(&m, in_folder(want[i][0]), &err), SN_OK);
        assert_int_equal(sn_file_read(in_folder(want[i][0]), &data, &size, &err), SN_OK);
        assert_string_equal(data, want[i][1]);
        sn_release(data);
    }
}

static void refused_paths_and_meshes(void **state)
{
    (void)state;
    sn_tri_mesh m;
    sn_error err = {0};
    make_tet(&m);
    int before = count_files();
    assert_int_equal(sn_surface_save(&m, in_folder("x.fbx"), &err), SN_EINVAL);
    assert_non_null(strstr(err.msg, "unknown surface format 'fbx' (known: .obj .ply .stl .off)"));
    assert_int_equal(sn_surface_save(&m, in_folder("x.vtp"), &err), SN_EINVAL); /* only read */
    assert_non_null(strstr(err.msg, "unknown surface format 'vtp' (known: .obj .ply .stl .off)"));
    assert_int_equal(sn_surface_save(&m, in_folder("plain"), &err), SN_EINVAL);
    assert_int_equal(sn_surface_save(&m, in_folder("none/x.obj"), &err), SN_EIO);
    m.face[5] = 4;
    assert_int_equal(sn_surface_save(&m, in_folder("x.obj"), &err), SN_EINVAL);
    assert_non_null(strstr(err.msg, "x.obj: cannot save: face 2 names vertex 5, need 1..4"));
    assert_int_equal(count_files(), before);
    assert_int_equal(sn_surface_load(&m, in_folder("x.fbx"), &err), SN_EINVAL);
    assert_null(m.pos);
    assert_int_equal(sn_surface_load(&m, in_folder("missing.obj"), &err), SN_EIO);
    assert_non_null(strstr(err.msg, "missing.obj: cannot open: No such file"));
    assert_int_equal(sn_surface_load(&m, folder, &err), SN_EINVAL);
}

/* ---- Hostile input ---- */

static void any_truncation_is_refused_or_valid(void **state)
{
    (void)state;
    static const char *const text[][2] = {
        {"h.obj", "# c\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1/1/1 2//2 \\\n 3 -1\nf 1 2 3\n"},
        {"h.off",
         "COFF # c\n4 2 0\n0 0 0 1 1 1\n1 0 0 1 1 1\n1 1 0 1 1 1\n0 1 0 1 1 1\n4 0 1 2 3\n3 0 1 2 9 9 9\n"},
        {"h.ply", PLY_HEAD PLY_FACE PLY_V "4 0 1 2 3\n"},
        {"h.stl", "solid a\n" FACET("0 0 1", "0 0 0", "1 0 0", "0 1 0") "endsolid a\n"},
    };
    sn_tri_mesh m;
    sn_error err = {0};
    sn_tri_mesh_init(&m);
    for (size_t i = 0; i < 4; i++)
        for (size_t n = 0; n < strlen(text[i][1]); n++)
            if (!load_bytes(&m, text[i][0], text[i][1], n, &err)) sn_tri_mesh_free(&m);
    bytes b = make_ply(true, "\r\n");
    for (size_t n = 0; n < b.n; n++) assert_int_equal(load_bytes(&m, "h.ply", b.data, n, &err), SN_EFORMAT);
    unsigned char raw[134];
    size_t size = make_stl(raw, "solid x", 1, 0.0f);
    for (size_t n = 0; n < size; n++) assert_int_equal(load_bytes(&m, "h.stl", raw, n, &err), SN_EFORMAT);
}

static void garbage_is_refused_or_valid(void **state)
{
    (void)state;
    static const char *const name[] = {"r.obj", "r.off", "r.ply", "r.stl"};
    static const char *const start[] = {"f ", "OFF ", "ply\n", "solid"};
    uint64_t seed = 1;
    sn_tri_mesh m;
    sn_error err = {0};
    sn_tri_mesh_init(&m);
    for (int i = 0; i < 200; i++) {
        unsigned char raw[600];
        for (size_t k = 0; k < sizeof raw; k++) raw[k] = (unsigned char)(next_random(&seed) >> 24);
        if (i % 2) memcpy(raw, start[i / 2 % 4], strlen(start[i / 2 % 4]));
        if (!load_bytes(&m, name[i / 2 % 4], raw, sizeof raw, &err)) sn_tri_mesh_free(&m);
    }
}

/* ---- Memory ---- */

static void every_failed_allocation_is_clean(void **state)
{
    (void)state;
    bytes ply = make_ply(false, "\n");
    put_file("m.ply", ply.data, ply.n);
    static const char *const text[][2] = {
        {"m.obj", "v 2 0 0\nv 0 2 0\nv 0.5 0.5 0\nv -1 -1 0\nf 1 2 3 4\n"},
        {"m.stl", "solid\n" FACET("0 0 1", "0 0 0", "1 0 0", "0 1 0") "endsolid\n"},
        {"m.off", "OFF 3 1\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"}};
    static const char *const name[] = {"m.ply", "m.obj", "m.stl", "m.off"};
    for (size_t i = 0; i < 3; i++) put_file(text[i][0], text[i][1], strlen(text[i][1]));
    for (size_t i = 0; i < 4; i++) {
        sn_status st = SN_ENOMEM;
        for (int n = 0; st; n++) {
            failing f = {n, 0};
            const sn_allocator a = {failing_realloc, &f};
            sn_error err = {0};
            sn_tri_mesh m;
            sn_set_allocator(&a);
            sn_tri_mesh_init(&m);
            st = sn_surface_load(&m, in_folder(name[i]), &err);
            assert_true(st == SN_OK || st == SN_ENOMEM);
            if (st) assert_int_equal(f.n_alive, 0);
            sn_tri_mesh_free(&m);
            assert_int_equal(f.n_alive, 0);
            sn_set_allocator(NULL);
            assert_true(n < 100);
        }
    }
}

/* ---- Real files ---- */

static bool load_data(sn_tri_mesh *m, const char *name)
{
    char path[512];
    const char *root = getenv("SINEW_DATA");
    (void)snprintf(path, sizeof path, "%s/%s", root ? root : "../shared/data", name);
    if (access(path, R_OK) != 0) {
        print_message("%s is missing: not tested\n", path);
        return false;
    }
    sn_error err = {0};
    sn_tri_mesh_init(m);
    sn_status st = sn_surface_load(m, path, &err);
    if (st) fail_msg("%s", err.msg);
    return true;
}

/* The figures are those of the data's README. */
static void real_files_load(void **state)
{
    (void)state;
    sn_tri_mesh m;
    if (load_data(&m, "dog_hindleg/skin.stl")) {
        assert_int_equal(m.n_vert, 16952);
        assert_int_equal(m.n_face, 33900);
        check_close(sn_tri_mesh_volume(&m), 0.0241, 0.0001);
        sn_tri_mesh_free(&m);
    }
    if (load_data(&m, "human/skin.obj")) {
        assert_int_equal(m.n_vert, 19158);
        assert_int_equal(m.n_face, 2 * 18486);
        sn_tri_mesh_free(&m);
    }
    if (load_data(&m, "human/body_only.obj")) {
        assert_int_equal(m.n_face, 26756);
        check_close(sn_tri_mesh_volume(&m), 54.9, 0.05);
        sn_tri_mesh_free(&m);
    }
    if (load_data(&m, "gait2392/posed/femur_r__femur_r.obj")) sn_tri_mesh_free(&m);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(obj_forms),
        cmocka_unit_test(obj_line_ends),
        cmocka_unit_test(obj_messages),
        cmocka_unit_test(numbers_have_the_bits_of_strtod),
        cmocka_unit_test(random_numbers_have_the_bits_of_strtod),
        cmocka_unit_test(concave_polygons_are_cut_inside),
        cmocka_unit_test(polygon_sizes),
        cmocka_unit_test(odd_polygons_give_n_minus_2),
        cmocka_unit_test(off_forms),
        cmocka_unit_test(vtp_polygons),
        cmocka_unit_test(vtp_messages),
        cmocka_unit_test(off_messages),
        cmocka_unit_test(stl_text),
        cmocka_unit_test(stl_text_messages),
        cmocka_unit_test(stl_binary),
        cmocka_unit_test(ply_text),
        cmocka_unit_test(ply_text_messages),
        cmocka_unit_test(ply_binary),
        cmocka_unit_test(ply_binary_messages),
        cmocka_unit_test(same_bits_come_back),
        cmocka_unit_test(binary_stl_holds_floats),
        cmocka_unit_test(text_is_as_written_here),
        cmocka_unit_test(refused_paths_and_meshes),
        cmocka_unit_test(any_truncation_is_refused_or_valid),
        cmocka_unit_test(garbage_is_refused_or_valid),
        cmocka_unit_test(every_failed_allocation_is_clean),
        cmocka_unit_test(real_files_load),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
