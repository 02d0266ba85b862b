/* SPDX-License-Identifier: MIT
 *
 * A simulation as a user of the library has it: the clock, runs to a time, the callback that stops them, fields by
 * name, warnings.
 */
/* also in single precision */
#include "model/sim.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "folders.h"
#include "testing.h"

static const char *const scene_text =
    "cattaneo: 1\n"
    "model: tracer\n"
    "domain: {size: [2, 1], cells: [16, 8], origin: [-1, 3]}\n"
    "time: {end: 1, dt: 0.03, frames: 4}\n"
    "diffusion: {k: 0.02, tau: 0.3}\n"
    "fields: {phi: {initial: 'x + 10*y', unit: kg/m^3}, q: {initial: ['100*y', '1000*x']}}\n"
    "velocity: ['sin(pi*y)*0', 0]\n";

static const char *scene_path(void) {
  static char path[1024];
  const char *folder = folder_fresh("sim");
  file_write(folder, "scene.yaml", scene_text);
  snprintf(path, sizeof path, "%s/scene.yaml", folder);
  return path;
}

typedef struct one {
  cf_scene *scene;
  cf_sim *sim;
} one;

static one open_with(const int overrides, const char *const *set) {
  one o;
  OK(cf_scene_read(&o.scene, scene_path(), overrides, set));
  OK(cf_sim_create(&o.sim, o.scene, 2));
  return o;
}

static one open_one(void) { return open_with(0, NULL); }

static void close_one(const one *o) {
  cf_sim_destroy(o->sim);
  cf_scene_destroy(o->scene);
}

static void a_run_lands_on_the_time_asked_for_and_on_the_end(void **state) {
  (void)state;
  const one o = open_one();
  assert_true(cf_sim_time(o.sim) == 0 && cf_sim_end(o.sim) == 1);
  OK(cf_sim_run(o.sim, 0.1, NULL, NULL));
  assert_true(cf_sim_time(o.sim) == 0.1);
  assert_int_equal(cf_sim_step_count(o.sim), 4);
  OK(cf_sim_run(o.sim, 0.05, NULL, NULL)); /* behind us: nothing */
  assert_int_equal(cf_sim_step_count(o.sim), 4);
  assert_false(cf_sim_finished(o.sim));
  OK(cf_sim_run(o.sim, INFINITY, NULL, NULL));
  assert_true(cf_sim_time(o.sim) == 1 && cf_sim_finished(o.sim));
  assert_int_equal(cf_sim_run(o.sim, NAN, NULL, NULL), CF_BAD_ARGUMENT);
  close_one(&o);
}

static void at_the_end_no_step_is_left(void **state) {
  (void)state;
  const one o = open_one();
  OK(cf_sim_run(o.sim, INFINITY, NULL, NULL));
  const int64_t steps = cf_sim_step_count(o.sim);
  assert_int_equal(cf_sim_step(o.sim, NULL), CF_FAILED);
  assert_non_null(strstr(cf_status_sentence(), "end"));
  assert_int_equal(cf_sim_step_count(o.sim), steps);
  close_one(&o);
}

static void steps_land_on_every_frame(void **state) {
  (void)state;
  const one o = open_one();
  int frames = 1;
  assert_int_equal(cf_sim_frames(o.sim), 5);
  while (!cf_sim_finished(o.sim)) {
    bool on_frame;
    OK(cf_sim_step(o.sim, &on_frame));
    if (on_frame) assert_true(cf_sim_time(o.sim) == cf_sim_frame_time(o.sim, frames++));
  }
  assert_int_equal(frames, 5);
  close_one(&o);
}

static bool stop_at_third(void *context, cf_sim *sim) {
  ++*(int *)context;
  return cf_sim_step_count(sim) < 3;
}

static void the_callback_stops_a_run_that_can_go_on(void **state) {
  (void)state;
  const one o = open_one(), whole = open_one();
  int calls = 0;
  assert_int_equal(cf_sim_run(o.sim, INFINITY, stop_at_third, &calls), CF_STOPPED);
  assert_int_equal(calls, 3);
  assert_int_equal(cf_sim_step_count(o.sim), 3);
  OK(cf_sim_run(o.sim, INFINITY, NULL, NULL));
  OK(cf_sim_run(whole.sim, INFINITY, NULL, NULL));
  cf_view a, b;
  OK(cf_sim_field(o.sim, "phi", 0, &a));
  OK(cf_sim_field(whole.sim, "phi", 0, &b));
  for (int j = 0; j < 8; ++j)
    assert_memory_equal(a.at + j * a.stride[1], b.at + j * b.stride[1], 16 * sizeof(cf_real));
  close_one(&o);
  close_one(&whole);
}

static void a_cell_field_is_seen_where_it_is(void **state) {
  (void)state;
  const one o = open_one();
  cf_view v;
  OK(cf_sim_field(o.sim, "phi", 0, &v));
  assert_true(v.shape[0] == 16 && v.shape[1] == 8 && v.shape[2] == 1 && v.staggered == -1);
  assert_string_equal(v.unit, "kg/m^3");
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 16; ++i) {
      const double x = v.place[0] + i * v.h, y = v.place[1] + j * v.h;
      CLOSE(v.at[i * v.stride[0] + j * v.stride[1]], x + 10 * y, 1e-5);
    }
  CLOSE(v.place[0], -1 + 1.0 / 16, 1e-15);
  v.at[v.stride[1]] = 7; /* it is the state, not a copy */
  OK(cf_sim_field(o.sim, "phi", 0, &v));
  assert_true(v.at[v.stride[1]] == 7);
  close_one(&o);
}

