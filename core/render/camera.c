#include "render/camera.h"

#include <stdio.h>
#include <string.h>

#define PI 3.14159265358979323846
static const double preset_fov_deg = 25.0; /* a long lens: little distortion, still some depth */
static const double fit_border = 1.04;

typedef struct preset {
    const char *name;
    double azimuth_deg, elevation_deg;
} preset;
static const preset presets[] = {{"front", 0.0, 0.0},
                                 {"back", 180.0, 0.0},
                                 {"left", 90.0, 0.0},
                                 {"right", -90.0, 0.0},
                                 {"top", 0.0, 90.0},
                                 {"bottom", 0.0, -90.0},
                                 {"iso", 45.0, 35.264389682754654}};
enum { n_presets = (int)(sizeof presets / sizeof presets[0]) };

static double rad(double deg)
{
    return deg * (PI / 180.0);
}

/* cos and sin, exact at multiples of 90 degrees so that preset views are square to the axes. */
static void cos_sin(double deg, double *c, double *s)
{
    double turn = deg / 90.0, whole = round(turn);
    if (turn == whole) {
        static const double quarter[4] = {1.0, 0.0, -1.0, 0.0};
        int k = (int)(whole - 4.0 * floor(whole / 4.0));
        *c = quarter[k & 3];
        *s = quarter[(k + 3) & 3];
    } else {
        *c = cos(rad(deg));
        *s = sin(rad(deg));
    }
}

static sn_status check_box(sn_box3 box, sn_error *err)
{
    if (sn_box3_is_empty(box) || !sn_v3_is_finite(box.min) || !sn_v3_is_finite(box.max))
        return sn_fail(err, SN_EINVAL, "camera: the box to be seen is empty or not finite");
    return SN_OK;
}

/* The depths of the box's bounding ball, kept in front of the eye. */
static void set_depths(sn_camera *c, sn_box3 box)
{
    sn_vec3 right, up, back, mid = sn_v3_lerp(box.min, box.max, 0.5);
    sn_camera_frame(c, &right, &up, &back);
    double r = 0.525 * sn_box3_diagonal(box), d = sn_v3_dot(sn_v3_sub(c->eye, mid), back);
    double scale = fmax(r, sn_v3_dist(c->eye, c->target));
    c->znear = fmax(d - r, 1e-3 * scale);
    c->zfar = fmax(d + r, 2.0 * c->znear);
}

sn_status sn_camera_check(const sn_camera *c, sn_error *err)
{
    sn_vec3 d = sn_v3_sub(c->target, c->eye);
    if (!sn_v3_is_finite(c->eye) || !sn_v3_is_finite(c->target) || !sn_v3_is_finite(c->up))
        return sn_fail(err, SN_EINVAL, "camera: eye, target or up is not finite");
    if (!(sn_v3_len(d) > 0.0))
        return sn_fail(err, SN_EINVAL, "camera: eye and target are the same point (%g, %g, %g)", c->eye.x,
                       c->eye.y, c->eye.z);
    if (!(sn_v3_len(sn_v3_cross(sn_v3_unit(d), sn_v3_unit(c->up))) > 1e-9))
        return sn_fail(err, SN_EINVAL, "camera: up (%g, %g, %g) is parallel to the view or zero", c->up.x,
                       c->up.y, c->up.z);
    if (!(c->fov_deg >= 1.0 && c->fov_deg <= 170.0))
        return sn_fail(err, SN_EINVAL, "camera: field of view is %g degrees, need 1..170", c->fov_deg);
    if (!(c->znear > 0.0 && c->zfar > c->znear && isfinite(c->zfar)))
        return sn_fail(err, SN_EINVAL, "camera: depths %g..%g, need 0 < near < far", c->znear, c->zfar);
    return SN_OK;
}

sn_status sn_camera_look(sn_camera *out, sn_vec3 eye, sn_vec3 target, sn_vec3 up, double fov_deg, sn_box3 box,
                         sn_error *err)
{
    sn_camera c = {.eye = eye, .target = target, .up = up, .fov_deg = fov_deg, .znear = 1.0, .zfar = 2.0};
    sn_status st = sn_camera_check(&c, err);
    if (!st) st = check_box(box, err);
    if (st) return st;
    set_depths(&c, box);
    *out = c;
    return SN_OK;
}

/* The least distance from which all corners are inside the picture's pyramid of half slopes (tx, ty). */
static double fit_distance(const sn_camera *c, sn_box3 box, double tx, double ty)
{
    sn_vec3 right, up, back;
    sn_camera_frame(c, &right, &up, &back);
    double dist = 0.0;
    for (int k = 0; k < 8; k++) {
        sn_vec3 p = sn_v3(k & 1 ? box.max.x : box.min.x, k & 2 ? box.max.y : box.min.y,
                          k & 4 ? box.max.z : box.min.z);
        sn_vec3 q = sn_v3_sub(p, c->target);
        double z = sn_v3_dot(q, back);
        dist = fmax(dist, z + fabs(sn_v3_dot(q, right)) / tx);
        dist = fmax(dist, z + fabs(sn_v3_dot(q, up)) / ty);
    }
    return dist;
}

static sn_status check_orbit(double azimuth_deg, double elevation_deg, double zoom, double aspect,
                             sn_error *err)
{
    if (!isfinite(azimuth_deg)) return sn_fail(err, SN_EINVAL, "camera: azimuth is %g degrees", azimuth_deg);
    if (!(elevation_deg >= -90.0 && elevation_deg <= 90.0))
        return sn_fail(err, SN_EINVAL, "camera: elevation is %g degrees, need -90..90", elevation_deg);
    if (!(zoom >= 0.05 && zoom <= 20.0))
        return sn_fail(err, SN_EINVAL, "camera: zoom is %g, need 0.05..20", zoom);
    if (!(aspect >= 1e-3 && aspect <= 1e3))
        return sn_fail(err, SN_EINVAL, "camera: aspect (width / height) is %g, need 0.001..1000", aspect);
    return SN_OK;
}

