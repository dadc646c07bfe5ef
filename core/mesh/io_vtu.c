/* io_vtu.c - VTK XML with inline base64 or text arrays: unstructured grids (.vtu), and reading the polygons
 * of polygonal data (.vtp). */
#include "mesh/io_private.h"

#include "base/alloc.h"

#include <string.h>

enum { VTK_TETRA = 10 };

/* ---- Reading ---- */

typedef struct tag {
    sn_word name;
    const char *attr, *end; /* the attributes */
    bool closes, is_empty;  /* </name>, <name/> */
} tag;

typedef struct vtu {
    sn_scan *s;
    const char *type;  /* of the file: "UnstructuredGrid" */
    const char *cells; /* the element that holds the cells: "Cells" */
    sn_vtk_layout layout;
    bool is_compressed, in_piece;
    sn_word section; /* the element that holds the arrays: Points, Cells, CellData, ... */
    sn_vtk_values point, corner, offset, kind, part;
} vtu;

/* Steps over what begins with `open` and ends with `close`; false when it is not there. */
static bool skip_block(sn_scan *s, const char *open, const char *close)
{
    size_t n = strlen(open), m = strlen(close);
    if (sn_scan_left(s) < n || memcmp(s->p, open, n) != 0) return false;
    for (s->p += n; sn_scan_left(s) >= m && memcmp(s->p, close, m) != 0;) s->p++;
    s->p = sn_scan_left(s) >= m ? s->p + m : s->end;
    return true;
}

static bool is_name_char(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == ':';
}

/* The next tag; false at the end of the file. */
static sn_status next_tag(sn_scan *s, tag *t, bool *is_there, sn_error *err)
{
    *is_there = false;
    do {
        s->p = s->p < s->end ? memchr(s->p, '<', sn_scan_left(s)) : NULL;
        if (!s->p) {
            s->p = s->end;
            return SN_OK;
        }
    } while (skip_block(s, "<!--", "-->") || skip_block(s, "<?", "?>") || skip_block(s, "<!", ">"));
    sn_scan here = *s;
    *t = (tag){.closes = *++s->p == '/'};
    if (t->closes) s->p++;
    t->name.s = s->p;
    while (s->p < s->end && is_name_char(*s->p)) s->p++;
    t->name.n = (size_t)(s->p - t->name.s);
    t->attr = s->p;
    for (char quote = 0; s->p < s->end && (quote || *s->p != '>'); s->p++) {
        if (quote ? *s->p == quote : *s->p == '"' || *s->p == '\'') quote = quote ? 0 : *s->p;
    }
    if (s->p >= s->end) return sn_scan_fail(&here, err, "truncated: a tag without an end");
    t->is_empty = s->p > t->attr && s->p[-1] == '/';
    t->end = s->p++ - t->is_empty;
    *is_there = true;
    return SN_OK;
}

/* The value of an attribute; n = 0 when it is missing. */
static sn_word attribute(const tag *t, const char *key)
{
    size_t n = strlen(key);
    for (const char *p = t->attr; p < t->end;) {
        while (p < t->end && !is_name_char(*p)) p++;
        const char *name = p;
        while (p < t->end && is_name_char(*p)) p++;
        size_t n_name = (size_t)(p - name);
        while (p < t->end && *p != '"' && *p != '\'') p++;
        if (p >= t->end) break;
        const char *value = p + 1, *close = memchr(value, *p, (size_t)(t->end - value));
        if (!close) break;
        if (n_name == n && memcmp(name, key, n) == 0) return (sn_word){value, (size_t)(close - value)};
        p = close + 1;
    }
    return (sn_word){t->attr, 0};
}

static sn_number_type find_type(sn_word w)
{
    static const char *const name[SN_NO_NUMBER] = {"Int8",   "UInt8", "Int16",  "UInt16",  "Int32",
                                                   "UInt32", "Int64", "UInt64", "Float32", "Float64"};
    for (int t = 0; t < SN_NO_NUMBER; t++)
        if (sn_word_is(w, name[t])) return (sn_number_type)t;
    return SN_NO_NUMBER;
}

