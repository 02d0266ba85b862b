/* SPDX-License-Identifier: MIT
 *
 * A box that follows the tip of a crystal: what is shown stands where the crystal is.
 */
#include "scene_run.h"

static const char *const text =
    "cattaneo: 1\nmodel: phase\n"
    "domain: {size: [1.92, 1.44], cells: [64, 48], origin: [0.5, 0]}\n"
    "time: {end: 0.1}\n"
    "phase:\n  anisotropy: {folds: 4, strength: 0.05}\n"
    "  seeds: [{center: [0.5, 0], radius: 0.2}]\n"
    "  mask: \"x < %s ? 1 : 0\"\n"
    "  window: {follow: x+, at: 0.5}\n";

/* Where eta passes 1/2 on the lowest row, farthest along x. */
static double front(const cf_view *v) {
  for (int i = v->shape[0] - 1; i > 0; --i) {
    const double here = (double)v->at[i * v->stride[0]], before = (double)v->at[(i - 1) * v->stride[0]];
    if (before >= 0.5 && here < 0.5) return v->place[0] + v->h * (i - 1 + (before - 0.5) / (before - here));
  }
  return NAN;
}

static void box_that_follows_is_shown_where_it_is(void **state) {
  (void)state;
  char scene[1024];
  scene_run r;
  cf_view v;
  snprintf(scene, sizeof scene, text, "10");
  scene_open(&r, "window", scene, 1);
  OK(cf_sim_field(r.sim, "eta", 0, &v));
  const double first = v.place[0];
  OK(cf_sim_run(r.sim, 0.1, NULL, NULL));
  OK(cf_sim_field(r.sim, "eta", 0, &v));
  const double moved = (v.place[0] - first) / v.h;
  assert_true(moved > 3);
  CLOSE(moved, round(moved), 1e-9);
  /* On the wall y = 0 eta is that of the lowest row: the tip is the front. */
  CLOSE(front(&v), scene_metric(&r, "tip_x"), 1e-4);
  scene_close(&r);
}

/* Where it may not grow, it does not, however the box has moved. */
static void mask_stays_where_it_is_when_the_box_moves(void **state) {
  (void)state;
  char scene[1024];
  scene_run r;
  snprintf(scene, sizeof scene, text, "1.7");
  scene_open(&r, "window", scene, 1);
  OK(cf_sim_run(r.sim, 0.1, NULL, NULL));
  CLOSE(scene_metric(&r, "tip_x"), 1.7, 0.04);
  scene_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(box_that_follows_is_shown_where_it_is),
      cmocka_unit_test(mask_stays_where_it_is_when_the_box_moves),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