sn_status sn_camera_orbit(sn_camera *out, double azimuth_deg, double elevation_deg, double zoom, sn_box3 box,
                          sn_up up, double aspect, sn_error *err)
{
    sn_status st = check_orbit(azimuth_deg, elevation_deg, zoom, aspect, err);
    if (!st) st = check_box(box, err);
    if (st) return st;
    double ca, sa, ce, se;
    cos_sin(azimuth_deg, &ca, &sa);
    cos_sin(elevation_deg, &ce, &se);
    sn_vec3 front = up == SN_UP_Y ? sn_v3(0, 0, 1) : sn_v3(0, -1, 0);
    sn_vec3 above = up == SN_UP_Y ? sn_v3(0, 1, 0) : sn_v3(0, 0, 1);
    sn_vec3 level = sn_v3_add(sn_v3_scale(ca, front), sn_v3(sa, 0, 0));
    sn_vec3 toward = sn_v3_mad(sn_v3_scale(ce, level), se, above);
    /* The derivative of `toward` by the elevation: square to it everywhere, also straight above and below. */
    sn_camera c = {.target = sn_v3_lerp(box.min, box.max, 0.5), .fov_deg = preset_fov_deg};
    c.up = sn_v3_mad(sn_v3_scale(ce, above), -se, level);
    c.eye = sn_v3_add(c.target, toward);
    double ty = tan(rad(0.5 * preset_fov_deg)) / fit_border;
    double dist = fit_distance(&c, box, ty * aspect, ty);
    if (!(dist > 0.0)) dist = 1.0; /* the box is one point */
    c.eye = sn_v3_mad(c.target, dist, toward);
    c.fov_deg = 2.0 * atan(ty * fit_border / zoom) * (180.0 / PI);
    set_depths(&c, box);
    *out = c;
    return SN_OK;
}

sn_status sn_camera_preset(sn_camera *out, const char *name, sn_box3 box, sn_up up, double aspect,
                           sn_error *err)
{
    char known[96] = "";
    for (int i = 0; i < n_presets; i++) {
        if (strcmp(name, presets[i].name) == 0)
            return sn_camera_orbit(out, presets[i].azimuth_deg, presets[i].elevation_deg, 1.0, box, up,
                                   aspect, err);
        size_t n = strlen(known);
        (void)snprintf(known + n, sizeof known - n, "%s%s", n ? ", " : "", presets[i].name);
    }
    return sn_fail(err, SN_EINVAL, "camera: unknown view '%.60s' (known: %s)", name, known);
}

void sn_camera_frame(const sn_camera *c, sn_vec3 *right, sn_vec3 *up, sn_vec3 *back)
{
    *back = sn_v3_unit(sn_v3_sub(c->eye, c->target));
    *right = sn_v3_unit(sn_v3_cross(sn_v3_unit(c->up), *back));
    *up = sn_v3_cross(*back, *right);
}

void sn_camera_matrices(const sn_camera *c, double aspect, float view[16], float proj[16])
{
    sn_vec3 axis[3];
    sn_camera_frame(c, &axis[0], &axis[1], &axis[2]);
    for (int i = 0; i < 3; i++) {
        view[i] = (float)axis[i].x;
        view[4 + i] = (float)axis[i].y;
        view[8 + i] = (float)axis[i].z;
        view[12 + i] = (float)-sn_v3_dot(axis[i], c->eye);
        view[4 * i + 3] = 0.0f;
    }
    view[15] = 1.0f;
    double f = 1.0 / tan(rad(0.5 * c->fov_deg)), n = c->znear, z = c->zfar;
    memset(proj, 0, 16 * sizeof *proj);
    proj[0] = (float)(f / aspect);
    proj[5] = (float)f;
    proj[10] = (float)((z + n) / (n - z));
    proj[11] = -1.0f;
    proj[14] = (float)(2.0 * z * n / (n - z));
}

void sn_camera_ray(const sn_camera *c, double x, double y, int width, int height, sn_vec3 *origin,
                   sn_vec3 *dir)
{
    sn_vec3 right, up, back;
    sn_camera_frame(c, &right, &up, &back);
    double slope = 2.0 * tan(rad(0.5 * c->fov_deg)) / height; /* per pixel */
    sn_vec3 d = sn_v3_scale(-1.0, back);
    d = sn_v3_mad(d, slope * (x + 0.5 - 0.5 * width), right);
    d = sn_v3_mad(d, slope * (0.5 * height - y - 0.5), up);
    *origin = c->eye;
    *dir = sn_v3_unit(d);
}

bool sn_camera_project(const sn_camera *c, sn_vec3 p, int width, int height, double *x, double *y)
{
    sn_vec3 right, up, back, q = sn_v3_sub(p, c->eye);
    sn_camera_frame(c, &right, &up, &back);
    double depth = -sn_v3_dot(q, back);
    if (!(depth > 0.0)) return false;
    double slope = 2.0 * tan(rad(0.5 * c->fov_deg)) / height;
    *x = sn_v3_dot(q, right) / (depth * slope) + 0.5 * width - 0.5;
    *y = 0.5 * height - 0.5 - sn_v3_dot(q, up) / (depth * slope);
    return true;
}
