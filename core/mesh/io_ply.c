/* io_ply.c - PLY, text and binary of either byte order. Elements and properties other than the vertices' x,
 * y, z and the faces' list of vertices are passed over. */
#include "mesh/io_private.h"

#include "base/alloc.h"

#include <string.h>

typedef enum ply_role { PASSED_OVER, COORD_X, COORD_Y, COORD_Z, CORNERS } ply_role;

typedef struct ply_property {
    sn_number_type type, count_type; /* count_type: SN_NO_NUMBER unless a list */
    ply_role role;
} ply_property;

typedef struct ply_element {
    char name[SN_SHOWN_SIZE]; /* for messages */
    int64_t n_row;
    size_t first, n_prop; /* its properties */
    bool is_vertex, is_face;
} ply_element;

typedef struct ply {
    sn_scan *s;
    sn_builder *b;
    ply_element *elem;
    ply_property *prop;
    size_t n_elem, cap_elem, n_prop, cap_prop;
    bool is_text, is_big; /* is_big: most significant byte first */
} ply;

static sn_number_type find_type(sn_word w)
{
    static const struct {
        const char *name, *other;
        sn_number_type type;
    } known[] = {{"char", "int8", SN_I8},      {"uchar", "uint8", SN_U8},    {"short", "int16", SN_I16},
                 {"ushort", "uint16", SN_U16}, {"int", "int32", SN_I32},     {"uint", "uint32", SN_U32},
                 {"float", "float32", SN_F32}, {"double", "float64", SN_F64}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (sn_word_is(w, known[i].name) || sn_word_is(w, known[i].other)) return known[i].type;
    return SN_NO_NUMBER;
}

/* ---- Header ---- */

static sn_status read_type(ply *r, sn_number_type *type, sn_error *err)
{
    sn_scan_blanks(r->s);
    sn_scan word = *r->s;
    *type = find_type(sn_scan_word(r->s));
    return *type == SN_NO_NUMBER
               ? sn_scan_want(&word, "a type (char uchar short ushort int uint float double)", err)
               : SN_OK;
}

static ply_role find_role(const ply_element *e, sn_word name, bool is_list)
{
    if (e->is_vertex && !is_list && name.n == 1 && name.s[0] >= 'x' && name.s[0] <= 'z')
        return (ply_role)(COORD_X + (name.s[0] - 'x'));
    if (e->is_face && is_list && (sn_word_is(name, "vertex_indices") || sn_word_is(name, "vertex_index")))
        return CORNERS;
    return PASSED_OVER;
}

static sn_status read_property(ply *r, sn_error *err)
{
    if (r->n_elem == 0) return sn_scan_fail(r->s, err, "a property before the first element");
    ply_property p = {SN_NO_NUMBER, SN_NO_NUMBER, PASSED_OVER};
    sn_scan ahead = *r->s;
    sn_status st = SN_OK;
    if (sn_word_is(sn_scan_word(&ahead), "list")) {
        *r->s = ahead;
        st = read_type(r, &p.count_type, err);
    }
    if (!st) st = read_type(r, &p.type, err);
    if (st) return st;
    ply_element *e = &r->elem[r->n_elem - 1];
    sn_scan_blanks(r->s);
    sn_scan word = *r->s;
    sn_word name = sn_scan_word(r->s);
    if (name.n == 0) return sn_scan_want(&word, "the property's name", err);
    p.role = find_role(e, name, p.count_type != SN_NO_NUMBER);
    for (size_t i = e->first; i < r->n_prop && p.role != PASSED_OVER; i++)
        if (r->prop[i].role == p.role)
            return sn_scan_fail(&word, err, "property '%.*s' twice", (int)name.n, name.s);
    if (!sn_grow(&r->prop, &r->cap_prop, r->n_prop + 1, sizeof *r->prop))
        return sn_fail(err, SN_ENOMEM, "%s: no memory for the header", r->s->path);
    r->prop[r->n_prop++] = p;
    e->n_prop++;
    return SN_OK;
}

static sn_status read_element(ply *r, sn_error *err)
{
    sn_word name = sn_scan_word(r->s);
    ply_element e = {.first = r->n_prop};
    sn_word_show(e.name, name);
    sn_status st = sn_scan_int(r->s, &e.n_row, "the number of rows", err);
    if (st) return st;
    if (e.n_row < 0) return sn_scan_fail(r->s, err, "%lld rows, need 0 or more", (long long)e.n_row);
    e.is_vertex = sn_word_is(name, "vertex");
    e.is_face = sn_word_is(name, "face");
    if (!sn_grow(&r->elem, &r->cap_elem, r->n_elem + 1, sizeof *r->elem))
        return sn_fail(err, SN_ENOMEM, "%s: no memory for the header", r->s->path);
    r->elem[r->n_elem++] = e;
    return SN_OK;
}

static sn_status read_format(ply *r, sn_error *err)
{
    sn_scan_blanks(r->s);
    sn_scan word = *r->s;
    sn_word w = sn_scan_word(r->s);
    r->is_text = sn_word_is(w, "ascii");
    r->is_big = sn_word_is(w, "binary_big_endian");
    if (r->is_text || r->is_big || sn_word_is(w, "binary_little_endian")) return SN_OK;
    return sn_scan_want(&word, "ascii, binary_little_endian or binary_big_endian", err);
}

static bool has_roles(const ply *r, const ply_element *e, ply_role from, ply_role to)
{
    for (ply_role want = from; want <= to; want++) {
        size_t i = 0;
        while (i < e->n_prop && r->prop[e->first + i].role != want) i++;
        if (i == e->n_prop) return false;
    }
    return true;
}

static sn_status check_header(const ply *r, bool has_format, sn_error *err)
{
    if (!has_format) return sn_scan_fail(r->s, err, "the header has no 'format' line");
    for (size_t i = 0; i < r->n_elem; i++) {
        const ply_element *e = &r->elem[i];
        if (e->is_vertex && !has_roles(r, e, COORD_X, COORD_Z))
            return sn_scan_fail(r->s, err, "element 'vertex' needs the properties x, y and z");
        if (e->is_face && !has_roles(r, e, CORNERS, CORNERS))
            return sn_scan_fail(r->s, err,
                                "element 'face' needs a list property 'vertex_indices' or 'vertex_index'");
    }
    return SN_OK;
}

/* Steps over the line end behind "end_header". Only the first line tells "\r\n" from '\r' before a data byte
 * that happens to be '\n'. */
static void skip_header_end(sn_scan *s)
{
    while (s->p < s->end && *s->p != '\n' && *s->p != '\r') s->p++;
    const char *first = s->start;
    while (first < s->p && *first != '\n' && *first != '\r') first++;
    bool has_both = *first == '\r' && first + 1 < s->end && first[1] == '\n';
    if (s->p < s->end) s->p++;
    if (has_both && s->p < s->end && s->p[-1] == '\r' && *s->p == '\n') s->p++;
}

static sn_status read_header(ply *r, sn_error *err)
{
    sn_scan *s = r->s;
    bool has_format = false;
    s->by_line = true;
    if (!sn_word_is(sn_scan_word(s), "ply")) {
        s->p = s->start;
        return sn_scan_want(s, "'ply'", err);
    }
    for (;;) {
        sn_scan_next_line(s);
        if (!sn_scan_more(s)) return sn_scan_fail(s, err, "truncated: the header has no 'end_header'");
        sn_scan line = *s;
        sn_word key = sn_scan_word(s);
        sn_status st = SN_OK;
        if (sn_word_is(key, "end_header")) break;
        if (sn_word_is(key, "format")) {
            st = read_format(r, err);
            has_format = true;
        } else if (sn_word_is(key, "element")) {
            st = read_element(r, err);
        } else if (sn_word_is(key, "property")) {
            st = read_property(r, err);
        } else if (!sn_word_is(key, "comment") && !sn_word_is(key, "obj_info")) {
            st = sn_scan_want(&line, "a header line (element, property, comment, end_header)", err);
        }
        if (st) return st;
    }
    sn_status st = check_header(r, has_format, err);
    skip_header_end(s);
    s->by_line = false;
    return st;
}

/* ---- Rows ---- */

/* The next value, of either form. In a text file `what` is what the message asks for. */
static sn_status next_value(ply *r, sn_number_type type, double *v, const char *what, sn_error *err)
{
    if (r->is_text) return sn_scan_number(r->s, v, what, err);
    if (sn_scan_left(r->s) < sn_number_size(type))
        return sn_fail(err, SN_EFORMAT, "%s: truncated at byte %zu: need %s", r->s->path, sn_scan_at(r->s),
                       what);
    *v = sn_number_decode(r->s->p, type, r->is_big);
    r->s->p += sn_number_size(type);
    return SN_OK;
}

/* Steps over n values that nobody needs; in a text file they may be any words. */
static sn_status skip_values(ply *r, sn_number_type type, int64_t n, sn_error *err)
{
    if (!r->is_text) {
        if (sn_scan_left(r->s) / sn_number_size(type) < (uint64_t)n)
            return sn_fail(err, SN_EFORMAT, "%s: truncated at byte %zu: need %lld values of %zu bytes",
                           r->s->path, sn_scan_at(r->s), (long long)n, sn_number_size(type));
        r->s->p += (size_t)n * sn_number_size(type);
        return SN_OK;
    }
    for (int64_t i = 0; i < n; i++)
        if (sn_scan_word(r->s).n == 0) return sn_scan_want(r->s, "a value", err);
    return SN_OK;
}

/* A message about a value that was read in full, from offset `at`. */
static sn_status value_fail(ply *r, size_t at, double v, const char *what, sn_error *err)
{
    if (!r->is_text)
        return sn_fail(err, SN_EFORMAT, "%s: need %s, found %g at byte %zu", r->s->path, what, v, at);
    sn_scan word = *r->s;
    word.p = word.start + at;
    (void)sn_scan_more(&word);
    return sn_scan_want(&word, what, err);
}

static sn_status next_whole(ply *r, sn_number_type type, int64_t *n, const char *what, sn_error *err)
{
    double v = 0.0;
    size_t at = sn_scan_at(r->s);
    sn_status st = next_value(r, type, &v, what, err);
    if (st) return st;
    if (!(fabs(v) < 9e15 && v == floor(v))) return value_fail(r, at, v, what, err);
    *n = (int64_t)v;
    return SN_OK;
}

static sn_status next_count(ply *r, sn_number_type type, int64_t min, int64_t *n, const char *what,
                            sn_error *err)
{
    size_t at = sn_scan_at(r->s);
    sn_status st = next_whole(r, type, n, what, err);
    return st || (*n >= min && *n <= INT32_MAX) ? st : value_fail(r, at, (double)*n, what, err);
}

static sn_status read_corners(ply *r, const ply_property *p, sn_error *err)
{
    int64_t n = 0, v = 0;
    sn_status st = next_count(r, p->count_type, 3, &n, "3 or more corners", err);
    for (int64_t k = 0; k < n && !st; k++) {
        if (r->is_text) (void)sn_scan_more(r->s);
        size_t at = sn_scan_at(r->s);
        st = next_whole(r, p->type, &v, "a vertex index", err);
        if (!st) st = sn_build_corner(r->b, v, at, err);
    }
    return st ? st : sn_build_cell(r->b, (int32_t)n, err);
}

static sn_status read_coord(ply *r, const ply_property *p, double point[3], sn_error *err)
{
    size_t at = sn_scan_at(r->s);
    double *x = &point[p->role - COORD_X];
    sn_status st = next_value(r, p->type, x, "a coordinate", err);
    return st || isfinite(*x) ? st : value_fail(r, at, *x, "a finite coordinate", err);
}

static sn_status read_row(ply *r, const ply_element *e, sn_error *err)
{
    double point[3] = {0.0, 0.0, 0.0};
    sn_status st = SN_OK;
    for (size_t i = 0; i < e->n_prop && !st; i++) {
        const ply_property *p = &r->prop[e->first + i];
        int64_t n = 1;
        if (p->role == CORNERS) {
            st = read_corners(r, p, err);
        } else if (p->role != PASSED_OVER) {
            st = read_coord(r, p, point, err);
        } else {
            if (p->count_type != SN_NO_NUMBER)
                st = next_count(r, p->count_type, 0, &n, "the length of a list", err);
            if (!st) st = skip_values(r, p->type, n, err);
        }
    }
    if (!st && e->is_vertex) st = sn_build_point(r->b, point, err);
    if (!st && r->is_text && !sn_scan_at_eol(r->s)) st = sn_scan_want(r->s, "the end of the line", err);
    return st;
}

static sn_status read_rows(ply *r, const ply_element *e, sn_error *err)
{
    if (e->n_prop == 0) return SN_OK; /* nothing is stored for it, whatever its count */
    for (int64_t i = 0; i < e->n_row; i++) {
        if (r->is_text) (void)sn_scan_more(r->s);
        if (sn_scan_left(r->s) == 0)
            return sn_fail(
                err, SN_EFORMAT,
                "%s: truncated at byte %zu: the header promises %lld rows of '%s', the file has %lld",
                r->s->path, sn_scan_at(r->s), (long long)e->n_row, e->name, (long long)i);
        sn_status st = read_row(r, e, err);
        if (st) return st;
    }
    return SN_OK;
}

sn_status sn_ply_read(sn_builder *b, sn_scan *s, sn_error *err)
{
    ply r = {.s = s, .b = b};
    sn_status st = read_header(&r, err);
    for (size_t i = 0; i < r.n_elem && !st; i++) st = read_rows(&r, &r.elem[i], err);
    if (!st && !sn_build_in_range(b)) {
        if (r.is_text)
            st = sn_build_check(b, s, "face", 0, err);
        else
            st = sn_fail(err, SN_EFORMAT, "%s: face names vertex %lld, need 0..%lld, at byte %zu", s->path,
                         (long long)b->worst, (long long)sn_build_n_vert(b) - 1, b->worst_at);
    }
    sn_release(r.elem);
    sn_release(r.prop);
    return st;
}

/* ---- Writing ---- */

static void put_bytes(char *p, uint64_t v, int n)
{
    for (int k = 0; k < n; k++) p[k] = (char)(v >> 8 * k & 0xFF);
}

static void write_vertex(sn_out *o, const double *p, bool ascii)
{
    if (ascii) {
        sn_out_doubles(o, p, 3);
        return;
    }
    char row[24];
    for (int k = 0; k < 3; k++) {
        uint64_t u;
        memcpy(&u, &p[k], sizeof u);
        put_bytes(row + 8 * k, u, 8);
    }
    sn_out_bytes(o, row, sizeof row);
}

static void write_face(sn_out *o, const int32_t *v, bool ascii)
{
    char row[13] = {3};
    if (ascii) sn_out_text(o, "3");
    for (int k = 0; k < 3; k++) {
        if (ascii) {
            sn_out_text(o, " ");
            sn_out_int(o, v[k]);
        }
        put_bytes(row + 1 + 4 * k, (uint64_t)v[k], 4);
    }
    if (ascii)
        sn_out_text(o, "\n");
    else
        sn_out_bytes(o, row, sizeof row);
}

void sn_ply_write(sn_out *o, const sn_tri_mesh *m, bool ascii)
{
    sn_out_text(o, "ply\nformat ");
    sn_out_text(o, ascii ? "ascii" : "binary_little_endian");
    sn_out_text(o, " 1.0\nelement vertex ");
    sn_out_int(o, m->n_vert);
    sn_out_text(o, "\nproperty double x\nproperty double y\nproperty double z\nelement face ");
    sn_out_int(o, m->n_face);
    sn_out_text(o, "\nproperty list uchar int vertex_indices\nend_header\n");
    for (int32_t i = 0; i < m->n_vert; i++) write_vertex(o, m->pos + 3 * (size_t)i, ascii);
    for (int32_t f = 0; f < m->n_face; f++) write_face(o, m->face + 3 * (size_t)f, ascii);
}
