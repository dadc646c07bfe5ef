/* lsn_image.c - pictures in memory. */
#include "lsn.h"

#include "render/image_draw.h"

#include <stdio.h>
#include <string.h>

typedef struct picture {
    sn_image image;
} picture; /* user value: nil, or a table of the texts that save writes */

/* The texts a picture may carry, in the order in which they are written. */
static const char *const text_keys[] = {"Software", "Camera", "Renderer"};
static const double default_text_size = 16.0; /* pixels */
enum { n_text_keys = (int)(sizeof text_keys / sizeof text_keys[0]) };

sn_image *lsn_push_image(lua_State *L)
{
    picture *p = lsn_new_object(L, LSN_IMAGE, sizeof *p, 1);
    return &p->image;
}

const sn_image *lsn_check_image(lua_State *L, int arg)
{
    const picture *p = luaL_checkudata(L, arg, LSN_IMAGE);
    luaL_argcheck(L, p->image.rgba != NULL, arg, "image was closed");
    return &p->image;
}

static int image_gc(lua_State *L)
{
    picture *p = luaL_checkudata(L, 1, LSN_IMAGE);
    sn_image_free(&p->image);
    return 0;
}

static int image_tostring(lua_State *L)
{
    const picture *p = luaL_checkudata(L, 1, LSN_IMAGE);
    if (p->image.rgba)
        lua_pushfstring(L, "image: %d x %d pixels", p->image.width, p->image.height);
    else
        lua_pushliteral(L, "image (was closed)");
    return 1;
}

void lsn_set_image_text(lua_State *L, int image, const char *key)
{
    image = lua_absindex(L, image);
    if (lua_getiuservalue(L, image, 1) != LUA_TTABLE) {
        lua_pop(L, 1);
        lua_newtable(L);
        lua_pushvalue(L, -1);
        (void)lua_setiuservalue(L, image, 1);
    }
    lua_insert(L, -2);
    lua_setfield(L, -2, key);
    lua_pop(L, 1);
}

sn_status lsn_save_image(lua_State *L, int idx, const char *path, sn_error *err)
{
    const picture *p = lua_touserdata(L, idx);
    sn_image_text text[n_text_keys];
    int n = 0, texts = lua_gettop(L) + 1;
    if (lua_getiuservalue(L, idx, 1) == LUA_TTABLE)
        for (int k = 0; k < n_text_keys; k++) {
            if (lua_getfield(L, texts, text_keys[k]) == LUA_TSTRING)
                text[n++] = (sn_image_text){text_keys[k], lua_tostring(L, -1)};
            lua_pop(L, 1); /* the table holds the string */
        }
    sn_status st = sn_image_save(&p->image, n ? text : NULL, n, path, err);
    lua_settop(L, texts - 1);
    return st;
}

/* ---- colours, also for pictures of a scene ---- */

static bool named_color(const char *text, float out[4])
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

/* The list on top of the stack. */
static void list_color(lua_State *L, int arg, const char *key, float out[4])
{
    int n = lua_istable(L, -1) ? (int)lua_rawlen(L, -1) : 0;
    if (n != 3 && n != 4)
        (void)lsn_option_error(L, arg, key,
                               "{r, g, b} or {r, g, b, a} in 0..1, \"transparent\", \"white\", \"black\" or "
                               "\"#rrggbb\" expected");
    out[3] = 1.0f;
    for (int k = 0; k < n; k++) {
        bool is_number = lua_geti(L, -1, k + 1) == LUA_TNUMBER;
        double v = lua_tonumber(L, -1);
        if (!is_number || !(v >= 0.0 && v <= 1.0))
            (void)lsn_option_error(L, arg, key, "value %d is %s, need a number in 0..1", k + 1,
                                   luaL_tolstring(L, -1, NULL));
        out[k] = (float)v;
        lua_pop(L, 1);
    }
}

void lsn_opt_color(lua_State *L, int arg, const char *key, float out[4])
{
    if (!lsn_has(L, arg, key)) return;
    if (lua_getfield(L, arg, key) != LUA_TSTRING)
        list_color(L, arg, key, out);
    else if (!named_color(lua_tostring(L, -1), out))
        (void)lsn_option_error(L, arg, key, "unknown colour '%s' (known: transparent, white, black, #rrggbb)",
                               lua_tostring(L, -1));
    lua_pop(L, 1);
}

