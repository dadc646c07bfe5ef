/* side_name.h - which names belong to the left or right side, and the name of the other side. */
#ifndef SN_BASE_SIDE_NAME_H
#define SN_BASE_SIDE_NAME_H

#include <stdbool.h>
#include <stddef.h>

/* How much longer than the name its other side can be, with the 0 at the end: _left becomes _right. */
#define SN_SIDE_NAME_EXTRA 2

typedef enum sn_side { SN_SIDE_NONE, SN_SIDE_LEFT, SN_SIDE_RIGHT } sn_side;
sn_side sn_side_of(const char *name);

/* A name of a side ends in one of _l _r, _L _R, .l .r, .L .R, _left _right, with something before it. out
 * receives the name with the other ending, or the name itself when it has no side. Applied twice it gives the
 * name back. size: of out, at least strlen(name) + SN_SIDE_NAME_EXTRA; a smaller one cuts the name off.
 * Returns whether the name has a side. */
bool sn_side_name_swap(const char *name, char *out, size_t size);

#endif
