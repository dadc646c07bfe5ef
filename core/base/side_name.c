#include "base/side_name.h"

#include <stdio.h>
#include <string.h>

static const char *const endings[][2] = {
    {"_l", "_r"}, {"_L", "_R"}, {".l", ".r"}, {".L", ".R"}, {"_left", "_right"}};

static bool ends_in(const char *name, const char *ending)
{
    size_t n = strlen(name), k = strlen(ending);
    return n > k && strcmp(name + n - k, ending) == 0;
}

bool sn_side_name_swap(const char *name, char *out, size_t size)
{
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        for (int side = 0; side < 2; side++) {
            if (!ends_in(name, endings[i][side])) continue;
            int stem = (int)(strlen(name) - strlen(endings[i][side]));
            (void)snprintf(out, size, "%.*s%s", stem, name, endings[i][1 - side]);
            return true;
        }
    (void)snprintf(out, size, "%s", name);
    return false;
}

sn_side sn_side_of(const char *name)
{
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++) {
        if (ends_in(name, endings[i][0])) return SN_SIDE_LEFT;
        if (ends_in(name, endings[i][1])) return SN_SIDE_RIGHT;
    }
    return SN_SIDE_NONE;
}
