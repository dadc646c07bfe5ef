/* repl_complete.c - what a word on the REPL's line may become. Nothing that could have an effect is called.
 */
#include "bind/lsn.h"
#include "repl.h"

#include <ctype.h>
#include <string.h>

#define MAX_INDEX 8 /* how many __index are followed */

static bool is_word_char(char c)
{
    return isalnum((unsigned char)c) || c == '_';
}

/* Where the identifier that ends at n starts. */
static size_t word_start(const char *line, size_t n)
{
    while (n > 0 && is_word_char(line[n - 1])) n--;
    return n;
}

static size_t skip_blanks_back(const char *line, size_t n)
{
    while (n > 0 && line[n - 1] == ' ') n--;
    return n;
}

/* ---- collecting ---- */

typedef struct want { /* of the word before the cursor */
    const char *prefix;
    size_t n_prefix;
    int list; /* stack index; also a set: list[name] = true */
} want;

static void offer(lua_State *L, const want *w, const char *name, size_t n)
{
    if (n < w->n_prefix || memcmp(name, w->prefix, w->n_prefix) != 0) return;
    lua_pushlstring(L, name, n);
    lua_pushvalue(L, -1);
    if (lua_rawget(L, w->list) == LUA_TNIL) {
        lua_pushvalue(L, -2);
        lua_pushboolean(L, 1);
        lua_rawset(L, w->list);
        lua_pushvalue(L, -2);
        lua_rawseti(L, w->list, (lua_Integer)lua_rawlen(L, w->list) + 1);
    }
    lua_pop(L, 2);
}

static void offer_fields(lua_State *L, const want *w, int table, bool only_functions)
{
    lua_pushnil(L);
    while (lua_next(L, table)) {
        if (lua_type(L, -2) == LUA_TSTRING && (!only_functions || lua_isfunction(L, -1))) {
            size_t n;
            const char *name = lua_tolstring(L, -2, &n);
            bool is_private = name[0] == '_' && w->n_prefix == 0;
            if (!is_private && word_start(name, n) == 0) offer(L, w, name, n);
        }
        lua_pop(L, 1);
    }
}

/* Replaces the value on top by its metatable's __index when that is a table; false: it is not, and the value
 * is gone. */
static bool to_index_table(lua_State *L)
{
    int type = luaL_getmetafield(L, -1, "__index");
    lua_remove(L, type == LUA_TNIL ? -1 : -2);
    if (type != LUA_TTABLE && type != LUA_TNIL) lua_pop(L, 1);
    return type == LUA_TTABLE;
}

/* The fields of the value on top, which is removed. */
static void offer_members(lua_State *L, const want *w, bool only_functions)
{
    bool is_table = lua_istable(L, -1);
    if (!is_table) is_table = to_index_table(L);
    for (int i = 0; is_table && i < MAX_INDEX; i++) {
        offer_fields(L, w, lua_gettop(L), only_functions);
        is_table = to_index_table(L);
    }
    if (is_table) lua_pop(L, 1);
}

static void offer_globals(lua_State *L, const want *w)
{
    static const char *const keyword[] = {
        "and", "break", "do",  "else", "elseif", "end",    "false",  "for",  "function", "goto",  "if",
        "in",  "local", "nil", "not",  "or",     "repeat", "return", "then", "true",     "until", "while"};
    if (w->n_prefix > 0)
        for (size_t i = 0; i < sizeof keyword / sizeof keyword[0]; i++)
            offer(L, w, keyword[i], strlen(keyword[i]));
    lua_pushglobaltable(L);
    offer_members(L, w, false);
}

/* ---- what stands before the word ---- */

/* Replaces the value on top by its member. */
static void to_member(lua_State *L, const char *name, size_t n)
{
    bool is_table = lua_istable(L, -1);
    if (!is_table) is_table = to_index_table(L);
    for (int i = 0; is_table && i < MAX_INDEX; i++) {
        lua_pushlstring(L, name, n);
        if (lua_rawget(L, -2) != LUA_TNIL) {
            lua_remove(L, -2);
            return;
        }
        lua_pop(L, 1);
        is_table = to_index_table(L);
    }
    if (is_table) lua_pop(L, 1);
    lua_pushnil(L);
}

/* What a method gives, so that `scene:muscle("x"):` has completions without a call. Pushes the metatable's
 * __index or nil. */
static void push_result_of(lua_State *L, const char *name, size_t n)
{
    static const char *const result[][2] = {
        {"muscle", LSN_MUSCLE},      {"add_muscle", LSN_MUSCLE}, {"draw_muscle", LSN_MUSCLE},
        {"head", LSN_HEAD},          {"bone", LSN_BONE},         {"add_bone", LSN_BONE},
        {"skin", LSN_SURFACE},       {"surface", LSN_SURFACE},   {"mesh", LSN_SURFACE},
        {"part", LSN_PART},          {"scene", LSN_SCENE},       {"render", LSN_IMAGE},
        {"extract", LSN_EXTRACTION}, {"load", LSN_SURFACE}};
    for (size_t i = 0; i < sizeof result / sizeof result[0]; i++) {
        if (strlen(result[i][0]) != n || memcmp(result[i][0], name, n) != 0) continue;
        luaL_getmetatable(L, result[i][1]);
        if (lua_istable(L, -1)) {
            lua_getfield(L, -1, "__index");
            lua_remove(L, -2);
        }
        return;
    }
    lua_pushnil(L);
}

