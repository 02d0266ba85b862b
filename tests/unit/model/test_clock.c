/* SPDX-License-Identifier: MIT
 *
 * The clock of a run: steps land exactly on frames and on the end, with no step too many.
 */
#include <math.h>
#include <string.h>

#include "folders.h"
#include "model/sim.h"
#include "testing.h"

static const char *const scene_text =
    "cattaneo: 1\nmodel: tracer\ndomain: {size: [1, 1], cells: [8, 8]}\ntime: {end: 1, dt: 0.1, frames: 2}\n"
    "diffusion: {k: 0.01, tau: 1}\n";

typedef struct walk {
  int64_t steps, frames, planned;
  double last, shortest, longest;
  double frame_time[64];
} walk;

static walk walk_through(const char *end, const char *dt, const char *frames) {
  const char *folder = folder_fresh("clock");
  char path[2048], set[3][64];
  const char *sets[3] = {set[0], set[1], set[2]};
  cf_scene *scene;
  cf_sim *sim;
  walk w = {.shortest = INFINITY};
  file_write(folder, "scene.yaml", scene_text);
  snprintf(path, sizeof path, "%s/scene.yaml", folder);
  snprintf(set[0], 64, "time.end=%s", end);
  snprintf(set[1], 64, "time.dt=%s", dt);
  snprintf(set[2], 64, "time.frames=%s", frames);
  OK(cf_scene_read(&scene, path, 3, sets));
  OK(cf_sim_create(&sim, scene, 1));
  w.planned = cf_sim_frames(sim);
  w.frames = 1;
  while (!cf_sim_finished(sim)) {
    bool on_frame;
    OK(cf_sim_step(sim, &on_frame));
    w.shortest = fmin(w.shortest, sim->dt);
    w.longest = fmax(w.longest, sim->dt);
    if (on_frame) w.frame_time[w.frames++] = sim->time;
    ++w.steps;
    assert_true(w.steps < 1000);
  }
  w.last = sim->time;
  assert_int_equal(w.frames, sim->frame + 1);
  cf_sim_destroy(sim);
  cf_scene_destroy(scene);
  return w;
}

static void frames_are_at_multiples_and_the_last_is_the_end(void **state) {
  (void)state;
  const walk w = walk_through("1", "0.1", "2");
  assert_int_equal(w.planned, 3);
  assert_int_equal(w.frames, 3);
  assert_int_equal(w.steps, 10);
  assert_true(w.frame_time[1] == 0.5 && w.frame_time[2] == 1 && w.last == 1);
}

static void an_end_between_frames_is_one_more_frame(void **state) {
  (void)state;
  const walk w = walk_through("1.25", "0.1", "2");
  assert_int_equal(w.frames, 4);
  assert_int_equal(w.planned, 4);
  assert_true(w.frame_time[2] == 1 && w.frame_time[3] == 1.25);
}

static void end_times_frames_is_whole_to_one_in_a_thousand_million(void **state) {
  (void)state;
  assert_int_equal(walk_through("1.8", "0.01", "10/1.8").frames, 11);
  assert_int_equal(walk_through("0.7", "0.1", "10").frames, 8);
}

static void steps_are_shortened_to_land_and_a_remainder_is_no_step(void **state) {
  (void)state;
  walk w = walk_through("1", "0.3", "2");
  assert_int_equal(w.steps, 4);
  CLOSE(w.shortest, 0.2, 1e-12);
  w = walk_through("1", "1/3", "0"); /* three thirds leave less than 1e-9 dt */
  assert_int_equal(w.steps, 3);
  w = walk_through("0.9", "0.1", "0");
  assert_int_equal(w.steps, 9);
  assert_true(w.last == 0.9);
}

static void without_a_rate_there_is_a_first_and_a_last_frame(void **state) {
  (void)state;
  const walk w = walk_through("1", "0.25", "0");
  assert_int_equal(w.frames, 2);
  assert_int_equal(w.planned, 2);
}

static void an_automatic_step_is_finite_and_lands_too(void **state) {
  (void)state;
  const walk w = walk_through("1", "auto", "3");
  assert_int_equal(w.frames, 4);
  assert_true(w.longest <= 0.5 * 0.125 / 0.1 + 1e-12); /* cfl h/c */
  assert_true(w.last == 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(frames_are_at_multiples_and_the_last_is_the_end),
      cmocka_unit_test(an_end_between_frames_is_one_more_frame),
      cmocka_unit_test(end_times_frames_is_whole_to_one_in_a_thousand_million),
      cmocka_unit_test(steps_are_shortened_to_land_and_a_remainder_is_no_step),
      cmocka_unit_test(without_a_rate_there_is_a_first_and_a_last_frame),
      cmocka_unit_test(an_automatic_step_is_finite_and_lands_too),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
/* also in single precision */
