/* tet_io.c - finds the format of a tet mesh file, and hands over to its reader or writer. */
#include "mesh/tet_io.h"

#include "base/alloc.h"
#include "mesh/io_private.h"

#include <stdio.h>
#include <string.h>

typedef struct format {
    const char *ext;
    sn_status (*read)(sn_builder *b, sn_scan *s, sn_error *err);                                /* or NULL */
    sn_status (*write)(sn_out *o, const sn_tet_mesh *m, const sn_tet_extras *x, sn_error *err); /* or NULL */
} format;

static const format formats[] = {
    {"vtu", sn_vtu_read, sn_vtu_write}, {"mesh", sn_medit_read, sn_medit_write}, {"msh", NULL, sn_gmsh_write},
    {"node", sn_tetgen_read, NULL},     {"ele", sn_tetgen_read, NULL},
};

static const format *find_format(const char *path, char ext[16])
{
    sn_file_extension(path, ext);
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (strcmp(ext, formats[i].ext) == 0) return &formats[i];
    return NULL;
}

sn_status sn_tet_mesh_load(sn_tet_mesh *out, const char *path, sn_error *err)
{
    sn_tet_mesh_free(out);
    char ext[16];
    const format *f = find_format(path, ext);
    if (!f || !f->read)
        return sn_fail(err, SN_EINVAL, "%s: no tet mesh format to read '%s' (known: .vtu .mesh .node .ele)",
                       path, ext);
    char *data = NULL;
    sn_scan s;
    sn_builder b;
    sn_build_init(&b, path);
    sn_status st = sn_scan_open(&s, path, &data, err);
    if (!st) st = f->read(&b, &s, err);
    sn_release(data);
    if (!st) st = sn_build_tets(&b, out, err);
    sn_build_free(&b);
    return st;
}

/* Tets of a field's making may be flat; only what would make a broken file is refused. */
static sn_status check_mesh(const sn_tet_mesh *m, const sn_tet_extras *x, sn_error *err)
{
    if (m->n_tet < 1) return sn_fail(err, SN_EINVAL, "tet mesh has no tets");
    for (int32_t i = 0; i < m->n_vert; i++)
        if (!sn_v3_is_finite(sn_tet_mesh_point(m, i)))
            return sn_fail(err, SN_EINVAL, "vertex %d has a coordinate that is not finite", i + 1);
    for (size_t k = 0; k < 4 * (size_t)m->n_tet; k++)
        if (m->tet[k] < 0 || m->tet[k] >= m->n_vert)
            return sn_fail(err, SN_EINVAL, "tet %zu names vertex %lld, need 1..%d", k / 4 + 1,
                           (long long)m->tet[k] + 1, m->n_vert);
    int32_t limit = x->n_part > 0 ? x->n_part : INT32_MAX; /* part + 1 is written */
    for (int32_t t = 0; m->part && t < m->n_tet; t++)
        if (m->part[t] < 0 || m->part[t] >= limit)
            return sn_fail(err, SN_EINVAL, "tet %d has part id %d, need 0..%d", t + 1, m->part[t], limit - 1);
    return SN_OK;
}

bool sn_name_is_plain(const char *name)
{
    if (!name || !*name) return false;
    for (const char *c = name; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127 || *c == '"') return false;
    return true;
}

static sn_status check_whole(const sn_tet_field *f, size_t n, sn_error *err)
{
    for (size_t k = 0; k < n; k++) {
        double v = f->values[k];
        if (!(v >= INT32_MIN && v <= INT32_MAX && v == floor(v)))
            return sn_fail(err, SN_EINVAL, "field '%s' is %.17g at %s %zu, need a whole number of 32 bits",
                           f->name, v, f->per_tet ? "tet" : "vertex", k / (size_t)f->n_comp + 1);
    }
    return SN_OK;
}

