/* test_tet_io.c - reading and writing of tet meshes: each format, every message, hostile files. */
#define _DEFAULT_SOURCE /* mkdtemp */

#include "temp_folder.h"
#include "failing_memory.h"

#include "base/alloc.h"
#include "base/file.h"
#include "mesh/tet_io.h"

#include "made_mesh.h"

#include <signal.h>

/* Every accepted mesh must hold to its own rules; a refused one must leave nothing. */
static sn_status load_text(sn_tet_mesh *m, const char *name, const char *text, size_t size, sn_error *err)
{
    put_file(name, text, size);
    sn_status st = sn_tet_mesh_load(m, in_folder(name), err);
    if (st) {
        assert_int_equal(err->code, st);
        assert_true(!m->pos && !m->tet && !m->part && m->n_vert + m->n_tet == 0);
    } else {
        assert_int_equal(sn_tet_mesh_validate(m, err), SN_OK);
    }
    return st;
}

static void check_fails(const char *name, const char *text, const char *part)
{
    sn_tet_mesh m;
    sn_error err = {0};
    sn_tet_mesh_init(&m);
    assert_int_equal(load_text(&m, name, text, strlen(text), &err), SN_EFORMAT);
    if (strncmp(err.msg, folder, strlen(folder)) != 0 || !strstr(err.msg, part))
        fail_msg("message: %s\nwanted:  %s", err.msg, part);
}

/* part: n_tet ids, or NULL for none. */
static void check_loads(const char *name, const char *text, int n_vert, int n_tet, const int32_t *tet,
                        const int32_t *part)
{
    sn_tet_mesh m;
    sn_error err = {0};
    sn_tet_mesh_init(&m);
    if (load_text(&m, name, text, strlen(text), &err)) fail_msg("%s", err.msg);
    assert_int_equal(m.n_vert, n_vert);
    assert_int_equal(m.n_tet, n_tet);
    if (tet) assert_memory_equal(m.tet, tet, 4 * (size_t)n_tet * sizeof *tet);
    assert_int_equal(m.part != NULL, part != NULL);
    if (part) assert_memory_equal(m.part, part, (size_t)n_tet * sizeof *part);
    sn_tet_mesh_free(&m);
}

/* Two tets on both sides of the face (1 2 3), parts 0 and 2, coordinates that need 17 digits. */
static const double two_pos[15] = {-1.0 / 3.0, 0, 0,   0,         0,   0,      0,   1e5,
                                   0,          0, 0.1, 1.0 / 7.0, 0.7, 1e-300, -0.0};
static const int32_t two_tet[8] = {1, 2, 3, 0, 1, 3, 2, 4};
static const int32_t two_part[2] = {0, 2};

static void make_two(sn_tet_mesh *m)
{
    sn_error err = {0};
    sn_tet_mesh_init(m);
    assert_int_equal(sn_tet_mesh_reserve(m, 5, 2, true, &err), SN_OK);
    memcpy(m->pos, two_pos, sizeof two_pos);
    memcpy(m->tet, two_tet, sizeof two_tet);
    memcpy(m->part, two_part, sizeof two_part);
    for (int32_t i = 0; i < 2; i++)
        if (sn_tet_mesh_tet_volume(m, i) < 0.0) {
            int32_t *t = m->tet + 4 * i, d = t[3];
            t[3] = t[2];
            t[2] = d;
        }
    assert_int_equal(sn_tet_mesh_validate(m, &err), SN_OK);
}

static void check_same(const sn_tet_mesh *a, const sn_tet_mesh *b)
{
    assert_int_equal(a->n_vert, b->n_vert);
    assert_int_equal(a->n_tet, b->n_tet);
    assert_memory_equal(a->pos, b->pos, 24 * (size_t)a->n_vert);
    assert_memory_equal(a->tet, b->tet, 16 * (size_t)a->n_tet);
    assert_int_equal(a->part != NULL, b->part != NULL);
    if (a->part) assert_memory_equal(a->part, b->part, 4 * (size_t)a->n_tet);
}

static const char *const three_names[] = {"fat", "m. biceps & <co>",
                                          "\xC3\xBC"
                                          "ber"};
static const double vert_field[15] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 0.1};
static const double tet_field[2] = {0.25, -1e-9};
static const sn_tet_field two_fields[] = {
    {.name = "fiber", .values = vert_field, .n_comp = 3},
    {.name = "stretch", .values = tet_field, .n_comp = 1, .per_tet = true}};

static void same_bits_come_back(void **state)
{
    (void)state;
    static const char *const names[] = {"a.vtu", "t.VTU", "a.mesh"};
    sn_tet_mesh m, back;
    sn_error err = {0};
    make_two(&m);
    sn_tet_mesh_init(&back);
    for (int i = 0; i < 6; i++) {
        const sn_tet_extras x = {
            .part_name = three_names, .n_part = 3, .field = two_fields, .n_field = 2, .ascii = i % 3 == 1};
        if (i == 3) {
            sn_release(m.part); /* the second round without parts */
            m.part = NULL;
        }
        assert_int_equal(sn_tet_mesh_save(&m, i < 3 ? &x : NULL, in_folder(names[i % 3]), &err), SN_OK);
        if (sn_tet_mesh_load(&back, in_folder(names[i % 3]), &err)) fail_msg("%s", err.msg);
        check_same(&m, &back);
    }
    sn_tet_mesh_free(&back);
    sn_tet_mesh_free(&m);
}

static void same_mesh_gives_same_bytes(void **state)
{
    (void)state;
    static const char *const names[] = {"b.vtu", "b.mesh", "b.msh"};
    sn_tet_mesh m;
    sn_error err = {0};
    make_two(&m);
    const sn_tet_extras x = {.part_name = three_names, .n_part = 3, .field = two_fields, .n_field = 2};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(sn_tet_mesh_save(&m, &x, in_folder(names[i]), &err), SN_OK);
        char *first = file_text(names[i]);
        assert_int_equal(sn_tet_mesh_save(&m, &x, in_folder(names[i]), &err), SN_OK);
        char *second = file_text(names[i]);
        assert_string_equal(first, second);
        sn_release(first);
        sn_release(second);
    }
    sn_tet_mesh_free(&m);
}

