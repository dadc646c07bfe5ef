/* lsn_member.c - handles of bones and muscles: a name, and the scene as user value, which they keep alive.
 * The index is looked up at each call, so a handle survives every edit but the removal of its object. */
#include "lsn.h"

#include <stdio.h>
#include <string.h>

typedef struct member {
    char name[72]; /* the scene takes names of up to 64 bytes */
} member;

void lsn_push_member(lua_State *L, const char *type, int scene, const char *name)
{
    scene = lua_absindex(L, scene);
    member *m = lsn_new_object(L, type, sizeof *m, 1);
    (void)snprintf(m->name, sizeof m->name, "%s", name);
    lua_pushvalue(L, scene);
    (void)lua_setiuservalue(L, -2, 1);
}

sn_scene *lsn_check_member(lua_State *L, int arg, const char *type, const char **name)
{
    const member *m = luaL_checkudata(L, arg, type);
    *name = m->name;
    (void)lua_getiuservalue(L, arg, 1);
    sn_scene *const *s = luaL_testudata(L, -1, LSN_SCENE);
    lua_pop(L, 1);
    if (!s || !*s) (void)luaL_error(L, "%s '%s': its scene was closed", type + strlen("sinew."), m->name);
    return *s;
}

int lsn_member_eq(lua_State *L)
{
    const member *a = lua_touserdata(L, 1), *b = lua_touserdata(L, 2);
    bool equal = a && b && lua_getmetatable(L, 1) && lua_getmetatable(L, 2) && lua_rawequal(L, -1, -2);
    if (equal) {
        (void)lua_getiuservalue(L, 1, 1);
        (void)lua_getiuservalue(L, 2, 1);
        equal = lua_rawequal(L, -1, -2) && strcmp(a->name, b->name) == 0;
    }
    lua_pushboolean(L, equal);
    return 1;
}

const char *lsn_check_name(lua_State *L, int arg, const char *type)
{
    const member *m = luaL_testudata(L, arg, type);
    return m ? m->name : lsn_check_text(L, arg);
}
