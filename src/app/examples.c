/* SPDX-License-Identifier: MIT
 *
 * cattaneo examples [NAME]
 */
#define _GNU_SOURCE
#include "app/examples.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "app/command.h"
#include "base/param.h"
#include "io/folder.h"

static void list_all(void) {
  int width = 0;
  for (const cf_example *e = cf_examples; e->name != NULL; ++e) width = CF_MAX(width, (int)strlen(e->name));
  for (const cf_example *e = cf_examples; e->name != NULL; ++e)
    printf("%-*s  %s\n", width, e->name, e->title);
}

static cf_status find(const char *name, const cf_example **found) {
  const char *best = NULL;
  int least = -1;
  for (*found = cf_examples; (*found)->name != NULL; ++*found) {
    const int distance = cf_param_distance(name, (*found)->name);
    if (distance == 0 && strcmp(name, (*found)->name) == 0) return CF_OK;
    if (distance < 0 || (best != NULL && distance >= least)) continue;
    best = (*found)->name;
    least = distance;
  }
  if (best != NULL) return cf_fail(CF_BAD_USAGE, "there is no example %.64s: did you mean %s?", name, best);
  return cf_fail(CF_BAD_USAGE, "there is no example %.64s: `" CF_PROGRAM " examples` lists them", name);
}

static cf_status unless_there(const char *path, const bool force) {
  if (force || (access(path, F_OK) != 0 && errno == ENOENT)) return CF_OK;
  return cf_fail(CF_BAD_USAGE, "%s is there already: --force overwrites it", path);
}

/* What its scene names, into a folder beside it that is called as the example. */
static cf_status copy_files(const cf_example *e, const bool force) {
  for (int writing = 0; writing < 2; ++writing)
    for (const cf_example_file *f = cf_example_files; f->example != NULL; ++f) {
      if (strcmp(f->example, e->name) != 0) continue;
      if (!writing) {
        CF_TRY(unless_there(f->path, force));
        continue;
      }
      CF_TRY(cf_folder_make(f->example));
      CF_TRY(cf_file_write(f->path, f->bytes, f->size));
    }
  return CF_OK;
}

cf_status cf_examples_command(cf_arguments *a) {
  const cf_example *e;
  cf_path path;
  if (a->operands == 0) {
    list_all();
    return CF_OK;
  }
  CF_TRY(find(a->operand[0], &e));
  CF_TRY(cf_path_make(&path, "%s.yaml", e->name));
  CF_TRY(unless_there(path.text, a->force));
  CF_TRY(copy_files(e, a->force));
  CF_TRY(cf_file_write(path.text, e->scene, e->size));
  printf("%s\n", path.text);
  fprintf(stderr, "now: " CF_PROGRAM " run %s\n", path.text);
  return CF_OK;
}
