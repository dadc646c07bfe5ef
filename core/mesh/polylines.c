/* polylines.c - lines of points, and their files in text; io_vtp.c writes the others. */
#include "mesh/polylines.h"

#include "base/alloc.h"
#include "mesh/io_private.h"

#include <string.h>

void sn_polylines_init(sn_polylines *p, bool has_value)
{
    memset(p, 0, sizeof *p);
    p->has_value = has_value;
}

void sn_polylines_free(sn_polylines *p)
{
    sn_release(p->pos);
    sn_release(p->first);
    sn_release(p->part);
    sn_release(p->value);
    sn_polylines_init(p, p->has_value);
}

/* Room for so many more; what is there stays as it is, also on failure. */
static sn_status make_room(sn_polylines *p, size_t n_line, size_t n_point, sn_error *err)
{
    bool had_first = p->first != NULL;
    bool ok = sn_grow(&p->pos, &p->cap_pos, p->n_point + n_point, 3 * sizeof *p->pos) &&
              sn_grow(&p->part, &p->cap_part, p->n_line + n_line, sizeof *p->part) &&
              sn_grow(&p->first, &p->cap_first, p->n_line + n_line + 1, sizeof *p->first);
    if (ok && p->has_value) ok = sn_grow(&p->value, &p->cap_value, p->n_point + n_point, sizeof *p->value);
    if (!had_first && p->first) p->first[0] = 0;
    if (ok) return SN_OK;
    return sn_fail(err, SN_ENOMEM, "lines: no memory for %zu lines with %zu points", p->n_line + n_line,
                   p->n_point + n_point);
}

sn_status sn_polylines_begin(sn_polylines *p, int32_t part, sn_error *err)
{
    sn_status st = make_room(p, 1, 0, err);
    if (st) return st;
    p->part[p->n_line++] = part;
    p->first[p->n_line] = (int64_t)p->n_point;
    return SN_OK;
}

sn_status sn_polylines_add(sn_polylines *p, sn_vec3 point, double value, sn_error *err)
{
    if (p->n_line == 0) return sn_fail(err, SN_EINVAL, "lines: a point before the first line");
    sn_status st = make_room(p, 0, 1, err);
    if (st) return st;
    sn_v3_store(p->pos + 3 * p->n_point, point);
    if (p->has_value) p->value[p->n_point] = value;
    p->first[p->n_line] = (int64_t)++p->n_point;
    return SN_OK;
}

static void swap_points(sn_polylines *p, size_t a, size_t b)
{
    sn_vec3 at_a = sn_polylines_point(p, a);
    sn_v3_store(p->pos + 3 * a, sn_polylines_point(p, b));
    sn_v3_store(p->pos + 3 * b, at_a);
    if (!p->has_value) return;
    double value = p->value[a];
    p->value[a] = p->value[b];
    p->value[b] = value;
}

void sn_polylines_reverse_last(sn_polylines *p)
{
    if (p->n_line == 0) return;
    size_t a = (size_t)p->first[p->n_line - 1], b = p->n_point;
    while (a + 1 < b) swap_points(p, a++, --b);
}

void sn_polylines_drop_last(sn_polylines *p)
{
    if (p->n_line > 0) p->n_point = (size_t)p->first[--p->n_line];
}

sn_status sn_polylines_append(sn_polylines *p, const sn_polylines *other, sn_error *err)
{
    if (p->has_value != other->has_value)
        return sn_fail(err, SN_EINVAL, "lines: cannot join lines with values and lines without");
    if (other->n_line == 0) return SN_OK;
    sn_status st = make_room(p, other->n_line, other->n_point, err);
    if (st) return st;
    for (size_t i = 0; i < other->n_line; i++) {
        p->part[p->n_line + i] = other->part[i];
        p->first[p->n_line + i + 1] = (int64_t)p->n_point + other->first[i + 1];
    }
    if (other->n_point > 0) { /* else its arrays are NULL */
        memcpy(p->pos + 3 * p->n_point, other->pos, 3 * other->n_point * sizeof *p->pos);
        if (p->has_value) memcpy(p->value + p->n_point, other->value, other->n_point * sizeof *p->value);
    }
    p->n_line += other->n_line;
    p->n_point += other->n_point;
    return SN_OK;
}

double sn_polylines_length(const sn_polylines *p, size_t i_line)
{
    double sum = 0.0;
    for (int64_t k = p->first[i_line]; k + 1 < p->first[i_line + 1]; k++)
        sum += sn_v3_dist(sn_polylines_point(p, (size_t)k), sn_polylines_point(p, (size_t)k + 1));
    return sum;
}

