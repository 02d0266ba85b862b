/* SPDX-License-Identifier: MIT
 *
 * Making the object, and how long explicit steps may be; see phase_part.h for the other files.
 */
#include "physics/phase.h"

#include <math.h>

#include "base/mem.h"
#include "physics/phase_part.h"

bool cf_phase_has_memory(const cf_phase_params *p) { return p->tau_1 > 0 && p->f_eta < 1; }
bool cf_phase_heat_has_memory(const cf_phase_params *p) { return p->tau_2 > 0 && p->f_t < 1; }

/* --- parameters ------------------------------------------------------------------------------------------- */

static cf_status check_number(const char *name, const double value, const double low, const double high) {
  if (value >= low && value <= high) return CF_OK;
  if (isinf(high)) return cf_fail(CF_BAD_ARGUMENT, "%s = %g: must be a number >= %g", name, value, low);
  return cf_fail(CF_BAD_ARGUMENT, "%s = %g: must be between %g and %g", name, value, low, high);
}

static cf_status check_params(const cf_phase_params *p) {
  CF_TRY(check_number("tau_eta", p->tau_eta, 0, INFINITY));
  CF_TRY(check_number("tau_1", p->tau_1, 0, INFINITY));
  CF_TRY(check_number("tau_2", p->tau_2, 0, INFINITY));
  CF_TRY(check_number("f_eta", p->f_eta, 0, 1));
  CF_TRY(check_number("f_t", p->f_t, 0, 1));
  CF_TRY(check_number("width", p->width, 0, INFINITY));
  CF_TRY(check_number("the diffusivity of heat", p->D, 0, INFINITY));
  CF_TRY(check_number("Gamma", p->star, 0, INFINITY));
  if (p->karma_rappel && (cf_phase_has_memory(p) || p->drive_strength != 0))
    return cf_fail(CF_BAD_ARGUMENT,
                   "the driving force of Karma and Rappel goes with tau_1 = 0 or f_eta = 1, and "
                   "with an anisotropy of the surface");
  if (p->form == CF_PHASE_PAPER && p->tau_eta == 0)
    return cf_fail(CF_BAD_ARGUMENT, "tau_eta = 0: the paper's form needs tau_eta > 0");
  return CF_OK;
}

cf_status cf_phase_set(cf_phase *p, const cf_phase_params *params) {
  CF_TRY(check_params(params));
  if (cf_phase_has_memory(params) != p->has_r || cf_phase_heat_has_memory(params) != p->has_w)
    return cf_fail(CF_BAD_ARGUMENT, "a flux cannot lose or gain its memory while a crystal grows");
  cf_anisotropy law;
  CF_TRY(cf_anisotropy_init(&law, &params->anisotropy));
  if (p->law.strength != law.strength || p->law.polar != law.polar || p->law.facets != law.facets ||
      p->bounds.a_max == 0)
    p->bounds =
        cf_anisotropy_range(&law, p->grid->box.dim, p->strength_max >= 0 ? p->strength_max : law.strength);
  p->law = law;
  p->p = *params;
  p->drive_C = cos(4 * params->anisotropy.angle);
  p->drive_S = sin(4 * params->anisotropy.angle);
  return CF_OK;
}

/* --- creation --------------------------------------------------------------------------------------------- */

static cf_real *take(cf_real **room, const ptrdiff_t n) {
  cf_real *at = *room;
  *room += (n + CF_LANES - 1) / CF_LANES * CF_LANES;
  return at;
}

/* The rows of every thread in one piece of memory. */
static cf_status make_rows(cf_phase *p) {
  const cf_box *box = &p->grid->box;
  const ptrdiff_t n = box->n[0], plane = box->dim == 3 ? n * box->n[1] : 0, pad = 2 * CF_LANES;
  const ptrdiff_t each = 10 * (n + 1 + pad) + plane + pad;
  p->threads = CF_MAX(1, p->grid->threads);
  CF_TRY(CF_NEW(&p->rows, p->threads));
  CF_TRY(CF_NEW(&p->room, each * p->threads));
  for (int t = 0; t < p->threads; ++t) {
    cf_real *room = p->room + each * t;
    cf_phase_rows *w = &p->rows[t];
    cf_real **rows[] = {&w->x, &w->low, &w->y, &w->z, &w->div, &w->react, &w->rate, &w->beta, &w->A2};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; ++i) *rows[i] = take(&room, n + 1);
    w->plane = take(&room, plane);
  }
  return CF_OK;
}

