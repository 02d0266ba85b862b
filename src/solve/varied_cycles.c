/* SPDX-License-Identifier: MIT
 *
 * Fields for coefficients where no face is closed: stationary cycles, and where the finest level does not lie apart by colour
 * (fields_cycle.c) what they are made of. One sweep through memory leads from one coarse
 * correction to the next:
 *
 *     e += interpolated correction, half sweeps on r = A e
 *     x += e,   r -= A e                       in double
 *     e = 0, half sweeps on r = A e, the coarse level's right side = sums of r - A e
 *
 * Conjugate gradients around the same cycle would save an iteration in six, and take two passes more for each. Where
 * coefficients jump or the mesh sees them very different along its axes a cycle leaves too much, and they go on from there
 * (varied_cg.c).
 *
 * x has the precision of the state, r and e are single: what is added to x is e as it is stored, and A e is formed of the
 * coefficients in double and rounded once, so that r, which is not formed anew, is the residual to within some 1e-8 of
 * what it was at the beginning. Below that it is formed again, and so it is at the end where the state is single.
 */
#include <math.h>

#include "solve/coupled_pass.h"
#include "solve/varied.h"
#include "solve/varied_row.h"

/* Half sweeps before and after the coarse correction, on the finest level and below it, where they cost little. */
#define BEFORE        2
#define AFTER         4
#define COARSE_BEFORE 2
#define COARSE_AFTER  2
#define OMEGA         1.2f
/* A cycle that leaves more is not the method for this equation; the first one, which makes a smooth residual rough, may. */
#define RATE_MOST  0.2
#define FIRST_MOST 2
/* The last cycle is taken for the last if the one before lets expect so. */
#define HOPE 0.5

/* --- rows --------------------------------------------------------------------------------------------- */

/* In the units of level 0: its equations are the caller's times `scale`, its right side is the residual times `unit`. */
typedef struct turn {
  const float *e;
  float *r;
  double scale, unit;
} turn;

/* x += e/unit scale, r -= A e. */
CF_KERNEL void advance(const int dim, const int form, const int n, const cf_varied_row *of, const turn *t) {
  const cf_varied_row o = *of;
  const float *e = t->e;
  float *r = t->r;
  const double scale = t->scale, share = t->scale / t->unit;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const double here = (double)e[i];
    double sum = (double)cf_alpha_at(form, &o, i) * here;
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) {
      const ptrdiff_t s = o.stride[a];
      sum += (double)cf_low_at(form, &o, a, i) * (here - (double)e[i - s]) -
             (double)cf_high_at(form, &o, a, i) * ((double)e[i + s] - here);
    }
    r[i] = (float)((double)r[i] - scale * sum);
    o.x[i] = (cf_real)((double)o.x[i] + share * here);
  }
}
CF_VARIED_ROWS(advance, const turn *)

/* r = b - A x. */
CF_KERNEL void begin(const int dim, const int form, const int n, const cf_varied_row *of, const turn *t) {
  const cf_varied_row o = *of;
  float *r = t->r;
  const double unit = t->unit;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    r[i] = (float)(unit * ((double)o.b[i] - cf_apply_at(dim, form, &o, i)));
  }
}
CF_VARIED_ROWS(begin, const turn *)

#define SQUARES(name, T)                                                                    \
  CF_CLONES static double name(const int n, const T *f) {                                   \
    double sum[CF_SUM_LANES] = {0};                                                         \
    int i = 0;                                                                              \
    for (; i + CF_SUM_LANES <= n; i += CF_SUM_LANES)                                        \
      for (int l = 0; l < CF_SUM_LANES; ++l) sum[l] += (double)f[i + l] * (double)f[i + l]; \
    for (int l = 0; i < n; ++i, ++l) sum[l] += (double)f[i] * (double)f[i];                 \
    return cf_sum_lanes(sum);                                                               \
  }
SQUARES(squares, cf_real)
SQUARES(squares_single, float)

/* --- passes ------------------------------------------------------------------------------------------- */

typedef cf_cycling work;

/* The place of a row's sums: the first, and a box's rows further the second. */
static double *sum_of(const cf_varied *v, const int j, const int k) {
  return &v->sums[j + (ptrdiff_t)k * v->A->grid.box.n[1]];
}

/* The squares of r and of x. */
static void keep_sums(const work *w, const int n, const int j, const int k) {
  const cf_coupled *l = &w->v->level[0];
  const ptrdiff_t p = cf_box_at(&l->box, 0, j, k);
  double *sums = sum_of(w->v, j, k);
  sums[0] = squares_single(n, l->r + p);
  sums[cf_box_rows(&l->box)] = squares(n, w->x.at + p);
}

static turn turn_of(const work *w, const ptrdiff_t p) {
  const cf_coupled *l = &w->v->level[0];
  return (turn){l->e + p, l->r + p, w->v->scale, w->unit};
}

static void begin_run(const void *of, const cf_run *run, const int j, const int k) {
  const work *w = of;
  const cf_coupled *l = &w->v->level[0];
  const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
  const turn t = turn_of(w, p);
  cf_varied_row o = cf_varied_row_of(w->v, run, j, k, w->x);
  o.b = w->b.at + p;
  begin_row(l->dim, cf_varied_form_of(w->v), run->high - run->low, &o, &t);
  keep_sums(w, run->high - run->low, j, k);
}

