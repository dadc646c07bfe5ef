/* lsn_scene.c - the scene: skin, body, solving, questions to the result. Bones, muscles, pictures and
 * extraction have files of their own. */
#include "lsn.h"

#include <string.h>

static const char scenes_key = 'a',
                  newest_key = 'n'; /* registry: all scenes by number, weakly; the newest one */

static sn_scene **check_box(lua_State *L, int arg)
{
    return luaL_checkudata(L, arg, LSN_SCENE);
}

sn_scene *lsn_check_scene(lua_State *L, int arg)
{
    sn_scene **s = check_box(L, arg);
    luaL_argcheck(L, *s != NULL, arg, "scene was closed");
    return *s;
}

static const sn_run *run_of(lua_State *L)
{
    return &lsn_get_state(L)->run;
}

void lsn_scene_must(lua_State *L, sn_scene *s, sn_status st, const sn_error *err)
{
    lsn_flush_notes(L, s);
    if (st) (void)lsn_raise(L, err);
}

static int scene_gc(lua_State *L)
{
    sn_scene **s = check_box(L, 1);
    sn_scene_destroy(*s);
    *s = NULL;
    return 0;
}

static int scene_tostring(lua_State *L)
{
    sn_scene **s = check_box(L, 1);
    if (*s)
        lua_pushfstring(L, "scene '%s': %s, %d bones, %d muscles", sn_scene_name(*s),
                        sn_scene_skin(*s) ? "skin" : "no skin", sn_scene_bone_count(*s),
                        sn_scene_muscle_count(*s));
    else
        lua_pushliteral(L, "scene (was closed)");
    return 1;
}

/* ---- the scenes made so far ---- */

static void push_scenes(lua_State *L)
{
    if (lua_rawgetp(L, LUA_REGISTRYINDEX, &scenes_key) == LUA_TTABLE) return;
    lua_pop(L, 1);
    lua_newtable(L);
    lua_createtable(L, 0, 1);
    lua_pushliteral(L, "v");
    lua_setfield(L, -2, "__mode");
    lua_setmetatable(L, -2);
    lua_pushvalue(L, -1);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &scenes_key);
}

/* Numbers count upwards in the order of making; entry 0 of the table holds the last one given. */
static void list_scene(lua_State *L) /* the scene on top of the stack */
{
    push_scenes(L);
    (void)lua_rawgeti(L, -1, 0);
    lua_Integer number = 1 + lua_tointeger(L, -1);
    lua_pop(L, 1);
    lua_pushinteger(L, number);
    lua_rawseti(L, -2, 0);
    lua_pushvalue(L, -2);
    lua_rawseti(L, -2, number);
    lua_pop(L, 1);
    lua_pushvalue(L, -1);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &newest_key);
}

void lsn_push_last_scene(lua_State *L)
{
    lua_Integer best = 0;
    push_scenes(L);
    for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1)) {
        sn_scene *const *s = luaL_testudata(L, -1, LSN_SCENE);
        if (s && *s && lua_tointeger(L, -2) > best) best = lua_tointeger(L, -2);
    }
    if (best > 0)
        (void)lua_rawgeti(L, -1, best);
    else
        lua_pushnil(L);
    lua_remove(L, -2);
}

static int scene_new(lua_State *L) /* sinew.scene{name=, unit="m", up="y"} */
{
    static const char *const keys[] = {"name", "unit", "up", NULL};
    lsn_check_keys(L, 1, keys);
    const char *name = lsn_opt_string(L, 1, "name", "scene"), *unit = lsn_opt_string(L, 1, "unit", "m");
    const char *up = lsn_opt_string(L, 1, "up", "y");
    if (strcmp(up, "y") != 0 && strcmp(up, "z") != 0)
        return lsn_option_error(L, 1, "up", "unknown axis '%s' (known: y, z)", up);
    sn_scene **s = lsn_new_object(L, LSN_SCENE, sizeof *s, 0);
    sn_error err;
    if (sn_scene_create(s, name, unit, *up == 'z' ? SN_UP_Z : SN_UP_Y, &err)) return lsn_raise(L, &err);
    list_scene(L);
    return 1;
}

/* ---- what it is ---- */

static int scene_name(lua_State *L)
{
    lua_pushstring(L, sn_scene_name(lsn_check_scene(L, 1)));
    return 1;
}

