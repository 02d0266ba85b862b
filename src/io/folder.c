/* SPDX-License-Identifier: MIT
 *
 * The folder of a run: its lock, its log, and which files in it belong to the run. (One file: draft.c.)
 *
 * The lock is flock on a file .lock, so it is gone with the process however that ends. On file systems that
 * know no locks the run goes on without one.
 */
#define _GNU_SOURCE
#include "io/folder.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/mem.h"
#include "base/real.h"

#define DIGITS_MIN 6 /* of the number in a name */
#define DIGITS_MAX 18

/* --- names ---------------------------------------------------------------------------------------------- */

static bool is_one_of(const char *text, const char *const *list) {
  for (; *list != NULL; ++list)
    if (strcmp(text, *list) == 0) return true;
  return false;
}

/* Takes WORD_000012REST apart; false if the name is not made so. */
static bool take_apart(const char *name, char *word, const size_t size, int64_t *number, const char **rest) {
  const char *bar = name;
  while ((bar = strchr(bar, '_')) != NULL && !isdigit((unsigned char)bar[1])) ++bar;
  if (bar == NULL || bar == name || (size_t)(bar - name) >= size) return false;
  const size_t digits = strspn(bar + 1, "0123456789");
  if (digits < DIGITS_MIN || digits > DIGITS_MAX) return false;
  snprintf(word, size, "%.*s", (int)(bar - name), name);
  *number = strtoll(bar + 1, NULL, 10);
  *rest = bar + 1 + digits;
  return true;
}

cf_file_kind cf_file_kind_of(const char *name, int64_t *number) {
  static const char *const run[] = {"run.yaml", "metrics.csv", "log.txt", NULL};
  static const char *const arrays[] = {".vtkhdf", ".vdb", ".npy", ".ply", ".obj", NULL};
  static const char *const pictures[] = {"preview", "render", NULL};
  char word[128];
  const char *rest;
  const char *dot = strrchr(name, '.');
  *number = -1;
  if (is_one_of(name, run)) return CF_FILE_RUN;
  if (dot == NULL || dot == name || name[0] == '.') return CF_FILE_OTHER;
  if (strcmp(dot, ".series") == 0 && dot - name > 7 && strncmp(dot - 7, ".vtkhdf", 7) == 0)
    return CF_FILE_RUN;
  if (!take_apart(name, word, sizeof word, number, &rest)) return CF_FILE_OTHER;
  if (strcmp(word, "checkpoint") == 0) return strcmp(rest, ".h5") == 0 ? CF_FILE_CHECKPOINT : CF_FILE_OTHER;
  if (rest != dot && rest[0] != '_') return CF_FILE_OTHER;
  if (is_one_of(dot, arrays)) return CF_FILE_FRAME;
  return strcmp(dot, ".png") == 0 && is_one_of(word, pictures) ? CF_FILE_FRAME : CF_FILE_OTHER;
}

/* --- walking through a folder ------------------------------------------------------------------------- */

cf_status cf_folder_each(const char *path, void (*visit)(void *context, const char *name), void *context) {
  DIR *folder = opendir(path);
  if (folder == NULL) return cf_fail(CF_BAD_FILE, "%s: cannot be listed: %s", path, strerror(errno));
  for (const struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder))
    visit(context, entry->d_name);
  closedir(folder);
  return CF_OK;
}

typedef struct search {
  const char *word, *ext;
  int count, room; /* room 0: only count */
  int64_t *numbers;
} search;

static void visit_number(void *context, const char *name) {
  search *s = context;
  char word[128];
  const char *rest;
  int64_t number;
  if (!take_apart(name, word, sizeof word, &number, &rest)) return;
  if (strcmp(word, s->word) != 0 || rest[0] != '.' || strcmp(rest + 1, s->ext) != 0) return;
  if (s->count < s->room) s->numbers[s->count] = number;
  ++s->count;
}

static int compare_numbers(const void *a, const void *b) {
  const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
  return (x > y) - (x < y);
}

cf_status cf_folder_numbers(const char *path, const char *word, const char *ext, int *count,
                            int64_t **numbers) {
  search s = {.word = word, .ext = ext};
  *count = 0;
  *numbers = NULL;
  if (access(path, F_OK) != 0) return CF_OK;
  CF_TRY(cf_folder_each(path, visit_number, &s));
  search fill = {.word = word, .ext = ext, .room = s.count};
  CF_TRY(CF_NEW(&fill.numbers, s.count));
  const cf_status status = cf_folder_each(path, visit_number, &fill);
  if (status != CF_OK) {
    cf_free(fill.numbers);
    return status;
  }
  *count = CF_MIN(fill.count, fill.room);
  *numbers = fill.numbers;
  if (*count > 0) qsort(*numbers, (size_t)*count, sizeof **numbers, compare_numbers);
  return CF_OK;
}

