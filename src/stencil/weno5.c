/* SPDX-License-Identifier: MIT
 *
 * Rows of x in pieces that walk up y: the fluxes on the upper faces of a row are those on the lower faces of the
 * next. Along z both sides are worked out. Where a piece begins changes no bit.
 */
#include "stencil/weno5.h"

#include <omp.h>

#include "grid/sweep.h"
#include "stencil/weno.h"

enum { PIECE = 32, BUFFERS = 16 };

/* Everything around a row of faces: the six volumes p[0] .. p[5] in the order of the axis, the face between p[2]
 * and p[3]. */
typedef struct stencil {
  const cf_real *c, *p[6];
} stencil;

CF_CLONES static void flux_row(const int n, const stencil *at, cf_real *f) {
  const cf_real *c_row = at->c, *p0 = at->p[0], *p1 = at->p[1], *p2 = at->p[2], *p3 = at->p[3],
                *p4 = at->p[4], *p5 = at->p[5];
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    /* Everything is loaded before anything is chosen: a chosen load is a branch. */
    const cf_real c = c_row[i], v0 = p0[i], v1 = p1[i], v2 = p2[i], v3 = p3[i], v4 = p4[i], v5 = p5[i];
    const cf_real first = c > 0 ? v0 : v5, second = c > 0 ? v1 : v4, third = c > 0 ? v2 : v3;
    const cf_real fourth = c > 0 ? v3 : v2, fifth = c > 0 ? v4 : v1;
    f[i] = c * cf_weno5(first, second, third, fourth, fifth);
  }
}

/* c[i] = (u[i] + u[i - shift]) w. */
CF_CLONES static void courant_row(const int n, const cf_real *u, const ptrdiff_t shift, const cf_real w,
                                  cf_real *c) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) c[i] = (u[i] + u[i - shift]) * w;
}

/* What the two faces of an axis take out of a row of volumes is added to `out`. */
CF_CLONES static void outflow_row(const int n, const cf_real *low, const cf_real *high, cf_real *out) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) out[i] += high[i] - low[i];
}

CF_CLONES static void divergence_row(const int n, const cf_real *p, const cf_real *low, const cf_real *high,
                                     cf_real *out) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) out[i] -= p[i] * (high[i] - low[i]);
}

typedef struct mix {
  const cf_real *old, *from, *out;
  cf_real share;
} mix;

CF_CLONES static void mix_row(const int n, const mix *m, cf_real *to) {
  const cf_real *old = m->old, *from = m->from, *out = m->out, share = m->share, rest = 1 - m->share;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) to[i] = share * old[i] + rest * (from[i] - out[i]);
}

/* --- scratch ---------------------------------------------------------------------------------------------- */

/* Elements of a row buffer: a row of faces with three ghosts on both sides. */
static ptrdiff_t pitch_of(const cf_grid *g) {
  const ptrdiff_t pitch = (g->box.n[0] + 2 + 4 * CF_LANES - 1) / CF_LANES * CF_LANES;
  return pitch * (ptrdiff_t)sizeof(cf_real) % 4096 == 0 ? pitch + CF_LANES : pitch;
}

ptrdiff_t cf_weno5_rows(const cf_grid *g) { return BUFFERS * pitch_of(g); }

ptrdiff_t cf_weno5_lines(const cf_grid *g) { return 2 * (ptrdiff_t)(g->box.n[1] + 1) * (g->box.n[2] + 1); }

/* The rows that a thread works with: Courant numbers and fluxes on the lower [0] and upper [1] faces of y and z;
 * those of z serve along x as well. */
typedef struct bench {
  cf_real *ghost[6]; /* made where no row of the field will do */
  cf_real *line;     /* the row along x with its ghosts */
  cf_real *out;      /* what leaves a row of volumes */
  cf_real *c[3][2], *f[3][2];
} bench;

static bench bench_of(const cf_grid *g, cf_real *rows) {
  bench b;
  const ptrdiff_t pitch = pitch_of(g);
  cf_real *at = rows + CF_LANES;
  for (int i = 0; i < 6; ++i, at += pitch) b.ghost[i] = at;
  b.line = at;
  b.out = at + pitch;
  for (int i = 0; i < 2; ++i) {
    b.c[1][i] = at + (2 + 4 * i) * pitch;
    b.f[1][i] = at + (3 + 4 * i) * pitch;
    b.c[2][i] = b.c[0][i] = at + (4 + 4 * i) * pitch;
    b.f[2][i] = b.f[0][i] = at + (5 + 4 * i) * pitch;
  }
  return b;
}

