#include "sorted_keys.h"

#include <lauxlib.h>
#include <stdbool.h>
#include <string.h>

static int rank(lua_State *L, int idx)
{
    int type = lua_type(L, idx);
    return type == LUA_TNUMBER ? 0 : type == LUA_TSTRING ? 1 : 2;
}

static int compare_strings(lua_State *L, int a, int b)
{
    size_t n_a, n_b;
    const char *s_a = lua_tolstring(L, a, &n_a), *s_b = lua_tolstring(L, b, &n_b);
    int c = memcmp(s_a, s_b, n_a < n_b ? n_a : n_b);
    return c ? c : n_a < n_b ? -1 : n_a > n_b;
}

static bool is_less(lua_State *L, int a, int b)
{
    int rank_a = rank(L, a), rank_b = rank(L, b);
    if (rank_a != rank_b) return rank_a < rank_b;
    if (rank_a == 0) return lua_compare(L, a, b, LUA_OPLT);
    return rank_a == 1 && compare_strings(L, a, b) < 0;
}

/* Sinks list[i] in the heap of the first n: the largest key is at 1. */
static void sink(lua_State *L, int list, lua_Integer i, lua_Integer n)
{
    for (lua_Integer child = 2 * i; child <= n; i = child, child = 2 * i) {
        lua_rawgeti(L, list, child);
        lua_rawgeti(L, list, child < n ? child + 1 : child);
        if (child < n && is_less(L, -2, -1)) child++;
        lua_pop(L, 2);
        lua_rawgeti(L, list, i);
        lua_rawgeti(L, list, child);
        if (!is_less(L, -2, -1)) {
            lua_pop(L, 2);
            return;
        }
        lua_rawseti(L, list, i);
        lua_rawseti(L, list, child);
    }
}

static void swap(lua_State *L, int list, lua_Integer i, lua_Integer j)
{
    lua_rawgeti(L, list, i);
    lua_rawgeti(L, list, j);
    lua_rawseti(L, list, i);
    lua_rawseti(L, list, j);
}

lua_Integer cli_push_sorted_keys(lua_State *L, int table)
{
    lua_Integer n = 0;
    table = lua_absindex(L, table);
    luaL_checkstack(L, 8, "too many nested tables");
    lua_newtable(L);
    int list = lua_gettop(L);
    lua_pushnil(L);
    while (lua_next(L, table)) {
        lua_pop(L, 1);
        lua_pushvalue(L, -1);
        lua_rawseti(L, list, ++n);
    }
    for (lua_Integer i = n / 2; i >= 1; i--) sink(L, list, i, n);
    for (lua_Integer last = n; last > 1; last--) {
        swap(L, list, 1, last);
        sink(L, list, 1, last - 1);
    }
    return n;
}
