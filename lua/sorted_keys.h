/* sorted_keys.h - the keys of a Lua table in an order that depends on the table only. */
#ifndef CLI_SORTED_KEYS_H
#define CLI_SORTED_KEYS_H

#include <lua.h>

/* Pushes a list of the table's raw keys and returns how many: numbers by value, then strings by bytes, then
 * the rest as it comes. May raise Lua errors (memory). */
lua_Integer cli_push_sorted_keys(lua_State *L, int table);

#endif
