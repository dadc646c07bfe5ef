#include "tetra/mesher.h"

#include "base/alloc.h"
#include "mesh/repair_private.h"

#include <stdint.h>
#include <string.h>

#define PROGRAM "sinew-mesher"

void sn_mesher_exec(sn_child_out *out, sn_mesher_job job, const char *input, size_t size)
{
    uint64_t kind = job;
    char *whole = sn_alloc(size + sizeof kind, 1);
    if (!whole) return;
    memcpy(whole, &kind, sizeof kind);
    memcpy(whole + sizeof kind, input, size);
    sn_child_exec_beside(out, PROGRAM, SN_MESHER, whole, size + sizeof kind);
    sn_release(whole);
}

sn_status sn_mesher_serve(const char *input, size_t size, sn_child_out *out, sn_error *err)
{
    uint64_t kind = 0;
    if (size >= sizeof kind) memcpy(&kind, input, sizeof kind);
    if (kind == SN_MESHER_TETGEN) return sn_mesher_tetgen(input + sizeof kind, size - sizeof kind, out, err);
    if (kind == SN_MESHER_COREFINE)
        return sn_mesher_corefine(input + sizeof kind, size - sizeof kind, out, err);
    if (kind == SN_MESHER_REPAIR) return sn_repair_serve(input, size, out, err);
    return sn_fail(err, SN_EINTERNAL,
                   PROGRAM ": no job on the standard input; sinew runs this program by itself");
}