/* ---- files and pixels ---- */

static int image_load(lua_State *L) /* sinew.image.load(path) -> image | nil, message */
{
    const char *path = lsn_check_text(L, 1);
    sn_image *m = lsn_push_image(L);
    sn_error err;
    if (sn_image_load(m, path, &err)) return lsn_nil_error(L, &err);
    lsn_account(L, 4 * (size_t)m->width * (size_t)m->height);
    return 1;
}

static int image_save(lua_State *L) /* img:save(path) -> true | nil, message */
{
    (void)lsn_check_image(L, 1);
    const char *path = lsn_check_text(L, 2);
    sn_error err;
    return lsn_saved(L, lsn_save_image(L, 1, path, &err), &err);
}

static int image_width(lua_State *L)
{
    lua_pushinteger(L, lsn_check_image(L, 1)->width);
    return 1;
}

static int image_height(lua_State *L)
{
    lua_pushinteger(L, lsn_check_image(L, 1)->height);
    return 1;
}

static int image_pixel(lua_State *L) /* img:pixel(x, y) -> r, g, b, a: 0..255; (1, 1) is the top left pixel */
{
    const sn_image *m = lsn_check_image(L, 1);
    int32_t x = lsn_check_index(L, 2, m->width), y = lsn_check_index(L, 3, m->height);
    const uint8_t *c = m->rgba + 4 * ((size_t)y * (size_t)m->width + (size_t)x);
    for (int k = 0; k < 4; k++) lua_pushinteger(L, c[k]);
    return 4;
}

static int image_compare(lua_State *L) /* sinew.image.compare(a, b [, {max=, count=}]) */
{
    static const char *const keys[] = {"max", "count", NULL};
    const sn_image *a = lsn_check_image(L, 1), *b = lsn_check_image(L, 2);
    lsn_check_keys(L, 3, keys);
    int32_t max = lsn_opt_int(L, 3, "max", 0), count = lsn_opt_int(L, 3, "count", 0);
    sn_image *diff = lsn_push_image(L);
    sn_image_diff d;
    sn_error err;
    if (sn_image_compare(a, b, max, count, &d, diff, &err)) return lsn_raise(L, &err);
    lsn_account(L, 4 * (size_t)diff->width * (size_t)diff->height);
    lua_createtable(L, 0, 5);
    lsn_set_bool(L, "equal", d.equal);
    lsn_set_integer(L, "max", d.max);
    lsn_set_integer(L, "count", d.count);
    lsn_set_number(L, "rmse", d.rmse);
    lua_pushvalue(L, -2);
    lua_setfield(L, -2, "diff");
    return 1;
}

/* ---- drawing: places count from 1 here, from 0 in core ---- */

static sn_image *check_canvas(lua_State *L)
{
    (void)lsn_check_image(L, 1);
    return &((picture *)lua_touserdata(L, 1))->image;
}

static int drawn(lua_State *L, sn_status st, const sn_error *err) /* the image, for chains of calls */
{
    if (st) return lsn_raise(L, err);
    lua_settop(L, 1);
    return 1;
}

static int32_t whole(lua_State *L, int arg, double v, const char *what)
{
    if (!(v == floor(v) && fabs(v) <= SN_IMAGE_MAX_PLACE))
        (void)luaL_argerror(L, arg, lua_pushfstring(L, "%s is %f, need a whole number of pixels", what, v));
    return (int32_t)v;
}

static int32_t opt_whole(lua_State *L, const char *key, int32_t def)
{
    double v = lsn_opt_number(L, 2, key, def);
    lua_pushfstring(L, "option '%s'", key);
    int32_t n = whole(L, 2, v, lua_tostring(L, -1));
    lua_pop(L, 1);
    return n;
}

static double need_number(lua_State *L, const char *key)
{
    if (!lsn_has(L, 2, key)) (void)lsn_option_error(L, 2, NULL, "option '%s' is missing", key);
    return lsn_opt_number(L, 2, key, 0.0);
}

