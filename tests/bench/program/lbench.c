#include "lbench.h"

#include "bind/lsn.h"
#include "eigen_bridge.h"
#include "process.h"
#include "render/context.h"
#include "system.h"
#include "usual.h"

#include <lauxlib.h>
#include <stdio.h>
#include <string.h>

#define SYSTEMS "sinew.systems"

extern char *openblas_get_config(void);

typedef struct systems { /* its user value keeps the scene alive */
    bench_system system;
    bench_usual usual;
    const sn_scene *scene;
} systems;

static systems *check_systems(lua_State *L)
{
    return luaL_checkudata(L, 1, SYSTEMS);
}

static void update(lua_State *L, systems *s)
{
    sn_error err;
    if (!bench_system_make(&s->system, s->scene, &lsn_get_state(L)->run, &err)) return;
    bench_system_free(&s->system);
    bench_usual_free(&s->usual);
    (void)lsn_raise(L, &err);
}

static int systems_new(lua_State *L)
{
    const sn_scene *scene = lsn_check_scene(L, 1);
    systems *s = lsn_new_object(L, SYSTEMS, sizeof *s, 1);
    lua_pushvalue(L, 1);
    (void)lua_setiuservalue(L, -2, 1);
    s->scene = scene;
    update(L, s);
    return 1;
}

static int systems_update(lua_State *L)
{
    update(L, check_systems(L));
    return 0;
}

static int systems_size(lua_State *L)
{
    const bench_system *s = &check_systems(L)->system;
    lua_newtable(L);
    lsn_set_integer(L, "unknowns", s->n);
    lsn_set_integer(L, "right_hand_sides", s->n_rhs);
    lsn_set_integer(L, "collocation_points", s->n_row);
    lsn_set_integer(L, "entries", s->ptr ? s->ptr[s->n] : 0);
    return 1;
}

static void push_times(lua_State *L, const bench_times *t)
{
    lua_newtable(L);
    lsn_set_number(L, "analysis", t->analysis);
    lsn_set_number(L, "factor", t->factor);
    lsn_set_number(L, "solve", t->solve);
    lsn_set_integer(L, "entries", t->entries);
}

static int systems_cholmod(lua_State *L)
{
    systems *s = check_systems(L);
    lua_Integer n_threads = luaL_checkinteger(L, 2);
    luaL_argcheck(L, n_threads >= 0 && n_threads <= 1024, 2,
                  "0 (as the libraries choose) to 1024 threads expected");
    bench_times times;
    sn_error err;
    if (bench_usual_solve(&s->usual, &s->system, (int)n_threads, &times, &err)) return lsn_raise(L, &err);
    push_times(L, &times);
    return 1;
}

static int systems_eigen(lua_State *L)
{
    static const char *const names[] = {"ldlt", "cholmod", NULL};
    bench_system *s = &check_systems(L)->system;
    bench_eigen kind = luaL_checkoption(L, 2, NULL, names) == 0 ? BENCH_EIGEN_LDLT : BENCH_EIGEN_CHOLMOD;
    bench_times times = {0};
    bench_use_threads(0);
    int failed = bench_eigen_solve(kind, s->n, s->ptr, s->idx, s->val, s->n_rhs, s->rhs, s->x, &times.factor,
                                   &times.solve);
    bench_use_threads(1);
    if (failed) return luaL_error(L, "Eigen cannot factorize %d rows, or memory is short", (int)s->n);
    push_times(L, &times);
    return 1;
}

static int systems_difference(lua_State *L)
{
    const systems *s = check_systems(L);
    double difference;
    sn_error err;
    if (bench_system_compare(&s->system, s->scene, &difference, &err)) return lsn_raise(L, &err);
    lua_pushnumber(L, difference);
    return 1;
}

static int systems_release(lua_State *L)
{
    bench_usual_free(&check_systems(L)->usual);
    return 0;
}

static int systems_gc(lua_State *L)
{
    systems *s = check_systems(L);
    bench_usual_free(&s->usual);
    bench_system_free(&s->system);
    return 0;
}

static int memory_get(lua_State *L)
{
    lua_pushnumber(L, bench_memory_now());
    lua_pushnumber(L, bench_memory_peak());
    return 2;
}

static int memory_reset_peak(lua_State *L)
{
    (void)L;
    bench_reset_peak();
    return 0;
}

static int memory_trim(lua_State *L)
{
    (void)L;
    bench_trim();
    return 0;
}

static void set_string(lua_State *L, const char *key, const char *value)
{
    lua_pushstring(L, value);
    lua_setfield(L, -2, key);
}

static void set_renderer(lua_State *L)
{
    sn_context *c = NULL;
    sn_error err;
    sn_status st = sn_context_create(&c, lsn_get_state(L)->renderer, &err);
    set_string(L, "renderer", st ? err.msg : sn_context_renderer(c));
    sn_context_destroy(c);
}

static int machine_get(lua_State *L)
{
    char text[256];
    int version[3];
    lua_newtable(L);
    bench_cpu(text, sizeof text);
    set_string(L, "cpu", text);
    lsn_set_integer(L, "cores", bench_cores());
    lsn_set_number(L, "memory", bench_memory_total());
    (void)cholmod_l_version(version);
    (void)snprintf(text, sizeof text, "%d.%d.%d", version[0], version[1], version[2]);
    set_string(L, "cholmod", text);
    set_string(L, "openblas", openblas_get_config());
    set_string(L, "eigen", bench_eigen_version());
    set_renderer(L);
    return 1;
}

int luaopen_bench(lua_State *L)
{
    static const luaL_Reg functions[] = {{"systems", systems_new},          {"memory", memory_get},
                                         {"reset_peak", memory_reset_peak}, {"trim", memory_trim},
                                         {"machine", machine_get},          {NULL, NULL}};
    static const luaL_Reg meta[] = {{"__gc", systems_gc}, {NULL, NULL}};
    static const luaL_Reg methods[] = {{"update", systems_update},
                                       {"size", systems_size},
                                       {"cholmod", systems_cholmod},
                                       {"eigen", systems_eigen},
                                       {"difference", systems_difference},
                                       {"release", systems_release},
                                       {NULL, NULL}};
    lsn_new_type(L, SYSTEMS, meta, methods);
    luaL_newlib(L, functions);
    return 1;
}
