#include "field/half_solve.h"

#include "base/alloc.h"
#include "field/back_solve.h"

#include <string.h>

#define CHUNK 32 /* columns that go through the factor together; no result depends on the threads */

struct sn_half_solve {
    const sn_cholesky *c;
    int64_t *at;           /* n_super: first row in y, -1 when on no path          */
    int32_t *first, *last; /* n_super: columns of y that may not be zero there     */
    int32_t *step, n_step; /* supernodes on some path, ascending                   */
    double *y;             /* n_row x n_col, column-major                          */
    int64_t n_row;
    int32_t n_below; /* most rows below a supernode on a path */
    int32_t n_col;
};

void sn_half_solve_destroy(sn_half_solve *h)
{
    if (!h) return;
    sn_release(h->at);
    sn_release(h->first);
    sn_release(h->last);
    sn_release(h->step);
    sn_release(h->y);
    sn_release(h);
}

/* ---- paths ---- */

/* The supernode of the first row below supernode k; -1 at a root. */
static int32_t parent_of(const sn_cholesky *c, int32_t k)
{
    int own = sn_super_own(c->factor, (size_t)k);
    return sn_super_all(c->factor, (size_t)k) > own
               ? c->order->super_of[sn_super_rows(c->factor, (size_t)k)[own]]
               : -1;
}

/* Marks the paths vector by vector: a supernode's columns of y are an interval. */
static void mark_paths(sn_half_solve *h, const sn_sparse_vectors *b)
{
    const sn_order *o = h->c->order;
    for (size_t k = 0; k < h->c->factor->nsuper; k++) h->at[k] = -1;
    for (int32_t j = 0; j < b->n; j++)
        for (int32_t e = b->ptr[j]; e < b->ptr[j + 1]; e++)
            for (int32_t k = o->super_of[o->column_of[b->index[e]]]; k >= 0; k = parent_of(h->c, k)) {
                if (h->at[k] >= 0 && h->last[k] == j + 1) break; /* so are all above */
                if (h->at[k] < 0) h->first[k] = j;
                h->at[k] = 0;
                h->last[k] = j + 1;
            }
}

static sn_status lay_out(sn_half_solve *h, sn_error *err)
{
    const cholmod_factor *f = h->c->factor;
    for (size_t k = 0; k < f->nsuper; k++) h->n_step += h->at[k] >= 0;
    h->step = SN_NEW(int32_t, h->n_step);
    if (!h->step) return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d supernodes", h->n_step);
    h->n_step = 0;
    for (size_t k = 0; k < f->nsuper; k++) {
        if (h->at[k] < 0) continue;
        int32_t own = sn_super_own(f, k), below = sn_super_all(f, k) - own;
        h->at[k] = h->n_row;
        h->n_row += own;
        h->step[h->n_step++] = (int32_t)k;
        if (below > h->n_below) h->n_below = below;
    }
    if (h->n_row <= INT32_MAX) h->y = sn_alloc_zero((size_t)h->n_row * (size_t)h->n_col, sizeof *h->y);
    if (h->y) return SN_OK;
    return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %lld x %d values", (long long)h->n_row, h->n_col);
}

/* The value of a row (a column of the factor) in column j of y. */
static double *place_in(const sn_half_solve *h, int32_t row, int32_t j)
{
    int32_t s = h->c->order->super_of[row];
    return h->y + (size_t)j * (size_t)h->n_row + h->at[s] + (row - sn_supers(h->c->factor)[s]);
}

/* ---- forward ---- */

/* One supernode, columns from..to of y: y there := L_kk^-1 y there; what lies below is reduced by L_below
 * times that. */
static void eliminate(sn_half_solve *h, size_t k, int32_t from, int32_t to, double *below)
{
    const cholmod_factor *f = h->c->factor;
    int own = sn_super_own(f, k), all = sn_super_all(f, k), under = all - own, n_col = to - from;
    const SuiteSparse_long *row = sn_super_rows(f, k) + own;
    const double *l = sn_super_block(f, k);
    double *y = h->y + (size_t)from * (size_t)h->n_row + h->at[k];
    if (n_col == 1)
        cblas_dtrsv(CblasColMajor, CblasLower, CblasNoTrans, CblasNonUnit, own, l, all, y, 1);
    else
        cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, own, n_col, 1.0, l, all,
                    y, (int)h->n_row);
    if (under == 0) return;
    if (n_col == 1)
        cblas_dgemv(CblasColMajor, CblasNoTrans, under, own, 1.0, l + own, all, y, 1, 0.0, below, 1);
    else
        cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, under, n_col, own, 1.0, l + own, all, y,
                    (int)h->n_row, 0.0, below, under);
    for (int i = 0; i < under; i++) {
        double *at = place_in(h, (int32_t)row[i], from);
        for (int j = 0; j < n_col; j++)
            at[(size_t)j * (size_t)h->n_row] -= below[(size_t)j * (size_t)under + (size_t)i];
    }
}

