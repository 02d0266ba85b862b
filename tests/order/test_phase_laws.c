/* SPDX-License-Identifier: MIT
 *
 * What a crystal must keep to: curvature, energy, heat and the time's order.
 */
#include "crystal.h"
#include "physics/diffuse.h"

/* R^2 = R0^2 - 2 (d - 1) (eps^2/tau_eta) t with psi = 0. */
static void ball_shrinks_by_its_curvature(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; ++dim) {
    cf_phase_params q = crystal_params();
    crystal c;
    q.latent = 0, q.D = 0, q.gamma = 0, q.width = 1, q.tau_eta = 1;
    const int n = dim == 2 ? 80 : 44;
    const double h = dim == 2 ? 0.75 : 1, R0 = dim == 2 ? 20 : 16;
    crystal_make(&c, dim, (int[3]){n, n, n}, h, &q, NULL, false, 1);
    crystal_ball(&c, R0, 1, 0);
    double where[3];
    const double first = cf_phase_tip(c.p, c.y.eta, (double[3]){0, 0, 0}, 0, where), dt = 0.1;
    const int steps = dim == 2 ? 1000 : 250;
    crystal_grow(&c, dt, steps);
    const double last = cf_phase_tip(c.p, c.y.eta, (double[3]){0, 0, 0}, 0, where);
    CLOSE((first * first - last * last) / (2 * (dim - 1) * steps * dt), 1, 0.02);
    crystal_free(&c);
  }
}

/* With T frozen and A = 1, from noise and from a ball, for any memory and either way of stepping. */
static double largest_rise(const double theta, const double F, const bool implicit, const double dt,
                           const double strength, const int folds) {
  cf_phase_params q = crystal_params();
  crystal c;
  cf_cell h;
  uint64_t seed = 3;
  q.latent = 0, q.D = 0, q.f_eta = F, q.tau_1 = theta * q.tau_eta;
  q.anisotropy = (cf_anisotropy_params){.n = folds, .strength = strength};
  crystal_make(&c, 2, (int[3]){64, 64, 1}, 0.02, &q, NULL, implicit, 1);
  OK(cf_cell_create(&h, &c.g.box));
  crystal_ball(&c, 0.3, q.width, -0.03);
  CRYSTAL_CELLS(&c, i, j, k, p) {
    c.y.eta.at[p] += (cf_real)(0.2 * (test_random(&seed) - 0.5));
    h.at[p] = c.y.T.at[p];
  }
  double before = cf_phase_energy(c.p, &c.y), most = -INFINITY;
  const double scale = fabs(before);
  for (int s = 0; s < 60; ++s) {
    cf_solve_report report;
    if (implicit)
      OK(cf_phase_step_implicit(c.p, 0, dt * q.tau_eta, &(cf_phase_heat){h, h, 0}, c.y.eta, c.y.r, &report));
    else
      crystal_grow(&c, dt * q.tau_eta, 1);
    const double now = cf_phase_energy(c.p, &c.y);
    most = fmax(most, (now - before) / scale);
    before = now;
  }
  cf_cell_destroy(&h, &c.g.box);
  crystal_free(&c);
  return most;
}

static void energy_never_rises_while_the_temperature_is_frozen(void **state) {
  static const double theta[] = {0, 1, 10};
  (void)state;
  for (int i = 0; i < 3; ++i) {
    BELOW(largest_rise(theta[i], 0, false, 0.2, 0, 0), 1e-12);
    BELOW(largest_rise(theta[i], 0, true, 1, 0, 0), 1e-9);
    BELOW(largest_rise(theta[i], 0.5, true, 0.5, 0, 0), 1e-9);
  }
}

/* With anisotropy, up to the steps of this table. */
static void energy_falls_with_anisotropy_up_to_the_stated_steps(void **state) {
  static const struct {
    double theta, dt;
    bool implicit;
  } steps[] = {{0, 0.3, false}, {0, 2, true}, {1, 0.3, false}, {1, 2, true}, {10, 0.3, false}, {10, 2, true}};
  (void)state;
  for (size_t i = 0; i < sizeof steps / sizeof *steps; ++i)
    BELOW(largest_rise(steps[i].theta, 0, steps[i].implicit, steps[i].dt, 0.02, 6), 1e-4);
}

