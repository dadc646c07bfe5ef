/* sinew.h - everything: curves to tissue fields to muscles.
 *
 * Conventions of all headers. Functions that can fail return sn_status (0 = SN_OK), take the caller's sn_error last and
 * leave their outputs empty or untouched on failure. Right-handed coordinates; lengths in the scene's unit; indices
 * 0-based. Long functions take a sn_run (base/run.h). The library never prints or exits; the allocator hook is its only
 * global state. */
#ifndef SN_SINEW_H
#define SN_SINEW_H

#include "base/alloc.h"
#include "base/array.h"
#include "base/child.h"
#include "base/file.h"
#include "base/notes.h"
#include "base/run.h"
#include "base/status.h"
#include "base/vec3.h"
#include "extract/extraction.h"
#include "extract/part_fibers.h"
#include "field/attachment.h"
#include "field/cholesky.h"
#include "field/fiber.h"
#include "field/harmonic.h"
#include "field/laplacian.h"
#include "field/measure.h"
#include "field/segmentation.h"
#include "field/tendon.h"
#include "field/tensor.h"
#include "field/tissue.h"
#include "mesh/bvh.h"
#include "mesh/mesh_check.h"
#include "mesh/polygonize.h"
#include "mesh/polylines.h"
#include "mesh/predicates.h"
#include "mesh/remesh.h"
#include "mesh/shape.h"
#include "mesh/surface_io.h"
#include "mesh/tet_io.h"
#include "mesh/tet_mesh.h"
#include "mesh/tri_mesh.h"
#include "muscle/collocation.h"
#include "muscle/head.h"
#include "muscle/muscle.h"
#include "muscle/path.h"
#include "muscle/spline.h"
#include "muscle/spline_fit.h"
#include "muscle/stroke.h"
#include "render/camera.h"
#include "render/context.h"
#include "render/image.h"
#include "render/image_draw.h"
#include "render/picture.h"
#include "scene/scene.h"
#include "scene/scene_stroke.h"
#include "tetra/body.h"
#include "tetra/locate.h"
#include "tetra/trace.h"

#endif
