/* lsn_render.c - pictures of a scene: from a table of options to sn_picture_options. */
#include "lsn.h"

#include "base/file.h"
#include "render/picture.h"

#include <stdio.h>
#include <string.h>

static const double default_fov_deg = 30.0, default_skin_opacity = 0.3;
enum { default_width = 800, default_height = 600, opts = 2 }; /* opts: the argument that holds the options */

/* ---- size, what to show, background, clip ---- */

static int32_t read_side(lua_State *L, int k, const char *name)
{
    int is_whole;
    bool is_number = lua_geti(L, -1, k) == LUA_TNUMBER;
    lua_Integer n = lua_tointegerx(L, -1, &is_whole);
    if (!is_number || !is_whole || n < 1 || n > SN_IMAGE_MAX_SIDE)
        (void)lsn_option_error(L, opts, "size", "%s is %s, need a whole number of pixels in 1..%d", name,
                               luaL_tolstring(L, -1, NULL), SN_IMAGE_MAX_SIDE);
    lua_pop(L, 1);
    return (int32_t)n;
}

static void read_size(lua_State *L, sn_picture_options *o)
{
    o->width = default_width;
    o->height = default_height;
    if (!lsn_has(L, opts, "size")) return;
    if (lua_getfield(L, opts, "size") != LUA_TTABLE || lua_rawlen(L, -1) != 2)
        (void)lsn_option_error(L, opts, "size", "{width, height} expected");
    o->width = read_side(L, 1, "width");
    o->height = read_side(L, 2, "height");
    lua_pop(L, 1);
}