static void heat_is_kept_to_round_off(void **state) {
  (void)state;
  for (int memory = 0; memory < 2; ++memory) {
    cf_phase_params q = crystal_params();
    crystal c;
    q.f_eta = 0, q.tau_1 = memory * 3e-4, q.tau_2 = memory * 1e-4, q.f_t = 0;
    q.anisotropy = (cf_anisotropy_params){.n = 4, .strength = 0.05, .angle = 0.3};
    crystal_make(&c, 2, (int[3]){96, 96, 1}, 0.03, &q, NULL, false, 1);
    crystal_ball(&c, 0.12, q.width, -1);
    const double first = cf_phase_heat_content(c.p, &c.y);
    crystal_grow(&c, 1e-4, 1000);
    CLOSE(cf_phase_heat_content(c.p, &c.y) / first, 1, 1e-12);
    crystal_free(&c);
  }
}

/* --- the order in time ------------------------------------------------------------------------------------ */

static cf_cell released;
static const cf_grid *released_on;

static cf_status give(void *context, const double t, const cf_cell W) {
  (void)context, (void)t;
  const cf_box *b = &released_on->box;
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
    for (int i = 0; i < b->n[0]; ++i) W.at[cf_box_row(b, r) + i] = released.at[cf_box_row(b, r) + i];
  return CF_OK;
}

static void grow_implicitly(crystal *c, const cf_phase_params *q, const double dt, const int steps) {
  const cf_diffuse_params heat = {.k = {.value = q->D},
                                  .capacity = {.value = 1},
                                  .tau = q->tau_2,
                                  .f_t = q->f_t,
                                  .scheme = CF_DIFFUSE_SDIRK2,
                                  .solver = {1e-8, 100}};
  const cf_source source = {.rate = give};
  const cf_walls walls = {.value = {{{0}}}};
  cf_diffuse *d;
  cf_ledger ledger = {0, 0, 0};
  cf_cell now, before;
  released_on = &c->g;
  OK(cf_cell_create(&released, &c->g.box));
  OK(cf_cell_create(&now, &c->g.box));
  OK(cf_cell_create(&before, &c->g.box));
  OK(cf_diffuse_create(&d, &c->g, &walls, &heat, &source));
  for (int s = 0; s < steps; ++s) {
    cf_solve_report report;
    CRYSTAL_CELLS(c, i, j, k, p) {
      released.at[p] = c->y.eta.at[p];
      now.at[p] = c->y.T.at[p] - (cf_real)q->latent * c->y.eta.at[p];
    }
    OK(cf_phase_step_implicit(c->p, s * dt, dt, &(cf_phase_heat){now, before, s > 0 ? dt : 0}, c->y.eta,
                              c->y.r, &report));
    CRYSTAL_CELLS(c, i, j, k, p) {
      released.at[p] = (cf_real)(q->latent / dt) * (c->y.eta.at[p] - released.at[p]);
      before.at[p] = now.at[p];
    }
    OK(cf_diffuse_step_scalar(d, s * dt, dt, c->y.T, c->y.w, &ledger, &report));
  }
  cf_diffuse_destroy(d);
  cf_cell_destroy(&now, &c->g.box);
  cf_cell_destroy(&before, &c->g.box);
  cf_cell_destroy(&released, &c->g.box);
}

static double difference(const crystal *a, const crystal *b) {
  double sum = 0, all = 0;
  CRYSTAL_CELLS(a, i, j, k, p) {
    sum += fabs((double)(a->y.eta.at[p] - b->y.eta.at[p]));
    all += fabs((double)a->y.eta.at[p]);
  }
  return sum / all;
}

