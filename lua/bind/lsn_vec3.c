/* lsn_vec3.c - points and vectors as Lua values that do not change. */
#include "lsn.h"

#include "base/file.h"

#include <string.h>

void lsn_push_point(lua_State *L, sn_vec3 p)
{
    sn_vec3 *v = lsn_new_object(L, LSN_VEC3, sizeof *v, 0);
    *v = p;
}

static sn_vec3 check_vec3(lua_State *L, int arg)
{
    return *(const sn_vec3 *)luaL_checkudata(L, arg, LSN_VEC3);
}

static int push(lua_State *L, sn_vec3 p)
{
    lsn_push_point(L, p);
    return 1;
}

/* sinew.vec3(x, y, z) or sinew.vec3(point) */
static int vec3_new(lua_State *L)
{
    if (lua_gettop(L) == 1) return push(L, lsn_check_point(L, 1, "point"));
    double x = lsn_check_finite(L, 1), y = lsn_check_finite(L, 2), z = lsn_check_finite(L, 3);
    return push(L, sn_v3(x, y, z));
}

static int vec3_newindex(lua_State *L)
{
    return luaL_error(L, "a vec3 does not change: make a new one, {x, y, z} or sinew.vec3(x, y, z)");
}

static int vec3_len(lua_State *L)
{
    lua_pushinteger(L, 3);
    return 1;
}

static int vec3_eq(lua_State *L)
{
    const sn_vec3 *a = luaL_testudata(L, 1, LSN_VEC3), *b = luaL_testudata(L, 2, LSN_VEC3);
    lua_pushboolean(L, a && b && a->x == b->x && a->y == b->y && a->z == b->z);
    return 1;
}

static int vec3_tostring(lua_State *L) /* reads back as a table */
{
    sn_vec3 p = check_vec3(L, 1);
    char x[32], y[32], z[32];
    (void)sn_format_double(x, p.x);
    (void)sn_format_double(y, p.y);
    (void)sn_format_double(z, p.z);
    lua_pushfstring(L, "{%s, %s, %s}", x, y, z);
    return 1;
}

static int vec3_add(lua_State *L)
{
    return push(L, sn_v3_add(lsn_check_point(L, 1, "left side"), lsn_check_point(L, 2, "right side")));
}

static int vec3_sub(lua_State *L)
{
    return push(L, sn_v3_sub(lsn_check_point(L, 1, "left side"), lsn_check_point(L, 2, "right side")));
}

static int vec3_mul(lua_State *L) /* a number and a vec3, in either order */
{
    int number = lua_type(L, 1) == LUA_TNUMBER ? 1 : 2;
    if (lua_type(L, number) != LUA_TNUMBER)
        return luaL_error(L, "a vec3 times a number expected; for two vec3 use a:dot(b) or a:cross(b)");
    return push(L, sn_v3_scale(lsn_check_finite(L, number), lsn_check_point(L, 3 - number, "vec3")));
}

static int vec3_div(lua_State *L)
{
    sn_vec3 p = lsn_check_point(L, 1, "left side");
    double k = lsn_check_finite(L, 2);
    luaL_argcheck(L, k != 0.0, 2, "division by zero");
    return push(L, sn_v3(p.x / k, p.y / k, p.z / k));
}

static int vec3_unm(lua_State *L)
{
    return push(L, sn_v3_scale(-1.0, check_vec3(L, 1)));
}

static int vec3_dot(lua_State *L)
{
    lua_pushnumber(L, sn_v3_dot(check_vec3(L, 1), lsn_check_point(L, 2, "vector")));
    return 1;
}

static int vec3_cross(lua_State *L)
{
    return push(L, sn_v3_cross(check_vec3(L, 1), lsn_check_point(L, 2, "vector")));
}

static int vec3_length(lua_State *L)
{
    lua_pushnumber(L, sn_v3_len(check_vec3(L, 1)));
    return 1;
}

static int vec3_distance(lua_State *L)
{
    lua_pushnumber(L, sn_v3_dist(check_vec3(L, 1), lsn_check_point(L, 2, "point")));
    return 1;
}

static int vec3_unit(lua_State *L)
{
    return push(L, sn_v3_unit(check_vec3(L, 1)));
}

static const luaL_Reg methods[] = {{"dot", vec3_dot},       {"cross", vec3_cross},
                                   {"length", vec3_length}, {"distance", vec3_distance},
                                   {"unit", vec3_unit},     {NULL, NULL}};

static int vec3_index(lua_State *L) /* upvalue: the table of methods */
{
    sn_vec3 p = check_vec3(L, 1);
    int is_whole = 0;
    lua_Integer i = 0;
    if (lua_type(L, 2) == LUA_TNUMBER) {
        i = lua_tointegerx(L, 2, &is_whole);
        if (!is_whole || i < 1 || i > 3) return 0; /* nil: ends ipairs */
    } else if (lua_type(L, 2) == LUA_TSTRING) {
        const char *key = lua_tostring(L, 2);
        if (key[0] >= 'x' && key[0] <= 'z' && !key[1]) i = 1 + key[0] - 'x';
    }
    if (i == 0) {
        lua_settop(L, 2);
        lua_pushvalue(L, 2);
        return lua_rawget(L, lua_upvalueindex(1)) != LUA_TNIL ? 1 : lsn_unknown_method(L, "vec3", methods);
    }
    lua_pushnumber(L, i == 1 ? p.x : i == 2 ? p.y : p.z);
    return 1;
}

void lsn_open_vec3(lua_State *L)
{
    static const luaL_Reg meta[] = {{"__newindex", vec3_newindex},
                                    {"__len", vec3_len},
                                    {"__eq", vec3_eq},
                                    {"__tostring", vec3_tostring},
                                    {"__add", vec3_add},
                                    {"__sub", vec3_sub},
                                    {"__mul", vec3_mul},
                                    {"__div", vec3_div},
                                    {"__unm", vec3_unm},
                                    {NULL, NULL}};
    lsn_new_type(L, LSN_VEC3, meta, methods);
    luaL_getmetatable(L, LSN_VEC3);
    (void)lua_getfield(L, -1, "__index");
    lua_pushcclosure(L, vec3_index, 1);
    lua_setfield(L, -2, "__index");
    lua_pop(L, 1);
    lua_pushcfunction(L, vec3_new);
    lua_setfield(L, -2, "vec3");
}
