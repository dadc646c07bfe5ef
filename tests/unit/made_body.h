/* made_body.h - bodies for tests of pictures: a cube of tets with fields given as functions, a box for a
 * bone; drawing them and asking the picture what it shows. Brings cmocka and its headers. */
#ifndef SN_TESTS_MADE_BODY_H
#define SN_TESTS_MADE_BODY_H

#include "base/alloc.h"
#include "render/draw.h"
#include "render/muscle_tets.h"
#include "render/painter.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

/* Mesa keeps a few bytes per context and fontconfig two patterns until the process ends; not ours to free. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
    return "leak:libOSMesa\nleak:libfontconfig\n";
}

static inline void ok(sn_status st, const sn_error *err)
{
    if (st) fail_msg("%s", err->msg);
}

static inline void expect(sn_status st, sn_status want, const sn_error *err, const char *text)
{
    assert_int_equal(st, want);
    if (!strstr(err->msg, text)) fail_msg("'%s' does not say '%s'", err->msg, text);
}

static inline void assert_near(double a, double b, double tol)
{
    if (!(fabs(a - b) <= tol)) fail_msg("%.17g is not %.17g within %g", a, b, tol);
}

/* ---- a cube [-1, 1]^3 of n^3 boxes, six tets each (Kuhn), with fields given as functions ---- */

typedef struct body {
    sn_tet_mesh mesh;
    double *field;
    int32_t n_tissue;
    sn_picture_scene scene;
} body;
typedef double (*field_fn)(int32_t i_tissue, sn_vec3 p);