static void implicit_and_explicit_steps_agree_as_dt_goes_to_zero(void **state) {
  (void)state;
  for (int memory = 0; memory < 2; ++memory) {
    cf_phase_params q = crystal_params();
    crystal fine, c;
    double error[2];
    q.f_eta = 0, q.tau_1 = memory * q.tau_eta, q.tau_2 = memory * 1e-4, q.f_t = 0, q.solver.tolerance = 1e-8;
    q.anisotropy = (cf_anisotropy_params){.n = 6, .strength = 0.02};
    crystal_make(&fine, 2, (int[3]){64, 64, 1}, 0.03, &q, NULL, false, 1);
    crystal_ball(&fine, 0.15, q.width, -1);
    crystal_grow(&fine, 5e-5, 600);
    for (int i = 0; i < 2; ++i) {
      crystal_make(&c, 2, (int[3]){64, 64, 1}, 0.03, &q, NULL, true, 1);
      crystal_ball(&c, 0.15, q.width, -1);
      grow_implicitly(&c, &q, i == 0 ? 1.5e-4 : 7.5e-5, i == 0 ? 200 : 400);
      error[i] = difference(&c, &fine);
      crystal_free(&c);
    }
    print_message("memory %d: errors %.2e, %.2e\n", memory, error[0], error[1]);
    BELOW(error[0], 0.01);
    BELOW(error[1] / error[0], 0.36); /* second order: 1/4 */
    crystal_free(&fine);
  }
}

static void euler_is_of_first_order_and_the_default_of_third(void **state) {
  (void)state;
  for (int order = 1; order <= 3; order += 2) {
    cf_phase_params q = crystal_params();
    crystal c[3];
    q.anisotropy = (cf_anisotropy_params){.n = 6, .strength = 0.02};
    for (int i = 0; i < 3; ++i) {
      crystal_make(&c[i], 2, (int[3]){48, 48, 1}, 0.03, &q, NULL, false, 1);
      crystal_ball(&c[i], 0.15, q.width, -1);
      const cf_phase_explicit how = {.order = i == 2 ? 3 : order, .substeps = 1};
      const int steps = i == 2 ? 1600 : i == 0 ? 200 : 400;
      for (int s = 0; s < steps; ++s)
        OK(cf_phase_step_explicit(c[i].p, 0, 0.02 / steps, &how, &c[i].y, NULL));
    }
    const double coarse = difference(&c[0], &c[2]), fine = difference(&c[1], &c[2]);
    print_message("order %d: errors %.2e, %.2e\n", order, coarse, fine);
    CLOSE(log2(coarse / fine), order, 0.25);
    for (int i = 0; i < 3; ++i) crystal_free(&c[i]);
  }
}

/* Much latent heat, in cells so large that diffusion alone would allow steps three times as long (and T of .9): nothing gets warmer than
 * the melting point, but for what the interface's width does. */
static void steps_at_their_limit_do_not_overheat_the_interface(void **state) {
  (void)state;
  cf_phase_params q = crystal_params();
  crystal c;
  q.latent = 8;
  crystal_make(&c, 2, (int[3]){64, 64, 1}, 0.03, &q, NULL, false, 1);
  crystal_ball(&c, 0.3, q.width, -1);
  const double dt = 0.95 * cf_phase_limits_of(c.p).both;
  double most = -1;
  crystal_grow(&c, dt, (int)(0.03 / dt));
  CRYSTAL_CELLS(&c, i, j, k, p) most = fmax(most, (double)c.y.T.at[p]);
  print_message("steps of %.3g s: T up to %.4f\n", dt, most);
  BELOW(most, 0.04);
  crystal_free(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(ball_shrinks_by_its_curvature),
      cmocka_unit_test(energy_never_rises_while_the_temperature_is_frozen),
      cmocka_unit_test(energy_falls_with_anisotropy_up_to_the_stated_steps),
      cmocka_unit_test(heat_is_kept_to_round_off),
      cmocka_unit_test(implicit_and_explicit_steps_agree_as_dt_goes_to_zero),
      cmocka_unit_test(euler_is_of_first_order_and_the_default_of_third),
      cmocka_unit_test(steps_at_their_limit_do_not_overheat_the_interface),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
