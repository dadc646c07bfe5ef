/* io_medit.c - MEDIT text meshes (.mesh), as TetGen, Mmg, Gmsh, libigl and FreeFEM use them. */
#include "mesh/io_private.h"

#include "base/alloc.h"

/* ---- Reading ---- */

static bool starts_word(const sn_scan *s) /* a keyword, not a number */
{
    return (*s->p >= 'A' && *s->p <= 'Z') || (*s->p >= 'a' && *s->p <= 'z');
}

static sn_status read_count(sn_scan *s, int64_t *n, const char *what, sn_error *err)
{
    sn_status st = sn_scan_int(s, n, what, err);
    if (st) return st;
    return *n >= 0 ? SN_OK : sn_scan_fail(s, err, "%lld is no count, need %s", (long long)*n, what);
}

static sn_status truncated(const sn_scan *s, int64_t n, const char *what, int64_t found, sn_error *err)
{
    return sn_scan_fail(s, err, "truncated: the file promises %lld %s and ends after %lld", (long long)n,
                        what, (long long)found);
}

static sn_status read_vertices(sn_builder *b, sn_scan *s, sn_error *err)
{
    int64_t n = 0;
    sn_status st = read_count(s, &n, "the number of vertices", err);
    for (int64_t i = 0; i < n && !st; i++) {
        double p[3], ref;
        if (!sn_scan_more(s)) return truncated(s, n, "vertices", i, err);
        st = sn_scan_point(s, p, err);
        if (!st) st = sn_scan_number(s, &ref, "the vertex's reference", err);
        if (!st) st = sn_build_point(b, p, err);
    }
    return st;
}

static sn_status read_tets(sn_builder *b, sn_scan *s, sn_error *err)
{
    int64_t n = 0, v = 0;
    sn_status st = read_count(s, &n, "the number of tetrahedra", err);
    for (int64_t i = 0; i < n && !st; i++) {
        if (!sn_scan_more(s)) return truncated(s, n, "tetrahedra", i, err);
        for (int k = 0; k < 4 && !st; k++) {
            (void)sn_scan_more(s);
            size_t at = sn_scan_at(s);
            st = sn_scan_int(s, &v, "a vertex index", err);
            if (!st) st = sn_build_corner(b, v - 1, at, err);
        }
        if (!st) st = sn_scan_int(s, &v, "the tetrahedron's reference", err);
        if (!st) st = sn_build_cell(b, v < 0 || v > INT32_MAX ? -1 : (int32_t)v, err);
    }
    return st;
}

/* Whatever the section is, its numbers end at the next keyword. */
static void skip_section(sn_scan *s)
{
    while (sn_scan_more(s) && !starts_word(s))
        if (sn_scan_word(s).n == 0) s->p++;
}

/* References to parts: ours count from 1; a file that counts from 0 keeps its numbers; all 0 means none. */
static void number_parts(sn_builder *b)
{
    int32_t min = INT32_MAX, max = -1;
    for (size_t i = 0; i < b->n_cell; i++) {
        if (b->tag[i] < min) min = b->tag[i];
        if (b->tag[i] > max) max = b->tag[i];
    }
    if (min <= 0 && max > 0) return;
    for (size_t i = 0; i < b->n_cell; i++) b->tag[i]--;
}

static sn_status read_header(sn_scan *s, sn_error *err)
{
    int64_t version = 0;
    (void)sn_scan_more(s);
    sn_scan first = *s;
    if (!sn_word_is_nocase(sn_scan_word(s), "meshversionformatted"))
        return sn_scan_want(&first, "'MeshVersionFormatted' (a MEDIT mesh)", err);
    return sn_scan_int(s, &version, "the version", err);
}