static cf_status make_state(const cf_phase *p, cf_phase_state *y) {
  const cf_box *box = &p->grid->box;
  CF_TRY(cf_cell_create(&y->eta, box));
  CF_TRY(cf_cell_create(&y->T, box));
  if (p->has_r) CF_TRY(cf_cell_create(&y->r, box));
  return p->has_w ? cf_cell_create(&y->w, box) : CF_OK;
}

static void destroy_state(const cf_phase *p, cf_phase_state *y) {
  cf_cell *cells[] = {&y->eta, &y->r, &y->T, &y->w};
  for (int i = 0; i < 4; ++i) cf_cell_destroy(cells[i], &p->grid->box);
}

#define ONE_LEVEL 2.5

static cf_status make_implicit(cf_phase *p) {
  const cf_box *box = &p->grid->box;
  cf_cell *cells[] = {&p->x, &p->b, &p->alpha};
  for (size_t i = 0; i < sizeof cells / sizeof *cells; ++i) CF_TRY(cf_cell_create(cells[i], box));
  CF_TRY(cf_face_create(&p->beta, box));
  p->beta_is = -1;
  /* Where a cell is not much finer than the interface, diffusion adds little to the diagonal in any step that is
   * accurate, and one level is enough. */
  const double share = p->p.width * p->bounds.a_max / p->grid->h;
  return cf_helmholtz_create(&p->A, p->grid, &p->eta_walls.walls, share * share < ONE_LEVEL ? 1 : 0);
}

static cf_status make(cf_phase *p, const cf_phase_walls *walls, const cf_phase_params *params,
                      const bool implicit) {
  const cf_box *box = &p->grid->box;
  p->has_r = cf_phase_has_memory(params);
  p->has_w = cf_phase_heat_has_memory(params);
  if (p->places.strength.at != NULL)
    p->strength_max = cf_sweep_range(box, 1, p->places.strength.at, p->sums).max;
  CF_TRY(cf_phase_set(p, params));
  if (implicit && params->form == CF_PHASE_PAPER)
    return cf_fail(CF_BAD_ARGUMENT, "the paper's form of the phase has explicit steps only");
  if (!implicit && params->tau_eta == 0)
    return cf_fail(CF_BAD_ARGUMENT,
                   "tau_eta = 0: an interface in equilibrium at all times needs implicit steps");
  CF_TRY(cf_wall_values_create(&p->eta_walls, p->grid, &walls->eta));
  CF_TRY(cf_wall_values_create(&p->T_walls, p->grid, &walls->T));
  CF_TRY(make_rows(p));
  if (params->form == CF_PHASE_PAPER || implicit) CF_TRY(cf_cell_create(&p->X, box));
  if (implicit) return make_implicit(p);
  for (int i = 0; i < 2; ++i) CF_TRY(make_state(p, &p->stage[i]));
  return CF_OK;
}

/* Walls that radiate are held at what they radiate to. */
static void hold_radiating(cf_walls *walls) {
  for (int a = 0; a < 3; ++a)
    for (int side = 0; side < 2; ++side)
      if (walls->kind[a][side] == CF_WALL_RADIATE) walls->kind[a][side] = CF_WALL_VALUE;
}

cf_status cf_phase_create(cf_phase **p, const cf_grid *g, const cf_phase_walls *walls,
                          const cf_phase_params *params, const cf_phase_places *places, const bool implicit) {
  *p = NULL;
  cf_phase *fresh;
  cf_phase_walls held = *walls;
  hold_radiating(&held.eta);
  hold_radiating(&held.T);
  CF_TRY(CF_NEW(&fresh, 1));
  fresh->grid = g;
  fresh->strength_max = -1;
  if (places != NULL) fresh->places = *places;
  cf_status s = CF_NEW(&fresh->sums, 3 * cf_box_rows(&g->box));
  if (s == CF_OK) s = CF_NEW(&fresh->filled, cf_box_rows(&g->box));
  if (s == CF_OK) s = CF_NEW(&fresh->next_filled, cf_box_rows(&g->box));
  if (s == CF_OK) s = make(fresh, &held, params, implicit);
  if (s != CF_OK) {
    cf_phase_destroy(fresh);
    return s;
  }
  *p = fresh;
  return CF_OK;
}

