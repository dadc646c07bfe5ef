#include "field/tissue.h"

#include "base/alloc.h"
#include "field/tissue_private.h"

#include <string.h>

/* A factor of more would not fit into the memory of many machines: some 4 GB. */
#define MOST_UNKNOWNS_DIRECT 1500000
#define BLOCK 64 /* right-hand sides solved together: bounds the memory, wide enough for BLAS */

/* ---- the mesh ---- */

/* Vertices of skin faces are fixed; the rest are numbered. */
static sn_status number_unknowns(sn_tissue_solver *s, sn_error *err)
{
    const sn_tet_mesh *m = &s->body->mesh;
    s->number = SN_NEW_ZERO(int32_t, m->n_vert);
    s->vertex_of = SN_NEW(int32_t, m->n_vert);
    if (!s->number || !s->vertex_of) return sn_fail(err, SN_ENOMEM, "tissue: no memory");
    for (size_t h = 0; h < 4 * (size_t)m->n_tet; h++) {
        if (s->body->across[h] != -1 - SN_LABEL_SKIN) continue;
        for (int k = 0; k < 3; k++) s->number[m->tet[(h & ~(size_t)3) + (size_t)sn_tet_face[h & 3][k]]] = -1;
    }
    for (int32_t v = 0; v < m->n_vert; v++)
        if (s->number[v] >= 0) {
            s->vertex_of[s->n_free] = v;
            s->number[v] = s->n_free++;
        }
    if (s->n_free > 0) return SN_OK;
    return sn_fail(err, SN_ESOLVE,
                   "the tet mesh has no vertex off the skin: mesh with a smaller edge length");
}

static sn_status assemble(sn_tissue_solver *s, const sn_run *run, sn_error *err)
{
    sn_status st = number_unknowns(s, err);
    if (!st) st = sn_laplacian_build(&s->laplacian, &s->assembly, &s->body->mesh, s->body->size, run, err);
    if (st) return st;
    s->matrix = SN_NEW(double, s->laplacian.ptr[s->laplacian.n]);
    s->cover = SN_NEW(double, s->n_free);
    return s->matrix && s->cover ? SN_OK : sn_fail(err, SN_ENOMEM, "tissue: no memory");
}

sn_status sn_tissue_solver_create(sn_tissue_solver **out, const sn_body *body, sn_solver_kind kind,
                                  const sn_run *run, sn_error *err)
{
    *out = NULL;
    sn_tissue_solver *s = SN_NEW_ZERO(sn_tissue_solver, 1);
    if (!s) return sn_fail(err, SN_ENOMEM, "tissue: no memory");
    s->body = body;
    double start = sn_clock();
    sn_status st = assemble(s, run, err);
    s->report.seconds_assembly = sn_clock() - start;
    s->report.unknowns = s->n_free;
    start = sn_clock();
    s->report.is_iterative =
        kind == SN_SOLVER_ITERATIVE || (kind == SN_SOLVER_AUTO && s->n_free > MOST_UNKNOWNS_DIRECT);
    if (!st && !s->report.is_iterative)
        st = sn_cholesky_create(&s->system.cholesky, &s->laplacian, s->number, s->n_free, run, err);
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
    sn_tissue_system_free(&s->system);
    sn_row_set_free(&s->set);
    sn_csr_free(&s->laplacian);
    sn_assembly_free(&s->assembly);
    sn_release(s->matrix);
    sn_release(s->cover);
    sn_release(s->number);
    sn_release(s->vertex_of);
    sn_release(s);
}

/* ---- curves ---- */

static sn_status collect_rows(sn_row_set *set, const sn_tissue_muscle *muscle, int32_t n_muscle,
                              sn_error *err)
{
    size_t n = 0;
    for (int32_t i = 0; i < n_muscle; i++) n += (size_t)muscle[i].row->n_row;
    *set = (sn_row_set){SN_NEW(sn_row, n), 0};
    if (!set->row) return sn_fail(err, SN_ENOMEM, "tissue: no memory for %zu rows", n);
    for (int32_t i = 0; i < n_muscle; i++)
        for (int32_t r = 0; r < muscle[i].row->n_row; r++) {
            sn_row *to = &set->row[set->n++];
            to->tet = muscle[i].row->tet[r];
            memcpy(to->bary, muscle[i].row->bary + 4 * (size_t)r, sizeof to->bary);
        }
    sn_row_set_sort(set);
    return SN_OK;
}

sn_status sn_tissue_solver_set_curves(sn_tissue_solver *s, const sn_tissue_muscle *muscle, int32_t n_muscle,
                                      double alpha, sn_error *err)
{
    sn_row_set set;
    if (!(alpha > 0.0 && isfinite(alpha))) return sn_fail(err, SN_EINVAL, "alpha is %g, need > 0", alpha);
    sn_status st = collect_rows(&set, muscle, n_muscle, err);
    if (st) return st;
    sn_row_set_free(&s->set);
    s->set = set;
    s->revision++;
    s->has_cover = false;
    s->muscle = muscle;
    s->n_muscle = n_muscle;
    s->alpha = alpha;
    s->report.collocation_points = set.n;
    return SN_OK;
}

sn_tissue_rows sn_tissue_rows_of(const sn_tissue_solver *s)
{
    return (sn_tissue_rows){&s->set, s->revision, s->body->mesh.tet, s->number, s->n_free, s->alpha};
}

/* ---- solving ---- */

static void fill_isotropic(const void *user, sn_csr *matrix)
{
    const sn_tissue_solver *s = user;
    memcpy(matrix->val, s->laplacian.val, (size_t)matrix->ptr[matrix->n] * sizeof *matrix->val);
}

