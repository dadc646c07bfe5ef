#include "extract/extraction.h"

#include "base/alloc.h"
#include "base/file.h"
#include "extract/part_fibers.h"
#include "mesh/surface_io.h"

#include <stdio.h>
#include <string.h>

/* ---- a folder of surfaces ---- */

static sn_status save_part_surface(const sn_extraction *x, const int32_t *adj, int32_t tissue,
                                   const char *folder, sn_error *err)
{
    sn_tri_mesh surface;
    sn_tri_mesh_init(&surface);
    sn_status st = sn_tet_mesh_surface_adj(&x->mesh, adj, tissue, &surface, NULL, err);
    if (!st && surface.n_face > 0) {
        size_t n = strlen(folder) + strlen(x->name[tissue]) + 8;
        char *path = sn_alloc(n, 1);
        if (path) {
            (void)snprintf(path, n, "%s/%s.obj", folder, x->name[tissue]);
            st = sn_surface_save(&surface, path, err);
        } else {
            st = sn_fail(err, SN_ENOMEM, "%s: no memory", folder);
        }
        sn_release(path);
    }
    sn_tri_mesh_free(&surface);
    return st;
}

static sn_status save_folder(const sn_extraction *x, const char *path, const sn_run *run, sn_error *err)
{
    int32_t *adj = NULL;
    sn_status st = sn_dir_create(path, err);
    if (!st) st = sn_tet_mesh_adjacency(&x->mesh, &adj, err);
    for (int32_t i = 1; i < x->n_tissue && !st; i++) {
        st = sn_run_step(run, "saving surfaces", (double)(i - 1) / (x->n_tissue - 1), err);
        if (!st) st = save_part_surface(x, adj, i, path, err);
    }
    sn_release(adj);
    return st;
}

/* ---- tets with what is known of them ---- */

typedef struct sheet {      /* what goes into a file of tets; all in the order of the extraction's tets */
    double *fiber, *tendon; /* NULL: not known */
    char **name;            /* n_name: the tissues, then "NAME:tendon" where there is some; owned */
    int32_t n_name;
    sn_tet_field field[3];
    int32_t n_field;
} sheet;

static void sheet_free(sheet *s)
{
    sn_release(s->fiber);
    sn_release(s->tendon);
    for (int32_t i = 0; s->name && i < s->n_name; i++) sn_release(s->name[i]);
    sn_release(s->name);
}

static bool any_tendon(const sn_extraction *x)
{
    bool any = false;
    for (int32_t i = 0; i < x->n_muscle; i++) any = any || sn_muscle_has_tendon(&x->muscle[i]);
    return any;
}

static sn_status find_fibers(sheet *s, const sn_extraction *x, const sn_tet_mesh *input, int32_t tissue,
                             const sn_run *run, sn_error *err)
{
    s->fiber = SN_NEW(double, 3 * (size_t)x->mesh.n_tet);
    s->tendon = SN_NEW(double, x->mesh.n_tet);
    if (!s->fiber || !s->tendon)
        return sn_fail(err, SN_ENOMEM, "fibers: no memory for %d tets", x->mesh.n_tet);
    return sn_extraction_fibers(x, input, tissue, run, s->fiber, s->tendon, err);
}

/* The tissues' names, and those of their tendons when the format tells tets apart by one number only. */
static sn_status make_names(sheet *s, const sn_extraction *x, bool with_tendon, sn_error *err)
{
    int32_t n = with_tendon ? x->n_tissue + x->n_muscle : x->n_tissue;
    s->name = SN_NEW_ZERO(char *, n);
    bool ok = s->name != NULL;
    s->n_name = ok ? n : 0;
    for (int32_t i = 0; ok && i < n; i++) {
        const char *of = i < x->n_tissue ? x->name[i] : x->name[1 + i - x->n_tissue];
        size_t room = strlen(of) + 16;
        ok = (s->name[i] = sn_alloc(room, 1)) != NULL;
        if (ok) (void)snprintf(s->name[i], room, i < x->n_tissue ? "%s" : "%s:tendon", of);
    }
    return ok ? SN_OK : sn_fail(err, SN_ENOMEM, "extract: no memory for %d names", n);
}

/* Tets of tendon get the ids after the tissues: 0-based n_tissue + muscle. */
static void relabel_tendon(sn_tet_mesh *m, const sheet *s, int32_t n_tissue)
{
    for (int32_t t = 0; t < m->n_tet; t++)
        if (s->tendon[t] > 0.0) m->part[t] += n_tissue - 1;
}

static void list_fields(sheet *s, const double *envelope)
{
    s->field[s->n_field++] = (sn_tet_field){.name = "envelope", .values = envelope, .n_comp = 1};
    if (!s->fiber) return;
    s->field[s->n_field++] =
        (sn_tet_field){.name = "fiber", .values = s->fiber, .n_comp = 3, .per_tet = true};
    s->field[s->n_field++] =
        (sn_tet_field){.name = "tendon", .values = s->tendon, .n_comp = 1, .per_tet = true, .is_int = true};
}

/* m: tets with parts, to be written and relabelled; the sheet is in their order. */
static sn_status save_sheet(sheet *s, sn_tet_mesh *m, int32_t n_tissue, const double *envelope,
                            const char *path, const sn_run *run, sn_error *err)
{
    if (s->n_name > n_tissue) relabel_tendon(m, s, n_tissue);
    list_fields(s, envelope);
    sn_tet_extras extras = {.part_name = (const char *const *)s->name,
                            .n_part = s->n_name,
                            .field = s->field,
                            .n_field = s->n_field,
                            .run = run};
    return sn_tet_mesh_save(m, &extras, path, err);
}

