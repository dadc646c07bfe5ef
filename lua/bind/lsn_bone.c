/* lsn_bone.c - bones of a scene. */
#include "lsn.h"

static int32_t find(lua_State *L, sn_scene **s)
{
    const char *name;
    int32_t i = 0;
    sn_error err;
    *s = lsn_check_member(L, 1, LSN_BONE, &name);
    sn_status st = sn_scene_find_bone(*s, name, &i, &err);
    if (st == SN_EINVAL) (void)lsn_fail(L, SN_EINVAL, "bone '%s' was removed", name);
    if (st) (void)lsn_raise(L, &err);
    return i;
}

int lsn_scene_add_bone(lua_State *L) /* scene:add_bone(name, surface) -> bone */
{
    sn_scene *s = lsn_check_scene(L, 1);
    const char *name = lsn_check_text(L, 2);
    const sn_tri_mesh *mesh = lsn_check_surface(L, 3);
    sn_error err;
    lsn_scene_must(L, s, sn_scene_add_bone(s, name, mesh, &err), &err);
    lsn_push_member(L, LSN_BONE, 1, name);
    return 1;
}

int lsn_scene_bone(lua_State *L)
{
    sn_scene *s = lsn_check_scene(L, 1);
    const char *name = lsn_check_text(L, 2);
    int32_t i;
    sn_error err;
    if (sn_scene_find_bone(s, name, &i, &err)) return lsn_raise(L, &err);
    lsn_push_member(L, LSN_BONE, 1, name);
    return 1;
}

int lsn_scene_bones(lua_State *L) /* in the order added */
{
    const sn_scene *s = lsn_check_scene(L, 1);
    int32_t n = sn_scene_bone_count(s);
    lua_createtable(L, n, 0);
    for (int32_t i = 0; i < n; i++) {
        lsn_push_member(L, LSN_BONE, 1, sn_scene_bone_name(s, i));
        lua_rawseti(L, -2, i + 1);
    }
    return 1;
}

int lsn_scene_remove_bone(lua_State *L) /* by name or bone */
{
    sn_scene *s = lsn_check_scene(L, 1);
    sn_error err;
    lsn_scene_must(L, s, sn_scene_remove_bone(s, lsn_check_name(L, 2, LSN_BONE), &err), &err);
    return 0;
}

static int bone_name(lua_State *L)
{
    sn_scene *s;
    int32_t i = find(L, &s);
    lua_pushstring(L, sn_scene_bone_name(s, i));
    return 1;
}

static int bone_surface(lua_State *L) /* a copy */
{
    sn_scene *s;
    int32_t i = find(L, &s);
    sn_error err;
    if (sn_tri_mesh_copy(lsn_push_surface(L), sn_scene_bone_mesh(s, i), &err)) return lsn_raise(L, &err);
    return 1;
}

/* ---- editing ---- */

static void map_bone(lua_State *L, sn_scene *s, int32_t i, const sn_affine *map)
{
    sn_error err;
    lsn_scene_must(L, s, sn_scene_map_bone(s, i, map, &err), &err);
}

static int bone_move(lua_State *L) /* bone:move(v) -> bone */
{
    sn_scene *s;
    int32_t i = find(L, &s);
    sn_affine map = sn_affine_translation(lsn_check_point(L, 2, "v"));
    map_bone(L, s, i, &map);
    lua_settop(L, 1);
    return 1;
}

static int bone_rotate(lua_State *L) /* bone:rotate{axis=, degrees=, about=} -> bone */
{
    static const char *const keys[] = {"axis", "degrees", "about", NULL};
    sn_scene *s;
    int32_t i = find(L, &s);
    lua_settop(L, 2);
    luaL_checktype(L, 2, LUA_TTABLE);
    lsn_check_keys(L, 2, keys);
    sn_vec3 axis;
    double degrees;
    lsn_read_turn(L, 2, &axis, &degrees);
    sn_affine map =
        sn_affine_rotation(axis, degrees, lsn_opt_point(L, 2, "about", sn_scene_bone_centre(s, i), false));
    map_bone(L, s, i, &map);
    lua_settop(L, 1);
    return 1;
}

static int bone_scale(lua_State *L) /* bone:scale(k [, {about=}]) -> bone */
{
    static const char *const keys[] = {"about", NULL};
    sn_scene *s;
    int32_t i = find(L, &s);
    double k = lsn_check_finite(L, 2);
    luaL_argcheck(L, k > 0.0, 2, "a factor > 0 expected");
    lua_settop(L, 3);
    lsn_check_keys(L, 3, keys);
    sn_affine map = sn_affine_scale(k, lsn_opt_point(L, 3, "about", sn_scene_bone_centre(s, i), false));
    map_bone(L, s, i, &map);
    lua_settop(L, 1);
    return 1;
}

/* ---- ends and landmarks ---- */

static int bone_ends(lua_State *L) /* bone:ends() -> from, to, or nil */
{
    sn_scene *s;
    int32_t i = find(L, &s);
    sn_vec3 from, to;
    if (!sn_scene_bone_ends(s, i, &from, &to)) {
        lua_pushnil(L);
        return 1;
    }
    lsn_push_point(L, from);
    lsn_push_point(L, to);
    return 2;
}