static inline void fill_cube(sn_tet_mesh *m, int n)
{
    static const int order[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
    int step[3] = {1, n + 1, (n + 1) * (n + 1)}, v = 0, t = 0;
    for (int z = 0; z <= n; z++)
        for (int y = 0; y <= n; y++)
            for (int x = 0; x <= n; x++, v++)
                sn_v3_store(m->pos + 3 * v, sn_v3(2.0 * x / n - 1.0, 2.0 * y / n - 1.0, 2.0 * z / n - 1.0));
    for (int b = 0; b < n * n * n; b++)
        for (int q = 0; q < 6; q++, t++) {
            int32_t *c = m->tet + 4 * t;
            c[0] = b % n + b / n % n * step[1] + b / (n * n) * step[2];
            for (int k = 0; k < 3; k++) c[k + 1] = c[k] + step[order[q][k]];
            if (q >= 3) { /* an odd path: turn it round */
                int32_t swap = c[1];
                c[1] = c[2];
                c[2] = swap;
            }
        }
}

static inline void body_make(body *b, int n, int32_t n_tissue, field_fn f)
{
    sn_error err;
    memset(b, 0, sizeof *b);
    ok(sn_tet_mesh_reserve(&b->mesh, (n + 1) * (n + 1) * (n + 1), 6 * n * n * n, false, &err), &err);
    fill_cube(&b->mesh, n);
    ok(sn_tet_mesh_validate(&b->mesh, &err), &err);
    b->field = malloc(sizeof(double) * (size_t)n_tissue * (size_t)b->mesh.n_vert);
    for (int32_t i = 0; i < n_tissue; i++)
        for (int32_t v = 0; v < b->mesh.n_vert; v++)
            b->field[(size_t)i * (size_t)b->mesh.n_vert + (size_t)v] = f(i, sn_tet_mesh_point(&b->mesh, v));
    b->n_tissue = n_tissue;
    b->scene = (sn_picture_scene){.tets = &b->mesh, .field = b->field, .n_tissue = n_tissue, .unit = 3.5};
}

static inline void body_free(body *b)
{
    sn_tet_mesh_free(&b->mesh);
    free(b->field);
}

/* From the front, all shown, on nothing. */
static inline sn_picture_options front(int w, int h)
{
    sn_picture_options o = {
        .width = w, .height = h, .samples = 1, .skin_opacity = 0.5, .renderer = SN_RENDERER_OSMESA};
    sn_error err;
    o.show_muscles = o.show_bones = o.show_skin = o.show_curves = o.show_points = o.show_fibers =
        o.show_frames = true;
    ok(sn_camera_preset(&o.camera, "front", (sn_box3){{-1, -1, -1}, {1, 1, 1}}, SN_UP_Y, (double)w / h, &err),
       &err);
    return o;
}

static inline sn_picture_stats draw(const sn_picture_scene *s, const sn_picture_options *o, sn_image *m)
{
    sn_picture_stats stats;
    sn_error err;
    sn_image_init(m);
    ok(sn_picture_draw(s, o, NULL, m, &stats, &err), &err);
    return stats;
}

static inline sn_status find_tets(sn_muscle_tets *m, const sn_picture_scene *s, const sn_run *run,
                                  sn_error *err)
{
    sn_tet_fans fans = {0};
    ok(sn_tet_fans_find(&fans, s->tets, err), err);
    sn_status st = sn_muscle_tets_find(m, s, &fans, run, err);
    sn_tet_fans_free(&fans);
    return st;
}

static inline sn_status draw_tiled(const sn_picture_scene *s, const sn_picture_options *o, int tile_side,
                                   const sn_run *run, sn_image *m, sn_picture_stats *stats, sn_error *err)
{
    sn_painter *p;
    ok(sn_painter_create(&p, err), err);
    sn_status st = sn_painter_draw_tiled(p, s, o, tile_side, run, m, stats, err);
    sn_painter_destroy(p);
    return st;
}

static inline double covered(const sn_image *m) /* pixels */
{
    double sum = 0.0;
    for (size_t i = 0; i < (size_t)m->width * (size_t)m->height; i++) sum += m->rgba[4 * i + 3] / 255.0;
    return sum;
}

static inline const uint8_t *at(const sn_image *m, int x, int y)
{
    return m->rgba + 4 * ((size_t)y * (size_t)m->width + (size_t)x);
}

static inline const uint8_t *at_point(const sn_image *m, const sn_camera *c, sn_vec3 p)
{
    double x, y;
    assert_true(sn_camera_project(c, p, m->width, m->height, &x, &y));
    return at(m, (int)lround(x), (int)lround(y));
}

/* Which of the two muscle colours a lit pixel comes from: by the ratios of its linear channels. */
static inline double hue_distance(const uint8_t *p, int32_t i_muscle)
{
    sn_rgb c = sn_muscle_color(i_muscle);
    double a[3] = {pow(p[0] / 255.0, 2.2), pow(p[1] / 255.0, 2.2), pow(p[2] / 255.0, 2.2)};
    double b[3] = {pow(c.r, 2.2), pow(c.g, 2.2), pow(c.b, 2.2)}, na = 0, nb = 0, d = 0;
    for (int k = 0; k < 3; k++) {
        na += a[k];
        nb += b[k];
    }
    for (int k = 0; k < 3; k++) d += fabs(a[k] / na - b[k] / nb);
    return d;
}

static inline double color_gap(const uint8_t *p, sn_rgb c)
{
    return fmax(fabs(p[0] - 255.0 * (double)c.r),
                fmax(fabs(p[1] - 255.0 * (double)c.g), fabs(p[2] - 255.0 * (double)c.b)));
}

static inline void make_box(sn_tri_mesh *m, sn_vec3 lo, sn_vec3 hi)
{
    static const int32_t face[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                     2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    sn_error err;
    sn_tri_mesh_init(m);
    ok(sn_tri_mesh_reserve(m, 8, 12, &err), &err);
    for (int k = 0; k < 8; k++)
        sn_v3_store(m->pos + 3 * k, sn_v3(k & 1 ? hi.x : lo.x, k & 2 ? hi.y : lo.y, k & 4 ? hi.z : lo.z));
    memcpy(m->face, face, sizeof face);
    assert_true(sn_tri_mesh_volume(m) > 0.0);
}

/* Fails the 1st, 2nd, ... allocation: a clean error each time, until the picture comes out. */
typedef struct counter {
    long left;
} counter;
static inline void *count_realloc(void *user, void *p, size_t bytes)
{
    counter *c = user;
    if (bytes == 0) {
        free(p);
        return NULL;
    }
    return c->left-- == 0 ? NULL : realloc(p, bytes);
}

#endif
