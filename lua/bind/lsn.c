/* lsn.c - the module table, the state around the bindings, errors, and what all types share. */
#include "lsn.h"

#include "base/file.h"

#include "base/alloc.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const char state_key = 's', owner_type[] = "sinew.owner";

/* ---- state ---- */

lsn_state *lsn_get_state(lua_State *L)
{
    if (lua_rawgetp(L, LUA_REGISTRYINDEX, &state_key) != LUA_TUSERDATA) {
        lsn_state *fresh = lua_newuserdatauv(L, sizeof *fresh, 0);
        memset(fresh, 0, sizeof *fresh);
        lua_rawsetp(L, LUA_REGISTRYINDEX, &state_key);
        lua_rawgetp(L, LUA_REGISTRYINDEX, &state_key);
        lua_remove(L, -2);
    }
    lsn_state *st = lua_touserdata(L, -1);
    lua_pop(L, 1);
    return st;
}

sn_status lsn_status_of(lua_State *L, const char *message)
{
    const lsn_state *st = lsn_get_state(L);
    return st->last_message[0] && message && strstr(message, st->last_message) ? st->last_status : SN_EINVAL;
}

static void remember(lua_State *L, const sn_error *err)
{
    lsn_state *st = lsn_get_state(L);
    st->last_status = err->code;
    (void)snprintf(st->last_message, sizeof st->last_message, "%s", err->msg);
}

/* ---- errors and warnings ---- */

int lsn_raise(lua_State *L, const sn_error *err)
{
    remember(L, err);
    return luaL_error(L, "%s", err->msg);
}

int lsn_nil_error(lua_State *L, const sn_error *err)
{
    remember(L, err);
    lua_pushnil(L);
    lua_pushstring(L, err->msg);
    return 2;
}

int lsn_saved(lua_State *L, sn_status st, const sn_error *err)
{
    if (st) return lsn_nil_error(L, err);
    lua_pushboolean(L, 1);
    return 1;
}

int lsn_fail(lua_State *L, sn_status code, const char *fmt, ...)
{
    sn_error err = {.code = code};
    va_list ap;
    va_start(ap, fmt);
    (void)vsnprintf(err.msg, sizeof err.msg, fmt, ap);
    va_end(ap);
    return lsn_raise(L, &err);
}

static void give_warning(lua_State *L, const char *line)
{
    lsn_state *st = lsn_get_state(L);
    st->n_warning++;
    if (st->warn) st->warn(st->warn_user, line);
}

void lsn_warn(lua_State *L, const char *fmt, ...)
{
    char line[512];
    va_list ap;
    va_start(ap, fmt);
    (void)vsnprintf(line, sizeof line, fmt, ap);
    va_end(ap);
    give_warning(L, line);
}

void lsn_flush_notes(lua_State *L, sn_scene *s)
{
    const sn_notes *notes = sn_scene_notes(s);
    for (size_t i = 0; i < notes->n_line; i++) give_warning(L, notes->line[i]);
    sn_scene_clear_notes(s);
}

/* ---- tables that go out ---- */

void lsn_set_number(lua_State *L, const char *key, double value)
{
    lua_pushnumber(L, value);
    lua_setfield(L, -2, key);
}

void lsn_set_integer(lua_State *L, const char *key, int64_t value)
{
    lua_pushinteger(L, value);
    lua_setfield(L, -2, key);
}

void lsn_set_bool(lua_State *L, const char *key, bool value)
{
    lua_pushboolean(L, value);
    lua_setfield(L, -2, key);
}

void lsn_set_point(lua_State *L, const char *key, sn_vec3 p)
{
    lsn_push_point(L, p);
    lua_setfield(L, -2, key);
}

void lsn_push_box(lua_State *L, sn_box3 b)
{
    lua_createtable(L, 0, 2);
    lsn_set_point(L, "min", b.min);
    lsn_set_point(L, "max", b.max);
}

/* ---- objects ---- */

int lsn_unknown_method(lua_State *L, const char *type, const luaL_Reg *method)
{
    size_t n = 0;
    if (lua_type(L, 2) != LUA_TSTRING) return 0;
    while (method[n].name) n++;
    const char **name = lua_newuserdatauv(L, (n + 1) * sizeof *name, 0);
    for (size_t i = 0; i < n; i++) name[i] = method[i].name;
    const char *word = lua_tostring(L, 2), *near = sn_nearest_name(word, name, n);
    if (near) return luaL_error(L, "%s has no '%s' (did you mean '%s'?)", type, word, near);
    return luaL_error(L, "%s has no '%s'", type, word);
}

