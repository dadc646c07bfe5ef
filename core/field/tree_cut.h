/* tree_cut.h - the elimination tree of supernodes, cut into a trunk and branches. Branches have nothing to do
 * with one another: when the trunk is done, they are solved for side by side. */
#ifndef SN_FIELD_TREE_CUT_H
#define SN_FIELD_TREE_CUT_H

#include "base/status.h"

#include <cholmod.h>
#include <stdint.h>

typedef struct sn_branch { /* a supernode and all below it: from .. to - 1 */
    int32_t from, to;
    int64_t n_entry; /* of the factor */
} sn_branch;

typedef struct sn_tree_cut { /* zero-initialised = empty         */
    int32_t *parent;         /* n_super: -1 at roots; owned      */
    sn_branch *branch;       /* n_branch, the heaviest first; owned */
    int32_t n_branch;
    int32_t *trunk; /* n_trunk: supernodes, ascending; owned */
    int32_t n_trunk;
    int32_t *trunk_row;   /* n: of rows of the trunk, their number among these; owned */
    int32_t n_trunk_row;  /* rows of the trunk                */
    int32_t n_branch_row; /* most rows of a branch            */
} sn_tree_cut;

/* f: supernodal, in postorder. Depends on nothing else. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_tree_cut_find(sn_tree_cut *t, const cholmod_factor *f, const int32_t *super_of,
                                       sn_error *err);
void sn_tree_cut_free(sn_tree_cut *t);

#endif