static void advance_run(const void *of, const cf_run *run, const int j, const int k) {
  const work *w = of;
  const cf_coupled *l = &w->v->level[0];
  const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
  const turn t = turn_of(w, p);
  const cf_varied_row o = cf_varied_row_of(w->v, run, j, k, w->x);
  advance_row(l->dim, cf_varied_form_of(w->v), run->high - run->low, &o, &t);
  keep_sums(w, run->high - run->low, j, k);
}

static void add_down(cf_coupled_pass *s, const int halves) {
  cf_pass_add(s, CF_STAGE_FIRST, 0, OMEGA);
  cf_pass_add_halves(s, halves - 1, 1, OMEGA);
  cf_pass_add(s, CF_STAGE_SUM, 0, 1);
}

static void add_up(cf_coupled_pass *s, const int halves) {
  cf_pass_add(s, CF_STAGE_SPREAD, 0, 1);
  cf_pass_add_halves(s, halves, 0, OMEGA);
}

void cf_varied_correct(const cf_varied *v, const int at) {
  const cf_coupled *l = &v->level[at];
  if (at == v->depth - 1) {
    cf_varied_cycle(v, at);
    return;
  }
  cf_coupled_pass s = {.l = l, .coarse = l + 1};
  add_down(&s, COARSE_BEFORE);
  cf_coupled_run(&s, false);
  cf_varied_correct(v, at + 1);
  s.count = 0;
  add_up(&s, 2);
  cf_pass_add(&s, CF_STAGE_SUM, 0, 1);
  cf_coupled_run(&s, false);
  cf_varied_correct(v, at + 1);
  s.count = 0;
  add_up(&s, COARSE_AFTER);
  cf_coupled_run(&s, false);
}

static double squares_of(const cf_varied *v, const cf_cell f) {
  const cf_coupled *l = &v->level[0];
  CF_PARALLEL_COUPLED (l, w)
    CF_TILE_ROWS (l, w, j, k) *sum_of(v, j, k) = squares(l->box.n[0], f.at + cf_box_at(&l->box, 0, j, k));
  return cf_varied_add_up(v, 1).first;
}

/* What x and the coefficients take of a cell's memory. */
static ptrdiff_t bytes_of(const cf_varied *v) {
  const int fields = 1 + (v->beta.at[0] != NULL ? v->level[0].dim : 0) + (v->alpha.at != NULL);
  return fields * (ptrdiff_t)sizeof(cf_real);
}

bool cf_varied_can_cycle(const cf_varied *v) { return v->apart || (v->depth > 1 && v->level[0].is_open); }

/* After a pass. */
static void take_sums(work *w) {
  const cf_varied_sums s = cf_varied_add_up(w->v, 2);
  w->rr = s.first / (w->unit * w->unit);
  w->xx = s.second;
}

static cf_coupled_pass pass_of(const work *w) {
  const cf_coupled *l = &w->v->level[0];
  return (cf_coupled_pass){.l = l, .coarse = l + 1, .of = w, .own_bytes = bytes_of(w->v)};
}

static void begin_all(work *w) {
  const cf_varied *v = w->v;
  int exponent;
  w->bb = squares_of(v, w->b);
  if (!(w->bb > 0) || !isfinite(w->bb)) return;
  (void)frexp(sqrt(w->bb / (double)cf_box_cells(&v->level[0].box)), &exponent);
  w->unit = ldexp(1, CF_MAX(-1000, CF_MIN(1000, -exponent)));
  if (!w->kept) cf_varied_copy(v, w->x, v->best);
  w->kept = true;
  cf_coupled_pass s = pass_of(w);
  cf_varied_set_ghosts(v, w->x);
  s.own = begin_run;
  cf_pass_add(&s, CF_STAGE_OWN, 0, 1);
  add_down(&s, BEFORE);
  cf_coupled_run(&s, false);
  take_sums(w);
}

static void go_down(work *w) {
  cf_coupled_pass s = pass_of(w);
  add_down(&s, BEFORE);
  cf_coupled_run(&s, false);
}

static void go_up(work *w, const bool last) {
  cf_coupled_pass s = pass_of(w);
  cf_varied_correct(w->v, 1);
  s.own = advance_run;
  add_up(&s, AFTER);
  cf_pass_add(&s, CF_STAGE_OWN, 0, 1);
  if (!last) add_down(&s, BEFORE);
  cf_coupled_run(&s, false);
  take_sums(w);
}

void cf_varied_begin(work *w) { (w->v->apart ? cf_fields_begin : begin_all)(w); }

void cf_varied_run_cycles(work *w, const int limit, int *iterations) {
  const bool apart = w->v->apart;
  double rate = 1, most = FIRST_MOST;
  while (w->rr > w->target && *iterations < limit) {
    const double before = w->rr;
    const bool last = HOPE * before * rate <= w->target;
    (apart ? cf_fields_go_up : go_up)(w, last);
    ++*iterations;
    rate = w->rr / before;
    if (!(rate <= most * most)) break;
    most = RATE_MOST;
    if (last && w->rr > w->target) (apart ? cf_fields_go_down : go_down)(w);
  }
}
