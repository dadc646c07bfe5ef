/* lsn_bones.c - the bone library: sinew.bones.list and sinew.bones.add. */
#include "lsn.h"

#include "base/alloc.h"
#include "base/array.h"

#include <string.h>

static const char library_type[] = "sinew.bone_library", template_type[] = "sinew.bone_template";

/* The one library of this state. */
sn_bone_library *lsn_bone_library(lua_State *L)
{
    sn_error err;
    if (lua_getfield(L, LUA_REGISTRYINDEX, library_type) != LUA_TUSERDATA) {
        sn_bone_library **box = lsn_new_object(L, library_type, sizeof *box, 0);
        if (sn_bone_library_create(box, &err)) (void)lsn_raise(L, &err);
        lua_setfield(L, LUA_REGISTRYINDEX, library_type);
        lua_pop(L, 1);
        (void)lua_getfield(L, LUA_REGISTRYINDEX, library_type);
    }
    sn_bone_library *l = *(sn_bone_library **)lua_touserdata(L, -1);
    lua_pop(L, 1);
    return l;
}

static int library_gc(lua_State *L)
{
    sn_bone_library **box = lua_touserdata(L, 1);
    sn_bone_library_destroy(*box);
    *box = NULL;
    return 0;
}

static int template_gc(lua_State *L)
{
    sn_bone_template_free(lua_touserdata(L, 1));
    return 0;
}

static void push_landmark_names(lua_State *L, const sn_bone_template *t)
{
    lua_createtable(L, t->n_landmark, 0);
    for (int32_t k = 0; k < t->n_landmark; k++) {
        lua_pushstring(L, t->landmark[k].name);
        lua_rawseti(L, -2, k + 1);
    }
}

static int bones_list(
    lua_State *L) /* sinew.bones.list() -> list of {name=, kind=, faces=, fits=, landmarks=} */
{
    sn_bone_library *l = lsn_bone_library(L);
    int32_t n = sn_bone_library_count(l);
    lua_createtable(L, n, 0);
    for (int32_t i = 0; i < n; i++) {
        const sn_bone_template *t;
        sn_error err;
        if (sn_bone_library_find(l, sn_bone_library_name(l, i), &t, &err)) return lsn_raise(L, &err);
        lua_createtable(L, 0, 5);
        lua_pushstring(L, t->name);
        lua_setfield(L, -2, "name");
        lua_pushstring(L, sn_bone_kind_name(t->kind));
        lua_setfield(L, -2, "kind");
        lsn_set_integer(L, "faces", t->bone.n_face);
        lsn_set_bool(L, "fits", t->cage.n_face > 0);
        push_landmark_names(L, t);
        lua_setfield(L, -2, "landmarks");
        lua_rawseti(L, -2, i + 1);
    }
    return 1;
}

static int bones_surface(lua_State *L) /* sinew.bones.surface(name [, "cage" | "skin"]) -> surface */
{
    static const char *const parts[] = {"bone", "cage", "skin", NULL};
    const sn_bone_template *t;
    sn_error err;
    if (sn_bone_library_find(lsn_bone_library(L), lsn_check_text(L, 1), &t, &err)) return lsn_raise(L, &err);
    int part = luaL_checkoption(L, 2, "bone", parts);
    const sn_tri_mesh *m = part == 0 ? &t->bone : part == 1 ? &t->cage : &t->skin;
    if (m->n_face == 0)
        return lsn_fail(L, SN_EINVAL, "template '%s' has no %s: only shape bones have", t->name, parts[part]);
    if (sn_tri_mesh_copy(lsn_push_surface(L), m, &err)) return lsn_raise(L, &err);
    return 1;
}

/* ---- a user's template ---- */

static void copy_surface(lua_State *L, const char *key, sn_tri_mesh *out)
{
    sn_error err;
    if (!lsn_has(L, 1, key)) return;
    (void)lua_getfield(L, 1, key);
    const sn_tri_mesh *m = luaL_testudata(L, -1, LSN_SURFACE) ? lsn_check_surface(L, lua_gettop(L)) : NULL;
    if (!m) (void)lsn_option_error(L, 1, key, "surface expected, got %s", luaL_typename(L, -1));
    if (sn_tri_mesh_copy(out, m, &err)) (void)lsn_raise(L, &err);
    lua_pop(L, 1);
}

/* The landmark on top of the stack: {x, y, z} or {point=, radius=}. */
static void read_landmark(lua_State *L, sn_landmark *l)
{
    static const char *const keys[] = {"point", "radius", NULL};
    const char *what = lua_pushfstring(L, "landmark '%s'", l->name);
    lua_insert(L, -2);
    if (lua_istable(L, -1) && lua_getfield(L, -1, "point") != LUA_TNIL) {
        lua_pop(L, 1);
        lsn_enter_top(L, 1);
        lsn_check_keys(L, 1, keys);
        l->at = lsn_opt_point(L, 1, "point", l->at, true);
        l->radius = lsn_opt_number(L, 1, "radius", 0.0);
        lsn_leave(L, 1);
    } else {
        if (lua_istable(L, -2)) lua_pop(L, 1);
        if (!lsn_to_point(L, -1, what, &l->at)) (void)luaL_argerror(L, 1, lua_tostring(L, -1));
        lua_pop(L, 1);
    }
    lua_pop(L, 1);
}

