/* SPDX-License-Identifier: MIT
 *
 * Saving a simulation into a file and loading it again, for those who use the library: a checkpoint as
 * io/checkpoint.h writes it, together with the resolved scene, by which a file of another scene is known. What
 * a scene says under title, output and render may differ: numbers do not depend on it.
 */
#include <stdio.h>
#include <string.h>

#include "base/real.h"
#include "io/checkpoint.h"
#include "model/sim.h"

cf_status cf_sim_save(const cf_sim *sim, const char *path) {
  char *scene;
  CF_TRY(cf_scene_write(sim->scene, &scene));
  const cf_stamp stamp = {.title = sim->scene->title, .scene = scene, .time = sim->time, .step = sim->step};
  const cf_status s = cf_checkpoint_write_to(path, &sim->registry, &stamp);
  cf_free(scene);
  return s;
}

/* Goes through the lines of a resolved scene on which numbers depend. */
typedef struct cf_scene_lines {
  const char *next, *line;
  int length;
  bool beside; /* in a part on which none do */
} cf_scene_lines;

/* false: that was the last. */
static bool next_line(cf_scene_lines *l) {
  static const char *const beside[] = {"title:", "output:", "render:", "#"};
  while (*l->next != '\0') {
    l->line = l->next;
    l->length = (int)strcspn(l->line, "\n");
    l->next += l->length + (l->line[l->length] == '\n');
    if (l->line[0] != ' ') l->beside = false;
    for (size_t i = 0; i < sizeof beside / sizeof *beside; ++i)
      l->beside = l->beside || strncmp(l->line, beside[i], strlen(beside[i])) == 0;
    if (!l->beside) return true;
  }
  l->line = "nothing";
  l->length = (int)strlen(l->line);
  return false;
}

/* Where they first differ, if they do. */
static bool same_scene(const char *saved, const char *ours, cf_scene_lines *theirs, cf_scene_lines *own) {
  *theirs = (cf_scene_lines){.next = saved}, *own = (cf_scene_lines){.next = ours};
  bool more = true;
  while (more) {
    const bool first = next_line(theirs), second = next_line(own);
    if (first != second || theirs->length != own->length ||
        strncmp(theirs->line, own->line, (size_t)own->length) != 0)
      return false;
    more = first;
  }
  return true;
}

static cf_status check_scene(const cf_sim *sim, const char *path) {
  cf_checkpoint_facts facts;
  char *saved, *ours;
  CF_TRY(cf_checkpoint_describe(path, &facts, &saved));
  cf_status s = cf_scene_write(sim->scene, &ours);
  if (s != CF_OK) {
    cf_free(saved);
    return s;
  }
  cf_scene_lines theirs, own;
  if (!same_scene(saved != NULL ? saved : "", ours, &theirs, &own))
    s = cf_fail(
        CF_BAD_FILE,
        "%s: belongs to another scene (\"%.200s\", step %lld), which says `%.*s` where this one says "
        "`%.*s`: if it is this run's, put the scene (of a folder: run.yaml) back as it was; else start a "
        "new run in another folder",
        path, facts.title, (long long)facts.step, CF_MIN(theirs.length, 100), theirs.line,
        CF_MIN(own.length, 100), own.line);
  cf_free(saved);
  cf_free(ours);
  return s;
}

cf_status cf_sim_load(cf_sim *sim, const char *path) {
  CF_TRY(check_scene(sim, path));
  CF_TRY(cf_checkpoint_read(path, &sim->registry));
  memset(&sim->report, 0, sizeof sim->report);
  sim->warning[0] = '\0';
  return cf_sim_restored(sim);
}
