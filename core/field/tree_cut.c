#include "field/tree_cut.h"

#include "base/alloc.h"
#include "field/cholesky_private.h"

#include <stdlib.h>

/* A branch has at most this part of all entries: two threads, or a few more, end at about the same time. */
#define LARGEST_BRANCH 0.08

void sn_tree_cut_free(sn_tree_cut *t)
{
    sn_release(t->parent);
    sn_release(t->branch);
    sn_release(t->trunk);
    sn_release(t->trunk_row);
    *t = (sn_tree_cut){0};
}

/* whole: each supernode with all below it. In postorder children come before their parent, side by side. */
static void find_whole(sn_tree_cut *t, const cholmod_factor *f, const int32_t *super_of, sn_branch *whole)
{
    int32_t n = (int32_t)f->nsuper;
    for (int32_t k = 0; k < n; k++) {
        int own = sn_super_own(f, (size_t)k), all = sn_super_all(f, (size_t)k);
        t->parent[k] = all > own ? super_of[sn_super_rows(f, (size_t)k)[own]] : -1;
        whole[k] = (sn_branch){k, k + 1, (int64_t)own * all};
    }
    for (int32_t k = 0; k < n; k++) {
        int32_t up = t->parent[k];
        if (up < 0) continue;
        whole[up].n_entry += whole[k].n_entry;
        if (whole[k].from < whole[up].from) whole[up].from = whole[k].from;
    }
}

static int heaviest_first(const void *pa, const void *pb)
{
    const sn_branch *a = pa, *b = pb;
    if (a->n_entry != b->n_entry) return a->n_entry > b->n_entry ? -1 : 1;
    return a->from < b->from ? -1 : a->from > b->from;
}

/* From the roots down: what is too heavy belongs to the trunk, and what is below it is looked at. */
static void cut(sn_tree_cut *t, int32_t n, const sn_branch *whole, bool *is_trunk)
{
    int64_t total = 0;
    for (int32_t k = 0; k < n; k++)
        if (t->parent[k] < 0) total += whole[k].n_entry;
    for (int32_t k = n - 1; k >= 0; k--) { /* parents first */
        bool is_below_trunk = t->parent[k] < 0 || is_trunk[t->parent[k]];
        is_trunk[k] = is_below_trunk && (double)whole[k].n_entry > LARGEST_BRANCH * (double)total;
        if (is_below_trunk && !is_trunk[k]) t->branch[t->n_branch++] = whole[k];
    }
    for (int32_t k = 0; k < n; k++)
        if (is_trunk[k]) t->trunk[t->n_trunk++] = k;
    if (t->n_branch > 1) qsort(t->branch, (size_t)t->n_branch, sizeof *t->branch, heaviest_first);
}

static void count_rows(sn_tree_cut *t, const cholmod_factor *f)
{
    const SuiteSparse_long *super = sn_supers(f);
    for (int32_t i = 0; i < t->n_trunk; i++) {
        int32_t k = t->trunk[i];
        for (SuiteSparse_long r = super[k]; r < super[k + 1]; r++) t->trunk_row[r] = t->n_trunk_row++;
    }
    for (int32_t i = 0; i < t->n_branch; i++) {
        int32_t n = (int32_t)(super[t->branch[i].to] - super[t->branch[i].from]);
        if (n > t->n_branch_row) t->n_branch_row = n;
    }
}

sn_status sn_tree_cut_find(sn_tree_cut *t, const cholmod_factor *f, const int32_t *super_of, sn_error *err)
{
    size_t n = f->nsuper;
    sn_branch *whole = SN_NEW(sn_branch, n);
    bool *is_trunk = SN_NEW(bool, n);
    *t = (sn_tree_cut){.parent = SN_NEW(int32_t, n),
                       .branch = SN_NEW(sn_branch, n),
                       .trunk = SN_NEW(int32_t, n),
                       .trunk_row = SN_NEW(int32_t, f->n)};
    bool ok = whole && is_trunk && t->parent && t->branch && t->trunk && t->trunk_row;
    if (ok) {
        find_whole(t, f, super_of, whole);
        cut(t, (int32_t)n, whole, is_trunk);
        count_rows(t, f);
    }
    sn_release(whole);
    sn_release(is_trunk);
    if (ok) return SN_OK;
    sn_tree_cut_free(t);
    return sn_fail(err, SN_ENOMEM, "cholesky: no memory for %zu supernodes", n);
}
