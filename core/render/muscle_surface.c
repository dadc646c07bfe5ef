#include "render/muscle_surface.h"

#include "base/alloc.h"
#include "render/draw.h"
#include "render/muscle_polygons.h"

#include <string.h>

enum { block_items = 4096 }; /* tets or faces: the same blocks for any number of threads */
static const double crease_deg = 50.0;

/* ---- the border ---- */

void sn_muscle_border_free(sn_muscle_border *b)
{
    sn_release(b->vert);
    sn_release(b->normal);
    memset(b, 0, sizeof *b);
}

sn_status sn_muscle_border_find(sn_muscle_border *b, const sn_tet_mesh *mesh, const sn_run *run,
                                sn_error *err)
{
    sn_tri_mesh surface;
    sn_tri_mesh_init(&surface);
    int32_t *v_map = NULL;
    float *normal = NULL;
    sn_status st = sn_tet_mesh_surface(mesh, -1, &surface, &v_map, err);
    size_t n = 3 * (size_t)surface.n_face;
    if (!st) {
        normal = SN_NEW(float, 3 * n);
        b->vert = SN_NEW(int32_t, n);
        b->normal = SN_NEW(int16_t, 3 * n);
        st = normal && b->vert && b->normal
                 ? sn_corner_normals(&surface, crease_deg, run, normal, err)
                 : sn_fail(err, SN_ENOMEM, "picture: no memory for %d border faces", surface.n_face);
    }
    if (!st) {
        for (size_t i = 0; i < n; i++) b->vert[i] = v_map[surface.face[i]];
        for (size_t i = 0; i < 3 * n; i++) b->normal[i] = (int16_t)lrintf(32767.0f * normal[i]);
        b->n_face = surface.n_face;
    } else {
        sn_muscle_border_free(b);
    }
    sn_tri_mesh_free(&surface);
    sn_release(v_map);
    sn_release(normal);
    return st;
}

/* ---- polygons ---- */

typedef struct joining {
    const sn_picture_scene *scene;
    const sn_muscle_tets *tets;
    const sn_muscle_border *border;
    sn_vec3 origin;
    sn_polygons *block; /* those of the tets, then those of the faces */
    int32_t n_tet_block, n_block;
    size_t *corner0, *own0, *index0; /* per block: what the ones before it have */
    sn_corner *corner;               /* n_corner, of all blocks                 */
    uint32_t *vertex;                /* per corner: its vertex                  */
    uint32_t *at;                    /* n_vert + 1: corners by their edges' lower vertices, then...      */
    uint32_t *order;                 /* ...the corners in this order                                     */
    size_t n_corner, n_shared, n_own, n_index;
} joining;

static sn_status no_memory(sn_error *err)
{
    return sn_fail(err, SN_ENOMEM, "picture: no memory for the surfaces of the muscles");
}

static bool fill_block(joining *j, int32_t i_block, sn_polygon_scratch *w)
{
    bool is_tet = i_block < j->n_tet_block, ok = true;
    int32_t n = is_tet ? j->tets->n_tet : j->border->n_face;
    int32_t i0 = (is_tet ? i_block : i_block - j->n_tet_block) * block_items;
    int32_t i1 = n - i0 > block_items ? i0 + block_items : n;
    sn_polygons *p = &j->block[i_block];
    for (int32_t i = i0; i < i1 && ok; i++)
        ok = is_tet ? sn_polygons_add_tet(p, j->scene, j->tets, i, j->origin, w)
                    : sn_polygons_add_face(p, j->scene, j->tets, j->border, i, j->origin, w);
    return ok;
}

static sn_status make_polygons(joining *j, const sn_run *run, sn_error *err)
{
    j->n_tet_block = (j->tets->n_tet + block_items - 1) / block_items;
    j->n_block = j->n_tet_block + (j->border->n_face + block_items - 1) / block_items;
    j->block = SN_NEW_ZERO(sn_polygons, j->n_block);
    if (!j->block) return no_memory(err);
    bool is_short = false;
#pragma omp parallel num_threads(sn_run_threads(run)) reduction(|| : is_short)
    {
        sn_polygon_scratch w;
        is_short = !sn_polygon_scratch_init(&w, j->scene->n_tissue);
#pragma omp for schedule(dynamic, 1)
        for (int32_t i = 0; i < j->n_block; i++)
            if (!is_short) is_short = !fill_block(j, i, &w);
        sn_polygon_scratch_free(&w);
    }
    return is_short ? no_memory(err) : SN_OK;
}

