#define _GNU_SOURCE
#include "runner.h"

#include "bind/lsn.h"
#include "define.h"
#include "exit_code.h"
#include "interrupt.h"
#include "outputs.h"
#include "progress.h"
#include "render/context.h"
#include "repl.h"
#include "report.h"

#include <lualib.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char *cli_session_origin(const cli_session *s)
{
    const cli_options *o = s->opt;
    if (s->is_stdin) return "stdin";
    return o->i_script ? o->argv[o->i_script] : "sinew";
}

/* ---- warnings ---- */

static void take_warning(void *user, const char *line)
{
    cli_session *s = user;
    sn_notes_add(&s->warnings, "%s", line);
    if (s->opt->is_quiet) return;
    cli_progress_erase();
    (void)fprintf(stderr, "sinew: warning: %s\n", line);
}

/* Lua's own warn(...): pieces of a line until is_open is 0. Control messages ("@on") are for Lua's own
 * printer. */
static void take_lua_warning(void *user, const char *piece, int is_open)
{
    cli_session *s = user;
    size_t n = strlen(s->warning);
    if (n == 0 && !is_open && piece[0] == '@') return;
    (void)snprintf(s->warning + n, sizeof s->warning - n, "%s", piece);
    if (is_open) return;
    take_warning(s, s->warning);
    s->warning[0] = '\0';
}

/* ---- the end of a run ---- */

static void print_summary(const cli_session *s)
{
    (void)fprintf(stderr, "sinew: script %.2f s, output %.2f s, total %.2f s, peak memory %.0f MiB\n",
                  s->script_seconds, s->output_seconds, sn_clock() - s->start, cli_peak_memory() / 1048576.0);
}

int cli_session_finish(cli_session *s, lua_State *L, int exit_code)
{
    const cli_options *o = s->opt;
    cli_interrupt_settle();
    (void)fflush(stdout);
    if (o->is_strict && exit_code == CLI_EXIT_OK && s->warnings.n_line > 0) {
        (void)fprintf(stderr, "sinew: error: %zu warning%s, and --strict was given\n", s->warnings.n_line,
                      s->warnings.n_line == 1 ? "" : "s");
        exit_code = CLI_EXIT_SCRIPT;
    }
    sn_error err;
    if (o->json && cli_report_write(s, L, exit_code, &err)) {
        (void)fprintf(stderr, "sinew: error: %s\n", err.msg);
        if (exit_code == CLI_EXIT_OK) exit_code = cli_exit_code(err.code);
    } else if (o->json && !o->is_quiet) {
        (void)fprintf(stderr, "wrote %s\n", o->json);
    }
    if (o->is_verbose) print_summary(s);
    return exit_code;
}

/* os.exit([code [, close]]) that ends the run in order. Upvalues: the session, Lua's os.exit. */
static int exit_in_order(lua_State *L)
{
    cli_session *s = lua_touserdata(L, lua_upvalueindex(1));
    int code = CLI_EXIT_OK;
    if (lua_isboolean(L, 1))
        code = lua_toboolean(L, 1) ? CLI_EXIT_OK : CLI_EXIT_SCRIPT;
    else
        code = (int)luaL_optinteger(L, 1, CLI_EXIT_OK);
    if (s->script_start > 0.0) s->script_seconds = sn_clock() - s->script_start;
    code = cli_session_finish(s, L, code);
    cli_interrupt_detach();
    lua_pushvalue(L, lua_upvalueindex(2));
    lua_pushinteger(L, code);
    lua_pushboolean(L, lua_toboolean(L, 2));
    lua_call(L, 2, 0);
    return 0;
}

/* ---- the beginning of a run ---- */

static void make_arg_table(lua_State *L, const cli_options *o)
{
    lua_createtable(L, o->argc, o->argc);
    for (int i = 0; i < o->argc; i++) {
        lua_pushstring(L, o->argv[i]);
        lua_rawseti(L, -2, i - o->i_script);
    }
    lua_setglobal(L, "arg");
}

static void replace_os_exit(lua_State *L, cli_session *s)
{
    lua_getglobal(L, LUA_OSLIBNAME);
    lua_pushlightuserdata(L, s);
    lua_getfield(L, -2, "exit");
    lua_pushcclosure(L, exit_in_order, 2);
    lua_setfield(L, -2, "exit");
    lua_pop(L, 1);
}

static int set_up(lua_State *L)
{
    cli_session *s = lua_touserdata(L, 1);
    const cli_options *o = s->opt;
    luaL_openlibs(L);
    luaL_requiref(L, "sinew", luaopen_sinew, 1);
    lua_pop(L, 1);
    lsn_state *st = lsn_get_state(L);
    st->run.n_threads = o->threads;
    st->renderer = o->renderer;
    st->run.cancel = cli_interrupt_flag();
    st->run.progress = cli_progress_report;
    st->warn = take_warning;
    st->warn_user = s;
    lua_setwarnf(L, take_lua_warning, s);
    make_arg_table(L, o);
    replace_os_exit(L, s);
    cli_define_globals(L, &o->define);
    cli_interrupt_install(L);
    return 0;
}

