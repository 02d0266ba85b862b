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
#define PIECE 32                          /* rows of a piece of a line, at least */
#define RINGS 12                          /* row buffers of a field */
#define ROWS  (4 + CF_PPM_FIELDS * RINGS) /* row buffers of a thread */

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

/* Density of the volumes beyond the ends of a row. */
static void fill_density_ends(const cf_ppm_sweep *s, cf_real *rho) {
  const int n = s->count[0];
  for (int side = 0; side < 2; ++side) {
    const int to = side == 0 ? -1 : n, as = dense_as(s->field[0].ghost[side], to, n);
    rho[to] = as < 0 ? 1 : rho[as];
  }
}

static void fill_ends(const cf_ppm_field *f, const int n, const ptrdiff_t line, const cf_real *c,
                      cf_real *p) {
  for (int side = 0; side < 2; ++side) {
    const cf_ghost rule = f->ghost[side];
    const bool enters = rule == CF_GHOST_INFLOW && (side == 0 ? c[0] > 0 : c[n] < 0);
    for (int g = 0; g < 3; ++g) {
      const int to = side == 0 ? -1 - g : n + g;
      const cf_real image = p[cf_ghost_image(rule, to, n)];
      p[to] = enters ? (cf_real)f->inflow[side][line] : rule == CF_GHOST_ODD ? -image : image;
    }
  }
}

/* One field of a row, with Courant numbers and density of the row; `rows` has room for four. */
static void sweep_row_of(const cf_ppm_sweep *s, const cf_ppm_field *field, const ptrdiff_t line,
                         const cf_real *c, const cf_real *rho, cf_real *rows) {
  const ptrdiff_t at = cf_box_at(&s->grid->box, 0, (int)(line % s->count[1]), (int)(line / s->count[1]));
  const ptrdiff_t pitch = pitch_of(s->grid), lines = lines_of(s);
  const int n = s->count[0];
  cf_real *p = rows, *d = p + pitch, *e = d + pitch, *f = e + pitch;
  for (int i = 0; i < n; ++i) p[i] = field->from[at + i];
  fill_ends(field, n, line, c, p);
  slope_row(n + 4, p - 3, p - 2, p - 1, d - 2);
  edge_row(n + 3, p - 2, p - 1, d - 2, d - 1, e - 1);
  const cf_ppm_face face = {c, {p - 1, p}, {rho - 1, rho}, {e - 1, e, e + 1}};
  flux_row(n + 1, &face, f);
  const cf_ppm_volume volume = {p, rho, {f, f + 1}, {c, c + 1}, s->mass};
  update_row(n, &volume, field->to + at);
  if (field->lines == NULL) return;
  double *low = field->lines + line, *high = low + lines;
  add_through(1, c, f, 1, low, low + 2 * lines);
  add_through(1, c + n, f + n, -1, high, high + 2 * lines);
}

static void sweep_row(const cf_ppm_sweep *s, const ptrdiff_t line, cf_real *rows) {
  const cf_box *b = &s->grid->box;
  const ptrdiff_t at = cf_box_at(b, 0, (int)(line % s->count[1]), (int)(line / s->count[1]));
  const ptrdiff_t pitch = pitch_of(s->grid), shift = s->component < 0 ? 0 : b->stride[s->component];
  const int n = s->count[0];
  cf_real *rho = rows + CF_LANES, *c = rho + pitch;
  courant_row(n + 1, s->u.at[0] + at, shift, s->half, c);
  density_row(s, n, at, rho);
  fill_density_ends(s, rho);
  for (int f = 0; f < s->fields; ++f) sweep_row_of(s, &s->field[f], line, c, rho, c + pitch);
}

/* --- along y and z ------------------------------------------------------------------------------------ */

/* Rings of one field of a walk; row j of a ring of m is ring[j mod m]. */
typedef struct rider {
  const cf_ppm_field *field;
  cf_real *ghost[4], *e[4], *d[2], *f[2];
} rider;

