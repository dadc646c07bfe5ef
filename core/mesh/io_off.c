/* io_off.c - Object File Format, text. Colours, normals and texture coordinates behind a point are passed
 * over. */
#include "mesh/io_private.h"

#include <string.h>

/* [ST][C][N]OFF; false for the four-dimensional and n-dimensional kinds and for anything else. */
static bool is_keyword(sn_word w)
{
    if (w.n >= 2 && memcmp(w.s, "ST", 2) == 0) w = (sn_word){w.s + 2, w.n - 2};
    if (w.n >= 1 && w.s[0] == 'C') w = (sn_word){w.s + 1, w.n - 1};
    if (w.n >= 1 && w.s[0] == 'N') w = (sn_word){w.s + 1, w.n - 1};
    return sn_word_is(w, "OFF");
}

static sn_status read_count(sn_scan *s, int64_t *n, const char *what, sn_error *err)
{
    sn_status st = sn_scan_int(s, n, what, err);
    if (st) return st;
    return *n >= 0 ? SN_OK : sn_scan_fail(s, err, "%lld is no count, need %s", (long long)*n, what);
}

/* The keyword may be missing; the counts may stand on its line or below it. */
static sn_status read_header(sn_scan *s, int64_t *n_vert, int64_t *n_face, sn_error *err)
{
    (void)sn_scan_more(s);
    sn_scan first = *s;
    sn_word key = sn_scan_word(s);
    if (key.n > 0 && key.s[0] >= '0' && key.s[0] <= '9' && !memchr(key.s, 'O', key.n)) {
        s->p = first.p;
    } else if (!is_keyword(key)) {
        return sn_scan_want(&first, "the keyword OFF (or COFF, NOFF, STOFF)", err);
    } else {
        sn_scan ahead = *s;
        if (sn_word_is(sn_scan_word(&ahead), "BINARY")) return sn_scan_fail(s, err, "binary OFF is not read");
    }
    sn_status st = read_count(s, n_vert, "the number of vertices", err);
    if (!st) st = read_count(s, n_face, "the number of faces", err);
    sn_scan_next_line(s); /* the number of edges is often wrong or missing */
    return st;
}

static sn_status truncated(const sn_scan *s, int64_t n, const char *what, int64_t found, sn_error *err)
{
    return sn_scan_fail(s, err, "truncated: the header promises %lld %s, the file ends after %lld",
                        (long long)n, what, (long long)found);
}

static sn_status read_face(sn_builder *b, sn_scan *s, sn_error *err)
{
    int64_t n = 0, v = 0;
    sn_status st = sn_scan_int(s, &n, "the number of corners", err);
    if (st) return st;
    if (n < 3 || n > INT32_MAX)
        return sn_scan_fail(s, err, "a face with %lld corners, need 3 or more", (long long)n);
    for (int64_t k = 0; k < n; k++) {
        (void)sn_scan_more(s);
        size_t at = sn_scan_at(s);
        st = sn_scan_int(s, &v, "a vertex index", err);
        if (!st) st = sn_build_corner(b, v, at, err);
        if (st) return st;
    }
    return sn_build_cell(b, (int32_t)n, err);
}

sn_status sn_off_read(sn_builder *b, sn_scan *s, sn_error *err)
{
    int64_t n_vert = 0, n_face = 0;
    s->comment = '#';
    sn_status st = read_header(s, &n_vert, &n_face, err);
    for (int64_t i = 0; !st && i < n_vert; i++) {
        double p[3];
        if (!sn_scan_more(s)) return truncated(s, n_vert, "vertices", i, err);
        st = sn_scan_point(s, p, err);
        if (!st) st = sn_build_point(b, p, err);
        sn_scan_next_line(s);
    }
    for (int64_t i = 0; !st && i < n_face; i++) {
        if (!sn_scan_more(s)) return truncated(s, n_face, "faces", i, err);
        st = read_face(b, s, err);
        if (!st) sn_scan_next_line(s);
    }
    return st ? st : sn_build_check(b, s, "face", 0, err);
}

void sn_off_write(sn_out *o, const sn_tri_mesh *m, bool ascii)
{
    (void)ascii; /* it has no other form here */
    sn_out_text(o, "OFF\n");
    sn_out_int(o, m->n_vert);
    sn_out_text(o, " ");
    sn_out_int(o, m->n_face);
    sn_out_text(o, " 0\n");
    for (int32_t i = 0; i < m->n_vert; i++) sn_out_doubles(o, m->pos + 3 * (size_t)i, 3);
    for (int32_t f = 0; f < m->n_face; f++) {
        sn_out_text(o, "3");
        for (int k = 0; k < 3; k++) {
            sn_out_text(o, " ");
            sn_out_int(o, m->face[3 * (size_t)f + (size_t)k]);
        }
        sn_out_text(o, "\n");
    }
}
