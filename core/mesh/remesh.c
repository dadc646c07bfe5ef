#include "mesh/remesh.h"

#include "base/alloc.h"
#include "mesh/mesh_check.h"
#include "mesh/predicates.h"
#include "mesh/remesh_private.h"

#include <string.h>

#define MAX_LABEL 0xffffff      /* tables by label stay small                                           */
#define MAX_RING 48             /* vertices of a higher valence are left alone                          */
#define SPLIT_ABOVE (4.0 / 3.0) /* of the target length: Botsch and Kobbelt's bounds                    */
#define COLLAPSE_BELOW (4.0 / 5.0)
#define TINY_EDGE 0.05      /* of the target length: such an edge goes even if others get long      */
#define SLIVER 0.15         /* height over base of a cap that a split of its base may cure          */
#define CREASE_COS 0.6      /* an edge bent by more than 53 degrees is kept as a crease             */
#define CREASE_HEIGHT 0.02  /* of the target length: lower triangles do not tell where creases are      */
#define KEEP_NORMAL_COS 0.6 /* no step turns a sound triangle by more than this                     */
#define VOLUME_PASSES 2
#define DEFAULT_ITERATIONS 6
#define DEFAULT_DEVIATION 0.08

typedef struct triangle {
    sn_vec3 p[3];
    int32_t id[3];
    int32_t label;
} triangle;

typedef struct patch { /* triangles to be replaced, and what would replace them */
    int32_t old[MAX_RING + 2];
    triangle tri[MAX_RING];
    int n_old, n_new;
} patch;

typedef struct remesher {
    rm_mesh mesh;
    rm_grid grid;
    sn_bvh *input;
    const sn_remesh *opt;
    const sn_run *run;
    double deviation;
    sn_remesh_report report;
} remesher;

static double target_of(const remesher *r, int32_t label, sn_vec3 p)
{
    const sn_remesh *o = r->opt;
    double own =
        o->label_length && label >= 0 && label < o->n_label ? o->label_length[label] : o->edge_length;
    return o->sizing ? fmin(fmax(sn_sizing_at(o->sizing, p), own), o->coarsest * own) : own;
}

static double least_target(const sn_remesh *o)
{
    double least = o->edge_length;
    for (int32_t i = 0; o->label_length && i < o->n_label; i++) least = fmin(least, o->label_length[i]);
    return least;
}

static double edge_target(const remesher *r, int32_t h)
{
    const rm_mesh *m = &r->mesh;
    sn_vec3 p = sn_v3_lerp(m->pos[m->vert[h]], m->pos[m->vert[rm_next(h)]], 0.5);
    return fmin(target_of(r, m->label[h / 3], p), target_of(r, m->label[m->twin[h] / 3], p));
}

static double edge_len(const rm_mesh *m, int32_t h)
{
    return sn_v3_dist(m->pos[m->vert[h]], m->pos[m->vert[rm_next(h)]]);
}

static triangle triangle_at(const rm_mesh *m, int32_t t)
{
    triangle tri = {.label = m->label[t]};
    for (int k = 0; k < 3; k++) {
        tri.id[k] = m->vert[3 * (size_t)t + (size_t)k];
        tri.p[k] = m->pos[tri.id[k]];
    }
    return tri;
}

static sn_vec3 normal(const triangle *t)
{
    return sn_v3_cross(sn_v3_sub(t->p[1], t->p[0]), sn_v3_sub(t->p[2], t->p[0]));
}

static sn_vec3 centre(const triangle *t)
{
    return sn_v3_scale(1.0 / 3.0, sn_v3_add(sn_v3_add(t->p[0], t->p[1]), t->p[2]));
}

static double longest2(const triangle *t)
{
    return fmax(sn_v3_len2(sn_v3_sub(t->p[1], t->p[0])),
                fmax(sn_v3_len2(sn_v3_sub(t->p[2], t->p[1])), sn_v3_len2(sn_v3_sub(t->p[0], t->p[2]))));
}

/* Height over longest edge, 0 for a degenerate triangle, 0.87 for a regular one. */
static double shape(const triangle *t)
{
    double l2 = longest2(t);
    return l2 > 0.0 ? sn_v3_len(normal(t)) / l2 : 0.0;
}

