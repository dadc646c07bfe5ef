#define _GNU_SOURCE
#include "progress.h"

#include "base/run.h"
#include "interrupt.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#define SHOW_AFTER 1.0 /* seconds */
#define SHOW_EVERY 0.1
#define LEAST_FRACTION 0.02 /* of a step, to guess from how long the rest takes */

static struct {
    bool is_on, has_exit_handler;
    char step[64];
    double start, drawn; /* sn_clock() */
    double fraction;     /* of the last report */
    int width;           /* of the line on the terminal, 0: none */
} bar;

void cli_progress_enable(bool is_wanted)
{
    bar.is_on = is_wanted && isatty(STDERR_FILENO);
    if (bar.is_on && !bar.has_exit_handler) bar.has_exit_handler = atexit(cli_progress_erase) == 0;
}

void cli_progress_erase(void)
{
    if (bar.width > 0) (void)fprintf(stderr, "\r%*s\r", bar.width, "");
    if (bar.width > 0) (void)fflush(stderr);
    bar.width = 0;
}

static int columns(void)
{
    struct winsize w;
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &w) == 0 && w.ws_col > 10 ? w.ws_col : 80;
}

static void draw(double fraction, double seconds)
{
    char line[160];
    if (fraction >= LEAST_FRACTION)
        (void)snprintf(line, sizeof line, "%s: %3.0f %%, %.0f s, about %.0f s left", bar.step,
                       100.0 * fraction, seconds, seconds * (1.0 - fraction) / fraction);
    else if (fraction >= 0.0)
        (void)snprintf(line, sizeof line, "%s: %3.0f %%, %.0f s", bar.step, 100.0 * fraction, seconds);
    else
        (void)snprintf(line, sizeof line, "%s: %.0f s", bar.step, seconds);
    int room = columns() - 1, n = (int)strlen(line);
    if (n > room) n = room;
    (void)fprintf(stderr, "\r%.*s%*s", n, line, bar.width > n ? bar.width - n : 0, "");
    (void)fflush(stderr);
    if (n > bar.width) bar.width = n;
}

void cli_progress_report(void *user, const char *step, double fraction)
{
    (void)user;
    if (!bar.is_on) return;
    double now = sn_clock();
    bool is_new = strncmp(bar.step, step, sizeof bar.step - 1) != 0 || fraction < bar.fraction;
    bar.fraction = fraction;
    if (is_new) {
        cli_progress_erase();
        (void)snprintf(bar.step, sizeof bar.step, "%s", step);
        bar.start = now;
        bar.drawn = 0.0;
    }
    if (now - bar.start < SHOW_AFTER || now - bar.drawn < SHOW_EVERY) return;
    bar.drawn = now;
    draw(fraction, now - bar.start);
    cli_interrupt_wake(); /* nobody reports the end of a step: the next Lua instruction erases the line */
}
