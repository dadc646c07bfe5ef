/* progress.h - one line on standard error that tells how far a long step has come.
 *
 * Only when standard error is a terminal, and only for steps that last longer than a second. There is one
 * terminal, so the line is one per process. */
#ifndef CLI_PROGRESS_H
#define CLI_PROGRESS_H

#include <stdbool.h>

void cli_progress_enable(bool is_wanted); /* starts off; the line is also erased when the process exits */
/* For sn_run.progress. */
void cli_progress_report(void *user, const char *step, double fraction);
void cli_progress_erase(void); /* before anything else is printed; cheap when there is no line */

#endif
