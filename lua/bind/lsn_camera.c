/* lsn_camera.c - the size of a picture and the camera it is taken with, as every function with those options
 * reads them. */
#include "lsn.h"

static const double default_fov_deg = 30.0;
enum { default_width = 800, default_height = 600 };

/* ---- size ---- */

/* Item k of the list on top of the stack. */
static int32_t read_side(lua_State *L, int arg, int k, const char *name)
{
    int is_whole;
    bool is_number = lua_geti(L, -1, k) == LUA_TNUMBER;
    lua_Integer n = lua_tointegerx(L, -1, &is_whole);
    if (!is_number || !is_whole || n < 1 || n > SN_IMAGE_MAX_SIDE)
        (void)lsn_option_error(L, arg, "size", "%s is %s, need a whole number of pixels in 1..%d", name,
                               luaL_tolstring(L, -1, NULL), SN_IMAGE_MAX_SIDE);
    lua_pop(L, 1);
    return (int32_t)n;
}

void lsn_read_size(lua_State *L, int arg, int32_t *width, int32_t *height)
{
    *width = default_width;
    *height = default_height;
    if (!lsn_has(L, arg, "size")) return;
    if (lua_getfield(L, arg, "size") != LUA_TTABLE || lua_rawlen(L, -1) != 2)
        (void)lsn_option_error(L, arg, "size", "{width, height} expected");
    *width = read_side(L, arg, 1, "width");
    *height = read_side(L, arg, 2, "height");
    lua_pop(L, 1);
}

/* ---- camera ---- */

static void need(lua_State *L, sn_status st, const sn_error *err)
{
    if (st) (void)lsn_raise(L, err);
}

/* The table of option `camera`, entered: {eye=, target=, up=, fov=} or {azimuth=, elevation=, zoom=}. */
static void read_table(lua_State *L, int arg, const sn_scene *s, sn_box3 box, double aspect, sn_camera *out)
{
    static const char *const keys[] = {"eye", "target", "up", "fov", "azimuth", "elevation", "zoom", NULL};
    sn_vec3 above = sn_scene_up(s) == SN_UP_Z ? sn_v3(0, 0, 1) : sn_v3(0, 1, 0), none = {0};
    bool looks = false, orbits = false;
    sn_error err;
    lsn_check_keys(L, arg, keys);
    for (int k = 0; keys[k]; k++) *(k < 4 ? &looks : &orbits) |= lsn_has(L, arg, keys[k]);
    if (looks && orbits)
        (void)lsn_option_error(L, arg, "camera",
                               "eye, target, up, fov or azimuth, elevation, zoom expected, not both");
    if (!looks) {
        double azimuth = lsn_opt_number(L, arg, "azimuth", 0.0),
               elevation = lsn_opt_number(L, arg, "elevation", 0.0);
        double zoom = lsn_opt_positive(L, arg, "zoom", 1.0);
        need(L, sn_camera_orbit(out, azimuth, elevation, zoom, box, sn_scene_up(s), aspect, &err), &err);
        return;
    }
    sn_vec3 eye = lsn_opt_point(L, arg, "eye", none, true);
    sn_vec3 target = lsn_opt_point(L, arg, "target", sn_v3_lerp(box.min, box.max, 0.5), false);
    sn_vec3 up = lsn_opt_point(L, arg, "up", above, false);
    double fov = lsn_opt_positive(L, arg, "fov", default_fov_deg);
    need(L, sn_camera_look(out, eye, target, up, fov, box, &err), &err);
}

void lsn_read_camera(lua_State *L, int arg, const sn_scene *s, int32_t width, int32_t height, sn_camera *out)
{
    double aspect = (double)width / (double)height;
    sn_box3 box = sn_scene_bounds(s);
    sn_error err;
    int top = lua_gettop(L);
    if (sn_box3_is_empty(box))
        (void)lsn_fail(L, SN_EINVAL, "render: the scene has nothing to show: no skin, no bones, no muscles");
    bool is_name = lsn_has(L, arg, "camera") && lua_getfield(L, arg, "camera") == LUA_TSTRING;
    if (is_name || !lsn_has(L, arg, "camera")) {
        const char *name = is_name ? lua_tostring(L, -1) : "front";
        need(L, sn_camera_preset(out, name, box, sn_scene_up(s), aspect, &err), &err);
    } else if (lua_istable(L, -1)) {
        (void)lsn_enter(L, arg, "camera");
        read_table(L, arg, s, box, aspect, out);
        lsn_leave(L, arg);
    } else {
        (void)lsn_option_error(L, arg, "camera", "name of a view or table expected, got %s",
                               luaL_typename(L, -1));
    }
    lua_settop(L, top);
}
