#include "mesh/repair.h"

#include "base/alloc.h"
#include "mesh/repair_private.h"

#include <stdio.h>
#include <string.h>

#define WELD_REL 1e-6 /* of the input's diagonal, as the next two */
#define FILL_REL 0.25
#define TOLERANCE_REL 0.003
#define WRAP_FACES 0.5 /* a wrap has about that times area / tolerance^2 faces (measured) */
#define MAX_WRAP_FACES                                                                                       \
    1e5                   /* the tolerance that is set when none is given asks for no more than about these */
#define CRUMB_REL 1e-3    /* of the area: open components below are left out */
#define UNTANGLE_ROUNDS 3 /* rounding the exact result may leave a few crossings for the next round */
#define MAY_MISS_REL                                                                                         \
    0.02 /* of the diagonal: where untangling cut off more, wrapping is the better answer                    \
          */

sn_repair sn_repair_defaults(void)
{
    return (sn_repair){.weld = -1.0, .fill_holes = -1.0, .untangle = true, .memory_limit = (size_t)6 << 30};
}

typedef struct repair {
    const sn_tri_mesh *in;
    sn_repair opt; /* with all lengths set */
    const sn_run *run;
    double diagonal;
    bool may_fill_all;   /* the user has not said which holes to fill */
    sn_tri_mesh m;       /* the surface so far */
    sn_mesh_check check; /* of it */
    sn_repair_report *report;
    sn_error *err;
} repair;

/* ---- the report ---- */

static sn_repair_step *add_step(repair *r, const char *name)
{
    sn_repair_report *p = r->report;
    sn_repair_step *s = &p->step[p->n_step < SN_REPAIR_MAX_STEPS - 1 ? p->n_step++ : SN_REPAIR_MAX_STEPS - 1];
    *s = (sn_repair_step){.name = name};
    return s;
}

static void add_count(sn_repair_step *s, const char *name, int64_t n)
{
    s->count[s->n_count++] = (sn_repair_count){name, n};
}

/* ---- options ---- */

static sn_status check_options(const sn_repair *opt, sn_error *err)
{
    const struct {
        const char *name;
        double value;
    } length[] = {{"weld", opt->weld},   {"fill_holes", opt->fill_holes}, {"tolerance", opt->tolerance},
                  {"alpha", opt->alpha}, {"offset", opt->offset},         {"time_limit", opt->time_limit}};
    for (size_t i = 0; i < sizeof length / sizeof *length; i++) {
        bool has_default = i < 2; /* by a negative number */
        if (!isfinite(length[i].value) || (!has_default && length[i].value < 0.0))
            return sn_fail(err, SN_EINVAL, "repair: %s is %g, need a finite number >= 0", length[i].name,
                           length[i].value);
    }
    if (opt->wrap != SN_WRAP_AUTO && opt->wrap != SN_WRAP_ALWAYS && opt->wrap != SN_WRAP_NEVER)
        return sn_fail(err, SN_EINVAL, "repair: wrap is %d, need auto, always or never", (int)opt->wrap);
    return SN_OK;
}

static sn_status set_lengths(repair *r)
{
    sn_repair *o = &r->opt;
    r->diagonal = sn_box3_diagonal(sn_tri_mesh_bounds(r->in));
    if (!(r->diagonal > 0.0 && isfinite(r->diagonal)))
        return sn_fail(r->err, SN_EINVAL, "repair: the surface has an extent of %g", r->diagonal);
    if (r->in->n_face > INT32_MAX / 3)
        return sn_fail(r->err, SN_ELIMIT, "repair: %d faces, need at most %d", r->in->n_face, INT32_MAX / 3);
    if (o->weld < 0.0) o->weld = WELD_REL * r->diagonal;
    r->may_fill_all = o->fill_holes < 0.0;
    if (o->fill_holes < 0.0) o->fill_holes = FILL_REL * r->diagonal;
    if (o->tolerance == 0.0)
        o->tolerance =
            fmax(TOLERANCE_REL * r->diagonal, sqrt(WRAP_FACES / MAX_WRAP_FACES * sn_tri_mesh_area(r->in)));
    r->report->tolerance = o->tolerance;
    return SN_OK;
}

