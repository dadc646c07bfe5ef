#include "extract/extraction.h"

#include "base/alloc.h"
#include "extract/extract_private.h"

#include <math.h>
#include <string.h>

#define DEFAULT_MARGIN 1e-3

void sn_extraction_init(sn_extraction *x)
{
    memset(x, 0, sizeof *x);
}

static void free_muscles(sn_extraction *x)
{
    for (int32_t i = 0; i < x->n_muscle; i++) sn_muscle_free(&x->muscle[i]);
    sn_release(x->muscle);
    x->muscle = NULL;
    x->n_muscle = 0;
}

void sn_extraction_free(sn_extraction *x)
{
    free_muscles(x);
    sn_tet_mesh_free(&x->mesh);
    sn_release(x->source);
    sn_release(x->envelope);
    for (int32_t i = 0; x->name && i < x->n_tissue; i++) sn_release(x->name[i]);
    sn_release(x->name);
    sn_extraction_init(x);
}

static sn_status check_input(const sn_tet_mesh *m, int32_t n_tissue, const sn_extract_options *opt,
                             sn_error *err)
{
    if (n_tissue < 1 || n_tissue > SN_MAX_TISSUES)
        return sn_fail(err, SN_EINVAL, "extract: %d tissues, need 1 to %d", n_tissue, SN_MAX_TISSUES);
    double margin = opt ? opt->margin : 0.0;
    if (margin != 0.0 && !(margin > 0.0 && margin <= 0.2))
        return sn_fail(err, SN_EINVAL, "extract: margin is %g, need > 0 and <= 0.2", margin);
    sn_status st = sn_tet_mesh_validate(m, err);
    return st ? sn_fail_prefix(err, st, "extract: ") : SN_OK;
}

static sn_status copy_names(sn_extraction *x, const char *const *name, int32_t n_tissue, sn_error *err)
{
    x->name = SN_NEW_ZERO(char *, n_tissue);
    bool ok = x->name != NULL;
    x->n_tissue = ok ? n_tissue : 0;
    for (int32_t i = 0; ok && i < n_tissue; i++) ok = (x->name[i] = sn_strdup(name[i])) != NULL;
    return ok ? SN_OK : sn_fail(err, SN_ENOMEM, "extract: no memory");
}

/* Takes over the arrays of the cells, all but the ties. */
static sn_status adopt_cells(sn_extraction *x, xt_cells *c, const sn_tet_mesh *m, const xt_cuts *cuts,
                             sn_error *err)
{
    size_t n_vert = (size_t)m->n_vert + (size_t)cuts->n_edge_point + (size_t)cuts->n_face_point + c->n_inner;
    if (n_vert > INT32_MAX)
        return sn_fail(err, SN_ELIMIT, "extract: %zu vertices are more than 2^31", n_vert);
    x->mesh.pos = SN_NEW(double, 3 * n_vert);
    x->envelope = SN_NEW(double, n_vert);
    if (!x->mesh.pos || !x->envelope)
        return sn_fail(err, SN_ENOMEM, "extract: no memory for %zu vertices", n_vert);
    x->mesh.n_vert = (int32_t)n_vert;
    x->mesh.n_tet = (int32_t)c->n_tet;
    x->mesh.tet = c->tet;
    x->mesh.part = c->part;
    x->source = c->source;
    return SN_OK;
}

