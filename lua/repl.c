#define _GNU_SOURCE
#include "repl.h"

#include "base/alloc.h"
#include "base/file.h"
#include "bind/lsn.h"
#include "define.h"
#include "interrupt.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <readline/history.h>
#include <readline/readline.h>

#define HISTORY_LINES 2000
#define ORIGIN "stdin" /* as Lua names what is typed */

/* ---- history: $XDG_STATE_HOME/sinew/history, one line appended at a time ---- */

/* NULL: there is no place for it. By malloc. */
static char *make_history_path(void)
{
    const char *state = getenv("XDG_STATE_HOME"), *home = getenv("HOME");
    char *path = NULL;
    int n = -1;
    if (state && state[0] == '/')
        n = asprintf(&path, "%s/sinew/history", state);
    else if (home && home[0] == '/')
        n = asprintf(&path, "%s/.local/state/sinew/history", home);
    return n < 0 ? NULL : path;
}

static bool make_folders(char *path)
{
    for (char *p = strchr(path + 1, '/'); p; p = strchr(p + 1, '/')) {
        *p = '\0';
        sn_status st = sn_dir_create(path, NULL);
        *p = '/';
        if (st) return false;
    }
    return true;
}

/* Reads the history; NULL when it cannot be kept. */
static char *open_history(void)
{
    using_history();
    stifle_history(HISTORY_LINES);
    char *path = make_history_path();
    int fd = path && make_folders(path) ? open(path, O_CREAT | O_RDWR | O_CLOEXEC, 0600) : -1;
    if (fd < 0) {
        free(path);
        return NULL;
    }
    (void)close(fd);
    (void)history_truncate_file(path, HISTORY_LINES);
    (void)read_history(path);
    return path;
}

static void remember_line(const char *line, const char *history_path)
{
    const HIST_ENTRY *last = history_length > 0 ? history_get(history_base + history_length - 1) : NULL;
    if (!*line || (last && strcmp(last->line, line) == 0)) return;
    add_history(line);
    if (history_path) (void)append_history(1, history_path);
}

/* ---- completion ---- */

static lua_State *completing; /* readline's functions have no argument for it */

static int push_completions(lua_State *L)
{
    (void)cli_push_completions(L, lua_tostring(L, 1), (size_t)lua_tointeger(L, 2));
    return 1;
}

/* readline calls it with state 0, 1, 2, ... and frees what it gets. The list is on top of Lua's stack. */
static char *next_completion(const char *text, int state)
{
    (void)text;
    lua_rawgeti(completing, -1, state + 1);
    const char *name = lua_tostring(completing, -1);
    char *copy = name ? strdup(name) : NULL;
    lua_pop(completing, 1);
    return copy;
}

static char **complete(const char *text, int start, int end)
{
    lua_State *L = completing;
    char **match = NULL;
    bool in_quotes = start > 0 && (rl_line_buffer[start - 1] == '"' || rl_line_buffer[start - 1] == '\'');
    int top = lua_gettop(L);
    if (!lua_checkstack(L, 8)) return NULL;
    lua_pushcfunction(L, push_completions);
    lua_pushstring(L, rl_line_buffer);
    lua_pushinteger(L, end);
    if (lua_pcall(L, 2, 1, 0) == LUA_OK) match = rl_completion_matches(text, next_completion);
    lua_settop(L, top);
    rl_completion_append_character = '\0';            /* no blank after it */
    if (!in_quotes) rl_attempted_completion_over = 1; /* file names are for strings only */
    return match;
}

/* ---- reading ---- */

/* As rl_getc, but Ctrl-C empties the line and ends it. */
static int next_key(FILE *in)
{
    for (;;) {
        struct pollfd p = {.fd = fileno(in), .events = POLLIN};
        int ready = poll(&p, 1, 200);
        rl_check_signals();
        if (*cli_interrupt_flag()) {
            rl_replace_line("", 0);
            return '\n';
        }
        if (ready > 0 || (ready < 0 && errno != EINTR)) return rl_getc(in);
    }
}

static void set_up_readline(lua_State *L)
{
    completing = L;
    rl_readline_name = "sinew";
    rl_outstream = isatty(STDERR_FILENO) ? stderr : stdout;
    rl_getc_function = next_key;
    rl_attempted_completion_function = complete;
    rl_basic_word_break_characters = " \t\n\"\\'><=;:+-*/%^~#&|{}()[].,";
    rl_completer_quote_characters = "\"'";
    rl_completer_word_break_characters = NULL;
}

