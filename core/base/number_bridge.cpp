#include "base/number_bridge.h"

#include <charconv>

int sn_shortest_digits(double v, char digits[SN_DIGITS_MAX], int *exponent)
{
    char text[32]; /* d.ddde-xxx */
    const char *end = std::to_chars(text, text + sizeof text, v, std::chars_format::scientific).ptr;
    int n = 0;
    const char *p = text;
    for (; p < end && *p != 'e'; p++)
        if (*p != '.') digits[n++] = *p;
    bool is_small = *++p == '-';
    int e = 0;
    for (p++; p < end; p++) e = 10 * e + (*p - '0');
    *exponent = is_small ? -e : e;
    while (n > 1 && digits[n - 1] == '0') n--;
    return n;
}
