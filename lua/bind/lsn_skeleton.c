/* lsn_skeleton.c - what concerns all bones of a scene: joints, the other side, half models. */
#include "lsn.h"

int lsn_scene_mirror_bones(
    lua_State *L) /* scene:mirror_bones{plane={point=, normal=}} -> {added=, replaced=} */
{
    static const char *const keys[] = {"plane", NULL};
    sn_scene *s = lsn_check_scene(L, 1);
    sn_vec3 point = {0}, normal = {1, 0, 0};
    int32_t n_added, n_replaced;
    sn_error err;
    lua_settop(L, 2);
    lsn_check_keys(L, 2, keys);
    if (lsn_enter(L, 2, "plane")) {
        lsn_read_plane(L, 2, &point, &normal);
        lsn_leave(L, 2);
    } else {
        (void)sn_scene_cut_plane(s, &point, &normal);
        if (!(sn_v3_len2(normal) > 0.0)) normal = sn_v3(1, 0, 0);
    }
    lsn_scene_must(L, s, sn_scene_mirror_bones(s, point, normal, &n_added, &n_replaced, &err), &err);
    lua_createtable(L, 0, 2);
    lsn_set_integer(L, "added", n_added);
    lsn_set_integer(L, "replaced", n_replaced);
    return 1;
}

int lsn_scene_cut(lua_State *L) /* scene:cut{point=, normal=}; scene:cut(nil) makes it whole again */
{
    sn_scene *s = lsn_check_scene(L, 1);
    sn_vec3 point, normal;
    sn_error err;
    if (lua_gettop(L) == 2 && lua_isnil(L, 2)) {
        sn_scene_uncut(s);
        return 0;
    }
    luaL_checktype(L, 2, LUA_TTABLE);
    lua_settop(L, 2);
    lsn_read_plane(L, 2, &point, &normal);
    lsn_scene_must(L, s, sn_scene_cut(s, point, normal, &err), &err);
    return 0;
}

/* ---- joints ---- */

static const char *bone_option(lua_State *L, const char *key)
{
    if (!lsn_has(L, 2, key)) (void)lsn_option_error(L, 2, NULL, "option '%s' is missing", key);
    (void)lua_getfield(L, 2, key); /* stays on the stack: the text lives there */
    const char *name = lsn_check_name(L, lua_gettop(L), LSN_BONE);
    return name;
}

static bool read_axes(lua_State *L, sn_vec3 axis[3])
{
    if (!lsn_has(L, 2, "axes")) return false;
    if (lua_getfield(L, 2, "axes") != LUA_TTABLE || lua_rawlen(L, -1) != 3)
        (void)lsn_option_error(L, 2, "axes", "a list of three vectors expected");
    for (int k = 0; k < 3; k++) {
        (void)lua_geti(L, -1, k + 1);
        if (!lsn_to_point(L, -1, "axes", &axis[k])) (void)luaL_argerror(L, 2, lua_tostring(L, -1));
        lua_pop(L, 1);
    }
    lua_pop(L, 1);
    return true;
}

int lsn_scene_add_joint(lua_State *L) /* scene:add_joint{name=, parent=, child=, center=, axes=} */
{
    static const char *const keys[] = {"name", "parent", "child", "center", "axes", NULL};
    sn_scene *s = lsn_check_scene(L, 1);
    sn_vec3 axis[3];
    sn_error err;
    luaL_checktype(L, 2, LUA_TTABLE);
    lua_settop(L, 2);
    lsn_check_keys(L, 2, keys);
    if (!lsn_has(L, 2, "name")) return lsn_option_error(L, 2, NULL, "option 'name' is missing");
    const char *name = lsn_opt_string(L, 2, "name", "");
    const char *parent = bone_option(L, "parent"), *child = bone_option(L, "child");
    sn_vec3 center = lsn_opt_point(L, 2, "center", sn_v3(0, 0, 0), true);
    bool has_axes = read_axes(L, axis);
    lsn_scene_must(L, s, sn_scene_add_joint(s, name, parent, child, center, has_axes ? axis : NULL, &err),
                   &err);
    return 0;
}

int lsn_scene_remove_joint(lua_State *L)
{
    sn_scene *s = lsn_check_scene(L, 1);
    sn_error err;
    lsn_scene_must(L, s, sn_scene_remove_joint(s, lsn_check_text(L, 2), &err), &err);
    return 0;
}

int lsn_scene_joints(lua_State *L) /* scene:joints() -> list of {name=, parent=, child=, center=, axes=} */
{
    const sn_scene *s = lsn_check_scene(L, 1);
    int32_t n = sn_scene_joint_count(s);
    lua_createtable(L, n, 0);
    for (int32_t i = 0; i < n; i++) {
        const sn_joint *j = sn_scene_joint(s, i);
        const char *const text[] = {j->name, j->parent, j->child};
        static const char *const key[] = {"name", "parent", "child"};
        lua_createtable(L, 0, 5);
        for (int k = 0; k < 3; k++) {
            lua_pushstring(L, text[k]);
            lua_setfield(L, -2, key[k]);
        }
        lsn_set_point(L, "center", j->center);
        lua_createtable(L, 3, 0);
        for (int k = 0; k < 3; k++) {
            lsn_push_point(L, j->axis[k]);
            lua_rawseti(L, -2, k + 1);
        }
        lua_setfield(L, -2, "axes");
        lua_rawseti(L, -2, i + 1);
    }
    return 1;
}
