/* Some tissues solved together by a system: half solves, the change of the matrix since its factor, and what
 * of it is worth going back for. */
#include "base/alloc.h"
#include "field/tissue_private.h"

#include <string.h>

typedef struct block_job {
    const sn_tissue_solver *s;
    sn_tissue_system *system;
    const tissue_block *b;
    double *cover;
    tissue_rhs rhs;
    sn_half_place *place;  /* n: half solves                               */
    double *factor, *seen; /* width x n: see low_rank.h                   */
    int32_t *go, n_go;     /* columns that are solved to the end           */
    double **out;          /* n_go: where to                               */
} block_job;

static void free_job(block_job *j)
{
    sn_tissue_rhs_free(&j->rhs);
    sn_release(j->place);
    sn_release(j->factor);
    sn_release(j->seen);
    sn_release(j->go);
    sn_release(j->out);
}

static sn_status init_job(block_job *j, sn_error *err)
{
    size_t n = (size_t)j->b->n, width = (size_t)sn_low_rank_columns(j->system->change)->width;
    sn_status st = sn_tissue_rhs_init(&j->rhs, j->s, j->b->tissue, j->b->n, err);
    j->place = SN_NEW(sn_half_place, n);
    j->factor = SN_NEW(double, width *n);
    j->seen = SN_NEW(double, width *n);
    j->go = SN_NEW(int32_t, n);
    j->out = SN_NEW(double *, n);
    if (st || (j->place && j->factor && j->seen && j->go && j->out)) return st;
    return sn_fail(err, SN_ENOMEM, "tissue: no memory for %d fields", j->b->n);
}

/* ---- forward ---- */

/* A muscle's values and curve may have changed; it is the same one all the same. */
static sn_status need_half_solves(block_job *j, const sn_run *run, sn_error *err)
{
    uint64_t *key = SN_NEW(uint64_t, j->b->n);
    if (!key) return sn_fail(err, SN_ENOMEM, "tissue: no memory for %d fields", j->b->n);
    for (int32_t c = 0; c < j->b->n; c++)
        key[c] = j->b->tissue[c] > 0 ? j->s->muscle[j->b->tissue[c] - 1].id : 0;
    const sn_half_wanted w = {{j->rhs.n, j->rhs.ptr, j->rhs.index, j->rhs.value},
                              key,
                              sn_low_rank_columns(j->system->change),
                              j->s->n_free};
    sn_status st = sn_half_cache_need(&j->system->half, &w, run, j->place, j->factor, err);
    sn_release(key);
    return st;
}

static sn_status go_forward(block_job *j, const sn_run *run, sn_error *err)
{
    const sn_low_rank *change = j->system->change;
    sn_status st = need_half_solves(j, run, err);
    if (!st)
        st = sn_half_cache_see(&j->system->half, sn_low_rank_columns(change), j->place, j->b->n, run, j->seen,
                               err);
    return st ? st : sn_low_rank_factor(change, j->b->n, j->seen, j->factor, err);
}

/* ---- quick: what is worth going back for ---- */

/* How far a field is off where its matrix and the one of now differ: elsewhere it is less, as the difference
 * of two fields is harmonic there. */
