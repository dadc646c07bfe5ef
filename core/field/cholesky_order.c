#include "field/cholesky_order.h"

#include "base/alloc.h"

#include <omp.h>
#include <pthread.h>

sn_status sn_cholmod_fail(const cholmod_common *c, const char *what, sn_error *err)
{
    if (c->status == CHOLMOD_OUT_OF_MEMORY) return sn_fail(err, SN_ENOMEM, "%s: no memory", what);
    if (c->status == CHOLMOD_TOO_LARGE) return sn_fail(err, SN_ESOLVE, "%s: the matrix is too large", what);
    return sn_fail(err, SN_ESOLVE, "%s: CHOLMOD failed with status %d", what, c->status);
}

/* With two threads OpenBLAS cuts its work elsewhere and the last bits change, and CHOLMOD's own loops (four
 * threads for many small ones) take 0.40 s where one thread factorizes 108,000 unknowns in 0.18 s.
 * Independent matrices are the parallelism. */
int sn_cholmod_one_thread(void)
{
    int levels = omp_get_max_active_levels();
    openblas_set_num_threads(1);
    omp_set_max_active_levels(0);
    return levels;
}

void sn_cholmod_threads_again(int levels)
{
    omp_set_max_active_levels(levels);
}

void sn_cholmod_start(cholmod_common *c)
{
    cholmod_l_start(c);
    c->print = 0;
    c->supernodal = CHOLMOD_SUPERNODAL;
    c->nmethods = 1;
    c->postorder = 1;
}

/* The pattern of the lower triangle of the numbered part, columns in the order of the numbers. */
static cholmod_sparse *numbered_part(sn_order *o, const sn_csr *a, const int32_t *number)
{
    int64_t nnz = 0;
    for (int32_t i = 0; i < a->n; i++)
        for (int64_t k = a->ptr[i]; number[i] >= 0 && k < a->ptr[i + 1]; k++)
            nnz += number[a->idx[k]] >= number[i];
    cholmod_sparse *s = cholmod_l_allocate_sparse((size_t)o->n, (size_t)o->n, (size_t)nnz, 0, 1, -1,
                                                  CHOLMOD_PATTERN, &o->common);
    int32_t *row_of = SN_NEW(int32_t, o->n);
    if (!s || !row_of) {
        if (s) cholmod_l_free_sparse(&s, &o->common);
        sn_release(row_of);
        return NULL;
    }
    for (int32_t i = 0; i < a->n; i++)
        if (number[i] >= 0) row_of[number[i]] = i;
    SuiteSparse_long *ptr = s->p, *idx = s->i, n = 0;
    for (int32_t j = 0; j < o->n; j++) {
        ptr[j] = n;
        for (int64_t k = a->ptr[row_of[j]]; k < a->ptr[row_of[j] + 1]; k++)
            if (number[a->idx[k]] >= j) idx[n++] = number[a->idx[k]];
    }
    ptr[o->n] = n;
    sn_release(row_of);
    return s;
}

typedef struct analysis {
    sn_order *order;
    cholmod_sparse *pattern;
} analysis;

static void analyse(analysis *a)
{
    int levels = sn_cholmod_one_thread();
    a->order->symbolic = cholmod_l_analyze(a->pattern, &a->order->common);
    sn_cholmod_threads_again(levels);
}

/* METIS draws from the one random stream of the process: one at a time, or the order would not be the same
 * each time. One that was left behind is waited for. */
static pthread_mutex_t ordering = PTHREAD_MUTEX_INITIALIZER;

static void analyse_in_turn(void *job)
{
    (void)pthread_mutex_lock(&ordering);
    analyse(job);
    (void)pthread_mutex_unlock(&ordering);
}

static void analysis_free(void *job)
{
    analysis *a = job;
    cholmod_l_free_sparse(&a->pattern, &a->order->common);
    sn_order_leave(a->order);
    sn_release(a);
}

/* Small systems are done in a moment, many at a time. */
static sn_status find_order(sn_order *o, const sn_csr *a, const int32_t *number, bool is_small,
                            const sn_run *run, sn_error *err)
{
    analysis *job = SN_NEW_ZERO(analysis, 1);
    if (!job) return sn_fail(err, SN_ENOMEM, "cholesky: no memory");
    *job = (analysis){o, numbered_part(o, a, number)};
    sn_order_use(o); /* by the job */
    sn_status st = SN_OK;
    if (!job->pattern) {
        st = sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", o->n);
    } else if (is_small) {
        analyse(job);
    } else {
        st = sn_run_apart(run, "ordering the matrix", analyse_in_turn, analysis_free, job, err);
        if (st) return st;
    }
    analysis_free(job);
    if (st) return st;
    return o->symbolic && o->common.status >= 0 ? SN_OK : sn_cholmod_fail(&o->common, "analysis", err);
}

