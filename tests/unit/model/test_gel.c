/* SPDX-License-Identifier: MIT
 *
 * Model gel as a whole: what turns takes its saturation along, what is dropped comes to rest and is pressed as much as
 * its weight says, momenta are kept while water moves.
 */
#include <math.h>

#include "model/gel_part.h"
#include "scene_run.h"

static cf_gel *gel_of(const scene_run *r) { return r->sim->state; }

/* S of every particle, by its id. */
static void saturations(const scene_run *r, double *S) {
  const cf_gel *g = gel_of(r);
  OK(cf_gel_show(gel_of(r)));
  for (int64_t i = 0; i < g->set->count; ++i)
    S[g->set->id[i]] = (double)g->set->attribute[g->saturation].at[0][i];
}

/* --- turning ----------------------------------------------------------------------------------------------- */

enum { SPINNING_MOST = 8192 };
static double still[SPINNING_MOST], spun[SPINNING_MOST], begun[SPINNING_MOST];

/* Saturations at the end of a run of a disc with a wet spot off its middle. Returns how many. */
static int64_t spin_disc(const int cells, const double spin, double *S) {
  char text[1024];
  scene_run r;
  snprintf(
      text, sizeof text,
      "cattaneo: 1\nmodel: gel\ndomain: {size: [1, 1], cells: [%d, %d]}\ntime: {end: 0.3, dt: %.17g}\n"
      "diffusion: {k: 0.02, tau: 0.3, f_t: 0}\n"
      "gel:\n  bodies:\n    - {shape: ball, center: [0.503, 0.497], radius: 0.3, young: 800, swelling: 0,\n"
      "       saturation: \"0.2 + 0.6*exp(-((x-0.62)^2 + (y-0.5)^2)/0.01)\", spin: %g}\n",
      cells, cells, 0.015 / cells, spin);
  scene_open(&r, "spin", text, 1);
  if (begun[0] == 0) saturations(&r, begun);
  const double angular = scene_metric(&r, "angular_z"), kinetic = scene_metric(&r, "kinetic");
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  saturations(&r, S);
  BELOW(fabs(scene_metric(&r, "error_water")), 1e-12);
  CLOSE(scene_metric(&r, "angular_z"), angular, 1e-11 * (1 + fabs(angular)));
  BELOW(fabs(scene_metric(&r, "momentum_x")), 1e-11 * (1 + kinetic));
  const int64_t count = gel_of(&r)->set->count;
  assert_in_range(count, 500, SPINNING_MOST);
  scene_close(&r);
  return count;
}

static double rms(const int64_t n, const double *a, const double *b) {
  double sum = 0;
  for (int64_t i = 0; i < n; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sqrt(sum / (double)n);
}

/* The front of Cattaneo's law in a disc that has turned by more than a radian is where it is in one at rest, the better the
 * finer the cells. */
static void saturation_of_a_spinning_gel_is_that_of_one_at_rest(void **state) {
  (void)state;
  double off[2];
  for (int v = 0; v < 2; ++v) {
    begun[0] = 0;
    const int64_t n = spin_disc(24 << v, 0, still);
    assert_int_equal(spin_disc(24 << v, 4, spun), n);
    off[v] = rms(n, spun, still) / rms(n, still, begun);
    print_message("%d cells: off by %.4f of the change\n", 24 << v, off[v]);
  }
  BELOW(off[1], 0.02);
  BELOW(off[1], 0.6 * off[0]);
}

/* --- falling ----------------------------------------------------------------------------------------------- */

/* Drops a block of height 1/2 and waits; how much of its volume is gone then. */
static double pressed_by_weight(const int cells) {
  char text[1024];
  scene_run r;
  snprintf(text, sizeof text,
           "cattaneo: 1\nmodel: gel\ndomain: {size: [1, 1], cells: [%d, %d]}\ntime: {end: 4}\n"
           "diffusion: {k: 0.01, tau: 0.2, f_t: 0.1}\n"
           "gel:\n  bodies:\n    - {shape: box, center: [0.5, 0.35], half: [0.1875, 0.25], young: 400, "
           "poisson: 0.3,\n"
           "       swelling: 0, saturation: \"y\", solid_density: 10, porosity: 0.7}\n"
           "  gravity: [0, -10]\n  damping: 4\n",
           cells, cells);
  scene_open(&r, "drop", text, 1);
  const double whole = scene_metric(&r, "volume");
  double fastest = 0, lowest = 1;
  while (!cf_sim_finished(r.sim)) {
    OK(cf_sim_step(r.sim, NULL));
    fastest = fmax(fastest, scene_metric(&r, "kinetic"));
  }
  const double pressed = 1 - scene_metric(&r, "volume") / whole;
  BELOW(scene_metric(&r, "kinetic"), 1e-6 * fastest);
  BELOW(fabs(scene_metric(&r, "error_water")), 1e-12);
  const cf_gel *g = gel_of(&r);
  for (int64_t i = 0; i < g->set->count; ++i)
    lowest = fmin(lowest, (double)g->set->attribute[g->at.position].at[1][i]);
  BELOW(fabs(lowest), 1.0 / cells);
  scene_close(&r);
  return pressed;
}

/* On a floor without friction it bears sigma = rho g (H - y), and its volume falls by (1 + nu)(1 - 2 nu)/E rho g H/2 in the
 * plane. A floor pushes about a cell behind its surface, so errors are of first order; what they extrapolate to is
 * not. Water moves meanwhile, and none is lost. */
static void dropped_gel_comes_to_rest_pressed_by_its_weight(void **state) {
  (void)state;
  const double nu = 0.3, rho = 3, weight = (1 + nu) * (1 - 2 * nu) / 400 * rho * 10 * 0.5 / 2;
  const double coarse = pressed_by_weight(16) / weight, fine = pressed_by_weight(32) / weight;
  print_message("pressed by %.4f and %.4f of what it should be, extrapolated %.4f\n", coarse, fine,
                2 * fine - coarse);
  CLOSE(fine, 1, 0.2);
  CLOSE(2 * fine - coarse, 1, 0.03);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(saturation_of_a_spinning_gel_is_that_of_one_at_rest),
      cmocka_unit_test(dropped_gel_comes_to_rest_pressed_by_its_weight),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
