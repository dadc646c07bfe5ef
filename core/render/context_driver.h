/* context_driver.h - what a back end gives context.c. Internal to core/render. */
#ifndef SN_RENDER_CONTEXT_DRIVER_H
#define SN_RENDER_CONTEXT_DRIVER_H

#include "render/context.h"

typedef struct sn_context_driver {
    const char *prefix; /* of the renderer's name */
    /* Of version 3.3 core or later. wants_hardware: no software renderer will do. */
    sn_status (*create)(void **out, bool wants_hardware, sn_error *err);
    bool (*make_current)(void *object);
    void (*release)(void *object); /* the object may be current or not */
    void *(*proc)(const void *object, const char *name);
    void (*destroy)(void *object);
} sn_context_driver;

extern const sn_context_driver sn_context_osmesa, sn_context_egl;

/* sn_context_egl.create with this library in the place of libEGL. */
sn_status sn_context_egl_open(void **out, const char *library, bool wants_hardware, sn_error *err);

/* Does GL_RENDERER name one of the rasterisers that run on the CPU? */
bool sn_renderer_is_software(const char *gl_renderer);

#endif
