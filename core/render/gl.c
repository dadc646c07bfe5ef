#include "render/gl.h"

#include <stdint.h>
#include <string.h>

sn_status sn_gl_load(sn_gl *gl, const sn_context *c, sn_error *err)
{
    memset(gl, 0, sizeof *gl);
    void *p;
/* ISO C has no cast from a data pointer to a function pointer; copying the bits is what POSIX promises to
 * work. */
#define LOAD(UPPER, Name)                                                                                    \
    p = sn_context_proc(c, "gl" #Name);                                                                      \
    if (!p) return sn_fail(err, SN_ERENDER, "OpenGL: function gl" #Name " is missing, need version 3.3");    \
    memcpy(&gl->Name, &p, sizeof p);
    SN_GL_FUNCTIONS(LOAD)
#undef LOAD
    return SN_OK;
}

sn_status sn_gl_check(const sn_gl *gl, const char *step, sn_error *err)
{
    GLenum code = gl->GetError();
    if (code == GL_NO_ERROR) return SN_OK;
    if (code == GL_OUT_OF_MEMORY) return sn_fail(err, SN_ENOMEM, "OpenGL ran out of memory while %s", step);
    return sn_fail(err, SN_ERENDER, "OpenGL error 0x%04x while %s", code, step);
}

static sn_status compile(const sn_gl *gl, const char *name, GLenum kind, const char *const *source,
                         GLuint *out, sn_error *err)
{
    GLsizei n = 0;
    while (source[n]) n++;
    *out = gl->CreateShader(kind);
    gl->ShaderSource(*out, n, source, NULL);
    gl->CompileShader(*out);
    GLint is_good = 0;
    gl->GetShaderiv(*out, GL_COMPILE_STATUS, &is_good);
    if (is_good) return SN_OK;
    char log[400] = "";
    gl->GetShaderInfoLog(*out, sizeof log, NULL, log);
    return sn_fail(err, SN_ERENDER, "OpenGL: %s %s shader does not compile: %s", name,
                   kind == GL_VERTEX_SHADER ? "vertex" : "fragment", log);
}

sn_status sn_gl_program(const sn_gl *gl, const char *name, const char *const *vertex,
                        const char *const *fragment, GLuint *program, sn_error *err)
{
    GLuint vs, fs;
    *program = 0;
    sn_status st = compile(gl, name, GL_VERTEX_SHADER, vertex, &vs, err);
    if (!st) st = compile(gl, name, GL_FRAGMENT_SHADER, fragment, &fs, err);
    if (st) return st;
    *program = gl->CreateProgram();
    gl->AttachShader(*program, vs);
    gl->AttachShader(*program, fs);
    gl->LinkProgram(*program);
    GLint is_good = 0;
    gl->GetProgramiv(*program, GL_LINK_STATUS, &is_good);
    if (is_good) return SN_OK;
    char log[400] = "";
    gl->GetProgramInfoLog(*program, sizeof log, NULL, log);
    return sn_fail(err, SN_ERENDER, "OpenGL: %s program does not link: %s", name, log);
}

GLuint sn_gl_buffer(const sn_gl *gl, GLenum target, const void *data, size_t size)
{
    GLuint b;
    gl->GenBuffers(1, &b);
    gl->BindBuffer(target, b);
    gl->BufferData(target, (GLsizeiptr)size, data, GL_STATIC_DRAW);
    return b;
}

void sn_gl_delete_buffer(const sn_gl *gl, GLuint *buffer)
{
    if (*buffer) gl->DeleteBuffers(1, buffer);
    *buffer = 0;
}

void sn_gl_delete_texture(const sn_gl *gl, GLuint *texture)
{
    if (*texture) gl->DeleteTextures(1, texture);
    *texture = 0;
}

void sn_gl_delete_frame(const sn_gl *gl, GLuint *frame)
{
    if (*frame) gl->DeleteFramebuffers(1, frame);
    *frame = 0;
}

sn_gl_texels sn_gl_buffer_texture(const sn_gl *gl, GLenum format, const void *data, size_t size)
{
    sn_gl_texels t = {.buffer = sn_gl_buffer(gl, GL_TEXTURE_BUFFER, data, size)};
    gl->GenTextures(1, &t.texture);
    gl->BindTexture(GL_TEXTURE_BUFFER, t.texture);
    gl->TexBuffer(GL_TEXTURE_BUFFER, format, t.buffer);
    return t;
}

void sn_gl_delete_texels(const sn_gl *gl, sn_gl_texels *t)
{
    sn_gl_delete_texture(gl, &t->texture);
    sn_gl_delete_buffer(gl, &t->buffer);
}

void sn_gl_attribute(const sn_gl *gl, GLuint i, GLint size, GLenum type, bool is_normalized, size_t stride,
                     size_t offset)
{
    gl->EnableVertexAttribArray(i);
    gl->VertexAttribPointer(i, size, type, is_normalized ? GL_TRUE : GL_FALSE, (GLsizei)stride,
                            (const void *)(uintptr_t)offset);
}

sn_gl_mesh sn_gl_vertex_array(const sn_gl *gl, int n_attrib, const float *data, size_t n_vert)
{
    sn_gl_mesh m = {.n = (GLsizei)n_vert};
    gl->GenVertexArrays(1, &m.array);
    gl->BindVertexArray(m.array);
    size_t stride = 3 * sizeof *data * (size_t)n_attrib;
    m.buffer = sn_gl_buffer(gl, GL_ARRAY_BUFFER, data, n_vert * stride);
    for (int i = 0; i < n_attrib; i++)
        sn_gl_attribute(gl, (GLuint)i, 3, GL_FLOAT, false, stride, 3 * sizeof *data * (size_t)i);
    return m;
}

void sn_gl_delete_mesh(const sn_gl *gl, sn_gl_mesh *m)
{
    if (m->array) gl->DeleteVertexArrays(1, &m->array);
    sn_gl_delete_buffer(gl, &m->buffer);
    sn_gl_delete_buffer(gl, &m->index);
    memset(m, 0, sizeof *m);
}

void sn_gl_draw(const sn_gl *gl, const sn_gl_mesh *m, GLenum shape)
{
    if (m->n == 0) return;
    gl->BindVertexArray(m->array);
    if (m->index)
        gl->DrawElements(shape, m->n, GL_UNSIGNED_INT, NULL);
    else
        gl->DrawArrays(shape, 0, m->n);
}

void sn_gl_sampler(const sn_gl *gl, GLuint program, const char *name, int unit, GLenum target, GLuint texture)
{
    gl->ActiveTexture(GL_TEXTURE0 + (GLenum)unit);
    gl->BindTexture(target, texture);
    gl->Uniform1i(gl->GetUniformLocation(program, name), unit);
}

GLuint sn_gl_target(const sn_gl *gl, GLint format, int width, int height)
{
    bool is_depth = format == GL_DEPTH32F_STENCIL8, is_float = format == GL_RGBA16F || format == GL_RG32F;
    GLuint t;
    gl->GenTextures(1, &t);
    gl->BindTexture(GL_TEXTURE_2D, t);
    gl->TexImage2D(GL_TEXTURE_2D, 0, format, width, height, 0, is_depth ? GL_DEPTH_STENCIL : GL_RGBA,
                   is_depth   ? GL_FLOAT_32_UNSIGNED_INT_24_8_REV
                   : is_float ? GL_FLOAT
                              : GL_UNSIGNED_BYTE,
                   NULL);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return t;
}
