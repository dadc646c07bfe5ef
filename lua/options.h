/* options.h - the command line of `sinew`. Names shared by the program's own files start with cli_. */
#ifndef CLI_OPTIONS_H
#define CLI_OPTIONS_H

#include "base/status.h"
#include "render/context.h"

#include <stdbool.h>
#include <stdint.h>

typedef enum cli_mode { CLI_RUN, CLI_INFO, CLI_COMPARE, CLI_HELP, CLI_VERSION } cli_mode;

typedef struct cli_list { /* the strings are borrowed from argv */
    const char **item;
    int n;
} cli_list;

typedef struct cli_options {
    cli_mode mode;
    cli_list define;   /* each "name=value" with a name that a Lua variable may have */
    cli_list code;     /* of -e */
    cli_list output;   /* of -o, each with an extension that cli_output_kind knows */
    cli_list operand;  /* FILE... of info, A and B of compare: exactly two */
    const char *json;  /* NULL: no report */
    const char *diff;  /* of compare; NULL: none */
    int32_t max;       /* of compare, 0..255 */
    int64_t count;     /* of compare, >= 0   */
    int threads;       /* 0: one per core */
    sn_renderer renderer;
    double time_limit; /* seconds, 0: none */
    bool has_repl;     /* -i */
    bool is_strict, is_quiet, is_verbose;
    int i_script; /* argv[i_script] is the script and what follows its arguments; 0: no script */
    int argc;
    char **argv;
} cli_options;

/* Errors: SN_EINVAL (a usage error: the message names the option and, when one is near, what was meant),
 * SN_ENOMEM. *o is to be freed in any case. argv must live as long as *o. */
SN_MUST_USE sn_status cli_options_parse(cli_options *o, int argc, char **argv, sn_error *err);
void cli_options_free(cli_options *o);

typedef enum cli_output { CLI_OUTPUT_PICTURE, CLI_OUTPUT_MESH, CLI_OUTPUT_UNKNOWN } cli_output;
/* What a path that -o names is to hold: .png a picture; .vtu, .mesh, .msh or no extension (a folder) the
 * muscles. */
cli_output cli_output_kind(const char *path);

extern const char cli_help_text[];

#endif
