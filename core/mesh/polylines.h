/* polylines.h - many lines of points, each of a tissue: fibers, muscle curves. Lengths in the scene's unit.
 * C indices are 0-based.
 *
 * The points of all lines stand in one row: line i has the points first[i] to first[i + 1] - 1. Lines are
 * made one after the other, and only the last one can grow, turn or go. */
#ifndef SN_MESH_POLYLINES_H
#define SN_MESH_POLYLINES_H

#include "base/status.h"
#include "base/vec3.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

SN_BEGIN_DECLS

typedef struct sn_polylines { /* open: kernels read the arrays directly */
    double *pos;              /* n_point x 3, row-major, owned                                   */
    int64_t *first;           /* n_line + 1, ascending from 0; owned; NULL before the first line */
    int32_t *part;            /* n_line, the tissue's id >= 0; owned                             */
    double *value;            /* n_point, such as the u of a fiber; NULL unless has_value; owned */
    size_t n_point, n_line;
    bool has_value;
    size_t cap_pos, cap_first, cap_part, cap_value; /* the rooms, for sn_grow */
} sn_polylines;

void sn_polylines_init(sn_polylines *p, bool has_value); /* makes *p empty; must come first     */
void sn_polylines_free(sn_polylines *p); /* releases and re-inits, has_value stays; fine twice */

/* Starts a line without points. Errors: SN_ENOMEM; *p is unchanged. */
SN_MUST_USE sn_status sn_polylines_begin(sn_polylines *p, int32_t part, sn_error *err);
/* Appends a point to the last line. value: not kept unless has_value. Errors: SN_ENOMEM, SN_EINVAL (there is
 * no line); *p is unchanged. */
SN_MUST_USE sn_status sn_polylines_add(sn_polylines *p, sn_vec3 point, double value, sn_error *err);
void sn_polylines_reverse_last(sn_polylines *p); /* turns the last line round; nothing without one */
void sn_polylines_drop_last(sn_polylines *p);    /* takes the last line away; nothing without one  */
/* Appends all lines of `other`, which is not *p. Errors: SN_ENOMEM, SN_EINVAL (values on one side only); *p
 * is unchanged. */
SN_MUST_USE sn_status sn_polylines_append(sn_polylines *p, const sn_polylines *other, sn_error *err);

static inline sn_vec3 sn_polylines_point(const sn_polylines *p, size_t i_point)
{
    return sn_v3_load(p->pos + 3 * i_point);
}
static inline size_t sn_polylines_count(const sn_polylines *p, size_t i_line) /* points of a line */
{
    return (size_t)(p->first[i_line + 1] - p->first[i_line]);
}
double sn_polylines_length(const sn_polylines *p, size_t i_line); /* 0 below two points                 */
sn_box3 sn_polylines_bounds(const sn_polylines *p);               /* of all points; empty for no points */

/* Writes by extension (any case). part_name: n_part names, UTF-8, without '"' and control characters; the id
 * of each line is an index into them.
 *
 * .vtp: VTK XML, inline base64, header_type UInt64. Lines with Int64 connectivity; cell array "tissue"
 * (Int32); point array "u" (Float64) when has_value; all names as a FieldData string array "tissue_names", as
 * in .vtu.
 *
 * .obj: every point as v, then an "l" for each line; "o NAME" wherever the tissue is another than before.
 * Values are left out.
 *
 * All or nothing; independent of locale; the same lines give the same bytes. Errors: SN_EIO; SN_EINVAL
 * (unknown extension, no lines, a line of fewer than two points, a coordinate or value that is not finite, a
 * part id without a name, a name that cannot be; in .obj a name that ends with a backslash); SN_ENOMEM. */
SN_MUST_USE sn_status sn_polylines_save(const sn_polylines *p, const char *const *part_name, int32_t n_part,
                                        const char *path, sn_error *err);

SN_END_DECLS

#endif
