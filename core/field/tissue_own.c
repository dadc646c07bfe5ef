/* Anisotropic muscles: each with a matrix and a factor of its own, many at a time. */
#include "base/alloc.h"
#include "field/tissue_private.h"

void sn_tissue_close_room(own_room *r)
{
    if (!r) return;
    sn_cholesky_destroy(r->cholesky);
    sn_release(r->val);
    sn_release(r->x);
    sn_release(r);
}

static sn_status open_room(const sn_tissue_solver *s, own_room **out, sn_error *err)
{
    own_room *r = SN_NEW_ZERO(own_room, 1);
    *out = NULL;
    if (!r) return sn_fail(err, SN_ENOMEM, "tissue: no memory");
    r->val = SN_NEW(double, s->laplacian.ptr[s->laplacian.n]);
    r->x = SN_NEW(double, s->n_free);
    sn_status st = r->val && r->x ? sn_cholesky_clone(&r->cholesky, s->cholesky, err)
                                  : sn_fail(err, SN_ENOMEM, "tissue: no memory");
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

/* One that nobody is in; a new one when there is none. */
static sn_status take_room(sn_tissue_solver *s, own_room **out, sn_error *err)
{
    sn_status st = SN_OK;
    *out = NULL;
#pragma omp critical(sn_tissue_room)
    {
        for (int32_t i = 0; i < s->n_room && !*out; i++)
            if (!s->room[i]->is_taken) *out = s->room[i];
        if (!*out) st = add_room(s, out, err);
        if (!st) (*out)->is_taken = true;
    }
    return st;
}

static void leave_room(own_room *r)
{
#pragma omp critical(sn_tissue_room)
    r->is_taken = false;
}

/* The right-hand side has entries at the corners of crossed tets only. */
static sn_status solve_for_rows(const sn_tissue_solver *s, int32_t i_muscle, own_room *r, const sn_run *run,
                                sn_error *err)
{
    const sn_collocation *c = s->muscle[i_muscle].row;
    int32_t n = 0, *index = SN_NEW(int32_t, 4 * (size_t)c->n_row);
    double *value = SN_NEW(double, 4 * (size_t)c->n_row);
    sn_status st =
        index && value ? SN_OK : sn_fail(err, SN_ENOMEM, "tissue: no memory for %d rows", c->n_row);
    for (size_t k = 0; !st && k < 4 * (size_t)c->n_row; k++) {
        index[n] = s->number[s->body->mesh.tet[4 * (size_t)c->tet[k / 4] + k % 4]];
        value[n] = s->alpha * c->bary[k] * c->value[k / 4];
        n += index[n] >= 0;
    }
    if (!st) st = sn_cholesky_solve_few(r->cholesky, index, value, n, run, r->x, err);
    sn_release(index);
    sn_release(value);
    return st;
}

static sn_status solve_in(const sn_tissue_solver *s, int32_t i_muscle, const double *tensor, own_room *r,
                          const sn_run *run, double *field, double *residual, sn_error *err)
{
    sn_csr matrix = s->laplacian; /* its pattern, with values of its own */
    matrix.val = r->val;
    sn_status st = sn_run_step(run, "assembling", -1.0, err);
    if (st) return st;
    sn_laplacian_set_anisotropic(&matrix, &s->assembly, &s->body->mesh, tensor);
    sn_tissue_add_rows(s, &matrix);
    st = sn_cholesky_factorize(r->cholesky, &matrix, run, err);
    if (st) return st;
    st = solve_for_rows(s, i_muscle, r, run, err);
    if (st) return st;
    sn_tissue_put_field(s, 1 + i_muscle, 0.0, r->x, field);
    const double *own = field + (1 + (size_t)i_muscle) * (size_t)s->body->mesh.n_vert;
    *residual = sn_tissue_residual(s, &matrix, 1 + i_muscle, 0.0, own, r->x);
    return SN_OK;
}

sn_status sn_tissue_solver_solve_own(sn_tissue_solver *s, int32_t i_muscle, const double *tensor,
                                     const sn_run *run, double *field, double *residual, sn_error *err)
{
    own_room *r;
    if (!s->has_curves) return sn_fail(err, SN_EINVAL, "tissue: no curves set");
    sn_status st = take_room(s, &r, err);
    if (st) return st;
    st = solve_in(s, i_muscle, tensor, r, run, field, residual, err);
    leave_room(r);
    if (!st || st == SN_ECANCEL || st == SN_ELIMIT) return st;
    return sn_fail_prefix(err, st, "muscle '%s': ", s->muscle[i_muscle].name);
}
