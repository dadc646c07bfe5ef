#include "field/tissue.h"

#include "base/alloc.h"
#include "field/cholesky.h"
#include "field/tissue_private.h"

#include <string.h>

#define BLOCK 64 /* right-hand sides solved together: bounds the memory, wide enough for BLAS */

/* Vertices of skin faces are fixed; the rest are numbered. */
static sn_status number_unknowns(sn_tissue_solver *s, sn_error *err)
{
    const sn_tet_mesh *m = &s->body->mesh;
    s->number = SN_NEW_ZERO(int32_t, m->n_vert);
    if (!s->number) return sn_fail(err, SN_ENOMEM, "tissue: no memory");
    for (size_t h = 0; h < 4 * (size_t)m->n_tet; h++) {
        if (s->body->across[h] != -1 - SN_LABEL_SKIN) continue;
        for (int k = 0; k < 3; k++) s->number[m->tet[(h & ~(size_t)3) + (size_t)sn_tet_face[h & 3][k]]] = -1;
    }
    for (int32_t v = 0; v < m->n_vert; v++)
        if (s->number[v] >= 0) s->number[v] = s->n_free++;
    if (s->n_free > 0) return SN_OK;
    return sn_fail(err, SN_ESOLVE,
                   "the tet mesh has no vertex off the skin: mesh with a smaller edge length");
}

static sn_status copy_pattern(sn_csr *out, const sn_csr *a, sn_error *err)
{
    size_t nnz = (size_t)a->ptr[a->n];
    out->n = a->n;
    out->ptr = SN_NEW(int64_t, (size_t)a->n + 1);
    out->idx = SN_NEW(int32_t, nnz);
    out->val = SN_NEW(double, nnz);
    if (!out->ptr || !out->idx || !out->val) return sn_fail(err, SN_ENOMEM, "tissue: no memory");
    memcpy(out->ptr, a->ptr, ((size_t)a->n + 1) * sizeof *a->ptr);
    memcpy(out->idx, a->idx, nnz * sizeof *a->idx);
    return SN_OK;
}

sn_status sn_tissue_solver_create(sn_tissue_solver **out, const sn_body *body, const sn_run *run,
                                  sn_error *err)
{
    *out = NULL;
    sn_tissue_solver *s = SN_NEW_ZERO(sn_tissue_solver, 1);
    if (!s) return sn_fail(err, SN_ENOMEM, "tissue: no memory");
    s->body = body;
    double start = sn_clock();
    sn_status st = number_unknowns(s, err);
    if (!st) st = sn_laplacian_build(&s->laplacian, &s->assembly, &body->mesh, body->size, run, err);
    if (!st) st = copy_pattern(&s->matrix, &s->laplacian, err);
    s->report.seconds_assembly = sn_clock() - start;
    s->report.unknowns = s->n_free;
    start = sn_clock();
    if (!st) st = sn_cholesky_create(&s->cholesky, &s->laplacian, s->number, s->n_free, run, err);
    s->report.seconds_analysis = sn_clock() - start;
    if (st)
        sn_tissue_solver_destroy(s);
    else
        *out = s;
    return st;
}

void sn_tissue_solver_destroy(sn_tissue_solver *s)
{
    if (!s) return;
    for (int32_t i = 0; i < s->n_room; i++) sn_tissue_close_room(s->room[i]);
    sn_release(s->room);
    sn_cholesky_destroy(s->cholesky);
    sn_csr_free(&s->laplacian);
    sn_csr_free(&s->matrix);
    sn_assembly_free(&s->assembly);
    sn_release(s->number);
    sn_release(s);
}

