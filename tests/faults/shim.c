/* SPDX-License-Identifier: MIT
 *
 * A disk that fails on demand: preloaded (LD_PRELOAD), it counts the calls by which a program changes the files below
 * one folder, and lets one of them go wrong.
 *
 *   FAULT_FOLDER  the folder, an absolute path; calls on other files are passed on and not counted
 *   FAULT_KIND    error  the call fails and does nothing         short  a write does half of what was asked, then fails
 *                 full   this and all later writes find no space  kill   a write does half, then the process is killed
 *   FAULT_AT      which call, counted from 1; 0: none
 *   FAULT_TRACE   a file that gets a line for every call: its name and the file's
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define REAL(name, type) ((type)(size_t)dlsym(RTLD_NEXT, #name))

typedef enum fault { NONE, ERROR, SHORT, FULL, KILL } fault;

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static long calls;
static FILE *trace;

__attribute__((constructor)) static void open_trace(void) {
  const char *path = getenv("FAULT_TRACE");
  if (path != NULL) trace = fopen(path, "w");
}

/* What becomes of the call `name` of the file `path`; `writes`: it would take room on the disk. */
static fault next_of(const char *name, const char *path, const bool writes) {
  const char *folder = getenv("FAULT_FOLDER"), *at = getenv("FAULT_AT"), *kind = getenv("FAULT_KIND");
  const size_t length = folder != NULL ? strlen(folder) : 0;
  if (length == 0 || strncmp(path, folder, length) != 0) return NONE;
  const long wanted = at != NULL ? atol(at) : 0;
  pthread_mutex_lock(&lock);
  const long now = ++calls;
  if (trace != NULL) fprintf(trace, "%s %s\n", name, path + length);
  pthread_mutex_unlock(&lock);
  if (kind == NULL || wanted == 0 || now < wanted) return NONE;
  if (strcmp(kind, "full") == 0) return writes ? FULL : NONE;
  if (now > wanted) return NONE;
  return strcmp(kind, "short") == 0 ? SHORT : strcmp(kind, "kill") == 0 ? KILL : ERROR;
}

/* The same of an open file. */
static fault next(const char *name, const int file, const bool writes) {
  char link[64], path[PATH_MAX];
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length <= 0) return NONE;
  path[length] = '\0';
  return next_of(name, path, writes);
}

/* The same of a file by its name. */
static fault next_named(const char *name, const char *file) {
  char path[PATH_MAX];
  return realpath(file, path) != NULL ? next_of(name, path, false) : NONE;
}

static void die(void) { kill(getpid(), SIGKILL); }

/* --- bytes ------------------------------------------------------------------------------------------------ */

ssize_t write(const int file, const void *bytes, const size_t size) {
  ssize_t (*real)(int, const void *, size_t) = REAL(write, ssize_t(*)(int, const void *, size_t));
  const fault f = next("write", file, true);
  if (f == NONE) return real(file, bytes, size);
  if (f == SHORT) return real(file, bytes, size / 2);
  if (f == KILL) {
    (void)!real(file, bytes, size / 2);
    die();
  }
  errno = ENOSPC;
  return -1;
}

static ssize_t faulty_pwrite(const int file, const void *bytes, const size_t size, const off_t at) {
  ssize_t (*real)(int, const void *, size_t, off_t) =
      REAL(pwrite64, ssize_t(*)(int, const void *, size_t, off_t));
  const fault f = next("pwrite", file, true);
  if (f == NONE) return real(file, bytes, size, at);
  if (f == SHORT) return real(file, bytes, size / 2, at);
  if (f == KILL) {
    (void)!real(file, bytes, size / 2, at);
    die();
  }
  errno = ENOSPC;
  return -1;
}

ssize_t pwrite(const int file, const void *bytes, const size_t size, const off_t at) {
  return faulty_pwrite(file, bytes, size, at);
}
ssize_t pwrite64(const int file, const void *bytes, const size_t size, const off_t at) {
  return faulty_pwrite(file, bytes, size, at);
}

size_t fwrite(const void *bytes, const size_t size, const size_t count, FILE *file) {
  size_t (*real)(const void *, size_t, size_t, FILE *) =
      REAL(fwrite, size_t(*)(const void *, size_t, size_t, FILE *));
  const fault f = next("fwrite", fileno(file), true);
  if (f == NONE) return real(bytes, size, count, file);
  const size_t half = f == SHORT || f == KILL ? real(bytes, size, count / 2, file) : 0;
  if (f == KILL) {
    fflush_unlocked(file);
    die();
  }
  errno = ENOSPC;
  return half;
}

/* --- calls that do or do not ------------------------------------------------------------------------------ */

/* Whether the call is to fail, with errno set. */
static bool fails(const fault f, const int reason) {
  if (f == KILL) die();
  errno = reason;
  return f != NONE;
}

int fflush(FILE *file) {
  int (*real)(FILE *) = REAL(fflush, int (*)(FILE *));
  const fault f = file != NULL ? next("fflush", fileno(file), true) : NONE;
  return fails(f, ENOSPC) ? EOF : real(file);
}

int fclose(FILE *file) {
  int (*real)(FILE *) = REAL(fclose, int (*)(FILE *));
  const fault f = next("fclose", fileno(file), true);
  if (f == KILL) die();
  const int done = real(file); /* closed in any case */
  return fails(f, ENOSPC) ? EOF : done;
}

int close(const int file) {
  int (*real)(int) = REAL(close, int (*)(int));
  const fault f = next("close", file, false);
  if (f == KILL) die();
  const int done = real(file);
  return fails(f, EIO) ? -1 : done;
}

int fsync(const int file) {
  int (*real)(int) = REAL(fsync, int (*)(int));
  return fails(next("fsync", file, false), EIO) ? -1 : real(file);
}

int fdatasync(const int file) {
  int (*real)(int) = REAL(fdatasync, int (*)(int));
  return fails(next("fdatasync", file, false), EIO) ? -1 : real(file);
}

static int faulty_truncate(const int file, const off_t size) {
  int (*real)(int, off_t) = REAL(ftruncate64, int (*)(int, off_t));
  return fails(next("ftruncate", file, false), EIO) ? -1 : real(file, size);
}

int ftruncate(const int file, const off_t size) { return faulty_truncate(file, size); }
int ftruncate64(const int file, const off_t size) { return faulty_truncate(file, size); }

int rename(const char *from, const char *to) {
  int (*real)(const char *, const char *) = REAL(rename, int (*)(const char *, const char *));
  return fails(next_named("rename", from), EIO) ? -1 : real(from, to);
}

int unlink(const char *name) {
  int (*real)(const char *) = REAL(unlink, int (*)(const char *));
  return fails(next_named("unlink", name), EIO) ? -1 : real(name);
}
