/* io_private.h - what the mesh readers and writers share: a scanner over a file in memory, a mesh that grows,
 * and the list of formats. For surface_io.c, tet_io.c, polylines.c and io_*.c only. */
#ifndef SN_MESH_IO_PRIVATE_H
#define SN_MESH_IO_PRIVATE_H

#include "base/file.h"
#include "mesh/polylines.h"
#include "mesh/tet_io.h"
#include "mesh/tet_mesh.h"
#include "mesh/tri_mesh.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* ---- Scanner: text, or the bytes of a binary file. '\n', "\r\n" and '\r' end a line. ---- */

typedef struct sn_scan {
    const char *start, *p,
        *end;         /* the character at end stops any number; 0 bytes before it are ordinary text */
    const char *path; /* for messages; borrowed                                    */
    bool by_line;     /* numbers and words are looked for on the current line only */
    bool has_joins;   /* a backslash before a line end joins two lines             */
    char comment;     /* starts a comment up to the line end; 0: there are none    */
} sn_scan;

typedef struct sn_word { /* borrowed from the file */
    const char *s;
    size_t n;
} sn_word;

/* Reads the file; *data is the caller's to sn_release. Every flag of *s is off. */
SN_MUST_USE sn_status sn_scan_open(sn_scan *s, const char *path, char **data, sn_error *err);
void sn_scan_blanks(sn_scan *s);              /* to the next character on this line that is not blank     */
bool sn_scan_at_eol(sn_scan *s);              /* skips blanks first; a comment and the file's end count   */
void sn_scan_next_line(sn_scan *s);           /* to the first character of the next line                  */
bool sn_scan_more(sn_scan *s);                /* skips blanks, comments, line ends; false at the file's end */
bool sn_scan_ends(const sn_scan *s);          /* is *p no part of a word                                  */
sn_word sn_scan_word(sn_scan *s);             /* the next word; n = 0 when there is none                  */
bool sn_word_is(sn_word w, const char *text); /* exactly                  */
bool sn_word_is_nocase(sn_word w, const char *lower); /* in any case; ASCII only  */
/* The word for a message: shortened, without control characters. */
#define SN_SHOWN_SIZE 36
void sn_word_show(char out[SN_SHOWN_SIZE], sn_word w);
/* Digits with a sign, from *p on, with anything behind; false and *p unmoved when there are none. Saturates.
 */
bool sn_scan_digits(sn_scan *s, int64_t *v);
/* A whole word each. `what` completes "need ...". On error *p is at the word that is wrong. Errors:
 * SN_EFORMAT. */
SN_MUST_USE sn_status sn_scan_int(sn_scan *s, int64_t *v, const char *what, sn_error *err);
SN_MUST_USE sn_status sn_scan_number(sn_scan *s, double *v, const char *what,
                                     sn_error *err);                         /* also nan, inf */
SN_MUST_USE sn_status sn_scan_point(sn_scan *s, double p[3], sn_error *err); /* finite        */
/* SN_EFORMAT "path:line: need <what>, found '<the word at *p>'". */
sn_status sn_scan_want(const sn_scan *s, const char *what, sn_error *err);
/* SN_EFORMAT "path:line: ..." with the line of *p. */
sn_status sn_scan_fail(const sn_scan *s, sn_error *err, const char *fmt, ...) SN_PRINTF(3, 4);
/* Numbers of a binary file. */
typedef enum sn_number_type {
    SN_I8,
    SN_U8,
    SN_I16,
    SN_U16,
    SN_I32,
    SN_U32,
    SN_I64,
    SN_U64,
    SN_F32,
    SN_F64,
    SN_NO_NUMBER
} sn_number_type;
size_t sn_number_size(sn_number_type type); /* bytes; not for SN_NO_NUMBER */
/* The number at p, of either byte order. 64-bit integers beyond 2^53 are rounded. */
double sn_number_decode(const void *p, sn_number_type type, bool is_big);

/* Offsets into the file and back. */
static inline size_t sn_scan_at(const sn_scan *s)
{
    return (size_t)(s->p - s->start);
}
static inline size_t sn_scan_left(const sn_scan *s)
{
    return (size_t)(s->end - s->p);
}

