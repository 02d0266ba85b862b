/* SPDX-License-Identifier: MIT
 *
 * Implicit steps of the phase. A stage of length d, with everything at its end,
 *
 *     tau_eta (e - eta*)/d = r + F R,   (tau_1 + d) r = tau_1 r* + d (1 - F) R,   R = X(e) + f(e),
 *
 * is one equation for e once r is eliminated,
 *
 *     tau_eta e - c R(e) = tau_eta eta* + m r*,     c = d (d + F tau_1)/(tau_1 + d),  m = d tau_1/(tau_1 + d).
 *
 * It is solved by passes around the one solver. In each, f is linearised where that pulls (J = min(f', 0), so that the
 * matrix stays positive definite for any d), and of X only as much isotropic diffusion is implicit as bounds it,
 *
 *     (tau_eta - c J - c eps^2 a^2 div_* grad_*) e' = tau_eta eta* + m r* + c [f(e) - J e + X(e) - eps^2 a^2 lap_* e],
 *
 * a = max A, which is enough for every convex A. Two passes from e = eta* keep the second order of SDIRK2, which takes two
 * such stages; one would not, nor would a looser tolerance than about 1e-6. Where r is all that moves eta (F = 0) it
 * tells what e will be: one pass from e = eta* + (d/tau_eta) r does, r being r*, as long as d is short beside tau_eta
 * and tau_1.
 *
 * psi takes T = H + K e with H = T - K eta, which only diffusion moves, extrapolated over the step: so the latent heat
 * that slows an interface down within the step is seen in it, and steps of tau_eta and more stay sound.
 *
 * tau_eta = 0 is an ordinary value: the interface is then in equilibrium with T at all times.
 */
#include <math.h>
#include <string.h>

#include "physics/phase_part.h"

enum { PASSES = 2 };

/* Up to this share of tau_eta (and up to tau_1) a stage is foreseen by r. */
#define FORESEEN 0.5

/* What the tails of eta and r fall to far from an interface is 0: no rounding of anything else shows it, and where both are
 * 0 a row costs next to nothing. */
#define NOTHING 1e-30

/* What a step changes is a small part of what the right side holds: of the solver's tolerance, which is relative to
 * the latter, this much is asked for. */
#define OF_A_STEP 0.01

/* A mask of 0 would be an infinite tau_eta. */
#define LEAST_MOBILITY 1e-9

typedef struct stage {
  double delta, c, m, bound; /* bound = eps^2 a^2 */
  double pull;               /* tau_1/(tau_1 + d) */
  double weight;             /* of the stage's change: y <- y* + weight (y - y*) */
  double ahead;              /* of r: e begins as eta* + ahead r */
  cf_cell eta, r;            /* eta*, r* */
  const cf_real *h, *h_before;
  double later; /* H at the stage's end is h + later (h - h_before) */
} stage;

CF_CLONES static void extrapolate_row(const int n, const cf_real later, const cf_real *now,
                                      const cf_real *before, cf_real *to) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) to[i] = now[i] + later * (now[i] - before[i]);
}

CF_CLONES static void rate_row(const int n, const double tau, const cf_real *A2, const cf_real *mobility,
                               cf_real *rate) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const double m = mobility != NULL ? (double)mobility[i] : 1;
    rate[i] = (cf_real)(tau * (A2 != NULL ? (double)A2[i] : 1) / CF_MAX(m, LEAST_MOBILITY));
  }
}

/* tau_eta of the cells of a row, with mobility and A^2 in it. */
static void tau_row(const cf_phase *p, cf_phase_rows *rows, const cf_real *eta, const ptrdiff_t start) {
  if (p->p.karma_rappel) cf_phase_A2_row(p, p->grid->box.n[0], eta, start, rows->A2);
  rate_row(p->grid->box.n[0], p->p.tau_eta, p->p.karma_rappel ? rows->A2 : NULL,
           p->places.mobility.at != NULL ? p->places.mobility.at + start : NULL, rows->rate);
}

typedef struct equation {
  ptrdiff_t stride[3];
  cf_real star2[3], c, bound;     /* Gamma^2/h^2; eps^2 a^2 */
  const cf_real *e, *eta;         /* fields */
  const cf_real *tau, *X, *f, *J; /* rows */
  cf_real *alpha, *b;
} equation;

CF_KERNEL void equation_row(const int dim, const int n, const equation *q, const ptrdiff_t start) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const ptrdiff_t p = start + i;
    const cf_real e = q->e[p];
    cf_real bend = 0;
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) {
      const ptrdiff_t s = q->stride[a];
      bend += q->star2[a] * ((q->e[p + s] - e) - (e - q->e[p - s]));
    }
    q->alpha[p] = q->tau[i] - q->c * q->J[i];
    q->b[p] = q->tau[i] * q->eta[p] + q->c * ((q->f[i] - q->J[i] * e) + (q->X[i] - q->bound * bend));
  }
}
CF_CLONED(equation_row, const equation *, const ptrdiff_t)

