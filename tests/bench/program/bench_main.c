/* bench_main.c - the program `sinew-bench`: runs a script with the modules `sinew` and `bench`.
 *
 *     sinew-bench SCRIPT [ARGUMENTS] */
#include "bind/lsn.h"
#include "lbench.h"

#include <lualib.h>
#include <stdio.h>
#include <stdlib.h>

static int with_traceback(lua_State *L)
{
    luaL_traceback(L, L, lua_tostring(L, 1), 1);
    return 1;
}

static void set_arguments(lua_State *L, int argc, char **argv)
{
    lua_createtable(L, argc, 1);
    for (int i = 0; i < argc; i++) {
        lua_pushstring(L, argv[i]);
        lua_rawseti(L, -2, i - 1);
    }
    lua_setglobal(L, "arg");
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        (void)fprintf(stderr, "sinew-bench SCRIPT [ARGUMENTS]\n");
        return 2;
    }
    lua_State *L = luaL_newstate();
    if (!L) return EXIT_FAILURE;
    luaL_openlibs(L);
    luaL_requiref(L, "sinew", luaopen_sinew, 1);
    luaL_requiref(L, "bench", luaopen_bench, 1);
    set_arguments(L, argc, argv);
    lua_settop(L, 0);
    lua_pushcfunction(L, with_traceback);
    bool ok = luaL_loadfile(L, argv[1]) == LUA_OK && lua_pcall(L, 0, 0, 1) == LUA_OK;
    if (!ok) (void)fprintf(stderr, "sinew-bench: %s\n", lua_tostring(L, -1));
    lua_close(L);
    return ok ? EXIT_SUCCESS : EXIT_FAILURE;
}
