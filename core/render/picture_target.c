/* picture_target.c - the framebuffers of a tile, and the passes that turn what was drawn into light. */
#include "render/draw.h"

#include "render/shaders.h"

static const double occlusion_radius = 0.030; /* of the scene's unit */
enum { occlusion_pixels = 120 }; /* its bound on the tile, samples: see the margin in picture.c */

static sn_status make_frame(const sn_gl *gl, GLuint *frame, GLuint color0, GLuint color1, GLuint depth,
                            sn_error *err)
{
    static const GLenum both[2] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    gl->GenFramebuffers(1, frame);
    gl->BindFramebuffer(GL_FRAMEBUFFER, *frame);
    gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, color0, 0);
    if (color1) gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT1, GL_TEXTURE_2D, color1, 0);
    if (depth) gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_TEXTURE_2D, depth, 0);
    gl->DrawBuffers(color1 ? 2 : 1, both);
    GLenum state = gl->CheckFramebufferStatus(GL_FRAMEBUFFER);
    if (state == GL_FRAMEBUFFER_COMPLETE) return SN_OK;
    return sn_fail(err, SN_ERENDER, "OpenGL: a framebuffer is not complete (0x%04x)", state);
}

static void make_textures(sn_targets *t, const sn_gl *gl, int w, int h)
{
    t->color = sn_gl_target(gl, GL_RGBA8, w, h);
    t->shape = sn_gl_target(gl, GL_RGBA16F, w, h);
    t->depth = sn_gl_target(gl, GL_DEPTH32F_STENCIL8, w, h);
    t->open = sn_gl_target(gl, GL_RGBA8, w, h);
    t->picture = sn_gl_target(gl, GL_RGBA16F, w, h);
    if (t->has_skin) {
        t->skin_sum = sn_gl_target(gl, GL_RGBA16F, w, h);
        t->skin_weight = sn_gl_target(gl, GL_RGBA16F, w, h);
    }
    if (t->has_lines) {
        t->line = sn_gl_target(gl, GL_RGBA16F, w, h);
        t->line_depth = sn_gl_target(gl, GL_DEPTH32F_STENCIL8, w, h);
    }
}

sn_status sn_targets_create(sn_targets *t, const sn_frame *f, int width, int height, sn_error *err)
{
    const sn_gl *gl = &f->gl;
    make_textures(t, gl, width, height);
    sn_status st = sn_gl_check(gl, "making framebuffers", err);
    if (!st) st = make_frame(gl, &t->solid_frame, t->color, t->shape, t->depth, err);
    if (!st) st = make_frame(gl, &t->open_frame, t->open, 0, 0, err);
    if (!st) st = make_frame(gl, &t->picture_frame, t->picture, 0, 0, err);
    if (!st && t->has_skin) st = make_frame(gl, &t->skin_frame, t->skin_sum, t->skin_weight, t->depth, err);
    if (!st && t->has_lines) st = make_frame(gl, &t->line_frame, t->line, 0, t->line_depth, err);
    if (!st)
        st = sn_gl_program(gl, "occlusion", sn_shader_screen_vs, sn_shader_occlusion_fs,
                           &t->occlusion_program, err);
    if (!st) st = sn_gl_program(gl, "final", sn_shader_screen_vs, sn_shader_final_fs, &t->final_program, err);
    if (!st) gl->GenVertexArrays(1, &t->screen);
    return st;
}

void sn_targets_begin(const sn_targets *t, const sn_frame *f, GLuint frame)
{
    static const float none[4] = {0}, clear_view[4] = {0, 0, 0, 1};
    const sn_gl *gl = &f->gl;
    gl->BindFramebuffer(GL_FRAMEBUFFER, frame);
    gl->Viewport(0, 0, f->tile.width, f->tile.height);
    gl->ClearBufferfv(GL_COLOR, 0, frame == t->skin_frame ? clear_view : none);
    if (frame == t->solid_frame || frame == t->skin_frame) gl->ClearBufferfv(GL_COLOR, 1, none);
    if (frame == t->solid_frame || frame == t->line_frame) gl->ClearBufferfi(GL_DEPTH_STENCIL, 0, 1.0f, 0);
}

/* Uniforms of the passes over the whole tile. */
static void use_screen(const sn_targets *t, const sn_frame *f, GLuint program)
{
    const sn_gl *gl = &f->gl;
    gl->UseProgram(program);
    sn_gl_sampler(gl, program, "u_depth_map", 0, GL_TEXTURE_2D, t->depth);
    sn_gl_sampler(gl, program, "u_shape", 1, GL_TEXTURE_2D, t->shape);
    gl->Uniform2f(gl->GetUniformLocation(program, "u_depth"), f->depth[0], f->depth[1]);
    gl->Uniform2f(gl->GetUniformLocation(program, "u_origin"), (float)f->tile.x - 0.5f * (float)f->width,
                  (float)f->tile.y - 0.5f * (float)f->height);
    gl->Uniform1f(gl->GetUniformLocation(program, "u_slope"), f->slope);
    gl->Uniform2i(gl->GetUniformLocation(program, "u_size"), f->tile.width, f->tile.height);
}

static void draw_screen(const sn_targets *t, const sn_frame *f)
{
    f->gl.Disable(GL_DEPTH_TEST);
    f->gl.BindVertexArray(t->screen);
    f->gl.DrawArrays(GL_TRIANGLES, 0, 3);
    f->gl.Enable(GL_DEPTH_TEST);
}

void sn_targets_occlusion(const sn_targets *t, const sn_frame *f)
{
    const sn_gl *gl = &f->gl;
    sn_targets_begin(t, f, t->open_frame);
    use_screen(t, f, t->occlusion_program);
    gl->Uniform1f(gl->GetUniformLocation(t->occlusion_program, "u_radius"),
                  (float)(occlusion_radius * f->unit));
    gl->Uniform1f(gl->GetUniformLocation(t->occlusion_program, "u_max_pixels"), (float)occlusion_pixels);
    draw_screen(t, f);
}

void sn_targets_final(const sn_targets *t, const sn_frame *f)
{
    const sn_gl *gl = &f->gl;
    GLuint p = t->final_program;
    sn_targets_begin(t, f, t->picture_frame);
    use_screen(t, f, p);
    sn_gl_sampler(gl, p, "u_color", 2, GL_TEXTURE_2D, t->color);
    sn_gl_sampler(gl, p, "u_open", 3, GL_TEXTURE_2D, t->open);
    sn_gl_sampler(gl, p, "u_skin_sum", 4, GL_TEXTURE_2D, t->has_skin ? t->skin_sum : t->color);
    sn_gl_sampler(gl, p, "u_skin_weight", 5, GL_TEXTURE_2D, t->has_skin ? t->skin_weight : t->color);
    sn_gl_sampler(gl, p, "u_line", 6, GL_TEXTURE_2D, t->has_lines ? t->line : t->color);
    sn_gl_sampler(gl, p, "u_line_depth", 7, GL_TEXTURE_2D, t->has_lines ? t->line_depth : t->depth);
    gl->Uniform3f(gl->GetUniformLocation(p, "u_show"), t->has_skin ? 1.0f : 0.0f, t->has_lines ? 1.0f : 0.0f,
                  0.0f);
    gl->Uniform1f(gl->GetUniformLocation(p, "u_unit"), (float)f->unit);
    gl->Uniform1i(gl->GetUniformLocation(p, "u_samples"), f->samples);
    draw_screen(t, f);
}
