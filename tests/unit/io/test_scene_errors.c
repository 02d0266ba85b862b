/* SPDX-License-Identifier: MIT
 *
 * What bad scenes are told, byte for byte. Every NAME.yaml in tests/golden/scene_errors has its message in NAME.txt;
 * NAME.set, if there is one, holds overrides, one a line. Scenes are read from within the folder, so that messages
 * have no path of this machine.
 */
#define _GNU_SOURCE
#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "model/scene.h"
#include "testing.h"

#define FOLDER CF_SOURCE_DIR "/tests/golden/scene_errors"
enum { TEXT_MAX = 8192, OVERRIDES_MAX = 16, SCENES_MIN = 120 };

/* The text of a file; false if there is none. */
static bool read_text(const char *name, const char *ending, char *text) {
  char path[300];
  snprintf(path, sizeof path, "%s%s", name, ending);
  FILE *file = fopen(path, "rb");
  if (file == NULL) return false;
  text[fread(text, 1, TEXT_MAX - 1, file)] = '\0';
  fclose(file);
  return true;
}

static int is_scene(const struct dirent *entry) {
  const size_t length = strlen(entry->d_name);
  return length > 5 && strcmp(entry->d_name + length - 5, ".yaml") == 0;
}

/* The status of reading a scene with the overrides that belong to it. */
static cf_status read_scene(const char *name, cf_scene **scene) {
  static char set_text[TEXT_MAX];
  const char *set[OVERRIDES_MAX];
  char path[300];
  int count = 0;
  if (read_text(name, ".set", set_text))
    for (char *line = strtok(set_text, "\n"); line != NULL && count < OVERRIDES_MAX;
         line = strtok(NULL, "\n"))
      set[count++] = line;
  snprintf(path, sizeof path, "%s.yaml", name);
  return cf_scene_read(scene, path, count, set);
}

static int wrong_message(const char *name) {
  static char wanted[TEXT_MAX], got[TEXT_MAX];
  cf_scene *scene;
  const cf_status status = read_scene(name, &scene);
  snprintf(got, sizeof got, "%s\n", cf_status_sentence());
  if (!read_text(name, ".txt", wanted)) snprintf(wanted, sizeof wanted, "(there is no %s.txt)\n", name);
  if (status == CF_BAD_SCENE && scene == NULL && strcmp(got, wanted) == 0) return 0;
  print_error("--- %s: status %s, wanted\n%s--- got\n%s", name, cf_status_name(status), wanted, got);
  cf_scene_destroy(scene);
  return 1;
}

static void scene_errors_are_as_written_down(void **state) {
  (void)state;
  struct dirent **entries;
  int wrong = 0;
  assert_int_equal(chdir(FOLDER), 0);
  const int count = scandir(".", &entries, is_scene, alphasort);
  assert_true(count >= SCENES_MIN);
  for (int i = 0; i < count; ++i) {
    entries[i]->d_name[strlen(entries[i]->d_name) - 5] = '\0';
    wrong += wrong_message(entries[i]->d_name);
    free(entries[i]);
  }
  free(entries);
  if (wrong > 0) fail_msg("%d of %d messages differ", wrong, count);
}

static void refused(const char *path, const char *message) {
  cf_scene *scene;
  assert_int_equal(cf_scene_read(&scene, path, 0, NULL), CF_BAD_SCENE);
  assert_null(scene);
  assert_string_equal(cf_status_sentence(), message);
  assert_int_equal(cf_status_exit_code(CF_BAD_SCENE), 2);
}

static void scene_that_is_not_there_is_an_error(void **state) {
  (void)state;
  refused("no/such.yaml", "no/such.yaml: error: there is no such file\ntry: cattaneo examples");
  refused("", "'': error: the name of the scene is empty\ntry: cattaneo examples");
}

static void scene_that_is_a_folder_is_an_error(void **state) {
  (void)state;
  refused("/", "/: error: this is a folder, a scene is a file\ntry: cattaneo examples");
}

static void scene_that_is_too_large_is_an_error(void **state) {
  (void)state;
  const char *path = CF_BINARY_DIR "/too_large.yaml";
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  for (int i = 0; i < 500000; ++i) fputs("# nothing\n", file);
  fclose(file);
  cf_scene *scene;
  assert_int_equal(cf_scene_read(&scene, path, 0, NULL), CF_BAD_SCENE);
  assert_non_null(strstr(cf_status_sentence(), "the file has 4.8 MB, a scene has at most 4 MB"));
  remove(path);
}

/* One byte of a good scene changed, anywhere, to anything: a scene or an error, never more. */
static void scene_with_any_wrong_byte_does_no_harm(void **state) {
  (void)state;
  static const char good[] =
      "cattaneo: 1\nmodel: tracer\nlet: {H: 2}\ndomain: {size: [1, 1], cells: [8, 8], walls: {x-: open, y+: "
      "{value: \"t*H\"}}}\n"
      "time: {end: 1 min, dt: 1/24}\ndiffusion:\n  k: 2 cm^2/s\n  front_speed: 3\nfields: {phi: {initial: "
      "exp(-x)}}\n"
      "sources: [{at: [0.5, 0.5], amount: H}]\noutput: {checkpoint: {every: 10 steps}}\n";
  const char *path = CF_BINARY_DIR "/wrong_byte.yaml";
  uint64_t random = 12345;
  for (int round = 0; round < 1500; ++round) {
    char text[sizeof good];
    memcpy(text, good, sizeof good);
    const size_t at = (size_t)(test_random(&random) * (sizeof good - 1));
    text[at] = (char)(round % 2 ? test_random(&random) * 256
                                : " :{}[],\"'#&*!|>-?%@`\n\t"[(int)(test_random(&random) * 23)]);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fwrite(text, 1, sizeof good - 1, file);
    fclose(file);
    cf_scene *scene;
    const cf_status status = cf_scene_read(&scene, path, 0, NULL);
    assert_true(status == CF_OK ? scene != NULL : status == CF_BAD_SCENE && scene == NULL);
    cf_scene_destroy(scene);
  }
  remove(path);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(scene_errors_are_as_written_down),
      cmocka_unit_test(scene_that_is_not_there_is_an_error),
      cmocka_unit_test(scene_that_is_a_folder_is_an_error),
      cmocka_unit_test(scene_that_is_too_large_is_an_error),
      cmocka_unit_test(scene_with_any_wrong_byte_does_no_harm),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
