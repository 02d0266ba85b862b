/* SPDX-License-Identifier: MIT
 *
 * One stage of finite volumes with fifth-order weighted reconstruction (stencil/weno.h) on all axes at once:
 *
 *     f_face = c_face v,   v from the side the flow comes from,   c = u dt/h
 *     to = share old + (1 - share) (from - sum over the axes of f_+ - f_-)
 *
 * Three stages with share 0, 3/4, 1/3 are one step of the strong-stability-preserving Runge-Kutta scheme of
 * third order (Shu, Osher 1988). The sum is kept to round-off, and so are constants where u is free of
 * divergence. Along an axis the error is of fifth order; the flux of a face is u times a face mean of phi, so
 * that where u varies along the face the whole is of second order, with a small constant. New extrema of some
 * per cent occur at jumps: for bounds take parabolas (stencil/ppm.h).
 *
 * Volumes, staggered ones, ghosts and `mass` are as in stencil/ppm.h.
 */
#ifndef CF_STENCIL_WENO5_H
#define CF_STENCIL_WENO5_H

#include <stdbool.h>

#include "grid/field.h"
#include "grid/grid.h"
#include "stencil/ghost.h"

typedef struct cf_weno5_stage {
  const cf_grid *grid;
  int component; /* CF_CENTRES, or the axis on whose faces the field lies */
  int count[3];  /* volumes an axis */
  bool mass;     /* flux form; otherwise u.grad: from (c_+ - c_-) is added back */
  cf_real half;  /* dt/(2h) */
  cf_face u;     /* velocity with one layer of ghosts */
  cf_ghost ghost[3][2];
  const double *inflow[3][2]; /* CF_GHOST_INFLOW: a value for each volume at the wall, the lower of the other
                                 axes fastest */
  cf_real share;
  const cf_real *old, *from;
  cf_real *to;   /* may be `old`, not `from` */
  cf_real *rows; /* scratch: cf_weno5_rows(grid) elements for each thread */
  double *lines; /* scratch: cf_weno5_lines(grid) elements; NULL: nobody asks what passed through the walls */
} cf_weno5_stage;

ptrdiff_t cf_weno5_rows(const cf_grid *g);
ptrdiff_t cf_weno5_lines(const cf_grid *g);

/* If `lines` is given, adds to through[0] the sum of f over the faces of walls (other than wrapping ones) where
 * the flow enters, and to through[1] that where it leaves, times `weight`. */
void cf_weno5_stage_run(const cf_weno5_stage *s, double weight, double through[2]);

#endif