/* Where the bracket that closes at line[n - 1] opens, or n when nowhere. Brackets inside of strings are
 * counted, too. */
static size_t opening(const char *line, size_t n)
{
    int depth = 0;
    for (size_t i = n; i > 0; i--) {
        char c = line[i - 1];
        if (c == ')' || c == '}' || c == ']') depth++;
        if ((c == '(' || c == '{' || c == '[') && --depth == 0) return i - 1;
    }
    return n;
}

/* Pushes the value of the expression that ends at n: names joined by '.', or the kind of thing that a call
 * gives; else nil. */
static void push_expression(lua_State *L, const char *line, size_t n)
{
    n = skip_blanks_back(line, n);
    size_t start = word_start(line, n);
    if (start == n && n > 0 && (line[n - 1] == ')' || line[n - 1] == '}')) {
        size_t end = skip_blanks_back(line, opening(line, n));
        start = word_start(line, end);
        push_result_of(L, line + start, end - start);
        return;
    }
    if (start == n) {
        lua_pushnil(L);
    } else if (start > 0 && line[start - 1] == '.') {
        luaL_checkstack(L, 8, "too many names");
        push_expression(L, line, start - 1);
        to_member(L, line + start, n - start);
    } else if (start > 0 && line[start - 1] == ':') {
        lua_pushnil(L);
    } else {
        lua_pushglobaltable(L);
        to_member(L, line + start, n - start);
    }
}

/* ---- names inside quotes ---- */

/* Where the string that is open at n starts (its quote), or n when none is. */
static size_t open_quote(const char *line, size_t n)
{
    size_t start = n;
    for (size_t i = 0; i < n; i++) {
        if (start == n && (line[i] == '"' || line[i] == '\''))
            start = i;
        else if (start < n && line[i] == '\\')
            i++;
        else if (start < n && line[i] == line[start])
            start = n;
    }
    return start;
}

static bool is_one_of(const char *name, size_t n, const char *const list[])
{
    for (; *list; list++)
        if (strlen(*list) == n && memcmp(*list, name, n) == 0) return true;
    return false;
}

static void offer_bones(lua_State *L, const want *w, const sn_scene *s)
{
    for (int32_t i = 0; i < sn_scene_bone_count(s); i++)
        offer(L, w, sn_scene_bone_name(s, i), strlen(sn_scene_bone_name(s, i)));
}

static void offer_tissues(lua_State *L, const want *w, const sn_scene *s, int32_t first)
{
    for (int32_t i = first; i < sn_scene_tissue_count(s); i++)
        offer(L, w, sn_scene_tissue_name(s, i), strlen(sn_scene_tissue_name(s, i)));
}

/* The names that the method before the quote takes. */
static void offer_names(lua_State *L, const want *w, const char *line, size_t quote)
{
    static const char *const of_muscles[] = {"muscle", "remove_muscle", NULL};
    static const char *const of_bones[] = {"bone", "remove_bone", NULL};
    static const char *const of_tissues[] = {"part", NULL};
    size_t end = skip_blanks_back(line, quote);
    if (end > 0 && line[end - 1] == '(') end = skip_blanks_back(line, end - 1);
    size_t start = word_start(line, end);
    if (start == 0 || line[start - 1] != ':') return;
    push_expression(L, line, start - 1);
    if (!luaL_testudata(L, -1, LSN_SCENE)) {
        lua_pop(L, 1);
        lsn_push_last_scene(L);
    }
    if (!lua_isnil(L, -1)) {
        const sn_scene *s = lsn_check_scene(L, lua_gettop(L));
        const char *method = line + start;
        size_t n = end - start;
        if (is_one_of(method, n, of_muscles)) offer_tissues(L, w, s, 1);
        if (is_one_of(method, n, of_bones)) offer_bones(L, w, s);
        if (is_one_of(method, n, of_tissues)) offer_tissues(L, w, s, 0);
    }
    lua_pop(L, 1);
}

size_t cli_push_completions(lua_State *L, const char *line, size_t n)
{
    luaL_checkstack(L, 16, "too many names");
    lua_newtable(L);
    want w = {.list = lua_gettop(L)};
    size_t quote = open_quote(line, n), start = quote < n ? quote + 1 : word_start(line, n);
    w.prefix = line + start;
    w.n_prefix = n - start;
    if (quote < n) {
        offer_names(L, &w, line, quote);
    } else if (start > 0 && (line[start - 1] == '.' || line[start - 1] == ':')) {
        push_expression(L, line, start - 1);
        offer_members(L, &w, line[start - 1] == ':');
    } else {
        offer_globals(L, &w);
    }
    lua_settop(L, w.list);
    return w.n_prefix;
}