/* The corners of all blocks one after another. */
static sn_status gather_corners(joining *j, const sn_run *run, sn_error *err)
{
    j->corner0 = SN_NEW(size_t, j->n_block);
    j->own0 = SN_NEW(size_t, j->n_block);
    j->index0 = SN_NEW(size_t, j->n_block);
    if (!j->corner0 || !j->own0 || !j->index0) return no_memory(err);
    for (int32_t i = 0; i < j->n_block; i++) {
        const sn_polygons *p = &j->block[i];
        j->corner0[i] = j->n_corner;
        j->own0[i] = j->n_own;
        j->index0[i] = j->n_index;
        j->n_corner += p->n_corner;
        j->n_own += p->n_own;
        j->n_index += 3 * (p->n_corner - 2 * p->n_polygon); /* n corners are n - 2 triangles */
    }
    if (j->n_corner + j->n_own >= UINT32_MAX)
        return sn_fail(err, SN_ELIMIT, "picture: %zu corners of muscle surfaces, need fewer than 2^32",
                       j->n_corner);
    j->corner = SN_NEW(sn_corner, j->n_corner);
    if (!j->corner) return no_memory(err);
#pragma omp parallel for schedule(dynamic, 1) num_threads(sn_run_threads(run))
    for (int32_t i = 0; i < j->n_block; i++)
        if (j->block[i].n_corner > 0)
            memcpy(j->corner + j->corner0[i], j->block[i].corner, j->block[i].n_corner * sizeof *j->corner);
    return SN_OK;
}

/* ---- shared vertices ---- */

/* Corners by the lower vertices of their edges, then as they come. */
static sn_status sort_corners(joining *j, sn_error *err)
{
    size_t n_vert = (size_t)j->scene->tets->n_vert, sum = 0;
    j->at = SN_NEW_ZERO(uint32_t, n_vert + 1);
    j->order = SN_NEW(uint32_t, j->n_corner);
    j->vertex = SN_NEW(uint32_t, j->n_corner);
    if (!j->at || !j->order || !j->vertex) return no_memory(err);
    for (size_t i = 0; i < j->n_corner; i++)
        if (j->corner[i].a >= 0) j->at[j->corner[i].a]++;
    for (size_t v = 0; v <= n_vert; v++) { /* where the next one of v goes */
        size_t n = j->at[v];
        j->at[v] = (uint32_t)sum;
        sum += n;
    }
    for (size_t i = 0; i < j->n_corner; i++)
        if (j->corner[i].a >= 0) j->order[j->at[j->corner[i].a]++] = (uint32_t)i;
    return SN_OK; /* at[v] is now the end of v's, the start of the next one's */
}

static bool same_corner(const sn_corner *p, const sn_corner *q)
{
    return p->b == q->b && p->muscle == q->muscle && memcmp(p->normal, q->normal, sizeof p->normal) == 0;
}

/* Numbers the different corners at v by their first ones, from 0; these come first in v's part of `order`
 * afterwards. Returns how many there are. */
static uint32_t number_corners(joining *j, int32_t v)
{
    uint32_t first = v > 0 ? j->at[v - 1] : 0, n = 0;
    for (uint32_t i = first; i < j->at[v]; i++) {
        uint32_t id = j->order[i], k = 0;
        const sn_corner *c = &j->corner[id];
        while (k < n && !same_corner(&j->corner[j->order[first + k]], c)) k++;
        j->vertex[id] = k;
        if (k == n) j->order[first + n++] = id;
    }
    return n;
}

static sn_status number_vertices(joining *j, uint32_t **first, const sn_run *run, sn_error *err)
{
    int32_t n_vert = j->scene->tets->n_vert;
    uint32_t *n = *first = SN_NEW_ZERO(uint32_t, (size_t)n_vert + 1);
    if (!n) return no_memory(err);
#pragma omp parallel for schedule(dynamic, 2048) num_threads(sn_run_threads(run))
    for (int32_t v = 0; v < n_vert; v++) n[v + 1] = number_corners(j, v);
    for (int32_t v = 0; v < n_vert; v++) n[v + 1] += n[v];
    j->n_shared = n[n_vert];
    return SN_OK;
}

