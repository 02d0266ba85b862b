/* SPDX-License-Identifier: MIT
 *
 * examples/slalom: a front goes around plates at its own speed c. The shortest way from the warm wall to a point behind
 * all of them, over the tips of the plates, is 2.47 m long: before t = 2.47 s there is nothing, while Fourier's law has
 * been there all along. Nothing is lost or made on the way.
 */
#include "example.h"

static double value_at(const example *e, const char *field, const double x, const double y) {
  const cf_view v = example_field(e, field, 0);
  const int i = (int)((x - v.place[0]) / v.h + 0.5), j = (int)((y - v.place[1]) / v.h + 0.5);
  return (double)v.at[i * v.stride[0] + j * v.stride[1]];
}

static void the_front_comes_when_its_way_is_done(void **state) {
  (void)state;
  example e = example_open("slalom/scene.yaml",
                           (const char *const[]){"domain.cells=[120, 60]", "time.dt=0.008", NULL});
  example_run(&e, 2);
  const double early = value_at(&e, "wave", 1.9, 0.9), at_once = value_at(&e, "fourier", 1.9, 0.9);
  example_run(&e, INFINITY);
  const double late = value_at(&e, "wave", 1.9, 0.9);
  print_message("behind all plates: front %.1e at t = 2, %.3f at t = 3.2; Fourier %.3f at t = 2\n", early,
                late, at_once);
  BELOW(fabs(early), 1e-3);
  assert_true(late > 0.01);
  assert_true(at_once > 0.03);
  BELOW(fabs(example_metric(&e, "error_wave")), 1e-12);
  BELOW(fabs(example_metric(&e, "error_fourier")), 1e-12);
  example_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(the_front_comes_when_its_way_is_done)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
