#include "mesh/sizing.h"

#include "base/alloc.h"

#include <math.h>
#include <string.h>

void sn_sizing_free(sn_sizing *s)
{
    sn_release(s->length);
    memset(s, 0, sizeof *s);
}

static size_t count_cells(const sn_sizing *s)
{
    return (size_t)s->n[0] * (size_t)s->n[1] * (size_t)s->n[2];
}

/* false: too many. */
static bool set_counts(sn_sizing *s, sn_vec3 extent)
{
    const double size[3] = {extent.x, extent.y, extent.z};
    double all = 1.0;
    for (int k = 0; k < 3; k++) all *= floor(size[k] / s->cell) + 2.0;
    if (all > (double)SN_SIZING_MAX_CELLS) return false;
    for (int k = 0; k < 3; k++) s->n[k] = (int32_t)(size[k] / s->cell) + 2;
    return true;
}

sn_status sn_sizing_create(sn_sizing *s, sn_box3 box, double cell, double longest, sn_error *err)
{
    sn_vec3 extent = sn_v3_sub(box.max, box.min);
    bool is_box = !sn_box3_is_empty(box) && sn_v3_is_finite(extent);
    if (!is_box || !(cell > 0.0 && isfinite(cell)) || !(longest > 0.0 && isfinite(longest)))
        return sn_fail(err, SN_EINVAL, "sizing: needs a box, a cell > 0 (is %g) and a length > 0 (is %g)",
                       cell, longest);
    *s = (sn_sizing){.cell = cell, .unit = 1.0};
    while (!set_counts(s, extent)) s->cell *= 1.25;
    /* Off the box's corner: places on its faces or on a raster of whole cells then lie inside cells. */
    s->origin = sn_v3_sub(box.min, sn_v3(0.37 * s->cell, 0.41 * s->cell, 0.43 * s->cell));
    size_t n = count_cells(s);
    s->length = SN_NEW(float, n);
    if (!s->length) {
        sn_sizing_free(s);
        return sn_fail(err, SN_ENOMEM, "sizing: no memory for %zu cells", n);
    }
    for (size_t i = 0; i < n; i++) s->length[i] = (float)longest;
    return SN_OK;
}

static size_t cell_at(const sn_sizing *s, sn_vec3 p)
{
    const double at[3] = {(p.x - s->origin.x) / s->cell, (p.y - s->origin.y) / s->cell,
                          (p.z - s->origin.z) / s->cell};
    size_t c[3];
    for (int k = 0; k < 3; k++) c[k] = (size_t)fmin(fmax(at[k], 0.0), (double)(s->n[k] - 1));
    return c[0] + (size_t)s->n[0] * (c[1] + (size_t)s->n[1] * c[2]);
}

double sn_sizing_at(const sn_sizing *s, sn_vec3 p)
{
    return s->unit * (double)s->length[cell_at(s, p)];
}

sn_sizing sn_sizing_moved(const sn_sizing *s, sn_vec3 origin, double size)
{
    sn_sizing out = *s;
    out.origin = sn_v3_scale(1.0 / size, sn_v3_sub(s->origin, origin));
    out.cell /= size;
    out.unit /= size;
    return out;
}

/* ---- sites ---- */

void sn_sizing_add(sn_sizing *s, sn_vec3 p, double length)
{
    float *at = &s->length[cell_at(s, p)];
    if ((float)length < *at) *at = (float)length;
}

static void add_sample(sn_sizing *s, sn_vec3 p, const sn_sizing *of, double length)
{
    sn_sizing_add(s, p, of ? length * sn_sizing_at(of, p) : length);
}

/* Steps of half a cell or less. */
static int count_steps(const sn_sizing *s, double length)
{
    return (int)fmin(ceil(2.0 * length / s->cell), 4096.0) + 1;
}

void sn_sizing_add_piece(sn_sizing *s, sn_vec3 a, sn_vec3 b, const sn_sizing *of, double length)
{
    int n = count_steps(s, sn_v3_dist(a, b));
    for (int i = 0; i <= n; i++) add_sample(s, sn_v3_lerp(a, b, (double)i / n), of, length);
}