/* --- ghosts ----------------------------------------------------------------------------------------------- */

/* Along x. */
static void fill_ends(const cf_weno5_stage *s, const int j, const int k, const cf_real *c, cf_real *p) {
  const int n = s->count[0];
  for (int side = 0; side < 2; ++side) {
    const cf_ghost rule = s->ghost[0][side];
    const bool enters = rule == CF_GHOST_INFLOW && (side == 0 ? c[0] > 0 : c[n] < 0);
    for (int g = 0; g < 3; ++g) {
      const int to = side == 0 ? -1 - g : n + g;
      const cf_real image = p[cf_ghost_image(rule, to, n)];
      p[to] = enters                 ? (cf_real)s->inflow[0][side][j + (ptrdiff_t)s->count[1] * k]
              : rule == CF_GHOST_ODD ? -image
                                     : image;
    }
  }
}

/* Along y and z: the row of volumes at `at` of the axis, in line with the row (j, k); beyond a wall perhaps
 * written to `ghost`. */
static const cf_real *row_at(const cf_weno5_stage *s, const int axis, const int at, const int j, const int k,
                             cf_real *ghost) {
  const cf_box *b = &s->grid->box;
  const int count = s->count[axis], n = s->count[0];
  const bool inside = at >= 0 && at < count;
  const int side = at < 0 ? 0 : 1;
  const cf_ghost rule = s->ghost[axis][side];
  const int from = inside ? at : cf_ghost_image(rule, at, count);
  const cf_real *image = s->from + (axis == 1 ? cf_box_at(b, 0, from, k) : cf_box_at(b, 0, j, from));
  if (inside || (rule != CF_GHOST_ODD && rule != CF_GHOST_INFLOW)) return image;
  if (rule == CF_GHOST_ODD) {
    for (int i = 0; i < n; ++i) ghost[i] = -image[i];
    return ghost;
  }
  const int wall = side == 0 ? 0 : count;
  const cf_real *u = s->u.at[axis] + (axis == 1 ? cf_box_at(b, 0, wall, k) : cf_box_at(b, 0, j, wall));
  const double *inflow = s->inflow[axis][side] + (ptrdiff_t)n * (axis == 1 ? k : j);
  const cf_real inward = side == 0 ? 1 : -1;
  for (int i = 0; i < n; ++i) ghost[i] = inward * u[i] > 0 ? (cf_real)inflow[i] : image[i];
  return ghost;
}

/* --- fluxes ----------------------------------------------------------------------------------------------- */

static ptrdiff_t shift_of(const cf_weno5_stage *s) {
  return s->component < 0 ? 0 : s->grid->box.stride[s->component];
}

/* Courant numbers and fluxes on the lower faces, of y or z, of the volumes at `at` of that axis. */
static void faces_at(const cf_weno5_stage *s, const bench *b, const int axis, const int place[2], cf_real *c,
                     cf_real *f) {
  const int j = place[0], k = place[1], at = axis == 1 ? j : k, n = s->count[0];
  const cf_real *u = s->u.at[axis] + cf_box_at(&s->grid->box, 0, j, k);
  stencil face = {.c = c};
  for (int i = 0; i < 6; ++i) face.p[i] = row_at(s, axis, at - 3 + i, j, k, b->ghost[i]);
  courant_row(n, u, shift_of(s), s->half, c);
  flux_row(n, &face, f);
}

/* What passed through a row of wall faces: `inward` 1 on the low wall, -1 on the high one. */
static void add_through(const int n, const cf_real *c, const cf_real *f, const cf_real inward,
                        double through[2]) {
  for (int i = 0; i < n; ++i) {
    const double passed = (double)(inward * f[i]);
    if (inward * c[i] > 0)
      through[0] += passed;
    else
      through[1] -= passed;
  }
}

static bool is_wall(const cf_weno5_stage *s, const int axis) { return s->ghost[axis][0] != CF_GHOST_WRAP; }

