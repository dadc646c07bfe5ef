#include "field/half_cache.h"

#include "base/alloc.h"

#include <string.h>

/* Each is a term of every solve. */
enum { most_batches = 4 };

void sn_half_cache_free(sn_half_cache *h)
{
    for (int32_t i = 0; i < h->n_batch; i++) sn_half_solve_destroy(h->batch[i].z);
    sn_release(h->batch);
    sn_release(h->place);
    *h = (sn_half_cache){0};
}

/* FNV-1a, eight bytes at a time. */
static uint64_t hash_of(const sn_sparse_vectors *b, int32_t j)
{
    uint64_t hash = 14695981039346656037u;
    for (int32_t e = b->ptr[j]; e < b->ptr[j + 1]; e++) {
        uint64_t bits;
        memcpy(&bits, &b->value[e], sizeof bits);
        hash = (hash ^ (uint64_t)(uint32_t)b->index[e]) * 1099511628211u;
        hash = (hash ^ bits) * 1099511628211u;
        hash ^= hash >> 29;
    }
    return hash;
}

/* Returns how many are not there; their i_batch is -1. */
static int32_t find_places(const sn_half_cache *h, const sn_sparse_vectors *b, sn_half_place *place)
{
    int32_t n_new = 0;
    for (int32_t j = 0; j < b->n; j++) {
        place[j] = (sn_half_place){-1, 0, hash_of(b, j)};
        for (int32_t k = 0; k < h->n_place && place[j].i_batch < 0; k++)
            if (h->place[k].hash == place[j].hash) place[j] = h->place[k];
        n_new += place[j].i_batch < 0;
    }
    return n_new;
}

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

static void drop_batch(sn_half_cache *h, int32_t i_batch)
{
    int32_t n = 0;
    sn_half_solve_destroy(h->batch[i_batch].z);
    h->batch[i_batch] = h->batch[--h->n_batch];
    for (int32_t k = 0; k < h->n_place; k++) {
        sn_half_place p = h->place[k];
        if (p.i_batch == i_batch) continue;
        if (p.i_batch == h->n_batch) p.i_batch = i_batch; /* the last one took its place */
        h->place[n++] = p;
    }
    h->n_place = n;
}

static sn_status half_solve_new(const sn_cholesky *c, const sn_sparse_vectors *b, const sn_half_place *place,
                                int32_t n_new, const sn_run *run, sn_half_solve **out, sn_error *err)
{
    int32_t *ptr = SN_NEW_ZERO(int32_t, (size_t)n_new + 1), *index = SN_NEW(int32_t, b->ptr[b->n]), n = 0;
    double *value = SN_NEW(double, b->ptr[b->n]);
    *out = NULL;
    sn_status st =
        ptr && index && value ? SN_OK : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d vectors", n_new);
    for (int32_t j = 0; !st && j < b->n; j++) {
        if (place[j].i_batch >= 0) continue;
        size_t n_entry = (size_t)(b->ptr[j + 1] - b->ptr[j]);
        if (n_entry > 0) memcpy(index + ptr[n], b->index + b->ptr[j], n_entry * sizeof *index);
        if (n_entry > 0) memcpy(value + ptr[n], b->value + b->ptr[j], n_entry * sizeof *value);
        ptr[n + 1] = ptr[n] + (int32_t)n_entry;
        n++;
    }
    if (!st) st = sn_half_solve_create(out, c, &(sn_sparse_vectors){n_new, ptr, index, value}, run, err);
    sn_release(ptr);
    sn_release(index);
    sn_release(value);
    return st;
}

/* Room for one batch of n_new. */
static sn_status need_room(sn_half_cache *h, int32_t n_new, sn_error *err)
{
    sn_half_batch *batch = sn_realloc(h->batch, (size_t)h->n_batch + 1, sizeof *batch);
    if (batch) h->batch = batch;
    sn_half_place *all = sn_realloc(h->place, (size_t)h->n_place + (size_t)n_new, sizeof *all);
    if (all) h->place = all;
    return batch && all ? SN_OK : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d vectors", n_new);
}

sn_status sn_half_cache_need(sn_half_cache *h, const sn_cholesky *c, const sn_sparse_vectors *b,
                             const sn_run *run, sn_half_place *place, sn_error *err)
{
    int32_t n_new = find_places(h, b, place);
    h->n_use++;
    for (int32_t j = 0; j < b->n; j++)
        if (place[j].i_batch >= 0) h->batch[place[j].i_batch].last_use = h->n_use;
    if (n_new == 0) return SN_OK;
    if (h->n_batch == most_batches) {
        drop_batch(h, find_least(h));
        n_new = find_places(h, b, place);
    }
    sn_half_solve *z;
    sn_status st = need_room(h, n_new, err);
    if (!st) st = half_solve_new(c, b, place, n_new, run, &z, err);
    if (st) return st;
    h->batch[h->n_batch] = (sn_half_batch){z, h->n_use};
    for (int32_t j = 0, column = 0; j < b->n; j++) {
        if (place[j].i_batch >= 0) continue;
        place[j].i_batch = h->n_batch;
        place[j].column = column++;
        h->place[h->n_place++] = place[j];
    }
    h->n_batch++;
    return SN_OK;
}
