/* context.h - an offscreen OpenGL core profile context.
 *
 * Two back ends, one file each: OSMesa (Mesa's software rasterisers, linked) and EGL without a surface (a GPU
 * where there is one; libEGL is looked for at run time). A context is current in one thread at a time. */
#ifndef SN_RENDER_CONTEXT_H
#define SN_RENDER_CONTEXT_H

#include "base/status.h"

#include <stdbool.h>

typedef enum sn_renderer {
    SN_RENDERER_AUTO,   /* EGL when it gives a GPU, else OSMesa             */
    SN_RENDERER_OSMESA, /* in software, the same pictures on every machine  */
    SN_RENDERER_EGL     /* a GPU, else EGL's own software renderer          */
} sn_renderer;
#define SN_RENDERER_COUNT 3
/* "auto", "osmesa", "egl". */
const char *sn_renderer_name(sn_renderer r);

typedef struct sn_context sn_context; /* opaque */

/* OpenGL 3.3 core or later, current after the call. Errors: SN_ENOMEM, SN_ERENDER: says what the renderer
 * that was asked for lacks, and what to ask for instead. */
SN_MUST_USE sn_status sn_context_create(sn_context **out, sn_renderer renderer, sn_error *err);
SN_MUST_USE sn_status sn_context_make_current(sn_context *c, sn_error *err);
void sn_context_release(
    sn_context *c); /* no context is current in this thread afterwards; it can be in another */
/* GL_RENDERER and GL_VERSION in one line, with the back end unless it is OSMesa; owned by c. */
const char *sn_context_renderer(const sn_context *c);
bool sn_context_is_hardware(const sn_context *c);
/* Address of a GL function, NULL when unknown. A loader may give an address for a name that the context
 * cannot do. */
void *sn_context_proc(const sn_context *c, const char *name);
void sn_context_destroy(sn_context *c); /* NULL is fine; no context is current afterwards when c was */

#endif