static int scene_unit(lua_State *L)
{
    lua_pushstring(L, sn_scene_unit(lsn_check_scene(L, 1)));
    return 1;
}

static int scene_up(lua_State *L)
{
    lua_pushstring(L, sn_scene_up(lsn_check_scene(L, 1)) == SN_UP_Z ? "z" : "y");
    return 1;
}

static int scene_bounds(lua_State *L) /* nil when the scene is empty */
{
    sn_box3 box = sn_scene_bounds(lsn_check_scene(L, 1));
    if (sn_box3_is_empty(box))
        lua_pushnil(L);
    else
        lsn_push_box(L, box);
    return 1;
}

static int scene_revision(lua_State *L)
{
    lua_pushinteger(L, (lua_Integer)sn_scene_revision(lsn_check_scene(L, 1)));
    return 1;
}

static int scene_set_skin(lua_State *L)
{
    sn_scene *s = lsn_check_scene(L, 1);
    const sn_tri_mesh *skin = lsn_check_surface(L, 2);
    sn_error err;
    lsn_scene_must(L, s, sn_scene_set_skin(s, skin, &err), &err);
    return 0;
}

static int scene_skin(lua_State *L) /* a copy, or nil */
{
    const sn_tri_mesh *skin = sn_scene_skin(lsn_check_scene(L, 1));
    sn_error err;
    if (!skin) return 0;
    if (sn_tri_mesh_copy(lsn_push_surface(L), skin, &err)) return lsn_raise(L, &err);
    return 1;
}

static int scene_set_fat(lua_State *L)
{
    sn_scene *s = lsn_check_scene(L, 1);
    sn_error err;
    lsn_scene_must(L, s, sn_scene_set_fat(s, lsn_check_finite(L, 2), &err), &err);
    return 0;
}

static int scene_set_alpha(lua_State *L)
{
    sn_scene *s = lsn_check_scene(L, 1);
    sn_error err;
    lsn_scene_must(L, s, sn_scene_set_alpha(s, lsn_check_finite(L, 2), &err), &err);
    return 0;
}

static int scene_fat(lua_State *L)
{
    lua_pushnumber(L, sn_scene_fat(lsn_check_scene(L, 1)));
    return 1;
}

static int scene_alpha(lua_State *L)
{
    lua_pushnumber(L, sn_scene_alpha(lsn_check_scene(L, 1)));
    return 1;
}

/* ---- steps ---- */

static void push_body_report(lua_State *L, const sn_body_report *r)
{
    lua_createtable(L, 0, 16);
    lsn_set_integer(L, "vertices", r->n_vert);
    lsn_set_integer(L, "tets", r->n_tet);
    lsn_set_integer(L, "surface_faces", r->n_surface_face);
    lsn_set_integer(L, "crossings_cured", r->crossings_cured);
    lsn_set_bool(L, "resampled", r->was_resampled);
    lsn_set_number(L, "bone_volume_exact", r->bone_volume_exact);
    lsn_set_number(L, "bone_volume", r->bone_volume);
    lsn_set_integer(L, "dropped_tets", r->n_dropped);
    lsn_set_number(L, "dropped_volume", r->dropped_volume);
    lsn_set_number(L, "min_dihedral", r->min_dihedral_deg);
    lsn_set_number(L, "max_dihedral", r->max_dihedral_deg);
    lsn_set_number(L, "share_below_10_degrees", r->share_below_10_deg);
    lsn_set_number(L, "seconds_surface", r->seconds_surface);
    lsn_set_number(L, "seconds_tets", r->seconds_tets);
    if (r->n_coarse_tet > 0) {
        lsn_set_integer(L, "coarse_tets", r->n_coarse_tet);
        lsn_set_number(L, "seconds_coarse", r->seconds_coarse);
    }
    lsn_set_number(L, "seconds", r->seconds);
}

