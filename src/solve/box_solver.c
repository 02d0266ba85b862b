/* SPDX-License-Identifier: MIT
 *
 * The cycle over split levels, and the iteration around it.
 *
 * The first part of a V-cycle (half sweeps on e = 0, restriction) is done in the pass that made its residual, and
 * the second part (prolongation, half sweeps) begins the pass that takes the correction. Where the next
 * residual is expected to be small enough the pass ends there.
 */
#include "solve/box_solver.h"

#include <float.h>
#include <math.h>

#include "base/mem.h"
#include "grid/sweep.h"
#include "solve/direct.h"
#include "solve/multigrid.h"
#include "solve/pcg.h"
#include "solve/wave.h"

/* Half sweeps leave this much of the error on a coarsest level that is no line. */
#define COARSEST_GAIN 0.02
/* Sweeps after the coarse correction on levels below the finest. They cost little there, and with three in place of
 * one 5 cycles do what 6 did. */
#define COARSE_SWEEPS 3
/* Over-relaxation of the finest level over that of the others. */
#define FINEST_OVER 0.85
/* Up to this stiffness half sweeps alone are fewer operations, and fewer passes over memory, than cycles with coarse
 * levels: 32 of them, in one pass, do what 5 or 6 cycles do. */
#define SWEEPS_ENOUGH 10
/* A pass of half sweeps alone gains at most this, and has at most so many of them. */
#define PASS_GAIN   1e-7
#define PASS_SWEEPS 32
/* What rounding leaves of the residual that a recursion started from; a new start is due well before. */
#define RECURSION_FLOOR 5e-7
#define RECURSION_TURN  2e-5
/* A cycle that leaves more than this of the residual, so many times in a row: not a case for this path. */
#define SLOW       0.5
#define SLOW_TIMES 3
/* Above this stiffness the mean of x is computed from the mean of b, where no wall is held. */
#define MEAN_APART 1e4
/* Above this one the constant is out of a direct solution's sight. */
#define MEAN_LOST 1e10

struct cf_box_solver {
  int levels, depth;
  cf_split level[CF_LEVELS_MAX];
  cf_wave wave;
  cf_direct direct; /* where the coarsest level has few cells */
  double *line;     /* where it is a line: work */
  double *rows;
  ptrdiff_t sums;
  double alpha, beta, scale; /* scale: the diagonal in the middle of the finest level */
  double jacobi;             /* spectral radius of Jacobi's iteration on the coarsest level */
  bool singular, lost;       /* no alpha at all; next to none */
  bool free_mean;            /* no wall is held, and alpha is small or 0 */
};

/* --- making ------------------------------------------------------------------------------------------- */

void cf_box_solver_destroy(cf_box_solver *f) {
  if (f == NULL) return;
  for (int l = 0; l < f->levels; ++l) cf_split_destroy(&f->level[l]);
  cf_wave_destroy(&f->wave);
  cf_direct_destroy(&f->direct);
  cf_free(f->line);
  cf_free(f->rows);
  cf_free(f);
}

static cf_status levels_create(cf_box_solver *f, const cf_helmholtz *A) {
  for (int l = 0; l < A->levels; ++l) {
    f->levels = l + 1; /* counted first, so that a failure within frees it */
    CF_TRY(cf_split_create(&f->level[l], &A->level[l]));
  }
  const cf_split *finest = &f->level[0];
  CF_TRY(cf_wave_create(&f->wave, finest));
  CF_TRY(cf_direct_create(&f->direct));
  CF_TRY(CF_NEW(&f->line, 5 * CF_MAX(finest->n[0], CF_MAX(finest->n[1], finest->n[2]))));
  f->sums = (ptrdiff_t)finest->n[1] * finest->n[2] * cf_wave_pieces(finest);
  return CF_NEW(&f->rows, 3 * f->sums);
}

cf_status cf_box_solver_create(cf_box_solver **f, const cf_helmholtz *A) {
  *f = NULL;
  cf_box_solver *fresh;
  CF_TRY(CF_NEW(&fresh, 1));
  const cf_status s = levels_create(fresh, A);
  if (s != CF_OK) {
    cf_box_solver_destroy(fresh);
    return s;
  }
  *f = fresh;
  return CF_OK;
}

static bool solved_directly(const cf_level *l) { return cf_level_is_line(l) || cf_level_is_few(l); }

/* The level as the direct solution takes it: without an alpha too small to be seen beside beta. */
static cf_level coarsest_plain(const cf_box_solver *f) {
  cf_level l = *f->level[f->depth - 1].plain;
  if (f->lost) l.alpha = 0;
  return l;
}

/* Levels to use: the finest alone where half sweeps do. */
static int depth_for(const cf_helmholtz *A) {
  return cf_level_stiffness(&A->level[0]) <= SWEEPS_ENOUGH ? 1 : A->depth;
}