static int bone_set_ends(lua_State *L) /* bone:set_ends(from, to [, {thickness=}]) -> bone */
{
    static const char *const keys[] = {"thickness", NULL};
    sn_scene *s;
    int32_t i = find(L, &s);
    sn_error err;
    sn_vec3 from = lsn_check_point(L, 2, "from"), to = lsn_check_point(L, 3, "to");
    lua_settop(L, 4);
    lsn_check_keys(L, 4, keys);
    double thickness = lsn_opt_positive(L, 4, "thickness", 1.0);
    lsn_scene_must(L, s, sn_scene_set_bone_ends(s, i, from, to, thickness, &err), &err);
    lua_settop(L, 1);
    return 1;
}

static int bone_landmark(lua_State *L) /* bone:landmark(name) -> point, radius */
{
    sn_scene *s;
    int32_t i = find(L, &s);
    sn_landmark l;
    sn_error err;
    if (sn_scene_bone_landmark(s, i, lsn_check_text(L, 2), &l, &err)) return lsn_raise(L, &err);
    lsn_push_point(L, l.at);
    lua_pushnumber(L, l.radius);
    return 2;
}

static int bone_landmarks(lua_State *L) /* bone:landmarks() -> list of {name=, point=, radius=} */
{
    sn_scene *s;
    int32_t n, i = find(L, &s);
    const sn_landmark *l = sn_scene_bone_landmarks(s, i, &n);
    lua_createtable(L, n, 0);
    for (int32_t k = 0; k < n; k++) {
        lua_createtable(L, 0, 3);
        lua_pushstring(L, l[k].name);
        lua_setfield(L, -2, "name");
        lsn_set_point(L, "point", l[k].at);
        lsn_set_number(L, "radius", l[k].radius);
        lua_rawseti(L, -2, k + 1);
    }
    return 1;
}

static int bone_set_landmark(lua_State *L) /* bone:set_landmark(name, point [, radius]) -> bone */
{
    sn_scene *s;
    int32_t i = find(L, &s);
    sn_error err;
    sn_vec3 at = lsn_check_point(L, 3, "point");
    double radius = lua_isnoneornil(L, 4) ? 0.0 : lsn_check_finite(L, 4);
    lsn_scene_must(L, s, sn_scene_set_landmark(s, i, lsn_check_text(L, 2), at, radius, &err), &err);
    lua_settop(L, 1);
    return 1;
}

/* ---- distance from the skin ---- */

static int bone_clearance(lua_State *L) /* bone:clearance{margin=} -> {least=, at=, outside=, near=} */
{
    static const char *const keys[] = {"margin", NULL};
    sn_scene *s;
    int32_t i = find(L, &s);
    sn_clearance c;
    sn_error err;
    lua_settop(L, 2);
    lsn_check_keys(L, 2, keys);
    double margin = lsn_opt_positive(L, 2, "margin", 0.0);
    if (sn_scene_bone_clearance(s, i, margin, &lsn_get_state(L)->run, &c, &err)) return lsn_raise(L, &err);
    lsn_push_clearance(L, &c);
    return 1;
}

static int bone_keep_clear(lua_State *L) /* bone:keep_clear{margin=} -> report */
{
    static const char *const keys[] = {"margin", NULL};
    sn_scene *s;
    int32_t i = find(L, &s);
    sn_clearance_report r = {0};
    sn_error err;
    lua_settop(L, 2);
    lsn_check_keys(L, 2, keys);
    if (!lsn_has(L, 2, "margin")) return lsn_option_error(L, 2, NULL, "option 'margin' is missing");
    double margin = lsn_opt_positive(L, 2, "margin", 0.0);
    lsn_scene_must(L, s, sn_scene_keep_bone_clear(s, i, margin, &lsn_get_state(L)->run, &r, &err), &err);
    lsn_push_clearance_report(L, &r);
    return 1;
}

static int bone_tostring(lua_State *L)
{
    lua_pushfstring(L, "bone '%s'", (const char *)luaL_checkudata(L, 1, LSN_BONE));
    return 1;
}

void lsn_open_bone(lua_State *L)
{
    static const luaL_Reg meta[] = {{"__eq", lsn_member_eq}, {"__tostring", bone_tostring}, {NULL, NULL}};
    static const luaL_Reg methods[] = {{"name", bone_name},
                                       {"surface", bone_surface},
                                       {"move", bone_move},
                                       {"rotate", bone_rotate},
                                       {"scale", bone_scale},
                                       {"ends", bone_ends},
                                       {"set_ends", bone_set_ends},
                                       {"landmark", bone_landmark},
                                       {"landmarks", bone_landmarks},
                                       {"set_landmark", bone_set_landmark},
                                       {"clearance", bone_clearance},
                                       {"keep_clear", bone_keep_clear},
                                       {NULL, NULL}};
    lsn_new_type(L, LSN_BONE, meta, methods);
}