static void read_show(lua_State *L, sn_picture_options *o)
{
    static const char *const names[] = {"muscles", "bones", "skin", "curves", "points", NULL};
    bool *const flag[] = {&o->show_muscles, &o->show_bones, &o->show_skin, &o->show_curves, &o->show_points};
    o->show_muscles = o->show_bones = o->show_skin = true;
    if (!lsn_has(L, opts, "show")) return;
    for (int k = 0; k < 5; k++) *flag[k] = false;
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

static bool read_color(const char *text, float out[4])
{
    static const struct {
        const char *name;
        float rgba[4];
    } known[] = {{"white", {1, 1, 1, 1}}, {"black", {0, 0, 0, 1}}, {"transparent", {1, 1, 1, 0}}};
    for (int i = 0; i < 3; i++)
        if (strcmp(text, known[i].name) == 0) {
            memcpy(out, known[i].rgba, sizeof known[i].rgba);
            return true;
        }
    if (text[0] != '#' || strlen(text) != 7 || strspn(text + 1, "0123456789abcdefABCDEF") != 6) return false;
    for (int k = 0; k < 3; k++) {
        unsigned value = 0;
        (void)sscanf(text + 1 + 2 * k, "%2x", &value);
        out[k] = (float)value / 255.0f;
    }
    out[3] = 1.0f;
    return true;
}

static void read_background(lua_State *L, float out[4])
{
    for (int k = 0; k < 4; k++) out[k] = 1.0f;
    if (!lsn_has(L, opts, "background")) return;
    int type = lua_getfield(L, opts, "background");
    if (type == LUA_TSTRING) {
        const char *text = lua_tostring(L, -1);
        if (!read_color(text, out))
            (void)lsn_option_error(L, opts, "background",
                                   "unknown colour '%s' (known: transparent, white, black, #rrggbb)", text);
    } else {
        int n = type == LUA_TTABLE ? (int)lua_rawlen(L, -1) : 0;
        if (n != 3 && n != 4)
            (void)lsn_option_error(
                L, opts, "background",
                "{r, g, b} or {r, g, b, a} in 0..1, \"transparent\", \"white\", \"black\" or "
                "\"#rrggbb\" expected");
        for (int k = 0; k < n; k++) {
            bool is_number = lua_geti(L, -1, k + 1) == LUA_TNUMBER;
            double v = lua_tonumber(L, -1);
            if (!is_number || !(v >= 0.0 && v <= 1.0))
                (void)lsn_option_error(L, opts, "background", "value %d is %s, need a number in 0..1", k + 1,
                                       luaL_tolstring(L, -1, NULL));
            out[k] = (float)v;
            lua_pop(L, 1);
        }
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

/* ---- camera ---- */

static void need(lua_State *L, sn_status st, const sn_error *err)
{
    if (st) (void)lsn_raise(L, err);
}

/* The table of option `camera`, entered: {eye=, target=, up=, fov=} or {azimuth=, elevation=, zoom=}. */
static void read_camera_table(lua_State *L, const sn_scene *s, sn_box3 box, double aspect, sn_camera *out)
{
    static const char *const keys[] = {"eye", "target", "up", "fov", "azimuth", "elevation", "zoom", NULL};
    sn_vec3 above = sn_scene_up(s) == SN_UP_Z ? sn_v3(0, 0, 1) : sn_v3(0, 1, 0), none = {0};
    bool looks = false, orbits = false;
    sn_error err;
    lsn_check_keys(L, opts, keys);
    for (int k = 0; keys[k]; k++) *(k < 4 ? &looks : &orbits) |= lsn_has(L, opts, keys[k]);
    if (looks && orbits)
        (void)lsn_option_error(L, opts, "camera",
                               "eye, target, up, fov or azimuth, elevation, zoom expected, not both");
    if (!looks) {
        double azimuth = lsn_opt_number(L, opts, "azimuth", 0.0),
               elevation = lsn_opt_number(L, opts, "elevation", 0.0);
        double zoom = lsn_opt_positive(L, opts, "zoom", 1.0);
        need(L, sn_camera_orbit(out, azimuth, elevation, zoom, box, sn_scene_up(s), aspect, &err), &err);
        return;
    }
    sn_vec3 eye = lsn_opt_point(L, opts, "eye", none, true);
    sn_vec3 target = lsn_opt_point(L, opts, "target", sn_v3_lerp(box.min, box.max, 0.5), false);
    sn_vec3 up = lsn_opt_point(L, opts, "up", above, false);
    double fov = lsn_opt_positive(L, opts, "fov", default_fov_deg);
    need(L, sn_camera_look(out, eye, target, up, fov, box, &err), &err);
}

static void read_camera(lua_State *L, const sn_scene *s, sn_picture_options *o)
{
    double aspect = (double)o->width / (double)o->height;
    sn_box3 box = sn_scene_bounds(s);
    sn_error err;
    if (sn_box3_is_empty(box))
        (void)lsn_fail(L, SN_EINVAL, "render: the scene has nothing to show: no skin, no bones, no muscles");
    bool is_name = lsn_has(L, opts, "camera") && lua_getfield(L, opts, "camera") == LUA_TSTRING;
    if (is_name || !lsn_has(L, opts, "camera")) {
        const char *name = is_name ? lua_tostring(L, -1) : "front";
        need(L, sn_camera_preset(&o->camera, name, box, sn_scene_up(s), aspect, &err), &err);
    } else if (lua_istable(L, -1)) {
        (void)lsn_enter(L, opts, "camera");
        read_camera_table(L, s, box, aspect, &o->camera);
        lsn_leave(L, opts);
    } else {
        (void)lsn_option_error(L, opts, "camera", "name of a view or table expected, got %s",
                               luaL_typename(L, -1));
    }
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
    static const char *const keys[] = {"file",       "size",         "camera",  "show", "clip",
                                       "background", "skin_opacity", "samples", NULL};
    sn_scene *s = lsn_check_scene(L, 1);
    lua_settop(L, opts);
    lsn_check_keys(L, opts, keys);
    sn_picture_options o = {.skin_opacity = lsn_opt_number(L, opts, "skin_opacity", default_skin_opacity),
                            .samples = lsn_opt_int(L, opts, "samples", 0)};
    if (!(o.skin_opacity >= 0.0 && o.skin_opacity <= 1.0))
        return lsn_option_error(L, opts, "skin_opacity", "number in 0..1 expected, got %f", o.skin_opacity);
    if (lsn_has(L, opts, "samples") && (o.samples < 1 || o.samples > 4))
        return lsn_option_error(L, opts, "samples", "1..4 per pixel side expected, got %d", o.samples);
    read_size(L, &o);
    read_show(L, &o);
    read_background(L, o.background);
    read_clip(L, &o);
    const char *file = lsn_opt_string(L, opts, "file", NULL);
    if (file) check_file(L, file);
    read_camera(L, s, &o);
    sn_image *m = lsn_push_image(L);
    sn_picture_stats stats = {0};
    sn_error err;
    lsn_scene_must(L, s, sn_scene_render(s, &o, &lsn_get_state(L)->run, m, &stats, &err), &err);
    set_texts(L, lua_gettop(L), &o.camera, stats.renderer);
    lsn_account(L, 4 * (size_t)m->width * (size_t)m->height);
    if (stats.is_blank) lsn_warn(L, "%s%spicture is one flat colour", file ? file : "", file ? ": " : "");
    if (file && lsn_save_image(L, -1, file, &err)) return not_written(L, &err);
    return 1;
}