/* Adds alpha B'B; a row of B touches the four corners of one tet, so it stays in the pattern of L. */
void sn_tissue_add_rows(const sn_tissue_solver *s, sn_csr *matrix)
{
    const sn_tet_mesh *m = &s->body->mesh;
    for (int32_t i = 0; i < s->n_muscle; i++)
        for (int32_t r = 0; r < s->muscle[i].row->n_row; r++) {
            const int32_t *v = m->tet + 4 * (size_t)s->muscle[i].row->tet[r];
            const double *w = s->muscle[i].row->bary + 4 * (size_t)r;
            for (int a = 0; a < 4; a++)
                for (int b = 0; b < 4; b++)
                    matrix->val[sn_csr_find(matrix, v[a], v[b])] += s->alpha * w[a] * w[b];
        }
}

sn_status sn_tissue_solver_set_curves(sn_tissue_solver *s, const sn_tissue_muscle *muscle, int32_t n_muscle,
                                      double alpha, sn_error *err)
{
    if (!(alpha > 0.0 && isfinite(alpha))) return sn_fail(err, SN_EINVAL, "alpha is %g, need > 0", alpha);
    s->has_curves = true;
    s->has_factor = false;
    s->muscle = muscle;
    s->n_muscle = n_muscle;
    s->alpha = alpha;
    s->report.collocation_points = 0;
    for (int32_t i = 0; i < n_muscle; i++) s->report.collocation_points += muscle[i].row->n_row;
    return SN_OK;
}

static sn_status need_factor(sn_tissue_solver *s, const sn_run *run, sn_error *err)
{
    if (s->has_factor) return SN_OK;
    double start = sn_clock();
    memcpy(s->matrix.val, s->laplacian.val, (size_t)s->laplacian.ptr[s->laplacian.n] * sizeof(double));
    sn_tissue_add_rows(s, &s->matrix);
    sn_status st = sn_cholesky_factorize(s->cholesky, &s->matrix, run, err);
    s->report.seconds_factor = sn_clock() - start;
    s->report.factor_entries = sn_cholesky_factor_entries(s->cholesky);
    s->has_factor = st == SN_OK;
    return st;
}

/* b = alpha B' d_i on the unknowns: the skin value of a muscle is 0. */
void sn_tissue_muscle_rhs(const sn_tissue_solver *s, int32_t i, double *b)
{
    const sn_collocation *c = s->muscle[i].row;
    memset(b, 0, (size_t)s->n_free * sizeof *b);
    for (int32_t r = 0; r < c->n_row; r++)
        for (int k = 0; k < 4; k++) {
            int32_t u = s->number[s->body->mesh.tet[4 * (size_t)c->tet[r] + (size_t)k]];
            if (u >= 0) b[u] += s->alpha * c->bary[4 * (size_t)r + (size_t)k] * c->value[r];
        }
}

/* b = - (L + alpha B'B) restricted to unknown rows and skin columns, times d_fat. */
static void fat_rhs(const sn_tissue_solver *s, double fat, double *b)
{
    for (int32_t v = 0; v < s->matrix.n; v++) {
        if (s->number[v] < 0) continue;
        double sum = 0.0;
        for (int64_t k = s->matrix.ptr[v]; k < s->matrix.ptr[v + 1]; k++)
            if (s->number[s->matrix.idx[k]] < 0) sum += s->matrix.val[k];
        b[s->number[v]] = -fat * sum;
    }
}

static void tissue_rhs(const sn_tissue_solver *s, int32_t tissue, double fat, double *b)
{
    if (tissue == 0)
        fat_rhs(s, fat, b);
    else
        sn_tissue_muscle_rhs(s, tissue - 1, b);
}

/* max |A x - b| / max |b| for one tissue whose field is whole (skin values in place). b: room for n_free. */
double sn_tissue_residual(const sn_tissue_solver *s, const sn_csr *matrix, int32_t tissue, double fat,
                          const double *field, double *b)
{
    double worst = 0.0, largest = 0.0;
    tissue_rhs(s, tissue, fat, b);
    for (int32_t v = 0; v < matrix->n; v++) {
        if (s->number[v] < 0) continue;
        double sum = -b[s->number[v]];
        for (int64_t k = matrix->ptr[v]; k < matrix->ptr[v + 1]; k++)
            if (s->number[matrix->idx[k]] >= 0) sum += matrix->val[k] * field[matrix->idx[k]];
        worst = fmax(worst, fabs(sum));
        largest = fmax(largest, fabs(b[s->number[v]]));
    }
    return largest > 0.0 ? worst / largest : worst;
}

