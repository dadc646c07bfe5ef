/* repl.h - lines typed at a terminal (or piped in) and run one after the other. */
#ifndef CLI_REPL_H
#define CLI_REPL_H

#include "session.h"

/* Reads standard input to its end. Each input is tried as an expression, whose values are printed, then as
 * statements; more lines are asked for until it is complete. Errors are printed with their traceback and end
 * nothing. --time-limit holds for each input. */
void cli_repl(cli_session *s);

/* repl_print.c. A Lua function: prints its arguments for people, tables two levels deep with sorted keys. */
int cli_print_values(lua_State *L);

/* repl_complete.c. Pushes the list of completions of the last word of line (its first n bytes) and returns
 * how long that word is. Fields and methods are looked up raw; the names inside quotes after :muscle(" and
 * its like come from the scene, or from the newest one. May raise Lua errors. */
size_t cli_push_completions(lua_State *L, const char *line, size_t n);

/* repl_help.c. Defines the global function help. May raise Lua errors. */
void cli_open_help(lua_State *L);

#endif
