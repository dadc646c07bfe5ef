/* lsn.h - what the binding files share: one file per core module, no logic in any of them.
 *
 * Wrong use raises through luaL_argerror and its kin; failed computation raises with core's message through
 * lsn_raise; files that cannot be read or written return nil, message through lsn_nil_error. Both remember
 * the message with its status, so that the program can turn an error that reaches the top into its exit code.
 *
 * Any call with a lua_State may raise, which jumps: what is allocated lives in a userdata before the next
 * such call. */
#ifndef LSN_H
#define LSN_H

#include "base/notes.h"
#include "base/run.h"
#include "base/status.h"
#include "base/vec3.h"
#include "extract/extraction.h"
#include "mesh/mesh_check.h"
#include "mesh/shape.h"
#include "mesh/tri_mesh.h"
#include "render/camera.h"
#include "render/context.h"
#include "render/image.h"
#include "scene/scene.h"
#include "scene/scene_bones.h"
#include "skeleton/bone_library.h"

#include <lauxlib.h>
#include <lua.h>

#define LSN_SURFACE "sinew.surface"
#define LSN_SHAPE "sinew.shape"
#define LSN_SCENE "sinew.scene"
#define LSN_BONE "sinew.bone"
#define LSN_MUSCLE "sinew.muscle"
#define LSN_HEAD "sinew.head"
#define LSN_EXTRACTION "sinew.extraction"
#define LSN_PART "sinew.part"
#define LSN_TETS "sinew.tets"
#define LSN_IMAGE "sinew.image"
#define LSN_VEC3 "sinew.vec3"

int luaopen_sinew(lua_State *L); /* the module table `sinew` */

/* ---- the state around the bindings: made by luaopen_sinew, used by the program ---- */
typedef struct lsn_state {
    sn_run run; /* threads, cancel flag, deadline, progress: set by the program                         */
    sn_renderer renderer; /* what pictures are drawn with unless they say                               */
    void (*warn)(void *user, const char *line); /* receives every warning line; NULL: dropped           */
    void *warn_user;
    int64_t n_warning;
    sn_status last_status; /* of the last message given to Lua by lsn_raise or lsn_nil_error           */
    char last_message[512];
} lsn_state;
lsn_state *lsn_get_state(lua_State *L);
/* The status that a final error message stands for: that of the last core failure when the message contains
 * its text, else SN_EINVAL. */
sn_status lsn_status_of(lua_State *L, const char *message);
/* Pushes the newest scene that is not closed, or nil (for -o and the REPL). The scene made last is kept alive
 * for this even when the script has let go of it. */
void lsn_push_last_scene(lua_State *L);

/* ---- errors and warnings ---- */
int lsn_raise(lua_State *L,
              const sn_error *err); /* luaL_error with position, remembers the status; never returns */
int lsn_nil_error(lua_State *L, const sn_error *err); /* pushes nil, message; returns 2 */
int lsn_fail(lua_State *L, sn_status code, const char *fmt, ...)
    SN_PRINTF(3, 4); /* lsn_raise with a text of its own */
int lsn_saved(lua_State *L, sn_status st,
              const sn_error *err); /* what a save returns: true, or nil and the message  */
void lsn_warn(lua_State *L, const char *fmt, ...) SN_PRINTF(2, 3); /* one line to state->warn */
/* Hands the scene's new warnings to state->warn and clears them. */
void lsn_flush_notes(lua_State *L, sn_scene *s);

/* ---- arguments ---- */
/* Options `point` (the origin when there is none) and `normal` of the table at arg, which has no others. */
void lsn_read_plane(lua_State *L, int arg, sn_vec3 *point, sn_vec3 *normal);
/* Options `axis` and `degrees` of the table at arg; the axis has a length. */
void lsn_read_turn(lua_State *L, int arg, sn_vec3 *axis, double *degrees);
/* The same of option `rotate` at arg; false, and nothing read, when there is none. */
bool lsn_opt_turn(lua_State *L, int arg, sn_vec3 *axis, double *degrees);
/* The table at arg (none or nil: no options) holds only these keys: else "unknown option 'lenght' (did you
 * mean 'length'? known: length, ...)". Of several unknown keys the first in the alphabet is named. */