/* ---- guards ---- */

static bool crosses_anything(const remesher *r, const patch *p)
{
    for (int i = 0; i < p->n_new; i++) {
        const triangle *a = &p->tri[i];
        if (sn_triangle_is_degenerate(a->p[0], a->p[1], a->p[2])) return true;
        if (rm_grid_crosses(&r->grid, &r->mesh, a->p, a->id, p->old, p->n_old)) return true;
        for (int j = 0; j < i; j++) {
            const triangle *b = &p->tri[j];
            int x[3] = {a->id[0], a->id[1], a->id[2]}, y[3] = {b->id[0], b->id[1], b->id[2]};
            if (sn_triangles_cross(a->p, x, b->p, y)) return true;
        }
    }
    return false;
}

static double distance_to_input(const remesher *r, sn_vec3 p, int32_t label)
{
    sn_closest c =
        sn_bvh_mesh(r->input)->label ? sn_bvh_closest_label(r->input, p, label) : sn_bvh_closest(r->input, p);
    return c.dist;
}

/* The new triangles' centres lie near the input. Their corners do: each was put on it. */
static bool leaves_input(const remesher *r, const patch *p)
{
    for (int i = 0; i < p->n_new; i++) {
        const triangle *t = &p->tri[i];
        sn_vec3 c = centre(t);
        double limit = r->deviation * target_of(r, t->label, c);
        if (distance_to_input(r, c, t->label) > limit) return true;
    }
    return false;
}

/* ---- splits ---- */

/* The first pass of splits comes before the grid: faces that are huge against its cells would fill it. */
static bool register_tri(remesher *r, int32_t t)
{
    return !r->grid.head || rm_grid_add(&r->grid, &r->mesh, t);
}

static void unregister_tri(remesher *r, int32_t t)
{
    if (r->grid.head) rm_grid_remove(&r->grid, &r->mesh, t);
}

/* A split leaves the surface where it is up to a rounding of p: it needs no guard. */
static sn_status split_at(remesher *r, int32_t h, sn_vec3 p, sn_error *err)
{
    rm_mesh *m = &r->mesh;
    int32_t t = h / 3, u = m->twin[h] / 3;
    if (!rm_mesh_room(m)) return sn_fail(err, SN_ENOMEM, "remesh: no memory");
    unregister_tri(r, t);
    unregister_tri(r, u);
    rm_split(m, h, p);
    int32_t n = (int32_t)m->n_tri;
    if (!register_tri(r, t) || !register_tri(r, u) || !register_tri(r, n - 1) || !register_tri(r, n - 2))
        return sn_fail(err, SN_ENOMEM, "remesh: no memory");
    r->report.splits++;
    return SN_OK;
}

/* Where a cap's base should be split so that its top can fall onto it; false when h is not a base of a cap.
 */
static bool cap_foot(const remesher *r, int32_t h, sn_vec3 *foot)
{
    const rm_mesh *m = &r->mesh;
    sn_vec3 a = m->pos[m->vert[h]], b = m->pos[m->vert[rm_next(h)]], c = m->pos[m->vert[rm_prev(h)]];
    sn_vec3 d = sn_v3_sub(b, a);
    double len2 = sn_v3_len2(d), t = len2 > 0.0 ? sn_v3_dot(sn_v3_sub(c, a), d) / len2 : 0.0;
    if (t < 0.1 || t > 0.9) return false;
    *foot = sn_v3_mad(a, t, d);
    return sn_v3_dist(*foot, c) < SLIVER * sqrt(len2);
}

static bool is_border(const rm_mesh *m, int32_t h)
{
    return m->label[h / 3] != m->label[m->twin[h] / 3];
}

/* The longest side of a triangle; ties go to the edge with the lowest half-edge, so that neighbours agree. */
static int32_t longest_side(const rm_mesh *m, int32_t t)
{
    int32_t best = -1, best_id = 0;
    double best_len = -1.0;
    for (int32_t h = 3 * t; h < 3 * t + 3; h++) {
        int32_t id = h < m->twin[h] ? h : m->twin[h];
        double len = edge_len(m, h);
        if (len > best_len || (len == best_len && id < best_id)) {
            best = h;
            best_len = len;
            best_id = id;
        }
    }
    return best;
}

