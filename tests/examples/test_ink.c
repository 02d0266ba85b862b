/* SPDX-License-Identifier: MIT
 *
 * examples/ink: the ledger of the ink, the divergence of the water, and the front, on the example's own scenes.
 */
#include "example.h"

/* The highest cell on the axis with a tenth of the largest value. */
static double front(const cf_view *v) {
  double largest = 0, top = 0;
  const int i = v->shape[0] / 2, k = v->shape[2] / 2;
  for (int j = 0; j < v->shape[1]; ++j) largest = fmax(largest, view_at(v, i, j, k));
  for (int j = 0; j < v->shape[1]; ++j)
    if (view_at(v, i, j, k) > 0.1 * largest) top = view_x(v, 1, j);
  return top;
}

static double largest_after(const char *const *set, const double until) {
  example e = example_open("ink/scene.yaml", set);
  example_run(&e, until);
  const cf_view phi = example_field(&e, "phi", 0);
  const double error = example_metric(&e, "error_phi"), most = example_metric(&e, "max_phi");
  const double divergence = example_metric(&e, "divergence") * phi.h, top = front(&phi);
  print_message("ledger %.1e, divergence %.1e, front at %.2f m, largest value %.3f\n", error, divergence, top,
                most);
  BELOW(fabs(error), 1e-13);
  BELOW(divergence, 1e-3);
  BELOW(2, top);
  BELOW(top, 2 + until);
  /* 50 a second in a cube of an eighth of a metre, and nothing has left. */
  CLOSE(example_metric(&e, "sum_phi"), 50 * until / 512, 1e-9);
  example_close(&e);
  return most;
}

static void the_jet_keeps_its_promises(void **state) {
  (void)state;
  const double cattaneo = largest_after(NULL, 1.5);
  const double fourier = largest_after((const char *const[]){"diffusion.tau=0", NULL}, 1.5);
  assert_true(fourier < cattaneo);
}

static void the_drop_sinks_and_keeps_its_ink(void **state) {
  (void)state;
  example e = example_open("ink/drop.yaml",
                           (const char *const[]){"domain.cells=[24, 48, 24]", "points.0.count=1000", NULL});
  const double first = example_metric(&e, "sum_phi");
  example_run(&e, 0.4);
  const cf_view phi = example_field(&e, "phi", 0);
  double sum = 0, height = 0;
  for (int k = 0; k < phi.shape[2]; ++k)
    for (int j = 0; j < phi.shape[1]; ++j)
      for (int i = 0; i < phi.shape[0]; ++i) {
        sum += view_at(&phi, i, j, k);
        height += view_x(&phi, 1, j) * view_at(&phi, i, j, k);
      }
  print_message("centre of the ink at %.2f mm\n", 1e3 * height / sum);
  BELOW(height / sum, 0.033);
  BELOW(0.022, height / sum);
  CLOSE(example_metric(&e, "sum_phi"), first, 1e-12 * first);
  example_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_jet_keeps_its_promises),
      cmocka_unit_test(the_drop_sinks_and_keeps_its_ink),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