/* The array that a DataArray fills, or NULL when nobody needs it. */
static sn_vtk_values *find_target(vtu *r, const tag *t)
{
    sn_word name = attribute(t, "Name");
    if (sn_word_is(r->section, "Points")) return &r->point;
    if (sn_word_is(r->section, r->cells)) {
        if (sn_word_is(name, "connectivity")) return &r->corner;
        if (sn_word_is(name, "offsets")) return &r->offset;
        return sn_word_is(name, "types") ? &r->kind : NULL;
    }
    bool is_part = sn_word_is(name, "tissue") || (sn_word_is(name, "MaterialId") && !r->part.is_there);
    return is_part && sn_word_is(r->section, "CellData") ? &r->part : NULL;
}

static sn_status note_appended(vtu *r, const tag *t, sn_number_type type, sn_vtk_values *out, sn_error *err)
{
    sn_word at = attribute(t, "offset");
    sn_scan s = *r->s;
    int64_t offset = -1;
    s.p = at.s;
    if (at.n == 0 || !sn_scan_digits(&s, &offset) || s.p != at.s + at.n || offset < 0)
        return sn_scan_fail(r->s, err, "an appended array needs an offset");
    out->is_appended = true;
    out->offset = (size_t)offset;
    out->type = type;
    return SN_OK;
}

static sn_status read_array(vtu *r, const tag *t, sn_error *err)
{
    sn_vtk_values *out = find_target(r, t);
    if (!out) return SN_OK;
    sn_word format = attribute(t, "format");
    sn_number_type type = find_type(attribute(t, "type"));
    if (r->is_compressed && !(format.n == 0 || sn_word_is(format, "ascii")))
        return sn_scan_fail(r->s, err, "compressed data is not read: write the file without a compressor");
    if (type == SN_NO_NUMBER) return sn_scan_fail(r->s, err, "an array needs a type, Int8 to Float64");
    sn_release(out->v);
    *out = (sn_vtk_values){.is_there = true};
    if (sn_word_is(format, "appended")) return note_appended(r, t, type, out, err);
    const char *end = r->s->p < r->s->end ? memchr(r->s->p, '<', sn_scan_left(r->s)) : NULL;
    if (t->is_empty) return SN_OK;
    if (!end) return sn_scan_fail(r->s, err, "truncated: an array without an end");
    if (sn_word_is(format, "binary"))
        return sn_vtk_read_base64(&r->layout, r->s->p, end, true, type, out, err);
    if (format.n == 0 || sn_word_is(format, "ascii")) return sn_vtk_read_text(&r->layout, end, out, err);
    return sn_scan_fail(r->s, err, "an array needs the format binary, ascii or appended");
}

/* The data behind the elements begins after an underscore. It is the last that is read of the file. */
static sn_status read_appended(vtu *r, const tag *t, sn_error *err)
{
    sn_vtk_values *all[] = {&r->point, &r->corner, &r->offset, &r->kind, &r->part};
    sn_word encoding = attribute(t, "encoding");
    bool is_raw = sn_word_is(encoding, "raw");
    if (!is_raw && !sn_word_is(encoding, "base64"))
        return sn_scan_fail(r->s, err, "appended data needs the encoding raw or base64");
    if (!sn_scan_more(r->s) || *r->s->p != '_')
        return sn_scan_fail(r->s, err, "appended data needs to start with '_'");
    const char *data = r->s->p + 1, *end = r->s->end;
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        if (!all[i]->is_appended) continue;
        if (all[i]->offset > (size_t)(end - data))
            return sn_scan_fail(r->s, err, "truncated: an array at offset %zu, the data ends at %zu",
                                all[i]->offset, (size_t)(end - data));
        const char *at = data + all[i]->offset;
        sn_status st = is_raw ? sn_vtk_read_raw(&r->layout, at, end, all[i]->type, all[i], err)
                              : sn_vtk_read_base64(&r->layout, at, end, false, all[i]->type, all[i], err);
        if (st) return st;
        all[i]->is_appended = false;
    }
    return SN_OK;
}

