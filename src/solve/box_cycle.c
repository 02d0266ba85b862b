/* SPDX-License-Identifier: MIT
 *
 * The cycle over split levels, as passes.
 *
 * The first part of a cycle (half sweeps on e = 0, restriction) is done in the pass that made its residual, and
 * the second part (prolongation, half sweeps) begins the pass that takes the correction. Where the next
 * residual is expected to be small enough the pass ends there.
 */
#include <math.h>

#include "grid/sweep.h"
#include "solve/box_part.h"
#include "solve/pcg.h"

/* Half sweeps leave this much of the error on a coarsest level that is no line. */
#define COARSEST_GAIN 0.02
/* Sweeps after the coarse correction on levels below the finest, where they cost little: in a V-cycle, with three in place of
 * one 5 cycles do what 6 did; in a W-cycle. */
#define COARSE_SWEEPS_V 3
#define COARSE_SWEEPS_W 2
/* Sweeps over rows at edges after the coarse correction, over-relaxed. */
#define EDGE_SWEEPS 2
#define EDGE_OMEGA  1.35
/* A pass of half sweeps alone gains at most this, and has at most so many of them. */
#define PASS_GAIN   1e-7
#define PASS_SWEEPS 32
/* A step is at least this, and at most its inverse. */
#define LEAST_STEP 0.4
/* The residual may grow so much at first. It grows more where coarse levels are far wrong about something: a neck that they
 * do not know of. */
#define MOST_GROWTH 2

/* --- passes ------------------------------------------------------------------------------------------- */

/* After FIRST, or where that does not do: the half sweeps before the coarse correction. */
static void push_start(cf_pass *p) {
  if (p->at->odd_seam) {
    cf_pass_push(p, CF_PASS_CLEAR, 0);
    cf_pass_push(p, CF_PASS_RED, 0);
    cf_pass_push(p, CF_PASS_BLACK, 0);
  } else {
    cf_pass_push(p, CF_PASS_SECOND, 0);
  }
}

/* The last black half sweep, and taking the correction. */
static void push_end(cf_pass *p, const double omega_last, const double omega_first) {
  if (p->at->odd_seam) {
    cf_pass_push(p, CF_PASS_BLACK, omega_last);
    cf_pass_push(p, CF_PASS_RESIDUAL, 0);
  } else {
    cf_pass_push(p, CF_PASS_LAST, omega_last);
  }
  cf_pass_push(p, CF_PASS_UPDATE, omega_first);
}

/* Half sweeps over-relaxed so that `count` of them in a row, red first, damp all errors alike; the first is FIRST. */
static void push_half_sweeps(cf_pass *p, const double jacobi, const int count, const bool finest) {
  const double j2 = jacobi * jacobi;
  if (p->at->odd_seam) cf_pass_push(p, CF_PASS_CLEAR, 0);
  double omega = 1;
  for (int v = 0; v < count; ++v) {
    if (p->at->odd_seam)
      omega = 1; /* neighbours of one colour: no such theory */
    else if (v > 0)
      omega = cf_omega_after(v, j2, omega);
    if (v == count - 1 && finest)
      push_end(p, omega, 1);
    else if (v == 1 && !p->at->odd_seam)
      cf_pass_push(p, CF_PASS_SECOND, omega);
    else if (v > 1 || p->at->odd_seam)
      cf_pass_push(p, v % 2 == 0 ? CF_PASS_RED : CF_PASS_BLACK, omega);
  }
}

/* An even number of half sweeps that gain so much, at least 4. */
static int half_sweeps_for(const double jacobi, const double gain) {
  const double root = sqrt(1 - jacobi * jacobi), per_sweep = jacobi / (1 + root);
  const int count = per_sweep > 0 ? (int)ceil(log(gain / 2) / log(per_sweep)) : 4;
  return CF_MIN(CF_MAX((count + 1) / 2 * 2, 4), PASS_SWEEPS);
}

static cf_pass pass_on(const cf_box_solver *f, const int l) {
  const bool last = l + 1 >= f->depth, around = f->varied != NULL;
  return (cf_pass){.at = &f->level[l],
                   .coarse = last || around ? NULL : &f->level[l + 1],
                   .below = last || !around ? NULL : &f->varied->level[l + 1]};
}

static cf_pass pass_on_finest(const cf_box_solver *f, const cf_cell b, const cf_cell x) {
  cf_pass p = pass_on(f, 0);
  p.x = x.at;
  p.b = b.at;
  p.alpha = f->alpha;
  p.beta = f->beta;
  p.sums = f->sums;
  p.rows = f->rows;
  return p;
}

/* --- the cycle below the finest level ------------------------------------------------------------------ */