static int scene_tetrahedralize(lua_State *L)
{
    static const char *const keys[] = {"edge_length", "bone_edge_length", "adaptive", "max_volume",
                                       "radius_edge", "time_limit",       NULL};
    sn_scene *s = lsn_check_scene(L, 1);
    sn_body_report report = {0};
    sn_error err;
    lsn_check_keys(L, 2, keys);
    sn_body_options opt = {.edge_length = lsn_opt_positive(L, 2, "edge_length", 0.0),
                           .bone_edge_length = lsn_opt_positive(L, 2, "bone_edge_length", 0.0),
                           .is_adaptive = lsn_opt_bool(L, 2, "adaptive", false),
                           .max_volume = lsn_opt_positive(L, 2, "max_volume", 0.0),
                           .radius_edge = lsn_opt_positive(L, 2, "radius_edge", 0.0),
                           .time_limit = lsn_opt_positive(L, 2, "time_limit", 0.0)};
    lsn_scene_must(L, s, sn_scene_tetrahedralize(s, &opt, run_of(L), &report, &err), &err);
    push_body_report(L, &report);
    return 1;
}

/* A list of the names of those for which is_in holds. */
static void set_tissues(lua_State *L, const sn_scene *s, const char *key,
                        bool (*is_in)(const sn_scene *, int32_t))
{
    lua_Integer n = 0;
    lua_newtable(L);
    for (int32_t i = 0; i < sn_scene_tissue_count(s); i++) {
        if (!is_in(s, i)) continue;
        lua_pushstring(L, sn_scene_tissue_name(s, i));
        lua_rawseti(L, -2, ++n);
    }
    lua_setfield(L, -2, key);
}

static void set_solve_report(lua_State *L, const sn_solve_report *s)
{
    const sn_tissue_report *r = &s->tissue;
    lsn_set_integer(L, "unknowns", r->unknowns);
    lsn_set_integer(L, "collocation_points", r->collocation_points);
    lsn_set_integer(L, "factor_entries", r->factor_entries);
    lua_pushstring(L, r->is_iterative ? "iterative" : "direct");
    lua_setfield(L, -2, "solver");
    lsn_set_integer(L, "iterations", r->iterations);
    lsn_set_integer(L, "changed_rows", r->n_changed_rows);
    lsn_set_integer(L, "solved", r->n_solved);
    lsn_set_integer(L, "kept", r->n_kept);
    lsn_set_number(L, "residual", r->residual);
    lsn_set_number(L, "seconds_assembly", r->seconds_assembly);
    lsn_set_number(L, "seconds_analysis", r->seconds_analysis);
    lsn_set_number(L, "seconds_factor", r->seconds_factor);
    lsn_set_number(L, "seconds_solve", r->seconds_solve);
    lsn_set_integer(L, "anisotropic", s->n_anisotropic);
    lsn_set_number(L, "seconds_frames", s->seconds_frames);
    lsn_set_number(L, "seconds_anisotropic", s->seconds_anisotropic);
    lsn_set_number(L, "seconds", s->seconds);
    lsn_set_bool(L, "meshed", s->was_meshed);
    lsn_set_bool(L, "factorized", s->was_factorized);
    lsn_set_bool(L, "quick", s->was_quick);
}

static void read_solver(lua_State *L, sn_scene *s)
{
    static const char *const kind[] = {"auto", "direct", "iterative"}; /* as in sn_solver_kind */
    const char *wanted = lsn_opt_string(L, 2, "solver", NULL);
    for (int i = 0; wanted && i < 3; i++)
        if (strcmp(wanted, kind[i]) == 0) {
            sn_scene_set_solver(s, (sn_solver_kind)i);
            wanted = NULL;
        }
    if (wanted)
        (void)lsn_option_error(L, 2, "solver", "unknown '%s' (known: auto, direct, iterative)", wanted);
}

static int scene_solve(lua_State *L)
{
    static const char *const keys[] = {"quick", "solver", NULL};
    sn_scene *s = lsn_check_scene(L, 1);
    sn_solve_report r = {0};
    sn_error err;
    bool is_quick = false;
    if (!lua_isnoneornil(L, 2)) {
        lsn_check_keys(L, 2, keys);
        is_quick = lsn_opt_bool(L, 2, "quick", false);
        read_solver(L, s);
    }
    sn_status st =
        is_quick ? sn_scene_solve_quick(s, run_of(L), &r, &err) : sn_scene_solve(s, run_of(L), &r, &err);
    lsn_scene_must(L, s, st, &err);
    lua_createtable(L, 0, 20);
    set_solve_report(L, &r);
    set_tissues(L, s, "tissues", sn_scene_was_solved);
    set_tissues(L, s, "factorized_muscles", sn_scene_was_factorized);
    return 1;
}

