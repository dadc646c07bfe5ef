#include "mesh/tet_mesh.h"

#include "base/alloc.h"
#include "base/array.h"

#include <string.h>

const int sn_tet_face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
const int sn_tet_edge[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

void sn_tet_mesh_init(sn_tet_mesh *m)
{
    memset(m, 0, sizeof *m);
}

void sn_tet_mesh_free(sn_tet_mesh *m)
{
    sn_release(m->pos);
    sn_release(m->tet);
    sn_release(m->part);
    sn_tet_mesh_init(m);
}

sn_status sn_tet_mesh_reserve(sn_tet_mesh *m, int32_t n_vert, int32_t n_tet, bool has_parts, sn_error *err)
{
    sn_tet_mesh_free(m);
    m->pos = SN_NEW(double, 3 * (size_t)n_vert);
    m->tet = SN_NEW(int32_t, 4 * (size_t)n_tet);
    m->part = has_parts ? SN_NEW(int32_t, n_tet) : NULL;
    if (!m->pos || !m->tet || (has_parts && !m->part)) {
        sn_tet_mesh_free(m);
        return sn_fail(err, SN_ENOMEM, "tet mesh: no memory for %d vertices and %d tets", n_vert, n_tet);
    }
    m->n_vert = n_vert;
    m->n_tet = n_tet;
    return SN_OK;
}

sn_status sn_tet_mesh_copy(sn_tet_mesh *out, const sn_tet_mesh *m, sn_error *err)
{
    sn_status st = sn_tet_mesh_reserve(out, m->n_vert, m->n_tet, m->part != NULL, err);
    if (st) return st;
    memcpy(out->pos, m->pos, 3 * (size_t)m->n_vert * sizeof *m->pos);
    memcpy(out->tet, m->tet, 4 * (size_t)m->n_tet * sizeof *m->tet);
    if (m->part) memcpy(out->part, m->part, (size_t)m->n_tet * sizeof *m->part);
    return SN_OK;
}

double sn_tet_mesh_tet_volume(const sn_tet_mesh *m, int32_t i_tet)
{
    const int32_t *t = m->tet + 4 * (size_t)i_tet;
    sn_vec3 a = sn_tet_mesh_point(m, t[0]);
    return sn_v3_det(sn_v3_sub(sn_tet_mesh_point(m, t[1]), a), sn_v3_sub(sn_tet_mesh_point(m, t[2]), a),
                     sn_v3_sub(sn_tet_mesh_point(m, t[3]), a)) /
           6.0;
}

sn_status sn_tet_mesh_validate(const sn_tet_mesh *m, sn_error *err)
{
    if (m->n_tet < 1) return sn_fail(err, SN_EINVAL, "tet mesh has no tets");
    for (int32_t i = 0; i < m->n_vert; i++)
        if (!sn_v3_is_finite(sn_tet_mesh_point(m, i)))
            return sn_fail(err, SN_EINVAL, "vertex %d has a coordinate that is not finite", i + 1);
    for (int32_t t = 0; t < m->n_tet; t++) {
        for (int k = 0; k < 4; k++) {
            int32_t v = m->tet[4 * (size_t)t + (size_t)k];
            if (v < 0 || v >= m->n_vert)
                return sn_fail(err, SN_EINVAL, "tet %d names vertex %lld, need 1..%d", t + 1,
                               (long long)v + 1, m->n_vert);
        }
        double vol = sn_tet_mesh_tet_volume(m, t);
        if (!(vol > 0.0)) return sn_fail(err, SN_EINVAL, "tet %d has volume %g, need > 0", t + 1, vol);
    }
    return SN_OK;
}

sn_vec3 sn_tet_mesh_centre(const sn_tet_mesh *m, int32_t i_tet)
{
    sn_vec3 p = {0};
    for (int k = 0; k < 4; k++)
        p = sn_v3_mad(p, 0.25, sn_tet_mesh_point(m, m->tet[4 * (size_t)i_tet + (size_t)k]));
    return p;
}

sn_box3 sn_tet_mesh_bounds(const sn_tet_mesh *m)
{
    sn_box3 b = sn_box3_empty();
    for (int32_t i = 0; i < m->n_vert; i++) b = sn_box3_add(b, sn_tet_mesh_point(m, i));
    return b;
}

double sn_tet_mesh_volume(const sn_tet_mesh *m)
{
    double sum = 0.0;
    for (int32_t t = 0; t < m->n_tet; t++) sum += sn_tet_mesh_tet_volume(m, t);
    return sum;
}

/* Faces are bucketed by their smallest vertex (counting sort), then matched inside the bucket, which is
 * short. */
sn_status sn_tet_mesh_adjacency(const sn_tet_mesh *m, int32_t **out, sn_error *err)
{
    size_t n_half = 4 * (size_t)m->n_tet;
    int32_t *adj = SN_NEW(int32_t, n_half), *next = SN_NEW(int32_t, n_half),
            *mid = SN_NEW(int32_t, 2 * n_half);
    int32_t *head = SN_NEW(int32_t, m->n_vert);
    sn_status st = SN_OK;
    *out = NULL;
    if (!adj || !next || !mid || !head) {
        st = sn_fail(err, SN_ENOMEM, "tet mesh: no memory for the adjacency of %d tets", m->n_tet);
        goto done;
    }
    for (int32_t v = 0; v < m->n_vert; v++) head[v] = -1;
    for (size_t h = 0; h < n_half; h++) {
        const int32_t *t = m->tet + (h & ~(size_t)3);
        const int *c = sn_tet_face[h & 3];
        int32_t v[3] = {t[c[0]], t[c[1]], t[c[2]]};
        sn_sort3(v);
        mid[2 * h] = v[1];
        mid[2 * h + 1] = v[2];
        adj[h] = -1;
        int32_t g = head[v[0]];
        while (g >= 0 && (mid[2 * (size_t)g] != v[1] || mid[2 * (size_t)g + 1] != v[2])) g = next[g];
        if (g < 0) {
            next[h] = head[v[0]];
            head[v[0]] = (int32_t)h;
        } else if (adj[g] >= 0) {
            st = sn_fail(err, SN_EINVAL, "tet mesh: face (%d, %d, %d) belongs to more than two tets",
                         v[0] + 1, v[1] + 1, v[2] + 1);
            goto done;
        } else {
            adj[g] = (int32_t)(h >> 2);
            adj[h] = g >> 2;
        }
    }
    *out = adj;
    adj = NULL;
done:
    sn_release(adj);
    sn_release(next);
    sn_release(mid);
    sn_release(head);
    return st;
}

/* used[v] -> rank among the used, -1 otherwise; returns how many. */
static int32_t number_used(int32_t *used, int32_t n)
{
    int32_t k = 0;
    for (int32_t v = 0; v < n; v++) used[v] = used[v] ? k++ : -1;
    return k;
}

static bool is_inside(const sn_tet_mesh *m, int32_t t, int32_t part_id)
{
    return t >= 0 && (part_id < 0 || (m->part && m->part[t] == part_id));
}

static bool is_outer(const sn_tet_mesh *m, const int32_t *adj, size_t h, int32_t part_id)
{
    return is_inside(m, (int32_t)(h >> 2), part_id) && !is_inside(m, adj[h], part_id);
}

static int32_t half_face_vertex(const sn_tet_mesh *m, size_t h, int k)
{
    return m->tet[(h & ~(size_t)3) + (size_t)sn_tet_face[h & 3][k]];
}

sn_status sn_tet_mesh_surface_adj(const sn_tet_mesh *m, const int32_t *adj, int32_t part_id, sn_tri_mesh *out,
                                  int32_t **v_map, sn_error *err)
{
    size_t n_half = 4 * (size_t)m->n_tet, n = 0;
    int32_t *used = SN_NEW_ZERO(int32_t, m->n_vert), *map = NULL, n_face = 0;
    sn_tri_mesh_free(out);
    if (v_map) *v_map = NULL;
    if (!used) return sn_fail(err, SN_ENOMEM, "surface: no memory");
    for (size_t h = 0; h < n_half; h++) {
        if (!is_outer(m, adj, h, part_id)) continue;
        n_face++;
        for (int k = 0; k < 3; k++) used[half_face_vertex(m, h, k)] = 1;
    }
    int32_t n_vert = number_used(used, m->n_vert);
    map = SN_NEW(int32_t, n_vert);
    sn_status st =
        map ? sn_tri_mesh_reserve(out, n_vert, n_face, err) : sn_fail(err, SN_ENOMEM, "surface: no memory");
    if (st) goto done;
    for (int32_t v = 0; v < m->n_vert; v++)
        if (used[v] >= 0) {
            map[used[v]] = v;
            memcpy(out->pos + 3 * (size_t)used[v], m->pos + 3 * (size_t)v, 3 * sizeof *m->pos);
        }
    for (size_t h = 0; h < n_half; h++)
        for (int k = 0; k < 3 && is_outer(m, adj, h, part_id); k++)
            out->face[n++] = used[half_face_vertex(m, h, k)];
    if (v_map) {
        *v_map = map;
        map = NULL;
    }
done:
    sn_release(used);
    sn_release(map);
    return st;
}

sn_status sn_tet_mesh_surface(const sn_tet_mesh *m, int32_t part_id, sn_tri_mesh *out, int32_t **v_map,
                              sn_error *err)
{
    int32_t *adj = NULL;
    if (v_map) *v_map = NULL;
    sn_status st = sn_tet_mesh_adjacency(m, &adj, err);
    if (st)
        sn_tri_mesh_free(out);
    else
        st = sn_tet_mesh_surface_adj(m, adj, part_id, out, v_map, err);
    sn_release(adj);
    return st;
}
