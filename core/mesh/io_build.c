/* io_build.c - the growing mesh that all readers fill, and the cutting of polygons into triangles. */
#include "mesh/io_private.h"

#include "base/alloc.h"

#include <string.h>

void sn_build_init(sn_builder *b, const char *path)
{
    *b = (sn_builder){.path = path};
}

void sn_build_free(sn_builder *b)
{
    sn_release(b->pos);
    sn_release(b->corner);
    sn_release(b->tag);
    sn_build_init(b, b->path);
}

static sn_status no_memory(const sn_builder *b, sn_error *err)
{
    return sn_fail(err, SN_ENOMEM, "%s: no memory for %zu vertices and %zu faces or tets", b->path,
                   sn_build_n_vert(b), b->n_cell);
}

sn_status sn_build_point(sn_builder *b, const double p[3], sn_error *err)
{
    if (!sn_grow(&b->pos, &b->cap_pos, b->n_pos + 3, sizeof *b->pos)) return no_memory(b, err);
    memcpy(b->pos + b->n_pos, p, 3 * sizeof *p);
    b->n_pos += 3;
    return SN_OK;
}

sn_status sn_build_corner(sn_builder *b, int64_t index, size_t at, sn_error *err)
{
    if (!sn_grow(&b->corner, &b->cap_corner, b->n_corner + 1, sizeof *b->corner)) return no_memory(b, err);
    if ((uint64_t)index > (uint64_t)b->worst) { /* a negative one is worse than any positive one */
        b->worst = index;
        b->worst_at = at;
    }
    b->corner[b->n_corner++] = index < 0 || index > INT32_MAX ? INT32_MAX : (int32_t)index;
    return SN_OK;
}

sn_status sn_build_cell(sn_builder *b, int32_t tag, sn_error *err)
{
    if (!sn_grow(&b->tag, &b->cap_cell, b->n_cell + 1, sizeof *b->tag)) return no_memory(b, err);
    b->tag[b->n_cell++] = tag;
    return SN_OK;
}

bool sn_build_in_range(const sn_builder *b)
{
    return b->n_cell == 0 || (uint64_t)b->worst < sn_build_n_vert(b);
}

sn_status sn_build_check(const sn_builder *b, sn_scan *s, const char *cell, int base, sn_error *err)
{
    if (sn_build_in_range(b)) return SN_OK;
    s->p = s->start + b->worst_at;
    return sn_scan_fail(s, err, "%s names vertex %lld, need %d..%lld", cell, (long long)(b->worst + base),
                        base, (long long)sn_build_n_vert(b) - 1 + base);
}

static sn_status check_counts(const sn_builder *b, size_t n_cell, const char *cells, sn_error *err)
{
    if (b->n_cell == 0) return sn_fail(err, SN_EFORMAT, "%s: no %s in the file", b->path, cells);
    if (sn_build_n_vert(b) > INT32_MAX || n_cell > INT32_MAX)
        return sn_fail(err, SN_EFORMAT, "%s: %zu vertices and %zu %s, at most %d of each are read", b->path,
                       sn_build_n_vert(b), n_cell, cells, INT32_MAX);
    return SN_OK;
}

/* Moves an array out of the builder and gives back the room that growing left over. */
static void *take(void *p_ptr, size_t n, size_t size)
{
    void *p, *none = NULL;
    memcpy(&p, p_ptr, sizeof p);
    memcpy(p_ptr, &none, sizeof none);
    void *q = sn_realloc(p, n, size);
    return q ? q : p;
}

static sn_status cut_all(const sn_builder *b, int32_t *face, int32_t *work, sn_error *err)
{
    const int32_t *v = b->corner;
    for (size_t i = 0; i < b->n_cell; i++) {
        int32_t n = b->tag[i];
        if (!sn_polygon_cut(b->pos, v, n, face, work))
            return sn_fail(err, SN_EFORMAT, "%s: face %zu is concave with %d corners, at most %d can be cut",
                           b->path, i + 1, n, SN_POLYGON_MAX);
        v += n;
        face += 3 * (size_t)(n - 2);
    }
    return SN_OK;
}

