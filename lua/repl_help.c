/* repl_help.c - help() and help(name or function): the texts come from sinew.help_text, name -> text. */
#include "repl.h"
#include "sorted_keys.h"

#include "bind/lsn.h"

#include <stdio.h>
#include <string.h>

static const char general[] = "Type an expression to see its value, or statements. Tab completes, also the "
                              "names of muscles and bones.\n"
                              "Ctrl-C stops what runs or clears the line, Ctrl-D leaves.\n"
                              "help(\"name\") or help(f) explains one thing; known names:\n";

/* Pushes sinew.help_text, or an empty table. */
static void push_texts(lua_State *L)
{
    lua_getfield(L, LUA_REGISTRYINDEX, LUA_LOADED_TABLE);
    if (lua_getfield(L, -1, "sinew") == LUA_TTABLE) {
        lua_pushliteral(L, "help_text");
        (void)lua_rawget(L, -2);
    } else {
        lua_pushnil(L);
    }
    if (!lua_istable(L, -1)) {
        lua_pop(L, 1);
        lua_newtable(L);
    }
    lua_replace(L, -3);
    lua_pop(L, 1);
}

static int print_general(lua_State *L)
{
    lua_Integer n;
    int width = 0;
    push_texts(L);
    n = cli_push_sorted_keys(L, -1);
    (void)fputs(general, stdout);
    for (lua_Integer i = 1; i <= n; i++) {
        lua_rawgeti(L, -1, i);
        const char *name = luaL_tolstring(L, -1, NULL);
        int len = (int)strlen(name) + 2;
        if (width > 0 && width + len > 98) {
            (void)printf("\n");
            width = 0;
        }
        (void)printf("  %s", name);
        width += len;
        lua_pop(L, 2);
    }
    (void)printf("\n");
    return 0;
}

/* ---- the name of a function ---- */

/* Pushes prefix .. name for the field of the table (an index) that holds the function at 1; false and nothing
 * when none does. */
static bool push_field_name(lua_State *L, int table, const char *prefix)
{
    lua_pushnil(L);
    while (lua_next(L, table)) {
        if (lua_rawequal(L, -1, 1) && lua_type(L, -2) == LUA_TSTRING) {
            lua_pushfstring(L, "%s%s", prefix, lua_tostring(L, -2));
            lua_replace(L, -3);
            lua_pop(L, 1);
            return true;
        }
        lua_pop(L, 1);
    }
    return false;
}

/* As push_field_name for `sinew` and the tables in it. */
static bool push_module_name(lua_State *L)
{
    int top = lua_gettop(L);
    lua_getfield(L, LUA_REGISTRYINDEX, LUA_LOADED_TABLE);
    if (lua_getfield(L, -1, "sinew") != LUA_TTABLE) return false;
    int module = lua_gettop(L);
    if (push_field_name(L, module, "sinew.")) return true;
    lua_pushnil(L);
    while (lua_next(L, module)) {
        if (lua_istable(L, -1) && lua_type(L, -2) == LUA_TSTRING) {
            lua_pushfstring(L, "sinew.%s.", lua_tostring(L, -2));
            lua_insert(L, -2);
            if (push_field_name(L, lua_gettop(L), lua_tostring(L, -2))) return true;
            lua_remove(L, -2);
        }
        lua_pop(L, 1);
    }
    lua_settop(L, top);
    return false;
}

static bool push_method_name(lua_State *L)
{
    static const char *const type[] = {LSN_SURFACE, LSN_SHAPE,      LSN_SCENE, LSN_BONE,  LSN_MUSCLE,
                                       LSN_PART,    LSN_EXTRACTION, LSN_TETS,  LSN_IMAGE, LSN_VEC3};
    for (size_t i = 0; i < sizeof type / sizeof type[0]; i++) {
        char prefix[64];
        (void)snprintf(prefix, sizeof prefix, "%s:", strchr(type[i], '.') + 1);
        if (luaL_getmetatable(L, type[i]) == LUA_TTABLE && lua_getfield(L, -1, "__index") == LUA_TTABLE &&
            push_field_name(L, lua_gettop(L), prefix))
            return true;
        lua_settop(L, 1);
    }
    return false;
}

/* ---- looking up ---- */

static const char *last_part(const char *name)
{
    const char *part = name;
    for (; *name; name++)
        if (*name == '.' || *name == ':') part = name + 1;
    return part;
}

static bool print_text(lua_State *L, int texts, const char *name)
{
    lua_pushstring(L, name);
    bool has = lua_rawget(L, texts) == LUA_TSTRING;
    if (has) (void)printf("%s\n", lua_tostring(L, -1));
    lua_pop(L, 1);
    return has;
}

/* The names of all that begins with name and ':' or '.': the methods of a type. */
static bool print_members(lua_State *L, int texts, const char *name)
{
    bool has = false;
    size_t n_name = strlen(name);
    lua_Integer n = cli_push_sorted_keys(L, texts);
    for (lua_Integer i = 1; i <= n; i++) {
        lua_rawgeti(L, -1, i);
        const char *key = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : "";
        if (strncmp(key, name, n_name) == 0 && (key[n_name] == ':' || key[n_name] == '.'))
            has = print_text(L, texts, key) || has;
        lua_pop(L, 1);
    }
    lua_pop(L, 1);
    return has;
}

/* The text of the name itself, or else those of all names with the same last part. */
static bool print_texts(lua_State *L, const char *name)
{
    bool has = false;
    push_texts(L);
    int texts = lua_gettop(L);
    if (print_text(L, texts, name)) return true;
    if (strncmp(name, "sinew.", 6) == 0 && print_text(L, texts, name + 6)) return true;
    lua_Integer n = cli_push_sorted_keys(L, texts);
    for (lua_Integer i = 1; i <= n; i++) {
        lua_rawgeti(L, texts + 1, i);
        const char *key = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : "";
        if (strcmp(last_part(key), last_part(name)) == 0) has = print_text(L, texts, key) || has;
        lua_pop(L, 1);
    }
    return print_members(L, texts, name) || has;
}

static int help(lua_State *L)
{
    if (lua_isnoneornil(L, 1)) return print_general(L);
    lua_settop(L, 1);
    const char *name = NULL;
    if (lua_type(L, 1) == LUA_TUSERDATA && luaL_getmetafield(L, 1, "__name") == LUA_TSTRING)
        name = last_part(lua_tostring(L, -1));
    else if (lua_type(L, 1) == LUA_TSTRING ||
             (lua_isfunction(L, 1) && (push_module_name(L) || push_method_name(L))))
        name = lua_tostring(L, -1);
    if (!name) return luaL_argerror(L, 1, "a name, or a function or an object of sinew expected");
    if (!print_texts(L, name)) return luaL_error(L, "no help for '%s' (help() lists what there is)", name);
    return 0;
}

void cli_open_help(lua_State *L)
{
    lua_register(L, "help", help);
}
