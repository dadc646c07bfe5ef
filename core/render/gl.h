/* gl.h - the OpenGL 3.3 functions that the picture needs, found at run time, and a few helpers around them.
 *
 * What a context still has when it is destroyed goes with it. */
#ifndef SN_RENDER_GL_H
#define SN_RENDER_GL_H

#include "render/context.h"

#include <GL/glcorearb.h>
#include <stdbool.h>
#include <stddef.h>

/* clang-format off */
#define SN_GL_FUNCTIONS(X) \
    X(ACTIVETEXTURE, ActiveTexture) X(ATTACHSHADER, AttachShader) X(BINDBUFFER, BindBuffer) \
    X(BINDFRAMEBUFFER, BindFramebuffer) X(BINDTEXTURE, BindTexture) X(BINDVERTEXARRAY, BindVertexArray) \
    X(BLENDFUNCSEPARATE, BlendFuncSeparate) X(BUFFERDATA, BufferData) \
    X(CHECKFRAMEBUFFERSTATUS, CheckFramebufferStatus) X(CLEARBUFFERFI, ClearBufferfi) \
    X(CLEARBUFFERFV, ClearBufferfv) X(COLORMASK, ColorMask) X(COMPILESHADER, CompileShader) \
    X(CREATEPROGRAM, CreateProgram) X(CREATESHADER, CreateShader) X(CULLFACE, CullFace) X(DEPTHFUNC, DepthFunc) \
    X(DELETEBUFFERS, DeleteBuffers) \
    X(DELETEFRAMEBUFFERS, DeleteFramebuffers) X(DELETETEXTURES, DeleteTextures) \
    X(DELETEVERTEXARRAYS, DeleteVertexArrays) X(DEPTHMASK, DepthMask) X(DISABLE, Disable) X(DRAWARRAYS, DrawArrays) X(DRAWBUFFERS, DrawBuffers) \
    X(DRAWELEMENTS, DrawElements) X(ENABLE, Enable) X(ENABLEVERTEXATTRIBARRAY, EnableVertexAttribArray) \
    X(FRAMEBUFFERTEXTURE2D, FramebufferTexture2D) X(GENBUFFERS, GenBuffers) X(GENFRAMEBUFFERS, GenFramebuffers) \
    X(GENTEXTURES, GenTextures) X(GENVERTEXARRAYS, GenVertexArrays) X(GETERROR, GetError) \
    X(GETINTEGERV, GetIntegerv) X(GETPROGRAMINFOLOG, GetProgramInfoLog) X(GETPROGRAMIV, GetProgramiv) \
    X(GETSHADERINFOLOG, GetShaderInfoLog) X(GETSHADERIV, GetShaderiv) X(GETUNIFORMLOCATION, GetUniformLocation) \
    X(LINKPROGRAM, LinkProgram) X(POLYGONOFFSET, PolygonOffset) X(READBUFFER, ReadBuffer) X(READPIXELS, ReadPixels) \
    X(SCISSOR, Scissor) X(SHADERSOURCE, ShaderSource) X(STENCILFUNC, StencilFunc) X(STENCILOP, StencilOp) \
    X(STENCILOPSEPARATE, StencilOpSeparate) X(TEXBUFFER, TexBuffer) X(TEXIMAGE2D, TexImage2D) \
    X(TEXPARAMETERI, TexParameteri) X(UNIFORM1F, Uniform1f) X(UNIFORM1I, Uniform1i) X(UNIFORM2F, Uniform2f) X(UNIFORM2I, Uniform2i) \
    X(UNIFORM3F, Uniform3f) X(UNIFORM4F, Uniform4f) X(UNIFORMMATRIX3FV, UniformMatrix3fv) \
    X(UNIFORMMATRIX4FV, UniformMatrix4fv) X(USEPROGRAM, UseProgram) X(VERTEXATTRIBPOINTER, VertexAttribPointer) \
    X(VIEWPORT, Viewport)
/* clang-format on */

typedef struct sn_gl {
#define SN_GL_FIELD(UPPER, Name) PFNGL##UPPER##PROC Name;
    SN_GL_FUNCTIONS(SN_GL_FIELD)
#undef SN_GL_FIELD
} sn_gl;

/* The functions of c, which is current. Errors: SN_ERENDER (names the first function that is missing). */
SN_MUST_USE sn_status sn_gl_load(sn_gl *gl, const sn_context *c, sn_error *err);
/* glGetError into SN_ERENDER or, when GL ran out of memory, SN_ENOMEM. `step` says what was done. */
SN_MUST_USE sn_status sn_gl_check(const sn_gl *gl, const char *step, sn_error *err);
/* name is for messages. vertex and fragment: lists of sources, NULL-ended, joined in order.
 * Errors: SN_ERENDER with GL's log. */
SN_MUST_USE sn_status sn_gl_program(const sn_gl *gl, const char *name, const char *const *vertex,
                                    const char *const *fragment, GLuint *program, sn_error *err);
/* A buffer with a copy of data. target: GL_ARRAY_BUFFER etc.; stays bound there. */
GLuint sn_gl_buffer(const sn_gl *gl, GLenum target, const void *data, size_t size);
/* Deletes one object; 0 is fine. */
void sn_gl_delete_buffer(const sn_gl *gl, GLuint *buffer);
void sn_gl_delete_texture(const sn_gl *gl, GLuint *texture);
void sn_gl_delete_frame(const sn_gl *gl, GLuint *frame);
typedef struct sn_gl_texels { /* a buffer texture */
    GLuint texture, buffer;
} sn_gl_texels;
/* Over a copy of data. Sizes beyond GL_MAX_TEXTURE_BUFFER_SIZE texels are the caller's to avoid. */
sn_gl_texels sn_gl_buffer_texture(const sn_gl *gl, GLenum format, const void *data, size_t size);
void sn_gl_delete_texels(const sn_gl *gl, sn_gl_texels *t);

typedef struct sn_gl_mesh {      /* vertices to be drawn */
    GLuint array, buffer, index; /* index: 0 when there is none */
    GLsizei n;                   /* vertices, or indices        */
} sn_gl_mesh;
/* Of one buffer of n_attrib attributes of 3 floats each, interleaved, that are drawn in order. Stays bound.
 */
sn_gl_mesh sn_gl_vertex_array(const sn_gl *gl, int n_attrib, const float *data, size_t n_vert);
void sn_gl_delete_mesh(const sn_gl *gl, sn_gl_mesh *m); /* 0 is fine */
void sn_gl_draw(const sn_gl *gl, const sn_gl_mesh *m, GLenum shape);
/* Tells attribute i of the bound vertex array where it is in the bound buffer. */
void sn_gl_attribute(const sn_gl *gl, GLuint i, GLint size, GLenum type, bool is_normalized, size_t stride,
                     size_t offset);
/* Binds texture to unit and tells the sampler of the current program. */
void sn_gl_sampler(const sn_gl *gl, GLuint program, const char *name, int unit, GLenum target,
                   GLuint texture);
/* An unfiltered 2D texture, values not set. */
GLuint sn_gl_target(const sn_gl *gl, GLint format, int width, int height);

#endif