/* From h across ever longer sides to an edge that is the longest of both its triangles (Rivara 1984): halving
 * that one first keeps the triangles from thinning out, which halving in any order does not. */
static int32_t edge_to_halve(const rm_mesh *m, int32_t h)
{
    for (;;) {
        int32_t e = longest_side(m, h / 3), f = longest_side(m, m->twin[e] / 3);
        if (f == m->twin[e]) return e;
        h = f;
    }
}

/* Long edges in halves; on label borders, where no flip is allowed, caps at their foot. */
static sn_status split_pass(remesher *r, sn_error *err)
{
    rm_mesh *m = &r->mesh;
    sn_status st = SN_OK;
    int32_t n_before = (int32_t)(3 * m->n_tri);
    for (int32_t h = 0; h < (int32_t)(3 * m->n_tri); h++) { /* also the half-edges made on the way */
        if (!rm_alive(m, h / 3)) continue;
        sn_vec3 foot;
        while (!st && edge_len(m, h) > SPLIT_ABOVE * edge_target(r, h)) {
            int32_t e = edge_to_halve(m, h);
            st = split_at(r, e, sn_v3_lerp(m->pos[m->vert[e]], m->pos[m->vert[rm_next(e)]], 0.5), err);
        }
        double length = edge_len(m, h);
        if (!st && h < n_before && is_border(m, h) && length > TINY_EDGE * edge_target(r, h) &&
            cap_foot(r, h, &foot))
            st = split_at(r, h, foot, err);
        if (st) return st;
        if (h % 65536 == 0 && (st = sn_run_step(r->run, "remeshing", -1.0, err))) return st;
    }
    return SN_OK;
}

/* ---- collapses ---- */

/* What is left of the ring of h's first vertex after it moves to the second. false: valence too high. */
static bool collapse_patch(const rm_mesh *m, int32_t h, patch *out)
{
    int32_t gone = m->vert[h], to = m->vert[rm_next(h)], i = h;
    out->n_old = out->n_new = 0;
    do {
        int32_t t = i / 3;
        if (out->n_old == MAX_RING) return false;
        out->old[out->n_old++] = t;
        if (t != h / 3 && t != m->twin[h] / 3) {
            triangle *n = &out->tri[out->n_new++];
            *n = triangle_at(m, t);
            for (int k = 0; k < 3; k++)
                if (n->id[k] == gone) {
                    n->id[k] = to;
                    n->p[k] = m->pos[to];
                }
        }
        i = rm_spin(m, i);
    } while (i != h);
    return out->n_new > 0;
}

/* No sound triangle turns over or becomes a sliver, no edge gets long. */
static bool collapse_keeps_shape(const remesher *r, int32_t h, const patch *p, bool tiny)
{
    const rm_mesh *m = &r->mesh;
    int n = 0;
    for (int i = 0; i < p->n_old; i++) {
        if (p->old[i] == h / 3 || p->old[i] == m->twin[h] / 3) continue;
        triangle was = triangle_at(m, p->old[i]);
        const triangle *now = &p->tri[n++];
        double limit = SPLIT_ABOVE * target_of(r, now->label, centre(now)), old_shape = shape(&was),
               new_shape = shape(now);
        if (!tiny && longest2(now) > limit * limit) return false;
        if (old_shape > 0.05) {
            sn_vec3 a = normal(&was), b = normal(now);
            if (sn_v3_dot(a, b) < KEEP_NORMAL_COS * sn_v3_len(a) * sn_v3_len(b)) return false;
        }
        if (new_shape < 0.1 && new_shape < old_shape) return false;
    }
    return true;
}

/* A crease's vertex may only slide along it, a corner not at all. Checks that the crease stays where it is,
 * too. */
