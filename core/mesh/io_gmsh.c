/* io_gmsh.c - Gmsh 2.2 text meshes (.msh), the version that the most programs read. */
#include "mesh/io_private.h"

static void write_names(sn_out *o, const sn_tet_extras *x)
{
    char room[24];
    if (x->n_part == 0) return;
    sn_out_text(o, "$PhysicalNames\n");
    sn_out_int(o, x->n_part);
    for (int32_t i = 0; i < x->n_part; i++) {
        sn_out_text(o, "\n3 "); /* the dimension */
        sn_out_int(o, (int64_t)i + 1);
        sn_out_text(o, " \"");
        sn_out_text(o, sn_part_name(x->part_name, i, room));
        sn_out_text(o, "\"");
    }
    sn_out_text(o, "\n$EndPhysicalNames\n");
}

static void write_tet(sn_out *o, const sn_tet_mesh *m, int32_t t)
{
    int64_t part = m->part ? m->part[t] : 0;
    int64_t row[9] = {(int64_t)t + 1, 4 /* tet */, 2 /* tags */,
                      m->part ? part + 1 : 0 /* physical: 0 is none */, part + 1 /* elementary: from 1 */};
    for (size_t k = 0; k < 4; k++) row[5 + k] = (int64_t)m->tet[4 * (size_t)t + k] + 1;
    for (int k = 0; k < 9; k++) {
        sn_out_int(o, row[k]);
        sn_out_text(o, k < 8 ? " " : "\n");
    }
}

/* One text: the name; one number: the time; three whole numbers: the time step, the components, the rows. */
static void write_field(sn_out *o, const sn_tet_mesh *m, const sn_tet_field *f)
{
    int32_t n_row = f->per_tet ? m->n_tet : m->n_vert;
    sn_out_text(o, f->per_tet ? "$ElementData\n1\n\"" : "$NodeData\n1\n\"");
    sn_out_text(o, f->name);
    sn_out_text(o, "\"\n1\n0.0\n3\n0\n");
    sn_out_int(o, f->n_comp);
    sn_out_text(o, "\n");
    sn_out_int(o, n_row);
    sn_out_text(o, "\n");
    for (int32_t i = 0; i < n_row && !sn_out_failed(o); i++) {
        sn_out_int(o, (int64_t)i + 1);
        sn_out_text(o, " ");
        sn_out_doubles(o, f->values + (size_t)i * (size_t)f->n_comp,
                       f->n_comp); /* whole ones without a point */
    }
    sn_out_text(o, f->per_tet ? "$EndElementData\n" : "$EndNodeData\n");
}

sn_status sn_gmsh_write(sn_out *o, const sn_tet_mesh *m, const sn_tet_extras *x, sn_error *err)
{
    (void)err;
    sn_out_text(o, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n");
    write_names(o, x);
    sn_out_text(o, "$Nodes\n");
    sn_out_int(o, m->n_vert);
    sn_out_text(o, "\n");
    for (int32_t i = 0; i < m->n_vert && !sn_out_failed(o); i++) {
        sn_out_int(o, (int64_t)i + 1);
        sn_out_text(o, " ");
        sn_out_doubles(o, m->pos + 3 * (size_t)i, 3);
    }
    sn_out_text(o, "$EndNodes\n$Elements\n");
    sn_out_int(o, m->n_tet);
    sn_out_text(o, "\n");
    for (int32_t t = 0; t < m->n_tet && !sn_out_failed(o); t++) write_tet(o, m, t);
    sn_out_text(o, "$EndElements\n");
    for (int32_t i = 0; i < x->n_field; i++) write_field(o, m, &x->field[i]);
    return SN_OK;
}
