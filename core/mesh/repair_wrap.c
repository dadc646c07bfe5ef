/* repair_wrap.c - a new surface around the old one, as near as asked for. */
#include "mesh/repair_private.h"

#include "base/alloc.h"
#include "mesh/bvh.h"

#include <string.h>

/* Of the tolerance. What the wrap bridges lies at most least + offset away, but for the few places where CGAL
 * makes it manifold by filling in: those get nearer with smaller sizes. */
#define ALPHA_REL 3.0
#define FAR_REL 0.6
#define LEAST_REL 0.5
#define OFFSET_REL 0.3
#define FAR_OFFSET 1.2 /* offsets: a wrap is never nearer than one of them */
#define NEXT_ALPHA 0.5
#define NEXT_REL 0.8 /* for the others */
#define WRAP_TRIES 3
#define LAY_FROM 1.5 /* offsets: vertices nearer than that are laid back ... */
#define LAY_TO 0.1   /* ... to this distance, so that both sides of a sheet do not meet                     */
#define LAY_PASSES 12
#define LEAST_COS 0.3 /* a face may turn by that when its corners are laid back */
#define SHELL 2.0     /* volume over offset times area below which the wrap has two sides everywhere        */

/* ---- laying back ---- */

typedef struct layer {
    sn_tri_mesh *m;
    double *from, *to; /* n_vert x 3 */
    double *part;      /* n_vert, how far a vertex goes: 1, 1/2 or 0 */
    double offset;
} layer;

static void find_targets(layer *l, const sn_bvh *b, const sn_run *run)
{
#pragma omp parallel for num_threads(sn_run_threads(run)) schedule(dynamic, 256)
    for (int32_t i = 0; i < l->m->n_vert; i++) {
        sn_vec3 p = sn_tri_mesh_point(l->m, i);
        sn_closest c = sn_bvh_closest(b, p);
        bool goes = c.dist > LAY_TO * l->offset && c.dist < LAY_FROM * l->offset;
        l->part[i] = goes ? 1.0 : 0.0;
        sn_v3_store(l->from + 3 * (size_t)i, p);
        sn_v3_store(l->to + 3 * (size_t)i, goes ? sn_v3_lerp(c.point, p, LAY_TO * l->offset / c.dist) : p);
    }
}

static void move_vertices(layer *l)
{
    for (int32_t i = 0; i < l->m->n_vert; i++) {
        size_t k = 3 * (size_t)i;
        sn_v3_store(l->m->pos + k, sn_v3_lerp(sn_v3_load(l->from + k), sn_v3_load(l->to + k), l->part[i]));
    }
}

/* Holds the corners of a face back; false when they have not moved. */
static bool hold_back(layer *l, int32_t f)
{
    bool changes = false;
    for (int k = 0; k < 3; k++) {
        double *part = &l->part[l->m->face[3 * (size_t)f + (size_t)k]];
        if (*part == 0.0) continue;
        *part = *part > 0.5 ? 0.5 : 0.0;
        changes = true;
    }
    return changes;
}

static bool is_turned(const layer *l, int32_t f)
{
    sn_tri_mesh before = *l->m;
    before.pos = l->from;
    sn_vec3 a = sn_tri_mesh_face_normal(&before, f), b = sn_tri_mesh_face_normal(l->m, f);
    return !(sn_v3_dot(a, b) > LEAST_COS * sn_v3_len(a) * sn_v3_len(b));
}

/* Moves all, and holds back the faces that turn over or cross others until there are none. */
static sn_status lay(layer *l, const sn_run *run, sn_error *err)
{
    for (int pass = 0; pass < LAY_PASSES; pass++) {
        bool changes = false;
        int32_t *pair;
        size_t n;
        move_vertices(l);
        for (int32_t f = 0; f < l->m->n_face; f++)
            if (is_turned(l, f)) changes = hold_back(l, f) || changes;
        if (changes) continue;
        sn_status st = sn_mesh_self_intersections(l->m, run, &pair, &n, err);
        if (st) return st;
        for (size_t i = 0; i < 2 * n; i++) changes = hold_back(l, pair[i]) || changes;
        sn_release(pair);
        if (!changes) return SN_OK;
    }
    for (int32_t i = 0; i < l->m->n_vert; i++) l->part[i] = 0.0;
    move_vertices(l);
    return SN_OK;
}