sn_status sn_extract(const sn_tet_mesh *m, const double *value, const char *const *name, int32_t n_tissue,
                     const sn_extract_options *opt, const sn_run *run, sn_extraction *out, sn_error *err)
{
    xt_grid grid = {0};
    xt_cuts cuts = {0};
    xt_cells cells = {0};
    double start = sn_clock();
    sn_extraction_free(out);
    sn_status st = check_input(m, n_tissue, opt, err);
    if (!st) st = copy_names(out, name, n_tissue, err);
    if (!st) st = sn_run_step(run, "extracting", 0.0, err);
    if (!st) st = xt_grid_build(&grid, value, name, n_tissue, m->n_vert, run, err);
    if (!st) st = xt_cuts_build(&cuts, m, &grid, run, err);
    if (!st) st = xt_cells_build(&cells, m, &grid, &cuts, run, err);
    if (!st) st = adopt_cells(out, &cells, m, &cuts, err);
    double margin = opt && opt->margin > 0.0 ? opt->margin : DEFAULT_MARGIN;
    if (!st) st = xt_place(out, m, &grid, &cuts, &cells, value, margin, run, err);
    out->input_volume = st ? 0.0 : sn_tet_mesh_volume(m);
    out->seconds = sn_clock() - start;
    if (out->mesh.tet) cells.tet = cells.part = cells.source = NULL; /* adopted */
    xt_cells_free(&cells);
    xt_cuts_free(&cuts);
    xt_grid_free(&grid);
    if (st) sn_extraction_free(out);
    return st;
}

sn_status sn_extraction_set_muscles(sn_extraction *x, const sn_muscle *const *muscle, int32_t n_muscle,
                                    sn_error *err)
{
    sn_extraction copy = {.muscle = SN_NEW_ZERO(sn_muscle, n_muscle), .n_muscle = n_muscle};
    if (!copy.muscle) return sn_fail(err, SN_ENOMEM, "extract: no memory for %d muscles", n_muscle);
    for (int32_t i = 0; i < n_muscle; i++) {
        sn_status st = sn_muscle_copy(&copy.muscle[i], muscle[i], err);
        if (!st) continue;
        free_muscles(&copy);
        return st;
    }
    free_muscles(x);
    x->muscle = copy.muscle;
    x->n_muscle = copy.n_muscle;
    return SN_OK;
}

int32_t sn_extraction_find(const sn_extraction *x, const char *name)
{
    for (int32_t i = 0; i < x->n_tissue; i++)
        if (strcmp(x->name[i], name) == 0) return i;
    return -1;
}

int32_t sn_extraction_part_tets(const sn_extraction *x, int32_t tissue)
{
    int32_t n = 0;
    for (int32_t t = 0; t < x->mesh.n_tet; t++) n += x->mesh.part[t] == tissue;
    return n;
}

double sn_extraction_part_volume(const sn_extraction *x, int32_t tissue)
{
    double sum = 0.0;
    for (int32_t t = 0; t < x->mesh.n_tet; t++)
        if (x->mesh.part[t] == tissue) sum += sn_tet_mesh_tet_volume(&x->mesh, t);
    return sum;
}

sn_status sn_extraction_part(const sn_extraction *x, int32_t tissue, sn_tet_mesh *out, sn_error *err)
{
    const sn_tet_mesh *m = &x->mesh;
    int32_t n_tet = sn_extraction_part_tets(x, tissue), n_vert = 0, *number = SN_NEW_ZERO(int32_t, m->n_vert);
    if (!number) return sn_fail(err, SN_ENOMEM, "part: no memory");
    for (int32_t t = 0; t < m->n_tet; t++)
        for (int k = 0; k < 4 && m->part[t] == tissue; k++) number[m->tet[4 * (size_t)t + (size_t)k]] = 1;
    for (int32_t v = 0; v < m->n_vert; v++) number[v] = number[v] ? n_vert++ : -1;
    sn_status st = sn_tet_mesh_reserve(out, n_vert, n_tet, true, err);
    if (!st) {
        int32_t n = 0;
        for (int32_t v = 0; v < m->n_vert; v++)
            if (number[v] >= 0)
                memcpy(out->pos + 3 * (size_t)number[v], m->pos + 3 * (size_t)v, 3 * sizeof *m->pos);
        for (int32_t t = 0; t < m->n_tet; t++) {
            if (m->part[t] != tissue) continue;
            for (int k = 0; k < 4; k++)
                out->tet[4 * (size_t)n + (size_t)k] = number[m->tet[4 * (size_t)t + (size_t)k]];
            out->part[n++] = tissue;
        }
    }
    sn_release(number);
    return st;
}
