/* SPDX-License-Identifier: MIT
 *
 * Crystals mirrored, turned and computed by several threads.
 */
#include "crystal.h"

static cf_phase_params snow(const double theta, const double angle) {
  cf_phase_params q = crystal_params();
  q.f_eta = 0, q.tau_1 = theta * q.tau_eta;
  q.anisotropy = (cf_anisotropy_params){.n = 6, .strength = 0.02, .angle = angle * acos(-1) / 180};
  return q;
}

static double unlike_its_mirror(const crystal *c, const int axis) {
  double most = 0;
  CRYSTAL_CELLS(c, i, j, k, p) {
    int at[3] = {i, j, k};
    at[axis] = c->g.box.n[axis] - 1 - at[axis];
    const ptrdiff_t q = cf_box_at(&c->g.box, at[0], at[1], at[2]);
    most = fmax(most, fabs((double)(c->y.eta.at[p] - c->y.eta.at[q])));
    most = fmax(most, fabs((double)(c->y.T.at[p] - c->y.T.at[q])));
  }
  return most;
}

static void crystal_in_the_plane_is_its_mirror_image_to_the_bit(void **state) {
  (void)state;
  for (int memory = 0; memory < 2; ++memory) {
    const cf_phase_params q = snow(memory, 0);
    crystal c;
    crystal_make(&c, 2, (int[3]){96, 96, 1}, 0.03, &q, NULL, false, 1);
    crystal_ball(&c, 0.12, q.width, -1);
    crystal_grow(&c, 1e-4, 600);
    assert_true(unlike_its_mirror(&c, 0) == 0 && unlike_its_mirror(&c, 1) == 0);
    crystal_free(&c);
  }
}

static void crystal_in_space_is_its_mirror_image_to_the_bit(void **state) {
  (void)state;
  cf_phase_params q = snow(1, 0);
  q.star = 0.5;
  crystal c;
  crystal_make(&c, 3, (int[3]){32, 32, 20}, 0.03, &q, NULL, false, 1);
  crystal_ball(&c, 0.12, q.width, -1);
  crystal_grow(&c, 8e-5, 150);
  for (int a = 0; a < 3; ++a) assert_true(unlike_its_mirror(&c, a) == 0);
  crystal_free(&c);
}

static void implicit_crystal_is_its_mirror_image_to_its_tolerance(void **state) {
  (void)state;
  const cf_phase_params q = snow(1, 0);
  crystal c;
  cf_cell h;
  crystal_make(&c, 2, (int[3]){96, 96, 1}, 0.03, &q, NULL, true, 1);
  OK(cf_cell_create(&h, &c.g.box));
  crystal_ball(&c, 0.4, q.width, -0.5);
  CRYSTAL_CELLS(&c, i, j, k, p) h.at[p] = c.y.T.at[p] - (cf_real)q.latent * c.y.eta.at[p];
  for (int s = 0; s < 60; ++s) {
    cf_solve_report report;
    OK(cf_phase_step_implicit(c.p, 0, 1.5e-4, &(cf_phase_heat){h, h, 0}, c.y.eta, c.y.r, &report));
    assert_true(report.converged);
  }
  BELOW(unlike_its_mirror(&c, 0), 1e-6);
  BELOW(unlike_its_mirror(&c, 1), 1e-6);
  cf_cell_destroy(&h, &c.g.box);
  crystal_free(&c);
}

