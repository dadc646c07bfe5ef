/* lsn_render.c - pictures of a scene: from a table of options to sn_picture_options. */
#include "lsn.h"

#include "base/file.h"
#include "render/picture.h"

#include <string.h>

static const double default_skin_opacity = 0.3;
enum { opts = 2, default_fibers = 150, max_fibers = 100000 }; /* opts: the argument that holds the options */

/* ---- what to show, background, clip ---- */

static void read_show(lua_State *L, sn_picture_options *o)
{
    static const char *const names[] = {"muscles", "bones",  "skin",   "curves",
                                        "points",  "fibers", "frames", NULL};
    bool *const flag[] = {&o->show_muscles, &o->show_bones,  &o->show_skin,  &o->show_curves,
                          &o->show_points,  &o->show_fibers, &o->show_frames};
    o->show_muscles = o->show_bones = o->show_skin = true;
    if (!lsn_has(L, opts, "show")) return;
    for (int k = 0; names[k]; k++) *flag[k] = false;
    (void)lua_getfield(L, opts, "show");
    int32_t n = lsn_check_list(L, -1, opts, "option 'show'");
    for (int32_t i = 0; i < n; i++) {
        if (lua_geti(L, -1, i + 1) != LUA_TSTRING)
            (void)lsn_option_error(L, opts, "show", "list of names expected, item %d is a %s", i + 1,
                                   luaL_typename(L, -1));
        const char *word = lua_tostring(L, -1);
        int k = 0;
        while (names[k] && strcmp(word, names[k]) != 0) k++;
        if (!names[k])
            (void)lsn_option_error(L, opts, "show", "unknown '%s' (%s)", word,
                                   lsn_push_known(L, word, names));
        *flag[k] = true;
        lua_pop(L, 1);
    }
    lua_pop(L, 1);
}

static void read_clip(lua_State *L, sn_picture_options *o)
{
    static const char *const keys[] = {"point", "normal", NULL};
    if (!lsn_enter(L, opts, "clip")) return;
    lsn_check_keys(L, opts, keys);
    o->clip_point = lsn_opt_point(L, opts, "point", o->clip_point, true);
    o->clip_normal = lsn_opt_point(L, opts, "normal", o->clip_normal, true);
    if (!(sn_v3_len(o->clip_normal) > 0.0)) (void)lsn_option_error(L, opts, "normal", "has no length");
    o->has_clip = true;
    lsn_leave(L, opts);
}

static sn_renderer read_renderer(lua_State *L)
{
    const char *names[SN_RENDERER_COUNT + 1] = {NULL};
    const char *word = lsn_opt_string(L, opts, "renderer", NULL);
    if (!word) return lsn_get_state(L)->renderer;
    for (int i = 0; i < SN_RENDERER_COUNT; i++) {
        names[i] = sn_renderer_name((sn_renderer)i);
        if (strcmp(word, names[i]) == 0) return (sn_renderer)i;
    }
    (void)lsn_option_error(L, opts, "renderer", "unknown '%s' (%s)", word, lsn_push_known(L, word, names));
    return SN_RENDERER_AUTO;
}

/* ---- the file ---- */

/* A picture that cannot be written is a failed rendering, not a bad input file. */
static int not_written(lua_State *L, sn_error *err)
{
    if (err->code == SN_EIO) err->code = SN_ERENDER;
    return lsn_raise(L, err);
}

/* Opens the file for writing and lets go of it again: better now than after a minute of drawing. */
static void check_file(lua_State *L, const char *path)
{
    char ext[16];
    sn_out *out;
    sn_error err;
    sn_file_extension(path, ext);
    if (strcmp(ext, "png") != 0)
        (void)lsn_option_error(L, opts, "file", "%s: pictures are written as .png, found '.%s'", path, ext);
    if (sn_out_open(&out, path, &err)) (void)not_written(L, &err);
    sn_out_abort(out);
}

static void push_number(lua_State *L, double v)
{
    char text[32];
    (void)sn_format_double(text, v);
    lua_pushstring(L, text);
}

/* The camera as a Lua table that option `camera` takes, and the renderer's name, on the image at stack index
 * `image`. */
static void set_texts(lua_State *L, int image, const sn_camera *c, const char *renderer)
{
    lua_pushliteral(L, "sinew " SN_VERSION);
    lsn_set_image_text(L, image, "Software");
    lua_pushstring(L, renderer);
    lsn_set_image_text(L, image, "Renderer");
    const sn_vec3 v[3] = {c->eye, c->target, c->up};
    static const char *const before[3] = {"{eye = {", "}, target = {", "}, up = {"};
    int bottom = lua_gettop(L);
    for (int k = 0; k < 3; k++) {
        lua_pushstring(L, before[k]);
        push_number(L, v[k].x);
        lua_pushliteral(L, ", ");
        push_number(L, v[k].y);
        lua_pushliteral(L, ", ");
        push_number(L, v[k].z);
    }
    lua_pushliteral(L, "}, fov = ");
    push_number(L, c->fov_deg);
    lua_pushliteral(L, "}");
    lua_concat(L, lua_gettop(L) - bottom);
    lsn_set_image_text(L, image, "Camera");
}

int lsn_scene_render(lua_State *L) /* scene:render{...} -> image */
{
    static const char *const keys[] = {"file",       "size",         "camera",  "show",        "clip",
                                       "background", "skin_opacity", "samples", "fiber_count", "renderer", NULL};
    sn_scene *s = lsn_check_scene(L, 1);
    lua_settop(L, opts);
    lsn_check_keys(L, opts, keys);
    sn_picture_options o = {.skin_opacity = lsn_opt_number(L, opts, "skin_opacity", default_skin_opacity),
                            .samples = lsn_opt_int(L, opts, "samples", 0)};
    if (!(o.skin_opacity >= 0.0 && o.skin_opacity <= 1.0))
        return lsn_option_error(L, opts, "skin_opacity", "number in 0..1 expected, got %f", o.skin_opacity);
    if (lsn_has(L, opts, "samples") && (o.samples < 1 || o.samples > 4))
        return lsn_option_error(L, opts, "samples", "1..4 per pixel side expected, got %d", o.samples);
    int32_t n_fiber = lsn_opt_int(L, opts, "fiber_count", default_fibers);
    if (n_fiber < 1 || n_fiber > max_fibers)
        return lsn_option_error(L, opts, "fiber_count", "1..%d lines per muscle expected, got %d",
                                (int)max_fibers, n_fiber);
    lsn_read_size(L, opts, &o.width, &o.height);
    read_show(L, &o);
    for (int k = 0; k < 4; k++) o.background[k] = 1.0f;
    lsn_opt_color(L, opts, "background", o.background);
    read_clip(L, &o);
    o.renderer = read_renderer(L);
    const char *file = lsn_opt_string(L, opts, "file", NULL);
    if (file) check_file(L, file);
    lsn_read_camera(L, opts, s, o.width, o.height, &o.camera);
    sn_image *m = lsn_push_image(L);
    sn_picture_stats stats = {0};
    sn_error err;
    lsn_scene_must(L, s, sn_scene_render(s, &o, n_fiber, &lsn_get_state(L)->run, m, &stats, &err), &err);
    set_texts(L, lua_gettop(L), &o.camera, stats.renderer);
    lsn_account(L, 4 * (size_t)m->width * (size_t)m->height);
    if (stats.is_blank) lsn_warn(L, "%s%spicture is one flat colour", file ? file : "", file ? ": " : "");
    if (file && lsn_save_image(L, -1, file, &err)) return not_written(L, &err);
    return 1;
}
