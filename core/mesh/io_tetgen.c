/* io_tetgen.c - TetGen's .node and .ele text files, which belong together. */
#include "mesh/io_private.h"

#include "base/alloc.h"

#include <string.h>

/* The first line: a count, then up to three more numbers; those left out stay as they are. */
static sn_status read_header(sn_scan *s, int64_t n[4], const char *what, sn_error *err)
{
    s->comment = '#';
    s->by_line = true;
    (void)sn_scan_more(s);
    sn_status st = sn_scan_int(s, &n[0], what, err);
    for (int k = 1; k < 4 && !st && !sn_scan_at_eol(s); k++)
        st = sn_scan_int(s, &n[k], "a header number", err);
    if (!st && n[0] < 0) st = sn_scan_fail(s, err, "%lld is no count, need %s", (long long)n[0], what);
    return st;
}

/* The number at the start of each row. Rows are in order; the first one of the .node file tells the base. */
static sn_status read_row_number(sn_scan *s, int64_t want, sn_error *err)
{
    int64_t i = 0;
    sn_status st = sn_scan_int(s, &i, "a row number", err);
    if (st || i == want) return st;
    return sn_scan_fail(s, err, "row number %lld, need %lld", (long long)i, (long long)want);
}

static sn_status truncated(const sn_scan *s, int64_t n, const char *what, int64_t found, sn_error *err)
{
    return sn_scan_fail(s, err, "truncated: the header promises %lld %s, the file ends after %lld",
                        (long long)n, what, (long long)found);
}

static sn_status read_nodes(sn_builder *b, sn_scan *s, int64_t *base, sn_error *err)
{
    int64_t head[4] = {0, 3, 0, 0}; /* points, dimension, attributes, markers */
    sn_status st = read_header(s, head, "the number of points", err);
    if (!st && head[1] != 3) st = sn_scan_fail(s, err, "dimension %lld, need 3", (long long)head[1]);
    sn_scan_next_line(s);
    for (int64_t i = 0; i < head[0] && !st; i++) {
        double p[3];
        if (!sn_scan_more(s)) return truncated(s, head[0], "points", i, err);
        if (i == 0) *base = *s->p == '0' ? 0 : 1;
        st = read_row_number(s, i + *base, err);
        if (!st) st = sn_scan_point(s, p, err);
        if (!st) st = sn_build_point(b, p, err);
        sn_scan_next_line(s); /* attributes and the marker */
    }
    return st;
}

/* The region attribute is a part when it is a whole number from 0 on. */
static sn_status read_part(sn_scan *s, int32_t *part, sn_error *err)
{
    double v = -1.0;
    sn_status st = sn_scan_number(s, &v, "the region attribute", err);
    *part = v >= 0.0 && v <= (double)INT32_MAX && v == floor(v) ? (int32_t)v : -1;
    return st;
}

static sn_status read_tet(sn_builder *b, sn_scan *s, const int64_t head[4], int64_t base, sn_error *err)
{
    sn_status st = SN_OK;
    int32_t part = -1;
    int64_t v = 0;
    for (int64_t k = 0; k < head[1] && !st; k++) {
        sn_scan_blanks(s);
        size_t at = sn_scan_at(s);
        st = sn_scan_int(s, &v, "a vertex index", err);
        if (!st && k < 4) st = sn_build_corner(b, v - base, at, err); /* then the middles of the edges */
    }
    if (!st && head[2] > 0) st = read_part(s, &part, err);
    return st ? st : sn_build_cell(b, part, err);
}

static sn_status read_tets(sn_builder *b, sn_scan *s, int64_t base, sn_error *err)
{
    int64_t head[4] = {0, 4, 0, 0}; /* tets, corners of each, attributes */
    sn_status st = read_header(s, head, "the number of tetrahedra", err);
    if (!st && head[1] != 4 && head[1] != 10)
        st = sn_scan_fail(s, err, "%lld corners for each tetrahedron, need 4 or 10", (long long)head[1]);
    sn_scan_next_line(s);
    for (int64_t i = 0; i < head[0] && !st; i++) {
        if (!sn_scan_more(s)) return truncated(s, head[0], "tetrahedra", i, err);
        st = read_row_number(s, i + base, err);
        if (!st) st = read_tet(b, s, head, base, err);
        sn_scan_next_line(s);
    }
    return st ? st : sn_build_check(b, s, "tetrahedron", (int)base, err);
}

sn_status sn_tetgen_read(sn_builder *b, sn_scan *s, sn_error *err)
{
    char ext[16], *data = NULL;
    sn_file_extension(s->path, ext);
    bool has_nodes = strcmp(ext, "node") == 0;
    size_t stem = strlen(s->path) - strlen(ext);
    char *path = sn_alloc(stem + 5, 1);
    if (!path) return sn_fail(err, SN_ENOMEM, "%s: no memory to read it", s->path);
    memcpy(path, s->path, stem);
    memcpy(path + stem, has_nodes ? "ele" : "node", has_nodes ? 4 : 5);
    sn_scan other;
    int64_t base = 1;
    sn_status st = sn_scan_open(&other, path, &data, err);
    if (!st) st = read_nodes(b, has_nodes ? s : &other, &base, err);
    if (!st) st = read_tets(b, has_nodes ? &other : s, base, err);
    sn_release(data);
    sn_release(path);
    return st;
}
