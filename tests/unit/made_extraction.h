/* made_extraction.h - extractions that tests make, with the soundness check that each must pass. */
#ifndef SN_TESTS_MADE_EXTRACTION_H
#define SN_TESTS_MADE_EXTRACTION_H

#include "extract/extraction.h"

#include "made_mesh.h"

#include <stdio.h>

#define MAX_NAMES 64

static uint64_t seed = 88172645463325252u;

static inline double rnd(void)
{
    return made_random(&seed);
}

static inline int below(int n)
{
    return (int)(rnd() * n);
}

static inline const char *const *names(void)
{
    static char text[MAX_NAMES][16];
    static const char *name[MAX_NAMES];
    for (int i = 0; i < MAX_NAMES; i++) {
        (void)snprintf(text[i], sizeof text[i], "t%d", i);
        name[i] = text[i];
    }
    name[0] = "fat";
    return name;
}

static inline double *new_values(const sn_tet_mesh *m, int n_tissue)
{
    double *value = SN_NEW(double, (size_t)n_tissue *(size_t)m->n_vert);
    assert_non_null(value);
    return value;
}

/* ---- what every extraction must be ---- */

static inline void assert_sound(const sn_extraction *x, const sn_tet_mesh *m, int n_tissue)
{
    sn_extraction_check c;
    sn_error err = {0};
    if (sn_extraction_check_run(&c, x, m, NULL, &err)) fail_msg("%s", err.msg);
    if (!c.conforming || !c.manifold || !c.positive || !(c.volume_error < 1e-9))
        fail_msg("bad faces %lld, edges %lld, vertices %lld, inverted %d, volume %g, seed now %llu",
                 (long long)c.bad_faces, (long long)c.nonmanifold_edges, (long long)c.nonmanifold_vertices,
                 c.inverted, c.volume_error, (unsigned long long)seed);
    assert_int_equal(c.bad_faces + c.nonmanifold_edges + c.nonmanifold_vertices + c.inverted, 0);
    assert_true(0.0 < c.min_volume && c.min_volume <= c.max_volume);
    assert_int_equal(x->n_tissue, n_tissue);
    assert_true(x->mesh.n_tet >= m->n_tet && x->mesh.n_vert >= m->n_vert);
    assert_memory_equal(x->mesh.pos, m->pos, 3 * (size_t)m->n_vert * sizeof *m->pos);
    assert_true(x->input_volume == sn_tet_mesh_volume(m));
    double sum = 0.0;
    int32_t n_tet = 0;
    for (int i = 0; i < n_tissue; i++) {
        assert_string_equal(x->name[i], names()[i]);
        sum += sn_extraction_part_volume(x, i);
        n_tet += sn_extraction_part_tets(x, i);
    }
    assert_int_equal(n_tet, x->mesh.n_tet);
    assert_true(fabs(sum - x->input_volume) < 1e-9 * x->input_volume);
    for (int32_t t = 1; t < x->mesh.n_tet; t++) assert_true(x->source[t - 1] <= x->source[t]);
    assert_int_equal(x->source[x->mesh.n_tet - 1], m->n_tet - 1);
}

static const sn_run one_thread = {.n_threads = 1}; /* starting threads takes longer than a small case */

static inline sn_extraction extract(const sn_tet_mesh *m, const double *value, int n_tissue)
{
    sn_extraction x;
    sn_error err = {0};
    sn_extraction_init(&x);
    if (sn_extract(m, value, names(), n_tissue, NULL, &one_thread, &x, &err))
        fail_msg("%s, seed now %llu", err.msg, (unsigned long long)seed);
    assert_sound(&x, m, n_tissue);
    return x;
}

#endif