/* ---- Builder: vertices and cells in file order. Cells may name vertices that come later. ---- */

typedef struct sn_builder {
    const char *path; /* for messages; borrowed */
    double *pos;      /* three for each vertex  */
    int32_t *corner;  /* of all cells in a row  */
    int32_t *tag;     /* for each cell: its number of corners (surfaces) or its part, -1 for none (tets) */
    size_t n_pos, cap_pos, n_corner, cap_corner, n_cell, cap_cell;
    int64_t worst;   /* the corner that is furthest out of range, or the largest one */
    size_t worst_at; /* the file offset it was read from                             */
} sn_builder;

void sn_build_init(sn_builder *b, const char *path);
void sn_build_free(sn_builder *b);
SN_MUST_USE sn_status sn_build_point(sn_builder *b, const double p[3], sn_error *err);
/* Any index is taken; the range is checked at the end, with sn_build_in_range. */
SN_MUST_USE sn_status sn_build_corner(sn_builder *b, int64_t index, size_t at, sn_error *err);
SN_MUST_USE sn_status sn_build_cell(sn_builder *b, int32_t tag, sn_error *err); /* ends a cell */
static inline size_t sn_build_n_vert(const sn_builder *b)
{
    return b->n_pos / 3;
}
bool sn_build_in_range(const sn_builder *b); /* every corner names a vertex, or there is no cell */
/* SN_EFORMAT when a corner is out of range: "face names vertex ...", counted from `base`, with the line it is
 * on. */
SN_MUST_USE sn_status sn_build_check(const sn_builder *b, sn_scan *s, const char *cell, int base,
                                     sn_error *err);
/* Hand the result over and leave *b empty. Corners must be in range.
 * Surfaces: polygons are cut (see surface_io.h). Tets: inside-out ones are turned; parts are kept when no tag
 * is < 0. Errors: SN_EFORMAT (no cells, too many, a tet without volume, a huge concave polygon), SN_ENOMEM;
 * out is empty. */
SN_MUST_USE sn_status sn_build_surface(sn_builder *b, sn_tri_mesh *out, sn_error *err);
SN_MUST_USE sn_status sn_build_tets(sn_builder *b, sn_tet_mesh *out, sn_error *err);

/* Cuts polygon v (n >= 3 corners) into n - 2 triangles. work: room for 2 n. Not for n > SN_POLYGON_MAX unless
 * the polygon is convex: returns false then. */
#define SN_POLYGON_MAX 1024
bool sn_polygon_cut(const double *pos, const int32_t *v, int32_t n, int32_t *tri, int32_t *work);

/* ---- Formats. Readers fill a builder; their corners have been checked. Writers get a mesh that is valid.
 * ---- */

SN_MUST_USE sn_status sn_obj_read(sn_builder *b, sn_scan *s, sn_error *err);
SN_MUST_USE sn_status sn_ply_read(sn_builder *b, sn_scan *s, sn_error *err);
SN_MUST_USE sn_status sn_stl_read(sn_builder *b, sn_scan *s, sn_error *err); /* corners not shared */
SN_MUST_USE sn_status sn_off_read(sn_builder *b, sn_scan *s, sn_error *err);
void sn_obj_write(sn_out *o, const sn_tri_mesh *m, bool ascii);
void sn_ply_write(sn_out *o, const sn_tri_mesh *m, bool ascii);
void sn_stl_write(sn_out *o, const sn_tri_mesh *m, bool ascii);
void sn_off_write(sn_out *o, const sn_tri_mesh *m, bool ascii);
SN_MUST_USE sn_status sn_vtp_write(sn_out *o, const sn_polylines *p, const char *const *part_name,
                                   int32_t n_part, sn_error *err);

/* The polygons of VTK XML polygonal data (.vtp); points that only vertices, lines or strips use stay. */
SN_MUST_USE sn_status sn_vtp_read(sn_builder *b, sn_scan *s, sn_error *err);