/* A line that walks up the axis, and the rings that its fields share. */
typedef struct walk {
  const cf_ppm_sweep *s;
  ptrdiff_t at, stride,
      shift;      /* volume 0 of the line; to the next volume; to the component's lower neighbour */
  int n, count;   /* elements of a row; volumes along the line */
  ptrdiff_t line, /* its number */
      wall;       /* of the line's first element in the wall's layer of values */
  cf_real *rho[2], *c[2];
  rider rider[CF_PPM_FIELDS];
} walk;

static cf_real *ring(cf_real *const *rows, const int m, const int j) { return rows[(j + m * 4) % m]; }

/* The values of volume row j, -3 <= j < count + 3. */
static const cf_real *values(const walk *w, const rider *r, const int j) {
  const cf_ppm_field *f = r->field;
  if (j >= 0 && j < w->count) return f->from + w->at + j * w->stride;
  const int side = j < 0 ? 0 : 1;
  const cf_ghost rule = f->ghost[side];
  const cf_real *image = f->from + w->at + cf_ghost_image(rule, j, w->count) * w->stride;
  if (rule != CF_GHOST_ODD && rule != CF_GHOST_INFLOW) return image;
  cf_real *ghost = ring(r->ghost, 4, j);
  if (rule == CF_GHOST_ODD) {
    for (int i = 0; i < w->n; ++i) ghost[i] = -image[i];
    return ghost;
  }
  const cf_real *u = w->s->u.at[w->s->axis] + w->at + (side == 0 ? 0 : w->count) * w->stride;
  const double *inflow = f->inflow[side] + w->wall;
  const cf_real inward = side == 0 ? 1 : -1;
  for (int i = 0; i < w->n; ++i) ghost[i] = inward * u[i] > 0 ? (cf_real)inflow[i] : image[i];
  return ghost;
}

static void make_slope(const walk *w, const rider *r, const int j) {
  slope_row(w->n, values(w, r, j - 1), values(w, r, j), values(w, r, j + 1), ring(r->d, 2, j));
}

static void make_edge(const walk *w, const rider *r, const int j) {
  edge_row(w->n, values(w, r, j - 1), values(w, r, j), ring(r->d, 2, j - 1), ring(r->d, 2, j),
           ring(r->e, 4, j));
}

/* Of volume row j, once for all fields. */
static void make_density(const walk *w, const int j) {
  cf_real *rho = ring(w->rho, 2, j);
  const cf_ghost rule = w->s->field[0].ghost[j < 0 ? 0 : 1];
  const int as = j >= 0 && j < w->count ? j : dense_as(rule, j, w->count);
  if (as >= 0)
    density_row(w->s, w->n, w->at + as * w->stride, rho);
  else
    for (int i = 0; i < w->n; ++i) rho[i] = 1;
}

/* On the low faces of row j, likewise; and the density above them. */
static void make_courant(const walk *w, const int j) {
  make_density(w, j);
  courant_row(w->n, w->s->u.at[w->s->axis] + w->at + j * w->stride, w->shift, w->s->half, ring(w->c, 2, j));
}

/* What passed the wall face j of the line. */
static void note_through(const walk *w, const rider *r, const int j) {
  const int side = j == 0 ? 0 : 1;
  const ptrdiff_t lines = lines_of(w->s);
  double *entered = r->field->lines + side * lines + w->line;
  add_through(w->n, ring(w->c, 2, j), ring(r->f, 2, j), side == 0 ? 1 : -1, entered, entered + 2 * lines);
}

/* Flux through the low faces of row j; slopes up to j, edges up to j, density of j - 1 must be there. */
static void make_flux(const walk *w, const rider *r, const int j) {
  make_slope(w, r, j + 1);
  make_edge(w, r, j + 1);
  const cf_ppm_face face = {ring(w->c, 2, j),
                            {values(w, r, j - 1), values(w, r, j)},
                            {ring(w->rho, 2, j - 1), ring(w->rho, 2, j)},
                            {ring(r->e, 4, j - 1), ring(r->e, 4, j), ring(r->e, 4, j + 1)}};
  flux_row(w->n, &face, ring(r->f, 2, j));
  if (r->field->lines != NULL && (j == 0 || j == w->count)) note_through(w, r, j);
}