/* Elimination, through the plain level's fields. */
static void solve_coarsest(const cf_box_solver *f) {
  const cf_split *s = &f->level[f->depth - 1];
  const cf_level plain = cf_box_coarsest(f);
  for (int k = 0; k < s->n[2]; ++k)
    for (int j = 0; j < s->n[1]; ++j)
      for (int i = 0; i < s->n[0]; ++i)
        plain.b.at[cf_box_at(&plain.box, i, j, k)] =
            (cf_real)(f->scale * (double)s->r[j * s->row + k * s->plane + cf_split_at(s, i)]);
  if (cf_level_is_line(&plain))
    cf_level_solve_line(&plain, plain.b, f->line, plain.x);
  else
    cf_direct_solve(&plain, &f->direct, plain.b, plain.x);
  if (f->lost) cf_level_remove_mean(&plain, plain.x);
  for (int k = 0; k < s->n[2]; ++k)
    for (int j = 0; j < s->n[1]; ++j)
      for (int i = 0; i < s->n[0]; ++i)
        s->e[j * s->row + k * s->plane + cf_split_at(s, i)] =
            (float)plain.x.at[cf_box_at(&plain.box, i, j, k)];
}

/* The same below segments. */
static void correct_around(const cf_box_solver *f) {
  cf_box_gather_odds(f);
  cf_varied_cycle(f->varied, 1);
  cf_coupled_wrap(&f->varied->level[1], f->varied->level[1].e);
  cf_box_spread_odds(f);
}

static void correct(const cf_box_solver *f, int l);

/* The same, with the ghosts that interpolation reads, where the stages have not set them. */
static void correct_from(const cf_box_solver *f, const int l) {
  const cf_split *s = &f->level[l];
  correct(f, l);
  if (cf_split_needs_ghosts(s) || cf_level_is_solved_directly(s->plain)) cf_split_fill_seams(s, s->e);
}

/* e from r on level l, whose first half sweep is done. */
static void correct(const cf_box_solver *f, const int l) {
  if (cf_level_is_solved_directly(f->level[l].plain)) {
    solve_coarsest(f);
    return;
  }
  cf_pass down = pass_on(f, l), again = down, up = down;
  if (l == f->depth - 1) {
    push_half_sweeps(&down, f->jacobi, half_sweeps_for(f->jacobi, COARSEST_GAIN), false);
    cf_wave_run(&f->wave, &down);
    return;
  }
  push_start(&down);
  cf_pass_push(&down, CF_PASS_RESTRICT, 0);
  cf_wave_run(&f->wave, &down);
  correct_from(f, l + 1);
  /* The finest level's cycle gains so much that the coarse correction must be as good: a W-cycle. */
  if (!cf_level_is_solved_directly(f->level[l + 1].plain) && f->thorough) {
    cf_pass_push(&again, CF_PASS_PROLONG, 0);
    cf_pass_push(&again, CF_PASS_RED, 0);
    cf_pass_push(&again, CF_PASS_BLACK, 1);
    cf_pass_push(&again, CF_PASS_RESTRICT_RED, 0);
    cf_wave_run(&f->wave, &again);
    correct_from(f, l + 1);
  }
  cf_pass_push(&up, CF_PASS_PROLONG, 0);
  for (int v = 0; v < (f->thorough ? COARSE_SWEEPS_W : COARSE_SWEEPS_V); ++v) {
    cf_pass_push(&up, CF_PASS_RED, 0);
    cf_pass_push(&up, CF_PASS_BLACK, 0);
  }
  cf_wave_run(&f->wave, &up);
}

/* --- passes over the finest level ---------------------------------------------------------------------- */

/* The half sweeps before the coarse correction, of which FIRST, at the end of the pass before, has done one. */
static void push_first_part(const cf_box_solver *f, cf_pass *p) {
  if (!f->thorough) {
    push_start(p);
    if (f->depth > 1) cf_pass_push(p, CF_PASS_RESTRICT, 0);
    return;
  }
  cf_pass_push(p, CF_PASS_SECOND, f->omega[1]);
  cf_pass_push(p, CF_PASS_RED, f->omega[2]);
  cf_pass_push(p, CF_PASS_BLACK, f->omega[3]);
  cf_pass_push(p, CF_PASS_RESTRICT_RED, 0);
}

