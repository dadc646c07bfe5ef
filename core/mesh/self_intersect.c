/* self_intersect.c - all pairs of faces of one surface that cross: a tree finds candidates, exact signs
 * decide. */
#include "base/alloc.h"
#include "base/array.h"
#include "mesh/bvh.h"
#include "mesh/mesh_check.h"
#include "mesh/predicates.h"
#include "mesh/mesh_check_private.h"

#include <string.h>

enum { CHUNK = 256 }; /* faces one thread takes at a time */

typedef struct pair {
    int32_t f, g;
} pair;

typedef struct finder { /* one per thread */
    const sn_tri_mesh *m;
    sn_self_crossings *out;
    size_t cap;
    bool store;
    bool short_of_memory;
    int32_t face;
    sn_vec3 p[3];
} finder;

static void corners(const sn_tri_mesh *m, int32_t f, sn_vec3 p[3])
{
    for (int k = 0; k < 3; k++) p[k] = sn_tri_mesh_point(m, m->face[3 * (size_t)f + (size_t)k]);
}

static int compare_pairs(const void *a, const void *b)
{
    const pair *p = a, *q = b;
    if (p->f != q->f) return p->f < q->f ? -1 : 1;
    return (p->g > q->g) - (p->g < q->g);
}

static bool add_pair(finder *w, pair found)
{
    sn_self_crossings *out = w->out;
    if (w->store) {
        if (!sn_grow(&out->pairs, &w->cap, 2 * (out->n + 1), sizeof *out->pairs)) return false;
        memcpy(out->pairs + 2 * out->n, &found, sizeof found);
    }
    const pair first = {out->first[0], out->first[1]};
    if (out->n == 0 || compare_pairs(&found, &first) < 0) memcpy(out->first, &found, sizeof found);
    out->n++;
    return true;
}

static bool test_candidate(void *user, int32_t g)
{
    finder *w = user;
    if (g <= w->face) return true; /* each pair once */
    sn_vec3 q[3];
    corners(w->m, g, q);
    const int32_t *face = w->m->face;
    if (!sn_triangles_cross(w->p, face + 3 * (size_t)w->face, q, face + 3 * (size_t)g)) return true;
    if (add_pair(w, (pair){w->face, g})) return true;
    w->short_of_memory = true;
    return false;
}

static void test_faces(finder *w, const sn_bvh *b, int32_t begin, int32_t end)
{
    for (int32_t f = begin; f < end && !w->short_of_memory; f++) {
        w->face = f;
        corners(w->m, f, w->p);
        sn_box3 box = sn_box3_empty();
        for (int k = 0; k < 3; k++) box = sn_box3_add(box, w->p[k]);
        sn_bvh_overlap(b, box, test_candidate, w);
    }
}

/* Appends the pairs of one thread; the order is put right at the end. */
static bool take(sn_self_crossings *all, size_t *cap, const finder *w)
{
    const sn_self_crossings *part = w->out;
    if (part->n == 0) return !w->short_of_memory;
    const pair a = {all->first[0], all->first[1]}, b = {part->first[0], part->first[1]};
    if (all->n == 0 || compare_pairs(&b, &a) < 0) memcpy(all->first, &b, sizeof b);
    if (w->store) {
        if (!sn_grow(&all->pairs, cap, 2 * (all->n + part->n), sizeof *all->pairs)) return false;
        memcpy(all->pairs + 2 * all->n, part->pairs, 2 * part->n * sizeof *all->pairs);
    }
    all->n += part->n;
    return !w->short_of_memory;
}

/* false when memory is short */
static bool find_all(const sn_bvh *b, bool store, const sn_run *run, sn_self_crossings *out)
{
    const sn_tri_mesh *m = sn_bvh_mesh(b);
    int32_t n_chunk = (m->n_face - 1) / CHUNK + 1;
    size_t cap = 0;
    bool ok = true;
#pragma omp parallel num_threads(sn_run_threads(run))
    {
        sn_self_crossings own = {NULL, 0, {-1, -1}};
        finder w = {.m = m, .out = &own, .store = store};
#pragma omp for schedule(dynamic)
        for (int32_t c = 0; c < n_chunk; c++) {
            int32_t begin = c * CHUNK, end = c == n_chunk - 1 ? m->n_face : begin + CHUNK;
            if (!sn_run_stopped(run)) test_faces(&w, b, begin, end);
        }
#pragma omp critical(sn_self_crossings_take)
        if (!take(out, &cap, &w)) ok = false;
        sn_release(own.pairs);
    }
    if (ok && store && out->n > 0) sn_sort(out->pairs, out->n, sizeof(pair), compare_pairs);
    return ok;
}

sn_status sn_self_crossings_find(sn_self_crossings *out, const sn_tri_mesh *m, bool store, const sn_run *run,
                                 sn_error *err)
{
    static const char step[] = "looking for self-intersections";
    *out = (sn_self_crossings){NULL, 0, {-1, -1}};
    sn_status st = sn_run_step(run, step, 0.0, err);
    if (st || m->n_face == 0) return st;
    sn_bvh *b;
    st = sn_bvh_create(&b, m, err);
    if (st) return st;
    if (!find_all(b, store, run, out))
        st = sn_fail(err, SN_ENOMEM, "self-intersections: no memory for the crossing pairs of %d faces",
                     m->n_face);
    else
        st = sn_run_step(run, step, 1.0, err);
    sn_bvh_destroy(b);
    if (st) {
        sn_release(out->pairs);
        *out = (sn_self_crossings){NULL, 0, {-1, -1}};
    }
    return st;
}

sn_status sn_mesh_self_intersections(const sn_tri_mesh *m, const sn_run *run, int32_t **pairs, size_t *n,
                                     sn_error *err)
{
    sn_self_crossings found;
    sn_status st = sn_self_crossings_find(&found, m, true, run, err);
    *pairs = found.pairs;
    *n = found.n;
    return st;
}
