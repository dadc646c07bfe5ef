/* failure.h - an error that reached the top: where, what, the exit code, and how it is printed. */
#ifndef CLI_FAILURE_H
#define CLI_FAILURE_H

#include <lua.h>
#include <stdbool.h>

typedef struct cli_failure { /* zero-initialised = none */
    int exit_code;           /* 0: no failure                                                */
    int line;                /* 0: unknown                                                   */
    char *file;              /* the script, or the file that the message names; owned        */
    char *text;              /* without file and line; owned                                 */
    char *traceback;         /* NULL: none; owned                                            */
} cli_failure;

void cli_failure_free(cli_failure *f); /* releases and empties */

/* Calls the function below n_arg arguments; its results, n_result of them, stay on the stack. false: it
 * failed, *f (empty before) says how, and nothing stays. origin: the script's path, or what stands for it
 * where a message has no position. */
bool cli_call(lua_State *L, int n_arg, int n_result, const char *origin, cli_failure *f);
/* As cli_call for a failed lua_load, whose message is on top and is removed. */
void cli_failure_of_load(cli_failure *f, lua_State *L, int status, const char *origin);

/* "file:line: error: text" on standard error; the traceback below. */
void cli_failure_print(const cli_failure *f, bool has_traceback);

#endif
