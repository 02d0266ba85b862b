/* SPDX-License-Identifier: MIT
 *
 * `points:` of a scene: where and when they begin, how many, and that they end where the flow has brought them.
 */
/* also in single precision */
#include "scene_run.h"

#define SINGLE (sizeof(cf_real) == sizeof(float))

static const cf_particles *points_of(const scene_run *r) {
  return cf_registry_find(&r->sim->registry, "points")->particles;
}

static double at(const cf_particles *p, const char *name, const int c, const int64_t i) {
  return (double)p->attribute[cf_particles_find(p, name)].at[c][i];
}

static const char *const wind =
    "cattaneo: 1\nmodel: tracer\ndomain: {size: [4, 1], cells: [64, 16], walls: {x-: open, x+: open}}\n"
    "time: {end: 1, dt: 0.05}\nvelocity: ['1', '0']\n";

static scene_run open_with(const char *points) {
  char text[2048];
  scene_run r;
  snprintf(text, sizeof text, "%spoints:\n%s", wind, points);
  scene_open(&r, "points", text, 1);
  return r;
}

static void points_begin_where_and_when_the_scene_says(void **state) {
  (void)state;
  scene_run r = open_with(
      "  - {shape: sphere, center: [1, 0.5], radius: 0.2, count: 1000}\n"
      "  - {shape: box, center: [0.5, 0.5], half: [0.125, 0.25], per_cell: 5}\n"
      "  - {shape: box, center: [0.5, 0.5], half: [0.1, 0.1], rate: 200, from: 0.2, to: 0.7}\n"
      "  - {where: 'x > 2 && x < 2.5', per_cell: 1, from: 0.5}\n");
  const cf_particles *p = points_of(&r);
  assert_int_equal(p->count, 1000 + 4 * 8 * 5);
  double left = 0;
  for (int64_t i = 0; i < p->count; ++i) {
    const double x = at(p, "position", 0, i), y = at(p, "position", 1, i);
    if (at(p, "source", 0, i) > 0) continue;
    BELOW(hypot(x - 1, y - 0.5), 0.2 + 1e-6);
    left += x < 1;
  }
  CLOSE(left, 500, 5); /* evenly */
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  p = points_of(&r);
  int count[4] = {0, 0, 0, 0};
  for (int64_t i = 0; i < p->count; ++i) {
    const int from = (int)at(p, "source", 0, i);
    const double born = at(p, "born", 0, i), x = at(p, "position", 0, i) - (1 - born);
    ++count[from];
    if (from == 0) BELOW(fabs(x - 1), 0.2 + 1e-5);
    if (from == 2) BELOW(fabs(x - 0.5), 0.1 + 1e-5);
    if (from == 2) assert_true(born >= 0.2 && born <= 0.7 + 1e-6);
    if (from == 3) CLOSE(born, 0.5, 1e-6);
    if (from == 3) BELOW(fabs(x - 2.25), 0.25 + 1e-5);
  }
  assert_int_equal(count[2], 100);
  assert_int_equal(count[3], 8 * 16);
  scene_close(&r);
}

/* 10 a cell of fluid, through the upper half of the wall, for 0.5 s: 8 cells high, 8 cells long. */
static void points_come_in_with_the_fluid_as_an_even_stream(void **state) {
  (void)state;
  scene_run r =
      open_with("  - {wall: x-, shape: box, center: [0, 1], half: [1, 0.5], per_cell: 10, to: 0.5}\n");
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  const cf_particles *p = points_of(&r);
  double mean = 0;
  CLOSE((double)p->count, 640, 30);
  for (int64_t i = 0; i < p->count; ++i) {
    const double x = at(p, "position", 0, i);
    assert_true(x >= 0.5 - 1e-5 && x <= 1 + 1e-5 && at(p, "position", 1, i) >= 0.5);
    mean += x / (double)p->count;
  }
  CLOSE(mean, 0.75, 0.02);
  scene_close(&r);
}

static void points_that_leave_are_counted(void **state) {
  (void)state;
  scene_run r = open_with("  - {where: 'x > 3', per_cell: 2}\n");
  OK(cf_sim_run(r.sim, 0.5, NULL, NULL));
  CLOSE(scene_metric(&r, "points") + scene_metric(&r, "points_left"), 16 * 16 * 2, 0);
  CLOSE(scene_metric(&r, "points"), 16 * 16, 16);
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  BELOW(scene_metric(&r, "points"), 17);
  scene_close(&r);
}