static bool collapse_keeps_creases(const remesher *r, int32_t h)
{
    const rm_mesh *m = &r->mesh;
    int32_t a = m->vert[h];
    int n = rm_crease_count(m, a);
    if (n == 0) return true;
    if (n != 2 || !m->crease[h]) return false;
    int32_t i = rm_spin(m, h);
    while (!m->crease[i]) i = rm_spin(m, i);
    sn_vec3 p = m->pos[a], q = m->pos[m->vert[rm_next(i)]], b = m->pos[m->vert[rm_next(h)]];
    sn_vec3 d = sn_v3_sub(b, q);
    double len2 = sn_v3_len2(d), t = len2 > 0.0 ? sn_v3_dot(sn_v3_sub(p, q), d) / len2 : 0.0;
    t = fmin(1.0, fmax(0.0, t));
    return sn_v3_dist(p, sn_v3_mad(q, t, d)) <= r->deviation * edge_target(r, h);
}

static sn_status try_collapse(remesher *r, int32_t h, bool *done, sn_error *err)
{
    rm_mesh *m = &r->mesh;
    patch p;
    *done = false;
    bool tiny = edge_len(m, h) < TINY_EDGE * edge_target(r, h);
    if (!collapse_keeps_creases(r, h) || !rm_can_collapse(m, h) || !collapse_patch(m, h, &p) ||
        !collapse_keeps_shape(r, h, &p, tiny) || leaves_input(r, &p))
        return SN_OK;
    if (crosses_anything(r, &p)) {
        r->report.refused++;
        return SN_OK;
    }
    int32_t dead[2] = {h / 3, m->twin[h] / 3};
    for (int i = 0; i < p.n_old; i++) rm_grid_remove(&r->grid, m, p.old[i]);
    rm_collapse(m, h);
    for (int i = 0; i < p.n_old; i++)
        if (p.old[i] != dead[0] && p.old[i] != dead[1] && !register_tri(r, p.old[i]))
            return sn_fail(err, SN_ENOMEM, "remesh: no memory");
    r->report.collapses++;
    *done = true;
    return SN_OK;
}

static sn_status collapse_pass(remesher *r, sn_error *err)
{
    rm_mesh *m = &r->mesh;
    sn_status st = SN_OK;
    for (int32_t h = 0; h < (int32_t)(3 * m->n_tri); h++) {
        if (h % 65536 == 0 && (st = sn_run_step(r->run, "remeshing", -1.0, err))) return st;
        if (!rm_alive(m, h / 3) || edge_len(m, h) >= COLLAPSE_BELOW * edge_target(r, h)) continue;
        bool done;
        st = try_collapse(r, h, &done, err);
        if (!st && !done) st = try_collapse(r, m->twin[h], &done, err);
        if (st) return st;
    }
    return SN_OK;
}

/* ---- flips ---- */

static void flip_patch(const rm_mesh *m, int32_t h, patch *out)
{
    int32_t g = m->twin[h];
    int32_t a = m->vert[h], b = m->vert[g], c = m->vert[rm_prev(h)], d = m->vert[rm_prev(g)];
    int32_t label = m->label[h / 3];
    *out = (patch){.old = {h / 3, g / 3}, .n_old = 2, .n_new = 2};
    out->tri[0] = (triangle){{m->pos[c], m->pos[d], m->pos[b]}, {c, d, b}, label};
    out->tri[1] = (triangle){{m->pos[d], m->pos[c], m->pos[a]}, {d, c, a}, label};
}

/* A flip is worth it when the worse of the two triangles gets better and neither turns away. */
static bool flip_helps(const remesher *r, int32_t h, const patch *p)
{
    triangle s = triangle_at(&r->mesh, h / 3), t = triangle_at(&r->mesh, r->mesh.twin[h] / 3);
    double before = fmin(shape(&s), shape(&t)), after = fmin(shape(&p->tri[0]), shape(&p->tri[1]));
    if (after <= 1.05 * before) return false;
    sn_vec3 n = sn_v3_add(normal(&s), normal(&t));
    for (int i = 0; i < 2; i++) {
        sn_vec3 q = normal(&p->tri[i]);
        if (sn_v3_dot(n, q) < 0.8 * sn_v3_len(n) * sn_v3_len(q)) return false;
    }
    return true;
}

