#include "field/half_cache.h"

#include "base/alloc.h"

#include <string.h>

/* Each is a term of every solve. */
enum { most_batches = 4 };

static void drop_products(sn_half_batch *b)
{
    for (int32_t i = 0; i < b->n_product; i++) sn_release(b->product[i]);
    sn_release(b->product);
    b->product = NULL;
    b->n_product = 0;
}

static void free_batch(sn_half_batch *b)
{
    drop_products(b);
    sn_half_solve_destroy(b->z);
    sn_release(b->ptr);
    sn_release(b->index);
    sn_release(b->value);
    sn_release(b->key);
}

void sn_half_cache_free(sn_half_cache *h)
{
    for (int32_t i = 0; i < h->n_batch; i++) free_batch(&h->batch[i]);
    sn_release(h->batch);
    *h = (sn_half_cache){0};
}

static sn_sparse_vectors vectors_of(const sn_half_batch *b)
{
    return (sn_sparse_vectors){sn_half_solve_count(b->z), b->ptr, b->index, b->value};
}

/* ---- what is there ---- */

typedef struct search {
    const sn_half_wanted *w;
    double *difference; /* n_unknown: all 0 between two comparisons        */
    int32_t *column_of; /* n_unknown: -1 for unknowns without a column     */
} search;

static void close_search(search *s)
{
    sn_release(s->difference);
    sn_release(s->column_of);
}

static sn_status open_search(search *s, const sn_half_wanted *w, sn_error *err)
{
    *s = (search){w, SN_NEW_ZERO(double, w->n_unknown), SN_NEW(int32_t, w->n_unknown)};
    if (!s->difference || !s->column_of) {
        close_search(s);
        return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d rows", w->n_unknown);
    }
    for (int32_t u = 0; u < w->n_unknown; u++) s->column_of[u] = -1;
    for (int32_t k = 0; k < w->e->width; k++) s->column_of[w->e->unknown[k]] = k;
    return SN_OK;
}

static void add_vector(search *s, double sign, const sn_sparse_vectors *b, int32_t j)
{
    for (int32_t e = b->ptr[j]; e < b->ptr[j + 1]; e++) s->difference[b->index[e]] += sign * b->value[e];
}

/* Whether there is a column wherever the vector has an unknown and the difference is not 0. */
static bool has_columns(const search *s, const sn_sparse_vectors *b, int32_t j)
{
    bool ok = true;
    for (int32_t e = b->ptr[j]; ok && e < b->ptr[j + 1]; e++)
        ok = s->difference[b->index[e]] == 0.0 || s->column_of[b->index[e]] >= 0;
    return ok;
}

/* The difference becomes 0 at the vector's unknowns; what it was goes to rest (NULL: nowhere). */
static void clear(search *s, const sn_sparse_vectors *b, int32_t j, double *rest)
{
    for (int32_t e = b->ptr[j]; e < b->ptr[j + 1]; e++) {
        int32_t u = b->index[e];
        if (rest && s->difference[u] != 0.0) rest[s->column_of[u]] = s->difference[u];
        s->difference[u] = 0.0;
    }
}

/* Whether vector j is that of `old` (NULL: nothing) but for unknowns with a column. rest, all 0, receives the
 * difference. */
static bool is_near(search *s, int32_t j, const sn_sparse_vectors *old, int32_t i, double *rest)
{
    const sn_sparse_vectors *b = &s->w->b;
    add_vector(s, 1.0, b, j);
    if (old) add_vector(s, -1.0, old, i);
    bool ok = has_columns(s, b, j) && (!old || has_columns(s, old, i));
    clear(s, b, j, ok ? rest : NULL);
    if (old) clear(s, old, i, ok ? rest : NULL);
    return ok;
}

