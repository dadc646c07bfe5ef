/* trace.h - the pieces that the tets cut a piecewise cubic curve into, found by walking from tet to tet. */
#ifndef SN_TETRA_TRACE_H
#define SN_TETRA_TRACE_H

#include "mesh/cubic.h"
#include "tetra/body.h"
#include "tetra/locate.h"

typedef struct sn_trace_piece { /* one stay of the curve in one tet */
    int32_t tet;
    int32_t i_seg;  /* cubic that the piece's middle lies on                             */
    double s;       /* parameter of the middle (by parameter) on it                      */
    double length;  /* of the piece, > 0                                                 */
    double bary[4]; /* of the middle, clamped to >= 0, sum 1                             */
} sn_trace_piece;

typedef struct sn_trace {
    sn_trace_piece *piece; /* in curve order, owned                                             */
    size_t n_piece;
    double length_inside, length_outside;
} sn_trace;

void sn_trace_free(sn_trace *t); /* t: zero-initialised or filled */
/* Pieces inside the body. Where the curve leaves through a bone or the skin it is followed until it comes
 * back in (returns shorter than 1/1000 of a cubic may be missed). No piece: SN_OK with n_piece = 0. Errors:
 * SN_ENOMEM. */
SN_MUST_USE sn_status sn_trace_curve(const sn_body *b, const sn_locator *l, const sn_cubic *curve,
                                     int32_t n_seg, sn_trace *out, sn_error *err);

#endif
