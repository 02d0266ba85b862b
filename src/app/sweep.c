/* SPDX-License-Identifier: MIT
 *
 * cattaneo sweep SCENE.yaml... --grid KEY=A,B,C ... -o DIR
 *
 * All scenes are read before any runs, so that a wrong value is told at once. What is in DIR already is looked at
 * run by run: a folder whose run.yaml says the same scene goes on (or is finished already), one that says another is
 * refused. So the same command again finishes what was stopped.
 */
#define _GNU_SOURCE
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "app/children.h"
#include "app/combine.h"
#include "app/command.h"
#include "app/relaunch.h"
#include "app/sheet.h"
#include "app/stop.h"
#include "app/sweep_table.h"
#include "app/tell.h"
#include "base/mem.h"
#include "io/folder.h"
#include "model/scene.h"

enum { WORDS_MAX = 24, RUN_BYTES = 8 << 20 };

typedef struct sweep {
  const cf_arguments *a;
  cf_combinations runs;
  cf_path *folder;
  cf_child *child;
  const char ***words; /* of each child's command line */
  char threads[16], until[40];
  int done;
  double began;
} sweep;

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* --- what stands in the folders ------------------------------------------------------------------------------ */

/* run.yaml below its head of comments. */
static const char *below_head(const char *text) {
  while (*text == '#') {
    text += strcspn(text, "\n");
    if (*text == '\n') ++text;
  }
  return text;
}

static cf_status compare(const char *folder, const char *file, const char *scene) {
  char *text;
  size_t size;
  CF_TRY(cf_file_read(file, RUN_BYTES, &text, &size));
  const bool same = strcmp(below_head(text), scene) == 0;
  cf_free(text);
  if (same) return CF_OK;
  return cf_fail(CF_BAD_USAGE, "%s holds a run of another scene: --force runs it anew", folder);
}

/* The overrides of a run: those of the command line, then its own. `set` has room for all. */
static void list_overrides(const sweep *s, const int i, const char **set) {
  for (int k = 0; k < s->a->sets; ++k) *set++ = s->a->set[k];
  for (int k = 0; k < s->runs.axes; ++k) *set++ = s->runs.item[i].set[k];
}

/* Reads the scene of run i, and compares it with what stands in its folder. *resumes: something does. */
static cf_status inspect(const sweep *s, const int i, const char **set, bool *resumes) {
  cf_path file;
  cf_scene *scene;
  char *text = NULL;
  list_overrides(s, i, set);
  CF_TRY(cf_path_make(&file, "%s/run.yaml", s->folder[i].text));
  *resumes = access(file.text, F_OK) == 0 && !s->a->force;
  CF_TRY(cf_scene_read(&scene, s->a->operand[s->runs.item[i].scene], s->a->sets + s->runs.axes, set));
  cf_status status = CF_OK;
  if (*resumes) status = cf_scene_write(scene, &text);
  if (*resumes && status == CF_OK) status = compare(s->folder[i].text, file.text, text);
  cf_free(text);
  cf_scene_destroy(scene);
  return status;
}

/* --- command lines ------------------------------------------------------------------------------------------ */

static cf_status write_line(sweep *s, const int i, const bool resumes, const char *const *set) {
  const cf_arguments *a = s->a;
  const int sets = a->sets + s->runs.axes;
  const char **w;
  int n = 0;
  CF_TRY(CF_NEW(&s->words[i], WORDS_MAX + 2 * sets));
  w = s->words[i];
  w[n++] = CF_PROGRAM;
  w[n++] = resumes ? "resume" : "run";
  w[n++] = "--progress";
  w[n++] = "none";
  w[n++] = "--threads";
  w[n++] = s->threads;
  if (a->until > 0) {
    w[n++] = "--until";
    w[n++] = s->until;
  }
  if (!resumes) {
    for (int k = 0; k < sets; ++k) {
      w[n++] = "--set";
      w[n++] = set[k];
    }
    w[n++] = "-o";
    w[n++] = s->folder[i].text;
    if (a->force) w[n++] = "--force";
  }
  w[n++] = "--";
  w[n++] = resumes ? s->folder[i].text : a->operand[s->runs.item[i].scene];
  w[n] = NULL;
  s->child[i].argv = (char **)(uintptr_t)w;
  return CF_OK;
}

static cf_status plan(sweep *s) {
  const cf_arguments *a = s->a;
  const int count = s->runs.count;
  const char **set;
  CF_TRY(CF_NEW(&s->folder, count));
  CF_TRY(CF_NEW(&s->child, count));
  CF_TRY(CF_NEW(&s->words, count));
  CF_TRY(CF_NEW(&set, a->sets + s->runs.axes + 1));
  cf_status status = CF_OK;
  for (int i = 0; i < count && status == CF_OK; ++i) {
    bool resumes = false;
    status = cf_path_make(&s->folder[i], "%s/%s", a->output, s->runs.item[i].name);
    if (status == CF_OK) status = inspect(s, i, set, &resumes);
    if (status == CF_OK) status = write_line(s, i, resumes, set);
  }
  cf_free(set);
  return status;
}