void sn_sizing_add_triangle(sn_sizing *s, sn_vec3 a, sn_vec3 b, sn_vec3 c, const sn_sizing *of, double length)
{
    int n = count_steps(s, fmax(sn_v3_dist(a, b), fmax(sn_v3_dist(b, c), sn_v3_dist(c, a))));
    sn_vec3 u = sn_v3_sub(b, a), v = sn_v3_sub(c, a);
    for (int i = 0; i <= n; i++)
        for (int j = 0; i + j <= n; j++)
            add_sample(s, sn_v3_mad(sn_v3_mad(a, (double)i / n, u), (double)j / n, v), of, length);
}

/* ---- spreading ---- */

typedef struct neighbour { /* of the 13 that come before a cell */
    int d[3];
    double distance; /* in cells */
} neighbour;

static int list_neighbours(neighbour out[13])
{
    int n = 0;
    for (int z = -1; z <= 0; z++)
        for (int y = -1; y <= 1; y++)
            for (int x = -1; x <= 1; x++)
                if (z < 0 || y < 0 || (y == 0 && x < 0))
                    out[n++] = (neighbour){{x, y, z}, sqrt((double)(x * x + y * y + z * z))};
    return n;
}

/* Lowers a cell to what its neighbours on one side (sign 1: those before it) and `growth` between them and it
 * allow. */
static void lower_cell(sn_sizing *s, const neighbour *near, int32_t x, int32_t y, int32_t z, int sign,
                       double growth)
{
    int64_t at[3] = {x, y, z}, row = s->n[0], slice = row * s->n[1], here = x + row * y + slice * z;
    float least = s->length[here];
    for (int k = 0; k < 13; k++) {
        const int *d = near[k].d;
        bool is_in = true;
        for (int c = 0; c < 3; c++)
            is_in = is_in && at[c] + sign * d[c] >= 0 && at[c] + sign * d[c] < s->n[c];
        if (!is_in) continue;
        float reach = s->length[here + sign * (d[0] + row * d[1] + slice * d[2])] +
                      (float)(growth * s->cell * near[k].distance);
        if (reach < least) least = reach;
    }
    s->length[here] = least;
}

/* Two sweeps of a chamfer distance transform (G. Borgefors, Distance transformations in arbitrary dimensions,
 * 1984). */
static void sweep(sn_sizing *s, double growth)
{
    neighbour near[13];
    (void)list_neighbours(near);
    for (int32_t z = 0; z < s->n[2]; z++)
        for (int32_t y = 0; y < s->n[1]; y++)
            for (int32_t x = 0; x < s->n[0]; x++) lower_cell(s, near, x, y, z, 1, growth);
    for (int32_t z = s->n[2] - 1; z >= 0; z--)
        for (int32_t y = s->n[1] - 1; y >= 0; y--)
            for (int32_t x = s->n[0] - 1; x >= 0; x--) lower_cell(s, near, x, y, z, -1, growth);
}

/* Each cell gets the least length of itself and its two neighbours along one axis. */
static void widen_along(sn_sizing *s, int axis)
{
    size_t step = axis == 0 ? 1 : axis == 1 ? (size_t)s->n[0] : (size_t)s->n[0] * (size_t)s->n[1];
    size_t n = (size_t)s->n[axis], all = count_cells(s);
    for (size_t first = 0; first < all; first++) {
        if (first / step % n != 0) continue; /* the starts of the rows */
        float before = s->length[first];
        for (size_t i = 0; i < n; i++) {
            float *at = &s->length[first + i * step], here = *at, after = i + 1 < n ? at[step] : here;
            *at = fminf(here, fminf(before, after));
            before = here;
        }
    }
}

void sn_sizing_spread(sn_sizing *s, int band, double growth)
{
    for (int i = 0; i < band; i++)
        for (int axis = 0; axis < 3; axis++) widen_along(s, axis);
    sweep(s, growth);
}