static sn_status flip_pass(remesher *r, sn_error *err)
{
    rm_mesh *m = &r->mesh;
    for (int32_t h = 0; h < (int32_t)(3 * m->n_tri); h++) {
        if (!rm_alive(m, h / 3) || m->twin[h] < h || !rm_can_flip(m, h)) continue;
        patch p;
        flip_patch(m, h, &p);
        if (!flip_helps(r, h, &p) || leaves_input(r, &p)) continue;
        if (crosses_anything(r, &p)) {
            r->report.refused++;
            continue;
        }
        rm_grid_remove(&r->grid, m, p.old[0]);
        rm_grid_remove(&r->grid, m, p.old[1]);
        rm_flip(m, h);
        if (!register_tri(r, p.old[0]) || !register_tri(r, p.old[1]))
            return sn_fail(err, SN_ENOMEM, "remesh: no memory");
        r->report.flips++;
    }
    return sn_run_step(r->run, "remeshing", -1.0, err);
}

/* ---- smoothing ---- */

/* The area-weighted centre of the ring, drawn onto the input. */
static sn_vec3 smooth_target(const remesher *r, int32_t v)
{
    const rm_mesh *m = &r->mesh;
    sn_vec3 sum = {0, 0, 0}, n = {0, 0, 0}, p = m->pos[v];
    double weight = 0.0;
    int32_t h = m->out[v], i = h;
    do {
        triangle t = triangle_at(m, i / 3);
        sn_vec3 a = normal(&t);
        double w = sn_v3_len(a);
        sum = sn_v3_mad(sum, w, centre(&t));
        n = sn_v3_add(n, a);
        weight += w;
        i = rm_spin(m, i);
    } while (i != h);
    if (!(weight > 0.0)) return p;
    sn_vec3 to = sn_v3_sub(sn_v3_scale(1.0 / weight, sum), p);
    n = sn_v3_unit(n);
    to = sn_v3_mad(to, -sn_v3_dot(to, n), n);
    sn_vec3 q = sn_v3_add(p, to);
    sn_closest c = sn_bvh_mesh(r->input)->label ? sn_bvh_closest_label(r->input, q, m->label[h / 3])
                                                : sn_bvh_closest(r->input, q);
    return c.face >= 0 ? c.point : p;
}

static bool move_patch(const rm_mesh *m, int32_t v, sn_vec3 to, patch *out)
{
    int32_t h = m->out[v], i = h;
    out->n_old = out->n_new = 0;
    do {
        if (out->n_old == MAX_RING) return false;
        triangle *t = &out->tri[out->n_new++];
        out->old[out->n_old++] = i / 3;
        *t = triangle_at(m, i / 3);
        for (int k = 0; k < 3; k++)
            if (t->id[k] == v) t->p[k] = to;
        i = rm_spin(m, i);
    } while (i != h);
    return true;
}

static bool move_keeps_shape(const rm_mesh *m, const patch *p)
{
    double before = 1.0, after = 1.0;
    for (int i = 0; i < p->n_new; i++) {
        triangle was = triangle_at(m, p->old[i]);
        sn_vec3 a = normal(&was), b = normal(&p->tri[i]);
        if (shape(&was) > 0.05 && sn_v3_dot(a, b) < KEEP_NORMAL_COS * sn_v3_len(a) * sn_v3_len(b))
            return false;
        before = fmin(before, shape(&was));
        after = fmin(after, shape(&p->tri[i]));
    }
    return after > 0.2 || after >= before;
}

/* Moves v when the surface stays sound. */
static sn_status try_move(remesher *r, int32_t v, sn_vec3 to, sn_error *err)
{
    rm_mesh *m = &r->mesh;
    patch p;
    if (!move_patch(m, v, to, &p) || !move_keeps_shape(m, &p)) return SN_OK;
    if (crosses_anything(r, &p)) {
        r->report.refused++;
        return SN_OK;
    }
    for (int i = 0; i < p.n_old; i++) rm_grid_remove(&r->grid, m, p.old[i]);
    m->pos[v] = to;
    for (int i = 0; i < p.n_old; i++)
        if (!register_tri(r, p.old[i])) return sn_fail(err, SN_ENOMEM, "remesh: no memory");
    r->report.moves++;
    return SN_OK;
}