SN_MUST_USE sn_status sn_vtu_read(sn_builder *b, sn_scan *s, sn_error *err);
SN_MUST_USE sn_status sn_medit_read(sn_builder *b, sn_scan *s, sn_error *err);
/* s: the file named by the caller, .node or .ele; reads the other one itself. */
SN_MUST_USE sn_status sn_tetgen_read(sn_builder *b, sn_scan *s, sn_error *err);
SN_MUST_USE sn_status sn_vtu_write(sn_out *o, const sn_tet_mesh *m, const sn_tet_extras *x, sn_error *err);
SN_MUST_USE sn_status sn_medit_write(sn_out *o, const sn_tet_mesh *m, const sn_tet_extras *x, sn_error *err);
SN_MUST_USE sn_status sn_gmsh_write(sn_out *o, const sn_tet_mesh *m, const sn_tet_extras *x, sn_error *err);
/* The name of a part: the one given, or (part_name NULL) "part<i>", made in `room`. */
const char *sn_part_name(const char *const *part_name, int32_t i_part, char room[24]);
/* Can it stand in quotes or on a line of its own: neither empty nor with quotes and control characters. */
bool sn_name_is_plain(const char *name);
/* Writes a line of numbers with blanks between them. */
void sn_out_doubles(sn_out *o, const double *v, int n);

static inline bool sn_host_is_big(void) /* most significant byte first */
{
    const uint16_t one = 1;
    unsigned char first;
    memcpy(&first, &one, 1);
    return first == 0;
}

/* ---- VTK XML, read: one array, as doubles ---- */

typedef struct sn_vtk_values {
    double *v; /* n, by sn_alloc, the caller's also on error */
    size_t n;
    bool is_there;       /* the file has it                                       */
    sn_number_type type; /* of one that is appended                               */
    bool is_appended;    /* its data is at that offset behind the elements        */
    size_t offset;
} sn_vtk_values;

typedef struct sn_vtk_layout { /* how a file holds its arrays */
    sn_scan *s;                /* for messages; its p is where text is read        */
    bool is_big, has_long_header;
} sn_vtk_layout;

/* The array that begins at `text`; is_whole: it is all of the text up to `end`. Errors: SN_EFORMAT,
 * SN_ENOMEM. */
SN_MUST_USE sn_status sn_vtk_read_base64(const sn_vtk_layout *f, const char *text, const char *end,
                                         bool is_whole, sn_number_type type, sn_vtk_values *out,
                                         sn_error *err);
SN_MUST_USE sn_status sn_vtk_read_raw(const sn_vtk_layout *f, const char *data, const char *end,
                                      sn_number_type type, sn_vtk_values *out, sn_error *err);
SN_MUST_USE sn_status sn_vtk_read_text(const sn_vtk_layout *f, const char *end, sn_vtk_values *out,
                                       sn_error *err);

/* ---- VTK XML, written: .vtu and .vtp. Arrays are inline, base64 or text. ---- */

typedef struct sn_vtk_out {
    sn_out *o; /* borrowed */
    bool ascii;
    unsigned char chunk[3 << 10]; /* bytes of the array that wait to be encoded: whole groups of 3 */
    size_t n_chunk;
} sn_vtk_out;

/* The head of a file of that type ("PolyData"), up to and with the opening tag of that name. */
void sn_vtk_begin(sn_vtk_out *w, sn_out *o, const char *type, bool ascii);
void sn_vtk_end(sn_vtk_out *w, const char *type); /* closes both tags */
/* The FieldData with the string array "tissue_names"; nothing when n_part = 0. */
void sn_vtk_part_names(sn_vtk_out *w, const char *const *part_name, int32_t n_part);
/* One array in one go: a row of n_comp numbers each. */
void sn_vtk_doubles(sn_vtk_out *w, const char *name, const double *v, size_t n_row, int n_comp);
void sn_vtk_i32(sn_vtk_out *w, const char *name, const int32_t *v, size_t n_row);
/* One array number by number: open, put each of n_value, close. type: SN_U8, SN_I32 or SN_I64. */
void sn_vtk_open(sn_vtk_out *w, sn_number_type type, const char *name, int n_comp, size_t n_value);
void sn_vtk_put(sn_vtk_out *w, sn_number_type type, int64_t v, bool ends_line);
void sn_vtk_close(sn_vtk_out *w);

#endif
