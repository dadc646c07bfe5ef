/* io_stl.c - STL, text and binary. */
#include "mesh/io_private.h"

#include <string.h>

enum { HEADER_SIZE = 84, FACET_SIZE = 50 };

static uint32_t get_u32(const char *p)
{
    const unsigned char *u = (const unsigned char *)p;
    return (uint32_t)u[0] | (uint32_t)u[1] << 8 | (uint32_t)u[2] << 16 | (uint32_t)u[3] << 24;
}

static void put_u32(char *p, uint32_t v)
{
    for (int k = 0; k < 4; k++) p[k] = (char)(v >> 8 * k & 0xFF);
}

static double get_float(const char *p)
{
    uint32_t u = get_u32(p);
    float f;
    memcpy(&f, &u, sizeof f);
    return (double)f;
}

static void put_float(char *p, double v)
{
    float f = (float)v;
    uint32_t u;
    memcpy(&u, &f, sizeof u);
    put_u32(p, u);
}

/* A file that starts with "solid" may still be binary: exporters write it into the header. The size then fits
 * the count, or, in a damaged one, a 0 byte gives it away: the count has one unless there are 16 million
 * facets. */
static bool is_text(const sn_scan *s)
{
    size_t size = sn_scan_left(s);
    if (size >= HEADER_SIZE && size == HEADER_SIZE + (size_t)FACET_SIZE * get_u32(s->p + 80)) return false;
    sn_scan ahead = *s;
    sn_word key = sn_scan_word(&ahead);
    return sn_word_is_nocase(key, "solid") && !memchr(s->p, 0, size < 512 ? size : 512);
}

static sn_status add_facet(sn_builder *b, double p[3][3], size_t at, sn_error *err)
{
    sn_status st = SN_OK;
    for (int k = 0; k < 3 && !st; k++) {
        st = sn_build_corner(b, (int64_t)sn_build_n_vert(b), at, err);
        if (!st) st = sn_build_point(b, p[k], err);
    }
    return st ? st : sn_build_cell(b, 3, err);
}

static sn_status read_binary(sn_builder *b, sn_scan *s, sn_error *err)
{
    size_t size = sn_scan_left(s);
    if (size < HEADER_SIZE)
        return sn_fail(
            err, SN_EFORMAT,
            "%s: not an STL: %zu bytes that do not start with 'solid', a binary one has at least %d", s->path,
            size, HEADER_SIZE);
    size_t n = get_u32(s->p + 80), need = HEADER_SIZE + FACET_SIZE * n;
    if (size != need)
        return sn_fail(err, SN_EFORMAT,
                       "%s: %s: the header promises %zu triangles (%zu bytes), the file has %zu bytes",
                       s->path, size < need ? "truncated STL" : "STL with bytes left over", n, need, size);
    for (size_t i = 0; i < n; i++) {
        size_t at = HEADER_SIZE + FACET_SIZE * i + 12; /* the normal is passed over */
        double p[3][3];
        for (size_t k = 0; k < 9; k++) {
            p[k / 3][k % 3] = get_float(s->start + at + 4 * k);
            if (!isfinite(p[k / 3][k % 3]))
                return sn_fail(err, SN_EFORMAT, "%s: a coordinate of triangle %zu is not finite, at byte %zu",
                               s->path, i + 1, at + 4 * k);
        }
        sn_status st = add_facet(b, p, at, err);
        if (st) return st;
    }
    return SN_OK;
}

static sn_status expect(sn_scan *s, const char *keyword, const char *what, sn_error *err)
{
    (void)sn_scan_more(s);
    sn_scan word = *s;
    return sn_word_is_nocase(sn_scan_word(s), keyword) ? SN_OK : sn_scan_want(&word, what, err);
}

