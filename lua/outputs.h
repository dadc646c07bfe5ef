/* outputs.h - the files that -o names, made from the newest scene. */
#ifndef CLI_OUTPUTS_H
#define CLI_OUTPUTS_H

#include <lua.h>

/* A Lua function. Argument: the session as a light userdata. Renders and extracts through the scripting
 * interface, names each file on standard error and counts it in the session. Raises what fails, and when
 * there are files to write but no scene. */
int cli_write_outputs(lua_State *L);

#endif