/* Whether single precision can do this at all, half sweeps of one colour are independent on the finest level, and
 * levels go far enough. */
static bool is_suitable(const cf_box_solver *f, const cf_level *finest, const cf_level *coarsest) {
  if (solved_directly(finest) || f->level[0].odd_seam) return false;
  if (!(f->scale > 0) || !(f->scale < 1e100)) return false;
  /* The direct solution takes cf_real. */
  if (sizeof(cf_real) == sizeof(float) && f->scale > 1e30) return false;
  return solved_directly(coarsest) ||
         cf_level_stiffness(coarsest) <= (f->depth == 1 ? SWEEPS_ENOUGH : CF_STIFF_ENOUGH);
}

/* 1 + (share of diffusion in the diagonal)^2 / 5, a little less on the finest level, was best at 1e-6. */
static void choose_omega(const cf_level *l, const bool finest, const bool half_sweeps_only, double omega[4]) {
  const double over = (double)cf_level_relaxation(l) - 1;
  for (int v = 0; v < 4; ++v) omega[v] = half_sweeps_only ? 1 : 1 + (finest ? FINEST_OVER : 1) * over;
}

bool cf_box_solver_set(cf_box_solver *f, const cf_helmholtz *A) {
  f->depth = depth_for(A);
  const cf_level *finest = &A->level[0], *coarsest = &A->level[f->depth - 1];
  const double h = A->grid.h, stiffness = cf_level_stiffness(coarsest);
  f->alpha = finest->alpha;
  f->beta = A->beta;
  f->scale = f->alpha + 2 * A->grid.box.dim * f->beta / (h * h);
  if (!is_suitable(f, finest, coarsest)) return false;
  f->jacobi = stiffness / (1 + stiffness);
  f->singular = A->singular;
  f->free_mean = !A->has_held_wall && cf_level_stiffness(finest) > MEAN_APART;
  f->lost = f->singular || (f->free_mean && cf_level_stiffness(finest) > MEAN_LOST);
  for (int l = 0; l < f->depth; ++l) {
    const bool half_sweeps_only = l == f->depth - 1 && !solved_directly(coarsest);
    double omega[4];
    choose_omega(&A->level[l], l == 0, half_sweeps_only, omega);
    cf_split_set(&f->level[l], f->alpha, f->beta, f->scale, omega);
  }
  const cf_level plain = coarsest_plain(f);
  if (cf_level_is_few(&plain)) cf_direct_factor(&plain, &f->direct);
  return true;
}

const char *cf_box_solver_method(const cf_box_solver *f) { return f->depth == 1 ? "sor" : "multigrid"; }

/* --- passes ------------------------------------------------------------------------------------------- */

static void push(cf_pass *p, const cf_pass_stage stage, const double omega) {
  p->omega[p->count] = (float)omega;
  p->stage[p->count++] = stage;
}

/* After FIRST, or where that does not do: the half sweeps before the coarse correction. */
static void push_start(cf_pass *p) {
  if (p->at->odd_seam) {
    push(p, CF_PASS_CLEAR, 0);
    push(p, CF_PASS_RED, 0);
    push(p, CF_PASS_BLACK, 0);
  } else {
    push(p, CF_PASS_SECOND, 0);
  }
}

/* The last black half sweep, and taking the correction. */
static void push_end(cf_pass *p, const double omega_last, const double omega_first) {
  if (p->at->odd_seam) {
    push(p, CF_PASS_BLACK, omega_last);
    push(p, CF_PASS_RESIDUAL, 0);
  } else {
    push(p, CF_PASS_LAST, omega_last);
  }
  push(p, CF_PASS_UPDATE, omega_first);
}

/* Half sweeps over-relaxed so that `count` of them in a row, red first, damp all errors alike; the first is FIRST. */
static void push_half_sweeps(cf_pass *p, const double jacobi, const int count, const bool finest) {
  const double j2 = jacobi * jacobi;
  if (p->at->odd_seam) push(p, CF_PASS_CLEAR, 0);
  double omega = 1;
  for (int v = 0; v < count; ++v) {
    if (p->at->odd_seam)
      omega = 1; /* neighbours of one colour: no such theory */
    else if (v > 0)
      omega = v == 1 ? 1 / (1 - j2 / 2) : 1 / (1 - j2 * omega / 4);
    if (v == count - 1 && finest)
      push_end(p, omega, 1);
    else if (v == 1 && !p->at->odd_seam)
      push(p, CF_PASS_SECOND, omega);
    else if (v > 1 || p->at->odd_seam)
      push(p, v % 2 == 0 ? CF_PASS_RED : CF_PASS_BLACK, omega);
  }
}