static void crystal_has_the_same_bits_for_any_number_of_threads(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; ++dim) {
    const cf_phase_params q = snow(1, 10);
    const int n[3] = {dim == 2 ? 120 : 40, dim == 2 ? 100 : 36, 24};
    crystal c[3];
    for (int t = 0; t < 3; ++t) {
      crystal_make(&c[t], dim, n, 0.03, &q, NULL, false, t + 1);
      crystal_ball(&c[t], 0.15, q.width, -1);
      crystal_grow(&c[t], 8e-5, dim == 2 ? 200 : 60);
    }
    CRYSTAL_CELLS(&c[0], i, j, k, p)
    for (int t = 1; t < 3; ++t)
      assert_true(c[0].y.eta.at[p] == c[t].y.eta.at[p] && c[0].y.T.at[p] == c[t].y.T.at[p] &&
                  c[0].y.r.at[p] == c[t].y.r.at[p]);
    assert_true(cf_phase_energy(c[0].p, &c[0].y) == cf_phase_energy(c[2].p, &c[2].y));
    for (int t = 0; t < 3; ++t) crystal_free(&c[t]);
  }
}

/* Turned by 15 degrees it grows turned by 15 degrees, as large, and with no more of the grid's four folds. */
static void grow_turned(const cf_phase_form form, const double theta, const double angle, double six[2],
                        double *four) {
  cf_phase_params q = snow(theta, angle);
  crystal c;
  double phase;
  q.form = form;
  crystal_make(&c, 2, (int[3]){128, 128, 1}, 0.03, &q, NULL, false, 1);
  crystal_ball(&c, 0.12, q.width, -1);
  const cf_phase_limits l = cf_phase_limits_of(c.p);
  const double dt = fmin(1.5e-4, 0.95 * l.both), end = theta > 1 ? 0.15 : 0.1;
  crystal_grow(&c, dt, (int)(end / dt));
  six[0] = crystal_harmonic(&c, 6, &phase);
  six[1] = phase;
  *four = crystal_harmonic(&c, 4, NULL);
  crystal_free(&c);
}

static void crystal_turned_by_15_degrees_grows_turned_by_15_degrees(void **state) {
  (void)state;
  for (int i = 0; i < 3; ++i) {
    const double theta = i == 0 ? 0 : i == 1 ? 1 : 10;
    double straight[2], turned[2], four[2];
    grow_turned(CF_PHASE_STABLE, theta, 0, straight, &four[0]);
    grow_turned(CF_PHASE_STABLE, theta, 15, turned, &four[1]);
    print_message("theta %g: six folds %.3f at %.2f, %.3f at %.2f; four folds %.4f, %.4f\n", theta,
                  straight[0], straight[1], turned[0], turned[1], four[0], four[1]);
    CLOSE(straight[1], 0, 0.5);
    CLOSE(turned[1], 15, 0.5);
    CLOSE(turned[0] / straight[0], 1, 0.04);
    BELOW(four[0], 0.03);
    BELOW(four[1], 0.03);
    assert_true(straight[0] > 0.2);
  }
}

/* The paper's form at tau_1 = 10 tau_eta: the same crystal, turned, has several times the four folds. */
static void paper_form_with_much_memory_feels_the_grid(void **state) {
  (void)state;
  double straight[2], turned[2], four[2], stable[2], four_stable;
  grow_turned(CF_PHASE_PAPER, 10, 0, straight, &four[0]);
  grow_turned(CF_PHASE_PAPER, 10, 15, turned, &four[1]);
  grow_turned(CF_PHASE_STABLE, 10, 15, stable, &four_stable);
  print_message("paper: six folds %.3f at %.2f, %.3f at %.2f; four folds %.4f, %.4f (stable %.4f)\n",
                straight[0], straight[1], turned[0], turned[1], four[0], four[1], four_stable);
  assert_true(four[1] > 4 * four_stable);
  assert_true(four[1] > 2 * four[0]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(crystal_in_the_plane_is_its_mirror_image_to_the_bit),
      cmocka_unit_test(crystal_in_space_is_its_mirror_image_to_the_bit),
      cmocka_unit_test(implicit_crystal_is_its_mirror_image_to_its_tolerance),
      cmocka_unit_test(crystal_has_the_same_bits_for_any_number_of_threads),
      cmocka_unit_test(crystal_turned_by_15_degrees_grows_turned_by_15_degrees),
      cmocka_unit_test(paper_form_with_much_memory_feels_the_grid),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
