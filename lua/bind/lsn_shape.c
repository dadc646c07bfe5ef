/* lsn_shape.c - implicit shapes for skins and bones made by a script. */
#include "lsn.h"

static sn_shape **check_box(lua_State *L, int arg)
{
    return luaL_checkudata(L, arg, LSN_SHAPE);
}

sn_shape *lsn_check_shape(lua_State *L, int arg)
{
    sn_shape **s = check_box(L, arg);
    luaL_argcheck(L, *s != NULL, arg, "shape was closed");
    return *s;
}

static sn_shape **push_shape(lua_State *L)
{
    return lsn_new_object(L, LSN_SHAPE, sizeof(sn_shape *), 0);
}

static int made(lua_State *L, sn_status st, const sn_error *err)
{
    return st ? lsn_raise(L, err) : 1;
}

static int shape_gc(lua_State *L)
{
    sn_shape **s = check_box(L, 1);
    sn_shape_release(*s);
    *s = NULL;
    return 0;
}

static int shape_tostring(lua_State *L)
{
    sn_shape **s = check_box(L, 1);
    if (*s) {
        sn_vec3 size = sn_v3_sub(sn_shape_bounds(*s).max, sn_shape_bounds(*s).min);
        lua_pushfstring(L, "shape: within %f x %f x %f", size.x, size.y, size.z);
    } else {
        lua_pushliteral(L, "shape (was closed)");
    }
    return 1;
}

static int shape_sphere(lua_State *L) /* sphere(center, radius) */
{
    sn_vec3 center = lsn_check_point(L, 1, "center");
    double radius = lsn_check_finite(L, 2);
    sn_error err;
    return made(L, sn_shape_sphere(push_shape(L), center, radius, &err), &err);
}

static int shape_ellipsoid(lua_State *L) /* ellipsoid(center, {rx, ry, rz}) */
{
    sn_vec3 center = lsn_check_point(L, 1, "center"), radii = lsn_check_point(L, 2, "radii");
    sn_error err;
    return made(L, sn_shape_ellipsoid(push_shape(L), center, radii, &err), &err);
}

static int shape_capsule(lua_State *L) /* capsule(a, b, ra [, rb]) */
{
    sn_vec3 a = lsn_check_point(L, 1, "a"), b = lsn_check_point(L, 2, "b");
    double ra = lsn_check_finite(L, 3), rb = lua_isnoneornil(L, 4) ? ra : lsn_check_finite(L, 4);
    sn_error err;
    return made(L, sn_shape_capsule(push_shape(L), a, b, ra, rb, &err), &err);
}

static int shape_box(lua_State *L) /* box(center, {hx, hy, hz} [, rounding]) */
{
    sn_vec3 center = lsn_check_point(L, 1, "center"), half = lsn_check_point(L, 2, "half sizes");
    double rounding = lua_isnoneornil(L, 3) ? 0.0 : lsn_check_finite(L, 3);
    sn_error err;
    return made(L, sn_shape_box(push_shape(L), center, half, rounding, &err), &err);
}

/* The shapes from argument `first` on, or those of a list there: spread over the stack, which keeps them
 * alive. Pushes their array; *n receives how many. */
static sn_shape *const *check_shapes(lua_State *L, int first, int *n)
{
    if (lua_istable(L, first)) {
        int32_t n_item = lsn_check_list(L, first, first, "shapes");
        lua_settop(L, first);
        luaL_checkstack(L, n_item, "too many shapes");
        for (int32_t i = 0; i < n_item; i++) (void)lua_rawgeti(L, first, i + 1);
        lua_remove(L, first);
    }
    *n = lua_gettop(L) - first + 1;
    luaL_argcheck(L, *n > 0, first, "shapes expected, got none");
    luaL_checkstack(L, LUA_MINSTACK, "too many shapes");
    sn_shape **s = lua_newuserdatauv(L, (size_t)*n * sizeof *s, 0);
    for (int i = 0; i < *n; i++) s[i] = lsn_check_shape(L, first + i);
    return s;
}

static int shape_union(lua_State *L) /* union(a, b, ...) or union{a, b, ...} */
{
    int n;
    sn_shape *const *s = check_shapes(L, 1, &n);
    sn_error err;
    return made(L, sn_shape_union(push_shape(L), s, n, &err), &err);
}

static int shape_smooth_union(lua_State *L) /* smooth_union(k, a, b, ...) or (k, {a, b, ...}) */
{
    int n;
    double k = lsn_check_finite(L, 1);
    sn_shape *const *s = check_shapes(L, 2, &n);
    sn_error err;
    return made(L, sn_shape_smooth_union(push_shape(L), k, s, n, &err), &err);
}

static int shape_subtract(lua_State *L) /* subtract(a, b): a without b */
{
    sn_shape *a = lsn_check_shape(L, 1), *b = lsn_check_shape(L, 2);
    sn_error err;
    return made(L, sn_shape_subtract(push_shape(L), a, b, &err), &err);
}

static int shape_smooth_subtract(lua_State *L) /* smooth_subtract(k, a, b) */
{
    double k = lsn_check_finite(L, 1);
    sn_shape *a = lsn_check_shape(L, 2), *b = lsn_check_shape(L, 3);
    sn_error err;
    return made(L, sn_shape_smooth_subtract(push_shape(L), k, a, b, &err), &err);
}

