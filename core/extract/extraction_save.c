#include "extract/extraction.h"

#include "base/alloc.h"
#include "base/file.h"
#include "mesh/surface_io.h"

#include <stdio.h>
#include <string.h>

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

static sn_status save_folder(const sn_extraction *x, const char *path, sn_error *err)
{
    int32_t *adj = NULL;
    sn_status st = sn_dir_create(path, err);
    if (!st) st = sn_tet_mesh_adjacency(&x->mesh, &adj, err);
    for (int32_t i = 1; i < x->n_tissue && !st; i++) st = save_part_surface(x, adj, i, path, err);
    sn_release(adj);
    return st;
}

sn_status sn_extraction_save(const sn_extraction *x, const char *path, sn_error *err)
{
    char extension[16];
    sn_file_extension(path, extension);
    if (extension[0] == '\0') return save_folder(x, path, err);
    sn_tet_field envelope = {.name = "envelope", .values = x->envelope, .n_comp = 1};
    sn_tet_extras extras = {
        .part_name = (const char *const *)x->name, .n_part = x->n_tissue, .field = &envelope, .n_field = 1};
    return sn_tet_mesh_save(&x->mesh, &extras, path, err);
}
