/* SPDX-License-Identifier: MIT
 *
 * X = eps^2 div_* J(p). On the low face of axis a, between the cells p - a and p, with b (and c) the other axes,
 *
 *     p_a = [10 d(p) + d(p+b) + d(p-b)]/(12 h),   d(q) = eta_q - eta_{q-a}     (3D: 8 d(p) and four neighbours)
 *     p_b = [(eta_{p+b} - eta_{p-b}) + (eta_{p-a+b} - eta_{p-a-b})]/(4 h)
 *
 * (or d(p)/h alone, if the caller wants plain differences). With these weights the Laplacian's error is isotropic to fourth order, and the anisotropy of a crystal is its own
 * and not the grid's. The sums are grouped so that a mirrored field gives mirrored fluxes to the last bit.
 *
 * No flux passes an insulated wall, whatever the crystal's angle to it.
 *
 * One law on every face once: a thread walks over its slab of rows and keeps the fluxes that the next row or plane
 * shares. Where eta is 0 all around, X is 0 and costs nothing.
 */
#include <string.h>

#include "base/lanes.h"
#include "grid/halo.h"
#include "physics/phase_part.h"

/* What the kernel of a row of faces reads and writes. */
typedef struct faces {
  ptrdiff_t stride[3];
  const cf_real *eta, *e, *C, *S;
  const cf_anisotropy *law;
  cf_facing facing;
  cf_real centre, side;         /* weights of d(p), and of d at its neighbours, times h */
  cf_real star[3], across[3];   /* per axis: Gamma/h of normal, Gamma/(4 h) of transverse differences */
  cf_real scale[3], main, rest; /* eps^2 Gamma/h; which parts of J */
  cf_real *out;
} faces;

CF_KERNEL cf_facing facing_at(const int varies, const faces *f, const int a, const ptrdiff_t p) {
  if (!varies) return f->facing;
  const ptrdiff_t o = p - f->stride[a];
  const cf_real half = (cf_real)0.5;
  return (cf_facing){half * (f->e[o] + f->e[p]), half * (f->C[o] + f->C[p]), half * (f->S[o] + f->S[p])};
}

/* eta_{q} - eta_{q-a}. */
CF_KERNEL cf_real step_at(const faces *f, const int a, const ptrdiff_t q) {
  return f->eta[q] - f->eta[q - f->stride[a]];
}

CF_KERNEL cf_real side_at(const faces *f, const int a, const int b, const ptrdiff_t p) {
  return step_at(f, a, p + f->stride[b]) + step_at(f, a, p - f->stride[b]);
}

CF_KERNEL cf_real across_at(const faces *f, const int a, const int b, const ptrdiff_t p) {
  const ptrdiff_t o = p - f->stride[a], s = f->stride[b];
  return f->across[b] * ((f->eta[p + s] - f->eta[p - s]) + (f->eta[o + s] - f->eta[o - s]));
}

CF_KERNEL cf_real normal_at(const int dim, const faces *f, const int a, const int b, const int c,
                            const ptrdiff_t p) {
  cf_real sides = side_at(f, a, b, p);
  if (dim == 3) sides += side_at(f, a, c, p);
  return f->star[a] * (f->centre * step_at(f, a, p) + f->side * sides);
}

/* p = grad_* eta on the low face of axis a of cell p. */
CF_KERNEL cf_vec gradient_at(const int dim, const faces *f, const int a, const ptrdiff_t p) {
  const int b = a == 0 ? 1 : 0, c = a == 2 ? 1 : 2;
  const cf_real normal = normal_at(dim, f, a, b, c, p), first = across_at(f, a, b, p);
  const cf_real second = dim == 3 ? across_at(f, a, c, p) : 0;
  if (a == 0) return (cf_vec){normal, first, second};
  if (a == 1) return (cf_vec){first, normal, second};
  return (cf_vec){first, second, normal};
}

CF_KERNEL void faces_of_axis(const int dim, const int facets, const int varies, const int a, const int n,
                             const faces *f, const ptrdiff_t start) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const cf_vec p = gradient_at(dim, f, a, start + i);
    const cf_vec J =
        cf_anisotropy_flux(dim, facets, f->law, facing_at(varies, f, a, start + i), p, f->main, f->rest);
    f->out[i] = f->scale[a] * (a == 0 ? J.x : a == 1 ? J.y : J.z);
  }
}

