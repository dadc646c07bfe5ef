/* lsn_surface.c - triangle surfaces. */
#include "lsn.h"

#include "base/alloc.h"
#include "mesh/bvh.h"
#include "mesh/mesh_check.h"
#include "mesh/surface_io.h"
#include "mesh/tri_cut.h"

typedef struct surface {
    sn_tri_mesh mesh;
    sn_bvh *bvh; /* made by the first query, NULL after a change */
} surface;

static size_t mesh_bytes(const sn_tri_mesh *m)
{
    return 24 * (size_t)m->n_vert + 12 * (size_t)m->n_face;
}

static surface *check_surface(lua_State *L, int arg)
{
    surface *s = luaL_checkudata(L, arg, LSN_SURFACE);
    luaL_argcheck(L, s->mesh.face != NULL, arg, "surface was closed");
    return s;
}

const sn_tri_mesh *lsn_check_surface(lua_State *L, int arg)
{
    return &check_surface(L, arg)->mesh;
}

sn_tri_mesh *lsn_push_surface(lua_State *L)
{
    surface *s = lsn_new_object(L, LSN_SURFACE, sizeof *s, 0);
    return &s->mesh;
}

static int surface_gc(lua_State *L)
{
    surface *s = luaL_checkudata(L, 1, LSN_SURFACE);
    sn_tri_mesh_free(&s->mesh);
    sn_bvh_destroy(s->bvh);
    s->bvh = NULL;
    return 0;
}

static int surface_tostring(lua_State *L)
{
    const surface *s = luaL_checkudata(L, 1, LSN_SURFACE);
    if (s->mesh.face)
        lua_pushfstring(L, "surface: %d vertices, %d faces", s->mesh.n_vert, s->mesh.n_face);
    else
        lua_pushliteral(L, "surface (was closed)");
    return 1;
}

/* ---- making, files ---- */

static int surface_load(lua_State *L) /* sinew.surface.load(path) -> surface | nil, message */
{
    const char *path = lsn_check_text(L, 1);
    sn_tri_mesh *m = lsn_push_surface(L);
    sn_error err;
    if (sn_surface_load(m, path, &err)) return lsn_nil_error(L, &err);
    lsn_account(L, mesh_bytes(m));
    return 1;
}

static int surface_save(lua_State *L) /* s:save(path [, {ascii=}]) -> true | nil, message */
{
    static const char *const keys[] = {"ascii", NULL};
    const sn_tri_mesh *m = lsn_check_surface(L, 1);
    const char *path = lsn_check_text(L, 2);
    lsn_check_keys(L, 3, keys);
    bool ascii = lsn_opt_bool(L, 3, "ascii", false);
    sn_error err;
    sn_status st = ascii ? sn_surface_save_ascii(m, path, &err) : sn_surface_save(m, path, &err);
    return lsn_saved(L, st, &err);
}

static void read_vertex(lua_State *L, int32_t i, double *out)
{
    sn_vec3 p;
    (void)lua_geti(L, 1, i + 1);
    lua_pushfstring(L, "vertices[%d]", i + 1);
    if (!lsn_to_point(L, -2, lua_tostring(L, -1), &p)) (void)luaL_argerror(L, 1, lua_tostring(L, -1));
    sn_v3_store(out, p);
    lua_pop(L, 2);
}