static bool any_appended(const vtu *r)
{
    return r->point.is_appended || r->corner.is_appended || r->offset.is_appended || r->kind.is_appended ||
           r->part.is_appended;
}

static sn_status read_root(vtu *r, const tag *t, sn_error *err)
{
    if (!sn_word_is(attribute(t, "type"), r->type))
        return sn_scan_fail(r->s, err, "need a VTKFile of type %s", r->type);
    r->is_compressed = attribute(t, "compressor").n > 0; /* said also where all arrays are text */
    r->layout.is_big = sn_word_is(attribute(t, "byte_order"), "BigEndian");
    r->layout.has_long_header = sn_word_is(attribute(t, "header_type"), "UInt64");
    return SN_OK;
}

/* Other elements (InformationKey, ...) may stand between the arrays of a section. */
static bool is_section(sn_word name)
{
    static const char *const names[] = {"FieldData", "PointData", "CellData", "Points", "Cells",
                                        "Polys",     "Verts",     "Lines",    "Strips"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (sn_word_is(name, names[i])) return true;
    return false;
}

static sn_status read_tag(vtu *r, const tag *t, sn_error *err)
{
    if (sn_word_is(t->name, "VTKFile")) return read_root(r, t, err);
    if (sn_word_is(t->name, "Piece")) {
        if (r->in_piece) return sn_scan_fail(r->s, err, "a second Piece: only files of one piece are read");
        r->in_piece = true;
    } else if (sn_word_is(t->name, "DataArray")) {
        return read_array(r, t, err);
    } else if (is_section(t->name)) {
        r->section = t->name;
    }
    return SN_OK;
}

static sn_status read_tags(vtu *r, sn_error *err)
{
    bool has_root = false, is_there = false;
    tag t;
    for (;;) {
        sn_status st = next_tag(r->s, &t, &is_there, err);
        if (st) return st;
        if (!is_there) break;
        if (t.closes) {
            if (!sn_word_is(t.name, "VTKFile")) continue;
            return any_appended(r) ? sn_scan_fail(r->s, err, "no AppendedData for an appended array") : SN_OK;
        }
        if (!has_root && !sn_word_is(t.name, "VTKFile")) break;
        has_root = true;
        if (sn_word_is(t.name, "AppendedData")) return read_appended(r, &t, err);
        st = read_tag(r, &t, err);
        if (st) return st;
    }
    if (!has_root) return sn_scan_fail(r->s, err, "not a VTK XML file: no <VTKFile> at the start");
    return sn_scan_fail(r->s, err, "truncated: no </VTKFile>");
}

static sn_status missing(const vtu *r, const char *what, sn_error *err)
{
    return sn_fail(err, SN_EFORMAT, "%s: %s", r->s->path, what);
}

static sn_status no_array(const vtu *r, const char *name, sn_error *err)
{
    return sn_fail(err, SN_EFORMAT, "%s: no '%s' in %s", r->s->path, name, r->cells);
}

static sn_status check_cells(const vtu *r, sn_error *err)
{
    if (!r->point.is_there || r->point.n % 3 != 0) return missing(r, "no Points with three components", err);
    if (!r->corner.is_there) return no_array(r, "connectivity", err);
    return r->offset.is_there ? SN_OK : no_array(r, "offsets", err);
}

static sn_status check_arrays(const vtu *r, sn_error *err)
{
    size_t n = r->kind.n;
    sn_status st = check_cells(r, err);
    if (st) return st;
    if (!r->kind.is_there) return no_array(r, "types", err);
    for (size_t i = 0; i < n; i++)
        if (r->kind.v[i] != VTK_TETRA)
            return sn_fail(err, SN_EFORMAT, "%s: cell %zu has type %g, need %d (tets only)", r->s->path,
                           i + 1, r->kind.v[i], VTK_TETRA);
    if (r->offset.n != n || r->corner.n != 4 * n || (r->part.is_there && r->part.n != n))
        return sn_fail(err, SN_EFORMAT,
                       "%s: %zu cells with %zu offsets, %zu corners and %zu tissues do not fit", r->s->path,
                       n, r->offset.n, r->corner.n, r->part.n);
    for (size_t i = 0; i < n; i++)
        if (r->offset.v[i] != (double)(4 * (i + 1)))
            return sn_fail(err, SN_EFORMAT, "%s: offset %zu is %g, need %zu", r->s->path, i + 1,
                           r->offset.v[i], 4 * (i + 1));
    return SN_OK;
}

/* The corners first .. end - 1 of cell i. */
static sn_status add_corners(const vtu *r, sn_builder *b, size_t i, size_t first, size_t end, sn_error *err)
{
    sn_status st = SN_OK;
    for (size_t k = first; k < end && !st; k++) {
        double v = r->corner.v[k];
        if (!(v >= 0.0 && v < (double)sn_build_n_vert(b) && v == floor(v)))
            return sn_fail(err, SN_EFORMAT, "%s: cell %zu names point %g, need 0..%lld", b->path, i + 1, v,
                           (long long)sn_build_n_vert(b) - 1);
        st = sn_build_corner(b, (int64_t)v, 0, err);
    }
    return st;
}

static sn_status add_tet(const vtu *r, sn_builder *b, size_t i, sn_error *err)
{
    sn_status st = add_corners(r, b, i, 4 * i, 4 * i + 4, err);
    double part = r->part.is_there ? r->part.v[i] : -1.0;
    bool is_part = part >= 0.0 && part <= (double)INT32_MAX && part == floor(part);
    return st ? st : sn_build_cell(b, is_part ? (int32_t)part : -1, err);
}

/* Polygon i: a file's offsets are where each one ends. */
static sn_status add_polygon(const vtu *r, sn_builder *b, size_t i, sn_error *err)
{
    double first = i > 0 ? r->offset.v[i - 1] : 0.0, end = r->offset.v[i];
    if (!(end <= (double)r->corner.n && end == floor(end)))
        return sn_fail(err, SN_EFORMAT, "%s: offset %zu is %g, need a whole number up to %zu", b->path, i + 1,
                       end, r->corner.n);
    if (!(end - first >= 3.0 && end - first <= (double)INT32_MAX))
        return sn_fail(err, SN_EFORMAT, "%s: polygon %zu has %g corners, need 3 or more", b->path, i + 1,
                       end - first);
    sn_status st = add_corners(r, b, i, (size_t)first, (size_t)end, err);
    return st ? st : sn_build_cell(b, (int32_t)(end - first), err);
}

static sn_status add_points(const vtu *r, sn_builder *b, sn_error *err)
{
    for (size_t i = 0; i + 2 < r->point.n; i += 3) {
        if (!sn_v3_is_finite(sn_v3_load(r->point.v + i)))
            return sn_fail(err, SN_EFORMAT, "%s: point %zu has a coordinate that is not finite", b->path,
                           i / 3);
        sn_status st = sn_build_point(b, r->point.v + i, err);
        if (st) return st;
    }
    return SN_OK;
}

static void vtu_free(vtu *r)
{
    sn_release(r->point.v);
    sn_release(r->corner.v);
    sn_release(r->offset.v);
    sn_release(r->kind.v);
    sn_release(r->part.v);
}

sn_status sn_vtu_read(sn_builder *b, sn_scan *s, sn_error *err)
{
    vtu r = {.s = s, .layout = {.s = s}, .type = "UnstructuredGrid", .cells = "Cells"};
    sn_status st = read_tags(&r, err);
    if (!st) st = check_arrays(&r, err);
    if (!st) st = add_points(&r, b, err);
    for (size_t i = 0; i < r.kind.n && !st; i++) st = add_tet(&r, b, i, err);
    vtu_free(&r);
    return st;
}

sn_status sn_vtp_read(sn_builder *b, sn_scan *s, sn_error *err)
{
    vtu r = {.s = s, .layout = {.s = s}, .type = "PolyData", .cells = "Polys"};
    sn_status st = read_tags(&r, err);
    if (!st) st = check_cells(&r, err);
    if (!st) st = add_points(&r, b, err);
    for (size_t i = 0; i < r.offset.n && !st; i++) st = add_polygon(&r, b, i, err);
    vtu_free(&r);
    return st;
}

/* ---- Writing ---- */

static void write_field(sn_vtk_out *w, const sn_tet_field *f, size_t n_row)
{
    if (!f->is_int) {
        sn_vtk_doubles(w, f->name, f->values, n_row, f->n_comp);
        return;
    }
    size_t n_comp = (size_t)f->n_comp;
    sn_vtk_open(w, SN_I32, f->name, f->n_comp, n_row * n_comp);
    for (size_t k = 0; k < n_row * n_comp && !sn_out_failed(w->o); k++)
        sn_vtk_put(w, SN_I32, (int64_t)f->values[k], k % n_comp == n_comp - 1);
    sn_vtk_close(w);
}

static void write_fields(sn_vtk_out *w, const sn_tet_mesh *m, const sn_tet_extras *x, bool per_tet)
{
    sn_out_text(w->o, per_tet ? "<CellData>\n" : "<PointData>\n");
    if (per_tet && m->part) sn_vtk_i32(w, "tissue", m->part, (size_t)m->n_tet);
    for (int32_t i = 0; i < x->n_field; i++)
        if (x->field[i].per_tet == per_tet)
            write_field(w, &x->field[i], (size_t)(per_tet ? m->n_tet : m->n_vert));
    sn_out_text(w->o, per_tet ? "</CellData>\n" : "</PointData>\n");
}

static void write_cells(sn_vtk_out *w, const sn_tet_mesh *m)
{
    sn_out_text(w->o, "<Cells>\n");
    size_t n = (size_t)m->n_tet;
    sn_vtk_open(w, SN_I64, "connectivity", 1, 4 * n);
    for (size_t k = 0; k < 4 * n && !sn_out_failed(w->o); k++) sn_vtk_put(w, SN_I64, m->tet[k], k % 4 == 3);
    sn_vtk_close(w);
    sn_vtk_open(w, SN_I64, "offsets", 1, n);
    for (int64_t t = 0; t < m->n_tet && !sn_out_failed(w->o); t++) sn_vtk_put(w, SN_I64, 4 * (t + 1), true);
    sn_vtk_close(w);
    sn_vtk_open(w, SN_U8, "types", 1, n);
    for (int32_t t = 0; t < m->n_tet; t++) sn_vtk_put(w, SN_U8, VTK_TETRA, true);
    sn_vtk_close(w);
    sn_out_text(w->o, "</Cells>\n");
}

sn_status sn_vtu_write(sn_out *o, const sn_tet_mesh *m, const sn_tet_extras *x, sn_error *err)
{
    (void)err;
    sn_vtk_out w;
    sn_vtk_begin(&w, o, "UnstructuredGrid", x->ascii);
    sn_vtk_part_names(&w, x->part_name, x->n_part);
    sn_out_text(o, "<Piece NumberOfPoints=\"");
    sn_out_int(o, m->n_vert);
    sn_out_text(o, "\" NumberOfCells=\"");
    sn_out_int(o, m->n_tet);
    sn_out_text(o, "\">\n");
    write_fields(&w, m, x, false);
    write_fields(&w, m, x, true);
    sn_out_text(o, "<Points>\n");
    sn_vtk_doubles(&w, "Points", m->pos, (size_t)m->n_vert, 3);
    sn_out_text(o, "</Points>\n");
    write_cells(&w, m);
    sn_out_text(o, "</Piece>\n");
    sn_vtk_end(&w, "UnstructuredGrid");
    return SN_OK;
}
