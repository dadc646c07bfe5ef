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
typedef double vec __attribute__((vector_size(SN_LANES * sizeof(double)), aligned(sizeof(double))));

typedef struct block { /* one supernode, some of the right-hand sides */
    const double *l;   /* all x own, column-major      */
    int own, all;
    int first, last;             /* columns to solve for: those from last on are done */
    size_t stride, below_stride; /* values per row of x and below */
    double *x;                   /* its own rows                 */
    const double *below;         /* the rows below, gathered     */
} block;

typedef vec sums[most_columns][most_vecs];

/* sum[i] += L(rows, column + i)' z for n columns and w vectors. */
static inline __attribute__((always_inline)) void add_products(const double *l, int all, int n_row,
                                                               const double *z, size_t stride, int n, int w,
                                                               sums sum)
{
    for (int r = 0; r < n_row; r++) {
        const vec *row = (const vec *)(z + (size_t)r * stride);
#pragma GCC unroll 4
        for (int i = 0; i < n; i++) {
            double entry = l[(size_t)i * (size_t)all + (size_t)r];
#pragma GCC unroll 4
            for (int k = 0; k < w; k++) sum[i][k] += entry * row[k];
        }
    }
}

/* The columns column .. column + n - 1 of a supernode; those after them are done. */
static inline __attribute__((always_inline)) void solve_columns(const block *b, int column, int n, int w)
{
    sums sum = {0};
    size_t all = (size_t)b->all;
    const double *l = b->l + (size_t)column * all;
    int next = column + n;
    add_products(l + next, b->all, b->own - next, b->x + (size_t)next * b->stride, b->stride, n, w, sum);
    add_products(l + b->own, b->all, b->all - b->own, b->below, b->below_stride, n, w, sum);
#pragma GCC unroll 4
    for (int i = n - 1; i >= 0; i--) {
        vec *x = (vec *)(b->x + (size_t)(column + i) * b->stride);
#pragma GCC unroll 4
        for (int j = i + 1; j < n; j++) {
            const vec *done = (const vec *)(b->x + (size_t)(column + j) * b->stride);
#pragma GCC unroll 4
            for (int k = 0; k < w; k++) sum[i][k] += l[(size_t)i * all + (size_t)(column + j)] * done[k];
        }
#pragma GCC unroll 4
        for (int k = 0; k < w; k++) x[k] = (x[k] - sum[i][k]) / l[(size_t)i * all + (size_t)(column + i)];
    }
}

static inline __attribute__((always_inline)) void solve_block(const block *b, int n, int w)
{
    int column = b->last;
    for (; column - b->first >= n; column -= n) solve_columns(b, column - n, n, w);
    for (; column > b->first; column--) solve_columns(b, column - 1, 1, w);
}

/* For one, two and three vectors of right-hand sides, with n columns of L at a time. */
#define SOLVERS(name, n, target)                                                                             \
    target static void name##_1(const block *b)                                                              \
    {                                                                                                        \
        solve_block(b, n, 1);                                                                                \
    }                                                                                                        \
    target static void name##_2(const block *b)                                                              \
    {                                                                                                        \
        solve_block(b, n, 2);                                                                                \
    }                                                                                                        \
    target static void name##_3(const block *b)                                                              \
    {                                                                                                        \
        solve_block(b, n, 3);                                                                                \
    }                                                                                                        \
    static const solve_fn name[] = {NULL, name##_1, name##_2, name##_3};

typedef void (*solve_fn)(const block *);
SOLVERS(plain, 2, )
/* Fused multiply-adds where the processor has them: the same bits on every run of one machine, as of BLAS. */
#if defined(__x86_64__) && defined(__GNUC__)
#define FUSED optimize("fp-contract=fast")
SOLVERS(avx2, 2, __attribute__((target("avx2,fma"), FUSED)))
SOLVERS(avx512, 4, __attribute__((target("avx512f"), FUSED)))
#endif

static const solve_fn *solvers(void)
{
#if defined(__x86_64__) && defined(__GNUC__)
    if (__builtin_cpu_supports("avx512f")) return avx512;
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return avx2;
#endif
    return plain;
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
static void solve_panel(const block *b, int32_t n, const solve_fn *solve)
{
    const int32_t most = most_vecs * SN_LANES;
    for (int32_t from = 0; from < n; from += most) {
        block part = *b;
        part.x += from;
        part.below += from;
        solve[(n - from < most ? n - from : most) / SN_LANES](&part);
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
    const solve_fn *solve = solvers();
    int n_column = panel / b.all / most_columns * most_columns;
    if (n_column < most_columns) n_column = most_columns;
    for (b.last = b.own; b.last > 0; b.last = b.first) {
        b.first = b.last > n_column ? b.last - n_column : 0;
        solve_panel(&b, s->n, solve);
    }
}
