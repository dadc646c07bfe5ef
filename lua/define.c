#include "define.h"

#include <lauxlib.h>
#include <string.h>

static const char values_key; /* its address names the table of the variables not yet read in the registry */

static void push_value(lua_State *L, const char *text)
{
    if (strcmp(text, "true") == 0 || strcmp(text, "false") == 0)
        lua_pushboolean(L, text[0] == 't');
    else if (lua_stringtonumber(L, text) == 0)
        lua_pushstring(L, text);
}

/* __index of the globals, called for names that are not there. Upvalue 1: the variables not yet read. */
static int first_read(lua_State *L)
{
    lua_settop(L, 2);
    lua_pushvalue(L, 2);
    if (lua_rawget(L, lua_upvalueindex(1)) == LUA_TNIL) return 1;
    lua_pushvalue(L, 2); /* from here on an ordinary global */
    lua_pushvalue(L, 3);
    lua_rawset(L, 1);
    lua_pushvalue(L, 2);
    lua_pushnil(L);
    lua_rawset(L, lua_upvalueindex(1));
    return 1;
}

static int default_assigned(lua_State *L)
{
    lua_settop(L, 3);
    lua_pushvalue(L, 2);
    if (lua_rawget(L, lua_upvalueindex(1)) != LUA_TNIL) return 0;
    lua_settop(L, 3);
    lua_rawset(L, 1);
    return 0;
}

/* The table of values is on top; it stays. */
static void add_value(lua_State *L, const char *text)
{
    const char *eq = strchr(text, '=');
    lua_pushlstring(L, text, (size_t)(eq - text));
    lua_pushglobaltable(L);
    lua_pushvalue(L, -2);
    lua_pushnil(L);
    lua_rawset(L, -3); /* what Lua has by that name would never be looked for here */
    lua_pop(L, 1);
    push_value(L, eq + 1);
    lua_rawset(L, -3);
}

void cli_define_globals(lua_State *L, const cli_list *define)
{
    if (define->n == 0) return;
    lua_newtable(L);
    for (int i = 0; i < define->n; i++) add_value(L, define->item[i]);
    lua_pushvalue(L, -1);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &values_key);
    lua_pushglobaltable(L);
    lua_createtable(L, 0, 2);
    lua_pushvalue(L, -3);
    lua_pushcclosure(L, first_read, 1);
    lua_setfield(L, -2, "__index");
    lua_pushvalue(L, -3);
    lua_pushcclosure(L, default_assigned, 1);
    lua_setfield(L, -2, "__newindex");
    lua_setmetatable(L, -2);
    lua_pop(L, 2);
}

void cli_define_settle(lua_State *L)
{
    if (lua_rawgetp(L, LUA_REGISTRYINDEX, &values_key) != LUA_TTABLE) {
        lua_pop(L, 1);
        return;
    }
    lua_pushglobaltable(L);
    lua_pushnil(L);
    while (lua_next(L, -3)) { /* values, globals, name, value */
        lua_pushvalue(L, -2);
        lua_insert(L, -2);
        lua_rawset(L, -4);
        lua_pushvalue(L, -1);
        lua_pushnil(L);
        lua_rawset(L, -5); /* with no values left the metatable does nothing */
    }
    lua_pop(L, 2);
}
