/* SPDX-License-Identifier: MIT
 *
 * Half sweeps on a level of couplings, and its residual, as lists of stages.
 */
#include "solve/coupled_pass.h"

#include "solve/colours.h"
#include "solve/lean.h"

/* --- seams -------------------------------------------------------------------------------------------- */

/* A ghost that is right already is not written: its page may not be ours to touch. */
static void copy_ghost(float *to, const float from) {
  if (*to != from) *to = from;
}

void cf_coupled_wrap_axis(const cf_coupled *l, const int a, float *f) {
  const cf_box *b = &l->box;
  if (!l->periodic[a]) return;
  int n[3] = {b->n[0], b->n[1], b->n[2]};
  const ptrdiff_t last = (b->n[a] - 1) * b->stride[a], step = b->stride[a];
  n[a] = 1;
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        float *at = f + cf_box_at(b, i, j, k);
        copy_ghost(at - step, at[last]);
        copy_ghost(at + last + step, at[0]);
      }
}

void cf_coupled_wrap(const cf_coupled *l, float *f) {
  for (int a = 0; a < l->dim; ++a) cf_coupled_wrap_axis(l, a, f);
}

/* --- half sweeps -------------------------------------------------------------------------------------- */

/* Cells of a row that go together. */
#define APART 512

/* The level as the kernels of a row see it, and where the row is. */
typedef struct view {
  float *e, *rest;
  const float *r, *inverse, *free, *held, *c[3];
  ptrdiff_t stride[3];
  float omega;
  float *to; /* of sums: where they go, */
  bool pairs, is_first;
} view;

typedef struct place {
  ptrdiff_t p;
  int parity; /* of the cells meant, counted from p */
} place;

static view view_of(const cf_coupled *l, const float omega) {
  return (view){.e = l->e,
                .rest = l->rest,
                .r = l->r,
                .inverse = l->inverse,
                .free = l->free,
                .held = l->held,
                .c = {l->c[0], l->c[1], l->c[2]},
                .stride = {l->box.stride[0], l->box.stride[1], l->box.stride[2]},
                .omega = omega};
}

CF_KERNEL void first_row(const int dim, const int n, const view *v, const place at) {
  (void)dim;
  float *e = v->e + at.p;
  const float *r = v->r + at.p, *inverse = v->inverse + at.p;
  const float omega = v->omega;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i)
    e[i] = ((i ^ at.parity) & 1) == 0 && inverse[i] > 0 ? omega * (inverse[i] * r[i]) : 0;
}

/* Neighbours have the other colour, so rows may run in any order and the loop in vectors; both colours are computed and
 * one is kept, so that what is read while another thread changes it does not count. Changes are put down apart first:
 * a vector that is loaded across one just stored waits for the store. form 1: a cell is over-relaxed by what couplings
 * have of its diagonal; one that a large alpha holds is simply solved. */
CF_KERNEL void half_piece(const int dim, const int form, const int n, const view *v, const place at) {
  const view w = *v;
  float *e = w.e + at.p;
  const float *r = w.r + at.p, *inverse = w.inverse + at.p;
  _Alignas(CF_ALIGN) float fresh[APART];
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    CF_THROWN_AWAY(((i ^ at.parity) & 1) != 0);
    float sum = r[i];
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) {
      const float *c = w.c[a] + at.p;
      sum += c[i] * e[i - w.stride[a]] + c[i + w.stride[a]] * e[i + w.stride[a]];
    }
    const float share = form ? 1 - w.free[at.p + i] * inverse[i] : 1;
    const float over = form ? (w.omega - 1) * share * share : w.omega - 1;
    fresh[i] = inverse[i] > 0 ? (1 + over) * (inverse[i] * sum) - over * e[i] : 0;
  }
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i)
    if (((i ^ at.parity) & 1) == 0) e[i] = fresh[i];
}

