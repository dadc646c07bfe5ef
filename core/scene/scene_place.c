/* Bones of the library put into the scene. */
#include "base/alloc.h"
#include "base/plane.h"
#include "base/side_name.h"
#include "scene/scene_private.h"

#include <stdio.h>
#include <string.h>

#define EDGE_ON                                                                                              \
    0.02 /* sine of the angle between a plane and a line of sight: less is no place on the plane */

static sn_status need_skin(const sn_scene *s, const char *what, sn_error *err)
{
    return s->skin.n_face
               ? SN_OK
               : sn_fail(err, SN_EINVAL, "%s needs a skin and the scene has none: set_skin first", what);
}

/* The whole skin, also in a half model: a limb is as thick as it is. */
static sn_status skin_tree(const sn_scene *s, const char *what, sn_bvh **out, sn_error *err)
{
    *out = NULL;
    sn_status st = need_skin(s, what, err);
    return st ? st : sn_bvh_create(out, &s->skin, err);
}

sn_status sn_scene_pick(const sn_scene *s, const sn_pick *pick, sn_vec3 *out, sn_error *err)
{
    if (!pick->is_ray) {
        *out = pick->origin;
        return sn_v3_is_finite(pick->origin) ? SN_OK
                                             : sn_fail(err, SN_EINVAL, "pick: the point is not finite");
    }
    sn_bvh *skin;
    sn_status st = skin_tree(s, "a pick by a ray", &skin, err);
    if (!st) st = sn_pick_midpoint(skin, pick->origin, pick->dir, out, err);
    sn_bvh_destroy(skin);
    return st;
}

sn_status sn_scene_units_per_metre(const sn_scene *s, double *out, sn_error *err)
{
    static const struct {
        const char *name;
        double per_metre;
    } known[] = {{"m", 1.0},    {"dm", 10.0},         {"cm", 100.0},       {"mm", 1000.0},
                 {"km", 0.001}, {"in", 1.0 / 0.0254}, {"ft", 1.0 / 0.3048}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strcmp(s->unit, known[i].name) == 0) {
            *out = known[i].per_metre;
            return SN_OK;
        }
    return sn_fail(
        err, SN_EINVAL,
        "how long a metre is in the scene's unit '%s' is not known (known: m, dm, cm, mm, km, in, ft)",
        s->unit);
}

/* ---- what all kinds have in common ---- */

/* Where a figure that stands upright looks: towards the eye of the view "front". */
static sn_vec3 front_of(const sn_scene *s)
{
    return s->up == SN_UP_Z ? sn_v3(0, -1, 0) : sn_v3(0, 0, 1);
}

static sn_status begin_bone(const sn_bone_placing *p, scene_bone *b, sn_error *err)
{
    *b = (scene_bone){.name = sn_strdup(p->name)};
    return b->name ? SN_OK : sn_scene_no_memory(err);
}

/* Weights of the corners v of a face at p, by areas. */
static void weights_at(const sn_tri_mesh *m, const int32_t v[3], sn_vec3 p, double w[3])
{
    sn_vec3 d[3];
    double sum = 0.0;
    for (int k = 0; k < 3; k++) d[k] = sn_v3_sub(sn_tri_mesh_point(m, v[k]), p);
    for (int k = 0; k < 3; k++) sum += w[k] = sn_v3_len(sn_v3_cross(d[(k + 1) % 3], d[(k + 2) % 3]));
    for (int k = 0; k < 3; k++) w[k] = sum > 0.0 ? w[k] / sum : k == 0;
}

/* Attachment regions go along with the surface they lie on. before, after: of the same faces. */
static sn_status carry_landmarks(const sn_tri_mesh *before, const sn_tri_mesh *after, sn_landmark *l,
                                 int32_t n, sn_error *err)
{
    sn_bvh *tree;
    sn_status st = sn_bvh_create(&tree, before, err);
    for (int32_t i = 0; !st && i < n; i++) {
        if (l[i].radius == 0.0) continue; /* the centre of a joint */
        sn_closest c = sn_bvh_closest(tree, l[i].at);
        const int32_t *v = before->face + 3 * (size_t)c.face;
        double bary[3];
        weights_at(before, v, c.point, bary);
        for (int k = 0; k < 3; k++)
            l[i].at = sn_v3_mad(l[i].at, bary[k],
                                sn_v3_sub(sn_tri_mesh_point(after, v[k]), sn_tri_mesh_point(before, v[k])));
    }
    sn_bvh_destroy(tree);
    return st;
}