void lsn_check_keys(lua_State *L, int arg, const char *const keys[]);
/* The value under key, which must be finite and a number, not a string that looks like one; def when there is
 * none. Errors name the key. */
double lsn_opt_number(lua_State *L, int arg, const char *key, double def);
double lsn_opt_positive(lua_State *L, int arg, const char *key, double def); /* > 0 when given */
int32_t lsn_opt_int(lua_State *L, int arg, const char *key, int32_t def);    /* >= 0 when given */
const char *lsn_opt_string(lua_State *L, int arg, const char *key, const char *def);
bool lsn_opt_bool(lua_State *L, int arg, const char *key, bool def);
bool lsn_has(lua_State *L, int arg, const char *key);
sn_vec3 lsn_check_point(lua_State *L, int arg,
                        const char *what); /* {x, y, z}, {x=, y=, z=} or vec3; finite */
sn_vec3 lsn_opt_point(lua_State *L, int arg, const char *key, sn_vec3 def, bool required);
/* A vec3: p.x p.y p.z p[1] p[2] p[3], #p, ==, tostring, + - * / and unary -. */
void lsn_push_point(lua_State *L, sn_vec3 p);
int32_t lsn_check_index(lua_State *L, int arg, int32_t n); /* 1-based outside, 0-based inside */
double lsn_check_finite(lua_State *L, int arg);
const char *lsn_check_text(lua_State *L, int arg); /* a string (no number) without zero bytes: names, paths */
/* Raises "option 'key': what" for the option table at arg; key NULL: "what" alone. Never returns. */
int lsn_option_error(lua_State *L, int arg, const char *key, const char *fmt, ...);
/* Reads the option `key` as an option table of its own: while it is entered it stands in the place of arg, so
 * that errors name the argument that the user gave. false when there is none; else lsn_leave puts the outer
 * table back. Between the two the stack must be balanced. */
bool lsn_enter(lua_State *L, int arg, const char *key);
void lsn_leave(lua_State *L, int arg);
void lsn_enter_top(lua_State *L, int arg); /* the same for the table on top of the stack */
/* Reads the value at stack index idx; on failure pushes "what: {x, y, z} expected, got ..." and returns
 * false. */
bool lsn_to_point(lua_State *L, int idx, const char *what, sn_vec3 *out);
bool lsn_to_number(lua_State *L, int idx, const char *what, double *out);
/* Length of the list at stack index idx; raises for arg when it is no table or longer than INT32_MAX. */
int32_t lsn_check_list(lua_State *L, int idx, int arg, const char *what);
/* Stack room for a list of n numbers, freed by the collector. Pushes one value. */
double *lsn_push_numbers(lua_State *L, size_t n);
/* Pushes the values of option `key` for n things: a number for all of them, or a list of n; `what` they are
 * called in messages ("points"). NULL, and nothing pushed, when there is none. */
const double *lsn_push_each(lua_State *L, int arg, const char *key, int32_t n, const char *what);
/* Pushes "known: a, b, c" of a NULL-ended list, with "did you mean 'b'? " before it when word is near one. */
const char *lsn_push_known(lua_State *L, const char *word, const char *const keys[]);

/* ---- pictures ---- */
/* Option `size` of the table at arg, {width, height} in pixels: {800, 600} when there is none. */
void lsn_read_size(lua_State *L, int arg, int32_t *width, int32_t *height);
/* A colour option: a name, "#rrggbb", {r, g, b} or {r, g, b, a} in 0..1. out is untouched when there is none.
 */