/* One unit tet, part 1 of two. */
static double unit_pos[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
static int32_t unit_tet[4] = {0, 1, 2, 3}, unit_part[1] = {1};
static const sn_tet_mesh unit = {unit_pos, unit_tet, unit_part, 4, 1};

static void text_is_as_written_here(void **state)
{
    (void)state;
    static const char *const names[] = {"skin", "m. soleus"};
    const sn_tet_field f[2] = {{.name = "a", .values = unit_pos, .n_comp = 1, .per_tet = true},
                               {.name = "n", .values = unit_pos, .n_comp = 3, .is_int = true}};
    const sn_tet_extras x = {.part_name = names, .n_part = 2, .field = f, .n_field = 2, .ascii = true};
    static const char *const want[][2] = {
        {"u.mesh",
         "MeshVersionFormatted 2\n# tissue 1 skin\n# tissue 2 m. soleus\nDimension 3\nVertices\n4\n0 0 0 0\n"
         "1 0 0 0\n0 1 0 0\n0 0 1 0\nTriangles\n4\n2 3 4 2\n1 4 3 2\n1 2 4 2\n1 3 2 2\nTetrahedra\n1\n1 2 3 "
         "4 2\nEnd\n"},
        {"u.msh",
         "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 1 \"skin\"\n3 2 \"m. soleus\"\n"
         "$EndPhysicalNames\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n1\n"
         "1 4 2 2 2 1 2 3 4\n$EndElements\n$ElementData\n1\n\"a\"\n1\n0.0\n3\n0\n1\n1\n1 0\n$EndElementData\n"
         "$NodeData\n1\n\"n\"\n1\n0.0\n3\n0\n3\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodeData\n"},
        {"u.vtu",
         "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
         "byte_order=\"LittleEndian\" "
         "header_type=\"UInt64\">\n<UnstructuredGrid>\n<FieldData>\n<DataArray type=\"String\" "
         "Name=\"tissue_names\" "
         "NumberOfTuples=\"2\" format=\"ascii\">\n115 107 105 110 0\n109 46 32 115 111 108 101 117 115 "
         "0\n</DataArray>\n"
         "</FieldData>\n<Piece NumberOfPoints=\"4\" "
         "NumberOfCells=\"1\">\n<PointData>\n<DataArray type=\"Int32\" Name=\"n\" NumberOfComponents=\"3\" "
         "format=\"ascii\">\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n</DataArray>\n</PointData>\n<CellData>\n"
         "<DataArray type=\"Int32\" Name=\"tissue\" format=\"ascii\">\n1\n</DataArray>\n"
         "<DataArray type=\"Float64\" Name=\"a\" format=\"ascii\">\n0\n</DataArray>\n</CellData>\n<Points>\n"
         "<DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format=\"ascii\">\n0 0 0\n1 0 "
         "0\n0 1 0\n"
         "0 0 1\n</DataArray>\n</Points>\n<Cells>\n<DataArray type=\"Int64\" Name=\"connectivity\" "
         "format=\"ascii\">\n"
         "0 1 2 3\n</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\" "
         "format=\"ascii\">\n4\n</DataArray>\n"
         "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">\n10\n</DataArray>\n</Cells>\n</Piece>\n"
         "</UnstructuredGrid>\n</VTKFile>\n"}};
    for (int i = 0; i < 3; i++) {
        sn_error err = {0};
        assert_int_equal(sn_tet_mesh_save(&unit, &x, in_folder(want[i][0]), &err), SN_OK);
        char *text = file_text(want[i][0]);
        assert_string_equal(text, want[i][1]);
        sn_release(text);
    }
}

static void names_made_up_and_left_out(void **state)
{
    (void)state;
    sn_error err = {0};
    const sn_tet_extras x = {.n_part = 3};
    assert_int_equal(sn_tet_mesh_save(&unit, &x, in_folder("n.msh"), &err), SN_OK);
    char *text = file_text("n.msh");
    assert_non_null(strstr(text, "3\n3 1 \"part0\"\n3 2 \"part1\"\n3 3 \"part2\"\n$EndPhysicalNames\n"));
    sn_release(text);
    assert_int_equal(sn_tet_mesh_save(&unit, NULL, in_folder("n.msh"), &err), SN_OK);
    text = file_text("n.msh");
    assert_null(strstr(text, "Physical"));
    sn_release(text);
    const sn_tet_mesh plain = {unit_pos, unit_tet, NULL, 4, 1};
    assert_int_equal(sn_tet_mesh_save(&plain, NULL, in_folder("n.msh"), &err), SN_OK);
    text = file_text("n.msh");
    assert_non_null(strstr(text, "\n1 4 2 0 1 1 2 3 4\n"));
    sn_release(text);
}

/* The numbers behind a section's head must have the bits of the field, each row behind its number. */
static void check_rows(const char *text, const char *head, const double *want, int n_row, int n_comp)
{
    const char *p = strstr(text, head);
    assert_non_null(p);
    p += strlen(head);
    for (int i = 0; i < n_row; i++) {
        double v = sn_parse_double(p, &p);
        assert_true(v == i + 1);
        for (int k = 0; k < n_comp; k++) {
            v = sn_parse_double(p, &p);
            assert_memory_equal(&v, &want[i * n_comp + k], sizeof v);
        }
        assert_int_equal(*p++, '\n');
    }
    assert_memory_equal(p, "$End", 4);
}

static void gmsh_fields_come_back(void **state)
{
    (void)state;
    static const double whole[6] = {-2147483648.0, 2147483647.0, 0, 1, 2, 3};
    const sn_tet_field f[3] = {two_fields[0], two_fields[1], {"id", whole, 3, true, true}};
    sn_tet_mesh m;
    sn_error err = {0};
    make_two(&m);
    assert_int_equal(
        sn_tet_mesh_save(&m, &(sn_tet_extras){.field = f, .n_field = 3}, in_folder("g.msh"), &err), SN_OK);
    char *text = file_text("g.msh");
    check_rows(text, "$NodeData\n1\n\"fiber\"\n1\n0.0\n3\n0\n3\n5\n", vert_field, 5, 3);
    check_rows(text, "$ElementData\n1\n\"stretch\"\n1\n0.0\n3\n0\n1\n2\n", tet_field, 2, 1);
    check_rows(text, "$ElementData\n1\n\"id\"\n1\n0.0\n3\n0\n3\n2\n", whole, 2, 3);
    assert_non_null(strstr(text, "\n1 -2147483648 2147483647 0\n"));
    sn_release(text);
    sn_tet_mesh_free(&m);
}

/* Base64 of the length (8 bytes: 8) and of the Int32 values -1 and 65536, worked out by hand: the bytes are
 * 08 00 00 00 00 00 00 00 FF FF FF FF 00 00 01 00. */
static void vtu_whole_numbers_are_int32(void **state)
{
    (void)state;
    static const double whole[2] = {-1, 65536};
    const sn_tet_field f = {"id", whole, 1, true, true};
    sn_tet_mesh m;
    sn_error err = {0};
    make_two(&m);
    assert_int_equal(
        sn_tet_mesh_save(&m, &(sn_tet_extras){.field = &f, .n_field = 1}, in_folder("i.vtu"), &err), SN_OK);
    char *text = file_text("i.vtu");
    assert_non_null(strstr(text, "<DataArray type=\"Int32\" Name=\"id\" format=\"binary\">\n"
                                 "CAAAAAAAAAD/////AAABAA==\n</DataArray>\n</CellData>"));
    sn_release(text);
    sn_tet_mesh_free(&m);
}

/* MEDIT has no place for fields: the bytes are those without. */
static void medit_leaves_fields_out(void **state)
{
    (void)state;
    sn_tet_mesh m;
    sn_error err = {0};
    make_two(&m);
    assert_int_equal(sn_tet_mesh_save(&m, NULL, in_folder("p.mesh"), &err), SN_OK);
    assert_int_equal(
        sn_tet_mesh_save(&m, &(sn_tet_extras){.field = two_fields, .n_field = 2}, in_folder("q.mesh"), &err),
        SN_OK);
    char *plain = file_text("p.mesh"), *other = file_text("q.mesh");
    assert_string_equal(plain, other);
    sn_release(plain);
    sn_release(other);
    sn_tet_mesh_free(&m);
}

/* The face between the two parts is there once, with the lower part's reference: 3 + 3 + 1. */
static void medit_borders(void **state)
{
    (void)state;
    sn_tet_mesh m;
    sn_error err = {0};
    make_two(&m);
    assert_int_equal(sn_tet_mesh_save(&m, NULL, in_folder("c.mesh"), &err), SN_OK);
    char *text = file_text("c.mesh"), *p = strstr(text, "Triangles\n");
    assert_non_null(p);
    p += 10;
    int n = (int)strtol(p, &p, 10), n_low = 0, n_shared = 0;
    assert_int_equal(n, 7);
    for (int i = 0; i < n; i++) {
        long v[4];
        for (int k = 0; k < 4; k++) v[k] = strtol(p, &p, 10);
        n_low += v[3] == 1;
        assert_true(v[3] == 1 || v[3] == 3);
        n_shared += v[0] * v[1] * v[2] == 24 && v[0] + v[1] + v[2] == 9; /* 2 3 4 */
    }
    assert_int_equal(n_low, 4);
    assert_int_equal(n_shared, 1);
    sn_release(text);
    sn_tet_mesh_free(&m);
}

/* ---- Refused by the writers ---- */

static void check_refused(const sn_tet_mesh *m, const sn_tet_extras *x, const char *name, const char *part)
{
    sn_error err = {0};
    int before = count_files();
    assert_int_equal(sn_tet_mesh_save(m, x, in_folder(name), &err), SN_EINVAL);
    if (!strstr(err.msg, part)) fail_msg("message: %s\nwanted:  %s", err.msg, part);
    assert_int_equal(count_files(), before);
}

static void refused_meshes(void **state)
{
    (void)state;
    sn_tet_mesh m, none;
    sn_error err = {0};
    sn_tet_mesh_init(&none);
    make_two(&m);
    check_refused(&m, NULL, "x.stl", "x.stl: no tet mesh format to write 'stl' (known: .vtu .mesh .msh)");
    check_refused(&m, NULL, "x.node", "no tet mesh format to write 'node'");
    check_refused(&none, NULL, "x.vtu", "x.vtu: cannot save: tet mesh has no tets");
    check_refused(&m, &(sn_tet_extras){.part_name = three_names, .n_part = 2}, "x.vtu",
                  "tet 2 has part id 2, need 0..1");
    m.part[1] = -1;
    check_refused(&m, NULL, "x.vtu", "tet 2 has part id -1, need 0..2147483646");
    m.part[1] = INT32_MAX;
    check_refused(&m, NULL, "x.mesh", "tet 2 has part id 2147483647");
    m.part[1] = 0;
    m.tet[7] = 5;
    check_refused(&m, NULL, "x.vtu", "tet 2 names vertex 6, need 1..5");
    m.tet[7] = 4;
    m.pos[7] = INFINITY;
    check_refused(&m, NULL, "x.vtu", "vertex 3 has a coordinate that is not finite");
    m.pos[7] = 1.0;
    assert_int_equal(sn_tet_mesh_save(&m, NULL, in_folder("none/x.vtu"), &err), SN_EIO);
    static int32_t same[12] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
    const sn_tet_mesh thrice = {unit_pos, same, NULL, 4, 3};
    check_refused(&thrice, NULL, "x.mesh", "x.mesh: cannot save: tet mesh: face");
    sn_tet_mesh_free(&m);
}

static void check_field_refused(const char *name, const double *values, int n_comp, bool per_tet,
                                const char *part)
{
    const sn_tet_field f[2] = {{.name = "ok", .values = unit_pos, .n_comp = 1},
                               {.name = name, .values = values, .n_comp = n_comp, .per_tet = per_tet}};
    check_refused(&unit, &(sn_tet_extras){.field = f, .n_field = 2}, "x.vtu", part);
}

static void refused_extras(void **state)
{
    (void)state;
    static const double bad[4] = {0, 0, NAN, 0};
    static const char *const names[] = {"a", "b\nc"}, *const quoted[] = {"a", "b\"c"},
                             *const empty[] = {"a", ""};
    check_refused(&unit, &(sn_tet_extras){.part_name = names, .n_part = 2}, "x.mesh",
                  "part 2 needs a name without quotes");
    check_refused(&unit, &(sn_tet_extras){.part_name = quoted, .n_part = 2}, "x.msh",
                  "part 2 needs a name without quotes");
    check_refused(&unit, &(sn_tet_extras){.part_name = empty, .n_part = 2}, "x.vtu", "part 2 needs a name");
    check_refused(&unit, &(sn_tet_extras){.n_part = -1}, "x.vtu",
                  "-1 part names and 0 fields, need 0 or more");
    check_field_refused("f", bad, 1, false, "field 'f' is not finite at vertex 3");
    check_field_refused("f", bad, 3, true, "field 'f' is not finite at tet 1");
    check_field_refused("f", unit_pos, 2, true, "field 'f' has 2 components, need 1 or 3");
    check_field_refused("tissue", unit_pos, 1, true,
                        "field 2 needs a name without quotes and control characters, other than");
    check_field_refused(NULL, unit_pos, 1, true, "field 2 needs a name");
    check_field_refused("ok", unit_pos, 1, false, "two fields are named 'ok'");
}

static void refused_whole_numbers(void **state)
{
    (void)state;
    static const double half[4] = {0, 0, 0.5, 0}, big[1] = {2147483648.0}, small[3] = {0, -2147483649.0, 0};
    const sn_tet_field f[3] = {
        {"f", half, 1, false, true}, {"f", big, 1, true, true}, {"f", small, 3, true, true}};
    check_refused(&unit, &(sn_tet_extras){.field = &f[0], .n_field = 1}, "x.vtu",
                  "field 'f' is 0.5 at vertex 3, need a whole number of 32 bits");
    check_refused(&unit, &(sn_tet_extras){.field = &f[1], .n_field = 1}, "x.msh",
                  "field 'f' is 2147483648 at tet 1, need a whole number of 32 bits");
    check_refused(&unit, &(sn_tet_extras){.field = &f[2], .n_field = 1}, "x.mesh",
                  "field 'f' is -2147483649 at tet 1, need");
}

/* ---- MEDIT ---- */

#define MESH_HEAD "MeshVersionFormatted 2\nDimension 3\n"
#define MESH_V "Vertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 7\n"

static void medit_forms(void **state)
{
    (void)state;
    static const int32_t up[] = {0, 1, 2, 3}, two[] = {0, 1, 2, 3, 0, 1, 2, 3};
    check_loads("f.mesh", MESH_HEAD MESH_V "Tetrahedra\n1\n1 2 3 4 1\nEnd\n", 4, 1, up, (const int32_t[]){0});
    check_loads("f.mesh", MESH_HEAD MESH_V "Tetrahedra\n1\n1 3 2 4 0\nEnd\n", 4, 1,
                (const int32_t[]){0, 2, 3, 1}, NULL);
    check_loads("f.mesh", MESH_HEAD MESH_V "Tetrahedra 2 1 2 3 4 3 1 2 3 4 9", 4, 2, two,
                (const int32_t[]){2, 8});
    check_loads("f.mesh", MESH_HEAD MESH_V "Tetrahedra 2 1 2 3 4 0 1 2 3 4 5", 4, 2, two,
                (const int32_t[]){0, 5});
    check_loads("f.mesh", MESH_HEAD MESH_V "Tetrahedra 2 1 2 3 4 -2 1 2 3 4 5", 4, 2, two, NULL);
    check_loads("F.MESH",
                "# c\r\nMeshVersionFormatted 1\r\n\r\nDimension\r\n3\r\n# tissue 1 a\r\nTetrahedra\r\n1\r\n1 "
                "2 3 4 2 # t\r\n"
                "Vertices\r\n4\r\n0 0 0 0\r\n1 0 0 0\r\n0 1 0 0\r\n0 0 1 0\r\nCorners 2 1 4\r\nTriangles "
                "1\r\n1 2 3 5\r\n"
                "Normals 1 0.5 -1e-3 nan\r\nEnd\r\nthe rest is not looked at",
                4, 1, up, (const int32_t[]){1});
}

static void medit_messages(void **state)
{
    (void)state;
    check_fails("f.mesh", "",
                "f.mesh:1: need 'MeshVersionFormatted' (a MEDIT mesh), found the end of the file");
    check_fails("f.mesh", "MFEM mesh v1.0\n",
                "f.mesh:1: need 'MeshVersionFormatted' (a MEDIT mesh), found 'MFEM'");
    check_fails("f.mesh", "MeshVersionFormatted\nDimension 3\n",
                "f.mesh:2: need the version, found 'Dimension'");
    check_fails("f.mesh", "MeshVersionFormatted 2\nDimension 2\n", "f.mesh:2: dimension 2, need 3");
    check_fails("f.mesh", "MeshVersionFormatted 2\nDimension x\n", "f.mesh:2: need the dimension, found 'x'");
    check_fails("f.mesh", "MeshVersionFormatted 2\n7\n", "f.mesh:2: need a keyword, found '7'");
    check_fails("f.mesh", MESH_HEAD "Vertices\n-1\n",
                "f.mesh:4: -1 is no count, need the number of vertices");
    check_fails("f.mesh", MESH_HEAD "Vertices\nmany\n", "need the number of vertices, found 'many'");
    check_fails("f.mesh", MESH_HEAD "Vertices\n2000000000\n0 0 0 0\n",
                "truncated: the file promises 2000000000 vertices and ends after 1");
    check_fails("f.mesh", MESH_HEAD "Vertices\n1\n0 0 nan 0\n",
                "f.mesh:5: need a finite coordinate, found 'nan'");
    check_fails("f.mesh", MESH_HEAD "Vertices\n1\n0 0 0 End\n",
                "f.mesh:5: need the vertex's reference, found 'End'");
    check_fails("f.mesh", MESH_HEAD MESH_V "Tetrahedra\n9\n1 2 3 4 0\n",
                "truncated: the file promises 9 tetrahedra and ends after 1");
    check_fails("f.mesh", MESH_HEAD MESH_V "Tetrahedra\n1\n1 2 3 5 0\n",
                "f.mesh:11: tetrahedron names vertex 5, need 1..4");
    check_fails("f.mesh", MESH_HEAD MESH_V "Tetrahedra\n1\n1 2 3 0 0\n",
                "f.mesh:11: tetrahedron names vertex 0, need 1..4");
    check_fails("f.mesh", MESH_HEAD MESH_V "Tetrahedra\n1\n1 2 3 End\n",
                "f.mesh:11: need a vertex index, found 'End'");
    check_fails("f.mesh", MESH_HEAD MESH_V "Tetrahedra\n1\n1 2 3 4\nEnd\n",
                "f.mesh:12: need the tetrahedron's reference, found 'End'");
    check_fails("f.mesh", MESH_HEAD MESH_V "Tetrahedra\n1\n1 2 3 3 0\nEnd\n", "f.mesh: tet 1 ");
    check_fails("f.mesh", MESH_HEAD MESH_V "End\n", "f.mesh: no tets in the file");
}

/* ---- TetGen ---- */

static void tetgen_forms(void **state)
{
    (void)state;
    static const int32_t up[] = {0, 1, 2, 3};
    put_text("g.node", "# c\n4 3 1 1\n1 0 0 0 0.5 1\n2 1 0 0 0.5 1\n3 0 1 0 nan 1\n4 0 0 1 0 0 # last\n");
    check_loads("g.ele", "1 4 1\n1  1 2 3 4  7\n# by TetGen\n", 4, 1, up, (const int32_t[]){7});
    check_loads("g.ele", "1\n1  1 2 3 4\n", 4, 1, up, NULL);
    check_loads("g.ele", "1 4 1\n1  1 2 3 4  -1.5\n", 4, 1, up, NULL);
    check_loads("g.ele", "1 10 1\n1  1 2 3 4 5 6 7 8 9 10 2\n", 4, 1, up, (const int32_t[]){2});
    static const char zero[] = "2 4 0\n0 0 1 2 3\n1 3 2 1 0\n";
    put_file("g.ele", zero, sizeof zero - 1);
    check_loads("g.node", "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n", 4, 2,
                (const int32_t[]){0, 1, 2, 3, 3, 2, 1, 0}, NULL);
}

static void tetgen_messages(void **state)
{
    (void)state;
    static const char good[] = "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n";
    put_file("h.node", good, sizeof good - 1);
    check_fails("h.ele", "", "h.ele:1: need the number of tetrahedra, found the end of the file");
    check_fails("h.ele", "-1 4 0\n", "h.ele:1: -1 is no count, need the number of tetrahedra");
    check_fails("h.ele", "1 5 0\n", "5 corners for each tetrahedron, need 4 or 10");
    check_fails("h.ele", "1 4 x\n", "h.ele:1: need a header number, found 'x'");
    check_fails("h.ele", "1000000000 4 0\n1 1 2 3 4\n",
                "the header promises 1000000000 tetrahedra, the file ends after 1");
    check_fails("h.ele", "1 4 0\n0 1 2 3 4\n", "h.ele:2: row number 0, need 1");
    check_fails("h.ele", "1 4 0\nx 1 2 3 4\n", "h.ele:2: need a row number, found 'x'");
    check_fails("h.ele", "1 4 0\n1 1 2 3 5\n", "h.ele:2: tetrahedron names vertex 5, need 1..4");
    check_fails("h.ele", "1 4 0\n1 1 2 3\n", "h.ele:2: need a vertex index, found the end of the line");
    check_fails("h.ele", "1 4 1\n1 1 2 3 4\n",
                "h.ele:2: need the region attribute, found the end of the line");
    check_fails("h.ele", "0 4 0\n", "h.ele: no tets in the file");
    put_text("i.ele", "1 4 0\n0 0 1 2 4\n");
    check_fails("i.node", "4 2 0 0\n", "i.node:1: dimension 2, need 3");
    check_fails("i.node", "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n",
                "i.ele:2: tetrahedron names vertex 4, need 0..3");
    check_fails("i.node", "4 3 0 0\n1 0 0 0\n1 1 0 0\n", "i.node:3: row number 1, need 2");
    check_fails("i.node", "4 3 0 0\n1 0 0 0\n",
                "truncated: the header promises 4 points, the file ends after 1");
    check_fails("i.node", "4 3 0 0\n1 0 0 inf\n", "i.node:2: need a finite coordinate, found 'inf'");
    sn_tet_mesh m;
    sn_error err = {0};
    sn_tet_mesh_init(&m);
    put_file("alone.node", good, sizeof good - 1);
    assert_int_equal(sn_tet_mesh_load(&m, in_folder("alone.node"), &err), SN_EIO);
    assert_non_null(strstr(err.msg, "alone.ele: cannot open"));
}

/* ---- VTU ---- */

#define VTU_TOP                                                                                              \
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" "                                           \
    "byte_order=\"LittleEndian\">\n<UnstructuredGrid>"
#define VTU_POINTS                                                                                           \
    "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1"  \
    "<InformationKey name=\"a>b\">1</InformationKey></DataArray></Points>"
#define VTU_C(values)                                                                                        \
    "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">" values "</DataArray>"
#define VTU_O(values) "<DataArray type='Int32' Name='offsets' format='ascii'>" values "</DataArray>"
#define VTU_T(values) "<DataArray type=\"UInt8\" Name=\"types\">" values "</DataArray>"
#define VTU_CELLS "<Cells>" VTU_C("0 1 2 3") VTU_O("4") VTU_T("10") "</Cells>"
#define VTU_END "</Piece></UnstructuredGrid></VTKFile>\n"
#define VTU(body) VTU_TOP "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">" body VTU_END

static void vtu_forms(void **state)
{
    (void)state;
    static const int32_t up[] = {0, 1, 2, 3};
    check_loads("v.vtu", VTU(VTU_POINTS VTU_CELLS), 4, 1, up, NULL);
    check_loads("v.vtu",
                VTU("<!-- <Cells> --><CellData Scalars=\"q\"><DataArray Name=\"q\" type=\"Foo\" "
                    "format=\"odd\">x</DataArray>"
                    "<DataArray type=\"Int64\" Name=\"MaterialId\" format=\"ascii\"> 5 "
                    "</DataArray></CellData>" VTU_CELLS VTU_POINTS),
                4, 1, up, (const int32_t[]){5});
    check_loads("v.vtu",
                VTU("<CellData><DataArray type=\"Float32\" Name=\"tissue\" format=\"ascii\">3</DataArray>"
                    "<DataArray type=\"Int64\" Name=\"MaterialId\" format=\"ascii\">5</DataArray></CellData>"
                    "<PointData><DataArray type=\"Int32\" Name=\"tissue\" "
                    "format=\"ascii\">9</DataArray></PointData>" VTU_CELLS VTU_POINTS),
                4, 1, up, (const int32_t[]){3});
    check_loads("v.vtu",
                VTU("<CellData><DataArray type=\"Float32\" Name=\"tissue\" "
                    "format=\"ascii\">-3</DataArray></CellData>" VTU_CELLS VTU_POINTS),
                4, 1, up, NULL);
    /* A 4-byte header that is encoded by itself ("BAAAAA==", 4 bytes) and one in a row with its data. */
    check_loads("v.vtu",
                VTU(VTU_POINTS "<Cells>" VTU_C(
                    "0 2 1 3") "<DataArray type=\"Int32\" Name=\"offsets\" format=\"binary\">\n"
                               "BAAAAA==BAAAAA==\n</DataArray><DataArray type=\"UInt8\" Name=\"types\" "
                               "format=\"binary\">AQAAAAo=</DataArray>"
                               "</Cells>"),
                4, 1, (const int32_t[]){0, 2, 3, 1}, NULL);
}

static void vtu_big_endian(void **state)
{
    (void)state;
    check_loads("v.vtu",
                "<VTKFile type=\"UnstructuredGrid\" byte_order=\"BigEndian\" "
                "header_type=\"UInt64\"><Piece>" VTU_POINTS "<Cells>" VTU_C("0 1 2 3")
                    VTU_T("10") "<DataArray type=\"Int64\" Name=\"offsets\" "
                                "format=\"binary\">AAAAAAAAAAgAAAAAAAAABA==</DataArray></Cells>" VTU_END,
                4, 1, NULL, NULL);
}

#define APPENDED(extra, offset)                                                                              \
    "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\" " extra ">\n<Piece><Points>\n"           \
    "<DataArray type=\"Float32\" format=\"appended\" offset=" offset "/></Points>"

/* Bytes of a file that grows; numbers with the lowest byte first. */
typedef struct bytes {
    char at[4096];
    size_t n;
} bytes;

static void put_number(bytes *b, uint64_t v, int size)
{
    for (int k = 0; k < size; k++) b->at[b->n++] = (char)(v >> 8 * k & 0xff);
}

static void put_string(bytes *b, const char *s)
{
    memcpy(b->at + b->n, s, strlen(s));
    b->n += strlen(s);
}

/* As ParaView writes it: what is not wanted (a field) in between, Int64 indices, UInt8 kinds. */
static void appended_data_is_read(void **state)
{
    (void)state;
    static const float pos[12] = {0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 0.5f};
    bytes b = {.n = 0};
    put_string(
        &b, "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\" "
            "header_type=\"UInt64\">\n<UnstructuredGrid><Piece>\n<CellData>"
            "<DataArray type=\"Float64\" Name=\"x\" format=\"appended\" offset=\"56\"/>"
            "<DataArray type=\"Int32\" Name=\"tissue\" format=\"appended\" offset=\"72\"/></CellData>\n"
            "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/>"
            "</Points>\n<Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"appended\" "
            "offset=\"84\"/><DataArray type=\"Int64\" Name=\"offsets\" format=\"appended\" offset=\"124\"/>"
            "<DataArray type=\"UInt8\" Name=\"types\" format=\"appended\" offset=\"140\"/></Cells>\n"
            "</Piece></UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n _");
    put_number(&b, sizeof pos, 8);
    for (int k = 0; k < 12; k++) {
        uint32_t u;
        memcpy(&u, &pos[k], sizeof u);
        put_number(&b, u, 4);
    }
    put_number(&b, 8, 8);
    put_number(&b, 0x3c3c3c3c3c3c3c3cu, 8); /* full of '<' */
    put_number(&b, 4, 8);
    put_number(&b, 7, 4);
    put_number(&b, 32, 8);
    for (uint64_t k = 0; k < 4; k++) put_number(&b, k, 8);
    put_number(&b, 8, 8);
    put_number(&b, 4, 8);
    put_number(&b, 1, 8);
    put_number(&b, 10, 1);
    put_string(&b, "\n</AppendedData>\n</VTKFile>\n");
    sn_tet_mesh m;
    sn_error err = {0};
    sn_tet_mesh_init(&m);
    if (load_text(&m, "raw.vtu", b.at, b.n, &err)) fail_msg("%s", err.msg);
    assert_int_equal(m.n_vert, 4);
    assert_int_equal(m.n_tet, 1);
    assert_int_equal(m.part[0], 7);
    assert_true(m.pos[3] == 2.0 && m.pos[7] == 3.0 && m.pos[11] == 0.5);
    sn_tet_mesh_free(&m);
}

/* Our own arrays, gathered behind the elements one after the other, with the header coded alone or not. */
static void appended_base64_is_read(void **state)
{
    (void)state;
    static const char text[] =
        "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\" header_type=\"UInt32\"><Piece>"
        "<Points><DataArray type=\"UInt8\" format=\"appended\" offset=\"0\"/></Points><Cells>"
        "<DataArray type=\"UInt8\" Name=\"connectivity\" format=\"appended\" offset=\"24\"/>"
        "<DataArray type=\"UInt8\" Name=\"offsets\" format=\"appended\" offset=\"40\"/>"
        "<DataArray type=\"UInt8\" Name=\"types\" format=\"appended\" offset=\"48\"/></Cells></Piece>"
        "<AppendedData encoding=\"base64\">_"
        "DAAAAAAAAAEAAAABAAAAAQ==" /* 12: 0 0 0, 1 0 0, 0 1 0, 0 0 1; 24 characters */
        "BAAAAA==AAECAw=="         /* 4, and 0 1 2 3 on their own            */
        "AQAAAAQ="                 /* 1: 4                                   */
        "AQAAAAo="                 /* 1: 10                                  */
        "</AppendedData></VTKFile>";
    sn_tet_mesh m;
    sn_error err = {0};
    sn_tet_mesh_init(&m);
    if (load_text(&m, "b64.vtu", text, strlen(text), &err)) fail_msg("%s", err.msg);
    assert_true(m.n_vert == 4 && m.n_tet == 1 && !m.part);
    assert_memory_equal(m.pos, unit.pos, 12 * sizeof *m.pos);
    assert_memory_equal(m.tet, unit.tet, 4 * sizeof *m.tet);
    sn_tet_mesh_free(&m);
}

/* ---- Stopping ---- */

typedef struct stopper {
    int n_call, stop_at;
    double last;
    volatile sig_atomic_t cancel;
} stopper;

static void count_progress(void *user, const char *step, double fraction)
{
    stopper *s = user;
    assert_string_equal(step, "saving tets");
    assert_true(fraction >= s->last && fraction <= 1.0);
    s->last = fraction;
    if (++s->n_call == s->stop_at) s->cancel = 1;
}

static void saving_reports_and_stops(void **state)
{
    (void)state;
    static const char *const name[] = {"stop.vtu", "stop.msh", "stop.mesh"};
    enum { n = 24 };
    sn_tet_mesh m = made_lattice(n, sn_v3(0, 0, 0), 1.0 / 3.0);
    sn_error err = {0};
    int n_before = count_files();
    double *field = SN_NEW_ZERO(double, 3 * (size_t)m.n_tet);
    for (size_t k = 0; k < 3 * (size_t)m.n_tet; k++) field[k] = 1.0 / (double)(k + 3);
    const sn_tet_field f = {.name = "fiber", .values = field, .n_comp = 3, .per_tet = true};
    for (int i = 0; i < 3; i++) {
        stopper s = {.last = 0.0};
        const sn_run run = {.cancel = &s.cancel, .progress = count_progress, .user = &s};
        const sn_tet_extras x = {.field = &f, .n_field = 1, .run = &run};
        assert_int_equal(sn_tet_mesh_save(&m, &x, in_folder(name[i]), &err), SN_OK);
        assert_true(s.n_call > 3 && s.last > 0.5);
        assert_int_equal(remove(in_folder(name[i])), 0);
        for (int stop_at = 1; stop_at <= 3; stop_at++) {
            s = (stopper){.stop_at = stop_at};
            assert_int_equal(sn_tet_mesh_save(&m, &x, in_folder(name[i]), &err), SN_ECANCEL);
            assert_string_equal(err.msg, "interrupted while saving tets");
            assert_int_equal(s.n_call, stop_at); /* nothing is written afterwards */
            assert_int_equal(count_files(), n_before);
        }
    }
    sn_release(field);
    sn_tet_mesh_free(&m);
}

static void vtu_messages(void **state)
{
    (void)state;
    check_fails("v.vtu", "", "v.vtu:1: not a VTK XML file: no <VTKFile> at the start");
    check_fails("v.vtu", "<html>\n", "not a VTK XML file: no <VTKFile> at the start");
    check_fails("v.vtu", "<VTKFile type=\"PolyData\">\n", "v.vtu:1: need a VTKFile of type UnstructuredGrid");
    check_fails("v.vtu",
                "<VTKFile type=\"UnstructuredGrid\" compressor=\"vtkZLibDataCompressor\">\n<Points>\n"
                "<DataArray type=\"Float64\" format=\"binary\">AAAA</DataArray>",
                "compressed data is not read: write the file without a compressor");
    check_fails(
        "v.vtu",
        "<VTKFile type=\"UnstructuredGrid\">\n<Points>\n<DataArray type=\"Float64\" format=\"appended\"/>",
        "v.vtu:3: an appended array needs an offset");
    check_fails(
        "v.vtu",
        "<VTKFile type=\"UnstructuredGrid\">\n<Points>\n<DataArray type=\"Float64\" format=\"appended\" "
        "offset=\"x\"/>",
        "v.vtu:3: an appended array needs an offset");
    check_fails("v.vtu", APPENDED("", "\"0\"") "</VTKFile>", "no AppendedData for an appended array");
    check_fails("v.vtu", APPENDED("", "\"0\"") "<AppendedData encoding=\"hex\">_</AppendedData>",
                "appended data needs the encoding raw or base64");
    check_fails("v.vtu", APPENDED("", "\"0\"") "<AppendedData encoding=\"raw\">AAAA</AppendedData>",
                "appended data needs to start with '_'");
    check_fails("v.vtu", APPENDED("", "\"999\"") "<AppendedData encoding=\"raw\">_AAAA</AppendedData>",
                "truncated: an array at offset 999, the data ends at 19");
    check_fails("v.vtu", APPENDED("", "\"0\"") "<AppendedData encoding=\"raw\">_\1\1\1\1</AppendedData>",
                "the array is damaged: it promises 16843009 bytes and has 15");
    check_fails("v.vtu", APPENDED("", "\"0\"") "<AppendedData encoding=\"base64\">_AQEBAQ==</AppendedData>",
                "the array is damaged: it promises 16843009 bytes and has 0");
    check_fails("v.vtu", VTU("<Points><DataArray type=\"Float64\" format=\"hex\">0</DataArray></Points>"),
                "v.vtu:3: an array needs the format binary, ascii or appended");
    check_fails("v.vtu", VTU("<Points><DataArray type=\"Real\" format=\"ascii\">0</DataArray></Points>"),
                "v.vtu:3: an array needs a type, Int8 to Float64");
    check_fails("v.vtu", VTU_TOP "<Piece><Points", "v.vtu:3: truncated: a tag without an end");
    check_fails("v.vtu", VTU_TOP "<Piece><Points><DataArray type=\"Float64\">0 0",
                "truncated: an array without an end");
    check_fails("v.vtu", VTU_TOP "<Piece>" VTU_POINTS VTU_CELLS, "truncated: no </VTKFile>");
    check_fails("v.vtu", VTU(VTU_POINTS VTU_CELLS "</Piece><Piece>" VTU_POINTS VTU_CELLS),
                "a second Piece: only files of one piece are read");
    check_fails("v.vtu", VTU(VTU_CELLS), "v.vtu: no Points with three components");
    check_fails("v.vtu", VTU("<Points><DataArray type=\"Float64\">0 0</DataArray></Points>" VTU_CELLS),
                "no Points with three components");
    check_fails("v.vtu", VTU(VTU_POINTS), "no 'connectivity' in Cells");
    check_fails("v.vtu", VTU(VTU_POINTS "<Cells>" VTU_C("0") "</Cells>"), "no 'offsets' in Cells");
    check_fails("v.vtu", VTU(VTU_POINTS "<Cells>" VTU_C("0") VTU_O("4") "</Cells>"), "no 'types' in Cells");
    check_fails("v.vtu", VTU(VTU_POINTS "<Cells>" VTU_C("0 1 2") VTU_O("3") VTU_T("5") "</Cells>"),
                "v.vtu: cell 1 has type 5, need 10 (tets only)");
    check_fails("v.vtu", VTU(VTU_POINTS "<Cells>" VTU_C("0 1 2") VTU_O("4") VTU_T("10") "</Cells>"),
                "v.vtu: 1 cells with 1 offsets, 3 corners and 0 tissues do not fit");
    check_fails("v.vtu", VTU(VTU_POINTS "<Cells>" VTU_C("0 1 2 3") VTU_O("5") VTU_T("10") "</Cells>"),
                "offset 1 is 5, need 4");
    check_fails("v.vtu", VTU(VTU_POINTS "<Cells>" VTU_C("0 1 2 4") VTU_O("4") VTU_T("10") "</Cells>"),
                "v.vtu: cell 1 names point 4, need 0..3");
    check_fails("v.vtu", VTU(VTU_POINTS "<Cells>" VTU_C("0 1 2 -1") VTU_O("4") VTU_T("10") "</Cells>"),
                "names point -1");
    check_fails("v.vtu", VTU(VTU_POINTS "<Cells>" VTU_C("0 1 2 nan") VTU_O("4") VTU_T("10") "</Cells>"),
                "names point nan");
    check_fails("v.vtu", VTU(VTU_POINTS "<Cells>" VTU_C("0 1 2 q") VTU_O("4") VTU_T("10") "</Cells>"),
                "v.vtu:3: need a number, found 'q'");
    check_fails("v.vtu", VTU("<Points><DataArray type=\"Float64\">0 0 nan</DataArray></Points>" VTU_CELLS),
                "point 0 has a coordinate that is not finite");
    check_fails("v.vtu",
                VTU("<Points><DataArray type=\"Float64\" format=\"binary\">////fwAA</DataArray></Points>"),
                "the array is damaged: it promises 2147483647 bytes and has 2");
    check_fails("v.vtu", VTU("<Points><DataArray type=\"Float64\" format=\"binary\"></DataArray></Points>"),
                "the array is damaged: it promises 0 bytes and has 0");
    check_fails("v.vtu", VTU(VTU_POINTS "<Cells>" VTU_C("") VTU_O("") VTU_T("") "</Cells>"),
                "v.vtu: no tets in the file");
}

static void refused_paths(void **state)
{
    (void)state;
    sn_tet_mesh m;
    sn_error err = {0};
    sn_tet_mesh_init(&m);
    assert_int_equal(sn_tet_mesh_load(&m, in_folder("x.msh"), &err), SN_EINVAL);
    assert_non_null(
        strstr(err.msg, "x.msh: no tet mesh format to read 'msh' (known: .vtu .mesh .node .ele)"));
    assert_int_equal(sn_tet_mesh_load(&m, in_folder("missing.vtu"), &err), SN_EIO);
    assert_non_null(strstr(err.msg, "missing.vtu: cannot open"));
}

/* ---- Hostile input ---- */

static uint64_t next_random(uint64_t *s)
{
    *s ^= *s << 13;
    *s ^= *s >> 7;
    return *s ^= *s << 17;
}

static void damaged_files_are_refused_or_valid(void **state)
{
    (void)state;
    static const char *const name[] = {"d.vtu", "e.VTU", "d.mesh"};
    sn_tet_mesh m;
    sn_error err = {0};
    make_two(&m);
    uint64_t seed = 99;
    for (int i = 0; i < 3; i++) {
        const sn_tet_extras x = {
            .part_name = three_names, .n_part = 3, .field = two_fields, .n_field = 2, .ascii = i == 1};
        assert_int_equal(sn_tet_mesh_save(&m, &x, in_folder(name[i]), &err), SN_OK);
        char *text = file_text(name[i]);
        size_t n = strlen(text);
        sn_tet_mesh back;
        sn_tet_mesh_init(&back);
        for (size_t k = 0; k < n; k += 1 + n / 600)
            if (!load_text(&back, name[i], text, k, &err)) sn_tet_mesh_free(&back);
        for (int k = 0; k < 600; k++) {
            size_t at = next_random(&seed) % n;
            char old = text[at];
            text[at] = k % 2 ? (char)next_random(&seed) : "0-9n<>/\" =\n"[next_random(&seed) % 11];
            if (!load_text(&back, name[i], text, n, &err)) sn_tet_mesh_free(&back);
            if (k % 4) text[at] = old; /* the others stay and add up */
        }
        sn_release(text);
    }
    sn_tet_mesh_free(&m);
}

/* ---- Memory ---- */

static void every_failed_allocation_is_clean(void **state)
{
    (void)state;
    static const char *const name[] = {"m.vtu", "m.mesh", "m.ele"};
    put_text("m.node", "4 3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n");
    put_text("m.ele", "1 4 1\n1 1 2 3 4 1\n");
    const sn_tet_extras x = {.part_name = three_names, .n_part = 3, .field = two_fields, .n_field = 1};
    for (int i = 0; i < 5; i++) { /* two are written, then three read */
        sn_status st = SN_ENOMEM;
        for (int n = 0; st; n++) {
            failing f = {n, 0};
            const sn_allocator a = {failing_realloc, &f};
            sn_error err = {0};
            sn_tet_mesh m;
            sn_set_allocator(&a);
            sn_tet_mesh_init(&m);
            if (i < 2)
                st = sn_tet_mesh_save(&unit, &x, in_folder(name[i]), &err);
            else
                st = sn_tet_mesh_load(&m, in_folder(name[i - 2]), &err);
            assert_true(st == SN_OK || st == SN_ENOMEM);
            sn_tet_mesh_free(&m);
            assert_int_equal(f.n_alive, 0);
            sn_set_allocator(NULL);
            assert_true(n < 100);
        }
    }
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_bits_come_back),
        cmocka_unit_test(same_mesh_gives_same_bytes),
        cmocka_unit_test(text_is_as_written_here),
        cmocka_unit_test(names_made_up_and_left_out),
        cmocka_unit_test(gmsh_fields_come_back),
        cmocka_unit_test(vtu_whole_numbers_are_int32),
        cmocka_unit_test(medit_leaves_fields_out),
        cmocka_unit_test(medit_borders),
        cmocka_unit_test(refused_meshes),
        cmocka_unit_test(refused_extras),
        cmocka_unit_test(refused_whole_numbers),
        cmocka_unit_test(medit_forms),
        cmocka_unit_test(medit_messages),
        cmocka_unit_test(tetgen_forms),
        cmocka_unit_test(tetgen_messages),
        cmocka_unit_test(vtu_forms),
        cmocka_unit_test(vtu_big_endian),
        cmocka_unit_test(vtu_messages),
        cmocka_unit_test(appended_data_is_read),
        cmocka_unit_test(appended_base64_is_read),
        cmocka_unit_test(saving_reports_and_stops),
        cmocka_unit_test(refused_paths),
        cmocka_unit_test(damaged_files_are_refused_or_valid),
        cmocka_unit_test(every_failed_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