static sn_status smooth_pass(remesher *r, sn_error *err)
{
    rm_mesh *m = &r->mesh;
    int32_t n = (int32_t)m->n_vert;
    sn_vec3 *to = SN_NEW(sn_vec3, n);
    if (!to) return sn_fail(err, SN_ENOMEM, "remesh: no memory");
#pragma omp parallel for schedule(dynamic, 256) num_threads(sn_run_threads(r->run))
    for (int32_t v = 0; v < n; v++)
        if (m->out[v] >= 0) to[v] = rm_crease_count(m, v) ? m->pos[v] : smooth_target(r, v);
    sn_status st = SN_OK;
    for (int32_t v = 0; v < n && !st; v++)
        if (m->out[v] >= 0 && sn_v3_dist(to[v], m->pos[v]) >= 0.01 * edge_target(r, m->out[v]))
            st = try_move(r, v, to[v], err);
    sn_release(to);
    return st ? st : sn_run_step(r->run, "remeshing", -1.0, err);
}

/* ---- volume ---- */

/* What a polyhedron's facets lose at its ridges when vertices move off them adds up: thin bones would shrink
 * by some percent. Each label's patch is moved along its normals by the lost volume over its area. */
typedef struct patch_size {
    double volume, area; /* volume: of the cone from the origin below; only differences mean something */
} patch_size;

static void add_triangle(patch_size *s, const triangle *t, sn_vec3 origin)
{
    s->volume +=
        sn_v3_det(sn_v3_sub(t->p[0], origin), sn_v3_sub(t->p[1], origin), sn_v3_sub(t->p[2], origin)) / 6.0;
    s->area += 0.5 * sn_v3_len(normal(t));
}

static int32_t label_count(const rm_mesh *m)
{
    int32_t n = 0;
    for (size_t t = 0; t < m->n_tri; t++) n = m->label[t] >= n ? m->label[t] + 1 : n;
    return n;
}

/* Sizes of all labels' patches; labels are small numbers from 0. */
static patch_size *measure_patches(const rm_mesh *m, int32_t n_label, sn_vec3 origin)
{
    patch_size *s = SN_NEW_ZERO(patch_size, n_label);
    for (size_t t = 0; s && t < m->n_tri; t++) {
        if (!rm_alive(m, (int32_t)t)) continue;
        triangle tri = triangle_at(m, (int32_t)t);
        add_triangle(&s[m->label[t]], &tri, origin);
    }
    return s;
}

/* The area-weighted normal at v; false on label borders, which stay. */
static bool patch_normal(const rm_mesh *m, int32_t v, sn_vec3 *out)
{
    int32_t h = m->out[v], i = h;
    sn_vec3 n = {0, 0, 0};
    do {
        triangle t = triangle_at(m, i / 3);
        if (t.label != m->label[h / 3]) return false;
        n = sn_v3_add(n, normal(&t));
        i = rm_spin(m, i);
    } while (i != h);
    *out = sn_v3_unit(n);
    return true;
}

static sn_status restore_volume(remesher *r, const patch_size *want, int32_t n_label, sn_vec3 origin,
                                sn_error *err)
{
    rm_mesh *m = &r->mesh;
    sn_status st = SN_OK;
    for (int pass = 0; pass < VOLUME_PASSES && !st; pass++) {
        patch_size *now = measure_patches(m, n_label, origin);
        if (!now) return sn_fail(err, SN_ENOMEM, "remesh: no memory");
        for (int32_t v = 0; v < (int32_t)m->n_vert && !st; v++) {
            sn_vec3 n;
            if (m->out[v] < 0 || !patch_normal(m, v, &n)) continue;
            int32_t label = m->label[m->out[v] / 3];
            double most = r->deviation * target_of(r, label, m->pos[v]);
            double d =
                now[label].area > 0.0 ? (want[label].volume - now[label].volume) / now[label].area : 0.0;
            d = fmax(-most, fmin(most, d));
            if (fabs(d) > 1e-6 * most) st = try_move(r, v, sn_v3_mad(m->pos[v], d, n), err);
        }
        sn_release(now);
    }
    return st;
}

/* ---- the whole ---- */