/* Keeps the mesh within the margin; landmarks: n, go along. */
static sn_status keep_clear(const sn_scene *s, sn_tri_mesh *mesh, sn_landmark *l, int32_t n, double margin,
                            const sn_run *run, sn_clearance_report *report, sn_error *err)
{
    sn_bvh *skin = NULL;
    sn_tri_mesh before;
    sn_tri_mesh_init(&before);
    sn_status st = skin_tree(s, "a margin", &skin, err);
    if (!st) st = sn_tri_mesh_copy(&before, mesh, err);
    if (!st) st = sn_clearance_keep(mesh, skin, margin, run, report, err);
    if (!st && report->n_moved > 0) st = carry_landmarks(&before, mesh, l, n, err);
    sn_bvh_destroy(skin);
    sn_tri_mesh_free(&before);
    return st;
}

/* Adds the bone with its margin kept; the caller's to free on error. */
static sn_status end_bone(sn_scene *s, const sn_bone_placing *p, scene_bone *b, const sn_run *run,
                          sn_clearance_report *clear, sn_error *err)
{
    sn_clearance_report own = {0};
    sn_status st = SN_OK;
    if (p->margin > 0.0) st = keep_clear(s, &b->mesh, b->landmark, b->n_landmark, p->margin, run, &own, err);
    if (!st) st = sn_scene_put_bone(s, -1, b, err);
    if (!st && clear) *clear = own;
    return st;
}

/* Landmarks of the template, mapped; suffix: after the name, "" for none. */
static sn_status add_landmarks(scene_bone *b, const sn_bone_template *t, const sn_affine *map,
                               const char *suffix, sn_error *err)
{
    int32_t first = b->n_landmark, n = t->n_landmark;
    sn_landmark *list = sn_realloc(b->landmark, (size_t)(first + n), sizeof *list);
    if (n > 0 && !list) return sn_scene_no_memory(err);
    b->landmark = list;
    double scale = cbrt(fabs(sn_affine_det(map)));
    for (int32_t i = 0; i < n; i++) {
        const sn_landmark *l = &t->landmark[i];
        size_t size = strlen(l->name) + strlen(suffix) + 1;
        char *name = SN_NEW(char, size);
        if (!name) return sn_scene_no_memory(err);
        (void)snprintf(name, size, "%s%s", l->name, suffix);
        list[b->n_landmark++] = (sn_landmark){name, sn_affine_point(map, l->at), scale * l->radius};
    }
    return SN_OK;
}

static sn_status fail_placing(const sn_bone_placing *p, sn_status st, sn_error *err)
{
    return st == SN_ECANCEL || st == SN_ELIMIT || st == SN_ENOMEM
               ? st
               : sn_fail_prefix(err, st, "bone '%.64s': ", p->name);
}

/* ---- cylinder ---- */

static sn_status find_thickness(const sn_scene *s, const sn_bone_template *t, const scene_bone *b,
                                const sn_cylinder_placing *opt, double *out, sn_error *err)
{
    if (opt->is_kept) return sn_scene_units_per_metre(s, out, err);
    double own = sn_v3_dist(t->from, t->to);
    if (opt->proportion > 0.0 && own > 0.0) *out = opt->proportion * sn_v3_dist(b->from, b->to) / own;
    return SN_OK;
}

