#include "mesh/remesh_private.h"

#include "base/alloc.h"
#include "mesh/predicates.h"

#include <string.h>

typedef struct cell_range {
    int32_t lo[3], hi[3];
} cell_range;

static int32_t cell_of(double x, double origin, double cell)
{
    return (int32_t)floor((x - origin) / cell);
}

/* fmin and fmax are calls into the C library, for the sake of NaN: a fifth of the remesher's time. */
static double min3(double a, double b, double c)
{
    double m = a < b ? a : b;
    return m < c ? m : c;
}

static double max3(double a, double b, double c)
{
    double m = a > b ? a : b;
    return m > c ? m : c;
}

static cell_range range_of(const rm_grid *g, const sn_vec3 p[3])
{
    return (cell_range){{cell_of(min3(p[0].x, p[1].x, p[2].x), g->origin.x, g->cell),
                         cell_of(min3(p[0].y, p[1].y, p[2].y), g->origin.y, g->cell),
                         cell_of(min3(p[0].z, p[1].z, p[2].z), g->origin.z, g->cell)},
                        {cell_of(max3(p[0].x, p[1].x, p[2].x), g->origin.x, g->cell),
                         cell_of(max3(p[0].y, p[1].y, p[2].y), g->origin.y, g->cell),
                         cell_of(max3(p[0].z, p[1].z, p[2].z), g->origin.z, g->cell)}};
}

static size_t slot_of(const rm_grid *g, int32_t x, int32_t y, int32_t z)
{
    uint64_t h = (uint64_t)(uint32_t)x * 0x9E3779B97F4A7C15u ^ (uint64_t)(uint32_t)y * 0xC2B2AE3D27D4EB4Fu ^
                 (uint64_t)(uint32_t)z * 0x165667B19E3779F9u;
    return (size_t)((h ^ h >> 29) & (g->n_head - 1));
}

static void corners(const rm_mesh *m, int32_t t, sn_vec3 p[3])
{
    for (int k = 0; k < 3; k++) p[k] = m->pos[m->vert[3 * (size_t)t + (size_t)k]];
}

static bool add_to_cell(rm_grid *g, int32_t t, int32_t x, int32_t y, int32_t z)
{
    int32_t i = g->free_link;
    if (i >= 0) {
        g->free_link = g->link[i].next;
    } else {
        if (g->n_link >= INT32_MAX || !sn_grow(&g->link, &g->cap_link, g->n_link + 1, sizeof *g->link))
            return false;
        i = (int32_t)g->n_link++;
    }
    size_t s = slot_of(g, x, y, z);
    g->link[i] = (struct rm_link){t, g->head[s], x, y, z};
    g->head[s] = i;
    return true;
}

bool rm_grid_add(rm_grid *g, const rm_mesh *m, int32_t t)
{
    sn_vec3 p[3];
    corners(m, t, p);
    cell_range r = range_of(g, p);
    for (int32_t z = r.lo[2]; z <= r.hi[2]; z++)
        for (int32_t y = r.lo[1]; y <= r.hi[1]; y++)
            for (int32_t x = r.lo[0]; x <= r.hi[0]; x++)
                if (!add_to_cell(g, t, x, y, z)) return false;
    return true;
}

static void remove_from_cell(rm_grid *g, int32_t t, int32_t x, int32_t y, int32_t z)
{
    int32_t *at = &g->head[slot_of(g, x, y, z)];
    while (*at >= 0) {
        struct rm_link *l = &g->link[*at];
        if (l->tri == t && l->cx == x && l->cy == y && l->cz == z) {
            int32_t i = *at;
            *at = l->next;
            l->next = g->free_link;
            g->free_link = i;
            return;
        }
        at = &l->next;
    }
}

void rm_grid_remove(rm_grid *g, const rm_mesh *m, int32_t t)
{
    sn_vec3 p[3];
    corners(m, t, p);
    cell_range r = range_of(g, p);
    for (int32_t z = r.lo[2]; z <= r.hi[2]; z++)
        for (int32_t y = r.lo[1]; y <= r.hi[1]; y++)
            for (int32_t x = r.lo[0]; x <= r.hi[0]; x++) remove_from_cell(g, t, x, y, z);
}

