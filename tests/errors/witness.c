/* SPDX-License-Identifier: MIT
 *
 * Linked into a copy of the program with ld's --wrap, so that every failure passes here on its way: its format is
 * appended to the file that ERRORS_SEEN names, one a line. And the allocation that ALLOCATION_FAILS counts to, from 1,
 * fails.
 */
#define _GNU_SOURCE
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "io/scene_tree.h"
#include "model/scene.h"

enum { TEXT = 4096 };

cf_status __real_cf_fail(cf_status code, const char *format, ...);
cf_status __wrap_cf_fail(cf_status code, const char *format, ...);
cf_status __real_cf_scene_fail_at(const cf_scene *scene, const char *key, const char *format, ...);
cf_status __wrap_cf_scene_fail_at(const cf_scene *scene, const char *key, const char *format, ...);
cf_status __real_cf_config_fail(const cf_config *config, cf_about about, const char *format, ...);
cf_status __wrap_cf_config_fail(const cf_config *config, cf_about about, const char *format, ...);
cf_status __real_cf_config_fail_at(const cf_config *config, const char *key, const char *format, ...);
cf_status __wrap_cf_config_fail_at(const cf_config *config, const char *key, const char *format, ...);

__attribute__((constructor)) static void take_memory(void) {
  const char *at = getenv("ALLOCATION_FAILS");
  if (at != NULL) cf_mem_fail_at(atol(at));
}

static void note(const char *format) {
  const char *path = getenv("ERRORS_SEEN");
  char line[TEXT];
  size_t n = 0;
  const int file = path != NULL ? open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666) : -1;
  if (file < 0) return;
  for (; *format != '\0' && n + 3 < sizeof line; ++format) {
    if (*format == '\n') line[n++] = '\\';
    line[n++] = *format == '\n' ? 'n' : *format;
  }
  line[n++] = '\n';
  (void)!write(file, line, n);
  close(file);
}

#define SENTENCE(text, format)                  \
  char text[TEXT];                              \
  va_list values;                               \
  note(format);                                 \
  va_start(values, format);                     \
  vsnprintf(text, sizeof text, format, values); \
  va_end(values)

cf_status __wrap_cf_fail(const cf_status code, const char *format, ...) {
  SENTENCE(text, format);
  return __real_cf_fail(code, "%s", text);
}

cf_status __wrap_cf_scene_fail_at(const cf_scene *scene, const char *key, const char *format, ...) {
  SENTENCE(text, format);
  return __real_cf_scene_fail_at(scene, key, "%s", text);
}

cf_status __wrap_cf_config_fail(const cf_config *config, const cf_about about, const char *format, ...) {
  SENTENCE(text, format);
  return __real_cf_config_fail(config, about, "%s", text);
}

cf_status __wrap_cf_config_fail_at(const cf_config *config, const char *key, const char *format, ...) {
  SENTENCE(text, format);
  return __real_cf_config_fail_at(config, key, "%s", text);
}
