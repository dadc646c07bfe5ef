#include "scene/scene_stroke.h"

#include "base/alloc.h"
#include "mesh/spline_fit.h"
#include "scene/scene_private.h"

#define TELL 0.01 /* share of a curve in bone or outside of the skin that is worth a note */

/* The lines of sight of sn_camera_ray, written linearly in x and y. */
static sn_stroke_view view_of(const sn_camera *c, int width, int height)
{
    static const double pi = 3.14159265358979323846;
    sn_vec3 right, up, back;
    sn_camera_frame(c, &right, &up, &back);
    double per_pixel = 2.0 * tan(0.5 * c->fov_deg * pi / 180.0) / height;
    sn_vec3 corner = sn_v3_scale(-1.0, back);
    corner = sn_v3_mad(corner, per_pixel * (0.5 - 0.5 * width), right);
    corner = sn_v3_mad(corner, per_pixel * (0.5 * height - 0.5), up);
    return (sn_stroke_view){.eye = c->eye,
                            .corner = corner,
                            .per_x = sn_v3_scale(per_pixel, right),
                            .per_y = sn_v3_scale(-per_pixel, up)};
}

static void tell(sn_scene *s, const char *name, sn_stroke_depth depth, const sn_stroke_report *r)
{
    const char *advice =
        depth == SN_DEPTH_LINEAR
            ? "depth = \"clear\" keeps out of it"
            : "give it more points or another margin, draw it from another side, or move its points";
    if (r->inside_bone > TELL)
        sn_notes_add(&s->notes, "muscle '%s': %.0f %% of the drawn curve is inside bone: %s", name,
                     100.0 * r->inside_bone, advice);
    if (r->outside_skin > TELL)
        sn_notes_add(&s->notes, "muscle '%s': %.0f %% of the drawn curve is outside of the skin: %s", name,
                     100.0 * r->outside_skin,
                     depth == SN_DEPTH_LINEAR ? "depth = \"clear\" stays inside" : advice);
}

static sn_status curve_of(const sn_scene *s, const sn_scene_stroke *stroke, const sn_stroke_options *opt,
                          const sn_run *run, double *point, sn_stroke_report *report, sn_error *err)
{
    const char **name = SN_NEW(const char *, s->n_bone);
    const sn_tri_mesh **mesh = SN_NEW(const sn_tri_mesh *, s->n_bone);
    sn_status st = name && mesh ? SN_OK : sn_fail(err, SN_ENOMEM, "scene: no memory");
    int32_t n = 0;
    for (int32_t i = 0; !st && i < s->n_bone; i++) {
        if (sn_scene_bone_mesh(s, i)->n_face == 0) continue; /* cut off */
        name[n] = s->bone[i].name;
        mesh[n++] = sn_scene_bone_mesh(s, i);
    }
    if (!st) {
        const sn_stroke_body body = {.bone_name = name, .bone = mesh, .n_bone = n, .skin = sn_scene_skin(s)};
        const sn_stroke drawn = {.view = view_of(stroke->camera, stroke->width, stroke->height),
                                 .pixel = stroke->pixel,
                                 .n_pixel = stroke->n_pixel};
        st = sn_stroke_curve(&drawn, &body, opt, run, point, report, err);
    }
    sn_release(name);
    sn_release(mesh);
    return st;
}

sn_status sn_scene_draw_muscle(sn_scene *s, const sn_scene_stroke *stroke, const sn_stroke_options *opt,
                               const sn_run *run, sn_stroke_report *report, sn_error *err)
{
    sn_stroke_report own = {0};
    double point[3 * SN_SPLINE_FIT_MAX_POINTS];
    if (stroke->width < 1 || stroke->height < 1)
        return sn_fail(err, SN_EINVAL, "the picture is %d x %d pixels, need 1 or more", stroke->width,
                       stroke->height);
    sn_status st = sn_camera_check(stroke->camera, err);
    if (!st) st = curve_of(s, stroke, opt, run, point, &own, err);
    if (st) return sn_fail_prefix(err, st, "muscle '%.64s': ", stroke->name);
    st = sn_scene_add_muscle(s, stroke->name, point, stroke->tissue, sn_stroke_point_count(opt), err);
    if (st) return st;
    tell(s, stroke->name, opt->depth, &own);
    if (report) *report = own;
    return SN_OK;
}
