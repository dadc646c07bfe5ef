/* lsn_fibers.c - fibers, fiber lines and architecture of parts. */
#include "lsn.h"

#include "base/alloc.h"

#include <string.h>

enum { default_lines = 100, max_lines = 1000000 };

#define FIBERS_BOX "sinew.fibers box"
#define FOLLOW_KEYS "points", "heads", "kind", "angle", "sheets", "axis", "frame_angle"

/* What has to be released however a call ends. */
typedef struct fibers_box {
    sn_part_fibers fibers;
    sn_muscle muscle; /* given in the call */
    sn_polylines lines;
    sn_vec3 *centre, *direction;
    double *u;
    bool *is_tendon;
} fibers_box;

static int box_gc(lua_State *L)
{
    fibers_box *b = luaL_checkudata(L, 1, FIBERS_BOX);
    sn_part_fibers_free(&b->fibers);
    sn_muscle_free(&b->muscle);
    sn_polylines_free(&b->lines);
    sn_release(b->centre);
    sn_release(b->direction);
    sn_release(b->u);
    sn_release(b->is_tendon);
    memset(b, 0, sizeof *b);
    return 0;
}

static fibers_box *push_box(lua_State *L)
{
    fibers_box *b = lsn_new_object(L, FIBERS_BOX, sizeof *b, 0);
    sn_polylines_init(&b->lines, true);
    return b;
}

static void empty_box(lua_State *L, int box)
{
    lua_pushcfunction(L, box_gc);
    lua_pushvalue(L, box);
    lua_call(L, 1, 0);
}

/* The muscle that the options at arg describe, in the box; NULL when they describe none. */
static const sn_muscle *read_muscle(lua_State *L, int arg, const char *name, fibers_box *b)
{
    int32_t n;
    sn_error err;
    if (!lsn_has(L, arg, "points") && !lsn_has(L, arg, "heads")) {
        static const char *const needs_curve[] = {"kind", "angle", "sheets", "axis", "frame_angle", NULL};
        for (int i = 0; needs_curve[i]; i++)
            if (lsn_has(L, arg, needs_curve[i]))
                (void)lsn_option_error(L, arg, needs_curve[i],
                                       "goes with a curve given here (option 'points' or 'heads')");
        return NULL;
    }
    sn_pennation p = lsn_read_pennation(L, arg);
    sn_anisotropy a = {.is_on = true, .eigenvalue = {1.0, 1.0, 1.0}};
    a.angle_deg = lsn_opt_number(L, arg, "frame_angle", 0.0);
    a.has_axis = lsn_has(L, arg, "axis");
    a.axis = lsn_opt_point(L, arg, "axis", sn_v3(0, 0, 0), false);
    const sn_head_points *head = lsn_push_heads(L, arg, &n);
    if (sn_muscle_init(&b->muscle, name, head, n, &err)) (void)lsn_raise(L, &err);
    if (sn_muscle_set_anisotropy(&b->muscle, &a, &err)) (void)lsn_raise(L, &err);
    if (sn_muscle_set_pennation(&b->muscle, &p, &err)) (void)lsn_raise(L, &err);
    return &b->muscle;
}

/* The fibers of the part at argument 1, by the options at argument 2. */
static const sn_extraction *build_part(lua_State *L, fibers_box *b)
{
    int32_t tissue;
    const sn_tet_mesh *input;
    const sn_extraction *x = lsn_check_part(L, &tissue, &input);
    const sn_muscle *m = read_muscle(L, 2, x->name[tissue], b);
    sn_error err;
    if (!input)
        (void)lsn_fail(L, SN_EINVAL, "part '%s': the tets it was cut from were closed", x->name[tissue]);
    if (sn_part_fibers_build(&b->fibers, x, input, tissue, m, &lsn_get_state(L)->run, &err))
        (void)lsn_raise(L, &err);
    return x;
}

/* ---- per tet ---- */

static void set_check(lua_State *L, const sn_fibers_check *c)
{
    lua_createtable(L, 0, 5);
    lsn_set_integer(L, "sinks", c->sinks);
    lsn_set_integer(L, "sources", c->sources);
    lsn_set_integer(L, "flipped", c->flipped);
    lsn_set_integer(L, "still", c->still);
    lsn_set_number(L, "worst_turn", c->worst_turn_deg);
}

int lsn_part_fibers(lua_State *L) /* part:fibers{...} -> list of {point=, direction=, u=, tendon=}, check */
{
    static const char *const keys[] = {FOLLOW_KEYS, NULL};
    lsn_check_keys(L, 2, keys);
    lua_settop(L, 2);
    fibers_box *b = push_box(L);
    const sn_extraction *x = build_part(L, b);
    int32_t n = b->fibers.n_tet;
    sn_fibers_check check;
    sn_error err;
    b->centre = SN_NEW(sn_vec3, n);
    b->direction = SN_NEW(sn_vec3, n);
    b->u = SN_NEW(double, n);
    b->is_tendon = SN_NEW(bool, n);
    if (!b->centre || !b->direction || !b->u || !b->is_tendon)
        return lsn_fail(L, SN_ENOMEM, "fibers: no memory for %d tets", n);
    if (sn_part_fibers_check(&b->fibers, x, &check, &err)) return lsn_raise(L, &err);
    sn_part_fibers_sample(&b->fibers, x, &lsn_get_state(L)->run, b->centre, b->direction, b->u, b->is_tendon);
    lua_createtable(L, n, 0);
    for (int32_t i = 0; i < n; i++) {
        lua_createtable(L, 0, 4);
        lsn_set_point(L, "point", b->centre[i]);
        lsn_set_point(L, "direction", b->direction[i]);
        lsn_set_number(L, "u", b->u[i]);
        lsn_set_bool(L, "tendon", b->is_tendon[i]);
        lua_rawseti(L, -2, i + 1);
    }
    set_check(L, &check);
    empty_box(L, 3);
    return 2;
}

