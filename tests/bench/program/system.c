#include "system.h"

#include "base/alloc.h"
#include "muscle/collocation.h"

#include <math.h>
#include <string.h>

static sn_status no_memory(sn_error *err)
{
    return sn_fail(err, SN_ENOMEM, "bench: no memory");
}

void bench_system_free(bench_system *s)
{
    sn_release(s->ptr);
    sn_release(s->idx);
    sn_release(s->val);
    sn_release(s->rhs);
    sn_release(s->x);
    sn_release(s->number);
    sn_release(s->vertex);
    sn_csr_free(&s->laplacian);
    sn_csr_free(&s->matrix);
    sn_locator_destroy(s->locator);
    memset(s, 0, sizeof *s);
}

/* ---- what is kept while the mesh is ---- */

static sn_status number_vertices(bench_system *s, sn_error *err)
{
    const sn_tet_mesh *m = &s->body->mesh;
    s->number = SN_NEW_ZERO(int32_t, m->n_vert);
    s->vertex = SN_NEW(int32_t, m->n_vert);
    if (!s->number || !s->vertex) return no_memory(err);
    for (int32_t t = 0; t < m->n_tet; t++)
        for (int face = 0; face < 4; face++) {
            if (s->body->across[4 * (size_t)t + (size_t)face] != -1 - SN_LABEL_SKIN) continue;
            for (int k = 0; k < 3; k++) s->number[m->tet[4 * (size_t)t + (size_t)sn_tet_face[face][k]]] = -1;
        }
    for (int32_t v = 0; v < m->n_vert; v++) {
        if (s->number[v] < 0) continue;
        s->vertex[s->n] = v;
        s->number[v] = s->n++;
    }
    return SN_OK;
}

static sn_status make_pattern(bench_system *s, sn_error *err)
{
    const sn_csr *l = &s->laplacian;
    size_t nnz = (size_t)l->ptr[l->n];
    s->ptr = SN_NEW(int64_t, (size_t)s->n + 1);
    s->idx = SN_NEW(int64_t, nnz);
    s->val = SN_NEW(double, nnz);
    s->matrix.ptr = SN_NEW(int64_t, (size_t)l->n + 1);
    s->matrix.idx = SN_NEW(int32_t, nnz);
    s->matrix.val = SN_NEW(double, nnz);
    if (!s->ptr || !s->idx || !s->val || !s->matrix.ptr || !s->matrix.idx || !s->matrix.val)
        return no_memory(err);
    s->matrix.n = l->n;
    memcpy(s->matrix.ptr, l->ptr, ((size_t)l->n + 1) * sizeof *l->ptr);
    memcpy(s->matrix.idx, l->idx, nnz * sizeof *l->idx);
    return SN_OK;
}

static sn_status start(bench_system *s, const sn_body *body, const sn_run *run, sn_error *err)
{
    sn_assembly assembly = {0};
    s->body = body;
    s->pos = body->mesh.pos;
    sn_status st = number_vertices(s, err);
    if (!st) st = sn_laplacian_build(&s->laplacian, &assembly, &body->mesh, body->size, run, err);
    sn_assembly_free(&assembly);
    if (!st) st = make_pattern(s, err);
    if (!st) st = sn_locator_create(&s->locator, &body->mesh, err);
    return st;
}

/* ---- what the curves change ---- */

static void add_row(bench_system *s, const sn_collocation *c, int32_t row, int32_t i_muscle, double alpha)
{
    const int32_t *v = s->body->mesh.tet + 4 * (size_t)c->tet[row];
    const double *w = c->bary + 4 * (size_t)row;
    double *b = s->rhs + (size_t)(1 + i_muscle) * (size_t)s->n;
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) s->matrix.val[sn_csr_find(&s->matrix, v[i], v[j])] += alpha * w[i] * w[j];
        if (s->number[v[i]] >= 0) b[s->number[v[i]]] += alpha * w[i] * c->value[row];
    }
}