static sn_half_place find_place(const sn_half_cache *h, search *s, int32_t j, double *rest, bool *is_there)
{
    *is_there = true;
    for (int32_t i = 0; i < h->n_batch; i++) {
        const sn_sparse_vectors old = vectors_of(&h->batch[i]);
        for (int32_t k = 0; k < old.n; k++)
            if (h->batch[i].key[k] == s->w->key[j] && is_near(s, j, &old, k, rest))
                return (sn_half_place){i, k};
    }
    *is_there = is_near(s, j, NULL, 0, rest);
    return (sn_half_place){-1, 0};
}

/* is_missing: b.n. Returns how many are. */
static int32_t find_places(sn_half_cache *h, search *s, sn_half_place *place, double *rest, bool *is_missing)
{
    size_t width = (size_t)s->w->e->width;
    int32_t n_missing = 0;
    if (width > 0) memset(rest, 0, width * (size_t)s->w->b.n * sizeof *rest);
    for (int32_t j = 0; j < s->w->b.n; j++) {
        bool is_there;
        place[j] = find_place(h, s, j, rest + (size_t)j * width, &is_there);
        is_missing[j] = !is_there;
        n_missing += !is_there;
        if (place[j].i_batch >= 0) h->batch[place[j].i_batch].last_use = h->n_use;
    }
    return n_missing;
}

/* ---- what is not ---- */

/* Which batch is given up: the one not used for longest, but for the one with the most columns. */
static int32_t find_least(const sn_half_cache *h)
{
    int32_t largest = 0, least = -1;
    for (int32_t i = 1; i < h->n_batch; i++)
        if (sn_half_solve_count(h->batch[i].z) > sn_half_solve_count(h->batch[largest].z)) largest = i;
    for (int32_t i = 0; i < h->n_batch; i++)
        if (i != largest && (least < 0 || h->batch[i].last_use < h->batch[least].last_use)) least = i;
    return least;
}

static sn_status make_batch(sn_half_batch *b, const sn_half_wanted *w, const bool *is_missing,
                            int32_t n_missing, const sn_run *run, sn_error *err)
{
    int32_t n_entry = w->b.ptr[w->b.n], n = 0;
    *b = (sn_half_batch){.ptr = SN_NEW_ZERO(int32_t, (size_t)n_missing + 1),
                         .index = SN_NEW(int32_t, n_entry),
                         .value = SN_NEW(double, n_entry),
                         .key = SN_NEW(uint64_t, n_missing)};
    if (!b->ptr || !b->index || !b->value || !b->key)
        return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d vectors", n_missing);
    for (int32_t j = 0; j < w->b.n; j++) {
        if (!is_missing[j]) continue;
        size_t count = (size_t)(w->b.ptr[j + 1] - w->b.ptr[j]);
        if (count > 0) memcpy(b->index + b->ptr[n], w->b.index + w->b.ptr[j], count * sizeof *b->index);
        if (count > 0) memcpy(b->value + b->ptr[n], w->b.value + w->b.ptr[j], count * sizeof *b->value);
        b->ptr[n + 1] = b->ptr[n] + (int32_t)count;
        b->key[n++] = w->key[j];
    }
    const sn_sparse_vectors missing = {n, b->ptr, b->index, b->value};
    return sn_half_solve_create(&b->z, w->e->c, &missing, run, err);
}

/* Makes what is missing the last batch. */
static sn_status add_batch(sn_half_cache *h, const sn_half_wanted *w, const bool *is_missing,
                           int32_t n_missing, const sn_run *run, sn_half_place *place, sn_error *err)
{
    sn_half_batch *batch = sn_realloc(h->batch, (size_t)h->n_batch + 1, sizeof *batch);
    if (!batch) return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d vectors", n_missing);
    h->batch = batch;
    sn_status st = make_batch(&batch[h->n_batch], w, is_missing, n_missing, run, err);
    if (st) {
        free_batch(&batch[h->n_batch]);
        return st;
    }
    batch[h->n_batch].last_use = h->n_use;
    for (int32_t j = 0, column = 0; j < w->b.n; j++)
        if (is_missing[j]) place[j] = (sn_half_place){h->n_batch, column++};
    h->n_batch++;
    return SN_OK;
}

