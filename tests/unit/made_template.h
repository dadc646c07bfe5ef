/* made_template.h - a lumpy head with a bone inside, cut and caged as a template for fitting. */
#ifndef SN_TESTS_MADE_TEMPLATE_H
#define SN_TESTS_MADE_TEMPLATE_H

#include "asserts.h"
#include "skeleton/fit.h"

#include "made_mesh.h"

/* Radius of the head in a direction: a nose, two brows, an ear, a chin. Around 1. */
static inline double head_radius(sn_vec3 d)
{
    static const double lump[][5] = {/* direction, height, width */
                                     {0.0, -0.1, 1.0, 0.25, 0.20},   {0.45, 0.5, 0.75, 0.12, 0.25},
                                     {-0.45, 0.5, 0.75, 0.12, 0.25}, {0.95, 0.0, -0.1, 0.2, 0.2},
                                     {-0.95, 0.05, 0.0, 0.15, 0.25}, {0.1, -0.9, 0.5, 0.15, 0.3},
                                     {0.2, 0.9, -0.4, 0.1, 0.4}};
    double r = 0.9;
    for (size_t i = 0; i < sizeof lump / sizeof *lump; i++) {
        sn_vec3 c = sn_v3_unit(sn_v3(lump[i][0], lump[i][1], lump[i][2]));
        r += lump[i][3] * exp(-0.5 * sn_v3_len2(sn_v3_sub(d, c)) / (lump[i][4] * lump[i][4]));
    }
    return r;
}

static inline sn_tri_mesh made_head(double cell)
{
    sn_tri_mesh m = made_sphere(sn_v3(0, 0, 0), 1.0, cell);
    for (int32_t i = 0; i < m.n_vert; i++) {
        sn_vec3 d = sn_v3_unit(sn_tri_mesh_point(&m, i));
        double r = head_radius(d);
        sn_v3_store(m.pos + 3 * i, sn_v3(0.9 * r * d.x, 1.15 * r * d.y, r * d.z));
    }
    return m;
}

/* The faces with a corner above z = low, with just the vertices that they use. */
static inline sn_tri_mesh cut_above(const sn_tri_mesh *m, double low)
{
    sn_tri_mesh out;
    int32_t n_face = 0, n_vert = 0, *to = malloc((size_t)m->n_vert * sizeof *to);
    sn_tri_mesh_init(&out);
    assert_int_equal(sn_tri_mesh_reserve(&out, m->n_vert, m->n_face, NULL), SN_OK);
    for (int32_t i = 0; i < m->n_vert; i++) to[i] = -1;
    for (int32_t f = 0; f < m->n_face; f++) {
        const int32_t *v = m->face + 3 * (size_t)f;
        if (!(fmax(m->pos[3 * v[0] + 2], fmax(m->pos[3 * v[1] + 2], m->pos[3 * v[2] + 2])) > low)) continue;
        for (int k = 0; k < 3; k++) {
            if (to[v[k]] < 0) {
                memcpy(out.pos + 3 * n_vert, m->pos + 3 * v[k], 3 * sizeof *out.pos);
                to[v[k]] = n_vert++;
            }
            out.face[3 * n_face + k] = to[v[k]];
        }
        n_face++;
    }
    free(to);
    out.n_face = n_face;
    out.n_vert = n_vert;
    return out;
}

typedef struct made_template {
    sn_tri_mesh head, bone, cage, skin;
    sn_fit_template t;
} made_template;

static const double head_landmarks[] = {0.0, 0.0, 0.7, 0.3, -0.4, 0.2};

/* t->t points into *t. The bone is an inner head, shorter and deeper set. */
static inline void made_template_init(made_template *t, double cell)
{
    t->head = made_head(cell);
    t->skin = cut_above(&t->head, -0.3);
    t->bone = made_head(1.7 * cell);
    for (int32_t i = 0; i < t->bone.n_vert; i++) {
        double *p = t->bone.pos + 3 * i;
        p[0] *= 0.6, p[1] = 0.65 * p[1] + 0.05, p[2] = 0.55 * p[2] + 0.15;
    }
    t->cage = made_sphere(sn_v3(0, 0, 0), 1.75, 1.0);
    t->t = (sn_fit_template){&t->bone, &t->cage, &t->skin, head_landmarks, 2};
}

static inline void made_template_free(made_template *t)
{
    sn_tri_mesh_free(&t->head);
    sn_tri_mesh_free(&t->bone);
    sn_tri_mesh_free(&t->cage);
    sn_tri_mesh_free(&t->skin);
}

#endif
