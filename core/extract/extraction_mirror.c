#include "extract/extraction_mirror.h"

#include "base/alloc.h"
#include "base/side_name.h"
#include "muscle/muscle_mirror.h"

#include <string.h>

typedef struct mirror {
    const sn_extraction *x;
    sn_plane plane;
    double near;    /* counts as on the plane                                           */
    int32_t *image; /* n_vert: the vertex that is its image, itself on the plane        */
    int32_t *twin;  /* n_tissue of x: the tissue that its image belongs to              */
    int32_t n_vert; /* of the whole                                                     */
} mirror;

static sn_status no_memory(const mirror *m, sn_error *err)
{
    return sn_fail(err, SN_ENOMEM, "mirror: no memory for %d tets", m->x->mesh.n_tet);
}

static sn_status check_half(const sn_extraction *x, sn_error *err)
{
    if (x->half.n_tet > 0) return sn_fail(err, SN_EINVAL, "mirror: the extraction is mirrored already");
    if (x->mesh.n_tet < 1) return sn_fail(err, SN_EINVAL, "mirror: the extraction has no tets");
    if (x->mesh.n_tet > INT32_MAX / 2 || x->mesh.n_vert > INT32_MAX / 2)
        return sn_fail(err, SN_ELIMIT, "mirror: twice %d tets are more than 2^31", x->mesh.n_tet);
    if (x->n_muscle != 0 && x->n_muscle != x->n_tissue - 1)
        return sn_fail(err, SN_EINVAL, "mirror: muscles of %d tissues are known, need %d or none",
                       x->n_muscle, x->n_tissue - 1);
    return SN_OK;
}

/* ---- vertices ---- */

/* How far the half reaches to both sides; refuses one that reaches to both. */
static sn_status check_sides(const mirror *m, sn_error *err)
{
    const sn_tet_mesh *mesh = &m->x->mesh;
    int32_t lowest = 0, highest = 0;
    double low = INFINITY, high = -INFINITY;
    for (int32_t v = 0; v < mesh->n_vert; v++) {
        double h = sn_plane_height(&m->plane, sn_tet_mesh_point(mesh, v));
        if (h < low) low = h, lowest = v;
        if (h > high) high = h, highest = v;
    }
    double beyond = fmin(-low, high);
    if (!(beyond > m->near)) return SN_OK;
    return sn_fail(err, SN_EINVAL,
                   "mirror: vertex %d lies %g beyond the plane: a half must lie on one side of it",
                   1 + (high < -low ? highest : lowest), beyond);
}

static bool is_on(const mirror *m, int32_t v)
{
    return m->image[v] == v;
}

/* A half that only touches the plane, or does not reach it, would not be joined. */
static sn_status check_joint(const mirror *m, sn_error *err)
{
    const sn_tet_mesh *mesh = &m->x->mesh;
    bool has_face = false;
    double least = INFINITY;
    for (int32_t t = 0; t < mesh->n_tet; t++) {
        const int32_t *v = mesh->tet + 4 * (size_t)t;
        int n_on = is_on(m, v[0]) + is_on(m, v[1]) + is_on(m, v[2]) + is_on(m, v[3]);
        has_face = has_face || n_on == 3;
        if (n_on == 4) return sn_fail(err, SN_EMESH, "mirror: tet %d lies flat in the plane", t + 1);
    }
    if (has_face) return SN_OK;
    for (int32_t v = 0; v < mesh->n_vert; v++)
        least = fmin(least, fabs(sn_plane_height(&m->plane, sn_tet_mesh_point(mesh, v))));
    return sn_fail(err, SN_EINVAL,
                   "mirror: the half has no face in the plane, its nearest vertex is %g from it", least);
}

static sn_status number_images(mirror *m, sn_error *err)
{
    const sn_tet_mesh *mesh = &m->x->mesh;
    m->image = SN_NEW(int32_t, mesh->n_vert);
    if (!m->image) return no_memory(m, err);
    m->n_vert = mesh->n_vert;
    for (int32_t v = 0; v < mesh->n_vert; v++) {
        double h = sn_plane_height(&m->plane, sn_tet_mesh_point(mesh, v));
        m->image[v] = fabs(h) <= m->near ? v : m->n_vert++;
    }
    return check_joint(m, err);
}

/* ---- tissues ---- */

/* The half's names, then those of new tissues; finds the twins. */
static sn_status make_names(mirror *m, sn_extraction *out, sn_error *err)
{
    const sn_extraction *x = m->x;
    m->twin = SN_NEW(int32_t, x->n_tissue);
    out->name = SN_NEW_ZERO(char *, 2 * (size_t)x->n_tissue);
    if (!m->twin || !out->name) return no_memory(m, err);
    for (int32_t i = 0; i < x->n_tissue; i++) {
        out->name[i] = sn_strdup(x->name[i]);
        out->n_tissue = i + 1;
        if (!out->name[i]) return no_memory(m, err);
    }
    for (int32_t i = 0; i < x->n_tissue; i++) {
        size_t size = strlen(x->name[i]) + SN_SIDE_NAME_EXTRA;
        char *other = SN_NEW(char, size);
        if (!other) return no_memory(m, err);
        (void)sn_side_name_swap(x->name[i], other, size);
        m->twin[i] = sn_extraction_find(x, other);
        if (m->twin[i] >= 0) {
            sn_release(other);
        } else {
            m->twin[i] = out->n_tissue;
            out->name[out->n_tissue++] = other;
        }
    }
    return SN_OK;
}

