/* tissue_system.h - one matrix L + alpha B'B that follows the curves.
 *
 * It is factorized for the rows that B has at some time. When B changes, what it gained and lost is a change
 * of low rank (see low_rank.h): a moved control point changes the rows of one muscle. Only when that grows
 * too large is the matrix factorized anew. A system that is too large for a factor has a preconditioner in
 * its place, which serves other rows as well. */
#ifndef SN_FIELD_TISSUE_SYSTEM_H
#define SN_FIELD_TISSUE_SYSTEM_H

#include "field/iterative.h"
#include "field/half_cache.h"
#include "field/low_rank.h"
#include "field/tissue_rows.h"

typedef struct sn_tissue_state { /* rows of a time */
    uint64_t revision;
    sn_row_set set;
} sn_tissue_state;

typedef struct sn_tissue_system { /* zero-initialised but for the factor; owned                 */
    sn_cholesky *cholesky;        /* not factorized before the first follow; NULL: iterative    */
    sn_iterative *iterative;      /* NULL before the first follow                               */
    sn_row_set base;              /* the rows in the factor                                     */
    double alpha;                 /* that it was made with; 0: no change goes on it             */
    sn_low_rank *change;          /* from them to those that are followed                       */
    sn_half_cache half;           /* right-hand sides by the factor                             */
    uint64_t followed;            /* rows->revision of these; 0: none                           */
    sn_tissue_state *state;       /* n_state: the matrices that fields are of                   */
    int32_t n_state;
    bool can_see; /* change has columns for the unknowns of their rows that went */
} sn_tissue_system;

void sn_tissue_system_free(sn_tissue_system *s);
void sn_tissue_system_forget(sn_tissue_system *s); /* the factor: the next follow makes another */

/* Fills the whole matrix without the rows. */
typedef void (*sn_fill_fn)(const void *user, sn_csr *matrix);

/* Brings the system up to date; with_probes: so that it can be seen how far fields of before are off. matrix:
 * of the pattern that the system was analysed with; its values are overwritten when it is factorized.
 * *was_factorized: whether it was. Errors: SN_ESOLVE, SN_ENOMEM, SN_ECANCEL, SN_ELIMIT; the system is then as
 * it was, or needs to be factorized. */
SN_MUST_USE sn_status sn_tissue_system_follow(sn_tissue_system *s, const sn_tissue_rows *rows,
                                              bool with_probes, sn_csr *matrix, sn_fill_fn fill,
                                              const void *user, const sn_run *run, bool *was_factorized,
                                              sn_error *err);
/* After fields were solved: solved_at[0..n) says for which revision each field was; what no field is of is
 * forgotten. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_tissue_system_settle(sn_tissue_system *s, const sn_tissue_rows *rows,
                                              const uint64_t *solved_at, int32_t n, sn_error *err);

#endif
