/* Lines along the fibers of a part. */
#include "extract/part_fibers.h"

#include "base/alloc.h"
#include "extract/extraction_mirror.h"
#include "tetra/locate.h"

enum { steps_per_curve = 128, max_steps = 4096, bisections = 12 };
#define KINK_COS 0.3 /* a line ends where neighbouring steps turn more than this: it has no way to go on */

typedef struct tracer {
    const sn_part_fibers *part;
    sn_tet_mesh mesh; /* of the part alone, in the order of part->tet */
    sn_locator *locator;
    double step;
    int32_t room; /* of the line: sn_fibers_room */
} tracer;

/* The direction at p, towards the insertion for sign 1; false outside of the belly, and beyond a sheet. */
static bool direction_at(const tracer *t, sn_vec3 p, double sign, sn_vec3 *d, double *u)
{
    int32_t i = sn_locator_find(t->locator, p, NULL);
    const sn_part_fibers *f = t->part;
    if (i < 0 || (f->has_tendon && sn_tendons_at(&f->tendons, &f->fibers.paths, p) > 0.0)) return false;
    if (sn_fibers_room(&f->fibers, p) != t->room) return false;
    *d = sn_v3_scale(sign, sn_fibers_at(&f->fibers, f->source[i], p, u));
    return true;
}

/* The last point of the belly on the way from p, which is in it, along d. */
static sn_vec3 way_out(const tracer *t, sn_vec3 p, sn_vec3 d, double length)
{
    double lo = 0.0, hi = length, u;
    for (int i = 0; i < bisections; i++) {
        double mid = 0.5 * (lo + hi);
        sn_vec3 unused;
        if (direction_at(t, sn_v3_mad(p, mid, d), 1.0, &unused, &u))
            lo = mid;
        else
            hi = mid;
    }
    return sn_v3_mad(p, lo, d);
}

/* From p on, by the midpoint rule, to the border of the belly; p itself is not added. */
static sn_status follow(const tracer *t, sn_vec3 p, double sign, sn_polylines *out, sn_error *err)
{
    double u = 0.0;
    sn_vec3 d, mid, next, last;
    if (!direction_at(t, p, sign, &d, &u)) return SN_OK;
    last = d;
    for (int i = 0; i < max_steps; i++) {
        bool is_in = direction_at(t, sn_v3_mad(p, 0.5 * t->step, d), sign, &mid, &u);
        if (is_in && sn_v3_dot(mid, last) < KINK_COS) return SN_OK;
        if (!is_in) mid = d;
        next = sn_v3_mad(p, t->step, mid);
        if (!is_in || !direction_at(t, next, sign, &d, &u)) {
            next = way_out(t, p, mid, t->step);
            return sn_v3_dist(next, p) > 1e-3 * t->step ? sn_polylines_add(out, next, u, err) : SN_OK;
        }
        if (sn_v3_dot(d, mid) < KINK_COS) return SN_OK;
        sn_status st = sn_polylines_add(out, next, u, err);
        if (st) return st;
        p = next;
        last = mid;
    }
    return SN_OK;
}

static sn_status trace_line(tracer *t, sn_vec3 seed, sn_polylines *out, sn_error *err)
{
    t->room = sn_fibers_room(&t->part->fibers, seed);
    double u = 0.0;
    sn_vec3 unused;
    if (!direction_at(t, seed, 1.0, &unused, &u)) return SN_OK;
    sn_status st = sn_polylines_begin(out, t->part->tissue, err);
    if (!st) st = follow(t, seed, -1.0, out, err);
    if (!st) sn_polylines_reverse_last(out);
    if (!st) st = sn_polylines_add(out, seed, u, err);
    if (!st) st = follow(t, seed, 1.0, out, err);
    if (!st && out->first[out->n_line] - out->first[out->n_line - 1] < 2) sn_polylines_drop_last(out);
    return st;
}

/* Seeds: the tets in their order, which goes through space, cut into n runs of equal volume of belly; the
 * middle of each. */
