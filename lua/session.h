/* session.h - one run of the program: the interpreter, what the command line asks for, and what has happened
 * so far. */
#ifndef CLI_SESSION_H
#define CLI_SESSION_H

#include "base/notes.h"
#include "failure.h"
#include "options.h"

#include <lua.h>

typedef struct cli_session {
    lua_State *L;
    const cli_options *opt;
    bool is_stdin;       /* the script comes from standard input            */
    sn_notes warnings;   /* every warning line, printed or not              */
    char warning[512];   /* the pieces of a line that Lua's warn gave so far */
    int n_written;       /* the first so many of opt->output are written    */
    cli_failure failure; /* of the script, -e or -o                         */
    double start;        /* sn_clock()                                      */
    double script_start; /* sn_clock(); 0: the script does not run          */
    double script_seconds, output_seconds;
} cli_session;

/* What stands for the script where an error has no position: its path, "stdin", or "sinew" when there is
 * none. */
const char *cli_session_origin(const cli_session *s);
/* What is left to do when a run ends with this exit code: --strict, the report, -v. Returns the final exit
 * code. L: the thread of Lua that runs. */
int cli_session_finish(cli_session *s, lua_State *L, int exit_code);

#endif
