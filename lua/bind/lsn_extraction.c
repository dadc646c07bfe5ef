/* lsn_extraction.c - muscles as tets that fit each other, of a scene or of anybody's functions on a tet mesh.
 */
#include "lsn.h"

#include "base/alloc.h"
#include "extract/extraction_mirror.h"

#include <string.h>

enum { max_name = 64 }; /* bytes, as in a scene */

/* ---- extraction: its user value is the tet mesh that was cut ---- */

sn_extraction *lsn_push_extraction(lua_State *L, int tets)
{
    tets = lua_absindex(L, tets);
    sn_extraction *x = lsn_new_object(L, LSN_EXTRACTION, sizeof *x, 1);
    lua_pushvalue(L, tets);
    (void)lua_setiuservalue(L, -2, 1);
    return x;
}

static sn_extraction *check_extraction(lua_State *L, int arg)
{
    sn_extraction *x = luaL_checkudata(L, arg, LSN_EXTRACTION);
    luaL_argcheck(L, x->name != NULL, arg, "extraction was closed");
    return x;
}

const sn_extraction *lsn_check_extraction(lua_State *L, const sn_tet_mesh **input)
{
    const sn_extraction *x = check_extraction(L, 1);
    (void)lua_getiuservalue(L, 1, 1);
    *input = lua_touserdata(L, -1);
    if (*input && !(*input)->tet) *input = NULL; /* closed */
    lua_pop(L, 1);
    return x;
}

static int extraction_gc(lua_State *L)
{
    sn_extraction_free(luaL_checkudata(L, 1, LSN_EXTRACTION));
    return 0;
}

static int extraction_tostring(lua_State *L)
{
    const sn_extraction *x = luaL_checkudata(L, 1, LSN_EXTRACTION);
    if (x->name)
        lua_pushfstring(L, "extraction: %d vertices, %d tets, %d tissues", x->mesh.n_vert, x->mesh.n_tet,
                        x->n_tissue);
    else
        lua_pushliteral(L, "extraction (was closed)");
    return 1;
}

/* Warns of tissues from `first` on that won nowhere. */
static void warn_of_empty(lua_State *L, const sn_extraction *x, int32_t first, const char *kind)
{
    bool *has_tets = lua_newuserdatauv(L, (size_t)x->n_tissue * sizeof *has_tets, 0);
    memset(has_tets, 0, (size_t)x->n_tissue * sizeof *has_tets);
    for (int32_t t = 0; t < x->mesh.n_tet; t++) has_tets[x->mesh.part[t]] = true;
    for (int32_t i = first; i < x->n_tissue; i++)
        if (!has_tets[i]) lsn_warn(L, "%s '%s' is empty: no tets", kind, x->name[i]);
    lua_pop(L, 1);
}

static void account(lua_State *L, const sn_extraction *x)
{
    lsn_account(L, 24 * (size_t)x->mesh.n_vert + 24 * (size_t)x->mesh.n_tet);
}

int lsn_scene_extract(lua_State *L) /* scene:extract{margin=} -> extraction */
{
    static const char *const keys[] = {"margin", NULL};
    sn_scene *s = lsn_check_scene(L, 1);
    lsn_check_keys(L, 2, keys);
    sn_extract_options opt = {.margin = lsn_opt_positive(L, 2, "margin", 0.0)};
    sn_tet_mesh *input = lsn_push_tets(L);
    sn_extraction *x = lsn_push_extraction(L, -1);
    sn_error err;
    lsn_scene_must(L, s, sn_scene_extract(s, &opt, &lsn_get_state(L)->run, x, &err), &err);
    if (sn_tet_mesh_copy(input, &sn_scene_body(s)->mesh, &err)) return lsn_raise(L, &err);
    warn_of_empty(L, x, 1, "muscle");
    account(L, x);
    return 1;
}

/* ---- sinew.extract(tets, {{name=, values=}, ...} [, {margin=}]) ---- */

static int function_error(lua_State *L, int32_t i, const char *what)
{
    return luaL_argerror(L, 2, lua_pushfstring(L, "functions[%d]: %s", i + 1, what));
}

