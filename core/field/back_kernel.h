/* back_kernel.h - the innermost loops of back_solve.c, for one kind of vector: included once for each.
 *
 * Before: KERNEL, a name; LANES, doubles in a vector; TARGET, an attribute of functions or nothing.
 * After: KERNEL, a `kernel`. */
#define NAME2(kernel, what) kernel##_##what
#define NAME1(kernel, what) NAME2(kernel, what)
#define NAME(what) NAME1(KERNEL, what)
#define vec NAME(vec)
#define INLINE static inline __attribute__((always_inline))

typedef double vec __attribute__((vector_size(LANES * sizeof(double)), aligned(sizeof(double))));

/* sum[i] += L(rows, column + i)' z for n columns and w vectors. */
INLINE void NAME(add_products)(const double *l, int all, int n_row, const double *z, size_t stride, int n,
                               int w, vec sum[most_columns][most_vecs])
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
INLINE void NAME(solve_columns)(const block *b, int column, int n, int w)
{
    vec sum[most_columns][most_vecs] = {0};
    size_t all = (size_t)b->all;
    const double *l = b->l + (size_t)column * all;
    int next = column + n;
    NAME(add_products)
    (l + next, b->all, b->own - next, b->x + (size_t)next * b->stride, b->stride, n, w, sum);
    NAME(add_products)(l + b->own, b->all, b->all - b->own, b->below, b->below_stride, n, w, sum);
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

INLINE void NAME(solve_block)(const block *b, int w)
{
    int column = b->last;
    for (; column - b->first >= most_columns; column -= most_columns)
        NAME(solve_columns)(b, column - most_columns, most_columns, w);
    for (; column > b->first; column--) NAME(solve_columns)(b, column - 1, 1, w);
}

TARGET static void NAME(solve_1)(const block *b)
{
    NAME(solve_block)(b, 1);
}

TARGET static void NAME(solve_2)(const block *b)
{
    NAME(solve_block)(b, 2);
}

TARGET static void NAME(solve_3)(const block *b)
{
    NAME(solve_block)(b, 3);
}

static const kernel KERNEL = {LANES, {NULL, NAME(solve_1), NAME(solve_2), NAME(solve_3)}};

#undef NAME2
#undef NAME1
#undef NAME
#undef vec
#undef INLINE
#undef KERNEL
#undef LANES
#undef TARGET