static sn_status add_curves(bench_system *s, const sn_scene *scene, sn_error *err)
{
    double alpha = sn_scene_alpha(scene);
    s->n_row = 0;
    for (int32_t i = 0; i + 1 < s->n_rhs; i++) {
        sn_collocation c = {0};
        sn_status st = sn_collocate(sn_scene_muscle(scene, i), s->body, s->locator, &c, NULL, err);
        for (int32_t row = 0; !st && row < c.n_row; row++) add_row(s, &c, row, i, alpha);
        s->n_row += c.n_row;
        sn_collocation_free(&c);
        if (st) return st;
    }
    return SN_OK;
}

/* The skin's value of fat goes to the right-hand side; that of the muscles is 0. */
static void take_unknowns(bench_system *s, double fat)
{
    int64_t n = 0;
    for (int32_t u = 0; u < s->n; u++) {
        int32_t v = s->vertex[u];
        double on_skin = 0.0;
        s->ptr[u] = n;
        for (int64_t k = s->matrix.ptr[v]; k < s->matrix.ptr[v + 1]; k++) {
            int32_t other = s->number[s->matrix.idx[k]];
            if (other < 0) on_skin += s->matrix.val[k];
            if (other < u) continue;
            s->idx[n] = other;
            s->val[n++] = s->matrix.val[k];
        }
        s->rhs[u] = -fat * on_skin;
    }
    s->ptr[s->n] = n;
}

sn_status bench_system_make(bench_system *out, const sn_scene *scene, const sn_run *run, sn_error *err)
{
    const sn_body *body = sn_scene_body(scene);
    if (!body) return sn_fail(err, SN_EINVAL, "bench: the scene is not meshed");
    if (sn_scene_muscle_count(scene) < 1) return sn_fail(err, SN_EINVAL, "bench: the scene has no muscles");
    if (out->body && (out->pos != body->mesh.pos || out->laplacian.n != body->mesh.n_vert))
        return sn_fail(err, SN_EINVAL, "bench: the scene was meshed again, its systems are to be made anew");
    sn_status st = out->body ? SN_OK : start(out, body, run, err);
    if (st) return st;
    sn_release(out->rhs);
    sn_release(out->x);
    out->n_rhs = 1 + sn_scene_muscle_count(scene);
    size_t n_value = (size_t)out->n * (size_t)out->n_rhs;
    out->rhs = SN_NEW_ZERO(double, n_value);
    out->x = SN_NEW_ZERO(double, n_value);
    if (!out->rhs || !out->x) return no_memory(err);
    memcpy(out->matrix.val, out->laplacian.val,
           (size_t)out->laplacian.ptr[out->laplacian.n] * sizeof(double));
    st = add_curves(out, scene, err);
    if (!st) take_unknowns(out, sn_scene_fat(scene));
    return st;
}

sn_status bench_system_compare(const bench_system *s, const sn_scene *scene, double *difference,
                               sn_error *err)
{
    const double *field = sn_scene_picture_fields(scene);
    if (!field || !s->body || s->n_rhs != sn_scene_tissue_count(scene) || s->body != sn_scene_body(scene))
        return sn_fail(err, SN_EINVAL, "bench: the scene is not solved, or not the one that was assembled");
    double worst = 0.0, largest = 0.0;
    for (int32_t i = 0; i < s->n_rhs; i++) {
        if (i > 0 && sn_scene_muscle(scene, i - 1)->anisotropy.is_on) continue;
        for (int32_t u = 0; u < s->n; u++) {
            double value = field[(size_t)i * (size_t)s->body->mesh.n_vert + (size_t)s->vertex[u]];
            worst = fmax(worst, fabs(value - s->x[(size_t)i * (size_t)s->n + (size_t)u]));
            largest = fmax(largest, fabs(value));
        }
    }
    *difference = largest > 0.0 ? worst / largest : worst;
    return SN_OK;
}
