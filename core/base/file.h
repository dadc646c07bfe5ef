/* file.h - whole-file input and all-or-nothing output, independent of the locale.
 *
 * Output goes to a temporary file beside the target, which replaces the target only at sn_out_commit: no
 * failure leaves a partial file. Numbers are written so that reading them back gives the same bits. */
#ifndef SN_BASE_FILE_H
#define SN_BASE_FILE_H

#include "base/run.h"
#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Reads the whole file; *data is by sn_alloc with one 0 byte after *size bytes. Errors: SN_EIO (with the path
 * and the system's reason), SN_ENOMEM; *data is then NULL. Folders and other non-files are errors. */
SN_MUST_USE sn_status sn_file_read(const char *path, char **data, size_t *size, sn_error *err);

/* The extension in lower case without the dot ("STL" -> "stl"), "" when there is none. out: room for 16. */
void sn_file_extension(const char *path, char out[16]);

/* Creates the folder when it is missing; its parent must exist. Errors: SN_EIO. */
SN_MUST_USE sn_status sn_dir_create(const char *path, sn_error *err);

typedef struct sn_out sn_out; /* opaque: a buffered stream into the temporary file */
/* A link is followed: what it leads to is replaced. Errors: SN_EIO (also for folders and devices), SN_ENOMEM.
 */
SN_MUST_USE sn_status sn_out_open(sn_out **out, const char *path, sn_error *err);
/* From now on bytes that go out report progress as that step (a text that lives as long as o) and a stop of
 * the run is kept as a failure. run: NULL for none; borrowed. expected: bytes of the whole file, 0: not
 * known. */
void sn_out_watch(sn_out *o, const sn_run *run, const char *step, double expected);
bool sn_out_failed(const sn_out *o); /* what is still written is lost: long writers may as well end */
void sn_out_bytes(sn_out *o, const void *data, size_t size); /* failures are kept until sn_out_commit */
void sn_out_text(sn_out *o, const char *s);
void sn_out_int(sn_out *o, int64_t v);
void sn_out_double(sn_out *o,
                   double v); /* shortest of 15..17 digits that reads back to the same bits; '.' always */
/* Base64 of data in one go (RFC 4648, padded). */
void sn_out_base64(sn_out *o, const void *data, size_t size);
/* Closes, renames over the target, destroys o (also on failure, then the target is untouched). Errors:
 * SN_EIO; SN_ECANCEL, SN_ELIMIT when the run was stopped. */
SN_MUST_USE sn_status sn_out_commit(sn_out *o, sn_error *err);
void sn_out_abort(sn_out *o); /* removes the temporary file, destroys o; NULL is fine */

/* Writes a double as sn_out_double does; returns the length, buf 0-terminated. */
int sn_format_double(char buf[32], double v);
/* As strtod in the C locale. *end receives the first character not used (= s when there is no number). */
double sn_parse_double(const char *s, const char **end);

#endif
