#include "outputs.h"

#include "bind/lsn.h"
#include "progress.h"
#include "session.h"

#include <stdio.h>

enum { ARG_SESSION = 1, SCENE, EXTRACTION }; /* stack of cli_write_outputs; EXTRACTION is nil until needed */

/* Calls the method of the object below n_arg arguments; raises the message of nil, message. One result stays.
 */
static void call_method(lua_State *L, const char *name, int n_arg)
{
    lua_getfield(L, -1 - n_arg, name);
    lua_insert(L, -2 - n_arg);
    lua_call(L, n_arg + 1, 2);
    if (!lua_toboolean(L, -2)) {
        if (!lua_isstring(L, -1)) luaL_error(L, "%s gave no result", name);
        lua_error(L);
    }
    lua_pop(L, 1);
}

static void render(lua_State *L, const char *path)
{
    lua_pushvalue(L, SCENE);
    lua_createtable(L, 0, 1);
    lua_pushstring(L, path);
    lua_setfield(L, -2, "file");
    call_method(L, "render", 1);
    lua_pop(L, 1);
}

static void extract(lua_State *L, const char *path)
{
    if (lua_isnil(L, EXTRACTION)) {
        lua_pushvalue(L, SCENE);
        lua_newtable(L);
        call_method(L, "extract", 1);
        lua_replace(L, EXTRACTION);
    }
    lua_pushvalue(L, EXTRACTION);
    lua_pushstring(L, path);
    call_method(L, "save", 1);
    lua_pop(L, 1);
}

int cli_write_outputs(lua_State *L)
{
    cli_session *s = lua_touserdata(L, ARG_SESSION);
    const cli_list *output = &s->opt->output;
    if (output->n == 0) return 0;
    lsn_push_last_scene(L);
    if (lua_isnil(L, SCENE)) return luaL_error(L, "-o %s: the script made no scene", output->item[0]);
    lua_pushnil(L);
    for (; s->n_written < output->n; s->n_written++) {
        const char *path = output->item[s->n_written];
        if (cli_output_kind(path) == CLI_OUTPUT_PICTURE)
            render(L, path);
        else
            extract(L, path);
        cli_progress_erase();
        if (!s->opt->is_quiet) (void)fprintf(stderr, "wrote %s\n", path);
    }
    return 0;
}
