/* Some tissues solved together by a system: half solves, the change of the matrix since its factor, and what
 * of it is worth going back for. */
#include "base/alloc.h"
#include "field/tissue_private.h"

#include <string.h>

typedef struct block_job {
    const sn_tissue_solver *s;
    const sn_tissue_system *system;
    const tissue_block *b;
    double *cover;
    tissue_rhs rhs;
    sn_half_solve *z;
    double *factor, *seen; /* terms x n: see low_rank.h           */
    double *select;        /* n x n_go                            */
    int32_t *go, n_go;     /* columns that are solved to the end  */
    double **out;          /* n_go: where to                      */
} block_job;

static void free_job(block_job *j)
{
    sn_tissue_rhs_free(&j->rhs);
    sn_half_solve_destroy(j->z);
    sn_release(j->factor);
    sn_release(j->seen);
    sn_release(j->select);
    sn_release(j->go);
    sn_release(j->out);
}

static sn_status init_job(block_job *j, sn_error *err)
{
    size_t n = (size_t)j->b->n, terms = (size_t)sn_low_rank_width(j->system->change);
    sn_status st = sn_tissue_rhs_init(&j->rhs, j->s, j->b->tissue, j->b->n, err);
    j->factor = SN_NEW(double, terms *n);
    j->seen = SN_NEW(double, terms *n);
    j->select = SN_NEW_ZERO(double, n *n);
    j->go = SN_NEW(int32_t, n);
    j->out = SN_NEW(double *, n);
    if (st || (j->factor && j->seen && j->select && j->go && j->out)) return st;
    return sn_fail(err, SN_ENOMEM, "tissue: no memory for %d fields", j->b->n);
}

static sn_status go_forward(block_job *j, const sn_run *run, sn_error *err)
{
    const sn_sparse_vectors b = {j->rhs.n, j->rhs.ptr, j->rhs.index, j->rhs.value};
    sn_status st = sn_half_solve_create(&j->z, j->system->cholesky, &b, run, err);
    if (st) return st;
    return sn_low_rank_factor(j->system->change, j->z, j->b->n, j->factor, j->seen, err);
}

/* ---- quick: what is worth going back for ---- */

/* How far a field is off where its matrix and the one of now differ: elsewhere it is less, as the difference
 * of two fields is harmonic there. */
static double worst_seen(const block_job *j, int32_t column)
{
    const sn_sparse_vectors u = sn_low_rank_vectors(j->system->change);
    const double *now = j->seen + (size_t)column * (size_t)u.n;
    int32_t tissue = j->b->tissue[column];
    const double *field = j->b->field + (size_t)tissue * (size_t)j->s->body->mesh.n_vert;
    double worst = 0.0;
    for (int32_t k = 0; k < u.n; k++) {
        double was = 0.0;
        for (int32_t e = u.ptr[k]; e < u.ptr[k + 1]; e++)
            was += u.value[e] * (tissue == 0 ? j->cover[u.index[e]] : field[j->s->vertex_of[u.index[e]]]);
        worst = fmax(worst, fabs(now[k] - was));
    }
    return tissue == 0 ? j->b->fat * worst : worst;
}

static void choose(block_job *j)
{
    const sn_tissue_quick *q = j->b->quick;
    for (int32_t c = 0; c < j->b->n; c++) {
        int32_t tissue = j->b->tissue[c];
        bool is_kept = q && j->b->stamp && j->system->can_see && !q->is_edited[tissue] &&
                       worst_seen(j, c) <= q->tolerance;
        if (q) q->was_kept[tissue] = is_kept;
        if (!is_kept) j->go[j->n_go++] = c;
    }
}

/* ---- back ---- */