/* After the word "facet". The normal is not looked at: exporters write "nan" for a facet without area. */
static sn_status read_facet(sn_builder *b, sn_scan *s, sn_error *err)
{
    sn_scan ahead = *s;
    size_t at = sn_scan_at(s);
    if (sn_word_is_nocase(sn_scan_word(&ahead), "normal")) {
        for (int k = 0; k < 3; k++) (void)sn_scan_word(&ahead);
        *s = ahead;
    }
    double p[3][3];
    sn_status st = expect(s, "outer", "'outer loop'", err);
    if (!st) st = expect(s, "loop", "'outer loop'", err);
    for (int k = 0; k < 3 && !st; k++) {
        st = expect(s, "vertex", "'vertex'", err);
        if (!st) st = sn_scan_point(s, p[k], err);
    }
    if (!st) st = expect(s, "endloop", "'endloop' after three vertices", err);
    if (!st) st = expect(s, "endfacet", "'endfacet'", err);
    return st ? st : add_facet(b, p, at, err);
}

static sn_status read_text(sn_builder *b, sn_scan *s, sn_error *err)
{
    bool is_open = false; /* between solid and endsolid; several solids become one surface */
    while (sn_scan_more(s)) {
        sn_scan here = *s;
        sn_word key = sn_scan_word(s);
        if (is_open && sn_word_is_nocase(key, "facet")) {
            sn_status st = read_facet(b, s, err);
            if (st) return st;
        } else if (sn_word_is_nocase(key, is_open ? "endsolid" : "solid")) {
            is_open = !is_open;
            sn_scan_next_line(s); /* its name */
        } else {
            return sn_scan_want(&here, is_open ? "'facet' or 'endsolid'" : "'solid'", err);
        }
    }
    if (!is_open) return SN_OK;
    return sn_scan_fail(s, err, "truncated STL: the file ends after %zu triangles without 'endsolid'",
                        b->n_cell);
}

sn_status sn_stl_read(sn_builder *b, sn_scan *s, sn_error *err)
{
    return is_text(s) ? read_text(b, s, err) : read_binary(b, s, err);
}

static void write_text(sn_out *o, const sn_tri_mesh *m)
{
    sn_out_text(o, "solid sinew\n");
    for (int32_t f = 0; f < m->n_face; f++) {
        sn_vec3 n = sn_v3_unit(sn_tri_mesh_face_normal(m, f));
        double normal[3] = {n.x, n.y, n.z};
        if (!sn_v3_is_finite(n)) normal[0] = normal[1] = normal[2] = 0.0;
        sn_out_text(o, "facet normal ");
        sn_out_doubles(o, normal, 3);
        sn_out_text(o, "outer loop\n");
        for (size_t k = 0; k < 3; k++) {
            sn_out_text(o, "vertex ");
            sn_out_doubles(o, m->pos + 3 * (size_t)m->face[3 * (size_t)f + k], 3);
        }
        sn_out_text(o, "endloop\nendfacet\n");
    }
    sn_out_text(o, "endsolid sinew\n");
}

void sn_stl_write(sn_out *o, const sn_tri_mesh *m, bool ascii)
{
    if (ascii) {
        write_text(o, m);
        return;
    }
    char head[HEADER_SIZE] = "sinew binary STL"; /* must not start with "solid" */
    put_u32(head + 80, (uint32_t)m->n_face);
    sn_out_bytes(o, head, sizeof head);
    for (int32_t f = 0; f < m->n_face; f++) {
        char row[FACET_SIZE] = {0};
        sn_vec3 n = sn_v3_unit(sn_tri_mesh_face_normal(m, f));
        if (!sn_v3_is_finite(n)) n = sn_v3(0.0, 0.0, 0.0);
        put_float(row, n.x);
        put_float(row + 4, n.y);
        put_float(row + 8, n.z);
        for (size_t k = 0; k < 9; k++)
            put_float(row + 12 + 4 * k, m->pos[3 * (size_t)m->face[3 * (size_t)f + k / 3] + k % 3]);
        sn_out_bytes(o, row, sizeof row);
    }
}
