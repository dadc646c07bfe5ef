/* lsn_place.c - scene:place_bone: bones of the library put into a scene. */
#include "lsn.h"

#include <string.h>

enum { opts = 2 }; /* the argument that holds the options */

/* ---- picks ---- */

static void need_option(lua_State *L, const char *key)
{
    if (!lsn_has(L, opts, key)) (void)lsn_option_error(L, opts, NULL, "option '%s' is missing", key);
}

/* {x, y} under `pixel` of the table that stands for the options. */
static void read_pixel(lua_State *L, double out[2])
{
    if (lua_getfield(L, opts, "pixel") != LUA_TTABLE || lua_rawlen(L, -1) != 2)
        (void)lsn_option_error(L, opts, "pixel", "{x, y} expected, from the top left corner");
    for (int k = 0; k < 2; k++) {
        (void)lua_geti(L, -1, k + 1);
        if (!lsn_to_number(L, -1, k ? "pixel: y" : "pixel: x", &out[k]))
            (void)luaL_argerror(L, opts, lua_tostring(L, -1));
        lua_pop(L, 1);
    }
    lua_pop(L, 1);
}

/* Whether option `key` is a table with this field. */
static bool has_field(lua_State *L, const char *key, const char *field)
{
    bool found = lua_getfield(L, opts, key) == LUA_TTABLE && lua_getfield(L, -1, field) != LUA_TNIL;
    lua_settop(L, opts);
    return found;
}

static void read_pixel_ray(lua_State *L, const sn_scene *s, sn_pick *p)
{
    static const char *const keys[] = {"camera", "size", "pixel", NULL};
    double pixel[2];
    int32_t width, height;
    sn_camera camera;
    lsn_check_keys(L, opts, keys);
    read_pixel(L, pixel);
    lsn_read_size(L, opts, &width, &height);
    lsn_read_camera(L, opts, s, width, height, &camera);
    sn_camera_ray(&camera, pixel[0], pixel[1], width, height, &p->origin, &p->dir);
}

/* Option `key`: {camera=, size=, pixel=}, {origin=, direction=} or a point. */
static sn_pick read_pick(lua_State *L, const sn_scene *s, const char *key)
{
    static const char *const keys[] = {"origin", "direction", NULL};
    sn_pick p = {0};
    need_option(L, key);
    bool is_pixel = has_field(L, key, "pixel");
    p.is_ray = is_pixel || has_field(L, key, "origin") || has_field(L, key, "direction");
    if (!p.is_ray) {
        p.origin = lsn_opt_point(L, opts, key, p.origin, true);
        return p;
    }
    (void)lsn_enter(L, opts, key);
    if (is_pixel) {
        read_pixel_ray(L, s, &p);
    } else {
        lsn_check_keys(L, opts, keys);
        p.origin = lsn_opt_point(L, opts, "origin", p.origin, true);
        p.dir = lsn_opt_point(L, opts, "direction", p.dir, true);
    }
    lsn_leave(L, opts);
    return p;
}

/* ---- what all kinds have ---- */

static void set_clearance(lua_State *L, const sn_clearance *c)
{
    lsn_set_number(L, "least", c->least);
    lsn_set_point(L, "at", c->at);
    lsn_set_integer(L, "outside", c->n_out);
    lsn_set_integer(L, "near", c->n_near);
}

void lsn_push_clearance(lua_State *L, const sn_clearance *c)
{
    lua_createtable(L, 0, 4);
    set_clearance(L, c);
}

void lsn_push_clearance_report(lua_State *L, const sn_clearance_report *r)
{
    lua_createtable(L, 0, 5);
    lsn_push_clearance(L, &r->before);
    lua_setfield(L, -2, "before");
    lsn_push_clearance(L, &r->after);
    lua_setfield(L, -2, "after");
    lsn_set_number(L, "moved", r->moved);
    lsn_set_integer(L, "moved_vertices", r->n_moved);
    lsn_set_integer(L, "rounds", r->rounds);
}

