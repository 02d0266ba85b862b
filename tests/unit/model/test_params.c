/* SPDX-License-Identifier: MIT
 *
 * Every sufficient set of the keys that stand for k, tau and f_t gives the same k, tau and F_T; contradictions name
 * both keys.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "folders.h"
#include "model/scene.h"
#include "model/scene_params.h"
#include "testing.h"

/* One medium, and all that can be said of it. */
static const double k = 0.23, tau = 1.7, wind = 0.9, thickness = 0.8;

static cf_scene *read_diffusion(const char *diffusion, const char *velocity, cf_status *status) {
  static char text[2048], path[1024];
  const char *folder = folder_fresh("params");
  snprintf(text, sizeof text,
           "cattaneo: 1\nmodel: tracer\ndomain: {size: [1, 1], cells: [8, 8], walls: open}\n"
           "time: {end: 1}\nvelocity: %s\ndiffusion: {%s}\n",
           velocity, diffusion);
  file_write(folder, "scene.yaml", text);
  snprintf(path, sizeof path, "%s/scene.yaml", folder);
  cf_scene *scene;
  *status = cf_scene_read(&scene, path, 0, NULL);
  return scene;
}

static void says(const char *diffusion, const char *const parts[2]) {
  cf_status status;
  cf_scene *scene = read_diffusion(diffusion, "[0.9, 0]", &status);
  cf_scene_destroy(scene);
  assert_int_equal(status, CF_BAD_SCENE);
  for (int i = 0; i < 2; ++i)
    if (strstr(cf_status_sentence(), parts[i]) == NULL)
      fail_msg("{%s}: \"%s\" is not in: %s", diffusion, parts[i], cf_status_sentence());
}

/* The keys by the quantity they fix, as a scene would say them. */
enum { KINDS = 5, ALIASES = 3 };
static void say_all(const double f_t, char say[KINDS][ALIASES][96]) {
  const cf_scene_measures m = cf_scene_measure(k, tau, f_t, wind, thickness);
  memset(say, 0, sizeof(char[KINDS][ALIASES][96]));
  snprintf(say[0][0], 96, "k: %.17g", k);
  snprintf(say[0][1], 96, "saturation: %.17g, thickness: %.17g", m.saturation, thickness);
  snprintf(say[1][0], 96, "tau: %.17g", tau);
  snprintf(say[2][0], 96, "front_speed: %.17g", m.front_speed);
  snprintf(say[2][1], 96, "cone_angle: %.17g", m.cone_angle);
  snprintf(say[2][2], 96, "arrival: %.17g, thickness: %.17g", m.arrival, thickness);
  snprintf(say[3][0], 96, "reach: %.17g", m.reach);
  snprintf(say[4][0], 96, "visible_length: %.17g", m.visible_length);
}

static void check_set(const char *set, const double f_t) {
  cf_status status;
  cf_scene *scene = read_diffusion(set, "[0.54, 0.72]", &status);
  if (status != CF_OK) fail_msg("{%s}: %s", set, cf_status_sentence());
  const cf_scene_diffusion *d = &scene->fields.item[0].diffusion;
  const double got[3] = {d->k.fn.value, d->tau, d->f_t}, wanted[3] = {k, tau, f_t};
  for (int i = 0; i < 3; ++i)
    if (!(fabs(got[i] - wanted[i]) <= 1e-12))
      fail_msg("{%s}: k = %.17g, tau = %.17g, f_t = %.17g", set, got[0], got[1], got[2]);
  assert_false(d->given.front_speed || d->given.reach || d->given.cone_angle || d->given.thickness);
  cf_scene_destroy(scene);
}

static int check_pairs(const double f_t, const char *share) {
  char say[KINDS][ALIASES][96], set[512];
  int sets = 0;
  say_all(f_t, say);
  for (int a = 0; a < KINDS; ++a)
    for (int b = a + 1; b < KINDS; ++b)
      for (int i = 0; i < ALIASES; ++i)
        for (int j = 0; j < ALIASES; ++j) {
          if (say[a][i][0] == '\0' || say[b][j][0] == '\0') continue;
          if (strstr(say[a][i], "thickness") != NULL && strstr(say[b][j], "thickness") != NULL) continue;
          snprintf(set, sizeof set, "%s, %s%s%s", say[a][i], say[b][j], share[0] != '\0' ? ", " : "", share);
          check_set(set, f_t);
          ++sets;
        }
  return sets;
}

static void every_sufficient_set_gives_the_same_medium(void **state) {
  (void)state;
  char blur[64];
  const double f_t = 0.15;
  snprintf(blur, sizeof blur, "blur: %.17g", cf_scene_measure(k, tau, f_t, wind, 0).blur);
  const int sets = check_pairs(0, "") + check_pairs(0, "f_t: 0") + check_pairs(0, "blur: 0") +
                   check_pairs(f_t, "f_t: 0.15") + check_pairs(f_t, blur);
  print_message("%d sets\n", sets);
  assert_true(sets > 100);
}