sn_status sn_half_cache_need(sn_half_cache *h, const sn_half_wanted *w, const sn_run *run,
                             sn_half_place *place, double *rest, sn_error *err)
{
    search s;
    sn_status st = open_search(&s, w, err);
    if (st) return st;
    bool *is_missing = SN_NEW(bool, w->b.n);
    if (!is_missing) st = sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d vectors", w->b.n);
    h->n_use++;
    int32_t n_missing = st ? 0 : find_places(h, &s, place, rest, is_missing);
    if (n_missing > 0 && h->n_batch == most_batches) {
        int32_t least = find_least(h);
        free_batch(&h->batch[least]);
        h->batch[least] = h->batch[--h->n_batch];
        n_missing = find_places(h, &s, place, rest, is_missing);
    }
    if (n_missing > 0) st = add_batch(h, w, is_missing, n_missing, run, place, err);
    close_search(&s);
    sn_release(is_missing);
    return st;
}

/* ---- products ---- */

/* Room for products with all parts; those with columns that were given up go. */
static sn_status open_products(sn_half_batch *b, const sn_unit_columns *e, sn_error *err)
{
    if (b->generation != e->generation) drop_products(b);
    b->generation = e->generation;
    double **product = sn_realloc(b->product, (size_t)e->n_part, sizeof(double *));
    if (!product) return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d columns", e->width);
    b->product = product;
    for (; b->n_product < e->n_part; b->n_product++) b->product[b->n_product] = NULL;
    return SN_OK;
}

typedef struct multiplying {
    sn_half_cache *h;
    const sn_unit_columns *e;
    const bool *is_used; /* n_batch */
} multiplying;

static sn_status multiply(void *user, int32_t i, const sn_run *run, sn_error *err)
{
    const multiplying *m = user;
    sn_half_batch *b = &m->h->batch[i / m->e->n_part];
    const sn_unit_part *part = &m->e->part[i % m->e->n_part];
    double **product = m->is_used[i / m->e->n_part] ? &b->product[i % m->e->n_part] : NULL;
    if (!product || *product) return SN_OK;
    sn_status st = sn_run_step(run, "solving", -1.0, err);
    if (st) return st;
    *product = SN_NEW(double, (size_t)part->n *(size_t)sn_half_solve_count(b->z));
    if (!*product) return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d columns", part->n);
    sn_half_solve_product(part->y, b->z, *product);
    return SN_OK;
}

static void put_seen(const sn_half_cache *h, const sn_unit_columns *e, sn_half_place place, double *seen)
{
    if (place.i_batch < 0) {
        if (e->width > 0) memset(seen, 0, (size_t)e->width * sizeof *seen);
        return;
    }
    for (int32_t p = 0; p < e->n_part; p++) {
        size_t n = (size_t)e->part[p].n;
        memcpy(seen + e->part[p].first, h->batch[place.i_batch].product[p] + (size_t)place.column * n,
               n * sizeof *seen);
    }
}

sn_status sn_half_cache_see(sn_half_cache *h, const sn_unit_columns *e, const sn_half_place *place, int32_t n,
                            const sn_run *run, double *seen, sn_error *err)
{
    bool is_used[most_batches] = {false};
    sn_status st = SN_OK;
    for (int32_t j = 0; j < n; j++)
        if (place[j].i_batch >= 0) is_used[place[j].i_batch] = true;
    for (int32_t i = 0; i < h->n_batch && !st; i++)
        if (is_used[i]) st = open_products(&h->batch[i], e, err);
    multiplying m = {h, e, is_used};
    if (!st) st = sn_run_each(run, h->n_batch * e->n_part, multiply, &m, err);
    for (size_t j = 0; !st && j < (size_t)n; j++) put_seen(h, e, place[j], seen + j * (size_t)e->width);
    return st;
}