static sn_status make_muscles(const mirror *m, sn_extraction *out, sn_error *err)
{
    const sn_extraction *x = m->x;
    if (x->n_muscle == 0) return SN_OK;
    out->muscle = SN_NEW_ZERO(sn_muscle, out->n_tissue);
    if (!out->muscle) return no_memory(m, err);
    out->n_muscle = out->n_tissue - 1;
    for (int32_t i = 1; i < x->n_tissue; i++) {
        const sn_muscle *from = &x->muscle[i - 1];
        int32_t twin = m->twin[i];
        sn_status st = sn_muscle_copy(&out->muscle[i - 1], from, err);
        if (!st && twin >= x->n_tissue)
            st = sn_muscle_mirror(&out->muscle[twin - 1], from, &m->plane, out->name[twin], err);
        if (st) return st;
    }
    return SN_OK;
}

/* ---- the whole ---- */

static sn_status make_arrays(const mirror *m, sn_extraction *out, sn_error *err)
{
    int32_t n_tet = 2 * m->x->mesh.n_tet;
    sn_status st = sn_tet_mesh_reserve(&out->mesh, m->n_vert, n_tet, true, err);
    if (st) return sn_fail_prefix(err, st, "mirror: ");
    out->source = SN_NEW(int32_t, n_tet);
    out->envelope = SN_NEW(double, m->n_vert);
    return out->source && out->envelope ? SN_OK : no_memory(m, err);
}

static void fill_vertices(const mirror *m, sn_extraction *out)
{
    const sn_extraction *x = m->x;
    for (int32_t v = 0; v < x->mesh.n_vert; v++) {
        sn_vec3 p = sn_tet_mesh_point(&x->mesh, v);
        if (is_on(m, v)) p = sn_plane_project(&m->plane, p);
        sn_v3_store(out->mesh.pos + 3 * (size_t)v, p);
        if (!is_on(m, v))
            sn_v3_store(out->mesh.pos + 3 * (size_t)m->image[v], sn_plane_reflect(&m->plane, p));
        out->envelope[v] = out->envelope[m->image[v]] = x->envelope[v];
    }
}

static void fill_tets(const mirror *m, sn_extraction *out)
{
    const sn_extraction *x = m->x;
    for (int32_t t = 0; t < x->mesh.n_tet; t++) {
        int32_t image = x->mesh.n_tet + t;
        const int32_t *v = x->mesh.tet + 4 * (size_t)t;
        const int32_t turned[4] = {m->image[v[0]], m->image[v[1]], m->image[v[3]], m->image[v[2]]};
        memcpy(out->mesh.tet + 4 * (size_t)t, v, sizeof turned);
        memcpy(out->mesh.tet + 4 * (size_t)image, turned, sizeof turned);
        out->mesh.part[t] = x->mesh.part[t];
        out->mesh.part[image] = m->twin[x->mesh.part[t]];
        out->source[t] = out->source[image] = x->source[t];
    }
}

/* Moving a vertex onto the plane could turn a tet over that is thinner than the move is long. */
static sn_status check_positive(const mirror *m, const sn_extraction *out, sn_error *err)
{
    for (int32_t t = 0; t < out->mesh.n_tet; t++)
        if (!(sn_tet_mesh_tet_volume(&out->mesh, t) > 0.0))
            return sn_fail(err, SN_EMESH, "mirror: tet %d is too thin to be kept", 1 + t % m->x->mesh.n_tet);
    return SN_OK;
}

static void fill_rest(const mirror *m, sn_extraction *out)
{
    const sn_extraction *x = m->x;
    out->input_volume = 2.0 * x->input_volume;
    out->n_moved = 2 * x->n_moved;
    out->largest_move = x->largest_move;
    out->half = (sn_extraction_half){m->plane, x->mesh.n_vert, x->mesh.n_tet, x->n_tissue, x->n_muscle};
}

sn_status sn_extraction_mirror(const sn_extraction *x, sn_vec3 point, sn_vec3 normal, const sn_run *run,
                               sn_extraction *out, sn_error *err)
{
    mirror m = {.x = x};
    double start = sn_clock();
    sn_extraction_free(out);
    sn_status st = sn_plane_make(&m.plane, "mirror", point, normal, err);
    if (!st) st = sn_run_step(run, "mirroring", 0.0, err);
    if (!st) st = check_half(x, err);
    m.near = SN_PLANE_REL * sn_box3_diagonal(sn_tet_mesh_bounds(&x->mesh));
    if (!st) st = check_sides(&m, err);
    if (!st) st = number_images(&m, err);
    if (!st) st = make_names(&m, out, err);
    if (!st) st = make_muscles(&m, out, err);
    if (!st) st = make_arrays(&m, out, err);
    if (!st) st = sn_run_step(run, "mirroring", 0.5, err);
    if (!st) {
        fill_vertices(&m, out);
        fill_tets(&m, out);
        fill_rest(&m, out);
        st = check_positive(&m, out, err);
    }
    out->seconds = sn_clock() - start;
    sn_release(m.image);
    sn_release(m.twin);
    if (st) sn_extraction_free(out);
    return st;
}

sn_extraction sn_extraction_half_view(const sn_extraction *x)
{
    sn_extraction half = *x;
    half.mesh.n_vert = x->half.n_vert;
    half.mesh.n_tet = x->half.n_tet;
    half.n_tissue = x->half.n_tissue;
    half.n_muscle = x->half.n_muscle;
    half.input_volume = 0.5 * x->input_volume;
    half.n_moved = x->n_moved / 2;
    half.half = (sn_extraction_half){0};
    return half;
}

/* The first tet's image tells: every tissue's tets have all their images in one tissue. */
int32_t sn_extraction_half_tissue(const sn_extraction *x, int32_t tissue, bool is_image)
{
    if (!is_image) return tissue < x->half.n_tissue ? tissue : -1;
    for (int32_t t = 0; t < x->half.n_tet; t++)
        if (x->mesh.part[x->half.n_tet + t] == tissue) return x->mesh.part[t];
    return -1;
}
