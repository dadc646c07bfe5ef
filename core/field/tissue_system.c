#include "field/tissue_system.h"

#include "base/alloc.h"
#include "field/tissue_change.h"

#include <math.h>
#include <string.h>

/* Unknowns that what a factor is off by may touch: a new one costs about a right-hand side, forward only
 * (unknowns^4/3), a new factor unknowns^2; all together the factors of a dense matrix, which bounds them in
 * any case. */
#define CHANGES_PER_SIZE 0.35 /* of unknowns^2/3 */
enum { least_changes = 200, most_changes = 2000 };
/* A factor worse than this is used as it is, but no change is built on it. */
#define LEAST_RCOND 1e-12
/* Unknowns of rows of before at which fields are looked at; when there are more, all fields are solved for.
 */
#define MOST_PROBES 200

void sn_tissue_system_free(sn_tissue_system *s)
{
    sn_cholesky_destroy(s->cholesky);
    sn_iterative_destroy(s->iterative);
    sn_low_rank_destroy(s->change);
    sn_half_cache_free(&s->half);
    sn_row_set_free(&s->base);
    for (int32_t i = 0; i < s->n_state; i++) sn_row_set_free(&s->state[i].set);
    sn_release(s->state);
    *s = (sn_tissue_system){0};
}

void sn_tissue_system_forget(sn_tissue_system *s)
{
    s->alpha = 0.0;
    s->followed = 0;
    s->can_see = false;
}

/* ---- a new factor ---- */

/* matrix += alpha B'B; a row of B touches the four corners of one tet, so it stays in the pattern. */
static void add_rows(sn_csr *matrix, const sn_tissue_rows *rows)
{
    for (int32_t r = 0; r < rows->set->n; r++) {
        const sn_row *row = &rows->set->row[r];
        const int32_t *v = rows->tet + 4 * (size_t)row->tet;
        for (int a = 0; a < 4; a++)
            for (int b = 0; b < 4; b++)
                matrix->val[sn_csr_find(matrix, v[a], v[b])] += rows->alpha * row->bary[a] * row->bary[b];
    }
}

static sn_status factorize(sn_tissue_system *s, const sn_tissue_rows *rows, sn_csr *matrix, sn_fill_fn fill,
                           const void *user, const sn_run *run, sn_error *err)
{
    sn_low_rank_destroy(s->change);
    s->change = NULL;
    sn_half_cache_free(&s->half);
    sn_tissue_system_forget(s);
    sn_status st = sn_run_step(run, "assembling", -1.0, err);
    if (!st) fill(user, matrix);
    if (!st) add_rows(matrix, rows);
    if (!st) st = sn_cholesky_factorize(s->cholesky, matrix, run, err);
    if (!st) st = sn_row_set_copy(&s->base, rows->set, err);
    if (!st) st = sn_low_rank_create(&s->change, s->cholesky, err);
    if (!st && sn_cholesky_rcond(s->cholesky) > LEAST_RCOND) s->alpha = rows->alpha;
    return st;
}

/* ---- what changed ---- */

static sn_status join_states(const sn_tissue_system *s, sn_row_set *past, sn_error *err)
{
    sn_status st = SN_OK;
    for (int32_t i = 0; !st && i < s->n_state; i++) st = sn_row_set_join(past, &s->state[i].set, past, err);
    return st;
}

static int32_t changes_allowed(int32_t n_free)
{
    double n = CHANGES_PER_SIZE * pow(n_free, 2.0 / 3.0);
    return n < least_changes ? least_changes : n > most_changes ? most_changes : (int32_t)n;
}