static sn_status check_field(const sn_tet_mesh *m, const sn_tet_extras *x, int32_t i, sn_error *err)
{
    const sn_tet_field *f = &x->field[i];
    if (!sn_name_is_plain(f->name) || strcmp(f->name, "tissue") == 0)
        return sn_fail(err, SN_EINVAL,
                       "field %d needs a name without quotes and control characters, other than 'tissue'",
                       i + 1);
    for (int32_t k = 0; k < i; k++)
        if (x->field[k].per_tet == f->per_tet && strcmp(x->field[k].name, f->name) == 0)
            return sn_fail(err, SN_EINVAL, "two fields are named '%s'", f->name);
    if (f->n_comp != 1 && f->n_comp != 3)
        return sn_fail(err, SN_EINVAL, "field '%s' has %d components, need 1 or 3", f->name, f->n_comp);
    size_t n = (size_t)(f->per_tet ? m->n_tet : m->n_vert) * (size_t)f->n_comp;
    for (size_t k = 0; k < n; k++)
        if (!isfinite(f->values[k]))
            return sn_fail(err, SN_EINVAL, "field '%s' is not finite at %s %zu", f->name,
                           f->per_tet ? "tet" : "vertex", k / (size_t)f->n_comp + 1);
    return f->is_int ? check_whole(f, n, err) : SN_OK;
}

static sn_status check_extras(const sn_tet_mesh *m, const sn_tet_extras *x, sn_error *err)
{
    if (x->n_part < 0 || x->n_field < 0)
        return sn_fail(err, SN_EINVAL, "%d part names and %d fields, need 0 or more", x->n_part, x->n_field);
    for (int32_t i = 0; x->part_name && i < x->n_part; i++)
        if (!sn_name_is_plain(x->part_name[i]))
            return sn_fail(err, SN_EINVAL, "part %d needs a name without quotes and control characters",
                           i + 1);
    for (int32_t i = 0; i < x->n_field; i++) {
        sn_status st = check_field(m, x, i, err);
        if (st) return st;
    }
    return SN_OK;
}

/* Bytes of the file, about: for the progress. */
static double expect_size(const sn_tet_mesh *m, const sn_tet_extras *x, const char *ext)
{
    double n_vert = m->n_vert, n_tet = m->n_tet;
    if (strcmp(ext, "mesh") == 0) return 45.0 * n_vert + 26.0 * n_tet;
    bool is_binary = strcmp(ext, "vtu") == 0 && !x->ascii;
    double sum = is_binary ? 24.0 * n_vert + 45.0 * n_tet : 58.0 * n_vert + 35.0 * n_tet;
    for (int32_t i = 0; i < x->n_field; i++) {
        const sn_tet_field *f = &x->field[i];
        double of_binary = f->is_int ? 4.0 : 8.0, of_text = f->is_int ? 2.0 : 19.0;
        double row = is_binary ? of_binary * f->n_comp : 8.0 + of_text * f->n_comp;
        sum += row * (f->per_tet ? n_tet : n_vert);
    }
    return is_binary ? sum * 4.0 / 3.0 : sum;
}

sn_status sn_tet_mesh_save(const sn_tet_mesh *m, const sn_tet_extras *x, const char *path, sn_error *err)
{
    static const sn_tet_extras nothing;
    if (!x) x = &nothing;
    char ext[16];
    const format *f = find_format(path, ext);
    if (!f || !f->write)
        return sn_fail(err, SN_EINVAL, "%s: no tet mesh format to write '%s' (known: .vtu .mesh .msh)", path,
                       ext);
    sn_status st = check_mesh(m, x, err);
    if (!st) st = check_extras(m, x, err);
    if (st) return sn_fail_prefix(err, st, "%s: cannot save: ", path);
    sn_out *o = NULL;
    st = sn_out_open(&o, path, err);
    if (st) return st;
    sn_out_watch(o, x->run, "saving tets", expect_size(m, x, ext));
    st = f->write(o, m, x, err);
    if (!st) return sn_out_commit(o, err);
    sn_out_abort(o);
    return sn_fail_prefix(err, st, "%s: cannot save: ", path);
}

const char *sn_part_name(const char *const *part_name, int32_t i_part, char room[24])
{
    if (part_name) return part_name[i_part];
    (void)snprintf(room, 24, "part%d", i_part);
    return room;
}
