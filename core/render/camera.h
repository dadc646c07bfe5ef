/* camera.h - where a picture is taken from. Right-handed; the up axis is the scene's (y or z).
 *
 * front looks along -z in a y-up scene (the eye is at +z), along +y in a z-up one (the eye is at -y). */
#ifndef SN_RENDER_CAMERA_H
#define SN_RENDER_CAMERA_H

#include "base/status.h"
#include "base/vec3.h"

#include <stdbool.h>

typedef struct sn_camera {
    sn_vec3 eye, target, up; /* up: not parallel to target - eye          */
    double fov_deg;          /* vertical, 1..170                          */
    double znear, zfar;      /* > 0, from the box to be seen              */
} sn_camera;

typedef enum sn_up { SN_UP_Y, SN_UP_Z } sn_up;

/* A name: front back left right top bottom iso. left and right are the subject's own: left looks from +x. top
 * and bottom keep the front at the lower edge and at the upper edge. iso is azimuth 45, elevation 35.26. The
 * whole box fits into a picture with aspect = width / height, with a border of about 4 %. Errors: SN_EINVAL:
 * an unknown name (lists the known), an empty or infinite box, aspect not in 0.001..1000. */
SN_MUST_USE sn_status sn_camera_preset(sn_camera *out, const char *name, sn_box3 box, sn_up up, double aspect,
                                       sn_error *err);
/* azimuth 0 = front, turning to the subject's left (+90: the eye is at +x); elevation -90..90 above the
 * horizon; zoom 1 fits the box as sn_camera_preset does, 2 is twice as large (a narrower fov from the same
 * eye), 0.05..20. SN_EINVAL. */
SN_MUST_USE sn_status sn_camera_orbit(sn_camera *out, double azimuth_deg, double elevation_deg, double zoom,
                                      sn_box3 box, sn_up up, double aspect, sn_error *err);
/* Sets znear, zfar from the box. SN_EINVAL: eye = target, up parallel, fov out of range, not finite, an empty
 * box. */
SN_MUST_USE sn_status sn_camera_look(sn_camera *out, sn_vec3 eye, sn_vec3 target, sn_vec3 up, double fov_deg,
                                     sn_box3 box, sn_error *err);
/* The invariants above, for a camera filled by hand. The message names the first breach. SN_EINVAL. */
SN_MUST_USE sn_status sn_camera_check(const sn_camera *c, sn_error *err);
/* Unit vectors to the right, up and back (from target to eye) of the picture. */
void sn_camera_frame(const sn_camera *c, sn_vec3 *right, sn_vec3 *up, sn_vec3 *back);
/* Column-major 4x4, OpenGL clip space. aspect = width / height. */
void sn_camera_matrices(const sn_camera *c, double aspect, float view[16], float proj[16]);
/* Pixel coordinates run right and down; whole numbers are the centres of pixels, (0, 0) that of the top left
 * one. dir has length 1. */
void sn_camera_ray(const sn_camera *c, double x, double y, int width, int height, sn_vec3 *origin,
                   sn_vec3 *dir);
/* Pixel coordinates of a point (the inverse of sn_camera_ray); false behind the eye, x and y are then
 * untouched. */
bool sn_camera_project(const sn_camera *c, sn_vec3 p, int width, int height, double *x, double *y);

#endif