static void read_face(lua_State *L, int32_t i, int32_t n_vert, int32_t *out)
{
    int type = lua_geti(L, 2, i + 1), is_whole;
    if (type != LUA_TTABLE && !luaL_testudata(L, -1, LSN_VEC3))
        (void)luaL_argerror(
            L, 2, lua_pushfstring(L, "faces[%d]: {a, b, c} expected, got %s", i + 1, lua_typename(L, type)));
    if (luaL_len(L, -1) != 3)
        (void)luaL_argerror(
            L, 2, lua_pushfstring(L, "faces[%d]: 3 corners expected, got %d", i + 1, (int)luaL_len(L, -1)));
    for (int k = 0; k < 3; k++) {
        type = lua_geti(L, -1, k + 1);
        lua_Integer v = type == LUA_TNUMBER ? lua_tointegerx(L, -1, &is_whole) : 0;
        if (type != LUA_TNUMBER || !is_whole || v < 1 || v > n_vert)
            (void)luaL_argerror(L, 2,
                                lua_pushfstring(L, "faces[%d]: corner %d is %s, need a vertex index in 1..%d",
                                                i + 1, k + 1, luaL_tolstring(L, -1, NULL), n_vert));
        out[k] = (int32_t)(v - 1);
        lua_pop(L, 1);
    }
    lua_pop(L, 1);
}

static int surface_new(lua_State *L) /* sinew.surface.new(vertices, faces) */
{
    int32_t n_vert = lsn_check_list(L, 1, 1, "vertices"), n_face = lsn_check_list(L, 2, 2, "faces");
    luaL_argcheck(L, n_face > 0, 2, "faces: the list is empty");
    lua_settop(L, 2);
    sn_tri_mesh *m = lsn_push_surface(L);
    sn_error err;
    if (sn_tri_mesh_reserve(m, n_vert, n_face, &err)) return lsn_raise(L, &err);
    for (int32_t i = 0; i < n_vert; i++) read_vertex(L, i, m->pos + 3 * (size_t)i);
    for (int32_t i = 0; i < n_face; i++) read_face(L, i, n_vert, m->face + 3 * (size_t)i);
    lsn_account(L, mesh_bytes(m));
    return 1;
}

static int surface_copy(lua_State *L)
{
    const sn_tri_mesh *m = lsn_check_surface(L, 1);
    sn_tri_mesh *out = lsn_push_surface(L);
    sn_error err;
    if (sn_tri_mesh_copy(out, m, &err)) return lsn_raise(L, &err);
    lsn_account(L, mesh_bytes(out));
    return 1;
}

/* ---- figures ---- */

static int surface_vertex_count(lua_State *L)
{
    lua_pushinteger(L, lsn_check_surface(L, 1)->n_vert);
    return 1;
}

static int surface_face_count(lua_State *L)
{
    lua_pushinteger(L, lsn_check_surface(L, 1)->n_face);
    return 1;
}

static int surface_vertex(lua_State *L)
{
    const sn_tri_mesh *m = lsn_check_surface(L, 1);
    lsn_push_point(L, sn_tri_mesh_point(m, lsn_check_index(L, 2, m->n_vert)));
    return 1;
}

static int surface_face(lua_State *L)
{
    const sn_tri_mesh *m = lsn_check_surface(L, 1);
    const int32_t *v = m->face + 3 * (size_t)lsn_check_index(L, 2, m->n_face);
    lua_createtable(L, 3, 0);
    for (int k = 0; k < 3; k++) {
        lua_pushinteger(L, v[k] + 1);
        lua_rawseti(L, -2, k + 1);
    }
    return 1;
}

static int surface_bounds(lua_State *L)
{
    lsn_push_box(L, sn_tri_mesh_bounds(lsn_check_surface(L, 1)));
    return 1;
}

static int surface_area(lua_State *L)
{
    lua_pushnumber(L, sn_tri_mesh_area(lsn_check_surface(L, 1)));
    return 1;
}

static int surface_volume(lua_State *L)
{
    lua_pushnumber(L, sn_tri_mesh_volume(lsn_check_surface(L, 1)));
    return 1;
}

