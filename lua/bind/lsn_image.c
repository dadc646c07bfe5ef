/* lsn_image.c - pictures in memory. */
#include "lsn.h"

#include <string.h>

typedef struct picture {
    sn_image image;
} picture; /* user value: nil, or a table of the texts that save writes */

/* The texts a picture may carry, in the order in which they are written. */
static const char *const text_keys[] = {"Software", "Camera", "Renderer"};
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

void lsn_open_image(lua_State *L)
{
    static const luaL_Reg meta[] = {
        {"__gc", image_gc}, {"__close", image_gc}, {"__tostring", image_tostring}, {NULL, NULL}};
    static const luaL_Reg methods[] = {{"save", image_save},     {"width", image_width},
                                       {"height", image_height}, {"pixel", image_pixel},
                                       {"close", image_gc},      {NULL, NULL}};
    static const luaL_Reg functions[] = {{"load", image_load}, {"compare", image_compare}, {NULL, NULL}};
    lsn_new_type(L, LSN_IMAGE, meta, methods);
    luaL_newlib(L, functions);
    lua_setfield(L, -2, "image");
}