static int by_name(const void *a, const void *b)
{
    const sn_landmark *p = a, *q = b;
    return strcmp(p->name, q->name) < 0;
}

static void read_landmarks(lua_State *L, sn_bone_template *t)
{
    if (!lsn_has(L, 1, "landmarks")) return;
    if (lua_getfield(L, 1, "landmarks") != LUA_TTABLE)
        (void)lsn_option_error(L, 1, "landmarks", "table of NAME = {x, y, z} expected");
    int list = lua_gettop(L);
    int32_t n = 0;
    for (lua_pushnil(L); lua_next(L, list); lua_pop(L, 1)) {
        if (lua_type(L, -2) != LUA_TSTRING)
            (void)lsn_option_error(L, 1, "landmarks", "every landmark needs a name");
        n++;
    }
    t->landmark = SN_NEW_ZERO(sn_landmark, n);
    if (!t->landmark) (void)lsn_fail(L, SN_ENOMEM, "landmarks: no memory for %d", n);
    for (lua_pushnil(L); lua_next(L, list);) {
        sn_landmark *l = &t->landmark[t->n_landmark];
        l->name = sn_strdup(lua_tostring(L, -2));
        if (!l->name) (void)lsn_fail(L, SN_ENOMEM, "landmarks: no memory for %d", n);
        t->n_landmark++;
        read_landmark(L, l);
    }
    lua_pop(L, 1);
    sn_sort(t->landmark, (size_t)n, sizeof *t->landmark, by_name); /* a table has no order */
}

static int bones_add(lua_State *L) /* sinew.bones.add{name=, kind=, mesh=, ...} */
{
    static const char *const keys[] = {"name",  "kind", "mesh", "from",      "to", "length",
                                       "front", "cage", "skin", "landmarks", NULL};
    static const char *const kinds[] = {"cylinder", "curve", "shape", NULL};
    sn_error err;
    luaL_checktype(L, 1, LUA_TTABLE);
    lua_settop(L, 1);
    lsn_check_keys(L, 1, keys);
    for (int i = 0; i < 3; i++)
        if (!lsn_has(L, 1, keys[i])) return lsn_option_error(L, 1, NULL, "option '%s' is missing", keys[i]);
    sn_bone_template *t = lsn_new_object(L, template_type, sizeof *t, 0);
    const char *kind = lsn_opt_string(L, 1, "kind", "");
    while (t->kind < 3 && strcmp(kinds[t->kind], kind) != 0) t->kind++;
    if (t->kind == 3) return lsn_option_error(L, 1, "kind", "%s", lsn_push_known(L, kind, kinds));
    t->name = sn_strdup(lsn_opt_string(L, 1, "name", ""));
    if (!t->name) return lsn_fail(L, SN_ENOMEM, "bone template: no memory");
    copy_surface(L, "mesh", &t->bone);
    copy_surface(L, "cage", &t->cage);
    copy_surface(L, "skin", &t->skin);
    read_landmarks(L, t);
    t->length = lsn_opt_positive(L, 1, "length", 0.0);
    bool has_axis = t->kind == SN_BONE_CYLINDER || (t->kind == SN_BONE_CURVE && lsn_has(L, 1, "from"));
    sn_vec3 from = lsn_opt_point(L, 1, "from", sn_v3(0, 0, 0), has_axis);
    sn_vec3 to = lsn_opt_point(L, 1, "to", from, has_axis);
    sn_vec3 front = lsn_opt_point(L, 1, "front", sn_v3(0, 0, 1), false);
    t->from = from;
    t->to = to;
    if (t->kind == SN_BONE_CURVE && has_axis && sn_bone_template_align(t, from, to, front, &err))
        return lsn_raise(L, &err);
    if (sn_bone_library_add(lsn_bone_library(L), t, &err)) return lsn_raise(L, &err);
    return 0;
}

void lsn_open_bones(lua_State *L)
{
    static const luaL_Reg library_meta[] = {{"__gc", library_gc}, {NULL, NULL}};
    static const luaL_Reg template_meta[] = {{"__gc", template_gc}, {NULL, NULL}}, none[] = {{NULL, NULL}};
    static const luaL_Reg functions[] = {
        {"list", bones_list}, {"surface", bones_surface}, {"add", bones_add}, {NULL, NULL}};
    lsn_new_type(L, library_type, library_meta, none);
    lsn_new_type(L, template_type, template_meta, none);
    luaL_newlib(L, functions);
    lua_setfield(L, -2, "bones");
}