/* __index of a method table, for names that it does not have. Upvalues: the type's name, its methods. */
static int no_method(lua_State *L)
{
    return lsn_unknown_method(L, lua_tostring(L, lua_upvalueindex(1)),
                              lua_touserdata(L, lua_upvalueindex(2)));
}

void lsn_new_type(lua_State *L, const char *type, const luaL_Reg *meta, const luaL_Reg *methods)
{
    (void)luaL_newmetatable(L, type);
    luaL_setfuncs(L, meta, 0);
    lua_newtable(L);
    luaL_setfuncs(L, methods, 0);
    lua_createtable(L, 0, 1);
    lua_pushstring(L, type + strlen("sinew."));
    lua_pushlightuserdata(L, (void *)(uintptr_t)methods); /* only read */
    lua_pushcclosure(L, no_method, 2);
    lua_setfield(L, -2, "__index");
    lua_setmetatable(L, -2);
    lua_setfield(L, -2, "__index");
    lua_pop(L, 1);
}

void *lsn_new_object(lua_State *L, const char *type, size_t size, int n_uv)
{
    void *p = lua_newuserdatauv(L, size, n_uv);
    memset(p, 0, size);
    luaL_setmetatable(L, type);
    return p;
}

void lsn_empty_owner(void **box)
{
    sn_release(*box);
    *box = NULL;
}

static int owner_gc(lua_State *L)
{
    lsn_empty_owner(luaL_checkudata(L, 1, owner_type));
    return 0;
}

void **lsn_push_owner(lua_State *L)
{
    return lsn_new_object(L, owner_type, sizeof(void *), 0);
}

/* A collector that sees 100 bytes in an object of 100 MB would let a loop of such objects fill the memory. */
void lsn_account(lua_State *L, size_t bytes)
{
    size_t kb = bytes / 1024;
    if (kb > 0 && lua_gc(L, LUA_GCISRUNNING)) (void)lua_gc(L, LUA_GCSTEP, (int)(kb < 1 << 20 ? kb : 1 << 20));
}

/* ---- the module ---- */

static int sinew_time(lua_State *L)
{
    lua_pushnumber(L, sn_clock());
    return 1;
}

static int sinew_folder(lua_State *L) /* sinew.folder(path) -> path | nil, message */
{
    sn_error err;
    const char *path = luaL_checkstring(L, 1);
    luaL_argcheck(L, *path, 1, "path is empty");
    if (sn_dir_create(path, &err)) return lsn_nil_error(L, &err);
    lua_settop(L, 1);
    return 1;
}

static int sinew_threads(lua_State *L) /* sinew.threads([n]) -> the number in use */
{
    sn_run *run = &lsn_get_state(L)->run;
    if (!lua_isnoneornil(L, 1)) {
        lua_Integer n = luaL_checkinteger(L, 1);
        luaL_argcheck(L, n >= 0 && n <= 1024, 1, "0 (one per core) to 1024 threads expected");
        run->n_threads = (int)n;
    }
    lua_pushinteger(L, sn_run_threads(run));
    return 1;
}

int luaopen_sinew(lua_State *L)
{
    static const luaL_Reg functions[] = {
        {"time", sinew_time}, {"threads", sinew_threads}, {"folder", sinew_folder}, {NULL, NULL}};
    static const luaL_Reg owner_meta[] = {{"__gc", owner_gc}, {NULL, NULL}}, none[] = {{NULL, NULL}};
    luaL_checkversion(L);
    (void)lsn_get_state(L);
    lsn_new_type(L, owner_type, owner_meta, none);
    luaL_newlib(L, functions);
    lua_pushstring(L, SN_VERSION);
    lua_setfield(L, -2, "version");
    lsn_open_vec3(L);
    lsn_open_surface(L);
    lsn_open_shape(L);
    lsn_open_scene(L);
    lsn_open_bone(L);
    lsn_open_bones(L);
    lsn_open_place(L);
    lsn_open_muscle(L);
    lsn_open_head(L);
    lsn_open_extraction(L);
    lsn_open_fibers(L);
    lsn_open_tets(L);
    lsn_open_image(L);
    lsn_open_help(L);
    return 1;
}
