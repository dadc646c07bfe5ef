/* json.h - writes JSON as a stream, two spaces a level. Text that is not UTF-8 is mended with U+FFFD; a
 * number that is not finite becomes null. */
#ifndef CLI_JSON_H
#define CLI_JSON_H

#include "base/file.h"

#include <lua.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct cli_json {
    sn_out *out; /* borrowed */
    int depth;
    bool has_item; /* in the innermost object or list */
} cli_json;

void cli_json_init(cli_json *j, sn_out *out);
/* key: NULL in a list and at the top. bracket: '{' or '['; the matching one ends it. */
void cli_json_begin(cli_json *j, const char *key, char bracket);
void cli_json_end(cli_json *j, char bracket);
void cli_json_string(cli_json *j, const char *key, const char *value); /* NULL becomes null */
void cli_json_int(cli_json *j, const char *key, int64_t value);
void cli_json_double(cli_json *j, const char *key, double value);
void cli_json_null(cli_json *j, const char *key);
/* A Lua value: a table with keys 1..n is a list, any other an object with its keys sorted; what JSON does not
 * have is written as text. Tables below the 16th level become null. May raise Lua errors. */
void cli_json_value(cli_json *j, const char *key, lua_State *L, int idx);

#endif
