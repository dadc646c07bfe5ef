/* lsn_muscle.c - muscles of a scene: adding them, and what their owner wants of shape and fibers. Curves are
 * in lsn_head.c. */
#include "lsn.h"

#include <string.h>

enum { max_heads = 64 };

int32_t lsn_find_muscle(lua_State *L, int arg, sn_scene **s)
{
    const char *name;
    int32_t i = 0;
    sn_error err;
    *s = lsn_check_member(L, arg, LSN_MUSCLE, &name);
    sn_status st = sn_scene_find_muscle(*s, name, &i, &err);
    if (st == SN_EINVAL) (void)lsn_fail(L, SN_EINVAL, "muscle '%s' was removed", name);
    if (st) (void)lsn_raise(L, &err);
    return i;
}

static const sn_muscle *check_muscle(lua_State *L)
{
    sn_scene *s;
    int32_t i = lsn_find_muscle(L, 1, &s);
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

/* Reads {points=, tissue=} at arg; what it points to stays on the stack. */
static sn_head_points push_head(lua_State *L, int arg)
{
    sn_head_points h = {0};
    h.point = push_points(L, arg, &h.n);
    h.tissue = push_tissues(L, arg, h.n);
    return h;
}

/* The head at argument 1, in a protected call: returns what it points to, to be kept, and fills the light
 * userdata at argument 2. */
static int read_head(lua_State *L)
{
    static const char *const keys[] = {"points", "tissue", NULL};
    sn_head_points *out = lua_touserdata(L, 2);
    lua_settop(L, 1);
    if (!lua_istable(L, 1))
        return lsn_option_error(L, 1, NULL, "{points=, tissue=} expected, got %s", luaL_typename(L, 1));
    lsn_check_keys(L, 1, keys);
    *out = push_head(L, 1);
    lua_createtable(L, 4, 0);
    lua_insert(L, 1);
    for (int i = lua_gettop(L); i > 1; i--) lua_rawseti(L, 1, i); /* the arrays live as long as this list */
    return 1;
}

/* Raises for arg what read_head said of head i: the text in the brackets of its message. */
static void blame_head(lua_State *L, int arg, int32_t i)
{
    const char *text = luaL_tolstring(L, -1, NULL), *open = strchr(text, '(');
    size_t n = open ? strlen(open + 1) : 0;
    if (n == 0 || open[n] != ')') (void)lua_error(L); /* none of ours: memory, say */
    lua_pushlstring(L, open + 1, n - 1);
    (void)lsn_option_error(L, arg, NULL, "heads[%d]: %s", i + 1, lua_tostring(L, -1));
}

/* Option `heads` of the table at arg: a list of {points=, tissue=}. Leaves what they hold on the stack. */
static const sn_head_points *push_head_list(lua_State *L, int arg, int32_t *n)
{
    int list = lua_gettop(L) + 1;
    (void)lua_getfield(L, arg, "heads");
    *n = lsn_check_list(L, list, arg, "option 'heads'");
    if (*n < 1 || *n > max_heads)
        (void)lsn_option_error(L, arg, "heads", "%d heads, need 1..%d", *n, (int)max_heads);
    sn_head_points *head = lua_newuserdatauv(L, (size_t)*n * sizeof *head, 0);
    luaL_checkstack(L, *n + 16, "too many heads");
    for (int32_t i = 0; i < *n; i++) {
        lua_pushcfunction(L, read_head);
        (void)lua_geti(L, list, i + 1);
        lua_pushlightuserdata(L, &head[i]);
        if (lua_pcall(L, 2, 1, 0) != LUA_OK) blame_head(L, arg, i);
    }
    return head;
}

const sn_head_points *lsn_push_heads(lua_State *L, int arg, int32_t *n)
{
    if (lsn_has(L, arg, "heads")) {
        if (lsn_has(L, arg, "points") || lsn_has(L, arg, "tissue"))
            (void)lsn_option_error(L, arg, NULL,
                                   "either option 'heads' or 'points' and 'tissue' expected, got both");
        return push_head_list(L, arg, n);
    }
    sn_head_points *one = lua_newuserdatauv(L, sizeof *one, 0);
    *one = push_head(L, arg);
    *n = 1;
    return one;
}

int lsn_scene_add_muscle(lua_State *L) /* scene:add_muscle(name, {points=, tissue=} or {heads=}) -> muscle */
{
    static const char *const keys[] = {"points", "tissue", "heads", NULL};
    sn_scene *s = lsn_check_scene(L, 1);
    const char *name = lsn_check_text(L, 2);
    int32_t n;
    sn_error err;
    luaL_checktype(L, 3, LUA_TTABLE);
    lsn_check_keys(L, 3, keys);
    const sn_head_points *head = lsn_push_heads(L, 3, &n);
    lsn_scene_must(L, s, sn_scene_add_heads(s, name, head, n, &err), &err);
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

static int muscle_length(lua_State *L) /* of all heads together */
{
    lua_pushnumber(L, sn_muscle_length(check_muscle(L)));
    return 1;
}

/* ---- frame ---- */

/* A list of one to `most` numbers under key, or one number; returns how many. */
static int32_t read_numbers(lua_State *L, int arg, const char *key, int32_t most, double *out)
{
    if (!lsn_has(L, arg, key)) return 0;
    if (lua_getfield(L, arg, key) != LUA_TTABLE) {
        lua_pop(L, 1);
        out[0] = lsn_opt_number(L, arg, key, 0.0);
        return 1;
    }
    lua_Unsigned n = lua_rawlen(L, -1);
    if (n < 1 || n > (lua_Unsigned)most)
        (void)lsn_option_error(L, arg, key, "%d values, need 1..%d", (int)n, (int)most);
    for (int i = 0; i < (int)n; i++) {
        (void)lua_rawgeti(L, -1, i + 1);
        lua_pushfstring(L, "option '%s'[%d]", key, i + 1);
        if (!lsn_to_number(L, -2, lua_tostring(L, -1), &out[i]))
            (void)luaL_argerror(L, arg, lua_tostring(L, -1));
        lua_pop(L, 2);
    }
    lua_pop(L, 1);
    return (int32_t)n;
}

static int muscle_set_frame(lua_State *L) /* m:set_frame{angle=, eigenvalues=, axis=}; nil turns it off */
{
    static const char *const keys[] = {"angle", "eigenvalues", "axis", NULL};
    sn_scene *s;
    int32_t i = lsn_find_muscle(L, 1, &s);
    sn_anisotropy a = {.eigenvalue = {1.0, 1.0, 1.0}};
    sn_error err;
    luaL_checkany(L, 2);
    lsn_check_keys(L, 2, keys);
    a.is_on = !lua_isnil(L, 2);
    a.angle_deg = lsn_opt_number(L, 2, "angle", 0.0);
    int32_t n = read_numbers(L, 2, "eigenvalues", 3, a.eigenvalue);
    if (n != 0 && n != 3) return lsn_option_error(L, 2, "eigenvalues", "{l1, l2, l3} expected, got %d", n);
    a.has_axis = lsn_has(L, 2, "axis");
    a.axis = lsn_opt_point(L, 2, "axis", sn_v3(0, 0, 0), false);
    lsn_scene_must(L, s, sn_scene_set_anisotropy(s, i, &a, &err), &err);
    return 0;
}

static int muscle_frame(lua_State *L) /* m:frame() -> {angle=, eigenvalues=, e1=, e2=, e3=} or nil */
{
    sn_scene *s;
    int32_t i = lsn_find_muscle(L, 1, &s);
    const sn_anisotropy *a = &sn_scene_muscle(s, i)->anisotropy;
    const sn_paths *paths;
    sn_error err;
    if (!a->is_on) return 0;
    if (sn_scene_muscle_paths(s, i, &paths, &err)) return lsn_raise(L, &err);
    lua_createtable(L, 0, 6);
    lsn_set_number(L, "angle", a->angle_deg);
    lua_createtable(L, 3, 0);
    for (int k = 0; k < 3; k++) {
        lua_pushnumber(L, a->eigenvalue[k]);
        lua_rawseti(L, -2, k + 1);
    }
    lua_setfield(L, -2, "eigenvalues");
    if (a->has_axis) lsn_set_point(L, "axis", a->axis);
    lsn_set_triad(L, paths->head[0].frame[0]);
    return 1;
}

/* ---- volume ---- */

static int muscle_volume(lua_State *L)
{
    sn_scene *s;
    int32_t i = lsn_find_muscle(L, 1, &s);
    double volume = 0.0;
    sn_error err;
    lsn_scene_must(L, s, sn_scene_muscle_volume(s, i, &lsn_get_state(L)->run, &volume, &err), &err);
    lua_pushnumber(L, volume);
    return 1;
}

static int muscle_set_volume(lua_State *L)
{
    sn_scene *s;
    int32_t i = lsn_find_muscle(L, 1, &s);
    double volume = lsn_check_finite(L, 2);
    sn_error err;
    lsn_scene_must(L, s, sn_scene_set_volume(s, i, volume, &lsn_get_state(L)->run, &err), &err);
    return 0;
}

static int muscle_set_preserve_volume(lua_State *L)
{
    sn_scene *s;
    int32_t i = lsn_find_muscle(L, 1, &s);
    sn_error err;
    luaL_checktype(L, 2, LUA_TBOOLEAN);
    lsn_scene_must(
        L, s, sn_scene_set_preserve_volume(s, i, lua_toboolean(L, 2), &lsn_get_state(L)->run, &err), &err);
    return 0;
}

static int muscle_preserved_volume(lua_State *L) /* or nil */
{
    sn_scene *s;
    int32_t i = lsn_find_muscle(L, 1, &s);
    double volume = sn_scene_kept_volume(s, i);
    if (!(volume > 0.0)) return 0;
    lua_pushnumber(L, volume);
    return 1;
}

/* ---- fibers and tendon ---- */

sn_pennation lsn_read_pennation(lua_State *L, int arg)
{
    sn_pennation p = {0};
    int32_t kind = 0;
    const char *word = lsn_opt_string(L, arg, "kind", sn_architecture_name[0]);
    while (kind < SN_N_ARCHITECTURE && strcmp(word, sn_architecture_name[kind]) != 0) kind++;
    if (kind == SN_N_ARCHITECTURE)
        (void)lsn_option_error(L, arg, "kind", "unknown kind '%s' (%s)", word,
                               lsn_push_known(L, word, sn_architecture_name));
    p.kind = (sn_architecture)kind;
    p.n_angle = read_numbers(L, arg, "angle", SN_PENNATION_ANGLES, p.angle_deg);
    if (lsn_has(L, arg, "sheets") && p.kind != SN_MULTIPENNATE)
        (void)lsn_option_error(L, arg, "sheets", "only a multipennate muscle has several");
    p.n_sheet = p.kind == SN_MULTIPENNATE ? lsn_opt_int(L, arg, "sheets", 2) : 0;
    return p;
}

static int muscle_set_pennation(lua_State *L) /* m:set_pennation{kind=, angle=, sheets=}; nil: fusiform */
{
    static const char *const keys[] = {"kind", "angle", "sheets", NULL};
    sn_scene *s;
    int32_t i = lsn_find_muscle(L, 1, &s);
    sn_error err;
    luaL_checkany(L, 2);
    lsn_check_keys(L, 2, keys);
    if (lua_istable(L, 2) && !lsn_has(L, 2, "kind"))
        return lsn_option_error(L, 2, NULL, "option 'kind' is missing");
    sn_pennation p = lsn_read_pennation(L, 2);
    lsn_scene_must(L, s, sn_scene_set_pennation(s, i, &p, &err), &err);
    return 0;
}

static int muscle_pennation(lua_State *L) /* -> {kind=, angle=, sheets=} */
{
    const sn_pennation *p = &check_muscle(L)->pennation;
    lua_createtable(L, 0, 3);
    lua_pushstring(L, sn_architecture_name[p->kind]);
    lua_setfield(L, -2, "kind");
    if (p->n_sheet > 0) lsn_set_integer(L, "sheets", p->n_sheet);
    if (p->n_angle == 1) lsn_set_number(L, "angle", p->angle_deg[0]);
    if (p->n_angle < 2) return 1;
    lua_createtable(L, p->n_angle, 0);
    for (int k = 0; k < p->n_angle; k++) {
        lua_pushnumber(L, p->angle_deg[k]);
        lua_rawseti(L, -2, k + 1);
    }
    lua_setfield(L, -2, "angle");
    return 1;
}

static int muscle_set_tendon(lua_State *L) /* m:set_tendon{length=, area=}; nil: none */
{
    static const char *const keys[] = {"length", "area", NULL};
    sn_scene *s;
    int32_t i = lsn_find_muscle(L, 1, &s);
    sn_error err;
    luaL_checkany(L, 2);
    lsn_check_keys(L, 2, keys);
    if (lua_istable(L, 2) && !lsn_has(L, 2, "length") && !lsn_has(L, 2, "area"))
        return lsn_option_error(L, 2, NULL, "option 'length' or 'area' expected");
    sn_tendon t = {lsn_opt_number(L, 2, "length", 0.0), lsn_opt_number(L, 2, "area", 0.0)};
    lsn_scene_must(L, s, sn_scene_set_tendon(s, i, &t, &err), &err);
    return 0;
}

static int muscle_tendon(lua_State *L) /* -> {length=, area=}, or nil */
{
    const sn_tendon *t = &check_muscle(L)->tendon;
    if (!(t->length > 0.0 || t->area > 0.0)) return 0;
    lua_createtable(L, 0, 2);
    lsn_set_number(L, "length", t->length);
    lsn_set_number(L, "area", t->area);
    return 1;
}

void lsn_open_muscle(lua_State *L)
{
    static const luaL_Reg meta[] = {{"__eq", lsn_member_eq}, {"__tostring", muscle_tostring}, {NULL, NULL}};
    static const luaL_Reg methods[] = {{"name", muscle_name},
                                       {"head_count", lsn_muscle_head_count},
                                       {"head", lsn_muscle_head},
                                       {"point_count", lsn_head_point_count},
                                       {"point", lsn_head_point},
                                       {"set_point", lsn_head_set_point},
                                       {"insert_point", lsn_head_insert_point},
                                       {"remove_point", lsn_head_remove_point},
                                       {"tissue", lsn_head_tissue},
                                       {"set_tissue", lsn_head_set_tissue},
                                       {"curve", lsn_head_curve},
                                       {"length", muscle_length},
                                       {"set_frame", muscle_set_frame},
                                       {"frame", muscle_frame},
                                       {"volume", muscle_volume},
                                       {"set_volume", muscle_set_volume},
                                       {"set_preserve_volume", muscle_set_preserve_volume},
                                       {"preserved_volume", muscle_preserved_volume},
                                       {"set_pennation", muscle_set_pennation},
                                       {"pennation", muscle_pennation},
                                       {"set_tendon", muscle_set_tendon},
                                       {"tendon", muscle_tendon},
                                       {NULL, NULL}};
    lsn_new_type(L, LSN_MUSCLE, meta, methods);
}
