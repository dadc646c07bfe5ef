/* io_vtk.c - what the writers of VTK XML files share: the head, the arrays and the names of the parts. */
#include "mesh/io_private.h"

#include <string.h>

void sn_vtk_begin(sn_vtk_out *w, sn_out *o, const char *type, bool ascii)
{
    *w = (sn_vtk_out){.o = o, .ascii = ascii};
    sn_out_text(o, "<?xml version=\"1.0\"?>\n<VTKFile type=\"");
    sn_out_text(o, type);
    sn_out_text(o, "\" version=\"1.0\" byte_order=\"");
    sn_out_text(o, sn_host_is_big() ? "BigEndian" : "LittleEndian");
    sn_out_text(o, "\" header_type=\"UInt64\">\n<");
    sn_out_text(o, type);
    sn_out_text(o, ">\n");
}

void sn_vtk_end(sn_vtk_out *w, const char *type)
{
    sn_out_text(w->o, "</");
    sn_out_text(w->o, type);
    sn_out_text(w->o, ">\n</VTKFile>\n");
}

/* ---- the bytes of an array: their number, then they themselves, encoded as one ---- */

static void put_bytes(sn_vtk_out *w, const void *data, size_t size)
{
    const unsigned char *p = data;
    while (size > 0) {
        size_t room = sizeof w->chunk - w->n_chunk, n = size < room ? size : room;
        memcpy(w->chunk + w->n_chunk, p, n);
        w->n_chunk += n;
        p += n;
        size -= n;
        if (w->n_chunk < sizeof w->chunk) continue;
        sn_out_base64(w->o, w->chunk, w->n_chunk);
        w->n_chunk = 0;
    }
}

static void begin_bytes(sn_vtk_out *w, size_t size)
{
    uint64_t n = size;
    w->n_chunk = 0;
    if (!w->ascii) put_bytes(w, &n, sizeof n);
}

/* n_tuple: < 0 where the piece tells how many there are. */
static void open_array(sn_vtk_out *w, const char *type, const char *name, int n_comp, int64_t n_tuple)
{
    sn_out_text(w->o, "<DataArray type=\"");
    sn_out_text(w->o, type);
    sn_out_text(w->o, "\" Name=\"");
    for (const char *c = name; *c; c++) {
        if (*c == '&' || *c == '<' || *c == '>')
            sn_out_text(w->o, *c == '&' ? "&amp;" : *c == '<' ? "&lt;" : "&gt;");
        else
            sn_out_bytes(w->o, c, 1);
    }
    if (n_comp > 1) {
        sn_out_text(w->o, "\" NumberOfComponents=\"");
        sn_out_int(w->o, n_comp);
    }
    if (n_tuple >= 0) {
        sn_out_text(w->o, "\" NumberOfTuples=\"");
        sn_out_int(w->o, n_tuple);
    }
    sn_out_text(w->o, w->ascii ? "\" format=\"ascii\">\n" : "\" format=\"binary\">\n");
}

void sn_vtk_open(sn_vtk_out *w, sn_number_type type, const char *name, int n_comp, size_t n_value)
{
    open_array(w, type == SN_U8 ? "UInt8" : type == SN_I32 ? "Int32" : "Int64", name, n_comp, -1);
    begin_bytes(w, n_value * sn_number_size(type));
}

void sn_vtk_put(sn_vtk_out *w, sn_number_type type, int64_t v, bool ends_line)
{
    if (w->ascii) {
        sn_out_int(w->o, v);
        sn_out_text(w->o, ends_line ? "\n" : " ");
        return;
    }
    int32_t v32 = (int32_t)v;
    uint8_t v8 = (uint8_t)v;
    if (type == SN_I64) put_bytes(w, &v, 8);
    if (type == SN_I32) put_bytes(w, &v32, 4);
    if (type == SN_U8) put_bytes(w, &v8, 1);
}

void sn_vtk_close(sn_vtk_out *w)
{
    if (!w->ascii) {
        sn_out_base64(w->o, w->chunk, w->n_chunk);
        sn_out_text(w->o, "\n");
    }
    sn_out_text(w->o, "</DataArray>\n");
}

void sn_vtk_doubles(sn_vtk_out *w, const char *name, const double *v, size_t n_row, int n_comp)
{
    size_t size = n_row * (size_t)n_comp * sizeof *v;
    open_array(w, "Float64", name, n_comp, -1);
    begin_bytes(w, size);
    if (!w->ascii) put_bytes(w, v, size);
    for (size_t i = 0; w->ascii && i < n_row; i++) sn_out_doubles(w->o, v + i * (size_t)n_comp, n_comp);
    sn_vtk_close(w);
}

void sn_vtk_i32(sn_vtk_out *w, const char *name, const int32_t *v, size_t n_row)
{
    sn_vtk_open(w, SN_I32, name, 1, n_row);
    for (size_t i = 0; i < n_row; i++) sn_vtk_put(w, SN_I32, v[i], true);
    sn_vtk_close(w);
}

void sn_vtk_part_names(sn_vtk_out *w, const char *const *part_name, int32_t n_part)
{
    if (n_part == 0) return;
    sn_out_text(w->o, "<FieldData>\n");
    char room[24];
    size_t size = 0;
    for (int32_t i = 0; i < n_part; i++) size += strlen(sn_part_name(part_name, i, room)) + 1;
    open_array(w, "String", "tissue_names", 1, n_part);
    begin_bytes(w, size);
    for (int32_t i = 0; i < n_part; i++)
        for (const char *c = sn_part_name(part_name, i, room);; c++) { /* the final 0 divides the names */
            sn_vtk_put(w, SN_U8, (unsigned char)*c, !*c);
            if (!*c) break;
        }
    sn_vtk_close(w);
    sn_out_text(w->o, "</FieldData>\n");
}
