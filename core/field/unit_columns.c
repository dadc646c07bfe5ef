#include "field/unit_columns.h"

#include "base/alloc.h"
#include "field/cholesky_private.h"

#include <stdlib.h>
#include <string.h>

/* Columns that are of no use any more may be twice as many as the others. */
#define MOST_COLUMNS_REL 3

void sn_unit_columns_free(sn_unit_columns *u)
{
    for (int32_t i = 0; i < u->n_part; i++) sn_half_solve_destroy(u->part[i].y);
    sn_release(u->part);
    sn_release(u->unknown);
    sn_release(u->gram);
    *u = (sn_unit_columns){.c = u->c, .generation = u->generation + 1};
}

typedef struct wanted { /* a column that is not there yet */
    int32_t place;      /* in the order of elimination    */
    int32_t i;          /* among those asked for          */
} wanted;

static int compare(const void *pa, const void *pb)
{
    const wanted *a = pa, *b = pb;
    return a->place < b->place ? -1 : a->place > b->place;
}

/* column: -1 for those that are not there; they are put in the order of elimination, so that the columns on
 * any path lie side by side. Returns how many. */
static int32_t find_columns(const sn_unit_columns *u, const int32_t *unknown, int32_t n, int32_t *column,
                            wanted *missing)
{
    int32_t n_missing = 0;
    for (int32_t i = 0; i < n; i++) {
        column[i] = -1;
        for (int32_t k = 0; k < u->width && column[i] < 0; k++)
            if (u->unknown[k] == unknown[i]) column[i] = k;
        if (column[i] < 0) missing[n_missing++] = (wanted){u->c->order->column_of[unknown[i]], i};
    }
    if (n_missing > 1) qsort(missing, (size_t)n_missing, sizeof *missing, compare);
    return n_missing;
}

typedef struct products { /* of a new part with all */
    const sn_unit_columns *u;
    const sn_unit_part *new;
    double *gram; /* width x width: has those of the others */
} products;

/* With part p; the one after the last is the new one itself. */
static sn_status add_product(void *user, int32_t p, const sn_run *run, sn_error *err)
{
    const products *job = user;
    const sn_unit_part *new = job->new, *with = p < job->u->n_part ? &job->u->part[p] : new;
    size_t n = (size_t) new->n, n_with = (size_t)with->n, width = (size_t) new->first + n;
    sn_status st = sn_run_step(run, "solving", -1.0, err);
    double *block = st ? NULL : SN_NEW(double, n_with *n);
    if (!st && !block) st = sn_fail(err, SN_ENOMEM, "cholesky: no memory for %zu columns", width);
    if (st) return st;
    if (with == new)
        sn_half_solve_gram(new->y, block);
    else
        sn_half_solve_product(with->y, new->y, block);
    for (size_t j = 0; j < n; j++)
        for (size_t i = 0; i < n_with; i++) {
            size_t a = (size_t)with->first + i, b = (size_t) new->first + j;
            job->gram[b * width + a] = job->gram[a * width + b] = block[j * n_with + i];
        }
    sn_release(block);
    return SN_OK;
}

/* Columns for these unknowns behind the others. */
static sn_status append(sn_unit_columns *u, const int32_t *unknown, int32_t n, const sn_run *run,
                        sn_error *err)
{
    size_t old = (size_t)u->width, width = old + (size_t)n;
    sn_unit_part new = {NULL, u->width, n}, *part = sn_realloc(u->part, (size_t)u->n_part + 1, sizeof *part);
    if (part) u->part = part;
    int32_t *all = sn_realloc(u->unknown, width, sizeof *all);
    if (all) u->unknown = all;
    double *gram = SN_NEW(double, width *width);
    sn_status st = part && all && gram
                       ? sn_half_solve_create_units(&new.y, u->c, unknown, n, run, err)
                       : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %zu columns", width);
    for (size_t j = 0; !st && j < old; j++) memcpy(gram + j * width, u->gram + j * old, old * sizeof *gram);
    products job = {u, &new, gram};
    if (!st) st = sn_run_each(run, u->n_part + 1, add_product, &job, err);
    if (st) {
        sn_half_solve_destroy(new.y);
        sn_release(gram);
        return st;
    }
    memcpy(all + old, unknown, (size_t)n * sizeof *all);
    sn_release(u->gram);
    u->gram = gram;
    u->part[u->n_part++] = new;
    u->width += n;
    return SN_OK;
}

sn_status sn_unit_columns_need(sn_unit_columns *u, const int32_t *unknown, int32_t n, int32_t *column,
                               const sn_run *run, sn_error *err)
{
    wanted *missing = SN_NEW(wanted, n);
    int32_t *new = SN_NEW(int32_t, n), n_missing = 0;
    sn_status st = missing && new ? SN_OK : sn_fail(err, SN_ENOMEM, "cholesky: no memory for %d columns", n);
    if (!st) n_missing = find_columns(u, unknown, n, column, missing);
    if (!st && u->width + n_missing > MOST_COLUMNS_REL * n) { /* mostly of no use: anew */
        sn_unit_columns_free(u);
        n_missing = find_columns(u, unknown, n, column, missing);
    }
    for (int32_t k = 0; !st && k < n_missing; k++) {
        new[k] = unknown[missing[k].i];
        column[missing[k].i] = u->width + k;
    }
    if (!st && n_missing > 0) st = append(u, new, n_missing, run, err);
    sn_release(missing);
    sn_release(new);
    return st;
}
