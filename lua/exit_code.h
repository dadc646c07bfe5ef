/* exit_code.h - what the program's exit code tells. */
#ifndef CLI_EXIT_CODE_H
#define CLI_EXIT_CODE_H

#include "base/status.h"

enum {
    CLI_EXIT_OK = 0,
    CLI_EXIT_SCRIPT = 1, /* an error in the script, and whatever has no code of its own */
    CLI_EXIT_USAGE = 2,
    CLI_EXIT_INPUT = 3, /* a file that cannot be read, understood or written */
    CLI_EXIT_MESH = 4,
    CLI_EXIT_SOLVER = 5,
    CLI_EXIT_RENDER = 6,
    CLI_EXIT_DIFFERS = 7, /* pictures that are not alike */
    CLI_EXIT_LIMIT = 8,   /* time or memory              */
    CLI_EXIT_INTERRUPTED = 130
};

static inline int cli_exit_code(sn_status st)
{
    switch (st) {
    case SN_OK:
        return CLI_EXIT_OK;
    case SN_EIO:
    case SN_EFORMAT:
        return CLI_EXIT_INPUT;
    case SN_EMESH:
        return CLI_EXIT_MESH;
    case SN_ESOLVE:
        return CLI_EXIT_SOLVER;
    case SN_ERENDER:
        return CLI_EXIT_RENDER;
    case SN_ENOMEM:
    case SN_ELIMIT:
        return CLI_EXIT_LIMIT;
    case SN_ECANCEL:
        return CLI_EXIT_INTERRUPTED;
    case SN_EINVAL:
    case SN_EINTERNAL:
        break;
    }
    return CLI_EXIT_SCRIPT;
}

#endif
