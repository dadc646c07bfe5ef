/* main.c - the program `sinew`: a script runner, a REPL and a few commands around the library. */
#define _GNU_SOURCE
#include "base/run.h"
#include "commands.h"
#include "exit_code.h"
#include "interrupt.h"
#include "options.h"
#include "progress.h"
#include "runner.h"

#include <errno.h>
#include <locale.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static int dispatch(const cli_options *o)
{
    switch (o->mode) {
    case CLI_HELP:
        (void)fputs(cli_help_text, stdout);
        break;
    case CLI_VERSION:
        (void)printf("sinew %s\n", SN_VERSION);
        break;
    case CLI_INFO:
        return cli_info(o);
    case CLI_COMPARE:
        return cli_compare(o);
    case CLI_RUN:
        return cli_run(o);
    }
    return CLI_EXIT_OK;
}

/* Results that did not arrive are a failure, but a reader that has had enough (| head) is none to talk about:
 * then the process ends as if the signal had not been caught. */
static int finish_output(int code)
{
    errno = 0;
    bool is_complete = fflush(stdout) == 0 && !ferror(stdout);
    if (is_complete) return code;
    if (cli_interrupt_pipe_closed()) {
        (void)signal(SIGPIPE, SIG_DFL);
        (void)raise(SIGPIPE);
    }
    (void)fprintf(stderr, "sinew: error: cannot write standard output%s%s\n", errno ? ": " : "",
                  errno ? strerror(errno) : "");
    return code ? code : CLI_EXIT_INPUT;
}

/* While a library still works on what was interrupted, it must not be taken down. */
static void end_at_once(int code)
{
    if (sn_run_left_behind() == 0) return;
    cli_progress_erase();
    (void)fflush(NULL);
    _exit(code);
}

int main(int argc, char **argv)
{
    cli_options options;
    sn_error err;
    (void)setlocale(LC_CTYPE, ""); /* the rest stays "C": numbers have points */
    int code;
    if (cli_options_parse(&options, argc, argv, &err)) {
        (void)fprintf(stderr, "sinew: error: %s\n", err.msg);
        if (err.code == SN_EINVAL) (void)fprintf(stderr, "sinew --help explains the options\n");
        code = err.code == SN_EINVAL ? CLI_EXIT_USAGE : CLI_EXIT_LIMIT;
    } else {
        code = finish_output(dispatch(&options));
    }
    cli_options_free(&options);
    end_at_once(code);
    return code;
}