/* ---- questions ---- */

static int scene_values_at(lua_State *L) /* scene:values_at(p) -> {fat=, NAME=, ...} or nil */
{
    sn_scene *s = lsn_check_scene(L, 1);
    sn_vec3 p = lsn_check_point(L, 2, "point");
    int32_t n = sn_scene_tissue_count(s);
    double *value = lsn_push_numbers(L, (size_t)n);
    bool inside = false;
    sn_error err;
    lsn_scene_must(L, s, sn_scene_values_at(s, p, run_of(L), value, &inside, &err), &err);
    if (!inside) return 0;
    lua_createtable(L, 0, n);
    for (int32_t i = 0; i < n; i++) lsn_set_number(L, sn_scene_tissue_name(s, i), value[i]);
    return 1;
}

static int scene_tissue_at(lua_State *L) /* scene:tissue_at(p) -> name | "fat" | "bone:NAME" | nil */
{
    sn_scene *s = lsn_check_scene(L, 1);
    sn_vec3 p = lsn_check_point(L, 2, "point");
    sn_place place = SN_PLACE_OUTSIDE;
    int32_t index = 0;
    sn_error err;
    lsn_scene_must(L, s, sn_scene_tissue_at(s, p, run_of(L), &place, &index, &err), &err);
    if (place == SN_PLACE_OUTSIDE) return 0;
    if (place == SN_PLACE_BONE)
        lua_pushfstring(L, "bone:%s", sn_scene_bone_name(s, index));
    else
        lua_pushstring(L, sn_scene_tissue_name(s, index));
    return 1;
}

/* ---- report ---- */

typedef struct report_box {
    sn_scene_report report;
} report_box;
static const char report_type[] = "sinew.report box";

static int report_gc(lua_State *L)
{
    report_box *box = luaL_checkudata(L, 1, report_type);
    sn_scene_report_free(&box->report);
    return 0;
}

/* {bone=, area=, centroid=, distance=} of one end. */
static void push_attachment(lua_State *L, const sn_scene *s, const sn_attachment *a)
{
    lua_createtable(L, 0, 4);
    if (a->i_bone >= 0) {
        lua_pushstring(L, sn_scene_bone_name(s, a->i_bone));
        lua_setfield(L, -2, "bone");
    }
    lsn_set_number(L, "area", a->area);
    lsn_set_point(L, "centroid", a->centroid);
    lsn_set_number(L, "distance", a->distance);
}

/* origin and insertion: of the only head, or of the first; those of all heads in `heads`. */
static void set_ends(lua_State *L, const sn_scene *s, const sn_muscle_report *m)
{
    static const char *const end[] = {"origin", "insertion"};
    for (int k = 0; k < 2; k++) {
        push_attachment(L, s, &m->end[k]);
        lua_setfield(L, -2, end[k]);
    }
    if (m->n_head < 2) return;
    lua_createtable(L, m->n_head, 0);
    for (int32_t h = 0; h < m->n_head; h++) {
        lua_createtable(L, 0, 2);
        for (int k = 0; k < 2; k++) {
            push_attachment(L, s, &m->end[2 * h + k]);
            lua_setfield(L, -2, end[k]);
        }
        lua_rawseti(L, -2, h + 1);
    }
    lua_setfield(L, -2, "heads");
}

static void push_muscle_reports(lua_State *L, const sn_scene *s, const sn_scene_report *r)
{
    lua_createtable(L, 0, r->n_muscle);
    for (int32_t i = 0; i < r->n_muscle; i++) {
        const sn_muscle_report *m = &r->muscle[i];
        lua_createtable(L, 0, 14);
        lsn_set_number(L, "volume", m->volume);
        lsn_set_integer(L, "tets", m->tets);
        lsn_set_integer(L, "components", m->components);
        lsn_set_number(L, "length", m->length);
        lsn_set_number(L, "length_outside", m->length_outside);
        set_ends(L, s, m);
        if (m->has_fibers) lsn_set_architecture(L, &m->architecture);
        lua_setfield(L, -2, sn_scene_muscle(s, i)->name);
    }
}

