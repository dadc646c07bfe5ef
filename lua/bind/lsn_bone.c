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

static int bone_tostring(lua_State *L)
{
    lua_pushfstring(L, "bone '%s'", (const char *)luaL_checkudata(L, 1, LSN_BONE));
    return 1;
}

void lsn_open_bone(lua_State *L)
{
    static const luaL_Reg meta[] = {{"__eq", lsn_member_eq}, {"__tostring", bone_tostring}, {NULL, NULL}};
    static const luaL_Reg methods[] = {{"name", bone_name}, {"surface", bone_surface}, {NULL, NULL}};
    lsn_new_type(L, LSN_BONE, meta, methods);
}