CF_KERNEL void half_row(const int dim, const int form, const int n, const view *v, const place at) {
  for (int from = 0; from < n; from += APART) /* even, so that the parity stays */
    half_piece(dim, form, CF_MIN(APART, n - from), v, (place){at.p + from, at.parity});
}

/* Nothing is left where there is no equation: r is that of an earlier region there. */
CF_KERNEL void residual_piece(const int dim, const int n, const view *v, const ptrdiff_t p, float *rest) {
  const view w = *v;
  const float *e = w.e + p, *r = w.r + p, *free = w.free + p, *held = w.held + p, *inverse = w.inverse + p;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    float sum = (free[i] + held[i]) * e[i];
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) {
      const float *c = w.c[a] + p;
      sum += c[i] * (e[i] - e[i - w.stride[a]]) - c[i + w.stride[a]] * (e[i + w.stride[a]] - e[i]);
    }
    rest[i] = inverse[i] > 0 ? r[i] - sum : 0;
  }
}

CF_KERNEL void residual_row(const int dim, const int n, const view *v, const place at) {
  residual_piece(dim, n, v, at.p, v->rest + at.p);
}

/* The pairs of cells of a row go to the coarse row above it, or its cells do; what is missing at its end counts as 0. */
CF_KERNEL void sum_row(const int dim, const int n, const view *v, const place at) {
  _Alignas(CF_ALIGN) float rest[APART + 1];
  const int shift = v->pairs, first = v->is_first;
  for (int from = 0; from < n; from += APART) {
    const int m = CF_MIN(APART, n - from);
    float *to = v->to + (from >> shift);
    residual_piece(dim, m, v, at.p + from, rest);
    rest[m] = 0;
    if (shift) {
      CF_ROW_LOOP
      for (int i = 0; i < (m + 1) / 2; ++i) to[i] = (first ? 0 : to[i]) + (rest[2 * i] + rest[2 * i + 1]);
    } else {
      CF_ROW_LOOP
      for (int i = 0; i < m; ++i) to[i] = (first ? 0 : to[i]) + rest[i];
    }
  }
}

CF_CLONED(first_row, const view *, const place)
CF_CLONED_FORMS(half_row, const view *, const place)
CF_CLONED(residual_row, const view *, const place)
CF_CLONED(sum_row, const view *, const place)

/* --- stages ------------------------------------------------------------------------------------------- */

typedef cf_coupled_pass pass;

static void push_band(pass *s, const cf_band_sweeps band, const bool back) {
  if (s->l->has_band)
    for (int v = 0; v < 2 * band.count; ++v) cf_pass_add(s, CF_STAGE_BAND, (v + back) % 2, band.omega);
}

/* Where the sums of a row go. */
static void find_sums(const pass *s, const cf_run *run, const int j, const int k, view *w) {
  const cf_coupled *l = s->l;
  const int x = l->coarsened[0], y = l->coarsened[1], z = l->coarsened[2];
  w->pairs = x;
  w->is_first = (j & y) == 0 && (k & z) == 0;
  w->to = s->coarse->r + cf_box_at(&s->coarse->box, run->low >> x, j >> y, k >> z);
}

static void run_row(const pass *s, const cf_coupled_stage kind, const int n, const view *v, const place at) {
  const cf_coupled *l = s->l;
  if (kind == CF_STAGE_FIRST)
    first_row_by_dim(l->dim, n, v, at);
  else if (kind == CF_STAGE_REST)
    residual_row_by_dim(l->dim, n, v, at);
  else if (kind == CF_STAGE_SUM)
    sum_row_by_dim(l->dim, n, v, at);
  else
    half_row_by_form(l->dim, l->is_gentle, n, v, at);
}

