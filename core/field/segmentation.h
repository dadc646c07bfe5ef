/* segmentation.h - which tissue is where: the largest of the tissue functions [A 3.5]. */
#ifndef SN_FIELD_SEGMENTATION_H
#define SN_FIELD_SEGMENTATION_H

#include "tetra/locate.h"

/* The values of all tissues at barycentric coordinates of a tet. field: n_tissue x n_vert; out: n_tissue. */
void sn_tissue_values(const sn_tet_mesh *m, const double *field, int32_t n_tissue, int32_t i_tet,
                      const double bary[4], double *out);
/* Index of the largest value; ties go to the lower index. n >= 1. */
int32_t sn_tissue_winner(const double *value, int32_t n);

#endif