/* The bone and the report on top of the stack, which gets the margin's. */
static int finish(lua_State *L, const sn_bone_placing *p, const sn_clearance_report *clear)
{
    if (p->margin > 0.0) {
        lsn_push_clearance_report(L, clear);
        lua_setfield(L, -2, "clearance");
    }
    lsn_push_member(L, LSN_BONE, 1, p->name);
    lua_insert(L, -2);
    return 2;
}

static sn_run *run_of(lua_State *L)
{
    return &lsn_get_state(L)->run;
}

/* ---- cylinder ---- */

static int place_cylinder(lua_State *L, sn_scene *s, const sn_bone_placing *p)
{
    static const char *const keys[] = {"name",      "template", "margin", "from", "to",
                                       "thickness", "twist",    "front",  NULL};
    sn_cylinder_placing o = {0};
    sn_clearance_report clear = {0};
    sn_error err;
    lsn_check_keys(L, opts, keys);
    o.is_kept = lua_getfield(L, opts, "thickness") == LUA_TSTRING && strcmp(lua_tostring(L, -1), "kept") == 0;
    lua_pop(L, 1);
    if (!o.is_kept) o.proportion = lsn_opt_positive(L, opts, "thickness", 0.0);
    o.map.twist_deg = lsn_opt_number(L, opts, "twist", 0.0);
    o.map.front = lsn_opt_point(L, opts, "front", o.map.front, false);
    sn_pick from = read_pick(L, s, "from"), to = read_pick(L, s, "to");
    lsn_scene_must(L, s, sn_scene_place_cylinder(s, p, &from, &to, &o, run_of(L), &clear, &err), &err);
    int32_t i = sn_scene_bone_count(s) - 1;
    sn_vec3 a, b;
    (void)sn_scene_bone_ends(s, i, &a, &b);
    lua_createtable(L, 0, 4);
    lsn_set_point(L, "from", a);
    lsn_set_point(L, "to", b);
    lsn_set_number(L, "length", sn_v3_dist(a, b));
    return finish(L, p, &clear);
}

/* ---- along a curve ---- */

/* The list of points on top of the stack. Pushes a value. */
static const double *push_points(lua_State *L, int32_t *n)
{
    int list = lua_gettop(L);
    *n = lsn_check_list(L, list, opts, "option 'along'");
    double *point = lsn_push_numbers(L, 3 * (size_t)*n);
    for (int32_t i = 0; i < *n; i++) {
        sn_vec3 p;
        (void)lua_geti(L, list, i + 1);
        lua_pushfstring(L, "along[%d]", i + 1);
        if (!lsn_to_point(L, -2, lua_tostring(L, -1), &p)) (void)luaL_argerror(L, opts, lua_tostring(L, -1));
        sn_v3_store(point + 3 * (size_t)i, p);
        lua_pop(L, 2);
    }
    return point;
}

/* Option `along`: a list of points, or a stroke {camera=, size=, stroke=} seen on the plane. Pushes values.
 */
static const double *push_along(lua_State *L, const sn_scene *s, const sn_curve_options *o, int32_t *n)
{
    static const char *const keys[] = {"camera", "size", "stroke", NULL};
    sn_camera camera;
    sn_error err;
    int32_t width, height;
    need_option(L, "along");
    bool is_stroke = has_field(L, "along", "stroke");
    if (!is_stroke) {
        (void)lua_getfield(L, opts, "along");
        return push_points(L, n);
    }
    if (!o->has_plane)
        (void)lsn_option_error(L, opts, NULL,
                               "option 'plane' is missing: a stroke is seen on the plane of symmetry");
    (void)lsn_enter(L, opts, "along");
    lsn_check_keys(L, opts, keys);
    lsn_read_size(L, opts, &width, &height);
    lsn_read_camera(L, opts, s, width, height, &camera);
    lsn_leave(L, opts);
    (void)lua_getfield(L, opts, "along");
    (void)lua_getfield(L, -1, "stroke");
    const double *pixel = lsn_push_pixels(L, lua_gettop(L), opts, n);
    double *point = lsn_push_numbers(L, 3 * (size_t)*n);
    if (sn_scene_stroke_on_plane(&camera, width, height, pixel, *n, o->plane_point, o->plane_normal, point,
                                 &err))
        (void)lsn_raise(L, &err);
    return point;
}