/* Stage `number` on rows [j, j_end) of plane k. end: cells from there on, along each axis, are left out. */
static void run_rows_to(const pass *s, const int number, int j, const int j_end, const int k,
                        const int end[3]) {
  const cf_coupled *l = s->l;
  const cf_coupled_stage kind = s->stage[number].kind;
  view w = view_of(l, s->stage[number].omega);
  if (kind == CF_STAGE_NONE) return;
  for (; j < CF_MIN(j_end, end[1]); ++j) {
    const cf_run *run, *run_end;
    if (kind == CF_STAGE_BAND && !l->band[j + (ptrdiff_t)l->box.n[1] * k]) continue;
    for (cf_coupled_runs(l, j, k, &run, &run_end); run < run_end; ++run) {
      if (kind == CF_STAGE_OWN) {
        s->own(s->of, run, j, k);
        continue;
      }
      if (kind == CF_STAGE_SPREAD) {
        cf_coupled_spread(s->coarse, l, run, j, k);
        continue;
      }
      if (kind == CF_STAGE_SUM) find_sums(s, run, j, k, &w);
      run_row(s, kind, CF_MIN(run->high, end[0]) - run->low, &w,
              (place){cf_box_at(&l->box, run->low, j, k), (j + k + s->stage[number].colour + run->low) & 1});
    }
  }
}

static void run_rows(const void *of, const int number, const int j, const int j_end, const int k) {
  const pass *s = of;
  run_rows_to(s, number, j, j_end, k, s->l->box.n);
}

/* --- periodic axes: stage by stage -------------------------------------------------------------------- */

static float relaxed(const view *v, const int dim, const ptrdiff_t p) {
  float sum = v->r[p];
  for (int a = 0; a < dim; ++a) {
    const ptrdiff_t s = v->stride[a];
    sum += v->c[a][p] * v->e[p - s] + v->c[a][p + s] * v->e[p + s];
  }
  return v->inverse[p] * sum;
}

static bool has_odd_seam(const cf_coupled *l, const int a) { return l->periodic[a] && l->box.n[a] % 2 == 1; }

/* Cells of a colour in the last layer of axis a, one after the other. That layer of an odd periodic axis and the first are
 * neighbours of one colour, moved at once without seeing each other; the last one moves once more, so that it comes after
 * all others of its colour as Gauss-Seidel has it. */
static void sweep_seam(const cf_coupled *l, const int a, const int colour, const bool back) {
  const view w = view_of(l, 1);
  int low[3] = {0, 0, 0}, n[3] = {l->box.n[0], l->box.n[1], l->box.n[2]};
  if (!has_odd_seam(l, a)) return;
  cf_coupled_wrap(l, l->e);
  low[a] = n[a] - 1;
  n[a] = 1;
  const ptrdiff_t cells = (ptrdiff_t)n[0] * n[1] * n[2];
  for (ptrdiff_t v = 0; v < cells; ++v) {
    const ptrdiff_t c = back ? cells - 1 - v : v;
    const int i = low[0] + (int)(c % n[0]), j = low[1] + (int)(c / n[0] % n[1]),
              k = low[2] + (int)(c / n[0] / n[1]);
    const ptrdiff_t p = cf_box_at(&l->box, i, j, k);
    if (((i + j + k + colour) & 1) == 0) w.e[p] = relaxed(&w, l->dim, p); /* 0 without an equation */
  }
}

/* `back`: the last layers first, then all others. */
static void run_stage(const pass *s, const int number, const bool back) {
  const cf_coupled *l = s->l;
  const cf_coupled_stage kind = s->stage[number].kind;
  const int colour = s->stage[number].colour;
  const bool sweeps = kind == CF_STAGE_FIRST || kind == CF_STAGE_HALF || kind == CF_STAGE_BAND;
  int end[3] = {l->box.n[0], l->box.n[1], l->box.n[2]};
  for (int a = l->dim - 1; a >= 0 && back && sweeps; --a) {
    sweep_seam(l, a, colour, true);
    end[a] -= has_odd_seam(l, a);
  }
  if (kind != CF_STAGE_FIRST && kind != CF_STAGE_SPREAD) cf_coupled_wrap(l, l->e);
  CF_PARALLEL_COUPLED (l, v)
    for (int k = l->row[v].k; k < CF_MIN(l->row[v].k_end, end[2]); ++k)
      run_rows_to(s, number, l->row[v].j, l->row[v].j_end, k, end);
  for (int a = 0; a < l->dim && !back && sweeps; ++a) sweep_seam(l, a, colour, false);
}

