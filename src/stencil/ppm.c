/* SPDX-License-Identifier: MIT
 *
 * Lines of a sweep. Along x a line is one row: its values go into a buffer with room for ghosts, and the
 * kernels run over it shifted by one. Along y and z a line is a block of x that walks up the axis; slopes,
 * edges, fluxes and densities of the last few rows are kept in rings, so each is worked out once.
 * Where a line is cut into pieces for the threads changes no bit: a piece starts from the values, not from
 * its neighbour's results.
 */
#include "stencil/ppm.h"

#include <omp.h>

/* Elements of a block in x: a dozen rows of it stay in the first-level cache. */
#define BLOCK ((int)(2048 / sizeof(cf_real)))
#define PIECE 32 /* rows of a piece of a line, at least */
#define ROWS  16 /* row buffers of a thread */

CF_CLONES static void slope_row(const int n, const cf_real *low, const cf_real *p, const cf_real *high,
                                cf_real *d) {
  cf_ppm_slope_row(n, low, p, high, d);
}
CF_CLONES static void edge_row(const int n, const cf_real *low, const cf_real *p, const cf_real *d_low,
                               const cf_real *d, cf_real *e) {
  cf_ppm_edge_row(n, low, p, d_low, d, e);
}
CF_CLONES static void flux_row(const int n, const cf_ppm_face *at, cf_real *f) { cf_ppm_flux_row(n, at, f); }
CF_CLONES static void update_row(const int n, const cf_ppm_volume *v, cf_real *p) {
  cf_ppm_update_row(n, v, p);
}
CF_CLONES static void courant_row(const int n, const cf_real *u, const ptrdiff_t shift, const cf_real w,
                                  cf_real *c) {
  cf_ppm_courant_row(n, u, shift, w, c);
}
CF_CLONES static void thin_row(const int n, const cf_real *u, const ptrdiff_t next, const ptrdiff_t shift,
                               const cf_real w, cf_real *rho) {
  cf_ppm_thin_row(n, u, next, shift, w, rho);
}

/* --- scratch ------------------------------------------------------------------------------------------ */

/* Elements of a row buffer: a row with ghosts on both sides; not a multiple of a page. */
static ptrdiff_t pitch_of(const cf_grid *g) {
  const ptrdiff_t pitch = (g->box.n[0] + 1 + 4 * CF_LANES - 1) / CF_LANES * CF_LANES;
  return pitch * (ptrdiff_t)sizeof(cf_real) % 4096 == 0 ? pitch + CF_LANES : pitch;
}

static int blocks_of(const int n) { return (n + BLOCK - 1) / BLOCK; }

ptrdiff_t cf_ppm_rows(const cf_grid *g) { return ROWS * pitch_of(g); }

ptrdiff_t cf_ppm_lines(const cf_grid *g) {
  const ptrdiff_t blocks = blocks_of(g->box.n[0] + 1), ny = g->box.n[1] + 1, nz = g->box.n[2] + 1;
  return 4 * CF_MAX(ny * nz, blocks * CF_MAX(ny, nz));
}

/* Lines of a sweep: rows along x; along y and z, blocks of x times the other axis. */
static ptrdiff_t lines_of(const cf_ppm_sweep *s) {
  if (s->axis == 0) return (ptrdiff_t)s->count[1] * s->count[2];
  return (ptrdiff_t)blocks_of(s->count[0]) * s->count[s->axis == 1 ? 2 : 1];
}

/* --- beyond the walls --------------------------------------------------------------------------------- */

/* The volume whose density the one beyond a wall has, or -1: its density is 1. */
static int dense_as(const cf_ghost rule, const int g, const int count) {
  return rule == CF_GHOST_WRAP || rule == CF_GHOST_ODD ? cf_ghost_image(rule, g, count) : -1;
}

/* Adds what passed through wall faces with flux f and Courant number c to entered and left. `inward` is 1
 * on the low wall and -1 on the high one. */
static void add_through(const int n, const cf_real *c, const cf_real *f, const cf_real inward,
                        double *entered, double *left) {
  double in = 0, out = 0;
  for (int i = 0; i < n; ++i) {
    const double passed = (double)(inward * f[i]);
    if (inward * c[i] > 0)
      in += passed;
    else
      out -= passed;
  }
  *entered = in;
  *left = out;
}

/* --- along x ------------------------------------------------------------------------------------------ */

/* Density of the row's volumes before this sweep. */
static void density_row(const cf_ppm_sweep *s, const int n, const ptrdiff_t p, cf_real *rho) {
  const cf_box *b = &s->grid->box;
  const ptrdiff_t shift = s->component < 0 ? 0 : b->stride[s->component];
  for (int i = 0; i < n; ++i) rho[i] = 1;
  for (int e = 0; e < s->swept; ++e) {
    const int axis = s->before[e];
    thin_row(n, s->u.at[axis] + p, b->stride[axis], shift, s->half, rho);
  }
}

