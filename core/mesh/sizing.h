/* sizing.h - how long edges should be from place to place: a lattice over a box that is fine at given sites
 * and grows evenly with the distance from them.
 *
 * Build: create, add the sites, spread. Lengths are kept in single precision and places rounded to cells, so
 * that the last bits of what it is made from decide nothing. */
#ifndef SN_MESH_SIZING_H
#define SN_MESH_SIZING_H

#include "base/status.h"
#include "base/vec3.h"

#include <stdint.h>

SN_BEGIN_DECLS

typedef struct sn_sizing { /* open */
    sn_vec3 origin;        /* the lattice's corner                                       */
    double cell;           /* edge of a cell                                             */
    int32_t n[3];          /* cells along x, y, z                                        */
    float *length;         /* n[0] * n[1] * n[2], x fastest: of each cell; owned         */
    double unit;           /* what the lengths are in: 1, or another unit after a change */
} sn_sizing;

#define SN_SIZING_MAX_CELLS ((size_t)1 << 23)

/* All cells get `longest`. cell: made longer where the box would have more than SN_SIZING_MAX_CELLS. s:
 * zero-initialised; zero again on error. Errors: SN_EINVAL (box, cell or longest not finite or not > 0),
 * SN_ENOMEM. */
SN_MUST_USE sn_status sn_sizing_create(sn_sizing *s, sn_box3 box, double cell, double longest, sn_error *err);
void sn_sizing_free(sn_sizing *s);

/* The cell at p (the nearest one, for p outside) gets at most that length. */
void sn_sizing_add(sn_sizing *s, sn_vec3 p, double length);
/* The cells of places every half cell on the triangle, or on the piece from a to b: at most `length`, or,
 * with `of`, `length` times what that sizing has there. */
void sn_sizing_add_triangle(sn_sizing *s, sn_vec3 a, sn_vec3 b, sn_vec3 c, const sn_sizing *of,
                            double length);
void sn_sizing_add_piece(sn_sizing *s, sn_vec3 a, sn_vec3 b, const sn_sizing *of, double length);

/* Lengths stay what they are for `band` cells around each site and grow from there by `growth` for each unit
 * of distance (up to 8 % more by the way that distances are summed). */
void sn_sizing_spread(sn_sizing *s, int band, double growth);

double sn_sizing_at(const sn_sizing *s, sn_vec3 p);
/* The same sizing where places p are written (p - origin) / size, and lengths over size. Borrows. */
sn_sizing sn_sizing_moved(const sn_sizing *s, sn_vec3 origin, double size);

SN_END_DECLS

#endif
