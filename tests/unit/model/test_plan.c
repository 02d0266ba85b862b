/* SPDX-License-Identifier: MIT
 *
 * Which scheme a scene gets and how its flux is kept: from the scene and dt alone, with a word on why.
 */
#include "scene_run.h"

/* The plan's words for a scene of 64^2 cells, h = 1/64. */
static const char *plan(const char *time, const char *diffusion, const char *rest) {
  static char says[512];
  char text[2048];
  scene_run r;
  snprintf(text, sizeof text,
           "cattaneo: 1\nmodel: tracer\ndomain: {size: [1, 1], cells: [64, 64]}\ntime: {end: 1, "
           "%s}\ndiffusion: {%s}\n%s",
           time, diffusion, rest);
  scene_open(&r, "plan", text, 1);
  snprintf(says, sizeof says, "%s", scene_says(&r, 0));
  scene_close(&r);
  return says;
}

#define SAYS(text, words)                                                             \
  do {                                                                                \
    const char *says_ = text;                                                         \
    if (strstr(says_, words) == NULL) fail_msg("\"%s\" has no \"%s\"", says_, words); \
  } while (0)

static void waves_are_followed_explicitly(void **state) {
  (void)state;
  SAYS(plan("dt: 1/64", "front_speed: 1, tau: 1", ""), "leapfrog, 2 explicit substeps");
  SAYS(plan("dt: 1/128", "front_speed: 1, tau: 1", ""), "leapfrog, 1 explicit substep a step");
}

static void what_explicit_steps_would_cost_too_much_is_implicit(void **state) {
  (void)state;
  SAYS(plan("dt: 1", "front_speed: 1, tau: 1", ""), "sdirk2, two implicit stages");
  SAYS(plan("dt: 1/64", "k: 1, tau: 1e-6", ""), "times as much");
  SAYS(plan("dt: 1/64", "k: 1", ""), "Fourier's law has no waves");
  SAYS(plan("dt: 1/64", "k: 1, tau: 1, f_t: 1", ""), "Fourier's law has no waves");
  SAYS(plan("dt: 1/64", "k: 1, tau: 1, f_t: 0.3", ""), "Fourier's part");
}

static void what_does_not_diffuse_is_not_solved_for(void **state) {
  (void)state;
  SAYS(plan("dt: 1/64", "k: 0, tau: 1", ""), "leapfrog, 1 explicit substep a step: nothing diffuses");
  SAYS(plan("dt: 1/64", "k: 0, tau: 0, f_t: 0.5", ""),
       "leapfrog, 1 explicit substep a step: nothing diffuses");
}

static void frames_shorten_the_step_that_is_planned_for(void **state) {
  (void)state;
  SAYS(plan("dt: 1, frames: 128", "front_speed: 1, tau: 1", ""), "leapfrog, 1 explicit substep a step");
}

static void a_scheme_that_is_named_is_taken(void **state) {
  (void)state;
  SAYS(plan("dt: 1/64", "front_speed: 1, tau: 1, scheme: sdirk2", ""), "sdirk2, two");
  SAYS(plan("dt: 1/64", "front_speed: 1, tau: 1, scheme: paper", ""), "paper, one stage");
  SAYS(plan("dt: 1/64", "front_speed: 1, tau: 1, scheme: wave", ""), "wave, 2 explicit substeps");
  SAYS(plan("dt: 1", "front_speed: 1, tau: 1, scheme: leapfrog", ""), "leapfrog, 96 explicit");
  SAYS(plan("dt: 1/64", "front_speed: 1, tau: 1, positivity: on", ""), "limited to |q| <= c phi");
}

static void nobody_asks_for_q_then_its_divergence_will_do(void **state) {
  (void)state;
  const char *const scalar = "kept as its divergence", *const waves = "front_speed: 1, tau: 1";
  const char *const faces[] = {
      "fields: {phi: {}, q: {}}\n",
      "output: {fields: [phi, q]}\n",
      "sources: [{field: q, shape: everywhere, rate: ['1', '0']}]\n",
      "fields: {phi: {walls: {x-: radiate}}}\n",
  };
  SAYS(plan("dt: 1/64", waves, ""), scalar);
  SAYS(plan("dt: 1/64", "front_speed: 1, tau: 1, scheme: sdirk2", ""), scalar);
  for (int i = 0; i < 4; ++i) assert_null(strstr(plan("dt: 1/64", waves, faces[i]), scalar));
  SAYS(plan("dt: 1/64", "front_speed: 1, tau: 1, flux_rate: material", ""),
       scalar); /* at rest: all the same */
  assert_null(strstr(
      plan("dt: 1/64", "front_speed: 1, tau: 1, flux_rate: material", "velocity: ['sin(pi*x)', '0']\n"),
      scalar));
  assert_null(
      strstr(plan("dt: 1/64", waves, "velocity: ['sin(pi*x)', '0']\nadvection: {scheme: cubic}\n"), scalar));
  SAYS(plan("dt: 1/64", waves, "velocity: ['sin(pi*x)', '0']\n"), scalar);
}

/* --- errors ----------------------------------------------------------------------------------------------- */

static void refused(const char *diffusion, const char *place, const char *words) {
  char text[1024];
  cf_scene *scene;
  snprintf(
      text, sizeof text,
      "cattaneo: 1\nmodel: tracer\ndomain: {size: [1, 1], cells: [8, 8]}\ntime: {end: 1}\ndiffusion: {%s}\n",
      diffusion);
  assert_int_equal(cf_scene_read(&scene, scene_path("plan_refused", text), 0, NULL), CF_BAD_SCENE);
  const char *says = cf_status_sentence();
  if (strstr(says, place) == NULL || strstr(says, words) == NULL)
    fail_msg("%s\n(no %s, or no %s)", says, place, words);
}

static void a_scheme_that_cannot_is_an_error_at_the_key(void **state) {
  (void)state;
  refused("k: 1, tau: 1, f_t: 0.1, scheme: wave", "yaml:5:", "diffusion.f_t must be 0 with scheme: wave");
  refused("k: 1, scheme: wave", "yaml:5:", "diffusion.tau must be above 0");
  refused("k: 1+x, tau: 1, scheme: wave", "yaml:5:", "diffusion.k must be one number");
  refused("k: 1, tau: 1, scheme: sdirk2, positivity: on", "yaml:5:", "goes with scheme: default or leapfrog");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(waves_are_followed_explicitly),
      cmocka_unit_test(what_explicit_steps_would_cost_too_much_is_implicit),
      cmocka_unit_test(what_does_not_diffuse_is_not_solved_for),
      cmocka_unit_test(frames_shorten_the_step_that_is_planned_for),
      cmocka_unit_test(a_scheme_that_is_named_is_taken),
      cmocka_unit_test(nobody_asks_for_q_then_its_divergence_will_do),
      cmocka_unit_test(a_scheme_that_cannot_is_an_error_at_the_key),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
