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
    sn_scene_stale_body(s);
    sn_body_free(&s->body);
    sn_tri_mesh_free(&s->skin);
    for (int32_t i = 0; i < s->n_bone; i++) {
        sn_release(s->bone[i].name);
        sn_tri_mesh_free(&s->bone[i].mesh);
    }
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
    sn_locator_destroy(s->locator);
    sn_tissue_solver_destroy(s->solver);
    sn_harmonic_destroy(s->harmonic);
    s->locator = NULL;
    s->solver = NULL;
    s->harmonic = NULL;
    s->has_body = false;
    for (int32_t i = 0; i < s->n_muscle; i++) s->muscle[i]->has_row = s->muscle[i]->has_tensor = false;
    sn_scene_stale_muscles(s);
}

void sn_scene_stale_muscles(sn_scene *s)
{
    sn_scene_stale_curves(s);
    sn_release(s->field);
    s->field = NULL;
    s->has_field = false;
}

void sn_scene_stale_curves(sn_scene *s)
{
    s->revision++;
    sn_release(s->inputs);
    s->inputs = NULL;
    s->has_factor = false;
    s->is_fat_solved = false;
    for (int32_t i = 0; i < s->n_muscle; i++) s->muscle[i]->is_solved = false;
}

void sn_scene_stale_field(sn_scene *s, int32_t i_muscle)
{
    s->revision++;
    if (i_muscle < 0) {
        s->is_fat_solved = false;
        return;
    }
    s->muscle[i_muscle]->is_solved = false;
    s->muscle[i_muscle]->has_row = false; /* d is in the row; B does not change */
}

/* ---- skin and bones ---- */

sn_status sn_scene_set_skin(sn_scene *s, const sn_tri_mesh *skin, sn_error *err)
{
    sn_tri_mesh copy;
    sn_tri_mesh_init(&copy);
    sn_status st = sn_tri_mesh_validate(skin, err);
    if (st) return sn_fail_prefix(err, st, "skin: ");
    st = sn_tri_mesh_copy(&copy, skin, err);
    if (st) return st;
    sn_tri_mesh_free(&s->skin);
    s->skin = copy;
    sn_scene_stale_body(s);
    return SN_OK;
}

const sn_tri_mesh *sn_scene_skin(const sn_scene *s)
{
    return s->skin.n_face ? &s->skin : NULL;
}

static sn_status new_bone_name(const sn_scene *s, const char *name, sn_error *err)
{
    sn_status st = sn_check_name("bone", name, err);
    for (int32_t i = 0; !st && i < s->n_bone; i++)
        if (strcmp(s->bone[i].name, name) == 0)
            st = sn_fail(err, SN_EINVAL, "there is a bone '%s' already", name);
    return st;
}

sn_status sn_scene_add_bone(sn_scene *s, const char *name, const sn_tri_mesh *bone, sn_error *err)
{
    sn_status st = new_bone_name(s, name, err);
    if (st) return st;
    st = sn_tri_mesh_validate(bone, err);
    if (st) return sn_fail_prefix(err, st, "bone '%s': ", name);
    if (!sn_grow(&s->bone, &s->cap_bone, (size_t)s->n_bone + 1, sizeof *s->bone))
        return sn_scene_no_memory(err);
    scene_bone b = {.name = sn_strdup(name)};
    if (!b.name) return sn_scene_no_memory(err);
    st = sn_tri_mesh_copy(&b.mesh, bone, err);
    if (st) {
        sn_release(b.name);
        return st;
    }
    s->bone[s->n_bone++] = b;
    sn_scene_stale_body(s);
    return SN_OK;
}

sn_status sn_scene_find_bone(const sn_scene *s, const char *name, int32_t *i_bone, sn_error *err)
{
    const char **names = SN_NEW(const char *, s->n_bone);
    if (!names) return sn_scene_no_memory(err);
    for (int32_t i = 0; i < s->n_bone; i++) names[i] = s->bone[i].name;
    sn_status st = sn_find_name("bone", name, names, s->n_bone, i_bone, err);
    sn_release(names);
    return st;
}

sn_status sn_scene_remove_bone(sn_scene *s, const char *name, sn_error *err)
{
    int32_t i;
    sn_status st = sn_scene_find_bone(s, name, &i, err);
    if (st) return st;
    sn_release(s->bone[i].name);
    sn_tri_mesh_free(&s->bone[i].mesh);
    memmove(&s->bone[i], &s->bone[i + 1], (size_t)(s->n_bone - i - 1) * sizeof *s->bone);
    s->n_bone--;
    sn_scene_stale_body(s);
    return SN_OK;
}

int32_t sn_scene_bone_count(const sn_scene *s)
{
    return s->n_bone;
}

const char *sn_scene_bone_name(const sn_scene *s, int32_t i_bone)
{
    return s->bone[i_bone].name;
}

const sn_tri_mesh *sn_scene_bone_mesh(const sn_scene *s, int32_t i_bone)
{
    return &s->bone[i_bone].mesh;
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
    sn_box3 b = sn_tri_mesh_bounds(&s->skin);
    for (int32_t i = 0; i < s->n_bone; i++) b = sn_box3_merge(b, sn_tri_mesh_bounds(&s->bone[i].mesh));
    for (int32_t i = 0; i < s->n_muscle; i++) {
        const sn_muscle *m = &s->muscle[i]->muscle;
        for (int32_t h = 0; h < m->n_head; h++)
            for (int32_t k = 0; k < m->head[h].n_point; k++)
                b = sn_box3_add(b, sn_v3_load(m->head[h].point + 3 * (size_t)k));
    }
    return b;
}
