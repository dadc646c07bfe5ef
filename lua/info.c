/* info.c - `sinew info`: what is right and wrong with the meshes in files. */
#include "commands.h"

#include "base/array.h"
#include "base/file.h"
#include "exit_code.h"
#include "interrupt.h"
#include "mesh/mesh_check.h"
#include "mesh/surface_io.h"
#include "mesh/tet_io.h"
#include "progress.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static void print_number(const char *name, double v)
{
    char text[32];
    (void)sn_format_double(text, v);
    (void)printf("  %s: %s\n", name, text);
}

static void print_count(const char *name, int64_t n)
{
    (void)printf("  %s: %" PRId64 "\n", name, n);
}

static void print_claim(const char *name, bool is_true)
{
    (void)printf("  %s: %s\n", name, is_true ? "true" : "false");
}

static void print_bounds(sn_box3 b)
{
    (void)printf("  bounds: %.9g %.9g %.9g .. %.9g %.9g %.9g\n", b.min.x, b.min.y, b.min.z, b.max.x, b.max.y,
                 b.max.z);
}

static void print_check(const sn_mesh_check *c)
{
    print_claim("closed", c->closed);
    print_claim("manifold", c->manifold);
    print_claim("oriented", c->oriented);
    print_count("components", c->components);
    print_count("boundary_edges", c->boundary_edges);
    print_count("nonmanifold_edges", c->nonmanifold_edges);
    print_count("nonmanifold_vertices", c->nonmanifold_vertices);
    print_count("degenerate_faces", c->degenerate_faces);
    print_count("duplicate_vertices", c->duplicate_vertices);
    print_count("duplicate_faces", c->duplicate_faces);
    print_count("unused_vertices", c->unused_vertices);
    print_count("self_intersections", c->self_intersections);
    if (c->first_pair[0] >= 0)
        (void)printf("  first_pair: %" PRId32 " %" PRId32 "\n", c->first_pair[0] + 1, c->first_pair[1] + 1);
    else
        (void)printf("  first_pair: none\n");
    bool is_usable = c->closed && c->manifold && c->oriented && c->degenerate_faces == 0 &&
                     c->duplicate_faces == 0 && c->self_intersections == 0;
    if (!is_usable) (void)printf("  hint: surface:repair{} may mend it\n");
}

static sn_status surface_info(const char *path, const sn_run *run, sn_error *err)
{
    sn_tri_mesh m;
    sn_mesh_check check;
    sn_tri_mesh_init(&m);
    sn_status st = sn_surface_load(&m, path, err);
    if (!st) st = sn_mesh_check_run(&check, &m, run, err);
    if (!st) {
        cli_progress_erase();
        (void)printf("%s\n", path);
        print_count("vertices", m.n_vert);
        print_count("faces", m.n_face);
        print_bounds(sn_tri_mesh_bounds(&m));
        print_number("area", sn_tri_mesh_area(&m));
        print_number("volume", sn_tri_mesh_volume(&m));
        print_check(&check);
    }
    sn_tri_mesh_free(&m);
    return st;
}

static int less_i32(const void *a, const void *b)
{
    return *(const int32_t *)a < *(const int32_t *)b;
}

/* How many different parts there are; sorts the parts of m. */
static int32_t count_parts(sn_tet_mesh *m)
{
    int32_t n = 0;
    if (!m->part) return 0;
    sn_sort(m->part, (size_t)m->n_tet, sizeof *m->part, less_i32);
    for (int32_t i = 0; i < m->n_tet; i++) n += i == 0 || m->part[i] != m->part[i - 1];
    return n;
}

static sn_status tet_info(const char *path, sn_error *err)
{
    sn_tet_mesh m;
    sn_tet_mesh_init(&m);
    sn_status st = sn_tet_mesh_load(&m, path, err);
    if (!st) {
        double least = sn_tet_mesh_tet_volume(&m, 0);
        for (int32_t i = 1; i < m.n_tet; i++) {
            double v = sn_tet_mesh_tet_volume(&m, i);
            if (v < least) least = v;
        }
        (void)printf("%s\n", path);
        print_count("vertices", m.n_vert);
        print_count("tets", m.n_tet);
        print_count("parts", count_parts(&m));
        print_bounds(sn_tet_mesh_bounds(&m));
        print_number("volume", sn_tet_mesh_volume(&m));
        print_number("min_volume", least);
    }
    sn_tet_mesh_free(&m);
    return st;
}

static bool is_one_of(const char *ext, const char *const list[])
{
    for (; *list; list++)
        if (strcmp(*list, ext) == 0) return true;
    return false;
}

static sn_status file_info(const char *path, const sn_run *run, sn_error *err)
{
    static const char *const surface[] = {"obj", "ply", "stl", "off", "vtp", NULL};
    static const char *const tets[] = {"mesh", "vtu", "node", "ele", NULL};
    char ext[16];
    sn_file_extension(path, ext);
    if (is_one_of(ext, surface)) return surface_info(path, run, err);
    if (is_one_of(ext, tets)) return tet_info(path, err);
    return sn_fail(err, SN_EFORMAT,
                   "%s: unknown extension (known: .obj, .ply, .stl, .off, .vtp, .mesh, .vtu, .node, .ele)",
                   path);
}

int cli_info(const cli_options *o)
{
    int code = CLI_EXIT_OK;
    cli_interrupt_install(NULL);
    cli_progress_enable(!o->is_quiet);
    sn_run run = {.n_threads = o->threads,
                  .cancel = cli_interrupt_flag(),
                  .deadline = o->time_limit > 0.0 ? sn_clock() + o->time_limit : 0.0,
                  .progress = cli_progress_report};
    for (int i = 0; i < o->operand.n && !ferror(stdout); i++) {
        sn_error err = {SN_OK, ""};
        sn_status st = sn_run_step(&run, "reading", -1.0, &err);
        if (!st) st = file_info(o->operand.item[i], &run, &err);
        if (!st) continue;
        cli_progress_erase();
        (void)fflush(stdout);
        (void)fprintf(stderr, "sinew: error: %s\n", err.msg);
        if (st == SN_ECANCEL || st == SN_ELIMIT) return cli_exit_code(st);
        code = CLI_EXIT_INPUT;
    }
    cli_progress_erase();
    return code;
}