static sn_status check_now(repair *r)
{
    return sn_mesh_check_run(&r->check, &r->m, r->run, r->err);
}

static bool is_whole(const sn_mesh_check *c)
{
    return c->closed && c->manifold && c->oriented;
}

static bool is_usable(const sn_mesh_check *c)
{
    return is_whole(c) && c->self_intersections == 0 && c->degenerate_faces == 0;
}

/* ---- steps ---- */

static sn_status copy_input(repair *r)
{
    sn_status st = sn_tri_mesh_copy(&r->m, r->in, r->err);
    if (st) return st;
    sn_release(r->m.label);
    r->m.label = NULL;
    return SN_OK;
}

static sn_status weld(repair *r)
{
    sn_repair_step *s = add_step(r, "weld");
    int32_t n_joined = 0;
    sn_status st = sn_repair_weld(&r->m, r->opt.weld, &n_joined, &s->moved, r->err);
    add_count(s, "joined_vertices", n_joined);
    return st;
}

static sn_status clean(repair *r)
{
    sn_repair_step *s = add_step(r, "clean");
    sn_clean_counts n = {0, 0, 0};
    sn_status st = sn_repair_clean(&r->m, &n, r->err);
    add_count(s, "degenerate_faces", n.degenerate);
    add_count(s, "duplicate_faces", n.duplicate);
    add_count(s, "unused_vertices", n.unused);
    if (!st && r->m.n_face == 0)
        return sn_fail(r->err, SN_EMESH, "repair: no face has an area that the weld tolerance of %.4g leaves",
                       r->opt.weld);
    return st;
}

/* Takes made for the surface so far and measures how far it lies from the one before. */
static sn_status replace(repair *r, sn_tri_mesh *made, sn_repair_step *s)
{
    sn_status st = sn_repair_moved(made, &r->m, r->run, &s->moved, r->err);
    sn_tri_mesh_free(&r->m);
    r->m = *made;
    sn_tri_mesh_init(made);
    return st;
}

/* A mesher that gives up is no reason to give up: the wrap may still do. */
static bool may_go_on(const repair *r, sn_status st)
{
    return st == SN_EMESH && r->opt.wrap != SN_WRAP_NEVER;
}

static sn_status orient_and_fill(repair *r)
{
    sn_repair_step *orient = add_step(r, "orient"), *fill = add_step(r, "fill");
    sn_repair_counts n = {0};
    sn_tri_mesh made;
    sn_tri_mesh_init(&made);
    sn_status st = SN_OK;
    if (!is_whole(&r->check)) {
        double crumb = CRUMB_REL * sn_tri_mesh_area(&r->m);
        st = sn_repair_in_child(SN_TASK_ORIENT_FILL, &r->m,
                                (sn_repair_sizes){.hole = r->opt.fill_holes, .crumb = crumb}, &r->opt, r->run,
                                &made, &n, r->err);
        if (!st && made.n_face > 0) st = replace(r, &made, fill);
        if (may_go_on(r, st)) st = SN_OK;
    }
    add_count(orient, "turned_faces", n.turned);
    add_count(orient, "split_vertices", n.split_vertices);
    add_count(orient, "stitched_edges", n.stitched);
    add_count(orient, "removed_crumbs", n.crumbs);
    add_count(fill, "filled_holes", n.filled);
    add_count(fill, "added_faces", n.added);
    add_count(fill, "left_holes", n.left);
    sn_tri_mesh_free(&made);
    return st ? st : check_now(r);
}

