/* repl_print.c - values as the REPL shows them. */
#include "repl.h"

#include "sorted_keys.h"

#include <ctype.h>
#include <lauxlib.h>
#include <stdio.h>
#include <string.h>

#define MAX_LEVEL 2   /* of tables; deeper ones are {...} */
#define MAX_TEXT 100  /* bytes of a string in a table     */
#define LINE_WIDTH 76 /* a table that fits stays on one line */

/* How many items of a table on this level are shown. */
static lua_Integer max_items(int level)
{
    return level == 0 ? 60 : 12;
}

static void push_value_text(lua_State *L, int idx, int level);

static void push_quoted(lua_State *L, int idx)
{
    size_t n;
    const char *s = lua_tolstring(L, idx, &n);
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    luaL_addchar(&b, '"');
    for (size_t i = 0; i < n; i++) {
        char code[8];
        unsigned char c = (unsigned char)s[i];
        if (i >= MAX_TEXT && c < 0x80) { /* not within a UTF-8 sequence */
            luaL_addstring(&b, "\"...");
            luaL_pushresult(&b);
            return;
        }
        if (c == '"' || c == '\\')
            (void)snprintf(code, sizeof code, "\\%c", c);
        else if (c == '\n')
            (void)snprintf(code, sizeof code, "\\n");
        else if (c < 0x20 || c == 0x7F)
            (void)snprintf(code, sizeof code, "\\x%02X", c);
        else
            (void)snprintf(code, sizeof code, "%c", c);
        luaL_addstring(&b, code);
    }
    luaL_addchar(&b, '"');
    luaL_pushresult(&b);
}

static bool is_name(const char *s)
{
    if (!isalpha((unsigned char)s[0]) && s[0] != '_') return false;
    for (; *s; s++)
        if (!isalnum((unsigned char)*s) && *s != '_') return false;
    return true;
}

static void push_key_text(lua_State *L, int idx)
{
    if (lua_type(L, idx) == LUA_TSTRING && is_name(lua_tostring(L, idx))) {
        lua_pushvalue(L, idx);
        return;
    }
    idx = lua_absindex(L, idx);
    lua_pushliteral(L, "[");
    push_value_text(L, idx, MAX_LEVEL);
    lua_pushliteral(L, "]");
    lua_concat(L, 3);
}

/* Pushes the text of item i of the sorted keys: "value" in the list part, else "key = value". */
static void push_item_text(lua_State *L, int table, int keys, lua_Integer i, int level)
{
    lua_rawgeti(L, keys, i);
    lua_pushvalue(L, -1);
    lua_rawget(L, table);
    int key = lua_gettop(L) - 1;
    if (lua_isinteger(L, key) && lua_tointeger(L, key) == i) {
        push_value_text(L, key + 1, level + 1);
    } else {
        push_key_text(L, key);
        lua_pushliteral(L, " = ");
        push_value_text(L, key + 1, level + 1);
        lua_concat(L, 3);
    }
    lua_replace(L, key);
    lua_settop(L, key);
}

/* Fills the list at `items` and returns whether they fit on one line together. */
static bool make_items(lua_State *L, int table, int keys, lua_Integer n, int items, int level)
{
    size_t width = 2;
    bool is_flat = true;
    for (lua_Integer i = 1; i <= n && i <= max_items(level); i++) {
        push_item_text(L, table, keys, i, level);
        size_t len;
        const char *text = lua_tolstring(L, -1, &len);
        is_flat = is_flat && !memchr(text, '\n', len);
        width += len + 2;
        lua_rawseti(L, items, i);
    }
    if (n > max_items(level)) {
        lua_pushfstring(L, "... (%I more)", (LUAI_UACINT)(n - max_items(level)));
        lua_rawseti(L, items, max_items(level) + 1);
    }
    return is_flat && width + 2 * (size_t)level <= LINE_WIDTH && n <= max_items(level);
}

static void push_table_text(lua_State *L, int table, int level)
{
    lua_Integer n = cli_push_sorted_keys(L, table);
    int keys = lua_gettop(L), items = keys + 1;
    if (level >= MAX_LEVEL && n > 0) {
        lua_pushliteral(L, "{...}");
        lua_replace(L, keys);
        return;
    }
    lua_newtable(L);
    bool is_flat = make_items(L, table, keys, n, items, level);
    char gap[2 * MAX_LEVEL + 8];
    (void)snprintf(gap, sizeof gap, "\n%*s", 2 * level, "");
    lua_Integer n_item = n > max_items(level) ? max_items(level) + 1 : n;
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    luaL_addstring(&b, "{");
    for (lua_Integer i = 1; i <= n_item; i++) {
        luaL_addstring(&b, is_flat ? (i > 1 ? " " : "") : gap);
        if (!is_flat) luaL_addstring(&b, "  ");
        lua_rawgeti(L, items, i);
        luaL_addvalue(&b);
        if (i < n_item) luaL_addstring(&b, ",");
    }
    if (!is_flat) luaL_addstring(&b, gap);
    luaL_addstring(&b, "}");
    luaL_pushresult(&b);
    lua_replace(L, keys);
    lua_settop(L, keys);
}

static bool has_text_of_its_own(lua_State *L, int idx)
{
    if (luaL_getmetafield(L, idx, "__tostring") == LUA_TNIL) return false;
    lua_pop(L, 1);
    return true;
}

static void push_value_text(lua_State *L, int idx, int level)
{
    luaL_checkstack(L, 24, "too many nested tables");
    idx = lua_absindex(L, idx);
    if (lua_type(L, idx) == LUA_TSTRING && level > 0)
        push_quoted(L, idx);
    else if (lua_type(L, idx) == LUA_TTABLE && !has_text_of_its_own(L, idx))
        push_table_text(L, idx, level);
    else
        luaL_tolstring(L, idx, NULL);
}

int cli_print_values(lua_State *L)
{
    int n = lua_gettop(L);
    for (int i = 1; i <= n; i++) {
        size_t len;
        push_value_text(L, i, 0);
        const char *text = lua_tolstring(L, -1, &len);
        (void)fwrite(text, 1, len, stdout);
        (void)fputc(i < n ? '\t' : '\n', stdout);
        lua_settop(L, n);
    }
    (void)fflush(stdout);
    return 0;
}