static void along_x(const cf_weno5_stage *s, const bench *b, const int place[2], double through[2]) {
  const int n = s->count[0];
  const ptrdiff_t at = cf_box_at(&s->grid->box, 0, place[0], place[1]);
  cf_real *p = b->line, *c = b->c[0][0], *f = b->f[0][0];
  for (int i = 0; i < n; ++i) p[i] = s->from[at + i];
  courant_row(n + 1, s->u.at[0] + at, shift_of(s), s->half, c);
  fill_ends(s, place[0], place[1], c, p);
  const stencil face = {c, {p - 3, p - 2, p - 1, p, p + 1, p + 2}};
  flux_row(n + 1, &face, f);
  for (int i = 0; i < n; ++i) b->out[i] = 0;
  outflow_row(n, f, f + 1, b->out);
  if (!s->mass) divergence_row(n, p, c, c + 1, b->out);
  if (!is_wall(s, 0)) return;
  add_through(1, c, f, 1, through);
  add_through(1, c + n, f + n, -1, through);
}

/* Along y or z, with the lower faces known. */
static void along(const cf_weno5_stage *s, const bench *b, const int axis, const int place[2],
                  double through[2]) {
  const int n = s->count[0], at = place[axis - 1];
  const int above[2] = {place[0] + (axis == 1 ? 1 : 0), place[1] + (axis == 2 ? 1 : 0)};
  cf_real *const *c = b->c[axis], *const *f = b->f[axis];
  faces_at(s, b, axis, above, c[1], f[1]);
  outflow_row(n, f[0], f[1], b->out);
  if (!s->mass) divergence_row(n, b->line, c[0], c[1], b->out);
  if (!is_wall(s, axis)) return;
  if (at == 0) add_through(n, c[0], f[0], 1, through);
  if (at == s->count[axis] - 1) add_through(n, c[1], f[1], -1, through);
}

static void swap_rows(cf_real *rows[2]) {
  cf_real *const low = rows[0];
  rows[0] = rows[1];
  rows[1] = low;
}

/* Rows j0 <= j < j1 of the layer k. */
static void stage_piece(const cf_weno5_stage *s, const int j0, const int j1, const int k, cf_real *rows) {
  const cf_box *box = &s->grid->box;
  bench b = bench_of(s->grid, rows);
  faces_at(s, &b, 1, (const int[2]){j0, k}, b.c[1][0], b.f[1][0]);
  for (int j = j0; j < j1; ++j) {
    const int place[2] = {j, k};
    const ptrdiff_t at = cf_box_at(box, 0, j, k);
    double through[2] = {0, 0};
    along_x(s, &b, place, through);
    along(s, &b, 1, place, through);
    swap_rows(b.c[1]);
    swap_rows(b.f[1]);
    if (box->dim == 3) {
      faces_at(s, &b, 2, place, b.c[2][0], b.f[2][0]);
      along(s, &b, 2, place, through);
    }
    const mix m = {s->old + at, b.line, b.out, s->share};
    mix_row(s->count[0], &m, s->to + at);
    if (s->lines == NULL) continue;
    double *line = s->lines + j + (ptrdiff_t)s->count[1] * k;
    line[0] = through[0];
    line[(ptrdiff_t)s->count[1] * s->count[2]] = through[1];
  }
}

void cf_weno5_stage_run(const cf_weno5_stage *s, const double weight, double through[2]) {
  const int pieces = CF_MAX(s->count[1] / PIECE, 1), count = s->count[1];
  const ptrdiff_t each = cf_weno5_rows(s->grid), lines = (ptrdiff_t)count * s->count[2];
#pragma omp parallel for schedule(static) num_threads(cf_sweep_threads(&s->grid->box, s->grid->threads))
  for (ptrdiff_t task = 0; task < (ptrdiff_t)pieces * s->count[2]; ++task) {
    const int piece = (int)(task % pieces), k = (int)(task / pieces);
    const int j0 = (int)((ptrdiff_t)piece * count / pieces),
              j1 = (int)((ptrdiff_t)(piece + 1) * count / pieces);
    stage_piece(s, j0, j1, k, s->rows + omp_get_thread_num() * each);
  }
  if (s->lines == NULL) return;
  through[0] += weight * cf_sum_ordered(s->lines, lines);
  through[1] += weight * cf_sum_ordered(s->lines + lines, lines);
}
