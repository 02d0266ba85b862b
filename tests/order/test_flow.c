/* SPDX-License-Identifier: MIT
 *
 * The flow against flows that are known: Taylor and Green's whirls, at rest and carried along, with and without
 * viscosity; layers that are heavier above than below, whose growth is known mode by mode; two fluids one above the
 * other (Rayleigh, Taylor).
 */
#include "scene_run.h"

#define PI 3.14159265358979323846

/* --- Taylor, Green ---------------------------------------------------------------------------------------- */

/* Mean error of u along x at t = 0.5, for whirls of speed 1 carried with (U, U/2). */
static double whirls(const int n, const double nu, const double U) {
  char text[1024];
  scene_run r;
  cf_view u;
  double sum = 0;
  snprintf(text, sizeof text,
           "cattaneo: 1\nmodel: flow\n"
           "domain: {size: [1, 1], cells: [%d, %d], walls: periodic}\n"
           "time: {end: 0.5, dt: %.17g}\n"
           "velocity: ['%g + sin(2*pi*x)*cos(2*pi*y)', '%g - cos(2*pi*x)*sin(2*pi*y)']\n"
           "flow: {viscosity: %g}\nsolver: {tolerance: 1e-8}\n",
           n, n, 0.5 / n, U, U / 2, nu);
  scene_open(&r, "whirls", text, 1);
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  OK(cf_sim_field(r.sim, "velocity", 0, &u));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double x = (double)i / n - U * 0.5, y = (j + 0.5) / n - U * 0.25;
      const double exact = U + sin(2 * PI * x) * cos(2 * PI * y) * exp(-8 * PI * PI * nu * 0.5);
      sum += fabs((double)u.at[i * u.stride[0] + j * u.stride[1]] - exact);
    }
  BELOW(scene_metric(&r, "divergence"), 1e-6);
  scene_close(&r);
  return sum / n / n;
}

static void order_of(const double nu, const double U, const double least, const double error) {
  const double coarse = whirls(32, nu, U), fine = whirls(64, nu, U);
  print_message("nu = %g, U = %g: %.2e, %.2e, order %.2f\n", nu, U, coarse, fine, log2(coarse / fine));
  BELOW(fine, error);
  BELOW(least, log2(coarse / fine));
}

static void whirls_decay_with_second_order(void **state) {
  (void)state;
  order_of(0.01, 0, 1.9, 2e-5);
  order_of(0, 0, 1.9, 5e-4);
}

/* An observer who moves sees the same flow. */
static void whirls_that_are_carried_along_do_too(void **state) {
  (void)state;
  order_of(0.01, 1, 1.9, 1e-3);
  order_of(0, 1, 1.7, 3e-3);
}

/* --- layers ----------------------------------------------------------------------------------------------- */

/* phi = y makes the fluid heavier upwards at a rate N^2 = -1 (gravity 1, buoyancy -1): a mode cos(kx) sin(ly) grows with
 * sigma^2 = k^2/(k^2 + l^2), exactly as long as it is small. */
static void unstable_layers_grow_at_the_known_rate(void **state) {
  (void)state;
  scene_run r;
  scene_open(&r, "layers",
             "cattaneo: 1\nmodel: flow\n"
             "domain: {size: [1, 1], cells: [48, 48]}\n"
             "time: {end: 5, dt: 0.02}\n"
             "advection: {scheme: weno5}\n"
             "fields: {phi: {initial: y}}\n"
             "velocity: ['-1e-5*sin(2*pi*x)*cos(pi*y)/2', '1e-5*cos(2*pi*x)*sin(pi*y)']\n"
             "flow: {gravity: [0, -1], buoyancy: {phi: -1}}\nsolver: {tolerance: 1e-8}\n",
             1);
  const double sigma = sqrt(4.0 / 5);
  OK(cf_sim_run(r.sim, 2.5, NULL, NULL));
  const double first = scene_metric(&r, "kinetic_energy");
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  const double rate = log(scene_metric(&r, "kinetic_energy") / first) / 5;
  /* From rest in phi the energy is cosh^2(sigma t), which is exp(2 sigma t)/4 but for a little. */
  const double exact = log(cosh(5 * sigma) / cosh(2.5 * sigma)) / 2.5;
  print_message("growth %.5f, exactly %.5f\n", rate, exact);
  CLOSE(rate, exact, 0.01 * exact);
  scene_close(&r);
}

/* Two fluids: sigma^2 = A g k tanh(k H/2), with 2 A the difference of phi; half as high waves at 64 cells a wave. */
static void heavy_over_light_grows_as_rayleigh_and_taylor_say(void **state) {
  (void)state;
  scene_run r;
  scene_open(
      &r, "two_fluids",
      "cattaneo: 1\nmodel: flow\n"
      "domain: {size: [1, 1], cells: [96, 96], origin: [0, -0.5], walls: {x-: periodic, x+: periodic}}\n"
      "time: {end: 2.5, dt: 0.0125}\n"
      "fields: {phi: {initial: 'y > 0 ? 1 : -1'}}\n"
      "velocity: ['1e-3*sin(2*pi*x)*exp(-2*pi*abs(y))*(y > 0 ? 1 : -1)', "
      "'1e-3*cos(2*pi*x)*exp(-2*pi*abs(y))']\n"
      "flow: {gravity: [0, -1], buoyancy: {phi: -0.5}}\n",
      1);
  const double k = 2 * PI, sigma = sqrt(0.5 * k * tanh(k / 2));
  OK(cf_sim_run(r.sim, 0.8, NULL, NULL));
  const double first = scene_metric(&r, "kinetic_energy");
  OK(cf_sim_run(r.sim, 1.6, NULL, NULL));
  const double rate = log(scene_metric(&r, "kinetic_energy") / first) / 1.6;
  const double exact = log(cosh(1.6 * sigma) / cosh(0.8 * sigma)) / 0.8;
  print_message("growth %.4f, for a sharp interface %.4f\n", rate, exact);
  CLOSE(rate, exact, 0.05 * exact);
  scene_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(whirls_decay_with_second_order),
      cmocka_unit_test(whirls_that_are_carried_along_do_too),
      cmocka_unit_test(unstable_layers_grow_at_the_known_rate),
      cmocka_unit_test(heavy_over_light_grows_as_rayleigh_and_taylor_say),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
