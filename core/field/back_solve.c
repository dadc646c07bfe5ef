/* BLAS packs the factor anew for each call, which costs more than the product when the right-hand sides are
 * few. Here a column of the factor is read once, as it lies, and its products with all right-hand sides stay
 * in registers. */
#include "field/back_solve.h"

#include <string.h>

enum {
    most_columns = 4, /* of L at a time */
    most_vecs = 3,    /* vectors of right-hand sides: all sums stay in registers */
    panel = 16384     /* entries of L that stay in the cache for all right-hand sides */
};

typedef struct block { /* one supernode, some of the right-hand sides */
    const double *l;   /* all x own, column-major      */
    int own, all;
    int first, last;             /* columns to solve for: those from last on are done */
    size_t stride, below_stride; /* values per row of x and below */
    double *x;                   /* its own rows                 */
    const double *below;         /* the rows below, gathered     */
} block;

typedef struct kernel {
    int lanes;                                   /* right-hand sides in a vector */
    void (*solve[most_vecs + 1])(const block *); /* for so many vectors          */
} kernel;

#define KERNEL plain
#define LANES 2
#define TARGET
#include "field/back_kernel.h"

/* Fused multiply-adds where the processor has them: the same bits on every run of one machine, as of BLAS. */
#if defined(__x86_64__) && defined(__GNUC__)
#define KERNEL avx2
#define LANES 4
#define TARGET __attribute__((target("avx2,fma"), optimize("fp-contract=fast")))
#include "field/back_kernel.h"

#define KERNEL avx512
#define LANES 8
#define TARGET __attribute__((target("avx512f"), optimize("fp-contract=fast")))
#include "field/back_kernel.h"
#endif

static const kernel *best_kernel(void)
{
#if defined(__x86_64__) && defined(__GNUC__)
    if (__builtin_cpu_supports("avx512f")) return &avx512;
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return &avx2;
#endif
    return &plain;
}

/* One right-hand side: BLAS reads the factor as it lies, too. */
static void solve_1(const block *b)
{
    int under = b->all - b->own;
    if (under > 0)
        cblas_dgemv(CblasColMajor, CblasTrans, under, b->own, -1.0, b->l + b->own, b->all, b->below, 1, 1.0,
                    b->x, 1);
    cblas_dtrsv(CblasColMajor, CblasLower, CblasTrans, CblasNonUnit, b->own, b->l, b->all, b->x, 1);
}

int32_t sn_back_solve_width(int32_t n_rhs)
{
    return n_rhs == 1 ? 1 : (n_rhs + SN_LANES - 1) / SN_LANES * SN_LANES;
}

/* All right-hand sides, as many at a time as stay in registers. */
static void solve_panel(const block *b, int32_t n, const kernel *with)
{
    const int32_t most = most_vecs * with->lanes;
    for (int32_t from = 0; from < n; from += most) {
        block part = *b;
        part.x += from;
        part.below += from;
        with->solve[(n - from < most ? n - from : most) / with->lanes](&part);
    }
}

/* The rows below: those of the branch come first, as they are ascending. */
static void gather(const sn_strip *s, const SuiteSparse_long *row, int n_row)
{
    const int32_t *trunk_row = s->c->order->tree.trunk_row;
    size_t width = (size_t)s->width, n = (size_t)s->n, size = n * sizeof(double);
    double *to = s->below;
    int i = 0;
    for (; s->branch && i < n_row && row[i] < s->last; i++, to += n)
        memcpy(to, s->branch + (size_t)(row[i] - s->first) * width, size);
    for (; i < n_row; i++, to += n) memcpy(to, s->trunk + (size_t)trunk_row[row[i]] * width + s->from, size);
}

void sn_back_solve(const sn_strip *s, size_t k)
{
    const cholmod_factor *f = s->c->factor;
    size_t n = (size_t)s->n;
    block b = {.l = sn_super_block(f, k),
               .own = sn_super_own(f, k),
               .all = sn_super_all(f, k),
               .stride = (size_t)s->width,
               .below_stride = n,
               .x = sn_strip_row(s, sn_supers(f)[k]),
               .below = s->below};
    gather(s, sn_super_rows(f, k) + b.own, b.all - b.own);
    if (s->width == 1) {
        solve_1(&b);
        return;
    }
    const kernel *with = best_kernel();
    int n_column = panel / b.all / most_columns * most_columns;
    if (n_column < most_columns) n_column = most_columns;
    for (b.last = b.own; b.last > 0; b.last = b.first) {
        b.first = b.last > n_column ? b.last - n_column : 0;
        solve_panel(&b, s->n, with);
    }
}
