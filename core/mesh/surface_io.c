/* surface_io.c - finds the format of a surface file, and hands over to its reader or writer. */
#include "mesh/surface_io.h"

#include "base/alloc.h"
#include "mesh/io_private.h"

#include <float.h>
#include <string.h>

typedef struct format {
    const char *ext;
    sn_status (*read)(sn_builder *b, sn_scan *s, sn_error *err);
    void (*write)(sn_out *o, const sn_tri_mesh *m, bool ascii); /* NULL: it is only read */
    bool has_floats;    /* its binary form holds floats                */
    bool needs_welding; /* it writes the corners of each face anew     */
} format;

static const format formats[] = {
    {"obj", sn_obj_read, sn_obj_write, false, false}, {"ply", sn_ply_read, sn_ply_write, false, false},
    {"stl", sn_stl_read, sn_stl_write, true, true},   {"off", sn_off_read, sn_off_write, false, false},
    {"vtp", sn_vtp_read, NULL, false, false},
};

static sn_status find_format(const format **out, const char *path, bool to_write, sn_error *err)
{
    char ext[16];
    sn_file_extension(path, ext);
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (strcmp(ext, formats[i].ext) == 0 && (formats[i].write || !to_write)) {
            *out = &formats[i];
            return SN_OK;
        }
    return sn_fail(err, SN_EINVAL, "%s: unknown surface format '%s' (known: .obj .ply .stl .off%s)", path,
                   ext, to_write ? "" : " .vtp");
}

sn_status sn_surface_load(sn_tri_mesh *out, const char *path, sn_error *err)
{
    sn_tri_mesh_free(out);
    const format *f = NULL;
    sn_status st = find_format(&f, path, false, err);
    if (st) return st;
    char *data = NULL;
    sn_scan s;
    sn_builder b;
    sn_build_init(&b, path);
    st = sn_scan_open(&s, path, &data, err);
    if (!st) st = f->read(&b, &s, err);
    sn_release(data);
    if (!st) st = sn_build_surface(&b, out, err);
    if (!st && f->needs_welding) {
        st = sn_tri_mesh_weld(out, NULL, err);
        if (st) sn_tri_mesh_free(out);
    }
    sn_build_free(&b);
    return st;
}

static sn_status check_floats(const sn_tri_mesh *m, const char *path, sn_error *err)
{
    for (size_t k = 0; k < 3 * (size_t)m->n_vert; k++)
        if (fabs(m->pos[k]) > (double)FLT_MAX)
            return sn_fail(err, SN_EINVAL,
                           "%s: vertex %zu has the coordinate %g, a binary STL holds up to %g", path,
                           k / 3 + 1, m->pos[k], (double)FLT_MAX);
    return SN_OK;
}

static sn_status save(const sn_tri_mesh *m, const char *path, bool ascii, sn_error *err)
{
    const format *f = NULL;
    sn_status st = find_format(&f, path, true, err);
    if (st) return st;
    st = sn_tri_mesh_validate(m, err);
    if (st) return sn_fail_prefix(err, st, "%s: cannot save: ", path);
    if (f->has_floats && !ascii) {
        st = check_floats(m, path, err);
        if (st) return st;
    }
    sn_out *o = NULL;
    st = sn_out_open(&o, path, err);
    if (st) return st;
    f->write(o, m, ascii);
    return sn_out_commit(o, err);
}

sn_status sn_surface_save(const sn_tri_mesh *m, const char *path, sn_error *err)
{
    return save(m, path, false, err);
}

sn_status sn_surface_save_ascii(const sn_tri_mesh *m, const char *path, sn_error *err)
{
    return save(m, path, true, err);
}

void sn_out_doubles(sn_out *o, const double *v, int n)
{
    for (int i = 0; i < n; i++) {
        sn_out_double(o, v[i]);
        sn_out_bytes(o, i + 1 < n ? " " : "\n", 1);
    }
}
