/* lsn_muscle.c - muscles of a scene: curves and tissue values. */
#include "lsn.h"

enum { max_curve_points = 1000000 };

static int32_t find(lua_State *L, sn_scene **s)
{
    const char *name;
    int32_t i = 0;
    sn_error err;
    *s = lsn_check_member(L, 1, LSN_MUSCLE, &name);
    sn_status st = sn_scene_find_muscle(*s, name, &i, &err);
    if (st == SN_EINVAL) (void)lsn_fail(L, SN_EINVAL, "muscle '%s' was removed", name);
    if (st) (void)lsn_raise(L, &err);
    return i;
}

static const sn_muscle *check_muscle(lua_State *L)
{
    sn_scene *s;
    int32_t i = find(L, &s);
    return sn_scene_muscle(s, i);
}

/* ---- in the scene ---- */

/* Pushes the coordinates of option `points` of the table at arg; *n receives how many points. */
static const double *push_points(lua_State *L, int arg, int32_t *n)
{
    if (!lsn_has(L, arg, "points")) (void)lsn_option_error(L, arg, NULL, "option 'points' is missing");
    int list = lua_gettop(L) + 1;
    (void)lua_getfield(L, arg, "points");
    *n = lsn_check_list(L, list, arg, "option 'points'");
    double *point = lsn_push_numbers(L, 3 * (size_t)*n);
    for (int32_t i = 0; i < *n; i++) {
        sn_vec3 p;
        (void)lua_geti(L, list, i + 1);
        lua_pushfstring(L, "points[%d]", i + 1);
        if (!lsn_to_point(L, -2, lua_tostring(L, -1), &p)) (void)luaL_argerror(L, arg, lua_tostring(L, -1));
        sn_v3_store(point + 3 * (size_t)i, p);
        lua_pop(L, 2);
    }
    return point;
}

/* The same for option `tissue`: a number for all n points, or a list of n; NULL when there is none. */
static const double *push_tissues(lua_State *L, int arg, int32_t n)
{
    if (!lsn_has(L, arg, "tissue")) return NULL;
    int value = lua_gettop(L) + 1;
    bool is_list = lua_getfield(L, arg, "tissue") == LUA_TTABLE;
    if (!is_list && lua_type(L, value) != LUA_TNUMBER)
        (void)lsn_option_error(L, arg, "tissue", "number or list of numbers expected, got %s",
                               luaL_typename(L, value));
    if (is_list && lua_rawlen(L, value) != (lua_Unsigned)n)
        (void)lsn_option_error(L, arg, "tissue", "%d values for %d points", (int)lua_rawlen(L, value), n);
    double *tissue = lsn_push_numbers(L, (size_t)n);
    for (int32_t i = 0; i < n; i++) {
        if (is_list)
            (void)lua_geti(L, value, i + 1);
        else
            lua_pushvalue(L, value);
        lua_pushfstring(L, is_list ? "tissue[%d]" : "option 'tissue'", i + 1);
        if (!lsn_to_number(L, -2, lua_tostring(L, -1), &tissue[i]))
            (void)luaL_argerror(L, arg, lua_tostring(L, -1));
        lua_pop(L, 2);
    }
    return tissue;
}

int lsn_scene_add_muscle(lua_State *L) /* scene:add_muscle(name, {points=, tissue=}) -> muscle */
{
    static const char *const keys[] = {"points", "tissue", NULL};
    sn_scene *s = lsn_check_scene(L, 1);
    const char *name = lsn_check_text(L, 2);
    int32_t n;
    sn_error err;
    luaL_checktype(L, 3, LUA_TTABLE);
    lsn_check_keys(L, 3, keys);
    const double *point = push_points(L, 3, &n), *tissue = push_tissues(L, 3, n);
    lsn_scene_must(L, s, sn_scene_add_muscle(s, name, point, tissue, n, &err), &err);
    lsn_push_member(L, LSN_MUSCLE, 1, name);
    return 1;
}

int lsn_scene_muscle(lua_State *L)
{
    sn_scene *s = lsn_check_scene(L, 1);
    const char *name = lsn_check_text(L, 2);
    int32_t i;
    sn_error err;
    if (sn_scene_find_muscle(s, name, &i, &err)) return lsn_raise(L, &err);
    lsn_push_member(L, LSN_MUSCLE, 1, name);
    return 1;
}

int lsn_scene_muscles(lua_State *L) /* in the order added */
{
    const sn_scene *s = lsn_check_scene(L, 1);
    int32_t n = sn_scene_muscle_count(s);
    lua_createtable(L, n, 0);
    for (int32_t i = 0; i < n; i++) {
        lsn_push_member(L, LSN_MUSCLE, 1, sn_scene_muscle(s, i)->name);
        lua_rawseti(L, -2, i + 1);
    }
    return 1;
}

int lsn_scene_remove_muscle(lua_State *L) /* by name or muscle */
{
    sn_scene *s = lsn_check_scene(L, 1);
    sn_error err;
    lsn_scene_must(L, s, sn_scene_remove_muscle(s, lsn_check_name(L, 2, LSN_MUSCLE), &err), &err);
    return 0;
}

/* ---- methods ---- */

