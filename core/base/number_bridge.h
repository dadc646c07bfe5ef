/* number_bridge.h - the shortest digits of a double, by the C++ library (Ryu, U. Adams 2018). */
#ifndef SN_BASE_NUMBER_BRIDGE_H
#define SN_BASE_NUMBER_BRIDGE_H

#include "base/status.h"

SN_BEGIN_DECLS

#define SN_DIGITS_MAX 17

/* The fewest digits that read back to the same bits; of several such numbers the nearest to v. v: finite and
 * > 0. digits: d_1 d_2 ... d_n, not 0-terminated, d_1 and d_n not '0'; v is about d_1.d_2...d_n *
 * 10^exponent. Returns n. */
int sn_shortest_digits(double v, char digits[SN_DIGITS_MAX], int *exponent);

SN_END_DECLS

#endif