/* In a wind (1 + 3 t^2, 0) every point comes t + t^3 far; Simpson's rule has no error there. */
static void a_changing_wind_carries_them_as_far_as_it_blows(void **state) {
  (void)state;
  scene_run r;
  scene_open(&r, "gust",
             "cattaneo: 1\nmodel: tracer\ndomain: {size: [4, 1], cells: [64, 16], walls: open}\n"
             "time: {end: 1, dt: 0.25}\nvelocity: ['1 + 3*t^2', '0']\n"
             "points:\n  - {shape: box, center: [1, 0.5], half: [0.5, 0.25], count: 100}\n",
             1);
  double before = 0, after = 0;
  for (int64_t i = 0; i < 100; ++i) before += at(points_of(&r), "position", 0, i);
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  for (int64_t i = 0; i < 100; ++i) after += at(points_of(&r), "position", 0, i);
  CLOSE((after - before) / 100, 2, SINGLE ? 1e-5 : 1e-12);
  OK(cf_sim_show(r.sim));
  CLOSE(at(points_of(&r), "velocity", 0, 7), 4, SINGLE ? 1e-5 : 1e-12);
  scene_close(&r);
}

/* Points and a scalar that begin in the same place keep together in a flow that moves itself. */
static void points_follow_the_ink_they_began_in(void **state) {
  (void)state;
  scene_run r;
  cf_view phi;
  scene_open(&r, "drop",
             "cattaneo: 1\nmodel: flow\ndomain: {size: [1, 2], cells: [48, 96]}\n"
             "time: {end: 1, cfl: 0.7}\n"
             "fields: {phi: {initial: '(x - 0.5)^2 + (y - 1.5)^2 < 0.04 ? 1 : 0'}}\n"
             "flow: {gravity: [0, -1], buoyancy: {phi: -1}}\n"
             "points:\n  - {shape: sphere, center: [0.5, 1.5], radius: 0.2, count: 4000}\n",
             1);
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  OK(cf_sim_field(r.sim, "phi", 0, &phi));
  const cf_particles *p = points_of(&r);
  double points = 0, ink = 0, all = 0, in_ink = 0;
  for (int64_t n = 0; n < p->count; ++n) {
    const int i = (int)(at(p, "position", 0, n) * 48), j = (int)(at(p, "position", 1, n) * 48);
    points += at(p, "position", 1, n) / (double)p->count;
    in_ink += (double)phi.at[i * phi.stride[0] + j * phi.stride[1]] > 0.25;
  }
  for (int j = 0; j < 96; ++j)
    for (int i = 0; i < 48; ++i) {
      const double here = (double)phi.at[i * phi.stride[0] + j * phi.stride[1]];
      all += here;
      ink += here * (j + 0.5) / 48;
    }
  print_message("points at %.4f m, ink at %.4f m; %.1f %% of the points in it\n", points, ink / all,
                100 * in_ink / (double)p->count);
  BELOW(points, 1.35);
  CLOSE(points, ink / all, 0.005);
  BELOW(0.95 * (double)p->count, in_ink);
  scene_close(&r);
}

static void refused(const char *points, const char *word) {
  char text[2048];
  cf_scene *scene;
  cf_sim *sim;
  snprintf(text, sizeof text, "%spoints:\n%s", wind, points);
  cf_status s = cf_scene_read(&scene, scene_path("refused", text), 0, NULL);
  if (s == CF_OK) {
    s = cf_sim_create(&sim, scene, 1);
    cf_scene_destroy(scene);
  }
  assert_int_equal(s, CF_BAD_SCENE);
  if (strstr(cf_status_sentence(), word) == NULL) fail_msg("%s", cf_status_sentence());
}

static void what_cannot_be_seeded_is_told(void **state) {
  (void)state;
  refused("  - {shape: box, center: [1, 0.5], half: [1, 1]}\n", "count, per_cell or rate");
  refused("  - {count: 1, rate: 2}\n", "twice");
  refused("  - {shape: sphere, count: 1}\n", "needs center");
  refused("  - {wall: z-, per_cell: 1}\n", "is no wall");
  refused("  - {wall: x-, count: 1}\n", "needs per_cell");
  refused("  - {where: '0', count: 1}\n", "no place");
  refused("  - {shape: sphere, center: [9, 9], radius: 1, per_cell: 1}\n", "no place");
  refused("  - {count: 5, to: 3}\n", "rate or wall");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(points_begin_where_and_when_the_scene_says),
      cmocka_unit_test(points_come_in_with_the_fluid_as_an_even_stream),
      cmocka_unit_test(points_that_leave_are_counted),
      cmocka_unit_test(a_changing_wind_carries_them_as_far_as_it_blows),
      cmocka_unit_test(points_follow_the_ink_they_began_in),
      cmocka_unit_test(what_cannot_be_seeded_is_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
