#include "json.h"

#include "sorted_keys.h"

#include <lauxlib.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define MAX_DEPTH 16

void cli_json_init(cli_json *j, sn_out *out)
{
    *j = (cli_json){.out = out};
}

/* Length of the UTF-8 sequence at s (RFC 3629), 0 when it is none. */
static size_t utf8_length(const unsigned char *s, size_t n)
{
    static const unsigned least[] = {0, 0, 0x80, 0x800, 0x10000};
    if (s[0] < 0x80) return 1;
    size_t len = s[0] >= 0xF0 && s[0] < 0xF5   ? 4
                 : s[0] >= 0xE0 && s[0] < 0xF0 ? 3
                 : s[0] >= 0xC2 && s[0] < 0xE0 ? 2
                                               : 0;
    if (len == 0 || len > n) return 0;
    unsigned code = s[0] & (0x7Fu >> len);
    for (size_t i = 1; i < len; i++) {
        if ((s[i] & 0xC0) != 0x80) return 0;
        code = code << 6 | (s[i] & 0x3F);
    }
    return code < least[len] || code > 0x10FFFF || (code >= 0xD800 && code < 0xE000) ? 0 : len;
}

static void write_text(sn_out *out, const char *text, size_t n)
{
    sn_out_text(out, "\"");
    for (size_t i = 0; i < n;) {
        unsigned char c = (unsigned char)text[i];
        size_t len = utf8_length((const unsigned char *)text + i, n - i);
        char escape[8] = {'\\', (char)c, '\0'};
        if (len == 0)
            sn_out_text(out, "\xEF\xBF\xBD");
        else if (c == '"' || c == '\\')
            sn_out_text(out, escape);
        else if (c < 0x20 || c == 0x7F) {
            (void)snprintf(escape, sizeof escape, "\\u%04x", c);
            sn_out_text(out, escape);
        } else
            sn_out_bytes(out, text + i, len);
        i += len ? len : 1;
    }
    sn_out_text(out, "\"");
}

static void indent(cli_json *j)
{
    sn_out_text(j->out, "\n");
    for (int i = 0; i < j->depth; i++) sn_out_text(j->out, "  ");
}

static void start_item(cli_json *j, const char *key)
{
    if (j->has_item) sn_out_text(j->out, ",");
    if (j->depth > 0) indent(j);
    if (key) {
        write_text(j->out, key, strlen(key));
        sn_out_text(j->out, ": ");
    }
    j->has_item = true;
}

void cli_json_begin(cli_json *j, const char *key, char bracket)
{
    start_item(j, key);
    sn_out_bytes(j->out, &bracket, 1);
    j->depth++;
    j->has_item = false;
}

void cli_json_end(cli_json *j, char bracket)
{
    j->depth--;
    if (j->has_item) indent(j);
    sn_out_bytes(j->out, &bracket, 1);
    j->has_item = true;
    if (j->depth == 0) sn_out_text(j->out, "\n");
}

void cli_json_string(cli_json *j, const char *key, const char *value)
{
    start_item(j, key);
    if (value)
        write_text(j->out, value, strlen(value));
    else
        sn_out_text(j->out, "null");
}

void cli_json_int(cli_json *j, const char *key, int64_t value)
{
    start_item(j, key);
    sn_out_int(j->out, value);
}

void cli_json_double(cli_json *j, const char *key, double value)
{
    start_item(j, key);
    if (isfinite(value))
        sn_out_double(j->out, value);
    else
        sn_out_text(j->out, "null");
}

void cli_json_null(cli_json *j, const char *key)
{
    start_item(j, key);
    sn_out_text(j->out, "null");
}

static void write_list(cli_json *j, const char *key, lua_State *L, int table, lua_Integer n)
{
    cli_json_begin(j, key, '[');
    for (lua_Integer i = 1; i <= n; i++) {
        lua_rawgeti(L, table, i);
        cli_json_value(j, NULL, L, -1);
        lua_pop(L, 1);
    }
    cli_json_end(j, ']');
}

/* keys: the list of the table's sorted keys. */
static void write_object(cli_json *j, const char *key, lua_State *L, int table, int keys, lua_Integer n)
{
    cli_json_begin(j, key, '{');
    for (lua_Integer i = 1; i <= n; i++) {
        lua_rawgeti(L, keys, i);
        lua_pushvalue(L, -1);
        lua_rawget(L, table);
        cli_json_value(j, luaL_tolstring(L, -2, NULL), L, -2);
        lua_pop(L, 3);
    }
    cli_json_end(j, '}');
}

static void write_table(cli_json *j, const char *key, lua_State *L, int table)
{
    if (j->depth >= MAX_DEPTH) {
        cli_json_null(j, key);
        return;
    }
    lua_Integer n = cli_push_sorted_keys(L, table), n_list = (lua_Integer)lua_rawlen(L, table);
    if (n > 0 && n == n_list)
        write_list(j, key, L, table, n);
    else
        write_object(j, key, L, table, lua_gettop(L), n);
    lua_pop(L, 1);
}

void cli_json_value(cli_json *j, const char *key, lua_State *L, int idx)
{
    size_t n;
    idx = lua_absindex(L, idx);
    luaL_checkstack(L, 8, "too many nested tables");
    switch (lua_type(L, idx)) {
    case LUA_TNIL:
        cli_json_null(j, key);
        break;
    case LUA_TTABLE:
        write_table(j, key, L, idx);
        break;
    case LUA_TBOOLEAN:
        start_item(j, key);
        sn_out_text(j->out, lua_toboolean(L, idx) ? "true" : "false");
        break;
    case LUA_TNUMBER:
        if (lua_isinteger(L, idx))
            cli_json_int(j, key, lua_tointeger(L, idx));
        else
            cli_json_double(j, key, lua_tonumber(L, idx));
        break;
    default: {
        const char *text = luaL_tolstring(L, idx, &n);
        start_item(j, key);
        write_text(j->out, text, n);
        lua_pop(L, 1);
    }
    }
}