static sn_status place_cylinder(sn_scene *s, const sn_bone_placing *p, const sn_pick *from, const sn_pick *to,
                                const sn_cylinder_placing *opt, scene_bone *b, sn_error *err)
{
    sn_cylinder_options o = opt->map;
    sn_affine map;
    o.is_mirrored = sn_side_of(p->name) == SN_SIDE_RIGHT;
    if (sn_v3_len2(o.front) == 0.0) o.front = front_of(s);
    sn_status st = sn_scene_pick(s, from, &b->from, err);
    if (st) return sn_fail_prefix(err, st, "from: ");
    st = sn_scene_pick(s, to, &b->to, err);
    if (st) return sn_fail_prefix(err, st, "to: ");
    st = find_thickness(s, p->from_template, b, opt, &o.thickness, err);
    if (!st) st = sn_place_cylinder(p->from_template, b->from, b->to, &o, &map, err);
    if (!st) st = sn_tri_mesh_copy(&b->mesh, &p->from_template->bone, err);
    if (st) return st;
    b->has_ends = true;
    sn_affine_mesh(&map, &b->mesh);
    return add_landmarks(b, p->from_template, &map, "", err);
}

sn_status sn_scene_place_cylinder(sn_scene *s, const sn_bone_placing *p, const sn_pick *from,
                                  const sn_pick *to, const sn_cylinder_placing *opt, const sn_run *run,
                                  sn_clearance_report *clear, sn_error *err)
{
    scene_bone b;
    sn_status st = begin_bone(p, &b, err);
    if (!st && (st = place_cylinder(s, p, from, to, opt, &b, err))) st = fail_placing(p, st, err);
    if (!st) st = end_bone(s, p, &b, run, clear, err);
    sn_scene_free_bone(&b);
    return st;
}

/* ---- row along a curve ---- */

static sn_status append_mesh(sn_tri_mesh *m, const sn_tri_mesh *piece, int32_t i_piece, const sn_affine *map,
                             sn_error *err)
{
    sn_tri_mesh one;
    sn_tri_mesh_init(&one);
    sn_status st = sn_tri_mesh_copy(&one, piece, err);
    if (st) return st;
    sn_affine_mesh(map, &one);
    size_t n_vert = (size_t)one.n_vert, n_face = (size_t)one.n_face, i = (size_t)i_piece;
    memcpy(m->pos + 3 * i * n_vert, one.pos, 3 * n_vert * sizeof *m->pos);
    for (size_t c = 0; c < 3 * n_face; c++) m->face[3 * i * n_face + c] = one.face[c] + i_piece * one.n_vert;
    sn_tri_mesh_free(&one);
    return SN_OK;
}

static sn_status build_row(const sn_bone_template *t, const sn_affine *map, int32_t n, scene_bone *b,
                           sn_error *err)
{
    if ((int64_t)n * t->bone.n_vert > INT32_MAX || (int64_t)n * t->bone.n_face > INT32_MAX / 3)
        return sn_fail(err, SN_EINVAL, "%d pieces are too many", n);
    sn_status st = sn_tri_mesh_reserve(&b->mesh, n * t->bone.n_vert, n * t->bone.n_face, err);
    for (int32_t k = 0; k < n && !st; k++) {
        char suffix[16];
        (void)snprintf(suffix, sizeof suffix, "_%d", k + 1);
        st = append_mesh(&b->mesh, &t->bone, k, &map[k], err);
        if (!st) st = add_landmarks(b, t, &map[k], suffix, err);
    }
    return st;
}

sn_status sn_scene_place_row(sn_scene *s, const sn_bone_placing *p, const double *point, int32_t n,
                             const sn_curve_options *opt, const sn_run *run, sn_curve_report *report,
                             int32_t *n_piece, sn_clearance_report *clear, sn_error *err)
{
    scene_bone b;
    sn_affine *map = NULL;
    sn_curve_options o = *opt;
    if (sn_v3_len2(o.front) == 0.0) o.front = front_of(s);
    sn_status st = begin_bone(p, &b, err);
    if (!st) st = sn_place_curve(p->from_template, point, n, &o, run, &map, n_piece, report, err);
    for (int32_t k = 0; !st && k < *n_piece && sn_side_of(p->name) == SN_SIDE_RIGHT; k++)
        map[k] = sn_affine_after(map[k], sn_affine_mirror(sn_v3(0, 0, 0), sn_v3(1, 0, 0)));
    if (!st) st = build_row(p->from_template, map, *n_piece, &b, err);
    if (st) st = fail_placing(p, st, err);
    if (!st) st = end_bone(s, p, &b, run, clear, err);
    sn_release(map);
    sn_scene_free_bone(&b);
    return st;
}