static void fill_ends(const cf_ppm_sweep *s, const ptrdiff_t line, const cf_real *c, cf_real *p,
                      cf_real *rho) {
  const int n = s->count[0];
  for (int side = 0; side < 2; ++side) {
    const cf_ghost rule = s->ghost[side];
    const bool enters = rule == CF_GHOST_INFLOW && (side == 0 ? c[0] > 0 : c[n] < 0);
    for (int g = 0; g < 3; ++g) {
      const int to = side == 0 ? -1 - g : n + g;
      const cf_real image = p[cf_ghost_image(rule, to, n)];
      p[to] = enters ? (cf_real)s->inflow[side][line] : rule == CF_GHOST_ODD ? -image : image;
    }
    const int to = side == 0 ? -1 : n, as = dense_as(rule, to, n);
    rho[to] = as < 0 ? 1 : rho[as];
  }
}

static void sweep_row(const cf_ppm_sweep *s, const ptrdiff_t line, cf_real *rows) {
  const cf_box *b = &s->grid->box;
  const ptrdiff_t at = cf_box_at(b, 0, (int)(line % s->count[1]), (int)(line / s->count[1]));
  const ptrdiff_t pitch = pitch_of(s->grid), shift = s->component < 0 ? 0 : b->stride[s->component];
  const int n = s->count[0];
  cf_real *p = rows + CF_LANES, *d = p + pitch, *e = d + pitch, *rho = e + pitch, *c = rho + pitch,
          *f = c + pitch;
  for (int i = 0; i < n; ++i) p[i] = s->from[at + i];
  courant_row(n + 1, s->u.at[0] + at, shift, s->half, c);
  density_row(s, n, at, rho);
  fill_ends(s, line, c, p, rho);
  slope_row(n + 4, p - 3, p - 2, p - 1, d - 2);
  edge_row(n + 3, p - 2, p - 1, d - 2, d - 1, e - 1);
  const cf_ppm_face face = {c, {p - 1, p}, {rho - 1, rho}, {e - 1, e, e + 1}};
  flux_row(n + 1, &face, f);
  const cf_ppm_volume volume = {p, rho, {f, f + 1}, {c, c + 1}, s->mass};
  update_row(n, &volume, s->to + at);
  if (s->lines == NULL) return;
  const ptrdiff_t lines = lines_of(s);
  add_through(1, c, f, 1, s->lines + line, s->lines + 2 * lines + line);
  add_through(1, c + n, f + n, -1, s->lines + lines + line, s->lines + 3 * lines + line);
}

/* --- along y and z ------------------------------------------------------------------------------------ */

/* A line that walks up the axis, and its rings; row j of a ring of m is ring[j mod m]. */
typedef struct walk {
  const cf_ppm_sweep *s;
  ptrdiff_t at, stride,
      shift;      /* volume 0 of the line; to the next volume; to the component's lower neighbour */
  int n, count;   /* elements of a row; volumes along the line */
  ptrdiff_t wall; /* of the line's first element in the wall's layer of values */
  cf_real *ghost[4], *e[4], *d[2], *rho[2], *c[2], *f[2];
} walk;

static cf_real *ring(cf_real *const *rows, const int m, const int j) { return rows[(j + m * 4) % m]; }

/* The values of volume row j, -3 <= j < count + 3. */
static const cf_real *values(const walk *w, const int j) {
  const cf_ppm_sweep *s = w->s;
  if (j >= 0 && j < w->count) return s->from + w->at + j * w->stride;
  const int side = j < 0 ? 0 : 1;
  const cf_ghost rule = s->ghost[side];
  const cf_real *image = s->from + w->at + cf_ghost_image(rule, j, w->count) * w->stride;
  if (rule != CF_GHOST_ODD && rule != CF_GHOST_INFLOW) return image;
  cf_real *ghost = ring(w->ghost, 4, j);
  if (rule == CF_GHOST_ODD) {
    for (int i = 0; i < w->n; ++i) ghost[i] = -image[i];
    return ghost;
  }
  const cf_real *u = s->u.at[s->axis] + w->at + (side == 0 ? 0 : w->count) * w->stride;
  const double *inflow = s->inflow[side] + w->wall;
  const cf_real inward = side == 0 ? 1 : -1;
  for (int i = 0; i < w->n; ++i) ghost[i] = inward * u[i] > 0 ? (cf_real)inflow[i] : image[i];
  return ghost;
}

static void make_slope(walk *w, const int j) {
  slope_row(w->n, values(w, j - 1), values(w, j), values(w, j + 1), ring(w->d, 2, j));
}

static void make_edge(walk *w, const int j) {
  edge_row(w->n, values(w, j - 1), values(w, j), ring(w->d, 2, j - 1), ring(w->d, 2, j), ring(w->e, 4, j));
}

static void make_density(walk *w, const int j) {
  cf_real *rho = ring(w->rho, 2, j);
  const int as = j >= 0 && j < w->count ? j : dense_as(w->s->ghost[j < 0 ? 0 : 1], j, w->count);
  if (as >= 0)
    density_row(w->s, w->n, w->at + as * w->stride, rho);
  else
    for (int i = 0; i < w->n; ++i) rho[i] = 1;
}

