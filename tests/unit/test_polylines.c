/* test_polylines.c - lines of points: making them, their files read back by hand, every message. */
#define _DEFAULT_SOURCE /* mkdtemp */

#include "temp_folder.h"
#include "failing_memory.h"

#include "base/alloc.h"
#include "mesh/polylines.h"

#include <locale.h>

static void add(sn_polylines *p, double x, double y, double z, double value)
{
    sn_error err = {0};
    if (sn_polylines_add(p, sn_v3(x, y, z), value, &err)) fail_msg("%s", err.msg);
}

static void begin(sn_polylines *p, int32_t part)
{
    sn_error err = {0};
    if (sn_polylines_begin(p, part, &err)) fail_msg("%s", err.msg);
}

/* Three lines of the parts 2, 2, 0 with 3, 2 and 2 points; coordinates that need 17 digits. */
static void make_three(sn_polylines *p, bool has_value)
{
    sn_polylines_init(p, has_value);
    begin(p, 2);
    add(p, 0, 0, 0, 0);
    add(p, 3, 4, 0, 1.0 / 3.0);
    add(p, 3, 4, 12, 1);
    begin(p, 2);
    add(p, -1e-300, 1.0 / 7.0, 1e5, 0.25);
    add(p, 0.1, -0.0, 0.7, 0.75);
    begin(p, 0);
    add(p, 1, 2, 3, 0.5);
    add(p, 1, 2, 4, 0.6);
}

/* first must be ascending from 0 to n_point. */
static void check_rows(const sn_polylines *p, size_t n_line, size_t n_point)
{
    assert_int_equal(p->n_line, n_line);
    assert_int_equal(p->n_point, n_point);
    if (n_line == 0) return;
    assert_int_equal(p->first[0], 0);
    for (size_t i = 0; i < n_line; i++) assert_true(p->first[i] <= p->first[i + 1]);
    assert_int_equal(p->first[n_line], n_point);
}

static void check_point(const sn_polylines *p, size_t k, double x, double y, double z)
{
    const double want[3] = {x, y, z};
    assert_memory_equal(p->pos + 3 * k, want, sizeof want);
}

static void check_same(const sn_polylines *a, const sn_polylines *b)
{
    check_rows(b, a->n_line, a->n_point);
    assert_memory_equal(a->first, b->first, 8 * (a->n_line + 1));
    assert_memory_equal(a->part, b->part, 4 * a->n_line);
    assert_memory_equal(a->pos, b->pos, 24 * a->n_point);
    assert_int_equal(a->has_value, b->has_value);
    if (a->has_value) assert_memory_equal(a->value, b->value, 8 * a->n_point);
}

/* ---- Lines ---- */

static void lines_are_rows_of_points(void **state)
{
    (void)state;
    sn_polylines p;
    make_three(&p, true);
    check_rows(&p, 3, 7);
    static const int64_t first[4] = {0, 3, 5, 7};
    static const int32_t part[3] = {2, 2, 0};
    static const double value[7] = {0, 1.0 / 3.0, 1, 0.25, 0.75, 0.5, 0.6};
    assert_memory_equal(p.first, first, sizeof first);
    assert_memory_equal(p.part, part, sizeof part);
    assert_memory_equal(p.value, value, sizeof value);
    check_point(&p, 4, 0.1, -0.0, 0.7);
    assert_int_equal(sn_polylines_count(&p, 0), 3);
    assert_true(sn_polylines_length(&p, 0) == 5.0 + 12.0); /* 3 4 5, then straight up */
    assert_true(sn_polylines_length(&p, 2) == 1.0);
    sn_box3 b = sn_polylines_bounds(&p);
    assert_true(b.min.x == -1e-300 && b.min.y == 0.0 && b.min.z == 0.0);
    assert_true(b.max.x == 3.0 && b.max.y == 4.0 && b.max.z == 1e5);
    sn_polylines_free(&p);
    assert_true(p.has_value && !p.pos && !p.first && !p.part && !p.value);
    sn_polylines_free(&p);
    make_three(&p, false);
    assert_null(p.value);
    sn_polylines_free(&p);
}