static void keys_that_agree_may_say_more_than_needed(void **state) {
  (void)state;
  char say[KINDS][ALIASES][96], set[512];
  say_all(0, say);
  snprintf(set, sizeof set, "%s, %s, %s, %s, %s, f_t: 0", say[0][0], say[1][0], say[2][1], say[3][0],
           say[4][0]);
  check_set(set, 0);
}

static void contradictions_name_both_keys(void **state) {
  (void)state;
  says("k: 0.25, tau: 4, front_speed: 0.5",
       (const char *const[]){"diffusion.front_speed contradicts", "diffusion.k"});
  says("tau: 4, front_speed: 0.3, cone_angle: 30",
       (const char *const[]){"diffusion.cone_angle contradicts", "diffusion.front_speed"});
  says("k: 1, thickness: 1, saturation: 1, tau: 1",
       (const char *const[]){"diffusion.saturation contradicts", "diffusion.k"});
  says("tau: 4, front_speed: 0.3, reach: 1",
       (const char *const[]){"diffusion.reach contradicts", "diffusion.tau"});
  says("tau: 4, front_speed: 0.3, f_t: 0.1, blur: 1",
       (const char *const[]){"diffusion.blur contradicts", "diffusion.f_t"});
  says("tau: 4, cone_angle: 30, wind: 1", (const char *const[]){"diffusion.wind contradicts", "velocity"});
}

static void what_is_missing_is_said(void **state) {
  (void)state;
  cf_status status;
  says("front_speed: 1",
       (const char *const[]){"diffusion.front_speed needs k or tau", "diffusion.front_speed"});
  says("reach: 1", (const char *const[]){"diffusion.reach is not enough", "front_speed"});
  says("blur: 1, k: 1", (const char *const[]){"diffusion.blur is not enough", "tau"});
  says("tau: 1, arrival: 1", (const char *const[]){"diffusion.arrival needs `thickness`", "arrival"});
  says("tau: 1, k: 1, thickness: 1", (const char *const[]){"diffusion.thickness goes with", "arrival"});
  says("tau: 1, k: 1, wind: 1", (const char *const[]){"diffusion.wind goes with", "cone_angle"});
  says("front_speed: 1, visible_length: 1", (const char *const[]){"visible_length", "no cone"});
  says("k: 0.1, front_speed: 1, blur: 3",
       (const char *const[]){"diffusion.k and diffusion.front_speed", "blur"});
  assert_null(read_diffusion("cone_angle: 30, tau: 1", "[0, 0]", &status));
  assert_non_null(strstr(cf_status_sentence(), "needs a wind"));
  assert_null(read_diffusion("cone_angle: 30, tau: 1", "['y', '0']", &status));
  assert_non_null(strstr(cf_status_sentence(), "not the same everywhere"));
}

static void angles_have_units_and_capacity_counts(void **state) {
  (void)state;
  cf_status status;
  cf_scene *scene = read_diffusion("cone_angle: 0.5235987755982988 rad, tau: 2, wind: 2 m/s, capacity: 3",
                                   "['y', '0']", &status);
  assert_int_equal(status, CF_OK);
  CLOSE(scene->fields.item[0].diffusion.k.fn.value, 3 * 1.0 * 1.0 * 2,
        1e-12); /* k = C c^2 tau, c = 2 sin 30 */
  char *text;
  OK(cf_scene_write(scene, &text));
  assert_null(strstr(text, "cone_angle"));
  cf_free(text);
  cf_scene_destroy(scene);
}

static void the_measures_are_those_of_the_text_book(void **state) {
  (void)state;
  char text[512];
  const cf_scene_measures m = cf_scene_measure(0.25, 4, 0, 0.5, 1);
  CLOSE(m.front_speed, 0.25, 1e-15);
  CLOSE(m.cone_angle, 30, 1e-12);
  CLOSE(m.visible_length, 2 * 4 * 0.5 * 0.75, 1e-12);
  CLOSE(exp(-m.reach / (2 * m.front_speed * 4)), 0.05, 1e-15); /* a front decays as exp(-t/(2 tau)) */
  CLOSE(m.saturation * 0.25, 1.129, 1e-3);
  assert_true(m.rings);
  cf_scene_measures_text(&m, 1, text, sizeof text);
  assert_non_null(strstr(text, "reach = 5.991 m"));
  assert_non_null(strstr(text, "cone_angle = 30 degrees"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_sufficient_set_gives_the_same_medium),
      cmocka_unit_test(keys_that_agree_may_say_more_than_needed),
      cmocka_unit_test(contradictions_name_both_keys),
      cmocka_unit_test(what_is_missing_is_said),
      cmocka_unit_test(angles_have_units_and_capacity_counts),
      cmocka_unit_test(the_measures_are_those_of_the_text_book),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