/* Flux through the low faces of row j; slopes up to j, edges up to j, density of j - 1 must be there. */
static void make_flux(walk *w, const int j) {
  const cf_ppm_sweep *s = w->s;
  make_slope(w, j + 1);
  make_edge(w, j + 1);
  make_density(w, j);
  cf_real *c = ring(w->c, 2, j);
  courant_row(w->n, s->u.at[s->axis] + w->at + j * w->stride, w->shift, s->half, c);
  const cf_ppm_face face = {c,
                            {values(w, j - 1), values(w, j)},
                            {ring(w->rho, 2, j - 1), ring(w->rho, 2, j)},
                            {ring(w->e, 4, j - 1), ring(w->e, 4, j), ring(w->e, 4, j + 1)}};
  flux_row(w->n, &face, ring(w->f, 2, j));
}

/* What passed the wall face j of the line. */
static void note_through(const walk *w, const ptrdiff_t line, const ptrdiff_t lines, const int j) {
  const int side = j == 0 ? 0 : 1;
  double *entered = w->s->lines + side * lines + line;
  add_through(w->n, ring(w->c, 2, j), ring(w->f, 2, j), side == 0 ? 1 : -1, entered, entered + 2 * lines);
}

static void walk_up(walk *w, const ptrdiff_t line, const int start, const int stop) {
  const cf_ppm_sweep *s = w->s;
  const bool noted = s->lines != NULL;
  make_slope(w, start - 2);
  make_slope(w, start - 1);
  make_edge(w, start - 1);
  make_slope(w, start);
  make_edge(w, start);
  make_density(w, start - 1);
  make_flux(w, start);
  if (noted && start == 0) note_through(w, line, lines_of(s), 0);
  for (int j = start; j < stop; ++j) {
    make_flux(w, j + 1);
    const cf_ppm_volume volume = {values(w, j),
                                  ring(w->rho, 2, j),
                                  {ring(w->f, 2, j), ring(w->f, 2, j + 1)},
                                  {ring(w->c, 2, j), ring(w->c, 2, j + 1)},
                                  s->mass};
    update_row(w->n, &volume, s->to + w->at + j * w->stride);
  }
  if (noted && stop == w->count) note_through(w, line, lines_of(s), stop);
}

/* One piece of one line: rows start..stop-1. */
static void sweep_piece(const cf_ppm_sweep *s, const ptrdiff_t line, const int start, const int stop,
                        cf_real *rows) {
  const cf_box *b = &s->grid->box;
  const int blocks = blocks_of(s->count[0]), other = s->axis == 1 ? 2 : 1;
  const int x = (int)(line % blocks) * BLOCK, o = (int)(line / blocks);
  const ptrdiff_t pitch = pitch_of(s->grid);
  walk w = {.s = s,
            .at = x + o * b->stride[other],
            .stride = b->stride[s->axis],
            .shift = s->component < 0 ? 0 : b->stride[s->component],
            .n = CF_MIN(BLOCK, s->count[0] - x),
            .count = s->count[s->axis],
            .wall = x + (ptrdiff_t)o * s->count[0]};
  cf_real **const ring_of_row[ROWS] = {&w.e[0],     &w.e[1],     &w.e[2],     &w.e[3],    &w.d[0], &w.d[1],
                                       &w.rho[0],   &w.rho[1],   &w.c[0],     &w.c[1],    &w.f[0], &w.f[1],
                                       &w.ghost[0], &w.ghost[1], &w.ghost[2], &w.ghost[3]};
  for (int r = 0; r < ROWS; ++r) *ring_of_row[r] = rows + r * pitch;
  walk_up(&w, line, start, stop);
}

/* How many pieces a line is cut into so that every thread has a few. */
static int pieces_of(const ptrdiff_t lines, const int count, const int threads) {
  const ptrdiff_t wanted = (4 * threads + lines - 1) / lines, most = CF_MAX(count / PIECE, 1);
  return threads == 1 ? 1 : (int)CF_MIN(wanted, most);
}

void cf_ppm_sweep_run(const cf_ppm_sweep *sweep, double through[2]) {
  cf_ppm_sweep s = *sweep;
  if (s.ghost[0] == CF_GHOST_WRAP) s.lines = NULL;
  const ptrdiff_t lines = lines_of(&s), row_elements = cf_ppm_rows(s.grid);
  const int threads = cf_sweep_threads(&s.grid->box, s.grid->threads), count = s.count[s.axis];
  const int pieces = s.axis == 0 ? 1 : pieces_of(lines, count, threads);
#pragma omp parallel for schedule(static) num_threads(threads)
  for (ptrdiff_t task = 0; task < lines * pieces; ++task) {
    cf_real *rows = s.rows + omp_get_thread_num() * row_elements;
    const ptrdiff_t line = task / pieces, piece = task % pieces;
    if (s.axis == 0)
      sweep_row(&s, line, rows);
    else
      sweep_piece(&s, line, (int)(piece * count / pieces), (int)((piece + 1) * count / pieces), rows);
  }
  if (s.lines == NULL) return;
  through[0] += cf_sum_ordered(s.lines, 2 * lines);
  through[1] += cf_sum_ordered(s.lines + 2 * lines, 2 * lines);
}