static int muscle_name(lua_State *L)
{
    lua_pushstring(L, check_muscle(L)->name);
    return 1;
}

static int muscle_tostring(lua_State *L)
{
    lua_pushfstring(L, "muscle '%s'", (const char *)luaL_checkudata(L, 1, LSN_MUSCLE));
    return 1;
}

static int muscle_point_count(lua_State *L)
{
    lua_pushinteger(L, check_muscle(L)->n_point);
    return 1;
}

static int muscle_point(lua_State *L)
{
    const sn_muscle *m = check_muscle(L);
    lsn_push_point(L, sn_v3_load(m->point + 3 * (size_t)lsn_check_index(L, 2, m->n_point)));
    return 1;
}

static int muscle_set_point(lua_State *L)
{
    sn_scene *s;
    int32_t i = find(L, &s), i_point = lsn_check_index(L, 2, sn_scene_muscle(s, i)->n_point);
    sn_vec3 p = lsn_check_point(L, 3, "point");
    sn_error err;
    lsn_scene_must(L, s, sn_scene_set_point(s, i, i_point, p, &err), &err);
    return 0;
}

/* A new point has the value of the curve where it goes in: half way between its neighbours, or that of the
 * end. */
static double tissue_between(const sn_muscle *m, int32_t i_point)
{
    if (i_point == 0) return m->tissue[0];
    if (i_point == m->n_point) return m->tissue[m->n_point - 1];
    return sn_muscle_tissue_at(m, i_point - 1, 0.5);
}

static int muscle_insert_point(
    lua_State *L) /* m:insert_point(i, p [, tissue]): before point i; count + 1 appends */
{
    sn_scene *s;
    int32_t i = find(L, &s), i_point = lsn_check_index(L, 2, sn_scene_muscle(s, i)->n_point + 1);
    sn_vec3 p = lsn_check_point(L, 3, "point");
    double tissue =
        lua_isnoneornil(L, 4) ? tissue_between(sn_scene_muscle(s, i), i_point) : lsn_check_finite(L, 4);
    sn_error err;
    lsn_scene_must(L, s, sn_scene_insert_point(s, i, i_point, p, tissue, &err), &err);
    return 0;
}

static int muscle_remove_point(lua_State *L)
{
    sn_scene *s;
    int32_t i = find(L, &s), i_point = lsn_check_index(L, 2, sn_scene_muscle(s, i)->n_point);
    sn_error err;
    lsn_scene_must(L, s, sn_scene_remove_point(s, i, i_point, &err), &err);
    return 0;
}

static int muscle_tissue(lua_State *L)
{
    const sn_muscle *m = check_muscle(L);
    lua_pushnumber(L, m->tissue[lsn_check_index(L, 2, m->n_point)]);
    return 1;
}

static int muscle_set_tissue(lua_State *L) /* m:set_tissue(i, value), or (value) for all points */
{
    sn_scene *s;
    int32_t i = find(L, &s), i_point = -1;
    bool for_all = lua_gettop(L) <= 2;
    if (!for_all) i_point = lsn_check_index(L, 2, sn_scene_muscle(s, i)->n_point);
    double value = lsn_check_finite(L, for_all ? 2 : 3);
    sn_error err;
    lsn_scene_must(L, s, sn_scene_set_tissue(s, i, i_point, value, &err), &err);
    return 0;
}

static int muscle_curve(lua_State *L) /* m:curve(n): n points evenly spaced along the curve */
{
    const sn_muscle *m = check_muscle(L);
    luaL_checktype(L, 2, LUA_TNUMBER);
    lua_Integer n = luaL_checkinteger(L, 2);
    if (n < 2 || n > max_curve_points)
        return luaL_argerror(L, 2,
                             lua_pushfstring(L, "%I points, need 2..%d", (LUAI_UACINT)n, max_curve_points));
    double *p = lsn_push_numbers(L, 3 * (size_t)n);
    sn_spline_sample(&m->spline, (int32_t)n, p);
    lua_createtable(L, (int)n, 0);
    for (lua_Integer i = 0; i < n; i++) {
        lsn_push_point(L, sn_v3_load(p + 3 * i));
        lua_rawseti(L, -2, i + 1);
    }
    return 1;
}

static int muscle_length(lua_State *L)
{
    lua_pushnumber(L, sn_spline_length(&check_muscle(L)->spline));
    return 1;
}

void lsn_open_muscle(lua_State *L)
{
    static const luaL_Reg meta[] = {{"__eq", lsn_member_eq}, {"__tostring", muscle_tostring}, {NULL, NULL}};
    static const luaL_Reg methods[] = {{"name", muscle_name},
                                       {"point_count", muscle_point_count},
                                       {"point", muscle_point},
                                       {"set_point", muscle_set_point},
                                       {"insert_point", muscle_insert_point},
                                       {"remove_point", muscle_remove_point},
                                       {"tissue", muscle_tissue},
                                       {"set_tissue", muscle_set_tissue},
                                       {"curve", muscle_curve},
                                       {"length", muscle_length},
                                       {NULL, NULL}};
    lsn_new_type(L, LSN_MUSCLE, meta, methods);
}
