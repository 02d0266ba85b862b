/* SPDX-License-Identifier: MIT
 *
 * Files that appear whole or not at all: write aside, sync, rename, sync the folder. (The functions of
 * folder.h that concern one file.)
 */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/mem.h"
#include "io/folder.h"

cf_status cf_path_make(cf_path *p, const char *format, ...) {
  va_list values;
  va_start(values, format);
  const int length = vsnprintf(p->text, sizeof p->text, format, values);
  va_end(values);
  if (length < 0 || length >= (int)sizeof p->text)
    return cf_fail(CF_BAD_ARGUMENT, "the path %.60s... is too long: at most %d letters", p->text,
                   CF_PATH_MAX - 1);
  return CF_OK;
}

void cf_path_quote(const char *path, char *text, const size_t size) {
  const bool plain = path[strcspn(path, " \t\n'\"\\$&|;<>()*?[]{}#~`!")] == '\0';
  size_t n = (size_t)snprintf(text, size, "%s", plain ? path : "'");
  if (plain) return;
  for (; *path != '\0' && n + 6 < size; ++path)
    n += (size_t)snprintf(text + n, size - n, *path == '\'' ? "'\\''" : "%c", *path);
  snprintf(text + n, size - n, "'");
}

/* The folder part of a path, "." if it has none; *name is the rest. */
static cf_status split(const char *path, cf_path *folder, const char **name) {
  const char *slash = strrchr(path, '/');
  *name = slash == NULL ? path : slash + 1;
  if (slash == NULL) return cf_path_make(folder, ".");
  if (slash == path) return cf_path_make(folder, "/");
  return cf_path_make(folder, "%.*s", (int)(slash - path), path);
}

cf_status cf_draft_begin(cf_draft *d, const char *path) {
  cf_path folder;
  const char *name;
  CF_TRY(cf_path_make(&d->path, "%s", path));
  CF_TRY(split(path, &folder, &name));
  if (name[0] == '\0') return cf_fail(CF_BAD_ARGUMENT, "%s: names a folder, not a file", path);
  /* The process in the name: two programs that write the same picture do not meet halfway. */
  return cf_path_make(&d->temporary, "%s/.%s.%ld.part", folder.text, name, (long)getpid());
}

cf_status cf_draft_try(const char *path) {
  cf_draft d;
  struct stat facts;
  CF_TRY(cf_draft_begin(&d, path));
  if (stat(path, &facts) == 0 && S_ISDIR(facts.st_mode))
    return cf_fail(CF_CANNOT_WRITE, "%s: cannot be written: it is a folder", path);
  const int file = open(d.temporary.text, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0) return cf_fail(CF_CANNOT_WRITE, "%s: cannot be written: %s", path, strerror(errno));
  close(file);
  cf_draft_drop(&d);
  return CF_OK;
}

static cf_status sync_path(const char *path, const int flags) {
  const int file = open(path, flags | O_RDONLY | O_CLOEXEC);
  if (file < 0) return cf_fail(CF_CANNOT_WRITE, "%s: cannot be opened again: %s", path, strerror(errno));
  /* Some file systems cannot sync a folder and say EINVAL: nothing more can be done there. */
  const int failed = fsync(file) != 0 && errno != EINVAL && errno != ENOTSUP;
  const int reason = errno;
  close(file);
  if (failed) return cf_fail(CF_CANNOT_WRITE, "%s: not brought to the disk: %s", path, strerror(reason));
  return CF_OK;
}

void cf_draft_drop(const cf_draft *d) { unlink(d->temporary.text); }

cf_status cf_draft_keep(const cf_draft *d) {
  cf_path folder;
  const char *name;
  cf_status s = sync_path(d->temporary.text, 0);
  if (s == CF_OK && rename(d->temporary.text, d->path.text) != 0)
    s = cf_fail(CF_CANNOT_WRITE, "%s: cannot be put in place: %s", d->path.text, strerror(errno));
  if (s != CF_OK) {
    cf_draft_drop(d);
    return s;
  }
  CF_TRY(split(d->path.text, &folder, &name));
  return sync_path(folder.text, O_DIRECTORY);
}

cf_status cf_file_fill(const char *path, bool (*fill)(FILE *file, const void *what), const void *what) {
  cf_draft draft;
  CF_TRY(cf_draft_begin(&draft, path));
  FILE *file = fopen(draft.temporary.text, "wbe");
  if (file == NULL) return cf_fail(CF_CANNOT_WRITE, "%s: cannot be written: %s", path, strerror(errno));
  errno = 0;
  const bool written = fill(file, what) && fflush(file) == 0 && !ferror(file);
  const int reason = errno;
  if (fclose(file) != 0 || !written) {
    cf_draft_drop(&draft);
    return cf_fail(CF_CANNOT_WRITE, "%s: cannot be written: %s", path, strerror(written ? errno : reason));
  }
  return cf_draft_keep(&draft);
}

typedef struct block {
  const void *bytes;
  size_t size;
} block;

static bool fill_block(FILE *file, const void *what) {
  const block *b = what;
  return fwrite(b->bytes, 1, b->size, file) == b->size;
}

cf_status cf_file_write(const char *path, const void *bytes, const size_t size) {
  return cf_file_fill(path, fill_block, &(block){bytes, size});
}

/* Reads what the open file has; its size was asked before, but it may be growing. */
static cf_status read_all(FILE *file, const char *path, const size_t size, char *text, size_t *got) {
  *got = fread(text, 1, size, file);
  if (ferror(file)) return cf_fail(CF_BAD_FILE, "%s: cannot be read: %s", path, strerror(errno));
  return CF_OK;
}

FILE *cf_file_stream(const char *path) {
  const int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  FILE *stream = file < 0 ? NULL : fdopen(file, "rb");
  if (file >= 0 && stream == NULL) close(file);
  return stream;
}

cf_status cf_file_open(const char *path, FILE **file, size_t *size) {
  struct stat facts;
  *file = cf_file_stream(path);
  if (*file == NULL) return cf_fail(CF_BAD_FILE, "%s: cannot be read: %s", path, strerror(errno));
  if (fstat(fileno(*file), &facts) == 0 && S_ISREG(facts.st_mode)) {
    *size = (size_t)facts.st_size;
    return CF_OK;
  }
  fclose(*file);
  *file = NULL;
  return cf_fail(CF_BAD_FILE, "%s: is not a file", path);
}

cf_status cf_file_read(const char *path, const size_t most, char **text, size_t *size) {
  FILE *file;
  size_t bytes;
  *text = NULL;
  CF_TRY(cf_file_open(path, &file, &bytes));
  cf_status s = CF_OK;
  if (bytes > most)
    s = cf_fail(CF_BAD_FILE, "%s: has %zu bytes, more than the %zu that make sense", path, bytes, most);
  if (s == CF_OK) s = CF_NEW(text, bytes + 1);
  if (s == CF_OK) s = read_all(file, path, bytes, *text, size);
  fclose(file);
  if (s != CF_OK) {
    cf_free(*text);
    *text = NULL;
  }
  return s;
}