static void empty_lines_are_fine(void **state)
{
    (void)state;
    sn_polylines p;
    sn_error err = {0};
    sn_polylines_init(&p, false);
    sn_polylines_reverse_last(&p);
    sn_polylines_drop_last(&p);
    check_rows(&p, 0, 0);
    assert_true(sn_box3_is_empty(sn_polylines_bounds(&p)));
    assert_int_equal(sn_polylines_add(&p, sn_v3(0, 0, 0), 0, &err), SN_EINVAL);
    assert_string_equal(err.msg, "lines: a point before the first line");
    begin(&p, 0);
    begin(&p, 1);
    check_rows(&p, 2, 0);
    assert_true(sn_polylines_length(&p, 1) == 0.0);
    sn_polylines_reverse_last(&p);
    add(&p, 1, 2, 3, 0);
    assert_true(sn_polylines_length(&p, 1) == 0.0);
    sn_polylines_reverse_last(&p);
    check_point(&p, 0, 1, 2, 3);
    assert_int_equal(sn_polylines_count(&p, 0), 0);
    sn_polylines_free(&p);
}

static void only_the_last_line_turns(void **state)
{
    (void)state;
    sn_polylines p;
    make_three(&p, true);
    sn_polylines_reverse_last(&p); /* even */
    check_point(&p, 5, 1, 2, 4);
    check_point(&p, 6, 1, 2, 3);
    assert_true(p.value[5] == 0.6 && p.value[6] == 0.5);
    check_point(&p, 4, 0.1, -0.0, 0.7);
    add(&p, 9, 9, 9, 7); /* odd: the middle stays */
    sn_polylines_reverse_last(&p);
    check_point(&p, 5, 9, 9, 9);
    check_point(&p, 6, 1, 2, 3);
    check_point(&p, 7, 1, 2, 4);
    assert_true(p.value[5] == 7 && p.value[6] == 0.5 && p.value[7] == 0.6);
    check_rows(&p, 3, 8);
    sn_polylines_free(&p);
}

static void dropped_lines_leave_room(void **state)
{
    (void)state;
    sn_polylines p, want;
    make_three(&p, true);
    make_three(&want, true);
    sn_polylines_drop_last(&p);
    check_rows(&p, 2, 5);
    begin(&p, 0);
    add(&p, 1, 2, 3, 0.5);
    add(&p, 1, 2, 4, 0.6);
    check_same(&want, &p);
    for (int i = 0; i < 5; i++) sn_polylines_drop_last(&p);
    check_rows(&p, 0, 0);
    sn_polylines_free(&want);
    sn_polylines_free(&p);
}

/* Appending in pieces gives what one long making gives. */
static void appended_lines_follow(void **state)
{
    (void)state;
    sn_polylines all, p, three, none;
    sn_error err = {0};
    sn_polylines_init(&all, true);
    sn_polylines_init(&p, true);
    sn_polylines_init(&none, true);
    make_three(&three, true);
    for (int i = 0; i < 50; i++) {
        for (size_t k = 0; k < three.n_line; k++) {
            begin(&all, three.part[k]);
            for (int64_t j = three.first[k]; j < three.first[k + 1]; j++) {
                sn_vec3 at = sn_polylines_point(&three, (size_t)j);
                add(&all, at.x, at.y, at.z, three.value[j]);
            }
        }
        assert_int_equal(sn_polylines_append(&p, &three, &err), SN_OK);
        assert_int_equal(sn_polylines_append(&p, &none, &err), SN_OK);
    }
    check_same(&all, &p);
    begin(&none, 1); /* a line, but no point */
    assert_int_equal(sn_polylines_append(&p, &none, &err), SN_OK);
    check_rows(&p, 151, 350);
    sn_polylines_free(&all);
    assert_int_equal(sn_polylines_append(&all, &none, &err), SN_OK);
    check_rows(&all, 1, 0);
    sn_polylines plain;
    make_three(&plain, false);
    assert_int_equal(sn_polylines_append(&p, &plain, &err), SN_EINVAL);
    assert_string_equal(err.msg, "lines: cannot join lines with values and lines without");
    check_rows(&p, 151, 350);
    sn_polylines_free(&plain);
    sn_polylines_free(&three);
    sn_polylines_free(&none);
    sn_polylines_free(&all);
    sn_polylines_free(&p);
}

