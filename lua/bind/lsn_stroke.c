/* lsn_stroke.c - muscles drawn as strokes in a picture. */
#include "lsn.h"

#include "mesh/spline_fit.h"
#include "scene/scene_stroke.h"

#include <string.h>

enum { opts = 3 }; /* the argument that holds the options */

/* Item i of the list of pixels at stack index `list`. */
static void read_pixel(lua_State *L, int list, int arg, int32_t i, double *out)
{
    bool is_list = lua_geti(L, list, i + 1) == LUA_TTABLE;
    if (is_list && lua_rawlen(L, -1) != 2)
        (void)lsn_option_error(L, arg, NULL, "stroke[%d]: {x, y} in pixels expected, got a list of %d", i + 1,
                               (int)lua_rawlen(L, -1));
    if (!is_list)
        (void)lsn_option_error(L, arg, NULL, "stroke[%d]: {x, y} in pixels expected, got %s", i + 1,
                               luaL_typename(L, -1));
    for (int k = 0; k < 2; k++) {
        (void)lua_geti(L, -1, k + 1);
        lua_pushfstring(L, "stroke[%d]: coordinate %s", i + 1, k ? "y" : "x");
        if (!lsn_to_number(L, -2, lua_tostring(L, -1), &out[k]))
            (void)luaL_argerror(L, arg, lua_tostring(L, -1));
        lua_pop(L, 2);
    }
    lua_pop(L, 1);
}

const double *lsn_push_pixels(lua_State *L, int list, int arg, int32_t *n)
{
    *n = lsn_check_list(L, list, arg, "option 'stroke'");
    double *pixel = lsn_push_numbers(L, 2 * (size_t)*n);
    for (int32_t i = 0; i < *n; i++) read_pixel(L, list, arg, i, pixel + 2 * (size_t)i);
    return pixel;
}

static void read_options(lua_State *L, sn_stroke_options *o)
{
    const char *depth = lsn_opt_string(L, opts, "depth", "clear");
    if (strcmp(depth, "clear") != 0 && strcmp(depth, "linear") != 0)
        (void)lsn_option_error(L, opts, "depth", "unknown '%s' (known: clear, linear)", depth);
    o->depth = *depth == 'l' ? SN_DEPTH_LINEAR : SN_DEPTH_CLEAR;
    o->n_point = lsn_opt_int(L, opts, "points", 0);
    if (lsn_has(L, opts, "points") && (o->n_point < 2 || o->n_point > SN_SPLINE_FIT_MAX_POINTS))
        (void)lsn_option_error(L, opts, "points", "2..%d control points expected, got %d",
                               SN_SPLINE_FIT_MAX_POINTS, o->n_point);
    o->snap = lsn_opt_number(L, opts, "snap", 0.0);
    if (!(o->snap >= 0.0))
        (void)lsn_option_error(L, opts, "snap", "number of pixels, 0 or more, expected, got %f", o->snap);
    o->margin = lsn_opt_positive(L, opts, "margin", 0.0);
}

static void push_report(lua_State *L, const sn_scene *s, const sn_stroke_report *r)
{
    lua_createtable(L, 0, 8);
    lsn_set_number(L, "rms", r->rms);
    lsn_set_number(L, "max", r->max);
    lsn_set_number(L, "inside_bone", r->inside_bone);
    lsn_set_number(L, "outside_skin", r->outside_skin);
    lsn_set_number(L, "path_length", r->path_length);
    lsn_set_number(L, "snapped", fmax(r->snapped[0], r->snapped[1]));
    lua_pushstring(L, sn_scene_bone_name(s, r->bone[0]));
    lua_setfield(L, -2, "origin");
    lua_pushstring(L, sn_scene_bone_name(s, r->bone[1]));
    lua_setfield(L, -2, "insertion");
}

int lsn_scene_draw_muscle(lua_State *L) /* scene:draw_muscle(name, {...}) -> muscle, report */
{
    static const char *const keys[] = {"camera", "size", "stroke", "depth", "points",
                                       "tissue", "snap", "margin", NULL};
    sn_scene *s = lsn_check_scene(L, 1);
    sn_scene_stroke stroke = {.name = lsn_check_text(L, 2)};
    sn_stroke_options o = {0};
    sn_stroke_report report = {0};
    sn_camera camera;
    sn_error err;
    luaL_checktype(L, opts, LUA_TTABLE);
    lua_settop(L, opts);
    lsn_check_keys(L, opts, keys);
    if (sn_scene_bone_count(s) == 0)
        return lsn_fail(L, SN_EINVAL,
                        "draw_muscle: the scene has no bones: a stroke begins and ends over one");
    read_options(L, &o);
    if (!lsn_has(L, opts, "stroke")) return lsn_option_error(L, opts, NULL, "option 'stroke' is missing");
    (void)lua_getfield(L, opts, "stroke");
    stroke.pixel = lsn_push_pixels(L, lua_gettop(L), opts, &stroke.n_pixel);
    stroke.tissue = lsn_push_each(L, opts, "tissue", sn_stroke_point_count(&o), "points");
    lsn_read_size(L, opts, &stroke.width, &stroke.height);
    lsn_read_camera(L, opts, s, stroke.width, stroke.height, &camera);
    stroke.camera = &camera;
    lsn_scene_must(L, s, sn_scene_draw_muscle(s, &stroke, &o, &lsn_get_state(L)->run, &report, &err), &err);
    lsn_push_member(L, LSN_MUSCLE, 1, stroke.name);
    push_report(L, s, &report);
    return 2;
}
