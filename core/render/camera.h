/* camera.h - where a picture is taken from. Right-handed; the up axis is the scene's (y or z).
 *
 * front looks along -z in a y-up scene (the eye is at +z), along +y in a z-up one (the eye is at -y). */
#ifndef SN_RENDER_CAMERA_H
#define SN_RENDER_CAMERA_H

#include "base/status.h"
#include "base/vec3.h"

#include <stdbool.h>

typedef struct sn_camera {
    sn_vec3 eye, target, up;   /* up: not parallel to target - eye          */
    double fov_deg;            /* vertical, 1..170                          */
    double znear, zfar;        /* > 0, from the box to be seen              */
} sn_camera;

typedef enum sn_up { SN_UP_Y, SN_UP_Z } sn_up;

/* A name: front back left right top bottom iso. The whole box fits into width x height. SN_EINVAL for an unknown name
 * (lists the known). */
SN_MUST_USE sn_status sn_camera_preset(sn_camera *out, const char *name, sn_box3 box, sn_up up, double aspect, sn_error *err);
/* azimuth 0 = front, turning to the subject's left (+90: the eye is at +x); elevation -90..90 above the horizon; zoom 1 fits the box, 2 is twice as large. */
SN_MUST_USE sn_status sn_camera_orbit(sn_camera *out, double azimuth_deg, double elevation_deg, double zoom, sn_box3 box,
                                      sn_up up, double aspect, sn_error *err);
/* Sets znear, zfar from the box. SN_EINVAL: eye = target, up parallel, fov out of range, not finite. */
SN_MUST_USE sn_status sn_camera_look(sn_camera *out, sn_vec3 eye, sn_vec3 target, sn_vec3 up, double fov_deg, sn_box3 box,
                                     sn_error *err);
/* Column-major 4x4, OpenGL clip space. */
void sn_camera_matrices(const sn_camera *c, double aspect, float view[16], float proj[16]);
/* The ray through the centre of pixel (x, y), x right and y down from the top left corner, of a width x height picture. */
void sn_camera_ray(const sn_camera *c, double x, double y, int width, int height, sn_vec3 *origin, sn_vec3 *dir);
/* Pixel coordinates of a point; false behind the eye. */
bool sn_camera_project(const sn_camera *c, sn_vec3 p, int width, int height, double *x, double *y);

#endif
