/* place_crossing.c - which bones of a row cross each other. */
#include "base/alloc.h"
#include "mesh/bvh.h"
#include "mesh/predicates.h"
#include "skeleton/place_private.h"

typedef struct row {
    const sn_tri_mesh *bone;
    const sn_affine *map; /* n                                              */
    sn_box3 *box;         /* n                                              */
    int32_t *other;       /* n: the lowest later one that it crosses, or -1 */
    int32_t n;
} row;

/* ---- boxes ---- */

static sn_box3 placed_box(const sn_tri_mesh *bone, const sn_affine *map)
{
    sn_box3 box = sn_box3_empty();
    for (int32_t v = 0; v < bone->n_vert; v++)
        box = sn_box3_add(box, sn_affine_point(map, sn_tri_mesh_point(bone, v)));
    return box;
}

static bool boxes_meet(sn_box3 a, sn_box3 b)
{
    return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y &&
           a.min.z <= b.max.z && b.min.z <= a.max.z;
}

static int32_t next_near(const row *r, int32_t i, int32_t j)
{
    for (j++; j < r->n && !boxes_meet(r->box[i], r->box[j]);) j++;
    return j;
}

/* ---- one bone against another ---- */

typedef struct face_test {
    const sn_tri_mesh *m; /* of the other bone          */
    sn_vec3 p[3];
    int32_t id[3]; /* different from all of m's  */
    bool crosses;
} face_test;

static bool test_face(void *user, int32_t f)
{
    face_test *t = user;
    const int32_t *v = t->m->face + 3 * (size_t)f;
    sn_vec3 q[3];
    for (int k = 0; k < 3; k++) q[k] = sn_tri_mesh_point(t->m, v[k]);
    t->crosses = sn_triangles_cross(t->p, t->id, q, v);
    return !t->crosses;
}

static bool surfaces_cross(const sn_bvh *a, const sn_tri_mesh *b)
{
    face_test t = {.m = sn_bvh_mesh(a), .id = {-1, -2, -3}};
    for (int32_t f = 0; f < b->n_face && !t.crosses; f++) {
        sn_box3 box = sn_box3_empty();
        for (int k = 0; k < 3; k++) {
            t.p[k] = sn_tri_mesh_point(b, b->face[3 * (size_t)f + (size_t)k]);
            box = sn_box3_add(box, t.p[k]);
        }
        sn_bvh_overlap(a, box, test_face, &t);
    }
    return t.crosses;
}

static sn_status placed_tree(const row *r, int32_t i, sn_tri_mesh *m, sn_bvh **tree, sn_error *err)
{
    sn_status st = sn_tri_mesh_copy(m, r->bone, err);
    if (st) return st;
    sn_affine_mesh(&r->map[i], m);
    return sn_bvh_create(tree, m, err);
}

/* They do not cross, but one may lie within the other: then any of its corners does. */
static bool holds(const sn_bvh *tree, const sn_tri_mesh *m)
{
    return sn_bvh_contains(tree, sn_tri_mesh_point(m, m->face[0]));
}

static sn_status test_pair(const row *r, const sn_tri_mesh *a, const sn_bvh *a_tree, int32_t j, bool *crosses,
                           sn_error *err)
{
    sn_tri_mesh b;
    sn_bvh *b_tree = NULL;
    sn_tri_mesh_init(&b);
    sn_status st = placed_tree(r, j, &b, &b_tree, err);
    *crosses = !st && (surfaces_cross(a_tree, &b) || holds(a_tree, &b) || holds(b_tree, a));
    sn_bvh_destroy(b_tree);
    sn_tri_mesh_free(&b);
    return st;
}

/* ---- all of them ---- */

static sn_status test_bone(void *user, int32_t i, const sn_run *run, sn_error *err)
{
    row *r = user;
    sn_tri_mesh m;
    sn_bvh *tree = NULL;
    int32_t j = next_near(r, i, i);
    r->other[i] = -1;
    if (j == r->n) return SN_OK;
    sn_tri_mesh_init(&m);
    sn_status st = placed_tree(r, i, &m, &tree, err);
    for (; !st && j < r->n && r->other[i] < 0; j = next_near(r, i, j)) {
        bool crosses = false;
        st = sn_run_step(run, "looking for crossing bones", -1.0, err);
        if (!st) st = test_pair(r, &m, tree, j, &crosses, err);
        if (crosses) r->other[i] = j;
    }
    sn_bvh_destroy(tree);
    sn_tri_mesh_free(&m);
    return st;
}

sn_status sn_row_crossing(const sn_tri_mesh *bone, const sn_affine *map, int32_t n, const sn_run *run,
                          int32_t pair[2], sn_error *err)
{
    row r = {.bone = bone, .map = map, .n = n, .box = SN_NEW(sn_box3, n), .other = SN_NEW(int32_t, n)};
    sn_status st = SN_OK;
    if (!r.box || !r.other) st = sn_fail(err, SN_ENOMEM, "curve bones: no memory for %d bones", n);
    for (int32_t i = 0; !st && i < n; i++) r.box[i] = placed_box(bone, &map[i]);
    if (!st) st = sn_run_each(run, n, test_bone, &r, err);
    pair[0] = pair[1] = -1;
    for (int32_t i = n - 1; !st && i >= 0; i--)
        if (r.other[i] >= 0) {
            pair[0] = i;
            pair[1] = r.other[i];
        }
    sn_release(r.box);
    sn_release(r.other);
    return st;
}