void cf_phase_destroy(cf_phase *p) {
  if (p == NULL) return;
  const cf_box *box = &p->grid->box;
  cf_cell *cells[] = {&p->x, &p->b, &p->alpha, &p->X};
  for (size_t i = 0; i < sizeof cells / sizeof *cells; ++i) cf_cell_destroy(cells[i], box);
  for (int i = 0; i < 2; ++i) destroy_state(p, &p->stage[i]);
  cf_face_destroy(&p->beta, box);
  cf_helmholtz_destroy(p->A);
  cf_wall_values_destroy(&p->eta_walls);
  cf_wall_values_destroy(&p->T_walls);
  cf_free(p->rows);
  cf_free(p->room);
  cf_free(p->sums);
  cf_free(p->filled);
  cf_free(p->next_filled);
  cf_free(p);
}

/* --- limits ----------------------------------------------------------------------------------------------- */

/* Largest real and complex |lambda dt| that three stages of third order bear. */
#define REAL_LIMIT    2.4
#define COMPLEX_LIMIT 1.6

/* Of y' = [z + ...], x y'' + ...: a pair with the given (negative) trace and determinant. */
static double pair_limit(const double trace, const double det) {
  const double inside = trace * trace / 4 - det;
  if (inside < 0) return COMPLEX_LIMIT / sqrt(det);
  const double fastest = trace / 2 + sqrt(inside);
  return fastest > 0 ? REAL_LIMIT / fastest : INFINITY;
}

/* s y_t = m + F R + rest, tau m_t + m = (1 - F) R, R = -stiff y, rest = -more y. */
static double limit_of(const double s, const double tau, const double F, const double stiff,
                       const double more) {
  if (!(tau > 0) || F >= 1) return stiff + more > 0 ? REAL_LIMIT * s / (stiff + more) : INFINITY;
  return pair_limit((F * stiff + more) / s + 1 / tau, (stiff + more) / (s * tau));
}

/* What freezes warms what freezes, which then freezes slower: T_t = -chi/tau_eta T at the steepest of psi, in the middle of
 * the interface. This is chi, of the part that acts at once. */
static double release_rate(const cf_phase_params *q) {
  const double now = cf_phase_has_memory(q) ? q->f_eta : 1;
  return now * q->latent * (q->karma_rappel ? q->coupling / 2 : q->alpha * q->gamma / (4 * acos(-1)));
}

cf_phase_limits cf_phase_limits_of(const cf_phase *p) {
  const cf_phase_params *q = &p->p;
  const int dim = p->grid->box.dim;
  const double h2 = p->grid->h * p->grid->h, star = dim == 3 ? fmax(1, q->star) : 1;
  const double steepest = q->plain ? 4 * dim : 6; /* h^2 times the largest eigenvalue of the Laplacian */
  const double spread = steepest * q->width * q->width * p->bounds.stiff_max * star * star / h2;
  const double pull = q->karma_rappel ? 4 : 1,
               s = q->tau_eta * (q->karma_rappel ? p->bounds.a_min * p->bounds.a_min : 1);
  cf_phase_limits l;
  if (q->form == CF_PHASE_PAPER)
    l.phase = limit_of(s, q->tau_1, q->f_eta, spread, spread + pull);
  else
    l.phase = limit_of(s, q->tau_1, q->f_eta, spread + pull, 0);
  l.heat = limit_of(1, q->tau_2, q->f_t, 4 * dim * q->D / h2, 0);
  l.both = fmin(l.phase, limit_of(1, q->tau_2, q->f_t, 4 * dim * q->D / h2, release_rate(q) / s));
  l.reaction = q->form == CF_PHASE_STABLE && cf_phase_has_memory(q)
                   ? fmax(q->tau_eta, sqrt(q->tau_eta * q->tau_1))
                   : q->tau_eta;
  return l;
}