static const char *need_text(lua_State *L)
{
    if (!lsn_has(L, 2, "text")) (void)lsn_option_error(L, 2, NULL, "option 'text' is missing");
    return lsn_opt_string(L, 2, "text", "");
}

static int image_new(lua_State *L) /* sinew.image.new{size={w, h}, background="white"} -> image */
{
    static const char *const keys[] = {"size", "background", NULL};
    float color[4] = {1, 1, 1, 1};
    int32_t width, height;
    sn_error err;
    lsn_check_keys(L, 1, keys);
    if (!lsn_has(L, 1, "size")) return lsn_option_error(L, 1, NULL, "option 'size' is missing");
    lsn_read_size(L, 1, &width, &height);
    lsn_opt_color(L, 1, "background", color);
    if (sn_image_create(lsn_push_image(L), width, height, color, &err)) return lsn_raise(L, &err);
    lsn_account(L, 4 * (size_t)width * (size_t)height);
    return 1;
}

static int image_paste(lua_State *L) /* img:paste(other, x, y) -> img */
{
    sn_image *m = check_canvas(L);
    const sn_image *from = lsn_check_image(L, 2);
    int32_t x = whole(L, 3, lsn_check_finite(L, 3), "x"), y = whole(L, 4, lsn_check_finite(L, 4), "y");
    sn_error err;
    return drawn(L, sn_image_paste(m, from, x - 1, y - 1, &err), &err);
}

static int image_fill(lua_State *L) /* img:fill{x=1, y=1, width=, height=, color=} -> img */
{
    static const char *const keys[] = {"x", "y", "width", "height", "color", NULL};
    sn_image *m = check_canvas(L);
    float color[4];
    sn_error err;
    lsn_check_keys(L, 2, keys);
    int32_t x = opt_whole(L, "x", 1), y = opt_whole(L, "y", 1);
    int32_t width = opt_whole(L, "width", m->width), height = opt_whole(L, "height", m->height);
    if (!lsn_has(L, 2, "color")) return lsn_option_error(L, 2, NULL, "option 'color' is missing");
    lsn_opt_color(L, 2, "color", color);
    return drawn(L, sn_image_fill(m, x - 1, y - 1, width, height, color, &err), &err);
}

/* Pushes the numbers of option `points`, a list of {x, y}; returns how many points. */
static int32_t read_points(lua_State *L, double **out)
{
    static const char *const name[2] = {"x", "y"};
    if (!lsn_has(L, 2, "points")) (void)lsn_option_error(L, 2, NULL, "option 'points' is missing");
    (void)lua_getfield(L, 2, "points");
    int32_t n = lsn_check_list(L, -1, 2, "option 'points'");
    *out = lsn_push_numbers(L, 2 * (size_t)n);
    for (int32_t i = 0; i < n; i++) {
        if (lua_geti(L, -2, i + 1) != LUA_TTABLE || lua_rawlen(L, -1) != 2)
            (void)lsn_option_error(L, 2, "points", "point %d: {x, y} expected", i + 1);
        for (int k = 0; k < 2; k++) {
            lua_pushfstring(L, "option 'points': point %d: coordinate %s", i + 1, name[k]);
            (void)lua_geti(L, -2, k + 1);
            if (!lsn_to_number(L, -1, lua_tostring(L, -2), &(*out)[2 * (size_t)i + (size_t)k]))
                (void)luaL_argerror(L, 2, lua_tostring(L, -1));
            lua_pop(L, 2);
            (*out)[2 * (size_t)i + (size_t)k] -= 1.0;
        }
        lua_pop(L, 1);
    }
    return n;
}

static int image_line(lua_State *L) /* img:line{points={{x, y}, ...}, width=1, color="black"} -> img */
{
    static const char *const keys[] = {"points", "width", "color", NULL};
    sn_image *m = check_canvas(L);
    float color[4] = {0, 0, 0, 1};
    double *point;
    sn_error err;
    lsn_check_keys(L, 2, keys);
    double width = lsn_opt_positive(L, 2, "width", 1.0);
    lsn_opt_color(L, 2, "color", color);
    int32_t n = read_points(L, &point);
    return drawn(L, sn_image_line(m, point, n, width, color, &err), &err);
}

