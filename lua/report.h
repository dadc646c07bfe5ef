/* report.h - the report of a run that --json asks for. */
#ifndef CLI_REPORT_H
#define CLI_REPORT_H

#include "session.h"

/* Writes s->opt->json, all or nothing. L: the thread of Lua that runs. Errors: SN_EIO, SN_ENOMEM. */
SN_MUST_USE sn_status cli_report_write(const cli_session *s, lua_State *L, int exit_code, sn_error *err);

/* The most memory that this process has held, and the largest of its children. */
double cli_peak_memory(void);
double cli_peak_memory_of_children(void);

#endif
