/* SPDX-License-Identifier: MIT
 *
 * A blob in a rigidly turning medium (rotation_centred.csv, rotation_offset_objective.csv): with the objective rate
 * the medium's turning does not show, in either form of the flux; with the material one diffusion is slowed down.
 */
#include "reference.h"
#include "scene_run.h"

static void turn(scene_run *r, const char *diffusion, const char *more, const double from) {
  char text[2048];
  snprintf(text, sizeof text,
           "cattaneo: 1\n"
           "model: tracer\n"
           "let: {w: 3.14159265358979, a: %.17g}\n"
           "domain: {size: [2, 2], cells: [200, 200], origin: [-1, -1], walls: open}\n"
           "time: {end: 1, dt: 0.0025}\n"
           "diffusion: {k: 0.02, tau: 0.6, front_filter: off, %s}\n"
           "velocity: ['-w*y', 'w*x']\n"
           "advection: {scheme: weno5}\n"
           "fields: {phi: {initial: 'exp(-((x-a)^2+y^2)/(2*.08^2))'}%s}\n",
           from, diffusion, more);
  scene_open(r, "rotation", text, 2);
  OK(cf_sim_run(r->sim, INFINITY, NULL, NULL));
}

/* The largest error over the largest value, on the x axis and the diagonal. */
static double centred(const char *diffusion, const char *more, const char *column) {
  scene_run r;
  table t = table_read("rotation_centred.csv");
  double wrong = 0, most = 0;
  turn(&r, diffusion, more, 0);
  for (int i = 0; i < t.rows; ++i) {
    const double radius = table_at(&t, i, "r"), exact = table_at(&t, i, column);
    wrong = fmax(wrong, fabs(scene_at(&r, radius, 0) - exact));
    wrong = fmax(wrong, fabs(scene_at(&r, -radius * sqrt(0.5), radius * sqrt(0.5)) - exact));
    most = fmax(most, exact);
  }
  scene_close(&r);
  table_free(&t);
  return wrong / most;
}

static void the_objective_rate_does_not_see_the_turning(void **state) {
  (void)state;
  const double scalar = centred("scheme: sdirk2", "", "phi_objective");
  const double leaps = centred("scheme: leapfrog", "", "phi_objective");
  const double faces = centred("scheme: sdirk2", ", q: {}", "phi_objective");
  print_message("centred, objective: scalar form %.4f (leapfrog %.4f), faces %.4f\n", scalar, leaps, faces);
  BELOW(scalar, 0.01);
  BELOW(leaps, 0.01);
  BELOW(faces, 0.02);
}

static void the_material_rate_does(void **state) {
  (void)state;
  const double own = centred("scheme: sdirk2, flux_rate: material", "", "phi_material_derivative");
  const double other = centred("scheme: sdirk2, flux_rate: material", "", "phi_objective");
  print_message("centred, material: %.4f of its own solution, %.4f of the objective one\n", own, other);
  BELOW(own, 0.02);
  assert_true(other > 1);
}

static void a_blob_off_the_axis_arrives_as_at_rest(void **state) {
  (void)state;
  scene_run r;
  table t = table_read("rotation_offset_objective.csv");
  double wrong = 0, most = 0;
  turn(&r, "scheme: default", "", table_at(&t, 0, "ex"));
  for (int i = 0; i < t.rows; ++i) {
    wrong =
        fmax(wrong, fabs(scene_at(&r, table_at(&t, i, "x"), table_at(&t, i, "y")) - table_at(&t, i, "phi")));
    most = fmax(most, table_at(&t, i, "phi"));
  }
  print_message("off the axis: %.4f of the largest value (%s)\n", wrong / most, scene_says(&r, 0));
  BELOW(wrong / most, 0.01);
  scene_close(&r);
  table_free(&t);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(the_objective_rate_does_not_see_the_turning),
                                     cmocka_unit_test(the_material_rate_does),
                                     cmocka_unit_test(a_blob_off_the_axis_arrives_as_at_rest)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
