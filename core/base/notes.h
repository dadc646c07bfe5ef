/* notes.h - warnings that a step leaves for its caller: a list of lines. The library never prints them. */
#ifndef SN_BASE_NOTES_H
#define SN_BASE_NOTES_H

#include "base/status.h"

#include <stddef.h>

typedef struct sn_notes { /* zero-initialised = empty */
    char **line;
    size_t n_line, cap;
} sn_notes;

/* notes: NULL to drop the line. A line that memory is short for is dropped, too. */
void sn_notes_add(sn_notes *notes, const char *fmt, ...) SN_PRINTF(2, 3);
void sn_notes_free(sn_notes *notes);

#endif