typedef struct census {
  bool yaml, metrics;
  int frames, checkpoints, others;
} census;

static void visit_census(void *context, const char *name) {
  census *c = context;
  int64_t number;
  const cf_file_kind kind = cf_file_kind_of(name, &number);
  if (strcmp(name, "run.yaml") == 0)
    c->yaml = true;
  else if (strcmp(name, "metrics.csv") == 0)
    c->metrics = true;
  else if (kind == CF_FILE_FRAME)
    ++c->frames;
  else if (kind == CF_FILE_CHECKPOINT)
    ++c->checkpoints;
}

/* "run.yaml, metrics.csv, 24 frame files, 2 checkpoints"; "" if there is no run (a log alone is what a run leaves that
 * was killed before it began). */
static void census_sentence(const census *c, char *text, const size_t size) {
  char frames[48] = "", checkpoints[48] = "";
  if (c->frames > 0)
    snprintf(frames, sizeof frames, ", %d frame file%s", c->frames, c->frames == 1 ? "" : "s");
  if (c->checkpoints > 0)
    snprintf(checkpoints, sizeof checkpoints, ", %d checkpoint%s", c->checkpoints,
             c->checkpoints == 1 ? "" : "s");
  char all[256];
  snprintf(all, sizeof all, "%s%s%s%s", c->yaml ? ", run.yaml" : "", c->metrics ? ", metrics.csv" : "",
           frames, checkpoints);
  snprintf(text, size, "%s", all[0] == '\0' ? "" : all + 2);
}

typedef struct cut {
  const char *path;
  bool frames, run, checkpoints, drafts;
  int64_t above; /* of frames */
  cf_status status;
} cut;

static void visit_cut(void *context, const char *name) {
  cut *c = context;
  int64_t number;
  const cf_file_kind kind = cf_file_kind_of(name, &number);
  const size_t length = strlen(name);
  const bool draft = name[0] == '.' && length > 6 && strcmp(name + length - 5, ".part") == 0;
  const bool mine = (c->frames && kind == CF_FILE_FRAME && number > c->above) ||
                    (c->run && kind == CF_FILE_RUN) || (c->checkpoints && kind == CF_FILE_CHECKPOINT) ||
                    (c->drafts && draft);
  cf_path file;
  if (!mine || c->status != CF_OK) return;
  c->status = cf_path_make(&file, "%s/%s", c->path, name);
  if (c->status == CF_OK && unlink(file.text) != 0 && errno != ENOENT)
    c->status = cf_fail(CF_CANNOT_WRITE, "%s: cannot be removed: %s", file.text, strerror(errno));
}

static cf_status cut_files(cut c) {
  CF_TRY(cf_folder_each(c.path, visit_cut, &c));
  return c.status;
}

cf_status cf_folder_cut_frames(const char *path, const int64_t last) {
  return cut_files((cut){.path = path, .frames = true, .above = last});
}

/* --- the folder --------------------------------------------------------------------------------------------
 */

cf_status cf_folder_make(const char *path) {
  cf_path part;
  CF_TRY(cf_path_make(&part, "%s", path));
  for (char *at = part.text + 1;; ++at) {
    if (*at != '/' && *at != '\0') continue;
    const char end = *at;
    *at = '\0';
    struct stat facts;
    if (mkdir(part.text, 0777) != 0 && errno != EEXIST)
      return cf_fail(CF_CANNOT_WRITE, "%s: the folder cannot be made: %s", part.text, strerror(errno));
    if (stat(part.text, &facts) != 0 || !S_ISDIR(facts.st_mode))
      return cf_fail(CF_CANNOT_WRITE, "%s: is there and is not a folder: another name is wanted", part.text);
    *at = end;
    if (end == '\0') return CF_OK;
  }
}

/* Whether `path` is still the name of the open file: a run that ends takes its lock's name away. */
static bool is_name_of(const char *path, const int file) {
  struct stat here, there;
  return stat(path, &here) == 0 && fstat(file, &there) == 0 && here.st_ino == there.st_ino &&
         here.st_dev == there.st_dev;
}

