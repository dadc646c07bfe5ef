#include "scene/scene.h"

#include "base/alloc.h"
#include "scene/scene_private.h"

#include <string.h>

#define DEFAULT_FAT 0.2
#define DEFAULT_ALPHA 5.0

sn_status sn_scene_no_memory(sn_error *err)
{
    return sn_fail(err, SN_ENOMEM, "scene: no memory");
}

sn_status sn_scene_create(sn_scene **out, const char *name, const char *unit, sn_up up, sn_error *err)
{
    *out = NULL;
    sn_scene *s = SN_NEW_ZERO(sn_scene, 1);
    if (s) {
        s->name = sn_strdup(name);
        s->unit = sn_strdup(unit);
        s->up = up;
        s->fat = DEFAULT_FAT;
        s->alpha = DEFAULT_ALPHA;
    }
    if (!s || !s->name || !s->unit) {
        sn_scene_destroy(s);
        return sn_scene_no_memory(err);
    }
    *out = s;
    return SN_OK;
}

void sn_scene_destroy(sn_scene *s)
{
    if (!s) return;
    sn_scene_free_view(s);
    sn_scene_stale_body(s);
    sn_body_free(&s->body);
    sn_tri_mesh_free(&s->skin);
    sn_tri_mesh_free(&s->half_skin);
    for (int32_t i = 0; i < s->n_bone; i++) sn_scene_free_bone(&s->bone[i]);
    while (s->n_joint > 0) sn_scene_drop_joint(s, s->n_joint - 1);
    sn_release(s->joint);
    for (int32_t i = 0; i < s->n_muscle; i++) sn_scene_free_muscle(s->muscle[i]);
    sn_release(s->bone);
    sn_release(s->muscle);
    sn_notes_free(&s->notes);
    sn_release(s->name);
    sn_release(s->unit);
    sn_release(s);
}

const char *sn_scene_name(const sn_scene *s)
{
    return s->name;
}

const char *sn_scene_unit(const sn_scene *s)
{
    return s->unit;
}

sn_up sn_scene_up(const sn_scene *s)
{
    return s->up;
}

uint64_t sn_scene_revision(const sn_scene *s)
{
    return s->revision;
}

const sn_notes *sn_scene_notes(const sn_scene *s)
{
    return &s->notes;
}

void sn_scene_clear_notes(sn_scene *s)
{
    sn_notes_free(&s->notes);
}

/* ---- staleness ---- */

void sn_scene_stale_body(sn_scene *s)
{
    s->shape_revision++;
    sn_locator_destroy(s->locator);
    sn_tissue_solver_destroy(s->solver);
    sn_harmonic_destroy(s->harmonic);
    s->locator = NULL;
    s->solver = NULL;
    s->harmonic = NULL;
    s->has_body = false;
    for (int32_t i = 0; i < s->n_muscle; i++) s->muscle[i]->has_row = s->muscle[i]->has_tensor = false;
    sn_scene_drop_fields(s, -1);
    sn_scene_stale_curves(s);
}

void sn_scene_drop_fields(sn_scene *s, int32_t i_muscle)
{
    size_t n_vert = (size_t)s->body.mesh.n_vert;
    if (i_muscle >= 0 && i_muscle + 1 < s->n_field) {
        double *row = s->field + (size_t)(1 + i_muscle) * n_vert;
        memmove(row, row + n_vert, (size_t)(s->n_field - i_muscle - 2) * n_vert * sizeof *row);
        s->n_field--;
    }
    if (i_muscle >= 0) return;
    sn_release(s->field);
    s->field = NULL;
    s->n_field = 0;
    s->is_fat_edited = true;
    s->fat_stamp = 0;
    for (int32_t i = 0; i < s->n_muscle; i++) {
        s->muscle[i]->is_edited = true;
        s->muscle[i]->stamp = 0;
    }
}

void sn_scene_stale_curves(sn_scene *s)
{
    s->revision++;
    sn_release(s->inputs);
    s->inputs = NULL;
    s->has_curves = s->is_fat_solved = s->is_quick = false;
    for (int32_t i = 0; i < s->n_muscle; i++) s->muscle[i]->is_solved = false;
}

void sn_scene_stale_field(sn_scene *s, int32_t i_muscle)
{
    s->revision++;
    s->is_quick = false;
    if (i_muscle < 0) {
        s->is_fat_solved = false;
        s->is_fat_edited = true;
        return;
    }
    scene_muscle *m = s->muscle[i_muscle];
    m->is_solved = m->has_row = false; /* d is in the row; B does not change */
    m->is_edited = true;
}

/* ---- fat and alpha ---- */

sn_status sn_scene_set_fat(sn_scene *s, double value, sn_error *err)
{
    if (!(value >= 0.0 && isfinite(value))) return sn_fail(err, SN_EINVAL, "fat is %g, need >= 0", value);
    if (value != s->fat) sn_scene_stale_field(s, -1);
    s->fat = value;
    return SN_OK;
}

sn_status sn_scene_set_alpha(sn_scene *s, double value, sn_error *err)
{
    if (!(value > 0.0 && isfinite(value))) return sn_fail(err, SN_EINVAL, "alpha is %g, need > 0", value);
    if (value != s->alpha) sn_scene_stale_curves(s);
    s->alpha = value;
    return SN_OK;
}

void sn_scene_set_solver(sn_scene *s, sn_solver_kind kind)
{
    if (kind == s->solver_kind) return;
    s->solver_kind = kind;
    sn_tissue_solver_destroy(s->solver);
    sn_harmonic_destroy(s->harmonic);
    s->solver = NULL;
    s->harmonic = NULL;
    sn_scene_drop_fields(s, -1);
    sn_scene_stale_curves(s);
}

double sn_scene_fat(const sn_scene *s)
{
    return s->fat;
}

double sn_scene_alpha(const sn_scene *s)
{
    return s->alpha;
}

sn_box3 sn_scene_bounds(const sn_scene *s)
{
    sn_box3 b = sn_tri_mesh_bounds(s->has_cut ? &s->half_skin : &s->skin);
    for (int32_t i = 0; i < s->n_bone; i++)
        b = sn_box3_merge(b, sn_tri_mesh_bounds(sn_scene_bone_mesh(s, i)));
    for (int32_t i = 0; i < s->n_muscle; i++) {
        const sn_muscle *m = &s->muscle[i]->muscle;
        for (int32_t h = 0; h < m->n_head; h++)
            for (int32_t k = 0; k < m->head[h].n_point; k++)
                b = sn_box3_add(b, sn_v3_load(m->head[h].point + 3 * (size_t)k));
    }
    return b;
}