sn_status rm_grid_build(rm_grid *g, const rm_mesh *m, double cell, sn_error *err)
{
    memset(g, 0, sizeof *g);
    g->free_link = -1;
    sn_box3 b = sn_box3_empty();
    for (size_t v = 0; v < m->n_vert; v++) b = sn_box3_add(b, m->pos[v]);
    g->cell = fmax(cell, 1e-5 * sn_box3_diagonal(b)); /* cell numbers fit 32 bits */
    g->origin = b.min;
    g->n_head = 1024;
    while (g->n_head < 2 * m->n_tri) g->n_head *= 2;
    g->head = SN_NEW(int32_t, g->n_head);
    bool ok = g->head != NULL;
    for (size_t s = 0; ok && s < g->n_head; s++) g->head[s] = -1;
    for (size_t t = 0; ok && t < m->n_tri; t++) ok = rm_grid_add(g, m, (int32_t)t);
    if (ok) return SN_OK;
    rm_grid_free(g);
    return sn_fail(err, SN_ENOMEM, "remesh: no memory for the grid of %zu triangles", m->n_tri);
}

void rm_grid_free(rm_grid *g)
{
    sn_release(g->head);
    sn_release(g->link);
    memset(g, 0, sizeof *g);
}

static bool boxes_apart(const sn_vec3 p[3], const sn_vec3 q[3])
{
    return min3(p[0].x, p[1].x, p[2].x) > max3(q[0].x, q[1].x, q[2].x) ||
           max3(p[0].x, p[1].x, p[2].x) < min3(q[0].x, q[1].x, q[2].x) ||
           min3(p[0].y, p[1].y, p[2].y) > max3(q[0].y, q[1].y, q[2].y) ||
           max3(p[0].y, p[1].y, p[2].y) < min3(q[0].y, q[1].y, q[2].y) ||
           min3(p[0].z, p[1].z, p[2].z) > max3(q[0].z, q[1].z, q[2].z) ||
           max3(p[0].z, p[1].z, p[2].z) < min3(q[0].z, q[1].z, q[2].z);
}

static bool crosses_in_cell(const rm_grid *g, const rm_mesh *m, const sn_vec3 p[3], const int32_t id[3],
                            const int32_t *skip, int n_skip, const int32_t c[3], const cell_range *r)
{
    for (int32_t i = g->head[slot_of(g, c[0], c[1], c[2])]; i >= 0; i = g->link[i].next) {
        const struct rm_link *l = &g->link[i];
        if (l->cx != c[0] || l->cy != c[1] || l->cz != c[2]) continue;
        sn_vec3 q[3];
        corners(m, l->tri, q);
        if (boxes_apart(p, q)) continue;
        /* A triangle in several cells is tested in the lowest cell that both ranges share. */
        cell_range s = range_of(g, q);
        bool here = true;
        for (int k = 0; k < 3; k++) here = here && c[k] == (s.lo[k] > r->lo[k] ? s.lo[k] : r->lo[k]);
        if (!here) continue;
        bool skipped = false;
        for (int k = 0; k < n_skip; k++) skipped = skipped || skip[k] == l->tri;
        if (skipped) continue;
        const int32_t *v = m->vert + 3 * (size_t)l->tri;
        int a[3] = {id[0], id[1], id[2]}, b[3] = {v[0], v[1], v[2]};
        if (sn_triangles_cross(p, a, q, b)) return true;
    }
    return false;
}

bool rm_grid_crosses(const rm_grid *g, const rm_mesh *m, const sn_vec3 p[3], const int32_t id[3],
                     const int32_t *skip, int n_skip)
{
    cell_range r = range_of(g, p);
    int32_t c[3];
    for (c[2] = r.lo[2]; c[2] <= r.hi[2]; c[2]++)
        for (c[1] = r.lo[1]; c[1] <= r.hi[1]; c[1]++)
            for (c[0] = r.lo[0]; c[0] <= r.hi[0]; c[0]++)
                if (crosses_in_cell(g, m, p, id, skip, n_skip, c, &r)) return true;
    return false;
}
