/* repair_parts.c - the closed components: which way out they are, and which one lies inside which. */
#include "mesh/repair_private.h"

#include "base/alloc.h"
#include "mesh/bvh.h"

#include <string.h>

typedef struct part {
    sn_tri_mesh mesh; /* borrows its stretch of the sorted faces, and the vertices of the whole */
    sn_box3 box;
    double volume;
    int32_t outermost; /* the largest part around it, itself when there is none */
    int32_t winding;   /* just outside of it, made by the parts around it, signs as given */
    bool crosses;      /* another part: what lies inside what cannot be said */
    bool stays;
} part;

typedef struct parts {
    sn_tri_mesh *m;
    part *p;
    int32_t n;
    int32_t *of;   /* n_face: the part of a face */
    int32_t *face; /* sorted by part             */
    bool *keep;    /* n_face */
} parts;

static void parts_free(parts *s)
{
    sn_release(s->p);
    sn_release(s->of);
    sn_release(s->face);
    sn_release(s->keep);
}

static void sort_faces(parts *s)
{
    const sn_tri_mesh *m = s->m;
    for (int32_t f = 0; f < m->n_face; f++) s->p[s->of[f]].mesh.n_face++;
    int32_t *at = s->face;
    for (int32_t i = 0; i < s->n; i++) {
        sn_tri_mesh *own = &s->p[i].mesh;
        *own = (sn_tri_mesh){.pos = m->pos, .face = at, .n_vert = m->n_vert, .n_face = own->n_face};
        at += 3 * (size_t)own->n_face;
        own->n_face = 0;
    }
    for (int32_t f = 0; f < m->n_face; f++) {
        sn_tri_mesh *own = &s->p[s->of[f]].mesh;
        memcpy(own->face + 3 * (size_t)own->n_face++, m->face + 3 * (size_t)f, 3 * sizeof *m->face);
    }
}

static sn_status parts_create(parts *s, sn_tri_mesh *m, sn_error *err)
{
    *s = (parts){.m = m,
                 .of = SN_NEW(int32_t, m->n_face),
                 .face = SN_NEW(int32_t, 3 * (size_t)m->n_face),
                 .keep = SN_NEW(bool, m->n_face)};
    sn_status st = s->of && s->face && s->keep ? sn_mesh_components(m, s->of, &s->n, err)
                                               : sn_fail(err, SN_ENOMEM, "repair: no memory");
    if (st) return st;
    s->p = SN_NEW_ZERO(part, s->n);
    if (!s->p) return sn_fail(err, SN_ENOMEM, "repair: no memory for %d components", s->n);
    sort_faces(s);
    for (int32_t i = 0; i < s->n; i++) {
        part *p = &s->p[i];
        p->box = sn_box3_empty();
        for (size_t k = 0; k < 3 * (size_t)p->mesh.n_face; k++)
            p->box = sn_box3_add(p->box, sn_tri_mesh_point(m, p->mesh.face[k]));
        p->volume = sn_tri_mesh_volume(&p->mesh);
        p->outermost = i;
    }
    return SN_OK;
}

static sn_status find_crossings(parts *s, const sn_run *run, sn_error *err)
{
    int32_t *pair;
    size_t n;
    sn_status st = sn_mesh_self_intersections(s->m, run, &pair, &n, err);
    if (st) return st;
    for (size_t i = 0; i < n; i++) {
        int32_t a = s->of[pair[2 * i]], b = s->of[pair[2 * i + 1]];
        if (a != b) s->p[a].crosses = s->p[b].crosses = true;
    }
    sn_release(pair);
    return SN_OK;
}

static bool may_hold(const part *outer, const part *inner)
{
    sn_vec3 a = outer->box.min, b = outer->box.max, c = inner->box.min, d = inner->box.max;
    return !inner->crosses && a.x < c.x && a.y < c.y && a.z < c.z && d.x < b.x && d.y < b.y && d.z < b.z;
}

/* Which parts lie inside part i: those that cross nothing and have one vertex there. */
static sn_status find_inside(parts *s, int32_t i, sn_error *err)
{
    sn_bvh *b = NULL;
    const part *outer = &s->p[i];
    for (int32_t k = 0; k < s->n; k++) {
        part *inner = &s->p[k];
        if (k == i || !may_hold(outer, inner)) continue;
        sn_status st = b ? SN_OK : sn_bvh_create(&b, &outer->mesh, err);
        if (st) return st;
        double w = sn_bvh_winding(b, sn_tri_mesh_point(s->m, inner->mesh.face[0]));
        if (fabs(w) <= 0.5) continue;
        inner->winding += w > 0.0 ? 1 : -1;
        if (fabs(outer->volume) > fabs(s->p[inner->outermost].volume)) inner->outermost = i;
    }
    sn_bvh_destroy(b);
    return SN_OK;
}

/* Signs as given are turned so that the outermost part is positive. A part is a border of the solid when just
 * one of its sides is solid. */
static bool is_border(const parts *s, const part *p)
{
    int sign = s->p[p->outermost].volume < 0.0 ? -1 : 1;
    int32_t outside = sign * p->winding, inside = outside + (sign * p->volume < 0.0 ? -1 : 1);
    return (outside > 0) != (inside > 0);
}

static int32_t largest_part(const parts *s)
{
    int32_t best = 0;
    for (int32_t i = 1; i < s->n; i++)
        if (fabs(s->p[i].volume) > fabs(s->p[best].volume)) best = i;
    return best;
}

static void judge(parts *s, bool only_largest, sn_part_counts *n)
{
    int32_t largest = largest_part(s);
    for (int32_t i = 0; i < s->n; i++) {
        part *p = &s->p[i];
        bool borders = is_border(s, p);
        p->stays = borders && (!only_largest || p->outermost == largest);
        n->inside += !borders;
        n->others += borders && !p->stays;
        n->turned += p->stays && s->p[p->outermost].volume < 0.0;
    }
    for (int32_t f = 0; f < s->m->n_face; f++) {
        const part *p = &s->p[s->of[f]];
        int32_t *v = s->m->face + 3 * (size_t)f, swap = v[1];
        s->keep[f] = p->stays;
        if (s->p[p->outermost].volume >= 0.0) continue;
        v[1] = v[2];
        v[2] = swap;
    }
}

sn_status sn_repair_parts(sn_tri_mesh *m, bool only_largest, const sn_run *run, sn_part_counts *n,
                          sn_error *err)
{
    parts s;
    *n = (sn_part_counts){0, 0, 0};
    sn_status st = parts_create(&s, m, err);
    if (!st) st = find_crossings(&s, run, err);
    for (int32_t i = 0; i < s.n && !st; i++) {
        st = sn_run_step(run, "sorting components", (double)i / s.n, err);
        if (!st) st = find_inside(&s, i, err);
    }
    if (!st) {
        judge(&s, only_largest, n);
        st = sn_repair_keep_faces(m, s.keep, NULL, err);
    }
    parts_free(&s);
    return st;
}