static sn_status go_forward(void *user, int32_t i_chunk, const sn_run *run, sn_error *err)
{
    sn_half_solve *h = user;
    int32_t from = i_chunk * CHUNK, to = from + CHUNK < h->n_col ? from + CHUNK : h->n_col;
    double *below = SN_NEW(double, (size_t)h->n_below *(size_t)(to - from));
    sn_status st = below ? SN_OK : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", h->n_below);
    for (int32_t s = 0; !st && s < h->n_step; s++) {
        int32_t k = h->step[s];
        int32_t first = h->first[k] > from ? h->first[k] : from, last = h->last[k] < to ? h->last[k] : to;
        if (s % 256 == 0) st = sn_run_step(run, "solving", -1.0, err);
        if (!st && first < last) eliminate(h, (size_t)k, first, last, below);
    }
    sn_release(below);
    return st;
}

sn_status sn_half_solve_create(sn_half_solve **out, const sn_cholesky *c, const sn_sparse_vectors *b,
                               const sn_run *run, sn_error *err)
{
    *out = NULL;
    sn_half_solve *h = SN_NEW_ZERO(sn_half_solve, 1);
    if (!h) return sn_fail(err, SN_ENOMEM, "cholesky: no memory");
    h->c = c;
    h->n_col = b->n;
    h->at = SN_NEW(int64_t, c->factor->nsuper);
    h->first = SN_NEW(int32_t, c->factor->nsuper);
    h->last = SN_NEW(int32_t, c->factor->nsuper);
    sn_status st = h->at && h->first && h->last
                       ? SN_OK
                       : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", c->order->n);
    if (!st) mark_paths(h, b);
    if (!st) st = lay_out(h, err);
    for (int32_t j = 0; !st && j < b->n; j++)
        for (int32_t e = b->ptr[j]; e < b->ptr[j + 1]; e++)
            *place_in(h, c->order->column_of[b->index[e]], j) += b->value[e];
    openblas_set_num_threads(1);
    if (!st) st = sn_run_each(run, (b->n + CHUNK - 1) / CHUNK, go_forward, h, err);
    if (st)
        sn_half_solve_destroy(h);
    else
        *out = h;
    return st;
}

sn_status sn_half_solve_create_units(sn_half_solve **out, const sn_cholesky *c, const int32_t *index,
                                     int32_t n, const sn_run *run, sn_error *err)
{
    int32_t *ptr = SN_NEW(int32_t, (size_t)n + 1);
    double *one = SN_NEW(double, n);
    *out = NULL;
    sn_status st = ptr && one ? SN_OK : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d columns", n);
    for (int32_t j = 0; !st && j <= n; j++) ptr[j] = j;
    for (int32_t j = 0; !st && j < n; j++) one[j] = 1.0;
    if (!st) st = sn_half_solve_create(out, c, &(sn_sparse_vectors){n, ptr, index, one}, run, err);
    sn_release(ptr);
    sn_release(one);
    return st;
}

int32_t sn_half_solve_count(const sn_half_solve *h)
{
    return h->n_col;
}

/* ---- products ---- */

void sn_half_solve_gram(const sn_half_solve *h, double *out)
{
    int32_t n = h->n_col;
    openblas_set_num_threads(1);
    cblas_dsyrk(CblasColMajor, CblasUpper, CblasTrans, n, (int)h->n_row, 1.0, h->y, (int)h->n_row, 0.0, out,
                n);
    for (int32_t i = 0; i < n; i++)
        for (int32_t j = 0; j < i; j++)
            out[(size_t)j * (size_t)n + (size_t)i] = out[(size_t)i * (size_t)n + (size_t)j];
}