/* Those after it, and taking the correction. */
static void push_second_part(const cf_box_solver *f, cf_pass *p) {
  cf_pass_push(p, CF_PASS_PROLONG, 0);
  if (!f->thorough) {
    cf_pass_push(p, CF_PASS_RED, 0);
    push_end(p, 0, 0);
    return;
  }
  if (f->varied != NULL) /* near walls the correction is not as good as elsewhere */
    for (int v = 0; v < EDGE_SWEEPS; ++v) {
      cf_pass_push(p, CF_PASS_RED_EDGES, EDGE_OMEGA);
      cf_pass_push(p, CF_PASS_BLACK_EDGES, EDGE_OMEGA);
    }
  cf_pass_push(p, CF_PASS_RED, f->omega[4]);
  cf_pass_push(p, CF_PASS_BLACK, f->omega[5]);
  cf_pass_push(p, CF_PASS_RED, f->omega[6]);
  push_end(p, f->omega[7], f->omega[0]);
}

static double sum_of(const cf_box_solver *f, const cf_pass_sum kind) {
  return cf_sum_ordered(f->rows + kind * f->sums, f->sums);
}

static void take_form_sums(const cf_box_solver *f, cf_box_iteration *it) {
  it->rr = sum_of(f, CF_SUM_RESIDUAL);
  it->bb = sum_of(f, CF_SUM_B2);
  it->xx = sum_of(f, CF_SUM_X2);
  it->b_sum = sum_of(f, CF_SUM_B);
  it->x_sum = sum_of(f, CF_SUM_X);
  it->start = it->rr;
}

/* How much of the next correction to take: what would have been best this time, with which the method is that of Barzilai
 * and Borwein (1988). With A e for what the cycle made of r:  step = r . A e / A e . A e. */
static void choose_step(const cf_box_solver *f, const double before, cf_box_iteration *it) {
  const double product = (sum_of(f, CF_SUM_BLACK) + sum_of(f, CF_SUM_RED)) * it->scale * it->scale;
  const double change = before - 2 * product + it->rr;
  const double best = change > 0 ? it->step * (before - product) / change : it->step;
  it->overshoots = it->rate > MOST_GROWTH;
  it->step = CF_MAX(LEAST_STEP, CF_MIN(best, 1 / LEAST_STEP));
}

/* The last step of every pass that corrects x. */
static void run_update(const cf_box_solver *f, cf_pass *p, cf_box_iteration *it) {
  const double before = it->rr;
  p->step = it->step;
  p->gain = it->step * it->scale / f->scale;
  p->lift = it->lift;
  p->sums_of_x = f->singular;
  cf_wave_run(&f->wave, p);
  it->lifted = CF_MAX(it->lifted, fabs(it->lift));
  it->lift = 0;
  it->rr = sum_of(f, CF_SUM_RESIDUAL) * it->scale * it->scale;
  it->rate = sqrt(it->rr / before);
  if (f->varied != NULL && f->depth > 1) choose_step(f, before, it);
  if (!p->sums_of_x) return;
  it->x_sum = sum_of(f, CF_SUM_X);
  it->xx = sum_of(f, CF_SUM_X2);
}

void cf_box_form(const cf_box_solver *f, const cf_helmholtz *A, const cf_cell b, const cf_cell x,
                 cf_box_iteration *it) {
  if (f->varied == NULL)
    cf_halo_fill(&A->grid.box, &A->outside, 1, -1, x.at);
  else if (f->level[0].has_seam) /* no other ghosts are looked at */
    cf_varied_set_ghosts(f->varied, x);
  cf_pass p = pass_on_finest(f, b, x);
  p.scale = it->scale;
  p.shift = it->shift;
  cf_pass_push(&p, CF_PASS_FORM, f->depth == 1 ? 1 : f->thorough ? f->omega[0] : 0);
  if (f->depth > 1) push_first_part(f, &p);
  cf_wave_run(&f->wave, &p);
  take_form_sums(f, it);
  it->ready = true;
}

void cf_box_cycle(const cf_box_solver *f, const cf_cell b, const cf_cell x, const bool last,
                  cf_box_iteration *it) {
  cf_pass p = pass_on_finest(f, b, x);
  if (!it->ready) {
    cf_pass first = p;
    push_first_part(f, &first);
    cf_wave_run(&f->wave, &first);
  }
  if (f->varied != NULL) {
    correct_around(f);
  } else {
    correct_from(f, 1);
  }
  push_second_part(f, &p);
  if (!last) push_first_part(f, &p);
  run_update(f, &p, it);
  it->ready = !last;
}

void cf_box_sweeps(const cf_box_solver *f, const cf_cell b, const cf_cell x, const double gain,
                   cf_box_iteration *it) {
  cf_pass p = pass_on_finest(f, b, x);
  push_half_sweeps(&p, f->jacobi, half_sweeps_for(f->jacobi, CF_MAX(gain, PASS_GAIN)), true);
  run_update(f, &p, it);
}