static sn_status sort_components(repair *r, bool only_largest)
{
    sn_repair_step *s = add_step(r, "components");
    sn_part_counts n = {0, 0, 0};
    sn_status st = is_whole(&r->check) ? sn_repair_parts(&r->m, only_largest, r->run, &n, r->err) : SN_OK;
    add_count(s, "turned", n.turned);
    add_count(s, "removed_inside", n.inside);
    add_count(s, "removed_others", n.others);
    return st ? st : check_now(r);
}

/* Cuts and unites until nothing crosses or nothing gets better. */
static sn_status untangle_rounds(repair *r, sn_repair_counts *sum, sn_repair_step *s)
{
    for (int round = 0; round < UNTANGLE_ROUNDS && r->check.self_intersections > 0; round++) {
        int64_t before = r->check.self_intersections;
        sn_tri_mesh made;
        sn_repair_counts n = {0};
        sn_tri_mesh_init(&made);
        sn_status st = sn_repair_in_child(SN_TASK_UNTANGLE, &r->m, (sn_repair_sizes){0}, &r->opt, r->run,
                                          &made, &n, r->err);
        if (!st && made.n_face > 0) st = replace(r, &made, s);
        if (!st) st = check_now(r);
        sn_tri_mesh_free(&made);
        if (st) return st;
        sum->unions += n.unions;
        sum->mended += n.mended;
        if (!is_whole(&r->check) || r->check.self_intersections >= before) break;
    }
    return SN_OK;
}

/* Has untangling cut off what was seen from outside? */
static sn_status judge_untangling(repair *r, const sn_tri_mesh *before, bool *is_good)
{
    double missed = 0.0;
    *is_good = is_usable(&r->check);
    if (!*is_good) return SN_OK;
    sn_status st = sn_repair_missed(&r->m, before, r->run, &missed, r->err);
    *is_good = missed <= MAY_MISS_REL * r->diagonal;
    return st;
}

/* Goes back to the surface before when it does not get good: the wrap wants that one. */
static sn_status untangle(repair *r)
{
    if (!is_whole(&r->check) || r->check.self_intersections == 0 || !r->opt.untangle) return SN_OK;
    sn_repair_step *s = add_step(r, "untangle");
    sn_repair_counts n = {0};
    sn_tri_mesh before;
    bool is_good = false;
    int64_t crossings = r->check.self_intersections;
    sn_tri_mesh_init(&before);
    sn_status st = sn_tri_mesh_copy(&before, &r->m, r->err);
    if (!st) st = untangle_rounds(r, &n, s);
    if (!st) st = judge_untangling(r, &before, &is_good);
    if (may_go_on(r, st)) st = SN_OK;
    add_count(s, "crossings_before", crossings);
    add_count(s, "crossings_after", r->check.self_intersections);
    add_count(s, "mended_components", n.mended);
    add_count(s, "unions", n.unions);
    add_count(s, "taken_back", !st && !is_good);
    if (!st && is_good) st = sort_components(r, r->opt.largest);
    if (!st && !is_good) {
        s->moved = 0.0;
        sn_tri_mesh_free(&r->m);
        r->m = before;
        sn_tri_mesh_init(&before);
        st = check_now(r);
    }
    sn_tri_mesh_free(&before);
    return st;
}

/* An open bowl: a wrap goes in and leaves a thin shell. With all its holes filled it is a body. */
static sn_status close_bowl(repair *r)
{
    r->may_fill_all = false;
    r->opt.fill_holes = 2.0 * r->diagonal;
    sn_status st = orient_and_fill(r);
    return st ? st : sort_components(r, r->opt.largest);
}

