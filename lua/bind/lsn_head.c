/* lsn_head.c - curves and tissue values: of one head, or of a muscle that has but one. */
#include "lsn.h"

enum { max_curve_points = 1000000 };

/* A head's user value is the handle of its muscle. */
typedef struct head_handle {
    int32_t i_head;
} head_handle;

typedef struct target { /* what argument 1 stands for */
    sn_scene *scene;
    int32_t i_muscle, i_head;
    const sn_head *head;
} target;

/* Argument 1 is a head, or a muscle; i_head is then -1. */
static target find(lua_State *L)
{
    target t = {.i_head = -1};
    const head_handle *h = luaL_testudata(L, 1, LSN_HEAD);
    if (h)
        (void)lua_getiuservalue(L, 1, 1);
    else
        lua_pushvalue(L, 1);
    t.i_muscle = lsn_find_muscle(L, lua_gettop(L), &t.scene);
    lua_pop(L, 1);
    const sn_muscle *m = sn_scene_muscle(t.scene, t.i_muscle);
    if (!h) return t;
    t.i_head = h->i_head;
    if (t.i_head >= m->n_head)
        (void)lsn_fail(L, SN_EINVAL, "muscle '%s' has no head %d any more", m->name, t.i_head + 1);
    t.head = &m->head[t.i_head];
    return t;
}

/* The one head meant. */
static target check_head(lua_State *L)
{
    target t = find(L);
    const sn_muscle *m = sn_scene_muscle(t.scene, t.i_muscle);
    if (t.head) return t;
    if (m->n_head > 1)
        (void)lsn_fail(L, SN_EINVAL, "muscle '%s' has %d heads: say which, as in muscle:head(1):point(1)",
                       m->name, m->n_head);
    t.i_head = 0;
    t.head = &m->head[0];
    return t;
}

/* ---- heads of a muscle ---- */

int lsn_muscle_head_count(lua_State *L)
{
    sn_scene *s;
    int32_t i = lsn_find_muscle(L, 1, &s);
    lua_pushinteger(L, sn_scene_muscle(s, i)->n_head);
    return 1;
}

int lsn_muscle_head(lua_State *L) /* m:head(k) -> head */
{
    sn_scene *s;
    int32_t i = lsn_find_muscle(L, 1, &s), k = lsn_check_index(L, 2, sn_scene_muscle(s, i)->n_head);
    head_handle *h = lsn_new_object(L, LSN_HEAD, sizeof *h, 1);
    h->i_head = k;
    lua_pushvalue(L, 1);
    (void)lua_setiuservalue(L, -2, 1);
    return 1;
}

static int head_tostring(lua_State *L)
{
    const head_handle *h = luaL_checkudata(L, 1, LSN_HEAD);
    (void)lua_getiuservalue(L, 1, 1);
    lua_pushfstring(L, "%s, head %d", luaL_tolstring(L, -1, NULL), h->i_head + 1);
    return 1;
}

static int head_eq(lua_State *L)
{
    const head_handle *a = luaL_testudata(L, 1, LSN_HEAD), *b = luaL_testudata(L, 2, LSN_HEAD);
    bool equal = a && b && a->i_head == b->i_head;
    if (equal) {
        (void)lua_getiuservalue(L, 1, 1);
        (void)lua_getiuservalue(L, 2, 1);
        equal = lua_compare(L, -1, -2, LUA_OPEQ);
    }
    lua_pushboolean(L, equal);
    return 1;
}

/* ---- points ---- */

int lsn_head_point_count(lua_State *L)
{
    lua_pushinteger(L, check_head(L).head->n_point);
    return 1;
}

int lsn_head_point(lua_State *L)
{
    const sn_head *h = check_head(L).head;
    lsn_push_point(L, sn_v3_load(h->point + 3 * (size_t)lsn_check_index(L, 2, h->n_point)));
    return 1;
}

int lsn_head_set_point(lua_State *L)
{
    target t = check_head(L);
    int32_t i_point = lsn_check_index(L, 2, t.head->n_point);
    sn_vec3 p = lsn_check_point(L, 3, "point");
    sn_error err;
    lsn_scene_must(L, t.scene, sn_scene_set_point(t.scene, t.i_muscle, t.i_head, i_point, p, &err), &err);
    return 0;
}

/* A new point has the value of the curve where it goes in: half way between its neighbours, or that of the
 * end. */
static double tissue_between(const sn_head *h, int32_t i_point)
{
    if (i_point == 0) return h->tissue[0];
    if (i_point == h->n_point) return h->tissue[h->n_point - 1];
    return sn_head_tissue_at(h, i_point - 1, 0.5);
}