static int shape_intersect(lua_State *L) /* intersect(a, b, ...) or intersect{a, b, ...} */
{
    int n;
    sn_shape *const *s = check_shapes(L, 1, &n);
    sn_error err;
    return made(L, sn_shape_intersect(push_shape(L), s, n, &err), &err);
}

static int shape_torus(lua_State *L) /* torus(center, axis, ring, tube) */
{
    sn_vec3 center = lsn_check_point(L, 1, "center"), axis = lsn_check_point(L, 2, "axis");
    double ring = lsn_check_finite(L, 3), tube = lsn_check_finite(L, 4);
    sn_error err;
    return made(L, sn_shape_torus(push_shape(L), center, axis, ring, tube, &err), &err);
}

static int shape_plate(lua_State *L) /* plate(a, b, c, radius) */
{
    sn_vec3 a = lsn_check_point(L, 1, "a"), b = lsn_check_point(L, 2, "b"), c = lsn_check_point(L, 3, "c");
    double radius = lsn_check_finite(L, 4);
    sn_error err;
    return made(L, sn_shape_plate(push_shape(L), a, b, c, radius, &err), &err);
}

/* Option scale: a number or one for each axis. */
static sn_vec3 opt_scale(lua_State *L, int arg)
{
    bool each = lua_istable(L, arg) && lua_getfield(L, arg, "scale") == LUA_TTABLE;
    lua_settop(L, arg);
    if (each) return lsn_opt_point(L, arg, "scale", sn_v3(1.0, 1.0, 1.0), true);
    double s = lsn_opt_positive(L, arg, "scale", 1.0);
    return sn_v3(s, s, s);
}

static int shape_transform(lua_State *L) /* s:transform{scale=, rotate={axis=, degrees=}, translate=} */
{
    static const char *const keys[] = {"scale", "rotate", "translate", NULL};
    sn_shape *s = lsn_check_shape(L, 1);
    lsn_check_keys(L, 2, keys);
    sn_shape_placement t = {.scale = opt_scale(L, 2)};
    t.translate = lsn_opt_point(L, 2, "translate", t.translate, false);
    (void)lsn_opt_turn(L, 2, &t.axis, &t.angle_deg);
    sn_error err;
    return made(L, sn_shape_transform(push_shape(L), s, &t, &err), &err);
}

static int shape_mirror(lua_State *L) /* s:mirror{point=, normal=} */
{
    static const char *const keys[] = {"point", "normal", NULL};
    sn_shape *s = lsn_check_shape(L, 1);
    lsn_check_keys(L, 2, keys);
    sn_vec3 point = lsn_opt_point(L, 2, "point", sn_v3(0.0, 0.0, 0.0), false);
    sn_vec3 normal = lsn_opt_point(L, 2, "normal", point, true);
    sn_error err;
    return made(L, sn_shape_mirror(push_shape(L), s, point, normal, &err), &err);
}

static int shape_value(lua_State *L)
{
    const sn_shape *s = lsn_check_shape(L, 1);
    lua_pushnumber(L, sn_shape_value(s, lsn_check_point(L, 2, "point")));
    return 1;
}

static int shape_bounds(lua_State *L)
{
    lsn_push_box(L, sn_shape_bounds(lsn_check_shape(L, 1)));
    return 1;
}

static int shape_mesh(lua_State *L) /* shape:mesh{cell=} -> surface */
{
    static const char *const keys[] = {"cell", NULL};
    const sn_shape *s = lsn_check_shape(L, 1);
    lsn_check_keys(L, 2, keys);
    if (!lsn_has(L, 2, "cell"))
        return lsn_option_error(L, 2, NULL, "option 'cell' (the edge length) is missing");
    double cell = lsn_opt_positive(L, 2, "cell", 0.0);
    sn_tri_mesh *m = lsn_push_surface(L);
    sn_error err;
    if (sn_shape_mesh(s, cell, &lsn_get_state(L)->run, m, &err)) return lsn_raise(L, &err);
    lsn_account(L, 24 * (size_t)m->n_vert + 12 * (size_t)m->n_face);
    return 1;
}

void lsn_open_shape(lua_State *L)
{
    static const luaL_Reg meta[] = {
        {"__gc", shape_gc}, {"__close", shape_gc}, {"__tostring", shape_tostring}, {NULL, NULL}};
    static const luaL_Reg methods[] = {{"mesh", shape_mesh},
                                       {"value", shape_value},
                                       {"bounds", shape_bounds},
                                       {"transform", shape_transform},
                                       {"mirror", shape_mirror},
                                       {"close", shape_gc},
                                       {NULL, NULL}};
    static const luaL_Reg functions[] = {
        {"sphere", shape_sphere},       {"ellipsoid", shape_ellipsoid},
        {"capsule", shape_capsule},     {"box", shape_box},
        {"union", shape_union},         {"smooth_union", shape_smooth_union},
        {"subtract", shape_subtract},   {"smooth_subtract", shape_smooth_subtract},
        {"intersect", shape_intersect}, {"torus", shape_torus},
        {"plate", shape_plate},         {NULL, NULL}};
    lsn_new_type(L, LSN_SHAPE, meta, methods);
    luaL_newlib(L, functions);
    lua_setfield(L, -2, "shape");
}
