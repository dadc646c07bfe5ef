/* lsn_repair.c - surface:repair{}: options in, the report as a table out. */
#include "lsn.h"

#include "mesh/repair.h"

#include <string.h>

static double length_or(lua_State *L, const char *key, double def)
{
    double value = lsn_opt_number(L, 2, key, def);
    if (lsn_has(L, 2, key) && value < 0.0)
        (void)lsn_option_error(L, 2, key, "number of at least 0 expected, got %f", value);
    return value;
}

static sn_wrap read_wrap(lua_State *L)
{
    static const char *const name[] = {"auto", "always", "never", NULL};
    const char *word = lsn_opt_string(L, 2, "wrap", "auto");
    for (int i = 0; name[i]; i++)
        if (strcmp(word, name[i]) == 0) return (sn_wrap)i;
    (void)lsn_option_error(L, 2, "wrap", "unknown value '%s' (%s)", word, lsn_push_known(L, word, name));
    return SN_WRAP_AUTO;
}

static bool read_largest(lua_State *L)
{
    static const char *const name[] = {"all", "largest", NULL};
    const char *word = lsn_opt_string(L, 2, "components", "all");
    if (strcmp(word, "all") != 0 && strcmp(word, "largest") != 0)
        (void)lsn_option_error(L, 2, "components", "unknown value '%s' (%s)", word,
                               lsn_push_known(L, word, name));
    return strcmp(word, "largest") == 0;
}

static sn_repair read_options(lua_State *L)
{
    static const char *const keys[] = {
        "weld",  "fill_holes", "self_intersections", "components", "wrap", "tolerance",
        "alpha", "offset",     "time_limit",         NULL};
    sn_repair opt = sn_repair_defaults();
    lsn_check_keys(L, 2, keys);
    opt.weld = length_or(L, "weld", opt.weld);
    opt.fill_holes = length_or(L, "fill_holes", opt.fill_holes);
    opt.untangle = lsn_opt_bool(L, 2, "self_intersections", opt.untangle);
    opt.largest = read_largest(L);
    opt.wrap = read_wrap(L);
    opt.tolerance = lsn_opt_positive(L, 2, "tolerance", 0.0);
    opt.alpha = lsn_opt_positive(L, 2, "alpha", 0.0);
    opt.offset = lsn_opt_positive(L, 2, "offset", 0.0);
    opt.time_limit = lsn_opt_positive(L, 2, "time_limit", 0.0);
    return opt;
}

static void push_step(lua_State *L, const sn_repair_step *s)
{
    lua_createtable(L, 0, s->n_count + 2);
    lua_pushstring(L, s->name);
    lua_setfield(L, -2, "name");
    lsn_set_number(L, "moved", s->moved);
    for (int i = 0; i < s->n_count; i++) lsn_set_integer(L, s->count[i].name, s->count[i].n);
}

static void push_report(lua_State *L, const sn_repair_report *r)
{
    lua_createtable(L, 0, 8);
    lua_createtable(L, r->n_step, 0);
    for (int i = 0; i < r->n_step; i++) {
        push_step(L, &r->step[i]);
        lua_rawseti(L, -2, i + 1);
    }
    lua_setfield(L, -2, "steps");
    lsn_set_bool(L, "wrapped", r->wrapped);
    lsn_set_number(L, "moved", r->moved);
    lsn_set_number(L, "missed", r->missed);
    if (r->wrapped) {
        lsn_set_number(L, "tolerance", r->tolerance);
        lsn_set_number(L, "alpha", r->alpha);
        lsn_set_number(L, "offset", r->offset);
    }
    lsn_push_check(L, &r->check);
    lua_setfield(L, -2, "check");
}

int lsn_surface_repair(lua_State *L) /* s:repair{...} -> surface, report */
{
    const sn_tri_mesh *m = lsn_check_surface(L, 1);
    sn_repair opt = read_options(L);
    sn_repair_report report;
    sn_error err;
    sn_tri_mesh *out = lsn_push_surface(L);
    if (sn_repair_run(m, &opt, &lsn_get_state(L)->run, out, &report, &err)) return lsn_raise(L, &err);
    lsn_account(L, 24 * (size_t)out->n_vert + 12 * (size_t)out->n_face);
    push_report(L, &report);
    return 2;
}