/* Chosen columns come first. */
static sn_status go_back(block_job *j, const sn_run *run, sn_error *err)
{
    size_t n = (size_t)j->b->n, terms = (size_t)sn_low_rank_width(j->system->change);
    bool is_all = j->n_go == j->b->n;
    for (size_t k = 0; k < (size_t)j->n_go; k++) {
        size_t c = (size_t)j->go[k];
        int32_t tissue = j->b->tissue[c];
        j->select[k * n + c] = 1.0;
        if (k != c && terms > 0) memcpy(j->factor + k * terms, j->factor + c * terms, terms * sizeof(double));
        j->out[k] = j->b->field + (size_t)tissue * (size_t)j->s->body->mesh.n_vert;
    }
    const sn_half_term term[2] = {{j->z, is_all ? NULL : j->select},
                                  {sn_low_rank_half(j->system->change), j->factor}};
    return sn_half_solve_finish(term, terms > 0 ? 2 : 1, j->n_go, j->out, j->s->vertex_of, run, err);
}

/* max |A x - b| / max |b| of the sum of all columns with signs: one product for all. */
static sn_status find_residual(const block_job *j, double *residual, sn_error *err)
{
    size_t n = (size_t)j->s->n_free;
    double *x = SN_NEW(double, n), *r = SN_NEW(double, n), worst = 0.0, largest = 0.0;
    if (!x || !r) {
        sn_release(x);
        sn_release(r);
        return sn_fail(err, SN_ENOMEM, "tissue: no memory for %zu rows", n);
    }
    memset(x, 0, n * sizeof *x);
    for (int32_t k = 0; k < j->n_go; k++)
        for (size_t u = 0; u < n; u++) x[u] += (k % 2 ? -1.0 : 1.0) * j->out[k][j->s->vertex_of[u]];
    memset(r, 0, n * sizeof *r);
    for (int32_t k = 0; k < j->n_go; k++)
        for (int32_t e = j->rhs.ptr[j->go[k]]; e < j->rhs.ptr[j->go[k] + 1]; e++)
            r[j->rhs.index[e]] -= (k % 2 ? -1.0 : 1.0) * j->rhs.value[e];
    for (size_t u = 0; u < n; u++) largest = fmax(largest, fabs(r[u]));
    sn_cholesky_add_product(j->system->cholesky, x, r);
    sn_low_rank_add_product(j->system->change, x, r);
    for (size_t u = 0; u < n; u++) worst = fmax(worst, fabs(r[u]));
    *residual = largest > 0.0 ? worst / largest : worst;
    sn_release(x);
    sn_release(r);
    return SN_OK;
}

/* What the solution on the unknowns leaves to be done: the skin, and fat from the cover. */
static void complete(const block_job *j)
{
    const sn_tissue_solver *s = j->s;
    for (int32_t k = 0; k < j->n_go; k++) {
        int32_t tissue = j->b->tissue[j->go[k]];
        double *f = j->out[k];
        for (int32_t v = 0; v < s->body->mesh.n_vert; v++)
            if (s->number[v] < 0) f[v] = 0.0;
        for (int32_t u = 0; tissue == 0 && u < s->n_free; u++) j->cover[u] = f[s->vertex_of[u]];
        if (tissue == 0) sn_tissue_put_fat(s, j->b->fat, f);
        if (j->b->stamp) j->b->stamp[tissue] = s->revision;
    }
}

sn_status sn_tissue_solve_block(const sn_tissue_solver *s, const sn_tissue_system *system,
                                const tissue_block *b, double *cover, const sn_run *run, double *residual,
                                int32_t *n_solved, sn_error *err)
{
    block_job j = {.s = s, .system = system, .b = b, .cover = cover};
    sn_status st = init_job(&j, err);
    if (!st) st = go_forward(&j, run, err);
    if (!st) choose(&j);
    if (!st && j.n_go > 0) st = go_back(&j, run, err);
    if (!st && j.n_go > 0 && residual) st = find_residual(&j, residual, err);
    if (!st) complete(&j);
    *n_solved = j.n_go;
    free_job(&j);
    return st;
}
