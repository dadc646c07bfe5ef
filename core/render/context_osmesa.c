/* context_osmesa.c - the OSMesa back end (Mesa's software rasterisers). The only file that sees OSMesa:
 * Mesa 25.1 dropped it, so another back end would stand beside this file. llvmpipe takes its thread count
 * from LP_NUM_THREADS. */
#include "render/context.h"

#include "base/alloc.h"

#include <GL/osmesa.h>
#include <stdio.h>
#include <string.h>

enum { surface_side = 16 }; /* the default framebuffer is never drawn to */

struct sn_context {
    OSMesaContext mesa;
    char renderer[160];
    unsigned char surface[4 * surface_side * surface_side];
};

/* Asks for the newest version first: an implementation may give no more than was asked for. */
static OSMesaContext create_core(void)
{
    static const int version[][2] = {{4, 5}, {4, 3}, {4, 1}, {3, 3}};
    for (size_t i = 0; i < sizeof version / sizeof version[0]; i++) {
        const int want[] = {OSMESA_FORMAT,
                            OSMESA_RGBA,
                            OSMESA_DEPTH_BITS,
                            24,
                            OSMESA_PROFILE,
                            OSMESA_CORE_PROFILE,
                            OSMESA_CONTEXT_MAJOR_VERSION,
                            version[i][0],
                            OSMESA_CONTEXT_MINOR_VERSION,
                            version[i][1],
                            0,
                            0};
        OSMesaContext c = OSMesaCreateContextAttribs(want, NULL);
        if (c) return c;
    }
    return NULL;
}

typedef const GLubyte *(*get_string_fn)(GLenum);

/* A function address, read through a union: ISO C has no cast between the two kinds of pointer. */
static const char *gl_string(GLenum name)
{
    union {
        void *object;
        get_string_fn call;
    } get = {sn_context_proc("glGetString")};
    const GLubyte *s = get.object ? get.call(name) : NULL;
    return s ? (const char *)s : "unknown";
}

sn_status sn_context_create(sn_context **out, sn_error *err)
{
    *out = NULL;
    sn_context *c = SN_NEW_ZERO(sn_context, 1);
    if (!c) return sn_fail(err, SN_ENOMEM, "OpenGL: no memory for a context");
    c->mesa = create_core();
    if (!c->mesa) {
        sn_release(c);
        return sn_fail(err, SN_ERENDER,
                       "OpenGL: OSMesa gave no context, need a core profile of version 3.3 or later");
    }
    sn_status st = sn_context_make_current(c, err);
    if (st) {
        sn_context_destroy(c);
        return st;
    }
    (void)snprintf(c->renderer, sizeof c->renderer, "%s, OpenGL %s", gl_string(GL_RENDERER),
                   gl_string(GL_VERSION));
    *out = c;
    return SN_OK;
}

sn_status sn_context_make_current(sn_context *c, sn_error *err)
{
    if (OSMesaMakeCurrent(c->mesa, c->surface, GL_UNSIGNED_BYTE, surface_side, surface_side)) return SN_OK;
    return sn_fail(err, SN_ERENDER, "OpenGL: OSMesa cannot make its context current");
}

const char *sn_context_renderer(const sn_context *c)
{
    return c->renderer;
}

void *sn_context_proc(const char *name)
{
    union {
        OSMESAproc call;
        void *object;
    } p = {OSMesaGetProcAddress(name)};
    return p.object;
}

void sn_context_destroy(sn_context *c)
{
    if (!c) return;
    if (OSMesaGetCurrentContext() == c->mesa) (void)OSMesaMakeCurrent(NULL, NULL, 0, 0, 0);
    OSMesaDestroyContext(c->mesa);
    sn_release(c);
}
