/* context.h - an offscreen OpenGL core profile context. One file per back end; OSMesa (llvmpipe) is the
 * first. A context belongs to the thread that made it. */
#ifndef SN_RENDER_CONTEXT_H
#define SN_RENDER_CONTEXT_H

#include "base/status.h"

typedef struct sn_context sn_context; /* opaque */

/* OpenGL 3.3 core or later, current after the call. Errors: SN_ERENDER. */
SN_MUST_USE sn_status sn_context_create(sn_context **out, sn_error *err);
SN_MUST_USE sn_status sn_context_make_current(sn_context *c, sn_error *err);
const char *sn_context_renderer(const sn_context *c); /* GL_RENDERER and GL_VERSION in one line, owned by c */
/* Address of a GL function, NULL when unknown. A loader may give an address for a name that the context
 * cannot do. */
void *sn_context_proc(const char *name);
void sn_context_destroy(sn_context *c); /* NULL is fine; no context is current afterwards when c was */

#endif
