#include "field/segmentation.h"

void sn_tissue_values(const sn_tet_mesh *m, const double *field, int32_t n_tissue, int32_t i_tet,
                      const double bary[4], double *out)
{
    const int32_t *t = m->tet + 4 * (size_t)i_tet;
    for (int32_t i = 0; i < n_tissue; i++) {
        const double *f = field + (size_t)i * (size_t)m->n_vert;
        out[i] = bary[0] * f[t[0]] + bary[1] * f[t[1]] + bary[2] * f[t[2]] + bary[3] * f[t[3]];
    }
}

int32_t sn_tissue_winner(const double *value, int32_t n)
{
    int32_t best = 0;
    for (int32_t i = 1; i < n; i++)
        if (value[i] > value[best]) best = i;
    return best;
}