static bool is_good_name(const char *name, size_t size)
{
    if (size < 1 || size > max_name) return false;
    for (size_t i = 0; i < size; i++)
        if ((unsigned char)name[i] < 32 || name[i] == 127 || name[i] == '/') return false;
    return true;
}

/* The name of the function on top of the stack; `names` (stack index) maps the names so far to true and holds
 * them. */
static const char *read_name(lua_State *L, int32_t i, int names)
{
    size_t size;
    lua_pushliteral(L, "name");
    if (lua_rawget(L, -2) != LUA_TSTRING) (void)function_error(L, i, "option 'name': string expected");
    const char *name = lua_tolstring(L, -1, &size);
    if (!is_good_name(name, size))
        (void)function_error(L, i, "option 'name': 1..64 bytes without '/' or control characters expected");
    lua_pushvalue(L, -1);
    if (lua_rawget(L, names) != LUA_TNIL)
        (void)function_error(L, i, lua_pushfstring(L, "name '%s' is taken by an earlier one", name));
    lua_pop(L, 1);
    lua_pushboolean(L, 1);
    lua_rawset(L, names);
    return name;
}

static void read_values(lua_State *L, int32_t i, int32_t n_vert,
                        double *out) /* of the function on top of the stack */
{
    lua_pushliteral(L, "values");
    if (lua_rawget(L, -2) != LUA_TTABLE)
        (void)function_error(L, i, "option 'values': list of numbers expected");
    if (lua_rawlen(L, -1) != (lua_Unsigned)n_vert)
        (void)function_error(L, i,
                             lua_pushfstring(L, "%I values, need one for each of the %d vertices",
                                             (LUAI_UACINT)lua_rawlen(L, -1), n_vert));
    for (int32_t v = 0; v < n_vert; v++) {
        bool is_number = lua_rawgeti(L, -1, v + 1) == LUA_TNUMBER;
        out[v] = lua_tonumber(L, -1);
        if (!is_number || !isfinite(out[v])) {
            lua_pushfstring(L, "functions[%d].values[%d]", i + 1, v + 1);
            (void)lsn_to_number(L, -2, lua_tostring(L, -1), &out[v]);
            (void)luaL_argerror(L, 2, lua_tostring(L, -1));
        }
        lua_pop(L, 1);
    }
    lua_pop(L, 1);
}

static int sinew_extract(lua_State *L)
{
    static const char *const keys[] = {"margin", NULL}, *const parts[] = {"name", "values", NULL};
    const sn_tet_mesh *m = lsn_check_tets(L, 1);
    int32_t n = lsn_check_list(L, 2, 2, "functions");
    luaL_argcheck(L, n >= 1 && n <= SN_MAX_TISSUES, 2, "functions: 1 to 4096 expected");
    lsn_check_keys(L, 3, keys);
    sn_extract_options opt = {.margin = lsn_opt_positive(L, 3, "margin", 0.0)};
    lua_settop(L, 3);
    lua_createtable(L, 0, n);
    const char **name = lua_newuserdatauv(L, (size_t)n * sizeof *name, 0);
    double *value = lsn_push_numbers(L, (size_t)n * (size_t)m->n_vert);
    for (int32_t i = 0; i < n; i++) {
        if (lua_rawgeti(L, 2, i + 1) != LUA_TTABLE) return function_error(L, i, "{name=, values=} expected");
        lsn_enter_top(L, 2);
        lsn_check_keys(L, 2, parts);
        lsn_leave(L, 2);
        (void)lua_rawgeti(L, 2, i + 1);
        name[i] = read_name(L, i, 4);
        read_values(L, i, m->n_vert, value + (size_t)i * (size_t)m->n_vert);
        lua_pop(L, 1);
    }
    sn_extraction *x = lsn_push_extraction(L, 1);
    sn_error err;
    if (sn_extract(m, value, name, n, &opt, &lsn_get_state(L)->run, x, &err)) return lsn_raise(L, &err);
    warn_of_empty(L, x, 0, "tissue");
    account(L, x);
    return 1;
}

/* ---- methods ---- */

static int extraction_names(lua_State *L) /* in the order of the ids */
{
    const sn_extraction *x = check_extraction(L, 1);
    lua_createtable(L, x->n_tissue, 0);
    for (int32_t i = 0; i < x->n_tissue; i++) {
        lua_pushstring(L, x->name[i]);
        lua_rawseti(L, -2, i + 1);
    }
    return 1;
}