/* ---- Files ---- */

static const char *const names[3] = {"m. biceps & <co>", "skin",
                                     "\xC3\xBC"
                                     "ber"};

/* One digit at a time, by the table of RFC 4648. Returns the number of bytes. */
static size_t decode_base64(const char *text, unsigned char *out)
{
    static const char table[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    size_t n = 0;
    unsigned bits = 0;
    int n_bits = 0;
    for (const char *digit; *text && (digit = strchr(table, *text)); text++) {
        bits = bits << 6 | (unsigned)(digit - table);
        n_bits += 6;
        if (n_bits < 8) continue;
        n_bits -= 8;
        out[n++] = (unsigned char)(bits >> n_bits & 0xFF);
    }
    return n;
}

/* The bytes of the array that begins with this tag, behind their length. */
static void check_array(const char *text, const char *tag, const void *want, size_t size)
{
    static unsigned char raw[1024];
    const char *p = strstr(text, tag);
    if (!p) fail_msg("no %s", tag);
    p += strlen(tag);
    assert_int_equal(*p++, '\n');
    assert_true(strcspn(p, "\n") < sizeof raw);
    size_t n = decode_base64(p, raw);
    uint64_t said;
    memcpy(&said, raw, 8);
    assert_int_equal(n, 8 + size);
    assert_int_equal(said, size);
    assert_memory_equal(raw + 8, want, size);
}

static void vtp_comes_back(void **state)
{
    (void)state;
    static const int64_t corner[7] = {0, 1, 2, 3, 4, 5, 6};
    sn_polylines p;
    sn_error err = {0};
    make_three(&p, true);
    if (sn_polylines_save(&p, names, 3, in_folder("a.VTP"), &err)) fail_msg("%s", err.msg);
    char *text = file_text("a.VTP");
#define ARRAY(type, name, more) "<DataArray type=\"" type "\" Name=\"" name "\"" more " format=\"binary\">"
    check_array(text, ARRAY("String", "tissue_names", " NumberOfTuples=\"3\""),
                "m. biceps & <co>\0skin\0\xC3\xBC"
                "ber",
                28);
    check_array(text, ARRAY("Float64", "u", ""), p.value, 7 * 8);
    check_array(text, ARRAY("Int32", "tissue", ""), p.part, 3 * 4);
    check_array(text, ARRAY("Float64", "Points", " NumberOfComponents=\"3\""), p.pos, 21 * 8);
    check_array(text, ARRAY("Int64", "connectivity", ""), corner, sizeof corner);
    check_array(text, ARRAY("Int64", "offsets", ""), p.first + 1, 3 * 8);
#undef ARRAY
    sn_release(text);
    sn_polylines_free(&p);
}

/* What stands between the arrays: their order and the counts. */
static void vtp_has_this_frame(void **state)
{
    (void)state;
    static const char *const frame[] = {
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n<DataArray type=\"String\" Name=\"tissue_names\"",
        "</DataArray>\n</FieldData>\n<Piece NumberOfPoints=\"7\" NumberOfVerts=\"0\" NumberOfLines=\"3\" "
        "NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<PointData>\n</PointData>\n<CellData>\n"
        "<DataArray type=\"Int32\" Name=\"tissue\"",
        "</DataArray>\n</CellData>\n<Points>\n<DataArray type=\"Float64\" Name=\"Points\"",
        "</DataArray>\n</Points>\n<Lines>\n<DataArray type=\"Int64\" Name=\"connectivity\"",
        "</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\"",
        "</DataArray>\n</Lines>\n</Piece>\n</PolyData>\n</VTKFile>\n"};
    sn_polylines p;
    sn_error err = {0};
    make_three(&p, false);
    assert_int_equal(sn_polylines_save(&p, names, 3, in_folder("f.vtp"), &err), SN_OK);
    char *text = file_text("f.vtp"), *at = text;
    for (size_t i = 0; i < sizeof frame / sizeof *frame; i++) {
        char *found = strstr(at, frame[i]);
        if (!found) fail_msg("not there, or too early: %s", frame[i]);
        if (i == 0) assert_ptr_equal(found, text);
        at = found + strlen(frame[i]);
    }
    assert_int_equal(*at, '\0');
    sn_release(text);
    sn_polylines_free(&p);
}

static void obj_is_as_written_here(void **state)
{
    (void)state;
    static const char want[] =
        "v 0 0 0\nv 3 4 0\nv 3 4 12\nv -1e-300 0.14285714285714285 100000\nv 0.1 -0 0.7\nv 1 2 3\nv 1 2 4\n"
        "o \xC3\xBC"
        "ber\nl 1 2 3\nl 4 5\no m. biceps & <co>\nl 6 7\n";
    sn_polylines p;
    sn_error err = {0};
    make_three(&p, true);
    assert_int_equal(sn_polylines_save(&p, names, 3, in_folder("a.obj"), &err), SN_OK);
    char *text = file_text("a.obj");
    assert_string_equal(text, want);
    sn_release(text);
    sn_polylines_free(&p);
}

/* Also under a locale with decimal commas, where the machine has one. */
static void same_lines_give_same_bytes(void **state)
{
    (void)state;
    static const char *const path[] = {"b.vtp", "b.obj"};
    sn_polylines p;
    sn_error err = {0};
    make_three(&p, true);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(sn_polylines_save(&p, names, 3, in_folder(path[i]), &err), SN_OK);
        char *first = file_text(path[i]);
        (void)setlocale(LC_ALL, "de_DE.UTF-8");
        assert_int_equal(sn_polylines_save(&p, names, 3, in_folder(path[i]), &err), SN_OK);
        (void)setlocale(LC_ALL, "C");
        char *second = file_text(path[i]);
        assert_string_equal(first, second);
        sn_release(first);
        sn_release(second);
    }
    sn_polylines_free(&p);
}

