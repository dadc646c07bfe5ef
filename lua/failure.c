#include "failure.h"

#include "base/alloc.h"
#include "bind/lsn.h"
#include "exit_code.h"
#include "progress.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char traceback_key; /* its address is the key in the registry */

void cli_failure_free(cli_failure *f)
{
    sn_release(f->file);
    sn_release(f->text);
    sn_release(f->traceback);
    *f = (cli_failure){0};
}

/* The message handler: leaves the traceback in the registry and makes the error a string. */
static int keep_traceback(lua_State *L)
{
    if (!lua_isstring(L, 1)) {
        if (!luaL_callmeta(L, 1, "__tostring") || lua_type(L, -1) != LUA_TSTRING)
            lua_pushfstring(L, "(error object is a %s value)", luaL_typename(L, 1));
        lua_replace(L, 1);
    }
    (void)lua_tostring(L, 1); /* a number becomes text in place */
    lua_settop(L, 1);
    luaL_traceback(L, L, NULL, 1);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &traceback_key);
    return 1;
}

/* Lua shortens a long path to "..." and its end. Is file what Lua makes of path? */
static bool is_shortened(const char *file, size_t n, const char *path)
{
    size_t n_path = strlen(path);
    return n > 3 && n_path >= n - 3 && memcmp(file, "...", 3) == 0 &&
           memcmp(path + n_path - (n - 3), file + 3, n - 3) == 0;
}

/* Text before ":12:" is taken for a file when it looks like one: messages may hold such things by chance. */
static bool is_position(const char *file, size_t n, const char *origin)
{
    char path[512];
    if (n == 0) return false;
    if (!memchr(file, ' ', n) || file[0] == '[' || file[0] == '(') return true;
    if ((strlen(origin) == n && memcmp(file, origin, n) == 0) || is_shortened(file, n, origin)) return true;
    if (n >= sizeof path) return false;
    memcpy(path, file, n);
    path[n] = '\0';
    return access(path, F_OK) == 0;
}

/* Splits "file:12: text". n_file = 0: there is no position. */
static const char *split(const char *message, const char *origin, size_t *n_file, int *line)
{
    *n_file = 0;
    *line = 0;
    for (const char *p = message; *p && *p != '\n'; p++) {
        if (*p != ':' || !isdigit((unsigned char)p[1])) continue;
        const char *end = p + 1;
        while (isdigit((unsigned char)*end)) end++;
        if (*end != ':' || !is_position(message, (size_t)(p - message), origin)) continue;
        *n_file = (size_t)(p - message);
        *line = atoi(p + 1);
        return end + 1 + (end[1] == ' ');
    }
    return message;
}

static char *copy_part(const char *s, size_t n)
{
    char *copy = SN_NEW(char, n + 1);
    if (!copy) return NULL;
    memcpy(copy, s, n);
    copy[n] = '\0';
    return copy;
}

/* The message is on top; it may be any value when even the message handler failed. */
static void fill(cli_failure *f, lua_State *L, int exit_code, const char *origin)
{
    const char *message = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : "(error object is no text)";
    f->exit_code = exit_code;
    size_t n_file;
    const char *text = split(message, origin, &n_file, &f->line);
    f->file =
        n_file == 0 || is_shortened(message, n_file, origin) ? sn_strdup(origin) : copy_part(message, n_file);
    f->text = sn_strdup(text);
}

static int code_of(lua_State *L, int status)
{
    if (status == LUA_ERRMEM) return CLI_EXIT_LIMIT;
    const char *message = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : "";
    return cli_exit_code(lsn_status_of(L, message));
}

bool cli_call(lua_State *L, int n_arg, int n_result, const char *origin, cli_failure *f)
{
    int handler = lua_gettop(L) - n_arg;
    lua_pushcfunction(L, keep_traceback);
    lua_insert(L, handler);
    int status = lua_pcall(L, n_arg, n_result, handler);
    lua_remove(L, handler);
    if (status == LUA_OK) return true;
    fill(f, L, code_of(L, status), origin);
    lua_pop(L, 1);
    if (status != LUA_ERRMEM && lua_rawgetp(L, LUA_REGISTRYINDEX, &traceback_key) == LUA_TSTRING)
        f->traceback = sn_strdup(lua_tostring(L, -1));
    if (status != LUA_ERRMEM) lua_pop(L, 1);
    return false;
}

void cli_failure_of_load(cli_failure *f, lua_State *L, int status, const char *origin)
{
    int code = status == LUA_ERRFILE  ? CLI_EXIT_INPUT
               : status == LUA_ERRMEM ? CLI_EXIT_LIMIT
                                      : CLI_EXIT_SCRIPT;
    fill(f, L, code, origin);
    lua_pop(L, 1);
}

void cli_failure_print(const cli_failure *f, bool has_traceback)
{
    cli_progress_erase();
    (void)fflush(stdout); /* so that both streams read in order when they go to one place */
    const char *file = f->file ? f->file : "sinew", *text = f->text ? f->text : "not enough memory";
    if (f->line > 0)
        (void)fprintf(stderr, "%s:%d: error: %s\n", file, f->line, text);
    else
        (void)fprintf(stderr, "%s: error: %s\n", file, text);
    if (has_traceback && f->traceback) (void)fprintf(stderr, "%s\n", f->traceback);
}
