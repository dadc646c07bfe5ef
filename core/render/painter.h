/* painter.h - draws pictures of one scene one after another and keeps, from each to the next, the OpenGL
 * context, the compiled shaders, the framebuffers and all that was sent of the scene. Only what has changed
 * is made and sent again: after a camera move nothing is.
 *
 * What has changed is told by the stamps in sn_picture_scene, never found out by comparing: equal stamps
 * promise equal contents. Every picture is the same, to the bit, as that of a new painter.
 *
 * A painter may be used from any thread, by one at a time: its context is current only within a call.
 * Different painters are independent. */
#ifndef SN_RENDER_PAINTER_H
#define SN_RENDER_PAINTER_H

#include "render/picture.h"

typedef struct sn_painter sn_painter; /* opaque */

/* Without a context yet: the first picture makes it. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_painter_create(sn_painter **out, sn_error *err);
/* As sn_picture_draw, with its errors. The picture after one that failed is right all the same. */
SN_MUST_USE sn_status sn_painter_draw(sn_painter *p, const sn_picture_scene *s, const sn_picture_options *opt,
                                      const sn_run *run, sn_image *out, sn_picture_stats *stats,
                                      sn_error *err);
void sn_painter_destroy(sn_painter *p); /* NULL is fine */

#endif