/* --- running ------------------------------------------------------------------------------------------------ */

static cf_status write_table(const sweep *s) {
  cf_path file;
  CF_TRY(cf_path_make(&file, "%s/table.csv", s->a->output));
  return cf_sweep_table_write(&s->runs, s->folder, s->child, file.text);
}

/* A line for each run; the table grows with it. */
static void on_end(void *context, const int i) {
  sweep *s = context;
  char took[32], word[48] = "done";
  const int code = s->child[i].code;
  ++s->done;
  cf_duration_text(now() - s->began, took, sizeof took);
  if (code == cf_status_exit_code(CF_STOPPED))
    snprintf(word, sizeof word, "stopped");
  else if (code != 0)
    snprintf(word, sizeof word, "failed, exit code %d", code);
  if (s->a->progress != CF_PROGRESS_NONE)
    fprintf(stderr, "%d of %d   %s: %s   %s\n", s->done, s->runs.count, s->runs.item[i].name, word, took);
  write_table(s);
}

static cf_status make_sheet(const sweep *s) {
  const char **folder, **caption;
  cf_path file;
  CF_TRY(cf_path_make(&file, "%s/sheet.png", s->a->output));
  CF_TRY(CF_NEW(&folder, 2 * s->runs.count));
  caption = folder + s->runs.count;
  for (int i = 0; i < s->runs.count; ++i) {
    folder[i] = s->folder[i].text;
    caption[i] = s->runs.item[i].caption;
  }
  const int last = s->runs.axes > 0 ? s->runs.axis[s->runs.axes - 1].count : 0;
  const cf_sheet sheet = {.count = s->runs.count,
                          .folder = folder,
                          .caption = caption,
                          .columns = s->a->columns > 0  ? s->a->columns
                                     : s->runs.axes > 1 ? last
                                                        : 0,
                          .field = s->a->field,
                          .file = file.text};
  const cf_status status = cf_sheet_write(&sheet);
  cf_free(folder);
  return status;
}

static cf_status count_failures(const sweep *s) {
  int failed = 0, first = -1;
  for (int i = 0; i < s->runs.count; ++i)
    if (s->child[i].code != 0) {
      if (first < 0) first = i;
      ++failed;
    }
  if (failed == 0) return CF_OK;
  return cf_fail(CF_FAILED, "%d of %d runs failed, the first %s (exit code %d); see its log.txt", failed,
                 s->runs.count, s->folder[first].text, s->child[first].code);
}

static cf_status run_all(sweep *s) {
  const cf_arguments *a = s->a;
  const int processors = (int)CF_MAX(1, sysconf(_SC_NPROCESSORS_ONLN));
  const int jobs = CF_MIN(a->jobs > 0 ? a->jobs : processors, s->runs.count);
  const int threads = CF_MAX(1, (a->threads > 0 ? a->threads : processors) / jobs);
  snprintf(s->threads, sizeof s->threads, "%d", threads);
  snprintf(s->until, sizeof s->until, "%.17g", a->until);
  CF_TRY(plan(s));
  CF_TRY(cf_folder_make(a->output));
  cf_children c = {.count = s->runs.count, .jobs = jobs, .child = s->child, .ended = on_end, .context = s};
  cf_stop_watch();
  s->began = now();
  const cf_status status = cf_children_run(&c);
  if (status == CF_STOPPED)
    return cf_fail(CF_STOPPED,
                   "stopped; the same command again goes on, and keeps the runs that are finished");
  CF_TRY(status);
  CF_TRY(write_table(s));
  if (make_sheet(s) != CF_OK && a->progress != CF_PROGRESS_NONE)
    fprintf(stderr, "no sheet.png: %s\n", cf_status_sentence());
  return count_failures(s);
}

static void sweep_clear(sweep *s) {
  for (int i = 0; s->words != NULL && i < s->runs.count; ++i) cf_free(s->words[i]);
  cf_free(s->words);
  cf_free(s->child);
  cf_free(s->folder);
  cf_combinations_clear(&s->runs);
}

cf_status cf_sweep_command(cf_arguments *a) {
  if (a->other) return cf_relaunch_sister(a->argv);
  if (a->output == NULL) return cf_fail(CF_BAD_USAGE, "sweep: -o DIR is missing: the folder for the runs");
  if (a->grids == 0 && a->operands < 2)
    return cf_fail(CF_BAD_USAGE, "sweep: --grid KEY=A,B,C is missing: what is to vary");
  sweep s = {.a = a};
  CF_TRY(cf_combinations_make(&s.runs, a->operands, a->operand, a->grids, a->grid));
  const cf_status status = run_all(&s);
  sweep_clear(&s);
  if (status == CF_OK) printf("%s\n", a->output);
  return status;
}