/* {a, b} under key. */
static void read_pair(lua_State *L, const char *key, double *a, double *b)
{
    if (!lsn_has(L, opts, key)) return;
    if (lua_getfield(L, opts, key) != LUA_TTABLE || lua_rawlen(L, -1) != 2)
        (void)lsn_option_error(L, opts, key, "a list of two numbers expected");
    for (int k = 0; k < 2; k++) {
        (void)lua_geti(L, -1, k + 1);
        if (!lsn_to_number(L, -1, key, k ? b : a)) (void)luaL_argerror(L, opts, lua_tostring(L, -1));
        lua_pop(L, 1);
    }
    lua_pop(L, 1);
}

static int place_row(lua_State *L, sn_scene *s, const sn_bone_placing *p)
{
    static const char *const keys[] = {"name",    "template", "margin", "along",          "count",
                                       "spacing", "range",    "size",   "fill",           "thickness",
                                       "front",   "reversed", "plane",  "control_points", NULL};
    sn_curve_options o = {0};
    sn_curve_report r = {0};
    sn_clearance_report clear = {0};
    sn_error err;
    int32_t n, n_piece;
    lsn_check_keys(L, opts, keys);
    o.count = lsn_opt_int(L, opts, "count", 0);
    o.spacing = lsn_opt_positive(L, opts, "spacing", 0.0);
    o.fill = lsn_opt_positive(L, opts, "fill", 0.0);
    o.thickness = lsn_opt_positive(L, opts, "thickness", 0.0);
    o.front = lsn_opt_point(L, opts, "front", o.front, false);
    o.is_reversed = lsn_opt_bool(L, opts, "reversed", false);
    o.n_control = lsn_opt_int(L, opts, "control_points", 0);
    read_pair(L, "range", &o.first, &o.last);
    read_pair(L, "size", &o.size[0], &o.size[1]);
    o.has_plane = lsn_enter(L, opts, "plane");
    if (o.has_plane) {
        lsn_read_plane(L, opts, &o.plane_point, &o.plane_normal);
        lsn_leave(L, opts);
    }
    const double *point = push_along(L, s, &o, &n);
    lsn_scene_must(L, s, sn_scene_place_row(s, p, point, n, &o, run_of(L), &r, &n_piece, &clear, &err), &err);
    lua_createtable(L, 0, 7);
    lsn_set_integer(L, "count", n_piece);
    lsn_set_number(L, "length", r.length);
    lsn_set_number(L, "spacing", r.spacing);
    lsn_set_number(L, "moved", r.moved);
    lsn_set_number(L, "rms", r.rms);
    lsn_set_number(L, "fill", r.fill);
    return finish(L, p, &clear);
}

/* ---- shape ---- */

static void push_icp(lua_State *L, const sn_icp_report *r)
{
    lua_createtable(L, 0, 6);
    lsn_set_integer(L, "iterations", r->n_iteration);
    lua_pushstring(L, sn_icp_stop_name(r->stop));
    lua_setfield(L, -2, "stop");
    lsn_set_number(L, "size", r->size);
    lsn_set_integer(L, "paired", r->n_paired);
    lsn_set_integer(L, "points", r->n_point);
    lsn_set_integer(L, "opposed", r->n_opposed);
    lua_createtable(L, r->n_iteration + 1, 0);
    for (int32_t i = 0; i <= r->n_iteration; i++) {
        lua_pushnumber(L, r->residual[i]);
        lua_rawseti(L, -2, i + 1);
    }
    lua_setfield(L, -2, "residual");
}