sn_status sn_scene_stroke_on_plane(const sn_camera *camera, int width, int height, const double *pixel,
                                   int32_t n, sn_vec3 point, sn_vec3 normal, double *out, sn_error *err)
{
    sn_plane plane;
    sn_status st = sn_camera_check(camera, err);
    if (!st) st = sn_plane_make(&plane, "plane", point, normal, err);
    for (int32_t i = 0; i < n && !st; i++) {
        sn_vec3 eye, dir;
        sn_camera_ray(camera, pixel[2 * (size_t)i], pixel[2 * (size_t)i + 1], width, height, &eye, &dir);
        double along = sn_v3_dot(plane.normal, dir), t = -sn_plane_height(&plane, eye) / along;
        if (!(fabs(along) > EDGE_ON) || !(t > 0.0))
            return sn_fail(
                err, SN_EINVAL,
                "stroke[%d]: the line of sight of pixel (%g, %g) does not meet the plane: look at it "
                "from the side",
                i + 1, pixel[2 * (size_t)i], pixel[2 * (size_t)i + 1]);
        sn_v3_store(out + 3 * (size_t)i, sn_plane_project(&plane, sn_v3_mad(eye, t, dir)));
    }
    return st;
}

/* ---- shape ---- */

static bool is_turned(const sn_affine *a)
{
    return sn_v3_len2(a->col[0]) > 0.0;
}

/* Template to scene: metres to units, size, mirror, turn, place. */
static sn_status start_of_shape(const sn_scene *s, const sn_bone_placing *p, sn_vec3 at,
                                const sn_shape_options *opt, sn_affine *out, sn_error *err)
{
    double unit, size = opt->size == 0.0 ? 1.0 : opt->size;
    sn_status st = sn_scene_units_per_metre(s, &unit, err);
    if (st) return st;
    if (!(size > 0.0 && isfinite(size))) return sn_fail(err, SN_EINVAL, "size is %g, need > 0", size);
    sn_vec3 zero = sn_v3(0, 0, 0);
    *out = sn_affine_scale(size * unit, zero);
    if (sn_side_of(p->name) == SN_SIDE_RIGHT)
        *out = sn_affine_after(*out, sn_affine_mirror(zero, sn_v3(1, 0, 0)));
    if (s->up == SN_UP_Z) *out = sn_affine_after(sn_affine_rotation(sn_v3(1, 0, 0), 90.0, zero), *out);
    if (is_turned(&opt->turn)) *out = sn_affine_after(opt->turn, *out);
    *out = sn_affine_after(sn_affine_translation(at), *out);
    return SN_OK;
}

static sn_status put_unfitted(const sn_bone_template *t, const sn_affine *map, scene_bone *b, sn_error *err)
{
    sn_status st = sn_tri_mesh_copy(&b->mesh, &t->bone, err);
    if (st) return st;
    sn_affine_mesh(map, &b->mesh);
    return add_landmarks(b, t, map, "", err);
}

/* Fitted from where put_unfitted leaves it: template surfaces are mapped first, so that a mirrored one is
 * fitted as any. */
