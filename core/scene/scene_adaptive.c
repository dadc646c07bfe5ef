/* Where an adaptive mesh is to be fine: the muscles are solved once on a coarse mesh, and the faces between
 * its tissues and the muscles' curves are the places. */
#include "base/alloc.h"
#include "scene/scene.h"
#include "scene/scene_private.h"

/* Chosen on the hind leg of a dog (17 muscles, 630 k tets without): with these the fields have as many
 * collocation points as on the even mesh, on a third of the tets. */
#define GROWTH 0.7        /* of lengths per unit of distance from the places and from bones       */
#define CURVE_LENGTH 0.75 /* at the curves, of what an even mesh has there                        */
#define CURVE_BAND 1      /* cells around the curves: their tets decide how strong a muscle is    */
#define BORDER_LENGTH 0.9 /* at the borders between tissues                                       */

/* ---- the coarse scene ---- */

static sn_status add_muscle(sn_scene *to, const sn_muscle *m, sn_error *err)
{
    sn_head_points *head = SN_NEW(sn_head_points, m->n_head);
    if (!head) return sn_scene_no_memory(err);
    for (int32_t h = 0; h < m->n_head; h++)
        head[h] = (sn_head_points){m->head[h].point, m->head[h].tissue, m->head[h].n_point};
    sn_status st = sn_scene_add_heads(to, m->name, head, m->n_head, err);
    if (!st) st = sn_scene_set_anisotropy(to, sn_scene_muscle_count(to) - 1, &m->anisotropy, err);
    sn_release(head);
    return st;
}

/* What s holds, without what is computed. */
static sn_status copy_inputs(sn_scene *to, const sn_scene *s, sn_error *err)
{
    sn_status st = sn_scene_set_skin(to, &s->skin, err);
    for (int32_t i = 0; i < s->n_bone && !st; i++)
        st = sn_scene_add_bone(to, s->bone[i].name, &s->bone[i].mesh, err);
    for (int32_t i = 0; i < s->n_muscle && !st; i++) st = add_muscle(to, &s->muscle[i]->muscle, err);
    if (!st) st = sn_scene_set_fat(to, s->fat, err);
    if (!st) st = sn_scene_set_alpha(to, s->alpha, err);
    if (!st && s->has_cut) st = sn_scene_cut(to, s->cut_point, s->cut_normal, err);
    return st;
}

/* ---- the places ---- */

typedef struct site_maker {
    sn_unit_box box;
    sn_body_options opt; /* with the defaults filled in */
    sn_sizing usual;     /* as an even mesh would be: fine at bones, coarser away from them */
    sn_sizing *out;
} site_maker;

static sn_vec3 boxed(const site_maker *w, sn_vec3 p)
{
    return sn_v3_scale(1.0 / w->box.size, sn_v3_sub(p, w->box.origin));
}

static void add_bone(site_maker *w, const sn_tri_mesh *m)
{
    for (int32_t f = 0; f < m->n_face; f++) {
        const int32_t *v = m->face + 3 * (size_t)f;
        sn_sizing_add_triangle(&w->usual, boxed(w, sn_tri_mesh_point(m, v[0])),
                               boxed(w, sn_tri_mesh_point(m, v[1])), boxed(w, sn_tri_mesh_point(m, v[2])),
                               NULL, w->opt.bone_edge_length / w->box.size);
    }
}

static sn_status add_curves(const site_maker *w, const sn_muscle *m, sn_error *err)
{
    sn_paths p = {0};
    sn_status st = sn_paths_build(&p, m, err);
    for (int32_t h = 0; !st && h < p.n_head; h++)
        for (int k = 0; k < SN_PATH_STEPS; k++)
            sn_sizing_add_piece(w->out, boxed(w, p.head[h].point[k]), boxed(w, p.head[h].point[k + 1]),
                                &w->usual, CURVE_LENGTH);
    sn_paths_free(&p);
    return st;
}

