#include "field/iterative.h"

#include "base/alloc.h"
#include "field/amg_bridge.h"

#include <string.h>

enum { most_iterations = 2000 };

struct sn_iterative {
    sn_csr a;      /* n unknowns                     */
    int64_t *from; /* where the whole matrix has each */
    sn_amg *amg;
};

void sn_iterative_destroy(sn_iterative *s)
{
    if (!s) return;
    sn_csr_free(&s->a);
    sn_release(s->from);
    sn_amg_destroy(s->amg);
    sn_release(s);
}

/* ---- the matrix ---- */

static void sort_row(int32_t *idx, int64_t *from, int64_t n)
{
    for (int64_t i = 1; i < n; i++) {
        int32_t column = idx[i];
        int64_t source = from[i], at = i;
        for (; at > 0 && idx[at - 1] > column; at--) {
            idx[at] = idx[at - 1];
            from[at] = from[at - 1];
        }
        idx[at] = column;
        from[at] = source;
    }
}

static void fill_pattern(sn_iterative *s, const sn_csr *a, const int32_t *number, const int32_t *row_of)
{
    for (int32_t u = 0; u < s->a.n; u++) {
        int64_t n = s->a.ptr[u];
        for (int64_t k = a->ptr[row_of[u]]; k < a->ptr[row_of[u] + 1]; k++) {
            if (number[a->idx[k]] < 0) continue;
            s->a.idx[n] = number[a->idx[k]];
            s->from[n++] = k;
        }
        sort_row(s->a.idx + s->a.ptr[u], s->from + s->a.ptr[u], n - s->a.ptr[u]);
    }
}

static sn_status take_pattern(sn_iterative *s, const sn_csr *a, const int32_t *number, int32_t n,
                              sn_error *err)
{
    int32_t *row_of = SN_NEW(int32_t, n);
    s->a.n = n;
    s->a.ptr = SN_NEW_ZERO(int64_t, (size_t)n + 1);
    for (int32_t i = 0; row_of && s->a.ptr && i < a->n; i++) {
        if (number[i] < 0) continue;
        row_of[number[i]] = i;
        for (int64_t k = a->ptr[i]; k < a->ptr[i + 1]; k++) s->a.ptr[number[i] + 1] += number[a->idx[k]] >= 0;
    }
    for (int32_t u = 0; row_of && s->a.ptr && u < n; u++) s->a.ptr[u + 1] += s->a.ptr[u];
    if (row_of && s->a.ptr) {
        s->a.idx = SN_NEW(int32_t, s->a.ptr[n]);
        s->a.val = SN_NEW(double, s->a.ptr[n]);
        s->from = SN_NEW(int64_t, s->a.ptr[n]);
    }
    bool ok = s->a.idx && s->a.val && s->from;
    if (ok) fill_pattern(s, a, number, row_of);
    sn_release(row_of);
    return ok ? SN_OK : sn_fail(err, SN_ENOMEM, "iterative solver: no memory for %d rows", n);
}

void sn_iterative_set_values(sn_iterative *s, const sn_csr *a)
{
    for (int64_t k = 0; k < s->a.ptr[s->a.n]; k++) s->a.val[k] = a->val[s->from[k]];
    if (s->amg) sn_amg_set_values(s->amg, s->a.val);
}

/* Takes time, and cannot be stopped: with what it needs, on a thread apart. */
typedef struct set_up {
    sn_iterative *solver;
    sn_status status;
    sn_error error;
} set_up;

static void make_amg(void *job)
{
    set_up *u = job;
    const sn_csr *a = &u->solver->a;
    u->status = sn_amg_create(&u->solver->amg, a->n, a->ptr, a->idx, a->val, &u->error);
}

static void leave_amg(void *job)
{
    set_up *u = job;
    sn_iterative_destroy(u->solver);
    sn_release(u);
}

/* s is gone when it is stopped. */
static sn_status precondition(sn_iterative **s, const sn_run *run, sn_error *err)
{
    set_up *u = SN_NEW_ZERO(set_up, 1);
    if (!u) return sn_fail(err, SN_ENOMEM, "iterative solver: no memory");
    u->solver = *s;
    sn_status st = sn_run_apart(run, "preconditioning", make_amg, leave_amg, u, err);
    if (st) {
        *s = NULL;
        return st;
    }
    st = u->status;
    if (st && err) *err = u->error;
    sn_release(u);
    return st;
}

