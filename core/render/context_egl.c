/* context_egl.c - the EGL back end: a context without a surface, on a GPU where there is one. The only file
 * that sees EGL. libEGL is loaded when it is first asked for, so that the program runs where there is none.
 *
 * A display is never terminated: all who ask for the same device share it, in other threads too. */
#include "render/context_driver.h"

#include "base/alloc.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

#define NO_EGL "renderer egl: "
#define ADVICE "; use osmesa"

/* clang-format off */
#define EGL_FUNCTIONS(X) \
    X(PFNEGLQUERYSTRINGPROC, QueryString) X(PFNEGLINITIALIZEPROC, Initialize) X(PFNEGLBINDAPIPROC, BindAPI) \
    X(PFNEGLCHOOSECONFIGPROC, ChooseConfig) X(PFNEGLCREATECONTEXTPROC, CreateContext) \
    X(PFNEGLDESTROYCONTEXTPROC, DestroyContext) X(PFNEGLMAKECURRENTPROC, MakeCurrent) \
    X(PFNEGLGETCURRENTCONTEXTPROC, GetCurrentContext) X(PFNEGLGETERRORPROC, GetError) \
    X(PFNEGLGETPLATFORMDISPLAYEXTPROC, GetPlatformDisplayEXT)
/* clang-format on */

typedef struct egl {
    void *library;
    PFNEGLGETPROCADDRESSPROC GetProcAddress;
#define FIELD(Type, Name) Type Name;
    EGL_FUNCTIONS(FIELD)
#undef FIELD
    EGLDisplay display;
    EGLContext context;
} egl;

enum { max_devices = 64 };

/* ---- the library ---- */

/* Of the library itself, else by its own look-up, which older ones have for extensions only. */
static void *find(const egl *e, const char *name)
{
    void *p = dlsym(e->library, name);
    union {
        __eglMustCastToProperFunctionPointerType call;
        void *object;
    } found = {0};
    if (!p && e->GetProcAddress) found.call = e->GetProcAddress(name);
    return p ? p : found.object;
}