int lsn_head_insert_point(lua_State *L) /* (i, p [, tissue]): before point i; count + 1 appends */
{
    bool has_tissue = !lua_isnoneornil(L, 4);
    target t = check_head(L);
    int32_t i_point = lsn_check_index(L, 2, t.head->n_point + 1);
    sn_vec3 p = lsn_check_point(L, 3, "point");
    double tissue = has_tissue ? lsn_check_finite(L, 4) : tissue_between(t.head, i_point);
    sn_error err;
    lsn_scene_must(L, t.scene, sn_scene_insert_point(t.scene, t.i_muscle, t.i_head, i_point, p, tissue, &err),
                   &err);
    return 0;
}

int lsn_head_remove_point(lua_State *L)
{
    target t = check_head(L);
    int32_t i_point = lsn_check_index(L, 2, t.head->n_point);
    sn_error err;
    lsn_scene_must(L, t.scene, sn_scene_remove_point(t.scene, t.i_muscle, t.i_head, i_point, &err), &err);
    return 0;
}

/* ---- tissue ---- */

int lsn_head_tissue(lua_State *L)
{
    const sn_head *h = check_head(L).head;
    lua_pushnumber(L, h->tissue[lsn_check_index(L, 2, h->n_point)]);
    return 1;
}

int lsn_head_set_tissue(lua_State *L) /* (i, value), or (value) for all points, of all heads of a muscle */
{
    bool for_all = lua_gettop(L) <= 2;
    target t = for_all ? find(L) : check_head(L);
    int32_t i_point = for_all ? -1 : lsn_check_index(L, 2, t.head->n_point);
    double value = lsn_check_finite(L, for_all ? 2 : 3);
    sn_error err;
    lsn_scene_must(L, t.scene, sn_scene_set_tissue(t.scene, t.i_muscle, t.i_head, i_point, value, &err),
                   &err);
    return 0;
}

/* ---- the curve ---- */

int lsn_head_curve(lua_State *L) /* (n): n points evenly spaced along the curve */
{
    const sn_head *h = check_head(L).head;
    luaL_checktype(L, 2, LUA_TNUMBER);
    lua_Integer n = luaL_checkinteger(L, 2);
    if (n < 2 || n > max_curve_points)
        return luaL_argerror(L, 2,
                             lua_pushfstring(L, "%I points, need 2..%d", (LUAI_UACINT)n, max_curve_points));
    double *p = lsn_push_numbers(L, 3 * (size_t)n);
    sn_spline_sample(&h->spline, (int32_t)n, p);
    lua_createtable(L, (int)n, 0);
    for (lua_Integer i = 0; i < n; i++) {
        lsn_push_point(L, sn_v3_load(p + 3 * i));
        lua_rawseti(L, -2, i + 1);
    }
    return 1;
}

static int head_length(lua_State *L)
{
    lua_pushnumber(L, sn_spline_length(&check_head(L).head->spline));
    return 1;
}

void lsn_set_triad(lua_State *L, sn_triad f)
{
    lsn_set_point(L, "e1", f.e1);
    lsn_set_point(L, "e2", f.e2);
    lsn_set_point(L, "e3", f.e3);
}

static int head_frame(lua_State *L) /* h:frame(t) -> {e1=, e2=, e3=, point=}, t from 0 (origin) to 1 */
{
    target t = check_head(L);
    double at = lua_isnoneornil(L, 2) ? 0.0 : lsn_check_finite(L, 2);
    const sn_paths *paths;
    sn_error err;
    luaL_argcheck(L, at >= 0.0 && at <= 1.0, 2, "a number from 0 (origin) to 1 (insertion) expected");
    if (sn_scene_muscle_paths(t.scene, t.i_muscle, &paths, &err)) return lsn_raise(L, &err);
    const sn_path *p = &paths->head[t.i_head];
    lua_createtable(L, 0, 4);
    lsn_set_triad(L, sn_path_frame(p, at * p->length));
    lsn_set_point(L, "point", sn_path_point(p, at * p->length));
    return 1;
}

void lsn_open_head(lua_State *L)
{
    static const luaL_Reg meta[] = {{"__eq", head_eq}, {"__tostring", head_tostring}, {NULL, NULL}};
    static const luaL_Reg methods[] = {{"point_count", lsn_head_point_count},
                                       {"point", lsn_head_point},
                                       {"set_point", lsn_head_set_point},
                                       {"insert_point", lsn_head_insert_point},
                                       {"remove_point", lsn_head_remove_point},
                                       {"tissue", lsn_head_tissue},
                                       {"set_tissue", lsn_head_set_tissue},
                                       {"curve", lsn_head_curve},
                                       {"length", head_length},
                                       {"frame", head_frame},
                                       {NULL, NULL}};
    lsn_new_type(L, LSN_HEAD, meta, methods);
}
