/* tet_io.h - reads and writes tet meshes with named parts and fields.
 *
 * .vtu: VTK XML, inline base64 (or ASCII). Cell array "tissue" (Int32) when there are parts; fields as cell
 * or point arrays, Float64 or Int32; part names as a FieldData string array "tissue_names"; Int64
 * connectivity, header_type UInt64.
 *
 * .mesh: MEDIT ASCII, MeshVersionFormatted 2. Vertices, Triangles, Tetrahedra with ref = part id + 1 (0: no
 * parts); names as comment lines "# tissue <ref> <name>" below the first line. Triangles are the faces to the
 * outside and between parts, each once, as seen from outside the part with the lower id, with its ref. The
 * format has no place for fields: they are left out.
 *
 * .msh: Gmsh 2.2 ASCII. Tets with physical and elementary id = part id + 1; names in $PhysicalNames. Fields
 * per tet as $ElementData, per vertex as $NodeData, each at time 0.0 in step 0.
 *
 * All or nothing; independent of locale; the same mesh gives the same bytes. */
#ifndef SN_MESH_TET_IO_H
#define SN_MESH_TET_IO_H

#include "base/run.h"
#include "mesh/tet_mesh.h"

#include <stdbool.h>

typedef struct sn_tet_field { /* borrowed for the call */
    const char *name;         /* "fiber"                                             */
    const double *values;     /* n_vert or n_tet x n_comp, row-major                  */
    int n_comp;               /* 1 or 3                                               */
    bool per_tet;
    bool is_int; /* values are whole numbers of 32 bits, and are written as such */
} sn_tet_field;

typedef struct sn_tet_extras { /* zero-initialised = nothing */
    const char *const
        *part_name; /* n_part, UTF-8, no '"' or control characters; NULL: "part0", "part1", ... */
    int32_t n_part; /* 0: no names are written, any part id will do          */
    const sn_tet_field *field;
    int32_t n_field;
    bool ascii;        /* .vtu only */
    const sn_run *run; /* progress, and what stops the writing; NULL: nothing. Borrowed */
} sn_tet_extras;

/* x: NULL for nothing. Fields are checked for every format, also for one that leaves them out. Flat tets are
 * written as they are.
 * Errors: SN_EIO; SN_EINVAL (unknown extension, no tets, index out of range, part id < 0 or >= n_part, a
 * coordinate or field value that is not finite, a value of an is_int field that is no 32-bit integer, a name
 * or n_comp that cannot be, two fields of one name, and for .mesh a face of three tets); SN_ENOMEM;
 * SN_ECANCEL, SN_ELIMIT (then nothing is left). */
SN_MUST_USE sn_status sn_tet_mesh_save(const sn_tet_mesh *m, const sn_tet_extras *x, const char *path,
                                       sn_error *err);

/* .mesh (MEDIT ASCII), .vtu (ASCII, inline base64, or appended, raw or base64; uncompressed, one piece; any
 * number type; tets only), .node + .ele (TetGen text; either path; 0- or 1-based; of ten-node tets the
 * corners). Parts: MEDIT's ref - 1 (in a file that has a ref 0 among others: ref; all 0: none), "tissue"
 * before "MaterialId", or the first region attribute as it is. They are dropped (part = NULL) unless each is
 * a whole number from 0 on. Tets written inside out are turned; flat ones are an error. out: init-ed; empty
 * on error. Errors: SN_EIO, SN_EFORMAT (with line or what is missing), SN_EINVAL (unknown extension),
 * SN_ENOMEM. */
SN_MUST_USE sn_status sn_tet_mesh_load(sn_tet_mesh *out, const char *path, sn_error *err);

#endif