static cf_status take_lock(cf_folder *f) {
  cf_path file;
  char owner[32] = "";
  CF_TRY(cf_path_make(&file, "%s/.lock", f->path.text));
  for (;;) {
    f->lock = open(file.text, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (f->lock < 0) return cf_fail(CF_CANNOT_WRITE, "%s: cannot be written: %s", file.text, strerror(errno));
    if (flock(f->lock, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) break;
    if (is_name_of(file.text, f->lock)) {
      const int length = snprintf(owner, sizeof owner, "%ld\n", (long)getpid());
      if (ftruncate(f->lock, 0) != 0 || pwrite(f->lock, owner, (size_t)length, 0) != length)
        errno = 0; /* only a hint */
      return CF_OK;
    }
    close(f->lock);
  }
  if (pread(f->lock, owner, sizeof owner - 1, 0) < 0) owner[0] = '\0';
  owner[strcspn(owner, "\n")] = '\0';
  close(f->lock);
  f->lock = -1; /* not ours: its name stays */
  return cf_fail(CF_CANNOT_WRITE,
                 "%s: another run is writing this folder%s%s: wait for it, or choose another with -o",
                 f->path.text, owner[0] != '\0' ? ", process " : "", owner);
}

static cf_status open_log(cf_folder *f) {
  cf_path file;
  CF_TRY(cf_path_make(&file, "%s/log.txt", f->path.text));
  f->log = open(file.text, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (f->log < 0) return cf_fail(CF_CANNOT_WRITE, "%s: cannot be written: %s", file.text, strerror(errno));
  return CF_OK;
}

static cf_status refuse_or_clear(const cf_folder *f, const bool force) {
  const char *path = f->path.text;
  census found = {0};
  char holds[256], word[CF_PATH_MAX];
  CF_TRY(cf_folder_each(path, visit_census, &found));
  census_sentence(&found, holds, sizeof holds);
  if (holds[0] == '\0') return CF_OK;
  cf_path_quote(path, word, sizeof word);
  if (!force)
    return cf_fail(
        CF_BAD_USAGE,
        "%s: holds a run already (%s): give --force to replace it, -o DIR to write elsewhere, or go on "
        "with `cattaneo resume %s`",
        path, holds, word);
  /* run.yaml goes first: whatever interrupts this, no old checkpoint can be taken for one of the new run. */
  CF_TRY(cut_files((cut){.path = path, .run = true}));
  return cut_files((cut){.path = path, .frames = true, .above = -1, .checkpoints = true});
}

/* The common end of create and open: on failure nothing stays open. */
static cf_status settle(cf_folder *f, cf_status s) {
  if (s == CF_OK) s = cut_files((cut){.path = f->path.text, .drafts = true});
  if (s == CF_OK) s = open_log(f);
  if (s != CF_OK) cf_folder_close(f);
  return s;
}

static cf_status name_folder(cf_folder *f, const char *path) {
  *f = (cf_folder){.lock = -1, .log = -1};
  if (path[0] == '\0') return cf_fail(CF_BAD_USAGE, "the output folder has an empty name");
  CF_TRY(cf_path_make(&f->path, "%s", path));
  size_t length = strlen(f->path.text);
  while (length > 1 && f->path.text[length - 1] == '/') f->path.text[--length] = '\0';
  return CF_OK;
}

cf_status cf_folder_create(cf_folder *f, const char *path, const bool force) {
  CF_TRY(name_folder(f, path));
  CF_TRY(cf_folder_make(f->path.text));
  cf_status s = take_lock(f);
  if (s == CF_OK) s = refuse_or_clear(f, force);
  return settle(f, s);
}

cf_status cf_folder_open(cf_folder *f, const char *path) {
  cf_path yaml;
  struct stat facts;
  CF_TRY(name_folder(f, path));
  if (stat(f->path.text, &facts) != 0)
    return cf_fail(CF_BAD_FILE, "%s: cannot be opened: %s; wanted is the folder of a run", f->path.text,
                   strerror(errno));
  if (!S_ISDIR(facts.st_mode))
    return cf_fail(CF_BAD_FILE,
                   "%s: is not a folder; wanted is the folder of a run (a scene is run by cattaneo run)",
                   f->path.text);
  CF_TRY(cf_path_make(&yaml, "%s/run.yaml", f->path.text));
  if (access(yaml.text, R_OK) != 0)
    return cf_fail(CF_BAD_FILE, "%s: holds no run that could go on: run.yaml: %s", f->path.text,
                   strerror(errno));
  return settle(f, take_lock(f));
}

void cf_folder_close(cf_folder *f) {
  cf_path lock;
  if (f->path.text[0] == '\0') return;
  if (f->log >= 0) close(f->log);
  if (f->lock >= 0) {
    if (cf_path_make(&lock, "%s/.lock", f->path.text) == CF_OK) unlink(lock.text);
    close(f->lock);
  }
  *f = (cf_folder){.lock = -1, .log = -1};
}

cf_status cf_folder_log(cf_folder *f, const char *format, ...) {
  char line[2 * CF_SENTENCE_MAX];
  va_list values;
  va_start(values, format);
  vsnprintf(line, sizeof line - 1, format, values);
  va_end(values);
  const size_t length = strlen(line);
  line[length] = '\n';
  if (write(f->log, line, length + 1) != (ssize_t)(length + 1))
    return cf_fail(CF_CANNOT_WRITE, "%s/log.txt: cannot be written: %s", f->path.text, strerror(errno));
  return CF_OK;
}
