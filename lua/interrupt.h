/* interrupt.h - Ctrl-C, the time limit and a closed standard output, made into Lua errors.
 *
 * A signal handler may do next to nothing: it sets a flag, which long steps of the core look at through
 * sn_run.cancel, and installs a Lua hook, so that the next Lua instruction looks at it, too. A second Ctrl-C
 * before the first was dealt with ends the process. Signals belong to the process, so there is one of all
 * this. */
#ifndef CLI_INTERRUPT_H
#define CLI_INTERRUPT_H

#include <lua.h>
#include <signal.h>
#include <stdbool.h>

/* Installs the handlers of SIGINT and SIGPIPE. L: the interpreter to stop, with `sinew` and the coroutine
 * library open (new coroutines then look at the flag now and then); NULL: none. May raise Lua errors
 * (memory). */
void cli_interrupt_install(lua_State *L);
/* No hook any more; to be called before the interpreter is closed. */
void cli_interrupt_detach(void);

/* For sn_run.cancel. */
const volatile sig_atomic_t *cli_interrupt_flag(void);
/* Was there a Ctrl-C that nobody has dealt with? Clears it. */
bool cli_interrupt_take(void);

/* From now on Lua code and long steps may take that long. 0 seconds: as long as they like. */
void cli_deadline_set(double seconds);

/* Has the hook run at the next Lua instruction, which also erases the line of progress. */
void cli_interrupt_wake(void);

/* After a run that ended, however it did: no flag, no time limit, no hook, no line of progress. */
void cli_interrupt_settle(void);

/* Has a write met a pipe that nobody reads any more? */
bool cli_interrupt_pipe_closed(void);

#endif
