#include "field/attachment.h"

#include "base/alloc.h"
#include "base/array.h"

typedef struct contact { /* a face of bone, or the part of it that the muscle covers */
    int32_t i_bone, head;
    double area, progress; /* progress of the nearest place of the curves, 0..1 */
    sn_vec3 centroid;
} contact;

typedef struct contacts {
    contact *item;
    size_t n, cap;
} contacts;

static sn_status find_contacts(const sn_body *b, const sn_measure *m, const sn_paths *paths, contacts *out,
                               sn_error *err)
{
    for (size_t h = 0; h < 4 * (size_t)b->mesh.n_tet; h++) {
        sn_vec3 centroid = {0};
        if (sn_body_bone(b, b->across[h]) < 0) continue;
        double area = sn_measure_face_area(m, (int32_t)(h >> 2), (int)(h & 3), 1.0, &centroid);
        if (!(area > 0.0)) continue;
        if (!sn_grow(&out->item, &out->cap, out->n + 1, sizeof *out->item))
            return sn_fail(err, SN_ENOMEM, "attachments: no memory");
        sn_curve_place at = sn_paths_place(paths, centroid);
        out->item[out->n++] = (contact){sn_body_bone(b, b->across[h]), at.head, area,
                                        at.arc / paths->head[at.head].length, centroid};
    }
    return SN_OK;
}

static bool is_near_end(const contact *c, int32_t head, bool at_origin, bool is_shared)
{
    if (!is_shared && c->head != head) return false;
    return at_origin ? c->progress <= SN_ATTACHMENT_REACH : c->progress >= 1.0 - SN_ATTACHMENT_REACH;
}

static sn_attachment patch_at(const contacts *all, sn_vec3 end, int32_t head, bool at_origin, bool is_shared)
{
    sn_attachment a = {.i_bone = -1, .distance = INFINITY};
    for (size_t i = 0; i < all->n; i++) {
        const contact *c = &all->item[i];
        if (!is_near_end(c, head, at_origin, is_shared) || sn_v3_dist(c->centroid, end) >= a.distance)
            continue;
        a.distance = sn_v3_dist(c->centroid, end);
        a.i_bone = c->i_bone;
    }
    for (size_t i = 0; i < all->n; i++) {
        const contact *c = &all->item[i];
        if (c->i_bone != a.i_bone || !is_near_end(c, head, at_origin, is_shared)) continue;
        a.area += c->area;
        a.centroid = sn_v3_mad(a.centroid, c->area, c->centroid);
    }
    if (a.area > 0.0) a.centroid = sn_v3_scale(1.0 / a.area, a.centroid);
    return a;
}

/* The corner of a bone's surface nearest to the end. */
static sn_attachment nearest_bone(const sn_body *b, sn_vec3 end)
{
    sn_attachment a = {.i_bone = -1, .distance = INFINITY, .centroid = end};
    for (size_t h = 0; h < 4 * (size_t)b->mesh.n_tet; h++) {
        if (sn_body_bone(b, b->across[h]) < 0) continue;
        for (int k = 0; k < 3; k++) {
            sn_vec3 p =
                sn_tet_mesh_point(&b->mesh, b->mesh.tet[(h & ~(size_t)3) + (size_t)sn_tet_face[h & 3][k]]);
            if (sn_v3_dist(p, end) >= a.distance) continue;
            a = (sn_attachment){sn_body_bone(b, b->across[h]), 0.0, p, sn_v3_dist(p, end)};
        }
    }
    if (a.i_bone < 0) a.distance = 0.0;
    return a;
}

sn_status sn_attachments_find(const sn_body *body, const sn_measure *m, const sn_muscle *muscle,
                              const sn_paths *paths, sn_attachment *out, sn_error *err)
{
    contacts all = {0};
    sn_shared_end shared = sn_muscle_shared_end(muscle);
    sn_status st = find_contacts(body, m, paths, &all, err);
    for (int32_t h = 0; h < paths->n_head && !st; h++)
        for (int k = 0; k < 2; k++) {
            const sn_path *p = &paths->head[h];
            sn_vec3 end = p->point[k ? SN_PATH_STEPS : 0];
            bool is_shared = shared == (k ? SN_SHARE_INSERTION : SN_SHARE_ORIGIN);
            sn_attachment *a = &out[2 * h + k];
            *a = patch_at(&all, end, h, k == 0, is_shared);
            if (a->i_bone < 0) *a = nearest_bone(body, end);
        }
    sn_release(all.item);
    return st;
}