static sn_status find_places(sn_order *o, const int32_t *number, sn_error *err)
{
    const SuiteSparse_long *perm = o->symbolic->Perm;
    o->place = SN_NEW(int32_t, o->n_row);
    o->column_of = SN_NEW(int32_t, o->n);
    o->super_of = SN_NEW(int32_t, o->n);
    if (!o->place || !o->column_of || !o->super_of)
        return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", o->n);
    for (int32_t j = 0; j < o->n; j++) o->column_of[perm[j]] = j;
    for (int32_t i = 0; i < o->n_row; i++) o->place[i] = number[i] >= 0 ? o->column_of[number[i]] : -1;
    for (size_t k = 0; k < o->symbolic->nsuper; k++)
        for (SuiteSparse_long j = sn_supers(o->symbolic)[k]; j < sn_supers(o->symbolic)[k + 1]; j++)
            o->super_of[j] = (int32_t)k;
    return SN_OK;
}

/* One column: ascending, with where each comes from. */
static void sort_column(SuiteSparse_long *idx, int64_t *from, SuiteSparse_long n)
{
    for (SuiteSparse_long i = 1; i < n; i++) {
        SuiteSparse_long row = idx[i], at = i;
        int64_t source = from[i];
        for (; at > 0 && idx[at - 1] > row; at--) {
            idx[at] = idx[at - 1];
            from[at] = from[at - 1];
        }
        idx[at] = row;
        from[at] = source;
    }
}

/* CHOLMOD would permute each matrix given to it, twice: it is gathered in the order of elimination instead.
 */
static sn_status find_lower(sn_order *o, const sn_csr *a, sn_error *err)
{
    o->ptr = sn_alloc_zero((size_t)o->n + 1, sizeof *o->ptr);
    int32_t *row_of = SN_NEW(int32_t, o->n);
    if (!o->ptr || !row_of) {
        sn_release(row_of);
        return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", o->n);
    }
    for (int32_t i = 0; i < a->n; i++) {
        if (o->place[i] < 0) continue;
        row_of[o->place[i]] = i;
        for (int64_t k = a->ptr[i]; k < a->ptr[i + 1]; k++)
            o->ptr[o->place[i] + 1] += o->place[a->idx[k]] >= o->place[i];
    }
    for (int32_t j = 0; j < o->n; j++) o->ptr[j + 1] += o->ptr[j];
    o->idx = SN_NEW(SuiteSparse_long, (size_t)o->ptr[o->n]);
    o->from = SN_NEW(int64_t, (size_t)o->ptr[o->n]);
    for (int32_t j = 0; o->idx && o->from && j < o->n; j++) {
        SuiteSparse_long n = o->ptr[j];
        for (int64_t k = a->ptr[row_of[j]]; k < a->ptr[row_of[j] + 1]; k++) {
            if (o->place[a->idx[k]] < j) continue;
            o->idx[n] = o->place[a->idx[k]];
            o->from[n++] = k;
        }
        sort_column(o->idx + o->ptr[j], o->from + o->ptr[j], n - o->ptr[j]);
    }
    sn_release(row_of);
    return o->idx && o->from ? SN_OK : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", o->n);
}

static void destroy(sn_order *o)
{
    if (o->symbolic) cholmod_l_free_factor(&o->symbolic, &o->common);
    cholmod_l_finish(&o->common);
    sn_release(o->place);
    sn_release(o->column_of);
    sn_release(o->super_of);
    sn_release(o->ptr);
    sn_release(o->idx);
    sn_release(o->from);
    sn_tree_cut_free(&o->tree);
    sn_release(o);
}

sn_status sn_order_create(sn_order **out, const sn_csr *a, const int32_t *number, int32_t n,
                          int ordering_method, const sn_run *run, sn_error *err)
{
    *out = NULL;
    if (n < 1) return sn_fail(err, SN_EINVAL, "cholesky: the matrix has no rows");
    sn_status st = sn_run_step(run, "ordering the matrix", 0.0, err);
    if (st) return st;
    sn_order *o = SN_NEW_ZERO(sn_order, 1);
    if (!o) return sn_fail(err, SN_ENOMEM, "cholesky: no memory");
    sn_cholmod_start(&o->common);
    o->common.method[0].ordering = ordering_method;
    atomic_init(&o->users, 1);
    o->n = n;
    o->n_row = a->n;
    st = find_order(o, a, number, ordering_method == CHOLMOD_AMD, run, err);
    if (!st) st = find_places(o, number, err);
    if (!st) st = find_lower(o, a, err);
    if (!st) st = sn_tree_cut_find(&o->tree, o->symbolic, o->super_of, err);
    if (!st) st = sn_run_step(run, "ordering the matrix", 1.0, err);
    if (st)
        sn_order_leave(o);
    else
        *out = o;
    return st;
}

void sn_order_use(sn_order *o)
{
    (void)atomic_fetch_add(&o->users, 1);
}

void sn_order_leave(sn_order *o)
{
    if (o && atomic_fetch_sub(&o->users, 1) == 1) destroy(o);
}
