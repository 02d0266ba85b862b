/* SPDX-License-Identifier: MIT
 *
 * One sweep of mass-weighted parabolas along one axis: what the flow carries through the faces of that axis.
 *
 * With c the Courant number on faces, p the mean values of a row of volumes and rho their pseudo-density:
 *
 *   d_i     = MC(p_i - p_{i-1}, p_{i+1} - p_i)                        limited slope
 *   e_i     = (p_{i-1} + p_i)/2 - (d_i - d_{i-1})/6                   value on the low face of volume i
 *   f       = c [R - a/2 (D - (1 - 2a/3) S)],  a = |c|/rho            flux out of the donor of a face, where
 * R is the parabola's value on that face, L on the far one (both limited), D = R - L, S = 6 (p - (L+R)/2) m_i
 * = rho_i p_i - (f_{i+1} - f_i),  rho'_i = rho_i - (c_{i+1} - c_i),  p'_i = m_i/rho'_i
 *
 * (Colella and Woodward 1984 for the parabola.) rho starts each substep at 1 and is never stored: it is
 * 1 - sum of c_+ - c_- over the axes already swept. In the last sweep of a substep p' = m where the sum of
 * phi is what counts, or m/rho' again for the advective form u.grad phi.
 *
 * Volumes are cells, or the staggered volumes around the faces of one axis s. The Courant number on the low
 * d-face of volume p is (u_d[p] + u_d[p - stride_s]) dt/(2h) for both, with stride 0 for cells.
 *
 * Ghost values are made row by row, from a rule for each side, so fields need no ghosts in memory (u does
 * need its first layer). The kernels know nothing of axes: a row of neighbours along x is the same row
 * shifted by one, along y and z another row.
 */
#ifndef CF_STENCIL_PPM_H
#define CF_STENCIL_PPM_H

#include <stdbool.h>

#include "grid/field.h"
#include "grid/grid.h"
#include "grid/sweep.h"
#include "stencil/ghost.h"
#include "stencil/limit.h"

/* d[i] from a volume and its two neighbours. */
CF_KERNEL void cf_ppm_slope_row(const int n, const cf_real *low, const cf_real *p, const cf_real *high,
                                cf_real *d) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) d[i] = cf_limit_mc(p[i] - low[i], high[i] - p[i]);
}

/* e[i] between volumes `low` and `p` with their slopes. */
CF_KERNEL void cf_ppm_edge_row(const int n, const cf_real *low, const cf_real *p, const cf_real *d_low,
                               const cf_real *d, cf_real *e) {
  const cf_real sixth = (cf_real)(1.0 / 6.0);
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) e[i] = (low[i] + p[i]) / 2 - (d[i] - d_low[i]) * sixth;
}

/* Everything around a row of faces: the volumes below [0] and above [1] it, and the edges one face further
 * down, on it, and one further up. */
typedef struct cf_ppm_face {
  const cf_real *c, *p[2], *rho[2], *e[3];
} cf_ppm_face;

/* f[i] out of whichever volume the flow comes from. With x = R - p and y = p - L, limiting cuts both to the
 * same sign and to at most twice the other. */
CF_KERNEL void cf_ppm_flux_row(const int n, const cf_ppm_face *at, cf_real *f) {
  const cf_real *c_row = at->c, *p_low = at->p[0], *p_high = at->p[1], *rho_low = at->rho[0],
                *rho_high = at->rho[1], *e_low = at->e[0], *e_mid = at->e[1], *e_high = at->e[2];
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    /* Everything is loaded before anything is chosen: a chosen load is a branch. */
    const cf_real c = c_row[i], p0 = p_low[i], p1 = p_high[i], r0 = rho_low[i], r1 = rho_high[i];
    const cf_real e0 = e_low[i], e1 = e_mid[i], e2 = e_high[i];
    const cf_real p = c > 0 ? p0 : p1, rho = c > 0 ? r0 : r1, far = c > 0 ? e0 : e2;
    const cf_real a = (c > 0 ? c : -c) / rho;
    const cf_real x0 = e1 - p, y0 = p - far;
    const cf_real x = cf_limit_between(x0, 2 * y0), y = cf_limit_between(y0, 2 * x0);
    f[i] = c * (p + (x - a / 2 * ((x + y) - (3 - 2 * a) * (y - x))));
  }
}

