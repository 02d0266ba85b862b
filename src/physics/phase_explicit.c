/* SPDX-License-Identifier: MIT
 *
 * Explicit steps: three stages (Shu, Osher 1988), each a mean of Euler steps,
 *
 *     y1 = y + dt F(y),   y2 = 3/4 y + 1/4 (y1 + dt F(y1)),   y <- 1/3 y + 2/3 (y2 + dt F(y2)),
 *
 * or one Euler step. A stage is one pass: fluxes, driving force, phase and heat of a row while it is in the cache.
 * Heat takes K times the very rate that the phase moves with, so T - K eta is kept to round-off by any stage.
 *
 * eta below 1e-16 is 0, as far as double precision can tell eta from 1; otherwise the tail of the interface would
 * fill the box with numbers that only cost time.
 */
#include <string.h>

#include "physics/phase_part.h"

#define NOTHING ((cf_real)1e-16)

/* One stage: out = keep start + pass in + dt F(in). */
typedef struct stage {
  const cf_phase_state *start, *in, *out;
  const cf_real *W;
  double dt, weight; /* of F in this stage, and in the whole step */
  bool leaks;
  cf_real keep, pass, d;
  cf_real per_tau, per_tau_1, f, rest; /* 1/tau_eta, 1/tau_1, F, 1 - F */
  cf_real per_tau_2, f_t, rest_t, spread, latent;
} stage;

/* What a row of a stage works on; everything begins at the row's first cell. Arrays that may be missing have loops
 * of their own: a masked load from nowhere is what a processor is slowest at. */
typedef struct stage_row {
  const cf_real *R, *more, *mobility; /* what has the memory, what has not in the paper's form */
  const cf_real *start, *in, *start_m, *in_m;
  cf_real *rate, *out, *out_m;
} stage_row;

/* What of R = X + f has a memory. */
enum { PLAIN, STABLE, PAPER };

CF_KERNEL cf_real clean(const cf_real x) { return x < NOTHING && x > -NOTHING ? 0 : x; }

/* rate = eta_t; eta and r. */
CF_KERNEL void phase_loop(const int memory, const int masked, const int n, const stage *s,
                          const stage_row *w) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    cf_real rate = w->R[i];
    if (memory != PLAIN) {
      const cf_real R = rate, r = w->in_m[i], r_rate = (s->rest * R - r) * s->per_tau_1;
      w->out_m[i] = clean(s->keep * w->start_m[i] + s->pass * r + s->d * r_rate);
      rate = r + s->f * R;
      if (memory == PAPER) rate += w->more[i];
    }
    rate *= s->per_tau;
    if (masked) rate *= w->mobility[i];
    w->rate[i] = rate;
    w->out[i] = clean(s->keep * w->start[i] + s->pass * w->in[i] + s->d * rate);
  }
}

#define PHASE_ROW(memory)                                                                      \
  CF_CLONES static void phase_row_##memory(const int n, const stage *s, const stage_row *w) {  \
    phase_loop(memory, 0, n, s, w);                                                            \
  }                                                                                            \
  CF_CLONES static void masked_row_##memory(const int n, const stage *s, const stage_row *w) { \
    phase_loop(memory, 1, n, s, w);                                                            \
  }
PHASE_ROW(PLAIN)
PHASE_ROW(STABLE)
PHASE_ROW(PAPER)

typedef void phase_row(int n, const stage *s, const stage_row *w);
static phase_row *const phase_rows[3][2] = {{phase_row_PLAIN, masked_row_PLAIN},
                                            {phase_row_STABLE, masked_row_STABLE},
                                            {phase_row_PAPER, masked_row_PAPER}};

CF_CLONES static void divide_row(const int n, const cf_real *x, cf_real *y) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) y[i] /= x[i];
}

typedef struct heat_row {
  ptrdiff_t stride[3];
  const cf_real *rate; /* eta_t, a row; the others are fields */
  const cf_real *T, *start, *start_m, *in_m;
  cf_real *out, *out_m;
  const stage *s;
} heat_row;

CF_KERNEL cf_real bend_at(const int dim, const ptrdiff_t *stride, const cf_real *T, const ptrdiff_t p) {
  cf_real bend = 0;
  CF_AXIS_LOOP
  for (int a = 0; a < dim; ++a) bend += (T[p + stride[a]] - T[p]) - (T[p] - T[p - stride[a]]);
  return bend;
}