static sn_status wrap(repair *r)
{
    sn_repair_step *s = add_step(r, "wrap");
    sn_wrap_result w;
    sn_tri_mesh made;
    sn_tri_mesh_init(&made);
    int32_t n_before = r->m.n_face;
    sn_status st = sn_repair_wrap(&r->m, &r->opt, r->run, &made, &w, r->err);
    add_count(s, "faces_before", n_before);
    add_count(s, "faces_after", made.n_face);
    add_count(s, "tries", w.tries);
    add_count(s, "laid_back_vertices", w.laid_back);
    s->moved = w.moved;
    r->report->alpha = w.alpha;
    r->report->offset = w.offset;
    if (st && w.is_shell && r->may_fill_all) {
        sn_tri_mesh_free(&made);
        s->moved = 0.0;
        st = close_bowl(r);
        bool is_done = is_usable(&r->check) && r->opt.wrap != SN_WRAP_ALWAYS;
        return st || is_done ? st : wrap(r);
    }
    if (st) return st;
    r->report->wrapped = true;
    sn_tri_mesh_free(&r->m);
    r->m = made;
    st = check_now(r);
    return !st && r->opt.largest ? sort_components(r, true) : st;
}

/* ---- the end ---- */

static sn_status tell_what_remains(const repair *r)
{
    const sn_mesh_check *c = &r->check;
    const struct {
        const char *what;
        int64_t n;
    } fault[] = {{"boundary edges", c->boundary_edges},
                 {"non-manifold edges", c->nonmanifold_edges},
                 {"non-manifold vertices", c->nonmanifold_vertices},
                 {"degenerate faces", c->degenerate_faces},
                 {"self-intersections", c->self_intersections}};
    char list[200] = "";
    size_t n = 0;
    for (size_t i = 0; i < sizeof fault / sizeof *fault; i++)
        if (fault[i].n > 0)
            n += (size_t)snprintf(list + n, sizeof list - n, "%s%lld %s", n > 0 ? ", " : "",
                                  (long long)fault[i].n, fault[i].what);
    if (n == 0) (void)snprintf(list, sizeof list, "faces wound against their neighbours");
    const char *help = r->report->wrapped      ? "a larger offset may help"
                       : c->boundary_edges > 0 ? "fill_holes closes larger holes, wrap = \"auto\" wraps it"
                       : c->self_intersections > 0 && !r->opt.untangle
                           ? "self_intersections = true resolves them, wrap = \"auto\" wraps it"
                           : "wrap = \"auto\" wraps it";
    return sn_fail(r->err, SN_EMESH, "repair: what remains: %s; %s", list, help);
}

static sn_status all_steps(repair *r)
{
    sn_status st = copy_input(r);
    if (!st) st = weld(r);
    if (!st) st = clean(r);
    if (!st) st = check_now(r);
    if (!st) st = orient_and_fill(r);
    bool always = r->opt.wrap == SN_WRAP_ALWAYS, tangled = r->check.self_intersections > 0;
    if (!st && !always) st = sort_components(r, r->opt.largest && !tangled);
    if (!st && !always) st = untangle(r);
    if (!st && r->opt.wrap != SN_WRAP_NEVER && (always || !is_usable(&r->check))) st = wrap(r);
    if (!st && !is_usable(&r->check)) st = tell_what_remains(r);
    if (!st) st = sn_repair_moved(&r->m, r->in, r->run, &r->report->moved, r->err);
    if (!st) st = sn_repair_missed(&r->m, r->in, r->run, &r->report->missed, r->err);
    r->report->check = r->check;
    return st;
}

sn_status sn_repair_run(const sn_tri_mesh *in, const sn_repair *opt, const sn_run *run, sn_tri_mesh *out,
                        sn_repair_report *report, sn_error *err)
{
    repair r = {.in = in, .opt = *opt, .run = run, .report = report, .err = err};
    sn_tri_mesh_free(out);
    *report = (sn_repair_report){0};
    sn_status st = check_options(opt, err);
    if (!st) st = set_lengths(&r);
    if (!st) st = all_steps(&r);
    if (!st) {
        *out = r.m;
        return SN_OK;
    }
    sn_tri_mesh_free(&r.m);
    return st;
}
