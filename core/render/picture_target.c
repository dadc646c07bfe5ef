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

static sn_status make_solid(sn_targets *t, const sn_gl *gl, int w, int h, sn_error *err)
{
    t->color = sn_gl_target(gl, GL_RGBA16F, w, h);
    t->shape = sn_gl_target(gl, GL_RGBA16F, w, h);
    t->depth = sn_gl_target(gl, GL_DEPTH32F_STENCIL8, w, h);
    t->open = sn_gl_target(gl, GL_RG32F, w, h);
    t->picture = sn_gl_target(gl, GL_RGBA16F, w, h);
    sn_status st = sn_gl_check(gl, "making framebuffers", err);
    if (!st) st = make_frame(gl, &t->solid_frame, t->color, t->shape, t->depth, err);
    if (!st) st = make_frame(gl, &t->open_frame, t->open, 0, 0, err);
    if (!st) st = make_frame(gl, &t->picture_frame, t->picture, 0, 0, err);
    t->width = w;
    t->height = h;
    return st;
}

static sn_status make_skin(sn_targets *t, const sn_gl *gl, sn_error *err)
{
    t->skin_sum = sn_gl_target(gl, GL_RGBA16F, t->width, t->height);
    t->skin_weight = sn_gl_target(gl, GL_RGBA16F, t->width, t->height);
    sn_status st = sn_gl_check(gl, "making framebuffers", err);
    return st ? st : make_frame(gl, &t->skin_frame, t->skin_sum, t->skin_weight, t->depth, err);
}

static sn_status make_lines(sn_targets *t, const sn_gl *gl, sn_error *err)
{
    t->line = sn_gl_target(gl, GL_RGBA16F, t->width, t->height);
    t->line_depth = sn_gl_target(gl, GL_DEPTH32F_STENCIL8, t->width, t->height);
    sn_status st = sn_gl_check(gl, "making framebuffers", err);
    return st ? st : make_frame(gl, &t->line_frame, t->line, 0, t->line_depth, err);
}

static sn_status make_programs(sn_targets *t, const sn_gl *gl, sn_error *err)
{
    sn_status st = sn_gl_program(gl, "occlusion", sn_shader_screen_vs, sn_shader_occlusion_fs,
                                 &t->occlusion_program, err);
    if (!st) st = sn_gl_program(gl, "final", sn_shader_screen_vs, sn_shader_final_fs, &t->final_program, err);
    if (!st)
        st = sn_gl_program(gl, "final", sn_shader_screen_vs, sn_shader_final_rest_fs, &t->rest_program, err);
    if (!st) gl->GenVertexArrays(1, &t->screen);
    return st;
}

sn_status sn_targets_update(sn_targets *t, const sn_frame *f, int width, int height, bool has_skin,
                            bool has_lines, sn_error *err)
{
    const sn_gl *gl = &f->gl;
    sn_status st = SN_OK;
    t->has_skin = has_skin;
    t->has_lines = has_lines;
    if (t->width != width || t->height != height) sn_targets_clear(t, gl);
    if (!t->solid_frame) st = make_solid(t, gl, width, height, err);
    if (!st && has_skin && !t->skin_frame) st = make_skin(t, gl, err);
    if (!st && has_lines && !t->line_frame) st = make_lines(t, gl, err);
    if (!st && !t->screen) st = make_programs(t, gl, err);
    if (st) sn_targets_clear(t, gl);
    return st;
}

void sn_targets_clear(sn_targets *t, const sn_gl *gl)
{
    GLuint *texture[] = {&t->color, &t->shape,      &t->depth, &t->skin_sum, &t->skin_weight,
                         &t->line,  &t->line_depth, &t->open,  &t->picture};
    GLuint *frame[] = {&t->solid_frame, &t->skin_frame, &t->line_frame, &t->open_frame, &t->picture_frame};
    gl->BindFramebuffer(GL_FRAMEBUFFER, 0);
    for (size_t i = 0; i < sizeof frame / sizeof frame[0]; i++) sn_gl_delete_frame(gl, frame[i]);
    for (size_t i = 0; i < sizeof texture / sizeof texture[0]; i++) sn_gl_delete_texture(gl, texture[i]);
    t->width = t->height = 0;
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

/* Draws the samples x0 <= x < x1, y0 <= y < y1 of the tile. */
static void draw_rectangle(const sn_targets *t, const sn_frame *f, int x0, int y0, int x1, int y1)
{
    if (x0 >= x1 || y0 >= y1) return;
    f->gl.Enable(GL_SCISSOR_TEST);
    f->gl.Scissor(x0, y0, x1 - x0, y1 - y0);
    f->gl.Disable(GL_DEPTH_TEST);
    f->gl.BindVertexArray(t->screen);
    f->gl.DrawArrays(GL_TRIANGLES, 0, 3);
    f->gl.Enable(GL_DEPTH_TEST);
    f->gl.Disable(GL_SCISSOR_TEST);
}

static int clamp_to(int v, int last)
{
    return v < 0 ? 0 : v > last ? last : v;
}

/* Where in the tile something solid may be: x0, y0, x1, y1 in samples from its lower left corner. */
static void solid_rectangle(const sn_frame *f, int out[4])
{
    int n = f->samples;
    out[0] = clamp_to(f->solid_part.x0 * n - f->tile.x, f->tile.width);
    out[1] = clamp_to(f->height - f->solid_part.y1 * n - f->tile.y, f->tile.height);
    out[2] = clamp_to(f->solid_part.x1 * n - f->tile.x, f->tile.width);
    out[3] = clamp_to(f->height - f->solid_part.y0 * n - f->tile.y, f->tile.height);
}

void sn_targets_occlusion(const sn_targets *t, const sn_frame *f)
{
    const sn_gl *gl = &f->gl;
    GLuint p = t->occlusion_program;
    int r[4];
    solid_rectangle(f, r);
    gl->BindFramebuffer(GL_FRAMEBUFFER, t->open_frame);
    use_screen(t, f, p);
    gl->Uniform1f(gl->GetUniformLocation(p, "u_radius"), (float)(occlusion_radius * f->unit));
    gl->Uniform1f(gl->GetUniformLocation(p, "u_max_pixels"), (float)occlusion_pixels);
    draw_rectangle(t, f, r[0], r[1], r[2], r[3]);
}

static void use_final(const sn_targets *t, const sn_frame *f, GLuint p)
{
    const sn_gl *gl = &f->gl;
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
}

/* The part with solid things in the middle, and what lies below, above, left and right of it. */
void sn_targets_final(const sn_targets *t, const sn_frame *f)
{
    int r[4], w = f->tile.width, h = f->tile.height;
    solid_rectangle(f, r);
    f->gl.BindFramebuffer(GL_FRAMEBUFFER, t->picture_frame);
    use_final(t, f, t->final_program);
    draw_rectangle(t, f, r[0], r[1], r[2], r[3]);
    use_final(t, f, t->rest_program);
    if (r[0] >= r[2] || r[1] >= r[3]) r[0] = r[1] = r[2] = r[3] = 0;
    draw_rectangle(t, f, 0, 0, w, r[1]);
    draw_rectangle(t, f, 0, r[3], w, h);
    draw_rectangle(t, f, 0, r[1], r[0], r[3]);
    draw_rectangle(t, f, r[2], r[1], w, r[3]);
}