typedef void faces_row(int axis, int n, const faces *f, ptrdiff_t start);

#define FACES_ROW(name, dim, facets, varies)                                                       \
  CF_CLONES static void name(const int axis, const int n, const faces *f, const ptrdiff_t start) { \
    if (axis == 0)                                                                                 \
      faces_of_axis(dim, facets, varies, 0, n, f, start);                                          \
    else if (axis == 1)                                                                            \
      faces_of_axis(dim, facets, varies, 1, n, f, start);                                          \
    else if (dim == 3)                                                                             \
      faces_of_axis(dim, facets, varies, 2, n, f, start);                                          \
  }
#define FACES_ROWS(facets)                      \
  FACES_ROW(faces_2_##facets##_0, 2, facets, 0) \
  FACES_ROW(faces_2_##facets##_1, 2, facets, 1) \
  FACES_ROW(faces_3_##facets##_0, 3, facets, 0) \
  FACES_ROW(faces_3_##facets##_1, 3, facets, 1)
FACES_ROWS(CF_FACETS_NONE)
FACES_ROWS(CF_FACETS_FOUR)
FACES_ROWS(CF_FACETS_SIX)
FACES_ROWS(CF_FACETS_ANY)
FACES_ROWS(CF_FACETS_CUBIC)

static faces_row *faces_row_of(const int dim, const cf_facets facets, const bool varies) {
#define FACES_NAMES(facets) \
  {{faces_2_##facets##_0, faces_2_##facets##_1}, {faces_3_##facets##_0, faces_3_##facets##_1}},
  static faces_row *const rows[CF_FACETS_COUNT][2][2] = {FACES_NAMES(CF_FACETS_NONE) FACES_NAMES(
      CF_FACETS_FOUR) FACES_NAMES(CF_FACETS_SIX) FACES_NAMES(CF_FACETS_ANY) FACES_NAMES(CF_FACETS_CUBIC)};
#undef FACES_NAMES
  return rows[facets][dim - 2][varies];
}

static faces faces_of(const cf_phase *p, const cf_phase_part part, const cf_cell eta) {
  const int dim = p->grid->box.dim;
  const double h = p->grid->h, eps2 = p->p.width * p->p.width;
  faces f = {
      .eta = eta.at, .e = p->places.strength.at, .C = p->places.C.at, .S = p->places.S.at, .law = &p->law};
  f.facing = (cf_facing){(cf_real)p->law.strength, (cf_real)p->law.C, (cf_real)p->law.S};
  const double side = p->p.plain ? 0 : 1.0 / 12;
  f.side = (cf_real)side;
  f.centre = (cf_real)(1 - 2 * (dim - 1) * side);
  f.main = part != CF_PHASE_X_2;
  f.rest = part != CF_PHASE_X_1;
  for (int a = 0; a < dim; ++a) {
    const double star = a == 2 ? p->p.star : 1;
    f.stride[a] = p->grid->box.stride[a];
    f.star[a] = (cf_real)(star / h);
    f.across[a] = (cf_real)(star / (4 * h));
    f.scale[a] = (cf_real)(eps2 * star / h);
  }
  return f;
}

/* --- where there is something ------------------------------------------------------------------------------ */

#define BLOCK 16

/* Whether n cells have nothing but 0. */
CF_KERNEL bool is_empty(const int n, const cf_real *block) {
  cf_real most = 0;
#pragma omp simd reduction(max : most)
  for (int i = 0; i < n; ++i) {
    const cf_real size = block[i] < 0 ? -block[i] : block[i];
    most = size > most ? size : most;
  }
  return most == 0;
}

/* The row of eta is 0 but for whole blocks from the first to the last in which it is not. */
CF_CLONES static void fill_span(const int n, const cf_real *row, cf_span *filled) {
  int from = 0, to = is_empty(n, row) ? 0 : n; /* most rows are empty, and one loop says so soonest */
  for (int m; m = CF_MIN(BLOCK, to - from), m > 0 && is_empty(m, row + from);) from += m;
  for (int m; m = CF_MIN(BLOCK, to - from), m > 0 && is_empty(m, row + to - m);) to -= m;
  filled->from = from;
  filled->to = to;
}

static bool has_held_wall(const cf_phase *p) {
  for (int a = 0; a < p->grid->box.dim; ++a)
    for (int side = 0; side < 2; ++side)
      if (p->eta_walls.at[a][side] != NULL) return true;
  return false;
}

static void note(const cf_phase *p, const cf_real *row, cf_span *filled) {
  const int n = p->grid->box.n[0];
  if (has_held_wall(p))
    *filled = (cf_span){0, n};
  else
    fill_span(n, row, filled);
}

void cf_phase_note_filled(const cf_phase *p, const ptrdiff_t r, const cf_real *row) {
  note(p, row, &p->next_filled[r]);
}

void cf_phase_find_filled(const cf_phase *p, const cf_cell eta) {
  const cf_box *box = &p->grid->box;
  CF_PARALLEL_ROWS (box, p->grid->threads, r) note(p, eta.at + cf_box_row(box, r), &p->filled[r]);
}

static int inside(const cf_phase *p, const int a, const int i) {
  const int n = p->grid->box.n[a];
  if (i >= 0 && i < n) return i;
  if (p->eta_walls.walls.kind[a][0] == CF_WALL_PERIODIC) return i < 0 ? n - 1 : 0;
  return i < 0 ? 0 : n - 1;
}

cf_span cf_phase_busy(const cf_phase *p, const int j, const int k) {
  const cf_box *box = &p->grid->box;
  const int n = box->n[0], reach = box->dim == 3 ? 1 : 0;
  int from = n, to = 0;
  for (int c = -reach; c <= reach; ++c)
    for (int b = -1; b <= 1; ++b) {
      const cf_span s = p->filled[inside(p, 1, j + b) + (ptrdiff_t)box->n[1] * inside(p, 2, k + c)];
      if (s.from < s.to) from = CF_MIN(from, s.from), to = CF_MAX(to, s.to);
    }
  if (from >= to) return (cf_span){0, 0};
  if ((from == 0 || to == n) && p->eta_walls.walls.kind[0][0] == CF_WALL_PERIODIC) return (cf_span){0, n};
  return (cf_span){CF_MAX(from - CF_WIDE, 0), CF_MIN(to + CF_WIDE, n)};
}

/* --- slabs ------------------------------------------------------------------------------------------------ */

typedef struct slab {
  const cf_phase *p;
  cf_phase_rows *rows;
  faces f;
  faces_row *row;
  cf_phase_visit *visit;
  void *context;
} slab;

static bool is_closed(const cf_phase *p, const int a, const int side) {
  return p->eta_walls.walls.kind[a][side] == CF_WALL_INSULATED;
}

/* 0 outside the span of n cells. */
static void clear_around(const int n, const cf_span span, cf_real *row) {
  memset(row, 0, (size_t)span.from * sizeof *row);
  memset(row + span.to, 0, (size_t)(n - span.to) * sizeof *row);
}

/* Faces number i of axis a (a wall at 0 and n) of the row that starts at `start`, into out. */
static void face_row(slab *s, const int a, const int i, const ptrdiff_t start, const cf_span busy,
                     cf_real *out) {
  const cf_box *box = &s->p->grid->box;
  if ((i == 0 && is_closed(s->p, a, 0)) || (i == box->n[a] && is_closed(s->p, a, 1))) {
    memset(out, 0, (size_t)box->n[0] * sizeof *out);
    return;
  }
  clear_around(box->n[0], busy, out);
  s->f.out = out + busy.from;
  s->row(a, busy.to - busy.from, &s->f, start + busy.from);
}

/* The faces in x, the high wall's included. Past the busy part they are 0. */
static void faces_in_x(slab *s, const ptrdiff_t start, const cf_span busy) {
  const int n = s->p->grid->box.n[0], last = busy.to == n && !is_closed(s->p, 0, 1);
  cf_real *x = s->rows->x;
  clear_around(n + 1, busy, x);
  s->f.out = x + busy.from;
  s->row(0, busy.to - busy.from + last, &s->f, start + busy.from);
  if (is_closed(s->p, 0, 0)) x[0] = 0;
}

CF_CLONES static void div_row(const cf_span busy, const cf_phase_rows *w, const cf_real *z_low,
                              cf_real *div) {
  if (z_low == NULL) {
    CF_ROW_LOOP
    for (int i = busy.from; i < busy.to; ++i) div[i] = (w->x[i + 1] - w->x[i]) + (w->y[i] - w->low[i]);
    return;
  }
  CF_ROW_LOOP
  for (int i = busy.from; i < busy.to; ++i)
    div[i] = ((w->x[i + 1] - w->x[i]) + (w->y[i] - w->low[i])) + (w->z[i] - z_low[i]);
}

static void swap_rows(cf_real **a, cf_real **b) {
  cf_real *const kept = *a;
  *a = *b;
  *b = kept;
}

/* X into div: of rows that have been visited there are the fluxes on low faces. */
static void row_of_slab(slab *s, const int j, const int k) {
  const cf_box *box = &s->p->grid->box;
  cf_phase_rows *w = s->rows;
  const int n = box->n[0];
  const ptrdiff_t start = cf_box_at(box, 0, j, k);
  cf_real *z_low = box->dim == 3 ? w->plane + (ptrdiff_t)n * j : NULL;
  const cf_span busy = w->busy = cf_phase_busy(s->p, j, k);
  clear_around(n, busy, w->div);
  if (busy.from < busy.to) {
    faces_in_x(s, start, busy);
    face_row(s, 1, j + 1, start + box->stride[1], busy, w->y);
    if (z_low != NULL) face_row(s, 2, k + 1, start + box->stride[2], busy, w->z);
    div_row(busy, w, z_low, w->div);
  } else {
    memset(w->y, 0, (size_t)n * sizeof *w->y);
    if (z_low != NULL) memset(w->z, 0, (size_t)n * sizeof *w->z);
  }
  swap_rows(&w->y, &w->low);
  if (z_low != NULL) memcpy(z_low, w->z, (size_t)n * sizeof *w->z);
}

/* Rows [from, to) of the outermost axis. */
static void run_slab(slab *s, const int from, const int to) {
  const cf_box *box = &s->p->grid->box;
  const bool space = box->dim == 3;
  const cf_span all = {0, box->n[0]};
  if (space)
    for (int j = 0; j < box->n[1]; ++j)
      face_row(s, 2, from, cf_box_at(box, 0, j, from), all, s->rows->plane + (ptrdiff_t)box->n[0] * j);
  for (int k = space ? from : 0; k < (space ? to : 1); ++k) {
    const int first = space ? 0 : from, last = space ? box->n[1] : to;
    face_row(s, 1, first, cf_box_at(box, 0, first, k), all, s->rows->low);
    for (int j = first; j < last; ++j) {
      row_of_slab(s, j, k);
      s->visit(s->p, s->rows, cf_box_at(box, 0, j, k), j + (ptrdiff_t)box->n[1] * k, s->context);
    }
  }
}

void cf_phase_each_row(const cf_phase *p, const cf_phase_part part, const cf_cell eta, cf_phase_visit *visit,
                       void *context) {
  const cf_box *box = &p->grid->box;
  const int outer = box->n[box->dim - 1];
  const int threads = CF_MIN(CF_MIN(p->threads, cf_sweep_threads(box, p->grid->threads)), outer);
  const faces f = faces_of(p, part, eta);
  faces_row *const row = faces_row_of(box->dim, p->law.facets, p->places.strength.at != NULL);
  if (p->known_of != eta.at) cf_phase_find_filled(p, eta);
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int t = 0; t < threads; ++t) {
    slab s = {p, &p->rows[t], f, row, visit, context};
    run_slab(&s, (int)((ptrdiff_t)outer * t / threads), (int)((ptrdiff_t)outer * (t + 1) / threads));
  }
}

void cf_phase_ghosts(const cf_phase *p, const cf_cell eta) { cf_wall_ghosts(&p->eta_walls, eta); }