/* Threads that do not follow each other must not add to the same sums: rests are put down, then added. */
static void run_in_turn(const pass *of, const bool back) {
  pass s = *of;
  for (int v = 0; v < s.count; ++v) {
    const bool sums = s.stage[v].kind == CF_STAGE_SUM;
    if (sums) s.stage[v].kind = CF_STAGE_REST;
    run_stage(&s, v, back);
    if (sums) cf_coupled_restrict(s.l, s.coarse);
  }
}

/* --- all of a list ------------------------------------------------------------------------------------ */

/* Both rows that a sum is made of are to be in one tile: tiles begin at even rows, for stages of even number. */
static void make_even(pass *s, int *height) {
  for (int v = 0; v < s->count; ++v) {
    if (s->stage[v].kind != CF_STAGE_SUM) continue;
    *height += *height % 2;
    if (v % 2 == 0 || s->count == CF_STAGES_MAX) continue;
    for (int u = s->count++; u > v; --u) s->stage[u] = s->stage[u - 1];
    s->stage[v++].kind = CF_STAGE_NONE;
  }
}

void cf_coupled_run(const cf_coupled_pass *of, const bool back) {
  pass s = *of;
  const cf_coupled *l = s.l;
  const int rows = l->high[1] - l->low[1], threads = cf_coupled_threads(l);
  for (int v = 0; v < s.count; ++v)
    if (s.stage[v].kind == CF_STAGE_SPREAD) cf_coupled_wrap(s.coarse, s.coarse->e);
  if (l->periodic[0] || l->periodic[1] || l->periodic[2]) {
    run_in_turn(&s, back);
    return;
  }
  /* e, r, 1/diagonal and couplings of a row */
  const ptrdiff_t cell = (3 + l->dim) * (ptrdiff_t)sizeof(float) + s.own_bytes;
  int height = cf_lean_height(rows, s.count, (l->high[0] - l->low[0]) * cell, threads);
  make_even(&s, &height);
  cf_lean_run(&(cf_lean){.j = l->low[1],
                         .j_end = l->high[1],
                         .k = l->low[2],
                         .k_end = l->high[2],
                         .stages = s.count,
                         .height = height,
                         .threads = threads,
                         .rows = run_rows,
                         .of = &s});
}

void cf_coupled_smooth_first(const cf_coupled *l, const float omega, const cf_band_sweeps band,
                             const bool with_rest) {
  pass s = {.l = l};
  cf_pass_add(&s, CF_STAGE_FIRST, 0, omega);
  cf_pass_add(&s, CF_STAGE_HALF, 1, omega);
  push_band(&s, band, false);
  if (with_rest) cf_pass_add(&s, CF_STAGE_REST, 0, 1);
  cf_coupled_run(&s, false);
}

void cf_coupled_smooth(const cf_coupled *l, const float omega, const cf_band_sweeps band, const int sweeps) {
  pass s = {.l = l};
  push_band(&s, band, false);
  cf_pass_add_halves(&s, 2 * sweeps, 0, omega);
  cf_coupled_run(&s, false);
}

void cf_coupled_smooth_again(const cf_coupled *l, const float omega) {
  pass s = {.l = l};
  cf_pass_add_halves(&s, 2, 0, omega);
  cf_pass_add(&s, CF_STAGE_REST, 0, 1);
  cf_coupled_run(&s, false);
}

void cf_coupled_smooth_back(const cf_coupled *l, const float omega, const cf_band_sweeps band) {
  pass s = {.l = l};
  push_band(&s, band, true);
  cf_pass_add_halves(&s, 2, 1, omega);
  cf_coupled_run(&s, true);
}