sn_status sn_iterative_create(sn_iterative **out, const sn_csr *a, const int32_t *number, int32_t n,
                              const sn_run *run, sn_error *err)
{
    *out = NULL;
    if (n < 1) return sn_fail(err, SN_EINVAL, "iterative solver: the matrix has no rows");
    sn_iterative *s = SN_NEW_ZERO(sn_iterative, 1);
    if (!s) return sn_fail(err, SN_ENOMEM, "iterative solver: no memory");
    sn_status st = take_pattern(s, a, number, n, err);
    if (!st) sn_iterative_set_values(s, a);
    if (!st) st = precondition(&s, run, err);
    if (st)
        sn_iterative_destroy(s);
    else
        *out = s;
    return st;
}

/* ---- conjugate gradients ---- */

typedef struct vectors {
    size_t n;
    double *r, *z, *p, *q;
    sn_amg_cycle *cycle;
} vectors;

static void vectors_free(vectors *v)
{
    sn_release(v->r);
    sn_release(v->z);
    sn_release(v->p);
    sn_release(v->q);
    sn_amg_cycle_destroy(v->cycle);
}

static sn_status vectors_init(vectors *v, const sn_iterative *s, sn_error *err)
{
    v->n = (size_t)s->a.n;
    v->r = SN_NEW(double, v->n);
    v->z = SN_NEW(double, v->n);
    v->p = SN_NEW(double, v->n);
    v->q = SN_NEW(double, v->n);
    if (!v->r || !v->z || !v->p || !v->q)
        return sn_fail(err, SN_ENOMEM, "iterative solver: no memory for %d rows", s->a.n);
    return sn_amg_cycle_create(&v->cycle, s->amg, err);
}

static double dot(const double *a, const double *b, size_t n)
{
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

static void multiply(const sn_csr *a, const double *x, double *y)
{
    for (int32_t i = 0; i < a->n; i++) {
        double sum = 0.0;
        for (int64_t k = a->ptr[i]; k < a->ptr[i + 1]; k++) sum += a->val[k] * x[a->idx[k]];
        y[i] = sum;
    }
}

/* r := b - A x; returns its largest entry over that of b. */
static double find_residual(const sn_iterative *s, const double *b, const double *x, double *r)
{
    double worst = 0.0, largest = 0.0;
    multiply(&s->a, x, r);
    for (int32_t i = 0; i < s->a.n; i++) {
        r[i] = b[i] - r[i];
        worst = fmax(worst, fabs(r[i]));
        largest = fmax(largest, fabs(b[i]));
    }
    return largest > 0.0 ? worst / largest : worst;
}

/* From r with z = M^-1 r, until r'z is at most enough. */
static sn_status iterate(const sn_iterative *s, vectors *v, double enough, double *x, const sn_run *run,
                         int32_t *n_iter, sn_error *err)
{
    double rz = dot(v->r, v->z, v->n), start = rz;
    memcpy(v->p, v->z, v->n * sizeof *v->p);
    for (*n_iter = 0; rz > enough; (*n_iter)++) {
        sn_status st =
            sn_run_step(run, "iterating", start > enough ? log(start / rz) / log(start / enough) : -1.0, err);
        if (!st && *n_iter == most_iterations)
            st = sn_fail(err, SN_ESOLVE,
                         "the iterative solver stands at %.1e of where it began after %d iterations",
                         sqrt(rz / start), *n_iter);
        if (st) return st;
        multiply(&s->a, v->p, v->q);
        double step = rz / dot(v->p, v->q, v->n);
        for (size_t i = 0; i < v->n; i++) {
            x[i] += step * v->p[i];
            v->r[i] -= step * v->q[i];
        }
        st = sn_amg_apply(v->cycle, v->r, v->z, err);
        if (st) return st;
        double next = dot(v->r, v->z, v->n), ratio = next / rz;
        if (!(next >= 0.0)) return sn_fail(err, SN_ESOLVE, "the matrix is not positive definite");
        for (size_t i = 0; i < v->n; i++) v->p[i] = v->z[i] + ratio * v->p[i];
        rz = next;
    }
    return SN_OK;
}

sn_status sn_iterative_solve(const sn_iterative *s, const double *b, double *x, double tolerance,
                             const sn_run *run, sn_iterative_report *report, sn_error *err)
{
    vectors v = {0};
    sn_status st = sn_run_step(run, "iterating", -1.0, err); /* many of them may wait when it is stopped */
    if (!st) st = vectors_init(&v, s, err);
    if (!st) st = sn_amg_apply(v.cycle, b, v.z, err); /* what the whole of b weighs */
    double enough = st ? 0.0 : tolerance * tolerance * dot(b, v.z, v.n);
    if (!st) {
        (void)find_residual(s, b, x, v.r);
        st = sn_amg_apply(v.cycle, v.r, v.z, err);
    }
    if (!st) st = iterate(s, &v, enough, x, run, &report->iterations, err);
    if (!st) report->residual = find_residual(s, b, x, v.r);
    vectors_free(&v);
    return st;
}