void lsn_opt_color(lua_State *L, int arg, const char *key, float out[4]);
/* Option `camera` of the table at arg: the name of a view, {eye=, target=, up=, fov=} or {azimuth=,
 * elevation=, zoom=}; "front" when there is none. Views fit the bounds of the scene into a picture of that
 * size. */
void lsn_read_camera(lua_State *L, int arg, const sn_scene *s, int32_t width, int32_t height, sn_camera *out);

/* ---- tables that go out ---- */
void lsn_set_number(lua_State *L, const char *key, double value); /* into the table on top of the stack */
void lsn_set_integer(lua_State *L, const char *key, int64_t value);
void lsn_set_bool(lua_State *L, const char *key, bool value);
void lsn_set_point(lua_State *L, const char *key, sn_vec3 p);
void lsn_push_box(lua_State *L, sn_box3 b); /* {min=, max=} */

/* ---- objects ---- */
/* Makes the metatable of a type: __index finds the methods, an unknown one raises with the nearest name. Both
 * lists are static and end with {NULL, NULL}. */
void lsn_new_type(lua_State *L, const char *type, const luaL_Reg *meta, const luaL_Reg *methods);
/* Raises for the name at index 2 that none of the methods has; returns 0 when it is no string. */
int lsn_unknown_method(lua_State *L, const char *type, const luaL_Reg *method);
/* Pushes a userdata of that type, all bytes 0, with n_uv user values. */
void *lsn_new_object(lua_State *L, const char *type, size_t size, int n_uv);
/* Pushes a box that releases what its pointer holds (by sn_release) when it is collected, or at once by
 * lsn_empty_owner. For arrays that core hands out. */
void **lsn_push_owner(lua_State *L);
void lsn_empty_owner(void **box);
/* Tells the collector that the object on top of the stack holds this many bytes it cannot see. */
void lsn_account(lua_State *L, size_t bytes);

sn_tri_mesh *lsn_push_surface(lua_State *L); /* pushes an empty surface and returns it to be filled */
const sn_tri_mesh *lsn_check_surface(lua_State *L, int arg);
void lsn_push_check(lua_State *L, const sn_mesh_check *check); /* what surface:check() returns */
int lsn_surface_repair(lua_State *L);                          /* a method of surfaces, in lsn_repair.c */
sn_shape *lsn_check_shape(lua_State *L, int arg);
sn_image *lsn_push_image(lua_State *L);
const sn_image *lsn_check_image(lua_State *L, int arg);
/* Sets a text chunk that img:save writes (key: Software, Camera or Renderer); pops the string on top of the
 * stack. */
void lsn_set_image_text(lua_State *L, int image, const char *key);
/* Writes the image at stack index idx with its texts. */
sn_status lsn_save_image(lua_State *L, int idx, const char *path, sn_error *err);
sn_tet_mesh *lsn_push_tets(lua_State *L);
const sn_tet_mesh *lsn_check_tets(lua_State *L, int arg);
sn_extraction *lsn_push_extraction(lua_State *L, int tets); /* tets: stack index of the tets that are cut */
sn_scene *lsn_check_scene(lua_State *L, int arg);
/* Pushes the handle of a bone or muscle (type) of the scene at stack index `scene`. It keeps the scene alive.
 */
void lsn_push_member(lua_State *L, const char *type, int scene, const char *name);
/* The scene and name that a handle stands for. */
sn_scene *lsn_check_member(lua_State *L, int arg, const char *type, const char **name);
int lsn_member_eq(lua_State *L); /* __eq of handles: the same scene and name */
/* The name at arg: a string, or a handle of that type. */
const char *lsn_check_name(lua_State *L, int arg, const char *type);
/* Flushes the scene's notes, then raises when st is not SN_OK. */
void lsn_scene_must(lua_State *L, sn_scene *s, sn_status st, const sn_error *err);