/* The next line without its end, by malloc; NULL at the end of the input. */
static char *read_line(bool is_tty, const char *prompt)
{
    if (is_tty) return readline(prompt);
    char *line = NULL;
    size_t cap = 0;
    ssize_t n = getline(&line, &cap, stdin);
    if (n < 0) {
        free(line);
        return NULL;
    }
    if (n > 0 && line[n - 1] == '\n') line[n - 1] = '\0';
    return line;
}

/* ---- running ---- */

/* Does the message on top say that the text ends too early? */
static bool is_incomplete(lua_State *L, int status)
{
    static const char mark[] = "<eof>";
    size_t n;
    const char *message = lua_tolstring(L, -1, &n);
    return status == LUA_ERRSYNTAX && message && n >= strlen(mark) &&
           strcmp(message + n - strlen(mark), mark) == 0;
}

static int load(lua_State *L, const char *text)
{
    return luaL_loadbufferx(L, text, strlen(text), "=" ORIGIN, "t");
}

/* Pushes the function that the text stands for, or the message of the load. */
static int load_input(lua_State *L, const char *text)
{
    char *expression = NULL;
    int status = LUA_ERRSYNTAX;
    if (asprintf(&expression, "return %s", text) >= 0) {
        status = load(L, expression);
        if (status != LUA_OK) lua_pop(L, 1);
        free(expression);
    }
    return status == LUA_OK ? status : load(L, text);
}

/* *text = *text "\n" line; line is freed. */
static bool append(char **text, char *line)
{
    char *joined = NULL;
    bool ok = !*text || asprintf(&joined, "%s\n%s", *text, line) >= 0;
    if (!*text) {
        *text = line;
        return true;
    }
    free(line);
    if (!ok) return false;
    free(*text);
    *text = joined;
    return true;
}

/* Reads until the input is complete and pushes its function or the message of the load. false: the input has
 * ended or was thrown away by Ctrl-C; *at_end tells. */
static bool read_input(lua_State *L, bool is_tty, const char *history, int *status, bool *at_end)
{
    char *text = NULL;
    bool is_complete = false;
    while (!is_complete) {
        char *line = read_line(is_tty, text ? ">> " : "> ");
        *at_end = line == NULL;
        if (cli_interrupt_take() || !line) {
            free(line);
            break;
        }
        if (is_tty) remember_line(line, history);
        if (!append(&text, line)) break;
        *status = load_input(L, text);
        is_complete = !is_incomplete(L, *status);
        if (!is_complete) lua_pop(L, 1);
    }
    if (*at_end && text) { /* say what is missing */
        *status = load_input(L, text);
        is_complete = true;
    }
    free(text);
    return is_complete;
}

/* Runs the function on top and prints what it gives. */
static bool run_input(cli_session *s, cli_failure *f)
{
    lua_State *L = s->L;
    cli_deadline_set(s->opt->time_limit);
    bool ok = cli_call(L, 0, LUA_MULTRET, ORIGIN, f);
    int n = lua_gettop(L);
    if (ok && n > 0) {
        luaL_checkstack(L, 4, NULL);
        lua_pushcfunction(L, cli_print_values);
        lua_insert(L, 1);
        ok = cli_call(L, n, 0, ORIGIN, f);
    }
    cli_interrupt_settle();
    return ok;
}

static int set_up(lua_State *L)
{
    cli_define_settle(L);
    cli_open_help(L);
    return 0;
}

void cli_repl(cli_session *s)
{
    lua_State *L = s->L;
    bool is_tty = isatty(STDIN_FILENO), at_end = false;
    char *history = is_tty ? open_history() : NULL;
    lua_settop(L, 0);
    lua_pushcfunction(L, set_up);
    (void)lua_pcall(L, 0, 0, 0);
    if (is_tty) set_up_readline(L);
    if (is_tty && !s->opt->is_quiet)
        (void)fprintf(rl_outstream, "sinew %s, %s. help() explains, Ctrl-D leaves.\n", SN_VERSION,
                      LUA_RELEASE);
    while (!at_end && !(ferror(stdout) && cli_interrupt_pipe_closed())) {
        int status = LUA_OK;
        cli_failure failure = {0};
        lua_settop(L, 0);
        if (!read_input(L, is_tty, history, &status, &at_end)) continue;
        if (status != LUA_OK) cli_failure_of_load(&failure, L, status, ORIGIN);
        if (status != LUA_OK || !run_input(s, &failure)) cli_failure_print(&failure, true);
        (void)fflush(stdout);
        cli_failure_free(&failure);
    }
    if (is_tty) (void)fprintf(rl_outstream, "\n");
    lua_settop(L, 0);
    free(history);
}