static void check_refused(const sn_polylines *p, const char *const *part_name, int32_t n_part,
                          const char *name, const char *part)
{
    sn_error err = {0};
    int before = count_files();
    assert_int_equal(sn_polylines_save(p, part_name, n_part, in_folder(name), &err), SN_EINVAL);
    if (strncmp(err.msg, in_folder(name), strlen(in_folder(name))) != 0 || !strstr(err.msg, part))
        fail_msg("message: %s\nwanted:  %s", err.msg, part);
    assert_int_equal(count_files(), before);
}

static void refused_lines(void **state)
{
    (void)state;
    sn_polylines p, none;
    sn_error err = {0};
    sn_polylines_init(&none, false);
    make_three(&p, true);
    check_refused(&p, names, 3, "x.stl", "x.stl: no format of lines to write 'stl' (known: .vtp .obj)");
    check_refused(&p, names, 3, "plain", "plain: no format of lines to write '' (known: .vtp .obj)");
    check_refused(&none, names, 3, "x.vtp", "x.vtp: cannot save: there are no lines");
    check_refused(&p, NULL, -1, "x.vtp", "x.vtp: cannot save: -1 part names, need 0 or more");
    p.part[1] = 3;
    check_refused(&p, names, 3, "x.obj", "line 2 has part id 3, which has no name (there are 3 names)");
    check_refused(&p, NULL, 0, "x.obj", "line 1 has part id 2, which has no name (there are 0 names)");
    p.part[1] = -1;
    check_refused(&p, names, 3, "x.vtp", "line 2 has part id -1, which has no name");
    p.part[1] = 2;
    p.pos[3 * 4 + 1] = NAN;
    check_refused(&p, names, 3, "x.vtp", "point 2 of line 2 has a coordinate that is not finite");
    p.pos[3 * 4 + 1] = 0;
    p.value[6] = INFINITY;
    check_refused(&p, names, 3, "x.obj", "point 2 of line 3 has a value that is not finite");
    p.value[6] = 0;
    begin(&p, 0);
    check_refused(&p, names, 3, "x.obj", "line 4 has 0 points, need 2 or more");
    add(&p, 0, 0, 0, 0);
    check_refused(&p, names, 3, "x.vtp", "line 4 has 1 points, need 2 or more");
    sn_polylines_drop_last(&p);
    assert_int_equal(sn_polylines_save(&p, names, 3, in_folder("none/x.vtp"), &err), SN_EIO);
    sn_polylines_free(&p);
}

