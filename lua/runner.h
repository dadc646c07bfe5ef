/* runner.h - a run: the -e code, the script, the files of -o, the REPL, the report. */
#ifndef CLI_RUNNER_H
#define CLI_RUNNER_H

#include "session.h"

/* Runs what the options of mode CLI_RUN ask for and returns the exit code. Errors are printed. */
int cli_run(const cli_options *o);

#endif