static sn_status lay_back(sn_tri_mesh *m, const sn_bvh *b, double offset, const sn_run *run, int32_t *n_laid,
                          sn_error *err)
{
    layer l = {.m = m,
               .from = SN_NEW(double, 3 * (size_t)m->n_vert),
               .to = SN_NEW(double, 3 * (size_t)m->n_vert),
               .part = SN_NEW(double, m->n_vert),
               .offset = offset};
    sn_status st = sn_run_step(run, "laying the wrap back", -1.0, err);
    if (!st && !(l.from && l.to && l.part))
        st = sn_fail(err, SN_ENOMEM, "wrapping: no memory for %d vertices", m->n_vert);
    if (!st) {
        find_targets(&l, b, run);
        st = lay(&l, run, err);
    }
    for (int32_t i = 0; i < m->n_vert && !st; i++) *n_laid += l.part[i] > 0.0;
    sn_release(l.from);
    sn_release(l.to);
    sn_release(l.part);
    return st;
}

/* ---- the wrap ---- */

static sn_wrap_sizes sizes_of_try(const sn_repair *opt, int i_try)
{
    double t = opt->tolerance * pow(NEXT_REL, i_try);
    double offset = opt->offset > 0.0 ? opt->offset : OFFSET_REL * t;
    if (opt->alpha > 0.0) return (sn_wrap_sizes){opt->alpha, t, opt->alpha, offset};
    double alpha = ALPHA_REL * opt->tolerance * pow(NEXT_ALPHA, i_try);
    return (sn_wrap_sizes){alpha, fmax(FAR_REL * t, FAR_OFFSET * offset), LEAST_REL * t, offset};
}

static sn_status check_wrap(const sn_tri_mesh *m, const sn_wrap_sizes *w, sn_error *err)
{
    if (m->n_face == 0) return sn_fail(err, SN_EMESH, "repair: the wrap is empty");
    if (sn_tri_mesh_volume(m) >= SHELL * w->offset * sn_tri_mesh_area(m)) return SN_OK;
    return sn_fail(
        err, SN_EMESH,
        "repair: the wrap went in through a hole and is a thin shell: fill_holes of the size of that "
        "hole closes it, an alpha (now %.4g) of at least half its width keeps the wrap out",
        w->least);
}

static sn_status wrap_once(const sn_tri_mesh *in, const sn_bvh *b, const sn_wrap_sizes *w,
                           const sn_repair *opt, const sn_run *run, sn_tri_mesh *out, sn_wrap_result *r,
                           sn_error *err)
{
    sn_repair_counts none;
    r->alpha = w->least;
    r->offset = w->offset;
    r->laid_back = 0;
    r->tries++;
    sn_status st =
        sn_repair_in_child(SN_TASK_WRAP, in, (sn_repair_sizes){.wrap = *w}, opt, run, out, &none, err);
    if (!st) {
        st = check_wrap(out, w, err);
        r->is_shell = st != SN_OK && out->n_face > 0;
    }
    if (!st) st = lay_back(out, b, w->offset, run, &r->laid_back, err);
    return st ? st : sn_repair_moved(out, in, run, &r->moved, err);
}

/* With the alpha given, or with smaller sizes until the tolerance holds. */
static sn_status wrap_within(const sn_tri_mesh *in, const sn_bvh *b, const sn_repair *opt, const sn_run *run,
                             sn_tri_mesh *out, sn_wrap_result *r, sn_error *err)
{
    do {
        sn_wrap_sizes w = sizes_of_try(opt, r->tries);
        sn_status st = wrap_once(in, b, &w, opt, run, out, r, err);
        if (st || r->moved <= opt->tolerance) return st;
    } while (!(opt->alpha > 0.0) && r->tries < WRAP_TRIES);
    return sn_fail(
        err, SN_EMESH,
        "repair: the wrap is up to %.4g away from the surface, the tolerance is %.4g: a smaller alpha "
        "(now %.4g) and offset (now %.4g) bring it nearer, or a larger tolerance lets it be",
        r->moved, opt->tolerance, r->alpha, r->offset);
}

sn_status sn_repair_wrap(const sn_tri_mesh *in, const sn_repair *opt, const sn_run *run, sn_tri_mesh *out,
                         sn_wrap_result *r, sn_error *err)
{
    sn_bvh *b = NULL;
    *r = (sn_wrap_result){0};
    sn_status st = sn_bvh_create(&b, in, err);
    if (!st) st = wrap_within(in, b, opt, run, out, r, err);
    sn_bvh_destroy(b);
    if (st) sn_tri_mesh_free(out);
    return st;
}