/* The muscle whose handle is at arg; raises when it was removed. */
int32_t lsn_find_muscle(lua_State *L, int arg, sn_scene **s);
/* Reads options `points` and `tissue`, or `heads`, at arg. What the heads point to stays on the stack. */
const sn_head_points *lsn_push_heads(lua_State *L, int arg, int32_t *n);
/* Reads options `kind`, `angle`, `sheets` at arg. */
sn_pennation lsn_read_pennation(lua_State *L, int arg);
void lsn_set_triad(lua_State *L, sn_triad f); /* e1, e2, e3 into the table on top of the stack */

sn_bone_library *lsn_bone_library(lua_State *L);              /* the one of this state */
void lsn_push_clearance(lua_State *L, const sn_clearance *c); /* {least=, at=, outside=, near=} */
void lsn_push_clearance_report(lua_State *L, const sn_clearance_report *r);
/* Pushes the pixels of the list of {x, y} at stack index `list`; errors are for arg. */
const double *lsn_push_pixels(lua_State *L, int list, int arg, int32_t *n);

/* ---- methods of a muscle that live in lsn_head.c: of its one head, when argument 1 is a muscle ---- */
int lsn_muscle_head_count(lua_State *L);
int lsn_muscle_head(lua_State *L);
int lsn_head_point_count(lua_State *L);
int lsn_head_point(lua_State *L);
int lsn_head_set_point(lua_State *L);
int lsn_head_insert_point(lua_State *L);
int lsn_head_remove_point(lua_State *L);
int lsn_head_tissue(lua_State *L);
int lsn_head_set_tissue(lua_State *L);
int lsn_head_curve(lua_State *L);

/* The extraction and tissue of the part at argument 1; *input receives the tets that were cut, NULL when
 * closed. */
const sn_extraction *lsn_check_part(lua_State *L, int32_t *tissue, const sn_tet_mesh **input);
const sn_extraction *lsn_check_extraction(lua_State *L, const sn_tet_mesh **input);
void lsn_set_architecture(lua_State *L, const sn_part_architecture *a); /* into the table on top */

/* ---- methods of parts and extractions that live in lsn_fibers.c ---- */
int lsn_part_fibers(lua_State *L);
int lsn_part_fiber_lines(lua_State *L);
int lsn_part_architecture(lua_State *L);
int lsn_extraction_fiber_lines(lua_State *L);

/* ---- methods of a scene that live in other files ---- */
int lsn_scene_render(lua_State *L);
int lsn_scene_extract(lua_State *L);
int lsn_scene_add_bone(lua_State *L);
int lsn_scene_bone(lua_State *L);
int lsn_scene_bones(lua_State *L);
int lsn_scene_remove_bone(lua_State *L);
int lsn_scene_place_bone(lua_State *L);
int lsn_scene_mirror_bones(lua_State *L);
int lsn_scene_cut(lua_State *L);
int lsn_scene_add_joint(lua_State *L);
int lsn_scene_remove_joint(lua_State *L);
int lsn_scene_joints(lua_State *L);
int lsn_scene_add_muscle(lua_State *L);
int lsn_scene_muscle(lua_State *L);
int lsn_scene_muscles(lua_State *L);
int lsn_scene_remove_muscle(lua_State *L);
int lsn_scene_draw_muscle(lua_State *L);

/* ---- one opener per file: registers metatables, fills fields of the module table on top of the stack ----
 */
void lsn_open_vec3(lua_State *L);
void lsn_open_surface(lua_State *L);
void lsn_open_shape(lua_State *L);
void lsn_open_scene(lua_State *L);
void lsn_open_bone(lua_State *L);
void lsn_open_bones(lua_State *L);
void lsn_open_place(lua_State *L);
void lsn_open_muscle(lua_State *L);
void lsn_open_head(lua_State *L);
void lsn_open_extraction(lua_State *L);
void lsn_open_fibers(lua_State *L);
void lsn_open_tets(lua_State *L);
void lsn_open_image(lua_State *L);
void lsn_open_help(lua_State *L);

#endif
