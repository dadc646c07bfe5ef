#define _POSIX_C_SOURCE 200809L
#include "tetra/mesher.h"

#include "base/alloc.h"

#include <stdint.h>
#include <string.h>
#include <unistd.h>

#define PROGRAM "sinew-mesher"

void sn_mesher_exec(sn_child_out *out, sn_mesher_job job, const char *input, size_t size)
{
    char path[4096];
    uint64_t kind = job;
    char *whole = sn_alloc(size + sizeof kind, 1);
    ssize_t n = readlink("/proc/self/exe", path, sizeof path - sizeof PROGRAM);
    if (!whole) return;
    memcpy(whole, &kind, sizeof kind);
    memcpy(whole + sizeof kind, input, size);
    if (n > 0) {
        path[n] = '\0';
        char *slash = strrchr(path, '/');
        memcpy(slash ? slash + 1 : path, PROGRAM, sizeof PROGRAM);
        sn_child_exec(out, path, whole, size + sizeof kind);
    }
    sn_child_exec(out, SN_MESHER, whole, size + sizeof kind);
    sn_release(whole);
}

sn_status sn_mesher_serve(const char *input, size_t size, sn_child_out *out, sn_error *err)
{
    uint64_t kind = 0;
    if (size >= sizeof kind) memcpy(&kind, input, sizeof kind);
    if (kind == SN_MESHER_TETGEN) return sn_mesher_tetgen(input + sizeof kind, size - sizeof kind, out, err);
    if (kind == SN_MESHER_COREFINE)
        return sn_mesher_corefine(input + sizeof kind, size - sizeof kind, out, err);
    return sn_fail(err, SN_EINTERNAL,
                   PROGRAM ": no job on the standard input; sinew runs this program by itself");
}