static void push_fit(lua_State *L, const sn_fit_result *f)
{
    lua_createtable(L, 0, 5);
    push_icp(L, &f->rigid);
    lua_setfield(L, -2, "rigid");
    push_icp(L, &f->bent);
    lua_setfield(L, -2, "cage");
    lsn_set_integer(L, "inverted_faces", f->n_inverted);
    lsn_set_integer(L, "crossings", f->n_crossing);
    lsn_set_integer(L, "crossings_before", f->n_crossing_before);
}

static void read_fit(lua_State *L, sn_shape_options *o)
{
    o->fit.rigid.max_iterations = o->fit.cage.icp.max_iterations = lsn_opt_int(L, opts, "iterations", 0);
    o->fit.rigid.tolerance = o->fit.cage.icp.tolerance = lsn_opt_positive(L, opts, "tolerance", 0.0);
    o->fit.cage.icp.max_residual = lsn_opt_positive(L, opts, "max_residual", 0.0);
    o->fit.cage.soft = lsn_opt_positive(L, opts, "stiffness", 0.0);
    o->fit.rigid.trim = o->fit.cage.icp.trim = lsn_opt_number(L, opts, "trim", 0.0);
    o->fit.keeps_scale = lsn_opt_bool(L, opts, "keep_scale", false);
}

static const char fit_type[] = "sinew.fit";

static int fit_gc(lua_State *L)
{
    sn_fit_result_free(lua_touserdata(L, 1));
    return 0;
}

static int place_shape(lua_State *L, sn_scene *s, const sn_bone_placing *p)
{
    static const char *const keys[] = {"name",      "template", "margin",     "at",        "size",
                                       "rotate",    "fit",      "iterations", "tolerance", "max_residual",
                                       "stiffness", "trim",     "keep_scale", NULL};
    sn_shape_options o = {0};
    sn_clearance_report clear = {0};
    sn_error err;
    lsn_check_keys(L, opts, keys);
    o.size = lsn_opt_positive(L, opts, "size", 0.0);
    o.is_fitted = lsn_opt_bool(L, opts, "fit", false);
    sn_vec3 axis;
    double degrees;
    if (lsn_opt_turn(L, opts, &axis, &degrees)) o.turn = sn_affine_rotation(axis, degrees, sn_v3(0, 0, 0));
    read_fit(L, &o);
    sn_pick at = read_pick(L, s, "at");
    sn_fit_result *fit = lsn_new_object(L, fit_type, sizeof *fit, 0);
    lsn_scene_must(L, s, sn_scene_place_shape(s, p, &at, &o, run_of(L), fit, &clear, &err), &err);
    if (o.is_fitted)
        push_fit(L, fit);
    else
        lua_newtable(L);
    return finish(L, p, &clear);
}

int lsn_scene_place_bone(lua_State *L) /* scene:place_bone{...} -> bone, report */
{
    sn_scene *s = lsn_check_scene(L, 1);
    sn_bone_placing p = {0};
    sn_error err;
    luaL_checktype(L, opts, LUA_TTABLE);
    lua_settop(L, opts);
    need_option(L, "name");
    need_option(L, "template");
    p.name = lsn_opt_string(L, opts, "name", "");
    p.margin = lsn_opt_positive(L, opts, "margin", 0.0);
    const char *name = lsn_opt_string(L, opts, "template", "");
    if (sn_bone_library_find(lsn_bone_library(L), name, &p.from_template, &err)) return lsn_raise(L, &err);
    switch (p.from_template->kind) {
    case SN_BONE_CYLINDER:
        return place_cylinder(L, s, &p);
    case SN_BONE_CURVE:
        return place_row(L, s, &p);
    default:
        return place_shape(L, s, &p);
    }
}

void lsn_open_place(lua_State *L)
{
    static const luaL_Reg meta[] = {{"__gc", fit_gc}, {NULL, NULL}}, none[] = {{NULL, NULL}};
    lsn_new_type(L, fit_type, meta, none);
}