/* A row of volumes with the flux and Courant number on its low [0] and high [1] faces. */
typedef struct cf_ppm_volume {
  const cf_real *p, *rho, *f[2], *c[2];
  bool mass; /* p' = m, not m/rho' */
} cf_ppm_volume;

CF_KERNEL void cf_ppm_update_row(const int n, const cf_ppm_volume *v, cf_real *p) {
  if (v->mass) {
    CF_ROW_LOOP
    for (int i = 0; i < n; ++i) p[i] = v->rho[i] * v->p[i] - (v->f[1][i] - v->f[0][i]);
    return;
  }
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const cf_real m = v->rho[i] * v->p[i] - (v->f[1][i] - v->f[0][i]);
    p[i] = m / (v->rho[i] - (v->c[1][i] - v->c[0][i]));
  }
}

/* c[i] = (u[i] + u[i - shift]) w. */
CF_KERNEL void cf_ppm_courant_row(const int n, const cf_real *u, const ptrdiff_t shift, const cf_real w,
                                  cf_real *c) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) c[i] = (u[i] + u[i - shift]) * w;
}

/* rho[i] -= c_+ - c_- along the axis of `u`, whose high faces are `next` elements further. */
CF_KERNEL void cf_ppm_thin_row(const int n, const cf_real *u, const ptrdiff_t next, const ptrdiff_t shift,
                               const cf_real w, cf_real *rho) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) rho[i] -= (u[i + next] + u[i + next - shift]) * w - (u[i] + u[i - shift]) * w;
}

/* Fields of a sweep at most: Courant numbers and densities are worked out once for all of them. */
#define CF_PPM_FIELDS 2

/* One field that is swept. */
typedef struct cf_ppm_field {
  cf_ghost ghost[2];       /* on the low and high side of the axis */
  const double *inflow[2]; /* CF_GHOST_INFLOW: a value for each volume at the wall, the lower of the other
                               axes fastest, `count` of it a line */
  const cf_real *from;
  cf_real *to;   /* another field; may be `from` itself for axis 0 */
  double *lines; /* scratch: cf_ppm_lines(grid) elements; NULL: nobody asks what passed through the walls */
  double entered,
      left; /* with `lines`: sums of f over the faces of walls through which the flow enters, and of
                            those through which it leaves, both counted positive for positive p, in units of p
                            times a cell; added to by every sweep */
} cf_ppm_field;

typedef struct cf_ppm_sweep {
  const cf_grid *grid;
  int axis;      /* swept along this axis */
  int component; /* CF_CENTRES, or the axis on whose faces the field lies */
  int count[3];  /* volumes an axis: those of the box, and one more on the component's axis unless it wraps */
  int swept;     /* how many axes this substep has swept already, */
  int before[2]; /* and which, in their order */
  bool mass;     /* the last sweep of the flux form */
  cf_real half;  /* dt/(2h) */
  cf_face u;     /* velocity with one layer of ghosts */
  cf_real *rows; /* scratch: cf_ppm_rows(grid) elements for each thread */
  int fields;    /* 1 <= fields <= CF_PPM_FIELDS; on volumes of the same kind, wrapped on the same sides */
  cf_ppm_field field[CF_PPM_FIELDS];
} cf_ppm_sweep;

ptrdiff_t cf_ppm_rows(const cf_grid *g);
ptrdiff_t cf_ppm_lines(const cf_grid *g);

/* Carries `from` of every field along the axis into `to`. */
void cf_ppm_sweep_run(cf_ppm_sweep *s);

#endif
