/* io_obj.c - Wavefront OBJ: the v and f lines; everything else is passed over. */
#include "mesh/io_private.h"

/* Steps over "/vt/vn", "/vt" or "//vn" behind an index. */
static void skip_references(sn_scan *s)
{
    if (s->p >= s->end || *s->p != '/') return;
    while (s->p < s->end && ((*s->p >= '0' && *s->p <= '9') || *s->p == '/' || *s->p == '-')) s->p++;
}

static sn_status read_corner(sn_builder *b, sn_scan *s, sn_error *err)
{
    const char *word = s->p;
    int64_t i = 0;
    bool is_index = sn_scan_digits(s, &i);
    if (is_index) skip_references(s);
    if (!is_index || !sn_scan_ends(s)) {
        s->p = word;
        return sn_scan_want(s, "a vertex index", err);
    }
    int64_t n = (int64_t)sn_build_n_vert(b);
    if (i == 0) return sn_scan_fail(s, err, "vertex index 0, need 1 or more (or -1 for the last vertex)");
    if (i < -n)
        return sn_scan_fail(s, err, "vertex index %lld with %lld vertices before it", (long long)i,
                            (long long)n);
    return sn_build_corner(b, i > 0 ? i - 1 : i + n, (size_t)(word - s->start), err);
}

static sn_status read_face(sn_builder *b, sn_scan *s, sn_error *err)
{
    int32_t n = 0;
    sn_scan line = *s;
    while (!sn_scan_at_eol(s)) {
        sn_status st = read_corner(b, s, err);
        if (st) return st;
        if (++n == INT32_MAX) return sn_scan_fail(s, err, "a face with %d corners", n);
    }
    if (n < 3) return sn_scan_fail(&line, err, "a face with %d corners, need 3 or more", n);
    return sn_build_cell(b, n, err);
}

sn_status sn_obj_read(sn_builder *b, sn_scan *s, sn_error *err)
{
    s->by_line = s->has_joins = true;
    s->comment = '#';
    while (sn_scan_more(s)) {
        sn_word key = sn_scan_word(s);
        sn_status st = SN_OK;
        double p[3];
        if (key.n == 1 && key.s[0] == 'v') {
            st = sn_scan_point(s, p, err);
            if (!st) st = sn_build_point(b, p, err);
        } else if (key.n == 1 && key.s[0] == 'f') {
            st = read_face(b, s, err);
        }
        if (st) return st;
        sn_scan_next_line(s);
    }
    return sn_build_check(b, s, "face", 1, err);
}

void sn_obj_write(sn_out *o, const sn_tri_mesh *m, bool ascii)
{
    (void)ascii; /* it has no other form */
    for (int32_t i = 0; i < m->n_vert; i++) {
        sn_out_text(o, "v ");
        sn_out_doubles(o, m->pos + 3 * (size_t)i, 3);
    }
    for (int32_t f = 0; f < m->n_face; f++) {
        sn_out_text(o, "f");
        for (int k = 0; k < 3; k++) {
            sn_out_text(o, " ");
            sn_out_int(o, (int64_t)m->face[3 * (size_t)f + (size_t)k] + 1);
        }
        sn_out_text(o, "\n");
    }
}
