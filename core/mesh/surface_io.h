/* surface_io.h - reads and writes surfaces: OBJ, PLY (ASCII, binary), STL (ASCII, binary), OFF; reads the
 * polygons of VTK XML polygonal data (.vtp). Independent of locale.
 *
 * Reading: the format follows the extension (.obj .ply .stl .off .vtp, any case); ASCII or binary follows the
 * contents. Lines may end in any of the three ways. Quads and polygons are cut into triangles as a fan from
 * their first corner, a concave planar polygon by ear clipping (at most 1,024 corners, else SN_EFORMAT). STL
 * corners that are bit-equal are welded. Vertices that no face uses are kept, and so are faces that name a
 * vertex twice. Texture coordinates, normals, colours, groups and materials are passed over. A negative OBJ
 * index counts from the last vertex read; a positive one may name a vertex that comes later. Several solids
 * in an STL become one surface. A VTP has one piece, its arrays inline, as text or base64, not compressed. No
 * labels come out.
 *
 * Errors: SN_EIO (cannot open or read), SN_EFORMAT
 * (contents; "path:line: ..." for text, "path: ... at byte N" for binary: truncated, an index out of range, a
 * number that is not finite, no faces, a binary STL whose size does not fit its count), SN_EINVAL (extension
 * unknown: the message lists the known ones), SN_ENOMEM. *out is then empty. Memory is taken as data is
 * found, never because a header promises much. */
#ifndef SN_MESH_SURFACE_IO_H
#define SN_MESH_SURFACE_IO_H

#include "mesh/tri_mesh.h"

#include <stdbool.h>

/* out: init-ed; what it held is released. */
SN_MUST_USE sn_status sn_surface_load(sn_tri_mesh *out, const char *path, sn_error *err);
/* Writes by extension: .obj and .off as text, .ply and .stl as little-endian binary (PLY with doubles, STL
 * with its floats: a coordinate beyond them is SN_EINVAL). Every form but binary STL reads back with the same
 * bits (STL in an order of its own, without unused vertices). Labels are not written. All or nothing: on
 * error no file appears and an old one stays. Errors: SN_EIO, SN_EINVAL (extension, a mesh that
 * sn_tri_mesh_validate refuses), SN_ENOMEM. */
SN_MUST_USE sn_status sn_surface_save(const sn_tri_mesh *m, const char *path, sn_error *err);
/* The same, with the text form where the format has two (PLY, STL). */
SN_MUST_USE sn_status sn_surface_save_ascii(const sn_tri_mesh *m, const char *path, sn_error *err);

#endif