/* Replaces the polygons by triangles. */
static sn_status cut_polygons(sn_builder *b, size_t n_face, sn_error *err)
{
    int32_t max = 3;
    for (size_t i = 0; i < b->n_cell; i++)
        if (b->tag[i] > max) max = b->tag[i];
    int32_t *face = SN_NEW(int32_t, 3 * n_face), *work = SN_NEW(int32_t, 2 * (size_t)max);
    sn_status st = face && work ? cut_all(b, face, work, err) : no_memory(b, err);
    sn_release(work);
    if (st) {
        sn_release(face);
        return st;
    }
    sn_release(b->corner);
    b->corner = face;
    return SN_OK;
}

sn_status sn_build_surface(sn_builder *b, sn_tri_mesh *out, sn_error *err)
{
    sn_tri_mesh_free(out);
    size_t n_face = b->n_corner - 2 * b->n_cell; /* n - 2 for each polygon */
    sn_status st = check_counts(b, n_face, "faces", err);
    if (!st && b->n_corner != 3 * b->n_cell) st = cut_polygons(b, n_face, err);
    if (!st) {
        out->n_vert = (int32_t)sn_build_n_vert(b);
        out->n_face = (int32_t)n_face;
        out->pos = take(&b->pos, b->n_pos, sizeof *b->pos);
        out->face = take(&b->corner, 3 * n_face, sizeof *b->corner);
    }
    sn_build_free(b);
    return st;
}

static void turn_tets(sn_tet_mesh *m)
{
    for (int32_t i = 0; i < m->n_tet; i++)
        if (sn_tet_mesh_tet_volume(m, i) < 0.0) {
            int32_t *t = m->tet + 4 * (size_t)i, d = t[3];
            t[3] = t[2];
            t[2] = d;
        }
}

sn_status sn_build_tets(sn_builder *b, sn_tet_mesh *out, sn_error *err)
{
    sn_tet_mesh_free(out);
    sn_status st = check_counts(b, b->n_cell, "tets", err);
    if (!st) {
        bool has_parts = true;
        for (size_t i = 0; i < b->n_cell; i++) has_parts = has_parts && b->tag[i] >= 0;
        out->n_vert = (int32_t)sn_build_n_vert(b);
        out->n_tet = (int32_t)b->n_cell;
        out->pos = take(&b->pos, b->n_pos, sizeof *b->pos);
        out->tet = take(&b->corner, 4 * b->n_cell, sizeof *b->corner);
        out->part = has_parts ? take(&b->tag, b->n_cell, sizeof *b->tag) : NULL;
        turn_tets(out);
        if (sn_tet_mesh_validate(out, err)) {
            st = sn_fail_prefix(err, SN_EFORMAT, "%s: ", b->path);
            sn_tet_mesh_free(out);
        }
    }
    sn_build_free(b);
    return st;
}

/* ---- Polygons ---- */

typedef struct plane { /* the two coordinates of the polygon's projection, in which it turns counter-clockwise
                        */
    const double *pos;
    const int32_t *v;
    int axis[2];
} plane;

/* Projects along the largest component of Newell's normal. */
static plane make_plane(const double *pos, const int32_t *v, int32_t n)
{
    double normal[3] = {0.0, 0.0, 0.0};
    const double *o = pos + 3 * (size_t)v[0];
    for (int32_t i = 0; i < n; i++) {
        const double *p = pos + 3 * (size_t)v[i], *q = pos + 3 * (size_t)v[i + 1 < n ? i + 1 : 0];
        for (int k = 0; k < 3; k++) {
            int a = (k + 1) % 3, c = (k + 2) % 3;
            normal[k] += (p[a] - o[a]) * (q[c] - o[c]) - (p[c] - o[c]) * (q[a] - o[a]);
        }
    }
    int k = 0;
    for (int j = 1; j < 3; j++)
        if (fabs(normal[j]) > fabs(normal[k])) k = j;
    plane f = {pos, v, {(k + 1) % 3, (k + 2) % 3}};
    if (normal[k] < 0.0) {
        f.axis[0] = (k + 2) % 3;
        f.axis[1] = (k + 1) % 3;
    }
    return f;
}