static int image_text(lua_State *L) /* img:text{x=, y=, text=, size=16, ...} -> img */
{
    static const char *const keys[] = {"x", "y", "text", "size", "color", "align", "rotate", NULL};
    static const char *const aligns[] = {"left", "center", "right", NULL};
    sn_image *m = check_canvas(L);
    sn_image_label label = {.color = {0, 0, 0, 1}};
    sn_error err;
    lsn_check_keys(L, 2, keys);
    label.x = need_number(L, "x") - 1.0;
    label.y = need_number(L, "y") - 1.0;
    label.text = need_text(L);
    label.size = lsn_opt_positive(L, 2, "size", default_text_size);
    label.rotate_deg = lsn_opt_number(L, 2, "rotate", 0.0);
    lsn_opt_color(L, 2, "color", label.color);
    const char *align = lsn_opt_string(L, 2, "align", "left");
    int k = 0;
    while (aligns[k] && strcmp(align, aligns[k]) != 0) k++;
    if (!aligns[k])
        return lsn_option_error(L, 2, "align", "unknown '%s' (%s)", align, lsn_push_known(L, align, aligns));
    label.align = (sn_text_align)k;
    return drawn(L, sn_image_text_draw(m, &label, &err), &err);
}

static int image_text_size(lua_State *L) /* img:text_size{text=, size=16} -> width, height, ascent */
{
    static const char *const keys[] = {"text", "size", NULL};
    sn_text_size out;
    sn_error err;
    (void)lsn_check_image(L, 1);
    lsn_check_keys(L, 2, keys);
    double size = lsn_opt_positive(L, 2, "size", default_text_size);
    if (sn_image_text_measure(need_text(L), size, &out, &err)) return lsn_raise(L, &err);
    lua_pushnumber(L, out.width);
    lua_pushnumber(L, out.height);
    lua_pushnumber(L, out.ascent);
    return 3;
}

static int image_flip(lua_State *L) /* img:flip() -> image */
{
    const sn_image *m = lsn_check_image(L, 1);
    sn_image *out = lsn_push_image(L);
    size_t size = 4 * (size_t)m->width * (size_t)m->height;
    sn_error err;
    if (sn_image_reserve(out, m->width, m->height, &err)) return lsn_raise(L, &err);
    memcpy(out->rgba, m->rgba, size);
    sn_image_flip(out);
    lsn_account(L, size);
    return 1;
}

static int image_resize(lua_State *L) /* img:resize(w, h) -> image */
{
    const sn_image *m = lsn_check_image(L, 1);
    int32_t side[2];
    for (int k = 0; k < 2; k++) {
        lua_Integer n = luaL_checkinteger(L, 2 + k);
        if (n < 1 || n > SN_IMAGE_MAX_SIDE)
            return luaL_argerror(L, 2 + k,
                                 lua_pushfstring(L, "%s is %I, need 1..%d pixels", k ? "height" : "width",
                                                 (LUAI_UACINT)n, SN_IMAGE_MAX_SIDE));
        side[k] = (int32_t)n;
    }
    sn_error err;
    if (sn_image_resize(lsn_push_image(L), m, side[0], side[1], &lsn_get_state(L)->run, &err))
        return lsn_raise(L, &err);
    lsn_account(L, 4 * (size_t)side[0] * (size_t)side[1]);
    return 1;
}

void lsn_open_image(lua_State *L)
{
    static const luaL_Reg meta[] = {
        {"__gc", image_gc}, {"__close", image_gc}, {"__tostring", image_tostring}, {NULL, NULL}};
    static const luaL_Reg methods[] = {{"save", image_save},
                                       {"width", image_width},
                                       {"height", image_height},
                                       {"pixel", image_pixel},
                                       {"paste", image_paste},
                                       {"fill", image_fill},
                                       {"line", image_line},
                                       {"text", image_text},
                                       {"text_size", image_text_size},
                                       {"resize", image_resize},
                                       {"flip", image_flip},
                                       {"close", image_gc},
                                       {NULL, NULL}};
    static const luaL_Reg functions[] = {
        {"new", image_new}, {"load", image_load}, {"compare", image_compare}, {NULL, NULL}};
    lsn_new_type(L, LSN_IMAGE, meta, methods);
    luaL_newlib(L, functions);
    lua_setfield(L, -2, "image");
}