/* The same where e, X and f are 0; J is of no interest where so is everything else. */
CF_CLONES static void idle_row(const int n, const equation *q, const ptrdiff_t start) {
  const cf_real *tau = q->tau, *eta = q->eta + start;
  cf_real *alpha = q->alpha + start, *b = q->b + start;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    alpha[i] = tau[i];
    b[i] = tau[i] * eta[i];
  }
}

/* J and f of the busy part of the row, in rows->x and rows->react. */
static void react(const cf_phase *p, cf_phase_rows *rows, const stage *s, const ptrdiff_t start) {
  const int from = rows->busy.from, n = rows->busy.to - from;
  cf_phase_react f = cf_phase_react_of(p, rows, n, p->x.at, start + from);
  f.T = s->h + start + from;
  if (s->later != 0) {
    extrapolate_row(n, (cf_real)s->later, f.T, s->h_before + start + from, rows->rate);
    f.T = rows->rate;
  }
  f.lean = rows->x; /* the fluxes in x have been used */
  cf_phase_react_row(n, &f);
}

static equation equation_of(const cf_phase *p, const cf_phase_rows *rows, const stage *s) {
  equation q = {.c = (cf_real)s->c, .bound = (cf_real)s->bound, .e = p->x.at, .eta = s->eta.at};
  q.tau = rows->rate, q.X = rows->div, q.f = rows->react, q.J = rows->x;
  q.alpha = p->alpha.at, q.b = p->b.at;
  for (int a = 0; a < p->grid->box.dim; ++a) {
    const double star = (a == 2 ? p->p.star : 1) / p->grid->h;
    q.stride[a] = p->grid->box.stride[a];
    q.star2[a] = (cf_real)(star * star);
  }
  return q;
}

static void visit(const cf_phase *p, cf_phase_rows *rows, const ptrdiff_t start, const ptrdiff_t r,
                  void *context) {
  const stage *s = context;
  const int dim = p->grid->box.dim, all = p->grid->box.n[0], from = rows->busy.from, to = rows->busy.to;
  equation q = equation_of(p, rows, s);
  (void)r;
  if (from < to) react(p, rows, s, start);
  tau_row(p, rows, p->x.at, start);
  idle_row(from, &q, start);
  q.tau += to;
  idle_row(all - to, &q, start + to);
  q.tau = rows->rate + from, q.X = rows->div + from;
  if (from < to) equation_row_by_dim(dim, to - from, &q, start + from);
  if (s->r.at != NULL) cf_phase_add_row(all, (cf_real)s->m, s->r.at + start, p->b.at + start);
}

static void fill_row(const int n, const cf_real value, cf_real *to) {
  for (int i = 0; i < n; ++i) to[i] = value;
}

/* beta on faces, where Gamma makes it another number along z. */
static void set_beta(cf_phase *p, const double beta) {
  const cf_box *box = &p->grid->box;
  p->beta_is = beta;
  for (int a = 0; a < box->dim; ++a) {
    const int n1 = cf_box_extent(box, 1, a), n2 = cf_box_extent(box, 2, a);
    for (int r = 0; r < n1 * n2; ++r)
      fill_row(cf_box_extent(box, 0, a), (cf_real)(a == 2 ? beta * p->p.star * p->p.star : beta),
               p->beta.at[a] + cf_box_at(box, 0, r % n1, r / n1));
  }
}

static cf_status pass(cf_phase *p, stage *s, cf_solve_report *report) {
  cf_solve_report one;
  cf_solve_options o = p->p.solver;
  o.tolerance = CF_MAX(o.tolerance * OF_A_STEP, 64 * CF_REAL_EPSILON);
  cf_phase_ghosts(p, p->x);
  cf_phase_each_row(p, CF_PHASE_X, p->x, visit, s);
  const bool alike = p->grid->box.dim == 2 || p->p.star == 1;
  cf_coefficients law = {.alpha_at = &p->alpha, .beta = s->c * s->bound};
  if (!alike) {
    if (law.beta != p->beta_is) set_beta(p, law.beta);
    law.beta_at = &p->beta;
    law.beta = 0;
  }
  CF_TRY(cf_helmholtz_set(p->A, &law));
  cf_helmholtz_add_walls(p->A, &p->eta_walls, p->b);
  CF_TRY(cf_helmholtz_solve(p->A, p->b, &o, p->x, &one));
  report->iterations += one.iterations;
  report->levels = one.levels;
  report->residual = CF_MAX(report->residual, one.residual);
  report->converged = report->converged && one.converged;
  report->method = one.method;
  return CF_OK;
}

/* What the row of a stage's end is made of. */
typedef struct ending {
  const cf_real *e, *mobility;
  cf_real *eta, *r;
  double pull, m, per, tau, weight;
} ending;

static inline cf_real something(const double value) {
  return value < NOTHING && value > -NOTHING ? 0 : (cf_real)value;
}

