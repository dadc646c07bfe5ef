/* lsn_tets.c - tet meshes of anybody's making, to be cut by sinew.extract. */
#include "lsn.h"

#include "mesh/tet_io.h"

sn_tet_mesh *lsn_push_tets(lua_State *L)
{
    return lsn_new_object(L, LSN_TETS, sizeof(sn_tet_mesh), 0);
}

const sn_tet_mesh *lsn_check_tets(lua_State *L, int arg)
{
    const sn_tet_mesh *m = luaL_checkudata(L, arg, LSN_TETS);
    luaL_argcheck(L, m->tet != NULL, arg, "tets were closed");
    return m;
}

static int tets_gc(lua_State *L)
{
    sn_tet_mesh_free(luaL_checkudata(L, 1, LSN_TETS));
    return 0;
}

static int tets_tostring(lua_State *L)
{
    const sn_tet_mesh *m = luaL_checkudata(L, 1, LSN_TETS);
    if (m->tet)
        lua_pushfstring(L, "tets: %d vertices, %d tets", m->n_vert, m->n_tet);
    else
        lua_pushliteral(L, "tets (was closed)");
    return 1;
}

static int tets_load(lua_State *L) /* sinew.tets.load(path) -> tets | nil, message */
{
    const char *path = lsn_check_text(L, 1);
    sn_tet_mesh *m = lsn_push_tets(L);
    sn_error err;
    if (sn_tet_mesh_load(m, path, &err)) return lsn_nil_error(L, &err);
    lsn_account(L, 24 * (size_t)m->n_vert + 20 * (size_t)m->n_tet);
    return 1;
}

static int tets_save(lua_State *L) /* t:save(path) -> true | nil, message */
{
    const sn_tet_mesh *m = lsn_check_tets(L, 1);
    const char *path = lsn_check_text(L, 2);
    sn_error err;
    return lsn_saved(L, sn_tet_mesh_save(m, NULL, path, &err), &err);
}

static int tets_vertex_count(lua_State *L)
{
    lua_pushinteger(L, lsn_check_tets(L, 1)->n_vert);
    return 1;
}

static int tets_tet_count(lua_State *L)
{
    lua_pushinteger(L, lsn_check_tets(L, 1)->n_tet);
    return 1;
}

static int tets_vertex(lua_State *L)
{
    const sn_tet_mesh *m = lsn_check_tets(L, 1);
    lsn_push_point(L, sn_tet_mesh_point(m, lsn_check_index(L, 2, m->n_vert)));
    return 1;
}

static int tets_tet(lua_State *L) /* t:tet(i) -> {a, b, c, d} */
{
    const sn_tet_mesh *m = lsn_check_tets(L, 1);
    const int32_t *v = m->tet + 4 * (size_t)lsn_check_index(L, 2, m->n_tet);
    lua_createtable(L, 4, 0);
    for (int k = 0; k < 4; k++) {
        lua_pushinteger(L, v[k] + 1);
        lua_rawseti(L, -2, k + 1);
    }
    return 1;
}

static int tets_volume(lua_State *L)
{
    lua_pushnumber(L, sn_tet_mesh_volume(lsn_check_tets(L, 1)));
    return 1;
}

static int tets_bounds(lua_State *L)
{
    lsn_push_box(L, sn_tet_mesh_bounds(lsn_check_tets(L, 1)));
    return 1;
}

void lsn_open_tets(lua_State *L)
{
    static const luaL_Reg meta[] = {
        {"__gc", tets_gc}, {"__close", tets_gc}, {"__tostring", tets_tostring}, {NULL, NULL}};
    static const luaL_Reg methods[] = {{"vertex_count", tets_vertex_count},
                                       {"tet_count", tets_tet_count},
                                       {"vertex", tets_vertex},
                                       {"tet", tets_tet},
                                       {"volume", tets_volume},
                                       {"bounds", tets_bounds},
                                       {"save", tets_save},
                                       {"close", tets_gc},
                                       {NULL, NULL}};
    static const luaL_Reg functions[] = {{"load", tets_load}, {NULL, NULL}};
    lsn_new_type(L, LSN_TETS, meta, methods);
    luaL_newlib(L, functions);
    lua_setfield(L, -2, "tets");
}