static double worst_seen(const block_job *j, int32_t column)
{
    const sn_unit_columns *e = sn_low_rank_columns(j->system->change);
    const double *now = j->seen + (size_t)column * (size_t)e->width;
    int32_t tissue = j->b->tissue[column];
    const double *field = j->b->field + (size_t)tissue * (size_t)j->s->body->mesh.n_vert;
    double worst = 0.0;
    for (int32_t k = 0; k < e->width; k++) {
        int32_t u = e->unknown[k];
        worst = fmax(worst, fabs(now[k] - (tissue == 0 ? j->cover[u] : field[j->s->vertex_of[u]])));
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

/* Which columns of Z, and what Y is multiplied with. */
typedef struct combination {
    sn_half_term *term; /* batches of Z, then parts of Y */
    int32_t n_term;
    int32_t *pick; /* n_batch x n_go */
} combination;

static void free_combination(combination *k)
{
    sn_release(k->term);
    sn_release(k->pick);
}

static void add_batches(const block_job *j, combination *k)
{
    for (int32_t i = 0; i < j->system->half.n_batch; i++) {
        int32_t *pick = k->pick + (size_t)i * (size_t)j->n_go;
        bool is_wanted = false;
        for (int32_t g = 0; g < j->n_go; g++) {
            const sn_half_place *p = &j->place[j->go[g]];
            pick[g] = p->i_batch == i ? p->column : -1;
            is_wanted = is_wanted || p->i_batch == i;
        }
        if (is_wanted) k->term[k->n_term++] = (sn_half_term){.y = j->system->half.batch[i].z, .pick = pick};
    }
}

static sn_status combine(const block_job *j, combination *k, sn_error *err)
{
    const sn_unit_columns *e = sn_low_rank_columns(j->system->change);
    size_t n_batch = (size_t)j->system->half.n_batch;
    k->term = SN_NEW(sn_half_term, n_batch + (size_t)e->n_part);
    k->pick = SN_NEW(int32_t, n_batch * (size_t)j->n_go);
    if (!k->term || !k->pick) return sn_fail(err, SN_ENOMEM, "tissue: no memory for %d fields", j->n_go);
    add_batches(j, k);
    for (int32_t i = 0; i < e->n_part; i++)
        k->term[k->n_term++] =
            (sn_half_term){.y = e->part[i].y, .factor = j->factor + e->part[i].first, .stride = e->width};
    return SN_OK;
}

static sn_status go_back(block_job *j, const sn_run *run, sn_error *err)
{
    size_t width = (size_t)sn_low_rank_columns(j->system->change)->width;
    combination k = {0};
    for (size_t g = 0; g < (size_t)j->n_go; g++) {
        size_t c = (size_t)j->go[g]; /* >= g: the factors move up */
        if (g != c && width > 0) memcpy(j->factor + g * width, j->factor + c * width, width * sizeof(double));
        j->out[g] = j->b->field + (size_t)j->b->tissue[c] * (size_t)j->s->body->mesh.n_vert;
    }
    sn_status st = combine(j, &k, err);
    if (!st)
        st = sn_half_solve_finish(j->system->cholesky, k.term, k.n_term, j->n_go, j->out, j->s->vertex_of,
                                  run, err);
    free_combination(&k);
    return st;
}

/* max |A x - b| of the sum of all columns with signs, one product for all, over the largest |b| of one: the
 * right-hand sides of fat and of a single muscle may be the same. */
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
        for (int32_t e = j->rhs.ptr[j->go[k]]; e < j->rhs.ptr[j->go[k] + 1]; e++) {
            r[j->rhs.index[e]] -= (k % 2 ? -1.0 : 1.0) * j->rhs.value[e];
            largest = fmax(largest, fabs(j->rhs.value[e]));
        }
    sn_cholesky_add_product(j->system->cholesky, x, r);
    sn_low_rank_add_product(j->system->change, x, r);
    for (size_t u = 0; u < n; u++) worst = fmax(worst, fabs(r[u]));
    *residual = largest > 0.0 ? worst / largest : worst;
    sn_release(x);
    sn_release(r);
    return SN_OK;
}

void sn_tissue_complete_field(const sn_tissue_solver *s, const tissue_block *b, double *cover, int32_t tissue)
{
    bool has_skin = b->stamp && b->stamp[tissue] > 0;
    double *f = b->field + (size_t)tissue * (size_t)s->body->mesh.n_vert;
    for (int32_t v = 0; !has_skin && v < s->body->mesh.n_vert; v++)
        if (s->number[v] < 0) f[v] = 0.0;
    for (int32_t u = 0; tissue == 0 && u < s->n_free; u++) cover[u] = f[s->vertex_of[u]];
    if (tissue == 0) sn_tissue_put_fat(s, b->fat, f);
    if (b->stamp) b->stamp[tissue] = s->revision;
}

sn_status sn_tissue_solve_block(const sn_tissue_solver *s, sn_tissue_system *system, const tissue_block *b,
                                double *cover, const sn_run *run, double *residual, int32_t *n_solved,
                                sn_error *err)
{
    block_job j = {.s = s, .system = system, .b = b, .cover = cover};
    sn_status st = init_job(&j, err);
    if (!st) st = go_forward(&j, run, err);
    if (!st) choose(&j);
    if (!st && j.n_go > 0) st = go_back(&j, run, err);
    if (!st && j.n_go > 0) st = find_residual(&j, residual, err);
    for (int32_t k = 0; !st && k < j.n_go; k++) sn_tissue_complete_field(s, b, cover, b->tissue[j.go[k]]);
    *n_solved = j.n_go;
    free_job(&j);
    return st;
}