sn_status sn_medit_read(sn_builder *b, sn_scan *s, sn_error *err)
{
    s->comment = '#';
    sn_status st = read_header(s, err);
    while (!st && sn_scan_more(s)) {
        sn_scan here = *s;
        sn_word key = sn_scan_word(s);
        int64_t dim = 0;
        if (sn_word_is_nocase(key, "end")) {
            break;
        } else if (sn_word_is_nocase(key, "dimension")) {
            st = sn_scan_int(s, &dim, "the dimension", err);
            if (!st && dim != 3) st = sn_scan_fail(s, err, "dimension %lld, need 3", (long long)dim);
        } else if (sn_word_is_nocase(key, "vertices")) {
            st = read_vertices(b, s, err);
        } else if (sn_word_is_nocase(key, "tetrahedra")) {
            st = read_tets(b, s, err);
        } else if (starts_word(&here)) {
            skip_section(s);
        } else {
            st = sn_scan_want(&here, "a keyword", err);
        }
    }
    if (!st) st = sn_build_check(b, s, "tetrahedron", 1, err);
    if (!st) number_parts(b);
    return st;
}

/* ---- Writing ---- */

static int32_t ref_of(const sn_tet_mesh *m, int32_t t)
{
    return m->part ? m->part[t] + 1 : 0;
}

static void write_names(sn_out *o, const sn_tet_extras *x)
{
    char room[24];
    for (int32_t i = 0; i < x->n_part; i++) {
        sn_out_text(o, "# tissue ");
        sn_out_int(o, (int64_t)i + 1);
        sn_out_text(o, " ");
        sn_out_text(o, sn_part_name(x->part_name, i, room));
        sn_out_text(o, "\n");
    }
}

static void write_cell(sn_out *o, const int32_t *v, int n, int32_t ref)
{
    for (int k = 0; k < n; k++) {
        sn_out_int(o, (int64_t)v[k] + 1);
        sn_out_text(o, " ");
    }
    sn_out_int(o, ref);
    sn_out_text(o, "\n");
}

static void write_section(sn_out *o, const char *keyword, int64_t n)
{
    sn_out_text(o, keyword);
    sn_out_int(o, n);
    sn_out_text(o, "\n");
}

/* A face between two parts belongs to the lower one, and is written once, seen from outside that. */
static bool is_border(const sn_tet_mesh *m, const int32_t *adj, size_t half)
{
    int32_t other = adj[half];
    return other < 0 || ref_of(m, (int32_t)(half >> 2)) < ref_of(m, other);
}

static void write_borders(sn_out *o, const sn_tet_mesh *m, const int32_t *adj)
{
    size_t n_half = 4 * (size_t)m->n_tet;
    int64_t n = 0;
    for (size_t h = 0; h < n_half; h++) n += is_border(m, adj, h);
    write_section(o, "Triangles\n", n);
    for (size_t h = 0; h < n_half && !sn_out_failed(o); h++) {
        if (!is_border(m, adj, h)) continue;
        const int32_t *t = m->tet + (h & ~(size_t)3);
        const int *c = sn_tet_face[h & 3];
        int32_t v[3] = {t[c[0]], t[c[1]], t[c[2]]};
        write_cell(o, v, 3, ref_of(m, (int32_t)(h >> 2)));
    }
}

sn_status sn_medit_write(sn_out *o, const sn_tet_mesh *m, const sn_tet_extras *x, sn_error *err)
{
    int32_t *adj = NULL;
    sn_status st = sn_tet_mesh_adjacency(m, &adj, err);
    if (st) return st;
    sn_out_text(o, "MeshVersionFormatted 2\n"); /* Gmsh wants it on the first line, before any comment */
    write_names(o, x);
    sn_out_text(o, "Dimension 3\n");
    write_section(o, "Vertices\n", m->n_vert);
    for (int32_t i = 0; i < m->n_vert && !sn_out_failed(o); i++) {
        double row[4] = {m->pos[3 * (size_t)i], m->pos[3 * (size_t)i + 1], m->pos[3 * (size_t)i + 2], 0.0};
        sn_out_doubles(o, row, 4);
    }
    write_borders(o, m, adj);
    write_section(o, "Tetrahedra\n", m->n_tet);
    for (int32_t t = 0; t < m->n_tet && !sn_out_failed(o); t++)
        write_cell(o, m->tet + 4 * (size_t)t, 4, ref_of(m, t));
    sn_out_text(o, "End\n");
    sn_release(adj);
    return SN_OK;
}