void sn_half_solve_product(const sn_half_solve *y, const sn_half_solve *z, double *out)
{
    const cholmod_factor *f = y->c->factor;
    memset(out, 0, (size_t)y->n_col * (size_t)z->n_col * sizeof *out);
    openblas_set_num_threads(1);
    for (int32_t s = 0; s < y->n_step; s++) {
        size_t k = (size_t)y->step[s];
        if (z->at[k] < 0) continue;
        cblas_dgemm(CblasColMajor, CblasTrans, CblasNoTrans, y->last[k] - y->first[k],
                    z->last[k] - z->first[k], sn_super_own(f, k), 1.0,
                    y->y + (size_t)y->first[k] * (size_t)y->n_row + y->at[k], (int)y->n_row,
                    z->y + (size_t)z->first[k] * (size_t)z->n_row + z->at[k], (int)z->n_row, 1.0,
                    out + (size_t)z->first[k] * (size_t)y->n_col + y->first[k], y->n_col);
    }
}

/* ---- back ---- */

typedef struct finishing {
    const sn_half_term *term;
    int32_t n_term, n_rhs, n_chunk;
    double *const *out;
    const int32_t *at;
    const sn_cholesky *c;
} finishing;

typedef struct strip { /* some of the right-hand sides */
    double *x;         /* n x width: see back_solve.h  */
    int32_t from, n, width;
} strip;

static void add_term(const sn_half_term *t, const strip *s)
{
    const sn_half_solve *h = t->y;
    const cholmod_factor *f = h->c->factor;
    size_t w = (size_t)s->width;
    for (int32_t i = 0; i < h->n_step; i++) {
        size_t k = (size_t)h->step[i];
        int32_t first = h->first[k], last = h->last[k];
        int own = sn_super_own(f, k);
        const double *y = h->y + h->at[k];
        double *x = s->x + (size_t)sn_supers(f)[k] * w;
        if (t->factor) { /* y, column-major, is y' to row-major eyes; so is the factor */
            cblas_dgemm(CblasRowMajor, CblasTrans, CblasTrans, own, s->n, last - first, 1.0,
                        y + (size_t)first * (size_t)h->n_row, (int)h->n_row,
                        t->factor + (size_t)s->from * (size_t)t->stride + first, t->stride, 1.0, x, s->width);
            continue;
        }
        for (int32_t j = first > s->from ? first : s->from; j < last && j < s->from + s->n; j++)
            for (int r = 0; r < own; r++)
                x[(size_t)r * w + (size_t)(j - s->from)] += y[(size_t)j * (size_t)h->n_row + (size_t)r];
    }
}

static void put_columns(const finishing *job, const strip *s)
{
    const SuiteSparse_long *perm = job->c->factor->Perm;
    for (size_t j = 0; j < job->c->factor->n; j++) {
        size_t to = job->at ? (size_t)job->at[perm[j]] : (size_t)perm[j];
        for (int32_t c = 0; c < s->n; c++) job->out[s->from + c][to] = s->x[j * (size_t)s->width + (size_t)c];
    }
}

static sn_status finish_strip(void *user, int32_t i, const sn_run *run, sn_error *err)
{
    const finishing *job = user;
    size_t n = job->c->factor->n;
    strip s = {.from = (int32_t)((int64_t)job->n_rhs * i / job->n_chunk)};
    s.n = (int32_t)((int64_t)job->n_rhs * (i + 1) / job->n_chunk) - s.from;
    s.width = sn_strip_width(s.n);
    s.x = SN_NEW_ZERO(double, n *(size_t)s.width);
    sn_status st =
        s.x ? SN_OK : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %zu x %d values", n, s.width);
    for (int32_t t = 0; !st && t < job->n_term; t++) add_term(&job->term[t], &s);
    if (!st) st = sn_back_solve(job->c->factor, s.x, s.width, run, err);
    if (!st) put_columns(job, &s);
    sn_release(s.x);
    return st;
}

/* Strips as even as may be, an even number of them when they are wide: for two threads the same as for one.
 */
static int32_t count_strips(int32_t n_rhs)
{
    int32_t n = (n_rhs + SN_STRIP_MAX - 1) / SN_STRIP_MAX;
    return n_rhs > 8 ? n + n % 2 : n;
}

sn_status sn_half_solve_finish(const sn_half_term *term, int32_t n_term, int32_t n_rhs, double *const *out,
                               const int32_t *at, const sn_run *run, sn_error *err)
{
    finishing job = {.term = term,
                     .n_term = n_term,
                     .n_rhs = n_rhs,
                     .n_chunk = count_strips(n_rhs),
                     .out = out,
                     .at = at,
                     .c = term[0].y->c};
    openblas_set_num_threads(1);
    return sn_run_each(run, job.n_chunk, finish_strip, &job, err);
}