/* Twice the signed area of the projected corners i, j, k. */
static double turn(const plane *f, int32_t i, int32_t j, int32_t k)
{
    const double *a = f->pos + 3 * (size_t)f->v[i], *b = f->pos + 3 * (size_t)f->v[j],
                 *c = f->pos + 3 * (size_t)f->v[k];
    int x = f->axis[0], y = f->axis[1];
    return (b[x] - a[x]) * (c[y] - a[y]) - (b[y] - a[y]) * (c[x] - a[x]);
}

static bool same_place(const plane *f, int32_t i, int32_t j)
{
    const double *a = f->pos + 3 * (size_t)f->v[i], *b = f->pos + 3 * (size_t)f->v[j];
    return a[f->axis[0]] == b[f->axis[0]] && a[f->axis[1]] == b[f->axis[1]];
}

static bool is_convex(const plane *f, int32_t n)
{
    for (int32_t i = 0; i < n; i++)
        if (turn(f, i, (i + 1) % n, (i + 2) % n) < 0.0) return false;
    return true;
}

/* Corner i with its neighbours is an ear: it turns left and no other corner lies in the triangle or on its
 * rim. Only a corner that does not turn left can be the first to enter. One at the same place as a corner of
 * the ear is where the polygon touches itself (a hole joined by a bridge) and does not count. */
static bool is_ear(const plane *f, const int32_t *prev, const int32_t *next, int32_t i)
{
    int32_t a = prev[i], c = next[i];
    if (!(turn(f, a, i, c) > 0.0)) return false;
    for (int32_t j = next[c]; j != a; j = next[j]) {
        if (turn(f, prev[j], j, next[j]) > 0.0) continue;
        if (same_place(f, j, a) || same_place(f, j, i) || same_place(f, j, c)) continue;
        if (turn(f, a, i, j) >= 0.0 && turn(f, i, c, j) >= 0.0 && turn(f, c, a, j) >= 0.0) return false;
    }
    return true;
}

/* Walks round the polygon and cuts ears. A lap without one means that the polygon crosses itself: the corner
 * at hand is then cut, so that n - 2 triangles always come out. */
static void cut_ears(const plane *f, int32_t n, int32_t *tri, int32_t *prev, int32_t *next)
{
    for (int32_t i = 0; i < n; i++) {
        prev[i] = (i + n - 1) % n;
        next[i] = (i + 1) % n;
    }
    int32_t left = n, since = 0, i = 1;
    while (left > 3) {
        if (since < left && !is_ear(f, prev, next, i)) {
            since++;
            i = next[i];
            continue;
        }
        *tri++ = f->v[prev[i]];
        *tri++ = f->v[i];
        *tri++ = f->v[next[i]];
        next[prev[i]] = next[i];
        prev[next[i]] = prev[i];
        i = next[next[i]]; /* skipping one keeps the triangles from all fanning out of one corner */
        left--;
        since = 0;
    }
    *tri++ = f->v[prev[i]];
    *tri++ = f->v[i];
    *tri = f->v[next[i]];
}

bool sn_polygon_cut(const double *pos, const int32_t *v, int32_t n, int32_t *tri, int32_t *work)
{
    plane f = make_plane(pos, v, n);
    if (n > 3 && !is_convex(&f, n)) {
        if (n > SN_POLYGON_MAX) return false;
        cut_ears(&f, n, tri, work, work + n);
        return true;
    }
    for (int32_t i = 1; i + 1 < n; i++) {
        *tri++ = v[0];
        *tri++ = v[i];
        *tri++ = v[i + 1];
    }
    return true;
}
