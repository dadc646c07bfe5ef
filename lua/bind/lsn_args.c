/* lsn_args.c - reads arguments: options by name, points, indices, lists; every mistake gets its own message.
 */
#include "lsn.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* ---- known names ---- */

const char *lsn_push_known(lua_State *L, const char *word, const char *const keys[])
{
    size_t n = 0;
    while (keys[n]) n++;
    const char *near = sn_nearest_name(word, keys, n);
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    if (near) {
        luaL_addstring(&b, "did you mean '");
        luaL_addstring(&b, near);
        luaL_addstring(&b, "'? ");
    }
    luaL_addstring(&b, "known: ");
    for (size_t i = 0; i < n; i++) {
        if (i > 0) luaL_addstring(&b, ", ");
        luaL_addstring(&b, keys[i]);
    }
    luaL_pushresult(&b);
    return lua_tostring(L, -1);
}

static bool is_known(const char *word, const char *const keys[])
{
    for (; *keys; keys++)
        if (strcmp(word, *keys) == 0) return true;
    return false;
}

void lsn_check_keys(lua_State *L, int arg, const char *const keys[])
{
    const char *unknown = NULL;
    if (lua_isnoneornil(L, arg)) return;
    if (!lua_istable(L, arg))
        (void)lsn_option_error(L, arg, NULL, "table of options expected, got %s", luaL_typename(L, arg));
    for (lua_pushnil(L); lua_next(L, arg); lua_pop(L, 1)) {
        if (lua_type(L, -2) != LUA_TSTRING)
            (void)lsn_option_error(L, arg, NULL, "options are given by name: {%s = ...}, not as a list",
                                   keys[0]);
        const char *key = lua_tostring(L, -2);
        if (!is_known(key, keys) && (!unknown || strcmp(key, unknown) < 0)) unknown = key;
    }
    if (unknown)
        (void)lsn_option_error(L, arg, NULL, "unknown option '%s' (%s)", unknown,
                               lsn_push_known(L, unknown, keys));
}

/* ---- options ---- */

int lsn_option_error(lua_State *L, int arg, const char *key, const char *fmt, ...)
{
    va_list ap;
    if (key) lua_pushfstring(L, "option '%s': ", key);
    va_start(ap, fmt);
    lua_pushvfstring(L, fmt, ap);
    va_end(ap);
    if (key) lua_concat(L, 2);
    return luaL_argerror(L, arg, lua_tostring(L, -1));
}

/* Pushes the value of an option; pushes nothing and returns false when there is none. Raw, so that the table
 * holds it. */
static bool push_option(lua_State *L, int arg, const char *key)
{
    if (!lua_istable(L, arg)) return false;
    lua_pushstring(L, key);
    if (lua_rawget(L, arg) != LUA_TNIL) return true;
    lua_pop(L, 1);
    return false;
}

bool lsn_has(lua_State *L, int arg, const char *key)
{
    if (!push_option(L, arg, key)) return false;
    lua_pop(L, 1);
    return true;
}

static int wrong_type(lua_State *L, int arg, const char *key, const char *want)
{
    return lsn_option_error(L, arg, key, "%s expected, got %s", want, luaL_typename(L, -1));
}

double lsn_opt_number(lua_State *L, int arg, const char *key, double def)
{
    double value;
    if (!push_option(L, arg, key)) return def;
    if (lua_type(L, -1) != LUA_TNUMBER) (void)wrong_type(L, arg, key, "number");
    value = lua_tonumber(L, -1);
    if (!isfinite(value)) (void)lsn_option_error(L, arg, key, "finite number expected, got %f", value);
    lua_pop(L, 1);
    return value;
}

double lsn_opt_positive(lua_State *L, int arg, const char *key, double def)
{
    if (!lsn_has(L, arg, key)) return def;
    double value = lsn_opt_number(L, arg, key, 0.0);
    if (!(value > 0.0)) (void)lsn_option_error(L, arg, key, "number above 0 expected, got %f", value);
    return value;
}

int32_t lsn_opt_int(lua_State *L, int arg, const char *key, int32_t def)
{
    int is_whole;
    if (!push_option(L, arg, key)) return def;
    if (lua_type(L, -1) != LUA_TNUMBER) (void)wrong_type(L, arg, key, "whole number");
    lua_Integer value = lua_tointegerx(L, -1, &is_whole);
    if (!is_whole || value < 0 || value > INT32_MAX)
        (void)lsn_option_error(L, arg, key, "whole number from 0 to %d expected, got %f", INT32_MAX,
                               lua_tonumber(L, -1));
    lua_pop(L, 1);
    return (int32_t)value;
}