static sn_status add_borders(const site_maker *w, const sn_tet_mesh *m, sn_error *err)
{
    int32_t *adj = NULL;
    sn_status st = sn_tet_mesh_adjacency(m, &adj, err);
    for (size_t h = 0; !st && h < 4 * (size_t)m->n_tet; h++) {
        if (adj[h] < 0 || m->part[h >> 2] >= m->part[adj[h]]) continue;
        const int32_t *v = m->tet + (h & ~(size_t)3);
        const int *f = sn_tet_face[h & 3];
        sn_sizing_add_triangle(w->out, boxed(w, sn_tet_mesh_point(m, v[f[0]])),
                               boxed(w, sn_tet_mesh_point(m, v[f[1]])),
                               boxed(w, sn_tet_mesh_point(m, v[f[2]])), &w->usual, BORDER_LENGTH);
    }
    sn_release(adj);
    return st;
}

static sn_status begin_sizing(site_maker *w, const sn_scene *s, sn_error *err)
{
    sn_box3 box = sn_tri_mesh_bounds(&s->skin);
    double finest = fmin(w->opt.edge_length, w->opt.bone_edge_length) / w->box.size,
           longest = w->opt.edge_length / w->box.size;
    box = (sn_box3){boxed(w, box.min), boxed(w, box.max)};
    sn_status st = sn_sizing_create(&w->usual, box, finest, longest, err);
    if (!st) st = sn_sizing_create(w->out, box, finest, SN_BODY_COARSEST * longest, err);
    for (int32_t i = 0; i < s->n_bone && !st; i++) add_bone(w, &s->bone[i].mesh);
    if (!st) sn_sizing_spread(&w->usual, 0, GROWTH);
    for (int32_t i = 0; i < s->n_muscle && !st; i++) st = add_curves(w, &s->muscle[i]->muscle, err);
    if (!st) sn_sizing_spread(w->out, CURVE_BAND, GROWTH);
    return st;
}

/* The borders between tissues on a mesh that is fine at the curves only. */
static sn_status find_borders(site_maker *w, const sn_scene *s, const sn_run *run, int32_t *n_coarse_tet,
                              sn_error *err)
{
    sn_scene *coarse = NULL;
    sn_extraction x;
    sn_body_options opt = w->opt;
    opt.is_adaptive = false;
    opt.sizing = w->out;
    sn_extraction_init(&x);
    sn_status st = sn_scene_create(&coarse, s->name, s->unit, s->up, err);
    if (!st) st = copy_inputs(coarse, s, err);
    if (!st) sn_scene_set_solver(coarse, s->solver_kind);
    if (!st) st = sn_scene_tetrahedralize(coarse, &opt, run, NULL, err);
    if (!st) *n_coarse_tet = coarse->body.mesh.n_tet;
    if (!st) st = sn_scene_extract(coarse, NULL, run, &x, err);
    if (!st) st = sn_run_step(run, "finding where muscles meet", -1.0, err);
    if (!st) st = add_borders(w, &x.mesh, err);
    if (!st) sn_sizing_spread(w->out, 0, GROWTH);
    sn_extraction_free(&x);
    sn_scene_destroy(coarse);
    return st;
}

sn_status sn_scene_find_sizing(const sn_scene *s, const sn_body_options *opt, const sn_run *run,
                               sn_sizing *out, int32_t *n_coarse_tet, sn_error *err)
{
    if (s->n_muscle == 0)
        return sn_fail(err, SN_EINVAL,
                       "tetrahedralize: an adaptive mesh is fine where muscles meet, and the scene has none: "
                       "add_muscle first");
    site_maker w = {.box = sn_body_unit_box(&s->skin), .out = out};
    sn_status st = sn_body_defaults(opt, &s->skin, &w.opt, err);
    if (!st) st = begin_sizing(&w, s, err);
    if (!st) st = find_borders(&w, s, run, n_coarse_tet, err);
    sn_sizing_free(&w.usual);
    if (st) sn_sizing_free(out);
    return st;
}