/* ---- putting together ---- */

static sn_status reserve(sn_muscle_surface *out, const joining *j, sn_error *err)
{
    out->n_vert = j->n_shared + j->n_own;
    out->n_index = j->n_index;
    out->vert = SN_NEW(sn_surface_vertex, out->n_vert);
    out->tendon = SN_NEW(float, out->n_vert);
    out->index = SN_NEW(uint32_t, out->n_index);
    return out->vert && out->tendon && out->index ? SN_OK : no_memory(err);
}

static void fill_shared(sn_muscle_surface *out, const joining *j, const uint32_t *first, const sn_run *run)
{
#pragma omp parallel for schedule(dynamic, 2048) num_threads(sn_run_threads(run))
    for (int32_t v = 0; v < j->scene->tets->n_vert; v++)
        for (uint32_t k = first[v]; k < first[v + 1]; k++) {
            const sn_corner *c = &j->corner[j->order[(v > 0 ? j->at[v - 1] : 0) + k - first[v]]];
            out->vert[k] = sn_corner_vertex(c, j->scene, j->tets, j->origin, &out->tendon[k]);
        }
}

static void fill_block_index(sn_muscle_surface *out, const joining *j, const uint32_t *first, int32_t i_block)
{
    const sn_polygons *p = &j->block[i_block];
    size_t own0 = j->n_shared + j->own0[i_block], c = 0, n = j->index0[i_block];
    for (size_t k = 0; k < p->n_own; k++) {
        out->vert[own0 + k] = p->own[k];
        out->tendon[own0 + k] = p->own_tendon[k];
    }
    uint32_t *vertex = j->vertex + j->corner0[i_block];
    for (size_t k = 0; k < p->n_corner; k++)
        vertex[k] = p->corner[k].a < 0 ? (uint32_t)(own0 + (size_t)p->corner[k].b)
                                       : first[p->corner[k].a] + vertex[k];
    for (size_t i = 0; i < p->n_polygon; c += (size_t)p->size[i++])
        for (int32_t k = 2; k < p->size[i]; k++) {
            out->index[n++] = vertex[c];
            out->index[n++] = vertex[c + (size_t)k - 1];
            out->index[n++] = vertex[c + (size_t)k];
        }
}

static void joining_free(joining *j)
{
    for (int32_t i = 0; j->block && i < j->n_block; i++) sn_polygons_free(&j->block[i]);
    sn_release(j->block);
    sn_release(j->corner0);
    sn_release(j->own0);
    sn_release(j->index0);
    sn_release(j->corner);
    sn_release(j->vertex);
    sn_release(j->at);
    sn_release(j->order);
}

sn_status sn_muscle_surface_make(sn_muscle_surface *out, const sn_picture_scene *s, const sn_muscle_tets *m,
                                 const sn_muscle_border *b, sn_vec3 origin, const sn_run *run, sn_error *err)
{
    joining j = {.scene = s, .tets = m, .border = b, .origin = origin};
    uint32_t *first = NULL;
    sn_status st = make_polygons(&j, run, err);
    if (!st) st = gather_corners(&j, run, err);
    if (!st) st = sort_corners(&j, err);
    if (!st) st = number_vertices(&j, &first, run, err);
    if (!st) st = reserve(out, &j, err);
    if (!st) {
        fill_shared(out, &j, first, run);
#pragma omp parallel for schedule(dynamic, 1) num_threads(sn_run_threads(run))
        for (int32_t i = 0; i < j.n_block; i++) fill_block_index(out, &j, first, i);
        if (!s->tendon) {
            sn_release(out->tendon);
            out->tendon = NULL;
        }
    }
    sn_release(first);
    joining_free(&j);
    if (st) sn_muscle_surface_free(out);
    return st;
}

void sn_muscle_surface_free(sn_muscle_surface *s)
{
    sn_release(s->vert);
    sn_release(s->tendon);
    sn_release(s->index);
    memset(s, 0, sizeof *s);
}
