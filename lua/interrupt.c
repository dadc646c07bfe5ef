#define _GNU_SOURCE
#include "interrupt.h"

#include "bind/lsn.h"
#include "progress.h"

#include <errno.h>
#include <lualib.h>
#include <stdio.h>
#include <string.h>
#include <sys/time.h>

#define COROUTINE_POLL 10000 /* instructions; a hook costs, so the main program runs without one */
#define INTERRUPTED "interrupted"

static volatile sig_atomic_t interrupted, pipe_closed, pipe_was_closed;
static lua_State *interpreter; /* NULL: none to wake */
static double deadline;        /* sn_clock(), 0: none */

static void tick(lua_State *L, lua_Debug *ar);

/* Instructions only: a hook on calls would also run in the message handler of an error on its way up. */
void cli_interrupt_wake(void)
{
    if (interpreter) lua_sethook(interpreter, tick, LUA_MASKCOUNT, 1);
}

static void on_interrupt(int sig)
{
    int code = errno;
    if (interrupted) {
        (void)signal(sig, SIG_DFL);
        (void)raise(sig);
    }
    interrupted = 1;
    cli_interrupt_wake();
    errno = code;
}

static void on_pipe(int sig)
{
    (void)sig;
    pipe_closed = 1;
    pipe_was_closed = 1;
    cli_interrupt_wake();
}

static void on_alarm(int sig)
{
    (void)sig;
    cli_interrupt_wake();
}

static void handle(int sig, void (*handler)(int))
{
    struct sigaction a;
    memset(&a, 0, sizeof a);
    a.sa_handler = handler;
    a.sa_flags = SA_RESTART;
    (void)sigemptyset(&a.sa_mask);
    (void)sigaction(sig, &a, NULL);
}

static void remember(lsn_state *st, sn_status status, const char *message)
{
    st->last_status = status;
    (void)snprintf(st->last_message, sizeof st->last_message, "%s", message);
}

/* Did a step of the core stop because of this Ctrl-C? Then its error has been raised, and caught if we are
 * here. */
static bool core_has_raised(const lsn_state *st)
{
    return st->last_status == SN_ECANCEL && strcmp(st->last_message, INTERRUPTED) != 0;
}

/* As luaL_error, with the position of the function that the hook came upon. */
static void raise_here(lua_State *L, const char *text)
{
    luaL_where(L, 0);
    lua_pushstring(L, text);
    lua_concat(L, 2);
    (void)lua_error(L);
}

/* The hook. On the main thread it goes as it runs: whoever wants it again wakes it. */
static void tick(lua_State *L, lua_Debug *ar)
{
    (void)ar;
    if (L == interpreter) lua_sethook(L, NULL, 0, 0);
    cli_progress_erase();
    lsn_state *st = lsn_get_state(L);
    if (pipe_closed) {
        pipe_closed = 0;
        if (ferror(stdout)) raise_here(L, "standard output is closed");
    }
    if (interrupted) {
        interrupted = 0;
        bool was_caught = core_has_raised(st);
        remember(st, SN_ECANCEL,
                 INTERRUPTED); /* the core's messages begin so, too: a script may raise them again */
        if (!was_caught) raise_here(L, INTERRUPTED);
    }
    if (deadline > 0.0 && sn_clock() > deadline) {
        lua_sethook(L, tick, LUA_MASKCOUNT, 1); /* every instruction from now on: no pcall gets around it */
        remember(st, SN_ELIMIT, "time limit reached");
        raise_here(L, "time limit reached");
    }
}

/* A hook belongs to one thread of Lua and is inherited by those it creates: upvalue 1, coroutine.create or
 * .wrap, is called with a hook that looks at the flags now and then. */
static int create_with_hook(lua_State *L)
{
    luaL_checktype(L, 1, LUA_TFUNCTION);
    lua_Hook hook = lua_gethook(L);
    int mask = lua_gethookmask(L), count = lua_gethookcount(L);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_sethook(L, tick, LUA_MASKCOUNT, COROUTINE_POLL);
    lua_call(L, lua_gettop(L) - 1, 1);
    lua_sethook(L, hook, mask, count);
    if (interrupted || pipe_closed) cli_interrupt_wake(); /* a hook that a signal set meanwhile is lost */
    return 1;
}

static void wrap_coroutine_function(lua_State *L, const char *name)
{
    lua_getglobal(L, LUA_COLIBNAME);
    lua_getfield(L, -1, name);
    lua_pushcclosure(L, create_with_hook, 1);
    lua_setfield(L, -2, name);
    lua_pop(L, 1);
}

void cli_interrupt_install(lua_State *L)
{
    if (L) {
        wrap_coroutine_function(L, "create");
        wrap_coroutine_function(L, "wrap");
    }
    interpreter = L;
    handle(SIGINT, on_interrupt);
    handle(SIGPIPE, on_pipe);
    handle(SIGALRM, on_alarm);
}

void cli_interrupt_detach(void)
{
    cli_interrupt_settle();
    interpreter = NULL;
}

const volatile sig_atomic_t *cli_interrupt_flag(void)
{
    return &interrupted;
}

void cli_interrupt_settle(void)
{
    interrupted = 0;
    cli_deadline_set(0.0);
    if (interpreter) lua_sethook(interpreter, NULL, 0, 0);
    cli_progress_erase();
}

bool cli_interrupt_take(void)
{
    bool was = interrupted != 0;
    interrupted = 0;
    return was;
}

void cli_deadline_set(double seconds)
{
    deadline = seconds > 0.0 ? sn_clock() + seconds : 0.0;
    if (interpreter) lsn_get_state(interpreter)->run.deadline = deadline;
    /* The alarm goes on ringing: one that comes a little early is no harm. */
    struct itimerval t = {{0, 0}, {0, 0}};
    if (seconds > 0.0) {
        double whole = seconds < 1e9 ? seconds : 1e9;
        t.it_value.tv_sec = (time_t)whole;
        t.it_value.tv_usec = (suseconds_t)(1e6 * (whole - (double)t.it_value.tv_sec)) + 1;
        if (t.it_value.tv_usec > 999999) t.it_value.tv_usec = 999999;
        t.it_interval.tv_usec = 50000;
    }
    (void)setitimer(ITIMER_REAL, &t, NULL);
}

bool cli_interrupt_pipe_closed(void)
{
    return pipe_was_closed != 0;
}
