/* SPDX-License-Identifier: MIT
 *
 * Flat fronts with a frozen driving force: speeds by shooting for the paper's form, in closed form for the stable
 * one; and the driving force itself.
 */
#include "crystal.h"
#include "physics/phase_part.h"
#include "reference.h"

enum { CELLS = 400 };

/* Speed of a front at psi in eps/tau_eta, from where eta = 1/2 at two times. h = eps/2. */
static double speed_of(const cf_phase_form form, const double theta, const double F, const double psi,
                       const bool implicit) {
  cf_phase_params q = crystal_params();
  crystal c;
  q.form = form, q.width = 1, q.tau_eta = 1, q.tau_1 = theta, q.f_eta = F, q.latent = 0, q.D = 0;
  crystal_make(&c, 2, (int[3]){CELLS, 3, 1}, 0.5, &q, NULL, implicit, 1);
  const double T = -tan(psi * acos(-1) / q.alpha) / q.gamma, end = c.g.origin[0];
  CRYSTAL_CELLS(&c, i, j, k, p) {
    const double x = cf_grid_place(&c.g, 0, i, 0) - end - 30;
    c.y.eta.at[p] = (cf_real)((1 - tanh(x / (2 * sqrt(2)))) / 2);
    c.y.T.at[p] = (cf_real)T;
  }
  const cf_phase_limits l = cf_phase_limits_of(c.p);
  const double dt = fmin(0.2, 0.9 * l.both), from[3] = {end, 0, 0};
  double where[3], first = 0, last = 0;
  const int steps = (int)(240 / dt);
  cf_cell h;
  OK(cf_cell_create(&h, &c.g.box));
  CRYSTAL_CELLS(&c, i, j, k, p) h.at[p] = c.y.T.at[p];
  const cf_phase_heat heat = {h, h, 0};
  for (int s = 0; s < steps; ++s) {
    cf_solve_report report;
    if (s == steps / 2) first = cf_phase_tip(c.p, c.y.eta, from, 0, where);
    if (implicit)
      OK(cf_phase_step_implicit(c.p, s * dt, dt, &heat, c.y.eta, c.y.r, &report));
    else
      crystal_grow(&c, dt, 1);
  }
  last = cf_phase_tip(c.p, c.y.eta, from, 0, where);
  cf_cell_destroy(&h, &c.g.box);
  crystal_free(&c);
  return (last - first) / ((steps - steps / 2) * dt);
}

static void paper_front_runs_as_shooting_says(void **state) {
  (void)state;
  table t = table_read("front_speed.csv");
  for (int r = 0; r < t.rows; r += 4) {
    const double psi = table_at(&t, r, "psi"), theta = table_at(&t, r, "theta"),
                 v = table_at(&t, r, "v_exact");
    CLOSE(speed_of(CF_PHASE_PAPER, theta, 0, psi, false) / v, 1, 0.01);
  }
  table_free(&t);
}

static void stable_front_runs_as_its_closed_form_says(void **state) {
  static const double theta[] = {0.5, 2, 8};
  (void)state;
  for (int i = 0; i < 3; ++i)
    CLOSE(
        speed_of(CF_PHASE_STABLE, theta[i], 0, 0.3, false) / (sqrt(2) * 0.3 / sqrt(1 + 2 * theta[i] * 0.09)),
        1, 0.01);
}

/* F_eta = 1 has no memory, whatever tau_1. */
static void fourier_front_runs_at_the_classical_speed(void **state) {
  (void)state;
  CLOSE(speed_of(CF_PHASE_STABLE, 2, 1, 0.3, false) / (sqrt(2) * 0.3), 1, 0.01);
  CLOSE(speed_of(CF_PHASE_PAPER, 2, 1, 0.3, false) / (sqrt(2) * 0.3), 1, 0.01);
}

static void implicit_front_runs_like_the_explicit_one(void **state) {
  (void)state;
  CLOSE(speed_of(CF_PHASE_STABLE, 0, 0, 0.3, true) / (sqrt(2) * 0.3), 1, 0.01);
  CLOSE(speed_of(CF_PHASE_STABLE, 2, 0, 0.3, true) / (sqrt(2) * 0.3 / sqrt(1 + 4 * 0.09)), 1, 0.01);
}

/* psi of eqs 27 and 28: f/(eta (1 - eta)) - eta + 1/2 in a row whose gradient points along v. */
static void driving_force_is_that_of_the_table(void **state) {
  (void)state;
  table t = table_read("driving_psi.csv");
  for (int r = 0; r < t.rows; ++r)
    for (int directed = 0; directed < 2; ++directed) {
      cf_phase_params q = crystal_params();
      crystal c;
      q.alpha = table_at(&t, r, "alpha"), q.gamma = table_at(&t, r, "gamma");
      q.drive_strength = directed ? table_at(&t, r, "delta") : 0;
      crystal_make(&c, 3, (int[3]){3, 3, 3}, 1, &q, NULL, false, 1);
      const double v[3] = {table_at(&t, r, "v1"), table_at(&t, r, "v2"), table_at(&t, r, "v3")};
      CRYSTAL_CELLS(&c, i, j, k, p) {
        const int at[3] = {i - 1, j - 1, k - 1};
        c.y.eta.at[p] = (cf_real)(0.3 + 0.01 * (v[0] * at[0] + v[1] * at[1] + v[2] * at[2]));
        c.y.T.at[p] = (cf_real)table_at(&t, r, "T");
      }
      const ptrdiff_t start = cf_box_at(&c.g.box, 0, 1, 1);
      cf_phase_react f = cf_phase_react_of(c.p, &c.p->rows[0], c.g.box.n[0], c.y.eta.at, start);
      f.T = c.y.T.at + start;
      cf_phase_react_row(3, &f);
      const double e = (double)c.y.eta.at[start + 1];
      const double psi = (double)f.react[1] / (e * (1 - e)) - e + 0.5;
      CLOSE(psi, table_at(&t, r, directed ? "psi_eq27" : "psi_eq28"), 1e-12);
      crystal_free(&c);
    }
  table_free(&t);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(paper_front_runs_as_shooting_says),
      cmocka_unit_test(stable_front_runs_as_its_closed_form_says),
      cmocka_unit_test(fourier_front_runs_at_the_classical_speed),
      cmocka_unit_test(implicit_front_runs_like_the_explicit_one),
      cmocka_unit_test(driving_force_is_that_of_the_table),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