CF_KERNEL void heat_loop(const int dim, const int memory, const int n, const heat_row *w,
                         const ptrdiff_t start) {
  const stage *s = w->s;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const ptrdiff_t p = start + i;
    const cf_real spread = s->spread * bend_at(dim, w->stride, w->T, p);
    cf_real flow = spread;
    if (memory) {
      const cf_real m = w->in_m[p];
      flow = m + s->f_t * spread;
      w->out_m[p] = s->keep * w->start_m[p] + s->pass * m + s->d * ((s->rest_t * spread - m) * s->per_tau_2);
    }
    w->out[p] = s->keep * w->start[p] + s->pass * w->T[p] + s->d * (s->latent * w->rate[i] + flow);
  }
}
CF_CLONED_FORMS(heat_loop, const heat_row *, const ptrdiff_t)

/* X becomes X + f, where the row is busy; with Karma and Rappel's tau_eta, which has A^2 in it, (X + f)/A^2. */
static void react(const cf_phase *p, cf_phase_rows *rows, const stage *s, const ptrdiff_t start) {
  const int from = rows->busy.from, n = rows->busy.to - from;
  cf_phase_react f = cf_phase_react_of(p, rows, n, s->in->eta.at, start + from);
  f.T = s->in->T.at + start + from;
  cf_phase_react_row(n, &f);
  cf_phase_add_row(n, 1, rows->react, rows->div + from);
  if (!p->p.karma_rappel) return;
  cf_phase_A2_row(p, n, s->in->eta.at, start + from, rows->A2);
  divide_row(n, rows->A2, rows->div + from);
}

static void phase_of_row(const cf_phase *p, cf_phase_rows *rows, const stage *s, const ptrdiff_t start) {
  const int memory = !p->has_r ? PLAIN : p->p.form == CF_PHASE_PAPER ? PAPER : STABLE;
  stage_row w = {.R = rows->div, .rate = rows->rate, .more = rows->div};
  w.start = s->start->eta.at + start, w.in = s->in->eta.at + start, w.out = s->out->eta.at + start;
  if (p->has_r)
    w.start_m = s->start->r.at + start, w.in_m = s->in->r.at + start, w.out_m = s->out->r.at + start;
  if (memory == PAPER) w.R = p->X.at + start; /* div is X - X_1 + f */
  if (p->places.mobility.at != NULL) w.mobility = p->places.mobility.at + start;
  phase_rows[memory][w.mobility != NULL](p->grid->box.n[0], s, &w);
}

static void visit(const cf_phase *p, cf_phase_rows *rows, const ptrdiff_t start, const ptrdiff_t r,
                  void *context) {
  const stage *s = context;
  const cf_box *box = &p->grid->box;
  if (rows->busy.from < rows->busy.to) react(p, rows, s, start);
  phase_of_row(p, rows, s, start);
  cf_phase_note_filled(p, r, s->out->eta.at + start);
  const heat_row heat = {{box->stride[0], box->stride[1], box->stride[2]},
                         rows->rate,
                         s->in->T.at,
                         s->start->T.at,
                         s->start->w.at,
                         s->in->w.at,
                         s->out->T.at,
                         s->out->w.at,
                         s};
  heat_loop_by_form(box->dim, p->has_w, box->n[0], &heat, start);
  if (s->W != NULL) cf_phase_add_row(box->n[0], s->d, s->W + start, s->out->T.at + start);
}

static void keep_X_1(const cf_phase *p, cf_phase_rows *rows, const ptrdiff_t start, const ptrdiff_t r,
                     void *context) {
  (void)r, (void)context;
  memcpy(p->X.at + start, rows->div, (size_t)p->grid->box.n[0] * sizeof *rows->div);
}

/* --- what comes in through walls -------------------------------------------------------------------------- */

static double integral(const cf_phase *p, const cf_cell f) {
  return cf_sweep_sum(&p->grid->box, p->grid->threads, f.at, p->sums) * cf_grid_volume(p->grid);
}

/* Rate at which the integral of T grows through held walls, and by what a flow took of w. */
static double through_walls(const cf_phase *p, const cf_phase_state *y, const bool leaks) {
  const cf_box *box = &p->grid->box;
  double sum = 0;
  bool any = false;
  for (int a = 0; a < box->dim; ++a)
    for (int side = 0; side < 2; ++side) {
      if (p->T_walls.at[a][side] == NULL) continue;
      const cf_wall_side w = cf_wall_side_of(box, a, side);
      any = true;
      for (int i_c = 0; i_c < w.n_c; ++i_c)
        for (int i_b = 0; i_b < w.n_b; ++i_b) {
          const ptrdiff_t q = cf_wall_cell(box, &w, i_b, i_c);
          sum += (double)(y->T.at[q + w.outward] - y->T.at[q]);
        }
    }
  if (!any) return leaks && p->has_w ? integral(p, y->w) : 0;
  const double now = sum * p->p.D / (p->grid->h * p->grid->h) * cf_grid_volume(p->grid);
  return p->has_w ? integral(p, y->w) + p->p.f_t * now : now;
}