void lsn_push_check(lua_State *L, const sn_mesh_check *check)
{
    const sn_mesh_check c = *check;
    lua_createtable(L, 0, 13);
    lsn_set_bool(L, "closed", c.closed);
    lsn_set_bool(L, "manifold", c.manifold);
    lsn_set_bool(L, "oriented", c.oriented);
    lsn_set_integer(L, "components", c.components);
    lsn_set_integer(L, "boundary_edges", c.boundary_edges);
    lsn_set_integer(L, "nonmanifold_edges", c.nonmanifold_edges);
    lsn_set_integer(L, "nonmanifold_vertices", c.nonmanifold_vertices);
    lsn_set_integer(L, "degenerate_faces", c.degenerate_faces);
    lsn_set_integer(L, "duplicate_vertices", c.duplicate_vertices);
    lsn_set_integer(L, "duplicate_faces", c.duplicate_faces);
    lsn_set_integer(L, "unused_vertices", c.unused_vertices);
    lsn_set_integer(L, "self_intersections", c.self_intersections);
    if (c.self_intersections > 0) {
        lua_createtable(L, 2, 0);
        for (int k = 0; k < 2; k++) {
            lua_pushinteger(L, c.first_pair[k] + 1);
            lua_rawseti(L, -2, k + 1);
        }
        lua_setfield(L, -2, "first_pair");
    }
}

static int surface_check(lua_State *L)
{
    sn_mesh_check c;
    sn_error err;
    if (sn_mesh_check_run(&c, lsn_check_surface(L, 1), &lsn_get_state(L)->run, &err))
        return lsn_raise(L, &err);
    lsn_push_check(L, &c);
    return 1;
}

/* ---- changes: of the surface itself, all or nothing ---- */

/* Takes the mesh of the surface on top of the stack, a changed copy of s, when its coordinates are still
 * finite. */
static int adopt(lua_State *L, surface *s, sn_status st, sn_error *err)
{
    surface *changed = lua_touserdata(L, -1);
    if (!st) st = sn_tri_mesh_validate(&changed->mesh, err);
    if (st) return lsn_raise(L, err);
    sn_tri_mesh_free(&s->mesh);
    s->mesh = changed->mesh;
    sn_tri_mesh_init(&changed->mesh);
    sn_bvh_destroy(s->bvh);
    s->bvh = NULL;
    lua_settop(L, 1);
    return 1;
}

static sn_tri_mesh *push_copy(lua_State *L, const surface *s)
{
    sn_error err;
    sn_tri_mesh *m = lsn_push_surface(L);
    if (sn_tri_mesh_copy(m, &s->mesh, &err)) (void)lsn_raise(L, &err);
    return m;
}

static int surface_transform(
    lua_State *L) /* s:transform{scale=, rotate={axis=, degrees=}, translate=} -> s */
{
    static const char *const keys[] = {"scale", "rotate", "translate", NULL};
    surface *s = check_surface(L, 1);
    sn_transform t = {.scale = 1.0};
    sn_error err;
    lsn_check_keys(L, 2, keys);
    t.scale = lsn_opt_positive(L, 2, "scale", 1.0);
    t.translate = lsn_opt_point(L, 2, "translate", t.translate, false);
    (void)lsn_opt_turn(L, 2, &t.axis, &t.angle_deg);
    sn_tri_mesh *m = push_copy(L, s);
    return adopt(L, s, sn_tri_mesh_transform(m, &t, &err), &err);
}

static int surface_mirror(lua_State *L) /* s:mirror{point=, normal=} -> s */
{
    surface *s = check_surface(L, 1);
    sn_error err;
    sn_vec3 point, normal;
    lsn_read_plane(L, 2, &point, &normal);
    sn_tri_mesh *m = push_copy(L, s);
    return adopt(L, s, sn_tri_mesh_mirror(m, point, normal, &err), &err);
}

/* ---- a part of it ---- */

static int surface_cut(lua_State *L) /* s:cut{point=, normal=} -> surface */
{
    const sn_tri_mesh *m = lsn_check_surface(L, 1);
    sn_error err;
    sn_vec3 point, normal;
    lsn_read_plane(L, 2, &point, &normal);
    sn_tri_mesh *out = lsn_push_surface(L);
    if (sn_tri_mesh_cut(m, point, normal, 0, &lsn_get_state(L)->run, out, NULL, &err))
        return lsn_raise(L, &err);
    lsn_account(L, mesh_bytes(out));
    return 1;
}