static sn_status check_options(const sn_remesh *o, sn_error *err)
{
    if (!(o->edge_length > 0.0 && isfinite(o->edge_length)))
        return sn_fail(err, SN_EINVAL, "remesh: edge length is %g, need > 0", o->edge_length);
    for (int32_t i = 0; o->label_length && i < o->n_label; i++)
        if (!(o->label_length[i] > 0.0 && isfinite(o->label_length[i])))
            return sn_fail(err, SN_EINVAL, "remesh: edge length of label %d is %g, need > 0", i,
                           o->label_length[i]);
    if (o->sizing && !(o->coarsest >= 1.0))
        return sn_fail(err, SN_EINVAL, "remesh: coarsest is %g, need >= 1", o->coarsest);
    if (o->iterations < 0 || !(o->max_deviation >= 0.0))
        return sn_fail(err, SN_EINVAL, "remesh: iterations and max_deviation must not be negative");
    return SN_OK;
}

static sn_status check_input(const sn_tri_mesh *in, sn_error *err)
{
    sn_status st = sn_tri_mesh_validate(in, err);
    if (st) return sn_fail_prefix(err, st, "remesh: ");
    for (int32_t f = 0; in->label && f < in->n_face; f++)
        if (in->label[f] < 0 || in->label[f] > MAX_LABEL)
            return sn_fail(err, SN_EINVAL, "remesh: label of face %d is %d, need 0..%d", f + 1, in->label[f],
                           MAX_LABEL);
    return SN_OK;
}

static sn_status count_crossings(const sn_tri_mesh *m, const sn_run *run, int64_t *n, sn_error *err)
{
    int32_t *pairs = NULL;
    size_t count = 0;
    sn_status st = sn_mesh_self_intersections(m, run, &pairs, &count, err);
    sn_release(pairs);
    *n = (int64_t)count;
    return st;
}

static sn_status run_passes(remesher *r, sn_error *err)
{
    int n = r->opt->iterations ? r->opt->iterations : DEFAULT_ITERATIONS;
    sn_vec3 origin = r->mesh.pos[0];
    int32_t n_label = label_count(&r->mesh);
    patch_size *want = measure_patches(&r->mesh, n_label, origin);
    sn_status st = want ? SN_OK : sn_fail(err, SN_ENOMEM, "remesh: no memory");
    for (int i = 0; i < n && !st; i++) {
        st = sn_run_step(r->run, "remeshing", (double)i / n, err);
        if (!st) st = split_pass(r, err);
        if (!st && i == 0) st = rm_grid_build(&r->grid, &r->mesh, r->opt->edge_length, err);
        if (!st) st = collapse_pass(r, err);
        if (!st) st = flip_pass(r, err);
        if (!st) st = smooth_pass(r, err);
        if (!st && i == n - 1) st = flip_pass(r, err);
    }
    if (!st) st = restore_volume(r, want, n_label, origin, err);
    sn_release(want);
    return st;
}

static void measure_moves(remesher *r, const sn_tri_mesh *out)
{
    for (int32_t v = 0; v < out->n_vert; v++) {
        double d = sn_bvh_closest(r->input, sn_tri_mesh_point(out, v)).dist;
        if (d > r->report.largest_move) r->report.largest_move = d;
    }
}

sn_status sn_remesh_run(const sn_tri_mesh *in, const sn_remesh *opt, const sn_run *run, sn_tri_mesh *out,
                        sn_remesh_report *report, sn_error *err)
{
    remesher r = {.opt = opt, .run = run};
    r.deviation = opt->max_deviation > 0.0 ? opt->max_deviation : DEFAULT_DEVIATION;
    sn_tri_mesh_free(out);
    sn_status st = check_options(opt, err);
    if (!st) st = check_input(in, err);
    if (!st) st = count_crossings(in, run, &r.report.crossings_before, err);
    if (!st) st = sn_bvh_create(&r.input, in, err);
    if (!st) st = rm_mesh_build(&r.mesh, in, CREASE_COS, CREASE_HEIGHT * least_target(opt), err);
    if (!st) st = run_passes(&r, err);
    if (!st) st = rm_mesh_export(&r.mesh, in->label != NULL, out, err);
    if (!st) st = count_crossings(out, run, &r.report.crossings_after, err);
    if (!st) measure_moves(&r, out);
    if (!st && report) *report = r.report;
    if (st) sn_tri_mesh_free(out);
    rm_grid_free(&r.grid);
    rm_mesh_free(&r.mesh);
    sn_bvh_destroy(r.input);
    return st;
}
