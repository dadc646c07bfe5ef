/* Tissues solved by conjugate gradients, side by side, each from the field of before. */
#include "base/alloc.h"
#include "field/tissue_private.h"

/* Of a field's energy norm: fields are then the direct solver's to 1e-8 of the largest value. Quick ones are
 * good for a picture. */
#define EXACT 1e-11
#define QUICK 1e-5

typedef struct iterate_job {
    const sn_tissue_solver *s;
    const sn_tissue_system *system;
    const tissue_block *b;
    double *cover;
    tissue_rhs rhs;
    sn_iterative_report *report; /* n */
} iterate_job;

static double *row_of(const iterate_job *j, int32_t tissue)
{
    return j->b->field + (size_t)tissue * (size_t)j->s->body->mesh.n_vert;
}

static void guess(const iterate_job *j, int32_t tissue, double *x)
{
    const double *f = row_of(j, tissue);
    bool has_field = j->b->stamp && j->b->stamp[tissue] > 0;
    for (int32_t u = 0; u < j->s->n_free; u++)
        x[u] = !has_field ? 0.0 : tissue == 0 ? j->cover[u] : f[j->s->vertex_of[u]];
}

static void put(const iterate_job *j, int32_t tissue, const double *x)
{
    double *f = row_of(j, tissue);
    for (int32_t u = 0; u < j->s->n_free; u++) f[j->s->vertex_of[u]] = x[u];
    sn_tissue_complete_field(j->s, j->b, j->cover, tissue);
}

static sn_status iterate(void *user, int32_t i, const sn_run *run, sn_error *err)
{
    const iterate_job *j = user;
    int32_t tissue = j->b->tissue[i];
    double *b = SN_NEW_ZERO(double, j->s->n_free), *x = SN_NEW(double, j->s->n_free);
    sn_status st = b && x ? SN_OK : sn_fail(err, SN_ENOMEM, "tissue: no memory for %d rows", j->s->n_free);
    if (!st) {
        guess(j, tissue, x);
        for (int32_t e = j->rhs.ptr[i]; e < j->rhs.ptr[i + 1]; e++) b[j->rhs.index[e]] += j->rhs.value[e];
        st = sn_iterative_solve(j->system->iterative, b, x, j->b->quick ? QUICK : EXACT, run, &j->report[i],
                                err);
    }
    if (!st) put(j, tissue, x);
    sn_release(b);
    sn_release(x);
    return st;
}

sn_status sn_tissue_iterate_block(const sn_tissue_solver *s, const sn_tissue_system *system,
                                  const tissue_block *b, double *cover, const sn_run *run, double *residual,
                                  int32_t *iterations, int32_t *n_solved, sn_error *err)
{
    iterate_job j = {
        .s = s, .system = system, .b = b, .cover = cover, .report = SN_NEW_ZERO(sn_iterative_report, b->n)};
    sn_status st = sn_tissue_rhs_init(&j.rhs, s, b->tissue, b->n, err);
    if (!st && !j.report) st = sn_fail(err, SN_ENOMEM, "tissue: no memory for %d fields", b->n);
    if (!st) st = sn_run_each(run, b->n, iterate, &j, err);
    *residual = 0.0;
    *iterations = 0;
    for (int32_t i = 0; !st && i < b->n; i++) {
        *residual = fmax(*residual, j.report[i].residual);
        if (j.report[i].iterations > *iterations) *iterations = j.report[i].iterations;
        if (b->quick) b->quick->was_kept[b->tissue[i]] = true; /* not to the last digit */
    }
    *n_solved = b->n;
    sn_tissue_rhs_free(&j.rhs);
    sn_release(j.report);
    return st;
}