static int extraction_tet_count(lua_State *L)
{
    lua_pushinteger(L, check_extraction(L, 1)->mesh.n_tet);
    return 1;
}

static int extraction_vertex_count(lua_State *L)
{
    lua_pushinteger(L, check_extraction(L, 1)->mesh.n_vert);
    return 1;
}

static int extraction_check(lua_State *L)
{
    const sn_tet_mesh *input;
    const sn_extraction *x = lsn_check_extraction(L, &input);
    sn_extraction_check c;
    sn_error err;
    if (sn_extraction_check_run(&c, x, input, &lsn_get_state(L)->run, &err)) return lsn_raise(L, &err);
    lua_createtable(L, 0, 12);
    lsn_set_bool(L, "conforming", c.conforming);
    lsn_set_bool(L, "manifold", c.manifold);
    lsn_set_bool(L, "positive", c.positive);
    lsn_set_number(L, "volume_error", c.volume_error);
    lsn_set_integer(L, "nonmanifold_edges", c.nonmanifold_edges);
    lsn_set_integer(L, "nonmanifold_vertices", c.nonmanifold_vertices);
    lsn_set_integer(L, "bad_faces", c.bad_faces);
    lsn_set_integer(L, "inverted", c.inverted);
    lsn_set_number(L, "min_volume", c.min_volume);
    lsn_set_number(L, "max_volume", c.max_volume);
    lsn_set_integer(L, "moved", x->n_moved);
    lsn_set_number(L, "largest_move", x->largest_move);
    return 1;
}

static int extraction_save(lua_State *L) /* x:save(path) -> true | nil, message */
{
    const sn_tet_mesh *input;
    const sn_extraction *x = lsn_check_extraction(L, &input);
    const char *path = lsn_check_text(L, 2);
    sn_error err;
    return lsn_saved(L, sn_extraction_save(x, input, path, &lsn_get_state(L)->run, &err), &err);
}

static int extraction_mirror(lua_State *L) /* x:mirror{point=, normal=} -> extraction */
{
    static const char *const keys[] = {"point", "normal", NULL};
    const sn_extraction *x = check_extraction(L, 1);
    sn_error err;
    lsn_check_keys(L, 2, keys);
    if (!x->is_cut && lua_isnoneornil(L, 2))
        return lsn_fail(L, SN_EINVAL, "mirror: the scene was not cut (scene:cut{}): give {point=, normal=}");
    sn_vec3 point = lsn_opt_point(L, 2, "point", x->cut_point, !x->is_cut);
    sn_vec3 normal = lsn_opt_point(L, 2, "normal", x->cut_normal, !x->is_cut);
    (void)lua_getiuservalue(L, 1, 1);
    sn_extraction *out = lsn_push_extraction(L, -1);
    if (sn_extraction_mirror(x, point, normal, &lsn_get_state(L)->run, out, &err)) return lsn_raise(L, &err);
    account(L, out);
    return 1;
}

/* ---- part: a tissue id, with the extraction as user value ---- */

typedef struct part {
    int32_t tissue;
} part;

static int extraction_part(lua_State *L) /* x:part(name) -> part */
{
    const sn_extraction *x = check_extraction(L, 1);
    const char *name = lsn_check_text(L, 2);
    int32_t tissue = sn_extraction_find(x, name);
    if (tissue < 0) {
        const char *near = sn_nearest_name(name, (const char *const *)x->name, (size_t)x->n_tissue);
        if (near) return lsn_fail(L, SN_EINVAL, "no part '%s' (did you mean '%s'?)", name, near);
        return lsn_fail(L, SN_EINVAL, "no part '%s'", name);
    }
    part *p = lsn_new_object(L, LSN_PART, sizeof *p, 1);
    p->tissue = tissue;
    lua_pushvalue(L, 1);
    (void)lua_setiuservalue(L, -2, 1);
    return 1;
}

