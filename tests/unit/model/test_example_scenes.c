/* SPDX-License-Identifier: MIT
 *
 * Every scene below examples/ is one, those that no test runs included.
 */
#define _GNU_SOURCE
#include <glob.h>

#include "model/scene.h"
#include "testing.h"

static void read_all(const char *pattern, const size_t least) {
  glob_t found;
  assert_int_equal(glob(pattern, 0, NULL, &found), 0);
  assert_true(found.gl_pathc >= least);
  for (size_t i = 0; i < found.gl_pathc; ++i) {
    cf_scene *scene;
    if (cf_scene_read(&scene, found.gl_pathv[i], 0, NULL) != CF_OK) fail_msg("%s", cf_status_sentence());
    cf_scene_destroy(scene);
  }
  globfree(&found);
}

static void every_scene_of_the_examples_is_read(void **state) {
  (void)state;
  read_all(CF_SOURCE_DIR "/examples/*/*.yaml", 30);
  read_all(CF_SOURCE_DIR "/examples/*/*/*.yaml", 12);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_scene_of_the_examples_is_read)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
