/* names.h - names that users give and mistype. */
#ifndef SN_BASE_NAMES_H
#define SN_BASE_NAMES_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

/* 1..64 bytes, no '/', no '"', no control characters, not "." or "..". kind: what is named, for the message.
 * SN_EINVAL. */
SN_MUST_USE sn_status sn_check_name(const char *kind, const char *name, sn_error *err);
/* The candidate nearest to word by edit distance, NULL when none is near. */
const char *sn_nearest_name(const char *word, const char *const *name, size_t n);
/* Index of word, or SN_EINVAL "no KIND 'x' (did you mean 'y'?)", or that the scene has n when none is near.
 */
SN_MUST_USE sn_status sn_find_name(const char *kind, const char *word, const char *const *name, int32_t n,
                                   int32_t *index, sn_error *err);

#endif