/* --- a step ----------------------------------------------------------------------------------------------- */

static void run_stage(cf_phase *p, const double t, const double keep, stage *s, double *heat_in) {
  const cf_phase_params *q = &p->p;
  s->keep = (cf_real)keep;
  s->pass = (cf_real)(1 - keep);
  s->d = (cf_real)s->dt;
  s->per_tau = (cf_real)(1 / q->tau_eta);
  s->per_tau_1 = (cf_real)(q->tau_1 > 0 ? 1 / q->tau_1 : 0);
  s->per_tau_2 = (cf_real)(q->tau_2 > 0 ? 1 / q->tau_2 : 0);
  s->f = (cf_real)q->f_eta, s->rest = (cf_real)(1 - q->f_eta);
  s->f_t = (cf_real)q->f_t, s->rest_t = (cf_real)(1 - q->f_t);
  s->spread = (cf_real)(q->D / (p->grid->h * p->grid->h));
  s->latent = (cf_real)q->latent;
  cf_wall_values_sample(&p->eta_walls, t);
  cf_wall_values_sample(&p->T_walls, t);
  cf_phase_ghosts(p, s->in->eta);
  cf_wall_ghosts(&p->T_walls, s->in->T);
  const double rate = through_walls(p, s->in, s->leaks);
  if (heat_in != NULL) *heat_in += s->weight * rate;
  const bool paper = q->form == CF_PHASE_PAPER && p->has_r; /* without a memory the forms are one */
  if (paper) cf_phase_each_row(p, CF_PHASE_X_1, s->in->eta, keep_X_1, NULL);
  cf_phase_each_row(p, paper ? CF_PHASE_X_2 : CF_PHASE_X, s->in->eta, visit, s);
  cf_span *const spans = p->filled;
  p->filled = p->next_filled;
  p->next_filled = spans;
  p->known_of = s->out->eta.at;
}

static void three_stages(cf_phase *p, const double t, const double dt, const cf_phase_explicit *how,
                         const cf_phase_state *y, double *heat_in) {
  const cf_real *W = how->W.at;
  const cf_phase_state *a = &p->stage[0], *b = &p->stage[1];
  run_stage(p, t, 0,
            &(stage){.start = y, .in = y, .out = a, .W = W, .leaks = how->leaks, .dt = dt, .weight = dt / 6},
            heat_in);
  run_stage(
      p, t + dt, 0.75,
      &(stage){.start = y, .in = a, .out = b, .W = W, .leaks = how->leaks, .dt = dt / 4, .weight = dt / 6},
      heat_in);
  run_stage(
      p, t + dt / 2, 1.0 / 3,
      &(stage){
          .start = y, .in = b, .out = y, .W = W, .leaks = how->leaks, .dt = 2 * dt / 3, .weight = 2 * dt / 3},
      heat_in);
}

static void copy_cell(const cf_phase *p, const cf_cell from, const cf_cell to) {
  const cf_box *box = &p->grid->box;
  if (from.at == NULL) return;
  CF_PARALLEL_ROWS (box, p->grid->threads, r)
    memcpy(to.at + cf_box_row(box, r), from.at + cf_box_row(box, r), (size_t)box->n[0] * sizeof *from.at);
}

cf_status cf_phase_step_explicit(cf_phase *p, const double t, const double dt, const cf_phase_explicit *how,
                                 const cf_phase_state *y, double *heat_in) {
  if (how->substeps < 1) return cf_fail(CF_BAD_ARGUMENT, "%d substeps: must be at least 1", how->substeps);
  const double sub = dt / how->substeps;
  p->known_of = NULL; /* anything may have moved eta since the last step */
  const cf_phase_state *now = y, *next = &p->stage[0];
  for (int i = 0; i < how->substeps; ++i) {
    if (how->order == 3) {
      three_stages(p, t + i * sub, sub, how, y, heat_in);
      continue;
    }
    stage s = {
        .start = now, .in = now, .out = next, .W = how->W.at, .leaks = how->leaks, .dt = sub, .weight = sub};
    run_stage(p, t + i * sub, 0, &s, heat_in);
    const cf_phase_state *done = next;
    next = now;
    now = done;
  }
  p->known_of = NULL;
  if (now == y) return CF_OK;
  copy_cell(p, now->eta, y->eta);
  copy_cell(p, now->r, y->r);
  copy_cell(p, now->T, y->T);
  copy_cell(p, now->w, y->w);
  return CF_OK;
}
