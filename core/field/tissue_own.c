/* Anisotropic muscles: each with a matrix and a factor of its own, many at a time. */
#include "base/alloc.h"
#include "field/tissue_private.h"

/* Factors that are kept when as many are not needed at once. */
#define MOST_ROOMS 8

void sn_tissue_close_room(own_room *r)
{
    if (!r) return;
    sn_tissue_system_free(&r->system);
    sn_release(r->val);
    sn_release(r);
}

static sn_status open_room(const sn_tissue_solver *s, own_room **out, sn_error *err)
{
    own_room *r = SN_NEW_ZERO(own_room, 1);
    *out = NULL;
    if (!r) return sn_fail(err, SN_ENOMEM, "tissue: no memory");
    r->val = SN_NEW(double, s->laplacian.ptr[s->laplacian.n]);
    sn_status st = r->val ? SN_OK : sn_fail(err, SN_ENOMEM, "tissue: no memory");
    if (!st && s->system.cholesky) st = sn_cholesky_clone(&r->system.cholesky, s->system.cholesky, err);
    if (st)
        sn_tissue_close_room(r);
    else
        *out = r;
    return st;
}

static sn_status add_room(sn_tissue_solver *s, own_room **out, sn_error *err)
{
    own_room **room = sn_realloc(s->room, (size_t)s->n_room + 1, sizeof(own_room *));
    if (!room) return sn_fail(err, SN_ENOMEM, "tissue: no memory");
    s->room = room;
    sn_status st = open_room(s, out, err);
    if (!st) s->room[s->n_room++] = *out;
    return st;
}

/* The muscle's own, else a new one while there are few, else the one that was left longest ago. */
static own_room *find_room(const sn_tissue_solver *s, uint64_t id)
{
    own_room *oldest = NULL;
    for (int32_t i = 0; i < s->n_room; i++) {
        own_room *r = s->room[i];
        if (r->is_taken) continue;
        if (r->id == id) return r;
        if (!oldest || r->last_use < oldest->last_use) oldest = r;
    }
    return s->n_room < MOST_ROOMS ? NULL : oldest;
}

static sn_status take_room(sn_tissue_solver *s, uint64_t id, own_room **out, sn_error *err)
{
    sn_status st = SN_OK;
#pragma omp critical(sn_tissue_room)
    {
        *out = find_room(s, id);
        if (!*out) st = add_room(s, out, err);
        if (!st) {
            (*out)->is_taken = true;
            (*out)->last_use = ++s->n_use;
        }
    }
    return st;
}

static void leave_room(own_room *r)
{
#pragma omp critical(sn_tissue_room)
    r->is_taken = false;
}

typedef struct own_fill {
    const sn_tissue_solver *s;
    const double *tensor;
} own_fill;

static void fill_anisotropic(const void *user, sn_csr *matrix)
{
    const own_fill *f = user;
    sn_laplacian_set_anisotropic(matrix, &f->s->assembly, &f->s->body->mesh, f->tensor);
}

static sn_status solve_in(const sn_tissue_solver *s, const sn_tissue_own *own, own_room *r,
                          const sn_tissue_quick *quick, sn_tissue_stamp *stamp, const sn_run *run,
                          double *field, double *residual, bool *was_factorized, sn_error *err)
{
    const own_fill fill = {s, own->tensor};
    const int32_t tissue = 1 + own->i_muscle;
    const tissue_block block = {&tissue, 1, 0.0, quick, stamp, field};
    sn_tissue_rows rows = sn_tissue_rows_of(s);
    sn_csr matrix = s->laplacian; /* its pattern, with values of its own */
    int32_t n_solved, iterations;
    matrix.val = r->val;
    if (r->id != s->muscle[own->i_muscle].id || r->tensor_id != own->tensor_id)
        sn_tissue_system_forget(&r->system);
    r->id = s->muscle[own->i_muscle].id;
    r->tensor_id = own->tensor_id;
    sn_status st = sn_tissue_system_follow(&r->system, &rows, quick != NULL, &matrix, fill_anisotropic, &fill,
                                           run, was_factorized, err);
    if (!st && !r->system.cholesky)
        return sn_tissue_iterate_block(s, &r->system, &block, NULL, run, residual, &iterations, &n_solved,
                                       err);
    if (!st) st = sn_tissue_solve_block(s, &r->system, &block, NULL, run, residual, &n_solved, err);
    if (!st && stamp) st = sn_tissue_system_settle(&r->system, &rows, stamp + tissue, 1, err);
    return st;
}

sn_status sn_tissue_solver_solve_own(sn_tissue_solver *s, const sn_tissue_own *own,
                                     const sn_tissue_quick *quick, sn_tissue_stamp *stamp, const sn_run *run,
                                     double *field, double *residual, bool *was_factorized, sn_error *err)
{
    own_room *r;
    if (s->revision == 0) return sn_fail(err, SN_EINVAL, "tissue: no curves set");
    const sn_tissue_muscle *m = &s->muscle[own->i_muscle];
    sn_status st = take_room(s, m->id, &r, err);
    if (st) return st;
    *residual = 0.0;
    st = solve_in(s, own, r, quick, stamp, run, field, residual, was_factorized, err);
    bool is_lost = !st && *residual > SN_RESIDUAL_TOO_LARGE && sn_low_rank_count(r->system.change) > 0;
    if (is_lost) {
        sn_tissue_system_forget(&r->system);
        if (quick) quick->was_kept[1 + own->i_muscle] = false;
        st = solve_in(s, own, r, NULL, stamp, run, field, residual, was_factorized, err);
    }
    leave_room(r);
    if (!st || st == SN_ECANCEL || st == SN_ELIMIT) return st;
    return sn_fail_prefix(err, st, "muscle '%s': ", m->name);
}