static bool is_medit(const char *path)
{
    char extension[16];
    sn_file_extension(path, extension);
    return strcmp(extension, "mesh") == 0;
}

/* tissue < 0: all. */
static sn_status fill_sheet(sheet *s, const sn_extraction *x, const sn_tet_mesh *input, int32_t tissue,
                            const char *path, const sn_run *run, sn_error *err)
{
    bool tendon_ids = is_medit(path) && input && any_tendon(x);
    sn_status st = make_names(s, x, tendon_ids, err);
    bool wants_fibers = input && x->n_muscle > 0 && (!is_medit(path) || tendon_ids);
    if (!st && wants_fibers) st = find_fibers(s, x, input, tissue, run, err);
    return st;
}

static sn_status save_tets(const sn_extraction *x, const sn_tet_mesh *input, const char *path,
                           const sn_run *run, sn_error *err)
{
    sheet s = {0};
    sn_tet_mesh m = x->mesh; /* borrowed, but for parts that change */
    int32_t *part = NULL;
    sn_status st = fill_sheet(&s, x, input, -1, path, run, err);
    if (!st && s.n_name > x->n_tissue) {
        part = SN_NEW(int32_t, m.n_tet);
        if (part) {
            memcpy(part, m.part, (size_t)m.n_tet * sizeof *part);
            m.part = part;
        } else {
            st = sn_fail(err, SN_ENOMEM, "%s: no memory", path);
        }
    }
    if (!st) st = save_sheet(&s, &m, x->n_tissue, x->envelope, path, run, err);
    sn_release(part);
    sheet_free(&s);
    return st;
}

sn_status sn_extraction_save(const sn_extraction *x, const sn_tet_mesh *input, const char *path,
                             const sn_run *run, sn_error *err)
{
    char extension[16];
    sn_file_extension(path, extension);
    return extension[0] == '\0' ? save_folder(x, path, run, err) : save_tets(x, input, path, run, err);
}

/* ---- one tissue ---- */

/* Keeps the values of the tissue's tets, in order. */
static void keep_part(double *value, int n_comp, const sn_extraction *x, int32_t tissue)
{
    size_t n = 0;
    for (int32_t t = 0; value && t < x->mesh.n_tet; t++)
        for (int c = 0; c < n_comp && x->mesh.part[t] == tissue; c++)
            value[n++] = value[(size_t)n_comp * (size_t)t + (size_t)c];
}

/* The envelope at the part's vertices, in order. By sn_alloc. */
static double *part_envelope(const sn_extraction *x, int32_t tissue, int32_t n_part_vert)
{
    bool *used = SN_NEW_ZERO(bool, x->mesh.n_vert);
    double *out = SN_NEW(double, n_part_vert);
    size_t n = 0;
    for (size_t k = 0; used && k < 4 * (size_t)x->mesh.n_tet; k++)
        if (x->mesh.part[k >> 2] == tissue) used[x->mesh.tet[k]] = true;
    for (int32_t v = 0; used && out && v < x->mesh.n_vert; v++)
        if (used[v]) out[n++] = x->envelope[v];
    if (!used) {
        sn_release(out);
        out = NULL;
    }
    sn_release(used);
    return out;
}

static sn_status save_part_tets(const sn_extraction *x, const sn_tet_mesh *input, int32_t tissue,
                                const char *path, const sn_run *run, sn_error *err)
{
    sheet s = {0};
    sn_tet_mesh m;
    double *envelope = NULL;
    sn_tet_mesh_init(&m);
    sn_status st = sn_extraction_part(x, tissue, &m, err);
    if (!st) st = fill_sheet(&s, x, input, tissue, path, run, err);
    if (!st && !(envelope = part_envelope(x, tissue, m.n_vert)))
        st = sn_fail(err, SN_ENOMEM, "%s: no memory", path);
    if (!st) {
        keep_part(s.fiber, 3, x, tissue);
        keep_part(s.tendon, 1, x, tissue);
        st = save_sheet(&s, &m, x->n_tissue, envelope, path, run, err);
    }
    sn_release(envelope);
    sn_tet_mesh_free(&m);
    sheet_free(&s);
    return st;
}

static sn_status save_surface(const sn_extraction *x, int32_t tissue, const char *path, sn_error *err)
{
    sn_tri_mesh surface;
    sn_tri_mesh_init(&surface);
    sn_status st = sn_tet_mesh_surface(&x->mesh, tissue, &surface, NULL, err);
    if (!st) st = sn_surface_save(&surface, path, err);
    sn_tri_mesh_free(&surface);
    return st;
}

static bool is_one_of(const char *word, const char *const *list)
{
    while (*list && strcmp(word, *list) != 0) list++;
    return *list != NULL;
}

sn_status sn_extraction_save_part(const sn_extraction *x, const sn_tet_mesh *input, int32_t tissue,
                                  const char *path, const sn_run *run, sn_error *err)
{
    static const char *const surfaces[] = {"obj", "ply", "stl", "off", NULL};
    static const char *const tets[] = {"vtu", "mesh", "msh", NULL};
    char extension[16];
    sn_file_extension(path, extension);
    bool as_surface = is_one_of(extension, surfaces);
    if (!as_surface && !is_one_of(extension, tets))
        return sn_fail(
            err, SN_EINVAL,
            "%s: unknown format '%s' (known: .obj .ply .stl .off for the surface, .vtu .mesh .msh for "
            "the tets)",
            path, extension);
    if (sn_extraction_part_tets(x, tissue) == 0)
        return sn_fail(err, SN_EINVAL, "part '%s' is empty: no tets", x->name[tissue]);
    return as_surface ? save_surface(x, tissue, path, err) : save_part_tets(x, input, tissue, path, run, err);
}