const char *lsn_opt_string(lua_State *L, int arg, const char *key, const char *def)
{
    size_t size;
    if (!push_option(L, arg, key)) return def;
    if (lua_type(L, -1) != LUA_TSTRING) (void)wrong_type(L, arg, key, "string");
    const char *text = lua_tolstring(L, -1, &size);
    if (strlen(text) != size) (void)lsn_option_error(L, arg, key, "text with a zero byte");
    lua_pop(L, 1);
    return text;
}

bool lsn_opt_bool(lua_State *L, int arg, const char *key, bool def)
{
    if (!push_option(L, arg, key)) return def;
    if (!lua_isboolean(L, -1)) (void)wrong_type(L, arg, key, "boolean");
    bool value = lua_toboolean(L, -1);
    lua_pop(L, 1);
    return value;
}

sn_vec3 lsn_opt_point(lua_State *L, int arg, const char *key, sn_vec3 def, bool required)
{
    sn_vec3 p;
    if (!push_option(L, arg, key)) {
        if (required) (void)lsn_option_error(L, arg, NULL, "option '%s' is missing", key);
        return def;
    }
    lua_pushfstring(L, "option '%s'", key);
    if (!lsn_to_point(L, -2, lua_tostring(L, -1), &p)) (void)luaL_argerror(L, arg, lua_tostring(L, -1));
    lua_pop(L, 2);
    return p;
}

void lsn_enter_top(lua_State *L, int arg)
{
    lua_pushvalue(L, arg);
    lua_insert(L, -2);
    lua_replace(L, arg);
}

bool lsn_enter(lua_State *L, int arg, const char *key)
{
    if (!push_option(L, arg, key)) return false;
    if (!lua_istable(L, -1)) (void)wrong_type(L, arg, key, "table");
    lsn_enter_top(L, arg);
    return true;
}

void lsn_leave(lua_State *L, int arg)
{
    lua_replace(L, arg);
}

/* ---- numbers and points ---- */

bool lsn_to_number(lua_State *L, int idx, const char *what, double *out)
{
    if (lua_type(L, idx) != LUA_TNUMBER) {
        lua_pushfstring(L, "%s: number expected, got %s", what, luaL_typename(L, idx));
        return false;
    }
    *out = lua_tonumber(L, idx);
    if (isfinite(*out)) return true;
    lua_pushfstring(L, "%s: finite number expected, got %f", what, *out);
    return false;
}

/* The coordinate on top of the stack, which is popped. */
static bool take_coordinate(lua_State *L, const char *what, const char *name, double *out)
{
    lua_pushfstring(L, "%s: coordinate %s", what, name);
    if (!lsn_to_number(L, -2, lua_tostring(L, -1), out)) return false;
    lua_pop(L, 2);
    return true;
}

static bool table_point(lua_State *L, int idx, const char *what, sn_vec3 *out)
{
    static const char *const name[3] = {"x", "y", "z"};
    double c[3];
    bool is_list = lua_rawgeti(L, idx, 1) != LUA_TNIL;
    lua_pop(L, 1);
    if (is_list && lua_rawlen(L, idx) > 3) {
        lua_pushfstring(L, "%s: {x, y, z} expected, got a list of %d", what, (int)lua_rawlen(L, idx));
        return false;
    }
    for (int k = 0; k < 3; k++) {
        if (is_list)
            (void)lua_rawgeti(L, idx, k + 1);
        else
            (void)lua_getfield(L, idx, name[k]);
        if (!take_coordinate(L, what, name[k], &c[k])) return false;
    }
    *out = sn_v3_load(c);
    return true;
}

bool lsn_to_point(lua_State *L, int idx, const char *what, sn_vec3 *out)
{
    idx = lua_absindex(L, idx);
    if (lua_istable(L, idx)) return table_point(L, idx, what, out);
    const sn_vec3 *p = luaL_testudata(L, idx, LSN_VEC3);
    if (!p) {
        lua_pushfstring(L, "%s: {x, y, z} expected, got %s", what, luaL_typename(L, idx));
        return false;
    }
    *out = *p;
    if (sn_v3_is_finite(*p)) return true;
    lua_pushfstring(L, "%s: a coordinate of {%f, %f, %f} is not finite", what, p->x, p->y, p->z);
    return false;
}

sn_vec3 lsn_check_point(lua_State *L, int arg, const char *what)
{
    sn_vec3 p = {0};
    if (!lsn_to_point(L, arg, what, &p)) (void)luaL_argerror(L, arg, lua_tostring(L, -1));
    return p;
}