static void a_flux_is_seen_on_the_faces_of_its_axis(void **state) {
  (void)state;
  const one o = open_one();
  for (int a = 0; a < 2; ++a) {
    cf_view v;
    OK(cf_sim_field(o.sim, "q", a, &v));
    assert_int_equal(v.staggered, a);
    CLOSE(v.place[a], a == 0 ? -1 : 3, 0); /* the first faces are the wall */
    CLOSE(v.place[1 - a], (a == 0 ? 3 : -1) + v.h / 2, 1e-15);
    assert_int_equal(v.shape[0], a == 0 ? 17 : 16);
    assert_int_equal(v.shape[1], a == 1 ? 9 : 8);
    for (int j = 0; j < v.shape[1]; ++j)
      for (int i = 0; i < v.shape[0]; ++i) {
        const int n = a == 0 ? i : j, last = v.shape[a] - 1;
        const double x = v.place[0] + i * v.h, y = v.place[1] + j * v.h;
        const double wanted = n == 0 || n == last ? 0 : a == 0 ? 100 * y : 1000 * x; /* insulated walls */
        CLOSE(v.at[i * v.stride[0] + j * v.stride[1]], wanted, 1e-4);
      }
  }
  close_one(&o);
}

static void a_field_that_is_not_there_is_answered_with_those_that_are(void **state) {
  (void)state;
  const one o = open_one();
  cf_view v;
  assert_int_equal(cf_sim_field(o.sim, "psi", 0, &v), CF_BAD_ARGUMENT);
  assert_non_null(strstr(cf_status_sentence(), "phi, q"));
  assert_int_equal(cf_sim_field(o.sim, "time", 0, &v), CF_BAD_ARGUMENT);
  assert_int_equal(cf_sim_field(o.sim, "phi", 1, &v), CF_BAD_ARGUMENT);
  assert_int_equal(cf_sim_field(o.sim, "q", 2, &v), CF_BAD_ARGUMENT);
  assert_int_equal(cf_sim_field(o.sim, "q", -1, &v), CF_BAD_ARGUMENT);
  assert_string_equal(cf_sim_field_name(o.sim, 0), "phi");
  assert_string_equal(cf_sim_field_name(o.sim, 1), "q");
  int count = 0;
  while (cf_sim_field_name(o.sim, count) != NULL)
    OK(cf_sim_field(o.sim, cf_sim_field_name(o.sim, count++), 0, &v));
  assert_in_range(count, 2, 3);
  close_one(&o);
}

static void a_stalled_solve_is_a_warning_of_its_step(void **state) {
  (void)state;
  static const char *const set[] = {"solver.max_iterations=1", "solver.tolerance=1e-15", "diffusion.k=1",
                                    "domain.cells=[64, 32]", "diffusion.scheme=sdirk2"};
  const one o = open_with(5, set);
  OK(cf_sim_step(o.sim, NULL));
  /* one cycle comes so near that in single precision the rest is round-off, which passes */
  if (sizeof(cf_real) == sizeof(double)) assert_non_null(strstr(cf_sim_warning(o.sim), "solver.tolerance"));
  close_one(&o);
  const one calm = open_one();
  OK(cf_sim_step(calm.sim, NULL));
  assert_string_equal(cf_sim_warning(calm.sim), "");
  close_one(&calm);
}

static void a_flow_through_a_wall_is_a_warning_and_round_off_is_not(void **state) {
  (void)state;
  static const char *const closed[] = {"velocity=['sin(pi*x)', 0]", "fields.phi.walls=insulated"};
  static const char *const passes[] = {"velocity=['cos(pi*x)', 0]"};
  const one o = open_with(2, closed);
  OK(cf_sim_step(o.sim, NULL));
  assert_string_equal(cf_sim_warning(o.sim), "");
  close_one(&o);
  const one wind = open_with(1, passes);
  OK(cf_sim_step(wind.sim, NULL));
  assert_non_null(strstr(cf_sim_warning(wind.sim), "up to 1 m/s"));
  close_one(&wind);
}

static void no_threads_is_refused(void **state) {
  (void)state;
  cf_scene *scene;
  cf_sim *sim = (cf_sim *)&scene;
  OK(cf_scene_read(&scene, scene_path(), 0, NULL));
  assert_int_equal(cf_sim_create(&sim, scene, 0), CF_BAD_ARGUMENT);
  assert_null(sim);
  cf_scene_destroy(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_run_lands_on_the_time_asked_for_and_on_the_end),
      cmocka_unit_test(at_the_end_no_step_is_left),
      cmocka_unit_test(steps_land_on_every_frame),
      cmocka_unit_test(the_callback_stops_a_run_that_can_go_on),
      cmocka_unit_test(a_cell_field_is_seen_where_it_is),
      cmocka_unit_test(a_flux_is_seen_on_the_faces_of_its_axis),
      cmocka_unit_test(a_field_that_is_not_there_is_answered_with_those_that_are),
      cmocka_unit_test(a_stalled_solve_is_a_warning_of_its_step),
      cmocka_unit_test(a_flow_through_a_wall_is_a_warning_and_round_off_is_not),
      cmocka_unit_test(no_threads_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