static sn_status fit_shape(const sn_scene *s, const sn_bone_template *t, const sn_affine *map,
                           const sn_fit_options *opt, const sn_run *run, scene_bone *b, sn_fit_result *fit,
                           sn_error *err)
{
    if (t->cage.n_face == 0)
        return sn_fail(err, SN_EINVAL, "template '%s' has no cage and skin to be fitted by", t->name);
    sn_status st = need_skin(s, "fitting", err);
    sn_tri_mesh cage, skin;
    sn_tri_mesh_init(&cage);
    sn_tri_mesh_init(&skin);
    double *at = SN_NEW(double, 3 * (size_t)b->n_landmark);
    if (!st && !at) st = sn_scene_no_memory(err);
    if (!st) st = sn_tri_mesh_copy(&cage, &t->cage, err);
    if (!st) st = sn_tri_mesh_copy(&skin, &t->skin, err);
    if (!st) {
        sn_affine_mesh(map, &cage);
        sn_affine_mesh(map, &skin);
        for (int32_t i = 0; i < b->n_landmark; i++) sn_v3_store(at + 3 * (size_t)i, b->landmark[i].at);
        const sn_fit_template placed = {&b->mesh, &cage, &skin, b->n_landmark ? at : NULL, b->n_landmark};
        const sn_transform start = {.scale = 1.0};
        st = sn_fit_shape(&placed, &s->skin, &start, opt, run, fit, err);
    }
    if (!st) {
        sn_tri_mesh_free(&b->mesh);
        st = sn_tri_mesh_copy(&b->mesh, &fit->bone, err);
        for (int32_t i = 0; i < b->n_landmark; i++)
            b->landmark[i].at = sn_v3_load(fit->point + 3 * (size_t)i);
    }
    sn_tri_mesh_free(&cage);
    sn_tri_mesh_free(&skin);
    sn_release(at);
    return st;
}

static sn_status place_shape(sn_scene *s, const sn_bone_placing *p, const sn_pick *at,
                             const sn_shape_options *opt, const sn_run *run, scene_bone *b,
                             sn_fit_result *fit, sn_error *err)
{
    sn_affine map;
    sn_vec3 place;
    sn_status st = sn_scene_pick(s, at, &place, err);
    if (!st) st = start_of_shape(s, p, place, opt, &map, err);
    if (!st) st = put_unfitted(p->from_template, &map, b, err);
    if (!st && opt->is_fitted) st = fit_shape(s, p->from_template, &map, &opt->fit, run, b, fit, err);
    return st;
}

sn_status sn_scene_place_shape(sn_scene *s, const sn_bone_placing *p, const sn_pick *at,
                               const sn_shape_options *opt, const sn_run *run, sn_fit_result *fit,
                               sn_clearance_report *clear, sn_error *err)
{
    scene_bone b;
    sn_status st = begin_bone(p, &b, err);
    if (!st && (st = place_shape(s, p, at, opt, run, &b, fit, err))) st = fail_placing(p, st, err);
    if (!st) st = end_bone(s, p, &b, run, clear, err);
    sn_scene_free_bone(&b);
    return st;
}

/* ---- how far from the skin ---- */

sn_status sn_scene_bone_clearance(const sn_scene *s, int32_t i_bone, double margin, const sn_run *run,
                                  sn_clearance *out, sn_error *err)
{
    sn_bvh *skin;
    sn_status st = skin_tree(s, "clearance", &skin, err);
    if (!st) st = sn_clearance_measure(&s->bone[i_bone].mesh, skin, margin, run, out, err);
    sn_bvh_destroy(skin);
    return st;
}

sn_status sn_scene_keep_bone_clear(sn_scene *s, int32_t i_bone, double margin, const sn_run *run,
                                   sn_clearance_report *report, sn_error *err)
{
    scene_bone *b = &s->bone[i_bone], moved = {.name = sn_strdup(b->name), .has_ends = b->has_ends};
    moved.from = b->from;
    moved.to = b->to;
    sn_status st = moved.name ? sn_tri_mesh_copy(&moved.mesh, &b->mesh, err) : sn_scene_no_memory(err);
    if (!st) st = sn_landmarks_copy(&moved.landmark, b->landmark, b->n_landmark, err);
    if (!st) moved.n_landmark = b->n_landmark;
    if (!st) {
        st = keep_clear(s, &moved.mesh, moved.landmark, moved.n_landmark, margin, run, report, err);
        if (st && st != SN_ECANCEL) st = sn_fail_prefix(err, st, "bone '%s': ", b->name);
    }
    if (!st) st = sn_scene_put_bone(s, i_bone, &moved, err);
    sn_scene_free_bone(&moved);
    return st;
}