static void begin_walk(const walk *w, const rider *r, const int start) {
  make_slope(w, r, start - 2);
  make_slope(w, r, start - 1);
  make_edge(w, r, start - 1);
  make_slope(w, r, start);
  make_edge(w, r, start);
  make_flux(w, r, start);
}

static void update(const walk *w, const rider *r, const int j) {
  const cf_ppm_volume volume = {values(w, r, j),
                                ring(w->rho, 2, j),
                                {ring(r->f, 2, j), ring(r->f, 2, j + 1)},
                                {ring(w->c, 2, j), ring(w->c, 2, j + 1)},
                                w->s->mass};
  update_row(w->n, &volume, r->field->to + w->at + j * w->stride);
}

static void walk_up(const walk *w, const int start, const int stop) {
  const rider *end = w->rider + w->s->fields;
  make_density(w, start - 1);
  make_courant(w, start);
  for (const rider *r = w->rider; r < end; ++r) begin_walk(w, r, start);
  for (int j = start; j < stop; ++j) {
    make_courant(w, j + 1);
    for (const rider *r = w->rider; r < end; ++r) {
      make_flux(w, r, j + 1);
      update(w, r, j);
    }
  }
}

static cf_real *take_rows(cf_real **ring_of_row, const int count, const ptrdiff_t pitch, cf_real *rows) {
  for (int r = 0; r < count; ++r, rows += pitch) ring_of_row[r] = rows;
  return rows;
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
            .line = line,
            .wall = x + (ptrdiff_t)o * s->count[0]};
  rows = take_rows(w.rho, 2, pitch, rows);
  rows = take_rows(w.c, 2, pitch, rows);
  for (int f = 0; f < s->fields; ++f) {
    rider *r = &w.rider[f];
    r->field = &s->field[f];
    rows = take_rows(r->e, 4, pitch, rows);
    rows = take_rows(r->d, 2, pitch, rows);
    rows = take_rows(r->f, 2, pitch, rows);
    rows = take_rows(r->ghost, 4, pitch, rows);
  }
  walk_up(&w, start, stop);
}

/* How many pieces a line is cut into so that every thread has a few. */
static int pieces_of(const ptrdiff_t lines, const int count, const int threads) {
  const ptrdiff_t wanted = (4 * threads + lines - 1) / lines, most = CF_MAX(count / PIECE, 1);
  return threads == 1 ? 1 : (int)CF_MIN(wanted, most);
}

void cf_ppm_sweep_run(cf_ppm_sweep *s) {
  const ptrdiff_t lines = lines_of(s), row_elements = cf_ppm_rows(s->grid);
  const int threads = cf_sweep_threads(&s->grid->box, s->grid->threads), count = s->count[s->axis];
  const int pieces = s->axis == 0 ? 1 : pieces_of(lines, count, threads);
#pragma omp parallel for schedule(static) num_threads(threads)
  for (ptrdiff_t task = 0; task < lines * pieces; ++task) {
    cf_real *rows = s->rows + omp_get_thread_num() * row_elements;
    const ptrdiff_t line = task / pieces, piece = task % pieces;
    if (s->axis == 0)
      sweep_row(s, line, rows);
    else
      sweep_piece(s, line, (int)(piece * count / pieces), (int)((piece + 1) * count / pieces), rows);
  }
  for (cf_ppm_field *f = s->field; f < s->field + s->fields; ++f) {
    if (f->lines == NULL) continue;
    f->entered += cf_sum_ordered(f->lines, 2 * lines);
    f->left += cf_sum_ordered(f->lines + 2 * lines, 2 * lines);
  }
}