static sn_status need_system(sn_tissue_solver *s, bool with_probes, const sn_run *run, sn_error *err)
{
    bool was_factorized;
    double start = sn_clock();
    sn_csr matrix = s->laplacian;
    matrix.val = s->matrix;
    sn_tissue_rows rows = sn_tissue_rows_of(s);
    sn_status st = sn_tissue_system_follow(&s->system, &rows, with_probes, &matrix, fill_isotropic, s, run,
                                           &was_factorized, err);
    s->report.seconds_factor += sn_clock() - start;
    s->report.was_factorized = s->report.was_factorized || was_factorized;
    if (s->system.cholesky) s->report.factor_entries = sn_cholesky_factor_entries(s->system.cholesky);
    if (!st) s->report.n_changed_rows = sn_low_rank_count(s->system.change);
    return st;
}

static sn_status solve_all(sn_tissue_solver *s, tissue_block b, const sn_run *run, sn_error *err)
{
    sn_status st = SN_OK;
    const int32_t *tissue = b.tissue;
    int32_t n = b.n;
    s->report.residual = 0.0;
    s->report.n_solved = s->report.iterations = 0;
    for (int32_t first = 0; !st && first < n; first += BLOCK) {
        double residual = 0.0;
        int32_t n_solved = 0, iterations = 0;
        b.tissue = tissue + first;
        b.n = n - first < BLOCK ? n - first : BLOCK;
        st = sn_run_step(run, "solving", (double)first / n, err);
        if (!st && s->report.is_iterative)
            st = sn_tissue_iterate_block(s, &s->system, &b, s->cover, run, &residual, &iterations, &n_solved,
                                         err);
        else if (!st)
            st = sn_tissue_solve_block(s, &s->system, &b, s->cover, run, &residual, &n_solved, err);
        if (iterations > s->report.iterations) s->report.iterations = iterations;
        s->report.residual = fmax(s->report.residual, residual);
        s->report.n_solved += n_solved;
    }
    return st;
}

/* Once more with a new factor when the change since the old one is to blame for the residual. */
static sn_status solve_checked(sn_tissue_solver *s, tissue_block b, const sn_run *run, sn_error *err)
{
    sn_status st = need_system(s, b.quick != NULL, run, err);
    double start = sn_clock();
    if (!st) st = solve_all(s, b, run, err);
    bool is_lost = !st && s->report.residual > SN_RESIDUAL_TOO_LARGE && s->report.n_changed_rows > 0;
    s->report.seconds_solve += sn_clock() - start;
    if (!is_lost) return st;
    sn_tissue_system_forget(&s->system);
    for (int32_t k = 0; b.quick && k < b.n; k++) b.quick->was_kept[b.tissue[k]] = false;
    b.quick = NULL;
    st = need_system(s, false, run, err);
    start = sn_clock();
    if (!st) st = solve_all(s, b, run, err);
    s->report.seconds_solve += sn_clock() - start;
    return st;
}

sn_status sn_tissue_solver_solve(sn_tissue_solver *s, double fat, const bool *wanted,
                                 const sn_tissue_quick *quick, sn_tissue_stamp *stamp, const sn_run *run,
                                 double *field, sn_error *err)
{
    if (!(fat >= 0.0 && isfinite(fat))) return sn_fail(err, SN_EINVAL, "fat is %g, need >= 0", fat);
    if (s->revision == 0) return sn_fail(err, SN_EINVAL, "tissue: no curves set");
    int32_t n = 0, n_tissue = s->n_muscle + 1;
    int32_t *tissue = SN_NEW(int32_t, n_tissue);
    if (!tissue) return sn_fail(err, SN_ENOMEM, "tissue: no memory for %d fields", n_tissue);
    for (int32_t i = 0; i < n_tissue; i++)
        if (!wanted || wanted[i]) tissue[n++] = i;
    s->report.seconds_factor = s->report.seconds_solve = 0.0;
    s->report.was_factorized = false;
    bool has_fat = n > 0 && tissue[0] == 0;
    if (has_fat) s->has_cover = false;
    sn_status st =
        n > 0 ? solve_checked(s, (tissue_block){tissue, n, fat, quick, stamp, field}, run, err) : SN_OK;
    if (!st && has_fat) s->has_cover = !quick || !quick->was_kept[0];
    s->report.n_kept = n - s->report.n_solved;
    sn_tissue_rows rows = sn_tissue_rows_of(s);
    if (!st && stamp && !s->report.is_iterative)
        st = sn_tissue_system_settle(&s->system, &rows, stamp, n_tissue, err);
    sn_release(tissue);
    return st;
}

/* ---- fat ---- */

void sn_tissue_put_fat(const sn_tissue_solver *s, double fat, double *field)
{
    for (int32_t v = 0; v < s->body->mesh.n_vert; v++)
        field[v] = s->number[v] >= 0 ? fat * (1.0 - s->cover[s->number[v]]) : fat;
}

bool sn_tissue_solver_set_fat(const sn_tissue_solver *s, double fat, double *field)
{
    if (s->has_cover) sn_tissue_put_fat(s, fat, field);
    return s->has_cover;
}

/* ---- what else there is ---- */

bool sn_tissue_solver_has_factor(const sn_tissue_solver *s)
{
    return s->system.cholesky ? sn_cholesky_is_factorized(s->system.cholesky) : s->system.iterative != NULL;
}

sn_status sn_tissue_solver_harmonic(const sn_tissue_solver *s, sn_harmonic **out, const sn_run *run,
                                    sn_error *err)
{
    if (s->report.is_iterative)
        return sn_harmonic_create_iterative(out, &s->laplacian, s->number, s->n_free, err);
    return sn_harmonic_create(out, &s->laplacian, s->number, s->n_free, s->system.cholesky, run, err);
}

const sn_tissue_report *sn_tissue_solver_report(const sn_tissue_solver *s)
{
    return &s->report;
}
