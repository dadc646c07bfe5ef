/* context_osmesa.c - the OSMesa back end (Mesa's software rasterisers). The only file that sees OSMesa, which
 * Mesa 25.1 dropped. llvmpipe takes its thread count from LP_NUM_THREADS. */
#include "render/context_driver.h"

#include "base/alloc.h"

#include <GL/osmesa.h>

enum { surface_side = 16 }; /* the default framebuffer is never drawn to */

typedef struct osmesa {
    OSMesaContext context;
    unsigned char surface[4 * surface_side * surface_side];
} osmesa;

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

static sn_status create(void **out, bool wants_hardware, sn_error *err)
{
    (void)wants_hardware; /* nobody asks OSMesa for it */
    osmesa *c = SN_NEW_ZERO(osmesa, 1);
    if (!c) return sn_fail(err, SN_ENOMEM, "OpenGL: no memory for a context");
    c->context = create_core();
    if (!c->context) {
        sn_release(c);
        return sn_fail(err, SN_ERENDER,
                       "OpenGL: OSMesa gave no context, need a core profile of version 3.3 or later");
    }
    *out = c;
    return SN_OK;
}

static bool make_current(void *object)
{
    osmesa *c = object;
    return OSMesaMakeCurrent(c->context, c->surface, GL_UNSIGNED_BYTE, surface_side, surface_side);
}

static void release(void *object)
{
    osmesa *c = object;
    if (OSMesaGetCurrentContext() == c->context) (void)OSMesaMakeCurrent(NULL, NULL, 0, 0, 0);
}

static void *proc(const void *object, const char *name)
{
    (void)object;
    union {
        OSMESAproc call;
        void *object;
    } p = {OSMesaGetProcAddress(name)};
    return p.object;
}

static void destroy(void *object)
{
    osmesa *c = object;
    release(c);
    OSMesaDestroyContext(c->context);
    sn_release(c);
}

const sn_context_driver sn_context_osmesa = {"", create, make_current, release, proc, destroy};