static void push_timings(lua_State *L, const sn_scene_report *r)
{
    lua_createtable(L, 0, 6);
    lsn_set_number(L, "tetrahedralize", r->body.seconds);
    lsn_set_number(L, "assembly", r->solve.tissue.seconds_assembly);
    lsn_set_number(L, "analysis", r->solve.tissue.seconds_analysis);
    lsn_set_number(L, "factor", r->solve.tissue.seconds_factor);
    lsn_set_number(L, "solve", r->solve.tissue.seconds_solve);
    lsn_set_number(L, "extract", r->seconds_extract);
}

static void push_report(lua_State *L, const sn_scene *s, const sn_scene_report *r)
{
    lua_createtable(L, 0, 8);
    lua_pushstring(L, sn_scene_name(s));
    lua_setfield(L, -2, "name");
    lua_pushstring(L, sn_scene_unit(s));
    lua_setfield(L, -2, "unit");
    lsn_set_number(L, "fat_volume", r->fat_volume);
    push_muscle_reports(L, s, r);
    lua_setfield(L, -2, "muscles");
    lua_createtable(L, SN_TISSUE_HISTOGRAM - 1, 0);
    for (int k = 1; k < SN_TISSUE_HISTOGRAM; k++) {
        lua_pushinteger(L, r->tissues_per_tet[k]);
        lua_rawseti(L, -2, k);
    }
    lua_setfield(L, -2, "tissues_per_tet");
    push_body_report(L, &r->body);
    lua_setfield(L, -2, "body");
    lua_newtable(L);
    set_solve_report(L, &r->solve);
    lua_setfield(L, -2, "solve");
    push_timings(L, r);
    lua_setfield(L, -2, "timings");
}

static int scene_report(lua_State *L)
{
    sn_scene *s = lsn_check_scene(L, 1);
    report_box *box = lsn_new_object(L, report_type, sizeof *box, 0);
    sn_error err;
    lsn_scene_must(L, s, sn_scene_report_make(s, run_of(L), &box->report, &err), &err);
    push_report(L, s, &box->report);
    sn_scene_report_free(&box->report);
    return 1;
}

void lsn_open_scene(lua_State *L)
{
    static const luaL_Reg meta[] = {
        {"__gc", scene_gc}, {"__close", scene_gc}, {"__tostring", scene_tostring}, {NULL, NULL}};
    static const luaL_Reg methods[] = {{"name", scene_name},
                                       {"unit", scene_unit},
                                       {"up", scene_up},
                                       {"bounds", scene_bounds},
                                       {"revision", scene_revision},
                                       {"close", scene_gc},
                                       {"set_skin", scene_set_skin},
                                       {"skin", scene_skin},
                                       {"add_bone", lsn_scene_add_bone},
                                       {"bone", lsn_scene_bone},
                                       {"bones", lsn_scene_bones},
                                       {"remove_bone", lsn_scene_remove_bone},
                                       {"place_bone", lsn_scene_place_bone},
                                       {"mirror_bones", lsn_scene_mirror_bones},
                                       {"cut", lsn_scene_cut},
                                       {"add_joint", lsn_scene_add_joint},
                                       {"remove_joint", lsn_scene_remove_joint},
                                       {"joints", lsn_scene_joints},
                                       {"tetrahedralize", scene_tetrahedralize},
                                       {"set_fat", scene_set_fat},
                                       {"set_alpha", scene_set_alpha},
                                       {"fat", scene_fat},
                                       {"alpha", scene_alpha},
                                       {"add_muscle", lsn_scene_add_muscle},
                                       {"draw_muscle", lsn_scene_draw_muscle},
                                       {"muscle", lsn_scene_muscle},
                                       {"muscles", lsn_scene_muscles},
                                       {"remove_muscle", lsn_scene_remove_muscle},
                                       {"solve", scene_solve},
                                       {"values_at", scene_values_at},
                                       {"tissue_at", scene_tissue_at},
                                       {"report", scene_report},
                                       {"render", lsn_scene_render},
                                       {"extract", lsn_scene_extract},
                                       {NULL, NULL}};
    static const luaL_Reg report_meta[] = {{"__gc", report_gc}, {NULL, NULL}}, none[] = {{NULL, NULL}};
    lsn_new_type(L, LSN_SCENE, meta, methods);
    lsn_new_type(L, report_type, report_meta, none);
    lua_pushcfunction(L, scene_new);
    lua_setfield(L, -2, "scene");
}