/* llvmpipe has a thread count of its own and looks at the environment once. */
static void set_drawing_threads(int n)
{
    char text[16];
    (void)snprintf(text, sizeof text, "%d", n);
    if (n > 0) (void)setenv("LP_NUM_THREADS", text, 0);
}

static void print_versions(const cli_options *o)
{
    sn_context *c = NULL;
    sn_error err;
    sn_status st = sn_context_create(&c, o->renderer, &err);
    int n = sn_run_threads(&(sn_run){.n_threads = o->threads});
    (void)fprintf(stderr, "sinew %s, %s, %d thread%s\n", SN_VERSION, LUA_RELEASE, n, n == 1 ? "" : "s");
    (void)fprintf(stderr, "renderer: %s\n", st ? err.msg : sn_context_renderer(c));
    sn_context_destroy(c);
}

/* ---- the steps of a run; each returns false when it failed, s->failure says how ---- */

static bool run_code(cli_session *s)
{
    for (int i = 0; i < s->opt->code.n; i++) {
        const char *code = s->opt->code.item[i];
        int status = luaL_loadbuffer(s->L, code, strlen(code), "=(command line)");
        if (status != LUA_OK) {
            cli_failure_of_load(&s->failure, s->L, status, cli_session_origin(s));
            return false;
        }
        if (!cli_call(s->L, 0, 0, cli_session_origin(s), &s->failure)) return false;
    }
    return true;
}

/* The chunk is on top of the stack. */
static bool call_script(cli_session *s)
{
    const cli_options *o = s->opt;
    int n = o->i_script ? o->argc - o->i_script - 1 : 0;
    if (!lua_checkstack(s->L, n + 8)) {
        lua_pop(s->L, 1);
        lua_pushfstring(s->L, "%d arguments are too many for a script", n);
        cli_failure_of_load(&s->failure, s->L, LUA_ERRRUN, "sinew");
        return false;
    }
    for (int i = 0; i < n; i++) lua_pushstring(s->L, o->argv[o->i_script + 1 + i]);
    return cli_call(s->L, n, 0, cli_session_origin(s), &s->failure);
}

static bool run_script(cli_session *s)
{
    int status = luaL_loadfile(s->L, s->is_stdin ? NULL : s->opt->argv[s->opt->i_script]);
    if (status == LUA_OK) return call_script(s);
    cli_failure_of_load(&s->failure, s->L, status, status == LUA_ERRFILE ? "sinew" : cli_session_origin(s));
    return false;
}

static bool run_outputs(cli_session *s)
{
    double start = sn_clock();
    lua_pushcfunction(s->L, cli_write_outputs);
    lua_pushlightuserdata(s->L, s);
    bool ok = cli_call(s->L, 1, 0, cli_session_origin(s), &s->failure);
    s->output_seconds = sn_clock() - start;
    return ok;
}

static void print_failure(const cli_session *s, bool has_traceback)
{
    cli_interrupt_settle();
    if (!s->failure.exit_code || (ferror(stdout) && cli_interrupt_pipe_closed())) return;
    cli_failure_print(&s->failure, has_traceback);
}

/* The -e code and the script. */
static bool run_program(cli_session *s)
{
    s->script_start = sn_clock();
    bool ok = run_code(s) && (!(s->opt->i_script || s->is_stdin) || run_script(s));
    s->script_seconds = sn_clock() - s->script_start;
    s->script_start = 0.0;
    return ok;
}

static int run_all(cli_session *s)
{
    const cli_options *o = s->opt;
    bool is_tty = isatty(STDIN_FILENO), is_bare = !o->i_script && !o->code.n && !o->has_repl;
    bool has_repl = o->has_repl || (is_bare && is_tty);
    s->is_stdin = o->i_script ? strcmp(o->argv[o->i_script], "-") == 0 : is_bare && !is_tty;
    bool has_program = o->i_script || o->code.n || s->is_stdin;
    cli_deadline_set(o->time_limit);
    if (has_program && run_program(s)) (void)run_outputs(s);
    if (has_program || !has_repl) print_failure(s, o->is_verbose || has_repl);
    if (!has_repl) return s->failure.exit_code;
    cli_repl(s);
    if (!has_program && !run_outputs(s))
        print_failure(s, o->is_verbose); /* what was typed has made the scene */
    return s->failure.exit_code;
}

int cli_run(const cli_options *o)
{
    cli_session s = {.opt = o, .start = sn_clock()};
    int code = CLI_EXIT_LIMIT;
    set_drawing_threads(o->threads);
    cli_progress_enable(!o->is_quiet);
    if (o->is_verbose) print_versions(o);
    s.L = luaL_newstate();
    if (!s.L) {
        (void)fprintf(stderr, "sinew: error: not enough memory for Lua\n");
        return code;
    }
    lua_pushcfunction(s.L, set_up);
    lua_pushlightuserdata(s.L, &s);
    if (lua_pcall(s.L, 1, 0, 0) == LUA_OK) {
        code = run_all(&s);
        code = cli_session_finish(&s, s.L, code);
    } else {
        const char *why = lua_tostring(s.L, -1);
        (void)fprintf(stderr, "sinew: error: %s\n", why ? why : "cannot start Lua");
    }
    cli_interrupt_detach();
    lua_close(s.L);
    cli_failure_free(&s.failure);
    sn_notes_free(&s.warnings);
    return code;
}
