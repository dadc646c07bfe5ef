#include "render/context.h"

#include "base/alloc.h"
#include "render/context_driver.h"

#include <GL/glcorearb.h>
#include <stdio.h>
#include <string.h>

struct sn_context {
    const sn_context_driver *driver;
    void *object; /* the driver's */
    char renderer[160];
    bool is_hardware;
};

static const char *const renderer_names[SN_RENDERER_COUNT] = {"auto", "osmesa", "egl"};

const char *sn_renderer_name(sn_renderer r)
{
    return renderer_names[r];
}

bool sn_renderer_is_software(const char *gl_renderer)
{
    static const char *const names[] = {"llvmpipe", "softpipe", "swrast", "SWR", "Software", "SwiftShader"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (strstr(gl_renderer, names[i])) return true;
    return false;
}

/* Read through a union: ISO C has no cast between the two kinds of pointer. */
static const char *gl_string(const sn_context *c, GLenum name)
{
    union {
        void *object;
        PFNGLGETSTRINGPROC call;
    } get = {sn_context_proc(c, "glGetString")};
    const GLubyte *s = get.object ? get.call(name) : NULL;
    return s ? (const char *)s : "unknown";
}

static sn_status create_with(sn_context **out, const sn_context_driver *d, bool wants_hardware, sn_error *err)
{
    sn_context *c = SN_NEW_ZERO(sn_context, 1);
    if (!c) return sn_fail(err, SN_ENOMEM, "OpenGL: no memory for a context");
    c->driver = d;
    sn_status st = d->create(&c->object, wants_hardware, err);
    if (!st) st = sn_context_make_current(c, err);
    if (st) {
        sn_context_destroy(c);
        return st;
    }
    const char *name = gl_string(c, GL_RENDERER);
    c->is_hardware = !sn_renderer_is_software(name);
    (void)snprintf(c->renderer, sizeof c->renderer, "%s%s, OpenGL %s", d->prefix, name,
                   gl_string(c, GL_VERSION));
    *out = c;
    return SN_OK;
}

sn_status sn_context_create(sn_context **out, sn_renderer renderer, sn_error *err)
{
    *out = NULL;
    if (renderer == SN_RENDERER_EGL) return create_with(out, &sn_context_egl, false, err);
    if (renderer == SN_RENDERER_AUTO) {
        sn_error none; /* no GPU is no error here */
        sn_status st = create_with(out, &sn_context_egl, true, &none);
        if (st == SN_ENOMEM && err) *err = none;
        if (st == SN_OK || st == SN_ENOMEM) return st;
    }
    return create_with(out, &sn_context_osmesa, false, err);
}

sn_status sn_context_make_current(sn_context *c, sn_error *err)
{
    if (c->driver->make_current(c->object)) return SN_OK;
    return sn_fail(err, SN_ERENDER,
                   "OpenGL: the context cannot be made current; is it in use in another thread?");
}

void sn_context_release(sn_context *c)
{
    c->driver->release(c->object);
}

const char *sn_context_renderer(const sn_context *c)
{
    return c->renderer;
}

bool sn_context_is_hardware(const sn_context *c)
{
    return c->is_hardware;
}

void *sn_context_proc(const sn_context *c, const char *name)
{
    return c->driver->proc(c->object, name);
}

void sn_context_destroy(sn_context *c)
{
    if (!c) return;
    if (c->object) c->driver->destroy(c->object);
    sn_release(c);
}
