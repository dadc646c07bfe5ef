/* io_vtp.c - VTK XML polygonal data (.vtp) that holds lines. */
#include "mesh/io_private.h"

static void write_piece(sn_out *o, const sn_polylines *p)
{
    sn_out_text(o, "<Piece NumberOfPoints=\"");
    sn_out_int(o, (int64_t)p->n_point);
    sn_out_text(o, "\" NumberOfVerts=\"0\" NumberOfLines=\"");
    sn_out_int(o, (int64_t)p->n_line);
    sn_out_text(o, "\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n");
}

/* A line's points follow each other: point k is corner k. */
static void write_lines(sn_vtk_out *w, const sn_polylines *p)
{
    sn_out_text(w->o, "<Lines>\n");
    sn_vtk_open(w, SN_I64, "connectivity", 1, p->n_point);
    for (size_t k = 0; k < p->n_point; k++) sn_vtk_put(w, SN_I64, (int64_t)k, true);
    sn_vtk_close(w);
    sn_vtk_open(w, SN_I64, "offsets", 1, p->n_line);
    for (size_t i = 0; i < p->n_line; i++) sn_vtk_put(w, SN_I64, p->first[i + 1], true);
    sn_vtk_close(w);
    sn_out_text(w->o, "</Lines>\n");
}

sn_status sn_vtp_write(sn_out *o, const sn_polylines *p, const char *const *part_name, int32_t n_part,
                       sn_error *err)
{
    (void)err;
    sn_vtk_out w;
    sn_vtk_begin(&w, o, "PolyData", false);
    sn_vtk_part_names(&w, part_name, n_part);
    write_piece(o, p);
    sn_out_text(o, "<PointData>\n");
    if (p->has_value) sn_vtk_doubles(&w, "u", p->value, p->n_point, 1);
    sn_out_text(o, "</PointData>\n<CellData>\n");
    sn_vtk_i32(&w, "tissue", p->part, p->n_line);
    sn_out_text(o, "</CellData>\n<Points>\n");
    sn_vtk_doubles(&w, "Points", p->pos, p->n_point, 3);
    sn_out_text(o, "</Points>\n");
    write_lines(&w, p);
    sn_out_text(o, "</Piece>\n");
    sn_vtk_end(&w, "PolyData");
    return SN_OK;
}
