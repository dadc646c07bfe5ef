/* tet_io.h - reads and writes tet meshes with named parts and fields.
 *   .vtu   VTK XML, inline base64 (or ASCII): cell arrays "tissue" (Int32) and any field; part names as a FieldData
 *          string array "tissue_names"; Int64 connectivity, header_type UInt64
 *   .mesh  MEDIT ASCII, MeshVersionFormatted 2: Vertices, Triangles (surfaces between parts and to the outside),
 *          Tetrahedra with ref = part id + 1; names as comment lines "# tissue <ref> <name>" at the top
 *   .msh   Gmsh 2.2 ASCII with $PhysicalNames
 * All or nothing; independent of locale; the same mesh gives the same bytes. */
#ifndef SN_MESH_TET_IO_H
#define SN_MESH_TET_IO_H

#include "mesh/tet_mesh.h"

typedef struct sn_tet_field { /* borrowed for the call */
    const char *name;         /* "fiber"                                             */
    const double *values;     /* n_vert or n_tet x n_comp, row-major                  */
    int n_comp;               /* 1 or 3                                               */
    bool per_tet;
} sn_tet_field;

typedef struct sn_tet_extras {  /* zero-initialised = nothing */
    const char *const *part_name; /* n_part, UTF-8; NULL: "part0", "part1", ...          */
    int32_t n_part;
    const sn_tet_field *field;
    int32_t n_field;
    bool ascii;                   /* .vtu only */
} sn_tet_extras;

/* x: NULL for nothing. Fields go into .vtu only. Errors: SN_EIO, SN_EINVAL (unknown extension, part id >= n_part), SN_ENOMEM. */
SN_MUST_USE sn_status sn_tet_mesh_save(const sn_tet_mesh *m, const sn_tet_extras *x, const char *path, sn_error *err);

/* .mesh (MEDIT ASCII), .vtu (ASCII or inline base64, uncompressed; Int32/Int64, Float32/Float64; tets only),
 * .node + .ele (TetGen text; either path; 0- or 1-based). Parts from ref, "tissue"/"MaterialId", or the region
 * attribute, where the file has them. Tets written inside out are turned. Errors: SN_EIO, SN_EFORMAT (with line or
 * what is missing), SN_EINVAL, SN_ENOMEM. */
SN_MUST_USE sn_status sn_tet_mesh_load(sn_tet_mesh *out, const char *path, sn_error *err);

#endif