/* *is_near: whether the factor is still near enough. */
static sn_status change(sn_tissue_system *s, const sn_tissue_rows *rows, bool with_probes, const sn_run *run,
                        bool *is_near, sn_error *err)
{
    sn_tissue_change c = {0};
    sn_row_set past = {0};
    sn_status st = with_probes ? join_states(s, &past, err) : SN_OK;
    if (!st) st = sn_tissue_change_find(&c, &s->base, rows, &past, err);
    *is_near = !st && c.n_touched <= changes_allowed(rows->n_free);
    s->can_see = with_probes && c.n_probe <= MOST_PROBES;
    if (*is_near) {
        const sn_low_rank_terms terms = {
            {c.n_term, c.ptr, c.index, c.value}, c.weight, c.probe, s->can_see ? c.n_probe : 0};
        st = sn_low_rank_set(s->change, &terms, run, err);
    }
    sn_row_set_free(&past);
    sn_tissue_change_free(&c);
    return st;
}

/* Of an iterative system. Another alpha: the preconditioner is made again, too. */
static sn_status follow_by_values(sn_tissue_system *s, const sn_tissue_rows *rows, sn_csr *matrix,
                                  sn_fill_fn fill, const void *user, const sn_run *run, bool *was_made,
                                  sn_error *err)
{
    sn_status st = sn_run_step(run, "assembling", -1.0, err);
    if (st) return st;
    fill(user, matrix);
    add_rows(matrix, rows);
    if (s->iterative && s->alpha == rows->alpha) {
        sn_iterative_set_values(s->iterative, matrix);
    } else {
        *was_made = true;
        sn_tissue_system_forget(s);
        sn_iterative_destroy(s->iterative);
        st = sn_iterative_create(&s->iterative, matrix, rows->number, rows->n_free, run, err);
        if (!st) s->alpha = rows->alpha;
    }
    if (!st) s->followed = rows->revision;
    return st;
}

sn_status sn_tissue_system_follow(sn_tissue_system *s, const sn_tissue_rows *rows, bool with_probes,
                                  sn_csr *matrix, sn_fill_fn fill, const void *user, const sn_run *run,
                                  bool *was_factorized, sn_error *err)
{
    bool is_near = false;
    sn_status st = SN_OK;
    *was_factorized = false;
    if (s->followed == rows->revision) return SN_OK;
    if (!s->cholesky) return follow_by_values(s, rows, matrix, fill, user, run, was_factorized, err);
    if (sn_cholesky_is_factorized(s->cholesky) && s->alpha == rows->alpha) {
        st = change(s, rows, with_probes, run, &is_near, err);
        if (st == SN_ESOLVE) { /* lost in the difference: as if it were far */
            is_near = false;
            st = SN_OK;
        }
    }
    if (!st && !is_near) {
        *was_factorized = true;
        st = factorize(s, rows, matrix, fill, user, run, err);
        if (!st) st = change(s, rows, false, run, &is_near, err);
    }
    if (!st) s->followed = rows->revision;
    return st;
}

/* ---- the matrices that fields are of ---- */

static bool is_in(uint64_t revision, const uint64_t *solved_at, int32_t n)
{
    for (int32_t i = 0; i < n; i++)
        if (solved_at[i] == revision) return true;
    return false;
}

sn_status sn_tissue_system_settle(sn_tissue_system *s, const sn_tissue_rows *rows, const uint64_t *solved_at,
                                  int32_t n, sn_error *err)
{
    int32_t kept = 0;
    bool has_now = false;
    for (int32_t i = 0; i < s->n_state; i++) {
        if (is_in(s->state[i].revision, solved_at, n)) {
            has_now = has_now || s->state[i].revision == rows->revision;
            s->state[kept++] = s->state[i];
        } else {
            sn_row_set_free(&s->state[i].set);
        }
    }
    s->n_state = kept;
    if (has_now || !is_in(rows->revision, solved_at, n)) return SN_OK;
    sn_tissue_state *state = sn_realloc(s->state, (size_t)kept + 1, sizeof *state);
    if (!state) return sn_fail(err, SN_ENOMEM, "tissue: no memory for %d rows", rows->set->n);
    s->state = state;
    s->state[kept] = (sn_tissue_state){.revision = rows->revision};
    sn_status st = sn_row_set_copy(&s->state[kept].set, rows->set, err);
    if (!st) s->n_state++;
    return st;
}
