/* The muscles of the scene: adding, removing, editing; each edit marks what it makes stale and no more. */
#include "scene/scene.h"

#include "base/alloc.h"
#include "scene/scene_private.h"

#include <string.h>

void sn_scene_free_muscle(scene_muscle *m)
{
    if (!m) return;
    sn_muscle_free(&m->muscle);
    sn_collocation_free(&m->row);
    sn_paths_free(&m->paths);
    sn_release(m->tensor);
    sn_release(m);
}

/* ---- the set ---- */

static sn_status new_muscle_name(const sn_scene *s, const char *name, sn_error *err)
{
    sn_status st = sn_check_name("muscle", name, err);
    if (!st && strcmp(name, "fat") == 0)
        st = sn_fail(err, SN_EINVAL, "'fat' is no name for a muscle: it is tissue 0");
    for (int32_t i = 0; !st && i < s->n_muscle; i++)
        if (strcmp(s->muscle[i]->muscle.name, name) == 0)
            st = sn_fail(err, SN_EINVAL, "there is a muscle '%s' already", name);
    return st;
}

sn_status sn_scene_add_heads(sn_scene *s, const char *name, const sn_head_points *head, int32_t n_head,
                             sn_error *err)
{
    sn_status st = new_muscle_name(s, name, err);
    if (st) return st;
    if (n_head < 1) return sn_fail(err, SN_EINVAL, "muscle '%s': no heads, need 1 or more", name);
    if (s->n_muscle + 1 >= SN_MAX_TISSUES)
        return sn_fail(err, SN_EINVAL, "muscle '%s': the scene has %d, the most it can hold", name,
                       s->n_muscle);
    if (!sn_grow(&s->muscle, &s->cap_muscle, (size_t)s->n_muscle + 1, sizeof *s->muscle))
        return sn_scene_no_memory(err);
    scene_muscle *m = SN_NEW_ZERO(scene_muscle, 1);
    if (!m) return sn_scene_no_memory(err);
    st = sn_muscle_init(&m->muscle, name, head, n_head, err);
    if (st) {
        sn_release(m);
        return st;
    }
    m->id = ++s->n_made;
    m->is_edited = true;
    s->muscle[s->n_muscle++] = m;
    sn_scene_stale_curves(s);
    return SN_OK;
}

sn_status sn_scene_add_muscle(sn_scene *s, const char *name, const double *point, const double *tissue,
                              int32_t n, sn_error *err)
{
    return sn_scene_add_heads(s, name, &(sn_head_points){point, tissue, n}, 1, err);
}

sn_status sn_scene_find_muscle(const sn_scene *s, const char *name, int32_t *i_muscle, sn_error *err)
{
    const char **names = SN_NEW(const char *, s->n_muscle);
    if (!names) return sn_scene_no_memory(err);
    for (int32_t i = 0; i < s->n_muscle; i++) names[i] = s->muscle[i]->muscle.name;
    sn_status st = sn_find_name("muscle", name, names, s->n_muscle, i_muscle, err);
    sn_release(names);
    return st;
}

sn_status sn_scene_remove_muscle(sn_scene *s, const char *name, sn_error *err)
{
    int32_t i;
    sn_status st = sn_scene_find_muscle(s, name, &i, err);
    if (st) return st;
    sn_scene_drop_fields(s, i);
    sn_scene_free_muscle(s->muscle[i]);
    memmove(&s->muscle[i], &s->muscle[i + 1], (size_t)(s->n_muscle - i - 1) * sizeof *s->muscle);
    s->n_muscle--;
    sn_scene_stale_curves(s);
    return SN_OK;
}

int32_t sn_scene_muscle_count(const sn_scene *s)
{
    return s->n_muscle;
}

const sn_muscle *sn_scene_muscle(const sn_scene *s, int32_t i_muscle)
{
    return &s->muscle[i_muscle]->muscle;
}

/* ---- curves and tissue values ---- */

sn_status sn_scene_check_muscle(const sn_scene *s, int32_t i_muscle, sn_error *err)
{
    if (i_muscle >= 0 && i_muscle < s->n_muscle) return SN_OK;
    return sn_fail(err, SN_EINVAL, "muscle %d, need 1..%d", i_muscle + 1, s->n_muscle);
}

/* Index checks in one place; `beyond` is how many places after the last point are allowed. *head: the one
 * meant. */
static sn_status find_point(const sn_scene *s, int32_t i_muscle, int32_t i_head, int32_t i_point,
                            int32_t beyond, sn_head **head, sn_error *err)
{
    sn_status st = sn_scene_check_muscle(s, i_muscle, err);
    if (st) return st;
    sn_muscle *m = &s->muscle[i_muscle]->muscle;
    if (i_head < 0 || i_head >= m->n_head)
        return sn_fail(err, SN_EINVAL, "muscle '%s': head %d, need 1..%d", m->name, i_head + 1, m->n_head);
    *head = &m->head[i_head];
    int32_t n = m->head[i_head].n_point + beyond;
    if (i_point >= 0 && i_point < n) return SN_OK;
    return sn_muscle_blame(m, i_head, sn_fail(err, SN_EINVAL, "point %d, need 1..%d", i_point + 1, n), err);
}