static sn_status load(egl *e, const char *library, sn_error *err)
{
    void *p;
    /* It stays in memory: drivers leave threads and thread-local data behind. */
    e->library = dlopen(library, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    if (!e->library) return sn_fail(err, SN_ERENDER, NO_EGL "%s is not installed" ADVICE, library);
/* ISO C has no cast from a data pointer to a function pointer; copying the bits is what POSIX promises to
 * work. */
#define LOAD(Type, Name)                                                                                     \
    p = find(e, "egl" #Name);                                                                                \
    if (!p) return sn_fail(err, SN_ERENDER, NO_EGL "%s has no function egl" #Name ADVICE, library);          \
    memcpy(&e->Name, &p, sizeof p);
    LOAD(PFNEGLGETPROCADDRESSPROC, GetProcAddress)
    EGL_FUNCTIONS(LOAD)
#undef LOAD
    return SN_OK;
}

/* ---- displays ---- */

static bool has_word(const char *list, const char *word)
{
    size_t n = strlen(word);
    for (const char *at = list; at && (at = strstr(at, word)) != NULL; at += n)
        if ((at == list || at[-1] == ' ') && (at[n] == '\0' || at[n] == ' ')) return true;
    return false;
}

/* The EGL devices; 0 where EGL cannot list them. */
static int list_devices(const egl *e, EGLDeviceEXT device[max_devices])
{
    void *p = find(e, "eglQueryDevicesEXT");
    PFNEGLQUERYDEVICESEXTPROC query;
    memcpy(&query, &p, sizeof p);
    EGLint n = 0;
    const char *known = e->QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (!p || !has_word(known, "EGL_EXT_platform_device") || !query(max_devices, device, &n)) return 0;
    return n;
}

static bool is_software(const egl *e, EGLDeviceEXT device)
{
    void *p = find(e, "eglQueryDeviceStringEXT");
    PFNEGLQUERYDEVICESTRINGEXTPROC query;
    memcpy(&query, &p, sizeof p);
    const char *words = p ? query(device, EGL_EXTENSIONS) : NULL;
    return has_word(words, "EGL_MESA_device_software");
}

/* ---- context ---- */

static EGLContext create_core(const egl *e)
{
    static const EGLint version[][2] = {{4, 5}, {4, 1}, {3, 3}};
    for (size_t i = 0; i < sizeof version / sizeof version[0]; i++) {
        const EGLint want[] = {EGL_CONTEXT_MAJOR_VERSION,
                               version[i][0],
                               EGL_CONTEXT_MINOR_VERSION,
                               version[i][1],
                               EGL_CONTEXT_OPENGL_PROFILE_MASK,
                               EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                               EGL_NONE};
        static const EGLint any[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
        EGLConfig config = NULL;
        EGLint n = 0;
        if (!e->ChooseConfig(e->display, any, &config, 1, &n) || n < 1) config = NULL; /* needs none */
        EGLContext c = e->CreateContext(e->display, config, EGL_NO_CONTEXT, want);
        if (c != EGL_NO_CONTEXT) return c;
    }
    return EGL_NO_CONTEXT;
}

static bool gl_is_hardware(const egl *e)
{
    union {
        __eglMustCastToProperFunctionPointerType found;
        const unsigned char *(*call)(unsigned int);
    } get = {e->GetProcAddress("glGetString")};
    const unsigned char *name = get.found ? get.call(0x1F01) : NULL; /* GL_RENDERER */
    return name && !sn_renderer_is_software((const char *)name);
}

/* On this display, current afterwards. */
static bool try_display(egl *e, EGLDisplay display, bool wants_hardware)
{
    e->display = display;
    if (display == EGL_NO_DISPLAY || !e->Initialize(display, NULL, NULL)) return false;
    if (!has_word(e->QueryString(display, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context")) return false;
    if (!e->BindAPI(EGL_OPENGL_API)) return false;
    e->context = create_core(e);
    if (e->context == EGL_NO_CONTEXT) return false;
    if (e->MakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, e->context) &&
        (!wants_hardware || gl_is_hardware(e)))
        return true;
    (void)e->MakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    (void)e->DestroyContext(display, e->context);
    e->context = EGL_NO_CONTEXT;
    return false;
}

/* The GPUs in EGL's order, then, unless hardware is wanted, what renders in software. */
static bool find_display(egl *e, bool wants_hardware, int *n_device)
{
    EGLDeviceEXT device[max_devices];
    int n = *n_device = list_devices(e, device);
    for (int software = 0; software < (wants_hardware ? 1 : 2); software++)
        for (int i = 0; i < n; i++)
            if (is_software(e, device[i]) == (software == 1) &&
                try_display(e, e->GetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device[i], NULL),
                            wants_hardware))
                return true;
    const char *known = e->QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (!has_word(known, "EGL_MESA_platform_surfaceless") || (wants_hardware && n > 0)) return false;
    return try_display(e, e->GetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL),
                       wants_hardware);
}

static void destroy(void *object);

sn_status sn_context_egl_open(void **out, const char *library, bool wants_hardware, sn_error *err)
{
    egl *e = SN_NEW_ZERO(egl, 1);
    int n_device = 0;
    if (!e) return sn_fail(err, SN_ENOMEM, "OpenGL: no memory for a context");
    sn_status st = load(e, library, err);
    if (!st && !find_display(e, wants_hardware, &n_device))
        st = sn_fail(err, SN_ERENDER,
                     NO_EGL "found %d device%s, none with OpenGL 3.3 or later%s and without a window" ADVICE,
                     n_device, n_device == 1 ? "" : "s", wants_hardware ? " in hardware" : "");
    if (st) {
        destroy(e);
        return st;
    }
    *out = e;
    return SN_OK;
}

static sn_status create(void **out, bool wants_hardware, sn_error *err)
{
    return sn_context_egl_open(out, "libEGL.so.1", wants_hardware, err);
}

static bool make_current(void *object)
{
    egl *e = object;
    return e->BindAPI(EGL_OPENGL_API) &&
           e->MakeCurrent(e->display, EGL_NO_SURFACE, EGL_NO_SURFACE, e->context);
}

static void release(void *object)
{
    egl *e = object;
    if (e->context != EGL_NO_CONTEXT && e->GetCurrentContext() == e->context)
        (void)e->MakeCurrent(e->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

static void *proc(const void *object, const char *name)
{
    const egl *e = object;
    union {
        __eglMustCastToProperFunctionPointerType call;
        void *object;
    } p = {e->GetProcAddress(name)};
    return p.object;
}

static void destroy(void *object)
{
    egl *e = object;
    if (e->context != EGL_NO_CONTEXT) {
        release(e);
        (void)e->DestroyContext(e->display, e->context);
    }
    if (e->library) (void)dlclose(e->library);
    sn_release(e);
}

const sn_context_driver sn_context_egl = {"EGL, ", create, make_current, release, proc, destroy};
