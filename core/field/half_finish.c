/* Half solves combined and gone back with: first the trunk of the elimination tree, each thread with some of
 * the right-hand sides, then its branches side by side, each with all. So the factor is read once by all
 * threads together, but for the trunk. */
#include "base/alloc.h"
#include "field/back_solve.h"
#include "field/half_solve_private.h"

#include <stdatomic.h>
#include <string.h>

#define MOST_VECS 3 /* of right-hand sides in a strip: each strip reads the trunk */

typedef struct finishing {
    const sn_half_term *term;
    int32_t n_term, n_rhs;
    double *const *out;
    const int32_t *at;
    const sn_cholesky *c;
    int32_t width, n_strip;
    double *trunk; /* see sn_strip */
    double *room;  /* n_room x room_size: what an item works in; made by the caller's thread, as what threads
                      that come and go ask for is new to them each time */
    size_t room_size;
    int n_room;
    atomic_bool *is_taken; /* n_room */
} finishing;

/* There are as many rooms as items at a time. */
static int take_room(const finishing *job)
{
    for (int i = 0;; i = (i + 1) % job->n_room)
        if (!atomic_exchange(&job->is_taken[i], true)) return i;
}

static void leave_room(const finishing *job, int i)
{
    atomic_store(&job->is_taken[i], false);
}

/* x += columns of y, those that are picked. */
static void add_columns(const sn_half_term *t, size_t k, const finishing *job, const sn_strip *s, double *x)
{
    const sn_half_solve *h = t->y;
    int own = sn_super_own(job->c->factor, k);
    for (int32_t j = s->from; j < s->from + s->n && j < job->n_rhs; j++) {
        int32_t column = t->pick ? t->pick[j] : j;
        if (column < h->first[k] || column >= h->last[k]) continue;
        const double *y = h->y + (size_t)column * (size_t)h->n_row + h->at[k];
        for (int r = 0; r < own; r++) x[(size_t)r * (size_t)s->width + (size_t)(j - s->from)] += y[r];
    }
}

/* x += y times its factor; y, column-major, is y' to row-major eyes; so is the factor. */
static void add_multiplied(const sn_half_term *t, size_t k, const finishing *job, const sn_strip *s,
                           double *x)
{
    const sn_half_solve *h = t->y;
    int32_t first = h->first[k], n = s->from + s->n < job->n_rhs ? s->n : job->n_rhs - s->from;
    cblas_dgemm(CblasRowMajor, CblasTrans, CblasTrans, sn_super_own(job->c->factor, k), n, h->last[k] - first,
                1.0, h->y + (size_t)first * (size_t)h->n_row + h->at[k], (int)h->n_row,
                t->factor + (size_t)s->from * (size_t)t->stride + first, t->stride, 1.0, x, s->width);
}

static void put_rows(const finishing *job, size_t k, const sn_strip *s, const double *x)
{
    const SuiteSparse_long *perm = job->c->factor->Perm, *super = sn_supers(job->c->factor);
    int32_t n = s->from + s->n < job->n_rhs ? s->n : job->n_rhs - s->from;
    for (SuiteSparse_long r = super[k]; r < super[k + 1]; r++, x += s->width) {
        size_t to = job->at ? (size_t)job->at[perm[r]] : (size_t)perm[r];
        for (int32_t j = 0; j < n; j++) job->out[s->from + j][to] = x[j];
    }
}

static void finish_supernode(const finishing *job, size_t k, const sn_strip *s)
{
    const cholmod_factor *f = job->c->factor;
    double *x = sn_strip_row(s, sn_supers(f)[k]);
    for (int r = 0; r < sn_super_own(f, k); r++)
        memset(x + (size_t)r * (size_t)s->width, 0, (size_t)s->n * sizeof *x);
    for (int32_t i = 0; i < job->n_term; i++) {
        const sn_half_term *t = &job->term[i];
        if (t->y->at[k] < 0) continue;
        if (t->factor)
            add_multiplied(t, k, job, s, x);
        else
            add_columns(t, k, job, s, x);
    }
    sn_back_solve(s, k);
    put_rows(job, k, s, x);
}

