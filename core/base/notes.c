#include "base/notes.h"

#include "base/alloc.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void sn_notes_add(sn_notes *notes, const char *fmt, ...)
{
    char text[512];
    if (!notes) return;
    va_list ap;
    va_start(ap, fmt);
    (void)vsnprintf(text, sizeof text, fmt, ap);
    va_end(ap);
    char *line = sn_strdup(text);
    if (line && sn_grow(&notes->line, &notes->cap, notes->n_line + 1, sizeof *notes->line))
        notes->line[notes->n_line++] = line;
    else
        sn_release(line);
}

void sn_notes_free(sn_notes *notes)
{
    for (size_t i = 0; i < notes->n_line; i++) sn_release(notes->line[i]);
    sn_release(notes->line);
    memset(notes, 0, sizeof *notes);
}