double lsn_check_finite(lua_State *L, int arg)
{
    luaL_checktype(L, arg, LUA_TNUMBER);
    double v = lua_tonumber(L, arg);
    if (!isfinite(v)) (void)luaL_argerror(L, arg, lua_pushfstring(L, "finite number expected, got %f", v));
    return v;
}

int32_t lsn_check_index(lua_State *L, int arg, int32_t n)
{
    luaL_checktype(L, arg, LUA_TNUMBER);
    lua_Integer i = luaL_checkinteger(L, arg);
    if (i < 1 || i > n)
        (void)luaL_argerror(L, arg, lua_pushfstring(L, "index %I not in 1..%d", (LUAI_UACINT)i, (int)n));
    return (int32_t)(i - 1);
}

const char *lsn_check_text(lua_State *L, int arg)
{
    size_t size;
    luaL_checktype(L, arg, LUA_TSTRING);
    const char *text = lua_tolstring(L, arg, &size);
    luaL_argcheck(L, strlen(text) == size, arg, "text with a zero byte");
    return text;
}

/* ---- lists ---- */

int32_t lsn_check_list(lua_State *L, int idx, int arg, const char *what)
{
    if (!lua_istable(L, idx))
        (void)luaL_argerror(L, arg,
                            lua_pushfstring(L, "%s: list expected, got %s", what, luaL_typename(L, idx)));
    lua_Unsigned n = lua_rawlen(L, idx);
    if (n > INT32_MAX) (void)luaL_argerror(L, arg, lua_pushfstring(L, "%s: the list is too long", what));
    return (int32_t)n;
}

double *lsn_push_numbers(lua_State *L, size_t n)
{
    return lua_newuserdatauv(L, n > 0 ? n * sizeof(double) : 1, 0);
}

const double *lsn_push_each(lua_State *L, int arg, const char *key, int32_t n, const char *what)
{
    if (!lsn_has(L, arg, key)) return NULL;
    int value = lua_gettop(L) + 1;
    bool is_list = lua_getfield(L, arg, key) == LUA_TTABLE;
    if (!is_list && lua_type(L, value) != LUA_TNUMBER)
        (void)lsn_option_error(L, arg, key, "number or list of numbers expected, got %s",
                               luaL_typename(L, value));
    if (is_list && lua_rawlen(L, value) != (lua_Unsigned)n)
        (void)lsn_option_error(L, arg, key, "%d values for %d %s", (int)lua_rawlen(L, value), n, what);
    double *each = lsn_push_numbers(L, (size_t)n);
    for (int32_t i = 0; i < n; i++) {
        if (is_list)
            (void)lua_geti(L, value, i + 1);
        else
            lua_pushvalue(L, value);
        if (is_list)
            lua_pushfstring(L, "%s[%d]", key, i + 1);
        else
            lua_pushfstring(L, "option '%s'", key);
        if (!lsn_to_number(L, -2, lua_tostring(L, -1), &each[i]))
            (void)luaL_argerror(L, arg, lua_tostring(L, -1));
        lua_pop(L, 2);
    }
    return each;
}

/* ---- planes and turns ---- */

void lsn_read_plane(lua_State *L, int arg, sn_vec3 *point, sn_vec3 *normal)
{
    static const char *const keys[] = {"point", "normal", NULL};
    lsn_check_keys(L, arg, keys);
    *point = lsn_opt_point(L, arg, "point", sn_v3(0, 0, 0), false);
    *normal = lsn_opt_point(L, arg, "normal", *point, true);
}

void lsn_read_turn(lua_State *L, int arg, sn_vec3 *axis, double *degrees)
{
    *axis = lsn_opt_point(L, arg, "axis", sn_v3(0, 0, 0), true);
    if (!(sn_v3_len2(*axis) > 0.0)) (void)lsn_option_error(L, arg, "axis", "has no length");
    if (!lsn_has(L, arg, "degrees")) (void)lsn_option_error(L, arg, NULL, "option 'degrees' is missing");
    *degrees = lsn_opt_number(L, arg, "degrees", 0.0);
}

bool lsn_opt_turn(lua_State *L, int arg, sn_vec3 *axis, double *degrees)
{
    static const char *const keys[] = {"axis", "degrees", NULL};
    if (!lsn_enter(L, arg, "rotate")) return false;
    lsn_check_keys(L, arg, keys);
    lsn_read_turn(L, arg, axis, degrees);
    lsn_leave(L, arg);
    return true;
}