static const sn_extraction *check_part(lua_State *L, int32_t *tissue)
{
    const part *p = luaL_checkudata(L, 1, LSN_PART);
    (void)lua_getiuservalue(L, 1, 1);
    const sn_extraction *x = luaL_testudata(L, -1, LSN_EXTRACTION);
    lua_pop(L, 1);
    luaL_argcheck(L, x && x->name, 1, "the part's extraction was closed");
    *tissue = p->tissue;
    return x;
}

const sn_extraction *lsn_check_part(lua_State *L, int32_t *tissue, const sn_tet_mesh **input)
{
    const sn_extraction *x = check_part(L, tissue);
    (void)lua_getiuservalue(L, 1, 1);
    (void)lua_getiuservalue(L, -1, 1);
    *input = lua_touserdata(L, -1);
    if (*input && !(*input)->tet) *input = NULL; /* closed */
    lua_pop(L, 2);
    return x;
}

static int part_tostring(lua_State *L)
{
    int32_t i;
    const sn_extraction *x = check_part(L, &i);
    lua_pushfstring(L, "part '%s': %d tets", x->name[i], sn_extraction_part_tets(x, i));
    return 1;
}

static int part_name(lua_State *L)
{
    int32_t i;
    const sn_extraction *x = check_part(L, &i);
    lua_pushstring(L, x->name[i]);
    return 1;
}

static int part_volume(lua_State *L)
{
    int32_t i;
    const sn_extraction *x = check_part(L, &i);
    lua_pushnumber(L, sn_extraction_part_volume(x, i));
    return 1;
}

static int part_tet_count(lua_State *L)
{
    int32_t i;
    const sn_extraction *x = check_part(L, &i);
    lua_pushinteger(L, sn_extraction_part_tets(x, i));
    return 1;
}

/* The boundary of a tissue as a surface in *out. */
static sn_status surface_of(const sn_extraction *x, int32_t tissue, sn_tri_mesh *out, sn_error *err)
{
    sn_status st = sn_tet_mesh_surface(&x->mesh, tissue, out, NULL, err);
    if (!st && out->n_face == 0)
        return sn_fail(err, SN_EINVAL, "part '%s' is empty: no tets", x->name[tissue]);
    return st;
}

static int part_surface(lua_State *L)
{
    int32_t i;
    const sn_extraction *x = check_part(L, &i);
    sn_error err;
    if (surface_of(x, i, lsn_push_surface(L), &err)) return lsn_raise(L, &err);
    return 1;
}

static int part_save(lua_State *L) /* part:save(path) -> true | nil, message */
{
    int32_t tissue;
    const sn_tet_mesh *input;
    const sn_extraction *x = lsn_check_part(L, &tissue, &input);
    const char *path = lsn_check_text(L, 2);
    sn_error err;
    return lsn_saved(L, sn_extraction_save_part(x, input, tissue, path, &lsn_get_state(L)->run, &err), &err);
}

void lsn_open_extraction(lua_State *L)
{
    static const luaL_Reg meta[] = {{"__gc", extraction_gc},
                                    {"__close", extraction_gc},
                                    {"__tostring", extraction_tostring},
                                    {NULL, NULL}};
    static const luaL_Reg methods[] = {{"names", extraction_names},
                                       {"part", extraction_part},
                                       {"tet_count", extraction_tet_count},
                                       {"vertex_count", extraction_vertex_count},
                                       {"check", extraction_check},
                                       {"save", extraction_save},
                                       {"mirror", extraction_mirror},
                                       {"fiber_lines", lsn_extraction_fiber_lines},
                                       {"close", extraction_gc},
                                       {NULL, NULL}};
    static const luaL_Reg part_meta[] = {{"__tostring", part_tostring}, {NULL, NULL}};
    static const luaL_Reg part_methods[] = {{"name", part_name},
                                            {"volume", part_volume},
                                            {"tet_count", part_tet_count},
                                            {"surface", part_surface},
                                            {"save", part_save},
                                            {"fibers", lsn_part_fibers},
                                            {"fiber_lines", lsn_part_fiber_lines},
                                            {"architecture", lsn_part_architecture},
                                            {NULL, NULL}};
    lsn_new_type(L, LSN_EXTRACTION, meta, methods);
    lsn_new_type(L, LSN_PART, part_meta, part_methods);
    lua_pushcfunction(L, sinew_extract);
    lua_setfield(L, -2, "extract");
}