void sn_tissue_put_field(const sn_tissue_solver *s, int32_t tissue, double fat, const double *x,
                         double *field)
{
    size_t n_vert = (size_t)s->body->mesh.n_vert;
    double *f = field + (size_t)tissue * n_vert;
    for (size_t v = 0; v < n_vert; v++) f[v] = s->number[v] >= 0 ? x[s->number[v]] : tissue == 0 ? fat : 0.0;
}

static sn_status solve_block(sn_tissue_solver *s, const int32_t *tissue, int32_t n, double fat,
                             const sn_run *run, double *x, double *field, sn_error *err)
{
    size_t n_vert = (size_t)s->body->mesh.n_vert;
    int threads = sn_run_threads(run);
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
    for (int32_t k = 0; k < n; k++) tissue_rhs(s, tissue[k], fat, x + (size_t)k * (size_t)s->n_free);
    sn_status st = sn_cholesky_solve(s->cholesky, x, n, run, err);
    if (st) return st;
    double worst = 0.0;
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads) reduction(max : worst)
    for (int32_t k = 0; k < n; k++) {
        double *b = x + (size_t)k * (size_t)s->n_free;
        sn_tissue_put_field(s, tissue[k], fat, b, field);
        worst = fmax(
            worst, sn_tissue_residual(s, &s->matrix, tissue[k], fat, field + (size_t)tissue[k] * n_vert, b));
    }
    s->report.residual = fmax(s->report.residual, worst);
    return SN_OK;
}

sn_status sn_tissue_solver_solve(sn_tissue_solver *s, double fat, const bool *wanted, const sn_run *run,
                                 double *field, sn_error *err)
{
    if (!(fat >= 0.0 && isfinite(fat))) return sn_fail(err, SN_EINVAL, "fat is %g, need >= 0", fat);
    if (!s->has_curves) return sn_fail(err, SN_EINVAL, "tissue: no curves set");
    int32_t n = 0, n_tissue = s->n_muscle + 1;
    int32_t *tissue = SN_NEW(int32_t, n_tissue);
    if (!tissue) return sn_fail(err, SN_ENOMEM, "tissue: no memory for %d fields", n_tissue);
    for (int32_t i = 0; i < n_tissue; i++)
        if (!wanted || wanted[i]) tissue[n++] = i;
    s->report.residual = s->report.seconds_solve = 0.0;
    s->report.n_solved = n;
    sn_status st = n > 0 ? need_factor(s, run, err) : SN_OK;
    double start = sn_clock();
    double *x = SN_NEW(double, (size_t)(n < BLOCK ? n : BLOCK) * (size_t)s->n_free);
    if (!st && !x) st = sn_fail(err, SN_ENOMEM, "tissue: no memory for %d fields", n);
    for (int32_t first = 0; !st && first < n; first += BLOCK) {
        st = sn_run_step(run, "solving", (double)first / n, err);
        if (!st)
            st = solve_block(s, tissue + first, n - first < BLOCK ? n - first : BLOCK, fat, run, x, field,
                             err);
    }
    s->report.seconds_solve = sn_clock() - start;
    sn_release(x);
    sn_release(tissue);
    return st;
}

sn_status sn_tissue_solver_harmonic(const sn_tissue_solver *s, sn_harmonic **out, const sn_run *run,
                                    sn_error *err)
{
    return sn_harmonic_create(out, &s->laplacian, s->number, s->n_free, s->cholesky, run, err);
}

const sn_tissue_report *sn_tissue_solver_report(const sn_tissue_solver *s)
{
    return &s->report;
}