/* An even number of half sweeps that gain so much, at least 4. */
static int half_sweeps_for(const double jacobi, const double gain) {
  const double root = sqrt(1 - jacobi * jacobi), per_sweep = jacobi / (1 + root);
  const int count = per_sweep > 0 ? (int)ceil(log(gain / 2) / log(per_sweep)) : 4;
  return CF_MIN(CF_MAX((count + 1) / 2 * 2, 4), PASS_SWEEPS);
}

static cf_pass pass_on(const cf_box_solver *f, const int l) {
  return (cf_pass){.at = &f->level[l], .coarse = l + 1 < f->depth ? &f->level[l + 1] : NULL};
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
  const cf_level plain = coarsest_plain(f);
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

/* e from r on level l, whose first half sweep is done. */
static void correct(const cf_box_solver *f, const int l) {
  if (solved_directly(f->level[l].plain)) {
    solve_coarsest(f);
    return;
  }
  cf_pass down = pass_on(f, l), up = down;
  if (l == f->depth - 1) {
    push_half_sweeps(&down, f->jacobi, half_sweeps_for(f->jacobi, COARSEST_GAIN), false);
    cf_wave_run(&f->wave, &down);
    return;
  }
  push_start(&down);
  push(&down, CF_PASS_RESTRICT, 0);
  cf_wave_run(&f->wave, &down);
  correct(f, l + 1);
  cf_split_fill_seams(down.coarse, down.coarse->e);
  push(&up, CF_PASS_PROLONG, 0);
  for (int v = 0; v < COARSE_SWEEPS; ++v) {
    push(&up, CF_PASS_RED, 0);
    push(&up, CF_PASS_BLACK, 0);
  }
  cf_wave_run(&f->wave, &up);
}

/* --- the iteration ------------------------------------------------------------------------------------ */

typedef struct iteration {
  double scale;       /* of r, a power of two */
  double bb, xx, rr;  /* squares */
  double start;       /* rr where the recursion began */
  double rate;        /* of |r| in the latest cycle */
  double shift, lift; /* of the mean, in the first pass */
  bool ready;         /* the first part of the next cycle is done */
} iteration;

/* A power of two near v, at which floats are at home. */
static double near_power(const double v) {
  if (!(v > 0) || !isfinite(v)) return 1;
  int exponent;
  (void)frexp(v, &exponent);
  return ldexp(1, exponent);
}

/* The largest value among a few rows: enough to choose a scale. */
static double sample_scale(const cf_box_solver *f, const cf_cell b, const cf_cell x) {
  const cf_box *box = &f->level[0].plain->box;
  const ptrdiff_t rows = cf_box_rows(box), step = CF_MAX(rows / 61, 1);
  double largest = 0;
  for (ptrdiff_t r = 0; r < rows; r += step)
    for (int i = 0; i < box->n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(box, r) + i;
      largest = CF_MAX(largest, CF_MAX(fabs((double)b.at[p]), f->scale * fabs((double)x.at[p])));
    }
  return largest;
}

static double scale_for(const cf_box_solver *f, const cf_level *l, const cf_cell b, const cf_cell x) {
  double size = sample_scale(f, b, x);
  if (!(size > 1e-15 && size < 1e15))
    size = sqrt((cf_level_dot(l, b, b) + f->scale * f->scale * cf_level_dot(l, x, x)) /
                (double)cf_box_cells(&l->box));
  return near_power(size);
}

static void push_first_part(const cf_box_solver *f, cf_pass *p) {
  push_start(p);
  if (f->depth > 1) push(p, CF_PASS_RESTRICT, 0);
}

static void take_form_sums(const cf_box_solver *f, iteration *it) {
  it->rr = cf_sum_ordered(f->rows, f->sums);
  it->bb = cf_sum_ordered(f->rows + f->sums, f->sums);
  it->xx = cf_sum_ordered(f->rows + 2 * f->sums, f->sums);
  it->start = it->rr;
}

static void take_update_sum(const cf_box_solver *f, iteration *it) {
  const double before = it->rr;
  it->rr = cf_sum_ordered(f->rows, f->sums) * it->scale * it->scale;
  it->rate = sqrt(it->rr / before);
}

/* r = b - A x, and the first part of a cycle. */
static void form(const cf_box_solver *f, const cf_helmholtz *A, const cf_cell b, const cf_cell x,
                 iteration *it) {
  cf_halo_fill(&A->grid.box, &A->outside, 1, -1, x.at);
  cf_pass p = pass_on_finest(f, b, x);
  p.scale = it->scale;
  p.shift = it->shift;
  push(&p, CF_PASS_FORM, f->depth > 1 ? 0 : 1);
  if (f->depth > 1) push_first_part(f, &p);
  cf_wave_run(&f->wave, &p);
  take_form_sums(f, it);
  it->ready = true;
}

/* One V-cycle; `last`: the first part of the next one is left away. */
static void cycle(const cf_box_solver *f, const cf_cell b, const cf_cell x, const bool last, iteration *it) {
  cf_pass p = pass_on_finest(f, b, x);
  if (!it->ready) {
    cf_pass first = p;
    push_first_part(f, &first);
    cf_wave_run(&f->wave, &first);
  }
  correct(f, 1);
  cf_split_fill_seams(p.coarse, p.coarse->e);
  p.gain = it->scale / f->scale;
  push(&p, CF_PASS_PROLONG, 0);
  push(&p, CF_PASS_RED, 0);
  push_end(&p, 0, 0);
  if (!last) push_first_part(f, &p);
  cf_wave_run(&f->wave, &p);
  it->ready = !last;
  take_update_sum(f, it);
}

/* One pass of half sweeps that is to gain so much. */
static void sweep_pass(const cf_box_solver *f, const cf_cell b, const cf_cell x, const double gain,
                       iteration *it) {
  cf_pass p = pass_on_finest(f, b, x);
  p.gain = it->scale / f->scale;
  push_half_sweeps(&p, f->jacobi, half_sweeps_for(f->jacobi, CF_MAX(gain, PASS_GAIN)), true);
  cf_wave_run(&f->wave, &p);
  take_update_sum(f, it);
}

/* Where rounding of x itself is all that b - A x shows. */
static double floor_of(const cf_box_solver *f, const iteration *it) {
  const double size = CF_REAL_EPSILON * f->scale;
  return size * size * it->xx;
}

/* The mean of x that b asks for, where alpha is too small for cycles to find it: x comes closer by `lift`. */
static void set_mean(const cf_box_solver *f, const cf_level *l, const cf_cell b, const cf_cell x,
                     iteration *it) {
  if (!f->free_mean || f->singular) return;
  const double cells = (double)cf_box_cells(&l->box);
  it->lift = cf_level_sum(l, b) / cells / f->alpha - cf_level_sum(l, x) / cells;
  it->shift = f->alpha * it->lift;
}

static cf_status check_sums(const iteration *it) {
  if (isfinite(it->bb) && isfinite(it->rr)) return CF_OK;
  return cf_fail(CF_NOT_FINITE,
                 "the equation to solve holds a value that is not finite (|b| = %g, |b - A x| = %g)",
                 sqrt(it->bb), sqrt(it->rr));
}

cf_status cf_box_solver_run(cf_box_solver *f, cf_helmholtz *A, const cf_cell b, const cf_solve_options *o,
                            const cf_cell x, cf_solve_report *report, bool *finished) {
  cf_level *l = &A->level[0];
  iteration it = {.rate = 0.1};
  int slow = 0;
  *finished = true;
  report->levels = f->depth;
  it.scale = scale_for(f, l, b, x);
  set_mean(f, l, b, x, &it);
  form(f, A, b, x, &it);
  CF_TRY(check_sums(&it));
  if (it.bb == 0) cf_level_clear(l, x);
  const double enough = o->tolerance * o->tolerance * it.bb;
  while (it.bb > 0 && report->iterations < o->max_iterations) {
    if (it.rr <= CF_MAX(enough, floor_of(f, &it))) break;
    const bool far = enough < RECURSION_FLOOR * RECURSION_FLOOR * it.start;
    const double turn = far ? CF_MAX(RECURSION_TURN * RECURSION_TURN * it.start, enough) : enough;
    const double expected = 1.5 * it.rate * it.rate * it.rr;
    const double before = it.rr;
    if (f->depth > 1)
      cycle(f, b, x, expected <= turn, &it);
    else
      sweep_pass(f, b, x, 0.5 * sqrt(enough / it.rr), &it);
    ++report->iterations;
    CF_TRY(check_sums(&it));
    slow = it.rr > SLOW * SLOW * before ? slow + 1 : 0;
    if (slow >= SLOW_TIMES) break;
    if (it.rr <= turn && (far || sizeof(cf_real) == sizeof(float))) {
      const double begun = it.start;
      it.scale = near_power(sqrt(it.rr / (double)cf_box_cells(&l->box)));
      form(f, A, b, x, &it);
      if (it.rr > SLOW * SLOW * begun) break; /* all that x can hold */
    }
  }
  *finished = slow < SLOW_TIMES;
  if (it.lift != 0) {
    cf_level_shift(l, it.lift, x);
    it.lift = it.shift = 0;
    form(f, A, b, x, &it); /* what rounding has made of a large mean is part of the residual */
  }
  report->residual = it.bb > 0 ? sqrt(it.rr / it.bb) : 0;
  report->converged = it.bb == 0 || it.rr <= CF_MAX(enough, floor_of(f, &it));
  return CF_OK;
}
