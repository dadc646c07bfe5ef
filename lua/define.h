/* define.h - the global variables that -D sets. */
#ifndef CLI_DEFINE_H
#define CLI_DEFINE_H

#include "options.h"

#include <lua.h>

/* Sets the variables: "true" and "false" become booleans, numbers numbers, the rest strings. Until a variable
 * is first read, assignments to it are the script's own default and have no effect; after that it is a
 * variable like any other. May raise Lua errors. */
void cli_define_globals(lua_State *L, const cli_list *define);
/* Ends the waiting for a first read: what is typed counts. May raise Lua errors. */
void cli_define_settle(lua_State *L);

#endif