static sn_status trace_all(tracer *t, int32_t n, const sn_run *run, sn_polylines *out, sn_error *err)
{
    const sn_part_fibers *f = t->part;
    double total = 0.0, done = 0.0, *volume = SN_NEW(double, t->mesh.n_tet);
    if (!volume) return sn_fail(err, SN_ENOMEM, "fibers: no memory");
    for (int32_t i = 0; i < t->mesh.n_tet; i++) {
        bool is_tendon = f->has_tendon &&
                         sn_tendons_at(&f->tendons, &f->fibers.paths, sn_tet_mesh_centre(&t->mesh, i)) > 0.0;
        volume[i] = is_tendon ? 0.0 : sn_tet_mesh_tet_volume(&t->mesh, i);
        total += volume[i];
    }
    sn_status st = SN_OK;
    int32_t k = 0;
    for (int32_t i = 0; i < t->mesh.n_tet && k < n && !st; i++) {
        done += volume[i];
        while (!st && k < n && volume[i] > 0.0 && done >= total * (k + 0.5) / n) {
            if (k % 64 == 0) st = sn_run_step(run, "tracing fibers", (double)k / n, err);
            if (!st) st = trace_line(t, sn_tet_mesh_centre(&t->mesh, i), out, err);
            k++;
        }
    }
    sn_release(volume);
    return st;
}

/* x: not mirrored. */
static sn_status trace_part(const sn_part_fibers *p, const sn_extraction *x, int32_t n, const sn_run *run,
                            sn_polylines *out, sn_error *err)
{
    tracer t = {.part = p, .step = INFINITY};
    sn_tet_mesh_init(&t.mesh);
    for (int32_t h = 0; h < p->fibers.paths.n_head; h++)
        t.step = fmin(t.step, p->fibers.paths.head[h].length / steps_per_curve);
    sn_status st = sn_extraction_part(x, p->tissue, &t.mesh, err);
    if (!st) st = sn_locator_create(&t.locator, &t.mesh, err);
    if (!st) st = trace_all(&t, n, run, out, err);
    sn_locator_destroy(t.locator);
    sn_tet_mesh_free(&t.mesh);
    return st;
}

/* ---- mirrored extractions ---- */

/* The lines of the half from `first` on become those of the part, reflected for the image. */
static void show_lines(sn_polylines *lines, size_t first, int32_t tissue, const sn_plane *mirror)
{
    for (size_t i = first; i < lines->n_line; i++) lines->part[i] = tissue;
    for (size_t k = lines->first ? (size_t)lines->first[first] : 0; mirror && k < lines->n_point; k++)
        sn_v3_store(lines->pos + 3 * k, sn_plane_reflect(mirror, sn_polylines_point(lines, k)));
}

sn_status sn_part_fibers_lines(const sn_part_fibers *p, const sn_extraction *x, int32_t n, const sn_run *run,
                               sn_polylines *out, sn_error *err)
{
    if (x->half.n_tet == 0) return trace_part(p, x, n, run, out, err);
    sn_extraction half = sn_extraction_half_view(x);
    sn_part_fibers side[2] = {sn_part_fibers_side(p, x, false), sn_part_fibers_side(p, x, true)};
    double volume[2] = {0.0, 0.0};
    for (int i = 0; i < 2; i++)
        if (side[i].n_tet > 0) volume[i] = sn_extraction_part_volume(&half, side[i].tissue);
    int32_t n_own = (int32_t)floor(n * volume[0] / (volume[0] + volume[1]) + 0.5);
    sn_status st = SN_OK;
    for (int i = 0; i < 2 && !st; i++) {
        size_t first = out->n_line;
        if (side[i].n_tet == 0) continue;
        st = trace_part(&side[i], &half, i == 0 ? n_own : n - n_own, run, out, err);
        if (!st) show_lines(out, first, p->tissue, i == 0 ? NULL : &x->half.plane);
    }
    return st;
}