/* ---- lines ---- */

static void push_line(lua_State *L, const sn_polylines *p, size_t i)
{
    lua_createtable(L, (int)(p->first[i + 1] - p->first[i]), 0);
    for (int64_t k = p->first[i]; k < p->first[i + 1]; k++) {
        lsn_push_point(L, sn_v3_load(p->pos + 3 * (size_t)k));
        lua_rawseti(L, -2, k - p->first[i] + 1);
    }
}

static int32_t read_count(lua_State *L, int arg)
{
    int32_t n = lsn_opt_int(L, arg, "count", default_lines);
    if (n < 1 || n > max_lines)
        (void)lsn_option_error(L, arg, "count", "%d lines, need 1..%d", n, (int)max_lines);
    return n;
}

/* Writes the lines when option `file` says so; raises when they cannot be written. */
static void write_lines(lua_State *L, int arg, const sn_polylines *lines, const sn_extraction *x)
{
    const char *path = lsn_opt_string(L, arg, "file", NULL);
    sn_error err;
    if (!path) return;
    if (sn_polylines_save(lines, (const char *const *)x->name, x->n_tissue, path, &err))
        (void)lsn_raise(L, &err);
}

int lsn_part_fiber_lines(lua_State *L) /* part:fiber_lines{count=, file=, ...} -> list of lists of points */
{
    static const char *const keys[] = {"count", "file", FOLLOW_KEYS, NULL};
    lsn_check_keys(L, 2, keys);
    lua_settop(L, 2);
    int32_t n = read_count(L, 2);
    fibers_box *b = push_box(L);
    const sn_extraction *x = build_part(L, b);
    sn_error err;
    if (sn_part_fibers_lines(&b->fibers, x, n, &lsn_get_state(L)->run, &b->lines, &err))
        return lsn_raise(L, &err);
    write_lines(L, 2, &b->lines, x);
    lua_createtable(L, (int)b->lines.n_line, 0);
    for (size_t i = 0; i < b->lines.n_line; i++) {
        push_line(L, &b->lines, i);
        lua_rawseti(L, -2, (lua_Integer)i + 1);
    }
    empty_box(L, 3);
    return 1;
}

int lsn_extraction_fiber_lines(lua_State *L) /* x:fiber_lines{count=, file=} -> {NAME=lines, ...} */
{
    static const char *const keys[] = {"count", "file", NULL};
    const sn_tet_mesh *input;
    const sn_extraction *x = lsn_check_extraction(L, &input);
    lsn_check_keys(L, 2, keys);
    lua_settop(L, 2);
    int32_t n = read_count(L, 2);
    fibers_box *b = push_box(L);
    sn_error err;
    if (x->n_muscle == 0) return lsn_fail(L, SN_EINVAL, "no part has a curve that fibers could follow");
    if (!input) return lsn_fail(L, SN_EINVAL, "the tets that the extraction was cut from were closed");
    lua_createtable(L, 0, x->n_muscle);
    for (int32_t i = 0; i < x->n_muscle; i++) {
        size_t first = b->lines.n_line;
        sn_status st = sn_part_fibers_build(&b->fibers, x, input, 1 + i, NULL, &lsn_get_state(L)->run, &err);
        if (st == SN_EINVAL) lsn_warn(L, "%s: no lines", err.msg);
        if (!st) st = sn_part_fibers_lines(&b->fibers, x, n, &lsn_get_state(L)->run, &b->lines, &err);
        sn_part_fibers_free(&b->fibers);
        if (st && st != SN_EINVAL) return lsn_raise(L, &err);
        lua_createtable(L, (int)(b->lines.n_line - first), 0);
        for (size_t k = first; k < b->lines.n_line; k++) {
            push_line(L, &b->lines, k);
            lua_rawseti(L, -2, (lua_Integer)(k - first) + 1);
        }
        lua_setfield(L, -2, x->name[1 + i]);
    }
    write_lines(L, 2, &b->lines, x);
    empty_box(L, 3);
    return 1;
}

/* ---- architecture ---- */

void lsn_set_architecture(lua_State *L, const sn_part_architecture *a)
{
    lsn_set_number(L, "fiber_length", a->fiber_length);
    lsn_set_number(L, "pennation_angle", a->pennation_deg);
    lsn_set_number(L, "pcsa", a->pcsa);
    lsn_set_number(L, "belly_volume", a->belly_volume);
    lsn_set_number(L, "tendon_volume", a->volume - a->belly_volume);
    set_check(L, &a->check);
    lua_setfield(L, -2, "fiber_check");
}

int lsn_part_architecture(
    lua_State *L) /* part:architecture{...} -> {fiber_length=, pennation_angle=, pcsa=, ...} */
{
    static const char *const keys[] = {FOLLOW_KEYS, NULL};
    lsn_check_keys(L, 2, keys);
    lua_settop(L, 2);
    fibers_box *b = push_box(L);
    const sn_extraction *x = build_part(L, b);
    sn_part_architecture a;
    sn_error err;
    if (sn_part_architecture_find(&b->fibers, x, &lsn_get_state(L)->run, &a, &err)) return lsn_raise(L, &err);
    lua_createtable(L, 0, 7);
    lsn_set_number(L, "volume", a.volume);
    lsn_set_architecture(L, &a);
    empty_box(L, 3);
    return 1;
}

void lsn_open_fibers(lua_State *L)
{
    static const luaL_Reg meta[] = {{"__gc", box_gc}, {NULL, NULL}}, none[] = {{NULL, NULL}};
    lsn_new_type(L, FIBERS_BOX, meta, none);
}
