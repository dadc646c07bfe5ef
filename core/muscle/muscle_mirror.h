/* muscle_mirror.h - the mirror image of a muscle. */
#ifndef SN_MUSCLE_MUSCLE_MIRROR_H
#define SN_MUSCLE_MUSCLE_MIRROR_H

#include "base/plane.h"
#include "muscle/muscle.h"

/* m reflected in the plane, under another name: same tissue values, origin still first. Its frame is such
 * that e1 and e3 are the images of m's, so that fibers lean the mirrored way; e2, to be right-handed, is the
 * image of m's turned round, which no diffusion and no aponeurosis can tell apart. A muscle whose fibers
 * follow a frame that it does not set gets one, with the eigenvalues 1. out: zero-initialised; zero again on
 * error. Errors: SN_ENOMEM, SN_EINVAL (points that reflection makes equal by rounding). */
SN_MUST_USE sn_status sn_muscle_mirror(sn_muscle *out, const sn_muscle *m, const sn_plane *plane,
                                       const char *name, sn_error *err);

#endif