/* A strip of the right-hand sides, in the trunk. */
static sn_status finish_trunk(void *user, int32_t i, const sn_run *run, sn_error *err)
{
    const finishing *job = user;
    const sn_tree_cut *tree = &job->c->order->tree;
    int room = take_room(job);
    int32_t n_vec = job->width / SN_LANES, from = n_vec * i / job->n_strip * SN_LANES,
            to = job->width == 1 ? 1 : n_vec * (i + 1) / job->n_strip * SN_LANES;
    const sn_strip s = {.c = job->c,
                        .trunk = job->trunk,
                        .width = job->width,
                        .from = from,
                        .n = to - from,
                        .below = job->room + (size_t)room * job->room_size};
    sn_status st = SN_OK;
    for (int32_t k = tree->n_trunk - 1; !st && k >= 0; k--) {
        finish_supernode(job, (size_t)tree->trunk[k], &s);
        st = sn_run_step(run, "solving", -1.0, err);
    }
    leave_room(job, room);
    return st;
}

static sn_status finish_branch(void *user, int32_t i, const sn_run *run, sn_error *err)
{
    const finishing *job = user;
    const sn_branch *b = &job->c->order->tree.branch[i];
    const SuiteSparse_long *super = sn_supers(job->c->factor);
    int room = take_room(job);
    double *below = job->room + (size_t)room * job->room_size;
    const sn_strip s = {.c = job->c,
                        .trunk = job->trunk,
                        .branch = below + job->c->factor->maxesize * (size_t)job->width,
                        .first = (int32_t)super[b->from],
                        .last = (int32_t)super[b->to],
                        .width = job->width,
                        .n = job->width,
                        .below = below};
    sn_status st = SN_OK;
    for (int32_t k = b->to - 1; !st && k >= b->from; k--) {
        finish_supernode(job, (size_t)k, &s);
        if (k % 1024 == 0) st = sn_run_step(run, "solving", -1.0, err);
    }
    leave_room(job, room);
    return st;
}

/* The same for any number of threads, as BLAS may round a column otherwise when others stand beside it; even,
 * for two of them. */
static int32_t count_strips(int32_t n_vec)
{
    return n_vec < 2 ? 1 : 2 * ((n_vec + 2 * MOST_VECS - 1) / (2 * MOST_VECS));
}

static sn_status open_rooms(finishing *job, const sn_run *run, sn_error *err)
{
    const sn_tree_cut *tree = &job->c->order->tree;
    size_t width = (size_t)job->width;
    int n_strip = sn_run_count_at_once(run, job->n_strip),
        n_branch = sn_run_count_at_once(run, tree->n_branch);
    job->room_size = (job->c->factor->maxesize + (size_t)tree->n_branch_row) * width;
    job->n_room = n_strip > n_branch ? n_strip : n_branch;
    job->trunk = SN_NEW(double, (size_t)tree->n_trunk_row *width);
    job->room = SN_NEW(double, (size_t)job->n_room * job->room_size);
    job->is_taken = SN_NEW(atomic_bool, job->n_room);
    if (!job->trunk || !job->room || !job->is_taken)
        return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d right-hand sides", job->n_rhs);
    for (int i = 0; i < job->n_room; i++) atomic_init(&job->is_taken[i], false);
    return SN_OK;
}

static void close_rooms(finishing *job)
{
    sn_release(job->trunk);
    sn_release(job->room);
    sn_release(job->is_taken);
}

sn_status sn_half_solve_finish(const sn_cholesky *c, const sn_half_term *term, int32_t n_term, int32_t n_rhs,
                               double *const *out, const int32_t *at, const sn_run *run, sn_error *err)
{
    finishing job = {.term = term,
                     .n_term = n_term,
                     .n_rhs = n_rhs,
                     .out = out,
                     .at = at,
                     .c = c,
                     .width = sn_back_solve_width(n_rhs)};
    job.n_strip = count_strips(job.width / SN_LANES);
    sn_status st = open_rooms(&job, run, err);
    openblas_set_num_threads(1);
    if (!st && c->order->tree.n_trunk > 0) st = sn_run_each(run, job.n_strip, finish_trunk, &job, err);
    if (!st) st = sn_run_each(run, c->order->tree.n_branch, finish_branch, &job, err);
    close_rooms(&job);
    return st;
}