/* What the edit of a curve says when it failed, and marks when it did not. */
static sn_status curve_edited(sn_scene *s, int32_t i_muscle, int32_t i_head, sn_status st, sn_error *err)
{
    scene_muscle *m = s->muscle[i_muscle];
    if (st) return sn_muscle_blame(&m->muscle, i_head, st, err);
    m->has_row = m->has_paths = m->has_tensor = false;
    m->is_edited = true;
    sn_scene_stale_curves(s);
    return SN_OK;
}

sn_status sn_scene_set_point(sn_scene *s, int32_t i_muscle, int32_t i_head, int32_t i_point, sn_vec3 p,
                             sn_error *err)
{
    sn_head *h;
    sn_status st = find_point(s, i_muscle, i_head, i_point, 0, &h, err);
    return st ? st : curve_edited(s, i_muscle, i_head, sn_head_set_point(h, i_point, p, err), err);
}

sn_status sn_scene_insert_point(sn_scene *s, int32_t i_muscle, int32_t i_head, int32_t i_point, sn_vec3 p,
                                double tissue, sn_error *err)
{
    sn_head *h;
    sn_status st = find_point(s, i_muscle, i_head, i_point, 1, &h, err);
    return st ? st : curve_edited(s, i_muscle, i_head, sn_head_insert_point(h, i_point, p, tissue, err), err);
}

sn_status sn_scene_remove_point(sn_scene *s, int32_t i_muscle, int32_t i_head, int32_t i_point, sn_error *err)
{
    sn_head *h;
    sn_status st = find_point(s, i_muscle, i_head, i_point, 0, &h, err);
    return st ? st : curve_edited(s, i_muscle, i_head, sn_head_remove_point(h, i_point, err), err);
}

sn_status sn_scene_set_tissue(sn_scene *s, int32_t i_muscle, int32_t i_head, int32_t i_point, double value,
                              sn_error *err)
{
    sn_head *h;
    sn_status st = sn_scene_check_muscle(s, i_muscle, err);
    if (st) return st;
    const sn_muscle *m = &s->muscle[i_muscle]->muscle;
    int32_t first = i_head < 0 ? 0 : i_head, last = i_head < 0 ? m->n_head - 1 : i_head;
    for (int32_t k = first; k <= last && !st; k++) /* all heads have that point, or none is changed */
        st = find_point(s, i_muscle, k, i_point < 0 ? 0 : i_point, 0, &h, err);
    for (int32_t k = first; k <= last && !st; k++)
        st = sn_muscle_blame(
            m, k, sn_head_set_tissue(&s->muscle[i_muscle]->muscle.head[k], i_point, value, err), err);
    if (!st) sn_scene_stale_field(s, i_muscle);
    return st;
}

/* ---- frame, fibers, tendon ---- */

static bool same_tensor(const sn_anisotropy *a, const sn_anisotropy *b)
{
    if (!a->is_on && !b->is_on) return true;
    bool same = a->is_on == b->is_on && a->angle_deg == b->angle_deg && a->has_axis == b->has_axis;
    for (int k = 0; k < 3; k++) same = same && a->eigenvalue[k] == b->eigenvalue[k];
    return same && (!a->has_axis || sn_v3_dist(a->axis, b->axis) == 0.0);
}

sn_status sn_scene_set_anisotropy(sn_scene *s, int32_t i_muscle, const sn_anisotropy *a, sn_error *err)
{
    sn_status st = sn_scene_check_muscle(s, i_muscle, err);
    if (st) return st;
    scene_muscle *m = s->muscle[i_muscle];
    sn_anisotropy old = m->muscle.anisotropy;
    st = sn_muscle_set_anisotropy(&m->muscle, a, err);
    if (st || same_tensor(&old, a)) return st;
    m->has_paths = m->has_tensor = m->is_solved = s->is_quick = false;
    m->is_edited = true;
    s->revision++;
    return SN_OK;
}

sn_status sn_scene_set_pennation(sn_scene *s, int32_t i_muscle, const sn_pennation *p, sn_error *err)
{
    sn_status st = sn_scene_check_muscle(s, i_muscle, err);
    if (!st) st = sn_muscle_set_pennation(&s->muscle[i_muscle]->muscle, p, err);
    if (!st) s->revision++;
    return st;
}

sn_status sn_scene_set_tendon(sn_scene *s, int32_t i_muscle, const sn_tendon *t, sn_error *err)
{
    sn_status st = sn_scene_check_muscle(s, i_muscle, err);
    if (!st) st = sn_muscle_set_tendon(&s->muscle[i_muscle]->muscle, t, err);
    if (!st) s->revision++;
    return st;
}

sn_status sn_scene_need_paths(scene_muscle *m, sn_error *err)
{
    if (m->has_paths) return SN_OK;
    sn_status st = sn_paths_build(&m->paths, &m->muscle, err);
    m->has_paths = st == SN_OK;
    return st;
}

sn_status sn_scene_muscle_paths(sn_scene *s, int32_t i_muscle, const sn_paths **paths, sn_error *err)
{
    sn_status st = sn_scene_check_muscle(s, i_muscle, err);
    if (!st) st = sn_scene_need_paths(s->muscle[i_muscle], err);
    if (!st) *paths = &s->muscle[i_muscle]->paths;
    return st;
}