static void refused_names(void **state)
{
    (void)state;
    static const char *const bad[][3] = {
        {"a", "b\nc", "d"}, {"a", "b\"c", "d"}, {"a", "", "d"}, {"a", NULL, "d"}};
    static const char *const slash[3] = {"a\\b", "c\\", "d"};
    sn_polylines p;
    sn_error err = {0};
    make_three(&p, false);
    for (int i = 0; i < 4; i++)
        check_refused(&p, bad[i], 3, i % 2 ? "x.obj" : "x.vtp",
                      "cannot save: part 2 needs a name without quotes and control characters");
    put_text("s.obj", "old\n");
    check_refused(&p, slash, 3, "s.obj",
                  "cannot save: the name 'c\\' ends with a backslash, which joins lines in .obj");
    char *text = file_text("s.obj");
    assert_string_equal(text, "old\n");
    sn_release(text);
    assert_int_equal(sn_polylines_save(&p, slash, 3, in_folder("s.vtp"), &err), SN_OK);
    sn_polylines_free(&p);
}

/* ---- Memory ---- */

static sn_status make_and_save(sn_polylines *p, const sn_polylines *three, const char *name, sn_error *err)
{
    sn_status st = sn_polylines_begin(p, 1, err);
    if (!st) st = sn_polylines_add(p, sn_v3(0, 0, 0), 0, err);
    if (!st) st = sn_polylines_add(p, sn_v3(0, 0, 1), 1, err);
    for (int i = 0; i < 20 && !st; i++) st = sn_polylines_append(p, three, err);
    if (!st) st = sn_polylines_save(p, names, 3, in_folder(name), err);
    return st;
}

static void every_failed_allocation_is_clean(void **state)
{
    (void)state;
    static const char *const path[] = {"m.vtp", "m.obj"};
    sn_polylines three;
    make_three(&three, true);
    for (int i = 0; i < 2; i++) {
        sn_status st = SN_ENOMEM;
        for (int n = 0; st; n++) {
            failing f = {n, 0};
            const sn_allocator a = {failing_realloc, &f};
            sn_error err = {0};
            sn_polylines p;
            sn_set_allocator(&a);
            sn_polylines_init(&p, true);
            st = make_and_save(&p, &three, path[i], &err);
            assert_true(st == SN_OK || st == SN_ENOMEM);
            if (st) assert_int_equal(access(in_folder(path[i]), F_OK), -1);
            f.left = 100;
            size_t n_line = p.n_line, n_point = p.n_point;
            begin(&p, 2); /* still usable */
            add(&p, 7, 8, 9, 1);
            check_rows(&p, n_line + 1, n_point + 1);
            check_point(&p, n_point, 7, 8, 9);
            sn_polylines_free(&p);
            assert_int_equal(f.n_alive, 0);
            sn_set_allocator(NULL);
            assert_true(n < 100);
        }
    }
    sn_polylines_free(&three);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_are_rows_of_points),
        cmocka_unit_test(empty_lines_are_fine),
        cmocka_unit_test(only_the_last_line_turns),
        cmocka_unit_test(dropped_lines_leave_room),
        cmocka_unit_test(appended_lines_follow),
        cmocka_unit_test(vtp_comes_back),
        cmocka_unit_test(vtp_has_this_frame),
        cmocka_unit_test(obj_is_as_written_here),
        cmocka_unit_test(same_lines_give_same_bytes),
        cmocka_unit_test(refused_lines),
        cmocka_unit_test(refused_names),
        cmocka_unit_test(every_failed_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