/* ---- queries ---- */

static const sn_bvh *bvh_of(lua_State *L, surface *s)
{
    sn_error err;
    if (!s->bvh && sn_bvh_create(&s->bvh, &s->mesh, &err)) (void)lsn_raise(L, &err);
    return s->bvh;
}

static void push_hit(lua_State *L, const sn_ray_hit *hit, double length)
{
    lua_createtable(L, 0, 4);
    lsn_set_number(L, "distance", hit->t * length);
    lsn_set_point(L, "point", hit->point);
    lsn_set_integer(L, "face", hit->face + 1);
    lsn_set_bool(L, "entering", hit->entering);
}

static int surface_raycast(lua_State *L) /* s:raycast(origin, direction) -> list of hits */
{
    surface *s = check_surface(L, 1);
    sn_vec3 origin = lsn_check_point(L, 2, "origin"), dir = lsn_check_point(L, 3, "direction");
    double length = hypot(hypot(dir.x, dir.y), dir.z); /* no overflow, no underflow */
    luaL_argcheck(L, length > 0.0, 3, "direction: has no length");
    const sn_bvh *b = bvh_of(L, s);
    void **box = lsn_push_owner(L);
    sn_ray_hit *hit = NULL;
    size_t n = 0;
    sn_error err;
    sn_status st = sn_bvh_ray_all(b, origin, dir, INFINITY, &hit, &n, &err);
    *box = hit;
    if (st) return lsn_raise(L, &err);
    lua_createtable(L, (int)n, 0);
    for (size_t i = 0; i < n; i++) {
        push_hit(L, &hit[i], length);
        lua_rawseti(L, -2, (lua_Integer)i + 1);
    }
    lsn_empty_owner(box);
    return 1;
}

static int surface_closest(lua_State *L) /* s:closest(p) -> {point=, distance=, face=} */
{
    surface *s = check_surface(L, 1);
    sn_vec3 p = lsn_check_point(L, 2, "point");
    sn_closest c = sn_bvh_closest(bvh_of(L, s), p);
    lua_createtable(L, 0, 3);
    lsn_set_point(L, "point", c.point);
    lsn_set_number(L, "distance", c.dist);
    lsn_set_integer(L, "face", c.face + 1);
    return 1;
}

static int surface_contains(lua_State *L)
{
    surface *s = check_surface(L, 1);
    sn_vec3 p = lsn_check_point(L, 2, "point");
    lua_pushboolean(L, sn_bvh_contains(bvh_of(L, s), p));
    return 1;
}

void lsn_open_surface(lua_State *L)
{
    static const luaL_Reg meta[] = {
        {"__gc", surface_gc}, {"__close", surface_gc}, {"__tostring", surface_tostring}, {NULL, NULL}};
    static const luaL_Reg methods[] = {{"save", surface_save},
                                       {"copy", surface_copy},
                                       {"close", surface_gc},
                                       {"vertex_count", surface_vertex_count},
                                       {"face_count", surface_face_count},
                                       {"vertex", surface_vertex},
                                       {"face", surface_face},
                                       {"bounds", surface_bounds},
                                       {"area", surface_area},
                                       {"volume", surface_volume},
                                       {"check", surface_check},
                                       {"repair", lsn_surface_repair},
                                       {"transform", surface_transform},
                                       {"mirror", surface_mirror},
                                       {"cut", surface_cut},
                                       {"raycast", surface_raycast},
                                       {"closest", surface_closest},
                                       {"contains", surface_contains},
                                       {NULL, NULL}};
    static const luaL_Reg functions[] = {{"load", surface_load}, {"new", surface_new}, {NULL, NULL}};
    lsn_new_type(L, LSN_SURFACE, meta, methods);
    luaL_newlib(L, functions);
    lua_setfield(L, -2, "surface");
}