sn_box3 sn_polylines_bounds(const sn_polylines *p)
{
    sn_box3 b = sn_box3_empty();
    for (size_t i = 0; i < p->n_point; i++) b = sn_box3_add(b, sn_polylines_point(p, i));
    return b;
}

/* ---- Files ---- */

static void write_line(sn_out *o, int64_t first, int64_t end)
{
    sn_out_text(o, "l");
    for (int64_t k = first; k < end; k++) {
        sn_out_text(o, " ");
        sn_out_int(o, k + 1);
    }
    sn_out_text(o, "\n");
}

static sn_status write_obj(sn_out *o, const sn_polylines *p, const char *const *part_name, int32_t n_part,
                           sn_error *err)
{
    for (int32_t i = 0; i < n_part; i++) {
        const char *name = part_name[i];
        if (name[strlen(name) - 1] == '\\')
            return sn_fail(err, SN_EINVAL, "the name '%s' ends with a backslash, which joins lines in .obj",
                           name);
    }
    for (size_t k = 0; k < p->n_point; k++) {
        sn_out_text(o, "v ");
        sn_out_doubles(o, p->pos + 3 * k, 3);
    }
    for (size_t i = 0; i < p->n_line; i++) {
        if (i == 0 || p->part[i] != p->part[i - 1]) {
            sn_out_text(o, "o ");
            sn_out_text(o, part_name[p->part[i]]);
            sn_out_text(o, "\n");
        }
        write_line(o, p->first[i], p->first[i + 1]);
    }
    return SN_OK;
}

static sn_status check_line(const sn_polylines *p, size_t i, int32_t n_part, sn_error *err)
{
    if (p->part[i] < 0 || p->part[i] >= n_part)
        return sn_fail(err, SN_EINVAL, "line %zu has part id %d, which has no name (there are %d names)",
                       i + 1, p->part[i], n_part);
    size_t n = sn_polylines_count(p, i), first = (size_t)p->first[i];
    if (n < 2) return sn_fail(err, SN_EINVAL, "line %zu has %zu points, need 2 or more", i + 1, n);
    for (size_t k = 0; k < n; k++) {
        if (!sn_v3_is_finite(sn_polylines_point(p, first + k)))
            return sn_fail(err, SN_EINVAL, "point %zu of line %zu has a coordinate that is not finite", k + 1,
                           i + 1);
        if (p->has_value && !isfinite(p->value[first + k]))
            return sn_fail(err, SN_EINVAL, "point %zu of line %zu has a value that is not finite", k + 1,
                           i + 1);
    }
    return SN_OK;
}

static sn_status check(const sn_polylines *p, const char *const *part_name, int32_t n_part, sn_error *err)
{
    if (p->n_line == 0) return sn_fail(err, SN_EINVAL, "there are no lines");
    if (n_part < 0) return sn_fail(err, SN_EINVAL, "%d part names, need 0 or more", n_part);
    for (int32_t i = 0; i < n_part; i++)
        if (!sn_name_is_plain(part_name[i]))
            return sn_fail(err, SN_EINVAL, "part %d needs a name without quotes and control characters",
                           i + 1);
    for (size_t i = 0; i < p->n_line; i++) {
        sn_status st = check_line(p, i, n_part, err);
        if (st) return st;
    }
    return SN_OK;
}

sn_status sn_polylines_save(const sn_polylines *p, const char *const *part_name, int32_t n_part,
                            const char *path, sn_error *err)
{
    char ext[16];
    sn_file_extension(path, ext);
    bool is_vtp = strcmp(ext, "vtp") == 0;
    if (!is_vtp && strcmp(ext, "obj") != 0)
        return sn_fail(err, SN_EINVAL, "%s: no format of lines to write '%s' (known: .vtp .obj)", path, ext);
    sn_status st = check(p, part_name, n_part, err);
    if (st) return sn_fail_prefix(err, st, "%s: cannot save: ", path);
    sn_out *o = NULL;
    st = sn_out_open(&o, path, err);
    if (st) return st;
    st = (is_vtp ? sn_vtp_write : write_obj)(o, p, part_name, n_part, err);
    if (!st) return sn_out_commit(o, err);
    sn_out_abort(o);
    return sn_fail_prefix(err, st, "%s: cannot save: ", path);
}