/* c R = tau_eta (e - eta*) - m r*, so (1 - F) d/(tau_1 + d) R = (1 - F)/(d + F tau_1) (...). */
CF_CLONES static void end_row(const int n, const ending *of) {
  const ending s = *of;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const double old = (double)s.eta[i], change = (double)s.e[i] - old;
    s.eta[i] = something(old + s.weight * change);
    if (s.r == NULL) continue;
    const double mobility = s.mobility != NULL ? (double)s.mobility[i] : 1, was = (double)s.r[i];
    const double tau = s.tau / CF_MAX(mobility, LEAST_MOBILITY);
    const double now = s.pull * was + s.per * (tau * change - s.m * was);
    s.r[i] = something(was + s.weight * (now - was));
  }
}

/* r of the stage from what moved eta, and both weighted. */
static void finish(cf_phase *p, const stage *s) {
  const cf_box *box = &p->grid->box;
  const double F = p->p.f_eta, d = s->delta;
  CF_PARALLEL_ROWS (box, p->grid->threads, r) {
    const ptrdiff_t start = cf_box_row(box, r);
    const ending row = {.e = p->x.at + start,
                        .mobility = p->places.mobility.at != NULL ? p->places.mobility.at + start : NULL,
                        .eta = s->eta.at + start,
                        .r = s->r.at != NULL ? s->r.at + start : NULL,
                        .pull = s->pull,
                        .m = s->m,
                        .per = (1 - F) / (d + F * p->p.tau_1),
                        .tau = p->p.tau_eta,
                        .weight = s->weight};
    end_row(box->n[0], &row);
  }
}

CF_CLONES static void foresee_row(const int n, const cf_real ahead, const cf_real *mobility,
                                  const cf_real *eta, const cf_real *r, cf_real *e) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) e[i] = eta[i] + (mobility != NULL ? ahead * mobility[i] : ahead) * r[i];
}

/* e = eta* + ahead r, with the mobility in it. */
static void foresee(const cf_phase *p, const stage *s) {
  const cf_box *box = &p->grid->box;
  CF_PARALLEL_ROWS (box, p->grid->threads, row) {
    const ptrdiff_t at = cf_box_row(box, row);
    foresee_row(box->n[0], (cf_real)s->ahead,
                p->places.mobility.at != NULL ? p->places.mobility.at + at : NULL, s->eta.at + at,
                s->r.at + at, p->x.at + at);
  }
}

static void copy_field(const cf_phase *p, const cf_cell from, const cf_cell to) {
  const cf_box *box = &p->grid->box;
  CF_PARALLEL_ROWS (box, p->grid->threads, r)
    memcpy(to.at + cf_box_row(box, r), from.at + cf_box_row(box, r), (size_t)box->n[0] * sizeof *to.at);
}

/* The end of a stage and its length; what of the change counts; and what its H is. */
typedef struct stage_place {
  double t_end, delta, weight, later;
} stage_place;

static cf_status run_stage(cf_phase *p, const stage_place *at, const cf_phase_heat *heat, const cf_cell eta,
                           const cf_cell r, cf_solve_report *report) {
  const double tau_1 = p->has_r ? p->p.tau_1 : 0, a = p->bounds.a_max * p->p.width, delta = at->delta;
  stage s = {.delta = delta, .weight = at->weight, .bound = a * a, .eta = eta, .later = at->later};
  s.h = heat->h_now.at, s.h_before = heat->h_before.at;
  s.pull = tau_1 > 0 ? 1 / (1 + delta / tau_1) : 0;
  s.m = delta * s.pull;
  s.c = tau_1 > 0 ? (delta * (1 - s.pull) + p->p.f_eta * s.m) : delta;
  if (p->has_r) s.r = r;
  cf_wall_values_sample(&p->eta_walls, at->t_end);
  const bool foreseen = p->has_r && p->p.f_eta == 0 && delta <= FORESEEN * p->p.tau_eta && delta <= tau_1;
  if (foreseen) {
    s.ahead = delta / p->p.tau_eta;
    foresee(p, &s);
  } else {
    copy_field(p, eta, p->x);
  }
  for (int i = foreseen ? 1 : 0; i < PASSES; ++i) CF_TRY(pass(p, &s, report));
  finish(p, &s);
  return CF_OK;
}

cf_status cf_phase_step_implicit(cf_phase *p, const double t, const double dt, const cf_phase_heat *heat,
                                 const cf_cell eta, const cf_cell r, cf_solve_report *report) {
  const double g = 1 - sqrt(0.5), per = heat->dt_before > 0 ? dt / heat->dt_before : 0;
  const stage_place first = {t + g * dt, g * dt, 1 + sqrt(2), g * per}, second = {t + dt, g * dt, 1, per};
  *report = (cf_solve_report){.converged = true};
  CF_TRY(run_stage(p, &first, heat, eta, r, report));
  return run_stage(p, &second, heat, eta, r, report);
}
