/* SPDX-License-Identifier: MIT
 *
 * The library in a program that has chosen a language with decimal commas: scenes are read, written, saved and loaded
 * with points, and the language is the program's again afterwards.
 */
#define _GNU_SOURCE
#include "testing.h"

#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "folders.h"
#include "model/scene.h"
#include "model/sim.h"

static const char yaml[] =
    "cattaneo: 1\n"
    "model: tracer\n"
    "domain: {size: [1, 0.5], cells: [16, 8]}\n"
    "time: {end: 0.25, dt: 0.05}\n"
    "diffusion: {k: 2.5 cm^2/s, tau: 0.5}\n"
    "fields: {phi: {initial: 'exp(-((x-.4)^2+(y-.3)^2)/.01)'}}\n";

/* Makes a language with commas, where the system has what it is made of. */
static bool speak_german(const char *folder) {
  char command[600];
  snprintf(command, sizeof command, "localedef -i de_DE -f UTF-8 '%s/de_DE.UTF-8' >'%s/said' 2>&1", folder,
           folder);
  const int made = system(command);
  setenv("LOCPATH", folder, 1);
  return made == 0 && setlocale(LC_ALL, "de_DE.UTF-8") != NULL &&
         strcmp(localeconv()->decimal_point, ",") == 0;
}

static void numbers_have_points_whatever_the_language(void **state) {
  char folder[512], path[600], saved[600], *text, *again;
  cf_scene *scene;
  cf_sim *sim, *other;
  (void)state;
  snprintf(folder, sizeof folder, "%s", folder_fresh("locale"));
  snprintf(path, sizeof path, "%s/scene.yaml", folder);
  snprintf(saved, sizeof saved, "%s/saved.h5", folder);
  file_write(folder, "scene.yaml", yaml);
  if (!speak_german(folder)) skip();
  OK(cf_scene_read(&scene, path, 1, (const char *[]){"time.end=0.1"}));
  CLOSE(scene->time.dt, 0.05, 0);
  CLOSE(scene->time.end, 0.1, 0);
  CLOSE(scene->domain.size.value[1], 0.5, 0);
  OK(cf_scene_write(scene, &text));
  OK(cf_sim_create(&sim, scene, 1));
  OK(cf_sim_run(sim, INFINITY, NULL, NULL));
  OK(cf_sim_save(sim, saved));
  assert_string_equal(localeconv()->decimal_point, ","); /* as it was */
  setlocale(LC_ALL, "C");
  OK(cf_scene_write(scene, &again));
  assert_string_equal(text, again);
  OK(cf_sim_create(&other, scene, 1));
  OK(cf_sim_load(other, saved));
  CLOSE(cf_sim_time(other), 0.1, 0);
  cf_free(text);
  cf_free(again);
  cf_sim_destroy(other);
  cf_sim_destroy(sim);
  cf_scene_destroy(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(numbers_have_points_whatever_the_language)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
